//! The motions of a program, each with its place in the file.

use crate::gcode::{BlockLine, SubprogramLine, WorkOffset};
use crate::machine::JointMotion;
use crate::program::{ClData, CutterLocation};
use nalgebra::{Point3, Vector3};
use std::iter;
use touchoff::certify::{Approximation, Trajectory};
use touchoff::tool::{Symmetry, ToolInfo};
use touchoff::{Motion, MotionError, Pose, Unit, cancellation};

/// A motion of a program.
#[derive(Clone, Debug)]
pub struct Move {
    /// Line of the block or cutter location at which the motion ends.
    pub line: usize,
    /// The line of its block in the file of subprograms that has it.
    pub within: Option<SubprogramLine>,
    /// Line at which it begins; `None` for the first position, which is checked by itself.
    pub from: Option<usize>,
    /// Set in rapid traverse.
    pub rapid: bool,
    /// Set on a path beside that of the program, which some control takes instead: it is checked, but cuts no stock and has no length.
    pub alternative: bool,
    /// Number of the tool in the spindle, if the program states it.
    pub tool: Option<u32>,
    /// The work offset, in a program on a machine.
    pub work_offset: Option<WorkOffset>,
    /// The path of the tool, in the frame and unit of the part.
    pub path: MovePath,
}

/// The path of the tool during a motion.
#[derive(Clone, Debug)]
pub enum MovePath {
    /// The tip moves on a straight line, and the axis turns at constant speed.
    Straight(Motion),
    /// The control interpolates the axes of a machine.
    Joints(Box<JointPath>),
    /// Each axis moves at a rate that is not known.
    Box(Box<RapidBox>),
    /// The rotation is ambiguous. Only the end is known, as a motion of length 0.
    Ambiguous(MotionError, Motion),
}

/// The poses of a tool that moves without turning from one position to another, on any path on which each axis moves at
/// a constant rate until it arrives: those of a box, which the ways of the axes span.
#[derive(Clone, Debug)]
pub struct RapidBox {
    start: Pose,
    /// The way of each axis, in the frame and unit of the part. They are orthogonal.
    edges: Vec<Vector3<f64>>,
}

impl RapidBox {
    /// Creates the box at a pose with the ways of up to three axes, which are orthogonal.
    pub fn new(start: Pose, edges: Vec<Vector3<f64>>) -> RapidBox {
        RapidBox { start, edges }
    }

    fn at(&self, tip: Point3<f64>) -> Pose {
        Pose::from_computed(*self.start.rotation(), tip)
    }

    /// Returns the pose at a fraction of every way.
    pub fn pose(&self, fraction: f64) -> Pose {
        self.at(self.start.tip() + fraction * self.edges.iter().sum::<Vector3<f64>>())
    }

    /// Returns the lowest and the highest corner of a box that holds a tool at all poses, in a unit.
    pub(crate) fn tool_bounds(&self, info: &ToolInfo, unit: Unit) -> [Point3<f64>; 2] {
        let factor = info.unit.factor_to(unit);
        let (axis, reach, radius) = (self.start.axis(), info.reach(), info.radius() * factor);
        let ends = [reach.low, reach.high].map(|at| self.start.tip() + axis.scale(at * factor));
        let mut bounds = [ends[0].inf(&ends[1]), ends[0].sup(&ends[1])];
        for k in 0..3 {
            // A disc across the axis.
            let across = radius * (1.0 - axis[k] * axis[k]).max(0.0).sqrt();
            let ways = self.edges.iter().map(|edge| edge[k]);
            bounds[0][k] += ways.clone().map(|way| way.min(0.0)).sum::<f64>() - across;
            bounds[1][k] += ways.map(|way| way.max(0.0)).sum::<f64>() + across;
        }
        bounds
    }

    /// Returns an upper bound on the distance of the box's poses from that in its middle, without rounding.
    pub(super) fn radius(&self) -> f64 {
        0.5 * self.edges.iter().map(Vector3::norm_squared).sum::<f64>().sqrt()
    }

