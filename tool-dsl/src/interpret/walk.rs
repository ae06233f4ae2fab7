//! The plan for one point after another.

use super::tape::{perform as block, whole};
use super::{BLOCK, Lanes, OUTPUTS, Operation, Slot};
use crate::checked::CheckedTool;
use crate::expr::{Coord, Id};
use crate::plan::Tree;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Operations in the order in which they are done; the last is what is asked for.
type List = Vec<Slot>;

/// A test, or an owner.
#[derive(Clone, Debug)]
enum Fork {
    Owner(Option<usize>),
    /// Where a curve's operations find its value below 0 (or at 0, if not strict) the walk goes on
    /// at the next place, else at `above`.
    Test {
        curve: usize,
        strict: bool,
        above: usize,
    },
}

/// A tool's plan that does for a point what it needs and no more.
#[derive(Clone, Debug)]
pub struct Walk {
    operations: Vec<Operation>,
    curves: Vec<List>,
    regions: Vec<[List; OUTPUTS - 1]>,
    forks: Vec<Fork>,
}

/// What a walk computes with: numbers, or what knows more of them.
pub trait Value:
    Copy
    + Default
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// A constant.
    fn of(value: f64) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// Whether `a ≤ b` may be, and whether it may not be; of numbers one of the two.
    fn le(a: Self, b: Self) -> [bool; 2];
    /// The same of `a < b`.
    fn lt(a: Self, b: Self) -> [bool; 2];
    /// What lies between two of which it is not known which one counts.
    #[must_use]
    fn either(self, _other: Self) -> Self {
        self
    }

    /// The smaller; `b` where they are equal.
    #[must_use]
    fn min(a: Self, b: Self) -> Self {
        pick(Self::lt(a, b), a, b)
    }

    /// The larger; `b` where they are equal.
    #[must_use]
    fn max(a: Self, b: Self) -> Self {
        pick(Self::lt(b, a), a, b)
    }
}

/// The first where a test succeeds, the second where it fails.
fn pick<V: Value>([yes, no]: [bool; 2], then: V, other: V) -> V {
    match (yes, no) {
        (true, true) => then.either(other),
        (true, false) => then,
        (false, _) => other,
    }
}

