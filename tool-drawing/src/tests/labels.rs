//! Labels lie on the sheet and do not overlap.

use super::{folder, library};
use crate::lettering::width;
use crate::{Content, TextRendering, svg};
use touchoff_plane::Point;

/// The height of capitals at scale 1.
const CAPITAL_HEIGHT: f64 = 14.0;

struct Label {
    text: String,
    low: Point,
    high: Point,
}

/// Returns the text after `begin` and before `end`.
fn between<'t>(text: &'t str, begin: &str, end: char) -> Option<&'t str> {
    let (_, rest) = text.split_once(begin)?;
    Some(rest.split(end).next().unwrap_or(rest))
}

fn numbers(text: &str) -> Vec<f64> {
    text.split(' ').map(|number| number.parse().expect("a number")).collect()
}

fn point(text: &str) -> Point {
    let [x, y] = numbers(text)[..] else { panic!("{text} is not a point") };
    [x, y]
}

/// Returns all labels of a drawing in the coordinates of the sheet.
fn labels(drawing: &str) -> Vec<Label> {
    let mut offsets = vec![[0.0, 0.0]];
    let mut labels = Vec::new();
    for tag in drawing.split('<') {
        let [dx, dy] = offsets.last().copied().expect("as many groups end as begin");
        let [x, y] = between(tag, "translate(", ')').map_or([0.0, 0.0], point);
        let at = [x + dx, y + dy];
        if tag.starts_with("/g>") {
            offsets.pop();
        } else if tag.starts_with("g ") {
            offsets.push(at);
        } else if let Some(text) = between(tag, "aria-label=\"", '"') {
            let text = text.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&");
            let scale = between(tag, "scale(", ')').map_or(0.0, |scale| numbers(scale)[0]);
            let size = CAPITAL_HEIGHT * scale;
            let low = [at[0], at[1] - size];
            labels.push(Label { low, high: [at[0] + width(&text, size), at[1]], text });
        }
    }
    labels
}

#[test]
fn labels_lie_on_the_sheet_apart_from_each_other() {
    let files = std::fs::read_dir(folder()).expect("the library's folder");
    let mut names: Vec<String> = files
        .map(|file| file.expect("a file").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "tool"))
        .filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned()))
        .collect();
    names.sort();
    assert!(names.len() > 30, "{names:?}");
    for name in names {
        let tool = library(&name);
        for content in [Content::Outline, Content::Regions] {
            let drawing = svg(&tool, content, TextRendering::Strokes);
            let frame = numbers(between(&drawing, "viewBox=\"", '"').expect("a frame"));
            let labels = labels(&drawing);
            for (k, label) in labels.iter().enumerate() {
                let Label { text, low, high } = label;
                for axis in 0..2 {
                    let end = frame[axis] + frame[axis + 2];
                    let inside = low[axis] > frame[axis] && high[axis] < end;
                    assert!(inside, "{name}: {text} leaves the sheet: {low:?} to {high:?}");
                }
                for other in &labels[..k] {
                    let apart = (0..2)
                        .any(|axis| low[axis] > other.high[axis] || high[axis] < other.low[axis]);
                    assert!(apart, "{name}, {content:?}: {text} overlaps {}", other.text);
                }
            }
        }
    }
}
