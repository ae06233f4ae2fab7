//! Borders of regions and of the solid: adjacent doubles with different owners according to 256 bits.

use crate::truth::{Subject, to_exact};
use std::f64::consts::TAU;
use touchoff_tests::oracle::rng::Rng;

/// Two points whose coordinates are equal but for one, in which they are adjacent doubles.
pub(crate) struct Bracket {
    pub(crate) ends: [[f64; 3]; 2],
    /// The owners of the points, which differ; `None` outside.
    pub(crate) owners: [Option<usize>; 2],
}

/// Returns brackets along each splitting curve and each segment of the surface, at about `max_points` of its points.
pub(crate) fn brackets(subject: &Subject, max_points: usize, rng: &mut Rng) -> Vec<Bracket> {
    let axes: &[usize] = if subject.oracle.is_revolved() { &[2, 0] } else { &[2, 0, 1] };
    let mut brackets = Vec::new();
    for curve in subject.oracle.curve_points() {
        let step = curve.len().div_ceil(max_points).max(1);
        let first = rng.bits() as usize % step;
        for p in curve.iter().skip(first).step_by(step) {
            brackets.extend(axes.iter().filter_map(|axis| bracket_at(subject, *p, *axis)));
        }
    }
    brackets
}

/// Returns the border that a coordinate line crosses at a point or within 1e-6 of the tool's size.
fn bracket_at(subject: &Subject, p: [f64; 3], axis: usize) -> Option<Bracket> {
    let point = |value: f64| {
        let mut p = p;
        p[axis] = value;
        p
    };
    let owner = |value: f64| subject.truth.owner(&to_exact(point(value)));
    let coordinate = p[axis];
    let adjacent = [[coordinate.next_down(), coordinate], [coordinate, coordinate.next_up()]];
    let reaches = [1e-9, 1e-6].map(|fraction| fraction * subject.scale());
    let intervals = reaches.map(|reach| [coordinate - reach, coordinate + reach]);
    // A distance from the axis cannot be negative.
    let lowest = if subject.oracle.is_revolved() && axis == 0 { 0.0 } else { f64::NEG_INFINITY };
    let mut intervals = adjacent.into_iter().chain(intervals).filter(|ends| ends[0] >= lowest);
    let ends = intervals.find(|ends| owner(ends[0]) != owner(ends[1]))?;
    let ends = bisect(ends, owner)?;
    Some(Bracket { ends: ends.map(point), owners: ends.map(owner) })
}

/// Bisects an interval until its ends are adjacent doubles. Toward 0 that would take a thousand steps. Such an interval
/// is given up, since 0 itself was tried.
fn bisect([mut a, mut b]: [f64; 2], owner: impl Fn(f64) -> Option<usize>) -> Option<[f64; 2]> {
    let first = owner(a);
    for _ in 0..80 {
        let midpoint = a + (b - a) / 2.0;
        if midpoint <= a || midpoint >= b {
            return Some([a, b]);
        }
        if owner(midpoint) == first { a = midpoint } else { b = midpoint }
    }
    None
}

/// Returns the rotations about z of a point in the half plane y = 0: onto x and y exactly, and by a random angle. A
/// point of a solid without rotational symmetry is returned unchanged.
pub(crate) fn rotated_copies(subject: &Subject, p: [f64; 3], rng: &mut Rng) -> Vec<[f64; 3]> {
    if !subject.oracle.is_revolved() {
        return vec![p];
    }
    let [d, _, z] = p;
    let (sin, cos) = rng.between(0.0, TAU).sin_cos();
    vec![p, [0.0, -d, z], [d * cos, d * sin, z]]
}
