//! Codes: every reason for which a program, a machine, a control or a job is refused, every gap in a check and every finding has one.
//!
//! A code is stable; the words of a message may change. `touchoff explain` and `docs/refusals.md` print the table. An enumeration of
//! errors is its own part of the table: the macro `faults` declares both at once.

use crate::check::{CheckGap, MachineProgramError, StepFault, UnknownCause, VerifyError};
use crate::gcode::{
    ArcFault, CompensationFault, ControlError, ControlFault, ExpressionFault, GcodeFault, NoteKind,
};
use crate::job::{FindingRule, JobError, JobFileFault, JobGap, NoVerdict};
use crate::machine::{BodyFault, InverseError, JointError, MachineError, MachineFault};
use crate::program::{ProgramError, ProgramFault, WriteError};
use crate::stock::StockError;

/// A row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// The stable code: a letter, two digits of the family, two of the row.
    pub code: &'static str,
    /// The lines of its documentation: the title, and after a blank line the explanation.
    lines: &'static [&'static str],
    /// The message with the remedy, and the names of the data in braces; empty if it is that of another library.
    template: &'static str,
}

/// A family of rows, whose codes have a common prefix.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    /// The first characters of its codes.
    pub prefix: &'static str,
    /// The subject, in a few words.
    pub title: &'static str,
    /// Its rows, by code. Variants that hand on the error of another enumeration have none.
    rows: &'static [Option<Entry>],
}

impl Family {
    pub(crate) const fn new(
        prefix: &'static str,
        title: &'static str,
        rows: &'static [Option<Entry>],
    ) -> Family {
        Family { prefix, title, rows }
    }

    /// Returns its rows, by code.
    pub fn entries(&self) -> impl Iterator<Item = &'static Entry> {
        self.rows.iter().flatten()
    }
}

impl Entry {
    pub(crate) const fn new(
        code: &'static str,
        lines: &'static [&'static str],
        template: &'static str,
    ) -> Entry {
        Entry { code, lines, template }
    }

    /// Returns the title, a noun phrase without a full stop that begins in lower case.
    pub fn title(&self) -> String {
        let title = self.lines.first().map_or("", |line| line.trim().trim_end_matches('.'));
        let end = title.find(|c: char| !c.is_alphabetic()).unwrap_or(title.len());
        // Words such as M99 and NaN keep their capitals.
        match title.get(1..end) {
            Some(rest)
                if rest.chars().all(char::is_lowercase)
                    && !title[end..].starts_with(|c: char| c.is_ascii_digit()) =>
            {
                title[..1].to_lowercase() + &title[1..]
            }
            _ => title.to_owned(),
        }
    }

    /// Returns the word before its code: `error` of what is refused, `finding`, or `gap` of what is left open.
    pub fn severity(&self) -> &'static str {
        match self.code.as_bytes() {
            [b'V', b'0', b'1', ..] => "finding",
            [b'V', ..] => "gap",
            _ => "error",
        }
    }

    /// Returns the sentences behind the title, which state the rule and its reason; empty if the message says everything.
    pub fn explanation(&self) -> String {
        let lines = self.lines.iter().skip(1).map(|line| line.trim());
        lines.filter(|line| !line.is_empty()).collect::<Vec<_>>().join(" ")
    }

    /// Returns the message without its remedy, with the names of data in capitals; empty if it is that of another library.
    pub fn message(&self) -> String {
        capitals(self.parts().0)
    }

    /// Returns the remedy, with the names of data in capitals; empty if the message has none, or names it among its data.
    pub fn remedy(&self) -> String {
        capitals(self.parts().1)
    }

    /// Returns the message with its remedy, and the explanation.
    pub fn help(&self) -> String {
        let colon = if self.remedy().is_empty() { "" } else { ": " };
        let sentence = format!("{}{colon}{}.", self.message(), self.remedy());
        format!("{sentence} {}", self.explanation()).trim_end().to_owned()
    }

    /// Splits the template at its last colon, behind which the remedy stands.
    fn parts(&self) -> (&'static str, &'static str) {
        self.template.rsplit_once(": ").unwrap_or((self.template, ""))
    }
}

