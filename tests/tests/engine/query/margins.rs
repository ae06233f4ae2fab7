//! Points so close to the tool's surface and splitting curves that only margins keep them. Every one that belongs
//! to the tool must be found, however large the part that it lies on.

use super::compare::{Case, Statistics, tools};
use super::parts;
use crate::prelude::*;
use touchoff_tests::oracle::displaced;

/// Checks points by the tool's curves, displaced by 0 and from 1e-15 to 1e-3, moved to a pose, among others over a
/// part of `size`.
fn compare_surface_points(tool_at: usize, size: f64, offset: f64, seed: u64) -> Statistics {
    let (tool, oracle) = tools().swap_remove(tool_at);
    let mut rng = Rng::new(seed);
    let centre = Point3::from(offset * parts::direction(&mut rng));
    let pose = parts::bringing(Vector3::zeros(), centre, &mut rng);
    let own = own_points(&*oracle, &mut rng).into_iter();
    let mut points: Vec<_> = own.map(|q| pose.tip() + pose.rotation() * q).collect();
    points.extend((0..500).map(|_| Point3::from(parts::vector(&mut rng, size))));
    let normals = points.iter().map(|_| parts::direction(&mut rng)).collect();
    let count = points.len();
    let part = parts::of(points, normals, vec![0.01; count]);
    let mut case = Case::new(&part, tool, &*oracle);
    for k in 0..6 {
        case.check(&pose, k);
    }
    case.statistics
}

fn own_points(oracle: &dyn Oracle, rng: &mut Rng) -> Vec<Vector3<f64>> {
    let mut points = Vec::new();
    for p in oracle.curve_points().into_iter().flatten() {
        for power in [0, -15, -14, -13, -12, -11, -9, -7, -6, -5, -3] {
            let step = if power == 0 { 0.0 } else { 10f64.powi(power) };
            let step = rng.direction().map(|c| step * c);
            let angle = rng.between(0.0, std::f64::consts::TAU);
            points.push(displaced(oracle, p, step, angle).into());
        }
    }
    points
}

#[test]
fn on_the_surface_and_the_curves() {
    for at in 0..tools().len() {
        for (seed, (size, offset)) in
            (1..).zip([(10.0, 0.0), (1e3, 5e2), (1e5, 9e4), (1e8, 3e7), (1e11, 1e11)])
        {
            let statistics = compare_surface_points(at, size, offset, seed);
            println!("{} {size:e}: {statistics:?}", tools()[at].1.name());
            assert!(statistics.contacts > 1_000, "{statistics:?}");
        }
    }
}

/// A part of one point is stored to the last bit: on the surface, and 1e-15 to 1e-3 off.
#[test]
fn one_point_at_a_time() {
    for (tool, oracle) in tools() {
        let mut rng = Rng::new(43);
        let mut statistics = Statistics::default();
        for (k, own) in own_points(&*oracle, &mut rng).into_iter().enumerate() {
            let at = [0.0, 0.0, 1e2, 1e5][k % 4] * parts::direction(&mut rng);
            let pose = parts::bringing(own, Point3::from(at), &mut rng);
            let part = parts::identical(Point3::from(at), 1);
            let mut case = Case::new(&part, tool, &*oracle);
            case.check(&pose, k);
            statistics.contacts += case.statistics.contacts;
            statistics.doubtful += case.statistics.doubtful;
            statistics.disputed += case.statistics.disputed;
        }
        println!("one point, {}: {statistics:?}", oracle.name());
        assert!(statistics.contacts > 300 && statistics.doubtful > 100, "{statistics:?}");
    }
}

/// Points a little outside the tool never touch; points a little inside all do.
#[test]
fn points_just_outside_never_touch_and_points_just_inside_do() {
    for (tool, oracle) in tools() {
        let mut rng = Rng::new(41);
        for size in [1e2, 1e4, 1e6] {
            for hair in [1e-3, 1e-6, 1e-8] {
                let centre = Point3::from(0.3 * size * parts::direction(&mut rng));
                let pose = parts::bringing(Vector3::zeros(), centre, &mut rng);
                // Points at a step of `hair` from the curves, kept if they are about as far off the surface.
                let mut both = [Vec::new(), Vec::new()];
                for p in oracle.curve_points().into_iter().flatten() {
                    let angle = rng.between(0.0, std::f64::consts::TAU);
                    for turn in 0..8 {
                        let (up, out) = (f64::from(turn) * std::f64::consts::FRAC_PI_4).sin_cos();
                        let direction =
                            if oracle.is_revolved() { [out, 0.0, up] } else { rng.direction() };
                        let q = displaced(&*oracle, p, direction.map(|c| hair * c), angle);
                        let offset = oracle.signed_distance(q);
                        if offset.abs() > 0.3 * hair && offset.abs() < 2.0 * hair {
                            let q = Vector3::from(q);
                            both[usize::from(offset < 0.0)].push(pose.tip() + pose.rotation() * q);
                        }
                    }
                }
                for (points, inside) in both.into_iter().zip([false, true]) {
                    let count = points.len();
                    assert!(count > 50, "{} {count}", oracle.name());
                    // Corners of the part, clear of the tool, make the tree as large as it should be.
                    let all = points.into_iter().chain([-size, size].map(|c| Point3::new(c, c, c)));
                    let normals = vec![Vector3::z(); count + 2];
                    let part = parts::of(all.collect(), normals, vec![1.0; count + 2]);
                    let mut case = Case::new(&part, tool, &*oracle);
                    let found = case.check(&pose, 0);
                    // The last leaf reaches to a corner, and its points are stored to 2^-24 of that.
                    if 1e-6 * size < hair {
                        assert_eq!(found, if inside { count } else { 0 }, "{}", oracle.name());
                    }
                    assert_eq!(case.statistics.disputed, 0);
                }
            }
        }
    }
}
