//! Expressions and trees as Rust.

use crate::expr::{Coord, Graph, Id, Node};
use crate::formula::CurveIndex;
use crate::model::Curve;
use crate::plan::Tree;
use proc_macro2::{Ident, Literal, Span, TokenStream, TokenTree};
use quote::{format_ident, quote};
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

/// Writes the body of one function.
pub(super) struct Writer<'g> {
    graph: &'g Graph,
    curves: &'g [Curve],
    form: Form,
    /// How often a node is used in this function: what is used once is written in its place.
    uses: BTreeMap<Id, usize>,
}

impl<'g> Writer<'g> {
    /// A writer for a function that computes some roots and tests some curves.
    pub(super) fn new(
        graph: &'g Graph,
        curves: &'g [Curve],
        form: Form,
        roots: &[Id],
        tested: &BTreeSet<(CurveIndex, bool)>,
    ) -> Writer<'g> {
        let mut writer = Writer { graph, curves, form, uses: BTreeMap::new() };
        let mut all: Vec<Id> = roots.to_vec();
        for (curve, _) in tested {
            all.extend(writer.compared(*curve));
        }
        for root in &all {
            *writer.uses.entry(*root).or_default() += 1;
        }
        for id in graph.needed(all) {
            for operand in graph.node(id).operands() {
                *writer.uses.entry(operand).or_default() += 1;
            }
        }
        writer
    }

    /// A curve's test as a person reads it.
    pub(super) fn shown(
        graph: &Graph,
        curves: &[Curve],
        curve: CurveIndex,
        strict: bool,
    ) -> String {
        let writer = Writer { graph, curves, form: Form::Scalar, uses: BTreeMap::new() };
        writer.test(curve, strict).to_string()
    }

    /// The definitions of `d` and `q` where the function needs them.
    pub(super) fn coordinates(&self) -> TokenStream {
        let uses = |coord| self.uses.keys().any(|id| *self.graph.node(*id) == Node::Coord(coord));
        match (uses(Coord::D), uses(Coord::Q)) {
            (true, true) => quote! { let q = x * x + y * y; let d = q.sqrt(); },
            (true, false) => quote! { let d = (x * x + y * y).sqrt(); },
            (false, true) => quote! { let q = x * x + y * y; },
            (false, false) => quote! {},
        }
    }

    /// The two sides of `c ≤ 0` as `left ≤ right`; a sum has the sign of its comparison exactly, so
    /// nothing is lost by not adding it up.
    fn sides(&self, curve: CurveIndex) -> [Operand; 2] {
        let value = self.curves[curve].value;
        let operand = |id: Id| match self.graph.constant(id) {
            Some(constant) => Operand::Constant(constant.to_f64()),
            None => Operand::Node(id),
        };
        match *self.graph.node(value) {
            Node::Sub(a, b) => [operand(a), operand(b)],
            Node::Neg(a) => [Operand::Constant(0.0), operand(a)],
            Node::Add(a, b) => match self.graph.constant(b) {
                Some(shift) => [operand(a), Operand::Constant(-shift.to_f64())],
                None => [operand(value), Operand::Constant(0.0)],
            },
            _ => [operand(value), Operand::Constant(0.0)],
        }
    }

    /// The nodes that a curve's test needs.
    fn compared(&self, curve: CurveIndex) -> impl Iterator<Item = Id> {
        self.sides(curve).into_iter().filter_map(|operand| match operand {
            Operand::Node(id) => Some(id),
            Operand::Constant(_) => None,
        })
    }

    /// The test of a curve, its operands already bound where they are shared. A constant stands on
    /// the right.
    fn test(&self, curve: CurveIndex, strict: bool) -> TokenStream {
        let sides = self.sides(curve);
        let flipped = matches!(sides[0], Operand::Constant(_));
        let [left, right] = sides.map(|side| match side {
            Operand::Node(id) => self.value(id),
            Operand::Constant(value) => self.constant(value),
        });
        match (self.form, strict, flipped) {
            (Form::Scalar, false, false) => quote! { #left <= #right },
            (Form::Scalar, true, false) => quote! { #left < #right },
            (Form::Scalar, false, true) => quote! { #right >= #left },
            (Form::Scalar, true, true) => quote! { #right > #left },
            (Form::Lanes, false, _) => quote! { Lane::le(#left, #right) },
            (Form::Lanes, true, _) => quote! { Lane::lt(#left, #right) },
        }
    }

    /// A constant as an operand of its own.
    fn constant(&self, value: f64) -> TokenStream {
        let literal = literal(value);
        match self.form {
            Form::Scalar => literal,
            Form::Lanes => quote! { z.of(#literal) },
        }
    }

    fn literal_of(&self, id: Id) -> TokenStream {
        self.constant(self.graph.constant(id).map_or(0.0, crate::number::Number::to_f64))
    }

    /// A node where it is used: its name if it has one, else its expression.
    fn value(&self, id: Id) -> TokenStream {
        if self.named(id) {
            let name = name(id);
            return quote! { #name };
        }
        let inner = self.operation(id);
        match self.graph.node(id) {
            Node::Add(..) | Node::Sub(..) | Node::Mul(..) | Node::Div(..) | Node::Neg(..) => {
                quote! { (#inner) }
            }
            _ => inner,
        }
    }

    /// A node as the value of a block.
    pub(super) fn leaf(&self, id: Id) -> TokenStream {
        if self.named(id) { self.value(id) } else { self.operation(id) }
    }

    /// Whether a node has a `let` of its own.
    fn named(&self, id: Id) -> bool {
        let free = matches!(self.graph.node(id), Node::Const(_) | Node::Coord(_));
        !free && self.uses.get(&id).is_some_and(|uses| *uses > 1)
    }

    /// A node's operation, whatever its name.
    fn operation(&self, id: Id) -> TokenStream {
        let v = |id: &Id| self.value(*id);
        match self.graph.node(id) {
            Node::Const(_) => self.literal_of(id),
            Node::Coord(coord) => {
                let name = Ident::new(
                    match coord {
                        Coord::X => "x",
                        Coord::Y => "y",
                        Coord::Z => "z",
                        Coord::D => "d",
                        Coord::Q => "q",
                        Coord::Length => "length",
                        Coord::PerLength => "per_length",
                    },
                    Span::call_site(),
                );
                quote! { #name }
            }
            Node::Neg(a) => {
                let a = v(a);
                quote! { -#a }
            }
            Node::Add(a, b) => {
                let a = v(a);
                match self.graph.constant(*b).map(crate::number::Number::to_f64) {
                    Some(shift) => {
                        let size = literal(shift.abs());
                        if shift < 0.0 {
                            quote! { #a - #size }
                        } else {
                            quote! { #a + #size }
                        }
                    }
                    None => {
                        let b = v(b);
                        quote! { #a + #b }
                    }
                }
            }
            Node::Sub(a, b) => {
                let (a, b) = (v(a), v(b));
                quote! { #a - #b }
            }
            Node::Mul(a, b) => match self.graph.constant(*a).map(crate::number::Number::to_f64) {
                Some(factor) => {
                    let (factor, b) = (literal(factor), v(b));
                    quote! { #b * #factor }
                }
                None => {
                    let (a, b) = (v(a), v(b));
                    quote! { #a * #b }
                }
            },
            Node::Div(a, b) => {
                let (a, b) = (v(a), v(b));
                quote! { #a / #b }
            }
            Node::Quotient(a, b) => {
                let (a, b) = (v(a), v(b));
                quote! { Lane::quotient(#a, #b) }
            }
            Node::Min(a, b) => {
                let (a, b) = (v(a), v(b));
                quote! { Lane::min(#a, #b) }
            }
            Node::Max(a, b) => {
                let (a, b) = (v(a), v(b));
                quote! { Lane::max(#a, #b) }
            }
            Node::Abs(a) => {
                let a = v(a);
                quote! { #a.abs() }
            }
            Node::Sqrt(a) => {
                let a = v(a);
                quote! { #a.sqrt() }
            }
            Node::Select { low, high, then, other } => {
                let (low, high, then, other) = (v(low), v(high), v(then), v(other));
                match self.form {
                    Form::Scalar => quote! { if #low <= #high { #then } else { #other } },
                    Form::Lanes => quote! { Lane::select(Lane::le(#low, #high), #then, #other) },
                }
            }
        }
    }

    /// A `let` for every shared node that some roots need and that is not yet in scope.
    fn lets(&self, roots: impl IntoIterator<Item = Id>, scope: &mut BTreeSet<Id>) -> TokenStream {
        // Operands first, so every name is known where it is used.
        let mut lets = TokenStream::new();
        for id in self.graph.needed(roots) {
            if self.named(id) && scope.insert(id) {
                let (name, operation) = (name(id), self.operation(id));
                lets.extend(quote! { let #name = #operation; });
            }
        }
        lets
    }

    /// A tree as nested `if`s; `leaf` writes a leaf's value and `needs` names its nodes. What every
    /// way down will need is computed before the first test.
    pub(super) fn nested<L>(
        &self,
        tree: &Tree<L>,
        needs: &impl Fn(&L) -> Vec<Id>,
        leaf: &impl Fn(&Self, &L) -> TokenStream,
    ) -> TokenStream {
        let mut always = HashMap::new();
        self.always(tree, needs, &mut always);
        self.branch(tree, &always, leaf, &BTreeSet::new()).0
    }

    /// A tree's code, and whether it is nothing but an `if`.
    fn branch<L>(
        &self,
        tree: &Tree<L>,
        always: &HashMap<*const Tree<L>, BTreeSet<Id>>,
        leaf: &impl Fn(&Self, &L) -> TokenStream,
        scope: &BTreeSet<Id>,
    ) -> (TokenStream, bool) {
        let mut scope = scope.clone();
        let needed = always.get(&std::ptr::from_ref(tree)).into_iter().flatten().copied();
        let lets = self.lets(needed, &mut scope);
        match tree {
            Tree::Leaf(own) => {
                let value = leaf(self, own);
                (quote! { #lets #value }, false)
            }
            Tree::Split { curve, strict, below, above } => {
                let test = self.test(*curve, *strict);
                let leaves = matches!((&**below, &**above), (Tree::Leaf(_), Tree::Leaf(_)));
                let (below, _) = self.branch(below, always, leaf, &scope);
                let (above, chained) = self.branch(above, always, leaf, &scope);
                let bare = lets.is_empty();
                if leaves && is_word(&below, "true") && is_word(&above, "false") {
                    (quote! { #lets #test }, false)
                } else if chained {
                    (quote! { #lets if #test { #below } else #above }, bare)
                } else {
                    (quote! { #lets if #test { #below } else { #above } }, bare)
                }
            }
        }
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

    /// The definitions that lanes need for some roots and tests: shared nodes, then masks.
    pub(super) fn straight(
        &self,
        roots: &[Id],
        tested: &BTreeSet<(CurveIndex, bool)>,
    ) -> TokenStream {
        let compared = tested.iter().flat_map(|(curve, _)| self.compared(*curve));
        let mut code = self.lets(roots.iter().copied().chain(compared), &mut BTreeSet::new());
        for (curve, strict) in tested {
            let (mask, test) = (mask(*curve, *strict), self.test(*curve, *strict));
            code.extend(quote! { let #mask = #test; });
        }
        code
    }

    /// A tree as selects over masks.
    pub(super) fn selects(&self, tree: &Tree<Id>) -> TokenStream {
        match tree {
            Tree::Leaf(id) => self.value(*id),
            Tree::Split { curve, strict, below, above } => {
                let mask = mask(*curve, *strict);
                let (below, above) = (self.selects(below), self.selects(above));
                quote! { Lane::select(#mask, #below, #above) }
            }
        }
    }

    /// A tree of yes and no as logic over masks.
    pub(super) fn logic(&self, tree: &Tree<bool>) -> TokenStream {
        match tree {
            Tree::Leaf(true) => quote! { Lane::le(z, z) },
            Tree::Leaf(false) => quote! { Lane::lt(z, z) },
            Tree::Split { curve, strict, below, above } => {
                let mask = mask(*curve, *strict);
                match (&**below, &**above) {
                    (Tree::Leaf(true), Tree::Leaf(false)) => quote! { #mask },
                    (Tree::Leaf(false), Tree::Leaf(true)) => quote! { !#mask },
                    (Tree::Leaf(false), above) => {
                        let above = self.logic(above);
                        quote! { (!#mask & #above) }
                    }
                    (below, Tree::Leaf(false)) => {
                        let below = self.logic(below);
                        quote! { (#mask & #below) }
                    }
                    (Tree::Leaf(true), above) => {
                        let above = self.logic(above);
                        quote! { (#mask | #above) }
                    }
                    (below, Tree::Leaf(true)) => {
                        let below = self.logic(below);
                        quote! { (!#mask | #below) }
                    }
                    (below, above) => {
                        let (below, above) = (self.logic(below), self.logic(above));
                        quote! { ((#mask & #below) | (!#mask & #above)) }
                    }
                }
            }
        }
    }
}

fn is_word(code: &TokenStream, word: &str) -> bool {
    let mut tokens = code.clone().into_iter();
    let first = tokens.next();
    tokens.next().is_none() && matches!(first, Some(TokenTree::Ident(ident)) if ident == word)
}

/// The curves that a tree tests, and how.
pub(super) fn tested<L>(tree: &Tree<L>, tests: &mut BTreeSet<(CurveIndex, bool)>) {
    if let Tree::Split { curve, strict, below, above } = tree {
        tests.insert((*curve, *strict));
        tested(below, tests);
        tested(above, tests);
    }
}

fn name(id: Id) -> Ident {
    format_ident!("t{}", id.index())
}

pub(super) fn mask(curve: CurveIndex, strict: bool) -> Ident {
    if strict { format_ident!("before{curve}") } else { format_ident!("upto{curve}") }
}

/// A double as a literal that reads back as the same double.
pub(super) fn literal(value: f64) -> TokenStream {
    let size = value.abs();
    let plain = size == 0.0 || (1e-5..1e16).contains(&size);
    let literal = if plain { None } else { format!("{size:e}").parse().ok() };
    let literal = literal.unwrap_or_else(|| Literal::f64_unsuffixed(size));
    if value.is_sign_negative() && size != 0.0 {
        quote! { -#literal }
    } else {
        quote! { #literal }
    }
}
