//! Cycle times against closed forms, worked out by hand.

use std::f64::consts::PI;
use touchoff::Unit;
use touchoff_verify::gcode::{ControlRules, ControlSetup};
use touchoff_verify::machine::Machine;
use touchoff_verify::{CycleTime, MachineProgram, Program};

/// Rates of the axes in rapid traverse, in mm and degrees per minute.
const RATES: [(&str, f64); 5] =
    [("X", 30_000.0), ("Y", 20_000.0), ("Z", 10_000.0), ("A", 3_600.0), ("C", 7_200.0)];

/// Returns a machine of the library with rates.
fn with_rates(machine: &str) -> Machine {
    let mut text = Machine::file(machine).expect("a machine of the library").to_owned();
    for (letter, rate) in RATES {
        let line = format!("letter = \"{letter}\"\n");
        text = text.replace(&line, &format!("{line}rapid = {rate}\n"));
    }
    Machine::parse(&text, "rates.toml").expect("a machine")
}

/// Returns the times of a program under a control. The first three motions start where nobody knows: two in rapid traverse, and
/// that of the length offset.
fn times(machine: Machine, control: Option<&str>, blocks: &str) -> Vec<CycleTime> {
    let rules = control.map(|name| ControlRules::named(name).expect("a control"));
    let mut setup = ControlSetup {
        lengths: [(1, 80.0), (2, 60.0)].into(),
        rules: rules.unwrap_or_default(),
        ..ControlSetup::default()
    };
    setup.work_offsets[0] = Some([0.0, 0.0, -300.0, 0.0, 0.0, 0.0]);
    let text = format!(
        "G21 G90 G94 G54 G17\nT1 M6\nS600 M3\nG0 X0. Y0.\nG43 H1 Z10.\nG0 X0. Y0. Z10.\n{blocks}\nM30\n"
    );
    let program = MachineProgram::new("time.nc", text, machine, setup).expect("a program");
    program.check_complete().expect("all lines are read");
    program.summary().times.clone()
}

/// Returns the time of the one tool on three axes under the rules of LinuxCNC.
fn time(blocks: &str) -> CycleTime {
    let times = times(with_rates("3-axis"), Some("linuxcnc"), blocks);
    assert_eq!(times.len(), 1, "{times:?}");
    times[0]
}

/// Returns the time in rapid traverse at rates that are stated.
fn rapid(time: &CycleTime) -> f64 {
    time.rapid.expect("rates")
}

#[track_caller]
fn assert_near(seconds: f64, expected: f64) {
    assert!((seconds - expected).abs() < 1e-9 * expected.max(1.0), "{seconds} s, not {expected} s");
}

#[test]
fn lines_and_arcs_take_their_length_over_the_feed() {
    assert_near(time("").feed, 0.0);
    assert_near(time("G1 X100. F200.").feed, 30.0);
    // Along the diagonal of a box of 3 x 4 x 12.
    assert_near(time("G1 X3. Y4. Z-2. F60.").feed, 13.0);
    // 10 mm, half a circle of radius 10, and half a turn of a helix that falls by 3.
    assert_near(time("G1 X10. F600.\nG3 X-10. Y0. I-10. J0.").feed, 1.0 + PI);
    let helix = "G1 X10. F600.\nG3 X-10. Y0. Z7. I-10. J0.";
    assert_near(time(helix).feed, 1.0 + 0.1 * (10.0 * PI).hypot(3.0));
    // An inch at 10 inches a minute.
    assert_near(time("G20 G1 X1. F10.").feed, 6.0);
    assert_near(time("G91 G1 X1. F60.\nX1.\nX1.\nG90").feed, 3.0);
}

#[test]
fn feeds_by_time_and_per_turn_have_their_meaning() {
    assert_near(time("G93 G1 X50. F2.\nX60. F4.").feed, 45.0);
    // 600 turns a minute at 0.1 mm a turn.
    assert_near(time("G95 G1 X60. F0.1").feed, 60.0);
    assert_near(time("G95 G1 X60. F0.1\nS1200\nX0.").feed, 90.0);
    assert_near(time("G95 G1 X60. F0.1\nG94 G1 X0. F120.").feed, 90.0);
}

