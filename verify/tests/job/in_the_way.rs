//! Programs whose motion hits, though one reading of a word would not: each beside the same motion in other words.

use crate::scene::{
    CLEAN, FANUC, FINDINGS, HAAS, HEIDENHAIN, LINUXCNC, NONE, SIEMENS, Scene, native,
};
use touchoff_verify::gcode::Choice;
use touchoff_verify::machine::{Letter, Link, Machine};

/// A B axis that tilts the spindle 160 mm above its gauge point, over a table C.
pub(crate) const B_HEAD: &str = r#"
    name = "B head"
    tool_change = { Z = 0 }
    axis = [
        { letter = "X", kind = "linear", carries = "table" },
        { letter = "C", kind = "rotary", carries = "table", direction = [0, 0, 1], point = [0, 0, -600] },
        { letter = "Y", kind = "linear", carries = "tool" },
        { letter = "Z", kind = "linear", carries = "tool" },
        { letter = "B", kind = "rotary", carries = "tool", direction = [0, 1, 0], point = [0, 0, 160] },
    ]"#;

/// A trunnion A with a table C.
pub(crate) const TRUNNION: &str = r#"
    name = "trunnion"
    tool_change = { Z = 0 }
    axis = [
        { letter = "Y", kind = "linear", carries = "table", rapid = 10000 },
        { letter = "A", kind = "rotary", carries = "table", direction = [1, 0, 0], point = [0, 0, -480], rapid = 10000 },
        { letter = "C", kind = "rotary", carries = "table", direction = [0, 0, 1], point = [0, 0, -500], rapid = 10000 },
        { letter = "X", kind = "linear", carries = "tool", rapid = 10000 },
        { letter = "Z", kind = "linear", carries = "tool", rapid = 10000 },
    ]"#;

pub(crate) fn named(file: &'static str, text: &str) -> Scene {
    let mut scene = Scene::of(text);
    scene.file = file;
    scene.job = scene.job.replace("a.nc", file);
    scene
}

pub(crate) fn scene(file: &'static str, text: &str, machine: &str, offset: &str) -> Scene {
    let mut scene =
        named(file, text).with_file("mine.toml", machine).with("machine = \"mine.toml\"");
    scene.job = scene.job.replace("LENGTH", "length = 80");
    scene.job += &format!("[work_offsets]\nG54 = {offset}\n");
    scene
}

/// The same path at any rate: an arc at FMAX about a centre is no chord.
#[test]
fn an_arc_in_rapid_traverse_is_an_arc() {
    let arcs = [
        "CC X+0 Y+0\nC X+50 Y+0 DR- FEED",
        "CC X+0 Y+0\nCP IPA-180 DR- FEED",
        "CR X+50 Y+0 R+50 DR- FEED",
    ];
    for arc in arcs {
        for feed in ["F9000", "FMAX"] {
            let text = format!(
                "BEGIN PGM A MM\nTOOL CALL 1 Z S1000\nL X-50 Y+0 R0 FMAX M3\nL Z+5 R0 FMAX\n{}\nL Z+100 R0 FMAX\nM30\n\
                 END PGM A MM\n",
                arc.replace("FEED", feed)
            );
            let scene = named("a.h", &text).placed().with("anyway = true");
            let hit = scene.obstacle([-5.0, 45.0, 0.0], [5.0, 55.0, 20.0]);
            hit.gives(HEIDENHAIN, FINDINGS, &["V0101 the clamp"]);
            let scene = named("a.h", &text).placed().with("anyway = true");
            scene.obstacle([-5.0, -5.0, 0.0], [5.0, 5.0, 20.0]).gives(HEIDENHAIN, CLEAN, &[]);
        }
    }
}

/// The head stands at 30°, by the origin of B or by its angle. Under TRAORI an axis that is not programmed stays.
#[test]
fn an_origin_of_an_axis_of_the_head_turns_the_tool() {
    for (offset, b) in [("[0, 0, -440, 0, 30, 0]", "B0"), ("[0, 0, -440, 0, 0, 0]", "B30")] {
        let text = format!(
            "G17 G90 G54 G71 G94\nT1 M6\nD1\nS1000 M3\nG0 {b} C0\nG0 X0 Y0 Z100\nTRAORI\nORIMKS ORIAXES\nG54\nG1 Z10 F500\n\
             G1 X0 Y0 Z200\nTRAFOOF\nG54\nG0 {b} C0\nG0 X0 Y0 Z100\nM30\n"
        );
        let scene = scene("a.mpf", &text, B_HEAD, offset);
        let scene = scene.obstacle([-124.0, -4.0, 40.0], [-116.0, 4.0, 60.0]);
        scene.gives(SIEMENS, FINDINGS, &["V0101 10 the clamp"]);
    }
}

