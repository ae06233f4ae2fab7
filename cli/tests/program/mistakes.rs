//! Mistakes that users make, with the exit status and the message of each. Every message says what is wrong, where,
//! and what to do.

use crate::bench::{Bench, TOOL, stdout};
use std::fmt::Write;
use std::process::{Command, Output};
use touchoff::{Mesh, Unit};

const PROGRAM: &str =
    "UNITS/MM\nGOTO/-9,0,3,0,0,1\nGOTO/-9,0,0.5,0,0,1\nGOTO/9,0,0.5,0,0,1\nFINI\n";

/// Files with defects, by name and content.
const FILES: [(&str, &str); 21] = [
    ("program.apt", PROGRAM),
    ("my.tool", TOOL),
    ("my.txt", TOOL),
    (
        "unclosed.tool",
        "tool Unclosed {\n    units mm;\n    profile { start (0, 0); line to (2, 0) as face; }\n",
    ),
    ("unitless.tool", "tool Unitless {\n    region r where d <= 1 { depth: 1 - d; }\n}\n"),
    ("mounting.tool", "tool Mounting {\n    units mm;\n    mount \"holder.tool\" as holder;\n}\n"),
    ("empty.tool", ""),
    ("empty.apt", ""),
    ("empty.stl", ""),
    ("unfinished.apt", "UNITS/MM\nGOTO/0,0,3,0,0,1\nGOTO/0,0,2,0,0,1\n"),
    ("far.apt", "UNITS/MM\nGOTO/900,0,3,0,0,1\nGOTO/900,9,3,0,0,1\nFINI\n"),
    ("cycle.apt", "UNITS/MM\nGOTO/0,0,3,0,0,1\nCYCLE/DRILL,5\nGOTO/9,0,3,0,0,1\nFINI\n"),
    ("gcode.nc", "G21\nG0 X0 Y0 Z3\nG1 Z-1 F100\n"),
    ("noaxis.csv", "0,0,3\n0,0,2\n"),
    ("short.csv", "0,0,3,0,0,1\n0,0,2,0,1\n"),
    ("names.csv", "tx,ty,tz,ax,ay,az\n0,0,3,0,0,1\n"),
    ("nan.csv", "0,0,3,0,0,1\n0,nan,2,0,0,1\n"),
    ("decimal_comma.csv", "0,5;0;3;0;0;1\n0;0;2;0;0;1\n"),
    ("zero.csv", "0,0,3,0,0,1\n0,0,2,0,0,0\n"),
    ("one.csv", "0,0,3,0,0,1\n"),
    ("part.step", "ISO-10303-21;\nHEADER;\n"),
];

/// Command lines, without `touchoff`. `PART` stands for `--part part.stl --unit mm`.
const MISTAKES: [&str; 83] = [
    // The command and its options.
    "verfy PART",
    "run --part part.stl --tool D2Ball --program program.apt",
    "run PART --tool D2Ball --path program.apt",
    "verify PART --tool D2Ball --program program.apt --tolerence 0.1",
    "run PART --tool D2Ball",
    "report part.stl --unit mm -o report.html",
    "report part.stl --unit mm --tool D2Ball --program program.apt -o report.pdf",
    "report job.toml --tool D2Ball -o report.html",
    "tools my.tool list",
    "tools part.stl",
    "export D2Ball -o tool.step",
    "export Fig73 -o tool.json",
    "haptic PART --tool D2Ball --device glove",
    "haptic PART --tool D2Ball --device playback",
    "haptic PART --tool D2Ball --device spacenav --program program.apt",
    // Values.
    "run --part part.stl --unit cm --tool D2Ball --program program.apt",
    "run PART --tool D2Ball --program program.apt --points 0",
    "run PART --tool D2Ball --program program.apt --points 1e6",
    "run PART --tool D2Ball --program program.apt --points 100 --sampling-error 0.1",
    "run PART --tool D2Ball --program program.apt --law hooke",
    "run PART --tool D2Ball --program program.apt --center 1,2",
    "verify PART --tool D2Ball --program program.apt --tolerance -0.1",
    "verify PART --tool D2Ball --program program.apt --tolerance 0,01",
    "verify PART --tool D2Ball --program program.apt --tolerance 0.01mm",
    "verify PART --tool D2Ball --program program.apt --tolerance --json",
    "verify PART --tool D2Ball --program program.apt --tolerance 10",
    "verify PART --tool D2Ball --program program.apt --allow fluet=1",
    "verify PART --tool D2Ball --program program.apt --allow flute",
    "verify PART --tool D2Ball --program program.apt --allow flute=NaN",
    "sweep PART --tool D2Ball --tolerance 0",
    "sweep PART --tool D2Ball --allow nut=0.1",
    "path part.postures --part part.stl --tool D2Ball --stepover -1 -o path.apt",
    "path part.postures --part part.stl --tool D2Ball --stepover 1e-9 -o path.apt",
    "path part.postures --part part.stl --tool D2Ball --plane-normal 0,0,0 --stepover 1 -o path.apt",
    "haptic PART --tool D2Ball --rate 0",
    // Tools.
    "run PART --tool D2Bal --program program.apt",
    "run PART --tool d2ball --program program.apt",
    "run PART --tool my --program program.apt",
    "run PART --tool my.txt --program program.apt",
    "run PART --tool mine.tool --program program.apt",
    "run PART --tool D2Ball --set D=3 --program program.apt",
    "sweep PART --tool my.tool,D2Ball --set D=3",
    "run PART --tool my.tool --set E=3 --program program.apt",
    "run PART --tool my.tool --set D --program program.apt",
    "run PART --tool my.tool --set D=-1 --program program.apt",
    "run PART --tool my.tool --set D=3deg --program program.apt",
    "sample PART --sampling-error 0.1 --set D=3 -o part.touchoff",
    "sweep PART --tool Block",
    "tools show D2Bal",
    "tools show my.tool",
    "check unclosed.tool",
    "check unitless.tool",
    "check mounting.tool",
    "check empty.tool my.tool",
    "check part.stl",
    "draw D2Ball",
    "explain T9999",
    "fmt mine.tool",
    // Parts.
    "run --part prat.stl --unit mm --tool D2Ball --program program.apt",
    "run --part . --unit mm --tool D2Ball --program program.apt",
    "run --part part.step --unit mm --tool D2Ball --program program.apt",
    "run --part program.apt --unit mm --tool D2Ball --program program.apt",
    "run --part empty.stl --unit mm --tool D2Ball --program program.apt",
    "run --part cut.stl --unit mm --tool D2Ball --program program.apt",
    "run --part part.stl --unit inch --tool D2Ball --program program.apt",
    "verify --part part.stl --unit m --tool D2Ball --program program.csv",
    "verify --part inverted.stl --unit mm --tool D2Ball --program program.apt",
    "sweep --part leaky.stl --unit mm --tool D2Ball",
    // Programs.
    "run PART --tool D2Ball --program programme.apt",
    "run PART --tool D2Ball --program empty.apt",
    "run PART --tool D2Ball --program gcode.nc",
    "run PART --tool D2Ball --program noaxis.csv",
    "run PART --tool D2Ball --program decimal_comma.csv",
    "verify PART --tool D2Ball --program far.apt",
    "run PART --tool Block --program program.apt",
    // Outputs and maps.
    "sweep PART --tool D2Ball -o part.stl",
    "draw my.tool -o nowhere/my.svg",
    "draw my.tool -o my.pdf",
    "map part.postures --part other.stl -o map.png",
    "map part.stl",
    "map part.postures -o map.png",
    "path part.postures --part part.stl --tool BallEr16 --stepover 1 -o path.apt",
    "sweep PART --tool D2Ball -o part.postures",
];

