//! The page `compile.md`: size of each tool's code, compile time, bounds proved, cost of loading a tool at run time
//! instead, and import of tool libraries.

use super::{imported, interpreter, proofs};
use clap::Args;
use std::collections::BTreeMap;
use std::error::Error;
use std::process::Command;
use touchoff_bench::compile::{CompileTimes, ToolStats, compile_times, sources, tool_stats};
use touchoff_bench::page::{Page, Section};

/// Number of compilations of each tool: in the release build, and in the unoptimised build.
const COUNTS: [usize; 2] = [7, 3];

/// Measures the code of each tool, its compile time with and without optimisation, and the cost of interpreting it, and the
/// import of a tool library.
#[derive(Args)]
pub(crate) struct Compile {
    /// Prints only the compile times of this build, in seconds: one line per tool with best, median and worst.
    #[arg(long)]
    times: bool,
}

impl Compile {
    pub(crate) fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        if self.times {
            for source in sources() {
                let measured = compile_times(&source, COUNTS[1]);
                println!(
                    "{}\t{}\t{}\t{}",
                    tool_file_name(&source.name),
                    measured.best,
                    measured.median,
                    measured.worst
                );
            }
            return Ok(None);
        }
        let unoptimised = unoptimised()?;
        let mut rows = String::new();
        for source in sources() {
            let release = compile_times(&source, COUNTS[0]);
            let name = tool_file_name(&source.name);
            let debug = unoptimised.get(name).ok_or_else(|| format!("no times of {name}"))?;
            rows += &row(&tool_stats(&source), release, *debug);
        }
        Ok(Some(Page {
            name: "compile",
            title: "What it costs to compile, prove, load and import tools",
            covers: &[
                "tool-dsl/src",
                "tool-macros/src",
                "tools-library/tools",
                "runtime/src/tool",
                "import/src",
            ],
            sections: vec![
                Section { title: "Compiled", body: body(&rows) },
                proofs::section()?,
                interpreter::section()?,
                imported::section()?,
            ],
            figures: Vec::new(),
        }))
    }
}

/// Returns the file name of a tool: the folder may differ in a cached build.
fn tool_file_name(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}

/// Returns the compile times in an unoptimised build, as a user's `cargo build` runs the macros.
fn unoptimised() -> Result<BTreeMap<String, CompileTimes>, Box<dyn Error>> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["run", "--quiet", "--profile", "user", "-p", "touchoff-bench"])
        .args(["--", "compile", "--times"])
        .stderr(std::process::Stdio::inherit())
        .output()?;
    let mut times_by_tool = BTreeMap::new();
    for line in String::from_utf8(output.stdout)?.lines() {
        if let [name, best, median, worst] = line.split('\t').collect::<Vec<_>>()[..] {
            let [best, median, worst] = [best.parse()?, median.parse()?, worst.parse()?];
            times_by_tool.insert(name.to_owned(), CompileTimes { best, median, worst });
        }
    }
    if times_by_tool.is_empty() {
        return Err("the unoptimised build said nothing".into());
    }
    Ok(times_by_tool)
}

fn row(stats: &ToolStats, release: CompileTimes, debug: CompileTimes) -> String {
    let segments = stats.segments.map_or_else(|| "by hand".to_owned(), |n| n.to_string());
    let mut row = format!(
        "| {} | {segments} | {} | {} | {} | {:.1} | {:.1} |",
        stats.name, stats.regions, stats.curves, stats.tests, stats.splits[0], stats.splits[1],
    );
    row += &format!(" {} |", stats.operations);
    for times in [release, debug] {
        for time in [times.best, times.median, times.worst] {
            row += &format!(" {:.1} |", 1e3 * time);
        }
    }
    row + "\n"
}

fn body(rows: &str) -> String {
    let [release_runs, debug_runs] = COUNTS;
    format!(
        "**Tests** are those of the tree of owners; **met** is how many of them one point meets on average, within 2 % of the largest
radius from the surface and anywhere in the tool's box. **Operations** are those of the code for lanes: arithmetic, square
roots, comparisons, selects; a block of points executes those on its way and of its regions. **Times** are from a text to its tokens, in ms: best, median and worst
of {release_runs} in a release build, of {debug_runs} in one where nothing is optimised, as when a user's `cargo build` expands a macro (profile
`user`). `Assembly30` is a cutter, its nut, a holder and a spindle nose. Goals for it: 50 ms and 300 ms. `Chords200` is a ball drawn as 200 chords, with ends
in full doubles, so that all borders meet in its centre within rounding, and `Chords200Rounded` the same with 9 decimals, so that they do not. Goal for these: 1 s
in a release build, with the proof below.

| tool | segments | regions | curves | tests | met near | met in box | operations | release: best | median | worst | debug: best | median | worst |
|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|
{rows}"
    )
}
