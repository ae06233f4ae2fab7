//! Tools with overhanging profiles, and their oracles, written separately.

use crate::{UP, block, pose, soup};
use nalgebra::Point3;
use std::sync::LazyLock;
use touchoff::certify::{Certifier, PoseVerdict, TriangleBvh};
use touchoff::tool::Interpreted;
use touchoff::{Interval, SurfaceId, Tool};
use touchoff_tests::oracle::restated::Restated;
use touchoff_tests::oracle::{Nearest, Oracle};

/// The texts of the tools.
const TEXTS: [&str; 7] = [
    r#"tool HoleSaw "38 mm, 12 mm deep" {
    units mm;
    profile {
        start (0, 12);
        line to (16, 12), (16, 0) as cup;
        line to (19, 0) as teeth cutting;
        line to (19, 18), (5, 18), (5, 45), (0, 45) as body;
    }
    niceness teeth: 1;
}"#,
    r#"tool Dished "a dovetail whose face is dished by 0.2 mm" {
    units mm;
    profile {
        start (0, 0.2);
        line to (8, 0) as face cutting;
        line to (5, 6) as flank cutting;
        line to (4, 7), (4, 40), (0, 40) as shank;
    }
    niceness face: 1;
    niceness flank: 1;
}"#,
    r#"tool Bell "hollow and round arcs on both sides" {
    units mm;
    profile {
        start (0, 8);
        arc to (6, 2) center (0, 2) concave as dome;
        arc to (8, 0) center (8, 2) as lip cutting;
        arc to (10, 2) center (8, 2) as lip cutting;
        line to (10, 12) as side cutting;
        arc to (6, 14) center (10, 17) concave as neck;
        line to (6, 40), (0, 40) as shank;
    }
    niceness lip: 1;
    niceness side: 1;
}"#,
    r#"tool Skirt "a stem with a skirt about it" {
    units mm;
    profile {
        start (0, 0);
        line to (3, 0) as face cutting;
        line to (3, 10), (8, 9), (7.5, 4) as under;
        line to (10, 3.5) as lip cutting;
        line to (12, 15), (4, 18), (4, 40), (0, 40) as top;
    }
    niceness face: 1;
    niceness lip: 1;
}"#,
    r#"tool Torus "an inclined web with a round rim, deepest on a circle" {
    units mm;
    profile {
        start (0, 1.2);
        line to (8.4, 0.8) as web;
        arc to (10, 0) center (10, 2) as low cutting;
        arc to (12, 2) center (10, 2) as low cutting;
        arc to (10, 4) center (10, 2) as high;
        arc to (8.4, 3.2) center (10, 2) as high;
        line to (0, 2.8) as top;
    }
    niceness low: 1;
}"#,
    r#"tool Wheel "an inclined web with a thick rim" {
    units mm;
    profile {
        start (0, 1.3);
        line to (8, 1.5) as web;
        line to (9, 0), (11, 0), (12, 1.5) as low cutting;
        line to (12, 2.5), (11, 4), (9, 4), (8, 2.5) as high;
        line to (0, 2.7) as top;
    }
    niceness low: 1;
}"#,
    r#"tool Dimple "a hollow cone in the end of a rod" {
    units mm;
    profile {
        start (0, 1);
        line to (1, 0) as dimple;
        line to (1, 20) as flute cutting;
        line to (0, 20) as top;
    }
    niceness flute: 1;
}"#,
];

/// The names of these tools that are compared with oracles.
pub(crate) const ALL: [&str; 6] = ["HoleSaw", "Dished", "Bell", "Skirt", "Torus", "Wheel"];

static TOOLS: LazyLock<[Interpreted; 7]> =
    LazyLock::new(|| TEXTS.map(|text| text.parse().expect("a tool")));

/// Returns one of these tools.
pub(crate) fn tool(name: &str) -> Option<&'static dyn Tool> {
    let found = TOOLS.iter().find(|tool| tool.info().name == name)?;
    Some(found)
}

