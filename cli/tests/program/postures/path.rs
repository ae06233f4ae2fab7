//! Paths: their files, pictures and error messages.

use super::{Tube, object, refused};
use crate::bench::{cuboid, objects, stderr, stdout, touchoff};
use nalgebra::Point3;
use resvg::tiny_skia::{Pixmap, PremultipliedColorU8};
use serde_json::Value;
use std::process::Output;
use touchoff::{Mesh, Unit};

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
    // G-code leaves the path of rapid traverse, and the frame of the part on a turned table, to the control.
    let mut control = Vec::new();
    if program.ends_with(".nc") {
        let rules = stdout(&touchoff(&["controls", "linuxcnc"])).replace("\"rs274ngc\"", "\"iso\"");
        control.extend(["--control".to_owned(), tube.bench.write("control.toml", &rules)]);
    }
    let control: Vec<&str> = control.iter().map(|word| &**word).collect();
    let checked = touchoff(&[&all[..], &more, &control].concat());
    assert_eq!(checked.status.code(), Some(0), "{}{}", stdout(&checked), stderr(&checked));
}

/// The axes of the built-in trunnion end at 120° from +z. Postures beyond them are not chosen, without `--max-tilt`.
#[test]
fn a_path_keeps_to_the_limits_of_the_machine_and_goes_home() {
    let tube = Tube::new();
    assert!(tube.sweep("D2Ball", &[]).status.success());
    let output = tube.bench.place("limits.nc");
    let words = ["--tool-number", "3", "--feed", "20", "--spindle", "9000"];
    let free = object(&path_across("1,0,0", &tube, &tube.bench.place("free.apt"), &[]));
    assert!(free["upside_down_locations"].as_u64() > Some(50), "{free}");
    let told = object(&path_across(
        "1,0,0",
        &tube,
        &output,
        &[&words[..], &["--machine", "A-C trunnion"]].concat(),
    ));
    assert!(told["contact_points"].as_u64() > Some(50), "{told}");
    verified(&tube, &output, &["--machine", "A-C trunnion"]);
    let text = std::fs::read_to_string(&output).expect("a program");
    let tilts =
        text.lines().flat_map(|line| line.split(' ')).filter_map(|word| word.strip_prefix('A'));
    let tilts: Vec<f64> = tilts.map(|angle| angle.parse().expect("an angle")).collect();
    let lowest = tilts.iter().copied().fold(0.0, f64::min);
    assert!(tilts.len() > 50 && (-120.0..-95.0).contains(&lowest), "{lowest} of {}", tilts.len());
    // With the place of the part known, the way home is proved as well.
    let job = format!(
        "part = {:?}\nunit = \"mm\"\nprogram = {output:?}\nmachine = \"A-C trunnion\"\ncontrol = {:?}\ntolerance = 0.05\n\
         [work_offsets]\nG54 = [0, 0, -480]\n[tool.3]\ntool = \"D2Ball\"\nlength = 100\nallow = {{ shank = 0.00625 }}\n",
        tube.part,
        tube.bench.place("control.toml"),
    );
    let checked = touchoff(&["verify", &tube.bench.write("job.toml", &job), "--json"]);
    assert_eq!(checked.status.code(), Some(0), "{}{}", stdout(&checked), stderr(&checked));
    assert!(!stdout(&checked).contains("reference position"), "{}", stdout(&checked));
}

