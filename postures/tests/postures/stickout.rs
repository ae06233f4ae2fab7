//! Least stick-out per tool, compared with a raster of the part in every direction from which the tool reaches.

use crate::sweep_all;
use nalgebra::{Point3, Vector3};
use std::fs;
use touchoff::mesh::shapes;
use touchoff::tool::Interpreted;
use touchoff::{Mesh, Tool, Unit};
use touchoff_postures::{Directions, Rules};

/// Distance between points of the raster.
const SPACING: f64 = 1.0;
/// Radius of the ball and length of the cutting part of both tools.
const RADIUS: f64 = 2.0;
const CUTTING: f64 = 8.0;

/// A cylinder as a holder, in mm.
struct Holder {
    radius: f64,
    stickout: f64,
}

/// Loads a ball mill in a holder, from files.
fn load(holder: &Holder, name: &str) -> Interpreted {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |file: &str, text: String| {
        fs::write(folder.path().join(file), text).expect("a writable folder");
    };
    let Holder { radius, stickout } = holder;
    write(
        "ball.tool",
        format!(
            "tool Ball \"a ball\" {{ units mm; profile {{ start (0, 0); \
             arc to ({RADIUS}, {RADIUS}) center (0, {RADIUS}) as ball cutting; \
             line to ({RADIUS}, {CUTTING}) as flute cutting; line to ({RADIUS}, 60), (0, 60) as shank; }} \
             niceness cutting: 1; }}"
        ),
    );
    write(
        "nut.tool",
        format!(
            "tool Nut \"a cylinder\" {{ units mm; profile {{ start (0, 0); \
             line to ({radius}, 0), ({radius}, 50), (0, 50) as nut; }} }}"
        ),
    );
    let tool = format!(
        "tool {name} \"a ball in a nut\" {{ units mm; mount \"ball.tool\" as cutter; \
         mount \"nut.tool\" as nut at z = {stickout}; }}"
    );
    write("tool.tool", tool);
    Interpreted::load(folder.path().join("tool.tool")).expect("a tool")
}

/// Returns a table of 40 by 40 with a wall of a height along one side.
fn step(height: f64) -> Mesh {
    let low = shapes::cuboid(
        Point3::new(-20.0, -20.0, -5.0),
        Point3::new(20.0, 20.0, 0.0),
        Unit::Millimetre,
    );
    let wall = shapes::cuboid(
        Point3::new(8.0, -20.0, -5.0),
        Point3::new(20.0, 20.0, height),
        Unit::Millimetre,
    );
    let [low, wall] = [low, wall].map(|mesh| mesh.expect("a cuboid"));
    let vertices = [low.vertices(), wall.vertices()].concat();
    let moved = wall.triangles().iter().map(|corners| corners.map(|corner| corner + 8));
    let triangles = low.triangles().iter().copied().chain(moved);
    Mesh::new(vertices, triangles, Unit::Millimetre).expect("a mesh")
}

/// Returns points of a mesh, at most [`SPACING`] apart along the sides of each triangle.
fn raster(mesh: &Mesh) -> Vec<Point3<f64>> {
    let mut points = Vec::new();
    for id in mesh.ids() {
        let [a, b, c] = mesh.triangle(id);
        let longest = (b - a).norm().max((c - a).norm()).max((c - b).norm());
        let count = (longest / SPACING).ceil() as u32;
        for i in 0..=count {
            for j in 0..=count - i {
                let [u, v] = [i, j].map(|k| f64::from(k) / f64::from(count));
                points.push(a + (b - a) * u + (c - a) * v);
            }
        }
    }
    points
}

#[test]
fn each_tool_has_the_least_stick_out_of_its_own_holder() {
    let holders = [Holder { radius: 6.0, stickout: 24.0 }, Holder { radius: 15.0, stickout: 40.0 }];
    let tools = [load(&holders[0], "Slim"), load(&holders[1], "Wide")];
    let directions = Directions::spread(40);
    let rules = Rules { tolerance: 0.01, niceness: 0.0, allowed: Vec::new() };
    let (mut less, mut most) = ([0; 2], [0; 2]);
    let tube = |length| shapes::tube(5.0, 20.0, length, 8, 2, Unit::Millimetre).expect("a tube");
    for mesh in [step(0.5), step(17.0), step(30.0), tube(30.0), tube(50.0)] {
        let all: Vec<&dyn Tool> = tools.iter().map(|tool| tool as &dyn Tool).collect();
        let (rows, _) = sweep_all(&mesh, &all, &directions, rules.clone());
        let points = raster(&mesh);
        for (id, row) in mesh.ids().zip(&rows) {
            let [a, b, c] = mesh.triangle(id);
            let normal = mesh.normal(id).expect("an area");
            let point = Point3::from((a.coords + b.coords + c.coords) / 3.0);
            for (tool, access) in row.access.iter().enumerate() {
                let Holder { radius, stickout } = holders[tool];
                let (mut least, mut enough) = (f64::INFINITY, f64::INFINITY);
                for (k, axis) in directions.list().iter().enumerate() {
                    if access.directions[k / 64] >> (k % 64) & 1 == 0 {
                        continue;
                    }
                    let axis = Vector3::from(*axis);
                    // The ball touches the centroid.
                    let tip = point + RADIUS * (normal - axis);
                    let highest = |radius: f64| {
                        let inside = points.iter().filter_map(|place| {
                            let (way, height) = (place - tip, (place - tip).dot(&axis));
                            ((way - axis * height).norm() <= radius).then_some(height)
                        });
                        inside.fold(CUTTING, f64::max)
                    };
                    least = least.min(highest(radius));
                    // Between points of the raster, and in a small triangle, the part may be higher.
                    let off = SPACING + radius / 32.0;
                    enough = enough.min(highest(radius + off) + off);
                }
                let text = format!("tool {tool} at {id}, {least} to {enough}: {access:?}");
                match access.stickout {
                    None => assert!(least.is_infinite(), "{text}"),
                    Some(found) => {
                        assert!(found <= stickout && found >= least.min(stickout) - 1e-9, "{text}");
                        assert!(found <= enough, "{text}");
                        less[tool] += u32::from(found < stickout - 1.0);
                        most[tool] += u32::from(found > CUTTING + 1.0);
                    }
                }
            }
        }
    }
    println!("{less:?} below the tool's own, {most:?} above the cutting part");
    assert!(less.iter().all(|count| *count > 10), "{less:?}");
    assert!(most.iter().all(|count| *count > 2), "{most:?}");
}
