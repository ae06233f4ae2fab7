//! Sweeps and maps: their output, their files and their error messages.

use super::{Tube, object, refused};
use crate::bench::{stderr, stdout, touchoff};
use serde_json::Value;
use touchoff_postures::PostureMap;

#[test]
fn a_sweep_fills_a_map_that_becomes_a_program_without_findings() {
    let tube = Tube::new();
    let told = object(&tube.sweep("D2Ball,BallEr16", &["--json"]));
    assert_eq!((&told["triangles"], &told["directions"]), (&384.into(), &80.into()), "{told}");
    assert_eq!(told["postures"]["total"], 384 * 80 * 2);
    assert_eq!(
        told["triangles_reached"], 384,
        "a ball of 1 mm comes everywhere in a tube of 12: {told}"
    );
    let [slim, stout] = [0, 1].map(|k: usize| &told["tools"][k]);
    assert_eq!(
        (&slim["triangles_reached"], &slim["stick_out"]),
        (&384.into(), &Value::Null),
        "{told}"
    );
    // The stout tool sticks 30 mm out of its nut, of which 18 mm cut.
    assert_eq!(
        (&stout["triangles_reached"], &stout["stick_out"][0]),
        (&384.into(), &18.0.into()),
        "{told}"
    );

    // Nothing is done twice, and the summary is the same.
    let again = object(&tube.sweep("D2Ball,BallEr16", &["--json"]));
    assert_eq!(
        (&again["earlier_batches"], &again["postures"]["total"]),
        (&again["batches"], &0.into())
    );
    assert_eq!(
        (&again["tools"], &again["area_fraction_reached"]),
        (&told["tools"], &told["area_fraction_reached"])
    );

    let to: Vec<String> =
        ["m.csv", "m.json", "m.ply", "m.png"].iter().map(|name| tube.bench.place(name)).collect();
    let shown = tube
        .bench
        .touchoff("map tube.postures --part tube.stl -o m.csv -o m.json -o m.ply -o m.png");
    assert!(stdout(&shown).contains("384 of 384 triangles have a posture"), "{}", stderr(&shown));
    let csv = std::fs::read_to_string(&to[0]).expect("a table");
    assert!(csv.lines().count() > 384, "{csv}");
    let json: Value =
        serde_json::from_slice(&std::fs::read(&to[1]).expect("a file")).expect("JSON");
    assert_eq!(json["rows"].as_array().expect("rows").len(), 384);
    assert!(std::fs::read(&to[2]).expect("a file").starts_with(b"ply"));
    assert!(std::fs::read(&to[3]).expect("a file").starts_with(b"\x89PNG"));

    for name in ["tube.apt", "tube.csv"] {
        let led = object(&tube.bench.touchoff(&format!(
            "path tube.postures --part tube.stl --tool D2Ball --plane-normal 0,0,1 --stepover 3 -o {name} --json"
        )));
        assert!(led["contact_points"].as_u64() > Some(40), "{led}");
        let checked = tube.bench.touchoff(&format!(
            "verify --part tube.stl --unit mm --tool D2Ball --program {name} --tolerance 0.05"
        ));
        assert_eq!(checked.status.code(), Some(0), "{}{}", stdout(&checked), stderr(&checked));
    }
}

#[test]
fn a_sweep_without_a_map_has_the_same_summary() {
    let tube = Tube::new();
    let kept = object(&tube.sweep("D2Ball", &["--json"]));
    let all = ["sweep", "--part", &tube.part, "--unit", "mm", "--tool", "D2Ball", "--json"];
    let told =
        object(&touchoff(&[&all[..], &["--directions", "40", "--tolerance", "0.05"]].concat()));
    for key in ["triangles_reached", "area_fraction_reached", "tools", "postures"] {
        assert_eq!(kept[key], told[key], "{key}");
    }
    let words = touchoff(&[&all[..7], &["--directions", "10"]].concat());
    assert!(stdout(&words).contains("proved acceptable"), "{}", stdout(&words));
}

