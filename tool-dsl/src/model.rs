//! The intermediate representation: a tool or a solid whose names, dimensions and rules are settled.
//!
//! Each pass takes the result of the one before by value, and none changes it:
//!
//! ```text
//! Source ──syntax──▶ Ast ──resolve──▶ Model ──bound, look, plan──▶ PlannedTool ──prove──▶ CheckedTool
//! ```
//!
//! A [`Model`] has no text in it. Spans are kept for diagnostics alone; no pass after `resolve` reads a source.
//!
//! # What a model means
//!
//! All statements are about real arithmetic. Expressions mean what [`crate::expr`] says: functions of a point in the
//! tool's frame and the file's unit of length.
//!
//! - **Domain.** The points of a `tool` are those of its half plane `y = 0, x ≥ 0`, where `x` is the distance `d` from the
//!   axis; space is swept from it by rotation. The points of a `solid` are those of space. Conditions, depths,
//!   magnitudes, nicenesses and courses of a tool read `D`, `Q` and `Z` only. [`Outputs`] alone are functions of space in
//!   both, and alone read [`Coord::Length`](crate::expr::Coord::Length).
//! - **Sides.** A [`Curve`] `c` divides the domain by its sign. An atom is `c ≤ 0` or `c ≥ 0`, both closed, so a curve
//!   belongs to both of its sides; a strict atom is `c < 0` or `c > 0`. A [`Formula`] is "and" and "or" over atoms. Where
//!   a curve is undefined, no atom of it holds.
//! - **Ownership.** A point belongs to the first of [`Model::regions`] whose [`Region::inside`] holds. The solid is the
//!   set of the points that belong to a region.
//! - **Depth.** [`Outputs::depth`] of the owner is `max(0, depth)`. With a `Section` it is the distance to the solid's
//!   surface; of regions by hand it is what the file says, and `prove` bounds it by the distance.
//! - **Direction.** [`Outputs::direction`] is a unit vector. Where the course has no length, and on the axis of a tool
//!   where the radial unit vector does not exist, it is a fixed one: `+x` stands for the radial direction.
//! - **Magnitude.** If the file gives none, it is the depth in the part's unit; else it is the file's own number and does
//!   not change with the unit. [`Outputs::gradient`] is its gradient by the position in the part's unit.
//! - **Niceness** is a number without a unit, `max(0, niceness)`.
//! - **Outside.** With a section, `Section::outside` has a distance for each part of the outside up to 64 sizes; farther
//!   out, and without a section, `plan` takes the distance to a box or a cylinder about the solid, a lower bound.
//!
//! # What each pass establishes
//!
//! A pass relies on everything that stands above it. *By type* means that no other value can be written.
//!
//! | pass | establishes | by |
//! |---|---|---|
//! | `syntax::parse` | items in the order of the text; at most 300 operations lie between a value and a coordinate; lists and texts are bounded | the grammar, `syntax::limits`, `syntax::refuse` |
//! | `resolve` | each name has one definition above its use, or in a file that is mounted; no definition depends on itself | `lower::Lowering`, `scope`, `cycle` |
//! | | sums, minima and comparisons have operands of one dimension; a depth and a course are lengths, a niceness has no dimension | `dimension::Dimension::alike` |
//! | | lengths are in one unit, `z` in the tool's frame: the tip is 0, the spindle is toward `+z` | `lower` for expressions, `Frame::to_tool` for constants |
//! | | indices of curves and surfaces are in range; `regions` is not empty | by construction: the lists only grow |
//! | | each region has a depth, a direction, a niceness and a magnitude | `region::regions`, `law::Laws` |
//! | | an outline runs counter-clockwise from the axis to the axis, on the left of no other piece and off the axis between its ends | `regionalise::check` in doubles; proved later, by `prove::jordan` |
//! | | the cells of `inner` and `outer` cover their sides, and each feature is the nearest in its cell | by the algorithm of `regionalise::slices`, in doubles; asked at points by `plan::section`, proved later by `prove` |
//! | `checked` (`finite`) | constants that code needs are finite doubles | `checked::finite` |
//! | `bound` | [`Extent`](crate::bound::Extent): the solid lies in a box and a cylinder; it is bounded, and it has points. [`Slab`](crate::bound::Slab): its largest radius between two heights | interval branch and bound; a section's pieces in closed form |
//! | `look` | nothing. It refutes: owners that overlap, regions that own nothing, depths below 0 or above 0 on the surface, undefined values, a tip elsewhere, each with the point | samples |
//! | `plan` | `Plan::owner` gives each point the owner that the list gives it | `plan::empty` proves which sides need no test; a section's cells are cut exactly; tests that are left out cannot hold in real arithmetic |
//! | | `Plan::inside` holds where `owner` is some region | by construction: it is the same tree with other leaves |
//! | | `Plan::outside` is the distance, or a lower bound of it, wherever `inside` does not hold | as for `owner` |
//! | | trees have at most 20,000 tests | `plan::LARGEST` |
//! | `prove` | [`Bounds`](crate::prove::Bounds) of the depth by the distance: of a section 1 and 1 by construction, which `touchoff check` proves; of regions by hand what a few thousand boxes prove | `docs/proofs.md` |
//! | | no depth jumps at a point that was found | enclosures of both depths there |
//!
//! `plan` adds curves behind those of the file, to a model that it was given whole: `0..n` mean what they meant before.
//!
//! What a [`CheckedTool`](crate::CheckedTool) promises its readers: emission, interpretation and drawing cannot fail; no
//! error was found; and where something is only believed (a proof that did not come to an end), its bounds say so by being
//! absent. `checked` alone can build one, and gives no mutable access to it.

