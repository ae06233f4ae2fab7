//! What a job states, what a verdict says, and what a program leaves to its next run.

use super::{FANUC, HAAS, LINUXCNC, SIEMENS, Scene};
use crate::bench::{Bench, findings, objects, stderr, stdout, touchoff};
use serde_json::json;
use std::fs;
use touchoff_verify::CYCLE_TIME_ASSUMPTIONS;
use touchoff_verify::gcode::{ControlRules, Rule};

/// Every tool with motions is in the verdict.
#[test]
fn a_tool_without_a_checked_motion_is_named() {
    let start = "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG0 Z20.\n";
    for (tool, words) in
        [("T2", "no motion of T2 is checked"), ("T0", "no motion of T0 is checked")]
    {
        let scene = Scene::new(&format!("{start}G49\n{tool} M6\nG0 X0. Y0.\nZ-5."));
        let mut scene = scene.placed();
        scene.job += "[tool.2]\ntool = \"D2Ball\"\n";
        scene.gives(&LINUXCNC, 2, &[words, "moves without a tool length offset"]);
    }
}

#[test]
fn a_number_that_two_tools_of_a_library_have_is_refused() {
    let scene = Scene::new("T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.");
    let bit = |name: &str| {
        format!(
            "{{\"guid\": \"{name}\", \"type\": \"flat end mill\", \"unit\": \"millimeters\", \"description\": \"{name}\", \
             \"geometry\": {{\"DC\": 6, \"LCF\": 20, \"OAL\": 60, \"LB\": 30, \"SFDM\": 6, \"shoulder-length\": 25}}, \
             \"post-process\": {{\"number\": 1}}}}"
        )
    };
    let library = format!("{{\"version\": 1, \"data\": [{}, {}]}}", bit("one"), bit("two"));
    let library = scene.bench.write("two.json", library);
    let (part, program) = (scene.bench.place("block.stl"), scene.bench.place("a.nc"));
    let common = ["verify", "--part", &part, "--unit", "mm", "--program", &program];
    let verify = |more: &[&str]| touchoff(&[&common, &LINUXCNC[..], more].concat());
    let output = verify(&["--tools", &library]);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("has 2 tools `T1`: `one`, `two`"), "{said}");
    // A folder keeps the numbers of the tools that were imported into it.
    let folder = scene.bench.place("tools");
    for (only, expected) in [("one", 0), ("two", 2)] {
        let imported = touchoff(&["import", &library, "-o", &folder, "--only", only]);
        assert!(imported.status.success(), "{}", stderr(&imported));
        let output = verify(&["--tools", &folder]);
        assert_eq!(output.status.code(), Some(expected), "{}", stderr(&output));
    }
}

#[test]
fn a_work_offset_far_from_the_part_is_named() {
    let blocks =
        "G43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG0 Z20.\nG55 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG0 Z20.";
    let mut scene = Scene::new(blocks).placed();
    scene.job += "G55 = [200, 0, -400]\n";
    scene.gives(&LINUXCNC, 2, &["under G55 the tool never comes within its diameter of the part"]);
    scene.job = scene.job.replace("[200, 0, -400]", "[1, 0, -400]");
    scene.gives(&LINUXCNC, 0, &[]);
}

