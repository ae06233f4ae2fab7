//! The syntax tree to the model: names, dimensions, the frame, each region's rules.

mod call;
mod condition;
mod cycle;
mod derived;
mod dimension;
mod direction;
mod given;
mod join;
mod law;
mod lower;
mod mount;
mod outputs;
mod over;
mod profile;
mod region;
mod scope;

pub(crate) use mount::off_tip;
pub(crate) use over::never_wins;

use crate::domain::Domain;
use crate::geometry::outline::Segment;
use crate::model::{Model, Surface, Unit};
use crate::report::{Missing, Report, Reported, enough, nearest};
use crate::source::{Sources, Span};
use crate::syntax::tree::{Definition, Expr, Item, Law, Mount, Name, Profile, Region, Tool};
use condition::Curves;
use derived::FromProfile;
use given::Given;
use law::Laws;
use lower::{Lowering, in_range};
use mount::Along;
use over::Divider;
use std::collections::BTreeMap;

/// Resolves a tool with what its params are given; the files that it mounts are read on the way.
/// Fails only with an error among the reports, and never succeeds with one that it adds.
pub fn resolve(
    tool: &Tool,
    given: &[Definition],
    sources: &mut Sources,
    reports: &mut Vec<Report>,
) -> Result<Model, Reported> {
    let unit = unit(tool).map_err(|report| Reported::push(reports, report))?;
    let mut lowering = Lowering::of(tool, unit);
    let given = given::from_outside(given, (tool.domain, unit), reports);
    given::untaken(tool, &given, reports);
    constants(tool, &given, &mut lowering, reports);
    let misplaced = match tool.domain {
        Domain::Space => without_axis(tool, reports),
        Domain::HalfPlane => None,
    };
    frame(tool, &mut lowering, reports);
    for definition in definitions(tool, |item| matches!(item, Item::Curve(_))) {
        lowering.curve(definition, reports);
        if enough(reports)
            && let Some(reported) = Reported::among(reports)
        {
            return Err(reported);
        }
    }
    let mut curves = Curves::default();
    for definition in definitions(tool, |item| matches!(item, Item::Curve(_))) {
        if let Some(value) = lowering.values.get(&definition.name.word) {
            curves.name(&definition.name.word, value.id);
        }
    }
    let laws: Vec<&Law> = tool
        .items
        .iter()
        .filter_map(|item| if let Item::Law(law) = item { Some(law) } else { None })
        .collect();
    let shape = if misplaced.is_some() { None } else { shape(tool, reports) };
    let outlined = shape.map(|shape| match shape {
        Shape::Profile(profile) => {
            let outline = profile::outline(profile, &mut lowering, reports);
            outline.map(|(outline, surfaces)| Outlined {
                outline,
                surfaces,
                along: BTreeMap::new(),
                span: profile.span,
            })
        }
        Shape::Mounts(mounts) => {
            mount::assembled(&mounts, tool.name.span, &mut lowering, sources, reports)
        }
    });
    let mut without_shape = misplaced;
    let FromProfile { surfaces, regions, section } = match outlined {
        Some(Ok(Outlined { outline, surfaces, along, span })) => {
            let laws = Laws::new(&laws, along);
            let whole = (outline, surfaces, span);
            let divider = divider(tool, reports);
            derived::derived(whole, &divider, &laws, &mut lowering, &mut curves, reports)
        }
        Some(Err(reported)) => {
            without_shape = Some(reported);
            FromProfile::default()
        }
        None if misplaced.is_some() => FromProfile::default(),
        None => {
            let laws = Laws::new(&laws, BTreeMap::new());
            let (surfaces, regions) =
                region::regions(tool, &laws, &mut lowering, &mut curves, reports);
            FromProfile { surfaces, regions, section: None }
        }
    };
    let first = first_curves(tool, &mut lowering, &mut curves, reports);
    if let Some(reported) = without_shape.or(Reported::among(reports)) {
        return Err(reported);
    }
    for (word, value) in &lowering.values {
        if !value.used {
            reports.push(
                Report::warning(value.span, format!("`{word}` is never used"))
                    .missing(Missing::Use)
                    .help("drop it, or is another name misspelt?"),
            );
        }
    }
    Ok(Model {
        domain: tool.domain,
        name: tool.name.word.clone(),
        name_span: tool.name.span,
        title: tool.title.clone(),
        unit,
        graph: lowering.graph,
        frame: lowering.frame,
        curves: curves.list,
        surfaces,
        regions,
        first,
        section,
    })
}

