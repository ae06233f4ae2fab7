//! Containment of a tool in the material. No triangle shows that a region of the tool is wholly inside, so one
//! point of each connected piece of the restricted interior is located.

use crate::certify::nearest::NearestTriangle;
use crate::certify::part::Location;
use crate::certify::rounding;
use crate::certify::search::QuerySetting;
use crate::certify::space::Point;
use crate::certify::tool_model::field::FieldCore;
use crate::certify::tool_model::profile::ProfileModel;
use crate::certify::tool_model::{ToolModel, interior};
use crate::id::SurfaceId;
use crate::pose::Pose;
use crate::tool::{Symmetry, ToolInfo};
use std::f64::consts::TAU;

/// The number of azimuths at which a ball of a tool with an axis is tried.
const AZIMUTHS: u32 = 8;

/// The location of the restricted interior of a tool, given that no triangle of the part meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Containment {
    /// The whole region is outside the part.
    Outside,
    /// A connected piece is inside. Holds the surface that is the nearest to a point of that piece, as an index in
    /// the tool's list.
    Inside(SurfaceId),
    /// The part has no inside: its mesh is not closed and consistently oriented.
    Unknown,
    /// A point lies on the part's surface in `f64`, or no point was found within the budget.
    Undecided,
}

impl Containment {
    /// Returns whether a piece is inside; `None` if that is not known.
    pub(super) fn is_inside(self) -> Option<bool> {
        match self {
            Containment::Inside(_) => Some(true),
            Containment::Outside => Some(false),
            Containment::Unknown | Containment::Undecided => None,
        }
    }
}

/// A point of each connected piece of the restricted interior of a tool, with its nearest surface. The points for
/// the last tolerance are kept.
#[derive(Clone)]
pub(crate) struct CorePoints {
    /// The allowed depth of each surface, in the tool's unit; infinity for any depth.
    limits: Vec<f64>,
    /// The last tolerance and its points. The inner `None` means that the budget was spent before a point was found.
    cached: Option<(f64, Option<Vec<Core>>)>,
}

#[derive(Clone, Copy)]
struct Core {
    point: Point,
    /// The radius of a ball about the point that may have a piece; `None` if the point itself belongs to one.
    radius: Option<f64>,
    surface: SurfaceId,
}

impl CorePoints {
    /// The points for a tool whose surfaces have these limits, in the tool's unit and the order of its info. Margins,
    /// below 0, count as 0: a surface that keeps away from the part is outside it.
    pub(crate) fn new(limits: impl IntoIterator<Item = f64>) -> CorePoints {
        CorePoints {
            limits: limits.into_iter().map(|limit| limit.max(0.0)).collect(),
            cached: None,
        }
    }

    /// The points for a tool that may not be in the part at all.
    pub(crate) fn whole(info: &ToolInfo) -> CorePoints {
        CorePoints::new(info.surfaces.iter().map(|_| 0.0))
    }

    /// Returns the points of pieces that are deeper than their limits by more than a tolerance.
    fn pieces_deeper_than(
        &mut self,
        tool_model: &ToolModel<'_>,
        info: &ToolInfo,
        tolerance: f64,
    ) -> Option<&[Core]> {
        if self.cached.as_ref().is_none_or(|(cached, _)| *cached != tolerance) {
            self.cached = Some((tolerance, self.find(tool_model, info, tolerance)));
        }
        self.cached.as_ref()?.1.as_deref()
    }

