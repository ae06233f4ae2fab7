//! Proofs about a tool, on the expressions that are emitted. The depth of a profile is proved by its partition (`profile`). Regions
//! by hand are proved by interval branch and bound over the domain; identities of polynomials decide where a box cannot
//! distinguish 0 from nearly 0. Boxes also give the ranges and angles of both.
//!
//! A *claim* is a leaf of the emitted tree that a box may have points of, with the signs that the tests on
//! the path to it demand. A *point box* is so small that it is not divided further. `docs/proofs.md` has the
//! other terms and the mathematics.

use crate::diagnostic::{CheckKind, Diagnostic, FormattedNumber, Statement};
use crate::expr::interval::{Cell, Interval, ZERO};
use crate::lint::deep_on_surface;
use crate::model::{DirectionSource, Model, Region};
use crate::plan::PlannedTool;
use crate::source::Span;
use meridian::Meridian;
use std::f64::consts::PI;

mod borders;
mod cover;
mod depths;
mod direction;
mod distances;
mod existence;
mod meridian;
mod profile;
mod range;
mod root;
mod rounding;
mod slope;
mod survey;
mod witness;

/// At points where three or more regions meet, depths are proved to agree to this part of the tool's size,
/// and inside a region depth is at most this far below 0: see [`Certificate::tolerance`]. The actual
/// disagreement is also included in the slack.
const TOLERANCE: f64 = 1e-6;

/// The size of boxes, relative to the tool's size, in which the proof looks for points with different depths.
const SMALL_BOX_FRACTION: f64 = 1.0 / 1024.0;

/// The relative tolerance within which both bounds must be 1 for depth to count as the distance, see
/// [`Certificate::is_exact`]. `c` of a distance is lowered by a tenth of it ([`slope::SLOPE_MARGIN`]).
const EXACT_TOLERANCE: f64 = 1e-8;

/// The number of boxes that a proof may use.
const MAX_BOXES: usize = 35_000;

/// A bound of the rounding of an angle that is shown, a few units in the last place.
const ANGLE_ROUNDING: f64 = 1e-6;

/// The facts proved about a tool.
#[derive(Clone, Debug)]
pub struct Certificate {
    /// The facts about each region.
    pub regions: Vec<RegionFacts>,
    /// The facts about each pair of neighbours and, for regions by hand, each curve that separates them.
    pub borders: Vec<Border>,
    /// The boxes where a proof did not finish.
    pub undecided: Vec<OpenProof>,
    /// The largest change of depth at points where several regions meet, and the largest amount by which it
    /// is below 0 inside, in the file's unit.
    pub tolerance: f64,
    /// The number of boxes examined.
    pub examined_boxes: usize,
    /// The least slope of the depth toward the surface.
    min_slope: f64,
    /// The slack of all bounds, in the file's unit: `c · distance - slack ≤ depth ≤ L · distance + slack`,
    /// and depth changes by at most L times the length of a path plus the slack. It includes jumps of depth
    /// at points where regions meet that no curve joins. For a profile it is the greatest difference of depth
    /// from the distance. A value below 2^-95 of the tool's size counts as 0, since constants have 256 bits.
    pub slack: f64,
}

/// The facts proved about a region.
#[derive(Clone, Debug)]
pub struct RegionFacts {
    /// The region's share of the section's area, or of a solid's volume. It is estimated, not proved.
    pub share: f64,
    /// The range of depths, in the file's unit.
    pub depth: Interval,
    /// The range of the length of the depth's gradient.
    pub gradient_length: Interval,
    /// A point of a box in which that length has no bound, in the tool's frame, if there is such a box.
    pub steep_at: Option<[f64; 3]>,
    /// True if the depth is the distance to a line, a circle or a point, or the least of several.
    pub is_distance: bool,
    /// The range of magnitudes.
    pub magnitude: Interval,
    /// The range of niceness, before values below 0 are replaced by 0.
    pub niceness: Interval,
    /// True if niceness nowhere grows with depth, according to the product of both gradients, within 1e-9 of
    /// the product of their lengths. The tolerance is needed because a file's constants have few digits.
    pub niceness_never_rises: bool,
    /// The angle between the direction and the steepest descent of depth, in radians, if it is known
    /// anywhere.
    pub direction_error: Option<Interval>,
    /// The largest angle that is certain at a point, in radians, and that point in the tool's frame. Present
    /// only where the direction is not that of steepest descent.
    pub oblique_witness: Option<(f64, [f64; 3])>,
    /// The largest rate at which niceness rises with depth at the points examined, per unit of depth, and
    /// that point in the tool's frame.
    pub rising_witness: Option<(f64, [f64; 3])>,
    /// The boxes where the direction vanishes; there it is along z.
    pub singular_cells: Vec<Cell>,
    /// True if the direction is perpendicular to an axis that the region touches, so that it turns there by
    /// up to half a turn.
    pub turns_on_axis: bool,
    /// A bound of the difference between the computed depth and the exact value of its expression, in the
    /// file's unit.
    pub rounding_error: f64,
}

