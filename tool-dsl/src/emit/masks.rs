//! Trees as lanes take them: every test a mask, selects and logic over these.

use super::tokens::Tokens;
use crate::formula::CurveIndex;
use crate::plan::Tree;
use std::collections::BTreeSet;

/// A tree as selects over masks.
pub(super) fn selects<L>(code: &mut Tokens, tree: &Tree<L>, leaf: &impl Fn(&mut Tokens, &L)) {
    match tree {
        Tree::Leaf(own) => leaf(code, own),
        Tree::Split { curve, strict, below, above } => {
            code.lane("select", |code| {
                code.word(&mask(*curve, *strict)).sign(",");
                selects(code, below, leaf);
                code.sign(",");
                selects(code, above, leaf);
            });
        }
    }
}

/// A tree of yes and no as logic over masks.
pub(super) fn logic(code: &mut Tokens, tree: &Tree<bool>) {
    let Tree::Split { curve, strict, below, above } = tree else {
        let name = if *tree == Tree::Leaf(true) { "le" } else { "lt" };
        code.lane(name, |code| {
            code.word("z").sign(",").word("z");
        });
        return;
    };
    let mask = mask(*curve, *strict);
    let with = |code: &mut Tokens, not: &str, sign: &str, tree: &Tree<bool>| {
        code.paren(|code| {
            code.sign(not).word(&mask).sign(sign);
            logic(code, tree);
        });
    };
    match (&**below, &**above) {
        (Tree::Leaf(true), Tree::Leaf(false)) => {
            code.word(&mask);
        }
        (Tree::Leaf(false), Tree::Leaf(true)) => {
            code.sign("!").word(&mask);
        }
        (Tree::Leaf(false), above) => with(code, "!", "&", above),
        (below, Tree::Leaf(false)) => with(code, "", "&", below),
        (Tree::Leaf(true), above) => with(code, "", "|", above),
        (below, Tree::Leaf(true)) => with(code, "!", "|", below),
        (below, above) => {
            code.paren(|code| {
                with(code, "", "&", below);
                code.sign("|");
                with(code, "!", "&", above);
            });
        }
    }
}

/// The curves that a tree tests, and how.
pub(super) fn tested<L>(tree: &Tree<L>, tests: &mut BTreeSet<(CurveIndex, bool)>) {
    if let Tree::Split { curve, strict, below, above } = tree {
        tests.insert((*curve, *strict));
        tested(below, tests);
        tested(above, tests);
    }
}

pub(super) fn mask(curve: CurveIndex, strict: bool) -> String {
    if strict { format!("before{curve}") } else { format!("upto{curve}") }
}
