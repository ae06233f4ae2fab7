//! A tool as it stands at a place of a part: where its tip is, and how nice that is.

use super::contact::Sites;
use crate::tool::Tool;
use crate::tool::{Ask, Felt, Points};
use crate::unit::Unit;
use fearless_simd::Level;
use nalgebra::{Point3, Vector3};

/// Where a part is touched.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    pub(super) point: Point3<f64>,
    /// Outward.
    pub(super) normal: Vector3<f64>,
}

/// A tool that touches a spot, whatever else is in its way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Posture {
    /// Its axis, by its place among those that were asked about.
    pub(super) direction: usize,
    pub(super) tip: Point3<f64>,
    /// The least of what touches; not a number where none is said.
    pub(super) niceness: f64,
}

/// A tool that can be asked how it touches.
pub(super) struct Touching<'a> {
    tool: &'a dyn Tool,
    /// Its unit of length in the part's.
    length: f64,
    sites: Sites,
    points: Points,
    felt: Felt,
}

impl<'a> Touching<'a> {
    /// A tool at a part in a unit of length.
    pub(super) fn new(tool: &'a dyn Tool, unit: Unit) -> Touching<'a> {
        let length = tool.card().unit.to(unit);
        Touching {
            tool,
            length,
            sites: Sites::new(tool.card(), length),
            points: Points::default(),
            felt: Felt::default(),
        }
    }

    /// How far from its tip any place is that it touches with.
    pub(super) fn reach(&self) -> f64 {
        self.sites.reach()
    }

    /// Lists the postures in which it touches a spot, axis by axis, the nicest first where one has several.
    pub(super) fn list(
        &mut self,
        spot: Spot,
        axes: impl IntoIterator<Item = Vector3<f64>>,
        postures: &mut Vec<Posture>,
    ) {
        self.points.clear();
        postures.clear();
        for (direction, axis) in axes.into_iter().enumerate() {
            for contact in self.sites.contacts(spot.point, spot.normal, axis) {
                for [d, z] in contact.within {
                    self.points.push([d / self.length, 0.0, z / self.length]);
                }
                postures.push(Posture { direction, tip: contact.tip, niceness: f64::NAN });
            }
        }
        let ask = Ask { niceness: true, ..Ask::INSIDE };
        self.tool.evaluate(Level::new(), ask, &self.points, self.length, &mut self.felt);
        for place in self.felt.places() {
            let niceness = &mut postures[place / 2].niceness;
            *niceness = niceness.min(self.felt.niceness[place]);
        }
        postures
            .sort_by(|a, b| a.direction.cmp(&b.direction).then(b.niceness.total_cmp(&a.niceness)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    crate::tool! {
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
        let mut touching = Touching::new(&Flat, Unit::Metre);
        let spot = Spot { point: Point3::new(0.1, 0.0, 0.2), normal: Vector3::z() };
        let axes = (1..90).map(|degrees| {
            let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
            Vector3::new(sine, 0.0, cosine)
        });
        let mut postures = Vec::new();
        touching.list(spot, axes, &mut postures);
        assert_eq!(postures.len(), 89);
        for posture in &postures {
            assert!((posture.niceness - 0.25).abs() < 1e-6, "{posture:?}");
        }
    }
}
