//! Arguments of a tool's `param`s, from outside its file.

use super::lower::{Constant, Lowering};
use crate::diagnostic::{
    Diagnostic, FormattedNumber, Kind, NameRemedy, Names, ParamRemedy, Role, ValueKind, nearest,
};
use crate::dimension::Dimension;
use crate::domain::Domain;
use crate::expr::Graph;
use crate::model::Unit;
use crate::number::Number;
use crate::syntax::tree::{Definition, Expr, Item, Name, Tool};

/// An argument of a `param`, evaluated where it is given.
pub(super) struct Argument<'t> {
    setting: &'t Definition,
    constant: Constant,
    /// The unit of the file in which it is written.
    unit: Unit,
}

/// Evaluates the arguments of a macro's call or of a command line: constants without names, in the file's own unit.
pub(super) fn from_outside<'t>(
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
pub(super) fn from_mount<'t>(
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
pub(super) fn value_of(
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
