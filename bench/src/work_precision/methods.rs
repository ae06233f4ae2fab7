//! The methods of this project that are timed.

use crate::race::contender::{Answer, Contender};
use touchoff::certify::Certifier;
use touchoff::{LodProbe, Pose, Probe, Wrench};

/// The wrench of a cloud's points.
pub(super) struct CloudProbe<'a>(pub(super) Probe<'a>);

fn answer_of(evaluation: &Wrench) -> Answer {
    let wrench = Some([evaluation.force, evaluation.torque]);
    Answer { colliding: evaluation.colliding, depth: evaluation.depth(), wrench }
}

impl Contender for CloudProbe<'_> {
    fn name(&self) -> &'static str {
        "cloud"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        answer_of(&self.0.wrench(pose))
    }
}

/// The upper bound on the depth of the whole surface.
pub(super) struct CloudBound<'a> {
    probe: Probe<'a>,
    sampling_error_bound: f64,
}

impl<'a> CloudBound<'a> {
    /// Wraps a probe. Returns `None` if the surface between the points has no known error bound.
    pub(super) fn new(probe: Probe<'a>) -> Option<CloudBound<'a>> {
        probe
            .sampling_error_bound()
            .map(|sampling_error_bound| CloudBound { probe, sampling_error_bound })
    }
}

impl Contender for CloudBound<'_> {
    fn name(&self) -> &'static str {
        "cloud + bound"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        // If no point is inside, the bound alone is the answer, and there is no contact.
        let depth = self.probe.depth_bound(pose).unwrap_or(f64::INFINITY);
        Answer { colliding: usize::from(depth > self.sampling_error_bound), depth, wrench: None }
    }
}

/// The wrench within a budget of nodes.
pub(super) struct BudgetedProbe<'a>(pub(super) LodProbe<'a>);

impl Contender for BudgetedProbe<'_> {
    fn name(&self) -> &'static str {
        "graded"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        answer_of(&self.0.wrench(pose).wrench)
    }
}

/// The certified depth of the triangles to a tolerance. The answer is the upper end of the interval, which is safe.
pub(super) struct CertifiedDepth<'a> {
    certifier: Certifier<'a>,
    tolerance: f64,
}

impl<'a> CertifiedDepth<'a> {
    /// Wraps a certifier.
    pub(super) fn new(certifier: Certifier<'a>, tolerance: f64) -> CertifiedDepth<'a> {
        CertifiedDepth { certifier, tolerance }
    }
}

impl Contender for CertifiedDepth<'_> {
    fn name(&self) -> &'static str {
        "certified"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let penetration = self.certifier.deepest(pose, self.tolerance);
        let colliding = usize::from(penetration.witness.is_some());
        Answer { colliding, depth: penetration.depth.high, wrench: None }
    }
}
