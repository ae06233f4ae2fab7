//! What a tool's `param`s are given from outside its file.

use super::dimension::Dimension;
use super::lower::Lowering;
use crate::domain::Domain;
use crate::expr::Graph;
use crate::model::Unit;
use crate::number::Number;
use crate::report::{Missing, Report, figure, nearest};
use crate::syntax::tree::{Definition, Expr, Item, Name, Tool};

/// A value for a `param`, evaluated where it is given.
pub(super) struct Given<'t> {
    setting: &'t Definition,
    value: Number,
    dimension: Dimension,
    /// The unit that the value is in.
    unit: Unit,
}

/// What a macro's call or a command line gives: constants without names, in the file's own unit.
pub(super) fn from_outside<'t>(
    settings: &'t [Definition],
    (domain, unit): (Domain, Unit),
    reports: &mut Vec<Report>,
) -> Vec<Given<'t>> {
    given(settings, &mut Lowering::new(domain, unit), reports, |report| {
        if matches!(report.missing, Some(Missing::Name(_))) {
            return report.help("what is given is a constant: numbers with their units, `pi`");
        }
        report
    })
}

/// What a mount gives, in the names and the unit of the file that says it.
pub(super) fn from_mount<'t>(
    settings: &'t [Definition],
    lowering: &mut Lowering,
    reports: &mut Vec<Report>,
) -> Vec<Given<'t>> {
    given(settings, lowering, reports, |report| report)
}

fn given<'t>(
    settings: &'t [Definition],
    lowering: &mut Lowering,
    reports: &mut Vec<Report>,
    said: impl Fn(Report) -> Report,
) -> Vec<Given<'t>> {
    let mut given: Vec<Given<'t>> = Vec::new();
    for setting in settings {
        let name = &setting.name;
        if let Some(first) = given.iter().find(|other| other.setting.name.word == name.word) {
            reports.push(
                Report::error(name.span, format!("`{}` is given twice", name.word))
                    .and(first.setting.name.span, "first here")
                    .help("drop one"),
            );
            continue;
        }
        match lowering.constant(&setting.value, "a `param`") {
            Ok((value, dimension)) => {
                given.push(Given { setting, value, dimension, unit: lowering.unit });
            }
            Err(report) => reports.push(said(report)),
        }
    }
    given
}

/// The value of a `param`: what is given, else its default.
pub(super) fn value_of(
    param: &Definition,
    default: (Number, Dimension),
    given: &[Given<'_>],
    unit: Unit,
) -> Result<(Number, Dimension), Report> {
    match given.iter().find(|given| given.setting.name.word == param.name.word) {
        Some(given) => given.replacing(&param.value, default.1, unit),
        None => Ok(default),
    }
}

impl Given<'_> {
    fn replacing(
        &self,
        default: &Expr,
        of_default: Dimension,
        unit: Unit,
    ) -> Result<(Number, Dimension), Report> {
        let Definition { name: Name { word, .. }, value } = self.setting;
        let Some(dimension) = of_default.alike(self.dimension) else {
            let message = format!("`{word}` is {of_default}, what is given is {}", self.dimension);
            let report = Report::error(value.span, message).and(default.span, "its default");
            return Err(report.help(format!("give {of_default}")));
        };
        let power = match dimension {
            // Where a length is wanted a bare number is in the unit of the file that it stands in.
            Dimension::Length(power) => power,
            Dimension::Bare if self.unit != unit && !self.value.is_zero() => {
                let number = figure(self.value.to_f64());
                let (here, there) = (self.unit.word(), unit.word());
                let message = format!("is `{word}` {number}{here} or {number}{there}?");
                return Err(Report::error(value.span, message).help(format!(
                    "this file is in {here}, the mounted one in {there}: write the unit; \
                     a mere number is `{number}{here}/1{here}`"
                )));
            }
            _ => 0.0,
        };
        Ok((&self.value * &scale(self.unit, unit, power), dimension))
    }
}

/// The factor that turns a power of length in one unit into the same in another.
fn scale(from: Unit, to: Unit, power: f64) -> Number {
    let mut graph = Graph::default();
    let length = graph.number(from.to(to));
    // Powers are sums of halves.
    let scale = graph.power(length, (power * 2.0) as i32);
    scale.and_then(|id| graph.constant(id).cloned()).unwrap_or_else(|| Number::int(1))
}

/// What is given that no `param` takes.
pub(super) fn untaken(tool: &Tool, given: &[Given<'_>], reports: &mut Vec<Report>) {
    let params: Vec<&str> = tool
        .items
        .iter()
        .filter_map(|item| match item {
            Item::Param(definition) => Some(definition.name.word.as_str()),
            _ => None,
        })
        .collect();
    let list = match params.as_slice() {
        [] => "it has none".to_owned(),
        [one] => format!("it has `{one}`"),
        many => format!(
            "it has {}",
            many.iter().map(|p| format!("`{p}`")).collect::<Vec<_>>().join(", ")
        ),
    };
    for Given { setting: Definition { name, .. }, .. } in given {
        let word = name.word.as_str();
        if params.contains(&word) {
            continue;
        }
        let other = tool.items.iter().find_map(|item| match item {
            Item::Let(definition) if definition.name.word == word => Some(definition),
            _ => None,
        });
        let report =
            Report::error(name.span, format!("`{}` has no param `{word}`", tool.name.word));
        reports.push(match (other, nearest(word, params.iter().copied())) {
            (Some(other), _) => report
                .and(other.name.span, "this is a `let`")
                .help(format!("write `param` there; {list}")),
            (None, Some(meant)) => report.help(format!("did you mean `{meant}`? {list}")),
            (None, None) => report.help(list.clone()),
        });
    }
}
