//! The whole contact as one force and torque (Ho 1999, eq. 5.1 to 5.5), and the derivative of that wrench with respect to
//! the tool's pose.

use crate::bvh::LaneVector;
use crate::pose::Pose;
use crate::probe::contacts::{DeepestPoint, deepest_point};
use crate::probe::state::QueryState;
use crate::probe::{Everything, Law, Probe, Weights};
use crate::tool::{BatchEvaluator, LANES, Tool};
use fearless_simd::{Select, Simd, SimdBase, SimdMask, dispatch, f64x8, mask64x8};
use nalgebra::{Matrix3, Matrix6, Vector3};

/// The wrench on a tool at a pose. Force and torque act on the tool and are given in the world's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Wrench {
    /// The force law.
    pub law: Law,
    /// The weights of points.
    pub weights: Weights,
    /// Number of points of the part inside the tool.
    pub colliding: usize,
    /// The deepest point.
    pub deepest: Option<DeepestPoint>,
    /// Force, in magnitude times weight.
    pub force: Vector3<f64>,
    /// Torque about the compliance centre, in force times the part's unit of length.
    pub torque: Vector3<f64>,
    /// The least niceness of all points inside; `None` without contact.
    pub niceness: Option<f64>,
    /// The sum `Σ w m` of weight times magnitude.
    pub integral: f64,
    /// The energy `½ Σ w m²`.
    pub energy: f64,
    /// Bounds on the rounding errors of force and torque.
    pub rounding: WrenchRounding,
}

/// Bounds on the distance of the force and the torque of a [`Wrench`] from the exact sums of the computed evaluations.
/// They are bounds, not estimates. `integral` and `energy`, whose terms are all positive, have a relative error of at
/// most `colliding + 6` units of roundoff (2^-53).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct WrenchRounding {
    /// Upper bound on the length of the force's error.
    pub force: f64,
    /// Upper bound on the length of the torque's error.
    pub torque: f64,
}

impl Wrench {
    /// Returns the wrench without contact.
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
            rounding: WrenchRounding::default(),
        }
    }

    /// Adds the wrench of another part, in the same frame and about the same point.
    pub(crate) fn add(&mut self, other: &Wrench) {
        // A sum with nothing keeps its bits, the law and the weights included.
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
        let sum_error =
            |mine: f64, theirs: f64, sum: Vector3<f64>| mine + theirs + UNIT_ROUNDOFF * sum.norm();
        self.rounding = WrenchRounding {
            force: sum_error(self.rounding.force, other.rounding.force, self.force),
            torque: sum_error(self.rounding.torque, other.rounding.torque, self.torque),
        };
    }

    /// Transforms the wrench from its own frame to the frame in which its own is at `frame`.
    pub(crate) fn turned(mut self, frame: &Pose) -> Wrench {
        if self.colliding > 0 && *frame != Pose::default() {
            let error = ROTATION_ERROR_FACTOR * UNIT_ROUNDOFF;
            self.rounding.force += error * self.force.norm();
            self.rounding.torque += error * self.torque.norm();
            self.force = frame.rotation() * self.force;
            self.torque = frame.rotation() * self.torque;
            if let Some(deepest) = &mut self.deepest {
                deepest.point = frame.tip() + frame.rotation() * deepest.point.coords;
            }
        }
        self
    }

    /// Returns the penetration depth of the deepest point; 0 without contact.
    pub fn depth(&self) -> f64 {
        self.deepest.map_or(0.0, |deepest| deepest.depth)
    }
}

/// The unit roundoff, slightly enlarged to cover products of errors.
const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0 * (1.0 + 1e-6);
/// The error of a rotated vector, in units of roundoff of its length: each component is the sum of three products,
/// whose sizes are the row's entries times the vector's components.
const ROTATION_ERROR_FACTOR: f64 = 3.0 * 1.733;

/// Sums in eight lanes: each lane adds its points in order; the lanes are added at the end.
struct Sums<S: Simd> {
    /// `Σ w m` and `Σ w m²`.
    weighted_sums: [f64x8<S>; 2],
    /// Force and torque about the tip, in the tool's frame.
    tool: [f64x8<S>; 6],
    /// The sum of the absolute values of all force components.
    abs_sum: f64x8<S>,
    niceness: f64x8<S>,
    depth: f64x8<S>,
    deepest: f64x8<S>,
}

/// The same sums, with the lanes added.
struct Totals {
    weighted_sums: [f64; 2],
    tool: [f64; 6],
    abs_sum: f64,
    /// Number of blocks with a point inside.
    blocks: usize,
    niceness: f64,
    /// The largest depth, and the index of its candidate, the first one if several are equally deep.
    depth: f64,
    deepest: f64,
}

