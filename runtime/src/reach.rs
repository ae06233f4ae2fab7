//! The reach of a tool from its tip, which bounds the travel of its points when it turns.

use crate::interval::Interval;
use crate::tool::ToolInfo;
use crate::unit::Unit;

/// Returns an upper bound on the distance of a tool's points from its tip, with lengths in `unit`.
pub(crate) fn max_distance_from_tip(info: &ToolInfo, unit: Unit) -> f64 {
    let Interval { low, high } = info.reach();
    low.abs().max(high.abs()).hypot(info.radius()) * info.unit.factor_to(unit)
}
