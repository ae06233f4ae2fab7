//! Proofs that no point has given signs.
//!
//! Two ways are tried. Curves that are linear in the coordinates (or in monomials and roots of them,
//! each taken for a variable of its own) are refuted by Fourier and Motzkin's elimination, which sees
//! where borders meet in a corner, to a part in 10^12. Other curves are enclosed over boxes that cover the
//! domain.

use super::eliminate::{Condition, ROUNDING, scaled, without};
use crate::bound::{Prover, halves};
use crate::domain::Domain;
use crate::expr::interval::{self, Cell, EVERYTHING, Interval};
use crate::expr::polynomial::{Monomial, Polynomial, Polynomials, monomial_of};
use crate::expr::{Coord, Graph, Id, Node};
use crate::formula::{ANY, NEGATIVE, POSITIVE, Signs, ZERO};
use crate::model::Model;
use crate::number::Number;
use std::collections::{BTreeMap, BTreeSet};

/// The most boxes of one proof, in the half plane and in space.
const BOXES: usize = 96;
const BOXES_OF_SPACE: usize = 400;

/// Proves sets of signs impossible.
pub(crate) struct Void<'m> {
    linear: Linear,
    domain: Domain,
    prover: Prover<'m>,
}

impl<'m> Void<'m> {
    pub(crate) fn new(model: &'m Model) -> Void<'m> {
        Void { linear: Linear::new(model), domain: model.domain, prover: Prover::new(model) }
    }

    /// Whether provably no point has these signs.
    pub(super) fn proved(&mut self, signs: &[Signs]) -> bool {
        self.linear.judged(signs).unwrap_or_else(|| self.uncovered(signs))
    }

    /// Whether no box of a cover of the domain can have the signs.
    fn uncovered(&mut self, signs: &[Signs]) -> bool {
        let mut open = vec![self.domain.whole(2f64.powi(300))];
        let mut left = match self.domain {
            Domain::HalfPlane => BOXES,
            Domain::Space => BOXES_OF_SPACE,
        };
        while let Some(cell) = open.pop() {
            self.prover.set(cell);
            let mut asked = signs.iter().enumerate().filter(|(_, wanted)| **wanted != ANY);
            if asked.any(|(curve, wanted)| self.prover.sign(curve) & wanted == 0) {
                continue;
            }
            if left == 0 {
                return false;
            }
            left -= 1;
            open.extend(halves(cell));
        }
        true
    }
}

/// The curves that are linear in the coordinates or in monomials of them.
pub(crate) struct Linear {
    /// Each curve as a linear form, if it is one.
    forms: Vec<Option<(Vec<f64>, f64)>>,
    variables: usize,
    /// The variable that is the coordinate along each axis that the domain has.
    axes: [Option<usize>; 3],
    /// What holds everywhere.
    facts: Vec<Condition>,
}

/// The distance from the axis.
const RADIUS: Monomial = [1, 0, 0, 0];

impl Linear {
    pub(crate) fn new(model: &Model) -> Linear {
        let mut variables = Variables { graph: &model.graph, known: BTreeMap::new() };
        let mut axes = [None; 3];
        for (coord, axis, _) in model.domain.coordinates() {
            axes[*axis] = Some(variables.of(Variable::Monomial(monomial_of(*coord))));
        }
        let forms: Vec<Option<Form>> =
            model.curves.iter().map(|curve| variables.form(curve.value)).collect();
        let facts = variables.facts();
        let count = variables.known.len();
        let dense = |form: Form| {
            let all = (0..count).map(|v| form.factors.get(&v).copied().unwrap_or(0.0));
            (all.collect(), form.constant)
        };
        let strict = false;
        let facts = facts.into_iter().map(dense);
        Linear {
            forms: forms.into_iter().map(|form| form.map(dense)).collect(),
            variables: count,
            axes,
            facts: facts
                .map(|(factors, constant)| Condition { factors, constant, strict })
                .collect(),
        }
    }

