//! The expressions of distances from features, of their interior sides and of the directions to them.

use super::section::{Feature, Section};
use crate::expr::{Coord, Graph, Id};
use crate::geometry::outline::{self, ExactCircle, ExactPoint};
use crate::number::Number;

/// A condition on the signs of expressions.
#[derive(Clone, Debug)]
pub(crate) enum Test {
    /// The same for all points.
    Const(bool),
    /// The expression is at most 0.
    AtMost(Id),
    /// All of these conditions hold.
    All(Vec<Test>),
    /// At least one of these conditions holds.
    Any(Vec<Test>),
}

/// The radius, in sizes of the outline, above which an arc's distance is computed from a point on the arc.
const MAX_FLATNESS: f64 = 2.0;

impl Section<'_> {
    pub(super) fn is_flat(&self, circle: &ExactCircle) -> bool {
        circle.radius.to_f64() > MAX_FLATNESS * self.size
    }

    pub(super) fn corner(&self, previous: Option<usize>) -> &ExactPoint {
        match previous {
            Some(piece) => &self.outline[piece].to,
            None => &self.outline[0].from,
        }
    }

    /// Returns the condition of the interior side of a segment's line or circle; `None` where a constant has no value.
    pub(super) fn inside(&self, graph: &mut Graph, piece: usize) -> Option<Test> {
        Some(match &self.outline[piece].circle {
            Some(circle) if !self.is_flat(circle) => {
                let square = graph.number(&circle.radius * &circle.radius);
                let squared_distance = outline::squared_distance(graph, &circle.centre);
                Test::AtMost(if circle.convex {
                    graph.sub(squared_distance, square)
                } else {
                    graph.sub(square, squared_distance)
                })
            }
            _ => {
                let depth = self.piece_depth(graph, piece)?;
                Test::AtMost(graph.neg(depth))
            }
        })
    }

    /// Returns the condition of a point not to be beyond the normal at an end of a segment: 0 for its start, 1 for its end.
    pub(super) fn before(&self, graph: &mut Graph, piece: usize, end: usize) -> Option<Test> {
        let side = self.outline[piece].sides(graph)?[end];
        Some(Test::AtMost(graph.neg(side)))
    }

    /// Returns the expression of a feature's distance.
    pub(crate) fn depth(&self, graph: &mut Graph, feature: usize) -> Option<Id> {
        match self.features[feature] {
            Feature::Piece(piece) => self.piece_depth(graph, piece),
            Feature::Corner(previous) => outline::distance(graph, self.corner(previous)),
        }
    }

    /// Returns the expression of the signed distance from a segment's line or circle.
    ///
    /// `r - |p - c|` loses as many digits as `r` exceeds the tool's size by. The distance from a flat arc is therefore
    /// computed from its middle `m`, with `w` the vector from there and `e` the outward direction from the centre:
    /// `-(w² + 2 r e·w) / (r + |p - c|)`.
    fn piece_depth(&self, graph: &mut Graph, piece: usize) -> Option<Id> {
        let segment = &self.outline[piece];
        let Some(circle) = segment.circle.as_ref().filter(|circle| self.is_flat(circle)) else {
            return segment.depth(graph);
        };
        let direction = [0, 1]
            .map(|k| &(&(&segment.from[k] + &segment.to[k]) / &Number::int(2)) - &circle.centre[k]);
        let length =
            (&(&direction[0] * &direction[0]) + &(&direction[1] * &direction[1])).sqrt()?;
        let outward = direction.map(|part| &part / &length);
        let middle = [0, 1].map(|k| &circle.centre[k] + &(&outward[k] * &circle.radius));
        let square = outline::squared_distance(graph, &middle);
        let rise = outline::linear(graph, outward, &middle)?;
        let (per_radius, two) =
            (graph.number(Number::int(1).checked_div(&circle.radius)?), graph.int(2));
        let (scaled, rise) = (graph.mul(per_radius, square), graph.mul(two, rise));
        let numerator = graph.add(scaled, rise);
        let (distance, one) = (outline::distance(graph, &circle.centre)?, graph.int(1));
        let denominator = graph.mul(per_radius, distance);
        let denominator = graph.add(denominator, one);
        let out = graph.div(numerator, denominator)?;
        Some(if circle.convex { graph.neg(out) } else { out })
    }
}

fn offset_from(graph: &mut Graph, point: &ExactPoint) -> [Id; 2] {
    let coordinates = [Coord::D, Coord::Z].map(|coord| graph.coord(coord));
    let constants = point.clone().map(|part| graph.number(part));
    [graph.sub(coordinates[0], constants[0]), graph.sub(coordinates[1], constants[1])]
}

/// Returns the direction to a feature's surface, not normalised.
pub(crate) fn direction_to_surface(
    graph: &mut Graph,
    outline: &[outline::Segment],
    feature: Feature,
) -> Option<[Id; 2]> {
    Some(match feature {
        Feature::Piece(index) => match &outline[index].circle {
            None => {
                let [d, z] = outline[index].direction()?;
                [graph.number(z), graph.number(-&d)]
            }
            Some(circle) => {
                let offset = offset_from(graph, &circle.centre);
                if circle.convex { offset } else { offset.map(|part| graph.neg(part)) }
            }
        },
        Feature::Corner(previous) => {
            let point = match previous {
                Some(piece) => &outline[piece].to,
                None => &outline.first()?.from,
            };
            offset_from(graph, point).map(|part| graph.neg(part))
        }
    })
}
