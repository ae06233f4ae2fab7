//! Undecided comparisons, and the values selected by them.

use super::Enclosure;
use crate::interval::Interval;
use std::ops::{BitAnd, BitOr, Not};

/// A first-order enclosure of a function over a box: its value at a reference point, and its slopes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LinearEnclosure {
    pub(super) at: Interval,
    pub(super) slope: [Interval; 3],
}

impl LinearEnclosure {
    pub(super) fn negated(self) -> LinearEnclosure {
        LinearEnclosure { at: self.at.negated(), slope: self.slope.map(Interval::negated) }
    }

    /// Returns the function's values at a point whose displacement from the reference point is known as an
    /// interval along each axis.
    pub(super) fn values(&self, displacement: [Interval; 3]) -> Interval {
        let terms = (0..3).map(|k| self.slope[k].times(displacement[k]));
        terms.fold(self.at, Interval::plus)
    }
}

/// A value that a function may take where another function, the gap, is at most 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Choice {
    pub(super) value: LinearEnclosure,
    pub(super) gap: LinearEnclosure,
}

/// The alternatives of a choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Choices {
    None,
    One(Choice),
    Two([Choice; 2]),
    Many,
}

impl Choices {
    pub(super) fn and(self, other: Choices) -> Choices {
        match (self, other) {
            (Choices::None, choices) | (choices, Choices::None) => choices,
            (Choices::One(first), Choices::One(second)) => Choices::Two([first, second]),
            _ => Choices::Many,
        }
    }
}

/// The possible outcomes of a comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ternary {
    /// True if the comparison may hold.
    pub yes: bool,
    /// True if the comparison may fail.
    pub no: bool,
    /// Functions that are at most 0 where the comparison is true and where it is false, if known.
    pub(super) gaps: [Option<LinearEnclosure>; 2],
}

impl Ternary {
    /// Returns the outcome of the comparison `a ≤ b`, given whether it may be true and whether it may be false.
    pub(super) fn of([yes, no]: [bool; 2], a: &Enclosure, b: &Enclosure) -> Ternary {
        let gap = || {
            let slope = [0, 1, 2].map(|k| a.linear.slope[k].plus(b.linear.slope[k].negated()));
            LinearEnclosure { at: a.linear.at.plus(b.linear.at.negated()), slope }
        };
        let gap = (yes && no).then(gap);
        Ternary { yes, no, gaps: [gap, gap.map(LinearEnclosure::negated)] }
    }
}

impl BitAnd for Ternary {
    type Output = Ternary;
    fn bitand(self, other: Ternary) -> Ternary {
        let yes = self.gaps[0].or(other.gaps[0]);
        // If both may fail, it is not known which one does.
        let no = match (self.no, other.no) {
            (true, true) => None,
            (_, true) => other.gaps[1],
            _ => self.gaps[1],
        };
        Ternary { yes: self.yes && other.yes, no: self.no || other.no, gaps: [yes, no] }
    }
}

impl BitOr for Ternary {
    type Output = Ternary;
    fn bitor(self, other: Ternary) -> Ternary {
        !(!self & !other)
    }
}

impl Not for Ternary {
    type Output = Ternary;
    fn not(self) -> Ternary {
        let [yes, no] = self.gaps;
        Ternary { yes: self.no, no: self.yes, gaps: [no, yes] }
    }
}
