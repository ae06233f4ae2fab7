//! Programs that are not clean though what they write down is: the hit, or what nobody knows, is in a word that they leave out.

use crate::in_the_way::{B_HEAD, TRUNNION, scene};
use crate::scene::{CLEAN, FINDINGS, HEIDENHAIN, LINUXCNC, NONE, Scene, native, rules, straight};
use touchoff_verify::gcode::{Choice, ControlRules, Rule};

const START: &str = "G21 G90 G17 G94 G54\nT1 M6\nS1000 M3\n";

/// The trunnion with limits of A, by which the direction of +Y is reached with C at half a turn only.
fn limited() -> String {
    TRUNNION.replace("[0, 0, -480],", "[0, 0, -480], limits = [-120, 30],")
}

fn on_trunnion(blocks: &str) -> Scene {
    scene("a.nc", &format!("{START}{blocks}\nM30\n"), &limited(), "[0, 0, -440]")
}

/// A longer tool stands in the part where its change leaves it, whatever comes after the change.
#[test]
fn a_tool_that_moves_no_more_after_its_change_is_found() {
    for end in ["", "G0 G53 Z0\n", "T2 M6\n", "T2 M6\nT1 M6\nG43 H1\nG0 Z100\n"] {
        for is_placed in [false, true] {
            let text = format!(
                "{START}G0 X0 Y0\nG43 H1 Z5\nG1 X1 F200\nG0 Z100\nT2 M6\nS1000 M3\nG43 H2\nG0 Z0.5\nG1 X0 F200\nG49\nT1 M6\n{end}\
                 M30\n"
            );
            let mut scene = Scene::of(&text).on("3-axis", "home = 0\n", "");
            scene.files.values_mut().for_each(|machine| {
                machine.insert_str(0, "tool_change = \"stays\"\n");
            });
            let second = "length = 52\n[tool.2]\ntool = \"D2Ball\"\nlength = 50";
            scene.job = scene.job.replace("LENGTH", second);
            if is_placed {
                scene.job += "[work_offsets]\nG54 = [0, 0, -400]\n";
            }
            let scene = scene.with("anyway = true");
            scene.gives(LINUXCNC, FINDINGS, &["V0101 14 flute"]);
            // A shorter one does not.
            let mut shorter = scene;
            shorter.job = shorter.job.replace("length = 52", "length = 49");
            shorter.gives(LINUXCNC, CLEAN, &[]);
        }
    }
}

/// A tool change moves axes of the machine, also while program coordinates are rotated: X and Y stay, where a longer tool stands in the
/// part.
#[test]
fn a_tool_change_in_a_rotated_plane_leaves_other_axes() {
    for rotation in ["", "G68 X0 Y0 R30\nG0 X0 Y0\n"] {
        let text = format!("{START}G0 X0 Y0\nG43 H1 Z5\n{rotation}G1 Z4 F200\nT2 M6\nG69\nM30\n");
        for (length, verdict) in [(51, FINDINGS), (49, CLEAN)] {
            let mut scene = Scene::of(&text).placed().on("3-axis", "home = 0\n", "");
            scene.files.values_mut().for_each(|machine| {
                machine.insert_str(0, "tool_change = { Z = -350 }\n");
            });
            let second = format!("length = 50\n[tool.2]\ntool = \"D2Ball\"\nlength = {length}");
            scene.job = scene.job.replace("length = 50", &second);
            scene.with("anyway = true").gives_by(straight(), verdict, &[]);
        }
    }
}

