//! Reports of a certificate: errors and warnings that are proved, and a warning of proofs that stay open.

use super::{Border, Bounds, Certificate};
use crate::look::deep_on_the_surface;
use crate::model::{DirectionSource, Model, Region};
use crate::plan::PlannedTool;
use crate::report::{Report, figure};
use crate::source::Span;
use std::f64::consts::PI;

impl Certificate {
    /// Returns all reports: errors with a counterexample, warnings with a point or a box.
    pub fn reports(&self, tool: &PlannedTool) -> Vec<Report> {
        let mut reports = self.certain(tool);
        reports.extend(self.undecided(tool));
        reports
    }

    /// Returns the reports of single points, which more boxes would not change.
    pub(super) fn certain(&self, tool: &PlannedTool) -> Vec<Report> {
        let model = &tool.model;
        let mut reports: Vec<Report> = Vec::new();
        // One report for each pair, and one for each region beside the outside.
        for report in self.borders.iter().filter_map(|border| jump(model, border)) {
            let same = |other: &Report| other.span == report.span && other.second == report.second;
            if !reports.iter().any(same) {
                reports.push(report);
            }
        }
        let facts = || model.regions.iter().zip(&self.regions);
        let oblique = facts()
            .filter(|(region, _)| region.source != DirectionSource::Oblique)
            .filter_map(|(region, facts)| Some((region.course.1, (region, facts.oblique?))));
        for (region, (angle, point)) in worst(oblique) {
            reports.push(oblique_direction(region, angle, &model.shown(point)));
        }
        let rises = facts()
            .filter(|(region, _)| !region.rising)
            .filter_map(|(region, facts)| Some((region.said.niceness, (region, facts.rises?))));
        for (region, (rate, point)) in worst(rises) {
            let place = model.shown(point);
            let (name, rate, unit) = (&region.name, figure(rate), model.unit.word());
            let message =
                format!("`niceness` of {name} rises with depth at {place}, by {rate} per {unit}");
            reports.push(Report::warning(region.said.niceness, message).help(
                "a deeper contact is seldom a better one: turn a sign, or write `allow rising` \
                 behind it if it is meant",
            ));
        }
        reports
    }

    /// Returns the reports of proofs that stay open, and might not in more boxes.
    fn undecided(&self, tool: &PlannedTool) -> Vec<Report> {
        let model = &tool.model;
        let mut reports = Vec::new();
        if model.is_exact() && self.is_continuous() && !self.is_exact() {
            let message =
                "the depth of this profile is not shown to be the distance to its surface";
            reports.push(Report::warning(model.name_span, message).help(
                "a profile's depth is that distance: this is a mistake of the compiler, and worth a report of it",
            ));
        }
        if let Some(first) = self.undecided.first() {
            let more = match self.undecided.len() - 1 {
                0 => String::new(),
                more => format!(", and {more} more like it"),
            };
            reports.push(
                Report::warning(
                    model.name_span,
                    format!(
                        "not decided: {} near {}{more}",
                        first.what,
                        model.shown(first.cell.middle())
                    ),
                )
                .help(match Bounds::of(tool).0.lipschitz {
                    _ if model.is_exact() => "a profile's depth is the distance to its surface by construction, which \
                                              is not proved for this tool"
                        .to_owned(),
                    Some(most) => format!(
                        "that depth is at most {} times the distance to the surface was proved while \
                         the tool was compiled, and stands",
                        figure(most)
                    ),
                    None => "bounds of depth by the distance are then not available".to_owned(),
                }),
            );
        }
        reports
    }
}

/// A border on which a point was found where depth jumps.
fn jump(model: &Model, border: &Border) -> Option<Report> {
    let (point, [own, other]) = border.seen?;
    let (region, beside) = border.between;
    let region = &model.regions[region];
    let place = model.shown(point);
    Some(match beside.map(|beside| &model.regions[beside]) {
        None => deep_on_the_surface(region, own, &place),
        Some(beside) => Report::error(
            region.said.depth,
            format!(
                "depth jumps from {} to {} at {place}, between {} and {}",
                figure(own),
                figure(other),
                region.name,
                beside.name
            ),
        )
        .and(beside.said.depth, "here")
        .help(
            "two regions have the same depth where they meet; what is felt may jump: write it \
             as `magnitude:` beside a `depth:` that does not",
        ),
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
fn oblique_direction(region: &Region, angle: f64, place: &str) -> Report {
    let name = &region.name;
    let message = match angle {
        // An angle is known to a few units of the last place.
        _ if angle > PI - 1e-6 => {
            format!("the direction of {name} leads straight inward at {place}")
        }
        _ => format!(
            "the direction of {name} is {}° from the steepest way out of its depth at {place}",
            figure(angle.to_degrees())
        ),
    };
    Report::warning(region.course.1, message).help(match region.source {
        DirectionSource::Derived => {
            "the direction follows from the depth here: this is a mistake of the compiler, and worth \
             a report of it"
        }
        _ => {
            "write the direction in which the depth falls fastest, or `direction: … allow oblique;` \
             if it is meant"
        }
    })
}
