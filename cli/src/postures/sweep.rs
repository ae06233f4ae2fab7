//! `touchoff sweep`: a part and tools, every triangle in every direction, and pieces of triangles with `--refine`.

use super::{TriangleTotals, default_tolerance, percent, refine, touched};
use crate::arguments::postures::Sweep;
use crate::failure::Failure;
use crate::loaded_tool::LoadedTool;
use crate::output::{Output, refuse_inputs};
use crate::part;
use crate::progress::Progress;
use serde::Serialize;
use std::ffi::OsString;
use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;
use touchoff::certify::TriangleBvh;
use touchoff::{Mesh, Tool, TriangleId, Unit};
use touchoff_postures::sweep::{Batch, PostureSweep, Refinement, Refiner, SweepStats};
use touchoff_postures::{Directions, MapIdentity, MapRow, Piece, PostureMap, Rules};

/// Summary of a sweep.
#[derive(Serialize)]
struct Summary {
    triangles: usize,
    /// Unit of lengths.
    unit: &'static str,
    directions: usize,
    tools: Vec<ToolSummary>,
    /// True if the inside of the part is known; otherwise only its surface was checked.
    inside_known: bool,
    /// Number of triangles with an acceptable posture.
    triangles_reached: usize,
    /// Their fraction of the part's area; of divided triangles, that of the pieces.
    area_fraction_reached: f64,
    /// The division into pieces, with `--refine`.
    refinement: Option<RefinementSummary>,
    batches: usize,
    /// Number of batches that an earlier sweep had done.
    earlier_batches: usize,
    time_s: f64,
    postures: PostureCounts,
}

/// Summary of the pieces of triangles.
#[derive(Serialize)]
pub(super) struct RefinementSummary {
    /// Longest edge of pieces that differ from their neighbours.
    pub(super) finest: f64,
    pub(super) triangles_divided: usize,
    /// Number of their pieces.
    pub(super) pieces: usize,
    /// Number of triangles of which only some pieces are reached.
    pub(super) triangles_partly_reached: usize,
}

/// Number of postures of this run by outcome.
#[derive(Serialize)]
struct PostureCounts {
    total: u64,
    not_facing: u64,
    below_niceness: u64,
    cached_obstruction: u64,
    obstructed: u64,
    undecided: u64,
    acceptable: u64,
}

#[derive(Serialize)]
pub(super) struct ToolSummary {
    name: String,
    /// Number of triangles that the tool reaches.
    pub(super) triangles_reached: usize,
    /// Number of triangles at which it has the best posture.
    pub(super) triangles_best: usize,
    /// Least stick-out: the smallest and the largest over the triangles.
    stick_out: Option<[f64; 2]>,
}

/// Counts, collected row by row.
pub(super) struct Count {
    /// Per triangle, the fraction of its area that is reached.
    pub(super) reached: Vec<f64>,
    pub(super) tools: Vec<ToolSummary>,
}

impl Count {
    fn new(mesh: &Mesh, tools: &[&dyn Tool]) -> Count {
        let none = |tool: &&dyn Tool| ToolSummary {
            name: tool.info().name.to_string(),
            triangles_reached: 0,
            triangles_best: 0,
            stick_out: None,
        };
        Count {
            reached: vec![0.0; mesh.triangles().len()],
            tools: tools.iter().map(none).collect(),
        }
    }

    fn add(&mut self, triangle: TriangleId, row: &MapRow) {
        if let Some(best) = row.best.first() {
            self.reached[triangle.index()] = 1.0;
            self.tools[usize::from(best.tool)].triangles_best += 1;
        }
        for access in &row.access {
            let tool = &mut self.tools[usize::from(access.tool)];
            tool.triangles_reached += usize::from(access.is_reached());
        }
        self.add_stickout(row);
    }

