//! What the machine cannot follow in a joint motion: limits of axes, and singular passes, in which a rotary axis turns far while
//! the tool axis hardly moves.

use super::Letter;
use super::chain::{angle_about, angle_between, radians_to_degrees};
use super::motion::JointMotion;
use nalgebra::Vector3;

/// Largest distance, in mm, by which a linear joint may exceed a limit without being found. Limits of
/// controls are given to 1e-3 mm.
const TOLERANCE: f64 = 1e-4;

/// The same of a rotary joint, in degrees: increments are sums of rounded numbers.
const ANGLE_TOLERANCE: f64 = 1e-6;

/// Largest number of intervals that are examined for one motion.
const MAX_INTERVALS: usize = 1 << 16;

/// An axis that leaves its limits during a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitViolation {
    /// The axis.
    pub letter: Letter,
    /// Time from 0 to 1 at which the axis is farthest beyond the limit.
    pub fraction: f64,
    /// Joint value at this time, in mm or degrees.
    pub value: f64,
    /// The limit, in mm or degrees.
    pub limit: f64,
    /// True if the axis takes the value. False if the search ended before it could rule out that the axis
    /// leaves its limits near this time: the value is then an upper or lower bound.
    pub is_reached: bool,
}

impl LimitViolation {
    /// Returns the violation of a joint that stands at a value.
    pub(crate) fn of_joint(letter: Letter, value: f64, [low, high]: [f64; 2]) -> Option<Self> {
        let tolerance = if letter.is_rotary() { ANGLE_TOLERANCE } else { TOLERANCE };
        let limit = if value > high { high } else { low };
        let is_beyond = value > high + tolerance || value < low - tolerance;
        is_beyond.then_some(LimitViolation {
            letter,
            fraction: 1.0,
            value,
            limit,
            is_reached: true,
        })
    }

    /// Returns how far the value is beyond the limit, in mm or degrees.
    pub(crate) fn excess(&self) -> f64 {
        (self.value - self.limit).abs()
    }
}

/// An interval of time with the values of a linear joint at both ends.
#[derive(Clone, Copy)]
struct TimeSpan {
    times: [f64; 2],
    values: [f64; 2],
}

impl JointMotion {
    /// Returns the axes that leave their limits during the motion, each limit at most once. With an empty
    /// list, no rotary joint exceeds a limit by more than 1e-6°, and no linear joint does by more than 1e-4 mm and rounding.
    ///
    /// Rotary joints are monotone. The range of a linear joint on an interval of duration Δ exceeds that of
    /// its ends by at most sup|q″| Δ²/8, as derived for the [deviation](JointMotion::deviation). Intervals
    /// are halved until this decides.
    pub fn check_limits(&self) -> Vec<LimitViolation> {
        let mut violations = Vec::new();
        for index in 0..3 {
            let [low, high] = self.chain.limits[index];
            for (limit, sign) in [(low, -1.0), (high, 1.0)] {
                if limit.is_finite() {
                    violations.extend(self.linear_violation(index, limit, sign));
                }
            }
        }
        for letter in [Letter::A, Letter::B, Letter::C] {
            let values = self.rotary_ends(letter);
            let [low, high] = self.chain.limits[letter.index()];
            for (limit, sign) in [(low, -1.0), (high, 1.0)] {
                // A rotary joint is monotone, so that it is farthest at an end.
                let last = usize::from(sign * values[1] > sign * values[0]);
                if sign * (values[last] - limit) > ANGLE_TOLERANCE {
                    violations.push(LimitViolation {
                        letter,
                        fraction: last as f64,
                        value: values[last],
                        limit,
                        is_reached: true,
                    });
                }
            }
        }
        violations
    }

    /// Searches the greatest excess of a linear joint over a limit. `sign` is 1 for an upper limit, −1 for a
    /// lower.
    fn linear_violation(&self, index: usize, limit: f64, sign: f64) -> Option<LimitViolation> {
        let excess = |value: f64| sign * (value - limit);
        let none = LimitViolation {
            letter: Letter::ALL[index],
            fraction: 0.0,
            value: limit,
            limit,
            is_reached: false,
        };
        let ends = [0.0, 1.0].map(|t| self.joints(t)[index]);
        let mut spans = vec![TimeSpan { times: [0.0, 1.0], values: ends }];
        let mut worst: Option<LimitViolation> = None;
        // An excess within rounding is none.
        let mut least = self.position_error;
        let mut examined = 0;
        while let Some(TimeSpan { times, values: ends }) = spans.pop() {
            for (fraction, value) in times.into_iter().zip(ends) {
                if excess(value) > least {
                    least = excess(value);
                    worst = Some(LimitViolation { fraction, value, is_reached: true, ..none });
                }
            }
            let duration = times[1] - times[0];
            let bulge = self.linear_acceleration(times[0], times[1]) * duration * duration / 8.0;
            let bound = excess(ends[0]).max(excess(ends[1])) + bulge;
            if bound <= least + TOLERANCE {
                continue;
            }
            let middle = 0.5 * (times[0] + times[1]);
            examined += 1;
            if examined > MAX_INTERVALS {
                let value = limit + sign * bound;
                return worst.or(Some(LimitViolation { fraction: middle, value, ..none }));
            }
            let centre = self.joints(middle)[index];
            spans.push(TimeSpan { times: [times[0], middle], values: [ends[0], centre] });
            spans.push(TimeSpan { times: [middle, times[1]], values: [centre, ends[1]] });
        }
        worst
    }
}

