//! The cutters of APT programs (`CUTTER`) and of NX (`TLDATA`).
//!
//! `CUTTER/d,r,e,f,a,b,h` has a diameter, the radius of the corner, the distances of the corner's centre from the axis
//! and from the tip, the angle of the end from the plane across the axis, the angle of the side from the axis, and the
//! height. The diameter is where end and side, continued, intersect (ISO 3592). `TLDATA/MILL,d,r,h,b,a` has diameter,
//! corner radius, height, and the angles of side and end; `TLDATA/DRILL,MILL,d,r,h,p,l` the angle of the point and the
//! length of the flutes.

use super::entry::{Entry, Note};
use super::shape::{Cutter, Shape};
use super::{Found, Problem};
use crate::unit::Unit;

/// The fields of `CUTTER`, `TLDATA/MILL` and `TLDATA/DRILL,MILL`.
const CUTTER: [&str; 7] = [
    "diameter",
    "corner radius",
    "radius of the corner's centre",
    "height of the corner's centre",
    "angle of the end",
    "angle of the side",
    "height",
];
const MILL: [&str; 5] =
    ["diameter", "corner radius", "length", "angle of the side", "angle of the end"];
const DRILL: [&str; 5] = ["diameter", "corner radius", "length", "point angle", "flute length"];

/// Reads the cutters of a program, each with its tool number.
pub(super) fn read(text: &str) -> Result<Vec<Found>, String> {
    let mut unit = None;
    let mut found: Vec<Statement> = Vec::new();
    // A number that stands before its cutter.
    let mut pending = None;
    // A `$` at the end continues a statement in the next line.
    let mut continued = String::new();
    for (index, line) in text.lines().enumerate() {
        // NX also writes `TLDATA` into comments, for controls that do not know it.
        let code = line.split_once("$$").map_or(line, |(code, _)| code).trim();
        if let Some(part) = code.strip_suffix('$') {
            continued.push_str(part);
            continue;
        }
        let code = std::mem::take(&mut continued) + code;
        let Some((word, rest)) = code.split_once('/') else { continue };
        let at_line = |what: &str| format!("line {}: {what}", index + 1);
        match word.trim().to_ascii_uppercase().as_str() {
            "UNITS" => {
                unit = Some(match rest.trim().to_ascii_uppercase().as_str() {
                    "MM" => Unit::Millimetre,
                    "INCHES" | "INCH" => Unit::Inch,
                    other => return Err(at_line(&format!("unit `{other}`"))),
                });
            }
            "LOADTL" | "TOOLNO" => {
                // Some programs call tools by name.
                let number: Option<f64> =
                    rest.split(',').next().and_then(|first| first.trim().parse().ok());
                let number = number.filter(|n| n.fract() == 0.0 && (0.0..1e9).contains(n));
                let number = number.map(|number| number as u32);
                match found.last_mut().filter(|last| last.number.is_none()) {
                    Some(last) => last.number = number,
                    None => pending = number,
                }
            }
            word @ ("CUTTER" | "TLDATA") => {
                let mut fields: Vec<String> =
                    rest.split(',').map(|field| field.trim().to_owned()).collect();
                let keyword = if word == "TLDATA" {
                    fields.remove(0).to_ascii_uppercase()
                } else {
                    String::new()
                };
                if keyword == "DRILL" && fields.first().is_some_and(|first| first == "MILL") {
                    fields.remove(0);
                }
                let number = pending.take();
                found.push(Statement { line: index + 1, keyword, fields, unit, number });
            }
            _ => {}
        }
    }
    if found.is_empty() {
        return Err("it states no cutter, by `CUTTER/` or `TLDATA/`".to_owned());
    }
    // The unit may be stated below the first cutter.
    Ok(found.iter().map(|statement| statement.tool(statement.unit.or(unit))).collect())
}

/// A statement that describes a cutter.
struct Statement {
    line: usize,
    /// The first word of a `TLDATA`; empty for a `CUTTER`.
    keyword: String,
    fields: Vec<String>,
    unit: Option<Unit>,
    number: Option<u32>,
}

