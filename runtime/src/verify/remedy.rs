//! Remedies of findings.

use super::{Finding, FindingKind, Verifier};
use crate::certify::Certifier;
use crate::pose::Pose;

/// Number of halvings after which a lift is known to a thousandth of the excess.
const HALVINGS: u32 = 10;

impl Verifier<'_> {
    /// Returns a travel along the tool's axis, away from the tip, after which the surface of a finding is within its
    /// limit at that pose, proved there: nearly the least such travel, if depth falls along the way. `None` for
    /// findings other than depth, or if not even the tool's length suffices.
    ///
    /// For a holder this is the stick-out that is missing; for a shank the reach of the flutes, or of a neck.
    pub fn lift(&self, finding: &Finding) -> Option<f64> {
        let FindingKind::Deep { surface, depth, .. } = finding.kind else { return None };
        let allowed = self.limits(finding.rapid)[surface.0];
        let mut certifier = Certifier::new(self.bvh, self.tool).ok()?.with_budget(self.budget);
        let mut is_clear = |travel: f64| {
            let tip = finding.pose.tip() + finding.pose.axis() * travel;
            let pose = if finding.pose.has_spin() {
                Pose::from_quaternion(tip, finding.pose.to_isometry().rotation.coords.into())
            } else {
                Pose::from_axis(tip, finding.pose.axis())
            };
            let Ok(pose) = pose else { return false };
            let tolerance = 0.5 * self.resolution;
            if allowed < 0.0 {
                let found = certifier.clearance_of(&[surface], &pose, tolerance);
                return found.is_ok_and(|found| found.distance.low >= -allowed - self.resolution);
            }
            let found = certifier.deepest_on(surface, &pose, tolerance);
            found.is_ok_and(|found| found.depth.high <= allowed + self.resolution)
        };
        let excess = (depth.high - allowed).max(self.resolution);
        let longest = 2.0 * self.reach();
        let mut enough = excess;
        while !is_clear(enough) {
            enough *= 2.0;
            if enough > longest {
                return None;
            }
        }
        let mut short = if enough > excess { 0.5 * enough } else { 0.0 };
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(short, enough);
            if is_clear(middle) {
                enough = middle;
            } else {
                short = middle;
            }
        }
        Some(enough)
    }
}
