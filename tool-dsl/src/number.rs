//! Constants, folded with 256 bits and rounded to `f64` once, so that a file gives the same code on every
//! machine.

use dashu_float::round::mode::HalfEven;
use dashu_float::{DBig, FBig};
use std::cmp::Ordering;
use std::hash::{Hash, Hasher};
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::str::FromStr;
use std::sync::OnceLock;

/// The sizes that numbers of a file other than 0 may have.
const SIZES_IN_FILES: std::ops::RangeInclusive<f64> = 1e-90..=1e90;

/// The relative difference of doubles beyond which the constants that they were rounded from are not equal: far above a
/// double's rounding.
pub(crate) const NEAR_IN_DOUBLES: f64 = 1e-9;

/// The precision of every constant, in bits.
const PRECISION_BITS: usize = 256;

/// The largest residue of a cancelling sum of [`Number`]s, relative to the absolute values of its terms.
pub(crate) const ROUNDING: f64 = 1.0 / ((1u128 << 95) as f64 * (1u128 << 95) as f64);

/// A real constant with 256 bits.
#[derive(Clone)]
pub struct Number {
    exact: FBig<HalfEven, 2>,
    /// The nearest double, computed on first use.
    near: OnceLock<f64>,
}

impl Number {
    fn new(exact: FBig<HalfEven, 2>) -> Number {
        Number { exact, near: OnceLock::new() }
    }

    /// Rounds to the precision. Zero has no sign, so that equal numbers have equal representations.
    fn rounded(value: FBig<HalfEven, 2>) -> Number {
        if value.repr().significand().is_zero() {
            return Number::new(FBig::ZERO.with_precision(PRECISION_BITS).value());
        }
        Number::new(value.with_precision(PRECISION_BITS).value())
    }

    /// Parses a decimal literal such as `0.25` or `1e-3`.
    pub fn parse_decimal(text: &str) -> Option<Number> {
        let value = DBig::from_str(text).ok()?;
        Some(Number::rounded(
            value.with_rounding::<HalfEven>().with_base_and_precision::<2>(PRECISION_BITS).value(),
        ))
    }

    /// Converts a double, exactly; `None` for NaN and infinities.
    pub fn from_f64(value: f64) -> Option<Number> {
        FBig::<HalfEven, 2>::try_from(value).ok().map(Number::rounded)
    }

    /// Converts an integer.
    pub fn int(value: i64) -> Number {
        Number::rounded(FBig::from(value))
    }

    /// Returns π.
    pub fn pi() -> Number {
        Number::new(FBig::<HalfEven, 2>::pi(PRECISION_BITS))
    }

    /// Returns the nearest double; an infinity if the number is out of range.
    pub fn to_f64(&self) -> f64 {
        *self.near.get_or_init(|| {
            let (significand, exponent) = (self.exact.repr().significand(), self.exponent());
            // Far from the ends of the range, scaling the rounded significand is exact.
            match exponent {
                Some(exponent) => significand.to_f64().value() * 2f64.powi(exponent),
                None => self.exact.to_f64().value(),
            }
        })
    }

    /// Returns the exponent of the significand, an integer of up to 256 bits, if the number is far from the
    /// ends of a double's range.
    fn exponent(&self) -> Option<i32> {
        let exponent = i32::try_from(self.exact.repr().exponent()).ok()?;
        (-700..=500).contains(&exponent).then_some(exponent)
    }

    /// Returns whether the number is a double. May be false for one near the ends of a double's range.
    pub(crate) fn is_double(&self) -> bool {
        // Significands of this type are odd, or 0.
        let significand = i64::try_from(self.exact.repr().significand());
        self.exponent().is_some()
            && significand
                .is_ok_and(|significand| significand.unsigned_abs() < 1 << f64::MANTISSA_DIGITS)
    }

    /// Returns whether a file may contain this number: zero, or a magnitude from 1e-90 to 1e90, so that sums
    /// of its powers do not overflow a double.
    pub(crate) fn is_in_range(&self) -> bool {
        self.is_zero() || SIZES_IN_FILES.contains(&self.to_f64().abs())
    }

    /// Returns whether this is exactly zero.
    pub fn is_zero(&self) -> bool {
        self.exact.repr().significand().is_zero()
    }

    /// Returns whether this is below zero.
    pub fn is_negative(&self) -> bool {
        match self.to_f64() {
            // The number may be below the smallest double.
            0.0 => *self < Number::int(0),
            near => near < 0.0,
        }
    }

    /// Returns the absolute value.
    pub fn abs(&self) -> Number {
        if self.is_negative() { -self } else { self.clone() }
    }

