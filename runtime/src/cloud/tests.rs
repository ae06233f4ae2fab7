use super::pieces::Surface;
use super::sampling::{AreaSampler, fraction};
use super::*;
use crate::cloud::Sampling;
use crate::id::TriangleId;
use crate::mesh::shapes;
use rand_core::SeedableRng;
use rand_pcg::Pcg64;

const UNIT: Unit = Unit::Millimetre;

fn cuboid() -> Mesh {
    let high = Point3::new(1.0, 2.0, 4.0);
    shapes::cuboid(Point3::origin(), high, UNIT).expect("a cuboid")
}

/// Returns Pearson's chi-square statistic of counts that should be proportional to `shares`.
fn chi_square(counts: &[f64], shares: &[f64]) -> f64 {
    let scale = counts.iter().sum::<f64>() / shares.iter().sum::<f64>();
    let terms = counts.iter().zip(shares.iter().map(|share| share * scale));
    terms.map(|(count, expected)| (count - expected).powi(2) / expected).sum()
}

#[test]
fn random_points_lie_on_the_surface_and_share_its_area() {
    let mesh = shapes::tube(3.0, 5.0, 13.116, 96, 23, UNIT).expect("a tube");
    let cloud = Cloud::sample(&mesh, Sampling::monte_carlo(20_000).with_seed(7)).expect("a cloud");
    assert_eq!((cloud.len(), cloud.unit()), (20_000, UNIT));
    let sum: f64 = cloud.weights().iter().sum();
    assert!((sum / mesh.diagnostics().area - 1.0).abs() < 1e-11, "{sum}");
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
    let cloud = Cloud::sample(&mesh, Sampling::monte_carlo(60_000).with_seed(3)).expect("a cloud");
    let areas: Vec<f64> = (0..12).map(|id| mesh.area(TriangleId(id))).collect();
    let mut counts = vec![0.0; 12];
    // Also count grid cells of equal share on the side z = 0, which is 1 by 2.
    let mut cells = vec![0.0; 32];
    for (point, &id) in cloud.points().iter().zip(cloud.triangles()) {
        counts[id.index()] += 1.0;
        if id.0 / 2 == 4 {
            cells[(point.x * 4.0) as usize + 4 * (point.y * 4.0) as usize] += 1.0;
        }
    }
    // With 11 and 31 degrees of freedom, chance exceeds these values once in a thousand seeds.
    let (sides, cells) = (chi_square(&counts, &areas), chi_square(&cells, &[1.0; 32]));
    assert!(sides < 31.3 && cells < 61.1, "{sides} {cells}");
}

#[test]
fn a_seed_is_a_cloud() {
    let mesh = cuboid();
    let [a, b, c] = [(100, 1), (200, 1), (100, 2)].map(|(count, seed)| {
        Cloud::sample(&mesh, Sampling::monte_carlo(count).with_seed(seed)).expect("a cloud")
    });
    assert_eq!(a.points(), &b.points()[..100]);
    assert_ne!(a.points(), c.points());
    // The stream must stay the same: clouds in published measurements are identified by their seed.
    let first = Point3::new(0.13120038523973798, 2.0, 0.06919470014228546);
    assert_eq!((a.triangles()[0], a.points()[0]), (TriangleId(7), first));
}

#[test]
fn degenerate_triangles_are_never_touched() {
    let vertices = cuboid().vertices().to_vec();
    let triangles = vec![[0, 0, 1], [0, 1, 2], [3, 3, 3], [4, 5, 6], [7, 6, 7]];
    let mesh = Mesh::new(vertices, triangles, UNIT).expect("a mesh");
    let cloud = Cloud::sample(&mesh, Sampling::monte_carlo(1000).with_seed(0)).expect("a cloud");
    assert!(cloud.triangles().iter().all(|id| [1, 3].contains(&id.0)));
    assert_eq!(Cloud::centroids(&mesh).triangles(), [1, 3].map(TriangleId));
    assert_eq!(Cloud::sample(&mesh, Sampling::monte_carlo(0).with_seed(0)), Err(CloudError::Empty));
    if let Some(count) = (u32::MAX as usize).checked_add(1) {
        assert_eq!(
            Cloud::sample(&mesh, Sampling::monte_carlo(count).with_seed(0)),
            Err(CloudError::TooMany { count })
        );
    }
}

