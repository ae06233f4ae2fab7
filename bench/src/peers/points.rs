//! Points in kd order and a tree of boxes over them, shared by several methods.

use super::formula;
use crate::race::contender::{PoseTransform, Sums};
use std::ops::Range;
use touchoff::Cloud;

/// A point of the cloud with its attributes.
#[derive(Clone, Copy)]
pub struct Point {
    /// The position.
    pub position: [f64; 3],
    /// The unit normal, out of the material.
    pub normal: [f64; 3],
    /// The surface area that the point represents.
    pub weight: f64,
}

impl Point {
    /// Adds the point to the sums if the formula in `f64` classifies it as inside.
    #[inline]
    pub fn add_to(&self, transform: &PoseTransform, sums: &mut Sums) {
        let offset = transform.offset_from_tip(self.position);
        let p = transform.to_tool_frame(offset);
        if let Some(evaluation) = formula::evaluate(p) {
            sums.add([offset, p], (self.weight, self.normal), evaluation);
        }
    }
}

/// Returns the cloud's points in their original order.
pub fn points(cloud: &Cloud) -> Vec<Point> {
    let lists = cloud.points().iter().zip(cloud.normals()).zip(cloud.weights());
    lists
        .map(|((at, normal), weight)| Point {
            position: at.coords.into(),
            normal: (*normal).into(),
            weight: *weight,
        })
        .collect()
}

/// Sorts points in kd order: splits at the longest side, with a power of two of full leaves in the left half.
pub fn sort_in_kd_order(points: &mut [Point], leaf: usize) {
    if points.len() <= leaf {
        return;
    }
    let left = leaf * (points.len().div_ceil(leaf).next_power_of_two() / 2);
    let bounds = Bounds::of(points.iter().map(|point| Bounds::of_point(point.position)));
    let axis = (0..3).fold(0, |best, k| if bounds.half[k] > bounds.half[best] { k } else { best });
    points.select_nth_unstable_by(left, |a, b| a.position[axis].total_cmp(&b.position[axis]));
    let (low, high) = points.split_at_mut(left);
    sort_in_kd_order(low, leaf);
    sort_in_kd_order(high, leaf);
}

/// A box, by its centre and half extents.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// The centre.
    pub centre: [f64; 3],
    /// The half extents.
    pub half: [f64; 3],
}

impl Bounds {
    /// Returns the box of a single point.
    pub fn of_point(point: [f64; 3]) -> Bounds {
        Bounds { centre: point, half: [0.0; 3] }
    }

    /// Returns the bounding box of several boxes.
    pub fn of(boxes: impl Iterator<Item = Bounds>) -> Bounds {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for other in boxes {
            for axis in 0..3 {
                low[axis] = low[axis].min(other.centre[axis] - other.half[axis]);
                high[axis] = high[axis].max(other.centre[axis] + other.half[axis]);
            }
        }
        let combine = |sign: f64| [0, 1, 2].map(|axis| 0.5 * (high[axis] + sign * low[axis]));
        Bounds { centre: combine(1.0), half: combine(-1.0) }
    }
}

/// Number of children per node of a [`Tree`].
const CHILDREN: usize = 4;

/// A tree without pointers. Node `n` of a level has the children `4 n …` in the next level; below the last level are
/// the points of the leaves.
pub struct Tree<N> {
    points: Vec<Point>,
    leaf: usize,
    /// The levels, from the root down.
    levels: Vec<Vec<N>>,
    nodes: Vec<u32>,
    next_nodes: Vec<u32>,
}

impl<N> Tree<N> {
    /// Builds the tree of a cloud with `leaf` points per leaf. `node` makes a node from its box and points.
    pub fn new(cloud: &Cloud, leaf: usize, node: impl Fn(Bounds, &[Point]) -> N) -> Self {
        let mut points = points(cloud);
        sort_in_kd_order(&mut points, leaf);
        let mut levels = Vec::new();
        let mut size = leaf;
        loop {
            let level: Vec<N> = points
                .chunks(size)
                .map(|chunk| {
                    node(
                        Bounds::of(chunk.iter().map(|point| Bounds::of_point(point.position))),
                        chunk,
                    )
                })
                .collect();
            let is_root = level.len() == 1;
            levels.push(level);
            if is_root {
                break;
            }
            size *= CHILDREN;
        }
        levels.reverse();
        Tree { points, leaf, levels, nodes: Vec::new(), next_nodes: Vec::new() }
    }

    /// Returns all points, in the tree's order.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Traverses the nodes that `touches` accepts. Returns all points, and the index ranges of the leaves reached.
    pub fn leaves(
        &mut self,
        mut touches: impl FnMut(&N) -> bool,
    ) -> (&[Point], impl Iterator<Item = Range<usize>>) {
        self.nodes.clear();
        self.nodes.push(0);
        for (depth, level) in self.levels.iter().enumerate() {
            self.next_nodes.clear();
            for node in &self.nodes {
                if !touches(&level[*node as usize]) {
                    continue;
                }
                if let Some(next) = self.levels.get(depth + 1) {
                    let first = *node as usize * CHILDREN;
                    self.next_nodes.extend(first as u32..(first + CHILDREN).min(next.len()) as u32);
                } else {
                    self.next_nodes.push(*node);
                }
            }
            std::mem::swap(&mut self.nodes, &mut self.next_nodes);
        }
        let (count, leaf) = (self.points.len(), self.leaf);
        let range = move |node: &u32| {
            let first = *node as usize * leaf;
            first..(first + leaf).min(count)
        };
        (&self.points, self.nodes.iter().map(range))
    }
}
