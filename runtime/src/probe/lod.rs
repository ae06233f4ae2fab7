//! Queries at the finest level of detail that a budget allows.

use super::{Law, PartPoints, Probe, Wrench};
use crate::debug::debug;
use crate::handle::Handle;
use crate::point_bvh::PointBvh;
use crate::pose::Pose;
use crate::tool::{BatchEvaluator, Tool};
use crate::unit::Unit;
use nalgebra::Vector3;

/// Number of queries over which a change of level is blended: a thirtieth of a second at 1 kHz.
const BLEND_QUERIES: u32 = 32;

/// A tool paired with a part that has [levels of detail](crate::Part::with_lods), queried within a budget. No query
/// visits more than `budget` nodes of the trees, each with sixteen boxes or points. The cost of a query is therefore
/// bounded in advance. Because nodes are counted rather than time, the same queries have the same results.
///
/// Each level is a complete quadrature, with weights and a covering radius of its own. A query proceeds through the
/// levels from the coarsest on and returns the wrench of the finest one that the budget pays for. While force and
/// torque are still being blended after a change of level, it uses no finer level.
pub struct LodProbe<'a, T: ?Sized = dyn Tool + 'a> {
    /// One probe per level, the coarsest first.
    probes: Vec<Probe<'a, T>>,
    budget: usize,
    last: Option<LastContact>,
}

debug!([T: ?Sized] LodProbe<'_, T>, "LodProbe", |this| { levels: this.probes.len(), budget: this.budget });

/// The result of the last query, if it was in contact.
struct LastContact {
    level: usize,
    /// Force and torque as returned, with the blend.
    applied: [Vector3<f64>; 2],
    /// Offset added to force and torque at the last change of level. It fades out over the remaining queries.
    step: [Vector3<f64>; 2],
    remaining: u32,
}

/// A wrench computed within a budget.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LodWrench {
    /// The result of [`Probe::wrench`] at that level, except that force and torque do not jump when the level changes
    /// in contact. At that query they equal those of the query before, and over the next 32 queries they are blended to
    /// their values at the new level. Without contact they are 0.
    pub wrench: Wrench,
    /// The level used; 0 is the finest.
    pub level: usize,
    /// Number of nodes visited, of this level and of coarser ones.
    pub nodes: usize,
    /// Upper bound on how much deeper the surface can be than found ([`Probe::sampling_error_bound`] at that level).
    pub sampling_error_bound: Option<f64>,
}

/// A budget too small for the coarsest level.
#[derive(Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "a budget of {budget} nodes is too small: the coarsest level of this part may take {needed}; give as many, \
     or a part with coarser levels"
)]
#[non_exhaustive]
pub struct BudgetError {
    /// The given budget, in nodes.
    pub budget: usize,
    /// The number of nodes that may be needed.
    pub needed: usize,
}

crate::debug_as_sentence!(BudgetError);

impl<'a, T: BatchEvaluator + ?Sized> LodProbe<'a, T> {
    /// Makes a probe of trees, the coarsest first, whose lengths are in `unit`.
    ///
    /// # Errors
    ///
    /// If the budget is less than the number of nodes of the coarsest tree.
    pub(crate) fn of(
        trees: impl DoubleEndedIterator<Item = &'a PointBvh> + Clone,
        unit: Unit,
        tool: &'a T,
        budget: usize,
        law: Law,
    ) -> Result<LodProbe<'a, T>, BudgetError> {
        let needed = trees.clone().next().map_or(0, PointBvh::nodes);
        if budget < needed {
            return Err(BudgetError { budget, needed });
        }
        let probes = trees
            .map(|tree| {
                Probe::of(PartPoints::Level(tree), unit, Handle::Borrowed(tool)).with_law(law)
            })
            .collect();
        Ok(LodProbe { probes, budget, last: None })
    }

    /// Returns force, torque, depth and niceness of the whole contact, at the finest level that the budget allows.
    pub fn wrench(&mut self, pose: &Pose) -> LodWrench {
        let last = self.last.take();
        let (mut nodes, mut finest, mut in_reach) = (0, 0, false);
        // From the coarsest level on: what remains of the budget buys the next finer one.
        let coarsest = self.probes.len() - 1;
        for (index, probe) in self.probes.iter_mut().enumerate() {
            if last.as_ref().is_some_and(|last| last.remaining > 0 && coarsest - index < last.level)
            {
                break;
            }
            match probe.traverse_within(pose, self.budget - nodes) {
                Some(visited) => (nodes, finest, in_reach) = (nodes + visited, index, visited > 0),
                None => break,
            }
        }
        let level = coarsest - finest;
        let probe = &mut self.probes[finest];
        let mut wrench = if in_reach { probe.reduce(pose) } else { probe.zero_wrench() };
        if wrench.colliding > 0 {
            let (step, remaining) = match &last {
                Some(last) if last.level == level => (last.step, last.remaining.saturating_sub(1)),
                Some(last) => (
                    [last.applied[0] - wrench.force, last.applied[1] - wrench.torque],
                    BLEND_QUERIES,
                ),
                None => ([Vector3::zeros(); 2], 0),
            };
            // At the change the result is that of the query before; the difference fades out.
            let weight = f64::from(remaining) / f64::from(BLEND_QUERIES);
            wrench.force += weight * step[0];
            wrench.torque += weight * step[1];
            self.last = Some(LastContact {
                level,
                applied: [wrench.force, wrench.torque],
                step,
                remaining,
            });
        }
        LodWrench { wrench, level, nodes, sampling_error_bound: probe.sampling_error_bound() }
    }
}
