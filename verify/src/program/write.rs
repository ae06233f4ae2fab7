//! Writing of programs, as APT-CL and as tables, so that reading gives back what was written.
//!
//! Numbers are the shortest decimals that give back the same bits, without exponents, since not every
//! post-processor reads those. A tip is read back exactly. An axis is normalised once more when it is read,
//! which may change its components by a unit of roundoff. APT-CL can also be rounded to [`Decimals`].

use super::ClData;
use super::csv::{END, HEAD};
use super::decimals::{Decimals, rounded};
use std::fmt::{self, Display, Formatter};
use std::io::{self, Write};
use touchoff::tool::{ProfileSegment, ToolInfo};
use touchoff::{Pose, Unit};

/// A reason for which a program cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// APT-CL has no word for the unit.
    #[error("APT-CL has no word for {unit}: write the program in mm or inch, or as a table")]
    Unit {
        /// The program's unit.
        unit: Unit,
    },
    /// The part's name contains a control character, such as a line break.
    #[error("the part's name {name:?} has a line break or a control character: leave that out")]
    Part {
        /// The name.
        name: String,
    },
    /// A feed or a spindle speed is not finite or not above 0.
    #[error("{what} of {value} is not a rate above 0: give one per minute")]
    Rate {
        /// The name of the rate.
        what: &'static str,
        /// The given value.
        value: f64,
    },
    /// A feed is given, and the unit of the program is unknown.
    #[error("a feed needs the program's unit: state the unit of the program, or write no feed")]
    FeedUnit,
    /// The output could not be written.
    #[error("the program could not be written whole: {0}")]
    Output(#[from] io::Error),
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

/// A cutter as described by APT's `CUTTER/diameter,radius`, in the program's unit: a flat end with rounded
/// corners below a cylinder. The corner radius is half the diameter for a ball, and 0 for an end mill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cutter {
    /// The diameter.
    pub diameter: f64,
    /// The radius of the corners.
    pub corner: f64,
}

impl Cutter {
    /// Returns the cutting end of a tool in a unit of length; `None` if two numbers do not describe it. The
    /// profile has to begin with a flat end, a rounded corner and a straight flute, or with some of them in
    /// this order. Above the first surface that does not cut it may have any shape. A tool without a profile
    /// has no cutter.
    pub fn of(info: &ToolInfo, unit: Unit) -> Option<Cutter> {
        let cutting = |segment: &&ProfileSegment| info.surface(segment.surface).cutting;
        let mut segments = info.outline.iter().take_while(cutting).peekable();
        let (mut corner_end, mut corner) = ([0.0; 2], 0.0);
        segments.peek().filter(|segment| segment.from == corner_end)?;
        if let Some(face) = segments.next_if(|p| p.circle.is_none() && p.from[1] == p.to[1]) {
            corner_end = face.to;
        }
        if let Some(segment) = segments.next_if(|segment| segment.circle.is_some()) {
            let circle = segment.circle?;
            let round = circle.convex
                && points_agree(circle.centre, [corner_end[0], corner_end[1] + circle.radius])
                && points_agree(
                    segment.to,
                    [corner_end[0] + circle.radius, corner_end[1] + circle.radius],
                );
            (corner_end, corner) = round.then_some((segment.to, circle.radius))?;
        }
        let straight = segments
            .all(|segment| segment.circle.is_none() && agrees(segment.to[0], corner_end[0]));
        let length = info.unit.factor_to(unit);
        let is_one = straight && corner_end[0] > 0.0;
        is_one.then_some(Cutter { diameter: 2.0 * corner_end[0] * length, corner: corner * length })
    }
}

fn points_agree(one: [f64; 2], other: [f64; 2]) -> bool {
    agrees(one[0], other[0]) && agrees(one[1], other[1])
}

/// Returns whether two lengths of a profile differ by no more than the rounding of its constants.
fn agrees(one: f64, other: f64) -> bool {
    (one - other).abs() <= 1e-12 * (one.abs() + other.abs())
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

    /// Writes the program as a table with a row of names: `x,y,z,i,j,k`, or `x,y,z,qx,qy,qz,qw` if every pose
    /// has a given spin. A table states neither its unit nor which motions are rapid. Its first line, a
    /// comment, announces an end mark, so that a reader of this library never takes a truncated table for the
    /// whole.
    ///
    /// # Errors
    /// If `out` fails.
    pub fn write_csv(&self, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "{HEAD}")?;
        let has_spin = self.locations.iter().all(|location| location.pose.has_spin());
        writeln!(out, "{}", if has_spin { "x,y,z,qx,qy,qz,qw" } else { "x,y,z,i,j,k" })?;
        for location in &self.locations {
            let TipAxis(tip, axis) = TipAxis::of(&location.pose);
            if has_spin {
                let turn = location.pose.to_isometry().rotation.coords;
                writeln!(out, "{},{}", Listed(&tip), Listed(&[turn.x, turn.y, turn.z, turn.w]))?;
            } else {
                writeln!(out, "{},{}", Listed(&tip), Listed(&axis))?;
            }
        }
        writeln!(out, "{END}")
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
