//! Borders between owners: the polygons of the section are welded to a planar map, and its lines are traced with the
//! owners on both sides.

use super::curves::Curves;
use super::section::Piece;
use super::stroke::{Stroke, fitted, round};
use std::collections::{BTreeMap, HashMap};
use touchoff_dsl::formula::CurveIndex;
use touchoff_dsl::vector::{Point, cross, minus, norm};

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
    // First, so that a joint knows the curves on both sides of a speck.
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
        // A joint of more than two borders ends the chain.
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
            // A closed loop has come back to its start.
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
        let lengths = chain.iter().map(|index| {
            let [from, to] = edges[*index].ends;
            norm(minus(points[to], points[from]))
        });
        if lengths.sum::<f64>() >= speck {
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
                // The axis is a constraint like a curve.
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
    // Corners between the ends are on the line, apart from rounding.
    let straight =
        first.sides[1] == Side::Axis || first.curve.is_some_and(|curve| curves.straight(curve));
    let (strokes, exact) = if straight && ends[0] != ends[1] {
        (vec![Stroke::line(row[0], row[row.len() - 1])], true)
    } else {
        let arcs = round(
            &row,
            |p| first.curve.map_or(p, |curve| curves.foot(curve, p, near.reach)),
            near.weld,
        );
        match arcs {
            Some(strokes) => (strokes, true),
            None => (fitted(&row, near.visible_length), false),
        }
    };
    Border { ends, sides: first.sides, strokes, exact }
}

/// A part of a border, from one welded corner to another.
#[derive(Clone, Copy, Debug)]
struct Edge {
    ends: [usize; 2],
    sides: [Side; 2],
    curve: Option<CurveIndex>,
}

/// A side of a polygon: the polygon's index, and the side's curve.
type Half = (usize, Option<CurveIndex>);
/// Sides by their corner indices, smaller index first: the polygon on the left and the one on the right of that
/// direction.
type Halves = HashMap<[usize; 2], [Option<Half>; 2]>;

/// Returns the welded corners, and the edges between two owners.
fn edges(pieces: &[Piece], near: Nearness) -> (Vec<Point>, Vec<Edge>) {
    let mut weld = Weld { near: near.weld, points: Vec::new(), buckets: HashMap::new() };
    let mut halves = Halves::new();
    for (index, piece) in pieces.iter().enumerate() {
        for (from, to, curve) in weld.edges_of_piece(piece) {
            // Both polygons of a side find the same entry, whatever their direction.
            let (key, side_index) = if from < to { ([from, to], 0) } else { ([to, from], 1) };
            halves.entry(key).or_default()[side_index].get_or_insert((index, curve));
        }
    }
    let mut points = weld.points;
    matched(&mut halves, &points);
    // Any of several welded corners may have come first, so corners near the axis are moved onto it.
    points.iter_mut().filter(|p| p[0].abs() <= near.weld).for_each(|p| p[0] = 0.0);
    let owners = without_specks(pieces, &halves, &points, near.visible_length);
    let mut edges = Vec::new();
    for (ends, pair) in halves {
        if pair[0].map(|half| owners[half.0]) == pair[1].map(|half| owners[half.0]) {
            continue;
        }
        let on_axis = ends.iter().all(|end| points[*end][0] == 0.0);
        let [left, right] = pair.map(|half| match half.map(|(piece, _)| owners[piece]) {
            Some(Some(region)) => Side::Region(region),
            Some(None) => Side::Outside,
            None if on_axis => Side::Axis,
            None => Side::Beyond,
        });
        let inside = matches!(left, Side::Region(_)) || matches!(right, Side::Region(_));
        if inside {
            let curve = pair.iter().find_map(|half| half.and_then(|(_, curve)| curve));
            edges.push(if left < right {
                Edge { ends, sides: [left, right], curve }
            } else {
                Edge { ends: [ends[1], ends[0]], sides: [right, left], curve }
            });
        }
    }
    // The iteration order of a hash map varies.
    edges.sort_unstable_by_key(|edge| edge.ends);
    (points, edges)
}

/// Splits sides of cells that are divided on one side only, where the other cell did not need the division. Afterwards
/// each side has its counterpart.
fn matched(halves: &mut Halves, points: &[Point]) {
    let mut lone: Vec<[usize; 2]> = halves
        .iter()
        .filter(|(_, pair)| pair.iter().any(Option::is_none))
        .map(|(ends, _)| *ends)
        .collect();
    lone.sort_unstable();
    // Sides of cells are horizontal or vertical, at coordinates that are equal to the last bit.
    let line = |ends: &[usize; 2]| {
        let [a, b] = ends.map(|end| points[end]);
        (0..2).find(|k| a[*k] == b[*k]).map(|k| (k, a[k].to_bits()))
    };
    let mut along: HashMap<(usize, u64), Vec<usize>> = HashMap::new();
    for ends in &lone {
        if let Some(line) = line(ends) {
            along.entry(line).or_default().extend(ends);
        }
    }
    for (line, corners) in &mut along {
        corners.sort_unstable_by(|a, b| {
            points[*a][1 - line.0].total_cmp(&points[*b][1 - line.0]).then(a.cmp(b))
        });
        corners.dedup();
    }
    for ends in lone {
        let Some(line) = line(&ends) else { continue };
        let at = |corner: usize| points[corner][1 - line.0];
        let up = at(ends[0]) < at(ends[1]);
        let (low, high) = if up { (ends[0], ends[1]) } else { (ends[1], ends[0]) };
        let row: Vec<usize> = along
            .get(&line)
            .into_iter()
            .flatten()
            .copied()
            .filter(|corner| (at(low)..=at(high)).contains(&at(*corner)))
            .collect();
        if row.len() <= 2 {
            continue;
        }
        let Some(pair) = halves.remove(&ends) else { continue };
        for part in row.windows(2) {
            // The direction from the smaller corner index to the larger may be opposite to that of the whole side.
            let key = [part[0].min(part[1]), part[0].max(part[1])];
            let same = (part[0] < part[1]) == up;
            for (side_index, half) in pair.iter().enumerate() {
                let side_index = if same { side_index } else { 1 - side_index };
                if let Some(half) = half {
                    halves.entry(key).or_default()[side_index].get_or_insert(*half);
                }
            }
        }
    }
}

