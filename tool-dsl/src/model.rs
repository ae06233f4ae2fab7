//! The intermediate representation: a tool or a solid whose names, dimensions and rules are settled.
//!
//! Each pass takes the result of the previous one by value, and none modifies it:
//!
//! ```text
//! Source ──syntax──▶ Ast ──resolve──▶ Model ──bound, lint, plan──▶ PlannedTool ──prove──▶ CheckedTool
//! ```
//!
//! A [`Model`] contains no source text. Spans are kept for diagnostics only; no pass after `resolve` reads a
//! source.
//!
//! # Semantics of a model
//!
//! All statements are about real arithmetic. Expressions have the meaning given in [`crate::expr`]: functions
//! of a point in the tool's frame and in the file's unit of length.
//!
//! - **Domain.** The points of a `tool` are those of its half plane `y = 0, x ≥ 0`, where `x` is the distance
//!   `d` from the axis; rotating it about the axis sweeps out space. The points of a `solid` are those of
//!   space. Conditions, depths, magnitudes, nicenesses and courses of a tool read `D`, `Q` and `Z` only. Only
//!   [`RegionOutputs`] are functions of space in both domains, and only they read
//!   [`Coord::Length`](crate::expr::Coord::Length).
//! - **Sides.** A [`Curve`] `c` divides the domain by its sign. An atom is `c ≤ 0` or `c ≥ 0`, both closed,
//!   so a curve belongs to both of its sides. A [`Formula`] combines atoms by "and" and "or". Where a curve is
//!   undefined, none of its atoms holds.
//! - **Ownership.** A point belongs to the first of [`Model::regions`] whose [`Region::condition`] holds. With a
//!   `Profile` it belongs to the nearest feature of the profile and, if that is divided further, to the first
//!   condition that holds there or to the nearest segment of the rounded outline: see `regionalise::owners`. The solid is the set of points that belong to a
//!   region.
//! - **Depth.** [`RegionOutputs::depth`] of the owner is `max(0, depth)`. With a `Profile` it is the distance
//!   to the solid's surface. For regions written by hand it is the file's expression, and `prove` bounds it
//!   by the distance.
//! - **Direction.** [`RegionOutputs::direction`] is a unit vector. It is the normalised *raw direction*, the vector
//!   that the file writes or that is derived. Where the raw direction has zero length, and on the axis of a tool,
//!   where the radial unit vector does not exist, it is a fixed one: `+x` replaces the radial direction.
//! - **Magnitude.** If the file gives none, the magnitude is the depth in the part's unit. Otherwise it is
//!   the file's own number and does not change with the unit. [`RegionOutputs::gradient`] is its gradient
//!   with respect to the position in the part's unit.
//! - **Niceness** is a number without a unit, `max(0, niceness)`.
//!
//! # Guarantees of each pass
//!
//! A pass relies on everything above it in this table. `validate` checks in debug builds what a look at the data decides: expressions
//! and their coordinates, indices, outlines, trees.
//!
//! | pass | establishes | by |
//! |---|---|---|
//! | `syntax::parse` | items in the order of the text; at most 300 operations lie between a value and a coordinate; lists and texts are bounded | the grammar, `syntax::limits`, `syntax::refuse` |
//! | `resolve` | each name has one definition above its use, or in a mounted file; no definition depends on itself | `lower::Lowering`, `scope`, `cycle` |
//! | | sums, minima and comparisons have operands of one dimension; a depth and a raw direction are lengths, a niceness has no dimension | `dimension::Dimension::alike` |
//! | | lengths are in one unit, `z` in the tool's frame: the tip is at 0, the spindle is toward `+z` | `lower` for expressions, `Frame::to_tool` for constants |
//! | | indices of curves and surfaces are in range; `regions` is not empty | by construction: the lists only grow |
//! | | each region has a depth, a direction, a niceness and a magnitude | `region::regions`, `law::Laws` |
//! | | an outline runs counter-clockwise from the axis to the axis, touches itself nowhere else, and meets the axis only at its ends | `regionalise::check` in doubles |
//! | | the polygons of `inner` cover the cell of each feature, within rounding | `regionalise::cover`, in doubles |
//! | `checked` (`finite`) | constants that code needs are finite doubles | `checked::finite` |
//! | `bound` | [`Extent`](crate::bound::Extent): the solid lies in a box and a cylinder, is bounded, and is not empty. [`EnvelopeSlab`](crate::bound::EnvelopeSlab): its largest radius between two heights | interval branch and bound; a profile's segments in closed form |
//! | `lint` | nothing. It refutes overlapping owners, regions that own nothing, depths below 0 or above 0 on the surface, undefined values, and a misplaced tip, each with a counterexample | samples |
//! | `plan` | `PlannedTool::tree` gives each point the owner that the rule of the text gives it | by signs: `plan::signs` proves which sides need no test; of a profile: `plan::profile` follows every piece to the leaves |
//! | | trees have at most 20,000 tests | `plan::MAX_TESTS` |
//! | `prove` | [`Bounds`](crate::prove::Bounds) of the depth by the distance: for a profile 1 and 1 by construction, which `touchoff check` proves; for regions by hand the bounds that a few thousand boxes prove | `docs/proofs.md` |
//! | | depth jumps at no point that was found | enclosures of both depths there |
//!
//! `plan` receives a complete model and appends curves to those of the file; indices `0..n` keep their
//! meaning.
//!
//! A [`CheckedTool`](crate::CheckedTool) guarantees that emission, interpretation and drawing cannot fail,
//! and that no error was found. A property that is only believed, because its proof did not finish, has no
//! bounds. Only `checked` constructs a checked tool, and it gives no mutable access to it.

