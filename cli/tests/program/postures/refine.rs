//! Sweeps that divide triangles, and maps of their pieces.

use super::{object, refused};
use crate::bench::{Bench, stderr, stdout};
use resvg::tiny_skia::Pixmap;
use serde_json::Value;
use std::process::Output;
use touchoff::{Mesh, Unit};
use touchoff_postures::PostureMap;

/// A box of 30 by 24 by 12 mm with a pocket of 16 by 10 by 6, in 28 triangles.
struct Pocket {
    bench: Bench,
}

impl Pocket {
    fn new() -> Pocket {
        let bench = Bench::new();
        let outer = [[0.0, 0.0], [30.0, 0.0], [30.0, 24.0], [0.0, 24.0]];
        let inner = [[7.0, 7.0], [23.0, 7.0], [23.0, 17.0], [7.0, 17.0]];
        let rings = [(outer, 0.0), (outer, 12.0), (inner, 12.0), (inner, 6.0)];
        let vertices = rings.iter().flat_map(|(ring, z)| ring.map(|[x, y]| [x, y, *z]));
        let mut triangles = vec![[0, 3, 2], [0, 2, 1], [12, 13, 14], [12, 14, 15]];
        for ring in 0..3 {
            for k in 0..4 {
                let [a, b] = [4 * ring + k, 4 * ring + (k + 1) % 4];
                triangles.extend([[a, b, b + 4], [a, b + 4, a + 4]]);
            }
        }
        let mesh = Mesh::new(vertices, triangles, Unit::Millimetre).expect("a mesh");
        bench.part("pocket.stl", &mesh);
        Pocket { bench }
    }

    fn sweep(&self, options: &str) -> Output {
        let inputs = "--part pocket.stl --unit mm --tool D2Ball,BallEr16 --directions 20";
        self.bench.touchoff(&format!("sweep {inputs} {options}"))
    }

    /// Writes a map in another format, and returns the bytes.
    fn export(&self, map: &str, output: &str) -> Vec<u8> {
        let done = self.bench.touchoff(&format!("map {map} --part pocket.stl -o {output}"));
        assert!(done.status.success(), "{}", stderr(&done));
        let name = output.split(' ').next().expect("a name");
        std::fs::read(self.bench.place(name)).expect("a file")
    }
}

#[test]
fn pieces_show_what_a_tool_does_not_reach() {
    let pocket = Pocket::new();
    let told = object(&pocket.sweep("--refine --json -o refined.postures"));
    let refinement = &told["refinement"];
    assert_eq!((&refinement["finest"], &told["triangles_reached"]), (&0.25.into(), &28.into()));
    // The floor and the walls have strips of 1 mm at concave edges, outside of which all is reached.
    let edges =
        16.0 * 10.0 - 14.0 * 8.0 + 2.0 * (16.0 * 6.0 - 14.0 * 5.0) + 2.0 * (10.0 * 6.0 - 8.0 * 5.0);
    let area = 2.0 * 30.0 * 24.0 + 12.0 * 2.0 * (30.0 + 24.0) + 6.0 * 2.0 * (16.0 + 10.0);
    let expected = 1.0 - edges / area;
    let found = told["area_fraction_reached"].as_f64().expect("a number");
    assert!((found - expected).abs() < 0.004, "{found}, not {expected}");
    // All of the floor's triangles and of the walls' are reached in part.
    assert_eq!(refinement["triangles_partly_reached"], 10, "{told}");
    let pieces = refinement["pieces"].as_u64().expect("a number");

    let again = object(&pocket.sweep("--refine --json -o refined.postures"));
    assert_eq!(again["postures"]["total"], 0);
    for key in ["refinement", "tools", "area_fraction_reached"] {
        assert_eq!(again[key], told[key], "{key}");
    }
    let unsaved = pocket.sweep("--refine --json");
    for key in ["refinement", "tools", "area_fraction_reached", "postures"] {
        assert_eq!(object(&unsaved)[key], told[key], "{key}");
    }
    let words = pocket.sweep("--refine 0.5");
    assert!(
        stdout(&words).contains("down to 0.5000 mm; 10 are reached in part"),
        "{}",
        stdout(&words)
    );

    let shown = stdout(&pocket.bench.touchoff("map refined.postures"));
    let divided = refinement["triangles_divided"].as_u64().expect("a number");
    let line = format!("{divided} are divided into {pieces} pieces");
    assert!(shown.contains(&line), "{line}: {shown}");
    let table = String::from_utf8(pocket.export("refined.postures", "m.csv")).expect("text");
    // The floor is made of triangles 2 and 3.
    let fraction = |line: &str| line.rsplit(',').next().and_then(|last| last.parse::<f64>().ok());
    for triangle in ["2,D2Ball", "3,D2Ball"] {
        let line = table.lines().find(|line| line.starts_with(triangle)).expect("a line");
        assert!((fraction(line).expect("a number") - 0.7).abs() < 0.03, "{line}");
    }
    let ply = pocket.export("refined.postures", "m.ply");
    let faces = format!("element face {}\n", pieces + 28 - divided);
    assert!(String::from_utf8_lossy(&ply[..400]).contains(&faces), "{faces}");

    let path =
        "path refined.postures --part pocket.stl --tool D2Ball --stepover 3 -o pocket.apt --json";
    let led = object(&pocket.bench.touchoff(path));
    assert!(led["contact_points"].as_u64() > Some(40), "{led}");
}

