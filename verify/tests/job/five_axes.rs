//! Rotary axes, tool centre point control and tilted planes.

use crate::in_the_way::named;
use crate::scene::{
    ANY, CLEAN, FANUC, FINDINGS, HAAS, HEIDENHAIN, LINUXCNC, NONE, SIEMENS, Scene, native, program,
    rules, straight,
};
use touchoff_verify::gcode::{Choice, ControlRules, Rule};

/// LinuxCNC's kinematics of tilting tables turn the work by a positive command unless they are configured otherwise: the tool leans to
/// the other side, into a wall.
#[test]
fn linuxcnc_turns_axes_either_way_unless_the_direction_is_stated() {
    let linuxcnc = || ControlRules::named("linuxcnc").expect("a control");
    let blocks = "T1 M6\nS9000 M3\nG43 H1\nG0 X0. Y0. Z60. A0. C0.\nM428\nG0 A30.\nG1 Z1.\nG1 Z60.\nG0 A0.\nM429";
    let walled = |blocks: &str| {
        let scene = Scene::new(blocks).placed().obstacle([-3.0, 4.0, 3.0], [3.0, 6.0, 30.0]);
        scene.with("anyway = true")
    };
    let named = walled(blocks).with("machine = \"A-C trunnion\"");
    let reversed = ["V0101 8 the clamp", "V0101 8 under rotary_direction = \"reversed\""];
    named.gives_by(linuxcnc(), FINDINGS, &reversed);
    let stated = |choice| linuxcnc().with(Rule::RotaryDirection, choice);
    named.gives_by(stated(Choice::Iso841), CLEAN, &[]);
    named.gives_by(stated(Choice::Reversed), FINDINGS, &["V0101 8 the clamp"]);
    // A machine's own file states how its axes turn.
    let own = |to: &str| walled(blocks).on("A-C trunnion", "direction = [1, 0, 0]", to);
    own("direction = [1, 0, 0]").gives_by(linuxcnc(), CLEAN, &[]);
    own("direction = [-1, 0, 0]").gives_by(linuxcnc(), FINDINGS, &["V0101 8 the clamp"]);
    // Without kinematics the table turns the same way: 80 mm above its axis.
    let indexed = Scene::new(&blocks.replace("M428\n", "").replace("\nM429", "")).placed();
    let indexed = indexed.with("machine = \"A-C trunnion\"\nanyway = true");
    let indexed = indexed.obstacle([-3.0, 38.0, -12.0], [3.0, 43.0, 20.0]);
    indexed.gives_by(linuxcnc(), FINDINGS, &["V0101 under rotary_direction = \"reversed\""]);
    // Without a control ISO 841 is taken, and said.
    let known = blocks.replace("T1 M6\n", "").replace("M428\n", "").replace("\nM429", "");
    let unstated = Scene::new(&known).placed().with("machine = \"A-C trunnion\"\nanyway = true");
    unstated.gives(ANY, CLEAN, &["V0310 5 `rotary_direction`"]);
    assert!(!unstated.check(FANUC).has("V0310"));
    // Other controls turn axes by ISO 841.
    let fanuc = blocks.replace("G43 H1\n", "").replace("M428", "G43.4 H1").replace("M429", "G49");
    let fanuc = fanuc.replace("G0 X0.", "G43 H1\nG0 X0.");
    walled(&fanuc).with("machine = \"A-C trunnion\"").gives(FANUC, CLEAN, &[]);
}

/// The axes of a head turn each by itself in LinuxCNC's kinematics, and some releases leave the length of the tool along z.
#[test]
fn linuxcnc_leaves_the_length_of_a_tilted_tool_along_z_in_some_releases() {
    let blocks = "T1 M6\nS9000 M3\nG43 H1\nG0 X0. Y0. Z60. B0. C0.\nM428\nG0 B30.\nG1 Z1.\nG1 Z60.\nG0 B0.\nM429";
    let scene = Scene::new(blocks).placed().with("machine = \"B head + C table\"");
    let linuxcnc = || ControlRules::named("linuxcnc").expect("a control");
    scene.gives_by(linuxcnc(), NONE, &["V0419 7 `head_length`"]);
    let compensated = linuxcnc().with(Rule::HeadLength, Choice::Compensated);
    scene.gives_by(compensated.clone(), CLEAN, &[]);
    let wall = scene.obstacle([-6.0, -3.0, 3.0], [-4.0, 3.0, 30.0]);
    wall.gives_by(
        compensated.clone(),
        FINDINGS,
        // All choices are named for which it holds.
        &["V0101 8 under rotary_direction = \"reversed\" or \"B reversed\""],
    );
    wall.gives_by(compensated.with(Rule::RotaryDirection, Choice::Iso841), CLEAN, &[]);
}