use crate::domain::Domain;
use crate::expr::{Graph, Id};
use crate::formula::{Curve, CurveIndex, Formula};
use crate::geometry::function::{self, CurveFunction};
use crate::geometry::outline::Segment;
use crate::number::Number;
use crate::regionalise::Partition;
use crate::regionalise::overlay::{ConditionedPart, Division};
use crate::regionalise::pieces::{Piece, SampledPiece, Separations};
use crate::source::Span;
use std::rc::Rc;

/// A unit of length that a file may state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// `mm`
    Millimetre,
    /// `inch`
    Inch,
    /// `m`
    Metre,
}

impl Unit {
    /// Returns the unit with the given symbol, if there is one.
    pub fn from_symbol(symbol: &str) -> Option<Unit> {
        [Unit::Millimetre, Unit::Inch, Unit::Metre].into_iter().find(|unit| unit.symbol() == symbol)
    }

    /// Returns its symbol.
    pub fn symbol(self) -> &'static str {
        match self {
            Unit::Millimetre => "mm",
            Unit::Inch => "inch",
            Unit::Metre => "m",
        }
    }

    /// Returns its length in tenths of a millimetre, an integer for every unit.
    fn tenths(self) -> i64 {
        match self {
            Unit::Millimetre => 10,
            Unit::Inch => 254,
            Unit::Metre => 10_000,
        }
    }

    /// Returns the exact factor that converts a length in `self` to one in `other`.
    pub fn factor_to(self, other: Unit) -> Number {
        &Number::int(self.tenths()) / &Number::int(other.tenths())
    }
}

/// A resolved tool or solid.
#[derive(Clone, Debug)]
pub struct Model {
    /// The space that the expressions are functions on.
    pub domain: Domain,
    /// The name of the generated Rust type.
    pub name: String,
    /// The location of the name.
    pub name_span: Span,
    /// The description for people, if there is one.
    pub title: Option<String>,
    /// The file's unit.
    pub unit: Unit,
    /// All expressions.
    pub graph: Graph,
    /// The position of the file's coordinates in the tool's frame.
    pub frame: Frame,
    /// The splitting curves: every curve whose sign a region depends on, and those that a plan may split a profile by.
    pub curves: Vec<Curve>,
    /// The surfaces.
    pub surfaces: Vec<Surface>,
    /// The regions, in the order of the file.
    pub regions: Vec<Region>,
    /// The curves that the `bsp` item asks to be tried first.
    pub first_curves: Vec<CurveIndex>,
    /// The profile and its partition; `None` for a tool whose regions are written by hand.
    pub(crate) profile: Option<Profile>,
}

