//! What makes a posture acceptable.

use crate::Tool;
use crate::certify::{AllowanceError, Certifier, Facets, Uncertified};

/// What makes a posture acceptable.
#[derive(Clone, Debug, PartialEq)]
pub struct Rules {
    /// How deep the part may be in a surface that cuts, in the part's unit; more than 0, since facets that
    /// meet at an angle are in each other's way.
    pub tolerance: f64,
    /// Niceness has to be more than this.
    pub niceness: f64,
    /// How deep the part may be in surfaces by name, in the part's unit: those of the tools that have one of
    /// that name. What does not cut and is not named may not touch at all; below 0 it is a margin.
    pub allowed: Vec<(String, f64)>,
}

/// Why nothing can be held to rules.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RulesError {
    /// Without a tolerance no contact is acceptable.
    #[error(
        "a tolerance of {0} is no length above 0, and facets that meet at an angle are in each other's way: \
         give one, such as 0.01 mm"
    )]
    Tolerance(f64),
    /// A tool of which nothing can be proved.
    #[error(transparent)]
    Uncertified(#[from] Uncertified),
    /// An allowance that means nothing, or a tool of which it is not known which surface is the nearest.
    #[error(transparent)]
    Allowance(#[from] AllowanceError),
}

impl Rules {
    /// A certifier of a tool that goes by these.
    pub(crate) fn certifier<'a>(
        &self,
        facets: &'a Facets,
        tool: &'a dyn Tool,
    ) -> Result<Certifier<'a>, RulesError> {
        if !(self.tolerance > 0.0 && self.tolerance.is_finite()) {
            return Err(RulesError::Tolerance(self.tolerance));
        }
        let mut certifier = Certifier::new(facets, tool)?;
        for surface in tool.card().surfaces.iter() {
            let named = self.allowed.iter().find(|(name, _)| *name == surface.name);
            let usual = if surface.cutting { self.tolerance } else { 0.0 };
            let allowed = named.map_or(usual, |(_, allowed)| *allowed);
            certifier = certifier.allow(&surface.name, allowed)?;
        }
        Ok(certifier)
    }
}
