//! Forward kinematics: the pose of the tool relative to the workpiece or to another body of the machine.

use super::{
    Axis, JointError, Joints, Letter, Link, MAX_DEGREES, MAX_LENGTH, Machine, Setup, Side,
};
use nalgebra::{Matrix3, Point3, Vector3};
use std::f64::consts::PI;
use std::ops::Range;
use touchoff::Pose;

/// The unit of the bounds on rounding: 2⁻⁵³.
pub(super) const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// The axes between a body of the machine and the tool's tip, as the formula of the [module](super) has them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chain {
    /// The rotary axes, from the body to the tool: those of the table outermost first, then those of the
    /// tool.
    axes: [RotaryAxis; 2],
    /// Number of rotary axes.
    count: usize,
    /// Set for each of A, B, C that the machine has, between the body and the tool or not.
    has_rotary: [bool; 3],
    /// Number of rotary axes of the table. The linear axes follow them.
    table: usize,
    /// 1 for each linear axis that moves the tool relative to the body, 0 for the others; −1 in a [`Relation`] in which it moves
    /// the other way.
    pub(super) slides: Vector3<f64>,
    /// For each linear axis the first link that it moves; 0 for an axis of the tool.
    slide_links: [usize; 3],
    /// The limits of all axes of the machine, infinite where there are none.
    pub(super) limits: [[f64; 2]; 6],
    pub(super) frame: Frame,
    /// The link of the table side to which poses are relative.
    pub(super) link: usize,
    /// The pose of the tool's tip frame with all axes at 0, in mm: (0, 0, −h) without a rotation, or that of another body in a
    /// [`Relation`].
    pub(super) mount: Pose,
    /// Set if the mount is turned.
    is_mount_turned: bool,
}

/// A rotary axis of a chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RotaryAxis {
    pub(super) letter: Letter,
    pub(super) direction: Vector3<f64>,
    point: Vector3<f64>,
    /// The first link that the axis moves; 0 for an axis of the tool.
    link: usize,
}

/// The frame of the workpiece in the last link: F = G(o_r) T(o). The identity for other bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    /// The rotation of G(o_r).
    pub(super) rotation: Matrix3<f64>,
    /// The translation of G(o_r).
    translation: Vector3<f64>,
    origin: Vector3<f64>,
    /// Number of rotary axes with an offset other than 0.
    turned: usize,
}

/// Bounds on the rounding error of a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundingBound {
    /// Largest error of the tip, in mm.
    pub tip: f64,
    /// Largest error of the rotation as an operator: the largest displacement of a point at distance 1 from
    /// the tip.
    pub rotation: f64,
}

impl RotaryAxis {
    /// Returns the rotation matrix at joint values.
    fn turn(&self, joints: &Joints) -> Matrix3<f64> {
        rotation(&self.direction, joints[self.letter.index()])
    }

    /// Returns the position of a point, in mm, relative to the axis's point.
    pub(super) fn arm(&self, position: &Vector3<f64>) -> Vector3<f64> {
        position - self.point
    }

    /// Rotates a point about the axis's line.
    pub(super) fn apply(&self, turn: &Matrix3<f64>, position: &Vector3<f64>) -> Vector3<f64> {
        self.point + turn * self.arm(position)
    }

    /// Rotates a point about the axis's line, backwards.
    pub(super) fn undo(&self, turn: &Matrix3<f64>, position: &Vector3<f64>) -> Vector3<f64> {
        self.point + turn.tr_mul(&self.arm(position))
    }
}

impl Frame {
    const IDENTITY: Frame = Frame {
        rotation: Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        translation: Vector3::new(0.0, 0.0, 0.0),
        origin: Vector3::new(0.0, 0.0, 0.0),
        turned: 0,
    };

    /// Maps a point from the workpiece to the last link.
    pub(super) fn to_link(self, position: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * (self.origin + position) + self.translation
    }

    /// Maps a point from the last link to the workpiece.
    fn to_workpiece(self, position: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.tr_mul(&(position - self.translation)) - self.origin
    }
}

