//! Tool libraries of every format, with every type that can be read.

use serde_json::{Map, Value, json};

/// A file of a tool library.
pub struct LibraryFile {
    /// Its name; the ending gives the format.
    pub name: &'static str,
    /// Its content.
    pub text: String,
}

/// Returns a file of each format.
pub fn files() -> Vec<LibraryFile> {
    let file = |name, text| LibraryFile { name, text };
    vec![
        file("fusion.json", json!({ "version": 33, "data": fusion() }).to_string()),
        file("kiri.json", kiri().to_string()),
        file("camotics.json", camotics().to_string()),
        file("bits.fctb", bit("endmill", &["Diameter=6 mm", "ShankDiameter=8 mm"]).to_string()),
        file("holder.fcholder", fcholder().to_string()),
        file("hsm.hsmlib", HSM.to_owned()),
        file("cutters.apt", APT.to_owned()),
        file("table.tbl", "T1 P1 Z47.5 D6 ; ball\nT2 P2 Z40. D8.2 ; drill\n".to_owned()),
    ]
}

/// Returns a tool of Fusion 360 with these dimensions beside the usual ones.
pub fn fusion_tool(kind: &str, more: &Value) -> Value {
    let mut geometry = json!({ "DC": 10, "LCF": 20, "OAL": 60, "LB": 40, "SFDM": 8, "NOF": 3,
        "shoulder-length": 25, "shoulder-diameter": 7 });
    for (key, value) in more.as_object().expect("an object") {
        geometry[key] = value.clone();
    }
    json!({ "type": kind, "unit": "millimeters", "description": kind, "guid": format!("id {kind}"),
        "geometry": geometry, "post-process": { "number": 3 } })
}

/// Returns a library of Fusion 360 with so many tools, of every type and in sizes from a half to twice the usual.
pub fn fusion_library(count: usize) -> String {
    let kinds = fusion();
    let tool = |k: usize| {
        let mut tool = kinds[k % kinds.len()].clone();
        scale(&mut tool["geometry"], 0.5 + 1.5 * k as f64 / count as f64);
        tool["description"] = json!(format!("tool {k}"));
        tool
    };
    json!({ "data": (0..count).map(tool).collect::<Vec<_>>() }).to_string()
}

/// Scales the lengths of a tool.
fn scale(value: &mut Value, factor: f64) {
    match value {
        Value::Object(object) => {
            let not_lengths = ["SIG", "TA", "NT", "NOF", "thread-profile-angle", "chamfer-angle"];
            let lengths = object.iter_mut().filter(|(key, _)| !not_lengths.contains(&&***key));
            lengths.for_each(|(_, value)| scale(value, factor));
        }
        Value::Array(list) => list.iter_mut().for_each(|value| scale(value, factor)),
        Value::Number(number) => {
            let scaled = number.as_f64().unwrap_or(0.0) * factor;
            *value = json!((scaled * 1e4).round() / 1e4);
        }
        _ => {}
    }
}

/// Types of Fusion 360, and the dimensions beside the usual ones.
const FUSION: &str = r#"[
["flat end mill", {}],
["ball end mill", { "RE": 5 }],
["bull nose end mill", { "RE": 1.5 }],
["tapered mill", { "RE": 0.5, "TA": 4, "tapered-type": "tapered_bull_nose" }],
["tapered mill", { "RE": 5, "TA": 3, "tapered-type": "tapered_ball" }],
["chamfer mill", { "tip-diameter": 1, "TA": 45, "LCF": 6 }],
["dovetail mill", { "RE": 0.4, "TA": 30, "LCF": 4 }],
["lollipop mill", { "LCF": 9 }],
["slot mill", { "RE": 0.5, "LCF": 4 }],
["radius mill", { "RE": 2 }],
["face mill", { "RE": 0.8, "TA": 45, "DCX": 14, "LCF": 6, "upper-radius": 0.2 }],
["corner chamfer end mill", { "chamfer-width": 1, "chamfer-angle": 45 }],
["circle segment barrel", { "profile-radius": 80, "axial-distance": 8, "lower-radius": 1, "upper-radius": 1, "LCF": 16 }],
["circle segment lens", { "lower-radius": 30, "RE": 1 }],
["circle segment oval", { "lower-radius": 2, "profile-radius": 50 }],
["circle segment taper", { "DC": 12, "LCF": 20, "SFDM": 12, "shoulder-diameter": 12, "shoulder-length": 20,
    "tip-diameter": 0, "lower-radius": 3, "profile-radius": 375, "upper-radius": 6, "TA": 20 }],
