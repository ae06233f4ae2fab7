//! Borders in a box with several owners: the continuity of depth from one to another.

use super::super::borders::{Joint, Separation};
use super::super::cover::{Claim, half_diagonal};
use super::super::slope::{Slope, angle, fall_rate_across, shortest_combination};
use super::super::{Border, JumpPoint, OpenProof, Pair, SMALL_BOX_FRACTION, TOLERANCE};
use super::{BoxSize, MAX_SLOPE_UNCERTAINTY, STEEP_SLOPE, Survey, sum_rounded_up};
use crate::diagnostic::Statement;
use crate::domain::Domain;
use crate::expr::Id;
use crate::expr::interval::{Cell, Interval, ZERO as NOTHING};
use crate::formula::CurveIndex;
use crate::model::Region;

/// The accuracy of turns of the direction on the surface, in radians, unless boxes are as small as points. It
/// only decides whether a box is divided; the certificate has the angle of the enclosure.
const TURN_ACCURACY: f64 = 1e-5;

/// Two claims to a box that a curve separates.
struct Meeting {
    pair: Pair,
    separation: Separation,
    /// A point where both were found side by side with a jump between.
    jump_point: Option<JumpPoint>,
}

/// Returns the groups of regions that pairs join, directly or through others. Between two groups each depth is the
/// smaller on its own side, so that a descent by the slopes of one group leads down in the other, too.
fn connected(pairs: &[[usize; 2]]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for pair in pairs {
        let (joined, mut rest): (Vec<_>, Vec<_>) =
            groups.into_iter().partition(|group| pair.iter().any(|owner| group.contains(owner)));
        let mut group: Vec<usize> = joined.into_iter().flatten().chain(*pair).collect();
        group.sort_unstable();
        group.dedup();
        rest.push(group);
        groups = rest;
    }
    groups
}

