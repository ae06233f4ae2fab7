//! T0 leaves the spindle empty where the job has no tool 0: its motions are checked by the height of its gauge point.

use crate::in_the_way::{B_HEAD, TRUNNION, named, scene};
use crate::scene::{
    CLEAN, Checked, FANUC, FINDINGS, HAAS, HEIDENHAIN, LINUXCNC, NONE, SIEMENS, Scene, rules,
};
use touchoff_verify::Verdict;
use touchoff_verify::gcode::{Choice, Rule};
use touchoff_verify::machine::{Letter, Link};

/// A program of a control whose T1 passes over the part, and ends at the top of Z.
pub(crate) struct Post {
    pub(crate) control: &'static str,
    pub(crate) file: &'static str,
    /// Blocks up to the pass, which ends at the top of Z.
    pub(crate) start: &'static str,
    /// The change to an empty spindle.
    empty: &'static str,
    /// The change to T1, above X-6 Y0.
    change: &'static str,
    /// The end.
    pub(crate) end: &'static str,
}

const FANUC_POST: Post = Post {
    control: "fanuc",
    file: "a.nc",
    start: "G17 G21 G40 G49 G80 G90 G94 G61\nG53 G0 Z0.\nT1 M6\nG54\nS9000 M3\nG0 X-6. Y0.\nG43 H1 Z20.\nG1 Z0.2 F500.\nX6.\nG0 Z20.\nG53 Z0.\n",
    empty: "G49\nT0 M6\n",
    change: "T1 M6\nM3\nG0 X-6. Y0.\nG43 H1 Z20.\n",
    end: "G0 Z20.\nG53 Z0.\nG49\nM30\n",
};

pub(crate) const POSTS: [Post; 5] = [
    FANUC_POST,
    Post { control: "haas", ..FANUC_POST },
    Post {
        control: "linuxcnc",
        file: "a.ngc",
        start: "G17 G21 G40 G49 G80 G90 G94 G61\nG53 G0 Z0\nT1 M6\nG54\nS9000 M3\nG0 X-6 Y0\nG43 H1\nG0 Z20\nG1 Z0.2 F500\nX6\nG0 Z20\nG53 G0 Z0\n",
        empty: "G49\nT0 M6\n",
        change: "T1 M6\nM3\nG0 X-6 Y0\nG43 H1\nG0 Z20\n",
        end: "G0 Z20\nG53 G0 Z0\nG49\nM2\n",
    },
    Post {
        control: "siemens",
        file: "a.mpf",
        start: "G17 G40 G71 G90 G94 G60\nSUPA G0 Z0 D0\nT1\nM6\nG54\nS9000 M3 D1\nG0 X-6 Y0\nG0 Z20\nG1 Z0.2 F500\nX6\nG0 Z20\nSUPA G0 Z0 D0\n",
        empty: "T0\nM6\n",
        change: "T1\nM6\nM3 D1\nG0 X-6 Y0\nG0 Z20\n",
        end: "G0 Z20\nSUPA G0 Z0 D0\nM30\n",
    },
    Post {
        control: "heidenhain",
        file: "a.h",
        start: "BEGIN PGM A MM\nL Z+0 R0 FMAX M91\nTOOL CALL 1 Z S9000\nL X-6 Y+0 R0 FMAX M3\nL Z+20 R0 FMAX\nL Z+0.2 R0 F500\nL X+6\nL Z+20 R0 FMAX\nL Z+0 R0 FMAX M91\n",
        empty: "TOOL CALL 0\n",
        change: "TOOL CALL 1 Z S9000\nL X-6 Y+0 R0 FMAX M3\nL Z+20 R0 FMAX\n",
        end: "L Z+20 R0 FMAX\nL Z+0 R0 FMAX M91\nM30\nEND PGM A MM\n",
    },
];