/// After TRAFOOF the rotary axes stand where the program turns them, whatever tool vector was in force before.
#[test]
fn a_tool_vector_ends_with_the_transformation() {
    let text = "G17 G90 G54 G71 G94\nT1 M6\nD1\nS1000 M3\nG0 B0 C0\nG0 X0 Y0 Z100\nTRAORI\nORIWKS\nG54\n\
                G1 X0 Y0 Z100 A3=0.5 B3=0 C3=0.8660254 F500\nTRAFOOF\nG54\nG0 B0 C0\nG0 X0 Y0 Z100\nG1 Z50\nG0 Z100\nM30\n";
    let scene = scene("a.mpf", text, B_HEAD, "[0, 0, -440]");
    let scene = scene.obstacle([-4.0, -4.0, 40.0], [4.0, 4.0, 60.0]);
    scene.gives_by(native(Choice::KeepsOffset), FINDINGS, &["V0101 15 the clamp"]);
}

/// M140 retracts along the tool, wherever the datum of its axis is.
#[test]
fn a_retract_along_a_tilted_tool_is_not_one_along_z() {
    for (shift, b, verdict) in [("0", "0", CLEAN), ("30", "0", NONE), ("0", "30", NONE)] {
        let text = format!(
            "BEGIN PGM A MM\nTOOL CALL 1 Z S1000\nL B+0 C+0 R0 FMAX M3\nL X-30 Y+0 Z+200 R0 FMAX\n\
             CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 B+{shift}\nL B+{b} R0 FMAX\nL Z+50 R0 FMAX\nL M140 MB50 FMAX\n\
             CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 B+0\nM30\nEND PGM A MM\n"
        );
        let scene = scene("a.h", &text, B_HEAD, "[0, 0, -440]");
        // Nothing is near the part.
        let scene = if verdict == CLEAN { scene.with("anyway = true") } else { scene };
        let scene = scene.obstacle([200.0, 200.0, 0.0], [210.0, 210.0, 10.0]);
        let gap: &[&str] = if verdict == NONE { &["V0404 9"] } else { &[] };
        scene.gives(HEIDENHAIN, verdict, gap);
    }
}

/// The coordinates of a plane that begins on a turned table are those of the part as it stands, also if the plane is the one
/// before.
#[test]
fn a_plane_that_begins_again_on_a_turned_table_is_another() {
    let plane = "G68.2 X0. Y0. Z0. I0. J0. K0.";
    for turn in [format!("{plane}\nG0 X0. Y0.\nG0 C90.\nG69\n{plane}"), format!("G0 C90.\n{plane}")]
    {
        let text = format!(
            "G21 G90 G17 G94 G54\nT1 M6\nS1000 M3\nG0 A0. C0.\nG0 X0. Y0.\nG43 H1 Z20.\n{turn}\nG53.1\nG1 X15. Y0. F500.\n\
             G1 Z5.\nG1 Z20.\nG0 X0. Y0.\nG69\nG0 X0. Y0.\nG0 Z20.\nM30\n"
        );
        let scene = scene("a.nc", &text, TRUNNION, "[0, 0, -440]");
        let scene = scene.obstacle([-4.0, 11.0, 0.0], [4.0, 19.0, 15.0]);
        scene.gives(FANUC, NONE, &["V0415"]);
    }
}

/// After a tool change that stays, a longer tool stands in the stock: a rest cuts nothing, whatever the motion after it is.
#[test]
fn a_longer_tool_that_stands_in_the_stock_is_found() {
    for word in ["G0", "G1"] {
        let text = format!(
            "G21 G90 G17 G94 G54\nT1 M6\nS1000 M3\nG0 X0 Y0\nG43 H1 Z5\nG1 X20 F200\nM5\nT2 M6\nS1000 M3\nG43 H2\n\
             {word} X10 F200\nG0 Z20\nM2\n"
        );
        let mut scene =
            Scene::of(&text).placed().on("3-axis", "name = ", "tool_change = \"stays\"\nname = ");
        scene.job = scene
            .job
            .replace("length = 50", "length = 50\n[tool.2]\ntool = \"D2Ball\"\nlength = 70");
        scene.job += "[stock]\nbox = [[-30, -30, -40], [30, 30, 0]]\nspacing = 1\n";
        let scene = scene.with("anyway = true");
        scene.gives(LINUXCNC, FINDINGS, &["V0110 11"]);
    }
}

