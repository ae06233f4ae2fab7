//! The whole contact as one force and torque (Ho 1999, eq. 5.1 to 5.5).

use super::state::QueryState;
use super::{Deepest, Law, Weights, posture};
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
    /// What of them is rounding.
    pub rounding: Rounding,
}

/// How far rounding can take the force and the torque of a [`Wrench`] from the true sums of what was felt
/// point by point: a bound, not an estimate. `integral` and `energy`, whose terms are all positive, lose no
/// more than `colliding + 6` units of roundoff (2^-53) of themselves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rounding {
    /// The length of the force's error.
    pub force: f64,
    /// The length of the torque's.
    pub torque: f64,
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
            rounding: Rounding::default(),
        }
    }

    /// Adds what is felt of another part, in the same frame and about the same point.
    pub(crate) fn add(&mut self, other: &Wrench) {
        if other.colliding == 0 {
            return;
        }
        if self.colliding == 0 {
            *self = *other;
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
        let one = |mine: f64, theirs: f64, sum: Vector3<f64>| mine + theirs + UNIT * sum.norm();
        self.rounding = Rounding {
            force: one(self.rounding.force, other.rounding.force, self.force),
            torque: one(self.rounding.torque, other.rounding.torque, self.torque),
        };
    }

    /// The same in the frame in which its own is at `place`.
    pub(crate) fn turned(mut self, place: &Pose) -> Wrench {
        if self.colliding > 0 && *place != Pose::default() {
            let turned = |v: Vector3<f64>| (place.rotation() * v, TURNED * UNIT * v.norm());
            let (force, torque) = (turned(self.force), turned(self.torque));
            (self.force, self.torque) = (force.0, torque.0);
            self.rounding.force += force.1;
            self.rounding.torque += torque.1;
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

/// The unit roundoff, widened for products of errors.
const UNIT: f64 = f64::EPSILON / 2.0 * (1.0 + 1e-6);
/// Of a vector that is turned: three products and two sums in each part, whose sizes are those of the row's
/// parts times the vector's.
const TURNED: f64 = 3.0 * 1.733;

/// Sums over eight lanes: each lane adds its points in order, the lanes are added at the end.
struct Sums<S: Simd> {
    /// `Σ w m` and `Σ w m²`.
    pushes: [f64x8<S>; 2],
    /// In the tool's frame: force and torque about the tip.
    tool: [f64x8<S>; 6],
    /// What the parts of all forces are together, without their signs.
    size: f64x8<S>,
    niceness: f64x8<S>,
    depth: f64x8<S>,
    deepest: f64x8<S>,
}

/// The same sums, lanes added.
struct Totals {
    pushes: [f64; 2],
    tool: [f64; 6],
    size: f64,
    /// How many blocks had a point inside.
    blocks: usize,
    niceness: f64,
    /// The deepest, and which candidate it is: the first of several.
    depth: f64,
    deepest: f64,
}

/// Sums the evaluations of the points inside.
pub(super) fn sum(state: &QueryState<'_>, pose: &Pose) -> Wrench {
    let colliding = state.felt.count();
    let totals = dispatch!(state.level, simd => totals(simd, state, pose));
    let rotation = pose.rotation();
    let half =
        |sums: &[f64; 6], from: usize| Vector3::new(sums[from], sums[from + 1], sums[from + 2]);
    // In the tool's frame lengths are the tool's.
    let force = rotation * half(&totals.tool, 0);
    let about_tip = rotation * (half(&totals.tool, 3) * state.length);
    let arm = rotation * state.centre.coords;
    let torque = about_tip - arm.cross(&force);
    Wrench {
        law: state.law,
        weights: state.weights,
        colliding,
        deepest: (totals.depth >= 0.0)
            .then(|| posture::at(state, pose, totals.deepest as usize, totals.depth)),
        force,
        torque,
        niceness: (colliding > 0).then_some(totals.niceness),
        integral: totals.pushes[0],
        energy: totals.pushes[1] / 2.0,
        rounding: rounding(state, &totals, torque),
    }
}

/// Each lane adds a term a block, seven sums at most join the lanes (Higham, *Accuracy and Stability of Numerical
/// Algorithms*, 2002, eq. 4.4). A force is a product of a push, which is two products, and of the
/// difference of a direction and a turned normal, each part of which errs by five units at most where
/// these cancel. A moment is two products and a difference of lengths up to the tool's and such forces.
fn rounding(state: &QueryState<'_>, totals: &Totals, torque: Vector3<f64>) -> Rounding {
    let additions = totals.blocks as f64 + 7.0;
    let terms = 3.0 * totals.size + 9.0 * totals.pushes[0];
    let force = UNIT * ((additions + TURNED) * totals.size + terms);
    let moments = UNIT * ((additions + TURNED + 5.0) * totals.size + terms);
    let arm = state.centre.coords.norm();
    let torque = 2.0 * state.reach * state.length * moments
        + arm * (force + UNIT * 12.0 * totals.size)
        + UNIT * torque.norm();
    Rounding { force, torque }
}

// What runs on vectors is in functions that are always inlined: a closure would be compiled without
// the vector instructions of its surroundings.

type Triple<S> = [f64x8<S>; 3];

#[inline(always)]
fn totals<S: Simd>(simd: S, state: &QueryState<'_>, pose: &Pose) -> Totals {
    let zero = f64x8::splat(simd, 0.0);
    let mut sums = Sums {
        pushes: [zero; 2],
        tool: [zero; 6],
        size: zero,
        niceness: f64x8::splat(simd, f64::INFINITY),
        depth: f64x8::splat(simd, -1.0),
        deepest: zero,
    };
    let mut blocks = 0;
    for (block, inside) in state.felt.inside.iter().enumerate() {
        if *inside != 0 {
            blocks += 1;
            add(simd, state, pose, block, *inside, &mut sums);
        }
    }
    let depth = sums.depth.reduce_max();
    let last = f64x8::splat(simd, f64::INFINITY);
    let deepest = sums.depth.simd_ge(depth).select(sums.deepest, last);
    Totals {
        pushes: [sums.pushes[0].reduce_sum(), sums.pushes[1].reduce_sum()],
        tool: six(&sums.tool),
        size: sums.size.reduce_sum(),
        blocks,
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

/// A block of a list.
#[inline(always)]
fn load<S: Simd>(simd: S, list: &[f64], block: usize) -> f64x8<S> {
    f64x8::from_slice(simd, &list[block * LANES..(block + 1) * LANES])
}

/// A block of a list in `f32`.
#[inline(always)]
fn widen<S: Simd>(simd: S, list: &[f32], block: usize) -> f64x8<S> {
    let mut wide = [0.0; LANES];
    for (wide, single) in wide.iter_mut().zip(&list[block * LANES..(block + 1) * LANES]) {
        *wide = f64::from(*single);
    }
    f64x8::from_slice(simd, &wide)
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
    state: &QueryState<'_>,
    pose: &Pose,
    block: usize,
    inside: u8,
    sums: &mut Sums<S>,
) {
    const COUNT: [f64; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
    let (felt, candidates) = (&state.felt, &state.candidates);
    let zero = f64x8::splat(simd, 0.0);
    let in_solid = mask64x8::from_bitmask(simd, u64::from(inside));
    let magnitude = in_solid.select(load(simd, &felt.magnitude, block), zero);
    let push = match state.weights {
        Weights::Area => widen(simd, &candidates.weights, block) * state.tree.weight * magnitude,
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
    if state.law == Law::Gradient {
        let slope = load_vector(simd, &felt.gradient, block, in_solid);
        accumulate(sums, push, p, slope);
        return;
    }
    let direction = load_vector(simd, &felt.direction, block, in_solid);
    let normal = [
        widen(simd, &candidates.normals[0], block),
        widen(simd, &candidates.normals[1], block),
        widen(simd, &candidates.normals[2], block),
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
    let force = match state.law {
        Law::Facing => along.simd_le(zero).select(push, zero),
        _ => push,
    };
    accumulate(sums, force, p, way);
}

/// Adds `push · way` and its moment about the origin.
#[inline(always)]
fn accumulate<S: Simd>(sums: &mut Sums<S>, push: f64x8<S>, p: Triple<S>, way: Triple<S>) {
    let f = [push * way[0], push * way[1], push * way[2]];
    sums.size += f[0].abs() + f[1].abs() + f[2].abs();
    let sums = &mut sums.tool;
    sums[0] += f[0];
    sums[1] += f[1];
    sums[2] += f[2];
    sums[3] += p[1] * f[2] - p[2] * f[1];
    sums[4] += p[2] * f[0] - p[0] * f[2];
    sums[5] += p[0] * f[1] - p[1] * f[0];
}
