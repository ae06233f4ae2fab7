//! Contacts with closed-form solutions, on patches of parts that are many times as large.

use nalgebra::{Point3, Rotation3, Vector3};
use std::f64::consts::{PI, TAU};
use touchoff::mesh::shapes;
use touchoff::{Cloud, Mesh, Pose, Unit};
use touchoff_tests::oracle::closed_forms::{
    ball_in_cavity, ball_in_plane, ball_on_ball, cylinder_in_bore, cylinder_in_plane,
};
use touchoff_tests::oracle::draw::Rng;

/// Depth of the tool in the part, mm.
pub(super) const DEPTH: f64 = 0.1;
/// Radius of every tool at the contact, mm.
const RADIUS: f64 = 1.0;
/// Length of the patches touched by the side of a cylinder, and the tool's z over their middle, mm.
const LONG: f64 = 1.0;
const MIDDLE: f64 = 3.0;
/// Half the side of the square that a ball touches, and half the length of the strip across a cylinder's side, mm.
const SQUARE: f64 = 2.2;
const ACROSS: f64 = 6.0;
/// Radius of the touched ball or cavity, mm, and the angle from its pole to the border of its cap, rad.
const PART: f64 = 4.0;
const CAP: f64 = 0.55;
/// Radius of the bore, mm, and the number of its flat faces.
const BORE: f64 = 3.0;
const FLATS: u32 = 1024;
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
pub(super) struct Placed {
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
    pub(super) fn about(self) -> &'static str {
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
    pub(super) fn is_of_a_sphere(self) -> bool {
        matches!(self, Contact::BallOnBall | Contact::BallInCavity)
    }

    /// Returns whether the patch's triangles are the true surface.
    pub(super) fn is_flat(self) -> bool {
        matches!(self, Contact::BallInPlane | Contact::SideInPlane)
    }

    /// Returns the distance between the centre of the touched ball or cavity and the tool's centre, mm.
    fn between_centres(self) -> f64 {
        match self {
            Contact::BallInCavity => PART - RADIUS + DEPTH,
            _ => RADIUS + PART - DEPTH,
        }
    }

    /// Returns the area of the part that is inside the tool, mm².
    pub(super) fn area(self) -> f64 {
        let half = (DEPTH * (2.0 * RADIUS - DEPTH)).sqrt();
        match self {
            Contact::BallInPlane => PI * half * half,
            Contact::SideInPlane => 2.0 * half * LONG,
            Contact::BallOnBall | Contact::BallInCavity => {
                let far = self.between_centres();
                let height = PART - (PART * PART + far * far - RADIUS * RADIUS) / (2.0 * far);
                TAU * PART * height
            }
            Contact::SideInBore => {
                let off = BORE - RADIUS + DEPTH;
                let cos = (BORE * BORE + off * off - RADIUS * RADIUS) / (2.0 * BORE * off);
                2.0 * cos.acos() * BORE * LONG
            }
        }
    }

