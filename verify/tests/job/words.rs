//! Words, numbers and text that controls read in different ways.

use crate::in_the_way::named;
use crate::scene::{
    ANY, CLEAN, FANUC, FINDINGS, HAAS, HEIDENHAIN, LINUXCNC, NONE, SIEMENS, Scene, program, rules,
};
use std::collections::BTreeMap;
use touchoff_verify::JobReport;
use touchoff_verify::gcode::{Choice, ControlSetup, Rule, read};

#[test]
fn numbers_without_a_point_are_units_or_increments() {
    let blocks = "G0 X-6. Y0. Z20.\nG0 Z5\nX6.\nG1 X4. Z1.";
    let scene = Scene::new(blocks).obstacle([-1.0, -3.0, 0.5], [1.0, 3.0, 3.0]);
    scene.gives(
        ANY,
        FINDINGS,
        &["V0101 4 the clamp", "V0101 4 under whole_numbers = \"increments\""],
    );
    scene.gives(LINUXCNC, CLEAN, &[]);
    scene.gives(FANUC, FINDINGS, &["V0101 4 the clamp"]);
}

/// A Haas may read a whole number after R or Q as units, where those of axes are increments.
#[test]
fn a_whole_number_after_r_is_either_on_haas() {
    let blocks = "G0 X-6. Y0. Z20.\nG68 X0. Y0. R90\nX12. Y6. Z1.\nG1 X10.\nG69";
    let scene = Scene::new(blocks).obstacle([-8.0, 8.0, -1.0], [-4.0, 15.0, 9.0]);
    let scene = scene.with("anyway = true");
    scene.gives(HAAS, FINDINGS, &["V0103 5 the clamp", "V0103 5 under whole_radii = \"units\""]);
    scene.gives(FANUC, CLEAN, &[]);
    scene.gives(ANY, FINDINGS, &["V0103 5 the clamp"]);
    // The increment of a corner, too: 5 mm cut off 2.07 mm of it.
    let corner = "G0 X-6. Y-9. Z20.\nG1 Z1.\nX9. ,R5\nY9.\nG0 Z20.";
    let corner = Scene::new(corner).obstacle([6.5, -6.9, -1.0], [6.9, -6.5, 9.0]);
    corner.with("anyway = true").gives(HAAS, FINDINGS, &["V0101 under whole_radii = \"units\""]);
}

#[test]
fn text_after_a_semicolon_is_a_comment_or_a_block() {
    let blocks =
        "G0 X-6. Y0. Z20.\nG0 X0. Z20.; G1 Z-1. ; G0 Z20.\nG1 X1. Z19. ; a comment, G1 Z-1.";
    let scene = Scene::new(blocks).with("anyway = true");
    scene.gives(ANY, FINDINGS, &["V0101 3 ball", "V0101 3 under semicolon = \"end of block\""]);
    scene.gives(LINUXCNC, CLEAN, &[]);
    scene.gives(HAAS, FINDINGS, &["V0101 3 ball"]);
}

