//! Expressions as one shared graph: the single statement of what a tool computes.
//!
//! Everything that is said about a tool is said about this graph: the derivative
//! ([`mod@derive`]) is more of it, an enclosure ([`interval`]) and a value ([`value`]) are walks over
//! it, the emitted Rust and the interpreter's tape are listings of it.
//!
//! A node's meaning is a real function of the point that is felt, in the tool's frame and the
//! file's unit of length. Nodes are listed operands first, equal nodes are one node, constants are
//! folded with 256 bits.

pub mod derive;
mod graph;
pub mod interval;
mod node;
pub mod polynomial;
pub mod value;

pub use graph::Graph;
pub use node::{Coord, Id, Node};
