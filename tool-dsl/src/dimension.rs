//! Dimensions: a bare number, a power of length, or an angle.

use std::fmt;

/// What an expression measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dimension {
    /// A number without a unit; it fits any power of length.
    Bare,
    /// A power of length; exponents are sums of halves, exact in a double.
    Length(f64),
    /// An angle.
    Angle,
}

use Dimension::{Angle, Bare, Length};

/// One unit of length.
pub(crate) const LENGTH: Dimension = Length(1.0);

impl Dimension {
    /// Of a sum, a difference, a minimum, two sides of a comparison.
    pub(crate) fn alike(self, other: Dimension) -> Option<Dimension> {
        match (self, other) {
            (Bare, Length(_)) => Some(other),
            (Length(_), Bare) => Some(self),
            _ => (self == other).then_some(self),
        }
    }

    /// Of a product.
    pub(crate) fn times(self, other: Dimension) -> Option<Dimension> {
        match (self, other) {
            (Bare, any) | (any, Bare) => Some(any),
            (Length(a), Length(b)) => Some(Length(a + b)),
            _ => None,
        }
    }

    /// Of a quotient.
    pub(crate) fn over(self, other: Dimension) -> Option<Dimension> {
        match (self, other) {
            (any, Bare) => Some(any),
            (Bare, Length(b)) => Some(Length(-b)),
            (Length(a), Length(b)) => Some(Length(a - b)),
            (Angle, Angle) => Some(Bare),
            _ => None,
        }
    }

    /// Of a power with an exponent given in halves.
    pub(crate) fn power(self, halves: i32) -> Option<Dimension> {
        match self {
            Bare => Some(Bare),
            Length(a) => Some(Length(a * f64::from(halves) / 2.0)),
            Angle => None,
        }
    }

    /// Whether it will do where a length is wanted.
    pub(crate) fn is_length(self) -> bool {
        self == Bare || self == LENGTH
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Bare => f.write_str("a number"),
            Angle => f.write_str("an angle"),
            Length(0.0) => f.write_str("a ratio"),
            Length(1.0) => f.write_str("a length"),
            Length(2.0) => f.write_str("an area"),
            Length(3.0) => f.write_str("a volume"),
            Length(power) => write!(f, "a length to the power {power}"),
        }
    }
}
