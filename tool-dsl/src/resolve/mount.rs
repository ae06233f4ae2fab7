//! Several files joined into one profile.

use super::given::{self, Given};
use super::join::{OFF_TIP, Unjoined, join, moved};
use super::law::Laws;
use super::lower::{Lowering, May};
use super::region::{Niceness, quantity};
use super::{Outlined, Shape, constants, definitions, frame, profile, shape, unit};
use crate::domain::Domain;
use crate::expr::{Graph, Id};
use crate::geometry::outline::{Segment, reach};
use crate::model::{Frame, Surface, Unit};
use crate::number::Number;
use crate::regionalise::check::check;
use crate::report::{Report, Reported, figure};
use crate::source::{Source, Sources, Span};
use crate::syntax;
use crate::syntax::tree::{Definition, Expr, Item, Law, Mount, Quantity, Tool};
use std::collections::BTreeMap;

/// The most files that a tool mounts, those of mounted files among them.
const MOST: usize = 64;

/// A file's solid in its tool's frame and its unit, and the niceness that comes along.
pub(super) struct Part {
    pub(super) outline: Vec<Segment>,
    pub(super) surfaces: Vec<Surface>,
    /// The law of each surface, whether it may rise with depth, and in which of the scopes it is written.
    niceness: Vec<Option<(usize, Expr, bool)>>,
    scopes: Vec<Scope>,
}

/// The names of a mounted file.
struct Scope {
    lowering: Lowering,
    curves: Vec<Definition>,
}

/// A niceness law of a mounted file, in that file's own names, unit and frame.
pub(super) struct Along {
    lowering: Lowering,
    value: Expr,
    rising: bool,
}

impl Along {
    /// The law at a point of the whole tool, of which this is the depth.
    pub(super) fn lower(&self, graph: &mut Graph, depth: Id) -> Result<Niceness, Report> {
        self.lowering.clone().on(graph, |lowering| {
            let depth = lowering.length_here(depth);
            let value = quantity(lowering, &self.value, May::Depth(depth))?;
            Ok(Niceness { value, span: self.value.span, rising: self.rising })
        })
    }
}

/// The one profile of mounted files, and the niceness that comes along with its surfaces.
pub(super) fn assembled(
    mounts: &[&Mount],
    span: Span,
    lowering: &mut Lowering,
    sources: &mut Sources,
    reports: &mut Vec<Report>,
) -> Result<Outlined, Reported> {
    let mut mounting = Mounting { sources, reports, chain: Vec::new(), mounted: 0, full: None };
    mounting.chain.push(mounting.sources.own().base);
    let part = mounting.assemble(mounts, lowering)?;
    let mut scopes = Vec::new();
    for mut scope in part.scopes {
        for definition in &scope.curves {
            scope.lowering.on(&mut lowering.graph, |lowering| lowering.curve(definition, reports));
        }
        scopes.push(scope.lowering);
    }
    let along = part.surfaces.iter().zip(part.niceness).filter_map(|(surface, law)| {
        let (scope, value, rising) = law?;
        Some((surface.name.clone(), Along { lowering: scopes[scope].clone(), value, rising }))
    });
    let along = along.collect();
    Ok(Outlined { outline: part.outline, surfaces: part.surfaces, along, span })
}

/// What goes on while files are mounted.
struct Mounting<'a> {
    sources: &'a mut Sources,
    reports: &'a mut Vec<Report>,
    /// The files that are being mounted, each by the one before, by where their texts begin.
    chain: Vec<usize>,
    mounted: usize,
    /// Evidence that too many files are mounted.
    full: Option<Reported>,
}

