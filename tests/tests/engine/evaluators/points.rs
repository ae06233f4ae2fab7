//! Test points that are hard for an evaluator, and plenty of ordinary ones.

use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::oracle::{Meridian, Oracle, displaced};

/// Number of points spread over the box; as many are close to borders.
const UNIFORM_POINTS: usize = 60_000;
/// Number of border points to find, and of points beside each.
const BORDER_POINTS: usize = 15_000;
const POINTS_PER_BORDER_POINT: usize = 4;

/// Returns at least 100,000 points for a tool, from a seed.
pub(crate) fn all(oracle: &dyn Oracle, seed: u64) -> Vec<[f64; 3]> {
    let mut rng = Rng::new(seed);
    let mut points = Vec::new();
    uniform(oracle, &mut rng, &mut points);
    beside_borders(oracle, &mut rng, &mut points);
    exact(oracle, &mut rng, &mut points);
    axis(oracle, &mut rng, &mut points);
    assert!(points.len() >= 100_000);
    points
}

/// Returns unit vectors across the axis: exactly along x and y, and two in random directions.
fn azimuths(rng: &mut Rng) -> [[f64; 2]; 6] {
    let mut random_point = || {
        let (sin, cos) = rng.between(0.0, std::f64::consts::TAU).sin_cos();
        [cos, sin]
    };
    [[1.0, 0.0], [0.0, 1.0], [-1.0, -0.0], [0.0, -1.0], random_point(), random_point()]
}

fn to_space([d, z]: [f64; 2], [cos, sin]: [f64; 2]) -> [f64; 3] {
    [d * cos, d * sin, z]
}

/// Adds points in a box a tenth larger than the tool.
fn uniform(oracle: &dyn Oracle, rng: &mut Rng, points: &mut Vec<[f64; 3]>) {
    let [radius, height] = oracle.extent();
    for _ in 0..UNIFORM_POINTS {
        let xy = [0; 2].map(|_| rng.between(-1.1 * radius, 1.1 * radius));
        points.push([xy[0], xy[1], rng.between(-0.05 * height, 1.05 * height)]);
    }
}

/// Adds points within 1e-6 of the surface or a splitting curve. These are found by bisection of a line segment on
/// whose ends the oracle disagrees, so that nothing but the oracle's evaluation is trusted.
fn beside_borders(oracle: &dyn Oracle, rng: &mut Rng, points: &mut Vec<[f64; 3]>) {
    let samples: Vec<[f64; 3]> = oracle.curve_points().into_iter().flatten().collect();
    let owner = |p: [f64; 3]| oracle.evaluate(p).map(|evaluation| evaluation.owner);
    let mut found = 0;
    while found < BORDER_POINTS {
        let sample = samples[rng.bits() as usize % samples.len()];
        let reach = 0.05 * oracle.extent()[0];
        let mut near = || {
            let step = [0; 3].map(|_| rng.between(-reach, reach));
            displaced(oracle, sample, step, 0.0)
        };
        let (mut a, mut b) = (near(), near());
        let first = owner(a);
        if first == owner(b) {
            continue;
        }
        found += 1;
        for _ in 0..45 {
            let middle = [0, 1, 2].map(|k| (a[k] + b[k]) / 2.0);
            if owner(middle) == first { a = middle } else { b = middle }
        }
        for _ in 0..POINTS_PER_BORDER_POINT {
            // As many between 1e-16 and 1e-15 as between 1e-7 and 1e-6.
            let size = 10f64.powf(rng.between(-16.0, -6.0));
            let neighbour = displaced(oracle, a, rng.direction().map(|c| size * c), 0.0);
            let azimuths = azimuths(rng);
            let azimuth = azimuths[rng.bits() as usize % azimuths.len()];
            points.push(turned(oracle, neighbour, azimuth));
        }
    }
}

/// Adds every corner and every sample of a curve, and points one ulp to either side of it in each coordinate.
fn exact(oracle: &dyn Oracle, rng: &mut Rng, points: &mut Vec<[f64; 3]>) {
    let neighbours = |v: f64| [v, v.next_up(), v.next_down()];
    let curves = oracle.curve_points().into_iter().flatten();
    for [x, y, z] in oracle.corner_points().into_iter().chain(curves) {
        for x in neighbours(x) {
            for z in neighbours(z) {
                if oracle.is_revolved() {
                    points.extend(azimuths(rng).map(|azimuth| to_space([x.abs(), z], azimuth)));
                } else {
                    points.extend(neighbours(y).map(|y| [x, y, z]));
                }
            }
        }
    }
}

/// Returns a point of the half plane y = 0 turned about z if the solid is one of revolution; of another solid as it
/// is.
fn turned(oracle: &dyn Oracle, p: [f64; 3], azimuth: [f64; 2]) -> [f64; 3] {
    if oracle.is_revolved() { to_space([p[0], p[2]], azimuth) } else { p }
}

/// Adds points on the axis and as close to it as numbers go, at every height that a corner has and at others.
fn axis(oracle: &dyn Oracle, rng: &mut Rng, points: &mut Vec<[f64; 3]>) {
    const CLOSE: [f64; 8] = [0.0, 5e-324, 1e-310, 1.7e-162, 1.6e-154, 1e-100, 1e-20, f64::EPSILON];
    let height = oracle.extent()[1];
    let mut heights: Vec<f64> = oracle.corner_points().into_iter().map(|[.., z]| z).collect();
    heights.sort_by(f64::total_cmp);
    heights.dedup();
    let corners = heights.into_iter().flat_map(|z| [z, z.next_up(), z.next_down()]);
    let others = (0..=200).map(|k| height * f64::from(k) / 200.0);
    for z in corners.chain(others).chain([-0.0, 5e-324, -5e-324]) {
        for offset in CLOSE.into_iter().chain([2f64.powi(-540)]) {
            for [sx, sy] in
                [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            {
                points.push([offset * sx, offset * sy, z]);
            }
            let (sin, cos) = rng.between(0.0, std::f64::consts::TAU).sin_cos();
            points.push([offset * cos, offset * sin, z]);
        }
    }
}

/// Returns the scale of a tool's rounding, S: the next power of two above its largest coordinate.
pub(crate) fn scale(oracle: &dyn Oracle) -> f64 {
    let [radius, height] = oracle.extent();
    let mut scale = 1.0;
    while scale <= radius.max(height) {
        scale *= 2.0;
    }
    scale
}

/// Formats a point: its coordinates in the half plane, and in space to the last bit.
pub(crate) fn format_point(p: [f64; 3]) -> String {
    let [d, z] = Meridian::of(p).dz;
    format!("(d, z) = ({d:e}, {z:e}), p = {p:?}")
}
