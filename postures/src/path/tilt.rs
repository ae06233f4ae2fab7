//! The largest angle of the tool axis from +z of the part.

use nalgebra::Vector3;
use std::f64::consts::PI;

/// A limit of the angle between the tool axis and +z.
#[derive(Clone, Copy, Debug)]
pub(super) struct TiltLimit {
    /// Least z component of the axis.
    least: f64,
}

/// Rounding of a z component that is not counted as tilt. Where the axis is horizontal, it is 1e-12 rad.
const ROUNDING: f64 = 1e-12;

impl TiltLimit {
    /// Creates the limit from an angle in radians; `None` unless it is above 0 and at most π.
    pub(super) fn new(max_tilt: f64) -> Option<TiltLimit> {
        (max_tilt > 0.0 && max_tilt <= PI).then(|| TiltLimit { least: max_tilt.cos() - ROUNDING })
    }

    /// Returns whether an axis is within the limit.
    pub(super) fn allows(self, axis: &Vector3<f64>) -> bool {
        axis.z >= self.least
    }

    /// Returns whether an axis is within the limit while it turns from one direction to another, on a great circle.
    ///
    /// The circle is lowest at the direction d of -z in its plane. Between the ends the axis is lowest there, if d
    /// lies between them, and otherwise at an end.
    pub(super) fn allows_turn(self, from: &Vector3<f64>, to: &Vector3<f64>) -> bool {
        if !(self.allows(from) && self.allows(to)) {
            return false;
        }
        let normal = from.cross(to);
        let lowest = normal.cross(&normal.cross(&Vector3::z()));
        // Parallel and opposite directions, and horizontal circles, have no lowest direction.
        let Some(lowest) = lowest.try_normalize(0.0) else { return true };
        let is_between =
            from.cross(&lowest).dot(&normal) > 0.0 && lowest.cross(to).dot(&normal) > 0.0;
        !is_between || self.allows(&lowest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Directions;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn accepts_angles_above_0_and_up_to_pi() {
        for angle in [0.0, -1.0, 3.2, f64::NAN, f64::INFINITY] {
            assert!(TiltLimit::new(angle).is_none(), "{angle}");
        }
        assert!(TiltLimit::new(PI).expect("an angle").allows(&-Vector3::z()));
        assert!(!TiltLimit::new(3.1).expect("an angle").allows(&-Vector3::z()));
    }

    /// The lowest direction of a turn, by sampling it.
    #[test]
    fn a_turn_is_as_low_as_its_samples() {
        let directions = Directions::spread(40);
        let list: Vec<Vector3<f64>> =
            directions.list().iter().map(|direction| Vector3::from(*direction)).collect();
        let mut refused_between = 0;
        for angle in [0.4, 1.0, FRAC_PI_2, 2.0, 2.9] {
            let tilt = TiltLimit::new(angle).expect("an angle");
            for (from, to) in list.iter().flat_map(|from| list.iter().map(move |to| (from, to))) {
                let lowest = (0..=500)
                    .filter_map(|k| from.lerp(to, f64::from(k) / 500.0).try_normalize(1e-9))
                    .map(|axis| axis.z)
                    .fold(1.0, f64::min);
                // Samples miss the lowest direction by little.
                if (lowest - angle.cos()).abs() > 1e-3 && from.dot(to) > -0.99 {
                    assert_eq!(
                        tilt.allows_turn(from, to),
                        lowest > angle.cos(),
                        "{from} {to} {angle}"
                    );
                    let ends = tilt.allows(from) && tilt.allows(to);
                    refused_between += usize::from(ends && lowest < angle.cos());
                }
            }
        }
        assert!(refused_between > 10, "{refused_between}");
    }
}
