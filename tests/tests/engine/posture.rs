//! The quantities that a posture is judged by, for all sets of points whose depth and niceness are known.

use crate::prelude::*;
use touchoff_tests::fixtures::{interpreted, part_at};
use touchoff_tests::oracle::restated::Restated;

/// A point in a ball end mill, its depth, its niceness and whether its surface cuts.
type Known = ([f64; 3], f64, f64, bool);

const POINTS: [Known; 5] = [
    ([0.0, 0.0, 1.0], 1.0, 0.9, true),
    ([0.0, 0.0, 2.0], 2.0, 0.8, true),
    ([1.5, 0.0, 10.0], 1.5, 0.0, false),
    ([0.0, 2.5, 12.0], 0.5, 0.0, false),
    ([9.0, 0.0, 5.0], -6.0, 0.0, false),
];

fn mill() -> Interpreted {
    let mill = Restated::drawn("Mill", "0 0; ball 3 3 about 0 3; shank 3 20, 0 20", &[]);
    interpreted(&mill.cuts("ball"), "1 - z/10 allow rising")
}

fn near(found: Option<f64>, expected: Option<f64>, what: &str) {
    assert_near(found.unwrap_or(-1.0), expected.unwrap_or(-1.0), 1e-9, what);
}

#[test]
fn a_posture_has_the_greatest_depths_and_the_least_niceness_of_its_points() {
    let mill = mill();
    for set in 1..1u32 << POINTS.len() {
        let chosen = POINTS.iter().enumerate().filter(|(k, _)| set >> k & 1 == 1);
        let chosen: Vec<&Known> = chosen.map(|(_, known)| known).collect();
        // In both orders, so that the first is the least and the greatest in turn.
        for is_reversed in [false, true] {
            let mut points: Vec<Point3<f64>> =
                chosen.iter().map(|(at, ..)| Point3::from(*at)).collect();
            if is_reversed {
                points.reverse();
            }
            let part = part_at(&points);
            let inside: Vec<&&Known> = chosen.iter().filter(|known| known.1 >= 0.0).collect();
            let greatest = |is_counted: fn(&Known) -> bool| {
                let depths = inside.iter().filter(|known| is_counted(known)).map(|known| known.1);
                depths.reduce(f64::max)
            };
            let niceness = inside.iter().map(|known| known.2).reduce(f64::min);
            let mut probe = Probe::new(&part, &mill);
            let found = probe.posture(&Pose::default());
            assert_eq!(found.colliding, inside.len());
            near(found.niceness, niceness, "niceness");
            near(found.non_cutting_depth, greatest(|known| !known.3), "non-cutting depth");
            let deepest = greatest(|_| true);
            near(found.deepest.map(|deepest| deepest.depth), deepest, "depth");
            let alone = probe.deepest(&Pose::default());
            assert_eq!(alone, found.deepest);
            let wrench = probe.wrench(&Pose::default());
            assert_eq!((wrench.deepest, wrench.niceness), (found.deepest, found.niceness));
        }
    }
}
