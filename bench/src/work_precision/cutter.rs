//! Tools of the measurements.

use touchoff::Tool;
use touchoff_tools::{Fig73, Fig73Exact, UnitSphere};

/// A tool.
#[derive(Clone, Copy)]
pub(super) struct Cutter<'t>(pub(super) &'t dyn Tool);

impl<'t> Cutter<'t> {
    /// The thesis's tool with true depths.
    pub(super) const FIG_73_EXACT: Cutter<'static> = Cutter(&Fig73Exact);
    /// A ball of radius 1.
    pub(super) const UNIT_SPHERE: Cutter<'static> = Cutter(&UnitSphere);
    /// The thesis's tool with its own magnitudes.
    #[cfg(feature = "peers")]
    pub(super) const THESIS: Cutter<'static> = Cutter(&Fig73);

    /// Returns a tool of the same solid that has a profile, so that its distance is known.
    pub(super) fn tool_with_profile(self) -> &'t dyn Tool {
        if self.has_thesis_magnitudes() { &Fig73Exact } else { self.0 }
    }

    /// Returns the tool itself.
    pub(super) fn tool(self) -> &'t dyn Tool {
        self.0
    }

    fn has_thesis_magnitudes(self) -> bool {
        self.0.info() == Fig73.info()
    }

    /// Returns whether the peers, which only have the formula of fig. 7.3, can represent this solid.
    pub(super) fn is_known_to_peers(self) -> bool {
        self.0.info() == Fig73Exact.info() || self.has_thesis_magnitudes()
    }
}
