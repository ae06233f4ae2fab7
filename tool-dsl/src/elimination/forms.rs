//! Expressions as linear forms in the coordinates, and in monomials and roots of them, each taken as a
//! separate variable; and the facts known about such variables.

use crate::domain::Domain;
use crate::expr::polynomial::{Monomial, Polynomial, Polynomials, monomial_of};
use crate::expr::{Coord, Graph, Id, Node};
use crate::model::Model;
use crate::number::Number;
use std::collections::{BTreeMap, BTreeSet};

/// The monomial of the distance from the axis.
const RADIUS_MONOMIAL: Monomial = [1, 0, 0, 0];

/// A quantity that elimination treats as a separate variable.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Variable {
    /// A product of powers of coordinates.
    Monomial(Monomial),
    /// The value of a node that is a root or an absolute value.
    Root(Id),
}

/// A linear form, `Σ factor · variable + constant`.
#[derive(Clone, Debug)]
pub(super) struct Form {
    pub(super) factors: BTreeMap<usize, Number>,
    pub(super) constant: Number,
}

impl Default for Form {
    fn default() -> Form {
        Form { factors: BTreeMap::new(), constant: Number::int(0) }
    }
}

impl Form {
    fn variable(variable: usize) -> Form {
        Form { factors: BTreeMap::from([(variable, Number::int(1))]), ..Form::default() }
    }

    pub(super) fn plus(mut self, other: &Form, factor: &Number) -> Form {
        let sum = |own: &Number, term: &Number| {
            let term = factor * term;
            // A sum that cancels except for its last bits is 0.
            if own.nearly_equals(&-&term) { Number::int(0) } else { own + &term }
        };
        for (variable, term) in &other.factors {
            let own = self.factors.entry(*variable).or_insert(Number::int(0));
            *own = sum(own, term);
        }
        self.constant = sum(&self.constant, &other.constant);
        self
    }

    fn signed(self, other: &Form, negative: bool) -> Form {
        self.plus(other, &Number::int(if negative { -1 } else { 1 }))
    }

    fn negated(&self) -> Form {
        Form::default().signed(self, true)
    }
}

/// The variables encountered so far, with their indices.
pub(super) struct Variables<'m> {
    graph: &'m Graph,
    /// True in space. In the half plane regions meet in points, for which roots of several squares need no
    /// case distinction.
    is_space: bool,
    indices: BTreeMap<Variable, usize>,
}

