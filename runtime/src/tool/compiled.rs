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
/// unit. All functions but `contains`, `owner` and `clearance` are defined only at points of the solid; elsewhere their
/// results are meaningless. [`Evaluators::evaluate_lanes`] has the same bits as the functions of a single point.
pub trait Evaluators: Copy + Send + Sync + 'static {
    /// Returns the tool's description.
    fn info() -> &'static ToolInfo;

    /// Returns whether a point belongs to the solid, surface included.
    fn contains(point: [f64; 3]) -> bool;
    /// Returns the region that a point belongs to, as an index into the tool's list; `None` outside.
    fn owner(point: [f64; 3]) -> Option<usize>;
    /// Returns the penetration depth, at least 0.
    fn depth(point: [f64; 3]) -> f64;
    /// Returns the magnitude.
    fn magnitude(point: [f64; 3], length: f64) -> f64;
    /// Returns the niceness, at least 0.
    fn niceness(point: [f64; 3]) -> f64;
    /// Returns the unit vector to the surface. On the axis its radial component points along +x. At a centre, where no
    /// direction is nearest, it is +z.
    fn direction(point: [f64; 3]) -> [f64; 3];
    /// Returns the magnitude's gradient with respect to the position in the part's unit.
    fn gradient(point: [f64; 3], length: f64) -> [f64; 3];
    /// Returns the distance from a point outside to the tool, in the file's unit, as specified by [`Tool::clearance`].
    fn clearance(point: [f64; 3]) -> f64;

    /// Returns an enclosure of the evaluation over a box, for a tool without a profile; see [`Tool::enclose`].
    fn enclose(_sides: [Interval; 3], _reference: [f64; 3]) -> Option<EvaluationEnclosure> {
        None
    }

    /// Evaluates the requested outputs in the lanes that are `present` and belong to the solid.
    fn evaluate_lanes<L: Lane>(
        point: [L; 3],
        length: L,
        present: L::Mask,
        outputs: Outputs,
    ) -> LaneEvaluation<L>;
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
        self.inside = self.inside | lanes;
        self.region = L::pick(lanes, region, self.region);
    }
}

impl<T: Evaluators> Tool for T {
    fn info(&self) -> &ToolInfo {
        T::info()
    }

    fn clearance(&self, point: [f64; 3]) -> f64 {
        if T::contains(point) { 0.0 } else { T::clearance(point) }
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
        on_vectors!(level, simd => evaluate_blocks::<T, _>(simd, outputs, points, length, evaluations));
        evaluate_points::<T>(outputs, points, length, evaluations);
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
        on_vectors!(level, simd => evaluate_blocks::<T, _>(simd, O::OUTPUTS, points, length, evaluations));
        evaluate_points::<T>(O::OUTPUTS, points, length, evaluations);
    }
}

#[inline(always)]
fn store_vector<S: Simd>(lists: &mut [Vec<f64>; 3], block: Range<usize>, values: [f64x8<S>; 3]) {
    values[0].store_slice(&mut lists[0][block.clone()]);
    values[1].store_slice(&mut lists[1][block.clone()]);
    values[2].store_slice(&mut lists[2][block]);
}

/// Evaluates the points in blocks of eight. Vector code is kept in functions that are always inlined: a closure would
/// be compiled without the vector instructions of its surroundings.
#[inline(always)]
fn evaluate_blocks<T: Evaluators, S: Simd>(
    simd: S,
    outputs: Outputs,
    points: &PointBatch,
    length: f64,
    evaluations: &mut Evaluations,
) {
    let length = f64x8::splat(simd, length);
    let lists = points.coordinates();
    for index in 0..evaluations.inside.len() {
        let block = index * LANES..(index + 1) * LANES;
        let present = mask64x8::from_bitmask(simd, u64::from(present(points.len(), index)));
        let p = [
            f64x8::from_slice(simd, &lists[0][block.clone()]),
            f64x8::from_slice(simd, &lists[1][block.clone()]),
            f64x8::from_slice(simd, &lists[2][block.clone()]),
        ];
        let evaluation = T::evaluate_lanes(p, length, present, outputs);
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

/// Evaluates the points without vectors, by the functions of a single point.
fn evaluate_points<T: Evaluators>(
    outputs: Outputs,
    points: &PointBatch,
    length: f64,
    evaluations: &mut Evaluations,
) {
    let [x, y, z] = points.coordinates();
    for index in 0..points.len() {
        let p = [x[index], y[index], z[index]];
        if !T::contains(p) {
            continue;
        }
        evaluations.inside[index / LANES] |= 1 << (index % LANES);
        if outputs.depth {
            evaluations.depth[index] = T::depth(p);
        }
        if outputs.magnitude {
            evaluations.magnitude[index] = T::magnitude(p, length);
        }
        if outputs.niceness {
            evaluations.niceness[index] = T::niceness(p);
        }
        if outputs.direction {
            for (list, component) in evaluations.direction.iter_mut().zip(T::direction(p)) {
                list[index] = component;
            }
        }
        if outputs.gradient {
            for (list, component) in evaluations.gradient.iter_mut().zip(T::gradient(p, length)) {
                list[index] = component;
            }
        }
        if outputs.region {
            evaluations.region[index] = T::owner(p).map_or(-1.0, |region| region as f64);
        }
    }
}
