//! Diagnostics of a certificate: errors and warnings that are proved, and a warning for proofs that did not
//! finish.

use super::{Border, Bounds, Certificate};
use crate::diagnostic::{CheckKind, Diagnostic, FormattedNumber};
use crate::lint::deep_on_surface;
use crate::model::{DirectionSource, Model, Region};
use crate::plan::PlannedTool;
use crate::source::Span;
use std::f64::consts::PI;

impl Certificate {
    /// Returns all diagnostics: errors with a counterexample, warnings with a point or a box.
    pub fn diagnostics(&self, tool: &PlannedTool) -> Vec<Diagnostic> {
        let mut diagnostics = self.certain_diagnostics(tool);
        diagnostics.extend(self.undecided_diagnostics(tool));
        diagnostics
    }

    /// Returns the diagnostics that rest on single points, which more boxes would not change.
    pub(super) fn certain_diagnostics(&self, tool: &PlannedTool) -> Vec<Diagnostic> {
        let model = &tool.model;
        let mut diagnostics: Vec<Diagnostic> = Vec::new();
        // One diagnostic per pair of regions, and one per region next to the outside.
        for diagnostic in self.borders.iter().filter_map(|border| jump(model, border)) {
            let same = |other: &Diagnostic| {
                other.span == diagnostic.span && other.secondary == diagnostic.secondary
            };
            if !diagnostics.iter().any(same) {
                diagnostics.push(diagnostic);
            }
        }
        let facts = || model.regions.iter().zip(&self.regions);
        let oblique =
            facts().filter(|(region, _)| region.source != DirectionSource::Oblique).filter_map(
                |(region, facts)| Some((region.raw_direction.1, (region, facts.oblique_witness?))),
            );
        for (region, (angle, point)) in largest_by_span(oblique) {
            diagnostics.push(oblique_direction(region, angle, model.format_point(point)));
        }
        let rises =
            facts().filter(|(region, _)| !region.allow_rising).filter_map(|(region, facts)| {
                Some((region.law_spans.niceness, (region, facts.rising_witness?)))
            });
        for (region, (rate, point)) in largest_by_span(rises) {
            let kind = CheckKind::RisingNiceness {
                region: region.name.clone(),
                location: model.format_point(point),
                rate: FormattedNumber(rate),
                unit: model.unit.symbol(),
            };
            diagnostics.push(Diagnostic::new(region.law_spans.niceness, kind));
        }
        diagnostics
    }

    /// Returns the diagnostics of proofs that did not finish; more boxes might finish them.
    fn undecided_diagnostics(&self, tool: &PlannedTool) -> Vec<Diagnostic> {
        let model = &tool.model;
        let mut diagnostics = Vec::new();
        if let Some(open_proof) = self.undecided.first() {
            let kind = CheckKind::Undecided {
                statement: open_proof.statement.clone(),
                location: model.format_point(open_proof.cell.middle()),
                more: self.undecided.len() - 1,
                exact: model.is_exact(),
                factor: Bounds::of(tool).0.lipschitz.map(FormattedNumber),
            };
            diagnostics.push(Diagnostic::new(model.name_span, kind));
        } else if model.is_exact() && self.is_continuous() && !self.is_exact() {
            // Every proof is finished, and yet the depth is not proved to be the distance.
            diagnostics.push(Diagnostic::new(model.name_span, CheckKind::DepthNotProvedExact));
        }
        diagnostics
    }
}

/// Returns the error for a border with a point where depth jumps.
fn jump(model: &Model, border: &Border) -> Option<Diagnostic> {
    let (point, [own, other]) = border.jump_point?;
    let (region, neighbour) = border.sides;
    let region = &model.regions[region];
    let location = model.format_point(point);
    Some(match neighbour.map(|neighbour| &model.regions[neighbour]) {
        None => deep_on_surface(region, own, location),
        Some(neighbour) => {
            let kind = CheckKind::DiscontinuousDepth {
                depth: FormattedNumber(own),
                other_depth: FormattedNumber(other),
                location,
                region: region.name.clone(),
                other_region: neighbour.name.clone(),
            };
            Diagnostic::new(region.law_spans.depth, kind)
                .with_label(neighbour.law_spans.depth, "other depth")
        }
    })
}

/// A value at a point of a region.
type Fact<'t> = (&'t Region, (f64, [f64; 3]));

/// Returns the largest fact at each location of the text, since several regions may share a law or come from
/// one region.
fn largest_by_span<'t>(
    facts: impl Iterator<Item = (Span, Fact<'t>)>,
) -> impl Iterator<Item = Fact<'t>> {
    let mut largest: Vec<(Span, Fact<'t>)> = Vec::new();
    for (span, fact) in facts {
        match largest.iter_mut().find(|(known, _)| *known == span) {
            Some((_, known)) if known.1.0 >= fact.1.0 => {}
            Some((_, known)) => *known = fact,
            None => largest.push((span, fact)),
        }
    }
    largest.into_iter().map(|(_, fact)| fact)
}

/// Returns the warning for a direction that is certainly not that of steepest descent.
fn oblique_direction(region: &Region, angle: f64, location: String) -> Diagnostic {
    let kind = CheckKind::ObliqueDirection {
        region: region.name.clone(),
        degrees: FormattedNumber(angle.to_degrees()),
        // The tolerance covers the rounding of the angle, a few units in the last place.
        inward: angle > PI - 1e-6,
        derived: region.source == DirectionSource::Derived,
        location,
    };
    Diagnostic::new(region.raw_direction.1, kind)
}
