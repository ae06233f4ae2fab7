//! The stress list (section 6 of the accuracy reference), every item for every tool of the library, judged in 256 bits.
//!
//! A *figure* is an error in the unit of its bar; each item gives the worst of each kind, and where it is, to the last bit. All is drawn
//! from one seed, tool by tool and item by item, so a page comes out the same however many cores make it.

mod alike;
mod axis;
mod borders;
mod corners;
mod cycles;
mod degenerate;
mod denormal;
mod input;
pub mod judge;
mod leaves;
pub mod ledger;
mod moved;
mod near;
pub mod page;
mod poses;
mod scaled;
mod scene;
mod section;
mod tangent;
mod text;
pub mod truth;

use crate::parallel;
use ledger::{Item, Ledger, Row};
use touchoff_tests::oracle::draw::Draw;
use truth::{Subject, subjects};

/// -300, -290 … 300.
const POWERS: [i32; 61] = {
    let (mut powers, mut power, mut at) = ([0; 61], -300, 0);
    while at < powers.len() {
        powers[at] = power;
        power += 10;
        at += 1;
    }
    powers
};

/// How much is looked at.
#[derive(Clone, Copy, Debug)]
pub struct Amount {
    /// What all is drawn from.
    pub seed: u64,
    /// Points of a curve on which borders are looked for.
    pub borders: usize,
    /// Starts of Newton's method for two borders, and every how many-th two are taken.
    pub starts: (usize, usize),
    /// Heights on the axis.
    pub heights: usize,
    /// Points of a scaled scene, and by which powers of two it is.
    pub scaled: (usize, &'static [i32]),
    /// Points of a scene, and poses.
    pub scene: (usize, usize),
    /// Points beside a degenerate profile.
    pub degenerate: usize,
    /// Orders of the points of a tree.
    pub orders: usize,
    /// Cycles of a tool.
    pub cycles: usize,
}

impl Amount {
    /// All that the page has.
    pub fn full(seed: u64) -> Amount {
        // Ten million cycles, for all tools together.
        let cycles = 10_000_000usize.div_ceil(tools_library::TOOLS.len());
        Amount {
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

    /// A sample.
    pub fn sample(seed: u64) -> Amount {
        Amount {
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

/// The rows of the tools and items that are wanted, on all cores.
pub fn measure(
    amount: Amount,
    item: impl Fn(Item) -> bool,
    tool: impl Fn(&str) -> bool,
) -> Vec<Row> {
    let subjects: Vec<Subject> = subjects().into_iter().filter(|s| tool(s.name())).collect();
    let items = Item::all().filter(|one| item(*one));
    let mut tasks: Vec<(Item, &Subject)> =
        items.flat_map(|item| subjects.iter().map(move |subject| (item, subject))).collect();
    tasks.sort_by_key(|(item, subject)| (*item, subject.name()));
    let rows = parallel::rows(tasks.len(), |k| one(amount, tasks[k].0, tasks[k].1));
    let mut rows: Vec<Row> = rows.into_iter().flatten().collect();
    if item(Item(9)) {
        rows.extend(degenerate::degenerate(
            Item(9),
            amount.degenerate,
            &mut Draw::new(amount.seed),
        ));
    }
    if item(Item(10)) {
        rows.extend(input::refused(Item(10)));
    }
    rows.sort_by_key(|row| row.item);
    rows
}

/// An item's rows of a tool.
fn one(amount: Amount, item: Item, subject: &Subject) -> Vec<Row> {
    let name = subject.name();
    let mut ledger = Ledger::new(item, name);
    let letters = name.bytes().fold(0u64, |sum, c| sum.wrapping_mul(31).wrapping_add(c.into()));
    let mut draw = Draw::new(amount.seed ^ letters.wrapping_mul(64).wrapping_add(item.0 as u64));
    match item.0 {
        1 => near::exactly(subject, amount.borders, &mut draw, &mut ledger),
        2 => near::beside(subject, amount.borders, &mut draw, &mut ledger),
        3 => corners::meeting(subject, amount.starts, &mut draw, &mut ledger),
        4 => axis::axis(subject, amount.heights, &mut ledger),
        5 => scaled::scaled(subject, amount.scaled, &mut draw, &mut ledger),
        6 => moved::moved(subject, amount.scene, &mut draw, &mut ledger),
        7 => poses::poses(subject, amount.scene.0, &mut draw, &mut ledger),
        8 => tangent::tangent(subject, amount.scene.0 / 8, &mut draw, &mut ledger),
        10 => input::few(subject, amount.scene.1, &mut draw, &mut ledger),
        11 => {
            let poses = amount.scene.1.div_ceil(4);
            leaves::leaves(subject, (amount.orders, poses), &mut draw, &mut ledger);
        }
        12 => cycles::cycles(subject, amount.cycles, &mut draw, &mut ledger),
        13 => denormal::denormal(subject, amount.scene.0, &mut draw, &mut ledger),
        14 => alike::alike(subject, amount.scene, &mut draw, &mut ledger),
        _ => {}
    }
    ledger.rows()
}
