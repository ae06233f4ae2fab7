//! Charts along the program, and how long the work took.

use super::super::{Content, charts};
use super::{image, plain};
use crate::failure::Failure;
use crate::timing::Timing;
use maud::{Markup, html};

/// Returns the charts along the program.
///
/// # Errors
/// If a chart cannot be drawn.
pub(super) fn section(content: &Content<'_>) -> Result<Markup, Failure> {
    let job = content.checked.job;
    let mut parts = Vec::new();
    for along in &content.along {
        let tool = &job.tools[along.tool];
        let name = plain(&tool.tool.info().name);
        let number = tool.number().map_or(String::new(), |number| format!("T{number} "));
        let charts = charts::along(along, job.unit(), job.tolerance)?;
        parts.push(html! {
            h3 { (number) (name) }
            @if charts.is_empty() {
                p { "Nothing to show: no position of the tool is known." }
            }
            @for chart in &charts {
                figure.chart {
                    figcaption { b { (chart.title) ". " } (chart.caption) }
                    (image("svg+xml", chart.svg.as_bytes(), &chart.title))
                }
            }
        });
    }
    Ok(html! {
        section { h2 { "Along the program" } @for part in &parts { (part) } }
    })
}

/// Returns how long the work took.
///
/// # Errors
/// If a chart cannot be drawn.
pub(super) fn timing(content: &Content<'_>) -> Result<Markup, Failure> {
    let samples = || content.along.iter().flat_map(|along| &along.samples);
    let kinds: [(&str, Vec<u64>); 2] = [
        ("query for force and torque", samples().map(|sample| sample.query_ns).collect()),
        ("proof of depth at a position", samples().map(|sample| sample.proof_ns).collect()),
    ];
    let mut histograms = Vec::new();
    for (what, mut times) in kinds {
        if times.is_empty() {
            continue;
        }
        let svg = charts::histogram(&times, what)?;
        let Timing { p50, p99, max, .. } = Timing::of(&mut times);
        let micros = |ns: u64| format!("{:.1} µs", ns as f64 / 1e3);
        let text = format!(
            "Time of a {what}: median {}, 99 % within {}, longest {}.",
            micros(p50),
            micros(p99),
            micros(max)
        );
        histograms.push(html! {
            figure { figcaption { (text) } (image("svg+xml", svg.as_bytes(), what)) }
        });
    }
    Ok(html! {
        section {
            h2 { "Timing" }
            table.plain {
                @for (what, duration) in &content.times {
                    tr { th { (what) } td { (format!("{:.2} s", duration.as_secs_f64())) } }
                }
            }
            div.row { @for histogram in &histograms { (histogram) } }
        }
    })
}
