//! The page `continuity.md` and its plots: steps of the force, work round closed loops, drift of poses.

use clap::Args;
use std::error::Error;
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
use touchoff_bench::page::Page;
use touchoff_bench::parallel;

/// Measures steps of the force, work round closed loops, and the drift of composed poses.
#[derive(Args)]
pub(crate) struct Continuity {
    /// Measures a sample.
    #[arg(long)]
    quick: bool,
    /// Seed of the clouds.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
}

impl Continuity {
    pub(crate) fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        let Continuity { quick, seed } = *self;
        let start = Instant::now();
        let drift = Turn::all()
            .into_iter()
            .map(|turn| drift::row(turn, if quick { 100_000 } else { 10_000_000 }, 97));
        let drift = drift.collect();
        eprintln!("drift: {} s", start.elapsed().as_secs());
        let clouds = if quick { vec![20_000] } else { vec![20_000, 1_000_000] };
        let (mut all, mut figures) = (Vec::new(), Vec::new());
        for count in clouds {
            let part = steps::part(&tube(), count, seed);
            let rows = stepped(&part, count);
            figures.extend(around_the_worst(&part, count, &rows));
            all.push((count, rows));
            eprintln!("{count} points: {} s", start.elapsed().as_secs());
        }
        let points = if quick { 20_000 } else { 1_000_000 };
        let energy = (points, worked(points, seed, quick)?);
        let measured = Measured { steps: all, energy, drift };
        Ok(Some(Page {
            name: "continuity",
            title: "Continuity and energy".to_owned(),
            covers: &["runtime/src", "tool-dsl/src", "tools-library/tools"],
            body: page(&measured)?,
            figures,
            missed: measured.missed(),
        }))
    }
}

fn tools() -> [&'static dyn Tool; 3] {
    let of = |name: &str| tools_library::find(name).expect("a tool of the library");
    [of("Fig73"), of("Fig73Exact"), &Fig73Smooth]
}

/// Returns the rows of all paths, laws and tools.
fn stepped(part: &Part, count: usize) -> Vec<steps::Row> {
    let look = if count > 100_000 { Look::Stations(20_000) } else { Look::All };
    let mut asked = Vec::new();
    for path in Path::ALL {
        for law in LAWS {
            asked.extend(tools().map(|tool| (path, law, tool)));
        }
    }
    parallel::rows(asked.len(), |k| {
        let (path, law, tool) = asked[k];
        steps::row(part, tool, path, law, look)
    })
}

/// Draws the force around the worst step of the thesis's tool and law.
fn around_the_worst(part: &Part, count: usize, rows: &[steps::Row]) -> Option<(String, String)> {
    let share = |row: &steps::Row| row.force.force / row.peaks[0];
    let thesis = rows.iter().filter(|row| row.tool == "Fig73" && row.law == Law::Thesis);
    let worst = thesis.max_by(|a, b| share(a).total_cmp(&share(b)))?;
    let (path, law, at) = (worst.path, worst.law, worst.force.at);
    let around = tools()
        .map(|tool| (tool.card().name.to_string(), steps::around(part, tool, path, law, at)));
    let title = format!("Force on the path {}, {law} law, {count} points", path.name());
    Some((format!("continuity-{count}.svg"), plot(&title, around.into()).svg()))
}

/// The work of all tools round all loops.
fn worked(points: usize, seed: u64, quick: bool) -> Result<Vec<energy::Row>, Box<dyn Error>> {
    let part = Part::from_mesh(&block(), points, seed)?;
    let mut tools: Vec<&dyn Tool> = tools_library::TOOLS.to_vec();
    tools.push(&Fig73Smooth);
    tools.sort_by_key(|tool| tool.card().name.to_string());
    let within = [if quick { 1e-7 } else { 2e-9 }, 1e-6];
    let asked: Vec<_> = tools.iter().flat_map(|tool| Kind::ALL.map(|kind| (*tool, kind))).collect();
    let rows = parallel::rows(asked.len(), |k| {
        let (tool, kind) = asked[k];
        let row = energy::row(&part, tool, kind, within);
        if row.is_none() {
            eprintln!("{} cannot be brought to the block, {}", tool.card().name, kind.name());
        }
        row
    });
    Ok(rows.into_iter().flatten().collect())
}
