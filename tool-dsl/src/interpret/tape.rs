//! Evaluation of the plan for blocks of points.

use super::{OUTPUT_COUNT, Operation, Slot};
use crate::checked::CheckedTool;
use crate::expr::value::{max, min, quotient};
use crate::expr::{Coord, Id};
use std::collections::HashMap;

/// The number of points that a tape evaluates at a time.
pub const BLOCK_POINTS: usize = 64;

/// One value per point of a block.
pub type Lanes = [f64; BLOCK_POINTS];

/// The first `count` points of a block, by their coordinates in the tool's frame and the file's unit.
#[derive(Clone, Copy, Debug)]
pub struct Block<'a> {
    /// The x, y and z of the points.
    pub points: [&'a Lanes; 3],
    /// The number of points. The lanes after them have no meaning.
    pub count: usize,
    /// The length of the file's unit in units of the part.
    pub length: f64,
}

/// A part of a tool's plan as a list of operations on blocks of points.
#[derive(Clone, Debug)]
pub struct Tape {
    operations: Vec<Operation>,
    /// The slot of each output, and the number of operations up to it.
    outputs: Vec<(Slot, usize)>,
}

impl Tape {
    /// Makes the tape of the outputs in a region: depth, magnitude, niceness, direction, gradient.
    pub fn evaluation(tool: &CheckedTool, region: usize) -> Tape {
        let mut writer = TapeWriter { tool, operations: Vec::new(), slots: HashMap::new() };
        let mut outputs = Vec::with_capacity(OUTPUT_COUNT - 1);
        for root in tool.model.regions[region].outputs.roots() {
            let slot = writer.expression(root);
            outputs.push((slot, writer.operations.len()));
        }
        Tape { operations: writer.operations, outputs }
    }

    /// Allocates the registers that [`Tape::run`] needs.
    pub fn reserve(&self, registers: &mut Vec<Lanes>) {
        if registers.len() < self.operations.len() {
            registers.resize(self.operations.len(), [0.0; BLOCK_POINTS]);
        }
    }

    /// Evaluates the first `results.len()` outputs at the points of a block. `registers` are kept between calls. The function is inlined so that its loops are compiled for the
    /// caller's vector instructions.
    #[inline(always)]
    pub fn run(&self, block: Block<'_>, registers: &mut Vec<Lanes>, results: &mut [Lanes]) {
        let output_count = results.len().min(self.outputs.len());
        let Some((_, end)) = self.outputs[..output_count].last() else { return };
        self.reserve(registers);
        let block = block.padded();
        for (at, operation) in self.operations[..*end].iter().enumerate() {
            let (done, rest) = registers.split_at_mut(at);
            if let Some(result) = rest.first_mut() {
                perform(operation, block, done, result);
            }
        }
        for (result, (slot, _)) in results.iter_mut().zip(&self.outputs) {
            *result = registers[*slot as usize];
        }
    }
}

impl Block<'_> {
    /// Rounds the number of points up to a number of lanes that fills vectors.
    pub(super) fn padded(self) -> Self {
        Block { count: self.count.next_multiple_of(8).min(BLOCK_POINTS), ..self }
    }
}

/// Performs one operation on a block. The loops are written out here, since closures would be compiled
/// without the caller's vector instructions.
#[inline(always)]
pub(super) fn perform(
    operation: &Operation,
    Block { points, count, length }: Block<'_>,
    done: &[Lanes],
    result: &mut Lanes,
) {
    let result = &mut result[..count];
    let p = points.map(|list| &list[..count]);
    macro_rules! each {
        ($(let $name:ident = $slot:expr;)* $value:expr) => {{
            $(let $name = &done[$slot as usize][..count];)*
            for i in 0..count {
                $(let $name = $name[i];)*
                result[i] = $value;
            }
        }};
    }
    match *operation {
        Operation::Neg(a) => each! { let a = a; -a },
        Operation::Abs(a) => each! { let a = a; a.abs() },
        Operation::Sqrt(a) => each! { let a = a; a.sqrt() },
        Operation::Add(a, b) => each! { let a = a; let b = b; a + b },
        Operation::Sub(a, b) => each! { let a = a; let b = b; a - b },
        Operation::Mul(a, b) => each! { let a = a; let b = b; a * b },
        Operation::Div(a, b) => each! { let a = a; let b = b; a / b },
        Operation::Quotient(a, b) => each! { let a = a; let b = b; quotient(a, b) },
        Operation::Min(a, b) => each! { let a = a; let b = b; min(a, b) },
        Operation::Max(a, b) => each! { let a = a; let b = b; max(a, b) },
        Operation::Const(value) => result.fill(value),
        Operation::Coord(Coord::X) => result.copy_from_slice(p[0]),
        Operation::Coord(Coord::Y) => result.copy_from_slice(p[1]),
        Operation::Coord(Coord::Z) => result.copy_from_slice(p[2]),
        Operation::Coord(Coord::Length) => result.fill(length),
        Operation::Coord(Coord::PerLength) => result.fill(1.0 / length),
        Operation::Coord(Coord::Q) => {
            for i in 0..count {
                result[i] = p[0][i] * p[0][i] + p[1][i] * p[1][i];
            }
        }
        Operation::Coord(Coord::D) => {
            for i in 0..count {
                result[i] = (p[0][i] * p[0][i] + p[1][i] * p[1][i]).sqrt();
            }
        }
        Operation::Select { low, high, then, other } => each! {
            let low = low; let high = high; let then = then; let other = other;
            if low <= high { then } else { other }
        },
    }
}

struct TapeWriter<'t> {
    tool: &'t CheckedTool,
    operations: Vec<Operation>,
    slots: HashMap<Id, Slot>,
}

impl TapeWriter<'_> {
    fn put(&mut self, operation: Operation) -> Slot {
        self.operations.push(operation);
        (self.operations.len() - 1) as Slot
    }

    fn expression(&mut self, root: Id) -> Slot {
        for id in self.tool.model.graph.dependencies([root]) {
            if self.slots.contains_key(&id) {
                continue;
            }
            let operation = Operation::of(self.tool.model.graph.node(id), |id| self.slots[id]);
            let slot = self.put(operation);
            self.slots.insert(id, slot);
        }
        self.slots[&root]
    }
}
