//! A tool library of every format, with every type that can be read.

use serde_json::{Map, Value, json};
use std::ffi::OsStr;
use std::io::Write as _;
use std::path::Path;
use touchoff_import::{FindError, ImportedTool, Library, find_in_folder, write_numbers};
use touchoff_tests::fusion;

/// A file of a tool library.
pub(crate) struct LibraryFile {
    /// Its name; the ending gives the format.
    pub(crate) name: &'static str,
    /// Its content.
    pub(crate) text: String,
}

/// Returns a file of each format.
pub(crate) fn files() -> Vec<LibraryFile> {
    let file = |name, text| LibraryFile { name, text };
    vec![
        file("fusion.json", json!({ "version": 33, "data": fusion::tools() }).to_string()),
        file("kiri.json", kiri().to_string()),
        file("camotics.json", camotics().to_string()),
        file("bits.fctb", bit("endmill", &["Diameter=6 mm", "ShankDiameter=8 mm"]).to_string()),
        file("holder.fcholder", fcholder().to_string()),
        file("hsm.hsmlib", HSM.to_owned()),
        file("cutters.apt", APT.to_owned()),
        file("table.tbl", "T1 P1 Z47.5 D6 ; ball\nT2 P2 Z40. D8.2 ; drill\n".to_owned()),
    ]
}

