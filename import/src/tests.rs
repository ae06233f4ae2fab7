//! Imported tools against closed forms, and files that are no libraries.

use super::{Entry, ImportError, Library, Note, Stated};
use serde_json::{Value, json};
use touchoff::tool::{Interpreted, Tool};

mod formats;
mod freecad;
mod segments;
mod threads;
mod versions;

fn library(tool: &Value) -> Library {
    let text = json!({ "version": 33, "data": [tool] }).to_string();
    Library::parse("library.json".as_ref(), text.as_bytes()).expect("a library")
}

/// Returns a Fusion tool with these dimensions; the overall length is 60 and the shank as wide as the cutter.
fn fusion(kind: &str, dimensions: &Value) -> Value {
    let mut geometry = json!({ "DC": 10, "LCF": 20, "OAL": 60, "LB": 40 });
    for (key, value) in dimensions.as_object().expect("an object") {
        geometry[key] = value.clone();
    }
    json!({ "type": kind, "unit": "millimeters", "description": "a tool", "geometry": geometry })
}

fn loaded(tool: &Value) -> (Entry, Interpreted) {
    let library = library(tool);
    let tool = library.tools().first().unwrap_or_else(|| panic!("{:?}", library.skipped()));
    let loaded = tool.load().unwrap_or_else(|error| panic!("{error}\n{:?}", tool.files));
    assert_eq!(loaded.warnings(), "", "{:?}", tool.files);
    (tool.entry.clone(), loaded)
}

/// Returns the corners of a tool's outline.
fn corners(tool: &Value) -> Vec<[f64; 2]> {
    loaded(tool).1.info().outline.iter().map(|segment| segment.to).collect()
}

fn assert_corners(kind: &str, dimensions: &Value, expected: &[[f64; 2]]) {
    let corners = corners(&fusion(kind, dimensions));
    let same = corners.len() == expected.len()
        && corners.iter().zip(expected).all(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-12);
    assert!(same, "{kind} {dimensions}: {corners:?}, not {expected:?}");
}

/// Every corner is computed here by the formulas of a drawing, in doubles.
#[test]
fn cutting_parts_have_the_corners_of_their_drawings() {
    let top = [[5.0, 20.0], [5.0, 60.0], [0.0, 60.0]];
    let with = |first: &[[f64; 2]]| [first, &top].concat();
    let straight = |first: &[[f64; 2]]| [first, &[[5.0, 20.0], [5.0, 60.0], [0.0, 60.0]]].concat();
    assert_corners("flat end mill", &json!({}), &with(&[[5.0, 0.0]]));
    assert_corners("ball end mill", &json!({ "RE": 5 }), &with(&[[5.0, 5.0]]));
    assert_corners("bull nose end mill", &json!({ "RE": 2 }), &with(&[[3.0, 0.0], [5.0, 2.0]]));
    // A point of 90 degrees is as high as the radius.
    assert_corners("drill", &json!({ "SIG": 90 }), &straight(&[[5.0, 5.0]]));
    let (sin, cos, tan) = (0.5, 3f64.sqrt() / 2.0, 1.0 / 3f64.sqrt());
    let neck = json!({ "TA": 30, "shoulder-diameter": 6, "tip-diameter": 2, "LCF": 1, "SFDM": 6 });
    let high = 4.0 / tan;
    let chamfer = [[1.0, 0.0], [5.0, high], [3.0, high + 2.0 / tan], [3.0, 60.0], [0.0, 60.0]];
    assert_corners("chamfer mill", &neck, &chamfer);
    let inner = 5.0 - (1.0 - sin) / cos;
    let wide = 5.0 + 20.0 * tan;
    let tapered = [
        [inner, 0.0],
        [inner + cos, 1.0 - sin],
        [wide, 20.0],
        [5.0, 20.0],
        [5.0, 60.0],
        [0.0, 60.0],
    ];
    assert_corners("tapered mill", &json!({ "TA": 30, "RE": 1, "SFDM": 10 }), &tapered);
    let edge = [4.0 + cos, 1.0 + sin];
    let narrow = edge[0] - (4.0 - edge[1]) * tan;
    let dovetail = [[4.0, 0.0], edge, [narrow, 4.0], [2.0, 4.0], [2.0, 60.0], [0.0, 60.0]];
    assert_corners("dovetail mill", &json!({ "TA": 30, "RE": 1, "LCF": 4, "SFDM": 4 }), &dovetail);
    let ball = [[5.0, 5.0], [3.0, 9.0], [3.0, 60.0], [0.0, 60.0]];
    assert_corners("lollipop mill", &json!({ "shoulder-diameter": 6, "LCF": 9, "SFDM": 6 }), &ball);
    let slot =
        [[4.0, 0.0], [5.0, 1.0], [5.0, 3.0], [4.0, 4.0], [3.0, 4.0], [3.0, 60.0], [0.0, 60.0]];
    assert_corners("slot mill", &json!({ "RE": 1, "LCF": 4, "SFDM": 6 }), &slot);
    let radius = [[5.0, 0.0], [7.0, 2.0], [7.0, 20.0], [7.0, 60.0], [0.0, 60.0]];
    assert_corners("radius mill", &json!({ "RE": 2 }), &radius);
    let root = 5.0 - 1.0 / tan;
    let thread = [
        [root, 0.0],
        [5.0, 1.0],
        [root, 2.0],
        [5.0, 3.0],
        [root, 4.0],
        [root, 5.0],
        [4.0, 5.0],
        [4.0, 60.0],
        [0.0, 60.0],
    ];
    let teeth = json!({ "TP": 2, "NT": 2, "LCF": 5, "thread-profile-angle": 60, "SFDM": 8 });
    assert_corners("thread mill", &teeth, &thread);
    let face =
        [[5.0, 0.0], [15.0, 10.0 / tan], [15.0, 20.0], [8.0, 20.0], [8.0, 60.0], [0.0, 60.0]];
    assert_corners("face mill", &json!({ "TA": 30, "DCX": 30, "SFDM": 16 }), &face);
    let center =
        [[1.0, 1.0], [1.0, 3.0], [5.0, 3.0 + 4.0 / tan], [5.0, 20.0], [5.0, 60.0], [0.0, 60.0]];
    let pilot = json!({ "tip-diameter": 2, "tip-length": 3, "SIG": 90, "TA": 60 });
    assert_corners("center drill", &pilot, &center);
}

