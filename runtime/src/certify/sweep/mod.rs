//! Proof that a tool stays clear of a part along a trajectory, by intervals of time.
//!
//! An interval keeps a list of candidates: nodes and triangles that may be in the way. Bounds hold for the whole
//! interval, from the direction and length of the part's displacement in the tool's frame. Candidates that the
//! bounds rule out are dropped; the others pass to both halves of the interval. A node is opened if it is larger
//! than a fraction of the displacement.

pub(crate) mod interval;

use crate::bvh::{PoseTransform, WIDTH};
use crate::cancellation;
use crate::certify::bounds::descent::{BoundedTree, Node, of_children};
use crate::certify::bounds::swept::{Moving, SweptBatch, of_leaf};
use crate::certify::rounding;
use crate::certify::search::{DepthQuery, MAX_F32_MARGIN, QuerySetting};
use crate::certify::space::{Point, minus};
use crate::certify::sweep::interval::MotionInterval;
use crate::certify::tool_model::field::Scratch;
use crate::certify::tool_model::owners::Owners;
use crate::certify::tool_model::profile::ProfileModel;
use crate::certify::tool_model::{Surroundings, ToolModel};
use crate::certify::trajectory::Trajectory;
use crate::certify::triangle::line_search::{DeepestCandidate, DepthSearch, Goal};
use crate::certify::triangle::{LocalTriangle, SubTriangle, TrianglePiece};
use crate::pose::Pose;
use crate::tool::LANES;
use std::ops::ControlFlow;

/// The query, trajectory and limits of a sweep. Lengths are in the tool's unit.
pub(crate) struct SweepTask<'a> {
    pub(crate) setting: &'a QuerySetting<'a>,
    pub(crate) query: &'a DepthQuery,
    pub(crate) trajectory: &'a dyn Trajectory,
    /// The allowed depth of the query's owners. If negative, its magnitude is the distance that they have to keep. It
    /// is the query's own limit or, if that is at least 0, any larger value.
    pub(crate) limit: f64,
    /// The error bound of a point along this trajectory.
    pub(crate) error: f64,
    /// The excess over the limit that need not be reported.
    pub(crate) tolerance: f64,
}

impl SweepTask<'_> {
    /// Returns the depth up to which nothing needs to be examined.
    fn threshold(&self) -> f64 {
        self.limit + self.tolerance
    }

    /// Returns the bound above which a triangle has to be examined: the threshold and the distance to be kept, less the error.
    fn bound_threshold(&self) -> f64 {
        self.threshold() + self.required_clearance() - self.error
    }

    /// Returns the smallest distance that the owners have to keep.
    fn required_clearance(&self) -> f64 {
        (-self.threshold()).max(0.0)
    }

    /// Returns the depth of a point; negative values are distances.
    fn depth(&self, scratch: &mut Scratch, point: Point) -> DeepPoint {
        let (tool_model, owners) = (&self.setting.tool_model, &self.query.owners);
        let inside = if self.limit < 0.0 {
            Some(tool_model.distance(scratch, owners, point))
        } else {
            tool_model.depth(scratch, owners, point).filter(|depth| depth.value >= 0.0)
        };
        let depth =
            inside.unwrap_or_else(|| tool_model.distance(scratch, &Owners::default(), point));
        DeepPoint { point, depth: depth.value, feature: depth.feature }
    }

    /// Returns whether a point of the approximating motion exceeds the limit even after all rounding errors, and within
    /// its deviation from the trajectory.
    fn too_deep(&self, found: &DeepPoint, deviation: f64) -> bool {
        let steep = self.setting.tool_model.lipschitz();
        found.depth > self.limit + rounding::TOUCH * self.error + steep * deviation
    }
}

/// A point in the tool's frame and its depth.
#[derive(Clone, Copy)]
struct DeepPoint {
    point: Point,
    depth: f64,
    feature: usize,
}

