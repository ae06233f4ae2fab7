//! Arithmetic of macros: numbers, variables, brackets, operators and functions.
//!
//! Values are IEEE doubles. Sums, products, quotients and roots are rounded once, other functions are within 2⁻⁵⁰ of exact,
//! relatively. The language is that of the control: Fanuc's and Haas' macros (Fanuc B-64694, chapter "Custom macro"), or LinuxCNC's
//! (`interp_execute.cc`, `interp_read.cc`). Where no control is stated, an expression is read in both, and is refused if both read it
//! and give different values.
//!
//! A control of Fanuc computes with fewer digits. A comparison or a rounding that rounding errors decide is refused there.

use super::variables::{Scope, parameter};
use crate::codes::faults;
use crate::gcode::cursor::Cursor;
use crate::gcode::{LARGEST_NUMBER, shown};
use crate::machine::sin_cos_degrees;

/// Largest nesting of brackets and references.
const MAX_DEPTH: usize = 30;
/// Largest absolute value of a result.
const LARGEST_RESULT: f64 = 1e18;
/// LinuxCNC's numbers are equal if they differ by less (`TOLERANCE_EQUAL`).
const LINUXCNC_EQUAL: f64 = 1e-6;
/// The same of its earlier releases.
const LINUXCNC_EQUAL_BEFORE: f64 = 1e-4;
/// Numbers that differ by less, relatively (and absolutely below 1), may be equal on a control that computes with 8 digits.
const TIE: f64 = 1e-6;
/// The same on LinuxCNC, whose sines and angles have other last digits by the processor (`sin(x * M_PIl / 180)` in `long double`).
const LINUXCNC_TIE: f64 = 1e-12;

/// A value: a number, or `None` for a vacant variable of Fanuc.
pub(super) type Value = Option<f64>;

/// The language of expressions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Language {
    /// Fanuc and Haas.
    Fanuc,
    LinuxCnc,
}

faults! {
    #[family("P02", "Programs of controls: variables and expressions")]
    /// A fault in a variable or an expression.
    #[derive(Clone, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum ExpressionFault {
        /// A number that is not one.
        #[code = P0201]
        #[error("{shown} is not a number: write digits with a decimal point")]
        Number {
            /// The number as written.
            shown: String,
        },
        /// A value that is missing or not understood.
        #[code = P0202]
        #[error("a value is missing {}: write a number, a parameter or a bracket", place(.shown))]
        Value {
            /// The text after it.
            shown: String,
        },
        /// A function or operator that is not read.
        #[code = P0203]
        #[error("`{name}` in an expression is not read: post the program with numbers")]
        Operation {
            /// Its name.
            name: String,
        },
        /// A division in the value of a word, outside of brackets.
        #[code = P0204]
        #[error(
            "`/` after the value of a word is the sign of an optional block on Fanuc, and no division: write it in brackets, as in \
             `X[#1/2]`, or at the beginning of the block"
        )]
        Slash,
        /// An expression with a value that depends on the control.
        #[code = P0205]
        #[error("{shown} has another value on Fanuc than on LinuxCNC: state the `control`")]
        Differs {
            /// The expression.
            shown: String,
        },
        /// A comparison or a rounding that depends on the last digits with which a control computes.
        #[code = P0206]
        #[error(
            "`{operation}` of {value} depends on the digits with which the control computes: compare with a margin, or round before"
        )]
        Tie {
            /// The operation.
            operation: &'static str,
            /// The number, or the difference of the numbers that are compared.
            value: f64,
        },
        /// A function whose range is set by a parameter of the control.
        #[code = P0207]
        #[error(
            "`{function}` of this value is given in one of two ranges of angles, by a parameter of the control: post the program \
             without it"
        )]
        Range {
            /// The function.
            function: &'static str,
        },
        /// A bracket without its end.
        #[code = P0208]
        #[error("an expression has no `]`: close it")]
        OpenBracket,
        /// A name without its end.
        #[code = P0209]
        #[error("a named parameter has no `>`: close it")]
        OpenName,
        /// A variable that has no value.
        #[code = P0210]
        #[error(
            "{parameter} has no value here, but what an earlier program or the operator has left in it: assign it in the program before, \
             or state it in `[variables]` of the job"
        )]
        Unassigned {
            /// The variable.
            parameter: String,
        },
        /// A variable of the control whose value only the machine knows.
        #[code = P0211]
        #[error(
            "{parameter} is {}, whose value is not known: post the program without it, or state it in \
             `[variables]` of the job",
            system_variable(parameter)
        )]
        System {
            /// The variable.
            parameter: String,
        },
        /// A variable that the program cannot assign.
        #[code = P0212]
        #[error("{parameter} is not assigned by programs that are read: post the program without it")]
        ReadOnly {
            /// The variable.
            parameter: String,
        },
        /// A vacant variable where a number is needed.
        #[code = P0213]
        #[error("{parameter} is vacant here: give the macro its argument")]
        Vacant {
            /// The variable.
            parameter: String,
        },
        /// An index that is no whole number from 1.
        #[code = P0214]
        #[error("#{index} is no parameter: write a whole number from 1 to 999 after #")]
        Index {
            /// The index.
            index: f64,
        },
        /// An assignment without `=`.
        #[code = P0215]
        #[error("{parameter} stands alone: write `=` and a value after it, or a letter before it")]
        NoAssignment {
            /// The variable.
            parameter: String,
        },
        /// A division by zero, the root of a negative number, or a number beyond the largest.
        #[code = P0216]
        #[error(
            "the result of `{operation}` is not a number within {LARGEST_RESULT}: correct the values"
        )]
        NotFinite {
            /// The operation.
            operation: &'static str,
        },
        /// A bracket without its end, or an argument that is missing.
        #[code = P0217]
        #[error("an expression has no `)`, or lacks an argument before it: complete it")]
        OpenParenthesis,
        /// A text without its end.
        #[code = P0218]
        #[error("a text has no second quote: close it")]
        OpenQuote,
        /// A value of another kind than its place needs.
        #[code = P0219]
        #[error("{found} stands where {wanted} is needed: correct the expression")]
        Kind {
            /// The kind of the value.
            found: &'static str,
            /// The kind that is needed.
            wanted: &'static str,
        },
        /// Brackets that are nested too deeply.
        #[code = P0220]
        #[error("brackets are nested more than {MAX_DEPTH} deep: write the expression in steps")]
        TooDeep,
    }
}

