//! A bounding volume hierarchy of a point cloud: a 16-wide tree of boxes whose leaves hold 16 points.
//!
//! **Layout.** Points are put in kd order by splits at powers of two of leaves, so that every leaf but the last is full
//! and the tree needs no pointers: node `n` of a level has the children `16 n … 16 n + 15` of the next. A level is a
//! list of [`Boxes`], 16 boxes side by side.
//!
//! **Numbers.** Boxes are `f32` relative to the cloud's origin. Points are `f32` relative to the centre of their leaf's
//! box. Both are in units of `scale`, a power of two near the part's size. The stored point *is*
//! `origin + scale · (centre + offset)`, and queries take it as such, unrounded. It differs from the given point by at
//! most 2^-24 of its leaf's size and 2^-53 of the part's. A part that is tiny, huge or far from the world's origin
//! therefore loses no accuracy. A leaf spans its 16 points: a few points far from all others make a large leaf, and
//! move by 2^-24 of its size. The descent reads 12 bytes of a point and its share of the boxes, 1.6 bytes.

mod build;
mod filter;
mod orientation;
mod traverse;

pub(crate) use build::TreePoint;
pub(crate) use filter::{Candidates, filter};
pub(crate) use orientation::Enclosure;
pub(crate) use traverse::{Traversal, TraversalInput};

use crate::bvh::{Boxes, Frame, PoseTransform, WIDTH};
use crate::cloud::{Cloud, CoveringRadius};
use crate::id::TriangleId;
use bytemuck::{Pod, Zeroable};
use nalgebra::{Point3, Vector3};

/// Offsets of 16 points from the centre of the leaf's box. A slot without a point is NaN.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Leaf {
    pub(crate) offset: [[f32; WIDTH]; 3],
}

/// Normals and weights of a leaf's 16 points. A weight is relative to the tree's largest weight.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LeafAttributes {
    normal: [[f32; WIDTH]; 3],
    pub(crate) weight: [f32; WIDTH],
}

/// A bounding volume hierarchy of a point cloud.
#[derive(Clone, Debug)]
pub struct PointBvh {
    pub(crate) frame: Frame,
    /// Boxes of all levels, from the root's children down to the leaves.
    pub(crate) levels: Vec<Vec<Boxes>>,
    pub(crate) leaves: Vec<Leaf>,
    /// The largest half extent of a leaf's box, in the tree's unit.
    pub(crate) leaf_size: f32,
    /// Attributes of each leaf.
    pub(crate) attributes: Vec<LeafAttributes>,
    /// The largest weight; the leaves' weights are fractions of it.
    pub(crate) weight: f64,
    /// Triangle id of each point, in the tree's order.
    pub(crate) triangles: Vec<u32>,
    pub(crate) covering_radius: Option<CoveringRadius>,
    /// Number of points that were removed.
    pub(crate) removed: usize,
}

impl PointBvh {
    /// Builds the tree of a cloud.
    pub fn new(cloud: &Cloud) -> PointBvh {
        build::build(cloud)
    }

    /// Multiplies every length by a factor.
    pub(crate) fn scale_by(&mut self, factor: f64) {
        self.frame.origin *= factor;
        self.frame.scale *= factor;
        // Weights are areas.
        self.weight *= factor * factor;
        self.covering_radius = self.covering_radius.map(|covering_radius| CoveringRadius {
            radius: factor * covering_radius.radius,
            ..covering_radius
        });
    }

    /// Returns the number of nodes and leaves.
    pub(crate) fn nodes(&self) -> usize {
        self.levels.iter().map(|level| level.len()).sum::<usize>() + self.leaves.len()
    }

    /// Returns the number of points, without those that were removed.
    pub fn len(&self) -> usize {
        self.slots() - self.removed
    }

    /// Returns the number of slots for points, including those of removed points.
    pub fn slots(&self) -> usize {
        self.triangles.len()
    }

    /// Returns whether there are no points. A [`Cloud`] always has some, but all may have been removed.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the largest distance of the surface from the given points; `None` if it is not known.
    pub fn covering_radius(&self) -> Option<CoveringRadius> {
        self.covering_radius
    }

    /// Returns an upper bound on the distance of a stored point from the given one, in each coordinate.
    pub fn rounding(&self) -> f64 {
        let frame = &self.frame;
        let [leaf, size] = [self.leaf_size, frame.size].map(|half| frame.scale * f64::from(half));
        // Per coordinate: the difference from the tree's origin, which is taken first, and an offset in `f32` from the leaf's
        // centre.
        let difference = 2.0 * f64::EPSILON * (frame.origin.coords.amax() + size);
        difference + (leaf / 2f64.powi(24) + 2.0 * f64::EPSILON * size)
    }

    /// Returns whether a slot has a point that was not removed.
    pub fn has_point(&self, slot: usize) -> bool {
        // A slot without a point is NaN.
        !self.leaves[slot / WIDTH].offset[0][slot % WIDTH].is_nan()
    }

    /// Returns a point as it is stored, by its index in the tree's order, rounded to `f64` in the world's frame.
    /// Queries use the unrounded point. The result is NaN if the point was removed.
    pub fn point(&self, index: usize) -> Point3<f64> {
        let [centre, offset] = self.stored(index);
        Point3::from(std::array::from_fn(|axis| {
            self.frame.origin[axis]
                + (self.frame.scale * centre[axis] + self.frame.scale * offset[axis])
        }))
    }

    /// Returns the centre of a point's leaf relative to the origin, and the point relative to that centre, in the
    /// tree's unit.
    fn stored(&self, index: usize) -> [[f64; 3]; 2] {
        let (leaf, lane) = (index / WIDTH, index % WIDTH);
        let offset = &self.leaves[leaf].offset;
        [self.centre(leaf), std::array::from_fn(|axis| f64::from(offset[axis][lane]))]
    }

    /// Returns the centre of a leaf's box relative to the origin, in the tree's unit.
    #[inline(always)]
    fn centre(&self, leaf: usize) -> [f64; 3] {
        let (boxes, lane) = (&self.levels[self.levels.len() - 1][leaf / WIDTH], leaf % WIDTH);
        std::array::from_fn(|axis| f64::from(boxes.centre[axis][lane]))
    }

    /// Returns a point's outward normal as it is stored: each component is within 2^-24 of the given one.
    pub fn normal(&self, index: usize) -> [f64; 3] {
        let normal = &self.attributes[index / WIDTH].normal;
        std::array::from_fn(|axis| f64::from(normal[axis][index % WIDTH]))
    }

    /// Returns a point's share of the surface as it is stored: within 2^-24 of the largest weight.
    pub fn weight(&self, index: usize) -> f64 {
        self.weight * f64::from(self.attributes[index / WIDTH].weight[index % WIDTH])
    }

    /// Returns the id of the triangle on which a point lies.
    pub fn triangle(&self, index: usize) -> TriangleId {
        TriangleId(self.triangles[index])
    }

    /// Returns a point relative to the tip, in the part's frame, by its index in the tree.
    pub(crate) fn relative_to_tip(&self, view: &PoseTransform, index: usize) -> Vector3<f64> {
        let [centre, offset] = self.stored(index);
        let base = view.leaf_from_tip(centre);
        Vector3::from_fn(|axis, _| base[axis] + view.scale * offset[axis])
    }
}
