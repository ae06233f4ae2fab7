//! Tool bits (`.fctb`), libraries (`.fctl`) and holders (`.fcholder`) of FreeCAD.
//!
//! A bit names one of FreeCAD's shapes and the values of its parameters, as texts with units, whose decimals follow a
//! point or a comma. Texts of FreeCAD's imperial units have fractions and sums, such as `2" + 1/2"`. A length without a unit is in
//! inches if the parameter or the attribute `Units` says so, and else in millimetres. A bit whose shape was changed by its
//! user cannot be told from one of FreeCAD's own.

use super::entry::{Entry, Holder, Note, Section, Stated};
use super::json::{self, Object, pair, string};
use super::shape::{Cutter, Shape};
use super::{Found, MAX_TOOLS, Problem, bytes, text};
use serde_json::Value;
use std::path::{Component, Path, PathBuf};
use touchoff::{FileKind, Unit, is_within};

/// Reads a tool bit.
pub(super) fn bit(content: &str) -> Result<Vec<Found>, String> {
    let bit = object(content)?;
    Ok(vec![read_bit(&bit, None)])
}

/// A library with the bits that it lists.
pub(super) struct ListedBits {
    pub(super) found: Vec<Found>,
    /// The files of the bits.
    pub(super) files: Vec<PathBuf>,
}

/// Reads a library and the bits that it lists, which are in its folder or in `Bit` beside it, and within `root`.
pub(super) fn library(
    content: &str,
    file: &Path,
    root: Option<&Path>,
) -> Result<ListedBits, String> {
    let library = object(content)?;
    let tools = library.get("tools").and_then(Value::as_array).ok_or("there is no list `tools`")?;
    if tools.len() > MAX_TOOLS {
        return Err(format!("it lists more than {MAX_TOOLS} tools"));
    }
    let folder = file.parent().unwrap_or(Path::new(""));
    let mut files = Vec::new();
    // One file can be listed many times.
    let max_bytes = FileKind::Library.max_bytes();
    let mut read_bytes = 0;
    let mut read = |tool: &Value| {
        let bit = find_bit(tool, folder, root)?;
        let problem = |reason: String| Problem::new(listed_name(tool), &reason);
        let too_long = || {
            problem(format!("the bits before it and this one are longer than {max_bytes} bytes"))
        };
        if read_bytes > max_bytes {
            return Err(too_long());
        }
        let content = bytes(&bit).map_err(|error| problem(error.to_string()))?;
        files.push(bit);
        read_bytes += content.len() as u64;
        if read_bytes > max_bytes {
            return Err(too_long());
        }
        let bit = text(&content).and_then(|text| object(&text)).map_err(problem)?;
        read_bit(&bit, tool.get("nr"))
    };
    let found = tools
        .iter()
        .map(|tool| read(tool).map_err(|problem| problem.numbered(tool.get("nr"))))
        .collect();
    Ok(ListedBits { found, files })
}

/// Returns the name of a bit in the list of a library.
fn listed_name(tool: &Value) -> &str {
    tool.get("path").and_then(Value::as_str).unwrap_or("")
}

/// Returns the file of a bit.
fn find_bit(tool: &Value, folder: &Path, root: Option<&Path>) -> Result<PathBuf, Problem> {
    let path = listed_name(tool);
    let problem = |reason: String| Problem::new(path, &reason);
    // Paths of either kind of system.
    let plain = path.replace('\\', "/");
    let relative = Path::new(&plain);
    // A library must not read files elsewhere.
    if path.is_empty() || !relative.components().all(|part| matches!(part, Component::Normal(_))) {
        let reason = "its path is not below the library's folder: copy the bit to `Bit`, and list it by its name";
        return Err(problem(reason.to_owned()));
    }
    // Folders of vendors have names in lower case.
    let folders = ["", "../Bit", "../bit", "Bit", "bit"];
    let is_readable =
        |place: &PathBuf| place.is_file() && root.is_none_or(|root| is_within(place, root));
    let mut places = folders.iter().map(|place| folder.join(place).join(relative));
    places.find(is_readable).ok_or_else(|| {
        let reason =
            "there is no such file in the library's folder, `Bit` or `../Bit`: copy it there";
        problem(reason.to_owned())
    })
}

