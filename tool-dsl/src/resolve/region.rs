//! Resolves regions: points, depth, direction, magnitude and niceness, from their own properties or from the laws that
//! are stated for their surfaces.

use super::condition::Curves;
use super::lower::{Allowed, Lowered, Lowering};
use super::outputs;
use crate::diagnostic::{Diagnostic, Names, RegionKind, Role, SurfaceRemedy, enough, nearest};
use crate::dimension::Dimension;
use crate::domain::Domain;
use crate::expr::{Coord, Graph, Id};
use crate::formula::Formula;
use crate::model::{DirectionSource, LawSpans, Region, Surface};
use crate::source::Span;
use crate::syntax::tree::{
    self, Compare, Direction, Expr, Item, Law, Quantity, ScalarProperty, Tool, Tuple,
};
use std::collections::{BTreeMap, BTreeSet};

/// The maximum number of regions of a tool. Planning more would take minutes.
const MAX_REGIONS_OR_CONDITIONS: usize = 256;

/// Resolves all surfaces and regions that are written by hand.
pub(super) fn regions(
    tool: &Tool,
    laws: &Laws<'_>,
    lowering: &mut Lowering,
    curves: &mut Curves,
    diagnostics: &mut Vec<Diagnostic>,
) -> (Vec<Surface>, Vec<Region>) {
    let written: Vec<&tree::Region> = tool
        .items
        .iter()
        .filter_map(|item| if let Item::Region(region) = item { Some(region) } else { None })
        .collect();
    if written.is_empty() {
        diagnostics.push(Diagnostic::new(
            tool.name.span,
            RegionKind::NoRegion { tool: tool.name.text.clone() },
        ));
    }
    if let Some(beyond) = written.get(MAX_REGIONS_OR_CONDITIONS) {
        diagnostics.push(Diagnostic::new(
            beyond.name.span,
            RegionKind::TooManyRegions { limit: MAX_REGIONS_OR_CONDITIONS },
        ));
        return Default::default();
    }
    let mut surfaces = Vec::new();
    let owners: Vec<usize> =
        written.iter().map(|region| surface(region, &mut surfaces, diagnostics)).collect();
    laws.check(&surfaces, &lowering.left_out, diagnostics);
    let mut regions: Vec<Region> = Vec::new();
    for (written, owner) in written.into_iter().zip(owners) {
        if let Some(earlier) = regions.iter().find(|r| r.name == written.name.text) {
            diagnostics.push(
                Diagnostic::new(
                    written.name.span,
                    RegionKind::DuplicateRegion { name: earlier.name.clone() },
                )
                .with_label(earlier.span, "first region of this name"),
            );
        }
        let evaluation = RegionResolver { laws, lowering, surface: &surfaces[owner] };
        regions.extend(evaluation.region(written, owner, curves, diagnostics));
        if enough(diagnostics) {
            break;
        }
    }
    (surfaces, regions)
}

/// Returns the surface of a region: the one it names, or one of the region's own name.
fn surface(
    region: &tree::Region,
    surfaces: &mut Vec<Surface>,
    diagnostics: &mut Vec<Diagnostic>,
) -> usize {
    let name = region.surface.as_ref().unwrap_or(&region.name);
    named_surface(name, region.cutting.is_some(), surfaces, diagnostics)
}

/// Returns the index of the surface with a name, adding it if it is new.
pub(super) fn named_surface(
    name: &tree::Name,
    cutting: bool,
    surfaces: &mut Vec<Surface>,
    diagnostics: &mut Vec<Diagnostic>,
) -> usize {
    if name.text == "cutting" {
        diagnostics.push(Diagnostic::new(name.span, RegionKind::SurfaceCalledCutting));
    }
    match surfaces.iter().position(|surface| surface.name == name.text) {
        Some(at) => {
            if surfaces[at].cutting != cutting {
                let there =
                    if cutting { "not marked `cutting` here" } else { "marked `cutting` here" };
                diagnostics.push(
                    Diagnostic::new(
                        name.span,
                        RegionKind::InconsistentCutting {
                            name: name.text.clone(),
                            marked_here: cutting,
                        },
                    )
                    .with_label(surfaces[at].span, there),
                );
            }
            at
        }
        None => {
            surfaces.push(Surface { name: name.text.clone(), cutting, span: name.span });
            surfaces.len() - 1
        }
    }
}

