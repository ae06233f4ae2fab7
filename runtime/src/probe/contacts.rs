//! Contacts one by one, and what can be said of them together (Ho 1999, section 4.4).

use super::Weights;
use super::state::QueryState;
use crate::pose::Pose;
use crate::tool::Card;
use nalgebra::{Point3, Vector3};

/// A point of the part inside the tool. Vectors are in the world's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Where it is, in the part's unit.
    pub point: Point3<f64>,
    /// The part's outward normal there.
    pub normal: Vector3<f64>,
    /// The part's triangle that it lies on.
    pub triangle: u32,
    /// The tool's region, by its place in the card's list.
    pub region: usize,
    /// The tool's surface that the region belongs to, by its place in the card's list.
    pub surface: usize,
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
    /// For how much the point counts.
    pub weight: f64,
}

/// Lists what the probe has just felt.
pub(super) fn list(state: &QueryState<'_>, card: &Card, pose: &Pose, contacts: &mut Vec<Contact>) {
    let (felt, tree) = (&state.felt, state.tree);
    let rotation = pose.rotation();
    for at in felt.places() {
        let index = state.candidates.indices()[at] as usize;
        let vector = |lists: &[Vec<f64>; 3]| Vector3::from(lists.each_ref().map(|list| list[at]));
        let region = felt.region[at] as usize;
        contacts.push(Contact {
            point: pose.tip() + tree.relative_to_tip(&state.view, index),
            normal: tree.normal(index).into(),
            triangle: tree.triangle(index),
            region,
            surface: card.regions[region].surface,
            depth: felt.depth[at] * state.length,
            magnitude: felt.magnitude[at],
            direction: rotation * vector(&felt.direction),
            gradient: rotation * vector(&felt.gradient),
            niceness: felt.niceness[at],
            weight: match state.weights {
                Weights::Area => tree.weight(index),
                Weights::Unit => 1.0,
            },
        });
    }
}

/// Sum, mean, least and greatest of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// The sum, unweighted.
    pub sum: f64,
    /// The mean.
    pub mean: f64,
    /// The least.
    pub min: f64,
    /// The greatest.
    pub max: f64,
}

/// What some contacts have of a quantity together; `None` without contacts.
///
/// ```
/// # use touchoff::{Contact, summary};
/// # let contacts: Vec<Contact> = Vec::new();
/// let depths = summary(&contacts, |contact| contact.depth);
/// ```
pub fn summary(contacts: &[Contact], of: impl Fn(&Contact) -> f64) -> Option<Summary> {
    let first = of(contacts.first()?);
    let start = Summary { sum: 0.0, mean: 0.0, min: first, max: first };
    let all = contacts.iter().map(of).fold(start, |all, value| Summary {
        sum: all.sum + value,
        min: all.min.min(value),
        max: all.max.max(value),
        ..all
    });
    Some(Summary { mean: all.sum / contacts.len() as f64, ..all })
}
