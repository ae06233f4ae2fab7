//! Borders of regions and of the solid: adjacent doubles on different sides of a surface or a splitting curve,
//! according to the 256-bit reference.

use super::truth::{Place, Subject, place};
use touchoff_tests::oracle::draw::Rng;

/// Two adjacent doubles along one coordinate, with different owners.
pub(super) struct Bracket {
    /// The two points.
    pub ends: [[f64; 3]; 2],
    /// Their owners; `None` outside.
    pub owners: [Option<usize>; 2],
}

/// Returns brackets along each splitting curve and each segment of the surface, at about `most` of its points.
pub(super) fn brackets(subject: &Subject, most: usize, draw: &mut Rng) -> Vec<Bracket> {
    let mut found = Vec::new();
    for curve in subject.oracle.curve_points() {
        let step = curve.len().div_ceil(most).max(1);
        let first = draw.bits() as usize % step;
        for p in curve.iter().skip(first).step_by(step) {
            let axes: &[usize] = if subject.oracle.revolved() { &[2, 0] } else { &[2, 0, 1] };
            found.extend(axes.iter().filter_map(|axis| across(subject, *p, *axis)));
        }
    }
    found
}

/// Returns the border that a coordinate line crosses at a point or within 1e-6 of the tool's size.
fn across(subject: &Subject, p: [f64; 3], axis: usize) -> Option<Bracket> {
    let owner = |at: f64| {
        let mut p = p;
        p[axis] = at;
        // A distance from the axis cannot be negative.
        let beyond = subject.oracle.revolved() && axis == 0 && at < 0.0;
        (!beyond).then(|| subject.truth.owner(&place(p)))
    };
    let here = p[axis];
    let exactly = [[here.next_down(), here], [here, here.next_up()]];
    let near = [1e-9, 1e-6].map(|part| part * subject.scale());
    let near = near.map(|reach| [here - reach, here + reach]);
    for ends in exactly.into_iter().chain(near) {
        let (Some(first), Some(last)) = (owner(ends[0]), owner(ends[1])) else { continue };
        if first != last {
            return narrowed(ends, first, &|at| owner(at).flatten()).map(|(ends, owners)| {
                let point = |at: f64| {
                    let mut p = p;
                    p[axis] = at;
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
fn narrowed(
    [mut a, mut b]: [f64; 2],
    first: Option<usize>,
    owner: &dyn Fn(f64) -> Option<usize>,
) -> Option<([f64; 2], [Option<usize>; 2])> {
    for _ in 0..80 {
        let middle = a + (b - a) / 2.0;
        if middle <= a || middle >= b {
            return Some(([a, b], [first, owner(b)]));
        }
        if owner(middle) == first { a = middle } else { b = middle }
    }
    None
}

/// Returns the rotations about z of a point in the half plane y = 0: onto x and y exactly, and by a random angle. A
/// point of a solid without rotational symmetry is returned unchanged.
pub(super) fn turned(subject: &Subject, p: [f64; 3], draw: &mut Rng) -> Vec<[f64; 3]> {
    if !subject.oracle.revolved() {
        return vec![p];
    }
    let [d, _, z] = p;
    let (sin, cos) = draw.between(0.0, std::f64::consts::TAU).sin_cos();
    vec![p, [0.0, -d, z], [d * cos, d * sin, z]]
}

/// Returns whether a point lies exactly on the border of two regions: their depths agree to 1e-60 of the tool's size.
/// The depth outside is 0.
pub(super) fn exact(subject: &Subject, p: [f64; 3], owners: [Option<usize>; 2]) -> bool {
    let at: Place = place(p);
    let depths = owners.map(|owner| match owner {
        Some(region) => subject.truth.claim(&at, region).map(|claim| claim.depth),
        None => Some(touchoff_tests::oracle::big::Big::zero()),
    });
    match depths {
        [Some(a), Some(b)] => (&a - &b).abs().to_f64() <= 1e-60 * subject.scale(),
        _ => false,
    }
}
