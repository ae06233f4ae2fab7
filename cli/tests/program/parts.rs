//! Parts as users bring them, and the messages about their points.

use crate::bench::{Bench, rows, stderr, touchoff};
use serde_json::Value;
use touchoff::{Cloud, Mesh, Sampling, Unit};

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn run(bench: &Bench, part: &str, more: &[&str]) -> std::process::Output {
    bench.run(part, "path.csv", "D2Ball", &[&["--json"], more].concat())
}

#[test]
fn a_sampling_error_determines_the_number_of_points() {
    let bench = Bench::new();
    let output = run(&bench, "block.stl", &["--sampling-error", "0.05"]);
    let said = stderr(&output);
    assert!(said.contains("a sampling error of 0.05") && said.contains(" points"), "{said}");
    assert!(
        said.contains("(proved): the true depth exceeds the reported one by at most 0.0"),
        "{said}"
    );
    // The ball is 0.5 deep in the block at the second pose.
    let found = rows(&output);
    let (depth, bound) = (number(&found[1]["depth"]), number(&found[1]["depth_bound"]));
    assert!(depth <= 0.5 + 1e-9 && bound >= 0.5 && bound - depth <= 0.05, "{depth} {bound}");
    assert!(number(&found[0]["depth_bound"]) <= 0.05);
    for wrong in ["0", "-1", "fine"] {
        let output = run(&bench, "block.stl", &["--sampling-error", wrong]);
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    }
    let both = run(&bench, "block.stl", &["--sampling-error", "0.1", "--points", "10"]);
    assert_eq!(both.status.code(), Some(2));
}

/// A tolerance that needs too many points is proved in a run; for points that are only saved it is refused.
#[test]
fn a_small_sampling_error_is_certified() {
    let bench = Bench::new();
    let output = run(&bench, "block.stl", &["--sampling-error", "1e-6"]);
    let said = stderr(&output);
    assert!(said.contains("depth is certified on the triangles instead"), "{said}");
    let found = rows(&output);
    let bound = number(&found[1]["depth_bound"]);
    assert!((0.5..=0.5 + 2e-6).contains(&bound), "{bound}");
    assert!(number(&found[1]["certified_depth"][1]) <= bound + 1e-12);
    let output =
        bench.touchoff("sample --part block.stl --unit mm --sampling-error 1e-6 -o fine.touchoff");
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(1));
    assert!(said.contains("more than 20000000") && said.contains("certify"), "{said}");
}

#[test]
fn the_sampling_method_is_used() {
    let bench = Bench::new();
    let number_of = |sampling: &str| {
        let said = stderr(&run(&bench, "block.stl", &["--sampling", sampling, "--points", "2000"]));
        let at = said.find("is within ").expect("the covering radius") + "is within ".len();
        said[at..].split(' ').next().and_then(|word| word.parse::<f64>().ok()).expect("a length")
    };
    assert!(1.5 * number_of("blue") < number_of("random"));
    assert_eq!(run(&bench, "block.stl", &["--sampling", "green"]).status.code(), Some(2));
}

#[test]
fn points_without_triangles_have_an_estimated_error() {
    let bench = Bench::new();
    let mesh = Mesh::read_stl(bench.folder.path().join("block.stl"), Unit::Millimetre);
    let cloud = Cloud::sample(&mesh.expect("the block"), Sampling::new(3_000)).expect("a cloud");
    let mut ply = String::from("ply\nformat ascii 1.0\nelement vertex 3000\n");
    for name in ["x", "y", "z", "nx", "ny", "nz"] {
        ply += &format!("property double {name}\n");
    }
    ply += "end_header\n";
    for (p, n) in cloud.points().iter().zip(cloud.normals()) {
        ply += &format!("{} {} {} {} {} {}\n", p.x, p.y, p.z, n.x, n.y, n.z);
    }
    bench.write("block.ply", &ply);
    let output = run(&bench, "block.ply", &[]);
    let said = stderr(&output);
    assert!(
        said.contains("areas and covering radius are estimated") && said.contains("(estimated)"),
        "{said}"
    );
    let [found, of_mesh] =
        [output, run(&bench, "block.stl", &["--points", "3000"])].map(|output| rows(&output));
    let [found, of_mesh] = [&found, &of_mesh].map(|rows| number(&rows[1]["magnitude_integral"]));
    assert!((found / of_mesh - 1.0).abs() < 0.03, "{found} {of_mesh}");
}

