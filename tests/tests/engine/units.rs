//! One scene in millimetres, inches and metres.

use crate::prelude::*;
use crate::query::compare::Case;
use crate::query::parts;
use touchoff::scenes::ScenePath;
use touchoff_tests::fixtures::part_in;
use touchoff_tests::library::tool;
use touchoff_tests::oracle::{Fig73, cylinder, d2_ball, fig_7_3_exact};

/// D2Ball's 2 mm ball, flute and shank, in inches.
const INCH_BALL: &str = r#"tool InchBall "2 mm ball end mill, written in inches" {
    units inch;
    profile {
        start (0, 0);
        arc to (1mm, 1mm) center (0, 1mm) as ball cutting;
        line to (1mm, 5mm) as flute cutting;
        line to (1mm, 40mm), (0, 40mm) as shank;
    }
    niceness cutting: 1 - depth/1mm;
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

/// Scales a pose given in mm to a unit.
fn scaled(pose: &Pose, unit: Unit) -> Pose {
    let length_unit = Unit::Millimetre.factor_to(unit);
    Pose::from_axis(pose.tip() * length_unit, pose.axis()).expect("a pose")
}

fn poses() -> Vec<Pose> {
    ScenePath::ALL.into_iter().flat_map(|path| (0..150).map(move |k| path.pose(k, 150))).collect()
}

/// A written magnitude is the file's number in every part; its depth is a length, and its gradient is per length of
/// the part.
#[test]
fn a_written_magnitude_stays() {
    let written = parsed(WRITTEN);
    for unit in UNITS {
        let inch = Unit::Inch.factor_to(unit);
        let at = Point3::new(7.0, 8.0, 9.0);
        let part = part_in(unit, vec![at], vec![Vector3::z()], vec![3.0]);
        // A quarter of an inch deep.
        let pose = Pose::from_axis(at - 0.25 * inch * Vector3::z(), Vector3::z()).expect("a pose");
        let wrench = Probe::new(&part, &written).with_law(Law::Gradient).wrench(&pose);
        let near = |got: f64, want: f64| assert_near(got, want, 1e-12 * want.abs(), unit);
        near(wrench.depth(), 0.25 * inch);
        near(wrench.integral, 3.0 * 0.25);
        near(wrench.energy, 0.5 * 3.0 * 0.0625);
        near(wrench.force.z, 3.0 * 0.25 / inch);
        let mut probe = Probe::new(&part, &written).with_law(Law::Thesis);
        near(probe.wrench(&pose).force.z, 3.0 * 0.25 * 2.0);
        let contact = probe.contacts(&pose)[0];
        near(contact.magnitude, 0.25);
        near(contact.depth, 0.25 * inch);
        near(contact.gradient.z, 1.0 / inch);
    }
}

/// Brute force handles units by itself, for depths and for a magnitude that the file writes. The same solid in inches and
/// in mm is the same tool.
#[test]
fn every_unit_agrees_with_the_oracle() {
    let inch_ball = parsed(INCH_BALL);
    let tools: [(&dyn Tool, &dyn Oracle); 5] = [
        (tool("Cylinder"), &cylinder()),
        (tool("Fig73"), &Fig73::default()),
        (tool("Fig73Exact"), &fig_7_3_exact()),
        (tool("D2Ball"), &d2_ball()),
        // The oracle's file is in mm.
        (&inch_ball, &d2_ball()),
    ];
    for unit in UNITS {
        let part = parts::tube(6_000).converted_to(unit);
        for (tool, oracle) in tools {
            let mut case = Case::new(&part, tool, oracle);
            // Laws and weights take turns.
            for (k, pose) in poses().iter().enumerate() {
                case.check(&scaled(pose, unit), k);
            }
            assert!(case.statistics.touching > 50, "{unit} {:?}", case.statistics);
        }
    }
}
