//! A bounding volume hierarchy without pointers: a 16-wide tree of boxes over points or triangles.
//!
//! Items are put in kd order by splits at powers of two of leaves, so that every leaf but the last is full: node `n` of a
//! level has the children `16 n … 16 n + 15` of the next. A level is a list of [`Boxes`], 16 boxes side by side, in `f32`
//! relative to a [`Frame`].

mod build;
mod lanes;
mod view;

pub(crate) use build::{Bounds, Item, around, levels, order, outward};
pub(crate) use lanes::{LANE, Triple, extent, load, seen};
pub(crate) use view::{PoseTransform, QuerySetup, Reach, SLABS};

use bytemuck::{Pod, Zeroable};
use nalgebra::Point3;

/// Children of a node, points of a leaf.
pub(crate) const WIDTH: usize = 16;

/// 16 boxes by centre and half extent; what is not there has NaN for a centre.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Boxes {
    pub(crate) centre: [[f32; WIDTH]; 3],
    pub(crate) half: [[f32; WIDTH]; 3],
}

/// The origin and the unit of length that boxes are stored in.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    /// The middle of the part.
    pub(crate) origin: Point3<f64>,
    /// The unit of length; a power of two, if the part is in the unit that it came in.
    pub(crate) scale: f64,
    /// The largest extent of the whole.
    pub(crate) size: f32,
}