#[test]
fn a_feed_needs_a_spindle_that_turns_the_right_way() {
    let feed = "G0 X-6. Y0. Z20.\nG1 X4. Z1. F100.\nM30\n";
    let given = |start: &str, status: i32, words: &str| {
        let scene = Scene::of(&format!("G21 G90 G54\n{start}\n{feed}"));
        scene.gives(&LINUXCNC, status, &[words]);
    };
    given("S900 M3", 0, "");
    given("S900 M13", 2, "a brake of a rotary axis on Haas");
    given("S900 M3\nM5", 1, "feeds with the spindle off");
    given("M3", 1, "no speed of the spindle");
    given("S0 M3", 1, "feeds with the spindle off");
    given("S900 M4", 1, "the wrong way round");
    given("", 2, "never starts the spindle");
    let mut left = Scene::of(&format!("G21 G90 G54\nT1 M6\nS900 M4\nG43 H1\n{feed}"));
    left.gives(&LINUXCNC, 1, &["the wrong way round"]);
    left.job = left.job.replace("LENGTH", "hand = \"left\"\nLENGTH");
    left.gives(&LINUXCNC, 0, &[]);
    // A stop stops the spindle of a Haas, and not that of LinuxCNC.
    let stop = Scene::of(&format!("G21 G90 G54\nS900 M3\nM0\n{feed}"));
    stop.gives(&LINUXCNC, 0, &[]);
    stop.gives(&HAAS, 1, &["feeds with the spindle off"]);
    stop.gives(&[], 1, &["feeds with the spindle off", "under stop = \"stops spindle\""]);
    let heidenhain = Scene::of(&format!("G71 G90\nS900 M3\nM0\n{feed}"));
    let heidenhain_words = ["feeds with the spindle off"];
    heidenhain.gives(&["--control", "heidenhain"], 1, &heidenhain_words);
    // M6 stops the spindle without a change of the tool, too.
    let change = Scene::of(&format!("G71 G90\nT1\nS900 M3\nM6\n{feed}"));
    change.gives(&["--control", "heidenhain"], 1, &heidenhain_words);
    let order =
        Scene::of(&format!("G21 G90 G54\nG0 X-6. Y0. Z20.\nG1 X4. Z1. F100.\nS900 M3\n{feed}"));
    order.gives(&LINUXCNC, 1, &["feeds with the spindle off"]);
}

#[test]
fn what_a_program_leaves_out_at_its_start_is_named() {
    let blocks = "G0 X-6. Y0. Z20.\nG1 X4. Z1.";
    let scene = Scene::of(&format!("G90 G54 S900 M3 F100.\n{blocks}\nM30\n"));
    scene.gives(&[], 2, &["no G20 or G21", "state `unit` of the control"]);
    scene.gives(&LINUXCNC, 0, &[]);
    let scene = Scene::of(&format!("G90 G21 S900 M3 F100.\n{blocks}\nM30\n"));
    scene.gives(&[], 2, &["no work offset before a position", "`start_offset`"]);
    scene.gives(&SIEMENS, 2, &["a work offset (G54) before"]);
    scene.gives(&LINUXCNC, 0, &[]);
}

#[test]
fn a_finding_in_a_file_of_subprograms_names_the_call_and_its_line() {
    let scene = Scene::new("T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nM98 P9001\nG0 Z20.");
    scene.bench.write("O9001.nc", "(PASS)\nG0 X0. Y0.\nG1 Z-1.\nM99\n");
    scene.gives(&HAAS, 2, &["a.nc:5: there is no O9001", "name its file in `subprograms`"]);
    let mut scene = scene.placed().with("subprograms = [\"O9001.nc\"]");
    scene.gives(&HAAS, 1, &["a.nc:5: T1", "(O9001.nc, line 3)"]);
    scene.gives(
        &[&HAAS[..], &["--json"]].concat(),
        1,
        &["\"within\":{\"file\":\"O9001.nc\",\"line\":3}"],
    );
    let file = scene.bench.place("a.toml");
    let page = scene.bench.place("report.html");
    let options = ["--control", "haas", "-o", &page];
    let said = stderr(&touchoff(&[&["report", &file][..], &options].concat()));
    let page = std::fs::read_to_string(&page).expect(&said);
    assert!(page.contains("<summary>O9001.nc, lines 1 to 5</summary>"), "{said}");
    assert!(page.contains("&gt; 3  G1 Z-1."));
    // Two motions of one call, each with findings of several surfaces.
    scene.bench.write("O9001.nc", "G0 X-6. Y0.\nG1 Z-2.5\nX6.\nX-6.\nG0 Z20.\nM99\n");
    scene.gives(&HAAS, 1, &["pass right through the part on 2 motions, lines 5;"]);
    scene.job = scene.job.replace("O9001.nc", "O9002.nc");
    scene.gives(&HAAS, 2, &["O9002.nc: cannot be read"]);
    // A finding about the machine, too.
    let off = "T1 M6\nS9000 M3\nM5\nG43 H1 G0 X-6. Y0. Z20.\nM98 P9001\nG0 Z20.";
    let scene = Scene::new(off).placed().with("subprograms = [\"O9001.nc\"]");
    scene.bench.write("O9001.nc", "G0 X-6. Y0.\nG1 Z9.\nG0 Z20.\nM99\n");
    scene.gives(&HAAS, 1, &["a.nc:6: T1 feeds with the spindle off", "(O9001.nc, line 2)"]);
    let json = [&HAAS[..], &["--json"]].concat();
    scene.gives(&json, 1, &["\"within\":{\"file\":\"O9001.nc\",\"line\":2}"]);
}

