//! Joins several files into one profile.

use super::arguments::{self, Argument};
use super::join::{JoinError, TIP_TOLERANCE_FRACTION, highest_above, join, transformed_outline};
use super::law::Laws;
use super::lower::{Allowed, Lowering};
use super::region::{Niceness, quantity};
use super::{Outlined, Shape, constants, definitions, frame, profile, shape, unit};
use crate::diagnostic::{
    CheckKind, Diagnostic, FormattedNumber, MountChain, MountKind, Reported, Role,
};
use crate::domain::Domain;
use crate::expr::{Graph, Id};
use crate::geometry::outline::{Segment, bounding_box};
use crate::model::{Frame, Surface, Unit};
use crate::number::Number;
use crate::regionalise::check::check;
use crate::source::{Source, Sources, Span};
use crate::syntax;
use crate::syntax::tree::{Definition, Expr, Item, Law, Mount, Quantity, Tool};
use std::collections::{BTreeMap, BTreeSet};

/// The maximum number of files that a tool mounts, including those that mounted files mount.
const MAX_MOUNTS: usize = 64;

/// A file's solid in its tool's frame and unit, with its niceness laws.
pub(super) struct MountedPart {
    pub(super) outline: Vec<Segment>,
    pub(super) surfaces: Vec<Surface>,
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

/// A niceness law of a mounted file, in that file's own names, unit and frame.
pub(super) struct MountedNiceness {
    lowering: Lowering,
    value: Expr,
    rising: bool,
}

impl MountedNiceness {
    /// Lowers the law at a point of the whole tool with the given depth.
    pub(super) fn lower(&self, graph: &mut Graph, depth: Id) -> Result<Niceness, Diagnostic> {
        self.lowering.clone().on(graph, |lowering| {
            let depth = lowering.length_here(depth);
            let value = quantity(lowering, &self.value, Allowed::Depth(depth))?;
            Ok(Niceness { value, span: self.value.span, rising: self.rising })
        })
    }
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
    Ok(Outlined { outline: part.outline, surfaces: part.surfaces, niceness_by_surface, span })
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
            let given = arguments::from_mount(&mount.arguments, lowering, self.diagnostics);
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
        let shown = |[d, z]: [f64; 2]| format!("({}, {})", FormattedNumber(d), FormattedNumber(z));
        self.diagnostics.extend(check(&assembly.outline, shown));
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
        if !self.sources.may_mount(&location.1) {
            let root = self.sources.given_root().map(|root| root.display().to_string());
            return Err(Diagnostic::new(
                by,
                MountKind::OutsideRoot { file: written.to_owned(), root },
            ));
        }
        let shown = location.0.clone();
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
        arguments::report_unknown_params(tree, given, self.diagnostics);
        constants(tree, given, lowering, self.diagnostics);
        frame(tree, lowering, self.diagnostics);
        if let Some(reported) = Reported::among(&self.diagnostics[previous_count..]) {
            return Err(reported);
        }
        let mut part = match shape(tree, self.diagnostics) {
            Some(Shape::Profile(profile)) => {
                let (outline, surfaces) = profile::outline(profile, lowering, self.diagnostics)?;
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
        let cuts = |surface: usize| self.surfaces[surface].cutting;
        let (surface, end) = highest_above(&self.outline, at, cuts)?;
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
            if self.outline.iter().any(|segment| segment.surface == surface) {
                *index = Some(count);
                count += 1;
            }
        }
        for segment in &mut self.outline {
            segment.surface = new_indices[segment.surface].unwrap_or_default();
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
    let is_upside_down = other.abs() <= 1e-6 * size;
    let spindle = is_upside_down.then_some(if frame.spindle_down { '+' } else { '-' });
    Diagnostic::new(
        frame.tip_span,
        CheckKind::TipNotAtEnd { end: FormattedNumber(frame.to_file(end)), tip, spindle },
    )
}
