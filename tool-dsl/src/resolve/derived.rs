//! Derives the regions of a profile, names them, and applies their laws. Its inside may be divided further: by regions
//! that are written, or by the fans of smoothed corners.

use super::condition::Curves;
use super::lower::Lowering;
use super::outputs;
use super::profile::Outline;
use super::region::{
    self, LawValues, Laws, Placed, RawDirection, RegionHead, RegionResolver, first_mention,
    or_report,
};
use crate::diagnostic::{
    CheckKind, Diagnostic, FormattedNumber, ProfileKind, RegionKind, Role, SurfaceRemedy,
    any_error, enough, nearest,
};
use crate::domain::Domain;
use crate::expr::{Coord, Graph, Id};
use crate::formula::Formula;
use crate::geometry::outline::Segment;
use crate::model::{DirectionSource, Model, Over, Profile, Region, Surface};
use crate::regionalise::overlay::{ConditionedPart, Division, Overlay, PieceDivider};
use crate::regionalise::rounded::Rounded;
use crate::regionalise::smooth::{self, Origin, Rough};
use crate::regionalise::{self, Feature, Partition, Test};
use crate::source::Span;
use crate::syntax::tree::{self, Expr, Quantity};

/// The surfaces, regions and section that result from a profile.
#[derive(Default)]
pub(super) struct FromProfile {
    pub(super) surfaces: Vec<Surface>,
    pub(super) regions: Vec<Region>,
    pub(super) profile: Option<Profile>,
}

/// A part of the inside, in which one feature is nearest.
struct DerivedPart {
    feature: Feature,
    depth: Id,
    direction: [Id; 3],
    name: String,
    /// Index of its surface.
    owner: usize,
    span: Span,
}

impl DerivedPart {
    /// Returns the shortest direction to the feature.
    fn own_direction(&self) -> RawDirection {
        RawDirection { parts: self.direction, span: self.span, source: DirectionSource::Derived }
    }
}

/// Derives the regions of an outline.
pub(super) fn derived(
    outline: Outline,
    divider: &Divider<'_>,
    laws: &Laws<'_>,
    lowering: &mut Lowering,
    curves: &mut Curves,
    diagnostics: &mut Vec<Diagnostic>,
) -> FromProfile {
    laws.check(&outline.surfaces, &lowering.left_out, diagnostics);
    if let Err(diagnostic) = divider.check_limits(&outline.segments) {
        diagnostics.push(diagnostic);
        return FromProfile::default();
    }
    let inner = Partition::new(outline.segments.clone());
    let parts = match derived_parts(&inner, &outline, lowering) {
        Ok(parts) => parts,
        Err(diagnostic) => {
            diagnostics.push(diagnostic);
            return FromProfile::default();
        }
    };
    add_lines_through_corners(&outline.segments, curves, &mut lowering.graph);
    let mut register = |graph: &mut Graph, test: &Test| formula(test, curves, graph);
    let separations = inner.separations(&mut lowering.graph, &mut register);
    let mut profile = Profile { outline: outline.segments.clone(), inner, separations, over: None };
    let mut regions = Vec::new();
    let before = diagnostics.len();
    let conditions = divider.conditions(&outline, lowering, curves, diagnostics);
    match conditions {
        None => {
            for part in &parts {
                let evaluation =
                    RegionResolver { laws, lowering, surface: &outline.surfaces[part.owner] };
                let (name, condition) = (part.name.clone(), Formula::Const(true));
                let head = RegionHead { name, span: part.span, owner: part.owner, condition };
                let direction = part.own_direction();
                regions.extend(or_report(evaluation.of_part(part, head, direction), diagnostics));
            }
        }
        Some(inside) if diagnostics.len() == before => {
            let divided = inside.parts(&profile, outline.span, curves, lowering, diagnostics);
            let DividedInside { division, kinds } = inside;
            for ConditionedPart { part, condition } in &divided {
                let (part, formula) = (&parts[*part], division.condition(*condition));
                let surfaces = &outline.surfaces;
                let kind = &kinds[*condition];
                regions.extend(kind.region(part, formula, surfaces, laws, lowering, diagnostics));
            }
            profile.over = Some(Over { division, regions: divided });
        }
        Some(_) => {}
    }
    FromProfile { surfaces: outline.surfaces, regions, profile: Some(profile) }
}

/// Returns a model whose profile is divided again, from its outline alone. Curves of the partition that the model does not have
/// follow those that it has.
pub(crate) fn partitioned_anew(model: &Model) -> Option<Model> {
    let mut model = model.clone();
    let mut curves = Curves::of(std::mem::take(&mut model.curves), &model.graph);
    let mut register = |graph: &mut Graph, test: &Test| formula(test, &mut curves, graph);
    let profile = model.profile.as_mut()?;
    profile.inner = Partition::new(profile.outline.clone());
    profile.separations = profile.inner.separations(&mut model.graph, &mut register);
    if let Some(Over { division: Division::Rounded(rounded), .. }) = &mut profile.over {
        rounded.divide_anew(&mut model.graph, &mut register);
    }
    model.curves = curves.list;
    Some(model)
}

