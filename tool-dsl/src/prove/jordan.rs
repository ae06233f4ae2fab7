//! A proof that the solid is the set that its profile encloses.
//!
//! The solid ends only within `ρ = 2 s` of the profile, where `s` bounds depth. The points farther from the profile and
//! its mirror image form two connected sets, one enclosed and one outside, and one point of each decides which is
//! solid. Theorem 3 of `docs/proofs.md` has the proof, and a bound `X = 4.5 s / sin(β/2)` of the distance between the
//! two surfaces, where `β` is the least outside angle at a corner. This module has the profile's measures that it needs.

use crate::geometry::outline::{Point, Segment, cross, dot, minus, norm};

/// `X sin(β/2) / s`. The point on the bisector is at `x = 4 s / sin(β/2)`; an eighth more is for points beside
/// the corner and for arcs, which are off their tangents.
const DISTANCE_FACTOR: f64 = 4.5;
/// The least radius of an arc, in `X / sin(β/2)`. Along a length of `2 x` such an arc leaves its tangent by
/// `(2 x)² / (200 X)` at most, less than `x / 50`.
const MIN_RADIUS_FACTOR: f64 = 100.0;
/// The least distance of test points from the profile, in `s`: twice `ρ`, beyond which the two sets are known.
const TEST_OFFSET_FACTOR: f64 = 4.0;

/// The narrowest passage and the sharpest corner of a profile.
pub(super) struct Profile {
    /// The least distance between points of the profile, or of its mirror image, that face each other.
    narrowest: f64,
    /// The least radius of an arc.
    min_radius: f64,
    /// The sine of half the smallest angle outside the material at a corner.
    sharpest: f64,
}

impl Profile {
    pub(super) fn new(outline: &[Segment]) -> Profile {
        let mirrored: Vec<Segment> = outline.iter().map(Segment::mirrored).collect();
        let radii = outline.iter().filter_map(|piece| Some(piece.round()?.1));
        let min_radius = radii.fold(f64::INFINITY, f64::min);
        // Points of one arc face each other across its circle.
        let mut narrowest = 2.0 * min_radius;
        for (index, piece) in outline.iter().enumerate() {
            for (other, other_segment) in outline.iter().enumerate().skip(index + 1) {
                // At a common end the distance is 0, but consecutive segments do not face each other there.
                let joints: &[_] = if other == index + 1 { &[[1, 0]] } else { &[] };
                narrowest = narrowest.min(facing_distance(piece, other_segment, joints));
            }
            // The first and last segments continue as their own mirror images, which run in the opposite
            // sense.
            for (other, image) in mirrored.iter().enumerate().skip(index) {
                let mut joints = Vec::new();
                if other == index && index == 0 {
                    // Where the profile begins and ends on the axis, it continues as its image.
                    joints.push([0, 1]);
                }
                if other == index && index + 1 == outline.len() {
                    joints.push([1, 0]);
                }
                narrowest = narrowest.min(facing_distance(piece, image, &joints));
            }
        }
        // The whole closed curve.
        let closed_curve = || outline.iter().chain(mirrored.iter().rev());
        let sharpest = closed_curve().zip(closed_curve().cycle().skip(1)).map(|(before, after)| {
            let [before, after] = [before.tangent(true), after.tangent(false)];
            // A turn to the left is positive. The outside angle is β = π + turn, and sin(β/2) = cos(turn/2).
            // The corner, if that is more than π, is nearer to points on the bisector than its sides are.
            let turn = cross(before, after).atan2(dot(before, after));
            (0.5 * turn.min(0.0)).cos()
        });
        Profile { narrowest, min_radius, sharpest: sharpest.fold(1.0, f64::min) }
    }

    /// Returns an upper bound of the distance from the solid's surface to the profile. `slack` bounds depth
    /// where the solid ends, and the points that decide which side is solid lie at a distance of `test_offset`
    /// from the profile. Returns `None` if this does not prove that the profile encloses the solid.
    pub(super) fn max_distance(&self, slack: f64, test_offset: f64) -> Option<f64> {
        let max_distance = DISTANCE_FACTOR * slack / self.sharpest;
        let proved = 2.0 * max_distance < self.narrowest
            && MIN_RADIUS_FACTOR * max_distance / self.sharpest < self.min_radius
            && TEST_OFFSET_FACTOR * slack < test_offset;
        proved.then_some(max_distance)
    }
}

/// Returns a lower bound of the distance between points of two segments that face each other. `joints` are
/// the ends that the segments share, as pairs of indices of an end of each.
fn facing_distance(one: &Segment, other: &Segment, joints: &[[usize; 2]]) -> f64 {
    // Shortening the connection of two points that face each other ends at an end of a segment, at facing normals, or
    // at a third segment, to which it is shorter still. The rounding of doubles is far smaller than the factor of 2
    // that `max_distance` demands.
    let mut min_distance = f64::INFINITY;
    for (side, from, to) in [(0, one, other), (1, other, one)] {
        for (end, point) in from.ends().into_iter().enumerate() {
            if !joints.iter().any(|joint| joint[side] == end) {
                min_distance = min_distance.min(to.distance_to(point));
            }
        }
    }
    let is_between_normals =
        |segment: &Segment, p| segment.sector(p).iter().all(|side| *side >= 0.0);
    for [p, q] in normals(one, other) {
        let inward_sides_oppose = dot(one.inward(p), other.inward(q)) < 0.0;
        // On the same normal, but facing only if the material is on opposite sides of the two points.
        if inward_sides_oppose && is_between_normals(one, p) && is_between_normals(other, q) {
            min_distance = min_distance.min(norm(minus(p, q)));
        }
    }
    min_distance
}

