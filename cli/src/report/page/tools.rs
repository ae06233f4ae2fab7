//! The tools: drawings, and what is proved about them.

use super::super::Content;
use super::{image, plain};
use crate::check::proof;
use crate::failure::Failure;
use maud::{Markup, html};
use tool_drawing::{Content as Drawn, TextRendering, svg};

pub(super) fn section(content: &Content<'_>) -> Result<Markup, Failure> {
    let mut tools = Vec::new();
    let tools_of_job = content.inputs.tools.iter().zip(&content.checked.job.tools);
    for ((source, tool), shape) in tools_of_job.zip(&content.shapes) {
        let info = tool.tool.info();
        let compiled = source.compile()?;
        let drawing = compiled.tool().map(|tool| svg(tool, Drawn::Outline, TextRendering::Strokes));
        let proof = proof(compiled)?;
        let number = tool.number().map_or(String::new(), |number| format!("T{number} "));
        let name = plain(&info.name);
        tools.push(html! {
            h3 { (number) (name) @if !info.title.is_empty() { ": " (plain(&info.title)) } }
            div.tool {
                @if let Some(drawing) = &drawing {
                    figure { (image("svg+xml", drawing.as_bytes(), &format!("drawing of {name}, lengths in {}", info.unit))) }
                }
                div {
                    @if let Some((description, lines)) = &proof {
                        p { (plain(description)) }
                        p { "Proved by " code { "touchoff check" } ":" }
                        ul { @for line in lines.lines().filter(|line| !line.trim().is_empty()) { li { (plain(line.trim())) } } }
                    }
                    p.note { "Lengths in " (info.unit) ". Digest of the tool's meaning: " code { (format!("{:016x}", info.digest)) } "." }
                    @if !shape.is_exact {
                        p.note { "The tool has no profile: pictures show cylinders that contain it." }
                    }
                }
            }
        });
    }
    Ok(html! { section { h2 { "Tools" } @for tool in &tools { (tool) } } })
}