impl QueryState<'_> {
    /// Sums the evaluations of the points inside.
    pub(super) fn reduce(&self, pose: &Pose) -> Wrench {
        let colliding = self.evaluations.count();
        let totals = dispatch!(self.level, simd => totals(simd, self, pose));
        let rotation = pose.rotation();
        let [fx, fy, fz, mx, my, mz] = totals.tool;
        let force = rotation * Vector3::new(fx, fy, fz);
        // In the tool's frame, lengths are in the tool's unit.
        let torque_about_tip = rotation * (Vector3::new(mx, my, mz) * self.length);
        let arm = rotation * self.centre.coords;
        let torque = torque_about_tip - arm.cross(&force);
        Wrench {
            law: self.law,
            weights: self.weights,
            colliding,
            deepest: (totals.depth >= 0.0)
                .then(|| deepest_point(self, pose, totals.deepest as usize, totals.depth)),
            force,
            torque,
            niceness: (colliding > 0).then_some(totals.niceness),
            integral: totals.weighted_sums[0],
            energy: totals.weighted_sums[1] / 2.0,
            rounding: rounding(self, &totals, torque),
        }
    }
}

/// Returns bounds on the rounding errors of force and torque.
///
/// Each lane adds one term per block, and at most seven additions join the lanes (Higham, *Accuracy and Stability of
/// Numerical Algorithms*, 2002, eq. 4.4). The weighted magnitude of a force is made of two products. Its vector is the
/// difference of a direction and a rotated normal, each component of which errs by at most five units of roundoff where
/// the two cancel. A moment is the difference of two products of lengths, up to the tool's size, and such forces.
fn rounding(state: &QueryState<'_>, totals: &Totals, torque: Vector3<f64>) -> WrenchRounding {
    let additions = totals.blocks as f64 + 7.0;
    let terms = 3.0 * totals.abs_sum + 9.0 * totals.weighted_sums[0];
    let force = UNIT_ROUNDOFF * ((additions + ROTATION_ERROR_FACTOR) * totals.abs_sum + terms);
    let moments =
        UNIT_ROUNDOFF * ((additions + ROTATION_ERROR_FACTOR + 5.0) * totals.abs_sum + terms);
    let arm = state.centre.coords.norm();
    let torque = 2.0 * state.tool_size * state.length * moments
        + arm * (force + UNIT_ROUNDOFF * 12.0 * totals.abs_sum)
        + UNIT_ROUNDOFF * torque.norm();
    WrenchRounding { force, torque }
}

// Vector code is kept in functions that are always inlined: a closure would be compiled without the vector instructions
// of its surroundings.

#[inline(always)]
fn totals<S: Simd>(simd: S, state: &QueryState<'_>, pose: &Pose) -> Totals {
    let zero = f64x8::splat(simd, 0.0);
    let mut sums = Sums {
        weighted_sums: [zero; 2],
        tool: [zero; 6],
        abs_sum: zero,
        niceness: f64x8::splat(simd, f64::INFINITY),
        depth: f64x8::splat(simd, -1.0),
        deepest: zero,
    };
    let mut blocks = 0;
    for (block, inside) in state.evaluations.inside.iter().enumerate() {
        if *inside != 0 {
            blocks += 1;
            add(simd, state, pose, block, *inside, &mut sums);
        }
    }
    let depth = sums.depth.reduce_max();
    // The first of equally deep points: the least index in any lane, as if the points were taken one by one.
    let last = f64x8::splat(simd, f64::INFINITY);
    let deepest = sums.depth.simd_ge(depth).select(sums.deepest, last);
    Totals {
        weighted_sums: [sums.weighted_sums[0].reduce_sum(), sums.weighted_sums[1].reduce_sum()],
        tool: reduce_six(&sums.tool),
        abs_sum: sums.abs_sum.reduce_sum(),
        blocks,
        niceness: sums.niceness.reduce_min(),
        depth,
        deepest: deepest.reduce_min(),
    }
}

#[inline(always)]
fn reduce_six<S: Simd>(sums: &[f64x8<S>; 6]) -> [f64; 6] {
    let mut totals = [0.0; 6];
    for (total, sum) in totals.iter_mut().zip(sums) {
        *total = sum.reduce_sum();
    }
    totals
}

/// Loads one block of a list.
#[inline(always)]
fn load<S: Simd>(simd: S, list: &[f64], block: usize) -> f64x8<S> {
    f64x8::from_slice(simd, &list[block * LANES..(block + 1) * LANES])
}

/// Loads one block of a list in `f32`.
#[inline(always)]
fn widen<S: Simd>(simd: S, list: &[f32], block: usize) -> f64x8<S> {
    let mut wide = [0.0; LANES];
    for (wide, single) in wide.iter_mut().zip(&list[block * LANES..(block + 1) * LANES]) {
        *wide = f64::from(*single);
    }
    f64x8::from_slice(simd, &wide)
}

