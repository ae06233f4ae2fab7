//! The rounding bounds of a wrench at their limits: each test has a contact for which one term of a bound is all that
//! covers the error.
//!
//! All points of a part are equal here, so that its tree stores them exactly and each has the same evaluation. The
//! exact sum is then the number of points times one product in 256 bits.

use super::parts;
use crate::prelude::*;
use touchoff::tool::PointEvaluation;
use touchoff::{Scene, Weights, Wrench};
use touchoff_tests::evaluations::evaluate_points;
use touchoff_tests::fixtures::ball;
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::space::{Triple, distance, exactly};
use touchoff_tests::oracle::vector::{add, dot, sub, vector_product};

/// A point in a tool whose tip is at the world's origin, where the difference of both is exact.
struct ExactContact {
    pose: Pose,
    /// The point in the tool's frame, as the query computes it.
    position: [f64; 3],
    evaluation: PointEvaluation,
    normal: Vector3<f64>,
}

impl ExactContact {
    fn new(tool: &dyn Tool, pose: Pose, point: Point3<f64>, normal: Vector3<f64>) -> ExactContact {
        let rotation = pose.rotation();
        let position = [0, 1, 2].map(|axis| {
            let column = rotation.column(axis);
            point.x * column[0] + point.y * column[1] + point.z * column[2]
        });
        let evaluation = evaluate_points(tool, Level::new(), &[position])[0].expect("a contact");
        ExactContact { pose, position, evaluation, normal }
    }

    /// Returns the part of one point, `count` times with the weight 1, and its contact. The tree stores the normal rounded.
    fn repeated(
        tool: &dyn Tool,
        pose: Pose,
        point: Point3<f64>,
        normal: Vector3<f64>,
        count: usize,
    ) -> (Part, ExactContact) {
        let part = parts::of(vec![point; count], vec![normal; count], vec![1.0; count]);
        let normal = Vector3::from(part.tree().normal(0));
        (part, ExactContact::new(tool, pose, point, normal))
    }

    /// Returns the rows of the rotation.
    fn rows(&self) -> [Triple; 3] {
        [0, 1, 2].map(|row| exactly(self.pose.rotation().row(row).transpose()))
    }

    /// Returns the force of `count` such points under the law of the thesis, in the world's frame: `m (n - R u)`.
    fn force(&self, count: usize) -> Triple {
        let direction = exactly(self.evaluation.direction);
        let scale = &Big::exactly(count as f64) * &Big::exactly(self.evaluation.magnitude);
        let (rows, normal) = (self.rows(), exactly(self.normal));
        [0, 1, 2].map(|k| &scale * &(&normal[k] - &dot(&rows[k], &direction)))
    }

    /// Returns the torque of that force about a point of the tool's frame, in the world's frame.
    fn torque(&self, count: usize, centre: Point3<f64>) -> Triple {
        let arm = sub(&exactly(self.position), &exactly(centre));
        let arm = self.rows().map(|row| dot(&row, &arm));
        vector_product(&arm, &self.force(count))
    }

    fn wrench(&self, tool: &dyn Tool, part: &Part, centre: Point3<f64>) -> Wrench {
        let mut probe = Probe::new(part, tool)
            .with_law(Law::Thesis)
            .with_weights(Weights::Unit)
            .with_centre(centre);
        probe.wrench(&self.pose)
    }
}

/// Asserts that force, torque and integral err by no more than the wrench states.
fn assert_bounded(contact: &ExactContact, count: usize, wrench: &Wrench, centre: Point3<f64>) {
    assert_eq!(wrench.colliding, count);
    let force = distance(&contact.force(count), wrench.force);
    let torque = distance(&contact.torque(count, centre), wrench.torque);
    let stated = wrench.rounding;
    assert!(force <= stated.force, "{count} points: {force:e} of {stated:?}");
    assert!(torque <= stated.torque, "{count} points: {torque:e} of {stated:?}");
    let ulps = f64::EPSILON / 2.0 * (count as f64 + 6.0) * wrench.integral;
    let integral = &Big::exactly(count as f64) * &Big::exactly(contact.evaluation.magnitude);
    let lost = (&integral - &Big::exactly(wrench.integral)).abs().to_f64();
    assert!(lost <= ulps, "{count} points: {lost:e} of the integral");
}

/// Runs a check at random contacts of the ball: its pose, with the tip at the origin, and a point in it.
fn at_contacts(seed: u64, rounds: usize, check: impl Fn(&dyn Tool, Pose, Point3<f64>, &mut Rng)) {
    let tool = ball();
    let mut rng = Rng::new(seed);
    for _ in 0..rounds {
        let pose = Pose::from_quaternion(Point3::origin(), rng.quaternion()).expect("a pose");
        let own =
            Vector3::new(0.0, 0.0, 3.0) + rng.between(0.3, 2.9) * Vector3::from(rng.direction());
        check(&tool, pose, Point3::from(pose.rotation() * own), &mut rng);
    }
}

