//! Counts and findings of a suite, which threads collect and the suite adds up.

use std::fmt::{Display, Formatter};
use std::iter::Sum;

/// Named counts, and named findings with their texts, in the order in which they were first seen.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    counts: Vec<(&'static str, u64)>,
    findings: Vec<(&'static str, String)>,
}

impl Tally {
    /// Adds to a count.
    pub fn add(&mut self, name: &'static str, number: u64) {
        match self.counts.iter_mut().find(|(known, _)| *known == name) {
            Some((_, count)) => *count += number,
            None => self.counts.push((name, number)),
        }
    }

    /// Adds 1 to a count if something is so.
    pub fn see(&mut self, name: &'static str, is_so: bool) {
        self.add(name, u64::from(is_so));
    }

    /// Adds a finding, and 1 to the count of its name.
    pub fn find(&mut self, name: &'static str, text: String) {
        self.add(name, 1);
        self.findings.push((name, text));
    }

    /// Adds a finding if something occurred.
    pub fn never(&mut self, name: &'static str, occurred: bool, text: impl Fn() -> String) {
        if occurred {
            self.find(name, text());
        }
    }

    /// Returns a count; 0 for a name that was never seen.
    pub fn count(&self, name: &str) -> u64 {
        self.counts.iter().find(|(known, _)| *known == name).map_or(0, |(_, count)| *count)
    }

    /// Asserts that there is no finding of a name.
    pub fn assert_none(&self, name: &str) {
        let found = self.findings.iter().filter(|(known, _)| *known == name);
        let found: Vec<&String> = found.map(|(_, text)| text).collect();
        assert!(found.is_empty(), "{name}: {found:#?}");
    }
}

impl Sum for Tally {
    fn sum<I: Iterator<Item = Tally>>(tallies: I) -> Tally {
        tallies.fold(Tally::default(), |mut sum, tally| {
            tally.counts.into_iter().for_each(|(name, count)| sum.add(name, count));
            sum.findings.extend(tally.findings);
            sum
        })
    }
}

impl Display for Tally {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let counts = self.counts.iter().map(|(name, count)| format!("{count} {name}"));
        f.write_str(&counts.collect::<Vec<_>>().join(", "))
    }
}
