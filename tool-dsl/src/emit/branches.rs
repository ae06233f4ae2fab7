//! Trees of splits as Rust: nested `if`s for one point, masks for lanes.

use super::code::Writer;
use super::tokens::Tokens;
use crate::expr::Id;
use crate::plan::Tree;
use std::collections::{BTreeSet, HashMap};

impl Writer<'_> {
    /// A tree as nested `if`s; `leaf` writes a leaf's value and `needs` names its nodes. What every
    /// way down will need is computed before the first test.
    pub(super) fn nested<L>(
        &self,
        code: &mut Tokens,
        tree: &Tree<L>,
        needs: &impl Fn(&L) -> Vec<Id>,
        leaf: &impl Fn(&mut Tokens, &L),
    ) {
        let mut always = HashMap::new();
        self.always(tree, needs, &mut always);
        self.branch(code, tree, &always, leaf, &BTreeSet::new());
    }

    /// A tree's code, and whether it is nothing but an `if`.
    fn branch<L>(
        &self,
        code: &mut Tokens,
        tree: &Tree<L>,
        always: &HashMap<*const Tree<L>, BTreeSet<Id>>,
        leaf: &impl Fn(&mut Tokens, &L),
        scope: &BTreeSet<Id>,
    ) -> bool {
        let mut scope = scope.clone();
        let needed = always.get(&std::ptr::from_ref(tree)).into_iter().flatten().copied();
        let mut lets = Tokens::default();
        self.lets(&mut lets, needed, &mut scope);
        let bare = lets.is_empty();
        code.add(lets);
        let Tree::Split { curve, strict, below, above } = tree else {
            if let Tree::Leaf(own) = tree {
                leaf(code, own);
            }
            return false;
        };
        let mut sides = [Tokens::default(), Tokens::default()];
        self.branch(&mut sides[0], below, always, leaf, &scope);
        let chained = self.branch(&mut sides[1], above, always, leaf, &scope);
        let [below, above] = sides;
        if below.is_word("true") && above.is_word("false") {
            self.test(code, *curve, *strict);
            return false;
        }
        code.word("if");
        self.test(code, *curve, *strict);
        code.brace(|code| {
            code.add(below);
        });
        code.word("else");
        if chained {
            code.add(above);
        } else {
            code.brace(|code| {
                code.add(above);
            });
        }
        bare
    }

    /// Notes the nodes that every way down a tree needs, for each of its trees.
    fn always<L>(
        &self,
        tree: &Tree<L>,
        needs: &impl Fn(&L) -> Vec<Id>,
        known: &mut HashMap<*const Tree<L>, BTreeSet<Id>>,
    ) {
        let own = match tree {
            Tree::Leaf(leaf) => self.graph.needed(needs(leaf)).into_iter().collect(),
            Tree::Split { curve, below, above, .. } => {
                self.always(below, needs, known);
                self.always(above, needs, known);
                let [below, above] =
                    [below, above].map(|side| &known[&std::ptr::from_ref(&**side)]);
                let compared = self.graph.needed(self.compared(*curve));
                below.intersection(above).copied().chain(compared).collect()
            }
        };
        known.insert(std::ptr::from_ref(tree), own);
    }

    /// A tree as lanes walk it: `leaf` is told the mask of the lanes that come to it. The nodes that
    /// are named at the end are returned.
    pub(super) fn walked<L: PartialEq + Default>(
        &self,
        code: &mut Tokens,
        tree: &Tree<L>,
        leaf: &impl Fn(&mut Tokens, &str, &L),
    ) -> BTreeSet<Id> {
        let mut always = HashMap::new();
        self.always(tree, &|_| vec![], &mut always);
        let mut walk = Walk { writer: self, always, masks: 0, leaf };
        walk.below(code, tree, "present", &BTreeSet::new())
    }
}

/// A walk of lanes down a tree, as it is written.
struct Walk<'w, 'g, L, F> {
    writer: &'w Writer<'g>,
    always: HashMap<*const Tree<L>, BTreeSet<Id>>,
    /// How many masks have a name.
    masks: usize,
    leaf: &'w F,
}

impl<L: PartialEq + Default, F: Fn(&mut Tokens, &str, &L)> Walk<'_, '_, L, F> {
    /// The code for the lanes of a mask, and what is named in it.
    fn below(
        &mut self,
        code: &mut Tokens,
        tree: &Tree<L>,
        mask: &str,
        scope: &BTreeSet<Id>,
    ) -> BTreeSet<Id> {
        let mut scope = scope.clone();
        let needed = self.always.get(&std::ptr::from_ref(tree)).into_iter().flatten().copied();
        self.writer.lets(code, needed, &mut scope);
        match tree {
            Tree::Leaf(own) => (self.leaf)(code, mask, own),
            Tree::Split { curve, strict, below, above } => {
                self.masks += 1;
                let test = format!("test{}", self.masks);
                code.word("let").word(&test).sign("=");
                self.writer.test(code, *curve, *strict);
                code.sign(";");
                self.side(code, below, (mask, "", &test), &scope);
                self.side(code, above, (mask, "!", &test), &scope);
            }
        }
        scope
    }

    /// One side of a split, if it leads anywhere.
    fn side(
        &mut self,
        code: &mut Tokens,
        tree: &Tree<L>,
        (mask, not, test): (&str, &str, &str),
        scope: &BTreeSet<Id>,
    ) {
        if *tree == Tree::Leaf(L::default()) {
            return;
        }
        self.masks += 1;
        let own = format!("lanes{}", self.masks);
        code.word("let").word(&own).sign("=").word(mask).sign("&").sign(not).word(test).sign(";");
        if let Tree::Leaf(leaf) = tree {
            (self.leaf)(code, &own, leaf);
            return;
        }
        code.word("if").any(&own);
        let mut inner = Tokens::default();
        self.below(&mut inner, tree, &own, scope);
        code.brace(|code| {
            code.add(inner);
        });
    }
}