/// Refuses what only a tool has, in a solid.
fn without_axis(tool: &Tool, reports: &mut Vec<Report>) -> Option<Reported> {
    let mut refused = None;
    for item in &tool.items {
        let (span, word, why) = match item {
            Item::Tip(expr) => (expr.span, "tip", "its file's origin is the pose's"),
            Item::Spindle { span, .. } => (*span, "spindle", "its file's frame is the pose's"),
            Item::Profile(profile) => (profile.span, "profile", "it has regions by hand"),
            Item::Mount(mount) => (mount.span, "mount", "it has regions by hand"),
            Item::Regions { span, .. } => (*span, "regions", "it has regions by hand"),
            _ => continue,
        };
        let report = Report::error(span, format!("`{word}` exists in a `tool` only"));
        let help = format!("a `solid` has no axis: {why}");
        refused = Some(Reported::push(reports, report.help(help)));
    }
    refused
}

/// What divides a profile's inside: `regions smooth`, or regions by hand.
fn divider<'t>(tool: &'t Tool, reports: &mut Vec<Report>) -> Divider<'t> {
    let by_hand: Vec<&Region> = tool
        .items
        .iter()
        .filter_map(|item| if let Item::Region(region) = item { Some(region) } else { None })
        .collect();
    let mut said: Option<(Span, Option<&Expr>)> = None;
    for item in &tool.items {
        let Item::Regions { span, smooth } = item else { continue };
        if let Some((first, _)) = said {
            reports.push(
                Report::error(*span, "`regions` is said twice")
                    .and(first, "first here")
                    .help("drop one"),
            );
        }
        said = said.or(Some((*span, smooth.as_ref())));
    }
    match (said, by_hand.first()) {
        (Some((span, _)), Some(region)) => {
            reports.push(
                Report::error(span, "the regions are derived and written")
                    .and(region.name.span, "written here")
                    .help("drop this, or the regions"),
            );
            Divider::Features
        }
        (None, Some(_)) => Divider::Hand(by_hand),
        (Some((_, Some(length))), None) => Divider::Smooth(length),
        _ => Divider::Features,
    }
}

/// What a tool's outline is made of.
enum Shape<'t> {
    Profile(&'t Profile),
    Mounts(Vec<&'t Mount>),
}

/// A tool's outline in its frame and unit.
struct Outlined {
    outline: Vec<Segment>,
    surfaces: Vec<Surface>,
    /// The niceness that comes along with the surfaces of mounted files.
    along: BTreeMap<String, Along>,
    /// Where it is said.
    span: Span,
}

/// The profile or the mounts, if there are any, and what does not go with them.
fn shape<'t>(tool: &'t Tool, reports: &mut Vec<Report>) -> Option<Shape<'t>> {
    let mut profiles = tool.items.iter().filter_map(|item| match item {
        Item::Profile(profile) => Some(profile),
        _ => None,
    });
    let first = profiles.next();
    if let (Some(first), Some(second)) = (first, profiles.next()) {
        reports.push(
            Report::error(second.span, "a second profile")
                .and(first.span, "the first")
                .help("a tool has one outline: drop one"),
        );
    }
    let mounts: Vec<&Mount> = tool
        .items
        .iter()
        .filter_map(|item| if let Item::Mount(mount) = item { Some(mount) } else { None })
        .collect();
    if let (Some(profile), Some(mount)) = (first, mounts.first()) {
        reports.push(
            Report::error(mount.span, "a tool has a profile or mounts")
                .and(profile.span, "the profile")
                .help("drop one, or mount the profile as a file of its own"),
        );
    }
    for item in &tool.items {
        match item {
            Item::Regions { span, .. } if first.is_none() && mounts.is_empty() => reports.push(
                Report::error(*span, "there is no profile to derive regions of")
                    .help("write `profile { … }`"),
            ),
            Item::Tip(Expr { span, .. }) | Item::Spindle { span, .. } if !mounts.is_empty() => {
                reports.push(
                    Report::error(*span, "mounts bring their own tip and spindle")
                        .help("drop it: the tip is the first mount's, at z = 0"),
                );
            }
            _ => {}
        }
    }
    match first {
        Some(profile) => Some(Shape::Profile(profile)),
        None => (!mounts.is_empty()).then_some(Shape::Mounts(mounts)),
    }
}

fn definitions(tool: &Tool, wanted: impl Fn(&Item) -> bool) -> impl Iterator<Item = &Definition> {
    tool.items.iter().filter(move |item| wanted(item)).filter_map(|item| match item {
        Item::Let(definition) | Item::Param(definition) | Item::Curve(definition) => {
            Some(definition)
        }
        _ => None,
    })
}

