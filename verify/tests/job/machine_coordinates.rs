//! Machine coordinates, tool changes and work offsets while the table is turned, and the ways from and to places that only the machine
//! knows: each with a body that the true motion meets.

use crate::in_the_way::{TRUNNION, named, scene};
use crate::scene::{
    CLEAN, Control, FANUC, FINDINGS, HAAS, HEIDENHAIN, LINUXCNC, NONE, SIEMENS, Scene, native,
};
use touchoff_verify::Verdict;
use touchoff_verify::gcode::{Choice, ControlRules, Rule};
use touchoff_verify::machine::{Letter, Link, Machine};

/// The origin of G54 on the trunnion, 40 mm above the axis of A.
const G54: &str = "[0, 0, -440]";

/// The line of the machine's file that states where a tool change leaves the axes.
const CHANGE: &str = "tool_change = { Z = 0 }";

/// Returns the rules of a Fanuc whose tool change leaves the axes where they are.
fn stays() -> ControlRules {
    crate::scene::rules("fanuc")
        .with(Rule::ToolChange, Choice::Stays)
        .with(Rule::ReferenceReturn, Choice::KeepsLength)
        .with(Rule::LengthChange, Choice::MovesZ)
        .with(Rule::TcpStart, Choice::TableAtZero)
}

fn klartext(blocks: &str) -> String {
    format!("BEGIN PGM A MM\nTOOL CALL 1 Z S1000\n{blocks}\nM30\nEND PGM A MM\n")
}

fn iso(blocks: &str) -> String {
    format!("G21 G90 G17 G94 G54 G0\nT1 M6\nS1000 M3\n{blocks}\nM30\n")
}

fn sinumerik(blocks: &str) -> String {
    format!("G17 G90 G54 G71 G94\nT1 M6\nD1\nS1000 M3\n{blocks}\nM30\n")
}

/// Machine coordinates turn the table alone, while X, Y and Z rest: the tool does not follow the part, as it does under tool centre point
/// control.
#[test]
fn an_axis_turns_alone_in_an_aligned_plane() {
    for (file, text, control) in [
        (
            "a.h",
            klartext(
                "L A+0 C+0 R0 FMAX M3\nL X+40 Y+0 Z+100 R0 FMAX\nPLANE SPATIAL SPA+0 SPB+0 SPC+0 TURN FMAX\nL X+40 Y+0 R0 FMAX\n\
                 L Z+5 R0 FMAX\nL C+90 R0 FMAX M91\nPLANE RESET STAY\nL Z+0 R0 FMAX M91",
            ),
            HEIDENHAIN,
        ),
        (
            "a.mpf",
            sinumerik(
                "G0 A0 C0\nG0 X40 Y0 Z100\nCYCLE800(0,\"TC\",100000,57,0,0,0,0,0,0,0,0,0,1,0)\nG0 X40 Y0\nG0 Z5\nSUPA G0 C90\n\
                 CYCLE800()\nSUPA G0 Z-100",
            ),
            SIEMENS,
        ),
        (
            "a.nc",
            iso(
                "G0 A0. C0.\nG0 X40. Y0.\nG43 H1 Z100.\nG68.2 X0. Y0. Z0. I0. J0. K0.\nG53.1\nG0 X40. Y0.\nG0 Z5.\nG53 C90.\n\
                 G53 Z0.\nG69",
            ),
            FANUC,
        ),
    ] {
        let scene = scene(file, &text, TRUNNION, G54).with("anyway = true");
        let scene = scene.obstacle([26.0, -32.0, 0.0], [31.0, 32.0, 60.0]);
        scene.gives(control, FINDINGS, &["V01 the clamp"]);
    }
    // The positions of the plane are not followed on the table that has left it.
    let text = klartext(
        "L A+0 C+0 R0 FMAX M3\nL X+40 Y+0 Z+100 R0 FMAX\nPLANE SPATIAL SPA+0 SPB+0 SPC+0 TURN FMAX\nL C+90 R0 FMAX M91\nL X+50 R0 F500",
    );
    scene("a.h", &text, TRUNNION, G54).gives(HEIDENHAIN, NONE, &["V0420 7"]);
    // Neither a shift nor tool centre point control aligns it anew.
    let text = sinumerik(
        "G0 A0 C0\nG0 X40 Y0 Z100\nCYCLE800(0,\"TC\",100000,57,0,0,0,0,0,0,0,0,0,1,0)\nG0 X40 Y0\nG0 Z50\nSUPA G0 C90\nATRANS Z0\n\
         G0 X40 Y0\nG1 Z5 F500",
    );
    scene("a.mpf", &text, TRUNNION, G54).gives(SIEMENS, NONE, &["V0420 12"]);
    let text = iso(
        "G0 A0. C0.\nG43 H1\nG0 X40. Y0. Z50.\nG68.2 X0. Y0. Z0. I0. J0. K0.\nG53.1\nG53 C90.\nG43.4 H1\nG0 X40. Y0. Z50.\nG49",
    );
    scene("a.nc", &text, TRUNNION, G54).gives_by(stays(), NONE, &["V0420 11"]);
}

