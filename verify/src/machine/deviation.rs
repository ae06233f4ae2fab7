//! Bounds on the deviation of a joint motion from a motion at constant speed between two of its poses.
//!
//! Let the interval from t₀ to t₁ have the duration Δ. A point of the tool at distance ρ from the tip
//! deviates by at most |p − p̃| + ρ ‖R − R̃‖, where p and R are tip and rotation of the true motion, p̃ and
//! R̃ those of the approximating one at the same time. Both agree at t₀ and t₁.
//!
//! **Chord.** A function that is 0 at both ends is at most sup|e″| Δ²/8. As p̃ is linear, |p − p̃| ≤ sup|p″|
//! Δ²/8, and the norm of any point exceeds the greater of its norms at both ends by no more.
//!
//! **Tip.** p is a product of the chain's factors, applied to a point one by one ([`MovingPoint`]). Let the
//! point y have speeds up to v and accelerations up to a. A rotation by an angle with rate w about an axis at
//! distance at most ρ gives speeds up to v + |w|ρ and accelerations up to a + 2|w|v + w²ρ (Coriolis and
//! centripetal terms). A translation adds its own. With TCP, p is the path in the frame of the workpiece, and
//! rotations are undone from there to another body.
//!
//! **Other bodies.** The tip of a body other than the tool is a fixed point of its link, to which the same factors apply:
//! rotations, the translation by those of the linear joints that are between both links, and rotations. With TCP the linear joints
//! are the path, with the rotations of the table undone, less the tool's tip after those of the tool: their speeds and accelerations
//! are at most the sums of both.
//!
//! **Tool axis.** Let the outer axis have direction d₁ and rate w₁, the inner one d₂ and w₂, and let a(t) be
//! the tool axis after the inner rotation. In this frame the angular velocity ω = w₁d₁ + w₂d₂ is constant,
//! its derivative is n = w₁w₂ d₁ × d₂, and the tool axis has the speed |ω × a| and the tangential
//! acceleration
//!
//! > τ = n × a + f (ω − f a), with f = ω · a.
//!
//! τ is 0 if the tool axis turns on a great circle. Its norm over the interval follows from those at the ends
//! by the chord bound, with a bound on τ″ from a″ = w₂² d₂ × (d₂ × a).
//!
//! **Great circles** ([`geodesic_deviation`]). Let a curve on a unit sphere, of any dimension, have
//! tangential accelerations up to κ and speeds up to V, and φ = VΔ. The great circle ã between its ends has
//! the constant speed ω̃ ≤ V, and e = a − ã is 0 at both ends. Its second derivative is τ − |a′|² e − (|a′|²
//! − ω̃²) ã. With E = sup|e″|, |e| ≤ EΔ²/8, and ||a′| − ω̃| ≤ |e′| ≤ EΔ/2, because the mean of e′ is 0. Hence
//! E ≤ κ + E φ²/8 + E φ, and
//!
//! > |a − ã| ≤ κΔ²/8 / (1 − φ − φ²/8) where the denominator is positive.
//!
//! In any case sup|a″| ≤ κ + V² and |ã″| ≤ V², so |a − ã| ≤ (κΔ² + 2φ²)/8.
//!
//! For a tool of revolution, a − ã is all that counts: the smallest rotation that takes ã to a moves a point
//! at distance ρ by at most ρ|a − ã|, and takes the tool to a tool. For a solid, the curve is that of the
//! unit quaternion: q″ = ½ n q − ¼ |ω|² q, with ω and n as above, so that V = |ω|/2 is constant and κ =
//! |n|/2. Its great circle is the spherical interpolation, and ‖R − R̃‖ ≤ 2 |q − q̃|.

use super::chain::{Chain, RotaryAxis};
use super::motion::{Derivatives, JointMotion, Related, checked_time};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Relative rounding error of the bounds: they are sums and products of some hundred positive terms.
const RELATIVE_ERROR: f64 = 256.0 * f64::EPSILON;

/// A motion on an interval of time.
struct Interval<'m> {
    motion: &'m JointMotion,
    times: [f64; 2],
    duration: f64,
    /// The rotation matrices of the workpiece's chain at both ends.
    turns: Turns,
    /// Those of the body's chain.
    body_turns: Turns,
}

