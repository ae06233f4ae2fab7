//! The whole contact as one force and torque (Ho 1999, eq. 5.1 to 5.5).

use super::{Beside, Deepest, Law, Weights, posture};
use crate::pose::Pose;
use crate::tool::LANES;
use fearless_simd::{Select, Simd, SimdBase, SimdMask, dispatch, f64x8, mask64x8};
use nalgebra::Vector3;

/// What a tool feels at a pose. Forces and torques are on the tool, in the world's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrench {
    /// The law that made the force.
    pub law: Law,
    /// The weights that were used.
    pub weights: Weights,
    /// How many points of the part are inside the tool.
    pub colliding: usize,
    /// The deepest of them.
    pub deepest: Option<Deepest>,
    /// Force, in magnitude times weight.
    pub force: Vector3<f64>,
    /// Torque about the compliance centre, in force times the part's unit of length.
    pub torque: Vector3<f64>,
    /// The least niceness of all points; `None` without contact.
    pub niceness: Option<f64>,
    /// `Σ w m`
    pub integral: f64,
    /// `½ Σ w m²`
    pub energy: f64,
}

impl Wrench {
    /// What is felt without contact.
    pub(crate) fn nothing(law: Law, weights: Weights) -> Wrench {
        Wrench {
            law,
            weights,
            colliding: 0,
            deepest: None,
            force: Vector3::zeros(),
            torque: Vector3::zeros(),
            niceness: None,
            integral: 0.0,
            energy: 0.0,
        }
    }

    /// Adds what is felt of another part, in the same frame and about the same point.
    pub(crate) fn add(&mut self, other: &Wrench) {
        if other.colliding == 0 {
            return;
        }
        self.colliding += other.colliding;
        self.deepest = match (self.deepest, other.deepest) {
            (Some(mine), Some(theirs)) if theirs.depth > mine.depth => Some(theirs),
            (mine, theirs) => mine.or(theirs),
        };
        self.force += other.force;
        self.torque += other.torque;
        self.niceness = match (self.niceness, other.niceness) {
            (Some(mine), Some(theirs)) => Some(mine.min(theirs)),
            (mine, theirs) => mine.or(theirs),
        };
        self.integral += other.integral;
        self.energy += other.energy;
    }

    /// The same in the frame in which its own is at `place`.
    pub(crate) fn turned(mut self, place: &Pose) -> Wrench {
        if self.colliding > 0 && *place != Pose::default() {
            self.force = place.rotation() * self.force;
            self.torque = place.rotation() * self.torque;
            if let Some(deepest) = &mut self.deepest {
                deepest.point = place.tip() + place.rotation() * deepest.point.coords;
            }
        }
        self
    }

    /// Penetration depth of the deepest point; 0 without contact.
    pub fn depth(&self) -> f64 {
        self.deepest.map_or(0.0, |deepest| deepest.depth)
    }
}

/// Sums over eight lanes: each lane adds its points in order, the lanes are added at the end.
struct Sums<S: Simd> {
    /// `Σ w m` and `Σ w m²`.
    pushes: [f64x8<S>; 2],
    /// In the tool's frame: force and torque about the tip.
    tool: [f64x8<S>; 6],
    niceness: f64x8<S>,
    depth: f64x8<S>,
    deepest: f64x8<S>,
}

/// The same sums, lanes added.
struct Totals {
    pushes: [f64; 2],
    tool: [f64; 6],
    niceness: f64,
    /// The deepest, and which candidate it is: the first of several.
    depth: f64,
    deepest: f64,
}

/// Sums what the probe has just felt.
pub(super) fn sum(beside: &Beside<'_>, pose: &Pose) -> Wrench {
    let colliding = beside.felt.count();
    let totals = dispatch!(beside.level, simd => totals(simd, beside, pose));
    let rotation = pose.rotation();
    let half =
        |sums: &[f64; 6], from: usize| Vector3::new(sums[from], sums[from + 1], sums[from + 2]);
    // In the tool's frame lengths are the tool's.
    let force = rotation * half(&totals.tool, 0);
    let about_tip = rotation * (half(&totals.tool, 3) * beside.length);
    let arm = rotation * beside.centre.coords;
    Wrench {
        law: beside.law,
        weights: beside.weights,
        colliding,
        deepest: (totals.depth >= 0.0)
            .then(|| posture::at(beside, pose, totals.deepest as usize, totals.depth)),
        force,
        torque: about_tip - arm.cross(&force),
        niceness: (colliding > 0).then_some(totals.niceness),
        integral: totals.pushes[0],
        energy: totals.pushes[1] / 2.0,
    }
}

// What runs on vectors is in functions that are always inlined: a closure would be compiled without
// the vector instructions of its surroundings.

type Triple<S> = [f64x8<S>; 3];

