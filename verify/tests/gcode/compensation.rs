//! Cutter compensation against geometry: closed forms, and distances of random contours, computed from the contours alone.

use crate::common::{assert_fault, is_fault};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f64::consts::{PI, SQRT_2, TAU};
use touchoff_verify::gcode::{
    Choice, CompensationFault, ControlRules, ControlSetup, GcodeError, GcodeFault, Plane, Rule,
    Step, StepPath, read,
};

type Point = [f64; 2];

/// Returns a number from 0 to 1.
fn uniform(random: &mut Pcg64Mcg) -> f64 {
    (random.next_u64() >> 11) as f64 / 2f64.powi(53)
}

/// A control that stands at the origin, with the radius offsets D1 = 2, D2 = -2, D3 = 0 and D4 = 0.5.
fn setup(corner: Choice, start: Choice) -> ControlSetup {
    let rules = ControlRules::default()
        .with(Rule::Dialect, Choice::Iso)
        .with(Rule::OutsideCorner, corner)
        .with(Rule::CompensationStart, start);
    ControlSetup {
        start: [Some(0.0); 6],
        work_offsets: [Some([0.0; 6]); 9],
        radius_offsets: [(1, 2.0), (2, -2.0), (3, 0.0), (4, 0.5)].into(),
        rules,
        ..ControlSetup::default()
    }
}

fn arcs() -> ControlSetup {
    setup(Choice::ArcCorner, Choice::NextMotion)
}

fn run(program: &str, setup: &ControlSetup) -> Result<Vec<Step>, GcodeError> {
    read(&format!("{program}\nM30\n"), setup).map(|(steps, _)| steps)
}

fn steps(program: &str, setup: &ControlSetup) -> Vec<Step> {
    run(program, setup).unwrap_or_else(|error| panic!("{program}\n{error}"))
}

fn xy(position: &[Option<f64>; 6]) -> Point {
    [0, 1].map(|axis| position[axis].expect("a coordinate"))
}

fn distance(first: Point, second: Point) -> f64 {
    (first[0] - second[0]).hypot(first[1] - second[1])
}

/// Asserts the ends of the steps in the plane.
#[track_caller]
fn assert_ends(program: &str, setup: &ControlSetup, expected: &[Point]) {
    let steps = steps(program, setup);
    let ends: Vec<Point> = steps.iter().map(|step| xy(&step.end)).collect();
    assert_eq!(ends.len(), expected.len(), "{program}\n{ends:?}");
    for (end, expected) in ends.iter().zip(expected) {
        assert!(distance(*end, *expected) < 1e-9, "{program}\n{ends:?}\nare not\n{expected:?}");
    }
    assert_joined(&steps);
}

/// Asserts that each step begins where the one before ends.
#[track_caller]
fn assert_joined(steps: &[Step]) {
    for pair in steps.windows(2) {
        assert_eq!(pair[0].end, pair[1].start, "{pair:?}");
    }
}

/// A square of 20 mm, clockwise from the middle of its left side, with the tool outside.
const SQUARE: &str = "G0 X-10 Y0 Z5\nG1 G41 D1 X0 F100\nY10\nX20\nY-10\nX0\nY0\nG40 X-10";

#[test]
fn a_square_from_outside() {
    let around = [[-10.0, 0.0], [-2.0, 0.0], [-2.0, 10.0], [0.0, 12.0], [20.0, 12.0], [22.0, 10.0]];
    let back =
        [[22.0, -10.0], [20.0, -12.0], [0.0, -12.0], [-2.0, -10.0], [-2.0, 0.0], [-10.0, 0.0]];
    assert_ends(SQUARE, &arcs(), &[around, back].concat());
    let corners = [[-10.0, 0.0], [-2.0, 0.0], [-2.0, 12.0], [22.0, 12.0], [22.0, -12.0]];
    let sharp = [&corners[..], &[[-2.0, -12.0], [-2.0, 0.0], [-10.0, 0.0]]].concat();
    let straight = setup(Choice::StraightCorner, Choice::NextMotion);
    assert_ends(SQUARE, &straight, &sharp);
    // A negative offset is that of the other side, on which the tool is inside.
    let inside = [[-10.0, 0.0], [2.0, 0.0], [2.0, 8.0], [18.0, 8.0], [18.0, -8.0], [2.0, -8.0]];
    let inside = [&inside[..], &[[2.0, 0.0], [-10.0, 0.0]]].concat();
    for program in [SQUARE.replace("D1", "D2"), SQUARE.replace("G41", "G42")] {
        assert_ends(&program, &arcs(), &inside);
        assert_ends(&program, &straight, &inside);
    }
    // The inserted arc belongs to the block after the corner, and the tool goes around it to the right.
    let steps = steps(SQUARE, &arcs());
    let StepPath::Arc { centre, sweep, plane: Plane::Xy } = steps[3].path else {
        panic!("{steps:?}")
    };
    assert_eq!((steps[2].line, steps[3].line, centre), (3, 4, [0.0, 10.0]));
    assert!((sweep + 0.5 * PI).abs() < 1e-12, "{sweep}");
}