#[test]
fn rotary_axes_alone_turn_by_degrees() {
    let of = |blocks: &str| {
        let start = "G0 A0. C0.\n";
        let times =
            times(with_rates("A-C trunnion"), Some("linuxcnc"), &format!("{start}{blocks}"));
        times[0]
    };
    let before = of("");
    assert_near(of("G1 C90. F180.").feed, 30.0);
    assert_near(of("G1 A-30. C40. F100.").feed, 30.0);
    // Beside X, the feed is that of X.
    assert_near(of("G1 X10. C90. F60.").feed, 10.0);
    // An inch has no part in degrees.
    assert_near(of("G20 G1 C90. F180.").feed, 30.0);
    assert_near(rapid(&of("G0 A-60. C60.")) - rapid(&before), 1.0);
}

#[test]
fn the_slowest_axis_decides_in_rapid_traverse() {
    assert_near(rapid(&time("")), 0.0);
    // X takes 0.2 s, Y 0.3 s and Z 0.06 s.
    assert_near(rapid(&time("G0 X100. Y100. Z20.")), 0.3);
    assert_near(rapid(&time("G0 X100.\nY100.\nZ20.")), 0.56);
    // Down to R and up again, and the hole in between.
    let drilled = time("G98 G81 X0. Y0. Z-8. R2. F100.\nG80");
    assert_near(drilled.feed, 6.0);
    assert_near(rapid(&drilled), 0.006 * (8.0 + 18.0));
    assert_eq!(drilled.unknown, time("").unknown);

    // Without rates nobody knows.
    let machine = Machine::named("3-axis").expect("a machine of the library");
    let without = times(machine, Some("linuxcnc"), "G0 X100.\nG1 X0. F200.\nG0 Y5.");
    assert_near(without[0].feed, 30.0);
    assert_eq!(without[0].rapid, None);
    assert_eq!(without[0].first_unknown, Some(4));
    assert_eq!(without[0].unknown, time("").unknown + 3);
}

#[test]
fn dwells_are_in_the_unit_of_their_control() {
    let machine = || with_rates("3-axis");
    let before = time("").unknown;
    for (control, block, seconds) in [
        (Some("linuxcnc"), "G4 P2", Some(2.0)),
        (Some("linuxcnc"), "G4 P2.5", Some(2.5)),
        (Some("fanuc"), "G4 P500", Some(0.5)),
        (Some("haas"), "G4 P1.5", Some(1.5)),
        (Some("fanuc"), "G4 X2.", Some(2.0)),
        (Some("fanuc"), "G4 X2", None),
        (Some("siemens"), "G4 F3", Some(3.0)),
        (None, "G4 P2", None),
    ] {
        let dwelling = times(machine(), control, &format!("{block}\nG1 X100. F200."));
        assert_eq!(dwelling.len(), 1, "{dwelling:?}");
        let time = dwelling[0];
        assert_near(time.dwell, seconds.unwrap_or(0.0));
        assert_near(time.feed, 30.0);
        let plain = times(machine(), control, "G1 X100. F200.")[0];
        assert_eq!(time.unknown - plain.unknown, usize::from(seconds.is_none()), "{block}");
    }
    // The time at the bottom of a hole is not counted, and said.
    let drilled = time("G98 G82 X0. Y0. Z-8. R2. P1. F100.\nX5.\nG80");
    assert_eq!(drilled.unknown, before + 2);
}

#[test]
fn each_tool_has_its_time() {
    let blocks =
        "G1 X100. F200.\nG0 Z100.\nT2 M6\nS600 M3\nG43 H2 G0 X0. Y0. Z10.\nG1 X50. F100.\nG4 P4.";
    let times = times(with_rates("3-axis"), Some("linuxcnc"), blocks);
    let tools: Vec<_> = times.iter().map(|time| (time.tool, time.feed, time.dwell)).collect();
    assert_eq!(tools, [(Some(1), 30.0, 0.0), (Some(2), 30.0, 4.0)]);
    let said = times[1].to_string();
    assert!(said.starts_with("30.0 s in feed, ") && said.contains(", 4.0 s in dwells"), "{said}");
}

