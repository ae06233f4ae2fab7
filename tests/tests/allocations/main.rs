//! A haptic loop must not wait for memory: its cycles ask for none, however their contacts grow. After the first
//! round neither does a probe, nor a certifier.

mod growing;

use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;
use std::sync::atomic::AtomicBool;
use touchoff::certify::{Certifier, Clear, Facets};
use touchoff::haptic::{
    Axes, Hand, Limits, Rendering, Session, Settings, Unhurried, Watch, run, watched,
};
use touchoff::scenes::{Path, tube};
use touchoff::{Law, Pose, Probe};
use touchoff_tests::fixtures::{part, poses};

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

// Not of a harness: the counts are those of the process.
fn main() {
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
    a_certifier();
    a_haptic_loop();
    growing::no_cycle_allocates();
    growing::no_question_allocates();
}

/// Whether a tool that touches nothing is inside is asked of a ray, which does ask for memory.
fn a_certifier() {
    let facets = Facets::new(&tube());
    for name in ["Fig73Exact", "BallEr16"] {
        let tool = tools_library::find(name).expect("a tool");
        let mut certifier = Certifier::new(&facets, tool).expect("a profile");
        let mut round = |poses: &[Pose]| -> f64 {
            let depths = poses.iter().map(|pose| certifier.deepest(pose, 1e-6).depth[0]);
            depths.sum()
        };
        let poses: Vec<Pose> = Path::ALL.into_iter().flat_map(|path| poses(path, 200)).collect();
        let first = round(&poses);
        assert!(first > 0.0);
        let region = Region::new(COUNTED);
        let second = round(&poses);
        let change = region.change();
        assert_eq!((change.allocations, change.reallocations), (0, 0));
        assert!((first - second).abs() <= 1e-6 * poses.len() as f64);
        let touches = |pose: &&Pose| certifier.deepest(pose, 1e-6).depth[0] > 1e-3;
        let touching: Vec<Pose> = poses.iter().filter(touches).copied().collect();
        let mut all_touch =
            || touching.iter().all(|pose| matches!(certifier.clear(pose), Clear::Touching(_)));
        assert!(all_touch());
        let region = Region::new(COUNTED);
        let again = all_touch();
        let change = region.change();
        assert_eq!((again, change.allocations, change.reallocations), (true, 0, 0));
    }
}

/// Nor do cycles of the haptic loop, whatever the hand does, with somebody who looks on.
fn a_haptic_loop() {
    let part = part(20_000);
    let (rate, cycles) = (1000.0, 3_000);
    for name in ["Fig73Exact", "Block"] {
        let tool = tools_library::find(name).expect("a tool");
        let axes = if name == "Block" { Axes::Six } else { Axes::Five };
        let limits = Limits { axes, ..Limits::default() };
        for rendering in [None, Some(Rendering::Direct { scaled: true, damping: 1e-3 })] {
            let settings = Settings { rendering, ..Settings::new(rate) };
            let probe = Probe::new(&part, tool).law(Law::Gradient);
            let mut session = Session::new(probe, &settings, limits).expect("settings");
            let wish = |time: f64| {
                let pose = Path::Hold.pose((3e3 * (time % 1.0)) as usize, 10_000);
                let [x, y, z, w] = [0, 1, 2, 3].map(|k| pose.isometry().rotation.coords[k]);
                Pose::from_quaternion(pose.tip(), [x, y, z, w]).expect("a pose")
            };
            let mut hand = Hand::new(limits, rate, wish).expect("a hand");
            let (mut watch, mut latest, samples) = watched(2 * cycles as usize);
            let stop = AtomicBool::new(false);
            let clock = &mut Unhurried::default();
            let mut round = |watch: &mut Watch| {
                let ends = (&mut session, &mut hand);
                run(ends, (&mut *clock, cycles), watch, &stop).peak[0]
            };
            let first = round(&mut watch);
            assert!(first > 0.0, "{name}");
            let region = Region::new(COUNTED);
            let second = round(&mut watch);
            let change = region.change();
            let seen = latest.read().is_some();
            // Two histograms, before the first cycle.
            assert_eq!((change.allocations, change.reallocations, seen), (HISTOGRAMS, 0, true));
            assert!(second > 0.0 && samples.count() == 2 * cycles as usize);
        }
    }
}

/// What a report's two histograms take.
const HISTOGRAMS: usize = 2;