    /// Returns the patch on which clouds are sampled.
    ///
    /// # Panics
    /// Never: the patches are valid meshes.
    pub(super) fn mesh(self) -> Mesh {
        const SOUND: &str = "a sound patch";
        const UNIT: Unit = Unit::Millimetre;
        match self {
            Contact::BallInPlane => shapes::plane(SQUARE, 1, UNIT).expect(SOUND),
            Contact::SideInPlane => {
                let [x, y] = [LONG / 2.0, ACROSS];
                let corners = [[-x, -y], [x, -y], [x, y], [-x, y]];
                let corners = corners.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
                Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]], UNIT).expect(SOUND)
            }
            Contact::BallOnBall | Contact::BallInCavity => {
                let ball = shapes::sphere(PART, 7, UNIT).expect(SOUND);
                let low = PART * CAP.cos();
                let above = |[a, b, c]: &[u32; 3]| {
                    [a, b, c].iter().all(|i| ball.vertices()[**i as usize].z > low)
                };
                let mut cap: Vec<_> = ball.triangles().iter().copied().filter(above).collect();
                if self == Contact::BallInCavity {
                    cap.iter_mut().for_each(|corners| corners.swap(1, 2));
                }
                Mesh::new(ball.vertices().to_vec(), cap, UNIT).expect(SOUND)
            }
            Contact::SideInBore => {
                let at = |i: u32, z: f64| {
                    let (sin, cos) = (TAU * f64::from(i) / f64::from(FLATS)).sin_cos();
                    Point3::new(BORE * cos, BORE * sin, z)
                };
                let each = |i| [at(i, -LONG / 2.0), at(i, LONG / 2.0)];
                let flat = |i: u32| {
                    let (a, b) = (2 * i, 2 * ((i + 1) % FLATS));
                    [[a, a + 1, b], [b, a + 1, b + 1]]
                };
                let corners = (0..FLATS).flat_map(each).collect();
                Mesh::new(corners, (0..FLATS).flat_map(flat).collect(), UNIT).expect(SOUND)
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
            let from = match self {
                Contact::SideInBore => Vector3::new(point.x, point.y, 0.0),
                _ => point.coords,
            };
            let far = from.norm();
            let out = from / far;
            let facing = out.dot(normal).abs();
            // The area ratio of a cone (or a wedge) cut by the flat triangle and by the true surface.
            let (radius, grows, normal) = match self {
                Contact::SideInBore => (BORE, BORE / far, -out),
                Contact::BallInCavity => (PART, (PART / far).powi(2), -out),
                _ => (PART, (PART / far).powi(2), out),
            };
            points.push(point + out * (radius - far));
            normals.push(normal);
            weights.push(weight * facing * grows);
        }
        let triangles = cloud.triangles().to_vec();
        Cloud::new(points, normals, triangles, weights, cloud.unit()).expect("a carried cloud")
    }

    /// Returns a random pose of the tool on the patch.
    ///
    /// # Panics
    /// Never: the poses are finite.
    pub(super) fn place(self, draw: &mut Rng) -> Placed {
        let half = (DEPTH * (2.0 * RADIUS - DEPTH)).sqrt();
        let tilted = |draw: &mut Rng, up: Vector3<f64>, most: f64| {
            let across = up.cross(&Vector3::from(draw.direction())).normalize();
            Rotation3::new(across * draw.between(0.0, most)) * up
        };
        // The point about which the contact has no torque, the tool's axis, the distance from the tip to that point,
        // and the force.
        let (balance, axis, tip, push) = match self {
            Contact::BallInPlane => {
                let reach = SQUARE - half - MARGIN;
                let [x, y] = [0; 2].map(|_| draw.between(-reach, reach));
                let axis = tilted(draw, Vector3::z(), 1.0);
                let force = ball_in_plane(RADIUS, DEPTH).force;
                (Point3::new(x, y, RADIUS - DEPTH), axis, RADIUS, force * Vector3::z())
            }
            Contact::SideInPlane => {
                let reach = ACROSS - half - MARGIN;
                let balance = Point3::new(0.0, draw.between(-reach, reach), RADIUS - DEPTH);
                let force = LONG * cylinder_in_plane(RADIUS, DEPTH).force;
                (balance, Vector3::x(), MIDDLE, force * Vector3::z())
            }
            Contact::BallOnBall | Contact::BallInCavity => {
                // In a cavity the contact is wider than on a plane.
                let margin = if self == Contact::BallInCavity { 2.0 * MARGIN } else { MARGIN };
                let most = CAP - (half + margin) / PART;
                // Uniform over the cap.
                let z = draw.between(most.cos(), 1.0);
                let (sin, cos) = draw.between(0.0, TAU).sin_cos();
                let out = (1.0 - z * z).sqrt();
                let along = Vector3::new(out * cos, out * sin, z);
                let force = match self {
                    Contact::BallInCavity => ball_in_cavity(RADIUS, PART, DEPTH).force,
                    _ => ball_on_ball(RADIUS, PART, DEPTH).force,
                };
                let balance = Point3::from(self.between_centres() * along);
                (balance, tilted(draw, along, 3.0), RADIUS, force * along)
            }
            Contact::SideInBore => {
                let (sin, cos) = draw.between(0.0, TAU).sin_cos();
                let along = Vector3::new(cos, sin, 0.0);
                let off = BORE - RADIUS + DEPTH;
                let force = LONG * cylinder_in_bore(RADIUS, BORE, off).force;
                (Point3::from(off * along), Vector3::z(), MIDDLE, force * along)
            }
        };
        let arm = tip * axis;
        let pose = Pose::from_axis(balance - arm, axis).expect("a finite pose");
        Placed { pose, force: push, torque: arm.cross(&push) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn carried_clouds_have_the_true_area() {
        let true_area = |contact| match contact {
            Contact::BallInPlane => 4.0 * SQUARE * SQUARE,
            Contact::SideInPlane => 2.0 * ACROSS * LONG,
            Contact::BallOnBall | Contact::BallInCavity => TAU * PART * PART * (1.0 - CAP.cos()),
            Contact::SideInBore => TAU * BORE * LONG,
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
            let within = if contact.is_of_a_sphere() { 0.1 } else { 1e-5 };
            assert!((area / true_area(contact) - 1.0).abs() < within, "{contact:?} {area}");
        }
    }
}
