//! Points in an order in which neighbours lie together, and a tree of boxes about them. What
//! `parry-bvh`, `fidget` and `grid` stand on.

use super::formula;
use crate::race::contender::{Sums, View};
use std::ops::Range;
use touchoff::Cloud;

/// A point of the cloud with all that is known of it.
#[derive(Clone, Copy)]
pub struct Point {
    /// Where it is.
    pub at: [f64; 3],
    /// Out of the material.
    pub normal: [f64; 3],
    /// The area it stands for.
    pub weight: f64,
}

impl Point {
    /// Adds the point to the sums if the formula in `f64` has it inside.
    #[inline]
    pub fn feel(&self, view: &View, sums: &mut Sums) {
        let arm = view.arm(self.at);
        let p = view.turn(arm);
        if let Some(felt) = formula::sense(p) {
            sums.add([arm, p], (self.weight, self.normal), felt);
        }
    }
}

/// The cloud's points, as they come.
pub fn points(cloud: &Cloud) -> Vec<Point> {
    let lists = cloud.points().iter().zip(cloud.normals()).zip(cloud.weights());
    lists
        .map(|((at, normal), weight)| Point {
            at: at.coords.into(),
            normal: (*normal).into(),
            weight: *weight,
        })
        .collect()
}

/// Kd order: across the longest side, the left part a power of two of full leaves.
pub fn order(points: &mut [Point], leaf: usize) {
    if points.len() <= leaf {
        return;
    }
    let left = leaf * (points.len().div_ceil(leaf).next_power_of_two() / 2);
    let bounds = Bounds::of(points.iter().map(|point| Bounds::at(point.at)));
    let axis = (0..3).fold(0, |best, k| if bounds.half[k] > bounds.half[best] { k } else { best });
    points.select_nth_unstable_by(left, |a, b| a.at[axis].total_cmp(&b.at[axis]));
    let (low, high) = points.split_at_mut(left);
    order(low, leaf);
    order(high, leaf);
}

/// A box by its centre and half extents.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// Its centre.
    pub centre: [f64; 3],
    /// Half of its sides.
    pub half: [f64; 3],
}

impl Bounds {
    /// Of a point.
    pub fn at(point: [f64; 3]) -> Bounds {
        Bounds { centre: point, half: [0.0; 3] }
    }

    /// About some boxes.
    pub fn of(all: impl Iterator<Item = Bounds>) -> Bounds {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for one in all {
            for axis in 0..3 {
                low[axis] = low[axis].min(one.centre[axis] - one.half[axis]);
                high[axis] = high[axis].max(one.centre[axis] + one.half[axis]);
            }
        }
        let half = |sign: f64| [0, 1, 2].map(|axis| 0.5 * (high[axis] + sign * low[axis]));
        Bounds { centre: half(1.0), half: half(-1.0) }
    }
}

/// How many children a node of [`Tree`] has.
const CHILDREN: usize = 4;

/// A tree without pointers: node `n` of a level has the children `4 n …` of the next, and below
/// the last level stand the leaves' points.
pub struct Tree<N> {
    points: Vec<Point>,
    leaf: usize,
    /// From the root down.
    levels: Vec<Vec<N>>,
    nodes: Vec<u32>,
    below: Vec<u32>,
}

impl<N> Tree<N> {
    /// The tree of a cloud, leaves of so many points, each node made of its box and points.
    pub fn new(cloud: &Cloud, leaf: usize, node: impl Fn(Bounds, &[Point]) -> N) -> Self {
        let mut points = points(cloud);
        order(&mut points, leaf);
        let mut levels = Vec::new();
        let mut size = leaf;
        loop {
            let level: Vec<N> = points
                .chunks(size)
                .map(|some| node(Bounds::of(some.iter().map(|point| Bounds::at(point.at))), some))
                .collect();
            let done = level.len() == 1;
            levels.push(level);
            if done {
                break;
            }
            size *= CHILDREN;
        }
        levels.reverse();
        Tree { points, leaf, levels, nodes: Vec::new(), below: Vec::new() }
    }

    /// All points, in the tree's order.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// All points, and which of them lie in leaves that are reached through nodes that may touch
    /// the tool.
    pub fn leaves(
        &mut self,
        mut touches: impl FnMut(&N) -> bool,
    ) -> (&[Point], impl Iterator<Item = Range<usize>>) {
        self.nodes.clear();
        self.nodes.push(0);
        for (depth, level) in self.levels.iter().enumerate() {
            self.below.clear();
            for node in &self.nodes {
                if !touches(&level[*node as usize]) {
                    continue;
                }
                if let Some(next) = self.levels.get(depth + 1) {
                    let first = *node as usize * CHILDREN;
                    self.below.extend(first as u32..(first + CHILDREN).min(next.len()) as u32);
                } else {
                    self.below.push(*node);
                }
            }
            std::mem::swap(&mut self.nodes, &mut self.below);
        }
        let (count, leaf) = (self.points.len(), self.leaf);
        let range = move |node: &u32| {
            let first = *node as usize * leaf;
            first..(first + leaf).min(count)
        };
        (&self.points, self.nodes.iter().map(range))
    }
}
