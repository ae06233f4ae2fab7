//! The half section of a tool, divided into the parts that libraries know: cutter, shaft and holder; and the type of a cutter that
//! libraries share, found in its outline.

use crate::outline::rounded;
use touchoff::Unit;
use touchoff::tool::{Circle, ProfileSegment, ToolInfo};

/// Lengths nearer than this part of the size are the same.
const SAME: f64 = 1e-9;

/// A conical piece, from the tip's side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    pub(super) low: [f64; 2],
    pub(super) high: [f64; 2],
}

impl Cone {
    pub(super) fn is_cylinder(&self, tolerance: f64) -> bool {
        (self.high[0] - self.low[0]).abs() <= tolerance
    }
}

/// A tool's outline in parts, in the tool's frame.
pub(super) struct HalfSection {
    /// The unit of all lengths.
    pub(super) unit: Unit,
    /// The whole outline, with one segment per line and circle.
    pub(super) outline: Vec<ProfileSegment>,
    /// The cutting part: from the tip to the end of the last cutting segment.
    pub(super) cutting: Vec<ProfileSegment>,
    /// The conical pieces above it, up to the holder or the end; `Err` if one is round or runs back toward the tip.
    pub(super) body: Result<Vec<Cone>, String>,
    /// The holder's conical pieces; empty without a holder.
    pub(super) holder: Result<Vec<Cone>, String>,
    /// The height at which the holder begins, or the tool ends.
    pub(super) end: f64,
    /// The length by which points may differ.
    pub(super) tolerance: f64,
}

impl HalfSection {
    /// Divides the outline of a tool, in a unit.
    ///
    /// # Errors
    /// If the tool has no profile, or no cutting segment.
    pub(super) fn of(tool: &ToolInfo, unit: Unit) -> Result<HalfSection, String> {
        let factor = tool.unit.factor_to(unit);
        let outline: Vec<ProfileSegment> =
            tool.outline.iter().map(|segment| scaled(segment, factor)).collect();
        if outline.is_empty() {
            return Err("it has no profile: its regions are written by hand".to_owned());
        }
        let tolerance = SAME * size(&outline);
        let part = |segment: &ProfileSegment| {
            let name = &*tool.surface(segment.surface).name;
            name.split_once('.').map_or("", |(part, _)| part)
        };
        let is_cutting = |segment: &ProfileSegment| tool.surface(segment.surface).cutting;
        let first = part(&outline[0]);
        // The parts of an assembly: the cutter, its shaft, and what holds them.
        let holder_from = outline
            .iter()
            .position(|segment| part(segment) != first && part(segment) != "shaft")
            .unwrap_or(outline.len());
        let (lower, upper) = outline.split_at(holder_from);
        // The plane that closes the outline at its end does not cut, whatever its surface.
        let open = match lower.split_last() {
            Some((last, rest))
                if last.to[0] == 0.0 && last.circle.is_none() && !rest.is_empty() =>
            {
                rest
            }
            _ => lower,
        };
        let last_cutting = open.iter().rposition(is_cutting);
        let cutting = &lower[..last_cutting.ok_or("none of its surfaces is `cutting`")? + 1];
        if upper.iter().any(is_cutting) {
            return Err("a surface of its holder is `cutting`".to_owned());
        }
        let end = match upper.first() {
            // A step inward begins on the earlier file's side.
            Some(first) => first.from[1],
            None => lower.last().map_or(0.0, |last| last.to[1]),
        };
        Ok(HalfSection {
            unit,
            cutting: merged(cutting, tolerance),
            body: cones(&lower[cutting.len()..], tolerance),
            holder: cones(upper, tolerance),
            end,
            tolerance,
            outline,
        })
    }

    /// Returns the end of the cutting part.
    pub(super) fn cutting_end(&self) -> [f64; 2] {
        self.cutting.last().map_or([0.0; 2], |last| last.to)
    }

    /// Returns the cutting part as a solid, closed by a plane across the axis.
    pub(super) fn closed_cutting_part(&self) -> Vec<ProfileSegment> {
        closed(self.cutting.clone(), self.tolerance)
    }

    /// Returns what lies below the holder as a solid, closed by a plane across the axis.
    pub(super) fn closed_below_holder(&self) -> Vec<ProfileSegment> {
        closed(
            self.outline
                .iter()
                .take_while(|segment| {
                    segment.from[1].max(segment.to[1]) <= self.end + self.tolerance
                })
                .copied()
                .collect(),
            self.tolerance,
        )
    }
}