/// Corners, with coincident ones merged.
struct Weld {
    near: f64,
    points: Vec<Point>,
    buckets: HashMap<[i64; 2], Vec<usize>>,
}

impl Weld {
    fn corner(&mut self, p: Point) -> usize {
        // Buckets twice as wide as the tolerance: a near corner is in this one or beside it.
        let key = p.map(|part| (part / (2.0 * self.near)).floor() as i64);
        for i in [0, -1, 1] {
            for j in [0, -1, 1] {
                let known = self.buckets.get(&[key[0] + i, key[1] + j]);
                let same = known
                    .into_iter()
                    .flatten()
                    .find(|index| norm(minus(self.points[**index], p)) <= self.near);
                if let Some(index) = same {
                    return *index;
                }
            }
        }
        self.points.push(p);
        self.buckets.entry(key).or_default().push(self.points.len() - 1);
        self.points.len() - 1
    }

    /// Returns the sides of a polygon that have a length.
    fn edges_of_piece(&mut self, piece: &Piece) -> Vec<(usize, usize, Option<CurveIndex>)> {
        let corners: Vec<usize> =
            piece.corners.iter().map(|corner| self.corner(corner.at)).collect();
        let next = |k: usize| corners[(k + 1) % corners.len()];
        let sides: Vec<_> = (0..corners.len())
            .filter(|k| corners[*k] != next(*k))
            .map(|k| (corners[k], next(k), piece.corners[k].curve))
            .collect();
        // The rest of a sliver encloses nothing.
        if sides.len() < 3 { Vec::new() } else { sides }
    }
}

/// Returns the owner of each polygon. Where bent curves meet or nearly touch, their chords leave specks and slivers too
/// small to see. Those are given to the owner with which they share the longest border.
fn without_specks(
    pieces: &[Piece],
    halves: &Halves,
    points: &[Point],
    visible_length: f64,
) -> Vec<Option<usize>> {
    let mut owners: Vec<Option<usize>> = pieces.iter().map(|piece| piece.owner).collect();
    let mut rows: Vec<(&[usize; 2], &[Option<Half>; 2])> = halves.iter().collect();
    rows.sort_unstable_by_key(|(ends, _)| **ends);
    let shared: Vec<(usize, usize, f64)> = rows
        .into_iter()
        .filter_map(|(ends, pair)| {
            let [Some((a, _)), Some((b, _))] = *pair else { return None };
            Some((a, b, norm(minus(points[ends[1]], points[ends[0]]))))
        })
        .collect();
    // Connected polygons of one owner (union-find), represented by the first one.
    let mut roots: Vec<usize> = (0..pieces.len()).collect();
    for (a, b, _) in shared.iter().filter(|(a, b, _)| owners[*a] == owners[*b]) {
        let (a, b) = (root(&mut roots, *a), root(&mut roots, *b));
        roots[a.max(b)] = a.min(b);
    }
    let mut areas = vec![0.0; pieces.len()];
    for (index, piece) in pieces.iter().enumerate() {
        areas[root(&mut roots, index)] += area(piece);
    }
    let mut rims = vec![0.0; pieces.len()];
    let mut neighbours: HashMap<usize, Vec<(usize, f64)>> = HashMap::new();
    for (a, b, length) in shared.iter().filter(|(a, b, _)| owners[*a] != owners[*b]) {
        for (own, other) in [(*a, *b), (*b, *a)] {
            let (own, other) = (root(&mut roots, own), root(&mut roots, other));
            rims[own] += length;
            neighbours.entry(own).or_default().push((other, *length));
        }
    }
    let specks: Vec<usize> = (0..pieces.len())
        .filter(|k| {
            roots[*k] == *k && rims[*k] > 0.0 && areas[*k] < 0.1 * visible_length * rims[*k]
        })
        .filter(|k| {
            let largest = (0..pieces.len())
                .filter(|other| roots[*other] == *other && pieces[*other].owner == pieces[*k].owner)
                .max_by(|a, b| areas[*a].total_cmp(&areas[*b]));
            largest != Some(*k)
        })
        .collect();
    for speck in specks {
        let near = neighbours.get(&speck).map_or(&[][..], Vec::as_slice);
        let along = |other: usize| -> f64 {
            near.iter().filter(|(own, _)| *own == other).map(|(_, length)| length).sum()
        };
        let longest = near
            .iter()
            .map(|(other, _)| *other)
            .max_by(|a, b| along(*a).total_cmp(&along(*b)).then(b.cmp(a)));
        if let Some(other) = longest {
            for (index, owner) in owners.iter_mut().enumerate() {
                if root(&mut roots, index) == speck {
                    *owner = pieces[other].owner;
                }
            }
        }
    }
    owners
}

/// Returns the representative of a polygon's connected component, with path halving.
fn root(roots: &mut [usize], mut index: usize) -> usize {
    while roots[index] != index {
        roots[index] = roots[roots[index]];
        index = roots[index];
    }
    index
}

fn area(piece: &Piece) -> f64 {
    let corners = &piece.corners;
    let first = corners[0].at;
    let double_area =
        |k: usize| cross(minus(corners[k].at, first), minus(corners[k + 1].at, first));
    (1..corners.len() - 1).map(double_area).sum::<f64>() / 2.0
}
