//! Checks of a profile before regions are derived from it.

use crate::diagnostic::{Diagnostic, ProfileKind, enough};
use crate::geometry::outline::{
    Point, Segment, TANGENT_SINE, bounding_box, cross, dot, doubles, minus, norm,
};
use touchoff_plane::Circle;

/// The number of chords of an arc where a profile is looked at through points.
const ARC_STEPS: usize = 32;

/// The part of the largest radius by which an arc may pass the axis, or stay away from it, and end on it.
const AXIS_ROUNDING: f64 = 1e-12;

/// The part of the size within which two segments have a point in common.
const COMMON_POINT_ROUNDING: f64 = 1e-9;

/// The sine up to which two lines are in line, but for the rounding of coordinates in doubles. The partition takes their directions as they
/// are: between their normals, which part by no more than that of the length, depth differs by its square.
const IN_LINE_SINE: f64 = 1e-13;

/// Checks a profile that runs from the axis to the axis: contact with the axis, orientation, turns between neighbours,
/// self-intersections. Returns the diagnostics.
pub(crate) fn check(outline: &[Segment], show: impl Fn(Point) -> String) -> Vec<Diagnostic> {
    let (Some(first), Some(last)) = (outline.first(), outline.last()) else { return Vec::new() };
    let mut diagnostics = Vec::new();
    let points = outline.iter().flat_map(|segment| {
        let steps = if segment.circle.is_some() { ARC_STEPS } else { 1 };
        segment.geometry.places(steps).map(|place| place.point)
    });
    let points: Vec<Point> = points.collect();
    let [_, high] = bounding_box(outline);
    for (index, segment) in outline.iter().enumerate() {
        let [_, [to, _]] = segment.geometry.ends;
        // The point of an arc's circle nearest to the axis, if it lies strictly between the arc's ends.
        let arc_near_axis = segment.geometry.circle.filter(|Circle { centre, radius, .. }| {
            segment.geometry.sector([centre[0] - radius, centre[1]]).iter().all(|side| *side > 0.0)
        });
        let lowest =
            arc_near_axis.map_or(f64::INFINITY, |Circle { centre, radius, .. }| centre[0] - radius);
        // Only the last segment may end on the axis.
        let touches = lowest <= AXIS_ROUNDING * high[0]
            || (to <= AXIS_ROUNDING * high[0] && index + 1 < outline.len());
        if lies_on_axis(segment) {
            diagnostics.push(Diagnostic::new(segment.span, ProfileKind::OnAxis));
        } else if lowest < -AXIS_ROUNDING * high[0] || to < 0.0 {
            diagnostics.push(Diagnostic::new(segment.span, ProfileKind::CrossesAxis));
        } else if touches && !outline.get(index + 1).is_some_and(lies_on_axis) {
            diagnostics.push(Diagnostic::new(segment.span, ProfileKind::TouchesAxis));
        }
    }
    if !diagnostics.is_empty() {
        return diagnostics;
    }
    let area: f64 = points.windows(2).map(|pair| cross(pair[0], pair[1])).sum();
    // Twice the area, with arcs as chords; the closing side on the axis adds nothing.
    if area <= 0.0 {
        diagnostics.push(Diagnostic::new(first.span, ProfileKind::Clockwise));
        return diagnostics;
    }
    let axis_ends = [
        (first, first.geometry.tangent(0), first.geometry.ends[0]),
        (last, last.geometry.tangent(1), last.geometry.ends[1]),
    ];
    for (segment, tangent, point) in axis_ends {
        if tangent[0].abs() < TANGENT_SINE {
            diagnostics.push(Diagnostic::new(
                segment.span,
                ProfileKind::TangentToAxis { location: show(point) },
            ));
        }
    }
    // Segments that already have a diagnostic. Their neighbours would only repeat it.
    let mut reported: Vec<usize> = Vec::new();
    for (index, pair) in outline.windows(2).enumerate() {
        let (before, after) = (pair[0].geometry.tangent(1), pair[1].geometry.tangent(0));
        if cross(before, after).abs() < TANGENT_SINE && dot(before, after) < 0.0 {
            let location = show(pair[0].geometry.ends[1]);
            diagnostics.push(
                Diagnostic::new(pair[1].span, ProfileKind::TurnsBack { location })
                    .with_label(pair[0].span, "previous segment"),
            );
            reported.extend([index, index + 1]);
        } else if hardly_turns(&pair[0], &pair[1]) {
            let location = show(pair[0].geometry.ends[1]);
            diagnostics.push(
                Diagnostic::new(
                    pair[1].span,
                    ProfileKind::CornerTooFlat { min_angle: TANGENT_SINE, location },
                )
                .with_label(pair[0].span, "previous segment"),
            );
            reported.extend([index, index + 1]);
        }
    }
    let is_near_reported =
        |reported: &[usize], index: usize| reported.iter().any(|other| index.abs_diff(*other) <= 1);
    for (i, a) in outline.iter().enumerate() {
        for (j, b) in outline.iter().enumerate().skip(i + 1) {
            if is_near_reported(&reported, i) || is_near_reported(&reported, j) {
                continue;
            }
            if let Some(point) = common_point(a, b, j == i + 1) {
                let slack = COMMON_POINT_ROUNDING
                    * high.iter().fold(0.0, |size: f64, part| size.max(part.abs()));
                let is_end = |segment: &Segment| {
                    segment.geometry.ends.iter().any(|end| norm(minus(*end, point)) <= slack)
                };
                diagnostics.push(
                    Diagnostic::new(
                        b.span,
                        ProfileKind::SelfIntersection {
                            touches: is_end(a) || is_end(b),
                            location: show(point),
                        },
                    )
                    .with_label(a.span, "other segment"),
                );
                reported.extend([i, j]);
            }
            if enough(&diagnostics) {
                return diagnostics;
            }
        }
    }
    diagnostics
}

