//! `parry3d`'s own query: `contact` between the tool as a compound of convex shapes and the part's triangles.
//!
//! The union of the shapes is exactly the tool. Housing, spindle and cutter are cylinders. The taper is a cone whose
//! apex lies inside the cutter; the ball is a ball. The spindle extends through the housing, so that its end there is
//! not a surface through which a triangle could leave it. The answer is the pair of a shape and a triangle with the
//! deepest overlap. It has one depth and no sum over the contact, hence no force and torque. It takes into account the
//! whole surface, not only points of it.

use crate::race::contender::{Answer, Contender};
use parry3d::math::{Pose as ParryPose, Rotation, Vector};
use parry3d::query::contact;
use parry3d::shape::{Compound, SharedShape, TriMesh};
use touchoff::{Mesh, Pose};

/// The tool as a compound shape and the part as a mesh.
pub struct ParryContact {
    tool: Compound,
    part: TriMesh,
}

impl ParryContact {
    /// Converts the part's triangles.
    ///
    /// # Panics
    /// If the mesh has no triangles.
    pub fn new(mesh: &Mesh) -> ParryContact {
        // The axes of parry's cylinders and cones are along y, with the cone's apex up. Here that y axis points from
        // the spindle to the tip, and positions are those of the centres.
        let rotation = Rotation::from_rotation_x(-std::f32::consts::FRAC_PI_2);
        let pose_at = |z: f32| ParryPose::from_parts(Vector::new(0.0, 0.0, z), rotation);
        let tool = Compound::new(vec![
            (pose_at(14.5), SharedShape::cylinder(5.5, 5.0)),
            (pose_at(13.5), SharedShape::cylinder(6.5, 3.0)),
            (pose_at(5.5), SharedShape::cone(1.5, 3.0)),
            (pose_at(3.5), SharedShape::cylinder(2.5, 1.0)),
            (pose_at(1.0), SharedShape::ball(1.0)),
        ]);
        let vertices = mesh.vertices().iter().map(|v| to_single([v.x, v.y, v.z])).collect();
        let part =
            TriMesh::new(vertices, mesh.triangles().to_vec()).expect("the tube has triangles");
        ParryContact { tool, part }
    }
}

fn to_single(v: [f64; 3]) -> Vector {
    Vector::new(v[0] as f32, v[1] as f32, v[2] as f32)
}

impl Contender for ParryContact {
    fn name(&self) -> &'static str {
        "parry-contact"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let isometry = pose.to_isometry();
        let q = isometry.rotation.coords.map(|c| c as f32);
        let parry_pose = ParryPose::from_parts(
            to_single(pose.tip().coords.into()),
            Rotation::from_xyzw(q.x, q.y, q.z, q.w).normalize(),
        );
        let deepest = contact(&parry_pose, &self.tool, &ParryPose::IDENTITY, &self.part, 0.0)
            .expect("parry knows contacts of compounds and meshes");
        let depth = deepest.map_or(0.0, |contact| -f64::from(contact.dist)).max(0.0);
        Answer { colliding: usize::from(deepest.is_some()), depth, wrench: None }
    }
}
