//! Contacts with closed-form solutions, on patches of parts that are many times as large.

use nalgebra::{Point3, Rotation3, Vector3};
use std::f64::consts::{PI, TAU};
use touchoff::mesh::shapes;
use touchoff::{Cloud, Mesh, Pose, Unit};
use touchoff_tests::oracle::closed_forms::{
    ball_in_cavity, ball_in_plane, ball_on_ball, cylinder_in_bore, cylinder_in_plane,
};
use touchoff_tests::oracle::rng::Rng;

/// Depth of the tool in the part, mm.
pub(super) const DEPTH: f64 = 0.1;
/// Radius of every tool at the contact, mm.
const TOOL_RADIUS: f64 = 1.0;
/// Length of the patches touched by the side of a cylinder, and the tool's z over their middle, mm.
const PATCH_LENGTH: f64 = 1.0;
const TIP_OFFSET: f64 = 3.0;
/// Half the side of the square that a ball touches, and half the length of the strip across a cylinder's side, mm.
const HALF_SQUARE: f64 = 2.2;
const HALF_STRIP: f64 = 6.0;
/// Radius of the touched ball or cavity, mm, and the angle from its pole to the border of its cap, rad.
const SPHERE_RADIUS: f64 = 4.0;
const CAP_ANGLE: f64 = 0.55;
/// Radius of the bore, mm, and the number of its flat faces.
const BORE_RADIUS: f64 = 3.0;
const BORE_FACES: u32 = 1024;
/// Distance from a contact to the patch's border, mm, so that the contact is complete.
const MARGIN: f64 = 0.1;

/// A contact with a closed-form solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Contact {
    /// CF1: a tilted ball in a square of a plane.
    BallInPlane,
    /// CF2: the side of a cylinder in a strip of a plane.
    SideInPlane,
    /// CF3: a ball on a cap of a ball.
    BallOnBall,
    /// CF4: a ball on a cap of a spherical cavity.
    BallInCavity,
    /// CF5: the side of a cylinder in a bore.
    SideInBore,
}

/// A pose of the tool with the exact force and torque.
#[derive(Clone, Debug)]
pub(super) struct Placement {
    /// The tool's pose.
    pub(super) pose: Pose,
    /// The force on the tool, by the thesis's law.
    pub(super) force: Vector3<f64>,
    /// The torque about the tool's tip.
    pub(super) torque: Vector3<f64>,
}

