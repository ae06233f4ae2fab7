//! Motions between two blocks of a program: rotary joints linear in time, together with linear joints or with
//! the tip.

use super::chain::{Chain, RoundingBound, UNIT_ROUNDOFF};
use super::path::{LinearPath, PreparedPath};
use super::{JointError, Joints, Letter};
use nalgebra::{Matrix3, Point3};
use touchoff::{Motion, MotionError, Pose};

/// The motion of a machine between two blocks: what the control interpolates from t = 0 to 1.
///
/// Rotary joints r(t) = (1 − t) r₀ + t r₁ are linear in time. The path is that of the linear joints
/// ([`JointMotion::new`]), or that of the tip in the frame of the workpiece ([`JointMotion::with_tcp`]).
/// Poses are relative to the workpiece, or to another body of the machine ([`JointMotion::relative_to`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointMotion {
    /// The chain of the workpiece, in whose frame a path of the tip is.
    pub(super) chain: Chain,
    /// The chain of the body to which poses are relative.
    pub(super) body: Chain,
    /// Rotary joints at t = 0 and 1, in degrees.
    ends: [[f64; 3]; 2],
    pub(super) path: PreparedPath,
    /// Set if the path is that of the tip.
    pub(super) tcp: bool,
    /// Bounds on the error of poses.
    pub(super) rounding: RoundingBound,
    /// Bound on the error of a position at any place in the chain, in mm.
    pub(super) position_error: f64,
}

impl JointMotion {
    /// Creates a motion without TCP: the path is that of the linear joints. `rotary` has the joint values of
    /// A, B and C at t = 0 and 1, in degrees.
    ///
    /// # Errors
    /// If a value is out of range, or of a rotary axis that the machine lacks.
    pub fn new(
        chain: &Chain,
        rotary: [[f64; 3]; 2],
        path: &LinearPath,
    ) -> Result<JointMotion, JointError> {
        JointMotion::build(chain, rotary, path, false)
    }

