//! The part of Touchoff that runs in a web page: a cycle of the haptic loop, the compiler of tools, the shapes to draw, and the
//! check of programs.
//!
//! [`Engine`] and [`Checker`] are the interface to JavaScript, each for a thread of its own. Lengths are in the part's unit,
//! forces in N, torques in N·mm. Structured results are JSON; coordinates are typed arrays.
//!
//! ```text
//! STL ─▶ part ─┐
//!              ├─▶ touch: a hand, a session and a probe ─▶ state, contacts
//! text ─▶ tool ┴─▶ surface: triangles to draw
//!
//! G-code, APT ─▶ program ─▶ checker ─▶ findings; depth and clearance at each position
//!                              └─▶ stock ─▶ what remains at a position
//! ```

#![deny(missing_docs, missing_debug_implementations)]

mod checker;
mod engine;
mod error;
mod part;
mod program;
mod stock;
mod surface;
mod tool;
mod touch;

pub use checker::Checker;
pub use engine::Engine;