#[test]
fn another_program_in_the_file_is_not_passed_over() {
    let one = program("G0 X-6. Y0. Z20.\nG1 X4. Z1.");
    let other = program("G0 X0. Y0. Z20.\nG1 Z-1.");
    for text in [
        format!("%\nO1\n{one}%\n%\nO2\n{other}%\n"),
        format!("%\nO1\n{one}O2\n{other}%\n"),
        format!("%\n{one}%\n{other}"),
    ] {
        let scene = Scene::of(&text);
        scene.gives(LINUXCNC, NONE, &["V0512"]);
    }
    // Neither a program that begins anew, nor a subprogram before the main program, nor its end in one, nor an old title hides it.
    let again = one.replace("M30", "M99");
    let ends_inside = one.replace("M30", "M98 P7");
    for text in [
        format!("%\nO1\n{again}O2\n{other}%\n"),
        format!("%\nO9\nG0 X5.\nM99\nO2\n{}%\n", other.replace("M30", "M98 P9\nM30")),
        format!("%\nO1\n{ends_inside}O7\nG1 X5.\nM30\nO2\n{other}%\n"),
        format!("%\nO1\n{one}:2\n{other}%\n"),
        format!("%\nO9\nT1 M6\nG0 X5.\nM99\nO2\n{}%\n", other.replace("M30", "M98 P9\nM99")),
        format!("%\nO1\n{one}O0002 {other}%\n"),
        format!("%\n<PART>\n{one}<OTHER>\n{other}%\n"),
    ] {
        Scene::of(&text).gives(FANUC, NONE, &["V0512"]);
    }
    Scene::of(&format!("%\n<PART>\n{one}%\n")).gives(FANUC, CLEAN, &[]);
    // A program is called by its title, wherever it stands.
    let holes = "<DRILLS>\nG1 X5.\nM99\n<POCKET>\nG1 X0. Z-1.\nM99\n";
    let calls = one.replace("M30", "M98 <POCKET>\nM30");
    let own = Scene::of(&format!("%\nO1\n{calls}{holes}%\n"));
    own.gives(FANUC, FINDINGS, &["V0101"]);
    let other = Scene::of(&format!("%\nO1\n{calls}%\n")).with("subprograms = [\"POCKET.nc\"]");
    let other = other.with_file("POCKET.nc", format!("%\n{holes}%\n"));
    other.gives(FANUC, FINDINGS, &["V0101"]);
    // Nor is one of another language.
    let pgm = |name: &str, z: &str| {
        format!(
            "BEGIN PGM {name} MM\nTOOL CALL 1 Z S1000\nL X-6 Y+0 Z+20 R0 FMAX M3\nL Z{z} F100\nL Z+20 FMAX\nM30\nEND PGM {name} MM\n"
        )
    };
    let two = named("a.h", &(pgm("A", "+1") + &pgm("B", "-1")));
    two.gives(HEIDENHAIN, NONE, &["V0512"]);
    let mpf = |name: &str, z: &str| {
        format!(
            "%_N_{name}_MPF\nG17 G90 G54 G71 G94\nT1 M6\nD1\nS900 M3\nG0 X-6 Y0 Z20\nG1 Z{z} F100\nG0 Z20\nM30\n"
        )
    };
    let two = named("a.mpf", &(mpf("OP10", "1") + &mpf("OP20", "-1")));
    two.gives(SIEMENS, NONE, &["V0512"]);
    let sub = format!(
        "%\nO1\n{}O7\nG1 X5.\nM99\n%\n(made by a post)\n",
        one.replace("M30", "M98 P7\nM30")
    );
    Scene::of(&sub).gives(LINUXCNC, CLEAN, &[]);
}

/// Blocks that begin with `/`: the switch is the operator's, and both positions are checked unless the job states one.
#[test]
fn optional_blocks_are_checked_with_and_without() {
    let blocks = "G0 X-6. Y0. Z20.\n/G0 X20.\nG1 Z-1.\nG1 X19.\nG0 Z20.";
    let scene = Scene::new(blocks).with("anyway = true");
    scene.gives(LINUXCNC, FINDINGS, &["V0101 5 under optional_blocks = \"left out\""]);
    let scene = scene.with("block_delete = false");
    scene.gives(LINUXCNC, CLEAN, &[]);
}

#[test]
fn words_of_heidenhain_are_not_read_as_those_of_others() {
    let heidenhain = HEIDENHAIN;
    let own = Scene::of("G21 G90 S9000 M3 F100.\nG0 X-6. Y0. Z20.\nG1 X4. Z1.\nM30\n");
    own.gives(heidenhain, NONE, &["P0115 1 G21"]);
    let own = Scene::of("G71 G90 S9000 M3 F100.\nG0 X-6. Y0. Z20.\nG1 X4. Z1.\nM30\n");
    own.gives(heidenhain, CLEAN, &[]);
    // The head states the unit, and the last line repeats it.
    let own = "%PLATE G71 *\nN10 G90 S9000 M3 F100.\nN20 G0 X-6. Y0. Z20.\nN30 G1 X4. Z1.\nN99999999 %PLATE G71 *\n";
    Scene::of(own).gives(heidenhain, CLEAN, &[]);
    let fault = own.replace("N20 G0", "N20 G0 M91");
    Scene::of(&fault).gives(heidenhain, NONE, &["P0114 3 M91"]);
    // I and J are the pole: an arc about the origin.
    let arc = Scene::of("G71 G90 S9000 M3 F100.\nG0 X-6. Y0. Z1.\nG2 X6. Y0. I0. J0.\nM30\n");
    arc.gives(heidenhain, CLEAN, &[]);
    arc.gives(LINUXCNC, NONE, &["P0115 1 G71"]);
}

