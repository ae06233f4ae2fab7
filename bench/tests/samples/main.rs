//! Samples of the measurements: the thresholds of the pages in `docs/measured` are met.

mod accuracy;
mod certified;
mod mutants;
mod postures;
mod stress;
