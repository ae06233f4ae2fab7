//! The cutters of APT programs (`CUTTER`) and of NX (`TLDATA`).
//!
//! `CUTTER/d,r,e,f,a,b,h` has a diameter, the radius of the corner, the distances of the corner's centre from the axis
//! and from the tip, the angle of the end from the plane across the axis, the angle of the side from the axis, and the
//! height. The diameter is where end and side, continued, intersect (ISO 3592). Post processors of Autodesk write both
//! distances as 0, or a centre on the axis for any corner, which states no centre. `TLDATA/MILL,d,r,h,b,a` has diameter, corner radius, height, and the angles
//! of side and end; the corner's centre may follow, and after it the radius and the centre of an upper corner.
//! `TLDATA/DRILL,MILL,d,r,h,p,l` has the angle of the point and the length of the flutes. `TOOL PATH/path,TOOL,name`
//! names the tool of the next `TLDATA`. `LOADTL`, `TOOLNO` and NX's `LOAD/TOOL` give the number, and `CSI_SET_FLUTE_LENGTH` the length of the
//! flutes of the `CUTTER` before it.

use super::entry::{Entry, Note};
use super::shape::{Cutter, Shape};
use super::{Found, MAX_TOOLS, Problem};
use std::collections::HashSet;
use touchoff::Unit;

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
const MILL: [&str; 10] = [
    "diameter",
    "corner radius",
    "length",
    "angle of the side",
    "angle of the end",
    "radius of the corner's centre",
    "height of the corner's centre",
    "radius of the upper corner",
    "radius of the upper corner's centre",
    "height of the upper corner's centre",
];
const DRILL: [&str; 5] = ["diameter", "corner radius", "length", "point angle", "flute length"];

/// Reads the cutters of a program, each with its tool number. A cutter that is stated again with the same number or
/// name is the same tool, since programs state it for each operation.
pub(super) fn read(text: &str) -> Result<Vec<Found>, String> {
    let mut unit = None;
    let mut found: Vec<Statement> = Vec::new();
    // The number that was loaded last, in a program whose numbers stand before the cutters: it holds up to the next one.
    let mut loaded = None;
    let mut name = String::new();
    // A `$` continues a statement in the next line.
    let mut continued = String::new();
    for (index, line) in text.lines().enumerate() {
        // The library is refused then.
        if found.len() > MAX_TOOLS {
            break;
        }
        // NX also writes `TLDATA` into comments, for controls that do not know it.
        let code = line.split_once("$$").map_or(line, |(code, _)| code).trim();
        if let Some((part, _)) = code.split_once('$') {
            continued.push_str(part);
            continue;
        }
        let code = std::mem::take(&mut continued) + code;
        let Some((word, rest)) = code.split_once('/') else { continue };
        let mut fields = rest.split(',').map(str::trim);
        let mut next = || fields.next().unwrap_or_default();
        match word.trim().to_ascii_uppercase().as_str() {
            "UNITS" | "UNIT" => {
                unit = Some(match rest.trim().to_ascii_uppercase().as_str() {
                    "MM" | "MMS" => Unit::Millimetre,
                    "INCHES" | "INCH" | "IN" => Unit::Inch,
                    other => return Err(format!("line {}: unit `{other}`", index + 1)),
                });
            }
            "TOOL PATH" => {
                let tool = fields.find(|field| field.eq_ignore_ascii_case("TOOL"));
                name = tool.and(fields.next()).unwrap_or_default().to_owned();
            }
            word @ ("LOADTL" | "TOOLNO" | "LOAD") => {
                let first = next();
                let number = match word {
                    "LOAD" if first.eq_ignore_ascii_case("TOOL") => tool_number(next()),
                    "LOAD" => continue,
                    _ => tool_number(first),
                };
                // The first cutter tells whether numbers stand before the cutters or after them. There, a further number loads the same tool
                // again.
                let is_after = found.first().is_some_and(|first| first.is_before_number);
                match found.last_mut().filter(|_| is_after) {
                    Some(last) => last.number = last.number.or(number),
                    None => loaded = number,
                }
            }
            // SolidWorks CAM and CAMplete state it after the cutter.
            "CSI_SET_FLUTE_LENGTH" => {
                if let Some(last) = found.last_mut() {
                    last.flute_length = rest.trim().parse().ok().filter(|length| *length > 0.0);
                }
            }
            word @ ("CUTTER" | "TLDATA") => {
                let keyword = if word == "TLDATA" { next() } else { "" }.to_ascii_uppercase();
                let mut fields: Vec<String> = fields.map(str::to_owned).collect();
                if keyword == "DRILL" && fields.first().is_some_and(|first| first == "MILL") {
                    fields.remove(0);
                }
                found.push(Statement {
                    line: index + 1,
                    keyword,
                    name: std::mem::take(&mut name),
                    fields,
                    unit,
                    is_before_number: loaded.is_none(),
                    number: loaded,
                    flute_length: None,
                });
            }
            _ => {}
        }
    }
    if found.is_empty() {
        return Err("it states no cutter, by `CUTTER/` or `TLDATA/`".to_owned());
    }
    // The unit may be stated below the first cutter.
    found.iter_mut().for_each(|statement| statement.unit = statement.unit.or(unit));
    let mut known = HashSet::new();
    let found = found.iter().filter(|statement| statement.is_new(&mut known));
    Ok(found.map(Statement::tool).collect())
}

/// Returns a tool number; `None` for a name, by which some programs call tools.
fn tool_number(field: &str) -> Option<u32> {
    let number: Option<f64> = field.parse().ok();
    let number = number.filter(|n| n.fract() == 0.0 && (0.0..1e9).contains(n));
    number.map(|number| number as u32)
}