impl ExpressionFault {
    /// Returns whether the language lacks what is written, so that the control refuses it.
    fn is_of_language(&self) -> bool {
        matches!(
            self,
            ExpressionFault::Operation { .. }
                | ExpressionFault::OpenBracket
                | ExpressionFault::Value { .. }
        )
    }
}

/// Returns what a variable of the control is, where all controls that have its number agree.
fn system_variable(parameter: &str) -> &'static str {
    match parameter.strip_prefix('#').map(str::parse::<u32>) {
        Some(Ok(3007)) => "a system variable (the mirror images in force)",
        Some(Ok(5041..=5060)) => "a system variable (the present position)",
        Some(Ok(5061..=5080)) => "a system variable (the position of a skip or a probe)",
        None if parameter.starts_with('Q') => "a parameter of the control",
        _ => "a system variable",
    }
}

fn place(shown: &str) -> String {
    if shown.is_empty() { "at the end of the line".to_owned() } else { format!("before {shown}") }
}

/// A function of one argument, or of two (`ATAN`, `POW`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Function {
    Abs,
    Acos,
    Asin,
    Atan,
    Cos,
    Exists,
    Exp,
    Fix,
    Fup,
    Ln,
    Pow,
    Round,
    Sin,
    Sqrt,
    Tan,
}

/// The functions by name.
const FUNCTIONS: [(&str, Function); 15] = [
    ("ABS", Function::Abs),
    ("ACOS", Function::Acos),
    ("ASIN", Function::Asin),
    ("ATAN", Function::Atan),
    ("COS", Function::Cos),
    ("EXISTS", Function::Exists),
    ("EXP", Function::Exp),
    ("FIX", Function::Fix),
    ("FUP", Function::Fup),
    ("LN", Function::Ln),
    ("POW", Function::Pow),
    ("ROUND", Function::Round),
    ("SIN", Function::Sin),
    ("SQRT", Function::Sqrt),
    ("TAN", Function::Tan),
];

/// An operator between two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Operator {
    Power,
    Times,
    Over,
    Modulo,
    Plus,
    Minus,
    And,
    Or,
    Xor,
    Equal,
    NotEqual,
    Greater,
    GreaterOrEqual,
    Less,
    LessOrEqual,
}

