//! The cells of a profile's features, in closed form.
//!
//! A ball that touches a feature at a foot grows along the normal there until another feature stops it. Its centre is then
//! on the border of the two: on a bisector of lines, a parabola of a line and a point or circle, an ellipse or a hyperbola
//! of two circles. A cell is the area between a feature and the ends of its normals.

use super::section::{Polygon, Split, simplified};
use super::stroke::Stroke;
use std::f64::consts::PI;
use touchoff_dsl::model::ProfileSegment;
use touchoff_dsl::vector::{Point, cross, dot, minus, norm};

/// The parameters of a feature's outermost normals are this and its difference from 1. At the very ends balls are limits.
const END: f64 = 2e-5;
/// The number of intervals of a feature at whose ends its normals are measured first.
const FIRST_INTERVALS: u32 = 8;
/// The greatest number of halvings of such an interval.
const MAX_HALVINGS: u32 = 32;
/// The distance within which the joints of cells are found, relative to the largest distance of chords.
const JOINT_FRACTION: f64 = 1e-3;
/// The sine of the angle below which segments are tangent, as in the language.
const TANGENT_SINE: f64 = 1e-9;
/// The distance, in sizes, by which a ball may touch a feature beyond its end.
const TOUCHING_FRACTION: f64 = 1e-9;

/// A segment, or a reflex corner, which is a concave arc of radius 0.
#[derive(Clone, Copy)]
enum Feature {
    /// A line by its start, its unit direction and its length.
    Line { from: Point, along: Point, length: f64 },
    /// An arc from a polar angle, by a signed angle. The material is inside the circle if it is convex.
    Arc { centre: Point, radius: f64, convex: bool, start: f64, sweep: f64 },
}

/// The end of a ball's growth.
#[derive(Clone, Copy, PartialEq)]
enum Stop {
    Feature(usize),
    Axis,
    /// The centre of the feature's own arc.
    Centre,
}

/// The normal at a parameter from 0 to 1 along a feature, up to where the ball stops.
#[derive(Clone, Copy)]
struct Normal {
    parameter: f64,
    foot: Point,
    end: Point,
    stop: Stop,
}

impl Normal {
    fn length(&self) -> f64 {
        norm(minus(self.end, self.foot))
    }
}

/// The areas of cells and the lines between them.
#[derive(Default)]
pub(super) struct Cells {
    /// A polygon for each feature.
    pub(super) areas: Vec<Polygon>,
    pub(super) splits: Vec<Split>,
    /// Points of the axis, each with the feature whose normals end there.
    pub(super) axis: Vec<(usize, Point)>,
}

/// Returns the cells of a profile, whose chords deviate by at most `flat`.
pub(super) fn cells(profile: &[ProfileSegment], size: f64, flat: f64) -> Cells {
    let features = features(profile);
    let mut cells = Cells::default();
    for index in 0..features.len() {
        let cell = Cell { features: &features, profile, index, size, flat };
        cell.add_to(&mut cells);
    }
    cells
}

/// Returns the segments and, after each, the reflex corner at its end. At the axis half of a corner is that of the mirror
/// image.
fn features(profile: &[ProfileSegment]) -> Vec<Feature> {
    let mut features = Vec::new();
    let (Some(first), Some(last)) = (profile.first(), profile.last()) else { return features };
    let start = Feature::of(first).tangent(0.0);
    let mirrored = |[d, z]: Point| [d, -z];
    if let Some((angle, sweep)) = fan(mirrored(start), start) {
        features.push(corner(first.ends[0], angle + sweep / 2.0, sweep / 2.0));
    }
    for (index, segment) in profile.iter().enumerate() {
        let feature = Feature::of(segment);
        features.push(feature);
        let incoming = feature.tangent(1.0);
        let next = profile.get(index + 1);
        let outgoing = next.map_or(mirrored(incoming), |next| Feature::of(next).tangent(0.0));
        if let Some((angle, sweep)) = fan(incoming, outgoing) {
            let sweep = if std::ptr::eq(segment, last) { sweep / 2.0 } else { sweep };
            features.push(corner(segment.ends[1], angle, sweep));
        }
    }
    features
}

