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
use plan::{Plan, Tree};
use prove::Bounds;
use report::{Report, any_error};
use source::{Source, Sources};
use std::collections::{BTreeSet, HashSet};

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

/// What came of compiling a text.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The tool, if there is no error.
    pub tool: Option<Box<Checked>>,
    /// The tool's name, if the text got so far.
    pub name: Option<String>,
    /// Errors and warnings.
    pub reports: Vec<Report>,
    /// The texts that these speak of.
    pub sources: Sources,
}

impl Compiled {
    /// The same tool as another Rust type.
    #[must_use]
    pub fn named(mut self, name: &str) -> Compiled {
        if let Some(tool) = &mut self.tool {
            name.clone_into(&mut tool.model.name);
        }
        self.name = self.name.map(|_| name.to_owned());
        self
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
    let (tree, mut reports) = syntax::parse(sources.own());
    let mut settings = Vec::new();
    for source in &sources.all()[1..] {
        let (given, found) = syntax::given(source);
        settings.extend(given);
        reports.extend(found);
    }
    let Some(tree) = tree else { return Compiled { tool: None, name: None, reports, sources } };
    let name = Some(tree.name.word.clone()).filter(|name| syntax::is_type_name(name));
    let (model, found) = resolve::resolve(&tree, &settings, &mut sources);
    let broken: BTreeSet<&str> = tree.broken.iter().map(String::as_str).collect();
    let said = any_error(&reports);
    reports.extend(found.into_iter().filter(|report| !said || !follows(report, &broken)));
    let tool = match model {
        Some(model) if !any_error(&reports) => match check(model, &mut reports) {
            Ok(tool) => Some(Box::new(tool)),
            Err(report) => {
                reports.push(report);
                None
            }
        },
        _ => None,
    };
    let tool = tool.filter(|_| !any_error(&reports));
    Compiled { tool, name, reports: told(reports), sources }
}

/// What is told of all that was found: in the order of the text, each mistake once, and no more
/// than can be read.
fn told(mut reports: Vec<Report>) -> Vec<Report> {
    reports.sort_by_key(|report| report.span.start);
    // A file that is mounted twice has its mistakes once.
    let mut seen = HashSet::new();
    reports.retain(|report| seen.insert(report.clone()));
    if reports.len() > report::MOST {
        let next = reports[report::MOST].span;
        reports.truncate(report::MOST);
        reports.push(
            Report::error(next, "more is wrong from here on").help("mend what stands above first"),
        );
    }
    reports
}

fn check(mut model: Model, reports: &mut Vec<Report>) -> Result<Checked, Report> {
    finite(&model)?;
    let extent = match bound::extent(&model) {
        Ok(extent) => extent,
        // A curve that has no value somewhere has no bound either: say so.
        Err(report) => {
            reports.extend(look::undefined(&model));
            return if any_error(reports) { Ok(Checked::nothing(model)) } else { Err(report) };
        }
    };
    reports.extend(look::look(&model, &extent));
    if any_error(reports) {
        // The plan would only repeat what is wrong.
        return Ok(Checked::nothing(model));
    }
    let envelope = bound::envelope(&model, &extent);
    let plan = plan::plan(&mut model, &extent)?;
    let mut tool = Checked { model, extent, envelope, plan, bounds: Bounds::NONE };
    let (bounds, found) = Bounds::of(&tool);
    tool.bounds = bounds;
    reports.extend(found);
    Ok(tool)
}

impl Checked {
    /// A tool of which something is wrong: its errors stand beside it and it goes no further.
    fn nothing(mut model: Model) -> Checked {
        let outside = Tree::Leaf(model.graph.int(0));
        let plan = Plan { owner: Tree::Leaf(None), inside: Tree::Leaf(false), outside };
        let extent = Extent::of(model.domain.whole(0.0), 0.0);
        Checked { model, extent, envelope: Vec::new(), plan, bounds: Bounds::NONE }
    }
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
