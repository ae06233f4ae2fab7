//! What a job states, what a verdict says, and what a program leaves to its next run.

use crate::in_the_way::named;
use crate::scene::{
    ANY, CLEAN, FANUC, FINDINGS, HAAS, HEIDENHAIN, LINUXCNC, NONE, SIEMENS, Scene, rules,
};
use touchoff_verify::gcode::{ControlRules, Rule};
use touchoff_verify::{Gap, JobReport};

/// Every tool with motions is in the verdict.
#[test]
fn a_tool_without_a_checked_motion_is_named() {
    let start = "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG0 Z20.\n";
    for (tool, number) in [("T2", 2), ("T0", 0)] {
        let scene = Scene::new(&format!("{start}G49\n{tool} M6\nG0 X0. Y0.\nZ-5."));
        let mut scene = scene.placed();
        scene.job += &format!("[tool.{number}]\ntool = \"D2Ball\"\n");
        scene.gives(LINUXCNC, NONE, &[&format!("V0301 9 {tool}"), "V0407 9"]);
    }
}

#[test]
fn a_work_offset_far_from_the_part_is_named() {
    let blocks =
        "G43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG0 Z20.\nG55 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG0 Z20.";
    let mut scene = Scene::new(blocks).placed();
    scene.job += "G55 = [200, 0, -400]\n";
    scene.gives(LINUXCNC, NONE, &["V0603 6 G55"]);
    scene.job = scene.job.replace("[200, 0, -400]", "[1, 0, -400]");
    scene.gives(LINUXCNC, CLEAN, &[]);
}

#[test]
fn a_feed_needs_a_spindle_that_turns_the_right_way() {
    let feed = "G0 X-6. Y0. Z20.\nG1 X4. Z1. F100.\nM30\n";
    for (start, verdict, patterns) in [
        ("S900 M3", CLEAN, &[][..]),
        ("S900 M13", NONE, &["P0115 2 M13"]),
        ("S900 M3\nM5", FINDINGS, &["V0106 feeds with the spindle off"]),
        ("M3", FINDINGS, &["V0106 4 no speed of the spindle"]),
        ("S0 M3", FINDINGS, &["V0106 feeds with the spindle off"]),
        ("S900 M4", FINDINGS, &["V0106 the wrong way round"]),
        ("", NONE, &["V0305 4"]),
    ] {
        let scene = Scene::of(&format!("G21 G90 G54\n{start}\n{feed}"));
        scene.gives(LINUXCNC, verdict, patterns);
    }
    let mut left = Scene::of(&format!("G21 G90 G54\nT1 M6\nS900 M4\nG43 H1\n{feed}"));
    left.gives(LINUXCNC, FINDINGS, &["V0106 the wrong way round"]);
    left.job = left.job.replace("LENGTH", "hand = \"left\"\nLENGTH");
    left.gives(LINUXCNC, CLEAN, &[]);
    // A tap cuts a thread of its own hand.
    for (hand, pitch, verdict) in [
        ("left", "+", FINDINGS),
        ("left", "-", CLEAN),
        ("right", "-", FINDINGS),
        ("right", "+", CLEAN),
    ] {
        let text = format!(
            "BEGIN PGM A MM\nTOOL CALL 1 Z S900\nL Z+20 R0 FMAX M3\nL X-60 Y+0 R0 FMAX\n\
             CYCL DEF 207 TAP Q200=+5 Q201=-20 Q239={pitch}1 Q203=+0 Q204=+20\nCYCL CALL\nM30\nEND PGM A MM\n"
        );
        let mut tap = named("a.h", &text).placed().with("anyway = true");
        tap.job = tap.job.replace("length = 50", &format!("length = 50\nhand = \"{hand}\""));
        tap.gives(HEIDENHAIN, verdict, if verdict == CLEAN { &[] } else { &["V0106 6"] });
    }
    // A stop stops the spindle of a Haas, and not that of LinuxCNC.
    let stop = Scene::of(&format!("G21 G90 G54\nS900 M3\nM0\n{feed}"));
    stop.gives(LINUXCNC, CLEAN, &[]);
    stop.gives(HAAS, FINDINGS, &["V0106 feeds with the spindle off"]);
    stop.gives(
        ANY,
        FINDINGS,
        &["V0106 feeds with the spindle off", "V0106 5 under stop = \"stops spindle\""],
    );
    let heidenhain = Scene::of(&format!("G71 G90\nS900 M3\nM0\n{feed}"));
    let heidenhain_words = ["V0106 feeds with the spindle off"];
    heidenhain.gives(HEIDENHAIN, FINDINGS, &heidenhain_words);
    // M6 stops the spindle without a change of the tool, too.
    let change = Scene::of(&format!("G71 G90\nT1\nS900 M3\nM6\n{feed}"));
    change.gives(HEIDENHAIN, FINDINGS, &heidenhain_words);
    let order =
        Scene::of(&format!("G21 G90 G54\nG0 X-6. Y0. Z20.\nG1 X4. Z1. F100.\nS900 M3\n{feed}"));
    order.gives(LINUXCNC, FINDINGS, &["V0106 feeds with the spindle off"]);
}

