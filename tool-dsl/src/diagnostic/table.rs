//! The declaration of kinds: one entry states code, data, message, remedy and explanation.

use super::Severity;

/// A row of the table: the properties of a kind that do not depend on its data.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The stable code: `T`, two digits of the family, two of the kind.
    pub code: &'static str,
    /// Error or warning.
    pub severity: Severity,
    /// The title, in a few words.
    pub title: &'static str,
    /// One to three sentences that state the rule and its reason.
    pub explanation: &'static str,
    /// The remedies, with the names of their data in braces.
    pub(super) remedies: &'static [&'static str],
    /// A text that causes it.
    pub example: Example,
}

/// A text that causes a diagnostic, or the reason for having none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Example {
    /// The text of `tests/errors/CODE.tool`; files that it mounts are in `tests/errors/CODE/`.
    Text(&'static str),
    /// The reason for having no such file.
    Without(&'static str),
}

impl Entry {
    /// Returns the remedies, one per case, with the names of their data in capitals.
    pub fn remedies(&self) -> impl Iterator<Item = String> {
        self.remedies.iter().map(|template| capitals(template))
    }
}

/// Writes the placeholders of a template in capitals: `write {limit}` as `write LIMIT`.
fn capitals(template: &str) -> String {
    let mut shown = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once('{') {
        shown.push_str(before);
        // `{{` is a literal brace.
        if let Some(after) = after.strip_prefix('{') {
            shown.push('{');
            rest = after;
            continue;
        }
        let (name, after) = after.split_once('}').unwrap_or((after, ""));
        shown.push_str(&name.split(':').next().unwrap_or_default().to_uppercase());
        rest = after;
    }
    shown.push_str(rest);
    shown.replace("}}", "}")
}

/// Declares a family of kinds. An entry has the form
///
/// ```text
/// error T0201 UnknownName { word: String, remedy: NameRemedy }
///     "unknown name"
///     message "unknown name `{word}`"
///     help (remedy) { NameRemedy::Similar(suggestion) => "did you mean `{suggestion}`?", … }
///     explain "…";
/// ```
///
/// Message and help are either a template over the fields, or a `match` without the keyword. An entry that no
/// example file causes ends with `without "reason"`.
macro_rules! kinds {
    (
        $(#[doc = $doc:literal])*
        $family:ident $prefix:literal $about:literal
        $(
            $severity:ident $code:ident $name:ident $({ $($field:ident: $type:ty),* $(,)? })?
                $title:literal
                message $($message:literal)? $(($message_data:expr) {
                    $($case:pat $(if $guard:expr)? => $template:literal),* $(,)?
                })?
                help $($help:literal)? $(($help_data:expr) {
                    $($help_case:pat $(if $condition:expr)? => $remedy:literal),* $(,)?
                })?
                explain $explanation:literal
                $(without $reason:literal)?
        );* $(;)?
    ) => {
        $(#[doc = $doc])*
        #[derive(Clone, Debug, PartialEq)]
        pub enum $family {
            $(
                #[doc = concat!("`", stringify!($code), "`, ", $title, ". ", $explanation)]
                #[allow(missing_docs, reason = "message and remedy name the fields")]
                $name $({ $($field: $type),* })?,
            )*
        }

        impl $family {
            /// The family's part of the table.
            pub(super) const TABLE: $crate::diagnostic::Family = $crate::diagnostic::Family {
                prefix: $prefix,
                title: $about,
                entries: &[$($crate::diagnostic::Entry {
                    code: stringify!($code),
                    severity: kinds!(@severity $severity),
                    title: $title,
                    explanation: $explanation,
                    remedies: &[$($help)? $($($remedy),*)?],
                    example: kinds!(@example $code $($reason)?),
                }),*],
            };

            pub(super) fn code(&self) -> &'static str {
                match self {
                    $(Self::$name { .. } => stringify!($code)),*
                }
            }

            pub(super) fn severity(&self) -> $crate::diagnostic::Severity {
                match self {
                    $(Self::$name { .. } => kinds!(@severity $severity)),*
                }
            }

            #[allow(unused_variables, reason = "a message need not name every field")]
            pub(super) fn message(&self) -> String {
                match self {
                    $(Self::$name $({ $($field),* })? => {
                        $(format!($message))?
                        $(match $message_data { $($case $(if $guard)? => format!($template)),* })?
                    })*
                }
            }

            #[allow(unused_variables, reason = "a remedy need not name every field")]
            pub(super) fn help(&self) -> String {
                match self {
                    $(Self::$name $({ $($field),* })? => {
                        $(format!($help))?
                        $(match $help_data { $($help_case $(if $condition)? => format!($remedy)),* })?
                    })*
                }
            }
        }

        impl From<$family> for $crate::diagnostic::Kind {
            fn from(kind: $family) -> $crate::diagnostic::Kind {
                $crate::diagnostic::Kind::$family(kind)
            }
        }
    };
    (@severity error) => { $crate::diagnostic::Severity::Error };
    (@severity note) => { $crate::diagnostic::Severity::Note };
    (@severity warning) => { $crate::diagnostic::Severity::Warning };
    (@example $code:ident) => {
        $crate::diagnostic::Example::Text(include_str!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/tests/errors/",
            stringify!($code),
            ".tool"
        )))
    };
    (@example $code:ident $reason:literal) => { $crate::diagnostic::Example::Without($reason) };
}
pub(super) use kinds;
