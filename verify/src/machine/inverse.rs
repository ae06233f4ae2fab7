//! Inverse kinematics: joint values for a tip and a tool axis in the frame of the workpiece.

use super::chain::{Chain, RotaryAxis, angle_about, angle_between, radians_to_degrees, rotation};
use super::{InverseError, Joints, Letter};
use nalgebra::{Point3, Vector3};
use std::f64::consts::{PI, TAU};

/// Largest angle in radians by which the rotary axes may miss a tool axis: published programs round the
/// components of their axes to four digits, which turns them by up to √3 · 5e-5.
pub const REACH_TOLERANCE: f64 = 1e-4;

/// Angle in radians between tool axis and rotary axis below which the rotary joint keeps its value: it turns
/// the tool axis by less than twice this angle, 1e-6 mm at 500 mm from the tip.
const SINGULAR: f64 = 1e-9;

/// Smallest sine of the angle between spindle and inner rotary axis at which the axis tilts the tool.
const SMALLEST_TILT: f64 = 1e-6;

/// Rounding in degrees by which a joint value may exceed a limit.
const LIMIT_ROUNDING: f64 = 1e-9;

/// Joint values that place a tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InverseSolution {
    /// The joint values, in mm and degrees.
    pub joints: Joints,
    /// Angle in radians by which the rotary axes miss the tool axis, at most 1e-4: above rounding where the
    /// machine cannot reach the direction exactly.
    pub axis_error: f64,
    /// Set for each of A, B and C whose value is that of `near`: any other one gives the tool axis, too.
    pub kept: [bool; 3],
}

/// A value of a rotary axis in degrees, and whether it is that of `near`.
#[derive(Clone, Copy, Debug, Default)]
struct RotaryValue {
    degrees: f64,
    is_kept: bool,
}

impl RotaryValue {
    fn found(degrees: f64) -> RotaryValue {
        RotaryValue { degrees, is_kept: false }
    }

    fn kept(degrees: f64) -> RotaryValue {
        RotaryValue { degrees, is_kept: true }
    }
}