/// The torque about a centre far away along the force is small, and its error that of the arm.
#[test]
fn the_torque_bound_covers_a_centre_far_along_the_force() {
    at_contacts(1, 20, |tool, pose, point, rng| {
        let normal = Vector3::from(rng.direction()).map(|part| f64::from(part as f32));
        let (part, contact) = ExactContact::repeated(tool, pose, point, normal, 1);
        let at_tip = contact.wrench(tool, &part, Point3::origin());
        let along = pose.rotation().transpose() * at_tip.force.normalize();
        for distance in [0.0, 1.0, 1e3, 1e6, 1e9] {
            let centre = Point3::from(distance * along);
            assert_bounded(&contact, 1, &contact.wrench(tool, &part, centre), centre);
        }
    });
}

/// A normal that is the direction out of the tool cancels it, and their own rounding is all that is left.
#[test]
fn the_force_bound_covers_normals_that_face_the_way_out() {
    at_contacts(2, 40, |tool, pose, point, _| {
        let out = ExactContact::new(tool, pose, point, Vector3::z()).evaluation.direction;
        let normal = pose.rotation() * Vector3::from(out);
        let (part, contact) = ExactContact::repeated(tool, pose, point, normal, 1);
        let wrench = contact.wrench(tool, &part, Point3::origin());
        assert!(wrench.force.norm() < 1e-6 * wrench.integral);
        assert_bounded(&contact, 1, &wrench, Point3::origin());
    });
}

/// The same number is added thousands of times, so that each addition is rounded the same way.
#[test]
fn the_force_bound_covers_the_additions_of_many_equal_points() {
    const COUNT: usize = 20_000;
    at_contacts(3, 8, |tool, pose, point, rng| {
        let normal = Vector3::from(rng.direction());
        let (part, contact) = ExactContact::repeated(tool, pose, point, normal, COUNT);
        let wrench = contact.wrench(tool, &part, Point3::origin());
        assert_bounded(&contact, COUNT, &wrench, Point3::origin());
    });
}

/// A force along its arm has no torque about the tip, only the error of the moments.
#[test]
fn the_torque_bound_covers_moments_that_cancel() {
    at_contacts(4, 40, |tool, pose, point, _| {
        let out = ExactContact::new(tool, pose, point, Vector3::z()).evaluation.direction;
        // The direction mirrored along the arm differs from itself along the arm.
        let (out, arm) = (pose.rotation() * Vector3::from(out), point.coords.normalize());
        let normal = out - 2.0 * out.dot(&arm) * arm;
        let (part, contact) = ExactContact::repeated(tool, pose, point, normal, 1);
        let wrench = contact.wrench(tool, &part, Point3::origin());
        assert!(wrench.torque.norm() < 1e-5 * wrench.integral, "{wrench:?}");
        assert_bounded(&contact, 1, &wrench, Point3::origin());
    });
}

/// Returns the wrench of a tool at a pose on parts of a scene.
fn scene_wrench<'a>(
    tool: &dyn Tool,
    pose: Pose,
    parts: impl IntoIterator<Item = &'a Part>,
) -> Wrench {
    let mut scene = Scene::new(parts::UNIT).with_law(Law::Thesis).with_weights(Weights::Unit);
    for part in parts {
        scene.add_part(part, Pose::default()).expect("millimetres");
    }
    let id = scene.add_tool(tool);
    scene.move_tool(id, pose);
    scene.wrench(id)
}

/// The first part is hardly touched, so that all of the error is that of the second.
#[test]
fn the_bounds_of_a_scene_cover_the_part_that_is_added_last() {
    for is_reversed in [false, true] {
        at_contacts(5, 20, |tool, pose, point, rng| {
            let barely = Point3::from(pose.rotation() * Vector3::new(0.0, 0.0, 1e-9));
            let [light, heavy] = [(barely, 1), (point, 40)].map(|(at, count)| {
                let normal = Vector3::from(rng.direction());
                let (part, contact) = ExactContact::repeated(tool, pose, at, normal, count);
                (part, [contact.force(count), contact.torque(count, Point3::origin())])
            });
            let order = if is_reversed { [&heavy.0, &light.0] } else { [&light.0, &heavy.0] };
            let wrench = scene_wrench(tool, pose, order);
            assert_eq!(wrench.colliding, 41);
            let one = Big::exactly(1.0);
            let [force, torque] = [0, 1].map(|k| add(&light.1[k], &heavy.1[k], &one));
            let [force, torque] =
                [distance(&force, wrench.force), distance(&torque, wrench.torque)];
            assert!(force <= wrench.rounding.force, "{force:e} of {:?}", wrench.rounding);
            assert!(torque <= wrench.rounding.torque, "{torque:e} of {:?}", wrench.rounding);
        });
    }
}

/// The same force is added a thousand times, so that each addition is rounded the same way.
#[test]
fn the_bounds_of_a_scene_cover_the_additions_of_many_equal_parts() {
    const COUNT: usize = 1000;
    at_contacts(6, 8, |tool, pose, point, rng| {
        let normal = Vector3::from(rng.direction());
        let (part, contact) = ExactContact::repeated(tool, pose, point, normal, 1);
        let wrench = scene_wrench(tool, pose, std::iter::repeat_n(&part, COUNT));
        assert_bounded(&contact, COUNT, &wrench, Point3::origin());
    });
}