/// Gaps in a file of subprograms: a stop, a feed without a length offset, and a return to where nobody knows.
#[test]
fn a_gap_in_a_file_of_subprograms_names_the_call_and_its_line() {
    let scene = Scene::new("G0 X-6. Y0. Z20.\nM98 P9001\nM0");
    let scene = scene.with("subprograms = [\"O9001.nc\"]").with("anyway = true");
    scene.bench.write("O9001.nc", "(PASS)\nG0 X0. Y0.\nG1 Z15.\nM0\nG28 X0.\nM99\n");
    let words = [
        "not checked: line 3: motions by hand during the stop are not checked (2 times) (O9001.nc, line 4)",
        "were set with the tool (O9001.nc, line 3)",
        "`home` of its axes (O9001.nc, line 5)",
    ];
    scene.gives(&HAAS, 0, &words);
    let rows = objects(&scene.run(&[&HAAS[..], &["--json"]].concat()));
    for (reason, line) in [("by hand", 4), ("no tool length offset", 3), ("`home` of its axes", 5)]
    {
        let has_reason =
            |row: &&serde_json::Value| row["reason"].as_str().is_some_and(|of| of.contains(reason));
        let row = rows.iter().find(has_reason).expect(reason);
        assert_eq!((&row["kind"], &row["line"]), (&"not-checked".into(), &3.into()), "{row}");
        assert_eq!(row["within"], json!({ "file": "O9001.nc", "line": line }), "{row}");
    }
    // One in the program itself has none.
    assert!(
        rows.iter().any(|row| row["reason"].is_string() && row["within"].is_null()),
        "{rows:?}"
    );
    let (file, page) = (scene.bench.place("a.toml"), scene.bench.place("report.html"));
    let said = stderr(&touchoff(&["report", &file, "--control", "haas", "-o", &page]));
    let page = fs::read_to_string(&page).expect(&said);
    assert!(
        page.contains("during the stop are not checked (2 times) (O9001.nc, line 4)"),
        "{said}"
    );

    // The sentence of a line that is not read names the file by itself.
    scene.bench.write("O9001.nc", "G0 X0. Y0.\nG777\nM99\n");
    scene.gives(&HAAS, 2, &["a.nc:3: O9001.nc, line 2: G777"]);
    let rows = objects(&scene.run(&[&HAAS[..], &["--json"]].concat()));
    let row = rows.iter().find(|row| row["open"] == true).expect("a gap");
    assert_eq!(row["within"], json!({ "file": "O9001.nc", "line": 2 }), "{row}");
    assert!(!row["reason"].to_string().contains("(O9001.nc"), "{row}");
}

/// A collision is one however far it is from the part.
#[test]
fn a_collision_far_from_the_part_has_status_1() {
    let blocks = "G0 X100. Y0. Z20.\nG1 Z5.\nG0 Z20.";
    let scene = Scene::new(blocks).obstacle([95.0, -5.0, 0.0], [105.0, 5.0, 10.0]);
    scene.gives(&LINUXCNC, 1, &["the clamp"]);
    let free = Scene::new(blocks);
    free.gives(&LINUXCNC, 2, &["never comes within the tool's diameter"]);
    // The reason comes before everything else that is said of the program.
    let said = stderr(&free.run(&LINUXCNC));
    assert!(said.find("not verified:") < said.find("program:"), "{said}");
}