impl Chain {
    pub(super) fn new(machine: &Machine, setup: &Setup) -> Result<Chain, JointError> {
        let filler = RotaryAxis {
            letter: Letter::A,
            direction: Vector3::x(),
            point: Vector3::zeros(),
            link: 0,
        };
        let mount = Vector3::new(0.0, 0.0, -setup.tool_length);
        let mut chain = Chain {
            axes: [filler; 2],
            count: 0,
            has_rotary: [Letter::A, Letter::B, Letter::C].map(|l| machine.axis(l).is_some()),
            table: 0,
            slides: Vector3::repeat(1.0),
            slide_links: [0; 3],
            limits: [[f64::NEG_INFINITY, f64::INFINITY]; 6],
            frame: Frame::IDENTITY,
            link: machine.axes().iter().filter(|axis| axis.side == Side::Table).count(),
            mount: Pose::from_computed(Matrix3::identity(), Point3::from(mount)),
            is_mount_turned: false,
        };
        let mut link = 0;
        for axis in machine.axes() {
            if let Some(limits) = axis.limits {
                chain.limits[axis.letter.index()] = limits;
            }
            let is_table = axis.side == Side::Table;
            link += usize::from(is_table);
            let first_link = if is_table { link } else { 0 };
            if axis.letter.is_rotary() {
                // A later axis of the table is nearer to the workpiece, and so comes first.
                let at = if is_table { 0 } else { chain.count };
                chain.axes[at..].rotate_right(1);
                chain.axes[at] = RotaryAxis {
                    letter: axis.letter,
                    direction: axis.direction,
                    point: axis.point.coords,
                    link: first_link,
                };
                chain.count += 1;
                chain.table += usize::from(is_table);
            } else {
                chain.slide_links[axis.letter.index()] = first_link;
            }
        }
        let offset = &setup.work_offset;
        chain.check(offset)?;
        check_length("the tool length", setup.tool_length)?;
        let (mut rotation, mut translation) = (Matrix3::identity(), Vector3::zeros());
        // The factors of G, the rightmost first.
        for axis in chain.axes[..chain.table].iter().rev() {
            let turn = axis.turn(offset);
            rotation = turn * rotation;
            translation = axis.apply(&turn, &translation);
            chain.frame.turned += usize::from(offset[axis.letter.index()] != 0.0);
        }
        // Without an offset of a rotary axis the frame stays the exact identity.
        if chain.frame.turned > 0 {
            (chain.frame.rotation, chain.frame.translation) = (rotation, translation);
        }
        chain.frame.origin = Vector3::new(offset[0], offset[1], offset[2]);
        Ok(chain)
    }

    /// Returns the chain from a link of the table side to the tool's tip. The link's frame coincides with
    /// machine coordinates when all axes are at 0. The last link carries the workpiece, without the work
    /// offset.
    ///
    /// # Errors
    /// [`JointError::NoLink`] if the link is beyond that of this chain.
    pub fn relative_to(&self, link: usize) -> Result<Chain, JointError> {
        if link > self.link {
            return Err(JointError::NoLink { link, last: self.link });
        }
        let mut chain = Chain { frame: Frame::IDENTITY, link, ..*self };
        // Axes of the table beyond the link move the workpiece, and not the tool relative to the link.
        while chain.table > 0 && chain.axes[0].link > link {
            chain.axes.rotate_left(1);
            chain.table -= 1;
            chain.count -= 1;
        }
        for (slide, first_link) in chain.slides.iter_mut().zip(self.slide_links) {
            *slide = if first_link <= link { 1.0 } else { 0.0 };
        }
        Ok(chain)
    }

    /// Returns the link of the table whose frame is that of poses.
    pub(crate) fn link(&self) -> usize {
        self.link
    }

    /// Returns the chain without the limits of its linear axes. Without a work offset, linear joints are known up to a
    /// displacement only.
    #[must_use]
    pub fn without_linear_limits(&self) -> Chain {
        let mut chain = *self;
        chain.limits[..3].fill([f64::NEG_INFINITY, f64::INFINITY]);
        chain
    }

    /// Returns the chain without the lower limit of Z, which the tip of a tool of unknown length may pass.
    #[must_use]
    pub fn without_lower_z_limit(&self) -> Chain {
        let mut chain = *self;
        chain.limits[2][0] = f64::NEG_INFINITY;
        chain
    }

    /// Returns the chain to the point of the tool axis that is below the tip by a distance, in mm.
    ///
    /// # Errors
    /// [`JointError::Range`] if the distance is out of range.
    pub(super) fn below_tip(&self, distance: f64) -> Result<Chain, JointError> {
        check_length("the distance of the pivot", distance)?;
        let tip = self.mount.tip() - distance * self.mount.axis();
        let mount = Pose::from_computed(*self.mount.rotation(), tip);
        Ok(Chain { mount, ..*self })
    }

