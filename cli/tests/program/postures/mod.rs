//! Sweeps, maps and paths.

mod path;
mod refine;
mod shard;
mod sweep;
mod touched;

use crate::bench::{Bench, stderr, stdout, touchoff};
use serde_json::Value;
use std::process::Output;
use touchoff::Unit;
use touchoff::mesh::shapes;

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
        bench.part("tube.stl", &tube);
        let (part, map) = (bench.place("tube.stl"), bench.place("tube.postures"));
        Tube { bench, part, map }
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
