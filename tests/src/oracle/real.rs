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
    #[must_use]
    fn plus(&self, other: &Self) -> Self;
    /// Returns the difference.
    #[must_use]
    fn minus(&self, other: &Self) -> Self;
    /// Returns the product.
    #[must_use]
    fn times(&self, other: &Self) -> Self;
    /// Returns the quotient.
    #[must_use]
    fn over(&self, other: &Self) -> Self;
    /// Returns the square root.
    #[must_use]
    fn root(&self) -> Self;
    /// Returns the length of the vector with these components, also where their squares leave the range.
    #[must_use]
    fn hypot(&self, other: &Self) -> Self;

    /// Returns zero.
    #[must_use]
    fn zero() -> Self {
        Self::exactly(0.0)
    }

    /// Returns the number with the other sign.
    #[must_use]
    fn negated(&self) -> Self {
        Self::zero().minus(self)
    }

    /// Returns the absolute value.
    #[must_use]
    fn absolute(&self) -> Self {
        if *self < Self::zero() { self.negated() } else { self.clone() }
    }

    /// Returns the smaller of two.
    #[must_use]
    fn least(self, other: Self) -> Self {
        if other < self { other } else { self }
    }

    /// Returns the larger of two.
    #[must_use]
    fn most(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
}

impl Real for f64 {
    fn exactly(value: f64) -> f64 {
        value
    }
    fn decimal(value: f64) -> f64 {
        value
    }
    fn to_f64(&self) -> f64 {
        *self
    }
    fn plus(&self, other: &f64) -> f64 {
        self + other
    }
    fn minus(&self, other: &f64) -> f64 {
        self - other
    }
    fn times(&self, other: &f64) -> f64 {
        self * other
    }
    fn over(&self, other: &f64) -> f64 {
        self / other
    }
    fn root(&self) -> f64 {
        self.sqrt()
    }
    fn hypot(&self, other: &f64) -> f64 {
        f64::hypot(*self, *other)
    }
    fn absolute(&self) -> f64 {
        self.abs()
    }
    fn negated(&self) -> f64 {
        -self
    }
}

impl Real for Big {
    fn exactly(value: f64) -> Big {
        Big::exactly(value)
    }
    fn decimal(value: f64) -> Big {
        Big::decimal(value)
    }
    fn to_f64(&self) -> f64 {
        Big::to_f64(self)
    }
    fn plus(&self, other: &Big) -> Big {
        self + other
    }
    fn minus(&self, other: &Big) -> Big {
        self - other
    }
    fn times(&self, other: &Big) -> Big {
        self * other
    }
    fn over(&self, other: &Big) -> Big {
        self / other
    }
    fn root(&self) -> Big {
        self.sqrt()
    }
    fn hypot(&self, other: &Big) -> Big {
        (&(self * self) + &(other * other)).sqrt()
    }
    fn negated(&self) -> Big {
        -self
    }
}