/// Words of Heidenhain whose order in a block matters, or that keep what they leave out.
#[test]
fn words_of_heidenhain_depend_on_their_order() {
    let begin = "G71 G90 S9000 M3 F100.\nG0 X-6. Y0. Z20.\nG1 X-4. Z1.\n";
    for (blocks, word) in [
        ("G1 X6. G91 Y0. Z0.", "P0120 4 it holds for the coordinates after it"),
        ("G2 X-10. Y20. I-10.", "P0120 4 G2"),
        ("M89", "P0115 4 M89"),
    ] {
        let scene = Scene::of(&format!("{begin}{blocks}\nM30\n"));
        scene.gives(HEIDENHAIN, NONE, &[word]);
    }
    // The head is a title for others.
    let head = Scene::of("%P G71\nG90 G54 S9000 M3 F100.\nG0 X-6. Y0. Z20.\nG1 X-4. Z1.\nM30\n");
    head.gives(HEIDENHAIN, NONE, &["P0115 2 G54"]);
    let low = |report: &JobReport<'_>| report.pairs[0].report.approach.program[0].x;
    let low = head.with_report(rules("haas"), low).expect("a result");
    assert!((low + 152.4).abs() < 1e-9, "read in inches: {low}");
    let edge = Scene::new("D1\nG0 X-6. Y0. Z20.\nG1 X-4. Z1.\nD0\nG0 X6.").placed();
    edge.gives_natively(NONE, &["P0119 5 D0"]);
}

#[test]
fn a_call_that_controls_read_in_two_ways_is_refused() {
    let text = "G21 G90 G54 S9000 M3 F100.\nG0 X-6. Y0. Z20.\nM98 P20100\nM30\nO0100\nG91 G0 X3.\nG90\nM99\n\
                O20100\nG91 G0 X1.\nG90\nM99\n";
    Scene::of(text).gives(
        ANY,
        NONE,
        &["P0120 3 its last four digits are the number of a program, too"],
    );
    // T alone changes the tool of a Heidenhain.
    let text = "G71 G90 S9000 M3 F100.\nT1\nS9000 M3\nG0 X-6. Y0. Z20.\nG1 X4. Z1.\nT3\nS9000 M3\nG1 X5.\nM30\n";
    Scene::of(text).gives(HEIDENHAIN, NONE, &["J0103 8 T3"]);
    // The first of many tools without a file are named.
    let tools: String = (2..1000).map(|number| format!("T{number} M6\nG0 X1.\n")).collect();
    let many = format!("G21 G90 G54 S900 M3\nG0 X-6. Y0. Z20.\n{tools}M30\n");
    Scene::of(&many).gives(HAAS, NONE, &["J0103 T22 and 977 more tools"]);
}

/// Words that controls read in ways that are not followed are refused, or allow no verdict.
#[test]
fn other_words_on_which_controls_differ_are_refused() {
    let begin = "G0 X-6. Y0. Z20.\nG1 X4. Z1.\n";
    for (blocks, word) in [
        ("G99 G81 X4. Z0.5 R2.\nG20 X0.1", "P0120 5 G81"),
        ("T1 M6\nS900 M3\nG91 G43 H1 Z20.", "P0120 6 Z"),
        ("/1 G0 X5.\n/2 G0 X6.", "V0513 5"),
        ("G0 X0. Y0. Z20.\nG2 X0.02 Y0. I10. J0.", "V0514 5"),
        ("G0 Z30.\rG0 X5.", "P0102 4"),
        ("G91 G28 X0. Y0. Z0.\nG0 X-10.\nG90", "V040"),
        ("G53 G0 Z-30.\nG53 G0 X10.\nG53 G0 X0.", "V040"),
    ] {
        Scene::new(&format!("{begin}{blocks}")).gives(LINUXCNC, NONE, &[word]);
    }
    // The way home after G49 is the machine's, as that before it is. Other motions without the offset are not.
    let home = format!("T1 M6\nS900 M3\nG43 H1 {begin}G0 Z20.\nG49\nG53 G0 Z0.\n");
    let reference = ["V040"];
    Scene::new(&home).gives(LINUXCNC, CLEAN, &reference);
    Scene::new(&format!("{home}G53 G0 X0. Y0.\n")).gives(LINUXCNC, CLEAN, &reference);
    let low = home.replace("G53 G0 Z0.", "G53 G0 Z-30.");
    Scene::new(&low).gives(LINUXCNC, NONE, &["V0407 8"]);
    // Text after a semicolon, in ways that do not look like a block at first sight.
    for text in ["X0. ;;Z-1.", "X0. ; (a) Z-1.", "X0. ; /Z-1.", "X0. ; #1=2 ; Z-1. ; NOTE A"] {
        let scene = Scene::new(&format!("G0 X-6. Y0. Z20.\nG1 X-4. Z1.\n{text}\nG0 Z20."));
        let scene = scene.with("block_delete = false\nanyway = true");
        scene.gives(LINUXCNC, CLEAN, &[]);
        scene.gives(HAAS, FINDINGS, &["V0101 4 ball"]);
        scene.gives(ANY, FINDINGS, &["V0101 4 under semicolon = \"end of block\""]);
    }
    let scene = Scene::new(&format!("{begin}X5. ; G65 P100")).with("anyway = true");
    scene.gives(HAAS, NONE, &["P0126 4"]);
    // The number of repeats is no length.
    let repeats = Scene::new(&format!("{begin}G99 G91 G81 X0.1 Z-0.2 R-0.1 K2\nG80 G90"));
    repeats.with("anyway = true").gives(FANUC, CLEAN, &[]);
}