impl DeepPoint {
    fn candidate(&self, index: u32) -> DeepestCandidate {
        DeepestCandidate { point: self.point, feature: self.feature, index }
    }
}

/// The reason a sweep ends before the whole motion is proved clear.
pub(crate) enum SweepEnd {
    /// A point exceeds the limit at this fraction of the motion. The pose is that of the approximating motion, in which
    /// the point is on the part.
    Deeper { at: f64, pose: Pose, best: DeepestCandidate },
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

/// Bounds on the distance of a triangle's points from where the approximating motion has them in the middle of an interval.
#[derive(Clone, Copy)]
struct Spread {
    /// At any time of the interval.
    displacement: f64,
    /// At that time itself.
    deviation: f64,
}

/// A candidate that may be in the way.
#[derive(Clone, Copy)]
enum Candidate {
    Node(Node),
    Piece(TrianglePiece),
}

/// The search along a motion, with its memory.
#[derive(Clone, Default)]
pub(crate) struct Sweeper {
    view: PoseTransform,
    ends: [PoseTransform; 2],
    /// The candidates of all intervals that are being examined, as a stack.
    pending: Vec<Candidate>,
    stack: Vec<Node>,
    /// Triangles waiting for the next batch of eight.
    waiting: Vec<TrianglePiece>,
    swept_batch: SweptBatch,
    search: DepthSearch,
    scratch: Scratch,
    pieces: Vec<SubTriangle>,
    budget: u32,
}

impl Sweeper {
    /// Examines a whole motion. Returns `None` if the limit is proved to hold.
    pub(crate) fn run(&mut self, task: &SweepTask<'_>, budget: u32) -> Option<SweepEnd> {
        self.pending.clear();
        // The root alone is the first candidate.
        self.pending.push(Candidate::Node(Node { level: 0, index: 0, bound: f32::INFINITY }));
        self.budget = budget;
        self.check_interval(task, [0.0, 1.0], 0).break_value()
    }

    /// Examines an interval, whose candidates start at index `first` of the list.
    fn check_interval(
        &mut self,
        task: &SweepTask<'_>,
        [from, to]: [f64; 2],
        first: usize,
    ) -> ControlFlow<SweepEnd> {
        cancellation::check();
        let last = self.pending.len();
        let (times, clearance) = ([from, to], task.required_clearance());
        match MotionInterval::new(task.setting, task.trajectory, times, clearance) {
            Some(interval) => {
                self.examine(task, &interval, first..last)?;
            }
            // Nothing is known on so long an interval.
            None => self.pending.extend_from_within(first..last),
        }
        // Nothing was left undecided.
        if self.pending.len() == last {
            return ControlFlow::Continue(());
        }
        // An interval that cannot be halved any more counts as a spent budget: its candidates stay undecided.
        let middle = from / 2.0 + to / 2.0;
        if middle <= from || middle >= to || to - from < MIN_DURATION {
            return ControlFlow::Break(SweepEnd::Spent { at: from });
        }
        for half in [[from, middle], [middle, to]] {
            self.check_interval(task, half, last)?;
        }
        self.pending.truncate(last);
        ControlFlow::Continue(())
    }

