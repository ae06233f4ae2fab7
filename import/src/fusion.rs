//! Tool libraries of Fusion 360, as JSON. A `.tools` file is a ZIP archive with the same JSON in it.
//!
//! Lengths are in the unit of each tool; a holder has a unit of its own. Segments of a shaft and a holder begin at
//! the cutting end. `LB` is the length from the tip to the holder, `LCF` that of the flutes, `SFDM` the diameter of
//! the shank, `SIG` a whole angle, `TA` the angle between the axis and a side.

use super::entry::{Entry, Holder, Note, Section, Stated};
use super::json::{Object, number, object, pair, string, truth};
use super::shape::{Crest, Cutter, FormSegment, Shape, ShapeError};
use super::{Found, Problem};
use serde_json::Value;
use touchoff::Unit;

/// Reads a tool.
pub(super) fn tool(value: &Value) -> Found {
    let Some(tool) = value.as_object() else {
        return Err(Problem::new("entry", "it is no object"));
    };
    let kind = string(tool, "type");
    let title = string(tool, "description");
    let label = if title.is_empty() { kind } else { title };
    let number = tool.get("post-process").and_then(|post| post.get("number"));
    read_tool(tool, kind, title).map_err(|error| Problem::new(label, &error).numbered(number))
}

fn read_tool(tool: &Object, kind: &str, title: &str) -> Result<Entry, String> {
    let unit = unit(tool)?;
    let origin = origin(tool);
    let mut entry = Entry::new(unit, kind, title, origin);
    entry.set_number(tool.get("post-process").and_then(|post| post.get("number")));
    if kind == "holder" {
        entry.holder = Some(holder(tool)?.ok_or("its holder has no segments")?);
        return Ok(entry);
    }
    let empty = Object::new();
    let geometry = Geometry(object(tool, "geometry")?.unwrap_or(&empty));
    // The hand of cut (ISO 13399): `false` is left.
    entry.left_handed = match kind {
        "tap left hand" | "form tap left hand" => Some(true),
        "tap right hand" | "form tap right hand" => Some(false),
        _ => geometry.0.get("HAND").and_then(truth).map(|is_right| !is_right),
    };
    entry.cutter = Some(cutter(kind, tool, &geometry, &mut entry.notes)?);
    entry.notes.extend(contradicted_expressions(tool, &geometry, unit)?);
    if let Some(shaft) = object(tool, "shaft")? {
        entry.shaft = sections(shaft).map_err(|error| format!("its shaft: {error}"))?;
        if !shaft.get("segments").is_some_and(Value::is_array) {
            let (what, drawn) = ("shaft", "the shank is drawn as a cylinder");
            entry.notes.push(Note::NotDrawn { what, drawn });
        }
    }
    if let (Some(last), Some(shank)) = (entry.shaft.last(), geometry.get("SFDM")?)
        && shank > 0.0
        && last.upper_diameter != shank
    {
        entry.notes.push(Note::Contradiction {
            first: Stated { what: "shank diameter", value: shank },
            second: Stated {
                what: "diameter of the shaft's last segment",
                value: last.upper_diameter,
            },
            taken: "shaft's segments",
            is_narrower: last.upper_diameter < shank,
        });
    }
    if let Some(value) = object(tool, "holder")? {
        let Some(holder) = holder(value)? else {
            let (what, drawn) = ("holder", "the tool is drawn without its holder");
            entry.notes.push(Note::NotDrawn { what, drawn });
            return Ok(entry);
        };
        // Without it nothing says where the holder begins.
        entry.stickout = Some(geometry.require("LB", "length below the holder")?);
        let stated = geometry.get("assemblyGaugeLength")?;
        if let (Some(stickout), Some(stated)) = (entry.stickout, stated) {
            let sum = stickout + gauge_length(value, &holder)? * holder.unit.factor_to(unit);
            if stated > 0.0 && (sum - stated).abs() > 1e-4 * sum.abs() {
                entry.notes.push(Note::GaugeLength { stated, sum });
            }
        }
        entry.holder = Some(holder);
    }
    Ok(entry)
}

