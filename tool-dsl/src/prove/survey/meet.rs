//! Borders in a box with several owners: the continuity of depth from one to another.

use super::super::borders::{Joint, Pair, Parted};
use super::super::cover::{Claim, reach};
use super::super::nonsmooth::{across, angle};
use super::super::{Border, JumpPoint, OpenProof, SMALL, TOLERANCE};
use super::{BoxSize, SLOPING, Survey, VAGUE, up};
use crate::diagnostic::Statement;
use crate::domain::Domain;
use crate::expr::Id;
use crate::expr::interval::{Cell, Interval, ZERO as NOTHING};

/// The accuracy of turns of the direction on the surface, in radians, unless boxes are as small as points. It
/// only decides whether a box is divided; the certificate has the angle of the enclosure.
const VAGUE_TURN: f64 = 1e-5;

/// Two claims to a box that a curve separates.
struct Met {
    pair: Pair,
    by: Parted,
    /// A point where both were found side by side with a jump between.
    seen: Option<JumpPoint>,
}

impl Survey<'_> {
    /// Returns whether enough is known about the borders between the owners of the current box.
    pub(super) fn meet(&mut self, cell: Cell, claims: &[Claim], grain: BoxSize) -> bool {
        let mut all = Vec::new();
        for (k, a) in claims.iter().enumerate() {
            for b in &claims[k + 1..] {
                // The region comes first; of two regions, the one listed earlier.
                let (a, b) = match (a.owner, b.owner) {
                    (x, y) if x == y => continue,
                    (None, _) => (b, a),
                    (Some(x), Some(y)) if y < x => (b, a),
                    _ => (a, b),
                };
                let Some(own) = a.owner else { continue };
                let pair = (own, b.owner);
                let apart = self.jump(pair).low > 0.0;
                let place = (&mut self.cover, cell);
                if let Some(by) = self.parting.of(pair, [a, b], place, apart) {
                    all.push(Met { pair, by, seen: None });
                }
            }
        }
        let small = reach(&cell) <= SMALL * self.size;
        let (mut least, mut vague) = (f64::INFINITY, false);
        for met in &mut all {
            let apart = met.by.joint == Joint::None && self.jump(met.pair).low > 0.0;
            let place = (met.pair, met.by.curve);
            if apart && (small || grain.is_last()) && !self.jumping.contains_key(&place) {
                let seen = self.witness.beside(met.pair, cell);
                self.jumping.extend(seen.map(|seen| (place, seen)));
            }
            met.seen = if apart { self.jumping.get(&place).copied() } else { None };
            if met.by.joint == Joint::None && met.seen.is_none() && !grain.is_last() {
                return false;
            }
            // In a point box other regions may lie between the two.
            if grain != BoxSize::Point && self.feet.is_none() {
                let (fall, slack) = self.across(met);
                vague |= fall < SLOPING && slack > VAGUE;
                least = least.min(fall);
            }
        }
        // Small boxes resolve the turn of directions on the surface.
        let is_plane = self.tool.model.domain == Domain::HalfPlane;
        if is_plane && !grain.is_last() {
            let is_vague = |met: &Met| {
                let turn = self.turn(met.pair);
                turn.high - turn.low > VAGUE_TURN && self.is_on_surface(met.pair)
            };
            if all.iter().any(is_vague) {
                return false;
            }
        }
        // A slope this small may be an artefact of a large box.
        if (vague || least < SLOPING && !small) && !grain.is_last() {
            return false;
        }
        self.least = self.least.min(least);
        let unjoined = all.iter().filter(|met| met.by.joint == Joint::None && met.seen.is_none());
        let pairs: Vec<Pair> = unjoined.map(|met| met.pair).collect();
        let mut most = 0.0f64;
        for pair in pairs {
            let jump = self.jump(pair).high;
            let widest = self.widest.entry(pair).or_insert(0.0);
            *widest = widest.max(jump);
            most = most.max(jump);
        }
        self.jumps = up(self.jumps, most);
        for met in &all {
            let off = self.steps.entry((met.pair, met.by.curve)).or_insert(0.0);
            *off = met.by.off.max(*off);
            self.note(met, cell);
        }
        true
    }

    /// Returns a lower bound of the rate at which depth falls toward one of the sides of a border, and its
    /// uncertainty.
    fn across(&mut self, met: &Met) -> (f64, f64) {
        let regions = &self.tool.model.regions;
        let (Joint::Kinked, (own, Some(other))) = (met.by.joint, met.pair) else {
            return (f64::INFINITY, 0.0);
        };
        let [own, other] = [own, other].map(|owner| self.slopes.get(regions[owner].depth));
        let curve = self.slopes.get(self.tool.model.curves[met.by.curve].value);
        across(own, other, curve, met.by.below)
    }

    /// Returns the difference of two depths in the current box.
    fn jump(&mut self, (own, other): Pair) -> Interval {
        let regions = &self.tool.model.regions;
        let own = self.slopes.get(regions[own].depth).value;
        let other = other.map_or(NOTHING, |other| self.slopes.get(regions[other].depth).value);
        own.plus(other.negated()).abs()
    }

    /// Returns whether a region may reach the surface in the current box.
    fn is_on_surface(&mut self, (own, _): Pair) -> bool {
        self.slopes.get(self.tool.model.regions[own].depth).value.low <= 0.0
    }

    /// Encloses the angle between the directions of two regions in the current box.
    fn turn(&mut self, (own, other): Pair) -> Interval {
        let Some(other) = other else { return NOTHING };
        let regions = &self.tool.model.regions;
        let [a, b] =
            [own, other].map(|owner| regions[owner].direction.map(|id| self.slopes.get(id).value));
        angle(a, b)
    }

    fn note(&mut self, met: &Met, cell: Cell) {
        let regions = &self.tool.model.regions;
        let (own, other) = met.pair;
        let jump = match met.by.joint {
            Joint::None => self.jump(met.pair),
            _ => Interval { low: 0.0, high: met.by.off },
        };
        let depth = self.slopes.get(regions[own].depth);
        let turn = self.turn(met.pair);
        // In a box that is not divided further, a jump that may be 0 is one at a corner.
        if met.by.joint == Joint::None && met.seen.is_none() && jump.high > TOLERANCE * self.size {
            let [from, to] = [Some(own), other].map(|owner| self.named(owner));
            let statement = Statement::Continues(from, to);
            self.undecided.push(OpenProof { cell, statement });
        }
        let magnitude = |owner: usize| (regions[owner].magnitude, regions[owner].depth);
        let [of_own, of_other] = [Some(own), other].map(|owner| owner.map(magnitude));
        let same = |of: Option<(Id, Id)>| of.is_none_or(|(magnitude, depth)| magnitude == depth);
        let evaluation = |survey: &mut Survey<'_>, of: Option<(Id, Id)>| {
            of.map_or(NOTHING, |(magnitude, _)| survey.slopes.get(magnitude).value)
        };
        let step = if same(of_own) && same(of_other) {
            jump
        } else {
            evaluation(self, of_own).plus(evaluation(self, of_other).negated()).abs()
        };
        let here = Border {
            between: met.pair,
            curve: met.by.curve,
            jump,
            step,
            turn,
            turn_on_surface: self.is_on_surface(met.pair).then_some(turn),
            seen: met.seen,
            depth: Interval { low: depth.value.low.max(0.0), ..depth.value },
        };
        self.borders
            .entry((met.pair, met.by.curve))
            .and_modify(|known| known.join(&here))
            .or_insert(here);
    }
}
