//! `touchoff explain`: explanations of the codes of errors, warnings, findings and gaps.

use crate::failure::Failure;
use crate::output::Output;
use serde::Serialize;
use std::io::Write;
use touchoff_dsl::diagnostic::{self, Example, Severity};
use touchoff_verify::codes;

/// The largest number of edits between two similar codes.
const MAX_EDITS: usize = 2;

/// A row of the table of codes, as `--json` prints it.
#[derive(Serialize)]
struct Row {
    code: &'static str,
    severity: &'static str,
    title: String,
    /// The message, with the names of its data in capitals, if it is the same for all of them.
    #[serde(skip_serializing_if = "String::is_empty")]
    message: String,
    explanation: String,
    remedies: Vec<String>,
    example: Option<&'static str>,
    /// The reason for having no example.
    #[serde(skip)]
    without: Option<&'static str>,
}

impl From<&diagnostic::Entry> for Row {
    fn from(entry: &diagnostic::Entry) -> Row {
        let (example, without) = match entry.example {
            Example::Text(text) => (Some(text), None),
            Example::Without(reason) => (None, Some(reason)),
        };
        Row {
            code: entry.code,
            severity: match entry.severity {
                Severity::Error => "error",
                Severity::Warning => "warning",
                Severity::Note => "note",
            },
            title: entry.title.to_owned(),
            message: String::new(),
            explanation: entry.explanation.to_owned(),
            remedies: entry.remedies().collect(),
            example,
            without,
        }
    }
}

impl From<&codes::Entry> for Row {
    fn from(entry: &codes::Entry) -> Row {
        let remedy = Some(entry.remedy()).filter(|remedy| !remedy.is_empty());
        Row {
            code: entry.code,
            severity: entry.severity(),
            title: entry.title(),
            message: entry.message(),
            explanation: entry.explanation(),
            remedies: remedy.into_iter().collect(),
            example: None,
            without: None,
        }
    }
}

/// Returns the families of codes by their titles, those of tools before those of jobs.
fn families() -> Vec<(&'static str, Vec<Row>)> {
    let of_tools = diagnostic::FAMILIES
        .iter()
        .map(|family| (family.title, family.entries.iter().map(Row::from).collect()));
    let of_jobs = codes::FAMILIES
        .iter()
        .map(|family| (family.title, family.entries().map(Row::from).collect()));
    of_tools.chain(of_jobs).collect()
}

/// Prints the explanation of a code, or lists all codes with their titles.
///
/// # Errors
/// [`Failure::Code`] if there is no such code.
pub(crate) fn explain(code: Option<&str>, json: bool) -> Result<(), Failure> {
    let families = families();
    let rows = || families.iter().flat_map(|(_, rows)| rows);
    // Codes are typed in either case.
    let wanted = code.map(str::to_uppercase);
    let is_wanted = |row: &&Row| wanted.as_ref().is_none_or(|wanted| row.code == wanted);
    let found: Vec<&Row> = rows().filter(is_wanted).collect();
    if let (Some(code), true) = (code, found.is_empty()) {
        let near = similar_codes(&code.to_uppercase(), rows().map(|row| row.code));
        return Err(Failure::Code { code: code.to_owned(), near: near.join("`, `") });
    }
    let mut out = Output::rows();
    match (code, &found[..]) {
        _ if json => {
            for row in found {
                out.json(row)?;
            }
        }
        (Some(_), [row, ..]) => explain_one(row, &mut out)?,
        _ => list_all(&families, &mut out)?,
    }
    Ok(out.flush()?)
}

/// Returns the codes that are most similar to an unknown code: at most three, and none if no code is similar.
fn similar_codes(
    code: &str,
    known: impl Iterator<Item = &'static str> + Clone,
) -> Vec<&'static str> {
    let edits = |known: &&str| strsim::damerau_levenshtein(code, known);
    let min_edits = known.clone().map(|known| edits(&known)).min();
    let min_edits = min_edits.filter(|edits| *edits <= MAX_EDITS);
    known.filter(|known| Some(edits(known)) == min_edits).take(3).collect()
}

fn explain_one(row: &Row, out: &mut Output) -> Result<(), Failure> {
    writeln!(out, "{}[{}]: {}\n", row.severity, row.code, row.title)?;
    if !row.message.is_empty() {
        writeln!(out, "Message: {}\n", row.message)?;
    }
    if !row.explanation.is_empty() {
        writeln!(out, "{}\n", row.explanation)?;
    }
    match &row.remedies[..] {
        [] => {}
        [remedy] => writeln!(out, "Remedy: {remedy}{}", full_stop(remedy))?,
        remedies => {
            writeln!(out, "Remedy, as the case may be:")?;
            for remedy in remedies {
                writeln!(out, "- {remedy}")?;
            }
        }
    }
    match (row.example, row.without) {
        (Some(text), _) => writeln!(out, "\nExample:\n\n{}", text.trim_end())?,
        (None, Some(reason)) => writeln!(out, "\nNo example: {reason}.")?,
        (None, None) => {}
    }
    Ok(())
}

/// Returns the full stop behind a sentence that is no question.
fn full_stop(sentence: &str) -> &'static str {
    if sentence.ends_with('?') { "" } else { "." }
}

fn list_all(families: &[(&'static str, Vec<Row>)], out: &mut Output) -> Result<(), Failure> {
    for (title, rows) in families {
        writeln!(out, "{title}")?;
        for row in rows {
            let severity = match row.severity {
                severity @ ("warning" | "note") => format!(" ({severity})"),
                _ => String::new(),
            };
            writeln!(out, "  {}  {}{severity}", row.code, row.title)?;
        }
    }
    Ok(())
}