/// Feeds of Klartext along lines, arcs and the strokes of cycles; what F means otherwise is not known.
#[test]
fn klartext_has_its_feeds() {
    let of = |unit: &str, blocks: &str| {
        let mut setup = ControlSetup { lengths: [(1, 80.0)].into(), ..ControlSetup::default() };
        setup.work_offsets[0] = Some([0.0, 0.0, -300.0, 0.0, 0.0, 0.0]);
        let text = format!(
            "0 BEGIN PGM T {unit}\nTOOL CALL 1 Z S600 F600\nL X+0 Y+0 FMAX M3\nL Z+10 FMAX\n{blocks}\nM30\nEND PGM T {unit}\n"
        );
        let machine = with_rates("3-axis");
        let program = MachineProgram::new("time.h", text, machine, setup).expect("a program");
        program.check_complete().expect("all lines are read");
        let times = &program.summary().times;
        assert_eq!(times.len(), 1, "{times:?}");
        times[0]
    };
    let start = of("MM", "").unknown;
    let known = |blocks: &str| {
        let time = of("MM", blocks);
        assert_eq!(time.unknown, start, "{blocks}");
        time
    };
    assert_near(known("L X+100 F200").feed, 30.0);
    assert_near(known("L X+10 F AUTO\nCC X+0 Y+0\nC X-10 Y+0 DR+").feed, 1.0 + PI);
    // Down from 12 to 2 above the part; 8 mm at 100, the dwell, and up.
    let hole = |number: u32, more: &str| {
        format!(
            "CYCL DEF {number} HOLE ~\n Q200=+2 ~\n Q201=-8 ~\n Q206=+100 ~\n Q203=+0 ~\n Q204=+2 ~\n {more}\nCYCL CALL"
        )
    };
    let drilled = known(&hole(200, "Q202=+8 ~\n Q211=+0.5"));
    assert_near(drilled.feed, 6.0);
    assert_near(drilled.dwell, 0.5);
    assert_near(rapid(&drilled), 0.006 * (8.0 + 10.0));
    // The feed of CYCL CALL POS is that of the way to the position.
    let call = |feed: &str| {
        let hole = hole(200, "Q202=+8 ~\n Q211=+0").replace("CYCL CALL", "");
        format!("L X+100 F200\n{hole}\nCYCL CALL POS X+0 Y+0 Z+0 {feed}\nL X+100")
    };
    assert_near(known(&call("FMAX")).feed, 66.0);
    assert_near(known(&call("F100")).feed, 126.0);
    // Per turn, it is not known.
    let per_turn = of("MM", &call("FU0.1"));
    assert_near(per_turn.feed, 66.0);
    assert_eq!(per_turn.unknown, start + 1);
    assert_near(known(&hole(201, "Q208=+0")).feed, 12.0);
    assert_near(known(&hole(201, "Q208=+200")).feed, 9.0);
    assert_near(known(&format!("L X+100 F200\n{}\nL X+0", hole(201, "Q208=+200"))).feed, 69.0);
    for (unit, blocks, more) in [
        ("MM", "L X+100 FU0.1".to_owned(), 1),
        ("MM", "L X+10 F100\nRND R2 FU0.1\nL Y+10".to_owned(), 1),
        ("MM", "L X+10 F100 M109\nRND R2 F50\nL Y+10 M111".to_owned(), 2),
        ("MM", "L X+100 F200 M136\nL X+0 M137\nL X+100".to_owned(), 1),
        ("MM", "L X+100 F200 M109\nL X+0 M111".to_owned(), 1),
        ("MM", "L Z+9 F200 M103 F20".to_owned(), 1),
        ("MM", hole(207, "Q239=+1"), 2),
        ("MM", hole(200, "Q202=+8 ~\n Q210=+1"), 1),
        ("MM", "FUNCTION DWELL TIME10".to_owned(), 1),
        ("INCH", "L X+1 F20".to_owned(), 1),
    ] {
        assert_eq!(of(unit, &blocks).unknown, start + more, "{blocks}");
    }
}