/// Further work offsets have the origins that the job states by the names of the controls.
#[test]
fn further_work_offsets_are_stated() {
    for (control, block, name) in [
        ("haas", "G154 P5", "\"G154 P5\""),
        ("haas", "G114", "\"G154 P5\""),
        ("haas", "G154 P5", "G114"),
        ("fanuc", "G54.1 P5", "\"g54.1 p5\""),
    ] {
        let text = format!("{block}\nG0 X-100. Y0. Z20.\nG1 Z-1. F100.\nG0 Z20.");
        let mut scene = Scene::new(&text).placed();
        let arguments = ["--control", control];
        scene.gives(&arguments, 2, &["is unknown: state it"]);
        // 100 mm beside G54, so that the block is cut at its middle.
        let origin = format!("[work_offsets]\n{name} = [100, 0, -400]\n");
        scene.job = scene.job.replace("[work_offsets]\n", &origin);
        scene.gives(&arguments, 1, &["1.0000"]);
    }
    let mut scene = Scene::new("G0 Z20.").placed();
    let plain = scene.job.clone();
    for (names, said) in [
        ("\"G154 P0\" = [1, 2, 3]", "work offset `G154 P0`"),
        ("\"G154 P301\" = [1, 2, 3]", "work offset `G154 P301`"),
        ("G114 = [1, 2, 3]\n\"G54.1 P5\" = [1, 2, 3]", "once for each"),
        ("G130 = [1, 2, 3]", "work offset `G130`"),
        ("G114 = [1, 2]", "work offset `G114`"),
    ] {
        scene.job = plain.replace("[work_offsets]\n", &format!("[work_offsets]\n{names}\n"));
        scene.gives(&["--control", "haas"], 2, &[said]);
    }
}

