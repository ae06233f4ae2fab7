//! The table of `docs/measured/accuracy.md`: `accuracy [POINTS]`, a million points a tool if it is not said.

use std::error::Error;
use std::fmt::Write;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;
use touchoff_bench::page::made;
use touchoff_tests::accuracy::{Row, measure, tools};

fn main() -> Result<(), Box<dyn Error>> {
    let count = match std::env::args().nth(1) {
        Some(text) => text.parse()?,
        None => 1_000_000,
    };
    let start = Instant::now();
    let rows = rows(count);
    println!("{}", page(&rows, count)?);
    eprintln!("{} tools in {:.0} s", rows.len(), start.elapsed().as_secs_f64());
    Ok(())
}

/// A row a tool, on all cores.
fn rows(count: usize) -> Vec<Row> {
    let (tools, next) = (tools(), AtomicUsize::new(0));
    let rows = Mutex::new(Vec::new());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while let Some((tool, restated)) = tools.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let row = measure(*tool, restated, count, 1);
                    eprintln!("{}: {:?}", row.name, row.missed());
                    rows.lock().unwrap_or_else(PoisonError::into_inner).push(row);
                }
            });
        }
    });
    let mut rows = rows.into_inner().unwrap_or_else(PoisonError::into_inner);
    rows.sort_by(|a, b| a.name.cmp(&b.name));
    rows
}

fn page(rows: &[Row], count: usize) -> Result<String, std::fmt::Error> {
    let command = format!(
        "cargo run --release -p touchoff-bench --bin accuracy -- {count} > docs/measured/accuracy.md"
    );
    let head = made(&command, &["tool-dsl/src", "tools-library/tools", "runtime/src/tool"]);
    let mut page = format!(
        "# Rounding of the compiled tools

{head}

Compiled evaluators against 256 bits: for each tool {count} points, half of them within 1e-6 of the surface or of a splitting
curve (as many within 1e-15 as within 1e-6 of it), the others anywhere in its box; besides these every vertex and centre with
its neighbours of one ulp, and the axis at d = 0, -0, 5e-324 and 2^-540. Both forms of the code are asked, for one point and
for lanes. The reference knows each profile from a restatement of its own and takes the nearest feature by trying those that
doubles leave within 1e-9 of the tool's size, in 256 bits throughout.

S is the next power of two above the largest coordinate, ε = 2^-52, ulp(S) = ε S, ρ the distance to the nearest point at which
the direction does not exist. A side is wrong, or an owner, only beyond 2 ulp(S). The bar: depth 1 ulp(S), no wrong side, no wrong
owner, ||u| - 1| 4 ε, u - u_exact 8 ε max(1, S/ρ), the same bits in both forms. `Fig73` is not here: its magnitudes are no
distances.

| tool | S | points | inside | depth, ulp(S) | at | wrong sides | wrong owners | \\|\\|u\\|-1\\|, ε | u over its bound | outside, ulp(S) | unlike bits |
|---|--:|--:|--:|--:|---|--:|--:|--:|--:|--:|--:|
"
    );
    for row in rows {
        let clearance = match &row.clearance.place {
            Some(_) => format!("{:.3}", row.clearance.error),
            None => "bound only".to_owned(),
        };
        writeln!(
            page,
            "| {} | {} {} | {} | {} | {:.3} | {} | {} | {} | {:.2} | {:.3} | {clearance} | {} |",
            row.name,
            row.scale,
            row.unit,
            row.points,
            row.inside,
            row.depth.error,
            row.depth.shown(),
            row.sides.count,
            row.owners.count,
            row.length.error,
            row.direction.error,
            row.unlike,
        )?;
    }
    page += "\n## Missed\n\n";
    let missed: Vec<String> = rows
        .iter()
        .flat_map(|row| row.missed().into_iter().map(|what| format!("- {}: {what}", row.name)))
        .collect();
    page += &if missed.is_empty() { "Nothing.".to_owned() } else { missed.join("\n") };
    Ok(page)
}
