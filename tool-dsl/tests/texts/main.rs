//! Texts that the compiler refuses, accepts with warnings or proves facts about, and the list of its codes.

mod errors;
mod proved;
mod refused;
mod warned;