    /// Creates a motion with TCP: the path is that of the tip in the frame of the workpiece, and the linear
    /// joints follow. `rotary` has the joint values of A, B and C at t = 0 and 1, in degrees.
    ///
    /// # Errors
    /// As [`JointMotion::new`], and if the chain is that of a body that not all linear axes move.
    ///
    /// ```
    /// use touchoff_verify::machine::{JointMotion, LinearPath, Machine, Setup};
    ///
    /// let machine = Machine::named("A-C trunnion")?;
    /// let setup = Setup { work_offset: [0.0, 0.0, -450.0, 0.0, 0.0, 0.0], tool_length: 120.0 };
    /// let path = LinearPath::Line { start: [10.0, 0.0, 0.0], end: [50.0, 0.0, 0.0] };
    /// let rotary = [[0.0, 0.0, 0.0], [-30.0, 0.0, 90.0]];
    /// let motion = JointMotion::with_tcp(&machine.chain(&setup)?, rotary, &path)?;
    /// assert_eq!(motion.pose(0.5).tip().x, 30.0);
    /// // The tip stays on the line, so only the tool axis deviates, in proportion to the square of the time.
    /// assert!(motion.deviation(0.0, 0.1, 100.0) < 0.3);
    /// assert!(motion.deviation(0.0, 0.01, 100.0) < 0.003);
    /// assert!(motion.check_limits().is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_tcp(
        chain: &Chain,
        rotary: [[f64; 3]; 2],
        path: &LinearPath,
    ) -> Result<JointMotion, JointError> {
        chain.check_slides()?;
        JointMotion::build(chain, rotary, path, true)
    }

    fn build(
        chain: &Chain,
        rotary: [[f64; 3]; 2],
        path: &LinearPath,
        tcp: bool,
    ) -> Result<JointMotion, JointError> {
        for [a, b, c] in rotary {
            chain.check(&[0.0, 0.0, 0.0, a, b, c])?;
        }
        let mut motion = JointMotion {
            chain: *chain,
            body: *chain,
            ends: rotary,
            path: PreparedPath::new(path)?,
            tcp,
            rounding: RoundingBound { tip: 0.0, rotation: 0.0 },
            position_error: 0.0,
        };
        motion.set_rounding();
        Ok(motion)
    }

    /// Returns the same motion with poses relative to a link of the table side, as [`Chain::relative_to`]
    /// numbers them: for bodies of the machine such as a trunnion.
    ///
    /// # Errors
    /// [`JointError::NoLink`] if the link is beyond that of the workpiece.
    pub fn relative_to(&self, link: usize) -> Result<JointMotion, JointError> {
        let mut motion = JointMotion { body: self.chain.relative_to(link)?, ..*self };
        motion.set_rounding();
        Ok(motion)
    }

    /// Returns the pose of the tool at a time from 0 to 1, in mm. Times outside are clamped to the nearer
    /// end. [`JointMotion::rounding`] bounds the error.
    ///
    /// # Panics
    /// Panics if the time is NaN.
    pub fn pose(&self, t: f64) -> Pose {
        let t = checked_time(t);
        let mut joints = self.rotary(t);
        if self.tcp && self.body == self.chain {
            let turns = self.chain.turns(&joints);
            return Pose::from_computed(self.chain.rotation(&turns), Point3::from(self.path.at(t)));
        }
        self.fill_linear(t, &mut joints);
        self.body.place(&joints)
    }

    /// Returns the joint values at a time from 0 to 1, in mm and degrees. Times outside are clamped to the
    /// nearer end.
    ///
    /// # Panics
    /// Panics if the time is NaN.
    pub fn joints(&self, t: f64) -> Joints {
        let t = checked_time(t);
        let mut joints = self.rotary(t);
        self.fill_linear(t, &mut joints);
        joints
    }

    /// Returns the values of a rotary axis at t = 0 and 1, in degrees.
    pub(super) fn rotary_ends(&self, letter: Letter) -> [f64; 2] {
        self.ends.map(|values| values[letter.index() - 3])
    }

    /// Returns joint values with the rotary ones of a time, and the linear ones at 0. The values at both ends
    /// are those that were given.
    pub(super) fn rotary(&self, t: f64) -> Joints {
        let [start, end] = &self.ends;
        let [a, b, c] = [0, 1, 2].map(|k| (1.0 - t) * start[k] + t * end[k]);
        [0.0, 0.0, 0.0, a, b, c]
    }

    /// Sets the linear joint values of a time.
    fn fill_linear(&self, t: f64, joints: &mut Joints) {
        let position = self.path.at(t);
        let linear = if self.tcp {
            self.chain.follow(&self.chain.turns(joints), &position)
        } else {
            position
        };
        joints[..3].copy_from_slice(linear.as_slice());
    }

    /// Returns the motion at constant speed between the poses at two times, with the tip on a straight line
    /// and the tool axis on a great circle: that of a tool of revolution. [`JointMotion::deviation`] bounds
    /// the difference.
    ///
    /// # Errors
    /// [`MotionError::Opposite`] if both tool axes are opposite.
    ///
    /// # Panics
    /// Panics if a time is NaN.
    pub fn motion(&self, t0: f64, t1: f64) -> Result<Motion, MotionError> {
        Motion::new(&self.pose(t0), &self.pose(t1))
    }

    /// Returns the motion at constant speed between the poses at two times, with the tip on a straight line
    /// and the rotation about one axis: that of a solid. [`JointMotion::deviation_with_spin`] bounds the
    /// difference.
    ///
    /// While one rotary axis moves alone, the rotation is exact. It is therefore usually closer than
    /// [`JointMotion::motion`] for a tool of revolution, too.
    ///
    /// # Errors
    /// [`MotionError::HalfTurn`] if the rotations differ by half a turn.
    ///
    /// # Panics
    /// Panics if a time is NaN.
    pub fn motion_with_spin(&self, t0: f64, t1: f64) -> Result<Motion, MotionError> {
        Motion::with_spin(&self.pose(t0), &self.pose(t1))
    }

    /// Returns bounds on the rounding error of [`JointMotion::pose`], relative to exact kinematics of the
    /// given numbers.
    ///
    /// To the bounds of [`Chain::rounding`] come the error of the path, and that of the rotary joint values,
    /// 5u of the largest value r: a rotation of 5u r (π/180), which moves the tip by as much times the size
    /// S. With TCP, the linear joints of a pose relative to another body than the workpiece add the bound of
    /// another chain, for a size that includes them.
    pub fn rounding(&self) -> RoundingBound {
        self.rounding
    }

    fn set_rounding(&mut self) {
        let [start, end] = &self.ends;
        let greatest = start.iter().zip(end).map(|(start, end)| start.abs().max(end.abs()));
        let angles = 5.0 * UNIT_ROUNDOFF * greatest.sum::<f64>().to_radians();
        let reach = self.path.reach();
        let follow = self.chain.rounding_at(reach).tip + angles * self.chain.size(reach);
        let linear = if self.tcp { self.chain.size(reach) } else { reach };
        let pose = self.body.rounding_at(linear);
        let placed = pose.tip + angles * self.body.size(linear);
        let tip = match (self.tcp, self.body == self.chain) {
            (true, true) => 0.0,
            (true, false) => follow + placed,
            (false, _) => placed,
        };
        let path = self.path.rounding();
        self.rounding = RoundingBound { tip: path + tip, rotation: pose.rotation + angles };
        self.position_error = path + follow + placed;
    }

    /// Returns the rotation matrices of the workpiece's chain at a time.
    pub(super) fn turns(&self, t: f64) -> [Matrix3<f64>; 2] {
        self.chain.turns(&self.rotary(t))
    }
}

/// Clamps a time to the motion.
pub(super) fn checked_time(t: f64) -> f64 {
    assert!(!t.is_nan(), "NaN is no time of a motion: give a number from 0 to 1");
    t.clamp(0.0, 1.0)
}