/// Returns the gauge length of a holder in its unit. Where none is stated, Fusion 360 takes the height of the segments.
fn gauge_length(value: &Object, holder: &Holder) -> Result<f64, String> {
    match value.get("gaugeLength") {
        None | Some(Value::Null) => Ok(holder.sections.iter().map(|section| section.height).sum()),
        Some(stated) => Quantity::read(stated)
            .and_then(|quantity| quantity.to(holder.unit))
            .ok_or_else(|| format!("its holder: its `gaugeLength` is {stated}, no length")),
    }
}

/// A number of a library with the text of its unit.
struct Quantity {
    number: f64,
    unit: String,
}

impl Quantity {
    /// Reads a number, alone or as a text with a unit; `None` for a formula.
    fn read(value: &Value) -> Option<Quantity> {
        if let Some(number) = value.as_f64() {
            return Some(Quantity { number, unit: String::new() });
        }
        let text = value.as_str()?.trim();
        let quoted = [('"', '"'), ('\'', '\''), ('(', ')')];
        let inner = quoted
            .into_iter()
            .find_map(|(open, close)| text.strip_prefix(open)?.strip_suffix(close));
        let text = inner.unwrap_or(text).trim();
        let number = text.trim_end_matches(|c: char| c.is_alphabetic() || "\"'°".contains(c));
        let unit = text[number.len()..].to_lowercase();
        // A comma is the decimal sign of some languages.
        let number = number
            .trim()
            .replace(',', ".")
            .parse()
            .ok()
            .filter(|number: &f64| number.is_finite())?;
        Some(Quantity { number, unit })
    }

    /// Returns a length in a unit, or an angle in degrees; `None` if its unit is not known.
    fn to(&self, unit: Unit) -> Option<f64> {
        let millimetres = |length: f64| length * Unit::Millimetre.factor_to(unit);
        let factor = match &*self.unit {
            "" | "deg" | "degree" | "degrees" | "°" => 1.0,
            "rad" | "radian" | "radians" => 1_f64.to_degrees(),
            "mm" | "millimeter" | "millimeters" | "millimetre" | "millimetres" => millimetres(1.0),
            "cm" | "centimeter" | "centimeters" | "centimetre" | "centimetres" => millimetres(10.0),
            "m" | "meter" | "meters" | "metre" | "metres" => millimetres(1000.0),
            "um" | "µm" | "μm" | "micron" | "microns" => millimetres(1e-3),
            "in" | "inch" | "inches" | "\"" => Unit::Inch.factor_to(unit),
            "ft" | "foot" | "feet" | "'" => 12.0 * Unit::Inch.factor_to(unit),
            _ => return None,
        };
        Some(self.number * factor)
    }
}

/// The expressions of dimensions, from which Fusion 360 computes them anew when it reads the library.
const EXPRESSIONS: [(&str, &str, &str); 12] = [
    ("tool_diameter", "DC", "diameter"),
    ("tool_fluteLength", "LCF", "flute length"),
    ("tool_overallLength", "OAL", "overall length"),
    ("tool_bodyLength", "LB", "length below the holder"),
    ("tool_shaftDiameter", "SFDM", "shank diameter"),
    ("tool_cornerRadius", "RE", "corner radius"),
    ("tool_shoulderLength", "shoulder-length", "shoulder length"),
    ("tool_shoulderDiameter", "shoulder-diameter", "shoulder diameter"),
    ("tool_tipDiameter", "tip-diameter", "tip diameter"),
    ("tool_maximumCuttingDiameter", "DCX", "largest diameter"),
    ("tool_taperAngle", "TA", "taper angle"),
    ("tool_tipAngle", "SIG", "point angle"),
];