/// Writes the placeholders of a template in capitals: `write {expected}` as `write EXPECTED`. One without a name is `…`.
fn capitals(template: &str) -> String {
    let mut shown = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once('{') {
        shown.push_str(before);
        // `{{` is a brace.
        if let Some(after) = after.strip_prefix('{') {
            shown.push('{');
            rest = after;
            continue;
        }
        let (name, after) = after.split_once('}').unwrap_or((after, ""));
        match name.split(':').next().unwrap_or_default().trim_start_matches('.') {
            name if name.bytes().all(|byte| byte.is_ascii_digit()) => shown.push('…'),
            name => shown.push_str(&name.to_uppercase().replace('_', " ")),
        }
        rest = after;
    }
    shown.push_str(rest);
    shown.replace("}}", "}")
}

/// Declares an enumeration of errors with its rows of the table.
///
/// Each variant has documentation, whose first line is the title of its row and whose paragraphs after it are the explanation; a code,
/// or with `code_of` the field that is the error with the code; and its message, as `thiserror` takes it, with the remedy after the
/// last colon.
///
/// ```text
/// faults! {
///     #[family("P03", "Arcs")]
///     /// A fault in an arc.
///     #[derive(Clone, PartialEq, thiserror::Error)]
///     #[non_exhaustive]
///     pub enum ArcFault {
///         /// A centre and a radius.
///         #[code = P0302]
///         #[error("the arc has a centre and a radius: write one of them")]
///         CentreAndRadius,
///     }
/// }
/// ```
macro_rules! faults {
    (
        #[family($prefix:literal, $title:literal)]
        $(#[$meta:meta])*
        $visibility:vis enum $name:ident {
            $(
                $(#[doc = $doc:literal])+
                $(#[code = $code:ident])?
                $(#[code_of($of:tt)])?
                #[error($message:tt $($argument:tt)*)]
                $variant:ident $(($($tuple:tt)*))? $({$($field:tt)*})?
            ),* $(,)?
        }
    ) => {
        $(#[$meta])*
        $visibility enum $name {
            $(
                $(#[doc = $doc])+
                #[error($message $($argument)*)]
                $variant $(($($tuple)*))? $({$($field)*})?,
            )*
        }

        touchoff::debug_as_sentence!($name);

        impl $name {
            /// The rows of its variants.
            pub(crate) const FAMILY: $crate::codes::Family = $crate::codes::Family::new(
                $prefix,
                $title,
                &[$($crate::codes::faults!(@row [$($code)?] [$($doc),+] $message)),*],
            );

            /// Returns the stable code of the [table](crate::codes).
            $visibility fn code(&self) -> &'static str {
                match self {
                    $(
                        $(Self::$variant { .. } => stringify!($code),)?
                        $(Self::$variant { $of: fault, .. } => fault.code(),)?
                    )*
                }
            }
        }
    };
    (@row [] $docs:tt $message:tt) => { None };
    (@row [$code:ident] [$($doc:literal),+] $message:tt) => {
        Some($crate::codes::Entry::new(
            stringify!($code),
            &[$($doc),+],
            $crate::codes::faults!(@template $message),
        ))
    };
    (@template transparent) => { "" };
    (@template $message:literal) => { $message };
}
pub(crate) use faults;

/// All families, in the order of their codes.
pub const FAMILIES: &[Family] = &[
    JobError::FAMILY,
    JobFileFault::FAMILY,
    StockError::FAMILY,
    VerifyError::FAMILY,
    MachineFault::FAMILY,
    MachineError::FAMILY,
    BodyFault::FAMILY,
    ControlError::FAMILY,
    ControlFault::FAMILY,
    JointError::FAMILY,
    InverseError::FAMILY,
    StepFault::FAMILY,
    MachineProgramError::FAMILY,
    GcodeFault::FAMILY,
    ExpressionFault::FAMILY,
    ArcFault::FAMILY,
    CompensationFault::FAMILY,
    ProgramFault::FAMILY,
    ProgramError::FAMILY,
    WriteError::FAMILY,
    FindingRule::FAMILY,
    NoVerdict::FAMILY,
    CheckGap::FAMILY,
    UnknownCause::FAMILY,
    NoteKind::FAMILY,
    JobGap::FAMILY,
];

/// Returns all rows of the table, by code.
pub fn entries() -> impl Iterator<Item = &'static Entry> {
    FAMILIES.iter().flat_map(Family::entries)
}

/// Returns the row of a code, if there is one.
pub fn entry(code: &str) -> Option<&'static Entry> {
    entries().find(|entry| entry.code == code)
}
