//! Sweeps and posture maps.

use crate::error::{reading, refused};
use crate::part::{Part, rows};
use crate::pool::on_all_cores;
use crate::tool::Tool;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::convert::Infallible;
use std::num::{NonZeroU16, NonZeroUsize};
use std::ops::{ControlFlow, Range};
use std::path::PathBuf;
use touchoff::certify::TriangleBvh;
use touchoff::{Shard, TriangleId, Unit, cancellation};
use touchoff_postures::shard::{self, Merge, ShardError, is_done, shard_bytes};
use touchoff_postures::sweep::{PostureSweep, SweepError, SweepStats};
use touchoff_postures::{Accessibility, Directions, MapIdentity, MapRow, PostureMap, Rules};

/// The largest table of triangles, tools and directions, in bytes.
const MAX_ENTRIES: usize = 4 << 30;

/// A triangle's index, and its row.
type TriangleRow = (usize, MapRow);

/// Tries tools at every triangle of a part, from many directions.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub(crate) fn sweep<'py>(
    py: Python<'py>,
    part: &Part,
    tools: Vec<PyRef<'py, Tool>>,
    directions: usize,
    tolerance: Option<f64>,
    min_niceness: f64,
    allow: Vec<(String, f64)>,
    surface_only: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let directions = spread(py, directions)?;
    let tools: Vec<&Tool> = tools.iter().map(|tool| &**tool).collect();
    check_size(part.mesh()?.triangles().len(), tools.len(), directions.list().len())?;
    let (mesh, bvh) = (part.mesh()?, part.triangles(py)?);
    if !surface_only {
        part.require_inside(py)?;
    }
    let rules = rules(mesh.unit(), tolerance, min_niceness, allow);
    let swept = on_all_cores(py, || {
        let tools = tools.iter().map(|tool| tool.get() as &dyn touchoff::Tool).collect();
        let sweep = PostureSweep::new(mesh, bvh, tools, &directions, rules, NonZeroU16::MIN)?;
        let (rows, stats) = run(&sweep, 0..sweep.batches());
        let rows = rows.into_iter().map(|(id, row)| (id.index(), row)).collect();
        Ok::<_, SweepError>((rows, stats))
    })?;
    let (rows, stats) = swept.map_err(refused)?;
    let count = mesh.triangles().len();
    let names = tools.iter().map(|tool| tool.get().info().name.to_string()).collect();
    let dict = Map { count, tools: names, directions, rows }.arrays(py)?;
    dict.set_item("postures", stats.postures())?;
    dict.set_item("acceptable", stats.acceptable)?;
    dict.set_item("undecided", stats.undecided)?;
    Ok(dict)
}

/// Runs batches of a sweep.
fn run(sweep: &PostureSweep<'_>, batches: Range<usize>) -> (Vec<(TriangleId, MapRow)>, SweepStats) {
    let batches: Vec<usize> = batches.collect();
    let (mut rows, mut stats) = (Vec::new(), SweepStats::default());
    let flow: ControlFlow<Infallible> = sweep.run(&batches, |batch| {
        stats += batch.stats;
        rows.extend(batch.rows);
        ControlFlow::Continue(())
    });
    let ControlFlow::Continue(()) = flow;
    (rows, stats)
}

/// A sweep whose shards are computed one by one, here or elsewhere.
#[pyclass(frozen, module = "touchoff._touchoff")]
pub(crate) struct Study {
    part: Py<Part>,
    tools: Vec<Py<Tool>>,
    directions: Directions,
    rules: Rules,
    identity: MapIdentity,
}

