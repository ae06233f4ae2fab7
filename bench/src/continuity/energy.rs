//! The work that is done round closed loops, by the energy that is stored on the way.

use super::LAWS;
use super::loops::{Kind, Loop};
use std::f64::consts::TAU;
use touchoff::{Law, Part, Probe, Tool};

/// Panels that a loop is cut into at first.
const PANELS: u32 = 4096;
/// Where in a panel the second round begins.
const GOLDEN: f64 = 0.618;
/// How often a panel is halved at most.
const HALVED: u32 = 30;
/// The work round a loop under one law.
#[derive(Clone, Copy, Debug, Default)]
pub struct Work {
    /// By the largest energy stored on the way.
    pub share: f64,
    /// What is not known of it, by the same: bounds of all panels, as if their signs were random, or half of
    /// what two rounds differ by.
    pub error: f64,
    /// How many poses were asked about.
    pub poses: usize,
}

/// What is found of a tool on a loop.
#[derive(Clone, Debug)]
pub struct Row {
    /// The tool.
    pub tool: String,
    /// The loop.
    pub kind: Kind,
    /// Points in contact on average.
    pub colliding: f64,
    /// The largest energy on the way, mm⁴.
    pub energy: f64,
    /// Under each law of [`LAWS`].
    pub work: [Work; 3],
}

/// The work under each law, each panel known to within a part of the stored energy: one of the gradient's law, one of the others. `None` if the tool cannot be brought to the block.
pub fn row(part: &Part, tool: &dyn Tool, kind: Kind, within: [f64; 2]) -> Option<Row> {
    let looped = Loop::new(part, tool, kind)?;
    let mut row = Row {
        tool: tool.card().name.to_string(),
        kind,
        colliding: 0.0,
        energy: 0.0,
        work: [Work::default(); 3],
    };
    for (law, work) in LAWS.into_iter().zip(&mut row.work) {
        let mut probe = Probe::new(part, tool).law(law);
        let within = within[usize::from(law != Law::Gradient)];
        let (stored, colliding) = stored(&mut probe, &looped);
        let mut round = Round { probe, looped, within: within * stored, squares: 0.0, poses: 0 };
        // Once more from between the poses: what comes and goes within a panel is not seen by both.
        let [once, again] = [0.0, GOLDEN].map(|from| round.all(from) / stored);
        let error = (round.squares / 2.0).sqrt() / stored;
        *work = Work {
            share: f64::midpoint(once, again),
            error: error.max((once - again).abs() / 2.0),
            poses: round.poses,
        };
        (row.energy, row.colliding) = (stored, colliding);
    }
    Some(row)
}

/// The largest energy on the way, and the points in contact on average.
fn stored(probe: &mut Probe<'_>, looped: &Loop) -> (f64, f64) {
    let poses = PANELS as usize;
    let felt = (0..poses).map(|k| probe.wrench(&looped.at(TAU * k as f64 / poses as f64).pose));
    let (energy, colliding) = felt.fold((0f64, 0), |(energy, colliding), felt| {
        (energy.max(felt.energy), colliding + felt.colliding)
    });
    (energy, colliding as f64 / poses as f64)
}

/// The sum over a loop, by Boole's rule on panels of five poses that are halved where the force has a kink or a jump: where a point comes,
/// goes or crosses a border. Wherever in a panel it jumps, the fourth difference is no less than the jump, so that its product with the
/// way between two poses bounds what is wrong.
struct Round<'a> {
    probe: Probe<'a>,
    looped: Loop,
    within: f64,
    squares: f64,
    poses: usize,
}

impl Round<'_> {
    fn all(&mut self, from: f64) -> f64 {
        let step = TAU / f64::from(PANELS);
        let mut sum = 0.0;
        for k in 0..PANELS {
            let from = step * (f64::from(k) + from);
            let five = [0.0, 0.25, 0.5, 0.75, 1.0].map(|part| self.power(from + part * step));
            sum += self.panel(from, step, five, HALVED);
        }
        sum
    }

    fn panel(&mut self, from: f64, width: f64, [a, b, c, d, e]: [f64; 5], left: u32) -> f64 {
        let off = width / 4.0 * (a - 4.0 * b + 6.0 * c - 4.0 * d + e).abs();
        if off <= self.within || left == 0 {
            self.squares += off * off;
            return width / 90.0 * (7.0 * (a + e) + 32.0 * (b + d) + 12.0 * c);
        }
        let between = |k: f64| from + width * k / 8.0;
        let [ab, bc, cd, de] = [1.0, 3.0, 5.0, 7.0].map(|k| self.power(between(k)));
        self.panel(from, width / 2.0, [a, ab, b, bc, c], left - 1)
            + self.panel(between(4.0), width / 2.0, [c, cd, d, de, e], left - 1)
    }

    /// The work of force and torque by the loop's parameter.
    fn power(&mut self, t: f64) -> f64 {
        let moving = self.looped.at(t);
        let felt = self.probe.wrench(&moving.pose);
        self.poses += 1;
        felt.force.dot(&moving.velocity) + felt.torque.dot(&moving.spin)
    }
}