/// Loads one block of three lists; 0 where the mask is not set.
#[inline(always)]
fn load_vector<S: Simd>(
    simd: S,
    lists: &[Vec<f64>; 3],
    block: usize,
    mask: mask64x8<S>,
) -> LaneVector<f64x8<S>> {
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
    const LANE_INDICES: [f64; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
    let (evaluations, candidates) = (&state.evaluations, &state.candidates);
    let zero = f64x8::splat(simd, 0.0);
    let in_solid = mask64x8::from_bitmask(simd, u64::from(inside));
    let magnitude = in_solid.select(load(simd, &evaluations.magnitude, block), zero);
    let weighted_magnitude = match state.weights {
        Weights::Area => widen(simd, &candidates.weights, block) * state.tree.weight * magnitude,
        Weights::Unit => magnitude,
    };
    sums.weighted_sums[0] += weighted_magnitude;
    sums.weighted_sums[1] += weighted_magnitude * magnitude;
    let niceness = sums.niceness.min(load(simd, &evaluations.niceness, block));
    sums.niceness = in_solid.select(niceness, sums.niceness);
    let depth = load(simd, &evaluations.depth, block);
    // Lanes outside hold meaningless depths.
    let deeper = in_solid & depth.simd_gt(sums.depth);
    let indices = f64x8::from_slice(simd, &LANE_INDICES) + (block * LANES) as f64;
    sums.depth = deeper.select(depth, sums.depth);
    sums.deepest = deeper.select(indices, sums.deepest);

    let p = load_vector(simd, candidates.points.lists(), block, in_solid);
    if state.law == Law::Gradient {
        let slope = load_vector(simd, &evaluations.gradient, block, in_solid);
        accumulate(sums, weighted_magnitude, p, slope);
        return;
    }
    let direction = load_vector(simd, &evaluations.direction, block, in_solid);
    let normal = [
        widen(simd, &candidates.normals[0], block),
        widen(simd, &candidates.normals[1], block),
        widen(simd, &candidates.normals[2], block),
    ];
    // The normal is transformed to the tool's frame, in which the direction is given.
    let mut direction_sum = direction;
    let mut facing = zero;
    for (axis, part) in direction_sum.iter_mut().enumerate() {
        let column = pose.rotation().column(axis);
        let turned = normal[0] * column[0] + normal[1] * column[1] + normal[2] * column[2];
        facing += turned * *part;
        *part = turned - *part;
    }
    let force = match state.law {
        // A point whose normal faces the way out of the tool lies on the far side of a thin sheet.
        Law::Facing => facing.simd_le(zero).select(weighted_magnitude, zero),
        _ => weighted_magnitude,
    };
    accumulate(sums, force, p, direction_sum);
}

/// Adds the force `push · way` and its moment about the origin.
#[inline(always)]
fn accumulate<S: Simd>(
    sums: &mut Sums<S>,
    weighted_magnitude: f64x8<S>,
    p: LaneVector<f64x8<S>>,
    direction_sum: LaneVector<f64x8<S>>,
) {
    let f = [
        weighted_magnitude * direction_sum[0],
        weighted_magnitude * direction_sum[1],
        weighted_magnitude * direction_sum[2],
    ];
    sums.abs_sum += f[0].abs() + f[1].abs() + f[2].abs();
    let sums = &mut sums.tool;
    sums[0] += f[0];
    sums[1] += f[1];
    sums[2] += f[2];
    sums[3] += p[1] * f[2] - p[2] * f[1];
    sums[4] += p[2] * f[0] - p[0] * f[2];
    sums[5] += p[0] * f[1] - p[1] * f[0];
}

/// A wrench, and its derivative with respect to the tool's pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffness {
    /// The wrench at the pose.
    pub wrench: Wrench,
    /// The matrix `K`. As the tool moves by a small `u` and rotates by a small `θ` about its compliance centre, both in
    /// the world's frame, its force grows by the first three components of `-K (u, θ)` and its torque by the last
    /// three. The four blocks are in force per unit of length (the part's), force per radian, torque per unit of length
    /// and torque per radian.
    ///
    /// A point that enters the tool contributes nothing at first, since its magnitude is 0 at the surface. Torque is
    /// about a centre that moves with the tool. In a contact that exerts force, only the first three rows and columns
    /// are therefore symmetric, and these only for [`Law::Gradient`].
    pub matrix: Matrix6<f64>,
}