#[pymethods]
impl Study {
    #[new]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        part: Py<Part>,
        tools: Vec<Py<Tool>>,
        directions: usize,
        tolerance: Option<f64>,
        min_niceness: f64,
        allow: Vec<(String, f64)>,
        surface_only: bool,
    ) -> PyResult<Study> {
        let directions = spread(py, directions)?;
        let mesh = part.get().mesh()?;
        if !surface_only {
            part.get().require_inside(py)?;
        }
        let rules = rules(mesh.unit(), tolerance, min_niceness, allow);
        let listed: Vec<_> = tools.iter().map(|tool| tool.get().get()).collect();
        let identity = on_all_cores(py, || MapIdentity::new(mesh, &listed, rules.clone()))?;
        let identity = identity.map_err(refused)?.with_directions(directions.list().to_vec());
        let study = Study { part, tools, directions, rules, identity };
        // Errors of the sweep are raised here, and not by each shard.
        let bvh = study.part.get().triangles(py)?;
        on_all_cores(py, || study.swept(bvh).map(drop))?.map_err(refused)?;
        Ok(study)
    }

    /// Returns the bytes of a shard, from 1 to `count`.
    fn shard<'py>(
        &self,
        py: Python<'py>,
        number: u32,
        count: u32,
        threads: usize,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let shard = shard(number, count)?;
        let threads =
            NonZeroUsize::new(threads).ok_or_else(|| refused("threads: give 1 or more"))?;
        let part = self.part.get();
        let (mesh, bvh) = (part.mesh()?, part.triangles(py)?);
        let bytes = on_all_cores(py, || {
            let sweep = self.swept(bvh)?.with_threads(threads);
            let (rows, _) = run(&sweep, shard.range(sweep.batches()));
            Ok::<_, SweepError>(shard_bytes(mesh, &self.identity, shard, rows))
        })?;
        Ok(PyBytes::new(py, &bytes.map_err(refused)?))
    }

    /// Returns whether a file has a shard of this sweep, complete.
    fn is_done(&self, py: Python<'_>, path: PathBuf, number: u32, count: u32) -> PyResult<bool> {
        let shard = shard(number, count)?;
        on_all_cores(py, || is_done(path, &self.identity, shard))?.map_err(shard_error)
    }
}

impl Study {
    fn swept<'a>(&'a self, bvh: &'a TriangleBvh) -> Result<PostureSweep<'a>, SweepError> {
        let mesh = self.part.get().mesh.as_ref().expect("a study is made of a part with a mesh");
        let tools = self.tools.iter().map(|tool| tool.get().get() as &dyn touchoff::Tool).collect();
        let rules = self.rules.clone();
        PostureSweep::new(mesh, bvh, tools, &self.directions, rules, NonZeroU16::MIN)
    }
}

fn shard(number: u32, count: u32) -> PyResult<Shard> {
    Shard::new(number, count)
        .ok_or_else(|| refused(format!("{number}/{count}: there is no such shard")))
}

fn shard_error(error: ShardError) -> PyErr {
    reading(error)
}

/// Writes the bytes of a shard to a file, completely or not at all.
#[pyfunction]
pub(crate) fn write_shard(py: Python<'_>, path: PathBuf, bytes: &[u8]) -> PyResult<()> {
    on_all_cores(py, || shard::write_shard(path, bytes))?.map_err(shard_error)
}

/// Joins shards to a table, and returns its number of triangles.
#[pyfunction]
pub(crate) fn merge_shards(py: Python<'_>, files: Vec<PathBuf>, table: PathBuf) -> PyResult<u32> {
    let merged = on_all_cores(py, || {
        let mut merge = Merge::new();
        for file in files {
            cancellation::check();
            merge.add(file)?;
        }
        let merged = merge.finish()?;
        merged.write_table(table)?;
        Ok(merged.identity().part.triangles)
    })?;
    merged.map_err(shard_error)
}

/// Returns directions, given their number per hemisphere.
fn spread(py: Python<'_>, hemisphere: usize) -> PyResult<Directions> {
    if (1..=Directions::MAX_HEMISPHERE).contains(&hemisphere) {
        return on_all_cores(py, || Directions::spread(hemisphere));
    }
    let limit = Directions::MAX_HEMISPHERE;
    Err(refused(format!("directions: {hemisphere} per hemisphere: give 1 to {limit}")))
}

/// Returns the rules of a sweep.
fn rules(unit: Unit, tolerance: Option<f64>, niceness: f64, allowed: Vec<(String, f64)>) -> Rules {
    let tolerance = tolerance.unwrap_or_else(|| Rules::default_tolerance(unit));
    Rules { tolerance, niceness, allowed }
}

