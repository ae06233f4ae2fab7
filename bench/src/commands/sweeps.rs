//! The table of `docs/measured/sweeps.md`: `sweeps [--motions N] [--seed S] [--tool NAME]`, 10,000 motions that are
//! proved if it is not said; of one tool as many as it would have among all.

use std::error::Error;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;
use touchoff::Mesh;
use touchoff::certify::Facets;
use touchoff_bench::certified::sweeps::{Row, table};
use touchoff_bench::certified::{Pair, poses};
use touchoff_bench::page::made;
use touchoff_tests::oracle::Nearest;

/// The last is in inches.
const TOOLS: [&str; 10] = [
    "Fig73Exact",
    "BullNose",
    "TSlot",
    "BallEr16",
    "TaperedBall",
    "Lollipop",
    "Barrel",
    "CornerRounding",
    "Dovetail",
    "HalfInchBallCat40",
];

fn main() -> Result<(), Box<dyn Error>> {
    let (mut count, mut seed, mut only) = (10_000, 1, None);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words.next().ok_or_else(|| format!("what is `{word}`?"))?;
        match word.as_str() {
            "--motions" => count = value.parse()?,
            "--seed" => seed = value.parse()?,
            "--tool" => only = Some(value),
            _ => return Err(format!("`{word}` is not known").into()),
        }
    }
    let start = Instant::now();
    let parts = poses::parts()?;
    let each = count / (parts.len() * TOOLS.len());
    let rows = rows(&parts, each, seed, only.as_deref());
    let command = format!(
        "cargo run --release -p touchoff-bench --bin sweeps -- --motions {count} --seed {seed} > docs/measured/sweeps.md"
    );
    let head = made(&command, &["runtime/src/certify", "runtime/src/motion.rs"]);
    println!(
        "# Certified sweeps beside samples

{head}

For each tool and part motions are drawn until {each} are proved: slides, swings about the tip and about a place of the part by up to 150°,
plunges, straight ways, none at all, rapid moves and any between two poses. Most are moved to where they pass the part by 1e-7 to 0.5 mm,
some as much too near. Tolerances are 0, 1e-6 and 1e-3 in turn. Those that are proved are sampled at 66 times and 30 more beside the
closest, and from the best six a search climbs in time and place. All lengths are in the part's unit. *Near* is closer than 0.001; *over* is by how
much a sample is deeper than the tolerance and rounding, less than 0 where none is.
"
    );
    print!("{}", table(&rows)?);
    eprintln!("{} s", start.elapsed().as_secs());
    let violations: usize = rows.iter().map(|row| row.violations.len()).sum();
    if violations > 0 {
        return Err(format!("{violations} violations").into());
    }
    Ok(())
}

/// A row for each part and tool, on all cores.
fn rows(parts: &[(&str, Mesh)], each: usize, seed: u64, only: Option<&str>) -> Vec<Row> {
    let facets: Vec<Facets> = parts.iter().map(|(_, mesh)| Facets::new(mesh)).collect();
    let (next, rows) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    let (at, name) = (k / TOOLS.len(), TOOLS[k % TOOLS.len()]);
                    let Some((part, mesh)) = parts.get(at) else { break };
                    if only.is_some_and(|only| only != name) {
                        continue;
                    }
                    let tool = tools_library::find(name).expect("a tool of the library");
                    let oracle = Nearest::of(name);
                    let pair = Pair { part, mesh, facets: &facets[at], tool, oracle: &oracle };
                    let row = pair.sweeps(each, seed + k as u64);
                    eprintln!(
                        "{name} in {part}: {} of {} proved, {} undecided, {} violations",
                        row.proved,
                        row.motions,
                        row.undecided.len(),
                        row.violations.len()
                    );
                    row.violations.iter().for_each(|violation| eprintln!("{violation}"));
                    rows.lock().unwrap_or_else(PoisonError::into_inner).push((k, row));
                }
            });
        }
    });
    let mut rows = rows.into_inner().unwrap_or_else(PoisonError::into_inner);
    rows.sort_by_key(|(k, _)| *k);
    rows.into_iter().map(|(_, row)| row).collect()
}