/// At some rates the ball runs 0.88 mm deep along the face of a block: more than the resolution allows.
#[test]
fn a_box_of_rapid_traverse_keeps_the_resolution_once() {
    let text =
        "G21 G90 G17 G94 G54\nT1 M6\nS1000 M3\nG0 X-60 Y4.12\nG43 H1 Z-1\nG0 X60 Y16.92\nM30\n";
    let ball = "tool Ball { units mm; profile { start (0, 0); arc to (5, 5) center (0, 5) as ball cutting; \
                line to (5, 30), (0, 30) as shank; } niceness cutting: 1; }";
    for resolution in [0.5, 0.001] {
        let mut scene = Scene::of(text).placed().with_file("ball.tool", ball).with("anyway = true");
        scene.job = scene.job.replace("D2Ball", "ball.tool");
        let scene = scene.with(&format!("resolution = {resolution}"));
        let scene = scene.obstacle([-20.0, -40.0, -20.0], [20.0, 0.0, 3.0]);
        scene.gives(None, FINDINGS, &["V0101 the clamp"]);
    }
}

/// A cycle and a macro are called after each motion: also one in polar coordinates, a full circle, and one in a subprogram.
#[test]
fn a_modal_call_follows_every_motion() {
    let klartext = |motion: &str| {
        format!(
            "BEGIN PGM A MM\nTOOL CALL 1 Z S1000 F500\nL X-30 Y-10 R0 FMAX M3\nL Z+20 R0 FMAX\nL Y+0 FMAX\nCC X+0 Y+0\n\
             CYCL DEF 200 DRILLING Q200=2 Q201=-15 Q206=200 Q202=15 Q210=0 Q203=+0 Q204=20 Q211=0\nM89\n{motion}\n\
             CYCL DEF 200 DRILLING Q200=2 Q201=-1 Q206=200 Q202=15 Q210=0 Q203=+0 Q204=20 Q211=0\nL Z+100 R0 FMAX\nM30\n\
             END PGM A MM\n"
        )
    };
    let siemens = "G17 G90 G54 G71 G94\nT1 M6\nD1\nS1000 M3 F200\nG0 X30 Y0\nG0 Z20\nMCALL CYCLE81(20,0,2,-15)\nG3 I-10 J0\nMCALL\n\
                   G0 Z100\nM30\n"
        .to_owned();
    let fanuc = |motion: &str| {
        format!(
            "G21 G90 G17 G94 G54\nT1 M6\nS1000 M3 F500.\nG0 X-30. Y0.\nG43 H1 Z20.\n{motion}\nG67\nG0 Z100.\nM30\nO100\n\
             G0 X30. Y0.\nM99\nO9100\nG1 Z#26 F200.\nG0 Z20.\nM99\n"
        )
    };
    let modal = "G66 P9100 Z-15.";
    for (control, file, text) in [
        (HEIDENHAIN, "a.h", klartext("LP PR+30 PA+0 FMAX")),
        (HEIDENHAIN, "a.h", klartext("CP PA+0 DR- FMAX")),
        (HEIDENHAIN, "a.h", klartext("CTP PR+30 PA+0 FMAX")),
        (SIEMENS, "a.mpf", siemens),
        (FANUC, "a.nc", fanuc(&format!("{modal}\nM98 P100"))),
        (FANUC, "a.nc", fanuc(&format!("G0 X30.\n{modal}\nG2 I-10."))),
    ] {
        let scene = named(file, &text).placed().with("anyway = true");
        let scene = scene.obstacle([25.0, -5.0, -20.0], [35.0, 5.0, -8.0]);
        scene.gives(control, FINDINGS, &["V0101 the clamp"]);
    }
}

