//! Nodes inside a mesh, against closed forms and solid angles.

use super::*;
use nalgebra::Rotation3;
use std::f64::consts::PI;
use touchoff::mesh::{Geometry, shapes};

/// Returns the winding number of a mesh about a point, from the solid angles of its triangles (Van Oosterom
/// and Strackee 1983); `None` if the point is on a triangle, within rounding.
fn solid_angles(mesh: &Mesh, point: Point3<f64>) -> Option<f64> {
    let mut sum = 0.0;
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|vertex| mesh.vertices()[vertex as usize] - point);
        let (x, y, z) = (a.norm(), b.norm(), c.norm());
        let volume = a.dot(&b.cross(&c));
        let rest = x * y * z + a.dot(&b) * z + b.dot(&c) * x + c.dot(&a) * y;
        let rounding = 1e-9 * x * y * z;
        if volume.abs() <= rounding && rest <= rounding {
            return None;
        }
        sum += 2.0 * volume.atan2(rest);
    }
    let winding = sum / (4.0 * PI);
    assert!((winding - winding.round()).abs() < 1e-6, "{winding} at {point}");
    Some(winding)
}

fn joined(one: &Mesh, other: &Mesh, turned: bool) -> Mesh {
    let after = one.vertices().len() as u32;
    let turn = |[a, b, c]: [u32; 3]| if turned { [b, a, c] } else { [a, b, c] };
    let more = other.triangles().iter().map(|corners| turn(corners.map(|k| k + after)));
    let triangles = one.triangles().iter().copied().chain(more);
    Mesh::new([one.vertices(), other.vertices()].concat(), triangles, UNIT).expect("a mesh")
}

fn turned(mesh: &Mesh, angles: [f64; 3]) -> Mesh {
    let rotation = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
    let vertices = mesh.vertices().iter().map(|vertex| rotation * vertex);
    Mesh::new(vertices, mesh.triangles().to_vec(), UNIT).expect("a mesh")
}

#[test]
fn winding_numbers_agree_with_solid_angles() {
    let tube = shapes::tube(3.0, 5.0, 9.0, 24, 3, UNIT).expect("a tube");
    let sphere = shapes::sphere(4.0, 2, UNIT).expect("a sphere");
    let [low, high] = [-6.0, 6.0].map(|c| Point3::new(c, c, c));
    let cube = shapes::cuboid(low, high, UNIT).expect("a cube");
    // A void, two solids side by side, and two solids that overlap.
    let hollow = joined(&cube, &sphere, true);
    let meshes = [
        turned(&tube, [0.3, -0.7, 0.2]),
        turned(&sphere, [1.0, 0.2, 0.1]),
        turned(&hollow, [0.1, 0.4, 0.9]),
        joined(&cube, &turned(&tube, [0.3, 0.2, 0.1]), false),
        tube,
        sphere,
        hollow,
        cube,
    ];
    let (mut nodes, mut on_surface) = (0, 0);
    for mesh in meshes {
        for spacing in [0.5, 0.7] {
            let stock = Stock::from_mesh(&mesh, spacing).expect("a stock");
            for node in 0..stock.lattice.len() {
                let winding = solid_angles(&mesh, stock.lattice.position(node).into());
                nodes += 1;
                let Some(winding) = winding else {
                    on_surface += 1;
                    continue;
                };
                let is_inside = stock.initial.contains(node);
                assert_eq!(is_inside, winding > 0.5, "{:?}", stock.lattice.position(node));
            }
        }
    }
    println!("{nodes} nodes, {on_surface} on the surface");
    assert!(nodes > 20_000 && on_surface < nodes / 20);
}

