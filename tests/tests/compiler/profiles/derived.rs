//! Regions that the compiler derives from a profile, against nearest features by brute force.

use super::tool;
use std::collections::BTreeSet;
use touchoff_dsl::formula::Formula;
use touchoff_dsl::interpret::Interpreter;
use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::oracle::{Oracle, d2_ball, fig_7_3_exact, half_sphere_cylinder};

pub(crate) const FIG_7_3: &str = "tool Fig73 { units mm; tip z = 20; spindle -z;
    profile {
        start (0, 0);
        line to (5, 0), (5, 11), (3, 11) as housing;
        line to (3, 13), (1, 15)         as spindle;
        line to (1, 19)                  as flute cutting;
        arc  to (0, 20) center (0, 19)   as nose  cutting;
    } }";

const D2_BALL: &str = "tool D2 { units mm;
    profile {
        start (0, 0);
        arc  to (1, 1) radius 1 as ball  cutting;
        line to (1, 5)          as flute cutting;
        line to (1, 40), (0, 40) as shank;
    }
    niceness cutting: 1 - depth/1; }";

const HALF_SPHERE: &str = "tool Half { units mm; tip z = -2;
    profile {
        start (0, -2);
        arc  to (2, 0) center (0, 0) as ball;
        line to (1, 0)               as step;
        line to (1, 6), (0, 6)       as stem;
    } }";

/// Asserts that owner, depth and direction are the oracle's; `order` gives the oracle's index of each region.
fn agrees(text: &str, oracle: &dyn Oracle, order: &[usize]) {
    let tool = tool(text).expect("a good profile");
    assert_eq!(tool.model.regions.len(), order.len());
    let mut interpreter = Interpreter::new(&tool);
    let mut rng = Rng::new(3);
    let [radius, height] = oracle.extent();
    let scale = radius.max(height);
    let mut evaluation = 0;
    for _ in 0..60_000 {
        let p = [
            rng.between(-1.1 * radius, 1.1 * radius),
            rng.between(-1.1 * radius, 1.1 * radius),
            rng.between(-0.05 * height, 1.05 * height),
        ];
        if oracle.border_distance(p) < 1e-9 * scale {
            continue;
        }
        let (got, expected) = (interpreter.evaluate(p, 1.0), oracle.evaluate(p));
        let (Some(got), Some(expected)) = (got, expected) else {
            assert_eq!(got.is_some(), expected.is_some(), "inside at {p:?}");
            continue;
        };
        evaluation += 1;
        assert_eq!(order[got.region], expected.owner, "owner at {p:?}");
        assert!((got.depth - expected.depth).abs() < 1e-13 * scale, "{} at {p:?}", got.depth);
        for (a, b) in got.direction.iter().zip(expected.direction) {
            assert!(
                (a - b).abs() < 1e-9,
                "{:?}, not {:?} at {p:?}",
                got.direction,
                expected.direction
            );
        }
    }
    assert!(evaluation > 10_000);
}

#[test]
fn the_thesis_tool_is_derived() {
    // Derived from the tip up, where the thesis lists from the housing down.
    agrees(FIG_7_3, &fig_7_3_exact(), &[0, 1, 2, 3, 4, 5, 6, 7, 8]);
    let tool = tool(FIG_7_3).expect("a good profile");
    let names: Vec<&str> = tool.model.regions.iter().map(|region| region.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "nose",
            "flute",
            "flute/spindle.1",
            "spindle.1",
            "spindle.2",
            "spindle/housing.1",
            "housing.1",
            "housing.2",
            "housing.3",
        ]
    );
    // Nine curves divide, as in fig73-exact; five bound where no divider's line does.
    let mut curves = BTreeSet::new();
    tool.model.regions.iter().for_each(|region| mentioned(&region.inside, &mut curves));
    assert_eq!(curves.len(), 9 + 5);
}

fn mentioned(formula: &Formula, curves: &mut BTreeSet<usize>) {
    match formula {
        Formula::Const(_) => {}
        Formula::Atom { curve, .. } => {
            curves.insert(*curve);
        }
        Formula::All(parts) | Formula::Any(parts) => {
            parts.iter().for_each(|part| mentioned(part, curves));
        }
    }
}

#[test]
fn a_ball_cutter_is_derived() {
    agrees(D2_BALL, &d2_ball(), &[0, 1, 2, 3]);
}

#[test]
fn the_half_sphere_is_derived() {
    agrees(HALF_SPHERE, &half_sphere_cylinder(), &[0, 1, 2, 3, 4]);
}

/// A magnitude that is the depth is a length and changes with the part's unit; a law of another form is the file's
/// own number.
#[test]
fn a_law_that_is_the_depth_is_a_length() {
    let evaluation = |law: &str| {
        let tool = tool(&D2_BALL.replace("niceness cutting", &format!("{law} niceness cutting")));
        Interpreter::new(&tool.expect("a good profile"))
            .evaluate([0.5, 0.0, 3.0], 0.25)
            .expect("inside")
    };
    assert_eq!(evaluation("").magnitude, 0.125);
    assert_eq!(evaluation("magnitude: depth;").magnitude, 0.125);
    assert_eq!(evaluation("magnitude: 2*depth;").magnitude, 1.0);
}
