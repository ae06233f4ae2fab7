//! Expressions and trees of splits as Rust. A tree becomes nested `if`s where each leaf is an expression, masks
//! where it is an owner.

use super::tokens::Tokens;
use crate::expr::{Coord, Graph, Id, Node};
use crate::formula::{Curve, CurveIndex};
use crate::number::Number;
use crate::plan::Tree;
use proc_macro2::TokenStream;
use quote::quote;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// The two forms of generated code.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Form {
    /// `f64`, with nested `if`
    Scalar,
    /// Any lanes, with selects
    Lanes,
}

/// One side of a comparison.
enum Operand {
    Node(Id),
    Constant(f64),
}

/// A writer of the body of one function.
pub(super) struct Writer<'g> {
    graph: &'g Graph,
    curves: &'g [Curve],
    form: Form,
    /// The number of uses of each node in this function. A node that is used once is written inline.
    use_counts: BTreeMap<Id, usize>,
}

impl<'g> Writer<'g> {
    /// Makes a writer for a function that computes some roots and tests some curves.
    fn new(
        graph: &'g Graph,
        curves: &'g [Curve],
        form: Form,
        roots: &[Id],
        tested: &BTreeSet<(CurveIndex, bool)>,
    ) -> Writer<'g> {
        let mut writer = Writer { graph, curves, form, use_counts: BTreeMap::new() };
        let mut all: Vec<Id> = roots.to_vec();
        for (curve, _) in tested {
            all.extend(writer.compared(*curve));
        }
        for root in &all {
            *writer.use_counts.entry(*root).or_default() += 1;
        }
        for id in graph.dependencies(all) {
            for operand in graph.node(id).operands() {
                *writer.use_counts.entry(operand).or_default() += 1;
            }
        }
        writer
    }

    /// Makes a writer for a function that computes some roots and descends a tree.
    pub(super) fn of_tree<L>(
        graph: &'g Graph,
        curves: &'g [Curve],
        form: Form,
        roots: &[Id],
        tree: &Tree<L>,
    ) -> Writer<'g> {
        let mut tests = BTreeSet::new();
        tested(tree, &mut tests);
        Writer::new(graph, curves, form, roots, &tests)
    }

    /// Writes the test of a curve for people.
    pub(super) fn shown(
        graph: &Graph,
        curves: &[Curve],
        curve: CurveIndex,
        strict: bool,
    ) -> String {
        let writer = Writer { graph, curves, form: Form::Scalar, use_counts: BTreeMap::new() };
        let mut code = Tokens::default();
        writer.test(&mut code, curve, strict);
        code.done().to_string()
    }

    fn mentions(&self, coord: Coord) -> bool {
        self.use_counts.keys().any(|id| *self.graph.node(*id) == Node::Coord(coord))
    }

    /// Returns the definitions that the function needs besides a point: the reciprocal of the unit of length,
    /// `d` and `q`.
    pub(super) fn given(&self) -> TokenStream {
        let per_length = self.mentions(Coord::PerLength).then(|| {
            quote! { let per_length = Lane::of(length, 1.0) / length; }
        });
        let across = match (self.mentions(Coord::D), self.mentions(Coord::Q)) {
            (true, true) => quote! { let q = x * x + y * y; let d = q.sqrt(); },
            (true, false) => quote! { let d = (x * x + y * y).sqrt(); },
            (false, true) => quote! { let q = x * x + y * y; },
            (false, false) => quote! {},
        };
        quote! { #per_length #across }
    }

    /// Returns the two sides of `c ≤ 0` as `left ≤ right`. A rounded sum has the sign of its comparison
    /// exactly, so nothing is lost by not adding.
    fn sides(&self, curve: CurveIndex) -> [Operand; 2] {
        let value = self.curves[curve].value;
        match *self.graph.node(value) {
            Node::Sub(a, b) => [self.operand(a), self.operand(b)],
            Node::Neg(a) => [Operand::Constant(0.0), self.operand(a)],
            Node::Add(a, b) => match self.graph.constant(b) {
                Some(shift) => [self.operand(a), Operand::Constant(-shift.to_f64())],
                None => [self.operand(value), Operand::Constant(0.0)],
            },
            _ => [self.operand(value), Operand::Constant(0.0)],
        }
    }

    fn operand(&self, id: Id) -> Operand {
        match self.graph.constant(id) {
            Some(constant) => Operand::Constant(constant.to_f64()),
            None => Operand::Node(id),
        }
    }

    /// Returns the nodes that a curve's test needs.
    fn compared(&self, curve: CurveIndex) -> impl Iterator<Item = Id> {
        self.sides(curve).into_iter().filter_map(|operand| match operand {
            Operand::Node(id) => Some(id),
            Operand::Constant(_) => None,
        })
    }

    /// Writes the test of a curve, whose shared operands are already bound. In scalar code a constant is on
    /// the right.
    fn test(&self, code: &mut Tokens, curve: CurveIndex, strict: bool) {
        let [left, right] = self.sides(curve);
        if self.form == Form::Lanes {
            code.lane(if strict { "lt" } else { "le" }, |code| {
                self.side(code, &left);
                code.sign(",");
                self.side(code, &right);
            });
            return;
        }
        let mirrored = matches!(left, Operand::Constant(_));
        let (first, second) = if mirrored { (right, left) } else { (left, right) };
        self.side(code, &first);
        code.sign(match (mirrored, strict) {
            (false, false) => "<=",
            (false, true) => "<",
            (true, false) => ">=",
            (true, true) => ">",
        });
        self.side(code, &second);
    }

    /// Writes one side of a comparison.
    fn side(&self, code: &mut Tokens, side: &Operand) {
        match side {
            Operand::Node(id) => self.value(code, *id),
            Operand::Constant(value) => self.constant(code, *value),
        }
    }

    /// Writes a constant as an operand of its own.
    fn constant(&self, code: &mut Tokens, value: f64) {
        match self.form {
            Form::Scalar => code.number(value),
            Form::Lanes => code.of_lanes(value),
        };
    }

    /// Writes a node as an operand: its name if it has one, else its expression.
    pub(super) fn value(&self, code: &mut Tokens, id: Id) {
        if self.named(id) {
            code.word(&name(id));
            return;
        }
        match self.graph.node(id) {
            Node::Add(..) | Node::Sub(..) | Node::Mul(..) | Node::Div(..) | Node::Neg(..) => {
                code.paren(|code| self.operation(code, id));
            }
            _ => self.operation(code, id),
        }
    }

    /// Writes a node as the value of a block.
    fn leaf(&self, code: &mut Tokens, id: Id) {
        if self.named(id) { self.value(code, id) } else { self.operation(code, id) }
    }

    /// Returns whether a node has its own `let`.
    fn named(&self, id: Id) -> bool {
        let free = matches!(self.graph.node(id), Node::Const(_) | Node::Coord(_));
        !free && self.use_counts.get(&id).is_some_and(|count| *count > 1)
    }

    fn known(&self, id: &Id) -> Option<f64> {
        self.graph.constant(*id).map(Number::to_f64)
    }

    /// Writes two operands with a sign between them.
    fn two(&self, code: &mut Tokens, a: &Id, sign: &str, b: &Id) {
        self.value(code, *a);
        code.sign(sign);
        self.value(code, *b);
    }

    /// Writes the call of a function of lanes with two arguments.
    fn call(&self, code: &mut Tokens, name: &str, a: &Id, b: &Id) {
        code.lane(name, |code| self.two(code, a, ",", b));
    }

    /// Writes a node's operation, even if the node has a name.
    fn operation(&self, code: &mut Tokens, id: Id) {
        match self.graph.node(id) {
            Node::Const(value) => self.constant(code, value.to_f64()),
            Node::Coord(coord) => {
                code.word(match coord {
                    Coord::X => "x",
                    Coord::Y => "y",
                    Coord::Z => "z",
                    Coord::D => "d",
                    Coord::Q => "q",
                    Coord::Length => "length",
                    Coord::PerLength => "per_length",
                });
            }
            Node::Neg(a) => {
                code.sign("-");
                self.value(code, *a);
            }
            Node::Add(a, b) => match self.known(b) {
                Some(shift) => {
                    self.value(code, *a);
                    code.sign(if shift < 0.0 { "-" } else { "+" }).number(shift.abs());
                }
                None => self.two(code, a, "+", b),
            },
            Node::Sub(a, b) => self.two(code, a, "-", b),
            // The graph has a product's constant on the left. It is written on the right, since the trait `Lane`
            // has `Self * f64` but not `f64 * Self`.
            Node::Mul(a, b) => match self.known(a) {
                Some(factor) => {
                    self.value(code, *b);
                    code.sign("*").number(factor);
                }
                None => self.two(code, a, "*", b),
            },
            Node::Div(a, b) => self.two(code, a, "/", b),
            Node::Quotient(a, b) => self.call(code, "quotient", a, b),
            Node::Min(a, b) => self.call(code, "min", a, b),
            Node::Max(a, b) => self.call(code, "max", a, b),
            Node::Abs(a) => {
                self.value(code, *a);
                code.sign(".").word("abs").paren(|_| {});
            }
            Node::Sqrt(a) => {
                self.value(code, *a);
                code.sign(".").word("sqrt").paren(|_| {});
            }
            Node::Select { low, high, then, other } => match self.form {
                Form::Scalar => {
                    code.word("if");
                    self.two(code, low, "<=", high);
                    code.brace(|code| self.value(code, *then));
                    code.word("else").brace(|code| self.value(code, *other));
                }
                Form::Lanes => {
                    code.lane("select", |code| {
                        self.call(code, "le", low, high);
                        code.sign(",");
                        self.two(code, then, ",", other);
                    });
                }
            },
        }
    }

    /// Writes a `let` for every shared node that some roots need and that is not yet in scope.
    pub(super) fn lets(
        &self,
        code: &mut Tokens,
        roots: impl IntoIterator<Item = Id>,
        scope: &mut BTreeSet<Id>,
    ) {
        // Operands come first, so every name is defined before its use.
        for id in self.graph.dependencies(roots) {
            if self.named(id) && scope.insert(id) {
                code.word("let").word(&name(id)).sign("=");
                self.operation(code, id);
                code.sign(";");
            }
        }
    }
}

/// Collects the curves that a tree tests, each with the strictness of the test.
fn tested<L>(tree: &Tree<L>, tests: &mut BTreeSet<(CurveIndex, bool)>) {
    if let Tree::Split { curve, strict, below, above } = tree {
        tests.insert((*curve, *strict));
        tested(below, tests);
        tested(above, tests);
    }
}

fn name(id: Id) -> String {
    format!("t{}", id.index())
}

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

/// The lanes of a mask on one side of a test, by the names of both; `not` is `!` where the test fails.
struct LanesOfSide<'n> {
    mask: &'n str,
    not: &'n str,
    test: &'n str,
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
                self.side(code, below, LanesOfSide { mask, not: "", test: &test }, &scope);
                self.side(code, above, LanesOfSide { mask, not: "!", test: &test }, &scope);
            }
        }
        scope
    }

    /// Writes one side of a split, unless it is the default leaf.
    fn side(
        &mut self,
        code: &mut Tokens,
        tree: &Tree<L>,
        LanesOfSide { mask, not, test }: LanesOfSide<'_>,
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
