//! The deepest point of a contact, and the quantities that a posture is judged by (Ho 1999, chapter 6).

use super::state::QueryState;
use crate::id::TriangleId;
use crate::pose::Pose;
use crate::tool::ToolInfo;
use nalgebra::Point3;

/// The deepest point of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct DeepestPoint {
    /// The penetration depth, in the part's unit.
    pub depth: f64,
    /// The position, in the world's frame.
    pub point: Point3<f64>,
    /// The triangle on which the point lies.
    pub triangle: TriangleId,
}

/// The quantities that a posture is judged by.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Posture {
    /// Number of points of the part inside the tool.
    pub colliding: usize,
    /// The deepest point.
    pub deepest: Option<DeepestPoint>,
    /// The least niceness of all points inside; `None` without contact.
    pub niceness: Option<f64>,
    /// The largest penetration depth at a surface that does not cut, in the part's unit; `None` if no such surface is
    /// in contact.
    pub non_cutting_depth: Option<f64>,
}

/// Returns the deepest point of the last evaluation, the first one if several are equally deep.
pub(super) fn deepest(state: &QueryState<'_>, pose: &Pose) -> Option<DeepestPoint> {
    let mut deepest = None;
    for candidate in state.evaluations.inside_indices() {
        let depth = state.evaluations.depth[candidate];
        if deepest.is_none_or(|(deepest, _)| depth > deepest) {
            deepest = Some((depth, candidate));
        }
    }
    deepest.map(|(depth, candidate)| deepest_point(state, pose, candidate, depth))
}

/// Returns a candidate as a [`DeepestPoint`]; `depth` is in the tool's unit.
pub(super) fn deepest_point(
    state: &QueryState<'_>,
    pose: &Pose,
    candidate: usize,
    depth: f64,
) -> DeepestPoint {
    let index = state.candidates.indices()[candidate] as usize;
    let tree = state.tree;
    let point = pose.tip() + tree.relative_to_tip(&state.view, index);
    DeepestPoint { depth: depth * state.length, point, triangle: tree.triangle(index) }
}

/// Returns the posture of the last evaluation.
pub(super) fn posture(state: &QueryState<'_>, info: &ToolInfo, pose: &Pose) -> Posture {
    let evaluations = &state.evaluations;
    let (mut colliding, mut deepest, mut niceness) = (0, None, f64::INFINITY);
    let mut non_cutting_depth: Option<f64> = None;
    for candidate in evaluations.inside_indices() {
        colliding += 1;
        let depth = evaluations.depth[candidate];
        if deepest.is_none_or(|(deepest, _)| depth > deepest) {
            deepest = Some((depth, candidate));
        }
        niceness = niceness.min(evaluations.niceness[candidate]);
        if !info.surface_of(evaluations.region[candidate] as usize).cutting {
            non_cutting_depth = Some(non_cutting_depth.map_or(depth, |deepest| deepest.max(depth)));
        }
    }
    Posture {
        colliding,
        deepest: deepest.map(|(depth, candidate)| deepest_point(state, pose, candidate, depth)),
        niceness: (colliding > 0).then_some(niceness),
        non_cutting_depth: non_cutting_depth.map(|depth| depth * state.length),
    }
}
