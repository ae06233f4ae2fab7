//! Regions: what is felt where, as they or the laws say.

use super::condition::Curves;
use super::dimension::Dimension;
use super::direction::Course;
use super::law::{Laws, idle_niceness};
use super::lower::{Lowering, May};
use super::outputs;
use crate::expr::Id;
use crate::formula::Formula;
use crate::model::{DirectionSource, Region, Said, Surface};
use crate::report::{Missing, Report, enough};
use crate::source::Span;
use crate::syntax::tree::{self, Compare, Expr, Item, Quantity, Scalar, Tool};

/// The most regions that a tool may have: more take the planner minutes.
const MOST: usize = 256;

/// All surfaces and regions.
pub(super) fn regions(
    tool: &Tool,
    laws: &Laws<'_>,
    lowering: &mut Lowering,
    curves: &mut Curves,
    reports: &mut Vec<Report>,
) -> (Vec<Surface>, Vec<Region>) {
    let written: Vec<&tree::Region> = tool
        .items
        .iter()
        .filter_map(|item| if let Item::Region(region) = item { Some(region) } else { None })
        .collect();
    if written.is_empty() {
        reports.push(
            Report::error(tool.name.span, format!("`{}` has no region", tool.name.word))
                .missing(Missing::Region)
                .help("write its outline, `profile { … }`, or `region NAME where … { depth: …; }`"),
        );
    }
    if let Some(beyond) = written.get(MOST) {
        reports.push(
            Report::error(beyond.name.span, format!("more than {MOST} regions"))
                .help("write the outline as a `profile`: its regions are derived"),
        );
        return Default::default();
    }
    let mut surfaces = Vec::new();
    let owners: Vec<usize> =
        written.iter().map(|region| surface(region, &mut surfaces, reports)).collect();
    laws.check(&surfaces, reports);
    let mut regions: Vec<Region> = Vec::new();
    for (written, owner) in written.into_iter().zip(owners) {
        if let Some(earlier) = regions.iter().find(|r| r.name == written.name.word) {
            reports.push(
                Report::error(
                    written.name.span,
                    format!("two regions are called `{}`", earlier.name),
                )
                .and(earlier.span, "the first")
                .help("give it another name"),
            );
        }
        let felt = Felt { laws, lowering, surface: &surfaces[owner] };
        regions.extend(felt.region(written, owner, curves, reports));
        if enough(reports) {
            break;
        }
    }
    (surfaces, regions)
}

/// The surface of a region: the one it names, or one of its own name.
fn surface(region: &tree::Region, surfaces: &mut Vec<Surface>, reports: &mut Vec<Report>) -> usize {
    let name = region.surface.as_ref().unwrap_or(&region.name);
    named_surface(name, region.cutting.is_some(), surfaces, reports)
}

/// The surface of a name, known or new.
pub(super) fn named_surface(
    name: &tree::Name,
    cutting: bool,
    surfaces: &mut Vec<Surface>,
    reports: &mut Vec<Report>,
) -> usize {
    if name.word == "cutting" {
        reports.push(
            Report::error(name.span, "no surface is called `cutting`")
                .help("write `as NAME cutting`"),
        );
    }
    match surfaces.iter().position(|surface| surface.name == name.word) {
        Some(at) => {
            if surfaces[at].cutting != cutting {
                let (here, there) = if cutting { ("is", "not") } else { ("is not", "is") };
                reports.push(
                    Report::error(name.span, format!("`{}` {here} cutting here", name.word))
                        .and(surfaces[at].span, format!("and {there} here"))
                        .help("all pieces of one surface agree"),
                );
            }
            at
        }
        None => {
            surfaces.push(Surface { name: name.word.clone(), cutting, span: name.span });
            surfaces.len() - 1
        }
    }
}

/// What a region is, but for what is felt in it.
pub(super) struct Bare {
    pub(super) name: String,
    pub(super) span: Span,
    pub(super) owner: usize,
    pub(super) inside: Formula,
}

/// A value, and where it is said.
pub(super) type Placed = (Id, Span);

/// A niceness, where it is said, and whether it may rise with depth.
#[derive(Clone, Copy)]
pub(super) struct Niceness {
    pub(super) value: Id,
    pub(super) span: Span,
    pub(super) rising: bool,
}

/// What a result is worth; what is wrong is noted.
pub(super) fn noted<T>(result: Result<T, Report>, reports: &mut Vec<Report>) -> Option<T> {
    result.map_err(|report| reports.push(report)).ok()
}

/// A magnitude or a niceness.
pub(super) fn quantity(lowering: &mut Lowering, value: &Expr, may: May) -> Result<Id, Report> {
    let (id, dimension) = lowering.lower(value, may)?;
    if dimension == Dimension::Angle {
        return Err(Report::error(value.span, "this is an angle")
            .help("give a number or a power of length"));
    }
    Ok(id)
}

/// Settles what one region's evaluators compute.
pub(super) struct Felt<'a> {
    pub(super) laws: &'a Laws<'a>,
    pub(super) lowering: &'a mut Lowering,
    pub(super) surface: &'a Surface,
}

