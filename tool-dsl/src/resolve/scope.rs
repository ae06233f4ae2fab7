//! The names of a file: their definitions, cycles of these, the arguments of its `param`s, and the transform from the
//! tool's coordinates to the file's.

use super::definitions;
use super::lower::{Allowed, Constant, Lowering, mentioned};
use crate::diagnostic::{
    CycleLinks, Diagnostic, FormattedNumber, Kind, NameRemedy, Names, ParamRemedy, Reported, Role,
    ValueKind, nearest,
};
use crate::dimension::Dimension;
use crate::domain::Domain;
use crate::expr::{Coord, Graph, Id};
use crate::model::{Frame, Unit};
use crate::number::Number;
use crate::source::Span;
use crate::syntax::tree::{Definition, Expr, Item, Name, Tool};
use std::collections::{BTreeMap, BTreeSet};

impl Lowering {
    /// Returns the state for a text without names.
    fn new(domain: Domain, unit: Unit) -> Lowering {
        Lowering {
            domain,
            graph: Graph::default(),
            unit,
            frame: Frame {
                tip: Number::int(0),
                spindle_down: false,
                tip_span: Span { start: 0, end: 0 },
            },
            scale: Number::int(1),
            values: BTreeMap::new(),
            declared: BTreeMap::new(),
            broken: BTreeMap::new(),
            parametric: BTreeSet::new(),
            left_out: BTreeSet::new(),
        }
    }

    /// Returns the state for a tool of which nothing is lowered yet.
    pub(super) fn of(tool: &Tool, unit: Unit) -> Lowering {
        let declared = definitions(tool, |_| true)
            .map(|definition| (definition.name.text.clone(), definition.name.span))
            .collect();
        let mut lowering = Lowering { declared, ..Lowering::new(tool.domain, unit) };
        lowering.frame.tip_span = tool.name.span;
        lowering
    }

    /// Runs `work` on a graph that is shared with other files.
    pub(super) fn on<T>(&mut self, graph: &mut Graph, work: impl FnOnce(&mut Lowering) -> T) -> T {
        std::mem::swap(graph, &mut self.graph);
        let done = work(self);
        std::mem::swap(graph, &mut self.graph);
        done
    }

    /// Moves the file's tool: its lengths are multiplied by `scale`, then its tip is moved along the axis by `by`.
    pub(super) fn transform(&mut self, scale: &Number, by: &Number) {
        self.scale = &self.scale / scale;
        let by = &self.scale * by;
        self.frame.tip =
            if self.frame.spindle_down { &self.frame.tip + &by } else { &self.frame.tip - &by };
    }

    /// Converts a length of the tool to the file's unit.
    pub(super) fn length_here(&mut self, length: Id) -> Id {
        if self.scale == Number::int(1) {
            return length;
        }
        let scale = self.graph.number(self.scale.clone());
        self.graph.mul(scale, length)
    }

    /// Converts a coordinate of the tool to the file's unit and frame.
    pub(super) fn coordinate_here(&mut self, coordinate: Coord) -> Id {
        let id = self.graph.coord(coordinate);
        let id = self.length_here(id);
        if coordinate == Coord::Z { self.frame.file_z(&mut self.graph, id) } else { id }
    }

    /// Defines a curve, a function of the coordinates, or reports its error.
    pub(super) fn curve(&mut self, definition: &Definition, diagnostics: &mut Vec<Diagnostic>) {
        if !self.broken.contains_key(&definition.name.text) {
            let defined = self.curve_value(definition);
            self.report(&definition.name, defined, diagnostics);
        }
    }

    fn curve_value(&mut self, definition: &Definition) -> Result<(), Diagnostic> {
        let value = self.lower(&definition.value, Allowed::Coordinates)?;
        if value.dimension == Dimension::Angle {
            let diagnostic = Diagnostic::new(definition.value.span, ValueKind::CurveOfAngle);
            return Err(diagnostic);
        }
        self.define(&definition.name, value)
    }
}

/// The maximum number of links of a cycle that a message lists.
const MAX_LISTED_LINKS: usize = 64;