/// Words on which controls differ: each ends without a verdict, with the word that decides it.
#[test]
fn words_that_controls_execute_in_different_ways_are_refused_or_named() {
    let begin = "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\n";
    for (blocks, word) in [
        // Fanuc moves in rapid traverse, and by a dog-leg.
        ("G53 Z0.", "P0120 6 G53"),
        ("G0 Z20.\nT2\nT3 M6", "P0120 8 another tool is staged"),
        ("G0 Z20.\nT1 M6 X5.", "P0120 7 M6"),
        ("M98 P7 G0 Z20.\nM30\nO7\nM99", "P0120 6 M98"),
        (";py,self.execute(\"G0 X5\")", "P0115 6 a comment whose Python LinuxCNC executes"),
        ("( PY,a=1)", "P0115 6 a comment whose Python LinuxCNC executes"),
        // Rigid tapping leaves the spindle standing.
        ("G0 Z20.\nG84 X4. Z1. R2.\nG80\nG1 X5.", "V0306 9 M3"),
    ] {
        Scene::new(&format!("{begin}{blocks}")).gives(LINUXCNC, NONE, &[word]);
    }
    let tap = format!("{begin}G0 Z20.\nG84 X4. Z1. R2.\nG80\nS9000 M3\nG1 X5.");
    Scene::new(&tap).gives(LINUXCNC, CLEAN, &[]);
    // Native programs of Sinumerik shift by G58 and G59.
    let text = "G21 G90 G59 S9000 M3 F100.\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nM30\n";
    let mut shift = Scene::of(text).placed();
    shift.job += "G59 = [1, 0, -400]\n";
    shift.gives(ANY, NONE, &["V0503 1 `dialect`"]);
    shift.gives(SIEMENS, NONE, &["P0115 1 G59"]);
    // Words that move nothing, and the end of a block of Heidenhain.
    let passed = Scene::new(&format!("{begin}G103 P1\nG187 P2 E0.02\nM83\nM84\nG0 Z20.*\n"));
    passed.with("anyway = true").gives(HAAS, CLEAN, &[]);
}

