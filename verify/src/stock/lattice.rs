//! The lattice of a stock: a regular grid of nodes in a box, and the nodes inside a closed surface.
//!
//! **Inside.** A column is a line along z. The winding number of the surface about a node is the number of triangles that
//! the column crosses above it, counted 1 if they face up and −1 if they face down. Signs are those of exact
//! predicates (Shewchuk, *Adaptive precision floating-point arithmetic and fast robust geometric predicates*,
//! 1997), so the result is exact for the doubles of corners and nodes, unless products of three lengths
//! overflow or underflow.
//!
//! **Ties.** Columns through edges and corners are common: lattice and part are often symmetric. All nodes
//! count as if they were moved by `(ε², ε³, ε)`, with ε infinitely small (simulation of simplicity:
//! Edelsbrunner and Mücke 1990). A column then crosses no edge and no vertical triangle. A node on the
//! surface counts as the point just above it.

use super::StockError;
use nalgebra::{Point3, Vector3};
use robust::{Coord, Coord3D, orient2d, orient3d};
use touchoff::cancellation;

/// The greatest number of nodes of a lattice: an index fits 32 bits, and a set of nodes half a gigabyte.
const MAX_NODES: usize = u32::MAX as usize;

/// The smallest spacing as a fraction (2^-40) of the greatest coordinate: nodes are then rounded by less than
/// a thousandth of the spacing.
const MIN_SPACING_FRACTION: f64 = 1.0 / (1u64 << 40) as f64;

/// A regular grid of nodes in a box, at equal distances along x, y and z. The nodes of a column along z have
/// consecutive indices.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lattice {
    /// The node with the lowest coordinates.
    origin: Point3<f64>,
    spacing: f64,
    counts: [usize; 3],
}

impl Lattice {
    /// Creates the lattice of a box, centred in it, with the whole number of layers that is nearest to its
    /// size. The outermost nodes are half a spacing within the faces if the size is a multiple of the
    /// spacing, and never more than 3/4: the next ones would be outside. A box thinner than a spacing has one
    /// layer, in its middle.
    ///
    /// # Errors
    /// If the spacing is not a finite length above 0 or is too small for the coordinates, or if there are
    /// more than [`MAX_NODES`].
    pub(super) fn new([low, high]: [Point3<f64>; 2], spacing: f64) -> Result<Lattice, StockError> {
        if !(spacing > 0.0 && spacing.is_finite()) {
            return Err(StockError::Spacing { spacing });
        }
        let coordinate = low.coords.amax().max(high.coords.amax());
        let limit = MIN_SPACING_FRACTION * coordinate;
        if spacing < limit {
            return Err(StockError::Resolution { spacing, coordinate, limit });
        }
        let size = high - low;
        let counts = layers(&size, spacing);
        let nodes = counts.iter().product::<f64>();
        if nodes > MAX_NODES as f64 {
            let mut coarser = (size.iter().product::<f64>() / MAX_NODES as f64).cbrt().max(spacing);
            // A thin box needs more than its volume tells, at most a node per spacing along its longest side.
            while layers(&size, coarser).iter().product::<f64>() > MAX_NODES as f64 {
                coarser *= 1.01;
            }
            return Err(StockError::TooManyNodes { spacing, nodes, limit: MAX_NODES, coarser });
        }
        let origin = [0, 1, 2].map(|axis| {
            let margin = 0.5 * (size[axis] - (counts[axis] - 1.0) * spacing);
            low[axis] + margin
        });
        let counts = counts.map(|count| count as usize);
        Ok(Lattice { origin: origin.into(), spacing, counts })
    }

    /// Returns the lattice in another frame: `turn` is a rotation by quarter turns that takes coordinates of this frame to
    /// directions of the other one, and `origin` the place of this frame's origin in it.
    ///
    /// # Errors
    /// [`StockError::Resolution`] if the spacing is too small for the coordinates there.
    pub(super) fn placed(
        &self,
        turn: &QuarterTurn,
        origin: Point3<f64>,
    ) -> Result<Lattice, StockError> {
        let mut placed = self.clone();
        for (axis, (from, is_reversed)) in turn.0.into_iter().enumerate() {
            let last = self.coordinate(from, (self.counts[from] - 1) as f64);
            let first = if is_reversed { -last } else { self.origin[from] };
            placed.origin[axis] = origin[axis] + first;
            placed.counts[axis] = self.counts[from];
        }
        let (spacing, coordinate) = (self.spacing, placed.largest_coordinate());
        let limit = MIN_SPACING_FRACTION * coordinate;
        match spacing < limit {
            true => Err(StockError::Resolution { spacing, coordinate, limit }),
            false => Ok(placed),
        }
    }

    /// Returns the index in a placed lattice of a node of this one.
    pub(super) fn placed_index(&self, placed: &Lattice, turn: &QuarterTurn, index: usize) -> usize {
        let node = self.node(index);
        placed.index(turn.0.map(|(from, is_reversed)| match is_reversed {
            true => self.counts[from] - 1 - node[from],
            false => node[from],
        }))
    }

