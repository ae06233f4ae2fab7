//! The surface of what is left.

use super::*;

/// Returns the distance of a point from the surface of a cube, negative inside.
fn distance_of_cube(point: Point3<f64>, low: f64, high: f64) -> f64 {
    let out = point.coords.map(|c| (low - c).max(c - high));
    if out.max() <= 0.0 { out.max() } else { out.map(|c| c.max(0.0)).norm() }
}

/// The mesh is closed, has the volume of the cells, and is as near to the surface of what was cut as is stated.
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
    // The greatest depth in any of the balls (which are cut, unlike the shanks above them), or above the block.
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
