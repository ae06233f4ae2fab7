//! Expressions of Sinumerik: R parameters, variables, functions, comparisons.
//!
//! Operators bind in this order (*NC programming*, section on priorities): `NOT`; `* / DIV MOD`; `+ -`; `AND`; `XOR`; `OR`;
//! comparisons. `R1>5 AND R2<3` without brackets is therefore no comparison of two conditions, and is refused. Angles are in degrees.
//! Values are IEEE doubles, and each operation is rounded once; `SIN` and `COS` are exact at multiples of 90 degrees.
//!
//! A comparison of two numbers that differ by less than 1e-9 of their size is refused: it depends on how the control rounds.

use super::text::Cursor;
use super::variables::{Reference, Variables};
use crate::gcode::error::{combination, not_read};
use crate::gcode::{ExpressionFault, GcodeFault, LARGEST_NUMBER, shown};
use crate::machine::sin_cos_degrees;

/// Largest nesting of brackets and signs.
const MAX_DEPTH: usize = 30;
/// Relative difference of two numbers below which their comparison depends on rounding.
const SAME: f64 = 1e-9;

/// A value of a variable or an expression.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Number(f64),
    Truth(bool),
    Text(String),
}

impl Value {
    /// Returns the number.
    ///
    /// # Errors
    /// If it is a text or a condition.
    pub(super) fn number(&self) -> Result<f64, GcodeFault> {
        match self {
            Value::Number(number) => Ok(*number),
            Value::Truth(_) => Err(wrong_kind("a condition", "a number")),
            Value::Text(_) => Err(wrong_kind("a text", "a number")),
        }
    }

    /// Returns the condition: a number is true unless it is 0.
    ///
    /// # Errors
    /// If it is a text.
    pub(super) fn truth(&self) -> Result<bool, GcodeFault> {
        match self {
            Value::Number(number) => Ok(*number != 0.0),
            Value::Truth(truth) => Ok(*truth),
            Value::Text(_) => Err(wrong_kind("a text", "a condition")),
        }
    }
}

fn wrong_kind(found: &'static str, wanted: &'static str) -> GcodeFault {
    ExpressionFault::Kind { found, wanted }.into()
}

/// Reads an expression.
pub(super) fn expression(cursor: &mut Cursor, known: &Variables) -> Result<Value, GcodeFault> {
    comparison(cursor, known, 0)
}

/// Reads an expression whose value is a number.
pub(super) fn number(cursor: &mut Cursor, known: &Variables) -> Result<f64, GcodeFault> {
    expression(cursor, known)?.number()
}

/// The relations, the longer ones first.
const RELATIONS: [&str; 6] = ["==", "<>", ">=", "<=", ">", "<"];

fn comparison(cursor: &mut Cursor, known: &Variables, depth: usize) -> Result<Value, GcodeFault> {
    let left = logic(cursor, known, depth, 0)?;
    if cursor.take_text("<<") {
        return Err(ExpressionFault::Operation { name: "<<".to_owned() }.into());
    }
    let Some(relation) = RELATIONS.into_iter().find(|relation| cursor.take_text(relation)) else {
        return Ok(left);
    };
    let right = logic(cursor, known, depth, 0)?;
    let ordering = match (&left, &right) {
        (Value::Text(left), Value::Text(right)) if matches!(relation, "==" | "<>") => {
            left.cmp(right)
        }
        (Value::Truth(left), Value::Truth(right)) => left.cmp(right),
        _ => {
            let (left, right) = (left.number()?, right.number()?);
            if left != right && (left - right).abs() <= SAME * left.abs().max(right.abs()) {
                let condition = "both sides differ by rounding alone";
                return Err(combination(
                    relation,
                    condition,
                    "compare with ROUND, or count whole numbers",
                ));
            }
            left.total_cmp(&right)
        }
    };
    // -0 is 0.
    let is_equal = left == right || ordering.is_eq();
    Ok(Value::Truth(match relation {
        "==" => is_equal,
        "<>" => !is_equal,
        ">=" => is_equal || ordering.is_gt(),
        "<=" => is_equal || ordering.is_lt(),
        ">" => !is_equal && ordering.is_gt(),
        _ => !is_equal && ordering.is_lt(),
    }))
}

