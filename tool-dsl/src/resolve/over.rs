//! Divides a profile further: by regions that are written, or by the fans of smoothed corners.

use super::condition::Curves;
use super::derived::{DerivedPart, formula};
use super::direction::RawDirection;
use super::law::Laws;
use super::lower::Lowering;
use super::outputs;
use super::region::{Placed, RegionHead, RegionResolver, first_mention, inside, or_report};
use crate::diagnostic::{
    CheckKind, Diagnostic, FormattedNumber, RegionKind, Role, SurfaceRemedy, any_error, enough,
    nearest,
};
use crate::domain::Domain;
use crate::expr::Id;
use crate::formula::Formula;
use crate::geometry::outline::Segment;
use crate::model::{DirectionSource, Region, Surface};
use crate::regionalise::overlay::{self, ConditionedPart, Overlay};
use crate::regionalise::smooth::{self, Origin, Rough};
use crate::regionalise::{self, Feature, Partition, Undivided};
use crate::source::Span;
use crate::syntax::tree::{self, Expr, Quantity};

/// The further division of a profile's inside, in addition to its nearest features.
pub(super) enum Divider<'t> {
    /// No further division.
    Features,
    /// Regions written by hand.
    Hand(Vec<&'t tree::Region>),
    /// Directions of the outline with its corners rounded over this tangent length.
    Smooth(&'t Expr),
}

/// Conditions over the parts of a partition, and their effects.
pub(super) struct Conditions<'t> {
    pub(super) conditions: Vec<Formula>,
    /// The distances from the segments of the rounded outline.
    pub(super) distances: Vec<Id>,
    kinds: Vec<Kind<'t>>,
}

impl Conditions<'_> {
    const NONE: Conditions<'static> =
        Conditions { conditions: Vec::new(), distances: Vec::new(), kinds: Vec::new() };
}

enum Kind<'t> {
    Hand(&'t tree::Region, Option<usize>),
    /// The direction to the rounded outline, not normalised, and the origin of its segment.
    Smooth([Id; 3], Origin),
}

impl Divider<'_> {
    /// Rejects an outline that would take minutes to divide.
    pub(super) fn check_limits(&self, outline: &[Segment]) -> Result<(), Diagnostic> {
        match self {
            Divider::Smooth(length) if outline.len() > MAX_SMOOTH_SEGMENTS => Err(Diagnostic::new(
                length.span,
                RegionKind::TooManySmoothSegments { limit: MAX_SMOOTH_SEGMENTS },
            )),
            _ => Ok(()),
        }
    }

    /// Returns the conditions, if there is a further division.
    pub(super) fn conditions(
        &self,
        (outline, inner): (&[Segment], &Partition),
        surfaces: &[Surface],
        lowering: &mut Lowering,
        curves: &mut Curves,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<Conditions<'_>> {
        match self {
            Divider::Features => None,
            Divider::Hand(regions) => {
                let mut conditions = Conditions::NONE;
                for region in regions {
                    let surface = or_report(written(region, &regions[..], surfaces), diagnostics);
                    let condition = inside(region, lowering, curves, diagnostics);
                    if let (Some(surface), Some(condition)) = (surface, condition) {
                        conditions.conditions.push(condition);
                        conditions.kinds.push(Kind::Hand(region, surface));
                    }
                    if enough(diagnostics) {
                        break;
                    }
                }
                Some(conditions)
            }
            Divider::Smooth(length) => match fans(length, outline, inner, lowering, curves) {
                Ok(conditions) => Some(conditions),
                Err(diagnostic) => {
                    diagnostics.push(diagnostic);
                    None
                }
            },
        }
    }
}

/// Returns the surface that a written region names, if any.
fn written(
    region: &tree::Region,
    regions: &[&tree::Region],
    surfaces: &[Surface],
) -> Result<Option<usize>, Diagnostic> {
    let name = &region.name;
    if let Some(first) = regions.iter().find(|r| r.name.text == name.text)
        && first.name.span != name.span
    {
        let diagnostic =
            Diagnostic::new(name.span, RegionKind::DuplicateRegion { name: name.text.clone() });
        return Err(diagnostic.with_label(first.name.span, "first region of this name"));
    }
    if let Some(depth) = region.scalars.iter().find(|s| s.quantity == Quantity::Depth) {
        return Err(Diagnostic::new(depth.value.span, RegionKind::DepthBesideProfile));
    }
    match &region.surface {
        None => Ok(None),
        Some(surface_name) => {
            if let Some(cutting) = region.cutting {
                return Err(Diagnostic::new(cutting, RegionKind::CuttingBesideProfile));
            }
            let found = surfaces.iter().position(|surface| surface.name == surface_name.text);
            found.map(Some).ok_or_else(|| {
                let known = surfaces.iter().map(|surface| surface.name.as_str());
                let remedy = match nearest(&surface_name.text, known) {
                    Some(suggestion) => SurfaceRemedy::Similar(suggestion.to_owned()),
                    None => SurfaceRemedy::OfProfile,
                };
                let kind = RegionKind::UnknownSurface { name: surface_name.text.clone(), remedy };
                Diagnostic::new(surface_name.span, kind)
            })
        }
    }
}