impl Felt<'_> {
    /// The magnitude that a region or else the law for its surface writes; `None` if nobody does,
    /// or if it is written as `depth`. Any other is a number of its own, though depth be taken
    /// from it.
    pub(super) fn magnitude(
        &mut self,
        own: Option<&Expr>,
        depth: Id,
    ) -> Result<Option<(Id, Span)>, Report> {
        let law = self.laws.find(Quantity::Magnitude, self.surface).map(|law| &law.value);
        let Some(value) = own.or(law) else { return Ok(None) };
        let id = quantity(self.lowering, value, May::Depth(depth))?;
        let is_depth = id == depth && mention(value, Quantity::Depth.word()).is_some();
        Ok((!is_depth).then_some((id, value.span)))
    }

    /// Makes the evaluators' expressions.
    pub(super) fn finish(
        self,
        bare: Bare,
        (depth, depth_span): (Id, Span),
        (magnitude, niceness): (Option<Placed>, Niceness),
        course: Course,
    ) -> Result<Region, Report> {
        let (graph, domain) = (&mut self.lowering.graph, self.lowering.domain);
        let direction = outputs::unit(graph, course.parts, 2).ok_or_else(|| {
            Report::error(course.span, format!("the direction of {} vanishes", bare.name))
                .help("give a vector that is not 0, or `toward` a point")
        })?;
        let is_depth = magnitude.is_none();
        let (magnitude, magnitude_span) = magnitude.unwrap_or((depth, depth_span));
        let magnitudes = (magnitude, is_depth);
        let outputs = outputs::outputs(graph, domain, depth, magnitudes, direction, niceness.value);
        let said = Said { depth: depth_span, magnitude: magnitude_span, niceness: niceness.span };
        Ok(Region {
            name: bare.name,
            span: bare.span,
            surface: bare.owner,
            inside: bare.inside,
            depth,
            said,
            magnitude,
            direction,
            course: (course.parts, course.span),
            source: course.source,
            niceness: niceness.value,
            rising: niceness.rising,
            outputs,
        })
    }

    /// A region that says its own depth. Whatever is wrong with it is noted.
    fn region(
        mut self,
        written: &tree::Region,
        owner: usize,
        curves: &mut Curves,
        reports: &mut Vec<Report>,
    ) -> Option<Region> {
        let inside = inside(written, self.lowering, curves, reports);
        let known = noted(self.depth(written), reports);
        // What is said of a depth that is not known is looked at all the same.
        let any = self.lowering.domain.coordinates()[0].0;
        let depth = known.unwrap_or_else(|| (self.lowering.graph.coord(any), written.name.span));
        let (magnitude, niceness) = self.rules(written, depth.0, reports);
        let course = noted(self.course(written), reports);
        let (name, span) = (written.name.word.clone(), written.name.span);
        let bare = Bare { name, span, owner, inside: inside? };
        let course = course?.unwrap_or_else(|| Course {
            parts: self.downhill(depth.0),
            span: depth.1,
            source: DirectionSource::Derived,
        });
        known?;
        noted(self.finish(bare, depth, (magnitude?, niceness?), course), reports)
    }

    /// The magnitude and the niceness of a written region.
    pub(super) fn rules(
        &mut self,
        written: &tree::Region,
        depth: Id,
        reports: &mut Vec<Report>,
    ) -> (Option<Option<Placed>>, Option<Niceness>) {
        let magnitude = self.said(written, Quantity::Magnitude);
        let magnitude = magnitude.and_then(|own| self.magnitude(own.map(|own| &own.value), depth));
        let niceness = self.said(written, Quantity::Niceness);
        let niceness = niceness.and_then(|own| self.niceness(own, depth));
        (noted(magnitude, reports), noted(niceness, reports))
    }

    /// The region's own word on a quantity.
    pub(super) fn said<'w>(
        &self,
        written: &'w tree::Region,
        quantity: Quantity,
    ) -> Result<Option<&'w Scalar>, Report> {
        let mut all = written.scalars.iter().filter(|scalar| scalar.quantity == quantity);
        let first = all.next();
        if let (Some(first), Some(second)) = (first, all.next()) {
            return Err(Report::error(second.span, format!("`{}` is said twice", quantity.word()))
                .and(first.span, "first here")
                .help("drop one"));
        }
        Ok(first)
    }

    /// The depth: what the region says, else its magnitude.
    fn depth(&mut self, written: &tree::Region) -> Result<(Id, Span), Report> {
        let (value, by) = match self.said(written, Quantity::Depth)? {
            Some(own) => (&own.value, Quantity::Depth),
            None => match self.said(written, Quantity::Magnitude)? {
                Some(own) => (&own.value, Quantity::Magnitude),
                None => {
                    let name = &written.name;
                    return Err(Report::error(
                        name.span,
                        format!(
                            "region {} says neither `magnitude` nor `depth`, and there is no profile \
                             to take it from",
                            name.word
                        ),
                    )
                    .help("write `depth: …;` in it: 0 on the surface, positive inside"));
                }
            },
        };
        if let (Quantity::Magnitude, Some(span)) = (by, mention(value, "depth")) {
            let name = &written.name.word;
            return Err(Report::error(
                span,
                format!("`magnitude` of {name} mentions `depth`, which nothing else gives"),
            )
            .help("write `depth: …;` in the region"));
        }
        let (id, dimension) = self.lowering.lower(value, May::Coordinates)?;
        if by == Quantity::Depth && !dimension.is_length() {
            return Err(Report::error(
                value.span,
                format!("a depth is a length, this is {dimension}"),
            )
            .help("write how far it is to the surface; any power is a `magnitude:`"));
        }
        if dimension == Dimension::Angle {
            return Err(Report::error(value.span, "a magnitude is no angle")
                .help("give a number or a power of length"));
        }
        let graph = &mut self.lowering.graph;
        if graph.constant(id).is_some() {
            return Err(Report::error(value.span, "this depth is the same everywhere")
                .help("a depth is 0 on the surface and grows inward"));
        }
        Ok((id, value.span))
    }

    /// The niceness that a region or else the law for its surface writes, or else its mounted file;
    /// else 1, or 0 where nothing cuts.
    pub(super) fn niceness(&mut self, own: Option<&Scalar>, depth: Id) -> Result<Niceness, Report> {
        let nowhere = |value: Id| Niceness { value, span: self.surface.span, rising: false };
        if !self.surface.cutting {
            return match own {
                Some(own) => Err(idle_niceness(own.value.span, self.surface)),
                None => Ok(nowhere(self.lowering.graph.int(0))),
            };
        }
        let own = own.map(|own| (&own.value, own.rising));
        let law = self.laws.find(Quantity::Niceness, self.surface);
        let law = law.map(|law| (&law.value, law.rising));
        match (own.or(law), self.laws.along.get(&self.surface.name)) {
            (Some((value, rising)), _) => {
                let span = value.span;
                let value = quantity(self.lowering, value, May::Depth(depth))?;
                Ok(Niceness { value, span, rising })
            }
            (None, Some(along)) => along.lower(&mut self.lowering.graph, depth),
            (None, None) => Ok(nowhere(self.lowering.graph.int(1))),
        }
    }

    /// −∇ of the depth.
    fn downhill(&mut self, depth: Id) -> [Id; 3] {
        let (graph, domain) = (&mut self.lowering.graph, self.lowering.domain);
        outputs::gradient(graph, domain, depth).map(|part| graph.neg(part))
    }
}

