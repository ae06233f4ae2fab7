//! Tests that are not decided, and what was chosen by them.

use super::Enclosure;
use super::interval::Interval;
use std::ops::{BitAnd, BitOr, Not};

/// A function over a box: at one of its points, and how it changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Course {
    pub(super) at: Interval,
    pub(super) slope: [Interval; 3],
}

impl Course {
    pub(super) fn negated(self) -> Course {
        Course { at: self.at.negated(), slope: self.slope.map(Interval::negated) }
    }

    /// Its values at a point between ends from the known one.
    pub(super) fn values(&self, way: [[f64; 2]; 3]) -> Interval {
        let parts = (0..3).map(|k| {
            let [low, high] = way[k];
            self.slope[k].times(Interval { low, high })
        });
        parts.fold(self.at, Interval::plus)
    }
}

/// What a function may be, where another is not more than 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Choice {
    pub(super) value: Course,
    pub(super) gap: Course,
}

/// What a choice was between.
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
            (Choices::None, all) | (all, Choices::None) => all,
            (Choices::One(one), Choices::One(other)) => Choices::Two([one, other]),
            _ => Choices::Many,
        }
    }
}

/// A test's outcomes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Maybe {
    /// Whether it may succeed.
    pub yes: bool,
    /// Whether it may fail.
    pub no: bool,
    /// Not more than 0 where it succeeds, and where it fails, if that is known.
    pub(super) gaps: [Option<Course>; 2],
}

impl Maybe {
    /// Whether one is no more than another, which may be so and may not.
    pub(super) fn of([yes, no]: [bool; 2], less: &Enclosure, more: &Enclosure) -> Maybe {
        let gap = || {
            let slope =
                [0, 1, 2].map(|k| less.course.slope[k].plus(more.course.slope[k].negated()));
            Course { at: less.course.at.plus(more.course.at.negated()), slope }
        };
        let gap = (yes && no).then(gap);
        Maybe { yes, no, gaps: [gap, gap.map(Course::negated)] }
    }
}

impl BitAnd for Maybe {
    type Output = Maybe;
    fn bitand(self, other: Maybe) -> Maybe {
        let yes = self.gaps[0].or(other.gaps[0]);
        // Of two that may fail it is not known which does.
        let no = match (self.no, other.no) {
            (true, true) => None,
            (_, true) => other.gaps[1],
            _ => self.gaps[1],
        };
        Maybe { yes: self.yes && other.yes, no: self.no || other.no, gaps: [yes, no] }
    }
}

impl BitOr for Maybe {
    type Output = Maybe;
    fn bitor(self, other: Maybe) -> Maybe {
        !(!self & !other)
    }
}

impl Not for Maybe {
    type Output = Maybe;
    fn not(self) -> Maybe {
        let [yes, no] = self.gaps;
        Maybe { yes: self.no, no: self.yes, gaps: [no, yes] }
    }
}
