//! Ranges of the numbers that configure a loop, a device and a simulated hand.
//!
//! A period of NaN or infinity would make every pose of the loop NaN, so the constructors check all
//! numbers and the cycles check none.

use super::{
    Coupling, DeviceAxes, DeviceLimits, HandImpedance, Rendering, SessionSettings, SpeedLimit,
    Tremor,
};
use nalgebra::Point3;
use std::ops::RangeInclusive;

/// A number that a haptic loop cannot run with. It is returned by the constructors of
/// [`Session`](super::Session) and [`SimulatedHand`](super::SimulatedHand).
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the {what} is {value}: give {range}")]
pub struct SettingError {
    /// The name and the unit of the number.
    pub what: &'static str,
    /// The given value.
    pub value: f64,
    /// The range of valid values.
    pub range: &'static str,
}

/// Rates of a loop, Hz. The fastest has a period of a microsecond, which clocks and deadlines still
/// resolve.
const RATES: RangeInclusive<f64> = 1e-3..=1e6;

const ABOVE_ZERO: &str = "a finite number above 0";
const NOT_NEGATIVE: &str = "a finite number of 0 or more";
const FINITE: &str = "a finite number";

fn check(
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

impl DeviceLimits {
    pub(super) fn check(&self) -> Result<(), SettingError> {
        let DeviceLimits {
            axes: DeviceAxes::Five | DeviceAxes::Six,
            force,
            torque,
            stiffness,
            turning_stiffness: turning,
        } = *self;
        above_zero("largest force of the device in N", force)?;
        above_zero("largest torque of the device in N·mm", torque)?;
        above_zero("stiffness of the device in N/mm", stiffness)?;
        above_zero("rotational stiffness of the device in N·mm/rad", turning)
    }
}

impl SessionSettings {
    pub(super) fn check(&self) -> Result<(), SettingError> {
        let SessionSettings { rate, stiffness, rendering, passive: _, fastest } = *self;
        period(rate)?;
        above_zero("stiffness of contact", stiffness)?;
        match rendering {
            Some(Rendering::Direct { scaled: _, damping }) => {
                not_negative("damping of direct rendering in s", damping)?;
            }
            Some(Rendering::Coupled(coupling)) => coupling.check()?,
            None => {}
        }
        let SpeedLimit { linear, angular } = fastest;
        let speeds =
            [("largest speed in mm/s", linear), ("largest turning speed in rad/s", angular)];
        speeds.into_iter().try_for_each(|(what, speed)| {
            check(speed > 0.0, what, speed, "a number above 0, or infinity to accept any speed")
        })
    }
}

impl Coupling {
    fn check(&self) -> Result<(), SettingError> {
        let Coupling { stiffness, turning_stiffness: turning, damping } = *self;
        above_zero("stiffness of the coupling in N/mm", stiffness)?;
        above_zero("rotational stiffness of the coupling in N·mm/rad", turning)?;
        not_negative("damping of the coupling in s", damping)
    }
}

impl HandImpedance {
    pub(super) fn check(&self) -> Result<(), SettingError> {
        let HandImpedance {
            mass,
            damping,
            stiffness,
            inertia,
            turning_damping,
            turning_stiffness: turning,
        } = *self;
        above_zero("mass of the grip in kg", mass)?;
        above_zero("inertia of the grip in kg·mm²", inertia)?;
        not_negative("damping of the grip in N·s/mm", damping)?;
        not_negative("rotational damping of the grip in N·mm·s/rad", turning_damping)?;
        not_negative("stiffness of the grip in N/mm", stiffness)?;
        not_negative("rotational stiffness of the grip in N·mm/rad", turning)
    }
}

impl Tremor {
    /// Checks the settings. The filter resonates at the frequency, so it must not exceed half the loop's
    /// rate.
    pub(super) fn check(&self, period: f64) -> Result<(), SettingError> {
        not_negative("size of the tremor in mm", self.size)?;
        let is_valid = self.frequency > 0.0 && self.frequency * period <= 0.5;
        let what = "frequency of the tremor in Hz";
        check(is_valid, what, self.frequency, "a number above 0, up to half the rate")
    }
}
