//! Tools of which some lengths are stated and others are not: where the axes stand tells the tip of a stated length alone, and where a tip
//! is programmed tells no other one.

use crate::empty_spindle::{POSTS, Post, line_of};
use crate::in_the_way::{TRUNNION, named};
use crate::scene::{CLEAN, FINDINGS, NONE, Scene, native, rules};
use touchoff_verify::Verdict;
use touchoff_verify::gcode::{Choice, ControlRules, Rule};

/// The job's tools: T2 and T4 have stated lengths, T1 and T3 have not.
const TOOLS: &str = "[tool.2]\ntool = \"D2Ball\"\nlength = 50\n[tool.3]\ntool = \"D2Ball\"\n[tool.4]\ntool = \"D2Ball\"\nlength = 80\n";
const G54: &str = "[work_offsets]\nG54 = [0, 0, -400]\n";

/// Returns the rules of a control whose tool change leaves the axes where they are.
fn stays(control: &str) -> ControlRules {
    rules(control)
        .with(Rule::ToolChange, Choice::Stays)
        .with(Rule::ReferenceReturn, Choice::KeepsLength)
        .with(Rule::LengthChange, Choice::WithNextZ)
        .with(Rule::TcpStart, Choice::TableAtZero)
}

impl Post {
    /// Returns blocks in which a tool passes over the part, and stops beside it, 20 mm above it.
    fn pass(&self, tool: u32) -> String {
        let (start, _retract) = self.start.trim_end().rsplit_once('\n').expect("two blocks");
        // Without the length of the tool its offset comes before the first motion.
        let start = start.replace("G0 X-6. Y0.\nG43 H1 Z20.", "G43 H1\nG0 Z20.\nG0 X-6. Y0.");
        let start = start.replace("G0 X-6 Y0\nG43 H1\nG0 Z20", "G43 H1\nG0 Z20\nG0 X-6 Y0");
        let start = start.replace("T1", &format!("T{tool}")).replace("H1", &format!("H{tool}"));
        // Klartext moves in machine coordinates with the length that the run before has left.
        let start = start.replace("L Z+0 R0 FMAX M91\n", "");
        let start = start.replace("CALL 1", &format!("CALL {tool}"));
        format!("{start}\n{}", self.to('X', -50.0, true))
    }

    /// Returns the change to a tool, with its length offset.
    fn change_to(&self, tool: u32) -> String {
        match self.control {
            "heidenhain" => format!("TOOL CALL {tool} Z S9000\nM3\n"),
            "siemens" => format!("T{tool}\nM6\nM3 D1\n"),
            _ => format!("T{tool} M6\nM3\nG43 H{tool}\n"),
        }
    }

    /// Returns a job with a post of 15 mm between X-50 and the part.
    fn job(&self, blocks: &str) -> Scene {
        let end = self.end.split_once('\n').expect("two blocks").1;
        let mut scene = named(self.file, &format!("{blocks}{end}"));
        scene.job += TOOLS;
        scene.obstacle([-45.0, -1.0, 0.0], [-43.0, 1.0, 15.0])
    }

    /// Asserts what a job gives, with and without the origin of G54.
    fn gives(&self, blocks: &str, verdict: Verdict, patterns: &[String]) {
        let patterns: Vec<&str> = patterns.iter().map(String::as_str).collect();
        for offsets in ["", G54] {
            let mut scene = self.job(blocks);
            scene.job += offsets;
            scene.gives_by(stays(self.control), verdict, &patterns);
        }
    }
}

/// A tool change that leaves the axes leaves the tip of the new tool at a height that both lengths tell.
#[test]
fn a_tool_is_where_the_length_before_has_left_it() {
    for post in &POSTS {
        let cross = post.to('X', 50.0, true);
        for (tools, verdict) in [
            ([2, 4], FINDINGS),
            ([4, 2], CLEAN),
            ([2, 1], NONE),
            ([1, 2], NONE),
            ([1, 3], NONE),
            ([1, 1], CLEAN),
            ([2, 2], CLEAN),
        ] {
            let blocks = post.pass(tools[0]) + &post.change_to(tools[1]) + &cross;
            let line = line_of(&blocks, &cross);
            let rows = match verdict {
                NONE => vec![format!("V0423 {line}")],
                FINDINGS => vec![format!("V0101 {line} the clamp")],
                CLEAN => Vec::new(),
            };
            post.gives(&blocks, verdict, &rows);
        }
    }
}

