//! Containment of a tool in the material. No triangle shows that a region of the tool is wholly inside, so one
//! point of each connected piece of the restricted interior is located.

use crate::certify::part::Location;
use crate::certify::search::QuerySetting;
use crate::certify::space::Point;
use crate::certify::tool_model::field::DeepestPoint;
use crate::certify::tool_model::section::Owners;
use crate::certify::tool_model::{ToolModel, interior};
use crate::id::SurfaceId;
use crate::pose::Pose;
use crate::tool::ToolInfo;
use nalgebra::Vector3;

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
    fn deeper_than(
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
            ToolModel::Profile(section) => {
                let surfaces = (0..section.features.len()).map(|k| tool_model.surface(k));
                let limits: Vec<f64> = surfaces.map(|surface| self.limits[surface.0]).collect();
                let witnesses = interior::witnesses(section, &limits, tolerance);
                // Any azimuth will do: a tool with a profile is a solid of revolution.
                let core_points = witnesses.iter().map(|witness| Core {
                    point: [witness.point[0], 0.0, witness.point[1]],
                    surface: tool_model.surface(witness.feature),
                });
                Some(core_points.collect())
            }
            ToolModel::Field(field) => {
                // The tool is assumed to be connected. If not all limits are 0, the points of each region beyond its
                // limit are.
                let one = self.limits.iter().all(|limit| *limit == 0.0);
                let mut core_points = Vec::new();
                for (index, region) in info.regions.iter().enumerate() {
                    let limit = self.limits[region.surface.0];
                    // A connected tool needs one point.
                    if limit.is_infinite() || (one && index > 0) {
                        continue;
                    }
                    let owners = Owners::of_regions(info, |other, _| one || other == index);
                    match field.deepest(&owners, limit + tolerance, 2.0) {
                        DeepestPoint::Found { point, depth, .. } => {
                            core_points
                                .push(Core { point, surface: tool_model.surface(depth.feature) });
                        }
                        DeepestPoint::NoneDeeper => {}
                        DeepestPoint::BudgetSpent => return None,
                    }
                }
                Some(core_points)
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
        let Some(core_points) = core_points.deeper_than(&self.tool_model, self.info(), tolerance)
        else {
            return Containment::Undecided;
        };
        let mut found = Containment::Outside;
        for Core { point, surface } in core_points {
            let point = pose.tip() + pose.rotation() * Vector3::from(*point) * self.length;
            match self.bvh.locate(point) {
                Location::Inside => return Containment::Inside(*surface),
                Location::Unknown => return Containment::Unknown,
                // Another piece may still be certain to be inside.
                Location::Undecided => found = Containment::Undecided,
                Location::Outside => {}
            }
        }
        found
    }

    /// Returns whether the restricted interior is one connected piece.
    pub(crate) fn is_one_piece(&self, core_points: &mut CorePoints, tolerance: f64) -> bool {
        core_points
            .deeper_than(&self.tool_model, self.info(), tolerance)
            .is_some_and(|core_points| core_points.len() == 1)
    }
}
