//! `touchoff sweep`: a part and tools, every triangle in every direction.

use super::{Share, percent, usual};
use crate::arguments::ParamArguments;
use crate::arguments::postures::Sweep as Wanted;
use crate::failure::Failure;
use crate::files::{Found, length};
use crate::output::{Output, refuse_inputs};
use crate::part;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;
use touchoff::certify::TriangleBvh;
use touchoff::postures::sweep::{Batch, PostureSweep, SweepStats};
use touchoff::postures::{Directions, MapIdentity, MapRow, PostureMap, Rules};
use touchoff::{Mesh, Tool, Unit};

/// Summary of a sweep.
#[derive(Serialize)]
struct Summary {
    triangles: usize,
    directions: usize,
    tools: Vec<OfTool>,
    /// True if the inside of the part is known; otherwise only its surface was checked.
    inside_known: bool,
    /// Number of triangles with an acceptable posture.
    reached: usize,
    /// Their share of the part's area.
    area: f64,
    /// Number of batches that an earlier sweep had done.
    before: usize,
    batches: usize,
    seconds: f64,
    tally: SweepStatsRow,
}

/// Number of postures of this run by outcome.
#[derive(Serialize)]
struct SweepStatsRow {
    postures: u64,
    facing: u64,
    plain: u64,
    known: u64,
    found: u64,
    undecided: u64,
    acceptable: u64,
}

#[derive(Serialize)]
struct OfTool {
    name: String,
    /// Number of triangles that the tool reaches.
    reached: usize,
    /// Number of triangles at which it has the best posture.
    best: usize,
    /// Least stick-out, in the part's unit: the smallest and the largest over the triangles.
    stickout: Option<[f64; 2]>,
}

/// Counts, collected row by row.
struct Count {
    /// Per triangle, true if it has a posture.
    reached: Vec<bool>,
    tools: Vec<OfTool>,
}

impl Count {
    fn new(mesh: &Mesh, tools: &[&dyn Tool]) -> Count {
        let none = |tool: &&dyn Tool| OfTool {
            name: tool.info().name.to_string(),
            reached: 0,
            best: 0,
            stickout: None,
        };
        Count {
            reached: vec![false; mesh.triangles().len()],
            tools: tools.iter().map(none).collect(),
        }
    }

    fn add(&mut self, triangle: u32, row: &MapRow) {
        if let Some(best) = row.best.first() {
            self.reached[triangle as usize] = true;
            self.tools[usize::from(best.tool)].best += 1;
        }
        for access in &row.access {
            let tool = &mut self.tools[usize::from(access.tool)];
            tool.reached += usize::from(access.directions.iter().any(|word| *word != 0));
            if let Some(stickout) = access.stickout {
                let [least, most] = tool.stickout.unwrap_or([stickout; 2]);
                tool.stickout = Some([least.min(stickout), most.max(stickout)]);
            }
        }
    }
}