#[test]
fn centroids_are_exact_for_affine_integrands() {
    let mesh = cuboid();
    let cloud = Cloud::centroids(&mesh);
    let affine = |p: &Point3<f64>| 1.0 + 2.0 * p.x - 3.0 * p.y + 4.0 * p.z;
    let sum: f64 = cloud.points().iter().zip(cloud.weights()).map(|(p, w)| w * affine(p)).sum();
    // By symmetry, the mean of the surface is the centre of the box.
    assert!((sum - 28.0 * affine(&Point3::new(0.5, 1.0, 2.0))).abs() < 1e-12, "{sum}");
    // The divergence theorem: the weighted normals of a closed surface cancel.
    let normals = cloud.normals().iter().zip(cloud.weights()).map(|(n, w)| n * *w);
    assert!(normals.sum::<Vector3<f64>>().norm() < 1e-13);
}

#[test]
fn clouds_from_elsewhere_are_checked() {
    let at = |x: f64| vec![Point3::origin(), Point3::new(x, 0.0, 0.0)];
    let up = |z: f64| vec![Vector3::z(), Vector3::new(0.0, 0.0, z)];
    let of =
        |x, z, w| Cloud::new(at(x), up(z), vec![TriangleId(0), TriangleId(9)], vec![1.0, w], UNIT);
    let cloud = of(1.0, 1.0009, 0.0).expect("a cloud");
    assert_eq!(
        (cloud.normals()[1], cloud.triangles()),
        (Vector3::z(), &[0, 9].map(TriangleId)[..])
    );
    let coordinate = CloudError::Coordinate { point: 1, coordinate: f64::INFINITY };
    assert_eq!(of(f64::INFINITY, 1.0, 1.0), Err(coordinate));
    for x in [f64::NAN, f64::NEG_INFINITY, 1e61] {
        assert!(matches!(of(x, 1.0, 1.0), Err(CloudError::Coordinate { point: 1, .. })));
    }
    for z in [1.01, 0.0, 1e-320, f64::NAN, f64::INFINITY] {
        assert!(matches!(of(1.0, z, 1.0), Err(CloudError::Normal { point: 1, .. })));
    }
    for w in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(of(1.0, 1.0, w), Err(CloudError::Weight { point: 1, .. })));
    }
    let lengths = CloudError::Lengths { points: 2, normals: 2, triangles: 1, weights: 2 };
    let short = Cloud::new(at(1.0), up(1.0), vec![TriangleId(0)], vec![1.0; 2], UNIT);
    assert_eq!(short, Err(lengths));
    let none = Cloud::new(vec![], vec![], vec![], vec![], UNIT);
    assert_eq!(none, Err(CloudError::Empty));
    assert!(of(1e60, 1.0, 1.0).is_ok());
    for weight in [0.0, 1e308] {
        let ids = vec![TriangleId(0), TriangleId(9)];
        assert!(Cloud::new(at(1.0), up(1.0), ids, vec![weight; 2], UNIT).is_ok());
    }
}

#[test]
fn slivers_and_triangles_without_area_are_sampled() {
    let tetrahedron = |height: f64| {
        [[0.0; 3], [1.0, 0.0, 0.0], [0.0, height, 0.0], [0.0, 0.0, 1.0]].map(Point3::from)
    };
    let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3], [0, 1, 1]];
    for (height, count) in [(1.0, 4), (1.0, 5), (1e-300, 4)] {
        let mesh = Mesh::new(tetrahedron(height), faces[..count].to_vec(), UNIT).expect("a mesh");
        for sampling in [Sampling::monte_carlo(50), Sampling::new(50)] {
            let cloud = Cloud::sample(&mesh, sampling).expect("a cloud");
            assert!(cloud.points().iter().all(|p| p.iter().all(|c| c.is_finite())), "{cloud:?}");
            assert!(cloud.normals().iter().all(|n| (n.norm() - 1.0).abs() < 1e-12), "{cloud:?}");
            assert!(cloud.weights().iter().all(|w| w.is_finite() && *w >= 0.0), "{cloud:?}");
        }
    }
}

fn random(mesh: &Mesh, count: usize) -> Cloud {
    Cloud::sample(mesh, Sampling::monte_carlo(count).with_seed(5)).expect("a cloud")
}

