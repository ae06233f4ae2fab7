//! A tool that is known by its depth alone, which is not a distance, and by how fast that changes.
//!
//! Depth changes by no more than `L` times the way, and so bounds what is near a place. Closer bounds come
//! from its formula, enclosed over the box of a piece: its values, and by the mean value theorem its slopes
//! from the piece's middle. A triangle is halved, longest side first, until nothing of it can be deeper than
//! what was found.

use crate::certify::body::owners::Owners;
use crate::certify::body::section::Depth;
use crate::certify::space::Point;
use crate::certify::triangle::course::{Best, Search};
use crate::certify::triangle::piece::Piece;
use crate::tool::{Ask, Card, Felt, LANES, Points, Tool};
use fearless_simd::Level;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// What is known of such a tool.
pub(crate) struct Field<'a> {
    pub(super) tool: &'a dyn Tool,
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
    pub(super) points: Points,
    pub(super) felt: Felt,
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
        // With unit roundoff u halving rounds a middle by u of how far it is from the tip. A piece that matters and is `l`
        // long is no farther than √2 size + l; `l` is halved by two or three halvings, which makes 10 u of the part's extent
        // at most, and 1.5 u size for each of the halvings after. `rounding::place` has room for the first, since no meridian
        // is looked for here. 256 u size are 160 halvings: 120 end at a part in 2^40 of the tool, which is as near as depths are
        // told, and 10 u size are left for the middle and the reach of the last piece.
        let error = card.depth.rounding + 128.0 * f64::EPSILON * steep * card.size();
        Some(Field { tool, steep, error, level })
    }

    /// How deep places are; outside, the negative of how far they are from the tool at least.
    pub(super) fn depths(&self, scratch: &mut Scratch, count: usize) -> [Depth; LANES] {
        let Scratch { points, felt, .. } = scratch;
        let ask = Ask { depth: true, region: true, ..Ask::INSIDE };
        self.tool.evaluate(self.level, ask, points, 1.0, felt);
        let lists = points.lists();
        let mut depths = [Depth { value: f64::NAN, gradient: [0.0; 2], feature: 0 }; LANES];
        for (lane, depth) in depths.iter_mut().enumerate().take(count) {
            if felt.inside[0] >> lane & 1 == 1 {
                depth.value = felt.depth[lane];
                depth.feature = felt.region[lane] as usize;
            } else {
                let point = [0, 1, 2].map(|axis| lists[axis][lane]);
                depth.value = -self.tool.clearance(point);
            }
        }
        depths
    }

    /// Who the tool is.
    pub(crate) fn card(&self) -> &Card {
        self.tool.card()
    }

    /// How deep a place is.
    pub(crate) fn depth(&self, scratch: &mut Scratch, point: Point) -> Depth {
        scratch.points.clear();
        scratch.points.push(point);
        self.depths(scratch, 1)[0]
    }

    /// Looks at the pieces that are held, the deepest first: the deepest place that is deeper than the
    /// best, or outside, where the best is below 0, the nearest to the tool; then what is inside is at 0.
    pub(crate) fn look(
        &self,
        search: &mut Search,
        scratch: &mut Scratch,
        owners: &Owners,
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
            let mut centres = [[0.0; 3]; LANES];
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
                (some[count], centres[count], reach[count]) = (held, centre, far);
                count += 1;
            }
            if count == 0 {
                break;
            }
            let mut depths = self.depths(scratch, count);
            for (lane, depth) in depths.iter_mut().enumerate().take(count) {
                depth.value = value(depth.value);
                let point = centres[lane];
                if depth.value > search.best
                    && let Some(depth) = self.owned(scratch, owners, point, *depth)
                    && search.take(&depth)
                {
                    let (feature, index) = (depth.feature, some[lane].index);
                    best = Some(Best { point, feature, index });
                }
            }
            for lane in 0..count {
                let held = some[lane];
                let bound = depths[lane].value + self.steep * reach[lane] + self.error;
                let mut bound = held.bound.min(bound);
                if bound > search.wanted() && !outside {
                    let closer = self.at_most(scratch, owners, &held.piece, centres[lane]);
                    bound = bound.min(closer);
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