/// Returns the time of the first tool of a program that is read to its end, on a machine with rates.
fn first_time(name: &str, text: String, setup: ControlSetup) -> CycleTime {
    let program = MachineProgram::new(name, text, with_rates("3-axis"), setup);
    let program = program.expect("a program");
    program.check_complete().expect("all lines are read");
    program.summary().times[0]
}

/// Two sides of a square of 10 mm, of which a corner of 2 mm takes 2 of each.
#[test]
fn corners_of_klartext_have_their_feed() {
    let of = |blocks: &str| {
        let setup = ControlSetup { lengths: [(1, 80.0)].into(), ..ControlSetup::default() };
        let text = format!(
            "0 BEGIN PGM T MM\nTOOL CALL 1 Z S600 F600\nL X+0 Y+0 Z+10 FMAX M3\n{blocks}\nM30\nEND PGM T MM\n"
        );
        first_time("corner.h", text, setup)
    };
    let start = of("").unknown;
    // Both lines at 100 mm/min, and the corner at its own feed.
    let lines = 60.0 * 16.0 / 100.0;
    for (corner, seconds) in [
        ("RND R2", 60.0 * PI / 100.0),
        ("RND R2 F50", 60.0 * PI / 50.0),
        ("RND R2 F AUTO", 60.0 * PI / 600.0),
        ("CHF 2 F50", 60.0 * 8.0_f64.sqrt() / 50.0),
    ] {
        let time = of(&format!("L X+10 F100\n{corner}\nL Y+10"));
        assert_near(time.feed, lines + seconds);
        assert_eq!(time.unknown, start, "{corner}");
    }
    // A feed of the corner beside one of the path that is not known.
    let time = of("L X+10 FU0.1\nRND R2 F50\nL Y+10");
    assert_near(time.feed, 60.0 * PI / 50.0);
    assert_eq!(time.unknown, start + 2);
}

/// The same corners by the words of Sinumerik.
#[test]
fn corners_of_sinumerik_have_their_feed() {
    let of = |blocks: &str| {
        let mut setup = ControlSetup {
            lengths: [(1, 80.0)].into(),
            rules: ControlRules::named("siemens").expect("a control"),
            ..ControlSetup::default()
        };
        setup.work_offsets[0] = Some([0.0, 0.0, -300.0, 0.0, 0.0, 0.0]);
        let text = format!(
            "DEF REAL DEPTH=0\nG71 G90 G94 G54 G17\nT1 M6\nD1\nS600 M3\nG0 X0 Y0 Z10\nG0 X0 Y0 Z10\n{blocks}\nM30\n"
        );
        first_time("corner.mpf", text, setup)
    };
    let start = of("").unknown;
    let (line, arc) = (60.0 / 100.0, 60.0 * PI);
    for (blocks, seconds) in [
        ("G1 X10 RND=2 F100\nY10", 16.0 * line + arc / 100.0),
        // For the corner of the block alone; without one it has no effect.
        ("G1 X10 RND=2 FRC=50 F100\nY10 RND=2\nX0", 22.0 * line + arc / 50.0 + arc / 100.0),
        ("G1 X10 FRC=50 F100\nY10 RND=2\nX0", 26.0 * line + arc / 100.0),
        ("G1 X10 CHR=2 FRC=50 F100\nY10", 16.0 * line + 60.0 * 8.0_f64.sqrt() / 50.0),
        (
            "G1 X10 CHF=2 FRC=50 F100\nY10",
            60.0 * (20.0 - 8.0_f64.sqrt()) / 100.0 + 60.0 * 2.0 / 50.0,
        ),
        // For all corners, until 0 gives them the feed of the path again. FRC goes before.
        ("FRCM=50\nG1 X10 RND=2 F100\nY10 RND=2\nX0", 22.0 * line + 2.0 * arc / 50.0),
        (
            "FRCM=50\nG1 X10 RND=2 F100\nY10 RND=2 FRCM=0\nX0",
            22.0 * line + arc / 50.0 + arc / 100.0,
        ),
        ("FRCM=50\nG1 X10 RND=2 FRC=25 F100\nY10 RND=2\nX0", 22.0 * line + arc / 25.0 + arc / 50.0),
        // Per turn, of which there are 600 a minute.
        ("G95 G1 X10 RND=2 FRC=0.1 F0.5\nY10", 60.0 * 16.0 / 300.0 + arc / 60.0),
    ] {
        let time = of(blocks);
        assert_near(time.feed, seconds);
        assert_eq!(time.unknown, start, "{blocks}");
    }
    for (blocks, seconds) in [
        // A modal feed has to be stated again in another mode.
        ("FRCM=50\nG95 G1 X10 RND=2 F0.5\nY10", 60.0 * 16.0 / 300.0),
        ("G1 X10 RND=2 FRC=0 F100\nY10", 16.0 * line),
    ] {
        let time = of(blocks);
        assert_near(time.feed, seconds);
        assert_eq!(time.unknown, start + 1, "{blocks}");
    }
}

