//! Cycles that cut nothing, modes that are assumed, and arcs of large or of two radii.

use crate::in_the_way::{named, scene};
use crate::scene::{CLEAN, FANUC, FINDINGS, HAAS, HEIDENHAIN, LINUXCNC, NONE, SIEMENS, Scene};

/// Z in a further block of a cycle is its depth, and not a level. No material is touched here: the cycles are above the block.
#[test]
fn cycles_that_cut_nothing_are_named() {
    let series = |further: &str| {
        let blocks = format!(
            "G0 X-2. Y0. Z10.\nG82 Z0.5 R1.5 P0 F200.\nX0. Y0.{further}\nX2. Y0.{further}\nG80\nG0 Z20."
        );
        Scene::new(&blocks).placed()
    };
    for control in [LINUXCNC, HAAS] {
        series(" Z1.5").gives(control, NONE, &["V0518 4 (2 times)"]);
        series(" Z1.").gives(control, CLEAN, &[]);
    }
    let by_increments = "G0 X-2. Y0. Z10.\nG91 G81 X1. Z0 R-8. F200.\nG80 G90\nG0 Z20.";
    Scene::new(by_increments).placed().gives(LINUXCNC, NONE, &["V0518 3"]);
    // A depth of 0 on a Heidenhain.
    let klartext = |depth: &str| {
        named(
            "a.h",
            &format!(
                "BEGIN PGM A MM\nTOOL CALL 1 Z S1000\nL Z+0 R0 FMAX M91\nL X+0 Y+0 R0 FMAX M3\nL Z+20 R0 FMAX\n\
                 CYCL DEF 200 DRILLING ~\n Q200=+1 ~\n Q201={depth} ~\n Q206=+100 ~\n Q202=+5 ~\n Q210=+0 ~\n Q203=+3 ~\n \
                 Q204=+10 ~\n Q211=+0\nL X+1 R0 FMAX M99\nM30\nEND PGM A MM\n"
            ),
        )
        .placed()
    };
    klartext("+0").gives(HEIDENHAIN, NONE, &["V0518 15"]);
    klartext("-2").gives(HEIDENHAIN, CLEAN, &[]);
    // A cycle that is defined and never called.
    let mut uncalled = klartext("-2");
    uncalled.text = uncalled.text.replace(" M99", "");
    uncalled.gives(HEIDENHAIN, NONE, &["V0520 6"]);
    let modal = "G0 X0 Y0 Z5\nS900 M3 F100\nMCALL CYCLE81(5,2,1,1)\nX=1\nMCALL\nG0 Z=5\nM30\n";
    named("a.mpf", &format!("G71 G90 G54 G17 G94\n{modal}")).placed().gives(SIEMENS, CLEAN, &[]);
    let modal = format!("G71 G90 G54 G17 G94\n{}", modal.replace("X=1\n", ""));
    named("a.mpf", &modal).placed().gives(SIEMENS, NONE, &["V0520 4"]);
}

/// Words of a cycle before its first place (L0 of Haas), and places that a rotary axis turns to.
#[test]
fn a_cycle_waits_for_its_place() {
    let holes = |first: &str, further: &str| {
        Scene::new(&format!(
            "G0 X-2. Y0. Z10.\nG99 G81 Z1. R1.5 F200.{first}\n{further}\nG80\nG0 Z20."
        ))
        .placed()
    };
    holes(" L0", "X1.\nX2.").gives(HAAS, CLEAN, &[]);
    holes(" L0", "X1. Z-0.5").gives(HAAS, FINDINGS, &["V0101 4 0.5000 mm deep in the part"]);
    holes(" L0 X1.", "X2.").gives(HAAS, NONE, &["P0120 3 L0"]);
    holes(" L0", "").gives(HAAS, NONE, &["V0520 3"]);
    // The table turns about the middle of the block, whose corner is then 2.16 mm above its top, and whose side is 2 mm above.
    let turned = |retract: f64, further: &str| {
        let blocks =
            format!("G0 X-2. Y0. Z10. A0.\nG99 G81 Z1. R{retract} F200.\n{further}\nG80\nG0 Z20.");
        let mut scene = Scene::new(&blocks).placed().with("machine = \"4-axis\"");
        scene.job = scene.job.replace("[0, 0, -400]", "[0, 0, -499]");
        scene
    };
    turned(2.5, "A180.").gives(HAAS, CLEAN, &[]);
    turned(2.5, "X1. A90.").gives(HAAS, FINDINGS, &["V0101 4 ball and flute"]);
    turned(1.5, "A180.").gives(HAAS, FINDINGS, &["V0101 4 in rapid traverse"]);
    turned(2.5, "A180.").gives(LINUXCNC, NONE, &["P0120 4 A"]);
}

