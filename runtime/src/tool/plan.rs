//! Evaluation of a tool's plan on any type of lane: what generated code does, operation by operation, without a compiler.
//!
//! A point, eight points or a box descends the tree of tests from its root. Where lanes go both ways one of the ways is put off.
//! At a leaf the outputs of its region are computed, and selected for the lanes that arrived. No value depends on the way to it,
//! so each is computed once, when it is first needed.

use super::enclosure::Ternary;
use super::{Dual, Enclosure, Lane, LaneEvaluation, Outputs};
use fearless_simd::{Simd, SimdBase, SimdMask, f64x8, mask64x8};
use std::collections::{HashMap, HashSet};
use touchoff_dsl::CheckedTool;
use touchoff_dsl::expr::{Coord, Id, Node};
use touchoff_dsl::formula::Side;
use touchoff_dsl::plan::Tree;

/// A value of the evaluation.
#[derive(Clone, Copy)]
enum Operand {
    Constant(f64),
    /// One of x, y, z and the length of the file's unit.
    Given(usize),
    /// The index of a value in memory.
    Value(usize),
}

#[derive(Clone, Copy)]
enum Operation {
    /// The coordinates that are computed: `x² + y²`, its root and the reciprocal of the length of the file's unit.
    Square,
    Distance,
    PerLength,
    Neg(Operand),
    Add(Operand, Operand),
    Sub(Operand, Operand),
    Mul(Operand, Operand),
    Div(Operand, Operand),
    Quotient(Operand, Operand),
    Min(Operand, Operand),
    Max(Operand, Operand),
    Abs(Operand),
    Sqrt(Operand),
    /// The third where the first is at most the second, else the fourth.
    Select([Operand; 4]),
}

/// Operations in the order of their evaluation, each with the index of its result.
type Steps = Box<[(usize, Operation)]>;

/// A test of the tree, or its result.
enum Fork {
    Owner(Option<usize>),
    /// A test of `left ≤ right`, or `left < right` if strict. The descent continues at the next fork where it holds, elsewhere at `above`.
    Test {
        /// Operations that the sides need and no test before has taken.
        steps: Steps,
        sides: [Operand; 2],
        strict: bool,
        above: usize,
    },
}

/// Some outputs of a region, with the steps that they need.
struct OutputPlan<const N: usize> {
    steps: Steps,
    values: [Operand; N],
}

/// The outputs of a region.
struct RegionPlan {
    depth: OutputPlan<1>,
    magnitude: OutputPlan<1>,
    niceness: OutputPlan<1>,
    direction: OutputPlan<3>,
    gradient: OutputPlan<3>,
}

/// A tool's evaluator as data.
pub(super) struct Plan {
    forks: Vec<Fork>,
    regions: Vec<RegionPlan>,
    /// The number of values in memory.
    count: usize,
}

impl Plan {
    /// Lists the operations of a tool.
    pub(super) fn new(tool: &CheckedTool) -> Plan {
        let mut lister = Lister { tool, indices: HashMap::new(), forks: Vec::new() };
        lister.list(&tool.tree, &mut HashSet::new());
        let regions = tool.model.regions.iter().map(|region| {
            let outputs = &region.outputs;
            RegionPlan {
                depth: lister.output([outputs.depth]),
                magnitude: lister.output([outputs.magnitude]),
                niceness: lister.output([outputs.niceness]),
                direction: lister.output(outputs.direction),
                gradient: lister.output(outputs.gradient),
            }
        });
        let regions = regions.collect();
        Plan { regions, count: lister.indices.len(), forks: lister.forks }
    }

    /// Allocates the memory of an evaluation.
    pub(super) fn reserve<V: Copy + Default, M>(&self, memory: &mut Memory<V, M>) {
        memory.start(self.count);
        // At most one side of each test is put off.
        memory.pending.reserve(self.forks.len());
    }

