//! A tool that is known by its depth alone, which is not a distance, and by how fast that changes.
//!
//! Depth changes by no more than `L` times the way, and so bounds what is near a place. Closer bounds come
//! from its formula, enclosed over the box of a piece: its values, and by the mean value theorem its slopes
//! from the piece's middle. A triangle is halved, longest side first, until nothing of it can be deeper than
//! what was found.

use crate::certify::body::section::Depth;
use crate::certify::space::Point;
use crate::certify::triangle::course::{Best, Search};
use crate::certify::triangle::piece::Piece;
use crate::tool::{Ask, Enclosed, Felt, LANES, Points, Shape, Tool};
use fearless_simd::Level;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// What is known of such a tool.
pub(crate) struct Field<'a> {
    tool: &'a dyn Tool,
    /// `L`, at least 1.
    pub(crate) steep: f64,
    /// How far a depth is known.
    pub(crate) error: f64,
    pub(crate) level: Level,
}

/// A part of a triangle, and how deep it is at most.
#[derive(Clone, Copy, Default)]
struct Held {
    piece: Piece,
    /// Which triangle it is of.
    index: u32,
    bound: f64,
}

/// What a search keeps from triangle to triangle.
#[derive(Default)]
pub(crate) struct Scratch {
    /// The deepest on top.
    pieces: BinaryHeap<Held>,
    points: Points,
    felt: Felt,
}