    fn find(
        &self,
        tool_model: &ToolModel<'_>,
        info: &ToolInfo,
        tolerance: f64,
    ) -> Option<Vec<Core>> {
        match tool_model {
            ToolModel::Profile(ProfileModel { section, .. }) => {
                let surfaces = (0..section.outline.features.len()).map(|k| tool_model.surface(k));
                let limits: Vec<f64> = surfaces.map(|surface| self.limits[surface.0]).collect();
                let witnesses = interior::witnesses(section, &limits, tolerance);
                // Any azimuth will do: a tool with a profile is a solid of revolution.
                let core_points = witnesses.iter().map(|witness| Core {
                    point: [witness.point[0], 0.0, witness.point[1]],
                    radius: None,
                    surface: tool_model.surface(witness.feature),
                });
                Some(core_points.collect())
            }
            ToolModel::Field(field) => {
                let regions = info.regions.iter();
                let limits: Vec<f64> =
                    regions.map(|region| self.limits[region.surface.0]).collect();
                let cores = field.core_points(&limits, tolerance)?.into_iter();
                let cores = cores.map(|FieldCore { point, radius, region }| Core {
                    point,
                    radius,
                    surface: tool_model.surface(region),
                });
                Some(cores.collect())
            }
        }
    }
}

impl QuerySetting<'_> {
    /// Locates the restricted interior of the tool relative to the part. Call only if no triangle exceeds its
    /// surface's limit by more than `tolerance`, in the tool's unit.
    pub(crate) fn containment(
        &self,
        core_points: &mut CorePoints,
        pose: &Pose,
        tolerance: f64,
    ) -> Containment {
        let pieces = core_points.pieces_deeper_than(&self.tool_model, self.info(), tolerance);
        let Some(pieces) = pieces else { return Containment::Undecided };
        let mut found = Containment::Outside;
        for Core { point, radius, surface } in pieces {
            let location = match radius {
                Some(radius) => self.locate_ball(*point, *radius, pose),
                None => self.bvh.locate(self.to_world(pose, *point)),
            };
            match location {
                // A ball inside need not have a piece.
                Location::Inside if radius.is_some() => found = Containment::Undecided,
                Location::Inside => return Containment::Inside(*surface),
                Location::Unknown => return Containment::Unknown,
                // Another piece may still be certain to be inside.
                Location::Undecided => found = Containment::Undecided,
                Location::Outside => {}
            }
        }
        found
    }

    /// Returns the radius of a ball about a core point inside the material that is in the tool and in the material, in the part's unit; 0
    /// for a tool without a profile.
    pub(crate) fn common_ball(
        &self,
        core_points: &mut CorePoints,
        pose: &Pose,
        tolerance: f64,
    ) -> f64 {
        let ToolModel::Profile(ProfileModel { section, .. }) = &self.tool_model else { return 0.0 };
        let pieces = core_points.pieces_deeper_than(&self.tool_model, self.info(), tolerance);
        let mut triangles = NearestTriangle::new(&self.bvh);
        let error = rounding::APART * self.error * self.length;
        let radii = pieces.into_iter().flatten().filter_map(|Core { point, .. }| {
            let place = self.to_world(pose, *point);
            let in_tool = section.unsigned_distance([point[0], point[2]]) * self.length;
            let is_inside = self.bvh.locate(place) == Location::Inside;
            is_inside.then(|| in_tool.min(triangles.distance(place)) - error)
        });
        radii.fold(0.0, f64::max)
    }

    /// Locates a ball that no triangle meets. Of a tool with an axis it may be turned about the axis: a piece there is a ring.
    fn locate_ball(&self, [d, y, z]: Point, radius: f64, pose: &Pose) -> Location {
        let turns = if self.info().symmetry == Symmetry::Revolved { AZIMUTHS } else { 1 };
        let needed = (radius + rounding::APART * self.error) * self.length;
        let mut triangles = NearestTriangle::new(&self.bvh);
        for turn in 0..turns {
            let (sin, cos) = (TAU * f64::from(turn) / f64::from(AZIMUTHS)).sin_cos();
            let point = self.to_world(pose, [d * cos - y * sin, d * sin + y * cos, z]);
            if triangles.are_beyond(point, needed) {
                return self.bvh.locate(point);
            }
        }
        Location::Undecided
    }

    /// Returns whether the restricted interior is one connected piece.
    pub(crate) fn is_one_piece(&self, core_points: &mut CorePoints, tolerance: f64) -> bool {
        let known = core_points.pieces_deeper_than(&self.tool_model, self.info(), tolerance);
        matches!(known, Some([core]) if core.radius.is_none())
    }
}
