//! Tools as the measurement holds them: of some the types are known, which `f32` wants.

use super::methods::{Felt, Precision};
use crate::race::contender::Contender;
use tools_library::{D2Ball, Fig73, Fig73Exact, UnitSphere};
use touchoff::precision::{Double, Single};
use touchoff::tool::Senses;
use touchoff::{Part, Probe, Tool};

/// How a part is asked in `f32`.
type InSingle = for<'p> fn(&'p Part) -> Box<dyn Contender + 'p>;

/// A tool, and how to ask in `f32` if its type is known.
#[derive(Clone, Copy)]
pub(super) struct Cutter<'t> {
    tool: &'t dyn Tool,
    in_single: Option<InSingle>,
}

/// Those of the library that are measured in `f32`.
const BY_TYPE: [Cutter<'static>; 3] = [Cutter::FIG_73_EXACT, Cutter::UNIT_SPHERE, Cutter::D2_BALL];

impl<'t> Cutter<'t> {
    /// The thesis's tool, true depths.
    pub(super) const FIG_73_EXACT: Cutter<'static> =
        Cutter { tool: &Fig73Exact, in_single: Some(|part| single(part, &Fig73Exact)) };
    /// A ball of radius 1.
    pub(super) const UNIT_SPHERE: Cutter<'static> =
        Cutter { tool: &UnitSphere, in_single: Some(|part| single(part, &UnitSphere)) };
    const D2_BALL: Cutter<'static> =
        Cutter { tool: &D2Ball, in_single: Some(|part| single(part, &D2Ball)) };
    /// The thesis's tool with its own magnitudes.
    #[cfg(feature = "peers")]
    pub(super) const THESIS: Cutter<'static> = Cutter { tool: &Fig73, in_single: None };

    /// Of a tool of the library, or of any other.
    pub(super) fn of(tool: &'t dyn Tool, compiled: bool) -> Cutter<'t> {
        let known = BY_TYPE.into_iter().find(|known| known.tool.card() == tool.card());
        known.filter(|_| compiled).unwrap_or(Cutter { tool, in_single: None })
    }

    /// The same solid with a profile, so that its distance is known.
    pub(super) fn near(self) -> &'t dyn Tool {
        if self.is_the_thesis() { &Fig73Exact } else { self.tool }
    }

    /// The tool itself.
    pub(super) fn tool(self) -> &'t dyn Tool {
        self.tool
    }

    fn is_the_thesis(self) -> bool {
        self.tool.card() == Fig73.card()
    }

    /// Whether the peers, who know only the formula of fig. 7.3, know this solid.
    pub(super) fn peers_know_it(self) -> bool {
        self.tool.card() == Fig73Exact.card() || self.is_the_thesis()
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
        let probe = Probe::new(part, self.tool);
        match precision {
            Precision::Double => Some(Box::new(Felt(probe.precision::<Double>()))),
            Precision::Filtered => Some(Box::new(Felt(probe))),
            Precision::Single => self.in_single.map(|in_single| in_single(part)),
        }
    }
}

/// A probe in `f32`.
fn single<'p, T: Senses + Senses<f32>>(part: &'p Part, tool: &'p T) -> Box<dyn Contender + 'p> {
    Box::new(Felt(Probe::new(part, tool).precision::<Single>()))
}
