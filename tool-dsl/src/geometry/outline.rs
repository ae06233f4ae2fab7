//! A profile as geometry: segments and their distance functions.
//!
//! Everything is in the tool's frame, `[d, z]`, counter-clockwise: the material is on the left.

use crate::expr::{Coord, Graph, Id};
use crate::number::Number;
use crate::source::Span;
pub(crate) use crate::vector::{Point, cross, dot, minus, norm};

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
pub(crate) struct Circle {
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
    pub(crate) circle: Option<Circle>,
    pub(crate) surface: usize,
    pub(crate) span: Span,
    /// The same geometry in doubles.
    flat: Flat,
}

/// A segment in doubles.
#[derive(Clone, Debug)]
struct Flat {
    from: Point,
    to: Point,
    /// The unit direction of travel of a line.
    direction: Point,
    /// The centre, radius and convexity of an arc.
    circle: Option<(Point, f64, bool)>,
}

impl Flat {
    fn new(from: &ExactPoint, to: &ExactPoint, circle: Option<&Circle>) -> Flat {
        let [from, to] = [from, to].map(doubles);
        let circle =
            circle.map(|circle| (doubles(&circle.centre), circle.radius.to_f64(), circle.convex));
        Flat { from, to, direction: unit(minus(to, from)), circle }
    }
}

pub(crate) fn doubles(point: &ExactPoint) -> Point {
    [point[0].to_f64(), point[1].to_f64()]
}

fn unit(a: Point) -> Point {
    let length = norm(a);
    [a[0] / length, a[1] / length]
}

impl Segment {
    pub(crate) fn new(
        [from, to]: [ExactPoint; 2],
        circle: Option<Circle>,
        surface: usize,
        span: Span,
    ) -> Segment {
        let flat = Flat::new(&from, &to, circle.as_ref());
        Segment { from, to, circle, surface, span, flat }
    }

    /// Returns its start and end.
    pub(crate) fn ends(&self) -> [Point; 2] {
        [self.flat.from, self.flat.to]
    }

    /// Returns the centre and radius of an arc, and whether the material is inside the circle.
    pub(crate) fn round(&self) -> Option<(Point, f64, bool)> {
        self.flat.circle
    }

    /// Returns the polar angle of an arc's start about its centre, and the signed angle from there to its
    /// end, in radians; zeros for a line.
    pub(crate) fn angles(&self) -> [f64; 2] {
        let Some((centre, _, convex)) = self.flat.circle else { return [0.0; 2] };
        let [a, b] = self.ends().map(|end| minus(end, centre));
        let turn = cross(a, b).atan2(dot(a, b));
        let full = 2.0 * std::f64::consts::PI;
        let turn = match convex {
            true if turn < 0.0 => turn + full,
            false if turn > 0.0 => turn - full,
            _ => turn,
        };
        [a[1].atan2(a[0]), turn]
    }

    /// Returns the distance between its ends.
    pub(crate) fn chord(&self) -> f64 {
        norm(minus(self.flat.to, self.flat.from))
    }

    /// Returns the unit normal into the material at a point of the segment's line or circle.
    pub(crate) fn inward(&self, p: Point) -> Point {
        match self.flat.circle {
            None => [-self.flat.direction[1], self.flat.direction[0]],
            Some((centre, _, convex)) => {
                unit(if convex { minus(centre, p) } else { minus(p, centre) })
            }
        }
    }

    /// Returns the unit direction of travel at its start or end.
    pub(crate) fn tangent(&self, at_end: bool) -> Point {
        let Some((centre, _, convex)) = self.flat.circle else { return self.flat.direction };
        let out = unit(minus(self.ends()[usize::from(at_end)], centre));
        if convex { [-out[1], out[0]] } else { [out[1], -out[0]] }
    }

    /// Returns the signed distance of a point from the segment's whole line or circle, positive on the
    /// material's side.
    pub(crate) fn signed(&self, p: Point) -> f64 {
        match self.flat.circle {
            None => cross(self.flat.direction, minus(p, self.flat.from)),
            Some((centre, radius, convex)) => {
                let out = norm(minus(p, centre));
                if convex { radius - out } else { out - radius }
            }
        }
    }