impl Contact {
    /// Returns its name among the closed forms.
    pub(super) fn name(self) -> &'static str {
        match self {
            Contact::BallInPlane => "CF1",
            Contact::SideInPlane => "CF2",
            Contact::BallOnBall => "CF3",
            Contact::BallInCavity => "CF4",
            Contact::SideInBore => "CF5",
        }
    }

    /// Returns a description of the tool and the patch.
    pub(super) fn description(self) -> &'static str {
        match self {
            Contact::BallInPlane => {
                "`Fig73Exact`'s ball, r = 1, tilted by up to 1, in a square of a plane 4.4 wide"
            }
            Contact::SideInPlane => {
                "`Fig73Exact`'s side, r = 1, in a strip of a plane 1 long and 12 wide, from end to end"
            }
            Contact::BallOnBall => {
                "`UnitSphere` on a cap, 0.55 to each side of its pole, of a ball of radius 4"
            }
            Contact::BallInCavity => {
                "`UnitSphere` on a cap, 0.55 to each side of its pole, of a spherical cavity of radius 4"
            }
            Contact::SideInBore => {
                "`Fig73Exact`'s side, r = 1, in a bore of radius 3 that is 1 long, from end to end"
            }
        }
    }

    /// Returns whether the part is a cap of a sphere, seen from outside or from inside.
    pub(super) fn is_sphere_cap(self) -> bool {
        matches!(self, Contact::BallOnBall | Contact::BallInCavity)
    }

    /// Returns whether the patch's triangles are the true surface.
    pub(super) fn is_flat(self) -> bool {
        matches!(self, Contact::BallInPlane | Contact::SideInPlane)
    }

    /// Returns the distance between the centre of the touched ball or cavity and the tool's centre, mm.
    fn between_centres(self) -> f64 {
        match self {
            Contact::BallInCavity => SPHERE_RADIUS - TOOL_RADIUS + DEPTH,
            _ => TOOL_RADIUS + SPHERE_RADIUS - DEPTH,
        }
    }

    /// Returns the area of the part that is inside the tool, mm².
    pub(super) fn area(self) -> f64 {
        let half_width = (DEPTH * (2.0 * TOOL_RADIUS - DEPTH)).sqrt();
        match self {
            Contact::BallInPlane => PI * half_width * half_width,
            Contact::SideInPlane => 2.0 * half_width * PATCH_LENGTH,
            Contact::BallOnBall | Contact::BallInCavity => {
                let centre_distance = self.between_centres();
                let height = SPHERE_RADIUS
                    - (SPHERE_RADIUS * SPHERE_RADIUS + centre_distance * centre_distance
                        - TOOL_RADIUS * TOOL_RADIUS)
                        / (2.0 * centre_distance);
                TAU * SPHERE_RADIUS * height
            }
            Contact::SideInBore => {
                let offset = BORE_RADIUS - TOOL_RADIUS + DEPTH;
                let cos = (BORE_RADIUS * BORE_RADIUS + offset * offset - TOOL_RADIUS * TOOL_RADIUS)
                    / (2.0 * BORE_RADIUS * offset);
                2.0 * cos.acos() * BORE_RADIUS * PATCH_LENGTH
            }
        }
    }

    /// Returns the patch on which clouds are sampled.
    ///
    /// # Panics
    /// Never: the patches are valid meshes.
    pub(super) fn mesh(self) -> Mesh {
        const VALID: &str = "a sound patch";
        const UNIT: Unit = Unit::Millimetre;
        match self {
            Contact::BallInPlane => shapes::plane(HALF_SQUARE, 1, UNIT).expect(VALID),
            Contact::SideInPlane => {
                let [x, y] = [PATCH_LENGTH / 2.0, HALF_STRIP];
                let corners = [[-x, -y], [x, -y], [x, y], [-x, y]];
                let corners = corners.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
                Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]], UNIT).expect(VALID)
            }
            Contact::BallOnBall | Contact::BallInCavity => {
                let ball = shapes::sphere(SPHERE_RADIUS, 7, UNIT).expect(VALID);
                let low = SPHERE_RADIUS * CAP_ANGLE.cos();
                let is_in_cap = |[a, b, c]: &[u32; 3]| {
                    [a, b, c].iter().all(|i| ball.vertices()[**i as usize].z > low)
                };
                let mut cap: Vec<_> = ball.triangles().iter().copied().filter(is_in_cap).collect();
                if self == Contact::BallInCavity {
                    cap.iter_mut().for_each(|corners| corners.swap(1, 2));
                }
                Mesh::new(ball.vertices().to_vec(), cap, UNIT).expect(VALID)
            }
            Contact::SideInBore => {
                let rim_point = |i: u32, z: f64| {
                    let (sin, cos) = (TAU * f64::from(i) / f64::from(BORE_FACES)).sin_cos();
                    Point3::new(BORE_RADIUS * cos, BORE_RADIUS * sin, z)
                };
                let rim_points =
                    |i| [rim_point(i, -PATCH_LENGTH / 2.0), rim_point(i, PATCH_LENGTH / 2.0)];
                let face_triangles = |i: u32| {
                    let (a, b) = (2 * i, 2 * ((i + 1) % BORE_FACES));
                    [[a, a + 1, b], [b, a + 1, b + 1]]
                };
                let corners = (0..BORE_FACES).flat_map(rim_points);
                Mesh::new(corners, (0..BORE_FACES).flat_map(face_triangles), UNIT).expect(VALID)
            }
        }
    }

    /// Projects a cloud from the flat triangles to the true surface: points move along the radius, normals become
    /// exact, and weights scale with the area.
    ///
    /// # Panics
    /// Never: the lists of a valid cloud make a valid cloud.
    pub(super) fn exact(self, cloud: Cloud) -> Cloud {
        if self.is_flat() {
            return cloud;
        }
        let (mut points, mut normals, mut weights) = (vec![], vec![], vec![]);
        for ((point, normal), weight) in
            cloud.points().iter().zip(cloud.normals()).zip(cloud.weights())
        {
            let offset = match self {
                Contact::SideInBore => Vector3::new(point.x, point.y, 0.0),
                _ => point.coords,
            };
            let distance = offset.norm();
            let outward = offset / distance;
            let facing = outward.dot(normal).abs();
            // The area ratio of a cone (or a wedge) cut by the flat triangle and by the true surface.
            let (radius, area_ratio, normal) = match self {
                Contact::SideInBore => (BORE_RADIUS, BORE_RADIUS / distance, -outward),
                Contact::BallInCavity => {
                    (SPHERE_RADIUS, (SPHERE_RADIUS / distance).powi(2), -outward)
                }
                _ => (SPHERE_RADIUS, (SPHERE_RADIUS / distance).powi(2), outward),
            };
            points.push(point + outward * (radius - distance));
            normals.push(normal);
            weights.push(weight * facing * area_ratio);
        }
        let triangles = cloud.triangles().to_vec();
        Cloud::new(points, normals, triangles, weights, cloud.unit()).expect("a carried cloud")
    }

    /// Returns a random pose of the tool on the patch.
    ///
    /// # Panics
    /// Never: the poses are finite.
    pub(super) fn random_placement(self, rng: &mut Rng) -> Placement {
        let half_width = (DEPTH * (2.0 * TOOL_RADIUS - DEPTH)).sqrt();
        let tilt = |rng: &mut Rng, axis: Vector3<f64>, max_angle: f64| {
            let perpendicular = axis.cross(&Vector3::from(rng.direction())).normalize();
            Rotation3::new(perpendicular * rng.between(0.0, max_angle)) * axis
        };
        // The point about which the contact has no torque, the tool's axis, the distance from the tip to that point,
        // and the force.
        let (balance, axis, tip, force) = match self {
            Contact::BallInPlane => {
                let reach = HALF_SQUARE - half_width - MARGIN;
                let [x, y] = [0; 2].map(|_| rng.between(-reach, reach));
                let axis = tilt(rng, Vector3::z(), 1.0);
                let force = ball_in_plane(TOOL_RADIUS, DEPTH).force;
                (Point3::new(x, y, TOOL_RADIUS - DEPTH), axis, TOOL_RADIUS, force * Vector3::z())
            }
            Contact::SideInPlane => {
                let reach = HALF_STRIP - half_width - MARGIN;
                let balance = Point3::new(0.0, rng.between(-reach, reach), TOOL_RADIUS - DEPTH);
                let force = PATCH_LENGTH * cylinder_in_plane(TOOL_RADIUS, DEPTH).force;
                (balance, Vector3::x(), TIP_OFFSET, force * Vector3::z())
            }
            Contact::BallOnBall | Contact::BallInCavity => {
                // In a cavity the contact is wider than on a plane.
                let margin = if self == Contact::BallInCavity { 2.0 * MARGIN } else { MARGIN };
                let max_angle = CAP_ANGLE - (half_width + margin) / SPHERE_RADIUS;
                // Uniform over the cap.
                let z = rng.between(max_angle.cos(), 1.0);
                let (sin, cos) = rng.between(0.0, TAU).sin_cos();
                let radial = (1.0 - z * z).sqrt();
                let outward = Vector3::new(radial * cos, radial * sin, z);
                let force = match self {
                    Contact::BallInCavity => {
                        ball_in_cavity(TOOL_RADIUS, SPHERE_RADIUS, DEPTH).force
                    }
                    _ => ball_on_ball(TOOL_RADIUS, SPHERE_RADIUS, DEPTH).force,
                };
                let balance = Point3::from(self.between_centres() * outward);
                (balance, tilt(rng, outward, 3.0), TOOL_RADIUS, force * outward)
            }
            Contact::SideInBore => {
                let (sin, cos) = rng.between(0.0, TAU).sin_cos();
                let outward = Vector3::new(cos, sin, 0.0);
                let offset = BORE_RADIUS - TOOL_RADIUS + DEPTH;
                let force = PATCH_LENGTH * cylinder_in_bore(TOOL_RADIUS, BORE_RADIUS, offset).force;
                (Point3::from(offset * outward), Vector3::z(), TIP_OFFSET, force * outward)
            }
        };
        let arm = tip * axis;
        let pose = Pose::from_axis(balance - arm, axis).expect("a finite pose");
        Placement { pose, force, torque: arm.cross(&force) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projected_clouds_have_the_true_area() {
        let true_area = |contact| match contact {
            Contact::BallInPlane => 4.0 * HALF_SQUARE * HALF_SQUARE,
            Contact::SideInPlane => 2.0 * HALF_STRIP * PATCH_LENGTH,
            Contact::BallOnBall | Contact::BallInCavity => {
                TAU * SPHERE_RADIUS * SPHERE_RADIUS * (1.0 - CAP_ANGLE.cos())
            }
            Contact::SideInBore => TAU * BORE_RADIUS * PATCH_LENGTH,
        };
        for contact in [
            Contact::BallInPlane,
            Contact::SideInPlane,
            Contact::BallOnBall,
            Contact::BallInCavity,
            Contact::SideInBore,
        ] {
            let cloud = contact.exact(Cloud::centroids(&contact.mesh()));
            let area: f64 = cloud.weights().iter().sum();
            // The border of the cap is ragged by up to a triangle.
            let tolerance = if contact.is_sphere_cap() { 0.1 } else { 1e-5 };
            assert!((area / true_area(contact) - 1.0).abs() < tolerance, "{contact:?} {area}");
        }
    }
}
