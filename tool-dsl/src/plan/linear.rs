//! Curves that are linear in the coordinates, or in monomials and roots of them, each taken for a
//! variable of its own: what signs they can have together, by Fourier and Motzkin's elimination, which
//! sees where borders meet in a corner, to a part in 10^12.

use super::eliminate::{Condition, ROUNDING, in_own_unit, scaled, without};
use super::forms::{Form, Variable, Variables, compares_roots};
use crate::expr::Id;
use crate::expr::interval::{self, Cell, EVERYTHING, Interval};
use crate::expr::polynomial::monomial_of;
use crate::formula::{ANY, NEGATIVE, POSITIVE, Signs, ZERO};
use crate::model::Model;

/// The most combinations of choices.
const CHOICES: usize = 8;

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

impl Linear {
    /// What is known at once.
    pub(crate) fn new(model: &Model) -> Linear {
        Linear { choices: Vec::new(), ..Linear::of(model, [], None) }
    }

    /// With the regions' depths, and with what takes a choice.
    ///
    /// Where curves compare squares of roots, all that compare squares are taken for comparisons of
    /// what is squared, as far as its sign is known in a box that has the tool.
    pub(crate) fn with_depths(model: &Model, cell: Cell) -> Linear {
        let mut values = model.curves.iter().map(|curve| curve.value);
        let roots = values.any(|value| compares_roots(&model.graph, value)).then_some(cell);
        Linear::of(model, model.regions.iter().map(|region| region.depth), roots)
    }

    fn of(model: &Model, depths: impl IntoIterator<Item = Id>, roots: Option<Cell>) -> Linear {
        let mut variables = Variables::new(model);
        let mut axes = [None; 3];
        for (coord, axis, _) in model.domain.coordinates() {
            axes[*axis] = Some(variables.of(Variable::Monomial(monomial_of(*coord))));
        }
        let curves = model.curves.iter().map(|curve| curve.value);
        let mut forms: Vec<Option<Form>> =
            curves.chain(depths).map(|value| variables.form(value)).collect();
        if let Some(cell) = roots {
            for (form, curve) in forms.iter_mut().zip(&model.curves) {
                if let Some(compared) = variables.compared(curve.value, cell) {
                    *form = Some(compared);
                }
            }
        }
        let (mut facts, choices) = variables.facts();
        if roots.is_some() {
            facts.extend(variables.projections(forms[model.curves.len()..].iter().flatten()));
        }
        let count = variables.count();
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
        let (conditions, unit) = in_own_unit(self.conditions(signs));
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
                range.high = range.high.min(unit * (end + slack));
            } else if factor < -ROUNDING {
                range.low = range.low.max(unit * (end - slack));
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

    /// Whether these signs contradict one another, if what is linear in the curves settles it: of straight
    /// lines elimination overlooks nothing.
    pub(super) fn judged(&self, signs: &[Signs]) -> Option<bool> {
        let rest = self.without_any(self.conditions(signs))?;
        if absurd(&rest) {
            return Some(true);
        }
        let straight = |form: &Option<(Vec<f64>, f64)>| {
            form.as_ref().is_some_and(|(factors, _)| {
                let bent = |v: usize| factors[v] != 0.0 && !self.axes.contains(&Some(v));
                !(0..self.variables).any(bent)
            })
        };
        let mut asked = self.forms.iter().zip(signs).filter(|(_, sign)| **sign != ANY);
        asked.all(|(form, _)| straight(form)).then_some(false)
    }

    /// The same as [`Linear::contradictory`] in a region, whose depth is not negative.
    pub(crate) fn contradictory_in(&self, region: Option<usize>, signs: &[Signs]) -> bool {
        let mut conditions = self.conditions(signs);
        let depth = region.and_then(|region| self.forms[signs.len() + region].as_ref());
        if let Some((factors, constant)) = depth {
            conditions.push(Condition {
                factors: factors.iter().map(|factor| -factor).collect(),
                constant: -constant,
                strict: false,
            });
        }
        self.absurd(conditions)
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
    fn absurd(&self, mut conditions: Vec<Condition>) -> bool {
        // What is known of variables that nothing else mentions leads nowhere.
        let asked = conditions.split_off(self.facts.len());
        let mentioned: Vec<bool> = (0..self.variables)
            .map(|variable| {
                let mentions = |condition: &Condition| condition.factors[variable] != 0.0;
                self.axes.contains(&Some(variable)) || asked.iter().any(mentions)
            })
            .collect();
        let known = |condition: &Condition| {
            let mut used = condition.factors.iter().zip(&mentioned);
            used.all(|(factor, mentioned)| *factor == 0.0 || *mentioned)
        };
        conditions.retain(known);
        conditions.extend(asked);
        let mut count = 1;
        let choices: Vec<&Vec<Condition>> = (self.choices.iter())
            .filter(|(root, choices)| mentioned[*root] && choices.iter().all(known))
            .map(|(_, choices)| choices)
            .take_while(|choices| {
                count *= choices.len();
                count <= CHOICES
            })
            .collect();
        self.none_keeps(conditions.clone())
            || !choices.is_empty() && self.none_of(conditions, &choices)
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
        self.without_any(conditions).is_some_and(|rest| absurd(&rest))
    }

    /// What remains of conditions, in their own unit, when all variables may be anything.
    fn without_any(&self, conditions: Vec<Condition>) -> Option<Vec<Condition>> {
        without(in_own_unit(conditions).0, (0..self.variables).collect())
    }
}

/// Whether conditions on nothing are not kept.
fn absurd(conditions: &[Condition]) -> bool {
    let absurd = |c: &Condition| c.constant > if c.strict { -ROUNDING } else { ROUNDING };
    conditions.iter().any(absurd)
}