/// Checks that a picture shows points of the colours of the reasons for which a path leaves points out.
/// A check of the written program with its stock is the oracle: it removes material, and knows nothing of the planner.
#[test]
fn rapid_traverse_keeps_clear_of_stock() {
    let tube = Tube::new();
    assert!(tube.sweep("D2Ball", &[]).status.success());
    let output = tube.bench.place("stock.apt");
    tube.bench.part("stock.stl", &cuboid([-13.0, -13.0, -2.0], [13.0, 13.0, 14.0]));
    let stock = tube.bench.place("stock.stl");
    let job = format!(
        "part = {:?}\nunit = \"mm\"\nprogram = {output:?}\ntolerance = 0.05\n[stock]\nmesh = {stock:?}\nspacing = 0.5\n\
         [tool.3]\ntool = \"D2Ball\"\nallow = {{ shank = 0.00625 }}\n",
        tube.part,
    );
    let job = tube.bench.write("stock.toml", &job);
    let in_stock = |more: &[&str]| {
        let all = [&["--tool-number", "3", "--max-tilt", "90"], more].concat();
        let told = object(&path_across("0,0,1", &tube, &output, &all));
        let findings = objects(&touchoff(&["verify", &job, "--json"]));
        let found = findings.iter().filter(|found| found["kind"] == "stock");
        let rapid = found.clone().filter(|found| found["rapid"] == true).count();
        (told["contact_points"].as_u64(), rapid, found.count())
    };
    let (points, rapid, _) = in_stock(&[]);
    let (points_in_stock, rapid_in_stock, all) = in_stock(&["--stock", &stock]);
    assert!(rapid > 0 && rapid_in_stock == 0, "{rapid} {rapid_in_stock}");
    // The shank is in the stock nevertheless, in feed: the tool is short.
    assert!(points == points_in_stock && all > 0, "{points:?} {points_in_stock:?} {all}");
    // The joint motions of a machine are checked with the stock again.
    let machine =
        ["--tool-number", "3", "--feed", "20", "--machine", "A-C trunnion", "--stock", &stock];
    let told = object(&path(&tube, &tube.bench.place("stock.nc"), &machine));
    assert!(told["contact_points"].as_u64() > Some(50), "{told}");
    let open = Mesh::new(
        vec![Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0)],
        vec![[0, 1, 2]],
        Unit::Millimetre,
    );
    tube.bench.part("stock.stl", &open.expect("a triangle"));
    refused(&path(&tube, &output, &["--stock", &stock]), &["stock.stl", "inside"]);
}

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
    let output = tube.bench.place("words.apt");
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
        let program = touchoff_verify::ClData::parse(text, "words.apt").expect("a program");
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
    let table = path(&tube, &tube.bench.place("words.csv"), &words);
    assert_eq!(table.status.code(), Some(2), "{}", stderr(&table));
    assert!(stderr(&table).contains("a table has no place"), "{}", stderr(&table));
}

/// Across the tube, the lines pass its lower face, which no steep axis reaches.
#[test]
fn a_picture_shows_the_points_left_out() {
    let tube = Tube::new();
    assert!(tube.sweep("D2Ball", &[]).status.success());
    let picture = tube.bench.place("left.png");
    let more = ["--max-tilt", "60", "--picture", &picture];
    let summary = object(&path_across("1,0,0", &tube, &tube.bench.place("across.apt"), &more));
    assert_picture_has_points(&picture, &summary);
}

#[test]
fn a_path_that_rounding_ruins_is_not_written() {
    let tube = Tube::new();
    assert!(tube.sweep("D2Ball", &[]).status.success());
    let output = tube.bench.place("kept.apt");
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
    let output = tube.bench.place("tube.nc");
    let words = ["--tool-number", "3", "--feed", "500", "--spindle", "9000", "--max-tilt", "90"];
    for machine in ["A-C trunnion", "A-C fork head"] {
        let told = object(&path(&tube, &output, &[&words[..], &["--machine", machine]].concat()));
        let text = std::fs::read_to_string(&output).expect("a program");
        assert!(text.starts_with("G21 G90 G94 G54\nT3 M6\nS9000 M3\nG43.4 H3\nG0 X"), "{text}");
        assert!(text.ends_with("\nG49\nM5\nG53 G0 Z0.\nG53 G0 X0. Y0.\nM30\n"), "{text}");
        assert!(text.contains(" F500.\n"), "{text}");
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
    let limited = include_str!("../../../../verify/src/machine/machines/a-c-trunnion.toml")
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
        &["none of the directions that were swept is within the limits", "tilts the tool farther"],
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
        (path(&tube, &tube.bench.place("t.apt"), &["--machine", "3-axis"]), "ends in `.nc`"),
        (more(&["--machine", "lathe"]), "`lathe` is no machine"),
        (more(&["--machine", "3-axis", "--work-offset", "0,0,0"]), "--tool-length"),
    ] {
        assert_eq!(wrong.status.code(), Some(2), "{}", stderr(&wrong));
        assert!(stderr(&wrong).contains(words), "{words}: {}", stderr(&wrong));
    }
    assert!(!std::path::Path::new(&output).exists(), "a refusal writes nothing");
}