    /// Evaluates the requested outputs in the lanes that are `present`, as
    /// [`Evaluators::evaluate_lanes`](super::Evaluators::evaluate_lanes) does. The function is inlined so that it is compiled for the
    /// caller's vector instructions.
    #[inline(always)]
    pub(super) fn evaluate_lanes<L: Register>(
        &self,
        point: [L; 3],
        length: L,
        present: L::Mask,
        outputs: Outputs,
        memory: &mut Memory<L::Value, L::Kept>,
    ) -> LaneEvaluation<L> {
        memory.start(self.count);
        let none = present & !present;
        let mut result = LaneEvaluation::none(length, none);
        // Leaves outside take their lanes away; a box may reach several of these.
        result.inside = present;
        let mut has_owner = false;
        let mut lanes = present;
        let mut at = 0;
        let [x, y, z] = point;
        let mut walk = Walk { given: [x, y, z, length], memory };
        loop {
            match &self.forks[at] {
                Fork::Test { steps, sides: [left, right], strict, above } => {
                    walk.compute(steps);
                    let (left, right) = (walk.get(*left), walk.get(*right));
                    let test = if *strict { L::lt(left, right) } else { L::le(left, right) };
                    let (yes, no) = (lanes & test, lanes & !test);
                    if !L::any(yes) {
                        (at, lanes) = (*above, no);
                        continue;
                    }
                    if L::any(no) {
                        walk.memory.pending.push((*above, L::keep(no)));
                    }
                    (at, lanes) = (at + 1, yes);
                    continue;
                }
                Fork::Owner(None) => result.inside = result.inside & !lanes,
                Fork::Owner(Some(region)) => {
                    has_owner = true;
                    result.assign(lanes, length.of(*region as f64));
                    walk.set(&self.regions[*region], lanes, outputs, &mut result);
                }
            }
            let Some((next, kept)) = walk.memory.pending.pop() else { break };
            (at, lanes) = (next, length.mask(kept));
        }
        if !has_owner {
            result.inside = none;
        }
        result
    }
}

/// A writer of a plan.
struct Lister<'t> {
    tool: &'t CheckedTool,
    /// The place of each computed node in memory.
    indices: HashMap<Id, usize>,
    forks: Vec<Fork>,
}

