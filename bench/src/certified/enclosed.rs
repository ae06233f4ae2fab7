//! Tools entirely inside a block of material, and tools just cut by one of its faces.
//!
//! One face of the block is a small distance inside or outside the tool's extent, and the others are farther away. The
//! tool's extent in that direction is known from its dimensions, so the correct verdict is known.

use super::depth_oracle::DepthOracle;
use nalgebra::{Point3, Vector3};
use touchoff::certify::{Certifier, PoseVerdict, TriangleBvh};
use touchoff::mesh::shapes;
use touchoff::{Mesh, Pose, Tool};
use touchoff_tests::oracle::rng::Rng;

/// The verdicts for a tool.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// The tool's name.
    pub tool: String,
    /// Number of poses entirely inside, and number of them with that verdict.
    pub inside: [usize; 2],
    /// Number of poses at which a face cuts the tool, and number of them with the verdict of touching.
    pub cut: [usize; 2],
    /// Verdicts that are neither correct nor undecided.
    pub violations: Vec<String>,
}

/// Checks the verdicts on `count` random blocks around a tool.
///
/// # Panics
/// If the certifier rejects the tool.
pub fn measure(tool: &dyn Tool, subject: &DepthOracle, count: usize, seed: u64) -> Row {
    let mut rng = Rng::new(seed);
    let info = tool.info();
    let mut row = Row { tool: info.name.to_string(), ..Row::default() };
    let [radius, height] = subject.oracle().extent();
    let size = radius.max(height);
    for _ in 0..count {
        let gap = size * 10f64.powf(rng.between(subject.min_gap().log10(), -1.0));
        let inside = rng.bits().is_multiple_of(2);
        let near_face = rng.bits() as usize % 6;
        let extent = [radius, radius, 0.0, radius, radius, height];
        let faces: [f64; 6] = std::array::from_fn(|face| {
            let margin = if face == near_face && inside {
                gap
            } else if face == near_face {
                -gap.min(0.1 * radius)
            } else {
                size * rng.between(0.2, 1.0)
            };
            let coordinate = extent[face] + margin;
            if face < 3 { -coordinate } else { coordinate }
        });
        let low = Point3::new(faces[0], faces[1], faces[2]);
        let block = shapes::cuboid(low, Point3::new(faces[3], faces[4], faces[5]), info.unit);
        let tip = Point3::from(rng.direction()) * size;
        let pose = Pose::from_axis(tip, Vector3::from(rng.direction())).expect("an axis");
        let block = to_world(&block.expect("a cuboid"), &pose);
        let bvh = TriangleBvh::new(&block);
        let mut certifier = Certifier::new(&bvh, tool).expect("a tool that is proved");
        let verdict = certifier.check_pose(&pose);
        let counts = if inside { &mut row.inside } else { &mut row.cut };
        counts[0] += 1;
        match (inside, verdict) {
            (true, PoseVerdict::Inside(_)) | (false, PoseVerdict::Touching(_)) => counts[1] += 1,
            (_, PoseVerdict::Undecided(_)) => {}
            _ => row.violations.push(format!(
                "{} with a gap of {gap:e} at face {near_face}, inside {inside}: {verdict:?} at {pose:?}",
                info.name
            )),
        }
    }
    row
}

/// Transforms a mesh from the tool's frame to the world frame.
fn to_world(mesh: &Mesh, pose: &Pose) -> Mesh {
    let transform = |p: &Point3<f64>| pose.tip() + pose.rotation() * p.coords;
    let vertices = mesh.vertices().iter().map(transform).collect();
    Mesh::new(vertices, mesh.triangles().to_vec(), mesh.unit()).expect("a mesh as before")
}
