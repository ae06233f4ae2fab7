//! The summary of the page: the verdict, and what it is about.

use super::super::{Content, prefix};
use super::plain;
use crate::program::extent;
use maud::{Markup, html};
use std::collections::BTreeMap;
use touchoff::Unit;
use touchoff_verify::job::{JobBody, PairReport};
use touchoff_verify::{JobTool, Verdict};

/// Returns the verdict, and what it is about.
pub(super) fn summary(content: &Content<'_>, title: &str) -> Markup {
    html! {
        header {
            h1 { (title) }
            (verdict(content))
        }
        section {
            h2 { "Summary" }
            table.plain {
                @for Fact { key, values } in facts(content) {
                    tr { th { (key) } td.text { @for value in &values { div { (value) } } } }
                }
            }
        }
    }
}

/// Returns the verdict, as `verify` states it.
fn verdict(content: &Content<'_>) -> Markup {
    let class = match content.checked.verdict() {
        Verdict::Clean => "good",
        Verdict::Findings => "bad",
        Verdict::None => "open",
    };
    html! {
        p.verdict.(class) { strong { (content.checked.headline()) } }
        @for reason in content.checked.refusals() {
            p.reason { "Not verified: " (plain(&reason.to_string())) " [" (reason.code()) "]" }
        }
    }
}

/// A row of the summary.
struct Fact {
    key: &'static str,
    values: Vec<String>,
}

/// Returns the rows of the summary that have values.
fn facts(content: &Content<'_>) -> Vec<Fact> {
    let checked = content.checked;
    let tools = checked.job.tools.iter().map(|tool| {
        let info = tool.tool.info();
        plain(&format!("{}{} {}", prefix(tool.number()), info.name, info.title))
    });
    let named = |is_wanted: fn(&JobBody) -> bool| {
        let bodies = content.inputs.bodies.iter().skip(1).filter(move |body| is_wanted(body));
        bodies.map(|body| plain(&body.name)).collect::<Vec<String>>()
    };
    let revolved = checked.job.revolved.iter().map(|body| plain(&body.name));
    let machine = revolved.chain(named(JobBody::is_of_machine));
    let summaries = checked.summaries().into_iter().map(|summary| plain(&summary));
    let gaps =
        checked.gaps.iter().map(|gap| format!("{} [{}]", plain(&gap.to_string()), gap.code()));
    let facts = [
        Fact { key: "Part", values: part(content) },
        Fact { key: "Program", values: program(content) },
        Fact { key: "Tools", values: tools.collect() },
        Fact { key: "Other parts", values: named(JobBody::is_other_part) },
        Fact { key: "Fixtures", values: named(JobBody::is_fixture) },
        Fact { key: "Bodies of the machine", values: machine.collect() },
        Fact { key: "Checked", values: summaries.collect() },
        Fact { key: "Stock", values: stock(content) },
        Fact { key: "Not checked", values: gaps.collect() },
        Fact { key: "Findings", values: counts(content) },
    ];
    facts.into_iter().filter(|fact| !fact.values.is_empty()).collect()
}

/// Describes the part: its file, and its size.
fn part(content: &Content<'_>) -> Vec<String> {
    let (job, mesh) = (&content.inputs.file, &content.inputs.bodies[0].mesh);
    let [low, high] = mesh.bounds();
    let [x, y, z] = <[f64; 3]>::from(high - low).map(|side| job.unit.format(side));
    let size = format!("{x} x {y} x {z}, {} triangles", mesh.triangles().len());
    vec![plain(&job.part.display().to_string()), size]
}

/// Describes the program: its file, and where it goes.
fn program(content: &Content<'_>) -> Vec<String> {
    let (job, checked) = (&content.inputs.file, content.checked);
    // Once per tool: at every body and in every reading it goes the same way.
    let pairs = checked.tools_at_part().filter(|pair| pair.report.moves > 0);
    let travels =
        pairs.flat_map(|pair| travel(pair, checked.tool(pair).and_then(JobTool::number), job.unit));
    std::iter::once(plain(&job.program.display().to_string())).chain(travels).collect()
}

/// Describes what is left of the stock, if there is one.
fn stock(content: &Content<'_>) -> Vec<String> {
    let (Some(cut), Some(comparison)) = (content.checked.cut(), &content.comparison) else {
        return Vec::new();
    };
    vec![
        format!("{} of {} points remain", cut.stock.len(), cut.stock.initial_len()),
        cut.farthest("most material over the part", comparison.greatest_excess()),
        cut.farthest("most cut from the part", comparison.deepest_gouge()),
        cut.resolution(),
    ]
}

/// Counts the findings by their rules, if there are any.
fn counts(content: &Content<'_>) -> Vec<String> {
    let mut rules: BTreeMap<&str, usize> = BTreeMap::new();
    for finding in content.checked.findings() {
        *rules.entry(finding.rule.keyword()).or_default() += 1;
    }
    let counts: Vec<_> = rules.iter().map(|(rule, count)| format!("{count} {rule}")).collect();
    if counts.is_empty() { counts } else { vec![counts.join(", ")] }
}

/// Describes where a program goes.
fn travel(pair: &PairReport, number: Option<u32>, unit: Unit) -> [String; 3] {
    let report = &pair.report;
    let approach = &report.approach;
    let nearest = match (approach.distance, approach.line) {
        (0.0, line) => format!("the tool touches the part, first at line {line}"),
        (f64::INFINITY, _) => "the tool has no profile: its distance is not known".into(),
        (distance, line) => {
            format!("the tool comes within {} of the part, line {line}", unit.format(distance))
        }
    };
    let tool = number.map_or(String::new(), |number| format!("T{number}: "));
    let [feed, rapid] = approach.travel;
    [
        format!(
            "{tool}{} positions, tips in {} in {unit}",
            report.moves,
            extent(approach.program, unit)
        ),
        format!("{tool}{} in feed and {} in rapid traverse", unit.format(feed), unit.format(rapid)),
        format!("{tool}{nearest}"),
    ]
}
