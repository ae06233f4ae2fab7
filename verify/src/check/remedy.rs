//! Remedies of findings.

use super::{Finding, FindingKind, Verifier};
use nalgebra::Vector3;
use std::f64::consts::TAU;
use touchoff::Pose;
use touchoff::certify::{Certifier, PoseVerdict};
use touchoff::tool::Symmetry;

/// Number of halvings after which a lift is known to a thousandth of the excess, and a tilt to that of its angle.
const HALVINGS: u32 = 10;

/// Number of directions in which the axis is tilted.
const TILT_DIRECTIONS: u32 = 16;

/// Angles that are tried first, in degrees.
const TILT_ANGLES: [f64; 7] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 45.0];

/// A tilt of the tool axis about the tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tilt {
    /// Its angle, in radians.
    pub angle: f64,
    /// The tilted axis: a unit vector from the tip to the spindle, in the part's frame.
    pub axis: Vector3<f64>,
}

impl Verifier<'_> {
    /// Returns a tilt of the tool axis about the tip after which no surface exceeds its limit at the pose of a finding,
    /// proved there: the least one found, of at most 45°. `None` for findings other than depth, for a solid without an
    /// axis, or if no tilt is found. The motions before and after the pose are not checked.
    pub fn tilt(&self, finding: &Finding) -> Option<Tilt> {
        let FindingKind::Deep { .. } = finding.kind else { return None };
        if self.tool.info().symmetry != Symmetry::Revolved {
            return None;
        }
        let mut certifier = Certifier::new(self.bvh, self.tool).ok()?.with_budget(self.budget);
        for (surface, limit) in self.tool.info().surfaces.iter().zip(self.limits(finding.rapid)) {
            let limit = limit + self.resolution;
            certifier = certifier.with_allowance(&surface.name, limit).ok()?;
        }
        let (tip, axis) = (finding.pose.tip(), finding.pose.axis());
        // Across the least component of the axis, which is never near to parallel.
        let across = axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize();
        let along = axis.cross(&across);
        let tilted = |turn: f64, angle: f64| {
            axis * angle.cos() + (across * turn.cos() + along * turn.sin()) * angle.sin()
        };
        let mut is_clear = |turn: f64, angle: f64| {
            let pose = Pose::from_axis(tip, tilted(turn, angle));
            let verdict = pose.map(|pose| certifier.check_pose(&pose));
            matches!(verdict, Ok(PoseVerdict::Clear | PoseVerdict::SurfaceOnly))
        };
        let mut below = 0.0;
        for enough in TILT_ANGLES.map(f64::to_radians) {
            let turns =
                (0..TILT_DIRECTIONS).map(|k| TAU * f64::from(k) / f64::from(TILT_DIRECTIONS));
            let clear: Vec<f64> = turns.filter(|turn| is_clear(*turn, enough)).collect();
            let least = clear
                .into_iter()
                .map(|turn| (turn, bisected(below, enough, |angle| is_clear(turn, angle))));
            if let Some((turn, angle)) = least.min_by(|one, other| one.1.total_cmp(&other.1)) {
                return Some(Tilt { angle, axis: tilted(turn, angle).normalize() });
            }
            below = enough;
        }
        None
    }

    /// Returns a travel along the tool's axis, away from the tip, after which the surface of a finding is within its
    /// limit at that pose, proved there: nearly the least such travel, if depth falls along the way. `None` for
    /// findings other than depth, or if not even the tool's length suffices.
    ///
    /// For a holder this is the stick-out that is missing; for a shank the reach of the flutes, or of a neck.
    pub fn lift(&self, finding: &Finding) -> Option<f64> {
        let FindingKind::Deep { surface, depth, .. } = finding.kind else { return None };
        let allowed = self.limits(finding.rapid)[surface.0];
        let mut certifier = Certifier::new(self.bvh, self.tool).ok()?.with_budget(self.budget);
        // The other surfaces may be anywhere but inside, where no depth of a triangle tells of a surface.
        for (index, known) in self.tool.info().surfaces.iter().enumerate() {
            let limit = if index == surface.0 { allowed + self.resolution } else { f64::INFINITY };
            certifier = certifier.with_allowance(&known.name, limit).ok()?;
        }
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
            matches!(certifier.check_pose(&pose), PoseVerdict::Clear | PoseVerdict::SurfaceOnly)
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
        // Half of it was tried and is too short, unless the excess itself is enough.
        let short = if enough > excess { 0.5 * enough } else { 0.0 };
        Some(bisected(short, enough, is_clear))
    }
}

/// Returns nearly the least value that is clear, between one that is not, or may not be, and one that is.
fn bisected(mut short: f64, mut enough: f64, mut is_clear: impl FnMut(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(short, enough);
        if is_clear(middle) {
            enough = middle;
        } else {
            short = middle;
        }
    }
    enough
}
