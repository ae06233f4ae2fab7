//! Witnesses of the part of a tool that may not be inside the material: one point of each of its
//! connected pieces.
//!
//! Each surface has a *limit*, how deep the part may be in it. The restricted interior `S` holds the
//! points of the tool that are deeper than the limit of the surface nearest to them. If no triangle of
//! the part meets `S`, each connected piece of `S` lies wholly inside the part or wholly outside, and one
//! point of it decides which.
//!
//! **Every piece is found.** Let `p` be a point of `S` at depth `t`, and `q` its nearest point on the
//! profile: on a feature, or on a reflex corner; where the profile begins or ends on the axis, one with its mirror
//! image. The ball of radius `t` about `p` touches the profile at
//! `q` and holds nothing of it; so does every smaller ball that touches there. All points of the normal
//! from `q` between the limit `L` and `p` thus have `q` as their nearest point and lie in the same piece
//! of `S`. So each piece meets an *offset curve*: the points of the normals of a feature, or of the fan
//! of a reflex corner, at the distance `L`. A point of an offset curve is in the closure of `S` where no
//! other feature is nearer than `L`. Along the curve that can change only where the curve crosses the
//! axis or a curve at the distance `L` from another feature. These are lines and circles, so their
//! crossings have closed forms; between two neighbouring crossings one point decides for all.
//!
//! **In doubles** `L` is the limit, the tolerance and what rounding makes of a place together, and a point counts as
//! free if nothing is nearer than `L` but for a quarter of that. Where two circles nearly touch their crossings are
//! known to the root of rounding only, or lost: but there the curves are apart by rounding at most, which that quarter
//! holds. Neighbouring spans of free points make one run: nearer to the feature by half of what rounding makes they are
//! connected, and no triangle is there. So pieces that are deeper than the limit by the tolerance and rounding are found.

use crate::certify::body::feature::{Feature, Place, minus, norm};
use crate::certify::body::offset::{AXIS, Normals, levels};
use crate::certify::body::section::Section;

/// A point of a tool's half plane that stands for a connected piece of its restricted interior.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Witness {
    pub(crate) place: Place,
    /// The feature that is the nearest.
    pub(crate) feature: usize,
}

/// The restricted interior of a tool with a profile.
struct Interior<'a> {
    section: &'a Section,
    /// How deep the part may be where each feature is the nearest; infinity for any depth.
    limits: &'a [f64],
}

/// A point of each connected piece of the interior that is deeper than its features' limits by more than
/// `tolerance`; pieces that are not shown to be one may have several. What rounding adds is taken off.
pub(crate) fn witnesses(section: &Section, limits: &[f64], tolerance: f64) -> Vec<Witness> {
    let interior = Interior { section, limits };
    let more = tolerance + section.error;
    let mut found = Vec::new();
    for (index, feature) in section.features.iter().enumerate() {
        let limit = limits[index] + more;
        interior.add(&Normals::of(feature), limit, index, &mut found);
        for fan in [0, 1].into_iter().filter_map(|end| Normals::axis_fan(feature, end)) {
            interior.add(&fan, limit, index, &mut found);
        }
        let Some(next) = section.features.get(index + 1) else { continue };
        // Points of a fan are as near to both features, and so belong to the stricter.
        let owner = if limits[index + 1] < limits[index] { index + 1 } else { index };
        if let Some(fan) = Normals::fan(feature, next) {
            interior.add(&fan, limits[owner] + more, owner, &mut found);
        }
    }
    interior.joined(found, more)
}