impl<'m> Variables<'m> {
    pub(super) fn new(model: &'m Model) -> Variables<'m> {
        let is_space = model.domain == Domain::Space;
        Variables { graph: &model.graph, is_space, indices: BTreeMap::new() }
    }

    pub(super) fn count(&self) -> usize {
        self.indices.len()
    }

    pub(super) fn of(&mut self, variable: Variable) -> usize {
        let next = self.indices.len();
        *self.indices.entry(variable).or_insert(next)
    }

    /// Returns an expression as a linear form, if it is one.
    pub(super) fn form(&mut self, root: Id) -> Option<Form> {
        let mut polynomials = Polynomials::default();
        polynomials.of(self.graph, root);
        let polynomial = |id: &Id| polynomials.known(*id);
        // The terms of the form, each once, even if it is shared.
        let (mut pending, mut parts) = (vec![root], BTreeSet::new());
        while let Some(id) = pending.pop() {
            if parts.insert(id) && polynomial(&id).is_none() {
                match *self.graph.node(id) {
                    Node::Neg(a) => pending.push(a),
                    Node::Add(a, b) | Node::Sub(a, b) => pending.extend([a, b]),
                    Node::Mul(factor, b) if self.graph.constant(factor).is_some() => {
                        pending.push(b);
                    }
                    Node::Sqrt(_) | Node::Abs(_) => {}
                    _ => return None,
                }
            }
        }
        let mut forms: BTreeMap<Id, Form> = BTreeMap::new();
        for id in parts {
            let form = match (polynomial(&id), self.graph.node(id)) {
                (Some(polynomial), _) => self.of_polynomial(polynomial),
                (None, Node::Neg(a)) => forms[a].negated(),
                (None, Node::Add(a, b)) => forms[a].clone().signed(&forms[b], false),
                (None, Node::Sub(a, b)) => forms[a].clone().signed(&forms[b], true),
                (None, Node::Mul(factor, b)) => {
                    let factor = self.graph.constant(*factor).cloned();
                    Form::default().plus(&forms[b], &factor.unwrap_or(Number::int(0)))
                }
                _ => Form::variable(self.of(Variable::Root(id))),
            };
            forms.insert(id, form);
        }
        forms.remove(&root)
    }

    fn of_polynomial(&mut self, polynomial: &Polynomial) -> Form {
        let mut form = Form::default();
        for (monomial, factor) in polynomial.terms() {
            if monomial == [0; 4] {
                form.constant = factor.clone();
            } else {
                form.factors.insert(self.of(Variable::Monomial(monomial)), factor.clone());
            }
        }
        form
    }

    /// Returns two kinds of facts. First, forms that are nowhere above 0: the negative of a square, a
    /// distance or a root; and any term squared under a root, with either sign, minus the root. Second, for
    /// each root, alternatives of which at least one is at most 0 at every point: the root, plus or minus
    /// each term squared under it.
    pub(super) fn facts(&mut self) -> (Vec<Form>, Vec<(usize, Vec<Form>)>) {
        let (mut facts, mut choices) = (Vec::new(), Vec::new());
        for (variable, index) in self.indices.clone() {
            let negative = Form::variable(index).negated();
            let mut parts = Vec::new();
            match variable {
                Variable::Monomial(monomial) => {
                    if monomial == RADIUS_MONOMIAL {
                        let coordinates =
                            [Coord::X, Coord::Y].map(monomial_of).map(Variable::Monomial);
                        let indices =
                            coordinates.iter().filter_map(|v| self.indices.get(v).copied());
                        parts.extend(indices.map(Form::variable));
                    // A power with an odd exponent has both signs.
                    } else if monomial[1..].iter().any(|exponent| exponent % 2 == 1) {
                        continue;
                    }
                }
                Variable::Root(root) => {
                    let (squares, is_complete) = squares(self.graph, root);
                    let count = squares.len();
                    // Facts cover the existing variables only; forms with new ones are dropped.
                    let variables = self.indices.len();
                    parts.extend(squares.into_iter().filter_map(|part| self.form(part)));
                    parts.retain(|form| form.factors.keys().all(|v| *v < variables));
                    self.indices.retain(|_, at| *at < variables);
                    // For one square, `|u|` is `u` or `-u`. For several, a root is no more than the sum of their
                    // absolute values.
                    if is_complete && parts.len() == count && (count == 1 || self.is_space) {
                        let side = |signs: usize| {
                            parts
                                .iter()
                                .enumerate()
                                .fold(Form::variable(index), |sum, (k, part)| {
                                    sum.signed(part, signs >> k & 1 != 0)
                                })
                        };
                        choices.push((index, (0..1 << count).map(side).collect()));
                    }
                }
            }
            for part in parts {
                facts.extend([false, true].map(|sign| negative.clone().signed(&part, sign)));
            }
            facts.push(negative);
        }
        (facts, choices)
    }
}

/// Returns the terms squared under a root of a sum of squares, and whether the sum has no others. An absolute
/// value is the root of one square.
fn squares(graph: &Graph, root: Id) -> (Vec<Id>, bool) {
    let sum = match *graph.node(root) {
        Node::Sqrt(sum) => sum,
        Node::Abs(part) => return (vec![part], true),
        _ => return (Vec::new(), false),
    };
    let (mut pending, mut parts, mut is_complete) = (vec![sum], Vec::new(), true);
    while let Some(id) = pending.pop() {
        match *graph.node(id) {
            Node::Add(a, b) => pending.extend([a, b]),
            Node::Mul(a, b) if a == b => parts.push(a),
            // `q` is the sum of two squares, and a constant is one: more under the root only makes it larger.
            Node::Coord(Coord::Q) => is_complete = false,
            Node::Const(ref value) if !value.is_negative() => is_complete = false,
            _ => return (Vec::new(), false),
        }
    }
    (parts, is_complete)
}