#[test]
fn an_assembly_has_the_corners_of_cutter_shaft_and_holder() {
    let mut tool = fusion(
        "flat end mill",
        &json!({ "shoulder-length": 25, "shoulder-diameter": 8, "SFDM": 6 }),
    );
    tool["shaft"] =
        json!({ "segments": [{ "height": 5, "lower-diameter": 6, "upper-diameter": 12 }] });
    // A holder in inches, with a groove.
    tool["holder"] = json!({ "type": "holder", "unit": "inches", "description": "ER16",
        "segments": [{ "height": 1, "lower-diameter": 1, "upper-diameter": 1 },
                     { "height": 1, "lower-diameter": 0.5, "upper-diameter": 2 }] });
    let expected = [
        [5.0, 0.0],
        [5.0, 20.0],
        [4.0, 20.0],
        [4.0, 25.0],
        [3.0, 25.0],
        [6.0, 30.0],
        [6.0, 40.0],
        [12.7, 40.0],
        [12.7, 65.4],
        [6.35, 65.4],
        [25.4, 90.8],
        [0.0, 90.8],
    ];
    let corners = corners(&tool);
    let same = corners.len() == expected.len()
        && corners.iter().zip(expected).all(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-12);
    assert!(same, "{corners:?}");
    let (entry, tool) = loaded(&tool);
    let names: Vec<&str> = tool.info().surfaces.iter().map(|surface| &*surface.name).collect();
    assert_eq!(names, ["cutter.face", "cutter.flute", "cutter.neck", "shaft.shaft", "holder.body"]);
    assert!(matches!(
        entry.notes[..],
        [Note::Contradiction { first: Stated { what: "shank diameter", value: 6.0 }, .. }]
    ));
}

#[test]
fn contradictions_and_gaps_are_noted() {
    let holder = json!({ "type": "holder", "unit": "millimeters", "description": "H",
        "segments": [{ "height": 10, "lower-diameter": 8, "upper-diameter": 20 }] });
    let mut tool = fusion("flat end mill", &json!({ "LB": 15, "SFDM": 10 }));
    tool["holder"] = holder.clone();
    let notes = |tool: &Value| library(tool).tools()[0].entry.notes.clone();
    assert_eq!(
        notes(&tool),
        [
            Note::FlutesInHolder { flutes: 20.0, stickout: 15.0 },
            Note::ShankTooWide { shank: 10.0, nose: 8.0 },
        ]
    );
    let mut tool = fusion("flat end mill", &json!({ "LB": 70, "SFDM": 6 }));
    tool["holder"] = holder;
    assert_eq!(notes(&tool), [Note::TooShort { length: 60.0, stickout: 70.0 }]);
    let thin = json!({ "shoulder-length": 30, "shoulder-diameter": 0.2, "SFDM": 6 });
    let thin = notes(&fusion("flat end mill", &thin));
    assert_eq!(thin, [Note::ThinNeck { neck: 0.2, diameter: 10.0 }]);
    let zero = notes(&fusion("reamer", &json!({ "SIG": 0, "RE": 0, "LCF": 0, "SFDM": 0 })));
    let unstated = zero.iter().map(|note| match note {
        Note::Unstated(what, _) => what,
        other => panic!("{other}"),
    });
    assert_eq!(unstated.collect::<Vec<_>>(), [&"shank diameter", &"flute length"]);
}