/// Modes that the program leaves to the control are named where they matter first.
#[test]
fn assumed_modes_are_named() {
    let modes = |head: &str, blocks: &str| {
        let scene =
            Scene::of(&format!("{head}\nS900 M3 F100.\nG0 X-2. Y0. Z5.\n{blocks}\nG0 Z20.\nM30\n"));
        scene.placed().check(LINUXCNC)
    };
    let arc = "G1 Z1.\nG2 X2. I2.";
    let none = modes("G21 G54", arc);
    none.assert(CLEAN, &["V0519 3 G90", "V0519 4 G94", "V0519 5 G17"], arc);
    let all = modes("G21 G54 G90 G17 G94", arc);
    assert!(!all.has("V0519"), "{:#?}", all.rows);
    modes("G21 G54 G90 G17 G94", "G81 Z1. R2.").assert(CLEAN, &["V0519 4 G98 or G99"], arc);
    // No motion depends on a plane without an arc or a cycle.
    assert!(!modes("G21 G54 G90 G94", "G1 Z1.\nX2.").has("V0519"));
    let klartext = "BEGIN PGM A MM\nTOOL CALL 1 Z S1000\nL X+0 Y+0 R0 FMAX M3\nL Z+3 R0 F100\nM30\nEND PGM A MM\n";
    assert!(!named("a.h", klartext).check(HEIDENHAIN).has("V0519"));
}

/// Smoothing of tool paths makes arcs with radii of kilometres: a centre is no position, and radii that differ by rounding shift an
/// arc of less than half a turn by no more than they differ.
#[test]
fn shallow_arcs_are_as_clean_as_their_chords() {
    // A sagitta of 6e-6 mm over the block, and a chord of 0.03 mm with a radius of 3.5 m.
    for arc in [
        "G2 X4. Y-2. I4. J-3000000.",
        "G3 X4. Y-2. I4. J3000000.",
        "G2 X-3.97 Y-1.99997 I0. J-3500.",
    ] {
        let text = |z: &str| format!("G17\nG0 X-4. Y-2. Z5.\nG1 Z{z}\n{arc}\nG1 X4. Y-2.\nG0 Z5.");
        for control in [LINUXCNC, HAAS, FANUC, SIEMENS] {
            let clean = Scene::new(&text("0.")).placed().check(control);
            assert!(
                !clean.has("V05 radii") && !clean.has("K06") && !clean.has("V01"),
                "{arc}: {:#?}",
                clean.rows
            );
        }
        Scene::new(&text("0.")).placed().gives(LINUXCNC, CLEAN, &[]);
        Scene::new(&text("-0.5")).placed().gives(
            LINUXCNC,
            FINDINGS,
            &["V0101 0.5000 mm deep in the part"],
        );
    }
    // In other planes, and with a tilted plane that makes chords of it.
    let upright = "G0 X-4. Y-2. Z5.\nG18 G2 X4. Z5. I4. K3000000.\nG17\nG1 Z1.\nG0 Z5.";
    Scene::new(upright).placed().gives(LINUXCNC, CLEAN, &[]);
    let rotated =
        "G68 X0. Y0. R30.\nG0 X-4. Y-2. Z5.\nG1 Z0.\nG2 X4. Y-2. I4. J-3000000.\nG0 Z5.\nG69";
    Scene::new(rotated).placed().gives(HAAS, CLEAN, &[]);
}

