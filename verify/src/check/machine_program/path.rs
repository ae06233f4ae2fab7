//! Paths of steps as motions of joints or of the tip: lines, arcs, and rapid traverse in which each axis moves at its own rate.
//!
//! **Rapid traverse.** Without rapid interpolation a control starts all axes together, and each stops when it arrives: the path is straight
//! between two arrivals. Acceleration is not modelled. At rates that are not known the axes can be at any positions between
//! their ends: let u be the fraction that each axis has travelled. It is the least of 1 and t over the axis's time, and for
//! given u > 0 there are times for which all are reached at t = 1.

use super::StepFault;
use crate::gcode::{StepPath, band_radii};
use crate::machine::{Chain, JointError, JointMotion, Joints, Letter, LinearPath, Machine, Plane};
use nalgebra::{Matrix3, Vector3};

/// Distance between an arc and its chords, in mm, where the arc's plane is not parallel to two axes. [`Segment::error`] adds that of a
/// changing radius.
const CHORD_TOLERANCE: f64 = 2e-5;

/// Largest angle of a chord, in radians. It holds for radii below 0.00064 mm.
const MAX_CHORD_ANGLE: f64 = 0.5;

/// Largest number of chords of an arc.
const MAX_CHORDS: f64 = 100_000.0;

/// A map p ↦ R p + o of program coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Map {
    pub(super) rotation: Matrix3<f64>,
    pub(super) origin: Vector3<f64>,
}

impl Map {
    pub(super) fn apply(&self, position: [f64; 3]) -> [f64; 3] {
        (self.rotation * Vector3::from(position) + self.origin).into()
    }
}

/// A segment of a mapped path: the fractions of the step at which it begins and ends, and a bound on its distance from
/// the step's path at the same time, in mm.
pub(super) struct Segment {
    pub(super) fractions: [f64; 2],
    pub(super) path: LinearPath,
    pub(super) error: f64,
}

/// Maps the path of a step between two positions in program coordinates.
///
/// Arcs in planes that are parallel to two axes stay arcs. Others become chords.
pub(super) fn map(
    path: &StepPath,
    [start, end]: [[f64; 3]; 2],
    map: &Map,
) -> Result<Vec<Segment>, StepFault> {
    let [from, to] = [start, end].map(|position| map.apply(position));
    let StepPath::Arc { plane, centre, sweep } = *path else {
        let path = LinearPath::Line { start: from, end: to };
        return Ok(vec![Segment { fractions: [0.0, 1.0], path, error: 0.0 }]);
    };
    let [first, second] = plane.axes();
    let mut middle = start;
    (middle[first], middle[second]) = (centre[0], centre[1]);
    let middle = map.apply(middle);
    let normal: [f64; 3] = map.rotation.column(plane.normal()).into();
    // Rotations by quarter turns are exact.
    let parallel = (0..3).find(|k| normal[*k].abs() == 1.0);
    if let Some(axis) = parallel {
        let plane = [Plane::Yz, Plane::Zx, Plane::Xy][axis];
        let [first, second] = plane.axes();
        let path = LinearPath::Arc {
            start: from,
            end: to,
            plane,
            centre: [middle[first], middle[second]],
            // Seen from the other side of the plane, the arc turns the other way.
            sweep: if normal[axis] < 0.0 { -sweep } else { sweep },
        };
        return Ok(vec![Segment { fractions: [0.0, 1.0], path, error: 0.0 }]);
    }
    chords(plane, centre, sweep, [start, end], map)
}