/// The operators between conditions, those that bind least first.
const LOGIC: [&str; 3] = ["OR", "XOR", "AND"];

fn logic(
    cursor: &mut Cursor,
    known: &Variables,
    depth: usize,
    level: usize,
) -> Result<Value, GcodeFault> {
    let Some(operator) = LOGIC.get(level) else { return sum(cursor, known, depth) };
    let mut total = logic(cursor, known, depth, level + 1)?;
    while cursor.take_name(operator) {
        let right = logic(cursor, known, depth, level + 1)?;
        let (Value::Truth(left), Value::Truth(right)) = (&total, &right) else {
            let condition = "its sides are no conditions, since it binds before comparisons";
            return Err(combination(*operator, condition, "put each comparison in brackets"));
        };
        total = Value::Truth(match *operator {
            "OR" => *left || *right,
            "XOR" => left != right,
            _ => *left && *right,
        });
    }
    Ok(total)
}

fn sum(cursor: &mut Cursor, known: &Variables, depth: usize) -> Result<Value, GcodeFault> {
    let mut total = product(cursor, known, depth)?;
    loop {
        let operation = match cursor.peek() {
            Some(b'+') => "+",
            Some(b'-') => "-",
            _ => return Ok(total),
        };
        cursor.advance();
        let (left, right) = (total.number()?, product(cursor, known, depth)?.number()?);
        let result = if operation == "+" { left + right } else { left - right };
        total = finite(result, operation)?;
    }
}

fn product(cursor: &mut Cursor, known: &Variables, depth: usize) -> Result<Value, GcodeFault> {
    let mut total = signed(cursor, known, depth)?;
    loop {
        let operation = match cursor.peek() {
            Some(b'*') => "*",
            Some(b'/') => "/",
            Some(b'D' | b'd') if cursor.take_name("DIV") => "DIV",
            Some(b'M' | b'm') if cursor.take_name("MOD") => "MOD",
            _ => return Ok(total),
        };
        if matches!(operation, "*" | "/") {
            cursor.advance();
        }
        let (left, right) = (total.number()?, signed(cursor, known, depth)?.number()?);
        let result = match operation {
            "*" => left * right,
            "/" => left / right,
            _ => {
                let is_whole = left.fract() == 0.0 && right.fract() == 0.0;
                if !is_whole || left < 0.0 || right <= 0.0 {
                    let condition = "its sides are no whole numbers from 0";
                    return Err(combination(operation, condition, "write TRUNC of the quotient"));
                }
                if operation == "DIV" { (left / right).trunc() } else { left % right }
            }
        };
        total = finite(result, operation)?;
    }
}

fn signed(cursor: &mut Cursor, known: &Variables, depth: usize) -> Result<Value, GcodeFault> {
    // Brackets and signs recurse, as deep as the program has them.
    if depth > MAX_DEPTH {
        return Err(ExpressionFault::TooDeep.into());
    }
    match cursor.peek() {
        Some(b'-') => {
            cursor.advance();
            Ok(Value::Number(-signed(cursor, known, depth + 1)?.number()?))
        }
        Some(b'+') => {
            cursor.advance();
            Ok(Value::Number(signed(cursor, known, depth + 1)?.number()?))
        }
        Some(b'N' | b'n') if cursor.take_name("NOT") => match signed(cursor, known, depth + 1)? {
            Value::Truth(truth) => Ok(Value::Truth(!truth)),
            _ => Err(wrong_kind("a number or a text after NOT", "a condition")),
        },
        _ => primary(cursor, known, depth),
    }
}