/// Every curve between two radii is checked: the spiral is not the only one. A ball of radius 1 beside a wall, 0.05 mm and 0.03 mm from
/// the centre.
#[test]
fn every_curve_between_two_radii_is_checked() {
    let blocks = "G17\nG0 X0. Y0.05 Z5.\nG1 Z0.\nG2 X0.03 Y0. J-0.05\nG1 X0.\nG0 Z5.";
    let on_top = || Scene::new(blocks).placed().with("tolerance = 0.001");
    for control in [LINUXCNC, HAAS] {
        on_top().gives(control, CLEAN, &["V0517 5 grbl, Siemens, Heidenhain stop"]);
    }
    // The spiral reaches x = 0.0325, the circle of the larger radius 0.05.
    for (wall, verdict) in [(1.045, FINDINGS), (1.055, CLEAN)] {
        let scene = on_top().obstacle([wall, -3.0, 0.0], [wall + 1.0, 3.0, 5.0]);
        let pattern: &[&str] = if verdict == FINDINGS { &["V0101 5 the clamp"] } else { &[] };
        scene.gives(HAAS, verdict, pattern);
    }
    // A control that moves the centre of a longer arc moves it farther than the difference of the radii: at a small circle by 0.027 mm,
    // whose curves reach 0.06 mm from the centre, and at three quarters of a turn by 0.0042 mm.
    let small = "G17\nG0 X0. Y0.0093 Z5.\nG1 Z0.\nG2 X0. Y0. J-0.032\nG1 Y-4.\nG0 Z5.";
    let longer = "G17\nG0 X1. Y0. Z5.\nG1 Z0.\nG3 X0. Y-1.006 I-1. J0.\nG1 Y-1.\nG0 Z5.";
    for (blocks, [wall, clear]) in [(small, [1.055, 1.0605]), (longer, [2.008, 2.011])] {
        let on_top = || Scene::new(blocks).placed().with("tolerance = 0.001");
        on_top().gives(HAAS, CLEAN, &["V0517 5 grbl"]);
        for (wall, verdict) in [(wall, FINDINGS), (clear, CLEAN)] {
            let scene = on_top().obstacle([wall, -5.0, 0.0], [wall + 1.0, 5.0, 5.0]);
            let pattern: &[&str] = if verdict == FINDINGS { &["V0101 5 the clamp"] } else { &[] };
            scene.gives(HAAS, verdict, pattern);
        }
    }
    // Curves that are far from each other are not checked.
    let turned = "G17\nG0 X0. Y0. Z5.\nG3 X0.02 Y0. I-10. J0.\nG0 Z9.";
    Scene::new(turned).placed().gives(HAAS, NONE, &["V0514 4"]);
}