/// Parts from files, at some nodes each. A part that leaks is refused.
#[test]
fn parts_from_files_agree_with_solid_angles() {
    let mut random = Random(11);
    let mut checked = 0;
    for file in [
        "thesis_tube.stl",
        "impeller.stl",
        "kiri_pocket_test.stl",
        "nist_mbe_pmi_1_18k.ply",
        "nist_mbe_pmi_2_46k_leaky.ply",
    ] {
        let Some(path) = shared(&format!("parts/{file}")) else { continue };
        let Ok(Geometry::Mesh(mesh)) = Geometry::read(&path, UNIT) else { panic!("{file}") };
        let [low, high] = mesh.bounds();
        let spacing = (high - low).max() / 80.0;
        let stock = match Stock::from_mesh(&mesh, spacing) {
            Ok(stock) => stock,
            Err(refused) => {
                assert_eq!(refused, StockError::NoInside { what: "stock" });
                assert!(file.contains("leaky"), "{file}");
                continue;
            }
        };
        let volume = mesh.diagnostics().volume;
        println!(
            "{file}: {} points, volume {:.4} of the mesh's",
            stock.len(),
            stock.volume() / volume
        );
        assert!((stock.volume() / volume - 1.0).abs() < 0.03, "{file}");
        for _ in 0..200 {
            let node = (random.next() * stock.lattice.len() as f64) as usize;
            let winding = solid_angles(&mesh, stock.lattice.position(node).into());
            if let Some(winding) = winding {
                assert_eq!(stock.initial.contains(node), winding > 0.5, "{file} {node}");
                checked += 1;
            }
        }
    }
    println!("{checked} nodes of parts from files");
}

/// Columns through edges, corners and vertical faces, and nodes on faces: half-open in each coordinate, as if
/// each node were moved up by an infinitely small amount.
#[test]
fn nodes_on_the_surface_are_moved_up() {
    let (low, high) = (Point3::new(-1.0, -2.0, -1.0), Point3::new(1.0, 2.0, 3.0));
    let mesh = shapes::cuboid(low, high, UNIT).expect("a block");
    let around = [low - Vector3::new(2.5, 2.5, 2.5), high + Vector3::new(2.5, 2.5, 2.5)];
    let mut on_faces = 0;
    for spacing in [1.0, 0.5] {
        // Nodes at multiples of the spacing: from one box on all faces, from the other on none.
        for shift in [0.5 * (1.0 - spacing), 0.25] {
            let shift = Vector3::new(shift, shift, shift);
            let around = around.map(|corner| corner + shift);
            let lattice = Lattice::new(around, spacing).expect("a lattice");
            let triangles = mesh.corners().map(|corners| corners.map(|corner| corner.into()));
            let inside = nodes_inside(triangles, &lattice).expect("an inside");
            for node in 0..lattice.len() {
                let at = lattice.position(node);
                let expected = (0..3).all(|axis| low[axis] <= at[axis] && at[axis] < high[axis]);
                assert_eq!(inside.contains(node), expected, "{at:?}");
                on_faces += usize::from((0..3).any(|k| at[k] == low[k] || at[k] == high[k]));
            }
        }
    }
    assert!(on_faces > 100, "{on_faces}");
}

#[test]
fn a_box_and_its_mesh_are_the_same_stock() {
    let (low, high) = (Point3::new(0.0, 0.0, 0.0), Point3::new(10.0, 7.0, 3.1));
    let mesh = shapes::cuboid(low, high, UNIT).expect("a block");
    for spacing in [0.1, 0.5, 0.3, 1.0, 4.0, 20.0] {
        let of_mesh = Stock::from_mesh(&mesh, spacing).expect("a stock");
        let of_box = Stock::from_box([low, high], spacing, UNIT).expect("a stock");
        assert_eq!(of_mesh.initial, of_box.initial);
        assert_eq!(of_box.len(), of_box.lattice.len());
        // The same distance from both faces: half a spacing for multiples, else a quarter to three quarters.
        for axis in 0..3 {
            let first = of_box.lattice.coordinate(axis, 0.0) - low[axis];
            let count = of_box.lattice.counts()[axis];
            let last = high[axis] - of_box.lattice.coordinate(axis, count as f64 - 1.0);
            assert!(first > 0.0 && (first - last).abs() < 1e-9, "{first} {last}");
            let [low, high] = if count == 1 { [0.0, 0.75] } else { [0.25, 0.75] };
            assert!((low..=high).contains(&(first / spacing)), "{first} {spacing}");
        }
    }
    let stock = Stock::from_box([low, Point3::new(10.0, 7.0, 3.0)], 0.1, UNIT).expect("a stock");
    assert_eq!(stock.len(), 100 * 70 * 30);
    assert!((stock.volume() - 210.0).abs() < 1e-9);
}

