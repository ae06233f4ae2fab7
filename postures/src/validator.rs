//! Validation of postures, by proof instead of sampling.

use super::PostureRecord;
use serde::{Deserialize, Serialize};
use std::fmt;
use touchoff::certify::{AllowanceError, Certifier, NotCertifiable, PoseVerdict, TriangleBvh};
use touchoff::tool::Symmetry;
use touchoff::{Escaped, Pose, SurfaceId, Tool, Unit};

/// Rules that a posture has to meet to be accepted. Lengths are in the part's unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rules {
    /// Depth that a cutting surface may have in the part. It must be above 0: where two triangles meet at an
    /// angle, a surface that touches one of them is inside the other, and rounding decides contact with a
    /// single triangle.
    pub tolerance: f64,
    /// Bound on niceness: a posture is accepted only above it.
    pub niceness: f64,
    /// Depth allowed per surface name, in place of the default. Infinity allows any depth; a negative value is
    /// a margin that the surface has to keep from the part. A surface that does not cut and is not named here
    /// may not be in the part at all.
    pub allowed: Vec<(String, f64)>,
}

/// An error in [`Rules`].
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RulesError {
    /// The tolerance is not a finite length above 0.
    #[error(
        "a tolerance of {0} is not a length above 0, and triangles that meet at an angle are in each other's way: give \
         one in the part's unit, such as 0.01 mm"
    )]
    Tolerance(f64),
    /// The bound on niceness is not finite.
    #[error("a niceness of {0} is no number: give one as the tools' files have them")]
    Niceness(f64),
    /// The allowance is NaN or negative infinity.
    #[error(
        "an allowance of {allowed} for `{surface}` is not a length: give a finite number, or no allowance"
    )]
    Allowance {
        /// The surface.
        surface: String,
        /// The given allowance.
        allowed: f64,
    },
    /// An allowance names a surface that no tool has.
    #[error("no tool has the surface `{surface}` that is allowed for: they have {known}")]
    Surface {
        /// The given name.
        surface: String,
        /// The names of all tools' surfaces.
        known: String,
    },
}

touchoff::debug_as_sentence!(RulesError);

impl Rules {
    /// Returns the tolerance that is taken if none is stated, 0.01 mm, in a unit.
    pub fn default_tolerance(unit: Unit) -> f64 {
        0.01 * Unit::Millimetre.factor_to(unit)
    }

    /// Checks the rules for some tools: every surface with an allowance has to belong to at least one of them.
    ///
    /// # Errors
    /// [`RulesError`] for the first rule that is invalid.
    pub fn check(&self, tools: &[&dyn Tool]) -> Result<(), RulesError> {
        if !(self.tolerance > 0.0 && self.tolerance.is_finite()) {
            return Err(RulesError::Tolerance(self.tolerance));
        }
        if !self.niceness.is_finite() {
            return Err(RulesError::Niceness(self.niceness));
        }
        let surfaces = || tools.iter().flat_map(|tool| tool.info().surfaces.iter());
        for (surface, allowed) in &self.allowed {
            if allowed.is_nan() || *allowed == f64::NEG_INFINITY {
                return Err(RulesError::Allowance { surface: surface.clone(), allowed: *allowed });
            }
            if !surfaces().any(|known| known.name == *surface) {
                let mut known: Vec<String> =
                    surfaces().map(|known| format!("`{}`", known.name)).collect();
                known.sort();
                known.dedup();
                let known = known.join(", ");
                return Err(RulesError::Surface { surface: surface.clone(), known });
            }
        }
        Ok(())
    }
}

impl fmt::Display for Rules {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "tolerance {}, niceness above {}", self.tolerance, self.niceness)?;
        self.allowed
            .iter()
            .try_for_each(|(name, allowed)| write!(f, ", `{}` {allowed}", Escaped(name)))
    }
}

/// A reason for which postures of a tool cannot be validated.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ValidatorError {
    /// The tool cannot be certified.
    #[error(transparent)]
    NotCertifiable(#[from] NotCertifiable),
    /// The tool is a solid without an axis, and a posture has no spin.
    #[error("{tool} is a solid without an axis, and a posture does not say its spin")]
    Solid {
        /// The tool's name.
        tool: String,
    },
    /// An allowance is not one that the certifier takes.
    #[error(transparent)]
    Allowance(#[from] AllowanceError),
    /// The rules are invalid.
    #[error(transparent)]
    Rules(#[from] RulesError),
}

touchoff::debug_as_sentence!(ValidatorError);

/// Validates postures of a tool at a part.
pub struct Validator<'a> {
    pub(super) certifier: Certifier<'a>,
    /// Indices of the surfaces that do not cut, in the tool's list.
    non_cutting: Vec<SurfaceId>,
    /// Bound on niceness: a posture is accepted only above it.
    min_niceness: f64,
    /// Tolerance of recorded depths and clearances, in the part's unit.
    bound_tolerance: f64,
}

impl fmt::Debug for Validator<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Validator").field("certifier", &self.certifier).finish_non_exhaustive()
    }
}

