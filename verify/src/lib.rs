//! Verification of programs of machine tools against the finished part.
//!
//! ```text
//! program (tables, APT) ───────────────────────────▶ moves ──▶ check ──▶ findings
//! gcode (text, by the rules of a control) ──machine──▶ moves ──▶ stock ──▶ contacts with material that is left
//! ```
//!
//! A [`Verifier`] checks the moves of one tool against one body, from a [`ClData`] of cutter locations or a
//! [`MachineProgram`]. Lengths are in the part's unit, frames are right-handed, and a tool's axis points from the tip to the
//! spindle.
//!
//! ```
//! # use nalgebra::{Point3, Vector3};
//! use touchoff::{Unit, certify::TriangleBvh, mesh::shapes};
//! use touchoff_verify::{ClData, Verifier};
//!
//! touchoff::tool! {
//!     tool Ball "6 mm ball" {
//!         units mm;
//!         profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; }
//!         niceness cutting: 1 - depth/3;
//!     }
//! }
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let block = shapes::cuboid(Point3::new(-20., -20., -10.), Point3::new(20., 20., 0.), Unit::Millimetre)?;
//! let bvh = TriangleBvh::new(&block);
//! // One location per line: tip x, y, z and axis i, j, k. The name is for messages.
//! let program = ClData::parse("0,0,5,0,0,1\n0,0,-0.5,0,0,1\n", "plunge.csv")?;
//! let report = Verifier::new(&bvh, &Ball)?.with_tolerance(0.01)?.check(&program)?;
//! assert!(!report.is_clear());
//! # Ok(()) }
//! ```

#![deny(missing_docs, missing_debug_implementations, unnameable_types)]

// The code blocks of this page are tests, too.
#[cfg(doctest)]
#[doc = include_str!("../../docs/verify.md")]
struct VerifyPage;

mod check;
pub mod gcode;
pub mod job;
pub mod machine;
pub mod program;
pub mod stock;

pub use check::{
    Approach, Finding, FindingGroup, FindingKind, Gap, JointPath, MAX_READINGS, MachineProgram,
    MachineProgramError, MachineSummary, Move, MovePath, RapidBox, StepFault, Tilt, ToolSelection,
    ToolUse, UnknownCause, UnknownMotions, Verifier, VerifyError, VerifyReport,
};
pub use job::{Job, JobError, JobFile, JobReport, JobTool, Program, Verdict};
pub use program::{ClData, CutterLocation, ProgramError};
