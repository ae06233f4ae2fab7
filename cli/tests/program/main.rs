//! The program from the user's side: its output and its refusals.

mod bench;
mod controls;
mod docs;
mod explain;
mod fmt;
mod haptic;
mod help;
mod import;
mod integrations;
mod job;
mod keys;
mod live;
mod machine_bodies;
mod mistakes;
mod output;
mod params;
mod parts;
mod postures;
mod proofs;
mod report;
mod tools;
mod verify;

use bench::{Bench, rows, shared, stderr, stdout, touchoff};
use serde_json::Value;
use std::path::Path;
use std::process::Output;

#[test]
fn a_run_writes_one_object_per_pose() {
    let bench = Bench::new();
    let output = bench.run("block.stl", "path.csv", "D2Ball", &["--json", "--points", "200000"]);
    let rows = rows(&output);
    assert_eq!(rows.len(), 2);
    let keys = [
        "location",
        "line",
        "unit",
        "contacts",
        "depth",
        "force",
        "torque",
        "niceness",
        "magnitude_integral",
        "energy",
        "query_time_ns",
    ];
    for row in &rows {
        for key in keys {
            assert!(row.get(key).is_some(), "{key} is missing in {row}");
        }
    }
    assert_eq!(rows[0]["line"], 2);
    assert_eq!(rows[0]["contacts"], 0);
    assert!(rows[0]["niceness"].is_null());
    assert_eq!(rows[1]["location"], 1);
    // A ball of radius 1 pressed 0.5 into a plane: I = π h² (3r - 2h) / 3, and the plane pushes it up.
    let integral = rows[1]["magnitude_integral"].as_f64().expect("a number");
    assert!((integral - std::f64::consts::PI / 6.0).abs() < 0.05, "{integral}");
    // Its force is π h δ² under the law of an energy, with the centre at a height of h = r - δ.
    let force = rows[1]["force"][2].as_f64().expect("a number");
    assert!((force - std::f64::consts::PI / 8.0).abs() < 0.03, "{force}");
    assert!((rows[1]["depth"].as_f64().expect("a number") - 0.5).abs() < 0.01);
    let said = stderr(&output);
    assert!(said.contains("1 of 2 poses in contact") && said.contains("ball"), "{said}");
}

#[test]
fn each_row_has_the_certified_depth() {
    let bench = Bench::new();
    let run = |tolerance: &str, points: &str| {
        let more = ["--json", "--certify", tolerance, "--points", points];
        bench.run("block.stl", "path.csv", "D2Ball", &more)
    };
    // A cloud of three points is unlikely to have one near the tool, but the triangles are all there.
    let output = run("1e-9", "3");
    let found = rows(&output);
    let number = |value: &Value| value.as_f64().expect("a number");
    let proved =
        |row: &Value| [number(&row["certified_depth"][0]), number(&row["certified_depth"][1])];
    let [low, high] = proved(&found[1]);
    assert!(low <= 0.5 && 0.5 <= high && high - low < 2e-9, "{low} to {high}");
    assert!(found[1]["triangle"].is_u64() && found[1]["surface"] == "ball", "{}", found[1]);
    assert!(proved(&found[0])[1] < 1e-9 && found[0]["triangle"].is_null(), "{}", found[0]);
    assert!(stderr(&output).contains("proved: 1 of 2 poses in contact"), "{}", stderr(&output));
    let [low, high] = proved(&rows(&run("0", "3"))[1]);
    assert!(low <= 0.5 && 0.5 <= high && high - low < 1e-10, "{low} to {high}");
    for wrong in ["-1", "NaN", "deep"] {
        assert_eq!(run(wrong, "3").status.code(), Some(2), "{wrong}");
    }
    // A tool without a profile is certified by how fast its depth changes.
    let field = bench.run("block.stl", "path.csv", "Fig73", &["--certify", "1e-2"]);
    assert!(stderr(&field).contains("proved: 1 of 2 poses in contact"), "{}", stderr(&field));
}

