//! Regions by hand beside a profile: they determine the evaluation, never the solid.

use super::outline::{Outline, P2};
use touchoff::Level;
use touchoff::tool::{Interpreted, Tool};
use touchoff_dsl::CheckedTool;
use touchoff_dsl::interpret::Interpreter;
use touchoff_dsl::source::Source;
use touchoff_tests::checks::assert_near;
use touchoff_tests::evaluations::{evaluate_points, of_reference};
use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::oracle::vector::{sub, unit};
use touchoff_tests::texts::{self, assert_mistakes};

const PROFILE: &str = "profile {
        start (0, 0);
        arc to (3, 3) center (0, 3) as ball cutting;
        line to (3, 10) as flute cutting;
        line to (3, 12), (6, 12), (6, 20), (0, 20) as shank;
    }";

const REGIONS: &str = "curve low = z - 1;
    region own as ball where low <= 0 { direction: (1, -2) allow oblique; magnitude: 2*depth; }
    region slope where low >= 0, z <= 3 { magnitude: 5 - d - z/10; niceness: depth/4 allow rising; }
    region law as flute where 3 <= z <= 8, d >= 1 { magnitude: 3*depth^1.5; }
    region away as flute where 3 <= z <= 8, d <= 1 { direction: away from (0, 20) allow oblique; niceness: 0.25; }
    region toward as shank where 8 <= z <= 13 { direction: toward (9, 20) allow oblique; }
    region rest where z >= 13 {}
    magnitude shank: 7*depth;
    niceness cutting: 1 - depth/6;
    niceness flute: 0.5;";

fn outline(down: bool) -> Outline {
    Outline { down, ..Outline::parse("0 0, 3 3 about 0 3, 3 10, 3 12, 6 12, 6 20, 0 20") }
}

fn text(down: bool, regions: &str) -> String {
    let frame = if down { "tip z = 20; spindle -z;" } else { "" };
    format!("tool T {{ units mm; {frame} {PROFILE} {regions} }}")
}

/// Returns the values of the table of the language: region, surface, magnitude, direction, niceness.
fn expected_evaluation(outline: &Outline, p: P2) -> (&'static str, &'static str, f64, P2, f64) {
    let near = outline.profile.nearest(&p);
    let (depth, nearest) = (near.distance, outline.profile.direction(near.feature, &p));
    let [d, z] = p;
    if z < 1.0 {
        ("own", "ball", 2.0 * depth, unit(&[1.0, -2.0]), 1.0 - depth / 6.0)
    } else if z < 3.0 {
        ("slope", "ball", 5.0 - d - z / 10.0, unit(&[1.0, 0.1]), depth / 4.0)
    } else if z < 8.0 && d > 1.0 {
        ("law", "flute", 3.0 * depth.powf(1.5), nearest, 0.5)
    } else if z < 8.0 {
        ("away", "flute", depth, unit(&sub(&p, &[0.0, 20.0])), 0.25)
    } else if z < 13.0 {
        ("toward", "shank", 7.0 * depth, unit(&sub(&[9.0, 20.0], &p)), 0.0)
    } else {
        ("rest", "shank", 7.0 * depth, nearest, 0.0)
    }
}

#[test]
fn each_region_has_the_tabulated_values() {
    for down in [false, true] {
        let text = text(down, REGIONS);
        let tool = texts::tool(text.as_str());
        let planned = Interpreted::parse(&Source::new("t.tool", text.as_str())).expect("the same");
        let outline = outline(down);
        let mut rng = Rng::new(31);
        for _ in 0..30_000 {
            let p = [rng.between(0.0, 7.0), rng.between(-1.0, 21.0)];
            let borders = [p[1] - 1.0, p[1] - 3.0, p[1] - 8.0, p[1] - 13.0, p[0] - 1.0];
            let depth = outline.profile.depth(&p).abs();
            if depth > 1e-9 && borders.iter().all(|border| border.abs() > 1e-9) {
                check_point(&tool, &planned, &outline, p);
            }
        }
        let names: std::collections::BTreeSet<&str> =
            tool.model.regions.iter().map(|region| region.name.as_str()).collect();
        assert_eq!(names.len(), 6, "{names:?}");
    }
}

