//! The signs that linear curves can have together, by Fourier–Motzkin elimination. Curves are linear in the
//! coordinates, or in monomials and roots of them, each taken as a separate variable. Elimination recognises
//! borders that meet in a corner. Its results are confirmed with the 256 bits of constants.

mod answers;
mod forms;
mod fourier_motzkin;

use crate::expr::Id;
use crate::expr::interval::{self, Cell, ENTIRE, Interval};
use crate::expr::polynomial::monomial_of;
use crate::formula::{ANY_SIGN, NEGATIVE, POSITIVE, Signs, ZERO};
use crate::model::Model;
use crate::number::Number;
use answers::{Addition, Answers};
use forms::{Form, Variable, Variables};
use fourier_motzkin::{
    Condition, Contradiction, Exact, ROUNDING, Source, rescaled, scaled, without,
};
use std::cell::RefCell;
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
    /// Answers that queries have found so far.
    answers: RefCell<Answers>,
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
    /// Makes the linear form of an index from itself and its negative.
    fn new(form: usize, [exact, opposite]: [Rc<Exact>; 2]) -> LinearForm {
        let sides = [(&exact, false), (&opposite, true)].map(|(exact, is_opposite)| {
            Condition::from_exact(exact, false, Source::Sign { form, is_opposite })
        });
        let sizes = || sides[0].factors.iter().map(|factor| factor.abs());
        let largest = sizes().fold(0.0, f64::max);
        let is_lost = sizes().any(|size| size != 0.0 && size < 1e3 * ROUNDING * largest);
        LinearForm { exact, sides, is_lost }
    }
}

impl Linear {
    /// Collects the linear curves, without depths and choices.
    pub(crate) fn new(model: &Model) -> Linear {
        Linear { choices: Vec::new(), ..Linear::with_depths(model, &[]) }
    }

