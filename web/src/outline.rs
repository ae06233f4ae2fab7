//! The surface of a tool with a profile, as triangles with normals.

use std::f64::consts::TAU;
use touchoff::tool::{ProfileSegment, ToolInfo};

/// Flat sides about the axis, and greatest angle of a chord of an arc.
const SIDES: usize = 64;
const MAX_CHORD: f64 = 0.1;

/// Triangles to draw: 9 values per triangle in each list, and its surface.
#[derive(Debug, Default)]
pub(crate) struct Triangles {
    pub(crate) positions: Vec<f32>,
    pub(crate) normals: Vec<f32>,
    pub(crate) surfaces: Vec<u32>,
}

impl Triangles {
    pub(crate) fn push(&mut self, corners: [[f64; 3]; 3], normals: [[f64; 3]; 3], surface: u32) {
        self.positions.extend(corners.into_iter().flatten().map(|value| value as f32));
        self.normals.extend(normals.into_iter().flatten().map(|value| value as f32));
        self.surfaces.push(surface);
    }
}

/// A point of the profile with its outward normal, both as `[d, z]`.
type ProfilePoint = ([f64; 2], [f64; 2]);

/// Revolves a tool's profile; lengths are multiplied by `scale`.
pub(crate) fn revolve(info: &ToolInfo, scale: f64) -> Triangles {
    let mut triangles = Triangles::default();
    for segment in info.outline.iter() {
        let points = points(segment);
        for (lower, upper) in points.iter().zip(&points[1..]) {
            for side in 0..SIDES {
                let corner = |(at, normal): &ProfilePoint, side: usize| {
                    let (sin, cos) = (TAU * side as f64 / SIDES as f64).sin_cos();
                    let turned = |[d, z]: [f64; 2], by: f64| [by * d * cos, by * d * sin, by * z];
                    (turned(*at, scale), turned(*normal, 1.0))
                };
                let quad = [(lower, side), (lower, side + 1), (upper, side + 1), (upper, side)];
                let [a, b, c, d] = quad.map(|(point, side)| corner(point, side));
                let surface = segment.surface.0 as u32;
                // A quadrilateral that ends on the axis is one triangle.
                if lower.0[0] > 0.0 {
                    triangles.push([a.0, b.0, c.0], [a.1, b.1, c.1], surface);
                }
                if upper.0[0] > 0.0 {
                    triangles.push([a.0, c.0, d.0], [a.1, c.1, d.1], surface);
                }
            }
        }
    }
    triangles
}

/// Returns points of a segment with the normals there, from its start to its end.
fn points(segment: &ProfileSegment) -> Vec<ProfilePoint> {
    let Some(circle) = segment.circle else {
        let [d, z] = [0, 1].map(|k| segment.to[k] - segment.from[k]);
        let length = d.hypot(z);
        let normal = [z / length, -d / length];
        return vec![(segment.from, normal), (segment.to, normal)];
    };
    let angle = |[d, z]: [f64; 2]| (z - circle.centre[1]).atan2(d - circle.centre[0]);
    let (start, end) = (angle(segment.from), angle(segment.to));
    // Counter-clockwise if the material is inside the circle.
    let (sense, sign) = if circle.convex { (1.0, 1.0) } else { (-1.0, -1.0) };
    let turn = (sense * (end - start)).rem_euclid(TAU);
    let chords = (turn / MAX_CHORD).ceil().max(1.0);
    let at = |k: usize| {
        let (sin, cos) = (start + sense * turn * (k as f64 / chords)).sin_cos();
        let [d, z] = [cos, sin].map(|part| part * circle.radius);
        ([circle.centre[0] + d, circle.centre[1] + z], [sign * cos, sign * sin])
    };
    let mut points: Vec<ProfilePoint> = (0..=chords as usize).map(at).collect();
    let last = points.len() - 1;
    points[0].0 = segment.from;
    points[last].0 = segment.to;
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use tool_dsl::source::Source;
    use touchoff::Tool;
    use touchoff::tool::Interpreted;

    const BALL: &str = "tool Ball { units mm; profile { start (0, 0); arc to (3, 3) center (0, 3) as ball cutting; \
                        line to (3, 10), (0, 10) as shank; } niceness cutting: 1; }";

    /// The volume by the divergence theorem is that of half a ball and a cylinder, less what chords cut off.
    #[test]
    fn a_revolved_profile_encloses_the_tool() {
        let tool = Interpreted::parse(&Source::new("ball.tool", BALL)).expect("a tool");
        let triangles = revolve(tool.info(), 1.0);
        let mut volume = 0.0;
        for corners in triangles.positions.chunks(9) {
            let [a, b, c] =
                [0, 3, 6].map(|k| nalgebra::Vector3::from_fn(|i, _| f64::from(corners[k + i])));
            volume += a.dot(&b.cross(&c)) / 6.0;
        }
        let exact = std::f64::consts::PI * (2.0 / 3.0 * 27.0 + 9.0 * 7.0);
        assert!(volume < exact && volume > 0.995 * exact, "{volume} of {exact}");
    }
}