/// Reads a holder.
pub(super) fn holder(content: &str) -> Result<Vec<Found>, String> {
    let holder = object(content)?;
    let title = string(&holder, "name");
    Ok(vec![read_holder(&holder, title).map_err(|error| Problem::new(title, &error))])
}

fn read_holder(holder: &Object, title: &str) -> Result<Entry, String> {
    let unit = match string(holder, "units") {
        "mm" => Unit::Millimetre,
        "in" | "inch" => Unit::Inch,
        other => return Err(format!("its unit is `{other}`, not `mm` or `inch`")),
    };
    let profile = holder.get("profile").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let points: Option<Vec<[f64; 2]>> = profile.iter().map(pair).collect();
    let points = points.ok_or("a point of its profile is no pair of numbers")?;
    let mut sections = Vec::new();
    for pair in points.windows(2) {
        let ([below, low], [above, high]) = (pair[0], pair[1]);
        if high < low {
            return Err("its profile runs back toward the tip".to_owned());
        }
        // A step across the axis is the change of diameter from one section to the next.
        if high > low {
            sections.push(Section {
                height: high - low,
                lower_diameter: 2.0 * below,
                upper_diameter: 2.0 * above,
            });
        }
    }
    let mut entry = entry(unit, "holder", title, holder);
    entry.holder =
        Some(Holder { title: title.to_owned(), origin: entry.origin.clone(), unit, sections });
    Ok(entry)
}

fn read_bit(bit: &Object, number: Option<&Value>) -> Found {
    let title = string(bit, "name");
    read_shape(bit, title, number).map_err(|error| Problem::new(title, &error).numbered(number))
}

fn read_shape(bit: &Object, title: &str, number: Option<&Value>) -> Result<Entry, String> {
    // The shape is named by a path, of either kind of system.
    let shape = string(bit, "shape").rsplit(['/', '\\']).next().unwrap_or("").to_lowercase();
    let shape = shape.trim_end_matches(".fcstd");
    let mut entry = entry(Unit::Millimetre, shape, title, bit);
    entry.set_number(number);
    let empty = Object::new();
    let values = |key| bit.get(key).and_then(Value::as_object).unwrap_or(&empty);
    let parameters = Parameters::new(values("parameter"), values("attribute"));
    // The direction in which FreeCAD's posts turn the spindle for the bit.
    let direction = |key| values(key).get("SpindleDirection").and_then(Value::as_str);
    entry.left_handed = match direction("attribute").or(direction("parameter")) {
        Some("Reverse") => Some(true),
        Some("Forward") => Some(false),
        _ => None,
    };
    entry.cutter = Some(cutter(shape, &parameters, &mut entry.notes)?);
    Ok(entry)
}

fn entry(unit: Unit, kind: &str, title: &str, object: &Object) -> Entry {
    let origin = [("id", string(object, "id")), ("source", string(object, "source"))]
        .into_iter()
        .filter(|(_, value)| !value.is_empty())
        .map(|(name, value)| (name, value.to_owned()));
    Entry::new(unit, kind, title, origin.collect())
}

