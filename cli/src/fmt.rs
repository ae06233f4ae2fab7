//! Tools as files: how they are laid out.

use crate::failure::Failure;
use crate::output::{Output, show};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use tool_dsl::format::format;
use tool_dsl::source::{Source, Sources};
use touchoff::AtomicFile;

/// Lays files out in place, or only names those that would change. A file with errors of syntax
/// stays as it is.
pub(crate) fn fmt(files: &[PathBuf], check: bool) -> Result<(), Failure> {
    let (mut wrong, mut changed) = (0, 0);
    for file in files {
        match one(file, check)? {
            Outcome::Same => {}
            Outcome::Changed => changed += 1,
            Outcome::Wrong => wrong += 1,
        }
    }
    match files.len() {
        all if wrong > 0 => Err(Failure::Files { wrong, all }),
        all if check && changed > 0 => Err(Failure::Unformatted { changed, all }),
        _ => Ok(()),
    }
}

enum Outcome {
    Same,
    Changed,
    Wrong,
}

fn one(file: &Path, check: bool) -> Result<Outcome, Failure> {
    let piped = file == Path::new("-");
    let source = match if piped { standard_input() } else { Source::read(file) } {
        Ok(source) => source,
        Err(error) => {
            say!("error: {}: {error}", file.display());
            return Ok(Outcome::Wrong);
        }
    };
    let formatted = match format(&source) {
        Ok(formatted) => formatted,
        Err(reports) => {
            let sources = Sources::new(source, []);
            for report in reports {
                show(&report, &sources);
            }
            return Ok(Outcome::Wrong);
        }
    };
    let outcome = if formatted == source.text { Outcome::Same } else { Outcome::Changed };
    match (&outcome, check) {
        (Outcome::Changed, true) => {
            let mut out = Output::lines();
            writeln!(out, "{}", source.name)?;
            out.flush()?;
        }
        (_, false) if piped => {
            let mut out = Output::bytes();
            out.write_all(formatted.as_bytes())?;
            out.flush()?;
        }
        (Outcome::Changed, false) => {
            if let Err(error) = AtomicFile::write(file, &formatted) {
                say!("error: {}: {error}", file.display());
                return Ok(Outcome::Wrong);
            }
        }
        _ => {}
    }
    Ok(outcome)
}

fn standard_input() -> io::Result<Source> {
    let mut text = String::new();
    io::stdin().read_to_string(&mut text)?;
    Ok(Source::new("<stdin>", text))
}
