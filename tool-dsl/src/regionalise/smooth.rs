//! Rounds the corners of an outline. Directions are taken from the rounded outline.
//!
//! A corner is rounded by the largest arc that touches both of its segments within a length `w` of it, measured along
//! them. The normals of the arc are the corner's fan. Between lines the arc touches both at `w`, and its radius is
//! `w / tan(θ/2)`, where θ is the turn. Next to an arc it touches one segment at `w` and the other nearer to the
//! corner. The normals of the rounded outline turn continuously, so a direction that follows them does not jump along
//! the surface.

use crate::diagnostic::format_number;
use crate::geometry::outline::{
    ExactCircle, ExactPoint, Segment, cross, dot, doubles, minus, mirrored_direction, turn,
};
use crate::number::Number;
use std::f64::consts::PI;
use touchoff_plane::Circle;

/// The relative accuracy with which the longest length of `smooth` is found: finer than what is shown of it.
const LENGTH_ACCURACY: f64 = 1e-9;

/// The relative rounding of the six digits that are shown.
const SHOWN_ROUNDING: f64 = 1e-5;

/// The relative difference below which two lengths count as equal.
const ROUNDING: f64 = 1e-12;

/// The origin of a segment of the rounded outline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// A segment of the outline, by its index.
    Piece(usize),
    /// The corner at the end of a segment; for `None`, the one before the first segment.
    Fan(Option<usize>),
}

/// The reason why an outline cannot be rounded.
pub(crate) enum Rough {
    /// No arc near enough to the corner at the end of a segment touches both of its segments.
    Untouched(Option<usize>),
    /// A segment is too short for its corners: its index, its length, and the number of its corners.
    Short(usize, f64, usize),
}

/// Returns the rounded outline with the origin of each segment.
pub(crate) fn rounded(
    outline: &[Segment],
    length: &Number,
) -> Result<Vec<(Segment, Origin)>, Rough> {
    let count = outline.len();
    // Corner `k` precedes segment `k`; the last corner follows all segments.
    let corners: Vec<Option<Corner>> =
        (0..=count).map(|k| corner(outline, k, length)).collect::<Result<_, _>>()?;
    let fraction_available = |k: &usize| {
        let before = corners[*k].as_ref().map_or(0.0, |corner| corner.taken[1]);
        let after = corners[*k + 1].as_ref().map_or(0.0, |corner| corner.taken[0]);
        size(&outline[*k]) / (before + after)
    };
    if let Some(tightest) =
        (0..count).min_by(|a, b| fraction_available(a).total_cmp(&fraction_available(b)))
        && 1.0 > fraction_available(&tightest) * (1.0 + ROUNDING)
    {
        let fans = corners[tightest..].iter().take(2).flatten().count();
        return Err(Rough::Short(tightest, size(&outline[tightest]), fans));
    }
    let mut pieces = Vec::new();
    for (k, segment) in outline.iter().enumerate() {
        let (before, after) = (&corners[k], &corners[k + 1]);
        if k == 0
            && let Some(corner) = before
        {
            pieces.push((corner.arc(segment), Origin::Fan(None)));
        }
        // Two corners may take a segment wholly.
        if fraction_available(&k) * (1.0 - ROUNDING) > 1.0 {
            let from = before.as_ref().map_or(&segment.from, |corner| &corner.to);
            let to = after.as_ref().map_or(&segment.to, |corner| &corner.from);
            let ends = [from.clone(), to.clone()];
            let shortened =
                Segment::new(ends, segment.circle.clone(), segment.geometry.surface, segment.span);
            pieces.push((shortened, Origin::Piece(k)));
        }
        if let Some(corner) = after {
            pieces.push((corner.arc(segment), Origin::Fan(Some(k))));
        }
    }
    Ok(pieces)
}

/// Returns a length below `length` for which the outline can be rounded, usually close to the largest such number of
/// six digits.
pub(crate) fn largest_fitting_length(outline: &[Segment], length: &Number) -> Option<String> {
    let is_roundable =
        |length: f64| Number::from_f64(length).is_some_and(|w| rounded(outline, &w).is_ok());
    let halves = (1..64).map(|k| length.to_f64() / f64::from(k).exp2());
    let mut low = halves.into_iter().find(|length| is_roundable(*length))?;
    let mut high = 2.0 * low;
    while high - low > LENGTH_ACCURACY * high {
        let middle = f64::midpoint(low, high);
        if is_roundable(middle) { low = middle } else { high = middle }
    }
    // The six digits that are shown may be rounded up beyond the limit.
    let shown = [low, low * (1.0 - SHOWN_ROUNDING)].map(format_number);
    shown.into_iter().find(|text| text.parse().is_ok_and(is_roundable))
}