/// A step of 3 mm between an outside and an inside corner. Straight on at the outside one, its path is as long as it is, whatever the
/// radius.
#[test]
fn a_short_motion_is_lengthened_by_its_outside_corner() {
    let with_radius = |radius: f64, mut setup: ControlSetup| {
        setup.radius_offsets = [(1, radius)].into();
        setup
    };
    let straight = || setup(Choice::StraightCorner, Choice::NextMotion);
    let down = "G0 X-40 Y-20 Z5\nG1 G41 D1 X-20 F100\nY0\nX2\nY-3\nX20\nG40 Y30";
    let up = "G0 X20 Y-40 Z5\nG1 G42 D1 Y-3 F100\nX2\nY0\nX-20\nY-20\nG40 X-50";
    for r in [0.5, 2.9, 3.0, 3.2, 5.0, 9.0, 17.5] {
        let corners = [[-20.0 - r, -20.0], [-20.0 - r, r], [2.0 + r, r], [2.0 + r, r - 3.0]];
        let mut expected = vec![[-40.0, -20.0]];
        expected.extend(corners);
        expected.extend([[20.0, r - 3.0], [20.0, 30.0]]);
        assert_ends(down, &with_radius(r, straight()), &expected);
        let mut expected = vec![[20.0, -40.0], [20.0, r - 3.0]];
        expected.extend(corners.iter().rev());
        expected.push([-50.0, -20.0]);
        assert_ends(up, &with_radius(r, straight()), &expected);
    }
    let refusal = |program: &str, setup: ControlSetup| {
        run(program, &setup).expect_err("a corner without room")
    };
    // The last motion has 18 mm and no outside corner. Arcs lengthen nothing.
    for (program, line) in [(down, 6), (up, 3)] {
        let error = refusal(program, with_radius(18.5, straight()));
        assert!(is_fault(&error, "P0409"), "{error}");
        let error = refusal(program, with_radius(5.0, arcs()));
        let before = if line == 6 { 5 } else { 3 };
        let fault = GcodeFault::Compensation(CompensationFault::NoRoom { line: before });
        assert_eq!(error.fault, fault, "{error}");
    }
    // Between two inside corners, the direction would turn round.
    let slot = "G0 X-40 Y-20 Z5\nG1 G41 D1 X-20 F100\nY0\nX2\nY-3\nX20\nY20\nG40 X60";
    assert_eq!(run(slot, &with_radius(5.0, straight())).expect("steps").len(), 8);
    let slot = slot.replace("X20\nY20", "X10\nY20");
    let error = refusal(&slot, with_radius(5.0, straight()));
    assert!(is_fault(&error, "P0409 line 6"), "{error}");
}

/// The tool follows the contour without an offset, as a program of its centre does.
#[test]
fn an_offset_of_zero_changes_nothing() {
    let plain = steps(&SQUARE.replace("G41 D1 ", "").replace("G40 ", ""), &arcs());
    for number in ["D3", "D0"] {
        let same = steps(&SQUARE.replace("D1", number), &arcs());
        assert_eq!(same, plain);
    }
    // Nothing leads back from it.
    for end in ["G40\nG0 Z9\nG28 Z9", "G40 G49\nT1 M6", "G40 G28 Z9"] {
        let program = SQUARE.replace("D1", "D3").replace("G40 X-10", end);
        assert_eq!(steps(&program, &arcs())[..7], plain[..7], "{program}");
    }
    let arc = SQUARE.replace("D1", "D3").replace("G40 X-10", "G40 G2 X5 R5");
    assert!(is_fault(&run(&arc, &arcs()).expect_err("an arc"), "P0406 G40"));
    let arc = SQUARE.replace("G1 G41 D1 X0", "G2 G41 D3 X0 R20");
    assert!(is_fault(&run(&arc, &arcs()).expect_err("an arc"), "P0404"));
}

#[test]
fn circles_and_slots() {
    // A hole of radius 10, and a boss, milled by full circles.
    for (side, radius) in [("G41", 8.0), ("G42", 12.0)] {
        let program = format!("G0 X10 Y-5\nG1 {side} D1 Y0 F100\nG3 I-10\nG1 G40 Y5");
        let found = steps(&program, &arcs());
        let StepPath::Arc { centre, sweep, .. } = found[2].path else { panic!("{found:?}") };
        assert_eq!((centre, sweep), ([0.0, 0.0], TAU), "{side}");
        for end in [found[2].start, found[2].end] {
            assert!(distance(xy(&end), [radius, 0.0]) < 1e-12, "{found:?}");
        }
    }
    // A slot of 30 by 10, counterclockwise with the tool inside.
    let slot = "G0 X0 Y0\nG1 G41 D1 Y-5 F100\nX10\nG3 Y5 J5\nG1 X-10\nG3 Y-5 J-5\nG1 X0\nG40 Y0";
    let expected =
        [[0.0, 0.0], [0.0, -3.0], [10.0, -3.0], [10.0, 3.0], [-10.0, 3.0], [-10.0, -3.0]];
    assert_ends(slot, &arcs(), &[&expected[..], &[[0.0, -3.0], [0.0, 0.0]]].concat());
    let helix = slot.replace("G3 Y5 J5", "G3 Y5 J5 Z-1");
    let steps = steps(&helix, &arcs());
    assert_eq!([steps[3].start[2], steps[3].end[2]], [Some(0.0), Some(-1.0)]);
    assert!(matches!(steps[3].path, StepPath::Arc { sweep, .. } if (sweep - PI).abs() < 1e-12));
}

