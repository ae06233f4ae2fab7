//! The verdict, and what it is about.

use super::super::Content;
use super::plain;
use crate::lengths::format_length;
use crate::program::extent;
use crate::verify::{self, CheckedPair, Severity};
use maud::{Markup, html};
use std::collections::BTreeMap;
use touchoff::Unit;

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
    let refusals = content.verification.refusals();
    let count = |severity: Severity| {
        content.entries.iter().filter(|entry| entry.severity == severity).count()
    };
    let [violations, undecided, remarks] =
        [Severity::Violation, Severity::Undecided, Severity::Remark].map(count);
    let plural = |count: usize| if count == 1 { "" } else { "s" };
    let (class, text) = if content.verification.status(content.entries) == verify::NOT_CHECKED {
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
    let (inputs, verification) = (content.inputs, content.verification);
    let (job, unit) = (&inputs.job, inputs.job.unit);
    let part = &inputs.bodies[0];
    let sides = {
        let [low, high] = part.mesh.bounds();
        let [x, y, z]: [f64; 3] = (high - low).into();
        format!(
            "{} x {} x {}, {} triangles",
            format_length(x, unit),
            format_length(y, unit),
            format_length(z, unit),
            part.mesh.triangles().len()
        )
    };
    let mut rows = vec![("Part", vec![plain(&job.part.display().to_string()), sides])];
    let pairs = verification
        .pairs
        .iter()
        .filter(|pair| pair.is_part && pair.reading == 0 && pair.report.moves > 0);
    let mut program = vec![plain(&job.program.display().to_string())];
    program.extend(pairs.flat_map(|pair| travel(pair, unit)));
    rows.push(("Program", program));
    let tools = inputs.tools.iter().map(|tool| {
        let info = tool.tool().info();
        let number = tool.number.map_or(String::new(), |number| format!("T{number} "));
        plain(&format!("{number}{} {}", info.name, info.title))
    });
    rows.push(("Tools", tools.collect()));
    let fixtures = inputs.bodies.iter().skip(1).map(|body| plain(&body.name));
    let fixtures: Vec<String> = fixtures.collect();
    if !fixtures.is_empty() {
        rows.push(("Fixtures", fixtures));
    }
    let checked = verification.summaries().into_iter().map(|summary| plain(&summary));
    rows.push(("Checked", checked.collect()));
    if let (Some(cut), Some(comparison)) = (verification.cut(), &content.comparison) {
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
    let gaps = verification.gaps.iter().map(|gap| plain(&verify::not_checked(gap)));
    let gaps: Vec<String> = gaps.collect();
    if !gaps.is_empty() {
        rows.push(("Not checked", gaps));
    }
    let mut rules: BTreeMap<&str, usize> = BTreeMap::new();
    for entry in content.entries {
        *rules.entry(entry.rule).or_default() += 1;
    }
    if !rules.is_empty() {
        let counts = rules.iter().map(|(rule, count)| format!("{count} {rule}"));
        rows.push(("Findings", vec![counts.collect::<Vec<_>>().join(", ")]));
    }
    rows
}

/// Describes where a program goes.
fn travel(pair: &CheckedPair<'_>, unit: Unit) -> [String; 3] {
    let report = &pair.report;
    let approach = &report.approach;
    let nearest = match (approach.distance, approach.line) {
        (0.0, line) => format!("the tool touches the part, first at line {line}"),
        (distance, line) => {
            format!(
                "the tool comes within {} of the part, line {line}",
                format_length(distance, unit)
            )
        }
    };
    let tool = pair.scope.number.map_or(String::new(), |number| format!("T{number}: "));
    let [feed, rapid] = approach.travel;
    [
        format!(
            "{tool}{} positions, tips in {} in {unit}",
            report.moves,
            extent(approach.program, unit)
        ),
        format!(
            "{tool}{} in feed and {} in rapid traverse",
            format_length(feed, unit),
            format_length(rapid, unit)
        ),
        format!("{tool}{nearest}"),
    ]
}
