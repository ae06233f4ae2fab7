//! Motions between two blocks of a program: rotary joints linear in time, together with linear joints or with
//! the tip.

use super::chain::{Chain, Relation, RoundingBound, UNIT_ROUNDOFF, check_length, is_within};
use super::{JointError, Joints, Letter};
use nalgebra::{Matrix3, Point3, Vector3};
use touchoff::{Motion, MotionError, Pose};

/// The motion of a machine between two blocks: what the control interpolates from t = 0 to 1.
///
/// Rotary joints r(t) = (1 − t) r₀ + t r₁ are linear in time. The path is that of the linear joints
/// ([`JointMotion::new`]), or that of the tip in the frame of the workpiece ([`JointMotion::with_tcp`]), or another point of the tool
/// axis rests there ([`JointMotion::about`]).
/// Poses are relative to the workpiece, or to another body of the machine ([`JointMotion::relative_to`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointMotion {
    /// The chain of the workpiece, in whose frame a path of the tip is.
    pub(super) chain: Chain,
    /// With TCP, the chain to the point that is on the path: the tip, or another point of the tool axis.
    pub(super) guide: Chain,
    /// The chain of the body to which poses are relative.
    pub(super) body: Chain,
    pub(super) related: Related,
    /// Rotary joints at t = 0 and 1, in degrees.
    ends: [[f64; 3]; 2],
    pub(super) path: PreparedPath,
    /// Set if the path is that of the tip, or of another point of the tool axis.
    pub(super) tcp: bool,
    /// Bounds on the error of poses.
    pub(super) rounding: RoundingBound,
    /// Bound on the error of a position at any place in the chain, in mm.
    pub(super) position_error: f64,
}

