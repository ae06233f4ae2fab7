//! Reports of a certificate: errors and warnings that are proved, and a warning of proofs that stay open.

use super::{Border, Bounds, Certificate};
use crate::diagnostic::{CheckKind, Diagnostic, Figure};
use crate::look::deep_on_the_surface;
use crate::model::{DirectionSource, Model, Region};
use crate::plan::PlannedTool;
use crate::source::Span;
use std::f64::consts::PI;

impl Certificate {
    /// Returns all diagnostics: errors with a counterexample, warnings with a point or a box.
    pub fn diagnostics(&self, tool: &PlannedTool) -> Vec<Diagnostic> {
        let mut diagnostics = self.certain(tool);
        diagnostics.extend(self.undecided(tool));
        diagnostics
    }

    /// Returns the diagnostics of single points, which more boxes would not change.
    pub(super) fn certain(&self, tool: &PlannedTool) -> Vec<Diagnostic> {
        let model = &tool.model;
        let mut diagnostics: Vec<Diagnostic> = Vec::new();
        // One diagnostic for each pair, and one for each region beside the outside.
        for diagnostic in self.borders.iter().filter_map(|border| jump(model, border)) {
            let same = |other: &Diagnostic| {
                other.span == diagnostic.span && other.second == diagnostic.second
            };
            if !diagnostics.iter().any(same) {
                diagnostics.push(diagnostic);
            }
        }
        let facts = || model.regions.iter().zip(&self.regions);
        let oblique = facts()
            .filter(|(region, _)| region.source != DirectionSource::Oblique)
            .filter_map(|(region, facts)| Some((region.course.1, (region, facts.oblique?))));
        for (region, (angle, point)) in worst(oblique) {
            diagnostics.push(oblique_direction(region, angle, model.shown(point)));
        }
        let rises = facts()
            .filter(|(region, _)| !region.rising)
            .filter_map(|(region, facts)| Some((region.said.niceness, (region, facts.rises?))));
        for (region, (rate, point)) in worst(rises) {
            let kind = CheckKind::NicenessRises {
                region: region.name.clone(),
                place: model.shown(point),
                rate: Figure(rate),
                unit: model.unit.word(),
            };
            diagnostics.push(Diagnostic::new(region.said.niceness, kind));
        }
        diagnostics
    }

    /// Returns the diagnostics of proofs that stay open, and might not in more boxes.
    fn undecided(&self, tool: &PlannedTool) -> Vec<Diagnostic> {
        let model = &tool.model;
        let mut diagnostics = Vec::new();
        if model.is_exact() && self.is_continuous() && !self.is_exact() {
            diagnostics.push(Diagnostic::new(model.name_span, CheckKind::NotShownExact));
        }
        if let Some(first) = self.undecided.first() {
            let kind = CheckKind::Undecided {
                statement: first.statement.clone(),
                place: model.shown(first.cell.middle()),
                more: self.undecided.len() - 1,
                exact: model.is_exact(),
                bound: Bounds::of(tool).0.lipschitz.map(Figure),
            };
            diagnostics.push(Diagnostic::new(model.name_span, kind));
        }
        diagnostics
    }
}

/// A border on which a point was found where depth jumps.
fn jump(model: &Model, border: &Border) -> Option<Diagnostic> {
    let (point, [own, other]) = border.seen?;
    let (region, beside) = border.between;
    let region = &model.regions[region];
    let place = model.shown(point);
    Some(match beside.map(|beside| &model.regions[beside]) {
        None => deep_on_the_surface(region, own, place),
        Some(beside) => {
            let kind = CheckKind::DepthJumps {
                own: Figure(own),
                other: Figure(other),
                place,
                region: region.name.clone(),
                beside: beside.name.clone(),
            };
            Diagnostic::new(region.said.depth, kind).and(beside.said.depth, "here")
        }
    })
}

/// A value at a point of a region.
type Fact<'t> = (&'t Region, (f64, [f64; 3]));

/// The largest of the facts at each place of the text: several regions may share a law, or be parts of one.
fn worst<'t>(facts: impl Iterator<Item = (Span, Fact<'t>)>) -> impl Iterator<Item = Fact<'t>> {
    let mut kept: Vec<(Span, Fact<'t>)> = Vec::new();
    for (span, fact) in facts {
        match kept.iter_mut().find(|(known, _)| *known == span) {
            Some((_, known)) if known.1.0 >= fact.1.0 => {}
            Some((_, known)) => *known = fact,
            None => kept.push((span, fact)),
        }
    }
    kept.into_iter().map(|(_, fact)| fact)
}

/// A direction that is certainly not the steepest way out.
fn oblique_direction(region: &Region, angle: f64, place: String) -> Diagnostic {
    let kind = CheckKind::ObliqueDirection {
        region: region.name.clone(),
        degrees: Figure(angle.to_degrees()),
        // An angle is known to a few units of the last place.
        inward: angle > PI - 1e-6,
        derived: region.source == DirectionSource::Derived,
        place,
    };
    Diagnostic::new(region.course.1, kind)
}
