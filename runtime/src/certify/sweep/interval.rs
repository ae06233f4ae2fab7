//! An interval of a trajectory: the part's positions in the tool's frame, and bounds on how far its paths are from
//! straight.

use crate::certify::bounds::descent::Displacement;
use crate::certify::search::QuerySetting;
use crate::certify::space::Point;
use crate::certify::trajectory::{Approximation, Trajectory};
use crate::certify::triangle::SubTriangle;
use crate::pose::Pose;
use nalgebra::{Matrix3, Vector3};

/// An interval of a trajectory, in the tool's frame and unit. Positions are those of the approximating motion.
pub(crate) struct MotionInterval {
    pub(crate) from: f64,
    to: f64,
    /// The tip at the beginning of the motion, relative to the part's origin, in the part's frame and unit.
    start: Vector3<f64>,
    pub(crate) poses: [Pose; 3],
    /// The tool's frame at the start, the middle and the end of the interval.
    views: [MovedFrame; 3],
    /// Bounds on the displacement of a point from the middle of the interval, and on the deviation of its path from
    /// straight.
    bounds: MotionBounds,
    /// The axis of the rotation, in the tool's frame.
    axis: Vector3<f64>,
    /// A bound on the rounding of the tips of the poses, which are as large as their world coordinates, in the tool's unit.
    tip_error: f64,
}

/// The tool's frame at one time.
struct MovedFrame {
    /// The displacement of the tip since the beginning of the motion.
    displacement: Vector3<f64>,
    /// The rotation and scale from the part's frame and unit to the tool's.
    back: Matrix3<f64>,
}

#[derive(Clone, Copy)]
struct MotionBounds {
    /// The translation from the middle to the end.
    straight: [f64; 3],
    length: f64,
    turn: f64,
    /// The largest relevant distance of a point from the axis of the rotation.
    reach: f64,
    /// Bound on the distance of the trajectory from the approximating motion.
    deviation: f64,
}

impl MotionInterval {
    /// Creates the interval `[from, to]` of a trajectory, unless it is too long for an approximation. Points farther from
    /// the tool than `required_clearance` are irrelevant.
    pub(crate) fn new(
        setting: &QuerySetting<'_>,
        trajectory: &dyn Trajectory,
        [from, to]: [f64; 2],
        required_clearance: f64,
    ) -> Option<MotionInterval> {
        // No point of the tool is farther from its tip than √2 of its size.
        let near = 1.5 * setting.size + required_clearance;
        let Approximation { motion, times: [start, end], deviation } =
            trajectory.approximation([from, to], near * setting.length)?;
        let per_length = 1.0 / setting.length;
        let parts = [start, start / 2.0 + end / 2.0, end];
        // The middle halves the displacement: bounds hold from there to both ends.
        let poses = parts.map(|part| motion.pose(part));
        let views = [0, 1, 2].map(|k| MovedFrame {
            displacement: motion.displacement() * parts[k],
            back: poses[k].rotation().transpose() * per_length,
        });
        let half = 0.5 * (end - start);
        let straight = views[1].back * motion.displacement() * half;
        let (length, turn) = (straight.norm(), motion.angle() * half);
        let deviation = deviation * per_length;
        // A rotation preserves the distance from the tip, so a point that comes that near is never farther away in
        // this interval.
        let reach = near + 2.0 * length + deviation;
        Some(MotionInterval {
            from,
            to,
            start: motion.start() - setting.bvh.frame.origin,
            poses,
            views,
            bounds: MotionBounds { straight: straight.into(), length, turn, reach, deviation },
            axis: motion.rotation_axis(),
            tip_error: 2.0
                * f64::EPSILON
                * (motion.start().coords.norm() + motion.displacement().norm())
                * per_length,
        })
    }

    /// Returns a corner of the part, given relative to the part's origin, at the start, the middle and the end.
    pub(crate) fn transformed(&self, corner: &Point) -> [Point; 3] {
        let from_start = Vector3::from(*corner) - self.start;
        self.views.each_ref().map(|view| (view.back * (from_start - view.displacement)).into())
    }

    /// Returns a corner of the part, given as before, in the middle.
    pub(crate) fn in_the_middle(&self, corner: &Point) -> Point {
        let MovedFrame { displacement, back } = &self.views[1];
        (back * (Vector3::from(*corner) - self.start - displacement)).into()
    }

    /// Returns whether a piece comes near enough to be relevant.
    pub(crate) fn reaches(&self, piece: &SubTriangle, length: f64) -> bool {
        let (centre, reach) = piece.ball();
        let far = (Vector3::from(centre) - self.start - self.views[1].displacement).norm();
        far - reach <= length * self.bounds.reach
    }

    /// Returns the largest distance of the corners from the axis of the rotation.
    pub(crate) fn rotation_radius(&self, corners: &[Point; 3]) -> f64 {
        let [u, v, w] = [self.axis.x, self.axis.y, self.axis.z];
        corners
            .iter()
            .map(|&[x, y, z]| {
                let [a, b, c] = [w * y - v * z, u * z - w * x, v * x - u * y];
                c * c + b * b + a * a
            })
            .fold(0.0, f64::max)
            .sqrt()
    }

    /// Returns whether the tool rotates.
    pub(crate) fn rotates(&self) -> bool {
        self.bounds.turn > 0.0
    }

    /// Returns a bound on the distance of the trajectory from the approximating motion.
    pub(crate) fn deviation(&self) -> f64 {
        self.bounds.deviation
    }

    pub(crate) fn middle(&self) -> f64 {
        self.from / 2.0 + self.to / 2.0
    }

    /// Returns a bound on how far a path is from straight, for a point whose distance from the axis of the rotation
    /// is at most `radius` in the middle of the interval. [`Displacement::deviation_bound`] is the same in `f32`.
    pub(crate) fn deviation_bound(&self, radius: f64) -> f64 {
        let MotionBounds { length, turn, deviation, .. } = self.bounds;
        // Theorem 4 of `docs/certified.md`: ½ h² (2 ω v + ω² ρ), with `turn` for h ω and `length` for h v. During the
        // interval ρ grows by at most the length. The true point is within the deviation of the approximating motion's.
        turn * (length + 0.5 * turn * self.bounds.reach.min(radius + length)) + deviation
    }

    /// Returns a bound on the displacement of such a point from the middle of the interval.
    pub(crate) fn displacement_bound(&self, radius: f64) -> f64 {
        let MotionBounds { length, turn, .. } = self.bounds;
        length + turn * radius.min(self.bounds.reach) + self.deviation_bound(radius)
    }

    /// Returns the displacement in `f32`, rounded up, and the distance to be kept. Heights are compared without the margin of
    /// bounds, so that both have to reach beyond the rounding of coordinates as far away, and of the poses from which these are
    /// computed.
    pub(crate) fn shift(&self, required_clearance: f64) -> Displacement {
        let MotionBounds { straight, length, turn, reach, deviation } = self.bounds;
        Displacement {
            axis: self.axis.map(|part| part as f32).into(),
            translation: straight.map(rounded_up),
            length: rounded_up(length),
            clearance: rounded_up(required_clearance),
            turn: rounded_up(turn),
            reach: rounded_up(reach),
            deviation: rounded_up(deviation + self.tip_error),
        }
    }
}

/// The part by which a length is enlarged before it is rounded to `f32`: 16 units of roundoff. A coordinate errs by less than 8.
const F32_MARGIN: f64 = 1e-6;

/// Returns a length or an angle in `f32`, larger in magnitude by [`F32_MARGIN`].
fn rounded_up(value: f64) -> f32 {
    (value * (1.0 + F32_MARGIN)) as f32
}
