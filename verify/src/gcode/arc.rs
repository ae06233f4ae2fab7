//! Arcs: centre, sweep and the check of radii.

use super::modal::centre_letters;
use super::{Plane, Position, StepPath};
use std::f64::consts::{SQRT_2, TAU};
use touchoff::Unit;

/// A fault in an arc.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ArcFault {
    /// Neither a centre nor a radius.
    #[error("the arc has neither a centre nor a radius: write {centre}, or R")]
    NoCentre {
        /// The letters of the centre.
        centre: &'static str,
    },
    /// A centre and a radius.
    #[error("the arc has a centre and a radius: write one of them")]
    CentreAndRadius,
    /// A coordinate of the centre that is not in the plane of the arc.
    #[error("{letter} is not in the plane of the arc: write {centre}, or select another plane")]
    OtherPlane {
        /// The letter.
        letter: char,
        /// The letters of the centre.
        centre: &'static str,
    },
    /// An absolute centre (G90.1) with one coordinate.
    #[error("under G90.1 the centre needs both coordinates: write {centre}")]
    HalfCentre {
        /// The letters of the centre.
        centre: &'static str,
    },
    /// Start and end have different distances from the centre.
    #[error(
        "start and end have the distances {start} and {end} (mm) from the centre, which differ by more than \
         {tolerance:.4}: correct the end or the centre"
    )]
    Radii {
        /// Distance of the start, in millimetres.
        start: f64,
        /// Distance of the end, in millimetres.
        end: f64,
        /// The tolerance, in millimetres.
        tolerance: f64,
    },
    /// A centre on the start or the end, or a radius of zero.
    #[error("the arc has the radius zero: correct its centre or its radius")]
    ZeroRadius,
    /// A radius that does not reach the end.
    #[error(
        "the radius {radius} is less than half the distance from start to end, {half} (mm): correct it"
    )]
    TooShort {
        /// The radius, in millimetres.
        radius: f64,
        /// Half of the chord, in millimetres.
        half: f64,
    },
    /// A radius with an end that is the start.
    #[error("the arc ends where it starts, so its radius leaves the centre open: write {centre}")]
    SamePoint {
        /// The letters of the centre.
        centre: &'static str,
    },
}

/// Words of an arc, lengths in millimetres.
#[derive(Clone, Copy, Debug)]
pub(super) struct ArcWords {
    pub(super) clockwise: bool,
    pub(super) plane: Plane,
    /// Numbers after I, J and K.
    pub(super) offsets: [Option<f64>; 3],
    /// Set by G90.1: I J K are coordinates, not distances from the start.
    pub(super) absolute: bool,
    pub(super) radius: Option<f64>,
    /// Number of turns, a begun one included.
    pub(super) turns: u32,
    /// The unit of the program, in which the tolerances are defined.
    pub(super) unit: Unit,
}

/// Distance below which start and end are the same point, in millimetres. It is a hundredth of the least
/// increment of a control, and far above the rounding of a position.
const SAME_POINT: f64 = 1e-5;
/// Smallest radius, in millimetres.
const LEAST_RADIUS: f64 = 1e-7;
/// Largest relative difference of the radii of start and end: LinuxCNC's.
const RELATIVE_TOLERANCE: f64 = 1e-3;
/// LinuxCNC's absolute tolerance is a hundred times as large as the one that it allows beyond the relative
/// one.
const LARGEST_FACTOR: f64 = 100.0;

/// Returns the difference of radii that is always allowed, in millimetres. A centre that is rounded to 0.01
/// mm or 0.001 inch in both coordinates differs by as much (LinuxCNC's `CENTER_ARC_RADIUS_TOLERANCE`).
fn radius_tolerance(unit: Unit) -> f64 {
    match unit {
        Unit::Inch => 2.0 * 0.001 * SQRT_2 * Unit::Inch.millimetres(),
        _ => 2.0 * 0.01 * SQRT_2,
    }
}

/// Returns the largest excess of half the chord over a radius R, in millimetres: LinuxCNC's 0.00005 inch.
const CHORD_TOLERANCE: f64 = 0.00005 * 25.4;

