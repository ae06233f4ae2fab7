//! Answers of queries, remembered: a contradiction needs only a few of a query's signs, and is one for every other query with
//! these signs.

use super::fourier_motzkin::{Contradiction, Source};
use crate::formula::{CurveIndex, NEGATIVE, POSITIVE, Signs, ZERO};
use std::collections::{HashMap, HashSet};

/// The condition that a query adds to the signs of curves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Addition {
    /// No condition.
    None,
    /// A region's depth is not negative.
    NonNegativeDepth(usize),
    /// The first region is deeper than the second; `None` is the outside, whose depth is 0.
    Deeper([Option<usize>; 2]),
}

/// For each of some curves, the signs of which it has one.
type Demands = Vec<(CurveIndex, Signs)>;

/// The answers that queries have found.
#[derive(Default)]
pub(super) struct Answers {
    /// Demands that no point meets, if it also satisfies the addition.
    contradictions: HashMap<Addition, Vec<Demands>>,
    /// The queries without a contradiction.
    consistent: HashSet<(Addition, Vec<Signs>)>,
}

impl Answers {
    /// Returns whether no point has these signs and satisfies the addition, if that is known.
    pub(super) fn has_no_solution(&self, signs: &[Signs], addition: Addition) -> Option<bool> {
        if self.contradict(signs, addition) {
            return Some(true);
        }
        self.consistent.contains(&(addition, signs.to_vec())).then_some(false)
    }

    /// Returns whether a known contradiction shows that no point has these signs and satisfies the addition.
    pub(super) fn contradict(&self, signs: &[Signs], addition: Addition) -> bool {
        let without_addition = self.contradictions.get(&Addition::None);
        let with_addition =
            self.contradictions.get(&addition).filter(|_| addition != Addition::None);
        without_addition
            .into_iter()
            .chain(with_addition)
            .flatten()
            .any(|demands| demands.iter().all(|(curve, allowed)| meets(signs[*curve], *allowed)))
    }

    /// Remembers the demands of a contradiction that was found for these signs.
    pub(super) fn add_contradiction(
        &mut self,
        signs: &[Signs],
        addition: Addition,
        contradiction: &Contradiction,
    ) {
        let mut demands: Demands = Vec::new();
        let mut needs_addition = false;
        for source in &contradiction.sources {
            let (curve, side) = match *source {
                Source::Fact => continue,
                Source::Sign { form, is_opposite } if form < signs.len() => {
                    (form, if is_opposite { POSITIVE } else { NEGATIVE })
                }
                // Forms that follow those of curves are depths.
                Source::Sign { .. } | Source::Query => {
                    needs_addition = true;
                    continue;
                }
            };
            // The condition was strict if the curve could not be 0.
            let is_strict = contradiction.needs_strictness && signs[curve] == side;
            let allowed = if is_strict { side } else { side | ZERO };
            match demands.last_mut() {
                // Both sides of a curve are only demanded of its zeros.
                Some((last, known)) if *last == curve => *known &= allowed,
                _ => demands.push((curve, allowed)),
            }
        }
        let addition = if needs_addition { addition } else { Addition::None };
        self.contradictions.entry(addition).or_default().push(demands);
    }

    /// Remembers a query without a contradiction.
    pub(super) fn add_consistent(&mut self, signs: &[Signs], addition: Addition) {
        self.consistent.insert((addition, signs.to_vec()));
    }
}

/// Returns whether a curve with these signs has only allowed ones. Elimination does not use a curve without any sign.
fn meets(signs: Signs, allowed: Signs) -> bool {
    signs != 0 && signs & !allowed == 0
}