/// Returns the oracle of one of these tools, from the dimensions of its drawing.
pub(crate) fn oracle(name: &str) -> Option<Nearest> {
    let tool = match name {
        "HoleSaw" => Restated::new("HoleSaw", 12.0)
            .lines("cup", &[[16.0, 12.0], [16.0, 0.0]])
            .line("teeth", 19.0, 0.0)
            .lines("body", &[[19.0, 18.0], [5.0, 18.0], [5.0, 45.0], [0.0, 45.0]])
            .cuts(&["teeth"], |_, _, _| 1.0),
        "Dished" => Restated::new("Dished", 0.2)
            .line("face", 8.0, 0.0)
            .line("flank", 5.0, 6.0)
            .lines("shank", &[[4.0, 7.0], [4.0, 40.0], [0.0, 40.0]])
            .cuts(&["face", "flank"], |_, _, _| 1.0),
        "Bell" => Restated::new("Bell", 8.0)
            .arc("dome", [6.0, 2.0], [0.0, 2.0])
            .arc("lip", [8.0, 0.0], [8.0, 2.0])
            .arc("lip", [10.0, 2.0], [8.0, 2.0])
            .line("side", 10.0, 12.0)
            .arc("neck", [6.0, 14.0], [10.0, 17.0])
            .lines("shank", &[[6.0, 40.0], [0.0, 40.0]])
            .cuts(&["lip", "side"], |_, _, _| 1.0),
        "Skirt" => Restated::new("Skirt", 0.0)
            .line("face", 3.0, 0.0)
            .lines("under", &[[3.0, 10.0], [8.0, 9.0], [7.5, 4.0]])
            .line("lip", 10.0, 3.5)
            .lines("top", &[[12.0, 15.0], [4.0, 18.0], [4.0, 40.0], [0.0, 40.0]])
            .cuts(&["face", "lip"], |_, _, _| 1.0),
        "Torus" => Restated::new("Torus", 1.2)
            .line("web", 8.4, 0.8)
            .arc("low", [10.0, 0.0], [10.0, 2.0])
            .arc("low", [12.0, 2.0], [10.0, 2.0])
            .arc("high", [10.0, 4.0], [10.0, 2.0])
            .arc("high", [8.4, 3.2], [10.0, 2.0])
            .line("top", 0.0, 2.8)
            .cuts(&["low"], |_, _, _| 1.0),
        "Wheel" => Restated::new("Wheel", 1.3)
            .line("web", 8.0, 1.5)
            .lines("low", &[[9.0, 0.0], [11.0, 0.0], [12.0, 1.5]])
            .lines("high", &[[12.0, 2.5], [11.0, 4.0], [9.0, 4.0], [8.0, 2.5]])
            .line("top", 0.0, 2.7)
            .cuts(&["low"], |_, _, _| 1.0),
        _ => return None,
    };
    Some(Nearest::new(&tool))
}

/// The triangle crosses the circles on which the rims are deepest. It is cut off where edges or meridian would be as
/// deep.
#[test]
fn a_rim_is_as_deep_as_its_circle() {
    let corners = [[9.4, 1.0, 1.4], [10.8, -0.6, 1.3], [9.6, -0.13, 3.1]];
    let far = [[90.0, 0.0, 0.0], [91.0, 0.0, 0.0], [90.0, 1.0, 0.0]];
    let bvh = TriangleBvh::new(&soup(&[corners, far]));
    let pose = pose([0.0; 3], UP);
    for name in ["Torus", "Wheel"] {
        let oracle = oracle(name).expect("one of those above");
        let [a, b, c] = corners.map(Point3::from);
        // About 30,000 points, at most 0.01 apart.
        let samples = (0..=250).flat_map(|i| (0..=250 - i).map(move |j| (i, j)));
        let depth = |(i, j): (i32, i32)| {
            let p = a + (b - a) * (f64::from(i) / 250.0) + (c - a) * (f64::from(j) / 250.0);
            oracle.evaluate(p.into()).map_or(0.0, |evaluation| evaluation.depth)
        };
        let sampled = samples.map(depth).fold(0.0, f64::max);
        let Interval { low, high } =
            Certifier::new(&bvh, tool(name).expect("it")).expect("it").deepest(&pose, 0.0).depth;
        assert!(sampled <= high && low <= sampled + 0.01, "{name}: {sampled} in {low}..{high}");
    }
}

/// Points above the tip of the cone are nearest to that tip, a corner on the axis.
#[test]
fn a_zone_of_a_corner_on_the_axis_is_found_inside() {
    let bvh = TriangleBvh::new(&block([-30.0, -30.0, -40.0], [30.0, 30.0, 40.0]));
    for limit in [0.0, 0.5, 0.8, 0.9] {
        let mut certifier = Certifier::new(&bvh, tool("Dimple").expect("it")).expect("a profile");
        let unlimited = f64::INFINITY;
        for (surface, limit) in [("dimple", limit), ("flute", unlimited), ("top", unlimited)] {
            certifier = certifier.with_allowance(surface, limit).expect("a surface");
        }
        let verdict = certifier.check_pose(&pose([0.0; 3], UP));
        assert_eq!(verdict, PoseVerdict::Inside(SurfaceId(0)), "{limit}");
    }
}