#[test]
fn a_tool_file_has_the_same_contacts_as_the_built_in_tool() {
    let bench = Bench::new();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tools-library/tools/d2_ball.tool");
    bench.write("own.tool", std::fs::read(file).expect("a tool of the library"));
    let without_time = |output: Output| {
        let mut rows = rows(&output);
        rows.iter_mut().for_each(|row| row["query_time_ns"] = Value::Null);
        rows
    };
    let compiled = bench.run("block.stl", "path.csv", "D2Ball", &["--json"]);
    let loaded = bench.run("block.stl", "path.csv", "own.tool", &["--json"]);
    assert_eq!(without_time(compiled), without_time(loaded));
}

#[test]
fn law_weights_and_centre_change_the_wrench() {
    let bench = Bench::new();
    let row = |more: &[&str]| {
        let all = [&["--json", "--points", "20000"], more].concat();
        rows(&bench.run("block.stl", "path.csv", "D2Ball", &all)).swap_remove(1)
    };
    let number = |value: &Value| value.as_f64().expect("a number");
    let plain = row(&[]);
    // In ideal contact the thesis's law is about twice the gradient's.
    let thesis = row(&["--law", "thesis"]);
    assert!(number(&thesis["force"][2]) > 1.3 * number(&plain["force"][2]));
    let without_time = |mut row: Value| {
        row["query_time_ns"] = Value::Null;
        row
    };
    assert_eq!(without_time(row(&["--law", "gradient"])), without_time(plain.clone()));
    let unit = row(&["--weights", "unit"]);
    assert!(number(&unit["magnitude_integral"]) > 10.0 * number(&plain["magnitude_integral"]));
    let moved = row(&["--center", "-1,0,0"]);
    let expected = number(&plain["torque"][1]) - number(&plain["force"][2]);
    assert!((number(&moved["torque"][1]) - expected).abs() < 1e-9);
}

#[test]
fn tools_are_listed() {
    let rows = rows(&touchoff(&["tools", "--json"]));
    let names: Vec<&str> = rows.iter().filter_map(|row| row["name"].as_str()).collect();
    for name in ["UnitSphere", "Cylinder", "HalfSphereCylinder", "Fig73", "Fig73Exact", "D2Ball"] {
        assert!(names.contains(&name), "{name} is not in {names:?}");
    }
}

#[test]
fn files_are_checked_and_expanded() {
    let bench = Bench::new();
    let good = bench.write("good.tool", "tool Good { units mm; region r where hypot(d, z - 1) <= 1 { depth: 1 - hypot(d, z - 1); } }");
    let bad = bench.write(
        "bad.tool",
        "tool Bad {\n    units mm;\n    region r where hypot(d, z - 1) < 1 { depth: dept; }\n}",
    );
    let checked = touchoff(&["check", &good]);
    assert!(checked.status.success() && stdout(&checked).contains("Good"), "{}", stderr(&checked));
    let both = touchoff(&["check", &good, &bad]);
    assert_eq!(both.status.code(), Some(1));
    let said = stderr(&both);
    assert!(said.contains("bad.tool:3:") && said.contains("`<=`") && said.contains('^'), "{said}");
    let expanded = touchoff(&["expand", &good]);
    assert!(stdout(&expanded).contains("Evaluators for Good"));
    assert_eq!(touchoff(&["expand", &bad]).status.code(), Some(1));
}

#[test]
fn wrong_usage_ends_with_two() {
    let bench = Bench::new();
    let (part, path) = (bench.place("block.stl"), bench.place("path.csv"));
    let missing = touchoff(&["run", "--part", &part, "--program", &path, "--tool", "D2Ball"]);
    assert_eq!(missing.status.code(), Some(2));
    assert!(stderr(&missing).contains("--unit"), "{}", stderr(&missing));
    for more in [["--unit", "cm"], ["--points", "0"], ["--law", "hooke"], ["--center", "1,2"]] {
        let output = bench.run("block.stl", "path.csv", "D2Ball", &more);
        assert_eq!(output.status.code(), Some(2), "{more:?}: {}", stderr(&output));
    }
    assert_eq!(touchoff(&["feel"]).status.code(), Some(2));
}

