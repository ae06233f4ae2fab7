//! Points at which a direction certainly is not that of steepest descent, or niceness certainly rises with
//! depth. The enclosure of angles and slopes over a box does not show that any of its points attains them.

use super::{NOTHING, ROUNDING, Survey};
use crate::expr::interval::Cell;
use crate::prove::direction::off;

/// The largest angle, in radians, at which a direction counts as that of steepest descent. Components written
/// with four decimals turn it by no more.
const STRAIGHT: f64 = 1e-4;

/// A value that is certain at a point, and the point.
type At = (f64, [f64; 3]);

/// The facts about a region that are certain at single points.
#[derive(Clone, Default)]
pub(super) struct Certain {
    /// The largest angle between the direction and that of steepest descent, in radians.
    pub(super) oblique: Option<At>,
    /// The largest rate at which niceness rises per unit of depth.
    pub(super) rises: Option<At>,
}

fn keep_larger(known: &mut Option<At>, value: f64, point: [f64; 3]) {
    if known.is_none_or(|(most, _)| value > most) {
        *known = Some((value, point));
    }
}

impl Survey<'_> {
    /// Examines the centre of the current box, if it belongs to `owner` and the box may contain more than is
    /// known: a larger angle, or a niceness that rises.
    pub(super) fn look_at_middle(&mut self, owner: usize, cell: Cell, angle: f64, may_rise: bool) {
        let known = self.certain[owner].oblique.map_or(STRAIGHT, |(most, _)| most);
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
        let course = self.course(owner);
        let certain = &mut self.certain[owner];
        if let Some(angle) = off(course, depth, self.aims[owner].straight)
            && angle.low > STRAIGHT
        {
            keep_larger(&mut certain.oblique, angle.low, middle);
        }
        let along =
            (0..3).fold(NOTHING, |sum, k| sum.plus(depth.parts[k].times(niceness.parts[k])));
        // Niceness below 0 counts as 0.
        if along.low > ROUNDING * depth.length.high * niceness.length.high
            && niceness.value.low > 0.0
        {
            let rate = along.low / (depth.length.high * depth.length.high);
            keep_larger(&mut certain.rises, rate, middle);
        }
        self.slopes.set(cell);
    }
}
