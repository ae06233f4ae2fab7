//! The names of a file, and the transform from the tool's coordinates to the file's.

use super::definitions;
use super::lower::{Allowed, Lowering};
use crate::diagnostic::{Diagnostic, ValueKind};
use crate::dimension::Dimension;
use crate::domain::Domain;
use crate::expr::{Coord, Graph, Id};
use crate::model::{Frame, Unit};
use crate::number::Number;
use crate::source::Span;
use crate::syntax::tree::{Definition, Tool};
use std::collections::{BTreeMap, BTreeSet};

impl Lowering {
    /// Returns the state for a text without names.
    pub(super) fn new(domain: Domain, unit: Unit) -> Lowering {
        Lowering {
            domain,
            graph: Graph::default(),
            unit,
            frame: Frame {
                tip: Number::int(0),
                spindle_down: false,
                tip_span: Span { start: 0, end: 0 },
            },
            scale: Number::int(1),
            values: BTreeMap::new(),
            declared: BTreeMap::new(),
            broken: BTreeMap::new(),
            parametric: BTreeSet::new(),
            left_out: BTreeSet::new(),
        }
    }

    /// Returns the state for a tool of which nothing is lowered yet.
    pub(super) fn of(tool: &Tool, unit: Unit) -> Lowering {
        let declared = definitions(tool, |_| true)
            .map(|definition| (definition.name.text.clone(), definition.name.span))
            .collect();
        let mut lowering = Lowering { declared, ..Lowering::new(tool.domain, unit) };
        lowering.frame.tip_span = tool.name.span;
        lowering
    }

    /// Runs `work` on a graph that is shared with other files.
    pub(super) fn on<T>(&mut self, graph: &mut Graph, work: impl FnOnce(&mut Lowering) -> T) -> T {
        std::mem::swap(graph, &mut self.graph);
        let done = work(self);
        std::mem::swap(graph, &mut self.graph);
        done
    }

    /// Moves the file's tool: its lengths are multiplied by `scale`, then its tip is moved along the axis by `by`.
    pub(super) fn transform(&mut self, scale: &Number, by: &Number) {
        self.scale = &self.scale / scale;
        let by = &self.scale * by;
        self.frame.tip =
            if self.frame.spindle_down { &self.frame.tip + &by } else { &self.frame.tip - &by };
    }

    /// Converts a length of the tool to the file's unit.
    pub(super) fn length_here(&mut self, length: Id) -> Id {
        if self.scale == Number::int(1) {
            return length;
        }
        let scale = self.graph.number(self.scale.clone());
        self.graph.mul(scale, length)
    }

    /// Converts a coordinate of the tool to the file's unit and frame.
    pub(super) fn coordinate_here(&mut self, coordinate: Coord) -> Id {
        let id = self.graph.coord(coordinate);
        let id = self.length_here(id);
        if coordinate == Coord::Z { self.frame.file_z(&mut self.graph, id) } else { id }
    }

    /// Defines a curve, a function of the coordinates, or reports its error.
    pub(super) fn curve(&mut self, definition: &Definition, diagnostics: &mut Vec<Diagnostic>) {
        if !self.broken.contains_key(&definition.name.text) {
            let defined = self.curve_value(definition);
            self.report(&definition.name, defined, diagnostics);
        }
    }

    fn curve_value(&mut self, definition: &Definition) -> Result<(), Diagnostic> {
        let value = self.lower(&definition.value, Allowed::Coordinates)?;
        if value.1 == Dimension::Angle {
            let diagnostic = Diagnostic::new(definition.value.span, ValueKind::CurveOfAngle);
            return Err(diagnostic);
        }
        self.define(&definition.name, value)
    }
}