/// The maximum number of segments of a profile with `regions smooth`: the cells of each corner are intersected with
/// those of each segment.
const MAX_SMOOTH_SEGMENTS: usize = 128;

/// Returns the cells of the outline with rounded corners, from which directions are taken.
fn fans<'t>(
    length: &Expr,
    outline: &[Segment],
    inner: &Partition,
    lowering: &mut Lowering,
    curves: &mut Curves,
) -> Result<Conditions<'t>, Diagnostic> {
    let span = length.span;
    let width = lowering.length(length, Role::Smooth)?;
    if width.to_f64() <= 0.0 {
        return Err(Diagnostic::new(span, RegionKind::SmoothNotPositive));
    }
    let formatted = |behind: Option<usize>, lowering: &Lowering| {
        let [d, z] = match behind {
            Some(piece) => outline[piece].ends()[1],
            None => outline[0].ends()[0],
        };
        Domain::HalfPlane.format_point([d, 0.0, lowering.frame.to_file(z)])
    };
    let pieces = smooth::rounded(outline, &width).map_err(|rough| {
        let max_length = smooth::largest_fitting_length(outline, &width);
        match rough {
            Rough::Untouched(behind) => Diagnostic::new(
                span,
                RegionKind::NoTangentArc { location: formatted(behind, lowering), max_length },
            ),
            Rough::Short(piece, size, count) => {
                let [from, to] =
                    [piece.checked_sub(1), Some(piece)].map(|behind| formatted(behind, lowering));
                let corners = (count == 2).then_some([from, to]);
                Diagnostic::new(
                    span,
                    RegionKind::FansTooWide {
                        corners,
                        segment_length: FormattedNumber(size),
                        max_length,
                    },
                )
                .with_label(outline[piece].span, "segment too short")
            }
        }
    })?;
    let (rounded, origins): (Vec<Segment>, Vec<Origin>) = pieces.into_iter().unzip();
    let (graph, frame) = (&mut lowering.graph, &lowering.frame);
    let undivided = |Undivided([d, z]): Undivided| {
        Diagnostic::new(
            span,
            RegionKind::SmoothDivisionFailed {
                location: Domain::HalfPlane.format_point([d, 0.0, frame.to_file(z)]),
            },
        )
    };
    let parts = Partition::new(rounded.clone(), false).parts(graph).map_err(undivided)?;
    let mut conditions = Conditions::NONE;
    for part in &parts {
        let Feature::Piece(piece) = part.feature else { continue };
        let mut inside = part.inside.clone();
        if let Origin::Fan(behind) = origins[piece]
            && rounded[piece].round().is_some_and(|(_, _, convex)| convex)
        {
            // A convex corner protrudes beyond its arc; there the corner's edges bound the fan.
            let adjacent = [behind, Some(behind.map_or(0, |k| k + 1))];
            let edges = adjacent.into_iter().flatten().filter(|k| *k < outline.len());
            let edges = edges.filter_map(|k| inner.inside(graph, k)).collect();
            inside = inside.without_own(edges);
        }
        conditions.conditions.push(formula(&inside, curves, graph));
        conditions.distances.push(part.depth);
        let zero = graph.int(0);
        let direction = regionalise::direction_to_surface(graph, &rounded, part.feature)
            .unwrap_or([zero, zero]);
        let direction = Domain::HalfPlane.vector(graph, &direction);
        conditions.kinds.push(Kind::Smooth(direction, origins[piece]));
    }
    Ok(conditions)
}