fn check_point(tool: &CheckedTool, planned: &Interpreted, outline: &Outline, p: P2) {
    let [d, z] = outline.turned(p);
    let point = [d, 0.0, z];
    let found = evaluate_points(planned, Level::new(), &[point])[0];
    let reference = Interpreter::new(tool).evaluate(point, 1.0).map(of_reference);
    assert_eq!(reference, found, "at {p:?}");
    assert_eq!(reference.is_some(), outline.profile.encloses(&p), "at {p:?}");
    let depth = outline.profile.depth(&p).abs();
    let Some(evaluation) = reference else {
        return assert_near(planned.clearance(point), depth, 1e-12, p);
    };
    let (name, surface, magnitude, [e, f], niceness) = expected_evaluation(outline, p);
    let region = &tool.model.regions[evaluation.region];
    let found = (region.name.as_str(), tool.model.surfaces[region.surface].name.as_str());
    assert_eq!(found, (name, surface), "at {p:?}");
    let near = |a: f64, b: f64, what: &str| assert_near(a, b, 1e-11, (what, p, name));
    near(evaluation.depth, depth, "depth");
    near(evaluation.magnitude, magnitude, "magnitude");
    near(evaluation.niceness, niceness, "niceness");
    let f = if outline.down { -f } else { f };
    near(evaluation.direction[0], e, "radial part");
    near(evaluation.direction[1], 0.0, "part across");
    near(evaluation.direction[2], f, "axial part");
}

/// The gradient is the magnitude's slope.
#[test]
fn gradients_are_slopes() {
    let tool = texts::tool(text(false, REGIONS));
    let mut interpreter = Interpreter::new(&tool);
    let mut rng = Rng::new(32);
    for _ in 0..5_000 {
        let p = [rng.between(0.05, 6.0), 0.0, rng.between(0.0, 20.0)];
        let Some(evaluation) = interpreter.evaluate(p, 1.0) else { continue };
        let h = 1e-6;
        let slopes = [0, 1, 2].map(|k| {
            let ends = [h, -h].map(|h| {
                let mut q = p;
                q[k] += h;
                interpreter.evaluate(q, 1.0).filter(|other| other.region == evaluation.region)
            });
            ends[0].zip(ends[1]).map(|(a, b)| (a.magnitude - b.magnitude) / (2.0 * h))
        });
        if evaluation.depth > 1e-3 && slopes.iter().all(Option::is_some) {
            for (slope, part) in slopes.iter().zip(evaluation.gradient) {
                assert_near(slope.unwrap_or(f64::NAN), part, 1e-4, (p, evaluation));
            }
        }
    }
}

/// Regions beside the profile, words of the message, and the beginning of its place.
const MISTAKES: &str = "\
region low as ball where z <= 3 {} region high as shank where z >= 3 {}
region low as ball where z <= 3 {} region high as shank where z >= 4 {} => no region covers => profile
region low as ball where z <= 3 {} region high as shank where z >= 2 {} => regions low and high overlap => high
region low as ball where z <= 3 { depth: 3 - d; } region high as shank where z >= 3 {} => the profile already gives the depth => 3 - d
region low as ball where z <= 3 {} region high as shnak where z >= 3 {} => unknown surface `shnak` => shnak
region low as ball cutting where z <= 3 {} region high as shank where z >= 3 {} => the profile already tells which surfaces cut => cutting
region low as ball where z <= 3 {} region high as shank where z >= 3 {} region far where z >= 30 {} => region far contains no point => far
region low as ball where z <= 3 {} region high as shank where z >= 3 {} region never where z <= 1, z >= 2 {} => region never contains no point => never
region low as ball where z <= 3 {} region high as shank where z >= 3 {} region late where z >= 15 {} => region late has no points of its own: high, listed before it, covers it => late
region low as ball where z <= 3 {} region low as shank where z >= 3 {} => two regions are called `low` => low
region low as ball where z <= 3 { direction: (0, 0); } region high as shank where z >= 3 {} => the direction of low is the zero vector => direction: (0, 0)
region low as ball where z <= 3 {} region high as shank where z >= 3 { niceness: 1; } => is not marked `cutting` => 1
region low as ball where z <= 3 {} region high as shank where z >= 3 { magnitude: d - 1; } => `magnitude` of high is - => d - 1
region low as ball where z <= 3 {} region high as shank where z >= 3 {} regions nearest; => regions => regions nearest;";

#[test]
fn mistakes_of_regions_are_shown() {
    assert_mistakes(MISTAKES, |regions| text(false, regions));
}
