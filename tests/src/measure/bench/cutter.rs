//! Tools as the measurement holds them: of some the types are known, which `f32` wants.

use super::methods::{Felt, Precision};
use crate::race::contender::Contender;
use tools_library::{Fig73, Fig73Exact, UnitSphere};
use touchoff::precision::{Double, Single};
use touchoff::tool::Senses;
use touchoff::{Part, Probe, Tool};

/// A tool, by its type where that is known.
#[derive(Clone, Copy)]
pub(super) enum Cutter<'t> {
    /// The thesis's tool, true depths.
    Fig73Exact,
    /// A ball of radius 1.
    UnitSphere,
    /// Any other.
    Any(&'t dyn Tool),
}

impl<'t> Cutter<'t> {
    /// The thesis's tool with its own magnitudes.
    #[cfg(feature = "peers")]
    pub(super) const THESIS: Cutter<'static> = Cutter::Any(&Fig73);

    /// Of a tool of the library, by its name, or of any other.
    pub(super) fn of(tool: &'t dyn Tool, compiled: bool) -> Cutter<'t> {
        match &*tool.card().name {
            "Fig73Exact" if compiled => Cutter::Fig73Exact,
            "UnitSphere" if compiled => Cutter::UnitSphere,
            _ => Cutter::Any(tool),
        }
    }

    /// The same solid with a profile, so that its distance is known.
    pub(super) fn near(self) -> &'t dyn Tool {
        if self.is_the_thesis() { &Fig73Exact } else { self.tool() }
    }

    /// The tool itself.
    pub(super) fn tool(self) -> &'t dyn Tool {
        match self {
            Cutter::Fig73Exact => &Fig73Exact,
            Cutter::UnitSphere => &UnitSphere,
            Cutter::Any(tool) => tool,
        }
    }

    fn is_the_thesis(self) -> bool {
        self.tool().card() == Fig73.card()
    }

    /// Whether the peers, who know only the formula of fig. 7.3, know this solid.
    pub(super) fn peers_know_it(self) -> bool {
        matches!(self, Cutter::Fig73Exact) || self.is_the_thesis()
    }

    /// A probe at a precision; `None` where the tool cannot be asked in it.
    pub(super) fn probe<'p>(
        self,
        part: &'p Part,
        precision: Precision,
    ) -> Option<Box<dyn Contender + 'p>>
    where
        't: 'p,
    {
        let probe = Probe::new(part, self.tool());
        match (precision, self) {
            (Precision::Double, _) => Some(Box::new(Felt(probe.precision::<Double>()))),
            (Precision::Filtered, _) => Some(Box::new(Felt(probe))),
            (Precision::Single, Cutter::Fig73Exact) => Some(single(part, &Fig73Exact)),
            (Precision::Single, Cutter::UnitSphere) => Some(single(part, &UnitSphere)),
            (Precision::Single, Cutter::Any(_)) => None,
        }
    }
}

/// A probe in `f32`.
fn single<'p, T: Senses + Senses<f32>>(part: &'p Part, tool: &'p T) -> Box<dyn Contender + 'p> {
    Box::new(Felt(Probe::new(part, tool).precision::<Single>()))
}
