//! Witnesses of the region of a tool that may not be inside the material: one point per connected piece.
//!
//! Each surface has a *limit*, the depth that the part may have in it. The restricted interior `S` consists of the
//! points of the tool that are deeper than the limit of their nearest surface. If no triangle of the part meets `S`,
//! each connected piece of `S` lies wholly inside the part or wholly outside, and one point of it decides which.
//!
//! **Every piece is found.** Let `p` be a point of `S` at depth `t`, and `q` its nearest point on the profile.
//! `q` is on a feature, or a reflex corner; where the profile begins or ends on the axis, a corner with its
//! mirror image counts. The ball of radius `t` about `p` touches the profile at `q` and contains nothing of it;
//! so does every smaller ball that touches there. All points of the normal from `q` between the limit `L` and `p`
//! therefore have `q` as their nearest point and lie in the same piece of `S`. Hence each piece meets an *offset
//! curve*: the points at the distance `L` on the normals of a feature, or of the fan of a reflex corner. A point
//! of an offset curve is in the closure of `S` if no other feature is nearer than `L`. Along the curve that can
//! change only where it crosses the axis or a curve at the distance `L` from another feature. These are lines and
//! circles, so their crossings have closed forms. Between two neighbouring crossings one point decides for all.
//!
//! **In floating point** `L` is the sum of the limit, the tolerance and the error bound of a point. A point
//! counts as free if nothing is nearer than `L` less a quarter of that error bound. If two circles nearly touch,
//! their crossings are accurate only to the square root of the rounding error, or are lost. But there the curves
//! are apart by no more than the rounding error, which that quarter covers. Neighbouring spans of free points
//! make one run. Nearer to the feature by half of the error bound the spans are connected, and no triangle is
//! there. All pieces that are deeper than the limit by the tolerance and the error bound are therefore found.

use crate::certify::rounding;
use crate::certify::space::MeridianPoint;
use crate::certify::tool_model::quarter::Quarter;
use crate::certify::tool_model::section::Section;
use std::f64::consts::{FRAC_PI_2, TAU};
use touchoff_plane::{cross, dot, minus, norm};

/// The sine up to which headings are opposite, for which rounding decides the sense of the turn. A cusp gets a fan whether it points
/// into the tool or out of it. The threshold does not matter: a fan that points out yields no witness.
const CUSP_SINE: f64 = 1e-9;

/// A point of a tool's half plane that stands for a connected piece of its restricted interior.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CorePoint {
    pub(crate) point: MeridianPoint,
    /// The nearest feature.
    pub(crate) feature: usize,
}

/// The restricted interior of a tool with a profile.
struct Interior<'a> {
    section: &'a Section,
    /// The depth that the part may have where each feature is the nearest; infinity for any depth.
    limits: &'a [f64],
}

/// Returns a point of each connected piece of the interior that is deeper than its features' limits by more than
/// `tolerance` plus the error bound. A piece may have several points if they are not shown to be connected.
pub(crate) fn witnesses(section: &Section, limits: &[f64], tolerance: f64) -> Vec<CorePoint> {
    let interior = Interior { section, limits };
    let tolerance_and_error = tolerance + section.outline.error;
    let mut found = Vec::new();
    for (index, feature) in section.outline.features.iter().enumerate() {
        let limit = limits[index] + tolerance_and_error;
        interior.add(&Normals::of(feature), limit, index, &mut found);
        for fan in [0, 1].into_iter().filter_map(|end| Normals::axis_fan(feature, end)) {
            interior.add(&fan, limit, index, &mut found);
        }
        let Some(next) = section.outline.features.get(index + 1) else { continue };
        // Points of a fan are equally near to both features, and so belong to the stricter.
        let owner = if limits[index + 1] < limits[index] { index + 1 } else { index };
        if let Some(fan) = Normals::fan(feature, next) {
            interior.add(&fan, limits[owner] + tolerance_and_error, owner, &mut found);
        }
    }
    interior.joined(found, tolerance_and_error)
}

