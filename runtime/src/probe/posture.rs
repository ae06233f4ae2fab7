//! How deep a contact is, and what a posture is judged by (Ho 1999, chapter 6).

use super::state::QueryState;
use crate::pose::Pose;
use crate::tool::Card;
use nalgebra::Point3;

/// The deepest point of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deepest {
    /// Its penetration depth, in the part's unit.
    pub depth: f64,
    /// Where it is, in the world.
    pub point: Point3<f64>,
    /// The triangle it lies on.
    pub triangle: u32,
}

/// What a posture is judged by.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Posture {
    /// How many points of the part are inside the tool.
    pub colliding: usize,
    /// The deepest of them.
    pub deepest: Option<Deepest>,
    /// The least niceness of all points; `None` without contact.
    pub niceness: Option<f64>,
    /// The penetration depth of the deepest point at a surface that does not cut, in the part's unit;
    /// `None` if no such surface touches.
    pub body: Option<f64>,
}

/// The deepest of what was felt, the first of several.
pub(super) fn deepest(state: &QueryState<'_>, pose: &Pose) -> Option<Deepest> {
    let mut most = None;
    for candidate in state.felt.places() {
        let depth = state.felt.depth[candidate];
        if most.is_none_or(|(most, _)| depth > most) {
            most = Some((depth, candidate));
        }
    }
    most.map(|(depth, candidate)| at(state, pose, candidate, depth))
}

/// A candidate as the deepest; its depth is in the tool's unit.
pub(super) fn at(state: &QueryState<'_>, pose: &Pose, candidate: usize, depth: f64) -> Deepest {
    let place = state.candidates.indices()[candidate] as usize;
    let tree = state.tree;
    let point = pose.tip() + tree.relative_to_tip(&state.view, place);
    Deepest { depth: depth * state.length, point, triangle: tree.triangle(place) }
}

/// What was felt as a posture.
pub(super) fn posture(state: &QueryState<'_>, card: &Card, pose: &Pose) -> Posture {
    let felt = &state.felt;
    let (mut colliding, mut most, mut niceness) = (0, None, f64::INFINITY);
    let mut body: Option<f64> = None;
    for candidate in felt.places() {
        colliding += 1;
        let depth = felt.depth[candidate];
        if most.is_none_or(|(most, _)| depth > most) {
            most = Some((depth, candidate));
        }
        niceness = niceness.min(felt.niceness[candidate]);
        if !card.surface_of(felt.region[candidate] as usize).cutting {
            body = Some(body.map_or(depth, |most| most.max(depth)));
        }
    }
    Posture {
        colliding,
        deepest: most.map(|(depth, candidate)| at(state, pose, candidate, depth)),
        niceness: (colliding > 0).then_some(niceness),
        body: body.map(|depth| depth * state.length),
    }
}
