//! What is proved about a tool: by interval branch and bound over its domain, on the expressions
//! that are emitted, and by identities of polynomials where a box cannot tell 0 from nearly 0.
//!
//! `cover` knows which regions a box can have points of, `slope` how steep expressions are there,
//! `rounding` how far computed depths err, `root` whether depths agree on a curve, `sum` which curves are differences of depths, `touch` what
//! conics that touch imply of each other, `excess` how far distances exceed one another, `tangent` how far they differ where a profile is all but
//! smooth, `jordan` whether a profile encloses the solid, `parting` what parts two regions; `survey` goes from box
//! to box, of a solid of revolution in a half plane, which `meridian` makes.

mod aim;
mod cover;
mod diagnostics;
mod excess;
mod foot;
mod jordan;
mod kink;
mod meridian;
mod parting;
mod range;
mod root;
mod rounding;
mod slope;
mod sum;
mod survey;
mod tangent;
mod touch;
mod witness;

use crate::diagnostic::{Diagnostic, Statement};
use crate::expr::interval::{Cell, Interval, ZERO};
use crate::formula::CurveIndex;
use crate::model::{DirectionSource, Region};
use crate::plan::PlannedTool;
use meridian::Meridian;

/// At points where three regions or more meet, depths are known to agree to this part of the tool's
/// size, and nowhere inside a region is depth further below 0: [`Certificate::tolerance`]. By how much they do not agree is
/// in the slack besides.
const TOLERANCE: f64 = 1e-6;

/// The boxes, as a part of the tool's size, in which it is looked where depths differ, and whether a third explains how two
/// meet.
const SMALL: f64 = 1.0 / 1024.0;

/// Where both bounds are 1 to this, depth is said to be the distance: a choice, stated by [`Certificate::is_exact`]. `c` of
/// a distance is lowered by a tenth of it ([`kink::ROUNDING`]).
const EXACT: f64 = 1e-8;

/// Boxes that a proof may take, and one while a tool is compiled.
const MANY: usize = 35_000;
const FEW: usize = 4_000;

/// What is proved about a tool.
#[derive(Clone, Debug)]
pub struct Certificate {
    /// Of each region.
    pub regions: Vec<RegionFacts>,
    /// Of each pair of neighbours and each curve that parts them.
    pub borders: Vec<Border>,
    /// Where a proof did not come to an end.
    pub undecided: Vec<Undecided>,
    /// How much depth may change at points where several regions meet, and how far below 0 it may be inside, in the file's
    /// unit.
    pub tolerance: f64,
    /// How many boxes were looked at.
    pub boxes: usize,
    /// The least slope of the depth toward the surface.
    least: f64,
    /// How much depth may jump at points where regions meet that no curve joins, in the file's unit: `c · distance -
    /// slack ≤ depth ≤ L · distance + slack`, and depth changes by no more than L times the way and the slack. Of a profile,
    /// how far feet may be beyond a piece's ends, and how far depths are from the distances to the pieces. What is less than
    /// 2^-95 of the tool's size counts as 0: constants have 256 bits.
    pub slack: f64,
}

/// What is proved about a region.
#[derive(Clone, Debug)]
pub struct RegionFacts {
    /// Its part of the section's area, of a solid's volume: counted, not proved.
    pub share: f64,
    /// The depths of its points, in the file's unit.
    pub depth: Interval,
    /// How steep the depth is: lengths of its gradient.
    pub steepness: Interval,
    /// Whether the depth is the distance to a line, a circle or a point.
    pub distance: bool,
    /// Magnitudes.
    pub magnitude: Interval,
    /// Niceness, before what is below 0 counts as 0.
    pub niceness: Interval,
    /// Whether niceness nowhere grows with depth, by its slope along that of depth, but for 1e-9 of both lengths: constants
    /// of a file have few digits.
    pub falls: bool,
    /// The angle between the direction and the steepest way down, in radians, if it is known anywhere.
    pub aside: Option<Interval>,
    /// The largest angle that is certain at a point, in radians, and the point in the tool's frame: only where the
    /// direction is not the steepest way out.
    pub oblique: Option<(f64, [f64; 3])>,
    /// By how much niceness rises for each length of depth where it rises most of the points looked at, and that point
    /// in the tool's frame.
    pub rises: Option<(f64, [f64; 3])>,
    /// Boxes where the direction vanishes; there it is along z.
    pub singular: Vec<Cell>,
    /// Whether the direction is across an axis that the region touches, and so turns there by up to a
    /// half turn.
    pub on_axis: bool,
    /// A bound of the error of the computed depth against its expression's true value, in the file's unit.
    pub rounding: f64,
}

impl RegionFacts {
    const NONE: RegionFacts = RegionFacts {
        share: 0.0,
        depth: ZERO,
        steepness: ZERO,
        distance: false,
        magnitude: ZERO,
        niceness: ZERO,
        falls: true,
        aside: None,
        oblique: None,
        rises: None,
        singular: Vec::new(),
        on_axis: false,
        rounding: 0.0,
    };
}

/// A point of the tool's frame, and the depths on the two sides of a border there.
pub type Seen = ([f64; 3], [f64; 2]);