#[test]
fn saved_parts_have_the_same_contacts() {
    let bench = Bench::new();
    let sample = |out: &str, more: &[&str]| {
        let (part, out) = (bench.place("block.stl"), bench.place(out));
        let given = ["sample", "--part", &part, "--unit", "mm", "-o", &out];
        touchoff(&[&given[..], more].concat())
    };
    let output = sample("block.touchoff", &["--points", "5000"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stderr(&output).contains("5000 points"), "{}", stderr(&output));
    let evaluation = |part: &str| {
        let mut found = rows(&run(&bench, part, &["--points", "5000"]));
        for row in &mut found {
            row["query_time_ns"] = Value::Null;
        }
        found
    };
    assert_eq!(evaluation("block.touchoff"), evaluation("block.stl"));
    let refused = sample("block.part", &[]);
    assert!(stderr(&refused).contains("block.touchoff` instead of"), "{}", stderr(&refused));
    let nowhere = sample("no/such/folder/block.touchoff", &[]);
    assert_eq!(nowhere.status.code(), Some(1), "{}", stderr(&nowhere));
    let mut bytes = std::fs::read(bench.place("block.touchoff")).expect("saved");
    bytes[5_000] ^= 1;
    bench.write("flipped.touchoff", &bytes);
    bench.refused("flipped.touchoff", "path.csv", "D2Ball", &["flipped.touchoff"]);
    bench.write("short.touchoff", &bytes[..4_000]);
    bench.refused("short.touchoff", "path.csv", "D2Ball", &["short.touchoff"]);
    let stl = std::fs::read(bench.place("block.stl")).expect("the block");
    bench.write("foreign.touchoff", stl);
    bench.refused("foreign.touchoff", "path.csv", "D2Ball", &["foreign.touchoff"]);
    let certified = run(&bench, "block.touchoff", &["--certify", "1e-6"]);
    assert!(stderr(&certified).contains("`--certify` needs triangles"), "{}", stderr(&certified));
}

#[cfg(unix)]
#[test]
fn only_regular_files_are_read() {
    let bench = Bench::new();
    let pipe = bench.folder.path().join("pipe.stl");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status().expect("mkfifo");
    assert!(made.success());
    std::os::unix::fs::symlink("/dev/zero", bench.folder.path().join("zero.ply")).expect("a link");
    std::os::unix::fs::symlink("/dev/zero", bench.folder.path().join("zero.touchoff"))
        .expect("a link");
    for part in ["pipe.stl", "zero.ply", "zero.touchoff", "."] {
        bench.refused(part, "path.csv", "D2Ball", &["it is no regular file"]);
    }
    bench.refused_program("pipe.stl", &["it is no regular file"]);
}

#[test]
fn a_coordinate_far_outside_is_named() {
    let bench = Bench::new();
    let mut bytes = std::fs::read(bench.folder.path().join("block.stl")).expect("the block");
    let at = 84 + 50 * 5 + 12 + 4;
    bytes[at..at + 4].copy_from_slice(&1e13f32.to_le_bytes());
    bench.write("far.stl", &bytes);
    let says =
        ["far.stl, triangle 5 (from 0), byte 350: the coordinate", "is far outside the part"];
    bench.refused("far.stl", "path.csv", "D2Ball", &says);
}

/// A scan does not say which side is out: normals that face the side around which the surface closes are named.
#[test]
fn inward_normals_of_a_scan_are_named() {
    let bench = Bench::new();
    for (name, sign) in [("outward.ply", 1.0), ("inward.ply", -1.0)] {
        let mut ply = "ply\nformat ascii 1.0\nelement vertex 2000\n".to_owned();
        for column in ["x", "y", "z", "nx", "ny", "nz"] {
            ply += &format!("property double {column}\n");
        }
        ply += "end_header\n";
        for k in 0..2_000 {
            let z = 1.0 - (2.0 * f64::from(k) + 1.0) / 2_000.0;
            let (sine, cosine) = (2.4 * f64::from(k)).sin_cos();
            let [x, y] = [cosine, sine].map(|part| part * (1.0 - z * z).sqrt());
            let [nx, ny, nz] = [x, y, z].map(|part| sign * part);
            ply += &format!("{} {} {} {nx} {ny} {nz}\n", 5.0 * x, 5.0 * y, 5.0 * z);
        }
        bench.write(name, ply);
        for line in [
            format!("sample --part {name} --unit mm -o {name}.touchoff"),
            format!("run --part {name}.touchoff --unit mm --tool D2Ball --program path.csv"),
        ] {
            let output = bench.touchoff(&line);
            assert!(output.status.success(), "{line}: {}", stderr(&output));
            let words = ": the normals face into the material: at 100 % of the points";
            assert_eq!(stderr(&output).contains(words), sign < 0.0, "{line}: {}", stderr(&output));
        }
    }
}
