//! Evaluation of the plan for one point at a time.

use super::tape::{Block, perform as perform_on_block};
use super::{BLOCK_POINTS, Lanes, OUTPUT_COUNT, Operation, Slot};
use crate::checked::CheckedTool;
use crate::expr::{Coord, Id};
use crate::plan::Tree;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Operations in the order of evaluation; the last one gives the result.
type List = Vec<Slot>;

/// A test, or an owner.
#[derive(Clone, Debug)]
enum PlanNode {
    Owner(Option<usize>),
    /// If the curve's value is below 0 (or 0, if not strict) the walk continues at the next fork, else at
    /// `above`.
    Test {
        curve: usize,
        strict: bool,
        above: usize,
    },
}

/// A tool's plan in a form that computes only what a point needs.
#[derive(Clone, Debug)]
pub struct PlanEvaluator {
    operations: Vec<Operation>,
    curves: Vec<List>,
    regions: Vec<[List; OUTPUT_COUNT - 1]>,
    forks: Vec<PlanNode>,
}

/// A number type for the walk: doubles, or types that carry more information, such as intervals.
pub trait Value:
    Copy
    + Default
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Returns a constant.
    fn constant(value: f64) -> Self;
    /// Returns the square root.
    fn sqrt(self) -> Self;
    /// Returns the absolute value.
    fn abs(self) -> Self;
    /// Returns whether `a ≤ b` is possible, and whether its negation is possible. For plain numbers exactly
    /// one is true.
    fn le(a: Self, b: Self) -> [bool; 2];
    /// Returns the same for `a < b`.
    fn lt(a: Self, b: Self) -> [bool; 2];
    /// Returns a value that encloses both, for an undecided choice between them.
    #[must_use]
    fn hull(self, _other: Self) -> Self {
        self
    }

    /// Returns the smaller; `b` if they are equal.
    #[must_use]
    fn min(a: Self, b: Self) -> Self {
        pick(Self::lt(a, b), a, b)
    }

    /// Returns the larger; `b` if they are equal.
    #[must_use]
    fn max(a: Self, b: Self) -> Self {
        pick(Self::lt(b, a), a, b)
    }
}

/// Returns `then` if a test holds, `other` if it fails, and an enclosure of both if it is undecided.
fn pick<V: Value>([yes, no]: [bool; 2], then: V, other: V) -> V {
    match (yes, no) {
        (true, true) => then.hull(other),
        (true, false) => then,
        (false, _) => other,
    }
}

impl Value for f64 {
    fn constant(value: f64) -> f64 {
        value
    }
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }
    fn abs(self) -> f64 {
        f64::abs(self)
    }
    fn le(a: f64, b: f64) -> [bool; 2] {
        let is = a <= b;
        [is, !is]
    }
    fn lt(a: f64, b: f64) -> [bool; 2] {
        let is = a < b;
        [is, !is]
    }
}

/// The intermediate values at a point; the memory is kept between calls.
#[derive(Clone, Debug, Default)]
pub struct Scratch<V = f64> {
    values: Vec<V>,
    /// The number of the evaluation that last computed each value.
    done: Vec<u32>,
    now: u32,
}

/// The intermediate values of a block of points; the memory is kept between calls.
#[derive(Clone, Debug, Default)]
pub struct Registers {
    values: Vec<Lanes>,
    /// The number of the evaluation that last computed each value.
    done: Vec<u32>,
    now: u32,
    /// Forks of the plan still to visit, with the lanes that reach them.
    pending: Vec<(usize, u64)>,
}

impl PlanEvaluator {
    /// Makes the evaluator of a tool.
    pub fn new(tool: &CheckedTool) -> PlanEvaluator {
        let graph = &tool.model.graph;
        let slot = |id: &Id| id.index() as Slot;
        let list = |id: Id| graph.dependencies([id]).iter().map(slot).collect::<List>();
        let mut forks = Vec::new();
        flatten(&tool.tree, &mut forks);
        PlanEvaluator {
            operations: graph.nodes().iter().map(|node| Operation::of(node, slot)).collect(),
            curves: tool.model.curves.iter().map(|curve| list(curve.value)).collect(),
            regions: tool
                .model
                .regions
                .iter()
                .map(|region| region.outputs.roots().map(list))
                .collect(),
            forks,
        }
    }

    /// Allocates the memory of a walk for a point, so that [`PlanEvaluator::run`] and [`PlanEvaluator::evaluate`] do
    /// not allocate.
    pub fn reserve<V: Value>(&self, scratch: &mut Scratch<V>) {
        scratch.start(self.operations.len());
    }

