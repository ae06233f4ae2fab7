//! The table of `docs/measured/rounding.md`: `rounding [--cases N] [--seed S] [--only CASE] [--threads T]`, 10,000,000
//! cases on all cores if it is not said. `--only` shows a single case.

use std::error::Error;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;
use touchoff_bench::page::made;
use touchoff_bench::rounding::cases::Family;
use touchoff_bench::rounding::{Rounding, Row, table};

/// Cases that a thread takes at once.
const CHUNK: u64 = 2000;

fn main() -> Result<(), Box<dyn Error>> {
    let (mut count, mut seed, mut only) = (10_000_000, 1, None);
    let mut threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut arguments = std::env::args().skip(1);
    while let Some(name) = arguments.next() {
        let value = arguments.next().ok_or_else(|| format!("`{name}` needs a value"))?;
        match name.as_str() {
            "--cases" => count = value.parse()?,
            "--seed" => seed = value.parse()?,
            "--only" => only = Some(value.parse()?),
            "--threads" => threads = value.parse()?,
            _ => {
                return Err(format!(
                    "`{name}` is no option: use --cases, --seed, --only or --threads"
                )
                .into());
            }
        }
    }
    let start = Instant::now();
    let rounding = Rounding::new(seed);
    eprintln!("tools: {:.1} s", start.elapsed().as_secs_f64());
    if let Some(number) = only {
        let mut rows = Family::ALL.map(Row::new).to_vec();
        rounding.ask(number, &mut rows);
        rows.retain(|row| row.cases > 0);
        println!("{}\n{}", rounding.describe(number), table(&rows)?);
        return Ok(());
    }
    let rows = rows(&rounding, count, threads);
    let command = format!(
        "cargo run --release -p touchoff-bench --bin rounding -- --cases {count} --seed {seed} > docs/measured/rounding.md"
    );
    let head = made(&command, &["runtime/src/certify"]);
    println!(
        "# Certified depth against 256 bits

{head}

Each case is a triangle, or a few, a tool and a pose, drawn where rounding does the most: eleven profiles at five scales from 1e-6 to 1e6 mm, tolerances 0 and
1e-9 of the tool's size. The doubles of the mesh and the pose are exact numbers, and a place `p` of the part is `R⁻¹ (p - tip)` in the tool's frame, as `Pose` says.
A search in doubles finds places; the depth of the best of them in 256 bits is less than the true greatest depth or equal. The upper end is
*exceeded* if it is below that. A witness is *off* if it is farther from its triangle than the promised widening and the rounding of a point of the world, and
*shallow* if the place of the triangle next to it is less deep than the lower end by more than the two are apart and that rounding: both are violations for certain.

*Found alone* counts cases in which the search comes within 1e-9 of the tool's size of the lower end without knowing the witness, *low certain* those whose lower
end is no more than a depth in 256 bits. The widening is 64 ε of the tool's and the part's size together, and the skew; the lower end has the 64 ε twice. *Above* is the largest part that the truth
takes of what the upper end adds to the depth that was computed and the tolerance, *below* of what the lower end takes from that depth; at 1 the end would be
wrong. *Wider* counts intervals wider than the tolerance, or four roundings if that is more, and both widenings by a hundredth of one; *widest* is by how many
widenings at most. `--only` and its number show a case.

All rotations that the public interface of `Pose` makes are orthonormal to 4 ε: axes and quaternions are normalised if their norm is within 1e-3 of 1, and
composed rotations are corrected. *Drift* has some composed of up to 24 others.
"
    );
    print!("{}", table(&rows)?);
    eprintln!("{} s", start.elapsed().as_secs());
    let violations: u64 = rows.iter().map(Row::violations).sum();
    if violations > 0 {
        return Err(format!("{violations} violations").into());
    }
    Ok(())
}

/// The rows of all families.
fn rows(rounding: &Rounding, count: u64, threads: usize) -> Vec<Row> {
    let (next, rows) = (AtomicU64::new(0), Mutex::new(Family::ALL.map(Row::new)));
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let from = next.fetch_add(CHUNK, Ordering::Relaxed);
                    if from >= count {
                        break;
                    }
                    let mut own = Family::ALL.map(Row::new);
                    for number in from..(from + CHUNK).min(count) {
                        rounding.ask(number, &mut own);
                    }
                    let mut rows = rows.lock().unwrap_or_else(PoisonError::into_inner);
                    for (row, own) in rows.iter_mut().zip(own) {
                        own.shown.iter().for_each(|text| eprintln!("{text}"));
                        row.add(own);
                    }
                }
            });
        }
    });
    rows.into_inner().unwrap_or_else(PoisonError::into_inner).to_vec()
}
