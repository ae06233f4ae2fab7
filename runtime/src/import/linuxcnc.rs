//! LinuxCNC tool tables (`.tbl`): a diameter and offsets, and no shape.
//!
//! A line has a tool number `T`, a pocket `P`, offsets, and a diameter `D`; `;` begins a comment. The table's lengths
//! are in the machine's unit, which it does not state.

use super::{Found, Problem};

/// Reads the tools of a table. None has a shape.
pub(super) fn read(text: &str) -> Result<Vec<Found>, String> {
    let mut found = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let (words, comment) = line.split_once(';').unwrap_or((line, ""));
        if words.trim().is_empty() {
            continue;
        }
        let mut number = None;
        for word in words.split_whitespace() {
            let mut letters = word.chars();
            let letter = letters.next().map(|letter| letter.to_ascii_uppercase());
            let value: Option<f64> = letters.as_str().parse().ok();
            match (letter, value) {
                (Some('T'), Some(value)) => number = Some(value),
                (Some('A'..='Z'), Some(_)) => {}
                _ => {
                    return Err(format!("line {}: `{word}` is no word of a tool table", index + 1));
                }
            }
        }
        let Some(number) = number else {
            return Err(format!("line {}: there is no tool number `T`", index + 1));
        };
        let comment = comment.trim();
        let name =
            if comment.is_empty() { format!("T{number}") } else { format!("T{number} {comment}") };
        found.push(Err(Problem::new(
            &name,
            "a tool table states a diameter and offsets, but neither a shape nor a length: write its `.tool` file",
        )));
    }
    Ok(found)
}
