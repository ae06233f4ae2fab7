//! Points that go or move, without a new tree: leaves keep their points, boxes are fitted anew.

use super::build::{around, lay, leaf_bounds, outward};
use super::{Bounds, Item, Tree, WIDTH};
use nalgebra::{Point3, Vector3};

impl Tree {
    /// Takes points away, by their places. Those that stay do not move, not by a bit.
    pub(crate) fn remove(&mut self, places: impl IntoIterator<Item = usize>) {
        let (leaves, skins) = (self.leaves.to_mut(), self.skins.to_mut());
        let mut touched = Vec::new();
        for place in places {
            let (leaf, lane) = (place / WIDTH, place % WIDTH);
            let offset = &mut leaves[leaf].offset;
            if !offset[0][lane].is_nan() {
                offset.iter_mut().for_each(|list| list[lane] = f32::NAN);
                skins[leaf].weight[lane] = 0.0;
                self.gone += 1;
                touched.push(leaf);
            }
        }
        touched.sort_unstable();
        touched.dedup();
        let bottom = self.levels.len() - 1;
        let all = self.levels[bottom].to_mut();
        for leaf in &touched {
            // The centre stays: points are stored from there.
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

    /// Moves points and turns their normals; how far the farthest went, in the part's unit. What goes
    /// nowhere is not touched.
    pub(crate) fn displace(
        &mut self,
        mut to: impl FnMut(Point3<f64>, Vector3<f64>) -> (Point3<f64>, Vector3<f64>),
    ) -> f64 {
        let mut farthest = 0f64;
        let mut touched = Vec::new();
        let boxes = self.levels.len() - 1;
        for leaf in 0..self.leaves.len() {
            let mut items = [Item { at: [f64::NAN; 3], index: 0 }; WIDTH];
            let mut moved = false;
            for (lane, item) in items.iter_mut().enumerate() {
                let place = leaf * WIDTH + lane;
                if self.leaves[leaf].offset[0][lane].is_nan() {
                    continue;
                }
                let [centre, offset] = self.stored(place);
                item.at = [0, 1, 2].map(|axis| centre[axis] + offset[axis]);
                let (from, normal) = (self.point(place), Vector3::from(self.normal(place)));
                let (there, turned) = to(from, normal);
                if there != from || turned != normal {
                    moved = true;
                    farthest = farthest.max((there - from).norm());
                    item.at = self.frame.inside(there.into());
                    let skin = &mut self.skins.to_mut()[leaf].normal;
                    (0..3).for_each(|axis| skin[axis][lane] = turned[axis] as f32);
                }
            }
            if moved {
                let (laid, bounds) = lay(&items);
                self.leaves.to_mut()[leaf] = laid;
                self.levels[boxes].to_mut()[leaf / WIDTH].put(leaf % WIDTH, &bounds);
                let half = bounds.size() / 2.0;
                self.leaf_size = self.leaf_size.max(outward(half));
                touched.push(leaf);
            }
        }
        self.fit_above(touched);
        // The frame is about its origin.
        let whole = around(&self.levels[0][0]);
        self.frame.size = self.frame.size.max(outward(2.0 * whole.farthest() * (1.0 + 1e-6)));
        farthest
    }

    /// Fits the boxes above some leaves, which are given in order.
    fn fit_above(&mut self, mut touched: Vec<usize>) {
        for level in (1..self.levels.len()).rev() {
            touched.iter_mut().for_each(|node| *node /= WIDTH);
            touched.dedup();
            let (above, below) = self.levels.split_at_mut(level);
            let above = above[level - 1].to_mut();
            for node in &touched {
                let bounds = around(&below[0][*node]);
                above[node / WIDTH].put(node % WIDTH, &bounds);
            }
        }
    }
}

impl Bounds {
    /// How far from the origin it reaches along an axis.
    fn farthest(&self) -> f64 {
        let ends = self.low.iter().chain(&self.high);
        ends.filter(|end| end.is_finite()).map(|end| end.abs()).fold(0.0, f64::max)
    }
}