/// A region without its depth, direction, magnitude and niceness.
pub(super) struct RegionHead {
    pub(super) name: String,
    pub(super) span: Span,
    pub(super) owner: usize,
    pub(super) condition: Formula,
}

/// A value and its span.
#[derive(Clone, Copy)]
pub(super) struct Placed {
    pub(super) value: Id,
    pub(super) span: Span,
}

/// The magnitude and the niceness of a region.
pub(super) struct LawValues {
    /// The magnitude; `None` if it is the depth.
    pub(super) magnitude: Option<Placed>,
    pub(super) niceness: Niceness,
}

/// A niceness, its span, and whether it may rise with depth.
#[derive(Clone, Copy)]
pub(super) struct Niceness {
    value: Id,
    span: Span,
    rising: bool,
}

/// Returns the value of a result, and reports its error.
pub(super) fn or_report<T>(
    result: Result<T, Diagnostic>,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<T> {
    result.map_err(|diagnostic| diagnostics.push(diagnostic)).ok()
}

/// Lowers a magnitude or a niceness.
fn quantity(lowering: &mut Lowering, value: &Expr, may: Allowed) -> Result<Id, Diagnostic> {
    let Lowered { id, dimension } = lowering.lower(value, may)?;
    if dimension == Dimension::Angle {
        return Err(Diagnostic::new(value.span, RegionKind::AngleAsQuantity));
    }
    Ok(id)
}

/// Resolves the outputs of one region.
pub(super) struct RegionResolver<'a> {
    pub(super) laws: &'a Laws<'a>,
    pub(super) lowering: &'a mut Lowering,
    pub(super) surface: &'a Surface,
}