/// A tool change under tool centre point control moves Z of the machine: the tip is beside the place that the program has stated.
#[test]
fn a_tool_change_under_tool_centre_point_control_moves_axes() {
    let change = "G1 X0. Y0. Z60. A-30. F1000\nT1 M6\nM3\nG0 Z20.\nG0 X0. Y0. Z150.\nG0 A0.\n";
    for (file, text, control) in [
        (
            "a.nc",
            iso(&format!(
                "G0 A0. C0.\nG0 X0. Y0.\nG43.4 H1\nG0 X0. Y0. Z5.\nG0 Z100.\n{change}G49\nG53 Z0."
            )),
            FANUC,
        ),
        (
            "a.mpf",
            sinumerik(&format!(
                "G0 A0 C0\nG0 X0 Y0 Z100\nTRAORI\nORIMKS ORIAXES\nG54\nG0 X0 Y0 Z5\nG0 Z100\n{change}TRAFOOF\nG54\nSUPA G0 Z0"
            )),
            SIEMENS,
        ),
    ] {
        let scene = scene(file, &text, TRUNNION, G54).with("anyway = true");
        let scene = scene.obstacle([-6.0, 150.0, -60.0], [6.0, 163.0, 60.0]);
        scene.gives(control, FINDINGS, &["V01 the clamp"]);
    }
    let text =
        klartext("L A+0 C+0 R0 FMAX M3\nL X+0 Y+0 Z+100 R0 FMAX\nM128\nTOOL CALL 1 Z S900\nM129");
    scene("a.h", &text, TRUNNION, G54).gives(HEIDENHAIN, NONE, &["P0120 6 M129"]);
}

/// The part is turned with the table by G54: an axis at 0 of another work offset, whose origin is turned, turns it.
#[test]
fn an_axis_at_zero_of_a_turned_work_offset_is_turned() {
    let traori = sinumerik(
        "G55\nG0 A0 C0\nG0 X30 Y0 Z100\nTRAORI\nORIMKS ORIAXES\nG54\nG1 Z5 F500\nG1 Z100\nTRAFOOF\nG54\nSUPA G0 Z-100",
    );
    let m128 = klartext(
        "CYCL DEF 247 DATUM SETTING ~\n  Q339=+2 ;DATUM NUMBER\nL A+0 C+0 R0 FMAX M3\nL X+30 Y+0 Z+100 R0 FMAX\nM128\n\
         CYCL DEF 247 DATUM SETTING ~\n  Q339=+1 ;DATUM NUMBER\nL Z+5 R0 F500\nL Z+100 R0 FMAX\nM129\nL Z+0 R0 FMAX M91",
    );
    for (file, text, control) in [("a.mpf", traori, SIEMENS), ("a.h", m128, HEIDENHAIN)] {
        let mut scene = scene(file, &text, TRUNNION, G54).with("anyway = true");
        scene.job += "G55 = [0, 0, -440, 0, 0, 90]\n[presets]\n1 = \"G54\"\n2 = \"G55\"\n";
        let scene = scene.obstacle([-6.0, 24.0, 0.0], [6.0, 36.0, 60.0]);
        scene.gives(control, FINDINGS, &["V01 the clamp"]);
    }
}