/// The points that a region's conditions name. Each wrong condition is noted.
pub(super) fn inside(
    written: &tree::Region,
    lowering: &mut Lowering,
    curves: &mut Curves,
    reports: &mut Vec<Report>,
) -> Option<Formula> {
    if let Some(beyond) = written.conditions.get(MOST) {
        reports.push(
            Report::error(beyond.span, format!("more than {MOST} conditions"))
                .help("several of one kind are one, by `min` or `max`"),
        );
        return None;
    }
    let sides = written.conditions.iter();
    let sides: Vec<Option<Vec<Formula>>> =
        sides.map(|one| noted(condition(one, lowering, curves), reports)).collect();
    let sides: Option<Vec<Vec<Formula>>> = sides.into_iter().collect();
    Some(Formula::All(sides?.into_iter().flatten().collect()))
}

/// The sides of one condition: one, or two of a chain.
fn condition(
    condition: &tree::Condition,
    lowering: &mut Lowering,
    curves: &mut Curves,
) -> Result<Vec<Formula>, Report> {
    let mut sides = Vec::new();
    let mut left = lowering.lower(&condition.first, May::Coordinates)?;
    for (compare, right) in &condition.rest {
        let right = lowering.lower(right, May::Coordinates)?;
        if left.1.alike(right.1).is_none_or(|d| d == Dimension::Angle) {
            let message = format!("this compares {} with {}", left.1, right.1);
            return Err(Report::error(condition.span, message)
                .help("both sides want the same power of length; a bare number fits any"));
        }
        let graph = &mut lowering.graph;
        sides.push(match compare {
            Compare::AtMost => curves.at_most(graph, left.0, right.0),
            Compare::AtLeast => curves.at_most(graph, right.0, left.0),
        });
        left = right;
    }
    Ok(sides)
}

/// Where an expression mentions a name.
pub(super) fn mention(expr: &Expr, word: &str) -> Option<Span> {
    match &expr.kind {
        tree::ExprKind::Name(name) => (name == word).then_some(expr.span),
        tree::ExprKind::Number(..) => None,
        tree::ExprKind::Neg(inner) => mention(inner, word),
        tree::ExprKind::Binary(_, a, b) => mention(a, word).or_else(|| mention(b, word)),
        tree::ExprKind::Call(_, all) => all.iter().find_map(|part| mention(part, word)),
    }
}