    /// Returns the index of its longest way.
    fn longest(&self) -> Option<usize> {
        (0..self.edges.len())
            .max_by(|one, other| self.edges[*one].norm().total_cmp(&self.edges[*other].norm()))
    }

    /// Returns the poses at both ends of its longest way, in the middle of the others.
    pub(super) fn longest_line(&self) -> [Pose; 2] {
        let middle = self.pose(0.5).tip();
        let half = self.longest().map_or_else(Vector3::zeros, |index| 0.5 * self.edges[index]);
        [middle - half, middle + half].map(|tip| self.at(tip))
    }

    /// Returns an upper bound on the distance of the box's poses from that line, without rounding.
    pub(super) fn radius_across(&self) -> f64 {
        let longest = self.longest();
        let others = (0..self.edges.len()).filter(|index| Some(*index) != longest);
        0.5 * others.map(|index| self.edges[index].norm_squared()).sum::<f64>().sqrt()
    }

    /// Returns both halves of the box, divided across its second longest way.
    pub(super) fn halves_across(&self) -> [RapidBox; 2] {
        let longest = self.longest();
        let others = (0..self.edges.len()).filter(|index| Some(*index) != longest);
        let second = others
            .max_by(|one, other| self.edges[*one].norm().total_cmp(&self.edges[*other].norm()));
        self.halves_of(second.or(longest))
    }

    /// Returns both halves of the box, divided across its longest way.
    pub(super) fn halves(&self) -> [RapidBox; 2] {
        self.halves_of(self.longest())
    }

    fn halves_of(&self, way: Option<usize>) -> [RapidBox; 2] {
        let mut half = self.clone();
        // A box without ways is a pose, which has no halves.
        let Some(way) = way else { return [half.clone(), half] };
        half.edges[way] *= 0.5;
        let middle = self.start.tip() + half.edges[way];
        [half.clone(), RapidBox { start: self.at(middle), ..half }]
    }
}

/// A joint motion in the unit of the part.
#[derive(Clone, Debug)]
pub struct JointPath {
    motion: JointMotion,
    /// Units of the part per millimetre.
    scale: f64,
    /// Bound on the distance of the motion from the one that the control makes, in millimetres.
    error: f64,
    /// Origin of the frame of poses, in that of the motion and in millimetres.
    origin: Vector3<f64>,
}

impl JointPath {
    /// Creates the path of a joint motion that differs from that of the control by at most `error`, in millimetres.
    pub fn new(motion: JointMotion, unit: Unit, error: f64) -> JointPath {
        let (scale, origin) = (Unit::Millimetre.factor_to(unit), Vector3::zeros());
        JointPath { motion, scale, error, origin }
    }

    /// Returns the path relative to an origin, in millimetres and the frame of the motion.
    #[must_use]
    pub fn relative_to(self, origin: Vector3<f64>) -> JointPath {
        JointPath { origin, ..self }
    }

    /// Returns the pose at a fraction of the motion, from 0 to 1.
    pub fn pose(&self, fraction: f64) -> Pose {
        let pose = self.motion.pose(fraction);
        if self.scale == 1.0 && self.origin == Vector3::zeros() {
            return pose;
        }
        Pose::from_computed(*pose.rotation(), (pose.tip() - self.origin) * self.scale)
    }

    /// Returns an upper bound on the speed of points within `reach` of the tip, per unit of the motion's time.
    fn max_speed(&self, reach: f64) -> f64 {
        self.motion.max_speed(reach / self.scale) * self.scale
    }

    /// Returns the part of the deviation that does not decrease with the length of a span: the error of the motion, and
    /// rounding.
    fn error(&self, reach: f64) -> f64 {
        let rounding = self.motion.rounding();
        let unscaled = rounding.tip + 2.0 * rounding.rotation * reach / self.scale;
        let [from, to] = [0.0, 1.0].map(|at| self.scaled(unscaled, &self.pose(at).tip(), reach));
        from.max(to)
    }

