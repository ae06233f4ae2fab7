//! Values compared with their limits.

use std::fmt::Debug;
use touchoff::Interval;

/// Number of misses per tool that a failing test describes.
const DESCRIBED_MISSES: usize = 3;

/// The comparisons of one tool, or of one special case.
#[derive(Debug)]
pub struct Checks {
    tool: String,
    quantities: Vec<Quantity>,
    misses: Vec<String>,
}

/// A quantity, its limit, and its worst value so far.
#[derive(Clone, Debug)]
struct Quantity {
    /// The name, with the unit in brackets.
    name: &'static str,
    limit: f64,
    cases: usize,
    /// The largest value; infinite if a value was NaN.
    worst: f64,
    /// The place of the worst value, to the last bit.
    place: String,
}

impl Quantity {
    /// Returns the worst value, rounded for people.
    fn rounded(&self) -> f64 {
        (self.worst * 1e3).round() / 1e3
    }
}

impl Checks {
    /// Makes an empty list.
    pub fn new(tool: &str) -> Checks {
        Checks { tool: tool.to_owned(), quantities: Vec::new(), misses: Vec::new() }
    }

    /// Compares a value with its limit. NaN is a miss.
    pub fn within(
        &mut self,
        name: &'static str,
        value: f64,
        limit: f64,
        place: impl Fn() -> String,
    ) {
        let is_same = |quantity: &Quantity| quantity.name == name && quantity.limit == limit;
        let index = self.quantities.iter().position(is_same).unwrap_or_else(|| {
            let place = String::new();
            self.quantities.push(Quantity { name, limit, cases: 0, worst: 0.0, place });
            self.quantities.len() - 1
        });
        let quantity = &mut self.quantities[index];
        quantity.cases += 1;
        let magnitude = if value.is_nan() { f64::INFINITY } else { value };
        if magnitude > quantity.worst {
            (quantity.worst, quantity.place) = (magnitude, place());
        }
        if magnitude > limit && self.misses.len() < DESCRIBED_MISSES {
            let (tool, place) = (&self.tool, place());
            self.misses.push(format!("{tool}: {name} is {value:?}, above {limit}, at {place}"));
        }
    }

    /// Checks that an event did not occur.
    pub fn never(&mut self, name: &'static str, occurred: bool, place: impl Fn() -> String) {
        self.within(name, f64::from(occurred), 0.0, place);
    }

    /// Returns the number of comparisons.
    pub fn cases(&self) -> usize {
        self.quantities.iter().map(|quantity| quantity.cases).sum()
    }

    /// Returns whether some value of a quantity exceeded its limit.
    pub fn is_missed(&self, name: &str) -> bool {
        let mut quantities = self.quantities.iter();
        quantities.any(|quantity| quantity.name == name && quantity.worst > quantity.limit)
    }

    /// Prints the worst value of each quantity on one line, and where that of `placed` occurred.
    pub fn print_line(&self, placed: &str) {
        let described = self.quantities.iter().map(|quantity| {
            let value = format!("{} {}", quantity.name, quantity.rounded());
            if quantity.name == placed { format!("{value} at {}", quantity.place) } else { value }
        });
        eprintln!("{}: {}", self.tool, described.collect::<Vec<_>>().join(", "));
    }
}

/// Prints the worst value of each quantity over all tools, one line each.
pub fn print_worst(item: &str, tools: &[Checks]) {
    let mut worst: Vec<(&str, Quantity)> = Vec::new();
    for checks in tools {
        for quantity in &checks.quantities {
            let known = worst
                .iter_mut()
                .find(|(_, known)| known.name == quantity.name && known.limit == quantity.limit);
            let Some((tool, known)) = known else {
                worst.push((&checks.tool, quantity.clone()));
                continue;
            };
            let cases = known.cases + quantity.cases;
            if quantity.worst > known.worst {
                (*tool, *known) = (&checks.tool, quantity.clone());
            }
            known.cases = cases;
        }
    }
    for (tool, quantity) in worst {
        let (name, cases, worst) = (quantity.name, quantity.cases, quantity.rounded());
        let place = match quantity.worst {
            0.0 => String::new(),
            _ => format!(", {tool} at {}", quantity.place),
        };
        eprintln!("{item}: {name} {worst} of {} in {cases} cases{place}", quantity.limit);
    }
}

/// Asserts that no limit was exceeded.
pub fn assert_no_misses(tools: &[Checks]) {
    let misses: Vec<&String> = tools.iter().flat_map(|checks| &checks.misses).collect();
    assert!(misses.is_empty(), "{misses:#?}");
}

/// Asserts that two numbers differ by at most a tolerance.
#[track_caller]
pub fn assert_near(found: f64, expected: f64, tolerance: f64, case: impl Debug) {
    let is_near = (found - expected).abs() <= tolerance;
    assert!(is_near, "{found:?} is not {expected:?} within {tolerance:e}: {case:?}");
}

/// Asserts that an interval contains a number and is at most this wide.
#[track_caller]
pub fn assert_contains(found: Interval, expected: f64, width: f64, case: impl Debug) {
    let is_right = found.contains(expected) && found.width() <= width;
    assert!(is_right, "{expected:?} in {found:?}, at most {width:e} wide: {case:?}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_exceeds_a_limit_or_is_nan_is_a_miss() {
        for (value, is_miss) in [(1.0, false), (1.0f64.next_up(), true), (f64::NAN, true)] {
            let mut checks = Checks::new("tool");
            checks.within("value", value, 1.0, String::new);
            checks.never("event", false, String::new);
            assert_eq!((checks.is_missed("value"), checks.is_missed("event")), (is_miss, false));
            assert_eq!(checks.misses.is_empty(), !is_miss);
        }
    }
}
