//! JSON keys: `docs/cli.md` has all of them.

use crate::bench::{Bench, stderr, stdout, touchoff};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

/// Collects the keys of a value and of all values in it.
fn collect(value: &Value, keys: &mut BTreeSet<String>) {
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                keys.insert(key.clone());
                // Its keys are the names of surfaces.
                if key != "surface_depths" {
                    collect(value, keys);
                }
            }
        }
        Value::Array(list) => list.iter().for_each(|value| collect(value, keys)),
        _ => (),
    }
}

#[test]
fn all_keys_are_documented() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/cli.md");
    let page = std::fs::read_to_string(page).expect("the page");
    let bench = Bench::new();
    let (part, map, path) =
        (bench.place("block.stl"), bench.place("map.postures"), bench.place("path.apt"));
    let gouge = "UNITS/MM\nFEDRAT/9,MMPM\nGOTO/-9,0,3,0,0,1\nGOTO/-9,0,-0.5,0,0,1\nGOTO/9,0,-0.5,0,0,1\nFINI\n";
    let program = bench.write("gouge.apt", gouge);
    let milled =
        bench.write("mill.nc", "G21 G90 G54 S900 M3\nG0 X-9. Y0. Z3.\nG1 X9. F100.\nM30\n");
    let library = bench.write("library.json", crate::import::LIBRARY);
    let solid = bench.write("solid.csv", "-4,0,-0.2,0,0,0,1\n4,0,-0.2,0,0,0,1\n");
    let tool = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tools-library/tools/fig_7_3.tool");
    let tool = tool.display().to_string();
    let lines = [
        format!("run PART --tool D2Ball --program {program} --certify 1e-3"),
        format!("verify PART --tool D2Ball --program {program} --allow shank=-9"),
        format!("verify PART --tool Block --program {solid}"),
        format!("verify PART --tool D2Ball --program {milled} --control generic"),
        "haptic PART --tool D2Ball --duration 0.05".to_owned(),
        format!("sweep PART --tool D2Ball --directions 20 --tolerance 0.05 -o {map}"),
        format!("map {map}"),
        format!("path {map} --part {part} --tool D2Ball --stepover 1 -o {path}"),
        format!("import {library} -o {}", bench.place("tools")),
        "tools".to_owned(),
        "tools show D2Ball".to_owned(),
        format!("check {tool}"),
        "explain T0201".to_owned(),
        format!("fmt --check {tool}"),
    ];
    let block = format!("--part {part} --unit mm");
    for line in lines {
        let line = format!("{line} --json").replace("PART", &block);
        let output = touchoff(&line.split(' ').collect::<Vec<_>>());
        let mut keys = BTreeSet::new();
        for row in stdout(&output).lines() {
            collect(&serde_json::from_str(row).expect("an object"), &mut keys);
        }
        assert!(!keys.is_empty(), "{line}: {}", stderr(&output));
        for key in keys {
            assert!(
                page.contains(&format!("`{key}`")),
                "`{key}` of `{line}` is not in docs/cli.md"
            );
        }
    }
}