#[test]
fn the_same_library_gives_the_same_files() {
    let tools = [fusion("flat end mill", &json!({})), fusion("flat end mill", &json!({}))];
    let text = json!({ "data": tools }).to_string();
    let read = || Library::parse("l.json".as_ref(), text.as_bytes()).expect("a library");
    let files = |library: &Library| {
        library.tools().iter().flat_map(|t| t.files.clone()).collect::<Vec<_>>()
    };
    assert_eq!(files(&read()), files(&read()));
    let paths: Vec<String> = read().tools().iter().map(super::ImportedTool::path).collect();
    assert_eq!(paths, ["a_tool.tool", "a_tool_2.tool"]);
}

#[test]
fn tools_have_names_that_every_system_takes() {
    let named = |name: &str| {
        let mut tool = fusion("flat end mill", &json!({}));
        tool["description"] = name.into();
        tool
    };
    let names = ["con", "NUL", "com1", "lpt9", "com10", "console", "com", "tool_con"];
    let tools: Vec<Value> = names.map(named).into();
    let text = json!({ "data": tools }).to_string();
    let library = Library::parse("l.json".as_ref(), text.as_bytes()).expect("a library");
    let paths: Vec<String> = library.tools().iter().map(super::ImportedTool::path).collect();
    let expected =
        ["tool_con", "tool_nul", "tool_com1", "tool_lpt9", "com10", "console", "com", "tool_con_2"];
    assert_eq!(paths, expected.map(|name| format!("{name}.tool")));
}

/// A folder of tools can be a stranger's.
#[test]
#[cfg(unix)]
fn a_folder_of_tools_leads_nowhere_else() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().expect("a folder");
    let [tools, outside] = ["tools", "outside"].map(|name| folder.path().join(name));
    for made in [&tools, &outside] {
        std::fs::create_dir(made).expect("a folder");
    }
    let refused = || {
        let found = crate::find_in_folder(&tools, "T1".as_ref());
        matches!(found, Err(crate::FindError::Outside { .. }))
    };
    std::fs::write(outside.join("secret.tool"), "secret").expect("written");
    std::fs::write(tools.join("tools.toml"), "T1 = [\"../outside/secret.tool\"]").expect("written");
    assert!(refused() && crate::files_in_folder(&tools) == [tools.join("tools.toml")]);
    std::fs::remove_file(tools.join("tools.toml")).expect("removed");
    symlink("../outside/secret.tool", tools.join("tools.toml")).expect("a link");
    assert!(refused() && crate::files_in_folder(&tools).is_empty());
    std::fs::remove_file(tools.join("tools.toml")).expect("removed");
    symlink("../outside/secret.tool", tools.join("T1.tool")).expect("a link");
    assert!(refused() && crate::files_in_folder(&tools).is_empty());
    // Nor does an import into it.
    let library = library(&fusion("flat end mill", &json!({})));
    let tool = &library.tools()[0];
    for (target, link) in
        [("../outside/new.tool", tool.path()), ("../outside/new.toml", "tools.toml".to_owned())]
    {
        symlink(target, tools.join(&link)).expect("a link");
    }
    assert!(matches!(tool.write_to(&tools), Err(ImportError::Outside { .. })));
    let numbers = crate::write_numbers(&tools, &[tool], &[]);
    assert!(matches!(numbers, Err(crate::FindError::Outside { .. })), "{numbers:?}");
    assert_eq!(std::fs::read_dir(&outside).expect("a folder").count(), 1);
}

