//! Lines at which LinuxCNC stops with an error. The modes in force stay for its next program then.
//!
//! Each was run with its interpreter (`rs274`).

use super::flow::{Place, before_semicolon, line};
use super::line::{begins, code};
use crate::gcode::error::{combination, not_read};
use crate::gcode::{GcodeError, GcodeFault};

/// The longest line, in bytes without its end (`LINELEN` of the interpreter).
const MAX_LINE: usize = 251;

/// Refuses a line, whatever its words.
pub(super) fn check_line(text: &str) -> Result<(), GcodeFault> {
    let (word, meaning, remedy) = if text.len() > MAX_LINE {
        ("the line", "longer than the 251 bytes that LinuxCNC reads", "write two lines")
    } else if before_semicolon(text).trim_end().ends_with('*') {
        ("`*`", "an error on LinuxCNC", "remove it, or state another `dialect`")
    } else if text.split('(').skip(1).any(|comment| begins(comment, "abort,")) {
        ("(abort,", "a comment at which LinuxCNC stops", "remove it")
    } else if text.contains("98") || text.contains("99") {
        // Only such a line can have M98 or M99: others are not worth a copy.
        return check_spelling(&code(text)?);
    } else {
        return Ok(());
    };
    Err(not_read(word, meaning, remedy))
}

/// Refuses lines at which LinuxCNC stops also where it only seeks a subprogram after them.
pub(super) fn check_text(text: &str) -> Result<(), GcodeError> {
    let mut place = Place { offset: 0, line: 1 };
    while let Some((line, after)) = line(text, place) {
        let checked = check_line(line).and_then(|()| check_sought(line));
        checked.map_err(|fault| GcodeError { line: place.line, fault })?;
        place = after;
    }
    Ok(())
}

/// Refuses a line without a comment's end, and one with a label or the number of a call that may have no value: it is computed
/// also where the line is not executed.
fn check_sought(text: &str) -> Result<(), GcodeFault> {
    let code = code(text)?;
    let code = code.trim_start_matches('/');
    let label = code.trim_start_matches(|c: char| c == 'N' || c.is_ascii_digit() || c == '.');
    let (word, can_fail) = match code.split_once("M98") {
        Some((_, call)) => ("P of M98", can_fail(call)),
        None => {
            let is_computed = label.starts_with("O#") || label.starts_with("O[");
            ("the label after O", is_computed && can_fail(label))
        }
    };
    match can_fail {
        true => Err(combination(
            word,
            "it depends on a name, a quotient or a root, which LinuxCNC computes also where it passes the line",
            "write a number",
        )),
        false => Ok(()),
    }
}

/// Returns whether an expression may have no value. Numbered parameters always have one.
fn can_fail(text: &str) -> bool {
    text.contains("#<") || text.contains('/') || text.contains("SQRT")
}

/// Refuses M98 and M99 in another spelling, of which LinuxCNC reads three characters.
fn check_spelling(code: &str) -> Result<(), GcodeFault> {
    for text in code.split('M').skip(1) {
        let end = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
        let number = &text[..end];
        let is_call = number.parse().is_ok_and(|number: f64| number == 98.0 || number == 99.0);
        if is_call && number.len() > 2 {
            let word = format!("M{number}");
            let (meaning, remedy) = ("no word of LinuxCNC", "write M98 or M99");
            return Err(not_read(word, meaning, remedy));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_251_bytes_at_most() {
        let line = |blanks: usize| format!("X1{}Y1", " ".repeat(blanks));
        assert!(check_line(&line(247)).is_ok());
        assert!(check_line(&line(248)).is_err());
    }
}