/// Closes an outline by a plane across the axis, unless it ends on the axis.
fn closed(mut outline: Vec<ProfileSegment>, tolerance: f64) -> Vec<ProfileSegment> {
    if let Some(last) = outline.last().copied().filter(|last| last.to[0] > tolerance) {
        let to = [0.0, last.to[1]];
        outline.push(ProfileSegment { from: last.to, to, circle: None, surface: last.surface });
    }
    outline
}

/// Returns the round number that a computed one stands for: the nearest multiple of 1e-9, if only rounding errors are
/// between them.
pub(super) fn tidy(value: f64) -> f64 {
    let round = rounded(value);
    if (round - value).abs() <= 8.0 * f64::EPSILON * value.abs() { round } else { value }
}

/// Returns true if two outlines are the same curve.
pub(super) fn same(a: &[ProfileSegment], b: &[ProfileSegment]) -> bool {
    let tolerance = SAME * size(a).max(size(b));
    let [a, b] = [a, b].map(|outline| merged(outline, tolerance));
    a.len() == b.len()
        && a.iter().zip(&b).all(|(a, b)| {
            let is_near = [(a.from, b.from), (a.to, b.to)]
                .iter()
                .all(|(a, b)| (a[0] - b[0]).abs().max((a[1] - b[1]).abs()) <= tolerance);
            is_near && is_same_circle(a.circle, b.circle)
        })
}

/// Returns whether two arcs of the same ends, or two lines, are the same.
fn is_same_circle(a: Option<Circle>, b: Option<Circle>) -> bool {
    match (a, b) {
        (None, None) => true,
        // The centre of a shallow arc moves more than the arc.
        (Some(a), Some(b)) => {
            a.convex == b.convex && (a.radius - b.radius).abs() <= 1e-6 * a.radius
        }
        _ => false,
    }
}

fn scaled(segment: &ProfileSegment, factor: f64) -> ProfileSegment {
    let point = |p: [f64; 2]| p.map(|coordinate| coordinate * factor);
    ProfileSegment {
        from: point(segment.from),
        to: point(segment.to),
        circle: segment.circle.map(|circle| Circle {
            centre: point(circle.centre),
            radius: circle.radius * factor,
            convex: circle.convex,
        }),
        surface: segment.surface,
    }
}

/// Returns the largest coordinate of an outline.
fn size(outline: &[ProfileSegment]) -> f64 {
    outline.iter().flat_map(|segment| segment.to).map(f64::abs).fold(0.0, f64::max)
}

/// Joins segments that continue each other: lines in one direction, arcs of one circle up to half a turn.
fn merged(outline: &[ProfileSegment], tolerance: f64) -> Vec<ProfileSegment> {
    let mut merged: Vec<ProfileSegment> = Vec::new();
    for segment in outline {
        match merged.last_mut().filter(|last| continues(last, segment, tolerance)) {
            Some(last) => last.to = segment.to,
            None => merged.push(*segment),
        }
    }
    merged
}

