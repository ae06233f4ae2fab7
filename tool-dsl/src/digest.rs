//! A digest of a tool's meaning, which distinguishes its versions.

use crate::checked::CheckedTool;
use crate::domain::Domain;
use crate::expr::{Coord, Id, Node};
use crate::plan::Tree;
use crate::prove::Bounds;
use siphasher::sip::SipHasher24;
use std::collections::HashMap;
use std::fmt::{Debug, Write};

/// Computes a number that changes whenever anything that the tool answers may change: its solid, its
/// evaluations, its extent, its surfaces and regions by name, and the bounds proved for it. Layout, comments,
/// the tool's name and its title do not matter. Nor does it matter whether a number is written, given as an
/// argument or mounted. The result is the same on every machine for one version of the compiler; a compiler
/// that computes differently gives another.
///
/// It is SipHash-2-4, without a key, of the tool as text.
pub fn digest(tool: &CheckedTool) -> u64 {
    SipHasher24::new().hash(meaning(tool).as_bytes())
}

/// Writes everything that code is generated from. Expressions are identified by their index among those that
/// are needed, so that other definitions in the file do not matter.
fn meaning(tool: &CheckedTool) -> String {
    let model = &tool.model;
    let mut needed: Vec<Id> = model.curve_values().collect();
    needed.extend(model.regions.iter().flat_map(|region| region.outputs.roots()));
    let needed = model.graph.dependencies(needed);
    let indices: HashMap<Id, usize> =
        needed.iter().enumerate().map(|(index, id)| (*id, index)).collect();
    let index = |id: Id| indices[&id];

    let mut text = String::new();
    // Writing to a String does not fail.
    let mut line = |what: &dyn Debug| {
        let _ = writeln!(text, "{what:?}");
    };
    // Only numbers, words and tuples are written, so that a renamed type or field changes no digest.
    let domain = match model.domain {
        Domain::HalfPlane => "half plane",
        Domain::Space => "space",
    };
    let sides = tool.extent.cell().sides.map(|side| (side.low, side.high));
    line(&(domain, model.unit.symbol(), sides));
    tool.envelope().iter().for_each(|slab| line(&(slab.low, slab.high, slab.radius)));
    let Bounds { lower_slope, lipschitz, rounding_error } = tool.bounds();
    line(&(lower_slope, lipschitz, rounding_error));
    model.outline().for_each(|piece| line(&(piece.ends, piece.circle, piece.surface)));
    model.surfaces.iter().for_each(|surface| line(&(&surface.name, surface.cutting)));
    for region in &model.regions {
        let outputs: Vec<usize> = region.outputs.roots().into_iter().map(index).collect();
        line(&(&region.name, region.surface, outputs));
    }
    model.curves.iter().for_each(|curve| line(&index(curve.value)));
    line(&tests(&tool.tree));
    for id in &needed {
        match model.graph.node(*id) {
            // The rounded value, as in the generated code.
            Node::Const(value) => line(&value.to_f64()),
            node => {
                let operands: Vec<usize> = node.operands().map(index).collect();
                line(&(operation(node), operands));
            }
        }
    }
    text
}

/// Returns the word for an operation or a coordinate.
fn operation(node: &Node) -> &'static str {
    match node {
        Node::Const(_) => "constant",
        Node::Coord(Coord::X) => "x",
        Node::Coord(Coord::Y) => "y",
        Node::Coord(Coord::Z) => "z",
        Node::Coord(Coord::D) => "d",
        Node::Coord(Coord::Q) => "d squared",
        Node::Coord(Coord::Length) => "length",
        Node::Coord(Coord::PerLength) => "reciprocal of length",
        Node::Neg(_) => "negate",
        Node::Add(..) => "add",
        Node::Sub(..) => "subtract",
        Node::Mul(..) => "multiply",
        Node::Div(..) => "divide",
        Node::Quotient(..) => "divide or 0",
        Node::Min(..) => "min",
        Node::Max(..) => "max",
        Node::Abs(_) => "abs",
        Node::Sqrt(_) => "sqrt",
        Node::Select { .. } => "select",
    }
}

/// Writes a tree as nested tests.
fn tests(tree: &Tree) -> String {
    match tree {
        Tree::Leaf(owner) => format!("{owner:?}"),
        Tree::Split { curve, strict, below, above } => {
            format!("({curve} {strict} {} {})", tests(below), tests(above))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::digest;
    use crate::compile_with_arguments;
    use crate::source::Source;

    const BALL: &str = "tool Ball \"a ball\" {
        units mm;
        param D = 6;
        profile { start (0, 0); arc to (0, D) center (0, D/2) as ball cutting; }
        niceness cutting: 1 - depth/3;
    }";

    fn of(text: &str, given: &str) -> u64 {
        let given = if given.is_empty() { vec![] } else { vec![Source::new("given", given)] };
        let compiled = compile_with_arguments(&Source::new("ball.tool", text), &given);
        digest(&compiled.into_tool().expect("a tool without errors"))
    }

    #[test]
    fn names_titles_and_comments_do_not_change_the_digest() {
        let own = of(BALL, "");
        let others = [
            BALL.replace("\n", " "),
            BALL.replace("units", "// in millimetres\n units"),
            BALL.replace("a ball", "the ball"),
            BALL.replace("tool Ball", "tool Sphere"),
            BALL.replace("D = 6", "D = 12/2"),
            BALL.replace("D = 6", "D = 6mm"),
        ];
        for other in others {
            assert_eq!(of(&other, ""), own, "{other}");
        }
        assert_eq!(of(BALL, "D = 6"), own);
        assert_eq!(of(&BALL.replace("D = 6", "D = 8"), "D = 6"), own);
    }

    #[test]
    fn changed_outputs_change_the_digest() {
        let mut all = vec![of(BALL, ""), of(BALL, "D = 6.000000000000001")];
        for (from, to) in [
            ("mm", "inch"),
            ("D = 6", "D = 7"),
            ("1 - depth/3", "1 - depth/4"),
            ("as ball", "as sphere"),
            ("niceness", "magnitude: 2*depth; niceness"),
        ] {
            let other = BALL.replacen(from, to, 1);
            assert_ne!(other, BALL);
            all.push(of(&other, ""));
        }
        let count = all.len();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), count);
    }

    #[test]
    fn a_tool_without_a_profile_has_a_digest() {
        let text = |depth: &str| {
            format!(
                "tool Ball {{ units mm; region ball as ball cutting where hypot(d, z - 3) <= 3 {{ \
                 depth: {depth}; }} niceness cutting: 1; }}"
            )
        };
        let [one, other] = ["3 - hypot(d, z - 3)", "2*(3 - hypot(d, z - 3))"].map(text);
        assert_eq!(of(&one, ""), of(&one, ""));
        assert_ne!(of(&one, ""), of(&other, ""));
    }
}