/// An endless table turns by -330 or by +30 degrees; a post on it is at 180.
#[test]
fn a_rotary_axis_counts_or_turns_the_shorter_way() {
    let blocks = "T1 M6\nS9000 M3\nG43 H1\nG0 A0. C345.\nG0 X20. Y0.\nZ5.\nG1 C15.\nG0 Z50.";
    let scene = Scene::new(blocks).placed().obstacle([-22.0, -2.0, -2.0], [-18.0, 2.0, 30.0]);
    let scene = scene.with("machine = \"A-C trunnion\"\nanyway = true");
    scene.gives(ANY, FINDINGS, &["V0101 8 the clamp", "V0101 8 under rotary = \"counts\""]);
    scene.gives(LINUXCNC, FINDINGS, &["V0101 8 the clamp"]);
    scene.gives(FANUC, CLEAN, &[]);
    // Half a turn is as short either way.
    let half = Scene::new(&blocks.replace("C15.", "C165.")).placed();
    let half = half.with("machine = \"A-C trunnion\"");
    half.gives(FANUC, NONE, &["V0411 8"]);
}

#[test]
fn limits_of_rotary_axes_need_no_work_offset() {
    let blocks = "T1 M6\nS9000 M3\nG43 H1\nM428\nG0 X0. Y0. Z30. A0. C0.\nG1 A45.\nG1 A0.";
    let scene = Scene::new(blocks).with("machine = \"A-C trunnion\"\nanyway = true");
    scene.gives(LINUXCNC, FINDINGS, &["V0108 7 A goes to 45.0000°, beyond its limit of 30°"]);
    let said = ["V0309 `work_offsets`"];
    scene.gives(LINUXCNC, FINDINGS, &said);
}

/// The shorter way holds for every stated angle: under G53, through G28, on an arc, and after a tilted plane.
#[test]
fn the_shorter_way_holds_for_every_stated_angle() {
    let start = "T1 M6\nS9000 M3\nG43 H1\nG0 X20. Y0. Z50. A0. C345.\nG0 Z5.\n";
    let post = ([18.0, -2.0, -2.0], [22.0, 2.0, 30.0]);
    for turn in ["G53 G0 C15.", "G28 C15.", "G2 X20. Y0. I-1. J0. C15.", "G0 C15."] {
        let scene = Scene::new(&format!("{start}{turn}\nG43 H1 G0 Z50.")).placed();
        let scene =
            scene.obstacle(post.0, post.1).with("machine = \"A-C trunnion\"\nanyway = true");
        scene.gives(FANUC, FINDINGS, &["V01 the clamp"]);
        scene.gives(ANY, FINDINGS, &["V01 the clamp"]);
    }
    let tilted = "T1 M6\nS9000 M3\nG43 H1\nG0 X20. Y0. Z50. A0. C-15.\nG68.2 X0. Y0. Z0. I165. J20. K0.\nG53.1\nG69\n\
                  G0 A0.\nG0 C345.\nG0 X20. Y0. Z5.\nG0 C15.\nG0 Z50.";
    let scene = Scene::new(tilted).placed().obstacle(post.0, post.1);
    let scene = scene.with("machine = \"A-C trunnion\"\nanyway = true");
    let stated = rules("fanuc")
        .with(Rule::TcpStart, Choice::TableAtZero)
        .with(Rule::ReferenceReturn, Choice::KeepsLength)
        .with(Rule::LengthChange, Choice::WithNextZ)
        .with(Rule::CycleRepeats, Choice::RepeatsByL);
    scene.gives_by(stated, FINDINGS, &["V01 the clamp"]);
}

/// Endless axes of Siemens turn between angles from 0 to 360.
#[test]
fn a_rotary_axis_turns_within_a_turn() {
    let blocks =
        "T1 M6\nS9000 M3\nG43 H1\nG0 X20. Y0. Z50. A0. C0.\nG91 C450.\nG90 Z5.\nG1 C280.\nG0 Z50.";
    let scene = Scene::new(blocks).placed().obstacle([-22.0, -2.0, -2.0], [-18.0, 2.0, 30.0]);
    let scene = scene.with("machine = \"A-C trunnion\"\nanyway = true");
    scene.gives_natively(FINDINGS, &["V0101 8 the clamp"]);
    scene.gives(LINUXCNC, CLEAN, &[]);
    scene.gives(ANY, FINDINGS, &["V0101 8 under rotary = \"within a turn\""]);
}