    /// A box of which, by the linear curves alone, all points with these signs are.
    pub(crate) fn reach(&self, signs: &[Signs]) -> Cell {
        Cell {
            sides: self
                .axes
                .map(|axis| axis.map_or(interval::ZERO, |axis| self.range(signs, axis))),
        }
    }

    fn range(&self, signs: &[Signs], wanted: usize) -> Interval {
        let conditions: Vec<Condition> = self.conditions(signs).into_iter().map(scaled).collect();
        let size = conditions.iter().fold(0f64, |m, c| m.max(c.constant.abs()));
        let others = (0..self.variables).filter(|variable| *variable != wanted).collect();
        let Some(conditions) = without(conditions, others) else { return EVERYTHING };
        let mut range = EVERYTHING;
        for condition in conditions.into_iter().map(scaled) {
            let (factor, constant) = (condition.factors[wanted], condition.constant);
            // With what elimination rounds.
            let end = -constant / factor;
            let slack = ROUNDING * (size + end.abs());
            if factor > ROUNDING {
                range.high = range.high.min(end + slack);
            } else if factor < -ROUNDING {
                range.low = range.low.max(end - slack);
            }
        }
        range
    }

    fn conditions(&self, signs: &[Signs]) -> Vec<Condition> {
        let mut conditions = self.facts.clone();
        for (form, sign) in self.forms.iter().zip(signs) {
            let Some((factors, constant)) = form else { continue };
            // What would be lost as rounding must not take part: fewer conditions prove less.
            let largest = factors.iter().fold(0f64, |m, f| m.max(f.abs()));
            if factors.iter().any(|f| *f != 0.0 && f.abs() < 1e3 * ROUNDING * largest) {
                continue;
            }
            let mut add = |factor: f64, strict: bool| {
                conditions.push(Condition {
                    factors: factors.iter().map(|f| f * factor).collect(),
                    constant: constant * factor,
                    strict,
                });
            };
            match *sign {
                NEGATIVE => add(1.0, true),
                POSITIVE => add(-1.0, true),
                ZERO => {
                    add(1.0, false);
                    add(-1.0, false);
                }
                s if s == NEGATIVE | ZERO => add(1.0, false),
                s if s == POSITIVE | ZERO => add(-1.0, false),
                _ => {}
            }
        }
        conditions
    }

    pub(crate) fn contradictory(&self, signs: &[Signs]) -> bool {
        self.judged(signs) == Some(true)
    }

    /// Whether the linear curves alone contradict one another, if that settles it.
    fn judged(&self, signs: &[Signs]) -> Option<bool> {
        let conditions = without(self.conditions(signs), (0..self.variables).collect())?;
        let absurd = |c: &Condition| c.constant > if c.strict { -ROUNDING } else { ROUNDING };
        if conditions.iter().any(absurd) {
            return Some(true);
        }
        // Of straight lines elimination overlooks nothing.
        let straight = |form: &Option<(Vec<f64>, f64)>| {
            form.as_ref().is_some_and(|(factors, _)| {
                let bent = |v: usize| factors[v] != 0.0 && !self.axes.contains(&Some(v));
                !(0..self.variables).any(bent)
            })
        };
        let mut asked = self.forms.iter().zip(signs).filter(|(_, sign)| **sign != ANY);
        asked.all(|(form, _)| straight(form)).then_some(false)
    }
}

/// What elimination takes for a variable of its own.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Variable {
    /// A product of powers of coordinates.
    Monomial(Monomial),
    /// A root.
    Root(Id),
}

/// `Σ factor · variable + constant`
#[derive(Clone, Default)]
struct Form {
    factors: BTreeMap<usize, f64>,
    constant: f64,
}

impl Form {
    fn variable(variable: usize) -> Form {
        Form { factors: BTreeMap::from([(variable, 1.0)]), constant: 0.0 }
    }

    fn plus(mut self, other: &Form, factor: f64) -> Form {
        for (variable, more) in &other.factors {
            *self.factors.entry(*variable).or_default() += factor * more;
        }
        self.constant += factor * other.constant;
        self
    }
}