/// A program in Klartext with two presets goes to two places of one part; a preset that is not stated is named.
#[test]
fn presets_of_klartext_are_work_offsets() {
    let text = "0 BEGIN PGM A MM\nCYCL DEF 247 DATUM ~\n Q339=+1\nTOOL CALL 1 Z S900\nL X-6 Y+0 FMAX M3\nL Z+20 FMAX\n\
                CYCL DEF 247 DATUM ~\n Q339=+2\nL X+0 Y+0 FMAX\nL Z-1 F100\nL Z+20 FMAX\nM30\nEND PGM A MM\n";
    let scene = |presets: &str| {
        let mut scene = Scene::of(text).placed();
        scene.job = scene
            .job
            .replace("a.nc", "a.h")
            .replace("[work_offsets]\n", "[work_offsets]\nG55 = [3, 0, -400]\n");
        scene.job += presets;
        scene.bench.write("a.h", text);
        scene
    };
    scene("").gives(&[], 2, &["another preset than the one before", "in `presets` of the job"]);
    scene("[presets]\n1 = \"G54\"\n").gives(&[], 2, &["a preset whose work offset is not stated"]);
    scene("[presets]\n1 = \"G54\"\n2 = \"X\"\n").gives(&[], 2, &["preset `2`: write its number"]);
    scene("[presets]\n1 = \"G54\"\n2 = \"G55\"\n").gives(
        &[],
        1,
        &["a.h:10: T1", "at (3.0000, 0.0000"],
    );
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

#[test]
fn what_was_not_checked_is_in_the_json() {
    let scene = Scene::new("G0 X-6. Y0. Z20.\nM8\nM0\nG1 X4. Z1.");
    let output = scene.run(&[&LINUXCNC[..], &["--json"]].concat());
    let rows = objects(&output);
    let gaps: Vec<_> = rows.iter().filter(|row| row["kind"] == "not-checked").collect();
    let reasons: Vec<&str> = gaps.iter().filter_map(|row| row["reason"].as_str()).collect();
    assert!(gaps.iter().all(|row| row["open"] == false), "{gaps:?}");
    assert!(findings(&output).is_empty(), "{rows:?}");
    for word in
        ["limits of X, Y and Z", "no position before", "by hand during the stop", "of the tip"]
    {
        assert!(reasons.iter().any(|reason| reason.contains(word)), "{word}: {reasons:?}");
    }
    assert!(!reasons.iter().any(|reason| reason.contains("passed over")), "{reasons:?}");
}

/// 10 mm at 100 mm/min along X and a dwell, after a motion from where nobody knows; then rates, and another reading.
#[test]
fn cycle_times_are_in_the_json() {
    let times = |scene: &Scene, more: &[&str]| {
        let mut rows = objects(&scene.run(&[more, &["--json"]].concat()));
        rows.retain(|row| row["kind"] == "cycle-time");
        rows
    };
    let scene = Scene::new("G0 X-6. Y0. Z20.\nG1 X4.\nG4 P2.\nG0 Z30.");
    let found = times(&scene, &LINUXCNC);
    let [row] = &found[..] else { panic!("{found:?}") };
    let expected = json!({
        "file": row["file"], "kind": "cycle-time", "tool_number": null, "feed_s": 6.0, "rapid_s": null, "dwell_s": 2.0,
        "unknown": 2, "first_unknown_line": 2, "assumptions": CYCLE_TIME_ASSUMPTIONS,
    });
    assert_eq!(*row, expected);
    assert!(row["file"].as_str().is_some_and(|file| file.ends_with("a.nc")), "{row}");

    // 10 mm of Z at 3000 mm/min.
    let mut machine = stdout(&touchoff(&["machines", "3-axis"]));
    for letter in ["X", "Y", "Z"] {
        let line = format!("letter = \"{letter}\"\n");
        machine = machine.replace(&line, &format!("{line}rapid = 3000\n"));
    }
    let scene = scene.with("machine = \"mine.toml\"");
    scene.bench.write("mine.toml", machine);
    let found = times(&scene, &LINUXCNC);
    let rapid = found[0]["rapid_s"].as_f64().expect("rates");
    assert!((rapid - 0.2).abs() < 1e-9 && found[0]["unknown"] == 1, "{found:?}");

    // A program with several readings names the one of which it is the time.
    let scene = Scene::new("G0 X-6. Y0. Z20.\nG81 X-6. Y0. Z10. R15.\nX6.\nG80");
    let under = times(&scene, &[])[0]["under"].clone();
    assert!(under.as_str().is_some_and(|under| under.starts_with("under cycle_return")), "{under}");
}

/// Too many rules at once that are not stated are no verdict.
#[test]
fn too_many_readings_name_the_rules() {
    let blocks = "G0 X-6 Y0. Z2.\n/G0 X5.\nG81 X-6 Y0. Z1. R6.\nX6. ; G0 X1.\nG80\nM0\nG1 Z2.";
    let scene = Scene::new(blocks);
    let words = ["in more than 8 ways", "`whole_numbers` (line 2)", "`cycle_below_r`"];
    scene.gives(&[], 2, &words);
}

#[test]
fn a_wrong_control_is_refused_with_the_nearest_key() {
    let scene = Scene::new("G0 X-6. Y0. Z20.\nG1 X4. Z1.");
    scene.gives(&["--control", "fanac"], 2, &["did you mean `fanuc`?"]);
    let file = ControlRules::named("linuxcnc").expect("a control").to_toml();
    let control = scene.bench.place("c.toml");
    for (from, to, word) in [
        (
            "whole_numbers",
            "whole_number",
            "`whole_number` is no rule: did you mean `whole_numbers`?",
        ),
        ("\nrapid =", "\n#rapid =", "the rule `rapid` is missing"),
        ("\"straight\"", "\"fast\"", "`rapid` is one of \"straight\", \"each axis\""),
    ] {
        fs::write(&control, file.replace(from, to)).expect("a file");
        scene.gives(&["--control", &control], 2, &[word, "c.toml"]);
    }
    fs::write(&control, &file).expect("a file");
    scene.gives(&["--control", &control], 0, &[]);
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
            Some("haas") => 2,
            Some("siemens") => 4,
            Some("heidenhain") => 1,
            _ => 0,
        };
        assert_eq!(stated, keys - open, "{row}");
    }
    let machines = stdout(&touchoff(&["machines"]));
    let trunnion = "A moves the table, from -120 to 30°, home 0, about [1.0, 0.0, 0.0] through [0.0, 0.0, -480.0]";
    assert!(machines.contains(trunnion), "{machines}");
    let unknown = touchoff(&["machines", "4-axis"]);
    assert!(!unknown.status.success() && stderr(&unknown).contains("A-C trunnion"));
}

