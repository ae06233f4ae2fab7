//! Feeling a part as finely as a budget allows.

use super::{Law, Probe, Wrench};
use crate::pose::Pose;
use crate::tool::{Senses, Tool};
use crate::tree::Tree;
use crate::unit::Unit;
use nalgebra::Vector3;

/// Over so many queries a change of level is spread: a thirtieth of a second at 1 kHz.
const FADE: u32 = 32;

/// A tool beside a part that has [levels](crate::Part::detailed), felt within a budget: no query looks at more
/// nodes of the trees, of sixteen boxes or points each, than that. So what a query may cost is known
/// before it is asked; and as nodes are counted, not time, the same queries have the same answers.
///
/// Each level is a complete quadrature with weights and a cover of its own. A query goes through the
/// levels from the coarsest on and answers with the finest that it can pay; but while force and torque
/// still go over from a change of level, with none that is finer.
pub struct Graded<'a, T: ?Sized = dyn Tool + 'a> {
    /// The coarsest first.
    probes: Vec<Probe<'a, T>>,
    budget: usize,
    last: Option<Last>,
}

/// What the last query answered in contact.
struct Last {
    level: usize,
    /// Force and torque.
    pushed: [Vector3<f64>; 2],
    /// What was added to force and torque when the level changed last, and for how long it still is.
    step: [Vector3<f64>; 2],
    left: u32,
}

/// What is felt within a budget.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GradedWrench {
    /// As [`Probe::wrench`] has it of that level, but force and torque do not jump when the level
    /// changes in contact: at that query they are those of the query before, and in the next 32 they go
    /// over to what they are. Without contact they are 0.
    pub wrench: Wrench,
    /// Which level was felt: 0 is the finest.
    pub level: usize,
    /// How many nodes were looked at, of this level and of coarser ones.
    pub nodes: usize,
    /// How much deeper than found the surface can be ([`Probe::unseen`] of that level).
    pub unseen: Option<f64>,
}

/// A budget that does not pay for the coarsest level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "a budget of {budget} nodes is too small: the coarsest level of this part may take {needed}; give as many, \
     or a part with coarser levels"
)]
pub struct BudgetError {
    /// What was given.
    pub budget: usize,
    /// What may be needed.
    pub needed: usize,
}

impl<'a, T: Senses + ?Sized> Graded<'a, T> {
    /// Asks trees, the coarsest first, whose lengths are in that unit.
    pub(crate) fn of(
        trees: impl DoubleEndedIterator<Item = &'a Tree> + Clone,
        unit: Unit,
        (tool, budget, law): (&'a T, usize, Law),
    ) -> Result<Graded<'a, T>, BudgetError> {
        let needed = trees.clone().next().map_or(0, Tree::nodes);
        if budget < needed {
            return Err(BudgetError { budget, needed });
        }
        let probes = trees.map(|tree| Probe::of(tree, unit, tool).law(law)).collect();
        Ok(Graded { probes, budget, last: None })
    }

    /// Force, torque, depth and niceness of the whole contact, as finely as the budget allows.
    pub fn wrench(&mut self, pose: &Pose) -> GradedWrench {
        let last = self.last.take();
        let (mut nodes, mut finest, mut in_reach) = (0, 0, false);
        let coarsest = self.probes.len() - 1;
        for (place, probe) in self.probes.iter_mut().enumerate() {
            if last.as_ref().is_some_and(|last| last.left > 0 && coarsest - place < last.level) {
                break;
            }
            match probe.traverse_within(pose, self.budget - nodes) {
                Some(more) => (nodes, finest, in_reach) = (nodes + more, place, more > 0),
                None => break,
            }
        }
        let level = coarsest - finest;
        let probe = &mut self.probes[finest];
        let mut wrench = if in_reach { probe.reduce(pose) } else { probe.nothing() };
        if wrench.colliding > 0 {
            let (step, left) = match &last {
                Some(last) if last.level == level => (last.step, last.left.saturating_sub(1)),
                Some(last) => {
                    ([last.pushed[0] - wrench.force, last.pushed[1] - wrench.torque], FADE)
                }
                None => ([Vector3::zeros(); 2], 0),
            };
            let share = f64::from(left) / f64::from(FADE);
            wrench.force += share * step[0];
            wrench.torque += share * step[1];
            self.last = Some(Last { level, pushed: [wrench.force, wrench.torque], step, left });
        }
        GradedWrench { wrench, level, nodes, unseen: probe.unseen() }
    }
}
