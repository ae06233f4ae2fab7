//! Removing and moving points without building a new tree: leaves keep their points, and boxes are refitted.

use super::PointBvh;
use super::build::{build_leaf, leaf_bounds};
use crate::bvh::{Bounds, BuildItem, WIDTH, around, outward};
use nalgebra::{Point3, Vector3};

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

    /// Returns the points that were not removed, with their tree indices and normals.
    pub(crate) fn all(&self) -> impl Iterator<Item = (usize, Point3<f64>, Vector3<f64>)> {
        let all = (0..self.slots()).map(|slot| (slot, self.point(slot)));
        let present = all.filter(|(_, point)| !point.x.is_nan());
        present.map(|(slot, point)| (slot, point, self.normal(slot).into()))
    }

    /// Moves points. `moved` has their indices in ascending order, their new positions and their unit normals. Returns
    /// the largest displacement of all points, in the part's unit.
    pub(crate) fn replace(&mut self, moved: &[(usize, Point3<f64>, Vector3<f64>)]) -> f64 {
        let mut farthest = 0f64;
        let mut touched = Vec::new();
        let bottom = self.levels.len() - 1;
        let (leaves, attributes) = (&mut self.leaves, &mut self.attributes);
        let boxes = &mut self.levels[bottom];
        for moved_in_leaf in moved.chunk_by(|a, b| a.0 / WIDTH == b.0 / WIDTH) {
            let leaf = moved_in_leaf[0].0 / WIDTH;
            let (all, offset) = (&mut boxes[leaf / WIDTH], leaves[leaf].offset);
            let previous: [[f64; 3]; WIDTH] = std::array::from_fn(|lane| {
                let part = |axis: usize| {
                    f64::from(all.centre[axis][leaf % WIDTH]) + f64::from(offset[axis][lane])
                };
                [part(0), part(1), part(2)]
            });
            let mut items = previous.map(|at| BuildItem { at, index: 0 });
            for (slot, point, normal) in moved_in_leaf {
                items[slot % WIDTH].at = self.frame.inside((*point).into());
                let normals = &mut attributes[leaf].normal;
                (0..3).for_each(|axis| normals[axis][slot % WIDTH] = normal[axis] as f32);
            }
            let (leaf_points, bounds) = build_leaf(&items);
            leaves[leaf] = leaf_points;
            all.set_lane(leaf % WIDTH, &bounds);
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
        self.frame.size = self.frame.size.max(outward(2.0 * whole.farthest() * (1.0 + 1e-6)));
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
