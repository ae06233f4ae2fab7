//! Jobs on a control as the program checks them: options, statuses, lines of output, files.

use crate::bench::{Bench, findings, objects, stderr, stdout, touchoff};
use serde_json::json;
use std::process::Output;
use touchoff_verify::gcode::{ControlRules, Rule};

/// Returns a folder with a block, a program that states its unit and its offset and turns the spindle, and its job.
fn bench(blocks: &str) -> Bench {
    let bench = Bench::new();
    write(&bench, blocks);
    bench.write(
        "a.toml",
        "part = \"block.stl\"\nunit = \"mm\"\nprogram = \"a.nc\"\n[tool.1]\ntool = \"D2Ball\"\nlength = 50\n\
         [work_offsets]\nG54 = [0, 0, -400]\n",
    );
    bench
}

fn write(bench: &Bench, blocks: &str) {
    bench.write("a.nc", format!("G21 G90 G54 G94 S9000 M3 F100.\n{blocks}\nM30\n"));
}

/// Verifies the job of a folder with more options.
fn verify(bench: &Bench, more: &[&str]) -> Output {
    let file = bench.place("a.toml");
    touchoff(&[&["verify", &file][..], more].concat())
}

const LINUXCNC: [&str; 2] = ["--control", "linuxcnc"];

/// A finding, a gap and an error, each with its code at the place where the compiler of tools prints one.
#[test]
fn findings_gaps_and_errors_are_printed_with_their_codes() {
    let bench = bench("G43 H1 G0 X-6. Y0. Z20.\nX0.\nG1 Z-0.5\nG0 Z20.");
    let found = verify(&bench, &LINUXCNC);
    assert_eq!(found.status.code(), Some(1), "{}", stderr(&found));
    let (place, said) =
        (format!("{}:4: ball is 0.5000 mm deep", bench.place("a.nc")), stdout(&found));
    assert!(said.starts_with(&place) && said.ends_with(" [V0101]\n"), "{said}");
    assert!(stderr(&found).contains("\nnot checked: line 2: "), "{}", stderr(&found));
    assert!(stderr(&found).contains(" [V0401]\n"), "{}", stderr(&found));
    write(&bench, "G43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG777\nG0 Z20.");
    let open = verify(&bench, &LINUXCNC);
    assert_eq!((open.status.code(), &*stdout(&open)), (Some(2), ""), "{}", stderr(&open));
    // The verdict and its reason come before everything else that is said of the program.
    let said = stderr(&open);
    let mut lines = said.lines();
    assert!(lines.next().is_some_and(|line| line.starts_with("no verdict: ")), "{said}");
    let reason = format!("not verified: {}:4: G777 is ", bench.place("a.nc"));
    assert!(lines.next().is_some_and(|line| line.starts_with(&reason)), "{said}");
    assert!(said.contains(" [P0114]\n"), "{said}");
    write(&bench, "G43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.");
    let clean = verify(&bench, &LINUXCNC);
    assert_eq!((clean.status.code(), &*stdout(&clean)), (Some(0), ""), "{}", stderr(&clean));
    let unknown = verify(&bench, &["--control", "fanac"]);
    assert_eq!((unknown.status.code(), &*stdout(&unknown)), (Some(2), ""));
    let said = stderr(&unknown);
    assert!(said.starts_with("error[K0401]: ") && said.contains("`fanuc`"), "{said}");
}

/// `--control` takes a file, in which a fault has its line.
#[test]
fn a_control_is_read_from_a_file() {
    let bench = bench("G43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.");
    let file = ControlRules::named("linuxcnc").expect("a control").to_toml();
    let control = bench.write("c.toml", &file);
    let sound = verify(&bench, &["--control", &control]);
    assert_eq!(sound.status.code(), Some(0), "{}", stderr(&sound));
    bench.write("c.toml", file.replace("whole_numbers", "whole_number"));
    let faulty = verify(&bench, &["--control", &control]);
    assert_eq!(faulty.status.code(), Some(2));
    let said = stderr(&faulty);
    assert!(said.starts_with(&format!("error[K0502]: {control}:")), "{said}");
    assert!(said.contains("did you mean `whole_numbers`?"), "{said}");
}

