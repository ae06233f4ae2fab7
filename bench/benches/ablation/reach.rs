//! What rules out boxes and points: the envelope and the axis.

use crate::asked::{detect, wrench};
use crate::line::{Row, Setting};
use crate::without::OtherCard;
use tools_library::Fig73;
use touchoff::tool::{Card, Senses, Shape, Slab};
use touchoff::{Probe, Tool};

/// The envelope as one slab.
pub(crate) fn envelope(setting: &Setting) -> Vec<Row> {
    let single = OtherCard { tool: &Fig73, card: one_slab(Fig73.card()) };
    both(setting, ["detect", "wrench"], &Fig73, &single)
}

/// A tool that is taken for a solid without an axis.
pub(crate) fn axis(setting: &Setting) -> Vec<Row> {
    let card = Fig73.card();
    let radius = card.radius();
    let shape = Shape::Solid { across: [[-radius, radius]; 2] };
    let solid = OtherCard { tool: &Fig73, card: Card { shape, ..card.clone() } };
    both(setting, ["detect", "wrench"], &Fig73, &solid)
}

/// The whole reach and the largest radius.
fn one_slab(card: &Card) -> Card {
    let [low, high] = card.reach();
    Card { envelope: vec![Slab::new(low, high, card.radius())].into(), ..card.clone() }
}

/// Both questions of two tools.
fn both(
    setting: &Setting,
    [yes_or_no, all]: [&str; 2],
    with: &impl Senses,
    without: &impl Senses,
) -> Vec<Row> {
    let (with, without) = (Probe::new(setting.part, with), Probe::new(setting.part, without));
    vec![
        setting.compare(yes_or_no, &mut detect(with.another()), &mut detect(without.another())),
        setting.compare(all, &mut wrench(with), &mut wrench(without)),
    ]
}
