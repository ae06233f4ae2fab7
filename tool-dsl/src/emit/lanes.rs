//! The evaluator for lanes: one descent of the tree of splits, then the outputs of the regions that have a lane.
//!
//! Points that are evaluated together are close to each other and mostly lie in one or two regions. The code
//! therefore skips sides of a split that no lane takes, and regions that contain no lane. The remaining work
//! is little more than for a single point.
//!
//! Regions that differ in little, such as flute and shank of a mill, are computed together: each output once for the
//! lanes of all regions in which it is the same.

use super::code::Writer;
use super::tokens::Tokens;
use super::{OUTPUTS, Output};
use crate::checked::CheckedTool;
use crate::expr::{Coord, Graph, Id, Node};
use crate::model::{Model, RegionOutputs};
use crate::number::Number;
use proc_macro2::TokenStream;
use quote::quote;
use std::collections::{BTreeMap, BTreeSet};

/// Writes the evaluator for lanes.
pub(super) fn evaluator(tool: &CheckedTool) -> TokenStream {
    let model = &tool.model;
    let owners: BTreeSet<usize> = tool.tree.owners().into_iter().flatten().collect();
    let magnitude_is_depth =
        owners.iter().all(|owner| is_depth(&model.graph, &model.regions[*owner].outputs));
    let evaluator = Evaluator { model, magnitude_is_depth };
    let roots: Vec<Id> = owners.iter().flat_map(|owner| evaluator.roots(*owner)).collect();
    let writer = Writer::new(model, &tool.tree, &roots);
    let mut code = Tokens::default();
    for owner in &owners {
        code.word("let").word("mut").word(writer.mask(*owner)).sign("=").word("none").sign(";");
    }
    let scope = writer.descent(&mut code, &tool.tree);
    for owner in &owners {
        code.word("result").sign(".").word("assign").paren(|code| {
            code.word(writer.mask(*owner)).sign(",").of_lanes(*owner as f64);
        });
        code.sign(";");
    }
    for group in evaluator.groups(&owners) {
        GroupWriter { evaluator: &evaluator, writer: &writer, group }.write(&mut code, &scope);
    }
    if magnitude_is_depth {
        code.word("if").word("outputs").sign(".").word("magnitude").brace(|code| {
            code.word("result").sign(".").word("magnitude").sign("=");
            code.word("result").sign(".").word("depth").sign("*").word("length").sign(";");
        });
    }
    let (given, code) = (writer.given(), code.done());
    quote! {
        #[inline(always)]
        fn evaluate_lanes<L: Lane>(
            point: [L; 3], length: L, present: L::Mask, outputs: Outputs,
        ) -> LaneEvaluation<L> {
            let [x, y, z] = point;
            #given
            let none = present & !present;
            let mut result = LaneEvaluation::none(z, none);
            #code
            result
        }
    }
}

/// Returns whether the magnitude of a region is its depth, in the part's unit.
fn is_depth(graph: &Graph, outputs: &RegionOutputs) -> bool {
    let is_length = |id: Id| *graph.node(id) == Node::Coord(Coord::Length);
    match *graph.node(outputs.magnitude) {
        Node::Mul(a, b) => [a, b].contains(&outputs.depth) && (is_length(a) || is_length(b)),
        _ => false,
    }
}

struct Evaluator<'m> {
    model: &'m Model,
    /// True if the magnitude is the depth in all regions, so that it is computed once for all of them.
    magnitude_is_depth: bool,
}

impl Evaluator<'_> {
    /// Returns the values of an output in a region that are computed there. There are none where the output is 0, as it is
    /// before anything is computed, or follows from another one.
    fn values(&self, output: &Output, region: usize) -> Vec<Id> {
        let values = (output.of)(&self.model.regions[region].outputs);
        let is_zero = |id: &Id| self.model.graph.constant(*id).is_some_and(Number::is_zero);
        let follows = self.magnitude_is_depth && output.name == "magnitude";
        if follows || values.iter().all(is_zero) { Vec::new() } else { values }
    }

    /// Returns the values of all outputs of a region that are computed there.
    fn roots(&self, region: usize) -> Vec<Id> {
        OUTPUTS.iter().flat_map(|output| self.values(output, region)).collect()
    }

    /// Returns the regions in groups that are computed together. Enclosures tell regions written by hand apart by the mask of
    /// each, so that these are groups of their own.
    fn groups(&self, owners: &BTreeSet<usize>) -> Vec<Vec<usize>> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        let place = |region: usize| {
            let RegionOutputs { depth, direction, .. } = &self.model.regions[region].outputs;
            (*depth, *direction)
        };
        for owner in owners {
            let known = groups
                .iter_mut()
                .find(|group| self.model.profile.is_some() && place(group[0]) == place(*owner));
            match known {
                Some(group) => group.push(*owner),
                None => groups.push(vec![*owner]),
            }
        }
        groups
    }
}

