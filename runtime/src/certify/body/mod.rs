//! What is known of a tool: its profile, or how deep places are and how fast that changes.

mod circles;
mod deepest;
mod enclosed;
pub(crate) mod feature;
pub(crate) mod field;
pub(crate) mod interior;
mod offset;
pub(crate) mod owners;
pub(crate) mod section;

use crate::certify::body::feature::Place;
use crate::certify::body::field::{Field, Scratch};
use crate::certify::body::owners::Owners;
use crate::certify::body::section::{Depth, Section};
use crate::certify::space::Point;

/// A tool, as its depth is known.
pub(crate) enum Body<'a> {
    /// Depth is the distance from its profile.
    Profile(Section),
    /// Depth is what its file says.
    Field(Field<'a>),
}

impl Body<'_> {
    /// How fast depth changes at most.
    pub(crate) fn steep(&self) -> f64 {
        match self {
            Body::Profile(_) => 1.0,
            Body::Field(field) => field.steep,
        }
    }

    /// The surface that a feature is of.
    pub(crate) fn surface(&self, feature: usize) -> usize {
        match self {
            Body::Profile(section) => section.features[feature].surface,
            Body::Field(field) => field.card().regions[feature].surface,
        }
    }

    /// How deep owners are at a place, or less than 0.
    pub(crate) fn depth(
        &self,
        scratch: &mut Scratch,
        owners: &Owners,
        point: Point,
    ) -> Option<Depth> {
        match self {
            Body::Profile(section) => section.depth_at(owners, place(point)),
            Body::Field(field) => Some(field.depth_of(scratch, owners, point)),
        }
    }

    /// How near owners are to a place outside, as depth: no more than 0. Of a tool by its field what is inside is
    /// others'.
    pub(crate) fn distance(&self, scratch: &mut Scratch, owners: &Owners, point: Point) -> Depth {
        match self {
            Body::Profile(section) => section.distance(owners, place(point)),
            Body::Field(field) => {
                let depth = field.depth(scratch, point);
                let value = if depth.value < 0.0 { depth.value } else { f64::NEG_INFINITY };
                Depth { value, ..depth }
            }
        }
    }

    /// Whether no place of a rectangle of the half plane, no farther than `goes` from a place, is inside,
    /// deeper than `limit` and owned; or, if the limit is below 0, nearer to the owners than that.
    pub(crate) fn clears(
        &self,
        scratch: &mut Scratch,
        owners: &Owners,
        (point, rectangle): (Point, &[Place; 4]),
        (goes, limit): (f64, f64),
    ) -> bool {
        let steep = self.steep();
        let depth = match self {
            Body::Profile(section) if limit < 0.0 => {
                return section.distance(owners, place(point)).value + goes < limit;
            }
            Body::Profile(section) => section.signed(place(point)),
            Body::Field(field) => field.depth(scratch, point).value,
        };
        if depth + goes < 0.0 || depth + steep * goes <= limit {
            return true;
        }
        match self {
            Body::Profile(section) => {
                section.far_from(owners, rectangle, (place(point), depth, goes))
            }
            Body::Field(field) => field.passes(scratch, owners, point, (goes, limit)),
        }
    }
}

fn place([x, y, z]: Point) -> Place {
    [(x * x + y * y).sqrt(), z]
}