    /// Appends the candidates that remain of a range of the list.
    fn examine(
        &mut self,
        task: &SweepTask<'_>,
        interval: &MotionInterval,
        list: std::ops::Range<usize>,
    ) -> ControlFlow<SweepEnd> {
        let SweepTask { setting, query, .. } = *task;
        let bvh = &*setting.bvh;
        let frame = &bvh.frame;
        let [first, middle, last] = &interval.poses;
        setting.setup.set_pose(frame, first, &mut self.ends[0]);
        setting.setup.set_pose(frame, middle, &mut self.view);
        setting.setup.set_pose(frame, last, &mut self.ends[1]);
        // 2^-18 of the displacement covers the rounding of `Displacement`'s bounds in `f32`, whose terms are no larger.
        let margin = setting.margin()
            + (interval.displacement_bound(f64::INFINITY) + task.required_clearance())
                / f64::from(1 << 18);
        let threshold = (task.bound_threshold() - margin) as f32;
        let shift = interval.shift(task.required_clearance());
        let small = MAX_NODE_FRACTION * interval.displacement_bound(f64::INFINITY);
        self.stack.clear();
        self.waiting.clear();
        for at in list {
            match self.pending[at] {
                Candidate::Node(node) => self.stack.push(node),
                Candidate::Piece(piece) => self.add(task, interval, piece)?,
            }
            while let Some(node) = self.stack.pop() {
                if self.budget == 0 {
                    return ControlFlow::Break(SweepEnd::Spent { at: interval.from });
                }
                self.budget -= 1;
                if node.is_triangle(bvh) {
                    let origin = bvh.frame.origin.into();
                    let [a, b, c] = bvh.corners[node.index as usize];
                    let piece =
                        SubTriangle::new([minus(a, origin), minus(b, origin), minus(c, origin)]);
                    self.add(task, interval, TrianglePiece { index: node.index, piece })?;
                } else if node.size(bvh) * setting.setup.unit < small {
                    // Its size adds little to the displacement: halving the interval gains more than opening the node.
                    self.pending.push(Candidate::Node(node));
                } else {
                    let mut bounds = [node.bound; WIDTH];
                    let moving = Moving { hull: &query.hull, shift, ends: &self.ends };
                    let tree = BoundedTree { bvh, bounds: &moving, view: &self.view };
                    let hits = if margin > MAX_F32_MARGIN {
                        u32::MAX
                    } else if node.is_leaf(bvh) {
                        of_leaf(setting.level, &tree, node, threshold)
                    } else {
                        of_children(setting.level, &tree, node, threshold, &mut bounds)
                    };
                    self.stack.extend(node.children(bvh, hits));
                }
            }
        }
        self.examine_batch(task, interval)
    }

    /// Adds a triangle or a piece of one to the batch. If the motion turns and the piece is large compared with the
    /// tool, its path is far from straight, so the piece is halved.
    fn add(
        &mut self,
        task: &SweepTask<'_>,
        interval: &MotionInterval,
        triangle: TrianglePiece,
    ) -> ControlFlow<SweepEnd> {
        if self.budget == 0 {
            return ControlFlow::Break(SweepEnd::Spent { at: interval.from });
        }
        self.budget -= 1;
        if interval.rotates()
            && triangle.piece.longest() > 4.0 * task.setting.size * task.setting.length
        {
            let mut halves = triangle.piece.halves().peekable();
            if halves.peek().is_some() {
                for piece in halves.filter(|piece| interval.reaches(piece, task.setting.length)) {
                    self.add(task, interval, TrianglePiece { piece, ..triangle })?;
                }
                return ControlFlow::Continue(());
            }
        }
        self.waiting.push(triangle);
        if self.waiting.len() == LANES {
            self.examine_batch(task, interval)
        } else {
            ControlFlow::Continue(())
        }
    }