/// The page has a row for each rule, with what each control does.
#[test]
fn the_page_about_controls_states_every_rule() {
    let page = include_str!("../../../../docs/controls.md");
    for rule in Rule::all().filter(|rule| *rule != Rule::OptionalBlocks) {
        let words = ControlRules::names().map(|name| {
            let control = ControlRules::named(name).expect("a control");
            control.get(rule).map_or("either", |choice| rule.describe(choice)[0])
        });
        let row = format!("| `{}` | {} |", rule.key(), words.collect::<Vec<_>>().join(" | "));
        assert!(page.contains(&row), "{row}");
    }
}

/// The tool of a program that names none is that of its first length offset.
#[test]
fn a_program_without_a_tool_number_moves_its_gauge_point_without_an_offset() {
    let start = "G43 H1 G0 X-6. Y0. Z45.\nG1 X-4. Z1.\nG0 Z45.\n";
    for end in ["G49 Z45.\nX6.\nG1 X5.", "G91 G28 Z0.\nG90 G49 G0 Z45.\nX6.\nG1 X5."] {
        let scene = Scene::new(&format!("{start}{end}")).placed();
        let scene = scene.obstacle([0.0, -2.0, -20.0], [8.0, 2.0, -1.0]).with("anyway = true");
        scene.gives(&LINUXCNC, 1, &["the clamp"]);
    }
    let other = Scene::new(&format!("{start}G43 H7 Z45.\nX6.\nG1 X5.")).placed();
    other.gives(&LINUXCNC, 2, &["with the length offset H7 of another tool"]);
}

