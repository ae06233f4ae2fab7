//! Findings of a verification.

use super::Approach;
use crate::program::ProgramError;
use touchoff::certify::{AllowanceError, NotCertifiable, Witness};
use touchoff::{Interval, MotionError, Pose, SurfaceId};

/// A reason for which a program cannot be checked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VerifyError {
    /// The tool cannot be certified.
    #[error(transparent)]
    NotCertifiable(#[from] NotCertifiable),
    /// An allowance is invalid.
    #[error(transparent)]
    Allowance(#[from] AllowanceError),
    /// The program does not fit the part or the tool: its unit, its cutter, or its poses.
    #[error(transparent)]
    Program(#[from] ProgramError),
    /// A tolerance or a resolution is not a finite length of 0 or more.
    #[error("{tolerance} is no tolerance: give a length of 0 or more")]
    Tolerance {
        /// The given value.
        tolerance: f64,
    },
}

/// The result of checking a program.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct VerifyReport {
    /// Number of moves that were checked, the first position among them.
    pub moves: usize,
    /// Number of motions: one less than moves.
    pub motions: usize,
    /// Findings in the program's order; those of one motion in the order of the tool's surfaces.
    pub findings: Vec<Finding>,
    /// Set if the part has an inside: its mesh is closed, consistently oriented and not inside out. Otherwise a
    /// tool that is wholly inside the material is never found.
    pub inside_known: bool,
    /// The closest approach of the tool to the part.
    pub approach: Approach,
    /// Set if nothing could have been found: every surface may be as deep as possible, less the resolution, in
    /// all modes that the program uses.
    pub unrestricted: bool,
}

impl VerifyReport {
    /// Returns whether it is proved that the program does what is allowed: there are no findings, something could have
    /// been found, and the part has an inside.
    pub fn is_clear(&self) -> bool {
        self.findings.is_empty() && self.inside_known && !self.unrestricted
    }
}

/// A violation in one motion, or at the first cutter location of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Finding {
    /// Index of the cutter location at which the motion ends.
    pub location: usize,
    /// Line of that cutter location.
    pub line: usize,
    /// Line of the cutter location at which the motion begins; `None` for the first one, which is checked by
    /// itself.
    pub from: Option<usize>,
    /// Set if the motion is in rapid traverse.
    pub rapid: bool,
    /// Time on the motion, from 0 to 1, at which the tool is deepest, or from which on the result is unknown.
    pub time: f64,
    /// Pose of the tool at that time, in the part's frame and unit.
    pub pose: Pose,
    /// Set in rapid traverse whose axes move at rates that are not known: the pose is on the path at some rates, and not on the
    /// straight one.
    pub any_rates: bool,
    /// The kind of violation.
    pub kind: FindingKind,
}

/// The kind of a finding. Lengths are in the part's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FindingKind {
    /// A surface is deeper in the part than allowed.
    Deep {
        /// The tool's surface.
        surface: SurfaceId,
        /// The allowed depth.
        allowed: f64,
        /// Interval that contains the depth at the finding's pose, the deepest that was found.
        depth: Interval,
        /// Upper bound on the depth over the whole motion.
        max_depth: f64,
        /// Set if the part's surface passes the middle of the tool there. No point of the tool is deeper, so
        /// the depth does not tell how far the tool is in the material.
        through: bool,
        /// The point of the part at that depth.
        witness: Witness,
    },
    /// A surface comes nearer to the part than its margin.
    Near {
        /// The tool's surface.
        surface: SurfaceId,
        /// The distance to keep.
        margin: f64,
        /// Interval that contains the distance at the finding's pose, the nearest that was found.
        distance: Interval,
        /// Lower bound on the distance over the whole motion.
        min_distance: f64,
        /// The point of the part at that distance.
        witness: Witness,
    },
    /// A connected piece of the tool is wholly inside the material when the motion begins, where no triangle
    /// shows it.
    Inside {
        /// The surface that owns the piece; `None` if the whole tool is inside.
        surface: Option<SurfaceId>,
    },
    /// Rounding decides, or the budget was spent. Until the finding's time the surface is no deeper than
    /// allowed; the result after it is unknown.
    Undecided {
        /// The tool's surface.
        surface: SurfaceId,
    },
    /// The axes are antiparallel, or a solid turns by half a turn, so that the rotation is ambiguous: only the
    /// cutter location itself was checked.
    Ambiguous(MotionError),
}

impl FindingKind {
    /// Returns the surface of the finding, if it is about one.
    pub fn surface(&self) -> Option<SurfaceId> {
        match self {
            FindingKind::Deep { surface, .. }
            | FindingKind::Near { surface, .. }
            | FindingKind::Undecided { surface } => Some(*surface),
            FindingKind::Inside { surface } => *surface,
            FindingKind::Ambiguous(_) => None,
        }
    }
}
