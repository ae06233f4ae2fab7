//! Proof of a program as it is written: its text is read back, and every motion is checked with the allowances of the
//! planner.

use super::PostError;
use crate::Rules;
use crate::path::{MOTION_TOLERANCE_FRACTION, RetractSphere};
use touchoff::certify::TriangleBvh;
use touchoff::{Pose, SurfaceId, Tool};
use touchoff_verify::{ClData, Finding, FindingKind, Move, Verifier};

/// A cutter location, with a flag that is set if the tool arrives in rapid traverse.
pub type Location = (Pose, bool);

/// Fraction of the tolerance that the planner leaves to the rounding of coordinates.
const ROUNDING_FRACTION: f64 = 1.0 / 16.0;

/// Resolution of the proof, as a fraction of the tolerance. The limits of the proof are lower by this, so that no
/// excess below the resolution exceeds the rules.
const RESOLUTION_FRACTION: f64 = 1.0 / 256.0;

/// Returns the rules for the planner, so that its path meets `rules` after rounding.
pub fn planning_rules(rules: &Rules) -> Rules {
    Rules { tolerance: rules.tolerance * (1.0 - ROUNDING_FRACTION), ..rules.clone() }
}

/// Proves programs of a tool.
#[derive(Debug)]
pub struct PathProver<'a> {
    verifier: Verifier<'a>,
    /// The verifier of rapid traverse at the stock, if there is one. In feed it allows any depth.
    stock: Option<Verifier<'a>>,
    sphere: RetractSphere,
    /// Name of the output file.
    file: &'a str,
}

impl<'a> PathProver<'a> {
    /// Creates a prover with the rules of a path. A cutting surface may be as deep as the tolerance. During motions any
    /// other surface may exceed its allowance by the planner's share of the tolerance. In rapid traverse no surface may be
    /// deeper than the tolerance in the part or in its stock. `file` is the program's name in errors.
    ///
    /// # Errors
    /// If the tool or a rule is refused.
    pub fn new(
        bvh: &'a TriangleBvh,
        stock: Option<&'a TriangleBvh>,
        tool: &'a dyn Tool,
        rules: &Rules,
        file: &'a str,
    ) -> Result<PathProver<'a>, PostError> {
        let resolution = rules.tolerance * RESOLUTION_FRACTION;
        let motion = rules.tolerance * MOTION_TOLERANCE_FRACTION - resolution;
        let limited = |body| {
            Verifier::new(body, tool)?
                .with_tolerance(rules.tolerance - resolution)?
                .with_resolution(resolution)
        };
        let surfaces = tool.info().surfaces.iter();
        let allowances = surfaces.clone().filter_map(|surface| {
            // The last of several allowances for a surface holds, as in a sweep.
            let stated = rules.allowed.iter().rev().find(|(name, _)| *name == surface.name);
            let allowed = match stated {
                Some((_, allowed)) => allowed + motion,
                None if surface.cutting => return None,
                None => motion,
            };
            Some((&*surface.name, allowed))
        });
        let verifier = limited(bvh)?.with_allowances(allowances)?;
        let any_depth = surfaces.map(|surface| (&*surface.name, f64::INFINITY));
        let stock_verifier =
            stock.map(|stock| limited(stock)?.with_allowances(any_depth)).transpose()?;
        let sphere = RetractSphere::new(bvh, stock, verifier.reach());
        Ok(PathProver { verifier, stock: stock_verifier, sphere, file })
    }

    /// Proves a program, which `write` makes of cutter locations and reads back. In rapid traverse no surface may be
    /// deeper than the tolerance, in the part or in the stock, whatever its allowance. A motion in which one is changes to
    /// feed.
    ///
    /// # Errors
    /// If a motion is not proved in feed either.
    pub fn settle<T, E: From<PostError>>(
        &self,
        mut locations: Vec<Location>,
        write: impl Fn(&[Location]) -> Result<(ClData, T), E>,
    ) -> Result<(Vec<Location>, T), E> {
        loop {
            let (program, written) = write(&locations)?;
            let mut findings = self.verifier.check(&program).map_err(PostError::from)?.findings;
            if let Some(stock) = &self.stock {
                findings.extend(stock.check(&program).map_err(PostError::from)?.findings);
            }
            let Some(first) = findings.first() else { return Ok((locations, written)) };
            // Each round changes a motion to feed, so the loop ends.
            let rapid: Vec<&Finding> = findings.iter().filter(|finding| finding.rapid).collect();
            if rapid.is_empty() {
                return Err(self.failure(first, first.location).into());
            }
            rapid.iter().for_each(|finding| locations[finding.location].1 = false);
        }
    }

    /// Returns the findings of motions at the part.
    pub(super) fn findings(
        &self,
        moves: impl IntoIterator<Item = Move>,
    ) -> Result<Vec<Finding>, PostError> {
        Ok(self.verifier.check_moves(moves, &|_| ())?.findings)
    }

    /// Returns the findings of rapid traverse at the stock.
    pub(super) fn findings_in_stock(
        &self,
        moves: impl IntoIterator<Item = Move>,
    ) -> Result<Vec<Finding>, PostError> {
        let Some(stock) = &self.stock else { return Ok(Vec::new()) };
        Ok(stock.check_moves(moves, &|_| ())?.findings)
    }

    /// Returns two poses on the way off the part along the tool axis: a lead, and one from which the tool reaches the
    /// part in no direction. The latter is on a sphere about the part, twice as large as one that holds the tips of all
    /// tools that touch it. `None` for a pose beyond that.
    pub(super) fn away(&self, pose: &Pose) -> Option<[Pose; 2]> {
        let (exit, axis) = (self.sphere.outer_exit(pose)?, pose.axis());
        let lead = pose.translated(axis * exit.min(self.sphere.lead())).ok()?;
        Some([lead, pose.translated(axis * exit).ok()?])
    }

    /// Returns whether the tool reaches the part in no direction of its axis.
    pub(super) fn is_away(&self, pose: &Pose) -> bool {
        self.sphere.is_away(pose)
    }

    /// Returns the failure for a finding in the motion to a cutter location.
    pub(super) fn failure(&self, finding: &Finding, location: usize) -> PostError {
        let reason = match finding.kind {
            FindingKind::Deep { surface, allowed, max_depth, .. } => {
                format!(
                    "{} is up to {max_depth:.6} deep, and {allowed:.6} is allowed",
                    self.surface_name(surface)
                )
            }
            FindingKind::Near { surface, margin, min_distance, .. } => format!(
                "{} comes as near as {min_distance:.6}, and has to keep {margin:.6}",
                self.surface_name(surface)
            ),
            FindingKind::Inside { .. } => "the tool is inside the material".to_owned(),
            FindingKind::Undecided { surface } => {
                format!("rounding decides whether {} is too deep", self.surface_name(surface))
            }
            FindingKind::Ambiguous(error) => error.to_string(),
        };
        self.refusal(Some(finding.line), location, reason)
    }

    fn surface_name(&self, surface: SurfaceId) -> &str {
        &self.verifier.info().surface(surface).name
    }

    /// Returns the failure for the motion to a cutter location, with its line in the program if it has one.
    pub(super) fn refusal(
        &self,
        line: Option<usize>,
        location: usize,
        reason: String,
    ) -> PostError {
        let file = match line {
            Some(line) => format!("{}:{line}", self.file),
            None => self.file.to_owned(),
        };
        PostError::NotProved { file, location: location + 1, reason }
    }
}
