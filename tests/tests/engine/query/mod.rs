//! The tree query against asking the oracle about every point.
//!
//! [`compare`] holds the comparison and its bounds, [`parts`] and [`poses`] what is compared.

mod aligned;
mod anywhere;
mod bits;
mod compare;
mod composed;
mod error;
mod far;
mod law;
mod margins;
mod parts;
mod poses;
mod scenes;
mod solids;
mod stiffness;
mod sums;
