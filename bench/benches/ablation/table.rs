//! Rows as Markdown and as objects.

use crate::chapter::CHAPTERS;
use crate::line::Row;
use serde_json::json;

/// How wide text is.
const COLUMNS: usize = 130;

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
                "table": "ablation", "skip": skip, "scene": scene, "points": points,
                "ns_with": ns_with, "ns_without": ns_without, "ratio": ratio,
            });
            println!("{row}");
        }
    }
}

pub(crate) fn markdown(chapters: &[Vec<Row>], cores: usize, pinned: bool) {
    let pinned = if pinned { "pinned to one core" } else { "not pinned (the system refuses)" };
    println!(
        "# What the runtime skips, and what it would cost

```sh
cargo bench -p touchoff-bench --features peers --bench ablation > docs/measured/ablation.md
```

(`-- --json` for one object a row.) The tool of fig. 7.3 on the tube, one thread, {pinned}, of a machine of {cores} cores
that runs other programs too. A line takes a query as it is, **with** a skip, and one that does the same **without** it,
made by public API alone; it says what was changed. Both are asked at the same poses, 25 at a time in turns, so that what
disturbs the machine hits both; no pose is asked again before all others were. Of each block the fastest of five passes
counts, and all blocks are summed: ns a query. **ratio** is without by with: below 1 the skip costs more than it saves.
Some hundredths are the machine's, and times of different lines differ by more, since the machine was not the same a
second later: compare within a line. Where queries are slow, poses sit out, evenly. Before a line is timed both must give
the same answers at every pose: as many points, as deep, and the same force and torque to 1e-9."
    );
    for (chapter, rows) in CHAPTERS.iter().zip(chapters).filter(|(_, rows)| !rows.is_empty()) {
        println!("\n## {}\n\n{}\n", chapter.title, wrapped(chapter.how));
        println!("| skip | scene | points | with ns | without ns | ratio |");
        println!("|---|---|--:|--:|--:|--:|");
        rows.iter().for_each(line);
    }
}

/// A paragraph in lines.
fn wrapped(text: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.len() + 1 + word.len() <= COLUMNS => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines.join("\n")
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