impl Conditions<'_> {
    /// Returns the parts and conditions that have points in common, and reports gaps, overlaps and regions without points.
    pub(super) fn conditioned_parts(
        &self,
        (outline, inner, parts): (&[Segment], &Partition, &[DerivedPart]),
        (curves, lowering): (&Curves, &Lowering),
        span: Span,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Vec<ConditionedPart> {
        let (shapes, size) = overlay::shapes(&lowering.graph, &curves.list, outline);
        let insides: Vec<&Formula> = parts.iter().map(|part| &part.inside).collect();
        let Overlay { parts, uncovered, doubly_covered } =
            overlay::overlay(&inner.cells(8), &insides, &self.conditions, &shapes, size);
        let formatted =
            |[d, z]: [f64; 2]| Domain::HalfPlane.format_point([d, 0.0, lowering.frame.to_file(z)]);
        if let Some(p) = uncovered {
            diagnostics
                .push(Diagnostic::new(span, RegionKind::UncoveredPoint { location: formatted(p) }));
        }
        if let Some((first, second, p)) = doubly_covered
            && let (Kind::Hand(a, _), Kind::Hand(b, _)) = (&self.kinds[first], &self.kinds[second])
        {
            let (a, b) = (&a.name, &b.name);
            let is_left = parts.iter().any(|part| part.condition == second);
            diagnostics.push(match is_left {
                true => overlapping(&a.text, &b.text, b.span, formatted(p), a.span),
                false => never_wins(&b.text, b.span, &a.text, a.span, 0),
            });
        }
        for (k, kind) in self.kinds.iter().enumerate() {
            if let Kind::Hand(region, _) = kind
                && !any_error(diagnostics)
                && parts.iter().all(|part| part.condition != k)
            {
                let name = &region.name;
                diagnostics.push(Diagnostic::new(
                    name.span,
                    RegionKind::RegionOutsideProfile { region: name.text.clone() },
                ));
            }
        }
        parts
    }

    /// Returns the region of a part in which a condition holds.
    pub(super) fn region(
        &self,
        part: &DerivedPart,
        condition: usize,
        surfaces: &[Surface],
        laws: &Laws<'_>,
        lowering: &mut Lowering,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<Region> {
        let inside = Formula::All(vec![self.conditions[condition].clone(), part.inside.clone()]);
        let depth = part.depth;
        match &self.kinds[condition] {
            Kind::Smooth(direction, origin) => {
                let own = matches!((part.feature, origin), (Feature::Piece(a), Origin::Piece(b)) if a == *b);
                let name = match origin {
                    _ if own => part.name.clone(),
                    Origin::Piece(piece) => format!("{} by {}", part.name, piece + 1),
                    Origin::Fan(behind) => {
                        format!("{} by fan {}", part.name, behind.map_or(0, |k| k + 1))
                    }
                };
                let evaluation = RegionResolver { laws, lowering, surface: &surfaces[part.owner] };
                let head = RegionHead { name, span: part.span, owner: part.owner, inside };
                let source = DirectionSource::Oblique;
                let direction = RawDirection { parts: *direction, span: part.span, source };
                or_report(evaluation.of_part(part, head, direction), diagnostics)
            }
            Kind::Hand(region, surface) => {
                let owner = surface.unwrap_or(part.owner);
                let mut evaluation = RegionResolver { laws, lowering, surface: &surfaces[owner] };
                let law_values = evaluation.law_values(region, depth, diagnostics);
                let written = or_report(evaluation.resolve_direction(region), diagnostics)?;
                let law_values = law_values?;
                let own =
                    or_report(evaluation.scalar_of(region, Quantity::Magnitude), diagnostics)?;
                let free = own
                    .filter(|own| first_mention(&own.value, Quantity::Depth.keyword()).is_none());
                let direction = match (written, free, law_values.magnitude) {
                    (Some(direction), ..) => direction,
                    (None, Some(own), Some(magnitude)) => {
                        let graph = &mut evaluation.lowering.graph;
                        let slope = outputs::gradient(graph, Domain::HalfPlane, magnitude.value);
                        let parts = slope.map(|slope| graph.neg(slope));
                        let (span, source) = (own.value.span, DirectionSource::Written);
                        RawDirection { parts, span, source }
                    }
                    (None, ..) => part.own_direction(),
                };
                let (name, span) = (region.name.text.clone(), region.name.span);
                let head = RegionHead { name, span, owner, inside };
                let depth = Placed { value: depth, span };
                or_report(evaluation.finish(head, depth, law_values, direction), diagnostics)
            }
        }
    }
}

/// Returns the warning or error for a region that is entirely covered by one or more regions listed before it.
pub(crate) fn never_wins(name: &str, span: Span, first: &str, at: Span, more: usize) -> Diagnostic {
    Diagnostic::new(
        span,
        CheckKind::CoveredRegion { region: name.to_owned(), covering: first.to_owned(), more },
    )
    .with_label(at, "region listed before it")
}

/// Returns the error for two regions that have points in common, for instance at `location`. The first region is at `at`.
pub(crate) fn overlapping(
    first: &str,
    second: &str,
    span: Span,
    location: String,
    at: Span,
) -> Diagnostic {
    let (first, second) = (first.to_owned(), second.to_owned());
    Diagnostic::new(span, CheckKind::Overlap { first, second, location })
        .with_label(at, "overlapping region")
}
