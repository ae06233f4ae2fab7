//! Tools as the measurement holds them: where their types are known, probes are of those types.

use super::methods::{Felt, Precision};
use crate::race::contender::Contender;
use tools_library::{D2Ball, Fig73, Fig73Exact, UnitSphere};
use touchoff::{Part, Probe, Tool};

/// A tool, by its type where that is known.
#[derive(Clone, Copy)]
pub(super) enum Cutter<'t> {
    /// The thesis's tool, its magnitudes.
    Fig73,
    /// The thesis's tool, true depths.
    Fig73Exact,
    /// A ball of radius 1.
    UnitSphere,
    /// A ball cutter of 2 mm.
    D2Ball,
    /// Any other.
    Any(&'t dyn Tool),
}

impl<'t> Cutter<'t> {
    /// Of a tool of the library, by its name, or of any other.
    pub(super) fn of(tool: &'t dyn Tool, compiled: bool) -> Cutter<'t> {
        match &*tool.card().name {
            "Fig73" if compiled => Cutter::Fig73,
            "Fig73Exact" if compiled => Cutter::Fig73Exact,
            "UnitSphere" if compiled => Cutter::UnitSphere,
            "D2Ball" if compiled => Cutter::D2Ball,
            _ => Cutter::Any(tool),
        }
    }

    /// The same solid with a profile, so that its distance is known.
    pub(super) fn near(self) -> &'t dyn Tool {
        match self {
            Cutter::Fig73 => &Fig73Exact,
            other => other.tool(),
        }
    }

    /// The tool itself.
    pub(super) fn tool(self) -> &'t dyn Tool {
        match self {
            Cutter::Fig73 => &Fig73,
            Cutter::Fig73Exact => &Fig73Exact,
            Cutter::UnitSphere => &UnitSphere,
            Cutter::D2Ball => &D2Ball,
            Cutter::Any(tool) => tool,
        }
    }

    /// Whether the peers, who know only the formula of fig. 7.3, know this solid.
    pub(super) fn peers_know_it(self) -> bool {
        matches!(self, Cutter::Fig73 | Cutter::Fig73Exact)
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
        match self {
            Cutter::Fig73 => Felt::known(Probe::new(part, &Fig73), precision),
            Cutter::Fig73Exact => Felt::known(Probe::new(part, &Fig73Exact), precision),
            Cutter::UnitSphere => Felt::known(Probe::new(part, &UnitSphere), precision),
            Cutter::D2Ball => Felt::known(Probe::new(part, &D2Ball), precision),
            Cutter::Any(tool) => Felt::any(Probe::new(part, tool), precision),
        }
    }
}
