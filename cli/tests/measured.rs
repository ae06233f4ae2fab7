//! `touchoff bench`: rows as objects, a page with its diagrams.

use serde_json::Value;
use std::process::{Command, Output};

fn touchoff(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_touchoff")).args(arguments).output().expect("the program runs")
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_scene_is_measured_row_by_row_and_makes_a_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let to = folder.path().join("page").display().to_string();
    let output = touchoff(&["bench", "--quick", "--scene", "CF1", "--json", "--out", &to]);
    assert!(output.status.success(), "{}", said(&output));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let rows: Vec<Value> =
        text.lines().map(|line| serde_json::from_str(line).expect("an object")).collect();
    assert!(rows.len() > 15, "{text}");
    for row in &rows {
        assert_eq!(row["scene"], "CF1");
        assert!(row["p50_ns"].as_u64().is_some_and(|ns| ns > 0), "{row}");
        assert!(row["err_depth"].as_f64().is_some_and(|error| error > 0.0), "{row}");
    }
    let force = |sampling: &str, weights: &str| {
        let of = |row: &&Value| row["sampling"] == sampling && row["weights"] == weights;
        let last = rows.iter().rfind(of).expect("such a row");
        last["err_force"].as_f64().expect("a number")
    };
    // With some hundred points in contact, the better spread and weighed, the nearer.
    assert!(force("blue", "cells") < 0.2 * force("random", "equal"));
    let proved = rows.iter().filter(|row| row["method"] == "certified");
    for row in proved {
        let (worst, tolerance) = (row["worst_depth"].as_f64(), row["tolerance"].as_f64());
        assert!(worst.zip(tolerance).is_some_and(|(w, t)| w <= t + 1e-12), "{row}");
        assert!(row["points"].is_null() && row["weights"].is_null() && row["err_force"].is_null());
    }
    let read = |name: &str| {
        let file = folder.path().join("page").join(name);
        std::fs::read_to_string(&file).unwrap_or_else(|_| panic!("{} is there", file.display()))
    };
    assert_eq!(read("work-precision.jsonl"), text);
    let page = read("work-precision.md");
    assert!(page.contains("## CF1") && page.contains("Orders of convergence"), "{page}");
    for quantity in ["force", "torque", "depth"] {
        let name = format!("work-precision-CF1-{quantity}.svg");
        assert!(page.contains(&name) && read(&name).starts_with("<svg"), "{name}");
    }
}

#[test]
fn what_is_asked_in_part_is_refused() {
    for (arguments, words) in [
        (&["bench", "--scene", "CF6"][..], "CF6"),
        (&["bench", "--part", "part.stl"][..], "--path"),
        (&["bench", "--tool", "D2Ball"][..], "--part"),
    ] {
        let output = touchoff(arguments);
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        assert!(said(&output).contains(words), "{}", said(&output));
    }
}
