//! Proof that a tool stays clear of a part along a motion, by intervals of time.
//!
//! An interval keeps a list of candidates: nodes and triangles that may be in the way. Bounds hold for the whole
//! interval, from the direction and length of the part's displacement in the tool's frame. Candidates that the
//! bounds rule out are dropped; the others pass to both halves of the interval. A node is opened if it is larger
//! than a fraction of the displacement.

mod moving;
pub(crate) mod stretch;
mod task;

use crate::bvh::{PoseTransform, WIDTH};
use crate::certify::bounds::descent::{Node, of_children};
use crate::certify::bounds::swept_batch::SweptBatch;
use crate::certify::search::MARGIN;
use crate::certify::space::Point;
use crate::certify::sweep::stretch::MotionInterval;
use crate::certify::tool_model::ToolModel;
use crate::certify::tool_model::field::Scratch;
use crate::certify::tool_model::owners::Owners;
use crate::certify::tool_model::section::Section;
use crate::certify::triangle::line_search::{DeepestCandidate, DepthSearch, Goal};
use crate::certify::triangle::local::LocalTriangle;
use crate::certify::triangle::subdivision::{SubTriangle, TrianglePiece};
use crate::tool::LANES;
use moving::{Moving, of_leaf};
use task::DeepPoint;
pub(crate) use task::SweepTask;

/// The reason a sweep ends before the whole motion is proved clear.
pub(crate) enum SweepEnd {
    /// A point exceeds the limit at this fraction of the motion.
    Deeper { at: f64, best: DeepestCandidate },
    /// The budget was spent at this fraction of the motion.
    Spent { at: f64 },
}

impl SweepEnd {
    /// Returns whether this end takes precedence: a point too deep before a spent budget, then the earlier time.
    pub(crate) fn before(&self, other: &SweepEnd) -> bool {
        match (self, other) {
            (SweepEnd::Deeper { .. }, SweepEnd::Spent { .. }) => true,
            (SweepEnd::Spent { .. }, SweepEnd::Deeper { .. }) => false,
            (SweepEnd::Deeper { at, .. }, SweepEnd::Deeper { at: other, .. })
            | (SweepEnd::Spent { at }, SweepEnd::Spent { at: other }) => at < other,
        }
    }
}

/// A candidate that may be in the way.
#[derive(Clone, Copy)]
enum Undecided {
    Node(Node),
    Part(TrianglePiece),
}

/// The search along a motion, with its memory.
#[derive(Default)]
pub(crate) struct Sweeper {
    view: PoseTransform,
    ends: [PoseTransform; 2],
    /// The candidates of all intervals that are being examined, as a stack.
    left: Vec<Undecided>,
    stack: Vec<Node>,
    /// Triangles waiting for the next batch of eight.
    some: Vec<TrianglePiece>,
    swath: SweptBatch,
    search: DepthSearch,
    scratch: Scratch,
    pieces: Vec<SubTriangle>,
    budget: u32,
}

impl Sweeper {
    /// Examines a whole motion. Returns `None` if the limit is proved to hold.
    pub(crate) fn run(&mut self, task: &SweepTask<'_>, budget: u32) -> Option<SweepEnd> {
        self.left.clear();
        self.left.push(Undecided::Node(Node { level: 0, index: 0, bound: f32::INFINITY }));
        self.budget = budget;
        self.stretch(task, [0.0, 1.0], 0)
    }

    /// Examines an interval, whose candidates start at index `first` of the list.
    fn stretch(
        &mut self,
        task: &SweepTask<'_>,
        [from, to]: [f64; 2],
        first: usize,
    ) -> Option<SweepEnd> {
        let stretch = MotionInterval::new(task.setting, task.motion, [from, to], task.keep());
        let last = self.left.len();
        if let Some(stop) = self.look(task, &stretch, first..last) {
            return Some(stop);
        }
        if self.left.len() == last {
            return None;
        }
        let middle = stretch.middle();
        if middle <= from || middle >= to || to - from < FINEST {
            return Some(SweepEnd::Spent { at: from });
        }
        for half in [[from, middle], [middle, to]] {
            if let Some(stop) = self.stretch(task, half, last) {
                return Some(stop);
            }
        }
        self.left.truncate(last);
        None
    }