/// The first and the last motion by the types of Fanuc: A and B, and LinuxCNC's. At the first contour point the tool turns by 45 degrees
/// away from its offset, by 135 degrees away, or by 90 degrees towards it.
#[test]
fn first_and_last_motions() {
    let root = 0.5f64.sqrt();
    let program = |next: &str| format!("G0 X-10 Y0\nG1 G41 D1 X0 F100\n{next}\nG40\nX100 Y0");
    let first = |next: &str, corner: Choice, start: Choice| -> Vec<Point> {
        let steps = steps(&program(next), &setup(corner, start));
        steps.iter().filter(|step| step.line <= 3).map(|step| xy(&step.end)).collect()
    };
    let near = |found: Vec<Point>, expected: &[Point]| {
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!(distance(*found, *expected) < 1e-9, "{found:?} is not {expected:?}");
        }
    };
    let (arc, straight) = (Choice::ArcCorner, Choice::StraightCorner);
    let (a, b, linuxcnc) = (Choice::NextMotion, Choice::OutsideCorners, Choice::EntryMotion);
    // The normal of the next motion is (root, root) at 45 degrees, and (root, -root) at 135.
    let (gentle, sharp, inside) = ("X40 Y-40", "X-40 Y-40", "X0 Y40");
    let begin = [-10.0, 0.0];
    let beside = [2.0 * root, 2.0 * root];
    let end = |next: Point| [next[0] + 40.0 * root * SQRT_2, next[1] - 40.0 * root * SQRT_2];
    near(first(gentle, straight, a), &[begin, beside, end(beside)]);
    let meeting = [2.0 * (PI / 8.0).tan(), 2.0];
    near(first(gentle, straight, b), &[begin, meeting, end(beside)]);
    near(first(gentle, arc, linuxcnc), &[begin, [0.0, 2.0], beside, end(beside)]);
    let beside = [2.0 * root, -2.0 * root];
    let last = [beside[0] - 40.0, beside[1] - 40.0];
    near(first(sharp, straight, a), &[begin, beside, last]);
    let before = [beside[0] + 2.0 * root, beside[1] + 2.0 * root];
    near(first(sharp, straight, b), &[begin, [2.0, 2.0], before, last]);
    // At an inside corner, types A and B are the same.
    for start in [a, b] {
        near(first(inside, straight, start), &[begin, [-2.0, 0.0], [-2.0, 40.0]]);
    }
    near(first(inside, straight, linuxcnc), &[begin, [-2.0, 2.0], [-2.0, 40.0]]);
    // The last motion is the first one backwards: type B goes around the outside corner before it.
    let out = "G0 X0 Y-40\nG1 G41 D1 Y-30 F100\nY0\nG40 X40 Y40";
    let last = |start: Choice| {
        let steps = steps(out, &setup(straight, start));
        steps.iter().skip(2).map(|step| xy(&step.end)).collect::<Vec<_>>()
    };
    near(last(a), &[[-2.0, 0.0], [40.0, 40.0]]);
    near(last(b), &[[-2.0, 2.0 * (PI / 8.0).tan()], [40.0, 40.0]]);
    // G40 in a block of its own ends compensation beside the last motion.
    let alone = out.replace("G40 X40", "G40\nX40");
    let alone = steps(&alone, &setup(straight, b));
    near(alone.iter().skip(2).map(|step| xy(&step.end)).collect(), &[[-2.0, 0.0], [40.0, 40.0]]);
}

/// Motions across the plane are where the tool stands between both motions in it.
#[test]
fn motions_across_the_plane() {
    let at = |program: &str, setup: &ControlSetup| -> Vec<[f64; 3]> {
        let steps = steps(program, setup);
        assert_joined(&steps);
        steps
            .iter()
            .skip(2)
            .map(|step| [0, 1, 2].map(|axis| step.end[axis].expect("known")))
            .collect()
    };
    let outside = "G0 X-10 Y0 Z5\nG1 G41 D1 X0 F100\nY10\nZ1\nX20\nG40 Y30";
    assert_eq!(
        at(outside, &arcs()),
        [
            [-2.0, 10.0, 5.0],
            [-2.0, 10.0, 1.0],
            [0.0, 12.0, 1.0],
            [20.0, 12.0, 1.0],
            [20.0, 30.0, 1.0]
        ]
    );
    let straight = setup(Choice::StraightCorner, Choice::NextMotion);
    let found = at(outside, &straight);
    assert_eq!(found[1], [-2.0, 12.0, 1.0]);
    let inside = outside.replace("G41", "G42");
    assert_eq!(at(&inside, &arcs())[..2], [[2.0, 8.0, 5.0], [2.0, 8.0, 1.0]]);
    // Before the first motion nothing is offset.
    let before = "G0 X-10 Y0 Z5\nG41 D1\nG1 Z1 F100\nX0\nY10\nG40 X-10";
    assert_eq!(steps(before, &arcs())[1].end[..3], [-10.0, 0.0, 1.0].map(Some));
    // After G40 in a block of its own, LinuxCNC leads back with the next motion, whatever that is.
    let rules = ControlRules::named("linuxcnc").expect("a control");
    let linuxcnc = ControlSetup { rules, ..arcs() };
    let back = "G0 X-10 Y0 Z5\nG1 G41.1 D4 X0 F100\nY10\nG40\nG0 Z9";
    assert_eq!(at(back, &linuxcnc).last(), Some(&[0.0, 10.0, 9.0]));
    let stays = "G0 X-10 Y0 Z5\nG1 G41.1 D4 X0 F100\nY10\nG40";
    assert_eq!(at(stays, &linuxcnc).last(), Some(&[-2.0, 10.0, 5.0]));
}

/// LinuxCNC begins with an arc that ends in the direction of the programmed one, and moves straight across outside corners in rapid
/// traverse. A turn of less than 0.05 radians is no corner.
#[test]
fn motions_of_linuxcnc() {
    let rules = ControlRules::named("linuxcnc").expect("a control");
    let linuxcnc = ControlSetup { rules, ..arcs() };
    // The centre (10, y) is as far from (0, 0) as from (10, 12).
    let found = steps("G0 X0 Y0\nG41.1 D4 G2 X10 Y10 I10 F100\nG1 X20\nG40 Y0", &linuxcnc);
    let StepPath::Arc { centre, sweep, .. } = found[1].path else { panic!("{found:?}") };
    let y = 44.0 / 24.0;
    assert!(
        distance(centre, [10.0, y]) < 1e-12 && distance(xy(&found[1].end), [10.0, 12.0]) < 1e-12
    );
    assert!((sweep + 0.5 * PI + (y / 10.0).atan()).abs() < 1e-12, "{sweep}");
    let rapid = "G0 X-10 Y0\nG41.1 D4 G1 X0 F100\nY10\nG0 X20\nG40 Y30";
    let ends = [[-10.0, 0.0], [-2.0, 2.0], [-2.0, 10.0], [0.0, 12.0], [20.0, 12.0], [20.0, 30.0]];
    assert_ends(rapid, &linuxcnc, &ends);
    assert_eq!(steps(rapid, &linuxcnc)[3].path, StepPath::Line);
    // 0.4 in 10 is 0.04 radians.
    let bent = "G0 X-10 Y0\nG41.1 D4 G1 X0 F100\nX10 Y-0.4\nG40\nX20";
    let normal = [0.4 / 10.0f64.hypot(0.4) * 2.0, 10.0 / 10.0f64.hypot(0.4) * 2.0];
    let end = [10.0 + normal[0], normal[1] - 0.4];
    assert_ends(bent, &linuxcnc, &[[-10.0, 0.0], [0.0, 2.0], end, [20.0, -0.4]]);
}