/// Machine coordinates of X lead home from the top of Z's travel, and not from a height that only the machine knows.
#[test]
fn axes_go_home_from_a_known_height() {
    for post in &POSTS {
        let home = post.to_machine('X', 50.0);
        for (tools, code) in [([2, 4], "V0101"), ([2, 1], "V04"), ([1, 2], "V04"), ([1, 3], "V04")]
        {
            let blocks = post.pass(tools[0]) + &post.change_to(tools[1]) + &home;
            let row = format!("{code} {}", line_of(&blocks, &home));
            let verdict = if code == "V0101" { FINDINGS } else { NONE };
            let mut scene = post.job(&blocks);
            scene.job += G54;
            scene.gives_by(stays(post.control), verdict, &[&row]);
        }
    }
}

/// A change of the offset moves no axis: the tip is where its length tells, also before the program names a tool.
#[test]
fn an_offset_that_changes_tells_another_length() {
    let fanuc = &POSTS[0];
    let heidenhain = &POSTS[4];
    let cross = |post: &Post| post.to('X', 50.0, true);
    let defined = |tool: u32| format!("TOOL DEF {tool} L+50 R+1\n{}", heidenhain.change_to(tool));
    for (post, blocks, verdict, code) in [
        (fanuc, fanuc.pass(2) + "G49\n", CLEAN, ""),
        (fanuc, fanuc.pass(2) + "G43 H4\n", CLEAN, ""),
        (fanuc, fanuc.pass(2) + "G43 H1\n", NONE, "V0408"),
        (fanuc, fanuc.pass(1) + "G49\n", NONE, "V0407"),
        (fanuc, fanuc.pass(1) + "G43 H2\n", NONE, "V0408"),
        (fanuc, fanuc.pass(1) + "G43 H2\nG43 H1\n", CLEAN, ""),
        (fanuc, fanuc.pass(2) + "T1 M6\nG43 H1\nT2 M6\nM3\nG43 H2\n", CLEAN, ""),
        (heidenhain, heidenhain.pass(1) + &defined(3), NONE, "V0423"),
        (heidenhain, heidenhain.pass(2) + &defined(3), CLEAN, ""),
    ] {
        let cross = cross(post);
        let blocks = blocks + &cross;
        let row = format!("{code} {}", line_of(&blocks, &cross));
        post.gives(
            &blocks,
            verdict,
            if code.is_empty() { &[] } else { std::slice::from_ref(&row) },
        );
    }
}

/// The tool before the first change is that of the first register, of which a job with one tool states the length or not.
#[test]
fn a_tool_that_is_not_named_is_that_of_its_register() {
    let post = &POSTS[0];
    let cross = post.to('X', 50.0, true);
    for (register, length, verdict) in
        [(1, "length = 50", CLEAN), (2, "length = 50", NONE), (1, "", CLEAN), (2, "", NONE)]
    {
        let pass = post
            .pass(register)
            .replace(&format!("T{register} M6\n"), "")
            .replace("G53 G0 Z0.\n", "");
        let blocks = pass + &post.change_to(1) + &cross;
        let row = format!("V0423 {}", line_of(&blocks, &cross));
        let rows: &[&str] = if verdict == NONE { &[&row] } else { &[] };
        for offsets in ["", G54] {
            let mut scene = post.job(&blocks);
            scene.job = scene.job.replace(TOOLS, offsets).replace("LENGTH", length);
            scene.gives_by(stays(post.control), verdict, rows);
        }
    }
}