/// Outputs are compared with the files of a folder that a tool can be read from.
#[test]
fn tools_of_a_folder_end_in_tool_and_stand_in_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let place = |name: &str| folder.path().join(name);
    std::fs::create_dir(place("sub")).expect("a folder");
    let tools = ["d6.35.tool", "sub/x.tool", "sub/listed.tool"];
    for name in tools.iter().chain(&["T1", "holder.txt", "T3"]) {
        std::fs::write(place(name), "").expect("written");
    }
    std::fs::write(place("tools.toml"), "T2 = [\"sub/listed.tool\"]\nT3 = [\"T3\"]")
        .expect("written");
    let find = |name: &str| crate::find_in_folder(folder.path(), name.as_ref());
    for name in ["sub/x.tool", "./d6.35.tool", "..", "", "d6.35.tool/"] {
        assert!(matches!(find(name), Err(crate::FindError::NoName { .. })), "{name}");
    }
    for (name, file) in [
        ("d6.35", "d6.35.tool"),
        ("d6.35.tool", "d6.35.tool"),
        ("t2", "sub/listed.tool"),
        ("T1", "T1.tool"),
        ("holder.txt", "holder.txt.tool"),
    ] {
        let found = find(name).expect("a file");
        assert_eq!(found, place(file), "{name}");
        assert_eq!(crate::files_in_folder(folder.path()).contains(&found), found.is_file());
    }
    let refused = |name: &str| find(name).expect_err("no tool").to_string();
    let listed = refused("T3");
    assert!(listed.contains("tools.toml: T3 is `T3`") && listed.ends_with("rename it"), "{listed}");
    // A number of two tools, and numbers in other spellings.
    std::fs::write(place("T2.tool"), "").expect("written");
    let several = refused("T2");
    assert!(several.contains("`sub/listed.tool`, `T2.tool`"), "{several}");
    for key in ["T02", "t2", "2", "T+2", "T"] {
        std::fs::write(place("tools.toml"), format!("{key:?} = [\"sub/listed.tool\"]"))
            .expect("written");
        let message = refused("T2");
        assert!(message.contains(&format!("`{key}` is no number")), "{message}");
    }
}

/// Values of few bytes take much memory.
#[test]
fn a_text_whose_values_do_not_fit_into_memory_is_refused() {
    for value in ["{}", "0", "[]", "{\"a\":0}"] {
        let count = (12 << 20) / value.len();
        let text = format!("{{\"data\":[{}{value}]}}", format!("{value},").repeat(count));
        let error = Library::parse("l.json".as_ref(), text.as_bytes()).expect_err("too many");
        assert!(error.to_string().contains("memory: split it"), "{error}");
    }
}

#[test]
fn entries_without_a_solid_are_left_out_with_the_reason() {
    let reason = |tool: &Value| library(tool).skipped()[0].reason.clone();
    assert!(reason(&fusion("laser cutter", &json!({}))).contains("no solid"));
    assert!(reason(&fusion("bull nose end mill", &json!({}))).contains("corner radius"));
    assert!(reason(&fusion("flat end mill", &json!({ "DC": -1 }))).contains("diameter is -1"));
    for (dimension, name) in [
        ("LCF", "flute length"),
        ("SFDM", "shank diameter"),
        ("shoulder-length", "shoulder length"),
    ] {
        let tool = fusion("reamer", &json!({ "SIG": 0, dimension: -1 }));
        assert!(reason(&tool).contains(&format!("the {name} is -1: correct it")), "{dimension}");
    }
    assert!(
        reason(&fusion("bull nose end mill", &json!({ "RE": 6 }))).contains("corner radius, 6")
    );
    assert!(reason(&json!({ "type": "drill", "unit": "parsec" })).contains("parsec"));
    assert!(reason(&json!(3)).contains("no object"));
}