/// The planes permute the axes.
#[test]
fn compensation_in_three_planes() {
    let program = "G17\nG0 X-10 Y0 Z5\nG1 G41 D1 X0 F100\nY10\nG2 X10 Y20 I10 J0\nG1 X20 Z4\nY-10\nG3 X10 Y-20 I-10 J0\nG1 X0\nG40 Y-30";
    let plain = steps(program, &arcs());
    for (plane, letters, word) in [("G18", "ZXYKIJ", Plane::Zx), ("G19", "YZXJKI", Plane::Yz)] {
        let swapped: String = program
            .chars()
            .map(|c| match "XYZIJK".find(c) {
                Some(index) => char::from(letters.as_bytes()[index]),
                None => c,
            })
            .collect();
        let steps = steps(&swapped.replace("G17", plane), &arcs());
        assert_eq!(steps.len(), plain.len());
        let [first, second] = word.axes();
        for (step, plain) in steps.iter().zip(&plain) {
            let axes = [first, second, word.normal()];
            assert_eq!(axes.map(|axis| step.end[axis]), [0, 1, 2].map(|axis| plain.end[axis]));
            match (step.path, plain.path) {
                (StepPath::Line, StepPath::Line) => {}
                (
                    StepPath::Arc { plane, centre, sweep },
                    StepPath::Arc { centre: plain_centre, sweep: plain_sweep, .. },
                ) => assert_eq!((plane, centre, sweep), (word, plain_centre, plain_sweep)),
                _ => panic!("{step:?} is not {plain:?}"),
            }
        }
    }
}

/// Radii by control: a D number, the number of a tool, and a diameter in the unit of the program.
#[test]
fn radii_by_control() {
    let first_offset = |control: &str, program: &str| {
        let mut rules = ControlRules::named(control).expect("a control");
        for rule in [Rule::CompensationStart, Rule::ToolLength, Rule::LengthChange] {
            let choice = rules.get(rule).or(rule.choices().next()).expect("a choice");
            rules = rules.with(rule, choice);
        }
        let setup = ControlSetup { rules, tool_change: Some([None; 6]), ..arcs() };
        let begin = if control == "heidenhain" { "G71" } else { "G21 G54" };
        let program =
            format!("{begin} T4\nM6\nG0 X-10. Y0.\n{program} G1 X0. F100.\nY10.\nG40 X-10.");
        run(&program, &setup).map(|steps| xy(&steps[1].end)[0])
    };
    for (control, words, expected) in [
        ("fanuc", "G41 D1", -2.0),
        ("haas", "G41 D4", -0.5),
        ("fanuc", "D1\nG41", -2.0),
        ("linuxcnc", "G41 D1", -2.0),
        ("linuxcnc", "G42 D2", -2.0),
        ("linuxcnc", "G41", -0.5),
        ("linuxcnc", "G41 D0", -0.5),
        ("linuxcnc", "G41.1 D3", -1.5),
        ("linuxcnc", "G20 G41.1 D0.1", -1.27),
        ("siemens", "G41", -0.5),
        ("siemens", "G41 D1", -0.5),
        ("heidenhain", "G42", 0.5),
    ] {
        match first_offset(control, words) {
            Ok(found) => assert!((found - expected).abs() < 1e-9, "{control} {words}: {found}"),
            Err(error) => panic!("{control} {words}: {error}"),
        }
    }
}

