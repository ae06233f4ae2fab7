//! Q parameters and formulas.
//!
//! Values are IEEE doubles, and each operation is rounded once; angles are in degrees. Functions hold for the operand or the bracket
//! after them, `^` before `* / %`, and these before `+ -` (TNC 640, *Klartext programming*, "Entering formulas directly").
//! A parameter that the program has not assigned has a value that only the machine knows, and stops the interpreter, unless the job
//! states it. So do Q108 to Q199, by which the control reports its state.

use super::line::Cursor;
use crate::gcode::error::{combination, not_read};
use crate::gcode::{ExpressionFault, GcodeFault, LARGEST_NUMBER, shown};
use crate::machine::sin_cos_degrees;
use std::collections::BTreeMap;
use std::fmt;

/// Returns the name of a Q parameter in one spelling.
pub(crate) fn variable_name(text: &str) -> Option<String> {
    Parameter::named(text).map(|parameter| parameter.to_string())
}

/// Largest nesting of brackets and functions.
const MAX_DEPTH: usize = 30;

/// The parameters of each kind, with the number of them: global, local to the program, and kept after the power is off.
const KINDS: [(&str, u16); 3] = [("Q", 2000), ("QL", 500), ("QR", 500)];

/// A Q parameter: its place among all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Parameter(u16);

impl Parameter {
    /// Returns a global parameter by its number.
    pub(super) fn global(number: u16) -> Parameter {
        Parameter(number)
    }

    /// Returns the parameter with a name.
    fn named(name: &str) -> Option<Parameter> {
        let digits = name.find(|letter: char| letter.is_ascii_digit())?;
        Parameter::of_kind(&name[..digits], &name[digits..])
    }

    /// Returns the parameter of a kind, as `QL`, with the digits of its number.
    fn of_kind(kind: &str, digits: &str) -> Option<Parameter> {
        let number = digits.parse::<u16>().ok()?;
        let mut first = 0;
        for (known, count) in KINDS {
            if kind.eq_ignore_ascii_case(known) && number < count {
                return Some(Parameter(first + number));
            }
            first += count;
        }
        None
    }

    /// Returns whether the control writes its state into it.
    fn is_of_control(self) -> bool {
        (108..200).contains(&self.0)
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut number = self.0;
        for (kind, count) in KINDS {
            if number < count {
                return write!(f, "{kind}{number}");
            }
            number -= count;
        }
        Ok(())
    }
}

/// The parameters that the program has assigned.
#[derive(Clone, Debug)]
pub(super) struct Parameters {
    /// NaN for one that was not assigned.
    values: Vec<f64>,
}

impl Parameters {
    pub(super) fn new() -> Parameters {
        let count = KINDS.iter().map(|(_, count)| usize::from(*count)).sum();
        Parameters { values: vec![f64::NAN; count] }
    }

    /// Creates the parameters of a program, of which a job states those in `stated`.
    pub(super) fn stated(stated: &BTreeMap<String, Vec<f64>>) -> Parameters {
        let mut parameters = Parameters::new();
        for (name, values) in stated {
            if let Some((parameter, value)) = Parameter::named(name).zip(values.first()) {
                parameters.values[usize::from(parameter.0)] = *value;
            }
        }
        parameters
    }

    /// Hides the parameters of a program (QL) from one that it calls, and returns their values.
    pub(super) fn hide_local(&mut self) -> Vec<f64> {
        let first = usize::from(KINDS[0].1);
        let local = &mut self.values[first..first + usize::from(KINDS[1].1)];
        let values = local.to_vec();
        local.fill(f64::NAN);
        values
    }

    /// Gives the parameters of a program their values again.
    pub(super) fn show_local(&mut self, values: &[f64]) {
        let first = usize::from(KINDS[0].1);
        self.values[first..first + values.len()].copy_from_slice(values);
    }

    /// Assigns a value.
    ///
    /// # Errors
    /// If the control owns the parameter.
    pub(super) fn assign(
        &mut self,
        parameter: Parameter,
        value: f64,
    ) -> Result<(), ExpressionFault> {
        if parameter.is_of_control() {
            return Err(ExpressionFault::System { parameter: parameter.to_string() });
        }
        self.values[usize::from(parameter.0)] = value;
        Ok(())
    }

