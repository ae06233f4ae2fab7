//! `touchoff sweep`: a part and tools, every triangle in every direction, and pieces of triangles with `--refine`, round by
//! round.

use super::touched;
use crate::arguments::postures::Sweep;
use crate::failure::Failure;
use crate::loaded_tool::LoadedTool;
use crate::output::{Output, refuse_inputs};
use crate::part;
use crate::progress::Progress;
use serde::Serialize;
use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;
use touchoff::certify::TriangleBvh;
use touchoff::{Mesh, Tool, TriangleId, Unit};
use touchoff_postures::sweep::{
    BATCH_TRIANGLES, Batch, PieceBatch, PostureSweep, Refinement, Refiner, SweepStats,
};
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
struct RefinementSummary {
    /// Longest edge of pieces that differ from their neighbours.
    finest: f64,
    triangles_divided: usize,
    /// Number of their pieces.
    pieces: usize,
    /// Number of triangles of which only some pieces are reached.
    triangles_partly_reached: usize,
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

impl PostureCounts {
    fn of(stats: &SweepStats) -> PostureCounts {
        PostureCounts {
            total: stats.postures(),
            not_facing: stats.not_facing,
            below_niceness: stats.below_niceness,
            cached_obstruction: stats.cached_obstruction,
            obstructed: stats.obstructed,
            undecided: stats.undecided,
            acceptable: stats.acceptable,
        }
    }
}

#[derive(Serialize)]
struct ToolSummary {
    name: String,
    /// Number of triangles that the tool reaches.
    triangles_reached: usize,
    /// Number of triangles at which it has the best posture.
    triangles_best: usize,
    /// Least stick-out: the smallest and the largest over the triangles.
    stick_out: Option<[f64; 2]>,
}

/// Counts, collected row by row.
struct Count<'a> {
    /// Per triangle, the fraction of its area that is reached.
    reached: Vec<f64>,
    tools: Vec<ToolSummary>,
    /// Takes the rows too, if triangles are to be divided.
    refiner: Option<Refiner<'a>>,
}

impl<'a> Count<'a> {
    fn new(mesh: &Mesh, tools: &[&dyn Tool], refiner: Option<Refiner<'a>>) -> Count<'a> {
        let tools = tools.iter().map(|tool| ToolSummary {
            name: tool.info().name.to_string(),
            triangles_reached: 0,
            triangles_best: 0,
            stick_out: None,
        });
        Count { reached: vec![0.0; mesh.triangles().len()], tools: tools.collect(), refiner }
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
        if let Some(refiner) = &mut self.refiner {
            refiner.add(Piece::whole(triangle), row);
        }
    }

    /// Includes the stick-outs of a row.
    fn add_stickout(&mut self, row: &MapRow) {
        for access in &row.access {
            let tool = &mut self.tools[usize::from(access.tool)];
            if let Some(stickout) = access.stickout {
                let [least, most] = tool.stick_out.unwrap_or([stickout; 2]);
                tool.stick_out = Some([least.min(stickout), most.max(stickout)]);
            }
        }
    }

    /// Replaces the counts of triangles by those of their pieces.
    fn refine(&mut self, refiner: &Refiner<'_>, finest: f64) -> RefinementSummary {
        for tool in &mut self.tools {
            (tool.triangles_reached, tool.triangles_best) = (0, 0);
        }
        let mut summary = RefinementSummary {
            finest,
            triangles_divided: 0,
            pieces: 0,
            triangles_partly_reached: 0,
        };
        for reach in refiner.reach() {
            self.reached[reach.triangle.index()] = reach.area_fraction;
            for (tool, fraction) in self.tools.iter_mut().zip(&reach.by_tool) {
                tool.triangles_reached += usize::from(*fraction > 0.0);
            }
            if let Some(best) = reach.best {
                self.tools[usize::from(best)].triangles_best += 1;
            }
            if reach.pieces > 1 {
                summary.triangles_divided += 1;
                summary.pieces += reach.pieces;
            }
            let is_partial = reach.area_fraction > 0.0 && reach.area_fraction < 1.0;
            summary.triangles_partly_reached += usize::from(is_partial);
        }
        summary
    }
}

/// A sweep and the map of its rows.
struct SweepRun<'a> {
    sweep: &'a PostureSweep<'a>,
    map: Option<&'a PostureMap>,
    json: bool,
}

