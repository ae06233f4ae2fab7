//! Tools as oracles whose depth is fast enough for millions of evaluations.

use touchoff_tests::oracle::{self, Nearest, Oracle, restated};

pub(crate) const PROFILES: [&str; 6] =
    ["Fig73Exact", "BullNose", "Lollipop", "TSlot", "BallEr16", "TaperedBall"];

/// Tools with regions written by hand, solids, and tools whose profile overhangs.
pub(crate) const FIELDS: [&str; 7] =
    ["Fig73", "Cylinder", "UnitSphere", "Block", "LBracket", "BoringBar", "FaceMill"];

/// A Lipschitz bound for all fields in the list; the thesis's tool attains √5.
const FIELD_LIPSCHITZ_BOUND: f64 = 2.24;

/// A tool whose depth is evaluated many times.
pub(crate) enum DepthOracle {
    Profile(Nearest),
    Field(Box<dyn Oracle>),
}

impl DepthOracle {
    pub(crate) fn of(name: &str) -> DepthOracle {
        match restated::of(name) {
            Some(tool) if !FIELDS.contains(&name) => DepthOracle::Profile(Nearest::new(&tool)),
            _ => DepthOracle::Field(oracle::of(name)),
        }
    }

    pub(crate) fn oracle(&self) -> &dyn Oracle {
        match self {
            DepthOracle::Profile(nearest) => nearest,
            DepthOracle::Field(field) => &**field,
        }
    }

    /// Returns the depth of a point; it is negative outside.
    pub(crate) fn depth(&self, p: [f64; 3]) -> f64 {
        match self {
            DepthOracle::Profile(nearest) => nearest.profile().depth(&[p[0].hypot(p[1]), p[2]]),
            DepthOracle::Field(field) => field
                .evaluate(p)
                .map_or_else(|| -field.signed_distance(p), |evaluation| evaluation.depth),
        }
    }

    pub(crate) fn lipschitz_bound(&self) -> f64 {
        match self {
            DepthOracle::Profile(..) => 1.0,
            DepthOracle::Field(_) => FIELD_LIPSCHITZ_BOUND,
        }
    }

    /// Returns the smallest gap to validate, as a share of the tool's size. The certifier resolves a field only to a
    /// thousandth.
    pub(crate) fn min_gap(&self) -> f64 {
        match self {
            DepthOracle::Profile(..) => 1e-7,
            DepthOracle::Field(_) => 1e-2,
        }
    }

    /// Returns the tolerance for the certifier, in the part's unit. That of a field is a millionth of the unit,
    /// whatever the tool's size.
    pub(crate) fn tolerance(&self, size: f64) -> f64 {
        match self {
            DepthOracle::Profile(..) => 1e-9 * size,
            DepthOracle::Field(_) => 1e-6,
        }
    }

    /// Returns how near samples should come to the lower bound, in the part's unit.
    pub(crate) fn reach_margin(&self, size: f64) -> f64 {
        match self {
            DepthOracle::Profile(..) => 1e-9 * size,
            DepthOracle::Field(_) => 1e-6 * size,
        }
    }
}
