//! Who a tool is, or a solid: to the runtime a solid is a tool without an axis.

use crate::unit::Unit;
use std::borrow::Cow;

/// A tool's name, parts and reach.
#[derive(Clone, Debug, PartialEq)]
pub struct Card {
    /// The type's name.
    pub name: Cow<'static, str>,
    /// What it is, for people; may be empty.
    pub title: Cow<'static, str>,
    /// The unit of the file, and of every length on this card.
    pub unit: Unit,
    /// The surfaces.
    pub surfaces: Cow<'static, [Surface]>,
    /// The regions, as listed in the file.
    pub regions: Cow<'static, [Region]>,
    /// The solid's largest radius along the axis, proved: no point of it lies outside all slabs.
    pub envelope: Cow<'static, [Slab]>,
    /// Whether it has an axis.
    pub shape: Shape,
    /// The profile: the boundary of its half of the section, from the axis at its lower end
    /// counter-clockwise to the axis, each piece beginning where the last one ends. Empty without
    /// one.
    pub outline: Cow<'static, [Piece]>,
    /// What is proved of depth.
    pub depth: Depth,
    /// A number that changes whenever anything that the tool answers may: its versions are told apart by it.
    /// How its file is laid out, comments, its name and its title do not matter. A tool of one's own that is
    /// kept account of by its digest has to change it likewise.
    pub digest: u64,
}

/// What is proved of a tool's depth and the distance to its surface, of all points inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depth {
    /// `c`: no depth is less than `c` times the distance to the surface. `None` if none is proved.
    pub least: Option<f64>,
    /// `L`: no depth is more than `L` times the distance to the surface, and depth changes by no more
    /// than `L` times the way. `None` if none is proved.
    pub lipschitz: Option<f64>,
    /// A bound of the error of a computed depth against the true one of its region, in the file's unit.
    pub rounding: f64,
}

/// Whether a tool looks the same however it is turned about z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// It does: a `tool`, a solid of revolution. A tip and an axis place it.
    Revolved,
    /// It does not: a `solid`. Only a full pose places it (see [`crate::Pose::is_full`]).
    Solid {
        /// From where to where it reaches along x and along y, proved.
        across: [[f64; 2]; 2],
    },
}

impl Card {
    /// A card from constants, as generated code writes it.
    pub const fn new(
        [name, title]: [&'static str; 2],
        unit: Unit,
        (surfaces, regions): (&'static [Surface], &'static [Region]),
        (shape, envelope): (Shape, &'static [Slab]),
        (outline, depth): (&'static [Piece], Depth),
        digest: u64,
    ) -> Card {
        Card {
            name: Cow::Borrowed(name),
            title: Cow::Borrowed(title),
            unit,
            surfaces: Cow::Borrowed(surfaces),
            regions: Cow::Borrowed(regions),
            envelope: Cow::Borrowed(envelope),
            shape,
            outline: Cow::Borrowed(outline),
            depth,
            digest,
        }
    }

    /// Whether depth and clearance are true distances; farther out than 48 sizes of the tool
    /// clearance is a lower bound. Without a profile, depth is what the file says and clearance a
    /// lower bound everywhere.
    pub fn exact(&self) -> bool {
        !self.outline.is_empty()
    }

    /// The surface that a region belongs to.
    pub fn surface_of(&self, region: usize) -> &Surface {
        &self.surfaces[self.regions[region].surface]
    }

    /// The lowest and highest z that the tool may reach.
    pub fn reach(&self) -> [f64; 2] {
        self.envelope.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], slab| {
            [low.min(slab.low), high.max(slab.high)]
        })
    }

    /// A radius about the axis that the tool does not exceed.
    pub fn radius(&self) -> f64 {
        self.envelope.iter().fold(0.0, |radius, slab| radius.max(slab.radius))
    }

    /// How far the tool reaches from its tip along the axis or from the axis, whichever is more.
    pub(crate) fn size(&self) -> f64 {
        let reach = self.envelope.iter().map(|s| s.low.abs().max(s.high.abs()).max(s.radius));
        reach.fold(0.0, f64::max)
    }
}

/// A surface of a tool.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Its name: `ball`, `flute`, `shank`, …
    pub name: Cow<'static, str>,
    /// Whether it cuts.
    pub cutting: bool,
}

impl Surface {
    /// A surface from constants.
    pub const fn new(name: &'static str, cutting: bool) -> Surface {
        Surface { name: Cow::Borrowed(name), cutting }
    }
}

/// A region of a tool's inside.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Its name.
    pub name: Cow<'static, str>,
    /// Its surface's place in the card's list.
    pub surface: usize,
}

impl Region {
    /// A region from constants.
    pub const fn new(name: &'static str, surface: usize) -> Region {
        Region { name: Cow::Borrowed(name), surface }
    }
}

/// A piece of a profile, a line or an arc, as `[d, z]`; the material lies on its left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Its beginning.
    pub from: [f64; 2],
    /// Its end.
    pub to: [f64; 2],
    /// The circle that an arc is of.
    pub circle: Option<Circle>,
    /// Its surface's place in the card's list.
    pub surface: usize,
}

/// The circle of an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Its centre, as `[d, z]`.
    pub centre: [f64; 2],
    /// Its radius.
    pub radius: f64,
    /// Whether the material is inside: then it is walked counter-clockwise.
    pub convex: bool,
}

impl Piece {
    /// A line.
    pub const fn line(from: [f64; 2], to: [f64; 2], surface: usize) -> Piece {
        Piece { from, to, circle: None, surface }
    }

    /// An arc.
    pub const fn arc(ends: [[f64; 2]; 2], circle: Circle, surface: usize) -> Piece {
        Piece { from: ends[0], to: ends[1], circle: Some(circle), surface }
    }
}

/// A stretch of the axis and the largest radius of the solid there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
    /// The radius.
    pub radius: f64,
}

impl Slab {
    /// A slab.
    pub const fn new(low: f64, high: f64, radius: f64) -> Slab {
        Slab { low, high, radius }
    }
}
