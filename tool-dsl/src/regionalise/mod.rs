//! The nearest-feature partition of a profile, from which the regions of a tool follow.
//!
//! Features are the segments of the profile and its reflex corners. The axis is a mirror and not a feature, and a
//! tangent joint has no cell of its own. `section` has the features, and the nearest one to a point, `cover` convex
//! polygons that provably cover their cells, `curve` the expressions of distances, `nearer` those of borders between two
//! features. `pieces` and `outside` are what a plan separates. `overlay` and `rounded` divide the cells further, by
//! written regions and by the outline with rounded corners, which `smooth` makes. `owners` is the rule of the text for
//! the owner of a point. `normals` are for drawings.

pub(crate) mod check;
mod cover;
mod curve;
mod nearer;
pub(crate) mod normals;
mod outside;
pub(crate) mod overlay;
pub(crate) mod owners;
pub(crate) mod pieces;
pub(crate) mod rounded;
mod section;
pub(crate) mod smooth;

use crate::geometry::outline::{Segment, bounding_box};
use crate::geometry::polygon::Polygon;
pub(crate) use curve::{Test, direction_to_surface};
pub(crate) use section::{Feature, Section};

/// The partition of the inside of an outline.
#[derive(Clone, Debug)]
pub(crate) struct Partition {
    outline: Vec<Segment>,
    /// For each feature, polygons that cover its cell.
    covers: Vec<Vec<Polygon>>,
}

impl Partition {
    /// Divides the inside of an outline.
    pub(crate) fn new(outline: Vec<Segment>) -> Partition {
        let section = Section::new(&outline);
        let [low, high] = bounding_box(&outline);
        let bounds = vec![[0.0, low[1]], [high[0], low[1]], high, [0.0, high[1]]];
        let features = 0..section.features.len();
        let covers = features.map(|feature| section.cover(feature, &bounds)).collect();
        Partition { outline, covers }
    }

    /// Returns the polygons that cover the cell of a feature.
    #[cfg(test)]
    fn cover_of(&self, feature: usize) -> &[Polygon] {
        &self.covers[feature]
    }

    /// Returns the features and their geometry.
    pub(crate) fn section(&self) -> Section<'_> {
        Section::new(&self.outline)
    }
}