/// Returns whether a segment goes on as the one before it.
fn continues(last: &ProfileSegment, segment: &ProfileSegment, tolerance: f64) -> bool {
    match (last.circle, segment.circle) {
        (None, None) => {
            let [a, b] = [last, segment].map(|s| [s.to[0] - s.from[0], s.to[1] - s.from[1]]);
            let (cross, dot) = (a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
            dot > 0.0 && cross.abs() <= tolerance * a[0].hypot(a[1]).max(b[0].hypot(b[1]))
        }
        (Some(a), Some(b)) => {
            let apart = (a.centre[0] - b.centre[0]).hypot(a.centre[1] - b.centre[1]);
            a.convex == b.convex && apart.max((a.radius - b.radius).abs()) <= tolerance
        }
        _ => false,
    }
}

/// Returns straight segments as conical pieces; steps across the axis lie between them.
fn cones(segments: &[ProfileSegment], tolerance: f64) -> Result<Vec<Cone>, String> {
    let mut cones = Vec::new();
    for segment in merged(segments, tolerance) {
        let rise = segment.to[1] - segment.from[1];
        match segment.circle {
            Some(_) => return Err("its shaft or holder is rounded".to_owned()),
            None if rise > tolerance => cones.push(Cone { low: segment.from, high: segment.to }),
            None if rise < -tolerance => {
                return Err("its shaft or holder runs back toward the tip".to_owned());
            }
            None => {}
        }
    }
    Ok(cones)
}

/// A cutting part as its type and its dimensions, in the tool's unit; angles in degrees.
#[derive(Clone, Copy, Debug)]
pub(super) enum Type {
    /// A cylinder whose lower edge has this radius.
    End {
        diameter: f64,
        corner: f64,
    },
    Ball {
        diameter: f64,
    },
    /// A point with its whole angle, which may be truncated.
    Point {
        diameter: f64,
        tip_diameter: f64,
        angle: f64,
    },
    /// A cone above a tip of this diameter with a rounded edge, with half its angle.
    Taper {
        tip_diameter: f64,
        corner: f64,
        half_angle: f64,
    },
    /// A cone above a ball, with half its angle.
    TaperedBall {
        radius: f64,
        half_angle: f64,
    },
}

/// A segment of a cutting part, with its upper end.
enum Side {
    Line {
        to: [f64; 2],
    },
    /// A convex arc.
    Arc {
        to: [f64; 2],
        radius: f64,
    },
    /// A concave arc, which no type has.
    Other,
}

impl Side {
    fn of(segment: &ProfileSegment) -> Side {
        let to = segment.to;
        match segment.circle {
            None => Side::Line { to },
            Some(Circle { radius, convex: true, .. }) => Side::Arc { to, radius },
            Some(Circle { convex: false, .. }) => Side::Other,
        }
    }
}

/// Returns the type of a cutting part, as its segments suggest it. The caller has to compare the outlines.
pub(super) fn recognise(cutting: &[ProfileSegment]) -> Option<Type> {
    use Side::{Arc, Line};
    let sides: Vec<Side> = cutting.iter().map(Side::of).collect();
    match *sides {
        [Arc { radius, .. }] => Some(Type::Ball { diameter: 2.0 * radius }),
        [Line { to: edge }] | [Line { to: edge }, Line { .. }] if edge[1] > 0.0 => {
            Some(point(edge, 0.0, cone_half_angle([0.0; 2], edge)))
        }
        [Arc { to: edge, radius }, Line { to: end }] => Some(if is_straight(edge, end) {
            Type::Ball { diameter: 2.0 * radius }
        } else {
            Type::TaperedBall { radius, half_angle: cone_half_angle(edge, end) }
        }),
        [Line { to: edge }, Line { to: end }] => Some(if is_straight(edge, end) {
            Type::End { diameter: 2.0 * edge[0], corner: 0.0 }
        } else {
            let half_angle = cone_half_angle(edge, end);
            Type::Taper { tip_diameter: 2.0 * edge[0], corner: 0.0, half_angle }
        }),
        [Line { to: face }, Line { to: wide }, Line { .. }] => {
            Some(point(wide, 2.0 * face[0], cone_half_angle(face, wide)))
        }
        [Line { to: face }, Arc { to: edge, radius }, Line { to: end }] => {
            if is_straight(edge, end) {
                return Some(Type::End { diameter: 2.0 * end[0], corner: radius });
            }
            let half_angle = cone_half_angle(edge, end);
            // The side, continued, meets the plane of the tip there.
            let (sin, cos) = half_angle.to_radians().sin_cos();
            let tip_diameter = 2.0 * (face[0] + radius * (1.0 - sin) / cos);
            Some(Type::Taper { tip_diameter, corner: radius, half_angle })
        }
        _ => None,
    }
}

/// Returns a point with its largest circle at `wide`, from half its angle in degrees.
fn point(wide: [f64; 2], tip_diameter: f64, half_angle: f64) -> Type {
    Type::Point { diameter: 2.0 * wide[0], tip_diameter, angle: 2.0 * half_angle }
}

/// Returns whether the line from one point up to another is parallel to the axis, to within 1e-9 of the upper one's height.
fn is_straight(from: [f64; 2], to: [f64; 2]) -> bool {
    (from[0] - to[0]).abs() <= 1e-9 * to[1].abs()
}

/// Returns half the angle of the cone from one point up to another, in degrees.
fn cone_half_angle(from: [f64; 2], to: [f64; 2]) -> f64 {
    ((to[0] - from[0]) / (to[1] - from[1])).atan().to_degrees()
}