/// The tool stands in a pocket: its way home along X and Y leads where only the machine knows, unless Z returns before or with them.
#[test]
fn a_return_along_x_and_y_from_a_known_depth_is_not_free() {
    let machine = Machine::file("3-axis").expect("a machine").replace("home = 0\n", "");
    let machine = machine.replace("name = ", "tool_change = \"stays\"\nname = ");
    for (control, word) in [(FANUC, "G28"), (FANUC, "G30"), (LINUXCNC, "G28")] {
        for (blocks, verdict, gap) in [
            (format!("G91 {word} X0. Y0."), NONE, "V0404 7"),
            (format!("G91 {word} X0. Y0. Z0."), CLEAN, "V0405 7"),
            (format!("G53 G0 Z0.\nG91 {word} X0. Y0."), CLEAN, "V0405 8"),
        ] {
            let text = format!(
                "G21 G90 G17 G94 G54\nT1 M6\nS1000 M3\nG0 X0. Y0.\nG43 H1 Z20.\nG1 Z1. F200.\n{blocks}\nG90\nM30\n"
            );
            let scene = Scene::of(&text).placed().with("machine = \"mine.toml\"");
            let scene = scene.with_file("mine.toml", &*machine);
            scene.gives(control, verdict, &[gap]);
        }
    }
}

/// A retract by a distance along a tilted tool ends where the machine's file does not say.
#[test]
fn a_retract_by_a_distance_is_no_way_home() {
    for (b, retract, verdict, gap) in [
        (0, "4,\"TC\",0,57,0,0,0,0,0,0,0,0,0,0", CLEAN, "V0405 8"),
        // Along a tilted tool the way also leads aside.
        (30, "4,\"TC\",0,57,0,0,0,0,0,0,0,0,0,0", NONE, "V0404 8"),
        (30, "5,\"TC\",0,57,0,0,0,0,0,0,0,0,0,0,60", NONE, "V0404 8"),
    ] {
        let text = format!(
            "G17 G90 G54 G71 G94\nT1 M6\nD1\nS1000 M3 F200\nG0 B0 C0\nG0 X0 Y0 Z200\nG0 B{b}\nCYCLE800({retract})\nCYCLE800()\nM30\n"
        );
        let scene = scene("a.mpf", &text, B_HEAD, "[0, 0, -440]");
        // Nothing is near the part.
        let scene = if verdict == CLEAN { scene.with("anyway = true") } else { scene };
        let scene = scene.obstacle([300.0, 300.0, 0.0], [310.0, 310.0, 10.0]);
        scene.gives(SIEMENS, verdict, &[gap]);
    }
}

/// The reference position of Z, below the axis, is that of Z alone: the way there leads down, whatever others state.
#[test]
fn the_way_to_a_reference_position_leads_down_to_it() {
    for (home, verdict) in [(-200, FINDINGS), (-100, CLEAN)] {
        let machine = format!(
            "name = \"mill\"\naxis = [\n{{ letter = \"X\", kind = \"linear\", carries = \"table\" }},\n\
             {{ letter = \"Y\", kind = \"linear\", carries = \"table\" }},\n\
             {{ letter = \"Z\", kind = \"linear\", carries = \"tool\", limits = [-500, 0], home = {home} }},\n]"
        );
        // The axis stands at -170.
        let text = "G21 G90 G17 G94 G54\nT1 M6\nS1000 M3\nG43 H1\nG0 X0 Y60 Z200\nY90\nG91 G28 Z0\nG90\nM2\n";
        let scene = scene("a.nc", text, &machine, "[0, 0, -450]").with("anyway = true");
        scene.obstacle([-9.0, 81.0, 0.0], [9.0, 99.0, 180.0]).gives(LINUXCNC, verdict, &[]);
    }
}

/// As the drawing of a tool is long, its way leads down to a reference position below the top, also if its length is not stated.
#[test]
fn a_tool_of_unknown_length_goes_down_to_a_low_reference_position() {
    for (height, verdict, gap) in [(-250, NONE, Some("V0612 the clamp")), (-60, CLEAN, None)] {
        let machine = format!(
            "name = \"mill\"\nm92 = [0, 0, {height}]\naxis = [\n{{ letter = \"X\", kind = \"linear\", carries = \"table\", home = 0 }},\n\
             {{ letter = \"Y\", kind = \"linear\", carries = \"table\", home = 0 }},\n\
             {{ letter = \"Z\", kind = \"linear\", carries = \"tool\", limits = [-500, 0], home = {height} }},\n]"
        );
        let iso = |way: &str| {
            format!(
                "G21 G90 G17 G94 G54\nT1 M6\nS1000 M3\nG43 H1\nG0 X-6 Y0 Z200\nZ20\nG1 Z0.2 F500\nX6\nG0 Z200\nY90\n{way}\nM30\n"
            )
        };
        let klartext = "BEGIN PGM A MM\nTOOL CALL 1 Z S900\nL Z+0 R0 FMAX M91\nL X-6 Y+0 R0 FMAX M3\nL Z+20 FMAX\nL Z+0.2 F500\nL X+6\nL Z+200 FMAX\nL Y+90 FMAX\nL Z+0 R0 FMAX M92\n\
                        L X+0 Y+90 R0 FMAX M91\nM30\nEND PGM A MM\n";
        for (control, file, text) in [
            (LINUXCNC, "a.nc", iso("G91 G28 Z0\nG90")),
            (LINUXCNC, "a.nc", iso(&format!("G53 G0 Z{height}"))),
            (LINUXCNC, "a.nc", iso("G91 G28 X0 Y0 Z0\nG90")),
            (HEIDENHAIN, "a.h", klartext.to_owned()),
        ] {
            let mut scene = scene(file, &text, &machine, "[0, 0, -450]");
            scene.job = scene.job.replace("length = 80\n", "");
            let scene = scene.obstacle([-9.0, 81.0, 0.0], [9.0, 99.0, 199.0]);
            let gap =
                gap.map(
                    |gap| {
                        if control == HEIDENHAIN { gap.replace('7', "6") } else { gap.to_owned() }
                    },
                );
            scene.gives(control, verdict, gap.as_deref().as_slice());
        }
    }
}

