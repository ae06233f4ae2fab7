//! Words, numbers and text that controls read in different ways.

use super::{FANUC, HAAS, LINUXCNC, SIEMENS, Scene, program};
use crate::bench::stderr;

#[test]
fn numbers_without_a_point_are_units_or_increments() {
    let blocks = "G0 X-6. Y0. Z20.\nG0 Z5\nX6.\nG1 X4. Z1.";
    let scene = Scene::new(blocks).obstacle([-1.0, -3.0, 0.5], [1.0, 3.0, 3.0]);
    scene.gives(&[], 1, &["the clamp", "under whole_numbers = \"increments\""]);
    scene.gives(&LINUXCNC, 0, &[]);
    scene.gives(&FANUC, 1, &["the clamp"]);
}

/// A Haas may read a whole number after R or Q as units, where those of axes are increments.
#[test]
fn a_whole_number_after_r_is_either_on_haas() {
    let blocks = "G0 X-6. Y0. Z20.\nG68 X0. Y0. R90\nX12. Y6. Z1.\nG1 X10.\nG69";
    let scene = Scene::new(blocks).obstacle([-8.0, 8.0, -1.0], [-4.0, 15.0, 9.0]);
    let scene = scene.with("anyway = true");
    scene.gives(&HAAS, 1, &["the clamp", "under whole_radii = \"units\""]);
    scene.gives(&FANUC, 0, &[]);
    scene.gives(&[], 1, &["the clamp"]);
}

#[test]
fn text_after_a_semicolon_is_a_comment_or_a_block() {
    let blocks =
        "G0 X-6. Y0. Z20.\nG0 X0. Z20.; G1 Z-1. ; G0 Z20.\nG1 X1. Z19. ; a comment, G1 Z-1.";
    let scene = Scene::new(blocks).with("anyway = true");
    scene.gives(&[], 1, &["ball", "under semicolon = \"end of block\""]);
    scene.gives(&LINUXCNC, 0, &[]);
    scene.gives(&HAAS, 1, &["ball"]);
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
        scene.gives(&LINUXCNC, 2, &["another program begins here, and is not checked"]);
    }
    let sub = format!(
        "%\nO1\n{}O7\nG1 X5.\nM99\n%\n(made by a post)\n",
        one.replace("M30", "M98 P7\nM30")
    );
    Scene::of(&sub).gives(&LINUXCNC, 0, &[]);
}

/// Blocks that begin with `/`: the switch is the operator's, and both positions are checked unless the job states one.
#[test]
fn optional_blocks_are_checked_with_and_without() {
    let blocks = "G0 X-6. Y0. Z20.\n/G0 X20.\nG1 Z-1.\nG1 X19.\nG0 Z20.";
    let scene = Scene::new(blocks).with("anyway = true");
    scene.gives(&LINUXCNC, 1, &["under optional_blocks = \"left out\""]);
    let scene = scene.with("block_delete = false");
    scene.gives(&LINUXCNC, 0, &[]);
}

#[test]
fn words_of_heidenhain_are_not_read_as_those_of_others() {
    let heidenhain = ["--control", "heidenhain"];
    let own = Scene::of("G21 G90 S9000 M3 F100.\nG0 X-6. Y0. Z20.\nG1 X4. Z1.\nM30\n");
    own.gives(&heidenhain, 2, &["G21 is another word in DIN/ISO programs of Heidenhain"]);
    let own = Scene::of("G71 G90 S9000 M3 F100.\nG0 X-6. Y0. Z20.\nG1 X4. Z1.\nM30\n");
    own.gives(&heidenhain, 0, &[]);
    // The head states the unit, and the last line repeats it.
    let own = "%PLATE G71 *\nN10 G90 S9000 M3 F100.\nN20 G0 X-6. Y0. Z20.\nN30 G1 X4. Z1.\nN99999999 %PLATE G71 *\n";
    Scene::of(own).gives(&heidenhain, 0, &[]);
    let fault = own.replace("N20 G0", "N20 G0 M91");
    Scene::of(&fault).gives(&heidenhain, 2, &["a.nc:3: M91 is not understood"]);
    // I and J are the pole: an arc about the origin.
    let arc = Scene::of("G71 G90 S9000 M3 F100.\nG0 X-6. Y0. Z1.\nG2 X6. Y0. I0. J0.\nM30\n");
    arc.gives(&heidenhain, 0, &[]);
    arc.gives(&LINUXCNC, 2, &["G71 is a unit in programs of Sinumerik"]);
}