/// Reference implementation of sample elimination: one point at a time, with all distances.
fn thinned_one_by_one(cloud: &Cloud, area: f64, count: usize) -> Vec<u32> {
    let all = cloud.len();
    let reach = 2.0 * (area / (2.0 * 3f64.sqrt() * count as f64)).sqrt();
    let least = 0.65 * (1.0 - (count as f64 / all as f64).powf(1.5));
    let share = |i: usize, j: usize| {
        let away = (cloud.points[i] - cloud.points[j]).norm() / reach;
        let same = cloud.normals[i].dot(&cloud.normals[j]) > -0.3;
        if i != j && same && away < 1.0 { (1.0 - away.max(least)).powi(8) } else { 0.0 }
    };
    let mut left: Vec<usize> = (0..all).collect();
    let mut crowded: Vec<f64> = (0..all).map(|i| (0..all).map(|j| share(i, j)).sum()).collect();
    while left.len() > count {
        let most = (0..left.len()).max_by(|a, b| crowded[left[*a]].total_cmp(&crowded[left[*b]]));
        let gone = left.remove(most.expect("some are left"));
        left.iter().for_each(|other| crowded[*other] -= share(gone, *other));
    }
    left.into_iter().map(|index| index as u32).collect()
}

#[test]
fn all_at_once_leave_as_one_by_one() {
    let tube = shapes::tube(1.0, 2.0, 3.0, 64, 3, UNIT).expect("a tube");
    for (mesh, count) in [(cuboid(), 100), (cuboid(), 399), (tube, 60)] {
        let cloud = random(&mesh, 400);
        let area = mesh.diagnostics().area;
        let thinned = blue_noise::decimate(&cloud.points, &cloud.normals, area, count);
        let expected = thinned_one_by_one(&cloud, area, count);
        assert_eq!(thinned.len(), count);
        // Single precision may decide differently between points whose crowding agrees to seven figures.
        let other = thinned.iter().filter(|index| !expected.contains(index)).count();
        assert!(other * 50 <= count, "{other} of {count} are others");
    }
}

#[test]
fn without_neighbours_as_many_are_left_as_are_asked_for() {
    let far = |i: u32| Point3::new(f64::from(i), 0.0, 0.0);
    let points: Vec<_> = (0..9).map(far).collect();
    let left = blue_noise::decimate(&points, &[Vector3::z(); 9], 1e-6, 4);
    assert_eq!(left, [0, 1, 2, 3]);
    let same = blue_noise::decimate(&[Point3::origin(); 9], &[Vector3::z(); 9], 1.0, 4);
    assert_eq!(same.len(), 4);
}

/// Returns grid points on all triangles of a mesh, with the triangles' ids.
fn places(mesh: &Mesh, fine: u32) -> impl Iterator<Item = (u32, Point3<f64>)> {
    let steps = (0..=fine).flat_map(move |i| (0..=fine - i).map(move |j| (i, j)));
    (0..).zip(mesh.corners()).flat_map(move |(id, [a, b, c])| {
        let part = move |k: u32| f64::from(k) / f64::from(fine);
        steps.clone().map(move |(i, j)| (id, a + part(i) * (b - a) + part(j) * (c - a)))
    })
}

fn nearest(cloud: &Cloud, place: &Point3<f64>) -> f64 {
    cloud.points().iter().map(|p| (p - place).norm()).fold(f64::INFINITY, f64::min)
}

/// Returns two sheets back to back, so close that a point is nearer to the other sheet than to its neighbours.
fn sheets() -> Mesh {
    let high = Point3::new(4.0, 4.0, 0.01);
    shapes::cuboid(Point3::origin(), high, UNIT).expect("a sheet")
}

/// Returns long, thin triangles with angles near 0 and 180 degrees.
fn slivers() -> Mesh {
    let at = |x: f64, y: f64| Point3::new(x, y, 0.0);
    let vertices =
        vec![at(0.0, 0.0), at(50.0, 0.0), at(25.0, 1e-3), at(25.0, -0.5), at(100.0, 1e-6)];
    Mesh::new(vertices, vec![[0, 1, 2], [1, 0, 3], [1, 4, 2]], UNIT).expect("slivers")
}

