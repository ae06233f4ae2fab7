//! Constants, folded with 256 bits and rounded to `f64` once, so that a file gives the same code
//! on every machine.

use dashu_float::round::mode::HalfEven;
use dashu_float::{DBig, FBig};
use std::cmp::Ordering;
use std::hash::{Hash, Hasher};
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::str::FromStr;

/// Bits carried by every constant.
const PRECISION: usize = 256;

/// A real constant to 256 bits.
#[derive(Clone, Debug)]
pub struct Number(FBig<HalfEven, 2>);

impl Number {
    /// Rounded to the precision; zero has no sign, so equal numbers are equal in every way.
    fn rounded(value: FBig<HalfEven, 2>) -> Number {
        if value.repr().significand().is_zero() {
            return Number(FBig::ZERO.with_precision(PRECISION).value());
        }
        Number(value.with_precision(PRECISION).value())
    }

    /// A number from a decimal literal such as `0.25` or `1e-3`.
    pub fn decimal(text: &str) -> Option<Number> {
        let value = DBig::from_str(text).ok()?;
        Some(Number::rounded(
            value.with_rounding::<HalfEven>().with_base_and_precision::<2>(PRECISION).value(),
        ))
    }

    /// A number from a double, exactly; `None` for NaN and infinities.
    pub fn from_f64(value: f64) -> Option<Number> {
        FBig::<HalfEven, 2>::try_from(value).ok().map(Number::rounded)
    }

    /// A whole number.
    pub fn int(value: i64) -> Number {
        Number::rounded(FBig::from(value))
    }

    /// The ratio of the circle.
    pub fn pi() -> Number {
        Number(FBig::<HalfEven, 2>::pi(PRECISION))
    }

    /// The nearest double; an infinity beyond the range.
    pub fn to_f64(&self) -> f64 {
        self.0.to_f64().value()
    }

    /// Whether this is exactly zero.
    pub fn is_zero(&self) -> bool {
        self.0.repr().significand().is_zero()
    }

    /// Whether this is below zero.
    pub fn is_negative(&self) -> bool {
        *self < Number::int(0)
    }

    /// The absolute value.
    pub fn abs(&self) -> Number {
        if self.is_negative() { -self } else { self.clone() }
    }

    /// The square root; `None` below zero.
    pub fn sqrt(&self) -> Option<Number> {
        if self.is_negative() {
            None
        } else if self.is_zero() {
            Some(Number::int(0))
        } else {
            Some(Number::rounded(self.0.sqrt()))
        }
    }

    /// The quotient; `None` for division by zero.
    pub fn over(&self, divisor: &Number) -> Option<Number> {
        (!divisor.is_zero()).then(|| self / divisor)
    }

    /// The sine of an angle in radians.
    pub fn sin(&self) -> Number {
        Number::rounded(self.0.sin())
    }

    /// The cosine of an angle in radians.
    pub fn cos(&self) -> Number {
        Number::rounded(self.0.cos())
    }

    /// The exponent as a whole number of halves, if it is one between -32 and 32.
    pub fn halves(&self) -> Option<i32> {
        let twice = self.to_f64() * 2.0;
        let whole = twice.round();
        let exact = Number::from_f64(whole / 2.0)? == *self;
        (exact && whole.abs() <= 32.0).then_some(whole as i32)
    }

    /// Whether two constants agree but for the last few of their 256 bits.
    pub fn agrees(&self, other: &Number) -> bool {
        let difference = (self - other).abs();
        let scale = self.abs().max(other.abs());
        difference.to_f64() <= scale.to_f64() * 2f64.powi(-200)
    }
}

impl PartialEq for Number {
    fn eq(&self, other: &Number) -> bool {
        self.0.repr() == other.0.repr()
    }
}

impl Eq for Number {}

impl Hash for Number {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.0.repr().significand().hash(state);
        self.0.repr().exponent().hash(state);
    }
}

impl PartialOrd for Number {
    fn partial_cmp(&self, other: &Number) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Number {
    fn cmp(&self, other: &Number) -> Ordering {
        self.0.cmp(&other.0)
    }
}

macro_rules! arithmetic {
    ($($trait:ident $method:ident),*) => {$(
        impl $trait<&Number> for &Number {
            type Output = Number;
            fn $method(self, other: &Number) -> Number {
                Number::rounded($trait::$method(&self.0, &other.0))
            }
        }
    )*};
}
arithmetic!(Add add, Sub sub, Mul mul);

impl Div<&Number> for &Number {
    type Output = Number;
    /// Division by a constant that is known not to be zero.
    fn div(self, other: &Number) -> Number {
        Number::rounded(&self.0 / &other.0)
    }
}

impl Neg for &Number {
    type Output = Number;
    fn neg(self) -> Number {
        Number::rounded(-self.0.clone())
    }
}
