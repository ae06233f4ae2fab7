//! Points at which a direction certainly is not that of steepest descent, or niceness certainly rises with
//! depth. The enclosure of angles and slopes over a box does not show that any of its points attains them.

use super::{NOTHING, SLOPE_MARGIN, Survey};
use crate::expr::interval::Cell;
use crate::prove::direction::angle_to_descent;

/// The largest angle, in radians, at which a direction counts as that of steepest descent. Components written
/// with four decimals turn it by no more.
const ANGLE_TOLERANCE: f64 = 1e-4;

/// A value that is certain at a point, and the point.
type CertainValue = (f64, [f64; 3]);

/// The facts about a region that are certain at single points.
#[derive(Clone, Default)]
pub(super) struct CertainFacts {
    /// The largest angle between the direction and that of steepest descent, in radians.
    pub(super) oblique: Option<CertainValue>,
    /// The largest rate at which niceness rises per unit of depth.
    pub(super) rises: Option<CertainValue>,
}

fn keep_larger(known: &mut Option<CertainValue>, value: f64, point: [f64; 3]) {
    if known.is_none_or(|(largest, _)| value > largest) {
        *known = Some((value, point));
    }
}

impl Survey<'_> {
    /// Examines the centre of the current box, if it belongs to `owner` and the box may contain more than is
    /// known: a larger angle, or a niceness that rises.
    pub(super) fn examine_centre(&mut self, owner: usize, cell: Cell, angle: f64, may_rise: bool) {
        let known =
            self.certain_facts[owner].oblique.map_or(ANGLE_TOLERANCE, |(largest, _)| largest);
        if angle <= known && !may_rise {
            return;
        }
        let middle = cell.middle();
        let point = Cell::point(middle);
        let claims = self.cover.claims(point);
        if !matches!(claims.as_slice(), [claim] if claim.owner == Some(owner)) {
            return;
        }
        self.slopes.set(point);
        let region = &self.tool.model.regions[owner];
        let depth = self.slopes.get(region.depth);
        let niceness = self.slopes.get(region.niceness);
        let direction = self.raw_direction(owner);
        let certain = &mut self.certain_facts[owner];
        if let Some(angle) = angle_to_descent(direction, depth, self.directions[owner].is_parallel)
            && angle.low > ANGLE_TOLERANCE
        {
            keep_larger(&mut certain.oblique, angle.low, middle);
        }
        let dot_product =
            (0..3).fold(NOTHING, |sum, k| sum.plus(depth.partials[k].times(niceness.partials[k])));
        // Niceness below 0 counts as 0.
        if dot_product.low > SLOPE_MARGIN * depth.length.high * niceness.length.high
            && niceness.value.low > 0.0
        {
            let rate = dot_product.low / (depth.length.high * depth.length.high);
            keep_larger(&mut certain.rises, rate, middle);
        }
        self.slopes.set(cell);
    }
}
