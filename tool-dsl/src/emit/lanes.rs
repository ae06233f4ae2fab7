//! The evaluator for lanes: one descent of the tree of splits, then the outputs of the regions that have a lane.
//!
//! Points that are evaluated together are close to each other and mostly lie in one or two regions. The code
//! therefore skips sides of a split that no lane takes, and regions that contain no lane. The remaining work
//! is little more than for a single point.
//!
//! Regions that differ in little are computed together, see [`alike`](super::alike).

use super::OUTPUTS;
use super::alike::{Group, Groups, Values};
use super::code::Writer;
use super::tokens::Tokens;
use crate::checked::CheckedTool;
use crate::expr::{Id, Node};
use proc_macro2::TokenStream;
use quote::quote;
use std::collections::{BTreeMap, BTreeSet};

/// Writes the evaluator for lanes.
pub(super) fn evaluator(tool: &CheckedTool) -> TokenStream {
    let model = &tool.model;
    let owners: BTreeSet<usize> = tool.tree.owners().into_iter().flatten().collect();
    let groups = Groups::new(model, &owners);
    let writer = Writer::new(model, &tool.tree, &groups);
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
    for group in &groups.groups {
        GroupWriter { groups: &groups, writer: &writer, group }.write(&mut code, &scope);
    }
    if groups.magnitude_is_depth {
        code.word("if").word("outputs").sign(".").word("magnitude").brace(|code| {
            code.word("result").sign(".").word("magnitude").sign("=");
            code.word("result").sign(".").word("depth").sign("*").word("length").sign(";");
        });
    }
    let (given, code) = (writer.given(), code.done());
    quote! {
        #[inline(always)]
        fn evaluate_lanes<L: ::touchoff::tool::Lane>(
            point: [L; 3], length: L, present: L::Mask, outputs: ::touchoff::tool::Outputs,
        ) -> ::touchoff::tool::LaneEvaluation<L> {
            let [x, y, z] = point;
            #given
            let none = present & !present;
            let mut result = ::touchoff::tool::LaneEvaluation::none(z, none);
            #code
            result
        }
    }
}

/// The names of a vector's components.
const ALONG_AXES: [&str; 3] = ["along_x", "along_y", "along_z"];

/// The mask of the lanes of several regions.
const LANES: &str = "lanes";

/// A writer of the outputs of regions that are computed together.
struct GroupWriter<'a> {
    groups: &'a Groups,
    writer: &'a Writer<'a>,
    group: &'a Group,
}

impl GroupWriter<'_> {
    fn write(&self, code: &mut Tokens, scope: &BTreeSet<Id>) {
        let mut scope = scope.clone();
        let shared = self.shared();
        if self.group.regions.len() > 1 {
            code.word("let").word(LANES).sign("=");
            self.any_of(code, &self.group.regions);
            code.sign(";");
        }
        code.word("if").any(|code| {
            code.word(self.mask());
        });
        code.brace(|code| {
            for parameter in &self.group.parameters {
                self.parameter(code, *parameter);
            }
            self.writer.lets(code, shared, &mut scope);
            for (output, values) in OUTPUTS.iter().zip(&self.group.outputs) {
                for values in values {
                    code.word("if");
                    self.condition(code, output.name);
                    code.brace(|code| self.output(code, output.name, values, &scope));
                }
            }
        });
    }

    /// Writes the selection of a parameter: the constant of the first regions, or that of others in their lanes.
    fn parameter(&self, code: &mut Tokens, id: Id) {
        self.writer.value(code.word("let"), id);
        code.sign("=");
        for (k, choice) in self.groups.parameters[&id].iter().enumerate() {
            if k == 0 {
                code.of_lanes(choice.value());
            } else {
                code.sign(".").word("or").paren(|code| {
                    self.any_of(code, &choice.regions);
                    code.sign(",").number(choice.value());
                });
            }
        }
        code.sign(";");
    }

    /// Writes the condition under which an output is computed.
    fn condition(&self, code: &mut Tokens, output: &str) {
        code.word("outputs").sign(".").word(output);
        if self.groups.magnitude_is_depth && output == "depth" {
            code.sign("|").word("outputs").sign(".").word("magnitude");
        }
    }

    /// Returns the nodes that several outputs need.
    fn shared(&self) -> Vec<Id> {
        let mut users: BTreeMap<Id, usize> = BTreeMap::new();
        for values in self.group.outputs.iter().flatten() {
            for id in self.groups.graph.dependencies(values.ids.iter().copied()) {
                *users.entry(id).or_default() += 1;
            }
        }
        users.into_iter().filter(|(_, users)| *users > 1).map(|(id, _)| id).collect()
    }

    /// Returns the name of the mask of the group's lanes.
    fn mask(&self) -> &str {
        match self.group.regions[..] {
            [only] => self.writer.mask(only),
            _ => LANES,
        }
    }

    /// Writes the mask of the lanes in some regions of the group.
    fn mask_of(&self, code: &mut Tokens, regions: &[usize]) {
        if regions.len() == self.group.regions.len() {
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

    fn output(&self, code: &mut Tokens, output: &str, values: &Values, scope: &BTreeSet<Id>) {
        let mut scope = scope.clone();
        let (graph, ids) = (&self.groups.graph, &values.ids);
        let operands = ids.iter().flat_map(|id| graph.node(*id).operands());
        self.writer.lets(code, operands, &mut scope);
        let names: &[&str] = if ids.len() == 1 { &[output] } else { &ALONG_AXES };
        let is_short = |id: Id| match graph.node(id) {
            Node::Const(_) if self.writer.is_parameter(id) => true,
            Node::Const(value) => [-1.0, 0.0, 1.0].contains(&value.to_f64()),
            Node::Coord(_) => true,
            _ => scope.contains(&id),
        };
        for (id, name) in ids.iter().zip(names).filter(|(id, _)| !is_short(**id)) {
            code.word("let").word(name).sign("=");
            self.writer.operation(code, *id);
            code.sign(";");
        }
        let value = |code: &mut Tokens, k: usize| {
            if is_short(ids[k]) {
                self.writer.value(code, ids[k]);
            } else {
                code.word(names[k]);
            }
        };
        code.word("result").sign(".").word(&format!("set_{output}")).paren(|code| {
            self.mask_of(code, &values.regions);
            code.sign(",");
            match ids.len() {
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
