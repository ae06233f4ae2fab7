//! What is wrong with a profile, before anything is derived of it.

use crate::geometry::crossing::meeting;
use crate::geometry::outline::{Point, Segment, TANGENT, along, cross, dot, minus, norm, reach};
use crate::report::{Report, enough};

/// What is wrong with a profile that runs from the axis to the axis: its sense, crossings.
pub(crate) fn check(outline: &[Segment], show: impl Fn(Point) -> String) -> Vec<Report> {
    let (Some(first), Some(last)) = (outline.first(), outline.last()) else { return Vec::new() };
    let mut reports = Vec::new();
    let points: Vec<Point> = outline.iter().flat_map(along).collect();
    let [_, high] = reach(outline);
    for (index, segment) in outline.iter().enumerate() {
        let [_, [to, _]] = segment.ends();
        // An arc's own points, without its ends where they are the profile's.
        let within = segment.round().filter(|(centre, radius, _)| {
            segment.sector([centre[0] - radius, centre[1]]).iter().all(|side| *side > 0.0)
        });
        let lowest = within.map_or(f64::INFINITY, |(centre, radius, _)| centre[0] - radius);
        let touches =
            lowest <= 1e-12 * high[0] || (to <= 1e-12 * high[0] && index + 1 < outline.len());
        let lies = |segment: &Segment| {
            let [[from, _], [to, _]] = segment.ends();
            segment.round().is_none() && from == 0.0 && to == 0.0
        };
        if lies(segment) {
            reports.push(
                Report::error(segment.span, "this segment lies on the axis")
                    .help("leave it out: the axis closes the profile by itself"),
            );
        } else if lowest < -1e-12 * high[0] || to < 0.0 {
            reports.push(
                Report::error(segment.span, "this segment crosses the axis")
                    .help("`d` is a radius and never negative"),
            );
        } else if touches && !outline.get(index + 1).is_some_and(lies) {
            reports.push(
                Report::error(segment.span, "this segment touches the axis")
                    .help("a profile is on the axis at its two ends only"),
            );
        }
    }
    if !reports.is_empty() {
        return reports;
    }
    let area: f64 = points.windows(2).map(|pair| cross(pair[0], pair[1])).sum();
    if area <= 0.0 {
        reports.push(
            Report::error(first.span, "the profile runs clockwise")
                .help("start at its low end and keep the material on the left"),
        );
        return reports;
    }
    let axis_ends = [
        (first, first.tangent(false), first.ends()[0]),
        (last, last.tangent(true), last.ends()[1]),
    ];
    for (segment, along, at) in axis_ends {
        if along[0].abs() < TANGENT {
            let message = format!("this segment runs along the axis at {}", show(at));
            reports.push(
                Report::error(segment.span, message).help(
                    "a needle without an angle is no solid: let it meet the axis at an angle",
                ),
            );
        }
    }
    // Segments of which something was said: their neighbours would only repeat it.
    let mut said: Vec<usize> = Vec::new();
    for (index, pair) in outline.windows(2).enumerate() {
        let (before, after) = (pair[0].tangent(true), pair[1].tangent(false));
        if cross(before, after).abs() < TANGENT && dot(before, after) < 0.0 {
            let at = show(pair[0].ends()[1]);
            reports.push(
                Report::error(pair[1].span, format!("this segment turns straight back at {at}"))
                    .and(pair[0].span, "from this one")
                    .help("a needle without an angle is no solid: move a corner"),
            );
            said.extend([index, index + 1]);
        } else if hardly_turns(&pair[0], &pair[1]) {
            let at = show(pair[0].ends()[1]);
            let message = format!("this segment turns by less than {TANGENT:e} at {at}");
            reports.push(
                Report::error(pair[1].span, message)
                    .and(pair[0].span, "from this one")
                    .help("such a corner is told from none by no double: draw both as one line"),
            );
            said.extend([index, index + 1]);
        }
    }
    let known = |said: &[usize], index: usize| said.iter().any(|other| index.abs_diff(*other) <= 1);
    for (i, a) in outline.iter().enumerate() {
        for (j, b) in outline.iter().enumerate().skip(i + 1) {
            if known(&said, i) || known(&said, j) {
                continue;
            }
            if let Some(at) = meeting(a, b, j == i + 1) {
                let slack = 1e-9 * high.iter().fold(0.0, |size: f64, part| size.max(part.abs()));
                let end = |segment: &Segment| {
                    segment.ends().iter().any(|end| norm(minus(*end, at)) <= slack)
                };
                let verb = if end(a) || end(b) { "touches" } else { "crosses" };
                let message = format!("this segment {verb} that one at {}", show(at));
                reports.push(
                    Report::error(b.span, message)
                        .and(a.span, "that one")
                        .help("a profile never crosses or touches itself: move a corner"),
                );
                said.extend([i, j]);
            }
            if enough(&reports) {
                return reports;
            }
        }
    }
    reports
}

/// Whether a line follows another at an angle that is not 0 and yet taken for tangent: what lies between the two would be felt by the
/// wrong one.
fn hardly_turns(before: &Segment, after: &Segment) -> bool {
    if before.round().is_some() || after.round().is_some() {
        return false;
    }
    let (Some([ad, az]), Some([bd, bz])) = (before.direction(), after.direction()) else {
        return false;
    };
    // What 256 bits round is far less.
    let sine = (&(&ad * &bz) - &(&az * &bd)).to_f64().abs();
    (1e-60..TANGENT).contains(&sine)
}
