//! Test points that are hard for an evaluator, and plenty of ordinary ones.

use crate::prelude::*;
use touchoff_tests::count::case_count;
use touchoff_tests::oracle::Meridian;
use touchoff_tests::oracle::reference::power_above;
use touchoff_tests::points::{
    BESIDE_AXIS, add_anywhere, add_beside_borders, add_turned, azimuths, heights, neighbourhood,
    to_space,
};

const POINTS_PER_BORDER_POINT: usize = 4;

/// Returns points for a tool, from a seed: 2,000 spread over the box, and as many close to borders, or as many as the variable `EVALUATED`
/// says; corners, curves and the axis beside them.
pub(crate) fn all(oracle: &dyn Oracle, seed: u64) -> Vec<[f64; 3]> {
    let mut rng = Rng::new(seed);
    let mut points = Vec::new();
    let count = case_count("EVALUATED", 2_000);
    add_anywhere(oracle, count, &mut rng, &mut points);
    let border_points = [count / POINTS_PER_BORDER_POINT, POINTS_PER_BORDER_POINT];
    add_beside_borders(oracle, border_points, &mut rng, &mut points);
    exact(oracle, &mut rng, &mut points);
    axis(oracle, &mut rng, &mut points);
    assert!(points.len() >= 15 * count / 10);
    points
}

/// Adds every corner and every sample of a curve, and points one ulp to either side of it in each coordinate.
fn exact(oracle: &dyn Oracle, rng: &mut Rng, points: &mut Vec<[f64; 3]>) {
    let curves = oracle.curve_points().into_iter().flatten();
    for p in oracle.corner_points().into_iter().chain(curves) {
        for neighbour in neighbourhood(oracle, p) {
            add_turned(oracle, neighbour, &azimuths(rng), points);
        }
    }
}

/// Adds points on the axis and as close to it as numbers go, at every height that a corner has and at others.
fn axis(oracle: &dyn Oracle, rng: &mut Rng, points: &mut Vec<[f64; 3]>) {
    for z in heights(oracle, 200) {
        for offset in BESIDE_AXIS {
            for [sx, sy] in
                [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            {
                points.push([offset * sx, offset * sy, z]);
            }
            points.push(to_space([offset, z], rng.azimuth()));
        }
    }
}

/// Returns the scale of a tool's rounding, S: the next power of two above its largest coordinate.
pub(crate) fn scale(oracle: &dyn Oracle) -> f64 {
    let [radius, height] = oracle.extent();
    power_above(radius.max(height)).max(1.0)
}

/// Formats a point: its coordinates in the half plane, and in space to the last bit.
pub(crate) fn format_point(p: [f64; 3]) -> String {
    let [d, z] = Meridian::of(p).dz;
    format!("(d, z) = ({d:e}, {z:e}), p = {p:?}")
}
