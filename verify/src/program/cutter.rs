//! The cutter that a program states, compared with the tool at hand.

use super::{ClData, ProgramError};
use touchoff::Unit;
use touchoff::tool::ToolInfo;

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
        let mut segments = info
            .outline
            .iter()
            .take_while(|segment| info.surface(segment.surface).cutting)
            .peekable();
        let (mut corner_end, mut corner) = ([0.0; 2], 0.0);
        // The end begins at the tip, on the axis.
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

fn joined(numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
    numbers.join(",")
}

/// Tolerance of lengths as a fraction of the diameter, and of angles in radians: cutters are written with few digits.
const ROUNDED: f64 = 1e-3;

impl ClData {
    /// Compares the arguments of APT's `CUTTER`, and of NX's `TLDATA/MILL`, with a tool. `part` is the unit of
    /// a program that states none. Returns the line of a `CUTTER` that cannot be compared because two numbers
    /// do not describe the tool (see [`Cutter::of`]).
    ///
    /// `CUTTER/d,r,e,f,a,b,h` is the diameter, the radius of the corner, the distances of its centre from the
    /// axis and from the tip, the angles of end and side in degrees, and the height. Those of the first six
    /// that are given are compared, but for a centre of 0, which states none.
    ///
    /// # Errors
    /// If a stated cutter is not the tool's.
    pub fn check_cutter(&self, info: &ToolInfo, part: Unit) -> Result<Option<usize>, ProgramError> {
        let unit = self.unit.unwrap_or(part);
        let Some((first, _)) = self.cutters.first() else { return Ok(None) };
        let Some(Cutter { diameter, corner }) = Cutter::of(info, unit) else {
            return Ok(Some(*first));
        };
        // The end of such a cutter is across the axis and its side along it: both angles are 0.
        let expected = [diameter, corner, 0.5 * diameter - corner, corner, 0.0, 0.0];
        let lengths = [ROUNDED * diameter; 4];
        let tolerances = lengths.into_iter().chain([ROUNDED.to_degrees(); 2]);
        let other = self.cutters.iter().find(|(_, stated)| {
            // Autodesk's post processors state the corner's centre as 0, or on the axis, whatever the cutter.
            let is_unstated = matches!(stated[..], [_, r, 0.0, z, ..] if z == 0.0 || z == r);
            let pairs = stated.iter().zip(&expected).zip(tolerances.clone()).enumerate();
            pairs
                .filter(|(at, _)| !(is_unstated && matches!(at, 2 | 3)))
                .any(|(_, ((stated, expected), tolerance))| (stated - expected).abs() > tolerance)
        });
        let Some((line, stated)) = other else { return Ok(None) };
        // The arguments after those that are stated would explain nothing, and two always describe the tool.
        let shown = stated.len().clamp(2, expected.len());
        Err(ProgramError::Cutter {
            file: self.file.clone(),
            line: *line,
            stated: joined(stated),
            tool: info.name.to_string(),
            expected: joined(&expected[..shown]),
            unit,
        })
    }
}