/// The operators by name, with their precedence on Fanuc and on LinuxCNC (`precedence` of `interp_execute.cc`): the highest is
/// executed first, 0 for one that the language lacks.
const OPERATORS: [(&str, Operator, [u8; 2]); 15] = [
    ("**", Operator::Power, [0, 5]),
    ("*", Operator::Times, [3, 4]),
    ("/", Operator::Over, [3, 4]),
    ("MOD", Operator::Modulo, [3, 4]),
    ("+", Operator::Plus, [2, 3]),
    ("-", Operator::Minus, [2, 3]),
    ("AND", Operator::And, [3, 1]),
    ("OR", Operator::Or, [2, 1]),
    ("XOR", Operator::Xor, [2, 1]),
    ("EQ", Operator::Equal, [1, 2]),
    ("NE", Operator::NotEqual, [1, 2]),
    ("GT", Operator::Greater, [1, 2]),
    ("GE", Operator::GreaterOrEqual, [1, 2]),
    ("LT", Operator::Less, [1, 2]),
    ("LE", Operator::LessOrEqual, [1, 2]),
];

/// Returns the function that begins here: a name with a bracket.
fn function(mut cursor: Cursor) -> Option<Function> {
    cursor.peek();
    let name = cursor.take_while(|byte| byte.is_ascii_alphabetic());
    let known = FUNCTIONS.into_iter().find(|(known, _)| name.eq_ignore_ascii_case(known));
    known.filter(|_| cursor.peek() == Some(b'[')).map(|(_, function)| function)
}

/// Returns whether a value begins here.
pub(super) fn begins_value(cursor: &mut Cursor) -> bool {
    match cursor.peek() {
        Some(b'0'..=b'9' | b'.' | b'+' | b'-' | b'[' | b'#') => true,
        // `X SQRT[2]` has a value; any other letter begins the next word.
        Some(byte) if byte.is_ascii_alphabetic() => function(*cursor).is_some(),
        _ => false,
    }
}

/// Reads a value: a number, a variable, a bracket or a function, with one sign at most.
pub(super) fn value(
    cursor: &mut Cursor,
    scope: &Scope,
    rounding: Rounding,
) -> Result<Value, ExpressionFault> {
    let mut literal = *cursor;
    let negative = literal.peek() == Some(b'-');
    if negative || literal.peek() == Some(b'+') {
        literal.advance();
    }
    if matches!(literal.peek(), Some(b'0'..=b'9' | b'.')) {
        let number = number(&mut literal)?;
        *cursor = literal;
        return Ok(Some(if negative { -number } else { number }));
    }
    agreed(cursor, scope, rounding, |reader, cursor| reader.unary(cursor, 0))
}

/// Reads an expression, as after `=`. LinuxCNC reads one value there. Fanuc's table of operations has sums, products and quotients
/// without brackets (`#i=#j/#k`): `/` is a division there, and begins no optional block.
pub(super) fn expression(cursor: &mut Cursor, scope: &Scope) -> Result<Value, ExpressionFault> {
    agreed(cursor, scope, Rounding::Whole, |reader, cursor| match reader.language {
        Language::Fanuc => reader.binary(cursor, 0, 1),
        Language::LinuxCnc => {
            let value = reader.unary(cursor, 0)?;
            match cursor.peek() {
                Some(b'+' | b'-' | b'*' | b'/') => {
                    let name = char::from(cursor.rest().as_bytes()[0]).to_string();
                    Err(ExpressionFault::Operation { name })
                }
                _ => Ok(value),
            }
        }
    })
}

/// Reads an expression in brackets, and returns whether it is true: not 0.
pub(super) fn condition(cursor: &mut Cursor, scope: &Scope) -> Result<bool, ExpressionFault> {
    if cursor.peek() != Some(b'[') {
        return Err(ExpressionFault::Value { shown: rest(cursor) });
    }
    let value = agreed(cursor, scope, Rounding::Whole, |reader, cursor| {
        let value = reader.bracket(cursor, 0)?;
        reader.is_true(value.unwrap_or_default(), "a condition")?;
        Ok(value)
    })?;
    Ok(value.is_some_and(|value| value != 0.0))
}

