//! The plots of `docs/performance/`, and beside them `goals.md`, of rows that the benches wrote:
//!
//! ```sh
//! cargo bench -p touchoff-bench --features peers --bench peers -- --json > peers.json
//! cargo bench -p touchoff-bench --features peers --bench scaling -- --json > scaling.json
//! cargo run --release -p touchoff-bench -- performance peers.json scaling.json
//! ```

mod goals;

use clap::Args;
use serde_json::Value;
use std::error::Error;
use std::path::{Path, PathBuf};
use touchoff_bench::page::Page;
use touchoff_bench::plot::{Axis, Fit, Mark, Plot, Series};

/// Points of the clouds whose errors are drawn against time.
const COMPARED: f64 = 20_000.0;
/// The cycle of a haptic device, µs.
const CYCLE: f64 = 1e3;
/// Samples of a fitted line, which is bent on logarithmic axes.
const SAMPLES: u32 = 60;
/// The colours of what is no method or scene.
const GREY: usize = 9;

/// Draws the plots of `docs/performance`, and writes its `goals.md`, whatever `--to` says.
///
/// A plot for which the files have no rows is left as it was.
#[derive(Args)]
pub(crate) struct Performance {
    /// Files of rows, an object a line, that the benches `peers`, `scaling` and `ablation` write with `--json`.
    #[arg(required = true, value_name = "ROWS.json")]
    files: Vec<PathBuf>,
}

impl Performance {
    pub(crate) fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        let mut rows = Vec::new();
        for file in &self.files {
            rows.extend(read(file)?);
        }
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/performance");
        std::fs::create_dir_all(&folder)?;
        std::fs::write(folder.join("goals.md"), goals::table(&rows)?)?;
        for (name, plot) in plots(&rows)? {
            if plot.is_empty() {
                eprintln!("{name}.svg: no rows for it");
                continue;
            }
            std::fs::write(folder.join(format!("{name}.svg")), plot.svg())?;
            eprintln!("{name}.svg: {} points left out", plot.left_out());
        }
        Ok(None)
    }
}

fn plots(rows: &[Row]) -> Result<Vec<(String, Plot)>, String> {
    let mut plots = Vec::new();
    for scene in ["outside", "inside", "hold"] {
        plots.push((format!("peers-{scene}"), peers(rows, scene)?));
        plots.push((format!("error-{scene}"), error(rows, scene)?));
    }
    plots.push(("points".to_owned(), points(rows)?));
    plots.push(("contact".to_owned(), contact(rows)?));
    plots.push(("apart".to_owned(), apart(rows)?));
    plots.push(("build".to_owned(), build(rows)?));
    Ok(plots)
}

/// Time against points, for every method; the slowest stand first, as at the plot's right end.
fn peers(rows: &[Row], scene: &str) -> Result<Plot, String> {
    let mut lines = Vec::new();
    for (look, method) in methods(rows).into_iter().enumerate() {
        let of = [("table", "peers"), ("scene", scene), ("method", method)];
        let line = places(select(rows, &of), ["points", "cpu_avg"], [1.0, 1e-3])?;
        lines.push((line.last().map_or(0.0, |place| place[1]), series(look, method, line)));
    }
    lines.sort_by(|a, b| b.0.total_cmp(&a.0));
    let plot = Plot::new(
        format!("Time of a query, {scene}"),
        Axis::log("points of the cloud"),
        Axis::log("CPU time of a query, µs"),
    );
    let plot = plot.mark(Mark::across(CYCLE, "a cycle of 1 kHz"));
    Ok(lines.into_iter().fold(plot, |plot, (_, line)| plot.with(line)))
}

/// Error of the force against time, and what is not beaten in both.
fn error(rows: &[Row], scene: &str) -> Result<Plot, String> {
    let mut plot = Plot::new(
        format!("Error of the force against time, {scene}, 20,000 points"),
        Axis::log("CPU time of a query, µs"),
        Axis::log("error of the force, relative"),
    );
    let (mut all, mut found) = (Vec::new(), Vec::new());
    for (look, method) in methods(rows).into_iter().enumerate() {
        let of = [("table", "peers"), ("scene", scene), ("method", method)];
        let same = select(rows, &of).filter(|row| row.is("points", COMPARED));
        let places = places(same, ["cpu_avg", "err_force"], [1e-3, 1.0])?;
        all.extend(places.iter().copied().filter(|place| place[1] > 0.0));
        if !places.is_empty() {
            found.push(emphasised(Series::points(method, places).look(look), method));
        }
    }
    if !all.is_empty() {
        plot = plot.with(Series::front("not beaten", &all).look(GREY));
    }
    Ok(found.into_iter().fold(plot, Plot::with))
}

/// Time of this project against points, for both questions.
fn points(rows: &[Row]) -> Result<Plot, String> {
    let mut plot = Plot::new(
        "Time of a query, machine undisturbed",
        Axis::log("points of the cloud"),
        Axis::log("time of a query, µs"),
    )
    .mark(Mark::across(CYCLE, "a cycle of 1 kHz"));
    for (look, scene) in ["outside", "inside", "hold"].into_iter().enumerate() {
        for (asked, word) in [("wrench", "force and torque"), ("detect", "yes or no")] {
            let of = [("table", "query"), ("scene", scene), ("asked", asked)];
            let line = places(select(rows, &of), ["points", "ns_best"], [1.0, 1e-3])?;
            let name = format!("{scene}, {word}");
            let line = if asked == "wrench" {
                Series::line(name, line)
            } else {
                Series::dashes(name, line)
            };
            plot = plot.with(line.look(look));
        }
    }
    Ok(plot)
}

