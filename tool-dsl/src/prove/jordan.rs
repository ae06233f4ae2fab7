//! A proof that the solid is the set that its profile encloses.
//!
//! Let depth be no more than `s` where the solid ends, and no less than the distance to the profile less `s`. Then the
//! solid ends within `ρ = 2 s` of the profile only. The profile with its mirror image is a simple closed curve. What is
//! farther from it than `ρ` has two connected pieces, one enclosed and one outside (Jordan), if the distance from the curve
//! has no critical value up to `ρ`: its level sets are then isotopic (Grove, *Critical point theory for distance
//! functions*, 1993). Each piece is wholly solid or wholly not, and a point of it tells which.
//!
//! A critical point is in the convex hull of the places of the curve that are nearest to it: two places, corners among them,
//! that face each other, or three, of which some are on pieces that do not follow each other; any two are at most `2 ρ` apart
//! and see each other through the empty ball. Shortening the way between two of them ends at an end of a piece, at facing
//! normals, or at a third piece, to which it is shorter still. [`Profile::narrowest`] is no more than the least distance of
//! such places: of ends from pieces that they are not on, along facing normals, and across circles. Doubles err by far
//! less than the factor of 2 that is asked for besides.
//!
//! From a place of the profile that is nearest to a point inside, an outside point farther than `ρ` from the profile is no
//! farther than `ρ / sin(β/2)`, with the outside angle `β` of a corner next to it. Twice that covers how arcs bend, since
//! facing normals, far ends of neighbours and diameters are all longer than four times that. So the surface of the solid is no farther than `4 s / sin(β/2)` from that place.

use crate::geometry::outline::{Point, Segment, cross, dot, minus, norm};

/// How narrow the passages of a profile are, and how sharp its corners.
pub(super) struct Profile {
    /// The least distance between places of the profile, or of its mirror image, that face each other.
    narrowest: f64,
    /// The sine of half the least angle outside of the material at a corner.
    sharpest: f64,
}

impl Profile {
    pub(super) fn new(outline: &[Segment]) -> Profile {
        let mirrored: Vec<Segment> = outline.iter().map(Segment::mirrored).collect();
        let diameters = outline.iter().filter_map(|piece| Some(2.0 * piece.round()?.1));
        let mut narrowest = diameters.fold(f64::INFINITY, f64::min);
        let last = outline.len().saturating_sub(1);
        for (index, piece) in outline.iter().enumerate() {
            for (other, own) in outline.iter().enumerate().skip(index + 1) {
                let joint = (other == index + 1).then_some([1, 0]);
                narrowest = narrowest.min(facing(piece, own, joint.as_slice()));
            }
            // The first piece and the last one go on as their own mirror images, which run the other way.
            for (other, image) in mirrored.iter().enumerate().skip(index) {
                let ends = [(index == 0).then_some([0, 1]), (index == last).then_some([1, 0])];
                let joints: Vec<_> =
                    ends.into_iter().flatten().filter(|_| other == index).collect();
                narrowest = narrowest.min(facing(piece, image, &joints));
            }
        }
        // The whole curve, once around.
        let around = || outline.iter().chain(mirrored.iter().rev());
        let sharpest = around().zip(around().cycle().skip(1)).map(|(before, after)| {
            let [before, after] = [before.tangent(true), after.tangent(false)];
            let turn = cross(before, after).atan2(dot(before, after));
            (0.5 * turn.min(0.0)).cos()
        });
        Profile { narrowest, sharpest: sharpest.fold(1.0, f64::min) }
    }

    /// Returns how far the surface of the solid may be from the nearest point of the profile, if depth is off by no more
    /// than `slack` where the solid ends, and points `beside` the profile tell what is solid; `None` where that does not show
    /// that the profile encloses the solid.
    pub(super) fn off(&self, slack: f64, beside: f64) -> Option<f64> {
        let off = 4.0 * slack / self.sharpest;
        (2.0 * off < self.narrowest && 4.0 * slack < beside).then_some(off)
    }
}

/// Returns a lower bound of the distance between points of two segments that face each other. `joints` are the ends that
/// the segments share, each as the end of the one and of the other.
fn facing(one: &Segment, other: &Segment, joints: &[[usize; 2]]) -> f64 {
    let mut least = f64::INFINITY;
    for (side, from, to) in [(0, one, other), (1, other, one)] {
        for (end, point) in from.ends().into_iter().enumerate() {
            if !joints.iter().any(|joint| joint[side] == end) {
                least = least.min(to.away(point));
            }
        }
    }
    let between = |segment: &Segment, p| segment.sector(p).iter().all(|side| *side >= 0.0);
    for [p, q] in normals(one, other) {
        let facing = dot(one.inward(p), other.inward(q)) < 0.0;
        if facing && between(one, p) && between(other, q) {
            least = least.min(norm(minus(p, q)));
        }
    }
    least
}