/// Klartext as CAM systems post it today: a tool by its name, a cycle of the builder, a point of the builder, a plane that turns nothing.
#[test]
fn klartext_of_cam_systems_is_read() {
    const TRUNNION: &str = r#"
        name = "trunnion"
        m92 = [0, 0, -20]
        axis = [
            { letter = "Y", kind = "linear", carries = "table", home = 0 },
            { letter = "A", kind = "rotary", carries = "table", direction = [1, 0, 0], point = [0, 0, -480], home = 0 },
            { letter = "C", kind = "rotary", carries = "table", direction = [0, 0, 1], point = [0, 0, -500], home = 0 },
            { letter = "X", kind = "linear", carries = "tool", home = 0 },
            { letter = "Z", kind = "linear", carries = "tool", limits = [-500, 0], home = 0 },
        ]"#;
    let text = "BEGIN PGM A MM\nCYCL DEF 392 ATC~\n Q240=0 ;TUNING~\n Q241=1 ;WEIGHT\nM127\nFUNCTION RESET TCPM\n\
                L Z0 R0 FMAX M92\nTOOL CALL \"Ball 2\" Z S2900 DL+0 DR+0\nL Z0 R0 FMAX M92\nL X0 Y0 R0 FMAX M92\n\
                CYCL DEF9 .0 DWELL\nCYCL DEF9.1 DWELL5\nPLANE SPATIAL SPA0 SPB0 SPC0 STAY SEQ+ TABLE ROT\n\
                L A+Q120 C+Q122 R0 FMAX M126\nL X-2 Y0 R0 F MAX M3\nL Z5 R0 F MAX\nL Z0 R0 F100\nL X2\nL Z5 R0 FMAX\n\
                PLANE RESET STAY\nL Z0 R0 FMAX M92\n/M30\nLBL \"Check\"\nFN 9: IF +Q1900 EQU +1 GOTO LBL \"On\"\nLBL 0\n\
                LBL \"On\"\nFN 0: Q1901=4\nLBL 0\nEND PGM A MM\n";
    let job = |text: &str, machine: &str| {
        let mut scene = scene("a.h", text, machine, "[0, 0, -460]");
        scene.job = scene.job.replace("length = 80", "length = 80\nname = \"BALL 2\"");
        scene.job += "[ignore]\n\"CYCL DEF 392\" = \"tunes the drives\"\n";
        scene
    };
    job(text, TRUNNION).gives(HEIDENHAIN, CLEAN, &["V0505 2 tunes the drives"]);
    // A plane that turns nothing leaves nothing open: the sign of the axes, and which coordinate is stated first.
    for plane in ["SPATIAL SPA0 SPB0 SPC0 STAY SYM- TABLE ROT", "RELATIV SPC+0 STAY TABLE ROT"] {
        let other = text.replace("SPATIAL SPA0 SPB0 SPC0 STAY SEQ+ TABLE ROT", plane);
        let other = other.replace("M126\nL X-2 Y0", "M126\nL X-2");
        job(&other, TRUNNION).gives(HEIDENHAIN, CLEAN, &[]);
    }
    let retracts = text
        .replace("SEQ+ TABLE ROT\nL A+Q120 C+Q122 R0 FMAX M126", "TABLE ROT\nM126")
        .replace("STAY TABLE", "TURN MB MAX FMAX TABLE");
    let retracts = retracts
        .replace("PLANE RESET STAY", "PLANE RESET TURN MB MAX FMAX")
        .replace("DWELL5\n", "DWELL5\nL A0 C0 R0 FMAX\n");
    job(&retracts, TRUNNION).gives(HEIDENHAIN, CLEAN, &[]);
    let tilted = text.replace("SPA0 SPB0 SPC0 STAY SEQ+ TABLE ROT", "SPA+10 SPB0 SPC0 STAY SYM+");
    job(&tilted, TRUNNION).gives(HEIDENHAIN, NONE, &["P0115 13 SYM+"]);
    let low = text.replace("L Z0 R0 F100", "L Z-0.5 R0 F100");
    job(&low, TRUNNION).gives(HEIDENHAIN, FINDINGS, &["V0101 18 0.5000 mm deep in the part"]);
    // Without the reason, the name or the point, there is no verdict.
    let mut unnamed = job(text, TRUNNION);
    unnamed.job = unnamed.job.replace("BALL 2", "DRILL");
    unnamed.gives(HEIDENHAIN, NONE, &["P0115 8 `[tool.N]`"]);
    // Cycles 300 to 399 are those of builders, and others that are not known can be named, too.
    for number in ["391", "512"] {
        let other = text.replace("392", number);
        job(&other, TRUNNION).gives(HEIDENHAIN, NONE, &["P0115 2 `[ignore]`"]);
        let mut ignored = job(&other, TRUNNION);
        ignored.job = ignored.job.replace("392", number);
        ignored.gives(HEIDENHAIN, CLEAN, &["V0505 2 tunes the drives"]);
    }
    job(text, &TRUNNION.replace("m92 = [0, 0, -20]", "")).gives(HEIDENHAIN, NONE, &["V0404 9"]);
    // The point is above the travel.
    job(text, &TRUNNION.replace("-20]", "20]")).gives(
        HEIDENHAIN,
        FINDINGS,
        &["V0108 Z goes to 20"],
    );
    // A cycle that moves the tool is not ignored.
    let mut known = job(text, TRUNNION);
    known.job = known.job.replace("CYCL DEF 392", "CYCL DEF 200");
    known.gives(HEIDENHAIN, NONE, &["K0504"]);
    // A condition that decides about a motion is not passed over.
    let decides = text.replace("\nLBL 0\nLBL \"On\"", "\nL Z2 R0 FMAX\nLBL \"On\"");
    job(&decides, TRUNNION).gives(HEIDENHAIN, NONE, &["P0210 24 Q1900"]);
}

/// Arcs that releases of LinuxCNC take for full circles, and full circles that they take for arcs.
#[test]
fn ends_that_are_apart_by_rounding_are_refused_on_linuxcnc() {
    for arc in ["G2 X-5. Y0.00003 I50. J0.", "G3 X-5. Y0.000005 I2. J0."] {
        let scene = Scene::new(&format!("G17\nG0 X-5. Y0. Z20.\nG1 Z10.\n{arc}\nG0 Z20."));
        scene.gives(LINUXCNC, NONE, &["P0120 5 full circle"]);
    }
}
