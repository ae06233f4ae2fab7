//! The G-code interpreter: LinuxCNC's own tests, programs with known motions, refusals, Klartext, and mutants.

mod common;
mod compensation;
mod expected;
mod figures;
mod geometry;
mod klartext;
mod klartext_cycles;
mod macros;
mod mutants;
mod next_run;
mod refusals;
mod sinumerik;
mod subprograms;