/// Returns the tools of Kiri:Moto, one of each type.
pub(crate) fn kiri() -> Value {
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
pub(crate) fn camotics() -> Value {
    let tool = |units: &str, shape: &str| {
        json!({ "units": units, "shape": shape, "length": 30, "diameter": 6, "snub_diameter": 2,
            "description": shape })
    };
    json!({ "1": tool("metric", "cylindrical"), "2": tool("metric", "conical"),
        "3": tool("imperial", "ballnose"), "4": tool("imperial", "snubnose") })
}

/// Returns a FreeCAD bit of a shape with these parameters, written `Name=value unit`, beside the usual ones.
pub(crate) fn bit(shape: &str, more: &[&str]) -> Value {
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
pub(crate) fn bits() -> Vec<Value> {
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

/// A program selects a tool by its number alone, of which none was left out.
#[test]
fn programs_select_tools_by_their_numbers() {
    let tool = |kind: &str, title: &str, number: u32| {
        format!(
            "{{\"type\": \"{kind}\", \"description\": \"{title}\", \"unit\": \"millimeters\", \"geometry\": {{\"DC\": 10, \"LCF\": 20, \
             \"LB\": 40, \"OAL\": 70, \"SFDM\": 10}}, \"post-process\": {{\"number\": {number}}}}}"
        )
    };
    let found = |tools: &[String]| {
        let text = format!("{{\"data\": [{}], \"version\": 2}}", tools.join(", "));
        let library = Library::parse(Path::new("a.json"), text.as_bytes()).expect("a library");
        library.find("T1").iter().map(|tool| tool.entry.title.clone()).collect::<Vec<_>>()
    };
    let end_mill = |title: &str, number| tool("flat end mill", title, number);
    assert_eq!(found(&[end_mill("wide", 1), end_mill("T1", 5)]), ["wide"]);
    assert_eq!(found(&[end_mill("T1", 5)]), [""; 0]);
    assert_eq!(found(&[end_mill("slim", 1), tool("form mill", "wide", 1)]), [""; 0]);
    assert_eq!(
        found(&[end_mill("T1", 0).replace("\"number\": 0", ""), tool("form mill", "wide", 1)]),
        [""; 0]
    );
    // So are those of an APT library, and of a folder that was written from one.
    let text = "UNITS/MM\nLOADTL/1\nCUTTER/6,3,0,3,0,0,30\nLOADTL/1\nTLDATA/BARREL,6\nLOADTL/2\nCUTTER/8,4,0,4,0,0,30\nFINI\n";
    let library = Library::parse(Path::new("a.cls"), text.as_bytes()).expect("a library");
    let count = |wanted: &str| library.find(wanted).len();
    assert_eq!((library.skipped()[0].number, count("T1"), count("T2")), (Some(1), 0, 1));
    let folder = tempfile::tempdir().expect("a folder");
    let tools: Vec<&ImportedTool> = library.tools().iter().collect();
    tools.iter().for_each(|tool| drop(tool.write_to(folder.path()).expect("written")));
    write_numbers(folder.path(), &tools, &[1]).expect("written");
    let found = |name: &str| find_in_folder(folder.path(), OsStr::new(name));
    assert!(matches!(found("T1"), Err(FindError::LeftOut { .. })));
    assert!(found("T2").is_ok_and(|file| file.is_file()));
    // Another library does not have it instead, nor does one of which no tool is written forget it.
    write_numbers(folder.path(), &tools, &[]).expect("written");
    assert!(matches!(found("T1"), Err(FindError::LeftOut { .. })));
    write_numbers(folder.path(), &[], &[2]).expect("written");
    assert!(matches!(found("T2"), Err(FindError::LeftOut { .. })));
    std::fs::remove_file(folder.path().join("tools.toml")).expect("removed");
    write_numbers(folder.path(), &tools, &[]).expect("written");
    // Names of files may have characters that macOS divides.
    std::fs::write(folder.path().join("tools.toml"), "T7 = [\"fra\u{308}ser.tool\"]\n")
        .expect("written");
    for _ in 0..2 {
        write_numbers(folder.path(), &tools, &[]).expect("the list can be read");
    }
    assert!(found("T1").is_ok_and(|file| file.is_file()));
}

/// Notes of what a program can hit that the imported tool does not are told from others; so is the hand.
#[test]
fn doubts_and_hands_of_tools_are_told() {
    let of = |name: &str, text: &str| {
        let library = Library::parse(Path::new(name), text.as_bytes()).expect("a library");
        let entry = &library.tools()[0].entry;
        (entry.left_handed, entry.doubts())
    };
    let hsm = |motion: &str, holder: &str| {
        let text = format!(
            "<tool-library><tool type=\"flat end mill\" unit=\"millimeters\"><nc number=\"1\"/>{motion}<body diameter=\"10\" \
             flute-length=\"20\" body-length=\"40\" overall-length=\"70\" shaft-diameter=\"10\"/>{holder}</tool></tool-library>"
        );
        of("l.hsmlib", &text)
    };
    assert_eq!(hsm("<motion clockwise=\"yes\"/>", ""), (None, Vec::new()));
    assert_eq!(hsm("<motion clockwise=\"no\"/>", ""), (Some(true), Vec::new()));
    for holder in ["<holder guid=\"h\"/>", "<holder guid=\"h\"></holder>"] {
        assert_eq!(hsm("", holder).1.len(), 1, "{holder}");
    }
    let fusion = |more: &str| {
        let text = format!(
            "{{\"data\": [{{\"type\": \"face mill\", \"unit\": \"millimeters\", \"geometry\": {{\"DC\": 40, \"LCF\": 10, \"LB\": 40, \
             \"OAL\": 70, \"SFDM\": 16{more}}}}}], \"version\": 2}}"
        );
        of("l.json", &text)
    };
    assert_eq!(fusion(", \"TA\": 45, \"DCX\": 50, \"HAND\": true"), (Some(false), Vec::new()));
    assert_eq!(fusion(", \"TA\": 0, \"DCX\": 40, \"HAND\": false"), (Some(true), Vec::new()));
    assert_eq!(fusion("}, \"shaft\": {\"description\": \"x\"").1.len(), 1);
    assert_eq!(fusion("}, \"expressions\": {\"tool_diameter\": \"44 mm\"").1.len(), 1);
    assert_eq!(fusion(", \"TA\": 0, \"DCX\": 50").1.len(), 1);
    let angle = |angle: &str| {
        fusion(&format!(
            ", \"TA\": 45, \"DCX\": 50}}, \"expressions\": {{\"tool_taperAngle\": \"{angle}\""
        ))
        .1
        .len()
    };
    assert_eq!([angle("45 degrees"), angle("30 deg")], [0, 1]);
    let tap = |kind: &str, hand: bool| {
        let text = format!(
            "{{\"data\": [{{\"type\": \"{kind}\", \"unit\": \"millimeters\", \"geometry\": {{\"DC\": 6, \"LCF\": 20, \"LB\": 40, \
             \"OAL\": 70, \"SFDM\": 6, \"TP\": 1, \"SIG\": 90, \"tip-diameter\": 0, \"HAND\": {hand}}}}}], \"version\": 2}}"
        );
        of("l.json", &text).0
    };
    assert_eq!(tap("form tap left hand", true), Some(true));
    assert_eq!(tap("form tap right hand", false), Some(false));
    let gauge = |assembly: u32| {
        fusion(&format!(
            ", \"assemblyGaugeLength\": {assembly}}}, \"holder\": {{\"unit\": \"millimeters\", \"gaugeLength\": 40, \"segments\": \
             [{{\"height\": 40, \"lower-diameter\": 30, \"upper-diameter\": 30}}]}}, \"x\": {{\"y\": 1"
        ))
    };
    assert_eq!([60, 80, 100].map(|length| gauge(length).1.len()), [1, 0, 0]);
    // That of the holder can be a text with a unit, or follows from its segments.
    let holder = |gauge: &str| {
        fusion(&format!(
            ", \"assemblyGaugeLength\": 60}}, \"holder\": {{\"unit\": \"millimeters\"{gauge}, \"segments\": \
             [{{\"height\": 40, \"lower-diameter\": 30, \"upper-diameter\": 30}}]}}, \"x\": {{\"y\": 1"
        ))
        .1
        .len()
    };
    let gauges = ["", ", \"gaugeLength\": \"40 mm\"", ", \"gaugeLength\": \"2 cm\""];
    assert_eq!(gauges.map(holder), [1, 1, 0]);
    let assembly = "<holder guid=\"h\"><section diameter=\"40\" length=\"30\"/></holder>";
    assert_eq!(hsm("", assembly).1.len(), 0);
    let short = hsm("<body assembly-gauge-length=\"60\"/>", assembly);
    assert_eq!(short.1.len(), 1, "{short:?}");
    // The statement that gives the narrower tool can be the wrong one of two.
    let ball = |radius: u32| {
        let text = format!(
            "{{\"data\": [{{\"type\": \"ball end mill\", \"unit\": \"millimeters\", \"geometry\": {{\"DC\": 6, \"RE\": {radius}, \
             \"LCF\": 20, \"OAL\": 70, \"SFDM\": 6}}}}]}}"
        );
        of("l.json", &text).1.len()
    };
    assert_eq!([2, 3, 5].map(ball), [0, 0, 1]);
    let chamfer = |height: &str| {
        let text = format!(
            "{{\"shape\": \"chamfer.fcstd\", \"parameter\": {{\"CuttingEdgeHeight\": \"{height}\", \"Length\": \"80 mm\", \
             \"ShankDiameter\": \"6 mm\", \"Diameter\": \"10 mm\", \"CuttingEdgeAngle\": \"60 deg\", \"TipDiameter\": \"1 mm\"}}}}"
        );
        of("c.fctb", &text).1.len()
    };
    assert_eq!(["5 mm", "7.794 mm", "9 mm"].map(chamfer), [1, 0, 0]);
}

/// One of two libraries is dropped otherwise.
#[test]
fn an_archive_has_one_library() {
    let packed = |names: &[&str]| {
        let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
        for name in names {
            let options = zip::write::SimpleFileOptions::default();
            archive.start_file(*name, options).expect("an entry");
            archive.write_all(br#"{"data": []}"#).expect("an archive");
        }
        let content = archive.finish().expect("an archive").into_inner();
        Library::parse(Path::new("l.tools"), &content)
    };
    assert!(packed(&["tools.json", "picture.png"]).is_ok());
    let error = packed(&["a.json", "b.json"]).expect_err("two libraries").to_string();
    assert!(error.contains("2 `.json` files"), "{error}");
    // The second name is changed to the first one, which writers do not do.
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for name in ["tools.json", "tuuls.json"] {
        let options = zip::write::SimpleFileOptions::default();
        archive.start_file(name, options).expect("an entry");
        archive.write_all(br#"{"data": []}"#).expect("an archive");
    }
    let mut content = archive.finish().expect("an archive").into_inner();
    while let Some(at) = content.windows(5).position(|bytes| bytes == b"tuuls") {
        content[at..at + 5].copy_from_slice(b"tools");
    }
    let error = Library::parse(Path::new("l.tools"), &content).expect_err("one name").to_string();
    assert!(error.contains("two files of one name"), "{error}");
}