impl Lister<'_> {
    /// Lists the forks of a tree, given which nodes have been computed on the way to it.
    fn list(&mut self, tree: &Tree, computed: &mut HashSet<Id>) {
        let Tree::Split { curve, strict, below, above } = tree else {
            let Tree::Leaf(owner) = tree else { return };
            return self.forks.push(Fork::Owner(*owner));
        };
        let model = &self.tool.model;
        let sides = model.curves[*curve].sides(&model.graph);
        let mut needed = model.graph.dependencies(sides.iter().filter_map(Side::node));
        needed.retain(|id| computed.insert(*id));
        let steps = self.steps(&needed);
        let sides = sides.map(|side| match side {
            Side::Node(id) => self.operand(id),
            Side::Constant(value) => Operand::Constant(value),
        });
        let at = self.forks.len();
        self.forks.push(Fork::Owner(None));
        self.list(below, computed);
        let next = self.forks.len();
        self.list(above, computed);
        needed.iter().for_each(|id| _ = computed.remove(id));
        self.forks[at] = Fork::Test { steps, sides, strict: *strict, above: next };
    }

    fn output<const N: usize>(&mut self, roots: [Id; N]) -> OutputPlan<N> {
        let steps = self.steps(&self.tool.model.graph.dependencies(roots));
        OutputPlan { steps, values: roots.map(|id| self.operand(id)) }
    }

    /// Returns the operations of some nodes, which come after their operands.
    fn steps(&mut self, nodes: &[Id]) -> Steps {
        let steps = nodes.iter().filter_map(|id| {
            let Operand::Value(index) = self.operand(*id) else { return None };
            Some((index, self.operation(*id)?))
        });
        steps.collect()
    }

    fn operand(&mut self, id: Id) -> Operand {
        match self.tool.model.graph.node(id) {
            Node::Const(value) => Operand::Constant(value.to_f64()),
            Node::Coord(Coord::X) => Operand::Given(0),
            Node::Coord(Coord::Y) => Operand::Given(1),
            Node::Coord(Coord::Z) => Operand::Given(2),
            Node::Coord(Coord::Length) => Operand::Given(3),
            _ => {
                let next = self.indices.len();
                Operand::Value(*self.indices.entry(id).or_insert(next))
            }
        }
    }

    fn operation(&mut self, id: Id) -> Option<Operation> {
        let graph = &self.tool.model.graph;
        let mut v = |id: &Id| self.operand(*id);
        Some(match graph.node(id) {
            Node::Coord(Coord::Q) => Operation::Square,
            Node::Coord(Coord::D) => Operation::Distance,
            Node::Coord(Coord::PerLength) => Operation::PerLength,
            Node::Const(_) | Node::Coord(_) => return None,
            Node::Neg(a) => Operation::Neg(v(a)),
            Node::Add(a, b) => Operation::Add(v(a), v(b)),
            Node::Sub(a, b) => Operation::Sub(v(a), v(b)),
            Node::Mul(a, b) => Operation::Mul(v(a), v(b)),
            Node::Div(a, b) => Operation::Div(v(a), v(b)),
            Node::Quotient(a, b) => Operation::Quotient(v(a), v(b)),
            Node::Min(a, b) => Operation::Min(v(a), v(b)),
            Node::Max(a, b) => Operation::Max(v(a), v(b)),
            Node::Abs(a) => Operation::Abs(v(a)),
            Node::Sqrt(a) => Operation::Sqrt(v(a)),
            Node::Select { low, high, then, other } => {
                Operation::Select([low, high, then, other].map(v))
            }
        })
    }
}

/// A lane that is kept in memory between operations. The memory's type does not name the vector instructions.
pub(super) trait Register: Lane {
    /// A lane in memory.
    type Value: Copy + Default;
    /// A mask in memory.
    type Kept: Copy;
    fn store(self) -> Self::Value;
    fn load(self, value: &Self::Value) -> Self;
    fn keep(mask: Self::Mask) -> Self::Kept;
    fn mask(self, kept: Self::Kept) -> Self::Mask;
}

macro_rules! kept_as_it_is {
    ($lane:ty, $mask:ty) => {
        impl Register for $lane {
            type Value = $lane;
            type Kept = $mask;
            fn store(self) -> $lane {
                self
            }
            fn load(self, value: &$lane) -> $lane {
                *value
            }
            fn keep(mask: $mask) -> $mask {
                mask
            }
            fn mask(self, kept: $mask) -> $mask {
                kept
            }
        }
    };
}

kept_as_it_is!(f64, bool);
kept_as_it_is!(Dual, bool);
kept_as_it_is!(Enclosure, Ternary);

/// Eight lanes in memory, aligned as the widest vector is.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(super) struct Eight([f64; 8]);

impl<S: Simd> Register for f64x8<S> {
    type Value = Eight;
    type Kept = u8;

    #[inline(always)]
    fn store(self) -> Eight {
        Eight(self.into())
    }
    #[inline(always)]
    fn load(self, value: &Eight) -> Self {
        f64x8::from_slice(self.simd, &value.0)
    }
    #[inline(always)]
    fn keep(mask: mask64x8<S>) -> u8 {
        mask.to_bitmask() as u8
    }
    #[inline(always)]
    fn mask(self, kept: u8) -> mask64x8<S> {
        mask64x8::from_bitmask(self.simd, u64::from(kept))
    }
}

/// The values of an evaluation; the memory is kept between calls.
#[derive(Clone, Debug)]
pub(super) struct Memory<V, M> {
    values: Vec<V>,
    /// The number of the evaluation that last computed each value.
    computed: Vec<u32>,
    now: u32,
    /// Forks still to descend from, with their lanes.
    pending: Vec<(usize, M)>,
}