impl Interior<'_> {
    /// Adds a witness of each run of normals that are longer than a limit.
    fn add(&self, normals: &Normals, limit: f64, feature: usize, found: &mut Vec<CorePoint>) {
        if limit.is_infinite() || limit >= normals.longest() {
            return;
        }
        // Between neighbouring cuts nothing comes nearer or moves away, so a middle decides for its span.
        let mut cuts = vec![0.0, normals.end()];
        normals.crossings(limit, AXIS, &mut cuts);
        for other in &self.section.outline.features {
            levels(other, limit).for_each(|level| normals.crossings(limit, level, &mut cuts));
        }
        cuts.sort_by(f64::total_cmp);
        // The widest span of each run of spans whose normals are long enough.
        let mut run: Option<[f64; 2]> = None;
        let spans = cuts.windows(2).map(|pair| [pair[0], pair[1]]);
        for span in spans.filter(|[from, to]| from < to).map(Some).chain([None]) {
            let free_span = span.filter(|[from, to]| {
                self.is_free(normals.point(f64::midpoint(*from, *to), limit), limit)
            });
            match (run, free_span) {
                (Some(widest), Some(span)) if span[1] - span[0] <= widest[1] - widest[0] => {}
                (_, Some(span)) => run = Some(span),
                (Some([from, to]), None) => {
                    let s = f64::midpoint(from, to);
                    let longest = self.length(normals, s, limit);
                    let point =
                        normals.point(s, limit + WITNESS_DEPTH_FRACTION * (longest - limit));
                    // The fan of a cusp may point out of the tool. Rounding does not affect this test, since the
                    // profile is not near.
                    if self.section.contains(point) {
                        found.push(CorePoint { point, feature });
                    }
                    run = None;
                }
                (None, None) => {}
            }
        }
    }

    /// Returns whether nothing of the profile is nearer to a point than its foot, `t` away, by more than rounding.
    fn is_free(&self, p: MeridianPoint, t: f64) -> bool {
        p[0] >= 0.0
            && self.section.unsigned_distance(p)
                >= t - rounding::FRACTION * self.section.outline.error
    }

    /// Returns the length of a normal, at least `least`: the distance at which another point of the profile is as
    /// near as its foot, or at which it reaches the axis.
    fn length(&self, normals: &Normals, s: f64, least: f64) -> f64 {
        // No normal inside the tool is longer than its diameter.
        let [mut low, mut high] = [least, normals.longest().min(2.0 * self.section.outline.size)];
        for _ in 0..MAX_HALVINGS {
            let middle = f64::midpoint(low, high);
            if self.is_free(normals.point(s, middle), middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }

    /// Returns the radius about a point of the tool within which all points are deeper than the limit of their
    /// nearest feature by more than `tolerance_and_error`. The result is not positive if no such radius is shown.
    ///
    /// Let the depth of the point be `d`. Every point within `r` of it has a depth of at least `d - r`, and its
    /// nearest feature is at most `d + 2r` from the point. For each limit `l`, `r` may therefore be as large as
    /// `d - l`, or as half the amount by which the features of that limit are farther away than `d`.
    fn margin(&self, p: MeridianPoint, tolerance_and_error: f64) -> f64 {
        let depth = self.section.signed(p);
        let features = self.section.outline.features.iter().zip(self.limits);
        features
            .map(|(feature, limit)| {
                (depth - limit - tolerance_and_error)
                    .max(0.5 * (feature.segment.distance(p) - depth))
            })
            .fold(depth, f64::min)
    }

    /// Returns whether the segment between two points is shown to stay in the interior.
    fn connects(&self, from: MeridianPoint, to: MeridianPoint, tolerance_and_error: f64) -> bool {
        let displacement = minus(to, from);
        let length = norm(displacement);
        let mut at = 0.0;
        for _ in 0..MAX_STEPS {
            if at >= length {
                return true;
            }
            let p = [0, 1].map(|k| from[k] + displacement[k] * (at / length));
            let margin = self.margin(p, tolerance_and_error);
            if margin <= self.section.outline.error {
                return false;
            }
            // Everything within the margin is in the interior, so the next step may begin there.
            at += margin;
        }
        false
    }

    /// Drops redundant witnesses: one of each set of connected witnesses is left, the one with the largest margin.
    fn joined(&self, mut found: Vec<CorePoint>, tolerance_and_error: f64) -> Vec<CorePoint> {
        // A witness far from the limits connects to others in few steps, so it stands for its piece.
        found.sort_by(|one, other| {
            let [one, other] = [one, other].map(|w| self.margin(w.point, tolerance_and_error));
            other.total_cmp(&one)
        });
        let mut pieces: Vec<Vec<CorePoint>> = Vec::new();
        for witness in found {
            let mut rest = Vec::new();
            let mut piece_witnesses = vec![witness];
            for piece in pieces {
                let connected = piece
                    .iter()
                    .any(|p| self.connects(p.point, witness.point, tolerance_and_error));
                if connected {
                    piece_witnesses = [piece, piece_witnesses].concat();
                } else {
                    rest.push(piece);
                }
            }
            rest.push(piece_witnesses);
            pieces = rest;
        }
        pieces.into_iter().map(|piece| piece[0]).collect()
    }
}

/// A witness stands at this fraction of the way from the limit to the end of the normal.
const WITNESS_DEPTH_FRACTION: f64 = 0.75;

/// The number of bisections for the length of a normal: to 2^-48 of the tool's size.
const MAX_HALVINGS: u32 = 50;

/// The maximum number of steps along a segment. After these it is not shown to stay inside.
const MAX_STEPS: u32 = 256;

/// The inward normals of a feature, or of the fan of a reflex corner.
#[derive(Clone, Copy, Debug)]
enum Normals {
    /// The normals of a line: they start at `from + s along`, `s` up to `length`, in the direction `inward`.
    Line { from: MeridianPoint, along: MeridianPoint, length: f64, inward: MeridianPoint },
    /// The normals of an arc: at the angle `from + s`, `s` up to `turn`. At the distance `t` from the profile the
    /// point is `radius + grows t` away from the centre.
    Arc { centre: MeridianPoint, from: f64, turn: f64, radius: f64, grows: f64 },
}

/// A line or circle that contains points at a distance from a feature.
#[derive(Clone, Copy)]
enum Level {
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
    fn of(feature: &Quarter) -> Normals {
        let [from, to] = feature.segment.ends;
        match feature.segment.circle {
            None => Normals::Line {
                from,
                along: feature.segment.along,
                length: feature.segment.chord,
                inward: [-feature.segment.along[1], feature.segment.along[0]],
            },
            Some(circle) => {
                let [first, last] = [from, to].map(|end| angle(minus(end, circle.centre)));
                // A convex arc is traversed counterclockwise about its centre, a concave one clockwise.
                let (from, to) = if circle.convex { (first, last) } else { (last, first) };
                let grows = if circle.convex { -1.0 } else { 1.0 };
                Normals::Arc {
                    centre: circle.centre,
                    from,
                    turn: (to - from).rem_euclid(TAU),
                    radius: circle.radius,
                    grows,
                }
            }
        }
    }

    /// Returns the fan of normals between two features that meet in a reflex corner; `None` if they do not.
    fn fan(before: &Quarter, after: &Quarter) -> Option<Normals> {
        let [arrives, leaves] = [before.segment.tangent(1), after.segment.tangent(0)];
        let turn = cross(arrives, leaves);
        if turn >= 0.0 && !(turn < CUSP_SINE && dot(arrives, leaves) < 0.0) {
            return None;
        }
        let [from, to] = [leaves, arrives].map(|tangent| angle([-tangent[1], tangent[0]]));
        Some(Normals::Arc {
            centre: after.segment.ends[0],
            from,
            turn: (to - from).rem_euclid(TAU),
            radius: 0.0,
            grows: 1.0,
        })
    }

    /// Returns the fan of normals between a feature's normal at its end on the axis and the axis, if the feature
    /// meets its mirror image in a reflex corner there.
    fn axis_fan(feature: &Quarter, end: usize) -> Option<Normals> {
        let [d, z] = feature.segment.tangent(end);
        if feature.segment.ends[end][0] != 0.0 || z >= 0.0 {
            return None;
        }
        let normal = angle([-z, d]);
        // The direction into the tool: up at its beginning, down at its end.
        let axis = if end == 0 { FRAC_PI_2 } else { -FRAC_PI_2 };
        Some(Normals::Arc {
            centre: feature.segment.ends[end],
            from: normal.min(axis),
            turn: (axis - normal).abs(),
            radius: 0.0,
            grows: 1.0,
        })
    }

    /// Returns the upper end of the parameter range.
    fn end(&self) -> f64 {
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
    fn longest(&self) -> f64 {
        match self {
            Normals::Arc { radius, grows, .. } if *grows < 0.0 => *radius,
            _ => f64::INFINITY,
        }
    }

    /// Appends the parameters at which the offset curve at the distance `t` crosses a line or circle.
    fn crossings(&self, t: f64, level: Level, into: &mut Vec<f64>) {
        let crossings = match (self, level) {
            (Normals::Line { along, .. }, Level::Line { normal, at }) => {
                let slope = dot(*along, normal);
                let crossing =
                    (slope != 0.0).then(|| (at - dot(self.point(0.0, t), normal)) / slope);
                [crossing, None]
            }
            (Normals::Line { along, .. }, Level::Circle { centre, radius }) => {
                let out = minus(self.point(0.0, t), centre);
                let (middle, offset) = (-dot(*along, out), cross(*along, out));
                let half = radius * radius - offset * offset;
                if half >= 0.0 {
                    let half = half.sqrt();
                    [Some(middle - half), Some(middle + half)]
                } else {
                    [None; 2]
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
                    [middle - half, middle + half]
                        .map(|crossing| Some((crossing - from).rem_euclid(TAU)))
                } else {
                    [None; 2]
                }
            }
        };
        let inside = crossings.into_iter().flatten().filter(|s| *s > 0.0 && *s < self.end());
        into.extend(inside);
    }
}

fn angle(vector: MeridianPoint) -> f64 {
    vector[1].atan2(vector[0])
}

/// Returns the lines and circles that contain all points at the distance `t` from a feature.
fn levels(feature: &Quarter, t: f64) -> impl Iterator<Item = Level> {
    let sides = match feature.segment.circle {
        None => {
            let normal = [-feature.segment.along[1], feature.segment.along[0]];
            let at = dot(feature.segment.ends[0], normal);
            [-t, t].map(|t| Level::Line { normal, at: at + t })
        }
        Some(circle) => [circle.radius + t, (circle.radius - t).abs()]
            .map(|radius| Level::Circle { centre: circle.centre, radius }),
    };
    let ends = feature.segment.ends.map(|centre| Level::Circle { centre, radius: t });
    sides.into_iter().chain(ends)
}

/// The axis of the tool.
const AXIS: Level = Level::Line { normal: [1.0, 0.0], at: 0.0 };

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::tool_model::owners::Owners;
    use crate::id::SurfaceId;
    use crate::tool::Interpreted;
    use crate::tool::Tool;
    use crate::tool::{Circle, ProfileSegment, ToolInfo};
    use std::borrow::Cow;
    use std::sync::LazyLock;

    static SLENDER: LazyLock<Interpreted> = LazyLock::new(|| {
        r#"tool Slender "a flat end, a long flute" {
            units mm;
            profile {
                start (0, 0);
                line to (0.5, 0) as face cutting;
                line to (0.5, 70) as flute cutting;
                line to (0, 70) as top;
            }
            niceness cutting: 1;
        }"#
        .parse()
        .expect("a tool")
    });

    static DUMBBELL: LazyLock<Interpreted> = LazyLock::new(|| {
        r#"tool Dumbbell "two cylinders of 3 mm radius, and a neck of 1 mm" {
            units mm;
            profile {
                start (0, 0);
                line to (3, 0), (3, 10) as lower cutting;
                line to (1, 10), (1, 30), (3, 30) as neck;
                line to (3, 40), (0, 40) as upper;
            }
            niceness cutting: 1;
        }"#
        .parse()
        .expect("a tool")
    });

    static CHAMFERED: LazyLock<Interpreted> = LazyLock::new(|| {
        r#"tool Chamfered "a chamfer of a tenth of a micrometre" {
            units mm;
            profile {
                start (0, 0);
                line to (4.9999, 0) as face cutting;
                line to (5, 0.0001) as chamfer cutting;
                line to (5, 50), (0, 50) as flute;
            }
            niceness cutting: 1;
        }"#
        .parse()
        .expect("a tool")
    });

    /// Returns the witnesses of a tool whose surfaces have limits by name; all others may have any depth.
    fn of(tool: &dyn Tool, limits: &[(&str, f64)]) -> Vec<CorePoint> {
        let info = tool.info();
        let section = Section::new(info, 1e-12).expect("a profile");
        let limit = |feature: &Quarter| {
            let name = &*info.surfaces[feature.segment.surface].name;
            limits
                .iter()
                .find(|(known, _)| *known == name)
                .map_or(f64::INFINITY, |(_, limit)| *limit)
        };
        let limits: Vec<f64> = section.outline.features.iter().map(limit).collect();
        let found = witnesses(&section, &limits, 1e-9);
        for witness in &found {
            assert!(section.signed(witness.point) > limits[witness.feature], "{witness:?}");
            let own = section.outline.features[witness.feature].segment.distance(witness.point);
            assert!((own - section.signed(witness.point)).abs() < 1e-12, "{witness:?}");
        }
        found
    }

    #[test]
    fn a_thin_piece_is_found() {
        let [face] = of(&*SLENDER, &[("face", 0.0)])[..] else { panic!("one piece") };
        assert!(face.point[1] < 0.5 && face.feature == 0, "{face:?}");
        let [chamfer] = of(&*CHAMFERED, &[("chamfer", 0.0)])[..] else { panic!("one piece") };
        assert_eq!(chamfer.feature, 1);
    }

    /// A profile of lines and concave or convex quarters, as a tool from user code may have it: `.tool` files may not
    /// turn straight back.
    fn drawn(pieces: &[([f64; 2], [f64; 2], Option<Circle>)]) -> Section {
        let pieces = pieces.iter().map(|(from, to, circle)| ProfileSegment {
            from: *from,
            to: *to,
            circle: *circle,
            surface: SurfaceId(0),
        });
        let info = ToolInfo { outline: Cow::Owned(pieces.collect()), ..DUMBBELL.info().clone() };
        Section::new(&info, 1e-12).expect("a profile")
    }

    /// Two arcs meet with opposite headings: in the rim of a disc, whose fan points out of the tool, and at the
    /// bottom of a groove, whose fan points into it.
    #[test]
    fn cusps_have_no_witness_outside() {
        let circle =
            |d: f64, z: f64, convex: bool| Some(Circle { centre: [d, z], radius: 2.0, convex });
        let disc = drawn(&[
            ([0.0, 0.0], [3.0, 0.0], None),
            ([3.0, 0.0], [5.0, 2.0], circle(5.0, 0.0, false)),
            ([5.0, 2.0], [3.0, 4.0], circle(5.0, 4.0, false)),
            ([3.0, 4.0], [3.0, 10.0], None),
            ([3.0, 10.0], [0.0, 10.0], None),
        ]);
        let groove = drawn(&[
            ([0.0, 0.0], [5.0, 0.0], None),
            ([5.0, 0.0], [3.0, 2.0], circle(3.0, 0.0, true)),
            ([3.0, 2.0], [5.0, 4.0], circle(3.0, 4.0, true)),
            ([5.0, 4.0], [5.0, 10.0], None),
            ([5.0, 10.0], [0.0, 10.0], None),
        ]);
        for section in [disc, groove] {
            for limit in [0.0, 0.1] {
                let found = witnesses(&section, &vec![limit; section.outline.features.len()], 1e-9);
                assert!(!found.is_empty());
                for witness in found {
                    assert!(section.signed(witness.point) > limit, "{witness:?}");
                }
            }
        }
    }

    #[test]
    fn the_greatest_depth_is_that_of_the_middle() {
        let section = Section::new(DUMBBELL.info(), 1e-12).expect("a profile");
        let of = |surface: usize| Owners::of(&section, |k| k == surface).greatest_depth(&section);
        // The middle of each cylinder is 3 mm deep. The neck's edge is on the cylinder's end as well: it is the nearest
        // point of points on the axis down to a depth of 3 mm, the middle excepted.
        for surface in 0..3 {
            assert!((3.0..=3.0303).contains(&of(surface)), "{surface}: {}", of(surface));
        }
        let section = Section::new(SLENDER.info(), 1e-12).expect("a profile");
        for surface in 0..3 {
            let depth = Owners::of(&section, |k| k == surface).greatest_depth(&section);
            assert!((0.5..=0.50505).contains(&depth), "{surface}: {depth}");
        }
    }

    #[test]
    fn pieces_are_as_many_as_there_are() {
        let limits = |limit: f64| [("lower", limit), ("neck", limit), ("upper", limit)];
        assert_eq!(of(&*DUMBBELL, &limits(0.0)).len(), 1);
        // A path along the axis joins them, which straight segments between witnesses do not show.
        assert!((1..=3).contains(&of(&*DUMBBELL, &limits(0.9)).len()));
        // The neck is nowhere so deep.
        let heights: Vec<f64> = of(&*DUMBBELL, &limits(1.5)).iter().map(|w| w.point[1]).collect();
        let [low, high] = heights[..] else { panic!("two pieces: {heights:?}") };
        assert!(low.min(high) < 10.0 && low.max(high) > 30.0, "{heights:?}");
        assert_eq!(of(&*DUMBBELL, &limits(3.1)), []);
        assert_eq!(of(&*DUMBBELL, &[("lower", 0.0), ("upper", 0.0)]).len(), 2);
        assert_eq!(of(&*DUMBBELL, &[]), []);
    }
}