impl RegionFacts {
    const NONE: RegionFacts = RegionFacts {
        share: 0.0,
        depth: ZERO,
        gradient_length: ZERO,
        steep_at: None,
        is_distance: false,
        magnitude: ZERO,
        niceness: ZERO,
        niceness_never_rises: true,
        direction_error: None,
        oblique_witness: None,
        rising_witness: None,
        singular_cells: Vec::new(),
        turns_on_axis: false,
        rounding_error: 0.0,
    };
}

/// A point of the tool's frame, and the depths on the two sides of a border there.
pub type JumpPoint = ([f64; 3], [f64; 2]);

/// The facts proved about two neighbours, or about a region and the outside.
#[derive(Clone, Debug)]
pub struct Border {
    /// A region and its neighbour, `None` for the outside.
    pub sides: (usize, Option<usize>),
    /// The difference of their depths on it, 0 if they agree exactly. The depth of the outside is 0.
    pub depth_jump: Interval,
    /// The difference of their magnitudes on it.
    pub magnitude_jump: Interval,
    /// The angle between their directions, in radians.
    pub direction_angle: Interval,
    /// The same angle where they meet on the surface, if they do.
    pub direction_angle_on_surface: Option<Interval>,
    /// The depths at which they meet.
    pub depth: Interval,
    /// A point of the tool's frame where depth jumps, with both depths, if one was found.
    pub jump_point: Option<JumpPoint>,
}

/// A box where a proof did not finish, and the statement to be proved.
#[derive(Clone, Debug)]
pub struct OpenProof {
    /// The box, in the tool's frame.
    pub cell: Cell,
    /// The statement.
    pub statement: Statement,
}

impl Border {
    /// Adds the facts of another border between the same two owners.
    pub fn merge(&mut self, other: &Border) {
        self.depth_jump = self.depth_jump.hull(other.depth_jump);
        self.magnitude_jump = self.magnitude_jump.hull(other.magnitude_jump);
        self.direction_angle = self.direction_angle.hull(other.direction_angle);
        self.direction_angle_on_surface =
            match (self.direction_angle_on_surface, other.direction_angle_on_surface) {
                (Some(a), Some(b)) => Some(a.hull(b)),
                (is_one, other) => is_one.or(other),
            };
        self.depth = self.depth.hull(other.depth);
        self.jump_point = self.jump_point.or(other.jump_point);
    }

    /// Returns whether depths agree exactly on the border. Otherwise it is a point where other regions lie
    /// between the two.
    pub fn has_equal_depths(&self) -> bool {
        self.depth_jump.high == 0.0
    }
}

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

    /// Returns whether depth is continuous and 0 on the surface, within [`Certificate::tolerance`].
    pub fn is_continuous(&self) -> bool {
        self.undecided.is_empty()
            && self.borders.iter().all(|border| border.depth_jump.high <= self.tolerance)
    }

    /// Returns `L`, if it is proved: depth is at most `L` times the distance to the surface, and changes by
    /// at most `L` times the length of a path, up to the [slack](Certificate::slack).
    pub fn lipschitz(&self) -> Option<f64> {
        let steepest =
            self.regions.iter().map(|region| region.gradient_length.high).fold(0.0, f64::max);
        // The slopes bound the changes within regions only; a jump would be a change along a path of no length.
        (self.is_continuous() && steepest.is_finite()).then_some(steepest)
    }

    /// Returns `c`, if it is proved: depth is at least `c` times the distance to the surface, up to the
    /// [slack](Certificate::slack).
    pub fn lower_slope(&self) -> Option<f64> {
        (self.is_continuous() && self.min_slope > 0.0).then_some(self.min_slope)
    }

    /// Returns whether depth is proved to be the distance to the surface, to a part in 10^8 and up to the
    /// [slack](Certificate::slack).
    pub fn is_exact(&self) -> bool {
        let bounds = [self.lipschitz(), self.lower_slope()];
        bounds.iter().all(|b| b.is_some_and(|b| (b - 1.0).abs() < EXACT_TOLERANCE))
    }
}

impl Certificate {
    /// Returns all diagnostics: errors with a counterexample, warnings with a point or a box.
    pub fn diagnostics(&self, tool: &PlannedTool) -> Vec<Diagnostic> {
        let mut diagnostics = self.certain_diagnostics(tool);
        let factor = Bounds::of(tool).0.lipschitz;
        diagnostics.extend(self.undecided_diagnostics(tool, factor));
        diagnostics
    }

