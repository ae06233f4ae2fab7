//! The text and the diagrams of the page `work-precision.md`.

use super::choice::{Choice, ErrorRequirement, fastest};
use super::orders::{expected, orders};
use super::plots::{improving_front, plot};
use super::row::{Label, Quantity, Row};
use super::table::{cells, format_error, format_micros, format_setting};
use super::{Measurements, Plan, SceneInfo};
use crate::page::{GENERATED_CODE, Page, Section};
use std::fmt::{Error, Write};

/// The prefix of all file names.
const NAME: &str = "work-precision";

fn file_name(scene: &str, quantity: Quantity) -> String {
    format!("{NAME}-{scene}-{}.svg", quantity.name())
}

fn rows_of<'a>(measured: &'a Measurements, scene: &str) -> Vec<&'a Row> {
    measured.rows.iter().filter(|row| row.scene == scene).collect()
}

/// Returns the page with its diagrams.
///
/// # Errors
/// Never in practice: writing to a string cannot fail.
pub fn page(measured: &Measurements, plan: &Plan) -> Result<Page, Error> {
    let mut body = String::new();
    write_head(&mut body, measured, plan)?;
    for facts in &measured.scenes {
        write_scene(&mut body, facts, &rows_of(measured, &facts.scene))?;
    }
    write_orders(&mut body, measured)?;
    write_choices(&mut body, measured)?;
    Ok(Page {
        name: NAME,
        title: "Run time against error",
        covers: &[
            "runtime/src/bvh",
            "runtime/src/certify",
            "runtime/src/cloud",
            "runtime/src/part.rs",
            "runtime/src/point_bvh",
            "runtime/src/pose.rs",
            "runtime/src/probe",
            "runtime/src/tool",
            GENERATED_CODE,
            "tools-library/tools",
        ],
        sections: vec![Section { title: "", body }],
        figures: figures(measured),
    })
}

/// The quantities with diagrams. Torque behaves like force.
const PLOTTED: [Quantity; 2] = [Quantity::Force, Quantity::Depth];

/// Returns the diagrams of those paths that have points.
fn figures(measured: &Measurements) -> Vec<(String, String)> {
    let mut figures = Vec::new();
    for facts in measured.scenes.iter().filter(|facts| facts.is_path) {
        let rows = rows_of(measured, &facts.scene);
        for quantity in PLOTTED {
            let plot = plot(&rows, &facts.scene, quantity);
            if !plot.is_empty() {
                figures.push((file_name(&facts.scene, quantity), plot.svg()));
            }
        }
    }
    figures
}

fn write_head(page: &mut String, measured: &Measurements, plan: &Plan) -> Result<(), Error> {
    let pinned = if measured.pinned { "kept on one core" } else { "not kept on one core" };
    let sample = if plan.quick { "This is the sample, `--quick`.\n\n" } else { "" };
    writeln!(
        page,
        "{sample}Methods are asked in one process, the thread {pinned}, in turns of 25 poses, those of one size against each other; half of the turns are timed query by
query, with the clock's own 20 ns in them. No pose is asked twice of a method, but where a path has fewer than 2,000 in contact and is gone along
again. Only poses in true contact count: errors are root mean squares over them, by the root mean square of the true force, torque about the tip, and
depth, under the thesis's law. On patches the truth is a closed form, on paths depth is proved to 1e-9 mm (`Certifier::deepest`) and force and torque
are sums over the part's own triangles, quartered where that changes them; no error is given below what the truth is known to (`≤`).
Of patches each size has several clouds and {} placements on each, of paths one cloud and {} poses.

The command prints all rows, one object a line. **missed** is the share of poses in contact in which no point is inside (of
`apart`, where nothing is in contact, at which something is). **worst** is the largest error of depth, in the part's unit.

| method | what it is | setting |
|---|---|---|
| `cloud` | `Probe::wrench` of a cloud, `random` or `blue`; each point counts for the area over their number, `equal`, or of its cell, `cells` | points |
| `cloud + bound` | `Probe::depth_bound`: what no place of the surface is deeper than; the error is what that is too much | points |
| `graded` | `LodProbe::wrench` of the largest cloud and its levels, asked pose by pose along the path | nodes a query may look at |
| `certified` | `Certifier::deepest`: the upper end of what is proved | tolerance |
| `centroids` | `cloud` of the centroids of equal triangles with their areas | points |
| `brute-f64`, `brute-f32` | all points, scalar with branches; and 16 at a time, all in `f32` | points |
| `thesis` | a binary tree of 18-DOPs behind pointers, the tool in three volumes, scalar trees of splits | points |
| `parry-bvh` | `parry3d`'s `Bvh` over blocks of 64 points, the tool's outline, formula and SIMD by hand, survivors in `f64` | points |
| `fidget` | the formula as a JIT: intervals on nodes, a slice of points, gradients of hits | points |
| `parry-contact` | `parry3d`'s `contact` of a compound and the triangle mesh: a depth, no force | |

`brute` to `parry-contact` are other methods, with the feature `peers`. They know the thesis's magnitudes, and are judged by those; clouds are
blue, with cells.
",
        plan.placements, plan.checks,
    )
}

