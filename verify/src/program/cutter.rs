//! The cutter that a program states, compared with the tool at hand.

use super::{ClData, ProgramError};
use touchoff::Unit;
use touchoff::tool::{ProfileSegment, ToolInfo};

/// A cutter that a program states, in the program's unit.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StatedCutter {
    /// The line of the statement, 1-based.
    pub(super) line: usize,
    pub(super) stated: Stated,
}

/// The statement of a cutter.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Stated {
    /// The arguments of `CUTTER`, one at least.
    Form(Vec<f64>),
    /// The diameter alone.
    Diameter(f64),
    /// A kind that is not read.
    Other,
}

impl Stated {
    fn numbers(&self) -> &[f64] {
        match self {
            Stated::Form(form) => form,
            Stated::Diameter(diameter) => std::slice::from_ref(diameter),
            Stated::Other => &[],
        }
    }
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
    /// Compares the cutters that APT states with a tool: `CUTTER`, also in comments of Creo, and NX's `TLDATA`. `part` is the unit of
    /// a program that states none. Returns the line of a cutter of which no more than the diameter is compared, because two numbers do
    /// not describe the tool (see [`Cutter::of`]) or because its kind is not read.
    ///
    /// `CUTTER/d,r,e,f,a,b,h` is the diameter, the radius of the corner, the distances of its centre from the
    /// axis and from the tip, the angles of end and side in degrees, and the height. Those of the first six
    /// that are given are compared, but for a centre of 0, which states none. A corner that is left out is 0 (ISO 3592), but in Creo,
    /// which states the diameter alone. That of a drill or T cutter of NX is compared, too: it has to be one of the tool's.
    ///
    /// # Errors
    /// If a stated cutter is not the tool's.
    pub fn check_cutter(&self, info: &ToolInfo, part: Unit) -> Result<Option<usize>, ProgramError> {
        let unit = self.unit.unwrap_or(part);
        let cutter = Cutter::of(info, unit);
        let mut not_compared = None;
        for StatedCutter { line, stated } in &self.cutters {
            let other = match (stated, cutter) {
                (Stated::Form(form), Some(cutter)) => cutter.other_form(form),
                (Stated::Form(form), None) => {
                    not_compared = not_compared.or(Some(*line));
                    // A diameter beside angles is where end and side intersect, and need not be one of the tool's.
                    let is_inclined = form.iter().skip(4).take(2).any(|angle| *angle != 0.0);
                    other_diameter(info, unit, form[0]).filter(|_| !is_inclined)
                }
                (Stated::Diameter(diameter), _) => other_diameter(info, unit, *diameter),
                (Stated::Other, _) => {
                    not_compared = not_compared.or(Some(*line));
                    None
                }
            };
            if let Some(expected) = other {
                return Err(ProgramError::Cutter {
                    file: self.file.clone(),
                    line: *line,
                    stated: joined(stated.numbers()),
                    tool: info.name.to_string(),
                    expected: joined(&expected),
                    unit,
                });
            }
        }
        Ok(not_compared)
    }
}

impl Cutter {
    /// Returns the arguments of `CUTTER` that describe the cutter, if a program states others.
    fn other_form(self, stated: &[f64]) -> Option<Vec<f64>> {
        let Cutter { diameter, corner } = self;
        // The end of such a cutter is across the axis and its side along it: both angles are 0.
        let expected = [diameter, corner, 0.5 * diameter - corner, corner, 0.0, 0.0];
        let lengths = [ROUNDED * diameter; 4];
        let tolerances = lengths.into_iter().chain([ROUNDED.to_degrees(); 2]);
        // Autodesk's post processors state the corner's centre as 0, or on the axis, whatever the cutter.
        let is_unstated = matches!(stated, [_, r, 0.0, z, ..] if *z == 0.0 || z == r);
        // A corner that is left out is 0.
        let compared = stated.len().clamp(2, expected.len());
        let stated = stated.iter().copied().chain([0.0]).take(compared);
        let mut pairs = stated.zip(expected).zip(tolerances).enumerate();
        let is_other = pairs.any(|(at, ((stated, expected), tolerance))| {
            !(is_unstated && matches!(at, 2 | 3)) && (stated - expected).abs() > tolerance
        });
        is_other.then(|| expected[..compared].to_vec())
    }
}

/// Returns the greatest diameter of a tool's cutting surfaces, if a stated one is none of theirs.
fn other_diameter(info: &ToolInfo, unit: Unit, stated: f64) -> Option<Vec<f64>> {
    let length = info.unit.factor_to(unit);
    let mut diameters = cutting_radii(info).map(|radius| 2.0 * length * radius);
    let widest = diameters.clone().reduce(f64::max)?;
    let is_one = diameters.any(|diameter| (diameter - stated).abs() <= ROUNDED * stated);
    (!is_one).then_some(vec![widest])
}

/// Returns the radii of the cutting surfaces of a tool with a profile, at their ends and in the middle of arcs, which may be wider, in its
/// unit.
pub(crate) fn cutting_radii(info: &ToolInfo) -> impl Iterator<Item = f64> + Clone {
    let cutting = info.outline.iter().filter(|segment| info.surface(segment.surface).cutting);
    cutting.flat_map(|segment| {
        [Some(segment.from[0]), Some(segment.to[0]), middle(segment)].into_iter().flatten()
    })
}

/// Returns the greatest radius of an arc beyond its ends, as of a lollipop mill.
fn middle(segment: &ProfileSegment) -> Option<f64> {
    let circle = segment.circle.filter(|circle| circle.convex)?;
    let [low, high] = [segment.from[1].min(segment.to[1]), segment.from[1].max(segment.to[1])];
    (low..=high).contains(&circle.centre[1]).then_some(circle.centre[0] + circle.radius)
}