impl Statement {
    fn tool(&self, unit: Option<Unit>) -> Found {
        let read = || -> Result<Entry, String> {
            let unit =
                unit.ok_or("the program states no `UNITS/`: add `UNITS/MM` or `UNITS/INCHES`")?;
            let names: &[&str] = match self.keyword.as_str() {
                "" => &CUTTER,
                "MILL" => &MILL,
                "DRILL" => &DRILL,
                kind => return Err(format!("`TLDATA/{kind}` cannot be read yet")),
            };
            self.entry(unit, &self.numbers(names)?)
        };
        read().map_err(|reason| Problem::new(&format!("cutter of line {}", self.line), &reason))
    }

    /// Returns the value of each field, `None` for one that is left empty.
    fn numbers(&self, names: &[&str]) -> Result<Vec<Option<f64>>, String> {
        if self.fields.len() > names.len() {
            return Err(format!("it has {} fields, not {}", self.fields.len(), names.len()));
        }
        let number = |(field, name): (&String, &&str)| {
            if field.is_empty() {
                return Ok(None);
            }
            let value: Option<f64> = field.parse().ok();
            let value = value.filter(|value| value.is_finite());
            value.map(Some).ok_or_else(|| format!("its {name} is `{field}`, which is no number"))
        };
        let mut numbers =
            self.fields.iter().zip(names).map(number).collect::<Result<Vec<_>, _>>()?;
        numbers.resize(names.len(), None);
        Ok(numbers)
    }

    fn entry(&self, unit: Unit, numbers: &[Option<f64>]) -> Result<Entry, String> {
        let need = |k: usize, what: &str| numbers[k].ok_or_else(|| format!("it states no {what}"));
        let diameter = need(0, "diameter")?;
        let corner = numbers[1].unwrap_or(0.0);
        let (shape, flute_length, length) = match self.keyword.as_str() {
            "DRILL" => {
                let (length, point_angle) = (need(2, "length")?, need(3, "point angle")?);
                if corner != 0.0 {
                    return Err(format!("it is a drill with a corner radius, {corner}"));
                }
                let shape = Shape::Drill { tip_diameter: 0.0, point_angle };
                (shape, numbers[4].unwrap_or(length), length)
            }
            "MILL" => {
                let length = need(2, "length")?;
                let [side, end] = [3, 4].map(|k| numbers[k].unwrap_or(0.0));
                let centre = (diameter / 2.0 - corner, corner);
                (general(diameter, corner, centre, [end, side]), length, length)
            }
            _ => {
                let length = need(6, "height, the last of seven numbers")?;
                let centre =
                    (numbers[2].unwrap_or(diameter / 2.0 - corner), numbers[3].unwrap_or(corner));
                let [end, side] = [4, 5].map(|k| numbers[k].unwrap_or(0.0));
                (general(diameter, corner, centre, [end, side]), length, length)
            }
        };
        let note = if flute_length < length {
            Note::Unstated("holder", "the tool ends at its length".to_owned())
        } else {
            Note::Unstated("shank and the holder", "the tool ends with its flutes".to_owned())
        };
        let mut entry = Entry::new(unit, "cutter", "", vec![("line", self.line.to_string())]);
        entry.number = self.number;
        entry.notes = vec![note];
        entry.cutter = Some(Cutter {
            shape,
            diameter,
            flute_length,
            length,
            shoulder: None,
            shank_diameter: None,
        });
        Ok(entry)
    }
}

/// Returns the shape of APT's general cutter. The simple ones keep their simple names.
fn general(diameter: f64, corner: f64, centre: (f64, f64), [end, side]: [f64; 2]) -> Shape {
    let same = |a: f64, b: f64| (a - b).abs() <= 1e-6 * diameter;
    let plain = same(centre.0, diameter / 2.0 - corner) && same(centre.1, corner);
    match (plain, end == 0.0, side == 0.0) {
        (true, true, true) if corner > 0.0 && same(corner, diameter / 2.0) => Shape::Ball,
        (true, true, true) => Shape::Flat { corner },
        _ => Shape::General { corner, centre, end_angle: end, side_angle: side },
    }
}