use crate::domain::Domain;
use crate::expr::{Graph, Id};
use crate::formula::{Curve, CurveIndex, Formula};
use crate::geometry::outline::Segment;
use crate::number::Number;
use crate::regionalise::Partition;
use crate::source::Span;

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
    /// The unit of a word.
    pub fn from_word(word: &str) -> Option<Unit> {
        [Unit::Millimetre, Unit::Inch, Unit::Metre].into_iter().find(|unit| unit.word() == word)
    }

    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Unit::Millimetre => "mm",
            Unit::Inch => "inch",
            Unit::Metre => "m",
        }
    }

    /// Its length in tenths of a millimetre, a whole number for all.
    fn tenths(self) -> i64 {
        match self {
            Unit::Millimetre => 10,
            Unit::Inch => 254,
            Unit::Metre => 10_000,
        }
    }

    /// The exact factor that turns a length in `self` into one in `other`.
    pub fn to(self, other: Unit) -> Number {
        &Number::int(self.tenths()) / &Number::int(other.tenths())
    }
}

/// A tool or a solid, resolved.
#[derive(Clone, Debug)]
pub struct Model {
    /// What the expressions are functions of.
    pub domain: Domain,
    /// The type's name.
    pub name: String,
    /// Where it stands.
    pub name_span: Span,
    /// What it is, for people.
    pub title: Option<String>,
    /// The file's unit.
    pub unit: Unit,
    /// All expressions.
    pub graph: Graph,
    /// Where the file's coordinates lie in the tool's frame.
    pub frame: Frame,
    /// The splitting curves: every curve on whose side a region depends.
    pub curves: Vec<Curve>,
    /// The surfaces.
    pub surfaces: Vec<Surface>,
    /// The regions, as listed.
    pub regions: Vec<Region>,
    /// The curves that `bsp` wants tried first.
    pub first: Vec<CurveIndex>,
    /// What is known of a tool with a profile.
    pub(crate) section: Option<Section>,
}

/// A profile and the exact partition of both its sides by nearest features.
#[derive(Clone, Debug)]
pub(crate) struct Section {
    /// The pieces, counter-clockwise in the tool's frame.
    pub(crate) outline: Vec<Segment>,
    /// The inside; its parts are the regions, where nothing divides them once more.
    pub(crate) inner: Partition,
    /// The outside, as far as 64 sizes; its parts are those of `outside`.
    pub(crate) outer: Partition,
    /// The features that are nearest outside.
    pub(crate) outside: Vec<Outside>,
    /// What divides the inside once more.
    pub(crate) over: Option<Over>,
}

/// Conditions over the inside's parts: regions by hand, or the fans of smoothed corners.
#[derive(Clone, Debug)]
pub(crate) struct Over {
    /// A point belongs to the first that holds.
    pub(crate) conditions: Vec<Formula>,
    /// The part and the condition of each region.
    pub(crate) regions: Vec<(usize, usize)>,
    /// The distances from the pieces of the outline with rounded corners, which conditions compare.
    pub(crate) distances: Vec<Id>,
}

impl Model {
    /// A point of the tool's frame as the file has it.
    pub fn shown(&self, [x, y, z]: [f64; 3]) -> String {
        self.domain.shown([x, y, self.frame.to_file(z)])
    }

    /// The depths of the regions in their order, and behind them the distances of [`Over`] that no region has.
    pub(crate) fn depths(&self) -> Vec<Id> {
        let mut depths: Vec<Id> = self.regions.iter().map(|region| region.depth).collect();
        let over = self.section.iter().filter_map(|section| section.over.as_ref());
        for distance in over.flat_map(|over| &over.distances) {
            if !depths.contains(distance) {
                depths.push(*distance);
            }
        }
        depths
    }

