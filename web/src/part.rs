//! Parts: a file's, or generated ones.

use crate::error::EngineError;
use nalgebra::Point3;
use serde::Serialize;
use std::collections::HashMap;
use touchoff::mesh::Geometry;
use touchoff::{Mesh, Unit, scenes};

/// The facts about a part that the page shows.
#[derive(Debug, Serialize)]
pub(crate) struct PartFacts {
    unit: &'static str,
    /// The length of the unit in mm.
    millimetres: f64,
    lowest: [f64; 3],
    highest: [f64; 3],
    /// The findings about the mesh, as sentences.
    findings: Vec<String>,
}

/// Returns the facts about a part's mesh.
pub(crate) fn facts(mesh: &Mesh) -> PartFacts {
    let [lowest, highest] = mesh.bounds();
    PartFacts {
        unit: mesh.unit().symbol(),
        millimetres: mesh.unit().millimetres(),
        lowest: lowest.coords.into(),
        highest: highest.coords.into(),
        findings: mesh.diagnostics().findings(),
    }
}

/// Returns the corners of all triangles, 9 values per triangle.
pub(crate) fn positions(mesh: &Mesh) -> Vec<f32> {
    let corners = mesh.ids().flat_map(|id| mesh.triangle(id));
    corners.flat_map(|corner| corner.coords.data.0[0]).map(|value| value as f32).collect()
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

/// The plate's size and the pocket, whose floor is at `z = FLOOR`, in cells of 1 mm.
const PLATE: [i32; 3] = [40, 30, 10];
const POCKET: [std::ops::Range<i32>; 2] = [8..28, 7..23];
const FLOOR: i32 = 4;

/// Generates a plate of 40 by 30 by 10 mm with a pocket of 20 by 16 by 6 mm, in squares of 1 mm. The top is at z = 0 and
/// the centre at x = y = 0.
fn pocket() -> Result<Mesh, EngineError> {
    let mut vertices = Vec::new();
    let mut known = HashMap::new();
    let mut vertex = |corner: [i32; 3]| {
        *known.entry(corner).or_insert_with(|| {
            let [x, y, z] = [0, 1, 2].map(|axis| f64::from(corner[axis]));
            let [width, depth, height] = PLATE.map(f64::from);
            vertices.push(Point3::new(x - width / 2.0, y - depth / 2.0, z - height));
            vertices.len() as u32 - 1
        })
    };
    let mut triangles = Vec::new();
    let [columns, rows, layers] = PLATE;
    for index in 0..columns * rows * layers {
        let cell = [index % columns, index / columns % rows, index / (columns * rows)];
        for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
            let mut neighbour = cell;
            neighbour[axis] += 2 * side - 1;
            // Only a face between material and air is part of the surface.
            if !is_material(cell) || is_material(neighbour) {
                continue;
            }
            let (second, third) = ((axis + 1) % 3, (axis + 2) % 3);
            // Counter-clockwise seen from outside.
            let around = if side == 1 {
                [(0, 0), (1, 0), (1, 1), (0, 1)]
            } else {
                [(0, 0), (0, 1), (1, 1), (1, 0)]
            };
            let [a, b, c, d] = around.map(|steps| {
                let mut corner = cell;
                corner[axis] += side;
                corner[second] += steps.0;
                corner[third] += steps.1;
                vertex(corner)
            });
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Ok(Mesh::new(vertices, triangles, Unit::Millimetre)?)
}

fn is_material(cell: [i32; 3]) -> bool {
    let in_plate = (0..3).all(|axis| (0..PLATE[axis]).contains(&cell[axis]));
    let in_pocket = (0..2).all(|axis| POCKET[axis].contains(&cell[axis])) && cell[2] >= FLOOR;
    in_plate && !in_pocket
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