/// A profile and the partition of its inside by nearest features.
#[derive(Clone, Debug)]
pub(crate) struct Profile {
    /// The segments, counter-clockwise in the tool's frame.
    pub(crate) outline: Vec<Segment>,
    /// The partition of the inside. Its parts are the regions, unless `over` divides them further.
    pub(crate) inner: Partition,
    /// The tests that tell the parts of the inside apart.
    pub(crate) separations: Separations,
    /// The further division of the inside, if there is one.
    pub(crate) over: Option<Over>,
}

/// The further division of the inside's parts: by regions by hand, or by the fans of smoothed corners.
#[derive(Clone, Debug)]
pub(crate) struct Over {
    /// What divides them.
    pub(crate) division: Division,
    /// The part and the condition of each region.
    pub(crate) regions: Vec<ConditionedPart>,
}

impl Profile {
    /// Returns the curves of a model as functions, and the size of the section.
    pub(crate) fn functions<'g>(
        &self,
        graph: &'g Graph,
        curves: &[Curve],
    ) -> (Vec<CurveFunction<'g>>, f64) {
        let (mut shapes, size) = function::functions(graph, curves, &self.outline);
        self.inner.set_distances(&self.separations, &mut shapes);
        if let Some(over) = &self.over {
            over.division.set_distances(&mut shapes);
        }
        (shapes, size)
    }

    /// Returns pieces that cover the inside and, after these, the outside.
    pub(crate) fn pieces(&self, shapes: &[CurveFunction<'_>]) -> Vec<Rc<Piece>> {
        let inside = self.inner.inner_pieces(&self.separations, shapes);
        let outside = self.inner.outer_pieces(&self.separations);
        inside.into_iter().chain(outside).map(Rc::new).collect()
    }

    /// Returns the feature from which a region has its depth.
    pub(crate) fn feature_of(&self, region: usize) -> usize {
        self.over.as_ref().map_or(region, |over| over.regions[region].part)
    }
}

impl Model {
    /// Returns the pieces of a profile's section with sample points; none for regions by hand.
    pub(crate) fn sampled_pieces(&self) -> Vec<SampledPiece> {
        let Some(profile) = &self.profile else { return Vec::new() };
        let (shapes, _) = profile.functions(&self.graph, &self.curves);
        let section = profile.inner.section();
        let sampled = |piece: Rc<Piece>| {
            let points = section.sample_points(&piece);
            SampledPiece { piece, points }
        };
        profile.pieces(&shapes).into_iter().map(sampled).collect()
    }

    /// Formats a point of the tool's frame in the file's coordinates.
    pub fn format_point(&self, [x, y, z]: [f64; 3]) -> String {
        self.domain.format_point([x, y, self.frame.to_file(z)])
    }

    /// Returns the expressions of the curves, in their order.
    pub(crate) fn curve_values(&self) -> impl Iterator<Item = Id> {
        self.curves.iter().map(|curve| curve.value)
    }

    /// Returns all expressions that are evaluated at a point: those of the regions, then the curves.
    pub(crate) fn roots(&self) -> impl Iterator<Item = Id> {
        let outputs = self.regions.iter().flat_map(|region| {
            let evaluation = [region.depth, region.magnitude, region.niceness];
            evaluation.into_iter().chain(region.direction).chain(region.raw_direction.0)
        });
        outputs.chain(self.curve_values())
    }

    /// Returns whether depth is an exact distance.
    pub fn is_exact(&self) -> bool {
        self.profile.is_some()
    }

    /// Returns the segments of the profile, in order, in the tool's frame and the file's unit; none without a profile.
    pub fn outline(&self) -> impl Iterator<Item = touchoff_plane::Segment> + '_ {
        let segments = self.profile.iter().flat_map(|profile| &profile.outline);
        segments.map(|segment| segment.geometry)
    }
}

