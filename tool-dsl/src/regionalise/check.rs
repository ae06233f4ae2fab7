//! What is wrong with a profile, before anything is derived of it.

use super::crossing::meeting;
use super::outline::{Point, Segment, TANGENT, along, cross, dot, doubles, reach};
use crate::report::Report;

/// What is wrong with a profile as a whole: where it begins and ends, its sense, crossings.
pub(crate) fn check(outline: &[Segment], show: impl Fn(Point) -> String) -> Vec<Report> {
    let (Some(first), Some(last)) = (outline.first(), outline.last()) else { return Vec::new() };
    let mut reports = Vec::new();
    let ends = [(first, doubles(&first.from), "begins"), (last, doubles(&last.to), "ends")];
    for (segment, [d, z], verb) in ends {
        if d != 0.0 {
            let place = show([d, z]);
            let axis = show([0.0, z]);
            reports.push(
                Report::error(
                    segment.span,
                    format!("the profile {verb} at {place}, not on the axis"),
                )
                .help(format!("let it run from the axis to the axis: add `line to {axis}`")),
            );
        }
    }
    let points: Vec<Point> = outline.iter().flat_map(along).collect();
    let [_, high] = reach(outline);
    for (index, segment) in outline.iter().enumerate() {
        let [[from, _], [to, _]] = segment.ends();
        // An arc's own points, without its ends where they are the profile's.
        let within = segment.round().filter(|(centre, radius, _)| {
            segment.sector([centre[0] - radius, centre[1]]).iter().all(|side| *side > 0.0)
        });
        let lowest = within.map_or(f64::INFINITY, |(centre, radius, _)| centre[0] - radius);
        let touches =
            lowest <= 1e-12 * high[0] || (to <= 1e-12 * high[0] && index + 1 < outline.len());
        if segment.round().is_none() && from == 0.0 && to == 0.0 {
            reports.push(
                Report::error(segment.span, "this segment lies on the axis")
                    .help("leave it out: the axis closes the profile by itself"),
            );
        } else if lowest < -1e-12 * high[0] || from < 0.0 || to < 0.0 {
            reports.push(
                Report::error(segment.span, "this segment crosses the axis")
                    .help("`d` is a radius and never negative"),
            );
        } else if touches {
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
    for pair in outline.windows(2) {
        let (before, after) = (pair[0].tangent(true), pair[1].tangent(false));
        if cross(before, after).abs() < TANGENT && dot(before, after) < 0.0 {
            let at = show(pair[0].ends()[1]);
            reports.push(
                Report::error(pair[1].span, format!("this segment turns straight back at {at}"))
                    .and(pair[0].span, "from this one")
                    .help("a needle without an angle is no solid: move a corner"),
            );
        }
    }
    for (i, a) in outline.iter().enumerate() {
        for (j, b) in outline.iter().enumerate().skip(i + 1) {
            if let Some(at) = meeting(a, b, j == i + 1) {
                reports.push(
                    Report::error(b.span, format!("this segment meets that one at {}", show(at)))
                        .and(a.span, "that one")
                        .help("a profile never crosses or touches itself"),
                );
            }
        }
    }
    reports
}
