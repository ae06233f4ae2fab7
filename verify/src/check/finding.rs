//! Findings of a verification, and those of consecutive motions joined.

use super::Approach;
use crate::codes::faults;
use crate::gcode::{BlockLine, SubprogramLine};
use crate::program::ProgramError;
use std::cmp::Ordering;
use std::mem::{self, Discriminant};
use touchoff::certify::{AllowanceErrors, NotCertifiable, Witness};
use touchoff::{Interval, MotionError, Pose, SurfaceId};

faults! {
    #[family("J05", "Tools and limits")]
    /// A reason for which a program cannot be checked.
    #[derive(thiserror::Error)]
    #[non_exhaustive]
    pub enum VerifyError {
        /// The tool cannot be certified.
        #[code = J0501]
        #[error(transparent)]
        NotCertifiable(#[from] NotCertifiable),
        /// Some allowances are invalid.
        #[code = J0502]
        #[error(transparent)]
        Allowances(#[from] AllowanceErrors),
        /// The program does not fit the part or the tool: its unit, its cutter, or its poses.
        #[code_of(0)]
        #[error(transparent)]
        Program(#[from] ProgramError),
        /// A tolerance or a resolution is not a finite length of 0 or more.
        #[code = J0503]
        #[error("{tolerance} is no tolerance: give a length of 0 or more")]
        Tolerance {
            /// The given value.
            tolerance: f64,
        },
        /// The part is so large that rounding hides more than the resolution.
        #[code = J0504]
        #[error(
            "the part is so large that motions are checked to {least:.3} {unit} only: remove what is far away, or state a resolution \
             from that on"
        )]
        Rounding {
            /// The least resolution, in the part's unit.
            least: f64,
            /// The symbol of that unit.
            unit: &'static str,
        },
    }
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
    /// The surfaces that are nowhere as deep as the tolerance, so that no finding of them is possible.
    pub unchecked_surfaces: Vec<SurfaceId>,
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
    /// The line of the motion in the file of subprograms that has it.
    pub within: Option<SubprogramLine>,
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

impl Finding {
    /// Returns the place of the block or cutter location.
    pub fn block(&self) -> BlockLine {
        BlockLine { line: self.line, within: self.within }
    }
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

/// Findings of the same kind and surface in consecutive motions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FindingGroup {
    /// The finding of the first motion.
    pub first: Finding,
    /// The worst finding: the deepest, or the nearest. Its bound holds for all motions of the group.
    pub worst: Finding,
    /// The finding of the last motion.
    pub last: Finding,
    /// Number of blocks or cutter locations.
    pub motions: usize,
}

impl FindingGroup {
    /// Joins findings in the program's order. Groups come in order of their first motion.
    pub fn join(findings: &[Finding]) -> Vec<FindingGroup> {
        let mut groups: Vec<FindingGroup> = Vec::new();
        // The groups that the next motion may continue; a tool has few surfaces.
        let mut open: Vec<(Key, usize)> = Vec::new();
        for finding in findings {
            let key = (finding.kind.surface(), mem::discriminant(&finding.kind));
            let position = open.iter().position(|(known, _)| *known == key);
            if let Some(position) = position {
                let group = &mut groups[open[position].1];
                // A motion without such a finding between them ends the group.
                if finding.location <= group.last.location + 1 {
                    group.add(finding);
                    continue;
                }
                open.swap_remove(position);
            }
            open.push((key, groups.len()));
            groups.push(FindingGroup {
                first: *finding,
                worst: *finding,
                last: *finding,
                motions: 1,
            });
        }
        groups
    }

    fn add(&mut self, finding: &Finding) {
        // A block may have several moves, and a first position by itself.
        self.motions += usize::from(finding.block() != self.last.block());
        self.last = *finding;
        let other = if finding.kind.severity(&self.worst.kind) == Ordering::Greater {
            mem::replace(&mut self.worst, *finding)
        } else {
            *finding
        };
        self.worst.kind.include_bound(&other.kind);
    }
}

/// The surface and the kind of a finding.
type Key = (Option<SurfaceId>, Discriminant<FindingKind>);

impl FindingKind {
    /// Extends the bound over the motion to that of another finding of the same kind.
    pub(super) fn include_bound(&mut self, other: &FindingKind) {
        match (self, other) {
            (FindingKind::Deep { max_depth, .. }, FindingKind::Deep { max_depth: other, .. }) => {
                *max_depth = max_depth.max(*other);
            }
            (
                FindingKind::Near { min_distance, .. },
                FindingKind::Near { min_distance: other, .. },
            ) => *min_distance = min_distance.min(*other),
            _ => (),
        }
    }

    /// Compares findings by severity: a tool or a surface inside the material, then depth beyond the allowance, then
    /// distance short of the margin, then motions that could not be decided.
    pub fn severity(&self, other: &FindingKind) -> Ordering {
        self.rank().cmp(&other.rank())
    }

    /// Returns the place in the order of severity.
    pub(crate) fn rank(&self) -> Rank {
        match self {
            FindingKind::Inside { surface: None } => Rank { class: RankClass::Inside, excess: 0.0 },
            FindingKind::Inside { surface: Some(_) } => {
                Rank { class: RankClass::PieceInside, excess: 0.0 }
            }
            FindingKind::Deep { allowed, depth, through, .. } => {
                Rank::deep(if *through { f64::INFINITY } else { depth.low - allowed })
            }
            FindingKind::Near { margin, distance, .. } => {
                Rank { class: RankClass::Near, excess: margin - distance.high }
            }
            FindingKind::Ambiguous(_) => Rank { class: RankClass::Ambiguous, excess: 0.0 },
            FindingKind::Undecided { .. } => Rank { class: RankClass::Undecided, excess: 0.0 },
        }
    }

    /// Returns whether the tool is so far in the material that no depth tells how far: a piece of it is inside, or the
    /// surface of the material passes its middle.
    pub(crate) fn is_right_through(&self) -> bool {
        matches!(self, FindingKind::Inside { .. } | FindingKind::Deep { through: true, .. })
    }
}

/// The place of a finding in the order of severity: the greater, the worse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rank {
    class: RankClass,
    /// A measure within the class, the length beyond a limit in the part's unit.
    excess: f64,
}

/// The classes of findings, from the least to the worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum RankClass {
    Undecided,
    Ambiguous,
    Machine,
    Near,
    Deep,
    PieceInside,
    Inside,
}

impl Rank {
    /// Returns the rank of a depth that exceeds its limit by a length.
    pub(crate) fn deep(excess: f64) -> Rank {
        Rank { class: RankClass::Deep, excess }
    }

    /// Returns the rank of a finding about the machine, which has no depth. A greater measure is worse.
    pub(crate) fn machine(measure: f64) -> Rank {
        Rank { class: RankClass::Machine, excess: measure }
    }

    pub(crate) fn cmp(&self, other: &Rank) -> Ordering {
        self.class.cmp(&other.class).then(self.excess.total_cmp(&other.excess))
    }
}
