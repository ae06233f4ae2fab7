//! Tools as files: how they are laid out.

use crate::failure::Failure;
use std::io::{self, IsTerminal, Read, Write};
use std::path::{Path, PathBuf};
use tool_dsl::format::format;
use tool_dsl::source::{Source, Sources};

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
                say!("{}\n", report.render(&sources, io::stderr().is_terminal()));
            }
            return Ok(Outcome::Wrong);
        }
    };
    let outcome = if formatted == source.text { Outcome::Same } else { Outcome::Changed };
    let mut out = io::stdout().lock();
    match (&outcome, check) {
        (Outcome::Changed, true) => writeln!(out, "{}", source.name)?,
        (_, false) if piped => out.write_all(formatted.as_bytes())?,
        (Outcome::Changed, false) => {
            if let Err(error) = replace(file, &formatted) {
                say!("error: {}: {error}", file.display());
                return Ok(Outcome::Wrong);
            }
        }
        _ => {}
    }
    out.flush()?;
    Ok(outcome)
}

fn standard_input() -> io::Result<Source> {
    let mut text = String::new();
    io::stdin().read_to_string(&mut text)?;
    Ok(Source::new("<stdin>", text))
}

/// Puts a text in a file's place at once: whoever reads the file finds all of the old or all of the
/// new. A link keeps leading to its file, and the file keeps its permissions.
fn replace(file: &Path, text: &str) -> io::Result<()> {
    let file = file.canonicalize()?;
    // Who may not write the file may not replace it either.
    std::fs::OpenOptions::new().write(true).open(&file)?;
    let folder = file.parent().unwrap_or(Path::new("."));
    let mut new = tempfile::Builder::new().prefix(".touchoff-").tempfile_in(folder)?;
    new.write_all(text.as_bytes())?;
    new.as_file().set_permissions(file.metadata()?.permissions())?;
    new.as_file().sync_all()?;
    new.persist(&file)?;
    Ok(())
}
