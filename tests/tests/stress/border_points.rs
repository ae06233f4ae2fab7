//! Items 1 and 2: points on borders, and one ulp beside them.
//!
//! A border is found where the truth in 256 bits goes from one owner to another, or from inside to outside: the two
//! adjacent doubles between which it does, along z and along d. Vertices and centres are added. On the border, the
//! contract is kept, the depth agrees with the depth of *each* neighbour, and the step of the depth from one double to
//! the other agrees with that of the truth.

use crate::prelude::*;
use crate::truth::to_exact;
use std::f64::consts::TAU;
use touchoff::tool::PointEvaluation;
use touchoff_tests::points::neighbourhood;

#[test]
fn points_on_borders_keep_the_contract() {
    check_tools(1, points_on_borders);
}

pub(crate) fn points_on_borders(subject: &Subject, rng: &mut Rng, checks: &mut Checks) {
    let validator = Validator::new(subject.tool, &*subject.truth);
    for bracket in brackets(subject, extent(1, 16), rng) {
        let evaluations = validator.validate(&bracket.ends, checks);
        let side = nearer_end(subject, &bracket);
        let p = bracket.ends[side];
        compare_neighbours(subject, p, evaluations[side].as_ref(), &bracket.owners, checks);
        compare_step(subject, &bracket, &evaluations, checks);
        validator.validate(&rotated_copies(subject, p, rng)[1..], checks);
    }
    for corner in subject.oracle.corner_points() {
        for p in rotated_copies(subject, corner, rng) {
            let evaluation = validator.validate(&[p], checks).swap_remove(0);
            compare_neighbours(subject, p, evaluation.as_ref(), &owners_at(subject, p), checks);
        }
    }
}

/// Returns the index of the bracket's end nearer to the border: there the depths of both sides differ less.
fn nearer_end(subject: &Subject, bracket: &Bracket) -> usize {
    let depth_difference = |p: [f64; 3]| {
        let depths = bracket.owners.map(|owner| region_depth(subject, p, owner));
        (&depths[0] - &depths[1]).abs()
    };
    usize::from(depth_difference(bracket.ends[1]) < depth_difference(bracket.ends[0]))
}

/// Returns the depth of a region at a point; outside it is 0.
fn region_depth(subject: &Subject, p: [f64; 3], owner: Option<usize>) -> Big {
    let values = owner.and_then(|region| subject.truth.region_values(&to_exact(p), region));
    values.map_or_else(Big::zero, |values| values.depth)
}

/// Returns all regions that own a point, to half an ulp(S).
pub(crate) fn owners_at(subject: &Subject, p: [f64; 3]) -> Vec<Option<usize>> {
    let at = to_exact(p);
    let owns = |region: &usize| {
        let values = subject.truth.region_values(&at, *region);
        values.is_some_and(|values| values.excess_distance <= subject.truth.ulp() / 2.0)
    };
    (0..subject.tool.info().regions.len()).filter(owns).map(Some).collect()
}

/// Compares a depth with the depth of each region that owns the point.
pub(crate) fn compare_neighbours(
    subject: &Subject,
    p: [f64; 3],
    evaluation: Option<&PointEvaluation>,
    owners: &[Option<usize>],
    checks: &mut Checks,
) {
    let Some(evaluation) = evaluation else { return };
    for owner in owners {
        let exact = region_depth(subject, p, *owner);
        let error = (&Big::exactly(evaluation.depth) - &exact).abs().to_f64() / subject.truth.ulp();
        let place = || format!("{p:?} of region {owner:?}");
        checks.within("depth of each neighbour [ulp(S)]", error, 1.0, place);
    }
}

/// Compares the change of the depth across a border with the true one.
fn compare_step(
    subject: &Subject,
    bracket: &Bracket,
    evaluations: &[Option<PointEvaluation>],
    checks: &mut Checks,
) {
    let [Some(a), Some(b)] = evaluations else { return };
    let exact = bracket.ends.map(|p| subject.truth.depth(&to_exact(p)));
    let step = &Big::exactly(a.depth) - &Big::exactly(b.depth);
    let error = (&step - &(&exact[0] - &exact[1])).abs().to_f64() / subject.truth.ulp();
    checks.within("step across [ulp(S)]", error, 1.0, || format!("{:?}", bracket.ends));
}

#[test]
fn points_one_ulp_beside_borders_keep_the_contract() {
    check_tools(2, |subject, rng, checks| {
        let validator = Validator::new(subject.tool, &*subject.truth);
        let mut centres: Vec<[f64; 3]> = subject.oracle.corner_points();
        let brackets = brackets(subject, extent(1, 16), rng);
        centres.extend(brackets.into_iter().flat_map(|bracket| bracket.ends));
        for centre in centres {
            let mut points = Vec::new();
            for [x, y, z] in neighbourhood(&*subject.oracle, centre) {
                if subject.oracle.is_revolved() {
                    let copies = rotated_copies(subject, [x.abs(), 0.0, z], rng);
                    points.push(copies[rng.index(copies.len())]);
                } else {
                    points.push([x, y, z]);
                }
            }
            validator.validate(&points, checks);
        }
    });
}

/// Two points whose coordinates are equal but for one, in which they are adjacent doubles.
struct Bracket {
    ends: [[f64; 3]; 2],
    /// The owners of the points, which differ; `None` outside.
    owners: [Option<usize>; 2],
}

/// Returns brackets along each splitting curve and each segment of the surface, at about `max_points` of its points.
fn brackets(subject: &Subject, max_points: usize, rng: &mut Rng) -> Vec<Bracket> {
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
fn rotated_copies(subject: &Subject, p: [f64; 3], rng: &mut Rng) -> Vec<[f64; 3]> {
    if !subject.oracle.is_revolved() {
        return vec![p];
    }
    let [d, _, z] = p;
    let (sin, cos) = rng.between(0.0, TAU).sin_cos();
    vec![p, [0.0, -d, z], [d * cos, d * sin, z]]
}
