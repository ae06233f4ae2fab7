//! The page: sections in reading order, with style, script and data inside.

mod assumptions;
mod summary;

use super::along;
use super::excerpt::{Excerpt, LineRole};
use super::scene::{base64, json};
use super::{Content, Picture, prefix};
use crate::check::{Proved, prove};
use crate::failure::Failure;
use crate::output::file_name;
use crate::timing::Timing;
use crate::verify;
use assumptions::assumptions;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use sha2::{Digest, Sha256};
use summary::summary;
use touchoff::Escaped;
use touchoff_drawing::{Content as Drawn, TextRendering, svg};
use touchoff_import::Libraries;
use touchoff_verify::job::Severity;

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("viewer.js");

/// Returns the policy of the page: nothing is loaded. Text of files cannot run as a script, since no hash allows it.
fn policy() -> String {
    let [style, script] =
        [STYLE, SCRIPT].map(|text| base64(Sha256::digest(text.as_bytes()).into_iter()));
    format!(
        "default-src 'none'; img-src data:; style-src 'sha256-{style}'; script-src 'sha256-{script}'"
    )
}

/// Returns the page.
///
/// # Errors
/// If a chart or a drawing cannot be made.
pub(super) fn html(content: &Content<'_>) -> Result<String, Failure> {
    let job = &content.inputs.file;
    let title = plain(&format!("{} on {}", file_name(&job.program), file_name(&job.part)));
    let rows = content.checked.findings().iter().map(|finding| content.checked.row(finding));
    let rows: Vec<_> = rows.collect();
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta http-equiv="Content-Security-Policy" content=(policy());
                title { (title) " - touchoff report" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                main {
                    (summary(content, &title))
                    (view(content))
                    (findings(content))
                    (along_program(content)?)
                    (tools(content)?)
                    (assumptions(content))
                    (timing(content)?)
                }
                script type="application/json" id="findings" { (PreEscaped(json(&rows)?)) }
                script type="application/json" id="scene" { (PreEscaped(&content.scene_json)) }
                script { (PreEscaped(SCRIPT)) }
            }
        }
    };
    Ok(page.into_string())
}

/// Returns text of files without the characters that a display interprets.
fn plain(text: &str) -> String {
    Escaped(text).to_string()
}

/// Returns an image that is part of the page. A drawing in it shares no names with other drawings.
fn image(kind: &str, bytes: &[u8], description: &str) -> Markup {
    let data = format!("data:image/{kind};base64,{}", base64(bytes.iter().copied()));
    html! { img src=(data) alt=(description); }
}

fn picture(picture: &Picture) -> Markup {
    image("png", &picture.png, &plain(&picture.caption))
}

/// Returns the 3-D view, and the pictures that stand in for it in print and without a script.
fn view(content: &Content<'_>) -> Markup {
    html! {
        section id="view" {
            h2 { "The part" }
            div.viewer {
                div.controls {
                    label { "colours: " select id="layer" {} }
                    label { input type="checkbox" id="cut" checked; " cut away what hides a finding" }
                    label { input type="checkbox" id="path" checked; " path of the tools" }
                    button type="button" id="whole" { "whole part" }
                }
                div.stage {
                    canvas id="canvas" tabindex="0" aria-label="the part in 3-D" {}
                    div id="heading" {}
                    div id="axes" {}
                    div id="scale" { span {} }
                }
                div.legend {
                    span id="low" {}
                    span id="ramp" {}
                    span id="high" {}
                    span.swatch {}
                    span id="nothing" {}
                }
                div.legend id="bodies" {}
                div.legend {
                    span { "path of the tip: " }
                    span.legend id="paths" {}
                    span { (content.path_caption) }
                }
                p.note {
                    "Drag to turn, shift and drag or two fingers to move; then the wheel zooms. Arrow keys turn, + and - zoom. A \
                     click on a finding moves the view there. The tool is drawn as glass, orange where it cuts."
                }
            }
            div.pictures {
                @for sheet in &content.sheets {
                    figure { (picture(sheet)) }
                }
            }
        }
    }
}

/// Returns the findings, the worst first, with the program around each, and pictures of the worst.
fn findings(content: &Content<'_>) -> Markup {
    html! {
        section {
            h2 { "Findings" }
            @if content.checked.findings().is_empty() {
                p { "None." }
            } @else {
                p.note {
                    "Violations come first, then what is undecided, then warnings; in each the worst comes first. In the text of \
                     the program " code { ">" } " marks the line of the worst motion and " code { "|" } " the other lines of the \
                     finding."
                }
                table.findings {
                    thead { tr { th { "#" } th { "severity" } th { "kind" } th { "line" } th { "lines" } th { "finding" } th {} } }
                    tbody {
                        @for (index, finding) in content.checked.findings().iter().enumerate() {
                            @let (class, severity) = severity(finding.severity);
                            @let [first, last] = finding.lines;
                            tr id={ "finding-" (index + 1) } {
                                td.number { (index + 1) }
                                td { span.badge.(class) { (severity) } }
                                td.name title=(finding.rule.code()) { (finding.rule) }
                                td.number { (finding.line) }
                                td.number { (first) @if last != first { " to " (last) } }
                                td.text {
                                    span.said { (plain(&finding.text)) }
                                    @for lines in &content.excerpts[index] { (excerpt(lines)) }
                                }
                                td {
                                    @if content.has_place[index] {
                                        button.show type="button" data-finding=(index) { "show" }
                                    }
                                }
                            }
                        }
                    }
                }
            }
            @if !content.close_ups.is_empty() {
                h3 { "The worst in pictures" }
                p.note { "The tool is drawn as glass, orange where it cuts. What stands in front of the place is cut away. Findings near a worse one are left out." }
                div.close-ups {
                    @for (index, close_up) in &content.close_ups {
                        figure {
                            a href={ "#finding-" (index + 1) } { (picture(close_up)) }
                            figcaption { (plain(&content.checked.findings()[*index].text)) }
                        }
                    }
                }
            }
        }
    }
}