    /// Allocates the memory of a walk for a block, so that [`PlanEvaluator::owners`] does not allocate.
    pub fn reserve_block(&self, registers: &mut Registers) {
        registers.start(self.operations.len());
        // The walk visits each fork at most once per block.
        registers.pending.reserve(self.forks.len());
    }

    /// Writes the first `results.len()` outputs at a point. Outside, only the owner is meaningful. The point
    /// is in the tool's frame and the file's unit; `length` is the length of the file's unit in units of the
    /// part.
    pub fn run<V: Value>(
        &self,
        point: [V; 3],
        length: V,
        scratch: &mut Scratch<V>,
        results: &mut [V],
    ) {
        scratch.start(self.operations.len());
        let mut at = 0;
        let owner = loop {
            match &self.forks[at] {
                PlanNode::Owner(owner) => break *owner,
                PlanNode::Test { curve, strict, above } => {
                    let value = self.value(&self.curves[*curve], point, length, scratch);
                    let [below, _] = below(value, *strict);
                    at = if below { at + 1 } else { *above };
                }
            }
        };
        let Some((first, rest)) = results.split_first_mut() else { return };
        *first = V::constant(owner.map_or(-1.0, |owner| owner as f64));
        let Some(owner) = owner else { return };
        self.evaluate_region(owner, point, length, scratch, rest);
    }

    /// Visits every possible owner, with its depth, of a point whose coordinates are known to lie between
    /// bounds; `None` is the outside. Also passes the first test on the path that was undecided, if any, and
    /// whether its value is taken to be below 0.
    pub fn for_each_owner<V: Value>(
        &self,
        point: [V; 3],
        length: V,
        scratch: &mut Scratch<V>,
        mut visit: impl FnMut(Option<(usize, V)>, Option<(V, bool)>),
    ) {
        scratch.start(self.operations.len());
        let mut pending = vec![(0, None)];
        while let Some((at, test)) = pending.pop() {
            match &self.forks[at] {
                PlanNode::Owner(owner) => {
                    let owner = owner.map(|owner| {
                        let depth = &self.regions[owner][0];
                        (owner, self.value(depth, point, length, scratch))
                    });
                    visit(owner, test);
                }
                PlanNode::Test { curve, strict, above } => {
                    let value = self.value(&self.curves[*curve], point, length, scratch);
                    match below(value, *strict) {
                        [true, true] => {
                            pending.push((*above, test.or(Some((value, false)))));
                            pending.push((at + 1, test.or(Some((value, true)))));
                        }
                        [true, false] => pending.push((at + 1, test)),
                        [false, _] => pending.push((*above, test)),
                    }
                }
            }
        }
    }

    /// Writes the owners of the first points of a block: a region's index in the list, -1 outside. Only what
    /// some point needs is computed. The function is inlined so that its loops are compiled for the caller's
    /// vector instructions.
    #[inline(always)]
    pub fn owners(&self, block: Block<'_>, registers: &mut Registers, owners: &mut Lanes) {
        registers.start(self.operations.len());
        let block = block.padded();
        let lanes = block.count;
        let Registers { values, done, now, pending } = registers;
        pending.clear();
        pending.push((0, u64::MAX >> (64 - lanes)));
        while let Some((at, lane_mask)) = pending.pop() {
            match &self.forks[at] {
                PlanNode::Owner(owner) => {
                    let owner = owner.map_or(-1.0, |owner| owner as f64);
                    for (lane, result) in owners[..lanes].iter_mut().enumerate() {
                        if lane_mask >> lane & 1 == 1 {
                            *result = owner;
                        }
                    }
                }
                PlanNode::Test { curve, strict, above } => {
                    let mut value = 0;
                    for &slot in &self.curves[*curve] {
                        value = slot as usize;
                        if done[value] != *now {
                            done[value] = *now;
                            let (before, rest) = values.split_at_mut(value);
                            let operation = &self.operations[value];
                            perform_on_block(operation, block, before, &mut rest[0]);
                        }
                    }
                    let mut below = 0;
                    for (lane, value) in values[value][..lanes].iter().enumerate() {
                        let is = if *strict { *value < 0.0 } else { *value <= 0.0 };
                        below |= u64::from(is) << lane;
                    }
                    for (place, lanes) in
                        [(*above, lane_mask & !below), (at + 1, lane_mask & below)]
                    {
                        if lanes != 0 {
                            pending.push((place, lanes));
                        }
                    }
                }
            }
        }
    }

