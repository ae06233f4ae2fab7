//! Points that are hard for an evaluator: beside borders, and beside the axis.

use crate::oracle::rng::Rng;
use crate::oracle::{Oracle, displaced};

/// Distances from the axis as small as numbers go.
pub const BESIDE_AXIS: [f64; 9] =
    [0.0, 5e-324, 1e-310, 1.7e-162, 1.6e-154, 1e-100, 1e-20, f64::EPSILON, TINY];

/// The square of this vanishes.
const TINY: f64 = f64::from_bits(0x1e30_0000_0000_0000);

/// Returns a point of the half plane y = 0 turned about z.
pub fn to_space([d, z]: [f64; 2], [cos, sin]: [f64; 2]) -> [f64; 3] {
    [d * cos, d * sin, z]
}

/// Returns a number and its two neighbours.
pub fn neighbours(number: f64) -> [f64; 3] {
    [number, number.next_up(), number.next_down()]
}

/// Returns a point and those one ulp beside it; of a solid of revolution those in the half plane y = 0.
pub fn neighbourhood(oracle: &dyn Oracle, [x, y, z]: [f64; 3]) -> Vec<[f64; 3]> {
    let ys = if oracle.is_revolved() { vec![y] } else { neighbours(y).to_vec() };
    let columns = neighbours(x).into_iter().flat_map(|x| neighbours(z).map(|z| [x, z]));
    columns.flat_map(|[x, z]| ys.iter().map(move |y| [x, *y, z])).collect()
}

/// Adds a point of a solid of revolution turned by each azimuth; of another solid the point itself.
pub fn add_turned(
    oracle: &dyn Oracle,
    p: [f64; 3],
    azimuths: &[[f64; 2]],
    points: &mut Vec<[f64; 3]>,
) {
    if oracle.is_revolved() {
        points.extend(azimuths.iter().map(|azimuth| to_space([p[0].abs(), p[2]], *azimuth)));
    } else {
        points.push(p);
    }
}

/// Returns unit vectors across the axis: exactly along x and y, and two in random directions.
pub fn azimuths(rng: &mut Rng) -> [[f64; 2]; 6] {
    [[1.0, 0.0], [0.0, 1.0], [-1.0, -0.0], [0.0, -1.0], rng.azimuth(), rng.azimuth()]
}

/// Adds points anywhere in a box a tenth larger than the tool.
pub fn add_anywhere(oracle: &dyn Oracle, count: usize, rng: &mut Rng, points: &mut Vec<[f64; 3]>) {
    let [radius, height] = oracle.extent();
    points.extend((0..count).map(|_| {
        let [x, y] = [0; 2].map(|_| rng.between(-1.1 * radius, 1.1 * radius));
        [x, y, rng.between(-0.05 * height, 1.05 * height)]
    }));
}

/// Adds points within 1e-6 of the surface or a splitting curve, `per_border_point` of them around each of `count` border
/// points. These are found beside samples of the curves, short ones as often as long ones, by bisection of a line segment
/// on whose ends the oracle disagrees, so that nothing but the oracle's evaluation is trusted.
pub fn add_beside_borders(
    oracle: &dyn Oracle,
    [count, per_border_point]: [usize; 2],
    rng: &mut Rng,
    points: &mut Vec<[f64; 3]>,
) {
    let curves = oracle.curve_points();
    let owner = |p: [f64; 3]| oracle.evaluate(p).map(|evaluation| evaluation.owner);
    let reach = 0.1 * oracle.extent()[0];
    let mut found = 0;
    while found < count {
        let curve = &curves[rng.index(curves.len())];
        let sample = curve[rng.index(curve.len())];
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
        for _ in 0..per_border_point {
            // As many between 1e-16 and 1e-15 as between 1e-7 and 1e-6.
            let size = rng.power(-16.0, -6.0);
            let neighbour = displaced(oracle, a, rng.direction().map(|c| size * c), 0.0);
            let azimuth = azimuths(rng)[rng.index(6)];
            add_turned(oracle, neighbour, &[azimuth], points);
        }
    }
}

/// Returns the heights of corners and their neighbours, `count` others from 0 to the top, and the smallest numbers.
pub fn heights(oracle: &dyn Oracle, count: u32) -> Vec<f64> {
    let mut corners: Vec<f64> = oracle.corner_points().into_iter().map(|[.., z]| z).collect();
    corners.sort_by(f64::total_cmp);
    corners.dedup();
    let top = oracle.extent()[1];
    let others = (0..=count).map(|k| top * f64::from(k) / f64::from(count));
    let tiny = [-0.0, 5e-324, -5e-324, TINY];
    corners.into_iter().flat_map(neighbours).chain(others).chain(tiny).collect()
}
