//! Programs out: as APT-CL and as tables, so that what is read back is what was written.
//!
//! Numbers are the shortest decimals that give the same bits back, without exponents, which not every
//! post-processor reads. A tip comes back as it was; an axis is normalised once more when it is read, which
//! may move its parts by a unit of roundoff.

use super::Program;
use super::csv::{END, HEAD};
use crate::pose::Pose;
use crate::tool::{Card, Piece};
use crate::unit::Unit;
use std::fmt::{self, Display, Formatter};
use std::io::{self, Write};

/// What a program cannot be written for.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// APT-CL has no word for the unit.
    #[error("APT-CL has no word for {unit}: write the program in mm or inch, or as a table")]
    Unit {
        /// The program's unit.
        unit: Unit,
    },
    /// The part's name would end the line that it stands in.
    #[error("the part's name {name:?} has a line break or a control character: leave that out")]
    Part {
        /// The name.
        name: String,
    },
    /// The output could not be written.
    #[error("the program could not be written whole: {0}")]
    Output(#[from] io::Error),
}

/// What stands before the positions of an APT-CL program.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Heading<'a> {
    /// What `PARTNO` says; nothing is written for an empty one.
    pub part: &'a str,
    /// What `CUTTER` says, in the program's unit.
    pub cutter: Option<Cutter>,
}

/// A cutter as APT's `CUTTER/diameter,radius` describes it, in the program's unit: a flat end with rounded
/// corners below a cylinder. A ball's corners have half its diameter, an end mill's 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cutter {
    /// Its diameter.
    pub diameter: f64,
    /// The radius of its corners.
    pub corner: f64,
}

impl Cutter {
    /// A tool's cutting end in a unit of length; `None` where two numbers do not describe it: no profile, or
    /// one that does not begin with a flat end, a rounded corner, a straight flute, or those of them that
    /// there are. What comes above the first surface that does not cut says nothing.
    pub fn of(card: &Card, unit: Unit) -> Option<Cutter> {
        let cutting = |piece: &&Piece| card.surfaces[piece.surface].cutting;
        let mut pieces = card.outline.iter().take_while(cutting).peekable();
        let (mut at, mut corner) = ([0.0; 2], 0.0);
        pieces.peek().filter(|piece| piece.from == at)?;
        if let Some(face) = pieces.next_if(|p| p.circle.is_none() && p.from[1] == p.to[1]) {
            at = face.to;
        }
        if let Some(piece) = pieces.next_if(|piece| piece.circle.is_some()) {
            let circle = piece.circle?;
            let round = circle.convex
                && near(circle.centre, [at[0], at[1] + circle.radius])
                && near(piece.to, [at[0] + circle.radius, at[1] + circle.radius]);
            (at, corner) = round.then_some((piece.to, circle.radius))?;
        }
        let straight = pieces.all(|piece| piece.circle.is_none() && near_by(piece.to[0], at[0]));
        let length = card.unit.to(unit);
        let is_one = straight && at[0] > 0.0;
        is_one.then_some(Cutter { diameter: 2.0 * at[0] * length, corner: corner * length })
    }
}

fn near(one: [f64; 2], other: [f64; 2]) -> bool {
    near_by(one[0], other[0]) && near_by(one[1], other[1])
}

/// Whether two lengths of a profile differ by no more than its constants were rounded.
fn near_by(one: f64, other: f64) -> bool {
    (one - other).abs() <= 1e-12 * (one.abs() + other.abs())
}

/// A statement that is longer is continued on the next line: cards had so many columns for it.
const COLUMNS: usize = 72;

/// The word that APT-CL has for a unit.
///
/// # Errors
/// It has none for metres.
pub fn apt_word(unit: Unit) -> Result<&'static str, WriteError> {
    match unit {
        Unit::Millimetre => Ok("MM"),
        Unit::Inch => Ok("INCHES"),
        Unit::Metre => Err(WriteError::Unit { unit }),
    }
}

impl Program {
    /// Writes the program as APT-CL: `PARTNO`, `UNITS` where the unit is known, `MULTAX/ON`, `CUTTER`, a `GOTO`
    /// for each stop, `RAPID` before those that are reached in rapid traverse, `FINI`. Spins that were given
    /// are not written, since APT has none.
    ///
    /// # Errors
    /// If the unit is the metre, the part's name is no line of text, or `out` fails.
    pub fn write_apt(&self, out: &mut impl Write, heading: &Heading<'_>) -> Result<(), WriteError> {
        let unit = self.unit.map(apt_word).transpose()?;
        if heading.part.contains(char::is_control) {
            return Err(WriteError::Part { name: heading.part.to_owned() });
        }
        if !heading.part.is_empty() {
            writeln!(out, "PARTNO/{}", heading.part)?;
        }
        if let Some(unit) = unit {
            writeln!(out, "UNITS/{unit}")?;
        }
        writeln!(out, "MULTAX/ON")?;
        if let Some(Cutter { diameter, corner }) = heading.cutter {
            writeln!(out, "CUTTER/{diameter},{corner}")?;
        }
        for stop in &self.stops {
            if stop.rapid {
                writeln!(out, "RAPID")?;
            }
            writeln!(out, "{}", statement(&stop.pose))?;
        }
        writeln!(out, "FINI")?;
        Ok(())
    }

    /// Writes the program as a table with a row of names: `x,y,z,i,j,k`, or, where the spin of every pose was
    /// given, `x,y,z,qx,qy,qz,qw`. A table says neither its unit nor which motions are rapid. Its first line, a
    /// comment, says that it ends with an end mark, so that no reader here takes a part of it for the whole.
    ///
    /// # Errors
    /// If `out` fails.
    pub fn write_csv(&self, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "{HEAD}")?;
        let full = self.stops.iter().all(|stop| stop.pose.is_full());
        writeln!(out, "{}", if full { "x,y,z,qx,qy,qz,qw" } else { "x,y,z,i,j,k" })?;
        for stop in &self.stops {
            let Place(tip, axis) = Place::of(&stop.pose);
            if full {
                let turn = stop.pose.isometry().rotation.coords;
                writeln!(out, "{},{}", Listed(&tip), Listed(&[turn.x, turn.y, turn.z, turn.w]))?;
            } else {
                writeln!(out, "{},{}", Listed(&tip), Listed(&axis))?;
            }
        }
        writeln!(out, "{END}")
    }
}

/// `GOTO/x,y,z,i,j,k`, continued where a line would have too many columns.
fn statement(pose: &Pose) -> String {
    let Place(tip, axis) = Place::of(pose);
    let mut statement = String::from("GOTO/");
    let mut columns = statement.len();
    for (k, number) in tip.iter().chain(&axis).enumerate() {
        let number = format!("{number}{}", if k < 5 { "," } else { "" });
        if columns + number.len() >= COLUMNS {
            statement.push_str("$\n");
            columns = 0;
        }
        columns += number.len();
        statement.push_str(&number);
    }
    statement
}

/// A pose's tip and axis.
struct Place([f64; 3], [f64; 3]);

impl Place {
    fn of(pose: &Pose) -> Place {
        Place(pose.tip().into(), pose.axis().into())
    }
}

/// Numbers with commas between them.
struct Listed<'a>(&'a [f64]);

impl Display for Listed<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for (k, number) in self.0.iter().enumerate() {
            write!(f, "{}{number}", if k == 0 { "" } else { "," })?;
        }
        Ok(())
    }
}
