//! Entries as files of other programs have them, against the same tools in plain notation.

use super::super::{ImportError, Library, Note};
use super::{corners, fusion, library};
use serde_json::{Value, json};
use touchoff::tool::Tool;

fn parse(name: &str, text: &str) -> Library {
    Library::parse(name.as_ref(), text.as_bytes()).expect("a library")
}

/// Returns the corners of the outline of each tool.
fn outlines(library: &Library) -> Vec<Vec<[f64; 2]>> {
    assert!(library.skipped().is_empty(), "{:?}", library.skipped());
    let corners = |tool: &super::super::ImportedTool| {
        let tool = tool.load().expect("a tool");
        tool.info().outline.iter().map(|segment| segment.to).collect()
    };
    library.tools().iter().map(corners).collect()
}

fn reasons(library: &Library) -> Vec<&str> {
    library.skipped().iter().map(|skipped| &*skipped.reason).collect()
}

/// HSM has both angles of a centre drill, and the point of a reamer, as taper angles.
#[test]
fn angles_of_hole_making_tools_in_hsm_are_those_of_fusion() {
    let tool = |kind: &str, angles: &str| {
        parse(
            "l.hsmlib",
            &format!(
                "<tool-library><tool type='{kind}' unit='millimeters'><body diameter='6' {angles} flute-length='12' \
                 overall-length='36' shaft-diameter='6' tip-diameter='2' tip-length='2'/></tool></tool-library>"
            ),
        )
    };
    let plain = |kind: &str, angles: Value| {
        let mut dimensions = json!({ "DC": 6, "LCF": 12, "OAL": 36, "SFDM": 6, "tip-diameter": 2,
            "tip-length": 2 });
        for (key, angle) in angles.as_object().expect("an object") {
            dimensions[key] = angle.clone();
        }
        corners(&fusion(kind, &dimensions))
    };
    let center_drill = tool("center drill", "taper-angle='118' taper-angle2='90'");
    assert_eq!(outlines(&center_drill)[0], plain("center drill", json!({ "SIG": 118, "TA": 90 })));
    assert_eq!(
        reasons(&tool("center drill", "taper-angle='118'")),
        [
            "the library does not state the body angle: correct it in the library and export it again"
        ]
    );
    for kind in ["reamer", "counter bore", "boring bar"] {
        let pointed = tool(kind, "taper-angle='120'");
        assert_eq!(outlines(&pointed)[0], plain(kind, json!({ "SIG": 120 })), "{kind}");
    }
    let chamfer = tool("chamfer mill", "taper-angle='45' taper-angle2='5'");
    assert_eq!(outlines(&chamfer)[0], plain("chamfer mill", json!({ "TA": 45 })));
}

