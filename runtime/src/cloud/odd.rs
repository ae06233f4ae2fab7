//! Tests with surfaces and points as damaged files and scanners produce them: long, coincident, crowded.

use super::pieces::Surface;
use super::sampling::AreaSampler;
use super::*;
use crate::cloud::Sampling;
use crate::id::TriangleId;
use crate::mesh::shapes;

const UNIT: Unit = Unit::Millimetre;

fn mesh(triangles: &[[[f64; 3]; 3]]) -> Mesh {
    let vertices = triangles.as_flattened().iter().map(|corner| Point3::from(*corner)).collect();
    let ids = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Mesh::new(vertices, ids, UNIT).expect("a mesh")
}

fn pieces(mesh: &Mesh, count: usize) -> usize {
    Surface::new(mesh, &AreaSampler::of(mesh), count).pieces.len()
}

/// Returns the largest distance of sampled points of the triangles from their nearest cloud points.
fn farthest(mesh: &Mesh, cloud: &Cloud) -> f64 {
    let between = |[a, b, c]: [Point3<f64>; 3], k: usize| {
        let (u, v) = ((k % 11) as f64 / 10.0, (k / 11) as f64 / 10.0);
        a + u * (b - a) + v * (1.0 - u) * (c - a)
    };
    let places = mesh.corners().flat_map(|corners| (0..121).map(move |k| between(corners, k)));
    let nearest = |place: Point3<f64>| {
        cloud.points().iter().map(|point| (point - place).norm()).fold(f64::INFINITY, f64::min)
    };
    places.map(nearest).fold(0.0, f64::max)
}

#[test]
fn long_triangles_have_pieces_in_proportion_to_points() {
    let long = mesh(&[[[0.0, 1.0, 0.0], [4e9, 1.0, 0.0], [0.0, 1.0 + 2.5e-10, 0.0]]]);
    let sliver = |k: u32| {
        let y = f64::from(k);
        [[0.0, y, 0.0], [1e6, y, 0.0], [0.0, y + 1e-9, 0.0]]
    };
    let slivers = mesh(&(0..300).map(sliver).collect::<Vec<_>>());
    for (mesh, count) in [(&long, 5), (&long, 2_000), (&slivers, 5), (&slivers, 2_000)] {
        let triangles = mesh.triangles().len();
        let pieces = pieces(mesh, count);
        // The bound follows from the coarser grain described in `pieces`.
        assert!(pieces <= 2 * triangles + count, "{pieces} of {triangles} for {count}");
    }
    for (mesh, count) in [(&long, 5), (&slivers, 500)] {
        let cloud = Cloud::sample(mesh, Sampling::new(count)).expect("a cloud");
        let cover = cloud.covering_radius().expect("it is known");
        assert!(cover.proved && cover.radius >= farthest(mesh, &cloud), "{cover:?}");
        let sum: f64 = cloud.weights().iter().sum();
        assert!((sum / mesh.diagnostics().area - 1.0).abs() < 1e-9, "{sum}");
    }
}

#[test]
fn coincident_triangles_are_divided_once() {
    let tube = shapes::tube(3.0, 5.0, 13.116, 24, 2, UNIT).expect("a tube");
    let turned = |[a, b, c]: [u32; 3], copy: usize| [[a, b, c], [b, c, a], [c, a, b]][copy % 3];
    let copies = (0..30).flat_map(|copy| tube.triangles().iter().map(move |t| turned(*t, copy)));
    let copies = Mesh::new(tube.vertices().to_vec(), copies.collect(), UNIT).expect("a mesh");
    assert_eq!(pieces(&copies, 2_000), pieces(&tube, 2_000));
    let [one, all] =
        [&tube, &copies].map(|mesh| Cloud::sample(mesh, Sampling::new(2_000)).expect("a cloud"));
    let sum = |cloud: &Cloud| cloud.weights().iter().sum::<f64>();
    assert!((sum(&all) / sum(&one) - 30.0).abs() < 1e-6);
    let [one, all] = [one, all].map(|cloud| cloud.covering_radius().expect("it is known").radius);
    assert!(all < 1.1 * one, "as evenly spread: {all} {one}");
}

/// On a surface of many layers, fewer points crowd each other than its area suggests.
#[test]
fn nearly_coincident_triangles_keep_a_proved_cover() {
    let layer = |k: u32| {
        let z = 1e-7 * f64::from(k);
        [[0.0, 0.0, z], [10.0, 0.0, z], [0.0, 10.0, z]]
    };
    let layers = mesh(&(0..200).map(layer).collect::<Vec<_>>());
    let cloud = Cloud::sample(&layers, Sampling::new(1_000)).expect("a cloud");
    let cover = cloud.covering_radius().expect("it is known");
    assert!(cover.proved && cover.radius >= farthest(&layers, &cloud), "{cover:?}");
    assert!(cover.radius < 2.0, "{cover:?}");
    let sum: f64 = cloud.weights().iter().sum();
    assert!((sum / 10_000.0 - 1.0).abs() < 1e-9, "{sum}");
}

#[test]
fn coincident_points_share_a_cell() {
    let grid = (0..900).map(|k| Point3::new(f64::from(k % 30), f64::from(k / 30), 0.0));
    let of = |repeated: usize, tilt: f64| {
        let mut points: Vec<_> = grid.clone().collect();
        points.extend(vec![Point3::new(15.0, 15.0, 0.0); repeated]);
        let normal = |k: usize| Vector3::new(tilt * k as f64, 0.0, 1.0).normalize();
        let normals = (0..points.len()).map(|k| normal(k.saturating_sub(900))).collect();
        Cloud::from_points(OrientedPoints { points, normals, triangles: None, areas: None }, UNIT)
            .expect("a cloud")
    };
    let one = of(0, 0.0);
    let whole = one.weights()[465];
    assert!((whole - 1.0).abs() < 1e-9, "{whole}");
    for tilt in [0.0, 1e-5] {
        let many = of(4_999, tilt);
        let shared: f64 = many.weights()[900..].iter().sum::<f64>() + many.weights()[465];
        assert!((shared / whole - 1.0).abs() < 1e-3, "{shared} for {whole}");
        assert_eq!(many.weights()[..400], one.weights()[..400]);
        assert_eq!(many.covering_radius(), one.covering_radius());
    }
    let alone = OrientedPoints {
        points: vec![Point3::origin(); 5_000],
        normals: vec![Vector3::z(); 5_000],
        triangles: None,
        areas: None,
    };
    assert_eq!(Cloud::from_points(alone, UNIT).expect("a cloud").covering_radius(), None);
}

#[test]
fn coincident_points_are_thinned() {
    let tube = shapes::tube(3.0, 5.0, 13.116, 24, 2, UNIT).expect("a tube");
    let cloud = Cloud::sample(&tube, Sampling::monte_carlo(100)).expect("a cloud");
    let repeated = |count: usize| {
        let all = (0..count).map(|k| k % 100);
        let points = all.clone().map(|k| cloud.points()[k]).collect();
        let normals = all.map(|k| cloud.normals()[k]).collect();
        let cloud = Cloud::new(points, normals, vec![TriangleId(0); count], vec![0.0; count], UNIT);
        cloud.expect("a cloud").decimated(&tube, 200)
    };
    let thinned = repeated(60_000);
    assert_eq!(thinned.len(), 200);
    let distinct: std::collections::HashSet<_> =
        thinned.points().iter().map(|p| <[f64; 3]>::from(*p).map(f64::to_bits)).collect();
    assert_eq!(distinct.len(), 100);
}
