//! Energy: the hand never gets back more than it put in.

use nalgebra::Vector3;
use touchoff::scenes::{ScenePath, tube};
use touchoff::{Law, Part, Probe, Sampling};
use touchoff_haptics::{
    Coupling, DeviceLimits, EnergyBalance, Rendering, ScriptedDevice, Session, SessionSettings,
};
use touchoff_tests::haptics::energy::{height, tapping_energy};
use touchoff_tests::haptics::wall::LIMITS;
use touchoff_tests::haptics::{block, tool};

const STRONG: DeviceLimits = DeviceLimits { force: 40.0, torque: 2000.0, ..LIMITS };

/// The account of a path that is travelled there and back.
struct Account {
    /// The balance after the last cycle.
    last: EnergyBalance,
    /// The largest energy held.
    max_held: f64,
    /// The work that pushes did because each was held for a cycle: the sum of `-½ (p' - p)·d` where it is positive.
    /// That is the difference between the trapezoid of the pushes `p` and `p'` at both ends of a step `d` and the
    /// rectangle of `p`. It is negative where the tool springs to another grain.
    lag: f64,
}

/// Returns the shortest rotation from one axis to another, as a rotation vector.
fn turn(from: Vector3<f64>, to: Vector3<f64>) -> Vector3<f64> {
    let sine = from.cross(&to);
    let size = sine.norm();
    if size > 0.0 { sine * (size.atan2(from.dot(&to)) / size) } else { sine }
}

fn there_and_back(part: &Part, law: Law, settings: &SessionSettings, path: ScenePath) -> Account {
    let tool = tool("Fig73Exact");
    let probe = Probe::new(part, tool).with_law(law);
    let mut session = Session::new(probe, settings, STRONG).expect("settings");
    const CYCLES_PER_DIRECTION: u64 = 10_000;
    let mut device = ScriptedDevice::new(STRONG, |cycle| {
        let at =
            if cycle <= CYCLES_PER_DIRECTION { cycle } else { 2 * CYCLES_PER_DIRECTION - cycle };
        // A twentieth of the path, which takes seconds instead of minutes.
        Ok(path.pose(at as usize, 20 * CYCLES_PER_DIRECTION as usize))
    });
    let (mut max_held, mut lag) = (0.0f64, 0.0);
    let mut last = session.cycle(&mut device).expect("it was somewhere");
    for _ in 0..2 * CYCLES_PER_DIRECTION {
        let state = session.cycle(&mut device).expect("it was somewhere");
        max_held = max_held.max(state.energy.stored);
        let (from, to) = (last.device, state.device);
        let by_force =
            (state.wrench_on_hand.force - last.wrench_on_hand.force).dot(&(to.tip() - from.tip()));
        let by_torque = (state.wrench_on_hand.torque - last.wrench_on_hand.torque)
            .dot(&turn(from.axis(), to.axis()));
        lag += (-0.5 * (by_force + by_torque)).max(0.0);
        last = state;
    }
    Account { last: last.energy, max_held, lag }
}

/// With a coupling, the push is the gradient of the energy that contact and spring hold. A way there and back then
/// generates nothing but the lag of pushes that are held for a cycle. That is less than a thousandth of the largest
/// energy held; on the path inside, where only 2.6e-4 N·mm are held, less than 9 %. The controller leaves less than
/// 0.02 % everywhere. Where the tool springs from one grain of the cloud to the next, some energy is lost.
#[test]
fn gradient_coupling_generates_at_most_the_lag_of_held_wrenches() {
    let part = Part::from_mesh(&tube(), Sampling::new(20_000)).expect("points of a tube");
    let coupling = Coupling { damping: 0.0, ..Coupling::of(&STRONG) };
    let rendering = Some(Rendering::Coupled(coupling));
    for path in ScenePath::ALL {
        for passive in [false, true] {
            let settings = SessionSettings {
                stiffness: 300.0,
                rendering,
                passive,
                ..SessionSettings::new(1000.0)
            };
            let Account { last: energy, max_held, lag } =
                there_and_back(&part, Law::Gradient, &settings, path);
            println!("{path:?}: {energy:?}, most {max_held}, lag {lag}");
            assert!(max_held > 0.0, "{path:?}");
            let tolerance = match (passive, path) {
                (true, _) => 2e-4,
                (false, ScenePath::Inside) => 0.09,
                (false, _) => 1e-3,
            };
            let net = energy.input - energy.stored;
            assert!(net > -tolerance * max_held, "{path:?}: {net} of {max_held}");
            assert!(energy.generated < tolerance * max_held, "{path:?}: {energy:?} of {max_held}");
            assert!(energy.generated < lag, "{path:?}: {energy:?}, lag {lag}");
        }
    }
}

/// A wall that is sampled pushes longer than it is pressed, so that each tap returns a little more than it took.
/// The controller takes that out as far as its damper may brake: half the device's stiffness times the squares of
/// the displacements, `½ k Σ d²`, 0.125 N·mm in these taps.
#[test]
fn generated_energy_is_dissipated_up_to_the_damper_limit() {
    let part = block(20_000);
    let direct = Some(Rendering::Direct { scaled: false, damping: 0.0 });
    let steps = (1..5_000).map(|cycle| height(cycle) - height(cycle - 1));
    let limit = 0.5 * LIMITS.stiffness * steps.map(|step| step * step).sum::<f64>();
    let mut reached = [false; 2];
    for stiffness in [0.25, 0.5, 1.0, 2.0, 4.0] {
        let [free, passive] = [false, true].map(|passive| {
            *tapping_energy(&part, stiffness, direct, passive).last().expect("states")
        });
        assert!(free.input < 0.0 && free.dissipated == 0.0, "{free:?}");
        let exceeds_limit = free.generated > limit;
        reached[usize::from(exceeds_limit)] = true;
        if exceeds_limit {
            // The controller takes out all that it may; the rest stays.
            assert!(passive.dissipated > 0.99 * limit, "{stiffness}: {passive:?} of {limit}");
            let remaining = free.generated - passive.dissipated;
            assert!(passive.generated < 1.01 * remaining, "{stiffness}: {passive:?} {free:?}");
        } else {
            // The controller takes out all but the energy of the last cycles.
            assert!(passive.generated < 0.002 * free.generated, "{passive:?} {free:?}");
            assert!(passive.dissipated > 0.998 * free.generated, "{passive:?} {free:?}");
            assert!(passive.input > 0.0, "{passive:?}");
        }
    }
    assert_eq!(reached, [true; 2]);
    let coupled = *tapping_energy(&part, 2.0, None, true).last().expect("states");
    assert!(coupled.input > coupled.stored && coupled.generated < 2e-6, "{coupled:?}");
}
