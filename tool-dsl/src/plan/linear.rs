//! Curves that are linear in the coordinates, or in monomials and roots of them, each taken for a
//! variable of its own: what signs they can have together, by Fourier and Motzkin's elimination, which
//! sees where borders meet in a corner, to a part in 10^12.

use crate::domain::Domain;
use crate::expr::interval::{self, Cell, EVERYTHING, Interval};
use crate::expr::polynomial::{Monomial, Polynomial, Polynomials, monomial_of};
use crate::expr::{Coord, Graph, Id, Node};
use crate::formula::{NEGATIVE, POSITIVE, Signs, ZERO};
use crate::model::Model;
use crate::number::Number;
use std::collections::{BTreeMap, BTreeSet};

/// A residue below this, relative to the curve's largest coefficient, is rounding.
const ROUNDING: f64 = 1e-12;
/// The most conditions that elimination may grow to.
const CONDITIONS: usize = 600;
/// `Σ factor · variable + constant ≤ 0`, or `< 0`.
#[derive(Clone, Debug)]
struct Condition {
    factors: Vec<f64>,
    constant: f64,
    strict: bool,
}

/// The curves that are linear in the coordinates or in monomials of them.
pub(crate) struct Linear {
    /// Each curve as a linear form, if it is one, and behind them regions' depths.
    forms: Vec<Option<(Vec<f64>, f64)>>,
    variables: usize,
    /// The variable that is the coordinate along each axis that the domain has.
    axes: [Option<usize>; 3],
    /// What holds everywhere.
    facts: Vec<Condition>,
    /// Conditions of which one holds everywhere, for each of several roots.
    choices: Vec<(usize, Vec<Condition>)>,
}

/// The most combinations of choices.
const CHOICES: usize = 8;

/// The distance from the axis.
const RADIUS: Monomial = [1, 0, 0, 0];

impl Linear {
    /// What is known at once.
    pub(crate) fn new(model: &Model) -> Linear {
        Linear { choices: Vec::new(), ..Linear::of(model, []) }
    }

    /// With the regions' depths, and in space with what takes a choice. In the half plane regions meet
    /// in points, which need none.
    pub(crate) fn with_depths(model: &Model) -> Linear {
        let known = Linear::of(model, model.regions.iter().map(|region| region.depth));
        match model.domain {
            Domain::HalfPlane => Linear { choices: Vec::new(), ..known },
            Domain::Space => known,
        }
    }

    fn of(model: &Model, depths: impl IntoIterator<Item = Id>) -> Linear {
        let mut variables = Variables { graph: &model.graph, known: BTreeMap::new() };
        let mut axes = [None; 3];
        for (coord, axis, _) in model.domain.coordinates() {
            axes[*axis] = Some(variables.of(Variable::Monomial(monomial_of(*coord))));
        }
        let curves = model.curves.iter().map(|curve| curve.value);
        let forms: Vec<Option<Form>> =
            curves.chain(depths).map(|value| variables.form(value)).collect();
        let (facts, choices) = variables.facts();
        let count = variables.known.len();
        let dense = |form: Form| {
            let all = (0..count).map(|v| form.factors.get(&v).copied().unwrap_or(0.0));
            (all.collect(), form.constant)
        };
        let condition = |form: Form| {
            let (factors, constant) = dense(form);
            Condition { factors, constant, strict: false }
        };
        Linear {
            forms: forms.into_iter().map(|form| form.map(dense)).collect(),
            variables: count,
            axes,
            facts: facts.into_iter().map(condition).collect(),
            choices: choices
                .into_iter()
                .map(|(root, choices)| (root, choices.into_iter().map(condition).collect()))
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
        self.absurd(self.conditions(signs))
    }

    /// Whether one region is nowhere deeper than another, or than the outside, where curves have
    /// these signs.
    pub(crate) fn no_deeper(&self, signs: &[Signs], a: Option<usize>, b: Option<usize>) -> bool {
        let nothing = (vec![0.0; self.variables], 0.0);
        let form = |region: Option<usize>| match region {
            Some(region) => self.forms[signs.len() + region].as_ref(),
            None => Some(&nothing),
        };
        let (Some(a), Some(b)) = (form(a), form(b)) else { return false };
        let mut conditions = self.conditions(signs);
        conditions.push(Condition {
            factors: b.0.iter().zip(&a.0).map(|(b, a)| b - a).collect(),
            constant: b.1 - a.1,
            strict: true,
        });
        self.absurd(conditions)
    }

    /// Whether no point keeps the conditions, whatever is chosen for roots in them.
    fn absurd(&self, conditions: Vec<Condition>) -> bool {
        let mentioned = |(root, _): &&(usize, Vec<Condition>)| {
            conditions[self.facts.len()..].iter().any(|condition| condition.factors[*root] != 0.0)
        };
        let mut count = 1;
        let asked: Vec<&Vec<Condition>> = (self.choices.iter().filter(mentioned))
            .map(|(_, choices)| choices)
            .take_while(|choices| {
                count *= choices.len();
                count <= CHOICES
            })
            .collect();
        self.none_keeps(conditions.clone()) || !asked.is_empty() && self.none_of(conditions, &asked)
    }

    /// Whether every choice is absurd.
    fn none_of(&self, conditions: Vec<Condition>, choices: &[&Vec<Condition>]) -> bool {
        let Some((first, rest)) = choices.split_first() else { return self.none_keeps(conditions) };
        first.iter().all(|choice| {
            let mut conditions = conditions.clone();
            conditions.push(choice.clone());
            self.none_of(conditions, rest)
        })
    }

    fn none_keeps(&self, conditions: Vec<Condition>) -> bool {
        let conditions = without(conditions, (0..self.variables).collect());
        let absurd = |c: &Condition| c.constant > if c.strict { -ROUNDING } else { ROUNDING };
        conditions.is_some_and(|conditions| conditions.iter().any(absurd))
    }
}

/// What elimination takes for a variable of its own.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Variable {
    /// A product of powers of coordinates.
    Monomial(Monomial),
    /// A root or an absolute value.
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
                    Node::Sqrt(_) | Node::Abs(_) => {}
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
    /// under a root, less the root. Beside them, of each root those of which one is nowhere above 0:
    /// the root, less what is squared under it, each with the one sign or the other.
    fn facts(&mut self) -> (Vec<Form>, Vec<(usize, Vec<Form>)>) {
        let (mut facts, mut choices) = (Vec::new(), Vec::new());
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
                    let (squares, all) = squares(self.graph, root);
                    let count = squares.len();
                    // Of more variables than there are nothing is known.
                    let variables = self.known.len();
                    parts.extend(squares.into_iter().filter_map(|part| self.form(part)));
                    parts.retain(|form| form.factors.keys().all(|v| *v < variables));
                    self.known.retain(|_, at| *at < variables);
                    if all && parts.len() == count {
                        let side = |signs: usize| {
                            parts.iter().enumerate().fold(Form::variable(at), |sum, (k, part)| {
                                sum.plus(part, if signs >> k & 1 == 0 { 1.0 } else { -1.0 })
                            })
                        };
                        choices.push((at, (0..1 << count).map(side).collect()));
                    }
                }
            }
            for part in parts {
                facts.extend([1.0, -1.0].map(|sign| minus.clone().plus(&part, sign)));
            }
            facts.push(minus);
        }
        (facts, choices)
    }
}