/// The names of a vector's components.
const ALONG_AXES: [&str; 3] = ["along_x", "along_y", "along_z"];

/// The mask of the lanes of several regions.
const LANES: &str = "lanes";

/// A writer of the outputs of regions that are computed together.
struct GroupWriter<'a> {
    evaluator: &'a Evaluator<'a>,
    writer: &'a Writer<'a>,
    group: Vec<usize>,
}

impl GroupWriter<'_> {
    fn write(&self, code: &mut Tokens, scope: &BTreeSet<Id>) {
        let mut scope = scope.clone();
        let shared = self.shared();
        if self.group.len() > 1 {
            code.word("let").word(LANES).sign("=");
            self.any_of(code, &self.group);
            code.sign(";");
        }
        code.word("if").any(|code| {
            code.word(self.mask());
        });
        code.brace(|code| {
            self.writer.lets(code, shared, &mut scope);
            for output in &OUTPUTS {
                for (values, regions) in self.distinct(output) {
                    code.word("if");
                    self.condition(code, output);
                    code.brace(|code| self.output(code, output, &values, &regions, &scope));
                }
            }
        });
    }

    /// Writes the condition under which an output is computed.
    fn condition(&self, code: &mut Tokens, output: &Output) {
        code.word("outputs").sign(".").word(output.name);
        if self.evaluator.magnitude_is_depth && output.name == "depth" {
            code.sign("|").word("outputs").sign(".").word("magnitude");
        }
    }

    /// Returns the distinct values of an output, each with the regions in which it has them.
    fn distinct(&self, output: &Output) -> Vec<(Vec<Id>, Vec<usize>)> {
        let mut distinct: Vec<(Vec<Id>, Vec<usize>)> = Vec::new();
        for region in &self.group {
            let values = self.evaluator.values(output, *region);
            match distinct.iter_mut().find(|(known, _)| *known == values) {
                Some((_, regions)) => regions.push(*region),
                None if values.is_empty() => {}
                None => distinct.push((values, vec![*region])),
            }
        }
        distinct
    }

    /// Returns the nodes that several outputs need.
    fn shared(&self) -> Vec<Id> {
        let mut users: BTreeMap<Id, usize> = BTreeMap::new();
        for output in &OUTPUTS {
            for (values, _) in self.distinct(output) {
                for id in self.evaluator.model.graph.dependencies(values) {
                    *users.entry(id).or_default() += 1;
                }
            }
        }
        users.into_iter().filter(|(_, users)| *users > 1).map(|(id, _)| id).collect()
    }

    /// Returns the name of the mask of the group's lanes.
    fn mask(&self) -> &str {
        match self.group[..] {
            [only] => self.writer.mask(only),
            _ => LANES,
        }
    }

    /// Writes the mask of the lanes in some regions of the group.
    fn mask_of(&self, code: &mut Tokens, regions: &[usize]) {
        if regions.len() == self.group.len() {
            code.word(self.mask());
        } else {
            self.any_of(code, regions);
        }
    }

    /// Writes the union of the masks of some regions.
    fn any_of(&self, code: &mut Tokens, regions: &[usize]) {
        for (k, region) in regions.iter().enumerate() {
            if k > 0 {
                code.sign("|");
            }
            code.word(self.writer.mask(*region));
        }
    }

    fn output(
        &self,
        code: &mut Tokens,
        output: &Output,
        values: &[Id],
        regions: &[usize],
        scope: &BTreeSet<Id>,
    ) {
        let mut scope = scope.clone();
        let graph = &self.evaluator.model.graph;
        let operands = values.iter().flat_map(|value| graph.node(*value).operands());
        self.writer.lets(code, operands, &mut scope);
        let names: &[&str] = if values.len() == 1 { &[output.name] } else { &ALONG_AXES };
        let is_short = |id: Id| match graph.node(id) {
            Node::Const(value) => [-1.0, 0.0, 1.0].contains(&value.to_f64()),
            Node::Coord(_) => true,
            _ => scope.contains(&id),
        };
        for (value, name) in values.iter().zip(names).filter(|(value, _)| !is_short(**value)) {
            code.word("let").word(name).sign("=");
            self.writer.operation(code, *value);
            code.sign(";");
        }
        let value = |code: &mut Tokens, k: usize| {
            if is_short(values[k]) {
                self.writer.value(code, values[k]);
            } else {
                code.word(names[k]);
            }
        };
        code.word("result").sign(".").word(&format!("set_{}", output.name)).paren(|code| {
            self.mask_of(code, regions);
            code.sign(",");
            match values.len() {
                1 => value(code, 0),
                count => {
                    code.bracket(|code| {
                        for k in 0..count {
                            value(code, k);
                            code.sign(",");
                        }
                    });
                }
            }
        });
        code.sign(";");
    }
}