    /// Forgets the value of a parameter, which the control chooses.
    pub(super) fn forget(&mut self, parameter: Parameter) {
        self.values[usize::from(parameter.0)] = f64::NAN;
    }

    /// Returns the value of a parameter; NaN for one that has none.
    pub(super) fn value(&self, parameter: Parameter) -> f64 {
        self.values[usize::from(parameter.0)]
    }

    /// Returns the value of a parameter.
    ///
    /// # Errors
    /// If neither the job states it nor the program has assigned it.
    pub(super) fn get(&self, parameter: Parameter) -> Result<f64, ExpressionFault> {
        let value = self.values[usize::from(parameter.0)];
        if !value.is_nan() {
            Ok(value)
        } else if parameter.is_of_control() {
            Err(ExpressionFault::System { parameter: parameter.to_string() })
        } else {
            Err(ExpressionFault::Unassigned { parameter: parameter.to_string() })
        }
    }
}

/// Reads the name of a parameter, which begins with Q.
pub(super) fn parameter(cursor: &mut Cursor) -> Result<Parameter, GcodeFault> {
    let start = *cursor;
    let kind = cursor.letters();
    let digits = cursor.take_while(|byte| byte.is_ascii_digit());
    if kind.eq_ignore_ascii_case("QS") {
        let (meaning, remedy) = ("a parameter of text", "write numbers instead");
        return Err(not_read(format!("QS{digits}"), meaning, remedy));
    }
    let mut start = start;
    Parameter::of_kind(kind, digits)
        .ok_or_else(|| start.unexpected("Q0 to Q1999, QL0 to QL499 or QR0 to QR499"))
}

/// Reads a value: a number or a parameter, with one sign at most.
pub(super) fn value(cursor: &mut Cursor, known: &Parameters) -> Result<f64, GcodeFault> {
    let is_negative = sign(cursor);
    let value = match cursor.peek() {
        Some(b'0'..=b'9' | b'.' | b',') => cursor.number()?,
        Some(b'Q' | b'q') => known.get(parameter(cursor)?)?,
        _ => return Err(missing_value(cursor)),
    };
    Ok(if is_negative { -value } else { value })
}

/// Passes over a sign, and returns whether it is a minus.
fn sign(cursor: &mut Cursor) -> bool {
    let is_negative = cursor.take(b'-');
    if !is_negative {
        cursor.take(b'+');
    }
    is_negative
}

fn missing_value(cursor: &mut Cursor) -> GcodeFault {
    let shown = if cursor.is_at_end() { String::new() } else { shown(cursor.rest().trim_end()) };
    ExpressionFault::Value { shown }.into()
}

/// Reads a formula, as after `=`.
pub(super) fn formula(cursor: &mut Cursor, known: &Parameters) -> Result<f64, GcodeFault> {
    sum(cursor, known, 0)
}

