//! Comparison of what is left with the finished part: material over it, and points of it that were removed.

use super::{Stock, StockError, columns, is_at_boundary};
use nalgebra::Point3;
use std::io::{self, Write};
use touchoff::Unit;
use touchoff::certify::{NearestTriangle, TriangleBvh};

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
        let inside = columns::nodes_inside(
            part.corners().map(|corners| corners.map(Into::into)),
            &self.lattice,
        )?;
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
