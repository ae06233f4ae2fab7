//! What the evaluators compute, from what a region says.

use crate::expr::derive::derivative;
use crate::expr::{Coord, Graph, Id};
use crate::model::Outputs;
use crate::number::Number;

/// Makes a vector a unit vector. Where both parts are 0 it is (1, 0) or, if not `first`, (0, 1).
///
/// Squares of numbers below 2^-480 lose digits and below 2^-537 vanish, so short vectors are
/// lengthened by a power of two before they are squared.
pub(super) fn unit(graph: &mut Graph, [a, b]: [Id; 2], first: bool) -> Option<[Id; 2]> {
    if let (Some(x), Some(y)) = (graph.constant(a).cloned(), graph.constant(b).cloned()) {
        let norm = (&(&x * &x) + &(&y * &y)).sqrt()?;
        let (x, y) = (x.over(&norm)?, y.over(&norm)?);
        return Some([graph.number(x), graph.number(y)]);
    }
    let square = |graph: &mut Graph, a: Id, b: Id| {
        let (aa, bb) = (graph.mul(a, a), graph.mul(b, b));
        graph.add(aa, bb)
    };
    let one = graph.int(1);
    let zero = graph.int(0);
    let tiny = graph.number(Number::from_f64(2f64.powi(-960))?);
    let huge = graph.number(Number::from_f64(2f64.powi(600))?);
    let plain = square(graph, a, b);
    let scale = graph.select(plain, tiny, huge, one);
    let (a, b) = (graph.mul(scale, a), graph.mul(scale, b));
    let square = square(graph, a, b);
    let norm = graph.sqrt(square)?;
    let (x, y) = (graph.quotient(a, norm), graph.quotient(b, norm));
    Some(if first {
        [graph.select(norm, zero, one, x), y]
    } else {
        [x, graph.select(norm, zero, one, y)]
    })
}

/// The gradient in (d, z).
pub(super) fn gradient(graph: &mut Graph, of: Id) -> [Id; 2] {
    [derivative(graph, of, Coord::D), derivative(graph, of, Coord::Z)]
}

/// A vector of the half plane (d, z) turned to where the point is in space. On the axis the
/// radial part is that of +x.
fn in_space(graph: &mut Graph, [radial, axial]: [Id; 2]) -> [Id; 3] {
    let across = [graph.coord(Coord::X), graph.coord(Coord::Y)];
    // Two coordinates are no constants, so the unit vector exists.
    let [cos, sin] = unit(graph, across, true).unwrap_or(across);
    [graph.mul(radial, cos), graph.mul(radial, sin), axial]
}

/// What a region's evaluators compute. A magnitude that is the depth is a length, and changes with
/// the unit; another is the file's own number.
pub(super) fn outputs(
    graph: &mut Graph,
    depth: Id,
    (magnitude, is_depth): (Id, bool),
    direction: [Id; 2],
    niceness: Id,
) -> Outputs {
    let zero = graph.int(0);
    let slope = gradient(graph, magnitude);
    let slope = in_space(graph, slope);
    let depth = graph.max(zero, depth);
    let (magnitude, gradient) = if is_depth {
        let length = graph.coord(Coord::Length);
        (graph.mul(depth, length), slope)
    } else {
        let per = graph.coord(Coord::PerLength);
        (magnitude, slope.map(|part| graph.mul(part, per)))
    };
    Outputs {
        depth,
        magnitude,
        gradient,
        direction: in_space(graph, direction),
        niceness: graph.max(zero, niceness),
    }
}