/// The bodies that the poses of a joint motion relate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Related {
    /// The tool and the workpiece.
    Workpiece,
    /// The tool and a link of the table.
    TableLink,
    /// Any two bodies.
    Bodies,
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

    /// Creates a motion of the rotary axes about a point of the tool axis, while the linear joints follow: the point that is below the
    /// tip by `distance`, in mm, rests at `point` in the frame of the workpiece. `rotary` has the joint values of A, B and C at t = 0
    /// and 1, in degrees.
    ///
    /// # Errors
    /// As [`JointMotion::with_tcp`], and if the distance is out of range.
    pub fn about(
        chain: &Chain,
        distance: f64,
        rotary: [[f64; 3]; 2],
        point: &Point3<f64>,
    ) -> Result<JointMotion, JointError> {
        let guide = chain.below_tip(distance)?;
        let point = [point.x, point.y, point.z];
        let path = LinearPath::Line { start: point, end: point };
        let motion = JointMotion::with_tcp(&guide, rotary, &path)?;
        // The tip is found from the joints: only the point of the guide is on the path.
        let related = if distance == 0.0 { Related::Workpiece } else { Related::Bodies };
        let mut motion = JointMotion { chain: *chain, body: *chain, related, ..motion };
        motion.set_rounding();
        Ok(motion)
    }

    /// Returns the same motion of the axes with another tool in the spindle, whose tip need not be on the path.
    pub(crate) fn with_tool(&self, chain: &Chain) -> JointMotion {
        let mut motion =
            JointMotion { chain: *chain, body: *chain, related: Related::Bodies, ..*self };
        motion.set_rounding();
        motion
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
            guide: *chain,
            body: *chain,
            related: Related::Workpiece,
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
        let body = self.chain.relative_to(link)?;
        let related = match self.related {
            Related::Bodies => Related::Bodies,
            Related::Workpiece | Related::TableLink => Related::TableLink,
        };
        let mut motion = JointMotion { body, related, ..*self };
        motion.set_rounding();
        Ok(motion)
    }

    /// Returns the motion of a body of the machine relative to another one.
    pub(crate) fn between(&self, relation: &Relation) -> JointMotion {
        let body = relation.of(&self.chain);
        let mut motion = JointMotion { body, related: Related::Bodies, ..*self };
        motion.set_rounding();
        motion
    }

    /// Returns the pose of the tool at a time from 0 to 1, in mm. Times outside are clamped to the nearer
    /// end. [`JointMotion::rounding`] bounds the error.
    ///
    /// # Panics
    /// Panics if the time is NaN.
    pub fn pose(&self, t: f64) -> Pose {
        let t = checked_time(t);
        let mut joints = self.rotary(t);
        // The tip is on its path, without the rounding of the kinematics.
        if self.tcp && self.related == Related::Workpiece {
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

    /// Returns a lower bound of the joint value of Z, in mm; `None` for a path of the tip that bends or on which axes turn.
    pub(crate) fn lowest_z(&self) -> Option<f64> {
        match &self.path.arc {
            arc if self.tcp && (arc.is_some() || self.ends[0] != self.ends[1]) => None,
            None => Some(self.joints(0.0)[2].min(self.joints(1.0)[2])),
            Some(arc) => {
                // The centre is at both ends of the prepared path.
                let [_, _, normal] = arc.indices;
                let radius = if normal == 2 { 0.0 } else { arc.radius() };
                Some(self.path.start.z.min(self.path.end.z) - radius)
            }
        }
    }

    /// Returns the values of a rotary axis at t = 0 and 1, in degrees.
    pub(super) fn rotary_ends(&self, letter: Letter) -> [f64; 2] {
        self.ends.map(|values| values[letter.index() - 3])
    }

    /// Returns joint values with the rotary ones of a time, and the linear ones at 0. The values at both ends
    /// are those that were given.
    fn rotary(&self, t: f64) -> Joints {
        let [start, end] = &self.ends;
        let [a, b, c] = [0, 1, 2].map(|k| (1.0 - t) * start[k] + t * end[k]);
        [0.0, 0.0, 0.0, a, b, c]
    }

    /// Sets the linear joint values of a time.
    fn fill_linear(&self, t: f64, joints: &mut Joints) {
        let position = self.path.at(t);
        let linear = if self.tcp {
            self.guide.follow(&self.guide.turns(joints), &position)
        } else {
            position
        };
        joints[..3].copy_from_slice(linear.as_slice());
    }

    /// Returns the linear joint values of a time, in mm.
    pub(super) fn linear(&self, t: f64) -> Vector3<f64> {
        let mut joints = self.rotary(t);
        self.fill_linear(t, &mut joints);
        Vector3::new(joints[0], joints[1], joints[2])
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
        let follow = self.guide.rounding_at(reach).tip + angles * self.guide.size(reach);
        let linear = if self.tcp { self.guide.size(reach) } else { reach };
        let pose = self.body.rounding_at(linear);
        let placed = pose.tip + angles * self.body.size(linear);
        let tip = match (self.tcp, self.related) {
            // The tip is the path itself.
            (true, Related::Workpiece) => 0.0,
            (true, Related::TableLink | Related::Bodies) => follow + placed,
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

    /// Returns the rotation matrices of the body's chain at a time.
    pub(super) fn body_turns(&self, t: f64) -> [Matrix3<f64>; 2] {
        self.body.turns(&self.rotary(t))
    }
}

/// Clamps a time to the motion.
pub(super) fn checked_time(t: f64) -> f64 {
    assert!(!t.is_nan(), "NaN is no time of a motion: give a number from 0 to 1");
    t.clamp(0.0, 1.0)
}

/// Largest magnitude of a coordinate of an arc's centre, in mm. Rounding is below 1e-5 mm then.
const MAX_CENTRE: f64 = 1e9;

/// Largest magnitude of an arc's sweep, in radians: some 1,600 turns.
const MAX_SWEEP: f64 = 1e4;

/// The plane of an arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Plane {
    /// G17: first coordinate x, second y, normal +z.
    Xy,
    /// G18: first coordinate z, second x, normal +y.
    Zx,
    /// G19: first coordinate y, second z, normal +x.
    Yz,
}

impl Plane {
    /// Returns the indices of the first and the second coordinate (x is 0).
    pub const fn axes(self) -> [usize; 2] {
        let [first, second, _] = self.indices();
        [first, second]
    }

    /// Returns the index of the normal (x is 0).
    pub const fn normal(self) -> usize {
        let [_, _, normal] = self.indices();
        normal
    }

    /// Returns the indices of the first and the second coordinate and of the normal.
    const fn indices(self) -> [usize; 3] {
        match self {
            Plane::Xy => [0, 1, 2],
            Plane::Zx => [2, 0, 1],
            Plane::Yz => [1, 2, 0],
        }
    }
}

/// The path of the linear joints or of the tip between two blocks, at a constant rate from t = 0 to 1. In mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinearPath {
    /// A straight line.
    Line {
        /// The position at t = 0.
        start: [f64; 3],
        /// The position at t = 1.
        end: [f64; 3],
    },
    /// A helical arc.
    ///
    /// Let R(φ) be the rotation of the plane by φ, a = start − centre and b = end − centre in it. The
    /// position is centre + R(t · sweep) ((1 − t) a + t R(−sweep) b): an arc if the sweep is that from a to b
    /// and both are as long, a spiral if their lengths differ a little, as controls allow. Along the plane's
    /// normal it is a line.
    Arc {
        /// The position at t = 0.
        start: [f64; 3],
        /// The position at t = 1.
        end: [f64; 3],
        /// The plane.
        plane: Plane,
        /// The centre: its first and second coordinate in the plane.
        centre: [f64; 2],
        /// Signed angle in radians, positive from the plane's first coordinate towards its second (G3). Its
        /// magnitude is above 2π for more than a turn.
        sweep: f64,
    },
}

impl LinearPath {
    /// Returns the path, moved by a displacement in mm: that of [`Setup::shift`](super::Setup::shift), for
    /// instance.
    #[must_use]
    pub fn translated(self, displacement: [f64; 3]) -> LinearPath {
        match self {
            LinearPath::Line { start, end } => {
                LinearPath::Line { start: sum(start, displacement), end: sum(end, displacement) }
            }
            LinearPath::Arc { start, end, plane, centre, sweep } => {
                let [first, second, _] = plane.indices();
                let centre = [centre[0] + displacement[first], centre[1] + displacement[second]];
                LinearPath::Arc {
                    start: sum(start, displacement),
                    end: sum(end, displacement),
                    plane,
                    centre,
                    sweep,
                }
            }
        }
    }
}

fn sum(position: [f64; 3], displacement: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| position[k] + displacement[k])
}