#[test]
fn what_a_program_leaves_out_at_its_start_is_named() {
    let blocks = "G0 X-6. Y0. Z20.\nG1 X4. Z1.";
    let scene = Scene::of(&format!("G90 G54 S900 M3 F100.\n{blocks}\nM30\n"));
    scene.gives(ANY, NONE, &["V0303 2 G20", "V0303 2 `unit`"]);
    scene.gives(LINUXCNC, CLEAN, &[]);
    let scene = Scene::of(&format!("G90 G21 S900 M3 F100.\n{blocks}\nM30\n"));
    scene.gives(ANY, NONE, &["V0304 2", "V0304 2 `start_offset`"]);
    scene.gives(SIEMENS, NONE, &["P0119 2 G54"]);
    scene.gives(LINUXCNC, CLEAN, &[]);
}

/// A collision is one however far it is from the part.
#[test]
fn a_collision_far_from_the_part_is_a_finding() {
    let blocks = "G0 X100. Y0. Z20.\nG1 Z5.\nG0 Z20.";
    let scene = Scene::new(blocks).obstacle([95.0, -5.0, 0.0], [105.0, 5.0, 10.0]);
    scene.gives(LINUXCNC, FINDINGS, &["V0101 3 the clamp"]);
    let free = Scene::new(blocks);
    free.gives(LINUXCNC, NONE, &["V0203"]);
}

/// Further work offsets have the origins that the job states by the names of the controls.
#[test]
fn further_work_offsets_are_stated() {
    for (control, block, name) in [
        (HAAS, "G154 P5", "\"G154 P5\""),
        (HAAS, "G114", "\"G154 P5\""),
        (HAAS, "G154 P5", "G114"),
        (FANUC, "G54.1 P5", "\"g54.1 p5\""),
    ] {
        let text = format!("{block}\nG0 X-100. Y0. Z20.\nG1 Z-1. F100.\nG0 Z20.");
        let mut scene = Scene::new(&text).placed();
        scene.gives(control, NONE, &["K0807 3"]);
        // 100 mm beside G54, so that the block is cut at its middle.
        let origin = format!("[work_offsets]\n{name} = [100, 0, -400]\n");
        scene.job = scene.job.replace("[work_offsets]\n", &origin);
        scene.gives(control, FINDINGS, &["V0101 4"]);
    }
    let mut scene = Scene::new("G0 Z20.").placed();
    let plain = scene.job.clone();
    for (names, said) in [
        ("\"G154 P0\" = [1, 2, 3]", "J0106 `G154 P0`"),
        ("\"G154 P301\" = [1, 2, 3]", "J0106 `G154 P301`"),
        ("G114 = [1, 2, 3]\n\"G54.1 P5\" = [1, 2, 3]", "J0106"),
        ("G130 = [1, 2, 3]", "J0106 `G130`"),
        ("G114 = [1, 2]", "J0106 `G114`"),
    ] {
        scene.job = plain.replace("[work_offsets]\n", &format!("[work_offsets]\n{names}\n"));
        scene.gives(HAAS, NONE, &[said]);
    }
}

