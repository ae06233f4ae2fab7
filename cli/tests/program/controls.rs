//! Controls differ: a program on which they do is clean only if it is clean on all of them, or on the one that is named.

use crate::bench::{Bench, objects, stderr, stdout, touchoff};
use nalgebra::Point3;
use std::fs;
use std::process::Output;
use touchoff::mesh::shapes;
use touchoff::{Mesh, Unit};
use touchoff_verify::gcode::{Choice, ControlRules, Rule};

/// A block of 6 × 6 × 2 below z = 0, a tool of 2 mm that ends in a ball, and what is added by a test.
struct Scene {
    bench: Bench,
    job: String,
}

/// A program that states its unit and its offset, and turns the spindle.
fn program(blocks: &str) -> String {
    format!("G21 G90 G54 G94 S9000 M3 F100.\n{blocks}\nM30\n")
}

fn cuboid(low: [f64; 3], high: [f64; 3]) -> Mesh {
    shapes::cuboid(Point3::from(low), Point3::from(high), Unit::Millimetre).expect("a cuboid")
}

impl Scene {
    fn new(blocks: &str) -> Scene {
        Scene::of(&program(blocks))
    }

    fn of(text: &str) -> Scene {
        let bench = Bench::new();
        bench.write("a.nc", text);
        let job = "part = \"block.stl\"\nunit = \"mm\"\nprogram = \"a.nc\"\n";
        Scene { bench, job: format!("{job}TOP\n[tool.1]\ntool = \"D2Ball\"\nLENGTH\n") }
    }

    /// States a key of the job.
    fn with(mut self, line: &str) -> Scene {
        self.job = self.job.replace("TOP", &format!("{line}\nTOP"));
        self
    }

    /// States the length of the tool, and where the part is on the machine.
    fn placed(mut self) -> Scene {
        self.job = self.job.replace("LENGTH", "length = 50");
        self.job += "[work_offsets]\nG54 = [0, 0, -400]\n";
        self
    }

    /// Adds an obstacle.
    fn obstacle(mut self, low: [f64; 3], high: [f64; 3]) -> Scene {
        self.bench.part("clamp.stl", &cuboid(low, high));
        self.job += "[[fixture]]\nname = \"the clamp\"\nmesh = \"clamp.stl\"\n";
        self
    }

    fn run(&self, more: &[&str]) -> Output {
        let job = self.job.replace("TOP\n", "").replace("LENGTH\n", "");
        let file = self.bench.write("a.toml", job);
        touchoff(&[&["verify", &file][..], more].concat())
    }

    /// As [`Scene::gives`], on a Sinumerik that reads native programs.
    fn gives_natively(&self, status: i32, words: &[&str]) {
        let siemens = ControlRules::named("siemens").expect("a control");
        let native = siemens.with(Rule::ToolLength, Choice::Always);
        let native = native.with(Rule::Rotary, Choice::WithinTurn);
        let native = native.with(Rule::ToolOrientation, Choice::ByAxes).to_toml();
        let control = self.bench.write("native.toml", native);
        self.gives(&["--control", &control], status, words);
    }

    /// As [`Scene::gives`], on a control that reads the words of Fanuc and moves as LinuxCNC does.
    fn gives_straight(&self, status: i32, words: &[&str]) {
        let rules = ControlRules::named("linuxcnc").expect("a control");
        let rules = rules.with(Rule::Dialect, Choice::Iso).to_toml();
        let control = self.bench.write("straight.toml", rules);
        self.gives(&["--control", &control], status, words);
    }

    /// Asserts the status and words of the output with more options.
    fn gives(&self, more: &[&str], status: i32, words: &[&str]) {
        let output = self.run(more);
        let all = format!("{}{}", stdout(&output), stderr(&output));
        assert_eq!(output.status.code(), Some(status), "{more:?}: {all}");
        for word in words {
            assert!(all.contains(word), "{more:?}: `{word}` is missing in:\n{all}");
        }
    }
}

const LINUXCNC: [&str; 2] = ["--control", "linuxcnc"];
const FANUC: [&str; 2] = ["--control", "fanuc"];
const HAAS: [&str; 2] = ["--control", "haas"];
const SIEMENS: [&str; 2] = ["--control", "siemens"];

/// The changer leaves the axes above a clamp, through which the tool then comes down.
#[test]
fn after_a_tool_change_only_the_machine_knows_where_the_axes_are() {
    let blocks =
        "G43 H1 G0 X-6. Y0. Z20.\nT1 M6\nS9000 M3\nG0 X6. Y0.\nG43 H1 Z0.5\nG1 X0.\nG0 Z20.";
    let scene = Scene::new(blocks).placed().obstacle([2.0, -3.0, 60.0], [12.0, 3.0, 70.0]);
    scene.gives(
        &[],
        2,
        &["only the machine knows where the tool change leaves its axes", "`tool_change`"],
    );
    scene.gives(&FANUC, 2, &["`tool_change`"]);
    scene.gives(&LINUXCNC, 0, &[]);
    // The control of Haas retracts Z to its home, unless T1 is in the spindle already.
    scene.gives(&HAAS, 2, &["`tool_change`"]);
    let other = blocks.replace("G43 H1 G0 X-6.", "T3 M6\nG43 H3 G0 X-6.");
    let mut other = Scene::new(&other).placed().obstacle([2.0, -3.0, 60.0], [12.0, 3.0, 70.0]);
    other.job += "[tool.3]\ntool = \"D2Ball\"\nlength = 50\n";
    other.gives(&HAAS, 1, &["the clamp"]);
    let machine = touchoff(&["machines", "3-axis"]);
    let machine = stdout(&machine).replace("name = ", "tool_change = { Z = -300 }\nname = ");
    scene.bench.write("mine.toml", &machine);
    let stated = scene.with("machine = \"mine.toml\"");
    stated.gives(&[], 1, &["the clamp"]);
    stated.bench.write("mine.toml", machine.replace("{ Z = -300 }", "\"stays\""));
    stated.gives(&[], 0, &[]);
    stated.bench.write("mine.toml", machine.replace("{ Z = -300 }", "\"stay\""));
    stated.gives(&[], 2, &["mine.toml:", "`tool_change` is \"stays\""]);
}

#[test]
fn a_cycle_below_r_moves_sideways_or_rises_first() {
    let blocks = "T1 M6\nS9000 M3\nG43 H1 G0 X-4. Y0. Z20.\nZ1.\nG98 G81 X20. Y0. Z1. R6.\nG80";
    let scene = Scene::new(blocks).placed().obstacle([8.0, -3.0, -2.0], [10.0, 3.0, 3.0]);
    let scene = scene.with("machine = \"mine.toml\"");
    let machine = stdout(&touchoff(&["machines", "3-axis"]));
    scene.bench.write("mine.toml", machine.replace("name = ", "tool_change = \"stays\"\nname = "));
    scene.gives(&[], 1, &["the clamp", "under cycle_below_r = \"sideways first\""]);
    scene.gives(&LINUXCNC, 0, &[]);
    scene.gives(&HAAS, 1, &["the clamp"]);
    let rows = objects(&scene.run(&["--json"]));
    let under =
        |row: &serde_json::Value| row["under"] == "under cycle_below_r = \"sideways first\"";
    assert!(rows.iter().any(under), "{rows:?}");
}