/// What is squared in a root of a sum of squares, of which an absolute value is one, and whether that
/// is all of the sum.
fn squares(graph: &Graph, root: Id) -> (Vec<Id>, bool) {
    let sum = match *graph.node(root) {
        Node::Sqrt(sum) => sum,
        Node::Abs(part) => return (vec![part], true),
        _ => return (Vec::new(), false),
    };
    let (mut open, mut parts, mut all) = (vec![sum], Vec::new(), true);
    while let Some(id) = open.pop() {
        match *graph.node(id) {
            Node::Add(a, b) => open.extend([a, b]),
            Node::Mul(a, b) if a == b => parts.push(a),
            Node::Coord(Coord::Q) => all = false,
            Node::Const(ref value) if !value.is_negative() => all = false,
            _ => return (Vec::new(), false),
        }
    }
    (parts, all)
}

/// The conditions that remain when some variables may be anything, those first that leave fewest;
/// `None` if there are too many.
fn without(mut conditions: Vec<Condition>, mut variables: Vec<usize>) -> Option<Vec<Condition>> {
    while !variables.is_empty() {
        let growth = |variable: usize| {
            let with = |sign: f64| {
                let bound = |c: &&Condition| sign * c.factors[variable] > ROUNDING;
                conditions.iter().filter(bound).count()
            };
            let (upper, lower) = (with(1.0), with(-1.0));
            (upper * lower).saturating_sub(upper + lower)
        };
        let place = (0..variables.len()).min_by_key(|place| growth(variables[*place]))?;
        conditions = eliminate(conditions, variables.swap_remove(place))?;
    }
    Some(conditions)
}

/// The conditions that remain when a variable may be anything; `None` if there are too many.
fn eliminate(conditions: Vec<Condition>, variable: usize) -> Option<Vec<Condition>> {
    let (mut upper, mut lower, mut rest) = (Vec::new(), Vec::new(), Vec::new());
    for condition in tightest(conditions) {
        match condition.factors[variable] {
            f if f > ROUNDING => upper.push(condition),
            f if f < -ROUNDING => lower.push(condition),
            _ => rest.push(condition),
        }
    }
    if rest.len() + upper.len() * lower.len() > CONDITIONS {
        return None;
    }
    for a in &upper {
        for b in &lower {
            let (x, y) = (-b.factors[variable], a.factors[variable]);
            let mut factors: Vec<f64> =
                a.factors.iter().zip(&b.factors).map(|(f, g)| f * x + g * y).collect();
            factors[variable] = 0.0;
            let constant = a.constant * x + b.constant * y;
            rest.push(Condition { factors, constant, strict: a.strict || b.strict });
        }
    }
    Some(rest)
}

/// Of conditions with the same factors, the one that says most.
fn tightest(conditions: Vec<Condition>) -> Vec<Condition> {
    let mut kept: Vec<Condition> = Vec::new();
    for condition in conditions {
        let condition = scaled(condition);
        let same = |other: &&mut Condition| {
            other.factors.iter().zip(&condition.factors).all(|(a, b)| (a - b).abs() <= ROUNDING)
        };
        match kept.iter_mut().find(same) {
            Some(other) => {
                let above = condition.constant - other.constant;
                // What differs by rounding is the same, and one of both is strict if the other is.
                let same = above.abs() <= ROUNDING * condition.constant.abs().max(1.0);
                let strict = same && (condition.strict || other.strict);
                if above > 0.0 {
                    *other = condition;
                }
                other.strict |= strict;
            }
            None => kept.push(condition),
        }
    }
    kept
}

/// A condition with its largest factor 1 and rounding's residues removed.
fn scaled(mut condition: Condition) -> Condition {
    let largest = condition.factors.iter().fold(0f64, |m, f| m.max(f.abs()));
    if largest > ROUNDING {
        let scale = 1.0 / largest;
        condition.constant *= scale;
        for factor in &mut condition.factors {
            *factor *= scale;
            if factor.abs() < ROUNDING {
                *factor = 0.0;
            }
        }
    }
    condition
}
