//! Fourier–Motzkin elimination: the consequences of linear conditions for fewer variables.
//!
//! The algorithm chooses combinations in doubles and treats small values as rounding. A result is accepted
//! only after the combination that led to it was repeated with 256 bits ([`Condition::evaluate_exactly`]).

use crate::number::{self, Number};
use std::collections::{BTreeSet, HashMap, HashSet};
use std::rc::Rc;

/// The bound below which a residue is rounding, relative to the curve's largest coefficient, or to the unit
/// of the conditions.
pub(super) const ROUNDING: f64 = 1e-12;
/// The largest number of conditions that elimination may produce.
const MAX_CONDITIONS: usize = 600;

/// `Σ factor · variable + constant`, with 256 bits.
#[derive(Clone, Debug)]
pub(super) struct Exact {
    pub(super) factors: Vec<Number>,
    pub(super) constant: Number,
}

impl Exact {
    /// Returns `by · self + other_by · other`.
    pub(super) fn combined(&self, by: &Number, other: &Exact, other_by: &Number) -> Exact {
        let sum = |a: &Number, b: &Number| match (a.is_zero(), b.is_zero()) {
            (true, true) => Number::int(0),
            (false, true) => a * by,
            (true, false) => b * other_by,
            (false, false) => &(a * by) + &(b * other_by),
        };
        let factors = self.factors.iter().zip(&other.factors).map(|(a, b)| sum(a, b)).collect();
        Exact { factors, constant: sum(&self.constant, &other.constant) }
    }
}

/// `Σ factor · variable + constant ≤ 0`, or `< 0`, up to a positive factor.
#[derive(Clone, Debug)]
pub(super) struct Condition {
    pub(super) factors: Vec<f64>,
    pub(super) constant: f64,
    strict: bool,
    origin: Origin,
    /// The weighted sum of the factors, if scaling the condition again changes nothing.
    scaled_sum: Option<f64>,
}

/// The origin of a condition: the form it was given as, or the two conditions it was combined from.
#[derive(Clone, Debug)]
enum Origin {
    Given(Rc<Exact>, Source),
    Sum(Rc<Sum>),
}

/// The reason why a condition was given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Source {
    /// It holds everywhere, or all its alternatives are tried.
    Fact,
    /// A form of this index is not positive, or, if it is the opposite, not negative.
    Sign { form: usize, is_opposite: bool },
    /// The query's own condition, beside those of signs.
    Query,
}

/// Given conditions that no point satisfies together.
#[derive(Default)]
pub(super) struct Contradiction {
    pub(super) sources: BTreeSet<Source>,
    /// True if `≤` in place of each `<` might leave a solution.
    pub(super) needs_strictness: bool,
}

/// A positive combination of two conditions in which a variable cancels: the first bounds it from above, the
/// second from below.
#[derive(Debug)]
struct Sum {
    upper: Origin,
    lower: Origin,
    variable: usize,
}

/// A condition combined with 256 bits, with the sums of absolute values of the terms of each factor and of
/// the constant.
struct Combined {
    exact: Rc<Exact>,
    sizes: Vec<f64>,
    size: f64,
}

impl Condition {
    pub(super) fn from_exact(exact: &Rc<Exact>, strict: bool, source: Source) -> Condition {
        Condition {
            factors: exact.factors.iter().map(Number::to_f64).collect(),
            constant: exact.constant.to_f64(),
            strict,
            origin: Origin::Given(Rc::clone(exact), source),
            scaled_sum: None,
        }
    }

    /// Returns whether it is about the given variables only.
    pub(super) fn is_about(&self, variables: &[bool]) -> bool {
        self.factors.iter().zip(variables).all(|(factor, given)| *factor == 0.0 || *given)
    }

    /// Returns the condition with `<` in place of `≤`.
    pub(super) fn strictly(&self) -> Condition {
        Condition { strict: true, ..self.clone() }
    }