/// The transform from the file's z to the tool's: `z_tool = z_file - tip`, or `tip - z_file` if the spindle
/// lies toward smaller z.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The tip's z in the file.
    pub tip: Number,
    /// True if the spindle lies toward the file's -z.
    pub spindle_down: bool,
    /// The location of the `tip` item, or of the tool's name if there is none.
    pub tip_span: Span,
}

impl Frame {
    /// Converts a z of the tool's frame to the file's.
    pub fn to_file(&self, z: f64) -> f64 {
        if self.spindle_down { self.tip.to_f64() - z } else { self.tip.to_f64() + z }
    }

    /// Returns the file's z as an expression in the tool's z.
    pub fn file_z(&self, graph: &mut Graph, z: Id) -> Id {
        let tip = graph.number(self.tip.clone());
        if self.spindle_down { graph.sub(tip, z) } else { graph.add(z, tip) }
    }

    /// Converts a constant z of the file to the tool's frame.
    pub fn to_tool(&self, z: &Number) -> Number {
        if self.spindle_down { &self.tip - z } else { z - &self.tip }
    }
}

/// The locations that define a region's quantities: in the region itself, in a law, or else the region's own
/// location.
#[derive(Clone, Copy, Debug)]
pub struct LawSpans {
    /// The location of the depth.
    pub depth: Span,
    /// The location of the magnitude.
    pub magnitude: Span,
    /// The location of the niceness.
    pub niceness: Span,
}

/// The origin of a region's direction, which decides who is responsible for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DirectionSource {
    /// Follows from the depth: its gradient, or the shortest path to the profile.
    Derived,
    /// Written in the file, or the gradient of a magnitude written there.
    Written,
    /// Allowed to differ from the direction of steepest descent of the depth: `allow oblique`, or
    /// `regions smooth`.
    Oblique,
}

/// A surface of the tool.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Its name.
    pub name: String,
    /// True for a surface that cuts.
    pub cutting: bool,
    /// The location where it is first named.
    pub span: Span,
}

/// A region of the tool's inside, and the quantities evaluated there.
#[derive(Clone, Debug)]
pub struct Region {
    /// Its name.
    pub name: String,
    /// The location of the name.
    pub span: Span,
    /// The index of the surface it belongs to.
    pub surface: usize,
    /// The condition of its points that the file states; those of regions listed earlier are excluded by precedence. A
    /// region of a profile has, of the points that are nearest to its feature, those that satisfy it.
    pub condition: Formula,
    /// The depth, as the file writes it.
    pub depth: Id,
    /// The locations that define its quantities.
    pub law_spans: LawSpans,
    /// The magnitude of the contact, as the file writes it.
    pub magnitude: Id,
    /// The direction to the surface in the domain, a unit vector.
    pub direction: [Id; 3],
    /// The direction before normalisation, and its location.
    pub raw_direction: ([Id; 3], Span),
    /// The origin of the direction.
    pub source: DirectionSource,
    /// The quality of a contact, as the file writes it.
    pub niceness: Id,
    /// `allow rising`: niceness may rise with depth without a warning.
    pub allow_rising: bool,
    /// The expressions that the evaluators compute.
    pub outputs: RegionOutputs,
}

/// The expressions that evaluators compute in a region, at a point x, y, z of the tool's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionOutputs {
    /// The penetration depth in the file's unit, at least 0.
    pub depth: Id,
    /// The magnitude. If it is the depth, it is in the part's unit; otherwise it is a number of the file's
    /// own.
    pub magnitude: Id,
    /// The gradient of the magnitude with respect to the position in the part's unit.
    pub gradient: [Id; 3],
    /// The unit vector toward the nearest surface.
    pub direction: [Id; 3],
    /// The niceness, at least 0.
    pub niceness: Id,
}

impl RegionOutputs {
    /// Returns all expressions: depth, magnitude, niceness, direction, gradient.
    pub(crate) fn roots(&self) -> [Id; 9] {
        let [ux, uy, uz] = self.direction;
        let [gx, gy, gz] = self.gradient;
        [self.depth, self.magnitude, self.niceness, ux, uy, uz, gx, gy, gz]
    }
}