/// Words of Heidenhain whose order in a block matters, or that keep what they leave out.
#[test]
fn words_of_heidenhain_depend_on_their_order() {
    let begin = "G71 G90 S9000 M3 F100.\nG0 X-6. Y0. Z20.\nG1 X-4. Z1.\n";
    for (blocks, word) in [
        ("G1 X6. G91 Y0. Z0.", "it holds for the coordinates after it"),
        ("G2 X-10. Y20. I-10.", "which keeps it on Heidenhain"),
        ("M89", "M89 is another word"),
    ] {
        let scene = Scene::of(&format!("{begin}{blocks}\nM30\n"));
        scene.gives(&["--control", "heidenhain"], 2, &[word]);
    }
    // The head is a title for others.
    let head = Scene::of("%P G71\nG90 G54 S9000 M3 F100.\nG0 X-6. Y0. Z20.\nG1 X-4. Z1.\nM30\n");
    head.gives(&["--control", "heidenhain"], 2, &["G54 is another word"]);
    head.gives(&HAAS, 2, &["(-152.4000"]);
    let edge = Scene::new("D1\nG0 X-6. Y0. Z20.\nG1 X-4. Z1.\nD0\nG0 X6.").placed();
    edge.gives_natively(2, &["D0 needs a tool in the spindle"]);
}

#[test]
fn a_call_that_controls_read_in_two_ways_is_refused() {
    let text = "G21 G90 G54 S9000 M3 F100.\nG0 X-6. Y0. Z20.\nM98 P20100\nM30\nO0100\nG91 G0 X3.\nG90\nM99\n\
                O20100\nG91 G0 X1.\nG90\nM99\n";
    Scene::of(text).gives(&[], 2, &["its last four digits are the number of a program, too"]);
    // T alone changes the tool of a Heidenhain.
    let text = "G71 G90 S9000 M3 F100.\nT1\nS9000 M3\nG0 X-6. Y0. Z20.\nG1 X4. Z1.\nT3\nS9000 M3\nG1 X5.\nM30\n";
    Scene::of(text).gives(&["--control", "heidenhain"], 2, &["no tool is given for T3"]);
}

