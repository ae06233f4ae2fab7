//! Programs of a folder: which of them the interpreter reads to the end, and the reasons for which it does not read the others.

use std::collections::BTreeMap;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};
use touchoff_verify::gcode::{ControlRules, ControlSetup, GcodeError, Interpreter};
use touchoff_verify::program::{ProgramError, ProgramFile};

/// A file, and what becomes of it.
struct Reading {
    /// Its path below the folder.
    file: String,
    outcome: Result<usize, Refusal>,
}

/// The first line that is not read.
struct Refusal {
    /// The line, if there is one.
    line: Option<usize>,
    reason: String,
}

impl From<GcodeError> for Refusal {
    fn from(GcodeError { line, fault }: GcodeError) -> Refusal {
        Refusal { line: Some(line), reason: fault.to_string() }
    }
}

impl fmt::Display for Reading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.outcome {
            Ok(motions) => write!(f, "{} | read to the end, {motions} motions", self.file),
            Err(Refusal { line: Some(line), reason }) => {
                write!(f, "{} | line {line}: {reason}", self.file)
            }
            Err(Refusal { line: None, reason }) => write!(f, "{} | {reason}", self.file),
        }
    }
}

/// Returns the files of a folder and of those in it, in the order of their paths.
fn files(root: &Path) -> Vec<PathBuf> {
    let (mut folders, mut found) = (vec![root.to_owned()], Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            match path.is_dir() {
                true => folders.push(path),
                false => found.push(path),
            }
        }
    }
    found.sort();
    found
}

/// Reads a file as a program of a control.
fn read(path: &Path, setup: &ControlSetup) -> Result<usize, Refusal> {
    let refused = |reason: String| Refusal { line: None, reason };
    let text = match ProgramFile::read(path) {
        Ok(ProgramFile::Gcode(text)) => text,
        Ok(ProgramFile::Locations(_)) => return Err(refused("it is CL data".to_owned())),
        Err(ProgramError::Line { line, fault, .. }) => {
            return Err(Refusal { line: Some(line), reason: fault.to_string() });
        }
        Err(_) => return Err(refused("it has no program".to_owned())),
    };
    let mut motions = 0;
    for step in Interpreter::new(&text, setup)? {
        step?;
        motions += 1;
    }
    Ok(motions)
}

/// Reads all programs of a folder. The control is at 0 in all axes, with all work offsets and all radius offsets at 0.
/// With an `ending`, other files are left out.
fn read_folder(root: &Path, ending: Option<&str>, rules: ControlRules) -> Vec<Reading> {
    let setup = ControlSetup {
        start: [Some(0.0); 6],
        work_offsets: [Some([0.0; 6]); 9],
        home: [Some(0.0); 6],
        radius_offsets: (1..1000).map(|number| (number, 0.0)).collect(),
        rules,
        ..ControlSetup::default()
    };
    let has_ending = |path: &PathBuf| {
        let own = path.extension().unwrap_or_default();
        ending.is_none_or(|ending| own.eq_ignore_ascii_case(ending))
    };
    let readings = files(root).into_iter().filter(has_ending).map(|path| {
        let file = path.strip_prefix(root).expect("a file of the folder").display().to_string();
        Reading { file, outcome: read(&path, &setup) }
    });
    readings.collect()
}

/// Returns the reasons, each with the number of files that it stops, from the most frequent.
fn reasons(readings: &[Reading]) -> Vec<(&str, usize)> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for refusal in readings.iter().filter_map(|reading| reading.outcome.as_ref().err()) {
        *counts.entry(&refusal.reason).or_default() += 1;
    }
    let mut counts: Vec<_> = counts.into_iter().collect();
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    counts
}

/// The programs of the folder in `PROGRAMS`, as the control in `CONTROL` reads them (as none that is stated, without it): a line per
/// file, and the number of files per reason. `ENDING` leaves out files with another one.
/// `CONTROL=heidenhain ENDING=h PROGRAMS=../programs cargo test -p touchoff-verify --test gcode programs_of_a_folder -- --nocapture`.
#[test]
fn programs_of_a_folder() {
    let Some(root) = std::env::var_os("PROGRAMS") else {
        println!("PROGRAMS is not set: no folder of programs is read");
        return;
    };
    let rules = match std::env::var("CONTROL") {
        Ok(name) => ControlRules::named(&name).expect("CONTROL is the name of a control"),
        Err(_) => ControlRules::default(),
    };
    let ending = std::env::var("ENDING").ok();
    let readings = read_folder(Path::new(&root), ending.as_deref(), rules);
    assert!(!readings.is_empty(), "PROGRAMS has no files");
    for reading in &readings {
        println!("{reading}");
    }
    let read = readings.iter().filter(|reading| reading.outcome.is_ok()).count();
    println!("{read} of {} files are read to the end", readings.len());
    for (reason, count) in reasons(&readings) {
        println!("{count} | {reason}");
    }
}

#[test]
fn a_folder_has_a_line_per_file_and_a_number_per_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, body: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, body).expect("a file");
    };
    let klartext =
        |blocks: &str| format!("0 BEGIN PGM P MM\n; of a test\n{blocks}\nEND PGM P MM\n");
    write("b/two.h", &klartext("L X+1 Y+0 R0 F100\nL X+5\nL Y+5\nL X+9"));
    write("a.h", &klartext("TCH PROBE 400"));
    write("b/c.h", &klartext("L X+1 FMAX\nTCH PROBE 400"));
    write("cl.apt", "UNITS/MM\nGOTO/1,2,3\nFINI\n");
    write("empty.h", "");
    let rules = ControlRules::named("heidenhain").expect("a control");
    let readings = read_folder(folder.path(), None, rules.clone());
    let lines: Vec<String> = readings.iter().map(|reading| reading.to_string()).collect();
    let starts = [
        "a.h | line 3: TCH PROBE",
        &format!("{} | read to the end, 4 motions", Path::new("b").join("two.h").display()),
    ];
    assert_eq!(lines.len(), 5, "{lines:?}");
    assert!(
        starts.iter().all(|start| lines.iter().any(|line| line.starts_with(start))),
        "{lines:?}"
    );
    assert!(lines.contains(&"cl.apt | it is CL data".to_owned()), "{lines:?}");
    let counts = reasons(&readings);
    assert!(counts[0].0.starts_with("TCH PROBE") && counts[0].1 == 2, "{counts:?}");
    assert_eq!(counts[1..], [("it has no program", 1), ("it is CL data", 1)]);
    assert_eq!(read_folder(folder.path(), Some("H"), rules).len(), 4);
}
