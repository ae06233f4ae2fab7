//! Polar coordinates, mirror images, and corners of contours: the same motions written without them, closed forms, and refusals.

use crate::common;
use crate::common::is_fault;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use touchoff_verify::gcode::{
    Choice, ControlRules, ControlSetup, GcodeError, NoteKind, Rule, Step, StepPath, read,
};

fn setup() -> ControlSetup {
    let rules = ControlRules::named("haas").expect("a control");
    let rules =
        rules.with(Rule::WholeNumbers, Choice::Units).with(Rule::LengthChange, Choice::NextMotion);
    ControlSetup {
        start: [Some(0.0); 6],
        work_offsets: [Some([0.0; 6]); 9],
        radius_offsets: [(1, 2.0)].into(),
        rules: rules.with(Rule::Unit, Choice::Millimetre),
        ..ControlSetup::default()
    }
}

fn execute(program: &str) -> Result<Vec<Step>, GcodeError> {
    common::execute(program, &setup())
}

#[track_caller]
fn steps(program: &str) -> Vec<Step> {
    common::steps(program, &setup())
}

/// Asserts that two programs move alike, up to rounding.
#[track_caller]
fn assert_same(program: &str, plain: &str) {
    let (found, expected) = (steps(program), steps(plain));
    assert_eq!(found.len(), expected.len(), "{program}\n{found:#?}");
    for (step, other) in found.iter().zip(&expected) {
        assert_eq!(step.rapid, other.rapid, "line {}", step.line);
        for axis in 0..6 {
            let [one, two] = [step, other].map(|step| step.end[axis].expect("a known position"));
            assert!(
                (one - two).abs() < 1e-9,
                "line {}: {:?}, not {:?}",
                step.line,
                step.end,
                other.end
            );
        }
        match (step.path, other.path) {
            (
                StepPath::Arc { plane, centre, sweep },
                StepPath::Arc { plane: other_plane, centre: other_centre, sweep: other_sweep },
            ) => {
                assert_eq!(plane, other_plane);
                let is_near = |one: f64, two: f64| (one - two).abs() < 1e-9;
                assert!(
                    is_near(centre[0], other_centre[0])
                        && is_near(centre[1], other_centre[1])
                        && is_near(sweep, other_sweep),
                    "line {}: {:?}, not {:?}",
                    step.line,
                    step.path,
                    other.path
                );
            }
            (path, other) => assert_eq!(path, other, "line {}", step.line),
        }
    }
}

#[track_caller]
fn assert_refused(program: &str, message: &str) {
    let error = execute(program).expect_err(program);
    assert!(is_fault(&error, message), "{program}\n{error}");
}

const START: &str = "G21 G17 G90 G54 G0 X0. Y0. Z10. S900 M3 F100.\n";

/// The positions r (cos φ, sin φ), computed here.
#[test]
fn polar_coordinates_are_those_of_the_radius_and_the_angle() {
    let at = |radius: f64, angle: f64| {
        let angle = angle.to_radians();
        format!("X{:.12} Y{:.12}", radius * angle.cos(), radius * angle.sin())
    };
    for unit in ["G21", "G20"] {
        let start = START.replace("G21", unit);
        let holes = format!(
            "{start}G16\nG81 X40. Y30. R2. Z-5.\nY150.\nX25.\nY-45.\nG80 G15\nG0 X1. Y2.\nM30\n"
        );
        let plain = format!(
            "{start}G81 {} R2. Z-5.\n{}\n{}\n{}\nG80\nG0 X1. Y2.\nM30\n",
            at(40.0, 30.0),
            at(40.0, 150.0),
            at(25.0, 150.0),
            at(25.0, -45.0)
        );
        assert_same(&holes, &plain);
    }
    // Along a circle by its radius; a motion of Z alone has no polar coordinate.
    let arc = format!("{START}G16\nG1 X10. Y0.\nZ-1.\nG3 X10. Y90. R10.\nG15\nG0 Z10.\nM30\n");
    assert_same(&arc, &format!("{START}G1 X10. Y0.\nZ-1.\nG3 X0. Y10. R10.\nG0 Z10.\nM30\n"));
    // After G15 and G16 the last radius is forgotten.
    let refused =
        |blocks: &str, message: &str| assert_refused(&format!("{START}{blocks}\nM30\n"), message);
    refused("G16\nX10.", "P0119 both the radius X and the angle Y");
    refused("G16\nX10. Y5.\nG15\nG16\nY5.", "P0119 both the radius X and the angle Y");
    refused("G16 X10. Y30.", "P0120 which is polar on some controls");
    refused("G16\nG91 X10. Y30.", "P0120 it is an increment");
    refused("G16\nG18\nX10. Y30.", "P0120 G18");
    refused("G16\nX10. Y0.\nG3 Y90. I-10. J0.", "P0120 G16");
    refused("G16\nG28 X0. Y0.", "P0120 G28");
    refused("G68 X0. Y0. R30.\nG16", "P0120 a plane is rotated");
    refused("G51.1 X0.\nG16", "P0120 a mirror image is in force");
}

