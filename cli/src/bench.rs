//! `touchoff bench`: run time against error of one part, tool and path. Clouds of more and more points are compared
//! with certified depths of the triangles, and with a cloud of more points than any of them.

use crate::arguments::Bench;
use crate::failure::Failure;
use crate::loaded_tool::LoadedTool;
use crate::output::Output;
use crate::program;
use crate::progress::Progress;
use nalgebra::Vector3;
use serde::Serialize;
use std::io::Write;
use std::path::Path;
use std::time::Instant;
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff::mesh::Geometry;
use touchoff::scenes::{ScenePath, tube};
use touchoff::{Cloud, Interval, Mesh, Part, Pose, Probe, Sampling, Tool, Unit, Wrench};

/// Sizes of the clouds, and of the reference cloud for forces and torques.
const POINTS: [usize; 6] = [1_000, 3_000, 10_000, 30_000, 100_000, 300_000];
const REFERENCE: usize = 1_000_000;
/// Number of these sizes in a quick run, and its reference.
const QUICK: usize = 3;
const QUICK_REFERENCE: usize = 100_000;
/// Tolerances of certified depth, as fractions of the tool's length or diameter, whichever is larger.
const TOLERANCES: [f64; 3] = [1e-3, 1e-6, 1e-9];
/// Largest number of poses, to which a longer path is thinned.
const POSES: usize = 1_000;

/// A part, a tool, and the poses of the queries.
struct Case<'t> {
    mesh: Mesh,
    tool: &'t dyn Tool,
    poses: Vec<Pose>,
}

/// The wrench at every pose, the sorted times of the queries in ns, and the stated bound on errors of depth.
struct QueryResults {
    wrenches: Vec<Wrench>,
    times: Vec<u64>,
    bound: Option<f64>,
}

/// The measurements of a method: queries on a cloud, or certified depth.
#[derive(Debug, Serialize)]
struct Row {
    method: &'static str,
    /// Number of points of the cloud.
    points: Option<usize>,
    /// The tolerance of certified depth, in the part's unit.
    tolerance: Option<f64>,
    /// Unit of lengths.
    unit: &'static str,
    query_time_ns: QueryTimes,
    /// Errors of force and torque: root mean squares over the poses, relative to those of the reference.
    force_error: Option<f64>,
    torque_error: Option<f64>,
    /// The largest error of a depth, or the widest interval, in the part's unit.
    depth_error: Option<f64>,
    /// The bound that the method states for it.
    depth_error_bound: Option<f64>,
}

/// Measures all methods, and prints one row per method.
pub(crate) fn bench(arguments: &Bench, json: bool) -> Result<(), Failure> {
    let loaded = arguments
        .tool
        .as_ref()
        .map(|name| LoadedTool::load(name, &arguments.params))
        .transpose()?;
    if loaded.is_none() && !arguments.params.is_empty() {
        return Err(Failure::UnusedParams("name one with `--tool FILE.tool`"));
    }
    let case = match (&arguments.part, arguments.unit, &loaded, &arguments.program) {
        (Some(part), Some(unit), Some(loaded), Some(program)) => {
            case_of(part, unit, loaded.tool(), program)?
        }
        _ => thesis_case(),
    };
    let (points, reference) = if arguments.quick {
        (&POINTS[..QUICK], QUICK_REFERENCE)
    } else {
        (&POINTS[..], REFERENCE)
    };
    let mut out = Output::lines();
    if !json {
        let (tool, unit) = (&case.tool.info().name, case.mesh.unit());
        writeln!(
            out,
            "{tool} at {} poses, {} triangles",
            case.poses.len(),
            case.mesh.triangles().len()
        )?;
        writeln!(
            out,
            "method          points   tolerance   p50 µs   p99 µs    force   torque  depth ({unit})  bound ({unit})"
        )?;
    }
    let info = case.tool.info();
    let Interval { low, high } = info.reach();
    let size = (high - low).max(2.0 * info.radius()) * info.unit.factor_to(case.mesh.unit());
    let bvh = TriangleBvh::new(&case.mesh);
    let progress = Progress::steps(TOLERANCES.len() + 1 + points.len(), "measurements", json);
    let certified = match Certifier::new(&bvh, case.tool) {
        Ok(mut certifier) => Vec::from(TOLERANCES.map(|part| {
            progress.advance(1);
            certified(&case, &mut certifier, part * size)
        })),
        Err(error) => {
            progress.suspend(|| message!("{error}; depths are compared with the reference cloud"));
            Vec::new()
        }
    };
    let truth = case.wrenches(reference, arguments.seed)?.wrenches;
    progress.advance(1);
    let depths: Vec<f64> = match certified.last() {
        Some((_, depths)) => depths.clone(),
        None => truth.iter().map(Wrench::depth).collect(),
    };
    for count in points {
        let row = case.cloud(*count, arguments.seed, (&truth, &depths))?;
        progress.advance(1);
        progress.suspend(|| print(&mut out, &row, json))?;
    }
    drop(progress);
    for (row, _) in &certified {
        print(&mut out, row, json)?;
    }
    Ok(())
}

/// Returns the tube and the tool of the thesis's figures.
fn thesis_case() -> Case<'static> {
    let poses = (0..POSES).map(|k| ScenePath::Outside.pose(k, POSES)).collect();
    Case { mesh: tube(), tool: &tools_library::Fig73Exact, poses }
}