/// Returns the times of a program in APT-CL, whose positions are in `unit` if it states none.
fn cl_times(text: &str, unit: Unit) -> Vec<CycleTime> {
    let machine = Machine::named("3-axis").expect("a machine of the library");
    let program = Program::parse(text, "time.cl", machine, &ControlSetup::default());
    program.expect("a program").cycle_times(unit)
}

/// Returns the time of the one tool of a program in mm, which begins where `FROM` says.
fn cl_time(statements: &str) -> CycleTime {
    let times = cl_times(&format!("UNITS/MM\nFROM/0,0,0\n{statements}\nFINI\n"), Unit::Inch);
    let [time] = times[..] else { panic!("{times:?}") };
    assert_eq!(time.rapid, None);
    time
}

#[test]
fn cutter_locations_take_their_length_over_fedrat() {
    let known = |statements: &str| {
        let time = cl_time(statements);
        assert_eq!((time.unknown, time.first_unknown), (0, None), "{statements}");
        time
    };
    assert_near(known("FEDRAT/200,MMPM\nGOTO/100,0,0").feed, 30.0);
    // Along the diagonal of a box of 3 x 4 x 12, and back while the axis turns.
    assert_near(known("FEDRAT/60,MMPM\nGOTO/3,4,-12").feed, 13.0);
    assert_near(known("FEDRAT/60,MMPM\nGOTO/3,4,-12\nGOTO/0,0,0,0,.6,.8").feed, 26.0);
    // The feed holds until the next one.
    assert_near(
        known("FEDRAT/60,MMPM\nGOTO/1,0,0\nGOTO/2,0,0\nFEDRAT/MMPM,120\nGOTO/4,0,0").feed,
        3.0,
    );
    // 254 mm at 10 inches a minute.
    assert_near(known("FEDRAT/10,IPM\nGOTO/254,0,0").feed, 60.0);
    // 600 turns a minute at 0.1 mm a turn, then 1200.
    let per_turn =
        "SPINDL/600,RPM,CLW\nFEDRAT/0.1,MMPR\nGOTO/60,0,0\nSPINDL/RPM,1200,CLW\nGOTO/0,0,0";
    assert_near(known(per_turn).feed, 90.0);
    // A position that is repeated.
    assert_near(known("FEDRAT/60,MMPM\nGOTO/1,0,0\nGOTO/1,0,0").feed, 1.0);
    // Delays of 2 s, and of 5 turns.
    let delays = known("SPINDL/600,RPM\nFEDRAT/60,MMPM\nGOTO/1,0,0\nDELAY/2\nDELAY/5,REV");
    assert_near(delays.dwell, 2.5);
    assert_near(delays.known(), 3.5);
}