/// Returns the pairs of points, one of each line or circle, that lie on a common normal. Lines, and circles about one
/// centre, have none: their ends are as near.
fn normals(one: &Segment, other: &Segment) -> Vec<[Point; 2]> {
    let on = |from: Point, direction: Point, by: f64| {
        [from[0] + by * direction[0], from[1] + by * direction[1]]
    };
    match (one.round(), other.round()) {
        (None, None) => Vec::new(),
        (None, Some((centre, radius, _))) => {
            let (start, along) = (one.ends()[0], one.tangent(false));
            let foot = on(start, along, dot(minus(centre, start), along));
            let across = [-along[1], along[0]];
            [radius, -radius].map(|by| [foot, on(centre, across, by)]).to_vec()
        }
        (Some(_), None) => normals(other, one).into_iter().map(|[p, q]| [q, p]).collect(),
        (Some((a, r, _)), Some((b, s, _))) => {
            let apart = norm(minus(b, a));
            if apart == 0.0 {
                return Vec::new();
            }
            let direction = minus(b, a).map(|part| part / apart);
            let pairs = [[r, s], [r, -s], [-r, s], [-r, -s]];
            pairs.map(|[r, s]| [on(a, direction, r), on(b, direction, s)]).to_vec()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;

    fn of(profile: &str) -> Profile {
        let profile = profile.replace(';', " as body;").replacen(" as body", "", 1);
        let text = format!("tool T \"a profile\" {{ units mm; profile {{ {profile} }} }}");
        let compiled = crate::compile(&Source::new("t.tool", text));
        assert!(compiled.diagnostics().is_empty(), "{:?}", compiled.diagnostics());
        let tool = compiled.into_tool().expect("a tool");
        let section = tool.model.section.as_ref().expect("a profile");
        Profile::new(&section.outline)
    }

    fn near(value: f64, expected: f64) {
        assert!((value - expected).abs() < 1e-9, "{value} is not {expected}");
    }

    #[test]
    fn narrowest_is_the_width_of_a_slot_a_wall_or_a_bore() {
        // A groove 0.25 wide in the side; a wall 0.3 thin on the face; a hole 0.2 across in the end.
        let groove =
            "start (0, 0); line to (5, 0), (5, 8), (3, 8), (3, 8.25), (5, 8.25), (5, 20), (0, 20);";
        near(of(groove).narrowest, 0.25);
        let wall = "start (0, 2); line to (4, 2), (4, 0), (4.3, 0), (4.3, 20), (0, 20);";
        near(of(wall).narrowest, 0.3);
        let hole = "start (0, 2); line to (0.1, 2), (0.1, 0), (6, 0), (6, 20), (0, 20);";
        // Its bottom ends in the axis, beside its wall.
        near(of(hole).narrowest, 0.1);
        let reach = "start (0, 0); line to (5, 0), (5, 20), (0, 20);";
        near(of(reach).narrowest, 5.0);
    }

    #[test]
    fn narrowest_sees_arcs() {
        // Where a ball and a neck's hollow come nearest to the axis and to each other.
        near(of("start (0, 0); arc to (0, 6) center (0, 3);").narrowest, 6.0);
        let neck = "start (0, 0); line to (3, 0), (3, 4); arc to (3, 8) center (3, 6) concave; line to (3, 20), (0, 20);";
        near(of(neck).narrowest, 2.0);
        // A bead of a sixth of a circle leaves the wall at 30°, as a corner that is sharp outside.
        let bead = "start (0, 0); line to (3, 0), (3, 4); arc to (3, 8) center (3 - 2*sqrt(3), 6); line to (3, 20), (0, 20);";
        near(of(bead).sharpest, 15f64.to_radians().cos());
    }

    /// A joint at which a line goes on as a circle faces nothing, and neither do the sides of a corner.
    #[test]
    fn neighbours_do_not_face_each_other() {
        let ball = "start (0, 0); arc to (3, 3) center (0, 3); line to (3, 20), (0, 20);";
        near(of(ball).narrowest, 3.0);
        let needle = "start (0, 0); line to (4, 10), (0, 10.5);";
        let profile = of(needle);
        assert!(profile.narrowest > 3.0, "{}", profile.narrowest);
        near(profile.sharpest, 1.0);
    }

    #[test]
    fn what_is_narrower_than_the_slack_is_not_shown() {
        let slot = of(
            "start (0, 0); line to (5, 0), (5, 8), (3, 8), (3, 8.25), (5, 8.25), (5, 20), (0, 20);",
        );
        // Its bottom has corners of 90° outside.
        assert!(slot.off(0.02, 0.1).is_some() && slot.off(0.025, 0.2).is_none());
        assert_eq!(slot.off(0.0, 0.1), Some(0.0));
        // Points that near tell nothing.
        assert_eq!(slot.off(0.02, 0.08), None);
    }
}
