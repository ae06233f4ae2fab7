//! Controls differ: a program on which they do is clean only if it is clean on all of them, or on the one that is named.

mod five_axes;
mod jobs;
mod motions;
mod posts;
mod words;

use crate::bench::{Bench, cuboid, stderr, stdout, touchoff};
use std::process::Output;
use touchoff_verify::gcode::{Choice, ControlRules, Rule};

/// A block of 6 × 6 × 2 below z = 0, a tool of 2 mm that ends in a ball, and what is added by a test.
struct Scene {
    bench: Bench,
    job: String,
}

/// A program that states its unit and its offset, and turns the spindle.
fn program(blocks: &str) -> String {
    format!("G21 G90 G54 G94 S9000 M3 F100.\n{blocks}\nM30\n")
}

impl Scene {
    fn new(blocks: &str) -> Scene {
        Scene::of(&program(blocks))
    }

    fn of(text: &str) -> Scene {
        let bench = Bench::new();
        bench.write("a.nc", text);
        let job = "part = \"block.stl\"\nunit = \"mm\"\nprogram = \"a.nc\"\n";
        Scene { bench, job: format!("{job}TOP\n[tool.1]\ntool = \"D2Ball\"\nLENGTH\n") }
    }

    /// States a key of the job.
    fn with(mut self, line: &str) -> Scene {
        self.job = self.job.replace("TOP", &format!("{line}\nTOP"));
        self
    }

    /// States the length of the tool, and where the part is on the machine.
    fn placed(mut self) -> Scene {
        self.job = self.job.replace("LENGTH", "length = 50");
        self.job += "[work_offsets]\nG54 = [0, 0, -400]\n";
        self
    }

    /// Adds an obstacle.
    fn obstacle(mut self, low: [f64; 3], high: [f64; 3]) -> Scene {
        self.bench.part("clamp.stl", &cuboid(low, high));
        self.job += "[[fixture]]\nname = \"the clamp\"\nmesh = \"clamp.stl\"\n";
        self
    }

    fn run(&self, more: &[&str]) -> Output {
        let job = self.job.replace("TOP\n", "").replace("LENGTH\n", "");
        let file = self.bench.write("a.toml", job);
        touchoff(&[&["verify", &file][..], more].concat())
    }

    /// As [`Scene::gives`], on a Sinumerik that reads native programs.
    fn gives_natively(&self, status: i32, words: &[&str]) {
        self.gives_after_traori(Choice::DeselectsOffset, status, words);
    }

    /// As [`Scene::gives_natively`], with what TRAORI does to the work offset.
    fn gives_after_traori(&self, offset: Choice, status: i32, words: &[&str]) {
        let siemens = ControlRules::named("siemens").expect("a control");
        let native = siemens.with(Rule::ToolLength, Choice::Always);
        let native = native.with(Rule::Rotary, Choice::WithinTurn);
        let native = native.with(Rule::ToolOrientation, Choice::ByAxes);
        let native = native.with(Rule::TransformationOffset, offset).to_toml();
        let control = self.bench.write("native.toml", native);
        self.gives(&["--control", &control], status, words);
    }

    /// As [`Scene::gives`], on a control that reads the words of Fanuc and moves as LinuxCNC does.
    fn gives_straight(&self, status: i32, words: &[&str]) {
        let rules = ControlRules::named("linuxcnc").expect("a control");
        let rules = rules.with(Rule::Dialect, Choice::Iso).to_toml();
        let control = self.bench.write("straight.toml", rules);
        self.gives(&["--control", &control], status, words);
    }

    /// Asserts the status and words of the output with more options.
    fn gives(&self, more: &[&str], status: i32, words: &[&str]) {
        let output = self.run(more);
        let all = format!("{}{}", stdout(&output), stderr(&output));
        assert_eq!(output.status.code(), Some(status), "{more:?}: {all}");
        for word in words {
            assert!(all.contains(word), "{more:?}: `{word}` is missing in:\n{all}");
        }
    }
}

const LINUXCNC: [&str; 2] = ["--control", "linuxcnc"];
const FANUC: [&str; 2] = ["--control", "fanuc"];
const HAAS: [&str; 2] = ["--control", "haas"];
const SIEMENS: [&str; 2] = ["--control", "siemens"];
