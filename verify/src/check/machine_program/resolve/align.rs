//! Alignments: the rotary axes turn until the tool stands along z of a tilted plane.

use super::super::path;
use super::super::{StepFault, UnknownCause};
use super::frame::Frame;
use super::{ANGLE_INCREMENT, Located, Resolved, Resolver, known};
use crate::gcode::{Alignment, Choice, Rotation, Rule, Step};
use crate::machine::{InverseSolution, JointMotion, Letter, Side};
use nalgebra::{Point3, Vector3};

/// Greatest angle between the tool and z of its plane, in degrees, where the program has turned the axes: angles are written to 0.001
/// degrees.
const ALIGNED: f64 = 2e-3;

impl Resolver<'_> {
    /// Resolves the rotation that aligns the tool with z of a tilted plane, with the linear joints at rest.
    pub(super) fn align(&mut self, frame: &Frame, step: &Step) -> Result<Resolved, StepFault> {
        if !step.commanded[3..].contains(&true) {
            return self.check_aligned(frame, &plane_axis(step));
        }
        let before = known(&self.joints);
        let found = match self.aligned_angles(frame, step)? {
            Located::Known(found) => found,
            Located::Unknown(cause) => return Ok(self.lose(cause)),
        };
        // The angles are known also where the way to them is not.
        let way = self.half_turn(&found);
        self.joints[3..].copy_from_slice(&found);
        let Some(found) = self.all_angles(found) else {
            return Ok(Resolved::Unknown(UnknownCause::Axis));
        };
        let Some(joints) = before else {
            return Ok(Resolved::Unknown(way.unwrap_or(self.cause)));
        };
        if self.part_position_unknown {
            return Ok(Resolved::Unknown(UnknownCause::NoPartPosition));
        }
        if frame.has_unknown_lever {
            return Ok(Resolved::Unknown(UnknownCause::NoLever));
        }
        let mut end = joints;
        end[3..].copy_from_slice(&found);
        match way {
            Some(cause) => {
                Ok(Resolved::Arrival(Box::new(path::line(&frame.chain, [end, end])?), cause))
            }
            None => self.rapid(step, &frame.chain, [joints, end]),
        }
    }

    /// Resolves a rotation about a point of the tool axis, below the tip by a distance in mm: to the angles that are stated, or to
    /// those that align the tool with z of a tilted plane.
    pub(super) fn pivot(
        &mut self,
        frame: &Frame,
        step: &Step,
        distance: f64,
    ) -> Result<Resolved, StepFault> {
        let before = known(&self.joints);
        let mut ends = [self.current_position(frame), step.end];
        let is_stated = (3..6).any(|k| step.end[k].is_some() && self.has_axis(k));
        let (found, way) = if is_stated {
            // Angles that are stated have the way of any other motion to them.
            let way = self.turn_endless(step, frame, &mut ends);
            let found = [3, 4, 5].map(|k| match ends[1][k].filter(|_| self.has_axis(k)) {
                Some(angle) => Some(angle + frame.rotary[k - 3]),
                None => Some(0.0),
            });
            (found, way)
        } else {
            match self.aligned_angles(frame, step)? {
                Located::Known(found) => (found, self.half_turn(&found)),
                Located::Unknown(cause) => return Ok(self.lose(cause)),
            }
        };
        let [a, b, c] = found;
        self.joints = [None, None, None, a, b, c];
        let Some(found) = self.all_angles(found) else {
            return Ok(Resolved::Unknown(UnknownCause::Axis));
        };
        let Some(joints) = before else {
            return Ok(Resolved::Unknown(way.unwrap_or(self.cause)));
        };
        if self.part_position_unknown {
            self.cause = UnknownCause::NoPartPosition;
            return Ok(Resolved::Unknown(self.cause));
        }
        if frame.has_unknown_lever {
            self.cause = UnknownCause::NoLever;
            return Ok(Resolved::Unknown(self.cause));
        }
        let pose = frame.chain.pose(&joints)?;
        let point = pose.tip() - distance * pose.axis();
        // The start counts so that the way to the end is that of the control.
        let start = [3, 4, 5].map(|k| match ends[0][k].filter(|_| is_stated && self.has_axis(k)) {
            Some(angle) => angle + frame.rotary[k - 3],
            None => joints[k],
        });
        let from = if way.is_some() { found } else { start };
        let motion = JointMotion::about(&frame.chain, distance, [from, found], &point)?;
        self.joints = motion.joints(1.0).map(Some);
        Ok(match way {
            Some(cause) => Resolved::Arrival(Box::new(motion), cause),
            None => Resolved::Motions(vec![(motion, 0.0)]),
        })
    }

    /// Returns the rotary joints that align the tool with z of a tilted plane, in degrees.
    fn aligned_angles(
        &mut self,
        frame: &Frame,
        step: &Step,
    ) -> Result<Located<[Option<f64>; 3]>, StepFault> {
        let near = self.joints.map(Option::unwrap_or_default);
        // The angles do not depend on the tip, whose linear joints are not those of the machine at rest.
        let chain = frame.chain.without_linear_limits();
        let mut found = chain.solutions(&Point3::origin(), &plane_axis(step), &near)?;
        match step.alignment {
            Some(Alignment::Master { is_positive }) => {
                if let Some(master) = self.master() {
                    let sign = if is_positive { 1.0 } else { -1.0 };
                    found.retain(|solution| sign * solution.joints[master] >= -ANGLE_INCREMENT);
                }
            }
            Some(Alignment::Value { is_higher }) => self.take_side(step, &mut found, is_higher),
            None => {}
        }
        if found.is_empty() || !self.is_one_choice(&found) {
            let is_known = (3..6).all(|k| self.joints[k].is_some());
            let cause = if is_known { UnknownCause::TwoPositions } else { self.cause };
            return Ok(Located::Unknown(cause));
        }
        let mut angles = self.angles(&found[0]);
        let dialect = self.setup.rules.get(Rule::Dialect);
        let is_swivel = matches!(step.alignment, Some(Alignment::Value { .. }));
        if is_swivel || matches!(dialect, Some(Choice::Heidenhain | Choice::Sinumerik)) {
            self.forget_free(frame, &found[0], &mut angles);
        }
        if dialect == Some(Choice::Heidenhain) {
            self.turn_counted(frame, step, &mut angles);
        }
        Ok(Located::Known(angles))
    }

    /// Forgets the angle of an axis about which the tool can be turned freely, unless it is 0. Heidenhain leaves it, or turns it to 0, by
    /// COORD ROT, TABLE ROT and the model; Siemens turns it to one of two positions of its own.
    fn forget_free(
        &self,
        frame: &Frame,
        solution: &InverseSolution,
        angles: &mut [Option<f64>; 3],
    ) {
        for k in (0..3).filter(|k| solution.kept[*k] && self.has_axis(*k + 3)) {
            let shown = |angle: &f64| (angle - frame.rotary[k]).rem_euclid(360.0);
            let is_zero = |angle: &f64| shown(angle).min(360.0 - shown(angle)) < ANGLE_INCREMENT;
            angles[k] = angles[k].filter(is_zero);
        }
    }

    /// Gives aligned angles the turns by which Heidenhain gets there. It turns an axis as to a programmed angle: one with limits to an angle
    /// from -180 to 180 degrees (iTNC 530, PLANE SPATIAL, examples of SEQ), one without by its rule. An angle below 0 is forgotten where
    /// the axis counts on and stands beyond half a turn: whether the control means it or the same place a turn higher is not stated.
    fn turn_counted(&mut self, frame: &Frame, step: &Step, angles: &mut [Option<f64>; 3]) {
        for (k, angle) in angles.iter_mut().enumerate() {
            let (Some(from), Some(to)) = (self.joints[k + 3], *angle) else { continue };
            if self.endless[k] && step.state.shorter_way {
                continue;
            }
            let origin = frame.rotary[k];
            let shown = (to - origin).rem_euclid(360.0);
            let is_positive = shown <= 180.0 + ANGLE_INCREMENT;
            let counted = origin + if is_positive { shown } else { shown - 360.0 };
            if !self.endless[k] {
                let ends = [counted, counted + 360.0, counted - 360.0];
                *angle = ends.into_iter().find(|end| self.is_within_limits(k + 3, *end));
                continue;
            }
            let within = from + shown - (from - origin).rem_euclid(360.0);
            let is_same = |end: f64| (end - within).abs() < ANGLE_INCREMENT;
            // Half a turn is known neither way.
            let is_half = (to - from).abs() >= 180.0 - ANGLE_INCREMENT;
            if is_positive && is_same(counted) && (is_same(to) || is_half) {
                *angle = Some(within);
                continue;
            }
            *angle = match self.ask(Rule::Rotary, step) {
                Some(Choice::Shortest) => *angle,
                Some(Choice::WithinTurn) => Some(within),
                _ => Some(counted).filter(|_| is_positive || (from - origin).abs() <= 180.0),
            };
        }
    }

    /// Returns whether the limits of an axis allow a position, if it has any.
    fn is_within_limits(&self, axis: usize, position: f64) -> bool {
        let axis = self.machine.axis(Letter::ALL[axis]);
        axis.and_then(|axis| axis.limits).is_none_or(|[low, high]| {
            (low - ANGLE_INCREMENT..=high + ANGLE_INCREMENT).contains(&position)
        })
    }

    /// Returns the rotary joints of a solution. One that any value solves keeps its own, also if that is unknown.
    pub(super) fn angles(&self, solution: &InverseSolution) -> [Option<f64>; 3] {
        [0, 1, 2].map(|k| match solution.kept[k] && self.has_axis(k + 3) {
            true => self.joints[k + 3],
            false => Some(solution.joints[k + 3]),
        })
    }

    /// Returns the angles, if all are known. If not, later motions are unknown for this cause.
    fn all_angles(&mut self, angles: [Option<f64>; 3]) -> Option<[f64; 3]> {
        if angles.contains(&None) {
            self.cause = UnknownCause::Axis;
        }
        let [a, b, c] = angles;
        Some([a?, b?, c?])
    }

    /// Refuses angles of the rotary axes at which the tool does not stand along z of a plane.
    fn check_aligned(&self, frame: &Frame, axis: &Vector3<f64>) -> Result<Resolved, StepFault> {
        let mut joints = self.joints;
        joints[..3].fill(Some(0.0));
        let Some(joints) = known(&joints) else { return Ok(Resolved::Unknown(self.cause)) };
        let pose = frame.chain.without_linear_limits().pose(&joints)?;
        let degrees = 2.0 * (0.5 * (pose.axis() - axis).norm()).asin().to_degrees();
        if degrees > ALIGNED {
            return Err(StepFault::NotAligned { degrees });
        }
        Ok(Resolved::Motions(Vec::new()))
    }

    /// Keeps the solutions with the lower or the higher value of the reference axis of CYCLE800, of those that are within limits. An axis
    /// without limits counts from 0 to 360 degrees.
    fn take_side(&mut self, step: &Step, found: &mut Vec<InverseSolution>, is_higher: bool) {
        let is_other = |one: &InverseSolution, other: &InverseSolution| {
            (3..6).any(|k| (one.joints[k] - other.joints[k]).abs() > ANGLE_INCREMENT)
        };
        if !found.iter().any(|solution| is_other(solution, &found[0])) {
            return;
        }
        let choice = self.ask(Rule::SwivelAxis, step);
        let mut axes = (3..6).filter(|k| self.has_axis(*k));
        let axis = match choice {
            Some(Choice::SecondAxis) => axes.nth(1),
            _ => axes.next(),
        };
        let Some(axis) = axis else { return };
        let value = |solution: &InverseSolution| {
            let angle = solution.joints[axis];
            let angle = if self.endless[axis - 3] { angle.rem_euclid(360.0) } else { angle };
            if is_higher { angle } else { -angle }
        };
        let greatest = found.iter().map(value).fold(f64::NEG_INFINITY, f64::max);
        found.retain(|solution| value(solution) >= greatest - ANGLE_INCREMENT);
    }

    /// Returns the index of the master axis of Heidenhain: the first rotary axis from the tool, or the last one from the table.
    fn master(&self) -> Option<usize> {
        // Axes are in order from the base outwards.
        self.rotary(Side::Tool).last().or_else(|| self.rotary(Side::Table).next())
    }

    /// Returns the cause for which the way to rotary joints is not known: if one of them is half a turn away, and the limits of its axis
    /// allow both ways.
    pub(super) fn half_turn(&self, rotary: &[Option<f64>]) -> Option<UnknownCause> {
        let mut axes = self.machine.axes().iter().filter(|axis| axis.letter.is_rotary());
        let is_half = axes.any(|axis| {
            let k = axis.letter.index();
            let Some((from, to)) = self.joints[k].zip(rotary[k - 3]) else { return false };
            let other = to - 360.0_f64.copysign(to - from);
            ((to - from).abs() - 180.0).abs() <= ANGLE_INCREMENT && self.is_within_limits(k, other)
        });
        is_half.then_some(UnknownCause::HalfTurn)
    }

    /// Returns whether all controls take the first of some solutions: where no other one turns a rotary axis by less, and the
    /// axes are known.
    pub(super) fn is_one_choice(&self, solutions: &[InverseSolution]) -> bool {
        let [first, others @ ..] = solutions else { return true };
        let turn = |of: &InverseSolution, k: usize| Some((of.joints[k] - self.joints[k]?).abs());
        let mut others = others.iter().filter(|other| {
            (3..6).any(|k| (first.joints[k] - other.joints[k]).abs() > ANGLE_INCREMENT)
        });
        // Controls take the least sum of turns, or the least turn of the first axis. Both are the first solution if it turns no axis
        // by more than another does.
        others.all(|other| {
            let mut is_less = false;
            for turns in (3..6).map(|k| turn(first, k).zip(turn(other, k))) {
                match turns {
                    Some((first, other)) if first <= other + ANGLE_INCREMENT => {
                        is_less |= first < other - ANGLE_INCREMENT;
                    }
                    _ => return false,
                }
            }
            // By equal turns Fanuc takes the axes nearer to 0.
            is_less
        })
    }
}

/// Returns z of the tilted plane of a step, in the frame of the part; z itself without one.
fn plane_axis(step: &Step) -> Vector3<f64> {
    match &step.state.rotation {
        Rotation::Tilted { frame, .. } => frame.rotation.column(2).into_owned(),
        Rotation::Off | Rotation::Plane { .. } => Vector3::z(),
    }
}
