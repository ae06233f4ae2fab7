//! Test points that are hard for an evaluator of a tool, and as many ordinary ones.

use touchoff_tests::oracle::Oracle;
use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::points::{
    add_anywhere, add_beside_borders, add_turned, heights, neighbourhood,
};

const POINTS_PER_BORDER_POINT: usize = 16;

/// The points with the largest errors that a climbing search found: a tool's name and the coordinates, per line.
const HARD_POINTS: &str = include_str!("hard_points.tsv");

/// Returns `count` points: half of them anywhere in a box a tenth larger than the tool, half within 1e-6 of the
/// surface or of a splitting curve. Adds every corner and points one ulp beside it, points on the axis, and the points
/// with the largest errors that are known.
pub(crate) fn points(oracle: &dyn Oracle, count: usize, seed: u64) -> Vec<[f64; 3]> {
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
