//! One line of text: an optional `/`, an optional `N` with a number, and words in any order. A word is a letter and a value.
//! Comments are `( … )` and `; …`. Case does not matter, and blanks may stand between words and between a letter and its value. A
//! character that belongs to none of these stops the interpreter.

use super::expression::{
    ExpressionFault, Language, Rounding, Value, begins_value, condition, value,
};
use super::flow::before_semicolon;
use super::is_heidenhain;
use super::variables::{Parameter, Scope, assignment};
use crate::gcode::block::{Block, Code, Group, Keyword, Number};
use crate::gcode::control::{Corner, CornerShape};
use crate::gcode::cursor::Cursor;
use crate::gcode::error::{combination, missing, not_read};
use crate::gcode::rules::{Choice, Rule};
use crate::gcode::{GcodeFault, LARGEST_NUMBER, MAX_ASSIGNMENTS, klartext, unquoted};
use std::collections::BTreeMap;
use std::fmt;

/// Words of Heidenhain Klartext that begin a line or end one.
const KLARTEXT: [&str; 14] = [
    "BEGIN", "BLK", "CALL", "CC", "CYCL", "END", "FMAX", "FN", "FUNCTION", "LBL", "PGM", "PLANE",
    "TCPM", "TOOL",
];

/// Statements of Sinumerik that decide what is executed.
const DECISIONS: [&str; 10] =
    ["CASE", "ELSE", "ENDIF", "FOR", "GOTOB", "GOTOF", "LOOP", "REPEAT", "THEN", "UNTIL"];

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
    pub(super) statement: Option<Statement>,
    pub(super) call: Option<MacroCall>,
    /// The file that M98 or M198 names: `M98 <NAME>`, or `M98 (NAME.NC)` of Haas.
    pub(super) file: Option<String>,
    pub(super) assignments: Vec<(Parameter, Value)>,
    /// Set if the line has an assignment.
    pub(super) assigns: bool,
    /// Words that the setup ignores.
    pub(super) ignored: Vec<String>,
    /// Set if the line has such a word, to which letters of the line can belong.
    pub(super) ignores: bool,
    /// Set if the line has an assignment, and another value that is computed.
    pub(super) assigns_beside_value: bool,
    /// Set if its execution has led elsewhere than to what follows: by a decision, a call, or a motion under G66.
    pub(super) has_branched: bool,
}

/// A statement of a macro of Fanuc that decides which line is next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Statement {
    /// `GOTO`, also after an `IF` that holds.
    GoTo(u32),
    /// `WHILE … DO m`, with its condition, or `DO m`.
    Do { holds: bool },
    /// `END m`.
    End,
    /// `IF` with a condition that does not hold.
    Nothing,
    /// A line to a printer or a file: `POPEN`, `DPRNT[…]`, `BPRNT[…]` and `PCLOS`.
    Print(&'static str),
}

/// A call of a macro: G65, or G66 for all motions that follow.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MacroCall {
    pub(super) is_modal: bool,
    pub(super) program: u32,
    pub(super) repeats: u32,
    pub(super) arguments: BTreeMap<u32, Value>,
}

