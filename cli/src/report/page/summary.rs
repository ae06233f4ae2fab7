//! The verdict, and what it is about.

use super::super::Content;
use super::plain;
use crate::program::extent;
use maud::{Markup, html};
use std::collections::BTreeMap;
use touchoff::Unit;
use touchoff_verify::Verdict;
use touchoff_verify::job::{PairReport, Severity};

pub(super) fn section(content: &Content<'_>, title: &str) -> Markup {
    html! {
        header {
            h1 { (title) }
            (verdict(content))
        }
        section {
            h2 { "Summary" }
            table.plain {
                @for (key, values) in rows(content) {
                    tr { th { (key) } td.text { @for value in &values { div { (value) } } } }
                }
            }
        }
    }
}

/// Returns the verdict, as the exit status of `verify` states it.
fn verdict(content: &Content<'_>) -> Markup {
    let refusals = content.checked.refusals();
    let count = |severity: Severity| {
        content.checked.findings().iter().filter(|finding| finding.severity == severity).count()
    };
    let [violations, undecided, remarks] =
        [Severity::Violation, Severity::Undecided, Severity::Remark].map(count);
    let plural = |count: usize| if count == 1 { "" } else { "s" };
    let (class, text) = if content.checked.verdict() == Verdict::None {
        ("open", "Not verified".to_owned())
    } else if violations > 0 {
        ("bad", format!("{violations} violation{}", plural(violations)))
    } else if undecided > 0 {
        ("open", format!("No violation found, {undecided} finding{} undecided", plural(undecided)))
    } else {
        ("good", "No findings: every motion is proved to stay within its limits".to_owned())
    };
    html! {
        p.verdict.(class) {
            strong { (text) }
            @if violations > 0 && undecided > 0 { " and " (undecided) " undecided" }
            @if remarks > 0 { "; " (remarks) " warning" (plural(remarks)) }
        }
        @for reason in &refusals { p.reason { "Not verified: " (plain(reason)) } }
    }
}

/// Returns the rows of the summary: a key and its values.
fn rows(content: &Content<'_>) -> Vec<(&'static str, Vec<String>)> {
    let (inputs, checked) = (content.inputs, content.checked);
    let (job, unit) = (&inputs.file, inputs.file.unit);
    let part = &inputs.bodies[0];
    let sides = {
        let [low, high] = part.mesh.bounds();
        let [x, y, z]: [f64; 3] = (high - low).into();
        format!(
            "{} x {} x {}, {} triangles",
            unit.format(x),
            unit.format(y),
            unit.format(z),
            part.mesh.triangles().len()
        )
    };
    let mut rows = vec![("Part", vec![plain(&job.part.display().to_string()), sides])];
    let is_shown =
        |pair: &&PairReport| pair.body == 0 && pair.reading == 0 && pair.report.moves > 0;
    let pairs = checked.pairs.iter().filter(is_shown);
    let mut program = vec![plain(&job.program.display().to_string())];
    program.extend(pairs.flat_map(|pair| travel(pair, checked.tool(pair).number(), unit)));
    rows.push(("Program", program));
    let tools = checked.job.tools.iter().map(|tool| {
        let info = tool.tool.info();
        let number = tool.number().map_or(String::new(), |number| format!("T{number} "));
        plain(&format!("{number}{} {}", info.name, info.title))
    });
    rows.push(("Tools", tools.collect()));
    let fixtures = inputs.bodies.iter().skip(1).map(|body| plain(&body.name));
    let fixtures: Vec<String> = fixtures.collect();
    if !fixtures.is_empty() {
        rows.push(("Fixtures", fixtures));
    }
    let summaries = checked.summaries().into_iter().map(|summary| plain(&summary));
    rows.push(("Checked", summaries.collect()));
    if let (Some(cut), Some(comparison)) = (checked.cut(), &content.comparison) {
        let stock = &cut.stock;
        rows.push((
            "Stock",
            vec![
                format!("{} of {} points remain", stock.len(), stock.initial_len()),
                cut.farthest("most material over the part", comparison.greatest_excess()),
                cut.farthest("most cut from the part", comparison.deepest_gouge()),
                cut.resolution(),
            ],
        ));
    }
    let gaps = checked.gaps.iter().map(|gap| plain(&format!("not checked: {gap}")));
    let gaps: Vec<String> = gaps.collect();
    if !gaps.is_empty() {
        rows.push(("Not checked", gaps));
    }
    let mut rules: BTreeMap<&str, usize> = BTreeMap::new();
    for finding in checked.findings() {
        *rules.entry(finding.rule).or_default() += 1;
    }
    if !rules.is_empty() {
        let counts = rules.iter().map(|(rule, count)| format!("{count} {rule}"));
        rows.push(("Findings", vec![counts.collect::<Vec<_>>().join(", ")]));
    }
    rows
}

/// Describes where a program goes.
fn travel(pair: &PairReport, number: Option<u32>, unit: Unit) -> [String; 3] {
    let report = &pair.report;
    let approach = &report.approach;
    let nearest = match (approach.distance, approach.line) {
        (0.0, line) => format!("the tool touches the part, first at line {line}"),
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
