//! What is known of a tool: its profile, or how deep places are and how fast that changes.

use super::course::{self, Course, Search};
use super::facet::Facet;
use super::feature::Place;
use super::field::{Field, Scratch};
use super::owners::Owners;
use super::section::{Depth, Section};

type Point = [f64; 3];

/// A tool, as its depth is known.
pub(super) enum Body<'a> {
    /// Depth is the distance from its profile.
    Profile(Section),
    /// Depth is what its file says.
    Field(Field<'a>),
}

/// Where a triangle is deepest, or nearest.
#[derive(Clone, Copy)]
pub(super) struct Found {
    pub(super) point: Point,
    pub(super) feature: usize,
}

impl Body<'_> {
    /// How fast depth changes at most.
    pub(super) fn steep(&self) -> f64 {
        match self {
            Body::Profile(_) => 1.0,
            Body::Field(field) => field.steep,
        }
    }

    /// The surface that a feature is of.
    pub(super) fn surface(&self, feature: usize) -> usize {
        match self {
            Body::Profile(section) => section.features[feature].surface,
            Body::Field(_) => feature,
        }
    }

    /// How deep owners are at a place, or less than 0.
    pub(super) fn depth(
        &self,
        scratch: &mut Scratch,
        owners: &Owners,
        point: Point,
    ) -> Option<Depth> {
        match self {
            Body::Profile(section) => section.depth_at(owners, place(point)),
            Body::Field(field) => Some(field.depth(scratch, point)),
        }
    }

    /// How near owners are to a place outside, as depth: no more than 0.
    pub(super) fn distance(&self, scratch: &mut Scratch, owners: &Owners, point: Point) -> Depth {
        match self {
            Body::Profile(section) => section.distance(owners, place(point)),
            Body::Field(field) => {
                let depth = field.depth(scratch, point);
                Depth { value: depth.value.min(0.0), ..depth }
            }
        }
    }

    /// The place of a triangle where owners are deepest, if deeper than the best, where that is at least 0.
    pub(super) fn inside(
        &self,
        (search, scratch): (&mut Search, &mut Scratch),
        owners: &Owners,
        facet: &Facet,
    ) -> Option<Found> {
        match self {
            Body::Profile(section) => {
                along(facet, |course| search.inside((section, owners), course))
            }
            Body::Field(field) => alone(field, (search, scratch), facet, false),
        }
    }

    /// The place of a triangle that is nearest to the owners, where the best is below 0. If all are, what
    /// is inside is at 0.
    pub(super) fn outside(
        &self,
        (search, scratch): (&mut Search, &mut Scratch),
        owners: &Owners,
        facet: &Facet,
    ) -> Option<Found> {
        match self {
            Body::Profile(section) => {
                along(facet, |course| search.outside((section, owners), course))
            }
            Body::Field(field) => alone(field, (search, scratch), facet, true),
        }
    }
}

fn alone(
    field: &Field<'_>,
    (search, scratch): (&mut Search, &mut Scratch),
    facet: &Facet,
    outside: bool,
) -> Option<Found> {
    scratch.clear();
    scratch.hold(facet.corners, 0, f64::INFINITY);
    field.look(search, scratch, outside).map(|(found, _)| found)
}

fn place([x, y, z]: Point) -> Place {
    [(x * x + y * y).sqrt(), z]
}

/// The last place that is found along the courses of a triangle.
fn along(facet: &Facet, mut found: impl FnMut(&Course) -> Option<course::Found>) -> Option<Found> {
    let mut best = None;
    for course in facet.courses() {
        if let Some(course::Found { t, feature }) = found(&course) {
            best = Some(Found { point: course.point(t), feature });
        }
    }
    best
}
