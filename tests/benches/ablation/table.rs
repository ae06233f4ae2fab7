//! Rows as Markdown and as objects.

use crate::chapter::CHAPTERS;
use crate::line::Row;
use serde_json::json;

/// The lines of a chapter together, as they came: each of all scenes and clouds.
pub(crate) fn in_order(rows: &mut [Row]) {
    let mut skips: Vec<String> = Vec::new();
    for row in rows.iter() {
        if !skips.contains(&row.skip) {
            skips.push(row.skip.clone());
        }
    }
    rows.sort_by_key(|row| skips.iter().position(|skip| *skip == row.skip));
}

/// One object a row; its skip is named with the chapter's word.
pub(crate) fn json(chapters: &[Vec<Row>]) {
    for (chapter, rows) in CHAPTERS.iter().zip(chapters) {
        for Row { skip, scene, points, ns_with, ns_without, ratio } in rows {
            let skip = format!("{}: {skip}", chapter.word);
            let row = json!({
                "skip": skip, "scene": scene, "points": points,
                "ns_with": ns_with, "ns_without": ns_without, "ratio": ratio,
            });
            println!("{row}");
        }
    }
}

pub(crate) fn markdown(chapters: &[Vec<Row>], pinned: bool) {
    let pinned = if pinned { "pinned to one core" } else { "not pinned (the system refuses)" };
    println!(
        "# What the runtime skips, and what it would cost

```sh
cargo bench -p touchoff-tests --features peers --bench ablation > docs/measured/ablation.md
```

(`-- --json` for one object a row.) The tool of fig. 7.3 on the tube, the thread {pinned}. A line takes a query as it is, **with** a
skip, and one that does the same **without** it, made by public API alone; it says what was changed. Both are asked at the same
poses, 25 at a time in turns, so that what disturbs the machine hits both; no pose is asked again before all others were. Of each
block the fastest of five passes counts, and all blocks are summed: ns a query. **ratio** is without by with: below 1 the skip
costs more than it saves. Differences of some hundredths are the machine's. Before a line is timed both must give the same answers
at every pose: as many points, as deep, and the same force and torque to 1e-9."
    );
    for (chapter, rows) in CHAPTERS.iter().zip(chapters).filter(|(_, rows)| !rows.is_empty()) {
        println!("\n## {}\n\n{}\n", chapter.title, chapter.how);
        println!("| skip | scene | points | with ns | without ns | ratio |");
        println!("|---|---|--:|--:|--:|--:|");
        rows.iter().for_each(line);
    }
}

fn line(row: &Row) {
    let Row { skip, scene, points, ns_with, ns_without, ratio } = row;
    let [with, without] = [ns_with, ns_without].map(|ns| digits(*ns));
    println!("| {skip} | {scene} | {points} | {with} | {without} | {ratio:.2} |");
}

/// A decimal where it tells something.
fn digits(ns: f64) -> String {
    if ns < 100.0 { format!("{ns:.1}") } else { format!("{ns:.0}") }
}
