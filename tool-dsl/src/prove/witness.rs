//! Evidence from single points: jumps, shares, and points where a solid ends.

use super::borders::Pair;
use super::{JumpPoint, TOLERANCE};
use crate::bound::spread;
use crate::domain::Domain;
use crate::expr::interval::Cell;
use crate::expr::value::{At, Evaluator};
use crate::formula::CurveIndex;
use crate::geometry::outline::{Segment, stations};
use crate::plan::PlannedTool;

/// The number of points from which shares are estimated.
const SPREAD: usize = 10_000;
/// The number of points on each segment of a profile, and the distance at which the test points lie beside
/// them, relative to the tool's size.
const STATIONS: usize = 8;
pub(super) const BESIDE: f64 = 1e-4;

/// Evaluates depths and owners at points.
pub(super) struct Witness<'t> {
    tool: &'t PlannedTool,
    values: Evaluator<'t>,
    size: f64,
}

impl<'t> Witness<'t> {
    pub(super) fn new(tool: &'t PlannedTool, size: f64) -> Witness<'t> {
        let model = &tool.model;
        let depths = model.regions.iter().map(|region| region.depth);
        let asked = depths.chain(model.curves.iter().map(|curve| curve.value));
        Witness { tool, values: Evaluator::new(&model.graph, asked), size }
    }

    /// Returns each region's share of the solid, estimated from evenly spread points.
    pub(super) fn shares(&mut self) -> Vec<f64> {
        let mut counts = vec![0.0; self.tool.model.regions.len()];
        for point in spread(self.tool.model.domain, &self.tool.extent, SPREAD, 0.0) {
            if let Some(owner) = self.owner(point) {
                counts[owner] += 1.0;
            }
        }
        let all: f64 = counts.iter().sum();
        counts.iter().map(|count| count / all.max(1.0)).collect()
    }

    /// Returns a point in a box with two owners side by side and a jump of depth between them, if a few test
    /// points find one.
    pub(super) fn beside(&mut self, (own, other): Pair, cell: Cell) -> Option<JumpPoint> {
        let steps = 6;
        let at = |axis: usize, k: u32| {
            let side = cell.sides[axis];
            side.low + (side.high - side.low) * f64::from(k) / f64::from(steps)
        };
        let axes: &[usize] = match self.tool.model.domain {
            Domain::HalfPlane => &[0, 2],
            Domain::Space => &[0, 1, 2],
        };
        // Pairs of consecutive points in each row of a grid.
        let mut before = None;
        for first in 0..=steps {
            for second in 0..=steps {
                let mut p = cell.middle();
                for (k, axis) in axes.iter().enumerate() {
                    p[*axis] = at(*axis, if k == 0 { first } else { second });
                }
                let here = self.owner(p);
                if let Some((last, owner)) = before
                    && [[owner, here], [here, owner]].contains(&[Some(own), other])
                {
                    let [from, to] = if owner == Some(own) { [last, p] } else { [p, last] };
                    let seen = self.jumps([from, to], [Some(own), other]);
                    if seen.is_some() {
                        return seen;
                    }
                }
                before = (second < steps).then_some((p, here));
            }
        }
        None
    }

    /// Returns the point of the border between two points of different owners, if depth jumps there.
    fn jumps(
        &mut self,
        [mut a, mut b]: [[f64; 3]; 2],
        owners: [Option<usize>; 2],
    ) -> Option<JumpPoint> {
        for _ in 0..60 {
            let middle = [0, 1, 2].map(|k| a[k] / 2.0 + b[k] / 2.0);
            match self.owner(middle) {
                owner if owner == owners[0] => a = middle,
                owner if owner == owners[1] => b = middle,
                _ => return None,
            }
        }
        let regions = &self.tool.model.regions;
        self.owner(a);
        let [first, second] =
            owners.map(|owner| owner.map_or(0.0, |owner| self.values.get(regions[owner].depth)));
        ((first - second).abs() > TOLERANCE * self.size).then_some((a, [first, second]))
    }

    pub(super) fn owner(&mut self, [x, y, z]: [f64; 3]) -> Option<usize> {
        self.values.set(At::point(x, y, z));
        let curves = &self.tool.model.curves;
        *self.tool.plan.owner.at(&|curve: CurveIndex| self.values.get(curves[curve].value))
    }

    /// Returns points of a profile beside which the solid does not end, from a few per segment, and whether
    /// it ends beside any.
    pub(super) fn off_profile(&mut self, outline: &[Segment]) -> (Vec<[f64; 3]>, bool) {
        let near = BESIDE * self.size;
        let (mut off, mut ends) = (Vec::new(), false);
        for (index, segment) in outline.iter().enumerate() {
            for [at, inward] in stations(segment, STATIONS) {
                let others = || outline.iter().enumerate().filter(|(k, _)| *k != index);
                // Where another segment is as near, either side may belong to it.
                if at[0] < 3.0 * near || others().any(|(_, other)| other.away(at) < 3.0 * near) {
                    continue;
                }
                let beside = |way: f64| [at[0] + way * inward[0], 0.0, at[1] + way * inward[1]];
                let [inside, outside] = [near, -near].map(|way| self.owner(beside(way)));
                if inside.is_none() || outside.is_some() {
                    off.push(beside(0.0));
                } else {
                    ends = true;
                }
            }
        }
        (off, ends)
    }
}
