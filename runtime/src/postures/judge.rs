//! Which postures are acceptable: proved, not sampled.

use super::Record;
use crate::certify::{AllowanceError, Certifier, Clear, Facets, Uncertified};
use crate::escape::Escaped;
use crate::pose::Pose;
use crate::tool::Shape;
use crate::tool::Tool;
use serde::{Deserialize, Serialize};
use std::fmt;

/// By which rules postures are taken in. Lengths are in the part's unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rules {
    /// How deep a surface that cuts may be in the part; more than 0, since a surface that touches is in the way
    /// of facets that meet at an angle, and rounding decides where it touches one alone.
    pub tolerance: f64,
    /// Niceness has to be more than this.
    pub niceness: f64,
    /// What surfaces are allowed other than that, by name: how deep they may be, infinity for as deep as they
    /// will, or below 0 how far they have to keep. What does not cut and is not named here may not be in the
    /// part at all.
    pub allowed: Vec<(String, f64)>,
}

/// Rules that mean nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RulesError {
    /// A tolerance that is none.
    #[error(
        "a tolerance of {0} is no length above 0, and facets that meet at an angle are in each other's way: give \
         one in the part's unit, such as 0.01 mm"
    )]
    Tolerance(f64),
    /// A niceness that is none.
    #[error("a niceness of {0} is no number: give one as the tools' files have them")]
    Niceness(f64),
    /// An allowance that is none.
    #[error("an allowance of {allowed} for `{surface}` is no length")]
    Allowance {
        /// The surface.
        surface: String,
        /// What was given.
        allowed: f64,
    },
    /// An allowance for what is not there.
    #[error("no tool has the surface `{surface}` that is allowed for: they have {known}")]
    Surface {
        /// The name that was given.
        surface: String,
        /// Those that there are.
        known: String,
    },
}

impl Rules {
    /// Whether they mean something of some tools: every surface that is allowed for has to be one of theirs.
    ///
    /// # Errors
    /// If they do not.
    pub fn check(&self, tools: &[&dyn Tool]) -> Result<(), RulesError> {
        if !(self.tolerance > 0.0 && self.tolerance.is_finite()) {
            return Err(RulesError::Tolerance(self.tolerance));
        }
        if !self.niceness.is_finite() {
            return Err(RulesError::Niceness(self.niceness));
        }
        let surfaces = || tools.iter().flat_map(|tool| tool.card().surfaces.iter());
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

/// A tool of which nothing can be judged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum JudgeError {
    /// Nothing can be proved of it.
    #[error(transparent)]
    Uncertified(#[from] Uncertified),
    /// It is a solid without an axis.
    #[error("{tool} is a solid without an axis, and a posture does not say its spin")]
    Solid {
        /// Its name.
        tool: String,
    },
    /// A surface is allowed what means nothing.
    #[error(transparent)]
    Allowance(#[from] AllowanceError),
    /// The rules.
    #[error(transparent)]
    Rules(#[from] RulesError),
}

/// Judges postures of a tool at a part.
pub struct Judge<'a> {
    pub(super) certifier: Certifier<'a>,
    /// The surfaces that do not cut, by their places in the card's list.
    body: Vec<usize>,
    least: f64,
    /// How finely depth and clearance are told.
    fine: f64,
}

/// Depth and clearance are told to this share of the tolerance.
const FINE: f64 = 1.0 / 64.0;

impl<'a> Judge<'a> {
    /// A judge of a tool beside a part. What the rules allow surfaces that this tool does not have is for
    /// others.
    ///
    /// # Errors
    /// Of a tool of which nothing can be proved, and of a solid, whose spin a posture does not say. Rules that mean
    /// nothing.
    pub fn new(
        facets: &'a Facets,
        tool: &'a dyn Tool,
        rules: &Rules,
    ) -> Result<Judge<'a>, JudgeError> {
        let surfaces = &tool.card().surfaces;
        let own = |(name, _): &&(String, f64)| surfaces.iter().any(|own| own.name == *name);
        let allowed: Vec<(String, f64)> = rules.allowed.iter().filter(own).cloned().collect();
        Rules { allowed: allowed.clone(), ..*rules }.check(&[tool])?;
        let mut certifier = Certifier::new(facets, tool)?;
        if let Shape::Solid { .. } = tool.card().shape {
            return Err(JudgeError::Solid { tool: tool.card().name.to_string() });
        }
        for surface in surfaces.iter() {
            let depth = if surface.cutting { rules.tolerance } else { 0.0 };
            certifier = certifier.allow(&surface.name, depth)?;
        }
        for (surface, depth) in &allowed {
            certifier = certifier.allow(surface, *depth)?;
        }
        let body = (0..surfaces.len()).filter(|index| !surfaces[*index].cutting).collect();
        let (least, fine) = (rules.niceness, rules.tolerance * FINE);
        Ok(Judge { certifier, body, least, fine })
    }

    /// Whether it is proved that no surface of the tool is deeper in the part than it may be. What rounding
    /// leaves open is not.
    pub fn accepts(&mut self, pose: &Pose) -> bool {
        matches!(self.certifier.clear(pose), Clear::Clear | Clear::SurfaceOnly)
    }

    /// A posture with what is proved of it, if it is acceptable: nice enough, and no deeper than it may be.
    /// It is judged as it is told, by tip and axis. `tool` is the tool's place in the map's list, `niceness`
    /// the least of the points that touch.
    pub fn record(&mut self, tool: u16, pose: &Pose, niceness: f64) -> Option<Record> {
        if niceness.is_nan() || niceness <= self.least {
            return None;
        }
        let (tip, axis) = (pose.tip().into(), pose.axis().into());
        let mut record = Record { tool, tip, axis, niceness, depth: 0.0, clearance: f64::INFINITY };
        let told = record.pose().ok()?;
        if !self.accepts(&told) {
            return None;
        }
        self.measure(&mut record, &told);
        Some(record)
    }

    /// What is proved of depth and clearance.
    pub(super) fn measure(&mut self, record: &mut Record, pose: &Pose) {
        record.depth = self.certifier.deepest(pose, self.fine).depth[1];
        record.clearance = self.certifier.clearance_of(&self.body, pose, self.fine).distance[0];
    }
}
