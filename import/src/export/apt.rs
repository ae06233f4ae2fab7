//! `CUTTER` statements of APT: the cutting part of a tool.

use super::section::{HalfSection, Type, recognise, tidy};
use super::{Written, description, is_same};
use touchoff::Unit;
use touchoff::tool::ToolInfo;

/// Returns the program.
pub(super) fn text(statements: &[String]) -> String {
    // Each statement begins with its unit, since tools may differ in it.
    let mut text = String::new();
    let mut last = "";
    for statement in statements {
        let (unit, rest) = statement.split_once('\n').unwrap_or((statement, ""));
        if unit != last {
            text += unit;
            text.push('\n');
            last = unit;
        }
        text += rest;
    }
    text + "FINI\n"
}

/// The reason for which a tool is left out.
const REFUSED: &str = "`CUTTER` cannot express its outline";

/// Writes the cutting part of a tool.
pub(super) fn write(
    tool: &ToolInfo,
    section: &HalfSection,
    number: usize,
) -> Result<Written<String>, String> {
    let height = section.cutting_end()[1];
    // Diameter, corner radius, centre of the corner, angles of end and side.
    let [diameter, corner, d, z, end, side] = match recognise(&section.cutting).ok_or(REFUSED)? {
        Type::End { diameter, corner } => {
            [diameter, corner, diameter / 2.0 - corner, corner, 0.0, 0.0]
        }
        Type::Ball { diameter } => [diameter, diameter / 2.0, 0.0, diameter / 2.0, 0.0, 0.0],
        Type::Taper { tip_diameter, corner, half_angle } => {
            let (sin, cos) = half_angle.to_radians().sin_cos();
            let d = tip_diameter / 2.0 - corner * (1.0 - sin) / cos;
            [tip_diameter, corner, d, corner, 0.0, half_angle]
        }
        Type::TaperedBall { radius, half_angle } => {
            let (sin, cos) = half_angle.to_radians().sin_cos();
            [2.0 * radius * (1.0 - sin) / cos, radius, 0.0, radius, 0.0, half_angle]
        }
        Type::Point { diameter, tip_diameter: 0.0, angle } => {
            [diameter, 0.0, diameter / 2.0, 0.0, 90.0 - angle / 2.0, 0.0]
        }
        Type::Point { .. } => return Err(REFUSED.to_owned()),
    };
    let unit = if section.unit == Unit::Inch { "INCHES" } else { "MM" };
    let list = [diameter, corner, d, z, end, side, height].map(|value| tidy(value).to_string());
    let statement = format!(
        "UNITS/{unit}\n$$ {}\nCUTTER/{}\nLOADTL/{number}\n",
        description(tool),
        list.join(",")
    );
    if !is_same("tool.apt", &statement, &section.closed_cutting_part()) {
        return Err(REFUSED.to_owned());
    }
    let mut gaps = Vec::new();
    if section.end > height + section.tolerance || !section.body.as_ref().is_ok_and(Vec::is_empty) {
        gaps.push("`CUTTER` has no shank and no holder: the tool ends with its flutes".to_owned());
    }
    Ok(Written { entry: statement, kind: "CUTTER".to_owned(), gaps })
}
