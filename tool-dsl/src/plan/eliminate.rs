//! Fourier and Motzkin's elimination: what linear conditions say of fewer variables.

/// A residue below this, relative to the curve's largest coefficient, or to the unit that conditions are
/// in, is rounding.
pub(super) const ROUNDING: f64 = 1e-12;
/// The most conditions that elimination may grow to.
const CONDITIONS: usize = 600;

/// `Σ factor · variable + constant ≤ 0`, or `< 0`.
#[derive(Clone, Debug)]
pub(super) struct Condition {
    pub(super) factors: Vec<f64>,
    pub(super) constant: f64,
    pub(super) strict: bool,
}

/// Conditions in a unit of their own, a power of two near the largest constant; and that unit. So what is
/// rounding does not depend on the unit that a tool is written in.
pub(super) fn in_own_unit(conditions: Vec<Condition>) -> (Vec<Condition>, f64) {
    let mut conditions: Vec<Condition> = conditions.into_iter().map(scaled).collect();
    let largest = conditions.iter().fold(0f64, |most, c| most.max(c.constant.abs()));
    let unit = if largest > 0.0 { largest.log2().floor().exp2() } else { 1.0 };
    conditions.iter_mut().for_each(|condition| condition.constant /= unit);
    (conditions, unit)
}

/// The conditions that remain when some variables may be anything, those first that leave fewest;
/// `None` if there are too many.
pub(super) fn without(
    mut conditions: Vec<Condition>,
    mut variables: Vec<usize>,
) -> Option<Vec<Condition>> {
    while !variables.is_empty() {
        // What is bounded from one side only takes its conditions along.
        let loose = |variable: &usize| {
            let any = |sign: f64| conditions.iter().any(|c| sign * c.factors[*variable] > 0.0);
            !any(1.0) || !any(-1.0)
        };
        let (free, bounded): (Vec<usize>, Vec<usize>) = variables.into_iter().partition(loose);
        variables = bounded;
        if !free.is_empty() {
            conditions.retain(|c| free.iter().all(|variable| c.factors[*variable] == 0.0));
            continue;
        }
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
pub(super) fn scaled(mut condition: Condition) -> Condition {
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
