//! LinuxCNC tool tables (`.tbl`): a diameter and offsets, and no shape.
//!
//! A line has a tool number `T`, a pocket `P`, offsets, and a diameter `D`; `;` begins a comment. The table's lengths
//! are in the machine's unit, which it does not state. LinuxCNC skips a line that it cannot read, such as the heading
//! of tables before its version 2.4.

use super::{Found, MAX_TOOLS, Problem};

/// Reads the tools of a table. None has a shape.
///
/// # Errors
/// If no line can be read.
pub(super) fn read(text: &str) -> Result<Vec<Found>, String> {
    let mut found = Vec::new();
    let mut unreadable = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let (words, comment) = line.split_once(';').unwrap_or((line, ""));
        if words.trim().is_empty() {
            continue;
        }
        // The library is refused then.
        if found.len() > MAX_TOOLS {
            break;
        }
        let problem = match number(words) {
            Ok(number) => {
                let reason = "a tool table states a diameter and offsets, but neither a shape nor a length: write \
                    its `.tool` file";
                Problem::new(format!("T{number} {}", comment.trim()).trim(), reason)
            }
            Err(reason) => {
                let line = format!("line {}", index + 1);
                unreadable.push(format!("{line}: {reason}"));
                Problem::new(&line, &reason)
            }
        };
        found.push(Err(problem));
    }
    match unreadable.first() {
        // A file without a readable line is no tool table.
        Some(first) if unreadable.len() == found.len() => Err(first.clone()),
        _ => Ok(found),
    }
}

/// Returns the tool number of a line.
fn number(words: &str) -> Result<f64, String> {
    let mut number = None;
    for word in words.split_whitespace() {
        let mut letters = word.chars();
        let letter = letters.next().map(|letter| letter.to_ascii_uppercase());
        let value: Option<f64> = letters.as_str().parse().ok();
        match (letter, value) {
            (Some('T'), Some(value)) => number = Some(value),
            (Some('A'..='Z'), Some(_)) => {}
            _ => return Err(format!("`{word}` is no word of a tool table")),
        }
    }
    number.ok_or_else(|| "there is no tool number `T`".to_owned())
}
