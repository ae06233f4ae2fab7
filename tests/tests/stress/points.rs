//! Test points that are hard for an evaluator of a profile, and as many ordinary ones.

use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::oracle::{Nearest, Oracle};
use touchoff_tests::points::{add_anywhere, add_beside_borders, heights, neighbours, to_space};

/// Number of points beside each border point that is found.
const POINTS_PER_BORDER_POINT: usize = 16;

/// The points with the largest errors that a climbing search found: a tool's name and the coordinates, per line.
const HARD_POINTS: &str = include_str!("hard_points.tsv");

/// Returns `count` points: half of them anywhere in a box a tenth larger than the tool, half within 1e-6 of the
/// surface or of a splitting curve. Adds every vertex, every centre, points on the axis, and the points with the
/// largest errors that are known.
pub(crate) fn points(oracle: &Nearest, count: usize, seed: u64) -> Vec<[f64; 3]> {
    let mut rng = Rng::new(seed);
    let mut points = Vec::new();
    add_anywhere(oracle, count / 2, &mut rng, &mut points);
    let border_points = count.div_ceil(2 * POINTS_PER_BORDER_POINT);
    let counts = [border_points, POINTS_PER_BORDER_POINT];
    add_beside_borders(oracle, counts, &mut rng, &mut points);
    add_points_at_corners(oracle, &mut rng, &mut points);
    add_points_on_axis(oracle, &mut points);
    points.extend(hard_points(oracle.name()));
    points
}

/// Returns the points with the largest known errors of a tool.
///
/// # Panics
/// If a line of the list is not a name and three numbers.
fn hard_points(tool: &str) -> impl Iterator<Item = [f64; 3]> {
    let coordinate = |word: &str| word.parse().expect("a coordinate");
    let line = move |line: &str| {
        let words: Vec<&str> = line.split('\t').collect();
        let [name, x, y, z] = words[..] else { panic!("no name and three numbers: {line}") };
        (name == tool).then(|| [x, y, z].map(coordinate))
    };
    HARD_POINTS.lines().filter_map(line)
}

/// Adds vertices, centres and ends of known curves, and points one ulp to either side in `d` and in `z`.
fn add_points_at_corners(oracle: &Nearest, rng: &mut Rng, points: &mut Vec<[f64; 3]>) {
    for [d, z] in oracle.corners() {
        for d in neighbours(d) {
            for z in neighbours(z) {
                let azimuths = [[1.0, 0.0], [0.0, -1.0]].into_iter().chain([rng.azimuth()]);
                points.extend(azimuths.map(|azimuth| to_space([d.abs(), z], azimuth)));
            }
        }
    }
}

/// Adds points on the axis and as close to it as numbers go, at every height that a corner has and at others.
fn add_points_on_axis(oracle: &Nearest, points: &mut Vec<[f64; 3]>) {
    for z in heights(oracle, 100) {
        for offset in [0.0, -0.0, 5e-324, 2f64.powi(-540)] {
            points.extend([[offset, 0.0, z], [-0.0, offset, z], [-offset, offset, z]]);
        }
    }
}
