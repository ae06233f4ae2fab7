//! One scene in millimetres, inches and metres: counts stay, lengths scale as lengths and areas as areas.

use nalgebra::{Point3, Vector3};
use touchoff::TriangleId;
use touchoff::mesh::shapes;
use touchoff::scenes::{HEIGHT, ScenePath};
use touchoff::tool::Interpreted;
use touchoff::{Cloud, Law, Part, Pose, Probe, Sampling, Tool, Unit, Weights, Wrench};
use touchoff_tests::library::tool;
use touchoff_tests::oracle::brute::{self, Query};
use touchoff_tests::oracle::{Fig73, Oracle, d2_ball, fig_7_3_exact};

/// D2Ball's 2 mm ball, flute and shank, in inches: 1 mm is 1/25.4 inch.
const INCH_BALL: &str = r#"tool InchBall "2 mm ball end mill, written in inches" {
    units inch;
    let mm = 1/25.4;
    let r = mm;

    curve nose = hypot(d, z - r) - r;
    curve side = r - d;
    curve end  = 40*mm - z;

    region ball as ball cutting where z <= r, nose <= 0 {
        depth:     -nose;
        direction: away from (0, r);
    }
    region flute as flute cutting where r <= z <= 5*mm, side >= 0 {
        depth:     side;
        direction: (1, 0);
    }
    region shank where z >= 5*mm, 0 <= side <= end {
        depth:     side;
        direction: (1, 0);
    }
    region end as shank where 0 <= end <= side {
        depth:     end;
        direction: (0, 1);
    }
    niceness cutting: 1 - depth/r;
}"#;

/// The unit sphere with a magnitude of its own formula, a plain number of the file's unit.
const WRITTEN: &str = r#"tool Written "a ball of 1 inch with a written magnitude" {
    units inch;
    region ball where hypot(d, z - 1) <= 1 {
        magnitude: 1 - hypot(d, z - 1);
        direction: away from (0, 1);
    }
}"#;

fn parsed(text: &str) -> Interpreted {
    text.parse().expect("a tool")
}

const UNITS: [Unit; 3] = [Unit::Millimetre, Unit::Inch, Unit::Metre];

/// Returns the scenes' tube, given in mm and scaled to a unit.
fn tube(unit: Unit, count: usize) -> Part {
    let length_unit = Unit::Millimetre.factor_to(unit);
    let mesh = shapes::tube(3.0, 5.0, HEIGHT, 256, 4, Unit::Millimetre).expect("a tube");
    let cloud = Cloud::sample(&mesh, Sampling::monte_carlo(count).with_seed(3)).expect("a cloud");
    let points = cloud.points().iter().map(|p| p * length_unit).collect();
    let weights = cloud.weights().iter().map(|w| w * length_unit * length_unit).collect();
    let ids = (0..count as u32).map(TriangleId).collect();
    let scaled = Cloud::new(points, cloud.normals().to_vec(), ids, weights, unit);
    Part::from_cloud(&scaled.expect("a cloud"))
}

/// Scales a pose given in mm to a unit.
fn scaled(pose: &Pose, unit: Unit) -> Pose {
    let length_unit = Unit::Millimetre.factor_to(unit);
    Pose::from_axis(pose.tip() * length_unit, pose.axis()).expect("a pose")
}

/// Returns a compliance centre off the tip, given in mm, in a unit.
fn centre(unit: Unit) -> Point3<f64> {
    Point3::new(1.5, -0.5, 2.0) * Unit::Millimetre.factor_to(unit)
}

/// Returns poses of all scenes, in mm.
fn poses() -> Vec<Pose> {
    ScenePath::ALL.into_iter().flat_map(|path| (0..150).map(move |k| path.pose(k, 150))).collect()
}

/// Powers by which each of a wrench's numbers grows with the unit's length: depth, integral, energy, force, torque.
type Powers = [i32; 5];

/// Returns the wrenches of a tool at one pose after another, in the part's unit.
fn evaluation(part: &Part, tool: &dyn Tool, law: Law, weights: Weights) -> Vec<Wrench> {
    let unit = part.unit();
    let mut probe =
        Probe::new(part, tool).with_law(law).with_weights(weights).with_centre(centre(unit));
    poses().iter().map(|pose| probe.wrench(&scaled(pose, unit))).collect()
}