/// Adds the normals at the ends of level and upright segments, which are level and upright too, as curves that a plan may split
/// by: no test is cheaper, and one often rules out the outside where the border of a part would cross it.
fn add_lines_through_corners(outline: &[Segment], curves: &mut Curves, graph: &mut Graph) {
    for segment in outline.iter().filter(|segment| segment.circle.is_none()) {
        for (across, axis, coord) in [(1, 0, Coord::D), (0, 1, Coord::Z)] {
            if segment.from[across] != segment.to[across] {
                continue;
            }
            for end in [&segment.from, &segment.to] {
                let (coord, at) = (graph.coord(coord), graph.number(end[axis].clone()));
                curves.at_most(graph, coord, at);
            }
        }
    }
}

/// Returns the parts of the inside with their names and directions.
fn derived_parts(
    inner: &Partition,
    outline: &Outline,
    lowering: &mut Lowering,
) -> Result<Vec<DerivedPart>, Diagnostic> {
    let section = inner.section();
    let graph = &mut lowering.graph;
    let zero = graph.int(0);
    let mut parts = Vec::new();
    for (index, (name, owner, span)) in names(outline, section.features()).into_iter().enumerate() {
        let depth = section.depth(graph, index);
        let depth = depth.ok_or_else(|| Diagnostic::new(span, ProfileKind::NoDistance))?;
        let feature = section.features()[index];
        let direction = regionalise::direction_to_surface(graph, &outline.segments, feature);
        let direction = Domain::HalfPlane.vector(graph, &direction.unwrap_or([zero, zero]));
        parts.push(DerivedPart { feature, depth, direction, name, owner, span });
    }
    Ok(parts)
}

/// Converts a test to a formula over curves.
fn formula(test: &Test, curves: &mut Curves, graph: &mut Graph) -> Formula {
    let zero = graph.int(0);
    match test {
        Test::Const(holds) => Formula::Const(*holds),
        Test::AtMost(value) => curves.at_most(graph, *value, zero),
        Test::All(tests) => {
            Formula::All(tests.iter().map(|test| formula(test, curves, graph)).collect())
        }
        Test::Any(tests) => {
            Formula::Any(tests.iter().map(|test| formula(test, curves, graph)).collect())
        }
    }
}