impl SweepRun<'_> {
    /// Judges the triangles of some batches, and counts them with those that are in the map already.
    ///
    /// # Errors
    /// If the map cannot be read or written.
    fn judge_triangles(
        &self,
        batches: &[usize],
        count: &mut Count<'_>,
    ) -> Result<SweepStats, Failure> {
        let mut stats = SweepStats::default();
        let progress = Progress::steps(batches.len(), "batches", self.json);
        let stopped = self.sweep.run(batches, |batch: Batch| {
            stats += batch.stats;
            progress.advance(1);
            // With a map the rows are read from it at the end, together with those of earlier sweeps.
            match self.map {
                Some(map) => {
                    if let Err(error) = map.record(&batch.rows) {
                        return ControlFlow::Break(error);
                    }
                }
                None => batch.rows.iter().for_each(|(id, row)| count.add(*id, row)),
            }
            ControlFlow::Continue(())
        });
        // Cleared before anything is printed.
        drop(progress);
        if let ControlFlow::Break(error) = stopped {
            return Err(error.into());
        }
        if let Some(map) = self.map {
            for entry in map.rows()? {
                let (triangle, row) = entry?;
                count.add(triangle, &row);
            }
        }
        Ok(stats)
    }

    /// Judges pieces until the refiner, which has the rows of all triangles, asks for no more.
    ///
    /// # Errors
    /// If there are too many pieces, or the map cannot be read or written.
    fn judge_pieces(
        &self,
        refiner: &mut Refiner<'_>,
        count: &mut Count<'_>,
    ) -> Result<SweepStats, Failure> {
        let mut known = self.map.map(PostureMap::piece_rows).transpose()?.unwrap_or_default();
        let mut stats = SweepStats::default();
        loop {
            let pieces = refiner.next_pieces()?;
            if pieces.is_empty() {
                return Ok(stats);
            }
            // A batch is in the map as a whole or not at all.
            let mut open = Vec::new();
            for (index, batch) in pieces.chunks(BATCH_TRIANGLES).enumerate() {
                if batch.iter().all(|piece| known.contains_key(piece)) {
                    for (piece, row) in batch.iter().filter_map(|piece| known.remove_entry(piece)) {
                        count.add_stickout(&row);
                        refiner.add(piece, &row);
                    }
                } else {
                    open.push(index);
                }
            }
            let progress = Progress::steps(open.len(), "batches of pieces", self.json);
            let stopped = self.sweep.run_pieces(&pieces, &open, |batch: PieceBatch| {
                stats += batch.stats;
                progress.advance(1);
                if let Some(Err(error)) = self.map.map(|map| map.record_pieces(&batch.rows)) {
                    return ControlFlow::Break(error);
                }
                for (piece, row) in &batch.rows {
                    count.add_stickout(row);
                    refiner.add(*piece, row);
                }
                ControlFlow::Continue(())
            });
            drop(progress);
            if let ControlFlow::Break(error) = stopped {
                return Err(error.into());
            }
        }
    }
}

/// Formats a fraction in percent; 0 % of an empty whole.
fn percent(amount: f64, whole: f64) -> String {
    format!("{:.1} %", if whole > 0.0 { 100.0 * amount / whole } else { 0.0 })
}

/// A number of triangles, and an area.
#[derive(Clone, Copy, Default)]
struct TriangleTotals {
    triangles: usize,
    /// In the square of the mesh's unit.
    area: f64,
}

impl TriangleTotals {
    /// Counts the triangles of which a fraction above 0 belongs to a set, and adds up the area of the set.
    fn count(mesh: &Mesh, fraction: impl Fn(TriangleId) -> f64) -> TriangleTotals {
        mesh.ids().fold(TriangleTotals::default(), |totals, id| TriangleTotals {
            triangles: totals.triangles + usize::from(fraction(id) > 0.0),
            area: totals.area + fraction(id) * mesh.area(id),
        })
    }

