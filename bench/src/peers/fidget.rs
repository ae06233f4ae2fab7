//! The tool as an implicit surface in `fidget`, compiled to machine code at run time.
//!
//! The method follows fidget's own way of working. Interval evaluation rules out nodes of a tree over the cloud. All
//! points of the remaining leaves are evaluated in one slice, and the gradient in a second slice of the points inside.
//! The function is the tool's magnitude as minima and maxima; its direction is `−∇m/|∇m|`. fidget computes in `f32`, so
//! points are transformed to the tool's frame in `f64` first. The tape is not simplified per node: for so short a tape,
//! compiling a shorter one takes longer than evaluating all points.

use super::points::{Bounds, Tree};
use crate::race::contender::{Answer, Contender, PoseTransform, Sums};
use fidget::context::Tree as Formula;
use fidget::eval::{BulkEvaluator, Function, MathFunction, Tape, TracingEvaluator};
use fidget::jit::{JitFloatSliceEval, JitFunction, JitGradSliceEval, JitIntervalEval};
use fidget::types::{Grad, Interval};
use fidget::var::Var;
use touchoff::{Cloud, Pose};

/// Points per leaf; sizes from 16 to 128 were tried at 20,000 points.
const LEAF: usize = 32;

/// Assumed bound on the single-precision error of the magnitude, mm.
const MARGIN: f32 = 1e-4;

type TapeOf<E> = <E as BulkEvaluator>::Tape;

/// The indices of x, y and z among a tape's arguments.
type ArgumentIndices = [usize; 3];

/// The formula as machine code, and a tree of the points.
pub struct Fidget {
    tree: Tree<Bounds>,
    interval: (JitIntervalEval, <JitIntervalEval as TracingEvaluator>::Tape, ArgumentIndices),
    values: (JitFloatSliceEval, TapeOf<JitFloatSliceEval>, ArgumentIndices),
    slopes: (JitGradSliceEval, TapeOf<JitGradSliceEval>, ArgumentIndices),
    candidates: Vec<usize>,
    arms: Vec<[[f64; 3]; 2]>,
    at: [Vec<f32>; 3],
    hits: Vec<usize>,
    hits_at: [Vec<Grad>; 3],
}

impl Fidget {
    /// Compiles the formula and builds the tree of a cloud.
    ///
    /// # Panics
    /// Never: the formula contains all three coordinates.
    pub fn new(cloud: &Cloud) -> Fidget {
        let mut context = fidget::Context::new();
        let node = context.import(&magnitude());
        let function = JitFunction::new(&context, &[node]).expect("a formula of x, y and z");
        let interval = function.interval_tape(Default::default());
        let values = function.float_slice_tape(Default::default());
        let slopes = function.grad_slice_tape(Default::default());
        let (a, b, c) =
            (argument_indices(&interval), argument_indices(&values), argument_indices(&slopes));
        Fidget {
            tree: Tree::new(cloud, LEAF, |bounds, _| bounds),
            interval: (JitIntervalEval::default(), interval, a),
            values: (JitFloatSliceEval::default(), values, b),
            slopes: (JitGradSliceEval::default(), slopes, c),
            candidates: Vec::new(),
            arms: Vec::new(),
            at: Default::default(),
            hits: Vec::new(),
            hits_at: Default::default(),
        }
    }

    /// Collects the points of the leaves that the tool may touch, in the tool's frame.
    fn gather(&mut self, transform: &PoseTransform) {
        let (eval, tape, indices) = &mut self.interval;
        let (points, leaves) = self.tree.leaves(|bounds| {
            let centre = transform.to_tool_frame(transform.offset_from_tip(bounds.centre));
            let half = transform.box_half_extents(bounds.half);
            let mut sides = [Interval::from(0.0); 3];
            for axis in 0..3 {
                let [low, high] = [-1.0, 1.0].map(|sign| (centre[axis] + sign * half[axis]) as f32);
                sides[indices[axis]] = Interval::new(low, high);
            }
            let (range, _) = eval.eval(tape, &sides).expect("three arguments");
            range[0].upper() >= -MARGIN
        });
        self.candidates.clear();
        self.arms.clear();
        self.at.iter_mut().for_each(Vec::clear);
        for index in leaves.flatten() {
            let offset = transform.offset_from_tip(points[index].position);
            let p = transform.to_tool_frame(offset);
            self.candidates.push(index);
            self.arms.push([offset, p]);
            for (coordinate, index) in p.iter().zip(self.values.2) {
                self.at[index].push(*coordinate as f32);
            }
        }
    }
}

/// Returns the indices of x, y and z among a tape's arguments.
fn argument_indices(tape: &impl Tape) -> ArgumentIndices {
    [Var::X, Var::Y, Var::Z].map(|var| tape.vars().get(&var).expect("the formula has all three"))
}

/// Returns [`super::formula::magnitude`] as a fidget expression.
fn magnitude() -> Formula {
    let (x, y, axial) = Formula::axes();
    let z = super::formula::TIP as f32 - axial;
    let squared = x.square() + y.square();
    let d = squared.sqrt();
    let above = (z.clone() - 19.0).max(0.0);
    let housing = 14.0 - d.min(3.0) - z.clone();
    let spindle = (3.0 - d.clone()).min(16.0 - d.clone() - z.clone() + (1.0 - d.clone()).max(0.0));
    let cutter = 1.0 - (squared + above.square()).sqrt();
    z.min(5.0 - d).min(housing.max(spindle).max(cutter))
}

impl Contender for Fidget {
    fn name(&self) -> &'static str {
        "fidget"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let transform = PoseTransform::of(pose);
        self.gather(&transform);
        let mut sums = Sums::default();
        if self.candidates.is_empty() {
            return sums.answer(&transform);
        }
        let (eval, tape, _) = &mut self.values;
        let values = eval.eval(tape, &self.at).expect("lists of one length");
        self.hits.clear();
        let inside_indices = values[0].iter().enumerate().filter(|(_, value)| **value >= 0.0);
        self.hits.extend(inside_indices.map(|(index, _)| index));
        if self.hits.is_empty() {
            return sums.answer(&transform);
        }
        let (eval, tape, indices) = &mut self.slopes;
        for (axis, index) in indices.iter().enumerate() {
            let mut unit = [0.0; 3];
            unit[axis] = 1.0;
            let list = &mut self.hits_at[*index];
            list.clear();
            let coordinate = |hit: &usize| self.at[self.values.2[axis]][*hit];
            let grad = |hit| Grad::new(coordinate(hit), unit[0], unit[1], unit[2]);
            list.extend(self.hits.iter().map(grad));
        }
        let slopes = eval.eval(tape, &self.hits_at).expect("lists of one length");
        for (hit, slope) in self.hits.iter().zip(&slopes[0]) {
            let descent = [slope.dx, slope.dy, slope.dz].map(|c| -f64::from(c));
            let length = crate::race::contender::dot(descent, descent).sqrt();
            // On the axis the gradient has no radial part.
            let direction =
                if length > 0.0 { descent.map(|c| c / length) } else { [1.0, 0.0, 0.0] };
            let point = &self.tree.points()[self.candidates[*hit]];
            let evaluation = (f64::from(slope.v), direction);
            sums.add(self.arms[*hit], (point.weight, point.normal), evaluation);
        }
        sums.answer(&transform)
    }
}
