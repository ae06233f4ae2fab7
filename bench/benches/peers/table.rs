//! What was measured, as objects or as a table.

use crate::clock::Times;
use crate::exact::Errors;
use serde::Serialize;

/// One method on one scene and cloud. Errors are relative, `null` where there is nothing to err on.
#[derive(Serialize)]
pub(crate) struct Row {
    scene: &'static str,
    points: usize,
    method: &'static str,
    /// On how many poses it was timed.
    poses: usize,
    ns_avg: f64,
    ns_p50: Option<u64>,
    ns_p99: Option<u64>,
    ns_p999: Option<u64>,
    ns_max: Option<u64>,
    /// CPU time, on average.
    cpu_avg: f64,
    colliding_avg: f64,
    colliding_max: usize,
    /// At how many poses the truth was worked out, and the count was found to be wrong.
    checked: usize,
    miscounted: usize,
    /// Depth against the deepest point of the cloud, for a method without points of the part.
    err_depth: Option<f64>,
    /// Depth against the deepest point of the part.
    err_part: Option<f64>,
    err_force: Option<f64>,
    err_torque: Option<f64>,
}

impl Row {
    pub(crate) fn new(
        scene: &'static str,
        points: usize,
        method: &'static str,
        times: &Times,
        errors: &Errors,
    ) -> Row {
        let (colliding_avg, colliding_max) = times.colliding();
        Row {
            scene,
            points,
            method,
            poses: times.poses(),
            ns_avg: times.average(),
            ns_p50: times.percentile(0.5),
            ns_p99: times.percentile(0.99),
            ns_p999: times.percentile(0.999),
            ns_max: times.longest(),
            cpu_avg: times.cpu(),
            colliding_avg,
            colliding_max,
            checked: errors.checked(),
            miscounted: errors.miscounted(),
            err_depth: errors.depth(),
            err_part: errors.part_depth(),
            err_force: errors.force(),
            err_torque: errors.torque(),
        }
    }
}

/// A row as one object a line.
pub(crate) fn json(row: &Row) {
    println!("{}", serde_json::to_string(row).expect("a row of numbers"));
}

/// What the table is about.
pub(crate) fn head(pinned: bool) {
    let pinned = if pinned { "pinned to one core" } else { "not pinned (the system refuses)" };
    println!(
        "# Beside other ways to ask the same

```sh
cargo bench -p touchoff-bench --features peers --bench peers > docs/measured/peers.md
```

(`-- --json` for one object a row.) The tool of fig. 7.3 on the tube, all in one process, the thread {pinned}, no compiler
flags. Every pose is asked of one method after the other, in turns of 25 poses; no pose is asked twice, and slow methods sit
out turns (**poses** says how many they had, evenly along the path). **avg** and **CPU** are wall and CPU time of whole turns,
in µs a query; the percentiles are of others, timed query by query. Where avg is far above CPU, other programs had the core: a
p99.9 or max of some 4 ms is a slice of theirs. **×** is how many times the CPU time of `brute-f64` is as long.

**Miscounted**: at so many of the checked poses the number of colliding points is not the oracle's. Errors are relative to the
oracle's loop in f64 over the same cloud, the root mean square over poses in contact; **part** is the error of depth against
the deepest point of the triangles, which a cloud can only approach. `touchoff` also finds niceness, energy and where the
deepest point is; the others find only what is compared.

| method | what it is |
|---|---|
| `touchoff` | this project: the compiled tool, all that `Probe::wrench` answers |
| `brute-f64` | every point, scalar, with branches |
| `brute-f32` | every point, all in f32, 16 at a time |
| `thesis` | binary tree of 18-DOPs behind pointers, the tool in three volumes, scalar trees of splits |
| `parry-bvh` | `parry3d`'s `Bvh` over blocks of 64 points, the tool's outline, formula and SIMD by hand, survivors in f64 |
| `parry-contact` | `parry3d`'s `contact` of a compound and the triangle mesh: a depth, no force. Its depth is the way out of one convex shape, which in `hold` is not the thesis's magnitude |
| `fidget` | the formula as a JIT: intervals on nodes, a slice of points, gradients of hits |
| `grid` | signed distances on a grid of 0.1 mm in space (13 MB), interpolated, under a tree of spheres |
| `grid-dz` | the same in the half plane, at 0.02 mm (1.3 MB): only for tools with an axis |
"
    );
}

/// All rows, scene by scene.
pub(crate) fn markdown(rows: &[Row]) {
    let mut scenes: Vec<&str> = Vec::new();
    for row in rows {
        if !scenes.contains(&row.scene) {
            scenes.push(row.scene);
        }
    }
    for scene in scenes {
        println!(
            "## {scene}

| points | method | poses | avg | p50 | p99 | p99.9 | max | CPU | × | colliding | miscounted | depth | part | force | torque |
|--:|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|"
        );
        for row in rows.iter().filter(|row| row.scene == scene) {
            let brute = rows.iter().find(|other| {
                (other.scene, other.points, other.method) == (scene, row.points, "brute-f64")
            });
            line(row, brute);
        }
        println!();
    }
}

fn line(row: &Row, brute: Option<&Row>) {
    let us = |ns: f64| format!("{:.*}", if ns < 9_995.0 { 2 } else { 0 }, ns / 1e3);
    let time = |ns: Option<u64>| ns.map_or("-".into(), |ns| us(ns as f64));
    let error = |value: Option<f64>| value.map_or("-".into(), |value| format!("{value:.0e}"));
    println!(
        "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {:.1} | {}/{} | {} | {} | {} | {} |",
        row.points,
        row.method,
        row.poses,
        us(row.ns_avg),
        time(row.ns_p50),
        time(row.ns_p99),
        time(row.ns_p999),
        time(row.ns_max),
        us(row.cpu_avg),
        brute.map_or("-".into(), |brute| format!("{:.1}", brute.cpu_avg / row.cpu_avg)),
        row.colliding_avg,
        row.miscounted,
        row.checked,
        error(row.err_depth),
        error(row.err_part),
        error(row.err_force),
        error(row.err_torque),
    );
}
