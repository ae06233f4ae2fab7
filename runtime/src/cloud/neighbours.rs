//! Neighbours of points: nearest-neighbour queries by a 16-wide bounding volume hierarchy, and their results as many short
//! lists in one allocation.

use crate::bvh::{Bounds, BuildItem, WIDTH, order};
use nalgebra::Point3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A point, by its index, and its squared distance from some position.
#[derive(Clone, Copy)]
pub(super) struct Neighbour {
    pub(super) squared: f64,
    pub(super) index: u32,
}

impl Neighbour {
    /// Compares by squared distance, then by index.
    pub(super) fn nearer(&self, other: &Neighbour) -> Ordering {
        self.squared.total_cmp(&other.squared).then(self.index.cmp(&other.index))
    }
}

/// A spatial index of points.
pub(super) struct NeighbourBvh {
    items: Vec<BuildItem>,
    /// Boxes of each level, from the leaves to the root.
    levels: Vec<Vec<Bounds>>,
}

impl NeighbourBvh {
    /// Builds the index of one or more points.
    pub(super) fn new(points: &[Point3<f64>]) -> NeighbourBvh {
        let mut items: Vec<BuildItem> = points
            .iter()
            .zip(0..)
            .map(|(point, index)| BuildItem { at: (*point).into(), index })
            .collect();
        order(&mut items);
        let leaves = items.chunks(WIDTH);
        let mut levels: Vec<Vec<Bounds>> =
            vec![leaves.map(|leaf| Bounds::of(leaf.iter().map(|item| item.at))).collect()];
        while let Some(below) = levels.last().filter(|level| level.len() > 1) {
            let above = below.chunks(WIDTH).map(Bounds::around).collect();
            levels.push(above);
        }
        NeighbourBvh { items, levels }
    }

    /// Puts the points within a distance of a position into `found`. The nearest come first, equally near ones by
    /// index.
    pub(super) fn within(&self, point: [f64; 3], distance: f64, found: &mut Vec<Neighbour>) {
        self.nearest_within(point, distance, usize::MAX, found);
    }

    /// Like [`NeighbourBvh::within`], but returns only the `max_count` nearest points. `max_count` must be at least 1.
    pub(super) fn nearest_within(
        &self,
        point: [f64; 3],
        distance: f64,
        max_count: usize,
        found: &mut Vec<Neighbour>,
    ) {
        found.clear();
        let mut max_squared = distance * distance;
        self.visit(point, max_squared, self.levels.len() - 1, 0, &mut |items| {
            for item in items {
                let squared_distance = squared_distance(item.at, point);
                if squared_distance <= max_squared {
                    found.push(Neighbour { squared: squared_distance, index: item.index });
                }
            }
            // At twice the count, a selection costs no more than the points did that were added since the last one.
            if found.len() / 2 >= max_count {
                let farthest = found.select_nth_unstable_by(max_count - 1, Neighbour::nearer).1;
                max_squared = farthest.squared;
                found.truncate(max_count);
            }
            max_squared
        });
        found.sort_unstable_by(Neighbour::nearer);
        found.truncate(max_count);
    }

    /// Returns the point with the least sum of its squared distance and `offset`; among equals, the one
    /// with the lower index.
    pub(super) fn min_sum(&self, point: [f64; 3], offset: impl Fn(u32) -> f64) -> u32 {
        let mut best = Neighbour { squared: f64::INFINITY, index: u32::MAX };
        self.visit(point, f64::INFINITY, self.levels.len() - 1, 0, &mut |items| {
            for item in items {
                let squared = squared_distance(item.at, point) + offset(item.index);
                let sum = Neighbour { squared, index: item.index };
                if sum.nearer(&best).is_lt() {
                    best = sum;
                }
            }
            // Offsets are not negative, so no point farther than the least sum has a lesser one.
            best.squared
        });
        best.index
    }

