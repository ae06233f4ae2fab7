//! Proofs that no point has given signs.
//!
//! Two ways are tried. Curves that are linear in the coordinates (or in monomials of them, each
//! taken for a variable of its own) are refuted by Fourier and Motzkin's elimination, which sees
//! where borders meet in a corner, to a part in 10^12. Other curves are enclosed over boxes that cover the
//! half plane.

use crate::bound::{Prover, halves};
use crate::expr::interval::{Cell, Interval};
use crate::expr::polynomial::Polynomial;
use crate::formula::{ANY, NEGATIVE, POSITIVE, Signs, ZERO};
use crate::model::Model;
use std::collections::BTreeMap;

/// A residue below this, relative to the curve's largest coefficient, is rounding.
const ROUNDING: f64 = 1e-12;
/// The most conditions that elimination may grow to.
const CONDITIONS: usize = 600;
/// The most boxes of one proof.
const BOXES: usize = 96;

/// `Σ factor · variable + constant ≤ 0`, or `< 0`.
#[derive(Clone, Debug)]
struct Condition {
    factors: Vec<f64>,
    constant: f64,
    strict: bool,
}

/// A half plane that is far from the origin.
#[derive(Clone, Copy)]
pub(crate) enum Beyond {
    /// Farther from the axis than this.
    Radius(f64),
    /// Higher than this.
    Above(f64),
    /// Lower than minus this.
    Below(f64),
}

/// Proves sets of signs impossible.
pub(crate) struct Void<'m> {
    /// Each curve as a linear form, if it is one.
    forms: Vec<Option<(Vec<f64>, f64)>>,
    variables: usize,
    not_negative: Vec<usize>,
    prover: Prover<'m>,
}

impl<'m> Void<'m> {
    pub(crate) fn new(model: &'m Model) -> Void<'m> {
        let mut variables = BTreeMap::from([([1, 0, 0, 0], 0), ([0, 0, 0, 1], 1)]);
        let mut forms = Vec::new();
        for curve in &model.curves {
            let form = Polynomial::of(&model.graph, curve.value).map(|polynomial| {
                let (mut factors, mut constant) = (BTreeMap::new(), 0.0);
                for (monomial, factor) in polynomial.terms() {
                    if monomial == [0; 4] {
                        constant = factor.to_f64();
                    } else {
                        let next = variables.len();
                        let variable = *variables.entry(monomial).or_insert(next);
                        factors.insert(variable, factor.to_f64());
                    }
                }
                (factors, constant)
            });
            forms.push(form);
        }
        let dense = |(factors, constant): (BTreeMap<usize, f64>, f64)| {
            let all = (0..variables.len()).map(|v| factors.get(&v).copied().unwrap_or(0.0));
            (all.collect(), constant)
        };
        Void {
            forms: forms.into_iter().map(|form| form.map(dense)).collect(),
            variables: variables.len(),
            not_negative: variables
                .iter()
                .filter(|(monomial, _)| monomial[1..].iter().all(|exponent| exponent % 2 == 0))
                .map(|(_, variable)| *variable)
                .collect(),
            prover: Prover::new(model),
        }
    }

    /// Whether provably no point has these signs.
    pub(super) fn proved(&mut self, signs: &[Signs]) -> bool {
        self.contradictory(signs, None) || self.uncovered(signs)
    }

    /// Whether, by the linear curves alone, no point has these signs and lies so far out.
    pub(crate) fn never_beyond(&self, signs: &[Signs], beyond: Beyond) -> bool {
        let (variable, factor, size) = match beyond {
            Beyond::Radius(size) => (0, -1.0, size),
            Beyond::Above(size) => (1, -1.0, size),
            Beyond::Below(size) => (1, 1.0, size),
        };
        let mut factors = vec![0.0; self.variables];
        factors[variable] = factor;
        self.contradictory(signs, Some(Condition { factors, constant: size, strict: false }))
    }

    fn contradictory(&self, signs: &[Signs], more: Option<Condition>) -> bool {
        // What is a square, or a distance from the axis, is not negative.
        let mut conditions: Vec<Condition> = self
            .not_negative
            .iter()
            .map(|variable| {
                let mut factors = vec![0.0; self.variables];
                factors[*variable] = -1.0;
                Condition { factors, constant: 0.0, strict: false }
            })
            .collect();
        conditions.extend(more);
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
        for variable in 0..self.variables {
            let Some(next) = eliminate(conditions, variable) else { return false };
            conditions = next;
        }
        conditions.iter().any(|c| c.constant > if c.strict { -ROUNDING } else { ROUNDING })
    }

    /// Whether no box of a cover of the half plane can have the signs.
    fn uncovered(&mut self, signs: &[Signs]) -> bool {
        let far = 2f64.powi(300);
        let whole = Cell { d: Interval::new(0.0, far), z: Interval::new(-far, far) };
        let mut open = vec![whole];
        let mut left = BOXES;
        while let Some(cell) = open.pop() {
            let here = self.prover.signs(cell);
            if here.iter().zip(signs).any(|(here, wanted)| *wanted != ANY && here & wanted == 0) {
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
            Some(other) if condition.constant > other.constant => *other = condition,
            Some(other) => other.strict |= condition.strict && condition.constant == other.constant,
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
