//! The hand never gets back more than it put in.

use touchoff::haptic::{Coupling, Energy, Limits, Rendering, Scripted, Session, Settings};
use touchoff::scenes::{Path, tube};
use touchoff::{Law, Part, Probe};
use touchoff_tests::measure::haptics::energy::{plane, tapping};
use touchoff_tests::measure::haptics::tool;
use touchoff_tests::measure::haptics::wall::LIMITS;

const STRONG: Limits = Limits { force: 40.0, torque: 2000.0, ..LIMITS };

/// What a law makes of a path that is gone there and back, and the most that was held.
fn there_and_back(part: &Part, law: Law, settings: &Settings, path: Path) -> (Energy, f64) {
    let tool = tool("Fig73Exact");
    let probe = Probe::new(part, tool).law(law);
    let mut session = Session::new(probe, settings, STRONG).expect("settings");
    const WAY: u64 = 20_000;
    let mut device = Scripted::new(STRONG, |cycle| {
        let at = if cycle <= WAY { cycle } else { 2 * WAY - cycle };
        // A tenth of the path, which is gone along in seconds instead of minutes.
        Ok(path.pose(at as usize, 10 * WAY as usize))
    });
    let mut most = 0.0f64;
    let mut last = None;
    for _ in 0..=2 * WAY {
        let state = session.cycle(&mut device).expect("it was somewhere");
        most = most.max(state.energy.held);
        last = Some(state.energy);
    }
    (last.expect("a path"), most)
}

/// Coupled, the push is the gradient of what contact and spring hold, so a way there and back gives nothing away
/// but what a push that is held from one cycle to the next lags behind; that the controller takes out. Where the
/// tool springs from one grain of the cloud to the next, some is lost.
#[test]
fn coupled_by_the_gradient_nothing_is_generated() {
    let part = Part::from_mesh(&tube(), 20_000, 1).expect("points of a tube");
    let coupling = Coupling { damping: 0.0, ..Coupling::of(&STRONG) };
    let rendering = Some(Rendering::Coupled(coupling));
    for path in Path::ALL {
        for (passive, share) in [(false, 0.1), (true, 1e-3)] {
            let settings =
                Settings { stiffness: 300.0, rendering, passive, ..Settings::new(1000.0) };
            let (energy, most) = there_and_back(&part, Law::Gradient, &settings, path);
            println!("{path:?}: {energy:?}, most {most}");
            assert!(most > 0.0, "{path:?}");
            let net = energy.put_in - energy.held;
            assert!(net > -share * most, "{path:?}: {net} of {most}");
            assert!(energy.generated < share * most, "{path:?}: {energy:?} of {most}");
        }
    }
}

/// A wall that is sampled pushes longer than it is pressed, so that each tap gives a little more than it took;
/// the controller takes that out.
#[test]
fn what_comes_from_nowhere_is_taken_out() {
    let part = plane();
    let direct = Some(Rendering::Direct { scaled: false, damping: 0.0 });
    let [free, passive] = [false, true].map(|passive| tapping(&part, direct, passive));
    let [free, passive] = [free, passive].map(|all| *all.last().expect("states"));
    assert!(free.put_in < 0.0, "{free:?}");
    assert!(passive.taken_out > 0.0 && passive.put_in > 0.5 * free.put_in, "{passive:?} {free:?}");
    let coupled = *tapping(&part, None, true).last().expect("states");
    assert!(coupled.put_in > 0.0, "{coupled:?}");
}