/// What is proved about two neighbours, or about a region and the outside.
#[derive(Clone, Debug)]
pub struct Border {
    /// A region and another, `None` for the outside.
    pub between: (usize, Option<usize>),
    /// A curve that parts them.
    pub curve: CurveIndex,
    /// How far their depths differ on it, 0 if they agree exactly; outside the depth is 0.
    pub jump: Interval,
    /// How far their magnitudes differ on it at most.
    pub step: Interval,
    /// The angle between their directions, in radians.
    pub turn: Interval,
    /// The same where they meet on the surface, if they do.
    pub turn_on_surface: Option<Interval>,
    /// The depths at which they meet.
    pub depth: Interval,
    /// A point of the tool's frame where depth jumps, if one was found, and both depths there.
    pub seen: Option<Seen>,
}

/// A box where a proof did not come to an end, and what was to be proved.
#[derive(Clone, Debug)]
pub struct Undecided {
    /// The box, in the tool's frame.
    pub cell: Cell,
    /// The statement.
    pub statement: Statement,
}

impl Border {
    /// Takes up what is known of another border of the same two.
    pub fn join(&mut self, other: &Border) {
        self.jump = self.jump.hull(other.jump);
        self.step = self.step.hull(other.step);
        self.turn = self.turn.hull(other.turn);
        self.turn_on_surface = match (self.turn_on_surface, other.turn_on_surface) {
            (Some(a), Some(b)) => Some(a.hull(b)),
            (one, other) => one.or(other),
        };
        self.depth = self.depth.hull(other.depth);
        self.seen = self.seen.or(other.seen);
    }

    /// Whether this is a whole border, on which depths agree exactly, and not a point where others
    /// come between.
    pub fn is_joined(&self) -> bool {
        self.jump.high == 0.0
    }
}

/// What is proved of a tool's depth while it is compiled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// See [`Certificate::least`].
    pub least: Option<f64>,
    /// See [`Certificate::lipschitz`].
    pub lipschitz: Option<f64>,
    /// A bound of the distance of a computed depth from one for which these bounds hold, in the file's unit: rounding, and
    /// [`Certificate::slack`].
    pub rounding: f64,
}

impl Bounds {
    /// What is proved of a tool in little time, and what is wrong with it by that.
    ///
    /// The depth of a profile is the distance by construction, which [`Certificate::of`] proves once
    /// more; regions by hand are looked at in a few thousand boxes, but not for their owners, which the
    /// plan proves as it is made. So are those of a profile for which a direction is written.
    pub(crate) fn of(tool: &PlannedTool) -> (Bounds, Vec<Diagnostic>) {
        let rounding = rounding::over(tool);
        let written = |region: &Region| region.source == DirectionSource::Written;
        let exact = Bounds { least: Some(1.0), lipschitz: Some(1.0), rounding };
        if tool.model.is_exact() && !tool.model.regions.iter().any(written) {
            return (exact, Vec::new());
        }
        let proved = proved(tool, FEW, false);
        // What is undecided here may not be in more boxes.
        let diagnostics = proved.certain(tool);
        if tool.model.is_exact() {
            return (exact, diagnostics);
        }
        let [least, lipschitz] = [proved.least(), proved.lipschitz()];
        let rounding = rounding + proved.slack;
        (Bounds { least, lipschitz, rounding }, diagnostics)
    }
}

/// Proves what can be proved in so many boxes, and of regions by hand whether any has points `alone`, if that is asked for.
fn proved(tool: &PlannedTool, boxes: usize, alone: bool) -> Certificate {
    match Meridian::of(tool) {
        Some(meridian) => meridian.turned(survey::survey(&meridian.tool, boxes, alone), tool),
        None => survey::survey(tool, boxes, alone),
    }
}

impl Certificate {
    /// Proves what can be proved about a tool.
    pub fn of(tool: &PlannedTool) -> Certificate {
        proved(tool, MANY, true)
    }

    /// Whether depth is continuous and 0 on the surface, but for [`Certificate::tolerance`].
    pub fn is_continuous(&self) -> bool {
        let joined = |border: &Border| border.jump.high <= self.tolerance;
        self.undecided.is_empty() && self.borders.iter().all(joined)
    }

    /// `L`, if it is proved: no depth is more than `L` times the distance to the surface, and depth
    /// changes by no more than `L` times the way, each but for the [slack](Certificate::slack).
    pub fn lipschitz(&self) -> Option<f64> {
        let steepest = self.regions.iter().map(|region| region.steepness.high).fold(0.0, f64::max);
        (self.is_continuous() && steepest.is_finite()).then_some(steepest)
    }

    /// `c`, if it is proved: no depth is less than `c` times the distance to the surface, but for the
    /// [slack](Certificate::slack).
    pub fn least(&self) -> Option<f64> {
        (self.is_continuous() && self.least > 0.0).then_some(self.least)
    }

    /// Whether depth is proved to be the distance to the surface, to a part in 10^8 and the [slack](Certificate::slack).
    pub fn is_exact(&self) -> bool {
        let one = |bound: Option<f64>| bound.is_some_and(|b| (b - 1.0).abs() < EXACT);
        one(self.lipschitz()) && one(self.least())
    }
}
