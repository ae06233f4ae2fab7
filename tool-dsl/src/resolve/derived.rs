//! Derives the regions of a profile, names them, and applies their laws.

use super::condition::Curves;
use super::direction::RawDirection;
use super::law::Laws;
use super::lower::Lowering;
use super::over::{Conditions, Divider};
use super::region::{LawValues, Placed, RegionHead, RegionResolver, or_report};
use crate::diagnostic::{Diagnostic, ProfileKind};
use crate::domain::Domain;
use crate::expr::{Graph, Id};
use crate::formula::Formula;
use crate::geometry::outline::{Segment, nearest_span};
use crate::model::{DirectionSource, OutsidePart, Over, Region, Section, Surface};
use crate::regionalise::overlay::ConditionedPart;
use crate::regionalise::{self, Derived, Feature, Partition, Test, Undivided};
use crate::source::Span;

/// The surfaces, regions and section that result from a profile.
#[derive(Default)]
pub(super) struct FromProfile {
    pub(super) surfaces: Vec<Surface>,
    pub(super) regions: Vec<Region>,
    pub(super) section: Option<Section>,
}

/// A part of the inside, in which one feature is nearest.
pub(super) struct DerivedPart {
    pub(super) feature: Feature,
    pub(super) inside: Formula,
    pub(super) depth: Id,
    pub(super) direction: [Id; 3],
    pub(super) name: String,
    /// Index of its surface.
    pub(super) owner: usize,
    pub(super) span: Span,
}

impl DerivedPart {
    /// Returns the shortest direction to the feature.
    pub(super) fn own_direction(&self) -> RawDirection {
        RawDirection { parts: self.direction, span: self.span, source: DirectionSource::Derived }
    }
}

/// Derives the regions of an outline.
pub(super) fn derived(
    (outline, surfaces, span): (Vec<Segment>, Vec<Surface>, Span),
    divider: &Divider<'_>,
    laws: &Laws<'_>,
    lowering: &mut Lowering,
    curves: &mut Curves,
    diagnostics: &mut Vec<Diagnostic>,
) -> FromProfile {
    laws.check(&surfaces, &lowering.left_out, diagnostics);
    if let Err(diagnostic) = divider.check_limits(&outline) {
        diagnostics.push(diagnostic);
        return FromProfile::default();
    }
    let reversed: Vec<Segment> = outline.iter().rev().map(Segment::reversed).collect();
    let inner = Partition::new(outline.clone(), false);
    let outer = Partition::new(reversed, true);
    let graph = &mut lowering.graph;
    let divided = inner.parts(graph).and_then(|parts| Ok((parts, outer.parts(graph)?)));
    let (derived, beside) = match divided {
        Ok(both) => both,
        Err(Undivided([d, z])) => {
            let at = nearest_span(&outline, [d, z]).unwrap_or(span);
            let z = lowering.frame.to_file(z);
            let diagnostic = Diagnostic::new(at, ProfileKind::DivisionFailed { d, z });
            diagnostics.push(diagnostic);
            return FromProfile::default();
        }
    };
    let parts = parts(&derived, &outline, &surfaces, lowering, curves);
    let profile = (outline.as_slice(), &inner);
    let mut regions = Vec::new();
    let before = diagnostics.len();
    let conditions = divider.conditions(profile, &surfaces, lowering, curves, diagnostics);
    let mut over = None;
    match conditions {
        None => {
            for part in &parts {
                let evaluation = RegionResolver { laws, lowering, surface: &surfaces[part.owner] };
                let (name, inside) = (part.name.clone(), part.inside.clone());
                let head = RegionHead { name, span: part.span, owner: part.owner, inside };
                let direction = part.own_direction();
                regions.extend(or_report(evaluation.of_part(part, head, direction), diagnostics));
            }
        }
        Some(conditions) if diagnostics.len() == before => {
            let whole = (outline.as_slice(), &inner, parts.as_slice());
            let divided =
                conditions.conditioned_parts(whole, (curves, lowering), span, diagnostics);
            for ConditionedPart { part, condition } in &divided {
                let (part, condition) = (&parts[*part], *condition);
                let region =
                    conditions.region(part, condition, &surfaces, laws, lowering, diagnostics);
                regions.extend(region);
            }
            let Conditions { conditions, distances, .. } = conditions;
            over = Some(Over { conditions, regions: divided, distances });
        }
        Some(_) => {}
    }
    let zero = lowering.graph.int(0);
    let outside = beside
        .iter()
        .map(|part| OutsidePart {
            condition: formula(&part.inside, curves, &mut lowering.graph),
            clearance: lowering.graph.max(zero, part.depth),
        })
        .collect();
    let section = Section { outline, inner, outer, outside, over };
    FromProfile { surfaces, regions, section: Some(section) }
}

/// Returns the parts of the inside with their names and directions.
fn parts(
    derived: &[Derived],
    outline: &[Segment],
    surfaces: &[Surface],
    lowering: &mut Lowering,
    curves: &mut Curves,
) -> Vec<DerivedPart> {
    let names = names(outline, surfaces, derived);
    let graph = &mut lowering.graph;
    let zero = graph.int(0);
    derived
        .iter()
        .zip(names)
        .map(|(part, (name, owner, span))| {
            let inside = formula(&part.inside, curves, graph);
            let direction = regionalise::direction_to_surface(graph, outline, part.feature)
                .unwrap_or([zero, zero]);
            let direction = Domain::HalfPlane.vector(graph, &direction);
            DerivedPart {
                feature: part.feature,
                inside,
                depth: part.depth,
                direction,
                name,
                owner,
                span,
            }
        })
        .collect()
}

/// Converts a test to a formula over curves.
pub(super) fn formula(test: &Test, curves: &mut Curves, graph: &mut Graph) -> Formula {
    let zero = graph.int(0);
    match test {
        Test::AtMost(value) => curves.at_most(graph, *value, zero),
        Test::All(tests) => {
            Formula::All(tests.iter().map(|test| formula(test, curves, graph)).collect())
        }
        Test::Any(tests) => {
            Formula::Any(tests.iter().map(|test| formula(test, curves, graph)).collect())
        }
        Test::Strictly(test) => match formula(test, curves, graph) {
            Formula::Atom { curve, below, .. } => Formula::Atom { curve, below, strict: true },
            // A side that always or never holds has no border.
            other => other,
        },
    }
}

/// Returns the name, surface and span of each derived region. `nut.2` is the second segment of a surface that has
/// several. `shank/nut.1` is the fan of a reflex corner, which belongs to the adjacent surface that does not cut,
/// otherwise to the first one.
fn names(
    outline: &[Segment],
    surfaces: &[Surface],
    parts: &[Derived],
) -> Vec<(String, usize, Span)> {
    let name = |piece: usize| {
        let surface = outline[piece].surface;
        let of_surface = |other: &&Segment| other.surface == surface;
        let segment_count = outline.iter().filter(of_surface).count();
        let before = outline[..=piece].iter().filter(of_surface).count();
        let word = &surfaces[surface].name;
        if segment_count > 1 { format!("{word}.{before}") } else { word.clone() }
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

impl RegionResolver<'_> {
    /// Returns the region of a part, with the laws for its surface.
    pub(super) fn of_part(
        mut self,
        part: &DerivedPart,
        head: RegionHead,
        direction: RawDirection,
    ) -> Result<Region, Diagnostic> {
        let magnitude = self.magnitude(None, part.depth)?;
        let niceness = self.niceness(None, part.depth)?;
        let depth = Placed { value: part.depth, span: head.span };
        self.finish(head, depth, LawValues { magnitude, niceness }, direction)
    }
}
