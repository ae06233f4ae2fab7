//! Values for the params of `.tool` files, and mounted files.

use crate::bench::{Bench, rows, stderr, stdout, touchoff};

const CUTTER: &str = "tool Cutter {
    units mm;
    param D = 2;
    profile { start (0, 0); line to (D/2, 0), (D/2, 20), (0, 20) as body cutting; }
}";

#[test]
fn params_are_set() {
    let bench = Bench::new();
    let cutter = bench.write("cutter.tool", CUTTER);
    let radius = |set: &[&str]| {
        let all = [&["tools", "list", "--json", &cutter], set].concat();
        rows(&touchoff(&all))[0]["radius"].as_f64().expect("a number")
    };
    assert!((radius(&[]) - 1.0).abs() < 1e-3);
    assert!((radius(&["--set", "D=0.25inch"]) - 3.175).abs() < 1e-3);
    let checked = touchoff(&["check", &cutter, "--set", "D = 3*2"]);
    assert!(stdout(&checked).contains("3 mm in radius"), "{}", stderr(&checked));
    let expanded = touchoff(&["expand", &cutter, "--set", "D=8"]);
    assert!(stdout(&expanded).contains("4.0"), "{}", stderr(&expanded));
    let depth = |more: &[&str]| {
        let all = [&["--json", "--points", "20000"], more].concat();
        let rows = rows(&bench.run("block.stl", "path.csv", "cutter.tool", &all));
        rows[1]["contacts"].as_u64().expect("a number")
    };
    assert!(depth(&["--set", "D=4"]) > 3 * depth(&[]));
}

#[test]
fn params_that_cannot_be_set_are_named() {
    let bench = Bench::new();
    let cutter = bench.write("cutter.tool", CUTTER);
    let refused = |arguments: &[&str], words: &[&str]| {
        let output = touchoff(arguments);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{said}");
        for word in words {
            assert!(said.contains(word), "`{word}` is missing in:\n{said}");
        }
    };
    refused(
        &["check", &cutter, "--set", "E=3"],
        &["`Cutter` has no param `E`", "it has `D`", "--set:1:1"],
    );
    refused(
        &["check", &cutter, "--set", "D=3deg"],
        &["the given value is an angle", "cutter.tool:3:"],
    );
    refused(&["expand", &cutter, "--set", "D"], &["PARAM = VALUE"]);
    refused(&["tools", "list", "--set", "D=3"], &["`--set` gives values to the params of `.tool`"]);
    let run = bench.run("block.stl", "path.csv", "D2Ball", &["--set", "D=3"]);
    assert!(stderr(&run).contains("`D2Ball` is a built-in tool"), "{}", stderr(&run));
}

#[test]
fn mounted_files_are_found_and_shown() {
    let bench = Bench::new();
    bench.write("cutter.tool", CUTTER);
    bench.write(
        "open.tool",
        "tool Open {\n    units mm;\n    profile { start (0, 0); line to (9, 0) as face; }\n}",
    );
    let mounts = |file: &str| {
        format!(
            "tool Whole {{ units mm; mount \"cutter.tool\" as cutter with D = 1;\n\
             mount \"{file}\" as nut at z = 15; }}"
        )
    };
    let good = bench.write("good.tool", mounts("cutter.tool"));
    let checked = touchoff(&["check", &good]);
    assert!(stdout(&checked).contains("Whole is 35 mm long"), "{}", stderr(&checked));
    let bad = bench.write("bad.tool", mounts("open.tool"));
    let said = stderr(&touchoff(&["check", &bad]));
    assert!(said.contains("open.tool:3:29") && said.contains("not on the axis"), "{said}");
}

/// `--set` holds for all tools of a sweep, and a path takes the tool with the same values.
#[test]
fn sweeps_and_paths_take_values() {
    let bench = Bench::new();
    bench.write(
        "ball.tool",
        "tool Own { units mm; param D = 9; let r = D/2; profile { start (0, 0); arc to (r, r) center (0, r) as \
         ball cutting; line to (r, 40), (0, 40) as shank; } niceness cutting: 1; }",
    );
    let sweep = |more: &str| {
        let inputs = "--part block.stl --unit mm --tool ball.tool --set D=2";
        bench.touchoff(&format!("sweep {inputs} {more}"))
    };
    let output = sweep("--directions 20 --tolerance 0.05 -o own.postures");
    assert!(output.status.success(), "{}", stderr(&output));
    let path = |set: &str| {
        let tool = format!("--tool ball.tool --set {set} --stepover 1");
        bench.touchoff(&format!("path own.postures --part block.stl {tool} -o own.csv"))
    };
    let other = path("D=3");
    assert!(stderr(&other).contains("was not swept with this `Own`"), "{}", stderr(&other));
    assert!(path("D=2").status.success());
    let mixed = sweep("--tool D2Ball");
    assert!(stderr(&mixed).contains("`D2Ball` is a built-in tool"), "{}", stderr(&mixed));
}