impl Post {
    /// Returns a block that moves to a coordinate, in rapid traverse or at feed rate.
    pub(crate) fn to(&self, letter: char, value: f64, rapid: bool) -> String {
        match (self.control, rapid) {
            ("heidenhain", true) => format!("L {letter}{value:+} R0 FMAX\n"),
            ("heidenhain", false) => format!("L {letter}{value:+} R0 F500\n"),
            ("fanuc" | "haas", true) => format!("G0 {letter}{value:.3}\n"),
            ("fanuc" | "haas", false) => format!("G1 {letter}{value:.3} F500.\n"),
            (_, true) => format!("G0 {letter}{value}\n"),
            (_, false) => format!("G1 {letter}{value} F500\n"),
        }
    }

    /// Returns a block that moves to a coordinate of the machine.
    pub(crate) fn to_machine(&self, letter: char, value: f64) -> String {
        match self.control {
            "heidenhain" => format!("L {letter}{value:+} R0 FMAX M91\n"),
            "siemens" => format!("SUPA G0 {letter}{value}\n"),
            "linuxcnc" => format!("G53 G0 {letter}{value}\n"),
            _ => format!("G53 G0 {letter}{value:.3}\n"),
        }
    }

    /// Returns the job of blocks after the change to an empty spindle, on a machine that changes tools at the top of Z.
    fn scene(&self, blocks: &str) -> Scene {
        self.scene_of(self.start, blocks)
    }

    fn scene_of(&self, start: &str, blocks: &str) -> Scene {
        let text = format!("{start}{}{blocks}{}", self.empty, self.end);
        let name = "name = \"3-axis\"";
        named(self.file, &text).on("3-axis", name, &format!("{name}\ntool_change = {{ Z = 0 }}"))
    }

    fn assert(&self, scene: &Scene, verdict: Verdict, patterns: &[&str]) -> Checked {
        let checked = scene.check_by(rules(self.control));
        checked.assert(verdict, patterns, &scene.text);
        checked
    }
}

/// Returns the line of the first block of a text.
pub(crate) fn line_of(text: &str, block: &str) -> usize {
    1 + text.lines().position(|line| line == block.trim_end()).expect("the block")
}

#[test]
fn an_empty_spindle_that_stays_high_is_clean() {
    for post in &POSTS {
        let blocks =
            post.to_machine('X', 100.0) + &post.to('X', -6.0, true) + &post.to('Z', 5.0, true);
        let scene = post.scene(&blocks).placed();
        let line = line_of(&scene.text, &post.to_machine('X', 100.0));
        post.assert(&scene, CLEAN, &[&format!("V0312 {line}")]);
        // A fixture and the stock may be higher than the part.
        let low = line_of(&scene.text, &post.to('Z', 5.0, true));
        let with_fixture = scene.obstacle([100.0, 100.0, 0.0], [101.0, 101.0, 6.0]);
        post.assert(&with_fixture, NONE, &[&format!("V0610 {low} the clamp")]);
        let mut with_stock = post.scene(&blocks).placed();
        with_stock.job += "[stock]\nbox = [[-3, -3, -2], [3, 3, 6]]\nspacing = 0.5\n";
        let checked = with_stock.check_by(rules(post.control));
        assert!(checked.has(&format!("V0610 {low} the stock")), "{:#?}", checked.rows);
    }
}

#[test]
fn an_empty_spindle_below_the_top_has_no_verdict() {
    for post in &POSTS {
        for rapid in [true, false] {
            let block = post.to('Z', -1.0, rapid);
            let blocks = post.to('X', 50.0, true) + &block + &post.to('X', 0.0, true);
            let scene = post.scene(&blocks).placed();
            let line = line_of(&scene.text, &block);
            let checked = post.assert(&scene, NONE, &[&format!("V0610 {line} the part")]);
            let untrue = ["V0407", "V0408", "V0301", "V0106"].map(|code| checked.has(code));
            assert_eq!(untrue, [false; 4], "{:#?}", checked.rows);
        }
        // The nose may not touch what it passes over.
        for (level, verdict) in [(0.0, NONE), (0.01, CLEAN)] {
            let blocks = post.to('Z', level, true) + &post.to('X', 0.0, true);
            let gaps: &[&str] = if verdict == NONE { &["V0610"] } else { &[] };
            post.assert(&post.scene(&blocks).placed(), verdict, gaps);
        }
        // An arc across the part dips below its ends.
        if !matches!(post.control, "siemens" | "heidenhain") {
            let arc = "G18\nG2 X4.000 Z3.000 I4.000 K0.000 F500.\nG17\n";
            let blocks = post.to('X', -4.0, true) + &post.to('Z', 3.0, true) + arc;
            post.assert(&post.scene(&blocks).placed(), NONE, &["V0610"]);
        }
    }
}