/// Time against what collides, with the bench's straight lines.
fn contact(rows: &[Row]) -> Result<Plot, String> {
    let mut plot = Plot::new(
        "Time by how many points collide",
        Axis::log("colliding points"),
        Axis::log("time of a wrench, µs"),
    );
    for (look, scene) in ["wall", "outside", "inside", "hold"].into_iter().enumerate() {
        let of = [("table", "contact"), ("scene", scene)];
        let found = places(select(rows, &of), ["colliding_avg", "ns_best"], [1.0, 1e-3])?;
        let ends = [found.first(), found.last()].map(|end| end.map_or(1.0, |place| place[0]));
        plot = plot.with(Series::points(scene, found).look(look));
        for row in select(rows, &[("table", "fit"), ("scene", scene)]) {
            if let [Some(at_zero), Some(slope)] =
                [row.number("ns_at_zero")?, row.number("ns_a_point")?]
            {
                let name = format!("{:.2} µs + {slope:.1} ns a point", at_zero / 1e3);
                let line = sampled(Fit { at_zero: at_zero / 1e3, slope: slope / 1e3 }, ends);
                plot = plot.with(Series::dashes(name, line).look(look));
            }
        }
    }
    Ok(plot)
}

/// Time at a distance.
fn apart(rows: &[Row]) -> Result<Plot, String> {
    let mut plot = Plot::new(
        "Time of a query, apart",
        Axis::log("from the ball to the wall, mm"),
        Axis::log("time of a query, ns"),
    );
    for (look, (asked, word)) in
        [("wrench", "force and torque"), ("detect", "yes or no")].into_iter().enumerate()
    {
        let of = [("table", "apart"), ("asked", asked)];
        let best = places(select(rows, &of), ["gap", "ns_best"], [1.0, 1.0])?;
        let worst = places(select(rows, &of), ["gap", "ns_p99"], [1.0, 1.0])?;
        plot = plot.with(Series::line(word, best).look(look));
        plot = plot.with(Series::dashes(format!("{word}, p99"), worst).look(look));
    }
    Ok(plot)
}

/// Time to make a part.
fn build(rows: &[Row]) -> Result<Plot, String> {
    let of = [("table", "build")];
    let line = |key| places(select(rows, &of), ["points", key], [1.0, 1.0]);
    let plot =
        Plot::new("Time to make a part", Axis::log("points of the cloud"), Axis::log("time, ms"));
    Ok(plot
        .with(Series::line("part of a cloud", line("tree_ms_best")?))
        .with(Series::line("cloud of a mesh", line("cloud_ms_best")?)))
}

/// Methods of `peers`, each once, in their order: their numbers are their colours.
fn methods(rows: &[Row]) -> Vec<&str> {
    let mut methods = Vec::new();
    for method in rows.iter().filter_map(|row| row.text("method")) {
        if !methods.contains(&method) {
            methods.push(method);
        }
    }
    methods
}

fn series(look: usize, method: &str, places: Vec<[f64; 2]>) -> Series {
    emphasised(Series::line(method, places).look(look), method)
}

/// This project is what the plots are about.
fn emphasised(series: Series, method: &str) -> Series {
    if method == "touchoff" { series.bold() } else { series }
}

/// A line between two places on a logarithmic axis.
fn sampled(line: Fit, [from, to]: [f64; 2]) -> Vec<[f64; 2]> {
    let steps = (0..=SAMPLES).map(|k| f64::from(k) / f64::from(SAMPLES));
    let places = steps.map(|share| from * (to / from).powf(share));
    places.map(|x| [x, line.at(x)]).collect()
}

/// One object of a bench.
struct Row(Value);

impl Row {
    /// Rows of `peers` name no table.
    fn text(&self, key: &str) -> Option<&str> {
        let text = self.0.get(key).and_then(Value::as_str);
        text.or((key == "table").then_some("peers"))
    }

    fn is(&self, key: &str, value: f64) -> bool {
        self.0.get(key).and_then(Value::as_f64) == Some(value)
    }

    /// `None` for what could not be measured.
    fn number(&self, key: &str) -> Result<Option<f64>, String> {
        match self.0.get(key) {
            Some(Value::Null) => Ok(None),
            Some(Value::Number(number)) => Ok(number.as_f64()),
            _ => Err(format!("no number {key:?} in {}: run the bench again", self.0)),
        }
    }
}

fn read(file: &Path) -> Result<Vec<Row>, Box<dyn Error>> {
    let name = file.display();
    let text = std::fs::read_to_string(file).map_err(|error| format!("{name}: {error}"))?;
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let rows = lines.map(|(at, line)| match serde_json::from_str(line) {
        Ok(row @ Value::Object(_)) => Ok(Row(row)),
        _ => Err(format!("{name}:{}: no object: write it by `-- --json`", at + 1)),
    });
    Ok(rows.collect::<Result<_, _>>()?)
}

/// Rows that have these words.
fn select<'a>(rows: &'a [Row], words: &'a [(&str, &str)]) -> impl Iterator<Item = &'a Row> {
    let has = |row: &Row| words.iter().all(|(key, word)| row.text(key) == Some(word));
    rows.iter().filter(move |row| has(row))
}

/// Two numbers of each row that has both, in another unit, from left to right.
fn places<'a>(
    rows: impl Iterator<Item = &'a Row>,
    keys: [&str; 2],
    units: [f64; 2],
) -> Result<Vec<[f64; 2]>, String> {
    let mut places = Vec::new();
    for row in rows {
        if let [Some(x), Some(y)] = [row.number(keys[0])?, row.number(keys[1])?] {
            places.push([x * units[0], y * units[1]]);
        }
    }
    places.sort_by(|a, b| a[0].total_cmp(&b[0]));
    Ok(places)
}
