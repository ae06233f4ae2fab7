//! A part of a motion: where it takes the part in the tool's frame, and how straight.

use crate::certify::bounds::descent::Shift;
use crate::certify::space::Point;
use crate::certify::triangle::piece::Piece;
use crate::certify::work::Setting;
use crate::motion::Motion;
use crate::pose::Pose;
use nalgebra::{Matrix3, Vector3};

/// A part of a motion, in the tool's frame and unit.
pub(crate) struct Stretch {
    pub(crate) from: f64,
    to: f64,
    /// The tip's place at the beginning of the motion from the part's middle.
    start: Vector3<f64>,
    pub(crate) poses: [Pose; 3],
    /// At both ends and, between these, in the middle: how far the tip has come, and the way from the part's
    /// frame and unit to the tool's.
    views: [(Vector3<f64>, Matrix3<f64>); 3],
    /// How far a place goes from where it is in the middle, and how far its way is from straight, at most.
    pace: Pace,
    /// The axis of the turn, in the tool's frame.
    axis: Vector3<f64>,
}

#[derive(Clone, Copy)]
struct Pace {
    straight: [f64; 3],
    length: f64,
    turn: f64,
    /// No place that matters is farther from the axis of the turn.
    reach: f64,
}

impl Stretch {
    /// What comes no nearer to the tool than `keep` does not matter.
    pub(crate) fn new(
        setting: &Setting<'_>,
        motion: &Motion,
        [from, to]: [f64; 2],
        keep: f64,
    ) -> Stretch {
        let per_length = 1.0 / setting.length;
        let parts = [from, from / 2.0 + to / 2.0, to];
        let poses = parts.map(|part| motion.pose(part));
        let view =
            |k: usize| (motion.way() * parts[k], poses[k].rotation().transpose() * per_length);
        let views = [view(0), view(1), view(2)];
        let half = 0.5 * (to - from);
        let straight = views[1].1 * motion.way() * half;
        let (length, turn) = (straight.norm(), motion.angle() * half);
        // A turn leaves the distance from the tip as it is, so that a place that comes that near is never farther on
        // this stretch. No place of the tool is farther from its tip than √2 of its size.
        let reach = 1.5 * setting.size + keep + 2.0 * length;
        Stretch {
            from,
            to,
            start: motion.start() - setting.facets.frame.origin,
            poses,
            views,
            pace: Pace { straight: straight.abs().into(), length, turn, reach },
            axis: motion.turns_about(),
        }
    }

    /// A corner of the part, given from its middle, at the beginning, in the middle and at the end.
    pub(crate) fn seen(&self, corner: &Point) -> [Point; 3] {
        let from_start = Vector3::from(*corner) - self.start;
        let [first, middle, last] = &self.views;
        let seen = |(way, back): &(Vector3<f64>, Matrix3<f64>)| (back * (from_start - way)).into();
        [seen(first), seen(middle), seen(last)]
    }

    /// Whether a piece comes so near that it matters.
    pub(crate) fn reaches(&self, piece: &Piece, length: f64) -> bool {
        let (centre, reach) = piece.ball();
        let [_, (way, _), _] = &self.views;
        let far = (Vector3::from(centre) - self.start - way).norm();
        far - reach <= length * self.pace.reach
    }

    /// Returns how far corners are from the axis of the turn at most.
    pub(crate) fn about(&self, corners: &[Point; 3]) -> f64 {
        let [u, v, w] = [self.axis.x, self.axis.y, self.axis.z];
        let square = |&[x, y, z]: &Point| {
            let [a, b, c] = [w * y - v * z, u * z - w * x, v * x - u * y];
            c * c + b * b + a * a
        };
        corners.iter().map(square).fold(0.0, f64::max).sqrt()
    }

    /// Whether the axis turns.
    pub(crate) fn turns(&self) -> bool {
        self.pace.turn > 0.0
    }

    pub(crate) fn middle(&self) -> f64 {
        self.from / 2.0 + self.to / 2.0
    }

    /// How far the way is from straight, of a place that is in the middle no farther than that from the axis of the
    /// turn.
    pub(crate) fn curve(&self, reach: f64) -> f64 {
        let Pace { length, turn, .. } = self.pace;
        turn * (length + 0.5 * turn * self.pace.reach.min(reach + length))
    }

    /// How far such a place goes from the middle.
    pub(crate) fn goes(&self, reach: f64) -> f64 {
        let Pace { length, turn, .. } = self.pace;
        length + turn * reach.min(self.pace.reach) + self.curve(reach)
    }

    pub(crate) fn shift(&self, keep: f64) -> Shift {
        let Pace { straight, length, turn, reach } = self.pace;
        let up = |value: f64| (value * (1.0 + 1e-6)) as f32;
        Shift {
            axis: self.axis.map(|part| part as f32).into(),
            straight: straight.map(|part| up(part + keep)),
            length: up(length),
            turn: up(turn),
            reach: up(reach),
        }
    }
}