    /// Returns the coefficient of the `wanted` variable, the constant, and the rounding error of the
    /// constant, computed with 256 bits. Returns `None` if the condition has another variable (any variable,
    /// if none is `wanted`), or if its combination is unusable. The coefficient may be as small as rounding.
    pub(super) fn evaluate_exactly(&self, wanted: Option<usize>) -> Option<(Number, Number, f64)> {
        let Combined { exact, sizes, size } = &*combined(&self.origin, &mut HashMap::new());
        let mut factor = Number::int(0);
        for (variable, value) in exact.factors.iter().enumerate() {
            let rounding_error = number::ROUNDING * sizes[variable];
            let is_rounding = rounding_error.is_finite() && value.to_f64().abs() <= rounding_error;
            // A factor that cancels leaves its rounding, which is not a variable left over.
            if Some(variable) == wanted {
                factor = value.clone();
            } else if !value.is_zero() && !is_rounding {
                return None;
            }
        }
        size.is_finite().then(|| (factor, exact.constant.clone(), number::ROUNDING * size))
    }

    /// Returns the contradiction among the given conditions that were combined to this one, if it is false for all values
    /// of its variables, confirmed with 256 bits.
    pub(super) fn contradiction(&self) -> Option<Contradiction> {
        let limit = if self.strict { -ROUNDING } else { 0.0 };
        (self.constant > limit).then_some(())?;
        let (_, constant, rounding_error) = self.evaluate_exactly(None)?;
        let value = constant.to_f64();
        let is_positive = value >= 2.0 * rounding_error && !constant.is_zero();
        let is_false = is_positive || self.strict && value >= -rounding_error;
        if !is_false {
            return None;
        }
        let mut sources = BTreeSet::new();
        collect_sources(&self.origin, &mut HashSet::new(), &mut sources);
        Some(Contradiction {
            sources,
            needs_strictness: !(is_positive && self.constant > ROUNDING),
        })
    }
}

/// Collects the sources of the given conditions behind another, visiting each part once.
fn collect_sources(
    origin: &Origin,
    visited: &mut HashSet<*const Sum>,
    sources: &mut BTreeSet<Source>,
) {
    match origin {
        Origin::Given(_, source) => {
            sources.insert(*source);
        }
        Origin::Sum(sum) if visited.insert(Rc::as_ptr(sum)) => {
            collect_sources(&sum.upper, visited, sources);
            collect_sources(&sum.lower, visited, sources);
        }
        Origin::Sum(_) => {}
    }
}

/// Repeats the combination behind a condition with 256 bits, each part once.
fn combined(origin: &Origin, known: &mut HashMap<*const Sum, Rc<Combined>>) -> Rc<Combined> {
    let sum = match origin {
        Origin::Given(exact, _) => {
            let sizes = exact.factors.iter().map(|factor| factor.to_f64().abs()).collect();
            let size = exact.constant.to_f64().abs();
            return Rc::new(Combined { exact: Rc::clone(exact), sizes, size });
        }
        Origin::Sum(sum) => sum,
    };
    if let Some(known) = known.get(&Rc::as_ptr(sum)) {
        return Rc::clone(known);
    }
    let [a, b] = [&sum.upper, &sum.lower].map(|origin| combined(origin, known));
    let (x, y) = (-&b.exact.factors[sum.variable], a.exact.factors[sum.variable].clone());
    // Rescaling keeps factors near 1 through repeated combination.
    let scale = Number::from_f64(x.to_f64().abs().max(y.to_f64().abs()).log2().floor().exp2());
    let rescale =
        |n: &Number| scale.as_ref().and_then(|scale| n.checked_div(scale)).unwrap_or(n.clone());
    let (x, y) = (rescale(&x), rescale(&y));
    let mut exact = a.exact.combined(&x, &b.exact, &y);
    // It cancels by construction, apart from rounding.
    exact.factors[sum.variable] = Number::int(0);
    let combine = |a: f64, b: f64| a * x.to_f64().abs() + b * y.to_f64().abs();
    let sizes = a.sizes.iter().zip(&b.sizes).map(|(a, b)| combine(*a, *b)).collect();
    // Only positive multiples preserve the inequality. An infinite size marks the result as unusable.
    let is_valid = !x.is_negative() && !y.is_negative();
    let size = if is_valid { combine(a.size, b.size) } else { f64::INFINITY };
    let result = Rc::new(Combined { exact: Rc::new(exact), sizes, size });
    known.insert(Rc::as_ptr(sum), Rc::clone(&result));
    result
}