/// Reads a posture map.
#[pyfunction]
pub(crate) fn read_map(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let read = on_all_cores(py, || {
        let map = PostureMap::read(&path)?;
        let identity = map.identity();
        let keep = identity.keep;
        let mut rows = Vec::new();
        map.for_each_triangle(|triangle, pieces| {
            cancellation::check();
            rows.push((triangle.index(), MapRow::joined(&pieces, keep)));
            Ok::<(), touchoff_postures::MapError>(())
        })?;
        Ok::<_, touchoff_postures::MapError>(Map {
            count: identity.part.triangles as usize,
            tools: identity.tools.iter().map(|tool| tool.name.clone()).collect(),
            directions: Directions::from(identity.directions.clone()),
            rows,
        })
    })?;
    read.map_err(reading)?.arrays(py)
}

/// Refuses a table that is longer than the limit.
fn check_size(count: usize, tools: usize, directions: usize) -> PyResult<()> {
    if count.saturating_mul(tools).saturating_mul(directions) <= MAX_ENTRIES {
        return Ok(());
    }
    Err(refused(format!(
        "the table of {count} triangles, {tools} tools and {directions} directions is longer than {MAX_ENTRIES} entries: take \
         fewer tools or directions at a time"
    )))
}

struct Map {
    /// The number of triangles.
    count: usize,
    tools: Vec<String>,
    directions: Directions,
    rows: Vec<TriangleRow>,
}

impl Map {
    /// Returns the arrays: per triangle and tool the directions that reach it, and per triangle the best posture.
    fn arrays(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let Map { count, tools, directions, rows: found } = self;
        let (tool_count, direction_count) = (tools.len(), directions.list().len());
        check_size(count, tool_count, direction_count)?;
        let mut reached = vec![false; count * tool_count * direction_count];
        let mut stickout = vec![f64::NAN; count * tool_count];
        let mut best_tool = vec![-1i64; count];
        let (mut tips, mut axes) = (vec![[f64::NAN; 3]; count], vec![[f64::NAN; 3]; count]);
        let [mut niceness, mut depth, mut clearance] = [(); 3].map(|()| vec![f64::NAN; count]);
        for (triangle, row) in &found {
            for Accessibility { tool, directions: set, stickout: needed } in &row.access {
                let at = triangle * tool_count + usize::from(*tool);
                if let Some(needed) = needed {
                    stickout[at] = *needed;
                }
                let of_tool = &mut reached[at * direction_count..(at + 1) * direction_count];
                for (direction, is_reached) in of_tool.iter_mut().enumerate() {
                    let word = set.get(direction / 64).copied().unwrap_or(0);
                    *is_reached = word >> (direction % 64) & 1 == 1;
                }
            }
            if let Some(best) = row.best.first() {
                best_tool[*triangle] = i64::from(best.tool);
                (tips[*triangle], axes[*triangle]) = (best.tip, best.axis);
                niceness[*triangle] = best.niceness;
                depth[*triangle] = best.depth;
                clearance[*triangle] = best.clearance;
            }
        }
        let dict = PyDict::new(py);
        let flat = |vectors: &[[f64; 3]]| rows(py, vectors.as_flattened().to_vec(), 3);
        let shape = [count, tool_count, direction_count];
        dict.set_item("tools", tools)?;
        dict.set_item("directions", flat(directions.list())?)?;
        dict.set_item("reached", PyArray1::from_vec(py, reached).reshape(shape)?)?;
        dict.set_item("stickout", rows(py, stickout, tool_count)?)?;
        dict.set_item("tool", PyArray1::from_vec(py, best_tool))?;
        dict.set_item("tip", flat(&tips)?)?;
        dict.set_item("axis", flat(&axes)?)?;
        dict.set_item("niceness", PyArray1::from_vec(py, niceness))?;
        dict.set_item("depth", PyArray1::from_vec(py, depth))?;
        dict.set_item("clearance", PyArray1::from_vec(py, clearance))?;
        Ok(dict)
    }
}
