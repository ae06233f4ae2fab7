//! The signs that linear curves can have together, by Fourier–Motzkin elimination. Curves are linear in the
//! coordinates, or in monomials and roots of them, each taken as a separate variable. Elimination recognises
//! borders that meet in a corner. Its results are confirmed with the 256 bits of constants.

mod forms;
mod fourier_motzkin;

use crate::expr::Id;
use crate::expr::interval::{self, Cell, ENTIRE, Interval};
use crate::expr::polynomial::monomial_of;
use crate::formula::{ANY_SIGN, NEGATIVE, POSITIVE, Signs, ZERO};
use crate::model::Model;
use crate::number::Number;
use forms::{Form, Variable, Variables, compares_roots};
use fourier_motzkin::{Condition, Exact, ROUNDING, rescaled, scaled, without};
use std::rc::Rc;

/// The largest number of combinations of choices.
const MAX_CHOICES: usize = 8;

/// The curves that are linear in the coordinates or in monomials of them.
pub(crate) struct Linear {
    /// The linear form of each curve, followed by those of depths; `None` where there is none.
    forms: Vec<Option<LinearForm>>,
    variables: usize,
    /// The variable of the coordinate along each axis of the domain.
    axes: [Option<usize>; 3],
    /// Conditions that hold everywhere.
    facts: Vec<Condition>,
    /// For several roots, alternatives of which at least one holds at every point.
    choices: Vec<(usize, Vec<Condition>)>,
}

/// The linear form of a curve or a depth.
struct LinearForm {
    exact: Rc<Exact>,
    /// The conditions that it is not positive, and that it is not negative.
    sides: [Condition; 2],
    /// True if a factor is so small next to another that doubles would lose it as rounding. The form is then
    /// not used, which proves less but nothing false.
    is_lost: bool,
}

impl LinearForm {
    fn new([exact, opposite]: [Rc<Exact>; 2]) -> LinearForm {
        let sides = [&exact, &opposite].map(|form| Condition::from_exact(form, false));
        let sizes = || sides[0].factors.iter().map(|factor| factor.abs());
        let largest = sizes().fold(0.0, f64::max);
        let is_lost = sizes().any(|size| size != 0.0 && size < 1e3 * ROUNDING * largest);
        LinearForm { exact, sides, is_lost }
    }
}

impl Linear {
    /// Collects the linear curves, without depths and choices.
    pub(crate) fn new(model: &Model) -> Linear {
        Linear { choices: Vec::new(), ..Linear::of(model, [], None) }
    }

    /// Collects the linear curves, the depths of [`Model::depths`], and the choices for roots.
    ///
    /// If some curve compares squares of expressions with roots, every comparison of squares becomes a
    /// comparison of the squared expressions, where their signs are known in a box that contains the tool.
    pub(crate) fn with_depths(model: &Model, cell: Cell) -> Linear {
        let compares_roots = model.curve_values().any(|value| compares_roots(&model.graph, value));
        let roots = compares_roots.then_some(cell);
        Linear::of(model, model.depths(), roots)
    }

    fn of(model: &Model, depths: impl IntoIterator<Item = Id>, roots: Option<Cell>) -> Linear {
        let mut variables = Variables::new(model);
        let mut axes = [None; 3];
        for (coord, axis, _) in model.domain.coordinates() {
            axes[*axis] = Some(variables.of(Variable::Monomial(monomial_of(*coord))));
        }
        let mut forms: Vec<Option<Form>> =
            model.curve_values().chain(depths).map(|value| variables.form(value)).collect();
        if let Some(cell) = roots {
            for (form, curve) in forms.iter_mut().zip(&model.curves) {
                if let Some(compared) = variables.comparison_without_squares(curve.value, cell) {
                    *form = Some(compared);
                }
            }
        }
        let (mut facts, choices) = variables.facts();
        if roots.is_some() {
            // With roots as variables, elimination needs to know how they bound one another.
            facts.extend(variables.projections(forms[model.curves.len()..].iter().flatten()));
        }
        let count = variables.count();
        let condition = |form: Form| Condition::from_exact(&dense(form, count), false);
        Linear {
            forms: forms
                .into_iter()
                .map(|form| {
                    let opposite = Form::default().plus(form.as_ref()?, &Number::int(-1));
                    Some(LinearForm::new([form?, opposite].map(|form| dense(form, count))))
                })
                .collect(),
            variables: count,
            axes,
            facts: facts.into_iter().map(condition).collect(),
            choices: choices
                .into_iter()
                .map(|(root, choices)| (root, choices.into_iter().map(condition).collect()))
                .collect(),
        }
    }