    /// Returns the square root; `None` below zero.
    pub fn sqrt(&self) -> Option<Number> {
        if self.is_negative() {
            None
        } else if self.is_zero() {
            Some(Number::int(0))
        } else {
            Some(Number::rounded(self.exact.sqrt()))
        }
    }

    /// Returns the quotient; `None` for division by zero.
    pub fn checked_div(&self, divisor: &Number) -> Option<Number> {
        (!divisor.is_zero()).then(|| self / divisor)
    }

    /// Returns the sine of an angle in radians.
    pub fn sin(&self) -> Number {
        Number::rounded(self.exact.sin())
    }

    /// Returns the cosine of an angle in radians.
    pub fn cos(&self) -> Number {
        Number::rounded(self.exact.cos())
    }

    /// Returns twice this exponent, if that is an integer between -32 and 32.
    pub fn doubled_exponent(&self) -> Option<i32> {
        let doubled = self.to_f64() * 2.0;
        let whole = doubled.round();
        let exact = Number::from_f64(whole / 2.0)? == *self;
        (exact && whole.abs() <= 32.0).then_some(whole as i32)
    }

    /// Returns whether two constants agree except for the last few of their 256 bits.
    pub fn nearly_equals(&self, other: &Number) -> bool {
        let (a, b) = (self.to_f64(), other.to_f64());
        let scale = a.abs().max(b.abs());
        // A comparison of doubles rejects most pairs cheaply.
        (a - b).abs() <= NEAR_IN_DOUBLES * scale
            && (self - other).to_f64().abs() <= scale * 2f64.powi(-200)
    }
}

impl std::fmt::Debug for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.exact.fmt(f)
    }
}

impl PartialEq for Number {
    fn eq(&self, other: &Number) -> bool {
        self.exact.repr() == other.exact.repr()
    }
}

impl Eq for Number {}

impl Hash for Number {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.exact.repr().significand().hash(state);
        self.exact.repr().exponent().hash(state);
    }
}

impl PartialOrd for Number {
    fn partial_cmp(&self, other: &Number) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Number {
    fn cmp(&self, other: &Number) -> Ordering {
        self.exact.cmp(&other.exact)
    }
}

macro_rules! arithmetic {
    ($($trait:ident $method:ident),*) => {$(
        impl $trait<&Number> for &Number {
            type Output = Number;
            fn $method(self, other: &Number) -> Number {
                Number::rounded($trait::$method(&self.exact, &other.exact))
            }
        }
    )*};
}
arithmetic!(Add add, Sub sub, Mul mul);

impl Div<&Number> for &Number {
    type Output = Number;
    /// Divides by a constant that is known to be nonzero.
    fn div(self, other: &Number) -> Number {
        Number::rounded(&self.exact / &other.exact)
    }
}

impl Neg for &Number {
    type Output = Number;
    fn neg(self) -> Number {
        Number::rounded(-self.exact.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of all sizes, with few and with all bits, among them doubles, and halfway points between two.
    fn numbers() -> Vec<Number> {
        let number = |text: &str| Number::parse_decimal(text).expect("a number");
        let third = &Number::int(1) / &Number::int(3);
        let mut numbers = vec![Number::int(0), Number::pi(), third, number("9007199254740993")];
        for exponent in [-330, -310, -250, -90, -1, 0, 1, 90, 250, 307, 309] {
            for digits in ["1", "-1.5", "3.14159265358979323846264338327950288419716939937510"] {
                numbers.push(number(&format!("{digits}e{exponent}")));
            }
        }
        for double in [0.1, -7.25, f64::MIN_POSITIVE, 5e-324, f64::MAX, 1.0 + f64::EPSILON] {
            let double = Number::from_f64(double).expect("finite");
            // Three quarters of the last place of 1 above a double.
            let above = &double + &(&double * &number("1.6653345369377348e-16"));
            numbers.extend([double, above]);
        }
        numbers
    }

    #[test]
    fn the_nearest_double_is_that_of_the_library_of_numbers() {
        for number in numbers() {
            let nearest = number.exact.to_f64().value();
            assert_eq!(number.to_f64().to_bits(), nearest.to_bits(), "{number:?}");
        }
    }

    #[test]
    fn doubles_are_recognised() {
        let mut doubles = 0;
        for number in numbers() {
            let is_double = Number::from_f64(number.to_f64()).as_ref() == Some(&number);
            assert!(!number.is_double() || is_double, "{number:?}");
            let size = number.to_f64().abs();
            if (1e-200..1e200).contains(&size) || size == 0.0 {
                assert_eq!(number.is_double(), is_double, "{number:?}");
            }
            doubles += usize::from(number.is_double());
        }
        // 0, 0.1 as a double, 1, 1 + ε, -1.5, -7.25, 10 and -15.
        assert_eq!(doubles, 8);
    }
}
