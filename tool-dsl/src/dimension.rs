//! Dimensions: a bare number, a power of length, or an angle.

use std::fmt;

/// The dimension of an expression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dimension {
    /// A number without a unit; it fits any power of length.
    Dimensionless,
    /// A power of length. Exponents are sums of halves and exact in a double.
    Length(f64),
    /// An angle.
    Angle,
}

use Dimension::{Angle, Dimensionless, Length};

/// One unit of length.
pub(crate) const LENGTH: Dimension = Length(1.0);

impl Dimension {
    /// Returns the dimension of a sum, a difference, a minimum, or the two sides of a comparison; `None` if
    /// they do not match.
    pub(crate) fn common(self, other: Dimension) -> Option<Dimension> {
        match (self, other) {
            (Dimensionless, Length(_)) => Some(other),
            (Length(_), Dimensionless) => Some(self),
            _ => (self == other).then_some(self),
        }
    }

    /// Returns the dimension of a product, if it has one.
    pub(crate) fn times(self, other: Dimension) -> Option<Dimension> {
        match (self, other) {
            (Dimensionless, any) | (any, Dimensionless) => Some(any),
            (Length(a), Length(b)) => Some(Length(a + b)),
            _ => None,
        }
    }

    /// Returns the dimension of a quotient, if it has one.
    pub(crate) fn over(self, other: Dimension) -> Option<Dimension> {
        match (self, other) {
            (any, Dimensionless) => Some(any),
            (Dimensionless, Length(b)) => Some(Length(-b)),
            (Length(a), Length(b)) => Some(Length(a - b)),
            (Angle, Angle) => Some(Dimensionless),
            _ => None,
        }
    }

    /// Returns the dimension of a power with an exponent given in halves; `None` for an angle.
    pub(crate) fn power(self, halves: i32) -> Option<Dimension> {
        match self {
            Dimensionless => Some(Dimensionless),
            Length(a) => Some(Length(a * f64::from(halves) / 2.0)),
            Angle => None,
        }
    }

    /// Returns whether it is accepted where a length is expected.
    pub(crate) fn is_length(self) -> bool {
        self == Dimensionless || self == LENGTH
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Dimensionless => f.write_str("a number"),
            Angle => f.write_str("an angle"),
            Length(0.0) => f.write_str("a ratio"),
            Length(1.0) => f.write_str("a length"),
            Length(2.0) => f.write_str("an area"),
            Length(3.0) => f.write_str("a volume"),
            Length(power) => write!(f, "a length to the power {power}"),
        }
    }
}
