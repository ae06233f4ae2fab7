//! The page of what was measured.

use super::scenes::stages;
use super::table::{Outcome, Row, measure};
use std::error::Error;
use std::fmt::{Error as Unwritten, Write};

/// Measures everything; takes some two minutes.
///
/// # Errors
/// None: meshes and clouds are sound, and a text can be written to.
pub fn page() -> Result<String, Box<dyn Error>> {
    let mut outcomes = Vec::new();
    for stage in stages()? {
        outcomes.extend(measure(&stage)?);
    }
    Ok(text(&outcomes)?)
}

fn text(outcomes: &[Outcome]) -> Result<String, Unwritten> {
    let mut page = "# Adaptive quadrature beside clouds

```sh
cargo run --release -p touchoff-tests --bin adaptive > docs/measured/adaptive.md
```

Could the part's triangles be integrated when they are touched, and halved where the error is largest, instead of summing a cloud of points?
Each triangle is asked at the seven points of a rule of degree 5; one of degree 2 among them says how wrong it is. Where the tool's
surface cuts a triangle, it is cut along the line on which the magnitude, as a plane, is 0, and what is left is integrated: magnitude is 0
there, so a line that is a little off costs little. Whoever has more than its share of the error is halved along its longest edge, all of
them together, so that the tool evaluates many points at a time. What sees nothing and is outside by its distance is dropped.

"
    .to_owned();
    verdict(outcomes, &mut page)?;
    page += "
## At equal error

Much is in the integrator's favour: which triangles the tool touches is found for free; long triangles of the fine tube were cut to 1 mm beforehand;
what sees nothing is taken to be outside by the tool's curvature, not by proof; its real error is compared, which is mostly
far smaller than the one it was asked for; and a wish that misses no less than the one before by a tenth is left out.
The fine tube is not held: none of its slivers' integrals was right enough to be a reference.

- **wished**: the sum of estimated errors, relative to force and torque. **evaluations** are points at which the tool was evaluated,
  **rounds** one more than how often triangles were halved; **µs** is the fastest of many passes.
- **force**: what it really missed, the root mean square over poses, against the same integrator at 1e-6 that begins with
  triangles of 0.1 mm and trusts less in what it does not see; no less than that one's estimate.
- **cloud**: how many points of `Cloud::blue` miss as much, how many of them are in contact, and the µs of `Probe::wrench`, between clouds
  that were measured here, below. `~`: beyond them, by the order of their error; µs by the line. With millions
  of points × may be off by some times, since the order is known to a tenth or two.
- **×** is how many times as long as the cloud the integrator takes.

| scene | wished | evaluations | rounds | µs | force | cloud, points | in contact | µs | × |
|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|
";
    for row in outcomes.iter().flat_map(|outcome| &outcome.rows) {
        writeln!(
            page,
            "| {} | {:.0e} | {:.0} | {:.1} | {} | {:.1e} | {}{} | {} | {} | {} |",
            row.name,
            row.wished,
            row.evaluations,
            row.rounds,
            short(row.time),
            row.error,
            if row.between { "" } else { "~" },
            short(row.blue.points),
            short(row.blue.contact),
            short(row.blue.time),
            short(row.times()),
        )?;
    }
    page += "
## The clouds

Two of each size: points, µs a query, and the root mean square error of the force over both and poses.
Of all but the first, error falls as points to the power of minus the **order**. Clouds know nothing of the integrator, and come as near to
its **reference** as they are fine; that is how wrong it is by its own estimate.

| scene | points | µs | error | points | µs | error | points | µs | error | points | µs | error | order | reference |
|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|
";
    for outcome in outcomes {
        write!(page, "| {} |", outcome.name)?;
        for blue in &outcome.blues {
            write!(page, " {} | {} | {:.1e} |", blue.points, short(blue.time), blue.error)?;
        }
        writeln!(page, " {:.2} | {:.0e} |", outcome.order, outcome.estimate)?;
    }
    Ok(page)
}

/// Three digits or so.
fn short(value: f64) -> String {
    match value {
        value if value >= 1e6 => format!("{value:.1e}"),
        value if value >= 100.0 => format!("{value:.0}"),
        value if value >= 10.0 => format!("{value:.1}"),
        value if value >= 0.1 => format!("{value:.2}"),
        _ => format!("{value:.4}"),
    }
}

/// From the least to the greatest of a list.
fn range(values: impl Iterator<Item = f64>) -> String {
    let ends = values.fold([f64::INFINITY, 0f64], |[low, high], x| [low.min(x), high.max(x)]);
    format!("{} to {}", short(ends[0]), short(ends[1]))
}

/// The median, and from where to where.
fn spread(rows: &[&Row]) -> String {
    let mut all: Vec<f64> = rows.iter().map(|row| row.times()).collect();
    all.sort_by(f64::total_cmp);
    let median = all.get(all.len() / 2).map_or("-".to_owned(), |median| short(*median));
    format!("{median} ({})", range(all.into_iter()))
}

fn verdict(outcomes: &[Outcome], page: &mut String) -> Result<(), Unwritten> {
    let all: Vec<&Row> = outcomes.iter().flat_map(|outcome| &outcome.rows).collect();
    let these = |which: fn(&Row) -> bool| -> Vec<&Row> {
        all.iter().copied().filter(|row| which(row)).collect()
    };
    let between = these(|row| row.between);
    let won = these(|row| row.times() < 1.0);
    let mut scenes: Vec<&str> = won.iter().map(|row| row.name).collect();
    scenes.dedup();
    writeln!(
        page,
        "## Verdict

At equal real error adaptive quadrature takes, in the median of {} rows, {} times as long as a query of a blue-noise cloud; in the {} of them
whose error lies between those of measured clouds, {} times. It is faster in {}, {} times, where the error is at most {:.1e}:
{}.
Of these, {} hardly halved anything, so that a rule for each triangle did it and no refinement, and {} are beyond what any cloud here reaches.",
        all.len(),
        spread(&all),
        between.len(),
        spread(&between),
        won.len(),
        range(won.iter().map(|row| 1.0 / row.times())),
        won.iter().map(|row| row.error).fold(0.0, f64::max),
        scenes.join("; "),
        won.iter().filter(|row| row.rounds < 1.5).count(),
        won.iter().filter(|row| !row.between).count(),
    )?;
    let point = outcomes.iter().map(|outcome| {
        let [.., from, to] = &outcome.blues[..] else { return f64::NAN };
        1e3 * (to.time - from.time) / (to.contact - from.contact)
    });
    writeln!(
        page,
        "In {} rows it misses more of the force than was wished: a rule does not see what lies between its points. An evaluation costs it {} ns with
what is decided about it, a point in contact {} ns of a query. The clouds' error falls by their points to a power of minus {}.",
        these(|row| row.error > row.wished).len(),
        range(all.iter().map(|row| 1e3 * row.time / row.evaluations)),
        range(point),
        range(outcomes.iter().map(|outcome| outcome.order)),
    )?;
    let kept = if 2 * won.len() > all.len() {
        "It mostly beats a denser cloud, so it is worth keeping."
    } else {
        "It does not beat a denser cloud, so it is not kept: nothing but this measurement uses it."
    };
    writeln!(page, "\n{kept}")
}