/// Returns the length along a segment.
fn size(segment: &Segment) -> f64 {
    match segment.geometry.circle {
        None => segment.geometry.chord,
        Some(Circle { radius, .. }) => radius * segment.geometry.turn().abs(),
    }
}

/// The arc of a corner.
struct Corner {
    from: ExactPoint,
    to: ExactPoint,
    circle: ExactCircle,
    /// The lengths that it takes from the segments before and after the corner.
    taken: [f64; 2],
}

impl Corner {
    fn arc(&self, beside: &Segment) -> Segment {
        let ends = [self.from.clone(), self.to.clone()];
        Segment::new(ends, Some(self.circle.clone()), beside.geometry.surface, beside.span)
    }
}

fn corner(outline: &[Segment], k: usize, length: &Number) -> Result<Option<Corner>, Rough> {
    let behind = k.checked_sub(1);
    let (before, after) = (behind.map(|k| &outline[k]), outline.get(k));
    // At the axis the outline meets its mirror image.
    let incoming = before.map(|s| s.geometry.tangent(1));
    let outgoing = after.map(|s| s.geometry.tangent(0));
    let (Some(a), Some(b)) = (
        incoming.or(outgoing.map(mirrored_direction)),
        outgoing.or(incoming.map(mirrored_direction)),
    ) else {
        return Ok(None);
    };
    let turned = turn(a, b);
    // A smooth joint is rounded already.
    if turned == 0.0 {
        return Ok(None);
    }
    let convex = turned > 0.0;
    let arm = |segment, at_end| Arm { segment, at_end, convex };
    let found = match (before, after) {
        (Some(before), Some(after)) => {
            let (before, after) = (arm(before, true), arm(after, false));
            fan(&before, &after, length)
                // The arc touches one of the segments at `length`, and which one is not known before.
                .or_else(|| fan(&after, &before, length).map(Corner::turned))
        }
        (None, Some(after)) => arm(after, false).half_arc_on_axis(length),
        (Some(before), None) => arm(before, true).half_arc_on_axis(length).map(Corner::turned),
        (None, None) => return Ok(None),
    };
    found.map(Some).ok_or(Rough::Untouched(behind))
}

impl Corner {
    fn turned(self) -> Corner {
        let [before, behind] = self.taken;
        Corner { from: self.to, to: self.from, taken: [behind, before], ..self }
    }
}

/// A segment that ends in a corner. `convex` is true if the material lies inside the corner's arc.
struct Arm<'o> {
    segment: &'o Segment,
    at_end: bool,
    convex: bool,
}