impl RegionResolver<'_> {
    /// Returns the magnitude written by the region, otherwise by the law for its surface. Returns `None` if there is
    /// neither, or if it is written as `depth`. Any other magnitude is a number of its own, even if it is computed from
    /// the depth.
    pub(super) fn magnitude(
        &mut self,
        own: Option<&Expr>,
        depth: Id,
    ) -> Result<Option<Placed>, Diagnostic> {
        let law = self.laws.find(Quantity::Magnitude, self.surface).map(|law| &law.value);
        let Some(value) = own.or(law) else { return Ok(None) };
        let id = quantity(self.lowering, value, Allowed::Depth(depth))?;
        let is_depth = id == depth && first_mention(value, Quantity::Depth.keyword()).is_some();
        Ok((!is_depth).then_some(Placed { value: id, span: value.span }))
    }

    /// Builds the expressions of the region's outputs.
    pub(super) fn finish(
        self,
        head: RegionHead,
        depth: Placed,
        LawValues { magnitude: own_magnitude, niceness }: LawValues,
        raw_direction: RawDirection,
    ) -> Result<Region, Diagnostic> {
        let (graph, domain) = (&mut self.lowering.graph, self.lowering.domain);
        let direction = outputs::unit(graph, raw_direction.parts, 2).ok_or_else(|| {
            Diagnostic::new(
                raw_direction.span,
                RegionKind::ZeroDirection { region: head.name.clone() },
            )
        })?;
        let own = own_magnitude.map(|magnitude| magnitude.value);
        let outputs = outputs::outputs(graph, domain, depth.value, own, direction, niceness.value);
        let magnitude = own_magnitude.unwrap_or(depth);
        let law_spans =
            LawSpans { depth: depth.span, magnitude: magnitude.span, niceness: niceness.span };
        Ok(Region {
            name: head.name,
            span: head.span,
            surface: head.owner,
            condition: head.condition,
            depth: depth.value,
            law_spans,
            magnitude: magnitude.value,
            direction,
            raw_direction: (raw_direction.parts, raw_direction.span),
            source: raw_direction.source,
            niceness: niceness.value,
            allow_rising: niceness.rising,
            outputs,
        })
    }

    /// Resolves a region that states its own depth, and reports all of its errors.
    fn region(
        mut self,
        written: &tree::Region,
        owner: usize,
        curves: &mut Curves,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<Region> {
        let condition = all_conditions(written, self.lowering, curves, diagnostics);
        let known = or_report(self.depth(written), diagnostics);
        // Without a depth, the other properties are still checked, with a stand-in for it.
        let any = self.lowering.domain.coordinates()[0].0;
        let depth = known.unwrap_or_else(|| Placed {
            value: self.lowering.graph.coord(any),
            span: written.name.span,
        });
        let law_values = self.law_values(written, depth.value, diagnostics);
        let direction = or_report(self.resolve_direction(written), diagnostics);
        let (name, span) = (written.name.text.clone(), written.name.span);
        let head = RegionHead { name, span, owner, condition: condition? };
        let direction = direction?.unwrap_or_else(|| RawDirection {
            parts: self.steepest_descent(depth.value),
            span: depth.span,
            source: DirectionSource::Derived,
        });
        known?;
        or_report(self.finish(head, depth, law_values?, direction), diagnostics)
    }

    /// Returns the magnitude and the niceness of a written region, and reports their errors.
    pub(super) fn law_values(
        &mut self,
        written: &tree::Region,
        depth: Id,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<LawValues> {
        let magnitude = self.scalar_of(written, Quantity::Magnitude);
        let magnitude = magnitude.and_then(|own| self.magnitude(own.map(|own| &own.value), depth));
        let niceness = self.scalar_of(written, Quantity::Niceness);
        let niceness = niceness.and_then(|own| self.niceness(own, depth));
        let (magnitude, niceness) =
            (or_report(magnitude, diagnostics), or_report(niceness, diagnostics));
        Some(LawValues { magnitude: magnitude?, niceness: niceness? })
    }

    /// Returns the region's own property for a quantity.
    pub(super) fn scalar_of<'w>(
        &self,
        written: &'w tree::Region,
        quantity: Quantity,
    ) -> Result<Option<&'w ScalarProperty>, Diagnostic> {
        let mut matching = written.scalars.iter().filter(|scalar| scalar.quantity == quantity);
        let first = matching.next();
        if let (Some(first), Some(second)) = (first, matching.next()) {
            return Err(Diagnostic::new(
                second.span,
                RegionKind::DuplicateStatement { keyword: quantity.keyword().to_owned() },
            )
            .with_label(first.span, "first definition"));
        }
        Ok(first)
    }

    /// Returns the depth: the region's own, otherwise its magnitude.
    fn depth(&mut self, written: &tree::Region) -> Result<Placed, Diagnostic> {
        let (value, by) = match self.scalar_of(written, Quantity::Depth)? {
            Some(own) => (&own.value, Quantity::Depth),
            None => match self.scalar_of(written, Quantity::Magnitude)? {
                Some(own) => (&own.value, Quantity::Magnitude),
                None => {
                    let name = &written.name;
                    return Err(Diagnostic::new(
                        name.span,
                        RegionKind::NoDepth { region: name.text.clone() },
                    ));
                }
            },
        };
        if let (Quantity::Magnitude, Some(span)) = (by, first_mention(value, "depth")) {
            return Err(Diagnostic::new(
                span,
                RegionKind::UndefinedDepth { region: written.name.text.clone() },
            ));
        }
        let Lowered { id, dimension } = self.lowering.lower(value, Allowed::Coordinates)?;
        if by == Quantity::Depth && !dimension.is_length() {
            return Err(Diagnostic::new(value.span, RegionKind::DepthNotLength { dimension }));
        }
        if dimension == Dimension::Angle {
            return Err(Diagnostic::new(value.span, RegionKind::AngleAsMagnitude));
        }
        let graph = &mut self.lowering.graph;
        if graph.constant(id).is_some() {
            return Err(Diagnostic::new(value.span, RegionKind::ConstantDepth));
        }
        Ok(Placed { value: id, span: value.span })
    }

    /// Returns the niceness written by the region, otherwise by the law for its surface, otherwise by its mounted file.
    /// Without any of them it is 1 on a cutting surface, and 0 on others.
    pub(super) fn niceness(
        &mut self,
        own: Option<&ScalarProperty>,
        depth: Id,
    ) -> Result<Niceness, Diagnostic> {
        let constant = |value: Id| Niceness { value, span: self.surface.span, rising: false };
        if !self.surface.cutting {
            return match own {
                Some(own) => Err(idle_niceness(own.value.span, self.surface)),
                None => Ok(constant(self.lowering.graph.int(0))),
            };
        }
        let own = own.map(|own| (&own.value, own.allow_rising));
        let law = self.laws.find(Quantity::Niceness, self.surface);
        let law = law.map(|law| (&law.value, law.allow_rising));
        match (own.or(law), self.laws.niceness_by_surface.get(&self.surface.name)) {
            (Some((value, rising)), _) => {
                let span = value.span;
                let value = quantity(self.lowering, value, Allowed::Depth(depth))?;
                Ok(Niceness { value, span, rising })
            }
            (None, Some(along)) => along.lower(&mut self.lowering.graph, depth),
            (None, None) => Ok(constant(self.lowering.graph.int(1))),
        }
    }

    /// Returns −∇ of the depth.
    fn steepest_descent(&mut self, depth: Id) -> [Id; 3] {
        let (graph, domain) = (&mut self.lowering.graph, self.lowering.domain);
        outputs::gradient(graph, domain, depth).map(|part| graph.neg(part))
    }
}