/// Returns a note for each dimension whose expression is a length or an angle that differs. Other expressions are not computed.
fn contradicted_expressions(
    tool: &Object,
    geometry: &Geometry<'_>,
    unit: Unit,
) -> Result<Vec<Note>, String> {
    let mut notes = Vec::new();
    let Some(expressions) = object(tool, "expressions")? else { return Ok(notes) };
    for (expression, key, what) in EXPRESSIONS {
        let stated = geometry.get(key)?;
        let quantity = expressions.get(expression).and_then(Quantity::read);
        let (Some(value), Some(stated)) = (quantity.and_then(|found| found.to(unit)), stated)
        else {
            continue;
        };
        let value = super::outline::rounded(value);
        if (value - stated).abs() > 1e-4 * stated.abs() {
            notes.push(Note::OtherExpression {
                stated: Stated { what, value: stated },
                expression: value,
            });
        }
    }
    Ok(notes)
}

fn cutter(
    kind: &str,
    tool: &Object,
    geometry: &Geometry<'_>,
    notes: &mut Vec<Note>,
) -> Result<Cutter, String> {
    if kind.starts_with("circle segment") {
        let drawn = "they are drawn tangent to each other".to_owned();
        notes.push(Note::Unstated("construction of its arcs", drawn));
    }
    let shape = match kind {
        "flat end mill" => Shape::Flat { corner: 0.0 },
        "bull nose end mill" => Shape::Flat { corner: geometry.require("RE", "corner radius")? },
        "ball end mill" => {
            let (radius, diameter) =
                (geometry.get("RE")?.unwrap_or(0.0), geometry.require("DC", "diameter")?);
            if radius > 0.0 && (2.0 * radius - diameter).abs() > 1e-6 * diameter {
                notes.push(Note::Contradiction {
                    first: Stated { what: "corner radius", value: radius },
                    second: Stated { what: "diameter", value: diameter },
                    taken: "diameter",
                    is_narrower: diameter < 2.0 * radius,
                });
            }
            Shape::Ball
        }
        "tapered mill" => {
            let corner = geometry.or("RE", "corner radius", 0.0, notes)?;
            let half_angle = geometry.require("TA", "taper angle")?;
            // Some exporters write it among the dimensions.
            let stated = [tool, geometry.0].map(|object| string(object, "tapered-type"));
            match stated.into_iter().find(|kind| !kind.is_empty()).unwrap_or_default() {
                "tapered_ball" => Shape::TaperedBall { radius: corner, half_angle, cone_to: 0.0 },
                kind @ ("" | "tapered_bull_nose") => {
                    if kind.is_empty() && corner > 0.0 {
                        let drawn = "a bull nose is drawn".to_owned();
                        notes.push(Note::Unstated("type of taper", drawn));
                    }
                    Shape::Tapered { corner, half_angle }
                }
                other => return Err(format!("the taper `{other}` cannot be read yet")),
            }
        }
        "chamfer mill" => Shape::Chamfer {
            tip_diameter: geometry.or("tip-diameter", "tip diameter", 0.0, notes)?,
            half_angle: geometry.require("TA", "taper angle")?,
        },
        "dovetail mill" => Shape::Dovetail {
            corner: geometry.or("RE", "corner radius", 0.0, notes)?,
            half_angle: geometry.require("TA", "taper angle")?,
        },
        "lollipop mill" => Shape::Lollipop,
        "slot mill" => Shape::Slot { corner: geometry.or("RE", "corner radius", 0.0, notes)? },
        "radius mill" => Shape::Radius {
            corner: geometry.require("RE", "corner radius")?,
            max_diameter: f64::INFINITY,
        },
        "face mill" => Shape::Face {
            corner: geometry.or("RE", "corner radius", 0.0, notes)?,
            upper: geometry.or("upper-radius", "upper radius", 0.0, notes)?,
            half_angle: geometry.or("TA", "taper angle", 0.0, notes)?,
            max_diameter: geometry.or("DCX", "largest diameter", 0.0, notes)?,
        },
        "corner chamfer end mill" => Shape::CornerChamfer {
            width: geometry.require("chamfer-width", "chamfer width")?,
            angle: geometry.require("chamfer-angle", "chamfer angle")?,
        },
        "circle segment barrel" => Shape::Barrel {
            flank: geometry.require("profile-radius", "profile radius")?,
            waist: geometry.require("axial-distance", "axial distance")?,
            lower: geometry.or("lower-radius", "lower radius", 0.0, notes)?,
            upper: geometry.or("upper-radius", "upper radius", 0.0, notes)?,
        },
        "circle segment lens" => Shape::Lens {
            face: geometry.require("lower-radius", "lower radius")?,
            corner: geometry.require("RE", "corner radius")?,
        },
        "circle segment oval" => Shape::Oval {
            ball: geometry.require("lower-radius", "lower radius")?,
            flank: geometry.require("profile-radius", "profile radius")?,
        },
        "circle segment taper" => Shape::SegmentTaper {
            tip_diameter: geometry.require("tip-diameter", "tip diameter")?,
            lower: geometry.require("lower-radius", "lower radius")?,
            flank: geometry.require("profile-radius", "profile radius")?,
            upper: geometry.require("upper-radius", "upper radius")?,
            half_angle: geometry.require("TA", "taper angle")?,
        },
        "form mill" => {
            notes.push(Note::Unstated(
                "part of the profile that cuts",
                "all of it counts as cutting".to_owned(),
            ));
            Shape::Form(profile(geometry.0.get("profile"))?)
        }
        "thread mill" => {
            // Teeth that do not fit the length of the flutes are not drawn.
            let teeth = geometry.or("NT", "number of teeth", 1.0, notes)?.clamp(1.0, 1e6) as u32;
            Shape::Thread {
                pitch: pitch(geometry, teeth, notes)?,
                angle: geometry.or("thread-profile-angle", "angle of the thread", 60.0, notes)?,
                teeth,
                crest: crest(geometry, notes)?,
            }
        }
        "drill" => {
            Shape::Drill { tip_diameter: 0.0, point_angle: geometry.require("SIG", "point angle")? }
        }
        "spot drill" | "counter sink" => Shape::Drill {
            tip_diameter: geometry.or("tip-diameter", "tip diameter", 0.0, notes)?,
            point_angle: geometry.require("SIG", "point angle")?,
        },
        "center drill" => Shape::CenterDrill {
            tip_diameter: geometry.require("tip-diameter", "tip diameter")?,
            tip_length: geometry.require("tip-length", "tip length")?,
            point_angle: geometry.require("SIG", "point angle")?,
            body_angle: geometry.require("TA", "body angle")?,
        },
        "reamer" | "counter bore" | "boring bar" | "block drill" => flat_or_point(geometry, notes)?,
        "tap left hand" | "tap right hand" | "form tap left hand" | "form tap right hand" => {
            notes
                .push(Note::Unstated("chamfer of the tap", "it is drawn as a cylinder".to_owned()));
            Shape::Flat { corner: 0.0 }
        }
        "probe" => Shape::Probe,
        "waterjet" | "plasma cutter" | "laser cutter" => {
            return Err("it cuts with a jet or a beam, which is no solid".to_owned());
        }
        other if other.starts_with("turning") => {
            return Err("it is a turning tool, which is no solid of revolution".to_owned());
        }
        other => return Err(format!("the type `{other}` cannot be read yet")),
    };
    let diameter = geometry.require("DC", "diameter")?;
    let shoulder_diameter = geometry.get("shoulder-diameter")?.filter(|diameter| *diameter != 0.0);
    let shoulder = geometry.get("shoulder-length")?.map(|length| (length, shoulder_diameter));
    let shank_diameter = geometry.get("SFDM")?.filter(|shank| *shank != 0.0);
    if shank_diameter.is_none() {
        notes.push(Note::no_shank_diameter());
    }
    // Probes state neither since version 36.
    let (flute_length, length) = match kind {
        "probe" => {
            let length = geometry.get("OAL")?;
            let length = match length.filter(|length| *length > 0.0) {
                Some(length) => length,
                None => {
                    let below = geometry.require("LB", "overall length")?;
                    let drawn = "the stem is drawn up to the length below the holder".to_owned();
                    notes.push(Note::Unstated("overall length", drawn));
                    below
                }
            };
            (geometry.or("LCF", "flute length", diameter / 2.0, notes)?, length)
        }
        _ => (geometry.require("LCF", "flute length")?, geometry.require("OAL", "overall length")?),
    };
    if flute_length == 0.0 && !matches!(shape, Shape::Form(_)) {
        let drawn = "no flutes are drawn above the end".to_owned();
        notes.push(Note::Unstated("flute length", drawn));
    }
    Ok(Cutter {
        shape,
        diameter,
        flute_length,
        length,
        shoulder,
        cutting_neck: 0.0,
        shank_diameter,
    })
}

