//! The table of `docs/measured/compile.md`. With `--times` only the times of the build that it is, a line a tool.

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Write;
use std::process::Command;
use touchoff_bench::compile::{Parts, Times, parts, sources, times};
use touchoff_bench::page::made;

/// Times each tool is compiled, optimised and not.
const COUNTS: [usize; 2] = [7, 3];

fn main() -> Result<(), Box<dyn Error>> {
    if std::env::args().any(|argument| argument == "--times") {
        for source in sources() {
            let took = times(&source, COUNTS[1]);
            println!("{}\t{}\t{}\t{}", file(&source.name), took.best, took.median, took.worst);
        }
        return Ok(());
    }
    let unoptimised = unoptimised()?;
    let mut rows = String::new();
    for source in sources() {
        let took = times(&source, COUNTS[0]);
        let slow = unoptimised.get(file(&source.name)).copied().unwrap_or_default();
        rows += &row(&parts(&source), took, slow);
    }
    println!("{}", page(&rows)?);
    Ok(())
}

/// The name of a tool's file: the folder may be another in a build that was kept.
fn file(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}

/// The times of a build such as a user's `cargo build` makes of the macros: nothing optimised.
fn unoptimised() -> Result<BTreeMap<String, Times>, Box<dyn Error>> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["run", "--quiet", "--profile", "user", "-p", "touchoff-tests"])
        .args(["--bin", "compile", "--", "--times"])
        .stderr(std::process::Stdio::inherit())
        .output()?;
    let mut all = BTreeMap::new();
    for line in String::from_utf8(output.stdout)?.lines() {
        if let [name, best, median, worst] = line.split('\t').collect::<Vec<_>>()[..] {
            let [best, median, worst] = [best.parse()?, median.parse()?, worst.parse()?];
            all.insert(name.to_owned(), Times { best, median, worst });
        }
    }
    if all.is_empty() {
        return Err("the unoptimised build said nothing".into());
    }
    Ok(all)
}

fn row(parts: &Parts, took: Times, slow: Times) -> String {
    let segments = parts.segments.map_or_else(|| "by hand".to_owned(), |n| n.to_string());
    let operations = |name: &str| parts.operations.get(name).copied().unwrap_or(0);
    let mut row = format!(
        "| {} | {segments} | {} | {} | {} | {:.1} | {:.1} |",
        parts.name, parts.regions, parts.curves, parts.tests, parts.splits[0], parts.splits[1],
    );
    row += &format!(" {} |", operations("feel"));
    for took in [took, slow] {
        for time in [took.best, took.median, took.worst] {
            row += &format!(" {:.1} |", 1e3 * time);
        }
    }
    row + "\n"
}

fn page(rows: &str) -> Result<String, std::fmt::Error> {
    let command = "cargo run --release -p touchoff-bench --bin compile > docs/measured/compile.md";
    let head = made(command, &["tool-dsl/src", "tools-library/tools"]);
    let mut page = format!("# What compiling a tool costs, and what comes of it\n\n{head}\n\n");
    writeln!(
        page,
        "**Tests** are those of the tree of owners; **met** is how many of them one point meets on average, within 2 % of the largest
radius from the surface and anywhere in the tool's box. **Feel** are the operations of the code for lanes: arithmetic, square
roots, comparisons, selects; a block of points executes those on its way and of its regions. **Times** are from a text to its tokens, in ms: best, median and worst
of {} in a release build, of {} in one where nothing is optimised, as when a user's `cargo build` expands a macro (profile
`user`). `Assembly30` is a cutter, its nut, a holder and a spindle nose. Goals for it: 50 ms and 300 ms.
",
        COUNTS[0], COUNTS[1]
    )?;
    page += "
| tool | segments | regions | curves | tests | met near | met in box | feel | release: best | median | worst | debug: best | median | worst |
|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|
";
    page += rows;
    Ok(page)
}