#[test]
fn what_cannot_be_followed_is_refused_with_its_line() {
    let begin = "G0 X-10 Y0 Z5\nG1 G41 D1 X0 F100\nY10\n";
    let named = |control: &str| {
        let rules = ControlRules::named(control).expect("a control");
        let rules = rules.with(Rule::CompensationStart, Choice::NextMotion);
        ControlSetup { rules: rules.with(Rule::WholeNumbers, Choice::Units), ..arcs() }
    };
    let unknown = ControlSetup { start: [None; 6], ..arcs() };
    let straight = setup(Choice::StraightCorner, Choice::NextMotion);
    for (program, setup, line, message) in [
        ("G41 X10", arcs(), 1, "P0119 G41"),
        ("G41 D9 X10", arcs(), 1, "P0401 radius offset 9"),
        ("G0 G41 D1 X10\nX20", unknown, 1, "P0402"),
        ("G0 G41 D1 X1\nX20", arcs(), 1, "P0403 radius offset 2"),
        ("G0 G41 D1 X0\nX20", arcs(), 1, "P0403"),
        ("G0 X1\nG41 D1 G2 X9 R5 F9", arcs(), 2, "P0404"),
        ("G18\nG91.1 G41.1 D4 X9", arcs(), 2, "P0115 G91.1"),
        ("G41.1 D4 X9", arcs(), 1, "P0115 by a diameter on LinuxCNC"),
        ("G41.2 D4 X9", arcs(), 1, "P0115 G41.2"),
        ("G42.4 D4 X9", arcs(), 1, "P0115 G42.4"),
        ("G141 D4 X9", arcs(), 1, "P0115 G141"),
        ("CUT3DC", arcs(), 1, "P0115 CUT3DC"),
        ("G450", arcs(), 1, "P0115 G450"),
        ("G81 X1 Z-1 R1 F1\nG41 D1", arcs(), 2, "P0120 G41"),
        ("G43.4 H1\nG41 D1", arcs(), 2, "P0120 G41"),
        ("G68.2 X0 Y0 Z0 I0 J30 K0\nG41 D1", arcs(), 2, "P0120 G53.1"),
        ("G19 G41 D4 X9", named("linuxcnc"), 1, "P0120 G41"),
        ("G0 G41.1 X9", named("linuxcnc"), 1, "P0119 G41.1"),
        ("G0 G41.1 D4 X2", named("linuxcnc"), 1, "P0403 radius offset 2"),
        ("G41.1 D4\nG0 Z9", named("linuxcnc"), 2, "P0403 radius offset 2"),
        ("G0 X1 D4", named("linuxcnc"), 1, "P0118 D"),
        ("G41 D-1", named("linuxcnc"), 1, "P0106 D-1"),
        ("BEGIN\nG42 X1 Y20", arcs(), 4, "P0120 G42"),
        ("BEGIN\nG41 D4 X1 Y20", arcs(), 4, "P0120 G41"),
        ("BEGIN\nD4", arcs(), 4, "P0120 D4"),
        ("BEGIN\nG18", arcs(), 4, "P0120 another plane while"),
        ("BEGIN\nG20", setup(Choice::ArcCorner, Choice::NextMotion), 4, "P0120 G20"),
        ("BEGIN\nG55", arcs(), 4, "P0120 G55"),
        ("BEGIN\nG43 H1", arcs(), 4, "P0120 G43"),
        ("BEGIN\nG53 G0 Z0", arcs(), 4, "P0120 G53"),
        ("BEGIN\nG28 Z5", arcs(), 4, "P0120 G28"),
        ("BEGIN\nG52 X1", arcs(), 4, "P0120 G52"),
        ("BEGIN\nG68 X0 Y0 R5", arcs(), 4, "P0120 G68"),
        ("BEGIN\nT1 M6", arcs(), 4, "P0120 M6"),
        ("BEGIN\nG81 X1 Z-1 R1 F1", arcs(), 4, "P0120 G81"),
        ("BEGIN\nC5", arcs(), 4, "P0120 C"),
        ("BEGIN\nM0", arcs(), 4, "P0120 M0"),
        ("BEGIN", arcs(), 4, "P0120 the end of the program while cutter compensation is in force"),
        ("BEGIN\nG40 G2 X5 Y15 R5", arcs(), 4, "P0406 G40"),
        ("BEGIN\nG40\nG0 Z9", arcs(), 5, "P0407 a motion across the plane follows G40"),
        ("BEGIN\nG40\nG28 Z9", arcs(), 5, "P0120 G28"),
        ("BEGIN\nM8\nM9\nX9\nG40 X20", arcs(), 6, "P0411 2 blocks"),
        ("BEGIN\nX0 Z1\nX9\nG40 X20", arcs(), 5, "P0411 2 blocks"),
        ("BEGIN\nG91 X0.\nG90 X9\nG40 X20", arcs(), 5, "P0411 2 blocks"),
        ("BEGIN\nG0 X9\nG40 X20", arcs(), 4, "P0120 G0"),
        ("BEGIN\nZ1\nX9 Y0\nG40 X20", straight, 5, "P0410"),
        ("T4\nG0 X-10 Y0\nG1 G41 X0 F100\nY10\nT5", named("heidenhain"), 5, "P0120 T"),
        // Inside corners and arcs.
        ("BEGIN\nX-9\nG3 X-11 Y8 J-2\nG1 X-20", arcs(), 5, "P0408"),
        ("BEGIN\nX-1\nY20\nG40 X9", arcs(), 4, "P0409 line 3"),
        ("BEGIN\nX-3\nY0\nG40 X9", arcs(), 5, "P0409 line 4"),
    ] {
        let program = program.replace("BEGIN\n", begin).replace("BEGIN", begin.trim_end());
        let error = run(&program, &setup).expect_err(&program);
        assert_fault(&program, &error, line, message);
    }
}

/// A motion of a contour: a line, or an arc by its centre and its sweep.
#[derive(Clone, Copy, Debug)]
struct Motion {
    start: Point,
    end: Point,
    arc: Option<(Point, f64)>,
}

impl Motion {
    /// Returns the point at a fraction of the motion.
    fn at(&self, fraction: f64) -> Point {
        let [start, end] = [self.start, self.end];
        match self.arc {
            None => [0, 1].map(|k| start[k] + fraction * (end[k] - start[k])),
            Some((centre, sweep)) => {
                let angle = (start[1] - centre[1]).atan2(start[0] - centre[0]) + fraction * sweep;
                let radius = distance(start, centre);
                [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()]
            }
        }
    }

    /// Returns the distance of a point.
    fn distance(&self, point: Point) -> f64 {
        let ends = distance(point, self.start).min(distance(point, self.end));
        match self.arc {
            None => {
                let way = [0, 1].map(|k| self.end[k] - self.start[k]);
                let from = [0, 1].map(|k| point[k] - self.start[k]);
                let length = way[0].hypot(way[1]);
                let along = (way[0] * from[0] + way[1] * from[1]) / length;
                let across = (way[0] * from[1] - way[1] * from[0]).abs() / length;
                if (0.0..=length).contains(&along) { across } else { ends }
            }
            Some((centre, sweep)) => {
                let angle = |point: Point| (point[1] - centre[1]).atan2(point[0] - centre[0]);
                let turn = (angle(point) - angle(self.start)) * sweep.signum();
                match turn.rem_euclid(TAU) <= sweep.abs() {
                    true => (distance(point, centre) - distance(self.start, centre)).abs(),
                    false => ends,
                }
            }
        }
    }

