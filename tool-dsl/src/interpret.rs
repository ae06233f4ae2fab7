//! The interpreter: a checked tool without Rust's compiler.
//!
//! Two ways to ask. [`Interpreter::at`] follows the text's own rule, region by region in the order
//! of the list, and is the reference for everything that is generated. [`Tape`] is the plan as a
//! list of operations, each done for a block of points before the next, for tools that are loaded
//! at run time. Both perform the operations of the generated code, one rounding each: the tape has
//! its bits everywhere, the reference but for corners, where a test that the plan left out because
//! it cannot fail would fail by rounding (within an ulp of the tool's size).

use crate::Checked;
use crate::expr::value::{At, Evaluator, max, min, quotient};
use crate::expr::{Coord, Id, Node};
use crate::formula::CurveIndex;
use crate::model::Outputs;
use crate::plan::Tree;
use std::collections::HashMap;

/// What is felt at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Felt {
    /// The region's place in the list.
    pub region: usize,
    /// Penetration depth in the file's unit.
    pub depth: f64,
    /// Magnitude.
    pub magnitude: f64,
    /// Unit vector to the surface.
    pub direction: [f64; 3],
    /// The magnitude's gradient.
    pub gradient: [f64; 3],
    /// Niceness.
    pub niceness: f64,
}

/// Evaluates a tool point by point.
#[derive(Clone, Debug)]
pub struct Interpreter<'t> {
    tool: &'t Checked,
    evaluator: Evaluator<'t>,
}

impl<'t> Interpreter<'t> {
    /// An interpreter of a tool.
    pub fn new(tool: &'t Checked) -> Interpreter<'t> {
        let model = &tool.model;
        let roots = model
            .regions
            .iter()
            .flat_map(|region| roots(&region.outputs))
            .chain(model.curves.iter().map(|curve| curve.value));
        Interpreter { tool, evaluator: Evaluator::new(&model.graph, roots) }
    }

    /// What is felt at a point of the tool's frame, in the file's unit; `None` outside.
    /// `length` is the file's unit of length measured in the part's.
    pub fn at(&mut self, [x, y, z]: [f64; 3], length: f64) -> Option<Felt> {
        self.evaluator.set(At { length, ..At::point(x, y, z) });
        let model = &self.tool.model;
        let value = |curve: CurveIndex| self.evaluator.get(model.curves[curve].value);
        let region = model.regions.iter().position(|region| region.inside.holds(&value))?;
        let get = |id: Id| self.evaluator.get(id);
        let outputs = &model.regions[region].outputs;
        Some(Felt {
            region,
            depth: get(outputs.depth),
            magnitude: get(outputs.magnitude),
            direction: outputs.direction.map(get),
            gradient: outputs.gradient.map(get),
            niceness: get(outputs.niceness),
        })
    }
}

/// The expressions that evaluators compute, in the order of a tape's outputs behind the owner.
pub(crate) fn roots(outputs: &Outputs) -> Vec<Id> {
    let mut roots = vec![outputs.depth, outputs.magnitude, outputs.niceness];
    roots.extend(outputs.direction);
    roots.extend(outputs.gradient);
    roots
}

/// How many points a tape does at a time.
pub const BLOCK: usize = 64;

/// The numbers of a block of points.
pub type Lanes = [f64; BLOCK];

/// How many numbers a tape can compute for a point: owner (-1 outside), depth, magnitude, niceness,
/// direction, gradient.
pub const OUTPUTS: usize = 10;

/// Where an operation finds an operand.
type Slot = u32;

#[derive(Clone, Copy, Debug)]
enum Operation {
    Const(f64),
    Coord(Coord),
    Neg(Slot),
    Add(Slot, Slot),
    Sub(Slot, Slot),
    Mul(Slot, Slot),
    Div(Slot, Slot),
    Quotient(Slot, Slot),
    Min(Slot, Slot),
    Max(Slot, Slot),
    Abs(Slot),
    Sqrt(Slot),
    Select {
        low: Slot,
        high: Slot,
        then: Slot,
        other: Slot,
    },
    /// `then` where `value < 0`, or `≤ 0` if not strict.
    Side {
        value: Slot,
        strict: bool,
        then: Slot,
        other: Slot,
    },
}

/// A tool's plan as a list of operations over blocks of points.
#[derive(Clone, Debug)]
pub struct Tape {
    operations: Vec<Operation>,
    /// Where each output is found, and how much of the tape it needs.
    outputs: Vec<(Slot, usize)>,
}

impl Tape {
    /// The tape of a tool.
    pub fn new(tool: &Checked) -> Tape {
        let mut writer = TapeWriter { tool, operations: Vec::new(), slots: HashMap::new() };
        let owner = writer.owner(&tool.plan.owner);
        let mut outputs = vec![(owner, writer.operations.len()); OUTPUTS];
        for (part, output) in outputs.iter_mut().enumerate().skip(1) {
            let tree = tool.plan.owner.map(&|owner: &Option<usize>| {
                owner.map(|region| roots(&tool.model.regions[region].outputs)[part - 1])
            });
            let slot = tree.map_or(owner, |tree| writer.tree(&tree));
            *output = (slot, writer.operations.len());
        }
        Tape { operations: writer.operations, outputs }
    }