#[test]
fn files_that_are_no_libraries_are_refused() {
    let parse =
        |name: &str, text: &[u8]| Library::parse(name.as_ref(), text).expect_err("no library");
    assert!(matches!(parse("part.stl", b""), ImportError::UnknownFormat { .. }));
    let malformed = |name: &str, text: &[u8]| match parse(name, text) {
        ImportError::Malformed { reason, .. } => reason,
        other => panic!("{other}"),
    };
    assert!(malformed("l.json", b"{").contains("EOF"));
    assert!(malformed("l.json", b"{}").contains("`data`"));
    let twice = malformed("l.json", br#"{"data": [{"geometry": {"DC": 2, "LCF": 9, "DC": 20}}]}"#);
    assert!(twice.contains("has the key `DC` twice at line 1"), "{twice}");
    assert!(malformed("l.json", b"\xff\xfe\x00").contains("UTF-16"));
    assert!(malformed("l.tools", b"PK").contains("zip") || !malformed("l.tools", b"PK").is_empty());
    assert!(malformed("l.hsmlib", b"<tool-library><tool>").contains("tool-library"));
    assert!(malformed("l.tbl", b"T1 D#2").contains("line 1"));
    assert!(malformed("l.apt", b"PARTNO/X").contains("CUTTER"));
    assert!(malformed("l.fctb", b"[]").contains("no JSON object"));
}

/// The same ball end mill in three notations.
#[test]
fn notations_agree() {
    let outline = |library: &Library| {
        let tool = library.tools().first().unwrap_or_else(|| panic!("{:?}", library.skipped()));
        tool.load().expect("a tool").info().outline.iter().map(|s| s.to).collect::<Vec<_>>()
    };
    let parse =
        |name: &str, text: &str| Library::parse(name.as_ref(), text.as_bytes()).expect("a library");
    let fusion = outline(&library(&fusion("ball end mill", &json!({ "OAL": 50, "SFDM": 10 }))));
    let bit = r#"{ "version": 2, "name": "ball", "shape": "ballend.fcstd", "parameter": { "Diameter": "1.00 cm",
        "CuttingEdgeHeight": "20.0 mm", "ShankDiameter": "10 mm", "Length": "50.000 mm" } }"#;
    assert_eq!(outline(&parse("ball.fctb", bit)), fusion);
    let hsm = r#"<?xml version="1.0"?><tool-library xmlns="http://www.hsmworks.com/xml/2004/cnc/tool-library">
        <tool type="ball end mill" unit="millimeters"><description>ball &amp; shank</description><nc number="7"/>
        <body diameter="10" corner-radius="5" flute-length="20" overall-length="50" shaft-diameter="10"/></tool>
        </tool-library>"#;
    let mut utf16: Vec<u8> = vec![0xff, 0xfe];
    utf16.extend(hsm.encode_utf16().flat_map(u16::to_le_bytes));
    let hsm = Library::parse("l.hsmlib".as_ref(), &utf16).expect("a library");
    assert_eq!(outline(&hsm), fusion);
    assert_eq!(
        (hsm.tools()[0].entry.number, &*hsm.tools()[0].entry.title),
        (Some(7), "ball & shank")
    );
    let apt = parse("p.apt", "UNITS/MM\nCUTTER/10,5,0,5,0,0,50\nLOADTL/3\nFINI\n");
    assert_eq!(outline(&apt), [[5.0, 5.0], [5.0, 50.0], [0.0, 50.0]]);
    assert_eq!(apt.tools()[0].entry.number, Some(3));
}

/// Tool numbers stand before or after the cutter, statements go on after `$`, and a field that is no number is refused.
#[test]
fn cutters_of_programs_keep_their_numbers() {
    let read = |text: &str| Library::parse("p.apt".as_ref(), text.as_bytes()).expect("a program");
    let numbers = |text: &str| -> Vec<Option<u32>> {
        read(text).tools().iter().map(|tool| tool.entry.number).collect()
    };
    let cutter = "CUTTER/6,0,3,0,0,0,30\n";
    let after = format!("UNITS/MM\n{cutter}LOADTL/1\n{cutter}LOADTL / 2.0, OSETNO, 2\nFINI\n");
    assert_eq!(numbers(&after), [Some(1), Some(2)]);
    let before = format!("UNITS/MM\nLOADTL/1\n{cutter}LOADTL/2\n{cutter}FINI\n");
    assert_eq!(numbers(&before), [Some(1), Some(2)]);
    let named = format!("UNITS/MM\n{cutter}LOADTL/DRILL\n{cutter}LOADTL/3\n");
    assert_eq!(numbers(&named), [None, Some(3)]);
    let continued = "UNITS/MM\nCUTTER / 6., 1.,  $\n 2., 1., 0., 0., 30.\nFINI\n";
    let library = read(continued);
    assert_eq!(library.tools()[0].entry.diameter(), Some(6.0));
    assert_eq!(library.tools()[0].entry.length(), Some(30.0));
    let wrong = read("UNITS/MM\nCUTTER/6,x,3,0,0,0,30\n");
    assert!(wrong.skipped()[0].reason.contains("corner radius is `x`"), "{:?}", wrong.skipped());
    // Autodesk's post processors state no centre of a corner.
    let corner = |centre: &str| {
        let library = read(&format!("UNITS/MM\nCUTTER/6,1,{centre},0,0,30\n"));
        let outline = library.tools()[0].load().expect("a tool").info().outline.clone();
        outline.iter().map(|segment| segment.to).collect::<Vec<_>>()
    };
    assert_eq!([corner("0,0"), corner("0,1")], [corner("2,1"), corner("2,1")]);
    // SolidWorks CAM has another word for the unit.
    assert_eq!(read(&format!("UNIT/MM\n{cutter}")).tools()[0].entry.unit.symbol(), "mm");
    let units = read(&format!("UNITS/MM\n{cutter}UNITS/INCHES\n{cutter}"));
    let units: Vec<&str> = units.tools().iter().map(|tool| tool.entry.unit.symbol()).collect();
    assert_eq!(units, ["mm", "inch"]);
}