/// A program in Klartext with two presets goes to two places of one part; a preset that is not stated is named.
#[test]
fn presets_of_klartext_are_work_offsets() {
    let text = "0 BEGIN PGM A MM\nCYCL DEF 247 DATUM ~\n Q339=+1\nTOOL CALL 1 Z S900\nL X-6 Y+0 FMAX M3\nL Z+20 FMAX\n\
                CYCL DEF 247 DATUM ~\n Q339=+2\nL X+0 Y+0 FMAX\nL Z-1 F100\nL Z+20 FMAX\nM30\nEND PGM A MM\n";
    let scene = |presets: &str| {
        let mut scene = Scene::of(text).placed();
        scene.file = "a.h";
        let stated = "[work_offsets]\nG55 = [3, 0, -400]\n";
        scene.job = scene.job.replace("[work_offsets]\n", stated) + presets;
        scene
    };
    scene("").gives(
        ANY,
        NONE,
        &["P0115 7 another preset than the one before", "P0115 7 `presets`"],
    );
    scene("[presets]\n1 = \"G54\"\n").gives(
        ANY,
        NONE,
        &["P0115 7 a preset whose work offset is not stated"],
    );
    scene("[presets]\n1 = \"G54\"\n2 = \"X\"\n").gives(ANY, NONE, &["J0212 `2`"]);
    scene("[presets]\n1 = \"G54\"\n2 = \"G55\"\n").gives(
        ANY,
        FINDINGS,
        &["V0101 10", "V0101 10 at (3.0000, 0.0000"],
    );
}

/// Too many rules at once that are not stated are no verdict.
#[test]
fn too_many_readings_name_the_rules() {
    let blocks = "G0 X-6 Y0. Z2.\n/G0 X5.\nG81 X-6 Y0. Z1. R6.\nX6. ; G0 X1.\nG80\nM0\nG1 Z2.";
    let scene = Scene::new(blocks);
    let words = ["K0901", "K0901 `whole_numbers`", "K0901 `cycle_below_r`"];
    scene.gives(ANY, NONE, &words);
}

/// The page has a row for each rule, with what each control does.
#[test]
fn the_page_about_controls_states_every_rule() {
    let page = include_str!("../../../docs/controls.md");
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
        scene.gives(LINUXCNC, FINDINGS, &["V0103 the clamp"]);
    }
    let other = Scene::new(&format!("{start}G43 H7 Z45.\nX6.\nG1 X5.")).placed();
    other.gives(LINUXCNC, NONE, &["V0408 5 H7"]);
}

/// What is in force at the end of a program is what its next run begins with, where the control keeps it.
#[test]
fn what_a_program_leaves_in_force_is_said() {
    let begin = "G21 G90 G54 S9000 M3 F100.\nG0 X-6. Y0. Z20.\nG1 X-4. Z1.\nG0 Z20.\n";
    let left = |end: &str, control| {
        let checked = Scene::of(&format!("{begin}{end}")).check(control);
        checked.assert(CLEAN, &[], end);
        checked.rows.into_iter().find(|row| row.code == "V0516").map(|row| row.text)
    };
    for (end, control, words) in [
        ("G91 G28 Z0.\nM30\n", FANUC, Some("G91 in force")),
        ("G91 G28 Z0.\nM30\n", LINUXCNC, None),
        ("G91 G28 Z0.\nG90\nM30\n", FANUC, None),
        ("G52 X1.\nM30\n", LINUXCNC, Some("G52 in force")),
        ("G92 X1.\nM30\n", FANUC, Some("G92 in force")),
        ("G92 X1.\nM30\n", LINUXCNC, None),
        ("G98 G81 X-4. Z12. R15.\nM30\n", FANUC, Some("G81 without G80 in force")),
        ("G68 X0. Y0. R30.\nM30\n", FANUC, Some("G68 in force")),
        ("M30\n", FANUC, None),
    ] {
        let said = left(end, control);
        assert_eq!(said.is_some(), words.is_some(), "{end}: {said:?}");
        assert!(said.is_none_or(|said| words.is_some_and(|words| said.contains(words))), "{end}");
    }
}