/// An endless table turns by -330 or by +30 degrees; a post on it is at 180.
#[test]
fn a_rotary_axis_counts_or_turns_the_shorter_way() {
    let blocks = "T1 M6\nS9000 M3\nG43 H1\nG0 A0. C345.\nG0 X20. Y0.\nZ5.\nG1 C15.\nG0 Z50.";
    let scene = Scene::new(blocks).placed().obstacle([-22.0, -2.0, -2.0], [-18.0, 2.0, 30.0]);
    let scene = scene.with("machine = \"A-C trunnion\"\nanyway = true");
    scene.gives(&[], 1, &["the clamp", "under rotary = \"counts\""]);
    scene.gives(&LINUXCNC, 1, &["the clamp"]);
    scene.gives(&FANUC, 0, &[]);
    // Half a turn is as short either way.
    let half = Scene::new(&blocks.replace("C15.", "C165.")).placed();
    let half = half.with("machine = \"A-C trunnion\"");
    half.gives(&FANUC, 2, &["half a turn"]);
}

/// Rapid traverse around the corner of a clamp: clear on the straight line, and not on some dog-leg.
#[test]
fn rapid_traverse_is_any_dog_leg_where_its_path_is_not_stated() {
    let blocks = "T1 M6\nS9000 M3\nG43 H1\nG0 X-10. Y-10. Z1.\nX10. Y10. Z1.\nG1 Y12.";
    let clamp = ([4.0, -9.0, -2.0], [9.0, -4.0, 5.0]);
    let scene = Scene::new(blocks).placed().obstacle(clamp.0, clamp.1).with("anyway = true");
    scene.gives(&[], 1, &["the clamp", "at some rates of its axes", "`rapid`"]);
    scene.gives(&FANUC, 1, &["the clamp"]);
    scene.gives(&LINUXCNC, 0, &[]);
    // With rates the path is one dog-leg: X and Y together, or X first.
    let machine = stdout(&touchoff(&["machines", "3-axis"]));
    let scene = scene.with("machine = \"mine.toml\"");
    for (x, status) in [(10_000, 0), (40_000, 1)] {
        let rate = |machine: &str, letter: &str, rate: i32| {
            let from = format!("letter = \"{letter}\"\n");
            machine.replace(&from, &format!("{from}rapid = {rate}\n"))
        };
        let machine = rate(&rate(&rate(&machine, "X", x), "Y", 10_000), "Z", 10_000);
        scene.bench.write("mine.toml", machine);
        scene.gives(&[], status, &[]);
    }
    // Away from the clamp all dog-legs are proved clear.
    let away = Scene::new(blocks).placed().obstacle([40.0, 40.0, 0.0], [45.0, 45.0, 9.0]);
    away.with("anyway = true").gives(&[], 0, &[]);
}

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

/// Every tool with motions is in the verdict.
#[test]
fn a_tool_without_a_checked_motion_is_named() {
    let start = "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG0 Z20.\n";
    for (tool, words) in
        [("T2", "no motion of T2 is checked"), ("T0", "no motion of T0 is checked")]
    {
        let scene = Scene::new(&format!("{start}G49\n{tool} M6\nG0 X0. Y0.\nZ-5."));
        let mut scene = scene.placed();
        scene.job += "[tool.2]\ntool = \"D2Ball\"\n";
        scene.gives(&LINUXCNC, 2, &[words, "moves without a tool length offset"]);
    }
}

/// The gauge point of the spindle goes where the program says without G43.
#[test]
fn a_feed_without_a_length_offset_is_no_guess() {
    let blocks = "T1 M6\nS9000 M3\nG0 X-6. Y0. Z20.\nG1 X4. Z1.";
    let scene = Scene::new(blocks);
    scene.gives(&LINUXCNC, 2, &["no tool length offset (G43) is in force", "write G43"]);
    scene.gives(&[], 2, &["no tool length offset (G43) is in force"]);
    // One of two tools has G43.
    let one = "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG49\nT3 M6\nS9000 M3\nG0 X-6. Y0. Z20.\nG1 X4.";
    let mut one = Scene::new(one);
    one.job += "[tool.3]\ntool = \"D2Ball\"\n";
    one.gives(&LINUXCNC, 2, &["T3 moves without a tool length offset: write G43 H3"]);
    // The length of the tool applies without a word in native programs of Sinumerik, and not in ISO mode.
    scene.gives(
        &SIEMENS,
        2,
        &["no tool length offset (G43) is in force", "tool_length = \"with G43\""],
    );
    scene.with("anyway = true").gives_natively(0, &[]);
    let named = Scene::new("G0 X-6. Y0. Z20.\nG1 X4. Z1.");
    named.gives(&LINUXCNC, 0, &["positions are taken as those of the tip"]);
}

#[test]
fn a_number_that_two_tools_of_a_library_have_is_refused() {
    let scene = Scene::new("T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.");
    let bit = |name: &str| {
        format!(
            "{{\"guid\": \"{name}\", \"type\": \"flat end mill\", \"unit\": \"millimeters\", \"description\": \"{name}\", \
             \"geometry\": {{\"DC\": 6, \"LCF\": 20, \"OAL\": 60, \"LB\": 30, \"SFDM\": 6, \"shoulder-length\": 25}}, \
             \"post-process\": {{\"number\": 1}}}}"
        )
    };
    let library = format!("{{\"version\": 1, \"data\": [{}, {}]}}", bit("one"), bit("two"));
    let library = scene.bench.write("two.json", library);
    let place = |name: &str| scene.bench.folder.path().join(name).display().to_string();
    let (part, program) = (place("block.stl"), place("a.nc"));
    let common = ["verify", "--part", &part, "--unit", "mm", "--program", &program];
    let verify = |more: &[&str]| touchoff(&[&common, &LINUXCNC[..], more].concat());
    let output = verify(&["--tools", &library]);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("has 2 tools `T1`: `one`, `two`"), "{said}");
    // A folder keeps the numbers of the tools that were imported into it.
    let folder = place("tools");
    for (only, expected) in [("one", 0), ("two", 2)] {
        let imported = touchoff(&["import", &library, "-o", &folder, "--only", only]);
        assert!(imported.status.success(), "{}", stderr(&imported));
        let output = verify(&["--tools", &folder]);
        assert_eq!(output.status.code(), Some(expected), "{}", stderr(&output));
    }
}

#[test]
fn a_work_offset_far_from_the_part_is_named() {
    let blocks =
        "G43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG0 Z20.\nG55 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG0 Z20.";
    let mut scene = Scene::new(blocks).placed();
    scene.job += "G55 = [200, 0, -400]\n";
    scene.gives(&LINUXCNC, 2, &["under G55 the tool never comes within its diameter of the part"]);
    scene.job = scene.job.replace("[200, 0, -400]", "[1, 0, -400]");
    scene.gives(&LINUXCNC, 0, &[]);
}