    /// The tape of the distance from points outside to the tool, its only output.
    pub fn outside(tool: &Checked) -> Tape {
        let mut writer = TapeWriter { tool, operations: Vec::new(), slots: HashMap::new() };
        let slot = writer.tree(&tool.plan.outside);
        Tape { outputs: vec![(slot, writer.operations.len())], operations: writer.operations }
    }

    /// Evaluates as many of the first outputs as there are results, at least one, at a block of points of the tool's frame, in the
    /// file's unit; `length` is the file's unit of length measured in the part's. Outputs of
    /// points outside, but for the owner, mean nothing. `registers` are kept between calls.
    pub fn run(
        &self,
        points: [&Lanes; 3],
        length: f64,
        registers: &mut Vec<Lanes>,
        results: &mut [Lanes],
    ) {
        let wanted = results.len().min(self.outputs.len());
        let Some((_, end)) = self.outputs[..wanted].last() else { return };
        registers.resize(self.operations.len(), [0.0; BLOCK]);
        for (at, operation) in self.operations[..*end].iter().enumerate() {
            let (done, rest) = registers.split_at_mut(at);
            if let Some(result) = rest.first_mut() {
                perform(operation, points, length, done, result);
            }
        }
        for (result, (slot, _)) in results.iter_mut().zip(&self.outputs) {
            *result = registers[*slot as usize];
        }
    }
}

fn perform(operation: &Operation, p: [&Lanes; 3], length: f64, done: &[Lanes], result: &mut Lanes) {
    let v = |slot: Slot| &done[slot as usize];
    let mut one = |a: Slot, f: fn(f64) -> f64| {
        for (r, a) in result.iter_mut().zip(v(a)) {
            *r = f(*a);
        }
    };
    match *operation {
        Operation::Neg(a) => return one(a, |a| -a),
        Operation::Abs(a) => return one(a, f64::abs),
        Operation::Sqrt(a) => return one(a, f64::sqrt),
        _ => {}
    }
    let mut two = |a: Slot, b: Slot, f: fn(f64, f64) -> f64| {
        for ((r, a), b) in result.iter_mut().zip(v(a)).zip(v(b)) {
            *r = f(*a, *b);
        }
    };
    match *operation {
        Operation::Add(a, b) => two(a, b, |a, b| a + b),
        Operation::Sub(a, b) => two(a, b, |a, b| a - b),
        Operation::Mul(a, b) => two(a, b, |a, b| a * b),
        Operation::Div(a, b) => two(a, b, |a, b| a / b),
        Operation::Quotient(a, b) => two(a, b, quotient),
        Operation::Min(a, b) => two(a, b, min),
        Operation::Max(a, b) => two(a, b, max),
        Operation::Const(value) => *result = [value; BLOCK],
        Operation::Coord(Coord::X) => *result = *p[0],
        Operation::Coord(Coord::Y) => *result = *p[1],
        Operation::Coord(Coord::Z) => *result = *p[2],
        Operation::Coord(Coord::Length) => *result = [length; BLOCK],
        Operation::Coord(Coord::PerLength) => *result = [1.0 / length; BLOCK],
        Operation::Coord(coord @ (Coord::Q | Coord::D)) => {
            for ((r, x), y) in result.iter_mut().zip(p[0]).zip(p[1]) {
                let q = x * x + y * y;
                *r = if coord == Coord::Q { q } else { q.sqrt() };
            }
        }
        Operation::Select { low, high, then, other } => {
            for (i, r) in result.iter_mut().enumerate() {
                *r = if v(low)[i] <= v(high)[i] { v(then)[i] } else { v(other)[i] };
            }
        }
        Operation::Side { value, strict, then, other } => {
            for (i, r) in result.iter_mut().enumerate() {
                let value = v(value)[i];
                let below = if strict { value < 0.0 } else { value <= 0.0 };
                *r = if below { v(then)[i] } else { v(other)[i] };
            }
        }
        Operation::Neg(_) | Operation::Abs(_) | Operation::Sqrt(_) => {}
    }
}

struct TapeWriter<'t> {
    tool: &'t Checked,
    operations: Vec<Operation>,
    slots: HashMap<Id, Slot>,
}