#[test]
fn a_library_without_tools_is_reported() {
    let empty =
        "<tool-library xmlns='http://www.hsmworks.com/xml/2004/cnc/tool-library' version='14'/>";
    for (name, text) in
        [("l.hsmlib", empty), ("l.json", r#"{ "data": [] }"#), ("l.tbl", "; none\n")]
    {
        assert_eq!(reasons(&parse(name, text)), ["it has no tools"], "{name}");
    }
}

#[test]
fn numbers_may_be_texts_in_fusion() {
    let mut tool = fusion("flat end mill", &json!({ "DC": "6.5", "SFDM": 6 }));
    let holder = json!({ "type": "holder", "unit": "millimeters", "description": "H",
        "segments": [{ "height": 15, "lower-diameter": "44", "upper-diameter": 40 }] });
    tool["holder"] = holder;
    let text = corners(&tool);
    tool["geometry"]["DC"] = json!(6.5);
    tool["holder"]["segments"][0]["lower-diameter"] = json!(44);
    assert_eq!(text, corners(&tool));
    tool["holder"]["segments"][0]["lower-diameter"] = json!("44 mm");
    let reason = library(&tool).skipped()[0].reason.clone();
    assert_eq!(reason, "its holder: a segment has no number `lower-diameter`");
}

#[test]
fn a_thread_mill_without_a_pitch_is_a_cylinder_with_a_note() {
    let tool = |pitch: f64| fusion("thread mill", &json!({ "TP": pitch, "NT": 1, "SFDM": 10 }));
    assert_eq!(corners(&tool(0.0)), corners(&fusion("flat end mill", &json!({ "SFDM": 10 }))));
    let notes = library(&tool(0.0)).tools()[0].entry.notes.clone();
    let is_pitch = |note: &&Note| matches!(note, Note::Unstated("thread pitch", _));
    assert_eq!(notes.iter().filter(is_pitch).count(), 1, "{notes:?}");
    assert!(library(&tool(-1.0)).skipped()[0].reason.contains("thread pitch is -1"));
}

#[test]
fn freecad_has_commas_and_names_of_other_releases() {
    let bit = |shape: &str, parameters: &str| {
        parse(
            "b.fctb",
            &format!(
                r#"{{ "name": "b", "shape": "{shape}.fcstd", "parameter": {{ "Diameter": "5,00 mm",
                "Length": "58,5 mm", "ShankDiameter": "5 mm", {parameters} }} }}"#
            ),
        )
    };
    let endmill = bit("endmill", r#""CuttingEdgeHeight": "30.25 mm""#);
    assert_eq!(outlines(&endmill), [[[2.5, 0.0], [2.5, 30.25], [2.5, 58.5], [0.0, 58.5]]]);
    let wrong = bit("endmill", r#""CuttingEdgeHeight": "1,030.25 mm""#);
    assert_eq!(
        reasons(&wrong),
        [
            "its `CuttingEdgeHeight` is `1,030.25 mm`, no number with a unit: correct the bit in FreeCAD, and save it again"
        ]
    );
    let cut = r#""CuttingEdgeHeight": "30 mm", "TipDiameter": "1 mm", "CuttingEdgeAngle": "60 °""#;
    let torus = r#""CuttingEdgeHeight": "30 mm", "TorusRadius": "1 mm""#;
    for (name, other, parameters) in [("v-bit", "v_bit", cut), ("bullnose", "torus", torus)] {
        assert_eq!(outlines(&bit(name, parameters)), outlines(&bit(other, parameters)));
    }
    // FreeCAD's own thread cutter leaves the angle to its shape.
    let tooth = r#""NeckDiameter": "3 mm", "NeckLength": "20 mm", "Crest": "0.1 mm""#;
    let stated = bit("thread-mill", &format!(r#"{tooth}, "cuttingAngle": "60 °""#));
    let unstated = bit("threadmill", tooth);
    assert_eq!(outlines(&stated), outlines(&unstated));
    assert_eq!(
        unstated.tools()[0].entry.notes,
        [Note::Unstated("angle of the thread", "taken: 60".to_owned())]
    );
    // A vendor's tapered ball on the shape of a straight one.
    let tapered = bit("ballend", r#""CuttingEdgeHeight": "15 mm", "TaperAngle": "5.000 °""#);
    let notes = &tapered.tools()[0].entry.notes;
    assert!(matches!(notes[..], [Note::NotTapered { angle: 5.0 }]));
    let insert =
        parse("b.fctb", r#"{ "shape": "Iso_shape_C.fcstd", "parameter": { "TipAngle": "80 °" } }"#);
    assert_eq!(reasons(&insert), ["it is a turning insert, which is no solid of revolution"]);
    let own = bit("my-cutter", r#""CuttingEdgeHeight": "30 mm""#);
    assert_eq!(reasons(&own), ["the shape `my-cutter` is none of FreeCAD's own"]);
}

#[test]
fn a_line_that_is_no_entry_does_not_hide_the_others_of_a_tool_table() {
    let table = parse("t.tbl", "TOOLNO POCKET DIAMETER\nT1 P1 D6 ;ball\n (mill)\nT2 P2\n");
    let skipped: Vec<&str> = table.skipped().iter().map(|skipped| &*skipped.name).collect();
    assert_eq!(skipped, ["line 1", "T1 ball", "line 3", "T2"]);
    assert_eq!(table.skipped()[2].reason, "`(mill)` is no word of a tool table");
}

/// The shank of a drill is wider than its flutes, whose length FreeCAD's own drills do not state.
#[test]
fn a_shank_is_drawn_where_it_has_a_length() {
    let bit = |flutes: &str| {
        parse(
            "b.fctb",
            &format!(
                r#"{{ "shape": "drill.fcstd", "parameter": {{ "Diameter": "2 mm", "Length": "38 mm",
                "ShankDiameter": "3 mm", {flutes} "TipAngle": "90 °" }} }}"#
            ),
        )
    };
    let stated = bit(r#""CuttingEdgeHeight": "5 mm","#);
    let expected = [[1.0, 1.0], [1.0, 5.0], [1.5, 5.0], [1.5, 38.0], [0.0, 38.0]];
    assert_eq!(outlines(&stated), [expected]);
    assert_eq!(stated.tools()[0].entry.notes, []);
    let unstated = bit("");
    assert_eq!(outlines(&unstated), [[[1.0, 1.0], [1.0, 38.0], [0.0, 38.0]]]);
    let notes = &unstated.tools()[0].entry.notes;
    let [Note::Unstated(first, _), Note::Unstated(second, _)] = &notes[..] else {
        panic!("{notes:?}");
    };
    assert_eq!([*first, *second], ["flute length", "length of the shank"]);
    let fluted = fusion("flat end mill", &json!({ "LCF": 60, "SFDM": 6 }));
    assert_eq!(corners(&fluted), [[5.0, 0.0], [5.0, 60.0], [0.0, 60.0]]);
}

/// Post processors of Autodesk write 0 for the centre of every corner.
#[test]
fn a_corner_of_apt_without_a_centre_touches_end_and_side() {
    let zeros =
        parse("p.apt", "UNITS/MM\nCUTTER/6, 3, 0, 0, 0, 0, 30\nCUTTER/6, 1, 0, 0, 0, 0, 30\n");
    let full = parse("p.apt", "UNITS/MM\nCUTTER/6,3,0,3,0,0,30\nCUTTER/6,1,2,1,0,0,30\n");
    assert_eq!(outlines(&zeros), outlines(&full));
    let has_note = |library: &Library| {
        let notes = library.tools()[0].entry.notes.iter();
        notes.clone().any(|note| matches!(note, Note::Unstated("centre of the corner", _)))
    };
    assert!(has_note(&zeros) && !has_note(&full));
}

/// NX numbers its tools by `LOAD/TOOL`, names them by `TOOL PATH`, and states them again for each operation.
#[test]
fn tools_of_nx_have_their_names_and_numbers_once() {
    let operation = |tool: &str, data: &str, number: u32| {
        format!(
            "TOOL PATH/CAVITY_MILL,TOOL,{tool}\nTLDATA/{data}\nPAINT/PATH\nSELECT/TOOL,9\n\
             LOAD/TOOL,{number},ADJUST,1\nGOTO/0,0,0\nEND-OF-PATH\n"
        )
    };
    let mill = "MILL,10.0,1.0,75.0,0.0,0.0";
    let program = [
        "UNITS/MM\n",
        &operation("EM10", mill, 3),
        &operation("EM10", mill, 3),
        &format!("TOOL PATH/CONTOUR,TOOL,EM10\nTLDATA/{mill}\nEND-OF-PATH\n"),
        &operation("BALL6", "MILL,6.0,3.0,75.0,0.0,0.0,0.0,3.0", 4),
        &operation("EM10", "MILL,10.0,1.0,60.0,0.0,0.0", 3),
        &operation("BARREL", "MILL,6.0,0.5,75.0,0.0,0.0,2.5,0.5,20,-17,10", 5),
        &operation("OD", "TURN,RIGHT,ROUGH,XZ,1.2,20,95,5,25,0", 6),
    ]
    .concat();
    let library = parse("p.cls", &program);
    let tools: Vec<(Option<u32>, &str, Option<f64>)> = library
        .tools()
        .iter()
        .map(|tool| (tool.entry.number, &*tool.entry.title, tool.entry.length()))
        .collect();
    let expected = [
        (Some(3), "EM10", Some(75.0)),
        (Some(4), "BALL6", Some(75.0)),
        (Some(3), "EM10", Some(60.0)),
    ];
    assert_eq!(tools, expected);
    assert_eq!(
        reasons(&library),
        [
            "its upper corner of radius 20 cannot be read yet",
            "it is a turning tool, which is no solid of revolution"
        ]
    );
}

/// A program that loads a tool again between two cutters gives the second its own number.
#[test]
fn a_number_after_a_cutter_is_not_that_of_the_next() {
    let cutter = |d: u32| format!("CUTTER/{d},0,0,0,0,0,30\n");
    let program =
        format!("UNITS/MM\n{}LOADTL/1\nLOADTL/1\n{}LOADTL/2\nFINI\n", cutter(6), cutter(8));
    let numbers: Vec<Option<u32>> =
        parse("p.apt", &program).tools().iter().map(|tool| tool.entry.number).collect();
    assert_eq!(numbers, [Some(1), Some(2)]);
}

/// A number before a cutter holds up to the next number: a cutter that is stated again is the same tool, and another one shares the number.
#[test]
fn a_number_before_a_cutter_holds_up_to_the_next() {
    let cutter = |d: u32| format!("CUTTER/{d},0,0,0,0,0,30\n");
    let tools = |program: &str| -> Vec<(f64, Option<u32>)> {
        let library = parse("p.apt", program);
        let tools = library.tools().iter();
        tools
            .map(|tool| (tool.entry.cutter.as_ref().expect("a cutter").diameter, tool.entry.number))
            .collect()
    };
    let program = format!("UNITS/MM\nLOADTL/2\n{0}{0}LOADTL/1\n{1}FINI\n", cutter(6), cutter(8));
    assert_eq!(tools(&program), [(6.0, Some(2)), (8.0, Some(1))]);
    let program = format!("UNITS/MM\nLOADTL/1\n{}{}FINI\n", cutter(6), cutter(8));
    assert_eq!(tools(&program), [(6.0, Some(1)), (8.0, Some(1))]);
}

/// SolidWorks CAM states the flutes of a cutter apart; names of tools are in Windows-1252 where NX runs on Windows.
#[test]
fn programs_of_windows_state_flutes_and_names() {
    let program = b"UNITS/MM\nTOOL PATH/A,TOOL,FR\xc4SER\nCUTTER/10,0,5,0,0,0,70\nLOAD/TOOL,1\nCSI_SET_FLUTE_LENGTH/22.\nFINI\n";
    let library = Library::parse("a.cls".as_ref(), program).expect("a library");
    let entry = &library.tools()[0].entry;
    assert_eq!(entry.title, "FR\u{c4}SER");
    assert_eq!(entry.cutter.as_ref().expect("a cutter").flute_length, 22.0);
}

#[test]
fn projects_of_camotics_are_read() {
    let project = r#"{ "units": "metric", "tools": { "30": { "units": "metric", "shape": "conical",
        "length": 12, "diameter": 10, "description": "" } }, "files": ["a.nc"] }"#;
    assert_eq!(outlines(&parse("a.camotics", project)), [[[5.0, 12.0], [0.0, 12.0]]]);
    let other = Library::parse("a.camotic".as_ref(), project.as_bytes());
    assert!(matches!(other, Err(ImportError::UnknownFormat { .. })));
}
