//! Joins several files into one profile: each outline onto the one below it at a plane, with the ring between them.

use super::lower::Lowering;
use super::profile::{self, Outline};
use super::region::{Laws, MountedNiceness};
use super::scope::{self, Argument};
use super::{Outlined, Shape, constants, definitions, frame, shape, unit};
use crate::diagnostic::{
    CheckKind, Diagnostic, FormattedNumber, MountChain, MountKind, Reported, Role,
};
use crate::domain::Domain;
use crate::expr::Graph;
use crate::geometry::outline::{ExactCircle, ExactPoint, Segment, bounding_box, doubles};
use crate::model::{Frame, Surface, Unit};
use crate::number::Number;
use crate::regionalise::check::check;
use crate::source::{Source, Sources, Span};
use crate::syntax;
use crate::syntax::tree::{Definition, Expr, Item, Law, Mount, Quantity, Tool};
use std::collections::{BTreeMap, BTreeSet};

/// The part of a tool's length within which its other end is taken for the tip, in a remedy.
const AT_TIP_FRACTION: f64 = 1e-6;

/// The maximum number of files that a tool mounts, including those that mounted files mount.
const MAX_MOUNTS: usize = 64;

/// A file's solid in its tool's frame and unit, with its niceness laws.
struct MountedPart {
    outline: Vec<Segment>,
    surfaces: Vec<Surface>,
    /// The law of each surface: the index of the scope in which it is written, its expression, and whether it may rise
    /// with depth.
    niceness: Vec<Option<(usize, Expr, bool)>>,
    scopes: Vec<Scope>,
    /// The surfaces that its file leaves out.
    left_out: BTreeSet<String>,
}

/// The names of a mounted file.
struct Scope {
    lowering: Lowering,
    curves: Vec<Definition>,
}

/// Returns the profile of the joined files, and the niceness laws that come with its surfaces.
pub(super) fn assemble_mounts(
    mounts: &[&Mount],
    span: Span,
    lowering: &mut Lowering,
    sources: &mut Sources,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<Outlined, Reported> {
    let mut mounting = Mounting { sources, diagnostics, chain: Vec::new(), mounted: 0, full: None };
    mounting.chain.push(mounting.sources.main().base);
    let part = mounting.assemble(mounts, lowering)?;
    let mut scopes = Vec::new();
    for mut scope in part.scopes {
        for definition in &scope.curves {
            scope
                .lowering
                .on(&mut lowering.graph, |lowering| lowering.curve(definition, diagnostics));
        }
        scopes.push(scope.lowering);
    }
    let niceness_by_surface =
        part.surfaces.iter().zip(part.niceness).filter_map(|(surface, law)| {
            let (scope, value, rising) = law?;
            Some((
                surface.name.clone(),
                MountedNiceness { lowering: scopes[scope].clone(), value, rising },
            ))
        });
    let niceness_by_surface = niceness_by_surface.collect();
    let outline = Outline { segments: part.outline, surfaces: part.surfaces, span };
    Ok(Outlined { outline, niceness_by_surface })
}

/// The state of mounting files.
struct Mounting<'a> {
    sources: &'a mut Sources,
    diagnostics: &'a mut Vec<Diagnostic>,
    /// The files being mounted, each by the one before, identified by the offsets of their texts.
    chain: Vec<usize>,
    mounted: usize,
    /// Evidence that too many files are mounted.
    full: Option<Reported>,
}

