//! Table 7.1 of Ho (1999): the thesis's tool along a tube, measured here.

use crate::failure::Failure;
use crate::output::Output;
use crate::timing::{Timing, nanoseconds};
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use std::io::Write;
use std::time::Instant;
use tools_library::Fig73;
use touchoff::scenes::{POSES, ScenePath, tube};
use touchoff::{Cloud, Part, Pose, Probe};

/// The thesis's values of a row: contacts (average and maximum) and query time (average, µs) on a 250 MHz R10000.
struct Printed {
    points: usize,
    outside: (f64, u32, f64),
    inside: (f64, u32, f64),
}

const TABLE_7_1: [Printed; 4] = [
    Printed { points: 1_000, outside: (1.86, 7, 453.7), inside: (3.98, 8, 466.3) },
    Printed { points: 5_000, outside: (4.50, 15, 544.4), inside: (4.32, 14, 618.4) },
    Printed { points: 10_000, outside: (7.83, 25, 694.7), inside: (13.42, 41, 887.3) },
    Printed { points: 20_000, outside: (11.8, 88, 954.4), inside: (23.5, 65, 1382.3) },
];

#[derive(Serialize)]
struct Row {
    points: usize,
    path: &'static str,
    poses: usize,
    colliding_avg: f64,
    colliding_max: usize,
    ns_avg: f64,
    ns_p50: u64,
    ns_p99: u64,
    ns_max: u64,
}

/// Measures and prints the table.
pub(crate) fn demo(json: bool) -> Result<(), Failure> {
    let mut out = Output::lines();
    let mesh = tube();
    let progress = ProgressBar::new((TABLE_7_1.len() * 2 * POSES) as u64);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} poses {msg}") {
        progress.set_style(style);
    }
    let mut rows = Vec::new();
    for printed in &TABLE_7_1 {
        let part = Part::from_cloud(&Cloud::uniform(&mesh, printed.points, 1)?);
        for (path, thesis) in
            [(ScenePath::Outside, &printed.outside), (ScenePath::Inside, &printed.inside)]
        {
            progress.set_message(format!("{} points, {}", printed.points, path.name()));
            let row = measure(&part, path, &progress);
            if json {
                serde_json::to_writer(&mut out, &row)?;
                writeln!(out)?;
            }
            rows.push((row, thesis));
        }
    }
    progress.finish_and_clear();
    if !json {
        table(&mut out, &rows)?;
    }
    out.flush()?;
    Ok(())
}

fn measure(part: &Part, path: ScenePath, progress: &ProgressBar) -> Row {
    let poses: Vec<Pose> = (0..POSES).map(|k| path.pose(k, POSES)).collect();
    let mut probe = Probe::new(part, &Fig73);
    // Warm-up: the first queries allocate their memory.
    for pose in poses.iter().step_by(POSES / 100) {
        probe.wrench(pose);
    }
    let mut times = Vec::with_capacity(POSES);
    let (mut sum, mut most) = (0, 0);
    for (done, pose) in poses.iter().enumerate() {
        let start = Instant::now();
        let evaluation = probe.wrench(pose);
        times.push(nanoseconds(start.elapsed()));
        sum += evaluation.colliding;
        most = most.max(evaluation.colliding);
        if done % 1_000 == 999 {
            progress.inc(1_000);
        }
    }
    let timing = Timing::of(&mut times);
    Row {
        points: part.tree().len(),
        path: path.name(),
        poses: POSES,
        colliding_avg: sum as f64 / POSES as f64,
        colliding_max: most,
        ns_avg: timing.avg,
        ns_p50: timing.p50,
        ns_p99: timing.p99,
        ns_max: timing.max,
    }
}

fn table(out: &mut impl Write, rows: &[(Row, &(f64, u32, f64))]) -> std::io::Result<()> {
    writeln!(out, "Ho (1999), table 7.1: the tool of fig. 7.3 along a tube, {POSES} poses a row.")?;
    writeln!(out, "Each query finds all colliding points, force, torque and niceness.\n")?;
    writeln!(
        out,
        "                 |      colliding, avg (max)     |            time a query, µs"
    )?;
    writeln!(
        out,
        " points  path    |      here        thesis 1999  |   avg    p50    p99   thesis   ratio"
    )?;
    writeln!(
        out,
        "-----------------+-------------------------------+-------------------------------------"
    )?;
    for (row, (thesis_avg, thesis_max, thesis_us)) in rows {
        let us = |ns: f64| ns / 1e3;
        let here = format!("{:.2} ({})", row.colliding_avg, row.colliding_max);
        let there = format!("{thesis_avg:.2} ({thesis_max})");
        writeln!(
            out,
            "{:>7}  {:<7} | {here:>13} {there:>15} | {:>6.2} {:>6.2} {:>6.2} {thesis_us:>8.1} {:>7.0}",
            row.points,
            row.path,
            us(row.ns_avg),
            us(row.ns_p50 as f64),
            us(row.ns_p99 as f64),
            thesis_us / us(row.ns_avg),
        )?;
    }
    writeln!(
        out,
        "\nThe thesis ran on a 250 MHz R10000; its paths are not published, these are of the same kind."
    )
}