impl Value for f64 {
    fn of(value: f64) -> f64 {
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

/// What a walk remembers of a point; kept between calls.
#[derive(Clone, Debug, Default)]
pub struct Scratch<V = f64> {
    values: Vec<V>,
    /// When each value was computed last.
    done: Vec<u32>,
    now: u32,
}

/// What a walk remembers of a block of points; kept between calls.
#[derive(Clone, Debug, Default)]
pub struct Registers {
    values: Vec<Lanes>,
    /// When each was computed last.
    done: Vec<u32>,
    now: u32,
    /// Places of the plan that are still to be gone to, and which lanes go there.
    open: Vec<(usize, u64)>,
}

impl Walk {
    /// The walk of a tool.
    pub fn new(tool: &CheckedTool) -> Walk {
        let graph = &tool.model.graph;
        let slot = |id: &Id| id.index() as Slot;
        let list = |id: Id| graph.needed([id]).iter().map(slot).collect::<List>();
        let mut forks = Vec::new();
        flatten(&tool.plan.owner, &mut forks);
        Walk {
            operations: graph.nodes().iter().map(|node| Operation::of(node, slot)).collect(),
            curves: tool.model.curves.iter().map(|curve| list(curve.value)).collect(),
            regions: tool
                .model
                .regions
                .iter()
                .map(|region| {
                    let roots = region.outputs.roots();
                    std::array::from_fn(|part| list(roots[part]))
                })
                .collect(),
            forks,
        }
    }

    /// Allocates what the walk of a point keeps, so that [`Walk::run`] and [`Walk::felt`] allocate nothing.
    pub fn reserve<V: Value>(&self, scratch: &mut Scratch<V>) {
        scratch.start(self.operations.len());
    }

    /// Allocates what the walk of a block keeps, so that [`Walk::owners`] allocates nothing.
    pub fn reserve_block(&self, registers: &mut Registers) {
        registers.start(self.operations.len());
        // A place of the plan is gone to once a block at most.
        registers.open.reserve(self.forks.len());
    }

    /// Writes as many of a point's first outputs as there are results; all but the owner mean
    /// nothing outside. The point is of the tool's frame, in the file's unit; `length` is the
    /// file's unit of length measured in the part's.
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
                Fork::Owner(owner) => break *owner,
                Fork::Test { curve, strict, above } => {
                    let value = self.value(&self.curves[*curve], point, length, scratch);
                    let [below, _] = below(value, *strict);
                    at = if below { at + 1 } else { *above };
                }
            }
        };
        let Some((first, rest)) = results.split_first_mut() else { return };
        *first = V::of(owner.map_or(-1.0, |owner| owner as f64));
        let Some(owner) = owner else { return };
        self.felt_in(owner, point, length, scratch, rest);
    }

    /// Visits each owner that a point may have whose coordinates are known to lie between ends, `None` outside,
    /// with its depth; and of the tests that were not decided on the way the first, and whether it is below 0.
    pub fn each_owner<V: Value>(
        &self,
        point: [V; 3],
        length: V,
        scratch: &mut Scratch<V>,
        mut visit: impl FnMut(Option<(usize, V)>, Option<(V, bool)>),
    ) {
        scratch.start(self.operations.len());
        let mut open = vec![(0, None)];
        while let Some((at, test)) = open.pop() {
            match &self.forks[at] {
                Fork::Owner(owner) => {
                    let depth = |owner: usize| &self.regions[owner][0];
                    let owner = owner
                        .map(|owner| (owner, self.value(depth(owner), point, length, scratch)));
                    visit(owner, test);
                }
                Fork::Test { curve, strict, above } => {
                    let value = self.value(&self.curves[*curve], point, length, scratch);
                    match below(value, *strict) {
                        [true, true] => {
                            open.push((*above, test.or(Some((value, false)))));
                            open.push((at + 1, test.or(Some((value, true)))));
                        }
                        [true, false] => open.push((at + 1, test)),
                        [false, _] => open.push((*above, test)),
                    }
                }
            }
        }
    }

    /// The owners of the first points of a block: a region's place in the list, -1 outside. Only what
    /// some point needs is computed. It is inlined so that its loops are compiled for the vectors
    /// that the caller has.
    #[inline(always)]
    pub fn owners(
        &self,
        (points, count): ([&Lanes; 3], usize),
        length: f64,
        registers: &mut Registers,
        owners: &mut Lanes,
    ) {
        registers.start(self.operations.len());
        let lanes = whole(count);
        let Registers { values, done, now, open } = registers;
        open.clear();
        open.push((0, u64::MAX >> (64 - lanes)));
        while let Some((at, here)) = open.pop() {
            match &self.forks[at] {
                Fork::Owner(owner) => {
                    let owner = owner.map_or(-1.0, |owner| owner as f64);
                    for (lane, result) in owners[..lanes].iter_mut().enumerate() {
                        if here >> lane & 1 == 1 {
                            *result = owner;
                        }
                    }
                }
                Fork::Test { curve, strict, above } => {
                    let mut value = 0;
                    for &slot in &self.curves[*curve] {
                        value = slot as usize;
                        if done[value] != *now {
                            done[value] = *now;
                            let (before, rest) = values.split_at_mut(value);
                            let operation = &self.operations[value];
                            block(operation, (points, lanes), length, before, &mut rest[0]);
                        }
                    }
                    let mut below = 0;
                    for (lane, value) in values[value][..lanes].iter().enumerate() {
                        let is = if *strict { *value < 0.0 } else { *value <= 0.0 };
                        below |= u64::from(is) << lane;
                    }
                    for (place, lanes) in [(*above, here & !below), (at + 1, here & below)] {
                        if lanes != 0 {
                            open.push((place, lanes));
                        }
                    }
                }
            }
        }
    }

    /// What is felt at a point of a region, as [`Tape::felt`](super::Tape::felt) gives it.
    pub fn felt(
        &self,
        owner: usize,
        point: [f64; 3],
        length: f64,
        scratch: &mut Scratch,
        results: &mut [f64],
    ) {
        scratch.start(self.operations.len());
        self.felt_in(owner, point, length, scratch, results);
    }

    fn felt_in<V: Value>(
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
    /// Forgets the last point.
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
    /// Forgets the last block.
    fn start(&mut self, slots: usize) {
        if self.values.len() < slots || self.now == u32::MAX {
            self.values.resize(slots, [0.0; BLOCK]);
            self.done.clear();
            self.done.resize(self.values.len(), 0);
            self.now = 0;
        }
        self.now += 1;
    }
}

fn flatten(tree: &Tree<Option<usize>>, forks: &mut Vec<Fork>) {
    match tree {
        Tree::Leaf(owner) => forks.push(Fork::Owner(*owner)),
        Tree::Split { curve, strict, below, above } => {
            let at = forks.len();
            forks.push(Fork::Owner(None));
            flatten(below, forks);
            forks[at] = Fork::Test { curve: *curve, strict: *strict, above: forks.len() };
            flatten(above, forks);
        }
    }
}

/// Whether a value may be below 0, or at 0 if not strict, and whether it may not be.
fn below<V: Value>(value: V, strict: bool) -> [bool; 2] {
    if strict { V::lt(value, V::of(0.0)) } else { V::le(value, V::of(0.0)) }
}

#[inline(always)]
fn perform<V: Value>(operation: Operation, [x, y, z]: [V; 3], length: V, values: &[V]) -> V {
    let v = |slot: Slot| values[slot as usize];
    match operation {
        Operation::Const(value) => V::of(value),
        Operation::Coord(Coord::X) => x,
        Operation::Coord(Coord::Y) => y,
        Operation::Coord(Coord::Z) => z,
        Operation::Coord(Coord::Q) => x * x + y * y,
        Operation::Coord(Coord::D) => (x * x + y * y).sqrt(),
        Operation::Coord(Coord::Length) => length,
        Operation::Coord(Coord::PerLength) => V::of(1.0) / length,
        Operation::Neg(a) => -v(a),
        Operation::Add(a, b) => v(a) + v(b),
        Operation::Sub(a, b) => v(a) - v(b),
        Operation::Mul(a, b) => v(a) * v(b),
        Operation::Div(a, b) => v(a) / v(b),
        Operation::Quotient(a, b) => {
            let zero = V::of(0.0);
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
        Operation::Side { value, strict, then, other } => {
            pick(below(v(value), strict), v(then), v(other))
        }
    }
}