#[test]
fn nothing_is_farther_than_the_covering_radius() {
    let ball = shapes::sphere(2.0, 3, UNIT).expect("a ball");
    let mut doubled = cuboid().triangles().to_vec();
    doubled.extend(cuboid().triangles().iter().map(|&[a, b, c]| [a, c, b]));
    let doubled = Mesh::new(cuboid().vertices().to_vec(), doubled, UNIT).expect("a mesh");
    for mesh in [cuboid(), ball, sheets(), slivers(), doubled] {
        for count in [1, 2, 3, 10, 300] {
            let blue = Cloud::sample(&mesh, Sampling::new(count)).expect("a cloud");
            let random = random(&mesh, count).with_voronoi_weights(&mesh);
            for cloud in [blue, random] {
                let cover = cloud.covering_radius().expect("a cover");
                assert!(cover.proved && cloud.len() == count);
                let fine = if mesh.triangles().len() > 100 { 6 } else { 60 };
                let far = places(&mesh, fine).map(|(_, place)| nearest(&cloud, &place));
                let far = far.fold(0.0, f64::max);
                // The bound is tight up to the resolution of the grid.
                let coarse = 0.9;
                assert!(far <= cover.radius, "{count}: {far} beyond {}", cover.radius);
                assert!(far >= coarse * cover.radius, "{count}: {far} for {}", cover.radius);
                let sum: f64 = cloud.weights().iter().sum();
                assert!((sum / mesh.diagnostics().area - 1.0).abs() < 1e-13, "{count}: {sum}");
            }
        }
    }
}

#[test]
fn weights_are_the_areas_of_cells() {
    // On a plane every position belongs to the nearest point.
    let mesh = shapes::plane(1.0, 3, UNIT).expect("a plane");
    let cloud = random(&mesh, 40).with_voronoi_weights(&mesh);
    let fine = 150;
    let mut counted = vec![0.0; 40];
    let mut all = 0.0;
    for (_, place) in places(&mesh, fine) {
        let away = |i: &usize| (cloud.points()[*i] - place).norm();
        let owner = (0..40).min_by(|i, j| away(i).total_cmp(&away(j))).expect("some");
        counted[owner] += 1.0;
        all += 1.0;
    }
    for (weight, counted) in cloud.weights().iter().zip(counted) {
        assert!((weight - 4.0 * counted / all).abs() < 2e-3, "{weight} {}", 4.0 * counted / all);
    }
}

#[test]
fn the_sides_of_a_sheet_are_weighed_apart() {
    let mesh = sheets();
    let cloud = Cloud::sample(&mesh, Sampling::new(400)).expect("a cloud");
    let side = |up: f64| {
        let of = cloud.normals().iter().zip(cloud.weights()).filter(|(n, _)| n.z * up > 0.5);
        of.map(|(_, weight)| *weight).sum::<f64>()
    };
    let [top, bottom] = [side(1.0), side(-1.0)];
    // The rim has hardly any points, so its area goes to the sides.
    assert!((top - 16.0).abs() < 0.12 && (bottom - 16.0).abs() < 0.12, "{top} {bottom}");
    let count = cloud.normals().iter().filter(|n| n.z > 0.5).count();
    assert!((180..=220).contains(&count), "{count}");
}

#[test]
#[cfg(feature = "parallel")]
fn a_blue_cloud_is_the_same_on_any_number_of_cores() {
    let tube = shapes::tube(3.0, 5.0, 13.0, 96, 4, UNIT).expect("a tube");
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| Cloud::sample(&tube, Sampling::new(20_000).with_seed(3)).expect("a cloud"))
    };
    let one = on(1);
    assert!(one.covering_radius().is_some_and(|cover| {
        cover.radius * (one.len() as f64 / tube.diagnostics().area).sqrt() <= 0.95
    }));
    assert_eq!(one, on(2));
    assert_eq!(one, on(5));
}