fn write_scene(page: &mut String, facts: &SceneInfo, rows: &[&Row]) -> Result<(), Error> {
    writeln!(page, "## {}\n\n{}.\n", facts.scene, facts.description)?;
    if rows.iter().all(|row| row.err_depth.is_none()) {
        return write_times(page, rows);
    }
    let [force, torque, depth] = facts.typical;
    let known = facts.reference_error.map(|share| format!("{share:.0e}"));
    let unit = facts.unit;
    writeln!(
        page,
        "Typical: force {force:.3e} {unit}³, torque {torque:.3e} {unit}⁴, depth {depth:.3e} {unit}; known to {}, {} and {} of that.\n",
        known[0], known[1], known[2]
    )?;
    for quantity in PLOTTED.into_iter().filter(|_| facts.is_path) {
        writeln!(
            page,
            "![{0}: {1}]({2})",
            facts.scene,
            quantity.name(),
            file_name(&facts.scene, quantity)
        )?;
    }
    for quantity in [Quantity::Force, Quantity::Depth] {
        writeln!(page, "\nWhat nothing is faster and nearer than, by the {}:\n", quantity.name())?;
        write_table(page, &pareto_rows(rows, quantity))?;
    }
    writeln!(page)
}

/// Writes the section of a scene without contact: times only.
fn write_times(page: &mut String, rows: &[&Row]) -> Result<(), Error> {
    writeln!(page, "Nothing touches; this is what it takes to say so.\n")?;
    writeln!(
        page,
        "| method | setting | sampling | p50 µs | p99 µs | missed |\n|---|--:|---|--:|--:|--:|"
    )?;
    for row in rows.iter().filter(|row| row.weights != Some("equal")) {
        writeln!(
            page,
            "| {} | {} | {} | {} | {} | {:.2} % |",
            row.method,
            format_setting(row),
            row.sampling.unwrap_or("-"),
            format_micros(row.p50_ns),
            format_micros(row.p99_ns),
            100.0 * row.missed
        )?;
    }
    writeln!(page)
}

/// Returns the rows on the Pareto front of time and error, the fastest first.
pub(super) fn pareto_rows<'a>(rows: &[&'a Row], quantity: Quantity) -> Vec<&'a Row> {
    let point_of = |row: &Row| Some([row.p50_ns? as f64, quantity.error(row)?]);
    let points: Vec<[f64; 2]> = rows.iter().filter_map(|row| point_of(row)).collect();
    let row_at =
        |corner: &[f64; 2]| rows.iter().copied().find(|row| point_of(row) == Some(*corner));
    improving_front(&points).iter().filter_map(row_at).collect()
}

fn write_table(page: &mut String, rows: &[&Row]) -> Result<(), Error> {
    writeln!(
        page,
        "| method | setting | sampling | weights | p50 µs | p99 µs | force | torque | depth | worst | missed |
|---|--:|---|---|--:|--:|--:|--:|--:|--:|--:|"
    )?;
    for row in rows {
        writeln!(page, "| {} % |", cells(row).join(" | "))?;
    }
    Ok(())
}

