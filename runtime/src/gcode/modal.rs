//! Modal settings that a motion depends on and that are no part of [`ControlState`](super::ControlState).

use crate::unit::Unit;

/// Plane of arcs and canned cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// G17: first axis X, second Y, normal Z.
    Xy,
    /// G18: first axis Z, second X, normal Y.
    Zx,
    /// G19: first axis Y, second Z, normal X.
    Yz,
}

impl Plane {
    /// Returns the indices of the first and the second axis (X is 0).
    pub const fn axes(self) -> [usize; 2] {
        match self {
            Plane::Xy => [0, 1],
            Plane::Zx => [2, 0],
            Plane::Yz => [1, 2],
        }
    }

    /// Returns the index of the normal (X is 0).
    pub const fn normal(self) -> usize {
        match self {
            Plane::Xy => 2,
            Plane::Zx => 1,
            Plane::Yz => 0,
        }
    }

    /// Returns the letters of a centre in the plane.
    pub(super) const fn centre_letters(self) -> &'static str {
        match self {
            Plane::Xy => "I and J",
            Plane::Zx => "I and K",
            Plane::Yz => "J and K",
        }
    }
}

/// The word that a block with axis words obeys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    Rapid,
    Feed,
    Arc {
        clockwise: bool,
    },
    /// A canned cycle, by its number.
    Cycle(u32),
}

/// Meaning of F.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FeedMode {
    PerMinute,
    /// G93: every block with a feed has its own F.
    InverseTime,
    PerRevolution,
}

/// Modal settings.
#[derive(Clone, Copy, Debug)]
pub(super) struct Modal {
    /// `None` at the start and after G80.
    pub(super) motion: Option<Motion>,
    pub(super) plane: Plane,
    pub(super) unit: Unit,
    /// G91.
    pub(super) incremental: bool,
    /// G90.1.
    pub(super) absolute_centres: bool,
    pub(super) feed_mode: FeedMode,
    pub(super) feed: Option<f64>,
    /// G99: canned cycles end in the plane R.
    pub(super) retract_to_r: bool,
}

impl Modal {
    pub(super) fn new(unit: Unit) -> Modal {
        Modal {
            motion: None,
            plane: Plane::Xy,
            unit,
            incremental: false,
            absolute_centres: false,
            feed_mode: FeedMode::PerMinute,
            feed: None,
            retract_to_r: false,
        }
    }

    /// Converts a length of the program to millimetres.
    pub(super) fn millimetres(&self, length: f64) -> f64 {
        length * self.unit.millimetres()
    }
}
