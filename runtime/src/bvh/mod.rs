//! A bounding volume hierarchy without pointers: a 16-wide tree of boxes over points or triangles, and its construction.
//!
//! Items are sorted in kd order. Splits fall at powers of two of leaves, so that every leaf but the last is full,
//! and node `n` of a level has the children `16 n … 16 n + 15` of the next. A level is a list of [`Boxes`], 16
//! boxes side by side, in `f32` relative to a [`Frame`].

mod view;

use crate::parallel;
use bytemuck::{Pod, Zeroable};
use nalgebra::Point3;

pub(crate) use view::{
    LANE_INDICES, LaneVector, PoseTransform, QuerySetup, ReachBounds, SLABS, dot, extent, load,
    transform,
};

/// The part by which a size is enlarged, since boxes that are stored in `f32` around other boxes are slightly larger than their contents.
pub(crate) const STORED_BOX_MARGIN: f64 = 1e-6;

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

/// Subtrees whose left half has fewer items are sorted on one core.
const MAX_SEQUENTIAL_ITEMS: usize = 1 << 12;

/// An item to be sorted: its representative point in the tree's frame, and its index.
#[derive(Clone, Copy)]
pub(crate) struct BuildItem {
    pub(crate) at: [f64; 3],
    pub(crate) index: u32,
}

/// A box as its lowest and highest corners.
#[derive(Clone, Copy)]
pub(crate) struct Bounds {
    pub(crate) low: [f64; 3],
    pub(crate) high: [f64; 3],
}

impl Bounds {
    /// Returns the bounding box of points; without any, low is +∞ and high is -∞.
    pub(crate) fn of(points: impl IntoIterator<Item = [f64; 3]>) -> Bounds {
        let mut bounds = Bounds { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };
        for point in points {
            for (axis, part) in point.into_iter().enumerate() {
                bounds.low[axis] = bounds.low[axis].min(part);
                bounds.high[axis] = bounds.high[axis].max(part);
            }
        }
        bounds
    }

    /// Returns the bounding box of boxes.
    pub(crate) fn around(boxes: &[Bounds]) -> Bounds {
        Bounds::of(boxes.iter().flat_map(|bounds| [bounds.low, bounds.high]))
    }

    /// Returns the squared distance of a point from the box; 0 inside.
    pub(crate) fn squared_distance(&self, at: [f64; 3]) -> f64 {
        let mut squared = 0.0;
        for (axis, at) in at.into_iter().enumerate() {
            let out = (self.low[axis] - at).max(at - self.high[axis]).max(0.0);
            squared += out * out;
        }
        squared
    }

    pub(crate) fn middle(&self, axis: usize) -> f64 {
        self.low[axis] / 2.0 + self.high[axis] / 2.0
    }

    pub(crate) fn size(&self) -> f64 {
        (0..3).map(|axis| self.high[axis] - self.low[axis]).fold(0.0, f64::max)
    }
}

impl Frame {
    /// Returns the frame of a set of points.
    pub(crate) fn around(points: impl IntoIterator<Item = [f64; 3]>) -> Frame {
        let bounds = Bounds::of(points);
        let scale = power_of_two(bounds.size());
        let origin = Point3::from([0, 1, 2].map(|axis| bounds.middle(axis)));
        let size = outward(bounds.size() / scale * (1.0 + STORED_BOX_MARGIN));
        Frame { origin, scale, size }
    }

    /// Returns a point in this frame and its unit.
    pub(crate) fn inside(&self, point: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| (point[axis] - self.origin[axis]) / self.scale)
    }
}

/// Builds all levels over leaf boxes, from the root's children down to the given boxes.
pub(crate) fn levels(mut boxes: Vec<Bounds>) -> Vec<Vec<Boxes>> {
    let mut levels = Vec::new();
    loop {
        let level: Vec<Boxes> = boxes.chunks(WIDTH).map(pack_boxes).collect();
        // The next level is built around the boxes as they are stored, rounded, and so contains them.
        boxes = level.iter().map(around).collect();
        levels.push(level);
        if boxes.len() == 1 {
            break;
        }
    }
    levels.reverse();
    levels
}

/// Returns the power of two next above a size, or 1 for a single point. Exponents are limited to ±1000.
fn power_of_two(size: f64) -> f64 {
    if size > 0.0 { 2f64.powi((size.log2().ceil() as i32).clamp(-1000, 1000)) } else { 1.0 }
}

/// Sorts items into kd order: across the longest side, with a power of two of full leaves on the left.
pub(crate) fn order(items: &mut [BuildItem]) {
    if items.len() <= WIDTH {
        return;
    }
    // So every leaf but the last is full, and the tree needs no pointers.
    let leaves = items.len().div_ceil(WIDTH);
    let left = WIDTH * (leaves.next_power_of_two() / 2);
    let bounds = Bounds::of(items.iter().map(|item| item.at));
    let size = [0, 1, 2].map(|axis| bounds.high[axis] - bounds.low[axis]);
    let axis = (0..3).fold(0, |best, axis| if size[axis] > size[best] { axis } else { best });
    // Equal coordinates are ordered by index, so the order depends on the items alone.
    items.select_nth_unstable_by(left, |a, b| {
        a.at[axis].total_cmp(&b.at[axis]).then(a.index.cmp(&b.index))
    });
    let (low, high) = items.split_at_mut(left);
    // For so few items a task costs more than it saves.
    if low.len() < MAX_SEQUENTIAL_ITEMS {
        order(low);
        order(high);
    } else {
        parallel::both(|| order(low), || order(high));
    }
}

fn pack_boxes(bounds: &[Bounds]) -> Boxes {
    let mut boxes = Boxes { centre: [[f32::NAN; WIDTH]; 3], half: [[0.0; WIDTH]; 3] };
    for (lane, bounds) in bounds.iter().enumerate() {
        boxes.set_lane(lane, bounds);
    }
    boxes
}

impl Boxes {
    /// Stores a box in a lane. An empty box (low above high) becomes an absent one.
    pub(crate) fn set_lane(&mut self, lane: usize, bounds: &Bounds) {
        for axis in 0..3 {
            let [low, high] = [bounds.low[axis], bounds.high[axis]];
            let centre = if low <= high { bounds.middle(axis) as f32 } else { f32::NAN };
            // The centre was rounded, so the box is no longer symmetric about it.
            let reach = (high - f64::from(centre)).max(f64::from(centre) - low);
            self.centre[axis][lane] = centre;
            self.half[axis][lane] = if centre.is_nan() { 0.0 } else { outward(reach) };
        }
    }
}

/// Returns the bounding box of sixteen stored boxes.
pub(crate) fn around(boxes: &Boxes) -> Bounds {
    let mut bounds = Bounds { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };
    for axis in 0..3 {
        for (centre, half) in boxes.centre[axis].iter().zip(boxes.half[axis]) {
            if !centre.is_nan() {
                let (centre, half) = (f64::from(*centre), f64::from(half));
                bounds.low[axis] = bounds.low[axis].min(centre - half);
                bounds.high[axis] = bounds.high[axis].max(centre + half);
            }
        }
    }
    bounds
}

/// Returns the smallest `f32` that is at least `value`.
pub(crate) fn outward(value: f64) -> f32 {
    let rounded = value as f32;
    if f64::from(rounded) < value { rounded.next_up() } else { rounded }
}
