//! One line of text: an optional `/`, an optional `N` with a number, and words in any order. A word is a letter and a value.
//! Comments are `( … )` and `; …`. Case does not matter, and blanks may stand between words and between a letter and its value. A
//! character that belongs to none of these stops the interpreter.

use super::expression::{Cursor, Parameter, Parameters, assignment, begins_value, value};
use crate::gcode::block::{Block, Code, Keyword, Number};
use crate::gcode::error::not_read;
use crate::gcode::{ExpressionFault, GcodeFault, MAX_ASSIGNMENTS, unquoted};
use std::fmt;

/// Words of Heidenhain Klartext that begin a line or end one.
const KLARTEXT: [&str; 14] = [
    "BEGIN", "BLK", "CALL", "CC", "CYCL", "END", "FMAX", "FN", "FUNCTION", "LBL", "PGM", "PLANE",
    "TCPM", "TOOL",
];

/// Words that decide what is executed, of macro programs and of Sinumerik.
const DECISIONS: [&str; 14] = [
    "CASE", "DO", "ELSE", "ENDIF", "FOR", "GOTO", "GOTOB", "GOTOF", "IF", "LOOP", "REPEAT", "THEN",
    "UNTIL", "WHILE",
];

/// Removes `/`, which may be followed by the number of its switch, and a block number.
pub(super) fn begin(line: &str) -> Cursor<'_> {
    let mut cursor = Cursor::new(line);
    if cursor.take(b'/') {
        cursor.take_while(|byte| byte.is_ascii_digit());
    }
    let mut numbered = cursor;
    if numbered.take(b'N') || numbered.take(b'n') {
        numbered.peek();
        if !numbered.take_while(|byte| byte.is_ascii_digit() || byte == b'.').is_empty() {
            return numbered;
        }
    }
    cursor
}

/// A line of a program: its block, and the words around it.
#[derive(Clone, Debug, Default)]
pub(super) struct Line {
    pub(super) block: Block,
    pub(super) label: Option<OWord>,
    assignments: Vec<(Parameter, f64)>,
    /// Set if the line has an assignment.
    pub(super) assigns: bool,
    /// Set if the line has an assignment, and another value that is computed.
    pub(super) assigns_beside_value: bool,
}

impl Line {
    /// Reads a line. Assignments take effect on `parameters` at its end.
    pub(super) fn parse(
        &mut self,
        text: &str,
        parameters: &mut Parameters,
    ) -> Result<(), GcodeFault> {
        self.block.clear();
        self.label = None;
        self.assignments.clear();
        (self.assigns, self.assigns_beside_value) = (false, false);
        let mut cursor = begin(text);
        // The assignments whose value depends on a parameter: with another assignment in the block, it depends on the control
        // whether that is in force yet.
        let mut uses = 0;
        while let Some(byte) = next(&mut cursor)? {
            match byte {
                b'#' => {
                    let start = cursor.rest();
                    if self.assignments.len() == MAX_ASSIGNMENTS {
                        return Err(GcodeFault::Assignments);
                    }
                    self.assignments.push(assignment(&mut cursor, parameters)?);
                    let written = &start[1..start.len() - cursor.rest().len()];
                    uses += usize::from(written.contains('#'));
                }
                b'O' | b'o' if self.is_empty() => {
                    self.label = Some(o_word(&mut cursor, parameters)?);
                }
                _ if byte.is_ascii_alphabetic() => self.word(&mut cursor, parameters)?,
                b',' => {
                    let word: String =
                        cursor.rest().chars().take(2).flat_map(char::escape_debug).collect();
                    let meaning = "a rounded or chamfered corner";
                    return Err(not_read(word, meaning, "post the program with its motions"));
                }
                b'0'..=b'9' if self.is_empty() => return Err(numbered_line(cursor)),
                _ => return Err(unexpected(&cursor)),
            }
        }
        self.assigns = !self.assignments.is_empty();
        self.assigns_beside_value =
            self.assigns && self.block.is_computed() || uses > 0 && self.assignments.len() > 1;
        // All values of the block were computed with the parameters before it (RS274/NGC, section 3.3.3.4).
        for (parameter, value) in self.assignments.drain(..) {
            parameters.assign(parameter, value);
        }
        Ok(())
    }

    /// Returns whether the line has no word yet.
    pub(super) fn is_empty(&self) -> bool {
        self.block.is_empty() && self.label.is_none() && self.assignments.is_empty()
    }

