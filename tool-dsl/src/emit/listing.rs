//! The intermediate stages of a tool as text, which reviewers compare after a change of the compiler. The tree of
//! splits is a graph in Graphviz's DOT.

use crate::checked::CheckedTool;
use crate::diagnostic::format_number;
use crate::expr::{Coord, Graph, Id, Node};
use crate::formula::{Curve, Formula};
use crate::model::{Over, Profile};
use crate::plan::Tree;
use crate::regionalise::Feature;
use crate::regionalise::overlay::Division;
use crate::source::Source;
use crate::syntax;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Lists the syntax tree of a text, one line per item, without source locations.
pub fn tree(source: &Source) -> String {
    let Ok(tree) = syntax::parse(source, &mut Vec::new()) else { return String::new() };
    let head = format!("{:?} {} {:?}\n", tree.domain, tree.name.text, tree.title);
    tree.items.iter().fold(head, |text, item| text + &unplaced(&format!("{item:?}")) + "\n")
}

/// Removes the spans from a debug text.
fn unplaced(text: &str) -> String {
    let mut parts = text.split("Span { start: ");
    let mut plain = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (_, rest) = part.split_once('}').unwrap_or_default();
        plain += "_";
        plain += rest;
    }
    let plain = plain.replace(", span: _", "").replace("span: _, ", "");
    plain.replace("Number(", "").replace(" (prec: 256))", "")
}

/// Lists the resolved model: frame, curves, surfaces, and the extent of the solid.
pub fn model(tool: &CheckedTool) -> String {
    let model = &tool.model;
    let mut text = String::new();
    // Writing to a String does not fail.
    let _ = writeln!(text, "{:?} {} {:?}", model.domain, model.name, model.title);
    let _ = writeln!(text, "unit {}", model.unit.symbol());
    let down = if model.frame.spindle_down { ", spindle -z" } else { "" };
    let _ = writeln!(text, "tip {}{down}", format_number(model.frame.tip.to_f64()));
    for side in tool.extent.cell().sides {
        let _ = writeln!(text, "reach {:?} to {:?}", side.low, side.high);
    }
    for slab in tool.envelope() {
        let _ = writeln!(text, "slab {:?} to {:?} within {:?}", slab.low, slab.high, slab.radius);
    }
    for surface in &model.surfaces {
        let cutting = if surface.cutting { " cutting" } else { "" };
        let _ = writeln!(text, "surface {}{cutting}", surface.name);
    }
    for (index, curve) in model.curves.iter().enumerate() {
        let name = curve.name.as_deref().unwrap_or("");
        let _ = writeln!(text, "curve {index} {name}: {}", expression(tool, curve.value));
    }
    text
}

/// Lists the regions: their conditions, and the quantities evaluated there.
pub fn regions(tool: &CheckedTool) -> String {
    let model = &tool.model;
    let mut text = String::new();
    for (index, region) in model.regions.iter().enumerate() {
        // Writing to a String does not fail.
        let surface = &model.surfaces[region.surface].name;
        let _ = writeln!(text, "region {} as {surface}", region.name);
        let nearest = model.profile.as_ref().map(|profile| nearest_feature(profile, index));
        let stated =
            (region.condition != Formula::Const(true)).then(|| condition(tool, &region.condition));
        let conditions: Vec<String> = nearest.into_iter().chain(stated).collect();
        let _ = writeln!(text, "  where {}", conditions.join(" and "));
        let evaluation = [
            ("depth", region.depth),
            ("magnitude", region.magnitude),
            ("niceness", region.niceness),
        ];
        for (name, id) in evaluation {
            let _ = writeln!(text, "  {name} {}", expression(tool, id));
        }
        let direction = region.raw_direction.0.map(|part| expression(tool, part));
        let _ = writeln!(text, "  direction ({})", direction.join(", "));
    }
    text
}

/// Returns the words for what the points of a region of a profile are nearest to.
fn nearest_feature(profile: &Profile, region: usize) -> String {
    let nearest = match profile.inner.section().features()[profile.feature_of(region)] {
        Feature::Piece(segment) => format!("nearest to segment {}", segment + 1),
        Feature::Corner(Some(segment)) => {
            format!("nearest to the corner after segment {}", segment + 1)
        }
        Feature::Corner(None) => "nearest to the corner before segment 1".to_owned(),
    };
    match &profile.over {
        Some(Over { division: Division::Rounded(_), regions }) => {
            format!(
                "{nearest} and to segment {} of the rounded outline",
                regions[region].condition + 1
            )
        }
        _ => nearest,
    }
}

fn condition(tool: &CheckedTool, formula: &Formula) -> String {
    let joined = |parts: &[Formula], word: &str| {
        let parts: Vec<String> = parts.iter().map(|part| condition(tool, part)).collect();
        format!("({})", parts.join(word))
    };
    match formula {
        Formula::Const(value) => value.to_string(),
        Formula::Atom { curve, below } => {
            let Curve { name, value } = &tool.model.curves[*curve];
            let curve = name.clone().unwrap_or_else(|| expression(tool, *value));
            format!("{curve} {} 0", if *below { "<=" } else { ">=" })
        }
        Formula::All(parts) => joined(parts, " and "),
        Formula::Any(parts) => joined(parts, " or "),
    }
}

