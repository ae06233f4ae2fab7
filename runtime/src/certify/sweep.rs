//! Whether a tool stays clear of a part on its way, proved by stretches of time.
//!
//! A stretch keeps a list of what may be in the way: nodes and triangles. Bounds hold for all of it, by how
//! far the part goes in the tool's frame and in which direction. What they rule out is gone; what they leave
//! goes on to both halves. Nodes are opened when they are larger than the way is long.

use super::course::Search;
use super::descent::{BoxBounds, Node, Shift, of_children, rings};
use super::facet::Facet;
use super::hull::Hull;
use super::owners::Owners;
use super::question::Question;
use super::swath::Swath;
use super::work::{Best, Setting};
use crate::motion::Motion;
use crate::tool::LANES;
use crate::tree::{Boxes, View, WIDTH};
use fearless_simd::{Simd, f32x16};
use nalgebra::{Matrix3, Vector3};

type Point = [f64; 3];

/// A part of a motion, in the tool's frame and unit.
pub(super) struct Stretch {
    from: f64,
    to: f64,
    start: Vector3<f64>,
    /// At both ends and, between these, in the middle: how far the tip has come, and the way from the part's
    /// frame and unit to the tool's.
    views: [(Vector3<f64>, Matrix3<f64>); 3],
    /// How far a place goes from where it is in the middle, and how far its way is from straight, at most.
    pace: Pace,
}

#[derive(Clone, Copy)]
struct Pace {
    straight: [f64; 3],
    length: f64,
    turn: f64,
    reach: f64,
    curve: f64,
}

impl Stretch {
    /// What comes no nearer to the tool than `keep` does not matter.
    fn new(setting: &Setting<'_>, motion: &Motion, [from, to]: [f64; 2], keep: f64) -> Stretch {
        let per_length = 1.0 / setting.length;
        let views = [from, from / 2.0 + to / 2.0, to].map(|part| {
            let back = motion.pose(part).rotation().transpose() * per_length;
            (motion.way() * part, back)
        });
        let half = 0.5 * (to - from);
        let straight = views[1].1 * motion.way() * half;
        let (length, turn) = (straight.norm(), motion.angle() * half);
        // A place that comes that near is never farther on this stretch. Of a quarter of a circle no place
        // is farther from the tip than √2 of its ends.
        let reach = 1.5 * setting.section.size + keep + 2.0 * length;
        let curve = turn * (length + 0.5 * turn * reach);
        Stretch {
            from,
            to,
            start: motion.pose(0.0).tip().coords,
            views,
            pace: Pace { straight: straight.abs().into(), length, turn, reach, curve },
        }
    }

    /// A corner of the part at the beginning, in the middle and at the end.
    pub(super) fn seen(&self, corner: &Point) -> [Point; 3] {
        let from_start = Vector3::from(*corner) - self.start;
        self.views.map(|(way, back)| (back * (from_start - way)).into())
    }

    fn middle(&self) -> f64 {
        self.from / 2.0 + self.to / 2.0
    }

    /// How far a place goes from the middle, that is no farther from what the axis turns about.
    fn goes(&self, reach: f64) -> f64 {
        let Pace { length, turn, curve, .. } = self.pace;
        length + turn * reach.min(self.pace.reach) + curve
    }

    fn shift(&self, keep: f64) -> Shift {
        let Pace { straight, turn, reach, curve, .. } = self.pace;
        let up = |value: f64| (value * (1.0 + 1e-6)) as f32;
        Shift {
            straight: straight.map(|part| up(part + curve + keep)),
            turn: up(turn),
            reach: up(reach),
        }
    }
}

/// A hull past which boxes move.
struct Moving<'a> {
    hull: &'a Hull<f32>,
    shift: Shift,
}

impl BoxBounds for Moving<'_> {
    #[inline(always)]
    fn of_boxes<S: Simd>(&self, simd: S, boxes: &Boxes, view: &View) -> f32x16<S> {
        self.hull.of_rings(simd, &rings(simd, boxes, view, Some(&self.shift)))
    }
}

/// How a sweep ends before all of it is proved.
pub(super) enum Stop {
    /// Something is deeper than is allowed at this part of the way.
    Deeper { at: f64, best: Best },
    /// The budget was spent there.
    Spent { at: f64 },
}