/// A program that begins with a return along one axis is followed from its first position on.
#[test]
fn a_program_begins_with_a_return_along_one_axis() {
    for first in ["G91 G28 Z0.\nG90", "G91 G28 X0. Y0. Z0.\nG90", "G53 G0 Z0."] {
        let blocks = format!(
            "{first}\nT1 M6\nS9000 M3\nG0 X-6. Y0.\nG43 H1 Z20.\nG1 X4. Z1.\nG0 Z20.\nG91 G28 Z0."
        );
        Scene::new(&blocks).placed().gives(LINUXCNC, CLEAN, &[]);
        Scene::new(&blocks).gives(LINUXCNC, CLEAN, &[]);
    }
}

/// Thin tools and necks, which pass between the points of a stock.
#[test]
fn a_tool_that_is_thinner_than_the_points_of_the_stock_are_apart_is_named() {
    let pin = "line to (0.5, 0), (0.5, 40), (0, 40) as pin cutting;";
    let necked = "line to (3, 0), (3, 3) as disc cutting; line to (0.75, 3), (0.75, 30) as neck; \
                  line to (3, 30), (3, 40), (0, 40) as shank;";
    // A saw has a disc as thin beside its wide arbor.
    let saw =
        "line to (30, 0), (30, 0.8), (8, 0.8) as disc cutting; line to (8, 40), (0, 40) as arbor;";
    for (profile, spacing, verdict, pattern) in [
        (pin, 1.0, NONE, "V0604 4 T1"),
        (saw, 1.0, FINDINGS, "V0604 4 T1"),
        (pin, 0.4, FINDINGS, "V0110 5 pin"),
        (necked, 1.0, NONE, "V0604 4 T1"),
        (necked, 0.5, FINDINGS, "V0110 5 neck"),
    ] {
        let text = format!("tool Pin {{ units mm; profile {{ start (0, 0); {profile} }} }}");
        let mut scene = Scene::new("T1 M6\nS900 M3\nG0 X-30. Y0. Z5.3\nX30.\nZ60.\nG1 X29.");
        scene = scene.with_file("pin.tool", text);
        scene.job = scene.job.replace("D2Ball", "pin.tool");
        scene.job +=
            &format!("[stock]\nbox = [[-20, -20, 12], [20, 20, 20]]\nspacing = {spacing}\n");
        scene.gives(LINUXCNC, verdict, &[pattern]);
    }
}

#[test]
fn a_finding_in_a_file_of_subprograms_names_the_call_and_its_line() {
    let pass = "(PASS)\nG0 X0. Y0.\nG1 Z-1.\nM99\n";
    let scene = Scene::new("T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nM98 P9001\nG0 Z20.");
    scene.gives(HAAS, NONE, &["P0126 5 O9001"]);
    let scene = scene.placed().with("subprograms = [\"O9001.nc\"]").with_file("O9001.nc", pass);
    scene.gives(HAAS, FINDINGS, &["V0101 5 T1", "V0101 5 (O9001.nc, line 3)"]);
    let within = |scene: &Scene, pattern: &str| {
        let checked = scene.check(HAAS);
        let row = checked.rows.into_iter().find(|row| row.is(pattern)).expect(pattern);
        row.within
    };
    let line = |line| Some(("O9001.nc".to_owned(), line));
    assert_eq!(within(&scene, "V0101 5 T1"), line(3));
    // Two motions of one call, each with findings of several surfaces.
    let through = "G0 X-6. Y0.\nG1 Z-2.5\nX6.\nX-6.\nG0 Z20.\nM99\n";
    let scene = scene.with_file("O9001.nc", through);
    scene.gives(HAAS, FINDINGS, &["V0101 5 pass right through the part on 2 motions, lines 5;"]);
    // A finding about the machine, too.
    let off = "T1 M6\nS9000 M3\nM5\nG43 H1 G0 X-6. Y0. Z20.\nM98 P9001\nG0 Z20.";
    let scene = Scene::new(off).placed().with("subprograms = [\"O9001.nc\"]");
    let scene = scene.with_file("O9001.nc", "G0 X-6. Y0.\nG1 Z9.\nG0 Z20.\nM99\n");
    scene.gives(HAAS, FINDINGS, &["V0106 6 T1", "V0106 6 (O9001.nc, line 2)"]);
    assert_eq!(within(&scene, "V0106 6"), line(2));
}

