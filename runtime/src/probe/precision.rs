//! How exactly a tool feels: in which formats points are ruled out, and those that are left felt.

use super::Once;
use crate::bvh::Rough;
use crate::tool::Depth;
use crate::tree::Carried;

/// How exactly a tool feels a part; a type, given to [`Probe::precision`](crate::Probe::precision).
///
/// Points are stored as they are whatever it is, and sums are taken in `f64`.
pub trait Precision: Once {
    /// What boxes and points are held to the tool's envelope in, with a margin for what it rounds.
    #[doc(hidden)]
    type Rough: Rough;
    /// What points that are left are carried to the tool's frame and felt in.
    #[doc(hidden)]
    type Number: Carried;

    /// How far rounding takes each coordinate of a point inside a tool that reaches that far from its
    /// tip, of leaves and a part with those half extents, all in one unit.
    #[doc(hidden)]
    fn carried(size: f64, _leaf: f64, part: f64) -> f64 {
        in_double(size, part)
    }
    /// How far it takes a depth, in the unit of the tool.
    #[doc(hidden)]
    fn felt(depth: &Depth) -> f64 {
        depth.rounding
    }
}

/// All in `f64`. The same points are inside as with [`Filtered`], each with the same bits: nothing that is
/// ruled out in `f32` there could be inside. Only the order of a sum may be another, and so its rounding.
#[derive(Clone, Copy, Debug)]
pub struct Double;

/// Ruled out in `f32`, with a margin for what that rounds; felt in `f64`. What probes do.
#[derive(Clone, Copy, Debug)]
pub struct Filtered;

/// All in `f32` but for the sums, for the last factor of speed: a point within
/// [`Probe::error`](crate::Probe::error) of the surface, some 1e-6 of the tool's size, may be on the
/// wrong side, and so may one beside a splitting curve. Only for tools that are known by their type.
#[derive(Clone, Copy, Debug)]
pub struct Single;

/// A point inside is no farther from the tip than the tool is large, so neither is the origin but for the
/// part's size: two sums, then three products and a change of unit.
fn in_double(size: f64, part: f64) -> f64 {
    f64::EPSILON / 2.0 * (2.0 * (size + 4.0 * part) + 8.0 * size)
}

impl Precision for Double {
    type Rough = f64;
    type Number = f64;
}

impl Precision for Filtered {
    type Rough = f32;
    type Number = f64;
}

impl Precision for Single {
    type Rough = f32;
    type Number = f32;

    /// A leaf's centre is carried in `f64` and rounded; each part of an offset from there is rounded four
    /// times (its row, its product, two sums), and the point once. A point inside is no farther than the
    /// tool is large, its leaf's centre by no more than the leaf is.
    fn carried(size: f64, leaf: f64, part: f64) -> f64 {
        let half = f64::from(f32::EPSILON) / 2.0;
        let across = 3f64.sqrt() * leaf;
        in_double(size, part) + half * (1.0 + 1e-6) * (2.0 * size + 5.0 * across)
    }

    fn felt(depth: &Depth) -> f64 {
        depth.rounding_single
    }
}
