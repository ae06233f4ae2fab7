//! Rapid traverse in which each axis moves at its own rate.
//!
//! Without rapid interpolation a control starts all axes together, and each stops when it arrives: the path is straight
//! between two arrivals. Acceleration is not modelled. At rates that are not known the axes can be at any positions between
//! their ends: let u be the fraction that each axis has travelled. It is the least of 1 and t over the axis's time, and for
//! given u > 0 there are times for which all are reached at t = 1.

use crate::machine::{Chain, JointError, JointMotion, Joints, Letter, LinearPath, Machine};

/// Returns the rates of the axes in mm and degrees per minute, if the machine states them. Axes that it lacks do not
/// move.
pub(super) fn rates(machine: &Machine) -> Option<Joints> {
    let rates = Letter::ALL.map(|letter| match machine.axis(letter) {
        None => Some(f64::INFINITY),
        Some(axis) => axis.rapid,
    });
    let mut known = [0.0; 6];
    for (known, rate) in known.iter_mut().zip(rates) {
        *known = rate?;
    }
    Some(known)
}

/// Returns the motions from one joint position to another: one up to each time at which an axis arrives. Without rates,
/// all axes arrive together.
///
/// # Errors
/// As for [`JointMotion::new`].
pub(super) fn motions(
    chain: &Chain,
    rates: Option<&Joints>,
    [start, end]: [Joints; 2],
) -> Result<Vec<JointMotion>, JointError> {
    let durations: Joints = match rates {
        None => [1.0; 6],
        Some(rates) => std::array::from_fn(|k| (end[k] - start[k]).abs() / rates[k]),
    };
    let mut times = durations.to_vec();
    times.sort_by(f64::total_cmp);
    times.dedup();
    // Where some axis moves, the time at which resting axes arrive ends no motion.
    if times.len() > 1 && times[0] == 0.0 {
        times.remove(0);
    }
    let at = |time: f64| -> Joints {
        std::array::from_fn(|k| match time < durations[k] {
            true => start[k] + (end[k] - start[k]) * (time / durations[k]),
            false => end[k],
        })
    };
    let ends = times.into_iter().map(at);
    let mut from = start;
    ends.map(|to| line(chain, [std::mem::replace(&mut from, to), to])).collect()
}

/// Returns the motion in which all axes move from one joint position to another in proportion.
///
/// # Errors
/// As for [`JointMotion::new`].
pub(super) fn line(chain: &Chain, [start, end]: [Joints; 2]) -> Result<JointMotion, JointError> {
    let linear = |joints: Joints| [joints[0], joints[1], joints[2]];
    let rotary = |joints: Joints| [joints[3], joints[4], joints[5]];
    let path = LinearPath::Line { start: linear(start), end: linear(end) };
    JointMotion::new(chain, [rotary(start), rotary(end)], &path)
}