    /// Appends the candidates that remain of a range of the list.
    fn look(
        &mut self,
        task: &SweepTask<'_>,
        stretch: &MotionInterval,
        list: std::ops::Range<usize>,
    ) -> Option<SweepEnd> {
        let SweepTask { setting, question, .. } = *task;
        let bvh = setting.bvh;
        let frame = &bvh.frame;
        let [first, middle, last] = &stretch.poses;
        setting.setup.set_pose(frame, first, &mut self.ends[0]);
        setting.setup.set_pose(frame, middle, &mut self.view);
        setting.setup.set_pose(frame, last, &mut self.ends[1]);
        // The tips of poses are rounded relative to their world coordinates.
        let tip = task.motion.start().coords.norm() + task.motion.displacement().norm();
        let margin = setting.margin()
            + (stretch.displacement_bound(f64::INFINITY) + task.keep()) / f64::from(1 << 18)
            + 2.0 * f64::EPSILON * tip / setting.length;
        let wanted = (task.above() - margin) as f32;
        let (keep, shift) = (task.keep() as f32, stretch.shift(task.keep()));
        let small = PART * stretch.displacement_bound(f64::INFINITY);
        self.stack.clear();
        self.some.clear();
        for at in list {
            match self.left[at] {
                Undecided::Node(node) => self.stack.push(node),
                Undecided::Part(part) => {
                    if let Some(stop) = self.add(task, stretch, part) {
                        return Some(stop);
                    }
                }
            }
            while let Some(node) = self.stack.pop() {
                if self.budget == 0 {
                    return Some(SweepEnd::Spent { at: stretch.from });
                }
                self.budget -= 1;
                if node.is_triangle(bvh) {
                    let origin = bvh.frame.origin;
                    let corners = bvh.corners[node.index as usize];
                    let piece =
                        SubTriangle::new(corners.map(|p| [0, 1, 2].map(|k| p[k] - origin[k])));
                    let part = TrianglePiece { index: node.index, piece };
                    if let Some(stop) = self.add(task, stretch, part) {
                        return Some(stop);
                    }
                } else if node.size(bvh) * setting.setup.unit < small {
                    self.left.push(Undecided::Node(node));
                } else {
                    let mut bounds = [node.bound; WIDTH];
                    let moving = Moving { hull: &question.hull, shift, keep, ends: &self.ends };
                    let seen = (bvh, &moving, &self.view);
                    let hits = if margin > MARGIN {
                        u32::MAX
                    } else if node.is_leaf(bvh) {
                        of_leaf(setting.level, seen, node, wanted)
                    } else {
                        of_children(setting.level, seen, node, wanted, &mut bounds)
                    };
                    self.stack.extend(node.children(bvh, hits));
                }
            }
        }
        self.triangles(task, stretch)
    }

    /// Adds a triangle or a piece of one to the batch. If the motion turns and the piece is large compared with the
    /// tool, its path is far from straight, so the piece is halved.
    fn add(
        &mut self,
        task: &SweepTask<'_>,
        stretch: &MotionInterval,
        part: TrianglePiece,
    ) -> Option<SweepEnd> {
        if self.budget == 0 {
            return Some(SweepEnd::Spent { at: stretch.from });
        }
        self.budget -= 1;
        if stretch.turns() && part.piece.longest() > 4.0 * task.setting.size * task.setting.length {
            let mut halves = part.piece.halves().peekable();
            if halves.peek().is_some() {
                for piece in halves.filter(|piece| stretch.reaches(piece, task.setting.length)) {
                    if let Some(stop) = self.add(task, stretch, TrianglePiece { piece, ..part }) {
                        return Some(stop);
                    }
                }
                return None;
            }
        }
        self.some.push(part);
        if self.some.len() == LANES { self.triangles(task, stretch) } else { None }
    }

