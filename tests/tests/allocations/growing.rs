//! Contacts that each exceed all before: memory that is allocated only once a contact has that size is detected
//! here.

use super::COUNTED;
use stats_alloc::Region;
use touchoff::tool::{BatchEvaluator, Interpreted};
use touchoff::{Law, Part, Probe, Tool};
use touchoff_haptics::{DeviceLimits, Rendering, ScriptedDevice, Session, SessionSettings};
use touchoff_tests::haptics::wall::LIMITS;
use touchoff_tests::haptics::{block, upright};

// A cone that encloses all of a block as it goes down, a ring of its points per cycle.
touchoff::include_tool!("tests/allocations/cone.tool");
const CONE: &str = include_str!("cone.tool");

const POINTS: usize = 5_000;
const CYCLES: u64 = 200;

/// Returns the height of the tip: 1 mm above the block in the first cycle, and 0.25 mm lower in each that follows.
/// All of the block is inside after 160 cycles.
fn height(cycle: u64) -> f64 {
    1.0 - 0.25 * cycle as f64
}

/// Asserts that a loop whose contact grows allocates no memory from its first cycle on, for compiled tools and for
/// interpreted ones, by each law and rendering.
pub(crate) fn no_cycle_allocates() {
    let part = block(POINTS);
    let interpreted = Interpreted::parse(&source(CONE)).expect("a cone");
    for law in [Law::Thesis, Law::Facing, Law::Gradient] {
        session(&part, &Probe::new(&part, &Cone).with_law(law), "compiled");
        session(&part, &Probe::new(&part, &Cone as &dyn Tool).with_law(law), "by its table");
        session(&part, &Probe::new(&part, &interpreted).with_law(law), "interpreted");
        let as_dyn = Probe::new(&part, &interpreted as &dyn Tool).with_law(law);
        session(&part, &as_dyn, "interpreted, dyn");
    }
}

fn session<T: BatchEvaluator + ?Sized>(part: &Part, probe: &Probe<'_, T>, name: &str) {
    let limits = DeviceLimits { force: 1e6, torque: 1e9, ..LIMITS };
    for rendering in [None, Some(Rendering::Direct { scaled: true, damping: 0.0 })] {
        // Soft enough for a coupled tool to follow the device.
        let settings =
            SessionSettings { stiffness: 1e-6, rendering, ..SessionSettings::new(1000.0) };
        let region = Region::new(COUNTED);
        let mut session = Session::new(probe.clone(), &settings, limits).expect("settings");
        let reserved = region.change().bytes_allocated;
        let mut device = ScriptedDevice::new(limits, |cycle| Ok(upright(height(cycle))));
        let (mut largest, mut growing) = (0, 0);
        let region = Region::new(COUNTED);
        for _ in 0..CYCLES {
            let state = session.cycle(&mut device).expect("it was somewhere");
            growing += usize::from(state.wrench.colliding > largest);
            largest = largest.max(state.wrench.colliding);
        }
        let change = region.change();
        assert_eq!((change.allocations, change.reallocations), (0, 0), "{name}, {rendering:?}");
        // All of the block is inside, ring by ring.
        assert_eq!(largest, part.tree().len(), "{name}, {rendering:?}");
        assert!(growing > 120, "{name}, {rendering:?}: {growing}");
        // The bound that `Session::new` states; the memory that an interpreted tool keeps is the same for all
        // parts.
        let bytes = reserved as f64 / POINTS as f64;
        println!("{name}, {rendering:?}: {bytes:.1} bytes per point, {growing} cycles larger");
        assert!(name.starts_with("interpreted") || bytes < 128.0, "{name}: {bytes}");
    }
}

/// Asserts that no query allocates if its probe has [reserved memory](Probe::with_reserved_memory), and that each
/// allocates in the first round alone otherwise.
pub(crate) fn no_question_allocates() {
    let part = block(POINTS);
    let interpreted = Interpreted::parse(&source(CONE)).expect("a cone");
    questions(&part, || Probe::new(&part, &Cone));
    questions(&part, || Probe::new(&part, &Cone).with_law(Law::Gradient));
    questions(&part, || Probe::new(&part, &interpreted as &dyn Tool));
}

fn questions<'a, T: BatchEvaluator + ?Sized + 'a>(part: &Part, probe: impl Fn() -> Probe<'a, T>) {
    type Ask<'a, T> = fn(&mut Probe<'a, T>, &touchoff::Pose) -> usize;
    let asks: [(&str, Ask<'a, T>); 6] = [
        ("detect", |probe, pose| usize::from(probe.detect(pose))),
        ("deepest", |probe, pose| usize::from(probe.deepest(pose).is_some())),
        ("posture", |probe, pose| probe.posture(pose).colliding),
        ("wrench", |probe, pose| probe.wrench(pose).colliding),
        ("stiffness", |probe, pose| probe.stiffness(pose).wrench.colliding),
        ("contacts", |probe, pose| probe.contacts(pose).len()),
    ];
    for (name, ask) in asks {
        let poses: Vec<_> = (0..CYCLES).map(|cycle| upright(height(cycle))).collect();
        let [fresh, reserved] = [probe(), probe().with_reserved_memory()].map(|mut probe| {
            [(); 2].map(|()| {
                let region = Region::new(COUNTED);
                let max_contacts = poses.iter().map(|pose| ask(&mut probe, pose)).max();
                let change = region.change();
                let all = if matches!(name, "detect" | "deepest") { 1 } else { part.tree().len() };
                assert_eq!(max_contacts, Some(all), "{name}");
                change.allocations + change.reallocations
            })
        });
        // Without reserved memory the first round allocates, and no other.
        let is_first_alone = fresh[0] > 0 && fresh[1] == 0;
        assert!(is_first_alone && reserved == [0; 2], "{name}: {fresh:?} {reserved:?}");
    }
    let region = Region::new(COUNTED);
    let probe = probe().with_reserved_memory();
    let bytes_per_point = region.change().bytes_allocated as f64 / POINTS as f64;
    drop(probe);
    println!("reserved: {bytes_per_point:.1} bytes per point");
    assert!(bytes_per_point < 310.0, "{bytes_per_point}");
}

fn source(text: &str) -> touchoff_dsl::source::Source {
    touchoff_dsl::source::Source::new("cone.tool", text)
}