/// The file's unit: the first item, exactly once.
fn unit(tool: &Tool) -> Result<Unit, Report> {
    let missing = |span: Span| {
        Report::error(span, "no unit: a tool says its unit of length first")
            .missing(Missing::Unit)
            .help("say `units mm;`, `units inch;` or `units m;`")
    };
    let Some(Item::Units(name)) = tool.items.first() else {
        let later = tool.items.iter().find_map(|item| match item {
            Item::Units(name) => Some(name.span),
            _ => None,
        });
        return Err(match later {
            Some(span) => Report::error(span, "the unit is not the first item")
                .help("move `units` to the top: everything below is measured in it"),
            None => missing(tool.name.span),
        });
    };
    if let Some(Item::Units(again)) = tool.items[1..].iter().find(|i| matches!(i, Item::Units(_))) {
        return Err(Report::error(again.span, "the unit is said twice")
            .and(name.span, "first here")
            .help("drop one; a single number may carry another unit, as in `0.25inch`"));
    }
    Unit::from_word(&name.word).ok_or_else(|| {
        let report = Report::error(name.span, format!("unknown unit `{}`", name.word))
            .missing(Missing::Definition(name.word.clone()));
        let meant = match name.word.as_str() {
            "in" | "inches" | "IN" => Some("inch"),
            "millimetre" | "millimeter" | "MM" => Some("mm"),
            "meter" | "metre" => Some("m"),
            word if word.len() > 2 => nearest(word, ["mm", "inch"]),
            _ => None,
        };
        match meant {
            Some(meant) => report.help(format!("write `units {meant};`")),
            None => report.help("units are `mm`, `inch` and `m`"),
        }
    })
}

/// `let` and `param`, in order. Names that are defined by themselves are reported first, those of
/// curves too, and stay without a value.
fn constants(tool: &Tool, given: &[Given<'_>], lowering: &mut Lowering, reports: &mut Vec<Report>) {
    lowering.broken = cycle::refused(definitions(tool, |_| true), reports);
    for item in &tool.items {
        let (definition, is_param) = match item {
            Item::Let(definition) => (definition, false),
            Item::Param(definition) => (definition, true),
            _ => continue,
        };
        if lowering.broken.contains_key(&definition.name.word) {
            continue;
        }
        let value = lowering.constant(&definition.value, "a `let`");
        let value = value.and_then(|value| match is_param {
            true => given::value_of(definition, value, given, lowering.unit),
            false => Ok(value),
        });
        let defined = value.and_then(|(value, dimension)| {
            in_range(&value, definition.value.span)?;
            let id = lowering.graph.number(value);
            lowering.define(&definition.name, (id, dimension))
        });
        lowering.note(&definition.name, defined, reports);
        if enough(reports) {
            break;
        }
    }
}

/// `tip` and `spindle`, each at most once.
fn frame(tool: &Tool, lowering: &mut Lowering, reports: &mut Vec<Report>) {
    let (mut tip, mut spindle): (Option<Span>, Option<Span>) = (None, None);
    for item in &tool.items {
        let (seen, span, word) = match item {
            Item::Tip(expr) => {
                match lowering.length(expr, "`tip`") {
                    Ok(value) => {
                        lowering.frame.tip = value;
                        lowering.frame.tip_span = expr.span;
                    }
                    Err(report) => reports.push(report),
                }
                (&mut tip, expr.span, "tip")
            }
            Item::Spindle { down, span } => {
                lowering.frame.down = *down;
                (&mut spindle, *span, "spindle")
            }
            _ => continue,
        };
        if let Some(first) = seen.replace(span) {
            reports.push(
                Report::error(span, format!("`{word}` is said twice"))
                    .and(first, "first here")
                    .help("drop one"),
            );
        }
    }
}

/// The curves that `bsp` lists.
fn first_curves(
    tool: &Tool,
    lowering: &mut Lowering,
    curves: &mut Curves,
    reports: &mut Vec<Report>,
) -> Vec<usize> {
    let mut first = Vec::new();
    let listed = tool.items.iter().filter_map(|item| match item {
        Item::Bsp(names) => Some(names),
        _ => None,
    });
    for name in listed.flatten() {
        match curve_of(name, lowering, curves) {
            Ok(Some(curve)) if first.contains(&curve) => {
                reports
                    .push(Report::warning(name.span, format!("`{}` is listed twice", name.word)));
            }
            Ok(Some(curve)) => first.push(curve),
            Ok(None) => reports.push(
                Report::warning(name.span, format!("no region depends on `{}`", name.word))
                    .help("drop it from `bsp`"),
            ),
            Err(report) => reports.push(report),
        }
    }
    first
}

fn curve_of(
    name: &Name,
    lowering: &mut Lowering,
    curves: &mut Curves,
) -> Result<Option<usize>, Report> {
    let Some(value) = lowering.values.get_mut(&name.word) else {
        if let Some(reported) = lowering.broken.get(&name.word) {
            return Err(Report::follow_up(name.span, *reported));
        }
        let report = Report::error(name.span, format!("unknown curve `{}`", name.word))
            .missing(Missing::Definition(name.word.clone()));
        return Err(match nearest(&name.word, lowering.values.keys().map(String::as_str)) {
            Some(meant) => report.help(format!("did you mean `{meant}`?")),
            None => report.help(format!("define it above: `curve {} = …;`", name.word)),
        });
    };
    value.used = true;
    let id = value.id;
    Ok(curves.find(&mut lowering.graph, id).map(|(curve, _)| curve))
}
