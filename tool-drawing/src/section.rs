//! Divides the section among the owners of the plan's tree. The bounding box in the half plane is divided into cells,
//! and each cell is cut by the splits that the plan leaves open in it.
//!
//! A cell that provably has one owner stays whole. A cell that only straight lines divide is cut exactly, at any size.
//! Where a curve bends, cells are halved until its chords are flat. Every side of a cell is cut at the same points from
//! both cells, since the cut of a side depends on the side alone.

use super::curves::Curves;
use std::collections::HashSet;
use touchoff_dsl::formula::{CurveIndex, NEGATIVE, ZERO};
use touchoff_dsl::plan::Tree;
use touchoff_dsl::vector::{Point, cross, minus, norm};

/// A convex polygon of the section with one owner, counter-clockwise.
pub(super) struct Piece {
    pub(super) owner: Option<usize>,
    pub(super) corners: Vec<Corner>,
}

/// A corner of a polygon, and the curve on which the side after it lies, if any.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    pub(super) at: Point,
    pub(super) curve: Option<CurveIndex>,
}

/// A point, and a curve's value there.
#[derive(Clone, Copy)]
struct Valued {
    at: Point,
    value: f64,
}

/// Length tolerances of the division, in the tool's unit.
#[derive(Clone, Copy)]
pub(super) struct Fineness {
    /// The largest cell that a bent curve may cross.
    pub(super) cell: f64,
    /// The largest distance of a chord from its curve.
    pub(super) flat: f64,
    /// Points nearer to each other than this are considered equal.
    pub(super) same: f64,
}

/// The maximum number of halvings of a cell.
const MAX_HALVINGS: u32 = 24;
/// The number of cells beyond which none is halved. Two curves that nearly coincide would take any number of cells.
const MAX_CELLS: usize = 8_000;
/// The maximum number of splits that may cut one cell.
const MAX_SPLITS_PER_CELL: usize = 12;

/// A cell: its corner in an integer lattice, and its side length.
#[derive(Clone, Copy)]
struct Cell {
    corner: [u64; 2],
    side: u64,
}

/// The lattice over the box that is divided.
struct Lattice {
    low: Point,
    unit: f64,
}

impl Lattice {
    fn at(&self, [i, j]: [u64; 2]) -> Point {
        [self.low[0] + i as f64 * self.unit, self.low[1] + j as f64 * self.unit]
    }
}

/// Divides the box from the axis to `high[0]` and from height `low[1]` to `high[1]`.
pub(super) fn divide(
    curves: &mut Curves<'_>,
    owners: &Tree,
    [low, high]: [Point; 2],
    fineness: Fineness,
) -> Vec<Piece> {
    let (width, height) = (high[0] - low[0], high[1] - low[1]);
    // At most 64 root cells in a row, also for a needle.
    let root = width.min(height).max(width.max(height) / 64.0);
    let lattice = Lattice { low, unit: root / f64::from(1 << MAX_HALVINGS) };
    let mut division =
        Division { curves, lattice, fineness, cells: Vec::new(), corners: HashSet::new() };
    let counts = [width, height].map(|side| (side / root).ceil() as u64);
    for j in 0..counts[1] {
        for i in 0..counts[0] {
            let side = 1 << MAX_HALVINGS;
            division.cell(Cell { corner: [i * side, j * side], side }, owners);
        }
    }
    let cells = std::mem::take(&mut division.cells);
    cells.iter().flat_map(|(cell, tree)| division.pieces(*cell, tree)).collect()
}

struct Division<'c, 'm> {
    curves: &'c mut Curves<'m>,
    lattice: Lattice,
    fineness: Fineness,
    cells: Vec<(Cell, Tree)>,
    /// Corners of all cells. A side of a cell may have corners of its neighbours on it.
    corners: HashSet<[u64; 2]>,
}

