//! Motions, cycles, returns and offsets.

use crate::scene::{ANY, CLEAN, FANUC, FINDINGS, HAAS, LINUXCNC, NONE, SIEMENS, Scene};

/// The changer leaves the axes above a clamp, through which the tool then comes down.
#[test]
fn after_a_tool_change_only_the_machine_knows_where_the_axes_are() {
    let blocks =
        "G43 H1 G0 X-6. Y0. Z20.\nT1 M6\nS9000 M3\nG0 X6. Y0.\nG43 H1 Z0.5\nG1 X0.\nG0 Z20.";
    let scene = Scene::new(blocks).placed().obstacle([2.0, -3.0, 60.0], [12.0, 3.0, 70.0]);
    scene.gives(ANY, NONE, &["V0403 5", "V0403 5 `tool_change`"]);
    scene.gives(FANUC, NONE, &["V0403 5 `tool_change`"]);
    scene.gives(LINUXCNC, CLEAN, &[]);
    // The control of Haas retracts Z to its home, unless T1 is in the spindle already.
    scene.gives(HAAS, NONE, &["V0403 5 `tool_change`"]);
    let other = blocks.replace("G43 H1 G0 X-6.", "T3 M6\nG43 H3 G0 X-6.");
    let mut other = Scene::new(&other).placed().obstacle([2.0, -3.0, 60.0], [12.0, 3.0, 70.0]);
    other.job += "[tool.3]\ntool = \"D2Ball\"\nlength = 50\n";
    other.gives(HAAS, FINDINGS, &["V0101 the clamp"]);
    let stated = |change: &str| {
        let scene = Scene::new(blocks).placed().obstacle([2.0, -3.0, 60.0], [12.0, 3.0, 70.0]);
        scene.on("3-axis", "name = ", &format!("tool_change = {change}\nname = "))
    };
    stated("{ Z = -300 }").gives(ANY, FINDINGS, &["V0101 the clamp"]);
    stated("\"stays\"").gives(ANY, CLEAN, &[]);
    stated("\"stay\"").gives(ANY, NONE, &["K0103 `tool_change`"]);
}

#[test]
fn a_cycle_below_r_moves_sideways_or_rises_first() {
    let blocks = "T1 M6\nS9000 M3\nG43 H1 G0 X-4. Y0. Z20.\nZ1.\nG98 G81 X20. Y0. Z1. R6.\nG80";
    let scene = Scene::new(blocks).placed().obstacle([8.0, -3.0, -2.0], [10.0, 3.0, 3.0]);
    let scene = scene.on("3-axis", "name = ", "tool_change = \"stays\"\nname = ");
    scene.gives(
        ANY,
        FINDINGS,
        &["V0101 6 the clamp", "V0101 6 under cycle_below_r = \"sideways first\""],
    );
    scene.gives(LINUXCNC, CLEAN, &[]);
    scene.gives(HAAS, FINDINGS, &["V0101 6 the clamp"]);
    let found = scene.with_report(Default::default(), |report| {
        let under = report.findings().iter().filter_map(|finding| finding.under.clone());
        under.collect::<Vec<String>>()
    });
    let found = found.expect("a result");
    assert!(found.contains(&"under cycle_below_r = \"sideways first\"".to_owned()), "{found:?}");
}

