//! The reference interpreter: evaluation by the rule of the text. Regions by hand are asked in the order of the list; with a
//! profile, the nearest of all features has the point.
//!
//! It has no tree. Generated code and the runtime's evaluator of tools, which descend the plan's tree, are tested against it. All perform the same operations with one rounding each, once the owner is known. The reference may have another
//! owner within rounding of a border: there a test that the plan left out, because it cannot fail, would fail by rounding, and
//! distances are compared in another form.

use crate::checked::CheckedTool;
use crate::expr::Id;
use crate::expr::value::{EvaluationPoint, Evaluator};
use crate::formula::CurveIndex;
use crate::regionalise::owners::Owners;

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
    /// The owners of a profile's points; `None` for regions by hand.
    owners: Option<Owners<'t>>,
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
        let owners = model.profile.as_ref().map(Owners::new);
        Interpreter { tool, evaluator: Evaluator::new(&model.graph, roots), owners }
    }

    /// Evaluates the tool at a point of its frame, in the file's unit; `None` outside. `length` is the length
    /// of the file's unit in units of the part.
    pub fn evaluate(&mut self, [x, y, z]: [f64; 3], length: f64) -> Option<Evaluation> {
        self.evaluator.evaluate(EvaluationPoint { length, ..EvaluationPoint::new(x, y, z) });
        let model = &self.tool.model;
        let mut value = |curve: CurveIndex| self.evaluator.get(model.curves[curve].value);
        let region = match &self.owners {
            Some(owners) => owners.region_at([(x * x + y * y).sqrt(), z], &mut value)?,
            None => {
                let mut regions = model.regions.iter();
                regions.position(|region| region.condition.holds(&mut value))?
            }
        };
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
