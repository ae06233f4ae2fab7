//! Chains: neighbouring slabs whose sides are short lines of a convex curve, as drawings have them for arcs. Bounds that need
//! not be tight take a chain as one slab.

use crate::certify::space::MeridianPoint;
use crate::certify::tool_model::quarter::MAX_BALL;
use crate::certify::tool_model::section::Section;
use std::ops::Range;
use touchoff_plane::{Segment, cross, dot, minus, norm};

/// Neighbouring slabs.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    /// Their indices in the section's list.
    pub(crate) slabs: Range<usize>,
    /// If there are several, the line that touches their sides from outside, parallel to the chord of them. No point of them is
    /// deeper than its distance under it.
    pub(crate) line: Option<Segment>,
    /// The height of the centre and the radius of a ball about a point of the axis that contains the chain and all slabs below it. It
    /// bounds their depth: the way from a point to its foot on the ball leads downward, out of the tool.
    pub(crate) ball: Option<[f64; 2]>,
}

/// The lowest slabs of a tool in a ball.
struct TipBall {
    slab_count: usize,
    ball: [f64; 2],
}

/// The least number of lines that are taken together.
const MIN_LINES: usize = 3;

/// The sine of the largest angle by which the sides of a chain turn. Beyond that the lines bound depth much better.
const MAX_TURN_SINE: f64 = 0.125;
/// The largest distance of an end of a chain from its line, as a fraction of the tool's size, for the same reason.
const MAX_GAP: f64 = 1.0 / 1024.0;

/// The largest distance of the lines from the ball about the tip, as a fraction of its radius.
const MAX_DEVIATION: f64 = 1.0 / 256.0;

impl Section {
    /// Returns all slabs as chains, in upward order.
    pub(super) fn chains(&self) -> Vec<Chain> {
        // A chain belongs to the ball as a whole or not at all.
        let tip = self.tip_ball();
        let tip_end = tip.as_ref().map(|tip| tip.slab_count);
        let mut chains = Vec::new();
        let mut next = 0;
        while next < self.slabs.len() {
            let first = next;
            next += 1;
            while next < self.slabs.len()
                && self.continues(next)
                && self.turn_sine(first, next) <= MAX_TURN_SINE
                && tip_end != Some(next)
            {
                next += 1;
            }
            let line = self.line_outside(first..next);
            let ball = tip.as_ref().filter(|tip| next <= tip.slab_count).map(|tip| tip.ball);
            if line.is_some() {
                chains.push(Chain { slabs: first..next, line, ball });
            } else {
                let single = |slab| Chain { slabs: slab..slab + 1, line: None, ball };
                chains.extend((first..next).map(single));
            }
        }
        chains
    }

    /// Returns whether the side of a slab continues that of the slab below it in a convex curve of lines.
    fn continues(&self, slab: usize) -> bool {
        let [below, above] = [&self.slabs[slab - 1], &self.slabs[slab]];
        let [first, second] = [below, above].map(|slab| self.side(slab));
        let has_hole = below.hole > 0.0 || above.hole > 0.0;
        !has_hole
            && below.high == above.low
            && first.segment.circle.is_none()
            && second.segment.circle.is_none()
            && first.segment.ends[1] == second.segment.ends[0]
            && cross(first.segment.along, second.segment.along) >= 0.0
            && dot(first.segment.along, second.segment.along) > 0.0
    }

    /// Returns the sine of the angle between the sides of two slabs.
    fn turn_sine(&self, first: usize, second: usize) -> f64 {
        let [first, second] =
            [first, second].map(|slab| self.side(&self.slabs[slab]).segment.along);
        cross(first, second)
    }

    /// Returns the ends of the sides of slabs that form a chain.
    fn vertices(&self, slabs: Range<usize>) -> impl Iterator<Item = MeridianPoint> {
        slabs.flat_map(|slab| self.side(&self.slabs[slab]).segment.ends)
    }

    /// Returns the line that touches the sides of several slabs, if it bounds their depth: all feet are outside the tool.
    fn line_outside(&self, slabs: Range<usize>) -> Option<Segment> {
        let (first, last) = (slabs.start, slabs.end - 1);
        if slabs.len() < MIN_LINES {
            return None;
        }
        let [from, to] = [first, last].map(|slab| *self.side(&self.slabs[slab]));
        let (start, end) = (from.segment.ends[0], to.segment.ends[1]);
        let chord = minus(end, start);
        let along = chord.map(|part| part / norm(chord));
        let outward = [along[1], -along[0]];
        let along_outward = |p: MeridianPoint| dot(outward, p);
        let touch = self
            .vertices(slabs.clone())
            .max_by(|one, other| along_outward(*one).total_cmp(&along_outward(*other)))?;
        // The ends of the chord are the farthest from the line.
        if along_outward(touch) - along_outward(start) > MAX_GAP * self.outline.size {
            return None;
        }
        let line = Segment::line_through(touch, along, from.segment.surface);
        let [low, _] = self.feet(&line, first);
        let [_, high] = self.feet(&line, last);
        let axis = [start[1], end[1]].map(|height| [0.0, height]);
        let is_outside = |p: MeridianPoint| (low..=high).contains(&line.position(p));
        // Positions along the line are linear, so the vertices of the chain are the extremes.
        self.vertices(slabs).chain(axis).all(is_outside).then_some(line)
    }

    /// Returns the ball about the most of the tool's lowest slabs whose sides are chords of it.
    fn tip_ball(&self) -> Option<TipBall> {
        let first = self.slabs.first()?;
        let side = self.side(first);
        let tip = side.segment.ends[0];
        if self.overhangs || tip != [0.0, first.low] || side.segment.circle.is_some() {
            return None;
        }
        let count = 1 + (1..self.slabs.len()).take_while(|slab| self.continues(*slab)).count();
        (MIN_LINES..=count).rev().find_map(|slab_count| {
            let [across, height] =
                minus(self.side(&self.slabs[slab_count - 1]).segment.ends[1], tip);
            // Above its centre the way to the foot would lead upward.
            let radius = 0.5 * (across * across + height * height) / height;
            let centre = tip[1] + radius;
            let distances = self.vertices(0..slab_count).map(|[d, z]| norm([d, z - centre]));
            let [least, greatest] = distances.fold([radius; 2], |[least, greatest], distance| {
                [least.min(distance), greatest.max(distance)]
            });
            let is_close = greatest - least <= MAX_DEVIATION * radius;
            let is_small = greatest.max(centre.abs()) <= MAX_BALL * self.outline.size;
            (height <= radius && is_close && is_small)
                .then_some(TipBall { slab_count, ball: [centre, greatest] })
        })
    }
}
