//! Points at which a direction is certainly not the steepest way out, or niceness certainly rises with depth: a box
//! encloses angles and slopes, and says nothing of what any of its points has.

use super::{NOTHING, ROUNDING, Survey};
use crate::expr::interval::Cell;
use crate::prove::aim::off;

/// A direction is said to be the steepest way out up to this angle, in radians: components that are written with four
/// decimals turn it by no more.
const STRAIGHT: f64 = 1e-4;

/// A value that is certain at a point, and the point.
type At = (f64, [f64; 3]);

/// The facts about a region that are certain at single points.
#[derive(Clone, Default)]
pub(super) struct Certain {
    /// The largest angle between the direction and the steepest way out.
    pub(super) oblique: Option<At>,
    /// Where niceness rises most with depth, and by how much for each length of it.
    pub(super) rises: Option<At>,
}

fn keep_larger(known: &mut Option<At>, value: f64, point: [f64; 3]) {
    if known.is_none_or(|(most, _)| value > most) {
        *known = Some((value, point));
    }
}

impl Survey<'_> {
    /// Looks at the middle of the present box, if that is `owner`'s and the box may have more than is known: an angle so
    /// large, or a niceness that may rise.
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
        // Below 0 niceness counts as 0.
        if along.low > ROUNDING * depth.length.high * niceness.length.high
            && niceness.value.low > 0.0
        {
            let rate = along.low / (depth.length.high * depth.length.high);
            keep_larger(&mut certain.rises, rate, middle);
        }
        self.slopes.set(cell);
    }
}