/// Lines are counted from `UNITS` and `FROM`.
#[test]
fn what_cutter_locations_leave_open_is_counted_and_no_time() {
    for (statements, feed, unknown, line) in [
        // Rapid traverse, whose rates APT does not state.
        ("FEDRAT/60,MMPM\nGOTO/1,0,0\nRAPID\nGOTO/9,0,0\nGOTO/8,0,0", 2.0, 1, 6),
        // A feed that comes late, one without a unit, and one per turn without a speed.
        ("GOTO/5,0,0\nFEDRAT/60,MMPM\nGOTO/6,0,0", 1.0, 1, 3),
        ("FEDRAT/60,MMPM\nGOTO/1,0,0\nFEDRAT/50\nGOTO/2,0,0\nGOTO/3,0,0", 1.0, 2, 6),
        ("FEDRAT/60,MMPM\nGOTO/1,0,0\nFEDRAT/0.1,MMPR\nGOTO/2,0,0", 1.0, 1, 6),
        // A turn of the axis in place.
        ("FEDRAT/60,MMPM\nGOTO/1,0,0,0,0,1\nGOTO/1,0,0,0,.6,.8", 1.0, 1, 5),
        // A delay in turns of a spindle whose speed is not known, and one whose unit is not.
        ("FEDRAT/60,MMPM\nGOTO/1,0,0\nDELAY/5,REV\nDWELL/5", 1.0, 2, 5),
    ] {
        let time = cl_time(statements);
        assert_near(time.feed, feed);
        assert_near(time.dwell, 0.0);
        assert_eq!((time.unknown, time.first_unknown), (unknown, Some(line)), "{statements}");
    }
    // The way to a first position that the tool has to reach.
    let times = cl_times("FEDRAT/60,MMPM\nGOTO/5,0,0\nGOTO/6,0,0\nFINI\n", Unit::Millimetre);
    assert_eq!((times[0].unknown, times[0].first_unknown), (1, Some(2)));
    assert_near(times[0].feed, 1.0);
    // No feed at all, and tables of poses.
    assert!(cl_times("GOTO/5,0,0\nGOTO/6,0,0\nFINI\n", Unit::Millimetre).is_empty());
    assert!(cl_times("0,0,0,0,0,1\n6,0,0,0,0,1\n", Unit::Millimetre).is_empty());
}

#[test]
fn cutter_locations_have_a_time_per_tool_in_the_unit_of_the_part() {
    // An inch is 25.4 mm; the tool 3 comes twice, and each comes from where only the machine knows.
    let text = "LOADTL/3\nFEDRAT/10,IPM\nGOTO/0,0,0\nGOTO/1,0,0\nLOADTL/7\nGOTO/0,0,0\nGOTO/0,2,0\nDELAY/4\n\
                LOADTL/3\nGOTO/0,0,0\nGOTO/0,0,3\nFINI\n";
    let of = |unit: Unit| {
        let times = cl_times(text, unit);
        let tools: Vec<_> = times.iter().map(|time| (time.tool, time.unknown)).collect();
        assert_eq!(tools, [(Some(3), 2), (Some(7), 1)]);
        [times[0].feed, times[1].feed, times[1].dwell]
    };
    for (unit, expected) in
        [(Unit::Inch, [24.0, 12.0, 4.0]), (Unit::Millimetre, [24.0 / 25.4, 12.0 / 25.4, 4.0])]
    {
        for (seconds, expected) in of(unit).into_iter().zip(expected) {
            assert_near(seconds, expected);
        }
    }
    let said = cl_times(text, Unit::Inch)[1].to_string();
    assert_eq!(
        said,
        "12.0 s in feed, rapid traverse not known, as no rates are stated, 4.0 s in dwells; the time of 1 motions or dwells is not \
         known, the first in line 6"
    );
}