/// Controls differ in how a plane of a work offset that is turned against G54 stands to the part, from its alignment on.
#[test]
fn a_plane_of_a_turned_work_offset_is_not_aligned() {
    let refused: &[&str] = &["K0808"];
    for (angles, verdict, gaps) in
        [("0, 0, 0", CLEAN, &[][..]), ("0, 0, 90", NONE, refused), ("30, 0, 0", NONE, refused)]
    {
        let text = klartext(
            "CYCL DEF 247 DATUM SETTING ~\n  Q339=+2 ;DATUM NUMBER\nL A+0 C+0 R0 FMAX M3\nL X+0 Y+0 R0 FMAX\nL Z+1 R0 FMAX\n\
             L Z+0 R0 FMAX M91\nPLANE SPATIAL SPA-20 SPB+0 SPC+0 TURN FMAX\nPLANE RESET TURN FMAX",
        );
        let mut scene = scene("a.h", &text, TRUNNION, G54);
        scene.job +=
            &format!("G55 = [0, 0, -440, {angles}]\n[presets]\n1 = \"G54\"\n2 = \"G55\"\n");
        scene.gives(HEIDENHAIN, verdict, gaps);
    }
}

/// The first way in X and Y, or of rotary axes, at a known Z below the part's top, wherever it begins.
#[test]
fn a_first_way_below_the_top_is_not_checked() {
    let upright = "G0 A0. C0.\n";
    let first = "G0 X4.5 Y0.\nG1 X4.4 F500\nG0 Z100.";
    for (blocks, high) in [
        (format!("{upright}G43 H1 ZLEVEL\n{first}"), CLEAN),
        (format!("{upright}G43 H1 ZLEVEL\nG68 X0. Y0. R90.\nG0 X0. Y-4.5\nG69\n{first}"), CLEAN),
        (format!("{upright}G43.4 H1 ZLEVEL\nG0 X4.5 Y0.\nG49\nG43 H1 ZLEVEL\n{first}"), CLEAN),
        // The level is along the tool.
        (format!("G0 A-30. C0.\nG43 H1 ZLEVEL\nG0 X4.5 Y0.\nG0 A0.\n{first}"), CLEAN),
        // It goes home before it moves sideways.
        (format!("{upright}G43 H1 ZLEVEL\nG53 G0 Z0.\nG0 X4.5 Y0.\nG0 Z1.\n{first}"), CLEAN),
        // In a plane, in which Z is that of the plane.
        (
            format!(
                "{upright}G43 H1 ZLEVEL\nG68.2 X0. Y0. Z0. I0. J0. K0.\nG53.1\nG53 X20. Y0.\nG53 Z0.\nG69\nG0 X4.5 Y0.\nG0 Z1.\n{first}"
            ),
            CLEAN,
        ),
        // A table that tilts from an angle that is not known swings the part against the tool.
        (format!("G43 H1 ZLEVEL\nG0 X4.5 Y0.\n{upright}{first}"), NONE),
        (format!("G0 X4.5 Y0.\nG43 H1 ZLEVEL\n{upright}{first}"), NONE),
        (format!("G43 H1 ZLEVEL\nG0 X-60. Y0.\nG53 G0 Z0.\n{upright}{first}"), NONE),
        (format!("G0 A-90. C0.\nG43 H1 ZLEVEL\nG0 X0. Y60. A0.\n{first}"), NONE),
        (format!("G43.4 H1\nG0 X4.5 Y0. ZLEVEL\n{upright}G49\nG43 H1 ZLEVEL\n{first}"), NONE),
    ] {
        // The part swings up by 0.11 mm.
        let above = if high == CLEAN { "1." } else { "0.1" };
        for (level, verdict) in [("-10.", NONE), (above, high)] {
            let text = iso(&blocks.replace("LEVEL", level));
            let machine = &TRUNNION.replace(CHANGE, "");
            let gap: &[&str] = if verdict == NONE { &["V0607"] } else { &[] };
            scene("a.nc", &text, machine, G54).gives_by(stays(), verdict, gap);
        }
    }
    // Above all that it swings, and at the top of Z, the table may tilt from anywhere.
    let text = iso(&format!("G43 H1 Z100.\nG0 X4.5 Y0.\n{upright}G0 Z1.\n{first}"));
    scene("a.nc", &text, &TRUNNION.replace(CHANGE, ""), G54).gives_by(stays(), CLEAN, &[]);
    let text = iso(&format!("G53 G0 Z0.\n{upright}G0 X4.5 Y0.\nG43 H1 Z1.\n{first}"));
    scene("a.nc", &text, TRUNNION, G54).gives(HAAS, CLEAN, &[]);
    // G49 leaves the height to the machine, and X and Y go home from there.
    let text =
        iso("G0 X4.5 Y0.\nG43 H1 Z100.\nG0 Z-1.\nG1 X4.4 F500\nG49\nG53 G0 X-60. Y0.\nG53 G0 Z0.");
    named("a.nc", &text).gives(LINUXCNC, NONE, &["V0407 9"]);
}

