//! Item 12: many cycles of a pose and a wrench, ten million over all tools in the full list, repeated on two threads and
//! at every SIMD level of this machine. All bits of each wrench are the same.

use crate::prelude::*;
use std::ops::Range;
use std::thread;
use touchoff::{Level, Part, Probe};
use touchoff_tests::evaluations::levels;

#[test]
fn cycles_have_the_same_bits_on_all_threads_and_levels() {
    let count = extent(100, 10_000_000 / touchoff_tools::TOOLS.len());
    check_tools(12, |subject, rng, checks| {
        let part = PointSet::near_tool(subject, 96, 2f64.powi(-20), rng).part();
        let cycles = Cycles { subject, part: &part, seed: rng.bits() };
        let expected = cycles.run(Level::new(), 0..count);
        let middle = count / 2;
        let on_two_threads = thread::scope(|scope| {
            let first = scope.spawn(|| cycles.run(Level::new(), 0..middle));
            let second = cycles.run(Level::new(), middle..count);
            [first.join().expect("no cycle panics"), second].concat()
        });
        let mut runs = vec![("two threads", on_two_threads)];
        // The first level is that of `expected`.
        for (name, level) in levels().into_iter().skip(1) {
            runs.push((name, cycles.run(level, 0..count)));
        }
        for (name, actual) in runs {
            let different = expected.iter().zip(&actual).position(|(a, b)| a != b);
            let place = || format!("cycle {different:?}, {name}");
            checks.never("other bits", different.is_some() || actual.len() != count, place);
        }
    });
}

/// Poses of a tool near a part. The number of a cycle gives its pose.
struct Cycles<'a> {
    subject: &'a Subject,
    part: &'a Part,
    seed: u64,
}

impl Cycles<'_> {
    /// Returns a checksum of the wrench of each cycle.
    fn run(&self, level: Level, cycles: Range<usize>) -> Vec<u64> {
        let [radius, height] = self.subject.oracle.extent();
        let mut probe = Probe::new(self.part, self.subject.tool).with_level(level);
        let checksum = |cycle: usize| {
            let mut rng = Rng::new(self.seed ^ (cycle as u64).wrapping_mul(0xd134_2543_de82_ef95));
            let [x, y] = [0; 2].map(|_| rng.between(-0.2, 0.2) * radius);
            let tip = Point3::new(x, y, rng.between(-0.1, 0.1) * height);
            let [a, b, c] = [0; 3].map(|_| rng.between(-0.1, 0.1));
            let norm = (1.0 + a * a + b * b + c * c).sqrt();
            let wrench = probe.wrench(&pose(tip, [a, b, c, 1.0].map(|q| q / norm)));
            let numbers = wrench.force.iter().chain(&wrench.torque).copied();
            let bits = numbers.chain([wrench.depth(), wrench.energy]).map(f64::to_bits);
            bits.chain([wrench.colliding as u64]).fold(0u64, |sum, bits| {
                (sum.rotate_left(5) ^ bits).wrapping_mul(0x9e37_79b9_7f4a_7c15)
            })
        };
        cycles.map(checksum).collect()
    }
}
