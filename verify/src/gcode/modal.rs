//! Modal settings that a motion depends on and that are no part of [`ControlState`](super::ControlState).

use crate::machine::Plane;
use touchoff::Unit;

/// Returns the letters of a centre in a plane.
pub(super) const fn centre_letters(plane: Plane) -> &'static str {
    match plane {
        Plane::Xy => "I and J",
        Plane::Zx => "I and K",
        Plane::Yz => "J and K",
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
    /// Set by G20 and G21.
    pub(super) unit_stated: bool,
    /// G91.
    pub(super) incremental: bool,
    /// G90.1 or G91.1; `None` before either.
    pub(super) absolute_centres: Option<bool>,
    pub(super) feed_mode: FeedMode,
    pub(super) feed: Option<f64>,
    /// Set where the path goes through the corners (G61).
    pub(super) exact_path: bool,
    /// G99: canned cycles end in the plane R; `None` before G98 or G99.
    pub(super) retract_to_r: Option<bool>,
}

impl Modal {
    pub(super) fn new() -> Modal {
        Modal {
            motion: None,
            plane: Plane::Xy,
            unit: Unit::Millimetre,
            unit_stated: false,
            incremental: false,
            absolute_centres: None,
            feed_mode: FeedMode::PerMinute,
            feed: None,
            exact_path: false,
            retract_to_r: None,
        }
    }

    /// Returns whether axis words move at feed rate, at last.
    pub(super) fn is_feed(&self) -> bool {
        !matches!(self.motion, None | Some(Motion::Rapid))
    }

    /// Returns the least increment of a length, in the unit of the program.
    pub(super) fn increment(&self) -> f64 {
        if self.unit == Unit::Inch { 1e-4 } else { 1e-3 }
    }

    /// Converts a length of the program to millimetres.
    pub(super) fn millimetres(&self, length: f64) -> f64 {
        length * self.unit.millimetres()
    }
}