    /// Formats these totals as percentages of `all`.
    fn percent_of(self, all: TriangleTotals) -> String {
        let triangles = percent(self.triangles as f64, all.triangles as f64);
        format!("{triangles} of the triangles, {} of the area", percent(self.area, all.area))
    }
}

/// Sweeps a part with tools, and prints a summary.
pub(crate) fn sweep(arguments: &Sweep, json: bool) -> Result<(), Failure> {
    let inputs = arguments.tools.iter().map(Path::new).chain([&*arguments.mesh.part]);
    let inputs = inputs.chain(arguments.params.library.as_deref());
    let inputs = inputs.chain(arguments.touched.as_deref());
    refuse_inputs(arguments.output.as_deref(), inputs)?;
    let loaded = arguments.tools.iter().map(|name| LoadedTool::load(name, &arguments.params));
    let loaded: Vec<LoadedTool> = loaded.collect::<Result<_, _>>()?;
    let tools: Vec<&dyn Tool> = loaded.iter().map(LoadedTool::tool).collect();
    let unit = arguments.mesh.unit;
    let mesh = part::mesh(&arguments.mesh.part, unit, "sweep")?;
    let bvh = TriangleBvh::new(&mesh);
    part::require_inside(&bvh, &arguments.mesh.part, arguments.surface_only)?;
    let rules = Rules {
        tolerance: arguments.tolerance.unwrap_or_else(|| Rules::default_tolerance(unit)),
        niceness: arguments.min_niceness,
        allowed: arguments.allow.clone(),
    };
    let directions = Directions::spread(arguments.directions.into());
    let sweep =
        PostureSweep::new(&mesh, &bvh, tools.clone(), &directions, rules.clone(), arguments.keep)?;
    let identity = MapIdentity::new(&mesh, &tools, rules)?
        .with_directions(directions.list().to_vec())
        .with_keep(arguments.keep);
    if let Some((shard, file)) = arguments.shard.zip(arguments.output.as_deref()) {
        return super::shard::sweep(&sweep, &mesh, &identity, shard, file, json);
    }
    let map = match &arguments.output {
        Some(file) => Some(PostureMap::open(file, &identity)?),
        None => None,
    };
    if let Some((file, map)) = arguments.touched.as_ref().zip(map.as_ref()) {
        return touched::record(file, map, &mesh, &bvh, &tools, json);
    }
    let refinement = arguments.refine.map(|finest| match finest {
        Some(finest) => Refinement::down_to(finest),
        None => Refinement::of_tools(&tools, unit),
    });
    let refiner = refinement.map(|how| Refiner::new(&mesh, tools.len(), how)).transpose()?;
    let mut count = Count::new(&mesh, &tools, refiner);
    let open = open_batches(&sweep, map.as_ref())?;
    let start = Instant::now();
    let run = SweepRun { sweep: &sweep, map: map.as_ref(), json };
    let mut stats = run.judge_triangles(&open, &mut count)?;
    let refinement = match count.refiner.take().zip(refinement) {
        Some((mut refiner, Refinement { finest, .. })) => {
            stats += run.judge_pieces(&mut refiner, &mut count)?;
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
        postures: PostureCounts::of(&stats),
    };
    let mut out = Output::lines();
    if json {
        out.json(&summary)?;
    } else {
        summary.print(&mut out, unit, &reached.percent_of(all))?;
    }
    Ok(out.flush()?)
}

/// Returns the batches that are not in the map.
fn open_batches(sweep: &PostureSweep<'_>, map: Option<&PostureMap>) -> Result<Vec<usize>, Failure> {
    let Some(map) = map else { return Ok((0..sweep.batches()).collect()) };
    let swept = map.swept()?;
    let open = (0..sweep.batches())
        .filter(|batch| sweep.triangles(*batch).iter().any(|id| !swept.contains(id)));
    Ok(open.collect())
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

#[cfg(test)]
mod tests {
    use super::percent;

    #[test]
    fn nothing_is_no_percentage_of_nothing() {
        assert_eq!(percent(0.0, 0.0), "0.0 %");
        assert_eq!(percent(3.0, 0.0), "0.0 %");
        assert_eq!(percent(1.0, 8.0), "12.5 %");
    }
}
