//! The results of a certifier.

use crate::escape::Escaped;
use crate::id::{SurfaceId, TriangleId};
use crate::interval::Interval;
use nalgebra::{Point3, Vector3};
use std::fmt;

/// The error for a tool that cannot be certified. Without a profile its distance is unknown, and no bound is
/// proved on the rate at which the depth of its file changes.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "{tool} cannot be certified: it has no profile, and how fast its depth changes is not \
     proved; write it as a `profile {{ … }}`, or see `touchoff check`"
)]
#[non_exhaustive]
pub struct NotCertifiable {
    /// The name of the tool.
    pub tool: String,
}

crate::debug_as_sentence!(NotCertifiable);

/// The error for a surface that the tool does not have.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[error("{tool} has {count} surfaces: there is none of number {}", .surface.0)]
#[non_exhaustive]
pub struct NoSuchSurface {
    /// The name of the tool.
    pub tool: String,
    /// The number of its surfaces.
    pub count: usize,
    /// The surface that was asked for.
    pub surface: SurfaceId,
}

crate::debug_as_sentence!(NoSuchSurface);

/// The error for an invalid allowance.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AllowanceError {
    /// The tool has no surface of that name.
    #[error("{tool} has no surface `{}`; it has {known}", Escaped(surface))]
    NoSurface {
        /// The name of the tool.
        tool: String,
        /// The name that was given.
        surface: String,
        /// The names of the tool's surfaces.
        known: String,
    },
    /// The allowance is negative, but the distances of outside points from the surface are unknown.
    #[error(
        "{tool} has no profile, so that `{surface}` can keep no margin: draw its `profile {{ … }}`, or allow 0 or \
         more"
    )]
    NoMargin {
        /// The name of the tool.
        tool: String,
        /// The name of the surface.
        surface: String,
    },
    /// The allowance is not a length.
    #[error(
        "an allowance of {allowed} for `{}` is not a length: give a finite number, or no allowance",
        Escaped(surface)
    )]
    NoLength {
        /// The name of the surface.
        surface: String,
        /// The value that was given.
        allowed: f64,
    },
}

crate::debug_as_sentence!(AllowanceError);

/// Several invalid allowances. The message has a line for each of the first, and the number of those left out.
#[derive(Clone, PartialEq)]
pub struct AllowanceErrors(pub Vec<AllowanceError>);

impl AllowanceErrors {
    /// Largest number of allowances that the message lists.
    const MAX_SHOWN: usize = 20;
}

impl fmt::Display for AllowanceErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (shown, left_out) = self.0.split_at(self.0.len().min(AllowanceErrors::MAX_SHOWN));
        let mut lines: Vec<String> = shown.iter().map(ToString::to_string).collect();
        if !left_out.is_empty() {
            lines.push(format!("{} more allowances are invalid", left_out.len()));
        }
        f.write_str(&lines.join("\n"))
    }
}

crate::debug_as_sentence!(AllowanceErrors);

impl std::error::Error for AllowanceErrors {}

/// The deepest penetration of a part's triangles into a tool.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Penetration {
    /// The lower and upper bound of the depth, in the part's unit; 0 if nothing is inside.
    pub depth: Interval,
    /// A point whose depth is at least the lower bound; `None` if none was found inside.
    pub witness: Option<Witness>,
}

/// A point of contact or closest approach between a tool and a part.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Witness {
    /// The point on the part, in world coordinates.
    pub point: Point3<f64>,
    /// The triangle of the mesh.
    pub triangle: TriangleId,
    /// The surface of the tool that is the nearest.
    pub surface: SurfaceId,
}