/// Fanuc takes the part as it stands where tool centre point control begins.
#[test]
fn tool_centre_point_control_begins_with_the_table_at_zero() {
    let blocks = "T1 M6\nS9000 M3\nG43.4 H1\nG0 X-6. Y0. Z20. A0. C0.\nG1 X-4. Z1.\nG0 Z50.";
    let turned = blocks.replace("G43.4 H1", "G0 A0. C90.\nG43.4 H1");
    let scene = |blocks: &str| {
        let scene = Scene::new(blocks).placed();
        scene.with("machine = \"A-C trunnion\"\nanyway = true")
    };
    scene(&turned).gives(FANUC, NONE, &["V0415 `tcp_start`"]);
    scene(&turned).gives(ANY, NONE, &["V0415 `tcp_start`"]);
    scene(&turned.replace("G43.4 H1", "G43 H1\nM428")).gives(LINUXCNC, CLEAN, &[]);
    let at_zero = blocks.replace("G43.4 H1", "G0 A0. C0.\nG43.4 H1");
    scene(&at_zero).gives(FANUC, CLEAN, &[]);
    let in_its_block = at_zero.replace("G43.4 H1", "G43.4 H1 C90.");
    scene(&in_its_block).gives(FANUC, NONE, &["P0120 5 G43.4"]);
    // It begins anew without a motion between, and so does a plane.
    let anew = format!("{at_zero}\nG1 C40.\nG49\nG43.4 H1\nG0 X-6. Y0. Z50.\nG49");
    scene(&anew).gives(FANUC, CLEAN, &["V0415 12", "V0415 `tcp_start`"]);
    let plane = "T1 M6\nS9000 M3\nG0 A0. C90.\nG43 H1 Z60.\nG68.2 X0 Y0 Z0 I0 J0 K0\nG53.1\nG0 X-6. Y0. Z20.";
    scene(plane).gives(FANUC, NONE, &["V0415 `tcp_start`"]);
    scene(&plane.replace("C90", "C0")).gives(FANUC, CLEAN, &[]);
    scene(&format!("{at_zero}\nG49 G0 X-7.")).gives(FANUC, NONE, &["P0120 9 G49"]);
    // An offset of the table turns the part, or does not.
    let mut offset = scene(&at_zero);
    offset.job = offset.job.replace("-400]", "-400, 0, 0, 30]");
    offset.gives(FANUC, CLEAN, &[]);
    for control in [HAAS, ANY] {
        offset.gives(control, NONE, &["K0808 G54"]);
    }
    offset.text = program(&at_zero.replace("G43.4 H1", "G43 H1\nM428"));
    offset.gives(LINUXCNC, NONE, &["K0808 G54"]);
}

/// A control computes tips with the length offset that is in force, also under tool centre point control.
#[test]
fn tool_centre_point_control_needs_a_length_offset() {
    let moves = "G0 X-6. Y0. Z20.\nG1 X-4. Z1.\nG0 Z50.";
    let scene = |blocks: &str| {
        let scene = Scene::new(&format!("T1 M6\nS9000 M3\nG0 A0. C0.\n{blocks}")).placed();
        scene.with("machine = \"A-C trunnion\"\nanyway = true")
    };
    let word = ["V0416"];
    for (control, start) in [
        (FANUC, "G43.4 H0"),
        (FANUC, "G43.4"),
        (FANUC, "G43.5 H0"),
        (HAAS, "G234 H0"),
        (LINUXCNC, "M428"),
        (LINUXCNC, "G43 H1\nM428\nG49"),
    ] {
        scene(&format!("{start}\n{moves}")).gives(control, NONE, &word);
    }
    let unknown = Scene::new(&format!("T1 M6\nS9000 M3\nG0 A0. C0.\nM428\n{moves}"));
    unknown.with("machine = \"A-C trunnion\"").gives(LINUXCNC, NONE, &word);
    for (control, start) in [
        (FANUC, "G43.4 H1"),
        (FANUC, "G43 H1 Z60.\nG68.2 X0 Y0 Z0 I0 J0 K0\nG53.1"),
        (LINUXCNC, "G43 H1\nM428"),
    ] {
        scene(&format!("{start}\n{moves}")).gives(control, CLEAN, &[]);
    }
}