    /// Includes the stick-outs of a row.
    pub(super) fn add_stickout(&mut self, row: &MapRow) {
        for access in &row.access {
            let tool = &mut self.tools[usize::from(access.tool)];
            if let Some(stickout) = access.stickout {
                let [least, most] = tool.stick_out.unwrap_or([stickout; 2]);
                tool.stick_out = Some([least.min(stickout), most.max(stickout)]);
            }
        }
    }
}

/// Sweeps a part with tools, and prints a summary.
pub(crate) fn sweep(arguments: &Sweep, json: bool) -> Result<(), Failure> {
    let inputs = arguments.tools.iter().map(Path::new).chain([&*arguments.mesh.part]);
    let inputs = inputs.chain(arguments.touched.as_deref());
    refuse_inputs(arguments.output.as_deref(), inputs)?;
    let load = |name: &OsString| LoadedTool::load(name, &arguments.params);
    let loaded: Vec<LoadedTool> = arguments.tools.iter().map(load).collect::<Result<_, _>>()?;
    let tools: Vec<&dyn Tool> = loaded.iter().map(LoadedTool::tool).collect();
    let unit = arguments.mesh.unit;
    let mesh = part::mesh(&arguments.mesh.part, unit, "sweep")?;
    let bvh = TriangleBvh::new(&mesh);
    part::require_inside(&bvh, &arguments.mesh.part, arguments.surface_only)?;
    let rules = Rules {
        tolerance: arguments.tolerance.unwrap_or_else(|| default_tolerance(unit)),
        niceness: arguments.min_niceness,
        allowed: arguments.allow.clone(),
    };
    let directions = Directions::spread(arguments.directions.into());
    let sweep =
        PostureSweep::new(&mesh, &bvh, tools.clone(), &directions, rules.clone(), arguments.keep)?;
    let map = match &arguments.output {
        Some(file) => {
            let identity = MapIdentity::new(&mesh, &tools, rules)?
                .with_directions(directions.list().to_vec())
                .with_keep(arguments.keep);
            Some(PostureMap::open(file, &identity)?)
        }
        None => None,
    };
    if let Some((file, map)) = arguments.touched.as_ref().zip(map.as_ref()) {
        return touched::record(file, map, &mesh, &bvh, &tools, json);
    }
    let mut count = Count::new(&mesh, &tools);
    let refinement = arguments.refine.map(|finest| match finest {
        Some(finest) => Refinement::down_to(finest),
        None => Refinement::of_tools(&tools, unit),
    });
    let refiner = refinement.map(|how| Refiner::new(&mesh, tools.len(), how)).transpose()?;
    let mut refiner = refiner.zip(refinement);
    let open = open_batches(&sweep, map.as_ref())?;
    let progress = Progress::steps(open.len(), "batches", json);
    let start = Instant::now();
    let mut stats = SweepStats::default();
    let mut add = |triangle: TriangleId, row: &MapRow| {
        count.add(triangle, row);
        if let Some((refiner, _)) = &mut refiner {
            refiner.add(Piece::whole(triangle), row);
        }
    };
    let stopped = sweep.run(&open, |batch: Batch| {
        stats += batch.stats;
        progress.advance(1);
        match &map {
            Some(map) => {
                if let Err(error) = map.record(&batch.rows) {
                    return ControlFlow::Break(error);
                }
            }
            None => batch.rows.iter().for_each(|(id, row)| add(*id, row)),
        }
        ControlFlow::Continue(())
    });
    drop(progress);
    if let ControlFlow::Break(error) = stopped {
        return Err(error.into());
    }
    if let Some(map) = &map {
        for entry in map.rows()? {
            let (triangle, row) = entry?;
            add(triangle, &row);
        }
    }
    let refinement = match refiner {
        Some((mut refiner, Refinement { finest, .. })) => {
            let pieces = refine::Pieces { sweep: &sweep, map: map.as_ref(), json };
            stats += pieces.judge(&mut refiner, &mut count)?;
            Some(count.refine(&refiner, finest))
        }
        None => None,
    };
    let time_s = start.elapsed().as_secs_f64();
    let all = TriangleTotals::count(&mesh, |_| 1.0);
    let reached = TriangleTotals::count(&mesh, |triangle| count.reached[triangle.index()]);
    let summary = Summary {
        triangles: mesh.triangles().len(),
        unit: unit.symbol(),
        directions: directions.list().len(),
        inside_known: bvh.has_inside(),
        triangles_reached: reached.triangles,
        area_fraction_reached: reached.area / all.area,
        refinement,
        tools: count.tools,
        earlier_batches: sweep.batches() - open.len(),
        batches: sweep.batches(),
        time_s,
        postures: PostureCounts {
            total: stats.postures(),
            not_facing: stats.not_facing,
            below_niceness: stats.below_niceness,
            cached_obstruction: stats.cached_obstruction,
            obstructed: stats.obstructed,
            undecided: stats.undecided,
            acceptable: stats.acceptable,
        },
    };
    let mut out = Output::lines();
    if json {
        serde_json::to_writer(&mut out, &summary)?;
        writeln!(out)?;
    } else {
        summary.print(&mut out, unit, &reached.percent_of(all))?;
    }
    out.flush()?;
    Ok(())
}

