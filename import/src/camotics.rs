//! Tool tables of CAMotics, as JSON: an object with a tool for each number, or such an object `tools` in a project
//! (`.camotics`).
//!
//! A tool is one body of `length` from the tip: a cylinder, a cone, a cylinder with a ball as its end, or a truncated
//! cone whose tip has the diameter `snub_diameter`.

use super::entry::{Entry, Note};
use super::json::{Object, number_of, string};
use super::shape::{Cutter, Shape};
use super::{Found, MAX_TOOLS, Problem};
use serde_json::Value;
use touchoff::Unit;

/// Returns true for a table of CAMotics.
pub(super) fn is_table(value: &Object) -> bool {
    !value.is_empty()
        && value.iter().all(|(key, tool)| key.parse::<u32>().is_ok() && tool.get("shape").is_some())
}

/// Reads the tools of a table, by their numbers.
pub(super) fn read(table: &Object) -> Vec<Found> {
    let mut tools: Vec<(u32, &Value)> =
        table.iter().filter_map(|(key, tool)| Some((key.parse().ok()?, tool))).collect();
    tools.sort_by_key(|(number, _)| *number);
    tools.into_iter().take(MAX_TOOLS + 1).map(|(number, tool)| read_tool(number, tool)).collect()
}

fn read_tool(number: u32, value: &Value) -> Found {
    let label = format!("T{number}");
    let Some(tool) = value.as_object() else {
        return Err(Problem::new(&label, "it is no object"));
    };
    entry(number, tool)
        .map_err(|reason| Problem { number: Some(number), ..Problem::new(&label, &reason) })
}

fn entry(number: u32, tool: &Object) -> Result<Entry, String> {
    let unit = match string(tool, "units").to_ascii_lowercase().as_str() {
        "metric" | "mm" => Unit::Millimetre,
        "imperial" | "inch" => Unit::Inch,
        "" => return Err("it states no units".to_owned()),
        other => return Err(format!("its units are `{other}`, not `metric` or `imperial`")),
    };
    let stated = |key: &str| number_of(tool, key).ok_or_else(|| format!("it states no `{key}`"));
    let (diameter, length) = (stated("diameter")?, stated("length")?);
    let shape = match string(tool, "shape").to_ascii_lowercase().as_str() {
        "cylindrical" => Shape::Flat { corner: 0.0 },
        "ballnose" => Shape::Ball,
        "conical" => Shape::TruncatedCone { tip_diameter: 0.0 },
        "snubnose" => Shape::TruncatedCone { tip_diameter: stated("snub_diameter")? },
        other => return Err(format!("the shape `{other}` cannot be read yet")),
    };
    let mut entry =
        Entry::new(unit, string(tool, "shape"), string(tool, "description"), Vec::new());
    entry.number = Some(number);
    let drawn = "the tool ends with its length".to_owned();
    entry.notes.push(Note::Unstated("shank and the holder", drawn));
    entry.cutter = Some(Cutter {
        shape,
        diameter,
        flute_length: length,
        length,
        shoulder: None,
        cutting_neck: 0.0,
        shank_diameter: None,
    });
    Ok(entry)
}