/// Returns the points that satisfy all of a region's conditions, and reports each invalid condition.
pub(super) fn all_conditions(
    written: &tree::Region,
    lowering: &mut Lowering,
    curves: &mut Curves,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<Formula> {
    if let Some(beyond) = written.conditions.get(MAX_REGIONS_OR_CONDITIONS) {
        diagnostics.push(Diagnostic::new(
            beyond.span,
            RegionKind::TooManyConditions { limit: MAX_REGIONS_OR_CONDITIONS },
        ));
        return None;
    }
    let sides = written.conditions.iter();
    let sides: Vec<Option<Vec<Formula>>> =
        sides.map(|one| or_report(condition(one, lowering, curves), diagnostics)).collect();
    let sides: Option<Vec<Vec<Formula>>> = sides.into_iter().collect();
    Some(Formula::All(sides?.into_iter().flatten().collect()))
}

/// Returns the sides of one condition: one, or two for a chain.
fn condition(
    condition: &tree::Condition,
    lowering: &mut Lowering,
    curves: &mut Curves,
) -> Result<Vec<Formula>, Diagnostic> {
    let mut sides = Vec::new();
    let mut left = lowering.lower(&condition.first, Allowed::Coordinates)?;
    for (compare, right) in &condition.rest {
        let right = lowering.lower(right, Allowed::Coordinates)?;
        if left.dimension.common(right.dimension).is_none_or(|d| d == Dimension::Angle) {
            return Err(Diagnostic::new(
                condition.span,
                RegionKind::MixedComparison { left: left.dimension, right: right.dimension },
            ));
        }
        let graph = &mut lowering.graph;
        sides.push(match compare {
            Compare::AtMost => curves.at_most(graph, left.id, right.id),
            Compare::AtLeast => curves.at_most(graph, right.id, left.id),
        });
        left = right;
    }
    Ok(sides)
}

/// Returns the span at which an expression mentions a name.
pub(super) fn first_mention(expr: &Expr, word: &str) -> Option<Span> {
    match &expr.kind {
        tree::ExprKind::Name(name) => (name == word).then_some(expr.span),
        tree::ExprKind::Number(..) => None,
        tree::ExprKind::Neg(inner) => first_mention(inner, word),
        tree::ExprKind::Binary(_, a, b) => {
            first_mention(a, word).or_else(|| first_mention(b, word))
        }
        tree::ExprKind::Call(_, matching) => {
            matching.iter().find_map(|part| first_mention(part, word))
        }
    }
}

/// A direction that is not yet normalised, with its span and its source.
#[derive(Clone, Copy)]
pub(super) struct RawDirection {
    pub(super) parts: [Id; 3],
    pub(super) span: Span,
    pub(super) source: DirectionSource,
}

impl RegionResolver<'_> {
    /// Returns the direction that a region writes, if it does.
    pub(super) fn resolve_direction(
        &mut self,
        written: &tree::Region,
    ) -> Result<Option<RawDirection>, Diagnostic> {
        match written.direction.as_slice() {
            [] => Ok(None),
            [resolve_direction] => Ok(Some(RawDirection {
                parts: self.direction(&resolve_direction.direction)?,
                span: resolve_direction.span,
                source: match resolve_direction.allow_oblique {
                    true => DirectionSource::Oblique,
                    false => DirectionSource::Written,
                },
            })),
            [first, second, ..] => {
                Err(Diagnostic::new(second.span, RegionKind::DuplicateDirection)
                    .with_label(first.span, "first direction"))
            }
        }
    }

    /// Returns the vector of a direction, not normalised.
    fn direction(&mut self, direction: &Direction) -> Result<[Id; 3], Diagnostic> {
        match direction {
            Direction::Vector(tuple) => self.along(tuple),
            Direction::AwayFrom(tuple) => self.direction_from_point(tuple),
            Direction::Toward(tuple) => {
                let from_point = self.direction_from_point(tuple)?;
                Ok(from_point.map(|part| self.lowering.graph.neg(part)))
            }
        }
    }

    fn along(&mut self, tuple: &Tuple) -> Result<[Id; 3], Diagnostic> {
        let domain = self.lowering.domain;
        let (mut parts, mut dimension) = (Vec::new(), Dimension::Dimensionless);
        for part in components(tuple, domain, Role::Direction)? {
            let Lowered { id, dimension: of_part } =
                self.lowering.lower(part, Allowed::Coordinates)?;
            let common_dimension = dimension.common(of_part).filter(|d| *d != Dimension::Angle);
            dimension = common_dimension.ok_or_else(|| {
                Diagnostic::new(
                    tuple.span,
                    RegionKind::MixedDirection { first: dimension, second: of_part },
                )
            })?;
            parts.push(id);
        }
        let down = self.lowering.frame.spindle_down;
        let graph = &mut self.lowering.graph;
        let [x, y, z] = domain.vector(graph, &parts);
        Ok([x, y, if down { graph.neg(z) } else { z }])
    }

    /// Returns the vector from a fixed point to the evaluated point.
    fn direction_from_point(&mut self, tuple: &Tuple) -> Result<[Id; 3], Diagnostic> {
        let domain = self.lowering.domain;
        let mut parts = Vec::new();
        for (part, (coord, ..)) in
            components(tuple, domain, Role::Point)?.into_iter().zip(domain.coordinates())
        {
            let constant = self.lowering.length(part, Role::Point)?;
            let constant = match coord {
                Coord::Z => self.lowering.frame.to_tool(&constant),
                _ => constant,
            };
            let graph = &mut self.lowering.graph;
            let (coordinate, constant) = (graph.coord(*coord), graph.number(constant));
            parts.push(graph.sub(coordinate, constant));
        }
        Ok(domain.vector(&mut self.lowering.graph, &parts))
    }
}

