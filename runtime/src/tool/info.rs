//! The description of a tool, or of a solid: to the runtime a solid is a tool without an axis.

use crate::id::SurfaceId;
use crate::interval::Interval;
use crate::unit::Unit;
use std::borrow::Cow;
use touchoff_plane::{Circle, Segment};

/// A tool's name, surfaces, regions and extent, and the bounds that are proved of its depth.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolInfo {
    /// The type's name.
    pub name: Cow<'static, str>,
    /// A description for people; may be empty.
    pub title: Cow<'static, str>,
    /// The unit of the file, and of every length in this description.
    pub unit: Unit,
    /// The surfaces.
    pub surfaces: Cow<'static, [Surface]>,
    /// The regions, as listed in the file.
    pub regions: Cow<'static, [Region]>,
    /// The solid's largest radius along the axis. Proved: no point of the solid lies outside all slabs.
    pub envelope: Cow<'static, [EnvelopeSlab]>,
    /// The symmetry: with or without an axis.
    pub symmetry: Symmetry,
    /// The profile: the boundary of the half section, counter-clockwise from the axis at its lower end back to the
    /// axis. Each segment begins where the previous one ends. Empty for a tool without a profile.
    pub outline: Cow<'static, [ProfileSegment]>,
    /// The proved bounds of depth.
    pub depth: DepthBounds,
    /// A number that changes whenever any result of the tool may change; it tells versions of the tool apart. The
    /// file's layout and comments and the tool's name and title do not affect it. A user's own implementation has to
    /// change its digest likewise if anything keeps records by it.
    pub digest: u64,
}

/// Bounds of a tool's depth against the distance to its surface, for all points inside: by construction for a profile,
/// which `touchoff check` proves, and proved for regions by hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthBounds {
    /// `c`: depth is at least `c` times the distance to the surface. `None` if no such bound is proved.
    pub lower_slope: Option<f64>,
    /// `L`: depth is at most `L` times the distance to the surface, and a Lipschitz constant of the depth. `None` if no
    /// such bound is proved.
    pub lipschitz: Option<f64>,
    /// Upper bound on the error of a computed depth against the exact depth of its region, in the file's unit. With a
    /// Lipschitz constant it includes what that constant neglects.
    pub rounding: f64,
}

/// The symmetry of a tool about z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Symmetry {
    /// A `tool`, a solid of revolution. A tip and an axis determine its placement.
    Revolved,
    /// A `solid`, without an axis of symmetry. Only a pose with a spin places it (see [`crate::Pose::has_spin`]).
    Solid {
        /// The proved extent along x and along y.
        extent: [Interval; 2],
    },
}

impl ToolInfo {
    /// Returns whether depth and clearance are true distances, which holds for a tool with a profile. Without one, depth is
    /// whatever the file defines, and clearance is a lower bound.
    pub fn is_exact(&self) -> bool {
        !self.outline.is_empty()
    }

    /// Returns the surface that a region belongs to.
    ///
    /// # Panics
    ///
    /// If there is no such region.
    pub fn surface_of(&self, region: usize) -> &Surface {
        self.surface(self.regions[region].surface)
    }

    /// Returns a surface.
    ///
    /// # Panics
    /// If the tool has no such surface.
    pub fn surface(&self, id: SurfaceId) -> &Surface {
        &self.surfaces[id.0]
    }

    /// Returns the surface of a name, if the tool has one.
    pub fn surface_named(&self, name: &str) -> Option<SurfaceId> {
        self.surfaces.iter().position(|surface| surface.name == name).map(SurfaceId)
    }

    /// Returns the lowest and highest z that the tool may reach.
    pub fn reach(&self) -> Interval {
        let none = Interval::new(f64::INFINITY, f64::NEG_INFINITY);
        self.envelope.iter().fold(none, |Interval { low, high }, slab| {
            Interval::new(low.min(slab.low), high.max(slab.high))
        })
    }

    /// Returns an upper bound on the distance of the tool's points from its tip, with lengths in `unit`: it bounds the
    /// travel of the points when the tool turns about the tip.
    pub fn max_distance_from_tip(&self, unit: Unit) -> f64 {
        let Interval { low, high } = self.reach();
        low.abs().max(high.abs()).hypot(self.radius()) * self.unit.factor_to(unit)
    }

    /// Returns an upper bound on the tool's radius about the axis.
    pub fn radius(&self) -> f64 {
        self.envelope.iter().fold(0.0, |radius, slab| radius.max(slab.radius))
    }

    /// Returns the tool's size: its reach from the tip along the axis or its radius about the axis, whichever is
    /// larger.
    pub fn size(&self) -> f64 {
        let reach = self.envelope.iter().map(|s| s.low.abs().max(s.high.abs()).max(s.radius));
        reach.fold(0.0, f64::max)
    }
}

/// A surface of a tool.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// The name: `ball`, `flute`, `shank`, …
    pub name: Cow<'static, str>,
    /// True if the surface cuts.
    pub cutting: bool,
}

impl Surface {
    /// Returns a surface made of constants.
    pub const fn new(name: &'static str, cutting: bool) -> Surface {
        Surface { name: Cow::Borrowed(name), cutting }
    }
}

/// A region of a tool's interior.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// The name.
    pub name: Cow<'static, str>,
    /// The surface that the region belongs to.
    pub surface: SurfaceId,
}

impl Region {
    /// Returns a region made of constants.
    pub const fn new(name: &'static str, surface: usize) -> Region {
        Region { name: Cow::Borrowed(name), surface: SurfaceId(surface) }
    }
}

/// A segment of a profile, a line or an arc, in coordinates `[d, z]`; the material lies on its left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfileSegment {
    /// The start point.
    pub from: [f64; 2],
    /// The end point.
    pub to: [f64; 2],
    /// The circle of an arc; `None` for a line.
    pub circle: Option<Circle>,
    /// The surface that the segment belongs to.
    pub surface: SurfaceId,
}

impl ProfileSegment {
    /// Returns a line segment.
    pub const fn line(from: [f64; 2], to: [f64; 2], surface: usize) -> ProfileSegment {
        ProfileSegment { from, to, circle: None, surface: SurfaceId(surface) }
    }

    /// Returns an arc.
    pub const fn arc(ends: [[f64; 2]; 2], circle: Circle, surface: usize) -> ProfileSegment {
        ProfileSegment {
            from: ends[0],
            to: ends[1],
            circle: Some(circle),
            surface: SurfaceId(surface),
        }
    }

    /// Returns it as geometry: its distance, nearest point and tangents.
    pub fn geometry(&self) -> Segment {
        Segment::new([self.from, self.to], self.circle, self.surface.0)
    }
}

/// An interval of the axis, with the largest radius of the solid there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvelopeSlab {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
    /// The radius.
    pub radius: f64,
}

impl EnvelopeSlab {
    /// Returns a slab.
    pub const fn new(low: f64, high: f64, radius: f64) -> EnvelopeSlab {
        EnvelopeSlab { low, high, radius }
    }
}
