//! The tables of `docs/measured/certified.md`: `certified [--poses N] [--seed S] [--parts FOLDER]`, 100,000
//! poses in all if it is not said. The folder's parts are asked about where it is there.
//!
//! `certified --zoomed N [--samples M] [--seed S]` prints the page's second part: N poses with M samples each, 10,000,000
//! if it is not said, that zoom in.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;
use touchoff::certify::Facets;
use touchoff::{Mesh, Unit};
use touchoff_bench::certified::subject::{FIELDS, PROFILES, Subject};
use touchoff_bench::certified::zoomed::{self, Zoomed};
use touchoff_bench::certified::{Pair, Row, buried, poses, table};
use touchoff_bench::page::made;
use touchoff_tests::oracle::Nearest;

const TOOLS: [&str; 6] = ["Fig73Exact", "BullNose", "Lollipop", "TSlot", "BallEr16", "TaperedBall"];

/// Real parts, where there is a folder of them, and their units.
const FILES: [(&str, Unit); 4] = [
    ("impeller.stl", Unit::Millimetre),
    ("featuretype_inch.stl", Unit::Inch),
    ("octagonal_pocket_metre.stl", Unit::Metre),
    ("kiri_pocket_test.stl", Unit::Millimetre),
];

fn main() -> Result<(), Box<dyn Error>> {
    let (mut count, mut seed) = (100_000, 1);
    let (mut zoomed, mut samples) = (0, 10_000_000);
    let mut folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/parts");
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words.next().ok_or_else(|| format!("what is `{word}`?"))?;
        match word.as_str() {
            "--poses" => count = value.parse()?,
            "--zoomed" => zoomed = value.parse()?,
            "--samples" => samples = value.parse()?,
            "--seed" => seed = value.parse()?,
            "--parts" => folder = PathBuf::from(value),
            _ => return Err(format!("`{word}` is not known").into()),
        }
    }
    let start = Instant::now();
    let mut parts = poses::parts()?;
    if zoomed > 0 {
        return zoom(&parts, zoomed, samples, seed);
    }
    for (name, unit) in FILES {
        let path = folder.join(name);
        if path.exists() {
            parts.push((name, Mesh::read_stl(path, unit)?));
        } else {
            eprintln!("{name} is skipped: there is no {}", path.display());
        }
    }
    let each = count / (parts.len() * TOOLS.len()).max(1);
    let rows = rows(&parts, each, seed);
    let command = format!(
        "cargo run --release -p touchoff-bench --bin certified -- --poses {count} --seed {seed} > docs/measured/certified.md"
    );
    let head = made(&command, &["runtime/src/certify"]);
    println!(
        "# Certified penetrations beside brute force

{head}

For each tool and part {each} poses: most put the tool's surface between 1e-9 and 6 mm into a triangle, a sixth lie along the
coordinate axes and flush with the part's box, a tenth are anywhere about the part. Tolerances are 0, 1e-9, 1e-6 and 1e-3 in turn.
All lengths are in the part's unit. *Over* is by how much a sample of brute force, or one beside the witness, is above the upper bound,
*under* by how much the witness is shallower than the lower one; 0 where it never is. *Brute behind* is by how much brute force without
the witness, which does not zoom, falls short of the lower bound, *reached* at how many poses by no more than 1e-6. *Wider* counts intervals wider than the tolerance and rounding.
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
fn rows(parts: &[(&str, Mesh)], each: usize, seed: u64) -> Vec<Row> {
    let facets: Vec<Facets> = parts.iter().map(|(_, mesh)| Facets::new(mesh)).collect();
    shared(parts.len() * TOOLS.len(), |k| {
        let ((part, mesh), name) = (&parts[k / TOOLS.len()], TOOLS[k % TOOLS.len()]);
        let tool = tools_library::find(name).expect("a tool of the library");
        let oracle = Nearest::of(name);
        let pair = Pair { part, mesh, facets: &facets[k / TOOLS.len()], tool, oracle: &oracle };
        let row = pair.measure(each, seed + k as u64);
        eprintln!("{} in {}: {} violations", row.tool, part, row.violations.len());
        row
    })
}

/// Prints the part of the page on samples that zoom in, and on tools inside the material.
fn zoom(
    parts: &[(&str, Mesh)],
    poses: usize,
    samples: u64,
    seed: u64,
) -> Result<(), Box<dyn Error>> {
    let start = Instant::now();
    let names: Vec<&str> = PROFILES.iter().chain(&FIELDS).copied().collect();
    let each = poses.div_ceil(parts.len() * names.len());
    let facets: Vec<Facets> = parts.iter().map(|(_, mesh)| Facets::new(mesh)).collect();
    let rows = shared(parts.len() * names.len(), |k| {
        let ((part, mesh), name) = (&parts[k / names.len()], names[k % names.len()]);
        let tool = tools_library::find(name).expect("a tool of the library");
        let subject = Subject::of(name);
        let facets = &facets[k / names.len()];
        let row = Zoomed { part, mesh, facets, tool, subject: &subject }.measure(
            each,
            samples,
            seed + k as u64,
        );
        eprintln!("{name} in {part}: {} violations", row.violations.len());
        row
    });
    // A solid's extents are no distances from an axis.
    let round: Vec<&str> =
        names.into_iter().filter(|name| !["Block", "LBracket"].contains(name)).collect();
    let blocks = shared(round.len(), |k| {
        let subject = Subject::of(round[k]);
        let tool = tools_library::find(round[k]).expect("a tool of the library");
        let count = if matches!(subject, Subject::Profile(..)) { 1000 } else { 20 };
        buried::measure(tool, &subject, count, seed)
    });
    let command = format!(
        "cargo run --release -p touchoff-bench --bin certified -- --zoomed {poses} --samples {samples} --seed {seed} >> docs/measured/certified.md"
    );
    let head = made(&command, &["runtime/src/certify"]);
    println!(
        "
## Zoomed maxima

{head}

For each tool and part {each} poses with {samples} samples each where a triangle is near. Half of them are middles of triangles and of their halves, the piece that may
have the deepest place first; the others zoom in on the deepest of these. Lengths are parts of the tool's size. *Over* is by how much a sample is above the upper
bound, *behind* by how much the samples fall short of the lower one, which they do not know, *reached* at how many poses by no more than 1e-9 or, of the tools by
their field or with overhangs, 1e-6. Tolerances are 1e-9 of the size, and of these 1e-6 mm; *wider* counts intervals wider than that and rounding.
"
    );
    print!("{}", zoomed::table(&rows, &blocks)?);
    eprintln!("{} s", start.elapsed().as_secs());
    let wrong = rows.iter().map(|row| row.violations.len()).sum::<usize>()
        + blocks.iter().map(|row| row.violations.len()).sum::<usize>();
    if wrong > 0 {
        return Err(format!("{wrong} violations").into());
    }
    Ok(())
}

/// The results of so many jobs, in their order, on all cores.
fn shared<T: Send>(jobs: usize, job: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    if k >= jobs {
                        break;
                    }
                    let result = job(k);
                    done.lock().unwrap_or_else(PoisonError::into_inner).push((k, result));
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    done.sort_by_key(|(k, _)| *k);
    done.into_iter().map(|(_, result)| result).collect()
}