/// Words that controls read in ways that are not followed are refused, or allow no verdict.
#[test]
fn other_words_on_which_controls_differ_are_refused() {
    let begin = "G0 X-6. Y0. Z20.\nG1 X4. Z1.\n";
    for (blocks, word) in [
        ("G99 G81 X4. Z0.5 R2.\nG20 X0.1", "coordinates, unit or tool have changed"),
        ("T1 M6\nS900 M3\nG91 G43 H1 Z20.", "the length offset has changed"),
        ("/1 G0 X5.\n/2 G0 X6.", "optional blocks have several switches"),
        ("G0 X0. Y0. Z20.\nG2 X20.02 Y0. I10. J0.", "the radii of an arc differ"),
        ("G0 Z30.\rG0 X5.", "a carriage return without a line feed"),
        ("G91 G28 X0. Y0. Z0.\nG0 X-10.\nG90", "only the machine knows where its coordinates"),
        ("G53 G0 Z-30.\nG53 G0 X10.\nG53 G0 X0.", "only the machine knows where its coordinates"),
    ] {
        Scene::new(&format!("{begin}{blocks}")).gives(&LINUXCNC, 2, &[word]);
    }
    // The way home after G49 is the machine's, as that before it is. Other motions without the offset are not.
    let home = format!("T1 M6\nS900 M3\nG43 H1 {begin}G0 Z20.\nG49\nG53 G0 Z0.\n");
    let reference = ["only the machine knows where its coordinates"];
    Scene::new(&home).gives(&LINUXCNC, 0, &reference);
    Scene::new(&format!("{home}G53 G0 X0. Y0.\n")).gives(&LINUXCNC, 0, &reference);
    let low = home.replace("G53 G0 Z0.", "G53 G0 Z-30.");
    Scene::new(&low).gives(&LINUXCNC, 2, &["moves without a tool length offset"]);
    // Text after a semicolon, in ways that do not look like a block at first sight.
    for text in ["X0. ;;Z-1.", "X0. ; (a) Z-1.", "X0. ; /Z-1.", "X0. ; #1=2 ; Z-1. ; NOTE A"] {
        let scene = Scene::new(&format!("G0 X-6. Y0. Z20.\nG1 X-4. Z1.\n{text}\nG0 Z20."));
        let scene = scene.with("block_delete = false\nanyway = true");
        scene.gives(&LINUXCNC, 0, &[]);
        scene.gives(&HAAS, 1, &["ball"]);
        scene.gives(&[], 1, &["under semicolon = \"end of block\""]);
    }
    let scene = Scene::new(&format!("{begin}X5. ; G65 P100")).with("anyway = true");
    scene.gives(&HAAS, 2, &["there is no O100"]);
    // The number of repeats is no length.
    let repeats = Scene::new(&format!("{begin}G99 G91 G81 X0.1 Z-0.2 R-0.1 K2\nG80 G90"));
    repeats.with("anyway = true").gives(&FANUC, 0, &[]);
}

/// Words on which controls differ: each ends without a verdict, with the word that decides it.
#[test]
fn words_that_controls_execute_in_different_ways_are_refused_or_named() {
    let begin = "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\n";
    for (blocks, word) in [
        // Fanuc moves in rapid traverse, and by a dog-leg.
        ("G53 Z0.", "G53 while G1 is in force differs between controls: write G0 in the block"),
        ("G0 Z20.\nT2\nT3 M6", "another tool is staged"),
        ("G0 Z20.\nT1 M6 X5.", "M6 while its block has axis words"),
        ("M98 P7 G0 Z20.\nM30\nO7\nM99", "M98 while its block has other words"),
        (";py,self.execute(\"G0 X5\")", "a comment whose Python LinuxCNC executes"),
        ("( PY,a=1)", "a comment whose Python LinuxCNC executes"),
        // Rigid tapping leaves the spindle standing.
        ("G0 Z20.\nG84 X4. Z1. R2.\nG80\nG1 X5.", "write M3 after G80"),
    ] {
        Scene::new(&format!("{begin}{blocks}")).gives(&LINUXCNC, 2, &[word]);
    }
    let tap = format!("{begin}G0 Z20.\nG84 X4. Z1. R2.\nG80\nS9000 M3\nG1 X5.");
    Scene::new(&tap).gives(&LINUXCNC, 0, &[]);
    // Native programs of Sinumerik shift by G58 and G59.
    let text = "G21 G90 G59 S9000 M3 F100.\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nM30\n";
    let mut shift = Scene::of(text).placed();
    shift.job += "G59 = [1, 0, -400]\n";
    shift.gives(&[], 2, &["shifts on native Sinumerik: state `dialect`"]);
    shift.gives(&SIEMENS, 2, &["G59 is a shift in native programs of Sinumerik"]);
    // Words that move nothing, and the end of a block of Heidenhain.
    let passed = Scene::new(&format!("{begin}G103 P1\nG187 P2 E0.02\nM83\nM84\nG0 Z20.*\n"));
    passed.with("anyway = true").gives(&HAAS, 0, &[]);
}