impl Interior<'_> {
    /// Adds a witness of each run of normals that are longer than a limit.
    fn add(&self, normals: &Normals, limit: f64, feature: usize, found: &mut Vec<Witness>) {
        if limit.is_infinite() || limit >= normals.longest() {
            return;
        }
        let mut cuts = vec![0.0, normals.end()];
        normals.crossings(limit, AXIS, &mut cuts);
        for other in &self.section.features {
            levels(other, limit).for_each(|level| normals.crossings(limit, level, &mut cuts));
        }
        cuts.sort_by(f64::total_cmp);
        // The widest span of each run of spans whose normals are long enough.
        let mut run: Option<[f64; 2]> = None;
        let spans = cuts.windows(2).map(|pair| [pair[0], pair[1]]);
        for span in spans.filter(|[from, to]| from < to).map(Some).chain([None]) {
            let long = span.filter(|[from, to]| {
                self.is_free(normals.point(f64::midpoint(*from, *to), limit), limit)
            });
            match (run, long) {
                (Some(widest), Some(span)) if span[1] - span[0] <= widest[1] - widest[0] => {}
                (_, Some(span)) => run = Some(span),
                (Some([from, to]), None) => {
                    let s = f64::midpoint(from, to);
                    let longest = self.length(normals, s, limit);
                    let place = normals.point(s, limit + DEEP * (longest - limit));
                    // The fan of a cusp may go out of the tool; rounding does not tell, as nothing of the profile is near.
                    if self.section.contains(place) {
                        found.push(Witness { place, feature });
                    }
                    run = None;
                }
                (None, None) => {}
            }
        }
    }

    /// Returns whether nothing of the profile is nearer to a point than its foot, `t` away, by more than rounding.
    fn is_free(&self, p: Place, t: f64) -> bool {
        p[0] >= 0.0 && self.section.away(p) >= t - NEARLY * self.section.error
    }

    /// Returns how far a normal that is at least `least` long goes before something else of the profile is as near
    /// as its foot, or to the axis.
    fn length(&self, normals: &Normals, s: f64, least: f64) -> f64 {
        let [mut low, mut high] = [least, normals.longest().min(2.0 * self.section.size)];
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(low, high);
            if self.is_free(normals.point(s, middle), middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }

    /// Returns how far about a point of the tool all points are deeper than the limit of their nearest feature by
    /// more than `more`; nothing if that is not shown.
    ///
    /// Let the point be `d` deep. No point within `r` of it is less than `d - r` deep, and its nearest
    /// feature is no farther than `d + 2r` from the point. So for each limit `l`, `r` may be as large as
    /// `d - l`, or as half of what the features of that limit are farther away than `d`.
    fn margin(&self, p: Place, more: f64) -> f64 {
        let depth = self.section.signed(p);
        let of = |(feature, limit): (&Feature, &f64)| {
            (depth - limit - more).max(0.5 * (feature.away(p) - depth))
        };
        let features = self.section.features.iter().zip(self.limits);
        features.map(of).fold(depth, f64::min)
    }

    /// Returns whether the straight way between two points is shown to stay in the interior.
    fn connects(&self, from: Place, to: Place, more: f64) -> bool {
        let way = minus(to, from);
        let length = norm(way);
        let mut at = 0.0;
        for _ in 0..STEPS {
            if at >= length {
                return true;
            }
            let p = [0, 1].map(|k| from[k] + way[k] * (at / length));
            let margin = self.margin(p, more);
            if margin <= self.section.error {
                return false;
            }
            at += margin;
        }
        false
    }

    /// Drops witnesses of pieces that have another: of those that are connected one is left, the one with
    /// the most room about it.
    fn joined(&self, mut found: Vec<Witness>, more: f64) -> Vec<Witness> {
        let margin = |witness: &Witness| self.margin(witness.place, more);
        found.sort_by(|one, other| margin(other).total_cmp(&margin(one)));
        let mut kept: Vec<Vec<Witness>> = Vec::new();
        for witness in found {
            let mut rest = Vec::new();
            let mut all = vec![witness];
            for piece in kept {
                let one = piece.iter().any(|p| self.connects(p.place, witness.place, more));
                if one {
                    all = [piece, all].concat();
                } else {
                    rest.push(piece);
                }
            }
            rest.push(all);
            kept = rest;
        }
        kept.into_iter().map(|piece| piece[0]).collect()
    }
}

/// A witness stands at this part of the way from the limit to where the normal ends.
const DEEP: f64 = 0.75;

/// What a distance may be less by for rounding alone, as a part of what rounding makes of a place.
const NEARLY: f64 = 0.25;

/// How often the length of a normal is halved: to a part in 2^48 of the tool's size.
const HALVINGS: u32 = 50;

