//! Tools as the measurement holds them.

use tools_library::{Fig73, Fig73Exact, UnitSphere};
use touchoff::Tool;

/// A tool, and what is known of it.
#[derive(Clone, Copy)]
pub(super) struct Cutter<'t>(pub(super) &'t dyn Tool);

impl<'t> Cutter<'t> {
    /// The thesis's tool, true depths.
    pub(super) const FIG_73_EXACT: Cutter<'static> = Cutter(&Fig73Exact);
    /// A ball of radius 1.
    pub(super) const UNIT_SPHERE: Cutter<'static> = Cutter(&UnitSphere);
    /// The thesis's tool with its own magnitudes.
    #[cfg(feature = "peers")]
    pub(super) const THESIS: Cutter<'static> = Cutter(&Fig73);

    /// The same solid with a profile, so that its distance is known.
    pub(super) fn near(self) -> &'t dyn Tool {
        if self.is_the_thesis() { &Fig73Exact } else { self.0 }
    }

    /// The tool itself.
    pub(super) fn tool(self) -> &'t dyn Tool {
        self.0
    }

    fn is_the_thesis(self) -> bool {
        self.0.card() == Fig73.card()
    }

    /// Whether the peers, who know only the formula of fig. 7.3, know this solid.
    pub(super) fn peers_know_it(self) -> bool {
        self.0.card() == Fig73Exact.card() || self.is_the_thesis()
    }
}
