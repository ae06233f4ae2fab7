//! The borders of cells: their evaluation at a point, and the expressions whose signs give their sides.

use super::section::{Feature, FootPoint, Section};
use crate::expr::{Coord, Graph, Id};
use crate::geometry::outline::{self, Circle, ExactPoint, Point, dot, minus};
use crate::number::Number;

/// A condition on the signs of expressions.
#[derive(Clone, Debug)]
pub(crate) enum Test {
    /// The expression is at most 0.
    AtMost(Id),
    /// All of these conditions hold.
    All(Vec<Test>),
    /// At least one of these conditions holds.
    Any(Vec<Test>),
    /// The condition holds with strict inequality.
    Strictly(Box<Test>),
}

impl Test {
    /// Returns the conditions of a cell, with `sides` in place of the condition of its own line or circle, which comes
    /// first.
    pub(crate) fn without_own(self, sides: Vec<Test>) -> Test {
        match self {
            Test::All(all) => Test::All(all.into_iter().skip(1).chain(sides).collect()),
            other => other,
        }
    }
}

/// One side of a border, by its geometric meaning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Border {
    /// On the interior side of a segment's whole line or circle.
    Inside { piece: usize },
    /// Not beyond the normal at an end of a segment (0 for its start, 1 for its end).
    Before { piece: usize, end: usize },
    /// Beyond the normal at an end of a segment.
    Past { piece: usize, end: usize },
    /// No farther from `this` feature's line, circle or corner than from the other's.
    Nearer { this: usize, other: usize },
    /// Up to the normal of a feature at a parameter.
    UpTo { feature: usize, parameter: f64 },
    /// Beyond the normal of a feature at a parameter.
    From { feature: usize, parameter: f64 },
}

/// The radius, in sizes of the outline, above which an arc's distance is computed from a point on the arc.
const MAX_FLATNESS: f64 = 2.0;

impl Border {
    pub(super) fn holds(&self, section: &Section<'_>, p: Point) -> bool {
        match *self {
            Border::Inside { piece } => section.outline[piece].signed(p) >= 0.0,
            Border::Before { piece, end } => section.outline[piece].sector(p)[end] >= 0.0,
            Border::Past { piece, end } => section.outline[piece].sector(p)[end] <= 0.0,
            Border::Nearer { this, other } => {
                section.depth_at(this, p) <= section.depth_at(other, p)
            }
            Border::UpTo { feature, parameter } => {
                section.distance_beyond_normal(feature, parameter, p) <= 0.0
            }
            Border::From { feature, parameter } => {
                section.distance_beyond_normal(feature, parameter, p) >= 0.0
            }
        }
    }

    /// Returns whether a point is on this side for certain, or with a negative `margin` whether it may be: two features within
    /// the margin are equally near, which they are for long where they hardly turn.
    pub(super) fn holds_by(&self, section: &Section<'_>, p: Point, margin: f64) -> bool {
        match *self {
            Border::Nearer { this, other } => {
                section.depth_at(this, p) + margin <= section.depth_at(other, p)
            }
            _ => self.holds(section, p),
        }
    }

    /// Returns the distance along a normal at which a straight border is met; NaN for other borders.
    pub(super) fn intersection_distance(
        &self,
        section: &Section<'_>,
        foot_point: &FootPoint,
    ) -> f64 {
        let value = |p: Point| match *self {
            Border::Before { piece, end } | Border::Past { piece, end } => {
                section.outline[piece].sector(p)[end]
            }
            Border::UpTo { feature, parameter } | Border::From { feature, parameter } => {
                section.distance_beyond_normal(feature, parameter, p)
            }
            Border::Inside { .. } | Border::Nearer { .. } => f64::NAN,
        };
        let (near, far) = (value(foot_point.at(0.0)), value(foot_point.at(section.size)));
        section.size * near / (near - far)
    }

    /// Returns the condition of this side; `None` where a constant has no value.
    pub(super) fn test(&self, section: &Section<'_>, graph: &mut Graph) -> Option<Test> {
        match *self {
            Border::Inside { piece } => match &section.outline[piece].circle {
                Some(circle) if !section.is_flat(circle) => {
                    let square = graph.number(&circle.radius * &circle.radius);
                    let squared_distance = outline::squared_distance(graph, &circle.centre);
                    Some(Test::AtMost(if circle.convex {
                        graph.sub(squared_distance, square)
                    } else {
                        graph.sub(square, squared_distance)
                    }))
                }
                _ => {
                    let depth = section.piece_depth(graph, piece)?;
                    Some(Test::AtMost(graph.neg(depth)))
                }
            },
            Border::Before { piece, end } => {
                let side = section.outline[piece].sides(graph)?[end];
                Some(Test::AtMost(graph.neg(side)))
            }
            Border::Past { piece, end } => {
                Some(Test::AtMost(section.outline[piece].sides(graph)?[end]))
            }
            Border::Nearer { this, other } => section.nearer(graph, this, other),
            Border::UpTo { feature, parameter } => {
                Some(Test::AtMost(section.normal_function(graph, feature, parameter)?))
            }
            Border::From { feature, parameter } => {
                let side = section.normal_function(graph, feature, parameter)?;
                Some(Test::AtMost(graph.neg(side)))
            }
        }
    }
}

impl Section<'_> {
    pub(super) fn is_flat(&self, circle: &Circle) -> bool {
        circle.radius.to_f64() > MAX_FLATNESS * self.size
    }

    pub(super) fn corner(&self, previous: Option<usize>) -> &ExactPoint {
        match previous {
            Some(piece) => &self.outline[piece].to,
            None => &self.outline[0].from,
        }
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

    /// Returns the signed distance of a point beyond the normal of a feature at a parameter.
    fn distance_beyond_normal(&self, feature: usize, parameter: f64, p: Point) -> f64 {
        let (from, direction) = self.normal_line(feature, parameter);
        dot(direction, minus(p, from))
    }

    /// Returns a point of a normal, and the direction across it toward larger parameters.
    fn normal_line(&self, feature: usize, parameter: f64) -> (Point, Point) {
        let foot_point = self.foot_point(feature, parameter);
        let direction = match self.features[feature] {
            Feature::Piece(piece) => match self.outline[piece].round() {
                None => self.outline[piece].tangent(false),
                Some((_, _, convex)) => {
                    // Counter-clockwise about the centre of a convex arc, clockwise about that of a concave one.
                    let out = if convex {
                        [-foot_point.normal[0], -foot_point.normal[1]]
                    } else {
                        foot_point.normal
                    };
                    if convex { [-out[1], out[0]] } else { [out[1], -out[0]] }
                }
            },
            Feature::Corner(_) => [foot_point.normal[1], -foot_point.normal[0]],
        };
        (foot_point.foot, direction)
    }

    fn normal_function(&self, graph: &mut Graph, feature: usize, parameter: f64) -> Option<Id> {
        let (from, direction) = self.normal_line(feature, parameter);
        let [from, direction] =
            [from, direction].map(|[d, z]| Some([Number::from_f64(d)?, Number::from_f64(z)?]));
        outline::linear(graph, direction?, &from?)
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
