//! `touchoff explain`: explanations of the compiler's error and warning codes.

use crate::failure::Failure;
use crate::output::Output;
use serde::Serialize;
use std::io::Write;
use touchoff_dsl::diagnostic::{
    Entry, Example, FAMILIES, Severity, entries, entry, similar_entries,
};

/// Prints the explanation of a code, or lists all codes with their titles.
///
/// # Errors
/// [`Failure::Code`] if there is no such code.
pub(crate) fn explain(code: Option<&str>, json: bool) -> Result<(), Failure> {
    let requested = match code {
        None => None,
        // Codes are typed in either case.
        Some(code) => Some(entry(&code.to_uppercase()).ok_or_else(|| unknown(code))?),
    };
    let mut out = Output::rows();
    match requested {
        // One row or all of them, in the same form.
        _ if json => {
            let all = entries()
                .filter(|row| requested.is_none_or(|requested| requested.code == row.code));
            for entry in all {
                out.json(&Row::of(entry))?;
            }
        }
        Some(entry) => explain_one(entry, &mut out)?,
        None => list_all(&mut out)?,
    }
    Ok(out.flush()?)
}

/// Returns the failure for an unknown code, with the codes most like it.
fn unknown(code: &str) -> Failure {
    let similar: Vec<&str> =
        similar_entries(&code.to_uppercase()).map(|entry| entry.code).collect();
    Failure::Code { code: code.to_owned(), near: similar.join("`, `") }
}

fn explain_one(entry: &Entry, out: &mut Output) -> Result<(), Failure> {
    writeln!(out, "{}[{}]: {}\n", severity(entry), entry.code, entry.title)?;
    writeln!(out, "{}\n", entry.explanation)?;
    match entry.remedies().collect::<Vec<_>>().as_slice() {
        [remedy] => writeln!(out, "Remedy: {remedy}.\n")?,
        remedies => {
            writeln!(out, "Remedy, as the case may be:")?;
            for remedy in remedies {
                writeln!(out, "- {remedy}")?;
            }
            writeln!(out)?;
        }
    }
    match entry.example {
        Example::Text(text) => writeln!(out, "Example:\n\n{}", text.trim_end())?,
        Example::Without(reason) => writeln!(out, "No example: {reason}.")?,
    }
    Ok(())
}

fn list_all(out: &mut Output) -> Result<(), Failure> {
    for family in FAMILIES {
        writeln!(out, "{}", family.title)?;
        for entry in family.entries {
            let severity = match entry.severity {
                Severity::Error => "",
                Severity::Warning => " (warning)",
                Severity::Note => " (note)",
            };
            writeln!(out, "  {}  {}{severity}", entry.code, entry.title)?;
        }
    }
    Ok(())
}

fn severity(entry: &Entry) -> &'static str {
    match entry.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    }
}

/// The row of a code in `--json`.
#[derive(Serialize)]
struct Row {
    code: &'static str,
    severity: &'static str,
    title: &'static str,
    explanation: &'static str,
    remedies: Vec<String>,
    example: Option<&'static str>,
}

impl Row {
    fn of(entry: &Entry) -> Row {
        Row {
            code: entry.code,
            severity: severity(entry),
            title: entry.title,
            explanation: entry.explanation,
            remedies: entry.remedies().collect(),
            example: match entry.example {
                Example::Text(text) => Some(text),
                Example::Without(_) => None,
            },
        }
    }
}