    /// Returns the distance of a point from the segment.
    pub(crate) fn distance_to(&self, p: Point) -> f64 {
        let [before, after] = self.sector(p);
        if before < 0.0 || after < 0.0 {
            let (from, to) = (norm(minus(p, self.flat.from)), norm(minus(p, self.flat.to)));
            return from.min(to);
        }
        self.signed(p).abs()
    }

    /// Returns the distances of a point past the normal at the start and ahead of the normal at the end. Both
    /// are at least 0 where the nearest point of the segment is not one of its ends.
    pub(crate) fn sector(&self, p: Point) -> [f64; 2] {
        let [from, to] = self.ends();
        match self.flat.circle {
            None => {
                [dot(self.flat.direction, minus(p, from)), dot(self.flat.direction, minus(to, p))]
            }
            Some((centre, radius, convex)) => {
                let (a, b, q) = (minus(from, centre), minus(to, centre), minus(p, centre));
                let sides = [cross(a, q) / radius, cross(q, b) / radius];
                if convex { sides } else { sides.map(|side| -side) }
            }
        }
    }

    /// Returns the expression of [`Segment::signed`].
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

    /// Returns the expressions of [`Segment::sector`], up to a positive factor.
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

/// Returns points along a segment, including its ends.
pub(crate) fn sample_points(segment: &Segment) -> Vec<Point> {
    let [from, to] = segment.ends();
    let Some((centre, ..)) = segment.flat.circle else { return vec![from, to] };
    let (a, angle) = (minus(from, centre), segment.angles()[1]);
    const STEPS: usize = 32;
    (0..=STEPS)
        .map(|k| match k {
            0 => from,
            STEPS => to,
            _ => {
                let (sin, cos) = (angle * k as f64 / STEPS as f64).sin_cos();
                [centre[0] + a[0] * cos - a[1] * sin, centre[1] + a[0] * sin + a[1] * cos]
            }
        })
        .collect()
}

/// Returns points on a segment, each with the unit normal into the material.
pub(crate) fn points_with_normals(segment: &Segment, count: usize) -> Vec<[Point; 2]> {
    let [from, to] = segment.ends();
    let [start, turn] = segment.angles();
    (0..count)
        .map(|k| {
            let fraction = (k as f64 + 0.5) / count as f64;
            let point = match segment.flat.circle {
                None => [0, 1].map(|axis| from[axis] + fraction * (to[axis] - from[axis])),
                Some((centre, radius, _)) => {
                    let (sin, cos) = (start + fraction * turn).sin_cos();
                    [centre[0] + radius * cos, centre[1] + radius * sin]
                }
            };
            [point, segment.inward(point)]
        })
        .collect()
}

/// Returns the bounding box of an outline from its ends and the extreme points of its arcs.
pub(crate) fn bounding_box(outline: &[Segment]) -> [Point; 2] {
    let [mut low, mut high] = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    let mut widen = |p: Point| {
        for k in 0..2 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    };
    for segment in outline {
        segment.ends().into_iter().for_each(&mut widen);
        if let Some((centre, radius, _)) = segment.flat.circle {
            for direction in [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]] {
                let p = [centre[0] + radius * direction[0], centre[1] + radius * direction[1]];
                if segment.sector(p).iter().all(|side| *side >= 0.0) {
                    widen(p);
                }
            }
        }
    }
    [low, high]
}

/// Returns the location of the segment that is nearest to a point.
pub(crate) fn nearest_span(outline: &[Segment], p: Point) -> Option<Span> {
    let nearest = outline.iter().min_by(|a, b| a.distance_to(p).total_cmp(&b.distance_to(p)));
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
        for [d, z] in segment.ends() {
            if (low..=high).contains(&z) {
                widest = widest.max(d);
            }
        }
        let [[d0, z0], [d1, z1]] = segment.ends();
        match segment.flat.circle {
            None => {
                for z in [low, high] {
                    if (z0.min(z1)..=z0.max(z1)).contains(&z) && z0 != z1 {
                        widest = widest.max(rounded_up(d0 + (d1 - d0) * ((z - z0) / (z1 - z0))));
                    }
                }
            }
            Some((centre, radius, _)) => {
                let half_chord =
                    |z: f64| (radius * radius - (z - centre[1]).powi(2)).max(0.0).sqrt();
                let mut include_point = |z: f64, d: f64| {
                    if segment.sector([d, z]).iter().all(|side| *side >= -SECTOR_ROUNDING * radius)
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
