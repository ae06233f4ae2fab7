//! Resolves a `profile` to its outline: points, circles and surfaces, in the tool's frame.

use super::lower::Lowering;
use super::mount::off_tip;
use crate::diagnostic::{
    Diagnostic, FormattedNumber, ProfileKind, Reported, Role, enough, format_number, without_error,
};
use crate::geometry::outline::{
    ExactCircle, ExactPoint, Segment, bounding_box, doubles, minus, norm,
};
use crate::model::Surface;
use crate::number::Number;
use crate::regionalise::check::check;
use crate::source::Span;
use crate::syntax::tree::{Arc, ArcCircle, Expr, PathSegment, Profile, Tuple};

/// A coordinate below this is shown as 0: what cancels in constants of a file.
const SHOWN_AS_0: f64 = 1e-12;

/// The sine of an arc's turn up to which it counts as half a turn, for which convex and concave differ by what the file says.
const HALF_TURN_SINE: f64 = 1e-12;

/// The slope of a chord up to which it is level: the centre on the axis that is as far from both its ends is then too far away.
const LEVEL_SINE: f64 = 1e-6;

/// The square of the distance of a centre from a chord's middle, in the square of the chord, that counts as 0: the square of the
/// rounding of numbers in a file.
const CHORD_ROUNDING: f64 = 1e-18;

/// The maximum number of segments of a profile. Dividing more would take minutes.
const MAX_SEGMENTS: usize = 256;
/// The largest radius of an arc, in chords.
const MAX_RADIUS_IN_CHORDS: f64 = 1e6;
/// The largest distance of an arc's ends from its circle, in radii.
const MAX_CIRCLE_DEVIATION_IN_RADII: f64 = 1e-9;

/// The largest distance of a tool from its tip at which its proofs are tried, in sizes of the tool.
const MAX_TIP_IN_SIZES: f64 = 1e6;

/// The outline of a tool's section, in the tool's frame and unit.
pub(super) struct Outline {
    /// Its segments, counter-clockwise.
    pub(super) segments: Vec<Segment>,
    pub(super) surfaces: Vec<Surface>,
    /// The span of the profile or, for mounts, of the tool's name.
    pub(super) span: Span,
}

