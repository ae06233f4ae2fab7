//! Parameters `#1`, `#<name>` and arithmetic in brackets.
//!
//! Values are IEEE doubles, and each operation is rounded once. Read are `+ - * /`, brackets, one sign before
//! a value, and `SQRT` and `ABS`, which mean the same on every control and are correctly rounded. Other
//! functions and operators are refused. So are parameters from `#1000` and names that begin with `_`, by
//! which controls report their state, and every parameter that the program has not assigned.
//!
//! An assignment takes effect after its block (RS274/NGC, section 3.3.3.4).

use std::collections::BTreeMap;

/// Largest nesting of brackets and references.
const MAX_DEPTH: usize = 30;
/// The first number of the parameters that belong to the control.
const FIRST_SYSTEM: u16 = 1000;
/// The first number of the parameters that a subprogram of O-words shares with its caller.
const FIRST_SHARED: u16 = 31;

/// A fault in a parameter or an expression.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExpressionFault {
    /// A number that is not one.
    #[error("{shown} is not a number: write digits with a decimal point")]
    Number {
        /// The number as written.
        shown: String,
    },
    /// A value that is missing or not understood.
    #[error("a value is missing {}: write a number, a parameter or a bracket", place(.shown))]
    Value {
        /// The text after it.
        shown: String,
    },
    /// A function or operator that is not read.
    #[error("`{name}` in an expression is not read: post the program with numbers")]
    Operation {
        /// Its name.
        name: String,
    },
    /// A bracket without its end.
    #[error("an expression has no `]`: close it")]
    OpenBracket,
    /// A name without its end.
    #[error("a named parameter has no `>`: close it")]
    OpenName,
    /// A parameter that has no value.
    #[error("{parameter} has no value here: assign it in the program before")]
    Unassigned {
        /// The parameter.
        parameter: String,
    },
    /// A parameter that the control owns.
    #[error(
        "{parameter} is a parameter of the control, whose value is not known: post the program without it"
    )]
    System {
        /// The parameter.
        parameter: String,
    },
    /// An index that is no whole number from 1.
    #[error("#{index} is no parameter: write a whole number from 1 to 999 after #")]
    Index {
        /// The index.
        index: f64,
    },
    /// An assignment without `=`.
    #[error("{parameter} stands alone: write `=` and a value after it, or a letter before it")]
    NoAssignment {
        /// The parameter.
        parameter: String,
    },
    /// A division by zero, the root of a negative number, or a number beyond the largest.
    #[error(
        "the result of `{operation}` is not a number within {}: correct the values",
        crate::gcode::LARGEST_NUMBER
    )]
    NotFinite {
        /// The operation.
        operation: &'static str,
    },
    /// A bracket without its end, or an argument that is missing.
    #[error("an expression has no `)`, or lacks an argument before it: complete it")]
    OpenParenthesis,
    /// A text without its end.
    #[error("a text has no second quote: close it")]
    OpenQuote,
    /// A value of another kind than its place needs.
    #[error("{found} stands where {wanted} is needed: correct the expression")]
    Kind {
        /// The kind of the value.
        found: &'static str,
        /// The kind that is needed.
        wanted: &'static str,
    },
    /// Brackets that are nested too deeply.
    #[error("brackets are nested more than {MAX_DEPTH} deep: write the expression in steps")]
    TooDeep,
}

touchoff::debug_as_sentence!(ExpressionFault);

fn place(shown: &str) -> String {
    if shown.is_empty() { "at the end of the line".to_owned() } else { format!("before {shown}") }
}

/// A parameter.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Parameter {
    Numbered(u16),
    /// A name in small letters without blanks, as names are compared.
    Named(String),
}

impl Parameter {
    fn shown(&self) -> String {
        match self {
            Parameter::Numbered(number) => format!("#{number}"),
            Parameter::Named(name) => format!("#<{name}>"),
        }
    }

    /// Returns whether a subprogram has its own: names always, numbers below [`FIRST_SHARED`] if it has `sub` (O-words).
    fn is_local(&self, has_sub: bool) -> bool {
        match self {
            Parameter::Named(_) => true,
            Parameter::Numbered(number) => has_sub && *number < FIRST_SHARED,
        }
    }
}

/// The parameters that the program has assigned.
#[derive(Clone, Debug, Default)]
pub(super) struct Parameters {
    values: BTreeMap<Parameter, f64>,
}

impl Parameters {
    pub(super) fn assign(&mut self, parameter: Parameter, value: f64) {
        self.values.insert(parameter, value);
    }