/// Words at which a control stops with an error: what the program has set stays for the next one.
#[test]
fn words_at_which_a_control_stops_are_refused() {
    let begin = "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG0 Z20.\n";
    for (block, word) in [
        ("G103 P1", "P0115 7 G103"),
        ("G43.4 H1", "P0115 7 G43.4"),
        ("G69", "P0115 7 G69"),
        ("G94\nG1 X5.", "P0122 8 G1"),
        ("G82 X4. Z1. R2. P1\nG81 X5. Z1.", "P0119 8 G81"),
        ("G81 X4. Z1. R2.\nX5. P1", "P0118 8 P"),
        ("M29 S900\nG18\nG84 X4. Y1. Z1. R2.", "P0115 7 M29"),
        ("G18\nG84 X4. Y1. Z1. R2.", "P0120 8 G84"),
        ("M29 S100", "P0115 7 M29"),
        ("M62", "P0119 7 M62"),
        ("G4 X1.", "P0119 7 G4"),
        ("G82 X4. Z1. R2.", "P0119 7 G82"),
        ("G81 X4. Z1. R2. K2", "P0118 7 K"),
        ("M4 S100\nG74 X4. Z1. R2. L2", "P0118 8 L"),
        ("D1", "P0118 7 D"),
        ("S-100", "P0106 7 S-100"),
        ("G0 G28 Z0.", "P0117 7 G28"),
        ("M8 M9", "P0117 7 M8"),
        ("M3 M5", "P0117 7 M3"),
    ] {
        Scene::new(&format!("{begin}{block}")).gives(LINUXCNC, NONE, &[word]);
    }
    let passed =
        "G61\nG64 P0.01\nM7\nM8\nM9\nM62 P1\nG4 P0.5\nG82 X4. Z1. R2. P1\nX5.\nG80\nG0 Z20.";
    Scene::new(&format!("{begin}{passed}")).gives(LINUXCNC, CLEAN, &[]);
    Scene::new(&format!("{begin}G61.1")).gives(FANUC, NONE, &["P0115 7 G61.1"]);
    for (control, blocks, word) in [
        // Without the digits below the increment the centre is 0.28 mm farther.
        (FANUC, "X-100.\nG2 X100. R100.0004 F500.", "V0515"),
        (FANUC, "X-12.\nX0.\nG1 Y0.\nG2 X.0004 Y.0104 R-5.", "V0515"),
        (
            FANUC,
            "X1.0004 Y-0.0004\nG2 X0.9996 Y0.0004 I5. J5.",
            "P0120 8 less than two increments from its start",
        ),
        (FANUC, "G0 X3.33333\nG92 X0", "P0120 8 G92"),
        (SIEMENS, "G52 Z-3.\nG91 G28 Z0.", "P0120 8 Z"),
        (HAAS, "G81 X4. Z1. R2.\nX5. L0", "P0120 8 L0"),
        (HAAS, "G81 X4. Z1. R2.\nG98 Z1.5", "P0120 8 G81"),
        (HAAS, "M30 M9", "P0120 7 M30"),
        (SIEMENS, "G4 X5.", "P0118 7 X"),
        (FANUC, "G18\nG43 H1 Z20.", "P0120 8 G43"),
        (SIEMENS, "G20\nG91 G1 X.0001", "P0120 8 X0.0001"),
        (FANUC, "S900 M4\nG86 X4. Z1. R2. P0\nG80", "P0120 8 G86"),
    ] {
        Scene::new(&format!("{begin}{blocks}")).gives(control, NONE, &[word]);
    }
    let off = Scene::new(&format!("{begin}M88\nM89\nG1 Z1.")).with("anyway = true");
    off.gives(HAAS, FINDINGS, &["V0106 9 feeds with the spindle off"]);
    let turned = Scene::new("T1 M6\nS900 M3\nG0 G43 H1 Z60.\nA-30. C0.\nM428\nG49\nX5.");
    let turned = turned.placed().with("machine = \"A-C trunnion\"");
    turned.gives(LINUXCNC, NONE, &["P0120 7 G49"]);
    let both = Scene::new(&format!("{begin}G81 G80 X4. Z1. R2."));
    both.gives(FANUC, NONE, &["P0117 7 G81"]);
    both.gives(LINUXCNC, CLEAN, &[]);
    for (block, word) in [("(a comment)", "P0115 4 `(`"), ("G64", "P0115 4 G64")] {
        let text = format!(
            "%A G71 *\nN10 G90 S9000 M3 F100.\nN20 G0 X-6. Y0. Z20.\n{block}\nN90 %A G71 *\n"
        );
        Scene::of(&text).gives(ANY, NONE, &[word]);
    }
}

/// A number that two words of a block take, and limits of LinuxCNC that it exceeds in silence or stops at.
#[test]
fn numbers_that_controls_share_out_differently_are_refused() {
    let begin = "G0 X-6. Y0. Z20.\n";
    let shared = "P0120 some controls give its number to both";
    for (blocks, word) in [
        ("G64 P3 G2 X4. I5. Z5.", shared),
        ("G2 X4. I5. Z5.\nM62 P3 X-6. I-5.", shared),
        ("G3 X4. Z5. R9. P2 M64", shared),
        ("G82 X4. Z1. R2. P1 G64", shared),
        ("G82 X4. Z1. R2. P-1", "P0106 3 P-1"),
        ("M62 P-1", "P0106 3 P-1"),
    ] {
        Scene::new(&format!("{begin}{blocks}")).gives(LINUXCNC, NONE, &[word]);
    }
    let many = |count: usize| format!("{begin}#1=4{}\nG0 X#1 Z1.", "#2=2".repeat(count - 1));
    Scene::new(&many(50)).gives(LINUXCNC, CLEAN, &[]);
    Scene::new(&many(51)).gives(LINUXCNC, NONE, &["P0140 3"]);
    let nested = |deep: usize| {
        let calls = (1..deep).map(|k| format!("O{k}\nM98 P{}\nM99\n", k + 1));
        let subprograms: String = calls.collect();
        let main = program(&format!("{begin}M98 P1"));
        Scene::of(&format!("{main}{subprograms}O{deep}\nG1 X4. Z1.\nM99\n"))
    };
    nested(9).gives(LINUXCNC, CLEAN, &[]);
    nested(10).gives(LINUXCNC, NONE, &["P0139 30"]);
}

