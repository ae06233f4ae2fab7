//! The numbers that an oracle computes with: doubles, or 256 bits.

use super::big::Big;
use std::fmt::Debug;

/// A real number. Operations take references, since numbers of 256 bits are not copied for nothing.
pub trait Real: Clone + Debug + PartialOrd {
    /// Returns the number that a double is, to its last bit.
    fn exactly(value: f64) -> Self;
    /// Returns the decimal that a double was written as.
    fn decimal(value: f64) -> Self;
    /// Returns the nearest double.
    fn to_f64(&self) -> f64;
    /// Returns the sum.
    fn plus(&self, other: &Self) -> Self;
    /// Returns the difference.
    fn minus(&self, other: &Self) -> Self;
    /// Returns the product.
    fn times(&self, other: &Self) -> Self;
    /// Returns the quotient.
    fn over(&self, other: &Self) -> Self;
    /// Returns the square root.
    fn root(&self) -> Self;
    /// Returns the length of the vector with these components, also where their squares leave the range.
    fn hypot(&self, other: &Self) -> Self;

    /// Returns zero.
    fn zero() -> Self {
        Self::exactly(0.0)
    }

    /// Returns the number with the other sign.
    fn negated(&self) -> Self;
    /// Returns the absolute value.
    fn absolute(&self) -> Self;

    /// Returns the smaller of two.
    fn least(self, other: Self) -> Self {
        if other < self { other } else { self }
    }

    /// Returns the larger of two.
    fn most(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
}

/// Implements what doubles and 256 bits have by the same names.
macro_rules! operators {
    () => {
        fn plus(&self, other: &Self) -> Self {
            self + other
        }
        fn minus(&self, other: &Self) -> Self {
            self - other
        }
        fn times(&self, other: &Self) -> Self {
            self * other
        }
        fn over(&self, other: &Self) -> Self {
            self / other
        }
        fn root(&self) -> Self {
            self.sqrt()
        }
        fn negated(&self) -> Self {
            -self
        }
        fn absolute(&self) -> Self {
            self.abs()
        }
    };
}

impl Real for f64 {
    operators!();
    fn exactly(value: f64) -> f64 {
        value
    }
    fn decimal(value: f64) -> f64 {
        value
    }
    fn to_f64(&self) -> f64 {
        *self
    }
    fn hypot(&self, other: &f64) -> f64 {
        f64::hypot(*self, *other)
    }
}

impl Real for Big {
    operators!();
    fn exactly(value: f64) -> Big {
        Big::exactly(value)
    }
    fn decimal(value: f64) -> Big {
        Big::decimal(value)
    }
    fn to_f64(&self) -> f64 {
        Big::to_f64(self)
    }
    fn hypot(&self, other: &Big) -> Big {
        (&(self * self) + &(other * other)).sqrt()
    }
}