/// Words at which a control stops with an error: what the program has set stays for the next one.
#[test]
fn words_at_which_a_control_stops_are_refused() {
    let begin = "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG0 Z20.\n";
    let long = format!("X-6.{}Y0.", " ".repeat(300));
    for (block, word) in [
        ("G103 P1", "G103 is no word of LinuxCNC"),
        ("G43.4 H1", "G43.4 is no word of LinuxCNC"),
        ("G69", "G69 is no word of LinuxCNC"),
        ("G94\nG1 X5.", "G1 needs a feed rate"),
        ("G82 X4. Z1. R2. P1\nG81 X5. Z1.", "G81 needs the retract plane R"),
        ("G81 X4. Z1. R2.\nX5. P1", "P is used by no G or M word"),
        ("M29 S900\nG18\nG84 X4. Y1. Z1. R2.", "M29 is no word of LinuxCNC"),
        ("G18\nG84 X4. Y1. Z1. R2.", "G84 while G18 or G19 is in force"),
        ("M29 S100", "M29 is no word of LinuxCNC"),
        ("M62", "M62 needs P"),
        ("G4 X1.", "G4 needs P with a time"),
        ("G82 X4. Z1. R2.", "G82 needs P with the time"),
        ("G81 X4. Z1. R2. K2", "K is used by no G or M word"),
        ("M4 S100\nG74 X4. Z1. R2. L2", "L is used by no G or M word"),
        ("D1", "D is used by no G or M word"),
        ("S-100", "S-100"),
        ("G0 G28 Z0.", "G28 and G0"),
        ("M8 M9", "M8 and M9"),
        ("M3 M5", "M3 and M5"),
        ("X-6. *", "`*` is an error on LinuxCNC"),
        ("(ABORT,stop)", "at which LinuxCNC stops"),
        (long.as_str(), "longer than the 251 bytes"),
    ] {
        Scene::new(&format!("{begin}{block}")).gives(&LINUXCNC, 2, &[word]);
    }
    let passed =
        "G61\nG64 P0.01\nM7\nM8\nM9\nM62 P1\nG4 P0.5\nG82 X4. Z1. R2. P1\nX5.\nG80\nG0 Z20.";
    Scene::new(&format!("{begin}{passed}")).gives(&LINUXCNC, 0, &[]);
    Scene::new(&format!("{begin}G61.1")).gives(&FANUC, 2, &["G61.1 is a word of LinuxCNC alone"]);
    for (control, blocks, word) in [
        // Without the digits below the increment the centre is 0.28 mm farther.
        (
            &FANUC[..],
            "X-100.\nG2 X100. R100.0004 F500.",
            "has more digits than the least increment",
        ),
        (
            &FANUC,
            "X-12.\nX0.\nG1 Y0.\nG2 X.0004 Y.0104 R-5.",
            "has more digits than the least increment",
        ),
        (
            &FANUC,
            "X1.0004 Y-0.0004\nG2 X0.9996 Y0.0004 I5. J5.",
            "less than two increments from its start",
        ),
        (&FANUC, "G0 X3.33333\nG92 X0", "G92 X0 while it or the position is no multiple"),
        (&SIEMENS, "G52 Z-3.\nG91 G28 Z0.", "shift or length has changed, which Sinumerik adds"),
        (&HAAS, "G81 X4. Z1. R2.\nX5. L0", "to whose place Haas moves"),
        (&HAAS, "G81 X4. Z1. R2.\nG98 Z1.5", "has no place of a hole, and is executed or not"),
        (&HAAS, "M30 M9", "M30 while its block has another M word"),
        (&SIEMENS, "G4 X5.", "X is used by no G or M word"),
        (&FANUC, "G18\nG43 H1 Z20.", "G43 while G18 or G19 is in force"),
        (&SIEMENS, "G20\nG91 G1 X.0001", "no multiple of the least increment"),
        (&FANUC, "S900 M4\nG86 X4. Z1. R2. P0\nG80", "which it does not do after it on Fanuc"),
    ] {
        Scene::new(&format!("{begin}{blocks}")).gives(control, 2, &[word]);
    }
    let off = Scene::new(&format!("{begin}M88\nM89\nG1 Z1.")).with("anyway = true");
    off.gives(&HAAS, 1, &["feeds with the spindle off"]);
    let turned = Scene::new("T1 M6\nS900 M3\nG0 G43 H1 Z60.\nA-30. C0.\nM428\nG49\nX5.");
    let turned = turned.placed().with("machine = \"A-C trunnion\"");
    turned.gives(&LINUXCNC, 2, &["G49 while M428 is in force with turned axes"]);
    let both = Scene::new(&format!("{begin}G81 G80 X4. Z1. R2."));
    both.gives(&FANUC, 2, &["G81 and G80"]);
    both.gives(&LINUXCNC, 0, &[]);
    for (block, word) in [("(a comment)", "`(` is no word"), ("G64", "G64 is another word")] {
        let text = format!(
            "%A G71 *\nN10 G90 S9000 M3 F100.\nN20 G0 X-6. Y0. Z20.\n{block}\nN90 %A G71 *\n"
        );
        Scene::of(&text).gives(&[], 2, &[word]);
    }
}