fn cutter(stated: &str, of: &Parameters<'_>, notes: &mut Vec<Note>) -> Result<Cutter, String> {
    // Releases of FreeCAD differ in `-` and `_`, and have other names for two shapes.
    let plain = stated.replace(['-', '_'], "");
    let shape = match plain.as_str() {
        "torus" => "bullnose",
        "taperballnose" | "conicalballnose" => "taperedballnose",
        // Shapes of add-ons that bring libraries of Fusion 360.
        "fusionflatendmill" => "endmill",
        "fusionballendmill" => "ballend",
        "fusionbullnoseendmill" => "bullnose",
        "fusiondrill" => "drill",
        other => other,
    };
    if shape.starts_with("iso") {
        return Err("it is a turning insert, which is no solid of revolution".to_owned());
    }
    let length = of.length("Length")?;
    // Probes have a name of their own for it.
    let shaft = if shape == "probe" { of.optional_length("ShaftDiameter")? } else { None };
    let shank_diameter =
        shaft.map_or_else(|| of.optional_length("ShankDiameter"), |d| Ok(Some(d)))?;
    if shank_diameter.is_none() {
        notes.push(Note::no_shank_diameter());
    } else if shape == "probe" && shaft.is_none() {
        notes.push(Note::Unstated("shaft diameter", "the shank diameter is taken".to_owned()));
    }
    if shape != "taperedballnose"
        && let Some(angle) = of.optional_angle("TaperAngle")?.filter(|angle| *angle != 0.0)
    {
        notes.push(Note::NotTapered { angle });
    }
    let (mut shoulder, mut cutting_neck) = (None, 0.0);
    let flutes = || of.length("CuttingEdgeHeight");
    let mut diameter = match (shape, of.optional_length("Diameter")?) {
        (_, Some(diameter)) => diameter,
        // It follows from the others.
        ("chamfer", None) => {
            let tip_diameter = of.optional_length("TipDiameter")?.unwrap_or(0.0);
            let half_angle = of.angle("CuttingEdgeAngle")? / 2.0;
            super::outline::rounded(tip_diameter + 2.0 * flutes()? * half_angle.to_radians().tan())
        }
        (_, None) => of.length("Diameter")?,
    };
    let (shape, flute_length) = match shape {
        "endmill" | "reamer" => (Shape::Flat { corner: 0.0 }, flutes()?),
        "ballend" => (Shape::Ball, flutes()?),
        "bullnose" => (Shape::Flat { corner: corner(of, diameter)? }, flutes()?),
        "chamfer" => {
            let tip_diameter = of.length_or("TipDiameter", "tip diameter", 0.0, notes)?;
            let half_angle = of.angle("CuttingEdgeAngle")? / 2.0;
            let wide = tip_diameter + 2.0 * flutes()? * half_angle.to_radians().tan();
            if (wide - diameter).abs() > 0.01 * diameter {
                notes.push(Note::Contradiction {
                    first: Stated { what: "diameter", value: diameter },
                    second: Stated {
                        what: "diameter at the end of the cone",
                        value: super::outline::rounded(wide),
                    },
                    taken: "cone",
                    is_narrower: wide < diameter,
                });
            }
            (Shape::Cone { tip_diameter, half_angle }, flutes()?)
        }
        "vbit" => {
            let tip_diameter = of.length_or("TipDiameter", "tip diameter", 0.0, notes)?;
            let point_angle = of.angle("CuttingEdgeAngle")?;
            // The height of the edge counts from the end of the point.
            let cone = (diameter - tip_diameter) / 2.0 / (point_angle / 2.0).to_radians().tan();
            let flute_length = super::outline::rounded(cone + flutes()?);
            (Shape::Drill { tip_diameter, point_angle }, flute_length)
        }
        "fusionchamfermill" => {
            let tip_diameter = of.length_or("TipDiameter", "tip diameter", 0.0, notes)?;
            (Shape::Chamfer { tip_diameter, half_angle: of.angle("TipAngle")? / 2.0 }, flutes()?)
        }
        "keyway" => {
            (shoulder, cutting_neck) = of.neck(flutes()?)?;
            if let Some(lower) = of.optional_length("LowerCuttingHeight")? {
                let lower = Stated { what: "lower cutting height", value: lower };
                add_contradiction(notes, lower, "cutting edge height", flutes()?, "latter");
            }
            (Shape::Slot { corner: 0.0 }, flutes()?)
        }
        "lollipop" => {
            (shoulder, cutting_neck) = of.neck(flutes()?)?;
            if let Some((_, Some(neck))) = shoulder
                && neck < diameter
            {
                let high = (diameter + (diameter * diameter - neck * neck).sqrt()) / 2.0;
                let edges = Stated { what: "cutting edge height", value: flutes()? };
                let high = super::outline::rounded(high);
                add_contradiction(
                    notes,
                    edges,
                    "height at which the neck leaves the ball",
                    high,
                    "latter",
                );
            }
            (Shape::Lollipop, flutes()?)
        }
        "dovetail" => {
            (shoulder, cutting_neck) = of.neck(flutes()?)?;
            (
                Shape::Dovetail { corner: 0.0, half_angle: of.angle("CuttingEdgeAngle")? / 2.0 },
                flutes()?,
            )
        }
        "drill" => {
            // FreeCAD draws flutes up to the end; vendors state their length for the sake of a wider shank.
            let flutes = of.optional_length("CuttingEdgeHeight")?.unwrap_or_else(|| {
                let drawn = "the flutes reach the end of the tool".to_owned();
                notes.push(Note::Unstated("flute length", drawn));
                length
            });
            let point_angle = of.optional_angle("TipAngle")?;
            let point_angle = point_angle
                .unwrap_or_else(|| Note::default_taken(notes, "tip angle", DRILL_TIP_ANGLE));
            (Shape::Drill { tip_diameter: 0.0, point_angle }, flutes)
        }
        "tap" => {
            let point_angle = of.angle("TipAngle")?;
            let cone = diameter / 2.0 / (point_angle / 2.0).to_radians().tan();
            let flute_length = super::outline::rounded(cone + of.length("CuttingEdgeLength")?);
            (Shape::Drill { tip_diameter: 0.0, point_angle }, flute_length)
        }
        "taperedballnose" => {
            let half_angle = of.angle("TaperAngle")? / 2.0;
            let cone_to =
                of.length_or("TaperDiameter", "largest diameter of the cone", 0.0, notes)?;
            (Shape::TaperedBall { radius: diameter / 2.0, half_angle, cone_to }, flutes()?)
        }
        "radius" => {
            let max_diameter = std::mem::replace(&mut diameter, of.length("TipDiameter")?);
            (Shape::Radius { corner: of.length("CuttingRadius")?, max_diameter }, flutes()?)
        }
        "slittingsaw" => {
            let cap_height = of.length_or("CapHeight", "height of the cap", 0.0, notes)?;
            let thickness = of.length("BladeThickness")?;
            if cap_height > 0.0 {
                notes.push(Note::Origin(cap_height));
            }
            let cap_diameter = of.length_or("CapDiameter", "diameter of the cap", 0.0, notes)?;
            let saw = Shape::Saw { thickness, cap_diameter, cap_height };
            // The length begins at the blade, the cap below it.
            return Ok(Cutter {
                shape: saw,
                diameter,
                flute_length: super::outline::rounded(thickness + cap_height),
                length: super::outline::rounded(length + cap_height),
                shoulder: None,
                cutting_neck: 0.0,
                shank_diameter,
            });
        }
        "probe" => (Shape::Probe, diameter / 2.0),
        "threadmill" => {
            // The shape's own values stand for those that a bit leaves out.
            let own = match THREAD_NECK_DIAMETER < diameter {
                true => THREAD_NECK_DIAMETER,
                false => super::outline::rounded(THREAD_NECK_FRACTION * diameter),
            };
            let neck_diameter = of.length_or("NeckDiameter", "neck diameter", own, notes)?;
            let own = THREAD_NECK_LENGTH.min(length);
            let neck_length = of.length_or("NeckLength", "length of the neck", own, notes)?;
            shoulder = Some((neck_length, Some(neck_diameter)));
            let crest = of.length_or("Crest", "width of the crest", 0.0, notes)?;
            let key = if of.values.contains_key("CuttingAngle") {
                "CuttingAngle"
            } else {
                "cuttingAngle"
            };
            let angle = of.optional_angle(key)?;
            let angle =
                angle.unwrap_or_else(|| Note::default_taken(notes, "angle of the thread", 60.0));
            (Shape::Tooth { neck_diameter, crest, angle }, diameter / 2.0)
        }
        "" => return Err("it names no `shape`".to_owned()),
        "fillet" => return Err("the shape `fillet` cannot be read yet".to_owned()),
        _ => return Err(format!("the shape `{stated}` is none of FreeCAD's own")),
    };
    Ok(Cutter { shape, diameter, flute_length, length, shoulder, cutting_neck, shank_diameter })
}

