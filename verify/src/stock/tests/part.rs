//! The surface of what is left, and its comparison with the finished part.

use super::*;
use touchoff::certify::NearestTriangle;
use touchoff::certify::TriangleBvh;
use touchoff::mesh::shapes;

fn cube(low: f64, high: f64) -> Mesh {
    let [low, high] = [low, high].map(|c| Point3::new(c, c, c));
    shapes::cuboid(low, high, UNIT).expect("a cube")
}

/// Returns the distance of a point from the surface of a cube, negative inside.
fn distance_of_cube(point: Point3<f64>, low: f64, high: f64) -> f64 {
    let out = point.coords.map(|c| (low - c).max(c - high));
    if out.max() <= 0.0 { out.max() } else { out.map(|c| c.max(0.0)).norm() }
}

/// The mesh is closed, has the volume of the cells, and is as near to the surface of what was cut as is
/// stated.
#[test]
fn the_remaining_mesh_is_within_its_deviation() {
    let mut stock = block([-5.0; 3], [5.0; 3], 0.3);
    assert!(stock.remaining_mesh().expect("a mesh").diagnostics().is_solid());
    let tips = [[5.0, 5.0, 3.0], [-5.0, 0.0, -4.0], [0.0, -5.0, 3.5], [0.0, 0.0, -3.0]];
    for tip in tips {
        // One pose each, so that the material that is left is known exactly.
        advance(&mut stock, &Ball, [upright(tip); 2], MotionMode::Feed, 50.0);
    }
    let mesh = stock.remaining_mesh().expect("a mesh");
    let diagnostics = mesh.diagnostics();
    assert!(diagnostics.is_solid(), "{diagnostics}");
    assert!((diagnostics.volume / stock.volume() - 1.0).abs() < 1e-12, "{diagnostics}");
    // The greatest depth in any of the balls (which are cut, unlike the shanks above them), or above the
    // block.
    let signed = |p: Point3<f64>| {
        let ball = tips.map(|[x, y, z]| (p - Point3::new(x, y, z + 3.0)).norm() - 3.0);
        distance_of_cube(p, -5.0, 5.0).max(ball.into_iter().map(|d| -d).fold(f64::MIN, f64::max))
    };
    // Shanks cut nothing, and points above the equator of a ball belong to them: left out here.
    let of_ball = |p: &Point3<f64>| {
        let beyond = stock.missed_ball_radius();
        tips.iter().all(|[x, y, z]| {
            (p - Point3::new(*x, *y, p.z)).norm() > 3.0 + beyond || p.z < z + 3.0 - beyond
        })
    };
    let mut checked = 0;
    for vertex in mesh.vertices().iter().filter(|vertex| of_ball(vertex)) {
        // The function is a lower bound on the distance from the surface, outside and inside.
        assert!(signed(*vertex).abs() < stock.missed_ball_radius() + 1e-9, "{vertex}");
        checked += 1;
    }
    assert!(checked > 3000, "{checked}");
    let mut bytes = Vec::new();
    mesh.write_stl(&mut bytes).expect("written");
    let read = Mesh::from_stl(&bytes, "", UNIT).expect("read");
    assert!(read.diagnostics().is_solid() && read.triangles().len() == mesh.triangles().len());
}

/// A cell by itself, and two that touch along an edge.
#[test]
fn cells_that_touch_along_an_edge_are_closed() {
    let mut stock = block([0.0; 3], [2.0, 2.0, 1.0], 1.0);
    assert_eq!(stock.len(), 4);
    let ids: Vec<usize> = (0..4)
        .filter(|slot| {
            let point = stock.tree.point(*slot);
            (point.x < 1.0) != (point.y < 1.0)
        })
        .collect();
    stock.tree.remove(ids);
    let diagnostics = stock.remaining_mesh().expect("a mesh").diagnostics();
    assert!(diagnostics.is_solid() && diagnostics.shared_edges == 1, "{diagnostics}");
    assert_eq!((diagnostics.volume, diagnostics.area, diagnostics.triangles), (2.0, 12.0, 24));
}

/// Distances are within the spacing of points that are spread over all triangles, and those of a cube have a
/// closed form.
#[test]
fn nearest_triangles_agree_with_brute_force() {
    let mut random = Random(3);
    let mut point = |size: f64| Point3::from([0; 3].map(|_| size * (2.0 * random.next() - 1.0)));
    let solid = TriangleBvh::new(&cube(-2.0, 3.0));
    let mut nearest = NearestTriangle::new(&solid);
    for _ in 0..2000 {
        let p = point(8.0);
        let expected = distance_of_cube(p, -2.0, 3.0).abs();
        let distance = nearest.distance(p);
        assert!((distance - expected).abs() < 1e-14, "{p}");
    }
    // Triangles anywhere, small and large, some without area.
    const DIVISIONS: u32 = 24;
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for k in 0..200u32 {
        let (a, size) = (point(10.0), [3.0, 0.1, 1e-6][k as usize % 3]);
        let [b, c] = [point(size), point(size)].map(|p| a + p.coords);
        let c = if k % 10 == 0 { b } else { c };
        vertices.extend([a, b, c]);
        triangles.push([3 * k, 3 * k + 1, 3 * k + 2]);
    }
    let soup = Mesh::new(vertices, triangles, UNIT).expect("a mesh");
    let bvh = TriangleBvh::new(&soup);
    let mut nearest = NearestTriangle::new(&bvh);
    for _ in 0..200 {
        let p = point(12.0);
        let (mut low, mut high) = (f64::INFINITY, f64::INFINITY);
        for [a, b, c] in soup.corners() {
            let mut sampled = f64::INFINITY;
            for i in 0..=DIVISIONS {
                for j in 0..=DIVISIONS - i {
                    let [i, j] = [i, j].map(|k| f64::from(k) / f64::from(DIVISIONS));
                    sampled = sampled.min((a + (b - a) * i + (c - a) * j - p).norm());
                }
            }
            let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
            high = high.min(sampled);
            low = low.min(sampled - longest / f64::from(DIVISIONS));
        }
        let distance = nearest.distance(p);
        assert!(low - 1e-12 <= distance && distance <= high + 1e-12, "{low} {distance} {high}");
    }
}

