//! Expressions and the tree of splits as Rust: each test gives a mask of lanes, and each leaf adds lanes to the mask of its
//! region.

use super::alike::{Choices, Groups};
use super::names::Names;
use super::tokens::Tokens;
use crate::expr::{Coord, Graph, Id, Node};
use crate::formula::{Curve, CurveIndex, Side};
use crate::model::Model;
use crate::number::Number;
use crate::plan::Tree;
use crate::resolve::SHORTEST_SQUARE;
use proc_macro2::TokenStream;
use quote::quote;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// A writer of the body of the evaluator.
pub(super) struct Writer<'m> {
    graph: &'m Graph,
    curves: &'m [Curve],
    parameters: &'m BTreeMap<Id, Choices>,
    names: Names,
    /// The number of uses of each node. A node that is used once is written inline.
    use_counts: BTreeMap<Id, usize>,
}

impl<'m> Writer<'m> {
    /// Makes a writer of code that descends a tree and computes the outputs of groups of regions.
    pub(super) fn new(model: &'m Model, tree: &Tree, groups: &'m Groups) -> Writer<'m> {
        let Groups { graph, parameters, .. } = groups;
        let (curves, names) = (&model.curves, Names::new(model, groups));
        let mut writer = Writer { graph, curves, parameters, names, use_counts: BTreeMap::new() };
        let mut tests = BTreeSet::new();
        tested(tree, &mut tests);
        let mut all: Vec<Id> = groups.groups.iter().flat_map(|group| group.roots()).collect();
        for (curve, _) in tests {
            all.extend(writer.compared(curve));
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

    /// Returns the name of the mask of the lanes in a region.
    pub(super) fn mask(&self, region: usize) -> &str {
        self.names.mask(region)
    }

    fn mentions(&self, coord: Coord) -> bool {
        self.use_counts.keys().any(|id| *self.graph.node(*id) == Node::Coord(coord))
    }

    /// Returns the definitions that the function needs besides a point: the reciprocal of the unit of length,
    /// `d` and `q`.
    pub(super) fn given(&self) -> TokenStream {
        let per_length = self.mentions(Coord::PerLength).then(|| {
            quote! { let per_length = length.of(1.0) / length; }
        });
        let across = match (self.mentions(Coord::D), self.mentions(Coord::Q)) {
            (true, true) => quote! { let q = x * x + y * y; let d = q.sqrt(); },
            (true, false) => quote! { let d = (x * x + y * y).sqrt(); },
            (false, true) => quote! { let q = x * x + y * y; },
            (false, false) => quote! {},
        };
        quote! { #per_length #across }
    }

    /// Returns the nodes that a curve's test needs.
    fn compared(&self, curve: CurveIndex) -> impl Iterator<Item = Id> {
        self.curves[curve].sides(self.graph).into_iter().filter_map(|side| side.node())
    }

    /// Writes the test of a curve, whose shared operands are already bound.
    fn test(&self, code: &mut Tokens, curve: CurveIndex, strict: bool) {
        let [left, right] = self.curves[curve].sides(self.graph);
        code.lane(if strict { "lt" } else { "le" }, |code| {
            self.side(code, &left);
            code.sign(",");
            self.side(code, &right);
        });
    }

    /// Writes one side of a comparison.
    fn side(&self, code: &mut Tokens, side: &Side) {
        match side {
            Side::Node(id) => self.value(code, *id),
            Side::Constant(value) => {
                code.of_lanes(*value);
            }
        }
    }

    /// Writes a node as an operand: its name if it has one, else its expression.
    pub(super) fn value(&self, code: &mut Tokens, id: Id) {
        if self.named(id) {
            code.word(&self.names.value(id));
            return;
        }
        match self.graph.node(id) {
            Node::Add(..) | Node::Sub(..) | Node::Mul(..) | Node::Div(..) | Node::Neg(..) => {
                code.paren(|code| self.operation(code, id));
            }
            _ => self.operation(code, id),
        }
    }

    /// Returns whether a node is a parameter of a group of regions.
    pub(super) fn is_parameter(&self, id: Id) -> bool {
        self.parameters.contains_key(&id)
    }

    /// Returns whether a node has its own `let`.
    fn named(&self, id: Id) -> bool {
        let free = match *self.graph.node(id) {
            Node::Const(_) | Node::Coord(_) => true,
            Node::Neg(operand) => self.is_parameter(operand),
            _ => false,
        };
        self.is_parameter(id) || !free && self.use_counts.get(&id).is_some_and(|count| *count > 1)
    }

    /// Returns whether a node is the square of the length below which a vector has no direction.
    fn is_shortest(&self, id: &Id) -> bool {
        self.known(id) == Some(SHORTEST_SQUARE)
    }

    fn known(&self, id: &Id) -> Option<f64> {
        let constant = self.graph.constant(*id).filter(|_| !self.is_parameter(*id));
        constant.map(Number::to_f64)
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
    pub(super) fn operation(&self, code: &mut Tokens, id: Id) {
        match self.graph.node(id) {
            Node::Const(value) => {
                code.of_lanes(value.to_f64());
            }
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
                None => match self.graph.node(*b) {
                    // Only parameters have opposites in sums.
                    Node::Neg(parameter) => self.two(code, a, "-", parameter),
                    _ => self.two(code, a, "+", b),
                },
            },
            Node::Sub(a, b) => self.two(code, a, "-", b),
            // A product's constant is written on the right, since the trait `Lane` has `Self * f64` but not `f64 * Self`.
            Node::Mul(a, b) => match (self.known(a), self.known(b)) {
                (Some(factor), _) => {
                    self.value(code, *b);
                    code.sign("*").number(factor);
                }
                (None, Some(factor)) => {
                    self.value(code, *a);
                    code.sign("*").number(factor);
                }
                (None, None) => self.two(code, a, "*", b),
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
            Node::Select { low, high, then, other }
                if let (Node::Div(part, whole), Some(short), true) =
                    (self.graph.node(*other), self.known(then), self.is_shortest(high)) =>
            {
                code.lane("component", |code| {
                    self.two(code, low, ",", part);
                    code.sign(",");
                    self.value(code, *whole);
                    code.sign(",").number(short);
                });
            }
            Node::Select { low, high, then, other } => {
                code.lane("select", |code| {
                    self.call(code, "le", low, high);
                    code.sign(",");
                    self.two(code, then, ",", other);
                });
            }
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
            // A group writes its parameters itself.
            if self.named(id) && !self.is_parameter(id) && scope.insert(id) {
                code.word("let").word(&self.names.value(id)).sign("=");
                self.operation(code, id);
                code.sign(";");
            }
        }
    }
}

/// Collects the curves that a tree tests, each with the strictness of the test.
fn tested(tree: &Tree, tests: &mut BTreeSet<(CurveIndex, bool)>) {
    if let Tree::Split { curve, strict, below, above } = tree {
        tests.insert((*curve, *strict));
        tested(below, tests);
        tested(above, tests);
    }
}

impl Writer<'_> {
    /// Writes a descent of the tree, which sets the mask of each region. Returns the nodes that have a name at its end.
    pub(super) fn descent(&self, code: &mut Tokens, tree: &Tree) -> BTreeSet<Id> {
        let mut always = HashMap::new();
        self.always(tree, &mut always);
        let mut descent = Descent { writer: self, always, masks: 0 };
        descent.below(code, tree, "present", &BTreeSet::new())
    }

    /// Records, for each subtree, the nodes that every path down from it needs.
    fn always(&self, tree: &Tree, known: &mut HashMap<*const Tree, BTreeSet<Id>>) {
        let own = match tree {
            Tree::Leaf(_) => BTreeSet::new(),
            Tree::Split { curve, below, above, .. } => {
                self.always(below, known);
                self.always(above, known);
                let [below, above] =
                    [below, above].map(|side| &known[&std::ptr::from_ref(&**side)]);
                let compared = self.graph.dependencies(self.compared(*curve));
                below.intersection(above).copied().chain(compared).collect()
            }
        };
        known.insert(std::ptr::from_ref(tree), own);
    }
}

/// The state while writing a descent.
struct Descent<'w, 'm> {
    writer: &'w Writer<'m>,
    always: HashMap<*const Tree, BTreeSet<Id>>,
    /// The number of masks named so far.
    masks: usize,
}

impl Descent<'_, '_> {
    /// Writes the code for the lanes of a mask, and returns the nodes named in it.
    fn below(
        &mut self,
        code: &mut Tokens,
        tree: &Tree,
        mask: &str,
        scope: &BTreeSet<Id>,
    ) -> BTreeSet<Id> {
        let mut scope = scope.clone();
        let needed = self.always.get(&std::ptr::from_ref(tree)).into_iter().flatten().copied();
        self.writer.lets(code, needed, &mut scope);
        match tree {
            Tree::Leaf(None) => {}
            Tree::Leaf(Some(region)) => {
                code.word(self.writer.mask(*region)).sign("|=").word(mask).sign(";");
            }
            Tree::Split { curve, strict, below, above } => {
                code.word("let").word("test").sign("=");
                self.writer.test(code, *curve, *strict);
                code.sign(";");
                self.side(code, below, [mask, ""], &scope);
                self.side(code, above, [mask, "!"], &scope);
            }
        }
        scope
    }

    /// Writes one side of a split, for the lanes of a mask in which the test holds, or, after `!`, does not.
    fn side(
        &mut self,
        code: &mut Tokens,
        tree: &Tree,
        [mask, not]: [&str; 2],
        scope: &BTreeSet<Id>,
    ) {
        match tree {
            Tree::Leaf(None) => {}
            Tree::Leaf(Some(region)) => {
                let own = self.writer.mask(*region);
                code.word(own).sign("|=").word(mask).sign("&").sign(not).word("test").sign(";");
            }
            Tree::Split { .. } => {
                self.masks += 1;
                let lanes = format!("lanes{}", self.masks);
                code.word("let").word(&lanes).sign("=").word(mask).sign("&").sign(not).word("test");
                code.sign(";").word("if").any(|code| {
                    code.word(&lanes);
                });
                code.brace(|code| {
                    self.below(code, tree, &lanes, scope);
                });
            }
        }
    }
}
