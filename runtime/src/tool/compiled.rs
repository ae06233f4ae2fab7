//! Tools that the macros compile.

use super::{
    BatchEvaluator, Derivatives, Dual, EvaluationEnclosure, Evaluations, LANES, Lane,
    OutputSelection, Outputs, PointBatch, Tool, ToolInfo, on_vectors, present,
};
use crate::interval::Interval;
use fearless_simd::{Level, Simd, SimdBase, SimdMask, f64x8, mask64x8};
use std::ops::Range;

/// The evaluators of a compiled tool. Implemented by the macros, not by hand.
///
/// Points are finite, in the tool's frame and the file's unit. `length` is the length of the file's unit in the part's
/// unit.
pub trait Evaluators: Copy + Send + Sync + 'static {
    /// Returns the tool's description.
    fn info() -> &'static ToolInfo;

    /// Evaluates the requested outputs in the lanes that are `present` and belong to the solid. Every type of lane
    /// gives the same bits.
    fn evaluate_lanes<L: Lane>(
        point: [L; 3],
        length: L,
        present: L::Mask,
        outputs: Outputs,
    ) -> LaneEvaluation<L>;

    /// Returns an enclosure of the evaluation over a box, for a tool without a profile; see [`Tool::enclose`].
    fn enclose(_sides: [Interval; 3], _reference: [f64; 3]) -> Option<EvaluationEnclosure> {
        None
    }

    /// Returns whether a point belongs to the solid, surface included.
    #[inline]
    fn contains(point: [f64; 3]) -> bool {
        Self::evaluate_lanes(point, 1.0, true, Outputs::INSIDE).inside
    }

    /// Returns the evaluation at a point; `None` outside.
    fn evaluate_point(point: [f64; 3], length: f64) -> Option<PointEvaluation> {
        let lane = Self::evaluate_lanes(point, length, true, Outputs::EVERYTHING);
        lane.inside.then_some(PointEvaluation {
            region: lane.region as usize,
            depth: lane.depth,
            magnitude: lane.magnitude,
            niceness: lane.niceness,
            direction: lane.direction,
            gradient: lane.gradient,
        })
    }
}

/// The evaluation at a point of the solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointEvaluation {
    /// The region that the point belongs to, as an index into the tool's list.
    pub region: usize,
    /// Penetration depth, at least 0, in the file's unit.
    pub depth: f64,
    /// Magnitude: in the part's unit if it is the depth, otherwise the file's own number.
    pub magnitude: f64,
    /// Niceness, at least 0.
    pub niceness: f64,
    /// Unit vector to the nearest surface, in the tool's frame. On the axis its radial component points along +x. At a
    /// centre, where no direction is nearest, it is +z.
    pub direction: [f64; 3],
    /// Gradient of the magnitude with respect to the position in the part's unit, in the tool's frame.
    pub gradient: [f64; 3],
}

/// The evaluation at points side by side. Lanes that are not inside, and outputs that were not requested, are
/// meaningless.
#[derive(Clone, Copy, Debug)]
#[expect(missing_docs, reason = "as in Evaluations")]
pub struct LaneEvaluation<L: Lane> {
    pub inside: L::Mask,
    pub depth: L,
    pub magnitude: L,
    pub niceness: L,
    pub direction: [L; 3],
    pub gradient: [L; 3],
    pub region: L,
}

impl<L: Lane> LaneEvaluation<L> {
    /// Returns an evaluation in which no lane is inside.
    #[inline(always)]
    pub fn none(like: L, none: L::Mask) -> LaneEvaluation<L> {
        let zero = like.none();
        LaneEvaluation {
            inside: none,
            depth: zero,
            magnitude: zero,
            niceness: zero,
            direction: [zero; 3],
            gradient: [zero; 3],
            region: zero,
        }
    }

    /// Marks some lanes as inside a region.
    #[inline(always)]
    pub fn assign(&mut self, lanes: L::Mask, region: L) {
        self.inside |= lanes;
        self.region = L::pick(lanes, region, self.region);
    }

    /// Sets the depth of some lanes.
    #[inline(always)]
    pub fn set_depth(&mut self, lanes: L::Mask, depth: L) {
        self.depth = L::select(lanes, depth, self.depth);
    }

    /// Sets the magnitude of some lanes.
    #[inline(always)]
    pub fn set_magnitude(&mut self, lanes: L::Mask, magnitude: L) {
        self.magnitude = L::select(lanes, magnitude, self.magnitude);
    }

    /// Sets the niceness of some lanes.
    #[inline(always)]
    pub fn set_niceness(&mut self, lanes: L::Mask, niceness: L) {
        self.niceness = L::select(lanes, niceness, self.niceness);
    }

    /// Sets the direction of some lanes.
    #[inline(always)]
    pub fn set_direction(&mut self, lanes: L::Mask, direction: [L; 3]) {
        self.direction = selected(lanes, direction, self.direction);
    }

    /// Sets the gradient of some lanes.
    #[inline(always)]
    pub fn set_gradient(&mut self, lanes: L::Mask, gradient: [L; 3]) {
        self.gradient = selected(lanes, gradient, self.gradient);
    }
}

#[inline(always)]
fn selected<L: Lane>(lanes: L::Mask, [x, y, z]: [L; 3], before: [L; 3]) -> [L; 3] {
    let [x_before, y_before, z_before] = before;
    [L::select(lanes, x, x_before), L::select(lanes, y, y_before), L::select(lanes, z, z_before)]
}

impl<T: Evaluators> Tool for T {
    fn info(&self) -> &ToolInfo {
        T::info()
    }