fn primary(cursor: &mut Cursor, known: &Variables, depth: usize) -> Result<Value, GcodeFault> {
    match cursor.peek() {
        Some(b'0'..=b'9' | b'.') => Ok(Value::Number(unsigned(cursor)?)),
        Some(b'"') => match cursor.quoted() {
            Some(text) => Ok(Value::Text(text.to_owned())),
            None => Err(ExpressionFault::OpenQuote.into()),
        },
        Some(b'(') => {
            cursor.advance();
            let value = comparison(cursor, known, depth + 1)?;
            close(cursor)?;
            Ok(value)
        }
        Some(byte) if byte.is_ascii_alphabetic() || matches!(byte, b'_' | b'$') => {
            named(cursor, known, depth)
        }
        _ => {
            let rest = cursor.rest();
            let shown = if rest.is_empty() { String::new() } else { shown(rest) };
            Err(ExpressionFault::Value { shown }.into())
        }
    }
}

/// Reads a number without a sign. `EX` begins an exponent.
pub(super) fn unsigned(cursor: &mut Cursor) -> Result<f64, GcodeFault> {
    let digits = cursor.take_while(|byte| byte.is_ascii_digit() || byte == b'.');
    let parsed = digits.parse::<f64>();
    let is_exponent = cursor.rest().get(..2).is_some_and(|text| text.eq_ignore_ascii_case("EX"));
    match parsed {
        Ok(_) if is_exponent => {
            let shown = format!("`{digits}EX`");
            Err(ExpressionFault::Number { shown }.into())
        }
        Ok(number) if number <= LARGEST_NUMBER => Ok(number),
        Ok(_) => Err(ExpressionFault::NotFinite { operation: "a number" }.into()),
        Err(_) => Err(ExpressionFault::Number { shown: shown(digits) }.into()),
    }
}

fn close(cursor: &mut Cursor) -> Result<(), GcodeFault> {
    match cursor.take(b')') {
        true => Ok(()),
        false => Err(ExpressionFault::OpenParenthesis.into()),
    }
}

/// The functions that are read, each with the number of its arguments.
const FUNCTIONS: [(&str, usize); 16] = [
    ("SIN", 1),
    ("COS", 1),
    ("TAN", 1),
    ("ASIN", 1),
    ("ACOS", 1),
    ("ATAN2", 2),
    ("SQRT", 1),
    ("ABS", 1),
    ("POT", 1),
    ("TRUNC", 1),
    ("ROUND", 1),
    ("ROUNDUP", 1),
    ("LN", 1),
    ("EXP", 1),
    ("MINVAL", 2),
    ("MAXVAL", 2),
];

/// Reads a name: a function, a constant or a variable.
fn named(cursor: &mut Cursor, known: &Variables, depth: usize) -> Result<Value, GcodeFault> {
    let mut after = *cursor;
    let name = after.name();
    if let Some((function, count)) =
        FUNCTIONS.iter().find(|(function, _)| function.eq_ignore_ascii_case(name))
        && after.take(b'(')
    {
        *cursor = after;
        let mut arguments = [0.0; 2];
        for (index, argument) in arguments.iter_mut().take(*count).enumerate() {
            if index > 0 && !cursor.take(b',') {
                return Err(ExpressionFault::OpenParenthesis.into());
            }
            *argument = comparison(cursor, known, depth + 1)?.number()?;
        }
        close(cursor)?;
        return evaluate(function, arguments);
    }
    if name.eq_ignore_ascii_case("TRUE") || name.eq_ignore_ascii_case("FALSE") {
        *cursor = after;
        return Ok(Value::Truth(name.eq_ignore_ascii_case("TRUE")));
    }
    if name.eq_ignore_ascii_case("$PI") {
        *cursor = after;
        return Ok(Value::Number(std::f64::consts::PI));
    }
    if name.starts_with('$') {
        let meaning = "a variable of the control, whose value only the machine knows";
        let remedy = "write its value, or an R parameter that `[variables]` of the job states";
        return Err(not_read(name.to_ascii_uppercase(), meaning, remedy));
    }
    let is_call = after.peek() == Some(b'(');
    let is_distance =
        ["AC", "IC", "DC", "ACP", "ACN"].iter().any(|known| name.eq_ignore_ascii_case(known));
    if is_call && is_distance {
        let meaning = "a way of one axis to its position";
        return Err(not_read(
            name.to_ascii_uppercase(),
            meaning,
            "write it after an axis: `X=AC(5)`",
        ));
    }
    if is_call {
        return Err(ExpressionFault::Operation { name: name.to_ascii_uppercase() }.into());
    }
    let Some(reference) = reference(cursor, known, depth)? else {
        return Err(super::undefined(name));
    };
    known.get(reference)
}