    /// Collects the linear curves, depths that begin with those of [`Model::depths`], and the choices for roots.
    pub(crate) fn with_depths(model: &Model, depths: &[Id]) -> Linear {
        let mut variables = Variables::new(model);
        let mut axes = [None; 3];
        for (coord, axis, _) in model.domain.coordinates() {
            axes[*axis] = Some(variables.of(Variable::Monomial(monomial_of(*coord))));
        }
        let values = model.curve_values().chain(depths.iter().copied());
        let forms: Vec<Option<Form>> = values.map(|value| variables.form(value)).collect();
        let (facts, choices) = variables.facts();
        let count = variables.count();
        let condition =
            |form: Form| Condition::from_exact(&dense(form, count), false, Source::Fact);
        Linear {
            forms: forms
                .into_iter()
                .enumerate()
                .map(|(index, form)| {
                    let opposite = Form::default().plus(form.as_ref()?, &Number::int(-1));
                    Some(LinearForm::new(index, [form?, opposite].map(|form| dense(form, count))))
                })
                .collect(),
            variables: count,
            axes,
            facts: facts.into_iter().map(condition).collect(),
            choices: choices
                .into_iter()
                .map(|(root, choices)| (root, choices.into_iter().map(condition).collect()))
                .collect(),
            answers: RefCell::default(),
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
        self.has_no_solution(signs, Addition::None)
    }

    /// Returns whether these signs contradict one another, if the linear part of the curves decides it. For
    /// straight lines elimination is complete.
    pub(super) fn is_contradictory(&self, signs: &[Signs]) -> Option<bool> {
        if self.answers.borrow().contradict(signs, Addition::None) {
            return Some(true);
        }
        let rest = self.without_variables(self.conditions(signs))?;
        if let Some(contradiction) = rest.iter().find_map(Condition::contradiction) {
            self.answers.borrow_mut().add_contradiction(signs, Addition::None, &contradiction);
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
        // A point of a region has a depth of 0 or more, which the path does not say.
        let known = region.filter(|region| self.forms[signs.len() + region].is_some());
        self.has_no_solution(signs, known.map_or(Addition::None, Addition::NonNegativeDepth))
    }

    /// Returns whether one region is nowhere deeper than another, or than the outside, where curves have
    /// these signs.
    pub(crate) fn no_deeper(&self, signs: &[Signs], a: Option<usize>, b: Option<usize>) -> bool {
        let has_form =
            |region: Option<usize>| region.is_none_or(|r| self.forms[signs.len() + r].is_some());
        // A contradiction shows that no point is deeper.
        has_form(a) && has_form(b) && self.has_no_solution(signs, Addition::Deeper([a, b]))
    }

    /// Returns the condition that a query adds to those of the signs of so many curves.
    fn added_condition(&self, curves: usize, addition: Addition) -> Option<Condition> {
        match addition {
            Addition::None => None,
            Addition::NonNegativeDepth(region) => {
                self.forms[curves + region].as_ref().map(|depth| depth.sides[1].clone())
            }
            Addition::Deeper(regions) => {
                let zero = Number::int(0);
                let zero_form =
                    Exact { factors: vec![zero.clone(); self.variables], constant: zero };
                let [a, b] = regions.map(|region| match region {
                    Some(region) => self.forms[curves + region].as_ref().map(|form| &*form.exact),
                    None => Some(&zero_form),
                });
                // `b - a < 0`
                let deeper = b?.combined(&Number::int(1), a?, &Number::int(-1));
                Some(Condition::from_exact(&Rc::new(deeper), true, Source::Query))
            }
        }
    }

    /// Returns whether no point has these signs and satisfies the added condition.
    fn has_no_solution(&self, signs: &[Signs], addition: Addition) -> bool {
        if let Some(known) = self.answers.borrow().has_no_solution(signs, addition) {
            return known;
        }
        let mut conditions = self.conditions(signs);
        conditions.extend(self.added_condition(signs.len(), addition));
        let contradiction = self.contradiction(conditions);
        let mut answers = self.answers.borrow_mut();
        match &contradiction {
            Some(contradiction) => answers.add_contradiction(signs, addition, contradiction),
            None => answers.add_consistent(signs, addition),
        }
        contradiction.is_some()
    }

    /// Returns, for each variable, whether it is a coordinate or a condition other than the facts mentions it.
    fn mentioned(&self, conditions: &[Condition]) -> Vec<bool> {
        let mut mentioned: Vec<bool> =
            (0..self.variables).map(|variable| self.axes.contains(&Some(variable))).collect();
        for condition in &conditions[self.facts.len()..] {
            for (mentioned, factor) in mentioned.iter_mut().zip(&condition.factors) {
                *mentioned |= *factor != 0.0;
            }
        }
        mentioned
    }

    /// Drops the facts about variables that nothing else mentions, which have no consequences.
    fn relevant(&self, mut conditions: Vec<Condition>, mentioned: &[bool]) -> Vec<Condition> {
        let requested = conditions.split_off(self.facts.len());
        conditions.retain(|condition| condition.is_about(mentioned));
        conditions.extend(requested);
        conditions
    }

    /// Returns a contradiction among conditions, whichever alternative holds for each root in them.
    fn contradiction(&self, conditions: Vec<Condition>) -> Option<Contradiction> {
        let mentioned = self.mentioned(&conditions);
        let conditions = self.relevant(conditions, &mentioned);
        let mut count = 1;
        let choices: Vec<&Vec<Condition>> = (self.choices.iter())
            .filter(|(root, choices)| {
                mentioned[*root] && choices.iter().all(|choice| choice.is_about(&mentioned))
            })
            .map(|(_, choices)| choices)
            .take_while(|choices| {
                // All combinations are tried, and their number is a product.
                count *= choices.len();
                count <= MAX_CHOICES
            })
            .collect();
        let found = self.contradiction_by_elimination(conditions.clone());
        if found.is_some() || choices.is_empty() {
            return found;
        }
        self.contradiction_for_all(conditions, &choices)
    }

    /// Returns the contradictions of all combinations of alternatives, if every one is contradictory.
    fn contradiction_for_all(
        &self,
        conditions: Vec<Condition>,
        choices: &[&Vec<Condition>],
    ) -> Option<Contradiction> {
        let Some((first, rest)) = choices.split_first() else {
            return self.contradiction_by_elimination(conditions);
        };
        let mut all = Contradiction::default();
        for choice in *first {
            let mut conditions = conditions.clone();
            conditions.push(choice.clone());
            let one = self.contradiction_for_all(conditions, rest)?;
            all.sources.extend(one.sources);
            all.needs_strictness |= one.needs_strictness;
        }
        Some(all)
    }

    fn contradiction_by_elimination(&self, conditions: Vec<Condition>) -> Option<Contradiction> {
        self.without_variables(conditions)?.iter().find_map(Condition::contradiction)
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
    use crate::source::Source;
    use crate::{compile, library};

    /// Every answer that rests on earlier ones is that of elimination by itself.
    #[test]
    fn remembered_answers_are_those_of_elimination() {
        for tool in library::tools_by_hand() {
            let model = &tool.model;
            let (curves, regions) = (model.curves.len(), model.regions.len());
            let depths: Vec<Id> = model.regions.iter().map(|region| region.depth).collect();
            let linear = Linear::with_depths(model, &depths);
            let mut counts = [0; 2];
            for number in 0..400u32 {
                // The signs at a point, some of them forgotten, so that queries resemble one another; or opposite ones.
                let signs: Vec<Signs> = (0..curves as u32)
                    .map(|curve| {
                        let mixed = (number / 3 + 1).wrapping_mul(0x9E37_79B9 ^ curve << 7) >> 9;
                        let choices = [NEGATIVE, POSITIVE, NEGATIVE | ZERO, POSITIVE | ZERO, ZERO];
                        choices.get((mixed % 11) as usize).copied().unwrap_or(ANY_SIGN)
                    })
                    .collect();
                let region = number as usize % regions;
                let other = Some((region + 1) % regions).filter(|_| number % 2 == 0);
                let ask = || {
                    let contradictory = linear.contradictory(&signs);
                    let in_region = linear.contradictory_in(Some(region), &signs);
                    [contradictory, in_region, linear.no_deeper(&signs, Some(region), other)]
                };
                let found = ask();
                let known = linear.answers.take();
                assert_eq!(found, ask(), "{} {signs:?}", model.name);
                linear.answers.replace(known);
                counts[usize::from(found[2])] += 1;
            }
            assert!(!counts.contains(&0), "{} {counts:?}", model.name);
        }
    }

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