/// Asserts that `b` is `a` in another unit, in which the length of `a`'s unit is `length_unit`. Points are stored to 2^-24
/// of their leaf, relative to a power of two that differs between units: that is `slack`, in mm, and sums differ by
/// it for every unit of weight.
fn scales(a: &Wrench, b: &Wrench, length_unit: f64, powers: Powers, slack: f64, what: &str) {
    let [depth, integral, energy, force, torque] = powers.map(|power| length_unit.powi(power));
    assert_eq!(a.colliding, b.colliding, "{what}");
    let assert_near = |got: f64, want: f64, bound: f64| {
        assert!((got - want).abs() <= bound, "{what}: {got}, not {want} to {bound:e}");
    };
    assert_near(b.depth() / depth, a.depth(), slack);
    let size = 10.0 * a.colliding as f64 * slack;
    assert_near(b.integral / integral, a.integral, size);
    assert_near(b.energy / energy, a.energy, 5.0 * size);
    assert_near((b.force / force - a.force).norm(), 0.0, 5.0 * size);
    assert_near((b.torque / torque - a.torque).norm(), 0.0, 100.0 * size);
    match (a.niceness, b.niceness) {
        (Some(a), Some(b)) => assert_near(b, a, 10.0 * slack),
        (a, b) => assert_eq!(a, b),
    }
}

const RELATIVE_TOLERANCE: f64 = 3e-7;

#[test]
fn one_scene_in_three_units() {
    let parts = UNITS.map(|unit| tube(unit, 6_000));
    // With depth for a magnitude, then with one that the file writes.
    let lengths = ["Fig73Exact", "D2Ball", "Cylinder"].map(|name| (name, true));
    for (name, depth) in lengths.into_iter().chain([("Fig73", false)]) {
        for (law, weights) in [
            (Law::Thesis, Weights::Area),
            (Law::Gradient, Weights::Area),
            (Law::Facing, Weights::Unit),
            (Law::Gradient, Weights::Unit),
        ] {
            // Powers of a weight, of a magnitude, and of a push: a gradient is the magnitude over a length.
            let w = if weights == Weights::Area { 2 } else { 0 };
            let m = i32::from(depth);
            let exponent = if law == Law::Gradient { m - 1 } else { 0 };
            let powers = [1, w + m, w + 2 * m, w + m + exponent, w + m + exponent + 1];
            let first = evaluation(&parts[0], tool(name), law, weights);
            let touching = first.iter().filter(|wrench| wrench.colliding > 0).count();
            assert!(touching > 50, "{name} {touching}");
            for part in &parts[1..] {
                let unit = part.unit();
                let length_unit = Unit::Millimetre.factor_to(unit);
                for (a, b) in first.iter().zip(evaluation(part, tool(name), law, weights)) {
                    scales(
                        a,
                        &b,
                        length_unit,
                        powers,
                        RELATIVE_TOLERANCE,
                        &format!("{name} {law} {weights} {unit}"),
                    );
                }
            }
        }
    }
}

/// The same solid in inches and in mm is the same tool.
#[test]
fn one_tool_in_two_units() {
    let inch_ball = parsed(INCH_BALL);
    for unit in UNITS {
        let part = tube(unit, 6_000);
        let length_unit = Unit::Millimetre.factor_to(unit);
        for law in [Law::Thesis, Law::Gradient, Law::Facing] {
            let mm = evaluation(&part, tool("D2Ball"), law, Weights::Area);
            let inch = evaluation(&part, &inch_ball, law, Weights::Area);
            for (a, b) in mm.iter().zip(&inch) {
                // Points are the same; only lengths of the tool are rounded elsewhere.
                let size = a.integral + length_unit.powi(3) * 1e-9;
                let assert_near = |a: f64, b: f64, size: f64| {
                    assert!((a - b).abs() <= 1e-9 * size, "{unit} {law}: {a} {b} {size}");
                };
                assert_eq!(a.colliding, b.colliding);
                assert_near(a.depth(), b.depth(), length_unit);
                assert_near(a.integral, b.integral, size);
                assert_near(a.energy, b.energy, size * length_unit);
                assert_near((a.force - b.force).norm(), 0.0, size);
                assert_near((a.torque - b.torque).norm(), 0.0, 40.0 * size * length_unit);
                assert_eq!(a.niceness.is_some(), b.niceness.is_some());
                if let (Some(a), Some(b)) = (a.niceness, b.niceness) {
                    assert_near(a, b, 1.0);
                }
            }
        }
    }
}

