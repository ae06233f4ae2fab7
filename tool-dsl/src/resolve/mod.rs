//! Resolves the syntax tree to the model: names, dimensions, the coordinate frame, the laws of each region.

mod condition;
mod derived;
mod lower;
mod mount;
mod outputs;
mod profile;
mod region;
mod scope;

pub(crate) use derived::{never_wins, overlapping, partitioned_anew};
pub(crate) use mount::off_tip;
pub(crate) use outputs::SHORTEST_SQUARE;

use crate::diagnostic::{
    Diagnostic, MountKind, RegionKind, Reported, Role, ValueKind, enough, nearest,
};
use crate::domain::Domain;
use crate::model::{Model, Unit};
use crate::source::{Sources, Span};
use crate::syntax::tree::{Definition, Expr, Item, Law, Mount, Name, Profile, Region, Tool};
use condition::Curves;
use derived::{Divider, FromProfile};
use lower::{Constant, Lowered, Lowering, in_range};
use profile::Outline;
use region::{Laws, MountedNiceness};
use scope::Argument;
use std::collections::BTreeMap;

/// Resolves a tool with the arguments of its parameters. The files that it mounts are read on the way.
///
/// # Errors
///
/// Fails only with an error among the diagnostics, and never succeeds if it adds an error.
pub fn resolve(
    tool: &Tool,
    given: &[Definition],
    sources: &mut Sources,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<Model, Reported> {
    let unit = unit(tool).map_err(|diagnostic| Reported::push(diagnostics, diagnostic))?;
    let mut lowering = Lowering::of(tool, unit);
    let given = scope::arguments_from_outside(given, tool.domain, unit, diagnostics);
    scope::report_unknown_params(tool, &given, diagnostics);
    constants(tool, &given, &mut lowering, diagnostics);
    let misplaced_item = match tool.domain {
        Domain::Space => report_items_of_axis(tool, diagnostics),
        Domain::HalfPlane => None,
    };
    frame(tool, &mut lowering, diagnostics);
    for definition in definitions(tool, |item| matches!(item, Item::Curve(_))) {
        lowering.curve(definition, diagnostics);
        if enough(diagnostics)
            && let Some(reported) = Reported::among(diagnostics)
        {
            return Err(reported);
        }
    }
    let mut curves = Curves::default();
    for definition in definitions(tool, |item| matches!(item, Item::Curve(_))) {
        if let Some(value) = lowering.values.get(&definition.name.text) {
            curves.name(&definition.name.text, value.id);
        }
    }
    let laws: Vec<&Law> = tool
        .items
        .iter()
        .filter_map(|item| if let Item::Law(law) = item { Some(law) } else { None })
        .collect();
    let shape = if misplaced_item.is_some() { None } else { shape(tool, diagnostics) };
    let outlined = shape.map(|shape| match shape {
        Shape::Profile(profile) => {
            let outline = profile::outline(profile, &mut lowering, diagnostics);
            outline.map(|outline| Outlined { outline, niceness_by_surface: BTreeMap::new() })
        }
        Shape::Mounts(mounts) => {
            mount::assemble_mounts(&mounts, tool.name.span, &mut lowering, sources, diagnostics)
        }
    });
    let mut without_shape = misplaced_item;
    let FromProfile { surfaces, regions, profile } = match outlined {
        Some(Ok(Outlined { outline, niceness_by_surface })) => {
            let laws = Laws::new(&laws, niceness_by_surface);
            let divider = divider(tool, diagnostics);
            derived::derived(outline, &divider, &laws, &mut lowering, &mut curves, diagnostics)
        }
        Some(Err(reported)) => {
            without_shape = Some(reported);
            FromProfile::default()
        }
        None if misplaced_item.is_some() => FromProfile::default(),
        None => {
            let laws = Laws::new(&laws, BTreeMap::new());
            let (surfaces, regions) =
                region::regions(tool, &laws, &mut lowering, &mut curves, diagnostics);
            FromProfile { surfaces, regions, profile: None }
        }
    };
    let first = first_curves(tool, &mut lowering, &mut curves, diagnostics);
    if let Some(reported) = without_shape.or(Reported::among(diagnostics)) {
        return Err(reported);
    }
    for (name, value) in &lowering.values {
        if !value.used {
            diagnostics
                .push(Diagnostic::new(value.span, ValueKind::UnusedName { name: name.clone() }));
        }
    }
    Ok(Model {
        domain: tool.domain,
        name: tool.name.text.clone(),
        name_span: tool.name.span,
        title: tool.title.clone(),
        unit,
        graph: lowering.graph,
        frame: lowering.frame,
        curves: curves.list,
        surfaces,
        regions,
        first_curves: first,
        profile,
    })
}

/// Reports items that only a tool may have, in a solid. Returns evidence if there are any.
fn report_items_of_axis(tool: &Tool, diagnostics: &mut Vec<Diagnostic>) -> Option<Reported> {
    let mut refused = None;
    for item in &tool.items {
        let (span, keyword) = match item {
            Item::Tip(expr) => (expr.span, "tip"),
            Item::Spindle { span, .. } => (*span, "spindle"),
            Item::Profile(profile) => (profile.span, "profile"),
            Item::Mount(mount) => (mount.span, "mount"),
            Item::Regions { span, .. } => (*span, "regions"),
            _ => continue,
        };
        let diagnostic = Diagnostic::new(span, RegionKind::NotInSolid { keyword });
        refused = Some(Reported::push(diagnostics, diagnostic));
    }
    refused
}

/// Returns the division of a profile's inside: `regions smooth`, regions by hand, or neither.
fn divider<'t>(tool: &'t Tool, diagnostics: &mut Vec<Diagnostic>) -> Divider<'t> {
    let by_hand: Vec<&Region> = tool
        .items
        .iter()
        .filter_map(|item| if let Item::Region(region) = item { Some(region) } else { None })
        .collect();
    let mut regions_item: Option<(Span, Option<&Expr>)> = None;
    for item in &tool.items {
        let Item::Regions { span, smooth } = item else { continue };
        if let Some((first, _)) = regions_item {
            diagnostics.push(
                Diagnostic::new(
                    *span,
                    RegionKind::DuplicateStatement { keyword: "regions".to_owned() },
                )
                .with_label(first, "first definition"),
            );
        }
        regions_item = regions_item.or(Some((*span, smooth.as_ref())));
    }
    match (regions_item, by_hand.first()) {
        (Some((span, _)), Some(region)) => {
            diagnostics.push(
                Diagnostic::new(span, RegionKind::DerivedAndWrittenRegions)
                    .with_label(region.name.span, "first region written by hand"),
            );
            Divider::Features
        }
        (None, Some(_)) => Divider::Hand(by_hand),
        (Some((_, Some(length))), None) => Divider::Smooth(length),
        _ => Divider::Features,
    }
}