/// A ball with the stated radius has a point in it wherever it is. Between eight nodes, the rounding of
/// stored points makes some balls of √3/2 of the spacing miss all of them.
#[test]
fn no_larger_ball_is_missed() {
    let mut random = Random(1);
    let mut missed = 0;
    for (low, high, spacing) in [(0.0, 10.0, 0.5), (0.1, 9.1, 0.3), (1e3, 1.001e3, 0.07)] {
        let stock = block([low; 3], [high; 3], spacing);
        let stored: Vec<_> = (0..stock.tree.slots()).map(|slot| stock.tree.point(slot)).collect();
        let (radius, bare) = (stock.missed_ball_radius(), 0.75f64.sqrt() * spacing);
        assert!(radius > bare && radius < bare * (1.0 + 1e-6), "{radius} {bare}");
        let last = stock.lattice.counts()[0] as f64 - 1.0;
        for k in 0..200 {
            let aside = if k % 2 == 0 { 0.0 } else { 0.02 };
            let centre = Point3::from([0, 1, 2].map(|axis| {
                let number = (random.next() * last).floor() + 0.5;
                stock.lattice.coordinate(axis, number) + aside * spacing * random.next()
            }));
            let nearest = stored.iter().map(|p| (p - centre).norm()).fold(f64::INFINITY, f64::min);
            assert!(nearest <= radius, "{nearest} {radius}");
            missed += usize::from(nearest > bare);
        }
    }
    assert!(missed > 0, "rounding plays no part");
}

#[test]
fn what_is_no_stock_is_refused() {
    let at = |x: f64| Point3::new(x, x, x);
    let cube = shapes::cuboid(at(0.0), at(10.0), UNIT).expect("a cube");
    for spacing in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = Stock::from_mesh(&cube, spacing).expect_err("no spacing");
        assert!(matches!(refused, StockError::Spacing { .. }), "{refused}");
    }
    for (low, high) in [(0.0, 0.0), (1.0, 0.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
        let refused = Stock::from_box([at(low), at(high)], 1.0, UNIT).expect_err("no box");
        assert!(matches!(refused, StockError::Box { axis: 'x', .. }), "{refused}");
    }
    let sheet = shapes::plane(2.0, 4, UNIT).expect("a plane");
    let refused = Stock::from_mesh(&sheet, 0.1).expect_err("no inside");
    assert_eq!(refused, StockError::NoInside { what: "stock" });
    // A piece that is inside out, next to a good one, and one that sticks out of it.
    for place in [20.0, 9.0] {
        let small = shapes::cuboid(at(place), at(place + 2.0), UNIT).expect("a cube");
        let mesh = joined(&cube, &small, true);
        let refused = Stock::from_mesh(&mesh, 0.5).expect_err("inside out");
        let StockError::InsideOut { point } = refused else { panic!("{refused}") };
        assert!(point.iter().all(|c| (place..place + 2.0).contains(c)), "{point:?}");
    }
    let tube = shapes::tube(3.0, 5.0, 9.0, 24, 3, UNIT).expect("a tube");
    assert!(matches!(Stock::from_mesh(&tube, 20.0), Err(StockError::Empty { .. })));
    for spacing in [1e-12, 1e-200] {
        let refused = Stock::from_mesh(&cube, spacing).expect_err("too fine");
        let StockError::Resolution { limit, .. } = refused else { panic!("{refused}") };
        assert!(limit > 9e-12 && limit < 1e-11, "{limit}");
    }
    // The spacing that a refusal names is accepted.
    for spacing in [1e-3, 1e-9, 1e-11] {
        let refused = Stock::from_mesh(&tube, spacing).expect_err("too fine");
        let StockError::TooManyNodes { coarser, .. } = refused else { panic!("{refused}") };
        let lattice = Lattice::new(tube.bounds(), coarser);
        assert!(lattice.is_ok_and(|lattice| lattice.len() > 4_000_000_000), "{coarser}");
    }
    let refused = Stock::from_box([at(0.0), at(10.0)], 0.02, UNIT).expect_err("too many");
    let StockError::TooManyPoints { coarser, points: 125_000_000, .. } = refused else {
        panic!("{refused}")
    };
    assert!(Lattice::new([at(0.0), at(10.0)], coarser).is_ok_and(|l| l.len() <= MAX_POINTS));
    assert!(coarser < 1.02 * (1000.0 / MAX_POINTS as f64).cbrt());
}