/// Z alone rises to the top of its travel, the others follow there, and Z comes down: the length of the tool does not matter.
#[test]
fn a_tool_of_unknown_length_arrives_from_the_top() {
    let klartext = |retract: &str| {
        format!(
            "BEGIN PGM A MM\nTOOL CALL 1 Z S900\n{retract}\nL X-6 Y+0 R0 FMAX M3\nL Z+20 FMAX\nL Z+0.2 F500\nL X+6\nL Z+20 FMAX\n\
             L Z+0 R0 FMAX M91\nL X+0 R0 FMAX M91\nM30\nEND PGM A MM\n"
        )
    };
    let fanuc = "G21 G90 G17 G94 G54\nT1 M6\nS1000 M3\nG43 H1\nG91 G28 Z0.\nG90\nG43 H1\nG0 X-6. Y0.\nG0 Z20.\nG1 Z0.2 F500.\nX6.\nG0 Z20.\n\
                 M30\n";
    // The length offset does not matter while Z rests at the top.
    let late = fanuc
        .replace("G43 H1\nG91", "G91")
        .replace("G43 H1\nG0 X-6. Y0.\nG0", "G0 X-6. Y0.\nG43 H1");
    let programs = [
        (HEIDENHAIN, "a.h", klartext("L Z+0 R0 FMAX M91")),
        (HEIDENHAIN, "a.h", klartext("L M140 MB MAX FMAX")),
        (FANUC, "a.nc", fanuc.to_owned()),
        (HAAS, "a.nc", late),
    ];
    // The travel can be longer than up to the reference position.
    for (limit, (control, file, text)) in
        programs.iter().flat_map(|program| [("0", program), ("1", program)])
    {
        if limit == "1" && text.contains("M140") {
            continue;
        }
        let scene = || {
            let mut scene = named(file, text).placed();
            scene.job = scene.job.replace("length = 50\n", "");
            scene.on("3-axis", "limits = [-500, 0]", &format!("limits = [-500, {limit}]"))
        };
        let control = *control;
        scene().gives(control, CLEAN, &[]);
        let below = scene().obstacle([-9.0, -2.0, 0.0], [-5.0, 2.0, 30.0]);
        below.gives(control, FINDINGS, &["V0101 the clamp"]);
        let high = scene().obstacle([40.0, 40.0, 0.0], [44.0, 44.0, 390.0]);
        high.gives(control, NONE, &["V0612 the clamp"]);
    }
}

