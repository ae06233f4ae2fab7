//! Writing of programs, as APT-CL and as tables, so that reading gives back what was written.
//!
//! Numbers are the shortest decimals that give back the same bits, without exponents, since not every
//! post-processor reads those. A tip is read back exactly. An axis is normalised once more when it is read,
//! which may change its components by a unit of roundoff. APT-CL can also be rounded to [`Decimals`].

use super::ClData;
use super::csv::{END_COLUMN, END_MARK};
use super::cutter::Cutter;
use crate::codes::faults;
use std::fmt::{self, Display, Formatter};
use std::io::{self, Write};
use touchoff::{Pose, Unit};

faults! {
    #[family("P07", "Programs that cannot be written")]
    /// A reason for which a program cannot be written.
    #[derive(thiserror::Error)]
    #[non_exhaustive]
    pub enum WriteError {
        /// APT-CL has no word for the unit.
        #[code = P0701]
        #[error("APT-CL has no word for {unit}: write the program in mm or inch, or as a table")]
        Unit {
            /// The program's unit.
            unit: Unit,
        },
        /// The part's name contains a control character, such as a line break.
        #[code = P0702]
        #[error("the part's name {name:?} has a line break or a control character: leave that out")]
        Part {
            /// The name.
            name: String,
        },
        /// A feed or a spindle speed is not finite or not above 0.
        #[code = P0703]
        #[error("{what} of {value} is not a rate above 0: give one per minute")]
        Rate {
            /// The name of the rate.
            what: &'static str,
            /// The given value.
            value: f64,
        },
        /// A feed is given, and the unit of the program is unknown.
        #[code = P0704]
        #[error("a feed needs the program's unit: state the unit of the program, or write no feed")]
        FeedUnit,
        /// The output could not be written.
        #[code = P0705]
        #[error("the program could not be written whole: {0}")]
        Output(#[from] io::Error),
    }
}

/// The statements before the positions of an APT-CL program, and the decimals of the positions. Nothing is
/// written for a statement that is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AptHeader<'a> {
    /// The text of `PARTNO`. Nothing is written for an empty one.
    pub part: &'a str,
    /// The number of the tool, for `LOADTL`.
    pub tool_number: Option<u32>,
    /// The arguments of `CUTTER`, in the program's unit.
    pub cutter: Option<Cutter>,
    /// The spindle speed in revolutions per minute, clockwise, for `SPINDL`.
    pub spindle: Option<f64>,
    /// The feed per minute, in the program's unit, for `FEDRAT`.
    pub feed: Option<f64>,
    /// The decimals to which positions are rounded; `None` for the shortest that give back the same bits.
    pub decimals: Option<Decimals>,
}

/// Columns of a line, as on a punched card. A longer statement is continued on the next line.
const MAX_COLUMNS: usize = 72;

/// Returns APT-CL's word for a unit.
///
/// # Errors
/// If the unit is the metre, for which APT-CL has no word.
pub fn apt_unit(unit: Unit) -> Result<&'static str, WriteError> {
    match unit {
        Unit::Millimetre => Ok("MM"),
        Unit::Inch => Ok("INCHES"),
        Unit::Metre => Err(WriteError::Unit { unit }),
    }
}

/// Returns the word of APT-CL for a feed per minute in a unit.
fn feed_unit(unit: Option<Unit>) -> Result<&'static str, WriteError> {
    match unit {
        Some(Unit::Millimetre) => Ok("MMPM"),
        Some(Unit::Inch) => Ok("IPM"),
        Some(unit @ Unit::Metre) => Err(WriteError::Unit { unit }),
        None => Err(WriteError::FeedUnit),
    }
}

impl ClData {
    /// Writes the program as APT-CL: `PARTNO`, `UNITS` if the unit is known, `MULTAX/ON`, `LOADTL`, `CUTTER`,
    /// `SPINDL`, `FEDRAT`, one `GOTO` per cutter location, `RAPID` before those that are reached in rapid
    /// traverse, `FINI`. Spins are not written, since APT has none.
    ///
    /// # Errors
    /// If the unit is the metre, if the part's name contains a control character, if a rate is not above 0 or
    /// a feed has no unit, or if `out` fails.
    pub fn write_apt(
        &self,
        out: &mut impl Write,
        heading: &AptHeader<'_>,
    ) -> Result<(), WriteError> {
        let unit = self.unit.map(apt_unit).transpose()?;
        if heading.part.contains(char::is_control) {
            return Err(WriteError::Part { name: heading.part.to_owned() });
        }
        for (what, rate) in [("a feed", heading.feed), ("a spindle speed", heading.spindle)] {
            if let Some(value) = rate.filter(|rate| !(*rate > 0.0 && rate.is_finite())) {
                return Err(WriteError::Rate { what, value });
            }
        }
        let feed_unit = heading.feed.map(|_| feed_unit(self.unit)).transpose()?;
        if !heading.part.is_empty() {
            writeln!(out, "PARTNO/{}", heading.part)?;
        }
        if let Some(unit) = unit {
            writeln!(out, "UNITS/{unit}")?;
        }
        writeln!(out, "MULTAX/ON")?;
        if let Some(number) = heading.tool_number {
            writeln!(out, "LOADTL/{number}")?;
        }
        if let Some(Cutter { diameter, corner }) = heading.cutter {
            writeln!(out, "CUTTER/{diameter},{corner}")?;
        }
        if let Some(speed) = heading.spindle {
            writeln!(out, "SPINDL/{speed},CLW")?;
        }
        if let Some((feed, unit)) = heading.feed.zip(feed_unit) {
            writeln!(out, "FEDRAT/{feed},{unit}")?;
        }
        for location in &self.locations {
            if location.rapid {
                writeln!(out, "RAPID")?;
            }
            writeln!(out, "{}", statement(&location.pose, heading.decimals))?;
        }
        writeln!(out, "FINI")?;
        Ok(())
    }