/// Rotation matrices of a chain at both ends of an interval.
type Turns = [[Matrix3<f64>; 2]; 2];

/// A point that moves: its positions at both ends of the interval, and bounds on its speed and acceleration.
struct MovingPoint {
    ends: [Vector3<f64>; 2],
    speed: f64,
    acceleration: f64,
}

impl JointMotion {
    /// Returns an upper bound on the deviation of the motion from [`JointMotion::motion`] from `t0` to `t1`,
    /// for a tool of revolution, in mm: at every time between, each point of the tool within `reach` of the
    /// tip is at most so far from the point at the same place of the tool in the approximating motion, apart
    /// from a spin about the tool axis. Rounding of the poses at both ends is included.
    ///
    /// The bound decreases with the square of t₁ − t₀, down to rounding, and is 0 but for it if the tip is on
    /// a line and one rotary axis, perpendicular to the tool axis, moves. It is 2 · reach plus that of the
    /// tip if the tool axis may turn by a quarter turn or more. The module's source has the derivation.
    ///
    /// # Panics
    /// Panics if a time is NaN.
    pub fn deviation(&self, t0: f64, t1: f64, reach: f64) -> f64 {
        let interval = Interval::new(self, t0, t1);
        interval.bound(interval.axis_deviation(), reach)
    }

    /// Returns an upper bound on the deviation of the motion from [`JointMotion::motion_with_spin`], for a
    /// solid: as [`JointMotion::deviation`], but with the spin.
    ///
    /// # Panics
    /// Panics if a time is NaN.
    pub fn deviation_with_spin(&self, t0: f64, t1: f64, reach: f64) -> f64 {
        let interval = Interval::new(self, t0, t1);
        interval.bound(interval.rotation_deviation(), reach)
    }

    /// Returns an upper bound on the speed of any point of the tool within `reach` of the tip, per unit of the motion's
    /// time, in mm: between the times s and t, none travels farther than that times |t − s|. It is the tip's speed, and
    /// the angular speed times the reach.
    pub fn max_speed(&self, reach: f64) -> f64 {
        let [outer, inner] = self.rates(&self.body);
        let (tip, _) = Interval::new(self, 0.0, 1.0).tip_bounds();
        (tip + reach * (outer.abs() + inner.abs())) * (1.0 + RELATIVE_ERROR)
    }

    /// Returns a bound on the second derivative of the linear joint values between two times, in mm.
    pub(super) fn linear_acceleration(&self, t0: f64, t1: f64) -> f64 {
        let acceleration = match self.tcp {
            true => Interval::new(self, t0, t1).linear_bounds().acceleration,
            // Rotations, which an interval has, do not count.
            false => self.path.derivatives().acceleration,
        };
        acceleration * (1.0 + RELATIVE_ERROR)
    }

    /// Returns the angular rates of the rotary axes of a chain to a body, in radians, in the chain's order.
    fn rates(&self, chain: &Chain) -> [f64; 2] {
        let mut rates = [0.0; 2];
        for (rate, axis) in rates.iter_mut().zip(chain.rotary()) {
            *rate = self.rate(axis);
        }
        rates
    }

    /// Returns the angular rate of a rotary axis, in radians.
    fn rate(&self, axis: &RotaryAxis) -> f64 {
        let [start, end] = self.rotary_ends(axis.letter);
        (end - start).to_radians()
    }
}

