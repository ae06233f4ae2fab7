//! The regions of a profile: derived, named, and given their laws.

use super::condition::Curves;
use super::lower::Lowering;
use super::region::{Felt, Laws, Said};
use crate::domain::Domain;
use crate::expr::Graph;
use crate::formula::Formula;
use crate::model::{Outside, Region, Section, Surface};
use crate::regionalise::outline::Segment;
use crate::regionalise::{self, Derived, Feature, Partition, Test, Undivided};
use crate::report::Report;
use crate::source::Span;

/// What a profile makes of a tool.
#[derive(Default)]
pub(super) struct FromProfile {
    pub(super) surfaces: Vec<Surface>,
    pub(super) regions: Vec<Region>,
    pub(super) section: Option<Section>,
}

/// The regions of an outline, derived, and its surfaces.
pub(super) fn derived(
    (outline, surfaces, span): (Vec<Segment>, Vec<Surface>, Span),
    laws: &Laws<'_>,
    lowering: &mut Lowering,
    curves: &mut Curves,
    reports: &mut Vec<Report>,
) -> FromProfile {
    laws.check(&surfaces, reports);
    let reversed: Vec<Segment> = outline.iter().rev().map(Segment::reversed).collect();
    let inner = Partition::new(outline.clone(), false);
    let outer = Partition::new(reversed, true);
    let graph = &mut lowering.graph;
    let parts = inner.parts(graph).and_then(|parts| Ok((parts, outer.parts(graph)?)));
    let (parts, beside) = match parts {
        Ok(both) => both,
        Err(Undivided([d, z])) => {
            let z = lowering.frame.to_file(z);
            let report = Report::error(
                span,
                format!(
                    "the section could not be divided by nearest features near ({d:.4}, {z:.4})"
                ),
            );
            reports.push(report.help("write this tool's regions by hand, as in docs/language.md"));
            return FromProfile::default();
        }
    };
    let names = names(&outline, &surfaces, &parts);
    let mut regions = Vec::new();
    for (part, (name, owner, span)) in parts.iter().zip(names) {
        let felt = Felt { laws, lowering, surface: &surfaces[owner] };
        match felt.derived(part, &outline, (name, owner, span), curves) {
            Ok(region) => regions.push(region),
            Err(report) => reports.push(report),
        }
    }
    let outside = beside
        .iter()
        .map(|part| Outside {
            beside: formula(&part.inside, curves, &mut lowering.graph),
            clearance: part.depth,
        })
        .collect();
    let section = Section { outline, inner, outer, outside };
    FromProfile { surfaces, regions, section: Some(section) }
}

/// A test as a formula over curves.
fn formula(test: &Test, curves: &mut Curves, graph: &mut Graph) -> Formula {
    let zero = graph.int(0);
    match test {
        Test::AtMost(value) => curves.at_most(graph, *value, zero),
        Test::All(all) => Formula::All(all.iter().map(|t| formula(t, curves, graph)).collect()),
        Test::Any(any) => Formula::Any(any.iter().map(|t| formula(t, curves, graph)).collect()),
    }
}

/// The name, surface and place of each derived region: `nut.2` for the second piece of a surface
/// of several, `shank/nut.1` for the fan of a reflex corner, which belongs to the neighbour that
/// does not cut, else to the first.
fn names(
    outline: &[Segment],
    surfaces: &[Surface],
    parts: &[Derived],
) -> Vec<(String, usize, Span)> {
    let name = |piece: usize| {
        let surface = outline[piece].surface;
        let of_surface = |other: &&Segment| other.surface == surface;
        let all = outline.iter().filter(of_surface).count();
        let before = outline[..=piece].iter().filter(of_surface).count();
        let word = &surfaces[surface].name;
        if all > 1 { format!("{word}.{before}") } else { word.clone() }
    };
    let mut fans = std::collections::BTreeMap::new();
    parts
        .iter()
        .map(|part| match part.feature {
            Feature::Piece(piece) => (name(piece), outline[piece].surface, outline[piece].span),
            Feature::Corner(behind) => {
                let first = behind.unwrap_or(0);
                let second = behind.map_or(0, |piece| (piece + 1).min(outline.len() - 1));
                let [a, b] = [first, second].map(|piece| outline[piece].surface);
                let owner = if surfaces[a].cutting && !surfaces[b].cutting { b } else { a };
                let pair = format!("{}/{}", surfaces[a].name, surfaces[b].name);
                let count: &mut usize = fans.entry(pair.clone()).or_default();
                *count += 1;
                (format!("{pair}.{count}"), owner, outline[second].span)
            }
        })
        .collect()
}

impl Felt<'_> {
    /// A region that was derived.
    fn derived(
        mut self,
        part: &Derived,
        outline: &[Segment],
        (name, owner, span): (String, usize, Span),
        curves: &mut Curves,
    ) -> Result<Region, Report> {
        let graph = &mut self.lowering.graph;
        let zero = graph.int(0);
        let inside = formula(&part.inside, curves, graph);
        let course = regionalise::course(graph, outline, part.feature).unwrap_or([zero, zero]);
        let course = Domain::HalfPlane.vector(graph, &course);
        let depth = part.depth;
        let magnitude = self.magnitude(None, depth)?;
        let niceness = self.niceness(None, depth)?;
        let felt = (depth, magnitude, niceness);
        self.finish(Said { name, span, owner, inside, depth_span: span }, felt, (course, span))
    }
}
