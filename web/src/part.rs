//! Parts: a file's, or generated ones.

use crate::error::EngineError;
use nalgebra::Point3;
use serde::Serialize;
use touchoff::mesh::Geometry;
use touchoff::{Mesh, Part, Sampling, Unit, scenes};

/// A part with the mesh that it was sampled from.
#[derive(Debug)]
pub(crate) struct LoadedPart {
    pub(crate) part: Part,
    pub(crate) mesh: Mesh,
}

/// The facts about a part that the page shows.
#[derive(Debug, Serialize)]
pub(crate) struct PartFacts {
    unit: &'static str,
    /// The length of the unit in mm.
    millimetres: f64,
    triangles: usize,
    points: usize,
    /// The covering radius of the points.
    covering_radius: Option<f64>,
    lowest: [f64; 3],
    highest: [f64; 3],
    /// The findings about the mesh, as sentences.
    findings: Vec<String>,
}

impl LoadedPart {
    pub(crate) fn new(mesh: Mesh, points: usize) -> Result<LoadedPart, EngineError> {
        let part = Part::from_mesh(&mesh, Sampling::new(points))?;
        Ok(LoadedPart { part, mesh })
    }

    pub(crate) fn facts(&self) -> PartFacts {
        let tree = self.part.tree();
        let [lowest, highest] = self.mesh.bounds();
        PartFacts {
            unit: self.mesh.unit().symbol(),
            millimetres: self.mesh.unit().millimetres(),
            triangles: self.mesh.triangles().len(),
            points: tree.len(),
            covering_radius: tree.covering_radius().map(|cover| cover.radius),
            lowest: lowest.coords.into(),
            highest: highest.coords.into(),
            findings: self.mesh.diagnostics().findings(),
        }
    }

    /// Returns the corners of all triangles, 9 values per triangle.
    pub(crate) fn positions(&self) -> Vec<f32> {
        let corners = self.mesh.ids().flat_map(|id| self.mesh.triangle(id));
        corners.flat_map(|corner| corner.coords.data.0[0]).map(|value| value as f32).collect()
    }
}

/// Reads a mesh of an STL, PLY or OBJ file in memory.
///
/// # Errors
/// Fails if it cannot be read, or has no triangles.
pub(crate) fn read(bytes: &[u8], name: &str, unit: &str) -> Result<Mesh, EngineError> {
    match Geometry::from_bytes(bytes, name, unit.parse()?)? {
        Geometry::Mesh(mesh) => Ok(mesh),
        Geometry::Points(_) => Err(EngineError::NoTriangles(name.to_owned())),
    }
}

/// Generates a part: `pocket`, a plate with a rectangular pocket, or `tube`, the thesis's tube.
///
/// # Errors
/// Fails if no generated part has the name.
pub(crate) fn generate(name: &str) -> Result<Mesh, EngineError> {
    match name {
        "pocket" => pocket(),
        "tube" => Ok(scenes::tube()),
        _ => Err(EngineError::UnknownShape(name.to_owned())),
    }
}

/// The edges of the plate and of its pocket along x and y, and the heights of its top, floor and bottom, in mm.
const X: [f64; 4] = [-20.0, -12.0, 8.0, 20.0];
const Y: [f64; 4] = [-15.0, -8.0, 8.0, 15.0];
const TOP: f64 = 0.0;
const FLOOR: f64 = -6.0;
const BOTTOM: f64 = -10.0;

/// Generates a plate of 40 by 30 by 10 mm with a pocket of 20 by 16 by 6 mm; the top is at z = 0.
fn pocket() -> Result<Mesh, EngineError> {
    let mut vertices = Vec::new();
    for z in [TOP, FLOOR, BOTTOM] {
        vertices.extend(Y.iter().flat_map(|y| X.iter().map(move |x| Point3::new(*x, *y, z))));
    }
    let corner = |layer: u32, x: u32, y: u32| 16 * layer + 4 * y + x;
    let cell = |layer: u32, x: u32, y: u32| {
        [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)].map(|(x, y)| corner(layer, x, y))
    };
    let mut quads: Vec<[u32; 4]> = Vec::new();
    for (x, y) in (0..3).flat_map(|y| (0..3).map(move |x| (x, y))) {
        let is_pocket = (x, y) == (1, 1);
        quads.push(cell(if is_pocket { 1 } else { 0 }, x, y));
        let [a, b, c, d] = cell(2, x, y);
        quads.push([d, c, b, a]);
    }
    // A wall from one layer down to another: the material is on the left of its upper edge.
    let mut wall = |from: (u32, u32), to: (u32, u32), lower: u32| {
        let at = |layer, (x, y)| corner(layer, x, y);
        quads.push([at(0, to), at(0, from), at(lower, from), at(lower, to)]);
    };
    for k in 0..3 {
        wall((k, 0), (k + 1, 0), 2);
        wall((3, k), (3, k + 1), 2);
        wall((3 - k, 3), (2 - k, 3), 2);
        wall((0, 3 - k), (0, 2 - k), 2);
    }
    let ring = [(1, 1), (1, 2), (2, 2), (2, 1)];
    for (k, from) in ring.into_iter().enumerate() {
        wall(from, ring[(k + 1) % 4], 1);
    }
    let triangles = quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Ok(Mesh::new(vertices, triangles, Unit::Millimetre)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pocket_is_a_solid_of_its_volume() {
        let mesh = pocket().expect("a mesh");
        let diagnostics = mesh.diagnostics();
        assert!(diagnostics.is_solid(), "{:?}", diagnostics.findings());
        let volume = 40.0 * 30.0 * 10.0 - 20.0 * 16.0 * 6.0;
        assert!((diagnostics.volume - volume).abs() < 1e-9 * volume, "{}", diagnostics.volume);
    }
}
