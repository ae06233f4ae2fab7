//! This project's ways to answer, as they are raced.

use crate::race::contender::{Answer, Contender};
use touchoff::certify::Certifier;
use touchoff::{Graded, Pose, Probe, Wrench};

/// The wrench of a cloud's points.
pub(super) struct Points<'a>(pub(super) Probe<'a>);

fn answer(felt: &Wrench) -> Answer {
    let wrench = Some([felt.force, felt.torque]);
    Answer { colliding: felt.colliding, depth: felt.depth(), wrench }
}

impl Contender for Points<'_> {
    fn name(&self) -> &'static str {
        "cloud"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        answer(&self.0.wrench(pose))
    }
}

/// What no place of the surface is deeper than.
pub(super) struct Bounded<'a> {
    probe: Probe<'a>,
    unseen: f64,
}

impl<'a> Bounded<'a> {
    /// Of a probe; `None` where it is not known what lies between the points.
    pub(super) fn new(probe: Probe<'a>) -> Option<Bounded<'a>> {
        probe.unseen().map(|unseen| Bounded { probe, unseen })
    }
}

impl Contender for Bounded<'_> {
    fn name(&self) -> &'static str {
        "cloud + bound"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        // Where no point is inside, the bound alone is the answer, and nothing was felt.
        let depth = self.probe.depth_bound(pose).unwrap_or(f64::INFINITY);
        Answer { colliding: usize::from(depth > self.unseen), depth, wrench: None }
    }
}

/// What is felt within a budget of nodes.
pub(super) struct Budgeted<'a>(pub(super) Graded<'a>);

impl Contender for Budgeted<'_> {
    fn name(&self) -> &'static str {
        "graded"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        answer(&self.0.wrench(pose).wrench)
    }
}

/// How deep the triangles are, to a tolerance: its upper end, which is safe.
pub(super) struct Proved<'a> {
    certifier: Certifier<'a>,
    tolerance: f64,
}

impl<'a> Proved<'a> {
    /// Of a certifier.
    pub(super) fn new(certifier: Certifier<'a>, tolerance: f64) -> Proved<'a> {
        Proved { certifier, tolerance }
    }
}

impl Contender for Proved<'_> {
    fn name(&self) -> &'static str {
        "certified"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let found = self.certifier.deepest(pose, self.tolerance);
        let colliding = usize::from(found.witness.is_some());
        Answer { colliding, depth: found.depth[1], wrench: None }
    }
}
