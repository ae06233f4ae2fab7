//! What is left of a stock: its surface as a mesh, and its comparison with the finished part, which finds material over it and
//! points of it that were removed.

use super::lattice::{BitSet, Lattice, nodes_inside};
use super::{Stock, StockError};
use nalgebra::Point3;
use std::collections::HashMap;
use std::io::{self, Write};
use touchoff::Unit;
use touchoff::certify::{NearestTriangle, TriangleBvh};
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
        // Seen from outside, the lower face turns the other way round.
        if !up {
            face.reverse();
        }
        face
    }

    fn vertex(&mut self, corner: [usize; 3]) -> u32 {
        let Corners { stock, ids, vertices } = self;
        // There are at most eight corners per point, so their number fits 32 bits.
        *ids.entry(corner).or_insert_with(|| {
            vertices.push(
                [0, 1, 2]
                    .map(|axis| stock.lattice.coordinate(axis, corner[axis] as f64 - 0.5))
                    .into(),
            );
            vertices.len() as u32 - 1
        })
    }
}

/// The deviations of what is left of a stock from the finished part.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PartComparison {
    /// Material over the part: the points that are left outside the part and have a neighbour that is not,
    /// with their distances from the part's surface, 0 or more. Material extends beyond a point by at most
    /// [`Stock::missed_ball_radius`].
    pub excess: Vec<DeviationPoint>,
    /// Gouges: the points of the stock inside the part that were removed, with their distances from the
    /// part's surface as negative numbers, 0 or less.
    pub gouges: Vec<DeviationPoint>,
    /// The unit of length.
    pub unit: Unit,
}

/// A point with its distance from the surface of the finished part.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct DeviationPoint {
    /// The point, in the part's frame and unit.
    pub point: Point3<f64>,
    /// The distance: positive outside the part, negative inside.
    pub distance: f64,
}

/// The columns of the CSV format.
const COLUMNS: &str = "x,y,z,distance";

impl Stock {
    /// Compares what is left with the finished part, in the same frame. A point on the part's surface counts
    /// as the point just above it, as in [`Stock::from_mesh`].
    ///
    /// # Errors
    /// If the part has another unit, has no inside, or is inside out somewhere.
    pub fn compare(&self, part: &TriangleBvh) -> Result<PartComparison, StockError> {
        if part.unit() != self.unit {
            return Err(StockError::Unit { part: part.unit(), stock: self.unit });
        }
        if !part.has_inside() {
            return Err(StockError::NoInside { what: "part" });
        }
        let inside =
            nodes_inside(part.corners().map(|corners| corners.map(Into::into)), &self.lattice)?;
        let remaining = self.remaining();
        let mut comparison =
            PartComparison { excess: Vec::new(), gouges: Vec::new(), unit: self.unit };
        let mut nearest = NearestTriangle::new(part);
        for index in self.initial.iter() {
            let is_gouge = inside.contains(index) && !remaining.contains(index);
            let is_excess = !inside.contains(index)
                && remaining.contains(index)
                && is_at_boundary(&self.lattice, &remaining, self.lattice.node(index));
            if !is_gouge && !is_excess {
                continue;
            }
            let point = Point3::from(self.lattice.position(index));
            let distance = nearest.distance(point);
            let (list, distance) = if is_gouge {
                (&mut comparison.gouges, -distance)
            } else {
                (&mut comparison.excess, distance)
            };
            list.push(DeviationPoint { point, distance });
        }
        Ok(comparison)
    }
}

impl PartComparison {
    /// Returns the point of material that is farthest outside the part, the first of several; `None` if there
    /// is none.
    pub fn greatest_excess(&self) -> Option<DeviationPoint> {
        farthest(&self.excess)
    }

    /// Returns the removed point that is deepest inside the part, the first of several; `None` if there is
    /// none.
    pub fn deepest_gouge(&self) -> Option<DeviationPoint> {
        farthest(&self.gouges)
    }

    /// Writes all points as CSV, with a header: first those over the part, then gouges. Every number reads
    /// back as the same double.
    ///
    /// # Errors
    /// If the output cannot be written.
    pub fn write_csv(&self, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "{COLUMNS}")?;
        for DeviationPoint { point, distance } in self.points() {
            writeln!(out, "{:?},{:?},{:?},{distance:?}", point.x, point.y, point.z)?;
        }
        out.flush()
    }

    /// Writes all points as binary PLY, in the order of [`PartComparison::write_csv`]: vertices with the
    /// property `distance`.
    ///
    /// # Errors
    /// If the output cannot be written.
    pub fn write_ply(&self, out: &mut impl Write) -> io::Result<()> {
        write!(
            out,
            "ply\nformat binary_little_endian 1.0\ncomment unit {}\nelement vertex {}\n\
             property double x\nproperty double y\nproperty double z\nproperty double distance\nend_header\n",
            self.unit,
            self.excess.len() + self.gouges.len(),
        )?;
        for DeviationPoint { point, distance } in self.points() {
            for number in [point.x, point.y, point.z, *distance] {
                out.write_all(&number.to_le_bytes())?;
            }
        }
        out.flush()
    }

    fn points(&self) -> impl Iterator<Item = &DeviationPoint> {
        self.excess.iter().chain(&self.gouges)
    }
}

/// Returns the first point with the largest distance, of either sign.
fn farthest(points: &[DeviationPoint]) -> Option<DeviationPoint> {
    points.iter().copied().reduce(|farthest, point| {
        if point.distance.abs() > farthest.distance.abs() { point } else { farthest }
    })
}

/// Returns whether a node has a neighbour that is not in a set.
fn is_at_boundary(lattice: &Lattice, nodes: &BitSet, node: [usize; 3]) -> bool {
    (0..3).any(|axis| {
        [false, true].into_iter().any(|up| {
            lattice.neighbour(node, axis, up).is_none_or(|neighbour| !nodes.contains(neighbour))
        })
    })
}
