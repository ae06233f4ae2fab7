//! `parry3d`'s bounding volume hierarchy over blocks of 64 points, with the tool's formula written by hand.
//!
//! An implementation as an expert in parry and SIMD would write it for this one tool. [`Bvh::leaves`] tests each node,
//! in the tool's frame, against the largest radius over the node's axial range. The 64 points of a block are tested in
//! `f32` with a margin, by the widest SIMD instructions of the machine. The remaining points are evaluated in `f64`.

use super::formula;
use super::points::{Bounds, Point, points, sort_in_kd_order};
use crate::race::contender::{Answer, Contender, PoseTransform, Sums};
use fearless_simd::{Level, Simd, SimdBase, SimdMask, dispatch, f32x16};
use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;
use parry3d::partitioning::{Bvh, BvhBuildStrategy};
use touchoff::{Cloud, Pose};

const POINTS_PER_BLOCK: usize = 64;
const WIDTH: usize = 16;

/// Margin in mm, larger than the single-precision error at coordinates below 100 mm.
const MARGIN: f64 = 1e-4;

/// Coordinates of 64 points, padded with coordinates far away.
struct Block([[f32; POINTS_PER_BLOCK]; 3]);

/// Blocks of points in `parry3d`'s hierarchy.
pub struct ParryBvh {
    level: Level,
    bvh: Bvh,
    blocks: Vec<Block>,
    points: Vec<Point>,
    found_blocks: Vec<u32>,
}

impl ParryBvh {
    /// Sorts the points of a cloud into blocks and builds the hierarchy.
    pub fn new(cloud: &Cloud) -> ParryBvh {
        let mut points = points(cloud);
        sort_in_kd_order(&mut points, POINTS_PER_BLOCK);
        let boxes: Vec<Aabb> = points
            .chunks(POINTS_PER_BLOCK)
            .map(|chunk| {
                let bounds = Bounds::of(chunk.iter().map(|point| Bounds::of_point(point.position)));
                let corner = |sign: f64| {
                    let end = |axis: usize| {
                        (bounds.centre[axis] + sign * (bounds.half[axis] + MARGIN)) as f32
                    };
                    Vector::new(end(0), end(1), end(2))
                };
                Aabb::new(corner(-1.0), corner(1.0))
            })
            .collect();
        let blocks = points
            .chunks(POINTS_PER_BLOCK)
            .map(|chunk| {
                let coordinate = |axis: usize, index: usize| {
                    chunk.get(index).map_or(1e6, |point| point.position[axis] as f32)
                };
                Block([0, 1, 2].map(|axis| std::array::from_fn(|index| coordinate(axis, index))))
            })
            .collect();
        let bvh = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        ParryBvh { level: Level::new(), bvh, blocks, points, found_blocks: Vec::new() }
    }
}

/// Adds the points of the found blocks that are inside to the sums.
#[inline(always)]
fn add_points_inside<S: Simd>(
    simd: S,
    method: &ParryBvh,
    transform: &PoseTransform,
    sums: &mut Sums,
) {
    let rows = transform.rows_f32();
    let tip = transform.tip.map(|c| c as f32);
    let margin = f32x16::splat(simd, -MARGIN as f32);
    for block in &method.found_blocks {
        let Block([xs, ys, zs]) = &method.blocks[*block as usize];
        for lane_group in 0..POINTS_PER_BLOCK / WIDTH {
            let range = lane_group * WIDTH..(lane_group + 1) * WIDTH;
            let lists = [&xs[range.clone()], &ys[range.clone()], &zs[range]];
            let depth = formula::magnitude_from(simd, lists, (rows, tip));
            let mut hits = depth.simd_ge(margin).to_bitmask();
            while hits != 0 {
                let index = *block as usize * POINTS_PER_BLOCK
                    + lane_group * WIDTH
                    + hits.trailing_zeros() as usize;
                method.points[index].add_to(transform, sums);
                hits &= hits - 1;
            }
        }
    }
}

impl Contender for ParryBvh {
    fn name(&self) -> &'static str {
        "parry-bvh"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let transform = PoseTransform::of(pose);
        self.found_blocks.clear();
        let leaves = self.bvh.leaves(|node| {
            let (low, high) = (node.mins(), node.maxs());
            let ends = [(low.x, high.x), (low.y, high.y), (low.z, high.z)];
            let centre = ends.map(|(low, high)| 0.5 * (f64::from(low) + f64::from(high)));
            let half = ends.map(|(low, high)| 0.5 * (f64::from(high) - f64::from(low)));
            formula::may_touch(
                transform.to_tool_frame(transform.offset_from_tip(centre)),
                transform.box_half_extents(half),
            )
        });
        self.found_blocks.extend(leaves);
        let mut sums = Sums::default();
        dispatch!(self.level, simd => add_points_inside(simd, self, &transform, &mut sums));
        sums.answer(&transform)
    }
}