/// Returns the outline of a profile.
pub(super) fn outline(
    profile: &Profile,
    lowering: &mut Lowering,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<Outline, Reported> {
    let before = diagnostics.len();
    if let Some(beyond) = profile.segments.get(MAX_SEGMENTS) {
        let diagnostic =
            Diagnostic::new(beyond.span, ProfileKind::TooManySegments { limit: MAX_SEGMENTS });
        return Err(Reported::push(diagnostics, diagnostic));
    }
    let mut surfaces = Vec::new();
    let mut segments = Vec::new();
    let mut from = exact_point(&profile.start, lowering).map_err(|r| diagnostics.push(r)).ok();
    let mut begin = &profile.start;
    for piece in &profile.segments {
        let ends = [std::mem::replace(&mut begin, &piece.end), &piece.end];
        let to = exact_point(&piece.end, lowering).map_err(|r| diagnostics.push(r)).ok();
        if from.is_some() && from == to && is_parametric(ends, lowering) {
            let surface = piece.surface.text.clone();
            lowering.left_out.insert(surface.clone());
            diagnostics.push(Diagnostic::new(piece.span, ProfileKind::SegmentLeftOut { surface }));
            continue;
        }
        let surface = surface(piece, &mut surfaces, diagnostics);
        if let (Some(from), Some(to)) = (from, to.clone()) {
            match segment(piece, from, to, surface, lowering) {
                Ok(segment) => segments.push(segment),
                Err(diagnostic) => diagnostics.push(diagnostic),
            }
        }
        from = to;
        if enough(diagnostics) {
            break;
        }
    }
    without_error(&diagnostics[before..])?;
    if segments.is_empty() {
        let diagnostic = Diagnostic::new(profile.span, ProfileKind::ZeroLengthSegment);
        return Err(Reported::push(diagnostics, diagnostic));
    }
    off_axis(profile, &segments, diagnostics);
    without_error(&diagnostics[before..])?;
    let frame = lowering.frame.clone();
    diagnostics.extend(check(&segments, shown));
    without_error(&diagnostics[before..])?;
    // The map to the tool's frame may reverse the orientation; the order of the segments is then reversed too.
    let to_tool = |point: &ExactPoint| [point[0].clone(), frame.to_tool(&point[1])];
    let mut segments: Vec<Segment> = segments
        .into_iter()
        .map(|segment| {
            let [from, to] = [to_tool(&segment.from), to_tool(&segment.to)];
            let circle = segment
                .circle
                .map(|circle| ExactCircle { centre: to_tool(&circle.centre), ..circle });
            let ends = if frame.spindle_down { [to, from] } else { [from, to] };
            Segment::new(ends, circle, segment.geometry.surface, segment.span)
        })
        .collect();
    if frame.spindle_down {
        segments.reverse();
    }
    // A tool so far from its tip loses its digits, and with them what was checked.
    let [[_, end], [radius, high]] = bounding_box(&segments);
    if end.abs() > MAX_TIP_IN_SIZES * radius.max(high - end) {
        return Err(Reported::push(diagnostics, off_tip(&frame, [end, high])));
    }
    Ok(Outline { segments, surfaces, span: profile.span })
}

fn shown([d, z]: [f64; 2]) -> String {
    let [d, z] =
        [d, z].map(|v| if v.abs() < SHOWN_AS_0 { "0".to_owned() } else { format_number(v) });
    format!("({d}, {z})")
}

/// Reports a profile that does not begin or does not end on the axis.
fn off_axis(profile: &Profile, segments: &[Segment], diagnostics: &mut Vec<Diagnostic>) {
    let (Some(first), Some(last)) = (segments.first(), segments.last()) else { return };
    let [start, end] = [first.geometry.ends[0], last.geometry.ends[1]];
    if start[0] != 0.0 {
        diagnostics.push(Diagnostic::new(
            profile.start.span,
            ProfileKind::StartsOffAxis { start: shown(start), axis_point: shown([0.0, start[1]]) },
        ));
    }
    if end[0] != 0.0 {
        diagnostics.push(Diagnostic::new(
            last.span,
            ProfileKind::EndsOffAxis { end: shown(end), axis_point: shown([0.0, end[1]]) },
        ));
    }
}

/// Returns whether a coordinate of one of the ends depends on a param.
fn is_parametric(ends: [&Tuple; 2], lowering: &Lowering) -> bool {
    ends.iter().flat_map(|end| &end.components).any(|part| lowering.is_parametric(part))
}

fn exact_point(tuple: &Tuple, lowering: &mut Lowering) -> Result<ExactPoint, Diagnostic> {
    let [d, z] = super::region::pair(tuple, Role::Point)?;
    let mut length = |expr: &Expr| lowering.length(expr, Role::Point);
    Ok([length(d)?, length(z)?])
}

fn surface(
    piece: &PathSegment,
    surfaces: &mut Vec<Surface>,
    diagnostics: &mut Vec<Diagnostic>,
) -> usize {
    let cutting = piece.cutting.is_some();
    super::region::named_surface(&piece.surface, cutting, surfaces, diagnostics)
}

fn segment(
    piece: &PathSegment,
    from: ExactPoint,
    to: ExactPoint,
    surface: usize,
    lowering: &mut Lowering,
) -> Result<Segment, Diagnostic> {
    let span = piece.span;
    if from == to {
        return Err(Diagnostic::new(span, ProfileKind::ZeroLengthSegment));
    }
    let circle = match &piece.arc {
        None => None,
        Some(arc) => Some(circle(arc, [&from, &to], span, lowering)?),
    };
    Ok(Segment::new([from, to], circle, surface, span))
}

fn circle(
    arc: &Arc,
    ends: [&ExactPoint; 2],
    span: Span,
    lowering: &mut Lowering,
) -> Result<ExactCircle, Diagnostic> {
    let (centre, radius) = match &arc.circle {
        ArcCircle::Center(tuple) => {
            let centre = exact_point(tuple, lowering)?;
            let [a, b] = ends.map(|end| distance(end, &centre));
            let (a_size, b_size) = (a.to_f64(), b.to_f64());
            if (a_size - b_size).abs() > MAX_CIRCLE_DEVIATION_IN_RADII * a_size.max(b_size) {
                let (mut start_radius, mut end_radius) =
                    (format_number(a_size), format_number(b_size));
                if start_radius == end_radius {
                    (start_radius, end_radius) = (a_size.to_string(), b_size.to_string());
                }
                return Err(Diagnostic::new(
                    span,
                    ProfileKind::UnequalArcRadii { start_radius, end_radius },
                ));
            }
            if a.nearly_equals(&b) { (centre, a) } else { midway(ends, &centre) }
        }
        ArcCircle::Radius(expr) => {
            let radius = lowering.length(expr, Role::Radius)?;
            if radius.to_f64() <= 0.0 {
                return Err(Diagnostic::new(expr.span, ProfileKind::RadiusNotPositive));
            }
            (by_radius(ends, &radius, arc.concave.is_some(), span)?, radius)
        }
    };
    let (r, chord) = (radius.to_f64(), norm(minus(doubles(ends[1]), doubles(ends[0]))));
    if r > MAX_RADIUS_IN_CHORDS * chord {
        return Err(Diagnostic::new(span, ProfileKind::FlatArc { radius: FormattedNumber(r) }));
    }
    let [a, b] = ends.map(|end| [0, 1].map(|k| &end[k] - &centre[k]));
    let turn = (&(&a[0] * &b[1]) - &(&a[1] * &b[0])).to_f64();
    let half = turn.abs() <= HALF_TURN_SINE * radius.to_f64().powi(2);
    let convex = if half { arc.concave.is_none() } else { turn > 0.0 };
    match (convex, arc.concave) {
        (true, Some(said)) => Err(Diagnostic::new(said, ProfileKind::NotConcave)),
        (false, None) => Err(Diagnostic::new(
            span,
            ProfileKind::UnmarkedConcave { centre: shown(doubles(&centre)) },
        )),
        _ => Ok(ExactCircle { centre, radius, convex }),
    }
}

fn dot(a: &ExactPoint, b: &ExactPoint) -> Number {
    &(&a[0] * &b[0]) + &(&a[1] * &b[1])
}

fn distance(a: &ExactPoint, b: &ExactPoint) -> Number {
    let [d, z] = [0, 1].map(|k| &a[k] - &b[k]);
    (&(&d * &d) + &(&z * &z)).sqrt().unwrap_or_else(|| Number::int(0))
}

/// Returns the centre and radius of a circle through both ends, so that borders of regions meet exactly at them. Its
/// centre is the nearest one to the given centre; if that is on the axis, the nearest one on the axis.
fn midway([from, to]: [&ExactPoint; 2], centre: &ExactPoint) -> (ExactPoint, Number) {
    let chord = [0, 1].map(|k| &to[k] - &from[k]);
    let middle = [0, 1].map(|k| &(&from[k] + &to[k]) / &Number::int(2));
    let offset = dot(&chord, &[0, 1].map(|k| &middle[k] - &centre[k]));
    let rises = chord[1].to_f64().abs() > LEVEL_SINE * norm(doubles(&chord));
    let direction =
        if centre[0].is_zero() && rises { [Number::int(0), Number::int(1)] } else { chord.clone() };
    let share = &offset / &dot(&chord, &direction);
    let centre = [0, 1].map(|k| &centre[k] + &(&share * &direction[k]));
    let radius = distance(from, &centre);
    (centre, radius)
}

/// Returns the centre of the arc of less than 180° that bulges out of the material, or into it if `concave`.
fn by_radius(
    [from, to]: [&ExactPoint; 2],
    radius: &Number,
    concave: bool,
    span: Span,
) -> Result<ExactPoint, Diagnostic> {
    let middle = [0, 1].map(|k| &(&from[k] + &to[k]) / &Number::int(2));
    let [d, z] = [0, 1].map(|k| &to[k] - &from[k]);
    let chord = (&(&d * &d) + &(&z * &z)).sqrt().unwrap_or_else(|| Number::int(0));
    let short = &(radius * radius) - &(&(&chord * &chord) / &Number::int(4));
    let (r, c) = (radius.to_f64(), norm(minus(doubles(to), doubles(from))));
    // The centre of a half circle is on its chord, within the tolerance of its ends.
    let rounding = if short.is_negative() { MAX_CIRCLE_DEVIATION_IN_RADII } else { CHORD_ROUNDING };
    let near = short.to_f64().abs() <= rounding * c * c;
    let offset = if near { Some(Number::int(0)) } else { short.sqrt() };
    let (Some(offset), true) = (offset, r > 0.0) else {
        let [radius, chord, min_radius] = [r, c, c / 2.0].map(FormattedNumber);
        return Err(Diagnostic::new(
            span,
            ProfileKind::RadiusTooSmall { radius, chord, min_radius },
        ));
    };
    // The material is on the left: an arc that bulges out of it has its centre there.
    let offset = if concave { -&offset } else { offset };
    let left = [-&z, d];
    Ok([0, 1].map(|k| &middle[k] + &(&(&left[k] * &offset) / &chord)))
}