/// The height at which a program begins before it names a tool is the operator's, as that of its first tool would be.
#[test]
fn a_height_before_the_first_tool_is_none_of_it() {
    let post = &POSTS[2];
    for (tool, blocks, verdict, rows) in [
        (1, "G0 Z20\n", CLEAN, &[][..]),
        (2, "G0 Z20\n", CLEAN, &[]),
        (1, "G0 X50\nG0 Z20\n", NONE, &["V0402 7"]),
        // The control counts Z without an offset as that of the gauge point.
        (2, "G0 X50\nG0 Z20\n", FINDINGS, &["V0101 7"]),
    ] {
        let start = "G17 G21 G40 G49 G80 G90 G94 G61\nG54\nG0 X-50 Y0 Z20\n";
        let pass = "G0 X-6\nG1 Z0.2 F500\nX6\nG0 Z20\n";
        let change = post.change_to(tool).replace("M3", "S9000 M3");
        let blocks = format!("{start}{change}{blocks}{pass}");
        post.gives(&blocks, verdict, &rows.iter().map(|row| row.to_string()).collect::<Vec<_>>());
    }
}

/// A tool change to a stated height, and machine coordinates in a plane or while the table is turned, are places of the axis alone.
#[test]
fn places_of_the_axis_tell_no_tip_of_an_unknown_length() {
    let post = &POSTS[0];
    let cross = post.to('X', 50.0, true);
    for (height, tool, verdict, rows) in [
        // The gauge point is 70 mm above the part.
        ("-330", 2, CLEAN, &[][..]),
        ("-330", 4, FINDINGS, &["V0101 16 the clamp"]),
        ("-330", 1, NONE, &["V0423 16"]),
        ("0", 1, CLEAN, &[]),
    ] {
        let blocks = post.pass(2) + &post.change_to(tool) + &cross;
        let mut scene = post.job(&blocks);
        let name = "name = \"3-axis\"";
        scene = scene.on("3-axis", name, &format!("{name}\ntool_change = {{ Z = {height} }}"));
        scene.job += G54;
        scene.gives_by(stays(post.control), verdict, rows);
    }
    let plane = "G68.2 X0. Y0. Z0. I0. J0. K0.\nG53.1\n";
    for (length, blocks, verdict, rows) in [
        // The gauge point is 50 mm above the part.
        ("length = 30", format!("G0 C90.\n{plane}G53 Z-390.\n"), CLEAN, &[][..]),
        ("length = 55", format!("G0 C90.\n{plane}G53 Z-390.\n"), FINDINGS, &["V01"]),
        ("", format!("G0 C90.\n{plane}G53 Z-390.\n"), NONE, &["V04"]),
        ("", format!("G0 C90.\n{plane}G53 Z0.\n"), CLEAN, &[]),
        ("", format!("G0 C90.\n{plane}G53 X50. Z0.\n"), NONE, &["V0404"]),
        ("", format!("G0 C90.\n{plane}G53 Z0.\nG0 X20. Y0.\n"), NONE, &["V0423"]),
    ] {
        let text = format!(
            "G21 G90 G17 G94 G54 G61 G49\nT1 M6\nS1000 M3\nG0 A0. C0.\nG43 H1\nG0 Z100.\nG0 X0. Y0.\nG0 Z0.2\nG1 X1. F500\nG0 Z100.\n{blocks}G53 X50.\nG53 X0.\nG53 Z0.\nG69\nG49\nM30\n"
        );
        let mut scene = named("a.nc", &text)
            .with_file("mine.toml", TRUNNION.replace("tool_change = { Z = 0 }", ""))
            .with("machine = \"mine.toml\"");
        scene.job = scene.job.replace("LENGTH", length);
        scene.job += "[work_offsets]\nG54 = [0, 0, -440]\n";
        scene.gives_by(stays("fanuc"), verdict, rows);
    }
}