/// Returns the angles of the normals at a reflex corner between two directions: the first, and the turn to the last.
fn fan(incoming: Point, outgoing: Point) -> Option<(f64, f64)> {
    let (sine, cosine) = (cross(incoming, outgoing), dot(incoming, outgoing));
    let is_tangent = sine.abs() < TANGENT_SINE && cosine > 0.0;
    (sine < 0.0 && !is_tangent).then(|| (incoming[0].atan2(-incoming[1]), sine.atan2(cosine)))
}

fn corner(centre: Point, start: f64, sweep: f64) -> Feature {
    Feature::Arc { centre, radius: 0.0, convex: false, start, sweep }
}

impl Feature {
    fn of(segment: &ProfileSegment) -> Feature {
        let [from, to] = segment.ends;
        let Some((centre, radius, convex)) = segment.circle else {
            let length = norm(minus(to, from));
            let along = minus(to, from).map(|part| part / length);
            return Feature::Line { from, along, length };
        };
        let (a, b) = (minus(from, centre), minus(to, centre));
        let turn = cross(a, b).atan2(dot(a, b));
        let sweep = match convex {
            true if turn < 0.0 => turn + 2.0 * PI,
            false if turn > 0.0 => turn - 2.0 * PI,
            _ => turn,
        };
        Feature::Arc { centre, radius, convex, start: a[1].atan2(a[0]), sweep }
    }

    /// Returns the point at a parameter, and the unit normal into the material there.
    fn foot(&self, t: f64) -> (Point, Point) {
        match *self {
            Feature::Line { from, along, length } => {
                let foot = [0, 1].map(|k| from[k] + t * length * along[k]);
                (foot, [-along[1], along[0]])
            }
            Feature::Arc { centre, radius, convex, start, sweep } => {
                let (sin, cos) = (start + t * sweep).sin_cos();
                let inward = if convex { -1.0 } else { 1.0 };
                let foot = [centre[0] + radius * cos, centre[1] + radius * sin];
                (foot, [inward * cos, inward * sin])
            }
        }
    }

    /// Returns the unit direction of travel at a parameter.
    fn tangent(&self, t: f64) -> Point {
        let (_, [d, z]) = self.foot(t);
        [z, -d]
    }

    /// Returns the parameter of the normal on which a point lies, and by how much it changes per unit of length there.
    fn parameter(&self, p: Point) -> (f64, f64) {
        match *self {
            Feature::Line { from, along, length } => {
                (dot(minus(p, from), along) / length, 1.0 / length)
            }
            Feature::Arc { centre, start, sweep, .. } => {
                let [d, z] = minus(p, centre);
                let angle = z.atan2(d) - start;
                // About the middle of the sweep, so that points beyond either end stay on their side.
                let turns = ((angle - sweep / 2.0) / (2.0 * PI)).round();
                ((angle - 2.0 * PI * turns) / sweep, 1.0 / (sweep.abs() * d.hypot(z)))
            }
        }
    }

    /// Returns the radius at which a ball that touches `p` with the normal `n` there touches the whole line or circle;
    /// infinite if it never does.
    fn growth(&self, p: Point, n: Point) -> f64 {
        let radius = match *self {
            // The centre `p + r n` is `r` from the line, too: `r = l + r n·m` with `|n - m|² = 2 (1 - n·m)`.
            Feature::Line { from, along, .. } => {
                let difference = minus(n, [-along[1], along[0]]);
                2.0 * cross(along, minus(p, from)) / dot(difference, difference)
            }
            // `|a + r n| = R - r` for a convex circle and `R + r` for a concave one, squared.
            Feature::Arc { centre, radius, convex, .. } => {
                let a = minus(p, centre);
                let (power, radial) = (radius * radius - dot(a, a), dot(a, n));
                if convex {
                    power / (radius + radial) / 2.0
                } else {
                    -power / (radius - radial) / 2.0
                }
            }
        };
        if radius >= 0.0 { radius } else { f64::INFINITY }
    }
}