/// In an aligned plane without a length offset the gauge point is where the program says: posts move X and Y so before G43, and retract.
#[test]
fn the_gauge_point_moves_in_a_plane_without_a_length_offset() {
    let scene = |blocks: &str| {
        let text = format!("T1 M6\nS9000 M3\nG0 A0. C0.\n{blocks}");
        Scene::new(&text).placed().with("machine = \"A-C trunnion\"\nanyway = true")
    };
    for tilt in [0, 30] {
        let plane = format!("G68.2 X0 Y0 Z0 I0 J{tilt} K0\nG53.1");
        let cut = |z: &str| {
            format!(
                "G53 G0 Z0.\nX-6. Y0.\n{plane}\nG0 X-6. Y0.\nG43 H1 Z20.\nG1 Z{z} F500.\nX-4.5\nG0 Z20.\nG69\nG49\nG53 Z0."
            )
        };
        scene(&cut("2.")).gives(FANUC, CLEAN, &[]);
        // The tip is 50 mm below the gauge point.
        let without = cut("2.").replace("G43 H1 Z20.", "G0 Z60.").replace("Z2. F500", "Z40. F500");
        scene(&without.replace("-4.5", "4.5")).gives(FANUC, FINDINGS, &["V0101"]);
        scene(&without.replace("Z40. F500", "Z55. F500").replace("-4.5", "4.5")).gives(
            FANUC,
            CLEAN,
            &[],
        );
    }
    for retract in ["SUPA G0 Z0 D0", "G53 G0 Z0 D0", "D0\nSUPA G0 Z0", "SUPA G0 Z-100"] {
        let text = format!(
            "G17 G90 G94 G71\nT1\nM6\nG54\nS9000 M3 D1\nSUPA G0 Z0\nG0 A0 C0\nG0 X-6 Y0\n\
             CYCLE800(0,\"\",0,57,0,0,0,30,0,0,0,0,0,1,0,1)\nD1\nG0 X-6 Y0\nG0 Z20\nG1 Z2 F500\nX-4.5\nG0 Z20\n{retract}\nCYCLE800()\nM30\n"
        );
        let scene =
            named("a.mpf", &text).placed().with("machine = \"A-C trunnion\"\nanyway = true");
        let checked = scene.check_by(native(Choice::DeselectsOffset));
        assert!(!checked.has("V0416") && !checked.has("P01"), "{retract}: {:#?}", checked.rows);
    }
}

/// After a tool change that leaves X and Y anywhere, a tilted plane is approached at the top of Z: first across the tool, then along it.
#[test]
fn a_tilted_plane_is_approached_from_the_top() {
    let scene = |above: &str, cut: &str| {
        let text = format!(
            "BEGIN PGM A MM\nTOOL CALL 1 Z S5000\nL Z+0 R0 FMAX M91\nM3\nPLANE SPATIAL SPA-30 SPB+0 SPC+0 TURN FMAX SEQ-\n{above}\n\
             L Z+20 R0 FMAX\nL Z{cut} R0 F500\nL X+4.5\nL Z+20 FMAX\nM5\nL Z+0 R0 FMAX M91\nPLANE RESET TURN FMAX\nM30\nEND PGM A MM\n"
        );
        named("a.h", &text).placed().with("machine = \"A-C trunnion\"")
    };
    scene("L X-6 Y+0 R0 FMAX", "+2").gives(HEIDENHAIN, CLEAN, &[]);
    scene("L X-6 Y+0 R0 FMAX", "-1").gives(HEIDENHAIN, FINDINGS, &["V0101 9 the part"]);
    // Only one of both is stated: where the tool comes down is not known.
    scene("L X-6 R0 FMAX", "+2").gives(HEIDENHAIN, NONE, &["V0403"]);
}

/// Under TRAORI the tool axis turns by the axes, or on a great circle, which is not followed.
#[test]
fn an_orientation_under_traori_is_stated() {
    let blocks = "T1 M6\nS9000 M3\nG0 A0. C0.\nTRAORI\nG54\nG0 X-6. Y0. Z20.\nG1 X-4. Z1.\nG0 Z20. A-10. C20.\nTRAFOOF\nG54";
    let scene = Scene::new(blocks).placed();
    let scene = scene.on("A-C trunnion", "name = ", "tool_change = \"stays\"\nname = ");
    scene.gives(SIEMENS, NONE, &["V0414 9 ORIVECT", "V0414 9"]);
    scene.gives_natively(CLEAN, &[]);
}

