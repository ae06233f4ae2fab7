//! Rates of APT-CL: the feed, the speed of the spindle, and delays, from which the time of motions follows.
//!
//! A number and the word of its unit are read in either order, since CAM systems write both: `FEDRAT/600,MMPM`,
//! `FEDRAT/MMPM,600`. A statement that is written otherwise leaves its rate unknown: without a unit, post-processors differ in what
//! a number means.

use super::number;
use touchoff::Unit;

/// A feed of the tip along its path.
#[derive(Clone, Copy)]
enum FeedRate {
    /// In millimetres per minute.
    PerMinute(f64),
    /// In millimetres per turn of the spindle.
    PerTurn(f64),
}

/// The rates in force, as far as they are known.
#[derive(Default)]
pub(super) struct Rates {
    feed: Option<FeedRate>,
    /// Turns of the spindle per minute.
    spindle: Option<f64>,
}

impl Rates {
    /// Reads a statement that changes a rate. Returns whether it states one: any other leaves the rate unknown, or concerns none.
    pub(super) fn read(&mut self, word: &str, arguments: &str) -> bool {
        match word {
            "FEDRAT" => {
                self.feed = feed_rate(arguments);
                self.feed.is_some()
            }
            // Slows down before a position, at a distance of the post-processor's.
            "FEDTO" => {
                self.feed = None;
                false
            }
            "SPINDL" => {
                self.spindle = match arguments.to_ascii_uppercase().as_str() {
                    // It turns at the speed that was stated, if that is known.
                    "ON" => self.spindle,
                    _ => spindle_speed(arguments),
                };
                self.spindle.is_some()
            }
            _ => false,
        }
    }

    /// Returns the feed in millimetres per minute.
    pub(super) fn feed(&self) -> Option<f64> {
        match self.feed? {
            FeedRate::PerMinute(feed) => Some(feed),
            FeedRate::PerTurn(feed) => Some(feed * self.spindle?),
        }
    }

    /// Returns the seconds of a delay: of `DELAY/t`, or of `DELAY/n,REV` at the speed of the spindle.
    pub(super) fn delay(&self, arguments: &str) -> Option<f64> {
        if let Ok(seconds) = number(arguments) {
            return (seconds >= 0.0).then_some(seconds);
        }
        let (turns, unit) = with_unit(arguments)?;
        (unit == "REV").then_some(60.0 * turns / self.spindle?)
    }
}

/// Returns the feed of `FEDRAT`; `None` if it has no unit, or is stated in another way (`INVERS`).
fn feed_rate(arguments: &str) -> Option<FeedRate> {
    let (feed, unit) = with_unit(arguments)?;
    let inch = Unit::Inch.millimetres();
    Some(match unit.as_str() {
        "MMPM" => FeedRate::PerMinute(feed),
        "IPM" => FeedRate::PerMinute(inch * feed),
        "MMPR" => FeedRate::PerTurn(feed),
        "IPR" => FeedRate::PerTurn(inch * feed),
        _ => return None,
    })
}

/// Returns the turns per minute of `SPINDL/n,RPM`, with the direction after it or not; `None` of a speed at the surface (`SFM`) and
/// of a spindle that stands.
fn spindle_speed(arguments: &str) -> Option<f64> {
    let upper = arguments.to_ascii_uppercase();
    let speed = match upper.rsplit_once(',') {
        Some((speed, direction)) if matches!(direction.trim(), "CLW" | "CCLW") => speed,
        _ => &upper,
    };
    let (turns, unit) = with_unit(speed)?;
    (unit == "RPM").then_some(turns)
}

/// Returns a number above 0 and the word of its unit, which stand in either order.
fn with_unit(arguments: &str) -> Option<(f64, String)> {
    let (first, second) = arguments.split_once(',')?;
    let (value, unit) = match number(first) {
        Ok(value) => (value, second),
        Err(_) => (number(second).ok()?, first),
    };
    (value > 0.0).then(|| (value, unit.trim().to_ascii_uppercase()))
}
