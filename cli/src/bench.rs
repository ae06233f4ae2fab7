//! `touchoff bench`: query time against error for one part, tool and path. Forces and torques of clouds of increasing
//! size are compared with those of a larger reference cloud. Depths are compared with the depths certified to the
//! tightest tolerance, or with the reference cloud if the tool cannot be certified.

use crate::arguments::Bench;
use crate::failure::Failure;
use crate::loaded_tool::LoadedTool;
use crate::output::Output;
use crate::part;
use crate::program;
use crate::progress::Progress;
use nalgebra::Vector3;
use serde::Serialize;
use std::io::Write;
use std::path::Path;
use std::time::Instant;
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff::scenes::{ScenePath, tube};
use touchoff::{Cloud, Interval, Mesh, Part, Pose, Probe, Sampling, Tool, Unit, Wrench};

/// Numbers of points of the measured clouds.
const POINT_COUNTS: [usize; 6] = [1_000, 3_000, 10_000, 30_000, 100_000, 300_000];
/// Number of points of the reference cloud.
const REFERENCE_POINTS: usize = 1_000_000;
/// Number of clouds in a quick run: the first of `POINT_COUNTS`.
const QUICK_CLOUDS: usize = 3;
/// Number of points of the reference cloud in a quick run.
const QUICK_REFERENCE_POINTS: usize = 100_000;
/// Tolerances of certified depth, as fractions of the tool's length or diameter, whichever is larger. From loose to
/// tight: the last gives the reference depths.
const TOLERANCES: [f64; 3] = [1e-3, 1e-6, 1e-9];
/// Largest number of poses. Of a longer path, every n-th is taken, with the least n that suffices.
const MAX_POSES: usize = 1_000;

/// A part, a tool, and the poses of the queries.
struct Case<'t> {
    mesh: Mesh,
    tool: &'t dyn Tool,
    poses: Vec<Pose>,
}

/// The results of a cloud's queries.
struct QueryResults {
    /// The wrench at every pose.
    wrenches: Vec<Wrench>,
    /// The sorted times of the queries in ns.
    times: Vec<u64>,
    /// The sampling error bound, in the part's unit.
    bound: Option<f64>,
}

/// Certified depths at one tolerance.
struct CertifiedResults {
    /// In the part's unit.
    tolerance: f64,
    /// The interval of the depth at every pose, in the part's unit.
    depths: Vec<Interval>,
    /// The sorted times of the queries in ns.
    times: Vec<u64>,
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
    /// The largest difference from the reference depth over all poses, in the part's unit. Of certified depth, that of
    /// the midpoint of the interval: 0 for the tolerance that gives the reference.
    depth_error: Option<f64>,
    /// The sampling error bound of a cloud, the widest interval of certified depth, in the part's unit.
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
            case_from_files(part, unit, loaded.tool(), program)?
        }
        // The argument parser requires all four or none.
        _ => thesis_case(),
    };
    let (point_counts, reference_points) = if arguments.quick {
        (&POINT_COUNTS[..QUICK_CLOUDS], QUICK_REFERENCE_POINTS)
    } else {
        (&POINT_COUNTS[..], REFERENCE_POINTS)
    };
    let mut out = Output::lines();
    if !json {
        let (tool, unit) = (&case.tool.info().name, case.mesh.unit());
        writeln!(
            out,
            "{tool} at {} poses, {} triangles; lengths in {unit}",
            case.poses.len(),
            case.mesh.triangles().len()
        )?;
        writeln!(out, "{}", line(HEADER))?;
    }
    let info = case.tool.info();
    let Interval { low, high } = info.reach();
    let size = (high - low).max(2.0 * info.radius()) * info.unit.factor_to(case.mesh.unit());
    let bvh = TriangleBvh::new(&case.mesh);
    let progress = Progress::steps(TOLERANCES.len() + 1 + point_counts.len(), "measurements", json);
    let certified: Vec<CertifiedResults> = match Certifier::new(&bvh, case.tool) {
        Ok(mut certifier) => Vec::from(TOLERANCES.map(|fraction| {
            let results = case.query_certified(&mut certifier, fraction * size);
            progress.advance(1);
            results
        })),
        Err(error) => {
            progress.suspend(|| message!("{error}; depths are compared with the reference cloud"));
            progress.advance(TOLERANCES.len());
            Vec::new()
        }
    };
    let true_wrenches = case.query_cloud(reference_points, arguments.seed)?.wrenches;
    progress.advance(1);
    let true_depths: Vec<f64> = match certified.last() {
        Some(tightest) => tightest.midpoints().collect(),
        None => true_wrenches.iter().map(Wrench::depth).collect(),
    };
    for count in point_counts {
        let row = case.measure_cloud(*count, arguments.seed, (&true_wrenches, &true_depths))?;
        progress.advance(1);
        progress.suspend(|| print(&mut out, &row, json))?;
    }
    drop(progress);
    for results in &certified {
        print(&mut out, &results.row(case.mesh.unit(), &true_depths), json)?;
    }
    Ok(())
}

/// Returns the tube and the tool of the thesis's figures.
fn thesis_case() -> Case<'static> {
    let poses = (0..MAX_POSES).map(|k| ScenePath::Outside.pose(k, MAX_POSES)).collect();
    Case { mesh: tube(), tool: &tools_library::Fig73Exact, poses }
}