/// Rapid traverse around the corner of a clamp: clear on the straight line, and not on some dog-leg.
#[test]
fn rapid_traverse_is_any_dog_leg_where_its_path_is_not_stated() {
    let blocks = "T1 M6\nS9000 M3\nG43 H1\nG0 X-10. Y-10. Z1.\nX10. Y10. Z1.\nG1 Y12.";
    let clamp = ([4.0, -9.0, -2.0], [9.0, -4.0, 5.0]);
    let scene = Scene::new(blocks).placed().obstacle(clamp.0, clamp.1).with("anyway = true");
    scene.gives(
        ANY,
        FINDINGS,
        &["V0101 6 the clamp", "V0101 6 at some rates of its axes", "V0101 6 `rapid`"],
    );
    scene.gives(FANUC, FINDINGS, &["V0101 6 the clamp"]);
    scene.gives(LINUXCNC, CLEAN, &[]);
    // With rates the path is one dog-leg: X and Y together, or X first.
    for (x, verdict) in [(10_000, CLEAN), (40_000, FINDINGS)] {
        let scene = Scene::new(blocks).placed().obstacle(clamp.0, clamp.1).with("anyway = true");
        scene.with_rates([x, 10_000, 10_000]).gives(ANY, verdict, &[]);
    }
    // Just above a plate, with a margin of the shank that the tip has not; and through it.
    for (z, verdict) in [("1.", CLEAN), ("-1.", FINDINGS)] {
        let text = format!("T1 M6\nS9000 M3\nG43 H1\nG0 X-60. Y-60. Z{z}\nX60. Y50. Z{z}\nG1 Y51.");
        let plate = Scene::new(&text).placed().obstacle([-55.0, -40.0, -9.0], [40.0, 40.0, 0.0]);
        let plate = plate.with("anyway = true\nallow = { shank = -5 }");
        plate.gives(FANUC, verdict, &[]);
    }
    // Away from the clamp all dog-legs are proved clear.
    let away = Scene::new(blocks).placed().obstacle([40.0, 40.0, 0.0], [45.0, 45.0, 9.0]);
    away.with("anyway = true").gives(ANY, CLEAN, &[]);
}

/// The gauge point of the spindle goes where the program says without G43.
#[test]
fn a_feed_without_a_length_offset_is_no_guess() {
    let blocks = "T1 M6\nS9000 M3\nG0 X-6. Y0. Z20.\nG1 X4. Z1.";
    let scene = Scene::new(blocks);
    scene.gives(LINUXCNC, NONE, &["V0307 5 G43", "V0307 5 G43"]);
    scene.gives(ANY, NONE, &["V0307 5 G43"]);
    // One of two tools has G43.
    let one = "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG49\nT3 M6\nS9000 M3\nG0 X-6. Y0. Z20.\nG1 X4.";
    let mut one = Scene::new(one);
    one.job += "[tool.3]\ntool = \"D2Ball\"\n";
    one.gives(LINUXCNC, NONE, &["V0407 9 T3"]);
    // The length of the tool applies without a word in native programs of Sinumerik, and not in ISO mode.
    scene.gives(SIEMENS, NONE, &["V0307 5 G43", "V0307 5 G43"]);
    scene.with("anyway = true").gives_natively(CLEAN, &[]);
    let named = Scene::new("G0 X-6. Y0. Z20.\nG1 X4. Z1.");
    named.gives(LINUXCNC, CLEAN, &["V0308 3"]);
}

/// The level to which a cycle returns without G98 or G99: R on LinuxCNC, the initial level elsewhere.
#[test]
fn a_cycle_without_a_return_level_returns_to_either() {
    let blocks = "G0 X-4. Y0. Z20.\nG81 X-4. Y0. Z1. R2.\nX4.\nG80\nG0 Z20.";
    let scene = Scene::new(blocks).obstacle([-1.0, -3.0, 0.5], [1.0, 3.0, 10.0]);
    scene.gives(ANY, FINDINGS, &["V0101 4 the clamp", "V0101 4 under cycle_return = \"plane R\""]);
    scene.gives(LINUXCNC, FINDINGS, &["V0101 4 the clamp"]);
    let stated = Scene::new(&blocks.replace("G81", "G98 G81"));
    let stated = stated.obstacle([-1.0, -3.0, 0.5], [1.0, 3.0, 10.0]);
    stated.gives(ANY, CLEAN, &[]);
}

/// The length offset after G28: off on Haas, so that the spindle comes down by the length of the tool.
#[test]
fn a_return_can_cancel_the_length_offset() {
    let blocks =
        "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nG91 G28 Z0.\nG90 G0 X0. Y0.\nZ49.5\nG1 X1.";
    let scene = Scene::new(blocks).placed().with("anyway = true");
    scene.gives(LINUXCNC, CLEAN, &[]);
    scene.gives(ANY, FINDINGS, &["V0101 8 under reference_return = \"cancels length\""]);
    scene.gives(HAAS, FINDINGS, &["V0101 8 0.5000 mm deep in the part"]);
}