/// Returns the pairs of points, one on each line or circle, that lie on a common normal. Two lines and two
/// concentric circles have none: the distances from their ends suffice.
fn normals(one: &Segment, other: &Segment) -> Vec<[Point; 2]> {
    match (one.round(), other.round()) {
        (None, None) => Vec::new(),
        (None, Some((centre, radius, _))) => {
            let (start, along) = (one.ends()[0], one.tangent(false));
            let foot = point_along(start, along, dot(minus(centre, start), along));
            let across = [-along[1], along[0]];
            // The common normal passes through the centre and meets the circle on both sides of it.
            [radius, -radius].map(|by| [foot, point_along(centre, across, by)]).to_vec()
        }
        (Some(_), None) => normals(other, one).into_iter().map(|[p, q]| [q, p]).collect(),
        (Some((a, r, _)), Some((b, s, _))) => {
            let centre_distance = norm(minus(b, a));
            if centre_distance == 0.0 {
                return Vec::new();
            }
            let direction = minus(b, a).map(|part| part / centre_distance);
            let pairs = [[r, s], [r, -s], [-r, s], [-r, -s]];
            pairs
                .map(|[r, s]| [point_along(a, direction, r), point_along(b, direction, s)])
                .to_vec()
        }
    }
}

fn point_along(from: Point, direction: Point, by: f64) -> Point {
    [from[0] + by * direction[0], from[1] + by * direction[1]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;

    fn profile_of(profile: &str) -> Profile {
        let profile = profile.replace(';', " as body;").replacen(" as body", "", 1);
        let text = format!("tool T \"a profile\" {{ units mm; profile {{ {profile} }} }}");
        let compiled = crate::compile(&Source::new("t.tool", text));
        assert!(compiled.diagnostics().is_empty(), "{:?}", compiled.diagnostics());
        let tool = compiled.into_tool().expect("a tool");
        let section = tool.model.section.as_ref().expect("a profile");
        Profile::new(&section.outline)
    }

    fn assert_near(value: f64, expected: f64) {
        assert!((value - expected).abs() < 1e-9, "{value} is not {expected}");
    }

    #[test]
    fn narrowest_is_the_width_of_a_slot_a_wall_or_a_bore() {
        // A groove 0.25 wide in the side; a wall 0.3 thick on the face; a hole of radius 0.1 in the end.
        let groove =
            "start (0, 0); line to (5, 0), (5, 8), (3, 8), (3, 8.25), (5, 8.25), (5, 20), (0, 20);";
        assert_near(profile_of(groove).narrowest, 0.25);
        let wall = "start (0, 2); line to (4, 2), (4, 0), (4.3, 0), (4.3, 20), (0, 20);";
        assert_near(profile_of(wall).narrowest, 0.3);
        let hole = "start (0, 2); line to (0.1, 2), (0.1, 0), (6, 0), (6, 20), (0, 20);";
        // The bottom of the hole ends on the axis, at this distance from its wall.
        assert_near(profile_of(hole).narrowest, 0.1);
        let pin = "start (0, 0); line to (5, 0), (5, 20), (0, 20);";
        assert_near(profile_of(pin).narrowest, 5.0);
    }

    #[test]
    fn narrowest_includes_arcs() {
        // The closest approach of a ball and of a neck's fillet to the axis and to each other.
        assert_near(profile_of("start (0, 0); arc to (0, 6) center (0, 3);").narrowest, 6.0);
        let neck = "start (0, 0); line to (3, 0), (3, 4); arc to (3, 8) center (3, 6) concave; line to (3, 20), (0, 20);";
        assert_near(profile_of(neck).narrowest, 2.0);
        // A bead of a sixth of a circle leaves the wall at 30°, like a corner with a small outside angle.
        let bead = "start (0, 0); line to (3, 0), (3, 4); arc to (3, 8) center (3 - 2*sqrt(3), 6); line to (3, 20), (0, 20);";
        assert_near(profile_of(bead).sharpest, 15f64.to_radians().cos());
    }

    /// At a joint where a line continues as a circle nothing faces anything, and neither do the sides of a
    /// corner.
    #[test]
    fn adjacent_segments_do_not_face_each_other() {
        let ball = "start (0, 0); arc to (3, 3) center (0, 3); line to (3, 20), (0, 20);";
        assert_near(profile_of(ball).narrowest, 3.0);
        let needle = "start (0, 0); line to (4, 10), (0, 10.5);";
        let profile = profile_of(needle);
        assert!(profile.narrowest > 3.0, "{}", profile.narrowest);
        assert_near(profile.sharpest, 1.0);
    }

    #[test]
    fn passages_narrower_than_the_slack_are_not_proved() {
        let slot = profile_of(
            "start (0, 0); line to (5, 0), (5, 8), (3, 8), (3, 8.25), (5, 8.25), (5, 20), (0, 20);",
        );
        // The bottom of the slot has outside corners of 90°.
        assert!(slot.max_distance(0.018, 0.1).is_some() && slot.max_distance(0.02, 0.2).is_none());
        assert_eq!(slot.max_distance(0.0, 0.1), Some(0.0));
        // Points this close decide nothing.
        assert_eq!(slot.max_distance(0.018, 0.072), None);
    }
}
