//! From a tool library to a program that is checked with its tools.

use crate::bench::{Bench, rows, stderr, stdout, touchoff};
use crate::help::{example_files, page_commands};
use serde_json::Value;

/// A ball end mill in a nut, and a drill without a holder.
pub(super) const LIBRARY: &str = r#"{ "version": 33, "data": [
  { "type": "ball end mill", "unit": "millimeters", "description": "D4 ball", "guid": "1", "vendor": "Example",
    "geometry": { "DC": 4, "RE": 2, "LCF": 10, "OAL": 50, "SFDM": 4, "LB": 30, "shoulder-length": 12,
      "shoulder-diameter": 3.8, "assemblyGaugeLength": 48 },
    "holder": { "type": "holder", "unit": "millimeters", "description": "ER16 nut", "gaugeLength": 17.5,
      "segments": [ { "height": 1.1, "lower-diameter": 25.8, "upper-diameter": 28 },
                    { "height": 16.4, "lower-diameter": 28, "upper-diameter": 28 } ] },
    "post-process": { "number": 3 } },
  { "type": "drill", "unit": "inches", "description": "1/4 drill", "geometry": { "DC": 0.25, "LCF": 2, "OAL": 3,
      "SIG": 118, "SFDM": 0.25 }, "post-process": { "number": 4 } } ] }"#;

#[test]
fn an_imported_tool_checks_a_program() {
    let bench = Bench::new();
    let library = bench.write("library.json", LIBRARY);
    let (folder, part) = (bench.place("tools"), bench.place("block.stl"));
    let output = touchoff(&["import", &library, "-o", &folder, "--json"]);
    let rows: Vec<Value> =
        stdout(&output).lines().map(|row| serde_json::from_str(row).expect("an object")).collect();
    assert_eq!(rows.len(), 2, "{}", stderr(&output));
    assert!(rows.iter().all(|row| row["proved"] == true), "{rows:?}");
    assert_eq!(rows[0]["stickout"], 30.0);
    // The gauge lengths of holder and stick-out are 47.5, not 48.
    assert!(rows[0]["notes"][0].as_str().is_some_and(|note| note.contains("47.5")), "{rows:?}");
    let tool = bench.place("tools/d4_ball.tool");
    let checked = touchoff(&["check", &tool]);
    assert!(checked.status.success(), "{}", stderr(&checked));
    // The flutes end at 10.
    let clamped = touchoff(&["check", &tool, "--set", "stickout=8"]);
    assert_eq!(clamped.status.code(), Some(3));
    assert!(stderr(&clamped).contains("cuts up to z = 10"), "{}", stderr(&clamped));
    let text = std::fs::read_to_string(&tool).expect("the tool's file");
    assert!(text.contains("mount \"holders/er16_nut.tool\" as holder at z = stickout;"), "{text}");
    let formatted =
        touchoff(&["fmt", "--check", &tool, &bench.place("tools/cutters/d4_ball.tool")]);
    assert!(formatted.status.success(), "{}", stderr(&formatted));
    // The ball's centre is 2 above the tip: at a depth of 0.5 the program gouges.
    let program = bench.write(
        "gouge.apt",
        "UNITS/MM\nGOTO/-9,0,3,0,0,1\nGOTO/-9,0,-0.5,0,0,1\nGOTO/9,0,-0.5,0,0,1\nFINI\n",
    );
    let verify = |tool: &str, from: &str| {
        let tools = ["--tools", from, "--tool", tool, "--program", &program];
        let part = ["--part", &part, "--unit", "mm", "--json"];
        touchoff(&[&["verify"][..], &tools, &part].concat())
    };
    let by_number = verify("T3", &library);
    assert_eq!(by_number.status.code(), Some(1), "{}", stderr(&by_number));
    assert_eq!(stdout(&by_number), stdout(&verify("D4 ball", &library)));
    assert_eq!(stdout(&by_number), stdout(&verify("d4_ball", &folder)));
    let missing = verify("T9", &library);
    assert_eq!(missing.status.code(), Some(2));
    assert!(stderr(&missing).contains("has no tool"), "{}", stderr(&missing));
}

#[test]
fn importing_again_changes_nothing() {
    let bench = Bench::new();
    let library = bench.write("library.json", LIBRARY);
    let folder = bench.place("tools");
    let import = || touchoff(&["import", &library, "-o", &folder]);
    assert!(import().status.success());
    assert!(import().status.success());
    let file = bench.folder.path().join("tools/1_4_drill.tool");
    std::fs::write(&file, "mine").expect("a writable folder");
    let refused = import();
    assert_eq!(refused.status.code(), Some(1));
    assert!(stderr(&refused).contains("other content"), "{}", stderr(&refused));
    assert_eq!(std::fs::read_to_string(&file).expect("the file"), "mine");
}

