//! What was measured, as objects or as tables.

use crate::config::{BASE, Config};
use crate::measure::{Measured, Scene};
use crate::study::{Cross, Study};
use serde::Serialize;

/// One tree on one scene and cloud.
#[derive(Serialize)]
struct Row<'a> {
    study: &'a str,
    volume: &'static str,
    leaf: usize,
    branching: usize,
    axis: &'static str,
    point: &'static str,
    points: usize,
    bytes_per_point: f64,
    points_per_leaf: f64,
    build_ms: f64,
    scene: &'static str,
    /// CPU time of a query; of two things varied only the search is timed.
    ns: Option<f64>,
    /// The search alone, and by that of the base in the same race.
    search_ns: f64,
    search_ratio: Option<f64>,
    volumes_tested: f64,
    leaves_reached: f64,
    points_tested: f64,
}

/// A race as one object a line for every scene.
pub(crate) fn json(study: &str, points: usize, scenes: &[Scene], all: &[Measured]) {
    let base = all.iter().find(|one| one.config == BASE);
    for one in all {
        for (at, (scene, found)) in scenes.iter().zip(&one.scenes).enumerate() {
            let row = Row {
                study,
                volume: one.config.kind.name(),
                leaf: one.config.rule.leaf,
                branching: one.config.branching,
                axis: one.config.axis(),
                point: one.config.point(),
                points,
                bytes_per_point: one.bytes,
                points_per_leaf: one.fill,
                build_ms: one.build,
                scene: scene.path.name(),
                ns: found.time,
                search_ns: found.search,
                search_ratio: base.map(|base| found.search / base.scenes[at].search),
                volumes_tested: found.tested,
                leaves_reached: found.leaves,
                points_tested: found.points,
            };
            println!("{}", serde_json::to_string(&row).expect("a row of numbers"));
        }
    }
}

/// What the tables are about.
pub(crate) fn head(pinned: bool, level: &str) {
    let pinned = if pinned { "pinned to one core" } else { "not pinned (the system refuses)" };
    let Config { kind, branching, rule } = BASE;
    println!(
        "# What makes a tree over the points fast

```sh
cargo bench -p touchoff-tests --features peers --bench volumes > docs/measured/volumes.md
```

(`-- --json` for one object a row.) Ho (1999), section 7.5.1, leaves open which bounding volume, how many points of a leaf, how
many children of a node and which way of dividing make a query fast. Here one tree has them as parameters. The tool is that of
fig. 7.3, the part the tube; volumes are in `f32`, children of a node side by side in one loop that the compiler makes vectors
of ({level}); points are carried in `f64`, eight in a loop, and those within the outline asked through the tool's splits.

Every volume is put to the same test in the tool's frame: from where to where it reaches along the axis, and a distance that it
keeps from the axis, against the largest radius of the tool over that stretch. A sphere says both by its centre; a box by how
far it reaches along three axes of the tool; a k-DOP likewise, by an upper bound from three of its directions. A 6-DOP is the
AABB. Besides, spheres are held to the distance from the tool, which is closer and which for other volumes would take long.
What is varied is one thing, all else as in the base: {volume}, at most {leaf} points a leaf, {branching} children, {axis}, {point}.
All volumes bound the same sets of points, which are divided without regard to the volume.

Every row of a table is timed against the others in turns of 25 poses, the thread {pinned}, no pose asked twice in a round.
**ns** is CPU time of a query, the median of three rounds; **search** is that of a query which stops at the points within the
tool's outline and does not ask what they feel. **volumes**, **leaves** and **points** are what a query tests on average.
**bytes** are those of the nodes a point (they begin at cache lines; the point itself, its normal and weight are 80 more), **a
leaf** is how many points one has on average, **build** is the CPU time to build the tree, ms. The base stands in every table: how
far its times differ there is what the machine does, and which trees share its caches, so times compare within a table only, and
what is within a tenth of the fastest is named with it. Of the larger cloud one thing is varied at a time, on fewer poses. Before
it is timed every tree is held to brute force at hundreds of poses of each scene: the same number of points, the same force and
torque.
",
        volume = kind.name(),
        leaf = rule.leaf,
        axis = BASE.axis(),
        point = BASE.point(),
    );
}

