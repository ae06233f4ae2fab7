//! Which points are near a place: boxes about boxes, sixteen wide.

use crate::tree::{Bounds, Item, WIDTH, order};
use nalgebra::Point3;

/// Points by where they are.
pub(super) struct Near {
    items: Vec<Item>,
    /// From the leaves up to the one about all.
    levels: Vec<Vec<Bounds>>,
}

impl Near {
    /// Of one point at least.
    pub(super) fn new(points: &[Point3<f64>]) -> Near {
        let item = |(point, index): (&Point3<f64>, u32)| Item { at: (*point).into(), index };
        let mut items: Vec<Item> = points.iter().zip(0..).map(item).collect();
        order(&mut items);
        let leaf = |items: &[Item]| Bounds::of(items.iter().map(|item| item.at));
        let mut levels = vec![items.chunks(WIDTH).map(leaf).collect::<Vec<_>>()];
        while let Some(below) = levels.last().filter(|level| level.len() > 1) {
            let above = below.chunks(WIDTH).map(Bounds::around).collect();
            levels.push(above);
        }
        Near { items, levels }
    }

    /// Puts the points within a distance of a place into `found`: squared distance and index, the
    /// nearest first, of equally near ones that of the lower index.
    pub(super) fn within(&self, at: [f64; 3], distance: f64, found: &mut Vec<(f64, u32)>) {
        found.clear();
        let squared = distance * distance;
        self.visit(at, squared, self.levels.len() - 1, 0, &mut |items| {
            for item in items {
                let away = away(item.at, at);
                if away <= squared {
                    found.push((away, item.index));
                }
            }
            squared
        });
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    }

    /// The squared distance of the `count`-th nearest point, of as many at least.
    pub(super) fn nearest_of(&self, at: [f64; 3], count: usize) -> f64 {
        let mut best = vec![f64::INFINITY; count];
        self.visit(at, f64::INFINITY, self.levels.len() - 1, 0, &mut |items| {
            for item in items {
                let away = away(item.at, at);
                if away < best[count - 1] {
                    let place = best.partition_point(|b| *b <= away);
                    best[place..].rotate_right(1);
                    best[place] = away;
                }
            }
            best[count - 1]
        });
        best[count - 1]
    }

    /// Visits the leaves of a node that are within a squared distance, the nearer boxes first; a
    /// visit says what distance is left. That distance at the end.
    fn visit(
        &self,
        at: [f64; 3],
        mut squared: f64,
        level: usize,
        node: usize,
        look: &mut impl FnMut(&[Item]) -> f64,
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

/// The squared distance of two places.
fn away(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [x, y, z] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    x * x + y * y + z * z
}
