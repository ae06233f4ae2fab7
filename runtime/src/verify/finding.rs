//! What is found wrong with a program.

use super::Approach;
use crate::certify::{AllowanceError, Uncertified, Witness};
use crate::motion::MotionError;
use crate::pose::Pose;
use crate::program::ProgramError;

/// Why a program could not be checked.
#[derive(Debug, thiserror::Error)]
pub enum VerifyError {
    /// Nothing can be proved of the tool.
    #[error(transparent)]
    Uncertified(#[from] Uncertified),
    /// What is allowed means nothing.
    #[error(transparent)]
    Allowance(#[from] AllowanceError),
    /// The program is in another unit than the part.
    #[error(transparent)]
    Program(#[from] ProgramError),
    /// A tolerance or a resolution that is no length.
    #[error("{tolerance} is no tolerance: give a length of 0 or more")]
    Tolerance {
        /// What was given.
        tolerance: f64,
    },
}

/// What became of a program.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// How many motions it has: one less than stops.
    pub motions: usize,
    /// What is wrong, in the program's order; of one motion in the order of the card's surfaces.
    pub findings: Vec<Finding>,
    /// Whether the part has an inside: its mesh is closed, consistently oriented and not inside out. Otherwise
    /// a tool that is wholly inside the material is never found.
    pub inside_known: bool,
    /// How near the tool comes to the part.
    pub approach: Approach,
    /// Whether nothing could have been found: every surface may be as deep as it can be, less the resolution, in
    /// all modes that the program uses.
    pub nothing_restricted: bool,
}

/// Something wrong with one motion, or with the stop that a program begins at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// The stop that the motion ends at, by its place in the program.
    pub stop: usize,
    /// The line of that stop.
    pub line: usize,
    /// The line of the stop that the motion begins at; `None` of the first stop, which is checked by itself.
    pub from: Option<usize>,
    /// Whether the motion is in rapid traverse.
    pub rapid: bool,
    /// The part of the way, from 0 to 1, that it is about: where the tool is deepest, or what is not known
    /// begins.
    pub part: f64,
    /// The tool then, in the part's frame and unit.
    pub pose: Pose,
    /// What is wrong.
    pub kind: Kind,
}

/// What is wrong with a motion. Surfaces are places in the tool card's list, lengths in the part's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A surface is deeper in the part than it may be.
    Deep {
        /// The tool's surface.
        surface: usize,
        /// How deep it may be.
        allowed: f64,
        /// Between what its depth lies at the finding's pose, where it is deepest as far as was found.
        depth: [f64; 2],
        /// What it is no deeper than on the whole motion.
        most: f64,
        /// Whether the part's surface passes the middle of the tool there: no point of the tool is deeper, so
        /// that the depth says no more of how far the tool is in the material.
        through: bool,
        /// Where it is that deep then.
        witness: Witness,
    },
    /// A surface comes nearer to the part than its margin.
    Near {
        /// The tool's surface.
        surface: usize,
        /// How far it has to keep.
        margin: f64,
        /// Between what its distance lies at the finding's pose, where it is nearest as far as was found.
        distance: [f64; 2],
        /// What it is no nearer than on the whole motion.
        least: f64,
        /// Where it is that near then.
        witness: Witness,
    },
    /// A part of the tool is wholly inside the material when the motion begins, where no triangle shows it.
    Inside {
        /// The surface that owns the part; `None` if all of the tool is inside.
        surface: Option<usize>,
    },
    /// Rounding decides, or the budget was spent: until the finding's part of the way the surface is no
    /// deeper than it may be, and what comes then is not known.
    Undecided {
        /// The tool's surface.
        surface: usize,
    },
    /// The axis turns to its opposite, or a solid by half a turn, so that the way between is ambiguous: only the stop
    /// itself was checked.
    Ambiguous(MotionError),
}

impl Kind {
    /// The surface that it is about, if that is one.
    pub fn surface(&self) -> Option<usize> {
        match self {
            Kind::Deep { surface, .. }
            | Kind::Near { surface, .. }
            | Kind::Undecided { surface } => Some(*surface),
            Kind::Inside { surface } => *surface,
            Kind::Ambiguous(_) => None,
        }
    }
}
