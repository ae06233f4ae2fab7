//! Item 12: many cycles with a running checksum, repeated on two threads and at every SIMD level.

use super::ledger::{Kind, Ledger};
use super::scene::PointSet;
use super::truth::Subject;
use nalgebra::Point3;
use touchoff::{Level, Part, Pose, Probe};
use touchoff_tests::oracle::rng::Rng;

const OTHER_CHECKSUM: Kind = Kind::forbidden_event("another checksum");
const CONTACT_SHARE: Kind = Kind::informational("touching", "share of cycles");

/// Number of cycles with a checksum of their own, whichever thread runs them.
const CYCLES_PER_CHUNK: usize = 500;

/// Returns all SIMD levels of this machine, the best first.
fn levels() -> Vec<(&'static str, Level)> {
    let best = Level::new();
    let mut levels = vec![("best", best)];
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        levels.extend(best.as_avx512().map(|level| ("AVX-512", Level::Avx512(level))));
        levels.extend(best.as_avx2().map(|level| ("AVX2", Level::Avx2(level))));
        levels.extend(best.as_sse4_2().map(|level| ("SSE4.2", Level::Sse4_2(level))));
        levels.extend(best.as_sse2().map(|level| ("SSE2", Level::Sse2(level))));
    }
    levels.push(("baseline", Level::baseline()));
    levels
}

/// Repeats the same cycles in all configurations and compares the checksums.
pub(super) fn cycles(subject: &Subject, count: usize, rng: &mut Rng, ledger: &mut Ledger) {
    let point_set = PointSet::near_tool(subject, 96, 2f64.powi(-20), rng);
    let part = point_set.part();
    let seed = rng.bits();
    let checksum = |level, threads| run_cycles(subject, &part, (level, threads), (count, seed));
    let levels = levels();
    let (first, touching) = checksum(levels[0].1, 1);
    let share = touching as f64 / count as f64;
    ledger.record_info(CONTACT_SHARE, count, share, &format!("checksum {first:016x}"));
    ledger.count(OTHER_CHECKSUM, checksum(levels[0].1, 2).0 != first, || "two threads".to_owned());
    for (name, level) in &levels[1..] {
        ledger.count(OTHER_CHECKSUM, checksum(*level, 1).0 != first, || (*name).to_owned());
    }
}

fn mix(sum: u64, bits: u64) -> u64 {
    (sum.rotate_left(5) ^ bits).wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

/// Returns the checksum of all cycles, and the number of cycles with contact.
fn run_cycles(
    subject: &Subject,
    part: &Part,
    (level, threads): (Level, usize),
    (count, seed): (usize, u64),
) -> (u64, usize) {
    let chunks = count.div_ceil(CYCLES_PER_CHUNK);
    let run_thread = |thread: usize| {
        let mut probe = Probe::new(part, subject.tool).with_level(level);
        let chunks_of_thread = (thread..chunks).step_by(threads);
        chunks_of_thread
            .map(|chunk| {
                let cycles = chunk * CYCLES_PER_CHUNK..((chunk + 1) * CYCLES_PER_CHUNK).min(count);
                let (sum, touching) = run_chunk(&mut probe, subject, cycles, seed);
                (chunk, sum, touching)
            })
            .collect::<Vec<_>>()
    };
    let mut sums: Vec<(usize, u64, usize)> = std::thread::scope(|scope| {
        let run_thread = &run_thread;
        let threads_running: Vec<_> =
            (0..threads).map(|k| scope.spawn(move || run_thread(k))).collect();
        let results =
            threads_running.into_iter().map(|thread| thread.join().expect("no cycle panics"));
        results.flatten().collect()
    });
    sums.sort_unstable();
    let touching = sums.iter().map(|(.., touching)| touching).sum();
    (sums.iter().fold(0, |sum, (_, chunk, _)| mix(sum, *chunk)), touching)
}

fn run_chunk(
    probe: &mut Probe<'_>,
    subject: &Subject,
    cycles: std::ops::Range<usize>,
    seed: u64,
) -> (u64, usize) {
    let [radius, height] = subject.oracle.extent();
    let (mut sum, mut touching) = (0, 0);
    for cycle in cycles {
        let mut rng = Rng::new(seed ^ (cycle as u64).wrapping_mul(0xd134_2543_de82_ef95));
        let tip = [0; 2].map(|_| rng.between(-0.2, 0.2) * radius);
        let tip = Point3::new(tip[0], tip[1], rng.between(-0.1, 0.1) * height);
        let [a, b, c] = [0; 3].map(|_| rng.between(-0.1, 0.1));
        let norm = (1.0 + a * a + b * b + c * c).sqrt();
        let quaternion = [a / norm, b / norm, c / norm, 1.0 / norm];
        let pose = Pose::from_quaternion(tip, quaternion).expect("a unit quaternion");
        let wrench = probe.wrench(&pose);
        touching += usize::from(wrench.colliding > 0);
        let (force, torque) = (wrench.force, wrench.torque);
        for number in
            [force.x, force.y, force.z, torque.x, torque.y, torque.z, wrench.depth(), wrench.energy]
        {
            sum = mix(sum, number.to_bits());
        }
        sum = mix(sum, wrench.colliding as u64);
    }
    (sum, touching)
}