["thread mill", { "TP": 1.5, "thread-profile-angle": 60, "NT": 3, "LCF": 6 }],
["thread mill", { "TP": 1.5, "thread-profile-angle": 60, "NT": 3, "LCF": 6, "thread-tip-type": "flat", "thread-tip-width": 0.2 }],
["thread mill", { "TP": 1.5, "thread-profile-angle": 60, "NT": 3, "LCF": 6, "thread-tip-type": "round", "thread-tip-radius": 0.1 }],
["drill", { "SIG": 118 }],
["spot drill", { "SIG": 90, "tip-diameter": 0 }],
["counter sink", { "SIG": 82, "tip-diameter": 2 }],
["center drill", { "tip-diameter": 3, "tip-length": 4, "SIG": 118, "TA": 60 }],
["reamer", { "SIG": 180, "RE": 0 }],
["counter bore", { "SIG": 180, "RE": 0 }],
["boring bar", { "SIG": 180, "RE": 0.4 }],
["tap right hand", { "TP": 1.5 }],
["probe", { "DC": 6, "shoulder-diameter": 3, "SFDM": 3 }],
["flat end mill", { "SFDM": 10 }],
["ball end mill", { "DC": 2, "RE": 1, "SFDM": 4, "LCF": 5, "shoulder-length": 5 }]
]"#;

/// Returns a tool of every type of Fusion 360 that has a shape. Two of them have a holder, and one a shaft.
pub fn fusion() -> Vec<Value> {
    let kinds: Vec<(String, Value)> = serde_json::from_str(FUSION).expect("types and dimensions");
    let mut tools: Vec<Value> = kinds.iter().map(|(kind, more)| fusion_tool(kind, more)).collect();
    let holder = json!({ "type": "holder", "unit": "inches", "description": "nut", "gaugeLength": 1.5,
        "segments": [
            { "height": 0.25, "lower-diameter": 1, "upper-diameter": 1.25 },
            { "height": 1.25, "lower-diameter": 1.25, "upper-diameter": 1.25 }] });
    let count = tools.len();
    for tool in &mut tools[count - 2..] {
        tool["holder"] = holder.clone();
    }
    tools[count - 1]["shaft"] = json!({ "segments": [
        { "height": 10, "lower-diameter": 2, "upper-diameter": 4 },
        { "height": 20, "lower-diameter": 4, "upper-diameter": 4 }] });
    let corners = [[0.0, 0.0], [3.0, 0.0], [4.0, 1.0], [4.0, 30.0], [0.0, 30.0]];
    let ends = corners.map(|end| json!({ "end": end, "arc": false }));
    let mut form = fusion_tool("form mill", &json!({ "profile": ends }));
    form["geometry"]["profile"][2] =
        json!({ "end": [4, 1], "arc": true, "ccw": true, "center": [3, 1] });
    tools.push(form);
    tools
}

/// Returns the tools of Kiri:Moto, one of each type.
pub fn kiri() -> Value {
    let tool = |number: u32, kind: &str, tip: f64| {
        json!({ "id": number, "number": number, "type": kind, "name": kind, "metric": number < 4,
            "shaft_diam": 8, "shaft_len": 15, "flute_diam": 6, "flute_len": 20, "taper_tip": tip })
    };
    json!([
        tool(1, "endmill", 0.0),
        tool(2, "ballmill", 0.0),
        tool(3, "tapermill", 1.0),
        tool(4, "drill", 0.0)
    ])
}

/// Returns a tool table of CAMotics with each shape.
pub fn camotics() -> Value {
    let tool = |units: &str, shape: &str| {
        json!({ "units": units, "shape": shape, "length": 30, "diameter": 6, "snub_diameter": 2,
            "description": shape })
    };
    json!({ "1": tool("metric", "cylindrical"), "2": tool("metric", "conical"),
        "3": tool("imperial", "ballnose"), "4": tool("imperial", "snubnose") })
}

