//! Trees of splits as Rust: nested `if`s where each leaf is an expression, masks where it is an owner.

use super::code::Writer;
use super::tokens::Tokens;
use crate::expr::Id;
use crate::plan::Tree;
use std::collections::{BTreeSet, HashMap};

impl Writer<'_> {
    /// Writes a tree of expressions as nested `if`s. Nodes that every path down the tree needs are computed
    /// before the first test.
    pub(super) fn nested(&self, code: &mut Tokens, tree: &Tree<Id>) {
        let mut always = HashMap::new();
        self.always(tree, &|id| vec![*id], &mut always);
        self.branch(code, tree, &always, &BTreeSet::new());
    }

    /// Writes a tree's code, and returns whether it is a single `if`.
    fn branch(
        &self,
        code: &mut Tokens,
        tree: &Tree<Id>,
        always: &HashMap<*const Tree<Id>, BTreeSet<Id>>,
        scope: &BTreeSet<Id>,
    ) -> bool {
        let mut scope = scope.clone();
        let needed = always.get(&std::ptr::from_ref(tree)).into_iter().flatten().copied();
        let mut lets = Tokens::default();
        self.lets(&mut lets, needed, &mut scope);
        let without_lets = lets.is_empty();
        code.add(lets);
        let (curve, strict, below, above) = match tree {
            Tree::Leaf(id) => {
                self.leaf(code, *id);
                return false;
            }
            Tree::Split { curve, strict, below, above } => (*curve, *strict, below, above),
        };
        code.word("if");
        self.test(code, curve, strict);
        code.brace(|code| {
            self.branch(code, below, always, &scope);
        });
        let mut other = Tokens::default();
        let is_chain = self.branch(&mut other, above, always, &scope);
        code.word("else");
        if is_chain {
            code.add(other);
        } else {
            code.brace(|code| {
                code.add(other);
            });
        }
        without_lets
    }

    /// Records, for each subtree, the nodes that every path down from it needs.
    fn always<L>(
        &self,
        tree: &Tree<L>,
        needs: &impl Fn(&L) -> Vec<Id>,
        known: &mut HashMap<*const Tree<L>, BTreeSet<Id>>,
    ) {
        let own = match tree {
            Tree::Leaf(leaf) => self.graph.dependencies(needs(leaf)).into_iter().collect(),
            Tree::Split { curve, below, above, .. } => {
                self.always(below, needs, known);
                self.always(above, needs, known);
                let [below, above] =
                    [below, above].map(|side| &known[&std::ptr::from_ref(&**side)]);
                let compared = self.graph.dependencies(self.compared(*curve));
                below.intersection(above).copied().chain(compared).collect()
            }
        };
        known.insert(std::ptr::from_ref(tree), own);
    }

    /// Writes a tree as a traversal by lanes. `leaf` receives the mask of the lanes that reach it. Returns
    /// the nodes that have a name at the end.
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

/// The state while writing a traversal by lanes.
struct Walk<'w, 'g, L, F> {
    writer: &'w Writer<'g>,
    always: HashMap<*const Tree<L>, BTreeSet<Id>>,
    /// The number of masks named so far.
    masks: usize,
    leaf: &'w F,
}

impl<L: PartialEq + Default, F: Fn(&mut Tokens, &str, &L)> Walk<'_, '_, L, F> {
    /// Writes the code for the lanes of a mask, and returns the nodes named in it.
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

    /// Writes one side of a split, unless it is the default leaf.
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
