//! Offset curves: the points at a distance from a feature of a profile, along its inward normals or along the fan
//! of normals of a reflex corner. Their crossings with each other and with the axis are computed in closed form.

use crate::certify::tool_model::feature::{Feature, MeridianPoint, cross, dot, minus, norm};
use std::f64::consts::FRAC_PI_2;

/// The inward normals of a feature, or of the fan of a reflex corner.
#[derive(Clone, Copy, Debug)]
pub(super) enum Normals {
    /// The normals of a line: they start at `from + s along`, `s` up to `length`, in the direction `inward`.
    Line { from: MeridianPoint, along: MeridianPoint, length: f64, inward: MeridianPoint },
    /// The normals of an arc: at the angle `from + s`, `s` up to `turn`. At the distance `t` from the profile the
    /// point is `radius + grows t` away from the centre.
    Arc { centre: MeridianPoint, from: f64, turn: f64, radius: f64, grows: f64 },
}

/// A line or circle that contains points at a distance from a feature.
#[derive(Clone, Copy)]
pub(super) enum Level {
    /// The line of points whose dot product with a unit vector is `at`.
    Line {
        normal: MeridianPoint,
        at: f64,
    },
    Circle {
        centre: MeridianPoint,
        radius: f64,
    },
}

impl Normals {
    pub(super) fn of(feature: &Feature) -> Normals {
        let [from, to] = feature.ends;
        match feature.circle {
            None => Normals::Line {
                from,
                along: feature.along,
                length: feature.length,
                inward: [-feature.along[1], feature.along[0]],
            },
            Some(circle) => {
                let [first, last] = [from, to].map(|end| angle(minus(end, circle.centre)));
                // A convex arc is traversed counterclockwise about its centre, a concave one clockwise.
                let (from, to) = if circle.convex { (first, last) } else { (last, first) };
                let grows = if circle.convex { -1.0 } else { 1.0 };
                Normals::Arc {
                    centre: circle.centre,
                    from,
                    turn: (to - from).rem_euclid(std::f64::consts::TAU),
                    radius: circle.radius,
                    grows,
                }
            }
        }
    }

    /// Returns the fan of normals between two features that meet in a reflex corner; `None` if they do not.
    pub(super) fn fan(before: &Feature, after: &Feature) -> Option<Normals> {
        let [arrives, leaves] = [before.tangent_at(1), after.tangent_at(0)];
        let turn = cross(arrives, leaves);
        // For opposite headings rounding decides the sense of the turn. A cusp therefore gets a fan whether it points
        // into the tool or out of it. The threshold does not matter: a fan that points out yields no witness.
        if turn >= 0.0 && !(turn < 1e-9 && dot(arrives, leaves) < 0.0) {
            return None;
        }
        let inward = |vector: MeridianPoint| angle([-vector[1], vector[0]]);
        let (from, to) = (inward(leaves), inward(arrives));
        Some(Normals::Arc {
            centre: after.ends[0],
            from,
            turn: (to - from).rem_euclid(std::f64::consts::TAU),
            radius: 0.0,
            grows: 1.0,
        })
    }

    /// Returns the fan of normals between a feature's normal at its end on the axis and the axis, if the feature
    /// meets its mirror image in a reflex corner there.
    pub(super) fn axis_fan(feature: &Feature, end: usize) -> Option<Normals> {
        let [d, z] = feature.tangent_at(end);
        if feature.ends[end][0] != 0.0 || z >= 0.0 {
            return None;
        }
        let normal = angle([-z, d]);
        // The direction into the tool: up at its beginning, down at its end.
        let axis = if end == 0 { FRAC_PI_2 } else { -FRAC_PI_2 };
        Some(Normals::Arc {
            centre: feature.ends[end],
            from: normal.min(axis),
            turn: (axis - normal).abs(),
            radius: 0.0,
            grows: 1.0,
        })
    }

    /// Returns the upper end of the parameter range.
    pub(super) fn end(&self) -> f64 {
        match self {
            Normals::Line { length, .. } => *length,
            Normals::Arc { turn, .. } => *turn,
        }
    }

    /// Returns the point at the distance `t` on the normal at the parameter `s`.
    pub(super) fn point(&self, s: f64, t: f64) -> MeridianPoint {
        match self {
            Normals::Line { from, along, inward, .. } => {
                [0, 1].map(|k| from[k] + s * along[k] + t * inward[k])
            }
            Normals::Arc { centre, from, radius, grows, .. } => {
                let distance = radius + grows * t;
                let (sin, cos) = (from + s).sin_cos();
                [centre[0] + distance * cos, centre[1] + distance * sin]
            }
        }
    }

    /// Returns the distance at which the normals meet; infinity if they never do.
    pub(super) fn longest(&self) -> f64 {
        match self {
            Normals::Arc { radius, grows, .. } if *grows < 0.0 => *radius,
            _ => f64::INFINITY,
        }
    }

    /// Appends the parameters at which the offset curve at the distance `t` crosses a line or circle.
    pub(super) fn crossings(&self, t: f64, level: Level, into: &mut Vec<f64>) {
        let end = self.end();
        let mut add = |s: f64| {
            if s > 0.0 && s < end {
                into.push(s);
            }
        };
        match (self, level) {
            (Normals::Line { along, .. }, Level::Line { normal, at }) => {
                let slope = dot(*along, normal);
                if slope != 0.0 {
                    add((at - dot(self.point(0.0, t), normal)) / slope);
                }
            }
            (Normals::Line { along, .. }, Level::Circle { centre, radius }) => {
                let out = minus(self.point(0.0, t), centre);
                let (middle, offset) = (-dot(*along, out), cross(*along, out));
                let half = radius * radius - offset * offset;
                if half >= 0.0 {
                    let half = half.sqrt();
                    add(middle - half);
                    add(middle + half);
                }
            }
            (Normals::Arc { centre, from, radius, grows, .. }, level) => {
                let distance = radius + grows * t;
                // In both cases the angles of the crossings from one direction have the same cosine.
                let (vector, cosine) = match level {
                    Level::Line { normal, at } => (normal, (at - dot(*centre, normal)) / distance),
                    Level::Circle { centre: other, radius } => {
                        let vector = minus(other, *centre);
                        let centre_distance = norm(vector);
                        let cosine = (distance * distance + centre_distance * centre_distance
                            - radius * radius)
                            / (2.0 * distance * centre_distance);
                        (vector, cosine)
                    }
                };
                if (-1.0..=1.0).contains(&cosine) {
                    let (middle, half) = (angle(vector), cosine.acos());
                    for crossing in [middle - half, middle + half] {
                        add((crossing - from).rem_euclid(std::f64::consts::TAU));
                    }
                }
            }
        }
    }
}

fn angle(vector: MeridianPoint) -> f64 {
    vector[1].atan2(vector[0])
}

/// Returns the lines and circles that contain all points at the distance `t` from a feature.
pub(super) fn levels(feature: &Feature, t: f64) -> impl Iterator<Item = Level> {
    let sides = match feature.circle {
        None => {
            let normal = [-feature.along[1], feature.along[0]];
            let at = dot(feature.ends[0], normal);
            [-t, t].map(|t| Level::Line { normal, at: at + t })
        }
        Some(circle) => [circle.radius + t, (circle.radius - t).abs()]
            .map(|radius| Level::Circle { centre: circle.centre, radius }),
    };
    let ends = feature.ends.map(|centre| Level::Circle { centre, radius: t });
    sides.into_iter().chain(ends)
}

/// The axis of the tool.
pub(super) const AXIS: Level = Level::Line { normal: [1.0, 0.0], at: 0.0 };
