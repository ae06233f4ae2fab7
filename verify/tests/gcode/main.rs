//! The G-code interpreter: LinuxCNC's own tests, programs with known motions, refusals, Klartext, the programs of a folder, and mutants.

mod blank;
mod common;
mod compensation;
mod expected;
mod figures;
#[path = "../frozen/mod.rs"]
mod frozen;
mod geometry;
mod klartext;
mod klartext_cycles;
mod macros;
mod mutants;
mod programs;
mod refusals;
mod sinumerik;
mod subprograms;
mod survey;
