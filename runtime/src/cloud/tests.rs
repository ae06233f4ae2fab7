use super::*;
use crate::mesh::shapes;

const UNIT: Unit = Unit::Millimetre;

fn cuboid() -> Mesh {
    let high = Point3::new(1.0, 2.0, 4.0);
    shapes::cuboid(Point3::origin(), high, UNIT).expect("a cuboid")
}

/// Pearson's statistic of counts that should be in proportion to `shares`.
fn chi_square(counts: &[f64], shares: &[f64]) -> f64 {
    let scale = counts.iter().sum::<f64>() / shares.iter().sum::<f64>();
    let terms = counts.iter().zip(shares.iter().map(|share| share * scale));
    terms.map(|(count, expected)| (count - expected).powi(2) / expected).sum()
}

#[test]
fn random_points_lie_on_the_surface_and_share_its_area() {
    let mesh = shapes::tube(3.0, 5.0, 13.116, 96, 23, UNIT).expect("a tube");
    let cloud = Cloud::random(&mesh, 20_000, 7).expect("a cloud");
    assert_eq!((cloud.len(), cloud.unit()), (20_000, UNIT));
    let sum: f64 = cloud.weights().iter().sum();
    assert!((sum / mesh.survey().area - 1.0).abs() < 1e-11, "{sum}");
    for i in 0..cloud.len() {
        let id = cloud.triangles()[i];
        assert_eq!(Some(cloud.normals()[i]), mesh.normal(id));
        let off = (cloud.points()[i] - mesh.triangle(id)[0]).dot(&cloud.normals()[i]);
        assert!(off.abs() < 1e-14, "{off}");
    }
}

#[test]
fn random_points_are_uniform() {
    let mesh = cuboid();
    let cloud = Cloud::random(&mesh, 60_000, 3).expect("a cloud");
    let areas: Vec<f64> = (0..12).map(|id| mesh.area(id)).collect();
    let mut counts = vec![0.0; 12];
    // On the side z = 0, which is 1 by 2, also by cells, whose shares are equal.
    let mut cells = vec![0.0; 32];
    for (point, &id) in cloud.points().iter().zip(cloud.triangles()) {
        counts[id as usize] += 1.0;
        if id / 2 == 4 {
            cells[(point.x * 4.0) as usize + 4 * (point.y * 4.0) as usize] += 1.0;
        }
    }
    // 11 and 31 degrees of freedom: chance goes beyond these once in a thousand seeds.
    let (sides, cells) = (chi_square(&counts, &areas), chi_square(&cells, &[1.0; 32]));
    assert!(sides < 31.3 && cells < 61.1, "{sides} {cells}");
}

#[test]
fn a_seed_is_a_cloud() {
    let mesh = cuboid();
    let [a, b, c] = [(100, 1), (200, 1), (100, 2)]
        .map(|(count, seed)| Cloud::random(&mesh, count, seed).expect("a cloud"));
    assert_eq!(a.points(), &b.points()[..100]);
    assert_ne!(a.points(), c.points());
    // The stream is a promise: clouds in published measurements are named by their seed.
    let first = Point3::new(0.13120038523973798, 2.0, 0.06919470014228546);
    assert_eq!((a.triangles()[0], a.points()[0]), (7, first));
}

#[test]
fn degenerate_triangles_are_never_touched() {
    let vertices = cuboid().vertices().to_vec();
    let triangles = vec![[0, 0, 1], [0, 1, 2], [3, 3, 3], [4, 5, 6], [7, 6, 7]];
    let mesh = Mesh::new(vertices, triangles, UNIT).expect("a mesh");
    let cloud = Cloud::random(&mesh, 1000, 0).expect("a cloud");
    assert!(cloud.triangles().iter().all(|id| [1, 3].contains(id)));
    assert_eq!(Cloud::centroids(&mesh).triangles(), [1, 3]);
    assert_eq!(Cloud::random(&mesh, 0, 0), Err(CloudError::Empty));
    if let Some(count) = (u32::MAX as usize).checked_add(1) {
        assert_eq!(Cloud::random(&mesh, count, 0), Err(CloudError::TooMany { count }));
    }
}

#[test]
fn centroids_are_exact_for_affine_integrands() {
    let mesh = cuboid();
    let cloud = Cloud::centroids(&mesh);
    let affine = |p: &Point3<f64>| 1.0 + 2.0 * p.x - 3.0 * p.y + 4.0 * p.z;
    let sum: f64 = cloud.points().iter().zip(cloud.weights()).map(|(p, w)| w * affine(p)).sum();
    // By symmetry the mean of the surface is the middle of the box.
    assert!((sum - 28.0 * affine(&Point3::new(0.5, 1.0, 2.0))).abs() < 1e-12, "{sum}");
    // The divergence theorem: the weighted normals of a closed surface cancel.
    let normals = cloud.normals().iter().zip(cloud.weights()).map(|(n, w)| n * *w);
    assert!(normals.sum::<Vector3<f64>>().norm() < 1e-13);
}

#[test]
fn clouds_from_elsewhere_are_checked() {
    let at = |x: f64| vec![Point3::origin(), Point3::new(x, 0.0, 0.0)];
    let up = |z: f64| vec![Vector3::z(), Vector3::new(0.0, 0.0, z)];
    let of = |x, z, w| Cloud::new(at(x), up(z), vec![0, 9], vec![1.0, w], UNIT);
    let cloud = of(1.0, 1.0009, 0.0).expect("a cloud");
    assert_eq!((cloud.normals()[1], cloud.triangles()), (Vector3::z(), &[0, 9][..]));
    let coordinate = CloudError::Coordinate { point: 1, coordinate: f64::INFINITY };
    assert_eq!(of(f64::INFINITY, 1.0, 1.0), Err(coordinate));
    for z in [1.01, 0.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(of(1.0, z, 1.0), Err(CloudError::Normal { point: 1, .. })));
    }
    for w in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(of(1.0, 1.0, w), Err(CloudError::Weight { point: 1, .. })));
    }
    let lengths = CloudError::Lengths { points: 2, normals: 2, triangles: 1, weights: 2 };
    let short = Cloud::new(at(1.0), up(1.0), vec![0], vec![1.0; 2], UNIT);
    assert_eq!(short, Err(lengths));
    let none = Cloud::new(vec![], vec![], vec![], vec![], UNIT);
    assert_eq!(none, Err(CloudError::Empty));
}