/// Returns the batches that are not in the map.
fn open_batches(sweep: &PostureSweep<'_>, map: Option<&PostureMap>) -> Result<Vec<usize>, Failure> {
    let Some(map) = map else { return Ok((0..sweep.batches()).collect()) };
    let swept = map.swept()?;
    let is_open = |batch: &usize| sweep.triangles(*batch).iter().any(|id| !swept.contains(id));
    Ok((0..sweep.batches()).filter(is_open).collect())
}

impl Summary {
    fn print(&self, out: &mut impl Write, unit: Unit, reached: &str) -> std::io::Result<()> {
        let Summary { triangles, directions, postures, time_s, .. } = self;
        if self.earlier_batches > 0 {
            writeln!(
                out,
                "{} of {} batches were in the map already",
                self.earlier_batches, self.batches
            )?;
        }
        let tools = self.tools.len();
        writeln!(
            out,
            "{triangles} triangles, {directions} directions, {tools} tool{}: {} postures in {time_s:.1} s",
            if tools == 1 { "" } else { "s" },
            postures.total
        )?;
        let rules = [
            (postures.not_facing, "no cutting surface faces the triangle"),
            (postures.below_niceness, "below the least niceness"),
            (postures.cached_obstruction, "obstructed like a neighbour"),
            (postures.obstructed, "obstructed, found by a search"),
            (postures.undecided, "not decided because of rounding, so not accepted"),
            (postures.acceptable, "proved acceptable"),
        ];
        for (count, words) in rules.into_iter().filter(|(count, _)| *count > 0) {
            let fraction = percent(count as f64, postures.total as f64);
            writeln!(out, "{count:>12} {fraction:>7}  {words}")?;
        }
        let known = if self.inside_known {
            ""
        } else {
            ", from the surface alone, as the inside is unknown"
        };
        writeln!(out, "reached: {reached}{known}")?;
        if let Some(refinement) = &self.refinement {
            let RefinementSummary {
                finest,
                triangles_divided,
                pieces,
                triangles_partly_reached,
                ..
            } = refinement;
            writeln!(
                out,
                "divided: {triangles_divided} triangles into {pieces} pieces, down to {}; {triangles_partly_reached} \
                 are reached in part",
                unit.format(*finest)
            )?;
        }
        for tool in &self.tools {
            let stickout = tool.stick_out.map_or(String::new(), |[least, most]| {
                let [least, most] = [least, most].map(|value| unit.format(value));
                format!("; least stick-out {least} to {most}")
            });
            let ToolSummary { name, triangles_reached, triangles_best, .. } = tool;
            writeln!(
                out,
                "  {name:<20} reaches {triangles_reached:>7}, best at {triangles_best:>7}{stickout}"
            )?;
        }
        Ok(())
    }
}
