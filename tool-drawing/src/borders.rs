//! Borders between owners: the polygons of the section are welded to a planar map, and its lines are traced with the
//! owners on both sides.

use super::curves::Curves;
use super::map::{Edge, edges};
use super::section::Piece;
use super::stroke::{Stroke, fitted, round};
use std::collections::BTreeMap;
use tool_dsl::formula::CurveIndex;
use tool_dsl::vector::{Point, minus, norm};

/// The area on one side of a border.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Side {
    /// A region, by its index.
    Region(usize),
    /// Outside the tool.
    Outside,
    /// The mirror image, across the axis.
    Axis,
    /// The rest of the section, beyond the divided window.
    Beyond,
}

/// A line between two joints of the map, with the same owners on both sides all along.
#[derive(Clone, Debug)]
pub(super) struct Border {
    /// Indices of the joints at its ends.
    pub(super) ends: [usize; 2],
    /// The areas on its left and its right. A region is on the left; of two regions, the one listed first.
    pub(super) sides: [Side; 2],
    /// Its geometry, as lines and arcs.
    pub(super) strokes: Vec<Stroke>,
    /// True if its arcs are exact, rather than approximations below the visible tolerance.
    pub(super) exact: bool,
}

/// Length tolerances of the map, in the tool's unit: `weld` merges corners, `visible_length` is the visible accuracy.
#[derive(Clone, Copy)]
pub(super) struct Nearness {
    pub(super) weld: f64,
    pub(super) visible_length: f64,
    /// The largest distance of a corner from the intersection of its curves.
    pub(super) reach: f64,
}

/// Finds the borders between polygons.
pub(super) fn borders(curves: &mut Curves<'_>, pieces: &[Piece], near: Nearness) -> Vec<Border> {
    let (mut points, mut edges) = edges(pieces, near);
    let mut chains = chains(&edges, points.len());
    contract(&mut edges, &mut chains, &points, 0.2 * near.visible_length);
    polish(curves, &edges, &chains, &mut points, near.reach);
    chains.iter().map(|chain| border(curves, &edges, chain, &points, near)).collect()
}

/// Returns the edges as chains, each from one joint to the next.
fn chains(edges: &[Edge], corners: usize) -> Vec<Vec<usize>> {
    let mut leaving: Vec<Vec<usize>> = vec![Vec::new(); corners];
    let mut coming: Vec<Vec<usize>> = vec![Vec::new(); corners];
    for (index, edge) in edges.iter().enumerate() {
        leaving[edge.ends[0]].push(index);
        coming[edge.ends[1]].push(index);
    }
    let next = |index: usize| {
        let corner = edges[index].ends[1];
        let ([after], [_]) = (leaving[corner].as_slice(), coming[corner].as_slice()) else {
            return None;
        };
        let (a, b) = (&edges[index], &edges[*after]);
        (a.sides == b.sides && a.curve == b.curve).then_some(*after)
    };
    let followed: Vec<bool> = {
        let mut followed = vec![false; edges.len()];
        (0..edges.len()).filter_map(next).for_each(|after| followed[after] = true);
        followed
    };
    let mut taken = vec![false; edges.len()];
    let mut chains = Vec::new();
    // Chains that begin at a joint come first, closed loops last.
    let starts = (0..edges.len()).filter(|index| !followed[*index]).chain(0..edges.len());
    for start in starts.collect::<Vec<_>>() {
        if taken[start] {
            continue;
        }
        let mut chain = vec![start];
        taken[start] = true;
        while let Some(after) = chain.last().and_then(|last| next(*last)) {
            if taken[after] {
                break;
            }
            taken[after] = true;
            chain.push(after);
        }
        chains.push(chain);
    }
    chains
}

/// Contracts chains that are too short to see: where several bent curves meet in a point, their chords leave a speck.
fn contract(edges: &mut [Edge], chains: &mut Vec<Vec<usize>>, points: &[Point], speck: f64) {
    let mut joint: Vec<usize> = (0..points.len()).collect();
    chains.retain(|chain| {
        let length = |index: &usize| {
            let [from, to] = edges[*index].ends;
            norm(minus(points[to], points[from]))
        };
        if chain.iter().map(length).sum::<f64>() >= speck {
            return true;
        }
        let [from, to] = ends(edges, chain).map(|end| joint[end]);
        joint.iter_mut().filter(|other| **other == from).for_each(|other| *other = to);
        false
    });
    for chain in chains {
        let (first, last) = (chain[0], chain[chain.len() - 1]);
        edges[first].ends[0] = joint[edges[first].ends[0]];
        edges[last].ends[1] = joint[edges[last].ends[1]];
    }
}

/// Returns the joints at the ends of a chain.
fn ends(edges: &[Edge], chain: &[usize]) -> [usize; 2] {
    [edges[chain[0]].ends[0], edges[chain[chain.len() - 1]].ends[1]]
}

/// Moves the joints to the exact intersections of their curves.
fn polish(
    curves: &mut Curves<'_>,
    edges: &[Edge],
    chains: &[Vec<usize>],
    points: &mut [Point],
    reach: f64,
) {
    let mut meeting: BTreeMap<usize, Vec<Option<CurveIndex>>> = BTreeMap::new();
    for chain in chains {
        let (first, last) = (edges[chain[0]], edges[chain[chain.len() - 1]]);
        for (edge, joint) in [(first, first.ends[0]), (last, last.ends[1])] {
            let constraint = match (edge.sides[1], edge.curve) {
                (Side::Axis, _) => None,
                (_, Some(curve)) => Some(curve),
                _ => continue,
            };
            let known = meeting.entry(joint).or_default();
            if !known.contains(&constraint) {
                known.push(constraint);
            }
        }
    }
    for (joint, constraints) in meeting {
        let mut best: Option<(f64, Point)> = None;
        for (k, a) in constraints.iter().enumerate() {
            for b in &constraints[k + 1..] {
                if let Some(found) = curves.meet([*a, *b], points[joint], reach)
                    && best.is_none_or(|(square, _)| found.0 > square + 1e-9)
                {
                    best = Some(found);
                }
            }
        }
        if let Some((_, p)) = best {
            points[joint] = p;
        }
    }
}

/// Returns the border along a chain of edges.
fn border(
    curves: &mut Curves<'_>,
    edges: &[Edge],
    chain: &[usize],
    points: &[Point],
    near: Nearness,
) -> Border {
    let first = edges[chain[0]];
    let ends = ends(edges, chain);
    let mut row: Vec<Point> = vec![points[ends[0]]];
    row.extend(chain.iter().map(|index| points[edges[*index].ends[1]]));
    let straight =
        first.sides[1] == Side::Axis || first.curve.is_some_and(|curve| curves.straight(curve));
    let (strokes, exact) = if straight && ends[0] != ends[1] {
        (vec![Stroke::line(row[0], row[row.len() - 1])], true)
    } else {
        let foot = |p: Point| match first.curve {
            Some(curve) => curves.foot(curve, p, near.reach),
            None => p,
        };
        match round(&row, foot, near.weld) {
            Some(strokes) => (strokes, true),
            None => (fitted(&row, near.visible_length), false),
        }
    };
    Border { ends, sides: first.sides, strokes, exact }
}
