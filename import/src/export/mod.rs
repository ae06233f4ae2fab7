//! Export of tools to the libraries of CAM systems.
//!
//! ```text
//! ToolInfo ──section──▶ cutter, shaft, holder ──recognise──▶ dimensions ──format──▶ text ──import──▶ the same outline?
//! ```
//!
//! Formats state types and dimensions, not outlines. So an outline is compared with those of the types, and what was
//! written is imported again: a tool is exported only if the result has its outline. Names of surfaces, params, laws and
//! regions have no place in these formats.

mod apt;
mod freecad;
mod fusion;
mod section;

use crate::Library;
use section::{HalfSection, same};
use std::path::Path;
use touchoff::Unit;
use touchoff::tool::{ProfileSegment, Tool, ToolInfo};

/// A format to export to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// Fusion 360, JSON: cutter, shaft and holder.
    Fusion,
    /// FreeCAD: a tool bit, `.fctb`, without its holder.
    FreeCad,
    /// An APT program of `CUTTER` statements: the cutting part.
    Apt,
}

/// An exported library.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Export {
    /// The text of the file.
    pub text: String,
    /// The result for each tool, in order.
    pub tools: Vec<ExportedTool>,
}

/// The result for one tool.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ExportedTool {
    /// The tool's name.
    pub name: String,
    /// The type in the format, or the reason why the tool was left out.
    pub kind: Result<String, String>,
    /// The format's gaps: what of the tool is not in the file.
    pub gaps: Vec<String>,
}

/// A tool as a format writes it.
struct Written<T> {
    entry: T,
    kind: String,
    gaps: Vec<String>,
}

/// Exports tools to one file.
///
/// The tools are numbered from 1. A tool whose outline the format cannot express is left out, with the reason. FreeCAD's
/// files have one tool: further ones are left out.
pub fn export(tools: &[&ToolInfo], format: Format) -> Export {
    match format {
        Format::Fusion => collect(tools, true, fusion::write, |entries| fusion::text(&entries)),
        // FreeCAD's lengths are written in mm.
        Format::FreeCad => collect(tools, false, freecad::write, |entries| entries.concat()),
        Format::Apt => collect(tools, true, apt::write, |entries| apt::text(&entries)),
    }
}

fn collect<T>(
    tools: &[&ToolInfo],
    has_inches: bool,
    write: impl Fn(&ToolInfo, &HalfSection, usize) -> Result<Written<T>, String>,
    text: impl Fn(Vec<T>) -> String,
) -> Export {
    let (mut entries, mut results) = (Vec::new(), Vec::new());
    for (index, tool) in tools.iter().enumerate() {
        let unit =
            if tool.unit == Unit::Inch && has_inches { Unit::Inch } else { Unit::Millimetre };
        let written =
            HalfSection::of(tool, unit).and_then(|section| write(tool, &section, index + 1));
        let (kind, gaps) = match written {
            Ok(Written { entry, kind, gaps }) => {
                entries.push(entry);
                (Ok(kind), gaps)
            }
            Err(reason) => (Err(reason), Vec::new()),
        };
        results.push(ExportedTool { name: tool.name.to_string(), kind, gaps });
    }
    Export { text: text(entries), tools: results }
}

/// Returns true if a file, imported again, has this outline.
fn is_same(file: &str, text: &str, outline: &[ProfileSegment]) -> bool {
    let Ok(library) = Library::parse(Path::new(file), text.as_bytes()) else { return false };
    let [tool] = library.tools() else { return false };
    tool.load().is_ok_and(|tool| same(&tool.info().outline, outline))
}

/// Returns the tool's title, or its name.
fn description(tool: &ToolInfo) -> &str {
    if tool.title.is_empty() { &tool.name } else { &tool.title }
}