/// Bodies of the machine have a height over the part, too, unless axes between raise them or tilt the part.
#[test]
fn a_first_way_is_above_the_bodies_of_the_machine() {
    let text = |level: &str| {
        let blocks = "G0 A0. C0.\nG43 H1 ZLEVEL\nG0 X0. Y0.\nG1 Z1. F500\nG0 Z100.";
        iso(&blocks.replace("LEVEL", level))
    };
    let low = ([40.0, -5.0, -460.0], [50.0, 5.0, -420.0]);
    let z = "{ letter = \"Z\", kind = \"linear\", carries = \"tool\", rapid = 10000 },";
    let raised = TRUNNION
        .replace(z, "")
        .replace("axis = [", &format!("axis = [\n{}", z.replace("tool", "table")));
    for (machine, link, level, verdict) in [
        (TRUNNION, Link::Axis(Letter::C), "30.", CLEAN),
        (TRUNNION, Link::Axis(Letter::C), "10.", NONE),
        (TRUNNION, Link::Base, "30.", CLEAN),
        (TRUNNION, Link::Base, "10.", NONE),
        // Z of the table moves the part alone: the tool stays 340 mm above the body.
        (&raised, Link::Base, "10.", CLEAN),
        // What the head carries is beside the tool, wherever the others are.
        (TRUNNION, Link::Axis(Letter::X), "30.", NONE),
    ] {
        let scene =
            scene("a.nc", &text(level), &machine.replace(CHANGE, ""), G54).body(low.0, low.1, link);
        let gaps: &[&str] = if verdict == NONE { &["V0607 5 the clamp"] } else { &[] };
        scene.gives_by(stays(), verdict, gaps);
    }
    // A column is out of the way at the top of Z's travel.
    let text = iso("G0 A0. C0.\nG0 X0. Y0.\nG43 H1 Z1.\nG1 Z1. F500\nG0 Z100.");
    let column = scene("a.nc", &text, TRUNNION, G54);
    column.body([-5.0, 300.0, -900.0], [5.0, 310.0, 400.0], Link::Base).gives(HAAS, CLEAN, &[]);
}

/// A tool change at a stated Z leaves X and Y where they are: from there the first way is judged by its level.
#[test]
fn the_first_way_after_a_change_at_a_stated_height_has_a_level() {
    for (level, verdict, gaps) in [("Z100.", CLEAN, &[][..]), ("Z-1.", NONE, &["V0607"])] {
        let text = iso(&format!("G0 G43 H1 {level}\nG0 X4.5 Y0.\nG0 Z-1.\nG1 X4.4 F500\nG0 Z100."));
        let (name, machine) = ("name = \"3-axis\"", Machine::file("3-axis").expect("a machine"));
        let scene = scene("a.nc", &text, &machine.replace(name, &format!("{name}\n{CHANGE}")), G54);
        scene.gives(HAAS, verdict, gaps);
    }
}

