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

/// Reads the cutters of a program, each with the tool number that follows it.
pub(super) fn read(text: &str) -> Result<Vec<Found>, String> {
    let mut unit = None;
    let mut found: Vec<(usize, Vec<f64>, Statement, Option<u32>)> = Vec::new();
    let mut number = None;
    // NX also writes `TLDATA` into comments for controls that do not know it.
    for (index, line) in text.lines().enumerate() {
        let code = line.split_once("$$").map_or(line, |(code, _)| code).trim();
        let Some((word, rest)) = code.split_once('/') else { continue };
        let word = word.trim().to_ascii_uppercase();
        let mut list = rest.split(',').map(str::trim);
        match word.as_str() {
            "UNITS" => {
                unit = Some(match rest.trim().to_ascii_uppercase().as_str() {
                    "MM" => Unit::Millimetre,
                    "INCHES" | "INCH" => Unit::Inch,
                    other => return Err(format!("line {}: unit `{other}`", index + 1)),
                });
            }
            "LOADTL" | "TOOLNO" => {
                number = list.next().and_then(|first| first.parse::<f64>().ok()).map(|n| n as u32);
                if let Some(last) = found.last_mut() {
                    last.3 = last.3.or(number);
                }
            }
            "CUTTER" | "TLDATA" => {
                let statement = match (word.as_str(), rest.split(',').next().map(str::trim)) {
                    ("CUTTER", _) => Statement::Cutter,
                    (_, Some("MILL")) => Statement::Mill,
                    (_, Some("DRILL")) => Statement::Drill,
                    (_, kind) => Statement::Other(kind.unwrap_or("").to_owned()),
                };
                let numbers = list.filter_map(|part| part.parse::<f64>().ok()).collect();
                found.push((index + 1, numbers, statement, number));
            }
            _ => {}
        }
    }
    if found.is_empty() {
        return Err("it states no cutter, by `CUTTER/` or `TLDATA/`".to_owned());
    }
    Ok(found.into_iter().map(|found| tool(found, unit)).collect())
}

/// The statement that describes a cutter.
enum Statement {
    Cutter,
    Mill,
    Drill,
    Other(String),
}

fn tool(
    (line, numbers, statement, number): (usize, Vec<f64>, Statement, Option<u32>),
    unit: Option<Unit>,
) -> Found {
    let label = format!("cutter of line {line}");
    let problem = |reason: &str| Problem::new(&label, reason);
    let unit = unit.ok_or_else(|| {
        problem("the program states no `UNITS/`: add `UNITS/MM` or `UNITS/INCHES`")
    })?;
    let at = |k: usize| numbers.get(k).copied().filter(|value| value.is_finite());
    let need =
        |k: usize, what: &str| at(k).ok_or_else(|| problem(&format!("its {what} is not stated")));
    let diameter = need(0, "diameter")?;
    let corner = at(1).unwrap_or(0.0);
    let mut notes =
        vec![Note::Unstated("shank and the holder", "the tool ends with its flutes".to_owned())];
    let (shape, flute_length, length) = match statement {
        Statement::Other(kind) => {
            return Err(problem(&format!("`TLDATA/{kind}` cannot be read yet")));
        }
        Statement::Drill => {
            let length = need(2, "length")?;
            let point_angle = need(3, "point angle")?;
            (Shape::Drill { tip_diameter: 0.0, point_angle }, at(4).unwrap_or(length), length)
        }
        Statement::Mill => {
            let length = need(2, "length")?;
            let [side, end] = [3, 4].map(|k| at(k).unwrap_or(0.0));
            let centre = (diameter / 2.0 - corner, corner);
            (general(diameter, corner, centre, [end, side]), length, length)
        }
        Statement::Cutter => {
            let length = match at(6) {
                Some(length) => length,
                None => {
                    return Err(problem("its height, the last of seven numbers, is not stated"));
                }
            };
            let centre = (at(2).unwrap_or(diameter / 2.0 - corner), at(3).unwrap_or(corner));
            let [end, side] = [4, 5].map(|k| at(k).unwrap_or(0.0));
            (general(diameter, corner, centre, [end, side]), length, length)
        }
    };
    if flute_length < length {
        notes.clear();
        notes.push(Note::Unstated("holder", "the tool ends at its length".to_owned()));
    }
    let mut entry = Entry::new(unit, "cutter", "", vec![("line", line.to_string())]);
    entry.number = number;
    entry.notes = notes;
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