    /// Checks that joint values are in range, and that no axis is moved that the machine lacks.
    pub(super) fn check(&self, joints: &Joints) -> Result<(), JointError> {
        for letter in Letter::ALL {
            let value = joints[letter.index()];
            if !letter.is_rotary() {
                check_length(&letter.to_string(), value)?;
            } else if !is_within(value, MAX_DEGREES) {
                let what = letter.to_string();
                return Err(JointError::Range { what, value, limit: MAX_DEGREES });
            } else if value != 0.0 && !self.has_rotary[letter.index() - 3] {
                return Err(JointError::NoAxis { letter, value });
            }
        }
        Ok(())
    }

    /// Returns the pose of the tool's tip frame relative to the workpiece, or to the link of
    /// [`Chain::relative_to`]. Its spin is known, in mm. [`Chain::rounding`] bounds its error.
    ///
    /// # Errors
    /// If a joint value is beyond [`MAX_LENGTH`] or [`MAX_DEGREES`], or of an axis that the machine lacks.
    /// Limits of axes are not checked.
    ///
    /// ```
    /// use touchoff_verify::machine::{Machine, Setup};
    ///
    /// let machine = Machine::named("A-C trunnion")?;
    /// let setup = Setup { work_offset: [0.0, 0.0, -480.0, 0.0, 0.0, 0.0], tool_length: 100.0 };
    /// let chain = machine.chain(&setup)?;
    /// // A command of A turns the tool about the trunnion's axis, relative to the workpiece.
    /// let pose = chain.pose(&[0.0, 0.0, -380.0, 90.0, 0.0, 0.0])?;
    /// assert!(pose.tip().coords.norm() < 1e-12);
    /// assert!((pose.axis() + nalgebra::Vector3::y()).norm() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn pose(&self, joints: &Joints) -> Result<Pose, JointError> {
        self.check(joints)?;
        Ok(self.place(joints))
    }

    /// Returns the pose at joint values that were checked.
    pub(super) fn place(&self, joints: &Joints) -> Pose {
        let turns = self.turns(joints);
        let linear = Vector3::new(joints[0], joints[1], joints[2]).component_mul(&self.slides);
        // The factors of P, the rightmost first: the axes of the tool, the linear ones, those of the table.
        let mut tip = self.swivelled_tip(&turns) + linear;
        for (axis, turn) in self.rotary().iter().zip(&turns).take(self.table).rev() {
            tip = axis.apply(turn, &tip);
        }
        let tip = self.frame.to_workpiece(&tip);
        Pose::from_computed(self.rotation(&turns), Point3::from(tip))
    }

    /// Returns the rotation of the tool from the turns of the axes.
    pub(super) fn rotation(&self, turns: &[Matrix3<f64>; 2]) -> Matrix3<f64> {
        let mut product = match self.count {
            0 => Matrix3::identity(),
            1 => turns[0],
            _ => turns[0] * turns[1],
        };
        if self.is_mount_turned {
            product *= self.mount.rotation();
        }
        if self.frame.turned > 0 { self.frame.rotation.tr_mul(&product) } else { product }
    }

    /// Returns the rotation matrices of the rotary axes; the identity in the place of a missing axis.
    pub(super) fn turns(&self, joints: &Joints) -> [Matrix3<f64>; 2] {
        let mut turns = [Matrix3::identity(); 2];
        for (turn, axis) in turns.iter_mut().zip(self.rotary()) {
            *turn = axis.turn(joints);
        }
        turns
    }

    /// Returns the tip after the motions of the tool's rotary axes, with the linear axes at 0.
    fn swivelled_tip(&self, turns: &[Matrix3<f64>; 2]) -> Vector3<f64> {
        let mut tip = self.mount.tip().coords;
        for at in self.tool_axes().rev() {
            tip = self.axes[at].apply(&turns[at], &tip);
        }
        tip
    }

    /// Returns the linear joint values, in mm, that put the tip at a point of the workpiece's frame. All
    /// linear axes have to move the tool relative to the body.
    pub(super) fn follow(&self, turns: &[Matrix3<f64>; 2], tip: &Vector3<f64>) -> Vector3<f64> {
        let mut position = self.frame.to_link(tip);
        for (axis, turn) in self.rotary().iter().zip(turns).take(self.table) {
            position = axis.undo(turn, &position);
        }
        position - self.swivelled_tip(turns)
    }

    /// Returns joint values whose linear axes put the tip at a point of the workpiece's frame, in mm, while
    /// the rotary axes keep their values in degrees: what a control with TCP does. The error is within the
    /// `tip` of [`Chain::rounding`] at the result.
    ///
    /// # Errors
    /// If a value is out of range, or if the chain is that of a body that not all linear axes move.
    pub fn linear_joints(
        &self,
        tip: &Point3<f64>,
        [a, b, c]: [f64; 3],
    ) -> Result<Joints, JointError> {
        self.check(&[tip.x, tip.y, tip.z, a, b, c])?;
        self.check_slides()?;
        let turns = self.turns(&[0.0, 0.0, 0.0, a, b, c]);
        let linear = self.follow(&turns, &tip.coords);
        Ok([linear.x, linear.y, linear.z, a, b, c])
    }

    /// Checks that all linear axes move the tool relative to the body.
    pub(super) fn check_slides(&self) -> Result<(), JointError> {
        match self.has_all_slides() {
            true => Ok(()),
            false => Err(JointError::Frame { link: self.link }),
        }
    }

    /// Returns whether all linear axes move the tool relative to the body.
    pub(super) fn has_all_slides(&self) -> bool {
        self.slides == Vector3::repeat(1.0)
    }

    /// Returns the rotary axes, from the body to the tool.
    pub(super) fn rotary(&self) -> &[RotaryAxis] {
        &self.axes[..self.count]
    }

    /// Returns the indices of the rotary axes of the tool.
    pub(super) fn tool_axes(&self) -> Range<usize> {
        self.table..self.count
    }

    /// Returns the number of rotary axes of the table.
    pub(super) fn table_axes(&self) -> usize {
        self.table
    }

    /// Returns bounds on the rounding error of [`Chain::pose`] at joint values, relative to exact kinematics
    /// of the numbers of the machine, with its directions normalised exactly.
    ///
    /// Let u = 2⁻⁵³, m the number of rotary axes, f that of table axes with a rotary offset, and S = |h| +
    /// |xyz| + |o| + 4 Σ|c| the sum of the tool length, the linear joint values, the work offset and the
    /// points of the axes, which no intermediate coordinate exceeds. A rotation matrix errs by 30u, as
    /// derived in the source of `rotation`, its product with a vector by another 3√3 u, and the differences
    /// before and after it by u each: 38u S per axis, second-order terms included. The frame of the workpiece
    /// adds the same for its translation, and its rotation and the product with it: 76u S per axis. Two
    /// translations and their sum remain:
    ///
    /// > tip: (38 m + 76 f + 4) u S
    ///
    /// A product of two rotations adds 9u. The Newton step that ends in an orthonormal matrix at most doubles
    /// the error, because its length is half of |I − RᵀR|, and rounds by 8u:
    ///
    /// > rotation: (2 (30 + 9) (m + f) + 8) u
    ///
    /// The turned mount of another body counts as one more axis: its rotation is taken as it is, within 9u of an exact one.
    ///
    /// Sine and cosine of the platform's library are taken to err by at most an ulp.
    pub fn rounding(&self, joints: &Joints) -> RoundingBound {
        let linear = Vector3::new(joints[0], joints[1], joints[2]).norm();
        self.rounding_at(linear)
    }

    /// Returns the bounds of [`Chain::rounding`] for linear joint values of a norm up to `linear`, in mm.
    pub(super) fn rounding_at(&self, linear: f64) -> RoundingBound {
        let [turned, axes] = [self.frame.turned, self.count].map(|count| count as f64);
        let tip = (38.0 * axes + 76.0 * turned + 4.0) * self.size(linear) * UNIT_ROUNDOFF;
        let factors = axes + turned + f64::from(u8::from(self.is_mount_turned));
        let rotation = 2.0 * (ROTATION_ERROR + 9.0) * factors + 8.0;
        RoundingBound { tip, rotation: rotation * UNIT_ROUNDOFF }
    }

    /// Returns the size S of [`Chain::rounding`], in mm.
    pub(super) fn size(&self, linear: f64) -> f64 {
        let points = self.rotary().iter().map(|axis| axis.point.norm()).sum::<f64>();
        self.mount.tip().coords.norm() + linear + self.frame.origin.norm() + 4.0 * points
    }
}

