//! The sentences of refusals, stored in a file per language in `tests/sentences`: the only tests that compare them.
//!
//! A line is a cause: a program, or a change of `machine.toml`, `job.toml` or the file of LinuxCNC's control, as `FROM => TO`. `\n` is the
//! end of a line in it. The indented line below has the code, the line and the sentence. `UPDATE_ERRORS=1` writes these anew; add a
//! cause as a line of its own.

use crate::scene::{line_of, rules};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use touchoff_verify::gcode::{Choice, ControlError, ControlRules, ControlSetup, Interpreter, Rule};
use touchoff_verify::machine::{Machine, MachineError};
use touchoff_verify::{ClData, JobFile, ProgramError};

/// The indentation of a sentence.
const INDENT: &str = "    ";

/// A refusal: its code, its line with 0 for none, and its sentence. `None` for a cause that is not refused.
type Refusal = Option<(&'static str, usize, String)>;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/sentences")
}

fn read(name: &str) -> String {
    let path = folder().join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Compares the sentences of a file with those of its causes.
fn assert_sentences(name: &str, refusal: impl Fn(&str) -> Refusal) {
    let file = format!("{name}.txt");
    let kept = read(&file);
    let mut found = String::new();
    for cause in kept.lines().filter(|line| !line.starts_with(INDENT)) {
        let text = cause.replace("\\n", "\n");
        let Some((code, line, sentence)) = refusal(&text) else {
            panic!("{file}: this is not refused: {cause}");
        };
        writeln!(found, "{cause}\n{INDENT}{code} {line} {sentence}").expect("a string");
    }
    if std::env::var_os("UPDATE_ERRORS").is_some() {
        std::fs::write(folder().join(&file), &found).expect("the file can be written");
    }
    let changed = found.lines().zip(kept.lines()).find(|(found, kept)| found != kept);
    let is_same = found == kept || std::env::var_os("UPDATE_ERRORS").is_some();
    assert!(is_same, "{file} is stale: UPDATE_ERRORS=1 writes it anew. {changed:?}");
}

/// Interprets a program on a control, or without one, with all axes and offsets at 0.
fn interpreted(control: Option<&str>, program: &str) -> Refusal {
    let stays = ControlRules::default().with(Rule::ToolChange, Choice::Stays);
    let setup = ControlSetup {
        start: [Some(0.0); 6],
        work_offsets: [Some([0.0; 6]); 9],
        lengths: [(1, 80.0), (2, 50.0), (5, 80.0)].into(),
        rules: control.map_or(stays, rules),
        // Endless loops are refused sooner.
        max_repeated: 10_000,
        ..ControlSetup::default()
    };
    let result = Interpreter::new(program, &setup)
        .and_then(|interpreter| interpreter.collect::<Result<Vec<_>, _>>());
    let error = result.err()?;
    Some((error.code(), error.line, error.fault.to_string()))
}

fn located(text: &str) -> Refusal {
    let error = ClData::parse(text, "part").err()?;
    let line = match &error {
        ProgramError::Line { line, .. } | ProgramError::OnePosition { line, .. } => *line,
        _ => 0,
    };
    // Lines after it are about further faults.
    let sentence = error.to_string().lines().next().unwrap_or_default().to_owned();
    Some((error.code(), line, sentence))
}

/// Returns a text with a change.
fn changed(text: &str, change: &str) -> String {
    let (from, to) = change.split_once(" =>").expect("a change");
    let to = to.trim_start();
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

#[test]
fn of_programs_of_controls() {
    for (name, control) in [
        ("iso", None),
        ("linuxcnc", Some("linuxcnc")),
        ("heidenhain", Some("heidenhain")),
        ("klartext", None),
        ("sinumerik", None),
    ] {
        assert_sentences(name, |program| interpreted(control, program));
    }
}

#[test]
fn of_tables_and_apt() {
    for name in ["table", "apt"] {
        assert_sentences(name, located);
    }
}

#[test]
fn of_machines() {
    let text = read("machine.toml");
    assert_sentences("machine", |change| {
        let error = Machine::parse(&changed(&text, change), "machine.toml").err()?;
        let line = match &error {
            MachineError::Line { line, .. } => *line,
            _ => 0,
        };
        Some((error.code(), line, error.to_string()))
    });
}

#[test]
fn of_jobs() {
    let text = read("job.toml");
    assert_sentences("job", |change| {
        let error = JobFile::parse(&changed(&text, change), Path::new("job.toml")).err()?;
        Some((error.code(), line_of(&error), error.to_string()))
    });
}

#[test]
fn of_controls() {
    let text = rules("linuxcnc").to_toml();
    assert_sentences("control", |change| {
        let error = ControlRules::parse(&changed(&text, change), "control.toml").err()?;
        let line = match &error {
            ControlError::Line { line, .. } => *line,
            _ => 0,
        };
        Some((error.code(), line, error.to_string()))
    });
}
