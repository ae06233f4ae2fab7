//! Real numbers with 256 bits.

use dashu_float::round::mode::HalfEven;
use dashu_float::{DBig, FBig};
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::str::FromStr;

const PRECISION: usize = 256;

/// A real number, rounded to 256 bits by every operation.
#[derive(Clone, Debug, PartialEq, PartialOrd)]
pub struct Big(FBig<HalfEven, 2>);

impl Big {
    /// Returns zero.
    pub fn zero() -> Big {
        Big::exactly(0.0)
    }

    /// Returns a finite double exactly, to the last bit.
    pub fn exactly(value: f64) -> Big {
        let exact = FBig::<HalfEven, 2>::try_from(value).expect("a finite number");
        Big(exact.with_precision(PRECISION).value())
    }

    /// Returns the decimal that a double was written as: 12.9 is 129/10.
    pub fn decimal(value: f64) -> Big {
        let text = DBig::from_str(&format!("{value}")).expect("a finite number");
        Big(text.with_rounding::<HalfEven>().with_base_and_precision::<2>(PRECISION).value())
    }

    /// Returns the nearest double.
    pub fn to_f64(&self) -> f64 {
        self.0.to_f64().value()
    }

    /// Returns decimal digits that keep all of its bits.
    pub fn to_decimal_string(&self) -> String {
        let decimal = self.0.clone().with_base_and_precision::<10>(90).value();
        decimal.to_string()
    }

    /// Returns whether the number is below zero.
    pub fn is_negative(&self) -> bool {
        *self < Big::zero()
    }

    /// Returns the absolute value.
    pub fn abs(&self) -> Big {
        if self.is_negative() { -self } else { self.clone() }
    }

    /// Returns the square root of a number that is not below zero.
    pub fn sqrt(&self) -> Big {
        if *self == Big::zero() { Big::zero() } else { Big(self.0.sqrt()) }
    }

    /// Returns the sine of an angle in degrees.
    pub fn sin_deg(degrees: f64) -> Big {
        Big(Big::radians(degrees).0.sin())
    }

    /// Returns the cosine of an angle in degrees.
    pub fn cos_deg(degrees: f64) -> Big {
        Big(Big::radians(degrees).0.cos())
    }

    /// Returns the tangent of an angle in degrees.
    pub fn tan_deg(degrees: f64) -> Big {
        &Big::sin_deg(degrees) / &Big::cos_deg(degrees)
    }

    fn radians(degrees: f64) -> Big {
        let turn = Big(FBig::<HalfEven, 2>::pi(PRECISION));
        &(&turn * &Big::decimal(degrees)) / &Big::exactly(180.0)
    }
}

/// Converts a coordinate as it is written: a decimal such as 12.9, which means 129/10.
impl From<f64> for Big {
    fn from(value: f64) -> Big {
        Big::decimal(value)
    }
}

macro_rules! arithmetic {
    ($($trait:ident $method:ident),*) => {$(
        impl $trait for &Big {
            type Output = Big;
            fn $method(self, other: &Big) -> Big {
                Big($trait::$method(&self.0, &other.0))
            }
        }
        impl<B: Into<Big>> $trait<B> for Big {
            type Output = Big;
            fn $method(self, other: B) -> Big {
                $trait::$method(&self, &other.into())
            }
        }
    )*};
}
arithmetic!(Add add, Sub sub, Mul mul, Div div);

impl Neg for &Big {
    type Output = Big;
    fn neg(self) -> Big {
        Big(-self.0.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_and_roots() {
        assert_eq!(Big::decimal(12.9).to_f64(), 12.9);
        assert!(Big::decimal(0.1) < Big::exactly(0.1));
        let two = Big::exactly(2.0);
        let difference = &(&two.sqrt() * &two.sqrt()) - &two;
        assert!(difference.abs() < Big::exactly(2f64.powi(-250)));
        assert_eq!(Big::decimal(-12.75).to_decimal_string(), "-12.75");
        let tiny = Big::exactly(5e-324);
        assert_eq!((&tiny * &tiny).sqrt().to_f64(), 5e-324);
        assert!((Big::tan_deg(45.0) - 1.0).abs() < Big::exactly(2f64.powi(-250)));
    }
}
