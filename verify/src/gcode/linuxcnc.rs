//! Lines and words at which LinuxCNC stops with an error. The modes in force stay for its next program then.
//!
//! Each was run with its interpreter (`rs274`). M428 and M429 of its configurations for five axes are read.

use super::block::{Block, Code, Group, begins};
use super::error::{combination, missing, not_read, same_group};
use super::flow::{Place, before_semicolon, line};
use super::{GcodeError, GcodeFault};

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

/// Returns a line in capitals without blanks and comments.
fn code(text: &str) -> Result<String, GcodeFault> {
    let mut code = String::new();
    let mut is_comment = false;
    for c in text.chars() {
        match c {
            '(' if is_comment => return Err(GcodeFault::OpenComment),
            '(' | ')' => is_comment = c == '(',
            ';' if !is_comment => return Ok(code),
            c if !is_comment && !c.is_whitespace() => code.push(c.to_ascii_uppercase()),
            _ => {}
        }
    }
    if is_comment { Err(GcodeFault::OpenComment) } else { Ok(code) }
}

/// Refuses the words of a block that are known elsewhere.
pub(super) fn check_words(block: &Block) -> Result<(), GcodeFault> {
    if let Some(code) = block.codes().find(is_unknown) {
        let (meaning, remedy) = ("no word of LinuxCNC", "remove it, or state another `dialect`");
        return Err(not_read(code, meaning, remedy));
    }
    for code in block.codes() {
        let (is_missing, needed) = match (code.letter, code.tenths) {
            ('M', 620..=650) => (!block.has('P'), "P with the number of an output"),
            ('M', 670 | 680) => (!block.has('E'), "E with the number of an output"),
            ('G', 960) => (!block.has('S'), "S with a speed"),
            ('G', 40) => (!block.has('P'), "P with a time"),
            ('G', 20 | 30) => (!block.has_any("XYZABCIJKR"), "its end, its centre or its radius"),
            ('G', 820 | 860 | 890) => (!block.has('P'), "P with the time of its dwell"),
            _ => continue,
        };
        if is_missing {
            return Err(missing(code, needed));
        }
    }
    // -1 stands for a word that is not there.
    if let Some(value) = block.value('P').filter(|value| *value < 0.0) {
        return Err(GcodeFault::NotAllowed { word: 'P', value, expected: "a number from 0" });
    }
    if block.has('D') && block.tenths_of(Group::CutterCompensation).is_none_or(|code| code == 400) {
        return Err(GcodeFault::Unused { word: 'D' });
    }
    let motion = block.code_of(Group::Motion);
    if let Some((code, motion)) =
        block.code_of(Group::OneShot).filter(|code| matches!(code.tenths, 280 | 300)).zip(motion)
    {
        return Err(same_group(code, motion));
    }
    for (index, code) in block.codes().enumerate() {
        let Some(group) = m_group(code) else { continue };
        let mut others = block.codes().skip(index + 1);
        if let Some(other) = others.find(|other| m_group(*other) == Some(group)) {
            return Err(same_group(code, other));
        }
    }
    Ok(())
}

/// Refuses the words of a canned cycle that it does not take.
pub(super) fn check_cycle(block: &Block, number: u32) -> Result<(), GcodeFault> {
    let unused = match number {
        73 | 83 => "KP",
        81 | 85 => "KPQ",
        // `check_items` of LinuxCNC lets G73, G76 and G81 to G89 repeat.
        74 => "KLQ",
        _ => "KQ",
    };
    if let Some(word) = unused.chars().find(|letter| block.has(*letter)) {
        return Err(GcodeFault::Unused { word });
    }
    match block.value('L') {
        Some(value) if value < 1.0 => {
            let expected = "a number of repeats from 1";
            Err(GcodeFault::NotAllowed { word: 'L', value, expected })
        }
        _ => Ok(()),
    }
}

/// Returns whether a word is read for other controls only.
fn is_unknown(code: &Code) -> bool {
    match code.letter {
        'G' => matches!(
            code.tenths,
            50 | 51 | 80 | 90 | 150 | 230 | 434 | 435 | 500 | 501 | 531 | 541 | 670 | 680
                ..=690 | 1030 | 1870 | 2340
        ),
        _ => matches!(
            code.tenths,
            100 | 110 | 120 | 290 | 310 | 330 | 410..=440 | 830 | 840 | 880 | 890
        ),
    }
}

/// Returns the modal group of an M word that neither moves, nor stops, nor turns the spindle (RS274/NGC, table 4).
fn m_group(code: Code) -> Option<u32> {
    match (code.letter, code.tenths) {
        ('M', 620..=680) => Some(5),
        ('M', 70 | 80 | 90) => Some(8),
        ('M', 480..=530) => Some(9),
        _ => None,
    }
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