/// The variables met so far.
struct Variables<'m> {
    graph: &'m Graph,
    known: BTreeMap<Variable, usize>,
}

impl Variables<'_> {
    fn of(&mut self, variable: Variable) -> usize {
        let next = self.known.len();
        *self.known.entry(variable).or_insert(next)
    }

    /// An expression as a linear form, if it is one.
    fn form(&mut self, root: Id) -> Option<Form> {
        let mut polynomials = Polynomials::default();
        polynomials.of(self.graph, root);
        let polynomial = |id: &Id| polynomials.known(*id);
        // What the form is summed up from; each once, however often it is shared.
        let (mut open, mut parts) = (vec![root], BTreeSet::new());
        while let Some(id) = open.pop() {
            if parts.insert(id) && polynomial(&id).is_none() {
                match *self.graph.node(id) {
                    Node::Neg(a) => open.push(a),
                    Node::Add(a, b) | Node::Sub(a, b) => open.extend([a, b]),
                    Node::Mul(factor, b) if self.graph.constant(factor).is_some() => open.push(b),
                    Node::Sqrt(_) => {}
                    _ => return None,
                }
            }
        }
        let mut forms: BTreeMap<Id, Form> = BTreeMap::new();
        for id in parts {
            let form = match (polynomial(&id), self.graph.node(id)) {
                (Some(polynomial), _) => self.of_polynomial(polynomial),
                (None, Node::Neg(a)) => Form::default().plus(&forms[a], -1.0),
                (None, Node::Add(a, b)) => forms[a].clone().plus(&forms[b], 1.0),
                (None, Node::Sub(a, b)) => forms[a].clone().plus(&forms[b], -1.0),
                (None, Node::Mul(factor, b)) => {
                    let factor = self.graph.constant(*factor).map_or(0.0, Number::to_f64);
                    Form::default().plus(&forms[b], factor)
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
                form.constant = factor.to_f64();
            } else {
                form.factors.insert(self.of(Variable::Monomial(monomial)), factor.to_f64());
            }
        }
        form
    }

    /// What is nowhere above 0: minus a square, a distance or a root; and whatever is squared
    /// under a root, less the root.
    fn facts(&mut self) -> Vec<Form> {
        let mut facts = Vec::new();
        for (variable, at) in self.known.clone() {
            let minus = Form::default().plus(&Form::variable(at), -1.0);
            let mut parts = Vec::new();
            match variable {
                Variable::Monomial(monomial) => {
                    if monomial == RADIUS {
                        let across = [Coord::X, Coord::Y].map(monomial_of).map(Variable::Monomial);
                        let known = across.iter().filter_map(|v| self.known.get(v).copied());
                        parts.extend(known.map(Form::variable));
                    } else if monomial[1..].iter().any(|exponent| exponent % 2 == 1) {
                        continue;
                    }
                }
                Variable::Root(root) => {
                    let squares = squares(self.graph, root);
                    // Of more variables than there are nothing is known.
                    let count = self.known.len();
                    parts.extend(squares.into_iter().filter_map(|part| self.form(part)));
                    parts.retain(|form| form.factors.keys().all(|v| *v < count));
                    self.known.retain(|_, at| *at < count);
                }
            }
            for part in parts {
                facts.extend([1.0, -1.0].map(|sign| minus.clone().plus(&part, sign)));
            }
            facts.push(minus);
        }
        facts
    }
}

/// What is squared in a root of a sum of squares.
fn squares(graph: &Graph, root: Id) -> Vec<Id> {
    let Node::Sqrt(sum) = *graph.node(root) else { return Vec::new() };
    let (mut open, mut parts) = (vec![sum], Vec::new());
    while let Some(id) = open.pop() {
        match *graph.node(id) {
            Node::Add(a, b) => open.extend([a, b]),
            Node::Mul(a, b) if a == b => parts.push(a),
            Node::Coord(Coord::Q) => {}
            Node::Const(ref value) if !value.is_negative() => {}
            _ => return Vec::new(),
        }
    }
    parts
}