/// Returns the pitch of a thread mill: `TP`, or from version 36 on the least and the greatest that it cuts, `TPN` and `TPX`. Samples of
/// Fusion 360 have 0, which states none. A single tooth cuts several pitches, and is drawn for the greatest; several teeth have one.
fn pitch(geometry: &Geometry<'_>, teeth: u32, notes: &mut Vec<Note>) -> Result<f64, String> {
    let stated = |key| geometry.get(key).map(|pitch| pitch.filter(|pitch| *pitch != 0.0));
    let (first, second) = (stated("TPN")?, stated("TPX")?);
    let pitch = match (first.or(second), second.or(first)) {
        (Some(least), Some(greatest)) if least > greatest => {
            return Err(super::entry::reason(&ShapeError::Contradiction(
                "least pitch",
                least,
                "greatest pitch",
                greatest,
            )));
        }
        (Some(least), Some(greatest)) if least < greatest => {
            if teeth > 1 {
                return Err(format!(
                    "it has {teeth} teeth and pitches from {least} to {greatest}, but teeth are one pitch apart: state one pitch in \
                     the library and export it again"
                ));
            }
            let drawn = format!("the tooth is drawn for the greatest pitch, {greatest}");
            notes.push(Note::Unstated("pitch of the thread that is cut", drawn));
            greatest
        }
        (Some(_), Some(greatest)) => {
            if let Some(other) = stated("TP")?.filter(|pitch| *pitch != greatest) {
                notes.push(Note::Contradiction {
                    first: Stated { what: "thread pitch", value: other },
                    second: Stated { what: "least and greatest pitch", value: greatest },
                    taken: "latter",
                    // A smaller pitch leaves wider roots, and a greater one wider teeth.
                    is_narrower: true,
                });
            }
            greatest
        }
        _ => geometry.require("TP", "thread pitch")?,
    };
    if pitch == 0.0 {
        let drawn = "the teeth are drawn as a cylinder".to_owned();
        notes.push(Note::Unstated("thread pitch", drawn));
    }
    Ok(pitch)
}