/// Reads a part and the poses of a program.
fn case_from_files<'t>(
    part: &Path,
    unit: Unit,
    tool: &'t dyn Tool,
    program: &Path,
) -> Result<Case<'t>, Failure> {
    let program = program::read(program, tool.info(), unit)?;
    let mesh = part::mesh(part, unit, "touchoff bench")?;
    let step = program.locations.len().div_ceil(MAX_POSES).max(1);
    let poses = program.locations.iter().step_by(step).map(|location| location.pose).collect();
    Ok(Case { mesh, tool, poses })
}

impl Case<'_> {
    /// Queries a cloud of `points` points at every pose.
    fn query_cloud(&self, points: usize, seed: u64) -> Result<QueryResults, Failure> {
        let part = Part::new(
            &Cloud::sample(&self.mesh, Sampling::new(points).with_seed(seed))?,
            self.mesh.diagnostics(),
        );
        let mut probe = Probe::new(&part, self.tool);
        let (wrenches, times) = timed(&self.poses, |pose| probe.wrench(pose));
        Ok(QueryResults { wrenches, times, bound: probe.sampling_error_bound() })
    }

    /// Queries certified depth at every pose.
    fn query_certified(&self, certifier: &mut Certifier<'_>, tolerance: f64) -> CertifiedResults {
        let (depths, times) = timed(&self.poses, |pose| certifier.deepest(pose, tolerance).depth);
        CertifiedResults { tolerance, depths, times }
    }

    /// Measures a cloud against the reference's wrenches and depths.
    fn measure_cloud(
        &self,
        points: usize,
        seed: u64,
        (true_wrenches, true_depths): (&[Wrench], &[f64]),
    ) -> Result<Row, Failure> {
        let QueryResults { wrenches, times, bound } = self.query_cloud(points, seed)?;
        let error = |of: fn(&Wrench) -> Vector3<f64>| {
            let squares = |wrenches: &mut dyn Iterator<Item = Vector3<f64>>| {
                wrenches.map(|vector| vector.norm_squared()).sum::<f64>()
            };
            let difference =
                squares(&mut wrenches.iter().zip(true_wrenches).map(|(a, b)| of(a) - of(b)));
            let all = squares(&mut true_wrenches.iter().map(of));
            (all > 0.0).then(|| (difference / all).sqrt())
        };
        Ok(Row {
            method: "cloud",
            points: Some(points),
            tolerance: None,
            unit: self.mesh.unit().symbol(),
            query_time_ns: QueryTimes::of(&times),
            force_error: error(|wrench| wrench.force),
            torque_error: error(|wrench| wrench.torque),
            depth_error: Some(max_difference(wrenches.iter().map(Wrench::depth), true_depths)),
            depth_error_bound: bound,
        })
    }
}

impl CertifiedResults {
    fn midpoints(&self) -> impl Iterator<Item = f64> {
        self.depths.iter().map(|Interval { low, high }| 0.5 * (low + high))
    }

    fn row(&self, unit: Unit, true_depths: &[f64]) -> Row {
        // The tolerance is no bound: rounding widens the intervals, as do triangles that are thinner than it.
        let widest = self.depths.iter().map(|depth| depth.width()).fold(0.0, f64::max);
        Row {
            method: "certified",
            points: None,
            tolerance: Some(self.tolerance),
            unit: unit.symbol(),
            query_time_ns: QueryTimes::of(&self.times),
            force_error: None,
            torque_error: None,
            depth_error: Some(max_difference(self.midpoints(), true_depths)),
            depth_error_bound: Some(widest),
        }
    }
}

/// Returns the largest difference of a depth from the reference depth at the same pose.
fn max_difference(depths: impl Iterator<Item = f64>, true_depths: &[f64]) -> f64 {
    let differences = depths.zip(true_depths).map(|(depth, true_depth)| (depth - true_depth).abs());
    differences.fold(0.0, f64::max)
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

/// The columns of a printed row. Errors of force and torque are relative; the bound is that of the depth error.
const HEADER: [&str; COLUMNS] = [
    "method",
    "points",
    "tolerance",
    "p50 µs",
    "p99 µs",
    "force error",
    "torque error",
    "depth error",
    "error bound",
];
const COLUMNS: usize = 9;
const COLUMN_WIDTHS: [usize; COLUMNS] = [12, 10, 12, 10, 10, 14, 14, 14, 14];

/// Formats a line of the table: the first column is aligned left, the others right.
fn line(cells: [impl std::fmt::Display; COLUMNS]) -> String {
    let mut cells = cells.into_iter().zip(COLUMN_WIDTHS);
    let first = cells.next().map(|(cell, width)| format!("{cell:<width$}"));
    let others = cells.map(|(cell, width)| format!("{cell:>width$}"));
    first.into_iter().chain(others).collect()
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
        let microseconds = |ns: u64| format!("{:.2}", ns as f64 / 1e3);
        let cells = [
            row.method.to_owned(),
            text(row.points.map(|points| points.to_string())),
            length(row.tolerance),
            microseconds(row.query_time_ns.p50),
            microseconds(row.query_time_ns.p99),
            percent(row.force_error),
            percent(row.torque_error),
            length(row.depth_error),
            length(row.depth_error_bound),
        ];
        writeln!(out, "{}", line(cells))?;
    }
    out.flush()?;
    Ok(())
}
