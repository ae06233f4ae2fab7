//! Construction of the tree from a cloud.

use super::{Leaf, LeafAttributes, PointBvh};
use crate::bvh::{Bounds, BuildItem, Frame, WIDTH, levels, order, outward};
use crate::cloud::Cloud;

pub(super) fn build(cloud: &Cloud) -> PointBvh {
    let points = || cloud.points().iter().map(|p| [p.x, p.y, p.z]);
    let frame = Frame::around(points());
    let mut items: Vec<BuildItem> = points()
        .zip(0u32..)
        .map(|(point, index)| BuildItem { at: frame.inside(point), index })
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
pub(super) fn build_leaf(items: &[BuildItem]) -> (Leaf, Bounds) {
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
pub(super) fn leaf_bounds(leaf: &Leaf) -> [f64; 3] {
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