/// Programs with one defect each, for `run`.
const PROGRAMS: [&str; 8] = [
    "short.csv",
    "names.csv",
    "nan.csv",
    "zero.csv",
    "one.csv",
    "unfinished.apt",
    "cycle.apt",
    ".",
];

fn run_in(bench: &Bench, line: &str) -> Output {
    let line = line.replace("PART", "--part part.stl --unit mm");
    let mut program = Command::new(env!("CARGO_BIN_EXE_touchoff"));
    let program = program.args(line.split(' ')).current_dir(&bench.folder);
    program.output().expect("the program runs")
}

/// Writes parts: a block, larger and damaged copies, and a map of it.
fn folder() -> Bench {
    let bench = Bench::new();
    for (name, text) in FILES {
        bench.write(name, text);
    }
    bench.write("program.csv", "-9,0,0.5,0,0,1\n9,0,0.5,0,0,1\n");
    let block = std::fs::read(bench.folder.path().join("block.stl")).expect("the block");
    bench.write("cut.stl", &block[..block.len() - 30]);
    bench.write("part.stl", &block);
    let mesh = Mesh::from_stl(&block, "block.stl", Unit::Millimetre).expect("the block");
    let made = |triangles: Vec<[u32; 3]>| {
        Mesh::new(mesh.vertices().to_vec(), triangles, Unit::Millimetre).expect("a mesh")
    };
    bench.part("leaky.stl", &made(mesh.triangles()[1..].to_vec()));
    bench.part(
        "inverted.stl",
        &made(mesh.triangles().iter().map(|[a, b, c]| [*b, *a, *c]).collect()),
    );
    let high = nalgebra::Point3::new(5.0, 5.0, 5.0);
    let other = touchoff::mesh::shapes::cuboid(-high, high, Unit::Millimetre);
    bench.part("other.stl", &other.expect("a block"));
    let sweep = "sweep PART --tool D2Ball --directions 20 --tolerance 0.05 -o part.postures";
    assert!(run_in(&bench, sweep).status.success());
    bench
}

/// After a change of a message, run `INSTA_UPDATE=always cargo test --workspace --test program mistakes` and read the
/// difference.
#[test]
fn messages_say_what_where_and_how() {
    let bench = folder();
    let programs = PROGRAMS.map(|file| format!("verify PART --tool D2Ball --program {file}"));
    let mut text = String::new();
    for line in MISTAKES.into_iter().chain(programs.iter().map(String::as_str)) {
        let output = run_in(&bench, line);
        let message = String::from_utf8(output.stderr.clone()).expect("UTF-8");
        let status = output.status.code().expect("a status");
        assert!(status != 0 && !message.contains("panicked"), "{line}: {status}: {message}");
        assert!(
            output.stdout.is_empty() || line.starts_with("check"),
            "{line}: {}",
            stdout(&output)
        );
        let _ = writeln!(text, "$ touchoff {line}\nstatus {status}\n{}\n", message.trim_end());
    }
    insta::with_settings!({ omit_expression => true }, {
        insta::assert_snapshot!("mistakes", text);
    });
}