/// Z under G53 is that of the gauge point, or of the tip on Siemens.
#[test]
fn under_g53_the_length_counts_or_not() {
    let blocks = "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nX0.\nG53 Z-399.5\nG1 X1.";
    let scene = Scene::new(blocks).placed().with("anyway = true");
    scene.gives(LINUXCNC, FINDINGS, &["V0101 6 right through the part"]);
    let scene = Scene::new(&blocks.replace("-399.5", "-350.5")).placed().with("anyway = true");
    scene.gives(LINUXCNC, FINDINGS, &["V0101 7 0.5000 mm deep in the part"]);
    let scene = Scene::new(&blocks.replace("-399.5", "-348.")).placed().with("anyway = true");
    scene.gives(LINUXCNC, CLEAN, &[]);
    let low = Scene::new(&blocks.replace("-399.5", "-300.")).placed().with("anyway = true");
    low.gives(LINUXCNC, CLEAN, &[]);
    low.gives(SIEMENS, CLEAN, &[]);
    let tip = Scene::new(&blocks.replace("-399.5", "-400.5")).placed().with("anyway = true");
    tip.gives(SIEMENS, FINDINGS, &["V0101 7 0.5000 mm deep in the part"]);
}

/// The path is that of each axis, or the straight line, where the machine's file has rates.
#[test]
fn rates_do_not_say_that_each_axis_moves_by_itself() {
    let blocks = "T1 M6\nS9000 M3\nG43 H1\nG0 X-10. Y-10. Z1.\nX10. Y10. Z1.\nG1 Y12.";
    let scene = Scene::new(blocks).placed().obstacle([3.0, 3.0, -2.0], [6.0, 6.0, 5.0]);
    let scene = scene.with_rates([40_000, 10_000, 10_000]).with("anyway = true");
    scene.gives(ANY, FINDINGS, &["V0101 6 the clamp", "V0101 6 under rapid = \"straight\""]);
    scene.gives(LINUXCNC, FINDINGS, &["V0101 6 the clamp"]);
    scene.gives(FANUC, CLEAN, &[]);
}

/// A tool change changes the length that counts without G43, and D0 ends it.
#[test]
fn the_length_that_counts_always_is_that_of_the_tool() {
    let start =
        "G21 G90 G54 S9000 M3 F100.\nT1 M6\nS9000 M3\nG0 X-6. Y0. Z20.\nG1 X4. Z1.\nG0 Z20.\n";
    let two = format!("{start}T2 M6\nS9000 M3\nG0 X-6. Y0. Z20.\nG1 Z0.5\nX0.\nM30\n");
    let mut scene = Scene::of(&two).placed().with("anyway = true");
    scene.job += "[tool.2]\ntool = \"D2Ball\"\nlength = 30\n";
    scene.gives_natively(CLEAN, &[]);
    scene.gives(LINUXCNC, FINDINGS, &[]);
    // Without a length, the spindle comes down by 50.
    let edge =
        Scene::of(&format!("{start}D0\nG0 Z49.\nX-3.\nM30\n")).placed().with("anyway = true");
    edge.gives_natively(FINDINGS, &["V0101 9 in rapid traverse"]);
    let edge = Scene::of(&format!("{start}D2\nG0 Z49.\nM30\n")).placed().with("anyway = true");
    edge.gives_natively(NONE, &["P0106 7 D1"]);
}