/// A statement that describes a cutter.
struct Statement {
    line: usize,
    /// The first word of a `TLDATA`; empty for a `CUTTER`.
    keyword: String,
    /// The tool's name; may be empty.
    name: String,
    fields: Vec<String>,
    unit: Option<Unit>,
    /// True if no number stood before the statement.
    is_before_number: bool,
    number: Option<u32>,
    /// The length of the flutes of a `CUTTER`.
    flute_length: Option<f64>,
}

/// All that a statement says of a tool but its number.
type Tool<'a> = (&'a str, &'a str, &'a [String], Option<&'static str>);

impl Statement {
    /// Returns true for a tool that was not stated before. One with neither number nor name is always new, and one with
    /// a name alone may be any with that name.
    fn is_new<'a>(&'a self, known: &mut HashSet<(Tool<'a>, Option<u32>)>) -> bool {
        let tool = (&*self.keyword, &*self.name, &*self.fields, self.unit.map(Unit::symbol));
        if self.number.is_none() && self.name.is_empty() {
            return true;
        }
        let is_new_name = known.insert((tool, None));
        if self.number.is_none() { is_new_name } else { known.insert((tool, self.number)) }
    }

    fn tool(&self) -> Found {
        let name = || format!("cutter of line {}", self.line);
        self.read()
            .map_err(|reason| Problem { number: self.number, ..Problem::new(&name(), &reason) })
    }

    fn read(&self) -> Result<Entry, String> {
        let unit =
            self.unit.ok_or("the program states no `UNITS/`: add `UNITS/MM` or `UNITS/INCHES`")?;
        let names: &[&str] = match self.keyword.as_str() {
            "" => &CUTTER,
            "MILL" => &MILL,
            "DRILL" => &DRILL,
            "TURN" | "GROOVE" | "THREAD" => {
                return Err("it is a turning tool, which is no solid of revolution".to_owned());
            }
            kind => return Err(format!("`TLDATA/{kind}` cannot be read yet")),
        };
        self.entry(unit, &self.numbers(names)?)
    }

    /// Returns the value of each field, `None` for one that is left empty.
    fn numbers(&self, names: &[&str]) -> Result<Vec<Option<f64>>, String> {
        if self.fields.len() > names.len() {
            let (fields, most) = (self.fields.len(), names.len());
            return Err(format!("it has {fields} fields, more than {most}"));
        }
        let mut numbers = self
            .fields
            .iter()
            .zip(names)
            .map(|(field, name)| {
                if field.is_empty() {
                    return Ok(None);
                }
                let value: Option<f64> = field.parse().ok();
                let value = value.filter(|value| value.is_finite());
                value
                    .map(Some)
                    .ok_or_else(|| format!("its {name} is `{field}`, which is no number"))
            })
            .collect::<Result<Vec<_>, _>>()?;
        numbers.resize(names.len(), None);
        Ok(numbers)
    }

    fn entry(&self, unit: Unit, numbers: &[Option<f64>]) -> Result<Entry, String> {
        let need = |k: usize, what: &str| numbers[k].ok_or_else(|| format!("it states no {what}"));
        let diameter = need(0, "diameter")?;
        let corner = numbers[1].unwrap_or(0.0);
        let mut notes = Vec::new();
        let mut centre = |d: Option<f64>, z: Option<f64>| {
            let is_on_axis = z == Some(corner) && 2.0 * corner < diameter;
            let is_unstated = corner > 0.0 && d == Some(0.0) && (z == Some(0.0) || is_on_axis);
            if is_unstated {
                let drawn = "the corner is drawn between a flat end and a straight side".to_owned();
                notes.push(Note::Unstated("centre of the corner", drawn));
            }
            let [d, z] = if is_unstated { [None; 2] } else { [d, z] };
            [d.unwrap_or(diameter / 2.0 - corner), z.unwrap_or(corner)]
        };
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
                if let Some(upper) = numbers[7].filter(|upper| *upper != 0.0) {
                    return Err(format!("its upper corner of radius {upper} cannot be read yet"));
                }
                let centre = centre(numbers[5], numbers[6]);
                (general(diameter, corner, centre, [end, side]), length, length)
            }
            _ => {
                let length = need(6, "height, the last of seven numbers")?;
                let centre = centre(numbers[2], numbers[3]);
                let [end, side] = [4, 5].map(|k| numbers[k].unwrap_or(0.0));
                let flutes = self.flute_length.map_or(length, |flutes| flutes.min(length));
                (general(diameter, corner, centre, [end, side]), flutes, length)
            }
        };
        let note = if flute_length < length {
            Note::Unstated("holder", "the tool ends at its length".to_owned())
        } else {
            Note::Unstated("shank and the holder", "the tool ends with its flutes".to_owned())
        };
        let mut entry =
            Entry::new(unit, "cutter", &self.name, vec![("line", self.line.to_string())]);
        entry.number = self.number;
        notes.push(note);
        entry.notes = notes;
        entry.cutter = Some(Cutter {
            shape,
            diameter,
            flute_length,
            length,
            shoulder: None,
            cutting_neck: 0.0,
            shank_diameter: None,
        });
        Ok(entry)
    }
}

/// Returns the shape of APT's general cutter. The simple ones keep their simple names.
fn general(diameter: f64, corner: f64, centre: [f64; 2], [end, side]: [f64; 2]) -> Shape {
    let same = |a: f64, b: f64| (a - b).abs() <= 1e-6 * diameter;
    let plain = same(centre[0], diameter / 2.0 - corner) && same(centre[1], corner);
    match (plain, end == 0.0, side == 0.0) {
        (true, true, true) if corner > 0.0 && same(corner, diameter / 2.0) => Shape::Ball,
        (true, true, true) => Shape::Flat { corner },
        _ => Shape::General { corner, centre, end_angle: end, side_angle: side },
    }
}