/// Adds a note if two statements of a bit differ by more than its rounding.
fn add_contradiction(
    notes: &mut Vec<Note>,
    first: Stated,
    what: &'static str,
    value: f64,
    taken: &'static str,
) {
    if (first.value - value).abs() > 0.01 * value {
        // The lower of two heights is drawn with less of the cutter.
        let is_narrower = value < first.value;
        let second = Stated { what, value };
        notes.push(Note::Contradiction { first, second, taken, is_narrower });
    }
}

/// Returns the corner radius of a bull nose; older bits state the flat part or the torus instead.
fn corner(of: &Parameters<'_>, diameter: f64) -> Result<f64, String> {
    if let Some(corner) = of.optional_length("CornerRadius")?.or(of.optional_length("TorusRadius")?)
    {
        return Ok(corner);
    }
    match of.optional_length("FlatRadius")? {
        Some(flat) => Ok(super::outline::rounded(diameter / 2.0 - flat)),
        None => Err(unstated("CornerRadius")),
    }
}

/// The tip angle of FreeCAD's drill, in degrees.
const DRILL_TIP_ANGLE: f64 = 119.0;

/// Diameter and length of the neck of FreeCAD's thread mill, in mm, and the fraction of the cutter that the neck of a thinner one has.
const THREAD_NECK_DIAMETER: f64 = 3.0;
const THREAD_NECK_LENGTH: f64 = 20.0;
const THREAD_NECK_FRACTION: f64 = 0.6;

