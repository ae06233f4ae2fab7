//! Tool libraries of Fusion 360, as JSON. A `.tools` file is a ZIP archive with the same JSON in it.
//!
//! Lengths are in the unit of each tool; a holder has a unit of its own. Segments of a shaft and a holder begin at
//! the cutting end. `LB` is the length from the tip to the holder, `LCF` that of the flutes, `SFDM` the diameter of
//! the shank, `SIG` a whole angle, `TA` the angle between the axis and a side.

use super::entry::{Entry, Holder, Note, Section};
use super::shape::{Cutter, Shape, ShapeError};
use super::{Found, Problem, form};
use crate::unit::Unit;
use serde_json::{Map, Value};

type Object = Map<String, Value>;

/// Reads the tools of a library.
pub(super) fn read(text: &str) -> Result<Vec<Found>, String> {
    let value: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
    let tools = match &value {
        Value::Object(library) => library.get("data").and_then(Value::as_array),
        Value::Array(tools) => Some(tools),
        _ => None,
    };
    let tools = tools.ok_or("there is no list `data` of tools")?;
    Ok(tools.iter().map(tool).collect())
}

pub(super) fn tool(value: &Value) -> Found {
    let Some(tool) = value.as_object() else {
        return Err(Problem::new("entry", "it is no object"));
    };
    let kind = text(tool, "type");
    let title = text(tool, "description");
    let label = if title.is_empty() { kind } else { title };
    read_tool(tool, kind, title).map_err(|error| Problem::new(label, &error))
}

fn read_tool(tool: &Object, kind: &str, title: &str) -> Result<Entry, String> {
    let unit = unit(tool)?;
    let origin = origin(tool);
    let mut entry = Entry::new(unit, kind, title, origin);
    entry.number =
        tool.get("post-process").and_then(|post| post.get("number")).and_then(tool_number);
    if kind == "holder" {
        entry.holder = Some(holder(tool)?);
        return Ok(entry);
    }
    let empty = Object::new();
    let geometry = Geometry(tool.get("geometry").and_then(Value::as_object).unwrap_or(&empty));
    entry.cutter = Some(cutter(kind, tool, &geometry, &mut entry.notes)?);
    if let Some(shaft) = tool.get("shaft").and_then(Value::as_object) {
        entry.shaft = sections(shaft)?;
    }
    if let (Some(last), Some(shank)) = (entry.shaft.last(), geometry.get("SFDM"))
        && shank > 0.0
        && last.upper_diameter != shank
    {
        entry.notes.push(Note::Contradiction {
            first: ("shank diameter", shank),
            second: ("diameter of the shaft's last segment", last.upper_diameter),
            taken: "shaft's segments",
        });
    }
    if let Some(value) = tool.get("holder").and_then(Value::as_object) {
        let holder = holder(value)?;
        entry.stickout = Some(geometry.require("LB", "length below the holder")?);
        let gauge = number_of(value, "gaugeLength");
        let stated = geometry.get("assemblyGaugeLength");
        if let (Some(stickout), Some(gauge), Some(stated)) = (entry.stickout, gauge, stated) {
            let sum = stickout + gauge * holder.unit.factor_to(unit);
            if stated > 0.0 && (sum - stated).abs() > 1e-4 * sum.abs() {
                entry.notes.push(Note::Contradiction {
                    first: ("gauge length of the assembly", stated),
                    second: ("sum of stick-out and holder", sum),
                    taken: "sum",
                });
            }
        }
        entry.holder = Some(holder);
    }
    Ok(entry)
}