/// Reads a value in the language of the control, or in both if none is stated.
fn agreed(
    cursor: &mut Cursor,
    scope: &Scope,
    rounding: Rounding,
    read: impl Fn(&Reader, &mut Cursor) -> Result<Value, ExpressionFault>,
) -> Result<Value, ExpressionFault> {
    if let Some(language) = scope.language {
        return read(&Reader { scope, language, rounding }, cursor);
    }
    let start = *cursor;
    let [mut fanuc, mut linuxcnc] = [start; 2];
    let first = read(&Reader { scope, language: Language::Fanuc, rounding }, &mut fanuc);
    let second = read(&Reader { scope, language: Language::LinuxCnc, rounding }, &mut linuxcnc);
    // One of both may have passed over blanks.
    fanuc.peek();
    linuxcnc.peek();
    // A program that one of them refuses runs on the other only.
    let (value, end) = match (first, second) {
        (Ok(first), Ok(second))
            if first == second && fanuc.rest().len() == linuxcnc.rest().len() =>
        {
            (first, fanuc)
        }
        (Ok(_), Ok(_)) => {
            return Err(ExpressionFault::Differs { shown: shown(start.text_to(&fanuc)) });
        }
        (Ok(value), Err(fault)) if fault.is_of_language() => (value, fanuc),
        (Err(fault), Ok(value)) if fault.is_of_language() => (value, linuxcnc),
        (Err(fault), _) | (_, Err(fault)) => return Err(fault),
    };
    *cursor = end;
    Ok(value)
}

/// Reads a number without a sign.
fn number(cursor: &mut Cursor) -> Result<f64, ExpressionFault> {
    let digits = cursor.take_while(|byte| byte.is_ascii_digit() || byte == b'.');
    match digits.parse::<f64>() {
        Ok(number) if number <= LARGEST_NUMBER => Ok(number),
        Ok(_) => Err(ExpressionFault::NotFinite { operation: "a number" }),
        Err(_) => Err(ExpressionFault::Number { shown: shown(digits) }),
    }
}

/// A reader of expressions in one language.
pub(super) struct Reader<'a> {
    pub(super) scope: &'a Scope<'a>,
    pub(super) language: Language,
    pub(super) rounding: Rounding,
}

/// To what ROUND of Fanuc rounds: to whole numbers, but in the value of a word to the increment of its address (B-63944EN, table of
/// arithmetic and logic operations).
#[derive(Clone, Copy, Debug)]
pub(super) enum Rounding {
    Whole,
    /// To multiples of an increment.
    Increment(f64),
    /// To what only the macro knows, of which the value is an argument.
    Argument,
}

