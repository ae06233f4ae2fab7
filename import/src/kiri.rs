//! Tools of Kiri:Moto, as JSON: a list, or a list `tools` in the settings of a device.
//!
//! Lengths are in millimetres if `metric` is true, and in inches otherwise. The flutes begin at the tip, and the shaft
//! above them. `taper_tip` is the diameter of a tapered mill's tip.

use super::entry::{Entry, Note};
use super::json::{Object, number_of, string};
use super::shape::{Cutter, Shape};
use super::{Found, Problem};
use serde_json::Value;
use touchoff::Unit;

/// Returns true for a tool of Kiri:Moto.
pub(super) fn is_tool(value: &Value) -> bool {
    value.get("flute_diam").is_some()
}

pub(super) fn tool(value: &Value) -> Found {
    let Some(tool) = value.as_object() else {
        return Err(Problem::new("entry", "it is no object"));
    };
    let number = tool.get("number");
    read_tool(tool).map_err(|reason| Problem::new(string(tool, "name"), &reason).numbered(number))
}

fn read_tool(tool: &Object) -> Result<Entry, String> {
    let unit = match tool.get("metric").and_then(Value::as_bool) {
        Some(true) => Unit::Millimetre,
        Some(false) => Unit::Inch,
        None => return Err("`metric` is neither true nor false".to_owned()),
    };
    let length =
        |key: &str| number_of(tool, key).ok_or_else(|| format!("it states no length `{key}`"));
    let (diameter, flute_length) = (length("flute_diam")?, length("flute_len")?);
    let shaft_length = length("shaft_len")?;
    let kind = string(tool, "type");
    let mut entry = Entry::new(unit, kind, string(tool, "name"), Vec::new());
    entry.set_number(tool.get("number"));
    let shape = match kind {
        "endmill" => Shape::Flat { corner: 0.0 },
        "ballmill" => Shape::Ball,
        "tapermill" => Shape::TruncatedCone { tip_diameter: length("taper_tip")? },
        "drill" => {
            let drawn = "its end is drawn flat".to_owned();
            entry.notes.push(Note::Unstated("angle of the point", drawn));
            Shape::Flat { corner: 0.0 }
        }
        other => return Err(format!("the type `{other}` cannot be read yet")),
    };
    let shank = if shaft_length > 0.0 { length("shaft_diam")? } else { 0.0 };
    entry.cutter = Some(Cutter {
        shape,
        diameter,
        flute_length,
        length: super::outline::rounded(flute_length + shaft_length),
        shoulder: None,
        cutting_neck: 0.0,
        shank_diameter: Some(shank).filter(|shank| *shank != 0.0),
    });
    Ok(entry)
}
