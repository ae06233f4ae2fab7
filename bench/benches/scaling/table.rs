//! Rows as objects, or as tables.

use crate::row::{Apart, Built, Contact, Line, Passed, Query, Row, Timing};

/// A row as one object a line.
pub(crate) fn json(row: &Row) {
    println!("{}", serde_json::to_string(row).expect("a row of numbers"));
}

/// All rows, table by table; tables without rows are left out.
pub(crate) fn markdown(rows: &[Row], pinned: bool) {
    let pinned = if pinned { "pinned to one core" } else { "not pinned (the system refuses)" };
    println!(
        "# How a query's time grows

```sh
cargo bench -p touchoff-bench --features peers --bench scaling > docs/measured/scaling.md
```

(`-- --json` for one object a row.) The tool of fig. 7.3 on the tube, one thread, {pinned}. Times are of one query, ns. **best**:
the poses in blocks of 25, five passes, the fastest pass of each block, summed: the machine undisturbed. **median**: the pass in the
middle, by the clock on the wall: where it is far above, other programs had the core. **CPU**, **p50** and **p99** are timed as
`peers` are, every pose asked once; a single query is timed some 20 ns too long. **detect** begins where it hit last, which along a
path is mostly where it hits again.
"
    );
    queries(&some(rows, |row| match row {
        Row::Query(query) => Some(query),
        _ => None,
    }));
    contacts(rows);
    aparts(&some(rows, |row| match row {
        Row::Apart(apart) => Some(apart),
        _ => None,
    }));
    builds(&some(rows, |row| match row {
        Row::Build(built) => Some(built),
        _ => None,
    }));
}

fn some<T>(rows: &[Row], which: impl Fn(&Row) -> Option<&T>) -> Vec<&T> {
    rows.iter().filter_map(which).collect()
}

fn queries(rows: &[&Query]) {
    let mut scenes: Vec<&str> = Vec::new();
    for row in rows {
        if !scenes.contains(&row.scene) {
            scenes.push(row.scene);
        }
    }
    for scene in scenes {
        println!(
            "## {scene}

| points | colliding | wrench: best | median | CPU | p50 | p99 | ns a colliding point | detect: best | median | CPU | p50 | p99 | wrench by detect |
|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|"
        );
        let of_scene: Vec<&&Query> = rows.iter().filter(|row| row.scene == scene).collect();
        for pair in of_scene.chunks_exact(2) {
            let [wrench, detect] = [&pair[0].timing, &pair[1].timing];
            println!(
                "| {} | {:.1} | {} | {} | {} | {:.1} |",
                pair[0].points,
                wrench.passed.colliding_avg,
                times(wrench),
                pair[0].ns_a_point.map_or("-".into(), |ns| format!("{ns:.1}")),
                times(detect),
                wrench.passed.ns_best / detect.passed.ns_best,
            );
        }
        println!();
    }
}

fn contacts(rows: &[Row]) {
    let contacts: Vec<&Contact> = some(rows, |row| match row {
        Row::Contact(contact) => Some(contact),
        _ => None,
    });
    let Some(first) = contacts.first() else { return };
    println!(
        "## By what collides

{} points. In `wall` the ball is pushed so deep (mm) into the outer wall; of the paths those blocks are together at which about
as many points collide.

| scene | depth | poses | colliding | best | median |
|---|--:|--:|--:|--:|--:|",
        first.points
    );
    for Contact { scene, depth, passed, .. } in contacts {
        let depth = depth.map_or("-".into(), |depth| depth.to_string());
        let Passed { passed, colliding_avg, ns_best, ns_median } = passed;
        println!(
            "| {scene} | {depth} | {passed} | {colliding_avg:.1} | {ns_best:.0} | {ns_median:.0} |"
        );
    }
    let lines: Vec<&Line> = some(rows, |row| match row {
        Row::Fit(line) => Some(line),
        _ => None,
    });
    println!(
        "\nAs a line, its relative errors least:\n\n| scene | ns at none | ns a point more |\n|---|--:|--:|"
    );
    for line in lines {
        println!("| {} | {:.0} | {:.2} |", line.scene, line.ns_at_zero, line.ns_a_point);
    }
    println!();
}

fn aparts(rows: &[&Apart]) {
    let Some(first) = rows.first() else { return };
    println!(
        "## Apart

{} points; the ball so far (mm) from the outer wall.

| gap | wrench: best | median | CPU | p50 | p99 | detect: best | median | CPU | p50 | p99 |
|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|",
        first.points
    );
    for pair in rows.chunks_exact(2) {
        println!("| {} | {} | {} |", pair[0].gap, times(&pair[0].timing), times(&pair[1].timing));
    }
    println!();
}

fn builds(rows: &[&Built]) {
    if rows.is_empty() {
        return;
    }
    println!(
        "## To build

**Cloud**: random points on the tube's triangles; **part**: the tree of it. Times in ms, best and median; bytes are a point's share,
allocated and still there afterwards. The **descent** reads only offsets and boxes, by their layout.

| points | builds | cloud, ms | median | part, ms | median | ns a point | cloud, bytes | part, bytes | descent, bytes |
|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|"
    );
    for row in rows {
        println!(
            "| {} | {} | {:.2} | {:.2} | {:.2} | {:.2} | {:.0} | {:.1} | {:.1} | {:.1} |",
            row.points,
            row.builds,
            row.cloud_ms_best,
            row.cloud_ms_median,
            row.tree_ms_best,
            row.tree_ms_median,
            1e6 * row.tree_ms_best / row.points as f64,
            row.cloud_bytes,
            row.part_bytes,
            row.geometry_bytes,
        );
    }
    println!();
}

/// The five columns of a question.
fn times(timing: &Timing) -> String {
    let single = |ns: Option<u64>| ns.map_or("-".into(), |ns| ns.to_string());
    format!(
        "{:.0} | {:.0} | {:.0} | {} | {}",
        timing.passed.ns_best,
        timing.passed.ns_median,
        timing.cpu_avg,
        single(timing.ns_p50),
        single(timing.ns_p99),
    )
}
