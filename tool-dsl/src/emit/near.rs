//! Which points may be inside, in single precision: the test of membership with room for what a
//! point's place and `f32` leave open. It may be wrong one way only.

use super::code::{Form, Operand, Writer};
use super::line::{Bounds, Line, Slack};
use super::tokens::Tokens;
use crate::Checked;
use crate::expr::{Coord, Graph, Id, Node};
use crate::formula::CurveIndex;
use crate::plan::Tree;
use crate::prove::{Compared, slacks};
use proc_macro2::TokenStream;
use quote::quote;
use std::collections::BTreeSet;

/// A sign that a curve may have.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Sign {
    NotAbove,
    Above,
}

/// The function.
pub(super) fn near(tool: &Checked) -> TokenStream {
    let model = &tool.model;
    let (graph, size) = (&model.graph, tool.extent.scale());
    let mut signs = BTreeSet::new();
    asked(&tool.plan.inside, &mut signs);
    let line = |curve: CurveIndex| Line::of(graph, model.curves[curve].value);
    let bent: BTreeSet<CurveIndex> =
        signs.iter().map(|(curve, _)| *curve).filter(|curve| line(*curve).is_none()).collect();
    let writer =
        |roots: &[Id]| Writer::new(graph, &model.curves, Form::Lanes, roots, &BTreeSet::new());
    let sides = writer(&[]);
    let compared: Vec<Compared> = bent.iter().map(|curve| parts(&sides, *curve)).collect();
    let slacks = slacks(tool, &compared);
    let roots: Vec<Id> = compared
        .iter()
        .flat_map(|(_, nodes, _)| nodes)
        .map(|node| match root_of(graph, *node) {
            Some(Rooted::Node(square)) => square,
            _ => *node,
        })
        .collect();
    let writer = writer(&roots);
    let mut code = Tokens::default();
    writer.lets(&mut code, roots.iter().copied(), &mut BTreeSet::new());
    let mut bounds = Bounds::default();
    for (curve, sign) in &signs {
        code.word("let").word(&name(*curve, *sign)).sign("=");
        match (line(*curve), slacks.get(curve)) {
            (Some(line), _) => line.write(&mut code, &mut bounds, *sign, size),
            (None, Some(slack)) => {
                let slack = Slack { margin: slack.slope, rounding: slack.rounding };
                let test = Test { graph, writer: &writer, slack };
                test.write(&mut code, &mut bounds, writer.sides(*curve), *sign);
            }
            (None, None) => everywhere(&mut code),
        }
        code.sign(";");
    }
    logic(&mut code, &tool.plan.inside);
    let [compute, code] = bounds.done(&code.done());
    quote! {
        #compute

        #[inline(always)]
        fn near_lanes<L: Lane>([x, y, z]: [L; 3], bounds: &[f32]) -> L::Mask {
            let q = x * x + y * y;
            let d = q.sqrt();
            #code
        }
    }
}

fn parts(writer: &Writer<'_>, curve: CurveIndex) -> Compared {
    let (mut nodes, mut constant) = (Vec::new(), 0.0);
    for side in writer.sides(curve) {
        match side {
            Operand::Node(id) => nodes.push(id),
            Operand::Constant(value) => constant = value,
        }
    }
    (curve, nodes, constant)
}

/// What a length is the root of.
enum Rooted {
    Node(Id),
    /// `x² + y²`
    Across,
}

fn root_of(graph: &Graph, id: Id) -> Option<Rooted> {
    match graph.node(id) {
        Node::Sqrt(square) => Some(Rooted::Node(*square)),
        Node::Coord(Coord::D) => Some(Rooted::Across),
        _ => None,
    }
}

/// A curve's test with its slack.
struct Test<'g> {
    graph: &'g Graph,
    writer: &'g Writer<'g>,
    slack: Slack,
}