/// Greatest angle between the tool axis and a rotary axis at which a pass counts as singular, in degrees. The
/// tool axis then turns by at most sin 5° = 0.087 of the angle of the rotary axis.
pub const SINGULAR_ANGLE: f64 = 5.0;

/// Least turn of the rotary axis in a singular pass, in degrees.
pub const SINGULAR_TURN: f64 = 90.0;

/// A part of a motion in which a rotary axis turns by at least [`SINGULAR_TURN`] while the tool axis is
/// within [`SINGULAR_ANGLE`] of its direction, or of the opposite one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SingularPass {
    /// The rotary axis.
    pub letter: Letter,
    /// Times at which the pass begins and ends, from 0 to 1.
    pub fractions: [f64; 2],
    /// Turn of the rotary axis in the pass, in degrees, positive.
    pub turn: f64,
    /// Angle between tool axis and rotary axis in the middle of the pass, in degrees, from 0 to 90.
    pub angle: f64,
}

impl JointMotion {
    /// Returns the singular pass with the largest turn, if there is one. A machine with fewer than two rotary
    /// axes has none.
    ///
    /// Let d₁ be the direction of the rotary axis on the side of the workpiece, d₂ that of the other, and a₀
    /// = +z. The sensitivity of the tool axis to the first axis is |∂a/∂q₁| = |d₁ × a|, the sine of the angle
    /// between both, and depends on the other axis alone: d₁ · a = d₁ · R(d₂, q₂) a₀ = c + s cos(q₂ − ψ),
    /// where c = (d₁ · d₂)(d₂ · a₀), s is the product of the sines of the angles of d₂ with d₁ and a₀, and q₂
    /// = ψ puts a into the plane of d₁ and d₂. The tool axis is near d₁ or −d₁ where this is at least cos 5°,
    /// or at most −cos 5°: on intervals of q₂ about ψ or ψ + 180°. The sensitivity to the other axis is
    /// constant.
    pub fn singular_pass(&self) -> Option<SingularPass> {
        let [first, second] = self.chain.rotary() else { return None };
        let [turn, tilt] = [first, second].map(|axis| {
            let [start, end] = self.rotary_ends(axis.letter);
            end - start
        });
        if turn.abs() < SINGULAR_TURN {
            return None;
        }
        let (d1, d2, z) = (first.direction, second.direction, Vector3::z());
        let constant = d1.dot(&d2) * d2.z;
        let amplitude = d1.cross(&d2).norm() * d2.cross(&z).norm();
        let [start, _] = self.rotary_ends(second.letter);
        // Without an amplitude the sensitivity is constant, and any angle will do.
        let nearest = if amplitude > 0.0 { angle_about(&d2, &z, &d1) } else { 0.0 };
        let cosine = SINGULAR_ANGLE.to_radians().cos();
        let mut longest: Option<[f64; 2]> = None;
        // Near d₁: c + s cos x ≥ cos 5°. Near −d₁: −c + s cos(x − 180°) ≥ cos 5°.
        for (centre, offset) in [(nearest, constant), (nearest + 180.0, -constant)] {
            if amplitude + offset < cosine {
                continue;
            }
            let ratio = (cosine - offset) / amplitude;
            let half_width = if ratio <= -1.0 || amplitude == 0.0 {
                f64::INFINITY
            } else {
                radians_to_degrees(ratio.min(1.0).acos())
            };
            let whole = |angle: f64| 360.0 * ((angle - centre) / 360.0).round();
            if tilt == 0.0 || half_width.is_infinite() {
                // The angle between both axes is constant, or small enough at any angle: the whole motion is the pass, or none.
                let away = (start - centre - whole(start)).abs();
                if half_width.is_infinite() || away <= half_width {
                    longest = longer(longest, [0.0, 1.0]);
                }
                continue;
            }
            // All passes within the motion are as long as another: the first whole one, or one that an end
            // cuts.
            let step = 360.0f64.copysign(tilt);
            for turns in [whole(start), whole(start) + step, whole(start + tilt)] {
                let reach = half_width.copysign(tilt);
                let fractions =
                    [-reach, reach].map(|offset| (centre + turns + offset - start) / tilt);
                if fractions[1] > 0.0 && fractions[0] < 1.0 {
                    longest = longer(longest, fractions);
                }
            }
        }
        let [from, to] = longest?;
        let pass_turn = turn.abs() * (to - from);
        let middle = 0.5 * (from + to);
        let turns = self.turns(middle);
        let axis = Vector3::from(turns[1].column(2));
        let angle = radians_to_degrees(angle_between(&d1, &axis));
        (pass_turn >= SINGULAR_TURN).then_some(SingularPass {
            letter: first.letter,
            fractions: [from, to],
            turn: pass_turn,
            angle: angle.min(180.0 - angle),
        })
    }
}

/// Returns the longer of two parts of a motion, the first if they are equally long. The second may reach beyond the motion.
fn longer(longest: Option<[f64; 2]>, fractions: [f64; 2]) -> Option<[f64; 2]> {
    let [from, to] = fractions.map(|fraction| fraction.clamp(0.0, 1.0));
    if longest.is_none_or(|[a, b]| to - from > b - a) { Some([from, to]) } else { longest }
}