#[test]
fn a_whole_angle_counts_in_thousandths_of_a_degree() {
    let rules = ControlRules::named("fanuc")
        .expect("a control")
        .with(Rule::LengthChange, Choice::NextMotion);
    let setup = ControlSetup { rules, ..setup() };
    let program = "G21 G90 G54 G0 X0 Y0\nG16\nX20000 Y90000\nM30\n";
    let steps = read(program, &setup).expect("a program").0;
    let end = steps[1].end;
    assert!(
        end[0].expect("X").abs() < 1e-12 && (end[1].expect("Y") - 20.0).abs() < 1e-12,
        "{end:?}"
    );
}

#[test]
fn a_mirror_image_turns_positions_arcs_and_compensation_over() {
    let contour = |x: &dyn Fn(f64) -> f64, [right, left]: [&str; 2], side: &str, sign: f64| {
        let points = [(-20.0, 5.0), (0.0, 5.0), (30.0, 5.0), (40.0, 15.0), (40.0, 40.0)];
        let at = |k: usize| format!("X{:.6} Y{:.6}", x(points[k].0), points[k].1);
        format!(
            "G0 {}\n{side} D1 G1 {}\n{}\n{right} {} R10.\nG1 {}\n{left} X{:.6} Y50. I{:.6} J0.\nG1 G40 X{:.6} Y70.\nG0 Z10.\n",
            at(0),
            at(1),
            at(2),
            at(3),
            at(4),
            x(30.0),
            sign * -10.0,
            x(-10.0)
        )
    };
    let plain = contour(&|x| x, ["G3", "G3"], "G41", 1.0);
    // Mirrored about X = 7, by hand.
    let mirrored = contour(&|x| 14.0 - x, ["G2", "G2"], "G42", -1.0);
    assert_same(
        &format!("{START}G51.1 X7.\n{plain}G50.1 X0\n{plain}M30\n"),
        &format!("{START}{mirrored}{plain}M30\n"),
    );
    // About both axes the figure is turned by 180 degrees, and arcs keep their direction.
    let arc = "G0 X10. Y0.\nG1 Z-1.\nG2 X0. Y-10. I-10. J0.\nG91 X-5. Y-2. R8.\nG90 G0 Z10.\n";
    let turned = "G0 X-10. Y0.\nG1 Z-1.\nG2 X0. Y10. I10. J0.\nG91 X5. Y2. R8.\nG90 G0 Z10.\n";
    assert_same(
        &format!("{START}G51.1 X0. Y0.\n{arc}G50.1 X0 Y0\nX1.\nM30\n"),
        &format!("{START}{turned}X1.\nM30\n"),
    );
    assert_same(
        &format!("{START}G51.1 Y5.\nG81 X3. Y4. R2. Z-5.\nX8.\nG80\nG50.1 Y0\nG0 X0. Y0.\nM30\n"),
        &format!("{START}G81 X3. Y6. R2. Z-5.\nX8.\nG80\nG0 X0. Y0.\nM30\n"),
    );
    let refused =
        |blocks: &str, message: &str| assert_refused(&format!("{START}{blocks}\nM30\n"), message);
    refused("G51.1", "P0119 the axes that it mirrors");
    refused("G51.1 A0.", "P0120 it names a rotary axis");
    refused("G51.1 X0.\nG50.1", "P0119 the axes that it mirrors");
    refused("G91 G51.1 X0.", "P0120 G91");
    refused("G51.1 X0.\nG55 X1.", "P0120 G55");
    refused("G51.1 X0.\nG68 X0. Y0. R30.", "P0120 G68");
    refused("G51.1 Z0.\nG81 X1. R2. Z-5.", "P0120 the axis of its holes is mirrored");
    refused("G51 X0. Y0. P2.", "P0115 scaling, whose axes and unit of P are set by parameters");
}