/// LinuxCNC seeks a subprogram after its call, and reads what stands between.
#[test]
fn a_subprogram_that_linuxcnc_does_not_find_is_refused() {
    let scene = |main: &str, subprograms: &str| {
        Scene::of(&format!("{}{subprograms}", program(&format!("G0 X-6. Y0. Z20.\n{main}"))))
    };
    let seven = "O7\nG1 Z3.\nM99\n";
    let eight = "O8\nM98 P7\nG1 X4. Z1.\nM99\n";
    scene("M98 P8", &format!("{eight}{seven}")).gives(LINUXCNC, CLEAN, &[]);
    scene("M98 P7\nM98 P8", &format!("{seven}{eight}")).gives(LINUXCNC, CLEAN, &[]);
    let not_found = "P0120 9 a call of O7 while it stands before the call";
    scene("M98 P8", &format!("{seven}{eight}")).gives(LINUXCNC, NONE, &[not_found]);
    let passed = format!("O9\nG1 X1.\nM99\n{seven}");
    scene("M98 P7\nG1 X4. Z1.", &passed).gives(LINUXCNC, CLEAN, &[]);
    Scene::of("G21 G90 G54 G94 S9000 M3\nG0 X-6. Y0. Z20.\nF0\nG1\nF100.\nG1 X4. Z1.\nM30\n")
        .gives(LINUXCNC, NONE, &["P0122 4 G1"]);
}

/// No control goes exactly through corners, unless the program says so.
#[test]
fn that_corners_are_rounded_is_said() {
    let blocks = "G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG0 Z20.";
    let word = "V0502 G61";
    Scene::new(blocks).gives(LINUXCNC, CLEAN, &[word]);
    Scene::new(&format!("G61\n{blocks}\nG64 P0.1\nX0.")).gives(LINUXCNC, CLEAN, &[word]);
    let exact = Scene::new(&format!("G61\n{blocks}")).check(LINUXCNC);
    assert!(!exact.has("V0502"), "{exact:?}");
}

/// An optional block, or a comment without an end, after the end of a block.
#[test]
fn a_block_after_a_semicolon_can_begin_with_a_comment() {
    let scene = |after: &str| {
        let blocks = format!("G0 X-6. Y0. Z1.\nG61\nG1 X-5.;{after}\nX4. Y0.");
        Scene::new(&blocks).obstacle([-6.0, 7.0, -1.0], [-4.0, 9.0, 9.0]).with("anyway = true")
    };
    for after in ["/(AROUND)Y10.", "/9 (AROUND) Y10."] {
        scene(after).gives(FANUC, FINDINGS, &["V0101 4 the clamp"]);
        scene(after).gives(ANY, FINDINGS, &["V0101 4 the clamp"]);
        scene(after).gives(LINUXCNC, CLEAN, &[]);
    }
    scene("(A)/(B)Y10.").gives(FANUC, NONE, &["P0204 4 `/`"]);
    scene("(NOTE").gives(FANUC, NONE, &["P0103 4 comment"]);
}

/// The stock of BLK FORM is that of the same box in the job.
#[test]
fn the_blank_of_klartext_is_the_stock() {
    let text = "BEGIN PGM A MM\nBLK FORM 0.1 Z X-4 Y-4 Z-2\nBLK FORM 0.2 X+4 Y+4 Z+1\nTOOL CALL 1 Z S9000\n\
                L Z+20 R0 FMAX M3\nL X-6 Y+0 FMAX\nL Z+0.5 F500\nL X+6\nL Z+20 FMAX\nM2\nEND PGM A MM\n";
    let scene = |text: &str, shape: &str| {
        let mut scene = Scene::of(text).placed();
        scene.file = "a.h";
        scene.job += &format!("[stock]\n{shape}\nspacing = 0.25\n");
        scene
    };
    let left = |shape: &str| {
        let points = |report: &JobReport<'_>| report.cut().map(|cut| cut.stock.remaining_points());
        let left = scene(text, shape).with_report(rules("heidenhain"), points);
        left.expect("a result").expect("a stock")
    };
    assert_eq!(left("blank = true"), left("box = [[-4, -4, -2], [4, 4, 1]]"));
    for (text, shape, message) in [
        (text.replace("BLK FORM 0.2", "; "), "blank = true", "J0123"),
        (text.replace("X+4 Y+4 Z+1", "X-5 Y+4 Z+1"), "blank = true", "J0123"),
        (text.to_owned(), "blank = true\nbox = [[0, 0, 0], [1, 1, 1]]", "J0127"),
    ] {
        scene(&text, shape).gives(HEIDENHAIN, NONE, &[message]);
    }
    // Its coordinates are those of the preset, of which the program may have several.
    let other = text.replace("BLK FORM 0.1", "CYCL DEF 247 DATUM SETTING Q339=+2\nBLK FORM 0.1");
    let mut other = scene(&other, "blank = true").with("presets = { 2 = \"G55\" }");
    other.job = other.job.replace("[work_offsets]", "[work_offsets]\nG55 = [0, 0, -370]");
    other.gives(HEIDENHAIN, NONE, &["J0136"]);
}

