//! Artificial tools of many regions: the plan finds the owner that the list of regions has, however the regions
//! lie.

use crate::prelude::*;
use touchoff_dsl::interpret::Interpreter;
use touchoff_dsl::source::Source;
use touchoff_tests::evaluations::evaluate_points;

/// Returns a rod of radius 5 from z = 0 to 20 with these regions, which all have the same depth and direction.
fn rod(curves: &str, conditions: impl IntoIterator<Item = String>) -> Source {
    let mut text = format!("tool Rod {{ units mm; {curves}\n");
    for (k, condition) in conditions.into_iter().enumerate() {
        text += &format!("region r{k} where d <= 5, 0 <= z <= 20, {condition} ");
        text += "{ depth: min(5 - d, min(z, 20 - z)); direction: (1, 0) allow oblique; }\n";
    }
    Source::new("rod", text + "}")
}

/// Compares the plan's owners with the list's.
fn agree(source: &Source) {
    let (checked, loaded) = (super::checked(source), super::interpreted(source));
    let mut reference = Interpreter::new(&checked);
    let mut rng = Rng::new(9);
    let mut points = Vec::new();
    for _ in 0..20_000 {
        let mut across = || rng.between(-5.5, 5.5);
        points.push([across(), across(), rng.between(-1.0, 21.0)]);
    }
    let evaluations = evaluate_points(&loaded, Level::baseline(), &points);
    for (p, evaluation) in points.iter().zip(evaluations) {
        let expected = reference.evaluate(*p, 1.0).map(|evaluation| evaluation.region);
        let found = evaluation.map(|evaluation| evaluation.region);
        assert_eq!(found, expected, "{p:?} of {}", source.text);
    }
}

#[test]
fn slabs() {
    agree(&rod(
        "",
        (0..40).map(|k| format!("{} <= z <= {}", k as f64 / 2.0, (k + 1) as f64 / 2.0)),
    ));
}

#[test]
fn a_grid() {
    let cells = (0..5).flat_map(|i| (0..8).map(move |k| (i, k)));
    agree(&rod(
        "",
        cells.map(|(i, k)| {
            let (low, high) = (2.5 * f64::from(k), 2.5 * f64::from(k + 1));
            format!("{i} <= d <= {}, {low} <= z <= {high}", i + 1)
        }),
    ));
}

#[test]
fn shells() {
    agree(&rod("", (0..16).map(|k| format!("{k} <= hypot(d, z - 5) <= {}", k + 1))));
}

/// The nearest of some corners: every pair of regions has a curve of its own.
#[test]
fn nearest_corners() {
    const CORNERS: usize = 9;
    let curves: String = (0..CORNERS)
        .map(|k| {
            let (d, z) = (1.0 + (k * 7 % 11) as f64 * 0.3, 1.0 + 2.0 * k as f64);
            format!("curve p{k} = hypot(d - {d}, z - {z}); ")
        })
        .collect();
    let nearest = |k: usize| {
        let others = (0..CORNERS).filter(|j| *j != k);
        others.map(|j| format!("p{k} <= p{j}")).collect::<Vec<_>>().join(", ")
    };
    agree(&rod(&curves, (0..CORNERS).map(nearest)));
}