/// The source of a tool's outline.
enum Shape<'t> {
    Profile(&'t Profile),
    Mounts(Vec<&'t Mount>),
}

/// A tool's outline, and the niceness laws that come with the surfaces of mounted files, by surface.
struct Outlined {
    outline: Outline,
    niceness_by_surface: BTreeMap<String, MountedNiceness>,
}

/// Returns the profile or the mounts, if there are any, and reports items that conflict with them.
fn shape<'t>(tool: &'t Tool, diagnostics: &mut Vec<Diagnostic>) -> Option<Shape<'t>> {
    let mut profiles = tool.items.iter().filter_map(|item| match item {
        Item::Profile(profile) => Some(profile),
        _ => None,
    });
    let first = profiles.next();
    if let (Some(first), Some(second)) = (first, profiles.next()) {
        diagnostics.push(
            Diagnostic::new(second.span, RegionKind::SecondProfile)
                .with_label(first.span, "first profile"),
        );
    }
    let mounts: Vec<&Mount> = tool
        .items
        .iter()
        .filter_map(|item| if let Item::Mount(mount) = item { Some(mount) } else { None })
        .collect();
    if let (Some(profile), Some(mount)) = (first, mounts.first()) {
        diagnostics.push(
            Diagnostic::new(mount.span, MountKind::ProfileWithMounts)
                .with_label(profile.span, "profile of this file"),
        );
    }
    for item in &tool.items {
        match item {
            Item::Regions { span, .. } if first.is_none() && mounts.is_empty() => {
                diagnostics.push(Diagnostic::new(*span, RegionKind::NoProfile));
            }
            Item::Tip(Expr { span, .. }) | Item::Spindle { span, .. } if !mounts.is_empty() => {
                diagnostics.push(Diagnostic::new(*span, MountKind::FrameWithMounts));
            }
            _ => {}
        }
    }
    match first {
        Some(profile) => Some(Shape::Profile(profile)),
        None => (!mounts.is_empty()).then_some(Shape::Mounts(mounts)),
    }
}

fn definitions(
    tool: &Tool,
    is_wanted: impl Fn(&Item) -> bool,
) -> impl Iterator<Item = &Definition> {
    tool.items.iter().filter(move |item| is_wanted(item)).filter_map(|item| match item {
        Item::Let(definition) | Item::Param(definition) | Item::Curve(definition) => {
            Some(definition)
        }
        _ => None,
    })
}

