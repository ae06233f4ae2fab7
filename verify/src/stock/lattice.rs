//! The lattice of a stock: a regular grid of nodes in a box.

use super::StockError;
use nalgebra::Point3;

/// The greatest number of nodes of a lattice: an index fits 32 bits, and a set of nodes half a gigabyte.
pub(super) const MAX_NODES: usize = u32::MAX as usize;

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
        let counts = |spacing: f64| [0, 1, 2].map(|axis| (size[axis] / spacing).round().max(1.0));
        let nodes = |spacing: f64| counts(spacing).iter().product::<f64>();
        if nodes(spacing) > MAX_NODES as f64 {
            let mut coarser = (size.iter().product::<f64>() / MAX_NODES as f64).cbrt().max(spacing);
            // A thin box needs more than its volume tells, at most a node per spacing along its longest side.
            while nodes(coarser) > MAX_NODES as f64 {
                coarser *= 1.01;
            }
            return Err(StockError::TooManyNodes {
                spacing,
                nodes: nodes(spacing),
                limit: MAX_NODES,
                coarser,
            });
        }
        let counts = counts(spacing);
        let origin = [0, 1, 2].map(|axis| {
            let margin = 0.5 * (size[axis] - (counts[axis] - 1.0) * spacing);
            low[axis] + margin
        });
        let counts = counts.map(|count| count as usize);
        Ok(Lattice { origin: origin.into(), spacing, counts })
    }

    /// Returns the largest absolute value of a node's coordinate.
    pub(super) fn largest_coordinate(&self) -> f64 {
        let last = |axis: usize| self.origin[axis] + (self.counts[axis] as f64) * self.spacing;
        (0..3).fold(self.origin.coords.amax(), |largest, axis| largest.max(last(axis).abs()))
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
    pub(super) fn between(&self, axis: usize, low: f64, high: f64) -> std::ops::Range<usize> {
        let number = |coordinate: f64| (coordinate - self.origin[axis]) / self.spacing;
        let count = self.counts[axis];
        // A conversion to an integer saturates.
        let first = ((number(low).ceil() - 1.0).max(0.0) as usize).min(count);
        let end = (number(high).floor() + 2.0).max(0.0) as usize;
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