    /// Adds to a bound on the deviation, in millimetres, the error of the motion and the rounding of the coordinates.
    fn scaled(&self, deviation: f64, tip: &Point3<f64>, reach: f64) -> f64 {
        let size = tip.coords.norm() + reach + self.origin.norm() * self.scale;
        let rounding = 2.0 * f64::EPSILON * size;
        (deviation + self.error) * self.scale + rounding
    }
}

impl Move {
    /// Returns the motions of a program: the first cutter location by itself, then from each to the next.
    ///
    /// # Panics
    /// As [`Move::between`].
    pub fn all(program: &ClData, symmetry: Symmetry) -> impl Iterator<Item = Move> + '_ {
        let locations = &program.locations;
        let before = iter::once(None).chain(locations.iter().map(Some));
        before
            .zip(locations)
            .map(move |(from, to)| Move { tool: program.tool, ..Move::between(from, to, symmetry) })
    }

    /// Returns the motion from one cutter location to the next, or the first one by itself. A tool of revolution
    /// turns about the common normal of both axes, a solid about one fixed axis.
    ///
    /// # Panics
    /// Panics if a solid is given a pose without a spin ([`ClData::check_poses`](crate::ClData::check_poses)).
    pub fn between(from: Option<&CutterLocation>, to: &CutterLocation, symmetry: Symmetry) -> Move {
        cancellation::check();
        let before = from.map_or(&to.pose, |from| &from.pose);
        let path = match between(before, &to.pose, symmetry) {
            Ok(motion) => MovePath::Straight(motion),
            Err(error) => {
                let rest = between(&to.pose, &to.pose, symmetry);
                MovePath::Ambiguous(error, rest.expect("a pose with a spin, if the tool needs one"))
            }
        };
        let from = from.map(|from| from.line);
        Move {
            line: to.line,
            within: None,
            from,
            rapid: to.rapid,
            alternative: false,
            tool: None,
            work_offset: None,
            path,
        }
    }

    /// Returns the place of its block or cutter location.
    pub fn block(&self) -> BlockLine {
        BlockLine { line: self.line, within: self.within }
    }
}

impl MovePath {
    /// Returns the pose at a fraction of the motion, from 0 to 1.
    pub fn pose(&self, fraction: f64) -> Pose {
        match self {
            MovePath::Straight(motion) | MovePath::Ambiguous(_, motion) => motion.pose(fraction),
            MovePath::Joints(path) => path.pose(fraction),
            MovePath::Box(path) => path.pose(fraction),
        }
    }

    /// Returns an upper bound on the speed of any point of a tool, per unit of the motion's time, with lengths in `unit`.
    pub fn max_speed(&self, tool: &ToolInfo, unit: Unit) -> f64 {
        let reach = tool.max_distance_from_tip(unit);
        match self {
            MovePath::Straight(motion) | MovePath::Ambiguous(_, motion) => motion.max_speed(reach),
            MovePath::Joints(path) => path.max_speed(reach),
            MovePath::Box(path) => 2.0 * path.radius(),
        }
    }

    /// Returns an upper bound on the travel of any point of the tool within `reach` of the tip.
    pub(super) fn max_travel(&self, reach: f64, symmetry: Symmetry) -> f64 {
        match self {
            MovePath::Straight(motion) => motion.max_speed(reach),
            MovePath::Joints(path) => span(path, [0.0, 1.0], reach, symmetry).max_travel,
            MovePath::Box(path) => 2.0 * path.radius(),
            MovePath::Ambiguous(..) => f64::INFINITY,
        }
    }
}

/// A span of a joint motion, approximated by a motion between its ends.
pub(super) struct Span {
    pub(super) motion: Result<Motion, MotionError>,
    /// Bound on the distance between any point of the tool in the approximation and its true place at the same time.
    pub(super) deviation: f64,
    /// Upper bound on the travel of any point of the tool.
    pub(super) max_travel: f64,
}

