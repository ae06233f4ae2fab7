//! The compiler of `.tool` files, an ordinary library.
//!
//! [`compile()`] runs the passes, whose order and guarantees [`model`] states. A [`CheckedTool`] contains no errors, so [`emit::emit`] and
//! [`interpret::Interpreter`] cannot fail.

#![deny(missing_docs, missing_debug_implementations, unnameable_types)]

pub mod bound;
mod boxes;
mod checked;
mod compile;
pub mod diagnostic;
mod digest;
mod dimension;
pub mod domain;
mod elimination;
pub mod emit;
#[cfg(feature = "macros")]
pub mod expand;
pub mod expr;
pub mod format;
pub mod formula;
mod geometry;
pub mod interpret;
#[cfg(test)]
mod library;
mod lint;
pub mod model;
pub mod number;
pub mod plan;
pub mod prove;
mod regionalise;
pub mod resolve;
pub mod source;
pub mod syntax;
mod validate;

pub use checked::CheckedTool;
pub use compile::{Accepted, Compiled, compile, compile_with_arguments};
pub use digest::digest;
#[doc(hidden)]
pub use regionalise::normals::{Features, Normal, NormalEnd};
