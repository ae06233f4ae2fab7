//! Why there is no such cloud.

use super::{MOST_BLUE, NORMAL_TOLERANCE};
use crate::mesh::LARGEST_COORDINATE;

/// Lists that make no cloud, or a wish for one that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CloudError {
    /// There is nothing to touch.
    #[error("the cloud has no point: ask for one at least")]
    Empty,
    /// More points than 32-bit indices can tell apart.
    #[error("{count} points are more than 32-bit indices can tell apart: ask for fewer")]
    TooMany {
        /// How many were asked for.
        count: usize,
    },
    /// More points than can be spread evenly.
    #[error(
        "{count} points are more than {MOST_BLUE}, the most that are spread evenly: take random ones"
    )]
    TooManyBlue {
        /// How many were asked for.
        count: usize,
    },
    /// A covering radius that is no length.
    #[error("{radius} is no covering radius: give a finite length above 0")]
    Radius {
        /// What was asked for.
        radius: f64,
    },
    /// A covering radius that wants too many points.
    #[error(
        "a covering radius of {radius} wants about {needed:.1e} points, more than {most}, \
         which would have one of about {instead:.2e}: ask for that, or ask the triangles \
         (`certify`), between which nothing lies"
    )]
    TooFine {
        /// What was asked for.
        radius: f64,
        /// About how many points it wants.
        needed: f64,
        /// The most that there can be.
        most: usize,
        /// About what so many points as there can be have.
        instead: f64,
    },
    /// The lists do not belong together.
    #[error(
        "{points} points, {normals} normals, {triangles} triangle ids and {weights} weights: give \
         one of each for every point"
    )]
    Lengths {
        /// How many points there are.
        points: usize,
        /// How many normals there are.
        normals: usize,
        /// How many triangle ids there are.
        triangles: usize,
        /// How many weights there are.
        weights: usize,
    },
    /// A coordinate is NaN, infinite or too large.
    #[error(
        "point {point} has the coordinate {coordinate}: coordinates must be finite and within \
         {LARGEST_COORDINATE:e}"
    )]
    Coordinate {
        /// The point's index.
        point: usize,
        /// The coordinate.
        coordinate: f64,
    },
    /// A normal is not a direction.
    #[error(
        "the normal of point {point} has norm {norm}: give a unit vector (within \
         {NORMAL_TOLERANCE} of 1)"
    )]
    Normal {
        /// The point's index.
        point: usize,
        /// The normal's norm; NaN when a component is.
        norm: f64,
    },
    /// A weight is not an area.
    #[error("the weight of point {point} is {weight}: give a finite area, 0 or more")]
    Weight {
        /// The point's index.
        point: usize,
        /// The weight.
        weight: f64,
    },
}