/// A number that two words of a block take, and limits of LinuxCNC that it exceeds in silence or stops at.
#[test]
fn numbers_that_controls_share_out_differently_are_refused() {
    let begin = "G0 X-6. Y0. Z20.\n";
    let shared = "some controls give its number to both";
    for (blocks, word) in [
        ("G64 P3 G2 X4. I5. Z5.", shared),
        ("G2 X4. I5. Z5.\nM62 P3 X-6. I-5.", shared),
        ("G3 X4. Z5. R9. P2 M64", shared),
        ("G82 X4. Z1. R2. P1 G64", shared),
        ("G82 X4. Z1. R2. P-1", "P-1 is not understood"),
        ("M62 P-1", "P-1 is not understood"),
    ] {
        Scene::new(&format!("{begin}{blocks}")).gives(&LINUXCNC, 2, &[word]);
    }
    let many = |count: usize| format!("{begin}#1=4{}\nG0 X#1 Z1.", "#2=2".repeat(count - 1));
    Scene::new(&many(50)).gives(&LINUXCNC, 0, &[]);
    Scene::new(&many(51)).gives(&LINUXCNC, 2, &["more than 50 assignments"]);
    let nested = |deep: usize| {
        let calls = (1..deep).map(|k| format!("O{k}\nM98 P{}\nM99\n", k + 1));
        let subprograms: String = calls.collect();
        let main = program(&format!("{begin}M98 P1"));
        Scene::of(&format!("{main}{subprograms}O{deep}\nG1 X4. Z1.\nM99\n"))
    };
    nested(9).gives(&LINUXCNC, 0, &[]);
    nested(10).gives(&LINUXCNC, 2, &["more than 9 deep"]);
}

/// LinuxCNC seeks a subprogram after its call, and reads what stands between.
#[test]
fn a_subprogram_that_linuxcnc_does_not_find_is_refused() {
    let scene = |main: &str, subprograms: &str| {
        Scene::of(&format!("{}{subprograms}", program(&format!("G0 X-6. Y0. Z20.\n{main}"))))
    };
    let seven = "O7\nG1 Z3.\nM99\n";
    let eight = "O8\nM98 P7\nG1 X4. Z1.\nM99\n";
    scene("M98 P8", &format!("{eight}{seven}")).gives(&LINUXCNC, 0, &[]);
    scene("M98 P7\nM98 P8", &format!("{seven}{eight}")).gives(&LINUXCNC, 0, &[]);
    let not_found = "a call of O7 while it stands before the call";
    scene("M98 P8", &format!("{seven}{eight}")).gives(&LINUXCNC, 2, &[not_found]);
    for spelling in ["M98. P7", "M098 P7"] {
        scene(spelling, seven).gives(&LINUXCNC, 2, &["write M98 or M99"]);
    }
    scene("#<x>=7\nM98 P#<x>", seven).gives(&LINUXCNC, 2, &["P of M98 while it depends on a name"]);
    let passed = |line: &str| format!("O9\n{line}\nM99\n{seven}");
    scene("M98 P7\nG1 X4. Z1.", &passed("G1 X1.")).gives(&LINUXCNC, 0, &[]);
    for (line, word) in [
        ("(A(B))", "comment"),
        ("(A", "comment"),
        ("M98 P#<q>", "P of M98 while it depends on a name"),
    ] {
        scene("M98 P7", &passed(line)).gives(&LINUXCNC, 2, &[word]);
    }
    Scene::of("G21 G90 G54 G94 S9000 M3\nG0 X-6. Y0. Z20.\nF0\nG1\nF100.\nG1 X4. Z1.\nM30\n")
        .gives(&LINUXCNC, 2, &["G1 needs a feed rate"]);
}