/// Approximates a span of a joint motion for the points within `reach` of the tip.
///
/// A tool of revolution may turn on a great circle or about one fixed axis, whichever is nearer to the truth: the first if
/// the spin about the tool axis is most of the rotation, the second otherwise.
pub(super) fn span(path: &JointPath, times: [f64; 2], reach: f64, symmetry: Symmetry) -> Span {
    let ([start, end], [from, to]) = (times, times.map(|time| path.pose(time)));
    let unscaled = reach / path.scale;
    let deviation = path.motion.deviation_with_spin(start, end, unscaled);
    let deviation = path.scaled(deviation, &from.tip(), reach);
    let mut span = Span::new(Motion::with_spin(&from, &to), deviation, reach);
    if symmetry == Symmetry::Revolved {
        let deviation = path.motion.deviation(start, end, unscaled);
        let deviation = path.scaled(deviation, &from.tip(), reach);
        let revolved = Span::new(Motion::new(&from, &to), deviation, reach);
        // Both bound the travel of the same true motion, whichever approximates it better.
        let max_travel = span.max_travel.min(revolved.max_travel);
        if span.motion.is_err() || revolved.deviation < span.deviation {
            span = revolved;
        }
        span.max_travel = max_travel;
    }
    span
}

impl Span {
    fn new(motion: Result<Motion, MotionError>, deviation: f64, reach: f64) -> Span {
        let max_travel = match &motion {
            // A point may deviate at both ends of its way.
            Ok(motion) => motion.max_speed(reach) + 2.0 * deviation,
            Err(_) => f64::INFINITY,
        };
        Span { motion, deviation, max_travel }
    }
}

/// A joint motion of a tool, as its check takes it.
pub(super) struct JointTrajectory<'a> {
    path: &'a JointPath,
    symmetry: Symmetry,
    /// Bound on the error of a point of the tool.
    error: f64,
}

impl JointTrajectory<'_> {
    /// Takes a path for the points within `reach` of the tip.
    pub(super) fn new(path: &JointPath, symmetry: Symmetry, reach: f64) -> JointTrajectory<'_> {
        JointTrajectory { path, symmetry, error: path.error(reach) }
    }
}

impl Trajectory for JointTrajectory<'_> {
    fn pose(&self, at: f64) -> Pose {
        self.path.pose(at)
    }

    fn approximation(&self, times: [f64; 2], reach: f64) -> Option<Approximation> {
        let Span { motion, deviation, .. } = span(self.path, times, reach, self.symmetry);
        motion.ok().map(|motion| Approximation { motion, times: [0.0, 1.0], deviation })
    }

    fn error(&self) -> f64 {
        self.error
    }

    fn max_speed(&self, reach: f64) -> f64 {
        self.path.max_speed(reach)
    }

    fn has_spin(&self) -> bool {
        true
    }
}

/// Returns the motion between two poses: about the common normal of both axes for a tool of revolution, about one
/// fixed axis for a solid.
fn between(from: &Pose, to: &Pose, symmetry: Symmetry) -> Result<Motion, MotionError> {
    match symmetry {
        Symmetry::Revolved => Motion::new(from, to),
        Symmetry::Solid { .. } => Motion::with_spin(from, to),
    }
}

/// Returns an upper bound on the distance between the places of any point of the tool within `reach` of the tip at
/// two poses. The spin of a tool of revolution does not count.
pub(super) fn displacement(from: &Pose, to: &Pose, reach: f64, symmetry: Symmetry) -> f64 {
    // A rotation by an angle a moves a point at distance d by at most 2d sin(a/2). That is the chord between the axes
    // for d = 1, and the Frobenius norm of the difference of the matrices is √2 times as large.
    let chord = match symmetry {
        Symmetry::Revolved => (to.axis() - from.axis()).norm(),
        Symmetry::Solid { .. } => {
            (to.rotation() - from.rotation()).norm() * std::f64::consts::FRAC_1_SQRT_2
        }
    };
    (to.tip() - from.tip()).norm() + chord * reach
}