/// Computes the path of an arc between two positions in program coordinates.
///
/// The arc is in the plane's coordinates (first axis, second axis), in which a positive sweep is from the
/// first to the second. With a centre, an end within 1e-5 mm of the start is a full circle. With a radius R,
/// the sweep is at most half a turn for R > 0, and at least half a turn for R < 0. Near half a turn, the
/// centre is ill-conditioned: an error δ of the end moves it by up to √(2 R δ). With a centre, the sweep of
/// one turn is within 2⁻⁴⁹ (1 + D / r) of exact, for the radius r and the largest coordinate D.
pub(super) fn path(words: &ArcWords, start: Position, end: Position) -> Result<StepPath, ArcFault> {
    let [first, second] = words.plane.axes();
    let letters = centre_letters(words.plane);
    let normal = words.plane.normal();
    // Posts that always write I, J and K give 0 for the third.
    let other = words.offsets[normal].filter(|offset| words.absolute || *offset != 0.0);
    if other.is_some() {
        return Err(ArcFault::OtherPlane { letter: ['I', 'J', 'K'][normal], centre: letters });
    }
    let offsets = [words.offsets[first], words.offsets[second]];
    let at = |position: Position| Some([position[first]?, position[second]?]);
    let known = at(start).zip(at(end));
    match (words.radius, offsets) {
        (None, [None, None]) => Err(ArcFault::NoCentre { centre: letters }),
        (Some(_), [None, None]) if known.is_none() => Ok(StepPath::Undetermined),
        (Some(radius), [None, None]) => match known {
            Some((start, end)) => by_radius(words, radius, start, end),
            None => Ok(StepPath::Undetermined),
        },
        (Some(_), _) => Err(ArcFault::CentreAndRadius),
        (None, [None, _] | [_, None]) if words.absolute => {
            Err(ArcFault::HalfCentre { centre: letters })
        }
        (None, [i, j]) => match known {
            Some((start, end)) => {
                let [i, j] = [i.unwrap_or(0.0), j.unwrap_or(0.0)];
                let centre = if words.absolute { [i, j] } else { [start[0] + i, start[1] + j] };
                by_centre(words, centre, start, end)
            }
            None => Ok(StepPath::Undetermined),
        },
    }
}

fn by_centre(
    words: &ArcWords,
    centre: [f64; 2],
    start: [f64; 2],
    end: [f64; 2],
) -> Result<StepPath, ArcFault> {
    let [from, to] = [start, end].map(|point| [point[0] - centre[0], point[1] - centre[1]]);
    let [start_radius, end_radius] = [from, to].map(|[u, v]| u.hypot(v));
    if start_radius < LEAST_RADIUS || end_radius < LEAST_RADIUS {
        return Err(ArcFault::ZeroRadius);
    }
    let difference = (start_radius - end_radius).abs();
    let tolerance = radius_tolerance(words.unit);
    let relative = RELATIVE_TOLERANCE * start_radius.max(end_radius);
    let allowed = relative.clamp(tolerance, LARGEST_FACTOR * tolerance);
    if difference > allowed {
        let (start, end, tolerance) = (start_radius, end_radius, allowed);
        return Err(ArcFault::Radii { start, end, tolerance });
    }
    let is_full = (start[0] - end[0]).hypot(start[1] - end[1]) < SAME_POINT;
    let sweep = if is_full { TAU } else { counterclockwise(from, to, words.clockwise) };
    Ok(arc(words, centre, sweep))
}

fn by_radius(
    words: &ArcWords,
    radius: f64,
    start: [f64; 2],
    end: [f64; 2],
) -> Result<StepPath, ArcFault> {
    let chord = [end[0] - start[0], end[1] - start[1]];
    let half = 0.5 * chord[0].hypot(chord[1]);
    if 2.0 * half < SAME_POINT {
        return Err(ArcFault::SamePoint { centre: centre_letters(words.plane) });
    }
    if radius.abs() < LEAST_RADIUS {
        return Err(ArcFault::ZeroRadius);
    }
    if half - radius.abs() > CHORD_TOLERANCE {
        return Err(ArcFault::TooShort { radius: radius.abs(), half });
    }
    // The product of sum and difference keeps its digits near half a turn.
    let squared = (radius.abs() - half) * (radius.abs() + half);
    let height = squared.max(0.0).sqrt();
    // The centre of a counter-clockwise arc of less than half a turn is left of its chord.
    let side = if words.clockwise == (radius > 0.0) { -height } else { height };
    let scale = side / (2.0 * half);
    let middle = [0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1])];
    let centre = [middle[0] - chord[1] * scale, middle[1] + chord[0] * scale];
    let half_angle = half.atan2(height);
    let sweep = if radius > 0.0 { 2.0 * half_angle } else { TAU - 2.0 * half_angle };
    Ok(arc(words, centre, sweep))
}

/// Returns the angle, from 0 to a full turn, from one direction to another, in the direction of the arc.
fn counterclockwise(from: [f64; 2], to: [f64; 2], clockwise: bool) -> f64 {
    let cross = from[0] * to[1] - from[1] * to[0];
    let dot = from[0] * to[0] + from[1] * to[1];
    let angle = if clockwise { (-cross).atan2(dot) } else { cross.atan2(dot) };
    if angle <= 0.0 { angle + TAU } else { angle }
}

fn arc(words: &ArcWords, centre: [f64; 2], sweep: f64) -> StepPath {
    let sweep = sweep + TAU * f64::from(words.turns - 1);
    let sweep = if words.clockwise { -sweep } else { sweep };
    StepPath::Arc { plane: words.plane, centre, sweep }
}
