//! How many postures a sweep looked at, and which rule decided them.

use std::ops::AddAssign;

/// How many postures were decided, by the rule that did it. A posture is a triangle, a tool and a direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Triangles beside tools that are done.
    pub triangles: u64,
    /// No surface that cuts faces the triangle: the tool would be on its other side, or touches it with
    /// what does not cut.
    pub facing: u64,
    /// The contact is not nice enough.
    pub plain: u64,
    /// A place of the part that was in the way of a posture beside, of the same direction, is in the way of
    /// this one.
    pub known: u64,
    /// The part's tree was searched, and something is in the way.
    pub found: u64,
    /// What is closest is so near to what is allowed that rounding decides: taken as not acceptable.
    pub undecided: u64,
    /// Proved acceptable.
    pub acceptable: u64,
}

/// What decided a posture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Decided {
    Plain,
    Known,
    Found,
    Undecided,
    Acceptable,
}

impl Tally {
    pub(super) fn of(&mut self, decided: Decided) -> &mut u64 {
        match decided {
            Decided::Plain => &mut self.plain,
            Decided::Known => &mut self.known,
            Decided::Found => &mut self.found,
            Decided::Undecided => &mut self.undecided,
            Decided::Acceptable => &mut self.acceptable,
        }
    }

    /// All postures.
    pub fn postures(&self) -> u64 {
        self.facing + self.plain + self.searched() + self.known
    }

    /// Those that the part's tree was searched for.
    pub fn searched(&self) -> u64 {
        self.found + self.undecided + self.acceptable
    }
}

impl AddAssign for Tally {
    fn add_assign(&mut self, other: Tally) {
        self.triangles += other.triangles;
        self.facing += other.facing;
        self.plain += other.plain;
        self.known += other.known;
        self.found += other.found;
        self.undecided += other.undecided;
        self.acceptable += other.acceptable;
    }
}