/// Tolerance of recorded depths and clearances, as a fraction of the rules' tolerance.
const BOUND_TOLERANCE_FRACTION: f64 = 1.0 / 64.0;

impl<'a> Validator<'a> {
    /// Creates a validator of a tool at a part. Allowances for surfaces that this tool does not have are
    /// ignored: they are for other tools.
    ///
    /// # Errors
    /// If the tool cannot be certified, if it is a solid (a posture does not state its spin), if the rules are
    /// invalid, or if the certifier refuses an allowance.
    pub fn new(
        bvh: &'a TriangleBvh,
        tool: &'a dyn Tool,
        rules: &Rules,
    ) -> Result<Validator<'a>, ValidatorError> {
        let surfaces = &tool.info().surfaces;
        let own =
            rules.allowed.iter().filter(|(name, _)| surfaces.iter().any(|own| own.name == *name));
        let allowed: Vec<(String, f64)> = own.cloned().collect();
        Rules { allowed: allowed.clone(), ..*rules }.check(&[tool])?;
        let mut certifier = Certifier::new(bvh, tool)?;
        if let Symmetry::Solid { .. } = tool.info().symmetry {
            return Err(ValidatorError::Solid { tool: tool.info().name.to_string() });
        }
        for surface in surfaces.iter() {
            let depth = if surface.cutting { rules.tolerance } else { 0.0 };
            certifier = certifier.with_allowance(&surface.name, depth)?;
        }
        // After the defaults: the last allowance of a surface holds.
        for (surface, depth) in &allowed {
            certifier = certifier.with_allowance(surface, *depth)?;
        }
        let ids = (0..surfaces.len()).filter(|index| !surfaces[*index].cutting);
        let non_cutting = ids.map(SurfaceId).collect();
        let (min_niceness, bound_tolerance) =
            (rules.niceness, rules.tolerance * BOUND_TOLERANCE_FRACTION);
        Ok(Validator { certifier, non_cutting, min_niceness, bound_tolerance })
    }

    /// Returns whether it is proved that no surface of the tool is deeper in the part than allowed. A pose that
    /// stays undecided, for example because of rounding, is not accepted. If the part has no inside, only
    /// contact with its triangles is checked.
    pub fn accepts(&mut self, pose: &Pose) -> bool {
        matches!(self.certifier.check_pose(pose), PoseVerdict::Clear | PoseVerdict::SurfaceOnly)
    }

    /// Returns the record of a posture with its proved bounds, or `None` if it is not acceptable. The niceness
    /// has to exceed the bound of the rules, and no surface may be deeper than allowed. The pose is validated
    /// as it is recorded, by tip and axis without spin. `tool` is the tool's index in the map's list, and
    /// `niceness` the least of the contact points.
    pub fn record(&mut self, tool: u16, pose: &Pose, niceness: f64) -> Option<PostureRecord> {
        if niceness.is_nan() || niceness <= self.min_niceness {
            return None;
        }
        let (tip, axis) = (pose.tip().into(), pose.axis().into());
        let mut record =
            PostureRecord { tool, tip, axis, niceness, depth: 0.0, clearance: f64::INFINITY };
        // The spin is not recorded, so the pose is proved without it.
        let recorded_pose = record.pose().ok()?;
        if !self.accepts(&recorded_pose) {
            return None;
        }
        self.measure(&mut record, &recorded_pose);
        Some(record)
    }

    /// Sets the proved bounds of a record: the depth from above, and the clearance of the surfaces that do not
    /// cut from below.
    pub(super) fn measure(&mut self, record: &mut PostureRecord, pose: &Pose) {
        record.depth = self.certifier.deepest(pose, self.bound_tolerance).depth.high;
        let clearance = self.certifier.clearance_of(&self.non_cutting, pose, self.bound_tolerance);
        record.clearance = clearance.expect("surfaces of the tool").distance.low;
    }
}
