//! Table 7.1 of Ho (1999): the thesis's tool along a tube, measured here.

use crate::failure::Failure;
use crate::output::Output;
use crate::progress::Progress;
use crate::timing::{Timing, nanoseconds};
use serde::Serialize;
use std::io::Write;
use std::time::Instant;
use tools_library::Fig73;
use touchoff::scenes::{POSES, ScenePath, tube};
use touchoff::{Cloud, Part, Pose, Probe, Sampling};

/// The thesis's values for a path: contacts at a pose, and the mean time of a query in µs on a 250 MHz R10000.
struct ThesisValues {
    contacts_mean: f64,
    contacts_max: u32,
    query_time_us: f64,
}

/// The thesis's values for a number of points.
struct Printed {
    points: usize,
    outside: ThesisValues,
    inside: ThesisValues,
}

const TABLE_7_1: [Printed; 4] = [
    Printed {
        points: 1_000,
        outside: ThesisValues { contacts_mean: 1.86, contacts_max: 7, query_time_us: 453.7 },
        inside: ThesisValues { contacts_mean: 3.98, contacts_max: 8, query_time_us: 466.3 },
    },
    Printed {
        points: 5_000,
        outside: ThesisValues { contacts_mean: 4.50, contacts_max: 15, query_time_us: 544.4 },
        inside: ThesisValues { contacts_mean: 4.32, contacts_max: 14, query_time_us: 618.4 },
    },
    Printed {
        points: 10_000,
        outside: ThesisValues { contacts_mean: 7.83, contacts_max: 25, query_time_us: 694.7 },
        inside: ThesisValues { contacts_mean: 13.42, contacts_max: 41, query_time_us: 887.3 },
    },
    Printed {
        points: 20_000,
        outside: ThesisValues { contacts_mean: 11.8, contacts_max: 88, query_time_us: 954.4 },
        inside: ThesisValues { contacts_mean: 23.5, contacts_max: 65, query_time_us: 1382.3 },
    },
];

#[derive(Serialize)]
struct Row {
    points: usize,
    path: &'static str,
    poses: usize,
    contacts_mean: f64,
    contacts_max: usize,
    query_time_ns: Timing,
}

/// Measures and prints the table.
pub(crate) fn demo(json: bool) -> Result<(), Failure> {
    let mut out = Output::lines();
    let mesh = tube();
    let progress = Progress::steps(TABLE_7_1.len() * 2 * POSES, "poses", json);
    let mut rows = Vec::new();
    for printed in &TABLE_7_1 {
        let part = Part::from_cloud(&Cloud::sample(&mesh, Sampling::monte_carlo(printed.points))?);
        for (path, thesis) in
            [(ScenePath::Outside, &printed.outside), (ScenePath::Inside, &printed.inside)]
        {
            progress.describe(format!("{} points, {}", printed.points, path.name()));
            let row = measure(&part, path, &progress);
            if json {
                serde_json::to_writer(&mut out, &row)?;
                writeln!(out)?;
            }
            rows.push((row, thesis));
        }
    }
    drop(progress);
    if !json {
        table(&mut out, &rows)?;
    }
    out.flush()?;
    Ok(())
}

/// Measures the queries of one path.
fn measure(part: &Part, path: ScenePath, progress: &Progress) -> Row {
    let poses: Vec<Pose> = (0..POSES).map(|k| path.pose(k, POSES)).collect();
    let mut probe = Probe::new(part, &Fig73);
    // Warm-up: the first queries allocate their memory.
    for pose in poses.iter().step_by(POSES / 100) {
        probe.wrench(pose);
    }
    let mut times = Vec::with_capacity(POSES);
    let (mut sum, mut max) = (0, 0);
    for (index, pose) in poses.iter().enumerate() {
        let start = Instant::now();
        let evaluation = probe.wrench(pose);
        times.push(nanoseconds(start.elapsed()));
        sum += evaluation.colliding;
        max = max.max(evaluation.colliding);
        if index % 1_000 == 999 {
            progress.advance(1_000);
        }
    }
    Row {
        points: part.tree().len(),
        path: path.name(),
        poses: POSES,
        contacts_mean: sum as f64 / POSES as f64,
        contacts_max: max,
        query_time_ns: Timing::of(&mut times),
    }
}

fn table(out: &mut impl Write, rows: &[(Row, &ThesisValues)]) -> std::io::Result<()> {
    writeln!(out, "Ho (1999), table 7.1: the tool of fig. 7.3 along a tube, {POSES} poses a row.")?;
    writeln!(out, "Each query finds all contacts, force, torque and niceness.\n")?;
    writeln!(
        out,
        "                 |      contacts, mean (max)     |            time a query, µs"
    )?;
    writeln!(
        out,
        " points  path    |      here        thesis 1999  |  mean    p50    p99   thesis   ratio"
    )?;
    writeln!(
        out,
        "-----------------+-------------------------------+-------------------------------------"
    )?;
    for (row, thesis) in rows {
        let us = |ns: f64| ns / 1e3;
        let times = &row.query_time_ns;
        let here = format!("{:.2} ({})", row.contacts_mean, row.contacts_max);
        let there = format!("{:.2} ({})", thesis.contacts_mean, thesis.contacts_max);
        writeln!(
            out,
            "{:>7}  {:<7} | {here:>13} {there:>15} | {:>6.2} {:>6.2} {:>6.2} {:>8.1} {:>7.0}",
            row.points,
            row.path,
            us(times.mean),
            us(times.p50 as f64),
            us(times.p99 as f64),
            thesis.query_time_us,
            thesis.query_time_us / us(times.mean),
        )?;
    }
    writeln!(
        out,
        "\nThe thesis ran on a 250 MHz R10000; its paths are not published, these are of the same kind."
    )
}