/// A written magnitude is the file's number in every part; its depth is a length, and its gradient is per length of
/// the part.
#[test]
fn a_written_magnitude_stays() {
    let written = parsed(WRITTEN);
    for unit in UNITS {
        let inch = Unit::Inch.factor_to(unit);
        let at = Point3::new(7.0, 8.0, 9.0);
        let ids = vec![TriangleId(0)];
        let cloud =
            Cloud::new(vec![at], vec![Vector3::z()], ids, vec![3.0], unit).expect("a cloud");
        let part = Part::from_cloud(&cloud);
        // A quarter of an inch deep.
        let pose = Pose::from_axis(at - 0.25 * inch * Vector3::z(), Vector3::z()).expect("a pose");
        let wrench = Probe::new(&part, &written).with_law(Law::Gradient).wrench(&pose);
        let assert_near = |got: f64, want: f64| {
            assert!((got - want).abs() < 1e-12 * want.abs(), "{unit}: {got}, not {want}");
        };
        assert_near(wrench.depth(), 0.25 * inch);
        assert_near(wrench.integral, 3.0 * 0.25);
        assert_near(wrench.energy, 0.5 * 3.0 * 0.0625);
        assert_near(wrench.force.z, 3.0 * 0.25 / inch);
        let mut probe = Probe::new(&part, &written);
        assert_near(probe.wrench(&pose).force.z, 3.0 * 0.25 * 2.0);
        let contact = probe.contacts(&pose)[0];
        assert_near(contact.magnitude, 0.25);
        assert_near(contact.depth, 0.25 * inch);
        assert_near(contact.gradient.z, 1.0 / inch);
    }
}

/// Compares with brute force, which handles units by itself.
#[test]
fn every_unit_agrees_with_the_oracle() {
    let inch_ball = parsed(INCH_BALL);
    let tools: [(&dyn Tool, &dyn Oracle); 4] = [
        (tool("Fig73"), &Fig73::default()),
        (tool("Fig73Exact"), &fig_7_3_exact()),
        (tool("D2Ball"), &d2_ball()),
        // The oracle's file is in mm.
        (&inch_ball, &d2_ball()),
    ];
    for unit in UNITS {
        let part = tube(unit, 1_500);
        let tree = part.tree();
        let indices = 0..tree.len();
        let points: Vec<[f64; 3]> = indices.clone().map(|i| tree.point(i).into()).collect();
        let normals: Vec<[f64; 3]> = indices.clone().map(|i| tree.normal(i)).collect();
        let weights: Vec<f64> = indices.map(|i| tree.weight(i)).collect();
        let length_unit = Unit::Millimetre.factor_to(unit);
        for (tool, oracle) in tools {
            for (law, same) in
                [(Law::Thesis, brute::Law::Thesis), (Law::Gradient, brute::Law::Gradient)]
            {
                let mut probe = Probe::new(&part, tool).with_law(law).with_centre(centre(unit));
                for pose in poses().iter().step_by(6).map(|pose| scaled(pose, unit)) {
                    let axes = [0, 1, 2].map(|k| pose.rotation().column(k).into_owned().into());
                    let brute_pose = brute::Pose { tip: pose.tip().into(), axes };
                    let mut query = Query::new(oracle, brute_pose, &points, &normals, &weights);
                    query.law = same;
                    query.scale = unit.factor_to(Unit::Millimetre);
                    query.centre = (pose.tip() + pose.rotation() * centre(unit).coords).into();
                    let (want, got) = (query.answer(), probe.wrench(&pose));
                    let assert_near = |error: f64, size: f64, what: &str| {
                        let name = oracle.name();
                        assert!(
                            error.abs() <= 1e-9 * size,
                            "{name} {unit} {what}: {error:e} {size:e}"
                        );
                    };
                    assert_eq!(want.count, got.colliding, "{} {unit}", oracle.name());
                    let depth = want.deepest.map_or(0.0, |(depth, _)| depth);
                    assert_near(got.depth() - depth, length_unit, "depth");
                    // Magnitudes near 0 err by the tool's rounding, not their own.
                    let [force, torque] = want.size;
                    let sum: f64 = want.contacts.iter().map(|&i| weights[i]).sum();
                    let m = if query.magnitude_is_depth { length_unit } else { 1.0 };
                    assert_near(got.integral - want.integral, want.integral + sum * m, "integral");
                    assert_near(got.energy - want.energy, want.energy + sum * m * m, "energy");
                    let scale = if law == Law::Gradient { m / length_unit } else { 1.0 };
                    let difference = (got.force - Vector3::from(want.force)).norm();
                    assert_near(difference, force + sum * m * scale, "force");
                    let difference = (got.torque - Vector3::from(want.torque)).norm();
                    assert_near(
                        difference,
                        torque + 20.0 * sum * m * scale * length_unit,
                        "torque",
                    );
                    assert_eq!(got.niceness.is_some(), want.niceness.is_some());
                    if let (Some(got), Some(want)) = (got.niceness, want.niceness) {
                        assert_near(got - want, 1.0, "niceness");
                    }
                }
            }
        }
    }
}
