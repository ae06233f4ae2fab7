//! The interpreter: a checked tool without Rust's compiler.
//!
//! Three ways to ask. [`Interpreter::at`] follows the text's own rule, region by region in the order
//! of the list, and is the reference for everything that is generated. For tools that are loaded at
//! run time there is the plan: [`Walk`] follows it for one point, doing what that point needs;
//! [`Tape`] is the whole plan as a list of operations, each done for a block of points before the
//! next. All perform the operations of the generated code, one rounding each: the plan has its bits
//! everywhere, the reference but for corners, where a test that the plan left out because it cannot
//! fail would fail by rounding (within an ulp of the tool's size).

mod tape;
mod walk;

pub use tape::{BLOCK, Lanes, Tape};
pub use walk::{Registers, Scratch, Value, Walk};

use crate::checked::CheckedTool;
use crate::expr::value::{At, Evaluator};
use crate::expr::{Coord, Id, Node};
use crate::formula::CurveIndex;

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
    tool: &'t CheckedTool,
    evaluator: Evaluator<'t>,
}

impl<'t> Interpreter<'t> {
    /// An interpreter of a tool.
    pub fn new(tool: &'t CheckedTool) -> Interpreter<'t> {
        let model = &tool.model;
        let roots = model
            .regions
            .iter()
            .flat_map(|region| region.outputs.roots())
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

/// How many numbers the plan can give for a point: owner (-1 outside), depth, magnitude, niceness,
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

impl Operation {
    /// The operation of a node, its operands where `slot` says.
    fn of(node: &Node, slot: impl Fn(&Id) -> Slot) -> Operation {
        let s = slot;
        match node {
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
        }
    }
}
