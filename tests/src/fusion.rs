//! Tool libraries of Fusion 360, with every type that can be read.

use serde_json::{Value, json};

/// Returns a tool of Fusion 360 with these dimensions beside the usual ones.
pub fn tool(kind: &str, more: &Value) -> Value {
    let mut geometry = json!({ "DC": 10, "LCF": 20, "OAL": 60, "LB": 40, "SFDM": 8, "NOF": 3,
        "shoulder-length": 25, "shoulder-diameter": 7 });
    for (key, value) in more.as_object().expect("an object") {
        geometry[key] = value.clone();
    }
    json!({ "type": kind, "unit": "millimeters", "description": kind, "guid": format!("id {kind}"),
        "geometry": geometry, "post-process": { "number": 3 } })
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
pub fn tools() -> Vec<Value> {
    let kinds: Vec<(String, Value)> = serde_json::from_str(FUSION).expect("types and dimensions");
    let mut tools: Vec<Value> = kinds.iter().map(|(kind, more)| tool(kind, more)).collect();
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
    let mut form = tool("form mill", &json!({ "profile": ends }));
    form["geometry"]["profile"][2] =
        json!({ "end": [4, 1], "arc": true, "ccw": true, "center": [3, 1] });
    tools.push(form);
    tools
}
