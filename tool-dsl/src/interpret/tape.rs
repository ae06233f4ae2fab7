//! The plan for blocks of points.

use super::{OUTPUTS, Operation, Slot, roots};
use crate::Checked;
use crate::expr::value::{max, min, quotient};
use crate::expr::{Coord, Id};
use crate::formula::CurveIndex;
use crate::plan::Tree;
use std::collections::HashMap;

/// How many points a tape does at a time.
pub const BLOCK: usize = 64;

/// The numbers of a block of points.
pub type Lanes = [f64; BLOCK];

/// A part of a tool's plan as a list of operations over blocks of points.
#[derive(Clone, Debug)]
pub struct Tape {
    operations: Vec<Operation>,
    /// Where each output is found, and how much of the tape it needs.
    outputs: Vec<(Slot, usize)>,
}

impl Tape {
    /// The tape of the owners: its only output is a region's place in the list, -1 outside.
    pub fn owner(tool: &Checked) -> Tape {
        let mut writer = TapeWriter { tool, operations: Vec::new(), slots: HashMap::new() };
        let slot = writer.owner(&tool.plan.owner);
        Tape { outputs: vec![(slot, writer.operations.len())], operations: writer.operations }
    }

    /// The tape of what is felt in a region: depth, magnitude, niceness, direction, gradient.
    pub fn felt(tool: &Checked, region: usize) -> Tape {
        let mut writer = TapeWriter { tool, operations: Vec::new(), slots: HashMap::new() };
        let mut outputs = Vec::with_capacity(OUTPUTS - 1);
        for root in roots(&tool.model.regions[region].outputs) {
            let slot = writer.expression(root);
            outputs.push((slot, writer.operations.len()));
        }
        Tape { operations: writer.operations, outputs }
    }

    /// The tape of the distance from points outside to the tool, its only output.
    pub fn outside(tool: &Checked) -> Tape {
        let mut writer = TapeWriter { tool, operations: Vec::new(), slots: HashMap::new() };
        let slot = writer.tree(&tool.plan.outside);
        Tape { outputs: vec![(slot, writer.operations.len())], operations: writer.operations }
    }

    /// Evaluates as many of the first outputs as there are results at a block of points of the
    /// tool's frame, in the file's unit; `length` is the file's unit of length measured in the
    /// part's. `registers` are kept between calls.
    pub fn run(
        &self,
        points: [&Lanes; 3],
        length: f64,
        registers: &mut Vec<Lanes>,
        results: &mut [Lanes],
    ) {
        let wanted = results.len().min(self.outputs.len());
        let Some((_, end)) = self.outputs[..wanted].last() else { return };
        if registers.len() < self.operations.len() {
            registers.resize(self.operations.len(), [0.0; BLOCK]);
        }
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
            let operation = Operation::of(self.tool.model.graph.node(id), s);
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
