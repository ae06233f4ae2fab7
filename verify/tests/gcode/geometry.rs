//! Positions and arcs against values that the tests know beforehand: they construct the geometry, and write the
//! program from it.

use crate::common::{assert_fault, is_fault};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f64::consts::{PI, TAU};
use touchoff_verify::gcode::{
    Choice, ControlRules, ControlSetup, LengthOffset, Plane, Position, Rotation, Rule, Step,
    StepPath, Tcp, WorkOffset, read,
};

fn at_zero() -> ControlSetup {
    ControlSetup {
        start: [Some(0.0); 6],
        work_offsets: [Some([0.0; 6]); 9],
        rules: ControlRules::default().with(Rule::Dialect, Choice::Rs274Ngc),
        ..ControlSetup::default()
    }
}

/// Executes a program as LinuxCNC does, and one with words of other controls as they do.
fn steps_of(program: &str, setup: &ControlSetup) -> Vec<Step> {
    let program = format!("{program}\nM30\n");
    let is_iso = ["G43.4", "G43.5", "G234", "G68", "M29"].iter().any(|word| program.contains(word));
    let mut setup = setup.clone();
    if is_iso {
        setup.rules = setup.rules.with(Rule::Dialect, Choice::Iso);
    }
    read(&program, &setup).unwrap_or_else(|error| panic!("{program}{error}")).0
}

fn ends(program: &str, setup: &ControlSetup) -> Vec<Position> {
    steps_of(program, setup).iter().map(|step| step.end).collect()
}

fn linear(position: Position) -> [Option<f64>; 3] {
    [position[0], position[1], position[2]]
}

#[track_caller]
fn assert_near(position: Position, expected: [f64; 3]) {
    for axis in 0..3 {
        let value =
            position[axis].unwrap_or_else(|| panic!("{position:?} is unknown, not {expected:?}"));
        assert!((value - expected[axis]).abs() < 1e-9, "{position:?} is not {expected:?}");
    }
}

/// Arcs of random centre, radius, start and sweep in all planes, in both units, written with I J K, absolute centres
/// and R.
#[test]
fn arcs_are_the_ones_that_were_written() {
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let mut uniform = || (random.next_u64() >> 11) as f64 / 2f64.powi(53);
    let mut worst = [0.0f64; 3];
    let count = 20_000;
    for index in 0..count {
        let (plane, word, letters, offsets) = [
            (Plane::Xy, "G17", ["X", "Y", "Z"], ["I", "J"]),
            (Plane::Zx, "G18", ["Z", "X", "Y"], ["K", "I"]),
            (Plane::Yz, "G19", ["Y", "Z", "X"], ["J", "K"]),
        ][index % 3];
        let (unit, unit_word) = [(1.0, "G21"), (25.4, "G20")][index / 3 % 2];
        let centre = [0, 1].map(|_| 200.0 * uniform() - 100.0);
        let radius = 1.0 + 50.0 * uniform();
        let begin = TAU * uniform();
        let is_full = index % 17 == 0;
        let sweep = if is_full { TAU } else { 0.02 + (TAU - 0.04) * uniform() };
        let clockwise = index % 2 == 0;
        let signed = if clockwise { -sweep } else { sweep };
        let at = |angle: f64| [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()];
        let start = at(begin);
        let end = if is_full { start } else { at(begin + signed) };
        let rise = 10.0 * uniform();
        let form = if is_full { index / 17 % 2 } else { index % 5 % 3 };
        // Near half a turn, R leaves the centre open to rounding.
        let form = if form == 2 && (sweep - PI).abs() < 0.2 { 0 } else { form };
        let number = |value: f64| format!("{:.12}", value / unit);
        let offset = |k: usize| match form {
            1 => number(centre[k]),
            _ => number(centre[k] - start[k]),
        };
        let shape = match form {
            2 if sweep > PI => format!("R{}", number(-radius)),
            2 => format!("R{}", number(radius)),
            _ => format!("{}{} {}{}", offsets[0], offset(0), offsets[1], offset(1)),
        };
        let mode = ["G91.1", "G90.1", ""][form];
        let motion = if clockwise { "G2" } else { "G3" };
        let turns = 1 + index % 4;
        let program = format!(
            "{unit_word} {word} {mode}\nG0 {}{} {}{} {}0\n{motion} F100 {}{} {}{} {}{} {shape} P{turns}",
            letters[0],
            number(start[0]),
            letters[1],
            number(start[1]),
            letters[2],
            letters[0],
            number(end[0]),
            letters[1],
            number(end[1]),
            letters[2],
            number(rise),
        );
        let steps = steps_of(&program, &at_zero());
        let step = &steps[1];
        let StepPath::Arc { plane: found, centre: found_centre, sweep: found_sweep } = step.path
        else {
            panic!("{program}\n{step:?}")
        };
        assert_eq!(found, plane);
        let [first, second] = plane.axes();
        let whole = signed + signed.signum() * TAU * (turns - 1) as f64;
        worst[0] = worst[0].max((found_centre[0] - centre[0]).hypot(found_centre[1] - centre[1]));
        worst[1] = worst[1].max((found_sweep - whole).abs());
        for (axis, wanted) in [(first, end[0]), (second, end[1]), (plane.normal(), rise)] {
            worst[2] = worst[2].max((step.end[axis].expect("a coordinate") - wanted).abs());
        }
    }
    println!(
        "{count} arcs: centre within {:.1e} mm, sweep {:.1e} rad, end {:.1e} mm",
        worst[0], worst[1], worst[2]
    );
    // Twelve digits are written; R amplifies their rounding by up to R over the distance of chord and centre.
    assert!(worst[0] < 1e-8 && worst[1] < 1e-8 && worst[2] < 1e-10, "{worst:?}");
}

