//! Converts conditions to formulas over splitting curves.

use crate::expr::corner::Corner;
use crate::expr::polynomial::{Polynomial, Polynomials};
use crate::expr::{Graph, Id};
use crate::formula::{Curve, CurveIndex, Formula};
use std::collections::BTreeMap;

/// The relative difference beyond which two curves' numbers are not those of multiples of one another: above the rounding of the
/// sums that they come from.
const NEAR_PROPORTION: f64 = 1e-8;

/// The maximum number of times that one condition may be split at `min`, `max` and `abs`.
const MAX_SPLITS: usize = 64;

/// The curves found so far.
#[derive(Default)]
pub(super) struct Curves {
    pub(super) list: Vec<Curve>,
    /// The proportion of each curve's polynomial.
    proportions: Vec<Option<f64>>,
    polynomials: Polynomials,
    found: BTreeMap<Id, (CurveIndex, bool)>,
    names: BTreeMap<Id, String>,
}

impl Curves {
    /// Returns the curves of a model, so that others can be added.
    pub(super) fn of(list: Vec<Curve>, graph: &Graph) -> Curves {
        let mut curves = Curves::default();
        for curve in list {
            curves.add(graph, curve);
        }
        curves
    }

    fn add(&mut self, graph: &Graph, curve: Curve) {
        let polynomial = self.polynomials.of(graph, curve.value);
        self.proportions.push(polynomial.and_then(Polynomial::proportion));
        self.list.push(curve);
    }

    /// Records the file's name for a curve.
    pub(super) fn name(&mut self, name: &str, value: Id) {
        self.names.entry(value).or_insert_with(|| name.to_owned());
    }

    /// Returns the known curve on which an expression is zero, and whether the expression has the curve's sign.
    pub(super) fn find(&mut self, graph: &mut Graph, value: Id) -> Option<(CurveIndex, bool)> {
        if let Some(found) = self.found.get(&value) {
            return Some(*found);
        }
        self.polynomials.of(graph, value);
        let own = self.polynomials.known(value);
        let proportion = own.and_then(Polynomial::proportion);
        let opposite = graph.neg(value);
        let found = self.list.iter().enumerate().find_map(|(index, curve)| {
            if curve.value == value {
                return Some((index, true));
            }
            if curve.value == opposite {
                return Some((index, false));
            }
            // Most curves are told apart by one number.
            let (a, b) = (proportion?, self.proportions[index]?);
            if (a - b).abs() > NEAR_PROPORTION * (a.abs() + b.abs()) {
                return None;
            }
            let factor = own?.ratio(self.polynomials.known(curve.value)?)?;
            Some((index, !factor.is_negative()))
        })?;
        self.found.insert(value, found);
        Some(found)
    }

    /// Returns the formula of `value ≤ 0` or, if not `below`, of `value ≥ 0`.
    fn atom(&mut self, graph: &mut Graph, value: Id, below: bool) -> Formula {
        if let Some(polynomial) = self.polynomials.of(graph, value) {
            if let Some(constant) = polynomial.constant() {
                return Formula::Const(constant.is_zero() || constant.is_negative() == below);
            }
            // The distance from the axis is never negative.
            let factor = polynomial.multiple_of_d();
            if factor.is_some_and(|factor| factor.is_negative() == below) {
                return Formula::Const(true);
            }
        }
        let (curve, same) = self.find(graph, value).unwrap_or_else(|| {
            let opposite = graph.neg(value);
            let name = self.names.get(&value).or_else(|| self.names.get(&opposite)).cloned();
            self.add(graph, Curve { name, value });
            (self.list.len() - 1, true)
        });
        Formula::Atom { curve, below: below == same }
    }

    /// Returns the formula of `low ≤ high`.
    pub(super) fn at_most(&mut self, graph: &mut Graph, low: Id, high: Id) -> Formula {
        let value = graph.sub(low, high);
        self.side(graph, value, true, &mut MAX_SPLITS.clone())
    }

    fn side(&mut self, graph: &mut Graph, value: Id, below: bool, parts: &mut usize) -> Formula {
        let corner = if *parts > 0 { graph.corner(value) } else { None };
        let Some(Corner { is_larger, parts: [a, b] }) = corner else {
            return self.atom(graph, value, below);
        };
        *parts -= 1;
        let sides = vec![self.side(graph, a, below, parts), self.side(graph, b, below, parts)];
        // max(a, b) ≤ 0 requires both sides, max(a, b) ≥ 0 one of them.
        if is_larger == below { Formula::All(sides) } else { Formula::Any(sides) }
    }
}