    /// Writes the program as a table with a row of names: `x,y,z,i,j,k,end`, or `x,y,z,qx,qy,qz,qw,end` if every pose
    /// has a given spin. A table states neither its unit nor which motions are rapid. The column `end` is empty but in the last row,
    /// so that a reader of this library never takes a truncated table for the whole.
    ///
    /// # Errors
    /// If `out` fails.
    pub fn write_csv(&self, out: &mut impl Write) -> io::Result<()> {
        let has_spin = self.locations.iter().all(|location| location.pose.has_spin());
        let columns = if has_spin { "x,y,z,qx,qy,qz,qw" } else { "x,y,z,i,j,k" };
        writeln!(out, "{columns},{END_COLUMN}")?;
        for (index, location) in self.locations.iter().enumerate() {
            let mark = if index + 1 == self.locations.len() { END_MARK } else { "" };
            let TipAxis(tip, axis) = TipAxis::of(&location.pose);
            if has_spin {
                let turn = location.pose.to_isometry().rotation.coords;
                let turn = [turn.x, turn.y, turn.z, turn.w];
                writeln!(out, "{},{},{mark}", Listed(&tip), Listed(&turn))?;
            } else {
                writeln!(out, "{},{},{mark}", Listed(&tip), Listed(&axis))?;
            }
        }
        Ok(())
    }
}

/// Formats `GOTO/x,y,z,i,j,k`, continued where a line would have too many columns.
fn statement(pose: &Pose, decimals: Option<Decimals>) -> String {
    let TipAxis(tip, axis) = TipAxis::of(pose);
    let mut statement = String::from("GOTO/");
    let mut columns = statement.len();
    for (k, number) in tip.iter().chain(&axis).enumerate() {
        let number = match decimals {
            None => number.to_string(),
            Some(Decimals { tip, .. }) if k < 3 => rounded(*number, tip),
            Some(Decimals { axis, .. }) => rounded(*number, axis),
        };
        let number = format!("{number}{}", if k < 5 { "," } else { "" });
        // The `$` takes a column, too.
        if columns + number.len() >= MAX_COLUMNS {
            statement.push_str("$\n");
            columns = 0;
        }
        columns += number.len();
        statement.push_str(&number);
    }
    statement
}

/// The tip and the axis of a pose.
struct TipAxis([f64; 3], [f64; 3]);

impl TipAxis {
    fn of(pose: &Pose) -> TipAxis {
        TipAxis(pose.tip().into(), pose.axis().into())
    }
}

/// Displays numbers separated by commas.
struct Listed<'a>(&'a [f64]);

impl Display for Listed<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for (k, number) in self.0.iter().enumerate() {
            write!(f, "{}{number}", if k == 0 { "" } else { "," })?;
        }
        Ok(())
    }
}

/// Numbers of decimals to which a program is rounded. A coordinate changes by at most half a unit of its last
/// decimal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decimals {
    /// Decimals of the tip's coordinates, in the program's unit.
    pub tip: usize,
    /// Decimals of the components of the tool axis, a unit vector.
    pub axis: usize,
}

impl Decimals {
    /// Returns the decimals that suit a unit: tips to 1e-5 mm, 1e-7 inch or 1e-8 m, axes to 1e-9. Such an axis
    /// errs by less than 1e-9 rad, which is 3e-7 mm at 300 mm from the tip.
    pub fn of(unit: Unit) -> Decimals {
        let tip = match unit {
            Unit::Millimetre => 5,
            Unit::Inch => 7,
            Unit::Metre => 8,
        };
        Decimals { tip, axis: 9 }
    }
}

/// Formats a number with at most the given decimals, without exponent, trailing zeros, and the sign of zero.
fn rounded(number: f64, decimals: usize) -> String {
    let fixed = format!("{number:.decimals$}");
    let short = match fixed.contains('.') {
        true => fixed.trim_end_matches('0').trim_end_matches('.'),
        false => &fixed,
    };
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn rounds_without_exponent_trailing_zeros_and_negative_zero() {
        for (number, decimals, text) in [
            (12.345_678, 5, "12.34568"),
            (-0.000_004, 5, "0"),
            (-0.000_006, 5, "-0.00001"),
            (100.0, 5, "100"),
            (1e9, 0, "1000000000"),
            (0.1 + 0.2, 9, "0.3"),
            (-1.0, 9, "-1"),
        ] {
            assert_eq!(rounded(number, decimals), text);
        }
    }
}