    /// Appends the triangles of the batch that remain.
    fn examine_batch(
        &mut self,
        task: &SweepTask<'_>,
        interval: &MotionInterval,
    ) -> ControlFlow<SweepEnd> {
        let SweepTask { setting, query, .. } = *task;
        let level = task.setting.level;
        let count = self.waiting.len();
        self.swept_batch.begin(interval, task.required_clearance(), &self.waiting);
        let threshold = task.bound_threshold();
        self.swept_batch.bound(level, &query.exact, threshold);
        let is_open = |bound: &f64| *bound > threshold || bound.is_nan();
        if !self.swept_batch.bounds[..count].iter().any(is_open) {
            self.waiting.clear();
            return ControlFlow::Continue(());
        }
        // Candidates are sampled where they are deepest in the middle of the interval.
        self.swept_batch.middle.bound(level, &query.exact, f64::NEG_INFINITY);
        let (at, pose) = (interval.middle(), interval.poses[1]);
        for lane in 0..count {
            let index = self.swept_batch.middle.index(lane);
            if self.swept_batch.bounds[lane] <= threshold {
                continue;
            }
            let corners = self.swept_batch.middle.corners(lane);
            let point = self.swept_batch.middle.point(lane);
            let spread = Spread {
                displacement: interval.displacement_bound(interval.rotation_radius(&corners)),
                deviation: interval.deviation(),
            };
            let sample = task.depth(&mut self.scratch, point);
            if task.too_deep(&sample, spread.deviation) {
                return ControlFlow::Break(SweepEnd::Deeper {
                    at,
                    pose,
                    best: sample.candidate(index),
                });
            }
            let steep = setting.tool_model.lipschitz();
            // Another's point says nothing about the owners.
            let may_become_too_deep = query.owners.is_owned(sample.feature)
                && sample.depth + steep * spread.displacement > task.threshold();
            let piece = self.waiting[lane];
            if may_become_too_deep {
                self.pending.push(Candidate::Piece(piece));
            } else if let Some(deep) = self.check_triangle(task, interval, &piece, spread) {
                return ControlFlow::Break(SweepEnd::Deeper {
                    at,
                    pose,
                    best: deep.candidate(index),
                });
            }
        }
        self.waiting.clear();
        ControlFlow::Continue(())
    }

    /// Examines a triangle or a piece of one: no point of it may be so deep, or so near, that its displacement could make it
    /// too deep. Appends what remains of it, or returns a point that is too deep.
    fn check_triangle(
        &mut self,
        task: &SweepTask<'_>,
        interval: &MotionInterval,
        triangle: &TrianglePiece,
        spread: Spread,
    ) -> Option<DeepPoint> {
        let SweepTask { setting, query, .. } = *task;
        let profile = match &setting.tool_model {
            ToolModel::Profile(profile) if query.owners.all() || task.limit < 0.0 => profile,
            _ => return self.check_subdivided(task, interval, triangle, spread),
        };
        let corners = triangle.piece.corners().map(|corner| interval.in_the_middle(&corner));
        match self.check_lines(task, profile, &query.owners, &TriangleBand::whole(corners), spread)
        {
            TriangleVerdict::TooDeep(deep) => return Some(deep),
            TriangleVerdict::Clear => {}
            TriangleVerdict::Undecided | TriangleVerdict::Halve(_) => {
                self.pending.push(Candidate::Piece(*triangle));
            }
        }
        None
    }

    /// Examines a band of a triangle by searching its lines on which the depth is greatest or the distance least.
    fn check_lines(
        &mut self,
        task: &SweepTask<'_>,
        profile: &ProfileModel,
        owners: &Owners,
        band: &TriangleBand,
        spread: Spread,
    ) -> TriangleVerdict {
        let TriangleBand { triangle, heights } = band;
        let displacement = spread.displacement + triangle.skew + task.error;
        // A point less deep than that does not become too deep in what is left of the interval.
        let least = task.threshold() - displacement;
        self.search.begin(Goal {
            threshold: least,
            // A finer search would tell nothing that the displacement does not blur.
            tolerance: 0.25 * displacement,
            stop_depth: f64::INFINITY,
            budget: self.budget,
        });
        let mut found = None;
        let section = &profile.section;
        let peaks = profile.circles.heights.iter().chain(&owners.peaks);
        let levels = peaks.chain(heights).filter_map(|height| triangle.level(*height));
        for line in triangle.search_lines().chain(levels) {
            let Some(line) = line.between(*heights) else { continue };
            let maximum = if least < 0.0 {
                self.search.outside(section, owners, &line)
            } else {
                self.search.inside(section, owners, triangle.skew, &line)
            };
            found = maximum.map(|maximum| line.point(maximum.t)).or(found);
        }
        if least >= 0.0 {
            let whole = SubTriangle::new(triangle.corners);
            whole.leave_unresolved(profile, owners, displacement, &mut self.search);
        }
        self.budget = self.search.remaining_budget();
        let Some(point) = found else {
            return if self.search.has_open() {
                TriangleVerdict::Undecided
            } else {
                TriangleVerdict::Clear
            };
        };
        let sample = task.depth(&mut self.scratch, point);
        if task.too_deep(&sample, spread.deviation) {
            TriangleVerdict::TooDeep(sample)
        } else if sample.depth > least {
            TriangleVerdict::Undecided
        } else {
            TriangleVerdict::Halve(point)
        }
    }

