//! A picture of the points that a path leaves out.

use super::picture::SIDE;
use crate::failure::Failure;
use crate::output::file_name;
use crate::picture::render::{Facet, Paint};
use crate::picture::{Heading, Legend, NOTHING, sheet};
use nalgebra::{Point3, Vector3};
use std::path::Path;
use touchoff::{Escaped, Mesh};
use touchoff_postures::path::{LeftOutReason, ToolPath};

/// Colours of points that are not reached, and of those without a proved motion.
const COLOURS: [[u8; 3]; 2] = [[204, 60, 50], [40, 90, 200]];

/// Radius of a point, as a fraction of the part's diagonal.
const RADIUS: f64 = 0.004;

/// Draws a part with the points that a path over it leaves out, as a PNG.
///
/// # Errors
/// If the picture cannot be made.
pub(super) fn picture(
    mesh: &Mesh,
    part: &Path,
    tool: &str,
    path: &ToolPath,
) -> Result<Vec<u8>, Failure> {
    let plain = mesh.ids().map(|id| mesh.triangle(id));
    let plain = plain.map(|corners| Facet { corners, paint: Paint::Plain(NOTHING) });
    let [low, high] = mesh.bounds();
    let radius = RADIUS * (high - low).norm();
    let colour = |reason| COLOURS[usize::from(reason == LeftOutReason::NoMotion)];
    let points = path.left_out.iter().flat_map(|left_out| {
        let paint = Paint::Value(colour(left_out.reason));
        octahedron(left_out.point, radius).map(|corners| Facet { corners, paint })
    });
    let facets: Vec<Facet> = plain.chain(points).collect();
    let count = |reason| path.count_left_out(reason);
    let keys = [
        (COLOURS[0], format!("not reached: {} points", count(LeftOutReason::NotReached))),
        (COLOURS[1], format!("without a proved motion: {} points", count(LeftOutReason::NoMotion))),
        (NOTHING, "the part".to_owned()),
    ];
    let heading = Heading {
        title: format!("{}: points left out by the path", Escaped(&file_name(part))),
        subtitle: format!("{}", Escaped(tool)),
    };
    sheet(&facets, &heading, &Legend::Keys(&keys), mesh.unit(), SIDE)
}

/// Returns the triangles of an octahedron.
fn octahedron(centre: Point3<f64>, radius: f64) -> [[Point3<f64>; 3]; 8] {
    std::array::from_fn(|octant| {
        [0, 1, 2].map(|axis| {
            let side = if octant >> axis & 1 == 0 { radius } else { -radius };
            centre + Vector3::ith(axis, side)
        })
    })
}