/// Returns the crests of a thread mill. They are points if their form or its size is not stated. Fusion 360 replaces a
/// width of 0 by a quarter of the pitch, so 0 states no size.
fn crest(geometry: &Geometry<'_>, notes: &mut Vec<Note>) -> Result<Crest, String> {
    let width = geometry.get("thread-tip-width")?.filter(|width| *width != 0.0);
    let radius = geometry.get("thread-tip-radius")?.filter(|radius| *radius != 0.0);
    let form = string(geometry.0, "thread-tip-type");
    let unstated = match (form, width, radius) {
        ("point", ..) | ("", None, None) => return Ok(Crest::Point),
        ("flat", Some(width), _) => return Ok(Crest::Flat { width }),
        ("round", _, Some(radius)) => return Ok(Crest::Round { radius }),
        ("flat", None, _) => "width of the crests",
        ("round", _, None) => "radius of the crests",
        _ => "form of the crests",
    };
    let drawn = match form {
        "" | "flat" | "round" => "teeth are drawn with a point".to_owned(),
        other => format!("teeth are drawn with a point, because `{other}` cannot be read yet"),
    };
    notes.push(Note::Unstated(unstated, drawn));
    Ok(Crest::Point)
}

/// Returns the shape of a tool whose end is flat if the angle of its point is 0 or 180.
fn flat_or_point(geometry: &Geometry<'_>, notes: &mut Vec<Note>) -> Result<Shape, String> {
    Ok(match geometry.or("SIG", "point angle", 180.0, notes)? {
        point_angle if point_angle > 0.0 && point_angle < 180.0 => {
            Shape::Drill { tip_diameter: 0.0, point_angle }
        }
        _ => Shape::Flat { corner: geometry.or("RE", "corner radius", 0.0, notes)? },
    })
}