/// Something that moves with a link of a machine, relative to another link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Mover {
    /// The tool in the spindle.
    Tool,
    /// A body of the machine.
    Body {
        /// Its link.
        link: Link,
        /// Its pose in machine coordinates with all axes at 0, in mm.
        mount: Pose,
    },
}

/// The frame to which poses are relative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Reference {
    /// That of the workpiece, with its work offset.
    Workpiece,
    /// That of a link, which coincides with machine coordinates when all axes are at 0.
    Link(Link),
}

/// The motion of any body of a machine relative to any other one.
///
/// Let link L of a machine be at P_L(q) in machine coordinates, as the [module](super) has it: the product of J(−q) of the axes of
/// the table up to L, or of J(q) of those of the tool. The pose of a mount M of link B relative to link A is
///
/// > P_A(q)⁻¹ P_B(q) M
///
/// The axes that both links have in common cancel. Of those that remain, the factors of A are inverted and reversed: from a link of
/// the table to one of the tool all of them are J(q), and the other way all are J(−q), where J(−q) of a rotary axis is J(q) about
/// the opposite direction. On each side the linear axes are nearer to the base than the rotary ones. The product is hence one of
/// rotations, translations, and rotations, as that of a [`Chain`] is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Relation {
    chain: Chain,
    /// Set if the mount is that of the tool in the spindle.
    is_of_tool: bool,
    /// Set if poses are relative to the workpiece.
    is_to_workpiece: bool,
}