    /// Returns the largest absolute value of a node's coordinate.
    pub(super) fn largest_coordinate(&self) -> f64 {
        (0..3).fold(self.origin.coords.amax(), |largest, axis| {
            let last = self.origin[axis] + (self.counts[axis] as f64) * self.spacing;
            largest.max(last.abs())
        })
    }

    pub(super) fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Returns the number of nodes along each axis.
    pub(super) fn counts(&self) -> [usize; 3] {
        self.counts
    }

    /// Returns the number of nodes.
    pub(super) fn len(&self) -> usize {
        self.counts.iter().product()
    }

    /// Returns the index of a node.
    pub(super) fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        (i * self.counts[1] + j) * self.counts[2] + k
    }

    /// Returns the node of an index, as its numbers along the axes.
    pub(super) fn node(&self, index: usize) -> [usize; 3] {
        let (column, k) = (index / self.counts[2], index % self.counts[2]);
        [column / self.counts[1], column % self.counts[1], k]
    }

    /// Returns a coordinate of the nodes with a number along an axis. Corners of cells are half a number off.
    pub(super) fn coordinate(&self, axis: usize, number: f64) -> f64 {
        self.origin[axis] + number * self.spacing
    }

    /// Returns the position of a node by its index.
    pub(super) fn position(&self, index: usize) -> [f64; 3] {
        let node = self.node(index);
        [0, 1, 2].map(|axis| self.coordinate(axis, node[axis] as f64))
    }

    /// Returns the numbers along an axis of the nodes between two coordinates. Rounding may add one at either
    /// end.
    fn between(&self, axis: usize, low: f64, high: f64) -> std::ops::Range<usize> {
        let [low, high] =
            [low, high].map(|coordinate| (coordinate - self.origin[axis]) / self.spacing);
        let count = self.counts[axis];
        // A conversion to an integer saturates.
        let first = ((low.ceil() - 1.0).max(0.0) as usize).min(count);
        let end = (high.floor() + 2.0).max(0.0) as usize;
        first..end.clamp(first, count)
    }

    /// Returns the index of the neighbour of a node along an axis, up or down; `None` if it is beyond the
    /// lattice.
    pub(super) fn neighbour(&self, node: [usize; 3], axis: usize, up: bool) -> Option<usize> {
        let mut neighbour = node;
        neighbour[axis] = if up {
            Some(node[axis] + 1).filter(|number| *number < self.counts[axis])?
        } else {
            node[axis].checked_sub(1)?
        };
        Some(self.index(neighbour))
    }
}

/// A rotation by quarter turns: for each axis of the new frame the axis of the old one, and whether it points the other way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct QuarterTurn([(usize, bool); 3]);

impl QuarterTurn {
    /// Takes the directions of the old frame's axes x and z in the new one; `None` if they are not those of two of its axes, or
    /// the same one.
    pub(super) fn new(x: [f64; 3], z: [f64; 3]) -> Option<QuarterTurn> {
        let along = |vector: [f64; 3]| {
            let mut axes = (0..3).filter(|axis| vector[*axis] != 0.0);
            let axis = axes.next().filter(|axis| vector[*axis].abs() == 1.0)?;
            axes.next().is_none().then_some((axis, vector[axis] < 0.0))
        };
        let ((x_axis, x_reversed), (z_axis, z_reversed)) = (along(x)?, along(z)?);
        if x_axis == z_axis {
            return None;
        }
        // y = z × x: along the next axis after z's if x's follows in turn.
        let y_axis = 3 - x_axis - z_axis;
        let in_turn = (z_axis + 1) % 3 == x_axis;
        let y_reversed = (x_reversed != z_reversed) == in_turn;
        let mut axes = [(0, false); 3];
        axes[x_axis] = (0, x_reversed);
        axes[y_axis] = (1, y_reversed);
        axes[z_axis] = (2, z_reversed);
        Some(QuarterTurn(axes))
    }
}

/// Returns the number of layers of nodes along each axis of a box.
fn layers(size: &Vector3<f64>, spacing: f64) -> [f64; 3] {
    [0, 1, 2].map(|axis| (size[axis] / spacing).round().max(1.0))
}

/// A set of integers from 0 up to a fixed limit.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BitSet {
    words: Vec<u64>,
}

impl BitSet {
    /// Creates an empty set of integers below `limit`.
    pub(super) fn new(limit: usize) -> BitSet {
        BitSet { words: vec![0; limit.div_ceil(64)] }
    }

    /// Adds an integer. Returns whether it is new.
    pub(super) fn insert(&mut self, member: usize) -> bool {
        let (word, bit) = (&mut self.words[member / 64], 1 << (member % 64));
        let is_new = *word & bit == 0;
        *word |= bit;
        is_new
    }

