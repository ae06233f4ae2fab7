//! Construction of the tree from a cloud. Points are removed and moved without a new tree: leaves keep their points, and
//! boxes are refitted.

use crate::bvh::{
    Bounds, BuildItem, Frame, STORED_BOX_MARGIN, WIDTH, around, levels, order, outward,
};
use crate::cloud::Cloud;
use crate::point_bvh::{Leaf, LeafAttributes, PointBvh};
use nalgebra::{Point3, Vector3};

pub(super) fn build(cloud: &Cloud) -> PointBvh {
    let frame = Frame::around(cloud.points().iter().map(|point| (*point).into()));
    let mut items: Vec<BuildItem> = cloud
        .points()
        .iter()
        .zip(0u32..)
        .map(|(point, index)| BuildItem { at: frame.inside((*point).into()), index })
        .collect();
    order(&mut items);
    let (leaves, boxes): (Vec<Leaf>, Vec<Bounds>) = items.chunks(WIDTH).map(build_leaf).unzip();
    let leaf_size = boxes.iter().map(|b| outward(b.size() / 2.0)).fold(0.0, f32::max);
    let levels = levels(boxes);
    let weight = cloud.weights().iter().fold(0.0, |max: f64, weight| max.max(*weight));
    PointBvh {
        frame,
        levels,
        leaves,
        leaf_size,
        attributes: items
            .chunks(WIDTH)
            .map(|items| leaf_attributes(items, cloud, weight))
            .collect(),
        weight,
        triangles: items.iter().map(|item| cloud.triangles()[item.index as usize].0).collect(),
        covering_radius: cloud.covering_radius(),
        removed: 0,
    }
}

/// Returns a leaf and the bounding box of its points as they are stored. Slots without a point stay NaN.
fn build_leaf(items: &[BuildItem]) -> (Leaf, Bounds) {
    // The centre is rounded to `f32` first: offsets are relative to the centre as it is stored.
    let bounds = Bounds::of(items.iter().map(|item| item.at));
    let centre: [f64; 3] = std::array::from_fn(|axis| f64::from(bounds.middle(axis) as f32));
    let mut leaf = Leaf { offset: [[f32::NAN; WIDTH]; 3] };
    for (lane, item) in items.iter().enumerate() {
        for (axis, centre) in centre.iter().enumerate() {
            leaf.offset[axis][lane] = (item.at[axis] - centre) as f32;
        }
    }
    let half = leaf_bounds(&leaf);
    let low = std::array::from_fn(|axis| centre[axis] - half[axis]);
    let high = std::array::from_fn(|axis| centre[axis] + half[axis]);
    (leaf, Bounds { low, high })
}

/// Returns the half extents of a leaf's points about its centre; negative if it has no points.
fn leaf_bounds(leaf: &Leaf) -> [f64; 3] {
    // `f64::max` ignores NaN.
    leaf.offset
        .map(|list| list.into_iter().fold(-1.0, |half, offset| f64::max(half, offset.abs().into())))
}

fn leaf_attributes(items: &[BuildItem], cloud: &Cloud, max_weight: f64) -> LeafAttributes {
    let mut leaf_attributes = LeafAttributes { normal: [[0.0; WIDTH]; 3], weight: [0.0; WIDTH] };
    for (lane, item) in items.iter().enumerate() {
        let normal = cloud.normals()[item.index as usize];
        for axis in 0..3 {
            leaf_attributes.normal[axis][lane] = normal[axis] as f32;
        }
        if max_weight > 0.0 {
            leaf_attributes.weight[lane] =
                (cloud.weights()[item.index as usize] / max_weight) as f32;
        }
    }
    leaf_attributes
}

/// A point of a tree.
pub(crate) struct TreePoint {
    pub(crate) slot: usize,
    pub(crate) position: Point3<f64>,
    /// The outward normal, a unit vector.
    pub(crate) normal: Vector3<f64>,
}