/// One thing varied.
pub(crate) fn study(study: &Study, scenes: &[Scene], all: &[Measured]) {
    let names: Vec<&str> = scenes.iter().map(|scene| scene.path.name()).collect();
    let heads =
        names.iter().map(|name| format!("{name} ns | search | volumes | leaves | points |"));
    println!("| | bytes | a leaf | build | {}", heads.collect::<Vec<_>>().join(" "));
    println!("|---|--:|--:|--:|{}", "--:|".repeat(5 * names.len()));
    for ((word, _), one) in study.rows.iter().zip(all) {
        let cells = one.scenes.iter().map(|found| {
            let [tested, leaves, points] = [found.tested, found.leaves, found.points].map(number);
            let time = found.time.map_or("-".into(), |time| format!("{time:.0}"));
            let search = found.search;
            format!("{time} | {search:.0} | {tested} | {leaves} | {points} |")
        });
        let cells = cells.collect::<Vec<_>>().join(" ");
        let [bytes, fill, build] = [one.bytes, one.fill, one.build].map(number);
        println!("| {word} | {bytes} | {fill} | {build} | {cells}");
    }
    println!();
    let words = || study.rows.iter().map(|(word, _)| &word[..]);
    for (at, name) in names.iter().enumerate() {
        let search = all.iter().map(|one| one.scenes[at].search);
        let whole = all.iter().filter_map(|one| one.scenes[at].time);
        let (search, whole) = (extremes(search.zip(words())), extremes(whole.zip(words())));
        println!("- {name}: search {search}; the whole query {whole}.");
    }
    println!();
}

/// Times that differ by no more are taken for alike: those of one tree differ so between tables.
const ALIKE: f64 = 1.1;
/// How many are named that are like the fastest.
const NAMED: usize = 3;

/// The fastest of some with those like it, and the slowest, in words.
fn extremes<'a>(times: impl Iterator<Item = (f64, &'a str)>) -> String {
    let mut times: Vec<(f64, &str)> = times.collect();
    times.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [(fast, first), others @ .., (slow, last)] = &times[..] else { return String::new() };
    let like: Vec<_> = others.iter().filter(|(time, _)| *time <= ALIKE * fast).collect();
    let named: String = like.iter().take(NAMED).map(|(_, word)| format!(" or *{word}*")).collect();
    let more = match like.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(" or {more} more"),
    };
    format!("fastest *{first}*{named}{more}, slowest *{last}*, {:.2} times as long", slow / fast)
}

/// Two things varied: the search by that of the base in the same race, the geometric mean over scenes.
pub(crate) fn cross(cross: &Cross, ratios: &[Vec<f64>]) {
    println!("| | {} |", cross.columns.join(" | "));
    println!("|---|{}", "--:|".repeat(cross.columns.len()));
    let mut cells = Vec::new();
    for ((word, _), row) in cross.rows.iter().zip(ratios) {
        let written: Vec<String> = row.iter().map(|ratio| format!("{ratio:.2}")).collect();
        println!("| {word} | {} |", written.join(" | "));
        for (column, ratio) in cross.columns.iter().zip(row) {
            cells.push((*ratio, format!("{word} with {column}")));
        }
    }
    let cells = cells.iter().map(|(ratio, word)| (*ratio, &word[..]));
    println!("\n- Of all: {}.", extremes(cells));
    for (at, column) in cross.columns.iter().enumerate() {
        let cells = cross.rows.iter().zip(ratios).map(|((word, _), row)| (row[at], &word[..]));
        println!("- {column}: {}.", extremes(cells));
    }
    println!();
}

/// Other methods in a race with the base, and how many points are inside.
pub(crate) fn beside(scenes: &[Scene], rows: &[(&str, Vec<f64>)]) {
    let names: Vec<&str> = scenes.iter().map(|scene| scene.path.name()).collect();
    println!("| | {} |", names.join(" | "));
    println!("|---|{}", "--:|".repeat(names.len()));
    for (name, times) in rows {
        let times: Vec<String> = times.iter().map(|time| format!("{time:.0}")).collect();
        println!("| {name}, ns | {} |", times.join(" | "));
    }
    let colliding = scenes.iter().map(|scene| number(scene.colliding));
    println!("| points inside | {} |", colliding.collect::<Vec<_>>().join(" | "));
    println!();
}

/// Three digits or so.
fn number(value: f64) -> String {
    let digits = if value < 9.95 { 1 } else { 0 };
    format!("{value:.digits$}")
}
