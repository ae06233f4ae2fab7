//! Sweeps, maps and paths: their output, their files and their error messages.

use crate::bench::{Bench, stderr, stdout, touchoff};
use resvg::tiny_skia::{Pixmap, PremultipliedColorU8};
use serde_json::Value;
use std::process::Output;
use touchoff::Unit;
use touchoff::mesh::shapes;
use touchoff::postures::PostureMap;

/// A tube, and the file for its map.
struct Tube {
    bench: Bench,
    part: String,
    map: String,
}

impl Tube {
    fn new() -> Tube {
        let bench = Bench::new();
        let tube = shapes::tube(6.0, 9.0, 12.0, 24, 3, Unit::Millimetre).expect("a tube");
        let mut stl = Vec::new();
        tube.write_stl(&mut stl).expect("memory");
        let place = |name: &str| bench.folder.path().join(name).display().to_string();
        let (part, map) = (place("tube.stl"), place("tube.postures"));
        std::fs::write(&part, stl).expect("a writable folder");
        Tube { bench, part, map }
    }

    fn place(&self, name: &str) -> String {
        self.bench.folder.path().join(name).display().to_string()
    }

    fn sweep(&self, tools: &str, more: &[&str]) -> Output {
        let all =
            ["sweep", "--part", &self.part, "--unit", "mm", "--tool", tools, "--directions", "40"];
        touchoff(&[&all[..], &["--tolerance", "0.05", "--output", &self.map], more].concat())
    }
}

fn object(output: &Output) -> Value {
    assert!(output.status.success(), "{}", stderr(output));
    serde_json::from_str(&stdout(output)).expect("JSON")
}

