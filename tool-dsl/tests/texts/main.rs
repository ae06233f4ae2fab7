//! Texts that the compiler refuses, accepts with warnings or proves facts about, the examples of its page, and the list
//! of its codes.

mod absurd;
mod errors;
mod language;
mod mended;
mod proved;
mod refused;
mod warned;
