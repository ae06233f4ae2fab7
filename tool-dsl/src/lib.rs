//! The compiler of `.tool` files, an ordinary library.
//!
//! ```text
//! text ──syntax──▶ tree ──resolve──▶ model ──bound, look──▶ checked tool ──plan──▶ splits
//!                                                                 │
//!                             Rust tokens, SVG ◀──emit, draw──────┼──────interpret──▶ values
//! ```
//!
//! A [`Checked`] tool has no error left in it: [`emit::emit`] and [`interpret::Interpreter`]
//! cannot fail.

pub mod bound;
mod digest;
pub mod domain;
pub mod draw;
pub mod emit;
pub mod expr;
pub mod format;
pub mod formula;
pub mod interpret;
mod look;
pub mod model;
pub mod number;
pub mod plan;
pub mod prove;
mod regionalise;
pub mod report;
pub mod resolve;
pub mod source;
pub mod syntax;

pub use digest::digest;

use bound::{Extent, Slab};
use model::Model;
use plan::Plan;
use prove::Bounds;
use report::{Refusal, Report, Reported, Severity, any_error, without_error};
use source::{Source, Sources, Span};
use std::collections::BTreeSet;

/// A tool that was looked over and found good, with everything that is emitted about it.
#[derive(Clone, Debug)]
pub struct Checked {
    /// What the file says.
    pub model: Model,
    /// How far the solid reaches.
    pub extent: Extent,
    /// Its largest radius along the axis.
    pub envelope: Vec<Slab>,
    /// The order of splits.
    pub plan: Plan,
    /// What is proved of its depth.
    pub bounds: Bounds,
}

/// What came of compiling a text: a tool, or the errors for which there is none.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The tool and its warnings, or why it is refused.
    pub outcome: Result<Accepted, Refusal>,
    /// The tool's name, if the text got so far.
    pub name: Option<String>,
    /// The texts that the reports speak of.
    pub sources: Sources,
}

/// A tool without an error.
#[derive(Clone, Debug)]
pub struct Accepted {
    /// The tool.
    pub tool: Box<Checked>,
    /// What is worth knowing of it, in the order of the text.
    pub warnings: Vec<Report>,
}

impl Compiled {
    /// The same tool as another Rust type.
    #[must_use]
    pub fn named(mut self, name: &str) -> Compiled {
        if let Ok(accepted) = &mut self.outcome {
            name.clone_into(&mut accepted.tool.model.name);
        }
        self.name = self.name.map(|_| name.to_owned());
        self
    }

    /// The tool, if it is not refused.
    pub fn tool(&self) -> Option<&Checked> {
        self.outcome.as_ref().ok().map(|accepted| &*accepted.tool)
    }

    /// The tool itself, if it is not refused.
    pub fn into_tool(self) -> Option<Box<Checked>> {
        self.outcome.ok().map(|accepted| accepted.tool)
    }

    /// Errors and warnings, in the order of the text.
    pub fn reports(&self) -> &[Report] {
        match &self.outcome {
            Ok(accepted) => &accepted.warnings,
            Err(refusal) => refusal.reports(),
        }
    }
}

/// Compiles a tool's text as far as a checked tool. The files that it mounts are read beside the
/// file that holds it.
pub fn compile(source: &Source) -> Compiled {
    compile_with(source, &[])
}

/// Compiles a tool of which some params are given: `D = 0.25inch, flute = 18`, with constant
/// expressions of the language. What is given replaces the default; a bare number is in the tool's
/// unit.
pub fn compile_with(source: &Source, given: &[Source]) -> Compiled {
    let mut sources = Sources::new(source.clone(), given.iter().cloned());
    let mut reports = Vec::new();
    let mut name = None;
    let start = Span { start: 0, end: 0 };
    let outcome = match compiled(&mut sources, &mut name, &mut reports) {
        Ok(tool) => Ok(Accepted { tool: Box::new(tool), warnings: report::readable(reports) }),
        Err(reported) => {
            name_given(&sources, given.len(), &mut reports);
            Err(Refusal::new(reports, start, reported))
        }
    };
    Compiled { outcome, name, sources }
}