    pub(super) fn remove(&mut self, member: usize) {
        self.words[member / 64] &= !(1 << (member % 64));
    }

    pub(super) fn contains(&self, member: usize) -> bool {
        self.words[member / 64] & (1 << (member % 64)) != 0
    }

    /// Returns the number of members.
    pub(super) fn len(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Iterates over the members in ascending order.
    pub(super) fn iter(&self) -> impl Iterator<Item = usize> + Clone {
        self.words.iter().enumerate().filter(|(_, word)| **word != 0).flat_map(|(index, word)| {
            let mut left = *word;
            std::iter::from_fn(move || {
                let bit = (left != 0).then(|| left.trailing_zeros() as usize)?;
                left &= left - 1;
                Some(64 * index + bit)
            })
        })
    }
}

/// A crossing of a column and a triangle.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Crossing {
    /// The column's number.
    column: usize,
    /// The number of the lowest node above the triangle.
    above: u32,
    faces_up: bool,
}

/// Returns the nodes about which the winding number of a closed and oriented surface is positive. `triangles`
/// are its corners.
///
/// # Errors
/// [`StockError::InsideOut`] if the winding number about a node is negative.
pub(super) fn nodes_inside(
    triangles: impl Iterator<Item = [[f64; 3]; 3]>,
    lattice: &Lattice,
) -> Result<BitSet, StockError> {
    let mut crossings = Vec::new();
    triangles.for_each(|corners| cross(lattice, corners, &mut crossings));
    crossings.sort_unstable();
    let mut inside = BitSet::new(lattice.len());
    let height = lattice.counts()[2];
    for column in crossings.chunk_by(|a, b| a.column == b.column) {
        let first = column[0].column * height;
        // From above the surface, where it is 0, down to each node.
        let mut winding = 0;
        for (position, crossing) in column.iter().enumerate().rev() {
            winding += if crossing.faces_up { 1 } else { -1 };
            let from = position.checked_sub(1).map_or(0, |below| column[below].above as usize);
            let nodes = first + from..first + crossing.above as usize;
            if winding > 0 {
                nodes.for_each(|node| {
                    inside.insert(node);
                });
            } else if winding < 0 && !nodes.is_empty() {
                return Err(StockError::InsideOut { point: lattice.position(nodes.start) });
            }
        }
    }
    Ok(inside)
}

/// Appends the crossings of a triangle.
fn cross(lattice: &Lattice, corners: [[f64; 3]; 3], crossings: &mut Vec<Crossing>) {
    let [a, b, c] = corners.map(|[x, y, _]| Coord { x, y });
    let area = orient2d(a, b, c);
    // No column crosses a vertical triangle.
    if area == 0.0 {
        return;
    }
    let faces_up = area > 0.0;
    let [rows, columns, heights] = [0, 1, 2].map(|axis| {
        let [a, b, c] = corners.map(|corner| corner[axis]);
        lattice.between(axis, a.min(b).min(c), a.max(b).max(c))
    });
    for i in rows {
        cancellation::check();
        for j in columns.clone() {
            let at =
                Coord { x: lattice.coordinate(0, i as f64), y: lattice.coordinate(1, j as f64) };
            if [(a, b), (b, c), (c, a)].iter().all(|(p, q)| is_left(*p, *q, at) == faces_up) {
                let above = first_not(heights.clone(), |k| {
                    let node = Coord3D { x: at.x, y: at.y, z: lattice.coordinate(2, k as f64) };
                    is_below(corners, faces_up, node)
                });
                let column = i * lattice.counts()[1] + j;
                crossings.push(Crossing { column, above: above as u32, faces_up });
            }
        }
    }
}

/// Returns whether a column, moved by `(ε², ε³)`, is on the left of a line. The line has two different
/// points.
fn is_left(from: Coord<f64>, to: Coord<f64>, at: Coord<f64>) -> bool {
    let side = orient2d(from, to, at);
    if side != 0.0 {
        return side > 0.0;
    }
    // The cross product of the line's direction with the displacement of the column.
    if from.y != to.y { to.y < from.y } else { to.x > from.x }
}

/// Returns whether a node is below a triangle that is not vertical. A node in its plane is above it.
fn is_below(corners: [[f64; 3]; 3], faces_up: bool, node: Coord3D<f64>) -> bool {
    let [a, b, c] = corners.map(|[x, y, z]| Coord3D { x, y, z });
    // Positive on the side from which the corners are seen clockwise.
    let side = orient3d(a, b, c, node);
    if faces_up { side > 0.0 } else { side < 0.0 }
}

/// Returns the first number of a range for which a condition fails that holds up to some number; the range's
/// end if it never fails.
fn first_not(range: std::ops::Range<usize>, holds: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (range.start, range.end);
    while low < high {
        let middle = low + (high - low) / 2;
        if holds(middle) { low = middle + 1 } else { high = middle }
    }
    low
}
