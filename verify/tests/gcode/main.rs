//! The G-code interpreter: LinuxCNC's own tests, programs with known motions, refusals, and mutants.

mod common;
mod compensation;
mod expected;
mod geometry;
mod macros;
mod mutants;
mod next_run;
mod refusals;
mod sinumerik;