impl<V, M> Default for Memory<V, M> {
    fn default() -> Memory<V, M> {
        Memory { values: Vec::new(), computed: Vec::new(), now: 0, pending: Vec::new() }
    }
}

impl<V: Copy + Default, M> Memory<V, M> {
    /// Invalidates the values of the last evaluation.
    #[inline(always)]
    fn start(&mut self, count: usize) {
        if self.values.len() < count || self.now == u32::MAX {
            self.values.resize(count.max(self.values.len()), V::default());
            self.computed.clear();
            self.computed.resize(self.values.len(), 0);
            self.now = 0;
        }
        self.now += 1;
    }
}

/// An evaluation in progress.
struct Walk<'a, L: Register> {
    /// x, y, z and the length of the file's unit.
    given: [L; 4],
    memory: &'a mut Memory<L::Value, L::Kept>,
}

impl<L: Register> Walk<'_, L> {
    /// Takes those steps that have not been taken.
    #[inline(always)]
    fn compute(&mut self, steps: &Steps) {
        for (index, operation) in steps {
            if self.memory.computed[*index] != self.memory.now {
                self.memory.computed[*index] = self.memory.now;
                self.memory.values[*index] = self.perform(operation).store();
            }
        }
    }

    #[inline(always)]
    fn output<const N: usize>(&mut self, plan: &OutputPlan<N>) -> [L; N] {
        self.compute(&plan.steps);
        let mut values = [self.given[3]; N];
        for (value, operand) in values.iter_mut().zip(&plan.values) {
            *value = self.get(*operand);
        }
        values
    }

    /// Sets the requested outputs of the lanes in a region.
    #[inline(always)]
    fn set(
        &mut self,
        region: &RegionPlan,
        lanes: L::Mask,
        outputs: Outputs,
        result: &mut LaneEvaluation<L>,
    ) {
        if outputs.depth {
            let [depth] = self.output(&region.depth);
            result.set_depth(lanes, depth);
        }
        if outputs.magnitude {
            let [magnitude] = self.output(&region.magnitude);
            result.set_magnitude(lanes, magnitude);
        }
        if outputs.niceness {
            let [niceness] = self.output(&region.niceness);
            result.set_niceness(lanes, niceness);
        }
        if outputs.direction {
            result.set_direction(lanes, self.output(&region.direction));
        }
        if outputs.gradient {
            result.set_gradient(lanes, self.output(&region.gradient));
        }
    }

    #[inline(always)]
    fn get(&self, operand: Operand) -> L {
        match operand {
            Operand::Constant(value) => self.given[3].of(value),
            Operand::Given(index) => self.given[index],
            Operand::Value(index) => self.given[3].load(&self.memory.values[index]),
        }
    }

    #[inline(always)]
    fn perform(&self, operation: &Operation) -> L {
        let [x, y, _, length] = self.given;
        match *operation {
            Operation::Square => x * x + y * y,
            Operation::Distance => (x * x + y * y).sqrt(),
            Operation::PerLength => length.of(1.0) / length,
            Operation::Neg(a) => -self.get(a),
            Operation::Add(a, b) => self.get(a) + self.get(b),
            Operation::Sub(a, b) => self.get(a) - self.get(b),
            Operation::Mul(a, b) => self.get(a) * self.get(b),
            Operation::Div(a, b) => self.get(a) / self.get(b),
            Operation::Quotient(a, b) => L::quotient(self.get(a), self.get(b)),
            Operation::Min(a, b) => L::min(self.get(a), self.get(b)),
            Operation::Max(a, b) => L::max(self.get(a), self.get(b)),
            Operation::Abs(a) => self.get(a).abs(),
            Operation::Sqrt(a) => self.get(a).sqrt(),
            Operation::Select([low, high, then, other]) => {
                L::select(L::le(self.get(low), self.get(high)), self.get(then), self.get(other))
            }
        }
    }
}
