//! The points of a contact: the deepest of them, the quantities that a posture is judged by (Ho 1999, chapter 6), and
//! lists of them with summary statistics (Ho 1999, section 4.4).

use crate::id::{SurfaceId, TriangleId};
use crate::pose::Pose;
use crate::probe::Weights;
use crate::probe::state::QueryState;
use crate::tool::ToolInfo;
use nalgebra::{Point3, Vector3};

/// A point of the part inside the tool. Vectors are in the world's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Contact {
    /// The position, in the part's unit.
    pub point: Point3<f64>,
    /// The part's outward normal at the point.
    pub normal: Vector3<f64>,
    /// The part's triangle on which the point lies.
    pub triangle: TriangleId,
    /// Index of the tool's region in the tool's list.
    pub region: usize,
    /// The region's surface.
    pub surface: SurfaceId,
    /// Penetration depth, at least 0, in the part's unit.
    pub depth: f64,
    /// Magnitude.
    pub magnitude: f64,
    /// Unit vector to the tool's nearest surface.
    pub direction: Vector3<f64>,
    /// The magnitude's gradient.
    pub gradient: Vector3<f64>,
    /// Niceness, at least 0.
    pub niceness: f64,
    /// The point's weight.
    pub weight: f64,
}

/// Lists the points inside, from the last evaluation.
pub(super) fn collect(
    state: &QueryState<'_>,
    info: &ToolInfo,
    pose: &Pose,
    contacts: &mut Vec<Contact>,
) {
    let (evaluations, tree) = (&state.evaluations, &*state.tree);
    let rotation = pose.rotation();
    for candidate in evaluations.inside_indices() {
        let index = state.candidates.indices()[candidate] as usize;
        let vector =
            |lists: &[Vec<f64>; 3]| Vector3::from(lists.each_ref().map(|list| list[candidate]));
        let region = evaluations.region[candidate] as usize;
        contacts.push(Contact {
            point: pose.tip() + tree.relative_to_tip(&state.view, index),
            normal: tree.normal(index).into(),
            triangle: tree.triangle(index),
            region,
            surface: info.regions[region].surface,
            depth: evaluations.depth[candidate] * state.length,
            magnitude: evaluations.magnitude[candidate],
            direction: rotation * vector(&evaluations.direction),
            gradient: rotation * vector(&evaluations.gradient),
            niceness: evaluations.niceness[candidate],
            weight: match state.weights {
                Weights::Area => tree.weight(index),
                Weights::Unit => 1.0,
            },
        });
    }
}

/// Sum, mean, minimum and maximum of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Summary {
    /// The sum, unweighted.
    pub sum: f64,
    /// The mean.
    pub mean: f64,
    /// The minimum.
    pub min: f64,
    /// The maximum.
    pub max: f64,
}

/// Returns summary statistics of a quantity over some contacts; `None` without contacts.
///
/// ```
/// # use touchoff::{Contact, summary};
/// # let contacts: Vec<Contact> = Vec::new();
/// let depths = summary(&contacts, |contact| contact.depth);
/// ```
pub fn summary(contacts: &[Contact], of: impl Fn(&Contact) -> f64) -> Option<Summary> {
    let first = of(contacts.first()?);
    // Minimum and maximum begin at a value that occurs.
    let start = Summary { sum: 0.0, mean: 0.0, min: first, max: first };
    let totals = contacts.iter().map(of).fold(start, |totals, value| Summary {
        sum: totals.sum + value,
        min: totals.min.min(value),
        max: totals.max.max(value),
        ..totals
    });
    Some(Summary { mean: totals.sum / contacts.len() as f64, ..totals })
}

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
    let tree = &*state.tree;
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
            // In the tool's unit, until the end.
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