    fn of(step: &Step) -> Motion {
        let arc = match step.path {
            StepPath::Arc { centre, sweep, .. } => Some((centre, sweep)),
            _ => None,
        };
        Motion { start: xy(&step.start), end: xy(&step.end), arc }
    }
}

/// A closed contour about the origin, counterclockwise from the middle of a line, which it ends with.
fn contour(random: &mut Pcg64Mcg) -> Vec<Motion> {
    let count = 4 + (5.0 * uniform(random)) as usize;
    let corners: Vec<Point> = (0..count)
        .map(|k| {
            let angle = TAU * (k as f64 + 0.5 * uniform(random)) / count as f64;
            let radius = 25.0 + 30.0 * uniform(random);
            [radius * angle.cos(), radius * angle.sin()]
        })
        .collect();
    let middle = [0, 1].map(|k| 0.5 * (corners[count - 1][k] + corners[0][k]));
    let mut motions = vec![Motion { start: middle, end: corners[0], arc: None }];
    for pair in corners.windows(2) {
        let [start, end] = [pair[0], pair[1]];
        let arc = (uniform(random) < 0.5).then(|| {
            // The sagitta is up to an eighth of the chord, to either side.
            let sweep = (2.0 * uniform(random) - 1.0) * 0.98;
            let chord = [0, 1].map(|k| end[k] - start[k]);
            let height = 0.5 / (0.5 * sweep).tan();
            let centre = [
                0.5 * (start[0] + end[0]) - height * chord[1],
                0.5 * (start[1] + end[1]) + height * chord[0],
            ];
            (centre, sweep)
        });
        motions.push(Motion { start, end, arc: arc.filter(|(_, sweep)| sweep.abs() > 0.05) });
    }
    motions.push(Motion { start: corners[count - 1], end: middle, arc: None });
    motions
}

/// Returns whether motions that are no neighbours come so near to each other that the tool does not fit between them.
fn is_narrow(motions: &[Motion], radius: f64) -> bool {
    // The first and the last motion are halves of one line.
    let (last, halves) = (motions.len() - 1, [motions[0], motions[motions.len() - 1]]);
    let line = Motion { start: halves[1].start, end: halves[0].end, arc: None };
    let mut sides = vec![line];
    sides.extend(&motions[1..last]);
    let count = sides.len();
    let pairs = (0..count).flat_map(|first| (0..count).map(move |second| (first, second)));
    let mut apart =
        pairs.filter(|(first, second)| (2..=count - 2).contains(&first.abs_diff(*second)));
    apart.any(|(first, second)| {
        let mut places = (0..=50).map(|k| sides[first].at(f64::from(k) / 50.0));
        places.any(|place| sides[second].distance(place) < 2.0 * radius + 2.0)
    })
}

fn write(motions: &[Motion], side: &str, offset: f64) -> String {
    write_with(motions, side, offset, 13)
}

/// Writes a program of a contour, with an offset to the left and so many decimals.
fn write_with(motions: &[Motion], side: &str, offset: f64, decimals: usize) -> String {
    let first = motions[0];
    // The normal to the left of the first line, on which the tool begins and ends.
    let length = distance(first.start, first.end);
    let normal = [first.start[1] - first.end[1], first.end[0] - first.start[0]];
    let lead = [0, 1].map(|k| first.start[k] + normal[k] / length * 3.0 * offset);
    let word = |letter: char, value: f64| format!("{letter}{value:.decimals$} ");
    let place = |point: Point| word('X', point[0]) + &word('Y', point[1]);
    let mut text = format!("G0 {}Z0\nG1 {side} D7 {}F100\n", place(lead), place(first.start));
    for motion in motions {
        text += &match motion.arc {
            None => format!("G1 {}\n", place(motion.end)),
            Some((centre, sweep)) => format!(
                "{} {}{}{}\n",
                if sweep > 0.0 { "G3" } else { "G2" },
                place(motion.end),
                word('I', centre[0] - motion.start[0]),
                word('J', centre[1] - motion.start[1]),
            ),
        };
    }
    text + &format!("G1 G40 {}", place(lead))
}

/// Returns the number of turns of a contour about a point.
fn winding(motions: &[Motion], point: Point) -> f64 {
    let angle = |place: Point| (place[1] - point[1]).atan2(place[0] - point[0]);
    let turns = motions.iter().flat_map(|motion| {
        (0..64).map(move |k| {
            let [from, to] = [k, k + 1].map(|k| motion.at(f64::from(k) / 64.0));
            let turn = angle(to) - angle(from);
            turn - TAU * (turn / TAU).round()
        })
    });
    turns.sum::<f64>() / TAU
}