/// The parameters of a bit.
struct Parameters<'a> {
    values: &'a Object,
    /// The unit of lengths without one, in mm.
    bare: f64,
}

/// The height of a neck, and its diameter where that is stated.
type Neck = (f64, Option<f64>);

impl Parameters<'_> {
    fn new<'a>(values: &'a Object, attributes: &Object) -> Parameters<'a> {
        let units = [values, attributes].map(|object| string(object, "Units"));
        let units = units.into_iter().find(|units| !units.is_empty()).unwrap_or_default();
        let units = units.to_ascii_lowercase();
        let bare = match units.as_str() {
            "imperial" | "inch" | "in" => 25.4,
            _ => 1.0,
        };
        Parameters { values, bare }
    }

    /// Returns the height and the diameter of the neck above a cutting part, and the length of its lower end that cuts.
    fn neck(&self, cutting: f64) -> Result<(Option<Neck>, f64), String> {
        let height = super::outline::rounded(cutting + self.length("NeckHeight")?);
        let edges = self.optional_length("NeckCuttingHeight")?.unwrap_or(0.0);
        Ok((Some((height, Some(self.length("NeckDiameter")?))), edges))
    }

    /// Returns a length in mm.
    fn length(&self, key: &str) -> Result<f64, String> {
        self.optional_length(key)?.ok_or_else(|| unstated(key))
    }

    fn optional_length(&self, key: &str) -> Result<Option<f64>, String> {
        self.quantity(key, |unit| match unit {
            "" => Some(self.bare),
            "mm" => Some(1.0),
            "cm" => Some(10.0),
            "m" => Some(1000.0),
            "in" | "\"" | "inch" => Some(25.4),
            "thou" | "mil" => Some(0.0254),
            "ft" | "'" => Some(304.8),
            "um" | "µm" | "μm" => Some(1e-3),
            _ => None,
        })
    }

    /// Returns a length in mm, or a default with a note.
    fn length_or(
        &self,
        key: &str,
        name: &'static str,
        default: f64,
        notes: &mut Vec<Note>,
    ) -> Result<f64, String> {
        let length = self.optional_length(key)?;
        Ok(length.unwrap_or_else(|| Note::default_taken(notes, name, default)))
    }

    /// Returns an angle in degrees.
    fn angle(&self, key: &str) -> Result<f64, String> {
        self.optional_angle(key)?.ok_or_else(|| unstated(key))
    }

    fn optional_angle(&self, key: &str) -> Result<Option<f64>, String> {
        self.quantity(key, |unit| match unit {
            "" | "°" | "deg" => Some(1.0),
            "rad" => Some(180.0 / std::f64::consts::PI),
            _ => None,
        })
    }

    fn quantity(
        &self,
        key: &str,
        factor: impl Fn(&str) -> Option<f64>,
    ) -> Result<Option<f64>, String> {
        let text = match self.values.get(key) {
            None | Some(Value::Null) => return Ok(None),
            Some(Value::Number(number)) => {
                let value = number.as_f64();
                return Ok(match factor("") {
                    Some(bare) if bare != 1.0 => {
                        value.map(|value| super::outline::rounded(value * bare))
                    }
                    _ => value,
                });
            }
            Some(Value::String(text)) => text.trim(),
            Some(other) => return Err(format!("its `{key}` is {other}, no quantity: {REMEDY}")),
        };
        match sum(text, &factor) {
            Some(value) => Ok(Some(value)),
            None => Err(format!("its `{key}` is `{text}`, no number with a unit: {REMEDY}")),
        }
    }
}