impl Division<'_, '_> {
    /// Prunes the tree to the splits that are open in a cell, and halves the cell until it is fine enough.
    fn cell(&mut self, cell: Cell, tree: &Tree) {
        let [low, high] = self.ends(cell);
        let tree = self.subdivide(tree, low, high);
        if cell.side == 1 || self.cells.len() > MAX_CELLS || self.is_fine_enough(&tree, low, high) {
            let [i, j] = cell.corner;
            let s = cell.side;
            // A larger neighbour takes these corners into its sides, so that both cut them alike.
            self.corners.extend([[i, j], [i + s, j], [i + s, j + s], [i, j + s]]);
            self.cells.push((cell, tree));
            return;
        }
        let side = cell.side / 2;
        for [i, j] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
            let corner = [cell.corner[0] + i * side, cell.corner[1] + j * side];
            self.cell(Cell { corner, side }, &tree);
        }
    }

    fn ends(&self, cell: Cell) -> [Point; 2] {
        let [i, j] = cell.corner;
        [self.lattice.at([i, j]), self.lattice.at([i + cell.side, j + cell.side])]
    }

    /// Returns the part of a tree that is open in a box.
    fn subdivide(&mut self, tree: &Tree, low: Point, high: Point) -> Tree {
        let Tree::Split { curve, strict, below, above } = tree else { return tree.clone() };
        let signs = self.curves.signs(*curve, low, high);
        let side = if *strict { NEGATIVE } else { NEGATIVE | ZERO };
        if signs & !side == 0 {
            return self.subdivide(below, low, high);
        }
        if signs & side == 0 {
            return self.subdivide(above, low, high);
        }
        let (below, above) = (self.subdivide(below, low, high), self.subdivide(above, low, high));
        // The curve separates owners elsewhere only.
        if below == above {
            return below;
        }
        let (below, above) = (Box::new(below), Box::new(above));
        Tree::Split { curve: *curve, strict: *strict, below, above }
    }

    /// Returns whether cutting a cell by this tree is accurate enough.
    fn is_fine_enough(&mut self, tree: &Tree, low: Point, high: Point) -> bool {
        let mut splits = Vec::new();
        tested(tree, &mut splits);
        let side = high[0] - low[0];
        let bent: Vec<CurveIndex> =
            splits.iter().copied().filter(|curve| !self.curves.straight(*curve)).collect();
        if bent.is_empty() {
            // Straight lines cut exactly, but each split may double the polygons.
            return splits.len() <= MAX_SPLITS_PER_CELL || side < self.fineness.flat;
        }
        // A chord in so small a cell is flat.
        if side < 2.0 * self.fineness.flat {
            return true;
        }
        // Where a bent curve meets another curve, the chord must not miss the intersection.
        let alone = splits.len() == bent.len() && self.one(&bent, low, high);
        alone && side < self.fineness.cell && self.flat(bent[0], low, high)
    }

    /// Returns whether bent curves are one and the same curve around a box, written differently.
    fn one(&mut self, bent: &[CurveIndex], low: Point, high: Point) -> bool {
        let side = high[0] - low[0];
        let test_points = [[0.5, 0.5], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        bent.len() == 1
            || test_points.into_iter().all(|share| {
                let corner = [0, 1].map(|k| low[k] + share[k] * side);
                let on = self.curves.foot(bent[0], corner, 2.0 * side);
                bent[1..].iter().all(|other| {
                    let foot = self.curves.foot(*other, on, side);
                    norm(minus(foot, on)) <= self.fineness.same
                })
            })
    }

    /// Returns whether a curve is well approximated by its chord in a box.
    fn flat(&mut self, curve: CurveIndex, low: Point, high: Point) -> bool {
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
        let mut crossings = Vec::new();
        for k in 0..4 {
            let [a, b] = [corners[k], corners[(k + 1) % 4]]
                .map(|at| Valued { at, value: self.curves.value(curve, at) });
            if (a.value <= 0.0) != (b.value <= 0.0) {
                crossings.push(self.crossing(curve, a, b));
            }
        }
        match crossings.as_slice() {
            // The curve does not cross the box, or the box is too small to matter.
            [] => {
                let side = high[0] - low[0];
                let middle = [low[0] + side / 2.0, low[1] + side / 2.0];
                side < 4.0 * self.fineness.flat || self.curves.distance(curve, middle) > 1.2 * side
            }
            [a, b] => {
                let middle = [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
                let foot = self.curves.foot(curve, middle, high[0] - low[0]);
                norm(minus(foot, middle)) < self.fineness.flat
            }
            _ => false,
        }
    }

    /// Returns the crossing of a curve with a side. The result does not depend on the order of the ends.
    fn crossing(&mut self, curve: CurveIndex, a: Valued, b: Valued) -> Point {
        // Both cells of a side must find the same point to the last bit.
        let (a, b) = if (a.at[1], a.at[0]) <= (b.at[1], b.at[0]) { (a, b) } else { (b, a) };
        let between = |t: f64| [0, 1].map(|k| a.at[k] + t * (b.at[k] - a.at[k]));
        let (mut low, mut high) = ((0.0, a.value), (1.0, b.value));
        // A secant alone would miss a bent curve; for a line it is exact.
        if !self.curves.straight(curve) {
            for _ in 0..16 {
                let t = (low.0 + high.0) / 2.0;
                let value = self.curves.value(curve, between(t));
                if (value <= 0.0) == (low.1 <= 0.0) { low = (t, value) } else { high = (t, value) }
            }
        }
        let share = low.1 / (low.1 - high.1);
        // Infinite values, where the curve is undefined, give no share.
        let share = if share.is_finite() { share } else { 0.5 };
        between(low.0 + share * (high.0 - low.0))
    }

    /// Returns the polygons of a cell.
    fn pieces(&mut self, cell: Cell, tree: &Tree) -> Vec<Piece> {
        let [i, j] = cell.corner;
        let s = cell.side;
        let ends = [[i, j], [i + s, j], [i + s, j + s], [i, j + s]];
        let mut corners = Vec::new();
        for k in 0..4 {
            self.side(ends[k], ends[(k + 1) % 4], &mut corners);
        }
        let mut pieces = Vec::new();
        self.cut(corners, tree, &mut pieces);
        // Two polygons meet along one side, with the same ends.
        if pieces.len() > 2 {
            joined(&mut pieces, 1e-9 * (s as f64) * self.lattice.unit);
        }
        pieces
    }

    /// Appends the corners of a side except the last: its own, and those of its neighbours in between.
    fn side(&self, a: [u64; 2], b: [u64; 2], corners: &mut Vec<Corner>) {
        let middle = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
        let length = a[0].abs_diff(b[0]) + a[1].abs_diff(b[1]);
        if length > 1 && self.corners.contains(&middle) {
            self.side(a, middle, corners);
            self.side(middle, b, corners);
        } else {
            corners.push(Corner { at: self.lattice.at(a), curve: None });
        }
    }

    /// Cuts a convex polygon by a tree.
    fn cut(&mut self, corners: Vec<Corner>, tree: &Tree, pieces: &mut Vec<Piece>) {
        match tree {
            Tree::Leaf(owner) => pieces.push(Piece { owner: *owner, corners }),
            Tree::Split { curve, below, above, .. } => {
                let values = self.values(*curve, &corners);
                let changes = changes(&values);
                // A bent curve enters twice. The corners of a triangle change signs at most twice.
                if changes > 2 {
                    for triangle in fan(&corners) {
                        self.cut(triangle, tree, pieces);
                    }
                    return;
                }
                for (sign, side) in [(-1.0, below), (1.0, above)] {
                    let part = self.part(*curve, &corners, &values, sign);
                    if part.len() >= 3 {
                        self.cut(part, side, pieces);
                    }
                }
            }
        }
    }

    /// Returns the curve's values at corners. A value that differs from 0 only by rounding is set to 0.
    fn values(&mut self, curve: CurveIndex, corners: &[Corner]) -> Vec<f64> {
        let values: Vec<f64> =
            corners.iter().map(|corner| self.curves.value(curve, corner.at)).collect();
        // A vertex that an earlier cut put on the curve must not be cut off as a sliver.
        let largest = values.iter().map(|v| v.abs()).filter(|v| v.is_finite()).fold(0.0, f64::max);
        values.into_iter().map(|v| if v.abs() < 1e-10 * largest { 0.0 } else { v }).collect()
    }

    /// Returns the part of a polygon on one side of a curve.
    fn part(
        &mut self,
        curve: CurveIndex,
        corners: &[Corner],
        values: &[f64],
        sign: f64,
    ) -> Vec<Corner> {
        let mut part: Vec<Corner> = Vec::new();
        if !values.iter().any(|value| value * sign > 0.0) {
            return part;
        }
        for (k, corner) in corners.iter().enumerate() {
            let next = (k + 1) % corners.len();
            let [here, after] = [k, next].map(|k| Valued { at: corners[k].at, value: values[k] });
            let (value_here, value_next) = (values[k] * sign, values[next] * sign);
            // A corner on the curve at which the part ends is followed by the chord.
            match (value_here >= 0.0, value_next >= 0.0) {
                (true, _) if value_here == 0.0 && value_next < 0.0 => {
                    part.push(Corner { at: corner.at, curve: Some(curve) });
                }
                (true, true) => part.push(*corner),
                (true, false) => {
                    let at = self.crossing(curve, here, after);
                    part.extend([*corner, Corner { at, curve: Some(curve) }]);
                }
                (false, true) if value_next > 0.0 => {
                    let at = self.crossing(curve, here, after);
                    part.push(Corner { at, curve: corner.curve });
                }
                (false, _) => {}
            }
        }
        part
    }
}

/// Collects the curves that a tree tests.
fn tested(tree: &Tree, curves: &mut Vec<CurveIndex>) {
    if let Tree::Split { curve, below, above, .. } = tree {
        if !curves.contains(curve) {
            curves.push(*curve);
        }
        tested(below, curves);
        tested(above, curves);
    }
}

/// Returns the number of sign changes around a polygon.
fn changes(values: &[f64]) -> usize {
    let signs: Vec<bool> = values.iter().filter(|v| **v != 0.0).map(|v| *v > 0.0).collect();
    (0..signs.len()).filter(|k| signs[*k] != signs[(k + 1) % signs.len()]).count()
}

/// Divides a polygon into triangles about its centroid.
fn fan(corners: &[Corner]) -> Vec<Vec<Corner>> {
    let count = corners.len() as f64;
    let at = [0, 1].map(|k| corners.iter().map(|corner| corner.at[k]).sum::<f64>() / count);
    let middle = Corner { at, curve: None };
    let triangles = (0..corners.len()).map(|k| {
        let next = Corner { curve: None, ..corners[(k + 1) % corners.len()] };
        vec![middle, corners[k], next]
    });
    triangles.collect()
}

/// Inserts the corners of each polygon into the sides of the others on which they lie.
fn joined(pieces: &mut [Piece], near: f64) {
    let points: Vec<Point> =
        pieces.iter().flat_map(|piece| piece.corners.iter().map(|corner| corner.at)).collect();
    for piece in pieces {
        let mut corners = Vec::new();
        for (k, corner) in piece.corners.iter().enumerate() {
            corners.push(*corner);
            let side = minus(piece.corners[(k + 1) % piece.corners.len()].at, corner.at);
            let length = norm(side);
            let mut between: Vec<(f64, Point)> = points
                .iter()
                .filter_map(|p| {
                    let q = minus(*p, corner.at);
                    let along = (q[0] * side[0] + q[1] * side[1]) / length;
                    let on = cross(side, q).abs() <= near * length;
                    (on && along > near && along < length - near).then_some((along, *p))
                })
                .collect();
            between.sort_by(|a, b| a.0.total_cmp(&b.0));
            between.dedup_by(|a, b| a.0 - b.0 <= near);
            corners.extend(between.into_iter().map(|(_, at)| Corner { at, curve: corner.curve }));
        }
        piece.corners = corners;
    }
}
