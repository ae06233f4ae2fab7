//! Borders of regions and of the solid: adjacent doubles on different sides of a surface or a splitting curve,
//! according to the 256-bit reference.

use super::truth::{ExactPoint, Subject, to_exact};
use touchoff_tests::oracle::rng::Rng;

/// Two adjacent doubles along one coordinate, with different owners.
pub(super) struct Bracket {
    /// The two points.
    pub ends: [[f64; 3]; 2],
    /// Their owners; `None` outside.
    pub owners: [Option<usize>; 2],
}

/// Returns brackets along each splitting curve and each segment of the surface, at about
/// `max_points` of its points.
pub(super) fn brackets(subject: &Subject, max_points: usize, rng: &mut Rng) -> Vec<Bracket> {
    let mut brackets = Vec::new();
    for curve in subject.oracle.curve_points() {
        let step = curve.len().div_ceil(max_points).max(1);
        let first = rng.bits() as usize % step;
        for p in curve.iter().skip(first).step_by(step) {
            let axes: &[usize] = if subject.oracle.is_revolved() { &[2, 0] } else { &[2, 0, 1] };
            brackets.extend(axes.iter().filter_map(|axis| bracket_at(subject, *p, *axis)));
        }
    }
    brackets
}

/// Returns the border that a coordinate line crosses at a point or within 1e-6 of the tool's size.
fn bracket_at(subject: &Subject, p: [f64; 3], axis: usize) -> Option<Bracket> {
    let owner = |value: f64| {
        let mut p = p;
        p[axis] = value;
        // A distance from the axis cannot be negative.
        let is_negative_distance = subject.oracle.is_revolved() && axis == 0 && value < 0.0;
        (!is_negative_distance).then(|| subject.truth.owner(&to_exact(p)))
    };
    let coordinate = p[axis];
    let adjacent = [[coordinate.next_down(), coordinate], [coordinate, coordinate.next_up()]];
    let intervals = [1e-9, 1e-6].map(|fraction| fraction * subject.scale());
    let intervals = intervals.map(|reach| [coordinate - reach, coordinate + reach]);
    for ends in adjacent.into_iter().chain(intervals) {
        let (Some(first), Some(last)) = (owner(ends[0]), owner(ends[1])) else { continue };
        if first != last {
            return bisect(ends, first, &|value| owner(value).flatten()).map(|(ends, owners)| {
                let point = |value: f64| {
                    let mut p = p;
                    p[axis] = value;
                    p
                };
                Bracket { ends: ends.map(point), owners }
            });
        }
    }
    None
}

/// Bisects an interval until its ends are adjacent doubles. Toward 0 that would take a thousand steps. Such an interval
/// is given up, since 0 itself was tried.
fn bisect(
    [mut a, mut b]: [f64; 2],
    first: Option<usize>,
    owner: &dyn Fn(f64) -> Option<usize>,
) -> Option<([f64; 2], [Option<usize>; 2])> {
    for _ in 0..80 {
        let midpoint = a + (b - a) / 2.0;
        if midpoint <= a || midpoint >= b {
            return Some(([a, b], [first, owner(b)]));
        }
        if owner(midpoint) == first { a = midpoint } else { b = midpoint }
    }
    None
}

/// Returns the rotations about z of a point in the half plane y = 0: onto x and y exactly, and by a random angle. A
/// point of a solid without rotational symmetry is returned unchanged.
pub(super) fn rotated_copies(subject: &Subject, p: [f64; 3], rng: &mut Rng) -> Vec<[f64; 3]> {
    if !subject.oracle.is_revolved() {
        return vec![p];
    }
    let [d, _, z] = p;
    let (sin, cos) = rng.between(0.0, std::f64::consts::TAU).sin_cos();
    vec![p, [0.0, -d, z], [d * cos, d * sin, z]]
}

/// Returns whether a point lies exactly on the border of two regions: their depths agree to 1e-60 of the tool's size.
/// The depth outside is 0.
pub(super) fn is_exact(subject: &Subject, p: [f64; 3], owners: [Option<usize>; 2]) -> bool {
    let exact_point: ExactPoint = to_exact(p);
    let depths = owners.map(|owner| match owner {
        Some(region) => subject.truth.region_values(&exact_point, region).map(|claim| claim.depth),
        None => Some(touchoff_tests::oracle::big::Big::zero()),
    });
    match depths {
        [Some(a), Some(b)] => (&a - &b).abs().to_f64() <= 1e-60 * subject.scale(),
        _ => false,
    }
}