fn lies_on_axis(segment: &Segment) -> bool {
    let [[from, _], [to, _]] = segment.geometry.ends;
    segment.geometry.circle.is_none() && from == 0.0 && to == 0.0
}

/// Returns whether a line follows another at an angle that is not 0 and yet small enough to count as tangent. Points
/// between the normals of the two would be assigned to the wrong line.
fn hardly_turns(before: &Segment, after: &Segment) -> bool {
    if before.geometry.circle.is_some() || after.geometry.circle.is_some() {
        return false;
    }
    let (Some([ad, az]), Some([bd, bz])) = (before.direction(), after.direction()) else {
        return false;
    };
    let sine = (&(&ad * &bz) - &(&az * &bd)).to_f64().abs();
    (IN_LINE_SINE..TANGENT_SINE).contains(&sine)
}

/// Returns a common point of two segments. For neighbours, the start of `b` that they share does not count.
fn common_point(a: &Segment, b: &Segment, neighbours: bool) -> Option<Point> {
    let candidates = match (&a.circle, &b.circle) {
        (None, None) => line_line(a, b),
        (None, Some(_)) => line_circle(a, b),
        (Some(_), None) => line_circle(b, a),
        (Some(_), Some(_)) => circle_circle(a, b),
    };
    let size = [&a.from, &a.to, &b.from, &b.to]
        .into_iter()
        .map(|point| norm(doubles(point)))
        .fold(0.0, f64::max);
    let slack = COMMON_POINT_ROUNDING * size;
    let is_on = |s: &Segment, p: Point| {
        s.geometry.signed_distance(p).abs() <= slack
            && s.geometry.sector(p).iter().all(|side| *side >= -slack)
    };
    let ends = [doubles(&a.from), doubles(&a.to), doubles(&b.from), doubles(&b.to)];
    candidates.into_iter().chain(ends).find(|p| {
        let shared = neighbours && norm(minus(*p, doubles(&b.from))) <= 2.0 * slack;
        !shared && is_on(a, *p) && is_on(b, *p)
    })
}

fn line_line(a: &Segment, b: &Segment) -> Vec<Point> {
    let (p, r) = (doubles(&a.from), minus(doubles(&a.to), doubles(&a.from)));
    let (q, s) = (doubles(&b.from), minus(doubles(&b.to), doubles(&b.from)));
    let sine = cross(r, s);
    if sine == 0.0 {
        return Vec::new();
    }
    let t = cross(minus(q, p), s) / sine;
    vec![[p[0] + t * r[0], p[1] + t * r[1]]]
}

fn line_circle(line: &Segment, arc: &Segment) -> Vec<Point> {
    let Some(circle) = &arc.circle else { return Vec::new() };
    let (centre, radius) = (doubles(&circle.centre), circle.radius.to_f64());
    let direction = line.geometry.tangent(0);
    let from = minus(doubles(&line.from), centre);
    let foot = -dot(direction, from);
    let distance = cross(direction, from);
    // A tangent may miss the circle by rounding.
    let half_chord = (radius * radius - distance * distance).max(0.0).sqrt();
    [foot - half_chord, foot + half_chord]
        .map(|t| [centre[0] + from[0] + t * direction[0], centre[1] + from[1] + t * direction[1]])
        .to_vec()
}

fn circle_circle(a: &Segment, b: &Segment) -> Vec<Point> {
    let (Some(ca), Some(cb)) = (&a.circle, &b.circle) else { return Vec::new() };
    let (p, q) = (doubles(&ca.centre), doubles(&cb.centre));
    let (r, s) = (ca.radius.to_f64(), cb.radius.to_f64());
    let between = minus(q, p);
    let distance = norm(between);
    if distance == 0.0 {
        return Vec::new();
    }
    let along = (distance * distance + r * r - s * s) / (2.0 * distance);
    let half_chord = (r * r - along * along).max(0.0).sqrt();
    let unit = [between[0] / distance, between[1] / distance];
    [half_chord, -half_chord]
        .map(|h| [p[0] + along * unit[0] - h * unit[1], p[1] + along * unit[1] + h * unit[0]])
        .to_vec()
}