/// Returns the holder; `None` if its segments are not stated.
fn holder(value: &Object) -> Result<Option<Holder>, String> {
    let sections = sections(value).map_err(|error| format!("its holder: {error}"))?;
    if sections.is_empty() {
        return Ok(None);
    }
    Ok(Some(Holder {
        title: string(value, "description").to_owned(),
        origin: origin(value),
        unit: unit(value).map_err(|error| format!("its holder: {error}"))?,
        sections,
    }))
}

fn sections(value: &Object) -> Result<Vec<Section>, String> {
    let list = match value.get("segments") {
        None | Some(Value::Null) => &[][..],
        Some(Value::Array(list)) => list,
        Some(_) => return Err("its `segments` are no list".to_owned()),
    };
    let length = |segment: &Value, key: &str| {
        segment.get(key).and_then(number).ok_or_else(|| format!("a segment has no number `{key}`"))
    };
    list.iter()
        .map(|segment| {
            Ok(Section {
                height: length(segment, "height")?,
                lower_diameter: length(segment, "lower-diameter")?,
                upper_diameter: length(segment, "upper-diameter")?,
            })
        })
        .collect()
}

/// The dimensions of a tool.
struct Geometry<'a>(&'a Object);

impl Geometry<'_> {
    /// Returns a dimension, if it is stated.
    fn get(&self, key: &str) -> Result<Option<f64>, String> {
        match self.0.get(key) {
            None | Some(Value::Null) => Ok(None),
            Some(value) => match number(value) {
                Some(number) => Ok(Some(number)),
                None => Err(format!("its `{key}` is {value}, no number")),
            },
        }
    }

    /// Returns a dimension, or a default with a note.
    fn or(
        &self,
        key: &str,
        name: &'static str,
        default: f64,
        notes: &mut Vec<Note>,
    ) -> Result<f64, String> {
        Ok(self.get(key)?.unwrap_or_else(|| Note::default_taken(notes, name, default)))
    }

    fn require(&self, key: &str, name: &'static str) -> Result<f64, String> {
        self.get(key)?.ok_or_else(|| super::entry::reason(&ShapeError::Unstated(name)))
    }
}

fn origin(object: &Object) -> Vec<(&'static str, String)> {
    [("vendor", "vendor"), ("product", "product-id"), ("id", "guid")]
        .map(|(name, key)| (name, string(object, key).to_owned()))
        .into_iter()
        .filter(|(_, value)| !value.is_empty())
        .collect()
}

fn unit(object: &Object) -> Result<Unit, String> {
    match string(object, "unit") {
        "millimeters" => Ok(Unit::Millimetre),
        "inches" => Ok(Unit::Inch),
        "" => Err("it states no unit".to_owned()),
        other => Err(format!("its unit is `{other}`, not `millimeters` or `inches`")),
    }
}

/// Ends of arcs are stated with few digits: their distances from the centre may differ by this part of the radius.
const ARC_TOLERANCE: f64 = 1e-2;