/// The direction of CYCLE800 selects one of two positions of the rotary axes: on the way to one of them the table turns a post into the tool.
#[test]
fn the_direction_of_a_swivel_selects_the_position() {
    let scene = |direction: i32| {
        let text = sinumerik(&format!(
            "G0 A0 C10\nG0 X40 Y0 Z100\nG0 Z5\nCYCLE800(0,\"TC\",100000,57,0,0,0,-20,0,0,0,0,0,{direction},0)\nSUPA G0 Z-100\n\
             CYCLE800()\nG0 A0 C0\nG0 X0 Y0\nG0 Z1\nSUPA G0 Z-100"
        ));
        let scene = scene("a.mpf", &text, TRUNNION, G54);
        scene.obstacle([-32.0, -32.0, -40.0], [-26.0, 32.0, 60.0])
    };
    let by = |choice| native(Choice::DeselectsOffset).with(Rule::SwivelAxis, choice);
    let verdicts = |choice| [-1, 1].map(|direction| scene(direction).check_by(by(choice)).verdict);
    assert_eq!(verdicts(Choice::SecondAxis), [CLEAN, FINDINGS]);
    assert_eq!(verdicts(Choice::FirstAxis), [FINDINGS, CLEAN]);
    // Without the axis both are checked.
    for direction in [-1, 1] {
        scene(direction).gives_natively(FINDINGS, &["V01 under swivel_axis"]);
    }
}

