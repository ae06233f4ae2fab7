//! Intersections of two segments of an outline.

use super::outline::{Point, Segment, cross, dot, doubles, minus, norm};

/// Returns a common point of two segments. For neighbours, the start of `b` that they share does not count.
pub(crate) fn common_point(a: &Segment, b: &Segment, neighbours: bool) -> Option<Point> {
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
    let slack = 1e-9 * size;
    let is_on = |s: &Segment, p: Point| {
        s.signed(p).abs() <= slack && s.sector(p).iter().all(|side| *side >= -slack)
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
    let direction = line.tangent(false);
    let from = minus(doubles(&line.from), centre);
    let foot = -dot(direction, from);
    let distance = cross(direction, from);
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
