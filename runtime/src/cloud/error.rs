//! Errors of building point clouds.

use super::{MAX_BLUE_NOISE_POINTS, NORMAL_TOLERANCE};
use crate::mesh::LARGEST_COORDINATE;

/// Reasons why lists do not form a cloud, or why a requested cloud cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CloudError {
    /// The cloud would have no points.
    #[error("the cloud has no point: ask for one at least")]
    Empty,
    /// There are more points than 32-bit indices can number.
    #[error("{count} points are more than 32-bit indices can tell apart: ask for fewer")]
    TooMany {
        /// The requested number of points.
        count: usize,
    },
    /// There are more points than [`MAX_BLUE_NOISE_POINTS`].
    #[error(
        "{count} points are more than {MAX_BLUE_NOISE_POINTS}, the most that are spread evenly: take random ones"
    )]
    TooManyBlueNoise {
        /// The requested number of points.
        count: usize,
    },
    /// The covering radius is not a positive finite length.
    #[error("{radius} is no covering radius: give a finite length above 0")]
    Radius {
        /// The requested covering radius.
        radius: f64,
    },
    /// The covering radius needs too many points.
    #[error(
        "a covering radius of {radius} needs about {needed:.1e} points, more than {limit}, \
         which give one of about {attainable:.2e}: ask for that, or query the triangles \
         (`certify`), between which nothing lies"
    )]
    TooFine {
        /// The requested covering radius.
        radius: f64,
        /// The approximate number of points it needs.
        needed: f64,
        /// The maximum number of points.
        limit: usize,
        /// The approximate covering radius of that maximum number of points.
        attainable: f64,
    },
    /// The lists have different lengths.
    #[error(
        "{points} points, {normals} normals, {triangles} triangle ids and {weights} weights: give \
         one of each for every point"
    )]
    Lengths {
        /// The number of points.
        points: usize,
        /// The number of normals.
        normals: usize,
        /// The number of triangle ids.
        triangles: usize,
        /// The number of weights.
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
    /// A normal is not a unit vector.
    #[error(
        "the normal of point {point} has norm {norm}: give a unit vector (within \
         {NORMAL_TOLERANCE} of 1)"
    )]
    Normal {
        /// The point's index.
        point: usize,
        /// The normal's norm; NaN if a component is NaN.
        norm: f64,
    },
    /// A weight is not a valid area.
    #[error("the weight of point {point} is {weight}: give a finite area, 0 or more")]
    Weight {
        /// The point's index.
        point: usize,
        /// The weight.
        weight: f64,
    },
}