/// Reads a part and the poses of a program.
fn case_of<'t>(
    part: &Path,
    unit: Unit,
    tool: &'t dyn Tool,
    program: &Path,
) -> Result<Case<'t>, Failure> {
    let program = program::read(program, tool.info(), unit)?;
    let file = part.display().to_string();
    let Geometry::Mesh(mesh) = Geometry::read(part, unit)? else {
        return Err(Failure::NoTriangles { file, what: "touchoff bench" });
    };
    for finding in mesh.diagnostics().findings() {
        message!("{file}: {finding}");
    }
    let step = program.locations.len().div_ceil(POSES).max(1);
    let poses = program.locations.iter().step_by(step).map(|location| location.pose).collect();
    Ok(Case { mesh, tool, poses })
}

impl Case<'_> {
    /// Queries a cloud of `points` points at every pose.
    fn wrenches(&self, points: usize, seed: u64) -> Result<QueryResults, Failure> {
        let part = Part::new(
            &Cloud::sample(&self.mesh, Sampling::new(points).with_seed(seed))?,
            self.mesh.diagnostics(),
        );
        let mut probe = Probe::new(&part, self.tool);
        let (wrenches, times) = timed(&self.poses, |pose| probe.wrench(pose));
        Ok(QueryResults { wrenches, times, bound: probe.sampling_error_bound() })
    }

    /// Measures a cloud against the reference's forces and depths.
    fn cloud(
        &self,
        points: usize,
        seed: u64,
        (truth, depths): (&[Wrench], &[f64]),
    ) -> Result<Row, Failure> {
        let QueryResults { wrenches, times, bound } = self.wrenches(points, seed)?;
        let error = |of: fn(&Wrench) -> Vector3<f64>| {
            let squares = |wrenches: &mut dyn Iterator<Item = Vector3<f64>>| {
                wrenches.map(|part| part.norm_squared()).sum::<f64>()
            };
            let difference = squares(&mut wrenches.iter().zip(truth).map(|(a, b)| of(a) - of(b)));
            let all = squares(&mut truth.iter().map(of));
            (all > 0.0).then(|| (difference / all).sqrt())
        };
        let errors = wrenches.iter().zip(depths).map(|(a, depth)| (a.depth() - depth).abs());
        Ok(Row {
            method: "cloud",
            points: Some(points),
            tolerance: None,
            unit: self.mesh.unit().symbol(),
            query_time_ns: QueryTimes::of(&times),
            force_error: error(|wrench| wrench.force),
            torque_error: error(|wrench| wrench.torque),
            depth_error: Some(errors.fold(0.0, f64::max)),
            depth_error_bound: bound,
        })
    }
}

/// Measures certified depth, and returns the midpoints of its intervals.
fn certified(case: &Case<'_>, certifier: &mut Certifier<'_>, tolerance: f64) -> (Row, Vec<f64>) {
    let (depths, times) = timed(&case.poses, |pose| certifier.deepest(pose, tolerance).depth);
    let row = Row {
        method: "certified",
        points: None,
        tolerance: Some(tolerance),
        unit: case.mesh.unit().symbol(),
        query_time_ns: QueryTimes::of(&times),
        force_error: None,
        torque_error: None,
        depth_error: Some(
            depths.iter().map(|Interval { low, high }| high - low).fold(0.0, f64::max),
        ),
        depth_error_bound: Some(tolerance),
    };
    (row, depths.into_iter().map(|Interval { low, high }| 0.5 * (low + high)).collect())
}

/// Queries every pose once after a warm-up, and returns the answers and the sorted times in ns.
fn timed<R>(poses: &[Pose], mut query: impl FnMut(&Pose) -> R) -> (Vec<R>, Vec<u64>) {
    const WARM: usize = 50;
    for pose in poses.iter().rev().take(WARM) {
        query(pose);
    }
    let mut times = Vec::with_capacity(poses.len());
    let results = poses.iter().map(|pose| {
        let start = Instant::now();
        let result = query(pose);
        times.push(u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX));
        result
    });
    let results = results.collect();
    times.sort_unstable();
    (results, times)
}

/// Times of single queries: median and 99th percentile.
#[derive(Debug, Serialize)]
struct QueryTimes {
    p50: u64,
    p99: u64,
}

impl QueryTimes {
    fn of(sorted: &[u64]) -> QueryTimes {
        QueryTimes { p50: quantile(sorted, 0.5), p99: quantile(sorted, 0.99) }
    }
}

/// Returns a quantile of sorted times; 0 if there are none.
fn quantile(times: &[u64], fraction: f64) -> u64 {
    let last = times.len().saturating_sub(1);
    times.get((fraction * last as f64).round() as usize).copied().unwrap_or_default()
}

fn print(out: &mut Output, row: &Row, json: bool) -> Result<(), Failure> {
    if json {
        serde_json::to_writer(&mut *out, row)?;
        writeln!(out)?;
    } else {
        let text = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
        let percent =
            |error: Option<f64>| text(error.map(|error| format!("{:.2} %", 100.0 * error)));
        let length = |value: Option<f64>| text(value.map(|value| format!("{value:.2e}")));
        writeln!(
            out,
            "{:<12}{:>10}{:>12}{:>9.2}{:>9.2}{:>9}{:>9}{:>12}{:>12}",
            row.method,
            text(row.points.map(|points| points.to_string())),
            length(row.tolerance),
            row.query_time_ns.p50 as f64 / 1e3,
            row.query_time_ns.p99 as f64 / 1e3,
            percent(row.force_error),
            percent(row.torque_error),
            length(row.depth_error),
            length(row.depth_error_bound),
        )?;
    }
    out.flush()?;
    Ok(())
}
