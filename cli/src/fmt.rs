//! `touchoff fmt`: the layout of `.tool` files.

use crate::arguments::Fmt;
use crate::failure::Failure;
use crate::output::{Output, show, unwritable};
use serde::Serialize;
use std::borrow::Cow;
use std::io::{self, Read, Write};
use std::path::Path;
use touchoff::AtomicFile;
use touchoff::tool::ToolError;
use touchoff_dsl::format::format;
use touchoff_dsl::source::{MAX_SOURCE_BYTES, Source, Sources};

/// Formats files in place, or with `--check` only names those that would change, and reports the rewritten files on
/// standard error. A file with syntax errors stays as it is. With `json`, writes one object per file to standard output, except for formatted text that goes there
/// itself.
pub(crate) fn fmt(arguments: &Fmt, json: bool) -> Result<(), Failure> {
    let Fmt { check, ref files } = *arguments;
    let (mut wrong, mut changed, mut rewritten) = (0, 0, 0);
    for file in files {
        let outcome = format_file(file, check, json)?;
        match outcome {
            Outcome::Unchanged => {}
            Outcome::Changed => changed += 1,
            Outcome::Failed => wrong += 1,
        }
        if matches!(outcome, Outcome::Changed) && !check && !is_piped(file) {
            rewritten += 1;
            message!("rewritten: {}", file.display());
        }
        if json && (check || !is_piped(file)) {
            let mut out = Output::lines();
            let row = Row { file: file.to_string_lossy(), check, outcome };
            out.json(&row)?;
            out.flush()?;
        }
    }
    if rewritten > 0 {
        message!("{rewritten} of {} files rewritten", files.len());
    }
    match files.len() {
        all if wrong > 0 => Err(Failure::Files { wrong, all }),
        all if check && changed > 0 => Err(Failure::Unformatted { changed, all }),
        _ => Ok(()),
    }
}

/// The row of a file in `--json`.
#[derive(Serialize)]
struct Row<'f> {
    file: Cow<'f, str>,
    /// True if the file was only checked.
    check: bool,
    outcome: Outcome,
}

#[derive(Clone, Copy, Serialize)]
#[serde(rename_all = "lowercase")]
enum Outcome {
    /// The layout is the standard one.
    Unchanged,
    /// The file was rewritten, or with `--check` would be.
    Changed,
    /// The file has errors, which are on standard error.
    Failed,
}

fn format_file(file: &Path, check: bool, json: bool) -> Result<Outcome, Failure> {
    let piped = is_piped(file);
    let shown = file.display();
    let source = match if piped { standard_input() } else { Source::read(file) } {
        Ok(source) => source,
        Err(error) => {
            message!("error: {}", ToolError::Unreadable { file: shown.to_string(), source: error });
            return Ok(Outcome::Failed);
        }
    };
    let formatted = match format(&source) {
        Ok(formatted) => formatted,
        Err(diagnostics) => {
            let sources = Sources::new(source, []);
            for diagnostic in diagnostics {
                show(&diagnostic, &sources);
            }
            return Ok(Outcome::Failed);
        }
    };
    let outcome = if formatted == source.text { Outcome::Unchanged } else { Outcome::Changed };
    match (&outcome, check) {
        (Outcome::Changed, true) if !json => {
            let mut out = Output::lines();
            writeln!(out, "{}", source.name)?;
            out.flush()?;
        }
        // Also text that is formatted already: the reader of the pipe expects it all.
        (_, false) if piped => {
            let mut out = Output::bytes();
            out.write_all(formatted.as_bytes())?;
            out.flush()?;
        }
        (Outcome::Changed, false) => {
            if let Err(error) = AtomicFile::write(file, &formatted) {
                message!("error: {}", unwritable(file, error));
                return Ok(Outcome::Failed);
            }
        }
        _ => {}
    }
    Ok(outcome)
}

fn is_piped(file: &Path) -> bool {
    file == Path::new("-")
}

/// Reads standard input. A text longer than a file's may be is cut one byte beyond that, and later refused for its
/// length.
fn standard_input() -> io::Result<Source> {
    let mut bytes = Vec::new();
    io::stdin().take(MAX_SOURCE_BYTES as u64 + 1).read_to_end(&mut bytes)?;
    let text = String::from_utf8(bytes)
        .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error.utf8_error()))?;
    Ok(Source::new("<stdin>", text))
}
