//! A `profile` to its outline: points, circles and surfaces, in the tool's frame.

use super::lower::Lowering;
use crate::model::Surface;
use crate::number::Number;
use crate::regionalise::check::check;
use crate::regionalise::outline::{Circle, Place, Segment, doubles, minus, norm};
use crate::report::Report;
use crate::source::Span;
use crate::syntax::tree::{Arc, Expr, Piece, Profile, Round, Tuple};

/// The most segments of a profile.
const MOST: usize = 4096;
/// How far an arc's ends may be off its circle, in radii.
const OFF_CIRCLE: f64 = 1e-9;

/// The outline of a profile, counter-clockwise in the tool's frame, and its surfaces.
pub(super) fn outline(
    profile: &Profile,
    lowering: &mut Lowering,
    reports: &mut Vec<Report>,
) -> Option<(Vec<Segment>, Vec<Surface>)> {
    let before = reports.len();
    if let Some(beyond) = profile.pieces.get(MOST) {
        reports.push(Report::error(beyond.span, format!("more than {MOST} segments")));
        return None;
    }
    let mut surfaces = Vec::new();
    let mut segments = Vec::new();
    let mut from = place(&profile.start, lowering).map_err(|r| reports.push(r)).ok();
    for piece in &profile.pieces {
        let surface = surface(piece, &mut surfaces, reports);
        let to = place(&piece.to, lowering).map_err(|r| reports.push(r)).ok();
        if let (Some(from), Some(to)) = (from, to.clone()) {
            match segment(piece, from, to, surface, lowering) {
                Ok(segment) => segments.push(segment),
                Err(report) => reports.push(report),
            }
        }
        from = to;
    }
    if reports.len() > before {
        return None;
    }
    let frame = lowering.frame.clone();
    let shown = |p: [f64; 2]| {
        let tidy = |v: f64| (v * 1e6).round() / 1e6 + 0.0;
        format!("({}, {})", tidy(p[0]), tidy(p[1]))
    };
    reports.extend(check(&segments, shown));
    if reports.len() > before {
        return None;
    }
    // The turn into the tool's frame may turn the sense over; then the walk is turned too.
    let to_tool = |place: &Place| [place[0].clone(), frame.to_tool(&place[1])];
    let mut outline: Vec<Segment> = segments
        .into_iter()
        .map(|segment| {
            let [from, to] = [to_tool(&segment.from), to_tool(&segment.to)];
            let circle =
                segment.circle.map(|circle| Circle { centre: to_tool(&circle.centre), ..circle });
            let ends = if frame.down { [to, from] } else { [from, to] };
            Segment::new(ends, circle, segment.surface, segment.span)
        })
        .collect();
    if frame.down {
        outline.reverse();
    }
    Some((outline, surfaces))
}

fn place(tuple: &Tuple, lowering: &mut Lowering) -> Result<Place, Report> {
    let [d, z] = super::direction::pair(tuple, "a point")?;
    let mut length = |expr: &Expr| lowering.length(expr, "a point");
    Ok([length(d)?, length(z)?])
}

fn surface(piece: &Piece, surfaces: &mut Vec<Surface>, reports: &mut Vec<Report>) -> usize {
    let cutting = piece.cutting.is_some();
    super::region::named_surface(&piece.surface, cutting, surfaces, reports)
}

fn segment(
    piece: &Piece,
    from: Place,
    to: Place,
    surface: usize,
    lowering: &mut Lowering,
) -> Result<Segment, Report> {
    let span = piece.span;
    if from == to {
        return Err(Report::error(span, "this segment has no length").help("drop it"));
    }
    let circle = match &piece.arc {
        None => None,
        Some(arc) => Some(circle(arc, [&from, &to], span, lowering)?),
    };
    Ok(Segment::new([from, to], circle, surface, span))
}

fn circle(
    arc: &Arc,
    ends: [&Place; 2],
    span: Span,
    lowering: &mut Lowering,
) -> Result<Circle, Report> {
    let (centre, radius) = match &arc.round {
        Round::Center(tuple) => {
            let centre = place(tuple, lowering)?;
            let [a, b] = ends.map(|end| distance(end, &centre));
            let (a_size, b_size) = (a.to_f64(), b.to_f64());
            if (a_size - b_size).abs() > OFF_CIRCLE * a_size.max(b_size) {
                return Err(Report::error(
                    span,
                    format!("the arc's ends are {a_size} and {b_size} from its centre"),
                )
                .help("both ends lie on one circle"));
            }
            (centre, a)
        }
        Round::Radius(expr) => {
            let radius = lowering.length(expr, "`radius`")?;
            (by_radius(ends, &radius, arc.concave.is_some(), span)?, radius)
        }
    };
    if radius.to_f64() <= 0.0 {
        return Err(Report::error(span, "an arc's radius is more than 0"));
    }
    let [a, b] = ends.map(|end| [0, 1].map(|k| &end[k] - &centre[k]));
    let turn = (&(&a[0] * &b[1]) - &(&a[1] * &b[0])).to_f64();
    let half = turn.abs() <= 1e-12 * radius.to_f64().powi(2);
    let convex = if half { arc.concave.is_none() } else { turn > 0.0 };
    let shown = centre.clone().map(|part| part.to_f64());
    match (convex, arc.concave) {
        (true, Some(said)) => Err(Report::error(said, "this arc is not concave")
            .help("its centre lies in the material: drop `concave`")),
        (false, None) => Err(Report::error(
            span,
            format!(
                "this arc is concave: its centre ({}, {}) lies outside the material",
                shown[0], shown[1]
            ),
        )
        .help("say `concave` if it should be")),
        _ => Ok(Circle { centre, radius, convex }),
    }
}

fn distance(a: &Place, b: &Place) -> Number {
    let [d, z] = [0, 1].map(|k| &a[k] - &b[k]);
    (&(&d * &d) + &(&z * &z)).sqrt().unwrap_or_else(|| Number::int(0))
}

/// The centre of the arc of less than 180° that bulges out of the material, or into it.
fn by_radius(
    [from, to]: [&Place; 2],
    radius: &Number,
    concave: bool,
    span: Span,
) -> Result<Place, Report> {
    let half = |a: &Number, b: &Number| &(a + b) / &Number::int(2);
    let middle = [0, 1].map(|k| half(&from[k], &to[k]));
    let [d, z] = [0, 1].map(|k| &to[k] - &from[k]);
    let chord = (&(&d * &d) + &(&z * &z)).sqrt().unwrap_or_else(|| Number::int(0));
    let short = &(radius * radius) - &(&(&chord * &chord) / &Number::int(4));
    let (r, c) = (radius.to_f64(), norm(minus(doubles(to), doubles(from))));
    // A half circle's centre is on its chord, as far as its ends are on the circle.
    let rounding = if short.is_negative() { OFF_CIRCLE } else { 1e-18 };
    let near = short.to_f64().abs() <= rounding * c * c;
    let off = if near { Some(Number::int(0)) } else { short.sqrt() };
    let (Some(off), true) = (off, r > 0.0) else {
        return Err(Report::error(span, format!("no arc of radius {r} spans a chord of {c}"))
            .help("take a larger radius, or nearer ends"));
    };
    // The material is on the left: a bulge out of it has its centre there.
    let off = if concave { -&off } else { off };
    let left = [-&z, d];
    Ok([0, 1].map(|k| &middle[k] + &(&(&left[k] * &off) / &chord)))
}
