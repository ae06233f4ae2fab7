//! The page: sections in reading order, with style, script and data inside.

use super::along::{self, POINTS};
use super::scene::{base64, json};
use super::{Content, Picture, prefix};
use crate::check::{Proved, prove};
use crate::failure::Failure;
use crate::output::file_name;
use crate::postures::picture::describe;
use crate::program::{extent, ignored_words};
use crate::timing::Timing;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use touchoff::{Escaped, Unit};
use touchoff_drawing::{Content as Drawn, TextRendering, svg};
use touchoff_verify::job::{PairReport, Severity};
use touchoff_verify::machine::Machine;
use touchoff_verify::{Program, Verdict, Verifier};

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

/// Returns the verdict, and what it is about.
fn summary(content: &Content<'_>, title: &str) -> Markup {
    html! {
        header {
            h1 { (title) }
            (verdict(content))
        }
        section {
            h2 { "Summary" }
            table.plain {
                @for (key, values) in facts(content) {
                    tr { th { (key) } td.text { @for value in &values { div { (value) } } } }
                }
            }
        }
    }
}

/// Returns the ending of a noun after a count.
fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}

/// Returns the verdict, as the exit status of `verify` states it.
fn verdict(content: &Content<'_>) -> Markup {
    let refusals = content.checked.refusals();
    let [violations, undecided, remarks] =
        [Severity::Violation, Severity::Undecided, Severity::Remark].map(|severity| {
            content.checked.findings().iter().filter(|finding| finding.severity == severity).count()
        });
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
fn facts(content: &Content<'_>) -> Vec<(&'static str, Vec<String>)> {
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
    // Once per tool: at every body and in every reading it goes the same way.
    let pairs = checked
        .pairs
        .iter()
        .filter(|pair| pair.body == 0 && pair.reading == 0 && pair.report.moves > 0);
    let mut program = vec![plain(&job.program.display().to_string())];
    program.extend(pairs.flat_map(|pair| travel(pair, checked.tool(pair).number(), unit)));
    rows.push(("Program", program));
    let tools = checked.job.tools.iter().map(|tool| {
        let info = tool.tool.info();
        let number = prefix(tool.number());
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
    let gaps = checked.gaps.iter().map(|gap| plain(&gap.to_string()));
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

/// Returns the 3-D view, and the pictures that stand in for it in print and without a script.
fn view(content: &Content<'_>) -> Markup {
    let has_fixtures = content.inputs.bodies.len() > 1;
    html! {
        section id="view" {
            h2 { "The part" }
            div.viewer {
                div.controls {
                    label { "colours: " select id="layer" {} }
                    @if has_fixtures {
                        label { input type="checkbox" id="fixtures"; " fixtures" }
                    }
                    label { input type="checkbox" id="cut" checked; " cut away what hides a finding" }
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

/// Returns the findings, the worst first, and pictures of the worst.
fn findings(content: &Content<'_>) -> Markup {
    html! {
        section {
            h2 { "Findings" }
            @if content.checked.findings().is_empty() {
                p { "None." }
            } @else {
                table.findings {
                    thead { tr { th { "#" } th { "severity" } th { "kind" } th { "line" } th { "lines" } th { "finding" } th {} } }
                    tbody {
                        @for (index, finding) in content.checked.findings().iter().enumerate() {
                            @let (class, severity) = severity(finding.severity);
                            @let [first, last] = finding.lines;
                            tr id={ "finding-" (index + 1) } {
                                td.number { (index + 1) }
                                td { span.badge.(class) { (severity) } }
                                td.name { (finding.rule) }
                                td.number { (finding.line) }
                                td.number { (first) @if last != first { " to " (last) } }
                                td.text { (plain(&finding.text)) }
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
    let mut shown = Vec::new();
    let tools_of_job = content.inputs.tools.iter().zip(&content.checked.job.tools);
    for ((source, tool), shape) in tools_of_job.zip(&content.shapes) {
        let info = tool.tool.info();
        let compiled = source.compile()?;
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

/// Returns the assumptions of the check, and its files.
fn assumptions(content: &Content<'_>) -> Markup {
    html! {
        section {
            h2 { "What was assumed" }
            ul { @for line in assumed(content) { li { (plain(&line)) } } }
            h3 { "Files" }
            table.files {
                thead { tr { th { "role" } th { "file" } th { "bytes" } th { "SHA-256" } } }
                tbody {
                    @for file in &content.files {
                        tr {
                            td.name { (plain(&file.role)) }
                            td.text { (plain(&file.name)) }
                            td.number { (file.bytes) }
                            td { code { (file.digest) } }
                        }
                    }
                }
            }
            p.note { "Written by touchoff " (env!("CARGO_PKG_VERSION")) ". Built-in tools are those of this version." }
        }
    }
}

fn assumed(content: &Content<'_>) -> Vec<String> {
    let inputs = content.inputs;
    let (job, unit) = (&inputs.file, inputs.file.unit);
    let resolution = job.resolution.unwrap_or_else(|| Verifier::default_resolution(unit));
    let mut lines = vec![
        format!(
            "Lengths are in {unit}. The part's file was read in this unit, and the program is in the frame of the part."
        ),
        format!(
            "No surface may be deeper in the part than {} (the tolerance), in rapid traverse whatever its allowance. An excess \
             of up to {} (the resolution) may be left unreported.",
            unit.format(job.tolerance),
            unit.format(resolution)
        ),
    ];
    let allowed = job.allow.iter().map(|(surface, depth)| match depth {
        depth if *depth == f64::INFINITY => format!("{surface} may be any depth"),
        depth if *depth < 0.0 => format!("{surface} keeps {}", unit.format(-depth)),
        depth => format!("{surface} may be {} deep", unit.format(*depth)),
    });
    let allowed: Vec<String> = allowed.collect();
    if !allowed.is_empty() {
        lines.push(format!("Allowances: {}.", allowed.join("; ")));
    }
    match &inputs.program {
        Program::Locations(programs) => {
            lines.push(
                "Between two positions the tip moves on a straight line and the axis turns evenly about the common normal of \
                 both axes."
                    .to_owned(),
            );
            if let Some(words) = ignored_words(programs) {
                lines.push(format!("Words that move nothing were ignored: {words}."));
            }
        }
        Program::Machine(readings) => {
            let control = match &job.control {
                Some(control) => format!("Control: {}.", control.display()),
                None => "No control is named: what every control does that is known is checked."
                    .to_owned(),
            };
            lines.push(format!(
                "Machine: {}. {control} Between two blocks the control interpolates its axes. G54 is the frame of the part.",
                inputs.program.machine().map_or("", Machine::name)
            ));
            if readings.len() > 1 {
                let each = readings.iter().map(|reading| reading.assumed().to_string());
                lines.push(format!(
                    "Readings of the program: {}.",
                    each.collect::<Vec<_>>().join("; ")
                ));
            }
        }
    }
    if job.anyway {
        lines.push("What is left open was accepted (`anyway`).".to_owned());
    }
    if content.checked.is_surface_only() {
        lines.push("The inside of a mesh is undefined; only its surface was checked.".to_owned());
    }
    lines.push(
        "The tool is its profile as drawn, turned about its axis. Deflection, runout, the rounding of corners by the control \
         and acceleration are not modelled."
            .to_owned(),
    );
    lines.push(match content.scene_rounding {
        Some(error) => format!("The 3-D view rounds coordinates by at most {error:.1e} {unit}."),
        None => {
            "The part has too many triangles for a 3-D view; pictures stand in for it.".to_owned()
        }
    });
    lines.push(
        "Long triangles are divided for colouring. The depth of findings is coloured by samples: the centre of each triangle, \
         points near its corners, and the deepest points found."
            .to_owned(),
    );
    lines.push(format!(
        "Depth and clearance along the program hold at the positions, not between them; findings hold for whole motions. \
         Forces are sums over {POINTS} sampled points."
    ));
    if let Some(named) = content.map {
        lines.push(format!("Posture map {}: {}.", named.file.display(), describe(named.map)));
    }
    lines
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