    /// Reads a word that begins with a letter.
    fn word(&mut self, cursor: &mut Cursor, parameters: &Parameters) -> Result<(), GcodeFault> {
        let start = *cursor;
        let letter = char::from(start.rest().as_bytes()[0]).to_ascii_uppercase();
        cursor.advance();
        if !begins_value(cursor) {
            return self.name(start, cursor, letter);
        }
        let text = cursor.rest();
        let value = value(cursor, parameters)?;
        let written = &text[..text.len() - cursor.rest().len()];
        match letter {
            'G' | 'M' => self.code(letter, value, written),
            'E' | 'U' | 'V' | 'W' => Err(GcodeFault::Axis { word: letter }),
            'N' | 'O' => Err(GcodeFault::Unused { word: letter }),
            _ => {
                let is_computed = written.contains(['[', '#']);
                let is_whole = !is_computed && !written.contains('.');
                self.block.add(letter, Number { value, is_whole, is_computed })
            }
        }
    }

    fn code(&mut self, letter: char, value: f64, written: &str) -> Result<(), GcodeFault> {
        let tenths = (10.0 * value).round();
        let digits = written.trim();
        let is_literal = digits.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
        if !is_literal || (10.0 * value - tenths).abs() > 1e-9 || tenths > 99_999.0 {
            let expected = "a number with one decimal at most";
            return Err(GcodeFault::NotAllowed { word: letter, value, expected });
        }
        self.block.add_code(Code { letter, tenths: tenths as u32 })
    }

    /// Reads a letter without a value: a word of another dialect, or a mistake.
    fn name<'a>(
        &mut self,
        start: Cursor<'a>,
        cursor: &mut Cursor<'a>,
        letter: char,
    ) -> Result<(), GcodeFault> {
        let mut whole = start;
        let name = whole.take_while(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
        let upper = name.to_ascii_uppercase();
        let keyword = match upper.as_str() {
            "TRAORI" => Keyword::TransformationOn,
            "TRAFOOF" => Keyword::TransformationOff,
            _ if KLARTEXT.contains(&upper.as_str()) || is_klartext_line(start.rest()) => {
                return Err(GcodeFault::Klartext { word: upper });
            }
            _ if DECISIONS.contains(&upper.trim_end_matches(|c: char| c.is_ascii_digit())) => {
                return Err(GcodeFault::ControlFlow { word: upper });
            }
            _ if name.len() > 1 => {
                return Err(GcodeFault::UnknownWord { word: unquoted(name) });
            }
            _ => {
                cursor.peek();
                let function = cursor.take_while(|byte| byte.is_ascii_alphabetic());
                return match function.len() > 1 && cursor.take(b'[') {
                    true => {
                        let name = function.to_ascii_uppercase();
                        Err(ExpressionFault::Operation { name }.into())
                    }
                    false => Err(GcodeFault::NoNumber { word: letter }),
                };
            }
        };
        if self.block.keyword.replace(keyword).is_some() {
            // Both keywords begin with it.
            return Err(GcodeFault::Repeated { word: 'T' });
        }
        // Parameters of the transformation, and no comment: offsets of the axes, or another data set than the first.
        if whole.peek() == Some(b'(') {
            let parameters = whole.take_until(')').ok_or(GcodeFault::OpenComment)?;
            if !matches!(parameters[1..].trim(), "" | "1") {
                let word = unquoted(&format!("{upper}{parameters})"));
                return Err(GcodeFault::UnknownWord { word });
            }
        }
        *cursor = whole;
        Ok(())
    }
}

/// Passes over blanks and comments, and returns the next byte.
pub(super) fn next(cursor: &mut Cursor) -> Result<Option<u8>, GcodeFault> {
    loop {
        match cursor.peek() {
            Some(b'(') => {
                let comment = cursor.take_until(')').ok_or(GcodeFault::OpenComment)?;
                if comment[1..].contains('(') {
                    return Err(GcodeFault::OpenComment);
                }
                check_comment(&comment[1..])?;
            }
            Some(b';') => {
                check_comment(&cursor.rest()[1..])?;
                return Ok(None);
            }
            None => return Ok(None),
            // The end of a block in DIN/ISO programs of Heidenhain.
            Some(b'*') if cursor.rest()[1..].trim().is_empty() => return Ok(None),
            Some(byte) => return Ok(Some(byte)),
        }
    }
}