impl Line {
    /// Reads a line, with its variables and conditions.
    pub(super) fn parse(&mut self, text: &str, scope: &Scope) -> Result<(), GcodeFault> {
        self.clear();
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
                    self.assignments.push(assignment(&mut cursor, scope)?);
                    let written = &start[1..start.len() - cursor.rest().len()];
                    uses += usize::from(written.contains('#'));
                }
                _ if byte.is_ascii_alphabetic() => self.word(&mut cursor, scope)?,
                b',' => self.corner(&mut cursor, scope)?,
                b'/' => return Err(ExpressionFault::Slash.into()),
                b'0'..=b'9' if self.is_empty() => return Err(numbered_line(cursor)),
                _ => return Err(unexpected(&cursor)),
            }
        }
        self.assigns = !self.assignments.is_empty();
        self.ignores = !self.ignored.is_empty();
        self.assigns_beside_value =
            self.assigns && self.block.is_computed() || uses > 0 && self.assignments.len() > 1;
        Ok(())
    }

    fn clear(&mut self) {
        self.block.clear();
        (self.statement, self.call, self.file) = (None, None, None);
        self.assignments.clear();
        self.ignored.clear();
        (self.assigns, self.assigns_beside_value, self.ignores) = (false, false, false);
        self.has_branched = false;
    }

    /// Returns whether the line has no word yet.
    pub(super) fn is_empty(&self) -> bool {
        self.block.is_empty()
            && self.statement.is_none()
            && self.call.is_none()
            && self.assignments.is_empty()
    }

    /// Returns whether the block has G187 of Haas, of which E is the tolerance.
    fn is_smoothness(&self) -> bool {
        self.block.code_of(Group::PathControl).is_some_and(|code| code.tenths == 1870)
    }

    /// Reads a word that begins with a letter.
    fn word(&mut self, cursor: &mut Cursor, scope: &Scope) -> Result<(), GcodeFault> {
        let start = *cursor;
        let letter = char::from(start.rest().as_bytes()[0]).to_ascii_uppercase();
        cursor.advance();
        if !begins_value(cursor) {
            return self.name(start, cursor, letter, scope);
        }
        let text = cursor.rest();
        let rounding = match letter {
            'A' | 'B' | 'C' => Rounding::Increment(1e-3),
            'X' | 'Y' | 'Z' | 'I' | 'J' | 'K' | 'R' | 'Q' | 'F' => {
                Rounding::Increment(scope.control.modal.increment())
            }
            _ => Rounding::Whole,
        };
        let value = value(cursor, scope, rounding)?;
        let written = &text[..text.len() - cursor.rest().len()];
        // A word with a vacant variable is as if it were not written (Fanuc).
        let Some(value) = value else { return Ok(()) };
        // M67 and M68 take it.
        let is_linuxcnc = scope.control.stated(Rule::Dialect) == Some(Choice::Rs274Ngc);
        match letter {
            'G' | 'M' => self.code(letter, value, written, cursor, scope),
            // An argument of an ignored word.
            'E' if !self.ignored.is_empty() => Ok(()),
            'E' if !self.is_smoothness() && !is_linuxcnc => Err(GcodeFault::Axis { word: letter }),
            'U' | 'V' | 'W' => Err(GcodeFault::Axis { word: letter }),
            'N' | 'O' => Err(GcodeFault::Unused { word: letter }),
            _ if value.abs() > LARGEST_NUMBER => Err(GcodeFault::TooLarge { word: letter }),
            _ => {
                let is_computed = written.contains(['[', '#']);
                let is_whole = !is_computed && !written.contains('.');
                self.block.add(letter, Number { value, is_whole, is_computed })
            }
        }
    }

    /// Reads `,R` or `,C` with its length.
    fn corner(&mut self, cursor: &mut Cursor, scope: &Scope) -> Result<(), GcodeFault> {
        let word: String = cursor.rest().chars().take(2).flat_map(char::escape_debug).collect();
        let is_known = matches!(
            scope.control.stated(Rule::Dialect),
            None | Some(Choice::Iso | Choice::Sinumerik)
        );
        let letter = word.chars().nth(1).filter(|_| is_known).map(|c| c.to_ascii_uppercase());
        let Some(letter @ ('R' | 'C')) = letter else {
            let meaning = "an angle, or a corner on other controls";
            return Err(not_read(word, meaning, "post the program with its motions"));
        };
        cursor.advance();
        cursor.advance();
        if !begins_value(cursor) {
            return Err(GcodeFault::NoNumber { word: letter });
        }
        let start = *cursor;
        let rounding = Rounding::Increment(scope.control.modal.increment());
        let Some(length) = value(cursor, scope, rounding)? else { return Ok(()) };
        if length.abs() > LARGEST_NUMBER {
            return Err(GcodeFault::TooLarge { word: letter });
        }
        let is_whole = !start.text_to(cursor).contains(['.', '[', '#']);
        let (word, shape) = match letter {
            'R' => (",R", CornerShape::Round),
            _ => (",C", CornerShape::Chamfer),
        };
        let corner = Corner { word, shape, length, is_whole };
        match self.block.corner.replace(corner) {
            None => Ok(()),
            Some(_) => Err(GcodeFault::Repeated { word: letter }),
        }
    }

    fn code(
        &mut self,
        letter: char,
        value: f64,
        written: &str,
        cursor: &mut Cursor,
        scope: &Scope,
    ) -> Result<(), GcodeFault> {
        let tenths = (10.0 * value).round();
        let is_literal = !written.contains(['+', '-']);
        let is_number = (10.0 * value - tenths).abs() <= 1e-9 && (0.0..=99_999.0).contains(&tenths);
        if !is_literal || !is_number {
            let expected = "a number with one decimal at most";
            return Err(GcodeFault::NotAllowed { word: letter, value, expected });
        }
        let code = Code { letter, tenths: tenths as u32 };
        let word = code.to_string();
        if scope.control.ignores(&word) {
            if is_heidenhain(scope.control) && klartext::has_effect(&word) {
                let meaning = "a word of Heidenhain that moves the tool or its coordinates, whatever the job ignores";
                return Err(not_read(code, meaning, "post the program without it"));
            }
            self.ignored.push(code.to_string());
            return Ok(());
        }
        match (letter, code.tenths) {
            ('G', 650 | 660) if scope.language == Some(Language::Fanuc) => {
                if !self.is_empty() {
                    let condition = "other words stand before it";
                    return Err(combination(code, condition, "write them in a block before"));
                }
                self.call = Some(macro_call(code, cursor, scope)?);
                Ok(())
            }
            ('M', 980 | 1980) if scope.language != Some(Language::LinuxCnc) => {
                self.file = file_name(cursor)?;
                self.block.add_code(code)
            }
            _ => self.block.add_code(code),
        }
    }

    /// Reads a letter without a value: a statement, a word of another dialect, or a mistake.
    fn name<'a>(
        &mut self,
        start: Cursor<'a>,
        cursor: &mut Cursor<'a>,
        letter: char,
        scope: &Scope,
    ) -> Result<(), GcodeFault> {
        let mut whole = start;
        if let Some(word) = statement(&mut whole) {
            *cursor = whole;
            return self.decision(word, cursor, scope);
        }
        let name = whole.take_while(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
        let upper = name.to_ascii_uppercase();
        if scope.control.ignores(&upper) {
            // Its arguments.
            if whole.peek() == Some(b'(') {
                whole.take_until(')').ok_or(GcodeFault::OpenComment)?;
            }
            self.ignored.push(upper);
            *cursor = whole;
            return Ok(());
        }
        if let Some(word) = ["POPEN", "DPRNT", "BPRNT", "PCLOS"].into_iter().find(|w| *w == upper)
            && scope.language == Some(Language::Fanuc)
        {
            *cursor = whole;
            return self.print(word, cursor);
        }
        let keyword = match upper.as_str() {
            "TRAORI" => Keyword::TransformationOn,
            "TRAFOOF" => Keyword::TransformationOff,
            _ if KLARTEXT.contains(&upper.as_str()) || is_klartext_line(start.rest()) => {
                return Err(GcodeFault::Klartext { word: upper });
            }
            _ if DECISIONS.contains(&upper.trim_end_matches(|c: char| c.is_ascii_digit())) => {
                return Err(GcodeFault::ControlFlow { word: upper });
            }
            _ if upper.starts_with("CUT3D") => {
                let meaning = "three-dimensional cutter compensation of Sinumerik";
                return Err(not_read(upper, meaning, "post the program with the path of the tool"));
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

    /// Reads a line to a printer, whose words are not those of a block.
    fn print(&mut self, word: &'static str, cursor: &mut Cursor) -> Result<(), GcodeFault> {
        if !self.is_empty() {
            let condition = "other words stand before it";
            return Err(combination(word, condition, "write it on a line of its own"));
        }
        if word.ends_with("PRNT") {
            let text = before_semicolon(cursor.rest());
            let end = text.rfind(']').filter(|_| text.trim_start().starts_with('['));
            let end = end.ok_or_else(|| missing(word, "its text in brackets"))?;
            *cursor = Cursor::new(&cursor.rest()[end + 1..]);
        }
        self.statement = Some(Statement::Print(word));
        check_end(cursor)
    }

    /// Reads what follows the first word of a statement.
    fn decision(
        &mut self,
        word: &'static str,
        cursor: &mut Cursor,
        scope: &Scope,
    ) -> Result<(), GcodeFault> {
        if scope.language == Some(Language::LinuxCnc) {
            let meaning = "a statement of macros of Fanuc and Haas";
            let remedy = "write an O-word, or state another `dialect`";
            return Err(not_read(word, meaning, remedy));
        }
        if !self.is_empty() {
            let condition = "other words stand before it";
            return Err(combination(word, condition, "write it on a line of its own"));
        }
        let statement = match word {
            "GOTO" => Statement::GoTo(sequence_number(cursor, scope)?),
            "IF" => {
                let holds = condition(cursor, scope)?;
                let is_jump = cursor.take_text("GOTO");
                if !is_jump && !cursor.take_text("THEN") {
                    let needed = "GOTO or THEN after its condition";
                    return Err(missing("IF", needed));
                }
                match (holds, is_jump) {
                    (false, _) => {
                        // The rest of the line is not executed, and its variables may have no value.
                        *cursor = Cursor::new("");
                        Statement::Nothing
                    }
                    (true, true) => Statement::GoTo(sequence_number(cursor, scope)?),
                    // The assignments of the line follow.
                    (true, false) => {
                        if next(cursor)? != Some(b'#') {
                            let needed = "an assignment `#1 = …` after THEN";
                            return Err(missing("IF", needed));
                        }
                        return Ok(());
                    }
                }
            }
            "WHILE" => {
                let holds = condition(cursor, scope)?;
                if !cursor.take_text("DO") {
                    return Err(missing("WHILE", "DO with a number after its condition"));
                }
                loop_number(cursor, "DO")?;
                Statement::Do { holds }
            }
            "DO" => {
                loop_number(cursor, "DO")?;
                Statement::Do { holds: true }
            }
            _ => {
                loop_number(cursor, "END")?;
                Statement::End
            }
        };
        if next(cursor)?.is_some() {
            let condition = "other words stand after it";
            return Err(combination(word, condition, "write them on a line of their own"));
        }
        self.statement = Some(statement);
        Ok(())
    }
}

/// Returns the name of a file after M98: in angle brackets, which are passed over, or in parentheses, which are a comment where P stands beside
/// them.
fn file_name(cursor: &mut Cursor) -> Result<Option<String>, GcodeFault> {
    let name = match cursor.peek() {
        Some(b'<') => {
            cursor.advance();
            cursor.take_until('>').ok_or(ExpressionFault::OpenName)?
        }
        Some(b'(') => &{ *cursor }.take_until(')').ok_or(GcodeFault::OpenComment)?[1..],
        _ => return Ok(None),
    };
    Ok(Some(name.trim().to_owned()))
}

/// Passes over the first word of a statement of a macro of Fanuc, and returns it.
pub(super) fn statement(cursor: &mut Cursor) -> Option<&'static str> {
    let start = *cursor;
    let word =
        ["GOTO", "IF", "WHILE", "DO", "END"].into_iter().find(|word| cursor.take_text(word))?;
    // `GOTOF` and `ENDIF` are Sinumerik's.
    let goes_on = cursor.rest().as_bytes().first().is_some_and(u8::is_ascii_alphabetic);
    if goes_on {
        *cursor = start;
    }
    (!goes_on).then_some(word)
}

/// Reads the number of a loop after DO or END, from 1 to 3.
pub(super) fn loop_number(cursor: &mut Cursor, word: &str) -> Result<u32, GcodeFault> {
    cursor.peek();
    let digits = cursor.take_while(|byte| byte.is_ascii_digit());
    match digits.parse() {
        Ok(number @ 1..=3) => Ok(number),
        _ => {
            let shown = format!("{word}{digits}");
            let expected = "DO and END with a number from 1 to 3";
            Err(GcodeFault::Sentence { shown, expected })
        }
    }
}

/// Reads the sequence number after GOTO, which can be computed.
fn sequence_number(cursor: &mut Cursor, scope: &Scope) -> Result<u32, GcodeFault> {
    let value = value(cursor, scope, Rounding::Whole)?.unwrap_or(0.0);
    match value.fract() == 0.0 && (1.0..=99_999_999.0).contains(&value) {
        true => Ok(value as u32),
        false => {
            let expected = "GOTO with a sequence number from 1";
            Err(GcodeFault::NotAllowed { word: 'N', value, expected })
        }
    }
}

/// Returns the local variable of an argument letter (type I), other than I, J and K.
fn local_of(letter: char) -> Option<u32> {
    Some(match letter {
        'A' => 1,
        'B' => 2,
        'C' => 3,
        'D' => 7,
        'E' => 8,
        'F' => 9,
        'H' => 11,
        'M' => 13,
        'Q' => 17,
        'R' => 18,
        'S' => 19,
        'T' => 20,
        'U' => 21,
        'V' => 22,
        'W' => 23,
        'X' => 24,
        'Y' => 25,
        'Z' => 26,
        _ => return None,
    })
}

/// Reads the words after G65 or G66: P with the program, L with the repeats, and the arguments.
///
/// I, J and K that repeat, or that are not in this order, are those of type II: I1 J1 K1 to I10 J10 K10 are #4 to #33. Of two
/// arguments for one variable the later counts.
fn macro_call(code: Code, cursor: &mut Cursor, scope: &Scope) -> Result<MacroCall, GcodeFault> {
    let (mut program, mut repeats) = (None, 1);
    let mut arguments = BTreeMap::new();
    // The next variable of I, J or K.
    let mut next_of_type_ii = 4;
    while let Some(byte) = next(cursor)? {
        if !byte.is_ascii_alphabetic() {
            return Err(unexpected(cursor));
        }
        let letter = char::from(byte).to_ascii_uppercase();
        cursor.advance();
        if !begins_value(cursor) {
            return Err(GcodeFault::NoNumber { word: letter });
        }
        let start = *cursor;
        let value = value(cursor, scope, Rounding::Argument)?;
        let written = start.text_to(cursor);
        let is_whole = !written.contains(['.', '[', '#']);
        let whole = |least: f64, expected: &'static str| {
            let value = value.unwrap_or(0.0);
            match value.fract() == 0.0 && (least..=99_999_999.0).contains(&value) {
                true => Ok(value as u32),
                false => Err(GcodeFault::NotAllowed { word: letter, value, expected }),
            }
        };
        let number = match letter {
            'P' => {
                program = Some(whole(0.0, "the number of a program after P")?);
                continue;
            }
            'L' => {
                repeats = whole(1.0, "a number of repeats from 1 after L")?;
                continue;
            }
            'I' | 'J' | 'K' => {
                let offset = u32::from(byte.to_ascii_uppercase() - b'I');
                let number = next_of_type_ii + (offset + 3 - (next_of_type_ii - 4) % 3) % 3;
                next_of_type_ii = number + 1;
                number
            }
            letter => local_of(letter)
                .ok_or(GcodeFault::NotAnArgument { word: letter, call: code.to_string() })?,
        };
        if number > 33 {
            return Err(GcodeFault::Repeated { word: letter });
        }
        // Fanuc counts such a number in the least increment of its letter, which depends on the machine.
        let is_length = !"DEFHMST".contains(letter);
        if is_whole
            && is_length
            && value.is_some_and(|value| value != 0.0)
            && scope.control.stated(Rule::WholeNumbers) != Some(Choice::Units)
        {
            let condition = "its number has no decimal point";
            let remedy = "write one: controls count such an argument in increments or in units";
            return Err(combination(format!("{letter} of {code}"), condition, remedy));
        }
        arguments.insert(number, value);
    }
    let program = program.ok_or_else(|| missing(code, "P with the number of a program"))?;
    Ok(MacroCall { is_modal: code.tenths == 660, program, repeats, arguments })
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

/// Returns a line in capitals without blanks and comments.
pub(super) fn code(text: &str) -> Result<String, GcodeFault> {
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

impl Label {
    /// Returns the label of a title in angle brackets.
    pub(super) fn of_title(name: &str) -> Label {
        let name: String = name.chars().filter(|c| !c.is_whitespace()).collect();
        Label::Name(name.to_lowercase())
    }

    /// Returns the label that the name of a file stands for, without its ending.
    pub(super) fn of_file(stem: &str) -> Label {
        let stem: String = stem.chars().filter(|c| !c.is_whitespace()).collect();
        let stem = stem.to_lowercase();
        let digits = stem.strip_prefix('o').unwrap_or(&stem);
        match digits.parse() {
            Ok(number) => Label::Number(number),
            Err(_) => Label::Name(stem),
        }
    }
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
    Return,
    If,
    ElseIf,
    Else,
    EndIf,
    Do,
    While,
    EndWhile,
    Repeat,
    EndRepeat,
    Break,
    Continue,
}

/// The roles of O-words by name.
const ROLES: [(&str, Role); 15] = [
    ("sub", Role::Sub),
    ("endsub", Role::EndSub),
    ("call", Role::Call),
    ("return", Role::Return),
    ("if", Role::If),
    ("elseif", Role::ElseIf),
    ("else", Role::Else),
    ("endif", Role::EndIf),
    ("do", Role::Do),
    ("while", Role::While),
    ("endwhile", Role::EndWhile),
    ("repeat", Role::Repeat),
    ("endrepeat", Role::EndRepeat),
    ("break", Role::Break),
    ("continue", Role::Continue),
];

impl Role {
    /// Returns the word.
    pub(super) fn word(self) -> &'static str {
        ROLES.into_iter().find(|(_, role)| *role == self).map_or("O", |(word, _)| word)
    }

    /// Returns whether it decides which line is next.
    pub(super) fn is_decision(self) -> bool {
        !matches!(self, Role::Title | Role::Sub | Role::EndSub | Role::Call)
    }
}

/// An O-word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct OWord {
    pub(super) label: Label,
    pub(super) role: Role,
}

/// Returns whether a line that begins with a byte can be a title or an O-word: `O1`, `:1`, or the name of a file, `<PART>` (Fanuc).
pub(super) fn begins_title(byte: u8) -> bool {
    matches!(byte, b'O' | b'o' | b':' | b'<')
}

/// Reads an O-word, or a title of Fanuc that begins with a colon or is a name. The label can be an expression. The arguments are left.
pub(super) fn o_word(cursor: &mut Cursor, scope: &Scope) -> Result<OWord, GcodeFault> {
    if cursor.byte() != Some(b'<') {
        cursor.advance();
    }
    let label = match cursor.take(b'<') {
        true => {
            let name = cursor.take_until('>').ok_or(ExpressionFault::OpenName)?;
            Label::of_title(name)
        }
        false => match value(cursor, scope, Rounding::Whole)?.unwrap_or(-1.0) {
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
    // LinuxCNC reads `end sub`, too.
    let mut word = String::new();
    while cursor.peek().is_some_and(|byte| byte.is_ascii_alphabetic()) {
        word += &cursor.take_while(|byte| byte.is_ascii_alphabetic()).to_ascii_lowercase();
    }
    let role = match ROLES.into_iter().find(|(known, _)| word == *known) {
        Some((_, role)) => role,
        None if word.is_empty() => Role::Title,
        None => return Err(GcodeFault::ControlFlow { word: unquoted(&word) }),
    };
    Ok(OWord { label, role })
}

/// Refuses words after an O-word.
pub(super) fn check_end(cursor: &mut Cursor) -> Result<(), GcodeFault> {
    match next(cursor)? {
        None => Ok(()),
        Some(_) => Err(unexpected(cursor)),
    }
}