    /// Returns the diagnostics that rest on single points, which more boxes would not change.
    fn certain_diagnostics(&self, tool: &PlannedTool) -> Vec<Diagnostic> {
        let model = &tool.model;
        let mut diagnostics: Vec<Diagnostic> = Vec::new();
        // One diagnostic per pair of regions, and one per region next to the outside.
        for diagnostic in self.borders.iter().filter_map(|border| jump(model, border)) {
            let is_known = diagnostics.iter().any(|other| {
                other.span == diagnostic.span && other.secondary == diagnostic.secondary
            });
            if !is_known {
                diagnostics.push(diagnostic);
            }
        }
        let facts = || model.regions.iter().zip(&self.regions);
        let oblique =
            facts().filter(|(region, _)| region.source != DirectionSource::Oblique).filter_map(
                |(region, facts)| Some((region.raw_direction.1, (region, facts.oblique_witness?))),
            );
        for (region, (angle, point)) in largest_by_span(oblique) {
            diagnostics.push(oblique_direction(region, angle, model.format_point(point)));
        }
        let rises =
            facts().filter(|(region, _)| !region.allow_rising).filter_map(|(region, facts)| {
                Some((region.law_spans.niceness, (region, facts.rising_witness?)))
            });
        for (region, (rate, point)) in largest_by_span(rises) {
            let kind = CheckKind::RisingNiceness {
                region: region.name.clone(),
                location: model.format_point(point),
                rate: FormattedNumber(rate),
                unit: model.unit.symbol(),
            };
            diagnostics.push(Diagnostic::new(region.law_spans.niceness, kind));
        }
        diagnostics
    }

    /// Returns the diagnostics of proofs that did not finish, which more boxes might finish, and of depths whose
    /// steepness has no bound. `factor` is the Lipschitz constant that a build proves.
    fn undecided_diagnostics(&self, tool: &PlannedTool, factor: Option<f64>) -> Vec<Diagnostic> {
        let model = &tool.model;
        if model.is_exact() {
            let kind = CheckKind::DepthNotProvedExact;
            let diagnostic = (!self.is_exact()).then(|| Diagnostic::new(model.name_span, kind));
            return diagnostic.into_iter().collect();
        }
        let mut diagnostics = Vec::new();
        let mut undecided = |span, statement, location, more| {
            let (factor, location) = (factor.map(FormattedNumber), model.format_point(location));
            let kind = CheckKind::Undecided { statement, location, more, factor };
            diagnostics.push(Diagnostic::new(span, kind));
        };
        let steep = model.regions.iter().zip(&self.regions);
        let steep = steep.filter_map(|(region, facts)| Some((region, facts.steep_at?))).next();
        if let Some(open_proof) = self.undecided.first() {
            let (statement, more) = (open_proof.statement.clone(), self.undecided.len() - 1);
            undecided(model.name_span, statement, open_proof.cell.middle(), more);
        } else if let Some((region, point)) = steep {
            let statement = Statement::BoundedSteepness(region.name.clone());
            undecided(region.law_spans.depth, statement, point, 0);
        }
        diagnostics
    }
}

/// Returns the error for a border with a point where depth jumps.
fn jump(model: &Model, border: &Border) -> Option<Diagnostic> {
    let (point, [own, other]) = border.jump_point?;
    let (region, neighbour) = border.sides;
    let region = &model.regions[region];
    let location = model.format_point(point);
    Some(match neighbour.map(|neighbour| &model.regions[neighbour]) {
        None => deep_on_surface(region, own, location),
        Some(neighbour) => {
            let kind = CheckKind::DiscontinuousDepth {
                depth: FormattedNumber(own),
                other_depth: FormattedNumber(other),
                location,
                region: region.name.clone(),
                other_region: neighbour.name.clone(),
            };
            Diagnostic::new(region.law_spans.depth, kind)
                .with_label(neighbour.law_spans.depth, "other depth")
        }
    })
}

/// A value at a point of a region.
type Fact<'t> = (&'t Region, (f64, [f64; 3]));

/// Returns the largest fact at each location of the text, since several regions may share a law or come from
/// one region.
fn largest_by_span<'t>(
    facts: impl Iterator<Item = (Span, Fact<'t>)>,
) -> impl Iterator<Item = Fact<'t>> {
    let mut largest: Vec<(Span, Fact<'t>)> = Vec::new();
    for (span, fact) in facts {
        match largest.iter_mut().find(|(known, _)| *known == span) {
            Some((_, known)) if known.1.0 >= fact.1.0 => {}
            Some((_, known)) => *known = fact,
            None => largest.push((span, fact)),
        }
    }
    largest.into_iter().map(|(_, fact)| fact)
}

/// Returns the warning for a direction that is certainly not that of steepest descent.
fn oblique_direction(region: &Region, angle: f64, location: String) -> Diagnostic {
    let kind = CheckKind::ObliqueDirection {
        region: region.name.clone(),
        degrees: FormattedNumber(angle.to_degrees()),
        inward: angle > PI - ANGLE_ROUNDING,
        derived: region.source == DirectionSource::Derived,
        location,
    };
    Diagnostic::new(region.raw_direction.1, kind)
}