impl Stop {
    /// Whether it says something worse: what is too deep, or what comes first.
    pub(super) fn before(&self, other: &Stop) -> bool {
        match (self, other) {
            (Stop::Deeper { .. }, Stop::Spent { .. }) => true,
            (Stop::Spent { .. }, Stop::Deeper { .. }) => false,
            (Stop::Deeper { at, .. }, Stop::Deeper { at: other, .. })
            | (Stop::Spent { at }, Stop::Spent { at: other }) => at < other,
        }
    }
}

/// What a sweep is about.
pub(super) struct Task<'a> {
    pub(super) setting: &'a Setting<'a>,
    pub(super) question: &'a Question,
    pub(super) motion: &'a Motion,
    /// How much deeper than its limit is not worth telling.
    pub(super) tolerance: f64,
}

impl Task<'_> {
    /// What is no deeper need not be looked at.
    fn wanted(&self) -> f64 {
        self.question.limit + self.tolerance
    }

    /// The same of what has grown by as much as is to be kept.
    fn above(&self) -> f64 {
        self.wanted() + self.keep() - self.setting.error
    }

    /// How far the owners have to keep.
    fn keep(&self) -> f64 {
        (-self.question.limit).max(0.0)
    }

    /// How deep a place is, or how near, as depth less than 0.
    fn depth(&self, point: Point) -> Found {
        let [x, y, z] = point;
        let (section, owners) = (&self.setting.section, &self.question.owners);
        let place = [(x * x + y * y).sqrt(), z];
        let inside = if self.question.limit < 0.0 {
            Some(section.distance(owners, place))
        } else {
            section.depth_at(owners, place).filter(|depth| depth.value >= 0.0)
        };
        let depth = inside.unwrap_or_else(|| section.distance(&Owners::default(), place));
        Found { point, depth: depth.value, feature: depth.feature, skew: 0.0 }
    }

    /// Whether a place is deeper than is allowed, whatever was rounded.
    fn too_deep(&self, found: &Found) -> bool {
        found.depth > self.question.limit + 2.0 * self.setting.error + found.skew
    }
}

/// A place in the tool's frame, and how deep it is.
#[derive(Clone, Copy)]
struct Found {
    point: Point,
    depth: f64,
    feature: usize,
    skew: f64,
}

impl Found {
    fn best(&self, index: u32) -> Best {
        Best { point: self.point, feature: self.feature, index }
    }
}

/// The search for what is in the way.
#[derive(Default)]
pub(super) struct Sweeper {
    view: View,
    /// What may be in the way, of all stretches that are being looked at.
    left: Vec<Node>,
    stack: Vec<Node>,
    swath: Swath,
    search: Search,
    owners: Owners,
    budget: u32,
}

impl Sweeper {
    /// Looks at a whole motion; `None` if nothing is deeper on the way.
    pub(super) fn run(&mut self, task: &Task<'_>, budget: u32) -> Option<Stop> {
        self.left.clear();
        self.left.push(Node { level: 0, index: 0, bound: f32::INFINITY });
        self.budget = budget;
        self.owners.clone_from(&task.question.owners);
        self.stretch(task, [0.0, 1.0], 0)
    }

    /// Looks at a stretch, of which that is left from that place of the list on.
    fn stretch(&mut self, task: &Task<'_>, [from, to]: [f64; 2], first: usize) -> Option<Stop> {
        let stretch = Stretch::new(task.setting, task.motion, [from, to], task.keep());
        let last = self.left.len();
        if let Some(stop) = self.look(task, &stretch, first..last) {
            return Some(stop);
        }
        if self.left.len() == last {
            return None;
        }
        let middle = stretch.middle();
        if middle <= from || middle >= to {
            return Some(Stop::Spent { at: from });
        }
        for half in [[from, middle], [middle, to]] {
            if let Some(stop) = self.stretch(task, half, last) {
                return Some(stop);
            }
        }
        self.left.truncate(last);
        None
    }

