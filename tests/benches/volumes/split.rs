//! How points are divided in two, again and again, until a leaf holds what is left.
//!
//! The rules are those that Klosowski (1997) compares. They go by the points alone, not by the
//! volumes that are put about them later, so that every volume bounds the same sets of points.

use std::ops::Range;

/// A point on its way to a leaf.
#[derive(Clone, Copy)]
pub(crate) struct Item {
    /// From the middle of the part.
    pub(crate) at: [f64; 3],
    pub(crate) index: u32,
}

/// A box by its ends.
#[derive(Clone, Copy)]
pub(crate) struct Bounds {
    low: [f64; 3],
    high: [f64; 3],
}

impl Bounds {
    pub(crate) fn of(items: &[Item]) -> Bounds {
        Bounds::of_places(items.iter().map(|item| item.at))
    }

    pub(crate) fn of_places(places: impl Iterator<Item = [f64; 3]>) -> Bounds {
        let mut bounds = Bounds { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };
        for at in places {
            for (axis, value) in at.into_iter().enumerate() {
                bounds.low[axis] = bounds.low[axis].min(value);
                bounds.high[axis] = bounds.high[axis].max(value);
            }
        }
        bounds
    }

    pub(crate) fn middle(&self, axis: usize) -> f64 {
        0.5 * (self.low[axis] + self.high[axis])
    }

    pub(crate) fn side(&self, axis: usize) -> f64 {
        self.high[axis] - self.low[axis]
    }

    pub(crate) fn volume(&self) -> f64 {
        self.side(0) * self.side(1) * self.side(2)
    }

    /// Half of it.
    pub(crate) fn surface(&self) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|axis| self.side(axis));
        x * y + y * z + z * x
    }
}

/// Across which axis.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Axis {
    /// The box's longest side.
    Longest,
    /// That along which the points vary most.
    Variance,
    /// That which leaves the least sum of volumes of the two boxes.
    Volumes,
    /// The same of surfaces.
    Surfaces,
}

/// Where.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Point {
    /// So that the left part has a power of two of full leaves.
    Full,
    Median,
    Mean,
    /// The middle of the box.
    Middle,
}

/// A rule for dividing.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct Rule {
    pub(crate) axis: Axis,
    pub(crate) point: Point,
    /// The most points of a leaf.
    pub(crate) leaf: usize,
}

/// Points in the rule's order, halves of halves.
pub(crate) struct Half {
    pub(crate) range: Range<usize>,
    pub(crate) leaves: usize,
    pub(crate) below: Option<Box<[Half; 2]>>,
}

impl Rule {
    /// Orders the points; `first` is the place of the first.
    pub(crate) fn divide(self, items: &mut [Item], first: usize) -> Half {
        let range = first..first + items.len();
        if items.len() <= self.leaf {
            return Half { range, leaves: 1, below: None };
        }
        let left = self.part(items);
        let (low, high) = items.split_at_mut(left);
        let below = [self.divide(low, first), self.divide(high, first + left)];
        let leaves = below[0].leaves + below[1].leaves;
        Half { range, leaves, below: Some(Box::new(below)) }
    }

    /// Divides the points in two; how many are left of the split.
    fn part(self, items: &mut [Item]) -> usize {
        let greatest = |values: [f64; 3]| {
            (0..3).fold(0, |best, axis| if values[axis] > values[best] { axis } else { best })
        };
        let axis = match self.axis {
            Axis::Longest => {
                let bounds = Bounds::of(items);
                greatest([0, 1, 2].map(|axis| bounds.side(axis)))
            }
            Axis::Variance => greatest([0, 1, 2].map(|axis| variance(items, axis))),
            Axis::Volumes => greatest(self.costs(items, Bounds::volume).map(|cost| -cost)),
            Axis::Surfaces => greatest(self.costs(items, Bounds::surface).map(|cost| -cost)),
        };
        self.across(items, axis)
    }

    /// What a split across each axis would leave.
    fn costs(self, items: &mut [Item], cost: impl Fn(&Bounds) -> f64) -> [f64; 3] {
        [0, 1, 2].map(|axis| {
            let left = self.across(items, axis);
            let (low, high) = items.split_at(left);
            cost(&Bounds::of(low)) + cost(&Bounds::of(high))
        })
    }

    /// Divides the points across an axis.
    fn across(self, items: &mut [Item], axis: usize) -> usize {
        let count = items.len();
        match self.point {
            Point::Full => {
                let leaves = count.div_ceil(self.leaf);
                by_rank(items, axis, self.leaf * (leaves.next_power_of_two() / 2))
            }
            Point::Median => by_rank(items, axis, count / 2),
            Point::Mean => by_value(items, axis, mean(items, axis)),
            Point::Middle => by_value(items, axis, Bounds::of(items).middle(axis)),
        }
    }
}

/// So many points to the left. Equal coordinates are told apart by the index.
fn by_rank(items: &mut [Item], axis: usize, left: usize) -> usize {
    items.select_nth_unstable_by(left, |a, b| {
        a.at[axis].total_cmp(&b.at[axis]).then(a.index.cmp(&b.index))
    });
    left
}

/// What is below a value to the left; half of all if that leaves a side empty.
fn by_value(items: &mut [Item], axis: usize, value: f64) -> usize {
    let mut left = 0;
    for at in 0..items.len() {
        if items[at].at[axis] < value {
            items.swap(at, left);
            left += 1;
        }
    }
    if left == 0 || left == items.len() { by_rank(items, axis, items.len() / 2) } else { left }
}

fn mean(items: &[Item], axis: usize) -> f64 {
    items.iter().map(|item| item.at[axis]).sum::<f64>() / items.len() as f64
}

fn variance(items: &[Item], axis: usize) -> f64 {
    let mean = mean(items, axis);
    let squared = |item: &Item| (item.at[axis] - mean) * (item.at[axis] - mean);
    items.iter().map(squared).sum::<f64>() / items.len() as f64
}