#[test]
fn excess_and_gouges_have_their_distances() {
    let mut stock = block([-8.0; 3], [8.0; 3], 0.5);
    let part = TriangleBvh::new(&cube(-5.0, 5.0));
    let comparison = stock.compare(&part).expect("compared");
    assert_eq!((comparison.gouges.len(), comparison.deepest_gouge()), (0, None));
    // The outermost layer of cells.
    assert_eq!(comparison.excess.len(), 32 * 32 * 32 - 30 * 30 * 30);
    for DeviationPoint { point, distance, .. } in &comparison.excess {
        assert!((distance - distance_of_cube(*point, -5.0, 5.0)).abs() < 1e-13, "{point}");
    }
    // The corners of the block.
    let greatest = comparison.greatest_excess().expect("an excess");
    assert!((greatest.distance - 2.75 * 3f64.sqrt()).abs() < 1e-13, "{greatest:?}");
    assert_eq!(greatest.point, Point3::new(-7.75, -7.75, -7.75));
    // A hole 2.2 mm into the part.
    let hole = [9.0, 2.8].map(|z| upright([0.0, 0.0, z]));
    assert_eq!(advance(&mut stock, &Mill, hole, MotionMode::Feed, 0.0), []);
    let comparison = stock.compare(&part).expect("compared");
    let expected: Vec<_> = nodes(&stock)
        .into_iter()
        .map(|(at, is_left)| (Point3::from(at), is_left))
        .filter(|(at, is_left)| !is_left && distance_of_cube(*at, -5.0, 5.0) < 0.0)
        .collect();
    assert_eq!(comparison.gouges.len(), expected.len());
    for (gouge, (at, _)) in comparison.gouges.iter().zip(&expected) {
        assert_eq!(gouge.point, *at);
        assert!((gouge.distance - distance_of_cube(*at, -5.0, 5.0)).abs() < 1e-13);
    }
    let deepest = comparison.deepest_gouge().expect("a gouge");
    // The lowest layer that is cut is at 3.25 mm if that at 2.75 mm is not.
    assert!((deepest.distance + 1.75).abs() < 1e-13, "{deepest:?}");
    // Points of the wall of the hole outside the part count as material over it.
    let lower =
        comparison.excess.iter().filter(|p| p.point.x.hypot(p.point.y) < 4.0 && p.point.z > 5.0);
    assert!(lower.count() > 100);

    let mut text = Vec::new();
    comparison.write_csv(&mut text).expect("written");
    let text = String::from_utf8(text).expect("text");
    let (header, rows) = text.split_once('\n').expect("lines");
    assert_eq!(header, "x,y,z,distance");
    let all: Vec<_> = comparison.excess.iter().chain(&comparison.gouges).collect();
    assert_eq!(rows.lines().count(), all.len());
    for (row, point) in rows.lines().zip(&all) {
        let numbers: Vec<f64> =
            row.split(',').map(|cell| cell.parse().expect("a number")).collect();
        assert_eq!(numbers, [point.point.x, point.point.y, point.point.z, point.distance]);
    }
    let mut ply = Vec::new();
    comparison.write_ply(&mut ply).expect("written");
    let body = all.iter().flat_map(|p| [p.point.x, p.point.y, p.point.z, p.distance]);
    let body: Vec<u8> = body.flat_map(f64::to_le_bytes).collect();
    assert!(ply.ends_with(&body));
    let header = String::from_utf8(ply[..ply.len() - body.len()].to_vec()).expect("text");
    assert!(header.contains(&format!("element vertex {}\n", all.len())), "{header}");
    assert!(header.contains("comment unit mm\n") && header.ends_with("end_header\n"), "{header}");
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let stock = block([-8.0; 3], [8.0; 3], 1.0);
    let sheet = TriangleBvh::new(&shapes::plane(2.0, 4, UNIT).expect("a plane"));
    assert_eq!(stock.compare(&sheet), Err(StockError::NoInside { what: "part" }));
    let inch = shapes::cuboid(Point3::origin(), Point3::new(1.0, 1.0, 1.0), Unit::Inch);
    let inch = TriangleBvh::new(&inch.expect("a cube"));
    let refused = stock.compare(&inch).expect_err("another unit");
    assert_eq!(refused, StockError::Unit { part: Unit::Inch, stock: UNIT });
}