/// Returns the file's unit, which has to be the first item and stated exactly once.
fn unit(tool: &Tool) -> Result<Unit, Diagnostic> {
    let Some(Item::Units(name)) = tool.items.first() else {
        let later = tool.items.iter().find_map(|item| match item {
            Item::Units(name) => Some(name.span),
            _ => None,
        });
        return Err(match later {
            Some(span) => Diagnostic::new(span, ValueKind::UnitNotFirst),
            None => Diagnostic::new(tool.name.span, ValueKind::MissingUnit),
        });
    };
    if let Some(Item::Units(second_unit)) =
        tool.items[1..].iter().find(|i| matches!(i, Item::Units(_)))
    {
        return Err(Diagnostic::new(second_unit.span, ValueKind::DuplicateUnit)
            .with_label(name.span, "first unit"));
    }
    Unit::from_symbol(&name.text).ok_or_else(|| {
        let suggestion = match name.text.as_str() {
            "in" | "inches" | "IN" => Some("inch"),
            "millimetre" | "millimeter" | "MM" => Some("mm"),
            "meter" | "metre" => Some("m"),
            word if word.len() > 2 => nearest(word, ["mm", "inch"]),
            _ => None,
        };
        let kind = ValueKind::UnknownFileUnit { unit: name.text.clone(), suggestion };
        Diagnostic::new(name.span, kind)
    })
}

/// Evaluates `let` and `param` items, in order. Names of constants and curves that are defined by themselves are
/// reported first, and stay without a value.
fn constants(
    tool: &Tool,
    given: &[Argument<'_>],
    lowering: &mut Lowering,
    diagnostics: &mut Vec<Diagnostic>,
) {
    lowering.broken = scope::report_cycles(definitions(tool, |_| true), diagnostics);
    for item in &tool.items {
        let (definition, is_param) = match item {
            Item::Let(definition) => (definition, false),
            Item::Param(definition) => (definition, true),
            _ => continue,
        };
        if lowering.broken.contains_key(&definition.name.text) {
            continue;
        }
        if is_param || lowering.is_parametric(&definition.value) {
            lowering.parametric.insert(definition.name.text.clone());
        }
        let mut constant = lowering.constant(&definition.value, Role::Let);
        if is_param {
            constant = constant
                .and_then(|default| scope::param_value(definition, default, given, lowering.unit));
        }
        let defined = constant.and_then(|Constant { value, dimension }| {
            in_range(&value, definition.value.span)?;
            let id = lowering.graph.number(value);
            lowering.define(&definition.name, Lowered { id, dimension })
        });
        lowering.report(&definition.name, defined, diagnostics);
        if enough(diagnostics) {
            break;
        }
    }
}

/// Evaluates `tip` and `spindle`, each stated at most once.
fn frame(tool: &Tool, lowering: &mut Lowering, diagnostics: &mut Vec<Diagnostic>) {
    let (mut tip, mut spindle): (Option<Span>, Option<Span>) = (None, None);
    for item in &tool.items {
        let (previous_span, span, keyword) = match item {
            Item::Tip(expr) => {
                match lowering.length(expr, Role::Tip) {
                    Ok(value) => {
                        lowering.frame.tip = value;
                        lowering.frame.tip_span = expr.span;
                    }
                    Err(diagnostic) => diagnostics.push(diagnostic),
                }
                (&mut tip, expr.span, "tip")
            }
            Item::Spindle { down, span } => {
                lowering.frame.spindle_down = *down;
                (&mut spindle, *span, "spindle")
            }
            _ => continue,
        };
        if let Some(first) = previous_span.replace(span) {
            diagnostics.push(
                Diagnostic::new(
                    span,
                    RegionKind::DuplicateStatement { keyword: keyword.to_owned() },
                )
                .with_label(first, "first definition"),
            );
        }
    }
}

/// Returns the curves that `bsp` lists.
fn first_curves(
    tool: &Tool,
    lowering: &mut Lowering,
    curves: &mut Curves,
    diagnostics: &mut Vec<Diagnostic>,
) -> Vec<usize> {
    let mut first = Vec::new();
    let listed = tool.items.iter().filter_map(|item| match item {
        Item::Bsp(names) => Some(names),
        _ => None,
    });
    for name in listed.flatten() {
        match curve_of(name, lowering, curves) {
            Ok(Some(curve)) if first.contains(&curve) => {
                diagnostics.push(Diagnostic::new(
                    name.span,
                    RegionKind::DuplicateCurve { name: name.text.clone() },
                ));
            }
            Ok(Some(curve)) => first.push(curve),
            Ok(None) => diagnostics.push(Diagnostic::new(
                name.span,
                RegionKind::UnusedCurve { name: name.text.clone() },
            )),
            Err(diagnostic) => diagnostics.push(diagnostic),
        }
    }
    first
}

fn curve_of(
    name: &Name,
    lowering: &mut Lowering,
    curves: &mut Curves,
) -> Result<Option<usize>, Diagnostic> {
    let Some(value) = lowering.values.get_mut(&name.text) else {
        if let Some(reported) = lowering.broken.get(&name.text) {
            return Err(lower::without_value(name.span, &name.text, *reported));
        }
        let suggestion = nearest(&name.text, lowering.values.keys().map(String::as_str));
        let suggestion = suggestion.map(str::to_owned);
        return Err(Diagnostic::new(
            name.span,
            RegionKind::UnknownCurve { name: name.text.clone(), suggestion },
        ));
    };
    value.used = true;
    let id = value.id;
    Ok(curves.find(&mut lowering.graph, id).map(|(curve, _)| curve))
}