#[test]
fn half_turns_by_radius_do_not_depend_on_the_last_digit() {
    for end in ["20", "20.000001", "20.001", "19.999999"] {
        let steps = steps_of(&format!("G0 X0 Y0\nG2 F1 X{end} Y0 R10"), &at_zero());
        let StepPath::Arc { centre, sweep, .. } = steps[1].path else { panic!("{steps:?}") };
        let end: f64 = end.parse().expect("a number");
        // An end that is short by d moves the centre by the root of R d.
        let distance = (10.0 * (20.0 - end).max(0.0)).sqrt();
        assert!(
            (centre[0] - 0.5 * end).abs() < 1e-9 && centre[1].abs() <= 1.01 * distance + 1e-9,
            "{centre:?}"
        );
        assert!((sweep + PI).abs() <= 0.21 * distance + 1e-9, "{sweep}");
    }
}

#[test]
fn inches_are_converted_once() {
    let setup =
        ControlSetup { rules: ControlRules::default().with(Rule::Unit, Choice::Inch), ..at_zero() };
    assert_eq!(
        linear(ends("G0 X0.1 Y1 Z-3.3", &setup)[0]),
        [Some(0.1 * 25.4), Some(25.4), Some(-3.3 * 25.4)]
    );
    let rules = setup.rules.with(Rule::Dialect, Choice::Sinumerik);
    let setup = ControlSetup { rules, ..at_zero() };
    assert_eq!(ends("G71 G0 X1\nG70 X1\nG710 X2", &setup).map_x(), [1.0, 25.4, 2.0].map(Some));
    let positions = ends("G20 G0 X1\nG21 G91 X1\nG20 X1", &at_zero());
    assert_eq!(positions.map_x(), [Some(25.4), Some(26.4), Some(26.4 + 25.4)]);
}

trait MapX {
    fn map_x(&self) -> Vec<Option<f64>>;
}

impl MapX for Vec<Position> {
    fn map_x(&self) -> Vec<Option<f64>> {
        self.iter().map(|position| position[0]).collect()
    }
}

/// G73 and G83 to G89 along Z, with the levels of G98 and G99; the levels are those of the definition of each cycle.
/// G91 after a cycle of G90 moves over the next holes, which keep their depth and R on Fanuc and Haas.
#[test]
fn a_cycle_of_g90_keeps_its_levels_under_g91() {
    let setup = |control: &str| ControlSetup {
        rules: match ControlRules::named(control).expect("a control") {
            // Fanuc has either, by its series.
            rules if control == "fanuc" => rules.with(Rule::CycleRepeats, Choice::RepeatsByK),
            rules => rules,
        },
        ..at_zero()
    };
    let first = "M3 S900\nG90 G0 Z9.\nG81 G99 X0 Y0 Z-3. R2. F100.\n";
    for (control, repeats) in [("fanuc", "K3"), ("haas", "L3")] {
        let short = format!("{first}G91 X10. {repeats}\nY-5.\nG90 X1. Y1.\nG80\nM30\n");
        let long = format!("{first}X10.\nX20.\nX30.\nY-5.\nX1. Y1.\nG80\nM30\n");
        let [short, long] = [short, long].map(|text| {
            let (steps, _) = read(&text, &setup(control)).unwrap_or_else(|e| panic!("{text}{e}"));
            steps.into_iter().map(|step| (step.rapid, step.end)).collect::<Vec<_>>()
        });
        assert_eq!(short, long, "{control}");
        for other in ["G91 X10. Z-5.", "G91 X10. R-5.", "G91 X1. Z-5. R0\nG90 X5."] {
            let text = format!("{first}{other}\nM30\n");
            let error = read(&text, &setup(control)).expect_err(other);
            assert!(is_fault(&error, "P0120 G90"), "{error}");
        }
    }
    let text = format!("{first}G91 X10.\nG80\nM30\n");
    let unnamed = ControlSetup { rules: ControlRules::default(), ..at_zero() };
    for setup in [setup("linuxcnc"), unnamed] {
        let error = read(&text, &setup).expect_err("levels");
        assert_fault(&text, &error, 4, "P0120 G81");
    }
}