/// A path, prepared for evaluation: p(t) = (1 − t) start + t end + [R(t · sweep) (arm + t · arm_rate)] in the
/// plane of an arc, where start and end are at its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PreparedPath {
    start: Vector3<f64>,
    end: Vector3<f64>,
    arc: Option<Arc>,
    /// Largest magnitude of a coordinate's terms, for rounding.
    size: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Arc {
    indices: [usize; 3],
    sweep: f64,
    arm: [f64; 2],
    arm_rate: [f64; 2],
}

/// Bounds on the first and second derivative of a path by t, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Derivatives {
    pub(super) speed: f64,
    pub(super) acceleration: f64,
}

impl PreparedPath {
    /// Checks and prepares a path.
    fn new(path: &LinearPath) -> Result<PreparedPath, JointError> {
        let (LinearPath::Line { start, end } | LinearPath::Arc { start, end, .. }) = *path;
        for (letter, value) in Letter::ALL.iter().zip(start).chain(Letter::ALL.iter().zip(end)) {
            check_length(&letter.to_string(), value)?;
        }
        let (start, end) = (Vector3::from(start), Vector3::from(end));
        let size = start.norm().max(end.norm());
        let LinearPath::Arc { plane, centre, sweep, .. } = *path else {
            return Ok(PreparedPath { start, end, arc: None, size });
        };
        for value in centre {
            // The limit of positions is not that of a centre: shallow arcs have radii of kilometres.
            if !is_within(value, MAX_CENTRE) {
                let what = "the centre of the arc".to_owned();
                return Err(JointError::Range { what, value, limit: MAX_CENTRE });
            }
        }
        if !is_within(sweep, MAX_SWEEP) {
            let what = "the sweep of the arc in radians".to_owned();
            return Err(JointError::Range { what, value: sweep, limit: MAX_SWEEP });
        }
        let indices @ [first, second, _] = plane.indices();
        let arm = [start[first] - centre[0], start[second] - centre[1]];
        let last = rotated(-sweep, [end[first] - centre[0], end[second] - centre[1]]);
        // The centre moves along the normal, from the height of the start to that of the end.
        let on_axis = |position: Vector3<f64>| {
            let mut foot = position;
            (foot[first], foot[second]) = (centre[0], centre[1]);
            foot
        };
        let (start, end) = (on_axis(start), on_axis(end));
        let arc = Arc { indices, sweep, arm, arm_rate: [last[0] - arm[0], last[1] - arm[1]] };
        let size = size + start.norm().max(end.norm()) + arc.radius();
        Ok(PreparedPath { start, end, arc: Some(arc), size })
    }

