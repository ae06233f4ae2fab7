//! The tables as Markdown, and the plot.

use super::energy::Row as Energy;
use super::steps::Row as Step;
use super::{LAWS, drift};
use crate::plot::{Axis, Plot, Series};
use std::fmt::{Error, Write};

/// The work round a loop that the gradient's law may do, by the energy stored.
pub const WORK: f64 = 1e-6;
/// How far from a rotation a pose may be, in ε.
pub const APART: f64 = 4.0;
/// By what angle it may be off after ten million motions, in radians.
pub const ANGLE: f64 = 1e-10;

/// All that was measured.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Steps of the force, by the number of points.
    pub steps: Vec<(usize, Vec<Step>)>,
    /// Work round loops, and how many points the block has.
    pub energy: (usize, Vec<Energy>),
    /// Rotations.
    pub drift: Vec<drift::Row>,
}

impl Measured {
    /// What misses its bar.
    pub fn missed(&self) -> Vec<String> {
        let mut missed = Vec::new();
        for row in &self.energy.1 {
            let work = row.work[1];
            if work.share.abs() > WORK {
                missed.push(format!(
                    "{}, {}: the gradient's law does {:.1e} of the stored energy, known to {:.1e}",
                    row.tool,
                    row.kind.name(),
                    work.share,
                    work.error
                ));
            }
        }
        for row in &self.drift {
            if row.apart > APART || row.angle > ANGLE || row.angle.is_nan() {
                let why = if row.turn.comes_round() {
                    "; it comes back to where it began, so rounding is the same time and again, and what a turn \
                     of it differs from a whole one is less than doubles hold"
                } else {
                    ""
                };
                let row = format!("{:?}: {:.2} ε, {:.1e} rad{why}", row.turn, row.apart, row.angle);
                missed.push(row);
            }
        }
        missed
    }
}

/// The page below its title.
///
/// # Errors
/// None that a text could have.
pub fn page(measured: &Measured) -> Result<String, Error> {
    let mut page = String::new();
    bars(&mut page, measured)?;
    for (count, rows) in &measured.steps {
        steps(&mut page, *count, rows)?;
    }
    energy(&mut page, measured.energy.0, &measured.energy.1)?;
    turns(&mut page, &measured.drift)?;
    writeln!(page, "\n## Missed\n")?;
    let missed = measured.missed();
    if missed.is_empty() {
        page += "Nothing.\n";
    }
    for line in missed {
        writeln!(page, "- {line}")?;
    }
    Ok(page)
}

fn bars(page: &mut String, measured: &Measured) -> Result<(), Error> {
    let works = measured.energy.1.iter().map(|row| row.work[1]);
    let work = works.clone().map(|work| work.share.abs()).fold(0.0, f64::max);
    let error = works.map(|work| work.error).fold(0.0, f64::max);
    let most = |of: fn(&drift::Row) -> f64| measured.drift.iter().map(of).fold(0.0, f64::max);
    let angle = |round: bool| {
        let rows = measured.drift.iter().filter(|row| row.turn.comes_round() == round);
        rows.map(|row| row.angle).fold(0.0, f64::max)
    };
    let count = measured.drift.first().map_or(0, |row| row.count);
    writeln!(page, "| what | bar | measured |\n|---|--:|--:|")?;
    writeln!(
        page,
        "| work round a closed loop by the gradient's law, of the stored energy | {WORK:e} | {work:.1e} (sums known to {error:.0e}) |"
    )?;
    writeln!(
        page,
        "| `RᵀR - I` after each of {count} compositions, in ε | {APART} | {:.2} |
| angle after them, rad | {ANGLE:e} | {:.1e} |
| the same of rotations that come back to where they began | {ANGLE:e} | {:.1e} |",
        most(|row| row.apart),
        angle(false),
        angle(true)
    )
}