/// Names what the params are given beside each error of the tool's own text: a value may have broken it.
fn name_given(sources: &Sources, count: usize, reports: &mut [Report]) {
    let given = &sources.all()[1..=count];
    if given.is_empty() {
        return;
    }
    let texts: Vec<String> =
        given.iter().map(|source| format!("`{}`", source.text.trim())).collect();
    let note = format!("given: {}", texts.join(", "));
    let is_given = |report: &Report| {
        let (source, _) = sources.locate(report.span);
        given.iter().any(|given| given.base == source.base)
    };
    for report in reports.iter_mut() {
        if report.severity == Severity::Error && !report.is_follow_up() && !is_given(report) {
            report.help = Some(match report.help.take() {
                Some(help) => format!("{help}; {note}"),
                None => note.clone(),
            });
        }
    }
}

/// Compiles the first of the sources with what the others give its params. Fails only with an error
/// among the reports, and never succeeds with one.
fn compiled(
    sources: &mut Sources,
    name: &mut Option<String>,
    reports: &mut Vec<Report>,
) -> Result<Checked, Reported> {
    let tree = syntax::parse(sources.own(), reports);
    let mut settings = Vec::new();
    for source in &sources.all()[1..] {
        settings.extend(syntax::given(source, reports));
    }
    let tree = tree?;
    *name = Some(tree.name.word.clone()).filter(|name| syntax::is_type_name(name));
    let mut found = Vec::new();
    let model = resolve::resolve(&tree, &settings, sources, &mut found);
    let broken: BTreeSet<&str> = tree.broken.iter().map(String::as_str).collect();
    let unread = any_error(reports);
    reports.extend(found.into_iter().filter(|report| !unread || !follows(report, &broken)));
    let model = model?;
    without_error(reports)?;
    check(model, reports)
}

fn check(mut model: Model, reports: &mut Vec<Report>) -> Result<Checked, Reported> {
    finite(&model).map_err(|report| Reported::push(reports, report))?;
    let extent = match bound::extent(&model) {
        Ok(extent) => extent,
        // A curve that has no value somewhere has no bound either: say so.
        Err(report) => {
            reports.extend(look::undefined(&model));
            let undefined = Reported::among(reports);
            return Err(undefined.unwrap_or_else(|| Reported::push(reports, report)));
        }
    };
    reports.extend(look::look(&model, &extent));
    // The plan would only repeat what is wrong.
    without_error(reports)?;
    let envelope = bound::envelope(&model, &extent);
    let plan = plan::plan(&mut model, &extent).map_err(|report| Reported::push(reports, report))?;
    let mut tool = Checked { model, extent, envelope, plan, bounds: Bounds::NONE };
    let (bounds, found) = Bounds::of(&tool);
    tool.bounds = bounds;
    reports.extend(found);
    without_error(reports)?;
    Ok(tool)
}

/// Every constant that code needs is a double.
fn finite(model: &Model) -> Result<(), Report> {
    let outputs = model.regions.iter().flat_map(|region| interpret::roots(&region.outputs));
    let curves = model.curves.iter().map(|curve| curve.value);
    let needed = model.graph.needed(outputs.chain(curves));
    let beyond =
        |id: &expr::Id| model.graph.constant(*id).is_some_and(|value| !value.to_f64().is_finite());
    if needed.iter().any(beyond) {
        return Err(Report::error(model.name_span, "a constant of this tool outgrows all numbers")
            .help("powers upon powers of large constants do so: write lengths in a nearer unit"));
    }
    Ok(())
}

/// Whether a report only says that what a broken item would have said is missing.
fn follows(report: &Report, broken: &BTreeSet<&str>) -> bool {
    let has = |word: &str| broken.contains(word);
    let message = &report.message;
    let missing_name = message.starts_with("unknown") && message.split('`').nth(1).is_some_and(has);
    missing_name
        || message.contains("is never used")
        || message.ends_with("has no region")
        || (message.starts_with("no unit") && has("units"))
        || (message.starts_with("unknown surface") && has("region"))
}
