//! A profile as geometry: segments in 256 bits, the same in doubles, and the expressions of their distances.
//!
//! Everything is in the tool's frame, `[d, z]`, counter-clockwise: the material is on the left.

use crate::expr::{Coord, Graph, Id};
use crate::number::Number;
use crate::source::Span;
pub(crate) use touchoff_plane::{Point, cross, dot, minus, norm};

/// The size below which a component of a unit vector has cancelled in 256 bits.
pub(crate) const CANCELLED: f64 = 1e-60;

/// The way out of the sector of its arc, in radii, by which rounding may move a point. A point that is not on the arc only widens the bound.
const SECTOR_ROUNDING: f64 = 1e-12;

/// A point with exact coordinates.
pub(crate) type ExactPoint = [Number; 2];

/// The sine of the angle below which two directions count as tangent.
pub(crate) const TANGENT_SINE: f64 = 1e-9;

/// The circle of an arc.
#[derive(Clone, Debug)]
pub(crate) struct ExactCircle {
    pub(crate) centre: ExactPoint,
    pub(crate) radius: Number,
    /// True if the material is inside the circle.
    pub(crate) convex: bool,
}

/// One segment of a profile.
#[derive(Clone, Debug)]
pub(crate) struct Segment {
    pub(crate) from: ExactPoint,
    pub(crate) to: ExactPoint,
    pub(crate) circle: Option<ExactCircle>,
    pub(crate) span: Span,
    /// The same geometry in doubles.
    pub(crate) geometry: touchoff_plane::Segment,
}

pub(crate) fn doubles(point: &ExactPoint) -> Point {
    [point[0].to_f64(), point[1].to_f64()]
}

impl Segment {
    pub(crate) fn new(
        [from, to]: [ExactPoint; 2],
        circle: Option<ExactCircle>,
        surface: usize,
        span: Span,
    ) -> Segment {
        let in_doubles = circle.as_ref().map(|circle| touchoff_plane::Circle {
            centre: doubles(&circle.centre),
            radius: circle.radius.to_f64(),
            convex: circle.convex,
        });
        let geometry = touchoff_plane::Segment::new([&from, &to].map(doubles), in_doubles, surface);
        Segment { from, to, circle, span, geometry }
    }

    /// Returns the expression of [`touchoff_plane::Segment::signed_distance`].
    pub(crate) fn depth(&self, graph: &mut Graph) -> Option<Id> {
        match &self.circle {
            None => {
                let [tx, tz] = self.direction()?;
                if tx.is_zero() || tz.is_zero() {
                    return linear(graph, [-&tz, tx], &self.from);
                }
                // Anchoring at a point of the line avoids cancellation far from the tip.
                Some(anchored(graph, [-&tz, tx], &self.from))
            }
            Some(circle) => {
                let out = distance(graph, &circle.centre)?;
                let radius = graph.number(circle.radius.clone());
                Some(if circle.convex { graph.sub(radius, out) } else { graph.sub(out, radius) })
            }
        }
    }

    /// Returns the expressions of [`touchoff_plane::Segment::sector`], up to a positive factor.
    pub(crate) fn sides(&self, graph: &mut Graph) -> Option<[Id; 2]> {
        match &self.circle {
            None => {
                let [tx, tz] = self.direction()?;
                let back = [-&tx, -&tz];
                Some([linear(graph, [tx, tz], &self.from)?, linear(graph, back, &self.to)?])
            }
            Some(circle) => {
                let radial = |point: &ExactPoint| -> Option<[Number; 2]> {
                    let [d, z] = [0, 1].map(|k| &point[k] - &circle.centre[k]);
                    Some([d.checked_div(&circle.radius)?, z.checked_div(&circle.radius)?])
                };
                let ([ad, az], [bd, bz]) = (radial(&self.from)?, radial(&self.to)?);
                // cross(a, q) = a_d q_z - a_z q_d
                let (first, last) = ([-&az, ad], [bz, -&bd]);
                let turn = |direction: [Number; 2]| {
                    if circle.convex { direction } else { direction.map(|part| -&part) }
                };
                Some([
                    linear(graph, turn(first), &circle.centre)?,
                    linear(graph, turn(last), &circle.centre)?,
                ])
            }
        }
    }

    /// Returns the unit direction of a line, to 256 bits.
    pub(crate) fn direction(&self) -> Option<[Number; 2]> {
        unit_between(&self.from, &self.to)
    }
}

/// Returns the unit vector from one point to another, to 256 bits; none if they coincide.
pub(crate) fn unit_between(from: &ExactPoint, to: &ExactPoint) -> Option<[Number; 2]> {
    let [d, z] = [0, 1].map(|k| &to[k] - &from[k]);
    let length = (&(&d * &d) + &(&z * &z)).sqrt()?;
    Some([d.checked_div(&length)?, z.checked_div(&length)?])
}

/// Returns `direction · (p - from)`, computed from the difference, so that its rounding error is proportional to
/// the distance from `from`.
pub(crate) fn anchored(graph: &mut Graph, direction: [Number; 2], from: &ExactPoint) -> Id {
    let [d, z] = [Coord::D, Coord::Z].map(|coord| graph.coord(coord));
    let [from_d, from_z] = from.clone().map(|part| graph.number(part));
    let [offset_d, offset_z] = [graph.sub(d, from_d), graph.sub(z, from_z)];
    let [way_d, way_z] = direction.map(|part| graph.number(part));
    let [d, z] = [graph.mul(way_d, offset_d), graph.mul(way_z, offset_z)];
    graph.add(d, z)
}