/// Returns the name, surface and span of each feature's part. `nut.2` is the second segment of a surface that has
/// several. `shank/nut.1` is the fan of a reflex corner, which belongs to the adjacent surface that does not cut,
/// otherwise to the first one.
fn names(
    Outline { segments: outline, surfaces, .. }: &Outline,
    features: &[Feature],
) -> Vec<(String, usize, Span)> {
    let mut fans = std::collections::BTreeMap::new();
    features
        .iter()
        .map(|feature| match *feature {
            Feature::Piece(piece) => {
                let segment = &outline[piece];
                let (surface, span) = (segment.geometry.surface, segment.span);
                let count = |segments: &[Segment]| {
                    segments.iter().filter(|other| other.geometry.surface == surface).count()
                };
                let word = &surfaces[surface].name;
                let name = match count(outline) {
                    1 => word.clone(),
                    _ => format!("{word}.{}", count(&outline[..=piece])),
                };
                (name, surface, span)
            }
            Feature::Corner(behind) => {
                let first = behind.unwrap_or(0);
                let second = behind.map_or(0, |piece| (piece + 1).min(outline.len() - 1));
                let [a, b] = [first, second].map(|piece| outline[piece].geometry.surface);
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
    fn of_part(
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

/// The further division of a profile's inside, in addition to its nearest features.
pub(super) enum Divider<'t> {
    /// No further division.
    Features,
    /// Regions written by hand.
    Hand(Vec<&'t tree::Region>),
    /// Directions of the outline with its corners rounded over this tangent length.
    Smooth(&'t Expr),
}

/// A division of the parts of a partition, and what each of its conditions effects.
struct DividedInside<'t> {
    division: Division,
    kinds: Vec<Kind<'t>>,
}

enum Kind<'t> {
    Hand(&'t tree::Region, Option<usize>),
    /// The direction to the rounded outline, not normalised, and the origin of its segment.
    Smooth([Id; 3], Origin),
}

impl Divider<'_> {
    /// Rejects an outline that would take minutes to divide.
    fn check_limits(&self, outline: &[Segment]) -> Result<(), Diagnostic> {
        match self {
            Divider::Smooth(length) if outline.len() > MAX_SMOOTH_SEGMENTS => Err(Diagnostic::new(
                length.span,
                RegionKind::TooManySmoothSegments { limit: MAX_SMOOTH_SEGMENTS },
            )),
            _ => Ok(()),
        }
    }

    /// Returns the conditions, if there is a further division.
    fn conditions(
        &self,
        outline: &Outline,
        lowering: &mut Lowering,
        curves: &mut Curves,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<DividedInside<'_>> {
        match self {
            Divider::Features => None,
            Divider::Hand(regions) => {
                let (mut formulas, mut kinds) = (Vec::new(), Vec::new());
                for region in regions {
                    let surface =
                        or_report(written(region, &regions[..], &outline.surfaces), diagnostics);
                    let condition = region::all_conditions(region, lowering, curves, diagnostics);
                    if let (Some(surface), Some(condition)) = (surface, condition) {
                        formulas.push(condition);
                        kinds.push(Kind::Hand(region, surface));
                    }
                    if enough(diagnostics) {
                        break;
                    }
                }
                Some(DividedInside { division: Division::Conditions(formulas), kinds })
            }
            Divider::Smooth(length) => {
                or_report(fans(length, &outline.segments, lowering, curves), diagnostics)
            }
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

/// The maximum number of segments of a profile with `regions smooth`: the cells of the rounded outline are intersected with
/// those of the outline.
const MAX_SMOOTH_SEGMENTS: usize = 128;

/// Returns the division by the outline with rounded corners, from which directions are taken.
fn fans<'t>(
    length: &Expr,
    outline: &[Segment],
    lowering: &mut Lowering,
    curves: &mut Curves,
) -> Result<DividedInside<'t>, Diagnostic> {
    let span = length.span;
    let width = lowering.length(length, Role::Smooth)?;
    if width.to_f64() <= 0.0 {
        return Err(Diagnostic::new(span, RegionKind::SmoothNotPositive));
    }
    let formatted = |behind: Option<usize>, lowering: &Lowering| {
        let [d, z] = match behind {
            Some(piece) => outline[piece].geometry.ends[1],
            None => outline[0].geometry.ends[0],
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
    let graph = &mut lowering.graph;
    let (segments, origins): (Vec<Segment>, Vec<Origin>) = pieces.iter().cloned().unzip();
    let zero = graph.int(0);
    let mut kinds = Vec::new();
    for (segment, origin) in origins.into_iter().enumerate() {
        let direction =
            regionalise::direction_to_surface(graph, &segments, Feature::Piece(segment));
        let direction = Domain::HalfPlane.vector(graph, &direction.unwrap_or([zero, zero]));
        kinds.push(Kind::Smooth(direction, origin));
    }
    let mut register = |graph: &mut Graph, test: &Test| formula(test, curves, graph);
    let rounded = Rounded::new(outline, &pieces, graph, &mut register);
    Ok(DividedInside { division: Division::Rounded(rounded), kinds })
}

impl DividedInside<'_> {
    /// Returns the parts and conditions that have points in common, and reports gaps, overlaps and regions without points.
    fn parts(
        &self,
        profile: &Profile,
        outline_span: Span,
        curves: &Curves,
        lowering: &Lowering,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Vec<ConditionedPart> {
        let (mut shapes, size) = profile.functions(&lowering.graph, &curves.list);
        self.division.set_distances(&mut shapes);
        let pieces = profile.inner.inner_pieces(&profile.separations, &shapes);
        let divider = PieceDivider::new(&self.division, &shapes, size);
        let Overlay { parts, uncovered, doubly_covered } =
            Overlay::new(&profile.inner.section(), pieces, &divider);
        let formatted =
            |[d, z]: [f64; 2]| Domain::HalfPlane.format_point([d, 0.0, lowering.frame.to_file(z)]);
        if let Some(p) = uncovered {
            let location = formatted(p);
            diagnostics
                .push(Diagnostic::new(outline_span, RegionKind::UncoveredPoint { location }));
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
                let kind = RegionKind::RegionOutsideProfile { region: name.text.clone() };
                diagnostics.push(Diagnostic::new(name.span, kind));
            }
        }
        parts
    }
}

impl Kind<'_> {
    /// Returns the region of a part in which a condition holds.
    fn region(
        &self,
        part: &DerivedPart,
        condition: Formula,
        surfaces: &[Surface],
        laws: &Laws<'_>,
        lowering: &mut Lowering,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<Region> {
        let depth = part.depth;
        match self {
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
                let head = RegionHead { name, span: part.span, owner: part.owner, condition };
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
                let head = RegionHead { name, span, owner, condition };
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