/// Fanuc and Haas have cycles and G80 in a group of their own: the motion before a series holds after it, and for the variables of the
/// control during it. LinuxCNC, and whoever states no control, needs a motion word.
#[test]
fn a_series_leaves_the_motion_before_it() {
    let setup = |control: &str| ControlSetup {
        rules: ControlRules::named(control).expect("a control"),
        ..at_zero()
    };
    let executed = |text: &str, control: &str| {
        let text = format!("M3 S900\nG90 G17 G94 G54 {text}\nM30\n");
        let (steps, _) = read(&text, &setup(control)).unwrap_or_else(|e| panic!("{text}{e}"));
        steps.into_iter().map(|step| (step.rapid, step.end)).collect::<Vec<_>>()
    };
    let series = "G81 G99 X1. Z-3. R2. F100.\nX2.";
    for control in ["fanuc", "haas"] {
        for (short, long) in [
            (format!("G0 Z9.\n{series}\nG80\nZ15."), format!("G0 Z9.\n{series}\nG0 Z15.")),
            (format!("G1 Z9. F9.\n{series}\nG80\nZ15."), format!("G1 Z9. F9.\n{series}\nG1 Z15.")),
            // Jumps on #4001, during the series and after it.
            (
                format!(
                    "G0 Z9.\n{series}\nIF [#4001 EQ 0] GOTO 5\nX7.\nN5 G80\nIF [#4001 EQ 0] GOTO 6\nG0 Z50.\nN6 X3."
                ),
                format!("G0 Z9.\n{series}\nG0 X3."),
            ),
            // A full circle, once more.
            ("G1 F9.\nG3 X0 Y0 I-2.\nI-2.".to_owned(), "G1 F9.\nG3 X0 Y0 I-2.\nG3 I-2.".to_owned()),
        ] {
            assert_eq!(executed(&short, control), executed(&long, control), "{control}: {short}");
        }
    }
    for (control, text) in [
        ("linuxcnc", format!("G0 Z9.\n{series}\nG80\nZ15.")),
        ("fanuc", format!("{series}\nG80\nZ15.")),
        ("fanuc", format!("G1 F9.\nG3 X0 Y0 I-2.\n{series}\nG80\nZ15.")),
        ("haas", format!("G0 Z9.\n{series}\nG80 Z15.")),
    ] {
        let text = format!("M3 S900\nG90 G17 G94 G54 {text}\nM30\n");
        let error = read(&text, &setup(control)).expect_err("no motion word");
        assert!(is_fault(&error, "P0121"), "{text}{error}");
    }
    let tolerance = "G21 G90 G54 G17 G64 P0.01\nG0 X1\nM2\n";
    assert!(read(tolerance, &setup("linuxcnc")).is_ok());
    let error = read(tolerance, &setup("haas")).expect_err("P beside G54");
    assert!(is_fault(&error, "P0120 P beside G54"), "{error}");
}