/// Returns a FreeCAD bit of a shape with these parameters, written `Name=value unit`, beside the usual ones.
pub fn bit(shape: &str, more: &[&str]) -> Value {
    let mut parameters = Map::new();
    let usual = ["Diameter=6 mm", "Length=50 mm", "CuttingEdgeHeight=20 mm", "ShankDiameter=6 mm"];
    for text in usual.iter().chain(more) {
        let (name, value) = text.split_once('=').expect("a name and a value");
        parameters.insert(name.to_owned(), json!(value));
    }
    json!({ "version": 2, "name": shape, "shape": format!("{shape}.fcstd"), "parameter": parameters })
}

/// Shapes of FreeCAD, and the parameters beside the usual ones.
const BITS: &str = "\
endmill:
reamer:
ballend:
bullnose: CornerRadius=1.5 mm
chamfer: TipDiameter=1 mm, CuttingEdgeAngle=60 deg, CuttingEdgeHeight=4 mm
v-bit: TipDiameter=1 mm, CuttingEdgeAngle=90 deg
dovetail: NeckDiameter=3 mm, NeckHeight=2 mm, CuttingEdgeAngle=30 deg, CuttingEdgeHeight=3 mm
drill: TipAngle=118 deg
tap: TipAngle=90 deg, CuttingEdgeLength=12 mm
taperedballnose: TaperAngle=8 deg, TaperDiameter=9 mm, ShankDiameter=10 mm
radius: CuttingRadius=2 mm, TipDiameter=2 mm
slittingsaw: BladeThickness=2 mm, CapHeight=1 mm, CapDiameter=4 mm, Diameter=30 mm
probe: ShaftDiameter=3 mm
thread-mill: NeckDiameter=3 mm, NeckLength=12 mm, Crest=0.1 mm, cuttingAngle=60 deg";

/// Returns a bit of every shape of FreeCAD.
pub fn bits() -> Vec<Value> {
    let bit_of = |line: &str| {
        let (shape, more) = line.split_once(':').expect("a shape and parameters");
        let more = more.split(',').map(str::trim).filter(|text| !text.is_empty());
        bit(shape, &more.collect::<Vec<_>>())
    };
    BITS.lines().map(bit_of).collect()
}

fn fcholder() -> Value {
    json!({ "version": 1, "name": "nut", "units": "mm", "id": "nut-1",
        "profile": [[11, 0], [14, 2], [14, 18]] })
}

const HSM: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<tool-library xmlns="http://www.hsmworks.com/xml/2004/cnc/tool-library" guid="library" version="10">
  <tool guid="a" type="tapered mill" tapered-type="tapered_ball" unit="millimeters" version="1.5">
    <description>ball &amp; cone</description>
    <nc diameter-offset="7" length-offset="7" number="7"/>
    <body diameter="1" corner-radius="0.5" taper-angle="5" flute-length="20" body-length="30"
      overall-length="50" shaft-diameter="6" shoulder-length="25" number-of-flutes="2"/>
    <holder guid="h"><section diameter="20" length="0"/><section diameter="25" length="10"/></holder>
  </tool>
  <tool guid="b" type="drill" unit="inches" version="1.5">
    <description>drill</description>
    <nc number="8"/>
    <body diameter="0.25" taper-angle="118" flute-length="1" body-length="1.5" overall-length="2.5"
      shaft-diameter="0.25" shoulder-length="1"/>
    <shaft><section diameter="0.25" length="0"/><section diameter="0.3" length="0.5"/></shaft>
  </tool>
</tool-library>
"#;

const APT: &str = "PARTNO/CUTTERS
UNITS/MM
CUTTER/6.,3.,0.,3.,0.,0.,30.
LOADTL/1
CUTTER/10,1.5,3.5,1.5,0,0,40
LOADTL/2
TLDATA/MILL,8.0000,0.5000,50.0000,0.0000,0.0000
LOADTL/3
TLDATA/DRILL,MILL,5.0000,0.0000,60.0000,118.0000,35.0000
LOADTL/4
GOTO/0,0,0
FINI
";