/// A table that tilts at the top of Z swings into a tool of unknown length, which is at least as long as it is drawn.
#[test]
fn a_table_that_tilts_under_a_tool_of_unknown_length_is_judged() {
    let text = "G21 G90 G17 G94 G54\nT1 M6\nS1000 M3\nG43 H1\nG0 A0. C0.\nX-6. Y0.\nZ20.\nG1 Z0.2 F500.\nX6.\nG0 Z20.\nG53 G0 Z0.\n\
                G0 A90.\nM30\n";
    for (y, verdict, gap) in [(460.0, NONE, Some("V0612 the clamp")), (400.0, CLEAN, None)] {
        let mut scene = scene("a.nc", text, TRUNNION, "[0, 0, -440]");
        scene.job = scene.job.replace("length = 80\n", "");
        let scene = scene.obstacle([-5.0, y, 0.0], [5.0, y + 5.0, 5.0]);
        scene.gives(LINUXCNC, verdict, gap.as_slice());
    }
    // Z alone rises from a tool change, whatever the table can meet: at the top it may tilt under a tool of a stated length.
    let text = "G21 G90 G17 G94 G54\nT1 M6\nS1000 M3\nG91 G28 Z0.\nG90\nG0 A0. C0.\nX-6. Y0.\nG43 H1 Z20.\nG1 Z0.2 F500.\nX6.\n\
                G0 Z20.\nM30\n";
    let scene = named("a.nc", text).placed().with("machine = \"A-C trunnion\"");
    scene.obstacle([-5.0, 460.0, 0.0], [5.0, 465.0, 5.0]).gives(LINUXCNC, CLEAN, &[]);
}

/// A head must not touch a disc that the table carries: the tool has to stay above that, too.
#[test]
fn a_disc_below_the_head_is_in_the_way() {
    let text = "G21 G90 G17 G94 G54\nT1 M6\nS1000 M3\nG0 G43 H1 Z60.\nG0 X-6. Y0.\nG1 Z0.2 F500.\nX6.\nG0 Z60.\nG53 G0 Z0.\nM30\n";
    for (z, verdict, gap) in [(-300.0, NONE, Some("V0607 the disc")), (-400.0, CLEAN, None)] {
        let scene = named("a.nc", text).placed();
        let scene = scene.body([-60.0, -60.0, 0.0], [60.0, 60.0, 200.0], Link::Axis(Letter::Z));
        scene.disc([300.0, 0.0, z], Link::Axis(Letter::X)).gives(HAAS, verdict, gap.as_slice());
    }
    // The disc turns up into the head, or stays below the tool.
    let text = |z: &str| {
        format!(
            "G17 G21 G40 G49 G80 G90 G94 G54\nG91 G28 Z0.\nG90\nT1 M6\nS9000 M3\nG0 X0. Y0. A0. C0.\nG43 H1 Z{z}\nX-20. A-90.\n\
             A0.\nX-6.\nZ20.\nG1 Z0.2 F500.\nX6.\nG0 Z20.\nG91 G28 Z0.\nG90\nM30\n"
        )
    };
    for (z, lowest, verdict, gap) in [
        ("65.", 0.0, NONE, Some("V0302 8 the disc")),
        ("200.", 0.0, CLEAN, None),
        // An arm of the head hangs lower than the tool, which is 50 mm long.
        ("200.", -150.0, CLEAN, None),
        ("200.", -200.0, NONE, Some("V0302 8 the disc")),
    ] {
        let scene = named("a.nc", &text(z)).placed().with("machine = \"A-C trunnion\"");
        let scene = scene.body([160.0, -5.0, lowest], [170.0, 5.0, 200.0], Link::Axis(Letter::Z));
        scene.disc([0.0, 0.0, -500.0], Link::Axis(Letter::A)).gives(HAAS, verdict, gap.as_slice());
    }
    // Of two that the table carries, the level of the tool says nothing.
    let scene = named("a.nc", &text("200.")).placed().with("machine = \"A-C trunnion\"");
    let scene = scene.body([-30.0, 250.0, -600.0], [30.0, 260.0, -590.0], Link::Base);
    scene.disc([0.0, 0.0, -500.0], Link::Axis(Letter::A)).gives(HAAS, NONE, &["V0302 8 the disc"]);
}

/// A head that may be tilted rises to the reference position of Z from wherever it stands, as posts begin.
#[test]
fn a_retract_of_z_before_the_first_position_is_free_under_a_head() {
    for retract in ["G91 G28 Z0.\nG90", "G53 G0 Z0."] {
        for machine in ["B head + C table", "A-C fork head"] {
            let rotary = if machine.starts_with('B') { "B0." } else { "A0." };
            let text = format!(
                "G17 G21 G40 G49 G80 G90 G94 G54\n{retract}\nT1 M6\nS9000 M3\nG0 {rotary} C0.\nX-6. Y0.\nG43 H1 Z20.\nG1 Z0.2 F500.\n\
                 X6.\nG0 Z20.\nG91 G28 Z0.\nG90\nM30\n"
            );
            let scene = || named("a.nc", &text).placed().with(&format!("machine = \"{machine}\""));
            scene().gives(HAAS, CLEAN, &[]);
            scene().obstacle([3.0, -2.0, -2.0], [5.0, 2.0, 2.0]).gives(HAAS, FINDINGS, &["V0101"]);
        }
    }
}

