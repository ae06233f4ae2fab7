//! Paths of the linear part of a motion: lines and helical arcs.

use super::chain::{UNIT_ROUNDOFF, check_length, is_within};
use super::{JointError, Letter};
use nalgebra::Vector3;

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
        let moved = |position: [f64; 3]| [0, 1, 2].map(|k| position[k] + displacement[k]);
        match self {
            LinearPath::Line { start, end } => {
                LinearPath::Line { start: moved(start), end: moved(end) }
            }
            LinearPath::Arc { start, end, plane, centre, sweep } => {
                let [first, second, _] = plane.indices();
                let centre = [centre[0] + displacement[first], centre[1] + displacement[second]];
                LinearPath::Arc { start: moved(start), end: moved(end), plane, centre, sweep }
            }
        }
    }
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
    pub(super) fn new(path: &LinearPath) -> Result<PreparedPath, JointError> {
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
            check_length("the centre of the arc", value)?;
        }
        if !is_within(sweep, MAX_SWEEP) {
            let what = "the sweep of the arc in radians".to_owned();
            return Err(JointError::Range { what, value: sweep, limit: MAX_SWEEP });
        }
        let indices @ [first, second, _] = plane.indices();
        let arm = [start[first] - centre[0], start[second] - centre[1]];
        let last = rotated(-sweep, [end[first] - centre[0], end[second] - centre[1]]);
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
    pub(super) fn reach(&self) -> f64 {
        self.size
    }

    /// Returns a bound on the error of [`PreparedPath::at`] relative to the formula of [`LinearPath`], in mm.
    ///
    /// With u = 2⁻⁵³ and the size P of the path: a line errs by 4u P, and its ends are exact. The arm of an
    /// arc errs by u |sweep| from its angle, 3u from sine and cosine, 3u from the product, twice as much from
    /// its end, and 3u from the sums: 24u in all and 2u |sweep|, relative to P.
    pub(super) fn rounding(&self) -> f64 {
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
