//! The points below all volumes, in the tree's order.
//!
//! They are carried to the tool's frame in `f64`, eight side by side for the compiler to make vectors
//! of, and first held to the tool's outline; only what is left is asked through the trees of splits.

use crate::contender::{Sums, View};
use crate::formula;
use crate::points::{Point, points};
use crate::split::Item;
use touchoff::Cloud;

const LANES: usize = 8;

/// What a query has found so far.
pub(crate) struct Felt {
    /// Points within the outline.
    pub(crate) near: usize,
    /// Which of eight such points are asked: all, or none when only the search is timed.
    wanted: u32,
    pub(crate) sums: Sums,
}

impl Felt {
    pub(crate) fn nothing(wanted: bool) -> Felt {
        Felt { near: 0, wanted: if wanted { u32::MAX } else { 0 }, sums: Sums::default() }
    }
}

pub(crate) struct Leaves {
    /// Coordinates list by list, with some more behind the last.
    at: [Vec<f64>; 3],
    points: Vec<Point>,
}

impl Leaves {
    pub(crate) fn new(cloud: &Cloud, items: &[Item]) -> Leaves {
        let given = points(cloud);
        let points: Vec<Point> = items.iter().map(|item| given[item.index as usize]).collect();
        let at = [0, 1, 2].map(|axis| {
            let mut list: Vec<f64> = points.iter().map(|point| point.at[axis]).collect();
            list.resize(points.len() + LANES, 0.0);
            list
        });
        Leaves { at, points }
    }

    /// Adds what is inside of so many points from the first.
    #[inline(always)]
    pub(crate) fn feel(&self, view: &View, (first, count): (usize, usize), felt: &mut Felt) {
        let end = first + count;
        let mut at = first;
        while at < end {
            let mut left = self.near(view, at) & (0xff >> (LANES - (end - at).min(LANES)));
            felt.near += left.count_ones() as usize;
            left &= felt.wanted;
            while left != 0 {
                self.points[at + left.trailing_zeros() as usize].feel(view, &mut felt.sums);
                left &= left - 1;
            }
            at += LANES;
        }
    }

    /// A bit for each of eight points that is within the outline.
    #[inline(always)]
    fn near(&self, view: &View, at: usize) -> u32 {
        let lists = [0, 1, 2].map(|axis| &self.at[axis][at..at + LANES]);
        let mut near = [0u32; LANES];
        for lane in 0..LANES {
            let arm = view.arm([lists[0][lane], lists[1][lane], lists[2][lane]]);
            near[lane] = u32::from(!formula::beside(view.turn(arm)));
        }
        let mut bits = 0;
        for (lane, near) in near.into_iter().enumerate() {
            bits |= near << lane;
        }
        bits
    }
}