impl Survey<'_> {
    /// Returns whether enough is known about the borders between the owners of the current box.
    pub(super) fn examine_borders(
        &mut self,
        cell: Cell,
        claims: &[Claim],
        box_size: BoxSize,
    ) -> bool {
        let mut meetings = self.meetings(cell, claims);
        let is_small = half_diagonal(&cell) <= SMALL_BOX_FRACTION * self.size;
        let (mut min_fall, mut any_vague) = (f64::INFINITY, false);
        // The pairs of regions that do not lead down each by its own slope.
        let mut falling_across = Vec::new();
        for meeting in &mut meetings {
            let depths_differ =
                meeting.separation.joint == Joint::None && self.jump(meeting.pair).low > 0.0;
            let key = (meeting.pair, meeting.separation.curve);
            // Points differ by no more than the enclosure allows. Half the tolerance leaves room for rounding.
            let may_be_found = self.jump(meeting.pair).high > TOLERANCE / 2.0 * self.size;
            if depths_differ
                && may_be_found
                && (is_small || box_size.is_last())
                && !self.jump_points.contains_key(&key)
            {
                // Only in small boxes: there a few test points suffice, and a jump is not that of a larger box's
                // corner.
                let jump_point = self.witness.find_jump(meeting.pair, cell);
                self.jump_points.extend(jump_point.map(|jump_point| (key, jump_point)));
            }
            meeting.jump_point =
                if depths_differ { self.jump_points.get(&key).copied() } else { None };
            if meeting.separation.joint == Joint::None
                && meeting.jump_point.is_none()
                && !box_size.is_last()
            {
                return false;
            }
            // In a point box other regions may lie between the two.
            if box_size != BoxSize::Point {
                if meeting.separation.joint == Joint::Zero && !self.meet_on_surface(meeting, cell) {
                    // Inside, a depth of 0 is as deep as any distance from the surface.
                    if !box_size.is_last() {
                        return false;
                    }
                    min_fall = 0.0;
                }
                let (fall, slack) = self.fall_across(meeting);
                // A smaller box may show that both sides lead down.
                any_vague |= fall < STEEP_SLOPE && slack > MAX_SLOPE_UNCERTAINTY;
                min_fall = min_fall.min(fall);
                if let (Pair { own, other: Some(other) }, true) = (meeting.pair, fall.is_finite()) {
                    falling_across.push([own, other]);
                }
            }
        }
        for group in connected(&falling_across).into_iter().filter(|group| group.len() > 2) {
            let depths = group.iter().map(|owner| self.tool.model.regions[*owner].depth);
            let slopes: Vec<Slope> = depths.map(|depth| self.slopes.get(depth)).collect();
            let (fall, slack) = shortest_combination(&slopes);
            // In the half plane smaller boxes lead down to points, at which descents are tried.
            let is_plane = self.tool.model.domain == Domain::HalfPlane;
            if is_plane && fall < min_fall.min(STEEP_SLOPE) && !box_size.is_last() {
                return false;
            }
            any_vague |= fall < STEEP_SLOPE && slack > MAX_SLOPE_UNCERTAINTY;
            min_fall = min_fall.min(fall);
        }
        // Small boxes resolve the turn of directions on the surface.
        let is_plane = self.tool.model.domain == Domain::HalfPlane;
        if is_plane && !box_size.is_last() {
            let any_vague =
                meetings.iter().any(|meeting| self.turns_vaguely_on_surface(meeting.pair));
            if any_vague {
                return false;
            }
        }
        // A slope this small may be an artefact of a large box.
        if (any_vague || min_fall < STEEP_SLOPE && !is_small) && !box_size.is_last() {
            return false;
        }
        self.min_slope = self.min_slope.min(min_fall);
        self.record_jumps(&meetings);
        for meeting in &meetings {
            self.record_border(meeting, cell, box_size == BoxSize::Point);
        }
        true
    }

    /// Returns the pairs of claims that meet in the current box.
    fn meetings(&mut self, cell: Cell, claims: &[Claim]) -> Vec<Meeting> {
        let mut meetings = Vec::new();
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
                let pair = Pair { own, other: b.owner };
                let depths_differ = self.jump(pair).low > 0.0;
                let Some(prover) = &mut self.border_prover else { continue };
                let cover = &mut self.cover;
                let separation = prover.separation(pair, [a, b], cover, cell, depths_differ);
                if let Some(separation) = separation {
                    meetings.push(Meeting { pair, separation, jump_point: None });
                }
            }
        }
        meetings
    }

    /// Records the jumps of depth between claims that no curve joins and on borders that are nearly smooth.
    fn record_jumps(&mut self, meetings: &[Meeting]) {
        let mut largest_jump = 0.0f64;
        for meeting in meetings {
            if meeting.separation.joint == Joint::None && meeting.jump_point.is_none() {
                largest_jump = largest_jump.max(self.jump(meeting.pair).high);
            }
            let key = (meeting.pair, meeting.separation.curve);
            let known_jump = self.smooth_border_jumps.entry(key).or_insert(0.0);
            *known_jump = meeting.separation.difference.max(*known_jump);
        }
        self.jumps = sum_rounded_up(self.jumps, largest_jump);
    }

    /// Returns a lower bound of the rate at which depth falls toward one of the sides of a border, and its
    /// uncertainty.
    fn fall_across(&mut self, meeting: &Meeting) -> (f64, f64) {
        let regions = &self.tool.model.regions;
        let Pair { own, other: Some(other) } = meeting.pair else { return (f64::INFINITY, 0.0) };
        let slopes = [own, other].map(|owner| self.slopes.get(regions[owner].depth));
        match meeting.separation.joint {
            Joint::Kinked => {
                let curve = self.slopes.get(self.tool.model.curves[meeting.separation.curve].value);
                fall_rate_across(slopes, curve, meeting.separation.below)
            }
            // Each side leads down by its own slope, both slopes agree, or depth is 0.
            _ => (f64::INFINITY, 0.0),
        }
    }

    /// Returns whether the points at which two regions meet with a depth of 0 are proved to be on the surface.
    fn meet_on_surface(&mut self, meeting: &Meeting, cell: Cell) -> bool {
        let owners: Vec<usize> =
            [Some(meeting.pair.own), meeting.pair.other].into_iter().flatten().collect();
        let is_proved = self.are_zero_on_surface_only(&owners, cell);
        self.slopes.set(cell);
        is_proved
    }

    /// Returns the difference of two depths in the current box.
    pub(super) fn jump(&mut self, pair: Pair) -> Interval {
        self.difference(pair, |region| region.depth)
    }

    /// Returns the absolute difference of a quantity of two regions in the current box; it is 0 outside.
    fn difference(
        &mut self,
        Pair { own, other }: Pair,
        quantity: impl Fn(&Region) -> Id,
    ) -> Interval {
        let regions = &self.tool.model.regions;
        let mut value = |owner: usize| self.slopes.get(quantity(&regions[owner])).value;
        let (own, other) = (value(own), other.map_or(NOTHING, value));
        own.plus(other.negated()).abs()
    }

    /// Returns whether a region may reach the surface in the current box.
    fn is_on_surface(&mut self, pair: Pair) -> bool {
        self.slopes.get(self.tool.model.regions[pair.own].depth).value.low <= 0.0
    }

    /// Returns whether the direction turns on the surface in the current box by an angle that is not known well.
    pub(super) fn turns_vaguely_on_surface(&mut self, pair: Pair) -> bool {
        let angle = self.turn_angle(pair);
        angle.high - angle.low > TURN_ACCURACY && self.is_on_surface(pair)
    }

    /// Encloses the angle between the directions of two regions in the current box.
    fn turn_angle(&mut self, pair: Pair) -> Interval {
        let Pair { own, other: Some(other) } = pair else { return NOTHING };
        let regions = &self.tool.model.regions;
        let [a, b] =
            [own, other].map(|owner| regions[owner].direction.map(|id| self.slopes.get(id).value));
        angle(a, b)
    }

    fn record_border(&mut self, meeting: &Meeting, cell: Cell, is_point: bool) {
        let Pair { own, other } = meeting.pair;
        let jump = match meeting.separation.joint {
            // At a point, the other depths there are no part of the border. The slack has the difference.
            Joint::None if meeting.separation.ends_here && is_point => NOTHING,
            Joint::None => self.jump(meeting.pair),
            _ => Interval { low: 0.0, high: meeting.separation.difference },
        };
        // In a box that is not divided further, a jump that may be 0 is one at a corner.
        if meeting.separation.joint == Joint::None
            && meeting.jump_point.is_none()
            && jump.high > TOLERANCE * self.size
        {
            let [from, to] = [Some(own), other].map(|owner| self.region_name(owner));
            let statement = Statement::ContinuousDepth(from, to);
            self.undecided.push(OpenProof { cell, statement });
        }
        let key = (meeting.pair, meeting.separation.curve);
        self.add_border(key, jump, meeting.jump_point);
    }

    /// Adds what the current box says about a border on which depths differ by `jump`.
    pub(super) fn add_border(
        &mut self,
        key: (Pair, CurveIndex),
        jump: Interval,
        jump_point: Option<JumpPoint>,
    ) {
        let regions = &self.tool.model.regions;
        let (pair @ Pair { own, other }, _) = key;
        let depth = self.slopes.get(regions[own].depth);
        let turn_angle = self.turn_angle(pair);
        // Where magnitude is depth, the two differ as exactly as depths do; enclosures would show a difference.
        let mut sides = [Some(own), other].into_iter().flatten();
        let magnitude_jump = if sides.all(|side| regions[side].magnitude == regions[side].depth) {
            jump
        } else {
            self.difference(pair, |region| region.magnitude)
        };
        let border = Border {
            sides: pair,
            depth_jump: jump,
            magnitude_jump,
            direction_angle: turn_angle,
            direction_angle_on_surface: self.is_on_surface(pair).then_some(turn_angle),
            jump_point,
            depth: Interval { low: depth.value.low.max(0.0), ..depth.value },
        };
        self.borders.entry(key).and_modify(|known| known.merge(&border)).or_insert(border);
    }
}