    /// Returns a box that contains all points with these signs, according to the linear curves alone.
    pub(crate) fn bounding_box(&self, signs: &[Signs]) -> Cell {
        Cell {
            sides: self
                .axes
                .map(|axis| axis.map_or(interval::ZERO, |axis| self.range(signs, axis))),
        }
    }

    fn range(&self, signs: &[Signs], wanted: usize) -> Interval {
        let (conditions, unit) = rescaled(self.conditions(signs));
        let largest =
            unit * conditions.iter().fold(0f64, |largest, c| largest.max(c.constant.abs()));
        let others = (0..self.variables).filter(|variable| *variable != wanted).collect();
        let Some(conditions) = without(conditions, others) else { return ENTIRE };
        let mut range = ENTIRE;
        for condition in conditions.into_iter().map(scaled) {
            let approximate_factor = condition.factors[wanted];
            let end = -unit * condition.constant / approximate_factor;
            let tighter = match approximate_factor {
                _ if approximate_factor > ROUNDING => end < range.high,
                _ if approximate_factor < -ROUNDING => end > range.low,
                _ => false,
            };
            // A repetition with 256 bits is slow, so only bounds that matter are confirmed.
            if !tighter {
                continue;
            }
            let Some((factor, constant, rounding_error)) = condition.evaluate_exactly(Some(wanted))
            else {
                continue;
            };
            let Some(end) = (-&constant).checked_div(&factor) else { continue };
            let end = Interval::enclosing(&end);
            // The slack keeps doubles that are computed from the range outside it.
            let size = largest + end.low.abs().max(end.high.abs());
            let slack = rounding_error / factor.to_f64().abs() + ROUNDING * size;
            if approximate_factor > 0.0 && !factor.is_negative() {
                range.high = range.high.min((end.high + slack).next_up());
            } else if approximate_factor < 0.0 && factor.is_negative() {
                range.low = range.low.max((end.low - slack).next_down());
            }
        }
        range
    }

    fn conditions(&self, signs: &[Signs]) -> Vec<Condition> {
        let mut conditions = self.facts.clone();
        for (form, sign) in self.forms.iter().zip(signs) {
            let Some(LinearForm { sides: [form, opposite], is_lost: false, .. }) = form else {
                continue;
            };
            match *sign {
                NEGATIVE => conditions.push(form.strictly()),
                POSITIVE => conditions.push(opposite.strictly()),
                ZERO => conditions.extend([form.clone(), opposite.clone()]),
                s if s == NEGATIVE | ZERO => conditions.push(form.clone()),
                s if s == POSITIVE | ZERO => conditions.push(opposite.clone()),
                _ => {}
            }
        }
        conditions
    }

    pub(crate) fn contradictory(&self, signs: &[Signs]) -> bool {
        self.has_no_solution(self.conditions(signs))
    }

    /// Returns whether these signs contradict one another, if the linear part of the curves decides it. For
    /// straight lines elimination is complete.
    pub(super) fn is_contradictory(&self, signs: &[Signs]) -> Option<bool> {
        let rest = self.without_variables(self.conditions(signs))?;
        if rest.iter().any(Condition::is_false) {
            return Some(true);
        }
        let mut constrained = self.forms.iter().zip(signs).filter(|(_, sign)| **sign != ANY_SIGN);
        let are_straight =
            constrained.all(|(form, _)| form.as_ref().is_some_and(|form| self.is_straight(form)));
        are_straight.then_some(false)
    }

    /// Returns whether a form is linear in the coordinates themselves.
    fn is_straight(&self, form: &LinearForm) -> bool {
        let factors = &form.sides[0].factors;
        !(0..self.variables).any(|v| factors[v] != 0.0 && !self.axes.contains(&Some(v)))
    }

    /// The same as [`Linear::contradictory`] in a region, where its depth is not negative.
    pub(crate) fn contradictory_in(&self, region: Option<usize>, signs: &[Signs]) -> bool {
        let mut conditions = self.conditions(signs);
        // A point of a region has a depth of 0 or more, which the path does not say.
        let depth = region.and_then(|region| self.forms[signs.len() + region].as_ref());
        conditions.extend(depth.map(|depth| depth.sides[1].clone()));
        self.has_no_solution(conditions)
    }

    /// Returns whether one region is nowhere deeper than another, or than the outside, where curves have
    /// these signs.
    pub(crate) fn no_deeper(&self, signs: &[Signs], a: Option<usize>, b: Option<usize>) -> bool {
        let zero = Number::int(0);
        let zero_form = Exact { factors: vec![zero.clone(); self.variables], constant: zero };
        let form = |region: Option<usize>| match region {
            Some(region) => self.forms[signs.len() + region].as_ref().map(|form| &*form.exact),
            None => Some(&zero_form),
        };
        let (Some(a), Some(b)) = (form(a), form(b)) else { return false };
        // `b - a < 0`; a contradiction shows that no such point exists.
        let deeper = b.combined(&Number::int(1), a, &Number::int(-1));
        let mut conditions = self.conditions(signs);
        conditions.push(Condition::from_exact(&Rc::new(deeper), true));
        self.has_no_solution(conditions)
    }