/// Returns the number of grey and of coloured pixels of a picture, above its legend.
fn pixels(bytes: &[u8]) -> [usize; 2] {
    let picture = Pixmap::decode_png(bytes).expect("a picture");
    let above_legend = (picture.width() * (picture.height() - 120)) as usize;
    let spread = |index: &usize| {
        let pixel = picture.pixels()[*index];
        let parts = [pixel.red(), pixel.green(), pixel.blue()];
        parts.into_iter().max().unwrap_or(0) - parts.into_iter().min().unwrap_or(0)
    };
    let is_paper = |index: &usize| picture.pixels()[*index].red() > 250;
    let shown = || (0..above_legend).filter(|index| !is_paper(index));
    [
        shown().filter(|index| spread(index) == 0).count(),
        shown().filter(|index| spread(index) > 30).count(),
    ]
}

#[test]
fn a_picture_has_the_colours_of_pieces() {
    let pocket = Pocket::new();
    assert!(pocket.sweep("-o plain.postures").status.success());
    assert!(pocket.sweep("--refine 0.5 -o refined.postures").status.success());
    let picture = |map: &str| pixels(&pocket.export(map, "m.png --color-by accessibility"));
    let [grey, coloured] = picture("plain.postures");
    let [more_grey, less_coloured] = picture("refined.postures");
    // Every triangle has its centroid reached, but the strips at the pocket's edges are not.
    assert!(more_grey > grey + 1500, "{grey}, {more_grey}");
    assert!(less_coloured < coloured, "{coloured}, {less_coloured}");
    // A tool alone has pictures of its own.
    let by_tool = "m.png --color-by stick-out --tool BallEr16";
    let [_, one] = pixels(&pocket.export("refined.postures", by_tool));
    assert!(one > 1000);
    let map = |tool: &str| {
        let line = format!("map refined.postures --part pocket.stl -o m.png --tool {tool}");
        pocket.bench.touchoff(&line)
    };
    refused(&map("Flat --color-by stick-out"), &["not swept with this `Flat`"]);
    let wrong = map("D2Ball");
    assert_eq!(wrong.status.code(), Some(2), "{}", stderr(&wrong));
    assert!(stderr(&wrong).contains("--color-by stick-out"), "{}", stderr(&wrong));
}

/// A sweep that ended after some batches of pieces, and one that was refined later.
#[test]
fn a_refinement_continues_where_it_ended() {
    let pocket = Pocket::new();
    let [whole, later, killed] =
        ["a.postures", "b.postures", "c.postures"].map(|name| pocket.bench.place(name));
    let told = object(&pocket.sweep("--refine 1 --json -o a.postures"));
    assert!(pocket.sweep("-o b.postures").status.success());
    std::fs::copy(&later, &killed).expect("a copy");
    let after = object(&pocket.sweep("--refine 1 --json -o b.postures"));
    assert_eq!(after["refinement"], told["refinement"]);
    let rows = PostureMap::read(&whole).expect("a map").piece_rows().expect("rows");
    let some: Vec<_> = rows.clone().into_iter().take(rows.len() / 2).collect();
    let map = PostureMap::resume(&killed).expect("a map");
    map.record_pieces(&some).expect("room");
    drop(map);
    let continued = object(&pocket.sweep("--refine 1 --json -o c.postures"));
    assert_eq!(continued["refinement"], told["refinement"]);
    let postures = |told: &Value| told["postures"]["total"].as_u64();
    assert!(postures(&continued) < postures(&told), "{continued}");
    let exports = [&whole, &later, &killed].map(|map| pocket.export(map, "m.json"));
    assert!(exports[0] == exports[1] && exports[0] == exports[2]);
    for wrong in ["0", "-1", "nan"] {
        let refused = pocket.sweep(&format!("--refine={wrong} -o a.postures"));
        assert_eq!(refused.status.code(), Some(2), "{}", stderr(&refused));
    }
    refused(&pocket.sweep("--refine=1e-6 -o a.postures"), &["0.000001", "larger"]);
}