/// The verdict on a tool at a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PoseVerdict {
    /// No point of the part is deeper in the tool than is allowed, and the tool is outside the part. Without
    /// allowances, no point of the part is inside the tool or on its surface.
    Clear,
    /// No triangle is deeper than is allowed, but the part has no inside: its mesh is open, inside out or not
    /// consistently oriented. Whether the tool is inside the material is unknown.
    SurfaceOnly,
    /// A point of the part is deeper in the tool than its surface is [allowed](super::Certifier::with_allowance) to
    /// be.
    Touching(Witness),
    /// No point is too deep, and the tool is outside the part if that has an inside, but a point of the part is nearer to a
    /// surface than its margin.
    Near(Witness),
    /// A connected piece of the restricted interior is inside the material, where no triangle shows it. The
    /// restricted interior is the whole tool, or the points that are deeper than the allowance of their nearest
    /// surface. Holds a surface of that piece.
    Inside(SurfaceId),
    /// Rounding decides, or the budget is spent: no point of a triangle is deeper than is allowed, or nearer than a margin if no
    /// point is deeper, by more than this, in the part's unit. It is 0 if the open question is whether the tool is inside the
    /// material. Where depth or the inside is undecided, nothing is said of margins.
    Undecided(f64),
}

/// The sentence of a verdict on the surface alone.
const NO_INSIDE: &str = "no triangle is too deep, and the part has no inside: repair its mesh";

/// The point with its triangle, and the surface by its number.
impl fmt::Display for Witness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z]: [f64; 3] = self.point.into();
        let Witness { triangle, surface, .. } = self;
        write!(f, "triangle {triangle} at ({x:.4}, {y:.4}, {z:.4}) and surface {}", surface.0)
    }
}

/// The sentence of the verdict. Surfaces have the numbers of the tool's list.
impl fmt::Display for PoseVerdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PoseVerdict::Clear => f.write_str("clear"),
            PoseVerdict::SurfaceOnly => f.write_str(NO_INSIDE),
            PoseVerdict::Touching(witness) => write!(f, "too deep: {witness}"),
            PoseVerdict::Near(witness) => write!(f, "nearer than a margin: {witness}"),
            PoseVerdict::Inside(surface) => {
                write!(f, "inside the material, with surface {}", surface.0)
            }
            PoseVerdict::Undecided(0.0) => {
                f.write_str("undecided whether the tool is inside the material")
            }
            PoseVerdict::Undecided(excess) => {
                write!(f, "undecided: no more than {excess} deeper than allowed")
            }
        }
    }
}

impl PoseVerdict {
    /// Returns whether it is proved that the tool is clear: no allowance is exceeded, and the tool is outside the
    /// part. It is not if only the part's surface could be checked ([`PoseVerdict::SurfaceOnly`]).
    pub fn is_clear(&self) -> bool {
        matches!(self, PoseVerdict::Clear)
    }

    /// Returns the place of the verdict among all, the gravest first.
    pub(super) fn rank(&self) -> u8 {
        match self {
            PoseVerdict::Touching(_) => 0,
            PoseVerdict::Inside(_) => 1,
            PoseVerdict::Undecided(_) => 2,
            PoseVerdict::Near(_) => 3,
            PoseVerdict::SurfaceOnly => 4,
            PoseVerdict::Clear => 5,
        }
    }
}

/// The verdict on a tool along a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotionVerdict {
    /// No point of the part exceeds its allowance by more than the tolerance at any time, and the tool is outside the
    /// part.
    Clear,
    /// The same, but the part has no inside: its mesh is open, inside out or not consistently oriented. Whether the
    /// tool is inside the material is unknown.
    SurfaceOnly,
    /// At this fraction of the motion, from 0 to 1, a point is deeper than is allowed. It may not be the first.
    Touching(f64, Witness),
    /// No point is too deep at any time, and the tool is outside the part if that has an inside, but at this fraction of the
    /// motion a point is nearer to a surface than its margin. It may not be the first.
    Near(f64, Witness),
    /// A connected piece of the restricted interior is inside the material when the motion begins, where no triangle
    /// shows it. Holds a surface of that piece.
    Inside(SurfaceId),
    /// The budget is spent, or rounding decides. The motion is clear up to this fraction of it, from 0 to 1; the rest
    /// is unknown. Where depth or the inside is undecided, nothing is said of margins.
    Undecided(f64),
}