/// How many steps a way is walked in at most, before it is not shown to stay inside.
const STEPS: u32 = 256;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::body::owners::Owners;
    use crate::tool::Tool;
    use crate::tool::{Card, Circle, Piece};
    use std::borrow::Cow;

    crate::tool! {
        tool Slender "a flat end, a long flute" {
            units mm;
            profile {
                start (0, 0);
                line to (0.5, 0) as face cutting;
                line to (0.5, 70) as flute cutting;
                line to (0, 70) as top;
            }
            niceness cutting: 1;
        }
    }

    crate::tool! {
        tool Dumbbell "two cylinders of 3 mm radius, and a neck of 1 mm" {
            units mm;
            profile {
                start (0, 0);
                line to (3, 0), (3, 10) as lower cutting;
                line to (1, 10), (1, 30), (3, 30) as neck;
                line to (3, 40), (0, 40) as upper;
            }
            niceness cutting: 1;
        }
    }

    crate::tool! {
        tool Chamfered "a chamfer of a tenth of a micrometre" {
            units mm;
            profile {
                start (0, 0);
                line to (4.9999, 0) as face cutting;
                line to (5, 0.0001) as chamfer cutting;
                line to (5, 50), (0, 50) as flute;
            }
            niceness cutting: 1;
        }
    }

    /// Witnesses of a tool whose surfaces have limits by name; all others may be as deep as they will.
    fn of(tool: &dyn Tool, limits: &[(&str, f64)]) -> Vec<Witness> {
        let card = tool.card();
        let section = Section::new(card, 1e-12).expect("a profile");
        let limit = |feature: &Feature| {
            let name = &*card.surfaces[feature.surface].name;
            limits
                .iter()
                .find(|(known, _)| *known == name)
                .map_or(f64::INFINITY, |(_, limit)| *limit)
        };
        let limits: Vec<f64> = section.features.iter().map(limit).collect();
        let found = witnesses(&section, &limits, 1e-9);
        for witness in &found {
            assert!(section.signed(witness.place) > limits[witness.feature], "{witness:?}");
            let own = section.features[witness.feature].away(witness.place);
            assert!((own - section.signed(witness.place)).abs() < 1e-12, "{witness:?}");
        }
        found
    }

    #[test]
    fn a_thin_piece_is_found() {
        let [face] = of(&Slender, &[("face", 0.0)])[..] else { panic!("one piece") };
        assert!(face.place[1] < 0.5 && face.feature == 0, "{face:?}");
        let [chamfer] = of(&Chamfered, &[("chamfer", 0.0)])[..] else { panic!("one piece") };
        assert_eq!(chamfer.feature, 1);
    }

    /// A profile of lines and concave or convex quarters, as a tool of a user's own may have it: `.tool` files may not turn
    /// straight back.
    fn drawn(pieces: &[([f64; 2], [f64; 2], Option<Circle>)]) -> Section {
        let pieces = pieces.iter().map(|(from, to, circle)| Piece {
            from: *from,
            to: *to,
            circle: *circle,
            surface: 0,
        });
        let card = Card { outline: Cow::Owned(pieces.collect()), ..Dumbbell.card().clone() };
        Section::new(&card, 1e-12).expect("a profile")
    }

    /// Two arcs meet with opposite headings: in the rim of a disc, whose fan goes out of the tool, and at the bottom of a
    /// groove, whose fan goes into it.
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
                let found = witnesses(&section, &vec![limit; section.features.len()], 1e-9);
                assert!(!found.is_empty());
                for witness in found {
                    assert!(section.signed(witness.place) > limit, "{witness:?}");
                }
            }
        }
    }

    #[test]
    fn the_greatest_depth_is_that_of_the_middle() {
        let section = Section::new(Dumbbell.card(), 1e-12).expect("a profile");
        let of = |surface: usize| Owners::of(&section, |k| k == surface).greatest_depth(&section);
        // The middle of a cylinder of 3 mm radius, the neck's, and again.
        for (surface, depth) in [(0, 3.0), (2, 3.0)] {
            assert!((0.99 * depth..=depth).contains(&of(surface)), "{surface}: {}", of(surface));
        }
        assert!((1.0..3.0).contains(&of(1)), "{}", of(1));
        let section = Section::new(Slender.card(), 1e-12).expect("a profile");
        for surface in 0..3 {
            let depth = Owners::of(&section, |k| k == surface).greatest_depth(&section);
            assert!((0.495..=0.5).contains(&depth), "{surface}: {depth}");
        }
    }

    #[test]
    fn pieces_are_as_many_as_there_are() {
        let all = |limit: f64| [("lower", limit), ("neck", limit), ("upper", limit)];
        assert_eq!(of(&Dumbbell, &all(0.0)).len(), 1);
        // A way along the axis joins them, which straight ways between witnesses do not show.
        assert!((1..=3).contains(&of(&Dumbbell, &all(0.9)).len()));
        // The neck is nowhere so deep.
        let heights: Vec<f64> = of(&Dumbbell, &all(1.5)).iter().map(|w| w.place[1]).collect();
        let [low, high] = heights[..] else { panic!("two pieces: {heights:?}") };
        assert!(low.min(high) < 10.0 && low.max(high) > 30.0, "{heights:?}");
        assert_eq!(of(&Dumbbell, &all(3.1)), []);
        assert_eq!(of(&Dumbbell, &[("lower", 0.0), ("upper", 0.0)]).len(), 2);
        assert_eq!(of(&Dumbbell, &[]), []);
    }
}
