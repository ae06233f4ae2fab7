//! The model of a tool: its profile, or its depth function with a bound on the function's rate of change.

mod cells;
pub(crate) mod chains;
pub(crate) mod field;
pub(crate) mod interior;
pub(crate) mod outline;
pub(crate) mod owners;
pub(crate) mod peaks;
pub(crate) mod profile;
pub(crate) mod quarter;
pub(crate) mod rectangle;
pub(crate) mod section;
pub(crate) mod slab;

use crate::certify::space::MeridianPoint;
use crate::certify::space::Point;
use crate::certify::tool_model::field::{Field, Scratch};
use crate::certify::tool_model::owners::Owners;
use crate::certify::tool_model::profile::ProfileModel;
use crate::certify::tool_model::section::Depth;
use crate::handle::ToolHandle;
use crate::id::SurfaceId;
use fearless_simd::Level;

/// Points of the half plane, within a distance of a point.
pub(crate) struct Surroundings {
    pub(crate) centre: Point,
    pub(crate) displacement: f64,
    /// The rectangle that holds the points.
    pub(crate) rectangle: [MeridianPoint; 4],
}

/// A tool with its source of depth.
#[derive(Clone)]
pub(crate) enum ToolModel<'a> {
    /// Depth is the distance from the tool's profile.
    Profile(ProfileModel),
    /// Depth is the function in the tool's file.
    Field(Field<'a>),
}

impl<'a> ToolModel<'a> {
    /// Creates the model of a tool; `error` is the error bound of a point. Returns `None` for a tool without a profile of
    /// whose depth no Lipschitz constant is proved, and for a profile that bounds nothing.
    pub(crate) fn new(tool: &ToolHandle<'a>, level: Level, error: f64) -> Option<ToolModel<'a>> {
        if tool.info().outline.is_empty() {
            return Some(ToolModel::Field(Field::new(tool.clone(), level, error)?));
        }
        ProfileModel::new(tool.info(), error).map(ToolModel::Profile)
    }

    /// Returns the error bound of a depth, given that of a point.
    pub(crate) fn depth_error(&self, point_error: f64) -> f64 {
        match self {
            ToolModel::Profile(_) => point_error,
            ToolModel::Field(field) => field.error + field.steep * point_error,
        }
    }

    /// Returns the Lipschitz constant of depth.
    pub(crate) fn lipschitz(&self) -> f64 {
        match self {
            ToolModel::Profile(_) => 1.0,
            ToolModel::Field(field) => field.steep,
        }
    }

    /// Returns the surface of a feature.
    pub(crate) fn surface(&self, feature: usize) -> SurfaceId {
        match self {
            ToolModel::Profile(profile) => {
                SurfaceId(profile.section.outline.features[feature].segment.surface)
            }
            ToolModel::Field(field) => field.info().regions[feature].surface,
        }
    }

    /// Returns the depth of a point if it is owned. Otherwise the value is less than 0 or absent; without a profile, of whose
    /// outside only a bound is known, it is absent for a point outside.
    pub(crate) fn depth(
        &self,
        scratch: &mut Scratch,
        owners: &Owners,
        point: Point,
    ) -> Option<Depth> {
        match self {
            ToolModel::Profile(profile) => profile.section.depth_at(owners, meridian_point(point)),
            ToolModel::Field(field) => {
                Some(field.depth_of(scratch, owners, point)).filter(|depth| depth.value >= 0.0)
            }
        }
    }

    /// Returns the negative distance of the owners from a point outside, at most 0. Without a profile it is minus a
    /// lower bound of the distance of the whole tool, and points inside count as infinitely far.
    pub(crate) fn distance(&self, scratch: &mut Scratch, owners: &Owners, point: Point) -> Depth {
        match self {
            ToolModel::Profile(profile) => profile.section.distance(owners, meridian_point(point)),
            ToolModel::Field(field) => {
                let depth = field.depth(scratch, point);
                let value = if depth.value < 0.0 { depth.value } else { f64::NEG_INFINITY };
                Depth { value, ..depth }
            }
        }
    }

    /// Returns whether none of the points is inside, deeper than `limit` and owned. If the limit is below 0, returns
    /// whether none is nearer to the owners than that.
    pub(crate) fn clears(
        &self,
        scratch: &mut Scratch,
        owners: &Owners,
        points: &Surroundings,
        limit: f64,
    ) -> bool {
        let Surroundings { centre: point, displacement, rectangle } = *points;
        let steep = self.lipschitz();
        let depth = match self {
            ToolModel::Profile(profile) if limit < 0.0 => {
                return profile.section.distance(owners, meridian_point(point)).value
                    + displacement
                    < limit;
            }
            ToolModel::Profile(profile) => profile.section.signed(meridian_point(point)),
            ToolModel::Field(field) => field.depth(scratch, point).value,
        };
        // Outside, depth is the negative of a distance, whose Lipschitz constant is 1.
        if depth + displacement < 0.0 || depth + steep * displacement <= limit {
            return true;
        }
        match self {
            ToolModel::Profile(profile) => {
                let (outline, p) = (&profile.section.outline, meridian_point(point));
                owners.are_far_from(outline, &rectangle, p, depth, displacement)
            }
            ToolModel::Field(field) => field.passes(scratch, owners, point, displacement, limit),
        }
    }
}

fn meridian_point([x, y, z]: Point) -> MeridianPoint {
    [(x * x + y * y).sqrt(), z]
}
