//! What a hand would feel of a tool's mathematics: steps of the force, work out of nothing, poses that drift.
//!
//! [`steps`] looks for the largest step of the force in a micrometre of motion, [`energy`] for the work that is done round closed loops
//! ([`loops`]), [`drift`] for what is left of a rotation after ten million of them.

pub mod drift;
pub mod energy;
pub mod loops;
pub mod page;
pub mod smooth;
pub mod steps;

mod change;
mod walk;

pub use change::{Change, push};
pub use walk::Walk;

use touchoff::Law;

/// Every law, in the order of tables.
pub const LAWS: [Law; 3] = [Law::Thesis, Law::Gradient, Law::Facing];
