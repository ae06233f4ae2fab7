//! Whether a tool stays clear of a part on its way, proved by stretches of time.
//!
//! A stretch keeps a list of what may be in the way: nodes and triangles. Bounds hold for all of it, by how
//! far the part goes in the tool's frame and in which direction. What they rule out is gone; what they leave
//! goes on to both halves. Nodes are opened when they are larger than the way is long.

mod moving;
pub(crate) mod stretch;
mod task;

use crate::bvh::{PoseTransform, WIDTH};
use crate::certify::body::Body;
use crate::certify::body::field::Scratch;
use crate::certify::body::owners::Owners;
use crate::certify::body::section::Section;
use crate::certify::bounds::descent::{Node, of_children};
use crate::certify::bounds::swath::Swath;
use crate::certify::space::Point;
use crate::certify::sweep::stretch::Stretch;
use crate::certify::triangle::course::{Best, Goal, Search};
use crate::certify::triangle::facet::Facet;
use crate::certify::triangle::piece::{Part, Piece};
use crate::certify::work::MARGIN;
use crate::tool::LANES;
use moving::{Moving, of_leaf};
use task::Place;
pub(crate) use task::Task;

/// How a sweep ends before all of it is proved.
pub(crate) enum Stop {
    /// Something is deeper than is allowed at this part of the way.
    Deeper { at: f64, best: Best },
    /// The budget was spent there.
    Spent { at: f64 },
}

impl Stop {
    /// Whether it says something worse: what is too deep, or what comes first.
    pub(crate) fn before(&self, other: &Stop) -> bool {
        match (self, other) {
            (Stop::Deeper { .. }, Stop::Spent { .. }) => true,
            (Stop::Spent { .. }, Stop::Deeper { .. }) => false,
            (Stop::Deeper { at, .. }, Stop::Deeper { at: other, .. })
            | (Stop::Spent { at }, Stop::Spent { at: other }) => at < other,
        }
    }
}

/// Something that may be in the way.
#[derive(Clone, Copy)]
enum Left {
    Node(Node),
    Part(Part),
}

/// The search for what is in the way.
#[derive(Default)]
pub(crate) struct Sweeper {
    view: PoseTransform,
    ends: [PoseTransform; 2],
    /// What may be in the way, of all stretches that are being looked at.
    left: Vec<Left>,
    stack: Vec<Node>,
    /// Triangles that are yet to be looked at, eight at a time.
    some: Vec<Part>,
    swath: Swath,
    search: Search,
    scratch: Scratch,
    pieces: Vec<Piece>,
    budget: u32,
}