#[test]
fn unknown_tools_and_missing_files_are_named() {
    let bench = Bench::new();
    bench.refused("block.stl", "path.csv", "D2Bal", &["D2Bal", "did you mean `D2Ball`?"]);
    bench.refused("block.stl", "path.csv", "nowhere.tool", &["nowhere.tool"]);
    bench.refused("nowhere.stl", "path.csv", "D2Ball", &["nowhere.stl"]);
    bench.refused_program("nowhere.csv", &["nowhere.csv"]);
}

#[test]
fn invalid_parts_are_refused() {
    let bench = Bench::new();
    let whole = std::fs::read(bench.folder.path().join("block.stl")).expect("the block");
    bench.write("short.stl", &whole[..whole.len() - 30]);
    bench.refused("short.stl", "path.csv", "D2Ball", &["short.stl", "12 triangles"]);
    bench.write("empty.stl", "");
    bench.refused("empty.stl", "path.csv", "D2Ball", &["empty.stl"]);
    bench.write("none.stl", "solid none\nendsolid none\n");
    bench.refused("none.stl", "path.csv", "D2Ball", &["none.stl"]);
    let facet = |vertex: &str| {
        format!(
            "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex {vertex}\nendloop\nendfacet\nendsolid s\n"
        )
    };
    bench.write("nan.stl", facet("0 nan 0"));
    bench.refused("nan.stl", "path.csv", "D2Ball", &["nan.stl", "6"]);
    bench.write("words.stl", facet("0 one 0"));
    bench.refused("words.stl", "path.csv", "D2Ball", &["words.stl", "6"]);
    bench.write("flat.stl", facet("2 0 0"));
    bench.refused("flat.stl", "path.csv", "D2Ball", &["flat.stl"]);
    let mut infinite = whole.clone();
    infinite[96..100].copy_from_slice(&f32::INFINITY.to_le_bytes());
    bench.write("infinite.stl", &infinite);
    bench.refused("infinite.stl", "path.csv", "D2Ball", &["infinite.stl"]);
}

#[test]
fn invalid_programs_are_refused() {
    let bench = Bench::new();
    let cases: [(&str, &str, &[&str]); 7] = [
        ("zero.csv", "0,0,0,0,0,1\n0,0,0,0,0,0\n", &["zero.csv:2", "zero"]),
        ("columns.csv", "0,0,0,0,0,1\n0,0,0,0,1\n", &["columns.csv:2", "5", "6"]),
        ("nan.csv", "0,0,nan,0,0,1\n", &["nan.csv:1"]),
        ("long.csv", "0,0,0,0,0,1.5\n", &["long.csv:1", "1.5"]),
        ("cut.apt", "UNITS/MM\nMULTAX\nGOTO/0,0,0,0,0,1\nGOTO/0,0", &["cut.apt"]),
        ("open.apt", "UNITS/MM\nMULTAX\nGOTO/0,0,0,0,0,1\n", &["open.apt", "FINI"]),
        (
            "inch.apt",
            "UNITS/INCHES\nMULTAX\nGOTO/0,0,0,0,0,1\nFINI\n",
            &["inch.apt:1", "inch", "mm"],
        ),
    ];
    for (name, text, words) in cases {
        bench.write(name, text);
        bench.refused_program(name, words);
    }
}

/// Returns the rows of a 2 mm ball cutter along a program.
fn evaluation(part: &str, path: &str, points: &str) -> Vec<Value> {
    let inputs = ["--part", part, "--unit", "mm", "--tool", "D2Ball", "--program", path];
    rows(&touchoff(&[&["run", "--points", points, "--json"], &inputs[..]].concat()))
}

