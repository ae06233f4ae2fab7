//! The evaluator for lanes: one descent of the tree of owners, then the outputs of each region that has a
//! lane.
//!
//! Points that are evaluated together are close to each other and mostly lie in one or two regions. The code
//! therefore skips sides of a split that no lane takes, and regions that contain no lane. The remaining work
//! is little more than for a single point.

use super::code::{Form, Writer};
use super::tokens::Tokens;
use super::{OUTPUTS, Output};
use crate::checked::CheckedTool;
use crate::expr::Id;
use proc_macro2::TokenStream;
use quote::quote;
use std::collections::{BTreeMap, BTreeSet};

/// Writes the evaluator for lanes.
pub(super) fn evaluator(tool: &CheckedTool) -> TokenStream {
    let model = &tool.model;
    let tree = &tool.plan.owner;
    let owners: BTreeSet<usize> = tree.leaves().into_iter().copied().flatten().collect();
    let outputs = owners.iter().map(|region| &model.regions[*region].outputs);
    let roots: Vec<Id> = outputs
        .flat_map(|outputs| OUTPUTS.iter().flat_map(|output| (output.of)(outputs)))
        .collect();
    let writer = Writer::of_tree(&model.graph, &model.curves, Form::Lanes, &roots, tree);
    let mut code = Tokens::default();
    for region in &owners {
        code.word("let").word("mut").word(&of(*region)).sign("=").word("none").sign(";");
    }
    let scope = writer.walked(&mut code, tree, &|code, mask, owner: &Option<usize>| {
        if let Some(region) = owner {
            let name = of(*region);
            code.word(&name).sign("=").word(&name).sign("|").word(mask).sign(";");
        }
    });
    for region in &owners {
        let section = Section { tool, writer: &writer, region: *region };
        section.write(&mut code, &scope);
    }
    let (given, code) = (writer.given(), code.done());
    quote! {
        #[inline(always)]
        fn evaluate_lanes<L: Lane>(
            [x, y, z]: [L; 3], length: L, present: L::Mask, outputs: Outputs,
        ) -> LaneEvaluation<L> {
            #given
            let none = present & !present;
            let mut evaluation = LaneEvaluation::none(z, none);
            #code
            evaluation
        }
    }
}

/// Returns the name of the mask of the lanes in a region.
fn of(region: usize) -> String {
    format!("of{region}")
}

/// The code of one region's outputs.
struct Section<'a> {
    tool: &'a CheckedTool,
    writer: &'a Writer<'a>,
    region: usize,
}

impl Section<'_> {
    fn write(&self, code: &mut Tokens, scope: &BTreeSet<Id>) {
        let mask = of(self.region);
        code.word("if").any(&mask);
        code.brace(|code| {
            let mut scope = scope.clone();
            code.word("evaluation").sign(".").word("assign").paren(|code| {
                code.word(&mask).sign(",").of_lanes(self.region as f64);
            });
            code.sign(";");
            self.writer.lets(code, self.shared(), &mut scope);
            for output in &OUTPUTS {
                code.word("if").word("outputs").sign(".").word(output.name);
                code.brace(|code| self.output(code, output, &mask, &mut scope.clone()));
            }
        });
    }

    /// Returns the nodes that several outputs need.
    fn shared(&self) -> Vec<Id> {
        let model = &self.tool.model;
        let mut users: BTreeMap<Id, usize> = BTreeMap::new();
        for output in &OUTPUTS {
            for id in model.graph.dependencies((output.of)(&model.regions[self.region].outputs)) {
                *users.entry(id).or_default() += 1;
            }
        }
        users.into_iter().filter(|(_, users)| *users > 1).map(|(id, _)| id).collect()
    }

    fn output(&self, code: &mut Tokens, output: &Output, mask: &str, scope: &mut BTreeSet<Id>) {
        let values = (output.of)(&self.tool.model.regions[self.region].outputs);
        self.writer.lets(code, values.iter().copied(), scope);
        if let [value] = values[..] {
            field(code, output);
            code.sign("=");
            self.select(code, mask, value, &|code| field(code, output));
            code.sign(";");
            return;
        }
        let parts = ["along_x", "along_y", "along_z"];
        code.word("let").bracket(|code| {
            for part in parts {
                code.word(part).sign(",");
            }
        });
        code.sign("=");
        field(code, output);
        code.sign(";");
        field(code, output);
        code.sign("=").bracket(|code| {
            for (value, part) in values.iter().zip(parts) {
                self.select(code, mask, *value, &|code| {
                    code.word(part);
                });
                code.sign(",");
            }
        });
        code.sign(";");
    }
    /// Writes a value in the lanes of a mask, and another one in the others.
    fn select(&self, code: &mut Tokens, mask: &str, value: Id, other: &dyn Fn(&mut Tokens)) {
        code.lane("select", |code| {
            code.word(mask).sign(",");
            self.writer.value(code, value);
            code.sign(",");
            other(code);
        });
    }
}

/// Writes the field of an evaluation that holds an output.
fn field(code: &mut Tokens, output: &Output) {
    code.word("evaluation").sign(".").word(output.name);
}