/// Rescales conditions to a unit of their own, a power of two near the largest constant, and returns that
/// unit. The rounding tolerance therefore does not depend on the unit that a tool is written in.
pub(super) fn rescaled(conditions: Vec<Condition>) -> (Vec<Condition>, f64) {
    let mut conditions: Vec<Condition> = conditions.into_iter().map(scaled).collect();
    let largest = conditions.iter().fold(0f64, |largest, c| largest.max(c.constant.abs()));
    let unit = if largest > 0.0 { largest.log2().floor().exp2() } else { 1.0 };
    conditions.iter_mut().for_each(|condition| condition.constant /= unit);
    (conditions, unit)
}

/// Eliminates variables, always the one that adds fewest conditions. Returns `None` if there are too many
/// conditions.
pub(super) fn without(
    mut conditions: Vec<Condition>,
    mut variables: Vec<usize>,
) -> Option<Vec<Condition>> {
    while !variables.is_empty() {
        // A variable bounded from one side only is eliminated by dropping its conditions.
        let (free, bounded): (Vec<usize>, Vec<usize>) =
            variables.into_iter().partition(|variable| {
                !conditions.iter().any(|c| c.factors[*variable] > 0.0)
                    || !conditions.iter().any(|c| c.factors[*variable] < 0.0)
            });
        variables = bounded;
        if !free.is_empty() {
            conditions.retain(|c| free.iter().all(|variable| c.factors[*variable] == 0.0));
            continue;
        }
        let index =
            (0..variables.len()).min_by_key(|index| growth(&conditions, variables[*index]))?;
        conditions = eliminate(conditions, variables.swap_remove(index))?;
    }
    Some(conditions)
}

/// Returns the number of conditions that the elimination of a variable adds: each upper bound is combined with each
/// lower one, and all of these are dropped.
fn growth(conditions: &[Condition], variable: usize) -> usize {
    let upper = conditions.iter().filter(|c| c.factors[variable] > ROUNDING).count();
    let lower = conditions.iter().filter(|c| c.factors[variable] < -ROUNDING).count();
    (upper * lower).saturating_sub(upper + lower)
}

/// Eliminates one variable. Returns `None` if there are too many conditions.
fn eliminate(conditions: Vec<Condition>, variable: usize) -> Option<Vec<Condition>> {
    let (mut upper, mut lower, mut rest) = (Vec::new(), Vec::new(), Vec::new());
    for condition in tightest(conditions) {
        match condition.factors[variable] {
            f if f > ROUNDING => upper.push(condition),
            f if f < -ROUNDING => lower.push(condition),
            _ => rest.push(condition),
        }
    }
    // The number may square with each variable. Giving up proves less, but nothing false.
    if rest.len() + upper.len() * lower.len() > MAX_CONDITIONS {
        return None;
    }
    for a in &upper {
        for b in &lower {
            let (x, y) = (-b.factors[variable], a.factors[variable]);
            let mut factors = a.factors.clone();
            for (factor, other) in factors.iter_mut().zip(&b.factors) {
                *factor = *factor * x + other * y;
            }
            factors[variable] = 0.0;
            let constant = a.constant * x + b.constant * y;
            let sum = Sum { upper: a.origin.clone(), lower: b.origin.clone(), variable };
            let strict = a.strict || b.strict;
            let origin = Origin::Sum(Rc::new(sum));
            rest.push(Condition { factors, constant, strict, origin, scaled_sum: None });
        }
    }
    Some(rest)
}