/// Returns the lines of a file around a finding, closed until a reader opens them.
fn excerpt(Excerpt { file, lines }: &Excerpt) -> Markup {
    let [first, .., last] = &lines[..] else { return html! {} };
    let digits = last.number.to_string().len();
    let file = file.as_deref().unwrap_or("program");
    html! {
        details {
            summary { (plain(file)) ", lines " (first.number) " to " (last.number) }
            pre {
                @for line in lines {
                    @let (class, mark) = match line.role {
                        LineRole::Worst => (Some("worst"), '>'),
                        LineRole::Within => (Some("within"), '|'),
                        LineRole::Around => (None, ' '),
                    };
                    span class=[class] { (format!("{mark} {:digits$}  {}", line.number, line.text)) "\n" }
                }
            }
        }
    }
}

/// Returns the class and the name of a severity.
fn severity(severity: Severity) -> (&'static str, &'static str) {
    match severity {
        Severity::Violation => ("bad", "violation"),
        Severity::Undecided => ("open", "undecided"),
        Severity::Remark => ("remark", "warning"),
    }
}

/// Returns the charts along the program.
///
/// # Errors
/// If a chart cannot be drawn.
fn along_program(content: &Content<'_>) -> Result<Markup, Failure> {
    let job = content.checked.job;
    let mut parts = Vec::new();
    for along in &content.along {
        let tool = &job.tools[along.tool];
        let name = plain(&tool.tool.info().name);
        let number = prefix(tool.number());
        let charts = along::charts(along, job.unit(), job.tolerance)?;
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

/// Returns the tools: drawings, and what is proved about them.
///
/// # Errors
/// If a tool cannot be compiled any more.
fn tools(content: &Content<'_>) -> Result<Markup, Failure> {
    let (mut shown, mut libraries) = (Vec::new(), Libraries::default());
    let tools_of_job = content.inputs.tools.iter().zip(&content.checked.job.tools);
    for (((named, _), tool), shape) in tools_of_job.zip(&content.shapes) {
        let info = tool.tool.info();
        let compiled = verify::compile(named, &mut libraries)?;
        let drawing = compiled.tool().map(|tool| svg(tool, Drawn::Outline, TextRendering::Strokes));
        let proof = prove(compiled)?;
        let number = prefix(tool.number());
        let name = plain(&info.name);
        shown.push(html! {
            h3 { (number) (name) @if !info.title.is_empty() { ": " (plain(&info.title)) } }
            div.tool {
                @if let Some(drawing) = &drawing {
                    figure { (image("svg+xml", drawing.as_bytes(), &format!("drawing of {name}, lengths in {}", info.unit))) }
                }
                div {
                    @if let Some(Proved { description, certificate }) = &proof {
                        p { (plain(description)) }
                        p { "Proved by " code { "touchoff check" } ":" }
                        ul { @for line in certificate.lines().filter(|line| !line.trim().is_empty()) { li { (plain(line.trim())) } } }
                    }
                    p.note { "Lengths in " (info.unit) ". Digest of the tool's meaning: " code { (format!("{:016x}", info.digest)) } "." }
                    @if !shape.is_exact {
                        p.note { "The tool has no profile: pictures show cylinders that contain it." }
                    }
                }
            }
        });
    }
    Ok(html! { section { h2 { "Tools" } @for tool in &shown { (tool) } } })
}

/// Returns how long the work took.
///
/// # Errors
/// If a chart cannot be drawn.
fn timing(content: &Content<'_>) -> Result<Markup, Failure> {
    let samples = content.along.iter().flat_map(|along| &along.samples);
    let (queries, proofs): (Vec<u64>, Vec<u64>) =
        samples.map(|sample| (sample.query_ns, sample.proof_ns)).unzip();
    let mut histograms = Vec::new();
    for (what, mut times) in
        [("query for force and torque", queries), ("proof of depth at a position", proofs)]
    {
        if times.is_empty() {
            continue;
        }
        let svg = along::histogram(&times, what)?;
        let Timing { p50, p99, max, .. } = Timing::of(&mut times);
        let [median, within, longest] = [p50, p99, max].map(|ns| ns as f64 / 1e3);
        let text = format!(
            "Time of a {what}: median {median:.1} µs, 99 % within {within:.1} µs, longest {longest:.1} µs."
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