#[test]
fn a_radius_says_how_many_points() {
    let mesh = cuboid();
    let most = Sampling::new(MAX_BLUE_NOISE_POINTS);
    let methods = [SamplingMethod::BlueNoise, SamplingMethod::Uniform, SamplingMethod::MonteCarlo];
    for method in methods {
        for radius in [10.0, 0.5, 0.05] {
            let cloud = Cloud::with_covering_radius(&mesh, radius, most.with_method(method));
            let cloud = cloud.expect("a cloud");
            let found = cloud.covering_radius().expect("a cover").radius;
            assert!(found <= radius, "{found} of {radius}");
            let spare = if method == SamplingMethod::BlueNoise { 0.85 } else { 0.7 };
            assert!(cloud.len() < 5 || found > spare * radius, "{found} of {radius}");
        }
    }
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = Cloud::with_covering_radius(&mesh, radius, most);
        assert!(matches!(refused, Err(CloudError::Radius { .. })), "{refused:?}");
    }
    let refused = Cloud::with_covering_radius(&mesh, 1e-5, most).expect_err("too many points");
    let text = refused.to_string();
    assert!(text.contains("needs about 2.3e11 points") && text.contains("certify"), "{text}");
}

#[test]
fn of_points_alone_cells_are_estimated() {
    let mesh = shapes::tube(3.0, 5.0, 13.0, 512, 8, UNIT).expect("a tube");
    let points = |cloud: Cloud, areas: Option<Vec<f64>>| {
        let Cloud { points, normals, .. } = cloud;
        Cloud::from_points(
            OrientedPoints { points, normals, triangles: None, areas, left_out: 0 },
            UNIT,
        )
    };
    for (cloud, close, near) in [
        (Cloud::sample(&mesh, Sampling::new(5_000)), 0.05, 0.25),
        (Cloud::sample(&mesh, Sampling::monte_carlo(5_000)), 0.15, 0.5),
    ] {
        let cloud = cloud.expect("a cloud").with_voronoi_weights(&mesh);
        let guessed = points(cloud.clone(), None).expect("points");
        let cover = guessed.covering_radius().expect("a cover");
        let radius = cloud.covering_radius().expect("a cover").radius;
        assert!(!cover.proved && (cover.radius / radius - 1.0).abs() < near, "{cover:?} {radius}");
        let area: f64 = guessed.weights().iter().sum();
        assert!((area / mesh.diagnostics().area - 1.0).abs() < close, "{area}");
        let given = points(cloud.clone(), Some(cloud.weights().to_vec())).expect("points");
        assert_eq!(given.weights(), cloud.weights());
    }
    let same = vec![Point3::origin(); 20];
    let all = OrientedPoints {
        points: same,
        normals: vec![Vector3::z(); 20],
        triangles: None,
        areas: None,
        left_out: 0,
    };
    let cloud = Cloud::from_points(all.clone(), UNIT).expect("points");
    assert!(cloud.weights().iter().all(|weight| *weight == 0.0));
    let negative = OrientedPoints { areas: Some(vec![-1.0; 20]), ..all };
    let refused = Cloud::from_points(negative, UNIT);
    assert_eq!(refused, Err(CloudError::Weight { point: 0, weight: -1.0 }));
}

/// Coincident points, and points mirrored in the surface: distance alone does not decide the owner.
#[test]
fn points_that_are_as_near_lose_nothing() {
    let at = |x: f64, y: f64, z: f64| Point3::new(x, y, z);
    let vertices = vec![at(0.0, 0.0, 0.0), at(40.0, 10.0, 0.0), at(0.0, 20.0, 0.0)];
    let mesh = Mesh::new(vertices, vec![[0, 1, 2]], UNIT).expect("a triangle");
    let check = |points: Vec<Point3<f64>>| {
        let count = points.len();
        let (normals, ids) = (vec![Vector3::z(); count], vec![TriangleId(0); count]);
        let cloud = Cloud::new(points, normals, ids, vec![0.0; count], UNIT).expect("a cloud");
        let cloud = cloud.with_voronoi_weights(&mesh);
        let far = places(&mesh, 40).map(|(_, place)| nearest(&cloud, &place)).fold(0.0, f64::max);
        let radius = cloud.covering_radius().expect("a cover").radius;
        // The covering radius is attained at a corner of the triangle or between points, so the grid's value is close.
        assert!(far <= radius && radius <= 1.1 * far + 0.3, "{far} {radius} {:?}", cloud.points());
        let sum: f64 = cloud.weights().iter().sum();
        assert!((sum / 400.0 - 1.0).abs() < 1e-12, "{sum}");
        cloud
    };
    let twice = check(vec![at(10.1, 10.0, 0.0), at(11.1, 12.5, 0.0), at(11.1, 12.5, 0.0)]);
    assert!(twice.weights()[0] > 100.0 && twice.weights()[1] > 100.0 && twice.weights()[2] == 0.0);
    let mirrored = check(vec![at(10.0, 9.0, 2.0), at(10.0, 9.0, -2.0), at(20.0, 10.0, 0.5)]);
    assert!(mirrored.weights()[0] > 100.0 && mirrored.weights()[1] == 0.0);
    let mut random = Pcg64::seed_from_u64(4);
    let mut draw = || fraction(&mut random);
    for _ in 0..300 {
        let mut points: Vec<_> =
            (0..8).map(|_| at(20.0 * draw(), 5.0 + 10.0 * draw(), 0.0)).collect();
        let again = points.clone();
        points.extend(again.iter().map(|p| at(p.x, p.y, p.z)));
        points.extend(again.iter().map(|p| at(p.x.next_up(), p.y, 0.0)));
        let lifted = draw();
        points
            .extend(again.iter().take(3).flat_map(|p| [lifted, -lifted].map(|z| at(p.x, p.y, z))));
        check(points);
    }
}

