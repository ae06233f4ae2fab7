//! The tables of `docs/measured/adaptive.md`.

use std::error::Error;
use std::fmt::{Error as Unwritten, Write};
use touchoff_tests::measure::adaptive::{Outcome, Row, measure, scenes, unrefined};

fn main() -> Result<(), Box<dyn Error>> {
    let scenes = scenes()?;
    let mut outcomes = Vec::new();
    for scene in &scenes {
        outcomes.push(measure(scene)?);
        eprintln!("{}", scene.name);
    }
    let known = scenes.iter().find_map(|scene| Some((scene, scene.force?)));
    let (ball, force) = known.ok_or("a scene with a closed form")?;
    print!("{}", page(&outcomes, &unrefined(ball, force)?)?);
    Ok(())
}

fn page(outcomes: &[Outcome], unrefined: &[[f64; 5]]) -> Result<String, Unwritten> {
    let mut page = "# Adaptive quadrature beside clouds

```sh
cargo run --release -p touchoff-tests --bin adaptive > docs/measured/adaptive.md
```

Could the part's triangles be integrated when they are touched, and halved where the error is largest, instead of summing a cloud of points?
Each triangle is asked at the seven points of a rule of degree 5; one of degree 2 among them says how wrong it is. Where the tool's
surface cuts a triangle, it is cut along the line on which the magnitude, as a plane, is 0, and what is left is integrated: magnitude is 0
there, so a line that is a little off costs little. Whoever has more than its share of the error is halved along its longest edge, all of
them together, so that the tool evaluates many points at a time. What sees nothing and is outside by its distance is dropped.

Much is in the integrator's favour: which triangles the tool touches is found for free; long triangles of the fine tube were cut to 1 mm beforehand;
what sees nothing is taken to be outside by the tool's curvature, not by proof; and its real error is compared, which is mostly
far smaller than the one it was asked for. The clouds' times are whole queries.

- **wished**: the sum of estimated errors, relative to force and torque. **evaluations** are points at which the tool was evaluated,
  **distances** how often it was asked how far it is, **rounds** one more than how often triangles were halved; **µs** is the fastest of many passes.
- **force**, **torque**: what it really missed, the root mean square over poses, against the same integrator at 1e-6 that begins with
  triangles of 0.1 mm (the fine tube held: 0.4) and trusts less in what it does not see; torque about the tip, relative to itself or the force on an arm of 1 mm.
- **random**: points in contact of a cloud of `Cloud::random` that misses as much of the force, and µs, by three clouds measured
  here: their error times √n is constant. **blue**: the same of a blue-noise cloud weighted by Voronoi cells, by the published law,
  1.2e-3 with 152 points in contact, falling as n^-1.26. It was found for a ball in a plane and 152 to 611 points; elsewhere it is taken to miss as much more as
  a random cloud does. Times are those of the random clouds, since they hardly depend on where the points are, beyond the largest by the line.
- **×** is how many times as long as the blue cloud the integrator takes.

| scene | wished | evaluations | distances | rounds | µs | force | torque | random, points | µs | blue, points | µs | × |
|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|
"
    .to_owned();
    for outcome in outcomes {
        for row in &outcome.rows {
            let [random, blue] = row.clouds;
            writeln!(
                page,
                "| {} | {:.0e} | {:.0} | {:.0} | {:.1} | {} | {:.1e} | {:.1e} | {} | {} | {} | {} | {} |",
                outcome.name,
                row.wished,
                row.evaluations,
                row.distances,
                row.rounds,
                short(row.time),
                row.errors[0],
                row.errors[1],
                short(random[0]),
                short(random[1]),
                short(blue[0]),
                short(blue[1]),
                short(times(row)),
            )?;
        }
    }
    page += "
## What it was measured against

**Touched** is how many triangles the integrator began with. The reference is compared with the closed form of the smooth surface, of which a bore
of flat sides is another, and with one random cloud of a million points, for the tubes ten million; *expected* is by how much such a cloud misses on average.

| scene | poses | touched | reference: evaluations | estimate | from the closed form | from the cloud | expected |
|---|--:|--:|--:|--:|--:|--:|--:|
";
    for outcome in outcomes {
        let [evaluations, estimate] = outcome.reference;
        writeln!(
            page,
            "| {} | {} | {:.1} | {evaluations:.0} | {estimate:.0e} | {} | {:.1e} | {:.1e} |",
            outcome.name,
            outcome.poses,
            outcome.touched,
            outcome.closed.map_or("-".to_owned(), |closed| format!("{closed:.1e}")),
            outcome.cloud[0],
            outcome.cloud[1],
        )?;
    }
    page += "
The random clouds, points in contact, µs and error of each:

| scene | points | µs | error | points | µs | error | points | µs | error |
|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|
";
    for outcome in outcomes {
        write!(page, "| {} |", outcome.name)?;
        for [count, time, error] in outcome.random {
            write!(page, " {count:.1} | {time:.2} | {error:.1e} |")?;
        }
        page += "\n";
    }
    page += "
## Without refinement

The ball again, its plane divided evenly into squares and these into two triangles, nothing halved.

| side, mm | evaluations | µs | force | blue, points |
|--:|--:|--:|--:|--:|
";
    for [side, count, time, error, blue] in unrefined {
        writeln!(page, "| {side:.4} | {count:.0} | {} | {error:.1e} | {blue:.0} |", short(*time))?;
    }
    verdict(outcomes, &mut page)?;
    Ok(page)
}

