//! The tree of splits as a graph in Graphviz's DOT.

use super::code::Writer;
use crate::checked::CheckedTool;
use crate::plan::Tree;
use std::fmt::Write;

/// Writes the tree of owners: a box per test, whose left branch is taken if it holds, and a leaf per region.
pub fn dot(tool: &CheckedTool) -> String {
    let mut graph = Dot { tool, text: String::new(), nodes: 0 };
    graph.tree(&tool.plan.owner);
    let name = &tool.model.name;
    format!("digraph {name} {{\n    node [fontname=\"monospace\", shape=box];\n{}}}\n", graph.text)
}

struct Dot<'t> {
    tool: &'t CheckedTool,
    text: String,
    nodes: usize,
}

impl Dot<'_> {
    fn node(&mut self, label: &str, style: &str) -> usize {
        let node = self.nodes;
        self.nodes += 1;
        // Writing to a String does not fail.
        let _ = writeln!(self.text, "    n{node} [label=\"{label}\"{style}];");
        node
    }

    fn tree(&mut self, tree: &Tree<Option<usize>>) -> usize {
        match tree {
            Tree::Leaf(None) => self.node("outside", ", shape=plaintext"),
            Tree::Leaf(Some(owner)) => {
                let name = self.tool.model.regions[*owner].name.clone();
                self.node(&name, ", shape=ellipse")
            }
            Tree::Split { curve, strict, below, above } => {
                let model = &self.tool.model;
                let test = Writer::shown(&model.graph, &model.curves, *curve, *strict);
                let name = model.curves[*curve].name.as_ref();
                let label = name.map_or(test.clone(), |name| format!("{name}\\n{test}"));
                let node = self.node(&label, "");
                for (side, label) in [(below, "yes"), (above, "no")] {
                    let child = self.tree(side);
                    let _ = writeln!(self.text, "    n{node} -> n{child} [label=\"{label}\"];");
                }
                node
            }
        }
    }
}
