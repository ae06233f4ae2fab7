//! Bits of FreeCAD 26.3, and of folders of vendors.

use super::super::{ImportedTool, Library, Note};
use serde_json::{Value, json};
use std::fs;
use touchoff::tool::Tool;

/// Returns a bit of a shape.
fn bit(shape: &str, parameters: &Value) -> Value {
    json!({ "version": 2, "name": shape, "shape": format!("{shape}.fcstd"), "parameter": parameters })
}

fn read(bit: &Value) -> Library {
    Library::parse("b.fctb".as_ref(), bit.to_string().as_bytes()).expect("a bit")
}

/// Returns the ends of the segments of a tool's outline, each with whether it cuts.
fn outline(library: &Library) -> Vec<([f64; 2], bool)> {
    let [tool] = library.tools() else { panic!("{:?}", library.skipped()) };
    let tool = tool.load().expect("a tool");
    let info = tool.info();
    info.outline.iter().map(|segment| (segment.to, info.surface(segment.surface).cutting)).collect()
}

fn assert_outline(library: &Library, expected: &[([f64; 2], bool)]) {
    let found = outline(library);
    let is_same = found.len() == expected.len()
        && found.iter().zip(expected).all(|((found, cuts), (expected, cutting))| {
            (found[0] - expected[0]).hypot(found[1] - expected[1]) < 1e-8 && cuts == cutting
        });
    assert!(is_same, "{found:?}, not {expected:?}");
}

fn notes(library: &Library) -> Vec<Note> {
    library.tools()[0].entry.notes.clone()
}

/// A disc on a neck, in inches.
#[test]
fn a_keyway_cutter_is_a_disc_on_a_neck() {
    let keyway = bit(
        "keyway",
        &json!({ "CuttingEdgeHeight": "0.2500 in", "Diameter": "0.5000 in", "Length": "2.0000 in",
            "LowerCuttingHeight": "0.2500 in", "NeckCuttingHeight": "0.0000 in", "NeckDiameter": "0.2500 in",
            "NeckHeight": "0.7500 in", "ShankDiameter": "0.5000 in", "Units": "Imperial" }),
    );
    let expected = [
        ([6.35, 0.0], true),
        ([6.35, 6.35], true),
        ([3.175, 6.35], false),
        ([3.175, 25.4], false),
        ([6.35, 25.4], false),
        ([6.35, 50.8], false),
        ([0.0, 50.8], false),
    ];
    assert_outline(&read(&keyway), &expected);
}

#[test]
fn a_lollipop_is_a_ball_on_a_neck() {
    let neck = 5.0 + 21f64.sqrt();
    let lollipop = bit(
        "lollipop",
        &json!({ "CuttingEdgeHeight": format!("{neck:.4} mm"), "Diameter": "10 mm", "Length": "60 mm",
            "NeckDiameter": "4 mm", "NeckHeight": "15 mm", "ShankDiameter": "10 mm" }),
    );
    let top = (neck * 1e4).round() / 1e4 + 15.0;
    let expected = [
        ([5.0, 5.0], true),
        ([2.0, neck], true),
        ([2.0, top], false),
        ([5.0, top], false),
        ([5.0, 60.0], false),
        ([0.0, 60.0], false),
    ];
    assert_outline(&read(&lollipop), &expected);
}

/// The lower end of a neck can cut.
#[test]
fn a_neck_cuts_as_far_as_it_states() {
    let dovetail = |edges: &str| {
        let half = 5.0 * 3f64.sqrt();
        let narrow = 12.0 - half / 3f64.sqrt();
        let bit = bit(
            "dovetail",
            &json!({ "CuttingEdgeAngle": "60 °", "CuttingEdgeHeight": format!("{half} mm"), "Diameter": "24 mm",
                "Length": "60 mm", "NeckCuttingHeight": edges, "NeckDiameter": "10 mm", "NeckHeight": "6 mm",
                "ShankDiameter": "10 mm" }),
        );
        (read(&bit), half, narrow)
    };
    let (cutting, high, narrow) = dovetail("2 mm");
    let top = high + 6.0;
    let expected = [
        ([12.0, 0.0], true),
        ([narrow, high], true),
        ([5.0, high], false),
        ([5.0, high + 2.0], true),
        ([5.0, top], false),
        ([5.0, 60.0], false),
        ([0.0, 60.0], false),
    ];
    assert_outline(&cutting, &expected);
    let is_edge = |(at, cuts): &([f64; 2], bool)| at[0] == 5.0 && *cuts;
    assert!(!outline(&dovetail("0 mm").0).iter().any(is_edge));
}