    /// Returns the position, in mm.
    pub(super) fn at(&self, t: f64) -> Vector3<f64> {
        let mut position = (1.0 - t) * self.start + t * self.end;
        if let Some(arc) = &self.arc {
            let arm = [0, 1].map(|k| arc.arm[k] + t * arc.arm_rate[k]);
            let arm = rotated(t * arc.sweep, arm);
            position[arc.indices[0]] += arm[0];
            position[arc.indices[1]] += arm[1];
        }
        position
    }

    /// Returns bounds on the derivatives. For an arc with sweep s, arm a + t a' and rate v along the normal,
    /// p' = R (s J (a + t a') + a') + v and p'' = R (2 s J a' − s² (a + t a')), with J a quarter turn.
    pub(super) fn derivatives(&self) -> Derivatives {
        let rate = (self.end - self.start).norm();
        let Some(arc) = &self.arc else {
            return Derivatives { speed: rate, acceleration: 0.0 };
        };
        let (sweep, arm_rate) = (arc.sweep.abs(), arc.arm_rate[0].hypot(arc.arm_rate[1]));
        let radius = arc.radius();
        Derivatives {
            speed: (sweep * radius + arm_rate).hypot(rate),
            acceleration: sweep * (sweep * radius + 2.0 * arm_rate),
        }
    }

    /// Returns the largest norm of a position, in mm.
    fn reach(&self) -> f64 {
        self.size
    }

    /// Returns a bound on the error of [`PreparedPath::at`] relative to the formula of [`LinearPath`], in mm.
    ///
    /// With u = 2⁻⁵³ and the size P of the path: a line errs by 4u P, and its ends are exact. The arm of an
    /// arc errs by u |sweep| from its angle, 3u from sine and cosine, 3u from the product, twice as much from
    /// its end, and 3u from the sums: 24u in all and 2u |sweep|, relative to P.
    fn rounding(&self) -> f64 {
        let arc = self.arc.map_or(0.0, |arc| 24.0 + 2.0 * arc.sweep.abs());
        (6.0 + arc) * UNIT_ROUNDOFF * self.size
    }
}

impl Arc {
    /// Returns the largest length of the arm, which is at an end.
    fn radius(&self) -> f64 {
        let end = [0, 1].map(|k| self.arm[k] + self.arm_rate[k]);
        self.arm[0].hypot(self.arm[1]).max(end[0].hypot(end[1]))
    }
}

/// Rotates a vector of the plane by an angle in radians.
fn rotated(angle: f64, [first, second]: [f64; 2]) -> [f64; 2] {
    let (sine, cosine) = angle.sin_cos();
    [cosine * first - sine * second, sine * first + cosine * second]
}
