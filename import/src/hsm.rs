//! Tool libraries of HSMWorks and its kin (`.hsmlib`), as XML.
//!
//! Types and dimensions are those of Fusion 360, under longer names, so each tool is read as one of Fusion's. Two
//! things differ: for tools that make holes `taper-angle` is the whole angle of the point, and `taper-angle2` that of a
//! centre drill's body; and a `section` of a shaft or holder gives the diameter that the outline reaches after its
//! length, so that the first one is the lower end.

use super::json::Object;
use super::{Found, MAX_TOOLS, fusion};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use serde_json::{Value, json};

/// The names of dimensions in HSM and in Fusion 360.
const DIMENSIONS: [(&str, &str); 27] = [
    ("TPN", "TPN"),
    ("TPX", "TPX"),
    ("axial-distance", "axial-distance"),
    ("body-length", "LB"),
    ("corner-radius", "RE"),
    ("diameter", "DC"),
    ("flute-length", "LCF"),
    ("lower-radius", "lower-radius"),
    ("maximum-cutting-diameter", "DCX"),
    ("number-of-teeth", "NT"),
    ("overall-length", "OAL"),
    ("profile-radius", "profile-radius"),
    ("shaft-diameter", "SFDM"),
    ("shoulder-diameter", "shoulder-diameter"),
    ("shoulder-length", "shoulder-length"),
    ("taper-angle", "TA"),
    ("taper-angle2", "taper-angle2"),
    ("thread-pitch", "TP"),
    ("thread-profile-angle", "thread-profile-angle"),
    ("thread-tip-radius", "thread-tip-radius"),
    ("thread-tip-width", "thread-tip-width"),
    ("tip-angle", "SIG"),
    ("tip-diameter", "tip-diameter"),
    ("tip-length", "tip-length"),
    ("tip-offset", "tip-offset"),
    ("upper-radius", "upper-radius"),
    ("assembly-gauge-length", "assemblyGaugeLength"),
];

/// The types that make holes. Fusion 360 states the angle of their point.
const HOLE_MAKING: [&str; 8] = [
    "drill",
    "spot drill",
    "center drill",
    "counter sink",
    "counter bore",
    "reamer",
    "boring bar",
    "block drill",
];

/// Reads the tools of a library.
pub(super) fn read(text: &str) -> Result<Vec<Found>, String> {
    let mut reader = Reader::from_str(text);
    let mut found = Vec::new();
    let mut open: Option<Tool> = None;
    let mut is_library = false;
    loop {
        let position = reader.buffer_position();
        let at = |error: &dyn std::fmt::Display| format!("byte {position}: {error}");
        match reader.read_event().map_err(|error| at(&error))? {
            Event::Eof => break,
            // The library is refused then.
            _ if found.len() > MAX_TOOLS => break,
            Event::Start(element) => {
                let name = local_name(&element);
                match (name.as_str(), &mut open) {
                    (root, None) if is_root(root) => is_library = true,
                    ("tool", None) => open = Some(Tool::new(&element).map_err(|e| at(&e))?),
                    (_, Some(tool)) => tool.begin(&name, &element).map_err(|e| at(&e))?,
                    _ => {}
                }
            }
            Event::Empty(element) => {
                let name = local_name(&element);
                match &mut open {
                    Some(tool) => {
                        tool.begin(&name, &element).map_err(|e| at(&e))?;
                        tool.end(&name);
                    }
                    None => is_library |= is_root(&name),
                }
            }
            Event::Text(text) => {
                if let Some(tool) = &mut open {
                    tool.text.push_str(&text.decode().map_err(|e| at(&e))?);
                }
            }
            Event::GeneralRef(entity) => {
                if let Some(tool) = &mut open {
                    let name = entity.decode().map_err(|e| at(&e))?;
                    let character = entity.resolve_char_ref().map_err(|e| at(&e))?;
                    match (character, quick_xml::escape::resolve_predefined_entity(&name)) {
                        (Some(character), _) => tool.text.push(character),
                        (None, Some(text)) => tool.text.push_str(text),
                        (None, None) => return Err(at(&format!("unknown entity `{name}`"))),
                    }
                }
            }
            Event::End(element) => {
                let name = String::from_utf8_lossy(element.local_name().as_ref()).into_owned();
                match open.take() {
                    Some(tool) if name == "tool" => found.push(fusion::tool(&tool.finish())),
                    Some(mut tool) => {
                        tool.end(&name);
                        open = Some(tool);
                    }
                    None => {}
                }
            }
            _ => {}
        }
    }
    if open.is_some() || !is_library {
        return Err("there is no complete `tool-library`".to_owned());
    }
    Ok(found)
}

/// A tool being read, as an object of Fusion's JSON.
struct Tool {
    object: Object,
    geometry: Object,
    stack: Option<Stack>,
    text: String,
}

/// The shaft or the holder whose sections are being read.
struct Stack {
    /// Its name among the tool's keys.
    key: &'static str,
    object: Object,
    sections: Vec<Section>,
}

/// A section of a shaft or a holder.
struct Section {
    /// The diameter that the outline reaches after the length.
    diameter: f64,
    length: f64,
}

impl Tool {
    fn new(element: &BytesStart<'_>) -> Result<Tool, String> {
        let attributes = Attributes::of(element)?;
        let mut object = Object::new();
        for (from, to) in [("type", "type"), ("unit", "unit"), ("guid", "guid")] {
            if let Some(value) = attributes.get(from) {
                object.insert(to.to_owned(), json!(value));
            }
        }
        Ok(Tool { object, geometry: Object::new(), stack: None, text: String::new() })
    }

