//! Units of length. Every tool and every part states its unit; none is guessed.

use nalgebra::Point3;
use std::fmt;
use std::str::FromStr;

/// A unit of length, with the symbol that `.tool` files and the program use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Unit {
    /// `mm`
    Millimetre,
    /// `inch`, 25.4 mm by definition
    Inch,
    /// `m`
    Metre,
}

impl Unit {
    /// Returns the length of one unit in millimetres.
    pub const fn millimetres(self) -> f64 {
        match self {
            Unit::Millimetre => 1.0,
            Unit::Inch => 25.4,
            Unit::Metre => 1000.0,
        }
    }

    /// Returns the factor that converts a length in `self` to one in `other`; exactly 1 if the units are equal.
    pub fn factor_to(self, other: Unit) -> f64 {
        self.millimetres() / other.millimetres()
    }

    /// Returns the unit's symbol: `mm`, `inch` or `m`.
    pub const fn symbol(self) -> &'static str {
        match self {
            Unit::Millimetre => "mm",
            Unit::Inch => "inch",
            Unit::Metre => "m",
        }
    }

    /// Formats a length with its unit, for people: to a tenth of a micrometre or about as finely.
    pub fn format(self, length: f64) -> String {
        format!("{} {self}", self.format_number(length))
    }

    /// Formats a length without its unit. What rounds to 0 has no sign.
    pub fn format_number(self, length: f64) -> String {
        let decimals = match self {
            Unit::Millimetre => 4,
            Unit::Inch => 5,
            Unit::Metre => 7,
        };
        let text = format!("{length:.decimals$}");
        match text.strip_prefix('-') {
            Some(zero) if zero.bytes().all(|byte| b"0.".contains(&byte)) => zero.to_owned(),
            _ => text,
        }
    }

    /// Formats a point without its unit.
    pub fn format_point(self, point: &Point3<f64>) -> String {
        let [x, y, z] = [point.x, point.y, point.z].map(|value| self.format_number(value));
        format!("({x}, {y}, {z})")
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol())
    }
}

/// A word that is not the symbol of a unit.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a unit: write `mm`, `inch` or `m`")]
pub struct ParseUnitError(pub String);

crate::debug_as_sentence!(ParseUnitError);

impl FromStr for Unit {
    type Err = ParseUnitError;

    fn from_str(word: &str) -> Result<Unit, ParseUnitError> {
        [Unit::Millimetre, Unit::Inch, Unit::Metre]
            .into_iter()
            .find(|unit| unit.symbol() == word)
            .ok_or_else(|| ParseUnitError(word.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rounds_to_zero_has_no_sign() {
        assert_eq!(Unit::Millimetre.format_number(-1e-9), "0.0000");
        assert_eq!(Unit::Millimetre.format_number(-1e-4), "-0.0001");
        assert_eq!(Unit::Inch.format_number(-0.0), "0.00000");
    }
}