/// The state at the end of a program is that in which its next run begins, on some controls.
#[test]
fn a_program_that_ends_otherwise_than_it_begins_is_named() {
    let begin = "G21 G54 S9000 M3 F100.\nG0 X-6. Y0. Z20.\nG1 X-4. Z1.\nG0 Z20.\n";
    let word = "which a control can keep, and its next run is another";
    Scene::of(&format!("{begin}G91 G28 Z0.\nM30\n")).gives(&FANUC, 2, &[word]);
    Scene::of(&format!("{begin}G91 G28 Z0.\nM30\n")).gives(&LINUXCNC, 0, &[]);
    Scene::of(&format!("{begin}G91 G28 Z0.\nG90\nM30\n")).gives(&FANUC, 0, &[]);
    Scene::of(&format!("{begin}G52 X1.\nM30\n")).gives(&LINUXCNC, 2, &[word]);
    Scene::of(&format!("%\n{begin}G91 G0 Z1.\n%\n")).gives(&LINUXCNC, 2, &[word]);
    let cycles = "G81 X-4. Y0. Z1. R3.\nG80\nG99 G81 X-5. Z1. R3.\nG80\nG0 Z20.\nG90\nM30\n";
    Scene::of(&format!("{begin}{cycles}")).gives(&FANUC, 2, &[word]);
    // LinuxCNC keeps the unit and the length offset, of all that M30 leaves.
    let moves = "G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG0 Z20.";
    let unit = format!("G90 G54 S900 M3 F100.\nG43 H1\n{moves}\nG20\nM30\n");
    Scene::of(&unit).gives(&LINUXCNC, 2, &["line 3: the program ends with G20"]);
    let length = format!("{begin}G43 H1\nG0 Z20.\nM30\n");
    Scene::of(&length).gives(&LINUXCNC, 2, &["line 2: the program ends with G43 H1"]);
    let stated = format!("{begin}G0 G90 Z20.\nG20 G55\nM30\n");
    Scene::of(&stated).gives(&LINUXCNC, 0, &[]);
    // G49 at the start moves Z by the length that the run before has left.
    let cancels = "G21 G90 G54 G49\nG0 X-6. Y0.\nG43 H1 Z20.\nS900 M3\nG1 X-4. Z1. F100.\nM30\n";
    Scene::of(cancels).gives(&FANUC, 2, &["line 1: the program ends with G43 H1"]);
    Scene::of(cancels).gives(&HAAS, 2, &["the program ends with G43 H1"]);
    Scene::of(&cancels.replace("M30", "G49\nM30")).gives(&LINUXCNC, 0, &[]);
    // The operator can turn the switch for optional blocks between two runs.
    let moves = "G0 X-6. Y0. Z20.\nG1 X-4. Z1.\nG0 Z20.";
    let switched = Scene::new(&format!("/G52 X0\n{moves}\n/G52 X-8."));
    switched.gives(&LINUXCNC, 2, &["line 3: the program ends with G52"]);
    Scene::new(&format!("/G52 X0\n{moves}")).gives(&LINUXCNC, 0, &[]);
    // A new origin and a shift, which cancel each other where both are kept.
    let both = format!("G43 H1\nG55\n{moves}\nG10 L2 P2 X40. Y0. Z-400.\nG52 X-40.\nG0 X-6.\nG49");
    let mut both = Scene::new(&both).placed();
    both.job += "G55 = [0, 0, -400]\n";
    both.gives(&FANUC, 2, &["the program ends with G10, G52"]);
    both.gives(&LINUXCNC, 0, &[]);
}

/// A program that begins with a return along one axis is followed from its first position on.
#[test]
fn a_program_begins_with_a_return_along_one_axis() {
    for first in ["G91 G28 Z0.\nG90", "G91 G28 X0. Y0. Z0.\nG90", "G53 G0 Z0."] {
        let blocks = format!(
            "{first}\nT1 M6\nS9000 M3\nG0 X-6. Y0.\nG43 H1 Z20.\nG1 X4. Z1.\nG0 Z20.\nG91 G28 Z0."
        );
        Scene::new(&blocks).placed().gives(&LINUXCNC, 0, &[]);
        Scene::new(&blocks).gives(&LINUXCNC, 0, &[]);
    }
}

/// Thin tools and necks, which pass between the points of a stock.
#[test]
fn a_tool_that_is_thinner_than_the_points_of_the_stock_are_apart_is_named() {
    let pin = "line to (0.5, 0), (0.5, 40), (0, 40) as pin cutting;";
    let necked = "line to (3, 0), (3, 3) as disc cutting; line to (0.75, 3), (0.75, 30) as neck; \
                  line to (3, 30), (3, 40), (0, 40) as shank;";
    for (profile, spacing, status, word) in [
        (pin, 1.0, 2, "and may pass through material of any thickness unseen"),
        (pin, 0.4, 1, "pin touches the stock in rapid traverse"),
        (necked, 1.0, 2, "and may pass through material up to a thickness of"),
        (necked, 0.5, 1, "neck touches the stock in rapid traverse"),
    ] {
        let text = format!("tool Pin {{ units mm; profile {{ start (0, 0); {profile} }} }}");
        let mut scene = Scene::new("T1 M6\nS900 M3\nG0 X-30. Y0. Z5.3\nX30.\nZ60.\nG1 X29.");
        scene.bench.write("pin.tool", text);
        scene.job = scene.job.replace("D2Ball", "pin.tool");
        scene.job +=
            &format!("[stock]\nbox = [[-20, -20, 12], [20, 20, 20]]\nspacing = {spacing}\n");
        scene.gives(&LINUXCNC, status, &[word]);
    }
}