    fn evaluate(
        &self,
        level: Level,
        outputs: Outputs,
        points: &PointBatch,
        length: f64,
        evaluations: &mut Evaluations,
    ) {
        evaluations.reserve(points, outputs);
        on_vectors!(level, simd => evaluate_blocks(
            simd, outputs, points, length, evaluations,
            #[inline(always)]
            |point, length, present, outputs| T::evaluate_lanes(point, length, present, outputs),
        ));
        evaluate_points(outputs, points, length, evaluations, T::evaluate_lanes);
    }

    fn enclose(
        &self,
        sides: [Interval; 3],
        at: [f64; 3],
        _: &mut Evaluations,
    ) -> Option<EvaluationEnclosure> {
        T::enclose(sides, at)
    }

    fn derivatives(&self, point: [f64; 3], length: f64, _: &mut Evaluations) -> Derivatives {
        // The derivatives are the slopes of these two, so nothing else has to be evaluated.
        let outputs = Outputs { direction: true, gradient: true, ..Outputs::INSIDE };
        let evaluation =
            T::evaluate_lanes(Dual::point(point), Dual::constant(length), true, outputs);
        Derivatives::of(evaluation.direction, evaluation.gradient, length)
    }
}

impl<T: Evaluators> BatchEvaluator for T {
    fn evaluate_outputs<O: OutputSelection>(
        &self,
        level: Level,
        points: &PointBatch,
        length: f64,
        evaluations: &mut Evaluations,
    ) {
        evaluations.reserve(points, O::OUTPUTS);
        on_vectors!(level, simd => evaluate_blocks(
            simd, O::OUTPUTS, points, length, evaluations,
            #[inline(always)]
            |point, length, present, outputs| T::evaluate_lanes(point, length, present, outputs),
        ));
        evaluate_points(O::OUTPUTS, points, length, evaluations, T::evaluate_lanes);
    }
}

#[inline(always)]
fn store_vector<S: Simd>(lists: &mut [Vec<f64>; 3], block: Range<usize>, values: [f64x8<S>; 3]) {
    values[0].store_slice(&mut lists[0][block.clone()]);
    values[1].store_slice(&mut lists[1][block.clone()]);
    values[2].store_slice(&mut lists[2][block]);
}

/// Evaluates the points in blocks of eight. Vector code is kept in functions that are always inlined: others are compiled without
/// the vector instructions of their surroundings, each operation as a call. So must `evaluate` be: a closure that is always
/// inlined, and not the name of a function, since the call through a name is never forced inline.
#[inline(always)]
pub(super) fn evaluate_blocks<S: Simd>(
    simd: S,
    outputs: Outputs,
    points: &PointBatch,
    length: f64,
    evaluations: &mut Evaluations,
    mut evaluate: impl FnMut([f64x8<S>; 3], f64x8<S>, mask64x8<S>, Outputs) -> LaneEvaluation<f64x8<S>>,
) {
    let length = f64x8::splat(simd, length);
    let lists = points.coordinates();
    for index in 0..evaluations.inside.len() {
        let block = index * LANES..(index + 1) * LANES;
        // Padding must not count as inside, whatever numbers it holds.
        let present = mask64x8::from_bitmask(simd, u64::from(present(points.len(), index)));
        let p = [
            f64x8::from_slice(simd, &lists[0][block.clone()]),
            f64x8::from_slice(simd, &lists[1][block.clone()]),
            f64x8::from_slice(simd, &lists[2][block.clone()]),
        ];
        let evaluation = evaluate(p, length, present, outputs);
        evaluations.inside[index] = evaluation.inside.to_bitmask() as u8;
        if outputs.depth {
            evaluation.depth.store_slice(&mut evaluations.depth[block.clone()]);
        }
        if outputs.magnitude {
            evaluation.magnitude.store_slice(&mut evaluations.magnitude[block.clone()]);
        }
        if outputs.niceness {
            evaluation.niceness.store_slice(&mut evaluations.niceness[block.clone()]);
        }
        if outputs.direction {
            store_vector(&mut evaluations.direction, block.clone(), evaluation.direction);
        }
        if outputs.gradient {
            store_vector(&mut evaluations.gradient, block.clone(), evaluation.gradient);
        }
        if outputs.region {
            evaluation.region.store_slice(&mut evaluations.region[block]);
        }
    }
}

/// Evaluates the points one by one, without vectors.
pub(super) fn evaluate_points(
    outputs: Outputs,
    points: &PointBatch,
    length: f64,
    evaluations: &mut Evaluations,
    mut evaluate: impl FnMut([f64; 3], f64, bool, Outputs) -> LaneEvaluation<f64>,
) {
    let [x, y, z] = points.coordinates();
    for index in 0..points.len() {
        let evaluation = evaluate([x[index], y[index], z[index]], length, true, outputs);
        if !evaluation.inside {
            continue;
        }
        evaluations.inside[index / LANES] |= 1 << (index % LANES);
        if outputs.depth {
            evaluations.depth[index] = evaluation.depth;
        }
        if outputs.magnitude {
            evaluations.magnitude[index] = evaluation.magnitude;
        }
        if outputs.niceness {
            evaluations.niceness[index] = evaluation.niceness;
        }
        if outputs.direction {
            for (list, part) in evaluations.direction.iter_mut().zip(evaluation.direction) {
                list[index] = part;
            }
        }
        if outputs.gradient {
            for (list, part) in evaluations.gradient.iter_mut().zip(evaluation.gradient) {
                list[index] = part;
            }
        }
        if outputs.region {
            evaluations.region[index] = evaluation.region;
        }
    }
}
