//! Verification of programs of machine tools against the finished part.
//!
//! ```text
//! program (CL data) ─────────────────────────────────▶ moves ─┬─▶ check ──▶ findings ─┐
//! gcode (text, by the rules of a control) ──machine──▶ moves ─┴─▶ stock ──▶ contacts ─┴─job─▶ verdict
//! ```
//!
//! A [`Job`] checks a [`Program`] of any kind with its tools against the part, fixtures and stock, and gives a verdict. It is made of a
//! [`Verifier`] per tool and body, which also checks moves by itself: those of [`ClData`], or of a [`MachineProgram`]. Lengths are in
//! the part's unit, frames are right-handed, and a tool's axis points from the tip to the spindle. [`Job`] and [`Verifier`] have
//! examples.

#![deny(missing_docs, missing_debug_implementations, unnameable_types)]

// The code blocks of this page are tests, too.
#[cfg(doctest)]
#[doc = include_str!("../../docs/verify.md")]
struct VerifyPage;

#[cfg(doctest)]
#[doc = include_str!("../../docs/rust.md")]
struct RustPage;

mod check;
pub mod codes;
pub mod gcode;
pub mod job;
pub mod machine;
pub mod program;
pub mod stock;

pub use check::{
    Approach, Assumption, BlindWay, BlockError, BlockFault, Finding, FindingGroup, FindingKind,
    Gap, GapWeight, JointPath, Level, MAX_READINGS, MAX_VALUES, MachineProgram,
    MachineProgramError, MachineSummary, Move, MovePath, Obstacle, ProgramStop, RapidBox,
    StepFault, Tilt, ToolSelection, ToolUse, TopWay, UnknownCause, UnknownMotions, Verifier,
    VerifyError, VerifyReport,
};
pub use job::{Job, JobError, JobFile, JobReport, JobTool, Program, Verdict};
pub use program::{ClData, CutterLocation, ProgramError};
