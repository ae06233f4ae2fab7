//! Motions, cycles, returns and offsets.

use super::{FANUC, HAAS, LINUXCNC, SIEMENS, Scene};
use crate::bench::{objects, stdout, touchoff};

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

/// Where the part is on the machine is not known: only the way home is no part of the verdict.
#[test]
fn a_position_in_machine_coordinates_is_not_the_way_home() {
    let start = "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG0 Z20.\n";
    for (way, status) in [
        ("G53 G0 Z0.", 0),
        ("G53 G0 Z0.\nG53 G0 X-20. Y30.", 0),
        ("G91 G28 Z0.", 0),
        ("G53 G0 Z-150.", 2),
        ("G53 G0 X-20. Y30.", 2),
    ] {
        Scene::new(&format!("{start}{way}")).gives(&LINUXCNC, status, &[]);
    }
}