/// Gaps in a file of subprograms: a stop, a feed without a length offset, and a return to where nobody knows.
#[test]
fn a_gap_in_a_file_of_subprograms_names_the_call_and_its_line() {
    let scene = Scene::new("G0 X-6. Y0. Z20.\nM98 P9001\nM0");
    let scene = scene.with("subprograms = [\"O9001.nc\"]").with("anyway = true");
    let scene = scene.with_file("O9001.nc", "(PASS)\nG0 X0. Y0.\nG1 Z15.\nM0\nG28 Z15.\nM99\n");
    let patterns = [
        "V0508 3 (2 times) (O9001.nc, line 4)",
        "V0308 3 (O9001.nc, line 3)",
        "V0405 3 (O9001.nc, line 5)",
    ];
    scene.gives(HAAS, CLEAN, &patterns);
    let rows = scene.check(HAAS).rows;
    for (code, line) in [("V0508", 4), ("V0308", 3), ("V0405", 5)] {
        let row = rows.iter().find(|row| row.code == code).expect(code);
        assert_eq!((row.line, &row.within), (3, &Some(("O9001.nc".to_owned(), line))), "{row:?}");
    }
    // One in the program itself has none.
    assert!(rows.iter().any(|row| row.within.is_none()), "{rows:?}");

    // The sentence of a line that is not read names the file by itself.
    let scene = scene.with_file("O9001.nc", "G0 X0. Y0.\nG777\nM99\n");
    scene.gives(HAAS, NONE, &["P0114 3 O9001.nc, line 2: G777"]);
    let rows = scene.check(HAAS).rows;
    let row = rows.iter().find(|row| row.code == "P0114").expect("a line");
    assert_eq!(row.within, Some(("O9001.nc".to_owned(), 2)), "{row:?}");
    assert!(!row.text.contains("(O9001.nc"), "{row:?}");
}

#[test]
fn what_is_not_checked_is_named_without_being_open() {
    let scene = Scene::new("G0 X-6. Y0. Z20.\nM8\nM0\nG1 X4. Z1.");
    // The limits of the axes, the way to the first position, the stop, and positions as those of the tip.
    scene.gives(LINUXCNC, CLEAN, &["V0309", "V0401 2", "V0508 4", "V0308 5"]);
    let is_open = |report: &JobReport<'_>| report.gaps.iter().any(Gap::is_open);
    assert!(!scene.with_report(rules("linuxcnc"), is_open).expect("a result"));
    // Words that change nothing are no gap.
    assert!(!scene.check(LINUXCNC).has("V0501"));
}

/// Each reading of a program keeps its stock: together they have no more points than one may have.
#[test]
fn stocks_of_all_readings_share_a_budget() {
    let check = |values: usize| {
        let mut scene = Scene::new("G0 X[#500] Y0 Z20.").placed();
        let values: Vec<String> = (0..values).map(|k| k.to_string()).collect();
        scene.job += &format!(
            "[stock]\nbox = [[-20, -20, -10], [20, 20, 2]]\nspacing = 0.45\n[variables]\n\"#500\" = [{}]\n",
            values.join(", ")
        );
        scene
    };
    check(100).gives(FANUC, NONE, &["J0407 those of all readings"]);
    assert!(!check(2).check(FANUC).has("J0407"));
}