    /// Returns whether no point satisfies the conditions, whichever alternative holds for each root in them.
    fn has_no_solution(&self, mut conditions: Vec<Condition>) -> bool {
        // Facts about variables that nothing else mentions have no consequences.
        let requested = conditions.split_off(self.facts.len());
        let mentioned: Vec<bool> = (0..self.variables)
            .map(|variable| {
                self.axes.contains(&Some(variable))
                    || requested.iter().any(|condition| condition.factors[variable] != 0.0)
            })
            .collect();
        let is_relevant = |condition: &Condition| {
            let mut used = condition.factors.iter().zip(&mentioned);
            used.all(|(factor, mentioned)| *factor == 0.0 || *mentioned)
        };
        conditions.retain(is_relevant);
        conditions.extend(requested);
        let mut count = 1;
        let choices: Vec<&Vec<Condition>> = (self.choices.iter())
            .filter(|(root, choices)| mentioned[*root] && choices.iter().all(is_relevant))
            .map(|(_, choices)| choices)
            .take_while(|choices| {
                // All combinations are tried, and their number is a product.
                count *= choices.len();
                count <= MAX_CHOICES
            })
            .collect();
        self.is_unsatisfiable(conditions.clone())
            || !choices.is_empty() && self.is_unsatisfiable_for_all(conditions, &choices)
    }

    /// Returns whether every combination of alternatives is contradictory.
    fn is_unsatisfiable_for_all(
        &self,
        conditions: Vec<Condition>,
        choices: &[&Vec<Condition>],
    ) -> bool {
        let Some((first, rest)) = choices.split_first() else {
            return self.is_unsatisfiable(conditions);
        };
        first.iter().all(|choice| {
            let mut conditions = conditions.clone();
            conditions.push(choice.clone());
            self.is_unsatisfiable_for_all(conditions, rest)
        })
    }

    fn is_unsatisfiable(&self, conditions: Vec<Condition>) -> bool {
        self.without_variables(conditions).is_some_and(|rest| rest.iter().any(Condition::is_false))
    }

    /// Eliminates all variables from conditions, in their own unit.
    fn without_variables(&self, conditions: Vec<Condition>) -> Option<Vec<Condition>> {
        without(rescaled(conditions).0, (0..self.variables).collect())
    }
}

/// Returns a linear form with a factor for each variable.
fn dense(form: Form, variables: usize) -> Rc<Exact> {
    let factors = (0..variables).map(|v| form.factors.get(&v).cloned().unwrap_or(Number::int(0)));
    Rc::new(Exact { factors: factors.collect(), constant: form.constant })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile;
    use crate::source::Source;

    /// `d < 1` and `d > 1 - 1e-13` hold in a thin ring, which doubles cannot distinguish from the empty set.
    #[test]
    fn contradictions_within_rounding_are_ignored() {
        let ball = "hypot(d, z - 3) <= 3";
        let text = format!(
            "tool Ball {{ units mm; curve a = d - 1; curve b = d - 0.9999999999999;
               region core where {ball}, b <= 0 {{ depth: 3 - hypot(d, z - 3); }}
               region ring where {ball}, 0 <= b, a <= 0 {{ depth: 3 - hypot(d, z - 3); }}
               region shell where {ball}, 0 <= a {{ depth: 3 - hypot(d, z - 3); }} }}"
        );
        let tool = compile(&Source::new("a.tool", text)).into_tool().expect("a tool");
        let curves = &tool.model.curves;
        let curve_index =
            |name: &str| curves.iter().position(|curve| curve.name.as_deref() == Some(name));
        let (a, b) = (curve_index("a").expect("a curve"), curve_index("b").expect("a curve"));
        let linear = Linear::new(&tool.model);
        let contradictory = |of_a: Signs, of_b: Signs| {
            let mut signs = vec![ANY_SIGN; curves.len()];
            (signs[a], signs[b]) = (of_a, of_b);
            linear.contradictory(&signs)
        };
        assert!(!contradictory(NEGATIVE, POSITIVE));
        assert!(!contradictory(NEGATIVE, NEGATIVE) && !contradictory(POSITIVE, POSITIVE));
        assert!(contradictory(ZERO, ZERO) && contradictory(ZERO | POSITIVE, ZERO | NEGATIVE));
    }
}
