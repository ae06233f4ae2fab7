//! The outline of a tool: the features of its profile, and which of them is the nearest.

use crate::certify::rounding;
use crate::certify::space::MeridianPoint;
use crate::certify::tool_model::quarter::Quarter;
use crate::tool::ToolInfo;
use touchoff_plane::{dot, minus, norm};

/// The features of a profile, in its order.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    pub(crate) features: Vec<Quarter>,
    /// The largest distance of an end of a quarter from the tip.
    pub(crate) size: f64,
    /// The error bound of a point and its depth.
    pub(crate) error: f64,
}

impl Outline {
    /// Creates the outline of a tool; it is empty if the tool has no profile.
    pub(super) fn new(info: &ToolInfo, error: f64) -> Outline {
        let features: Vec<Quarter> =
            info.outline.iter().flat_map(|segment| Quarter::of(segment.geometry())).collect();
        let size = features.iter().flat_map(|f| f.segment.ends).map(norm).fold(0.0, f64::max);
        Outline { features, size, error }
    }

    /// Returns the difference of two distances up to which both features count as the nearest: the errors of both.
    pub(super) fn owner_margin(&self) -> f64 {
        rounding::TIE * self.error
    }

    /// Returns the distance outside up to which a point counts as touching.
    pub(super) fn contact_tolerance(&self) -> f64 {
        rounding::APART * self.error
    }

    /// Returns the distance of a point from the nearest of some features, and that feature.
    #[inline]
    pub(super) fn nearest(
        &self,
        features: impl Iterator<Item = usize>,
        p: MeridianPoint,
    ) -> (f64, usize) {
        features.fold((f64::INFINITY, 0), |nearest, feature| {
            let distance = self.features[feature].segment.distance(p);
            if distance < nearest.0 { (distance, feature) } else { nearest }
        })
    }

    /// Returns whether neighbouring features are nearer than `feature` to all points of a polygon. That is so if the
    /// nearest point of `feature` is an end that it shares with a neighbour, and the neighbour comes nearer from there.
    pub(crate) fn hidden_by_neighbours(&self, feature: usize, corners: &[MeridianPoint]) -> bool {
        let Some(ends) = self.features[feature].nearest_ends(corners) else { return false };
        [0, 1].into_iter().all(|end| !ends[end] || self.neighbour_is_nearer(feature, end, corners))
    }

    /// Returns whether the neighbour that shares an end of a feature comes nearer to all points of a polygon from there.
    fn neighbour_is_nearer(&self, feature: usize, end: usize, corners: &[MeridianPoint]) -> bool {
        let neighbour = if end == 0 { feature.checked_sub(1) } else { Some(feature + 1) };
        let Some(other) = neighbour.and_then(|index| self.features.get(index)) else {
            return false;
        };
        // The direction in which the neighbour leaves the shared end.
        let tangent = other.segment.tangent(1 - end);
        let outward = if end == 0 { tangent.map(|part| -part) } else { tangent };
        let from = self.features[feature].segment.ends[end];
        corners.iter().all(|p| dot(outward, minus(*p, from)) > 0.0)
    }
}
