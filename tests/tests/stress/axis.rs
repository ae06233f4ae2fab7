//! Item 4: points at d = ±0, 5e-324 and 2^-540 from the axis: at the heights of all corners and an ulp beside them, at
//! ±0, ±5e-324 and 2^-540, and at others. Of a solid without an axis, each coordinate of a corner takes these values.

use crate::truth::Subject;
use crate::validator::Validator;
use crate::{check_tools, extent};

#[test]
fn points_on_the_axis_keep_the_contract() {
    check_tools(4, |subject, _, checks| {
        let validator = Validator::new(subject.tool, &*subject.truth);
        for points in points(subject).chunks(1024) {
            validator.validate(points, checks);
        }
    });
}

fn distances() -> [f64; 4] {
    [0.0, -0.0, 5e-324, 2f64.powi(-540)]
}

fn points(subject: &Subject) -> Vec<[f64; 3]> {
    let corners = subject.oracle.corner_points();
    if !subject.oracle.is_revolved() {
        return corners.into_iter().flat_map(points_near_planes).collect();
    }
    let mut corner_heights: Vec<f64> = corners.into_iter().map(|[.., z]| z).collect();
    corner_heights.sort_by(f64::total_cmp);
    corner_heights.dedup();
    let count = extent(4, 200);
    let top = subject.oracle.extent()[1];
    let mut heights: Vec<f64> =
        corner_heights.iter().flat_map(|z| [*z, z.next_up(), z.next_down()]).collect();
    heights.extend((0..=count).map(|k| top * k as f64 / count as f64));
    heights.extend([-0.0, 5e-324, -5e-324, 2f64.powi(-540)]);
    let around = |z: f64| {
        distances().map(|d| [[d, 0.0, z], [-0.0, d, z], [-d, d, z], [-d, -0.0, z]]).into_iter()
    };
    heights.into_iter().flat_map(around).flatten().collect()
}

/// Replaces each coordinate of a point in turn.
fn points_near_planes(p: [f64; 3]) -> Vec<[f64; 3]> {
    let mut points = Vec::new();
    for axis in 0..3 {
        for d in distances().into_iter().flat_map(|d| [d, -d]) {
            let mut q = p;
            q[axis] = d;
            points.push(q);
        }
    }
    points
}
