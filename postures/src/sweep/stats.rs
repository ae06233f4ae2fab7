//! Counters of a sweep: the number of postures, by the rule that decided them.

use std::ops::AddAssign;

/// Number of postures by the rule that decided them. A posture is a triangle, a tool and a direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct SweepStats {
    /// Pairs of a tool and a triangle, or a piece of one, that were processed.
    pub triangles: u64,
    /// Postures in which no cutting surface faces the triangle: the tool would be on its other side, or would
    /// touch it with a surface that does not cut.
    pub not_facing: u64,
    /// Postures whose contact is not nice enough.
    pub below_niceness: u64,
    /// Postures obstructed by a point of the part that was in the way of a neighbouring posture in the same
    /// direction.
    pub cached_obstruction: u64,
    /// Postures for which a search of the part's tree found an obstruction.
    pub obstructed: u64,
    /// Postures so close to a limit that rounding decides; they count as not acceptable.
    pub undecided: u64,
    /// Postures that are proved acceptable.
    pub acceptable: u64,
}

/// The rule that decided a posture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PostureDecision {
    BelowNiceness,
    CachedObstruction,
    Obstructed,
    Undecided,
    Acceptable,
}

impl SweepStats {
    pub(super) fn count_of(&mut self, decision: PostureDecision) -> &mut u64 {
        match decision {
            PostureDecision::BelowNiceness => &mut self.below_niceness,
            PostureDecision::CachedObstruction => &mut self.cached_obstruction,
            PostureDecision::Obstructed => &mut self.obstructed,
            PostureDecision::Undecided => &mut self.undecided,
            PostureDecision::Acceptable => &mut self.acceptable,
        }
    }

    /// Returns the number of all postures.
    pub fn postures(&self) -> u64 {
        self.not_facing + self.below_niceness + self.searched() + self.cached_obstruction
    }

    /// Returns the number of postures for which the part's tree was searched.
    pub fn searched(&self) -> u64 {
        self.obstructed + self.undecided + self.acceptable
    }
}

impl AddAssign for SweepStats {
    fn add_assign(&mut self, other: SweepStats) {
        self.triangles += other.triangles;
        self.not_facing += other.not_facing;
        self.below_niceness += other.below_niceness;
        self.cached_obstruction += other.cached_obstruction;
        self.obstructed += other.obstructed;
        self.undecided += other.undecided;
        self.acceptable += other.acceptable;
    }
}