impl Ord for Held {
    fn cmp(&self, other: &Held) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl PartialOrd for Held {
    fn partial_cmp(&self, other: &Held) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Held {
    fn eq(&self, other: &Held) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Held {}

impl Scratch {
    /// Holds a triangle that is to be looked at.
    pub(crate) fn hold(&mut self, corners: [Point; 3], index: u32) {
        let bound = f64::INFINITY;
        self.pieces.push(Held { piece: Piece::new(corners), index, bound });
    }

    /// Lets go of all that is held.
    pub(crate) fn clear(&mut self) {
        self.pieces.clear();
    }
}

impl<'a> Field<'a> {
    /// The field of a tool, if it is known how fast its depth changes.
    pub(crate) fn new(tool: &'a dyn Tool, level: Level) -> Option<Field<'a>> {
        let card = tool.card();
        let steep = card.depth.lipschitz?.max(1.0);
        // Halving rounds a place by half a unit of it, and no piece is halved more than some hundred times.
        let error = card.depth.rounding + 128.0 * f64::EPSILON * steep * card.size();
        Some(Field { tool, steep, error, level })
    }

    /// How deep places are; outside, the negative of how far they are from the tool at least.
    fn depths(&self, scratch: &mut Scratch, count: usize) -> [Depth; LANES] {
        let Scratch { points, felt, .. } = scratch;
        let ask = Ask { depth: true, region: true, ..Ask::INSIDE };
        self.tool.evaluate(self.level, ask, points, 1.0, felt);
        let lists = points.lists();
        let mut depths = [Depth { value: f64::NAN, gradient: [0.0; 2], feature: 0 }; LANES];
        for (lane, depth) in depths.iter_mut().enumerate().take(count) {
            if felt.inside[0] >> lane & 1 == 1 {
                depth.value = felt.depth[lane];
                let region = felt.region[lane] as usize;
                depth.feature = self.tool.card().regions[region].surface;
            } else {
                let point = [0, 1, 2].map(|axis| lists[axis][lane]);
                depth.value = -self.tool.clearance(point);
            }
        }
        depths
    }

    /// How deep a place is.
    pub(crate) fn depth(&self, scratch: &mut Scratch, point: Point) -> Depth {
        scratch.points.clear();
        scratch.points.push(point);
        self.depths(scratch, 1)[0]
    }

    /// No less than the depth of any place of a piece, given a place of it and how deep that is, or less than 0.
    fn at_most(&self, scratch: &mut Scratch, piece: &Piece, from: Point, depth: f64) -> f64 {
        let corners = piece.corners();
        let revolved = self.tool.card().shape == Shape::Revolved;
        let far = from[0].hypot(from[1]);
        // Away from the axis as seen from the place; no place is nearer to the axis than it is out that way.
        let out = if far > 0.0 { [from[0] / far, from[1] / far] } else { [1.0, 0.0] };
        let outward = |p: &Point| p[0] * out[0] + p[1] * out[1];
        let span = |of: &dyn Fn(&Point) -> f64| {
            let [a, b, c] = corners.each_ref().map(of);
            [a.min(b).min(c), a.max(b).max(c)]
        };
        let z = span(&|p| p[2]);
        let sides = if revolved {
            let most = span(&|p| p[0].hypot(p[1]))[1];
            [[span(&outward)[0].clamp(0.0, most), most], [0.0; 2], z]
        } else {
            [span(&|p| p[0]), span(&|p| p[1]), z]
        };
        let Some(Enclosed { inside, depth: [_, most], mut slope, .. }) =
            self.tool.enclose(sides, &mut scratch.felt)
        else {
            return f64::INFINITY;
        };
        if !inside.yes {
            return self.error;
        }
        // Outside depth goes on as 0.
        if inside.no {
            slope = slope.map(|[low, high]| [low.min(0.0), high.max(0.0)]);
        }
        let ways = corners.iter().map(|p| {
            let rise = p[2] - from[2];
            if revolved {
                // The distance from the axis is convex: it grows by no more than to the corner, and by no less
                // than outward.
                [[outward(p) - far, p[0].hypot(p[1]) - far], [0.0; 2], [rise; 2]]
            } else {
                [[p[0] - from[0]; 2], [p[1] - from[1]; 2], [rise; 2]]
            }
        });
        let grows = ways.map(|way| (0..3).map(|k| most_of(slope[k], way[k])).sum::<f64>());
        let mean = depth.max(0.0) + grows.fold(f64::NEG_INFINITY, f64::max);
        // A slope that is not known makes no number.
        most.min(mean) + self.error
    }

    /// Looks at the pieces that are held, the deepest first: the deepest place that is deeper than the
    /// best, or outside, where the best is below 0, the nearest to the tool; then what is inside is at 0.
    pub(crate) fn look(
        &self,
        search: &mut Search,
        scratch: &mut Scratch,
        outside: bool,
    ) -> Option<Best> {
        let value = |depth: f64| match (outside, depth < 0.0) {
            (true, _) => depth.min(0.0),
            (false, true) => self.steep * depth,
            (false, false) => depth,
        };
        let mut best = None;
        loop {
            let mut some = [Held::default(); LANES];
            let (mut reach, mut count) = ([0.0; LANES], 0);
            scratch.points.clear();
            while count < LANES
                && let Some(held) = scratch.pieces.pop()
            {
                if held.bound <= search.wanted() || search.enough() || !search.spend(held.bound) {
                    scratch.pieces.clear();
                    break;
                }
                let (centre, far) = held.piece.ball();
                scratch.points.push(centre);
                (some[count], reach[count]) = (held, far);
                count += 1;
            }
            if count == 0 {
                break;
            }
            let mut depths = self.depths(scratch, count);
            for (lane, depth) in depths.iter_mut().enumerate().take(count) {
                depth.value = value(depth.value);
                if search.take(depth) {
                    let lists = scratch.points.lists();
                    let point = [0, 1, 2].map(|axis| lists[axis][lane]);
                    let (feature, index) = (depth.feature, some[lane].index);
                    best = Some(Best { point, feature, index });
                }
            }
            for lane in 0..count {
                let held = some[lane];
                let bound = depths[lane].value + self.steep * reach[lane] + self.error;
                let mut bound = held.bound.min(bound);
                if bound > search.wanted() && !outside {
                    let lists = scratch.points.lists();
                    let centre = [0, 1, 2].map(|axis| lists[axis][lane]);
                    let depth = depths[lane].value;
                    bound = bound.min(self.at_most(scratch, &held.piece, centre, depth));
                }
                if bound <= search.wanted() {
                    continue;
                }
                let before = scratch.pieces.len();
                scratch.pieces.extend(held.piece.halves().map(|piece| Held {
                    piece,
                    bound,
                    ..held
                }));
                if scratch.pieces.len() == before {
                    search.leave(bound);
                }
            }
        }
        best
    }
}

/// The most that a slope between two ends grows on a way: a slope that falls by the first, one that rises by the
/// second.
fn most_of([low, high]: [f64; 2], [falls, rises]: [f64; 2]) -> f64 {
    let grows = |slope: f64| if slope < 0.0 { slope * falls } else { slope * rises };
    let most = grows(low).max(grows(high));
    if low < 0.0 && high > 0.0 { most.max(0.0) } else { most }
}