#[test]
fn limits_of_rotary_axes_need_no_work_offset() {
    let blocks = "T1 M6\nS9000 M3\nG43 H1\nM428\nG0 X0. Y0. Z30. A0. C0.\nG1 A45.\nG1 A0.";
    let scene = Scene::new(blocks).with("machine = \"A-C trunnion\"\nanyway = true");
    scene.gives(&LINUXCNC, 1, &["A goes to 45.0000°, beyond its limit of 30°"]);
    let said =
        ["the limits of X, Y and Z are not checked: state the origin of G54 in `work_offsets`"];
    scene.gives(&LINUXCNC, 1, &said);
}

#[test]
fn a_feed_needs_a_spindle_that_turns_the_right_way() {
    let feed = "G0 X-6. Y0. Z20.\nG1 X4. Z1. F100.\nM30\n";
    let given = |start: &str, status: i32, words: &str| {
        let scene = Scene::of(&format!("G21 G90 G54\n{start}\n{feed}"));
        scene.gives(&LINUXCNC, status, &[words]);
    };
    given("S900 M3", 0, "");
    given("S900 M13", 2, "a brake of a rotary axis on Haas");
    given("S900 M3\nM5", 1, "feeds with the spindle off");
    given("M3", 1, "no speed of the spindle");
    given("S0 M3", 1, "feeds with the spindle off");
    given("S900 M4", 1, "the wrong way round");
    given("", 2, "never starts the spindle");
    let mut left = Scene::of(&format!("G21 G90 G54\nT1 M6\nS900 M4\nG43 H1\n{feed}"));
    left.gives(&LINUXCNC, 1, &["the wrong way round"]);
    left.job = left.job.replace("LENGTH", "hand = \"left\"\nLENGTH");
    left.gives(&LINUXCNC, 0, &[]);
    // A stop stops the spindle of a Haas, and not that of LinuxCNC.
    let stop = Scene::of(&format!("G21 G90 G54\nS900 M3\nM0\n{feed}"));
    stop.gives(&LINUXCNC, 0, &[]);
    stop.gives(&HAAS, 1, &["feeds with the spindle off"]);
    stop.gives(&[], 1, &["feeds with the spindle off", "under stop = \"stops spindle\""]);
    let heidenhain = Scene::of(&format!("G71 G90\nS900 M3\nM0\n{feed}"));
    let heidenhain_words = ["feeds with the spindle off"];
    heidenhain.gives(&["--control", "heidenhain"], 1, &heidenhain_words);
    // M6 stops the spindle without a change of the tool, too.
    let change = Scene::of(&format!("G71 G90\nT1\nS900 M3\nM6\n{feed}"));
    change.gives(&["--control", "heidenhain"], 1, &heidenhain_words);
    let order =
        Scene::of(&format!("G21 G90 G54\nG0 X-6. Y0. Z20.\nG1 X4. Z1. F100.\nS900 M3\n{feed}"));
    order.gives(&LINUXCNC, 1, &["feeds with the spindle off"]);
}

