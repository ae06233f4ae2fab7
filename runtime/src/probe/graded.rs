//! Feeling a part as finely as a budget allows.

use super::{Law, Probe, Wrench};
use crate::part::Part;
use crate::pose::Pose;
use crate::tool::{Senses, Tool};
use nalgebra::Vector3;

/// Over so many queries a change of level is spread: a thirtieth of a second at 1 kHz.
const FADE: u32 = 32;

/// A tool beside a part that has [levels](Part::detailed), felt within a budget: no query looks at more
/// nodes of the trees, of sixteen boxes or points each, than that. So what a query may cost is known
/// before it is asked; and as nodes are counted, not time, the same queries have the same answers.
///
/// Each level is a complete quadrature with weights and a cover of its own. A query goes through the
/// levels from the coarsest on and answers with the finest that it can pay.
pub struct Graded<'a, T: ?Sized = dyn Tool + 'a> {
    /// The coarsest first.
    probes: Vec<Probe<'a, T>>,
    budget: usize,
    last: Option<Last>,
}

/// What the last query answered.
struct Last {
    level: usize,
    force: Vector3<f64>,
    torque: Vector3<f64>,
    /// What was added to force and torque when the level changed last, and for how long it still is.
    step: [Vector3<f64>; 2],
    left: u32,
}

/// What is felt within a budget.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GradedWrench {
    /// As [`Probe::wrench`] has it of that level, but force and torque do not jump when the level
    /// changes: at that query they are those of the query before, and in the next 32 they go over to
    /// what they are.
    pub wrench: Wrench,
    /// Which level was felt: 0 is the finest.
    pub level: usize,
    /// How many nodes were looked at.
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
    /// A tool beside a part, with a budget of nodes a query, and a law.
    ///
    /// # Errors
    /// A budget that is not enough for the coarsest level wherever the tool is.
    pub fn new(
        part: &'a Part,
        tool: &'a T,
        budget: usize,
        law: Law,
    ) -> Result<Graded<'a, T>, BudgetError> {
        let trees = part.levels().iter().rev();
        let probes: Vec<_> =
            trees.map(|tree| Probe::of(tree, part.unit(), tool).law(law)).collect();
        let needed = part.levels().last().map_or(0, |tree| tree.nodes());
        if budget < needed {
            return Err(BudgetError { budget, needed });
        }
        Ok(Graded { probes, budget, last: None })
    }

    /// Force, torque, depth and niceness of the whole contact, as finely as the budget allows.
    pub fn wrench(&mut self, pose: &Pose) -> GradedWrench {
        let (mut nodes, mut finest) = (0, 0);
        for (place, probe) in self.probes.iter_mut().enumerate() {
            match probe.look_within(pose, self.budget - nodes) {
                Some(more) => (nodes, finest) = (nodes + more, place),
                None => break,
            }
        }
        let level = self.probes.len() - 1 - finest;
        let probe = &mut self.probes[finest];
        let mut wrench = probe.looked(pose);
        let (mut step, mut left) = ([Vector3::zeros(); 2], 0);
        if let Some(last) = &self.last {
            (step, left) = if last.level == level {
                (last.step, last.left.saturating_sub(1))
            } else {
                ([last.force - wrench.force, last.torque - wrench.torque], FADE)
            };
        }
        let share = f64::from(left) / f64::from(FADE);
        wrench.force += share * step[0];
        wrench.torque += share * step[1];
        self.last = Some(Last { level, force: wrench.force, torque: wrench.torque, step, left });
        GradedWrench { wrench, level, nodes, unseen: probe.unseen() }
    }
}
