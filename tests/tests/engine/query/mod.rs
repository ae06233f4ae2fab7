//! The tree query against evaluations of the oracle at every point.
//!
//! [`compare`] has the comparison and its bounds, [`parts`] the inputs.

mod aligned;
mod anywhere;
mod bits;
mod bounds;
mod brute;
pub(crate) mod compare;
mod composed;
mod error;
mod far;
mod law;
mod margins;
pub(crate) mod parts;
mod stiffness;
mod sums;