#[test]
fn canned_cycles_stop_at_their_levels() {
    let levels = |program: &str| -> Vec<(f64, bool)> {
        let steps = steps_of(&format!("G0 X0 Y0 Z20\nF100 M29\n{program}"), &at_zero());
        steps[1..].iter().map(|step| (step.end[2].expect("a level"), step.rapid)).collect()
    };
    let (fast, slow) = (true, false);
    let g98 = [(20.0, fast), (2.0, fast), (-5.0, slow), (20.0, fast)];
    for cycle in ["G81", "G82 P1", "G86 P1", "G73 Q2"] {
        assert_eq!(levels(&format!("G98 {cycle} X1 Z-5 R2")), g98, "{cycle}");
        assert_eq!(levels(&format!("G99 {cycle} X1 Z-5 R2"))[3], (2.0, fast), "{cycle}");
    }
    for cycle in ["G84", "G74 P1", "G85", "G89 P1"] {
        let expected = [(20.0, fast), (2.0, fast), (-5.0, slow), (2.0, slow), (20.0, fast)];
        assert_eq!(levels(&format!("G98 {cycle} X1 Z-5 R2")), expected, "{cycle}");
    }
    let pecks = [
        (20.0, fast),
        (2.0, fast),
        (-1.0, slow),
        (2.0, fast),
        (-1.0, fast),
        (-4.0, slow),
        (2.0, fast),
        (-4.0, fast),
        (-5.0, slow),
        (20.0, fast),
    ];
    assert_eq!(levels("G98 G83 X1 Z-5 R2 Q3"), pecks);
    // A series keeps R and the depth, and its initial level under G98, to which it rises on the way.
    let series = levels("G99 G81 X1 Z-5 R2\nX2\nG98 X3\nG80\nG0 Z7");
    let expected = [
        (20.0, fast),
        (2.0, fast),
        (-5.0, slow),
        (2.0, fast),
        (2.0, fast),
        (-5.0, slow),
        (2.0, fast),
        (20.0, fast),
        (2.0, fast),
        (-5.0, slow),
        (20.0, fast),
        (7.0, fast),
    ];
    assert_eq!(series, expected);
    assert_eq!(
        ends("G0 X0 Y0 Z9\nG91 G99 G81 X2 Y1 R-4 Z-3 L3 F1", &at_zero())
            .last()
            .copied()
            .map(linear),
        Some([6.0, 3.0, 5.0].map(Some))
    );
}

#[test]
fn positions_that_only_the_machine_knows_are_unknown() {
    let unknown = ControlSetup::default();
    let steps = steps_of("G0 X1\nG91 Y1\nG90 Y2 Z3\nG2 I1 F1 Z4\nG28 Z5\nG0 X2", &unknown);
    let expected = [
        [Some(1.0), None, None],
        [Some(1.0), None, None],
        [Some(1.0), Some(2.0), Some(3.0)],
        [Some(1.0), Some(2.0), Some(4.0)],
        [Some(1.0), Some(2.0), Some(5.0)],
        [Some(1.0), Some(2.0), None],
        [Some(2.0), Some(2.0), None],
    ];
    for (step, expected) in steps.iter().zip(expected) {
        assert_eq!(linear(step.end), expected, "{step:?}");
    }
    assert_eq!(steps.len(), expected.len());
    // An axis whose end is unknown goes somewhere if it is commanded, and stays if not.
    assert!(steps[5].commanded[2]);
    assert!(!steps[6].commanded[2]);
    // An arc from an unknown start, a work offset that is not given, a length that is not given.
    assert_eq!(steps_of("G2 X1 Y1 R5 F1", &unknown)[0].path, StepPath::Undetermined);
    let steps = steps_of("G0 X1 Y1 Z1\nG55 X2\nG43 H1 X3", &unknown);
    assert_eq!(linear(steps[1].end), [Some(2.0), None, None]);
    assert_eq!(steps[1].state.work_offset, WorkOffset::Standard(2));
    let steps = steps_of("G0 X1 Y1 Z1\nG43 H1 X3\nG49 X4", &unknown);
    assert_eq!(linear(steps[1].end), [Some(3.0), Some(1.0), None]);
    assert_eq!(linear(steps[2].end), [Some(4.0), Some(1.0), None]);
    assert_eq!(steps[1].state.length, LengthOffset::On { register: 1, length: None });
}