/// The stand-in gouges by 0.03 mm, and near its 280th position by up to 0.15 mm. The impeller's program gouges too:
/// the ball by up to about 0.03 mm, the flank by about 0.15 mm.
#[test]
fn a_flank_pass_gouges() {
    let deepest = |surface: &str, rows: &[Value]| {
        rows.iter().filter_map(|row| row["surface_depths"][surface].as_f64()).fold(0.0, f64::max)
    };
    let gouging =
        |rows: &[Value]| rows.iter().filter(|row| row["depth"].as_f64() > Some(0.01)).count();
    let bench = Bench::new();
    let made = bench.gouging();
    let rows = evaluation(&made.part, &made.program, "200000");
    assert_eq!((rows.len(), gouging(&rows)), (363, 361));
    for surface in ["ball", "flute", "shank"] {
        // The pass lies between two positions in rapid traverse; points are some 0.06 mm apart.
        let [before, near] = [&rows[1..240], &rows[270..293]].map(|rows| deepest(surface, rows));
        assert!((0.02..0.031).contains(&before), "{surface}: {before}");
        assert!((0.14..0.151).contains(&near), "{surface}: {near}");
    }
    if let Some(data) = shared() {
        let place = |name: &str| data.join(name).display().to_string();
        let rows =
            evaluation(&place("parts/impeller.stl"), &place("paths/impeller_flank.apt"), "300000");
        assert_eq!(rows.len(), 1302);
        let ball = deepest("ball", &rows);
        assert!((0.025..0.045).contains(&ball), "{ball}");
        let near_280 = deepest("flute", &rows[270..292]).max(deepest("shank", &rows[270..292]));
        assert!((0.14..0.17).contains(&near_280), "{near_280}");
        assert!(gouging(&rows) > 300);
    }
}

#[test]
fn files_are_drawn() {
    let bench = Bench::new();
    let good = bench.write(
        "good.tool",
        "tool Good \"a ball\" { units mm; profile { start (0, 0); arc to (3, 3) center (0, 3) as ball \
         cutting; line to (3, 9), (0, 9) as shank; } }",
    );
    let svg = touchoff(&["draw", &good]);
    assert!(svg.status.success(), "{}", stderr(&svg));
    assert!(stdout(&svg).starts_with("<svg "), "{}", stdout(&svg));
    assert!(stdout(&svg).contains("ball R3"));
    assert!(touchoff(&["draw", &good, "-o", &bench.place("good.svg")]).status.success());
    let written = std::fs::read_to_string(bench.place("good.svg")).expect("the drawing");
    assert_eq!(written, stdout(&svg).trim_end());
    let png = touchoff(&["draw", &good, "--output", &bench.place("good.PNG")]);
    assert!(png.status.success() && png.stdout.is_empty(), "{}", stderr(&png));
    let bytes = std::fs::read(bench.place("good.PNG")).expect("the picture");
    assert!(bytes.starts_with(b"\x89PNG") && bytes.len() > 10_000, "{} bytes", bytes.len());

    let refused = |output: &str, words: &[&str]| {
        let done = touchoff(&["draw", &good, "-o", output]);
        let said = stderr(&done);
        assert_eq!(done.status.code(), Some(1), "{said}");
        for word in words {
            assert!(said.contains(word), "`{word}` is missing in:\n{said}");
        }
    };
    refused(&bench.place("good.pdf"), &["`.svg`", "`.png`", "good.svg"]);
    refused(&bench.place("good"), &["is neither", "good.svg"]);
    refused(&bench.place("nowhere/good.svg"), &["cannot write", "nowhere", "folder"]);
    let bad = bench.write("bad.tool", "tool Bad { units mm; }");
    assert_eq!(touchoff(&["draw", &bad]).status.code(), Some(1));
}

/// Spin matters for a solid without an axis: rows with an axis do not place it, quaternions do.
#[test]
fn a_solid_needs_poses_with_spin() {
    let bench = Bench::new();
    bench.refused_with(
        2,
        ("block.stl", "path.csv", "Block"),
        &["path.csv:2", "an axis does not place `Block`", "give a quaternion"],
    );
    bench.write("full.csv", "x,y,z,qx,qy,qz,qw\n0,0,1,0,0,0,1\n0,0,-0.5,0,0,0,1\n");
    let rows = rows(&bench.run("block.stl", "full.csv", "Block", &["--json"]));
    assert_eq!(rows[0]["contacts"], 0);
    assert!((rows[1]["depth"].as_f64().expect("a number") - 0.5).abs() < 1e-6, "{}", rows[1]);
}
