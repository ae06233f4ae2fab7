//! A haptic loop must not wait for memory: after the first round a probe asks for none.

use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;
use touchoff::scenes::Path;
use touchoff::{Law, Pose, Probe};
use touchoff_tests::measure::kernels::{part, poses};

#[global_allocator]
static COUNTED: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

fn everything(probe: &mut Probe<'_>, poses: &[Pose]) -> usize {
    poses
        .iter()
        .map(|pose| {
            let posture = probe.posture(pose);
            let deepest = probe.deepest(pose).map_or(0, |deepest| deepest.triangle as usize % 2);
            usize::from(probe.detect(pose))
                + posture.colliding
                + deepest
                + probe.wrench(pose).colliding
                + probe.contacts(pose).len()
        })
        .sum()
}

// One test, since the counts are those of the process.
#[test]
fn a_second_round_allocates_nothing() {
    let part = part(20_000);
    for law in [Law::Thesis, Law::Gradient] {
        for path in Path::ALL {
            let poses = poses(path, 500);
            let mut probe =
                Probe::new(&part, tools_library::find("Fig73").expect("a tool")).law(law);
            let first = everything(&mut probe, &poses);
            assert!(first > 0);
            let region = Region::new(COUNTED);
            let second = everything(&mut probe, &poses);
            let change = region.change();
            assert_eq!((second, change.allocations, change.reallocations), (first, 0, 0));
        }
    }
}
