//! The deepest point of a tool that is known by its depth field alone.

use crate::certify::space::Point;
use crate::certify::tool_model::field::{Field, Scratch};
use crate::certify::tool_model::owners::Owners;
use crate::certify::tool_model::section::Depth;
use crate::interval::Interval;
use crate::tool::Symmetry;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// The result of a search for the deepest point of some owners, in the tool's frame and unit.
pub(crate) enum DeepestPoint {
    /// A point, its depth, and an upper bound on the depth of all the owners' points.
    Found { point: Point, depth: Depth, max_depth: f64 },
    /// Proof that no point is deeper than the least depth asked for.
    NoneDeeper,
    /// No point was found before the budget was spent.
    BudgetSpent,
}

/// A box in the tool's frame and an upper bound of the depth in it.
#[derive(Clone, Copy)]
struct Cell {
    low: Point,
    high: Point,
    bound: f64,
}

impl Ord for Cell {
    fn cmp(&self, other: &Cell) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Cell) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Cell {
    fn eq(&self, other: &Cell) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Cell {}

impl Cell {
    /// Returns both halves of its longest side, with a bound for both.
    fn halves(self, bound: f64) -> [Cell; 2] {
        let size = [0, 1, 2].map(|k| self.high[k] - self.low[k]);
        let longest = (0..3).fold(0, |best, k| if size[k] > size[best] { k } else { best });
        let middle = f64::midpoint(self.low[longest], self.high[longest]);
        let (mut lower, mut upper) = (Cell { bound, ..self }, Cell { bound, ..self });
        lower.high[longest] = middle;
        upper.low[longest] = middle;
        [lower, upper]
    }
}

/// The number of boxes that are examined before the search gives up.
const BUDGET: u32 = 1 << 18;

impl Field<'_> {
    /// Searches for a point of the owners that is deeper than `min_depth`. The bound on the depth of all their points is
    /// at most `factor`, which is more than 1, times the depth found unless the budget is spent first.
    pub(crate) fn deepest(&self, owners: &Owners, min_depth: f64, factor: f64) -> DeepestPoint {
        let info = self.info();
        let Interval { low: bottom, high: top } = info.reach();
        // For a tool with an axis the half plane is enough.
        let [x, y] = match info.symmetry {
            Symmetry::Revolved => [Interval::new(0.0, info.radius()), Interval::default()],
            Symmetry::Solid { extent } => extent,
        };
        let (low, high) = ([x.low, y.low, bottom], [x.high, y.high, top]);
        let mut scratch = Scratch::default();
        let mut cells = BinaryHeap::from([Cell { low, high, bound: f64::INFINITY }]);
        let mut best: Option<(Point, Depth)> = None;
        for _ in 0..BUDGET {
            let deepest = best.map_or(0.0, |(_, depth)| depth.value);
            let Some(cell) = cells.pop() else { break };
            let Cell { low, high, bound } = cell;
            if bound <= min_depth || (deepest > min_depth && bound <= factor * deepest) {
                return match best.filter(|_| deepest > min_depth) {
                    Some((point, depth)) => {
                        DeepestPoint::Found { point, depth, max_depth: depth.value.max(bound) }
                    }
                    None => DeepestPoint::NoneDeeper,
                };
            }
            let middle = [0, 1, 2].map(|k| f64::midpoint(low[k], high[k]));
            let size = [0, 1, 2].map(|k| high[k] - low[k]);
            let reach = 0.5 * size.iter().map(|side| side * side).sum::<f64>().sqrt();
            let depth = self.depth(&mut scratch, middle);
            if depth.value > deepest
                && let Some(depth) = self.owned(&mut scratch, owners, middle, depth)
            {
                best = Some((middle, depth));
            }
            if self.passes(&mut scratch, owners, middle, reach, min_depth) {
                continue;
            }
            // The depth of a point outside is minus a lower bound of its distance, and depth grows from the surface
            // inward.
            cells.extend(cell.halves(bound.min(depth.value + self.steep * reach)));
        }
        // No owner's point outside the cells that are left is deeper than the best one, or than `min_depth`.
        let max_remaining = cells.peek().map_or(0.0, |cell| cell.bound);
        match best.filter(|(_, depth)| depth.value > min_depth) {
            Some((point, depth)) => {
                DeepestPoint::Found { point, depth, max_depth: depth.value.max(max_remaining) }
            }
            // Every box was discarded: none has an owner's point that is deeper.
            None if cells.is_empty() => DeepestPoint::NoneDeeper,
            None => DeepestPoint::BudgetSpent,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::{Certifier, PoseVerdict, TriangleBvh};
    use crate::mesh::shapes;
    use crate::{Pose, Unit};
    use fearless_simd::Level;
    use nalgebra::{Point3, Vector3};

    crate::tool! {
        tool Sphere "a ball of radius 1" {
            units mm;
            tip z = -1;
            curve sphere = hypot(d, z) - 1;
            region sphere where sphere <= 0 {
                depth: -sphere;
                direction: away from (0, 0);
            }
        }
    }

    #[test]
    fn a_search_that_discards_every_box_proves_that_no_point_is_deeper() {
        let field = Field::new(&Sphere, Level::new()).expect("a Lipschitz constant");
        let of_regions = |is_owned: bool| Owners::of_regions(field.info(), |_, _| is_owned);
        let DeepestPoint::Found { depth, max_depth, .. } =
            field.deepest(&of_regions(true), 0.5, 1.01)
        else {
            panic!("the centre is 1 deep")
        };
        assert!(depth.value <= 1.0 && 1.0 <= max_depth && max_depth <= 1.01 * depth.value);
        let deeper = field.deepest(&of_regions(true), 100.0, 1.01);
        assert!(matches!(deeper, DeepestPoint::NoneDeeper));
        let without_owners = field.deepest(&of_regions(false), 0.0, 1.01);
        assert!(matches!(without_owners, DeepestPoint::NoneDeeper));
    }

    #[test]
    fn a_tool_that_is_allowed_more_than_its_depth_is_clear()
    -> Result<(), Box<dyn std::error::Error>> {
        let (low, high) = (Point3::new(-5.0, -5.0, -5.0), Point3::new(5.0, 5.0, 0.0));
        let block = TriangleBvh::new(&shapes::cuboid(low, high, Unit::Millimetre)?);
        let mut certifier = Certifier::new(&block, &Sphere)?.with_allowance("sphere", 100.0)?;
        let pose = Pose::from_axis(Point3::new(0.0, 0.0, 3.0), Vector3::z())?;
        assert!(matches!(certifier.check_pose(&pose), PoseVerdict::Clear));
        Ok(())
    }
}
