//! Tool bits of FreeCAD, without a holder.

use super::section::{HalfSection, Type, recognise, tidy};
use super::{Written, description, is_same};
use serde_json::{Map, json};
use touchoff::tool::ToolInfo;

/// The reason for which a tool is left out.
const REFUSED: &str = "no shape of FreeCAD has its outline";

/// Writes a tool as one of FreeCAD's shapes.
pub(super) fn write(
    tool: &ToolInfo,
    section: &HalfSection,
    number: usize,
) -> Result<Written<String>, String> {
    if number > 1 {
        return Err("a FreeCAD bit is one tool: export each to a file of its own".to_owned());
    }
    let flutes = section.cutting_end()[1];
    let (shape, own) = match recognise(&section.cutting).ok_or(REFUSED)? {
        Type::End { diameter, corner: 0.0 } => ("endmill", vec![("Diameter", mm(diameter))]),
        Type::End { diameter, corner } => {
            ("bullnose", vec![("Diameter", mm(diameter)), ("CornerRadius", mm(corner))])
        }
        Type::Ball { diameter } => ("ballend", vec![("Diameter", mm(diameter))]),
        Type::Point { diameter, tip_diameter, angle } => {
            // The height of the edge counts from the end of the point.
            let cone = (diameter - tip_diameter) / 2.0 / (angle / 2.0).to_radians().tan();
            let own = vec![
                ("Diameter", mm(diameter)),
                ("TipDiameter", mm(tip_diameter)),
                ("CuttingEdgeAngle", deg(angle)),
                ("CuttingEdgeHeight", mm(flutes - cone)),
            ];
            ("v-bit", own)
        }
        Type::TaperedBall { radius, half_angle } => {
            let end = 2.0 * section.cutting_end()[0];
            let own = vec![
                ("Diameter", mm(2.0 * radius)),
                ("TaperAngle", deg(2.0 * half_angle)),
                ("TaperDiameter", mm(end)),
            ];
            ("taperedballnose", own)
        }
        Type::Taper { .. } => return Err(REFUSED.to_owned()),
    };
    let body = section.body.as_ref().map_err(Clone::clone)?;
    let shank = body.last().map_or(section.cutting_end()[0], |cone| cone.high[0]);
    let mut parameters = Map::new();
    let common = [
        ("CuttingEdgeHeight", mm(flutes)),
        ("Length", mm(section.end)),
        ("ShankDiameter", mm(2.0 * shank)),
        ("Units", "Metric".to_owned()),
    ];
    for (name, value) in common.into_iter().chain(own) {
        parameters.insert(name.to_owned(), json!(value));
    }
    let bit = json!({ "version": 2, "name": description(tool), "shape": format!("{shape}.fcstd"),
        "parameter": parameters, "attribute": {} });
    let text = format!("{bit:#}\n");
    if !is_same("tool.fctb", &text, &section.closed_below_holder()) {
        return Err(REFUSED.to_owned());
    }
    let mut gaps = Vec::new();
    if !matches!(&section.holder, Ok(holder) if holder.is_empty()) {
        gaps.push("a bit has no holder; the tool ends where it begins".to_owned());
    }
    Ok(Written { entry: text, kind: shape.to_owned(), gaps })
}

fn mm(value: f64) -> String {
    format!("{} mm", tidy(value))
}

fn deg(value: f64) -> String {
    format!("{} \u{b0}", tidy(value))
}