fn steps(page: &mut String, count: usize, rows: &[Step]) -> Result<(), Error> {
    writeln!(
        page,
        "\n## Steps of the force at {count} points\n
The largest change of the force in 1 µm of motion (of no point of the tool's axis more) along each path of the scenes, in mm³ as the
force, beside the largest force of the path; *smooth*: the median step within 0.1 mm of it, what stiffness alone does; *by what*: the
points that did most of it. `at` is the fraction of the path.\n
| path | law | tool | steps | largest | of the peak | smooth | median | at | by what | torque | of the peak |\n|---|---|---|--:|--:|--:|--:|--:|--:|---|--:|--:|"
    )?;
    for row in rows {
        let Step { force, torque, peaks, .. } = row;
        let share = |step: f64, peak: f64| format!("{:.2} %", 100.0 * step / peak);
        writeln!(
            page,
            "| {} | {} | {} | {} | {:.1e} | {} | {:.1e} | {:.1e} | {:.6} | {} | {:.1e} | {} |",
            row.path.name(),
            row.law,
            row.tool,
            row.steps,
            force.force,
            share(force.force, peaks[0]),
            row.change.staying.1.norm(),
            row.median,
            force.at,
            row.change.cause(),
            torque.torque,
            share(torque.torque, peaks[1])
        )?;
    }
    writeln!(page, "\n![the force around the worst place](continuity-{count}.svg)")
}

fn energy(page: &mut String, points: usize, rows: &[Energy]) -> Result<(), Error> {
    writeln!(
        page,
        "\n## Work round closed loops\n
Each tool of the library at the edge of a block of {points} points, 0.4 mm deep: its tip goes once round a circle of 0.3 mm
across the edge, by its *end* or its *side*, and on some loops the tool turns by 0.02 rad about two axes. The work of force and
torque, `∮ F·dx + τ·dω` by Boole's rule, over the largest energy `½ Σ w·m²` on the way. Stretches are
halved where the force has a kink or a jump. *Known to*: what all of them together may be off by, as if their signs were random,
or half of what two rounds from different poses differ by.\n
| tool | loop | in contact | thesis | facing | gradient | known to | poses |\n|---|---|--:|--:|--:|--:|--:|--:|"
    )?;
    for row in rows {
        let [thesis, gradient, facing] = row.work;
        writeln!(
            page,
            "| {} | {} | {:.0} | {:.2} % | {:.2} % | {:.1e} | {:.1e} | {} |",
            row.tool,
            row.kind.name(),
            row.colliding,
            100.0 * thesis.share,
            100.0 * facing.share,
            gradient.share,
            gradient.error,
            gradient.poses
        )?;
    }
    let most = |which: usize| {
        let shares = rows.iter().map(|row| row.work[which].share.abs());
        shares.fold(0.0, f64::max)
    };
    let law = |which: usize| LAWS[which];
    writeln!(
        page,
        "\nAt most: {} {:.1} %, {} {:.1} %, {} {:.1e}.",
        law(0),
        100.0 * most(0),
        law(2),
        100.0 * most(2),
        law(1),
        most(1)
    )
}

fn turns(page: &mut String, rows: &[drift::Row]) -> Result<(), Error> {
    writeln!(
        page,
        "\n## Drift\n
One rotation composed with itself by `Pose::then`, which ends each with one step of Newton's method, against its power in 256 bits;
*plain*: products left as they are. A rotation that comes back to where it began (6, 4, 7 and 360 times are once round) rounds alike
each time, so that its error grows with the number of steps, as that of plain products does; another's grows like a random walk. *Tip*: by how much its distance from the axis has changed, relative. Times are those of this run.\n
| about | by, rad | times | `RᵀR - I`, ε | angle, rad | plain, ε | plain, rad | tip | ns | plain, ns |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|"
    )?;
    for row in rows {
        writeln!(
            page,
            "| {:?} | {:.3e} | {} | {:.2} | {:.1e} | {:.1e} | {:.1e} | {:.1e} | {:.1} | {:.1} |",
            row.turn.axis,
            row.turn.angle,
            row.count,
            row.apart,
            row.angle,
            row.plain[0],
            row.plain[1],
            row.tip,
            row.ns[0],
            row.ns[1]
        )?;
    }
    Ok(())
}

/// The force of several tools around a place.
pub fn plot(title: &str, tools: Vec<(String, Vec<[f64; 2]>)>) -> Plot {
    let mut plot = Plot::new(title, Axis::linear("µm of motion"), Axis::linear("force, mm³"));
    for (look, (name, points)) in tools.into_iter().enumerate() {
        plot = plot.with(Series::line(name, points).look(look));
    }
    plot
}