    /// Returns the squared distance within which the points' weights add up to `min_weight`, or that of the
    /// farthest point if the total weight is less.
    pub(super) fn distance_to_weight(
        &self,
        point: [f64; 3],
        min_weight: usize,
        weight: impl Fn(u32) -> usize,
    ) -> f64 {
        let mut sum = 0;
        let mut nearest: BinaryHeap<(Squared, usize)> = BinaryHeap::new();
        self.visit(point, f64::INFINITY, self.levels.len() - 1, 0, &mut |items| {
            for item in items {
                let squared_distance = Squared(squared_distance(item.at, point));
                if sum < min_weight
                    || nearest.peek().is_some_and(|farthest| squared_distance < farthest.0)
                {
                    let weight = weight(item.index);
                    sum += weight;
                    nearest.push((squared_distance, weight));
                    // Drop the farthest points that the weight does without.
                    while let Some(farthest) = nearest.peek().filter(|f| sum - f.1 >= min_weight) {
                        sum -= farthest.1;
                        nearest.pop();
                    }
                }
            }
            let farthest = nearest.peek().filter(|_| sum >= min_weight);
            farthest.map_or(f64::INFINITY, |farthest| farthest.0.0)
        });
        nearest.peek().map_or(0.0, |farthest| farthest.0.0)
    }

    /// Visits the leaves of a node within a squared distance, the nearer boxes first. Each visit returns
    /// the new squared distance. Returns the final one.
    fn visit(
        &self,
        point: [f64; 3],
        mut max_squared: f64,
        level: usize,
        node: usize,
        visit_leaf: &mut impl FnMut(&[BuildItem]) -> f64,
    ) -> f64 {
        let (first, end) = (node * WIDTH, (node + 1) * WIDTH);
        if level == 0 {
            return visit_leaf(&self.items[first..end.min(self.items.len())]);
        }
        let below = &self.levels[level - 1];
        let mut children = [(0.0, 0); WIDTH];
        let mut count = 0;
        for (child, bounds) in (first..).zip(&below[first..end.min(below.len())]) {
            let squared_distance = bounds.squared_distance(point);
            if squared_distance <= max_squared {
                children[count] = (squared_distance, child);
                count += 1;
            }
        }
        children[..count].sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        for (squared_distance, child) in &children[..count] {
            // The visits before may have lowered the limit.
            if *squared_distance <= max_squared {
                max_squared = self.visit(point, max_squared, level - 1, *child, visit_leaf);
            }
        }
        max_squared
    }
}

/// A squared distance with a total order.
#[derive(Clone, Copy)]
struct Squared(f64);

impl PartialEq for Squared {
    fn eq(&self, other: &Squared) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Squared {}

impl PartialOrd for Squared {
    fn partial_cmp(&self, other: &Squared) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Squared {
    fn cmp(&self, other: &Squared) -> Ordering {
        self.0.total_cmp(&other.0)
    }
}

/// Returns the squared distance of two positions.
pub(super) fn squared_distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [x, y, z] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    x * x + y * y + z * z
}

/// Consecutive lists of indices, in one vector.
#[derive(Default)]
pub(super) struct Lists {
    items: Vec<u32>,
    /// The end of each list in `items`.
    ends: Vec<usize>,
}

impl Lists {
    /// Appends to the last list.
    pub(super) fn push(&mut self, item: u32) {
        self.items.push(item);
    }

    /// Ends the last list and begins another.
    pub(super) fn end(&mut self) {
        self.ends.push(self.items.len());
    }

    /// Concatenates several collections of lists, in order.
    pub(super) fn joined(parts: Vec<Lists>) -> Lists {
        let [items, lists] = parts.iter().fold([0; 2], |[items, lists], part| {
            [items + part.items.len(), lists + part.ends.len()]
        });
        let mut combined =
            Lists { items: Vec::with_capacity(items), ends: Vec::with_capacity(lists) };
        for Lists { items, ends } in parts {
            let offset = combined.items.len();
            combined.items.extend(items);
            combined.ends.extend(ends.into_iter().map(|end| offset + end));
        }
        combined
    }

    /// Returns the list at index `index`.
    pub(super) fn of(&self, index: u32) -> &[u32] {
        let index = index as usize;
        let start = if index == 0 { 0 } else { self.ends[index - 1] };
        &self.items[start..self.ends[index]]
    }
}