/// At the top of Z's travel every tool is out of the way, but what leaves it aslant begins lower by the length.
#[test]
fn a_tool_of_an_unknown_length_leaves_the_top_straight_down() {
    let (linuxcnc, fanuc) = (&POSTS[2], &POSTS[0]);
    let each_axis = |post: &Post| stays(post.control).with(Rule::Rapid, Choice::EachAxis);
    for (post, rules, blocks, verdict) in [
        (linuxcnc, stays("linuxcnc"), "G0 X50\nG0 Z20\n", CLEAN),
        (linuxcnc, stays("linuxcnc"), "G0 X50 Z20\n", NONE),
        (linuxcnc, stays("linuxcnc"), "G1 X50 Z20 F900\n", NONE),
        (linuxcnc, stays("linuxcnc"), "T2 M6\nM3\nG43 H2\nG0 X50 Z20\n", CLEAN),
        (fanuc, each_axis(fanuc), "G0 X50. Z20.\n", CLEAN),
        (fanuc, each_axis(fanuc), "G1 X50. Z20. F900\n", NONE),
        (
            fanuc,
            each_axis(fanuc),
            "G68 X0. Y0. R90.\nG0 X0. Y-50.\nG69\nG0 X50. Y0.\nG0 Z20.\n",
            CLEAN,
        ),
        (
            fanuc,
            each_axis(fanuc),
            "G68.2 X0. Y0. Z0. I90. J0. K0.\nG0 X0. Y-50.\nG69\nG0 X50. Y0.\nG0 Z20.\n",
            CLEAN,
        ),
    ] {
        let blocks = post.pass(2) + &post.to_machine('Z', 0.0) + &post.change_to(1) + blocks;
        let mut scene = post.job(&blocks);
        scene.job += G54;
        let rows: &[&str] = if verdict == NONE { &["V0423"] } else { &[] };
        scene.gives_by(rules, verdict, rows);
    }
}

/// Tool centre point control follows no tip of which only the axis is known.
#[test]
fn tool_centre_point_control_begins_at_no_unknown_tip() {
    let iso = |change: &str| {
        format!(
            "G21 G90 G17 G94 G54 G61 G49\nT2 M6\nS1000 M3\nG0 A0. C0.\nG0 X-50. Y0.\nG43 H2 Z20.\nG0 X-6.\nG1 Z0.2 F500.\nX6.\nG0 Z20.\nG49\n\
             {change}G0 X50.\nG49\nM30\n"
        )
    };
    let sinumerik = |change: &str| {
        format!(
            "G17 G90 G54 G71 G94\nT2 M6\nD1\nS1000 M3\nG0 A0 C0\nG0 X-50 Y0\nG0 Z20\nG0 X-6\nG1 Z0.2 F500\nX6\nG0 Z20\n\
             {change}TRAORI\nG54\nG0 X50\nTRAFOOF\nG54\nM30\n"
        )
    };
    let klartext = |change: &str| {
        format!(
            "BEGIN PGM A MM\nTOOL CALL 2 Z S1000\nL A+0 C+0 R0 FMAX M3\nL X-50 Y+0 R0 FMAX\nL Z+20 R0 FMAX\nL X-6 R0 FMAX\n\
             L Z+0.2 R0 F500\nL X+6\nL Z+20 R0 FMAX\n{change}M128\nL X+50 R0 FMAX\nM129\nM30\nEND PGM A MM\n"
        )
    };
    for (tool, is_high, verdict) in
        [(2, false, CLEAN), (2, true, CLEAN), (1, false, NONE), (1, true, NONE)]
    {
        let high = |block: &'static str| if is_high { block } else { "" };
        let iso_change = format!("{}T{tool} M6\nM3\nG43.4 H{tool}\n", high("G53 G0 Z0.\n"));
        let sinumerik_change = format!("{}T{tool} M6\nM3 D1\n", high("SUPA G0 Z0 D0\n"));
        let klartext_change =
            format!("{}TOOL CALL {tool} Z S1000\nM3\n", high("L Z+0 R0 FMAX M91\n"));
        for (file, text, control) in [
            ("a.nc", iso(&iso_change), "fanuc"),
            ("a.mpf", sinumerik(&sinumerik_change), "siemens"),
            ("a.h", klartext(&klartext_change), "heidenhain"),
        ] {
            let mut scene = named(file, &text)
                .with_file("mine.toml", TRUNNION.replace("tool_change = { Z = 0 }", ""))
                .with("machine = \"mine.toml\"");
            scene.job += TOOLS;
            scene.job += "[work_offsets]\nG54 = [0, 0, -440]\n";
            let rows: &[&str] = if verdict == NONE { &["V0423"] } else { &[] };
            let rules = match control {
                "siemens" => native(Choice::DeselectsOffset).with(Rule::ToolChange, Choice::Stays),
                _ => stays(control),
            };
            scene.gives_by(rules, verdict, rows);
        }
    }
    // Neither does it at the top, which its positions leave.
    for (start, verdict) in [("G43 H1", CLEAN), ("G43.4 H1", NONE)] {
        let text = format!(
            "G21 G90 G17 G94 G54 G61 G49\nT1 M6\nS1000 M3\nG43 H1\nG0 A0. C0.\nG0 X-6. Y0.\nG0 Z20.\nG1 Z0.2 F500.\nX6.\nG0 Z20.\nG49\n\
             T1 M6\nM3\n{start}\nG0 X50.\nG49\nM30\n"
        );
        let mut scene =
            named("a.nc", &text).with_file("mine.toml", TRUNNION).with("machine = \"mine.toml\"");
        scene.job += "[work_offsets]\nG54 = [0, 0, -440]\n";
        let rows: &[&str] = if verdict == NONE { &["V0423 15"] } else { &[] };
        scene.gives_by(stays("fanuc"), verdict, rows);
    }
}