/// Remedy for a value that is missing or cannot be read.
const REMEDY: &str = "correct the bit in FreeCAD, and save it again";

fn unstated(key: &str) -> String {
    format!("it does not state its `{key}`: {REMEDY}")
}

/// Returns the sum of quantities, such as `2.5 mm` or `1' + 2 1/2"`, by the factors of their units.
fn sum(text: &str, factor: &impl Fn(&str) -> Option<f64>) -> Option<f64> {
    let mut terms: Vec<f64> = Vec::new();
    let mut rest = text.trim();
    let mut is_exact = true;
    while !rest.is_empty() {
        if !terms.is_empty() {
            rest = rest.trim_start_matches('+').trim_start();
        }
        let (number, after) = mixed_number(rest)?;
        let end = after.find(|c: char| c.is_ascii_digit() || c == '+').unwrap_or(after.len());
        let (unit, after) = after.split_at(end);
        let factor = factor(unit.trim())?;
        is_exact &= factor == 1.0;
        terms.push(number * factor);
        rest = after.trim_start();
        // Only the last one can do without a unit, and then is the only one.
        if unit.trim().is_empty() && !(rest.is_empty() && terms.len() == 1) {
            return None;
        }
    }
    let sum: f64 = terms.iter().sum();
    let is_exact = is_exact && terms.len() == 1;
    (!terms.is_empty() && sum.is_finite())
        .then(|| if is_exact { sum } else { super::outline::rounded(sum) })
}

/// Returns the number at the beginning of a text, `2.5`, `2,5`, `1/2` or `2 1/2`, and what follows.
fn mixed_number(text: &str) -> Option<(f64, &str)> {
    let (whole, rest) = decimal_number(text)?;
    if let Some((divisor, rest)) = rest.strip_prefix('/').and_then(decimal_number) {
        return Some((whole / divisor, rest));
    }
    let fraction = decimal_number(rest.trim_start()).and_then(|(dividend, rest)| {
        let (divisor, rest) = decimal_number(rest.strip_prefix('/')?)?;
        Some((whole + dividend / divisor, rest))
    });
    Some(fraction.unwrap_or((whole, rest)))
}

fn decimal_number(text: &str) -> Option<(f64, &str)> {
    let is_part = |(at, c): (usize, char)| match c {
        '-' | '+' => at == 0 || text[..at].ends_with(['e', 'E']),
        _ => c.is_ascii_digit() || matches!(c, '.' | ',' | 'e' | 'E'),
    };
    let end = text.char_indices().find(|part| !is_part(*part)).map_or(text.len(), |(at, _)| at);
    let (number, rest) = text.split_at(end);
    let value: Option<f64> = match number.split_once(',') {
        Some((whole, decimals)) if !decimals.contains(['.', ',']) => {
            format!("{whole}.{decimals}").parse().ok()
        }
        _ => number.parse().ok(),
    };
    Some((value?, rest))
}

fn object(content: &str) -> Result<Object, String> {
    match json::parse(content)? {
        Value::Object(object) => Ok(object),
        _ => Err("it is no JSON object".to_owned()),
    }
}