/// Reports each cycle of definitions once, with its links, and returns the names on the cycles. If a name is defined
/// twice, the first definition counts.
pub(super) fn report_cycles<'t>(
    definitions: impl Iterator<Item = &'t Definition>,
    diagnostics: &mut Vec<Diagnostic>,
) -> BTreeMap<String, Reported> {
    let mut of_name: BTreeMap<&str, &Definition> = BTreeMap::new();
    for definition in definitions {
        of_name.entry(&definition.name.text).or_insert(definition);
    }
    let mut refused = BTreeMap::new();
    let mut done: BTreeMap<&str, bool> = BTreeMap::new();
    // In the order of the text, so that a cycle begins at its first definition.
    let mut roots: Vec<&Definition> = of_name.values().copied().collect();
    roots.sort_by_key(|definition| definition.name.span.start);
    for root in roots {
        if done.contains_key(root.name.text.as_str()) {
            continue;
        }
        // The path from the root; each step has the names still to be followed. It is iterative rather than recursive,
        // since a chain of definitions may be as long as a file.
        done.insert(&root.name.text, false);
        let mut path = vec![Step::new(root, root.name.span)];
        while let Some(step) = path.last_mut() {
            let Some((word, span)) = step.pending.pop() else {
                done.insert(&step.definition.name.text, true);
                path.pop();
                continue;
            };
            let Some(next) = of_name.get(word) else { continue };
            match done.get(word) {
                Some(true) => {}
                Some(false) => {
                    let first = path.iter().position(|step| step.definition.name.text == word);
                    let cycle = &path[first.unwrap_or_default()..];
                    let known = cycle.iter().any(|step| refused.contains_key(step.word()));
                    if !known {
                        let reported = Reported::push(diagnostics, circular(cycle, span));
                        refused.extend(cycle.iter().map(|step| (step.word().to_owned(), reported)));
                    }
                }
                None => {
                    done.insert(word, false);
                    path.push(Step::new(next, span));
                }
            }
        }
    }
    refused
}

/// A definition on the path, the span at which the previous one mentions it, and the names that it mentions itself.
struct Step<'t> {
    definition: &'t Definition,
    span: Span,
    pending: Vec<(&'t str, Span)>,
}

impl<'t> Step<'t> {
    fn new(definition: &'t Definition, span: Span) -> Step<'t> {
        let mut pending = mentioned(&definition.value);
        pending.reverse();
        Step { definition, span, pending }
    }

    fn word(&self) -> &'t str {
        &self.definition.name.text
    }
}

/// Returns the error for a cycle. `span` is where its last definition mentions the first one.
fn circular(cycle: &[Step<'_>], span: Span) -> Diagnostic {
    let name = cycle[0].word().to_owned();
    let [_, second, ..] = cycle else {
        let kind = ValueKind::CircularDefinition { name, links: CycleLinks(Vec::new()), more: 0 };
        return Diagnostic::new(span, kind);
    };
    let next = cycle.iter().skip(1).chain(&cycle[..1]);
    let links: Vec<[String; 2]> = cycle
        .iter()
        .zip(next)
        .take(MAX_LISTED_LINKS)
        .map(|(step, next)| [step.word(), next.word()].map(str::to_owned))
        .collect();
    let more = cycle.len() - links.len();
    let kind = ValueKind::CircularDefinition { name, links: CycleLinks(links), more };
    Diagnostic::new(span, kind).with_label(second.span, "first link of the cycle")
}

/// An argument of a `param`, evaluated where it is given.
pub(super) struct Argument<'t> {
    setting: &'t Definition,
    constant: Constant,
    /// The unit of the file in which it is written.
    unit: Unit,
}

/// Evaluates the arguments of a macro's call or of a command line: constants without names, in the file's own unit.
pub(super) fn arguments_from_outside<'t>(
    settings: &'t [Definition],
    domain: Domain,
    unit: Unit,
    diagnostics: &mut Vec<Diagnostic>,
) -> Vec<Argument<'t>> {
    read_arguments(settings, &mut Lowering::new(domain, unit), diagnostics, |mut diagnostic| {
        if let Kind::ValueKind(ValueKind::UnknownName { remedy, .. }) = &mut diagnostic.kind {
            *remedy = NameRemedy::Constant;
        }
        diagnostic
    })
}

/// Evaluates the arguments of a mount, in the names and the unit of the mounting file.
pub(super) fn arguments_of_mount<'t>(
    settings: &'t [Definition],
    lowering: &mut Lowering,
    diagnostics: &mut Vec<Diagnostic>,
) -> Vec<Argument<'t>> {
    read_arguments(settings, lowering, diagnostics, |diagnostic| diagnostic)
}

