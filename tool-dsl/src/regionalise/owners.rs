//! The owner of a point by the rule of the text: the nearest feature of the profile, and in its cell the first condition that
//! holds, or the nearest segment of the outline with rounded corners.

use super::overlay::{ConditionedPart, Division};
use super::rounded::RoundedSection;
use super::section::{Feature, Section};
use crate::formula::CurveIndex;
use crate::geometry::outline::{Point, minus, norm, turn};
use crate::model;

/// The owners of the points of a profile.
#[derive(Clone, Debug)]
pub(crate) struct Owners<'m> {
    profile: &'m model::Profile,
    inner: Section<'m>,
    /// The outline with rounded corners, if directions are taken from it.
    rounded: Option<RoundedSection<'m>>,
}

impl<'m> Owners<'m> {
    /// Returns the owners of a profile's points.
    pub(crate) fn new(profile: &'m model::Profile) -> Owners<'m> {
        let rounded = profile.over.as_ref().and_then(|over| match &over.division {
            Division::Rounded(rounded) => Some(RoundedSection::new(rounded)),
            Division::Conditions(_) => None,
        });
        Owners { profile, inner: profile.inner.section(), rounded }
    }

    /// Returns the region of a point where the curves have these values; `None` outside. Of features that are equally near,
    /// the first has the point.
    pub(crate) fn region_at(
        &self,
        p: Point,
        value: &mut impl FnMut(CurveIndex) -> f64,
    ) -> Option<usize> {
        let part = self.inner.owner_at(p)?;
        let Some(over) = &self.profile.over else { return Some(part) };
        let condition = match &over.division {
            Division::Conditions(conditions) => {
                conditions.iter().position(|condition| condition.holds(value))
            }
            Division::Rounded(_) => self.rounded.as_ref()?.nearest(p).0,
        };
        let regions = &over.regions;
        let own = condition.and_then(|condition| {
            regions.iter().position(|region| *region == ConditionedPart { part, condition })
        });
        // At a border, rounding may tell of a condition that the part does not have.
        own.or_else(|| regions.iter().position(|region| region.part == part))
    }
}

impl Section<'_> {
    /// Returns the nearest feature to a point, if the point is on its interior side.
    fn owner_at(&self, p: Point) -> Option<usize> {
        let mut nearest = (None, f64::INFINITY);
        let mut nearest_end = f64::INFINITY;
        let reach = self.reach(p);
        for (index, feature) in self.features.iter().enumerate() {
            if !self.is_box_within(index, p, nearest.1.min(reach)) {
                continue;
            }
            let distance = self.depth_at(index, p).abs();
            if self.sector_sides(index).iter().all(|side| side.at(p) >= 0.0) {
                if distance < nearest.1 {
                    nearest = (Some(index), distance);
                }
            } else if let Feature::Piece(piece) = *feature {
                nearest_end = nearest_end.min(self.outline[piece].geometry.distance(p));
            }
        }
        // Points outside may be nearest to a convex corner. Otherwise rounding alone has a joint nearer than the features there.
        let feature = match nearest {
            (Some(feature), distance) if distance <= nearest_end + self.tolerance() => feature,
            _ => self.ending_at(p, nearest_end)?,
        };
        let is_inside = match self.features[feature] {
            Feature::Piece(piece) => self.outline[piece].geometry.signed_distance(p) >= 0.0,
            // Behind a reflex corner, its segments are nearer.
            Feature::Corner(_) => true,
        };
        is_inside.then_some(feature)
    }

    /// Returns the feature at an end of a segment at some distance from a point: the reflex corner there, or a segment that goes
    /// on smoothly; `None` at a convex corner.
    fn ending_at(&self, p: Point, distance: f64) -> Option<usize> {
        if !distance.is_finite() {
            return None;
        }
        let is_there = |feature: &Feature| match *feature {
            Feature::Corner(previous) => norm(minus(p, self.corner_at(previous))) == distance,
            Feature::Piece(_) => false,
        };
        let goes_on = |feature: &Feature| {
            feature.piece().is_some_and(|piece| {
                self.outline[piece].geometry.distance(p) == distance
                    && !self.is_at_convex_corner(piece, p)
            })
        };
        let corner = self.features.iter().position(is_there);
        corner.or_else(|| self.features.iter().position(goes_on))
    }

    /// Returns whether the end of a segment that is nearer to a point is a convex corner.
    fn is_at_convex_corner(&self, piece: usize, p: Point) -> bool {
        let [from, to] = self.outline[piece].geometry.ends.map(|end| norm(minus(p, end)));
        let [incoming, outgoing] =
            self.directions_at(if to < from { Some(piece) } else { piece.checked_sub(1) });
        turn(incoming, outgoing) > 0.0
    }
}