#[test]
fn a_figure_that_is_left_is_noted() {
    for (words, left) in [("G16", "G16"), ("G51.1 X5.", "G51.1")] {
        let program =
            format!("G21 G17 G90 G54 S900 M3 F100.\nG0 X10. Y30. Z10.\n{words}\nX10. Y20.\nM30\n");
        let (_, notes) = read(&program, &setup()).expect("a program");
        let is_left =
            |kind: &NoteKind| matches!(kind, NoteKind::LeftModes { words } if words == left);
        assert!(notes.iter().any(|note| is_left(&note.kind)), "{notes:?}");
        let end = if left == "G16" { "G15" } else { "G50.1 X0" };
        let ended = program.replace("M30", &format!("{end}\nM30"));
        let (_, notes) = read(&ended, &setup()).expect("a program");
        assert!(!notes.iter().any(|note| is_left(&note.kind)), "{notes:?}");
    }
}

/// The points and centres of a square's corners, worked out by hand, and of a corner of 135 degrees by its angles.
#[test]
fn corners_of_a_contour_are_rounded_or_chamfered() {
    let written = "G1 X40. ,R5.\nY30. ,C2.\nX0. ,R3.\nY0.\nG0 Z10.\nM30\n";
    let plain = "G1 X35.\nG3 X40. Y5. I0. J5.\nG1 Y28.\nX38. Y30.\nX3.\nG3 X0. Y27. I0. J-3.\nG1 Y0.\nG0 Z10.\nM30\n";
    for unit in ["G21", "G20"] {
        let start = START.replace("G21", unit);
        assert_same(&format!("{start}{written}"), &format!("{start}{plain}"));
    }
    // A dwell or a comment between both lines, a mirror image, and a subprogram change nothing.
    assert_same(
        &format!("{START}G1 X40. ,R5.\n(corner)\nG4 P1.\nM98 P7\nG0 Z10.\nM30\nO7\nG1 Y30.\nM99\n"),
        &format!("{START}G1 X35.\nG4 P1.\nG3 X40. Y5. I0. J5.\nG1 Y30.\nG0 Z10.\nM30\n"),
    );
    assert_same(
        &format!("{START}G51.1 Y0.\nG1 X40. ,R5.\nY30.\nG50.1 Y0\nG0 Z10.\nM30\n"),
        &format!("{START}G1 X35.\nG2 X40. Y-5. I0. J-5.\nG1 Y-30.\nG0 Z10.\nM30\n"),
    );
    // In the plane ZX, and beside the path of the tool's centre.
    assert_same(
        &format!("{START}G18\nG1 Z-10. ,R5.\nX40.\nG0 Z10.\nM30\n"),
        &format!("{START}G18\nG1 Z-5.\nG2 X5. Z-10. R5.\nG1 X40.\nG0 Z10.\nM30\n"),
    );
    let beside = |contour: &str| {
        format!(
            "{START}G0 X-20. Y-20.\nG41 D1 G1 X0. Y-10.\nY0.\n{contour}\nG40 X60. Y60.\nG0 Z10.\nM30\n"
        )
    };
    assert_same(
        &beside("Y40. ,R5.\nX40. ,C4.\nY0."),
        &beside("Y35.\nG2 X5. Y40. I5. J0.\nG1 X36.\nX40. Y36.\nY0."),
    );
    let arc = steps(&format!("{START}G1 X20. ,R4.\nX40. Y20.\nG0 Z10.\nM30\n"))
        .into_iter()
        .find(|step| step.path != StepPath::Line)
        .expect("an arc");
    let StepPath::Arc { centre, sweep, .. } = arc.path else { panic!("{arc:?}") };
    let cut = 4.0 * (std::f64::consts::PI / 8.0).tan();
    assert!((sweep - std::f64::consts::FRAC_PI_4).abs() < 1e-12, "{sweep}");
    assert!(
        (centre[0] - (20.0 - cut)).abs() < 1e-12 && (centre[1] - 4.0).abs() < 1e-12,
        "{centre:?}"
    );
    let end = 20.0 + cut / 2.0f64.sqrt();
    assert!((arc.end[0].expect("X") - end).abs() < 1e-12, "{arc:?}");
    // Motions that go on in one direction have no corner.
    assert_same(
        &format!("{START}G1 X40. ,R5.\nX50.\nG0 Z10.\nM30\n"),
        &format!("{START}G1 X40.\nX50.\nG0 Z10.\nM30\n"),
    );
    let refused =
        |blocks: &str, message: &str| assert_refused(&format!("{START}{blocks}\nM30\n"), message);
    refused("G1 X40. ,R5.", "P0119 ,R needs a motion at feed in its plane after it");
    let round = "P0115 a corner that is not between two lines or arcs in its plane";
    for blocks in ["G0 Y10.", "Z5.", "G55 Y10.", "G18\nG1 X10.", "G3 Y10. Z5. R5."] {
        refused(&format!("G1 X40. ,R5.\n{blocks}"), round);
    }
    refused("G3 X40. R20. Z5. ,R5.\nG1 Y-10.", round);
    refused(
        "G1 X40. ,C5.\nG3 Y10. R8.",
        "P0115 a corner that is not between two lines in its plane",
    );
    refused(
        "G3 X40. R20. ,C5.\nG1 X60.",
        "P0115 a corner that is not between two lines in its plane",
    );
    refused("G0 X40. ,R5.\nG1 Y10.", "P0115 a corner that is not between two lines");
    refused(
        "G1 X40. ,C5.\nG3 Y10. R5.",
        "P0115 a corner that is not between two lines in its plane",
    );
    refused(
        "G1 X40. ,R5.\nG41 D1 Y10.",
        "P0120 the next motion begins or ends cutter compensation",
    );
    refused("G1 X40. ,R5.\nY4.", "P0120 a motion beside it is shorter");
    refused("G1 X40. ,R5.\nX30.", "P0120 the next motion goes back in its direction");
    refused("G1 X40. ,R0.\nY10.", "P0119 ,R needs a length above 0");
    refused("G1 X40. ,A5.\nY10.", "P0115 ,A is an angle, or a corner on other controls");
    refused("G1 X40. ,R5. ,C5.\nY10.", "P0116 C");
    refused(",R5.", "P0115 a corner that is not between two lines");
}

