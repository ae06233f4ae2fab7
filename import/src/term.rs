//! Values that know how a `.tool` file writes them.

use std::fmt;

/// A constant expression of a `.tool` file, and its value.
///
/// The text is what the imported file contains, so the file's geometry is computed by the compiler, with 256 bits. The
/// value is the same in doubles: it decides which segments have a length, and which dimensions contradict each other.
#[derive(Clone, Debug)]
pub(super) struct Term {
    text: String,
    value: f64,
    strength: Strength,
}

/// The precedence of the outermost operator of an expression.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
enum Strength {
    Sum,
    Product,
    Power,
    Atom,
}

impl Term {
    /// Returns a number.
    pub(super) fn number(value: f64) -> Term {
        let strength = if value < 0.0 { Strength::Sum } else { Strength::Atom };
        Term { text: decimal(value), value, strength }
    }

    /// Returns a name with its value.
    pub(super) fn name(name: &str, value: f64) -> Term {
        Term { text: name.to_owned(), value, strength: Strength::Atom }
    }

    pub(super) fn value(&self) -> f64 {
        self.value
    }

    pub(super) fn plus(&self, other: &Term) -> Term {
        if other.is("0") {
            return self.clone();
        }
        if self.is("0") {
            return other.clone();
        }
        Term {
            text: format!("{self} + {}", other.within(Strength::Product)),
            value: self.value + other.value,
            strength: Strength::Sum,
        }
    }

    pub(super) fn minus(&self, other: &Term) -> Term {
        if other.is("0") {
            return self.clone();
        }
        let text = if self.is("0") {
            format!("-{}", other.within(Strength::Power))
        } else {
            format!("{self} - {}", other.within(Strength::Product))
        };
        Term { text, value: self.value - other.value, strength: Strength::Sum }
    }

    pub(super) fn times(&self, other: &Term) -> Term {
        if other.is("1") {
            return self.clone();
        }
        if self.is("1") {
            return other.clone();
        }
        Term {
            text: format!("{}*{}", self.within(Strength::Product), other.within(Strength::Power)),
            value: self.value * other.value,
            strength: Strength::Product,
        }
    }

    pub(super) fn over(&self, other: &Term) -> Term {
        Term {
            text: format!("{}/{}", self.within(Strength::Product), other.within(Strength::Power)),
            value: self.value / other.value,
            strength: Strength::Product,
        }
    }

    pub(super) fn half(&self) -> Term {
        self.over(&Term::number(2.0))
    }

    pub(super) fn squared(&self) -> Term {
        Term {
            text: format!("{}^2", self.within(Strength::Atom)),
            value: self.value * self.value,
            strength: Strength::Power,
        }
    }

    pub(super) fn sqrt(&self) -> Term {
        self.call("sqrt", self.value.sqrt())
    }

    /// Returns the sine of an angle in degrees.
    pub(super) fn sin(&self) -> Term {
        self.call("sin", self.value.to_radians().sin())
    }

    /// Returns the cosine of an angle in degrees.
    pub(super) fn cos(&self) -> Term {
        self.call("cos", self.value.to_radians().cos())
    }

    /// Returns the tangent of an angle in degrees.
    pub(super) fn tan(&self) -> Term {
        self.call("tan", self.value.to_radians().tan())
    }

    fn call(&self, function: &str, value: f64) -> Term {
        Term { text: format!("{function}({self})"), value, strength: Strength::Atom }
    }

    fn is(&self, text: &str) -> bool {
        self.text == text
    }

    /// Returns the text, in parentheses if its operator binds less tightly than `strength`.
    fn within(&self, strength: Strength) -> String {
        if self.strength < strength { format!("({self})") } else { self.text.clone() }
    }
}

impl fmt::Display for Term {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// Writes a number as the language has it: the shortest decimal that is the same double, without an exponent.
pub(super) fn decimal(value: f64) -> String {
    // -0 would be written as `-0`.
    format!("{}", if value == 0.0 { 0.0 } else { value })
}

/// Returns a sum of decimals without the rounding of doubles: 1e-9 is finer than any tool library states a length.
pub(crate) fn rounded(value: f64) -> f64 {
    if value.abs() < 1e6 { (value * 1e9).round() / 1e9 } else { value }
}
