//! The distance from a point outside a tool to the tool.

use super::{EnvelopeSlab, Symmetry, ToolInfo};
use crate::interval::Interval;
use touchoff_plane::Point;

impl ToolInfo {
    /// Returns the distance from a point outside the tool to the tool, in the tool's frame and the file's unit.
    ///
    /// With a profile it is the least distance of the profile's segments in the half plane through the point. Without one it is
    /// a lower bound: the distance from the envelope or, for a solid without an axis, from its box. Both are rounded outward,
    /// to 1e-4 mm for a tool of some centimetres. Rounding is a few units in the last place of the largest coordinate. At a
    /// point inside the result is a distance from the surface, or 0, and says nothing.
    pub fn distance_from_outside(&self, [x, y, z]: [f64; 3]) -> f64 {
        let p = [x.hypot(y), z];
        if !self.outline.is_empty() {
            let halves = self.outline.iter().flat_map(|segment| segment.geometry().halves());
            let distances = halves.map(|half| half.distance(p));
            return distances.fold(f64::INFINITY, f64::min);
        }
        match &self.symmetry {
            Symmetry::Revolved => {
                let distances = self.envelope.iter().map(|slab| slab.distance(p));
                distances.fold(f64::INFINITY, f64::min)
            }
            Symmetry::Solid { extent: [along_x, along_y] } => {
                let across = along_x.distance(x).hypot(along_y.distance(y));
                across.hypot(self.reach().distance(z))
            }
        }
    }
}

impl Interval {
    /// Returns the distance of a number from the interval.
    fn distance(self, at: f64) -> f64 {
        (self.low - at).max(at - self.high).max(0.0)
    }
}

impl EnvelopeSlab {
    /// Returns the distance of a point of the half plane from the slab.
    fn distance(&self, [d, z]: Point) -> f64 {
        (d - self.radius).max(0.0).hypot(Interval::new(self.low, self.high).distance(z))
    }
}
