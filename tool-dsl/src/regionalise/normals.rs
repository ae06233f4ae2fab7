//! The normals of a profile's features, which drawings follow to the borders of the cells.

use super::section::{Obstacle, Section};
use crate::geometry::outline::Point;
use crate::model::Model;

/// What ends a normal in the section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalEnd {
    /// The cell of another feature.
    Feature(usize),
    /// The axis.
    Axis,
    /// The centre of the feature's own arc.
    Centre,
}

/// The normal at a point of a feature, up to the end of its cell.
#[derive(Clone, Copy, Debug)]
pub struct Normal {
    /// The point of the feature.
    pub foot: Point,
    /// The last point of the cell.
    pub end: Point,
    /// What is there.
    pub at_end: NormalEnd,
}

/// The features of a profile, in the order of the tool's regions.
#[allow(missing_debug_implementations)]
pub struct Features<'m>(Section<'m>);

impl<'m> Features<'m> {
    /// Returns the features of a tool whose regions are their cells; `None` if regions are written by hand or smoothed.
    pub fn of(model: &'m Model) -> Option<Features<'m>> {
        let section = model.section.as_ref().filter(|section| section.over.is_none())?;
        Some(Features(section.inner.section()))
    }

    /// Returns the index of each feature's segment; `None` for a reflex corner.
    pub fn segments(&self) -> impl Iterator<Item = Option<usize>> {
        self.0.features.iter().map(|feature| feature.piece())
    }

    /// Returns the parameter of a feature's normal through a point; outside [0, 1] if there is none.
    pub fn parameter(&self, feature: usize, p: Point) -> f64 {
        self.0.parameter(feature, p)
    }

    /// Returns the normal at a parameter from 0 to 1, exclusively.
    pub fn normal(&self, feature: usize, parameter: f64) -> Normal {
        let foot_point = self.0.foot_point(feature, parameter);
        let stop = self.0.grow_ball(feature, &foot_point);
        let at_end = match stop.obstacle {
            Obstacle::Feature(other) => NormalEnd::Feature(other),
            Obstacle::Axis => NormalEnd::Axis,
            Obstacle::Centre | Obstacle::Far => NormalEnd::Centre,
        };
        // Nothing in the section is farther away than its size.
        let [d, z] = foot_point.at(stop.radius.min(self.0.size));
        Normal { foot: foot_point.foot, end: [d.max(0.0), z], at_end }
    }
}
