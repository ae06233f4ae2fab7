//! The point cloud, arranged for being felt: a 16-wide tree of boxes whose leaves hold 16 points.
//!
//! **Layout.** Points are put in kd order by splits at powers of two of leaves, so that every leaf
//! but the last is full and the tree needs no pointers: node `n` of a level has the children
//! `16 n … 16 n + 15` of the next. A level is a list of [`Boxes`], 16 boxes side by side.
//!
//! **Numbers.** Boxes are `f32` relative to the cloud's origin, points `f32` relative to the centre
//! of their leaf's box, both in units of `scale`, a power of two near the part's size. The stored
//! point *is* `origin + scale · (centre + offset)`, and a query takes it so, unrounded; it differs
//! from the given one by at most 2^-24 of its leaf's size and 2^-53 of the part's. So a part far from the world's origin,
//! tiny or huge loses nothing. (A leaf spans what its 16 points span: a few points far from all
//! others make a large leaf, and move by 2^-24 of that.) What the descent reads of a point are
//! 12 bytes and its share of the boxes, 1.6 bytes.

mod build;
mod candidates;
mod change;
mod filter;
mod traverse;

pub(crate) use candidates::Candidates;
pub(crate) use filter::filter;
pub(crate) use traverse::Traversal;

use crate::bvh::{Boxes, Frame, PoseTransform, WIDTH};
use crate::cloud::{Cloud, Cover};
use bytemuck::{Pod, Zeroable};
use nalgebra::{Point3, Vector3};

/// 16 points by their offset from the centre of the leaf's box; what is not there is NaN.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Leaf {
    pub(crate) offset: [[f32; WIDTH]; 3],
}

/// What a part has at 16 points: its normal and their weight, as a part of the tree's.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Skin {
    pub(crate) normal: [[f32; WIDTH]; 3],
    pub(crate) weight: [f32; WIDTH],
}

/// A cloud in its tree.
#[derive(Clone, Debug)]
pub struct Tree {
    pub(crate) frame: Frame,
    /// From the root's children down to the leaves' boxes.
    pub(crate) levels: Vec<Vec<Boxes>>,
    pub(crate) leaves: Vec<Leaf>,
    /// The largest half extent of a leaf's box.
    pub(crate) leaf_size: f32,
    /// Of each leaf.
    pub(crate) skins: Vec<Skin>,
    /// The largest weight; the others are parts of it.
    pub(crate) weight: f64,
    /// Of each point, in the tree's order.
    pub(crate) triangles: Vec<u32>,
    pub(crate) cover: Option<Cover>,
    /// How many points were taken away.
    pub(crate) gone: usize,
}

impl Tree {
    /// The tree of a cloud.
    pub fn new(cloud: &Cloud) -> Tree {
        build::build(cloud)
    }

    /// Multiplies every length.
    pub(crate) fn scale_by(&mut self, factor: f64) {
        self.frame.origin *= factor;
        self.frame.scale *= factor;
        self.weight *= factor * factor;
        self.cover = self.cover.map(|cover| Cover { radius: factor * cover.radius, ..cover });
    }

    /// How many nodes and leaves there are.
    pub(crate) fn nodes(&self) -> usize {
        self.levels.iter().map(|level| level.len()).sum::<usize>() + self.leaves.len()
    }

    /// How many points there are, of those that were not taken away.
    pub fn len(&self) -> usize {
        self.places() - self.gone
    }

    /// How many places there are, those of points that were taken away as well.
    pub fn places(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there is none: a [`Cloud`] always has some, but all may have been cut away.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How far the surface gets from the points that were given; `None` where that is not known.
    pub fn cover(&self) -> Option<Cover> {
        self.cover
    }

    /// A point as it is stored, by its place in the tree's order, rounded to the world's `f64`;
    /// queries work with the unrounded one. NaN if it was taken away.
    pub fn point(&self, index: usize) -> Point3<f64> {
        let [centre, offset] = self.stored(index);
        Point3::from(std::array::from_fn(|axis| {
            self.frame.origin[axis]
                + (self.frame.scale * centre[axis] + self.frame.scale * offset[axis])
        }))
    }

    /// The centre of a point's leaf from the origin, and the point from there, in the tree's unit.
    pub(crate) fn stored(&self, index: usize) -> [[f64; 3]; 2] {
        let (leaf, lane) = (index / WIDTH, index % WIDTH);
        let offset = &self.leaves[leaf].offset;
        [self.centre(leaf), std::array::from_fn(|axis| f64::from(offset[axis][lane]))]
    }

    /// The centre of a leaf's box from the origin, in the tree's unit.
    #[inline(always)]
    pub(crate) fn centre(&self, leaf: usize) -> [f64; 3] {
        let (boxes, lane) = (&self.levels[self.levels.len() - 1][leaf / WIDTH], leaf % WIDTH);
        std::array::from_fn(|axis| f64::from(boxes.centre[axis][lane]))
    }

    /// A point's outward normal, as it is stored: each part within 2^-24 of the given one.
    pub fn normal(&self, index: usize) -> [f64; 3] {
        let normal = &self.skins[index / WIDTH].normal;
        std::array::from_fn(|axis| f64::from(normal[axis][index % WIDTH]))
    }

    /// A point's share of the surface, as it is stored: within 2^-24 of the largest.
    pub fn weight(&self, index: usize) -> f64 {
        self.weight * f64::from(self.skins[index / WIDTH].weight[index % WIDTH])
    }

    /// The triangle that a point lies on.
    pub fn triangle(&self, index: usize) -> u32 {
        self.triangles[index]
    }

    /// A point from the tip in the part's frame, by its place in the tree.
    pub(crate) fn relative_to_tip(&self, view: &PoseTransform, index: usize) -> Vector3<f64> {
        let [centre, offset] = self.stored(index);
        let base = view.leaf_from_tip(centre);
        Vector3::from_fn(|axis, _| base[axis] + view.scale * offset[axis])
    }
}
