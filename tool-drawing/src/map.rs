//! Welds the polygons of the section to a planar map, whose edges have an owner on each side.

use super::borders::{Nearness, Side};
use super::section::Piece;
use std::collections::HashMap;
use tool_dsl::formula::CurveIndex;
use tool_dsl::vector::{Point, cross, minus, norm};

/// A part of a border, from one welded corner to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub(super) ends: [usize; 2],
    pub(super) sides: [Side; 2],
    pub(super) curve: Option<CurveIndex>,
}

/// A side of a polygon: the polygon's index, and the side's curve.
type Half = (usize, Option<CurveIndex>);
/// Sides by their corner indices, smaller index first: the polygon on the left and the one on the right of that
/// direction.
type Halves = HashMap<[usize; 2], [Option<Half>; 2]>;

/// Returns the welded corners, and the edges between two owners.
pub(super) fn edges(pieces: &[Piece], near: Nearness) -> (Vec<Point>, Vec<Edge>) {
    let mut weld = Weld { near: near.weld, points: Vec::new(), buckets: HashMap::new() };
    let mut halves = Halves::new();
    for (index, piece) in pieces.iter().enumerate() {
        for (from, to, curve) in weld.edges_of_piece(piece) {
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
        let side = |half: Option<Half>| match half.map(|(piece, _)| owners[piece]) {
            Some(Some(region)) => Side::Region(region),
            Some(None) => Side::Outside,
            None if on_axis => Side::Axis,
            None => Side::Beyond,
        };
        let (left, right) = (side(pair[0]), side(pair[1]));
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
        let key = p.map(|part| (part / (2.0 * self.near)).floor() as i64);
        for i in [0, -1, 1] {
            for j in [0, -1, 1] {
                let known = self.buckets.get(&[key[0] + i, key[1] + j]);
                let same = |index: &&usize| norm(minus(self.points[**index], p)) <= self.near;
                if let Some(index) = known.into_iter().flatten().find(same) {
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
    let largest = |owner: Option<usize>, roots: &[usize]| {
        (0..pieces.len())
            .filter(|k| roots[*k] == *k && pieces[*k].owner == owner)
            .max_by(|a, b| areas[*a].total_cmp(&areas[*b]))
    };
    let specks: Vec<usize> = (0..pieces.len())
        .filter(|k| {
            roots[*k] == *k && rims[*k] > 0.0 && areas[*k] < 0.1 * visible_length * rims[*k]
        })
        .filter(|k| largest(pieces[*k].owner, &roots) != Some(*k))
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