    /// Appends the triangles of the batch that remain.
    fn triangles(&mut self, task: &SweepTask<'_>, stretch: &MotionInterval) -> Option<SweepEnd> {
        let SweepTask { setting, question, .. } = *task;
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
            let stop = |found: DeepPoint| SweepEnd::Deeper { at, best: found.best(index) };
            let here = task.depth(&mut self.scratch, point);
            if task.too_deep(&here) {
                return Some(stop(here));
            }
            let goes = stretch.displacement_bound(stretch.about(&corners));
            let steep = setting.body.lipschitz();
            let left = here.depth + steep * goes > task.wanted()
                || match self.passes(task, corners, goes) {
                    TriangleVerdict::Too(deep) => return Some(stop(deep)),
                    TriangleVerdict::Yes => false,
                    TriangleVerdict::Open | TriangleVerdict::Others => true,
                };
            if left {
                self.left.push(Undecided::Part(self.some[lane]));
            }
        }
        self.some.clear();
        None
    }

    /// Examines a triangle: no point of it may be so deep, or so near, that this displacement could make it too deep.
    fn passes(&mut self, task: &SweepTask<'_>, corners: [Point; 3], goes: f64) -> TriangleVerdict {
        let SweepTask { setting, question, .. } = *task;
        let ToolModel::Profile(section) = &setting.body else {
            return self.halved(task, corners, goes);
        };
        let facet = LocalTriangle::new(corners);
        if question.owners.all() || task.limit < 0.0 {
            return self.along(task, (section, &question.owners), &facet, goes);
        }
        // If no surface at all is too deep, the owners need not be told apart.
        match self.along(task, (section, &Owners::default()), &facet, goes) {
            TriangleVerdict::Others => self.halved(task, corners, goes),
            decided => decided,
        }
    }

    /// The same, by searching the lines of a triangle on which the depth is greatest or the distance least.
    fn along(
        &mut self,
        task: &SweepTask<'_>,
        asked: (&Section, &Owners),
        facet: &LocalTriangle,
        goes: f64,
    ) -> TriangleVerdict {
        let goes = goes + facet.skew + task.error;
        let least = task.wanted() - goes;
        let (tolerance, enough, budget) = (0.25 * goes, f64::INFINITY, self.budget);
        self.search.begin(Goal { least, tolerance, enough, budget });
        let mut found = None;
        let heights = asked.0.circles.iter().chain(&asked.1.peaks);
        let peaks = heights.filter_map(|height| facet.level(*height));
        for course in facet.search_lines().chain(peaks) {
            let deepest = if least < 0.0 {
                self.search.outside(asked, &course)
            } else {
                self.search.inside((asked.0, asked.1, facet.skew), &course)
            };
            found = deepest.map(|deepest| course.point(deepest.t)).or(found);
        }
        self.budget = self.search.left();
        let Some(point) = found else {
            return if self.search.open() { TriangleVerdict::Open } else { TriangleVerdict::Yes };
        };
        let here = task.depth(&mut self.scratch, point);
        if task.too_deep(&here) {
            TriangleVerdict::Too(here)
        } else if here.depth > least {
            TriangleVerdict::Open
        } else {
            TriangleVerdict::Others
        }
    }

    /// The same, by subdivision: the triangle is halved until all pieces pass, or a piece that does not is small
    /// compared with the displacement.
    fn halved(&mut self, task: &SweepTask<'_>, corners: [Point; 3], goes: f64) -> TriangleVerdict {
        let (body, owners) = (&task.setting.body, &task.question.owners);
        self.pieces.clear();
        self.pieces.push(SubTriangle::new(corners));
        let mut looks = 0;
        while let Some(piece) = self.pieces.pop() {
            looks += 1;
            if self.budget == 0 || looks > LOOKS {
                return TriangleVerdict::Open;
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
                return TriangleVerdict::Too(here);
            }
            if reach < SMALL * goes {
                return TriangleVerdict::Open;
            }
            self.pieces.extend(piece.halves());
        }
        TriangleVerdict::Yes
    }
}

/// The verdict on a triangle.
enum TriangleVerdict {
    Yes,
    /// The triangle is too deep at this point.
    Too(DeepPoint),
    Open,
    /// Points that may be too deep are nearer to other features than to the owners.
    Others,
}

/// The number of pieces of a triangle that are examined before the interval is halved instead.
const LOOKS: u32 = 1 << 12;

/// Pieces smaller than this fraction of the displacement are not halved.
const SMALL: f64 = 0.125;

/// Intervals shorter than this fraction of the motion are not halved.
const FINEST: f64 = f64::EPSILON;

/// Nodes larger than this fraction of the displacement are opened.
const PART: f64 = 0.3;
