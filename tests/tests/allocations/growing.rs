//! Contacts each larger than all before: memory that only has to be found once a contact was as large is found
//! out here.

use super::COUNTED;
use stats_alloc::Region;
use touchoff::haptic::{Limits, Rendering, Scripted, Session, Settings};
use touchoff::tool::{Interpreted, Senses};
use touchoff::{Law, Part, Probe, Tool};
use touchoff_tests::haptics::wall::LIMITS;
use touchoff_tests::haptics::{block, upright};

// A cone that takes in all of a block as it goes down, a ring of its points in each cycle.
touchoff::include_tool!("tests/allocations/cone.tool");
const CONE: &str = include_str!("cone.tool");

const POINTS: usize = 5_000;
const CYCLES: u64 = 200;

/// The tip 1 mm over the block in the first cycle, and 0.25 mm lower in each that follows: all of the block
/// is inside after 160.
fn height(cycle: u64) -> f64 {
    1.0 - 0.25 * cycle as f64
}

/// A loop whose contact grows asks for no memory from its first cycle on, for compiled tools and for those that
/// are interpreted, by each law and rendering.
pub(crate) fn no_cycle_allocates() {
    let part = block(POINTS);
    let interpreted = Interpreted::parse(&source(CONE)).expect("a cone");
    for law in [Law::Thesis, Law::Facing, Law::Gradient] {
        session(&part, &Probe::new(&part, &Cone).law(law), "compiled");
        session(&part, &Probe::new(&part, &Cone as &dyn Tool).law(law), "by its table");
        session(&part, &Probe::new(&part, &interpreted).law(law), "interpreted");
        session(&part, &Probe::new(&part, &interpreted as &dyn Tool).law(law), "interpreted, dyn");
    }
}

fn session<T: Senses + ?Sized>(part: &Part, probe: &Probe<'_, T>, name: &str) {
    let limits = Limits { force: 1e6, torque: 1e9, ..LIMITS };
    for rendering in [None, Some(Rendering::Direct { scaled: true, damping: 0.0 })] {
        // So soft that a coupled tool follows.
        let settings = Settings { stiffness: 1e-6, rendering, ..Settings::new(1000.0) };
        let region = Region::new(COUNTED);
        let mut session = Session::new(probe.another(), &settings, limits).expect("settings");
        let reserved = region.change().bytes_allocated;
        let mut device = Scripted::new(limits, |cycle| Ok(upright(height(cycle))));
        let (mut largest, mut growing) = (0, 0);
        let region = Region::new(COUNTED);
        for _ in 0..CYCLES {
            let state = session.cycle(&mut device).expect("it was somewhere");
            growing += usize::from(state.wrench.colliding > largest);
            largest = largest.max(state.wrench.colliding);
        }
        let change = region.change();
        assert_eq!((change.allocations, change.reallocations), (0, 0), "{name}, {rendering:?}");
        // All of the block, ring by ring.
        assert_eq!(largest, part.tree().len(), "{name}, {rendering:?}");
        assert!(growing > 120, "{name}, {rendering:?}: {growing}");
        // As `Session::new` says; what an interpreted tool keeps is the same for all parts.
        let each = reserved as f64 / POINTS as f64;
        println!("{name}, {rendering:?}: {each:.1} bytes per point, {growing} cycles larger");
        assert!(name.starts_with("interpreted") || each < 128.0, "{name}: {each}");
    }
}

/// Nor does any question of a probe that was [reserved](Probe::reserved); one that was not does.
pub(crate) fn no_question_allocates() {
    let part = block(POINTS);
    let interpreted = Interpreted::parse(&source(CONE)).expect("a cone");
    questions(&part, || Probe::new(&part, &Cone));
    questions(&part, || Probe::new(&part, &Cone).law(Law::Gradient));
    questions(&part, || Probe::new(&part, &interpreted as &dyn Tool));
}

fn questions<'a, T: Senses + ?Sized + 'a>(part: &Part, probe: impl Fn() -> Probe<'a, T>) {
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
        let [fresh, reserved] = [probe(), probe().reserved()].map(|mut probe| {
            let region = Region::new(COUNTED);
            let most = poses.iter().map(|pose| ask(&mut probe, pose)).max();
            let change = region.change();
            let all = if matches!(name, "detect" | "deepest") { 1 } else { part.tree().len() };
            assert_eq!(most, Some(all), "{name}");
            change.allocations + change.reallocations
        });
        assert_eq!(reserved, 0, "{name}");
        assert!(fresh > 0, "{name}");
    }
    let region = Region::new(COUNTED);
    let probe = probe().reserved();
    let each = region.change().bytes_allocated as f64 / POINTS as f64;
    drop(probe);
    println!("reserved: {each:.1} bytes per point");
    assert!(each < 310.0, "{each}");
}

fn source(text: &str) -> tool_dsl::source::Source {
    tool_dsl::source::Source::new("cone.tool", text)
}
