//! Directions: their angle to the steepest descent of depth, and the points where they vanish.

use super::root::RootForm;
use super::slope::{Slope, angle};
use crate::domain::Domain;
use crate::expr::interval::{Cell, Interval, ZERO, dot};
use crate::expr::polynomial::{Polynomial, Polynomials, monomial_of};
use crate::expr::{Graph, Id, Node};
use crate::model::{Model, Region};
use crate::number::Number;
use std::f64::consts::PI;

/// The facts about a region's direction.
#[derive(Clone)]
pub(super) struct DirectionFacts {
    /// True if it is parallel to the depth's gradient, with either sign.
    pub(super) is_parallel: bool,
    /// The angle between it and the steepest descent, in radians.
    pub(super) angle_to_descent: Option<Interval>,
    /// The boxes where it may vanish.
    pub(super) singular: Vec<Cell>,
    /// True if it has a component perpendicular to an axis that the region touches, where that component has
    /// no defined azimuth.
    pub(super) on_axis: bool,
}

impl DirectionFacts {
    pub(super) fn new(is_parallel: bool) -> DirectionFacts {
        DirectionFacts { is_parallel, angle_to_descent: None, singular: Vec::new(), on_axis: false }
    }

    /// Records the facts over a box. Returns the largest angle there, if it is known.
    pub(super) fn record(
        &mut self,
        direction: [Interval; 3],
        depth: Slope,
        cell: Cell,
        domain: Domain,
    ) -> Option<f64> {
        let angle_here = angle_to_descent(direction, depth, self.is_parallel);
        match angle_here {
            Some(angle) => {
                self.angle_to_descent =
                    Some(self.angle_to_descent.map_or(angle, |known| known.hull(angle)));
            }
            None if vanishes(direction) => {
                // Neighbouring boxes around one point become one box.
                let near = self.singular.iter().position(|known| known.meets(&cell));
                let known = near.map(|at| self.singular.swap_remove(at));
                self.singular.push(known.map_or(cell, |known| known.hull(&cell)));
            }
            None => {}
        }
        // The component along `d` has the azimuth of the point, which is undefined on the axis.
        let axis = domain == Domain::HalfPlane && cell.sides[0].low <= 0.0;
        self.on_axis |= axis && direction[0] != ZERO;
        angle_here.map(|angle| angle.high)
    }
}

/// Returns whether an identity proves that a region's direction is parallel to its depth's gradient, with
/// either sign.
pub(super) fn is_parallel(model: &Model, region: &Region, depth: Option<&RootForm>) -> bool {
    let Some(slope) = depth.and_then(RootForm::gradient_direction) else { return false };
    let mut polynomials = Polynomials::default();
    let without_root: Vec<(Id, i64, Option<Id>)> =
        region.raw_direction.0.iter().map(|part| without_root(&model.graph, *part)).collect();
    let mut divisors = without_root
        .iter()
        .filter(|(part, ..)| !model.graph.constant(*part).is_some_and(Number::is_zero))
        .map(|(.., by)| by);
    let first = divisors.next();
    // Components divided by different roots have another direction without them.
    if !divisors.all(|by| Some(by) == first) {
        return false;
    }
    let parts: Option<Vec<(Polynomial, &Polynomial)>> = model
        .domain
        .coordinates()
        .iter()
        .map(|(coord, axis, _)| {
            let (part, sign, _) = without_root[*axis];
            let part = polynomials.of(&model.graph, part)?.scaled(&Number::int(sign));
            let by = monomial_of(*coord).iter().position(|exponent| *exponent > 0)?;
            Some((part, &slope[by]))
        })
        .collect();
    let Some(parts) = parts else { return false };
    let parallel = |(a, u): &(Polynomial, &Polynomial), (b, v): &(Polynomial, &Polynomial)| {
        let cross = a.times(v)?.plus(&b.times(u)?.scaled(&Number::int(-1)));
        Some(cross.is_zero())
    };
    let mut pairs = parts
        .iter()
        .enumerate()
        .flat_map(|(k, a)| parts[k + 1..].iter().map(move |b| parallel(a, b).unwrap_or(false)));
    pairs.all(|parallel| parallel)
}

/// Returns a component of a vector without its sign and without the root that it is divided by.
fn without_root(graph: &Graph, part: Id) -> (Id, i64, Option<Id>) {
    match *graph.node(part) {
        Node::Neg(a) => {
            let (a, sign, by) = without_root(graph, a);
            (a, -sign, by)
        }
        Node::Div(a, by) | Node::Quotient(a, by) if matches!(graph.node(by), Node::Sqrt(_)) => {
            (a, 1, Some(by))
        }
        _ => (part, 1, None),
    }
}

/// Encloses the angle between a direction and the steepest descent over a box, if the direction does not
/// vanish there. It is exact if `is_parallel` is set.
pub(super) fn angle_to_descent(
    direction: [Interval; 3],
    depth: Slope,
    is_parallel: bool,
) -> Option<Interval> {
    let descent = depth.partials.map(Interval::negated);
    match dot(direction, descent) {
        _ if vanishes(direction) => None,
        // Parallel by an identity: the sign of the product decides between 0 and half a turn, exactly.
        Interval { low, .. } if is_parallel && low > 0.0 => Some(ZERO),
        Interval { high, .. } if is_parallel && high < 0.0 => Some(Interval { low: PI, high: PI }),
        // The sign is open, so the angle is one of the two, and a hull of both would say nothing.
        _ if is_parallel => None,
        _ => {
            let squares = direction.map(Interval::square);
            let length = squares[0].plus(squares[1]).plus(squares[2]).sqrt();
            Some(angle(unit(direction, length), unit(descent, depth.length)))
        }
    }
}

/// Encloses the unit vector along a vector of a given length.
fn unit(vector: [Interval; 3], length: Interval) -> [Interval; 3] {
    let reciprocal = length.reciprocal();
    let unit_range = Interval { low: -1.0, high: 1.0 };
    vector.map(|part| part.times(reciprocal).common(unit_range))
}

/// Returns whether a vector may be 0.
pub(super) fn vanishes(vector: [Interval; 3]) -> bool {
    vector.iter().all(|part| part.low <= 0.0 && part.high >= 0.0)
}
