//! The page: sections in reading order, with style, script and data inside.

mod assumptions;
mod findings;
mod program;
mod summary;
mod tools;

use super::scene::{base64, json};
use super::{Content, Picture};
use crate::failure::Failure;
use crate::output::file_name;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use sha2::{Digest, Sha256};
use touchoff::Escaped;

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
    let findings = content.checked.findings().iter();
    let rows: Vec<_> = findings.map(|finding| content.checked.row(finding)).collect();
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
                    (summary::section(content, &title))
                    (view(content))
                    (findings::section(content))
                    (program::section(content)?)
                    (tools::section(content)?)
                    (assumptions::section(content))
                    (program::timing(content)?)
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