/// Returns the components of a tuple, which has to have as many as the domain has coordinates.
fn components(tuple: &Tuple, domain: Domain, role: Role) -> Result<Vec<&Expr>, Diagnostic> {
    let (count, expected) = (tuple.components.len(), domain.coordinates().len());
    if count == expected {
        return Ok(tuple.components.iter().collect());
    }
    let (domain, coordinates) = (domain.keyword(), domain.tuple());
    let kind = RegionKind::WrongComponentCount { role, domain, expected, count, coordinates };
    Err(Diagnostic::new(tuple.span, kind))
}

/// Returns the two components of a point of a tool.
pub(super) fn pair(tuple: &Tuple, role: Role) -> Result<[&Expr; 2], Diagnostic> {
    components(tuple, Domain::HalfPlane, role).map(|_| [&tuple.components[0], &tuple.components[1]])
}

/// A niceness law of a mounted file, in that file's own names, unit and frame.
pub(super) struct MountedNiceness {
    pub(super) lowering: Lowering,
    pub(super) value: Expr,
    pub(super) rising: bool,
}

impl MountedNiceness {
    /// Lowers the law at a point of the whole tool with the given depth.
    fn lower(&self, graph: &mut Graph, depth: Id) -> Result<Niceness, Diagnostic> {
        self.lowering.clone().on(graph, |lowering| {
            let depth = lowering.length_here(depth);
            let value = quantity(lowering, &self.value, Allowed::Depth(depth))?;
            Ok(Niceness { value, span: self.value.span, rising: self.rising })
        })
    }
}

/// A tool's laws.
pub(super) struct Laws<'t> {
    own: &'t [&'t Law],
    /// The niceness laws that come with the surfaces of mounted files, by surface.
    niceness_by_surface: BTreeMap<String, MountedNiceness>,
}

