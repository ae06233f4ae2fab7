//! Allocations: a haptic loop must not wait for memory, so its cycles allocate none, however their contacts grow.
//! After the first round neither does a probe, nor a certifier.

mod growing;

use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;
use std::sync::atomic::AtomicBool;
use touchoff::certify::{Certifier, PoseVerdict, TriangleBvh};
use touchoff::scenes::{ScenePath, tube};
use touchoff::{Law, Pose, Probe};
use touchoff_haptics::{
    DeviceAxes, DeviceLimits, Rendering, Session, SessionSettings, SimulatedClock, SimulatedHand,
    StatePublisher, state_channel,
};
use touchoff_tests::fixtures::{part, poses};
use touchoff_tests::library;

#[global_allocator]
static COUNTED: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

// Without a test harness: the counts are those of the process.
fn main() {
    a_certifier();
    a_haptic_loop();
    growing::no_cycle_allocates();
    growing::no_question_allocates();
}

/// Asserts that a certifier does not allocate after its first round. Poses without contact are excluded from
/// `check_pose`: whether such a tool is inside is decided by a ray, which allocates.
fn a_certifier() {
    let bvh = TriangleBvh::new(&tube());
    for name in ["Fig73Exact", "BallEr16"] {
        let tool = library::tool(name);
        let mut certifier = Certifier::new(&bvh, tool).expect("a profile");
        let mut round = |poses: &[Pose]| -> f64 {
            let depths = poses.iter().map(|pose| certifier.deepest(pose, 1e-6).depth.low);
            depths.sum()
        };
        let poses: Vec<Pose> =
            ScenePath::ALL.into_iter().flat_map(|path| poses(path, 200)).collect();
        let first = round(&poses);
        assert!(first > 0.0);
        let region = Region::new(COUNTED);
        let second = round(&poses);
        let change = region.change();
        assert_eq!((change.allocations, change.reallocations), (0, 0));
        assert!((first - second).abs() <= 1e-6 * poses.len() as f64);
        let touches = |pose: &&Pose| certifier.deepest(pose, 1e-6).depth.low > 1e-3;
        let touching: Vec<Pose> = poses.iter().filter(touches).copied().collect();
        let mut is_touching = |pose| matches!(certifier.check_pose(pose), PoseVerdict::Touching(_));
        let mut all_touch = || touching.iter().all(&mut is_touching);
        assert!(all_touch());
        let region = Region::new(COUNTED);
        let again = all_touch();
        let change = region.change();
        assert_eq!((again, change.allocations, change.reallocations), (true, 0, 0));
    }
}

/// Asserts that cycles of the haptic loop do not allocate, whatever the hand does, while a reader follows the
/// states.
fn a_haptic_loop() {
    let part = part(20_000);
    let (rate, cycles) = (1000.0, 1_000);
    for name in ["Fig73Exact", "Block"] {
        let tool = library::tool(name);
        let axes = if name == "Block" { DeviceAxes::Six } else { DeviceAxes::Five };
        let limits = DeviceLimits { axes, ..DeviceLimits::default() };
        for rendering in [None, Some(Rendering::Direct { scaled: true, damping: 1e-3 })] {
            let settings = SessionSettings { rendering, ..SessionSettings::new(rate) };
            let probe = Probe::new(&part, tool).with_law(Law::Gradient);
            let mut session = Session::new(probe, &settings, limits).expect("settings");
            let hand_pose = |time: f64| {
                let pose = ScenePath::Hold.pose((3e3 * (time % 1.0)) as usize, 10_000);
                let [x, y, z, w] = [0, 1, 2, 3].map(|k| pose.to_isometry().rotation.coords[k]);
                Pose::from_quaternion(pose.tip(), [x, y, z, w]).expect("a pose")
            };
            let mut hand = SimulatedHand::new(limits, rate, hand_pose).expect("a hand");
            let (mut watch, mut latest, samples) = state_channel(2 * cycles as usize);
            let stop = AtomicBool::new(false);
            let clock = &mut SimulatedClock::default();
            let mut round = |watch: &mut StatePublisher| {
                session.run(&mut hand, &mut *clock, cycles, watch, &stop).peak_wrench[0]
            };
            let first = round(&mut watch);
            assert!(first > 0.0, "{name}");
            let region = Region::new(COUNTED);
            let second = round(&mut watch);
            let change = region.change();
            let was_published = latest.read().is_some();
            // Two histograms, before the first cycle.
            assert_eq!((change.allocations, change.reallocations), (HISTOGRAMS, 0));
            assert!(was_published);
            assert!(second > 0.0 && samples.count() == 2 * cycles as usize);
        }
    }
}

const HISTOGRAMS: usize = 2;
