//! The regions of a profile: derived, named, and given their laws.

use super::condition::Curves;
use super::lower::Lowering;
use super::profile;
use super::region::{Felt, Laws, Said};
use crate::domain::Domain;
use crate::expr::{Graph, Id};
use crate::formula::Formula;
use crate::model::{Region, Surface};
use crate::regionalise::outline::Segment;
use crate::regionalise::{self, Derived, Feature, Undivided};
use crate::report::Report;
use crate::source::Span;
use crate::syntax::tree;

/// The regions of a profile, derived, and the surfaces that it names.
pub(super) fn derived(
    profile: &tree::Profile,
    laws: &Laws<'_>,
    lowering: &mut Lowering,
    curves: &mut Curves,
    reports: &mut Vec<Report>,
) -> (Vec<Surface>, Vec<Region>) {
    let Some((outline, surfaces)) = profile::outline(profile, lowering, reports) else {
        return Default::default();
    };
    laws.check(&surfaces, reports);
    let parts = match regionalise::nearest(&mut lowering.graph, &outline) {
        Ok(parts) => parts,
        Err(Undivided([d, z])) => {
            let z = lowering.frame.to_file(z);
            let report = Report::error(
                profile.span,
                format!(
                    "the section could not be divided by nearest features near ({d:.4}, {z:.4})"
                ),
            );
            reports.push(report.help("write this tool's regions by hand, as in docs/language.md"));
            return Default::default();
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
    (surfaces, regions)
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
        let zero = self.lowering.graph.int(0);
        let graph = &mut self.lowering.graph;
        let bound = |sides: &Vec<Id>, curves: &mut Curves, graph: &mut Graph| {
            Formula::Any(sides.iter().map(|side| curves.at_most(graph, *side, zero)).collect())
        };
        let inside =
            Formula::All(part.conditions.iter().map(|sides| bound(sides, curves, graph)).collect());
        let course = regionalise::course(graph, outline, &part.feature).unwrap_or([zero, zero]);
        let course = Domain::HalfPlane.vector(graph, &course);
        let depth = part.depth;
        let magnitude = self.magnitude(None, depth)?;
        let niceness = self.niceness(None, depth)?;
        let felt = (depth, magnitude, niceness);
        self.finish(Said { name, span, owner, inside, depth_span: span }, felt, (course, span))
    }
}