/// Posts of Autodesk write no work offset after TRAORI.
#[test]
fn the_work_offset_after_traori_is_deselected_or_kept() {
    let blocks = "T1 D1 M6\nS9000 M3\nG0 X-6. Y0. Z20. A0. C0.\nTRAORI\nX-5.\nG1 X-4. Z1.\nG0 Z20.\nTRAFOOF\nG0 Z60.";
    let scene = Scene::new(blocks).placed();
    let scene = scene.with("machine = \"A-C trunnion\"\nanyway = true");
    scene.gives_by(native(Choice::KeepsOffset), CLEAN, &[]);
    let needed = "P0119 6 since TRAORI";
    scene.gives_by(native(Choice::DeselectsOffset), NONE, &[needed]);
    scene.gives(SIEMENS, NONE, &[needed, "P0119 6 traori_offset"]);
}

/// A rotary axis without limits returns in a direction of the machine's.
#[test]
fn a_return_of_a_rotary_axis_is_not_the_shorter_way() {
    let blocks = "G43 H1 G0 X-6. Y0. Z20. A0. C10.\nG1 X-4. Z1.\nG0 Z50.\nG91 G28 C0.\nG90";
    let scene = Scene::new(blocks).placed().with("machine = \"A-C trunnion\"");
    scene.gives(FANUC, NONE, &["V0413 5"]);
    scene.gives(LINUXCNC, CLEAN, &[]);
}

/// Two positions of the rotary axes align the tool, and the nearer of one axis is not that of the other.
#[test]
fn an_alignment_that_controls_choose_in_different_ways_is_not_followed() {
    let blocks = |first: &str| {
        format!(
            "T1 M6\nS9000 M3\nG43 H1\nG0 X-6. Y0. Z50. {first}\nG68.2 X0. Y0. Z0. I170. J20. K0.\nG53.1\nG0 X0. Y0. Z50.\nG1 Z1.5\nG0 Z50.\nG69"
        )
    };
    let scene = |blocks: &str| {
        let scene = Scene::new(blocks).placed();
        scene.with("machine = \"A-C trunnion\"")
    };
    scene(&blocks("A5. C0.")).gives_by(straight(), NONE, &["V0412 7"]);
    scene(&blocks("A0. C0.")).gives_by(straight(), CLEAN, &[]);
}

/// In an aligned plane, too, each axis moves by itself.
#[test]
fn rapid_traverse_in_a_tilted_plane_is_any_dog_leg() {
    let blocks = "T1 M6\nS9000 M3\nG43 H1\nG0 X-10. Y-10. Z50. A0. C0.\nG68.2 X0. Y0. Z0. I0. J0. K0.\nG53.1\n\
                  G0 X-10. Y-10. Z1.\nX10. Y10. Z1.\nG1 Y12.\nG0 Z50.\nG69";
    let scene = Scene::new(blocks).placed().obstacle([4.0, -9.0, -2.0], [9.0, -4.0, 5.0]);
    let scene = scene.with("machine = \"A-C trunnion\"\nanyway = true");
    scene.gives(FANUC, FINDINGS, &["V0101 9 the clamp", "V0101 9 at some rates of its axes"]);
    scene.gives_by(straight(), CLEAN, &[]);
}

/// An axis that the program has not stated leaves all motions between stated positions unknown.
#[test]
fn an_axis_that_is_not_stated_is_named() {
    let blocks =
        "T1 M6\nS9000 M3\nG43 H1\nG0 X-6. Y0. Z20.\nG0 Z0.02\nG0 X6.\nG0 A0. C0.\nG1 X4. Z1.";
    let scene = Scene::new(blocks).placed().with("machine = \"A-C trunnion\"");
    scene.gives(LINUXCNC, NONE, &["V0402 6"]);
    let stated = Scene::new(&blocks.replace("Y0. Z20.", "Y0. Z20. A0. C0.")).placed();
    stated.with("machine = \"A-C trunnion\"").gives(LINUXCNC, CLEAN, &[]);
}

