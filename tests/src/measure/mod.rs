//! Figures that the project quotes of itself, each made by a command of `src/bin`.

pub mod accuracy;
pub mod adaptive;
pub mod bench;
pub mod certified;
pub mod compile;
pub mod continuity;
pub mod convergence;
pub mod haptics;
pub mod kernels;
pub mod made;
pub mod mutants;
pub mod points;
pub mod postures;
pub mod rounding;
pub mod search;
pub mod stress;
