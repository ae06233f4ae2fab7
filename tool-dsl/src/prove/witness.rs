//! Evidence from single points: jumps and shares.

use super::{JumpPoint, Pair, TOLERANCE};
use crate::bound::spread;
use crate::domain::Domain;
use crate::expr::interval::Cell;
use crate::expr::value::{EvaluationPoint, LazyEvaluator};
use crate::formula::CurveIndex;
use crate::plan::PlannedTool;
use std::cell::RefCell;

/// The number of points from which shares are estimated.
const SHARE_SAMPLES: usize = 10_000;
/// Evaluates depths and owners at points.
pub(super) struct Witness<'t> {
    tool: &'t PlannedTool,
    values: LazyEvaluator<'t>,
    size: f64,
}

impl<'t> Witness<'t> {
    pub(super) fn new(tool: &'t PlannedTool, size: f64) -> Witness<'t> {
        let model = &tool.model;
        let depths = model.regions.iter().map(|region| region.depth);
        let outputs = depths.chain(model.curve_values());
        Witness { tool, values: LazyEvaluator::new(&model.graph, outputs), size }
    }

    /// Returns each region's share of the solid, estimated from evenly spread points.
    pub(super) fn shares(&mut self) -> Vec<f64> {
        let mut counts = vec![0.0; self.tool.model.regions.len()];
        for point in spread(self.tool.model.domain, &self.tool.extent, SHARE_SAMPLES, 0.0) {
            if let Some(owner) = self.owner(point) {
                counts[owner] += 1.0;
            }
        }
        let total: f64 = counts.iter().sum();
        counts.iter().map(|count| count / total.max(1.0)).collect()
    }

    /// Returns a point in a box with two owners side by side and a jump of depth between them, if a few test
    /// points find one.
    pub(super) fn find_jump(&mut self, Pair { own, other }: Pair, cell: Cell) -> Option<JumpPoint> {
        let steps = 6;
        let axes: &[usize] = match self.tool.model.domain {
            Domain::HalfPlane => &[0, 2],
            Domain::Space => &[0, 1, 2],
        };
        // Pairs of consecutive points in each row of a grid.
        let mut previous = None;
        for first in 0..=steps {
            for second in 0..=steps {
                let mut p = cell.middle();
                for (k, axis) in axes.iter().enumerate() {
                    let (step, side) = (if k == 0 { first } else { second }, cell.sides[*axis]);
                    p[*axis] =
                        side.low + (side.high - side.low) * f64::from(step) / f64::from(steps);
                }
                let owner_here = self.owner(p);
                // Side by side in either order.
                if let Some((last, owner)) = previous
                    && [[owner, owner_here], [owner_here, owner]].contains(&[Some(own), other])
                {
                    let [from, to] = if owner == Some(own) { [last, p] } else { [p, last] };
                    let jump_point = self.jump_between([from, to], [Some(own), other]);
                    if jump_point.is_some() {
                        return jump_point;
                    }
                }
                // The last point of a row is no neighbour of the next row's first.
                previous = (second < steps).then_some((p, owner_here));
            }
        }
        None
    }

    /// Returns the point of the border between two points of different owners, if depth jumps there.
    fn jump_between(
        &mut self,
        [mut a, mut b]: [[f64; 3]; 2],
        owners: [Option<usize>; 2],
    ) -> Option<JumpPoint> {
        // More halvings than a double has bits: the ends become neighbours on the two sides of the border.
        for _ in 0..60 {
            let middle = [0, 1, 2].map(|k| a[k] / 2.0 + b[k] / 2.0);
            match self.owner(middle) {
                owner if owner == owners[0] => a = middle,
                owner if owner == owners[1] => b = middle,
                // A third owner lies between: the two do not meet on this line.
                _ => return None,
            }
        }
        let regions = &self.tool.model.regions;
        // Selects the point for the values below.
        self.owner(a);
        let [first, second] =
            owners.map(|owner| owner.map_or(0.0, |owner| self.values.get(regions[owner].depth)));
        ((first - second).abs() > TOLERANCE * self.size)
            .then_some(JumpPoint { point: a, depths: [first, second] })
    }

    fn owner(&mut self, [x, y, z]: [f64; 3]) -> Option<usize> {
        self.values.set(EvaluationPoint::new(x, y, z));
        let curves = &self.tool.model.curves;
        let values = RefCell::new(&mut self.values);
        self.tool.tree.owner_at(&|curve: CurveIndex| values.borrow_mut().get(curves[curve].value))
    }
}