impl<T: BatchEvaluator + ?Sized> Probe<'_, T> {
    /// Returns the wrench and its derivative with respect to the pose. The derivative of each point inside is taken by
    /// the chain rule through the tool's own evaluators ([`Tool::derivatives`]), so it is exact up to rounding, except
    /// on borders between regions.
    pub fn stiffness(&mut self, pose: &Pose) -> Stiffness {
        if !self.state.set_pose(pose) {
            return self.zero_stiffness();
        }
        self.state.traverse(usize::MAX);
        self.state.filter(true);
        if !self.state.evaluate::<Everything, T>(&self.tool) {
            return self.zero_stiffness();
        }
        let wrench = self.state.reduce(pose);
        Stiffness { wrench, matrix: self.state.matrix(&*self.tool, pose) }
    }

    /// Returns the stiffness without contact.
    fn zero_stiffness(&self) -> Stiffness {
        Stiffness { wrench: self.zero_wrench(), matrix: Matrix6::zeros() }
    }
}

impl QueryState<'_> {
    /// Sums the derivatives over all points inside, in the tool's frame, and rotates the sum to the world's frame at
    /// the end.
    ///
    /// Let `p` be the point in the tool's frame and `r` the arm from the centre to it. A force `f = R φ(p)` changes by
    /// `θ × f - A (u + θ × r)`, where `A = R Dφ Rᵀ`. For a force along `n - R u`, in which the part's normal `n` does
    /// not rotate with the tool, the first term is `θ × f'` instead, where `f'` is the tool's share of the force. The
    /// arm changes by `-u`.
    fn matrix<T: Tool + ?Sized>(&mut self, tool: &T, pose: &Pose) -> Matrix6<f64> {
        let rotation = pose.rotation();
        // The tool needs it while the evaluations of this state are read.
        let mut scratch = std::mem::take(&mut self.scratch);
        let mut sum = StiffnessSum::default();
        for candidate in self.evaluations.inside_indices() {
            let index = self.candidates.indices()[candidate] as usize;
            let weight = match self.weights {
                Weights::Area => self.tree.weight(index),
                Weights::Unit => 1.0,
            };
            let vector =
                |lists: &[Vec<f64>; 3]| Vector3::from(lists.each_ref().map(|list| list[candidate]));
            let position = vector(self.candidates.points.lists());
            // The centre is in the part's unit, the candidates are in the tool's.
            let arm = position * self.length - self.centre.coords;
            let magnitude = self.evaluations.magnitude[candidate];
            let gradient = vector(&self.evaluations.gradient);
            let derivatives = tool.derivatives(position.into(), self.length, &mut scratch);
            let gradient_row = gradient.transpose();
            if self.law == Law::Gradient {
                let block = weight
                    * (gradient * gradient_row + magnitude * matrix_of(derivatives.gradient));
                let force = weight * magnitude * gradient;
                sum.add(block, arm, force, force);
                continue;
            }
            let direction = vector(&self.evaluations.direction);
            let normal = rotation.tr_mul(&Vector3::from(self.tree.normal(index)));
            // Such a point exerts no force, nor does it after a small displacement.
            if self.law == Law::Facing && normal.dot(&direction) > 0.0 {
                continue;
            }
            let relative = normal - direction;
            let block =
                weight * (relative * gradient_row - magnitude * matrix_of(derivatives.direction));
            let weighted_magnitude = weight * magnitude;
            sum.add(block, arm, weighted_magnitude * relative, -weighted_magnitude * direction);
        }
        self.scratch = scratch;
        sum.rotated(rotation)
    }
}

fn matrix_of(rows: [[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| rows[row][column])
}

/// The four blocks of the matrix, in the tool's frame.
#[derive(Default)]
struct StiffnessSum {
    force: [Matrix3<f64>; 2],
    torque: [Matrix3<f64>; 2],
}

impl StiffnessSum {
    /// Adds a force at an arm, given its derivative `block` with respect to the position and the share `moment` of it that
    /// rotates with the tool.
    fn add(
        &mut self,
        block: Matrix3<f64>,
        arm: Vector3<f64>,
        force: Vector3<f64>,
        moment: Vector3<f64>,
    ) {
        let (arm, moment) = (arm.cross_matrix(), moment.cross_matrix());
        // A rotation `θ` moves the point by `θ × arm`, and turns the share of the force that turns with the tool.
        let by_rotation = moment - block * arm;
        self.force[0] += block;
        self.force[1] += by_rotation;
        // The torque `arm × force`: the arm shortens by what the tool moves.
        self.torque[0] += arm * block - force.cross_matrix();
        self.torque[1] += arm * by_rotation;
    }

    fn rotated(&self, rotation: &Matrix3<f64>) -> Matrix6<f64> {
        let mut matrix = Matrix6::zeros();
        for (row, blocks) in [&self.force, &self.torque].into_iter().enumerate() {
            for (column, block) in blocks.iter().enumerate() {
                let rotated = rotation * block * rotation.transpose();
                matrix.fixed_view_mut::<3, 3>(3 * row, 3 * column).copy_from(&rotated);
            }
        }
        matrix
    }
}
