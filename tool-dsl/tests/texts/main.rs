//! Texts that the compiler refuses, warns of or proves something about, and the list of its codes.

mod errors;
mod proved;
mod refused;
mod warned;
