//! Whether the roots in the conditions of regions by hand exist. All proofs conclude from the signs of conditions, and a
//! condition has no sign where a number under one of its roots is negative. Lint looks for such points; a small disc of
//! them is found only here.

use super::cover::{Boxes, half_diagonal};
use super::slope::Slopes;
use crate::expr::interval::{Cell, Interval, dot};
use crate::expr::{Id, Node};
use crate::plan::PlannedTool;

/// The number of boxes that may be examined for a root.
const MAX_BOXES: usize = 10_000;

/// The size, relative to the tool's size, of boxes that are not divided: where a number under a root is 0 at a point, no box
/// about it shows that it is not below 0. Roots may not exist within that distance of such points.
const POINT_BOX_FRACTION: f64 = 1e-12;

/// Returns a box of the tool's extent in which a root of a condition is not proved to exist, if there is one. Roots of
/// visible sums of squares exist everywhere.
pub(super) fn box_without_root(tool: &PlannedTool) -> Option<Cell> {
    let graph = &tool.model.graph;
    let radicands = graph.dependencies(tool.model.curve_values()).into_iter().filter_map(|id| {
        let Node::Sqrt(radicand) = *graph.node(id) else { return None };
        graph.squares_of(radicand).is_none().then_some(radicand)
    });
    let radicands: Vec<Id> = radicands.collect();
    let point_size = POINT_BOX_FRACTION * half_diagonal(&tool.extent.cell());
    let mut slopes = Slopes::new(graph, tool.model.domain, radicands.iter().copied());
    radicands.into_iter().find_map(|radicand| {
        let mut boxes = Boxes::new(tool.extent.cell());
        while let Some(cell) = boxes.next() {
            if lower_bound(&mut slopes, radicand, cell) >= 0.0 || half_diagonal(&cell) <= point_size
            {
                continue;
            }
            if boxes.count > MAX_BOXES {
                return Some(cell);
            }
            boxes.divide(cell);
        }
        None
    })
}

/// Returns a lower bound of a root of a graph over a box: by its enclosure, or by its value in the middle and its slopes
/// (the mean value form; Moore 1966), which is closer in small boxes.
fn lower_bound(slopes: &mut Slopes<'_>, id: Id, cell: Cell) -> f64 {
    let middle = cell.middle();
    slopes.set(Cell::point(middle));
    let value_in_middle = slopes.get(id).value;
    slopes.set(cell);
    let slope = slopes.get(id);
    let offsets = [0, 1, 2].map(|axis| {
        let middle = Interval::new(-middle[axis], -middle[axis]);
        cell.sides[axis].plus(middle)
    });
    slope.value.low.max(value_in_middle.plus(dot(slope.partials, offsets)).low)
}
