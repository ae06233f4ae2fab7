//! The page `levels.md`: what a budget of nodes costs and what it misses; what changing a part on line costs, and how much
//! slower it is felt after; how long a saved part takes to open.

use clap::Args;
use nalgebra::{Point3, Vector3};
use std::error::Error;
use std::fmt::Write;
use std::time::Instant;
use tools_library::Fig73;
use touchoff::scenes::{Path, tube};
use touchoff::{Cloud, Graded, Law, Part, Pose, Probe, Wrench};
use touchoff_bench::page::Page;

const POSES: usize = 10_000;
const POINTS: usize = 1_000_000;
const PATHS: [Path; 3] = [Path::Outside, Path::Inside, Path::Hold];

/// Measures levels of detail under a budget of nodes, parts that change, and parts that are saved.
#[derive(Args)]
pub(crate) struct Levels {}

impl Levels {
    pub(crate) fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        let mesh = tube();
        let (part, built) = timed(|| Part::detailed(&mesh, POINTS, 1));
        let part = part?;
        let mut body = format!(
            "The tool of fig. 7.3 along the tube, {POSES} poses a path, one core.

## A budget of nodes

{POINTS} points and their coarser levels, made in {built:.1} s. The force's error is against the finest level, rms over the path, by the typical force; `unseen` is the bound of what lies between the points. What the force is off by has the way over to a new level in it: 32 of these poses.

| path | budget | nodes, most | levels | µs, average | µs, p99 | force off by | depth off by, at most, mm | unseen, worst, mm |
|---|--:|--:|---|--:|--:|--:|--:|--:|
"
        );
        for path in PATHS {
            eprintln!("{}", path.name());
            let poses: Vec<Pose> = (0..POSES).map(|k| path.pose(k, POSES)).collect();
            let mut probe = Probe::new(&part, &Fig73).law(Law::Gradient);
            let wanted: Vec<Wrench> = poses.iter().map(|pose| probe.wrench(pose)).collect();
            for budget in [100, 300, 1_000, 3_000, 100_000] {
                body += &budgeted(&part, path, budget, (&poses, &wanted))?;
            }
        }
        body += "\n## Changes\n\n| points | what | takes | for comparison |\n|--:|---|--:|---|\n";
        for points in [20_000, 200_000, POINTS] {
            eprintln!("changes of {points} points");
            changes(&mut body, points)?;
        }
        body += "\n## Saved parts\n\n";
        body += &saved(&part)?;
        Ok(Some(Page {
            name: "levels",
            title: "Levels of detail, parts that change, saved parts".to_owned(),
            covers: &["runtime/src", "tool-dsl/src", "tools-library/tools"],
            body,
            figures: Vec::new(),
            missed: Vec::new(),
        }))
    }
}

/// Measures the times of saving and opening a part, its file in the system's cache.
fn saved(part: &Part) -> Result<String, Box<dyn Error>> {
    const OPENED: usize = 51;
    let file = std::env::temp_dir().join(format!("levels-{}.touchoff", std::process::id()));
    let (done, seconds) = timed(|| part.save(&file));
    done?;
    let bytes = std::fs::metadata(&file)?.len();
    let mut times = Vec::new();
    for _ in 0..OPENED {
        let (opened, seconds) = timed(|| Part::open(&file));
        assert_eq!(opened?.tree().len(), POINTS);
        times.push(1e3 * seconds);
    }
    times.sort_unstable_by(f64::total_cmp);
    std::fs::remove_file(&file)?;
    Ok(format!(
        "{POINTS} points and their coarser levels, {:.1} MB: saved in {:.0} ms; opened {OPENED} times, every checksum compared, in {:.2} ms (median), {:.2} ms at most.",
        bytes as f64 / 1e6,
        1e3 * seconds,
        times[OPENED / 2],
        times[OPENED - 1],
    ))
}