/// Retracts and ends of programs as posts write them, and the blocks beside them of which only the machine knows the way.
#[test]
fn retracts_are_followed_as_far_as_the_machine_states_them() {
    let aligned = "L A+0 C+0 R0 FMAX M3\nL X+0 Y+0 R0 FMAX\nL Z+1 R0 FMAX\nL Z+100 R0 FMAX\nPLANE SPATIAL SPA-20 SPB+0 SPC+0 TURN FMAX\n\
                   L X+0 Y+0 R0 FMAX\nL Z+50 R0 FMAX\nL Z+0 R0 FMAX M91\nPLANE RESET TURN FMAX";
    let tilted = "L A+0 C+0 R0 FMAX M3\nL X+0 Y+0 Z+100 R0 FMAX\nL Z+1 R0 FMAX\nL Z+100 R0 FMAX\nL A-30 R0 FMAX\nL M140 MB50 FMAX\n\
                  L Z+0 R0 FMAX M91";
    let builder = "L A+0 C+0 R0 FMAX M3\nL X+0 Y+0 Z+100 R0 FMAX\nL Z+1 R0 FMAX\nL Z+100 R0 FMAX\nL Z+0 R0 FMAX M92";
    let rotary = "L A+0 C+0 R0 FMAX M3\nL X+40 Y+0 Z+100 R0 FMAX\nPLANE SPATIAL SPA+0 SPB+0 SPC+0 TURN FMAX\nL X+40 Y+0 R0 FMAX\n\
                  L Z+1 R0 FMAX\nCC X+0 Y+0\nC X+0 Y+40 C+90 DR+ F500";
    let to_top = aligned.replace("L Z+0 R0 FMAX M91", "L M140 MB MAX FMAX");
    let rows: [(&str, Verdict, &[&str]); 5] = [
        (aligned, CLEAN, &[]),
        (&to_top, NONE, &["V0404 11"]),
        (tilted, CLEAN, &[]),
        (builder, NONE, &["V0404 7"]),
        (rotary, NONE, &["P0120 9 PLANE RESET"]),
    ];
    for (blocks, verdict, gaps) in rows {
        let scene = scene("a.h", &klartext(blocks), TRUNNION, G54);
        scene.gives(HEIDENHAIN, verdict, gaps);
    }
    // A table tilts, and the tool stays along Z.
    let limited = TRUNNION.replace(r#"letter = "Z","#, r#"letter = "Z", limits = [-600, 0],"#);
    scene("a.h", &klartext(&to_top), &limited, G54).gives(HEIDENHAIN, CLEAN, &[]);
    let steps = "G0 X4.5 Y0.\nG43 H1 Z100.\nG0 Z-1.\nG1 X4.4 F500\nG0 Z100.\n";
    let three_axes =
        |blocks: &str, control: Control, machine: [&str; 2], verdict, gaps: &[&str]| {
            let text = iso(&format!("{steps}{blocks}"));
            let scene: Scene = named("a.nc", &text).on("3-axis", machine[0], machine[1]);
            let mut scene = scene;
            scene.job = scene.job.replace("LENGTH", "length = 50");
            scene.gives(control, verdict, gaps);
        };
    let same = ["letter = \"Z\"", "letter = \"Z\""];
    three_axes("G91 G28 Z0.\nG28 X0. Y0.", HAAS, same, CLEAN, &[]);
    three_axes("G53 G0 Z0.", HAAS, same, CLEAN, &[]);
    // Z rises to 500 on this machine.
    three_axes("G53 G0 Z0.", HAAS, ["limits = [-500, 0]", "limits = [0, 500]"], NONE, &["V0404"]);
}

/// An axis about which the tool can be turned freely is left, or turned to a place of the control's own: what comes after it is not
/// known, unless the axis stands at 0.
#[test]
fn a_free_axis_is_known_at_zero_alone() {
    let plane = |first: &str| {
        klartext(&format!(
            "L A+0 C+0 R0 FMAX M3\nL X+0 Y+0 FMAX\nL Z+150 FMAX\nPLANE SPATIAL {first} TURN FMAX SEQ-\nL X+0 Y+0 Z+150 FMAX\n\
             PLANE SPATIAL SPA+0 SPB+0 SPC+0 TURN FMAX\nPLANE RESET STAY\nL Z+150 FMAX\nL X+60 Y+0 FMAX\nL Z+10 F500\n\
             L Z+150 FMAX"
        ))
    };
    let scene = |file, text: &str| scene(file, text, TRUNNION, G54);
    scene("a.h", &plane("SPA-30 SPB+0 SPC+80")).gives(HEIDENHAIN, NONE, &["V04 first at line 8"]);
    let upright = scene("a.h", &plane("SPA-30 SPB+0 SPC+0")).with("anyway = true");
    assert!(!upright.check(HEIDENHAIN).rows.iter().any(|row| row.is("V04 first at line 8")));
    let swivel = |turn: &str| {
        sinumerik(&format!(
            "G0 A0 C0\nG0 X0 Y0\nG0 Z150\nCYCLE800(0,\"TABLE\",0,39,0,0,0,{turn},-30,0,0,0,0,-1)\nG0 X0 Y0 Z150\n\
             CYCLE800(0,\"TABLE\",0,39,0,0,0,0,0,0,0,0,0,-1)\nCYCLE800()\nG0 Z150\nG0 X60 Y0\nG1 Z10 F500\nG0 Z150"
        ))
    };
    scene("a.mpf", &swivel("80")).gives(SIEMENS, NONE, &["V04 first at line 10"]);
}

/// Heidenhain turns an axis to an angle from -180 to 180 degrees as to one that is programmed, and not by the shortest way.
#[test]
fn an_alignment_turns_an_axis_the_way_of_its_rule() {
    let text = |way: &str| {
        klartext(&format!(
            "L A+0 C+0 R0 FMAX M3{way}\nL X+0 Y+0 FMAX\nL Z+150 FMAX\nL C+150 FMAX\nL C+300 FMAX\nPLANE SPATIAL SPA-30 SPB+0 SPC+300 \
             STAY SEQ-\nL A+Q120 C+Q122 FMAX\nL X+0 Y+47 Z+150 FMAX\nL Z+38.67 FMAX\nPLANE SPATIAL SPA-30 SPB+0 SPC+10 STAY SEQ-\n\
             L A+Q120 C+Q122 FMAX\nL Z+150 FMAX\nPLANE RESET STAY\nL Z+0 R0 FMAX M91"
        ))
    };
    let post = |way: &str| {
        let limited =
            TRUNNION.replace("point = [0, 0, -480]", "point = [0, 0, -480], limits = [-120, 20]");
        let scene = scene("a.h", &text(way), &limited, G54).with("anyway = true");
        scene.obstacle([-35.0, -64.0, -40.0], [-16.0, -45.0, 34.0])
    };
    let rotary = |choice| crate::scene::rules("heidenhain").with(Rule::Rotary, choice);
    post("").gives_by(rotary(Choice::WithinTurn), FINDINGS, &["V0101 13 the clamp"]);
    post("").gives_by(rotary(Choice::Shortest), CLEAN, &[]);
    post(" M126").gives_by(rotary(Choice::WithinTurn), CLEAN, &[]);
    // 300 degrees may count as -60, to which it would turn all around.
    assert!(post("").check_by(rotary(Choice::Counts)).has("V04 first at line 9"));
    // An axis with limits turns to the angle itself: from -135 by 225 degrees, and not by -135.
    let text = klartext(
        "L A+0 C+0 R0 FMAX M3\nL X+0 Y+0 FMAX\nL Z+150 FMAX\nL C-135 FMAX\nPLANE SPATIAL SPA+45 SPB+0 SPC-135 TURN FMAX SEQ+\n\
         L X+0 Y-35.36 FMAX\nL Z+49.5 FMAX\nPLANE SPATIAL SPA+0 SPB+45 SPC+0 TURN FMAX SEQ+\nL Z+150 FMAX\nPLANE RESET STAY\n\
         L Z+0 R0 FMAX M91",
    );
    let limited =
        TRUNNION.replace("point = [0, 0, -500]", "point = [0, 0, -500], limits = [-9999, 9999]");
    let limited = scene("a.h", &text, &limited, G54).with("anyway = true");
    let limited = limited.obstacle([-35.0, -64.0, -40.0], [-16.0, -45.0, 34.0]);
    limited.gives(HEIDENHAIN, FINDINGS, &["V0101 10 the clamp"]);
}

/// Machine coordinates across the plane, and a retract in a frame whose z is not the tool's.
#[test]
fn lengths_across_the_plane_and_retracts_beside_the_tool_are_refused() {
    let scene = |blocks: &str| scene("a.mpf", &sinumerik(blocks), TRUNNION, G54);
    scene("G0 A0 C0\nG18\nG0 SUPA Z-430").gives(SIEMENS, NONE, &["P0120 7 G18"]);
    let tilted = "G0 A0 C0\nG0 X0 Y0\nG0 Z150\nCYCLE800(0,\"TABLE\",0,57,0,0,0,-30,0,0,0,0,0,-1)\nG0 X0 Y-60\nG0 Z40\nAROT X40\n\
         G0 X0 Y10 Z10\nCYCLE800(5,\"TABLE\",0,57,0,0,0,-30,0,0,0,0,0,-1,100)\nG0 X0 Y0 Z150";
    scene(tilted).gives(SIEMENS, NONE, &["P0120 12"]);
}

/// A change to the tool in the spindle leaves Z where it is: machine coordinates of other axes are no way home from there.
#[test]
fn a_height_that_a_tool_change_leaves_is_no_way_home() {
    let text = |block: &str| {
        klartext(&format!(
            "L Z+0 R0 FMAX M91\nL X+0 Y+0 R0 FMAX M91\nL A+0 C+0 R0 FMAX M3\nL X+0 Y+0 FMAX\nL Z+100 FMAX\nL Z+1 F500\nL Z+100 FMAX\nL X+60 FMAX\nL Z-10 F500\nTOOL CALL 1 Z S1000\nM3\n{block}\nL Z+0 R0 FMAX M91"
        ))
    };
    let machine = TRUNNION.replace("tool_change = { Z = 0 }", "");
    let scene = |block: &str| scene("a.h", &text(block), &machine, G54);
    scene("L X-60 R0 FMAX M91").gives(HEIDENHAIN, NONE, &["V0403 14"]);
    scene("L X-60 Z+0 R0 FMAX M91").gives(HEIDENHAIN, NONE, &["V0403 14"]);
    scene("").gives(HEIDENHAIN, CLEAN, &[]);
}

/// SUPA takes positions, with the length along Z: neither the ways of single axes nor a head that is turned.
#[test]
fn machine_coordinates_have_no_ways_of_their_own() {
    let on_table = |blocks: &str| scene("a.mpf", &sinumerik(blocks), TRUNNION, G54);
    let start = "G0 A0 C0\nG0 X0 Y0\nG0 Z2";
    for block in ["SUPA Z=IC(-100)", "SUPA C=DC(10)", "G53 X=AC(5)"] {
        on_table(&format!("{start}\nG0 {block}")).gives(SIEMENS, NONE, &["P0120 8 G53"]);
    }
    let head = "G0 B0 C0\nG0 X0 Y0\nG0 Z100\nG0 B60\nG0 SUPA X-60";
    let scene = scene("a.mpf", &sinumerik(head), crate::in_the_way::B_HEAD, G54);
    scene.gives(SIEMENS, NONE, &["P0120 9 SUPA"]);
}

/// An axis tilts the tool by its direction, whatever its letter is.
#[test]
fn a_retract_is_along_a_head_that_any_letter_tilts() {
    let swapped = crate::in_the_way::B_HEAD
        .replace("letter = \"C\"", "letter = \"?\"")
        .replace("letter = \"B\"", "letter = \"C\"")
        .replace("letter = \"?\"", "letter = \"B\"");
    for (machine, tilting, turning) in [(crate::in_the_way::B_HEAD, "B", "C"), (&swapped, "C", "B")]
    {
        for distance in ["60", "MAX"] {
            let blocks = format!(
                "L {tilting}+0 {turning}+0 R0 FMAX M3\nL X+0 Y+0 Z+100 FMAX\nL {tilting}+60 FMAX\nL M140 MB {distance} FMAX"
            );
            let scene = scene("a.h", &klartext(&blocks), machine, G54).with("anyway = true");
            assert!(scene.check(HEIDENHAIN).has("V0404 6"), "{tilting} {distance}");
        }
    }
}

/// The limits of axes hold where a way begins at an unknown place, after sums of increments, and for a way home.
#[test]
fn limits_hold_at_known_ends_and_up_to_rounding() {
    let limited = TRUNNION
        .replace(
            "carries = \"tool\", rapid = 10000 },\n        { letter = \"Z\"",
            "carries = \"tool\", rapid = 10000, limits = [-350, 350] },\n        { letter = \"Z\"",
        )
        .replace("point = [0, 0, -480]", "point = [0, 0, -480], limits = [-120, 30]");
    assert!(limited.contains("350") && limited.contains("-120"));
    let on = |blocks: &str| scene("a.nc", &iso(blocks), &limited, G54).with("anyway = true");
    on("G43 H1 G0 X400. Y0. Z100. A0. C0.\nT1 M6").gives(
        FANUC,
        FINDINGS,
        &["V0108 4 X goes to 400"],
    );
    let sum = format!("G0 X0. Y0. A0. C0.\nG43 H1 Z100.\nG91\n{}G90", "G1 A0.6 F100.\n".repeat(50));
    assert!(!on(&sum).check(FANUC).has("V0108"));
    // Z rises to its upper limit, and not by the whole of its travel.
    let roof = |height: f64| {
        let machine = TRUNNION.replace(
            "letter = \"Z\", kind = \"linear\"",
            "letter = \"Z\", kind = \"linear\", limits = [-800, 0]",
        );
        let home = scene(
            "a.nc",
            &iso("G0 X0. Y0. A0. C0.\nG43 H1 Z100.\nG1 Z9. F100.\nG28 G91 Z0."),
            &machine,
            G54,
        );
        home.obstacle([-9.0, -9.0, height], [9.0, 9.0, height + 9.0]).check(FANUC).has("V0101")
    };
    // The tip ends at 440 - 80 above the part, and the tool at 400.
    assert!(roof(370.0) && !roof(410.0));
}