/// G98 returns to the initial level of a cycle, or to R where that level is below it.
#[test]
fn g98_returns_to_the_initial_level_wherever_it_is() {
    let blocks = "G0 X-4. Y0. Z20.\nZ1.\nG98 G81 X-4. Y0. Z0.5 R9.\nX4.\nG80\nG0 Z20.";
    let scene = Scene::new(blocks).obstacle([-1.0, -3.0, 2.5], [1.0, 3.0, 7.0]);
    let scene = scene.with("anyway = true");
    scene.gives(LINUXCNC, CLEAN, &[]);
    scene.gives(HAAS, FINDINGS, &["V0101 5 the clamp"]);
    scene.gives(
        ANY,
        FINDINGS,
        &["V0101 5 the clamp", "V0101 5 under cycle_below_r = \"sideways first\""],
    );
    // LinuxCNC goes from the initial level to a lower R, and then sideways.
    let lower =
        Scene::new("G0 X-4. Y0. Z20.\nZ1.\nG99 G81 X-4. Y0. Z0.5 R9.\nX4. R4.\nG80\nG0 Z20.");
    let lower = lower.obstacle([-1.0, -3.0, 2.5], [1.0, 3.0, 7.0]).with("anyway = true");
    lower.gives(LINUXCNC, FINDINGS, &["V0101 5 the clamp"]);
}

/// LinuxCNC moves on a straight line to the next hole of a series and to a level that is higher, others sideways first.
#[test]
fn a_series_of_cycles_rises_on_the_way_or_after_it() {
    let blocks = "G0 X-10. Y0. Z20.\nG99 G81 X-10. Y0. Z0.5 R2.\nG98 X10.\nG80\nG1 X11.";
    let scene =
        Scene::new(blocks).obstacle([4.0, -3.0, 0.5], [9.0, 3.0, 4.0]).with("anyway = true");
    scene.gives(LINUXCNC, CLEAN, &[]);
    scene.gives(HAAS, FINDINGS, &["V0101 4 the clamp"]);
    scene.gives(
        ANY,
        FINDINGS,
        &["V0101 4 the clamp", "V0101 4 under cycle_below_r = \"sideways first\""],
    );
}

/// A change to the tool in the spindle may leave Z where it is.
#[test]
fn a_change_to_the_same_tool_may_not_retract() {
    let blocks = "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nT1 M6\nS9000 M3\nG0 X6.";
    Scene::new(blocks).placed().gives(HAAS, NONE, &["V0403 8 `tool_change`"]);
}

#[test]
fn g43_without_h_takes_the_tool_or_the_last_h() {
    let text =
        "G21 G90 G54 S9000 M3 F100.\nT1 M6\nS9000 M3\nG43 G0 X-6. Y0. Z49.5\nX0.\nG1 X4.\nM30\n";
    let scene = Scene::of(text).placed().with("anyway = true");
    scene.gives(LINUXCNC, CLEAN, &[]);
    scene.gives(FANUC, FINDINGS, &["V0101 6 0.5000 mm deep in the part"]);
    scene.gives(ANY, FINDINGS, &["V0101 6 under length_register = \"last H\""]);
}

#[test]
fn a_shift_that_ends_without_axes_ends_or_stays() {
    let blocks = "G0 X-6. Y0. Z20.\nG92 Z60.\nG92.1\nG0 Z41.\nX6.\nG1 X5.";
    let scene =
        Scene::new(blocks).obstacle([-1.0, -3.0, 0.0], [1.0, 3.0, 8.0]).with("anyway = true");
    scene.gives(LINUXCNC, CLEAN, &[]);
    scene.gives(FANUC, FINDINGS, &["V0101 6 the clamp"]);
    scene.gives(ANY, FINDINGS, &["V0101 6 under preset_end = \"stays\""]);
}

