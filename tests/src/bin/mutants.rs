//! The table of `docs/measured/mutants.md`.

use std::error::Error;
use tool_dsl::compile;
use tool_dsl::prove::Certificate;
use touchoff_tests::measure::compile::library;
use touchoff_tests::measure::mutants::{Caught, KINDS, caught, changes, mutants};

/// How often each tool is broken.
const EACH: usize = 20;

fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "# The library, broken on purpose

```sh
cargo run --release -p touchoff-tests --bin mutants > docs/measured/mutants.md
```

Every tool is broken {EACH} times, in one place each, after it was compiled; and proved once more. **Alike** are those that are
no other solid, depth or direction at 20,000 points. Of the rest: found by a **jump** of depth, shown at a point; by a
**proof** that does not come to its end where that of the whole tool does; by other **bounds** of depth by the distance than
those of the whole tool; by a **direction** that leads elsewhere than straight down; or **not**.

| tool | broken | alike | jump | proof | bounds | direction | not |
|---|--:|--:|--:|--:|--:|--:|--:|"
    );
    let mut missed = Vec::new();
    let (mut all, mut by_kind) = ([0; 7], vec![[0; 2]; KINDS.len()]);
    for (seed, source) in library().iter().enumerate() {
        let whole = *compile(source).into_tool().ok_or("a tool of the library has an error")?;
        let proved = Certificate::of(&whole);
        let mut counts = [0; 7];
        for mutant in mutants(&whole, EACH, seed as u64) {
            counts[0] += 1;
            if !changes(&whole, &mutant.tool, 1) {
                counts[1] += 1;
                continue;
            }
            let found = caught(&proved, &Certificate::of(&mutant.tool));
            let column = match found {
                Caught::Jump => 2,
                Caught::Open => 3,
                Caught::Bounds => 4,
                Caught::Direction => 5,
                Caught::Not => 6,
            };
            counts[column] += 1;
            by_kind[mutant.kind][usize::from(found == Caught::Not)] += 1;
            if found == Caught::Not {
                missed.push((whole.model.name.clone(), KINDS[mutant.kind], mutant.place));
            }
        }
        let row: Vec<String> = counts.iter().map(usize::to_string).collect();
        println!("| {} | {} |", whole.model.name, row.join(" | "));
        for (sum, count) in all.iter_mut().zip(counts) {
            *sum += count;
        }
    }
    let row: Vec<String> = all.iter().map(usize::to_string).collect();
    println!("| **all** | {} |", row.join(" | "));
    let other = all[0] - all[1];
    println!("\n{:.1} % of {other} are found.\n", 100.0 * (other - all[6]) as f64 / other as f64);
    println!("| broken | found | not |\n|---|--:|--:|");
    for (kind, [found, not]) in KINDS.iter().zip(by_kind) {
        println!("| {kind} | {found} | {not} |");
    }
    if !missed.is_empty() {
        println!("\n## Not found\n\n| tool | what | where |\n|---|---|---|");
        for (tool, kind, place) in missed {
            println!("| {tool} | {kind} | {place} |");
        }
    }
    Ok(())
}
