//! Force and torque without a cloud: the triangles that a tool touches are integrated, and halved where the error is largest.
//!
//! ```text
//! touched faces ──rule──▶ outside? dropped      inside? two rules, their difference
//!       ▲                 cut? the part in which magnitude, as a plane, is positive, by the same rules
//!       └── halved ◀── those with more than their share of the error, until the sum is as wished
//! ```
//!
//! An experiment beside the clouds of the project: `src/bin/adaptive.rs` says what came of it.

mod cell;
mod integrate;
mod page;
mod scenes;
mod table;

pub use page::page;
