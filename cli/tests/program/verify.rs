//! `touchoff verify`: one line or object per finding, and exit statuses for scripts.

use crate::bench::{Bench, cuboid, objects, shared, stderr, stdout, touchoff};
use serde_json::Value;
use std::process::Output;
use touchoff::{Mesh, Unit};

/// Starts clear, goes 0.5 deep into the block between two points that are clear of it, and leaves in rapid
/// traverse.
const PROGRAM: &str = "PARTNO/BLOCK\nUNITS/MM\nGOTO/-9,0,3,0,0,1\nGOTO/-9,0,-0.5,0,0,1\n\
                       GOTO/9,0,-0.5,0,0,1\nRAPID\nGOTO/9,0,3,0,0,1\nFINI\n";

fn verify(bench: &Bench, program: &str, tool: &str, more: &[&str]) -> Output {
    let (part, program) = (bench.place("block.stl"), bench.place(program));
    let tool = if tool.ends_with(".tool") { bench.place(tool) } else { tool.to_owned() };
    let all = ["verify", "--part", &part, "--unit", "mm", "--tool", &tool, "--program", &program];
    touchoff(&[&all, more].concat())
}

#[test]
fn findings_are_lines_as_compilers_print_them() {
    let bench = Bench::new();
    let file = bench.write("block.apt", PROGRAM);
    let output = verify(&bench, "block.apt", "D2Ball", &["--tolerance", "0.01"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let lines: Vec<String> = stdout(&output).lines().map(str::to_owned).collect();
    let [line] = &lines[..] else { panic!("{lines:?}") };
    assert!(
        line.starts_with(&format!("{file}:5: ball is 0.5000 mm deep in the part at (")),
        "{line}"
    );
    assert!(line.contains(" of the motion from line 4") && line.ends_with(" [V0101]"), "{line}");
    let said = stderr(&output);
    assert!(said.starts_with("findings: 1 violation\n"), "{said}");
    let said = stderr(&verify(&bench, "block.apt", "D2Ball", &["--verbose"]));
    assert!(
        said.contains("1 finding in 3 motions: ball on 1 motion (deepest 0.5000 mm, line 5)"),
        "{said}"
    );
    let clean = verify(&bench, "block.apt", "D2Ball", &["--tolerance", "0.5"]);
    assert_eq!((clean.status.code(), clean.stdout.len()), (Some(0), 0), "{}", stderr(&clean));
    assert!(
        stderr(&clean)
            .starts_with("no findings: every motion is proved to stay within its limits\n"),
        "{}",
        stderr(&clean)
    );
    let allowed = verify(&bench, "block.apt", "D2Ball", &["--allow", "ball=inf"]);
    assert_eq!(allowed.status.code(), Some(0), "{}", stdout(&allowed));
}

#[test]
fn a_thousand_findings_are_printed_and_the_others_are_counted() {
    let bench = Bench::new();
    let to_and_fro =
        ["-9,0,-0.5", "9,0,-0.5", "9,0,3", "-9,0,3"].map(|at| format!("GOTO/{at},0,0,1\n"));
    let to_and_fro = to_and_fro.concat().repeat(1_100);
    bench.write(
        "block.apt",
        format!("PARTNO/BLOCK\nUNITS/MM\nGOTO/-9,0,3,0,0,1\n{to_and_fro}FINI\n"),
    );
    let output = verify(&bench, "block.apt", "D2Ball", &["--tolerance", "0.01"]);
    let [printed, all] = [
        stdout(&output).lines().count(),
        objects(&verify(&bench, "block.apt", "D2Ball", &["--tolerance", "0.01", "--json"])).len(),
    ];
    assert_eq!((printed, all), (1_000, 1_100), "{}", stderr(&output));
    assert!(stderr(&output).contains("100 more findings are left out"), "{}", stderr(&output));
}

#[test]
fn a_finding_is_an_object_for_programs() {
    let bench = Bench::new();
    bench.write("block.apt", PROGRAM);
    let rows = |more: &[&str]| -> Vec<Value> {
        let output = verify(&bench, "block.apt", "D2Ball", &[&["--json"], more].concat());
        assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
        objects(&output)
    };
    let found = rows(&["--tolerance", "0.01"]);
    let [row] = &found[..] else { panic!("{found:?}") };
    let number = |value: &Value| value.as_f64().expect("a number");
    assert_eq!(
        (&row["line"], &row["from_line"], &row["location"]),
        (&5.into(), &4.into(), &2.into())
    );
    assert_eq!((&row["code"], &row["kind"]), (&"V0101".into(), &"deep".into()));
    assert_eq!(row["surface"], "ball");
    assert_eq!((&row["cutting"], &row["rapid"]), (&true.into(), &false.into()));
    assert!((0.3..0.7).contains(&number(&row["fraction"])) && row["triangle"].is_u64(), "{row}");
    assert!(number(&row["allowed_depth"]) == 0.01 && row["file"].is_string(), "{row}");
    let (low, high) = (number(&row["depth"][0]), number(&row["depth"][1]));
    assert!(low <= 0.5 && 0.5 <= high && number(&row["depth_bound"]) >= high, "{row}");
    for key in ["tip", "axis", "point"] {
        assert_eq!(row[key].as_array().map(Vec::len), Some(3), "{key} of {row}");
    }
    // A margin: the shank begins 5 above the tip, so it stays 4.5 above the block's top.
    let found = rows(&["--allow", "ball=inf", "--allow", "shank=-4.6"]);
    let [row] = &found[..] else { panic!("{found:?}") };
    assert_eq!((&row["kind"], &row["surface"]), (&"near".into(), &"shank".into()));
    let (low, high) = (number(&row["distance"][0]), number(&row["distance"][1]));
    assert!(low <= 4.5 && 4.5 <= high && number(&row["distance_bound"]) <= low, "{row}");
    assert!(number(&row["margin"]) == 4.6 && row.get("depth").is_none(), "{row}");
}

#[test]
fn a_tool_file_takes_its_values() {
    let bench = Bench::new();
    bench.write("block.apt", PROGRAM);
    bench.write(
        "own.tool",
        "tool Own { units mm; param D = 2; let r = D/2; profile { start (0, 0); arc to (r, r) center (0, r) as \
         ball cutting; line to (r, 40), (0, 40) as shank; } niceness cutting: 1; }",
    );
    let status = |more: &[&str]| {
        let all = [&["--allow", "ball=inf", "--allow", "shank=-1"], more].concat();
        verify(&bench, "block.apt", "own.tool", &all).status.code()
    };
    // The shank begins one radius above the tip: 0.5 above the block, in which the ball is as deep.
    assert_eq!(status(&[]), Some(1));
    assert_eq!(status(&["--set", "D=6"]), Some(0));
}

#[test]
fn unchecked_programs_have_their_own_status() {
    let bench = Bench::new();
    bench.write("block.apt", PROGRAM);
    bench.write("cut.apt", &PROGRAM[..PROGRAM.len() - 6]);
    bench.write("inch.apt", PROGRAM.replace("MM", "INCHES"));
    let refused = |program: &str, tool: &str, more: &[&str], word: &str| {
        let output = verify(&bench, program, tool, more);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(output.stdout.is_empty() && said.contains(word), "`{word}` is missing in:\n{said}");
    };
    refused("cut.apt", "D2Ball", &[], "cut.apt:7: the program stops here without FINI");
    refused("inch.apt", "D2Ball", &[], "inch.apt:2: UNITS says inch, but the part is in mm");
    refused("none.apt", "D2Ball", &[], "cannot be read");
    refused("block.apt", "D3Ball", &[], "did you mean `D2Ball`?");
    refused("block.apt", "D2Ball", &["--allow", "fluet=1"], "it has `ball`, `flute`, `shank`");
    refused("block.apt", "D2Ball", &["--allow", "flute"], "SURFACE=LENGTH");
    refused("block.apt", "D2Ball", &["--allow", "flute=NaN"], "SURFACE=LENGTH");
    refused("block.apt", "D2Ball", &["--tolerance=-1"], "finite length of 0 or more");
    refused("block.apt", "Block", &[], "an axis does not place `Block`");
}

/// A solid without an axis, along a table of quaternions: the block of 40 by 30 by 20 mm turns above the part.
#[test]
fn motions_of_a_solid_are_proved_with_their_spin() {
    let bench = Bench::new();
    let table = |height: f64| {
        format!("-4,0,{height},0,0,0,1\n4,0,{height},0,0,0.6,0.8\n4,0,{height},0,0,0.8,0.6\n")
    };
    bench.write("above.csv", table(0.1));
    bench.write("below.csv", table(-0.25));
    let above = verify(&bench, "above.csv", "Block", &[]);
    assert_eq!(above.status.code(), Some(0), "{}", stderr(&above));
    let below = verify(&bench, "below.csv", "Block", &["--json"]);
    assert_eq!(below.status.code(), Some(1), "{}", stderr(&below));
    let rows: Vec<serde_json::Value> =
        stdout(&below).lines().map(|line| serde_json::from_str(line).expect("an object")).collect();
    let deep = rows.iter().find(|row| row["surface"] == "bottom");
    let deep = deep.expect("the block's underside");
    assert_eq!(deep["kind"], "deep");
    assert!((deep["depth"][0].as_f64().expect("a number") - 0.25).abs() < 2e-3, "{deep}");
    assert_eq!(deep["quaternion"].as_array().map(Vec::len), Some(4), "{deep}");
    // Half a turn is ambiguous: either way is as short.
    bench.write("half.csv", "0,0,9,0,0,0,1\n0,0,9,0,0,1,0\n");
    let half = verify(&bench, "half.csv", "Block", &["--anyway"]);
    assert!(
        stdout(&half).contains("half a turn, so the way between is ambiguous"),
        "{}",
        stdout(&half)
    );
}

/// A statement that could be a motion is refused with its line, by every command that reads programs.
#[test]
fn unknown_statements_are_refused() {
    let bench = Bench::new();
    bench.write("word.apt", PROGRAM.replace("RAPID\n", "GOTOX/1,2,3\n"));
    let inputs = "--part block.stl --unit mm --tool D2Ball --program word.apt";
    for command in ["verify", "run"] {
        let output = bench.touchoff(&format!("{command} {inputs}"));
        assert_eq!(output.status.code(), Some(2), "{command}: {}", stderr(&output));
        let start = "error[P0515]: word.apt:6: `GOTOX` ";
        assert!(stderr(&output).starts_with(start), "{command}: {}", stderr(&output));
    }
    bench.write("wide.apt", PROGRAM.replace("UNITS/MM", "UNITS/MM\nCUTTER/50,25"));
    let output = verify(&bench, "wide.apt", "D2Ball", &["--tolerance", "0.5"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("wide.apt:3: CUTTER/50,25 is not `D2Ball`, which is CUTTER/2,1")
    );
    // All arguments that are stated are shown, and an angle counts whatever the diameter.
    bench.write("cone.apt", PROGRAM.replace("UNITS/MM", "UNITS/MM\nCUTTER/2,1,0,1,0.1"));
    let output = verify(&bench, "cone.apt", "D2Ball", &["--tolerance", "0.5"]);
    assert!(
        stderr(&output)
            .contains("CUTTER/2,1,0,1,0.1 is not `D2Ball`, which is CUTTER/2,1,0,1,0 in"),
        "{}",
        stderr(&output)
    );
    bench.write(
        "passed.apt",
        PROGRAM.replace(
            "UNITS/MM",
            "UNITS/MM\nCOOLNT/ON\nFEDRAT/9\nFEDRAT/8\nSPINDL/900,RPM\nFEDRAT/7,MMPM",
        ),
    );
    let output = verify(&bench, "passed.apt", "D2Ball", &["--tolerance", "0.5"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(
        stderr(&output).contains(": COOLNT, FEDRAT (3), PARTNO, SPINDL\n"),
        "{}",
        stderr(&output)
    );
}

/// A program that is compared with nothing has no verdict.
#[test]
fn a_program_that_never_comes_near_is_not_verified() {
    let bench = Bench::new();
    let far = |x: f64| {
        PROGRAM.replace("GOTO/-9", &format!("GOTO/{x}")).replace("GOTO/9", &format!("GOTO/{x}"))
    };
    bench.write("far.apt", far(1000.0));
    let output = verify(&bench, "far.apt", "D2Ball", &["-v"]);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    for words in [
        "part: (-3.0000, -3.0000, -2.0000) to (3.0000, 3.0000, 0.0000) in mm",
        "tips in (1000.0000, 0.0000, -0.5000) to (1000.0000, 0.0000, 3.0000) in mm",
        "nearest approach: 996.0",
        "; at least 99",
        "never comes within the tool's diameter",
    ] {
        assert!(said.contains(words), "`{words}` is missing in:\n{said}");
    }
    let output = verify(&bench, "far.apt", "D2Ball", &["--anyway"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    // Both ends are far away, but the motion between them is not.
    bench.write("across.csv", "-900,0,0.5,0,0,1\n900,0,0.5,0,0,1\n");
    let output = verify(&bench, "across.csv", "D2Ball", &["-v"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("nearest approach: 0."), "{}", stderr(&output));
    // No depth can be large enough to be a finding.
    for more in [&["--tolerance", "10"][..], &["--resolution", "10"]] {
        let output = verify(&bench, "across.csv", "D2Ball", more);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("allow every surface its greatest possible"), "{said}");
    }
    bench.write("one.csv", "0,0,0.5,0,0,1\n");
    let output = verify(&bench, "one.csv", "D2Ball", &[]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("one.csv:1: holds one position"), "{}", stderr(&output));
}

/// A mesh without an inside has a verdict on its surface only.
#[test]
fn a_part_without_an_inside_is_not_verified() {
    let bench = Bench::new();
    bench.write("block.apt", PROGRAM);
    let block = cuboid([-3.0, -3.0, -2.0], [3.0, 3.0, 0.0]);
    let made = |triangles: Vec<[u32; 3]>| {
        Mesh::new(block.vertices().to_vec(), triangles, Unit::Millimetre).expect("a mesh")
    };
    let leaky = made(block.triangles()[1..].to_vec());
    let inside_out = made(block.triangles().iter().map(|[a, b, c]| [*b, *a, *c]).collect());
    for (name, mesh) in [("leaky.stl", leaky), ("inside_out.stl", inside_out)] {
        bench.part(name, &mesh);
        let inputs = format!("--part {name} --unit mm --tool D2Ball");
        let status = |more: &str| {
            let line = format!("verify {inputs} --program block.apt --tolerance 0.5{more}");
            let output = bench.touchoff(&line);
            (output.status.code(), stderr(&output))
        };
        let (code, said) = status("");
        assert_eq!(code, Some(2), "{name}: {said}");
        assert!(said.contains("inside is undefined"), "{name}: {said}");
        assert_eq!(status(" --surface-only").0, Some(0), "{name}");
        let output = bench.touchoff(&format!("sweep {inputs} --directions 8"));
        assert_eq!(output.status.code(), Some(2), "{name}: {}", stderr(&output));
    }
}

#[test]
fn a_buried_tool_is_reported_inside() {
    let bench = Bench::new();
    bench.write("deep.csv", "0,0,-80,0,0,1\n0.5,0,-80,0,0,1\n");
    bench.part("large.stl", &cuboid([-100.0; 3], [100.0; 3]));
    let inputs = "--part large.stl --program deep.csv --unit mm --tool D2Ball";
    let output = bench.touchoff(&format!("verify {inputs} --json"));
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let whole = objects(&output);
    assert!(
        whole.iter().all(|row| row["kind"] == "inside" && row["surface"].is_null()),
        "{whole:?}"
    );
    let output = bench.touchoff(&format!("run {inputs} --certify 1e-6 --points 100"));
    let said = stderr(&output);
    let inside =
        "inside the material, deeper than its triangles show, at 2 of 2 poses, first at line 1";
    assert!(said.contains(inside), "{said}");
    assert!(stdout(&output).contains("wholly inside the material"), "{}", stdout(&output));
}

/// Returns the number of motions with a depth above a tolerance of 0.01 mm, per surface, and the greatest depth.
fn found(part: &str, program: &str) -> (u64, f64) {
    let all = ["verify", "--part", part, "--unit", "mm", "--tool", "D2Ball", "--program", program];
    let output = touchoff(&[&all[..], &["--tolerance", "0.01", "--json"]].concat());
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let found = objects(&output);
    let deep = found.iter().filter(|row| row["kind"] == "deep");
    let depths = deep.clone().filter_map(|row| row["depth"][0].as_f64());
    (deep.filter_map(|row| row["motions"].as_u64()).sum(), depths.fold(0.0, f64::max))
}

#[test]
fn gouges_of_a_flank_pass_are_found() {
    let bench = Bench::new();
    let made = bench.gouging();
    let (motions, deepest) = found(&made.part, &made.program);
    assert!(motions >= 360, "{motions}");
    // The wall is flatter than a cylinder by 2.4e-5 at most, and a chord of a degree by 1.9e-4.
    assert!((deepest - 0.15).abs() < 5e-4, "{deepest}");
    if let Some(data) = shared() {
        let place = |name: &str| data.join(name).display().to_string();
        let (motions, deepest) =
            found(&place("parts/impeller.stl"), &place("paths/impeller_flank.apt"));
        assert!(motions > 500, "{motions}");
        assert!((0.15..0.16).contains(&deepest), "{deepest}");
    }
}