impl Chain {
    /// Returns the joint values that put the tip at a point, in mm, with the tool axis in a direction, both
    /// in the frame of the workpiece: the solution within the limits of all axes whose rotary joints are
    /// nearest to `near`. See [`Chain::solutions`].
    ///
    /// # Errors
    /// As [`Chain::solutions`].
    ///
    /// ```
    /// use nalgebra::{Point3, Vector3};
    /// use touchoff_verify::machine::{Machine, Setup};
    ///
    /// let chain = Machine::named("A-C trunnion")?.chain(&Setup { tool_length: 400.0, ..Setup::default() })?;
    /// let axis = Vector3::new(0.0, -0.6, 0.8);
    /// // A is −36.87° with C at 180°, since its limits exclude 36.87° with C at 0°.
    /// let solution = chain.inverse(&Point3::new(0.0, 0.0, -480.0), &axis, &[0.0; 6])?;
    /// assert!((solution.joints[3] + 36.8699).abs() < 1e-4 && solution.joints[5].abs() == 180.0);
    /// let pose = chain.pose(&solution.joints)?;
    /// assert!((pose.axis() - axis).norm() < 1e-14);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn inverse(
        &self,
        tip: &Point3<f64>,
        axis: &Vector3<f64>,
        near: &Joints,
    ) -> Result<InverseSolution, InverseError> {
        let mut solutions = self.solutions(tip, axis, near)?;
        Ok(solutions.swap_remove(0))
    }

    /// Returns all solutions within limits, at most two, ordered by the sum of the turns of the rotary joints
    /// from `near`. Whole turns are added to come as near as the limits allow. Where the tool axis is
    /// parallel to the rotary axis on the side of the workpiece, this joint keeps the value of `near`. The
    /// axis need not be a unit vector.
    ///
    /// The rotary joints solve subproblem 2 of Paden and Kahan (Murray, Li, Sastry, *A mathematical
    /// introduction to robotic manipulation*, 1994, section 3.2): R(d₁, q₁) R(d₂, q₂) z = a. The spherical
    /// triangle of d₁, d₂ and c = R(d₂, q₂) z has the sides A = ∠(d₁, d₂), B = ∠(d₂, z), and C = ∠(d₁, c) =
    /// ∠(d₁, a). Its angle x at d₂ follows from the half-angle formula, whose error at the singular direction
    /// is that of C:
    ///
    /// > tan²(x/2) = sin(s − A) sin(s − B) / (sin s sin(s − C)), s = (A + B + C)/2
    ///
    /// q₂ is ±x from the angle that puts z into the plane of d₁ and d₂ on the side of d₁. q₁ rotates c to a
    /// (subproblem 1). For a single rotary axis, B = C has to hold. The pose at the joint values has the
    /// given tip and axis but for `axis_error`, the bounds of [`Chain::rounding`], and some 1e-14 rad of
    /// rounding in the joint values. The joint values themselves are ill-conditioned where both solutions
    /// meet, at the edge of the directions that the axes reach: 1e-16 in the axis moves them by 1e-8 rad
    /// there.
    ///
    /// # Errors
    /// If a value is out of range, if the axis is zero, if the rotary axes miss it by more than 1e-4 rad, or
    /// if all solutions are outside limits.
    pub fn solutions(
        &self,
        tip: &Point3<f64>,
        axis: &Vector3<f64>,
        near: &Joints,
    ) -> Result<Vec<InverseSolution>, InverseError> {
        self.check(near)?;
        self.check(&[tip.x, tip.y, tip.z, 0.0, 0.0, 0.0])?;
        self.check_slides()?;
        // Scaled first: the square of a tiny component underflows.
        let scale = axis.amax();
        if !(scale > 0.0 && scale < f64::INFINITY) || axis.iter().any(|value| value.is_nan()) {
            return Err(InverseError::NoDirection);
        }
        let direction = self.frame.rotation * (axis / scale).normalize();
        let candidates = self.rotary_values(&direction, near)?;
        let (mut solutions, mut fault) = (Vec::with_capacity(2), None);
        for candidate in candidates.into_iter().flatten() {
            let mut kept = [false; 3];
            for (axis, value) in self.rotary().iter().zip(candidate) {
                kept[axis.letter.index() - 3] = value.is_kept;
            }
            match self.solution(candidate, tip, near) {
                Ok(joints) => {
                    let turned = Vector3::from(self.rotation(&self.turns(&joints)).column(2));
                    let asked = (axis / scale).normalize();
                    let axis_error = angle_between(&turned, &asked);
                    solutions.push(InverseSolution { joints, axis_error, kept });
                }
                // It is told only if the other solution is beyond limits, too.
                Err(limit) => fault = fault.or(Some(limit)),
            }
        }
        solutions.sort_by(|a, b| {
            let [a, b] = [a, b]
                .map(|solution| (3..6).map(|k| (solution.joints[k] - near[k]).abs()).sum::<f64>());
            a.total_cmp(&b)
        });
        match fault {
            Some(fault) if solutions.is_empty() => Err(fault),
            _ => Ok(solutions),
        }
    }

    /// Returns the values of the rotary axes, in degrees and in the chain's order, that turn z to a direction
    /// in the last link: at least the first candidate.
    fn rotary_values(
        &self,
        direction: &Vector3<f64>,
        near: &Joints,
    ) -> Result<[Option<[RotaryValue; 2]>; 2], InverseError> {
        let z = Vector3::z();
        let near_value = |axis: &RotaryAxis| near[axis.letter.index()];
        let (first, second) = match self.rotary() {
            [] => {
                check_gap(angle_between(&z, direction))?;
                return Ok([Some([RotaryValue::default(); 2]), None]);
            }
            [only] => {
                let value = single(only, &z, direction, near_value(only))?;
                return Ok([Some([value, RotaryValue::default()]), None]);
            }
            [first, second, ..] => (first, second),
        };
        let (d1, d2) = (first.direction, second.direction);
        // The inner axis only spins the tool, so that it keeps its value.
        if d2.cross(&z).norm() < SMALLEST_TILT {
            let value = near_value(second);
            let spindle = rotation(&d2, value) * z;
            let turned = single(first, &spindle, direction, near_value(first))?;
            return Ok([Some([turned, RotaryValue::kept(value)]), None]);
        }
        let (a, b) = (angle_between(&d1, &d2), angle_between(&d2, &z));
        let c = angle_between(&d1, direction);
        let (least, greatest) = ((a - b).abs(), (a + b).min(TAU - a - b));
        check_gap((least - c).max(c - greatest))?;
        // A direction that is missed within the tolerance is taken as the nearest one that the axes reach.
        let c = c.clamp(least, greatest);
        let s = 0.5 * (a + b + c);
        let squares = [(s - a).sin() * (s - b).sin(), s.sin() * (s - c).sin()];
        let [sine, cosine] = squares.map(|square| square.max(0.0).sqrt());
        let half = sine.atan2(cosine);
        let middle = angle_about(&d2, &z, &d1);
        Ok([half, -half].map(|half| {
            let value = middle + 2.0 * radians_to_degrees(half);
            let tilted = rotation(&d2, value) * z;
            // Near the outer axis any value of it gives the direction.
            let turned = match c.min(PI - c) < SINGULAR {
                true => RotaryValue::kept(near_value(first)),
                false => RotaryValue::found(angle_about(&d1, &tilted, direction)),
            };
            Some([turned, RotaryValue::found(value)])
        }))
    }

    /// Returns the joint values for rotary values, with whole turns added and the linear joints that put the
    /// tip at its place.
    fn solution(
        &self,
        rotary: [RotaryValue; 2],
        tip: &Point3<f64>,
        near: &Joints,
    ) -> Result<Joints, InverseError> {
        let mut joints = [0.0; 6];
        for (axis, value) in self.rotary().iter().zip(rotary) {
            let index = axis.letter.index();
            joints[index] =
                nearest_turn(axis.letter, value.degrees, near[index], self.limits[index])?;
        }
        let linear = self.follow(&self.turns(&joints), &tip.coords);
        for (index, value) in linear.iter().enumerate() {
            joints[index] = *value;
            let [low, high] = self.limits[index];
            if !(low - LIMIT_ROUNDING..=high + LIMIT_ROUNDING).contains(value) {
                let letter = Letter::ALL[index];
                return Err(InverseError::Limit { letter, value: *value, low, high });
            }
        }
        Ok(joints)
    }
}

