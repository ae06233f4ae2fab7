//! A tool whose every name, dimension and rule is settled: what the compiler reasons about.
//!
//! All expressions are in the tool's frame (tip at the origin, +z toward the spindle; a solid's is
//! its file's) and the file's unit. A point belongs to the first region whose formula holds;
//! elsewhere it is outside.

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