/// Sweeps a part with tools, and prints a summary.
pub(crate) fn sweep(wanted: &Wanted, json: bool) -> Result<(), Failure> {
    let inputs = wanted.tools.iter().map(Path::new).chain([&*wanted.mesh.part]);
    refuse_inputs(wanted.out.as_deref(), inputs)?;
    let nothing = ParamArguments::default();
    let found: Vec<Found> =
        wanted.tools.iter().map(|name| Found::find(name, &nothing)).collect::<Result<_, _>>()?;
    let tools: Vec<&dyn Tool> = found.iter().map(Found::tool).collect();
    let unit = wanted.mesh.unit;
    let mesh = part::mesh(&wanted.mesh.part, unit, "sweep")?;
    let bvh = TriangleBvh::new(&mesh);
    part::has_inside(&bvh, &wanted.mesh.part, wanted.surface_only)?;
    let rules = Rules {
        tolerance: wanted.tolerance.unwrap_or_else(|| usual(unit)),
        niceness: wanted.niceness,
        allowed: wanted.allow.clone(),
    };
    let directions = Directions::spread(wanted.directions.into());
    let sweep =
        PostureSweep::new((&mesh, &bvh), tools.clone(), &directions, rules.clone(), wanted.keep)?;
    let map = match &wanted.out {
        Some(file) => {
            let identity = MapIdentity::new(&mesh, &tools, rules)?
                .with_directions(directions.list().to_vec())
                .with_keep(wanted.keep);
            Some(PostureMap::open(file, &identity)?)
        }
        None => None,
    };
    let mut count = Count::new(&mesh, &tools);
    let open = left(&sweep, map.as_ref())?;
    let bar = bar(open.len());
    let start = Instant::now();
    let mut tally = SweepStats::default();
    let stopped = sweep.run(&open, |batch: Batch| {
        tally += batch.stats;
        bar.inc(1);
        match &map {
            Some(map) => {
                if let Err(error) = map.record(&batch.rows) {
                    return ControlFlow::Break(error);
                }
            }
            None => batch.rows.iter().for_each(|(id, row)| count.add(*id, row)),
        }
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    if let ControlFlow::Break(error) = stopped {
        return Err(error.into());
    }
    let seconds = start.elapsed().as_secs_f64();
    if let Some(map) = &map {
        for entry in map.rows()? {
            let (triangle, row) = entry?;
            count.add(triangle, &row);
        }
    }
    let all = Share::of_all(&mesh, |_| true);
    let reached = Share::of_all(&mesh, |triangle| count.reached[triangle as usize]);
    let summary = Summary {
        triangles: mesh.triangles().len(),
        directions: directions.list().len(),
        inside_known: bvh.has_inside(),
        reached: reached.triangles,
        area: reached.area / all.area,
        tools: count.tools,
        before: sweep.batches() - open.len(),
        batches: sweep.batches(),
        seconds,
        tally: SweepStatsRow {
            postures: tally.postures(),
            facing: tally.not_facing,
            plain: tally.below_niceness,
            known: tally.cached_obstruction,
            found: tally.obstructed,
            undecided: tally.undecided,
            acceptable: tally.acceptable,
        },
    };
    let mut out = Output::lines();
    if json {
        serde_json::to_writer(&mut out, &summary)?;
        writeln!(out)?;
    } else {
        summary.print(&mut out, unit, &reached.of(all))?;
    }
    out.flush()?;
    Ok(())
}

/// Returns the batches that are not in the map.
fn left(sweep: &PostureSweep<'_>, map: Option<&PostureMap>) -> Result<Vec<usize>, Failure> {
    let Some(map) = map else { return Ok((0..sweep.batches()).collect()) };
    let swept = map.swept()?;
    let is_open = |batch: &usize| sweep.triangles(*batch).iter().any(|id| !swept.contains(id));
    Ok((0..sweep.batches()).filter(is_open).collect())
}

fn bar(batches: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{wide_bar} {percent} %, {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(batches as u64).with_style(style)
}

impl Summary {
    fn print(&self, out: &mut impl Write, unit: Unit, reached: &str) -> std::io::Result<()> {
        let Summary { triangles, directions, tally, seconds, .. } = self;
        if self.before > 0 {
            writeln!(out, "{} of {} batches were there already", self.before, self.batches)?;
        }
        let tools = self.tools.len();
        writeln!(
            out,
            "{triangles} triangles, {directions} directions, {tools} tools: {} postures in {seconds:.1} s",
            tally.postures
        )?;
        let rules = [
            (tally.facing, "nothing that cuts faces the triangle"),
            (tally.plain, "not nice enough"),
            (tally.known, "in the way is what was in a neighbour's"),
            (tally.found, "searched for, and something is in the way"),
            (tally.undecided, "rounding decides: not taken"),
            (tally.acceptable, "proved acceptable"),
        ];
        for (count, words) in rules.into_iter().filter(|(count, _)| *count > 0) {
            let part = percent(count as f64, tally.postures as f64);
            writeln!(out, "{count:>12} {part:>7}  {words}")?;
        }
        let known = if self.inside_known {
            ""
        } else {
            ", by the surface alone: what is inside is unknown"
        };
        writeln!(out, "reached: {reached}{known}")?;
        for tool in &self.tools {
            let stickout = tool.stickout.map_or(String::new(), |[least, most]| {
                let [least, most] = [least, most].map(|value| length(value, unit));
                format!("; sticks out at least {least} to {most}")
            });
            let OfTool { name, reached, best, .. } = tool;
            writeln!(out, "  {name:<20} reaches {reached:>7}, best at {best:>7}{stickout}")?;
        }
        Ok(())
    }
}