#[test]
fn a_length_that_counts_always_is_along_z_and_returns_with_d1() {
    let start = "G21 G90 G54 S9000 M3 F100.\nT1 M6\nS9000 M3\nG0 X-6. Y0. Z20.\n";
    let edge = Scene::of(&format!("{start}D0\nX-5.\nD1 Z20.\nG1 X4. Z1.\nM30\n")).placed();
    edge.with("anyway = true").gives_natively(CLEAN, &[]);
    let plane = Scene::of(&format!("{start}G18\nG0 Z21.\nM30\n")).placed();
    plane.gives_natively(NONE, &["P0120 6 G18"]);
    // An end near the start turns the arc of a control that moves its centre.
    let arc = Scene::of(&format!("{start}G0 X30.\nG3 X30.001 Y-0.1 I-30. J0.\nM30\n")).placed();
    arc.gives_natively(NONE, &["V0514 6"]);
    // The head of a program is that of one control.
    let head =
        "%PLATE G71 *\nN10 G90 G54 S9000 M3 F100.\nN20 G0 X-6. Y0. Z20.\nN99999999 %PLATE G71 *\n";
    Scene::of(head).gives(ANY, NONE, &["P0115 2 G54"]);
}

/// Motions in a plane whose tool is not along it, and the way in which the axes turn there.
#[test]
fn a_tilted_plane_is_aligned_in_rapid_traverse_before_its_first_position() {
    let scene = |blocks: &str| {
        let start = "T1 M6\nS9000 M3\nG0 A0. C0.\nG43 H1 Z60.\n";
        let scene = Scene::new(&format!("{start}{blocks}")).placed();
        scene.with("machine = \"A-C trunnion\"\nanyway = true")
    };
    let plane = "G68.2 X0 Y0 Z0 I0 J20. K0";
    scene(&format!("{plane}\nG53.1\nX-6. Y0. Z30.")).gives(FANUC, CLEAN, &[]);
    let not_aligned = "P0120 7 a length offset is in force in a tilted plane that is not aligned";
    scene(&format!("{plane}\nX-6. Y0. Z30.")).gives(FANUC, NONE, &[not_aligned]);
    let alone = scene(&format!("{plane}\nG53.1\nX-6. Y0. Z30.\nG69\nX-7."));
    alone.gives(FANUC, NONE, &["P0120 10 G68"]);
    let began = "G1 A-20. F500.\nG43.4 H1 Z60.";
    scene(began).gives_by(
        straight(),
        NONE,
        &["P0120 7 the first of tool centre point control that began with turned axes"],
    );
    scene("G234 X-6. Y0. Z30.").gives(HAAS, NONE, &["P0119 6 G234"]);
    let again = "G43.4 H1\nX-6. Y0. Z30.\nG43 H1";
    scene(again).gives(FANUC, NONE, &["P0120 8 G43"]);
    let tie = "G68.2 X0 Y0 Z0 I90. J25. K0\nG53.1\nX-6. Y0. Z30.\nG69";
    scene(tie).gives(FANUC, NONE, &["V0412 7"]);
    let in_feed = "P0120 8 G53.1";
    scene(&format!("G1 Z50.\n{plane}\nG53.1")).gives(FANUC, NONE, &[in_feed]);
}

/// Words whose values are positions of the work offset that TRAFOOF has deselected.
#[test]
fn words_after_trafoof_need_a_work_offset_as_positions_do() {
    for word in ["G52 X1.", "G92 X1.", "G28 Z50.", "G68 X0. Y0. R0."] {
        let start = "T1 D1 M6\nS9000 M3\nG0 X-6. Y0. Z20.\nTRAORI\nG54\nX-5.\nTRAFOOF";
        let scene = Scene::new(&format!("{start}\n{word}\nG54")).placed();
        let scene = scene.with("machine = \"A-C trunnion\"\nanyway = true");
        scene.gives_natively(NONE, &["P0119 9 since TRAORI and TRAFOOF deselect it"]);
    }
    // Parameters are no comment.
    for (word, verdict) in
        [("TRAORI(1)", CLEAN), ("TRAORI(1,0,0,1,30,0)", NONE), ("TRAORI(2)", NONE)]
    {
        let blocks = format!(
            "T1 D1 M6\nS9000 M3\nG0 X-6. Y0. Z20. A0. C0.\n{word}\nG54\nX-5.\nTRAFOOF\nG54\nG0 Z60."
        );
        let scene = Scene::new(&blocks).placed();
        scene.with("machine = \"A-C trunnion\"\nanyway = true").gives_natively(verdict, &[]);
    }
    let blocks = "T1 D1 M6\nS9000 M3\nG0 X-6. Y0. Z20. A0. C0.\nTRAORI\nG54\nG18 G0 X-5.";
    let scene = Scene::new(blocks).placed().with("machine = \"A-C trunnion\"\nanyway = true");
    scene.gives(SIEMENS, NONE, &["P0120 7 G18"]);
}