impl Mounting<'_> {
    /// Joins the parts of a tool into one, in the unit of the file that mounts them.
    fn assemble(
        &mut self,
        mounts: &[&Mount],
        lowering: &mut Lowering,
    ) -> Result<MountedPart, Reported> {
        let previous_count = self.diagnostics.len();
        let mut parts = Vec::new();
        let mut reported_error = None;
        for (index, mount) in mounts.iter().enumerate() {
            if let Some(first) = mounts[..index].iter().find(|m| m.name.text == mount.name.text) {
                self.diagnostics.push(
                    Diagnostic::new(
                        mount.name.span,
                        MountKind::DuplicateMount { name: mount.name.text.clone() },
                    )
                    .with_label(first.name.span, "first mount of this name"),
                );
            }
            let at = self.mount_height(mount, index, lowering);
            let given = scope::arguments_of_mount(&mount.arguments, lowering, self.diagnostics);
            let part = self.resolve_mount(mount, &given, &mut lowering.graph);
            match (at, part) {
                (Ok(at), Ok((part, unit))) => {
                    let names = part.left_out.iter();
                    lowering
                        .left_out
                        .extend(names.map(|name| format!("{}.{name}", mount.name.text)));
                    parts.push((
                        *mount,
                        at,
                        part.scaled_and_named(mount, &unit.factor_to(lowering.unit)),
                    ));
                }
                (Err(reported), _) | (_, Err(reported)) => reported_error = Some(reported),
            }
        }
        if let Some(reported) =
            reported_error.or(Reported::among(&self.diagnostics[previous_count..]))
        {
            return Err(reported);
        }
        let mut parts = parts.into_iter();
        let (mut last, mut height, mut assembly) = parts.next().ok_or_else(|| {
            let nothing = Diagnostic::new(lowering.frame.tip_span, MountKind::NoMount);
            Reported::push(self.diagnostics, nothing)
        })?;
        for (mount, at, part) in parts {
            self.diagnostics.extend(assembly.clamped_edge(mount, &at, &part));
            assembly
                .join_part(last, &height, mount, &at, part)
                .map_err(|diagnostic| Reported::push(self.diagnostics, diagnostic))?;
            (last, height) = (mount, at);
        }
        assembly.drop_unused_surfaces();
        self.diagnostics.extend(check(&assembly.outline, |[d, z]| {
            format!("({}, {})", FormattedNumber(d), FormattedNumber(z))
        }));
        Reported::among(&self.diagnostics[previous_count..]).map_or(Ok(assembly), Err)
    }

    /// Returns the z at which a mount places its part's tip.
    fn mount_height(
        &mut self,
        mount: &Mount,
        index: usize,
        lowering: &mut Lowering,
    ) -> Result<Number, Reported> {
        if mount.name.text == "cutting" {
            self.diagnostics.push(Diagnostic::new(mount.name.span, MountKind::MountCalledCutting));
        }
        if let Some(span) = mount.cutting {
            self.diagnostics.push(Diagnostic::new(span, MountKind::CuttingMount));
        }
        let wrong = match (index, &mount.position) {
            (0, None) => return Ok(Number::int(0)),
            (0, Some(at)) => Diagnostic::new(at.span, MountKind::FirstMountWithPosition),
            (_, None) => {
                Diagnostic::new(mount.span, MountKind::NoPosition { name: mount.name.text.clone() })
            }
            (_, Some(at)) => match lowering.length(at, Role::At) {
                Ok(height) => return Ok(height),
                Err(diagnostic) => diagnostic,
            },
        };
        Err(Reported::push(self.diagnostics, wrong))
    }

    /// Reads a mounted file and resolves it up to its profile. Returns its part and its unit.
    fn resolve_mount(
        &mut self,
        mount: &Mount,
        arguments: &[Argument<'_>],
        graph: &mut Graph,
    ) -> Result<(MountedPart, Unit), Reported> {
        let (base, tree) = self.read(mount)?;
        let previous_count = self.diagnostics.len();
        let unit =
            unit(&tree).map_err(|diagnostic| Reported::push(self.diagnostics, diagnostic))?;
        let mut lowering = Lowering::of(&tree, unit);
        self.chain.push(base);
        let part = lowering.on(graph, |lowering| self.part(mount, &tree, arguments, lowering));
        self.chain.pop();
        let mut part = part?;
        if let Some(reported) = Reported::among(&self.diagnostics[previous_count..]) {
            return Err(reported);
        }
        part.left_out = std::mem::take(&mut lowering.left_out);
        part.scopes.push(Scope { lowering, curves: curves(&tree) });
        Ok((part, unit))
    }

    /// Returns the syntax tree of a mounted file, and the offset of its text.
    fn read(&mut self, mount: &Mount) -> Result<(usize, Tool), Reported> {
        let source = self
            .source(mount)
            .map_err(|diagnostic| Reported::push(self.diagnostics, diagnostic))?;
        self.mounted += 1;
        if self.mounted > MAX_MOUNTS {
            let by = mount.file.span;
            // Reported only once, however many mounts follow.
            let diagnostic = Diagnostic::new(by, MountKind::TooManyMounts { limit: MAX_MOUNTS });
            let diagnostic = match self.full {
                Some(reported) => diagnostic.caused_by(reported),
                None => diagnostic,
            };
            let reported = Reported::push(self.diagnostics, diagnostic);
            self.full = Some(reported);
            return Err(reported);
        }
        if !syntax::begins_a_tool(&source.text) {
            // The message shows none of the file's text, since it may be any file.
            let diagnostic = Diagnostic::new(
                mount.file.span,
                MountKind::NotATool { file: mount.file.text.clone() },
            );
            return Err(Reported::push(self.diagnostics, diagnostic));
        }
        let previous_count = self.diagnostics.len();
        let tree = syntax::parse(&source, self.diagnostics)?;
        Reported::among(&self.diagnostics[previous_count..]).map_or(Ok((source.base, tree)), Err)
    }

    /// Returns the text of a mounted file.
    fn source(&mut self, mount: &Mount) -> Result<Source, Diagnostic> {
        let (written, by) = (mount.file.text.as_str(), mount.file.span);
        let location = self
            .sources
            .resolve_path(by, written)
            .ok_or_else(|| Diagnostic::new(by, MountKind::NoFolder { file: written.to_owned() }))?;
        if !self.sources.may_mount(&location.path) {
            let root = self.sources.given_root().map(|root| match root.as_os_str().is_empty() {
                true => ".".to_owned(),
                false => root.display().to_string(),
            });
            return Err(Diagnostic::new(
                by,
                MountKind::OutsideRoot { file: written.to_owned(), root },
            ));
        }
        let shown = location.shown.clone();
        let source = self.sources.read(by, location).cloned().map_err(|error| {
            Diagnostic::new(by, MountKind::Unreadable { file: shown, error: error.to_string() })
        })?;
        let Some(first) = self.chain.iter().position(|base| *base == source.base) else {
            return Ok(source);
        };
        let name =
            |base: &usize| self.sources.locate(Span { start: *base, end: *base }).0.name.clone();
        let mut chain: Vec<String> = self.chain[first..].iter().map(name).collect();
        chain.push(source.name.clone());
        Err(Diagnostic::new(
            by,
            MountKind::MountCycle { file: written.to_owned(), chain: MountChain(chain) },
        ))
    }

    /// Returns a mounted file's solid with its niceness laws.
    fn part(
        &mut self,
        mount: &Mount,
        tree: &Tool,
        given: &[Argument<'_>],
        lowering: &mut Lowering,
    ) -> Result<MountedPart, Reported> {
        let previous_count = self.diagnostics.len();
        if tree.domain == Domain::Space {
            let file = &mount.file;
            let diagnostic = Diagnostic::new(
                file.span,
                MountKind::MountedSolid { file: mount.file.text.clone() },
            );
            return Err(Reported::push(self.diagnostics, diagnostic));
        }
        scope::report_unknown_params(tree, given, self.diagnostics);
        constants(tree, given, lowering, self.diagnostics);
        frame(tree, lowering, self.diagnostics);
        if let Some(reported) = Reported::among(&self.diagnostics[previous_count..]) {
            return Err(reported);
        }
        let mut part = match shape(tree, self.diagnostics) {
            Some(Shape::Profile(profile)) => {
                let Outline { segments: outline, surfaces, .. } =
                    profile::outline(profile, lowering, self.diagnostics)?;
                self.diagnostics.extend(check_tip(&outline, &lowering.frame));
                let niceness = vec![None; surfaces.len()];
                MountedPart {
                    outline,
                    surfaces,
                    niceness,
                    scopes: Vec::new(),
                    left_out: BTreeSet::new(),
                }
            }
            Some(Shape::Mounts(mounts)) => self.assemble(&mounts, lowering)?,
            None => {
                let file = &mount.file;
                let regions = tree.items.iter().any(|item| matches!(item, Item::Region(_)));
                let diagnostic = Diagnostic::new(
                    file.span,
                    MountKind::NoMountedProfile { file: mount.file.text.clone(), regions },
                );
                return Err(Reported::push(self.diagnostics, diagnostic));
            }
        };
        let laws: Vec<&Law> = tree
            .items
            .iter()
            .filter_map(|item| if let Item::Law(law) = item { Some(law) } else { None })
            .filter(|law| law.quantity == Quantity::Niceness)
            .collect();
        let laws = Laws::new(&laws, BTreeMap::new());
        laws.check(&part.surfaces, &lowering.left_out, self.diagnostics);
        let own = part.scopes.len();
        for (surface, niceness) in part.surfaces.iter().zip(&mut part.niceness) {
            if let Some(law) = laws.find(Quantity::Niceness, surface).filter(|_| surface.cutting) {
                *niceness = Some((own, law.value.clone(), law.allow_rising));
            }
        }
        Ok(part)
    }
}

/// Returns the curves of a file, which its laws may mention.
fn curves(tree: &Tool) -> Vec<Definition> {
    definitions(tree, |item| matches!(item, Item::Curve(_))).cloned().collect()
}

/// Returns an error if a solid does not end at its tip.
fn check_tip(outline: &[Segment], frame: &Frame) -> Option<Diagnostic> {
    let [[_, end], [radius, high]] = bounding_box(outline);
    let is_off = end.abs() > TIP_TOLERANCE_FRACTION * radius.max(high - end);
    is_off.then(|| off_tip(frame, [end, high]))
}

impl MountedPart {
    /// Returns the part under the mount's name and in the unit of the mounting file.
    fn scaled_and_named(mut self, mount: &Mount, scale: &Number) -> MountedPart {
        let zero = Number::int(0);
        self.outline = transformed_outline(&self.outline, scale, &zero, 0);
        self.transform_scopes(scale, &zero);
        for surface in &mut self.surfaces {
            surface.name = format!("{}.{}", mount.name.text, surface.name);
        }
        self
    }

    /// Updates the laws' frames after their part was scaled and moved.
    fn transform_scopes(&mut self, scale: &Number, by: &Number) {
        for scope in &mut self.scopes {
            scope.lowering.transform(scale, by);
        }
    }

    /// Returns a warning if a part that does not cut begins below the end of a cutting surface.
    fn clamped_edge(&self, mount: &Mount, at: &Number, part: &MountedPart) -> Option<Diagnostic> {
        if part.surfaces.iter().any(|surface| surface.cutting) {
            return None;
        }
        let (surface, end) =
            highest_above(&self.outline, at, |surface| self.surfaces[surface].cutting)?;
        let kind = MountKind::ClampedEdge {
            name: mount.name.text.clone(),
            z: FormattedNumber(at.to_f64()),
            surface: self.surfaces[surface].name.clone(),
            end: FormattedNumber(end),
        };
        Some(Diagnostic::new(mount.position.as_ref().map_or(mount.span, |at| at.span), kind))
    }

    /// Joins another part onto this one at a plane.
    fn join_part(
        &mut self,
        last: &Mount,
        height: &Number,
        mount: &Mount,
        at: &Number,
        mut part: MountedPart,
    ) -> Result<(), Diagnostic> {
        let span = mount.position.as_ref().map_or(mount.span, |at| at.span);
        let (below, z) = (last.name.text.clone(), FormattedNumber(at.to_f64()));
        if at <= height {
            return Err(Diagnostic::new(
                span,
                MountKind::NotAbove {
                    name: mount.name.text.clone(),
                    z,
                    previous: below,
                    previous_z: FormattedNumber(height.to_f64()),
                },
            ));
        }
        let first = self.surfaces.len();
        let upper = transformed_outline(&part.outline, &Number::int(1), at, first);
        self.outline = join(&self.outline, &upper, at).map_err(|why| match why {
            JoinError::Short => {
                let [_, [_, top]] = bounding_box(&self.outline);
                let (length, top) = (FormattedNumber(top - height.to_f64()), FormattedNumber(top));
                Diagnostic::new(
                    span,
                    MountKind::TooShort { name: below, z, top, length, first: height.is_zero() },
                )
                .with_label(last.name.span, "lower tool")
            }
            JoinError::Point => {
                Diagnostic::new(span, MountKind::ZeroRadiusAtPlane { name: below, z })
            }
            JoinError::Back(segment) => {
                Diagnostic::new(span, MountKind::PlaneCutsTwice { name: below, z })
                    .with_label(segment.span, "second crossing")
            }
            JoinError::NoFace(segment) => Diagnostic::new(
                mount.file.span,
                MountKind::NoFlatFace { file: mount.file.text.clone() },
            )
            .with_label(segment.span, "first segment"),
        })?;
        part.transform_scopes(&Number::int(1), at);
        let scopes = self.scopes.len();
        self.surfaces.extend(part.surfaces);
        self.niceness.extend(
            part.niceness
                .into_iter()
                .map(|law| law.map(|(scope, value, rising)| (scope + scopes, value, rising))),
        );
        self.scopes.extend(part.scopes);
        Ok(())
    }

    /// Removes surfaces of which no segment is left.
    fn drop_unused_surfaces(&mut self) {
        let mut new_indices = vec![None; self.surfaces.len()];
        let mut count = 0;
        for (surface, index) in new_indices.iter_mut().enumerate() {
            if self.outline.iter().any(|segment| segment.geometry.surface == surface) {
                *index = Some(count);
                count += 1;
            }
        }
        for segment in &mut self.outline {
            let surface = &mut segment.geometry.surface;
            *surface = new_indices[*surface].unwrap_or_default();
        }
        let mut is_kept = new_indices.iter().map(Option::is_some);
        self.surfaces.retain(|_| is_kept.next().unwrap_or_default());
        let mut is_kept = new_indices.iter().map(Option::is_some);
        self.niceness.retain(|_| is_kept.next().unwrap_or_default());
    }
}

/// Returns the error for a tool whose end is at a z other than its tip; the opposite end may be at the tip.
pub(crate) fn off_tip(frame: &Frame, [end, other]: [f64; 2]) -> Diagnostic {
    let size = other - end;
    let tip = FormattedNumber(frame.tip.to_f64());
    let is_upside_down = other.abs() <= AT_TIP_FRACTION * size;
    let spindle = is_upside_down.then_some(if frame.spindle_down { '+' } else { '-' });
    Diagnostic::new(
        frame.tip_span,
        CheckKind::TipNotAtEnd { end: FormattedNumber(frame.to_file(end)), tip, spindle },
    )
}

/// Lengths below this fraction of the tool's size are rounding errors.
const ROUNDING: f64 = 1e-12;
/// The largest distance of a tool's end from its stated tip, in sizes of the tool.
const TIP_TOLERANCE_FRACTION: f64 = 1e-6;

/// The reason why two outlines cannot be joined at a plane.
#[derive(Debug)]
enum JoinError {
    /// The lower outline ends below the plane.
    Short,
    /// The lower outline meets the axis at the plane.
    Point,
    /// The lower outline crosses the plane again, with this segment.
    Back(Box<Segment>),
    /// The upper outline begins not with a flat face but with this segment.
    NoFace(Box<Segment>),
}

/// Returns an outline with its lengths multiplied by `scale`, then moved along the axis by `by`. Surface indices are
/// increased by `first`.
fn transformed_outline(
    outline: &[Segment],
    scale: &Number,
    by: &Number,
    first: usize,
) -> Vec<Segment> {
    let transformed = |[d, z]: &ExactPoint| [d * scale, &(z * scale) + by];
    let segments = outline.iter().map(|segment| {
        let circle = segment.circle.as_ref().map(|circle| ExactCircle {
            centre: transformed(&circle.centre),
            radius: &circle.radius * scale,
            convex: circle.convex,
        });
        let ends = [transformed(&segment.from), transformed(&segment.to)];
        Segment::new(ends, circle, segment.geometry.surface + first, segment.span)
    });
    segments.collect()
}

/// Returns the outline of the solid `lower` below a plane across the axis and of the solid `upper` above it. `upper`
/// has to begin at the plane. The ring between their radii at the plane belongs to the wider solid.
///
/// # Errors
///
/// If `lower` does not cross the plane exactly once away from the axis, or if `upper` has no flat face there.
fn join(lower: &[Segment], upper: &[Segment], plane: &Number) -> Result<Vec<Segment>, JoinError> {
    let slack = ROUNDING * size(lower).max(size(upper));
    let mut joined = below(lower, plane, slack)?;
    let Some(last) = joined.last() else { return Err(JoinError::Short) };
    let (radius, ring) = (last.to[0].clone(), (last.geometry.surface, last.span));
    if radius.to_f64() <= slack {
        return Err(JoinError::Point);
    }
    let (height, off_tip) = (plane.to_f64(), TIP_TOLERANCE_FRACTION * size(upper));
    let faces = upper
        .iter()
        .take_while(|segment| {
            let [[inner, a], [outer, b]] = segment.geometry.ends;
            let level = [a, b].into_iter().all(|z| (z - height).abs() <= off_tip);
            segment.circle.is_none() && level && inner < outer
        })
        .count();
    let (face, rest) = upper.split_at(faces);
    let (Some(rim), Some((wall, rest))) = (face.last(), rest.split_first()) else {
        return Err(JoinError::NoFace(Box::new(upper.first().unwrap_or(last).clone())));
    };
    let on_plane = |d: &Number| [d.clone(), plane.clone()];
    let mut at = on_plane(&radius);
    let (inner, outer) = (radius.to_f64(), rim.to[0].to_f64());
    if inner > outer + slack {
        let to = on_plane(&rim.to[0]);
        joined.push(Segment::new([at, to.clone()], None, ring.0, ring.1));
        at = to;
    }
    for segment in face.iter().filter(|segment| segment.to[0].to_f64() > inner + slack) {
        let to = on_plane(&segment.to[0]);
        joined.push(Segment::new([at, to.clone()], None, segment.geometry.surface, segment.span));
        at = to;
    }
    let ends = [at, wall.to.clone()];
    joined.push(Segment::new(ends, wall.circle.clone(), wall.geometry.surface, wall.span));
    joined.extend(rest.iter().cloned());
    Ok(joined)
}

/// Returns the surface that rises highest above a plane, and the height of its end, among those for which `counts` holds.
fn highest_above(
    outline: &[Segment],
    plane: &Number,
    counts: impl Fn(usize) -> bool,
) -> Option<(usize, f64)> {
    let slack = ROUNDING * size(outline);
    outline
        .iter()
        .filter(|segment| counts(segment.geometry.surface))
        .map(|segment| (segment.geometry.surface, segment.geometry.ends[1][1]))
        .filter(|(_, end)| *end > plane.to_f64() + slack)
        .max_by(|a, b| a.1.total_cmp(&b.1))
}

fn size(outline: &[Segment]) -> f64 {
    let ends = outline.iter().flat_map(|segment| segment.geometry.ends);
    ends.flatten().fold(0.0, |size, part| size.max(part.abs()))
}

/// Returns the part of an outline up to a plane, which it has to cross exactly once.
fn below(outline: &[Segment], plane: &Number, slack: f64) -> Result<Vec<Segment>, JoinError> {
    let height = plane.to_f64();
    let side = |z: f64| match z - height {
        off if off.abs() <= slack => 0,
        off if off < 0.0 => -1,
        _ => 1,
    };
    let mut lower_outline: Vec<Segment> = Vec::new();
    let mut reached = false;
    for segment in outline {
        let turning_heights = turning_heights(segment);
        if reached {
            if turning_heights.iter().any(|z| side(*z) < 0) {
                return Err(JoinError::Back(Box::new(segment.clone())));
            }
            continue;
        }
        match turning_heights.iter().position(|z| side(*z) >= 0) {
            None => lower_outline.push(segment.clone()),
            // The plane goes through the first corner of the outline, so nothing lies below it.
            Some(0) => return Err(JoinError::Point),
            Some(stop) => {
                if turning_heights[stop..].iter().any(|z| side(*z) < 0) {
                    return Err(JoinError::Back(Box::new(segment.clone())));
                }
                let at_end = stop + 1 == turning_heights.len() && side(turning_heights[stop]) == 0;
                let d = if at_end { segment.to[0].clone() } else { crossing(segment, plane) };
                let ends = [segment.from.clone(), [d, plane.clone()]];
                let circle = segment.circle.clone();
                lower_outline.push(Segment::new(
                    ends,
                    circle,
                    segment.geometry.surface,
                    segment.span,
                ));
                reached = true;
            }
        }
    }
    if reached { Ok(lower_outline) } else { Err(JoinError::Short) }
}

/// Returns the z of a segment's ends and, between them, the z at which an arc reverses along the axis.
fn turning_heights(segment: &Segment) -> Vec<f64> {
    let [from, to] = segment.geometry.ends.map(|end| end[1]);
    let turns = segment.circle.as_ref().and_then(|circle| {
        let ([_, centre], radius) = (doubles(&circle.centre), circle.radius.to_f64());
        [centre - radius, centre + radius].into_iter().find(|z| {
            let strictly = [from, to].iter().all(|end| (end - z).abs() > ROUNDING * radius);
            let point = [doubles(&circle.centre)[0], *z];
            strictly && segment.geometry.sector(point).iter().all(|side| *side > 0.0)
        })
    });
    [Some(from), turns, Some(to)].into_iter().flatten().collect()
}

/// Returns the distance from the axis at which a segment rises through a plane.
fn crossing(segment: &Segment, plane: &Number) -> Number {
    let [[d, z], [to_d, to_z]] = [&segment.from, &segment.to];
    match &segment.circle {
        None => {
            let part = (plane - z).checked_div(&(to_z - z)).unwrap_or_else(|| Number::int(0));
            d + &(&part * &(to_d - d))
        }
        Some(circle) => {
            let height = plane - &circle.centre[1];
            let square = &(&circle.radius * &circle.radius) - &(&height * &height);
            let offset = square.sqrt().unwrap_or_else(|| Number::int(0));
            // The material is on the left, which is toward the axis where the outline rises.
            let offset = if circle.convex { offset } else { -&offset };
            &circle.centre[0] + &offset
        }
    }
}