/// No control goes exactly through corners, unless the program says so.
#[test]
fn that_corners_are_rounded_is_said() {
    let blocks = "G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG0 Z20.";
    let word = "may round corners without G61";
    Scene::new(blocks).gives(&LINUXCNC, 0, &[word]);
    Scene::new(&format!("G61\n{blocks}\nG64 P0.1\nX0.")).gives(&LINUXCNC, 0, &[word]);
    let exact = Scene::new(&format!("G61\n{blocks}")).run(&LINUXCNC);
    assert!(!stderr(&exact).contains(word), "{}", stderr(&exact));
}

/// An optional block, or a comment without an end, after the end of a block.
#[test]
fn a_block_after_a_semicolon_can_begin_with_a_comment() {
    let scene = |after: &str| {
        let blocks = format!("G0 X-6. Y0. Z1.\nG61\nG1 X-5.;{after}\nX4. Y0.");
        Scene::new(&blocks).obstacle([-6.0, 7.0, -1.0], [-4.0, 9.0, 9.0]).with("anyway = true")
    };
    for after in ["/(AROUND)Y10.", "/9 (AROUND) Y10."] {
        scene(after).gives(&FANUC, 1, &["the clamp"]);
        scene(after).gives(&[], 1, &["the clamp"]);
        scene(after).gives(&LINUXCNC, 0, &[]);
    }
    scene("(A)/(B)Y10.").gives(&FANUC, 2, &["`/` begins no word"]);
    scene("(NOTE").gives(&FANUC, 2, &["comment"]);
}

/// The stock of BLK FORM is that of the same box in the job.
#[test]
fn the_blank_of_klartext_is_the_stock() {
    let text = "BEGIN PGM A MM\nBLK FORM 0.1 Z X-4 Y-4 Z-2\nBLK FORM 0.2 X+4 Y+4 Z+1\nTOOL CALL 1 Z S9000\n\
                L Z+20 R0 FMAX M3\nL X-6 Y+0 FMAX\nL Z+0.5 F500\nL X+6\nL Z+20 FMAX\nM2\nEND PGM A MM\n";
    let stock = |text: &str, shape: &str| {
        let mut scene = Scene::of(text).placed();
        scene.job += &format!("[stock]\n{shape}\nspacing = 0.25\n");
        let output = scene.run(&["--control", "heidenhain"]);
        let said = stderr(&output);
        let line = said.lines().find(|line| line.starts_with("stock: ")).map(str::to_owned);
        (output.status.code(), line, said)
    };
    let (status, line, said) = stock(text, "blank = true");
    assert!(line.is_some(), "{said}");
    let boxed = stock(text, "box = [[-4, -4, -2], [4, 4, 1]]");
    assert_eq!((status, line), (boxed.0, boxed.1), "{said}");
    for (text, shape, message) in [
        (text.replace("BLK FORM 0.2", "; "), "blank = true", "states no box by BLK FORM"),
        (text.replace("X+4 Y+4 Z+1", "X-5 Y+4 Z+1"), "blank = true", "states no box by BLK FORM"),
        (text.to_owned(), "blank = true\nbox = [[0, 0, 0], [1, 1, 1]]", "only one of them"),
    ] {
        let (status, _, said) = stock(&text, shape);
        assert!(status == Some(2) && said.contains(message), "{said}");
    }
}