/// Reads a variable: `R5`, `R[expression]`, a name, a name with one index or two. Returns `None`, without passing over it, for a name
/// that is not defined.
pub(super) fn reference(
    cursor: &mut Cursor,
    known: &Variables,
    depth: usize,
) -> Result<Option<Reference>, GcodeFault> {
    let mut after = *cursor;
    let name = after.name();
    let is_r = name.starts_with(['R', 'r']);
    if is_r && name.len() > 1 && name[1..].bytes().all(|byte| byte.is_ascii_digit()) {
        *cursor = after;
        let index = name[1..].parse().unwrap_or(f64::INFINITY);
        return Reference::r(index).map(Some);
    }
    if is_r && name.len() == 1 && after.take(b'[') {
        let index = comparison(&mut after, known, depth + 1)?.number()?;
        close_index(&mut after)?;
        *cursor = after;
        return Reference::r(index).map(Some);
    }
    let Some(variable) = known.find(name) else { return Ok(None) };
    let mut indices = [0.0; 2];
    let mut count = 0;
    if after.take(b'[') {
        for (place, index) in indices.iter_mut().enumerate() {
            if place > 0 && !after.take(b',') {
                break;
            }
            *index = comparison(&mut after, known, depth + 1)?.number()?;
            count += 1;
        }
        close_index(&mut after)?;
    }
    *cursor = after;
    known.element(variable, &indices[..count]).map(Some)
}

fn close_index(cursor: &mut Cursor) -> Result<(), GcodeFault> {
    match cursor.take(b']') {
        true => Ok(()),
        false => Err(ExpressionFault::OpenBracket.into()),
    }
}

fn evaluate(function: &'static str, [first, second]: [f64; 2]) -> Result<Value, GcodeFault> {
    let result = match function {
        "SIN" => sin_cos_degrees(first).0,
        "COS" => sin_cos_degrees(first).1,
        "TAN" => {
            let (sine, cosine) = sin_cos_degrees(first);
            sine / cosine
        }
        "ASIN" => first.asin().to_degrees(),
        "ACOS" => first.acos().to_degrees(),
        "ATAN2" => first.atan2(second).to_degrees(),
        "SQRT" => first.sqrt(),
        "ABS" => first.abs(),
        "POT" => first * first,
        "TRUNC" => first.trunc(),
        "ROUND" => first.round(),
        // Its description says downwards for numbers below 0, its examples upwards (NC programming, Job planning).
        "ROUNDUP" if first < 0.0 && first.fract() != 0.0 => {
            let condition = "its number is below 0, which manuals round up and down";
            return Err(combination("ROUNDUP", condition, "write TRUNC, or TRUNC and -1"));
        }
        "ROUNDUP" => first.ceil(),
        "LN" => first.ln(),
        "EXP" => first.exp(),
        "MINVAL" => first.min(second),
        _ => first.max(second),
    };
    finite(result, function)
}

fn finite(value: f64, operation: &'static str) -> Result<Value, GcodeFault> {
    match value.abs() <= LARGEST_NUMBER {
        true => Ok(Value::Number(value)),
        false => Err(ExpressionFault::NotFinite { operation }.into()),
    }
}
