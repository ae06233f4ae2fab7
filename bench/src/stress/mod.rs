//! The stress list (section 6 of the accuracy reference): every item for every library tool, validated in 256 bits.
//!
//! A *figure* is an error in the unit of its limit. Each item gives the worst figure of each kind and its location, to
//! the last bit. All random numbers come from one seed, tool by tool and item by item, so a page does not depend on the
//! number of cores.

mod axis;
mod border_points;
mod borders;
mod corners;
mod cycles;
mod degenerate;
mod denormal;
mod equivalent;
mod input;
mod leaves;
pub mod ledger;
pub mod page;
mod poses;
mod scaled;
mod scene;
mod section;
mod tangent;
mod text;
mod translated;
pub mod truth;
pub mod validator;

use crate::parallel;
use ledger::{Item, Ledger, Row};
use touchoff_tests::oracle::rng::Rng;
use truth::{Subject, subjects};

/// The exponents -300, -290 … 300.
const POWERS: [i32; 61] = {
    let (mut powers, mut power, mut index) = ([0; 61], -300, 0);
    while index < powers.len() {
        powers[index] = power;
        power += 10;
        index += 1;
    }
    powers
};

/// Extent of a measurement.
#[derive(Clone, Copy, Debug)]
pub struct StressSettings {
    /// The seed of all random numbers.
    pub seed: u64,
    /// Number of points per curve at which borders are searched for.
    pub borders: usize,
    /// Number of starts of Newton's method per pair of borders, and the stride over the pairs.
    pub starts: (usize, usize),
    /// Number of heights on the axis.
    pub heights: usize,
    /// Number of points of a scaled scene, and the exponents of two by which it is scaled.
    pub scaled: (usize, &'static [i32]),
    /// Number of points of a scene, and number of poses.
    pub scene: (usize, usize),
    /// Minimum number of points for a degenerate profile.
    pub degenerate: usize,
    /// Number of orders of a tree's points.
    pub orders: usize,
    /// Number of cycles per tool.
    pub cycles: usize,
}

impl StressSettings {
    /// Returns the extent of the full page.
    pub fn full(seed: u64) -> StressSettings {
        // Ten million cycles over all tools together.
        let cycles = 10_000_000usize.div_ceil(tools_library::TOOLS.len());
        StressSettings {
            seed,
            borders: 16,
            starts: (3, 1),
            heights: 200,
            scaled: (2_000, &POWERS),
            scene: (200, 8),
            degenerate: 4_000,
            orders: 8,
            cycles,
        }
    }

    /// Returns the extent of a sample.
    pub fn sample(seed: u64) -> StressSettings {
        StressSettings {
            seed,
            borders: 1,
            starts: (1, 3),
            heights: 4,
            scaled: (60, &[-30, 150]),
            scene: (12, 1),
            degenerate: 200,
            orders: 2,
            cycles: 100,
        }
    }
}

/// Validates the selected tools and items, in parallel, and returns the rows by item.
pub fn measure(
    settings: StressSettings,
    item: impl Fn(Item) -> bool,
    tool: impl Fn(&str) -> bool,
) -> Vec<Row> {
    let subjects: Vec<Subject> = subjects().into_iter().filter(|s| tool(s.name())).collect();
    let items = Item::all().filter(|candidate| item(*candidate));
    let mut tasks: Vec<(Item, &Subject)> =
        items.flat_map(|item| subjects.iter().map(move |subject| (item, subject))).collect();
    tasks.sort_by_key(|(item, subject)| (*item, subject.name()));
    let rows = parallel::rows(tasks.len(), |k| measure_item(settings, tasks[k].0, tasks[k].1));
    let mut rows: Vec<Row> = rows.into_iter().flatten().collect();
    if item(Item(9)) {
        rows.extend(degenerate::degenerate_profiles(
            Item(9),
            settings.degenerate,
            &mut Rng::new(settings.seed),
        ));
    }
    if item(Item(10)) {
        rows.extend(input::invalid_input(Item(10)));
    }
    rows.sort_by_key(|row| row.item);
    rows
}

/// Returns the rows of one item for one tool.
fn measure_item(settings: StressSettings, item: Item, subject: &Subject) -> Vec<Row> {
    let name = subject.name();
    let mut ledger = Ledger::new(item, name);
    let name_hash = name.bytes().fold(0u64, |sum, c| sum.wrapping_mul(31).wrapping_add(c.into()));
    let mut rng = Rng::new(settings.seed ^ name_hash.wrapping_mul(64).wrapping_add(item.0 as u64));
    match item.0 {
        1 => border_points::points_on_borders(subject, settings.borders, &mut rng, &mut ledger),
        2 => border_points::points_near_borders(subject, settings.borders, &mut rng, &mut ledger),
        3 => corners::equidistant_points(subject, settings.starts, &mut rng, &mut ledger),
        4 => axis::axis_points(subject, settings.heights, &mut ledger),
        5 => scaled::scaled_scenes(subject, settings.scaled, &mut rng, &mut ledger),
        6 => translated::translated_scenes(subject, settings.scene, &mut rng, &mut ledger),
        7 => poses::aligned_poses(subject, settings.scene.0, &mut rng, &mut ledger),
        8 => tangent::tangent_contacts(subject, settings.scene.0 / 8, &mut rng, &mut ledger),
        10 => input::small_clouds(subject, settings.scene.1, &mut rng, &mut ledger),
        11 => {
            let poses = settings.scene.1.div_ceil(4);
            leaves::leaves(subject, (settings.orders, poses), &mut rng, &mut ledger);
        }
        12 => cycles::cycles(subject, settings.cycles, &mut rng, &mut ledger),
        13 => denormal::denormal(subject, settings.scene.0, &mut rng, &mut ledger),
        14 => equivalent::equivalent_scenes(subject, settings.scene, &mut rng, &mut ledger),
        _ => {}
    }
    ledger.rows()
}