/// Random contours of lines and arcs, on both sides and with both forms of outside corners: the tool's centre is never nearer to the
/// contour than its radius, on the right side, and on every motion as near as that.
#[test]
fn random_contours_are_followed_at_the_radius() {
    let mut random = Pcg64Mcg::seed_from_u64(3);
    let (mut followed, mut samples, mut touched, mut motions_seen) = (0, 0, 0, 0);
    let mut worst = [0.0f64; 2];
    while followed < 2_000 {
        let radius = 0.5 + 4.0 * uniform(&mut random);
        let motions = contour(&mut random);
        if is_narrow(&motions, radius) {
            continue;
        }
        let is_inside = uniform(&mut random) < 0.5;
        let corner = [Choice::ArcCorner, Choice::StraightCorner][followed % 2];
        let mut setup = setup(corner, Choice::NextMotion);
        setup.radius_offsets = [(7, radius)].into();
        // Inside is left of a counterclockwise contour.
        let (side, lead) = if is_inside { ("G41", radius) } else { ("G42", -radius) };
        let program = write(&motions, side, lead);
        let steps = steps(&program, &setup);
        followed += 1;
        assert_joined(&steps);
        let path: Vec<Motion> = steps[2..steps.len() - 1].iter().map(Motion::of).collect();
        for motion in &path {
            if let Some((centre, _)) = motion.arc {
                assert!(
                    (distance(motion.start, centre) - distance(motion.end, centre)).abs() < 1e-9
                );
                assert!(distance(motion.at(1.0), motion.end) < 1e-9, "{motion:?}");
            }
            for k in 0..=24 {
                let place = motion.at(f64::from(k) / 24.0);
                let found =
                    motions.iter().map(|motion| motion.distance(place)).fold(f64::MAX, f64::min);
                worst[0] = worst[0].max(radius - found);
                let farthest = if corner == Choice::ArcCorner { radius } else { SQRT_2 * radius };
                worst[1] = worst[1].max(found - farthest);
                samples += 1;
            }
            let turns = winding(&motions, motion.at(0.5));
            assert!((turns - f64::from(is_inside)).abs() < 1e-6, "{program}\n{motion:?}");
        }
        // The tool touches each motion, but one of which its corners leave nothing at the middle.
        for motion in &motions {
            let middle = motion.at(0.5);
            let found = path.iter().map(|step| step.distance(middle)).fold(f64::MAX, f64::min);
            worst[0] = worst[0].max(radius - found);
            touched += usize::from((found - radius).abs() < 1e-9);
            motions_seen += 1;
        }
    }
    println!(
        "{followed} contours: {samples} places are at most {:.1e} mm nearer than the radius, {:.1e} mm farther than \
         allowed; {touched} of {motions_seen} motions are touched at their middle",
        worst[0], worst[1]
    );
    assert!(worst[0] < 1e-9 && worst[1] < 1e-9, "{worst:?}");
    assert!(touched * 10 > motions_seen * 9);
}