/// A table that stands at an unknown angle swings into a tool that is at its reference position and not at the top.
#[test]
fn a_table_that_tilts_below_a_low_home_is_not_passed_over() {
    for (home, verdict, gap) in [(-200, NONE, Some("V0607")), (0, CLEAN, None)] {
        let text = "G17 G21 G40 G49 G80 G90 G94 G54\nT1 M6\nS9000 M3\nG91 G28 Z0.\nG90\nG0 X0. Y0.\nG0 A-90. C0.\nG0 A0.\nX-4.5\nG43 H1 Z20.\n\
                    G1 Z0.2 F500.\nG0 Z20.\nG91 G28 Z0.\nG90\nM30\n";
        let scene = named("a.nc", text).placed();
        let scene = scene.on(
            "A-C trunnion",
            "limits = [-500, 0]\nhome = 0",
            &format!("limits = [-500, 0]\nhome = {home}"),
        );
        let scene = scene.obstacle([-9.0, 290.0, -20.0], [9.0, 299.0, -10.0]);
        scene.gives(LINUXCNC, verdict, gap.as_slice());
    }
}

/// Rapid traverse of a rotary axis with others at any rates is clear of what swings below the tool, and of nothing else.
#[test]
fn rapid_traverse_of_rotary_axes_is_judged_by_its_level() {
    let text = |z: &str| {
        format!(
            "G17 G21 G40 G49 G80 G90 G94 G54\nG91 G28 Z0.\nG90\nT1 M6\nS9000 M3\nG0 X20. Y-30. A0.\nG43 H1 Z300.\nZ{z}\nX-6. Y0. A90.\n\
             A0.\nZ20.\nG1 Z0.2 F500.\nX6.\nG0 Z20.\nG91 G28 Z0.\nG90\nM30\n"
        )
    };
    for (z, verdict, gap) in [("150.", CLEAN, None), ("-0.5", NONE, Some("V0302 9 the part"))] {
        let scene = named("a.nc", &text(z)).placed().with("machine = \"4-axis\"");
        scene.gives(HAAS, verdict, gap.as_slice());
    }
    let scene = || named("a.nc", &text("150.")).placed().with("machine = \"4-axis\"");
    // So it does with an angle of the work offset.
    let turned = |angle: &str| {
        let mut scene = scene();
        scene.job = scene.job.replace("[0, 0, -400]", &format!("[0, 0, -400, {angle}, 0, 0]"));
        scene
    };
    turned("30").gives(HAAS, CLEAN, &[]);
    let high = turned("30").obstacle([30.0, 290.0, -20.0], [40.0, 299.0, -10.0]);
    high.gives(HAAS, NONE, &["V0302 9 the clamp"]);
    // A shaft along the axis turns in its place.
    scene().obstacle([-300.0, -3.0, -12.0], [300.0, 3.0, -10.0]).gives(HAAS, CLEAN, &[]);
    // A bar on the table reaches higher while it turns.
    scene().obstacle([30.0, 90.0, -20.0], [40.0, 99.0, -10.0]).gives(HAAS, CLEAN, &[]);
    let high = scene().obstacle([30.0, 290.0, -20.0], [40.0, 299.0, -10.0]);
    high.gives(HAAS, NONE, &["V0302 9 the clamp"]);
    let stock = "[stock]\nbox = [[-3, -3, -400], [3, 3, 0]]\nspacing = 1\n";
    let mut tall = scene();
    tall.job += stock;
    tall.gives(HAAS, NONE, &["V0302 9 the stock"]);
}

