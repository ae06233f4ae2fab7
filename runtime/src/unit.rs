//! Units of length: a tool states one, a part is loaded with one, nothing is guessed.

use std::fmt;
use std::str::FromStr;

/// A unit of length, by the words that `.tool` files and the program use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "postures", derive(serde::Serialize, serde::Deserialize))]
pub enum Unit {
    /// `mm`
    Millimetre,
    /// `inch`, 25.4 mm by definition
    Inch,
    /// `m`
    Metre,
}

impl Unit {
    /// How many millimetres one of this unit is.
    pub const fn millimetres(self) -> f64 {
        match self {
            Unit::Millimetre => 1.0,
            Unit::Inch => 25.4,
            Unit::Metre => 1000.0,
        }
    }

    /// The factor that turns a length in `self` into one in `other`; exactly 1 when they agree.
    pub fn to(self, other: Unit) -> f64 {
        self.millimetres() / other.millimetres()
    }

    /// The word for it: `mm`, `inch` or `m`.
    pub const fn word(self) -> &'static str {
        match self {
            Unit::Millimetre => "mm",
            Unit::Inch => "inch",
            Unit::Metre => "m",
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

/// A word that is no unit.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a unit: write `mm`, `inch` or `m`")]
pub struct UnknownUnit(pub String);

impl FromStr for Unit {
    type Err = UnknownUnit;

    fn from_str(word: &str) -> Result<Unit, UnknownUnit> {
        [Unit::Millimetre, Unit::Inch, Unit::Metre]
            .into_iter()
            .find(|unit| unit.word() == word)
            .ok_or_else(|| UnknownUnit(word.to_owned()))
    }
}