/// The cell of one feature of a profile.
struct Cell<'p> {
    features: &'p [Feature],
    profile: &'p [ProfileSegment],
    index: usize,
    size: f64,
    flat: f64,
}

impl Cell<'_> {
    /// Returns the normal at a parameter.
    fn normal(&self, parameter: f64) -> Normal {
        let own = self.features[self.index];
        let (foot, n) = own.foot(parameter);
        // Nothing in the section is farther away than its size.
        let (mut radius, mut stop) = (self.size, Stop::Centre);
        if n[0] < 0.0 && -foot[0] / n[0] < radius {
            (radius, stop) = (-foot[0] / n[0], Stop::Axis);
        }
        if let Feature::Arc { radius: own, convex: true, .. } = own
            && own <= radius
        {
            (radius, stop) = (own, Stop::Centre);
        }
        for (index, other) in self.features.iter().enumerate() {
            let growth = other.growth(foot, n);
            if growth < radius && self.can_stop(index) && self.touches(other, foot, n, growth) {
                (radius, stop) = (growth, Stop::Feature(index));
            }
        }
        let end = [(foot[0] + radius * n[0]).max(0.0), foot[1] + radius * n[1]];
        Normal { parameter, foot, end, stop }
    }

    /// Returns whether a ball touches a feature itself, and not only its line or circle beyond its ends.
    fn touches(&self, other: &Feature, foot: Point, n: Point, growth: f64) -> bool {
        let centre = [0, 1].map(|k| foot[k] + growth * n[k]);
        let (parameter, per_length) = other.parameter(centre);
        let slack = TOUCHING_FRACTION * self.size * per_length;
        let is_inside = match *other {
            Feature::Arc { radius, convex: true, .. } => growth <= radius,
            _ => true,
        };
        is_inside && parameter >= -slack && parameter <= 1.0 + slack
    }

    /// Returns whether another feature may stop a ball. Features that join without an angle do not, except for an arc of
    /// smaller radius.
    fn can_stop(&self, other: usize) -> bool {
        if other.abs_diff(self.index) != 1 {
            return other != self.index;
        }
        let own = self.features[self.index];
        let neighbour = self.features[other];
        let (before, after) = if other < self.index { (neighbour, own) } else { (own, neighbour) };
        let (incoming, outgoing) = (before.tangent(1.0), after.tangent(0.0));
        match (own, neighbour) {
            (
                Feature::Arc { radius: own, convex: true, .. },
                Feature::Arc { radius, convex: true, .. },
            ) if radius < own => true,
            _ => cross(incoming, outgoing).abs() >= TANGENT_SINE || dot(incoming, outgoing) < 0.0,
        }
    }

    /// Returns normals along the feature, whose ends are joined by chords of the cell's borders.
    fn normals(&self) -> Vec<Normal> {
        let own = self.features[self.index];
        let mut parameters = vec![1.0 - END];
        parameters.extend((1..FIRST_INTERVALS).map(|k| f64::from(k) / f64::from(FIRST_INTERVALS)));
        // The normals through the ends of segments meet the smallest neighbours.
        let ends = self.profile.iter().map(|segment| own.parameter(segment.ends[0]).0);
        parameters.extend(ends.filter(|t| *t > END && *t < 1.0 - END));
        parameters.sort_by(f64::total_cmp);
        parameters.dedup();
        let mut normals = vec![self.normal(END)];
        for parameter in parameters {
            let last = normals[normals.len() - 1];
            self.refine(last, self.normal(parameter), MAX_HALVINGS, &mut normals);
        }
        // At a convex corner both cells end in the corner itself.
        let last = normals.len() - 1;
        for (index, t) in [(0, 0.0), (last, 1.0)] {
            if normals[index].length() < self.flat {
                normals[index].end = own.foot(t).0;
            }
        }
        normals
    }

    /// Adds the normals after `from` up to `to`. Where another feature stops the ball, they are close.
    fn refine(&self, from: Normal, to: Normal, halvings: u32, normals: &mut Vec<Normal>) {
        let chord = minus(to.end, from.end);
        let (length, is_one) = (norm(chord), from.stop == to.stop);
        let near = if is_one { self.flat } else { JOINT_FRACTION * self.flat };
        if halvings > 0 && length > near {
            let middle = self.normal(f64::midpoint(from.parameter, to.parameter));
            let off = cross(chord, minus(middle.end, from.end)).abs() / length;
            if !is_one || middle.stop != to.stop || off > self.flat / 2.0 {
                self.refine(from, middle, halvings - 1, normals);
                return self.refine(middle, to, halvings - 1, normals);
            }
        }
        normals.push(to);
    }

    /// Adds the cell to those of the profile.
    fn add_to(&self, cells: &mut Cells) {
        let own = self.features[self.index];
        let normals = self.normals();
        let last = normals[normals.len() - 1];
        let mut borders: Vec<Point> = Vec::new();
        let mut rest = &normals[..];
        while let Some(Normal { stop, .. }) = rest.first() {
            let count = rest.iter().take_while(|normal| normal.stop == *stop).count();
            let ends: Vec<Point> = rest.iter().take(count + 1).map(|normal| normal.end).collect();
            let mut line = simplified(&ends, self.flat / 2.0);
            borders.extend(&line);
            match *stop {
                // Each border is drawn by the first of its two features.
                Stop::Feature(other) if other > self.index => {
                    // Dashes begin at the surface.
                    if rest[count - 1].length() < rest[0].length() {
                        line.reverse();
                    }
                    cells.splits.push(Split { regions: [self.index, other], line });
                }
                Stop::Axis => cells.axis.push((self.index, rest[count / 2].end)),
                _ => {}
            }
            rest = &rest[count..];
        }
        // The normal between neighbours is drawn by the one before it.
        if self.index + 1 < self.features.len() && last.length() > self.flat {
            let line = vec![own.foot(1.0).0, last.end];
            cells.splits.push(Split { regions: [self.index, self.index + 1], line });
        }
        let mut area = vec![own.foot(0.0).0];
        if let Feature::Arc { radius, sweep, .. } = own {
            let step = 2.0 * (1.0 - self.flat / radius.max(self.flat)).acos();
            let count = (sweep.abs() / step).ceil() as usize;
            area.extend((1..count).map(|k| own.foot(k as f64 / count as f64).0));
        }
        area.push(own.foot(1.0).0);
        area.extend(borders.into_iter().rev());
        area.extend(area.first().copied());
        area.dedup_by(|p, q| norm(minus(*p, *q)) < JOINT_FRACTION * self.flat);
        // A cell without area is still its foot.
        area.truncate(area.len().saturating_sub(1).max(1));
        cells.areas.push(area);
    }
}

/// Returns a segment as strokes, of which each is less than half a circle.
pub(super) fn strokes(segment: &ProfileSegment) -> Vec<Stroke> {
    let feature = Feature::of(segment);
    let (parts, circle) = match feature {
        Feature::Line { .. } => (1, None),
        Feature::Arc { centre, radius, sweep, .. } => {
            ((sweep.abs() / (0.9 * PI)).ceil().max(1.0) as usize, Some((centre, radius)))
        }
    };
    let mut strokes = Vec::new();
    let mut from = segment.ends[0];
    for k in 1..=parts {
        let inner = feature.foot(k as f64 / parts as f64).0;
        let to = if k == parts { segment.ends[1] } else { inner };
        strokes.push(Stroke { from, to, circle });
        from = to;
    }
    strokes
}
