//! The table of `docs/measured/proofs.md`.

use std::error::Error;
use std::time::Instant;
use tool_dsl::compile;
use tool_dsl::prove::Certificate;
use tool_dsl::report::figure;
use touchoff_bench::compile::sources;
use touchoff_bench::page::made;

fn main() -> Result<(), Box<dyn Error>> {
    let command = "cargo run --release -p touchoff-bench --bin proofs > docs/measured/proofs.md";
    let head = made(command, &["tool-dsl/src", "tools-library/tools"]);
    println!(
        "# What is proved about the library

{head}

`c · distance ≤ depth ≤ L · distance`, and depth is L-Lipschitz; how, is in `docs/proofs.md`. **Joins** are borders of two
regions on which depths agree exactly, by an identity; **corners** are pairs of regions that meet in a point only or on a border that is
smooth but for rounding, where they agree to the tolerance. **Slack** is how far depth may be off its bounds, in the file's unit. **Open** are
boxes where the proof did not come to an end. Times are those of the proof alone.

| tool | regions | c | L | slack | a distance | joins | corners | jumps | open | boxes | ms |
|---|--:|--:|--:|--:|---|--:|--:|--:|--:|--:|--:|"
    );
    for source in sources() {
        let tool = compile(&source).into_tool().ok_or("a tool of the library has an error")?;
        let start = Instant::now();
        let proved = Certificate::of(&tool);
        let took = 1e3 * start.elapsed().as_secs_f64();
        let inner = || proved.borders.iter().filter(|border| border.between.1.is_some());
        let count = |is: &dyn Fn(f64) -> bool| inner().filter(|b| is(b.jump.high)).count();
        let bound = |bound: Option<f64>| bound.map_or("-".to_owned(), figure);
        println!(
            "| {} | {} | {} | {} | {:.0e} | {} | {} | {} | {} | {} | {} | {took:.1} |",
            tool.model.name,
            tool.model.regions.len(),
            bound(proved.least()),
            bound(proved.lipschitz()),
            proved.slack,
            if proved.is_exact() { "yes" } else { "no" },
            count(&|jump| jump == 0.0),
            count(&|jump| jump > 0.0 && jump <= proved.tolerance),
            count(&|jump| jump > proved.tolerance),
            proved.undecided.len(),
            proved.boxes,
        );
    }
    Ok(())
}
