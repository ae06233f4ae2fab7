//! Certified penetrations, checked against brute force at some hundred poses and against known results.
//!
//! `cargo run --release -p touchoff-bench -- certified` checks 100,000 poses.

mod allowances;
mod clearance;
mod closed_forms;
mod enclosed;
mod end_in_part;
mod fields;
mod hard_cases;
mod overhang;
mod ring_of_ties;
mod rounding;
mod spinning;
mod sweeps;
mod zoomed;

use nalgebra::{Point3, Vector3};
use touchoff::certify::TriangleBvh;
use touchoff::{Mesh, Pose, Tool, Unit};
use touchoff_bench::certified::{Pair, poses};
use touchoff_tests::oracle::Nearest;

/// Number of poses per part and tool.
const POSES: usize = 24;
const SEED: u64 = 2;

/// Returns a tool of the library, or one of [`overhang`].
fn tool(name: &str) -> &'static dyn Tool {
    tools_library::find(name).or_else(|| overhang::tool(name)).expect("a tool")
}

/// Returns the oracle of the tool, from the dimensions of its drawing.
fn oracle(name: &str) -> Nearest {
    overhang::oracle(name).unwrap_or_else(|| Nearest::of(name))
}

fn pose(tip: [f64; 3], axis: [f64; 3]) -> Pose {
    Pose::from_axis(Point3::from(tip), Vector3::from(axis)).expect("an axis")
}

/// Returns a plate of 40 by 30 mm whose upper face is at z = 0.
fn plate() -> Mesh {
    let [low, high] = [Point3::new(-20.0, -15.0, -10.0), Point3::new(20.0, 15.0, 0.0)];
    touchoff::mesh::shapes::cuboid(low, high, Unit::Millimetre).expect("a cuboid")
}

/// Returns a mesh of these triangles, which share no vertices.
fn soup(triangles: &[[[f64; 3]; 3]]) -> Mesh {
    let vertices = triangles.iter().flatten().map(|corner| Point3::from(*corner)).collect();
    let ids = (0..triangles.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    Mesh::new(vertices, ids, Unit::Millimetre).expect("a mesh")
}

fn violations(names: &[&str], count: usize, seed: u64) -> Vec<String> {
    let mut violations = Vec::new();
    for (part, mesh) in poses::parts().expect("parts") {
        let bvh = TriangleBvh::new(&mesh);
        for (k, name) in names.iter().enumerate() {
            let oracle = oracle(name);
            let (mesh, bvh) = (&mesh, &bvh);
            let pair = Pair { part, mesh, bvh, tool: tool(name), oracle: &oracle };
            let row = pair.measure(count, seed + k as u64);
            assert!(row.touching > count / 3, "{row:?}");
            violations.extend(row.violations);
        }
    }
    violations
}

#[test]
fn brute_force_stays_within_the_intervals() {
    let tools = ["Fig73Exact", "BullNose", "TSlot", "BallEr16", "TaperedBall"];
    let violations = violations(&tools, POSES, SEED);
    assert!(violations.is_empty(), "{violations:#?}");
}

#[test]
fn brute_force_stays_within_the_intervals_of_overhanging_profiles() {
    let tools = [&["FaceMill", "BoringBar"], &overhang::ALL[..]].concat();
    let violations = violations(&tools, POSES, 7);
    assert!(violations.is_empty(), "{violations:#?}");
}

#[test]
fn brute_force_stays_within_the_intervals_on_a_neck() {
    let violations = violations(&["Lollipop"], 4 * POSES, 2);
    assert!(violations.is_empty(), "{violations:#?}");
}