impl Interval<'_> {
    fn new(motion: &JointMotion, t0: f64, t1: f64) -> Interval<'_> {
        let (t0, t1) = (checked_time(t0), checked_time(t1));
        let turns = [t0, t1].map(|t| motion.turns(t));
        let body_turns = match motion.related {
            Related::Workpiece => turns,
            Related::TableLink | Related::Bodies => [t0, t1].map(|t| motion.body_turns(t)),
        };
        Interval { motion, times: [t0, t1], duration: (t1 - t0).abs(), turns, body_turns }
    }

    /// Adds up the bounds of tip, rotation and rounding. An error of the poses at both ends changes the
    /// approximating motion by that of the tip and, less than a quarter turn apart, by the sum of those of
    /// both rotations.
    fn bound(&self, rotation: f64, reach: f64) -> f64 {
        let rounding = self.motion.rounding;
        // The chord bound.
        let tip = self.tip_bounds().1 * self.duration.powi(2) / 8.0 + rounding.tip;
        (tip + reach * (rotation.min(2.0) + 2.0 * rounding.rotation)) * (1.0 + RELATIVE_ERROR)
    }

    /// Returns bounds on the speed and the acceleration of the tip relative to the body.
    fn tip_bounds(&self) -> (f64, f64) {
        let (chain, body) = (&self.motion.chain, &self.motion.body);
        if self.motion.tcp && self.motion.related != Related::Bodies {
            if body.has_all_slides() {
                return self.undone(chain.rotary().len() - body.rotary().len()).bounds();
            }
            // The body carries a linear axis of the table and hence no rotary axis. Its position is a part of the
            // linear joints' coordinates, and the rest is that of the spindle head.
            let head = self.swivelled_tip(body, &self.body_turns).bounds();
            return match body.slides == Vector3::zeros() {
                true => head,
                false => {
                    let slides = self.undone(chain.table_axes()).bounds();
                    (head.0 + slides.0, head.1 + slides.1)
                }
            };
        }
        let mut tip = self.swivelled_tip(body, &self.body_turns);
        if body.slides != Vector3::zeros() {
            let ends = self.times.map(|t| self.motion.linear(t).component_mul(&body.slides));
            tip.translate(ends, self.linear_bounds());
        }
        for at in (0..body.table_axes()).rev() {
            self.rotate(
                &mut tip,
                &body.rotary()[at],
                self.body_turns.map(|turns| turns[at]),
                false,
            );
        }
        tip.bounds()
    }

    /// Returns bounds on the derivatives of the linear joints. With TCP they follow the path.
    fn linear_bounds(&self) -> Derivatives {
        let path = self.motion.path.derivatives();
        if !self.motion.tcp {
            return path;
        }
        let chain = &self.motion.guide;
        let tips = [self.undone(chain.table_axes()), self.swivelled_tip(chain, &self.turns)];
        let [(speed, acceleration), (head_speed, head_acceleration)] = tips.map(|tip| tip.bounds());
        Derivatives { speed: speed + head_speed, acceleration: acceleration + head_acceleration }
    }

    /// Returns the tip of a chain after the rotary axes behind its linear ones, with these at 0.
    fn swivelled_tip(&self, chain: &Chain, turns: &Turns) -> MovingPoint {
        let tip = chain.mount.tip().coords;
        let mut tip = MovingPoint { ends: [tip; 2], speed: 0.0, acceleration: 0.0 };
        for at in chain.tool_axes().rev() {
            self.rotate(&mut tip, &chain.rotary()[at], turns.map(|turns| turns[at]), false);
        }
        tip
    }

    /// Returns the path of the guided point after undoing the first rotary axes, from the workpiece towards the base.
    fn undone(&self, count: usize) -> MovingPoint {
        let chain = &self.motion.guide;
        let path = self.motion.path.derivatives();
        let ends = self.times.map(|t| chain.frame.to_link(&self.motion.path.at(t)));
        let mut tip = MovingPoint { ends, speed: path.speed, acceleration: path.acceleration };
        for at in 0..count {
            self.rotate(&mut tip, &chain.rotary()[at], self.turns.map(|turns| turns[at]), true);
        }
        tip
    }

    /// Applies or undoes an axis, whose rotation matrices at both ends are given.
    fn rotate(
        &self,
        point: &mut MovingPoint,
        axis: &RotaryAxis,
        turns: [Matrix3<f64>; 2],
        undo: bool,
    ) {
        let rate = self.motion.rate(axis).abs();
        if rate > 0.0 {
            point.turn(axis, rate, self.duration, self.motion.position_error);
        }
        for (end, turn) in point.ends.iter_mut().zip(&turns) {
            *end = match undo {
                true => axis.undo(turn, end),
                false => axis.apply(turn, end),
            };
        }
    }

    /// Returns a bound on |a − ã| for the tool axis.
    fn axis_deviation(&self) -> f64 {
        let body = &self.motion.body;
        let [outer, inner] = self.motion.rates(body);
        // The axis that turns, before any rotation: +z but for a turned mount.
        let mounted = body.mount.axis();
        let (d1, d2) = match body.rotary() {
            [] => return 0.0,
            [outer] => (outer.direction, Vector3::z()),
            [outer, inner, ..] => (outer.direction, inner.direction),
        };
        let axes = match body.rotary().len() {
            1 => [mounted; 2],
            _ => self.body_turns.map(|turns| turns[1] * mounted),
        };
        let (omega, n) = (outer * d1 + inner * d2, outer * inner * d1.cross(&d2));
        // a'' = w2² d2 × (d2 × a), f' = w1w2 d1 · (d2 × a), f'' = w1w2² d1 · (d2 × (d2 × a)).
        let [outer, inner] = [outer.abs(), inner.abs()];
        let (lever, omega_norm) = (d2.cross(&mounted).norm(), omega.norm());
        let a2 = inner * inner * lever;
        let [f1, f2] = [outer * inner * lever, outer * a2];
        let f0 = omega_norm.min(outer + inner * d2.dot(&mounted).abs());
        let tau2 = n.norm() * a2
            + f2 * omega_norm
            + 2.0 * f1 * f1
            + 2.0 * f0 * f2
            + 4.0 * f0 * f1 * inner * lever
            + f0 * f0 * a2;
        let chord = self.duration.powi(2) / 8.0;
        let rounding = RELATIVE_ERROR * (outer + inner);
        let [mut curvature, mut speed] = [0.0f64; 2];
        for a in &axes {
            let f = omega.dot(a);
            curvature = curvature.max((n.cross(a) + f * (omega - f * a)).norm());
            speed = speed.max(omega.cross(a).norm());
        }
        geodesic_deviation(
            curvature + tau2 * chord + rounding * (outer + inner),
            speed + omega_norm * a2 * chord + rounding,
            self.duration,
        )
    }

    /// Returns a bound on ‖R − R̃‖ for the rotation.
    fn rotation_deviation(&self) -> f64 {
        let [outer, inner] = self.motion.rates(&self.motion.body);
        let (omega, n) = match self.motion.body.rotary() {
            [] => return 0.0,
            [_] => (outer.abs(), 0.0),
            [first, second, ..] => {
                let (d1, d2) = (first.direction, second.direction);
                ((outer * d1 + inner * d2).norm(), (outer * inner * d1.cross(&d2)).norm())
            }
        };
        2.0 * geodesic_deviation(0.5 * n, 0.5 * omega, self.duration)
    }
}

