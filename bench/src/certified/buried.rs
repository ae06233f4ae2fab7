//! Tools wholly inside a block of material, and those that just are not.
//!
//! One face of the block is at a small distance from the tool's extent, inside it or outside, and the others are
//! farther. Where the tool ends in that direction is known from its numbers, so is the verdict.

use super::subject::Subject;
use nalgebra::{Point3, Vector3};
use touchoff::certify::{Certifier, Clear, Facets};
use touchoff::mesh::shapes;
use touchoff::{Mesh, Pose, Tool};
use touchoff_tests::oracle::draw::Draw;

/// The verdicts about a tool.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// The tool.
    pub tool: String,
    /// Poses at which it is wholly inside, and those of them with that verdict.
    pub inside: [usize; 2],
    /// Poses at which a face cuts it, and those of them with a verdict of touching.
    pub cut: [usize; 2],
    /// Verdicts that are neither true nor undecided.
    pub violations: Vec<String>,
}

/// Asks about so many blocks around a tool.
///
/// # Panics
/// If the tool is refused.
pub fn measure(tool: &dyn Tool, subject: &Subject, count: usize, seed: u64) -> Row {
    let mut draw = Draw::new(seed);
    let card = tool.card();
    let mut row = Row { tool: card.name.to_string(), ..Row::default() };
    let [radius, height] = subject.oracle().extent();
    let size = radius.max(height);
    for _ in 0..count {
        let gap = size * 10f64.powf(draw.between(subject.finest().log10(), -1.0));
        let inside = draw.bits().is_multiple_of(2);
        let near = draw.bits() as usize % 6;
        let extent = [radius, radius, 0.0, radius, radius, height];
        let faces: [f64; 6] = std::array::from_fn(|face| {
            let beyond = if face == near && inside {
                gap
            } else if face == near {
                -gap.min(0.1 * radius)
            } else {
                size * draw.between(0.2, 1.0)
            };
            let away = extent[face] + beyond;
            if face < 3 { -away } else { away }
        });
        let low = Point3::new(faces[0], faces[1], faces[2]);
        let block = shapes::cuboid(low, Point3::new(faces[3], faces[4], faces[5]), card.unit);
        let tip = Point3::from(draw.direction()) * size;
        let pose = Pose::from_axis(tip, Vector3::from(draw.direction())).expect("an axis");
        let block = placed(&block.expect("a cuboid"), &pose);
        let facets = Facets::new(&block);
        let mut certifier = Certifier::new(&facets, tool).expect("a tool that is proved");
        let found = certifier.clear(&pose);
        let told = if inside { &mut row.inside } else { &mut row.cut };
        told[0] += 1;
        match (inside, found) {
            (true, Clear::Inside(_)) | (false, Clear::Touching(_)) => told[1] += 1,
            (_, Clear::Undecided(_)) => {}
            _ => row.violations.push(format!(
                "{} with a gap of {gap:e} at face {near}, inside {inside}: {found:?} at {pose:?}",
                card.name
            )),
        }
    }
    row
}

/// A mesh of the tool's frame in the world.
fn placed(mesh: &Mesh, pose: &Pose) -> Mesh {
    let place = |p: &Point3<f64>| pose.tip() + pose.rotation() * p.coords;
    let vertices = mesh.vertices().iter().map(place).collect();
    Mesh::new(vertices, mesh.triangles().to_vec(), mesh.unit()).expect("a mesh as before")
}
