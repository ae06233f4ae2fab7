//! Differences of poses about a tool's compliance centre, in millimetres and radians.

use super::device::DeviceAxes;
use nalgebra::{Point3, Rotation3, Vector3, Vector6};
use touchoff::{Pose, PoseError};

/// The reference point and units for differences of poses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// The compliance centre, in the tool frame and the part's unit.
    pub(super) centre: Point3<f64>,
    /// The length of the part's unit in mm.
    pub(super) unit: f64,
    pub(super) axes: DeviceAxes,
}

impl Frame {
    fn centre_of(&self, pose: &Pose) -> Vector3<f64> {
        pose.tip().coords + pose.rotation() * self.centre.coords
    }

    /// Returns the displacement of the centre (mm) and the rotation vector (rad) from one pose to another, in the world
    /// frame. With five axes, the rotation is the shortest that takes one tool axis to the other.
    pub(super) fn between(&self, from: &Pose, to: &Pose) -> Vector6<f64> {
        let translation = (self.centre_of(to) - self.centre_of(from)) * self.unit;
        let rotation = match self.axes {
            DeviceAxes::Five => {
                let (sine, cosine) = (from.axis().cross(&to.axis()), from.axis().dot(&to.axis()));
                // The arc tangent is accurate at all angles. Of opposite axes no rotation is the shortest; none is
                // taken then.
                let size = sine.norm();
                if size > 0.0 { sine * (size.atan2(cosine) / size) } else { Vector3::zeros() }
            }
            DeviceAxes::Six => {
                let rotation = to.rotation() * from.rotation().transpose();
                Rotation3::from_matrix_unchecked(rotation).scaled_axis()
            }
        };
        join(&translation, &rotation)
    }

    /// Returns a pose after the displacement and rotation of `step`, as returned by `between`.
    ///
    /// # Errors
    /// Fails if the result is not a valid pose: the step is NaN or leads out of bounds.
    pub(super) fn moved(&self, pose: &Pose, step: &Vector6<f64>) -> Result<Pose, PoseError> {
        let [translation, rotation] = halves(step);
        let turned = Rotation3::from_scaled_axis(rotation);
        let centre = self.centre_of(pose) + translation / self.unit;
        // The centre moves by the step; the tip turns about it.
        let tip = Point3::from(centre - turned * (self.centre_of(pose) - pose.tip().coords));
        pose.rotated_to(turned.into_inner(), tip)
    }
}

pub(super) fn join(translation: &Vector3<f64>, rotation: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(translation.x, translation.y, translation.z, rotation.x, rotation.y, rotation.z)
}

pub(super) fn halves(vector: &Vector6<f64>) -> [Vector3<f64>; 2] {
    [0, 3].map(|row| vector.fixed_rows::<3>(row).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchoff::Pose;

    #[test]
    fn a_pose_moved_by_the_difference_is_the_other() {
        let centre = Point3::new(0.3, -0.2, 4.0);
        let a =
            Pose::from_quaternion(Point3::new(1., 2., 3.), [0.5, 0.5, 0.5, 0.5]).expect("a pose");
        let b =
            Pose::from_quaternion(Point3::new(1.5, 2., 2.), [0.6, 0.0, 0.0, 0.8]).expect("a pose");
        let frame = Frame { centre, unit: 25.4, axes: DeviceAxes::Six };
        let moved = frame.moved(&a, &frame.between(&a, &b)).expect("a pose");
        assert!((moved.tip() - b.tip()).norm() < 1e-13);
        assert!((moved.rotation() - b.rotation()).norm() < 1e-13);
        let frame = Frame { centre: Point3::origin(), axes: DeviceAxes::Five, ..frame };
        let moved = frame.moved(&a, &frame.between(&a, &b)).expect("a pose");
        assert!((moved.tip() - b.tip()).norm() < 1e-13);
        assert!((moved.axis() - b.axis()).norm() < 1e-13);
    }
}
