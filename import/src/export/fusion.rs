//! Tools of Fusion 360, as JSON.

use super::section::{Cone, HalfSection, Type, recognise, tidy};
use super::{Written, description, is_same};
use serde_json::{Map, Value, json};
use touchoff::Unit;
use touchoff::tool::{ProfileSegment, ToolInfo};

/// Returns the library's text.
pub(super) fn text(tools: &[Value]) -> String {
    format!("{:#}\n", json!({ "data": tools, "version": 33 }))
}

/// Writes a tool as one of Fusion's types, or as a form mill.
pub(super) fn write(
    tool: &ToolInfo,
    section: &HalfSection,
    number: usize,
) -> Result<Written<Value>, String> {
    let typed = recognise(&section.cutting).and_then(|kind| typed(&kind));
    let form =
        || Some(("form mill", json!({ "profile": profile(&section.closed_below_holder()) })));
    // The formats' types come first: their dimensions can be changed in the CAM system.
    for (kind, geometry) in [typed, form()].into_iter().flatten() {
        let Ok(entry) = entry(tool, section, kind, &geometry, number) else { continue };
        if is_same("tool.json", &text(std::slice::from_ref(&entry)), &section.outline) {
            let mut gaps = Vec::new();
            if kind == "form mill" {
                gaps.push("as a form mill, all of its surfaces count as cutting".to_owned());
            }
            if matches!(&section.holder, Ok(holder) if !holder.is_empty()) {
                gaps.push(
                    "the tool ends where its holder begins: set its overall length".to_owned(),
                );
            }
            return Ok(Written { entry, kind: kind.to_owned(), gaps });
        }
    }
    section.holder.as_ref().map_err(Clone::clone)?;
    Err("no type of Fusion 360 has its outline".to_owned())
}

/// Returns a type of Fusion 360 and its own dimensions.
fn typed(cutter: &Type) -> Option<(&'static str, Value)> {
    Some(match *cutter {
        Type::End { diameter, corner: 0.0 } => ("flat end mill", json!({ "DC": diameter })),
        Type::End { diameter, corner } => {
            ("bull nose end mill", json!({ "DC": diameter, "RE": corner }))
        }
        Type::Ball { diameter } => {
            ("ball end mill", json!({ "DC": diameter, "RE": diameter / 2.0 }))
        }
        Type::Point { diameter, tip_diameter: 0.0, angle } => {
            ("drill", json!({ "DC": diameter, "SIG": angle }))
        }
        Type::Point { diameter, tip_diameter, angle } => {
            ("counter sink", json!({ "DC": diameter, "SIG": angle, "tip-diameter": tip_diameter }))
        }
        Type::Taper { tip_diameter, corner, half_angle } if half_angle > 0.0 => {
            let kind = json!({ "DC": tip_diameter, "RE": corner, "TA": half_angle,
                "tapered-type": "tapered_bull_nose" });
            ("tapered mill", kind)
        }
        Type::TaperedBall { radius, half_angle } if half_angle > 0.0 => {
            let kind = json!({ "DC": 2.0 * radius, "RE": radius, "TA": half_angle,
                "tapered-type": "tapered_ball" });
            ("tapered mill", kind)
        }
        _ => return None,
    })
}

/// Returns the tool of a type, with its body and its holder.
fn entry(
    tool: &ToolInfo,
    section: &HalfSection,
    kind: &str,
    own: &Value,
    number: usize,
) -> Result<Value, String> {
    let unit = if section.unit == Unit::Inch { "inches" } else { "millimeters" };
    let [end, flutes] = [section.end, section.cutting_end()[1]];
    let mut geometry = Map::new();
    geometry.insert("LCF".to_owned(), length(flutes));
    geometry.insert("OAL".to_owned(), length(end));
    geometry.insert("LB".to_owned(), length(end));
    let widest = section.cutting.iter().map(|segment| segment.to[0]).fold(0.0, f64::max);
    geometry.insert("DC".to_owned(), length(2.0 * widest));
    let mut entry = json!({ "type": kind, "unit": unit, "description": description(tool),
        "post-process": { "number": number } });
    for (key, value) in own.as_object().into_iter().flatten() {
        let value = value.as_f64().map_or_else(|| value.clone(), length);
        if key == "tapered-type" {
            entry[key] = value;
        } else {
            geometry.insert(key.clone(), value);
        }
    }
    if kind == "form mill" {
        geometry.insert("SFDM".to_owned(), length(2.0 * widest));
    } else {
        let body = section.body.clone()?;
        add_body(&body, section, &mut geometry, &mut entry);
    }
    entry["geometry"] = Value::Object(geometry);
    let holder = section.holder.clone()?;
    if let (Some(first), Some(last)) = (holder.first(), holder.last()) {
        let height = last.high[1] - first.low[1];
        entry["holder"] = json!({ "type": "holder", "unit": unit, "description": "holder",
            "gaugeLength": length(height), "segments": segments(&holder) });
    }
    Ok(entry)
}

fn length(value: f64) -> Value {
    json!(tidy(value))
}

/// Adds neck and shank: as the shoulder and the shank if they are cylinders, otherwise as segments of a shaft.
fn add_body(
    body: &[Cone],
    section: &HalfSection,
    geometry: &mut Map<String, Value>,
    entry: &mut Value,
) {
    let tolerance = section.tolerance;
    let top = body.last().map_or(section.cutting_end()[0], |cone| cone.high[0]);
    geometry.insert("SFDM".to_owned(), length(2.0 * top));
    match body {
        [] => {}
        [shank] if shank.is_cylinder(tolerance) => {}
        [neck, shank] if neck.is_cylinder(tolerance) && shank.is_cylinder(tolerance) => {
            geometry.insert("shoulder-length".to_owned(), length(neck.high[1]));
            geometry.insert("shoulder-diameter".to_owned(), length(2.0 * neck.low[0]));
        }
        _ => entry["shaft"] = json!({ "type": "shaft", "segments": segments(body) }),
    }
}

fn segments(cones: &[Cone]) -> Vec<Value> {
    cones.iter().map(|cone| {
        json!({ "height": length(cone.high[1] - cone.low[1]),
            "lower-diameter": length(2.0 * cone.low[0]), "upper-diameter": length(2.0 * cone.high[0]) })
    }).collect()
}

/// Returns an outline as the profile of a form mill.
fn profile(outline: &[ProfileSegment]) -> Value {
    let start = outline.first().map(|first| json!({ "end": first.from, "arc": false }));
    let ends = outline.iter().map(|segment| match segment.circle {
        None => json!({ "end": segment.to, "arc": false }),
        Some(circle) => {
            json!({ "end": segment.to, "arc": true, "ccw": circle.convex, "center": circle.centre })
        }
    });
    start.into_iter().chain(ends).collect()
}