    /// Whether depth and clearance are true distances.
    pub fn is_exact(&self) -> bool {
        self.section.is_some()
    }

    /// The pieces of the profile, in order, in doubles; none without one.
    pub fn outline(&self) -> impl Iterator<Item = Piece> + '_ {
        let segments = self.section.iter().flat_map(|section| &section.outline);
        segments.map(|segment| Piece {
            ends: segment.ends(),
            circle: segment.round(),
            surface: segment.surface,
        })
    }
}

/// A piece of a profile, as `[d, z]` in the tool's frame and the file's unit.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// Where it begins and ends.
    pub ends: [[f64; 2]; 2],
    /// Centre, radius and whether the material is inside, of an arc.
    pub circle: Option<([f64; 2], f64, bool)>,
    /// The surface it belongs to.
    pub surface: usize,
}

/// A part of the outside and the distance from the tool there.
#[derive(Clone, Debug)]
pub struct Outside {
    /// Its points, of those outside the solid.
    pub beside: Formula,
    /// The distance to the tool in the file's unit.
    pub clearance: Id,
}

/// `z_tool = z_file - tip`, or `tip - z_file` where the spindle lies toward smaller z.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The tip's z in the file.
    pub tip: Number,
    /// Whether the spindle lies toward the file's -z.
    pub down: bool,
    /// Where the tip is said, or else the tool's name.
    pub tip_span: Span,
}

impl Frame {
    /// The tool's z as the file's.
    pub fn to_file(&self, z: f64) -> f64 {
        if self.down { self.tip.to_f64() - z } else { self.tip.to_f64() + z }
    }

    /// The file's z, as an expression in the tool's.
    pub fn file_z(&self, graph: &mut Graph, z: Id) -> Id {
        let tip = graph.number(self.tip.clone());
        if self.down { graph.sub(tip, z) } else { graph.add(z, tip) }
    }

    /// A constant z of the file in the tool's frame.
    pub fn to_tool(&self, z: &Number) -> Number {
        if self.down { &self.tip - z } else { z - &self.tip }
    }
}

/// Where a region's quantities are said: by itself, by a law, or else where it stands.
#[derive(Clone, Copy, Debug)]
pub struct Said {
    /// The depth.
    pub depth: Span,
    /// The magnitude.
    pub magnitude: Span,
    /// The niceness.
    pub niceness: Span,
}

/// Where a region's direction comes from, and with it who answers for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DirectionSource {
    /// It is the depth's own: its slope, or the shortest way to the profile.
    Derived,
    /// The file writes it, or a magnitude whose slope it is.
    Written,
    /// It may leave the steepest way out: `allow oblique`, or `regions smooth`.
    Oblique,
}

/// A surface of the tool.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Its name.
    pub name: String,
    /// Whether it cuts.
    pub cutting: bool,
    /// Where it was first named.
    pub span: Span,
}

/// A region of the tool's inside, and what is felt there.
#[derive(Clone, Debug)]
pub struct Region {
    /// Its name.
    pub name: String,
    /// Where it is named.
    pub span: Span,
    /// The surface it belongs to.
    pub surface: usize,
    /// The points it has, but for those of regions listed earlier.
    pub inside: Formula,
    /// How deep a point lies, as the file says it.
    pub depth: Id,
    /// Where its quantities are said.
    pub said: Said,
    /// How hard it is pushed, as the file says it.
    pub magnitude: Id,
    /// The direction to the surface in the domain, a unit vector.
    pub direction: [Id; 3],
    /// The direction before it was made a unit vector, and where it is said.
    pub course: ([Id; 3], Span),
    /// Where the direction comes from.
    pub source: DirectionSource,
    /// How good a contact is, as the file says it.
    pub niceness: Id,
    /// `allow rising`: niceness may rise with depth.
    pub rising: bool,
    /// What the evaluators compute.
    pub outputs: Outputs,
}

/// The expressions that evaluators compute in a region, at a point x, y, z of the tool's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Outputs {
    /// Penetration depth in the file's unit, never below 0.
    pub depth: Id,
    /// Magnitude. If it is the depth, in the part's unit; else a number of the file's own.
    pub magnitude: Id,
    /// The magnitude's gradient by the point's position in the part's unit.
    pub gradient: [Id; 3],
    /// Unit vector to the nearest surface.
    pub direction: [Id; 3],
    /// Niceness, never below 0.
    pub niceness: Id,
}

impl Outputs {
    /// The expressions in the order of a tape's outputs behind the owner.
    pub(crate) fn roots(&self) -> Vec<Id> {
        let mut roots = vec![self.depth, self.magnitude, self.niceness];
        roots.extend(self.direction);
        roots.extend(self.gradient);
        roots
    }
}
