//! Paths of steps, mapped to joints or to the part's frame.

use super::StepFault;
use crate::gcode::StepPath;
use crate::machine::{LinearPath, Plane};
use nalgebra::{Matrix3, Vector3};

/// Largest distance between an arc and its chords, in mm, where the arc's plane is not parallel to two axes.
const CHORD_TOLERANCE: f64 = 2e-5;

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
            sweep: sweep.copysign(sweep * normal[axis]),
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
    let radius =
        |position: [f64; 3]| (position[first] - centre[0]).hypot(position[second] - centre[1]);
    let [from, to] = [start, end].map(radius);
    let largest = from.max(to);
    let angle = (8.0 * CHORD_TOLERANCE / largest).sqrt().clamp(1e-3, 0.5);
    let count = (sweep.abs() / angle).ceil().max(1.0);
    if count > MAX_CHORDS {
        let [degrees, limit] = [sweep.abs(), MAX_CHORDS * angle].map(f64::to_degrees);
        return Err(StepFault::LongArc { degrees, limit });
    }
    let begin = (start[second] - centre[1]).atan2(start[first] - centre[0]);
    let position = |k: f64| {
        let at = k / count;
        if k == count {
            return map.apply(end);
        }
        let (sine, cosine) = (begin + at * sweep).sin_cos();
        let radius = from + at * (to - from);
        let mut position = start;
        position[first] = centre[0] + radius * cosine;
        position[second] = centre[1] + radius * sine;
        position[normal] += at * (end[normal] - start[normal]);
        map.apply(position)
    };
    // The change of the radius adds 2 |r'| Δ to the second derivative.
    let step = sweep.abs() / count;
    let error = step * (largest * step + 2.0 * (to - from).abs() / count) / 8.0;
    let mut segments = Vec::new();
    let mut k = 0.0;
    while k < count {
        let path = LinearPath::Line { start: position(k), end: position(k + 1.0) };
        segments.push(Segment { fractions: [k / count, (k + 1.0) / count], path, error });
        k += 1.0;
    }
    Ok(segments)
}