/// The sentence of the verdict. Surfaces have the numbers of the tool's list.
impl fmt::Display for MotionVerdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MotionVerdict::Clear => f.write_str("clear"),
            MotionVerdict::SurfaceOnly => f.write_str(NO_INSIDE),
            MotionVerdict::Touching(at, witness) => {
                write!(f, "too deep at {:.1} % of the motion: {witness}", 100.0 * at)
            }
            MotionVerdict::Near(at, witness) => {
                write!(f, "nearer than a margin at {:.1} % of the motion: {witness}", 100.0 * at)
            }
            MotionVerdict::Inside(surface) => {
                write!(f, "begins inside the material, with surface {}", surface.0)
            }
            MotionVerdict::Undecided(at) => {
                write!(f, "undecided after {:.1} % of the motion", 100.0 * at)
            }
        }
    }
}

impl MotionVerdict {
    /// Returns whether it is proved that the tool is clear during the whole motion, as in [`PoseVerdict::is_clear`].
    pub fn is_clear(&self) -> bool {
        matches!(self, MotionVerdict::Clear)
    }

    /// Returns the place of the verdict among all, in the order of [`PoseVerdict::rank`].
    pub(super) fn rank(&self) -> u8 {
        match self {
            MotionVerdict::Touching(..) => 0,
            MotionVerdict::Inside(_) => 1,
            MotionVerdict::Undecided(_) => 2,
            MotionVerdict::Near(..) => 3,
            MotionVerdict::SurfaceOnly => 4,
            MotionVerdict::Clear => 5,
        }
    }
}

/// The depth of a surface of a tool in a part along a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotionDepth {
    /// The surface exceeds its allowance by no more than the tolerance at any time, and no region of the tool that it
    /// owns is inside the material. For a part without an inside (see [`MotionVerdict::SurfaceOnly`]) the latter is
    /// unknown.
    Within,
    /// The surface is deeper than its allowance, or nearer than its margin.
    Deeper {
        /// The fraction of the motion, from 0 to 1, of the greatest depth found.
        at: f64,
        /// The lower and upper bound of the depth at that time, in the part's unit. If negative, the magnitude is the
        /// distance from the part.
        depth: Interval,
        /// Upper bound on depth over the motion, in the part's unit. It usually exceeds `depth.low` by at most the
        /// tolerance or an eighth of the excess over the allowance, whichever is larger.
        max_depth: f64,
        /// The point with that depth at that time.
        witness: Witness,
    },
    /// No triangle exceeds the allowance, or none that is decided, but a region that the surface owns is inside the material when
    /// the motion begins.
    Inside,
    /// The budget is spent, or rounding decides. The allowance holds up to this fraction of the motion, from 0 to 1;
    /// the rest is unknown.
    Undecided(f64),
}

impl MotionDepth {
    /// Returns whether it is proved that the surface stays within its allowance during the whole motion.
    pub fn is_clear(&self) -> bool {
        matches!(self, MotionDepth::Within)
    }
}

/// The distance of a tool from a part.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Clearance {
    /// The lower and upper bound of the distance, in the part's unit; 0 in contact.
    pub distance: Interval,
    /// The nearest point found on the part.
    pub witness: Option<Witness>,
    /// The point of the tool's surface that is the nearest to it; `None` without a witness, and for a tool without a
    /// profile.
    pub on_tool: Option<ToolPoint>,
}

/// A point of a tool's surface, in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ToolPoint {
    /// The point. Any point of a circle about the axis is as near to a witness on the axis; this is one of them.
    pub point: Point3<f64>,
    /// The unit normal of the tool there, outward. Where a point outside is nearest to an edge of the tool, it points to
    /// that point.
    pub normal: Vector3<f64>,
}
