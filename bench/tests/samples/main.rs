//! Samples of the measurements: no bar that a page of `docs/measured` is held to is missed.

mod accuracy;
mod certified;
mod mutants;
mod postures;
mod stress;