fn sum(cursor: &mut Cursor, known: &Parameters, depth: usize) -> Result<f64, GcodeFault> {
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

fn product(cursor: &mut Cursor, known: &Parameters, depth: usize) -> Result<f64, GcodeFault> {
    let mut total = power(cursor, known, depth)?;
    loop {
        if cursor.take(b'*') {
            total = finite(total * power(cursor, known, depth)?, "*")?;
        } else if cursor.take(b'/') {
            total = finite(total / power(cursor, known, depth)?, "/")?;
        } else if cursor.take(b'%') {
            total = finite(total % power(cursor, known, depth)?, "%")?;
        } else {
            return Ok(total);
        }
    }
}

fn power(cursor: &mut Cursor, known: &Parameters, depth: usize) -> Result<f64, GcodeFault> {
    // The sign and the function of `-Q1 ^ 2` hold for Q1 or for the power: neither is stated.
    let is_plain = matches!(cursor.peek(), Some(b'0'..=b'9' | b'.' | b',' | b'Q' | b'q' | b'('));
    let base = operand(cursor, known, depth)?;
    if !cursor.take(b'^') {
        return Ok(base);
    }
    let exponent = operand(cursor, known, depth)?;
    if !is_plain || cursor.peek() == Some(b'^') {
        let meaning = "a power beside a sign, a function or another power";
        return Err(not_read("^", meaning, "write brackets around its base"));
    }
    finite(base.powf(exponent), "^")
}

fn operand(cursor: &mut Cursor, known: &Parameters, depth: usize) -> Result<f64, GcodeFault> {
    // Brackets and functions recurse, as deep as the program has them.
    if depth > MAX_DEPTH {
        return Err(ExpressionFault::TooDeep.into());
    }
    match cursor.peek() {
        Some(b'(') => {
            cursor.advance();
            let value = sum(cursor, known, depth + 1)?;
            match cursor.take(b')') {
                true => Ok(value),
                false => Err(cursor.unexpected("`)` after the bracket")),
            }
        }
        Some(b'+' | b'-') => {
            let is_negative = sign(cursor);
            let value = operand(cursor, known, depth + 1)?;
            Ok(if is_negative { -value } else { value })
        }
        Some(b'Q' | b'q') => Ok(known.get(parameter(cursor)?)?),
        Some(byte) if byte.is_ascii_alphabetic() => function(cursor, known, depth),
        _ => value(cursor, known),
    }
}

/// Reads a function and its operand, or π.
fn function(cursor: &mut Cursor, known: &Parameters, depth: usize) -> Result<f64, GcodeFault> {
    let found = FUNCTIONS.iter().find(|name| {
        let mut ahead = *cursor;
        // The name of a parameter may follow without a blank, as in `SINQ1`.
        ahead.take_text(name)
            && ahead.byte().is_none_or(|byte| !byte.is_ascii_alphabetic() || byte == b'Q')
    });
    let Some(operation) = found.copied() else {
        let name = cursor.letters().to_ascii_uppercase();
        return Err(ExpressionFault::Operation { name }.into());
    };
    cursor.take_text(operation);
    if operation == "PI" {
        return Ok(std::f64::consts::PI);
    }
    let x = operand(cursor, known, depth + 1)?;
    // It is 0 or 1 there. Rounding can make 0 of any value that is as small.
    if operation == "SGN" && x.abs() < 1e-9 {
        let condition = "its operand is 0";
        return Err(combination("SGN", condition, "decide on 0 before, as with FN 9"));
    }
    finite(apply(operation, x), operation)
}

/// The functions of one operand, and π.
const FUNCTIONS: [&str; 16] = [
    "SIN", "COS", "TAN", "ASIN", "ACOS", "ATAN", "SQRT", "SQ", "ABS", "INT", "FRAC", "NEG", "SGN",
    "LN", "EXP", "PI",
];

fn apply(operation: &str, x: f64) -> f64 {
    match operation {
        "SIN" => sin_cos_degrees(x).0,
        "COS" => sin_cos_degrees(x).1,
        "TAN" => {
            let (sine, cosine) = sin_cos_degrees(x);
            sine / cosine
        }
        "ASIN" => x.asin().to_degrees(),
        "ACOS" => x.acos().to_degrees(),
        "ATAN" => x.atan().to_degrees(),
        "SQRT" => x.sqrt(),
        "SQ" => x * x,
        "ABS" => x.abs(),
        "INT" => x.trunc(),
        "FRAC" => x.fract(),
        "NEG" => -x,
        "SGN" => x.signum(),
        "LN" => x.ln(),
        _ => x.exp(),
    }
}

/// Returns the angle of a right triangle with an opposite and an adjacent side (FN 13), from 0 to 360 degrees.
pub(super) fn angle(opposite: f64, adjacent: f64) -> Result<f64, GcodeFault> {
    if opposite == 0.0 && adjacent == 0.0 {
        return Err(ExpressionFault::NotFinite { operation: "ANG" }.into());
    }
    Ok(opposite.atan2(adjacent).to_degrees().rem_euclid(360.0))
}

/// Returns a value that a control can hold.
pub(super) fn finite(value: f64, operation: &'static str) -> Result<f64, GcodeFault> {
    match value.abs() <= LARGEST_NUMBER {
        true => Ok(value),
        false => Err(ExpressionFault::NotFinite { operation }.into()),
    }
}