impl MovingPoint {
    /// Returns the bounds on speed and acceleration.
    fn bounds(&self) -> (f64, f64) {
        (self.speed, self.acceleration)
    }

    fn translate(&mut self, displacement: [Vector3<f64>; 2], bounds: Derivatives) {
        for (end, displacement) in self.ends.iter_mut().zip(displacement) {
            *end += displacement;
        }
        self.speed += bounds.speed;
        self.acceleration += bounds.acceleration;
    }

    /// Updates the bounds for a rotation about an axis at a rate in radians. The positions err by at most
    /// `rounding`.
    fn turn(&mut self, axis: &RotaryAxis, rate: f64, duration: f64, rounding: f64) {
        let [start, end] = self.ends.map(|end| axis.direction.cross(&axis.arm(&end)).norm());
        let chord = self.acceleration * duration * duration / 8.0;
        let distance = start.max(end) + chord + rounding;
        self.acceleration += rate * (2.0 * self.speed + rate * distance);
        self.speed += rate * distance;
    }
}

/// Returns an upper bound on the distance between a curve on a unit sphere and the great circle between its
/// ends at constant speed, at the same time. `curvature` bounds the tangential acceleration and `speed` the
/// speed of the curve on an interval of the given duration. The bound is at least 2, which says nothing,
/// where the ends may be a quarter turn apart.
fn geodesic_deviation(curvature: f64, speed: f64, duration: f64) -> f64 {
    let (bend, angle) = (curvature * duration * duration, speed * duration);
    if angle.is_nan() || angle >= FRAC_PI_2 {
        return 2.0;
    }
    let rough = (bend + 2.0 * angle * angle) / 8.0;
    let factor = 1.0 - angle - angle * angle / 8.0;
    if factor > 0.0 { rough.min(bend / 8.0 / factor) } else { rough }
}