fn read_arguments<'t>(
    settings: &'t [Definition],
    lowering: &mut Lowering,
    diagnostics: &mut Vec<Diagnostic>,
    adapt: impl Fn(Diagnostic) -> Diagnostic,
) -> Vec<Argument<'t>> {
    let mut arguments: Vec<Argument<'t>> = Vec::new();
    for setting in settings {
        let name = &setting.name;
        if let Some(first) = arguments.iter().find(|other| other.setting.name.text == name.text) {
            diagnostics.push(
                Diagnostic::new(
                    name.span,
                    ValueKind::DuplicateArgument { name: name.text.clone() },
                )
                .with_label(first.setting.name.span, "first value"),
            );
            continue;
        }
        match lowering.constant(&setting.value, Role::Param) {
            Ok(constant) => arguments.push(Argument { setting, constant, unit: lowering.unit }),
            Err(diagnostic) => diagnostics.push(adapt(diagnostic)),
        }
    }
    arguments
}

/// Returns the value of a `param`: its argument, otherwise its default.
pub(super) fn param_value(
    param: &Definition,
    default: Constant,
    arguments: &[Argument<'_>],
    unit: Unit,
) -> Result<Constant, Diagnostic> {
    match arguments.iter().find(|argument| argument.setting.name.text == param.name.text) {
        Some(argument) => argument.replace_default(&param.value, default.dimension, unit),
        None => Ok(default),
    }
}

impl Argument<'_> {
    fn replace_default(
        &self,
        default: &Expr,
        default_dimension: Dimension,
        unit: Unit,
    ) -> Result<Constant, Diagnostic> {
        let Definition { name: Name { text: word, .. }, value } = self.setting;
        let Constant { value: number, dimension: found } = &self.constant;
        let Some(dimension) = default_dimension.common(*found) else {
            let diagnostic = Diagnostic::new(
                value.span,
                ValueKind::ArgumentDimension {
                    name: word.clone(),
                    dimension: default_dimension,
                    found: *found,
                },
            )
            .with_label(default.span, "default value");
            return Err(diagnostic);
        };
        let power = match dimension {
            // For a length, a number without a unit is in the unit of the file in which it is written.
            Dimension::Length(power) => power,
            Dimension::Dimensionless if self.unit != unit && !number.is_zero() => {
                return Err(Diagnostic::new(
                    value.span,
                    ValueKind::AmbiguousArgumentUnit {
                        name: word.clone(),
                        number: FormattedNumber(number.to_f64()),
                        file_unit: self.unit.symbol(),
                        mounted_unit: unit.symbol(),
                    },
                ));
            }
            _ => 0.0,
        };
        Ok(Constant { value: number * &scale(self.unit, unit, power), dimension })
    }
}

/// Returns the factor that converts a power of length from one unit to another.
fn scale(from: Unit, to: Unit, power: f64) -> Number {
    let mut graph = Graph::default();
    let length = graph.number(from.factor_to(to));
    // Exponents are multiples of one half.
    let scale = graph.power(length, (power * 2.0) as i32);
    scale.and_then(|id| graph.constant(id).cloned()).unwrap_or_else(|| Number::int(1))
}

/// Reports arguments that no `param` takes.
pub(super) fn report_unknown_params(
    tool: &Tool,
    arguments: &[Argument<'_>],
    diagnostics: &mut Vec<Diagnostic>,
) {
    let params: Vec<&str> = tool
        .items
        .iter()
        .filter_map(|item| match item {
            Item::Param(definition) => Some(definition.name.text.as_str()),
            _ => None,
        })
        .collect();
    for Argument { setting: Definition { name, .. }, .. } in arguments {
        let word = name.text.as_str();
        if params.contains(&word) {
            continue;
        }
        let other = tool.items.iter().find_map(|item| match item {
            Item::Let(definition) if definition.name.text == word => Some(definition),
            _ => None,
        });
        let remedy = match (other, nearest(word, params.iter().copied())) {
            (Some(_), _) => ParamRemedy::Let,
            (None, Some(suggestion)) => ParamRemedy::Similar(suggestion.to_owned()),
            (None, None) => ParamRemedy::List,
        };
        let (tool, params) = (tool.name.text.clone(), Names::new(params.iter().copied()));
        let kind = ValueKind::UnknownParam { tool, name: word.to_owned(), remedy, params };
        let diagnostic = Diagnostic::new(name.span, kind);
        diagnostics.push(match other {
            Some(other) => diagnostic.with_label(other.name.span, "defined by `let` here"),
            None => diagnostic,
        });
    }
}