/// A point along a contour, and the direction there.
struct Place {
    point: [f64; 2],
    direction: [f64; 2],
}

/// Returns a step's start and end as places, and its radius about a centre.
fn places(step: &Step) -> [Place; 2] {
    let at =
        |position: &[Option<f64>; 6]| [0, 1].map(|axis| position[axis].expect("a known place"));
    let points = [at(&step.start), at(&step.end)];
    let [start, end] = points;
    points.map(|point| {
        let direction = match step.path {
            StepPath::Arc { centre, sweep, .. } => {
                let radius = [point[0] - centre[0], point[1] - centre[1]];
                [-radius[1] * sweep.signum(), radius[0] * sweep.signum()]
            }
            _ => [end[0] - start[0], end[1] - start[1]],
        };
        let length = direction[0].hypot(direction[1]);
        Place { point, direction: direction.map(|value| value / length) }
    })
}

/// Corners between random lines and arcs, in ISO and in Klartext: each piece goes on where the one before ends, in its direction; the
/// corner has its radius; and what is left of both motions lies on them. A corner of two lines is also checked against its closed form.
#[test]
fn rounded_corners_touch_lines_and_arcs() {
    let mut random = Pcg64Mcg::seed_from_u64(31);
    let mut uniform = move || (random.next_u64() >> 11) as f64 / 2f64.powi(53);
    let rules = ControlRules::named("heidenhain").expect("a control");
    let klartext_setup =
        ControlSetup { rules: rules.with(Rule::ToolChange, Choice::Stays), ..setup() };
    let (mut read, mut kinds) = (0, [0; 4]);
    for case in 0..4000 {
        let kind = case % 4;
        let radius = 0.5 + 4.0 * uniform();
        // Two motions that meet at the origin; the first comes from `from`, the second leads to `to`.
        let angles = [0.0, 1.0].map(|_| std::f64::consts::TAU * uniform());
        let lengths = [0.0, 1.0].map(|_| 20.0 + 20.0 * uniform());
        let [from, to] =
            [0, 1].map(|k| [lengths[k] * angles[k].cos(), lengths[k] * angles[k].sin()]);
        let bends = [0, 1].map(|k| {
            (kind >> k & 1 == 1).then(|| (uniform() < 0.5, (0.6 + uniform()) * lengths[k]))
        });
        let word = |bend: Option<(bool, f64)>, point: [f64; 2], corner: &str| match bend {
            None => format!("G1 X{:.9} Y{:.9}{corner}", point[0], point[1]),
            Some((clockwise, radius)) => {
                let code = if clockwise { 2 } else { 3 };
                format!("G{code} X{:.9} Y{:.9} R{radius:.9}{corner}", point[0], point[1])
            }
        };
        let sentence = |bend: Option<(bool, f64)>, point: [f64; 2]| match bend {
            None => format!("L X{:+.9} Y{:+.9}", point[0], point[1]),
            Some((clockwise, radius)) => {
                let sign = if clockwise { '-' } else { '+' };
                format!("CR X{:+.9} Y{:+.9} R{radius:+.9} DR{sign}", point[0], point[1])
            }
        };
        let iso = format!(
            "{START}G0 X{:.9} Y{:.9}\n{}\n{}\nG1 Z9.\nM30\n",
            from[0],
            from[1],
            word(bends[0], [0.0; 2], &format!(",R{radius:.9}")),
            word(bends[1], to, "")
        );
        let klartext = format!(
            "0 BEGIN PGM A MM\nL X{:+.9} Y{:+.9} FMAX\n{} F100\nRND R{radius:.9}\n{}\nL Z+9\nEND PGM A MM\n",
            from[0],
            from[1],
            sentence(bends[0], [0.0; 2]),
            sentence(bends[1], to)
        );
        let plain = steps(&iso.replace(&format!(",R{radius:.9}"), ""));
        let found = execute(&iso);
        let twin = touchoff_verify::gcode::read(&klartext, &klartext_setup);
        assert_eq!(found.is_ok(), twin.is_ok(), "{iso}{klartext}{found:?} {twin:?}");
        let (Ok(found), Ok((twin, _))) = (found, twin) else { continue };
        let count = found.len();
        for (step, other) in found[count - 4..].iter().zip(&twin[twin.len() - 4..]) {
            let [one, two] = [step, other].map(places);
            for (one, two) in one.iter().zip(&two) {
                let [x, y] = [0, 1].map(|axis| one.point[axis] - two.point[axis]);
                assert!(
                    step.commanded[2] || x.hypot(y) < 1e-7,
                    "{iso}{klartext}{step:?} {other:?}"
                );
            }
        }
        let [before, between, after] = &found[count - 4..count - 1] else { panic!("{iso}") };
        let StepPath::Arc { centre, sweep, .. } = between.path else { panic!("{iso}{between:?}") };
        for [one, two] in [[before, between], [between, after]].map(|pair| pair.map(places)) {
            let ([_, end], [start, _]) = (one, two);
            let gap = (end.point[0] - start.point[0]).hypot(end.point[1] - start.point[1]);
            let bend = (end.direction[0] - start.direction[0])
                .hypot(end.direction[1] - start.direction[1]);
            assert!(gap == 0.0 && bend < 1e-6, "{iso}{found:?} {gap:e} {bend:e}");
        }
        for place in places(between) {
            let found = (place.point[0] - centre[0]).hypot(place.point[1] - centre[1]);
            assert!((found - radius).abs() < 1e-7, "{iso}: {found} is not {radius}");
        }
        // The rest of a motion is its own, and shorter.
        for (whole, part) in [(&plain[count - 4], before), (&plain[count - 3], after)] {
            match (whole.path, part.path) {
                (StepPath::Line, StepPath::Line) => {
                    let ([start, end], [first, last]) = (places(whole), places(part));
                    let along = |point: [f64; 2]| {
                        let [x, y] = [0, 1].map(|axis| point[axis] - start.point[axis]);
                        let across = x * start.direction[1] - y * start.direction[0];
                        assert!(across.abs() < 1e-7, "{iso}");
                        x * start.direction[0] + y * start.direction[1]
                    };
                    let order = [
                        along(start.point),
                        along(first.point),
                        along(last.point),
                        along(end.point),
                    ];
                    assert!(
                        order.windows(2).all(|pair| pair[0] <= pair[1] + 1e-9),
                        "{iso}{order:?}"
                    );
                }
                (
                    StepPath::Arc { centre, sweep, .. },
                    StepPath::Arc { centre: of_part, sweep: part_sweep, .. },
                ) => {
                    assert_eq!(centre, of_part);
                    assert!(sweep * part_sweep >= 0.0 && part_sweep.abs() <= sweep.abs(), "{iso}");
                    let ends = places(part).map(|place| {
                        (place.point[1] - centre[1]).atan2(place.point[0] - centre[0])
                    });
                    let turn = (ends[1] - ends[0] - part_sweep).rem_euclid(std::f64::consts::TAU);
                    assert!(turn.min(std::f64::consts::TAU - turn) < 1e-6, "{iso}{turn}");
                }
                other => panic!("{iso}{other:?}"),
            }
        }
        if kind == 0 {
            // The tangent length r / tan(half of the angle between both lines).
            let between = (angles[0] - angles[1]).cos().acos();
            let cut = places(before)[1].point;
            assert!((cut[0].hypot(cut[1]) - radius / (0.5 * between).tan()).abs() < 1e-6, "{iso}");
            assert!((sweep.abs() - (std::f64::consts::PI - between)).abs() < 1e-6, "{iso}");
        }
        read += 1;
        kinds[kind] += 1;
    }
    println!("{read} corners: {kinds:?} of two lines, an arc before, an arc after, two arcs");
    assert!(kinds.iter().all(|count| *count > 400), "{kinds:?}");
}
