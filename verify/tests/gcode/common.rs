//! The execution of programs, and those of the folder `shared/data/gcode`, which need not exist.

use std::fs;
use std::path::{Path, PathBuf};
use touchoff_verify::gcode::{ControlSetup, GcodeError, Interpreter, Step};

/// Returns the folder, or prints that it is absent.
pub(crate) fn folder() -> Option<PathBuf> {
    let found = Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .map(|folder| folder.join("shared/data/gcode"))
        .find(|folder| folder.is_dir());
    if found.is_none() {
        println!("shared/data/gcode is absent: its programs are not tested");
    }
    found
}

/// Executes a program.
pub(crate) fn execute(program: &str, setup: &ControlSetup) -> Result<Vec<Step>, GcodeError> {
    Interpreter::new(program, setup)?.collect()
}

/// Executes a program that is read to its end.
#[track_caller]
pub(crate) fn steps(program: &str, setup: &ControlSetup) -> Vec<Step> {
    execute(program, setup).unwrap_or_else(|error| panic!("{program}\n{error}"))
}

pub(crate) fn text(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Returns whether an error has a code and, where a word follows it in the pattern, this in its sentence: a word of the program, or what
/// tells two causes of one code apart.
pub(crate) fn is_fault(error: &GcodeError, pattern: &str) -> bool {
    let (code, word) = pattern.split_once(' ').unwrap_or((pattern, ""));
    error.code() == code && error.fault.to_string().contains(word)
}

/// Asserts the line and the fault of an error, as [`is_fault`] does.
#[track_caller]
pub(crate) fn assert_fault(program: &str, error: &GcodeError, line: usize, pattern: &str) {
    let said = format!("{program}\n{}: {error}, not {line}: {pattern}", error.code());
    assert!(error.line == line && is_fault(error, pattern), "{said}");
}