impl PointBvh {
    /// Removes points, by their tree indices. The other points do not change by a single bit.
    pub fn remove(&mut self, slots: impl IntoIterator<Item = usize>) {
        let (leaves, attributes) = (&mut self.leaves, &mut self.attributes);
        let mut touched = Vec::new();
        for slot in slots {
            let (leaf, lane) = (slot / WIDTH, slot % WIDTH);
            let offset = &mut leaves[leaf].offset;
            if !offset[0][lane].is_nan() {
                offset.iter_mut().for_each(|list| list[lane] = f32::NAN);
                attributes[leaf].weight[lane] = 0.0;
                self.removed += 1;
                touched.push(leaf);
            }
        }
        // Each leaf once, in ascending order, as the levels above are refitted.
        touched.sort_unstable();
        touched.dedup();
        let bottom = self.levels.len() - 1;
        let all = &mut self.levels[bottom];
        for leaf in &touched {
            // The centre stays, since points are stored relative to it.
            let half = leaf_bounds(&leaves[*leaf]);
            let boxes = &mut all[leaf / WIDTH];
            for (axis, half) in half.iter().enumerate() {
                boxes.half[axis][leaf % WIDTH] = outward(half.max(0.0));
                if *half < 0.0 {
                    boxes.centre[axis][leaf % WIDTH] = f32::NAN;
                }
            }
        }
        self.fit_above(touched);
    }

    /// Returns the points that were not removed.
    pub(crate) fn all(&self) -> impl Iterator<Item = TreePoint> {
        let all = (0..self.slots()).map(|slot| TreePoint {
            slot,
            position: self.point(slot),
            normal: self.normal(slot).into(),
        });
        all.filter(|point| !point.position.x.is_nan())
    }

    /// Moves points, given in ascending order of their slots, to new positions with new normals. Returns the largest
    /// displacement of all points, in the part's unit.
    pub(crate) fn replace(&mut self, moved: &[TreePoint]) -> f64 {
        let mut farthest = 0f64;
        let mut touched = Vec::new();
        let bottom = self.levels.len() - 1;
        let (leaves, attributes) = (&mut self.leaves, &mut self.attributes);
        let boxes = &mut self.levels[bottom];
        for moved_in_leaf in moved.chunk_by(|a, b| a.slot / WIDTH == b.slot / WIDTH) {
            let leaf = moved_in_leaf[0].slot / WIDTH;
            let (all, offset) = (&mut boxes[leaf / WIDTH], leaves[leaf].offset);
            let previous: [[f64; 3]; WIDTH] = std::array::from_fn(|lane| {
                std::array::from_fn(|axis| {
                    f64::from(all.centre[axis][leaf % WIDTH]) + f64::from(offset[axis][lane])
                })
            });
            let mut items = previous.map(|at| BuildItem { at, index: 0 });
            for TreePoint { slot, position, normal } in moved_in_leaf {
                items[slot % WIDTH].at = self.frame.inside((*position).into());
                let normals = &mut attributes[leaf].normal;
                (0..3).for_each(|axis| normals[axis][slot % WIDTH] = normal[axis] as f32);
            }
            let (leaf_points, bounds) = build_leaf(&items);
            leaves[leaf] = leaf_points;
            all.set_lane(leaf % WIDTH, &bounds);
            // The largest size so far stays a bound, though the leaf that had it may have shrunk.
            self.leaf_size = self.leaf_size.max(outward(bounds.size() / 2.0));
            touched.push(leaf);
            // The points that stay are rounded again, since the leaf's centre changed.
            for (lane, previous) in previous.iter().enumerate() {
                let distance: f64 = (0..3)
                    .map(|axis| {
                        let centre = f64::from(all.centre[axis][leaf % WIDTH]);
                        let current = centre + f64::from(leaves[leaf].offset[axis][lane]);
                        (current - previous[axis]).powi(2)
                    })
                    .sum();
                // NaN in slots without a point.
                farthest = farthest.max(distance.sqrt());
            }
        }
        self.fit_above(touched);
        // The frame's size is measured from its origin.
        let whole = around(&self.levels[0][0]);
        self.frame.size =
            self.frame.size.max(outward(2.0 * whole.farthest() * (1.0 + STORED_BOX_MARGIN)));
        farthest * self.frame.scale
    }

    /// Refits the boxes above some leaves, which are given in ascending order.
    fn fit_above(&mut self, mut touched: Vec<usize>) {
        for level in (1..self.levels.len()).rev() {
            touched.iter_mut().for_each(|node| *node /= WIDTH);
            touched.dedup();
            let (above, below) = self.levels.split_at_mut(level);
            let above = &mut above[level - 1];
            for node in &touched {
                let bounds = around(&below[0][*node]);
                above[node / WIDTH].set_lane(node % WIDTH, &bounds);
            }
        }
    }
}

impl Bounds {
    /// Returns the largest absolute coordinate of the box's corners.
    fn farthest(&self) -> f64 {
        let ends = self.low.iter().chain(&self.high);
        ends.filter(|end| end.is_finite()).map(|end| end.abs()).fold(0.0, f64::max)
    }
}