/// Returns the segments of a profile: a list of ends, each with `arc`, `ccw` and `center` if it ends an arc. The
/// first is the start. The outline begins and ends on the axis, from the tip upward or the other way.
fn profile(value: Option<&Value>) -> Result<Vec<FormSegment>, String> {
    let list = value.and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let mut corners = list.iter().map(corner).collect::<Result<Vec<_>, _>>()?;
    let (Some(first), Some(last)) = (corners.first(), corners.last()) else {
        return Err("its profile has no segments".to_owned());
    };
    if first.end[0] != 0.0 || last.end[0] != 0.0 {
        return Err("its profile does not begin and end on the axis".to_owned());
    }
    if first.end[1] > last.end[1] {
        corners = reversed(&corners);
    }
    if corners[0].end[1] != 0.0 || corners.iter().any(|corner| corner.end[1] < 0.0) {
        return Err("its profile does not begin at the tip, z = 0".to_owned());
    }
    let mut segments = Vec::new();
    for pair in corners.windows(2) {
        push(&mut segments, pair[0].end, &pair[1])?;
    }
    Ok(segments)
}

/// The end of a segment, and for an arc its centre and whether it runs counter-clockwise.
#[derive(Clone, Copy)]
struct Corner {
    end: [f64; 2],
    arc: Option<([f64; 2], bool)>,
}

fn corner(value: &Value) -> Result<Corner, String> {
    let point = |key: &str| {
        let point = value.get(key).and_then(pair);
        point.ok_or_else(|| format!("a segment of its profile has no point `{key}`"))
    };
    let flag = |key: &str| match value.get(key) {
        None => Ok(None),
        Some(Value::Bool(flag)) => Ok(Some(*flag)),
        Some(_) => Err(format!("`{key}` of a segment of its profile is neither true nor false")),
    };
    let arc = match (flag("arc")?, flag("ccw")?) {
        (Some(true), Some(ccw)) => Some((point("center")?, ccw)),
        (Some(true), None) => return Err("an arc of its profile has no `ccw`".to_owned()),
        (None, _) if value.get("center").is_some() => {
            return Err("a segment of its profile has a `center`, but no `arc`".to_owned());
        }
        _ => None,
    };
    Ok(Corner { end: point("end")?, arc })
}

fn reversed(corners: &[Corner]) -> Vec<Corner> {
    let mut reversed = Vec::new();
    for (k, corner) in corners.iter().enumerate().rev() {
        // The arc that ended at the next corner now ends at this one.
        let arc = corners.get(k + 1).and_then(|next| next.arc);
        reversed.push(Corner { end: corner.end, arc: arc.map(|(centre, ccw)| (centre, !ccw)) });
    }
    reversed
}

/// Adds a segment. An arc of more than half a turn becomes two.
fn push(segments: &mut Vec<FormSegment>, from: [f64; 2], corner: &Corner) -> Result<(), String> {
    let Corner { end, arc } = *corner;
    let Some((centre, ccw)) = arc else {
        segments.push(FormSegment { to: end, arc: None });
        return Ok(());
    };
    let radii = [from, end].map(|[d, z]| (d - centre[0]).hypot(z - centre[1]));
    let radius = (radii[0] + radii[1]) / 2.0;
    if !(radius > 0.0 && (radii[0] - radii[1]).abs() <= ARC_TOLERANCE * radius) {
        return Err("the ends of an arc of its profile are not on one circle".to_owned());
    }
    let [start, stop] = [from, end].map(|[d, z]| (z - centre[1]).atan2(d - centre[0]));
    let turn = if ccw { stop - start } else { start - stop };
    let turn = turn.rem_euclid(std::f64::consts::TAU);
    let concave = !ccw;
    let mut stops = vec![end];
    // By its radius, an arc of a `.tool` file has at most half a turn. Ends that coincide are those of a full circle.
    if turn > std::f64::consts::PI || turn == 0.0 {
        let full = if turn == 0.0 { std::f64::consts::TAU } else { turn };
        let middle = start + if ccw { full / 2.0 } else { -full / 2.0 };
        let at = [centre[0] + radius * middle.cos(), centre[1] + radius * middle.sin()];
        stops.insert(0, at.map(super::outline::rounded));
    }
    let mut last = from;
    for to in stops {
        // Rounded ends may be farther apart than the diameter.
        let chord = (to[0] - last[0]).hypot(to[1] - last[1]);
        segments.push(FormSegment { to, arc: Some((radius.max(chord / 2.0), concave)) });
        last = to;
    }
    Ok(())
}
