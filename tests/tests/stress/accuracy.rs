//! The contract at many points of each tool: half of them within 1e-6 of the surface or of a splitting curve, the
//! others anywhere, and besides all corners, points on the axis and beside it (item 4), and the points with the largest
//! errors that a search found.
//!
//! With `--nocapture` the test prints one line per tool.

use crate::prelude::*;
use crate::run;
use crate::validator::DEPTH;
use touchoff_tests::count::case_count;
use touchoff_tests::oracle::restated;
use touchoff_tests::points::{
    add_anywhere, add_beside_borders, add_turned, heights, neighbourhood,
};

/// Number of points that are evaluated at a time, so that a million take no gigabytes.
const POINTS_PER_CHUNK: usize = 1 << 15;

#[test]
fn every_tool_keeps_the_contract() {
    let count = case_count("POINTS", 6_000);
    let results = run(4, |subject, _, checks| {
        // Centres of a profile are given points of the half plane.
        let centres_are_rounded = restated::of(subject.name()).is_none();
        let validator = Validator::new(subject.tool, &*subject.truth);
        let validator = Validator { centres_are_rounded, ..validator };
        for chunk in points(&*subject.oracle, count, 2).chunks(POINTS_PER_CHUNK) {
            validator.validate(chunk, checks);
        }
    });
    results.iter().for_each(|checks| checks.print_line(DEPTH));
    assert_no_misses(&results);
}

const POINTS_PER_BORDER_POINT: usize = 16;

/// The points with the largest errors that a climbing search found: a tool's name and the coordinates, per line.
const HARD_POINTS: &str = include_str!("hard_points.tsv");

/// Returns `count` points: half of them anywhere in a box a tenth larger than the tool, half within 1e-6 of the
/// surface or of a splitting curve. Adds every corner and points one ulp beside it, points on the axis, and the points
/// with the largest errors that are known.
fn points(oracle: &dyn Oracle, count: usize, seed: u64) -> Vec<[f64; 3]> {
    let mut rng = Rng::new(seed);
    let mut points = Vec::new();
    add_anywhere(oracle, count / 2, &mut rng, &mut points);
    let border_points = count.div_ceil(2 * POINTS_PER_BORDER_POINT);
    let counts = [border_points, POINTS_PER_BORDER_POINT];
    add_beside_borders(oracle, counts, &mut rng, &mut points);
    for corner in oracle.corner_points() {
        for p in neighbourhood(oracle, corner) {
            add_turned(oracle, p, &[[1.0, 0.0], [0.0, -1.0], rng.azimuth()], &mut points);
        }
    }
    add_points_on_axis(oracle, count, &mut points);
    points.extend(hard_points(oracle.name()));
    points
}

/// Returns the points with the largest known errors of a tool.
fn hard_points(tool: &str) -> impl Iterator<Item = [f64; 3]> {
    let coordinate = |word: &str| word.parse().expect("a coordinate");
    let line = move |line: &str| {
        let words: Vec<&str> = line.split('\t').collect();
        let [name, x, y, z] = words[..] else { panic!("no name and three numbers: {line}") };
        (name == tool).then(|| [x, y, z].map(coordinate))
    };
    HARD_POINTS.lines().filter_map(line)
}

/// Adds points on the axis and as close to it as numbers go, at every height that a corner has and at others. Of a solid
/// without an axis, each coordinate of a corner takes these values.
fn add_points_on_axis(oracle: &dyn Oracle, count: usize, points: &mut Vec<[f64; 3]>) {
    let distances = [0.0, -0.0, 5e-324, 2f64.powi(-540)];
    if !oracle.is_revolved() {
        for corner in oracle.corner_points() {
            for value in distances.into_iter().flat_map(|d| [d, -d]) {
                points.extend([0, 1, 2].map(|axis| {
                    let mut p = corner;
                    p[axis] = value;
                    p
                }));
            }
        }
        return;
    }
    for z in heights(oracle, (count / 60).min(200) as u32) {
        for d in distances {
            points.extend([[d, 0.0, z], [-0.0, d, z], [-d, d, z], [-d, -0.0, z]]);
        }
    }
}