impl<'t> Laws<'t> {
    pub(super) fn new(
        own: &'t [&'t Law],
        niceness_by_surface: BTreeMap<String, MountedNiceness>,
    ) -> Laws<'t> {
        Laws { own, niceness_by_surface }
    }

    /// Returns the law for a surface: one for the surface itself, otherwise one for `cutting`, otherwise one for all
    /// surfaces.
    pub(super) fn find(&self, quantity: Quantity, surface: &Surface) -> Option<&'t Law> {
        let for_word = |word: &str| {
            self.own
                .iter()
                .filter(is(quantity))
                .find(|law| law.surfaces.iter().any(|name| name.text == word))
        };
        for_word(&surface.name)
            .or_else(|| if surface.cutting { for_word("cutting") } else { None })
            .or_else(|| self.own.iter().filter(is(quantity)).find(|law| law.surfaces.is_empty()))
            .copied()
    }

    /// Reports errors in the laws themselves. A law may be for a surface that is left out.
    pub(super) fn check(
        &self,
        surfaces: &[Surface],
        left_out: &BTreeSet<String>,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        let mut known_laws: Vec<(Quantity, &str, Span)> = Vec::new();
        for law in self.own {
            if enough(diagnostics) {
                return;
            }
            let what = law.quantity.keyword();
            if law.quantity == Quantity::Niceness && law.surfaces.is_empty() {
                diagnostics.push(Diagnostic::new(law.span, RegionKind::NicenessWithoutSurface));
            }
            let words: Vec<(&str, Span)> = if law.surfaces.is_empty() {
                vec![("", law.span)]
            } else {
                law.surfaces.iter().map(|name| (name.text.as_str(), name.span)).collect()
            };
            for (word, span) in words {
                if let Some((.., first)) =
                    known_laws.iter().find(|(q, w, _)| *q == law.quantity && *w == word)
                {
                    let surface = (!word.is_empty()).then(|| word.to_owned());
                    diagnostics.push(
                        Diagnostic::new(span, RegionKind::DuplicateLaw { quantity: what, surface })
                            .with_label(*first, "first law"),
                    );
                }
                known_laws.push((law.quantity, word, span));
                let surface = surfaces.iter().find(|surface| surface.name == word);
                if word == "cutting" && !surfaces.iter().any(|surface| surface.cutting) {
                    let kind = RegionKind::NoCuttingSurface { quantity: what };
                    diagnostics.push(Diagnostic::new(span, kind));
                }
                if word.is_empty() || word == "cutting" {
                    continue;
                }
                match surface {
                    None if left_out.contains(word) => {}
                    None => {
                        let known = surfaces.iter().map(|s| s.name.as_str());
                        // The part may have been omitted from the name of a part's surface.
                        let of_part = format!(".{word}");
                        let qualified_name = known.clone().find(|name| name.ends_with(&of_part));
                        let remedy = match qualified_name.or(nearest(word, known)) {
                            Some(suggestion) => SurfaceRemedy::Similar(suggestion.to_owned()),
                            None => match (named(word, surfaces), nearest(word, ["cutting"])) {
                                (SurfaceRemedy::List(_), Some(cutting)) => {
                                    SurfaceRemedy::Similar(cutting.to_owned())
                                }
                                (named, _) => named,
                            },
                        };
                        let kind = RegionKind::UnknownSurface { name: word.to_owned(), remedy };
                        diagnostics.push(Diagnostic::new(span, kind));
                    }
                    Some(s) if law.quantity == Quantity::Niceness && !s.cutting => {
                        diagnostics.push(idle_niceness(span, s));
                    }
                    Some(_) => {}
                }
            }
        }
    }
}

/// Lists the surfaces of the mounted part with this name, or some of all surfaces if there is no such part.
fn named(word: &str, surfaces: &[Surface]) -> SurfaceRemedy {
    let of = format!("{word}.");
    let names = || surfaces.iter().map(|surface| surface.name.as_str());
    if names().any(|name| name.starts_with(&of)) {
        SurfaceRemedy::OfMount(Names::new(names().filter(|name| name.starts_with(&of))))
    } else {
        SurfaceRemedy::List(Names::new(names().take(8)))
    }
}

fn idle_niceness(span: Span, surface: &Surface) -> Diagnostic {
    Diagnostic::new(span, RegionKind::NicenessOfNonCutting { surface: surface.name.clone() })
        .with_label(surface.span, "not marked `cutting` here")
}

/// Returns a filter of laws by quantity.
fn is(quantity: Quantity) -> impl Fn(&&&Law) -> bool {
    move |law| law.quantity == quantity
}