fn refused(output: &Output, words: &[&str]) {
    let said = stderr(output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    for word in words {
        assert!(said.contains(word), "`{word}` is not said: {said}");
    }
}

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
        ["m.csv", "m.json", "m.ply", "m.png"].iter().map(|name| tube.place(name)).collect();
    let shown = touchoff(&[
        "map", &tube.map, "--part", &tube.part, "-o", &to[0], "-o", &to[1], "-o", &to[2], "-o",
        &to[3],
    ]);
    assert!(stdout(&shown).contains("384 of 384 triangles have a posture"), "{}", stderr(&shown));
    let csv = std::fs::read_to_string(&to[0]).expect("a table");
    assert!(csv.lines().count() > 384, "{csv}");
    let json: Value =
        serde_json::from_slice(&std::fs::read(&to[1]).expect("a file")).expect("JSON");
    assert_eq!(json["rows"].as_array().expect("rows").len(), 384);
    assert!(std::fs::read(&to[2]).expect("a file").starts_with(b"ply"));
    assert!(std::fs::read(&to[3]).expect("a file").starts_with(b"\x89PNG"));

    for name in ["tube.apt", "tube.csv"] {
        let program = tube.place(name);
        let led = touchoff(&[
            "path",
            &tube.map,
            "--part",
            &tube.part,
            "--tool",
            "D2Ball",
            "--plane-normal",
            "0,0,1",
            "--stepover",
            "3",
            "-o",
            &program,
            "--json",
        ]);
        let led = object(&led);
        assert!(led["contact_points"].as_u64() > Some(40), "{led}");
        let checked = touchoff(&[
            "verify",
            "--part",
            &tube.part,
            "--unit",
            "mm",
            "--tool",
            "D2Ball",
            "--program",
            &program,
            "--tolerance",
            "0.05",
        ]);
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
    let block = tube.bench.folder.path().join("block.stl").display().to_string();
    let other =
        ["sweep", "--part", &block, "--unit", "mm", "--tool", "D2Ball", "--directions", "40"];
    let more = ["--tolerance", "0.05", "--output", &tube.map];
    refused(&touchoff(&[&other[..], &more].concat()), &["another part"]);
    let picture = tube.place("m.png");
    refused(&touchoff(&["map", &tube.map, "-o", &picture]), &["--part"]);
    refused(&touchoff(&["map", &tube.map, "--part", &block, "-o", &picture]), &["another part"]);
    refused(&touchoff(&["map", &tube.map, "-o", &tube.place("m.pdf")]), &[".csv", "m.pdf"]);
    let program = tube.place("p.apt");
    let path = |tool: &str, to: &str| {
        touchoff(&[
            "path",
            &tube.map,
            "--part",
            &tube.part,
            "--tool",
            tool,
            "--stepover",
            "3",
            "-o",
            to,
        ])
    };
    refused(&path("BallEr16", &program), &["not swept with this `BallEr16`"]);
    refused(&path("D2Ball", &tube.place("p.txt")), &[".apt", "p.txt"]);
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
    let missing = tube.place("missing.postures");
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
    let program = tube.place("kept.apt");
    std::fs::write(&program, "GOTO/1,2,3\n").expect("a writable folder");
    let path = ["path", &tube.map, "--part", &tube.part, "--tool", "D2Ball", "--stepover", "1"];
    refused(&touchoff(&[&path[..], &["-o", &program]].concat()), &["no word for m", "table"]);
    assert_eq!(std::fs::read_to_string(&program).expect("a file"), "GOTO/1,2,3\n");
}

/// Plans a path over the tube with the ball, in planes of a normal.
fn path_across(normal: &str, tube: &Tube, output: &str, more: &[&str]) -> Output {
    let all = ["path", &tube.map, "--part", &tube.part, "--tool", "D2Ball"];
    let pattern = ["--plane-normal", normal, "--stepover", "3", "-o", output, "--json"];
    touchoff(&[&all[..], &pattern, more].concat())
}

/// Plans a path over the tube with the ball, in horizontal planes.
fn path(tube: &Tube, output: &str, more: &[&str]) -> Output {
    path_across("0,0,1", tube, output, more)
}

fn verified(tube: &Tube, program: &str, more: &[&str]) {
    let all = ["verify", "--part", &tube.part, "--unit", "mm", "--tool", "D2Ball"];
    let more =
        [&["--program", program, "--tolerance", "0.05", "--allow", "shank=0.00625"], more].concat();
    let checked = touchoff(&[&all[..], &more].concat());
    assert_eq!(checked.status.code(), Some(0), "{}{}", stdout(&checked), stderr(&checked));
}

/// Checks that a picture shows points of the colours of the reasons for which a path leaves points out.
fn assert_picture_has_points(file: &str, summary: &Value) {
    let picture = Pixmap::load_png(file).expect("a picture");
    let keys = [("points_not_reached", [204, 60, 50]), ("points_without_motion", [40, 90, 200])];
    // The legend shows each colour too, in its lowest part.
    let above_legend = (picture.width() * (picture.height() - 120)) as usize;
    for (key, [r, g, b]) in keys {
        let is_point =
            |pixel: &&PremultipliedColorU8| (pixel.red(), pixel.green(), pixel.blue()) == (r, g, b);
        let pixels = picture.pixels()[..above_legend].iter().filter(is_point).count();
        let count = summary[key].as_u64().expect("a number");
        assert_eq!(pixels > 0, count > 0, "{key}: {count} points, {pixels} pixels");
    }
    assert!(summary["points_not_reached"].as_u64() > Some(0), "{summary}");
}

#[test]
fn a_path_states_tool_feed_and_spindle_and_keeps_to_a_tilt() {
    let tube = Tube::new();
    assert!(tube.sweep("D2Ball", &[]).status.success());
    let output = tube.place("words.apt");
    let words = ["--tool-number", "7", "--feed", "600.5", "--spindle", "8000"];
    let free = object(&path(&tube, &output, &words));
    let text = std::fs::read_to_string(&output).expect("a program");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(
        lines[..7],
        [
            "PARTNO/tube",
            "UNITS/MM",
            "MULTAX/ON",
            "LOADTL/7",
            "CUTTER/2,1",
            "SPINDL/8000,CLW",
            "FEDRAT/600.5,MMPM"
        ]
    );
    let longest = |range: std::ops::Range<usize>| {
        let numbers = lines.iter().filter_map(|line| line.strip_prefix("GOTO/"));
        let numbers =
            numbers.flat_map(|row| row.split(',').enumerate().filter(|(k, _)| range.contains(k)));
        numbers.map(|(_, number)| number.split_once('.').map_or(0, |(_, d)| d.len())).max()
    };
    assert_eq!((longest(0..3), longest(3..6)), (Some(5), Some(9)), "{text}");
    verified(&tube, &output, &[]);
    let sum = |told: &Value| {
        told["points_not_reached"].as_u64().expect("a number")
            + told["points_without_motion"].as_u64().expect("a number")
    };
    assert_eq!(free["points_left_out"].as_u64(), Some(sum(&free)), "{free}");
    let lowest = |text: &str| {
        let program = touchoff::Program::parse(text, "words.apt").expect("a program");
        program.locations.iter().map(|location| location.pose.axis().z).fold(1.0, f64::min)
    };
    let limit = 30f64.to_radians().cos();
    assert!(lowest(&text) < limit - 0.1, "without a limit the axis tilts more");

    let tilted = object(&path(&tube, &output, &["--max-tilt", "30"]));
    assert_eq!(tilted["points_left_out"].as_u64(), Some(sum(&tilted)), "{tilted}");
    let text = std::fs::read_to_string(&output).expect("a program");
    assert!(lowest(&text) >= limit - 1e-9, "{}", lowest(&text));
    assert!(!["LOADTL", "SPINDL", "FEDRAT"].iter().any(|word| text.contains(word)), "{text}");
    verified(&tube, &output, &[]);
    for angle in ["0", "-5", "180.5", "nan"] {
        let refused = path(&tube, &output, &["--max-tilt", angle]);
        assert_eq!(refused.status.code(), Some(2), "{angle}: {}", stderr(&refused));
    }
    let table = path(&tube, &tube.place("words.csv"), &words);
    assert_eq!(table.status.code(), Some(2), "{}", stderr(&table));
    assert!(stderr(&table).contains("a table has no place"), "{}", stderr(&table));
}

/// Across the tube, the lines pass its lower face, which no steep axis reaches.
#[test]
fn a_picture_shows_the_points_left_out() {
    let tube = Tube::new();
    assert!(tube.sweep("D2Ball", &[]).status.success());
    let picture = tube.place("left.png");
    let more = ["--max-tilt", "60", "--picture", &picture];
    let summary = object(&path_across("1,0,0", &tube, &tube.place("across.apt"), &more));
    assert_picture_has_points(&picture, &summary);
}

#[test]
fn a_path_that_rounding_ruins_is_not_written() {
    let tube = Tube::new();
    assert!(tube.sweep("D2Ball", &[]).status.success());
    let output = tube.place("kept.apt");
    std::fs::write(&output, "kept").expect("a writable folder");
    // Tips are rounded to 1e-5 mm, so that the ball is up to 5e-6 mm deep where it touches a plane.
    let fine = ["--tolerance", "1e-6", "--max-tilt", "90", "--forward-step", "12"];
    refused(
        &path(&tube, &output, &fine),
        &["kept.apt:", "as it would be written", "raise `--tolerance`"],
    );
    assert_eq!(std::fs::read_to_string(&output).expect("a file"), "kept");
}

#[test]
fn a_path_for_a_machine_is_proved_on_its_joints() {
    let tube = Tube::new();
    assert!(tube.sweep("D2Ball", &[]).status.success());
    let output = tube.place("tube.nc");
    let words = ["--tool-number", "3", "--feed", "500", "--spindle", "9000", "--max-tilt", "90"];
    for machine in ["A-C trunnion", "A-C fork head"] {
        let told = object(&path(&tube, &output, &[&words[..], &["--machine", machine]].concat()));
        let text = std::fs::read_to_string(&output).expect("a program");
        assert!(text.starts_with("G21 G90 G94 G54\nT3 M6\nS9000 M3\nG43.4 H3\nG0 X"), "{text}");
        assert!(text.ends_with("\nM30\n") && text.contains(" F500.\n"), "{text}");
        let motions =
            text.lines().filter(|line| line.starts_with("G0 X") || line.starts_with("G1 X"));
        assert_eq!(told["locations"].as_u64(), Some(motions.count() as u64), "{told}");
        assert!(told["contact_points"].as_u64() > Some(20), "{told}");
        verified(&tube, &output, &["--machine", machine]);
        println!("{machine}: {told}");
    }
    // Around the bore C comes to a limit, and large turns of the axis need cutter locations between.
    let across = |normal: &str, more: &[&str]| {
        object(&path_across(normal, &tube, &output, &[&words[..6], more].concat()))
    };
    let limited = include_str!("../../../runtime/src/machine/machines/a-c-trunnion.toml")
        .replace("letter = \"C\"", "letter = \"C\"\nlimits = [-190, 190]");
    let machine = tube.bench.write("limited.toml", &limited);
    let limited = across("0,0,1", &["--machine", &machine, "--max-tilt", "90"]);
    println!("at a limit: {limited}");
    verified(&tube, &output, &["--machine", &machine]);
    let coarse = ["--forward-step", "6", "--tolerance", "0.001", "--max-tilt", "60"];
    let coarse = across("1,0,0", &[&coarse[..], &["--machine", "B-C table-table"]].concat());
    println!("coarse: {coarse}");
    verified(&tube, &output, &["--machine", "B-C table-table"]);
    let inserted = [&limited, &coarse].map(|told| told["inserted_locations"].as_u64());
    assert!(inserted.iter().all(|count| *count > Some(0)), "{inserted:?}");
    std::fs::remove_file(&output).expect("the program");

    let more = |more: &[&'static str]| path(&tube, &output, &[&words[..], more].concat());
    refused(
        &more(&["--machine", "3-axis"]),
        &["`3-axis` does not reach cutter location", "the axis"],
    );
    let far = ["--machine", "A-C trunnion", "--work-offset", "0,0,-2000", "--tool-length", "100"];
    refused(&more(&far), &["`A-C trunnion` does not reach cutter location", "outside its limits"]);
    assert!(!std::path::Path::new(&output).exists(), "a refusal writes nothing");
    let near = ["--machine", "A-C trunnion", "--work-offset", "0,0,-480", "--tool-length", "100"];
    object(&more(&near));
    std::fs::remove_file(&output).expect("the program");
    for (wrong, words) in [
        (path(&tube, &output, &["--feed", "5", "--tool-number", "1"]), "name one with `--machine`"),
        (path(&tube, &output, &["--machine", "3-axis"]), "give `--tool-number` and `--feed`"),
        (path(&tube, &tube.place("t.apt"), &["--machine", "3-axis"]), "ends in `.nc`"),
        (more(&["--machine", "lathe"]), "`lathe` is no machine"),
        (more(&["--machine", "3-axis", "--work-offset", "0,0,0"]), "--tool-length"),
    ] {
        assert_eq!(wrong.status.code(), Some(2), "{}", stderr(&wrong));
        assert!(stderr(&wrong).contains(words), "{words}: {}", stderr(&wrong));
    }
    assert!(!std::path::Path::new(&output).exists(), "a refusal writes nothing");
}