impl Relation {
    /// Returns the motion of a body relative to a frame.
    ///
    /// # Errors
    /// [`JointError::NoCarrier`] if the machine lacks the axis of a link.
    pub(crate) fn new(
        machine: &Machine,
        mover: Mover,
        reference: Reference,
    ) -> Result<Relation, JointError> {
        let mut chain = machine.chain(&Setup::default())?;
        (chain.count, chain.table, chain.slides) = (0, 0, Vector3::zeros());
        let to = match mover {
            Mover::Tool => machine.last_link(Side::Tool),
            Mover::Body { link, mount } => {
                chain.is_mount_turned = *mount.rotation() != Matrix3::identity();
                chain.mount = mount;
                link
            }
        };
        let from = match reference {
            Reference::Workpiece => machine.last_link(Side::Table),
            Reference::Link(link) => link,
        };
        let [from, to] = [machine.carriers(from)?, machine.carriers(to)?];
        let common = from.iter().zip(&to).take_while(|(one, other)| one.letter == other.letter);
        let common = common.count();
        let inverted = from[common..].iter().rev().map(|axis| (axis, -link_sign(axis.side)));
        let applied = to[common..].iter().map(|axis| (axis, link_sign(axis.side)));
        let mut has_slide = false;
        for (axis, sign) in inverted.chain(applied) {
            if !axis.letter.is_rotary() {
                chain.slides[axis.letter.index()] = sign;
                has_slide = true;
                continue;
            }
            chain.axes[chain.count] = RotaryAxis {
                letter: axis.letter,
                direction: sign * axis.direction,
                point: axis.point.coords,
                link: 0,
            };
            chain.count += 1;
            // Rotary axes before the linear ones turn the position that these give.
            chain.table += usize::from(!has_slide);
        }
        let is_of_tool = mover == Mover::Tool;
        Ok(Relation { chain, is_of_tool, is_to_workpiece: reference == Reference::Workpiece })
    }

    /// Returns the chain for the tool length and the work offset of the chain of a workpiece.
    pub(super) fn of(&self, workpiece: &Chain) -> Chain {
        let mut chain = self.chain;
        if self.is_of_tool {
            chain.mount = workpiece.mount;
        }
        if self.is_to_workpiece {
            chain.frame = workpiece.frame;
        }
        chain
    }
}

/// Returns the sign of the joint value in the motion of an axis's link.
fn link_sign(side: Side) -> f64 {
    match side {
        Side::Table => -1.0,
        Side::Tool => 1.0,
    }
}

impl Machine {
    /// Returns the last link of a side: that of the workpiece, or that of the spindle.
    pub(crate) fn last_link(&self, side: Side) -> Link {
        let last = self.axes().iter().rfind(|axis| axis.side == side);
        last.map_or(Link::Base, |axis| Link::Axis(axis.letter))
    }