/// Findings and gaps in a file of subprograms name it in JSON and on the page of the report.
#[test]
fn a_line_of_a_subprogram_is_in_json_and_in_the_report() {
    let bench = bench("T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nM98 P9001\nM0\nG0 Z20.");
    let job = std::fs::read_to_string(bench.place("a.toml")).expect("the job");
    let job = bench.write("a.toml", format!("subprograms = [\"O9001.nc\"]\n{job}"));
    let lost = verify(&bench, &["--control", "haas"]);
    assert_eq!(lost.status.code(), Some(2));
    let said = stderr(&lost);
    assert!(said.starts_with("error[P0601]: ") && said.contains("O9001.nc"), "{said}");
    bench.write("O9001.nc", "(PASS)\nG0 X0. Y0.\nG1 Z-1.\nM99\n");
    let output = verify(&bench, &["--control", "haas", "--json"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let rows = objects(&output);
    let row = rows.iter().find(|row| row["code"] == "V0101").expect("a finding");
    let within = json!({ "file": "O9001.nc", "line": 3 });
    assert_eq!((&row["line"], &row["within"]), (&json!(5), &within), "{row}");
    // Messages about the program itself have none.
    assert!(rows.iter().any(|row| row["reason"].is_string() && row["within"].is_null()));
    let page = bench.place("report.html");
    let said = stderr(&touchoff(&["report", &job, "--control", "haas", "-o", &page]));
    let page = std::fs::read_to_string(&page).expect(&said);
    for words in [
        "<summary>O9001.nc, lines 1 to 5</summary>",
        "&gt; 3  G1 Z-1.",
        "during the stop are not checked [V0508]",
    ] {
        assert!(page.contains(words), "{words}: {said}");
    }
}

/// Gaps are rows of their own kind.
#[test]
fn gaps_are_in_the_json() {
    let bench = bench("G0 X-6. Y0. Z20.\nM8\nM0\nG1 X4.\nG4 P2.\nG0 Z30.");
    let output = verify(&bench, &[&LINUXCNC[..], &["--json"]].concat());
    let rows = objects(&output);
    let gaps: Vec<_> = rows.iter().filter(|row| row["kind"] == "not-checked").collect();
    for code in ["V0401", "V0502", "V0508"] {
        assert!(gaps.iter().any(|gap| gap["code"] == code && gap["open"] == false), "{gaps:?}");
    }
    assert!(findings(&output).is_empty(), "{rows:?}");
}

#[test]
fn a_number_that_two_tools_of_a_library_have_is_refused() {
    let bench = bench("T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.");
    let bit = |name: &str| {
        format!(
            "{{\"guid\": \"{name}\", \"type\": \"flat end mill\", \"unit\": \"millimeters\", \"description\": \"{name}\", \
             \"geometry\": {{\"DC\": 6, \"LCF\": 20, \"OAL\": 60, \"LB\": 30, \"SFDM\": 6, \"shoulder-length\": 25}}, \
             \"post-process\": {{\"number\": 1}}}}"
        )
    };
    let library = format!("{{\"version\": 1, \"data\": [{}, {}]}}", bit("one"), bit("two"));
    let library = bench.write("two.json", library);
    let (part, program) = (bench.place("block.stl"), bench.place("a.nc"));
    let common = ["verify", "--part", &part, "--unit", "mm", "--program", &program];
    let verify = |more: &[&str]| touchoff(&[&common, &LINUXCNC[..], more].concat());
    let output = verify(&["--tools", &library]);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("has 2 tools `T1`: `one`, `two`"), "{said}");
    // A folder keeps the numbers of the tools that were imported into it.
    let folder = bench.place("tools");
    for (only, expected) in [("one", 0), ("two", 2)] {
        let imported = touchoff(&["import", &library, "-o", &folder, "--only", only]);
        assert!(imported.status.success(), "{}", stderr(&imported));
        let output = verify(&["--tools", &folder]);
        assert_eq!(output.status.code(), Some(expected), "{}", stderr(&output));
    }
}

#[test]
fn a_mesh_in_place_of_a_job_is_named() {
    let bench = Bench::new();
    let part = bench.place("block.stl");
    let output = touchoff(&["verify", &part]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("is a mesh, and `verify` takes a job file"),
        "{}",
        stderr(&output)
    );
}

/// The commands list every rule of every control, and every axis of every machine; what they print is a file.
#[test]
fn controls_and_machines_are_listed() {
    let listed = stdout(&touchoff(&["controls"]));
    for name in ControlRules::names() {
        let control = ControlRules::named(name).expect("a control");
        assert!(listed.contains(&format!("{name}\n")), "{listed}");
        assert_eq!(stdout(&touchoff(&["controls", name])), control.to_toml());
    }
    let rows = objects(&touchoff(&["controls", "--json"]));
    let keys = Rule::all().filter(|rule| *rule != Rule::OptionalBlocks).count();
    for row in &rows {
        let stated = row["rules"].as_object().map_or(0, |rules| rules.len());
        let open = match row["name"].as_str() {
            Some("fanuc") => 3,
            Some("haas" | "linuxcnc") => 2,
            Some("siemens") => 5,
            Some("heidenhain") => 1,
            _ => 0,
        };
        assert_eq!(stated, keys - open, "{row}");
    }
    let machines = stdout(&touchoff(&["machines"]));
    let trunnion = "A moves the table, from -120 to 30°, home 0, about [1.0, 0.0, 0.0] through [0.0, 0.0, -480.0]";
    assert!(machines.contains(trunnion), "{machines}");
    let unknown = touchoff(&["machines", "9-axis"]);
    assert!(!unknown.status.success() && stderr(&unknown).contains("A-C trunnion"));
}