impl Mounting<'_> {
    /// The parts of a tool joined into one, in the unit of the file that mounts them.
    fn assemble(&mut self, mounts: &[&Mount], lowering: &mut Lowering) -> Result<Part, Reported> {
        let before = self.reports.len();
        let mut parts = Vec::new();
        let mut refused = None;
        for (index, mount) in mounts.iter().enumerate() {
            if let Some(first) = mounts[..index].iter().find(|m| m.name.word == mount.name.word) {
                self.reports.push(
                    Report::error(
                        mount.name.span,
                        format!("two mounts are called `{}`", mount.name.word),
                    )
                    .and(first.name.span, "the first")
                    .help("give it another name"),
                );
            }
            let at = self.place(mount, index, lowering);
            let given = given::from_mount(&mount.with, lowering, self.reports);
            let part = self.open(mount, &given, &mut lowering.graph);
            match (at, part) {
                (Ok(at), Ok((part, unit))) => {
                    parts.push((*mount, at, part.placed(mount, &unit.to(lowering.unit))));
                }
                (Err(reported), _) | (_, Err(reported)) => refused = Some(reported),
            }
        }
        if let Some(reported) = refused.or(Reported::among(&self.reports[before..])) {
            return Err(reported);
        }
        let mut parts = parts.into_iter();
        let (mut last, mut height, mut whole) = parts.next().ok_or_else(|| {
            let nothing = Report::error(lowering.frame.tip_span, "nothing is mounted");
            Reported::push(self.reports, nothing.help("write `mount \"FILE.tool\" as NAME;`"))
        })?;
        for (mount, at, part) in parts {
            whole
                .carry((last, &height), (mount, &at), part)
                .map_err(|report| Reported::push(self.reports, report))?;
            (last, height) = (mount, at);
        }
        whole.drop_what_is_gone();
        let shown = |[d, z]: [f64; 2]| format!("({}, {})", figure(d), figure(z));
        self.reports.extend(check(&whole.outline, shown));
        Reported::among(&self.reports[before..]).map_or(Ok(whole), Err)
    }

    /// Where a mount puts its tip.
    fn place(
        &mut self,
        mount: &Mount,
        index: usize,
        lowering: &mut Lowering,
    ) -> Result<Number, Reported> {
        if mount.name.word == "cutting" {
            self.reports.push(
                Report::error(mount.name.span, "no part is called `cutting`")
                    .help("give it another name"),
            );
        }
        if let Some(span) = mount.cutting {
            self.reports.push(
                Report::error(span, "a mount is not `cutting`")
                    .help("drop it: each surface of the mounted file says so for itself"),
            );
        }
        let wrong = match (index, &mount.at) {
            (0, None) => return Ok(Number::int(0)),
            (0, Some(at)) => Report::error(at.span, "the first mount keeps its place")
                .help("drop `at`: its tip is the tool's, at z = 0"),
            (_, None) => {
                let report = format!("where along the axis does `{}` begin?", mount.name.word);
                let help = "write `at z = …`, from the first mount's tip";
                Report::error(mount.span, report).help(help)
            }
            (_, Some(at)) => match lowering.length(at, "`at`") {
                Ok(height) => return Ok(height),
                Err(report) => report,
            },
        };
        Err(Reported::push(self.reports, wrong))
    }

    /// Reads and resolves a mounted file as far as its profile, and says its unit.
    fn open(
        &mut self,
        mount: &Mount,
        given: &[Given<'_>],
        graph: &mut Graph,
    ) -> Result<(Part, Unit), Reported> {
        let (base, tree) = self.read(mount)?;
        let before = self.reports.len();
        let unit = unit(&tree).map_err(|report| Reported::push(self.reports, report))?;
        let mut lowering = Lowering::of(&tree, unit);
        self.chain.push(base);
        let part = lowering.on(graph, |lowering| self.part(mount, &tree, given, lowering));
        self.chain.pop();
        let mut part = part?;
        if let Some(reported) = Reported::among(&self.reports[before..]) {
            return Err(reported);
        }
        part.scopes.push(Scope { lowering, curves: curves(&tree) });
        Ok((part, unit))
    }

    /// The tree of a mounted file, and where its text begins.
    fn read(&mut self, mount: &Mount) -> Result<(usize, Tool), Reported> {
        let source = self.source(mount).map_err(|report| Reported::push(self.reports, report))?;
        self.mounted += 1;
        if self.mounted > MOST {
            let by = mount.file.span;
            // Once is enough, however many follow.
            let report = match self.full {
                Some(reported) => Report::follow_up(by, reported),
                None => Report::error(by, format!("more than {MOST} mounted files"))
                    .help("write some of them as one file"),
            };
            let reported = Reported::push(self.reports, report);
            self.full = Some(reported);
            return Err(reported);
        }
        if !syntax::begins_a_tool(&source.text) {
            // Nothing of its text is shown: it may be any file.
            let message = format!("`{}` is not a `.tool` file", mount.file.word);
            let report = Report::error(mount.file.span, message)
                .help("a mounted file begins with `tool Name {`");
            return Err(Reported::push(self.reports, report));
        }
        let before = self.reports.len();
        let tree = syntax::parse(&source, self.reports)?;
        Reported::among(&self.reports[before..]).map_or(Ok((source.base, tree)), Err)
    }

    /// The text of a mounted file.
    fn source(&mut self, mount: &Mount) -> Result<Source, Report> {
        let (written, by) = (mount.file.word.as_str(), mount.file.span);
        let place = self.sources.beside(by, written).ok_or_else(|| {
            Report::error(by, format!("where is `{written}`? this text is from no file"))
                .help("a mounted file is looked for beside the file that mounts it")
        })?;
        if !self.sources.may_mount(&place.1) {
            let below = match self.sources.given_root() {
                Some(root) => format!("`{}`", root.display()),
                None => "the tool's folder".to_owned(),
            };
            let message = format!("`{written}` does not lie below {below}");
            return Err(Report::error(by, message).help(
                "move the file there; the program also takes a folder above both: `--root DIR`",
            ));
        }
        let shown = place.0.clone();
        let source = self.sources.read(by, place).cloned().map_err(|error| {
            Report::error(by, format!("cannot read `{shown}`: {error}"))
                .help("the path is relative to the file that mounts it")
        })?;
        let Some(first) = self.chain.iter().position(|base| *base == source.base) else {
            return Ok(source);
        };
        let name =
            |base: &usize| self.sources.locate(Span { start: *base, end: *base }).0.name.as_str();
        let mut chain: Vec<&str> = self.chain[first..].iter().map(name).collect();
        chain.push(&source.name);
        let message = format!("`{written}` mounts itself: {}", chain.join(" mounts "));
        Err(Report::error(by, message).help("mount a file that does not lead back to this one"))
    }

    /// A mounted file's solid and its niceness.
    fn part(
        &mut self,
        mount: &Mount,
        tree: &Tool,
        given: &[Given<'_>],
        lowering: &mut Lowering,
    ) -> Result<Part, Reported> {
        let before = self.reports.len();
        if tree.domain == Domain::Space {
            let file = &mount.file;
            let report =
                format!("`{}` is a solid without an axis and cannot be mounted", file.word);
            let report = Report::error(file.span, report)
                .help("only outlines can be joined: mount a `tool`");
            return Err(Reported::push(self.reports, report));
        }
        given::untaken(tree, given, self.reports);
        constants(tree, given, lowering, self.reports);
        frame(tree, lowering, self.reports);
        if let Some(reported) = Reported::among(&self.reports[before..]) {
            return Err(reported);
        }
        let mut part = match shape(tree, self.reports) {
            Some(Shape::Profile(profile)) => {
                let (outline, surfaces) = profile::outline(profile, lowering, self.reports)?;
                self.reports.extend(not_at_tip(&outline, &lowering.frame));
                let niceness = vec![None; surfaces.len()];
                Part { outline, surfaces, niceness, scopes: Vec::new() }
            }
            Some(Shape::Mounts(mounts)) => self.assemble(&mounts, lowering)?,
            None => {
                let file = &mount.file;
                let regions = tree.items.iter().any(|item| matches!(item, Item::Region(_)));
                let has = if regions { "has regions but no profile" } else { "has no profile" };
                let message = format!("`{}` {has} and cannot be mounted", file.word);
                let report = Report::error(file.span, message)
                    .help("only outlines can be joined: write it as a `profile`");
                return Err(Reported::push(self.reports, report));
            }
        };
        let laws: Vec<&Law> = tree
            .items
            .iter()
            .filter_map(|item| if let Item::Law(law) = item { Some(law) } else { None })
            .filter(|law| law.quantity == Quantity::Niceness)
            .collect();
        let laws = Laws::new(&laws, BTreeMap::new());
        laws.check(&part.surfaces, self.reports);
        let own = part.scopes.len();
        for (surface, niceness) in part.surfaces.iter().zip(&mut part.niceness) {
            if let Some(law) = laws.find(Quantity::Niceness, surface).filter(|_| surface.cutting) {
                *niceness = Some((own, law.value.clone(), law.rising));
            }
        }
        Ok(part)
    }
}

/// The curves of a file, of which its laws may speak.
fn curves(tree: &Tool) -> Vec<Definition> {
    definitions(tree, |item| matches!(item, Item::Curve(_))).cloned().collect()
}

/// A solid that does not end at its tip.
fn not_at_tip(outline: &[Segment], frame: &Frame) -> Option<Report> {
    let [[_, end], [radius, high]] = reach(outline);
    let off = end.abs() > OFF_TIP * radius.max(high - end);
    off.then(|| off_tip(frame, [end, high]))
}

impl Part {
    /// The part under its name and in the unit of the file that mounts it.
    fn placed(mut self, mount: &Mount, scale: &Number) -> Part {
        let zero = Number::int(0);
        self.outline = moved(&self.outline, scale, &zero, 0);
        self.raised(scale, &zero);
        for surface in &mut self.surfaces {
            surface.name = format!("{}.{}", mount.name.word, surface.name);
        }
        self
    }

    /// Lets the laws know where their part has gone.
    fn raised(&mut self, scale: &Number, by: &Number) {
        for scope in &mut self.scopes {
            scope.lowering.placed(scale, by);
        }
    }

    /// Puts another part on this one, from a plane on.
    fn carry(
        &mut self,
        (last, height): (&Mount, &Number),
        (mount, at): (&Mount, &Number),
        mut part: Part,
    ) -> Result<(), Report> {
        let span = mount.at.as_ref().map_or(mount.span, |at| at.span);
        let (name, below, z) = (&mount.name.word, &last.name.word, figure(at.to_f64()));
        if at <= height {
            let there = figure(height.to_f64());
            return Err(Report::error(
                span,
                format!("`{name}` at z = {z} does not lie above `{below}` at z = {there}"),
            )
            .help("mounts are listed from the tip up"));
        }
        let first = self.surfaces.len();
        let upper = moved(&part.outline, &Number::int(1), at, first);
        self.outline = join(&self.outline, &upper, at).map_err(|why| match why {
            Unjoined::Short => {
                let [_, [_, top]] = reach(&self.outline);
                let (long, top) = (figure(top - height.to_f64()), figure(top));
                let message = if height.is_zero() {
                    format!("`{below}` is {long} long and cannot stick out {z}")
                } else {
                    format!("`{below}` ends at z = {top} and does not reach z = {z}")
                };
                Report::error(span, message)
                    .and(last.name.span, "this one")
                    .help(format!("put it at z = {top} or below, or make `{below}` longer"))
            }
            Unjoined::Point => {
                Report::error(span, format!("`{below}` comes to a point at z = {z}"))
                    .help("put the plane where there is something to hold")
            }
            Unjoined::Back(segment) => {
                Report::error(span, format!("the plane z = {z} cuts `{below}` more than once"))
                    .and(segment.span, "here it comes back to it")
                    .help("put the plane where the profile crosses it once")
            }
            Unjoined::NoFace(segment) => Report::error(
                mount.file.span,
                format!("the first segment of `{}` is not a flat face", mount.file.word),
            )
            .and(segment.span, "this one")
            .help("what is mounted on another part begins with a face across the axis"),
        })?;
        part.raised(&Number::int(1), at);
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

    /// Forgets the surfaces of which nothing is left.
    fn drop_what_is_gone(&mut self) {
        let mut left = vec![None; self.surfaces.len()];
        let mut count = 0;
        for (surface, place) in left.iter_mut().enumerate() {
            if self.outline.iter().any(|segment| segment.surface == surface) {
                *place = Some(count);
                count += 1;
            }
        }
        for segment in &mut self.outline {
            segment.surface = left[segment.surface].unwrap_or_default();
        }
        let mut kept = left.iter().map(Option::is_some);
        self.surfaces.retain(|_| kept.next().unwrap_or_default());
        let mut kept = left.iter().map(Option::is_some);
        self.niceness.retain(|_| kept.next().unwrap_or_default());
    }
}

/// A tool that ends at a z which is not its tip; its other end may be.
pub(crate) fn off_tip(frame: &Frame, [end, other]: [f64; 2]) -> Report {
    let size = other - end;
    let said = frame.tip.to_f64();
    let message = format!(
        "the tool ends at z = {} and its tip is said to be at {}",
        figure(frame.to_file(end)),
        figure(said)
    );
    let report = Report::error(frame.tip_span, message);
    if other.abs() <= 1e-6 * size {
        let way = if frame.down { '+' } else { '-' };
        return report.help(format!("its other end is there: write `spindle {way}z;`"));
    }
    report.help(format!("write `tip z = {};`", figure(frame.to_file(end))))
}
