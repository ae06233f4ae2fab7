//! Errors of stocks.

use super::MAX_POINTS;
use crate::codes::faults;
use touchoff::mesh::{LARGEST_COORDINATE, MeshError};
use touchoff::{CloudError, Unit};

faults! {
    #[family("J04", "Stocks")]
    /// A reason for which a stock cannot be built, advanced or compared.
    #[derive(Clone, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum StockError {
        /// The spacing is not a finite length above 0.
        #[code = J0401]
        #[error("{spacing} is no spacing: give a finite length above 0")]
        Spacing {
            /// The given spacing.
            spacing: f64,
        },
        /// The spacing is too small for coordinates in double precision.
        #[code = J0402]
        #[error(
            "a spacing of {spacing} is too small for coordinates of {coordinate:.1e}, which are rounded to {:.1e}: move the \
             stock nearer to the origin, or give a spacing of {limit:.1e} or more",
            f64::EPSILON * .coordinate
        )]
        Resolution {
            /// The given spacing.
            spacing: f64,
            /// The greatest magnitude of a coordinate.
            coordinate: f64,
            /// The smallest spacing for such coordinates.
            limit: f64,
        },
        /// The corners of a box are no lowest and highest corner.
        #[code = J0403]
        #[error(
            "a box from {low} to {high} along {axis} is no stock: give its lowest and its highest corner, with \
             coordinates within {LARGEST_COORDINATE:e}"
        )]
        Box {
            /// `x`, `y` or `z`.
            axis: char,
            /// The coordinate of the lowest corner.
            low: f64,
            /// The coordinate of the highest corner.
            high: f64,
        },
        /// A mesh has no inside.
        #[code = J0404]
        #[error(
            "the mesh of the {what} has no inside, since it is not closed, not consistently oriented or inside out: \
             export it as one solid"
        )]
        NoInside {
            /// `stock` or `part`.
            what: &'static str,
        },
        /// The winding number of a mesh about a point is negative.
        #[code = J0405]
        #[error(
            "the mesh is inside out around the point {}, {}, {}: export it as one solid that does not cross itself",
            .point[0], .point[1], .point[2]
        )]
        InsideOut {
            /// The point, in the mesh's unit.
            point: [f64; 3],
        },
        /// The lattice has too many nodes.
        #[code = J0406]
        #[error(
            "the box around the stock has {nodes:.1e} nodes at a spacing of {spacing}, more than {limit}: give a \
             spacing of {coarser:.3e} or more"
        )]
        TooManyNodes {
            /// The given spacing.
            spacing: f64,
            /// The number of nodes in the box.
            nodes: f64,
            /// The greatest number of nodes.
            limit: usize,
            /// A spacing that gives no more nodes than that.
            coarser: f64,
        },
        /// The stock has too many points.
        #[code = J0407]
        #[error(
            "the stock has {points} points at a spacing of {spacing}, those of all readings of the program together, more than \
             {MAX_POINTS}: give a spacing of about {coarser:.3e} or more, or state the control and the variables"
        )]
        TooManyPoints {
            /// The given spacing.
            spacing: f64,
            /// The number of points inside, of all readings together.
            points: usize,
            /// A spacing that gives about the greatest number of points.
            coarser: f64,
        },
        /// No point of the lattice is inside the stock.
        #[code = J0408]
        #[error(
            "no point of a lattice with a spacing of {spacing} is inside the stock: give a smaller spacing"
        )]
        Empty {
            /// The given spacing.
            spacing: f64,
        },
        /// The points of a stock are turned otherwise than by quarter turns.
        #[code = J0409]
        #[error(
            "x = {x:?} and z = {z:?} are not directions of two coordinate axes, such as [1, 0, 0] and [0, 0, -1]: give such ones, or write \
             the stock by `output`, turn this mesh, and state it as `mesh`"
        )]
        Turn {
            /// The given direction of the axis x.
            x: [f64; 3],
            /// That of the axis z.
            z: [f64; 3],
        },
        /// Nothing of the stock is left.
        #[code = J0410]
        #[error("nothing of the stock is left, so it has no surface")]
        NothingLeft,
        /// The points are no cloud.
        #[code = J0411]
        #[error(transparent)]
        Cloud(#[from] CloudError),
        /// The surface of what is left is no mesh.
        #[code = J0412]
        #[error(transparent)]
        Mesh(#[from] MeshError),
        /// The travel of a motion is not a finite length of 0 or more, or needs too many samples.
        #[code = J0413]
        #[error(
            "a travel of {max_travel} is not a length from 0 to {limit:e}, the longest that is sampled at this \
             spacing: correct the motion, or divide it"
        )]
        Travel {
            /// The given travel.
            max_travel: f64,
            /// The greatest travel of one motion.
            limit: f64,
        },
        /// The tolerance is not a finite length of 0 or more.
        #[code = J0414]
        #[error("{tolerance} is no tolerance: give a length of 0 or more")]
        Tolerance {
            /// The given tolerance.
            tolerance: f64,
        },
        /// The tool is a solid without an axis, and a pose has no spin.
        #[code = J0415]
        #[error(
            "an axis does not place `{solid}`, a solid without one: give a motion between poses with a quaternion"
        )]
        NoSpin {
            /// The solid's name.
            solid: String,
        },
        /// The part is in another unit than the stock.
        #[code = J0416]
        #[error("the part is in {part}, but the stock is in {stock}: read both in the same unit")]
        Unit {
            /// The part's unit.
            part: Unit,
            /// The stock's unit.
            stock: Unit,
        },
    }
}