impl Sweeper {
    /// Looks at a whole motion; `None` if nothing is deeper on the way.
    pub(crate) fn run(&mut self, task: &Task<'_>, budget: u32) -> Option<Stop> {
        self.left.clear();
        self.left.push(Left::Node(Node { level: 0, index: 0, bound: f32::INFINITY }));
        self.budget = budget;
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
        if middle <= from || middle >= to || to - from < FINEST {
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
        let Task { setting, question, .. } = *task;
        let facets = setting.facets;
        let frame = &facets.frame;
        let [first, middle, last] = &stretch.poses;
        setting.setup.set_pose(frame, first, &mut self.ends[0]);
        setting.setup.set_pose(frame, middle, &mut self.view);
        setting.setup.set_pose(frame, last, &mut self.ends[1]);
        // The tips of poses are rounded where they are in the world.
        let tip = task.motion.start().coords.norm() + task.motion.way().norm();
        let margin = setting.margin()
            + (stretch.goes(f64::INFINITY) + task.keep()) / f64::from(1 << 18)
            + 2.0 * f64::EPSILON * tip / setting.length;
        let wanted = (task.above() - margin) as f32;
        let (keep, shift) = (task.keep() as f32, stretch.shift(task.keep()));
        let small = PART * stretch.goes(f64::INFINITY);
        self.stack.clear();
        self.some.clear();
        for at in list {
            match self.left[at] {
                Left::Node(node) => self.stack.push(node),
                Left::Part(part) => {
                    if let Some(stop) = self.add(task, stretch, part) {
                        return Some(stop);
                    }
                }
            }
            while let Some(node) = self.stack.pop() {
                if self.budget == 0 {
                    return Some(Stop::Spent { at: stretch.from });
                }
                self.budget -= 1;
                if node.is_triangle(facets) {
                    let origin = facets.frame.origin;
                    let corners = facets.corners[node.index as usize];
                    let piece = Piece::new(corners.map(|p| [0, 1, 2].map(|k| p[k] - origin[k])));
                    let part = Part { index: node.index, piece };
                    if let Some(stop) = self.add(task, stretch, part) {
                        return Some(stop);
                    }
                } else if node.size(facets) * setting.setup.unit < small {
                    self.left.push(Left::Node(node));
                } else {
                    let mut bounds = [node.bound; WIDTH];
                    let moving = Moving { hull: &question.hull, shift, keep, ends: &self.ends };
                    let seen = (facets, &moving, &self.view);
                    let hits = if margin > MARGIN {
                        u32::MAX
                    } else if node.is_leaf(facets) {
                        of_leaf(setting.level, seen, node, wanted)
                    } else {
                        of_children(setting.level, seen, node, wanted, &mut bounds)
                    };
                    self.stack.extend(node.children(facets, hits));
                }
            }
        }
        self.triangles(task, stretch)
    }

    /// Adds a part of a triangle to the batch. Of one that is large beside the tool the way is far from
    /// straight, so that it is halved.
    fn add(&mut self, task: &Task<'_>, stretch: &Stretch, part: Part) -> Option<Stop> {
        if self.budget == 0 {
            return Some(Stop::Spent { at: stretch.from });
        }
        self.budget -= 1;
        if stretch.turns() && part.piece.longest() > 4.0 * task.setting.size * task.setting.length {
            let mut halves = part.piece.halves().peekable();
            if halves.peek().is_some() {
                for piece in halves.filter(|piece| stretch.reaches(piece, task.setting.length)) {
                    if let Some(stop) = self.add(task, stretch, Part { piece, ..part }) {
                        return Some(stop);
                    }
                }
                return None;
            }
        }
        self.some.push(part);
        if self.some.len() == LANES { self.triangles(task, stretch) } else { None }
    }

    /// Adds to the list which triangles of the batch are left.
    fn triangles(&mut self, task: &Task<'_>, stretch: &Stretch) -> Option<Stop> {
        let Task { setting, question, .. } = *task;
        let level = task.setting.level;
        let count = self.some.len();
        self.swath.begin(stretch, task.keep(), &self.some);
        let above = task.above();
        self.swath.bound(level, &question.exact, above);
        if !self.swath.bounds[..count].iter().any(|bound| *bound > above || bound.is_nan()) {
            self.some.clear();
            return None;
        }
        self.swath.middle.bound(level, &question.exact, f64::NEG_INFINITY);
        for lane in 0..count {
            let index = self.swath.middle.index(lane);
            if self.swath.bounds[lane] <= above {
                continue;
            }
            let corners = self.swath.middle.corners(lane);
            let point = self.swath.middle.place(lane);
            let at = stretch.middle();
            let stop = |found: Place| Stop::Deeper { at, best: found.best(index) };
            let here = task.depth(&mut self.scratch, point);
            if task.too_deep(&here) {
                return Some(stop(here));
            }
            let goes = stretch.goes(stretch.about(&corners));
            let steep = setting.body.steep();
            let left = here.depth + steep * goes > task.wanted()
                || match self.passes(task, corners, goes) {
                    Passes::Too(deep) => return Some(stop(deep)),
                    Passes::Yes => false,
                    Passes::Open | Passes::Others => true,
                };
            if left {
                self.left.push(Left::Part(self.some[lane]));
            }
        }
        self.some.clear();
        None
    }

    /// Whether no place of a triangle is so deep, or so near, that after going so far it may be too deep.
    fn passes(&mut self, task: &Task<'_>, corners: [Point; 3], goes: f64) -> Passes {
        let Task { setting, question, .. } = *task;
        let Body::Profile(section) = &setting.body else {
            return self.halved(task, corners, goes);
        };
        let facet = Facet::new(corners);
        if question.owners.all() || task.limit < 0.0 {
            return self.along(task, (section, &question.owners), &facet, goes);
        }
        // Where no surface is too deep, none need be told apart.
        match self.along(task, (section, &Owners::default()), &facet, goes) {
            Passes::Others => self.halved(task, corners, goes),
            decided => decided,
        }
    }

    /// The same by the ways of a triangle on which it is deepest, or nearest.
    fn along(
        &mut self,
        task: &Task<'_>,
        asked: (&Section, &Owners),
        facet: &Facet,
        goes: f64,
    ) -> Passes {
        let goes = goes + facet.skew + task.error;
        let least = task.wanted() - goes;
        let (tolerance, enough, budget) = (0.25 * goes, f64::INFINITY, self.budget);
        self.search.begin(Goal { least, tolerance, enough, budget });
        let mut found = None;
        let heights = asked.0.circles.iter().chain(&asked.1.peaks);
        let peaks = heights.filter_map(|height| facet.level(*height));
        for course in facet.courses().chain(peaks) {
            let deepest = if least < 0.0 {
                self.search.outside(asked, &course)
            } else {
                self.search.inside((asked.0, asked.1, facet.skew), &course)
            };
            found = deepest.map(|deepest| course.point(deepest.t)).or(found);
        }
        self.budget = self.search.left();
        let Some(point) = found else {
            return if self.search.open() { Passes::Open } else { Passes::Yes };
        };
        let here = task.depth(&mut self.scratch, point);
        if task.too_deep(&here) {
            Passes::Too(here)
        } else if here.depth > least {
            Passes::Open
        } else {
            Passes::Others
        }
    }

    /// The same by its parts: it is halved until all of it passes, or what does not is small beside the
    /// way.
    fn halved(&mut self, task: &Task<'_>, corners: [Point; 3], goes: f64) -> Passes {
        let (body, owners) = (&task.setting.body, &task.question.owners);
        self.pieces.clear();
        self.pieces.push(Piece::new(corners));
        let mut looks = 0;
        while let Some(piece) = self.pieces.pop() {
            looks += 1;
            if self.budget == 0 || looks > LOOKS {
                return Passes::Open;
            }
            self.budget -= 1;
            let (centre, reach) = piece.ball();
            let far = goes + reach + task.error;
            let rectangle = piece.rectangle(goes + task.error);
            let place = (centre, &rectangle);
            if body.clears(&mut self.scratch, owners, place, (far, task.wanted())) {
                continue;
            }
            let here = task.depth(&mut self.scratch, centre);
            if task.too_deep(&here) {
                return Passes::Too(here);
            }
            if reach < SMALL * goes {
                return Passes::Open;
            }
            self.pieces.extend(piece.halves());
        }
        Passes::Yes
    }
}

/// What is said of a triangle.
enum Passes {
    Yes,
    /// It is too deep there.
    Too(Place),
    Open,
    /// What may be too deep is nearer to others than to the owners there.
    Others,
}

/// How many pieces of a triangle are looked at before time is halved instead.
const LOOKS: u32 = 1 << 12;

/// A piece of a triangle that is smaller than this part of its way is not halved.
const SMALL: f64 = 0.125;

/// A shorter stretch than this part of the motion is not halved.
const FINEST: f64 = f64::EPSILON;

/// Nodes are opened that are larger than this part of the way.
const PART: f64 = 0.3;