fn times(row: &Row) -> f64 {
    row.time / row.clouds[1][1]
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

fn verdict(outcomes: &[Outcome], page: &mut String) -> Result<(), Unwritten> {
    // What is missed is known if it is well above what the reference may miss, or that is next to nothing.
    let known =
        |o: &Outcome, row: &Row| o.reference[1] < 1e-5 || row.errors[0] > 3.0 * o.reference[1];
    let all: Vec<(&str, &Row)> = outcomes
        .iter()
        .flat_map(|o| o.rows.iter().filter(|row| known(o, row)).map(|row| (o.name, row)))
        .collect();
    let (won, lost): (Vec<_>, Vec<_>) = all.iter().partition(|(_, row)| times(row) < 1.0);
    let mut sorted: Vec<f64> = all.iter().map(|(_, row)| times(row)).collect();
    sorted.sort_by(f64::total_cmp);
    let mut scenes: Vec<&str> = won.iter().map(|(name, _)| *name).collect();
    scenes.dedup();
    write!(
        page,
        "\n## Verdict\n\nIn {} rows the reference is good enough to say what is missed. In {} of them adaptive quadrature takes longer than \
         a blue-noise cloud at equal error, {} times as long, with {} times as many evaluations as the cloud has points in contact; the median of all is {} times as long.",
        all.len(),
        lost.len(),
        range(lost.iter().map(|(_, row)| times(row))),
        range(lost.iter().map(|(_, row)| row.evaluations / row.clouds[1][0])),
        sorted.get(sorted.len() / 2).map_or("-".to_owned(), |median| short(*median)),
    )?;
    if !won.is_empty() {
        let once = won.iter().filter(|(_, row)| row.rounds < 1.5).count();
        write!(
            page,
            " It is faster in {}, {} times, {once} of which hardly halved anything, so that a rule for each triangle did it and no refinement: {}.",
            won.len(),
            range(won.iter().map(|(_, row)| 1.0 / times(row))),
            scenes.join("; "),
        )?;
    }
    let wrong = all.iter().filter(|(_, row)| row.errors[0] > row.wished).count();
    if wrong > 0 {
        write!(
            page,
            " In {wrong} rows it misses more of the force than was wished: a rule does not see what lies between its points."
        )?;
    }
    let each = all.iter().map(|(_, row)| 1e3 * row.time / row.evaluations);
    let point = outcomes.iter().map(|o| {
        let [_, [from, low, _], [to, high, _]] = o.random;
        1e3 * (high - low) / (to - from)
    });
    writeln!(
        page,
        " An evaluation costs it {} ns with what is decided about it, a point in contact {} ns of a query.",
        range(each),
        range(point),
    )?;
    let kept = 2 * won.len() > all.len();
    writeln!(
        page,
        "\nIt {} a denser cloud at equal error, so it is {}.",
        if kept { "mostly beats" } else { "does not beat" },
        if kept { "worth keeping" } else { "not kept: nothing but this measurement uses it" },
    )
}
