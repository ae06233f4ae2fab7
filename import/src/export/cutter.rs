//! The types of cutters that libraries share, found in an outline.

use touchoff::tool::{Circle, ProfileSegment};

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
