//! The blank in DIN/ISO programs of Heidenhain, whose corners are words of motions elsewhere: `G30 G17 X-50 Y-50 Z-20*`, the lowest one,
//! and `G31 G90 X+50 Y+50 Z+0*`.

use super::flow::before_semicolon;
use crate::gcode::GcodeFault;
use crate::gcode::error::not_read;
use std::iter;

/// A line of the blank.
#[derive(Debug, PartialEq)]
pub(super) struct BlankLine {
    /// 0 for the lowest corner, 1 for the highest one.
    pub(super) corner: usize,
    /// Its coordinates, in the unit of the program.
    pub(super) position: Option<[f64; 3]>,
    /// The modes in the line, which stay in force: `G17`, `G90`.
    pub(super) modes: String,
}

/// Returns the line of the blank in a text, if it is one.
///
/// # Errors
/// If it has other words than the blank needs.
pub(super) fn blank_line(text: &str) -> Option<Result<BlankLine, GcodeFault>> {
    let text = before_semicolon(text).trim().trim_end_matches('*');
    let mut words = words(text).peekable();
    words.next_if(|(letter, _)| *letter == 'N');
    let corner = match words.next()? {
        ('G', "30") => 0,
        ('G', "31") => 1,
        _ => return None,
    };
    let mut position = [None; 3];
    let mut modes = String::new();
    for (letter, number) in words {
        let axis = "XYZ".chars().position(|axis| axis == letter);
        match (axis, number.parse::<f64>()) {
            (Some(axis), Ok(value)) if value.is_finite() && position[axis].is_none() => {
                position[axis] = Some(value);
            }
            (None, _) if letter == 'G' && matches!(number, "17" | "90") => {
                modes += &format!("G{number} ");
            }
            _ => {
                let word = ["G30", "G31"][corner];
                let meaning = "a corner of the blank, with other words than G17, G90, X, Y and Z";
                let remedy = "write it with these alone, or remove the lines of the blank";
                return Some(Err(not_read(word, meaning, remedy)));
            }
        }
    }
    let [x, y, z] = position;
    let position = x.zip(y).zip(z).map(|((x, y), z)| [x, y, z]);
    Some(Ok(BlankLine { corner, position, modes }))
}

/// Returns the words of a line, each as its letter in capitals and the text up to the next one.
fn words(text: &str) -> impl Iterator<Item = (char, &str)> {
    let mut rest = text.trim_start_matches(|letter: char| !letter.is_alphabetic());
    iter::from_fn(move || {
        let letter = rest.chars().next()?;
        let after = &rest[letter.len_utf8()..];
        let end = after.find(char::is_alphabetic).unwrap_or(after.len());
        let (number, more) = after.split_at(end);
        rest = more;
        Some((letter.to_ascii_uppercase(), number.trim()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_the_blank_are_told_from_others() {
        let read = |text| blank_line(text).expect("a line of the blank").expect("a corner");
        let low =
            BlankLine { corner: 0, position: Some([-50.0, -5.5, -20.0]), modes: "G17 ".into() };
        assert_eq!(read("N10 G30 G17 X-50 Y-5.5 Z-20*"), low);
        assert_eq!(read("g30g17x-50y-5.5z-20 ; the blank"), low);
        let high = BlankLine { corner: 1, position: Some([50.0, 0.0, 1.0]), modes: "G90 ".into() };
        assert_eq!(read("G31 G90 X+50 Y+0 Z+1 *"), high);
        assert_eq!(read("G31 X1").position, None);
        for text in ["G30 G18 X0 Y0 Z0", "G31 G91 X1 Y1 Z1", "G31 X1 X2", "G31 X", "G30 X1 F9"] {
            let fault = blank_line(text).expect("a line of the blank").expect_err(text);
            assert!(fault.to_string().contains("a corner of the blank"), "{fault}");
        }
        for text in ["", "*", "N10", "G0 X1", "G30.1 X0", "N1 M30*", "; G30", "\u{e9}G30"] {
            assert_eq!(blank_line(text).map(|found| found.is_ok()), None, "{text}");
        }
    }
}
