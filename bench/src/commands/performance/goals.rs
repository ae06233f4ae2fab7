//! Goals beside what was reached.

use super::{Row, select};
use std::fmt::Write;

/// A goal: its words, what was measured, and the most that it allows.
struct Goal {
    words: String,
    found: Option<f64>,
    most: f64,
    unit: &'static str,
}

/// The goals as a table; what the rows do not tell is left out.
pub(super) fn table(rows: &[Row]) -> Result<String, String> {
    let mut text = String::from("| goal | measured | allowed | |\n|---|--:|--:|---|\n");
    for goal in goals(rows)? {
        let Some(found) = goal.found else { continue };
        let met = if found <= goal.most { "met" } else { "**missed**" };
        let (unit, most) = (goal.unit, goal.most);
        // Writing to a String does not fail.
        let _ = writeln!(
            text,
            "| {} | {} {unit} | {} {unit} | {met} |",
            goal.words,
            figure(found),
            figure(most)
        );
    }
    Ok(text)
}

fn goals(rows: &[Row]) -> Result<Vec<Goal>, String> {
    let mut goals = Vec::new();
    for (points, outside, inside) in [
        (1_000.0, 80.0, 100.0),
        (20_000.0, 230.0, 310.0),
        (100_000.0, 550.0, 870.0),
        (1e6, 3_100.0, 5_700.0),
    ] {
        for (scene, most) in [("outside", outside), ("inside", inside)] {
            let found = query(rows, (points, scene, "wrench"), "ns_best")?;
            let words = format!("a wrench, {scene}, {points} points");
            goals.push(Goal { words, found, most, unit: "ns" });
        }
    }
    let found = query(rows, (20_000.0, "hold", "wrench"), "ns_best")?;
    goals.push(Goal {
        words: "a wrench, hold, 20000 points".into(),
        found,
        most: 4_000.0,
        unit: "ns",
    });
    let found = query(rows, (20_000.0, "outside", "detect"), "ns_best")?;
    goals.push(Goal {
        words: "yes or no, outside, 20000 points".into(),
        found,
        most: 110.0,
        unit: "ns",
    });
    for scene in ["outside", "inside"] {
        let words = format!("a colliding point, {scene}, 1000000 points");
        let found = query(rows, (1e6, scene, "wrench"), "ns_a_point")?;
        goals.push(Goal { words, found, most: 5.0, unit: "ns" });
        let [p99, p50] =
            ["ns_p99", "ns_p50"].map(|key| query(rows, (20_000.0, scene, "wrench"), key));
        let found = p99?.zip(p50?).map(|(p99, p50)| p99 / p50);
        let words = format!("p99 by p50, {scene}, 20000 points");
        goals.push(Goal { words, found, most: 2.5, unit: "" });
    }
    let apart = select(rows, &[("table", "apart"), ("asked", "wrench")]);
    let found =
        apart.filter(|row| row.is("gap", 100.0)).find_map(|row| row.number("ns_best").transpose());
    goals.push(Goal {
        words: "apart by 100".into(),
        found: found.transpose()?,
        most: 16.0,
        unit: "ns",
    });
    for (points, most) in [(20_000.0, 1.5), (1e6, 250.0)] {
        let mut built = select(rows, &[("table", "build")]).filter(|row| row.is("points", points));
        let found = built.find_map(|row| row.number("tree_ms_best").transpose()).transpose()?;
        goals.push(Goal {
            words: format!("a part of {points} points, built"),
            found,
            most,
            unit: "ms",
        });
    }
    let mut built = select(rows, &[("table", "build")]).filter(|row| row.is("points", 20_000.0));
    let found = built.find_map(|row| row.number("geometry_bytes").transpose()).transpose()?;
    goals.push(Goal {
        words: "geometry of a point of 20000".into(),
        found,
        most: 14.0,
        unit: "bytes",
    });
    for scene in ["outside", "inside"] {
        let words = [("table", "ablation"), ("skip", "level: wrench, AVX2"), ("scene", scene)];
        let row = select(rows, &words).find(|row| row.is("points", 20_000.0));
        let found = row.map_or(Ok(None), |row| row.number("ratio"))?;
        let words = format!("AVX2 by AVX-512, {scene}, 20000 points");
        goals.push(Goal { words, found, most: 1.6, unit: "" });
    }
    goals.extend(against_peers(rows)?);
    Ok(goals)
}

/// This project's time as a part of others', which is to be at most one by so much.
fn against_peers(rows: &[Row]) -> Result<Vec<Goal>, String> {
    let mut goals = Vec::new();
    for (method, points, times) in [
        ("parry-bvh", 20_000.0, 5.0),
        ("parry-bvh", 1e6, 8.0),
        ("fidget", 20_000.0, 15.0),
        ("fidget", 1e6, 15.0),
        ("thesis", 20_000.0, 40.0),
        ("thesis", 1e6, 40.0),
    ] {
        for scene in ["outside", "inside"] {
            let of = |method| {
                let words = [("table", "peers"), ("scene", scene), ("method", method)];
                let row = select(rows, &words).find(|row| row.is("points", points));
                row.map_or(Ok(None), |row| row.number("cpu_avg"))
            };
            let found = of("touchoff")?.zip(of(method)?).map(|(own, other)| own / other);
            let words = format!(
                "of the time of `{method}`, {scene}, {points} points: one part in {times}; {} here",
                found.map_or_else(String::new, |part| format!("one in {:.1}", 1.0 / part)),
            );
            goals.push(Goal { words, found, most: 1.0 / times, unit: "" });
        }
    }
    Ok(goals)
}

fn query(
    rows: &[Row],
    (points, scene, asked): (f64, &str, &str),
    key: &str,
) -> Result<Option<f64>, String> {
    let words = [("table", "query"), ("scene", scene), ("asked", asked)];
    let row = select(rows, &words).find(|row| row.is("points", points));
    row.map_or(Ok(None), |row| row.number(key))
}

/// Three digits.
fn figure(value: f64) -> String {
    match value.abs() {
        size if size >= 100.0 => format!("{value:.0}"),
        size if size >= 10.0 => format!("{value:.1}"),
        size if size >= 1.0 => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    }
}