fn budgeted(
    part: &Part,
    path: Path,
    budget: usize,
    (poses, wanted): (&[Pose], &[Wrench]),
) -> Result<String, Box<dyn Error>> {
    let mut graded = Graded::new(part, &Fig73, budget, Law::Gradient)?;
    for pose in poses.iter().take(500) {
        graded.wrench(pose);
    }
    let (mut times, mut felt) = (Vec::with_capacity(POSES), Vec::with_capacity(POSES));
    for pose in poses {
        let start = Instant::now();
        felt.push(graded.wrench(pose));
        times.push(start.elapsed().as_nanos() as u64);
    }
    times.sort_unstable();
    let average = times.iter().sum::<u64>() as f64 / POSES as f64 / 1e3;
    let rms = |squares: f64| (squares / POSES as f64).sqrt();
    let typical = rms(wanted.iter().map(|w| w.force.norm_squared()).sum());
    let pairs = || felt.iter().zip(wanted);
    let off = rms(pairs().map(|(a, b)| (a.wrench.force - b.force).norm_squared()).sum()) / typical;
    let depth = pairs().map(|(a, b)| (a.wrench.depth() - b.depth()).abs()).fold(0.0, f64::max);
    let unseen = felt.iter().filter_map(|f| f.unseen).fold(0.0, f64::max);
    let most = felt.iter().map(|f| f.nodes).max().unwrap_or_default();
    let levels: Vec<String> = (0..8)
        .map(|level| (level, felt.iter().filter(|f| f.level == level).count()))
        .filter(|(_, count)| *count > 0)
        .map(|(level, count)| format!("{level}: {:.0} %", 100.0 * count as f64 / POSES as f64))
        .collect();
    Ok(format!(
        "| {} | {budget} | {most} | {} | {average:.2} | {:.2} | {off:.1e} | {depth:.4} | {unseen:.3} |\n",
        path.name(),
        levels.join(", "),
        times[POSES * 99 / 100] as f64 / 1e3,
    ))
}

fn changes(page: &mut String, points: usize) -> Result<(), Box<dyn Error>> {
    let cloud = Cloud::random(&tube(), points, 1)?.weighed(&tube());
    let (part, built) = timed(|| Part::from_cloud(&cloud));
    let built = format!("the tree anew: {:.2} ms", 1e3 * built);
    // The cutter goes through the rim.
    let poses: Vec<Pose> = (0..1_000).map(|k| Path::Hold.pose(k, 1_000)).collect();
    let mut cut = part.clone();
    let (taken, seconds) = timed(|| poses.iter().map(|pose| cut.cut(&Fig73, pose)).sum::<usize>());
    writeln!(
        page,
        "| {points} | cut along 1,000 poses, {taken} points gone | {:.1} µs a pose | {built} |",
        1e3 * seconds,
    )?;
    let kept: Vec<usize> = (0..cloud.len()).filter(|i| !cut.tree().point(*i).x.is_nan()).collect();
    let tree = cut.tree();
    let fresh = Part::from_cloud(&Cloud::new(
        kept.iter().map(|i| tree.point(*i)).collect(),
        kept.iter().map(|i| tree.normal(*i).into()).collect(),
        kept.iter().map(|i| tree.triangle(*i)).collect(),
        kept.iter().map(|i| tree.weight(*i)).collect(),
        cut.unit(),
    )?);
    writeln!(
        page,
        "| {points} | felt after the cut | {} | {} of a new tree |",
        query(&cut),
        query(&fresh)
    )?;
    for bend in [0.001, 0.01] {
        let to = |p: Point3<f64>, n: Vector3<f64>| (bent(&p, bend), n);
        let mut moved = part.clone();
        let (done, seconds) = timed(|| moved.displace(to));
        done?;
        writeln!(
            page,
            "| {points} | bent by {:.1} mm at the top | {:.2} ms | {built} |",
            bend * 13.116f64.powi(2),
            1e3 * seconds,
        )?;
        let places = cloud.points().iter().map(|p| bent(p, bend)).collect();
        let (normals, ids) = (cloud.normals().to_vec(), cloud.triangles().to_vec());
        let weights = cloud.weights().to_vec();
        let fresh = Part::from_cloud(&Cloud::new(places, normals, ids, weights, cloud.unit())?);
        writeln!(
            page,
            "| {points} | felt after | {} | {} of a new tree |",
            query(&moved),
            query(&fresh)
        )?;
    }
    Ok(())
}

fn bent(p: &Point3<f64>, bend: f64) -> Point3<f64> {
    Point3::new(p.x + bend * p.z * p.z, p.y, p.z)
}

fn timed<R>(make: impl FnOnce() -> R) -> (R, f64) {
    let start = Instant::now();
    let made = make();
    (made, start.elapsed().as_secs_f64())
}

/// Measures the time of a query along the outside: the best of five passes.
fn query(part: &Part) -> String {
    let poses: Vec<Pose> = (0..POSES).map(|k| Path::Outside.pose(k, POSES)).collect();
    let mut probe = Probe::new(part, &Fig73);
    let mut best = f64::INFINITY;
    for _ in 0..5 {
        let (_, seconds) =
            timed(|| poses.iter().map(|pose| probe.wrench(pose).depth()).sum::<f64>());
        best = best.min(seconds);
    }
    format!("{:.3} µs a query", 1e6 * best / POSES as f64)
}