/// Returns whether a comment begins with a word, in either case.
pub(super) fn begins(comment: &str, word: &str) -> bool {
    let start = comment.trim_start().as_bytes().get(..word.len());
    start.is_some_and(|start| start.eq_ignore_ascii_case(word.as_bytes()))
}

/// Refuses a comment that LinuxCNC executes.
fn check_comment(comment: &str) -> Result<(), GcodeFault> {
    if begins(comment, "py,") || begins(comment, "pyrun,") {
        let meaning = "a comment whose Python LinuxCNC executes";
        let remedy = "remove it, or write a blank before the comma";
        return Err(not_read("py,", meaning, remedy));
    }
    Ok(())
}

/// Returns the fault of a character that begins no word.
fn unexpected(cursor: &Cursor) -> GcodeFault {
    let shown = cursor.rest().chars().take(1).flat_map(char::escape_debug).collect::<String>();
    GcodeFault::Character { shown: format!("`{shown}`") }
}

/// Returns the fault of a line that begins with a number, as those of Heidenhain Klartext do.
fn numbered_line(mut cursor: Cursor) -> GcodeFault {
    let start = cursor;
    cursor.take_while(|byte| byte.is_ascii_digit());
    cursor.peek();
    let line = cursor;
    let word = cursor.take_while(|byte| byte.is_ascii_alphabetic()).to_ascii_uppercase();
    match KLARTEXT.contains(&word.as_str()) || is_klartext_line(line.rest()) {
        true => GcodeFault::Klartext { word },
        false => unexpected(&start),
    }
}

/// Returns whether a line is a motion of Heidenhain Klartext: `L X+10 FMAX`, `C X+5 DR+`.
fn is_klartext_line(line: &str) -> bool {
    let mut words = line.split_ascii_whitespace();
    matches!(words.next(), Some("L" | "C" | "CR" | "CT" | "LP" | "LN"))
        && words
            .next()
            .is_some_and(|word| word.starts_with(['X', 'Y', 'Z', 'A', 'B', 'C', 'I', 'P']))
}

/// The label of a program or a subprogram.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Label {
    Number(u32),
    /// A name in small letters without blanks, as names are compared.
    Name(String),
}

impl fmt::Display for Label {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Label::Number(number) => write!(f, "O{number}"),
            Label::Name(name) => write!(f, "O<{name}>"),
        }
    }
}

/// The word after a label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// None: a program or subprogram of ISO 6983, which M30 or M99 ends.
    Title,
    /// `sub`: a subprogram of O-words, which `endsub` ends.
    Sub,
    EndSub,
    Call,
}

/// An O-word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct OWord {
    pub(super) label: Label,
    pub(super) role: Role,
}

/// Reads an O-word. The label can be an expression.
pub(super) fn o_word(cursor: &mut Cursor, parameters: &Parameters) -> Result<OWord, GcodeFault> {
    cursor.advance();
    let label = match cursor.take(b'<') {
        true => {
            let name = cursor.take_until('>').ok_or(ExpressionFault::OpenName)?;
            let name: String = name.chars().filter(|c| !c.is_whitespace()).collect();
            Label::Name(name.to_lowercase())
        }
        false => match value(cursor, parameters)? {
            number if number.fract() == 0.0 && (0.0..=1e8).contains(&number) => {
                Label::Number(number as u32)
            }
            value => {
                let expected = "a whole number from 0";
                return Err(GcodeFault::NotAllowed { word: 'O', value, expected });
            }
        },
    };
    next(cursor)?;
    let word = cursor.take_while(|byte| byte.is_ascii_alphabetic());
    let role = match word.to_ascii_lowercase().as_str() {
        "" => Role::Title,
        "sub" => Role::Sub,
        "endsub" => Role::EndSub,
        "call" => Role::Call,
        _ => return Err(GcodeFault::ControlFlow { word: unquoted(word) }),
    };
    match next(cursor)? {
        None => Ok(OWord { label, role }),
        Some(b'[') if role != Role::Title => {
            let remedy = "assign parameters from #31 on before the call instead";
            let meaning = "a word with arguments";
            Err(not_read(word.to_ascii_lowercase(), meaning, remedy))
        }
        Some(_) => Err(unexpected(cursor)),
    }
}
