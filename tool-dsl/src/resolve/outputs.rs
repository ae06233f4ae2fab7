//! Builds the expressions of a region's outputs.

use crate::domain::Domain;
use crate::expr::derive::derivative;
use crate::expr::{Coord, Graph, Id, Node};
use crate::model::RegionOutputs;
use crate::number::Number;

/// The square of the length below which a vector has no direction, 2^-960: smaller squares lose digits.
pub(crate) const SHORTEST_SQUARE: f64 = f64::from_bits((1023 - 960) << 52);

/// Returns the unit vector of a vector. A vector shorter than 2^-480 becomes the unit vector along `axis`. `None` for a constant vector of zero length.
pub(super) fn unit(graph: &mut Graph, vector: [Id; 3], axis: usize) -> Option<[Id; 3]> {
    let constants = vector.map(|part| graph.constant(part).cloned());
    if let [Some(x), Some(y), Some(z)] = constants {
        let norm = (&(&(&x * &x) + &(&y * &y)) + &(&z * &z)).sqrt()?;
        let (x, y, z) = (x.checked_div(&norm)?, y.checked_div(&norm)?, z.checked_div(&norm)?);
        return Some([graph.number(x), graph.number(y), graph.number(z)]);
    }
    let [x, y, z] = vector.map(|part| graph.mul(part, part));
    let across = graph.add(x, y);
    let square = graph.add(across, z);
    let norm = graph.sqrt(square)?;
    let short = graph.number(Number::from_f64(SHORTEST_SQUARE)?);
    let mut unit = vector;
    for (k, part) in unit.iter_mut().enumerate() {
        let along = graph.int(i64::from(k == axis));
        let divided = graph.div(*part, norm)?;
        *part = graph.select(square, short, along, divided);
    }
    Some(unit)
}

/// Returns the gradient of an expression in a domain.
pub(super) fn gradient(graph: &mut Graph, domain: Domain, of: Id) -> [Id; 3] {
    let parts: Vec<Id> =
        domain.coordinates().iter().map(|(by, ..)| derivative(graph, of, *by)).collect();
    domain.vector(graph, &parts)
}

/// Rotates a vector of the domain to the point's position in space. On a tool's axis the radial direction is +x.
fn in_space(graph: &mut Graph, domain: Domain, vector: [Id; 3]) -> [Id; 3] {
    if domain == Domain::Space {
        return vector;
    }
    let [radial, _, axial] = vector;
    let across = [graph.coord(Coord::X), graph.coord(Coord::Y), graph.int(0)];
    // The coordinates are not constant, so the unit vector exists.
    let unit = unit(graph, across, 0).unwrap_or(across);
    let [x, y] = [0, 1]
        .map(|k| turned(graph, radial, across[k]).unwrap_or_else(|| graph.mul(radial, unit[k])));
    [x, y, axial]
}

/// Returns a rotated radial component that is a multiple of the distance from the axis: the coordinate times the other
/// factor. This avoids a division by the distance, which takes most of a direction's time, and it has a unique value on
/// the axis.
fn turned(graph: &mut Graph, radial: Id, coordinate: Id) -> Option<Id> {
    match *graph.node(radial) {
        Node::Coord(Coord::D) => Some(coordinate),
        Node::Neg(a) => turned(graph, a, coordinate).map(|a| graph.neg(a)),
        Node::Mul(a, b) if graph.constant(a).is_some() => {
            turned(graph, b, coordinate).map(|b| graph.mul(a, b))
        }
        Node::Div(a, b) => turned(graph, a, coordinate).and_then(|a| graph.div(a, b)),
        Node::Quotient(a, b) => turned(graph, a, coordinate).map(|a| graph.quotient(a, b)),
        Node::Select { low, high, then, other }
            if graph.constant(then).is_some_and(Number::is_zero) =>
        {
            let other = turned(graph, other, coordinate)?;
            Some(graph.select(low, high, then, other))
        }
        _ => None,
    }
}

/// Builds the outputs of a region. Without a magnitude of its own it is the depth, a length, and changes with the unit;
/// any other is the file's own number.
pub(super) fn outputs(
    graph: &mut Graph,
    domain: Domain,
    depth: Id,
    own_magnitude: Option<Id>,
    direction: [Id; 3],
    niceness: Id,
) -> RegionOutputs {
    let zero = graph.int(0);
    let slope = gradient(graph, domain, own_magnitude.unwrap_or(depth));
    let slope = in_space(graph, domain, slope);
    let depth = graph.max(zero, depth);
    let (magnitude, gradient) = match own_magnitude {
        None => {
            let length = graph.coord(Coord::Length);
            (graph.mul(depth, length), slope)
        }
        Some(magnitude) => {
            let per = graph.coord(Coord::PerLength);
            (magnitude, slope.map(|part| graph.mul(part, per)))
        }
    };
    RegionOutputs {
        depth,
        magnitude,
        gradient,
        direction: in_space(graph, domain, direction),
        niceness: graph.max(zero, niceness),
    }
}