#[test]
fn what_has_no_area_is_covered_too() {
    let mut vertices = cuboid().vertices().to_vec();
    vertices.extend([Point3::new(50.0, 0.0, 0.0), Point3::new(100.0, 0.0, 0.0)]);
    let mut triangles = cuboid().triangles().to_vec();
    triangles.push([0, 8, 9]);
    let mesh = Mesh::new(vertices, triangles, UNIT).expect("a mesh");
    for cloud in
        [Cloud::sample(&mesh, Sampling::new(50)), Cloud::sample(&mesh, Sampling::monte_carlo(50))]
    {
        let cloud = cloud.expect("a cloud").with_voronoi_weights(&mesh);
        let far = places(&mesh, 50).map(|(_, place)| nearest(&cloud, &place)).fold(0.0, f64::max);
        let radius = cloud.covering_radius().expect("a cover").radius;
        assert!(far <= radius && radius < 1.1 * far, "{far} {radius}");
        let sum: f64 = cloud.weights().iter().sum();
        assert!((sum / 28.0 - 1.0).abs() < 1e-12, "{sum}");
    }
}

#[test]
fn points_that_repeat_share_their_cells() {
    let mesh = shapes::plane(1.0, 4, UNIT).expect("a plane");
    let cloud = Cloud::sample(&mesh, Sampling::new(500)).expect("a cloud");
    let thrice = |list: &[Point3<f64>]| [list, list, list].concat();
    let oriented = |points: Vec<Point3<f64>>, areas| {
        let normals = vec![Vector3::z(); points.len()];
        Cloud::from_points(
            OrientedPoints { points, normals, triangles: None, areas, left_out: 0 },
            UNIT,
        )
    };
    let [one, three] = [cloud.points().to_vec(), thrice(cloud.points())]
        .map(|points| oriented(points, None).expect("points"));
    let sum = |cloud: &Cloud| cloud.weights().iter().sum::<f64>();
    assert!(
        (sum(&one) - sum(&three)).abs() < 1e-9 && one.covering_radius() == three.covering_radius()
    );
    // A single point gives no estimate of the covering radius.
    for count in [1, 20] {
        let alone = oriented(vec![Point3::origin(); count], None).expect("points");
        assert_eq!(alone.covering_radius(), None);
    }
    let short = oriented(vec![Point3::origin(); 20], Some(vec![1.0]));
    assert!(matches!(short, Err(CloudError::Lengths { weights: 1, .. })), "{short:?}");
}

// Surfaces and points as damaged files and scanners produce them: long, coincident, crowded.

fn mesh(triangles: &[[[f64; 3]; 3]]) -> Mesh {
    let vertices = triangles.as_flattened().iter().map(|corner| Point3::from(*corner));
    let ids = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
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
    let copies = Mesh::new(tube.vertices().to_vec(), copies, UNIT).expect("a mesh");
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
        Cloud::from_points(
            OrientedPoints { points, normals, triangles: None, areas: None, left_out: 0 },
            UNIT,
        )
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
        left_out: 0,
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