#[test]
fn a_map_of_something_else_is_refused() {
    let tube = Tube::new();
    assert!(tube.sweep("D2Ball", &[]).status.success());
    let rows = || {
        let map = PostureMap::read(&tube.map).expect("a map");
        let rows = map.rows().expect("rows");
        rows.collect::<Result<Vec<_>, _>>().expect("rows")
    };
    let before = rows();
    refused(&tube.sweep("BallEr16", &[]), &["tools", "D2Ball", "BallEr16"]);
    refused(&tube.sweep("D2Ball", &["--min-niceness", "0.5"]), &["rules"]);
    let block = tube.bench.place("block.stl");
    let other =
        ["sweep", "--part", &block, "--unit", "mm", "--tool", "D2Ball", "--directions", "40"];
    let more = ["--tolerance", "0.05", "--output", &tube.map];
    refused(&touchoff(&[&other[..], &more].concat()), &["another part"]);
    let picture = tube.bench.place("m.png");
    refused(&touchoff(&["map", &tube.map, "-o", &picture]), &["--part"]);
    refused(&touchoff(&["map", &tube.map, "--part", &block, "-o", &picture]), &["another part"]);
    refused(&touchoff(&["map", &tube.map, "-o", &tube.bench.place("m.pdf")]), &[".csv", "m.pdf"]);
    let path = |tool: &str, to: &str| {
        let part = format!("--part tube.stl --tool {tool} --stepover 3");
        tube.bench.touchoff(&format!("path tube.postures {part} -o {to}"))
    };
    refused(&path("BallEr16", "p.apt"), &["not swept with this `BallEr16`"]);
    refused(&path("D2Ball", "p.txt"), &[".apt", "p.txt"]);
    assert!(rows() == before, "a refusal changes nothing");
}

#[test]
fn a_map_that_is_damaged_or_in_use_is_refused() {
    let tube = Tube::new();
    assert!(tube.sweep("D2Ball", &[]).status.success());
    let open = PostureMap::resume(&tube.map).expect("a map");
    refused(&tube.sweep("D2Ball", &[]), &["another process"]);
    // Reading it is still possible.
    let shown = touchoff(&["map", &tube.map]);
    assert!(stdout(&shown).contains("384 of 384 triangles"), "{}", stderr(&shown));
    drop(open);
    assert!(tube.sweep("D2Ball", &[]).status.success());
    std::fs::write(&tube.map, "not a map").expect("a writable file");
    refused(&tube.sweep("D2Ball", &[]), &["tube.postures"]);
    let missing = tube.bench.place("missing.postures");
    refused(&touchoff(&["map", &missing]), &["missing.postures"]);
}

#[test]
fn invalid_options_are_refused() {
    let tube = Tube::new();
    refused(&tube.sweep("D2Bal", &[]), &["did you mean `D2Ball`"]);
    refused(&tube.sweep("D2Ball", &["--allow", "nut=0.1"]), &["`nut`", "`shank`"]);
    let cubes = tube.sweep("Block", &[]);
    refused(&cubes, &["Block"]);
    let wrong = tube.sweep("D2Ball", &["--tolerance", "0"]);
    assert_eq!(wrong.status.code(), Some(2), "{}", stderr(&wrong));
}

#[test]
fn a_program_that_cannot_be_written_leaves_the_file_as_it_was() {
    let tube = Tube::new();
    let all = ["sweep", "--part", &tube.part, "--unit", "m", "--tool", "D2Ball"];
    let more = ["--directions", "5", "--tolerance", "0.001", "--output", &tube.map];
    assert!(touchoff(&[&all[..], &more].concat()).status.success());
    let program = tube.bench.place("kept.apt");
    std::fs::write(&program, "GOTO/1,2,3\n").expect("a writable folder");
    let path = ["path", &tube.map, "--part", &tube.part, "--tool", "D2Ball", "--stepover", "1"];
    refused(&touchoff(&[&path[..], &["-o", &program]].concat()), &["no word for m", "table"]);
    assert_eq!(std::fs::read_to_string(&program).expect("a file"), "GOTO/1,2,3\n");
}
