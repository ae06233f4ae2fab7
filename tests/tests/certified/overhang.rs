//! Tools with overhanging profiles, and their oracles.

use crate::prelude::*;
use std::sync::LazyLock;
use touchoff_tests::fixtures::interpreted;
use touchoff_tests::oracle::restated::Restated;

/// Names, [drawings][Restated::drawn] and the surfaces that cut.
const DRAWN: [(&str, &str, &str); 7] = [
    ("HoleSaw", "0 12; cup 16 12, 16 0; teeth 19 0; body 19 18, 5 18, 5 45, 0 45", "teeth"),
    // A dovetail whose face is dished by 0.2 mm.
    ("Dished", "0 0.2; face 8 0; flank 5 6; shank 4 7, 4 40, 0 40", "face flank"),
    // Hollow and round arcs on both sides.
    (
        "Bell",
        "0 8; dome 6 2 about 0 2; lip 8 0 about 8 2, 10 2 about 8 2; side 10 12;
         neck 6 14 about 10 17; shank 6 40, 0 40",
        "lip side",
    ),
    // A stem with a skirt about it.
    (
        "Skirt",
        "0 0; face 3 0; under 3 10, 8 9, 7.5 4; lip 10 3.5; top 12 15, 4 18, 4 40, 0 40",
        "face lip",
    ),
    // An inclined web with a round rim, deepest on a circle.
    (
        "Torus",
        "0 1.2; web 8.4 0.8; low 10 0 about 10 2, 12 2 about 10 2;
         high 10 4 about 10 2, 8.4 3.2 about 10 2; top 0 2.8",
        "low",
    ),
    // An inclined web with a thick rim.
    (
        "Wheel",
        "0 1.3; web 8 1.5; low 9 0, 11 0, 12 1.5; high 12 2.5, 11 4, 9 4, 8 2.5; top 0 2.7",
        "low",
    ),
    // A hollow cone in the end of a rod.
    ("Dimple", "0 1; dimple 1 0; flute 1 20; top 0 20", "flute"),
];

/// The names of these tools that are compared with oracles.
pub(crate) const ALL: [&str; 6] = ["HoleSaw", "Dished", "Bell", "Skirt", "Torus", "Wheel"];

fn restated() -> [Restated; 7] {
    DRAWN.map(|(name, drawing, cutting)| Restated::drawn(name, drawing, &[]).cuts(cutting))
}

/// The tools, compiled from texts with the same numbers.
static TOOLS: LazyLock<[Interpreted; 7]> =
    LazyLock::new(|| restated().map(|tool| interpreted(&tool, "1")));

pub(crate) fn tool(name: &str) -> Option<&'static dyn Tool> {
    let found = TOOLS.iter().find(|tool| tool.info().name == name)?;
    Some(found)
}

pub(crate) fn oracle(name: &str) -> Option<Nearest> {
    restated().iter().find(|tool| tool.name == name).map(Nearest::new)
}

/// The triangle crosses the circles on which the rims are deepest. It is cut off where edges or meridian would be as
/// deep.
#[test]
fn a_rim_is_as_deep_as_its_circle() {
    let corners = [[9.4, 1.0, 1.4], [10.8, -0.6, 1.3], [9.6, -0.13, 3.1]];
    let far = [[90.0, 0.0, 0.0], [91.0, 0.0, 0.0], [90.0, 1.0, 0.0]];
    let part = soup(&[corners, far]);
    let pose = pose([0.0; 3], UP);
    for name in ["Torus", "Wheel"] {
        let oracle = oracle(name).expect("one of those above");
        let brute = BruteForce::new(&part, &oracle, 1.0);
        let sampled = brute.deepest(&brute.tool_frame(&pose), &mut Rng::new(1));
        let Interval { low, high } = certifier(&part, name).deepest(&pose, 0.0).depth;
        assert!(sampled <= high && low <= sampled + 1e-4, "{name}: {sampled} in {low}..{high}");
    }
}

/// Points above the tip of the cone are nearest to that tip, a corner on the axis.
#[test]
fn a_zone_of_a_corner_on_the_axis_is_found_inside() {
    let part = block([-30.0, -30.0, -40.0], [30.0, 30.0, 40.0]);
    for limit in [0.0, 0.5, 0.8, 0.9] {
        let unlimited = f64::INFINITY;
        let all = [("dimple", limit), ("flute", unlimited), ("top", unlimited)];
        let certifier = certifier(&part, "Dimple").with_allowances(all);
        let verdict = certifier.expect("surfaces").check_pose(&pose([0.0; 3], UP));
        assert_eq!(verdict, PoseVerdict::Inside(SurfaceId(0)), "{limit}");
    }
}