impl Arm<'_> {
    fn corner(&self) -> &ExactPoint {
        if self.at_end { &self.segment.to } else { &self.segment.from }
    }

    /// Returns the unit direction of a line, away from the corner.
    fn direction_from_corner(&self) -> Option<ExactPoint> {
        let direction = self.segment.direction()?;
        Some(if self.at_end { direction.map(|part| -&part) } else { direction })
    }

    /// Returns the unit normal at a point, toward the centre of the corner's arc.
    fn normal(&self, point: &ExactPoint) -> Option<ExactPoint> {
        let (normal, inward) = match &self.segment.circle {
            None => {
                let [d, z] = self.segment.direction()?;
                ([-&z, d], true)
            }
            Some(circle) => {
                let radial =
                    offset(point, &circle.centre).map(|part| part.checked_div(&circle.radius));
                let [Some(d), Some(z)] = radial else { return None };
                ([d, z], !circle.convex)
            }
        };
        Some(if inward == self.convex { normal } else { normal.map(|part| -&part) })
    }

    /// Returns whether a circle has the same convexity as the corner's arc.
    fn is_alike(&self, circle: &ExactCircle) -> bool {
        circle.convex == self.convex
    }

    /// Returns the point at a length from the corner along the segment's whole line or circle; `None` if that is half a
    /// circle or more.
    fn point(&self, length: &Number) -> Option<ExactPoint> {
        let corner = self.corner();
        let Some(circle) = &self.segment.circle else {
            return Some(point_along(corner, &self.direction_from_corner()?, length));
        };
        let angle = length.checked_div(&circle.radius)?;
        if angle.to_f64() >= PI {
            return None;
        }
        // From the end of a convex arc, away from the corner is clockwise.
        let (cos, sin) = (angle.cos(), angle.sin());
        let sin = if circle.convex == self.at_end { -&sin } else { sin };
        let [d, z] = offset(corner, &circle.centre);
        let turned = [&(&cos * &d) - &(&sin * &z), &(&sin * &d) + &(&cos * &z)];
        Some([0, 1].map(|k| &circle.centre[k] + &turned[k]))
    }

    /// Returns the distance of a point of the segment's line or circle from the corner, along it; negative on the other
    /// side.
    fn distance(&self, point: &ExactPoint) -> Option<f64> {
        let direction = doubles(&offset(point, self.corner()));
        Some(match self.segment.geometry.circle {
            None => dot(direction, doubles(&self.direction_from_corner()?)),
            Some(Circle { centre, radius, convex }) => {
                let [from, to] =
                    [self.corner(), point].map(|end_point| minus(doubles(end_point), centre));
                let turn = cross(from, to).atan2(dot(from, to)) * radius;
                if convex == self.at_end { -turn } else { turn }
            }
        })
    }

    /// Returns the radius of the circle that touches another segment at a point with this normal, and also touches this
    /// segment.
    fn radius(&self, point: &ExactPoint, normal: &ExactPoint) -> Option<Number> {
        match &self.segment.circle {
            None => {
                let own = self.normal(self.corner())?;
                let height = product(&offset(point, self.corner()), &own);
                height.checked_div(&(&Number::int(1) - &product(normal, &own)))
            }
            Some(circle) => {
                let offset = offset(point, &circle.centre);
                let numerator = &(&circle.radius * &circle.radius) - &product(&offset, &offset);
                let radial = product(&offset, normal);
                let two = Number::int(2);
                if self.is_alike(circle) {
                    numerator.checked_div(&(&two * &(&circle.radius + &radial)))
                } else {
                    (-&numerator).checked_div(&(&two * &(&circle.radius - &radial)))
                }
            }
        }
    }

    /// Returns the point at which a circle that touches the segment does so.
    fn contact_point(&self, centre: &ExactPoint, radius: &Number) -> Option<ExactPoint> {
        let Some(circle) = &self.segment.circle else {
            let (corner, direction) = (self.corner(), self.direction_from_corner()?);
            return Some(point_along(
                corner,
                &direction,
                &product(&offset(centre, corner), &direction),
            ));
        };
        let signed_radius = if self.is_alike(circle) { -radius } else { radius.clone() };
        // Circles that touch do so on the line through their centres.
        let ratio = circle.radius.checked_div(&(&circle.radius + &signed_radius))?;
        Some(point_along(&circle.centre, &offset(centre, &circle.centre), &ratio))
    }

    /// Returns whether a circle that touches the segment from the inside is smaller than the segment's own circle.
    fn admits_radius(&self, radius: &Number) -> bool {
        let circle = self.segment.circle.as_ref();
        circle.is_none_or(|circle| !self.is_alike(circle) || *radius < circle.radius)
    }

    /// Returns half the arc of a corner on the axis, from the axis to the point at which it touches the segment.
    fn half_arc_on_axis(&self, length: &Number) -> Option<Corner> {
        let to = self.point(length)?;
        let normal = self.normal(&to)?;
        // The centre is on the axis.
        let radius = (-&to[0]).checked_div(&normal[0])?;
        // The circle would be on the other side of the segment, or around the segment's own circle.
        if radius.to_f64() <= 0.0 || !self.admits_radius(&radius) {
            return None;
        }
        let centre = [Number::int(0), &to[1] + &(&radius * &normal[1])];
        let is_upper = self.at_end == self.convex;
        let pole = if is_upper { &centre[1] + &radius } else { &centre[1] - &radius };
        let from = [Number::int(0), pole];
        let circle = ExactCircle { centre, radius, convex: self.convex };
        Some(Corner { from, to, circle, taken: [0.0, length.to_f64()] })
    }
}

/// Returns the arc that touches the first segment of a corner at `length` from it, and the second one no farther away.
fn fan(first: &Arm<'_>, second: &Arm<'_>, length: &Number) -> Option<Corner> {
    let from = first.point(length)?;
    let normal = first.normal(&from)?;
    let radius = second.radius(&from, &normal)?;
    if radius.to_f64() <= 0.0 || !first.admits_radius(&radius) || !second.admits_radius(&radius) {
        return None;
    }
    let centre = point_along(&from, &normal, &radius);
    let to = second.contact_point(&centre, &radius)?;
    let (max_length, other) = (length.to_f64(), second.distance(&to)?);
    let circle = ExactCircle { centre, radius, convex: first.convex };
    let is_near = other > 0.0 && other <= max_length * (1.0 + ROUNDING);
    is_near.then_some(Corner { from, to, circle, taken: [max_length, other] })
}

fn offset(to: &ExactPoint, from: &ExactPoint) -> ExactPoint {
    [0, 1].map(|k| &to[k] - &from[k])
}

fn point_along(from: &ExactPoint, direction: &ExactPoint, by: &Number) -> ExactPoint {
    [0, 1].map(|k| &from[k] + &(&direction[k] * by))
}

fn product(a: &ExactPoint, b: &ExactPoint) -> Number {
    &(&a[0] * &b[0]) + &(&a[1] * &b[1])
}