    /// Evaluates the outputs of a region at a point, in the order of
    /// [`Tape::evaluation`](super::Tape::evaluation).
    pub fn evaluate(
        &self,
        owner: usize,
        point: [f64; 3],
        length: f64,
        scratch: &mut Scratch,
        results: &mut [f64],
    ) {
        scratch.start(self.operations.len());
        self.evaluate_region(owner, point, length, scratch, results);
    }

    fn evaluate_region<V: Value>(
        &self,
        owner: usize,
        point: [V; 3],
        length: V,
        scratch: &mut Scratch<V>,
        results: &mut [V],
    ) {
        for (result, list) in results.iter_mut().zip(&self.regions[owner]) {
            *result = self.value(list, point, length, scratch);
        }
    }

    fn value<V: Value>(&self, list: &List, p: [V; 3], length: V, scratch: &mut Scratch<V>) -> V {
        let mut last = V::default();
        for &slot in list {
            let slot = slot as usize;
            if scratch.done[slot] != scratch.now {
                scratch.done[slot] = scratch.now;
                scratch.values[slot] = perform(self.operations[slot], p, length, &scratch.values);
            }
            last = scratch.values[slot];
        }
        last
    }
}

impl<V: Value> Scratch<V> {
    /// Invalidates the values of the last point.
    fn start(&mut self, slots: usize) {
        if self.values.len() < slots || self.now == u32::MAX {
            self.values.resize(slots, V::default());
            self.done.clear();
            self.done.resize(self.values.len(), 0);
            self.now = 0;
        }
        self.now += 1;
    }
}

impl Registers {
    /// Invalidates the values of the last block.
    fn start(&mut self, slots: usize) {
        if self.values.len() < slots || self.now == u32::MAX {
            self.values.resize(slots, [0.0; BLOCK_POINTS]);
            self.done.clear();
            self.done.resize(self.values.len(), 0);
            self.now = 0;
        }
        self.now += 1;
    }
}

fn flatten(tree: &Tree, forks: &mut Vec<PlanNode>) {
    match tree {
        Tree::Leaf(owner) => forks.push(PlanNode::Owner(*owner)),
        Tree::Split { curve, strict, below, above } => {
            let at = forks.len();
            forks.push(PlanNode::Owner(None));
            flatten(below, forks);
            forks[at] = PlanNode::Test { curve: *curve, strict: *strict, above: forks.len() };
            flatten(above, forks);
        }
    }
}

/// Returns whether a value may be below 0 (or 0, if not strict), and whether it may not be.
fn below<V: Value>(value: V, strict: bool) -> [bool; 2] {
    if strict { V::lt(value, V::constant(0.0)) } else { V::le(value, V::constant(0.0)) }
}

#[inline(always)]
fn perform<V: Value>(operation: Operation, [x, y, z]: [V; 3], length: V, values: &[V]) -> V {
    let v = |slot: Slot| values[slot as usize];
    match operation {
        Operation::Const(value) => V::constant(value),
        Operation::Coord(Coord::X) => x,
        Operation::Coord(Coord::Y) => y,
        Operation::Coord(Coord::Z) => z,
        Operation::Coord(Coord::Q) => x * x + y * y,
        Operation::Coord(Coord::D) => (x * x + y * y).sqrt(),
        Operation::Coord(Coord::Length) => length,
        Operation::Coord(Coord::PerLength) => V::constant(1.0) / length,
        Operation::Neg(a) => -v(a),
        Operation::Add(a, b) => v(a) + v(b),
        Operation::Sub(a, b) => v(a) - v(b),
        Operation::Mul(a, b) => v(a) * v(b),
        Operation::Div(a, b) => v(a) / v(b),
        Operation::Quotient(a, b) => {
            let zero = V::constant(0.0);
            let ([below, away], [above, beyond]) = (V::le(v(b), zero), V::le(zero, v(b)));
            let is_zero = [below && above, away || beyond];
            if is_zero == [true, false] { zero } else { pick(is_zero, zero, v(a) / v(b)) }
        }
        Operation::Min(a, b) => V::min(v(a), v(b)),
        Operation::Max(a, b) => V::max(v(a), v(b)),
        Operation::Abs(a) => v(a).abs(),
        Operation::Sqrt(a) => v(a).sqrt(),
        Operation::Select { low, high, then, other } => {
            pick(V::le(v(low), v(high)), v(then), v(other))
        }
    }
}
