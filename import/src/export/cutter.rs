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

/// Returns the type of a cutting part, as its segments suggest it. The caller has to compare the outlines.
pub(super) fn recognise(cutting: &[ProfileSegment]) -> Option<Type> {
    let line = |segment: &ProfileSegment| segment.circle.is_none().then_some(segment.to);
    let arc = |segment: &ProfileSegment| {
        let Circle { centre, radius, convex } = segment.circle?;
        convex.then_some((segment.to, centre, radius))
    };
    let is_straight = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() <= 1e-9 * b[1].abs();
    // The half angle of the cone from one point up to another.
    let half_angle =
        |from: [f64; 2], to: [f64; 2]| ((to[0] - from[0]) / (to[1] - from[1])).atan().to_degrees();
    let point = |edge: [f64; 2]| {
        let angle = 2.0 * half_angle([0.0; 2], edge);
        Type::Point { diameter: 2.0 * edge[0], tip_diameter: 0.0, angle }
    };
    match cutting {
        [tip, flute] if arc(tip).is_some() => {
            let ((edge, _, radius), end) = (arc(tip)?, line(flute)?);
            Some(if is_straight(edge, end) {
                Type::Ball { diameter: 2.0 * radius }
            } else {
                Type::TaperedBall { radius, half_angle: half_angle(edge, end) }
            })
        }
        [tip] => match arc(tip) {
            Some((_, _, radius)) => Some(Type::Ball { diameter: 2.0 * radius }),
            None => line(tip).filter(|edge| edge[1] > 0.0).map(point),
        },
        [face, flute] => {
            let (edge, end) = (line(face)?, line(flute)?);
            Some(if edge[1] > 0.0 {
                point(edge)
            } else if is_straight(edge, end) {
                Type::End { diameter: 2.0 * edge[0], corner: 0.0 }
            } else {
                let half_angle = half_angle(edge, end);
                Type::Taper { tip_diameter: 2.0 * edge[0], corner: 0.0, half_angle }
            })
        }
        [face, corner, flute] => {
            let (face, end) = (line(face)?, line(flute)?);
            let Some((edge, _, radius)) = arc(corner) else {
                let wide = line(corner)?;
                let (diameter, tip_diameter) = (2.0 * wide[0], 2.0 * face[0]);
                return Some(Type::Point {
                    diameter,
                    tip_diameter,
                    angle: 2.0 * half_angle(face, wide),
                });
            };
            if is_straight(edge, end) {
                return Some(Type::End { diameter: 2.0 * end[0], corner: radius });
            }
            let half_angle = half_angle(edge, end);
            // The side, continued, meets the plane of the tip there.
            let (sin, cos) = half_angle.to_radians().sin_cos();
            let tip_diameter = 2.0 * (face[0] + radius * (1.0 - sin) / cos);
            Some(Type::Taper { tip_diameter, corner: radius, half_angle })
        }
        _ => None,
    }
}
