//! The page `docs/measured/haptics.md`.

use super::roughness::{Case, ForceStats};
use super::wall::{ENCODER_STEP, Row};
use crate::plot::{Axis, Plot, Series};
use std::fmt::{self, Write};
use touchoff_haptics::{EnergyBalance, LoopReport};

/// The measurements of the page.
pub struct Measurements {
    /// Stability limits of a wall, one row per update rate.
    pub walls: Vec<Row>,
    /// Force roughness: number of points, case and result.
    pub roughness: Vec<(usize, Case<'static>, ForceStats)>,
    /// Description of each rendering with which the sheet was pressed, and the samples: wanted depth in mm, height of
    /// the tip in mm, force in N.
    pub pressing: Vec<(&'static str, Vec<[f64; 3]>)>,
    /// Description of each rendering under a tapping hand, and the energy balance after each cycle.
    pub tapping: Vec<(&'static str, Vec<EnergyBalance>)>,
    /// Cycle rate in Hz, duration in s, and the reports of a pressing hand and of a loop that does nothing.
    pub latency: Vec<(f64, f64, [LoopReport; 2])>,
}

/// Update rate in Hz and stiffness in N/mm of walls that people perceived as rendered cleanly. Source: Choi and Tan,
/// *Effect of update rate on perceived instability of virtual haptic texture*, 2004.
const CLEAN_WALLS: [[f64; 2]; 2] = [[250.0, 0.33], [40_000.0, 0.90]];

/// Returns the plots: file names and SVG contents.
pub fn plots(measured: &Measurements) -> Vec<(&'static str, String)> {
    let limits = |name: &str, value: &dyn Fn(&Row) -> f64| {
        let points = measured.walls.iter().map(|row| [row.rate, value(row)]).collect();
        Series::line(name, points)
    };
    let theory = measured.walls.iter().map(|row| [row.rate, row.theory]).collect();
    let walls = Plot::new(
        "the stiffest wall that a hand comes to rest at",
        Axis::log("cycles a second"),
        Axis::log("N/mm"),
    )
    .with_series(Series::dashes("theory", theory))
    .with_series(limits("direct", &|row| row.measured[0]))
    .with_series(limits("direct, encoders of 0.01 mm", &|row| row.measured[1]))
    .with_series(limits("coupling, at a wall of 10 kN/mm", &|row| row.coupling))
    .with_series(Series::points("felt as clean (Choi and Tan)", CLEAN_WALLS.to_vec()));
    let axes = |label: &str| (Axis::linear("how deep the hand wants it, mm"), Axis::linear(label));
    let sheet = |label: &str, title: &str, row: usize| {
        let (x, y) = axes(label);
        measured.pressing.iter().fold(Plot::new(title, x, y), |plot, (name, points)| {
            let points = points.iter().step_by(20).map(|point| [point[0], point[row]]).collect();
            plot.with_series(Series::line(*name, points))
        })
    };
    let tapping = measured.tapping.iter().fold(
        Plot::new(
            "a ball taps a plane",
            Axis::linear("s"),
            Axis::linear("energy put in and not held, N·mm"),
        ),
        |plot, (name, energies)| {
            let point = |(cycle, energy): (usize, &EnergyBalance)| {
                [cycle as f64 / 1000.0, energy.input - energy.stored]
            };
            let points = energies.iter().enumerate().step_by(25).map(point).collect();
            plot.with_series(Series::line(*name, points))
        },
    );
    vec![
        ("haptics-energy.svg", tapping.svg()),
        ("haptics-walls.svg", walls.svg()),
        ("haptics-sheet.svg", sheet("tip, mm", "a ball on a sheet of 0.5 mm", 1).svg()),
        ("haptics-push.svg", sheet("force, N", "and what the hand feels", 2).svg()),
    ]
}

/// Returns the text of the page.
///
/// # Errors
/// Never in practice: writing to a string cannot fail.
pub fn page(measured: &Measurements) -> Result<String, fmt::Error> {
    let mut page = String::new();
    write_walls(&mut page, measured)?;
    write_roughness(&mut page, measured)?;
    writeln!(page, "## Energy\n")?;
    writeln!(
        page,
        "`D2Ball` moved up and down on a plane eight times a second: what the hand put in and contact and coupling do not hold. Below\n\
         0 it was given energy from nowhere.\n"
    )?;
    writeln!(page, "![energy](haptics-energy.svg)\n")?;
    writeln!(page, "| | after 5 s, N·mm | generated at most | taken out |\n|---|--:|--:|--:|")?;
    for (name, energies) in &measured.tapping {
        let Some(EnergyBalance { input, stored, generated, dissipated, .. }) = energies.last()
        else {
            continue;
        };
        let net = input - stored;
        writeln!(page, "| {name} | {net:.4} | {generated:.1e} | {dissipated:.1e} |")?;
    }
    writeln!(page)?;
    writeln!(page, "## A thin sheet\n")?;
    writeln!(
        page,
        "`D2Ball` (2 mm) pressed on a sheet of 0.5 mm, 100 N/mm³: where its tip is, and what the hand feels.\n"
    )?;
    writeln!(
        page,
        "![where the tool is](haptics-sheet.svg)\n![what the hand feels](haptics-push.svg)\n"
    )?;
    write_latency(&mut page, measured)?;
    Ok(page)
}

fn format_limit(limit: f64) -> String {
    if limit.is_finite() { format!("{limit:.2}") } else { "none up to 10⁵".to_owned() }
}

fn write_walls(page: &mut String, measured: &Measurements) -> fmt::Result {
    writeln!(page, "## How stiff a wall may be\n")?;
    writeln!(
        page,
        "A flat end on a plane, held by a hand of 0.1 kg, 5 N·s/m and 0.2 N/mm: the largest stiffness, N/mm, at which it comes to\n\
         rest. *Theory* is the spectral radius of one cycle; *encoders* tell {ENCODER_STEP} mm apart; *scaled* is by the largest eigenvalue of the\n\
         contact's stiffness to 1 N/mm; *coupled* by a spring of 1 N/mm. The last column is how stiff a coupling may be at a wall of 10⁴ N/mm.\n"
    )?;
    writeln!(page, "![limits](haptics-walls.svg)\n")?;
    writeln!(page, "| Hz | theory | direct | with encoders | scaled | coupled | a coupling |")?;
    writeln!(page, "|--:|--:|--:|--:|--:|--:|--:|")?;
    for row in &measured.walls {
        let [direct, encoded, scaled, coupled] = row.measured.map(format_limit);
        let (theory, coupling) = (format_limit(row.theory), format_limit(row.coupling));
        let rate = row.rate;
        writeln!(
            page,
            "| {rate} | {theory} | {direct} | {encoded} | {scaled} | {coupled} | {coupling} |"
        )?;
    }
    writeln!(page)
}

fn write_roughness(page: &mut String, measured: &Measurements) -> fmt::Result {
    writeln!(page, "## What shakes\n")?;
    writeln!(
        page,
        "The tool of fig. 7.3 on the tube, pressed by the hand with some 0.6 N as it goes along, 10 mm a second: the force's root mean square, what of it\n\
         is above 30 Hz, the largest change from one cycle to the next, and the contact's largest stiffness.\n"
    )?;
    writeln!(
        page,
        "| along | tool | points | law | | N/mm³ | force, N | above 30 Hz, N | of it | step, N | N/mm |"
    )?;
    writeln!(page, "|---|---|--:|---|---|--:|--:|--:|--:|--:|--:|")?;
    for (points, case, stats) in &measured.roughness {
        let ForceStats { force, roughness, max_step, max_stiffness } = stats;
        let Case { path, tool, law, rendering, stiffness } = case;
        let (path, tool, share) = (path.name(), tool.0, 100.0 * roughness / force);
        writeln!(
            page,
            "| {path} | {tool} | {points} | {law} | {rendering} | {stiffness} | {force:.3} | {roughness:.1e} | {share:.2} % | {max_step:.1e} | {max_stiffness:.1} |"
        )?;
    }
    writeln!(page)
}

fn write_latency(page: &mut String, measured: &Measurements) -> fmt::Result {
    writeln!(page, "## How long a cycle takes\n")?;
    writeln!(
        page,
        "In real time, a hand that presses a ball on a block of 100,000 points beside a loop that touches nothing, each on a core\n\
         of its own, first in, first out; µs. *Late* is how long after its time a cycle begins.\n"
    )?;
    writeln!(
        page,
        "| Hz | s | loop | | p50 | p99 | p99.9 | max | deadlines missed | left out | cycles |"
    )?;
    writeln!(page, "|--:|--:|---|---|--:|--:|--:|--:|--:|--:|--:|")?;
    for (rate, seconds, reports) in &measured.latency {
        for (name, report) in ["pressing", "empty"].into_iter().zip(reports) {
            for (quantity, times) in [("took", &report.durations), ("late", &report.start_delays)] {
                let quantile = |fraction: f64| times.value_at_quantile(fraction) as f64 / 1e3;
                writeln!(
                    page,
                    "| {rate} | {seconds} | {name} | {quantity} | {:.1} | {:.1} | {:.1} | {:.1} | {} | {} | {} |",
                    quantile(0.5),
                    quantile(0.99),
                    quantile(0.999),
                    times.max() as f64 / 1e3,
                    report.missed,
                    report.skipped,
                    report.cycles,
                )?;
            }
        }
    }
    Ok(())
}