/// Both ways of half a turn are as short, also if the program states no angle.
#[test]
fn half_a_turn_to_a_direction_is_open() {
    let plane =
        |euler: &str| format!("G68.2 X0. Y0. Z0. {euler}\nG53.1\nG0 X0. Y0. Z60.\nG69\nG49");
    let vector = |j: f64| {
        format!(
            "G49\nG43.5 H1\nG0 X0. Y0. Z60. I0. J0.6 K0.8\nG1 Z50. F100.\nG0 I0. J{j} K0.8\nG49"
        )
    };
    let start = "G0 A0. C0.\nG43 H1 Z60.\nG0 X0. Y0.";
    for (blocks, line) in [(plane("I0. J36.87 K0."), 8), (vector(-0.6), 11)] {
        let blocks = format!("{start}\n{blocks}");
        on_trunnion(&blocks).gives_by(straight(), NONE, &[&format!("V0411 {line}")]);
    }
    for blocks in [plane("I0. J-25. K0."), vector(0.6)] {
        let blocks = format!("{start}\n{blocks}");
        on_trunnion(&blocks).with("anyway = true").gives_by(straight(), CLEAN, &[]);
    }
    for (tilt, is_half) in [("+36.87", true), ("-25", false)] {
        for way in ["TURN FMAX", "MOVE DIST10 FMAX"] {
            let text = format!(
                "BEGIN PGM A MM\nTOOL CALL 1 Z S1000\nL A+0 C+0 FMAX M3\nL X+0 Y+0 Z+60 FMAX\n\
                 PLANE SPATIAL SPA{tilt} SPB+0 SPC+0 {way}\nL X+0 Y+0 Z+60 FMAX\nPLANE RESET STAY\nM30\nEND PGM A MM\n"
            );
            let checked = scene("a.h", &text, &limited(), "[0, 0, -440]").check(HEIDENHAIN);
            assert_eq!(checked.has("V0411 5"), is_half, "{checked:#?}\n{text}");
        }
    }
}

/// At the direction of the table any angle of it gives the tool axis, so that the one at which it stands stays unknown.
#[test]
fn a_table_of_unknown_angle_stays_unknown_in_its_own_direction() {
    let end = "G0 X30. Y0. Z50.\nG0 X15. Y0.\nG0 Z5.\nG0 Z50.";
    for start in [
        "G68.2 X0. Y0. Z0. I0. J0. K0.\nG53.1\nG0 G43 H1 X0. Y0. Z50.\nG69",
        "G43.5 H1\nG0 X0. Y0. Z50. I0. J0. K1.\nG49\nG43 H1",
    ] {
        let scene = on_trunnion(&format!("{start}\n{end}"));
        scene.gives_by(straight(), NONE, &["V0402"]);
        let known = on_trunnion(&format!("G0 A0. C0.\nG0 X0. Y0.\n{start}\n{end}"));
        known.with("anyway = true").gives_by(straight(), CLEAN, &[]);
    }
}

/// Without a length offset, Z is that of the spindle, which is the length of the only tool above its tip.
#[test]
fn rapid_traverse_without_a_length_offset_is_not_that_of_the_tip() {
    let text = "G21 G90 G17 G94 G54\nG0 X-30 Y0\nG0 Z20\nG0 X30\nT1 M6\nS1000 M3\nG43 H1 Z20\nG0 X0\nG1 Z1 F100\nG0 Z20\nG49\nM30\n";
    let stays = |text: &str| {
        let scene = Scene::of(text).on("3-axis", "name = ", "tool_change = \"stays\"\nname = ");
        scene.obstacle([-20.0, -2.0, -20.0], [-15.0, 2.0, -10.0])
    };
    stays(text).placed().gives(LINUXCNC, FINDINGS, &["V01 4 the clamp"]);
    let high = text.replace("Z20\nG0 X30", "Z90\nG0 X30");
    stays(&high).placed().gives(LINUXCNC, CLEAN, &[]);
    // The length is not stated.
    let rapids = "G21 G90 G17 G94 G54\nT1 M6\nG0 X-30 Y0\nG0 Z20\nG0 X0\nG0 Z1\nM30\n";
    stays(rapids).gives(LINUXCNC, NONE, &["V0307 5"]);
    // A program that names no tool is set up with that of the spindle.
    stays(&rapids.replace("T1 M6\n", "")).gives(LINUXCNC, CLEAN, &["V0308 4"]);
}

/// The end of the travel along a tilted tool is also aside.
#[test]
fn a_retract_to_the_end_of_the_travel_leads_aside_with_a_tilted_tool() {
    for (b, verdict, gap) in [("0", CLEAN, "V0405 6"), ("30", NONE, "V0404 6")] {
        let text = format!(
            "BEGIN PGM A MM\nTOOL CALL 1 Z S1000\nL B+{b} C+0 R0 FMAX M3\nL X-30 Y+0 Z+200 R0 FMAX\nL Z+50 R0 FMAX\n\
             L M140 MB MAX FMAX\nM30\nEND PGM A MM\n"
        );
        let scene = scene("a.h", &text, B_HEAD, "[0, 0, -440]");
        // Nothing is near the part, which is accepted.
        let scene = if verdict == CLEAN { scene.with("anyway = true") } else { scene };
        scene.gives(HEIDENHAIN, verdict, &[gap]);
    }
}

