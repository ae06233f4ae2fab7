//! The methods of this project that are timed.

use crate::race::contender::{Answer, Contender};
use touchoff::certify::Certifier;
use touchoff::{LodProbe, Pose, Probe, Wrench};

/// The wrench of a cloud's points.
pub(super) struct Points<'a>(pub(super) Probe<'a>);

fn answer(evaluation: &Wrench) -> Answer {
    let wrench = Some([evaluation.force, evaluation.torque]);
    Answer { colliding: evaluation.colliding, depth: evaluation.depth(), wrench }
}

impl Contender for Points<'_> {
    fn name(&self) -> &'static str {
        "cloud"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        answer(&self.0.wrench(pose))
    }
}

/// The upper bound on the depth of the whole surface.
pub(super) struct Bounded<'a> {
    probe: Probe<'a>,
    unseen: f64,
}

impl<'a> Bounded<'a> {
    /// Wraps a probe. Returns `None` if the surface between the points has no known error bound.
    pub(super) fn new(probe: Probe<'a>) -> Option<Bounded<'a>> {
        probe.sampling_error_bound().map(|unseen| Bounded { probe, unseen })
    }
}

impl Contender for Bounded<'_> {
    fn name(&self) -> &'static str {
        "cloud + bound"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        // If no point is inside, the bound alone is the answer, and there is no contact.
        let depth = self.probe.depth_bound(pose).unwrap_or(f64::INFINITY);
        Answer { colliding: usize::from(depth > self.unseen), depth, wrench: None }
    }
}

/// The wrench within a budget of nodes.
pub(super) struct Budgeted<'a>(pub(super) LodProbe<'a>);

impl Contender for Budgeted<'_> {
    fn name(&self) -> &'static str {
        "graded"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        answer(&self.0.wrench(pose).wrench)
    }
}

/// The certified depth of the triangles to a tolerance. The answer is the upper end of the interval, which is safe.
pub(super) struct Proved<'a> {
    certifier: Certifier<'a>,
    tolerance: f64,
}

impl<'a> Proved<'a> {
    /// Wraps a certifier.
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
        Answer { colliding, depth: found.depth.high, wrench: None }
    }
}