/// Returns the same with its constants combined.
pub(crate) fn linear(graph: &mut Graph, direction: [Number; 2], from: &ExactPoint) -> Option<Id> {
    let constant = -&(&(&direction[0] * &from[0]) + &(&direction[1] * &from[1]));
    // A value that cancels in 256 bits is 0.
    let without_residue =
        |value: Number| if value.to_f64().abs() < CANCELLED { Number::int(0) } else { value };
    let [wd, wz] = direction.map(without_residue);
    let (d, z) = (graph.coord(Coord::D), graph.coord(Coord::Z));
    let (wd, wz, constant) = (graph.number(wd), graph.number(wz), graph.number(constant));
    let (d, z) = (graph.mul(wd, d), graph.mul(wz, z));
    let sum = graph.add(d, z);
    Some(graph.add(sum, constant))
}

/// Returns the squared distance from a point.
pub(crate) fn squared_distance(graph: &mut Graph, point: &ExactPoint) -> Id {
    let coordinates = [Coord::D, Coord::Z].map(|coord| graph.coord(coord));
    let squares = [0, 1].map(|k| {
        let constant = graph.number(point[k].clone());
        let part = graph.sub(coordinates[k], constant);
        graph.mul(part, part)
    });
    graph.add(squares[0], squares[1])
}

/// Returns the distance from a point.
pub(crate) fn distance(graph: &mut Graph, point: &ExactPoint) -> Option<Id> {
    let square = squared_distance(graph, point);
    graph.sqrt(square)
}

/// Returns the sine of the turn from one direction to the next: positive to the left, 0 if they are tangent.
pub(crate) fn turn(incoming: Point, outgoing: Point) -> f64 {
    let sine = cross(incoming, outgoing);
    if sine.abs() < TANGENT_SINE && dot(incoming, outgoing) > 0.0 { 0.0 } else { sine }
}

/// Returns points on a segment, each with the unit normal into the material.
pub(crate) fn points_with_normals(segment: &Segment, count: usize) -> Vec<[Point; 2]> {
    let fraction = |k: usize| (k as f64 + 0.5) / count as f64;
    let places = (0..count).map(|k| segment.geometry.place(fraction(k)));
    places.map(|place| [place.point, place.outward().map(|part| -part)]).collect()
}

/// Returns the bounding box of an outline.
pub(crate) fn bounding_box(outline: &[Segment]) -> [Point; 2] {
    let none = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    let boxes = outline.iter().map(|segment| segment.geometry.bounding_box());
    boxes.fold(none, |[low, high], [lowest, highest]| {
        [[0, 1].map(|k| low[k].min(lowest[k])), [0, 1].map(|k| high[k].max(highest[k]))]
    })
}

/// Returns the location of the segment that is nearest to a point.
pub(crate) fn nearest_span(outline: &[Segment], p: Point) -> Option<Span> {
    let nearest =
        outline.iter().min_by(|a, b| a.geometry.distance(p).total_cmp(&b.geometry.distance(p)));
    nearest.map(|segment| segment.span)
}

/// Rounds up by more than the rounding errors of a radius that was interpolated or computed by Pythagoras.
fn rounded_up(d: f64) -> f64 {
    d * (1.0 + 4.0 * f64::EPSILON)
}

/// Returns the largest radius of an outline between two heights, rounded up unless it is that of an end.
pub(crate) fn radius_between(outline: &[Segment], low: f64, high: f64) -> f64 {
    let mut widest = 0.0f64;
    for segment in outline {
        for [d, z] in segment.geometry.ends {
            if (low..=high).contains(&z) {
                widest = widest.max(d);
            }
        }
        let [[d0, z0], [d1, z1]] = segment.geometry.ends;
        match segment.geometry.circle {
            None => {
                for z in [low, high] {
                    if (z0.min(z1)..=z0.max(z1)).contains(&z) && z0 != z1 {
                        widest = widest.max(rounded_up(d0 + (d1 - d0) * ((z - z0) / (z1 - z0))));
                    }
                }
            }
            Some(touchoff_plane::Circle { centre, radius, .. }) => {
                let half_chord =
                    |z: f64| (radius * radius - (z - centre[1]).powi(2)).max(0.0).sqrt();
                let mut include_point = |z: f64, d: f64| {
                    if segment
                        .geometry
                        .sector([d, z])
                        .iter()
                        .all(|side| *side >= -SECTOR_ROUNDING * radius)
                    {
                        widest = widest.max(rounded_up(d));
                    }
                };
                for z in [low, high] {
                    if (z - centre[1]).abs() <= radius {
                        include_point(z, centre[0] + half_chord(z));
                        include_point(z, centre[0] - half_chord(z));
                    }
                }
                if (low..=high).contains(&centre[1]) {
                    include_point(centre[1], centre[0] + radius);
                }
            }
        }
    }
    widest
}

/// Returns the direction in which the mirror image of a path with a given direction is passed backward: that in which
/// an outline comes from the axis, or goes on beyond it.
pub(crate) fn mirrored_direction([d, z]: Point) -> Point {
    [d, -z]
}