#[test]
fn a_tool_change_after_an_empty_spindle_goes_on() {
    for post in &POSTS {
        for (depth, verdict) in [(0.2, CLEAN), (-0.5, FINDINGS)] {
            let (pass, cut) = (post.to('Z', depth, false), post.to('X', 5.0, false));
            let blocks = format!("{}{}{pass}{cut}", post.to('X', 20.0, true), post.change);
            let scene = post.scene(&blocks).placed();
            let line = line_of(&scene.text, &cut);
            let finding = format!("V0101 {line} the part");
            let patterns: &[&str] = if verdict == FINDINGS { &[&finding] } else { &["V0312"] };
            post.assert(&scene, verdict, patterns);
        }
    }
}

/// Without the origin of G54 and without lengths, nothing tells where the gauge point is.
#[test]
fn an_empty_spindle_at_an_unknown_height_has_no_verdict() {
    for post in &POSTS {
        let block = post.to('Z', 50.0, true);
        let scene = post.scene(&(post.to_machine('Z', 0.0) + &block));
        let line = line_of(&scene.text, &block);
        post.assert(&scene, NONE, &[&format!("V0421 {line}")]);
        // At the top of Z it is above all.
        let mut scene = post.scene(&(post.to_machine('Z', 0.0) + &post.to('X', 20.0, true)));
        scene.text = scene.text.replace(&format!("{}{}", post.to('X', 20.0, true), post.end), "");
        scene.text += post.end.split_once('\n').expect("two blocks").1;
        let checked = scene.check_by(rules(post.control));
        let judged = ["V0421", "V0610"].map(|code| checked.has(code));
        assert_eq!(judged, [false; 2], "{:#?}", checked.rows);
    }
    let start = "G17 G21 G40 G49 G80 G90 G94 G61\nG54\nG53 G0 Z0\nT1 M6\nS900 M3\nG43 H1\nG0 Z20\nG0 X-6 Y0\nG1 Z0.2 F500\nX6\nG0 Z20\nG53 G0 Z0\nG49\nT0 M6\n";
    for (end, verdict, gaps) in [
        ("G53 G0 Z0\nG0 X50 Y0\nM2\n", CLEAN, &["V0312 15"][..]),
        ("G0 X50 Y0\nM2\n", CLEAN, &["V0312 15"]),
        ("G1 X50 Y0 F500\nM2\n", NONE, &["V0404 15"]),
        ("G0 Z500\nM2\n", NONE, &["V0421 15"]),
        ("G53 G0 Z-100\nM2\n", NONE, &["V0421 15"]),
        // A tool that follows is where the empty spindle has left the axes.
        ("G0 Z500\nT1 M6\nG43 H1\nG0 X50\nG0 Z20\nG49\nM2\n", NONE, &["V0423 18"]),
    ] {
        named("a.ngc", &format!("{start}{end}")).gives(LINUXCNC, verdict, gaps);
    }
    // With the length of a tool, the offset of G54 is that of the gauge point.
    for (level, verdict) in [("Z5", CLEAN), ("Z-1", NONE)] {
        let mut scene = named(
            "a.ngc",
            &format!("{start}G0 X50 Y0\nT1 M6\nG43 H1\nG0 Z60\nT0 M6\nG49\nG0 {level}\nM2\n"),
        );
        scene.job = scene.job.replace("LENGTH", "length = 50");
        scene.text = scene.text.replace("G53 G0 Z0\nG49\n", "G49\n");
        let gaps: &[&str] = if verdict == NONE { &["V0610 20"] } else { &[] };
        scene.gives(LINUXCNC, verdict, gaps);
    }
}

