//! A tool that is known by its depth alone, which is not a distance, and by how fast that changes.
//!
//! Depth changes by no more than `L` times the way, and so bounds what is near a place. A triangle is halved,
//! longest side first, until nothing of it can be deeper than what was found.

use super::body::Found;
use super::course::Search;
use super::section::Depth;
use crate::tool::{Ask, Felt, LANES, Points, Tool};
use fearless_simd::Level;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

type Point = [f64; 3];

/// What is known of such a tool.
pub(super) struct Field<'a> {
    tool: &'a dyn Tool,
    /// `L`, at least 1.
    pub(super) steep: f64,
    /// How far a depth is known.
    pub(super) error: f64,
    pub(super) level: Level,
}

/// A part of a triangle, and how deep it is at most.
#[derive(Clone, Copy, Default)]
struct Piece {
    corners: [Point; 3],
    /// Which triangle it is of.
    index: u32,
    bound: f64,
}

/// What a search keeps from triangle to triangle.
#[derive(Default)]
pub(super) struct Scratch {
    /// The deepest on top.
    pieces: BinaryHeap<Piece>,
    points: Points,
    felt: Felt,
}

impl Ord for Piece {
    fn cmp(&self, other: &Piece) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Piece) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Piece {
    fn eq(&self, other: &Piece) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Piece {}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn middle(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|axis| f64::midpoint(a[axis], b[axis]))
}

fn square(a: Point) -> f64 {
    a[0] * a[0] + a[1] * a[1] + a[2] * a[2]
}

impl Scratch {
    /// Holds a triangle that is to be looked at.
    pub(super) fn hold(&mut self, corners: [Point; 3], index: u32, bound: f64) {
        self.pieces.push(Piece { corners, index, bound });
    }

    /// Lets go of all that is held.
    pub(super) fn clear(&mut self) {
        self.pieces.clear();
    }
}

impl Piece {
    /// Its corners, so that the longest side is from the first to the second.
    fn turned(self) -> [Point; 3] {
        let [a, b, c] = self.corners;
        let [ab, bc, ca] = [minus(b, a), minus(c, b), minus(a, c)].map(square);
        if ab >= bc && ab >= ca {
            [a, b, c]
        } else if bc >= ca {
            [b, c, a]
        } else {
            [c, a, b]
        }
    }

    /// A place of it, and how far it reaches from there.
    fn ball(&self) -> (Point, f64) {
        let [a, b, c] = self.turned();
        let half = middle(a, b);
        let mean = [0, 1, 2].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0);
        let [half, mean] = [half, mean].map(|centre| {
            let far = [a, b, c].map(|corner| square(minus(corner, centre)));
            (centre, far[0].max(far[1]).max(far[2]).sqrt())
        });
        if half.1 < mean.1 { half } else { mean }
    }
}

impl<'a> Field<'a> {
    /// The field of a tool, if it is known how fast its depth changes.
    pub(super) fn new(tool: &'a dyn Tool, level: Level) -> Option<Field<'a>> {
        let card = tool.card();
        let steep = card.depth.lipschitz?.max(1.0);
        let error = card.depth.rounding + 8.0 * f64::EPSILON * steep * card.size();
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
    pub(super) fn depth(&self, scratch: &mut Scratch, point: Point) -> Depth {
        scratch.points.clear();
        scratch.points.push(point);
        self.depths(scratch, 1)[0]
    }

    /// Looks at the pieces that are held, the deepest first: the deepest place that is deeper than the
    /// best, or outside, where the best is below 0, the nearest to the tool; then what is inside is at 0.
    pub(super) fn look(
        &self,
        search: &mut Search,
        scratch: &mut Scratch,
        outside: bool,
    ) -> Option<(Found, u32)> {
        let value = |depth: f64| match (outside, depth < 0.0) {
            (true, _) => depth.min(0.0),
            (false, true) => self.steep * depth,
            (false, false) => depth,
        };
        let mut best = None;
        loop {
            let mut some = [Piece::default(); LANES];
            let (mut reach, mut count) = ([0.0; LANES], 0);
            scratch.points.clear();
            while count < LANES
                && let Some(piece) = scratch.pieces.pop()
            {
                if piece.bound <= search.wanted() || search.enough() || !search.spend(piece.bound) {
                    scratch.pieces.clear();
                    break;
                }
                let (centre, far) = piece.ball();
                scratch.points.push(centre);
                (some[count], reach[count]) = (piece, far);
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
                    best = Some((Found { point, feature: depth.feature }, some[lane].index));
                }
            }
            for lane in 0..count {
                let piece = some[lane];
                let bound = depths[lane].value + self.steep * reach[lane] + self.error;
                let bound = piece.bound.min(bound);
                if bound <= search.wanted() {
                    continue;
                }
                let [a, b, c] = piece.turned();
                let half = middle(a, b);
                if reach[lane] < search.fine() || half == a || half == b {
                    search.leave(bound);
                    continue;
                }
                scratch.pieces.push(Piece { corners: [a, half, c], bound, ..piece });
                scratch.pieces.push(Piece { corners: [half, b, c], bound, ..piece });
            }
        }
        best
    }
}
