//! What is asked of a tool: how deep some of its surfaces are in a part, or how near to it.

use crate::certify::body::field::Field;
use crate::certify::body::owners::Owners;
use crate::certify::body::section::Section;
use crate::certify::bounds::hull::Hull;
use crate::certify::bounds::shell::Shell;
use crate::certify::work::Setting;

/// A question, and what bounds its answer.
pub(crate) struct Question {
    pub(crate) owners: Owners,
    pub(crate) hull: Hull<f32>,
    pub(crate) exact: Hull<f64>,
    pub(crate) shell: Shell,
    /// How deep the owners may be; below 0, how far they have to keep.
    pub(crate) limit: f64,
}

impl Question {
    /// Of the features of some surfaces; `margin` is how far `f32` takes a place.
    pub(crate) fn new(
        section: &Section,
        margin: f64,
        limit: f64,
        surfaces: impl Fn(usize) -> bool,
    ) -> Question {
        if limit < 0.0 {
            let owners = Owners::near(section, surfaces);
            return Question {
                hull: Hull::holding(section, &owners, margin),
                exact: Hull::holding(section, &owners, section.error),
                shell: Shell::new(section, &owners),
                owners,
                limit,
            };
        }
        let owners = Owners::of(section, surfaces);
        let zones = owners.zones(section, limit - 8.0 * section.error);
        Question {
            hull: Hull::new(section, &zones, margin),
            exact: Hull::new(section, &zones, section.error),
            shell: Shell::new(section, &owners),
            owners,
            limit,
        }
    }

    /// Of some surfaces of a tool that is known by its field; `errors` are how far `f32` and `f64` take a
    /// place.
    pub(crate) fn of_field(
        field: &Field<'_>,
        errors: [f64; 2],
        limit: f64,
        surfaces: impl Fn(usize) -> bool,
    ) -> Question {
        let card = field.card();
        Question {
            owners: Owners::of_regions(card, |_, region| surfaces(region.surface)),
            hull: Hull::about(card, field.steep, errors[0]),
            exact: Hull::about(card, field.steep, errors[1]),
            shell: Shell::about(card),
            limit,
        }
    }

    /// What allowances of surfaces come to, each in its place of the card's list: of all surfaces that
    /// may be as deep one question, and one of those that have to keep as far.
    pub(crate) fn all(setting: &Setting<'_>, allowed: &[f64]) -> Vec<Question> {
        let depths =
            allowed.iter().map(|allowed| allowed.max(0.0)).filter(|depth| depth.is_finite());
        let gaps = allowed.iter().copied().filter(|allowed| *allowed < 0.0);
        let mut limits: Vec<f64> = depths.chain(gaps).collect();
        limits.sort_by(f64::total_cmp);
        limits.dedup();
        let question = |limit: f64| {
            setting.question(limit, |surface| {
                let allowed = allowed[surface];
                if limit < 0.0 { allowed == limit } else { allowed.max(0.0) == limit }
            })
        };
        limits.into_iter().rev().map(question).collect()
    }
}