/// An arc begins where tool centre point control has left the machine, which the program does not state.
#[test]
fn an_arc_from_a_place_that_is_not_stated_is_open() {
    let text = "BEGIN PGM A MM\nTOOL CALL 1 Z S1000\nL B+30 C+0 R0 FMAX M3\nL X-50 Y+0 Z+200 R0 FMAX\nM128\n\
                L X-50 Y+0 Z+20 R0 FMAX\nM129\nCC X+0 Y+0\nC X-70 Y+0 DR- FMAX\nL Z+300 R0 FMAX\nM30\nEND PGM A MM\n";
    scene("a.h", text, B_HEAD, "[0, 0, -440]").gives(HEIDENHAIN, NONE, &["V0417 9"]);
}

/// The axes that align the tool move each at its own rate, or straight.
#[test]
fn an_alignment_depends_on_the_path_of_rapid_traverse() {
    let blocks = "G0 A0.\nG0 C0.\nG0 X0.\nG0 Y0.\nG43 H1 Z60.\nG68.2 X0. Y0. Z0. I20. J-20. K0.\nG53.1\nG1 X0. Y0. Z60. F500.\n\
                  G69\nG1 A0. C0.";
    let machine = TRUNNION.replace("[0, 0, -480], rapid = 10000", "[0, 0, -480], rapid = 2000");
    let text = format!("{START}{blocks}\nM30\n");
    let scene = scene("a.nc", &text, &machine, "[0, 0, -440]");
    let has_straight = scene.with_job(ControlRules::default(), |job| {
        let mut readings = job.program.readings().iter();
        Ok(readings.any(|one| one.assumed().rules.get(Rule::Rapid) == Some(Choice::Straight)))
    });
    assert!(has_straight.expect("a job"));
}

/// The way to the first X and Y at a Z that the program states is somewhere at that height.
#[test]
fn a_way_to_the_first_position_below_the_top_of_a_body_is_open() {
    for (z, clamp, verdict, gap) in [
        (-1.0, -2.0, NONE, "V0607 4 the part"),
        (0.0, 0.0, CLEAN, "V0401 4"),
        (5.0, 8.0, NONE, "V0607 4 the clamp"),
        (8.0, 8.0, CLEAN, "V0401 4"),
    ] {
        let text = format!("{START}G0 G43 H1 Z{z}\nG0 X20 Y0\nG0 Z50\nG0 X0\nG1 Z1 F100.\nM30\n");
        let scene = Scene::of(&text).placed();
        let scene = scene.on("3-axis", "name = ", "tool_change = \"stays\"\nname = ");
        let scene = scene.obstacle([-60.0, -60.0, -5.0], [-50.0, -50.0, clamp]);
        scene.gives(LINUXCNC, verdict, &[gap]);
    }
    // In either order, X and Y before Z is the way of most programs.
    let text = format!("{START}G0 X0 Y0\nG43 H1 Z-1\nG1 X20 F100.\nG0 Z50\nM30\n");
    let known = Scene::of(&text.replace("Z-1", "Z1")).placed();
    known.gives(LINUXCNC, CLEAN, &["V0401 4"]);
}

/// The control chooses the angles of a vector, and they are the nearest, whatever it does with angles that the program states.
#[test]
fn a_tool_vector_turns_the_table_the_shorter_way() {
    let text = "G17 G90 G54 G71 G94\nT1 M6\nD1\nS1000 M3\nG0 A-36.87 C335\nG0 X0 Y0 Z100\nTRAORI\nORIWKS\nG54\n\
                G0 X0 Y0 Z60 A3=0.253570957 B3=0.543784672 C3=0.8\nG1 X0.5 F1000\nG1 A3=-0.253570957 B3=0.543784672 C3=0.8\n\
                G0 Z100\nTRAFOOF\nG54\nG0 Z100 A0 C0\nM30\n";
    let stated = native(Choice::KeepsOffset);
    for (y, verdict) in [(1.0, FINDINGS), (-1.0, CLEAN)] {
        // A post beside the middle of one way, and beside that of the other.
        let [low, high] = [18.0 * y - 1.0, 18.0 * y + 1.0];
        let scene = scene("a.mpf", text, &limited(), "[0, 0, -440]").with("anyway = true");
        let scene = scene.obstacle([-1.0, low, 83.0], [1.0, high, 85.0]);
        let gaps: &[&str] = if verdict == FINDINGS { &["V0101 12 the clamp"] } else { &[] };
        scene.gives_by(stated.clone(), verdict, gaps);
    }
}