impl TapeWriter<'_> {
    fn put(&mut self, operation: Operation) -> Slot {
        self.operations.push(operation);
        (self.operations.len() - 1) as Slot
    }

    fn expression(&mut self, root: Id) -> Slot {
        for id in self.tool.model.graph.needed([root]) {
            if self.slots.contains_key(&id) {
                continue;
            }
            let s = |id: &Id| self.slots[id];
            let operation = match self.tool.model.graph.node(id) {
                Node::Const(value) => Operation::Const(value.to_f64()),
                Node::Coord(coord) => Operation::Coord(*coord),
                Node::Neg(a) => Operation::Neg(s(a)),
                Node::Add(a, b) => Operation::Add(s(a), s(b)),
                Node::Sub(a, b) => Operation::Sub(s(a), s(b)),
                Node::Mul(a, b) => Operation::Mul(s(a), s(b)),
                Node::Div(a, b) => Operation::Div(s(a), s(b)),
                Node::Quotient(a, b) => Operation::Quotient(s(a), s(b)),
                Node::Min(a, b) => Operation::Min(s(a), s(b)),
                Node::Max(a, b) => Operation::Max(s(a), s(b)),
                Node::Abs(a) => Operation::Abs(s(a)),
                Node::Sqrt(a) => Operation::Sqrt(s(a)),
                Node::Select { low, high, then, other } => {
                    Operation::Select { low: s(low), high: s(high), then: s(then), other: s(other) }
                }
            };
            let slot = self.put(operation);
            self.slots.insert(id, slot);
        }
        self.slots[&root]
    }

    fn split(&mut self, curve: CurveIndex, strict: bool, then: Slot, other: Slot) -> Slot {
        let value = self.expression(self.tool.model.curves[curve].value);
        self.put(Operation::Side { value, strict, then, other })
    }

    fn tree(&mut self, tree: &Tree<Id>) -> Slot {
        match tree {
            Tree::Leaf(id) => self.expression(*id),
            Tree::Split { curve, strict, below, above } => {
                let (then, other) = (self.tree(below), self.tree(above));
                self.split(*curve, *strict, then, other)
            }
        }
    }

    fn owner(&mut self, tree: &Tree<Option<usize>>) -> Slot {
        match tree {
            Tree::Leaf(owner) => {
                self.put(Operation::Const(owner.map_or(-1.0, |index| index as f64)))
            }
            Tree::Split { curve, strict, below, above } => {
                let (then, other) = (self.owner(below), self.owner(above));
                self.split(*curve, *strict, then, other)
            }
        }
    }
}