#[test]
fn the_diameter_of_a_chamfer_mill_follows_from_its_cone() {
    let chamfer = |diameter: Value| {
        let mut parameters = json!({ "CuttingEdgeAngle": "90 °", "CuttingEdgeHeight": "4 mm", "Length": "40 mm",
            "ShankDiameter": "6 mm", "TipDiameter": "2 mm" });
        parameters["Diameter"] = diameter;
        read(&bit("chamfer", &parameters))
    };
    let derived = chamfer(Value::Null);
    assert_eq!(derived.tools()[0].entry.diameter(), Some(10.0));
    assert_eq!(outline(&derived), outline(&chamfer(json!("10 mm"))));
}

/// `Units` is the unit of a length that states none.
#[test]
fn a_length_without_a_unit_is_in_that_of_the_bit() {
    let endmill = |diameter: Value, units: &str| {
        read(&bit(
            "endmill",
            &json!({ "CuttingEdgeHeight": "1 in", "Diameter": diameter, "Length": "3 in",
                "ShankDiameter": "0.5 in", "Units": units }),
        ))
    };
    let inches = outline(&endmill(json!("0.5 in"), "Imperial"));
    for (diameter, units) in [
        (json!("0.5"), "Imperial"),
        (json!(0.5), "Imperial"),
        (json!("0.5"), "inch"),
        (json!(12.7), "Metric"),
    ] {
        assert_eq!(outline(&endmill(diameter.clone(), units)), inches, "{diameter} {units}");
    }
}

/// Texts of FreeCAD's imperial units.
#[test]
fn imperial_lengths_have_fractions_and_sums() {
    let endmill = |length: &str| {
        read(&bit(
            "endmill",
            &json!({ "CuttingEdgeHeight": "500 thou", "Diameter": "1/4\"", "Length": length, "ShankDiameter": "250 mil" }),
        ))
    };
    let expected = [
        ([3.175, 0.0], true),
        ([3.175, 12.7], true),
        ([3.175, 368.3], false),
        ([0.0, 368.3], false),
    ];
    for length in
        ["14.5 in", "14 1/2\"", "1' 2 1/2\"", "1' + 2\" + 1/2\"", "1 ft + 2,5 in", "14\" + 12.7 mm"]
    {
        assert_outline(&endmill(length), &expected);
    }
    for wrong in ["1' 2", "2 + 1/2\"", "1/0 in", "1' x", "2\" +", "1,000.5 mm", "\""] {
        let left_out = endmill(wrong);
        assert!(
            left_out.skipped()[0].reason.ends_with("save it again"),
            "{wrong}: {:?}",
            left_out.skipped()
        );
    }
    let attribute = json!({ "name": "a", "shape": "endmill.fcstd", "attribute": { "Units": "Imperial" },
        "parameter": { "CuttingEdgeHeight": "0.5", "Diameter": 0.25, "Length": "14.5", "ShankDiameter": "0.25" } });
    assert_outline(&read(&attribute), &expected);
}

/// Heights of edges that do not fit the rest are noted, and a probe has its shank by either name.
#[test]
fn contradictions_of_bits_are_noted() {
    let lollipop = |high: &str| {
        let bit = bit(
            "lollipop",
            &json!({ "CuttingEdgeHeight": high, "Diameter": "10 mm", "Length": "60 mm", "NeckDiameter": "6 mm",
                "NeckHeight": "15 mm", "ShankDiameter": "10 mm" }),
        );
        notes(&read(&bit))
    };
    assert_eq!(lollipop("9 mm"), []);
    assert!(
        matches!(&lollipop("5 mm")[..], [Note::Contradiction { second, .. }] if second.value == 9.0)
    );
    let keyway = bit(
        "keyway",
        &json!({ "CuttingEdgeHeight": "4 mm", "Diameter": "10 mm", "Length": "60 mm", "LowerCuttingHeight": "2 mm",
            "NeckDiameter": "6 mm", "NeckHeight": "15 mm", "ShankDiameter": "10 mm" }),
    );
    assert!(
        matches!(&notes(&read(&keyway))[..], [Note::Contradiction { first, .. }] if first.value == 2.0)
    );
    let [shaft, shank] = ["ShaftDiameter", "ShankDiameter"].map(|name| {
        let mut stem = json!({ "Diameter": "6 mm", "Length": "50 mm" });
        stem[name] = "4 mm".into();
        outline(&read(&bit("probe", &stem)))
    });
    assert_eq!(shaft, shank);
}

