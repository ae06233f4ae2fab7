//! Item 4: distances d = ±0, 5e-324 and 2^-540 from the axis, or for a solid from its coordinate planes.

use super::ledger::Ledger;
use super::truth::Subject;
use super::validator::Validator;

const DISTANCES: [f64; 4] = [0.0, -0.0, 5e-324, 0.0];

/// Returns the distances from the axis.
fn distances() -> [f64; 4] {
    let mut distances = DISTANCES;
    distances[3] = 2f64.powi(-540);
    distances
}

/// Validates points on the axis: at the height of every corner and one ulp beside it, at and near 0, and at
/// `extra_heights`
/// more heights.
pub(super) fn axis_points(subject: &Subject, extra_heights: usize, ledger: &mut Ledger) {
    let validator = Validator::new(subject.tool, &*subject.truth);
    let corners = subject.oracle.corner_points();
    let points = if subject.oracle.is_revolved() {
        let height = subject.oracle.extent()[1];
        let mut heights: Vec<f64> = corners.into_iter().map(|[.., z]| z).collect();
        heights.sort_by(f64::total_cmp);
        heights.dedup();
        let mut heights_to_test: Vec<f64> =
            heights.iter().flat_map(|z| [*z, z.next_up(), z.next_down()]).collect();
        heights_to_test
            .extend((0..=extra_heights).map(|k| height * k as f64 / extra_heights as f64));
        heights_to_test.extend([-0.0, 5e-324, -5e-324, 2f64.powi(-540)]);
        heights_to_test.into_iter().flat_map(points_near_axis).collect()
    } else {
        corners.into_iter().flat_map(points_near_planes).collect::<Vec<_>>()
    };
    for points in points.chunks(1024) {
        validator.validate(points, ledger);
    }
}

fn points_near_axis(z: f64) -> Vec<[f64; 3]> {
    let rotations = |d: f64| [[d, 0.0, z], [-0.0, d, z], [-d, d, z], [-d, -0.0, z]];
    distances().into_iter().flat_map(rotations).collect()
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
