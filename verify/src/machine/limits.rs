//! Limits of axes during a joint motion.

use super::Letter;
use super::motion::JointMotion;

/// Largest distance, in mm, by which a linear joint may exceed a limit without being found. Limits of
/// controls are given to 1e-3 mm.
const TOLERANCE: f64 = 1e-4;

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

/// An interval of time with the linear joint values at both ends.
#[derive(Clone, Copy)]
struct TimeSpan {
    times: [f64; 2],
    values: [[f64; 3]; 2],
}

impl JointMotion {
    /// Returns the axes that leave their limits during the motion, each limit at most once. With an empty
    /// list, no rotary joint exceeds a limit, and no linear joint does by more than 1e-4 mm and rounding.
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
                let last = usize::from(sign * values[1] > sign * values[0]);
                if sign * (values[last] - limit) > 0.0 {
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
        let values = |t: f64| -> [f64; 3] {
            let [x, y, z, ..] = self.joints(t);
            [x, y, z]
        };
        let found = |fraction: f64, value: f64, is_reached: bool| LimitViolation {
            letter: Letter::ALL[index],
            fraction,
            value,
            limit,
            is_reached,
        };
        let mut spans = vec![TimeSpan { times: [0.0, 1.0], values: [values(0.0), values(1.0)] }];
        let mut worst: Option<LimitViolation> = None;
        // An excess within rounding is none.
        let least = |worst: Option<LimitViolation>| {
            worst.map_or(self.position_error, |worst| excess(worst.value))
        };
        let mut examined = 0;
        while let Some(TimeSpan { times, values: ends }) = spans.pop() {
            for (time, end) in times.iter().zip(&ends) {
                if excess(end[index]) > least(worst) {
                    worst = Some(found(*time, end[index], true));
                }
            }
            let duration = times[1] - times[0];
            let bulge = self.linear_acceleration(times[0], times[1]) * duration * duration / 8.0;
            let bound = excess(ends[0][index]).max(excess(ends[1][index])) + bulge;
            if bound <= least(worst) + TOLERANCE {
                continue;
            }
            let middle = 0.5 * (times[0] + times[1]);
            examined += 1;
            if examined > MAX_INTERVALS {
                return worst.or(Some(found(middle, limit + sign * bound, false)));
            }
            let centre = values(middle);
            spans.push(TimeSpan { times: [times[0], middle], values: [ends[0], centre] });
            spans.push(TimeSpan { times: [middle, times[1]], values: [centre, ends[1]] });
        }
        worst
    }
}