/// Writes an expression in the language, and after it the values that it mentions more than once.
fn expression(tool: &CheckedTool, id: Id) -> String {
    let graph = &tool.model.graph;
    let needed = graph.dependencies([id]);
    let mut uses: BTreeMap<Id, usize> = BTreeMap::new();
    for operand in needed.iter().flat_map(|id| graph.node(*id).operands()) {
        *uses.entry(operand).or_default() += 1;
    }
    let is_shared = |id: &Id| uses.get(id).is_some_and(|uses| *uses > 1) && graph.height(*id) > 0;
    let mut names: BTreeMap<Id, String> = BTreeMap::new();
    let mut shared = Vec::new();
    for id in needed.iter().filter(|id| is_shared(id)) {
        let name = format!("v{}", names.len() + 1);
        shared.push(format!("{name} = {}", Infix { graph, names: &names }.text(*id).0));
        names.insert(*id, name);
    }
    let text = match names.get(&id) {
        Some(name) => name.clone(),
        None => Infix { graph, names: &names }.text(id).0,
    };
    if shared.is_empty() { text } else { format!("{text}, where {}", shared.join(", ")) }
}

/// The binding strength of an expression's outermost operator.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Binding {
    Sum,
    Product,
    Value,
}

/// Writes expressions with operators between operands, some of which have names.
struct Infix<'g> {
    graph: &'g Graph,
    names: &'g BTreeMap<Id, String>,
}

impl Infix<'_> {
    fn text(&self, id: Id) -> (String, Binding) {
        use Binding::{Product, Sum, Value};
        let call = |name: &str, operands: &[Id]| {
            let operands: Vec<String> = operands.iter().map(|id| self.within(*id, Sum)).collect();
            (format!("{name}({})", operands.join(", ")), Value)
        };
        match *self.graph.node(id) {
            Node::Const(ref value) => {
                let binding = if value.is_negative() { Sum } else { Value };
                (format_number(value.to_f64()), binding)
            }
            Node::Coord(coord) => {
                let name = match coord {
                    Coord::X => "x",
                    Coord::Y => "y",
                    Coord::Z => "z",
                    Coord::D => "d",
                    Coord::Q => "d^2",
                    Coord::Length => "unit",
                    Coord::PerLength => "1/unit",
                };
                (name.to_owned(), if coord == Coord::PerLength { Product } else { Value })
            }
            Node::Neg(a) => (format!("-{}", self.within(a, Product)), Sum),
            Node::Add(a, b) if let Some(x) = self.graph.constant(b).filter(|x| x.is_negative()) => {
                let x = format_number((-x).to_f64());
                (format!("{} - {x}", self.within(a, Sum)), Sum)
            }
            Node::Add(a, b) => {
                (format!("{} + {}", self.within(a, Sum), self.within(b, Product)), Sum)
            }
            Node::Sub(a, b) => {
                (format!("{} - {}", self.within(a, Sum), self.within(b, Product)), Sum)
            }
            Node::Mul(a, b) if a == b => (format!("{}^2", self.within(a, Value)), Value),
            Node::Mul(a, b) => {
                (format!("{}*{}", self.within(a, Product), self.within(b, Value)), Product)
            }
            Node::Div(a, b) | Node::Quotient(a, b) => {
                (format!("{}/{}", self.within(a, Product), self.within(b, Value)), Product)
            }
            Node::Min(a, b) => call("min", &[a, b]),
            Node::Max(a, b) => call("max", &[a, b]),
            Node::Abs(a) => call("abs", &[a]),
            Node::Sqrt(a) => call("sqrt", &[a]),
            Node::Select { low, high, then, other } => {
                let [low, high, then, other] =
                    [low, high, then, other].map(|id| self.within(id, Sum));
                (format!("({then} if {low} <= {high}, else {other})"), Value)
            }
        }
    }

    /// Returns an operand, in parentheses if its operator binds less than is needed.
    fn within(&self, id: Id, needed: Binding) -> String {
        if let Some(name) = self.names.get(&id) {
            return name.clone();
        }
        let (text, binding) = self.text(id);
        if binding < needed { format!("({text})") } else { text }
    }
}

/// Writes the tree of owners: a box per test, whose left branch is taken if it holds, and a leaf per region.
pub fn dot(tool: &CheckedTool) -> String {
    let mut graph = Dot { tool, text: String::new(), nodes: 0 };
    graph.tree(&tool.tree);
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

    fn tree(&mut self, tree: &Tree) -> usize {
        match tree {
            Tree::Leaf(None) => self.node("outside", ", shape=plaintext"),
            Tree::Leaf(Some(owner)) => {
                let name = self.tool.model.regions[*owner].name.clone();
                self.node(&name, ", shape=ellipse")
            }
            Tree::Split { curve, strict, below, above } => {
                let model = &self.tool.model;
                let sign = if *strict { "<" } else { "<=" };
                let test =
                    format!("{} {sign} 0", expression(self.tool, model.curves[*curve].value));
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
