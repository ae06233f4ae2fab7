//! What is asked of a tool: how deep some of its surfaces are in a part, or how near to it.

use crate::certify::body::field::{Field, Scratch};
use crate::certify::body::owners::Owners;
use crate::certify::body::section::Section;
use crate::certify::bounds::hull::Hull;
use crate::certify::bounds::shell::Shell;
use crate::certify::space::Point;
use crate::tool::{Card, Shape};

/// A question, and what bounds its answer.
pub(crate) struct Question {
    pub(crate) owners: Owners,
    pub(crate) hull: Hull<f32>,
    pub(crate) exact: Hull<f64>,
    pub(crate) shell: Shell,
    /// How deep the owners may be; below 0, how far they have to keep.
    pub(crate) limit: f64,
    /// Places that may not be in the part either, and how deep they are: one of each stretch of the axis
    /// that the owners have.
    pub(crate) cores: Vec<(Point, f64)>,
}

/// Of how many places of the axis between two heights cores are chosen.
const PLACES: u32 = 64;

/// The deepest place of each run of owned ones that are deeper than a limit.
fn cores(places: impl Iterator<Item = (Point, Option<f64>)>, limit: f64) -> Vec<(Point, f64)> {
    let mut runs: Vec<Option<(Point, f64)>> = vec![None];
    for (point, depth) in places {
        let run = runs.last_mut().expect("one at least");
        match depth.filter(|depth| *depth > limit.max(0.0)) {
            Some(depth) if run.is_none_or(|(_, most)| depth > most) => *run = Some((point, depth)),
            Some(_) => (),
            None => runs.push(None),
        }
    }
    runs.into_iter().flatten().collect()
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
                cores: Vec::new(),
            };
        }
        let owners = Owners::of(section, surfaces);
        let zones = owners.zones(section, limit - 8.0 * section.error);
        let part = |k: u32, n: u32| f64::from(k) / f64::from(n);
        let along = |d: f64| {
            let heights = section.slabs.iter().flat_map(|slab| {
                (0..PLACES).map(|k| slab.low + (slab.high - slab.low) * part(2 * k + 1, 2 * PLACES))
            });
            let places = heights.map(|z| {
                let depth = section.depth_at(&owners, [d, z]);
                ([d, 0.0, z], depth.map(|depth| depth.value))
            });
            cores(places, limit)
        };
        // What owns none of the axis may own places about it.
        let mut ways = (0..16).map(|k| along(section.size * part(k, 16)));
        let cores = ways.find(|cores| !cores.is_empty()).unwrap_or_default();
        Question {
            hull: Hull::new(section, &zones, margin),
            exact: Hull::new(section, &zones, section.error),
            shell: Shell::new(section, &owners),
            owners,
            limit,
            cores,
        }
    }

    /// Whether the places of the axis that are deeper than may be are one stretch.
    #[cfg(feature = "postures")]
    pub(crate) fn are_one_piece(rules: &[Question], section: &Section) -> bool {
        let part = |k: u32| f64::from(2 * k + 1) / f64::from(2 * PLACES);
        let heights = section
            .slabs
            .iter()
            .flat_map(|slab| (0..PLACES).map(|k| slab.low + (slab.high - slab.low) * part(k)));
        let deep = heights.map(|z| {
            rules.iter().filter(|rule| rule.limit >= 0.0).any(|rule| {
                let depth = section.depth_at(&rule.owners, [0.0, z]);
                depth.is_some_and(|depth| depth.value > rule.limit)
            })
        });
        let (mut stretches, mut before) = (0, false);
        for deep in deep {
            stretches += u32::from(deep && !before);
            before = deep;
        }
        stretches == 1
    }

    /// How deep a tool is that is known by its field; `errors` are how far `f32` and `f64` take a place.
    pub(crate) fn of_field(card: &Card, field: &Field<'_>, errors: [f64; 2]) -> Question {
        let [low, high] = card.reach();
        // A solid need not have the axis in it.
        let across = match card.shape {
            Shape::Revolved => [[0.0; 2]; 2],
            Shape::Solid { across } => across,
        };
        let steps = if card.shape == Shape::Revolved { [1, 1, 16 * PLACES] } else { [16; 3] };
        let mut scratch = Scratch::default();
        let mut best = Vec::new();
        for x in 1..=steps[0] {
            for y in 1..=steps[1] {
                let places = (1..steps[2]).map(|k| {
                    let at = |[from, to]: [f64; 2], k, n| {
                        from + (to - from) * f64::from(k) / f64::from(n)
                    };
                    let [x, y] = [at(across[0], x, steps[0] + 1), at(across[1], y, steps[1] + 1)];
                    let point = [x, y, at([low, high], k, steps[2])];
                    (point, Some(field.depth(&mut scratch, point).value))
                });
                best.extend(cores(places, 0.0));
            }
        }
        best.sort_by(|(_, depth), (_, other)| other.total_cmp(depth));
        best.truncate(1);
        Question {
            owners: Owners::default(),
            hull: Hull::about(card, field.steep, errors[0]),
            exact: Hull::about(card, field.steep, errors[1]),
            shell: Shell::about(card),
            limit: 0.0,
            cores: best,
        }
    }

    /// What allowances of surfaces come to, each in its place of the card's list: of all surfaces that
    /// may be as deep one question, and one of those that have to keep as far.
    pub(crate) fn all(section: &Section, margin: f64, allowed: &[f64]) -> Vec<Question> {
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