/// A return of Y leaves the length offset of Z, whose end moves Z then.
#[test]
fn a_return_of_other_axes_keeps_the_length() {
    let moved = |axis: &str| {
        let text =
            format!("G21 G90 G54 G94\nG43 H1 G0 X0. Y9. Z30.\nG91 G28 {axis}0.\nG90 G49\nM30\n");
        let setup = ControlSetup {
            start: [Some(0.0); 6],
            work_offsets: [Some([0.0; 6]); 9],
            lengths: BTreeMap::from([(1, 80.0)]),
            home: [Some(0.0); 6],
            rules: rules("fanuc")
                .with(Rule::ReferenceReturn, Choice::KeepsLength)
                .with(Rule::LengthChange, Choice::MovesZ),
            ..ControlSetup::default()
        };
        let (steps, _) = read(&text, &setup).unwrap_or_else(|error| panic!("{axis}: {error}"));
        steps.iter().any(|step| step.line == 4 && step.commanded[2])
    };
    assert_eq!(["Y", "Z"].map(moved), [true, false]);
}

/// R0 may stand before the next word without a blank, and words that a statement does not use are refused.
#[test]
fn words_of_klartext_are_neither_missed_nor_dropped() {
    let program = |blocks: &str| {
        format!(
            "BEGIN PGM A MM\nTOOL CALL 1 Z S1000\nL X-6 Y+0 R0 FMAX M3\nL Z+20 FMAX\n{blocks}\nM30\nEND PGM A MM\n"
        )
    };
    let steps = |blocks: &str| {
        let text = program(blocks);
        let setup = ControlSetup {
            radius_offsets: BTreeMap::from([(1, 3.0)]),
            lengths: BTreeMap::from([(1, 80.0)]),
            ..ControlSetup::default()
        };
        read(&text, &setup).map(|(steps, _)| steps)
    };
    let ends = |word: &str| {
        let text = format!("L X+0 Y+0 RR F500\nL X+20\nL X+40 {word}\nL X+60");
        let steps = steps(&text).unwrap_or_else(|error| panic!("{word}: {error}"));
        steps.iter().map(|step| step.end).collect::<Vec<_>>()
    };
    for word in ["R0F500", "R0FMAX", "R0.0 F500"] {
        assert_eq!(ends(word), ends("R0 F500"), "{word}");
    }
    let cycle = "CYCL DEF 200 DRILLING ~ Q200=+2 ~ Q201=-9 ~ Q206=+100 ~ Q202=+3 ~ Q210=+0 ~ Q203=+0 ~ Q204=+10 ~ Q211=+0";
    for (blocks, word) in [
        (format!("{cycle}\nSTOP M99"), "STOP"),
        (format!("{cycle}\nCYCL CALL M89"), "CYCL CALL"),
        ("STOP M140 MB 10".to_owned(), "STOP"),
    ] {
        let error = steps(&blocks).expect_err(word);
        assert!(error.code() == "P0120" && error.to_string().contains(word), "{error}");
    }
}

/// Words of one block that take or scale what belongs to another: each is what the control does, or refused.
#[test]
fn words_of_one_block_do_not_hide_each_other() {
    let start = "T1 M6\nS1000 M3\nG0 X0. Y0.\nG43 H1 Z50.\nG1 Z5.\nG0 Z50.\n";
    let scene =
        |blocks: &str| Scene::new(&format!("{start}{blocks}")).placed().with("anyway = true");
    // The Z of G52, G92, G10 and a plane is no motion, beside which the change of the length would be one.
    for word in
        ["G52 X0. Y0. Z0.", "G92 Z130.", "G10 L2 P2 Z-440.", "G68.2 X0. Y0. Z0. I0. J0. K0."]
    {
        scene(&format!("G49 {word}")).gives(FANUC, NONE, &["P0120 8 the length offset changes"]);
    }
    // A length offset does not hide the rotation beside it from a mirror image.
    for mode in ["G51.1 X0.", "G16"] {
        let rotated = format!("{mode}\nG43 H1 G68 X0. Y0. R90.\nG1 X5.");
        scene(&rotated).gives(FANUC, NONE, &["P0120 9 G68"]);
    }
    scene("G18\nG16\nG0 Z40.").gives(FANUC, NONE, &["P0120 10 G18"]);
    // The way to an intermediate point is that of a position.
    scene("G68 X0. Y0. R90.\nG0 X9. Y0.\nG69\nG28 X0.").gives(FANUC, NONE, &["P0120 11 G69"]);
    let stays = rules("fanuc").with(Rule::LengthChange, Choice::WithNextZ);
    scene("G49\nG91 G28 Z10.").gives_by(stays, NONE, &["P0120 9 Z"]);
    // Letters that an ignored word may own, and a word in force.
    let ignored = scene("G0 Z35. H2 M130").with("ignore = { M130 = \"a lamp\" }");
    ignored.gives(FANUC, NONE, &["P0120 8 H"]);
    for (block, pattern) in [("M130 H2", "P0120 8 H"), ("M130 D2", "P0120 8 D")] {
        let ignored = scene(block).with("ignore = { M130 = \"a lamp\" }");
        ignored.gives(FANUC, NONE, &[pattern]);
    }
    for word in ["M3", "M05", "M19", "M29", "M89", "G64", "G67"] {
        let text = format!("ignore = {{ {word} = \"a lamp\" }}");
        assert!(scene("").with(&text).check(FANUC).has("K0504"), "{word}");
    }
}

