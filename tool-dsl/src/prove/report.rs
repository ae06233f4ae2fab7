//! Diagnostics that a certificate gives.

use super::certificate::{Border, CertainValue, JumpPoint};
use super::{Bounds, Certificate};
use crate::diagnostic::{CheckKind, Diagnostic, FormattedNumber, Statement};
use crate::lint::deep_on_surface;
use crate::model::{DirectionSource, Model, Region};
use crate::plan::PlannedTool;
use crate::source::Span;
use std::f64::consts::PI;

/// A bound of the rounding of an angle that is shown, a few units in the last place.
const ANGLE_ROUNDING: f64 = 1e-6;

impl Certificate {
    /// Returns all diagnostics: errors with a counterexample, warnings with a point or a box.
    pub fn diagnostics(&self, tool: &PlannedTool) -> Vec<Diagnostic> {
        let mut diagnostics = self.certain_diagnostics(tool);
        let factor = Bounds::of(tool).0.lipschitz;
        diagnostics.extend(self.undecided_diagnostics(tool, factor));
        diagnostics
    }

    /// Returns the diagnostics that rest on single points, which more boxes would not change.
    pub(super) fn certain_diagnostics(&self, tool: &PlannedTool) -> Vec<Diagnostic> {
        let model = &tool.model;
        let mut diagnostics: Vec<Diagnostic> = Vec::new();
        // One diagnostic per pair of regions, and one per region next to the outside.
        for diagnostic in self.borders.iter().filter_map(|border| jump(model, border)) {
            let is_known = diagnostics.iter().any(|other| {
                other.span == diagnostic.span && other.secondary == diagnostic.secondary
            });
            if !is_known {
                diagnostics.push(diagnostic);
            }
        }
        let facts = || model.regions.iter().zip(&self.regions);
        let oblique =
            facts().filter(|(region, _)| region.source != DirectionSource::Oblique).filter_map(
                |(region, facts)| Fact::new(region, region.raw_direction.1, facts.oblique_witness),
            );
        for Fact { region, certain, .. } in largest_by_span(oblique) {
            let location = model.format_point(certain.point);
            diagnostics.push(oblique_direction(region, certain.value, location));
        }
        let rises =
            facts().filter(|(region, _)| !region.allow_rising).filter_map(|(region, facts)| {
                Fact::new(region, region.law_spans.niceness, facts.rising_witness)
            });
        for Fact { region, span, certain } in largest_by_span(rises) {
            let kind = CheckKind::RisingNiceness {
                region: region.name.clone(),
                location: model.format_point(certain.point),
                rate: FormattedNumber(certain.value),
                unit: model.unit.symbol(),
            };
            diagnostics.push(Diagnostic::new(span, kind));
        }
        diagnostics
    }

    /// Returns the diagnostics of proofs that did not finish, which more boxes might finish, and of depths whose
    /// steepness has no bound. `factor` is the Lipschitz constant that a build proves.
    pub(super) fn undecided_diagnostics(
        &self,
        tool: &PlannedTool,
        factor: Option<f64>,
    ) -> Vec<Diagnostic> {
        let model = &tool.model;
        if model.is_exact() {
            let kind = CheckKind::DepthNotProvedExact;
            let diagnostic = (!self.is_exact()).then(|| Diagnostic::new(model.name_span, kind));
            return diagnostic.into_iter().collect();
        }
        let mut diagnostics = Vec::new();
        let mut undecided = |span, statement, location, more| {
            let (factor, location) = (factor.map(FormattedNumber), model.format_point(location));
            let kind = CheckKind::Undecided { statement, location, more, factor };
            diagnostics.push(Diagnostic::new(span, kind));
        };
        let steep = model.regions.iter().zip(&self.regions);
        let steep = steep.filter_map(|(region, facts)| Some((region, facts.steep_at?))).next();
        if let Some(open_proof) = self.undecided.first() {
            let (statement, more) = (open_proof.statement.clone(), self.undecided.len() - 1);
            undecided(model.name_span, statement, open_proof.cell.middle(), more);
        } else if let Some((region, point)) = steep {
            let statement = Statement::BoundedSteepness(region.name.clone());
            undecided(region.law_spans.depth, statement, point, 0);
        }
        diagnostics
    }
}

/// Returns the error for a border with a point where depth jumps.
fn jump(model: &Model, border: &Border) -> Option<Diagnostic> {
    let JumpPoint { point, depths: [own, other] } = border.jump_point?;
    let region = &model.regions[border.sides.own];
    let location = model.format_point(point);
    Some(match border.sides.other.map(|neighbour| &model.regions[neighbour]) {
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

/// A certain value in a region, and the text that is to blame.
struct Fact<'t> {
    region: &'t Region,
    span: Span,
    certain: CertainValue,
}

impl<'t> Fact<'t> {
    fn new(region: &'t Region, span: Span, certain: Option<CertainValue>) -> Option<Fact<'t>> {
        certain.map(|certain| Fact { region, span, certain })
    }
}

/// Returns the largest fact at each location of the text, since several regions may share a law or come from
/// one region.
fn largest_by_span<'t>(facts: impl Iterator<Item = Fact<'t>>) -> Vec<Fact<'t>> {
    let mut largest: Vec<Fact<'t>> = Vec::new();
    for fact in facts {
        match largest.iter_mut().find(|known| known.span == fact.span) {
            Some(known) if known.certain.value >= fact.certain.value => {}
            Some(known) => *known = fact,
            None => largest.push(fact),
        }
    }
    largest
}

/// Returns the warning for a direction that is certainly not that of steepest descent.
fn oblique_direction(region: &Region, angle: f64, location: String) -> Diagnostic {
    let kind = CheckKind::ObliqueDirection {
        region: region.name.clone(),
        degrees: FormattedNumber(angle.to_degrees()),
        inward: angle > PI - ANGLE_ROUNDING,
        derived: region.source == DirectionSource::Derived,
        location,
    };
    Diagnostic::new(region.raw_direction.1, kind)
}