fn write_orders(page: &mut String, measured: &Measurements) -> Result<(), Error> {
    writeln!(
        page,
        "## Orders of convergence

p in `error = c · N^p`, by least squares of the logarithms, of `cloud`; expected where the contact's border is a curve on a smooth part and it touches
in a place. Along a line (CF2, CF5) the depth's is -2. CF8 and CF9 have no such border; a path has one cloud a size.

| scene | sampling | weights | force | expected | torque | depth | expected |
|---|---|---|--:|--:|--:|--:|--:|"
    )?;
    for orders in orders(&measured.rows) {
        let [force, torque, depth] =
            orders.slopes.map(|slope| slope.map_or("-".to_owned(), |slope| format!("{slope:.2}")));
        let expected = |quantity| expected(orders.weights, quantity);
        writeln!(
            page,
            "| {} | {} | {} | {force} | {} | {torque} | {depth} | {} |",
            orders.scene,
            orders.sampling,
            orders.weights,
            expected(Quantity::Force),
            expected(Quantity::Depth)
        )?;
    }
    writeln!(page)
}

fn write_choices(page: &mut String, measured: &Measurements) -> Result<(), Error> {
    let paths = measured.scenes.iter().filter(|facts| facts.is_path && facts.typical[2] > 0.0);
    let scenes: Vec<&str> = paths.map(|facts| facts.scene.as_str()).collect();
    if scenes.is_empty() {
        return Ok(());
    }
    writeln!(
        page,
        "## Which setting for which tolerance

The fastest that keeps the tolerance on every path ({}): of the force by its error, a root mean square, of the depth by its worst, in the part's
unit. The fastest is the one whose slowest median is the shortest. *Safe* are those that answer no less than the true depth.

| tolerance | of | method | setting | sampling | weights | p50 µs ({}) | error |
|--:|---|---|--:|---|---|--:|--:|",
        scenes.join(", "),
        scenes.join(", ")
    )?;
    for requirement in ErrorRequirement::ALL {
        let choice = fastest(&measured.rows, &scenes, requirement, |_| true);
        let (tolerance, quantity) = match requirement {
            ErrorRequirement::Force(share) => (format!("{} %", 100.0 * share), "force"),
            ErrorRequirement::Depth(depth) => (format!("{depth}"), "depth"),
        };
        write_choice(page, &tolerance, quantity, choice)?;
        if matches!(requirement, ErrorRequirement::Depth(_)) {
            let is_safe = |row: &Row| matches!(row.method, "certified" | "cloud + bound");
            let choice = fastest(&measured.rows, &scenes, requirement, is_safe);
            write_choice(page, &tolerance, "depth, safe", choice)?;
        }
    }
    Ok(())
}

fn write_choice(
    page: &mut String,
    tolerance: &str,
    quantity: &str,
    choice: Option<Choice>,
) -> Result<(), Error> {
    let Some(Choice { label, median_ns, error: worst }) = choice else {
        return writeln!(page, "| {tolerance} | {quantity} | none that was measured | | | | | |");
    };
    let times: Vec<String> = median_ns.into_iter().map(|ns| format_micros(Some(ns))).collect();
    let Label { method, points, sampling, weights, tolerance: setting_tolerance, budget } = label;
    let setting = match (points, budget, setting_tolerance) {
        (_, Some(budget), _) => format!("≤ {budget}"),
        (_, _, Some(setting_tolerance)) => format!("{setting_tolerance:.0e}"),
        (Some(points), ..) => points.to_string(),
        _ => "-".to_owned(),
    };
    writeln!(
        page,
        "| {tolerance} | {quantity} | {method} | {setting} | {} | {} | {} | {} |",
        sampling.unwrap_or("-"),
        weights.unwrap_or("-"),
        times.join(", "),
        format_error(Some(worst))
    )
}