/// A change of the length offset without Z moves nothing, or Z by the change: down by the length after G49.
#[test]
fn a_change_of_the_length_offset_moves_z_or_not() {
    let start = "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z45.\nX5.\n";
    for (change, unnamed) in [("G49\nX6.", FINDINGS), ("G43 H0\nX6.", NONE)] {
        let scene = Scene::new(&format!("{start}{change}\nG43 H1 Z45.\nG1 X5.")).placed();
        let scene = scene.obstacle([4.0, -2.0, -60.0], [8.0, 2.0, -1.0]).with("anyway = true");
        scene.gives(LINUXCNC, CLEAN, &[]);
        scene.gives(
            FANUC,
            FINDINGS,
            &["V0103 7 the clamp", "V0103 7 under length_change = \"moves Z\""],
        );
        // H0 takes the length of the tool on LinuxCNC.
        let words =
            if unnamed == FINDINGS { "V0103 7 length_change = \"moves Z\"" } else { "P0120 6 G49" };
        scene.gives(ANY, unnamed, &[words]);
    }
    let together = Scene::new(&format!("{start}G49 X6.\nG43 H1 Z45.\nG1 X5.")).placed();
    together.gives(FANUC, NONE, &["P0120 6 G49", "P0120 6 length_change"]);
    // Without an offset, and at the reference position, nothing changes.
    for blocks in [
        "G49\nT1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z45.",
        "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z45.\nG91 G28 Z0.\nG49\nG90",
    ] {
        let scene = Scene::new(blocks).placed().with("anyway = true");
        scene.gives(FANUC, CLEAN, &[]);
    }
    let pallet = Scene::new("G0 X-6. Y0. Z20.\nM50");
    pallet.gives(HAAS, NONE, &["P0115 3 M50"]);
    let one_block =
        Scene::of("G21 G90 G54 F100.\nT1 M6 S900 M3\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nM30\n");
    one_block.with("anyway = true").gives(LINUXCNC, CLEAN, &[]);
}

/// The repeats of a cycle are those after L, or after K; the other word says nothing.
#[test]
fn the_repeats_of_a_cycle_are_after_l_or_k() {
    let blocks = "G0 X-6. Y0. Z20.\nG99 G91 G81 X4. Z-0.2 R-18. L2\nG80 G90\nG0 Z20.";
    let scene = Scene::new(blocks).obstacle([1.0, -2.0, -1.0], [3.0, 2.0, 9.0]);
    scene.gives(HAAS, FINDINGS, &["V0103 3 the clamp"]);
    scene.gives(FANUC, FINDINGS, &["V0103 3 under cycle_repeats = \"L\""]);
    scene.gives(SIEMENS, CLEAN, &[]);
    scene.gives(ANY, FINDINGS, &["V0103 3 under cycle_repeats = \"L\""]);
    let scene =
        Scene::new(&blocks.replace("L2", "K2")).obstacle([1.0, -2.0, -1.0], [3.0, 2.0, 9.0]);
    scene.gives(FANUC, FINDINGS, &["V0103 3 the clamp"]);
    scene.gives(HAAS, CLEAN, &[]);
}

/// Where the part is on the machine is not known: only the way home is no part of the verdict.
#[test]
fn a_position_in_machine_coordinates_is_not_the_way_home() {
    let start = "T1 M6\nS9000 M3\nG43 H1 G0 X-6. Y0. Z20.\nG1 X4. Z1.\nG0 Z20.\n";
    for (way, verdict) in [
        ("G53 G0 Z0.", CLEAN),
        ("G53 G0 Z0.\nG53 G0 X-20. Y30.", CLEAN),
        ("G91 G28 Z0.", CLEAN),
        ("G53 G0 Z-150.", NONE),
        ("G53 G0 X-20. Y30.", NONE),
    ] {
        Scene::new(&format!("{start}{way}")).gives(LINUXCNC, verdict, &[]);
    }
}

/// The stock is cut along the straight path: any dog-leg has to be clear of its box.
#[test]
fn rapid_traverse_at_any_rates_is_clear_of_the_box_of_the_stock() {
    for (z, gaps) in [("20.", false), ("0.4", true)] {
        let text =
            format!("T1 M6\nS9000 M3\nG43 H1\nG0 X-60. Y-60. Z20.\nZ{z}\nX60. Y50.\nG0 Z20.");
        let mut scene = Scene::new(&text).placed().with("anyway = true");
        scene.job += "[stock]\nbox = [[-3, -3, -2], [3, 3, 0.5]]\nspacing = 0.5\n";
        assert_eq!(scene.check(FANUC).has("V0602"), gaps, "{z}");
        assert!(!scene.check(LINUXCNC).has("V0602"), "{z}");
    }
}