impl Test<'_> {
    fn write(&self, code: &mut Tokens, bounds: &mut Bounds, sides: [Operand; 2], sign: Sign) {
        match (sides, sign) {
            ([Operand::Node(a), Operand::Constant(c)], Sign::NotAbove)
            | ([Operand::Constant(c), Operand::Node(a)], Sign::Above) => {
                self.at_most(code, bounds, a, c);
            }
            ([Operand::Node(a), Operand::Constant(c)], Sign::Above)
            | ([Operand::Constant(c), Operand::Node(a)], Sign::NotAbove) => {
                self.at_least(code, bounds, a, c);
            }
            ([Operand::Node(a), Operand::Node(b)], Sign::NotAbove) => {
                self.order(code, bounds, a, b);
            }
            ([Operand::Node(a), Operand::Node(b)], Sign::Above) => self.order(code, bounds, b, a),
            // A curve is not a constant; if one were, nothing would be ruled out by it.
            ([Operand::Constant(_), Operand::Constant(_)], _) => everywhere(code),
        }
    }

    /// `a ≤ c`; of a length by its square.
    fn at_most(&self, code: &mut Tokens, bounds: &mut Bounds, a: Id, c: f64) {
        code.lane("le", |code| match root_of(self.graph, a) {
            Some(root) => {
                self.square(code, &root);
                code.sign(",").word(&bounds.most_squared(c, &self.slack));
            }
            None => {
                self.writer.value(code, a);
                code.sign(",").word(&bounds.most(c, &self.slack));
            }
        });
    }

    /// `a ≥ c`; of a length by its square.
    fn at_least(&self, code: &mut Tokens, bounds: &mut Bounds, a: Id, c: f64) {
        code.lane("le", |code| match root_of(self.graph, a) {
            Some(root) => {
                code.word(&bounds.least_squared(c, &self.slack)).sign(",");
                self.square(code, &root);
            }
            None => {
                code.word(&bounds.least(c, &self.slack)).sign(",");
                self.writer.value(code, a);
            }
        });
    }

    /// `a ≤ b`
    fn order(&self, code: &mut Tokens, bounds: &mut Bounds, a: Id, b: Id) {
        code.lane("le", |code| {
            self.writer.value(code, a);
            code.sign(",");
            self.writer.value(code, b);
            code.sign("+").word(&bounds.most(0.0, &self.slack));
        });
    }

    fn square(&self, code: &mut Tokens, root: &Rooted) {
        match root {
            Rooted::Node(id) => self.writer.value(code, *id),
            Rooted::Across => {
                code.word("q");
            }
        }
    }
}

/// Of every point that is a number.
pub(super) fn everywhere(code: &mut Tokens) {
    code.lane("le", |code| {
        code.word("z").sign(",").word("z");
    });
}

fn name(curve: CurveIndex, sign: Sign) -> String {
    match sign {
        Sign::NotAbove => format!("upto{curve}"),
        Sign::Above => format!("above{curve}"),
    }
}

/// The signs that the tree's logic asks for.
fn asked(tree: &Tree<bool>, signs: &mut BTreeSet<(CurveIndex, Sign)>) {
    let Tree::Split { curve, below, above, .. } = tree else { return };
    let [no, yes] = [false, true].map(Tree::Leaf);
    if **below != no {
        signs.insert((*curve, Sign::NotAbove));
    }
    if **above != no && **below != yes {
        signs.insert((*curve, Sign::Above));
    }
    asked(below, signs);
    asked(above, signs);
}

/// Whether a point may be on a way down to the inside.
fn logic(code: &mut Tokens, tree: &Tree<bool>) {
    let Tree::Split { curve, below, above, .. } = tree else {
        match tree {
            Tree::Leaf(true) => everywhere(code),
            _ => {
                code.lane("lt", |code| {
                    code.word("z").sign(",").word("z");
                });
            }
        }
        return;
    };
    let way = |code: &mut Tokens, sign: Sign, tree: &Tree<bool>| {
        let name = name(*curve, sign);
        if *tree == Tree::Leaf(true) {
            code.word(&name);
            return;
        }
        code.paren(|code| {
            code.word(&name).sign("&");
            logic(code, tree);
        });
    };
    let [no, yes] = [false, true].map(Tree::Leaf);
    if **above == no {
        way(code, Sign::NotAbove, below);
    } else if **below == no {
        way(code, Sign::Above, above);
    } else {
        code.paren(|code| {
            way(code, Sign::NotAbove, below);
            code.sign("|");
            // What is not below is above.
            if **below == yes {
                logic(code, above);
            } else {
                way(code, Sign::Above, above);
            }
        });
    }
}
