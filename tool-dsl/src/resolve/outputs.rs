//! What the evaluators compute, from what a region says.

use crate::domain::Domain;
use crate::expr::derive::derivative;
use crate::expr::{Coord, Graph, Id};
use crate::model::Outputs;
use crate::number::Number;

/// Makes a vector a unit vector. Where it vanishes it is the unit vector along `axis`.
///
/// Squares of numbers below 2^-480 lose digits and below 2^-537 vanish, so short vectors are
/// lengthened by a power of two before they are squared.
pub(super) fn unit(graph: &mut Graph, vector: [Id; 3], axis: usize) -> Option<[Id; 3]> {
    let constants = vector.map(|part| graph.constant(part).cloned());
    if let [Some(x), Some(y), Some(z)] = constants {
        let norm = (&(&(&x * &x) + &(&y * &y)) + &(&z * &z)).sqrt()?;
        let (x, y, z) = (x.over(&norm)?, y.over(&norm)?, z.over(&norm)?);
        return Some([graph.number(x), graph.number(y), graph.number(z)]);
    }
    let square = |graph: &mut Graph, vector: [Id; 3]| {
        let [x, y, z] = vector.map(|part| graph.mul(part, part));
        let across = graph.add(x, y);
        graph.add(across, z)
    };
    let one = graph.int(1);
    let zero = graph.int(0);
    let tiny = graph.number(Number::from_f64(2f64.powi(-960))?);
    let huge = graph.number(Number::from_f64(2f64.powi(600))?);
    let plain = square(graph, vector);
    let scale = graph.select(plain, tiny, huge, one);
    let vector = vector.map(|part| graph.mul(scale, part));
    let square = square(graph, vector);
    let norm = graph.sqrt(square)?;
    let mut unit = vector.map(|part| graph.quotient(part, norm));
    unit[axis] = graph.select(norm, zero, one, unit[axis]);
    Some(unit)
}

/// The gradient in a domain.
pub(super) fn gradient(graph: &mut Graph, domain: Domain, of: Id) -> [Id; 3] {
    let parts: Vec<Id> =
        domain.coordinates().iter().map(|(by, ..)| derivative(graph, of, *by)).collect();
    domain.vector(graph, &parts)
}

/// A vector of the domain turned to where the point is in space. On a tool's axis the radial part
/// is that of +x.
fn in_space(graph: &mut Graph, domain: Domain, vector: [Id; 3]) -> [Id; 3] {
    if domain == Domain::Space {
        return vector;
    }
    let [radial, _, axial] = vector;
    let across = [graph.coord(Coord::X), graph.coord(Coord::Y), graph.int(0)];
    // Coordinates are no constants, so the unit vector exists.
    let [cos, sin, _] = unit(graph, across, 0).unwrap_or(across);
    [graph.mul(radial, cos), graph.mul(radial, sin), axial]
}

/// What a region's evaluators compute. A magnitude that is the depth is a length, and changes with
/// the unit; another is the file's own number.
pub(super) fn outputs(
    graph: &mut Graph,
    domain: Domain,
    depth: Id,
    (magnitude, is_depth): (Id, bool),
    direction: [Id; 3],
    niceness: Id,
) -> Outputs {
    let zero = graph.int(0);
    let slope = gradient(graph, domain, magnitude);
    let slope = in_space(graph, domain, slope);
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
        direction: in_space(graph, domain, direction),
        niceness: graph.max(zero, niceness),
    }
}