    /// Removes the parameters that are local to a subprogram, and returns them. `has_sub` is set for O-words.
    pub(super) fn take_locals(&mut self, has_sub: bool) -> Parameters {
        let values = std::mem::take(&mut self.values);
        let (locals, shared) = values.into_iter().partition(|(key, _)| key.is_local(has_sub));
        self.values = shared;
        Parameters { values: locals }
    }

    /// Replaces the local parameters by those of the caller.
    pub(super) fn restore_locals(&mut self, locals: Parameters, has_sub: bool) {
        self.values.retain(|key, _| !key.is_local(has_sub));
        self.values.extend(locals.values);
    }

    fn get(&self, parameter: &Parameter) -> Result<f64, ExpressionFault> {
        self.values
            .get(parameter)
            .copied()
            .ok_or_else(|| ExpressionFault::Unassigned { parameter: parameter.shown() })
    }
}

/// A position in the text of a line.
#[derive(Clone, Copy)]
pub(super) struct Cursor<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(text: &'a str) -> Cursor<'a> {
        Cursor { text, at: 0 }
    }

    /// Returns the next byte that is no blank, without passing over it.
    pub(super) fn peek(&mut self) -> Option<u8> {
        let bytes = self.text.as_bytes();
        while matches!(bytes.get(self.at), Some(b' ' | b'\t')) {
            self.at += 1;
        }
        bytes.get(self.at).copied()
    }

    /// Passes over the next byte that is no blank if it is the given one.
    pub(super) fn take(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    /// Passes over one byte, which has to be ASCII.
    pub(super) fn advance(&mut self) {
        self.at += 1;
    }

    /// Passes over bytes as long as they satisfy the condition, and returns their text.
    pub(super) fn take_while(&mut self, condition: impl Fn(u8) -> bool) -> &'a str {
        let rest = &self.text[self.at..];
        let length = rest.bytes().position(|byte| !condition(byte)).unwrap_or(rest.len());
        self.at += length;
        &rest[..length]
    }

    /// Returns the rest of the line.
    pub(super) fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    /// Passes over the text up to a delimiter and the delimiter, and returns the text before it.
    pub(super) fn take_until(&mut self, delimiter: char) -> Option<&'a str> {
        let (before, _) = self.rest().split_once(delimiter)?;
        self.at += before.len() + delimiter.len_utf8();
        Some(before)
    }
}

/// Returns whether a value begins here.
pub(super) fn begins_value(cursor: &mut Cursor) -> bool {
    match cursor.peek() {
        Some(b'0'..=b'9' | b'.' | b'+' | b'-' | b'[' | b'#') => true,
        // `X SQRT[2]` has a value; any other letter begins the next word.
        Some(byte) if byte.is_ascii_alphabetic() => begins_function(*cursor).is_some(),
        _ => false,
    }
}

/// Returns the function that begins here, if it is one that is read.
fn begins_function(mut cursor: Cursor) -> Option<&'static str> {
    cursor.peek();
    let name = cursor.take_while(|byte| byte.is_ascii_alphabetic());
    let known = ["SQRT", "ABS"].into_iter().find(|known| name.eq_ignore_ascii_case(known))?;
    cursor.take(b'[').then_some(known)
}

/// Reads a value: a number, a parameter, a bracket or a function, with one sign at most.
pub(super) fn value(cursor: &mut Cursor, known: &Parameters) -> Result<f64, ExpressionFault> {
    signed(cursor, known, 0)
}

/// Reads a sum of products, as after `=` and in brackets.
fn sum(cursor: &mut Cursor, known: &Parameters, depth: usize) -> Result<f64, ExpressionFault> {
    let mut total = product(cursor, known, depth)?;
    loop {
        if cursor.take(b'+') {
            total = finite(total + product(cursor, known, depth)?, "+")?;
        } else if cursor.take(b'-') {
            total = finite(total - product(cursor, known, depth)?, "-")?;
        } else {
            return Ok(total);
        }
    }
}

fn product(cursor: &mut Cursor, known: &Parameters, depth: usize) -> Result<f64, ExpressionFault> {
    let mut total = signed(cursor, known, depth)?;
    loop {
        if cursor.take(b'*') {
            if cursor.peek() == Some(b'*') {
                return Err(ExpressionFault::Operation { name: "**".to_owned() });
            }
            total = finite(total * signed(cursor, known, depth)?, "*")?;
        } else if depth == 0 && cursor.peek() == Some(b'/') {
            // Outside of brackets it is the sign of an optional block on Fanuc.
            return Err(ExpressionFault::Operation { name: "/".to_owned() });
        } else if cursor.take(b'/') {
            total = finite(total / signed(cursor, known, depth)?, "/")?;
        } else {
            return Ok(total);
        }
    }
}

