//! The G-code interpreter: LinuxCNC's own tests, programs with known motions, refusals, and mutants.

mod common;
mod expected;
mod geometry;
mod mutants;
mod next_run;
mod refusals;
mod sinumerik;
