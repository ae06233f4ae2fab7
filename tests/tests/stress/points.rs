//! Test points that are hard for an evaluator of a profile, and as many ordinary ones.

use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::oracle::{Nearest, Oracle};

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
    add_random_points(oracle, count / 2, &mut rng, &mut points);
    add_points_near_borders(
        oracle,
        count.div_ceil(2 * POINTS_PER_BORDER_POINT),
        &mut rng,
        &mut points,
    );
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

fn to_space([d, z]: [f64; 2], [cos, sin]: [f64; 2]) -> [f64; 3] {
    [d * cos, d * sin, z]
}

fn random_azimuth(rng: &mut Rng) -> [f64; 2] {
    let (sin, cos) = rng.between(0.0, std::f64::consts::TAU).sin_cos();
    [cos, sin]
}

/// Returns a unit vector across the axis: exactly along x or y, or in a random direction.
fn azimuth(rng: &mut Rng) -> [f64; 2] {
    match rng.bits() % 6 {
        0 => [1.0, 0.0],
        1 => [0.0, 1.0],
        2 => [-1.0, -0.0],
        3 => [0.0, -1.0],
        _ => random_azimuth(rng),
    }
}

fn add_random_points(oracle: &Nearest, count: usize, rng: &mut Rng, points: &mut Vec<[f64; 3]>) {
    let [radius, height] = oracle.extent();
    for _ in 0..count {
        let xy = [0; 2].map(|_| rng.between(-1.1 * radius, 1.1 * radius));
        points.push([xy[0], xy[1], rng.between(-0.05 * height, 1.05 * height)]);
    }
}

/// Finds border points by bisection of a line segment on whose ends the oracle disagrees.
fn add_points_near_borders(
    oracle: &Nearest,
    count: usize,
    rng: &mut Rng,
    points: &mut Vec<[f64; 3]>,
) {
    let curves = oracle.curves();
    let owner = |[d, z]: [f64; 2]| oracle.evaluate([d, 0.0, z]).map(|evaluation| evaluation.owner);
    let mut border_points = 0;
    while border_points < count {
        // Short curves as often as long ones.
        let curve = &curves[rng.bits() as usize % curves.len()];
        let sample = curve[rng.bits() as usize % curve.len()];
        let reach = 0.1 * oracle.extent()[0];
        let mut random_point_nearby = || {
            let mut step = || rng.between(-reach, reach);
            [(sample[0] + step()).abs(), sample[1] + step()]
        };
        let (mut a, mut b) = (random_point_nearby(), random_point_nearby());
        let first = owner(a);
        if first == owner(b) {
            continue;
        }
        border_points += 1;
        for _ in 0..45 {
            let middle = [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
            if owner(middle) == first { a = middle } else { b = middle }
        }
        for _ in 0..POINTS_PER_BORDER_POINT {
            // As many between 1e-16 and 1e-15 as between 1e-7 and 1e-6.
            let size = 10f64.powf(rng.between(-16.0, -6.0));
            let [cos, sin] = random_azimuth(rng);
            points.push(to_space([(a[0] + size * cos).abs(), a[1] + size * sin], azimuth(rng)));
        }
    }
}

/// Adds vertices, centres and ends of known curves, and points one ulp to either side in `d` and in `z`.
fn add_points_at_corners(oracle: &Nearest, rng: &mut Rng, points: &mut Vec<[f64; 3]>) {
    let neighbours = |v: f64| [v, v.next_up(), v.next_down()];
    for [d, z] in oracle.corners() {
        for d in neighbours(d) {
            for z in neighbours(z) {
                let azimuths = [[1.0, 0.0], [0.0, -1.0]].into_iter().chain([random_azimuth(rng)]);
                points.extend(azimuths.map(|azimuth| to_space([d.abs(), z], azimuth)));
            }
        }
    }
}

/// Adds points on the axis and as close to it as numbers go, at every height that a corner has and at others.
fn add_points_on_axis(oracle: &Nearest, points: &mut Vec<[f64; 3]>) {
    let height = oracle.extent()[1];
    let corners = oracle.corners().into_iter().flat_map(|[_, z]| [z, z.next_up(), z.next_down()]);
    let others = (0..=100).map(|k| height * f64::from(k) / 100.0);
    for z in corners.chain(others).chain([-0.0, 5e-324, -5e-324]) {
        for offset in [0.0, -0.0, 5e-324, 2f64.powi(-540)] {
            points.extend([[offset, 0.0, z], [-0.0, offset, z], [-offset, offset, z]]);
        }
    }
}