/// A part of a file would be other content, and the import be refused for ever.
#[cfg(target_os = "linux")]
#[test]
fn an_import_without_room_can_be_made_again() {
    let bench = Bench::new();
    let library = bench.write("library.json", LIBRARY);
    let import = |limit: &str| {
        let script = format!("trap '' XFSZ; ulimit -f {limit}; exec \"$@\"");
        let mut shell = std::process::Command::new("sh");
        shell.args(["-c", &script, "sh", env!("CARGO_BIN_EXE_touchoff"), "import", &library]);
        shell.current_dir(&bench.folder).output().expect("a shell")
    };
    let full = import("0");
    assert_eq!(full.status.code(), Some(1));
    assert!(stderr(&full).contains("File too large"), "{}", stderr(&full));
    let again = import("unlimited");
    assert!(again.status.success(), "{}", stderr(&again));
}

/// The tools of a library go into a folder with its name, unless that is the folder around.
#[test]
fn an_import_stays_in_its_folder() {
    let bench = Bench::new();
    let work = bench.folder.path().join("work");
    std::fs::create_dir(&work).expect("a folder");
    for name in ["...json", "..json"] {
        bench.write(name, LIBRARY);
        let mut import = bench.command(&format!("import ../{name}"));
        let output = import.current_dir(&work).output().expect("the program runs");
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        assert!(stderr(&output).contains("by `-o`"), "{}", stderr(&output));
        assert!(!bench.folder.path().join("d4_ball.tool").exists());
        assert_eq!(std::fs::read_dir(&work).expect("a folder").count(), 0);
    }
    // The list of numbers is no library, but a link can make it one.
    let library = bench.write("library.json", LIBRARY);
    std::fs::hard_link(&library, work.join("tools.toml")).expect("a link");
    let refused = bench.touchoff("import library.json -o work");
    assert_eq!(refused.status.code(), Some(2), "{}", stderr(&refused));
    assert!(stderr(&refused).contains("is also an input"), "{}", stderr(&refused));
}

/// A tool of a library is read without files, which a command that is ended would leave.
#[test]
fn a_tool_of_a_library_needs_no_temporary_folder() {
    let bench = Bench::new();
    let library = bench.write("library.json", LIBRARY);
    for line in [
        ["tools", &library].to_vec(),
        ["export", "T3", "--tools", &library, "-o", "a.json"].to_vec(),
    ] {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_touchoff"));
        command.args(&line).current_dir(bench.folder.path());
        let output = command.env("TMPDIR", bench.place("none")).output().expect("the program");
        assert!(output.status.success(), "{line:?}: {}", stderr(&output));
    }
}

/// The commands of docs/import.md lead from a library to a checked program.
#[test]
fn the_commands_of_the_page_work() {
    let bench = example_files();
    let outputs = page_commands(&bench, include_str!("../../../docs/import.md"));
    for (command, output) in &outputs {
        assert_eq!(output.status.code(), Some(0), "{command}: {}", stderr(output));
    }
    let count = outputs.len();
    assert!((1..=10).contains(&count), "{count} commands");
    for file in
        ["tools/cutters/d4_ball.tool", "tools/holders/er16_nut.tool", "d4_ball.svg", "changed.json"]
    {
        assert!(bench.folder.path().join(file).is_file(), "{file} is missing");
    }
}

/// The table of a library has its sizes and its proofs, and an exported tool has the same.
#[test]
fn exported_tools_are_listed_as_before() {
    let bench = Bench::new();
    let library = bench.write("library.json", LIBRARY);
    let exported = bench.place("exported.json");
    let tools = ["--tools", &library, "T3", "T4", "-o", &exported];
    let output = touchoff(&[&["export", "--json"][..], &tools].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(rows(&output)[0]["type"], "ball end mill");
    assert!(rows(&output)[0]["gaps"][0].as_str().is_some_and(|gap| gap.contains("length")));
    let table = |file: &str| rows(&touchoff(&["tools", file, "--json"]));
    let (before, after) = (table(&library), table(&exported));
    for key in ["type", "title", "unit", "diameter", "flute_length", "stickout", "proved"] {
        for k in 0..2 {
            assert_eq!(before[k][key], after[k][key], "{key} of tool {k}");
        }
    }
    let wrong = touchoff(&["export", "D2Ball", "-o", "tool.step"]);
    assert_eq!(wrong.status.code(), Some(1));
    assert!(stderr(&wrong).contains("tool.json"), "{}", stderr(&wrong));
}
