//! Nearest-neighbour queries on points, by a 16-wide bounding volume hierarchy.

use crate::bvh::{Bounds, BuildItem, WIDTH, order};
use nalgebra::Point3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A spatial index of points.
pub(super) struct NeighbourBvh {
    items: Vec<BuildItem>,
    /// Boxes of each level, from the leaves to the root.
    levels: Vec<Vec<Bounds>>,
}

impl NeighbourBvh {
    /// Builds the index of one or more points.
    pub(super) fn new(points: &[Point3<f64>]) -> NeighbourBvh {
        let item = |(point, index): (&Point3<f64>, u32)| BuildItem { at: (*point).into(), index };
        let mut items: Vec<BuildItem> = points.iter().zip(0..).map(item).collect();
        order(&mut items);
        let leaf = |items: &[BuildItem]| Bounds::of(items.iter().map(|item| item.at));
        let mut levels = vec![items.chunks(WIDTH).map(leaf).collect::<Vec<_>>()];
        while let Some(below) = levels.last().filter(|level| level.len() > 1) {
            let above = below.chunks(WIDTH).map(Bounds::around).collect();
            levels.push(above);
        }
        NeighbourBvh { items, levels }
    }

    /// Puts the points within a distance of a position into `found`, as squared distance and index. The
    /// nearest come first, equally near ones by index.
    pub(super) fn within(&self, at: [f64; 3], distance: f64, found: &mut Vec<(f64, u32)>) {
        self.some_within(at, distance, usize::MAX, found);
    }

    /// Like [`PointGrid::within`], but returns only the `most` nearest points. `most` must be at least
    /// 1.
    pub(super) fn some_within(
        &self,
        at: [f64; 3],
        distance: f64,
        most: usize,
        found: &mut Vec<(f64, u32)>,
    ) {
        found.clear();
        let mut squared = distance * distance;
        self.visit(at, squared, self.levels.len() - 1, 0, &mut |items| {
            for item in items {
                let away = away(item.at, at);
                if away <= squared {
                    found.push((away, item.index));
                }
            }
            if found.len() / 2 >= most {
                squared = found.select_nth_unstable_by(most - 1, nearer).1.0;
                found.truncate(most);
            }
            squared
        });
        found.sort_unstable_by(nearer);
        found.truncate(most);
    }

    /// Returns the point with the least sum of its squared distance and `added`; among equals, the one
    /// with the lower index.
    pub(super) fn least(&self, at: [f64; 3], added: impl Fn(u32) -> f64) -> u32 {
        let mut best = (f64::INFINITY, u32::MAX);
        self.visit(at, f64::INFINITY, self.levels.len() - 1, 0, &mut |items| {
            for item in items {
                let sum = (away(item.at, at) + added(item.index), item.index);
                if nearer(&sum, &best).is_lt() {
                    best = sum;
                }
            }
            best.0
        });
        best.1
    }

    /// Returns the squared distance within which the points' weights add up to `wanted`, or that of the
    /// farthest point if the total weight is less.
    pub(super) fn weighing(
        &self,
        at: [f64; 3],
        wanted: usize,
        weight: impl Fn(u32) -> usize,
    ) -> f64 {
        let mut sum = 0;
        let mut nearest: BinaryHeap<(Squared, usize)> = BinaryHeap::new();
        self.visit(at, f64::INFINITY, self.levels.len() - 1, 0, &mut |items| {
            for item in items {
                let away = Squared(away(item.at, at));
                if sum < wanted || nearest.peek().is_some_and(|farthest| away < farthest.0) {
                    let weight = weight(item.index);
                    sum += weight;
                    nearest.push((away, weight));
                    while let Some(farthest) = nearest.peek().filter(|f| sum - f.1 >= wanted) {
                        sum -= farthest.1;
                        nearest.pop();
                    }
                }
            }
            let farthest = nearest.peek().filter(|_| sum >= wanted);
            farthest.map_or(f64::INFINITY, |farthest| farthest.0.0)
        });
        nearest.peek().map_or(0.0, |farthest| farthest.0.0)
    }

    /// Visits the leaves of a node within a squared distance, the nearer boxes first. Each visit returns
    /// the new squared distance. Returns the final one.
    fn visit(
        &self,
        at: [f64; 3],
        mut squared: f64,
        level: usize,
        node: usize,
        look: &mut impl FnMut(&[BuildItem]) -> f64,
    ) -> f64 {
        let range = |list: usize| node * WIDTH..((node + 1) * WIDTH).min(list);
        if level == 0 {
            return look(&self.items[range(self.items.len())]);
        }
        let below = &self.levels[level - 1];
        let mut near = [(0.0, 0); WIDTH];
        let mut count = 0;
        for child in range(below.len()) {
            let away = below[child].away(at);
            if away <= squared {
                near[count] = (away, child);
                count += 1;
            }
        }
        near[..count].sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        for (away, child) in &near[..count] {
            if *away <= squared {
                squared = self.visit(at, squared, level - 1, *child, look);
            }
        }
        squared
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

/// Compares two points by squared distance, then by index.
pub(super) fn nearer(a: &(f64, u32), b: &(f64, u32)) -> Ordering {
    a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
}

/// Returns the squared distance of two positions.
pub(super) fn away(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [x, y, z] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    x * x + y * y + z * z
}
