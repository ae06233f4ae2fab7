//! `touchoff export`: tools in the formats of CAM systems.

use crate::arguments::Export;
use crate::failure::Failure;
use crate::import::LEFT_OUT;
use crate::loaded_tool::LoadedTool;
use crate::output::{Output, extension, refuse_inputs, write_file};
use serde::Serialize;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use touchoff::Escaped;
use touchoff::tool::ToolInfo;
use touchoff_import::Libraries;
use touchoff_import::export::{Format, export as export_tools};

/// One line of `export --json`.
#[derive(Serialize)]
struct Row<'a> {
    name: &'a str,
    #[serde(rename = "type", skip_serializing_if = "Option::is_none")]
    kind: Option<&'a str>,
    gaps: &'a [String],
    #[serde(skip_serializing_if = "Option::is_none")]
    left_out: Option<&'a str>,
}

/// Exports tools into one file, and prints one line per tool.
pub(crate) fn export(arguments: &Export, json: bool) -> Result<ExitCode, Failure> {
    let Export { tools: names, output, tool } = arguments;
    let format = match extension(output).as_deref() {
        Some("json") => Format::Fusion,
        Some("fctb") => Format::FreeCad,
        Some("apt") => Format::Apt,
        _ => {
            let rule = "a library ends in `.json` (Fusion 360), `.fctb` (FreeCAD) or `.apt`";
            return Err(Failure::extension(rule, output, "json"));
        }
    };
    refuse_inputs([&**output], names.iter().map(Path::new).chain(tool.library.as_deref()))?;
    let mut libraries = Libraries::default();
    let tools: Vec<LoadedTool> = names
        .iter()
        .map(|name| LoadedTool::load_from(name, tool, &mut libraries))
        .collect::<Result<_, _>>()?;
    let infos: Vec<&ToolInfo> = tools.iter().map(|tool| tool.tool().info()).collect();
    let exported = export_tools(&infos, format);
    let mut out = Output::lines();
    for tool in &exported.tools {
        let (kind, left_out) = match &tool.kind {
            Ok(kind) => (Some(kind.as_str()), None),
            Err(reason) => (None, Some(reason.as_str())),
        };
        if json {
            let row = Row { name: &tool.name, kind, gaps: &tool.gaps, left_out };
            out.json(&row)?;
            continue;
        }
        if let Some(reason) = left_out {
            message!("left out: {}: {reason}", Escaped(&tool.name));
        }
        if let Some(kind) = kind {
            writeln!(out, "{:<24} {kind}", Escaped(&tool.name))?;
        }
        for gap in &tool.gaps {
            message!("warning: {}: {gap}", Escaped(&tool.name));
        }
    }
    out.flush()?;
    // A file without a tool would replace one that has some.
    let left_out = exported.tools.iter().filter(|tool| tool.kind.is_err()).count();
    if left_out < exported.tools.len() {
        write_file(output, exported.text)?;
    }
    Ok(if left_out == 0 { ExitCode::SUCCESS } else { ExitCode::from(LEFT_OUT) })
}
