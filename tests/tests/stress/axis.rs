//! Item 4: points at d = ±0, 5e-324 and 2^-540 from the axis: at the heights of all corners and an ulp beside them, at
//! ±0, ±5e-324 and 2^-540, and at others. Of a solid without an axis, each coordinate of a corner takes these values.

use crate::truth::Subject;
use crate::validator::Validator;
use crate::{check_tools, extent};
use touchoff_tests::points::heights;

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
    let around = |z: f64| {
        distances().map(|d| [[d, 0.0, z], [-0.0, d, z], [-d, d, z], [-d, -0.0, z]]).into_iter()
    };
    let heights = heights(&*subject.oracle, extent(4, 200) as u32);
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
