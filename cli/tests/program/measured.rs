//! `touchoff bench`: one row per method, for the built-in part and for the user's own.

use super::bench::{rows, stderr, touchoff};
use serde_json::Value;
use touchoff::Unit;
use touchoff::mesh::shapes;

/// Errors fall with the number of points, and no depth is off by more than its bound.
#[test]
fn clouds_are_judged_by_certified_depth() {
    let rows = rows(&touchoff(&["bench", "--quick", "--json"]));
    let number =
        |row: &Value, key: &str| row[key].as_f64().unwrap_or_else(|| panic!("{key}: {row}"));
    let (clouds, certified): (Vec<_>, Vec<_>) =
        rows.iter().partition(|row| row["method"] == "cloud");
    assert_eq!([clouds.len(), certified.len()], [3, 3]);
    for row in clouds.iter().chain(&certified) {
        assert!(
            number(&row["query_time_ns"], "p50") > 0.0
                && number(&row["query_time_ns"], "p50") <= number(&row["query_time_ns"], "p99")
        );
        assert!(number(row, "depth_error") <= number(row, "depth_error_bound"), "{row}");
    }
    // The tightest certified depths are the reference. Their intervals are wider than the tolerance by rounding, and
    // the bound includes that.
    let tightest = certified[2];
    assert_eq!(number(tightest, "depth_error"), 0.0);
    assert!(number(tightest, "depth_error_bound") > number(tightest, "tolerance"), "{tightest}");
    let [few, many] = [clouds[0], clouds[2]];
    for error in ["force_error", "torque_error", "depth_error"] {
        assert!(
            0.0 < number(many, error) && number(many, error) < 0.5 * number(few, error),
            "{error}"
        );
    }
    assert!(certified.iter().all(|row| row["points"].is_null() && row["force_error"].is_null()));
}

/// A block of 6 by 6 by 2, and a ball of diameter 2 that goes 0.25 deep into its top: all answers are known.
#[test]
fn a_users_part_is_measured() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| folder.path().join(name).display().to_string();
    let [low, high] = [[-3.0, -3.0, -2.0], [3.0, 3.0, 0.0]].map(nalgebra::Point3::from);
    let mut bytes = Vec::new();
    let block = shapes::cuboid(low, high, Unit::Millimetre).expect("a block");
    block.write_stl(&mut bytes).expect("memory");
    std::fs::write(file("block.stl"), bytes).expect("a writable folder");
    let path: String =
        (0..20).map(|k| format!("{},0,-0.25,0,0,1\n", 0.05 * f64::from(k))).collect();
    std::fs::write(file("path.csv"), path).expect("a writable folder");
    let (part, path) = (file("block.stl"), file("path.csv"));
    let own = [
        "bench",
        "--quick",
        "--part",
        &part,
        "--unit",
        "mm",
        "--tool",
        "D2Ball",
        "--program",
        &path,
    ];
    let rows = rows(&touchoff(&[&own[..], &["--json"]].concat()));
    let worst = rows[2]["depth_error"].as_f64().expect("a number");
    // 10,000 points on 120 mm² are some 0.1 mm apart: the deepest is 0.05²/2 less deep.
    assert!((1e-6..5e-3).contains(&worst), "{worst}");
    let output = touchoff(&own);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.starts_with("D2Ball at 20 poses, 12 triangles; lengths in mm\nmethod"), "{text}");
    assert_eq!(text.lines().count(), 8, "{text}");
    for column in ["force error", "torque error", "depth error", "error bound"] {
        assert!(text.lines().nth(1).is_some_and(|header| header.contains(column)), "{text}");
    }
    let widths: Vec<usize> = text.lines().skip(1).map(|line| line.chars().count()).collect();
    assert!(widths.iter().all(|width| *width == widths[0]), "{text}");
}

#[test]
fn incomplete_options_are_refused() {
    for (arguments, words) in [
        (&["bench", "--seed", "-1"][..], "--seed"),
        (&["bench", "--part", "part.stl"][..], "--program"),
        (&["bench", "--tool", "D2Ball"][..], "--part"),
    ] {
        let output = touchoff(arguments);
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        assert!(stderr(&output).contains(words), "{}", stderr(&output));
    }
}
