//! The distance of a tool from a part.

use super::Certifier;
use super::query::DepthQuery;
use super::rounding;
use super::search::{QuerySetting, SearchState};
use super::tool_model::ToolModel;
use super::triangle::line_search::Goal;
use super::verdict::{Clearance, NoSuchSurface};
use crate::id::SurfaceId;
use crate::interval::Interval;
use crate::pose::Pose;

/// The queries for the distance of some surfaces: the depth of points inside the tool, and the distance of those
/// outside.
pub(super) struct ClearanceQuery {
    surfaces: Vec<SurfaceId>,
    inside: DepthQuery,
    outside: DepthQuery,
}

impl Certifier<'_> {
    /// Computes the distance of the part's triangles from the tool. The interval is at most as wide as the tolerance,
    /// in the part's unit, plus the rounding error bound. It is 0 in contact. For a tool inside the material it is
    /// the distance to the part's surface.
    pub fn clearance(&mut self, pose: &Pose, tolerance: f64) -> Clearance {
        let Certifier { setting, whole_query, state, budget, .. } = self;
        distance(setting, [whole_query, whole_query], state, pose, (tolerance, *budget))
    }

    /// Computes the distance of the part's triangles from some surfaces of the tool. The interval is that of [`Certifier::clearance`]. It is 0 if a point inside the tool is the
    /// nearest to one of these surfaces. For a point in a region of the tool that other surfaces own, it is the
    /// distance from the nearest of these surfaces. Without any surfaces it is infinite. For a tool without a profile
    /// the nearest surface is unknown (see [`Certifier::with_allowance`]): the lower bound is that of the whole tool,
    /// the upper bound infinite.
    ///
    /// # Errors
    /// If there is no such surface.
    pub fn clearance_of(
        &mut self,
        surfaces: &[SurfaceId],
        pose: &Pose,
        tolerance: f64,
    ) -> Result<Clearance, NoSuchSurface> {
        for surface in surfaces {
            self.checked(*surface)?;
        }
        if surfaces.is_empty() {
            let distance = Interval::new(f64::INFINITY, f64::INFINITY);
            return Ok(Clearance { distance, witness: None });
        }
        let ToolModel::Profile(section) = &self.setting.tool_model else {
            let Interval { low, .. } = self.clearance(pose, tolerance).distance;
            return Ok(Clearance { distance: Interval::new(low, f64::INFINITY), witness: None });
        };
        if self
            .clearance_query
            .as_ref()
            .is_none_or(|clearance_query| clearance_query.surfaces != surfaces)
        {
            let margin = self.setting.setup.margin;
            let new_query = |limit| {
                DepthQuery::new(section, margin, limit, |k| surfaces.contains(&SurfaceId(k)))
            };
            // Any limit below 0 makes a query for the distance from the surfaces themselves.
            let (inside, outside) = (new_query(0.0), new_query(-1.0));
            self.clearance_query =
                Some(ClearanceQuery { surfaces: surfaces.to_vec(), inside, outside });
        }
        let Certifier { setting, clearance_query, state, budget, .. } = self;
        let ClearanceQuery { inside, outside, .. } =
            clearance_query.as_ref().expect("it was just made");
        Ok(distance(setting, [inside, outside], state, pose, (tolerance, *budget)))
    }
}

/// Computes the distance of the nearest point, or 0 if one is inside.
fn distance(
    setting: &QuerySetting<'_>,
    [inside, outside]: [&DepthQuery; 2],
    state: &mut SearchState,
    pose: &Pose,
    (tolerance, budget): (f64, u32),
) -> Clearance {
    let touch = 2.0 * setting.error;
    let goal = Goal { min_depth: -touch, tolerance: touch, stop_depth: touch, budget };
    state.inside(setting, inside, pose, goal);
    if let Some(best) = &state.best {
        let witness = setting.witness(best, pose);
        let high = if state.search.is_done() { 0.0 } else { 2.0 * touch + state.search.skew };
        let distance = Interval::new(0.0, high * setting.length);
        return Clearance { distance, witness: Some(witness) };
    }
    let unsure = state.search.has_open();
    // The rounding error grows with the distance.
    let error = setting.error + rounding::distance_error_bound(state.max_distance());
    // Written so that a NaN tolerance is replaced.
    let tolerance = (4.0 * error).max(tolerance / setting.length);
    let [min_depth, stop_depth] = [f64::NEG_INFINITY, f64::INFINITY];
    state.outside(setting, outside, pose, Goal { min_depth, tolerance, stop_depth, budget });
    let more = error + state.search.skew;
    let low = -state.search.threshold().max(state.search.open_bound) - more;
    let low = if unsure { 0.0 } else { low.max(0.0) };
    // For a point outside, a depth field gives only a lower bound of the distance.
    let high = if setting.exact { -state.search.best + more } else { f64::INFINITY };
    Clearance {
        distance: Interval::new(low, high).scaled_by(setting.length),
        witness: state.best.as_ref().map(|best| setting.witness(best, pose)),
    }
}
