//! All kinds of diagnostics, and the table of their codes.

use super::Severity;
use super::checks::CheckKind;
use super::mounts::MountKind;
use super::profile::ProfileKind;
use super::regions::RegionKind;
use super::spelling::SpellingKind;
use super::syntax::SyntaxKind;
use super::table::Entry;
use super::values::ValueKind;

/// A family of kinds, whose codes have a common prefix.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    /// The first characters of its codes.
    pub prefix: &'static str,
    /// The subject, in a few words.
    pub title: &'static str,
    /// Its kinds, by code.
    pub entries: &'static [Entry],
}

macro_rules! families {
    ($($family:ident),*) => {
        /// The reason for a diagnostic, with its data.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Kind {
            $(#[doc = concat!("See [`", stringify!($family), "`].")] $family($family)),*
        }

        /// All families, in the order of their codes.
        pub const FAMILIES: &[Family] = &[$($family::TABLE),*];

        impl Kind {
            /// Returns the stable code, which `touchoff explain` and `docs/errors.md` use for the kind.
            pub fn code(&self) -> &'static str {
                match self { $(Kind::$family(kind) => kind.code()),* }
            }

            /// Returns the severity of all diagnostics of this kind.
            pub fn severity(&self) -> Severity {
                match self { $(Kind::$family(kind) => kind.severity()),* }
            }

            /// Returns the message, in the terms of the domain.
            pub fn message(&self) -> String {
                match self { $(Kind::$family(kind) => kind.message()),* }
            }

            /// Returns the remedy.
            pub fn help(&self) -> String {
                match self { $(Kind::$family(kind) => kind.help()),* }
            }
        }
    };
}
families!(SyntaxKind, SpellingKind, ValueKind, ProfileKind, RegionKind, MountKind, CheckKind);

/// Returns all rows of the table, by code.
pub fn entries() -> impl Iterator<Item = &'static Entry> {
    FAMILIES.iter().flat_map(|family| family.entries)
}

/// Returns the row of a code, if there is one.
pub fn entry(code: &str) -> Option<&'static Entry> {
    entries().find(|entry| entry.code == code)
}
