//! The test bench: runs the program, reads its words and rows, and provides a folder.

use nalgebra::Point3;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use touchoff::mesh::shapes;
use touchoff::{Mesh, Unit};

pub(super) fn touchoff(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_touchoff")).args(arguments).output().expect("the program runs")
}

pub(super) fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("UTF-8")
}

pub(super) fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("UTF-8")
}

pub(super) fn rows(output: &Output) -> Vec<Value> {
    assert!(output.status.success(), "{}", stderr(output));
    objects(output)
}

/// Returns the JSON objects that a command printed, whatever its status.
pub(super) fn objects(output: &Output) -> Vec<Value> {
    stdout(output).lines().map(|line| serde_json::from_str(line).expect("a JSON object")).collect()
}

/// Returns the rows of `verify` that are findings, and no gaps.
pub(super) fn findings(output: &Output) -> Vec<Value> {
    objects(output).into_iter().filter(|row| row["kind"] != "not-checked").collect()
}

/// A tool of one param, as a user writes it.
pub(super) const TOOL: &str = "tool My {
    units mm;
    param D = 4;
    profile {
        start (0, 0);
        arc to (D/2, D/2) center (0, D/2) as ball cutting;
        line to (D/2, 20), (0, 20) as shank;
    }
    niceness cutting: 1;
}
";

/// Returns a box as a mesh in mm.
pub(super) fn cuboid(low: [f64; 3], high: [f64; 3]) -> Mesh {
    shapes::cuboid(Point3::from(low), Point3::from(high), Unit::Millimetre).expect("a cuboid")
}

/// A folder with a block of 6 × 6 × 2 below z = 0, and a path into it.
pub(super) struct Bench {
    pub(super) folder: tempfile::TempDir,
}

impl Bench {
    pub(super) fn new() -> Bench {
        let bench = Bench { folder: tempfile::tempdir().expect("a folder") };
        bench.part("block.stl", &cuboid([-3.0, -3.0, -2.0], [3.0, 3.0, 0.0]));
        bench.write("path.csv", "# a comment\n0,0,1,0,0,1\n0,0,-0.5,0,0,1\n");
        bench
    }

    /// Returns the command that runs the program in this folder, with the words of a line.
    pub(super) fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_touchoff"));
        command.args(line.split(' ')).current_dir(&self.folder);
        command
    }

    /// Runs the program in this folder, with the words of a line.
    pub(super) fn touchoff(&self, line: &str) -> Output {
        self.command(line).output().expect("the program runs")
    }

    /// Returns the path of a file in this folder.
    pub(super) fn place(&self, name: &str) -> String {
        self.folder.path().join(name).display().to_string()
    }

    pub(super) fn part(&self, name: &str, mesh: &Mesh) {
        let mut bytes = Vec::new();
        mesh.write_stl(&mut bytes).expect("memory");
        self.write(name, bytes);
    }

    pub(super) fn write(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        let path = self.folder.path().join(name);
        std::fs::write(&path, content).expect("a writable folder");
        path.display().to_string()
    }

    /// Runs `touchoff run` with a part, a path and a tool of this folder, and more arguments.
    pub(super) fn run(&self, part: &str, path: &str, tool: &str, more: &[&str]) -> Output {
        let (part, path) = (self.place(part), self.place(path));
        let tool = if tool.ends_with(".tool") { self.place(tool) } else { tool.to_owned() };
        let mut all = vec!["run", "--part", &part, "--program", &path, "--tool", &tool];
        if !more.contains(&"--unit") {
            all.extend(["--unit", "mm"]);
        }
        all.extend(more);
        touchoff(&all)
    }

    /// Asserts that a run fails with status 1, prints all of `words`, and writes no row.
    pub(super) fn refused(&self, part: &str, path: &str, tool: &str, words: &[&str]) {
        self.refused_with(1, (part, path, tool), words);
    }

    /// Asserts the same of a program that is refused, with status 2.
    pub(super) fn refused_program(&self, path: &str, words: &[&str]) {
        self.refused_with(2, ("block.stl", path, "D2Ball"), words);
    }

    pub(super) fn refused_with(
        &self,
        status: i32,
        (part, path, tool): (&str, &str, &str),
        words: &[&str],
    ) {
        let output = self.run(part, path, tool, &["--json"]);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(status), "{said}");
        assert!(output.stdout.is_empty(), "a row was written: {}", stdout(&output));
        for word in words {
            assert!(said.contains(word), "`{word}` is missing in:\n{said}");
        }
        assert!(!said.contains("panicked"), "{said}");
    }
}

/// A part and a program for it.
pub(super) struct Gouging {
    pub(super) part: String,
    pub(super) program: String,
}

impl Bench {
    /// Writes a stand-in for the impeller and its program: a tube, and a flank pass of a 2 mm cutter around its
    /// outer wall. The cutter is 0.03 mm deep in the wall, and up to 0.15 mm near the 280th of its 361 positions.
    pub(super) fn gouging(&self) -> Gouging {
        self.part("tube.stl", &touchoff::scenes::tube());
        let mut text =
            String::from("PARTNO/TUBE FLANK PASS\nUNITS/MM\nMULTAX/ON\nRAPID\nGOTO/9,0,2,0,0,1\n");
        for degree in 0..=360 {
            let near = f64::from(degree - 280) / 8.0;
            let gouge = 0.03 + 0.12 * (-near * near).exp();
            let out = touchoff::scenes::OUTER + 1.0 - gouge;
            let (sine, cosine) = f64::from(degree).to_radians().sin_cos();
            text += &format!("GOTO/{:.6},{:.6},2,0,0,1\n", out * cosine, out * sine);
        }
        let program = self.write("flank.apt", text + "RAPID\nGOTO/9,0,2,0,0,1\nFINI\n");
        Gouging { part: self.place("tube.stl"), program }
    }
}

/// Returns the folder of shared parts and programs, if it exists. A checkout alone has none; the stand-in then
/// serves for the same tests.
pub(super) fn shared() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    if !folder.is_dir() {
        eprintln!("{} is not there: only the stand-in is asked", folder.display());
        return None;
    }
    Some(folder)
}