/// Divides an arc into chords. A point that runs along the arc at a constant rate is at most r Δ²/8 from one that runs
/// along the chord, for a radius r and an angle Δ: the second derivative of its position is r Δ².
fn chords(
    plane: Plane,
    centre: [f64; 2],
    sweep: f64,
    [start, end]: [[f64; 3]; 2],
    map: &Map,
) -> Result<Vec<Segment>, StepFault> {
    let ([first, second], normal) = (plane.axes(), plane.normal());
    let [start_radius, end_radius] =
        [start, end].map(|end| (end[first] - centre[0]).hypot(end[second] - centre[1]));
    let max_radius = start_radius.max(end_radius);
    let angle = (8.0 * CHORD_TOLERANCE / max_radius).sqrt().min(MAX_CHORD_ANGLE);
    let count = (sweep.abs() / angle).ceil().max(1.0);
    if count > MAX_CHORDS {
        let [degrees, limit] = [sweep.abs(), MAX_CHORDS * angle].map(f64::to_degrees);
        return Err(StepFault::LongArc { degrees, limit });
    }
    let chords = count as u32;
    let start_angle = (start[second] - centre[1]).atan2(start[first] - centre[0]);
    let position = |k: u32| {
        // The last chord ends at the stated end, without the rounding of the angle.
        if k == chords {
            return map.apply(end);
        }
        let at = f64::from(k) / count;
        let (sine, cosine) = (start_angle + at * sweep).sin_cos();
        let radius = start_radius + at * (end_radius - start_radius);
        let mut position = start;
        position[first] = centre[0] + radius * cosine;
        position[second] = centre[1] + radius * sine;
        position[normal] += at * (end[normal] - start[normal]);
        map.apply(position)
    };
    // The change of the radius adds 2 |r'| Δ to the second derivative.
    let step = sweep.abs() / count;
    let error = step * (max_radius * step + 2.0 * (end_radius - start_radius).abs() / count) / 8.0;
    let chord = (0..chords).map(|k| Segment {
        fractions: [k, k + 1].map(|k| f64::from(k) / count),
        path: LinearPath::Line { start: position(k), end: position(k + 1) },
        error,
    });
    Ok(chord.collect())
}

/// Half the distance between the curves that stand for a band, in mm: less than an eighth of the usual resolution of a check, which 8
/// errors of a path have to keep.
const BAND_TOLERANCE: f64 = 1.2e-4;

/// Largest number of curves that stand for a band.
const MAX_CURVES: f64 = 512.0;

/// Curves for the band of an arc whose radii differ: arcs between the least and the greatest radius, each with its ends in program
/// coordinates, and the distance within which every point of the band has one, in mm. None for an arc without a band, or while rotary
/// axes turn.
pub(super) fn band(path: &StepPath, [start, end]: [Joints; 2]) -> (Vec<[Joints; 2]>, f64) {
    let none = (Vec::new(), 0.0);
    let StepPath::Arc { plane, centre, sweep } = *path else { return none };
    let [first, second] = plane.axes();
    let arms = [start, end].map(|end| [end[first] - centre[0], end[second] - centre[1]]);
    let radii = arms.map(|[u, v]| u.hypot(v));
    let Some([least, most]) = band_radii(arms, sweep).filter(|_| start[3..] == end[3..]) else {
        return none;
    };
    let count = ((most - least) / (2.0 * BAND_TOLERANCE)).ceil().min(MAX_CURVES);
    let curves = (0..=count as u32).map(|k| {
        let radius = least + f64::from(k) / count * (most - least);
        let mut ends = [start, end];
        for ((end, arm), own) in ends.iter_mut().zip(arms).zip(radii) {
            end[first] = centre[0] + arm[0] * (radius / own);
            end[second] = centre[1] + arm[1] * (radius / own);
        }
        ends
    });
    (curves.collect(), 0.5 * (most - least) / count)
}

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
pub(super) fn rapid(
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
    let ends = times.into_iter().map(|time| -> Joints {
        std::array::from_fn(|k| match time < durations[k] {
            true => start[k] + (end[k] - start[k]) * (time / durations[k]),
            false => end[k],
        })
    });
    let mut from = start;
    ends.map(|to| line(chain, [std::mem::replace(&mut from, to), to])).collect()
}

/// Returns the motion in which all axes move from one joint position to another in proportion.
///
/// # Errors
/// As for [`JointMotion::new`].
pub(super) fn line(chain: &Chain, ends: [Joints; 2]) -> Result<JointMotion, JointError> {
    let [(start, from), (end, to)] = ends.map(|[x, y, z, a, b, c]| ([x, y, z], [a, b, c]));
    JointMotion::new(chain, [from, to], &LinearPath::Line { start, end })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The error of chords does not grow with the radius, as what is as deep as some of it need not be found.
    #[test]
    fn chords_of_long_arcs_are_as_near_as_those_of_short_ones() {
        let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::x_axis(), 0.5);
        let tilt = Map { rotation: *turn.matrix(), origin: Vector3::zeros() };
        for radius in [10.0, 1e3, 6e5] {
            let sweep = 300.0 / radius;
            let path = StepPath::Arc { plane: Plane::Xy, centre: [0.0, radius], sweep };
            let end = [radius * sweep.sin(), radius * (1.0 - sweep.cos()), 0.0];
            let segments = map(&path, [[0.0; 3], end], &tilt).unwrap_or_default();
            assert!(segments.len() > 1, "{radius}");
            assert!(
                segments.iter().all(|segment| segment.error <= 1.001 * CHORD_TOLERANCE),
                "{radius}"
            );
        }
    }
}