/// A whole number is scaled as the word does that takes it.
#[test]
fn a_whole_number_is_an_increment_of_its_own_word() {
    let read = |text: &str| {
        let setup = ControlSetup { rules: rules("fanuc"), ..ControlSetup::default() };
        let program = format!("G20 G90 G17 G94 G54 G98\nT1 M6\nG0 X0. Y0. Z5.\n{text}\nM30\n");
        read(&program, &setup).expect("a program").0
    };
    // 0.97 inch in Y, though the block before was polar; a plane R of 0.2 inch beside G69.
    let end = read("G16\nG15 G0 X0 Y9700").last().expect("a step").end;
    assert!((end[1].expect("y") - 24.638).abs() < 1e-9, "{end:?}");
    let drilled = read("G69\nG69 G99 G81 X0. Y0. Z-.05 R2000 F5.");
    assert!(drilled.iter().any(|step| (step.end[2].unwrap_or(0.0) - 5.08).abs() < 1e-9));
}

/// A word that selects coordinates in the language of the program is none that a job can pass over.
#[test]
fn words_that_select_coordinates_are_not_ignored() {
    for word in ["G500", "G505", "G599", "G153", "G290", "G291", "PRESETONS"] {
        let text = format!("ignore = {{ {word} = \"a lamp\" }}");
        assert!(Scene::new("").with(&text).check(SIEMENS).has("K0504"), "{word}");
    }
    let scene = Scene::new("G0 X0. Y0. M91").with("ignore = { M91 = \"a lamp\" }");
    scene.gives(HEIDENHAIN, NONE, &["P0115 2 M91"]);
    scene.with("anyway = true").gives(FANUC, NONE, &[]);
}

/// Words of everyday programs that move nothing.
#[test]
fn words_without_motion_take_their_letters() {
    for (control, block) in [
        (LINUXCNC, "M67 E0 Q1"),
        (LINUXCNC, "M68 E2 Q0.5"),
        (LINUXCNC, "M52 P1"),
        (FANUC, "G5.1 Q1 R5"),
        (FANUC, "G5.1 Q3 X0 Y0 Z0"),
        (FANUC, "G5.1 Q2 X0 Y0\nG5.1 Q0"),
        (FANUC, "G5 P10000\nG5 P0"),
        (HAAS, "G98 G83 X0. Y0. Z1. R5. I2. J.5 K.5\nG80"),
        (HAAS, "G98 G83 X0. Y0. Z1. R5. Q2. K2.5\nG80"),
        (HAAS, "G98 G73 X0. Y0. Z1. R5. Q2. K7.5\nG80"),
        (HAAS, "G98 G84 X0. Y0. Z1. R5. J2\nG80"),
    ] {
        let scene = Scene::new(&format!("T1 M6\nS900 M3\nG43 H1\nG0 X0. Y0.\nZ50.\n{block}"));
        let checked = scene.placed().with("anyway = true").check(control);
        assert!(!checked.has("P01"), "{block}: {:#?}", checked.rows);
    }
    for block in ["G5.1 Q3 X10. Y0.", "G5.1 Q3 G1 X0.", "G5.1 X0. Y0.", "G5 P10001"] {
        let scene = Scene::new(&format!("T1 M6\nS900 M3\nG43 H1\nG0 X0. Y0.\nZ50.\n{block}"));
        let checked = scene.placed().with("anyway = true").check(FANUC);
        assert!(checked.has("P0115"), "{block}: {:#?}", checked.rows);
    }
}