/// Z of the program is that of the gauge point without a length offset and without a shift alone.
#[test]
fn offsets_and_shifts_move_an_empty_spindle() {
    let post = &POSTS[2];
    for (blocks, verdict, gaps) in [
        ("G43 H1\nG0 Z-1\nG49\n", CLEAN, &[][..]),
        ("G43 H1\nG0 Z-51\nG49\n", NONE, &["V0610 16"]),
        ("G43 H7\nG0 Z100\nG49\n", NONE, &["V0422 16 H7"]),
        ("G43\nG0 Z-1\nG49\n", NONE, &["V0610 16"]),
        ("G0 Z100\nG92 Z200\nG0 Z105\nG92.1\n", CLEAN, &[]),
        ("G0 Z100\nG92 Z200\nG0 Z99\nG92.1\n", NONE, &["V0610 17"]),
    ] {
        post.assert(&post.scene(blocks).placed(), verdict, gaps);
    }
    // A length of less than 0 lowers it.
    let mut lowered = post.scene("G43 H3\nG0 Z50\nG49\n").placed();
    lowered.job = lowered.job.replace("[work_offsets]", "[tool.3]\nlength = -60\n[work_offsets]");
    post.assert(&lowered, NONE, &["V0610 16"]);
    // A tool whose length is not stated is lower than the gauge point was.
    let known = "G0 X-50 Y0\nG0 Z20\nT1 M6\nM3\nG43 H1\nG0 X50\n";
    let scene = named(post.file, &format!("{}{}{known}{}", post.start, post.empty, post.end));
    let mut scene = scene.with("control = \"linuxcnc\"");
    scene.job += "[work_offsets]\nG54 = [0, 0, -400]\n";
    scene.obstacle([-45.0, -1.0, 0.0], [-43.0, 1.0, 15.0]).gives(LINUXCNC, NONE, &["V0423 20"]);
}

/// A table that tilts swings the part up, and an empty spindle that follows it under tool centre point control goes anywhere.
#[test]
fn rotary_axes_turn_under_an_empty_spindle() {
    let control = || {
        rules("fanuc")
            .with(Rule::Rapid, Choice::Straight)
            .with(Rule::ReferenceReturn, Choice::KeepsLength)
            .with(Rule::TcpStart, Choice::TableAtZero)
            .with(Rule::LengthChange, Choice::MovesZ)
    };
    let start = "G21 G90 G17 G94 G54 G61 G49\nG53 G0 Z0.\nT1 M6\nS1000 M3\nG0 A0. C0.\nG0 X0. Y0.\nG43 H1 Z1.\nG0 Z100.\nG53 Z0.\nG49\nT0 M6\n";
    for (machine, blocks, verdict, gaps) in [
        (TRUNNION, "G0 A-90. C90.\n", CLEAN, &[][..]),
        (TRUNNION, "G0 Z100.\nG0 A-90. C90.\n", CLEAN, &[]),
        // The corner of the part is 40.1 mm beside the axis, and its middle 40 mm.
        (TRUNNION, "G0 Z0.1\nG0 A-90.\n", NONE, &["V0610 13 the part"]),
        (TRUNNION, "G0 Z1.\nG0 A-90.\n", CLEAN, &[]),
        (TRUNNION, "G0 Z1.\nG0 C90.\n", CLEAN, &[]),
        (TRUNNION, "G43.4 H0\nG0 Z100.\nG0 X20.\nG0 A-30.\nG0 A0.\nG49\n", NONE, &["V0610"]),
        (TRUNNION, "G43.4 H1\nG0 X20.\nG49\n", NONE, &["K0801 13"]),
        (B_HEAD, "G0 B30.\nG0 B0.\n", NONE, &["V0610 13"]),
        (B_HEAD, "G0 C30.\nG0 X50.\n", CLEAN, &[]),
    ] {
        let (start, blocks) = match machine == B_HEAD {
            true => (
                start.replace("G53 G0 Z0.\nT1", "G0 B0. C0.\nG53 Z0.\nT1").replace('A', "B"),
                blocks,
            ),
            false => (start.to_owned(), blocks),
        };
        let text = format!("{start}{blocks}G53 G0 Z0.\nM30\n");
        scene("a.nc", &text, machine, "[0, 0, -440]").gives_by(control(), verdict, gaps);
    }
    // What stands still on the machine is out of the way at the top of Z, and a fixture or what the table carries is not.
    let first = "G0 A0. C0.\nG0 X0. Y0.\nG53 Z0.\nT1";
    let text = format!("{}G0 X50.\nM30\n", start.replace("G53 G0 Z0.\nT1", first));
    let low = ([-5.0, 300.0, -900.0], [5.0, 310.0, 400.0]);
    for (link, verdict) in [(Link::Base, CLEAN), (Link::Axis(Letter::A), NONE)] {
        let scene = scene("a.nc", &text, TRUNNION, "[0, 0, -440]").body(low.0, low.1, link);
        let gaps: &[&str] = if verdict == NONE { &["V0610 13 the clamp"] } else { &[] };
        scene.gives_by(control(), verdict, gaps);
    }
}

