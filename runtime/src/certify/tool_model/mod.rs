//! The model of a tool: its profile, or its depth function with a bound on the function's rate of change.

mod circles;
pub(crate) mod deepest;
mod enclosed;
pub(crate) mod feature;
pub(crate) mod field;
pub(crate) mod interior;
mod offset;
pub(crate) mod owners;
pub(crate) mod section;

use crate::certify::space::Point;
use crate::certify::tool_model::feature::MeridianPoint;
use crate::certify::tool_model::field::{Field, Scratch};
use crate::certify::tool_model::owners::Owners;
use crate::certify::tool_model::section::{Depth, Section};
use crate::id::SurfaceId;

/// A tool with its source of depth.
pub(crate) enum ToolModel<'a> {
    /// Depth is the distance from the tool's profile.
    Profile(Section),
    /// Depth is the function in the tool's file.
    Field(Field<'a>),
}

impl ToolModel<'_> {
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
            ToolModel::Profile(section) => SurfaceId(section.features[feature].surface),
            ToolModel::Field(field) => field.info().regions[feature].surface,
        }
    }

    /// Returns the depth of a point if it is owned. Otherwise the value is less than 0 or absent.
    pub(crate) fn depth(
        &self,
        scratch: &mut Scratch,
        owners: &Owners,
        point: Point,
    ) -> Option<Depth> {
        match self {
            ToolModel::Profile(section) => section.depth_at(owners, meridian_point(point)),
            ToolModel::Field(field) => Some(field.depth_of(scratch, owners, point)),
        }
    }

    /// Returns the negative distance of the owners from a point outside, at most 0. Without a profile it is minus a
    /// lower bound of the distance of the whole tool, and points inside count as infinitely far.
    pub(crate) fn distance(&self, scratch: &mut Scratch, owners: &Owners, point: Point) -> Depth {
        match self {
            ToolModel::Profile(section) => section.distance(owners, meridian_point(point)),
            ToolModel::Field(field) => {
                let depth = field.depth(scratch, point);
                let value = if depth.value < 0.0 { depth.value } else { f64::NEG_INFINITY };
                Depth { value, ..depth }
            }
        }
    }

    /// Returns whether no point of a rectangle of the half plane, within `displacement` of a point, is inside,
    /// deeper than `limit` and owned. If the limit is below 0, returns whether no such point is nearer to the
    /// owners than that.
    pub(crate) fn clears(
        &self,
        scratch: &mut Scratch,
        owners: &Owners,
        (point, rectangle): (Point, &[MeridianPoint; 4]),
        (displacement, limit): (f64, f64),
    ) -> bool {
        let steep = self.lipschitz();
        let depth = match self {
            ToolModel::Profile(section) if limit < 0.0 => {
                return section.distance(owners, meridian_point(point)).value + displacement
                    < limit;
            }
            ToolModel::Profile(section) => section.signed(meridian_point(point)),
            ToolModel::Field(field) => field.depth(scratch, point).value,
        };
        if depth + displacement < 0.0 || depth + steep * displacement <= limit {
            return true;
        }
        match self {
            ToolModel::Profile(section) => {
                section.far_from(owners, rectangle, meridian_point(point), depth, displacement)
            }
            ToolModel::Field(field) => field.passes(scratch, owners, point, displacement, limit),
        }
    }
}

fn meridian_point([x, y, z]: Point) -> MeridianPoint {
    [(x * x + y * y).sqrt(), z]
}