/// The axis is higher than the tip by a length that is not stated: its lower limit is not that of the tip, and its upper one is said.
#[test]
fn limits_of_z_are_those_of_the_axis() {
    let scene = |z: &str, g54: f64, length: &str| {
        let blocks = format!("T1 M6\nS900 M3\nG43 H1\nG0 X0. Y0.\nZ{z}\nG1 Z1.\nG0 Z{z}");
        let mut scene = Scene::new(&blocks).with("anyway = true");
        scene.job = scene.job.replace("LENGTH", length);
        scene.job += &format!("[work_offsets]\nG54 = [0, 0, {g54}]\n");
        scene
    };
    scene("50.", -510.0, "").gives_by(stays("haas"), CLEAN, &["V0313 7"]);
    scene("50.", -510.0, "length = 100").gives_by(stays("haas"), CLEAN, &[]);
    scene("230.", -250.0, "").gives_by(stays("haas"), CLEAN, &["V0313 7"]);
    scene("230.", -250.0, "length = 100").gives_by(
        stays("haas"),
        FINDINGS,
        &["V0108 Z goes to 80"],
    );
    // The tip alone is beyond it.
    scene("260.", -250.0, "").gives_by(stays("haas"), FINDINGS, &["V0108 Z goes to 10"]);
}

/// Aside at the top of Z, a tool of unknown length is at least as low as it is drawn.
#[test]
fn a_tool_of_unknown_length_is_not_above_all_at_the_top() {
    let blocks = "G53 G0 Z0.\nT1 M6\nS900 M3\nG43 H1\nG0 X0. Y0.\nZ50.\nG1 Z1.\nG0 Z50.\nG53 G0 Z0.\nG53 G0 X90. Y90.";
    for (top, verdict) in [(395.0, NONE), (300.0, CLEAN)] {
        let mut scene = Scene::new(blocks).obstacle([40.0, 40.0, 0.0], [45.0, 45.0, top]);
        scene.job += G54;
        let patterns: &[&str] = if verdict == NONE { &["V0612 the clamp"] } else { &[] };
        scene.gives_by(stays("linuxcnc"), verdict, patterns);
        // A tool that the program does not name is one, too.
        let mut unnamed = Scene::new(&blocks.replace("T1 M6\n", ""));
        unnamed = unnamed.obstacle([40.0, 40.0, 0.0], [45.0, 45.0, top]).with("anyway = false");
        unnamed.job += G54;
        assert_eq!(unnamed.check_by(stays("linuxcnc")).has("V0612"), verdict == NONE);
        // A stated length counts where only the machine knows the height (G30).
        let known = blocks.replace("G53 G0 Z0.\nG53 G0 X90.", "G91 G30 Z0.\nG90\nG53 G0 X90.");
        let mut scene = Scene::new(&known).obstacle([40.0, 40.0, 0.0], [45.0, 45.0, top]);
        scene.job = scene.job.replace("LENGTH", "length = 50") + G54;
        scene.gives_by(stays("haas"), verdict, patterns);
    }
}
