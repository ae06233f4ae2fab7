//! Tools as oracles whose depth is fast enough for millions of evaluations.

use crate::prelude::*;
use touchoff_tests::oracle::{self, restated};

pub(crate) const PROFILES: [&str; 6] =
    ["Fig73Exact", "BullNose", "Lollipop", "TSlot", "BallEr16", "TaperedBall"];

/// Tools with regions written by hand, solids, and tools whose profile overhangs.
pub(crate) const FIELDS: [&str; 7] =
    ["Fig73", "Cylinder", "UnitSphere", "Block", "LBracket", "BoringBar", "FaceMill"];

/// A tool whose depth is evaluated many times.
pub(crate) struct DepthOracle {
    pub(crate) oracle: Box<dyn Oracle>,
    /// The tool by its profile, if its depth is the distance to that.
    pub(crate) profile: Option<Nearest>,
    /// A Lipschitz bound of the depth; of the fields, the thesis's tool attains √5.
    pub(crate) lipschitz_bound: f64,
    /// The smallest gap to validate, as a share of the tool's size. The certifier resolves a field only to a thousandth.
    pub(crate) min_gap: f64,
    /// The distance of samples from the lower bound, at most, as a share of the tool's size.
    pub(crate) reach_margin: f64,
}

impl DepthOracle {
    pub(crate) fn of(name: &str) -> DepthOracle {
        let restated = restated::of(name).filter(|_| !FIELDS.contains(&name));
        let profile = restated.map(|tool| Nearest::new(&tool));
        let [lipschitz_bound, min_gap, reach_margin] =
            if profile.is_some() { [1.0, 1e-7, 1e-9] } else { [2.24, 1e-2, 1e-6] };
        DepthOracle { oracle: oracle::of(name), profile, lipschitz_bound, min_gap, reach_margin }
    }

    /// Returns the depth of a point; it is negative outside.
    pub(crate) fn depth(&self, p: [f64; 3]) -> f64 {
        let field = if self.profile.is_some() { None } else { self.oracle.evaluate(p) };
        field.map_or_else(|| -self.oracle.signed_distance(p), |evaluation| evaluation.depth)
    }

    /// Returns the tolerance for the certifier, in the part's unit. That of a field is a millionth of the unit,
    /// whatever the tool's size.
    pub(crate) fn tolerance(&self, size: f64) -> f64 {
        if self.profile.is_some() { 1e-9 * size } else { 1e-6 }
    }
}