/// LinuxCNC keeps the initial level of a series of cycles that no word has ended; others may keep the cycle.
#[test]
fn a_series_of_cycles_is_left_to_the_next_run() {
    let blocks = |end: &str| {
        format!(
            "G91 G28 Z0.\nG90 G43 H1\nG98 G81 X-2. Y0. Z0.5 R3.\nX2.\nG0 X10. Y0. Z20.\n\
             G81 X10. Y0. Z12. R15.\nX14.\n{end}"
        )
    };
    let left = "the program ends with G81 without G80";
    Scene::new(&blocks("")).placed().gives(&LINUXCNC, 2, &[left]);
    let ended = Scene::new(&blocks("G80")).placed().run(&LINUXCNC);
    assert!(!stderr(&ended).contains("without G80"), "{}", stderr(&ended));
}

/// Returns the options that join shards.
fn joined<const N: usize>(files: [&String; N]) -> Vec<&str> {
    files.into_iter().flat_map(|file| ["--checked", file]).collect()
}

/// The report of a job whose shards were checked before is that of the whole check, byte by byte: findings of tools at the part and a
/// fixture, in several readings, and of the stock.
#[test]
fn shards_of_a_job_give_its_report() {
    let mut blocks = "S900 M3\n".to_owned();
    for k in 0..300 {
        let depth = if [40, 41, 200].contains(&k) { -1.0 } else { 3.0 };
        let x = f64::from(k % 20) - 10.0;
        blocks += &format!("G1 X{x:.1} Y{:.1} Z{depth:.1}\n", f64::from(k / 20) - 7.5);
    }
    let mut scene = Scene::new(&blocks).placed().obstacle([8.0, -9.0, 0.0], [12.0, 9.0, 4.0]);
    scene.job += "[stock]\nbox = [[-8, -8, -8], [8, 8, 1]]\nspacing = 0.5\n";
    for control in [&LINUXCNC[..], &[]] {
        let whole = scene.run(&[control, &["--json"]].concat());
        assert_eq!(whole.status.code(), Some(1), "{}", stderr(&whole));
        for count in [1, 3, 7] {
            let mut files = Vec::new();
            for number in 1..=count {
                let file = scene.bench.place(&format!("{number}-of-{count}.json"));
                let shard = format!("{number}/{count}");
                let run = scene.run(&[control, &["--shard", &shard, "-o", &file]].concat());
                assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
                assert!(stdout(&run).contains(&format!("shard {shard}: findings in")));
                files.insert(0, file);
            }
            let checked = files.iter().flat_map(|file| ["--checked", file]);
            let options: Vec<&str> =
                control.iter().copied().chain(["--json"]).chain(checked).collect();
            let joined = scene.run(&options);
            assert_eq!(joined.status.code(), Some(1));
            assert_eq!((stdout(&joined), stderr(&joined)), (stdout(&whole), stderr(&whole)));
        }
    }
    let [one, two, three] =
        [1, 2, 3].map(|number| scene.bench.place(&format!("{number}-of-3.json")));
    scene.gives(&joined([&one, &three]), 2, &["1 of 3 shards are left, the first of them 2/3"]);
    scene.gives(&joined([&one, &two, &one]), 2, &["are both shard 1/3"]);
    let other = scene.bench.place("2-of-7.json");
    scene.gives(&joined([&one, &other]), 2, &["is shard 2/7, and"]);
    let text = std::fs::read_to_string(&two).expect("a shard");
    for changed in [text.replace("2/3", "3/3"), text[..text.len() / 2].to_owned(), "{}".to_owned()]
    {
        let file = scene.bench.write("changed.json", changed);
        scene.gives(&joined([&one, &file, &three]), 2, &["changed.json is damaged"]);
    }
    scene.bench.write("a.nc", super::program(&blocks.replace("Z-1.0", "Z-1.1")));
    scene.gives(&joined([&one, &two, &three]), 2, &["1-of-3.json is of another job"]);
}
