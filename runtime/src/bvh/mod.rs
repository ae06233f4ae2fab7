//! A bounding volume hierarchy without pointers: a 16-wide tree of boxes over points or triangles.
//!
//! Items are sorted in kd order. Splits fall at powers of two of leaves, so that every leaf but the last is full,
//! and node `n` of a level has the children `16 n … 16 n + 15` of the next. A level is a list of [`Boxes`], 16
//! boxes side by side, in `f32` relative to a [`Frame`].

mod build;
mod lanes;
mod view;

pub(crate) use build::{Bounds, BuildItem, around, levels, order, outward};
pub(crate) use lanes::{LANE_INDICES, LaneVector, extent, load, transform};
pub(crate) use view::{PoseTransform, QuerySetup, ReachBounds, SLABS};

use bytemuck::{Pod, Zeroable};
use nalgebra::Point3;

/// The number of children of a node and of items in a leaf.
pub(crate) const WIDTH: usize = 16;

/// Sixteen boxes, each as a centre and half extents. Absent boxes have a NaN centre.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Boxes {
    pub(crate) centre: [[f32; WIDTH]; 3],
    pub(crate) half: [[f32; WIDTH]; 3],
}

/// The origin and the unit of length in which boxes are stored.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    /// The middle of the part's bounding box, in the part's frame and unit.
    pub(crate) origin: Point3<f64>,
    /// The unit of length in the part's unit. It is a power of two unless the part was rescaled to another unit.
    pub(crate) scale: f64,
    /// The largest extent of the part in this unit, rounded up.
    pub(crate) size: f32,
}