    /// Examines a triangle by subdivision: it is halved until all pieces pass, or one does not that is small compared with the
    /// displacement. That piece remains, with those that were not examined: pieces that pass do so in both halves of the
    /// interval, too.
    fn check_subdivided(
        &mut self,
        task: &SweepTask<'_>,
        interval: &MotionInterval,
        triangle: &TrianglePiece,
        spread: Spread,
    ) -> Option<DeepPoint> {
        self.pieces.clear();
        self.pieces.push(triangle.piece);
        let mut count = 0;
        while let Some(piece) = self.pieces.pop() {
            count += 1;
            let verdict = if self.budget == 0 || count > MAX_PIECES {
                TriangleVerdict::Undecided
            } else {
                self.budget -= 1;
                let corners = piece.corners().map(|corner| interval.in_the_middle(&corner));
                self.check_piece(task, SubTriangle::new(corners), spread)
            };
            match verdict {
                TriangleVerdict::TooDeep(deep) => return Some(deep),
                TriangleVerdict::Clear => {}
                TriangleVerdict::Halve(_) => {
                    let before = self.pieces.len();
                    self.pieces.extend(piece.halves());
                    // A piece without halves is too small to be told apart.
                    if self.pieces.len() == before {
                        self.pending.push(Candidate::Piece(TrianglePiece { piece, ..*triangle }));
                    }
                }
                TriangleVerdict::Undecided => {
                    self.pieces.push(piece);
                    let remaining = self.pieces.drain(..);
                    let remaining = remaining.map(|piece| TrianglePiece { piece, ..*triangle });
                    self.pending.extend(remaining.map(Candidate::Piece));
                }
            }
        }
        None
    }