/// The job's own tool 0 is a tool like any other, and so is that of a job with one tool.
#[test]
fn a_stated_tool_0_is_a_tool() {
    for post in &POSTS {
        let blocks = post.to('X', -6.0, true) + &post.to('Z', 1.0, true) + &post.to('X', 6.0, true);
        for (length, depth, verdict) in [("length = 0", 1.0, CLEAN), ("length = 0", -0.5, FINDINGS)]
        {
            let blocks = blocks.replace(&post.to('Z', 1.0, true), &post.to('Z', depth, true));
            let mut scene = post.scene(&blocks).placed();
            let tool = format!("[tool.0]\ntool = \"D2Ball\"\n{length}\n[work_offsets]");
            scene.job = scene.job.replace("[work_offsets]", &tool);
            let checked = scene.check_by(rules(post.control));
            assert_eq!(checked.verdict, verdict, "{:#?}\n{}", checked.rows, scene.text);
            assert!(!checked.has("V0312"), "{:#?}", checked.rows);
        }
    }
}

/// The way home begins as high as the spindle stands.
#[test]
fn an_empty_spindle_goes_home_from_its_height() {
    let text = |level: &str, home: &str| {
        format!(
            "G21 G90 G17 G94 G54 G61 G49\nG53 G0 Z0.\nT1 M6\nS900 M3\nG0 X-6. Y0.\nG43 H1 Z20.\nG1 Z0.2 F500.\nX6.\nG0 Z20.\nG53 Z0.\nG49\n\
             T0 M6\nG0 X0. Y0.\nG0 {level}\nG91 {home}\nM30\n"
        )
    };
    let machine = "name = \"mine\"\ntool_change = { Z = 0 }\naxis = [\n{ letter = \"X\", kind = \"linear\", carries = \"table\" },\n\
                   { letter = \"Y\", kind = \"linear\", carries = \"table\" },\n{ letter = \"Z\", kind = \"linear\", carries = \"tool\" },\n]";
    for control in [FANUC, HAAS] {
        for home in ["G28 X0. Y0. Z0.", "G28 Z0."] {
            let high = scene("a.nc", &text("Z5.", home), machine, "[0, 0, -400]");
            high.gives(control, CLEAN, &["V0312 13"]);
            let low = scene("a.nc", &text("Z-1.", home), machine, "[0, 0, -400]");
            low.gives(control, NONE, &["V0610 14"]);
        }
    }
    for (file, control, text) in [
        ("a.mpf", SIEMENS, format!("{}T0\nD0\nSUPA G0 Z0\nM30\n", POSTS[3].start)),
        ("a.mpf", SIEMENS, format!("{}T0 M6\nSUPA G0 Z0 D0\nM30\n", POSTS[3].start)),
        (
            "a.h",
            HEIDENHAIN,
            format!("{}TOOL CALL 0\nL M140 MB MAX FMAX\nM30\nEND PGM A MM\n", POSTS[4].start),
        ),
    ] {
        let name = "name = \"3-axis\"";
        let scene =
            named(file, &text).on("3-axis", name, &format!("{name}\ntool_change = {{ Z = 0 }}"));
        scene.placed().gives(control, CLEAN, &[]);
    }
}