    /// Adds to the list what of a part of it is left.
    fn look(
        &mut self,
        task: &Task<'_>,
        stretch: &Stretch,
        list: std::ops::Range<usize>,
    ) -> Option<Stop> {
        let Task { setting, question, motion, .. } = *task;
        let facets = setting.facets;
        setting.sight.look(&facets.frame, &motion.pose(stretch.middle()), &mut self.view);
        let moving = Moving { hull: &question.hull, shift: stretch.shift(task.keep()) };
        let margin = setting.margin() + stretch.goes(f64::INFINITY) / f64::from(1 << 20);
        let wanted = (task.above() - margin) as f32;
        let small = f64::from(PART) * stretch.goes(f64::INFINITY);
        self.stack.clear();
        for at in list {
            self.stack.push(self.left[at]);
            while let Some(node) = self.stack.pop() {
                let spent = self.budget == 0;
                self.budget = self.budget.saturating_sub(1);
                if spent {
                    return Some(Stop::Spent { at: stretch.from });
                }
                if node.is_triangle(facets) {
                    let mut some = [node.index; LANES];
                    let mut count = 1;
                    while count < LANES
                        && let Some(next) = self.stack.pop_if(|node| node.is_triangle(facets))
                    {
                        some[count] = next.index;
                        count += 1;
                    }
                    if let Some(stop) = self.triangles(task, stretch, &some[..count]) {
                        return Some(stop);
                    }
                } else if node.size(facets) * setting.sight.unit < small {
                    self.left.push(node);
                } else {
                    let mut bounds = [node.bound; WIDTH];
                    let hits = if node.is_leaf(facets) || !(margin <= MARGIN) {
                        u32::MAX
                    } else {
                        let seen = (facets, &moving, &self.view);
                        of_children(setting.level, seen, node, wanted, &mut bounds)
                    };
                    self.stack.extend(node.children(facets, hits));
                }
            }
        }
        None
    }

    /// Adds to the list which of some triangles are left.
    fn triangles(&mut self, task: &Task<'_>, stretch: &Stretch, some: &[u32]) -> Option<Stop> {
        let Task { setting, question, .. } = *task;
        let grow = stretch.pace.curve + task.keep();
        let level = task.setting.level;
        self.swath.begin(setting.facets, stretch, some);
        let above = task.above();
        self.swath.bound(level, &question.exact, grow, above);
        if !self.swath.bounds[..some.len()].iter().any(|bound| !(*bound <= above)) {
            return None;
        }
        self.swath.middle.bound(level, &question.exact, f64::NEG_INFINITY);
        for (lane, index) in some.iter().enumerate() {
            if self.swath.bounds[lane] <= above {
                continue;
            }
            let corners = self.swath.middle.corners(lane);
            let point = self.swath.middle.place(lane);
            let at = stretch.middle();
            let stop = |found: Found| Stop::Deeper { at, best: found.best(*index) };
            let here = task.depth(point);
            if task.too_deep(&here) {
                return Some(stop(here));
            }
            let about = |corner: &Point| corner[0].hypot(corner[2]);
            let goes = stretch.goes(corners.iter().map(about).fold(0.0, f64::max));
            let left = here.depth + goes > task.wanted() || {
                let found = self.nearest(task, corners, goes);
                if let Some(found) = found
                    && task.too_deep(&found)
                {
                    return Some(stop(found));
                }
                found.is_some() || self.search.open()
            };
            if left {
                self.left.push(Node::of_triangle(setting.facets, *index));
            }
        }
        None
    }

    /// A place of a triangle that is so deep, or so near, that after going so far it may be too deep.
    fn nearest(&mut self, task: &Task<'_>, corners: [Point; 3], goes: f64) -> Option<Found> {
        let facet = Facet::new(corners);
        let goes = goes + facet.skew + task.setting.error;
        let least = task.wanted() - goes;
        self.search.begin(least, task.setting.error, self.budget);
        let section = &task.setting.section;
        let everyone = Owners::default();
        self.owners.slack = 2.0 * goes;
        let mut best = None;
        for course in facet.courses() {
            let found = if task.question.limit < 0.0 {
                self.search.outside((section, &task.question.owners), &course)
            } else if least < 0.0 {
                self.search.outside((section, &everyone), &course)
            } else {
                self.search.inside((section, &self.owners), &course)
            };
            best = found.map(|found| course.point(found.t)).or(best);
        }
        self.budget = self.search.left();
        let found = task.depth(best?);
        Some(Found { skew: facet.skew, ..found })
    }
}

/// Nodes are opened that are larger than this part of the way.
const PART: f32 = 0.5;

/// With a larger margin `f32` tells nothing, and its squares are too large for it.
const MARGIN: f64 = 1e9;
