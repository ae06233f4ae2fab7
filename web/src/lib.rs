//! The part of Touchoff that runs in a web page: a cycle of the haptic loop, the compiler of tools, and the shapes to draw.
//!
//! [`Engine`] is the interface to JavaScript. Lengths are in the part's unit, forces in N, torques in N·mm. Structured
//! results are JSON; coordinates are typed arrays.
//!
//! ```text
//! STL ─▶ part ─┐
//!              ├─▶ touch: a session and a probe ─▶ state, contacts
//! text ─▶ tool ┘     ▲ target
//!                    hand
//! ```

#![deny(missing_docs, missing_debug_implementations)]

mod engine;
mod error;
mod hand;
mod implicit;
mod library;
mod outline;
mod part;
mod tool;
mod touch;

pub use engine::Engine;