/// The machine stands still while coordinates change, so its axes are where they were.
#[test]
fn changes_of_coordinates_do_not_move_the_machine() {
    let mut setup = at_zero();
    setup.work_offsets[0] = Some([10.0, 20.0, 30.0, 1.0, 2.0, 3.0]);
    setup.work_offsets[1] = Some([-5.0, 7.0, 11.0, 0.0, 0.0, 4.0]);
    setup.lengths.insert(4, 100.0);
    setup.home = [0.0, 0.0, 500.0, 0.0, 0.0, 0.0].map(Some);
    let changes = [
        "G55",
        "G43 H4",
        "G52 X1 Y2 Z3 C5",
        "G92 X7 Y8 Z9",
        "G68 X1 Y1 R30",
        "G10 L2 P1 X1 R15",
        "T4 M6\nG43",
        "G49",
    ];
    for change in changes {
        let program = format!("G0 X1 Y2 Z3 A4 B5 C6\n{change}\nG91 G0 A0");
        let steps = steps_of(&program, &setup);
        let machine = [0, 1].map(|index| steps[index].state.to_machine(steps[index].end));
        for axis in 0..6 {
            let [before, after] = machine.map(|position| position[axis].expect("a coordinate"));
            assert!((before - after).abs() < 1e-12, "{change}: {machine:?}");
        }
    }
    // Work offset, length and reference position: 500 - 30 - 100.
    let steps = steps_of("G43 H4 G0 X0 Y0 Z0\nG91 G28 Z0\nG90 G53 X3 Z450", &setup);
    assert_eq!(steps[0].state.to_machine(steps[0].end)[..3], [Some(10.0), Some(20.0), Some(130.0)]);
    assert_eq!(linear(steps[1].end), [Some(0.0), Some(0.0), Some(370.0)]);
    assert_eq!(linear(steps[2].end), [Some(-7.0), Some(0.0), Some(320.0)]);
    // A coordinate whose origin does not change stays known, whatever the origin is.
    let unknown = ControlSetup { rules: setup.rules, ..ControlSetup::default() };
    let steps = steps_of("G0 X1 Y2 Z3\nG10 L2 P1 X9\nA0", &unknown);
    assert_eq!(linear(steps[1].end), [None, Some(2.0), Some(3.0)]);
    // G92 gives the position its coordinates, and G92.1 takes them back.
    let positions = ends("G0 X5\nG92 X1\nX2\nG92.1\nG91 X0\nG90 G52 X10\nG91 X0", &at_zero());
    assert_eq!(positions.map_x(), [Some(5.0), Some(2.0), Some(6.0), Some(-4.0)]);
}

#[test]
fn tilted_planes_map_by_their_euler_angles() {
    // The plane of a cube's corner: 45 degrees about z, then the angle between the diagonal and z about the new x.
    let angle = (1.0f64 / 3.0f64.sqrt()).acos().to_degrees();
    let program = format!(
        "G68.2 X10 Y20 Z30 I45 J{angle:.13} K0\nG53.1\nG0 X0 Y0 Z0\nX0 Y0 Z3\nX2 Y0 Z0\nG69\nG0 X1 Y0"
    );
    let steps = steps_of(&program, &at_zero());
    assert_eq!(steps[0].path, StepPath::Align);
    assert_eq!(steps[0].end[3..], [None; 3]);
    let workpiece = |index: usize| steps[index].state.to_workpiece(steps[index].end);
    assert_near(workpiece(1), [10.0, 20.0, 30.0]);
    // z of the plane is (sin I sin J, -cos I sin J, cos J), so y is the negative component.
    let z = 1.0 / 3.0f64.sqrt();
    assert_near(workpiece(2), [10.0 + 3.0 * z, 20.0 - 3.0 * z, 30.0 + 3.0 * z]);
    let x = 2.0 * 0.5f64.sqrt();
    assert_near(workpiece(3), [10.0 + x, 20.0 + x, 30.0]);
    assert!(matches!(steps[3].state.rotation, Rotation::Tilted { aligned: true, .. }));
    // The tool stands along z of the plane, so its length takes effect there.
    let mut known = at_zero();
    known.lengths.insert(2, 60.0);
    let lengthened = steps_of(&program.replace("X2 Y0 Z0", "G43 H2 X1"), &known);
    assert_eq!(linear(lengthened[3].end), [1.0, 0.0, 3.0 - 60.0].map(Some));
    // The angles are the machine's, so X Y Z are lost with the plane.
    assert_eq!(linear(steps[4].end), [Some(1.0), Some(0.0), None]);
    assert_eq!(steps[4].state.rotation, Rotation::Off);

    let steps = steps_of("G68 X10 Y0 R90\nG0 X11 Y0 Z5\nG69\nG91 X0", &at_zero());
    assert_eq!(linear(steps[0].state.to_workpiece(steps[0].end)), [10.0, 1.0, 5.0].map(Some));
    assert_eq!(linear(steps[1].end), [10.0, 1.0, 5.0].map(Some));
}

