//! The surface of what is left, as a mesh.

use super::{Stock, StockError};
use nalgebra::Point3;
use std::collections::HashMap;
use touchoff::mesh::Mesh;

impl Stock {
    /// Returns the surface of the cells that are left: a closed, consistently oriented mesh with two
    /// triangles per face between a cell that is left and one that is not. [`Mesh::write_stl`] writes it.
    /// Four faces share an edge along which alone cells touch.
    ///
    /// **Deviation.** Let M be the material as the points know it: what was inside at the beginning, less
    /// what was removed (see the [module's page](crate::stock)). A face lies halfway between a node inside M
    /// and a neighbour outside, and M's surface crosses the line between them. The crossing is within half a
    /// spacing of the face's middle, the face's corners are within √½ of a spacing of it, at right angles.
    /// Every point of the mesh is thus within √3/2 of a spacing of M's surface. A point of M that is farther
    /// than that from M's surface is in a cell that is left, since the nearest node is in M as well; likewise
    /// for points outside. Pieces and gaps that hold no larger ball may be missing.
    /// [`Stock::missed_ball_radius`] returns this distance.
    ///
    /// # Errors
    /// [`StockError::NothingLeft`] if nothing is left, and [`StockError::Mesh`] if coordinates are too large.
    pub fn remaining_mesh(&self) -> Result<Mesh, StockError> {
        if self.is_empty() {
            return Err(StockError::NothingLeft);
        }
        let remaining = self.remaining();
        let mut corners = Corners { stock: self, ids: HashMap::new(), vertices: Vec::new() };
        let mut triangles = Vec::new();
        for index in remaining.iter() {
            let node = self.lattice.node(index);
            for axis in 0..3 {
                for up in [false, true] {
                    let neighbour = self.lattice.neighbour(node, axis, up);
                    if neighbour.is_none_or(|neighbour| !remaining.contains(neighbour)) {
                        let [a, b, c, d] = corners.of_face(node, axis, up);
                        triangles.extend([[a, b, c], [a, c, d]]);
                    }
                }
            }
        }
        Ok(Mesh::new(corners.vertices, triangles, self.unit)?)
    }
}

/// The corners of cells that are in use.
struct Corners<'a> {
    stock: &'a Stock,
    /// The vertex of each corner, which is given by its numbers along the axes: those of the cell above it.
    ids: HashMap<[usize; 3], u32>,
    vertices: Vec<Point3<f64>>,
}

impl Corners<'_> {
    /// Returns the vertices of a cell's face, counter-clockwise seen from outside.
    fn of_face(&mut self, node: [usize; 3], axis: usize, up: bool) -> [u32; 4] {
        let (second, third) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut face = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[along_second, along_third]| {
            let mut corner = node;
            corner[axis] += usize::from(up);
            corner[second] += along_second;
            corner[third] += along_third;
            self.vertex(corner)
        });
        if !up {
            face.reverse();
        }
        face
    }

    fn vertex(&mut self, corner: [usize; 3]) -> u32 {
        let Corners { stock, ids, vertices } = self;
        // There are at most eight corners per point, so their number fits 32 bits.
        *ids.entry(corner).or_insert_with(|| {
            let coordinate =
                |axis: usize| stock.lattice.coordinate(axis, corner[axis] as f64 - 0.5);
            vertices.push([0, 1, 2].map(coordinate).into());
            vertices.len() as u32 - 1
        })
    }
}
