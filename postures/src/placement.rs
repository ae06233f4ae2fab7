//! Placement of a tool at a point of a part: the position of its tip, and the niceness of the contact.

use super::contact::ContactSites;
use nalgebra::{Point3, Vector3};
use touchoff::tool::{Evaluations, Outputs, PointBatch};
use touchoff::{Level, Tool, Unit};

/// A point of contact on the part's surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfacePoint {
    pub(super) point: Point3<f64>,
    /// Outward normal.
    pub(super) normal: Vector3<f64>,
}

/// A posture in which a tool touches a surface point, regardless of other interference.
#[derive(Clone, Copy, Debug)]
pub(super) struct CandidatePosture {
    /// Index of the axis in the list that was given.
    pub(super) direction: usize,
    pub(super) tip: Point3<f64>,
    /// Least niceness of the touching surfaces; NaN where the tool gives none.
    pub(super) niceness: f64,
}

/// Computes the postures in which a tool touches a surface point.
pub(super) struct ToolPlacement<'a> {
    tool: &'a dyn Tool,
    /// Factor from the tool's unit of length to the part's.
    length: f64,
    sites: ContactSites,
    points: PointBatch,
    evaluations: Evaluations,
}

impl<'a> ToolPlacement<'a> {
    /// Creates the placement of a tool at a part in the given unit of length.
    pub(super) fn new(tool: &'a dyn Tool, unit: Unit) -> ToolPlacement<'a> {
        let length = tool.info().unit.factor_to(unit);
        ToolPlacement {
            tool,
            length,
            sites: ContactSites::new(tool.info(), length),
            points: PointBatch::default(),
            evaluations: Evaluations::default(),
        }
    }

    /// Returns the largest distance between the tip and a point of contact, in the part's unit.
    pub(super) fn reach(&self) -> f64 {
        self.sites.reach()
    }

    /// Replaces `postures` by those in which the tool touches a surface point, axis by axis. Several of one
    /// axis are in descending order of niceness.
    pub(super) fn list(
        &mut self,
        target: SurfacePoint,
        axes: impl IntoIterator<Item = Vector3<f64>>,
        postures: &mut Vec<CandidatePosture>,
    ) {
        self.points.clear();
        postures.clear();
        for (direction, axis) in axes.into_iter().enumerate() {
            for contact in self.sites.contacts(target.point, target.normal, axis) {
                for [d, z] in contact.within {
                    self.points.push([d / self.length, 0.0, z / self.length]);
                }
                postures.push(CandidatePosture { direction, tip: contact.tip, niceness: f64::NAN });
            }
        }
        let outputs = Outputs { niceness: true, ..Outputs::INSIDE };
        self.tool.evaluate(Level::new(), outputs, &self.points, self.length, &mut self.evaluations);
        for index in self.evaluations.inside_indices() {
            let niceness = &mut postures[index / 2].niceness;
            *niceness = niceness.min(self.evaluations.niceness[index]);
        }
        postures
            .sort_by(|a, b| a.direction.cmp(&b.direction).then(b.niceness.total_cmp(&a.niceness)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    touchoff::tool! {
        tool Flat "two surfaces that meet in a sharp corner" {
            units mm;
            profile {
                start (0, 0);
                line to (6, 0) as face cutting;
                line to (6, 20) as flute cutting;
                line to (6, 60), (0, 60) as shank;
            }
            niceness flute: 1;
            niceness face: 0.25 + z;
        }
    }

    #[test]
    fn a_corner_is_as_nice_as_the_less_nice_of_what_meets_there() {
        let mut placement = ToolPlacement::new(&Flat, Unit::Metre);
        let target = SurfacePoint { point: Point3::new(0.1, 0.0, 0.2), normal: Vector3::z() };
        let axes = (1..90).map(|degrees| {
            let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
            Vector3::new(sine, 0.0, cosine)
        });
        let mut postures = Vec::new();
        placement.list(target, axes, &mut postures);
        assert_eq!(postures.len(), 89);
        for posture in &postures {
            assert!((posture.niceness - 0.25).abs() < 1e-6, "{posture:?}");
        }
    }
}
