//! Ranges of the numbers that configure a loop, a device and a simulated hand.
//!
//! A period of NaN or infinity would make every pose of the loop NaN, so the constructors check all
//! numbers and the cycles check none.

use nalgebra::Point3;
use std::ops::RangeInclusive;

/// A number that a haptic loop cannot run with. It is returned by the constructors of
/// [`Session`](super::Session) and [`SimulatedHand`](super::SimulatedHand).
#[derive(Clone, Copy, PartialEq, thiserror::Error)]
#[error("the {what} is {value}: give {range}")]
pub struct SettingError {
    /// The name and the unit of the number.
    pub what: &'static str,
    /// The given value.
    pub value: f64,
    /// The range of valid values.
    pub range: &'static str,
}

touchoff::debug_as_sentence!(SettingError);

/// Rates of a loop, Hz. The fastest has a period of a microsecond, which clocks and deadlines still resolve.
const RATES: RangeInclusive<f64> = 1e-3..=1e6;

const ABOVE_ZERO: &str = "a finite number above 0";
const NOT_NEGATIVE: &str = "a finite number of 0 or more";
const FINITE: &str = "a finite number";

pub(super) fn check(
    valid: bool,
    what: &'static str,
    value: f64,
    range: &'static str,
) -> Result<(), SettingError> {
    if valid { Ok(()) } else { Err(SettingError { what, value, range }) }
}

pub(super) fn above_zero(what: &'static str, value: f64) -> Result<(), SettingError> {
    check(value > 0.0 && value.is_finite(), what, value, ABOVE_ZERO)
}

pub(super) fn not_negative(what: &'static str, value: f64) -> Result<(), SettingError> {
    check(value >= 0.0 && value.is_finite(), what, value, NOT_NEGATIVE)
}

/// Returns the period of a rate, s.
pub(super) fn period(rate: f64) -> Result<f64, SettingError> {
    check(RATES.contains(&rate), "rate in Hz", rate, "0.001 to 1000000 cycles per second")?;
    Ok(1.0 / rate)
}

pub(super) fn centre(centre: &Point3<f64>) -> Result<(), SettingError> {
    centre.iter().try_for_each(|part| check(part.is_finite(), "compliance centre", *part, FINITE))
}