    /// Returns the axes that move a link, from the base outwards.
    fn carriers(&self, link: Link) -> Result<Vec<&Axis>, JointError> {
        let Link::Axis(letter) = link else { return Ok(Vec::new()) };
        let last = self.axis(letter).ok_or(JointError::NoCarrier { letter })?;
        let mut side: Vec<&Axis> =
            self.axes().iter().filter(|axis| axis.side == last.side).collect();
        let count = side.iter().take_while(|axis| axis.letter != letter).count();
        side.truncate(count + 1);
        Ok(side)
    }
}

/// Returns whether a value is a number of at most the given magnitude.
pub(super) fn is_within(value: f64, limit: f64) -> bool {
    value.abs() <= limit
}

/// Checks that a length is finite and within [`MAX_LENGTH`].
pub(super) fn check_length(what: &str, value: f64) -> Result<(), JointError> {
    match is_within(value, MAX_LENGTH) {
        true => Ok(()),
        false => Err(JointError::Range { what: what.to_owned(), value, limit: MAX_LENGTH }),
    }
}

/// Bound on the error of [`rotation`] as an operator, in units of 2⁻⁵³, relative to the rotation about the
/// exact unit vector by the exact angle.
///
/// With u = 2⁻⁵³: the angle in radians errs by 3u · π/4. Sine and cosine err by one ulp each, hence by 2u,
/// which changes the matrix by √8 u. Rounding its entries changes it by 8.2u (Frobenius norm). The stored
/// direction errs by 3.5u, which changes the matrix by (|sin θ| + 2 (1 − cos θ)) · 3.5u ≤ (2 + √5) · 3.5u.
/// The sum is below 30u.
const ROTATION_ERROR: f64 = 30.0;

/// Returns sine and cosine of an angle in degrees of magnitude up to 2⁴⁰. Each errs by at most 2⁻⁵² plus an
/// ulp of the library's function, and is exact at multiples of 90°.
///
/// The angle is reduced to ±45° in degrees. The reduction is exact: the difference of the angle and the
/// nearest multiple of 90° is a multiple of the angle's ulp and no larger than the angle, or both are within
/// a factor of 2.
pub(crate) fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let quarters = (degrees / 90.0).round();
    let (sine, cosine) = (degrees - 90.0 * quarters).to_radians().sin_cos();
    match quarters as i64 & 3 {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

/// Returns the rotation about a unit vector by an angle in degrees, counter-clockwise seen from its head
/// (Rodrigues' formula). [`ROTATION_ERROR`] bounds its error.
pub(super) fn rotation(direction: &Vector3<f64>, degrees: f64) -> Matrix3<f64> {
    let (sine, cosine) = sin_cos_degrees(degrees);
    let (d, versine) = (direction, 1.0 - cosine);
    let (xy, yz, zx) = (versine * d.x * d.y, versine * d.y * d.z, versine * d.z * d.x);
    let s = sine * d;
    Matrix3::new(
        versine * d.x * d.x + cosine,
        xy - s.z,
        zx + s.y,
        xy + s.z,
        versine * d.y * d.y + cosine,
        yz - s.x,
        zx - s.y,
        yz + s.x,
        versine * d.z * d.z + cosine,
    )
}

/// Returns the angle in degrees, from −180 to 180, by which the plane through a unit vector `axis` and `from`
/// turns about `axis` to the plane through `axis` and `to`. Neither vector may be parallel to the axis: the
/// angle of a vector that is errs without bound (Murray, Li, Sastry, *A mathematical introduction to robotic
/// manipulation*, 1994, subproblem 1).
pub(super) fn angle_about(axis: &Vector3<f64>, from: &Vector3<f64>, to: &Vector3<f64>) -> f64 {
    let (from, to) = (from - axis * axis.dot(from), to - axis * axis.dot(to));
    radians_to_degrees(axis.dot(&from.cross(&to)).atan2(from.dot(&to)))
}

/// Returns the angle between two unit vectors in radians, with an error of some 2⁻⁵¹ at any angle.
pub(super) fn angle_between(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

/// Returns an angle in degrees.
pub(super) fn radians_to_degrees(radians: f64) -> f64 {
    radians * (180.0 / PI)
}