#[test]
fn tool_centre_point_control() {
    let program = "T3 M6\nG0 X1 Y2 Z3 A0 B0 C0\nG43.4 H3\nG1 F100 X2 B30\nG49\nG0 Z50\n";
    let rules = ControlRules::default().with(Rule::Dialect, Choice::Rs274Ngc);
    let mut setup = ControlSetup { rules, ..ControlSetup::default() };
    setup.lengths.insert(3, 75.0);
    let steps = steps_of(program, &setup);
    // At zero of the rotary axes, only the length takes effect.
    assert_eq!(linear(steps[1].start), [Some(1.0), Some(2.0), Some(3.0 - 75.0)]);
    assert_eq!(steps[1].state.tcp, Tcp::Rotary);
    assert_eq!(steps[1].state.length, LengthOffset::On { register: 3, length: Some(75.0) });
    // Elsewhere the kinematics decide.
    assert_eq!(linear(steps[2].end), [None, None, Some(50.0)]);
    for (on, off) in
        [("TRAORI\nG54", "TRAFOOF\nG54"), ("M428", "M429"), ("G234 H3", "G49"), ("G43.4", "G49")]
    {
        let steps = steps_of(&format!("T3 M6\nG0 A0 B0 C0\n{on}\nG1 F1 X1 C5\n{off}\nX2"), &setup);
        let tcp = if on == "TRAORI\nG54" { Tcp::Transformation } else { Tcp::Rotary };
        assert_eq!([steps[1].state.tcp, steps[2].state.tcp], [tcp, Tcp::Off], "{on}");
    }
    // M428 keeps its kinematics under G43 and G49.
    let steps = steps_of("T3 M6\nG0 A0 B0 C0\nM428\nG43 H3\nG0 X1\nG49\nX2", &setup);
    assert_eq!([steps[1].state.tcp, steps[2].state.tcp], [Tcp::Rotary; 2]);

    let steps = steps_of("G43.5 H3\nG1 F1 X1 Y1 Z1\nX2 I3 K4\nX3\nI1\nG49\nX4", &setup);
    let vectors: Vec<_> = steps.iter().map(|step| step.tool_vector).collect();
    let tilted = Some([0.6, 0.0, 0.8]);
    assert_eq!(vectors, [None, tilted, tilted, Some([1.0, 0.0, 0.0]), None]);
    assert_eq!(steps[0].state.tcp, Tcp::Vector);
    assert_eq!(linear(steps[3].end), [3.0, 1.0, 1.0].map(Some));
}

#[test]
fn subprograms_are_repeated_and_keep_their_parameters() {
    let program =
        "O1000\n#100=2.\n#1=7.\nG90 G0 X0\nM98 P2000 L3\nX#1\nM30\nO2000\nG91 X#100\nM99\n";
    assert_eq!(ends(program, &at_zero()).map_x(), [0.0, 2.0, 4.0, 6.0, 13.0].map(Some));
    // The names and #1 to #30 of a subprogram of O-words are its own.
    let program = "(x) o<move> sub\n#1=5.\n#<d>=[#31*2]\nX[#1+#<d>]\no<move> endsub\n#1=1.\n#<d>=1.\n#31=10.\nG0 X0\n\
                   o<move> call\nX[#1+#<D>]";
    assert_eq!(ends(program, &at_zero()).map_x(), [0.0, 25.0, 2.0].map(Some));
}

#[test]
fn expressions_follow_the_rules_of_arithmetic() {
    for (expression, value) in [
        ("[1+2*3]", 7.0),
        ("[[1+2]*3]", 9.0),
        ("-[2-5]", 3.0),
        ("[8/4/2]", 1.0),
        ("[5-3-1]", 1.0),
        ("[-2*-3]", 6.0),
        ("SQRT[16]", 4.0),
        ("[ABS[-2.5]+.5]", 3.0),
        ("#[1+1]", 42.0),
        ("[#2/2.]", 21.0),
        ("[1 + SQRT[2] * 0]", 1.0),
        ("+3.", 3.0),
    ] {
        let program = format!("#2=42.\nG0X{expression}");
        assert_eq!(ends(&program, &at_zero()).map_x(), [Some(value)], "{expression}");
    }
    // An assignment takes effect after its block.
    assert_eq!(ends("#3=1.\nG0 X#3 #3=6.\nX#3", &at_zero()).map_x(), [Some(1.0), Some(6.0)]);
    let fanuc = ControlSetup {
        rules: ControlRules::default().with(Rule::Dialect, Choice::Iso),
        ..at_zero()
    };
    assert_eq!(ends("#3=1.+2.*3. (seven)\nG0 X#3", &fanuc).map_x(), [Some(7.0)]);
}
