//! Proofs about a tool, on the expressions that are emitted. The depth of a profile is proved by its partition (`profile`). Regions
//! by hand are proved by interval branch and bound over the domain; identities of polynomials decide where a box cannot
//! distinguish 0 from nearly 0. Boxes also give the ranges and angles of both.
//!
//! A *claim* is a leaf of the emitted tree that a box may have points of, with the signs that the tests on
//! the path to it demand. A *point box* is so small that it is not divided further. `docs/proofs.md` has the
//! other terms and the mathematics.

use crate::diagnostic::Diagnostic;
use crate::model::DirectionSource;
use crate::plan::PlannedTool;
use meridian::Meridian;

mod borders;
mod certificate;
mod cover;
mod depths;
mod direction;
mod distances;
mod existence;
mod meridian;
mod profile;
mod range;
mod report;
mod root;
mod rounding;
mod slope;
mod survey;
mod witness;

pub use certificate::{Border, CertainValue, Certificate, JumpPoint, OpenProof, Pair, RegionFacts};

/// At points where three or more regions meet, depths are proved to agree to this part of the tool's size,
/// and inside a region depth is at most this far below 0: see [`Certificate::tolerance`]. The actual
/// disagreement is also included in the slack.
const TOLERANCE: f64 = 1e-6;

/// The size of boxes, relative to the tool's size, in which the proof looks for points with different depths.
const SMALL_BOX_FRACTION: f64 = 1.0 / 1024.0;

/// The number of boxes that a proof may use.
const MAX_BOXES: usize = 35_000;

/// The bounds of a tool's depth that are proved during compilation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The least slope of the depth toward the surface.
    pub lower_slope: Option<f64>,
    /// The Lipschitz constant of the depth: see [`Certificate::lipschitz`].
    pub lipschitz: Option<f64>,
    /// A bound of the difference between a computed depth and one that satisfies these bounds, in the file's
    /// unit: rounding, and [`Certificate::slack`]. Rounding alone without a Lipschitz constant.
    pub rounding_error: f64,
}

impl Bounds {
    /// Returns the bounds that can be proved quickly, and diagnostics for the errors found.
    pub(crate) fn of(tool: &PlannedTool) -> (Bounds, Vec<Diagnostic>) {
        let rounding_error = rounding::bound_over_tool(tool) + tool.deviation;
        let exact = Bounds { lower_slope: Some(1.0), lipschitz: Some(1.0), rounding_error };
        let mut sources = tool.model.regions.iter().map(|region| region.source);
        // Depth and directions then follow from the construction, so no point can show an error.
        if tool.model.is_exact() && sources.all(|source| source != DirectionSource::Written) {
            return (exact, Vec::new());
        }
        if tool.model.is_exact() {
            // The plan has just been proved; only directions and nicenesses can be wrong.
            let certificate = survey::of_profile(tool, Some(tool.deviation), false);
            return (exact, certificate.certain_diagnostics(tool));
        }
        // Overlaps of regions are left to [`Certificate::prove`].
        let certificate = by_hand(tool, false);
        let mut diagnostics = certificate.certain_diagnostics(tool);
        let [lower_slope, lipschitz] = [certificate.lower_slope(), certificate.lipschitz()];
        if lipschitz.is_none() {
            // Slack without a bound would say nothing.
            diagnostics.extend(certificate.undecided_diagnostics(tool, None));
            return (Bounds { lower_slope, lipschitz, rounding_error }, diagnostics);
        }
        let rounding_error = rounding_error + certificate.slack;
        (Bounds { lower_slope, lipschitz, rounding_error }, diagnostics)
    }
}

/// Proves as much as possible about regions by hand. This includes, if `check_overlaps` is set, that no two of them overlap.
fn by_hand(tool: &PlannedTool, check_overlaps: bool) -> Certificate {
    match Meridian::of(tool) {
        Some(mut meridian) => {
            let certificate = survey::by_hand(&mut meridian.tool, check_overlaps);
            meridian.revolved(certificate, tool)
        }
        None => survey::by_hand(&mut tool.clone(), check_overlaps),
    }
}

impl Certificate {
    /// Proves as much as possible about a tool.
    pub fn prove(tool: &PlannedTool) -> Certificate {
        if tool.model.is_exact() {
            survey::of_profile(tool, profile::proved_deviation(tool), true)
        } else {
            by_hand(tool, true)
        }
    }
}
