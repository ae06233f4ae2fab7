//! The interpreter: evaluation of a checked tool without Rust's compiler.
//!
//! There are three forms of evaluation. [`Interpreter::evaluate`] follows the rule of the text, region by region in
//! the order of the list, and is the reference for all generated code. The other two follow the plan, for
//! tools loaded at run time. [`PlanEvaluator`] evaluates one point and computes only what that point needs.
//! [`Tape`] is a list of operations, each applied to a block of points before the next.
//!
//! All perform the operations of the generated code, with one rounding each. The plan gives the same bits in
//! every form. The reference differs only at corners, within an ulp of the tool's size: there a test that the
//! plan left out, because it cannot fail, would fail by rounding.

mod tape;
mod walk;

pub use tape::{BLOCK_POINTS, Block, Lanes, Tape};
pub use walk::{PlanEvaluator, Registers, Scratch, Value};

use crate::checked::CheckedTool;
use crate::expr::value::{EvaluationPoint, Evaluator};
use crate::expr::{Coord, Id, Node};
use crate::formula::CurveIndex;

/// The evaluation at a point inside the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evaluation {
    /// The index of the region in the list.
    pub region: usize,
    /// The penetration depth in the file's unit.
    pub depth: f64,
    /// The magnitude.
    pub magnitude: f64,
    /// The unit vector toward the surface.
    pub direction: [f64; 3],
    /// The gradient of the magnitude.
    pub gradient: [f64; 3],
    /// The niceness.
    pub niceness: f64,
}

/// Evaluates a tool point by point.
#[derive(Clone, Debug)]
pub struct Interpreter<'t> {
    tool: &'t CheckedTool,
    evaluator: Evaluator<'t>,
}

impl<'t> Interpreter<'t> {
    /// Makes an interpreter for a tool.
    pub fn new(tool: &'t CheckedTool) -> Interpreter<'t> {
        let model = &tool.model;
        let roots = model
            .regions
            .iter()
            .flat_map(|region| region.outputs.roots())
            .chain(model.curve_values());
        Interpreter { tool, evaluator: Evaluator::new(&model.graph, roots) }
    }

    /// Evaluates the tool at a point of its frame, in the file's unit; `None` outside. `length` is the length
    /// of the file's unit in units of the part.
    pub fn evaluate(&mut self, [x, y, z]: [f64; 3], length: f64) -> Option<Evaluation> {
        self.evaluator.evaluate(EvaluationPoint { length, ..EvaluationPoint::new(x, y, z) });
        let model = &self.tool.model;
        let region = model.regions.iter().position(|region| {
            region
                .inside
                .holds(&mut |curve: CurveIndex| self.evaluator.get(model.curves[curve].value))
        })?;
        let get = |id: Id| self.evaluator.get(id);
        let outputs = &model.regions[region].outputs;
        Some(Evaluation {
            region,
            depth: get(outputs.depth),
            magnitude: get(outputs.magnitude),
            direction: outputs.direction.map(get),
            gradient: outputs.gradient.map(get),
            niceness: get(outputs.niceness),
        })
    }
}

/// The number of values that the plan gives per point: owner (-1 outside), depth, magnitude, niceness,
/// direction, gradient.
pub const OUTPUT_COUNT: usize = 10;

/// The index of an operand's value.
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
    Select { low: Slot, high: Slot, then: Slot, other: Slot },
}

impl Operation {
    /// Returns the operation of a node; `slot` maps its operands to the indices of their values.
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