/// At the top of Z the length offset of the tool before does not matter: the tool is there by its own length.
#[test]
fn at_the_top_a_tool_has_its_own_length_under_the_offset_of_another() {
    let text = "G21 G17 G90 G94 G54\nT2 M6\nG43 H2\nS1000 M3\nG53 G0 Z0.\nG0 X90. Y0.\nX80.\nT1 M6\nS1000 M3\nG0 X90. Y0.\nX-6.\nG43 H1 Z50.\n\
                G1 Z0.2 F500.\nX6.\nG53 G0 Z0.\nM30\n";
    for (lengths, verdict, gaps) in [
        // The tip of the first passes at Z60 of the part, the clamp is 65 high.
        (["340", ""], FINDINGS, &["V0101 11 the clamp"][..]),
        (["340", "100"], FINDINGS, &["V0101 11 the clamp"]),
        (["300", ""], CLEAN, &[]),
        // The offset that is in force is known, and not that of the tool, which is drawn shorter.
        (["", "330"], CLEAN, &[]),
        (["", ""], CLEAN, &[]),
    ] {
        let [one, two] = lengths.map(|length| {
            if length.is_empty() { String::new() } else { format!("length = {length}\n") }
        });
        let mut scene = named("a.nc", text).with("machine = \"3-axis\"");
        scene.job = scene.job.replace("LENGTH\n", &one);
        scene.job +=
            &format!("[tool.2]\ntool = \"D2Ball\"\n{two}[work_offsets]\nG54 = [0, 0, -400]\n");
        let scene = scene.obstacle([40.0, -5.0, 0.0], [50.0, 5.0, 65.0]);
        scene.gives(HAAS, verdict, gaps);
    }
}

/// A table that turns while Z comes down from wherever it is can swing into the tool.
#[test]
fn a_table_that_turns_while_z_comes_from_an_unknown_height_is_judged() {
    let text = |way: &str| {
        format!(
            "G21 G17 G90 G94 G54\nT1 M6\nS1000 M3\nG0 X-6. Y0. A0.\n{way}\nG0 Z340.\nG0 A0.\nZ20.\nG1 Z0.2 F500.\nX6.\nG0 Z20.\nM30\n"
        )
    };
    for (way, verdict, gap) in
        [("G43 H1 Z60. A90.", NONE, Some("V0607 5 the clamp")), ("G43 H1 Z150.\nA90.", CLEAN, None)]
    {
        let scene = named("a.nc", &text(way)).placed();
        let scene = scene.on("4-axis", "name = ", "tool_change = \"stays\"\nname = ");
        let scene = scene.obstacle([30.0, 290.0, -20.0], [40.0, 299.0, -10.0]);
        scene.gives(HAAS, verdict, gap.as_slice());
    }
}

/// A beam that Z does not carry stays where it is, however high the tool is.
#[test]
fn a_beam_stays_while_the_tool_rises() {
    let machine = "name = \"router\"\ntool_change = \"stays\"\naxis = [\n{ letter = \"Y\", kind = \"linear\", carries = \"tool\" },\n\
                   { letter = \"X\", kind = \"linear\", carries = \"tool\" },\n\
                   { letter = \"Z\", kind = \"linear\", carries = \"tool\", limits = [0, 500] },\n]";
    let text = "G21 G90 G17 G94 G54\nT1 M6\nS1000 M3\nG0 G43 H1 Z60.\nG0 X-6. Y0.\nG1 Z0.2 F500.\nX6.\nG0 Z60.\nM30\n";
    // Z is 100 in the first position, and 240 at Z60.
    for (beam, link, top, verdict, gap) in [
        (130.0, Letter::Y, 140.0, NONE, Some("V0607 4 the clamp")),
        (130.0, Letter::Y, 120.0, CLEAN, None),
        (130.0, Letter::Z, 140.0, CLEAN, None),
    ] {
        let scene = scene("a.nc", text, machine, "[0, 0, 100]");
        let scene = scene.body([-60.0, -400.0, 0.0], [60.0, -300.0, top], Link::Base);
        scene.disc([0.0, 0.0, beam], Link::Axis(link)).gives(LINUXCNC, verdict, gap.as_slice());
    }
}

/// Under tool centre point control Z of the tip is known before the axes are, where an angle about Z is not.
#[test]
fn a_way_of_the_tip_about_an_unknown_angle_is_open() {
    for (start, verdict, gap) in
        [("A0", NONE, Some("V0607 8 the clamp")), ("A0 C0 X-6 Y0 Z200", CLEAN, None)]
    {
        let text = format!(
            "G21 G17 G90 G94 G54\nT1 M6\nS1000 M3\nG43 H1\nG0 {start}\nM428\nG0 Z20\nG0 X-6 Y0\nG0 Z200\nG0 C0\nG0 Z20\n\
             G1 Z0.2 F500\nX6\nG0 Z200\nM429\nM2\n"
        );
        let machine = TRUNNION.replace("{ Z = 0 }", "\"stays\"");
        let scene = scene("a.nc", &text, &machine, "[0, 0, -440]");
        let scene = scene.obstacle([40.0, 40.0, 0.0], [50.0, 50.0, 150.0]);
        scene.gives(LINUXCNC, verdict, gap.as_slice());
    }
}
