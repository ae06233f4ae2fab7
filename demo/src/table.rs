//! Table 7.1 of Ho (1999): the thesis's tool along a tube, measured on this machine.

use std::error::Error;
use std::time::Instant;
use touchoff::scenes::{POSES, ScenePath, tube};
use touchoff::{Cloud, Law, Part, Pose, Probe, Sampling};

touchoff::include_tool!("../tools-library/tools/fig_7_3.tool");

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

/// Contacts and times measured on a path.
struct Measured {
    contacts_mean: f64,
    contacts_max: usize,
    /// Times of the queries in µs, ascending.
    times: Vec<f64>,
}

/// Measures and prints the table.
pub(crate) fn measure() -> Result<(), Box<dyn Error>> {
    println!("Ho (1999), table 7.1: the tool of fig. 7.3 along a tube, {POSES} poses a row.");
    println!("Each query finds all contacts, force, torque and niceness.\n");
    println!("                 |      contacts, mean (max)     |            time a query, µs");
    println!(
        " points  path    |      here        thesis 1999  |  mean    p50    p99   thesis   ratio"
    );
    println!(
        "-----------------+-------------------------------+-------------------------------------"
    );
    let mesh = tube();
    for printed in &TABLE_7_1 {
        let part = Part::from_cloud(&Cloud::sample(&mesh, Sampling::monte_carlo(printed.points))?);
        let paths = [(ScenePath::Outside, &printed.outside), (ScenePath::Inside, &printed.inside)];
        for (path, thesis) in paths {
            print_row(printed.points, path, &along(&part, path), thesis);
        }
    }
    println!(
        "\nThe thesis ran on a 250 MHz R10000; its paths are not published, these are of the same kind."
    );
    Ok(())
}

/// Queries every pose of a path.
fn along(part: &Part, path: ScenePath) -> Measured {
    let poses: Vec<Pose> = (0..POSES).map(|k| path.pose(k, POSES)).collect();
    let mut probe = Probe::new(part, &Fig73).with_law(Law::Thesis);
    // Warm-up: the first queries allocate their memory.
    for pose in poses.iter().step_by(POSES / 100) {
        probe.wrench(pose);
    }
    let mut times = Vec::with_capacity(POSES);
    let (mut sum, mut max) = (0, 0);
    for pose in &poses {
        let start = Instant::now();
        let wrench = probe.wrench(pose);
        times.push(1e6 * start.elapsed().as_secs_f64());
        sum += wrench.colliding;
        max = max.max(wrench.colliding);
    }
    times.sort_unstable_by(f64::total_cmp);
    Measured { contacts_mean: sum as f64 / POSES as f64, contacts_max: max, times }
}

fn print_row(points: usize, path: ScenePath, measured: &Measured, thesis: &ThesisValues) {
    let times = &measured.times;
    let mean = times.iter().sum::<f64>() / times.len() as f64;
    let p50 = times[times.len() / 2];
    let p99 = times[times.len() * 99 / 100];
    let here = format!("{:.2} ({})", measured.contacts_mean, measured.contacts_max);
    let there = format!("{:.2} ({})", thesis.contacts_mean, thesis.contacts_max);
    println!(
        "{points:>7}  {:<7} | {here:>13} {there:>15} | {mean:>6.2} {p50:>6.2} {p99:>6.2} {:>8.1} {:>7.0}",
        path.name(),
        thesis.query_time_us,
        thesis.query_time_us / mean,
    );
}