/// Rectangles with rounded corners, turned and written with three decimals, so that no transition is quite tangent: all are followed, and
/// the tool's centre is as far from the exact contour as its radius, but for that rounding.
#[test]
fn rounded_numbers_bend_no_tangent_corner() {
    let mut random = Pcg64Mcg::seed_from_u64(9);
    let mut worst = 0.0f64;
    for index in 0..2_000 {
        let fillet = 2.0 + 8.0 * uniform(&mut random);
        let half = [0, 1].map(|_| fillet + 3.0 + 20.0 * uniform(&mut random));
        let angle = TAU * uniform(&mut random);
        let (sine, cosine) = angle.sin_cos();
        let turned = |[x, y]: Point| [cosine * x - sine * y, sine * x + cosine * y];
        let [a, b] = half;
        // Counterclockwise from the middle of the lower side.
        let corners = [[a, -b], [a, b], [-a, b], [-a, -b]];
        let mut motions = Vec::new();
        let mut place = [0.0, -b];
        for (corner, way) in
            corners.into_iter().zip([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
        {
            let next = [-way[1], way[0]];
            let start = [0, 1].map(|k| corner[k] - fillet * way[k]);
            let end = [0, 1].map(|k| corner[k] + fillet * next[k]);
            let centre = [0, 1].map(|k| start[k] + fillet * next[k]);
            motions.push(Motion { start: turned(place), end: turned(start), arc: None });
            let arc = Some((turned(centre), 0.5 * PI));
            motions.push(Motion { start: turned(start), end: turned(end), arc });
            place = end;
        }
        motions.push(Motion { start: turned(place), end: turned([0.0, -b]), arc: None });
        let is_inside = index % 2 == 0;
        let radius = if is_inside { fillet * (0.1 + 0.85 * uniform(&mut random)) } else { 5.0 };
        let (side, lead) = if is_inside { ("G41", radius) } else { ("G42", -radius) };
        let corner = [Choice::ArcCorner, Choice::StraightCorner][index / 2 % 2];
        let mut setup = setup(corner, Choice::NextMotion);
        setup.radius_offsets = [(7, radius)].into();
        let steps = steps(&write_with(&motions, side, lead, 3), &setup);
        for motion in steps[2..steps.len() - 1].iter().map(Motion::of) {
            for k in 0..=8 {
                let place = motion.at(f64::from(k) / 8.0);
                let found =
                    motions.iter().map(|motion| motion.distance(place)).fold(f64::MAX, f64::min);
                worst = worst.max((found - radius).abs());
            }
        }
    }
    println!("the tool is within {worst:.1e} mm of its radius");
    // Ends and centres are rounded by 0.0005 mm in each of two axes, and the radius by the sum of both.
    assert!(worst < 3e-3, "{worst}");
}

/// Random lines with turns to both sides, against the closed form of each corner. A corner towards the tool cuts r tan(turn / 2) off both
/// lines, and a program is refused at the first that has less left.
#[test]
fn random_lines_end_at_the_closed_form_of_their_corners() {
    let mut random = Pcg64Mcg::seed_from_u64(5);
    let (mut followed, mut refused, mut worst) = (0, 0, 0.0f64);
    for _ in 0..20_000 {
        let radius = 0.2 + 2.0 * uniform(&mut random);
        let count = 2 + (6.0 * uniform(&mut random)) as usize;
        let mut angles = vec![0.0];
        for _ in 1..count {
            // Turns of more than a millionth of a radian, and of less than 175 degrees.
            let turn = (2.0 * uniform(&mut random) - 1.0) * 175.0f64.to_radians();
            angles.push(angles[angles.len() - 1] + turn);
        }
        let lengths: Vec<f64> = (0..count).map(|_| 0.5 + 12.0 * uniform(&mut random)).collect();
        let mut places: Vec<Point> = vec![[0.0, 0.0]];
        for (angle, length) in angles.iter().zip(&lengths) {
            let [x, y] = places[places.len() - 1];
            places.push([x + length * angle.cos(), y + length * angle.sin()]);
        }
        let is_left = uniform(&mut random) < 0.5;
        let side = if is_left { 1.0 } else { -1.0 };
        let normal = |k: usize| [-side * angles[k].sin(), side * angles[k].cos()];
        let beside =
            |place: Point, k: usize| [0, 1].map(|axis| place[axis] + radius * normal(k)[axis]);
        // The ends of the steps from the first motion on, and the line at which a corner has no room.
        let mut expected = vec![beside(places[0], 0)];
        let (mut before, mut stops) = (0.0, None);
        for k in 0..count - 1 {
            let (place, turn) = (places[k + 1], angles[k + 1] - angles[k]);
            if side * turn < 0.0 {
                expected.extend([beside(place, k), beside(place, k + 1)]);
                before = 0.0;
                continue;
            }
            let cut = radius * (0.5 * turn.abs()).tan();
            if before + cut > lengths[k] || cut > lengths[k + 1] {
                stops = stops.or(Some(k + 4));
            }
            let bisector = [0, 1].map(|axis| normal(k)[axis] + normal(k + 1)[axis]);
            let scale = 2.0 * radius / (bisector[0] * bisector[0] + bisector[1] * bisector[1]);
            expected.push([0, 1].map(|axis| place[axis] + scale * bisector[axis]));
            before = cut;
        }
        expected.push(beside(places[count], count - 1));
        let mut program = format!(
            "G0 X{:.13} Y-30\nG1 {} D7 X0 Y0 F100\n",
            -30.0,
            if is_left { "G41" } else { "G42" }
        );
        for [x, y] in &places[1..] {
            program += &format!("X{x:.13} Y{y:.13}\n");
        }
        program += "G40\nX-30 Y-30";
        let mut setup = arcs();
        setup.radius_offsets = [(7, radius)].into();
        match (run(&program, &setup), stops) {
            (Ok(steps), None) => {
                followed += 1;
                assert_joined(&steps);
                let ends = &steps[1..steps.len() - 1];
                assert_eq!(ends.len(), expected.len(), "{program}");
                for (step, expected) in ends.iter().zip(&expected) {
                    worst = worst.max(distance(xy(&step.end), *expected));
                }
            }
            (Err(error), Some(line)) => {
                refused += 1;
                assert_eq!(error.line, line, "{program}\n{error}");
            }
            (found, expected) => panic!("{program}\n{found:?}\n{expected:?}"),
        }
    }
    println!(
        "{followed} paths within {worst:.1e} mm of the closed form, {refused} refused as it says"
    );
    assert!(worst < 1e-9 && followed > 2_000 && refused > 2_000);
}

/// LinuxCNC knows the ends of an arc and its direction: from a point beyond its end it turns all around, and on a full circle by nothing.
#[test]
fn arcs_beyond_their_end_are_refused_on_linuxcnc() {
    let short =
        "G41 D7 X10 Y-10\nX30\nG3 X30.03924 Y-9.9986 I-0.78524 J22.48629\nG1 X50.02581 Y-9.26572";
    let full = "G41 D7 X20 Y9.65079\nX30 Y10\nG3 X30 Y10 I0 J10";
    for (program, radius) in [(short, 2.5), (full, 5.0)] {
        let rules = ControlRules::named("linuxcnc").expect("a control");
        let radius_offsets = [(7, radius)].into();
        let setup = ControlSetup { rules, radius_offsets, ..arcs() };
        let program = format!("G21 G90 G1 X-10 Y-20 F500\n{program}\nG40 G1 X90 Y-30");
        let error = run(&program, &setup).expect_err(&program);
        assert!(is_fault(&error, "P0120 an arc"), "{program}\n{error}");
    }
}

/// The radius is that of the register on Fanuc and Haas, that of the tool on Sinumerik and Heidenhain, and of D0 on LinuxCNC.
#[test]
fn another_radius_than_that_of_the_tool_needs_a_stated_control() {
    let run = |control: &str, d: u32| {
        let program = format!(
            "G21 G90 G94 G17\nT2 M6\nG0 X-20. Y-20.\nG1 G41 D{d} X0. Y0. F500.\nX40.\nG40 X60. Y-20.\nM30\n"
        );
        let rules = ControlRules::named(control).expect("a control");
        let radius_offsets = [(1, 3.0), (2, 5.0), (3, 5.0)].into();
        run(&program, &ControlSetup { rules, radius_offsets, ..arcs() }).map(|_| ())
    };
    for d in [2, 3] {
        assert_eq!(run("generic", d), Ok(()), "{d}");
    }
    for d in [0, 1] {
        assert!(
            run("generic", d).is_err_and(|error| is_fault(&error, "P0120 the two differ")),
            "{d}"
        );
    }
    for control in ["fanuc", "linuxcnc"] {
        assert_eq!(run(control, 1), Ok(()), "{control}");
    }
}

/// A turn of less than 0.05 radians is a corner on Fanuc and none on LinuxCNC.
#[test]
fn small_turns_need_a_stated_control() {
    let program =
        "G21 G90 G94 G1 X-20. Y-20. F500.\nG41 D7 X0. Y0.\nX40.\nX90. Y2.25\nG40 X130. Y40.\nM30\n";
    let radius_offsets = [(7, 5.0)].into();
    let setup = ControlSetup { radius_offsets, ..arcs() };
    for (control, is_read) in [("generic", false), ("fanuc", true), ("linuxcnc", true)] {
        let rules = ControlRules::named(control).expect("a control");
        let result = run(program, &ControlSetup { rules, ..setup.clone() });
        let is_refused = result.is_err_and(|error| is_fault(&error, "P0120 a corner"));
        assert_eq!(is_refused, !is_read, "{control}");
    }
}