/// Returns the value of a rotary axis that turns a direction to another one, in degrees; the given value
/// where the axis is parallel to them.
fn single(
    axis: &RotaryAxis,
    from: &Vector3<f64>,
    to: &Vector3<f64>,
    near: f64,
) -> Result<RotaryValue, InverseError> {
    let [b, c] = [from, to].map(|vector| angle_between(&axis.direction, vector));
    check_gap((b - c).abs())?;
    let sine = b.sin().min(c.sin());
    Ok(match sine < SINGULAR {
        true => RotaryValue::kept(near),
        false => RotaryValue::found(angle_about(&axis.direction, from, to)),
    })
}

/// Refuses a direction that is missed by more than the tolerance, in radians.
fn check_gap(gap: f64) -> Result<(), InverseError> {
    match gap <= REACH_TOLERANCE {
        true => Ok(()),
        false => Err(InverseError::Unreachable { degrees: radians_to_degrees(gap) }),
    }
}

/// Returns the angle with the whole turns that bring it nearest to `near` within the limits, in degrees.
fn nearest_turn(
    letter: Letter,
    angle: f64,
    near: f64,
    [low, high]: [f64; 2],
) -> Result<f64, InverseError> {
    let least = ((low - LIMIT_ROUNDING - angle) / 360.0).ceil();
    let greatest = ((high + LIMIT_ROUNDING - angle) / 360.0).floor();
    let nearest = ((near - angle) / 360.0).round();
    if least > greatest {
        let value = angle + 360.0 * nearest;
        return Err(InverseError::Limit { letter, value, low, high });
    }
    // Rounding may have put it beyond a limit.
    Ok((angle + 360.0 * nearest.clamp(least, greatest)).clamp(low, high))
}
