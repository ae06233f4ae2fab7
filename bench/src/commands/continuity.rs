//! The page `docs/measured/continuity.md` and its plots: `continuity [--quick] [--seed N] [--to FOLDER]`.

use rayon::prelude::*;
use std::error::Error;
use std::path::{Path as File, PathBuf};
use std::time::Instant;
use touchoff::scenes::{Path, tube};
use touchoff::{Law, Part, Tool};
use touchoff_bench::continuity::LAWS;
use touchoff_bench::continuity::drift::{self, Turn};
use touchoff_bench::continuity::energy;
use touchoff_bench::continuity::loops::{Kind, block};
use touchoff_bench::continuity::page::{Measured, page, plot};
use touchoff_bench::continuity::smooth::Fig73Smooth;
use touchoff_bench::continuity::steps::{self, Look};

fn main() -> Result<(), Box<dyn Error>> {
    let (mut quick, mut seed) = (false, 1);
    let mut to = File::new(env!("CARGO_MANIFEST_DIR")).join("../docs/measured");
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("what is `{word}`?"));
        match word.as_str() {
            "--quick" => quick = true,
            "--seed" => seed = value()?.parse()?,
            "--to" => to = PathBuf::from(value()?),
            _ => return Err(format!("`{word}` is not known").into()),
        }
    }
    let start = Instant::now();
    let drift = Turn::all()
        .into_iter()
        .map(|turn| drift::row(turn, if quick { 100_000 } else { 10_000_000 }, 97));
    let drift = drift.collect();
    eprintln!("drift: {} s", start.elapsed().as_secs());
    let clouds = if quick { vec![20_000] } else { vec![20_000, 1_000_000] };
    std::fs::create_dir_all(&to)?;
    let mut all = Vec::new();
    for count in clouds {
        let part = steps::part(&tube(), count, seed);
        all.push((count, stepped(&part, count, &to)?));
        eprintln!("{count} points: {} s", start.elapsed().as_secs());
    }
    let points = if quick { 20_000 } else { 1_000_000 };
    let measured = Measured { steps: all, energy: (points, worked(points, seed, quick)?), drift };
    let quickly = if quick { " --quick" } else { "" };
    let text = format!(
        "# Continuity and energy

```sh
cargo run --release -p touchoff-bench --bin continuity --{quickly} --seed {seed}
```

{}",
        page(&measured)?
    );
    std::fs::write(to.join("continuity.md"), text)?;
    eprintln!("{} s", start.elapsed().as_secs());
    match measured.missed().len() {
        0 => Ok(()),
        count => Err(format!("{count} bars were missed").into()),
    }
}

fn tools() -> [&'static dyn Tool; 3] {
    let of = |name: &str| tools_library::find(name).expect("a tool of the library");
    [of("Fig73"), of("Fig73Exact"), &Fig73Smooth]
}

/// The rows of all paths, laws and tools, and the plot around the worst of the thesis's tool.
fn stepped(part: &Part, count: usize, to: &File) -> Result<Vec<steps::Row>, Box<dyn Error>> {
    let look = if count > 100_000 { Look::Stations(20_000) } else { Look::All };
    let mut asked = Vec::new();
    for path in Path::ALL {
        for law in LAWS {
            asked.extend(tools().map(|tool| (path, law, tool)));
        }
    }
    let rows = asked.par_iter().with_max_len(1);
    let rows = rows.map(|(path, law, tool)| steps::row(part, *tool, *path, *law, look));
    let rows: Vec<steps::Row> = rows.collect();
    let share = |row: &steps::Row| row.force.force / row.peaks[0];
    let thesis = rows.iter().filter(|row| row.tool == "Fig73" && row.law == Law::Thesis);
    if let Some(worst) = thesis.max_by(|a, b| share(a).total_cmp(&share(b))) {
        let (path, law, at) = (worst.path, worst.law, worst.force.at);
        let around = tools()
            .map(|tool| (tool.card().name.to_string(), steps::around(part, tool, path, law, at)));
        let title = format!("Force on the path {}, {law} law, {count} points", path.name());
        let file = to.join(format!("continuity-{count}.svg"));
        std::fs::write(file, plot(&title, around.into()).svg())?;
    }
    Ok(rows)
}

/// The work of all tools round all loops.
fn worked(points: usize, seed: u64, quick: bool) -> Result<Vec<energy::Row>, Box<dyn Error>> {
    let part = Part::from_mesh(&block(), points, seed)?;
    let mut tools: Vec<&dyn Tool> = tools_library::TOOLS.to_vec();
    tools.push(&Fig73Smooth);
    tools.sort_by_key(|tool| tool.card().name.to_string());
    let within = [if quick { 1e-7 } else { 2e-9 }, 1e-6];
    let asked: Vec<_> = tools.iter().flat_map(|tool| Kind::ALL.map(|kind| (*tool, kind))).collect();
    let rows = asked.par_iter().with_max_len(1).filter_map(|(tool, kind)| {
        let row = energy::row(&part, *tool, *kind, within);
        if row.is_none() {
            eprintln!("{} cannot be brought to the block, {}", tool.card().name, kind.name());
        }
        row
    });
    Ok(rows.collect())
}