#[test]
fn what_a_program_leaves_out_at_its_start_is_named() {
    let blocks = "G0 X-6. Y0. Z20.\nG1 X4. Z1.";
    let scene = Scene::of(&format!("G90 G54 S900 M3 F100.\n{blocks}\nM30\n"));
    scene.gives(&[], 2, &["no G20 or G21", "state `unit` of the control"]);
    scene.gives(&LINUXCNC, 0, &[]);
    let scene = Scene::of(&format!("G90 G21 S900 M3 F100.\n{blocks}\nM30\n"));
    scene.gives(&[], 2, &["no work offset before a position", "`start_offset`"]);
    scene.gives(&SIEMENS, 2, &["a work offset (G54) before"]);
    scene.gives(&LINUXCNC, 0, &[]);
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

/// The level to which a cycle returns without G98 or G99: R on LinuxCNC, the initial level elsewhere.
#[test]
fn a_cycle_without_a_return_level_returns_to_either() {
    let blocks = "G0 X-4. Y0. Z20.\nG81 X-4. Y0. Z1. R2.\nX4.\nG80\nG0 Z20.";
    let scene = Scene::new(blocks).obstacle([-1.0, -3.0, 0.5], [1.0, 3.0, 10.0]);
    scene.gives(&[], 1, &["the clamp", "under cycle_return = \"plane R\""]);
    scene.gives(&LINUXCNC, 1, &["the clamp"]);
    let stated = Scene::new(&blocks.replace("G81", "G98 G81"));
    let stated = stated.obstacle([-1.0, -3.0, 0.5], [1.0, 3.0, 10.0]);
    stated.gives(&[], 0, &[]);
}

/// The length offset after G28: off on Haas, so that the spindle comes down by the length of the tool.
#[test]
fn a_return_can_cancel_the_length_offset() {
    let blocks =
        "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nG91 G28 Z0.\nG90 G0 X0. Y0.\nZ49.5\nG1 X1.";
    let scene = Scene::new(blocks).placed().with("anyway = true");
    scene.gives(&LINUXCNC, 0, &[]);
    scene.gives(&[], 1, &["under reference_return = \"cancels length\""]);
    scene.gives(&HAAS, 1, &["in rapid traverse"]);
}

/// A collision is one however far it is from the part.
#[test]
fn a_collision_far_from_the_part_has_status_1() {
    let blocks = "G0 X100. Y0. Z20.\nG1 Z5.\nG0 Z20.";
    let scene = Scene::new(blocks).obstacle([95.0, -5.0, 0.0], [105.0, 5.0, 10.0]);
    scene.gives(&LINUXCNC, 1, &["the clamp"]);
    let free = Scene::new(blocks);
    free.gives(&LINUXCNC, 2, &["never comes within the tool's diameter"]);
    // The reason comes before everything else that is said of the program.
    let said = stderr(&free.run(&LINUXCNC));
    assert!(said.find("not verified:") < said.find("program:"), "{said}");
}

#[test]
fn a_mesh_in_place_of_a_job_is_named() {
    let bench = Bench::new();
    let part = bench.folder.path().join("block.stl").display().to_string();
    let output = touchoff(&["verify", &part]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("is a mesh, and `verify` takes a job file"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn what_was_not_checked_is_in_the_json() {
    let scene = Scene::new("G0 X-6. Y0. Z20.\nM8\nM0\nG1 X4. Z1.");
    let rows = objects(&scene.run(&[&LINUXCNC[..], &["--json"]].concat()));
    let reasons: Vec<&str> = rows.iter().filter_map(|row| row["reason"].as_str()).collect();
    assert!(
        rows.iter().all(|row| row["kind"] == "not-checked" && row["open"] == false),
        "{rows:?}"
    );
    for word in
        ["limits of X, Y and Z", "no position before", "by hand during the stop", "of the tip"]
    {
        assert!(reasons.iter().any(|reason| reason.contains(word)), "{word}: {reasons:?}");
    }
    assert!(!reasons.iter().any(|reason| reason.contains("passed over")), "{reasons:?}");
}

/// Too many rules at once that are not stated are no verdict.
#[test]
fn too_many_readings_name_the_rules() {
    let blocks = "G0 X-6 Y0. Z2.\n/G0 X5.\nG81 X-6 Y0. Z1. R6.\nX6. ; G0 X1.\nG80\nM0\nG1 Z2.";
    let scene = Scene::new(blocks);
    let words = ["in more than 8 ways", "`whole_numbers` (line 2)", "`cycle_below_r`"];
    scene.gives(&[], 2, &words);
}

#[test]
fn a_wrong_control_is_refused_with_the_nearest_key() {
    let scene = Scene::new("G0 X-6. Y0. Z20.\nG1 X4. Z1.");
    scene.gives(&["--control", "fanac"], 2, &["did you mean `fanuc`?"]);
    let file = ControlRules::named("linuxcnc").expect("a control").to_toml();
    let control = scene.bench.folder.path().join("c.toml").display().to_string();
    for (from, to, word) in [
        (
            "whole_numbers",
            "whole_number",
            "`whole_number` is no rule: did you mean `whole_numbers`?",
        ),
        ("\nrapid =", "\n#rapid =", "the rule `rapid` is missing"),
        ("\"straight\"", "\"fast\"", "`rapid` is one of \"straight\", \"each axis\""),
    ] {
        fs::write(&control, file.replace(from, to)).expect("a file");
        scene.gives(&["--control", &control], 2, &[word, "c.toml"]);
    }
    fs::write(&control, &file).expect("a file");
    scene.gives(&["--control", &control], 0, &[]);
}

/// The commands list every rule of every control, and every axis of every machine; what they print is a file.
#[test]
fn controls_and_machines_are_listed() {
    let listed = stdout(&touchoff(&["controls"]));
    for name in ControlRules::names() {
        let control = ControlRules::named(name).expect("a control");
        assert!(listed.contains(&format!("{name}\n")), "{listed}");
        assert_eq!(stdout(&touchoff(&["controls", name])), control.to_toml());
    }
    let rows = objects(&touchoff(&["controls", "--json"]));
    let keys = Rule::all().filter(|rule| *rule != Rule::OptionalBlocks).count();
    for row in &rows {
        let stated = row["rules"].as_object().map_or(0, |rules| rules.len());
        let open = match row["name"].as_str() {
            Some("fanuc") => 3,
            Some("haas") => 2,
            Some("siemens") => 3,
            Some("heidenhain") => 1,
            _ => 0,
        };
        assert_eq!(stated, keys - open, "{row}");
    }
    let machines = stdout(&touchoff(&["machines"]));
    let trunnion = "A moves the table, from -120 to 30°, home 0, about [1.0, 0.0, 0.0] through [0.0, 0.0, -480.0]";
    assert!(machines.contains(trunnion), "{machines}");
    let unknown = touchoff(&["machines", "4-axis"]);
    assert!(!unknown.status.success() && stderr(&unknown).contains("A-C trunnion"));
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

/// Z under G53 is that of the gauge point, or of the tip on Siemens.
#[test]
fn under_g53_the_length_counts_or_not() {
    let blocks = "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nX0.\nG53 Z-399.5\nG1 X1.";
    let scene = Scene::new(blocks).placed().with("anyway = true");
    scene.gives(&LINUXCNC, 1, &["right through the part"]);
    let scene = Scene::new(&blocks.replace("-399.5", "-350.5")).placed().with("anyway = true");
    scene.gives(&LINUXCNC, 1, &["0.5000 mm deep in the part"]);
    let scene = Scene::new(&blocks.replace("-399.5", "-348.")).placed().with("anyway = true");
    scene.gives(&LINUXCNC, 0, &[]);
    let low = Scene::new(&blocks.replace("-399.5", "-300.")).placed().with("anyway = true");
    low.gives(&LINUXCNC, 0, &[]);
    low.gives(&SIEMENS, 0, &[]);
    let tip = Scene::new(&blocks.replace("-399.5", "-400.5")).placed().with("anyway = true");
    tip.gives(&SIEMENS, 1, &["0.5000 mm deep in the part"]);
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

/// The path is that of each axis, or the straight line, where the machine's file has rates.
#[test]
fn rates_do_not_say_that_each_axis_moves_by_itself() {
    let blocks = "T1 M6\nS9000 M3\nG43 H1\nG0 X-10. Y-10. Z1.\nX10. Y10. Z1.\nG1 Y12.";
    let scene = Scene::new(blocks).placed().obstacle([3.0, 3.0, -2.0], [6.0, 6.0, 5.0]);
    let mut machine = stdout(&touchoff(&["machines", "3-axis"]));
    for (letter, rate) in [("X", 40_000), ("Y", 10_000), ("Z", 10_000)] {
        let from = format!("letter = \"{letter}\"\n");
        machine = machine.replace(&from, &format!("{from}rapid = {rate}\n"));
    }
    scene.bench.write("mine.toml", machine);
    let scene = scene.with("machine = \"mine.toml\"\nanyway = true");
    scene.gives(&[], 1, &["the clamp", "under rapid = \"straight\""]);
    scene.gives(&LINUXCNC, 1, &["the clamp"]);
    scene.gives(&FANUC, 0, &[]);
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
        scene.gives(&FANUC, 1, &["the clamp"]);
        scene.gives(&[], 1, &["the clamp"]);
    }
    let tilted = "T1 M6\nS9000 M3\nG43 H1\nG0 X20. Y0. Z50. A0. C-15.\nG68.2 X0. Y0. Z0. I165. J20. K0.\nG53.1\nG69\n\
                  G0 A0.\nG0 C345.\nG0 X20. Y0. Z5.\nG0 C15.\nG0 Z50.";
    let scene = Scene::new(tilted).placed().obstacle(post.0, post.1);
    let scene = scene.with("machine = \"A-C trunnion\"\nanyway = true");
    let fanuc = ControlRules::named("fanuc").expect("a control");
    let stated = fanuc
        .with(Rule::TcpStart, Choice::TableAtZero)
        .with(Rule::ReferenceReturn, Choice::KeepsLength)
        .with(Rule::LengthChange, Choice::WithNextZ)
        .with(Rule::CycleRepeats, Choice::RepeatsByL);
    let control = scene.bench.write("fanuc.toml", stated.to_toml());
    scene.gives(&["--control", &control], 1, &["the clamp"]);
}

/// A tool change changes the length that counts without G43, and D0 ends it.
#[test]
fn the_length_that_counts_always_is_that_of_the_tool() {
    let start =
        "G21 G90 G54 S9000 M3 F100.\nT1 M6\nS9000 M3\nG0 X-6. Y0. Z20.\nG1 X4. Z1.\nG0 Z20.\n";
    let two = format!("{start}T2 M6\nS9000 M3\nG0 X-6. Y0. Z20.\nG1 Z0.5\nX0.\nM30\n");
    let mut scene = Scene::of(&two).placed().with("anyway = true");
    scene.job += "[tool.2]\ntool = \"D2Ball\"\nlength = 30\n";
    scene.gives_natively(0, &[]);
    scene.gives(&LINUXCNC, 1, &[]);
    // Without a length, the spindle comes down by 50.
    let edge =
        Scene::of(&format!("{start}D0\nG0 Z49.\nX-3.\nM30\n")).placed().with("anyway = true");
    edge.gives_natively(1, &["in rapid traverse"]);
    let edge = Scene::of(&format!("{start}D2\nG0 Z49.\nM30\n")).placed().with("anyway = true");
    edge.gives_natively(2, &["D1, the only cutting edge"]);
}

/// Endless axes of Siemens turn between angles from 0 to 360.
#[test]
fn a_rotary_axis_turns_within_a_turn() {
    let blocks =
        "T1 M6\nS9000 M3\nG43 H1\nG0 X20. Y0. Z50. A0. C0.\nG91 C450.\nG90 Z5.\nG1 C280.\nG0 Z50.";
    let scene = Scene::new(blocks).placed().obstacle([-22.0, -2.0, -2.0], [-18.0, 2.0, 30.0]);
    let scene = scene.with("machine = \"A-C trunnion\"\nanyway = true");
    scene.gives_natively(1, &["the clamp"]);
    scene.gives(&LINUXCNC, 0, &[]);
    scene.gives(&[], 1, &["under rotary = \"within a turn\""]);
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
    scene(&turned).gives(&FANUC, 2, &["`tcp_start`"]);
    scene(&turned).gives(&[], 2, &["`tcp_start`"]);
    scene(&turned.replace("G43.4 H1", "G43 H1\nM428")).gives(&LINUXCNC, 0, &[]);
    let at_zero = blocks.replace("G43.4 H1", "G0 A0. C0.\nG43.4 H1");
    scene(&at_zero).gives(&FANUC, 0, &[]);
    let in_its_block = at_zero.replace("G43.4 H1", "G43.4 H1 C90.");
    scene(&in_its_block).gives(&FANUC, 2, &["G43.4 while its block turns the axes"]);
    // It begins anew without a motion between, and so does a plane.
    let anew = format!("{at_zero}\nG1 C40.\nG49\nG43.4 H1\nG0 X-6. Y0. Z50.\nG49");
    scene(&anew).gives(&FANUC, 0, &["1 motion not checked", "`tcp_start`"]);
    let plane = "T1 M6\nS9000 M3\nG0 A0. C90.\nG43 H1 Z60.\nG68.2 X0 Y0 Z0 I0 J0 K0\nG53.1\nG0 X-6. Y0. Z20.";
    scene(plane).gives(&FANUC, 2, &["`tcp_start`"]);
    scene(&plane.replace("C90", "C0")).gives(&FANUC, 0, &[]);
    scene(&format!("{at_zero}\nG49 G0 X-7.")).gives(&FANUC, 2, &["write it in a block of its own"]);
    // An offset of the table turns the part, or does not.
    let mut offset = scene(&at_zero);
    offset.job = offset.job.replace("-400]", "-400, 0, 0, 30]");
    offset.gives(&FANUC, 0, &[]);
    for control in [&HAAS[..], &[]] {
        offset.gives(control, 2, &["G54 turns the table"]);
    }
    offset.bench.write("a.nc", program(&at_zero.replace("G43.4 H1", "G43 H1\nM428")));
    offset.gives(&LINUXCNC, 2, &["G54 turns the table"]);
}

/// A control computes tips with the length offset that is in force, also under tool centre point control.
#[test]
fn tool_centre_point_control_needs_a_length_offset() {
    let moves = "G0 X-6. Y0. Z20.\nG1 X-4. Z1.\nG0 Z50.";
    let scene = |blocks: &str| {
        let scene = Scene::new(&format!("T1 M6\nS9000 M3\nG0 A0. C0.\n{blocks}")).placed();
        scene.with("machine = \"A-C trunnion\"\nanyway = true")
    };
    let word = ["and no length offset"];
    for (control, start) in [
        (&FANUC, "G43.4 H0"),
        (&FANUC, "G43.4"),
        (&FANUC, "G43.5 H0"),
        (&FANUC, "G68.2 X0 Y0 Z0 I0 J0 K0\nG53.1"),
        (&HAAS, "G234 H0"),
        (&LINUXCNC, "M428"),
        (&LINUXCNC, "G43 H1\nM428\nG49"),
    ] {
        scene(&format!("{start}\n{moves}")).gives(control, 2, &word);
    }
    let unknown = Scene::new(&format!("T1 M6\nS9000 M3\nG0 A0. C0.\nM428\n{moves}"));
    unknown.with("machine = \"A-C trunnion\"").gives(&LINUXCNC, 2, &word);
    for (control, start) in [
        (&FANUC, "G43.4 H1"),
        (&FANUC, "G43 H1 Z60.\nG68.2 X0 Y0 Z0 I0 J0 K0\nG53.1"),
        (&LINUXCNC, "G43 H1\nM428"),
    ] {
        scene(&format!("{start}\n{moves}")).gives(control, 0, &[]);
    }
}

/// Under TRAORI the tool axis turns by the axes, or on a great circle, which is not followed.
#[test]
fn an_orientation_under_traori_is_stated() {
    let blocks = "T1 M6\nS9000 M3\nG0 A0. C0.\nTRAORI\nG54\nG0 X-6. Y0. Z20.\nG1 X-4. Z1.\nG0 Z20. A-10. C20.\nTRAFOOF\nG54";
    let scene = Scene::new(blocks).placed().with("machine = \"mine.toml\"");
    let machine = stdout(&touchoff(&["machines", "A-C trunnion"]));
    let machine = machine.replace("name = ", "tool_change = \"stays\"\nname = ");
    scene.bench.write("mine.toml", machine);
    scene.gives(&SIEMENS, 2, &["ORIVECT", "great circle"]);
    scene.gives_natively(0, &[]);
}

/// A rotary axis without limits returns in a direction of the machine's.
#[test]
fn a_return_of_a_rotary_axis_is_not_the_shorter_way() {
    let blocks = "G43 H1 G0 X-6. Y0. Z20. A0. C10.\nG1 X-4. Z1.\nG0 Z50.\nG91 G28 C0.\nG90";
    let scene = Scene::new(blocks).placed().with("machine = \"A-C trunnion\"");
    scene.gives(&FANUC, 2, &["in a direction of the machine's"]);
    scene.gives(&LINUXCNC, 0, &[]);
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
    scene(&blocks("A5. C0.")).gives_straight(2, &["two positions of the rotary axes"]);
    scene(&blocks("A0. C0.")).gives_straight(0, &[]);
}

/// In an aligned plane, too, each axis moves by itself.
#[test]
fn rapid_traverse_in_a_tilted_plane_is_any_dog_leg() {
    let blocks = "T1 M6\nS9000 M3\nG43 H1\nG0 X-10. Y-10. Z50. A0. C0.\nG68.2 X0. Y0. Z0. I0. J0. K0.\nG53.1\n\
                  G0 X-10. Y-10. Z1.\nX10. Y10. Z1.\nG1 Y12.\nG0 Z50.\nG69";
    let scene = Scene::new(blocks).placed().obstacle([4.0, -9.0, -2.0], [9.0, -4.0, 5.0]);
    let scene = scene.with("machine = \"A-C trunnion\"\nanyway = true");
    scene.gives(&FANUC, 1, &["the clamp", "at some rates of its axes"]);
    scene.gives_straight(0, &[]);
}

/// The tool of a program that names none is that of its first length offset.
#[test]
fn a_program_without_a_tool_number_moves_its_gauge_point_without_an_offset() {
    let start = "G43 H1 G0 X-6. Y0. Z45.\nG1 X-4. Z1.\nG0 Z45.\n";
    for end in ["G49 Z45.\nX6.\nG1 X5.", "G91 G28 Z0.\nG90 G49 G0 Z45.\nX6.\nG1 X5."] {
        let scene = Scene::new(&format!("{start}{end}")).placed();
        let scene = scene.obstacle([0.0, -2.0, -20.0], [8.0, 2.0, -1.0]).with("anyway = true");
        scene.gives(&LINUXCNC, 1, &["the clamp"]);
    }
    let other = Scene::new(&format!("{start}G43 H7 Z45.\nX6.\nG1 X5.")).placed();
    other.gives(&LINUXCNC, 2, &["with the length offset H7 of another tool"]);
}

/// The state at the end of a program is that in which its next run begins, on some controls.
#[test]
fn a_program_that_ends_otherwise_than_it_begins_is_named() {
    let begin = "G21 G54 S9000 M3 F100.\nG0 X-6. Y0. Z20.\nG1 X-4. Z1.\nG0 Z20.\n";
    let word = "which a control can keep, and its next run is another";
    Scene::of(&format!("{begin}G91 G28 Z0.\nM30\n")).gives(&FANUC, 2, &[word]);
    Scene::of(&format!("{begin}G91 G28 Z0.\nM30\n")).gives(&LINUXCNC, 0, &[]);
    Scene::of(&format!("{begin}G91 G28 Z0.\nG90\nM30\n")).gives(&FANUC, 0, &[]);
    Scene::of(&format!("{begin}G52 X1.\nM30\n")).gives(&LINUXCNC, 2, &[word]);
    Scene::of(&format!("%\n{begin}G91 G0 Z1.\n%\n")).gives(&LINUXCNC, 2, &[word]);
    let cycles = "G81 X-4. Y0. Z1. R3.\nG80\nG99 G81 X-5. Z1. R3.\nG80\nG0 Z20.\nG90\nM30\n";
    Scene::of(&format!("{begin}{cycles}")).gives(&FANUC, 2, &[word]);
    // LinuxCNC keeps the unit and the length offset, of all that M30 leaves.
    let moves = "G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG0 Z20.";
    let unit = format!("G90 G54 S900 M3 F100.\nG43 H1\n{moves}\nG20\nM30\n");
    Scene::of(&unit).gives(&LINUXCNC, 2, &["line 3: the program ends with G20"]);
    let length = format!("{begin}G43 H1\nG0 Z20.\nM30\n");
    Scene::of(&length).gives(&LINUXCNC, 2, &["line 2: the program ends with G43 H1"]);
    let stated = format!("{begin}G0 G90 Z20.\nG20 G55\nM30\n");
    Scene::of(&stated).gives(&LINUXCNC, 0, &[]);
    // G49 at the start moves Z by the length that the run before has left.
    let cancels = "G21 G90 G54 G49\nG0 X-6. Y0.\nG43 H1 Z20.\nS900 M3\nG1 X-4. Z1. F100.\nM30\n";
    Scene::of(cancels).gives(&FANUC, 2, &["line 1: the program ends with G43 H1"]);
    Scene::of(cancels).gives(&HAAS, 2, &["the program ends with G43 H1"]);
    Scene::of(&cancels.replace("M30", "G49\nM30")).gives(&LINUXCNC, 0, &[]);
    // The operator can turn the switch for optional blocks between two runs.
    let moves = "G0 X-6. Y0. Z20.\nG1 X-4. Z1.\nG0 Z20.";
    let switched = Scene::new(&format!("/G52 X0\n{moves}\n/G52 X-8."));
    switched.gives(&LINUXCNC, 2, &["line 3: the program ends with G52"]);
    Scene::new(&format!("/G52 X0\n{moves}")).gives(&LINUXCNC, 0, &[]);
    // A new origin and a shift, which cancel each other where both are kept.
    let both = format!("G43 H1\nG55\n{moves}\nG10 L2 P2 X40. Y0. Z-400.\nG52 X-40.\nG0 X-6.\nG49");
    let mut both = Scene::new(&both).placed();
    both.job += "G55 = [0, 0, -400]\n";
    both.gives(&FANUC, 2, &["the program ends with G10, G52"]);
    both.gives(&LINUXCNC, 0, &[]);
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

/// An axis that the program has not stated leaves all motions between stated positions unknown.
#[test]
fn an_axis_that_is_not_stated_is_named() {
    let blocks =
        "T1 M6\nS9000 M3\nG43 H1\nG0 X-6. Y0. Z20.\nG0 Z5.\nG0 X6.\nG0 A0. C0.\nG1 X4. Z1.";
    let scene = Scene::new(blocks).placed().with("machine = \"A-C trunnion\"");
    scene.gives(
        &LINUXCNC,
        2,
        &["2 motions not checked, first at line 6: the position of another axis is not stated"],
    );
    let stated = Scene::new(&blocks.replace("Y0. Z20.", "Y0. Z20. A0. C0.")).placed();
    stated.with("machine = \"A-C trunnion\"").gives(&LINUXCNC, 0, &[]);
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

/// G98 returns to the initial level of a cycle, or to R where that level is below it.
#[test]
fn g98_returns_to_the_initial_level_wherever_it_is() {
    let blocks = "G0 X-4. Y0. Z20.\nZ1.\nG98 G81 X-4. Y0. Z0.5 R9.\nX4.\nG80\nG0 Z20.";
    let scene = Scene::new(blocks).obstacle([-1.0, -3.0, 2.5], [1.0, 3.0, 7.0]);
    let scene = scene.with("anyway = true");
    scene.gives(&LINUXCNC, 0, &[]);
    scene.gives(&HAAS, 1, &["the clamp"]);
    scene.gives(&[], 1, &["the clamp", "under cycle_below_r = \"sideways first\""]);
    // LinuxCNC goes from the initial level to a lower R, and then sideways.
    let lower =
        Scene::new("G0 X-4. Y0. Z20.\nZ1.\nG99 G81 X-4. Y0. Z0.5 R9.\nX4. R4.\nG80\nG0 Z20.");
    let lower = lower.obstacle([-1.0, -3.0, 2.5], [1.0, 3.0, 7.0]).with("anyway = true");
    lower.gives(&LINUXCNC, 1, &["the clamp"]);
}

/// LinuxCNC moves on a straight line to the next hole of a series and to a level that is higher, others sideways first.
#[test]
fn a_series_of_cycles_rises_on_the_way_or_after_it() {
    let blocks = "G0 X-10. Y0. Z20.\nG99 G81 X-10. Y0. Z0.5 R2.\nG98 X10.\nG80\nG1 X11.";
    let scene =
        Scene::new(blocks).obstacle([4.0, -3.0, 0.5], [9.0, 3.0, 4.0]).with("anyway = true");
    scene.gives(&LINUXCNC, 0, &[]);
    scene.gives(&HAAS, 1, &["the clamp"]);
    scene.gives(&[], 1, &["the clamp", "under cycle_below_r = \"sideways first\""]);
}

/// A change to the tool in the spindle may leave Z where it is.
#[test]
fn a_change_to_the_same_tool_may_not_retract() {
    let blocks = "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nT1 M6\nS9000 M3\nG0 X6.";
    Scene::new(blocks).placed().gives(&HAAS, 2, &["`tool_change`"]);
}

#[test]
fn g43_without_h_takes_the_tool_or_the_last_h() {
    let text =
        "G21 G90 G54 S9000 M3 F100.\nT1 M6\nS9000 M3\nG43 G0 X-6. Y0. Z49.5\nX0.\nG1 X4.\nM30\n";
    let scene = Scene::of(text).placed().with("anyway = true");
    scene.gives(&LINUXCNC, 0, &[]);
    scene.gives(&FANUC, 1, &["in rapid traverse"]);
    scene.gives(&[], 1, &["under length_register = \"last H\""]);
}

#[test]
fn a_shift_that_ends_without_axes_ends_or_stays() {
    let blocks = "G0 X-6. Y0. Z20.\nG92 Z60.\nG92.1\nG0 Z41.\nX6.\nG1 X5.";
    let scene =
        Scene::new(blocks).obstacle([-1.0, -3.0, 0.0], [1.0, 3.0, 8.0]).with("anyway = true");
    scene.gives(&LINUXCNC, 0, &[]);
    scene.gives(&FANUC, 1, &["the clamp"]);
    scene.gives(&[], 1, &["under preset_end = \"stays\""]);
}

/// Words that controls read in ways that are not followed are refused, or allow no verdict.
#[test]
fn other_words_on_which_controls_differ_are_refused() {
    let begin = "G0 X-6. Y0. Z20.\nG1 X4. Z1.\n";
    for (blocks, word) in [
        ("G99 G81 X4. Z0.5 R2.\nG20 X0.1", "coordinates, unit or tool have changed"),
        ("G0 X12. Y0.\nG3 X12. Y0.0004 I-2. J0.", "less than two increments from its start"),
        ("T1 M6\nS900 M3\nG91 G43 H1 Z20.", "the length offset has changed"),
        ("/1 G0 X5.\n/2 G0 X6.", "optional blocks have several switches"),
        ("G0 X0. Y0. Z20.\nG2 X20.02 Y0. I10. J0.", "the radii of an arc differ"),
        ("G0 Z30.\rG0 X5.", "a carriage return without a line feed"),
        ("G91 G28 X0. Y0. Z0.\nG0 X-10.\nG90", "only the machine knows where its coordinates"),
        ("G53 G0 Z-30.\nG53 G0 X10.\nG53 G0 X0.", "only the machine knows where its coordinates"),
    ] {
        Scene::new(&format!("{begin}{blocks}")).gives(&LINUXCNC, 2, &[word]);
    }
    // Text after a semicolon, in ways that do not look like a block at first sight.
    for text in ["X0. ;;Z-1.", "X0. ; (a) Z-1.", "X0. ; /Z-1.", "X0. ; #1=2 ; Z-1. ; NOTE A"] {
        let scene = Scene::new(&format!("G0 X-6. Y0. Z20.\nG1 X-4. Z1.\n{text}\nG0 Z20."));
        let scene = scene.with("block_delete = false\nanyway = true");
        scene.gives(&LINUXCNC, 0, &[]);
        scene.gives(&HAAS, 1, &["ball"]);
        scene.gives(&[], 1, &["under semicolon = \"end of block\""]);
    }
    let scene = Scene::new(&format!("{begin}X5. ; G65 P100")).with("anyway = true");
    scene.gives(&HAAS, 2, &["a macro call"]);
    // The number of repeats is no length.
    let repeats = Scene::new(&format!("{begin}G99 G91 G81 X0.1 Z-0.2 R-0.1 K2\nG80 G90"));
    repeats.with("anyway = true").gives(&FANUC, 0, &[]);
}

/// A change of the length offset without Z moves nothing, or Z by the change: down by the length after G49.
#[test]
fn a_change_of_the_length_offset_moves_z_or_not() {
    let start = "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z45.\nX5.\n";
    for (change, unnamed) in [("G49\nX6.", 1), ("G43 H0\nX6.", 2)] {
        let scene = Scene::new(&format!("{start}{change}\nG43 H1 Z45.\nG1 X5.")).placed();
        let scene = scene.obstacle([4.0, -2.0, -60.0], [8.0, 2.0, -1.0]).with("anyway = true");
        scene.gives(&LINUXCNC, 0, &[]);
        scene.gives(&FANUC, 1, &["the clamp", "under length_change = \"moves Z\""]);
        // H0 takes the length of the tool on LinuxCNC.
        let words = if unnamed == 1 { "length_change = \"moves Z\"" } else { "write G49" };
        scene.gives(&[], unnamed, &[words]);
    }
    let together = Scene::new(&format!("{start}G49 X6.\nG43 H1 Z45.\nG1 X5.")).placed();
    together.gives(&FANUC, 2, &["G49 while the length offset changes", "length_change"]);
    // Without an offset, and at the reference position, nothing changes.
    for blocks in [
        "G49\nT1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z45.",
        "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z45.\nG91 G28 Z0.\nG49\nG90",
    ] {
        let scene = Scene::new(blocks).placed().with("anyway = true");
        scene.gives(&FANUC, 0, &[]);
    }
    let pallet = Scene::new("G0 X-6. Y0. Z20.\nM50");
    pallet.gives(&HAAS, 2, &["M50 is a pallet change on Haas"]);
    let one_block =
        Scene::of("G21 G90 G54 F100.\nT1 M6 S900 M3\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nM30\n");
    one_block.with("anyway = true").gives(&LINUXCNC, 0, &[]);
}

/// A program that begins with a return along one axis is followed from its first position on.
#[test]
fn a_program_begins_with_a_return_along_one_axis() {
    for first in ["G91 G28 Z0.\nG90", "G91 G28 X0. Y0. Z0.\nG90", "G53 G0 Z0."] {
        let blocks = format!(
            "{first}\nT1 M6\nS9000 M3\nG0 X-6. Y0.\nG43 H1 Z20.\nG1 X4. Z1.\nG0 Z20.\nG91 G28 Z0."
        );
        Scene::new(&blocks).placed().gives(&LINUXCNC, 0, &[]);
        Scene::new(&blocks).gives(&LINUXCNC, 0, &[]);
    }
}

#[test]
fn a_length_that_counts_always_is_along_z_and_returns_with_d1() {
    let start = "G21 G90 G54 S9000 M3 F100.\nT1 M6\nS9000 M3\nG0 X-6. Y0. Z20.\n";
    let edge = Scene::of(&format!("{start}D0\nX-5.\nD1 Z20.\nG1 X4. Z1.\nM30\n")).placed();
    edge.with("anyway = true").gives_natively(0, &[]);
    let plane = Scene::of(&format!("{start}G18\nG0 Z21.\nM30\n")).placed();
    plane.gives_natively(
        2,
        &["G18 or G19 is in force and the length of the tool counts without G43"],
    );
    // An end near the start turns the arc of a control that moves its centre.
    let arc = Scene::of(&format!("{start}G0 X30.\nG3 X30.001 Y-0.1 I-30. J0.\nM30\n")).placed();
    arc.gives_natively(2, &["the radii of an arc differ"]);
    // The head of a program is that of one control.
    let head =
        "%PLATE G71 *\nN10 G90 G54 S9000 M3 F100.\nN20 G0 X-6. Y0. Z20.\nN99999999 %PLATE G71 *\n";
    Scene::of(head).gives(&[], 2, &["G54 is another word in DIN/ISO programs of Heidenhain"]);
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
    let passed = Scene::new(&format!("{begin}G103 P1\nG187 P2\nM83\nM84\nG0 Z20.*\n"));
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

/// A rapid traverse of a thin tool through a block of stock between its points.
#[test]
fn a_tool_that_is_thinner_than_the_points_of_the_stock_are_apart_is_named() {
    let text = "tool Pin { units mm; profile { start (0, 0); line to (0.5, 0), (0.5, 40), (0, 40) as pin cutting; } }";
    for (spacing, status, word) in [
        (1.0, 2, "T1 is too thin for a stock whose points are 1.0000 mm apart"),
        (0.4, 1, "pin touches the stock in rapid traverse"),
    ] {
        let mut scene = Scene::new("T1 M6\nS900 M3\nG0 X-30. Y0. Z5.3\nX30.\nG1 X4. Y40.");
        scene.bench.write("pin.tool", text);
        scene.job = scene.job.replace("D2Ball", "pin.tool");
        scene.job +=
            &format!("[stock]\nbox = [[-20, -20, -20], [20, 20, 20]]\nspacing = {spacing}\n");
        scene.gives(&LINUXCNC, status, &[word]);
    }
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
    scene(&format!("{plane}\nG53.1\nX-6. Y0. Z30.")).gives(&FANUC, 0, &[]);
    let not_aligned = "a length offset is in force in a tilted plane that is not aligned";
    scene(&format!("{plane}\nX-6. Y0. Z30.")).gives(&FANUC, 2, &[not_aligned]);
    let alone = scene(&format!("{plane}\nG53.1\nX-6. Y0. Z30.\nG69\nX-7."));
    alone.gives(&FANUC, 2, &["the first after G68 or G69, and not of both axes"]);
    let began = "G1 A-20. F500.\nG43.4 H1 Z60.";
    scene(began)
        .gives_straight(2, &["the first of tool centre point control that began with turned axes"]);
    scene("G234 X-6. Y0. Z30.").gives(&HAAS, 2, &["G234 needs H in its block"]);
    let again = "G43.4 H1\nX-6. Y0. Z30.\nG43 H1";
    scene(again).gives(&FANUC, 2, &["G43 while tool centre point control is on"]);
    let tie = "G68.2 X0 Y0 Z0 I90. J25. K0\nG53.1\nX-6. Y0. Z30.\nG69";
    scene(tie).gives(&FANUC, 2, &["two positions of the rotary axes give the tool axis"]);
    let in_feed = "a motion at feed rate is in force, at which Fanuc turns the axes";
    scene(&format!("G1 Z50.\n{plane}\nG53.1")).gives(&FANUC, 2, &[in_feed]);
}

/// Words whose values are positions of the work offset that TRAFOOF has deselected.
#[test]
fn words_after_trafoof_need_a_work_offset_as_positions_do() {
    for word in ["G52 X1.", "G92 X1.", "G28 Z50.", "G68 X0. Y0. R0."] {
        let start = "T1 D1 M6\nS9000 M3\nG0 X-6. Y0. Z20.\nTRAORI\nG54\nX-5.\nTRAFOOF";
        let scene = Scene::new(&format!("{start}\n{word}\nG54")).placed();
        let scene = scene.with("machine = \"A-C trunnion\"\nanyway = true");
        scene.gives_natively(2, &["since TRAORI and TRAFOOF deselect it"]);
    }
    // Parameters are no comment.
    for (word, status) in [("TRAORI(1)", 0), ("TRAORI(1,0,0,1,30,0)", 2), ("TRAORI(2)", 2)] {
        let blocks = format!(
            "T1 D1 M6\nS9000 M3\nG0 X-6. Y0. Z20. A0. C0.\n{word}\nG54\nX-5.\nTRAFOOF\nG54\nG0 Z60."
        );
        let scene = Scene::new(&blocks).placed();
        scene.with("machine = \"A-C trunnion\"\nanyway = true").gives_natively(status, &[]);
    }
    let blocks = "T1 D1 M6\nS9000 M3\nG0 X-6. Y0. Z20. A0. C0.\nTRAORI\nG54\nG18 G0 X-5.";
    let scene = Scene::new(blocks).placed().with("machine = \"A-C trunnion\"\nanyway = true");
    scene.gives(
        &SIEMENS,
        2,
        &["G18 or G19 is in force and the length of the tool counts without G43"],
    );
}

/// The repeats of a cycle are those after L, or after K; the other word says nothing.
#[test]
fn the_repeats_of_a_cycle_are_after_l_or_k() {
    let blocks = "G0 X-6. Y0. Z20.\nG99 G91 G81 X4. Z-0.2 R-18. L2\nG80 G90\nG0 Z20.";
    let scene = Scene::new(blocks).obstacle([1.0, -2.0, -1.0], [3.0, 2.0, 9.0]);
    scene.gives(&HAAS, 1, &["the clamp"]);
    scene.gives(&FANUC, 1, &["under cycle_repeats = \"L\""]);
    scene.gives(&SIEMENS, 0, &[]);
    scene.gives(&[], 1, &["under cycle_repeats = \"L\""]);
    let scene =
        Scene::new(&blocks.replace("L2", "K2")).obstacle([1.0, -2.0, -1.0], [3.0, 2.0, 9.0]);
    scene.gives(&FANUC, 1, &["the clamp"]);
    scene.gives(&HAAS, 0, &[]);
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