fn signed(cursor: &mut Cursor, known: &Parameters, depth: usize) -> Result<f64, ExpressionFault> {
    let negative = cursor.peek() == Some(b'-');
    if negative || cursor.peek() == Some(b'+') {
        cursor.advance();
    }
    let value = unsigned(cursor, known, depth)?;
    Ok(if negative { -value } else { value })
}

fn unsigned(cursor: &mut Cursor, known: &Parameters, depth: usize) -> Result<f64, ExpressionFault> {
    // Brackets and references recurse, as deep as the program has them.
    if depth > MAX_DEPTH {
        return Err(ExpressionFault::TooDeep);
    }
    match cursor.peek() {
        Some(b'0'..=b'9' | b'.') => {
            let digits = cursor.take_while(|byte| byte.is_ascii_digit() || byte == b'.');
            match digits.parse::<f64>() {
                Ok(number) => finite(number, "a number"),
                Err(_) => Err(ExpressionFault::Number { shown: crate::gcode::shown(digits) }),
            }
        }
        Some(b'#') => known.get(&parameter(cursor, known, depth)?),
        Some(b'[') => bracket(cursor, known, depth),
        Some(byte) if byte.is_ascii_alphabetic() => match begins_function(*cursor) {
            Some(function) => {
                cursor.take_while(|byte| byte.is_ascii_alphabetic());
                let argument = bracket(cursor, known, depth)?;
                if function == "ABS" { Ok(argument.abs()) } else { finite(argument.sqrt(), "SQRT") }
            }
            None => {
                let name = cursor.take_while(|byte| byte.is_ascii_alphabetic());
                Err(ExpressionFault::Operation { name: name.to_ascii_uppercase() })
            }
        },
        _ => Err(ExpressionFault::Value { shown: rest(cursor) }),
    }
}

/// Reads an expression in brackets.
fn bracket(cursor: &mut Cursor, known: &Parameters, depth: usize) -> Result<f64, ExpressionFault> {
    cursor.take(b'[');
    let value = sum(cursor, known, depth + 1)?;
    if cursor.take(b']') {
        return Ok(value);
    }
    match cursor.peek() {
        // An operator that is a word, such as `MOD`.
        Some(byte) if byte.is_ascii_alphabetic() => {
            let name = cursor.take_while(|byte| byte.is_ascii_alphabetic());
            Err(ExpressionFault::Operation { name: name.to_ascii_uppercase() })
        }
        _ => Err(ExpressionFault::OpenBracket),
    }
}

/// Reads a parameter, which begins with `#`.
fn parameter(
    cursor: &mut Cursor,
    known: &Parameters,
    depth: usize,
) -> Result<Parameter, ExpressionFault> {
    cursor.take(b'#');
    if cursor.take(b'<') {
        let name = cursor.take_until('>').ok_or(ExpressionFault::OpenName)?;
        let name: String = name.chars().filter(|c| !c.is_whitespace()).collect();
        let named = Parameter::Named(name.to_lowercase());
        return match name.starts_with('_') || name.is_empty() {
            true => Err(ExpressionFault::System { parameter: named.shown() }),
            false => Ok(named),
        };
    }
    let index = unsigned(cursor, known, depth + 1)?;
    if index.fract() != 0.0 || !(1.0..=f64::from(u16::MAX)).contains(&index) {
        return Err(ExpressionFault::Index { index });
    }
    let numbered = Parameter::Numbered(index as u16);
    // By these a control reports its state, which is not known here.
    match index >= f64::from(FIRST_SYSTEM) {
        true => Err(ExpressionFault::System { parameter: numbered.shown() }),
        false => Ok(numbered),
    }
}

/// Reads an assignment `#1 = value`.
pub(super) fn assignment(
    cursor: &mut Cursor,
    known: &Parameters,
) -> Result<(Parameter, f64), ExpressionFault> {
    let target = parameter(cursor, known, 0)?;
    match cursor.take(b'=') {
        true => Ok((target, sum(cursor, known, 0)?)),
        false => Err(ExpressionFault::NoAssignment { parameter: target.shown() }),
    }
}

fn finite(value: f64, operation: &'static str) -> Result<f64, ExpressionFault> {
    match value.abs() <= crate::gcode::LARGEST_NUMBER {
        true => Ok(value),
        false => Err(ExpressionFault::NotFinite { operation }),
    }
}

fn rest(cursor: &Cursor) -> String {
    if cursor.rest().is_empty() { String::new() } else { crate::gcode::shown(cursor.rest()) }
}