fn cutter(
    kind: &str,
    tool: &Object,
    geometry: &Geometry<'_>,
    notes: &mut Vec<Note>,
) -> Result<Cutter, String> {
    let diameter = || geometry.require("DC", "diameter");
    if kind.starts_with("circle segment") {
        let drawn = "they are drawn tangent to each other".to_owned();
        notes.push(Note::Unstated("construction of its arcs", drawn));
    }
    let shape = match kind {
        "flat end mill" => Shape::Flat { corner: 0.0 },
        "bull nose end mill" => Shape::Flat { corner: geometry.require("RE", "corner radius")? },
        "ball end mill" => {
            let (radius, diameter) = (geometry.get("RE").unwrap_or(0.0), diameter()?);
            if radius > 0.0 && (2.0 * radius - diameter).abs() > 1e-6 * diameter {
                notes.push(Note::Contradiction {
                    first: ("corner radius", radius),
                    second: ("diameter", diameter),
                    taken: "diameter",
                });
            }
            Shape::Ball
        }
        "tapered mill" => {
            let corner = geometry.get("RE").unwrap_or(0.0);
            let half_angle = geometry.require("TA", "taper angle")?;
            match text(tool, "tapered-type") {
                "tapered_ball" => Shape::TaperedBall { radius: corner, half_angle, cone_to: 0.0 },
                _ => Shape::Tapered { corner, half_angle },
            }
        }
        "chamfer mill" => Shape::Chamfer {
            tip_diameter: geometry.get("tip-diameter").unwrap_or(0.0),
            half_angle: geometry.require("TA", "taper angle")?,
        },
        "dovetail mill" => Shape::Dovetail {
            corner: geometry.get("RE").unwrap_or(0.0),
            half_angle: geometry.require("TA", "taper angle")?,
        },
        "lollipop mill" => Shape::Lollipop,
        "slot mill" => Shape::Slot { corner: geometry.get("RE").unwrap_or(0.0) },
        "radius mill" => Shape::Radius {
            corner: geometry.require("RE", "corner radius")?,
            max_diameter: f64::INFINITY,
        },
        "face mill" => Shape::Face {
            corner: geometry.get("RE").unwrap_or(0.0),
            upper: geometry.get("upper-radius").unwrap_or(0.0),
            half_angle: geometry.get("TA").unwrap_or(0.0),
            max_diameter: geometry.get("DCX").unwrap_or(0.0),
        },
        "corner chamfer end mill" => Shape::CornerChamfer {
            width: geometry.require("chamfer-width", "chamfer width")?,
            angle: geometry.require("chamfer-angle", "chamfer angle")?,
        },
        "circle segment barrel" => Shape::Barrel {
            flank: geometry.require("profile-radius", "profile radius")?,
            waist: geometry.require("axial-distance", "axial distance")?,
            lower: geometry.get("lower-radius").unwrap_or(0.0),
            upper: geometry.get("upper-radius").unwrap_or(0.0),
        },
        "circle segment lens" => Shape::Lens {
            face: geometry.require("lower-radius", "lower radius")?,
            corner: geometry.require("RE", "corner radius")?,
        },
        "circle segment oval" => Shape::Oval {
            ball: geometry.require("lower-radius", "lower radius")?,
            flank: geometry.require("profile-radius", "profile radius")?,
        },
        "form mill" => {
            notes.push(Note::Unstated(
                "part of the profile that cuts",
                "all of it counts as cutting".to_owned(),
            ));
            Shape::Form(form::profile(geometry.0.get("profile"))?)
        }
        "thread mill" => {
            let crest = text(geometry.0, "thread-tip-type");
            if !crest.is_empty() && crest != "point" {
                let drawn = "teeth are drawn with a point".to_owned();
                notes.push(Note::Unstated("profile of its crests for every pitch", drawn));
            }
            Shape::Thread {
                pitch: geometry.require("TP", "thread pitch")?,
                angle: geometry.get("thread-profile-angle").unwrap_or(60.0),
                teeth: geometry.get("NT").map_or(1, |teeth| teeth.clamp(1.0, 1e6) as u32),
            }
        }
        "drill" => {
            Shape::Drill { tip_diameter: 0.0, point_angle: geometry.require("SIG", "point angle")? }
        }
        "spot drill" | "counter sink" => Shape::Drill {
            tip_diameter: geometry.get("tip-diameter").unwrap_or(0.0),
            point_angle: geometry.require("SIG", "point angle")?,
        },
        "center drill" => Shape::CenterDrill {
            tip_diameter: geometry.require("tip-diameter", "tip diameter")?,
            tip_length: geometry.require("tip-length", "tip length")?,
            point_angle: geometry.require("SIG", "point angle")?,
            body_angle: geometry.require("TA", "body angle")?,
        },
        "reamer" | "counter bore" | "boring bar" | "block drill" => flat_or_point(geometry),
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
    let diameter = diameter()?;
    let shoulder = geometry.get("shoulder-length").map(|length| {
        let diameter = geometry.get("shoulder-diameter").filter(|diameter| *diameter > 0.0);
        (length, diameter)
    });
    Ok(Cutter {
        shape,
        diameter,
        flute_length: geometry.require("LCF", "flute length")?,
        length: geometry.require("OAL", "overall length")?,
        shoulder,
        shank_diameter: geometry.get("SFDM").filter(|shank| *shank > 0.0),
    })
}

/// Returns the shape of a tool whose point is flat unless it states an angle.
fn flat_or_point(geometry: &Geometry<'_>) -> Shape {
    match geometry.get("SIG") {
        Some(point_angle) if point_angle > 0.0 && point_angle < 180.0 => {
            Shape::Drill { tip_diameter: 0.0, point_angle }
        }
        _ => Shape::Flat { corner: geometry.get("RE").unwrap_or(0.0) },
    }
}

fn holder(value: &Object) -> Result<Holder, String> {
    let sections = sections(value).map_err(|error| format!("its holder: {error}"))?;
    if sections.is_empty() {
        return Err("its holder has no segments".to_owned());
    }
    Ok(Holder {
        title: text(value, "description").to_owned(),
        origin: origin(value),
        unit: unit(value).map_err(|error| format!("its holder: {error}"))?,
        sections,
    })
}

fn sections(value: &Object) -> Result<Vec<Section>, String> {
    let list = value.get("segments").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let length = |segment: &Value, key: &str| {
        segment.get(key).and_then(Value::as_f64).ok_or_else(|| format!("a segment has no `{key}`"))
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
    fn get(&self, key: &str) -> Option<f64> {
        number_of(self.0, key)
    }

    fn require(&self, key: &str, name: &'static str) -> Result<f64, String> {
        self.get(key).ok_or_else(|| super::entry::reason(&ShapeError::Unstated(name)))
    }
}

/// Returns a tool number.
pub(super) fn tool_number(value: &Value) -> Option<u32> {
    value.as_u64().and_then(|number| u32::try_from(number).ok())
}

fn number_of(object: &Object, key: &str) -> Option<f64> {
    object.get(key).and_then(Value::as_f64).filter(|value| value.is_finite())
}

fn text<'a>(object: &'a Object, key: &str) -> &'a str {
    object.get(key).and_then(Value::as_str).unwrap_or("").trim()
}

fn origin(object: &Object) -> Vec<(&'static str, String)> {
    [("vendor", "vendor"), ("product", "product-id"), ("id", "guid")]
        .map(|(name, key)| (name, text(object, key).to_owned()))
        .into_iter()
        .filter(|(_, value)| !value.is_empty())
        .collect()
}

fn unit(object: &Object) -> Result<Unit, String> {
    match text(object, "unit") {
        "millimeters" => Ok(Unit::Millimetre),
        "inches" => Ok(Unit::Inch),
        "" => Err("it states no unit".to_owned()),
        other => Err(format!("its unit is `{other}`, not `millimeters` or `inches`")),
    }
}