    fn begin(&mut self, name: &str, element: &BytesStart<'_>) -> Result<(), String> {
        self.text.clear();
        let attributes = Attributes::of(element)?;
        match name {
            "nc" => {
                let number = attributes.get("number").and_then(|n| n.parse::<u32>().ok());
                self.object.insert("post-process".to_owned(), json!({ "number": number }));
            }
            "body" => {
                for (from, to) in DIMENSIONS {
                    let Some(text) = attributes.get(from) else { continue };
                    let value: f64 =
                        text.parse().map_err(|_| format!("`{from}` is `{text}`, no number"))?;
                    self.geometry.insert(to.to_owned(), json!(value));
                }
                // Fusion 360 has the first among the tool's keys, and the second among its dimensions.
                if let Some(value) = attributes.get("tapered-type") {
                    self.object.insert("tapered-type".to_owned(), json!(value));
                }
                if let Some(value) = attributes.get("thread-tip-type") {
                    self.geometry.insert("thread-tip-type".to_owned(), json!(value));
                }
            }
            "shaft" | "holder" => {
                let kind = if name == "shaft" { "shaft" } else { "holder" };
                let mut object = Object::new();
                let keys = ["description", "guid", "vendor", "product-id", "unit"];
                for key in keys {
                    if let Some(value) = attributes.get(key) {
                        object.insert(key.to_owned(), json!(value));
                    }
                }
                self.stack = Some(Stack { key: kind, object, sections: Vec::new() });
            }
            "motion" if attributes.get("clockwise") == Some("no") => {
                self.geometry.insert("HAND".to_owned(), json!(false));
            }
            "section" => {
                if let Some(Stack { sections, .. }) = &mut self.stack {
                    let number = |key: &str| {
                        let text = attributes.get(key).unwrap_or("");
                        text.parse::<f64>().map_err(|_| format!("`{key}` is `{text}`, no number"))
                    };
                    sections
                        .push(Section { diameter: number("diameter")?, length: number("length")? });
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn end(&mut self, name: &str) {
        let text = self.text.trim().to_owned();
        match name {
            // Inside of a shaft or a holder it is not the tool's.
            "description" if self.stack.is_none() => {
                self.object.insert("description".to_owned(), json!(text));
            }
            "manufacturer" if self.stack.is_none() => {
                self.object.insert("vendor".to_owned(), json!(text));
            }
            "product-id" if self.stack.is_none() => {
                self.object.insert("product-id".to_owned(), json!(text));
            }
            "shaft" | "holder" => {
                if let Some(Stack { key, mut object, sections }) = self.stack.take()
                    && (!sections.is_empty() || key == "holder")
                {
                    object.insert("segments".to_owned(), segments(&sections));
                    // A holder is in the tool's unit unless it states its own.
                    if let Some(unit) = self.object.get("unit") {
                        object.entry("unit").or_insert(unit.clone());
                    }
                    self.object.insert(key.to_owned(), Value::Object(object));
                }
            }
            _ => {}
        }
        self.text.clear();
    }

    fn finish(mut self) -> Value {
        let kind = self.object.get("type").and_then(Value::as_str).unwrap_or("");
        let is_center_drill = kind == "center drill";
        // Their `taper-angle` is the whole angle of the point, and that of a centre drill's body has a name of its own.
        if HOLE_MAKING.contains(&kind)
            && let Some(angle) = self.geometry.remove("TA")
        {
            self.geometry.insert("SIG".to_owned(), angle);
        }
        if let Some(angle) = self.geometry.remove("taper-angle2")
            && is_center_drill
        {
            self.geometry.insert("TA".to_owned(), angle);
        }
        self.object.insert("geometry".to_owned(), Value::Object(self.geometry));
        Value::Object(self.object)
    }
}

/// Returns the outline of sections as Fusion's segments.
fn segments(sections: &[Section]) -> Value {
    let mut below = sections.first().map_or(0.0, |first| first.diameter);
    let mut segments = Vec::new();
    for Section { diameter, length } in sections {
        segments.push(json!({
            "height": length,
            "lower-diameter": below,
            "upper-diameter": diameter,
        }));
        below = *diameter;
    }
    Value::Array(segments)
}

/// Returns true for the root element of a library, in either of HSM's formats.
fn is_root(name: &str) -> bool {
    matches!(name, "tool-library" | "tool-table")
}

fn local_name(element: &BytesStart<'_>) -> String {
    String::from_utf8_lossy(element.local_name().as_ref()).into_owned()
}

/// The attributes of an element, by their names.
struct Attributes(Vec<(String, String)>);

impl Attributes {
    fn of(element: &BytesStart<'_>) -> Result<Attributes, String> {
        let attributes = element.attributes().map(|attribute| {
            let attribute = attribute.map_err(|error| error.to_string())?;
            let key = String::from_utf8_lossy(attribute.key.local_name().as_ref()).into_owned();
            let value = attribute
                .normalized_value(quick_xml::XmlVersion::Implicit1_0)
                .map_err(|error| error.to_string())?;
            Ok((key, value.into_owned()))
        });
        Ok(Attributes(attributes.collect::<Result<_, String>>()?))
    }

    fn get(&self, name: &str) -> Option<&str> {
        self.0.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }
}
