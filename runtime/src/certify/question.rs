//! What is asked of a tool: how deep some of its surfaces are in a part, or how near to it.

use super::hull::Hull;
use super::owners::Owners;
use super::section::Section;
use super::shell::Shell;
use crate::tool::Card;

/// A question, and what bounds its answer.
pub(super) struct Question {
    pub(super) owners: Owners,
    pub(super) hull: Hull<f32>,
    pub(super) exact: Hull<f64>,
    pub(super) shell: Shell,
    /// How deep the owners may be; below 0, how far they have to keep.
    pub(super) limit: f64,
}

impl Question {
    /// Of the features of some surfaces; `margin` is how far `f32` takes a place.
    pub(super) fn new(
        section: &Section,
        margin: f64,
        limit: f64,
        surfaces: impl Fn(usize) -> bool,
    ) -> Question {
        let owners = Owners::of(section, surfaces);
        let (hull, exact) = if limit < 0.0 {
            (
                Hull::holding(section, &owners, margin),
                Hull::holding(section, &owners, section.error),
            )
        } else {
            let zones = owners.zones(section, limit - 8.0 * section.error);
            (Hull::new(section, &zones, margin), Hull::new(section, &zones, section.error))
        };
        Question { hull, exact, shell: Shell::new(section, &owners), owners, limit }
    }

    /// How deep a tool is that is known by its field; `errors` are how far `f32` and `f64` take a place.
    pub(super) fn of_field(card: &Card, steep: f64, errors: [f64; 2]) -> Question {
        Question {
            owners: Owners::default(),
            hull: Hull::about(card, steep, errors[0]),
            exact: Hull::about(card, steep, errors[1]),
            shell: Shell::about(card),
            limit: 0.0,
        }
    }

    /// What allowances of surfaces come to, each in its place of the card's list: of all surfaces that
    /// may be as deep one question, and one of those that have to keep as far.
    pub(super) fn all(section: &Section, margin: f64, allowed: &[f64]) -> Vec<Question> {
        let depths =
            allowed.iter().map(|allowed| allowed.max(0.0)).filter(|depth| depth.is_finite());
        let gaps = allowed.iter().copied().filter(|allowed| *allowed < 0.0);
        let mut limits: Vec<f64> = depths.chain(gaps).collect();
        limits.sort_by(f64::total_cmp);
        limits.dedup();
        let question = |limit: f64| {
            Question::new(section, margin, limit, |surface| {
                let allowed = allowed[surface];
                if limit < 0.0 { allowed == limit } else { allowed.max(0.0) == limit }
            })
        };
        limits.into_iter().rev().map(question).collect()
    }
}
