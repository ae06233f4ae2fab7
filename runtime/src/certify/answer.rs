//! What a certifier says.

use nalgebra::Point3;

/// A tool of which nothing can be certified: it has no profile, so that its distance
/// is not known, and of the depth that its file says it is not proved how fast it changes.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{tool} cannot be certified: it has no profile, and how fast its depth changes is not \
     proved; draw its `profile {{ … }}`, or see what `touchoff check` says of it"
)]
pub struct Uncertified {
    /// Its name.
    pub tool: String,
}

/// An allowance that means nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AllowanceError {
    /// The tool has no surface of that name.
    #[error("{tool} has no surface `{surface}`; it has {known}")]
    NoSurface {
        /// The tool's name.
        tool: String,
        /// The name that was given.
        surface: String,
        /// Those that there are.
        known: String,
    },
    /// How far its surfaces are from places outside is not known.
    #[error(
        "{tool} has no profile, so that `{surface}` can keep no margin: draw its `profile {{ … }}`, or allow 0 or \
         more"
    )]
    NoMargin {
        /// The tool's name.
        tool: String,
        /// The surface's name.
        surface: String,
    },
    /// It is not a length.
    #[error("an allowance of {allowed} for `{surface}` is no length")]
    NoLength {
        /// The surface's name.
        surface: String,
        /// What was given.
        allowed: f64,
    },
}

/// The deepest penetration of a part's triangles into a tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penetration {
    /// Between what the depth lies, in the part's unit. It is 0 where nothing is inside.
    pub depth: [f64; 2],
    /// Where it is at least the lower of them; `None` where nothing was found inside.
    pub witness: Option<Witness>,
}

/// A place where a tool and a part are at each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Witness {
    /// Where it is on the part, in the world.
    pub point: Point3<f64>,
    /// The triangle it lies on.
    pub triangle: u32,
    /// The tool's nearest surface, by its place in the card's list.
    pub surface: usize,
}

/// Whether a tool is clear of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Clear {
    /// No point of the part is inside the tool or on its surface, and the tool is outside the part.
    Clear,
    /// No triangle touches the tool, or none is deeper than allowed, but the part has no inside: its mesh
    /// leaks, is inside out or not consistently oriented. Whether the tool is inside the material is not
    /// known.
    SurfaceOnly,
    /// A point of the part is inside the tool, or deeper than its surface is [allowed](super::Certifier::allow)
    /// to be, or nearer.
    Touching(Witness),
    /// A piece of what may not be in the part is wholly inside the material, where no triangle shows it: all
    /// of the tool, or what surfaces own that may not be so deep. Holds a surface of that piece, by its place in
    /// the card's list.
    Inside(usize),
    /// What is closest is so near to the surface that rounding decides, or the budget was spent: no
    /// point of the part is deeper than is allowed by more than this, in the part's unit. It is 0 where only
    /// whether the tool is inside the material is not decided.
    Undecided(f64),
}

/// Whether a tool stays clear of a part on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sweep {
    /// At no time is a point of the part deeper than is allowed, by more than the tolerance, and the tool is
    /// outside the part.
    Clear,
    /// The same, but the part has no inside: its mesh leaks, is inside out or not consistently oriented.
    /// Whether the tool is inside the material is not known.
    SurfaceOnly,
    /// At this part of the way, from 0 to 1, a point is deeper than is allowed; it may not be the first.
    Touching(f64, Witness),
    /// A piece of what may not be in the part is wholly inside the material when the motion begins, where no
    /// triangle shows it. Holds a surface of that piece, by its place in the card's list.
    Inside(usize),
    /// The budget was spent, or rounding decides: until this part of the way it is clear, and what comes then is
    /// not known.
    Undecided(f64),
}

/// How deep a surface of a tool gets in a part on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Along {
    /// At no time deeper than is allowed by more than the tolerance, and nothing of the tool that the surface
    /// owns is wholly inside the material. Of a part that has no inside (see [`Sweep::SurfaceOnly`]) the
    /// latter is not known.
    Within,
    /// Deeper than is allowed, or nearer.
    Deeper {
        /// The part of the way, from 0 to 1, at which it is deepest as far as was found.
        at: f64,
        /// Between what its depth lies then, in the part's unit; below 0 how far it is from the part.
        depth: [f64; 2],
        /// What it is no deeper than on the whole motion: seldom more than the lower of them by an eighth of
        /// what is too much, or by the tolerance.
        most: f64,
        /// Where it is that deep then.
        witness: Witness,
    },
    /// No triangle is so deep, but what the surface owns is wholly inside the material when the motion begins.
    Inside,
    /// The budget was spent, or rounding decides: until this part of the way it is no deeper, and what comes
    /// then is not known.
    Undecided(f64),
}

/// How far a tool is from a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// Between what the distance lies, in the part's unit; 0 where they touch.
    pub distance: [f64; 2],
    /// Where the part is that near.
    pub witness: Option<Witness>,
}