/// A length offset may differ from the length of the tool by what registers round: the tip is as far off.
#[test]
fn the_rounding_of_a_length_offset_counts() {
    for (length, verdict) in [("79.9991", FINDINGS), ("80", CLEAN)] {
        let blocks = "G0 A0. C0.\nG0 X-20. Y0.\nG43.4 H2\nG0 X-20. Y0. Z5.\nG1 Z0. F500.\nG1 X0.\nG0 Z50.\nG49";
        let mut scene = on_trunnion(blocks).with("resolution = 0.0001");
        let other = format!("length = 80\n[tool.2]\ntool = \"D2Ball\"\nlength = {length}");
        scene.job = scene.job.replace("length = 80", &other);
        let stated = rules("fanuc").with(Rule::LengthChange, Choice::WithNextZ);
        scene.gives_by(stated, verdict, &[]);
    }
}

/// With an origin of the table, a turn from 0 to 360 is that of the program's angles, or of the machine's.
#[test]
fn a_turn_whose_origin_is_not_stated_is_open() {
    let blocks = "G43 H1\nG0 A0. C350.\nG0 X20. Y0. Z50.\nG1 C10. F500.\nG0 Z50.";
    let stated = straight().with(Rule::Rotary, Choice::WithinTurn);
    for (offset, is_open) in [("30", true), ("0", false), ("5", false)] {
        let text = format!("{START}{blocks}\nM30\n");
        let offset = format!("[0, 0, -440, 0, 0, {offset}]");
        let checked = scene("a.nc", &text, TRUNNION, &offset).check_by(stated.clone());
        assert_eq!(checked.has("V0418 7"), is_open, "{checked:#?}");
    }
    // Heidenhain counts from the datum.
    let text = "BEGIN PGM A MM\nTOOL CALL 1 Z S1000\nL B+0 C+350 R0 FMAX M3\nL X+20 Y+0 Z+50 R0 FMAX\nL C+10 F500\nL Z+50 FMAX\n\
                M30\nEND PGM A MM\n";
    let stated = rules("heidenhain").with(Rule::Rotary, Choice::WithinTurn);
    let scene = scene("a.h", text, B_HEAD, "[0, 0, -440, 0, 0, 30]");
    let checked = scene.check_by(stated);
    assert!(!checked.has("V0418"), "{checked:#?}");
}

/// Only the machine knows its reference position, and yet Z alone goes straight up from where the tool stands: into an overhang. With
/// other axes the way goes in any direction, and the tool must be above all when it begins.
#[test]
fn a_way_to_an_unknown_reference_position_is_checked_as_far_as_it_is_known() {
    let leaving = |level: f64, way: &str| {
        format!("{START}G0 X-30. Y0.\nG43 H1 Z5.\nG1 X0. Z{level} F200.\n{way}\nM30\n")
    };
    let below = |text: &str| Scene::of(text).obstacle([-1.0, -5.0, 60.0], [5.0, 5.0, 70.0]);
    for way in ["G91 G28 Z0", "G91 G30 Z0", "G53 G0 Z0"] {
        let text = leaving(1.0, way);
        Scene::of(&text).gives(LINUXCNC, CLEAN, &["V0405 7"]);
        below(&text).gives(LINUXCNC, FINDINGS, &["V0101 7 in rapid traverse"]);
        // Beside the overhang.
        below(&text.replace("G1 X0.", "G1 X-2.5")).gives(LINUXCNC, CLEAN, &["V0405 7"]);
    }
    for way in ["G91 G28 X0 Y0 Z0", "G53 G0 X0 Y0 Z0", "G91 G28 X0 Z0"] {
        // In a pocket, whose walls are as high as the obstacle.
        let text = leaving(1.0, way);
        let low = Scene::of(&text).obstacle([5.0, -5.0, -5.0], [8.0, 5.0, 1.5]);
        low.gives(LINUXCNC, NONE, &["V0609 7"]);
        let high = Scene::of(&leaving(1.6, way)).obstacle([5.0, -5.0, -5.0], [8.0, 5.0, 1.5]);
        high.gives(LINUXCNC, CLEAN, &["V0405 7"]);
    }
}
