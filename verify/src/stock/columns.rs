//! Nodes of a lattice inside a closed surface: winding numbers along the columns of the lattice.
//!
//! A column is a line along z. The winding number of the surface about a node is the number of triangles that
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
use super::bits::BitSet;
use super::lattice::Lattice;
use robust::{Coord, Coord3D, orient2d, orient3d};

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
    if area == 0.0 {
        return;
    }
    let faces_up = area > 0.0;
    let range = |axis: usize| {
        let [a, b, c] = corners.map(|corner| corner[axis]);
        lattice.between(axis, a.min(b).min(c), a.max(b).max(c))
    };
    let heights = range(2);
    for i in range(0) {
        for j in range(1) {
            let at =
                Coord { x: lattice.coordinate(0, i as f64), y: lattice.coordinate(1, j as f64) };
            if [(a, b), (b, c), (c, a)].iter().all(|(p, q)| is_left(*p, *q, at) == faces_up) {
                let is_below = |k: &usize| {
                    let node = Coord3D { x: at.x, y: at.y, z: lattice.coordinate(2, *k as f64) };
                    is_below(corners, faces_up, node)
                };
                crossings.push(Crossing {
                    column: i * lattice.counts()[1] + j,
                    above: first_not(heights.clone(), is_below) as u32,
                    faces_up,
                });
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
fn first_not(range: std::ops::Range<usize>, holds: impl Fn(&usize) -> bool) -> usize {
    let (mut low, mut high) = (range.start, range.end);
    while low < high {
        let middle = low + (high - low) / 2;
        if holds(&middle) { low = middle + 1 } else { high = middle }
    }
    low
}