/// Bits beside their library, in folders of which the names are in lower case.
#[test]
fn folders_of_vendors_have_names_in_lower_case() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["bit", "library"] {
        fs::create_dir(folder.path().join(name)).expect("a folder");
    }
    let endmill = json!({ "CuttingEdgeHeight": "10 mm", "Diameter": "3 mm", "Length": "40 mm",
        "ShankDiameter": "3 mm" });
    let place = folder.path().join("bit/Mill_3.fctb");
    fs::write(place, bit("endmill", &endmill).to_string()).expect("a file");
    let file = folder.path().join("library/Shop.fctl");
    let read = |tool: Value| {
        let list = json!({ "label": "Shop", "tools": [tool] });
        fs::write(&file, list.to_string()).expect("a file");
        Library::read(&file).expect("a library")
    };
    fs::create_dir(folder.path().join("bit/mills")).expect("a folder");
    fs::copy(folder.path().join("bit/Mill_3.fctb"), folder.path().join("bit/mills/M.fctb"))
        .expect("a file");
    for tool in [
        json!({ "nr": 4, "path": "Mill_3.fctb" }),
        json!({ "nr": "4", "path": "mills/M.fctb" }),
        json!({ "nr": 4.0, "path": "mills\\M.fctb" }),
    ] {
        let library = read(tool);
        let [ImportedTool { entry, .. }] = library.tools() else {
            panic!("{:?}", library.skipped())
        };
        assert_eq!((entry.number, entry.diameter()), (Some(4), Some(3.0)));
    }
    for number in [json!(-1), json!(1.5), json!(1e30), json!("first")] {
        let library = read(json!({ "nr": number, "path": "Mill_3.fctb" }));
        let entry = &library.tools()[0].entry;
        let notes: Vec<String> = entry.notes.iter().map(Note::to_string).collect();
        assert_eq!(entry.number, None);
        assert!(
            notes[0].contains(&format!("tool number: {number} is no whole number")),
            "{notes:?}"
        );
    }
    let elsewhere = read(json!({ "nr": 4, "path": "../bit/Mill_3.fctb" }));
    assert!(elsewhere.skipped()[0].reason.contains(": copy the bit"), "{:?}", elsewhere.skipped());
}

/// Values that a bit leaves out are its shape's. The angle of an edge is not that of a tip.
#[test]
fn shapes_have_values_of_their_own() {
    let drill = read(&bit(
        "drill",
        &json!({ "CuttingEdgeAngle": 236.0, "CuttingEdgeHeight": "20 mm", "Diameter": "4 mm", "Length": "60 mm",
            "ShankDiameter": "4" }),
    ));
    let point = 2.0 / f64::to_radians(59.5).tan();
    assert_outline(
        &drill,
        &[([2.0, point], true), ([2.0, 20.0], true), ([2.0, 60.0], false), ([0.0, 60.0], false)],
    );
    assert_eq!(notes(&drill), [Note::Unstated("tip angle", "taken: 119".to_owned())]);
    for (diameter, neck) in [("5 mm", 3.0), ("2 mm", 1.2)] {
        let mill = read(&bit(
            "thread-mill",
            &json!({ "Crest": "0.1 mm", "Diameter": diameter, "Length": "50 mm", "ShankDiameter": "6 mm",
                "cuttingAngle": "60" }),
        ));
        let taken = |what, value: f64| Note::Unstated(what, format!("taken: {value}"));
        assert_eq!(notes(&mill), [taken("neck diameter", neck), taken("length of the neck", 20.0)]);
        let neck_end = |(at, cuts): &([f64; 2], bool)| *at == [neck / 2.0, 20.0] && !cuts;
        assert!(outline(&mill).iter().any(neck_end), "{:?}", outline(&mill));
    }
}

/// A cone from a tip, whose whole angle is stated.
#[test]
fn chamfer_mills_of_an_add_on_are_cones() {
    let mill = read(&bit(
        "_fusion_chamfer_mill",
        &json!({ "CuttingEdgeHeight": "30,5 mm", "Diameter": "8,0 mm", "Length": "60,0 mm",
            "NeckLength": "30,5 mm", "ShankDiameter": "8,0 mm", "TipAngle": "15,0 deg", "TipDiameter": "0,2 mm" }),
    ));
    let cone = 3.9 / f64::to_radians(7.5).tan();
    let expected = [
        ([0.1, 0.0], true),
        ([4.0, cone], true),
        ([4.0, 30.5], true),
        ([4.0, 60.0], false),
        ([0.0, 60.0], false),
    ];
    assert_outline(&mill, &expected);
}

/// A library can list one file many times.
#[test]
fn no_bit_is_read_beyond_the_limit_of_their_lengths() {
    let folder = tempfile::tempdir().expect("a folder");
    // A sparse file takes no space on the disk.
    let long = fs::File::create(folder.path().join("long.fctb"));
    long.and_then(|file| file.set_len(40 << 20)).expect("a long file");
    let tools = vec![json!({ "nr": 1, "path": "long.fctb" }); 6];
    let list = folder.path().join("l.fctl");
    fs::write(&list, json!({ "tools": tools }).to_string()).expect("written");
    let library = Library::read(&list).expect("a library");
    assert_eq!((library.listed_files().len(), library.skipped().len()), (2, 6));
    let last = &library.skipped()[5].reason;
    assert!(last.contains("longer than 67108864 bytes"), "{last}");
}