#[inline(always)]
fn totals<S: Simd>(simd: S, beside: &Beside<'_>, pose: &Pose) -> Totals {
    let zero = f64x8::splat(simd, 0.0);
    let mut sums = Sums {
        pushes: [zero; 2],
        tool: [zero; 6],
        niceness: f64x8::splat(simd, f64::INFINITY),
        depth: f64x8::splat(simd, -1.0),
        deepest: zero,
    };
    for (block, inside) in beside.felt.inside.iter().enumerate() {
        if *inside != 0 {
            add(simd, beside, pose, block, *inside, &mut sums);
        }
    }
    let depth = sums.depth.reduce_max();
    let last = f64x8::splat(simd, f64::INFINITY);
    let deepest = sums.depth.simd_ge(depth).select(sums.deepest, last);
    Totals {
        pushes: [sums.pushes[0].reduce_sum(), sums.pushes[1].reduce_sum()],
        tool: six(&sums.tool),
        niceness: sums.niceness.reduce_min(),
        depth,
        deepest: deepest.reduce_min(),
    }
}

#[inline(always)]
fn six<S: Simd>(sums: &[f64x8<S>; 6]) -> [f64; 6] {
    let mut totals = [0.0; 6];
    for (total, sum) in totals.iter_mut().zip(sums) {
        *total = sum.reduce_sum();
    }
    totals
}

#[inline(always)]
fn load<S: Simd>(simd: S, list: &[f64], block: usize) -> f64x8<S> {
    f64x8::from_slice(simd, &list[block * LANES..(block + 1) * LANES])
}

/// Three lists; 0 where the mask is not set.
#[inline(always)]
fn load_vector<S: Simd>(
    simd: S,
    lists: &[Vec<f64>; 3],
    block: usize,
    mask: mask64x8<S>,
) -> Triple<S> {
    let zero = f64x8::splat(simd, 0.0);
    [
        mask.select(load(simd, &lists[0], block), zero),
        mask.select(load(simd, &lists[1], block), zero),
        mask.select(load(simd, &lists[2], block), zero),
    ]
}

/// Adds one block of points.
#[inline(always)]
fn add<S: Simd>(
    simd: S,
    beside: &Beside<'_>,
    pose: &Pose,
    block: usize,
    inside: u8,
    sums: &mut Sums<S>,
) {
    const COUNT: [f64; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
    let (felt, candidates) = (&beside.felt, &beside.search.candidates);
    let zero = f64x8::splat(simd, 0.0);
    let in_solid = mask64x8::from_bitmask(simd, u64::from(inside));
    let magnitude = in_solid.select(load(simd, &felt.magnitude, block), zero);
    let push = match beside.weights {
        Weights::Area => single(simd, &candidates.weights, block) * beside.tree.weight * magnitude,
        Weights::Unit => magnitude,
    };
    sums.pushes[0] += push;
    sums.pushes[1] += push * magnitude;
    let niceness = sums.niceness.min(load(simd, &felt.niceness, block));
    sums.niceness = in_solid.select(niceness, sums.niceness);
    let depth = load(simd, &felt.depth, block);
    let deeper = in_solid & depth.simd_gt(sums.depth);
    let indices = f64x8::from_slice(simd, &COUNT) + (block * LANES) as f64;
    sums.depth = deeper.select(depth, sums.depth);
    sums.deepest = deeper.select(indices, sums.deepest);

    let p = load_vector(simd, candidates.points.lists(), block, in_solid);
    if beside.law == Law::Gradient {
        let slope = load_vector(simd, &felt.gradient, block, in_solid);
        accumulate(&mut sums.tool, push, p, slope);
        return;
    }
    let direction = load_vector(simd, &felt.direction, block, in_solid);
    let normal = [
        single(simd, &candidates.normals[0], block),
        single(simd, &candidates.normals[1], block),
        single(simd, &candidates.normals[2], block),
    ];
    // The normal in the tool's frame, where the direction is.
    let mut way = direction;
    let mut along = zero;
    for (axis, part) in way.iter_mut().enumerate() {
        let column = pose.rotation().column(axis);
        let turned = normal[0] * column[0] + normal[1] * column[1] + normal[2] * column[2];
        along += turned * *part;
        *part = turned - *part;
    }
    let force = match beside.law {
        Law::Facing => along.simd_le(zero).select(push, zero),
        _ => push,
    };
    accumulate(&mut sums.tool, force, p, way);
}

/// Numbers of single precision.
#[inline(always)]
fn single<S: Simd>(simd: S, list: &[f32], block: usize) -> f64x8<S> {
    let some = &list[block * LANES..(block + 1) * LANES];
    let mut wide = [0.0; LANES];
    for (wide, single) in wide.iter_mut().zip(some) {
        *wide = f64::from(*single);
    }
    f64x8::from_slice(simd, &wide)
}

/// Adds `push · way` and its moment about the origin.
#[inline(always)]
fn accumulate<S: Simd>(sums: &mut [f64x8<S>; 6], push: f64x8<S>, p: Triple<S>, way: Triple<S>) {
    let f = [push * way[0], push * way[1], push * way[2]];
    sums[0] += f[0];
    sums[1] += f[1];
    sums[2] += f[2];
    sums[3] += p[1] * f[2] - p[2] * f[1];
    sums[4] += p[2] * f[0] - p[0] * f[2];
    sums[5] += p[0] * f[1] - p[1] * f[0];
}
