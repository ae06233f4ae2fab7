//! What the benches of single calls are asked: many points about a tool, and poses along the tube.

use crate::oracle::draw::Draw;
use touchoff::scenes::{Path, tube};
use touchoff::tool::{Points, Tool};
use touchoff::{Cloud, Part, Pose};

/// Tools that the benches evaluate: one of straight lines and a ball, the thesis's by hand and by
/// profile, and one of many pieces.
pub const TOOLS: [&str; 4] = ["D2Ball", "Fig73", "Fig73Exact", "BullNoseHsk63"];

/// A tool of the library.
///
/// # Panics
/// If there is none of that name.
pub fn tool(name: &str) -> &'static dyn Tool {
    tools_library::find(name).expect("a tool of the library")
}

/// Points within 5 % of the tool's radius of its outline, inside or not: what the tree leaves of a
/// cloud. Of more than some 16,000 a processor cannot learn which branches they take.
pub fn near(tool: &dyn Tool, count: usize) -> Points {
    let card = tool.card();
    let ([low, high], radius) = (card.reach(), card.radius());
    let mut draw = Draw::new(1);
    let mut points = Points::default();
    while points.len() < count {
        let z = draw.between(low, high);
        let slabs = card.envelope.iter().filter(|slab| (slab.low..=slab.high).contains(&z));
        let outline = slabs.fold(0.0, |most, slab| slab.radius.max(most));
        let d = outline + draw.between(-0.05, 0.05) * radius;
        let (sin, cos) = draw.between(0.0, std::f64::consts::TAU).sin_cos();
        points.push([d * cos, d * sin, z]);
    }
    points
}

/// The tube as so many points.
///
/// # Panics
/// Of no points.
pub fn part(points: usize) -> Part {
    let mesh = tube();
    let cloud = Cloud::random(&mesh, points, 1).expect("the tube has a surface");
    Part::new(&cloud, mesh.survey())
}

/// A path cut into poses.
pub fn poses(path: Path, count: usize) -> Vec<Pose> {
    (0..count).map(|k| path.pose(k, count)).collect()
}