    /// Examines a piece as a whole. It is to be halved if the owners may own no point that is too deep, and others do.
    fn check_piece(
        &mut self,
        task: &SweepTask<'_>,
        piece: SubTriangle,
        spread: Spread,
    ) -> TriangleVerdict {
        let (tool_model, owners) = (&task.setting.tool_model, &task.query.owners);
        let Spread { displacement, deviation } = spread;
        let (centre, reach) = piece.ball();
        let points = Surroundings {
            centre,
            displacement: displacement + reach + task.error,
            rectangle: piece.rectangle(displacement + task.error).corners(),
        };
        if tool_model.clears(&mut self.scratch, owners, &points, task.threshold()) {
            return TriangleVerdict::Clear;
        }
        if let ToolModel::Profile(profile) = tool_model {
            let triangle = LocalTriangle::new(*piece.corners());
            let near = displacement + triangle.skew + rounding::APART * task.error;
            let Some(heights) = task.query.heights(&piece, near) else {
                return TriangleVerdict::Clear;
            };
            // Owners need not be told apart where no surface at all is too deep.
            let band = TriangleBand { triangle, heights };
            let other = match self.check_lines(task, profile, &Owners::default(), &band, spread) {
                TriangleVerdict::Halve(other) => other,
                decided => return decided,
            };
            // Halving tells nothing about a point as near to the border of another's region as the piece's ends are.
            let points = Surroundings {
                centre: other,
                displacement: near,
                rectangle: SubTriangle::new([other; 3]).rectangle(near).corners(),
            };
            if !tool_model.clears(&mut self.scratch, owners, &points, task.threshold()) {
                return match self.check_lines(task, profile, owners, &band, spread) {
                    TriangleVerdict::TooDeep(deep) => TriangleVerdict::TooDeep(deep),
                    _ => TriangleVerdict::Undecided,
                };
            }
        }
        let sample = task.depth(&mut self.scratch, centre);
        if task.too_deep(&sample, deviation) {
            TriangleVerdict::TooDeep(sample)
        } else if reach < MIN_PIECE_FRACTION * displacement {
            TriangleVerdict::Undecided
        } else {
            TriangleVerdict::Halve(centre)
        }
    }
}

/// The verdict on a triangle.
enum TriangleVerdict {
    Clear,
    /// The triangle is too deep at this point.
    TooDeep(DeepPoint),
    Undecided,
    /// Halves may tell: this point may be too deep, and is nearer to other features than to the owners, or is only the middle of a piece
    /// that is not small.
    Halve(Point),
}

/// The part of a triangle between two heights.
struct TriangleBand {
    triangle: LocalTriangle,
    heights: [f64; 2],
}

impl TriangleBand {
    fn whole(corners: [Point; 3]) -> TriangleBand {
        let heights = [f64::NEG_INFINITY, f64::INFINITY];
        TriangleBand { triangle: LocalTriangle::new(corners), heights }
    }
}

/// The number of pieces of a triangle that are examined before the interval is halved instead.
const MAX_PIECES: u32 = 1 << 12;

/// Pieces smaller than this fraction of the displacement are not halved.
const MIN_PIECE_FRACTION: f64 = 0.125;

/// Intervals shorter than this fraction of the motion are not halved.
const MIN_DURATION: f64 = f64::EPSILON;

/// Nodes larger than this fraction of the displacement are opened.
const MAX_NODE_FRACTION: f64 = 0.3;

#[cfg(test)]
mod tests {
    use crate::certify::{Certifier, MotionVerdict, TriangleBvh};
    use crate::mesh::Mesh;
    use crate::motion::Motion;
    use crate::pose::Pose;
    use crate::tool::Interpreted;
    use crate::unit::Unit;
    use nalgebra::{Point3, Vector3};
    use std::sync::LazyLock;

    static HELD: LazyLock<Interpreted> = LazyLock::new(|| {
        r#"tool Held "a flute that cuts, below a shank" {
            units mm;
            profile {
                start (0, 0);
                line to (6, 0) as face cutting;
                line to (6, 20) as flute cutting;
                line to (6, 60), (0, 60) as shank;
            }
            niceness cutting: 1;
        }"#
        .parse()
        .expect("a tool")
    });

    #[test]
    fn a_triangle_inside_the_tool_is_followed_from_the_flute_to_the_shank() {
        // It is deeper than its displacement, so it stays inside.
        let corners = [[2.5, -0.5, 20.0], [2.5, 0.5, 20.0], [2.5, 0.0, 20.5]].map(Point3::from);
        let mesh =
            Mesh::new(corners.to_vec(), vec![[0, 1, 2]], Unit::Millimetre).expect("a triangle");
        let bvh = TriangleBvh::new(&mesh);
        let pose = |z: f64| {
            Pose::from_axis(Point3::new(0.0, 0.0, z), Vector3::z()).expect("a unit vector")
        };
        let mut certifier = Certifier::new(&bvh, &*HELD)
            .expect("a profile")
            .with_allowance("face", f64::INFINITY)
            .expect("a surface")
            .with_allowance("flute", f64::INFINITY)
            .expect("a surface");
        for drop in [0.3, 1.0, 3.0, 5.0, 40.0] {
            let motion = Motion::new(&pose(2.0), &pose(2.0 - drop)).expect("a motion");
            let verdict = certifier.check_motion(&motion, 1e-6);
            let is_expected = match verdict {
                MotionVerdict::SurfaceOnly => drop < 1.5,
                MotionVerdict::Touching(..) => drop > 1.5,
                _ => false,
            };
            assert!(is_expected, "{drop} mm down: {verdict:?}");
        }
    }
}