impl Reader<'_> {
    /// Reads values with operators of a precedence and higher ones, from left to right.
    fn binary(
        &self,
        cursor: &mut Cursor,
        depth: usize,
        precedence: u8,
    ) -> Result<Value, ExpressionFault> {
        let mut left = self.unary(cursor, depth)?;
        while let Some((operator, own, after)) = self.operator(*cursor) {
            if own < precedence {
                break;
            }
            *cursor = after;
            let right = self.binary(cursor, depth, own + 1)?;
            left = self.apply(operator, left, right)?;
        }
        Ok(left)
    }

    /// Returns the operator that comes next, with its precedence and the place after it.
    fn operator<'a>(&self, mut cursor: Cursor<'a>) -> Option<(Operator, u8, Cursor<'a>)> {
        cursor.peek();
        let (_, operator, precedences) =
            OPERATORS.into_iter().find(|(name, _, _)| cursor.take_text(name))?;
        let precedence = precedences[usize::from(self.language == Language::LinuxCnc)];
        (precedence > 0).then_some((operator, precedence, cursor))
    }

    /// Reads a value with a sign.
    pub(super) fn unary(
        &self,
        cursor: &mut Cursor,
        depth: usize,
    ) -> Result<Value, ExpressionFault> {
        let negative = cursor.peek() == Some(b'-');
        if negative || cursor.peek() == Some(b'+') {
            cursor.advance();
        }
        let value = self.unsigned(cursor, depth)?;
        Ok(if negative { value.map(|value| -value) } else { value })
    }

    /// Reads a value without a sign.
    pub(super) fn unsigned(
        &self,
        cursor: &mut Cursor,
        depth: usize,
    ) -> Result<Value, ExpressionFault> {
        // Brackets and references recurse, as deep as the program has them.
        if depth > MAX_DEPTH {
            return Err(ExpressionFault::TooDeep);
        }
        match cursor.peek() {
            Some(b'0'..=b'9' | b'.') => number(cursor).map(Some),
            Some(b'#') => self.scope.get(&parameter(self, cursor, depth)?, self.language),
            Some(b'[') => self.bracket(cursor, depth),
            Some(byte) if byte.is_ascii_alphabetic() => match function(*cursor) {
                Some(function) => {
                    cursor.take_while(|byte| byte.is_ascii_alphabetic());
                    self.call(function, cursor, depth)
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
    fn bracket(&self, cursor: &mut Cursor, depth: usize) -> Result<Value, ExpressionFault> {
        cursor.take(b'[');
        let value = self.binary(cursor, depth + 1, 1)?;
        self.close(cursor)?;
        Ok(value)
    }

    fn close(&self, cursor: &mut Cursor) -> Result<(), ExpressionFault> {
        if cursor.take(b']') {
            return Ok(());
        }
        match cursor.peek() {
            // An operator that the language lacks.
            Some(byte) if byte.is_ascii_alphabetic() || byte == b'*' => {
                let is_word = byte.is_ascii_alphabetic();
                let name = cursor.take_while(|byte| byte.is_ascii_alphabetic() == is_word);
                let name: String = name.chars().take(8).collect();
                Err(ExpressionFault::Operation { name: name.to_ascii_uppercase() })
            }
            _ => Err(ExpressionFault::OpenBracket),
        }
    }

    /// Reads the arguments of a function, and returns its value.
    fn call(
        &self,
        function: Function,
        cursor: &mut Cursor,
        depth: usize,
    ) -> Result<Value, ExpressionFault> {
        let is_linuxcnc = self.language == Language::LinuxCnc;
        let lacks = |name: &str| Err(ExpressionFault::Operation { name: name.to_owned() });
        if function == Function::Exists {
            if !is_linuxcnc {
                return lacks("EXISTS");
            }
            cursor.take(b'[');
            if cursor.peek() != Some(b'#') {
                return Err(ExpressionFault::Value { shown: rest(cursor) });
            }
            let parameter = parameter(self, cursor, depth + 1)?;
            self.close(cursor)?;
            return Ok(Some(f64::from(u8::from(self.scope.has(&parameter)?))));
        }
        cursor.take(b'[');
        let first = self.binary(cursor, depth + 1, 1)?.unwrap_or(0.0);
        // `POW[a, b]` and `ATAN[y, x]` on Fanuc, `ATAN[y]/[x]` on both.
        let mut second = None;
        if !is_linuxcnc && cursor.take(b',') {
            second = Some(self.binary(cursor, depth + 1, 1)?.unwrap_or(0.0));
        }
        self.close(cursor)?;
        if function == Function::Atan && second.is_none() && cursor.take(b'/') {
            if cursor.peek() != Some(b'[') {
                return Err(ExpressionFault::Value { shown: rest(cursor) });
            }
            second = Some(self.bracket(cursor, depth)?.unwrap_or(0.0));
        }
        match (function, second) {
            (Function::Atan, Some(second)) => self.angle(first, second).map(Some),
            (Function::Pow, Some(second)) if !is_linuxcnc => {
                finite(first.powf(second), "POW").map(Some)
            }
            (Function::Atan, None) if is_linuxcnc => lacks("ATAN without `/`"),
            (Function::Atan, None) => Ok(Some(inexact(first.atan().to_degrees()))),
            (Function::Pow, _) => lacks("POW"),
            (_, Some(_)) => lacks(","),
            (function, None) => self.of_one(function, first).map(Some),
        }
    }

    /// Returns the angle of a direction, in degrees from -180 to 180.
    fn angle(&self, y: f64, x: f64) -> Result<f64, ExpressionFault> {
        let angle = inexact(y.atan2(x).to_degrees());
        match self.language {
            // From 0 to 360 or from -180 to 180, by parameter 6004.
            Language::Fanuc if angle < 0.0 => Err(ExpressionFault::Range { function: "ATAN" }),
            _ => Ok(angle),
        }
    }

    fn of_one(&self, function: Function, x: f64) -> Result<f64, ExpressionFault> {
        let is_fanuc = self.language == Language::Fanuc;
        match function {
            Function::Abs => Ok(x.abs()),
            Function::Acos => finite(inexact(x.acos().to_degrees()), "ACOS"),
            // From -90 to 90, or from 90 to 270, by parameter 6004.
            Function::Asin if is_fanuc => Err(ExpressionFault::Range { function: "ASIN" }),
            Function::Asin => finite(inexact(x.asin().to_degrees()), "ASIN"),
            Function::Cos => Ok(inexact(sin_cos_degrees(x).1)),
            Function::Sin => Ok(inexact(sin_cos_degrees(x).0)),
            Function::Tan => {
                let (sine, cosine) = sin_cos_degrees(x);
                finite(inexact(sine / cosine), "TAN")
            }
            Function::Exp => finite(x.exp(), "EXP"),
            Function::Ln => finite(x.ln(), "LN"),
            Function::Sqrt => finite(x.sqrt(), "SQRT"),
            // Toward 0 and away from it on Fanuc, down and up on LinuxCNC.
            Function::Fix if is_fanuc => self.rounded(x, x.trunc(), 0.0, "FIX"),
            Function::Fix => self.rounded(x, x.floor(), 0.0, "FIX"),
            Function::Fup if is_fanuc => {
                self.rounded(x, if x < 0.0 { x.floor() } else { x.ceil() }, 0.0, "FUP")
            }
            Function::Fup => self.rounded(x, x.ceil(), 0.0, "FUP"),
            Function::Round if is_fanuc => match self.rounding {
                Rounding::Whole => self.rounded(x, x.round(), 0.5, "ROUND"),
                Rounding::Increment(step) => {
                    let per_unit = (1.0 / step).round();
                    let steps = x * per_unit;
                    Ok(self.rounded(steps, steps.round(), 0.5, "ROUND")? / per_unit)
                }
                Rounding::Argument if x.fract() == 0.0 => Ok(x),
                Rounding::Argument => {
                    Err(ExpressionFault::Operation { name: "ROUND in an argument".to_owned() })
                }
            },
            Function::Round => self.rounded(x, x.round(), 0.5, "ROUND"),
            Function::Atan | Function::Exists | Function::Pow => {
                unreachable!("read with its arguments")
            }
        }
    }

    /// Returns a rounded number, unless the number is so near a step at whole numbers and an offset that its last digits decide.
    fn rounded(
        &self,
        x: f64,
        rounded: f64,
        offset: f64,
        operation: &'static str,
    ) -> Result<f64, ExpressionFault> {
        let distance = (x - offset) - (x - offset).round();
        match self.is_tie(distance, x) {
            true => Err(ExpressionFault::Tie { operation, value: x }),
            false => Ok(rounded),
        }
    }

    /// Returns whether the sign of a difference depends on the last digits of numbers of a size.
    fn is_tie(&self, difference: f64, size: f64) -> bool {
        let least = match self.language {
            Language::Fanuc => TIE,
            Language::LinuxCnc if self.scope.variables.has_angles => LINUXCNC_TIE,
            // Sums and products are those of IEEE 754 there, too.
            Language::LinuxCnc => return false,
        };
        difference != 0.0 && difference.abs() <= least * size.abs().max(1.0)
    }

    /// Returns whether a number is not 0, unless its last digits decide that.
    fn is_true(&self, x: f64, operation: &'static str) -> Result<bool, ExpressionFault> {
        match self.is_tie(x, 1.0) {
            true => Err(ExpressionFault::Tie { operation, value: x }),
            false => Ok(x != 0.0),
        }
    }

    fn apply(
        &self,
        operator: Operator,
        left: Value,
        right: Value,
    ) -> Result<Value, ExpressionFault> {
        let is_linuxcnc = self.language == Language::LinuxCnc;
        // A vacant variable is 0 in sums and products, and no number where it is compared for equality.
        if let (Operator::Equal | Operator::NotEqual, true) =
            (operator, left.is_none() || right.is_none())
        {
            let is_equal = left.is_none() && right.is_none();
            return Ok(Some(f64::from(u8::from(is_equal == (operator == Operator::Equal)))));
        }
        let [x, y] = [left, right].map(Option::unwrap_or_default);
        let truth = |holds: bool| Ok(f64::from(u8::from(holds)));
        let is_near = is_linuxcnc && (x - y).abs() < LINUXCNC_EQUAL;
        let value = match operator {
            Operator::Power => finite(x.powf(y), "**"),
            Operator::Times => finite(x * y, "*"),
            Operator::Over => finite(x / y, "/"),
            Operator::Plus => finite(x + y, "+"),
            Operator::Minus => finite(x - y, "-"),
            Operator::Modulo if is_linuxcnc => {
                let rest = x.rem_euclid(y.abs());
                let is_tie = [rest, y.abs() - rest].iter().any(|rest| self.is_tie(*rest, x));
                match is_tie {
                    true => Err(ExpressionFault::Tie { operation: "MOD", value: x }),
                    false => finite(rest, "MOD"),
                }
            }
            // Of whole numbers, with the sign of the first.
            Operator::Modulo if [x, y].iter().all(|value| value.fract() == 0.0) => {
                finite(x % y, "MOD")
            }
            Operator::Modulo => Err(ExpressionFault::Tie { operation: "MOD", value: x }),
            Operator::And if is_linuxcnc => {
                truth(self.is_true(x, "AND")? && self.is_true(y, "AND")?)
            }
            Operator::Or if is_linuxcnc => truth(self.is_true(x, "OR")? | self.is_true(y, "OR")?),
            Operator::Xor if is_linuxcnc => {
                truth(self.is_true(x, "XOR")? != self.is_true(y, "XOR")?)
            }
            Operator::And => bits(x, y, "AND", |x, y| x & y),
            Operator::Or => bits(x, y, "OR", |x, y| x | y),
            Operator::Xor => bits(x, y, "XOR", |x, y| x ^ y),
            Operator::Equal => self.compared(x, y, "EQ", is_near || !is_linuxcnc && x == y),
            Operator::NotEqual => self.compared(x, y, "NE", !(is_near || !is_linuxcnc && x == y)),
            Operator::Greater => self.compared(x, y, "GT", x > y),
            Operator::GreaterOrEqual => self.compared(x, y, "GE", is_near || x >= y),
            Operator::Less => self.compared(x, y, "LT", x < y),
            Operator::LessOrEqual => self.compared(x, y, "LE", is_near || x <= y),
        };
        value.map(Some)
    }

    /// Returns the result of a comparison, unless rounding errors decide it on a control with fewer digits, or the release of LinuxCNC.
    fn compared(
        &self,
        x: f64,
        y: f64,
        operation: &'static str,
        holds: bool,
    ) -> Result<f64, ExpressionFault> {
        let difference = x - y;
        let is_near = self.is_tie(difference, x.abs().max(y.abs()));
        let is_tie = match self.language {
            Language::Fanuc => is_near,
            // It is exact there, where others are equal within a tolerance.
            Language::LinuxCnc if matches!(operation, "GT" | "LT") => is_near,
            Language::LinuxCnc => {
                let is_decided = match operation {
                    "GE" => difference > 0.0,
                    "LE" => difference < 0.0,
                    _ => false,
                };
                !is_decided && (LINUXCNC_EQUAL..LINUXCNC_EQUAL_BEFORE).contains(&difference.abs())
            }
        };
        match is_tie {
            true => Err(ExpressionFault::Tie { operation, value: difference }),
            false => Ok(f64::from(u8::from(holds))),
        }
    }
}

/// Applies an operation on the bits of whole numbers of 32 bits.
fn bits(
    x: f64,
    y: f64,
    operation: &'static str,
    apply: fn(u32, u32) -> u32,
) -> Result<f64, ExpressionFault> {
    let is_whole =
        |value: f64| value.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&value);
    match is_whole(x) && is_whole(y) {
        true => Ok(f64::from(apply(x as u32, y as u32))),
        false => Err(ExpressionFault::NotFinite { operation }),
    }
}

/// Returns a sine or an angle a few digits beside the number that it is exactly: its last digits differ between controls, so that it must
/// not be equal to another number.
fn inexact(value: f64) -> f64 {
    if value == 0.0 { f64::EPSILON } else { value * (1.0 + 2.0 * f64::EPSILON) }
}

fn finite(value: f64, operation: &'static str) -> Result<f64, ExpressionFault> {
    match value.abs() <= LARGEST_RESULT {
        true => Ok(value),
        false => Err(ExpressionFault::NotFinite { operation }),
    }
}

pub(super) fn rest(cursor: &Cursor) -> String {
    if cursor.rest().is_empty() { String::new() } else { shown(cursor.rest()) }
}