/// Keeps only the tightest of the conditions that have the same factors.
fn tightest(conditions: Vec<Condition>) -> Vec<Condition> {
    let mut tightest_conditions: Vec<Condition> = Vec::new();
    let mut sums: Vec<f64> = Vec::new();
    for condition in conditions {
        let condition = scaled(condition);
        let sum = condition.scaled_sum.unwrap_or_else(|| weighted_sum(&condition.factors));
        // Factors that agree up to `ROUNDING` each have sums that agree up to so many times that, and half of it again for
        // the rounding of the sums. Few others do.
        let tolerance = 1.5 * ROUNDING * condition.factors.len() as f64;
        let same_factors = (0..sums.len()).find(|&other| {
            (sums[other] - sum).abs() <= tolerance
                && have_same_factors(&tightest_conditions[other], &condition)
        });
        match same_factors {
            Some(index) => {
                let other = &tightest_conditions[index];
                let difference = condition.constant - other.constant;
                // If two conditions differ by rounding only, the strict one is tighter.
                let are_equal = difference.abs() <= ROUNDING * condition.constant.abs().max(1.0);
                let is_stricter = condition.strict && !other.strict;
                if if are_equal && condition.strict != other.strict {
                    is_stricter
                } else {
                    difference > 0.0
                } {
                    tightest_conditions[index] = condition;
                    sums[index] = sum;
                }
            }
            None => {
                tightest_conditions.push(condition);
                sums.push(sum);
            }
        }
    }
    tightest_conditions
}

fn have_same_factors(a: &Condition, b: &Condition) -> bool {
    a.factors.iter().zip(&b.factors).all(|(a, b)| (a - b).abs() <= ROUNDING)
}

/// Returns the sum of factors with weights of at most 1, which tells most lists of factors apart.
fn weighted_sum(factors: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (index, factor) in factors.iter().enumerate() {
        sum += factor / (index + 1) as f64;
    }
    sum
}

/// Scales a condition to a largest factor of 1 and sets residues of rounding to 0.
pub(super) fn scaled(mut condition: Condition) -> Condition {
    // Most conditions pass through several eliminations unchanged.
    if condition.scaled_sum.is_some() {
        return condition;
    }
    let largest = largest_size(&condition.factors);
    if largest > ROUNDING {
        let scale = 1.0 / largest;
        condition.constant *= scale;
        for factor in &mut condition.factors {
            *factor *= scale;
            if factor.abs() < ROUNDING {
                *factor = 0.0;
            }
        }
        // Rounding may leave a largest factor beside 1, which scaling again would move.
        if largest_size(&condition.factors) != 1.0 {
            return condition;
        }
    }
    condition.scaled_sum = Some(weighted_sum(&condition.factors));
    condition
}

fn largest_size(factors: &[f64]) -> f64 {
    let mut largest = 0f64;
    for factor in factors {
        largest = largest.max(factor.abs());
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn condition(factors: [f64; 3], constant: f64) -> Condition {
        let number = |value: f64| Number::from_f64(value).expect("finite");
        let exact = Exact { factors: factors.map(number).to_vec(), constant: number(constant) };
        Condition::from_exact(&Rc::new(exact), false, Source::Fact)
    }

    /// Conditions are merged if and only if their scaled factors agree up to `ROUNDING`, whatever their weighted sums.
    #[test]
    fn conditions_with_the_same_factors_are_merged() {
        let mut kept: Vec<Condition> = Vec::new();
        let mut all = Vec::new();
        for k in 0..300 {
            let number = f64::from(k);
            let noise = (number * 0.37).sin() * 2.0 * ROUNDING;
            // Multiples of a few directions, off by rounding or a little more.
            let direction = [(number % 5.0) - 2.0, 1.0 + noise, (number % 3.0) / 7.0 - noise];
            let next = condition(direction.map(|part| part * (1.0 + number)), (number * 1.7).cos());
            all.push(next.clone());
            let next = scaled(next);
            match kept.iter_mut().find(|other| have_same_factors(other, &next)) {
                Some(other) if next.constant > other.constant => *other = next,
                Some(_) => {}
                None => kept.push(next),
            }
        }
        let found = tightest(all);
        assert_eq!(found.len(), kept.len());
        for (found, kept) in found.iter().zip(&kept) {
            assert_eq!((&found.factors, found.constant), (&kept.factors, kept.constant));
        }
    }

    #[test]
    fn a_condition_that_counts_as_scaled_is_not_changed_by_scaling() {
        for k in 1..200 {
            let once = scaled(condition([f64::from(k), -0.3, 1e-13], 1.0 / f64::from(k)));
            if once.scaled_sum.is_some() {
                let again = scaled(Condition { scaled_sum: None, ..once.clone() });
                assert_eq!((&again.factors, again.constant), (&once.factors, once.constant));
            }
        }
    }
}
