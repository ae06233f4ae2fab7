//! Devices that report nonsense, jump, vanish and come back.

use touchoff::{Law, Pose, PoseError, Probe};
use touchoff_haptics::{
    Device, DeviceError, DeviceLimits, DeviceWrench, ScriptedDevice, Session, SessionSettings,
};
use touchoff_tests::haptics::wall::LIMITS;
use touchoff_tests::haptics::{block, tool, upright};

fn session(part: &touchoff::Part) -> Session<'_> {
    let probe = Probe::new(part, tool("Flat")).with_law(Law::Gradient);
    Session::new(probe, &SessionSettings::new(1000.0), LIMITS).expect("settings")
}

/// Returns a device that is half a millimetre deep, except where a function replaces its pose.
fn deep(
    instead: impl Fn(u64) -> Option<Result<Pose, DeviceError>>,
) -> ScriptedDevice<impl FnMut(u64) -> Result<Pose, DeviceError>> {
    ScriptedDevice::new(LIMITS, move |cycle| instead(cycle).unwrap_or(Ok(upright(-0.5))))
}

fn gone() -> DeviceError {
    DeviceError::NotResponding(std::io::Error::from(std::io::ErrorKind::NotConnected))
}

#[test]
fn invalid_poses_are_replaced_by_the_last_and_counted() {
    let part = block(20_000);
    let mut session = session(&part);
    let nan = |cycle| (300..320).contains(&cycle).then_some(Err(PoseError::NotFinite.into()));
    let mut device = deep(nan);
    let states: Vec<_> =
        (0..600).map(|_| session.cycle(&mut device).expect("it was somewhere")).collect();
    for state in &states[200..] {
        assert!(
            (state.wrench_on_hand.force - states[199].wrench_on_hand.force).norm() < 1e-9,
            "{state:?}"
        );
        assert_eq!(state.held, (300..320).contains(&state.cycle));
    }
    assert_eq!(session.faults().no_pose, 20);
}

#[test]
fn the_last_pose_is_held_while_a_device_is_gone() {
    let part = block(20_000);
    let mut session = session(&part);
    let mut device = deep(|cycle| (300..400).contains(&cycle).then(|| Err(gone())));
    for cycle in 0..600 {
        let state = session.cycle(&mut device).expect("it was somewhere");
        assert_eq!(state.held, (300..400).contains(&cycle));
    }
    assert_eq!(session.faults().not_responding, 100);
}

#[test]
fn no_wrench_is_sent_before_the_first_pose() {
    let part = block(20_000);
    let mut session = session(&part);
    let mut device = deep(|cycle| (cycle < 10).then(|| Err(gone())));
    for cycle in 0..12 {
        assert_eq!(session.cycle(&mut device).is_some(), cycle >= 10);
    }
}

/// One wild pose is not followed; if the device stays there, rendering begins anew, gently.
#[test]
fn a_jump_is_followed_only_if_it_persists() {
    let part = block(20_000);
    let mut session = session(&part);
    let far_pose = || Some(Ok(upright(500.0)));
    let mut device = deep(|cycle| match cycle {
        300 => far_pose(),
        400..500 => far_pose(),
        _ => None,
    });
    let mut largest = 0.0f64;
    let mut before: Option<DeviceWrench> = None;
    for cycle in 0..800 {
        let state = session.cycle(&mut device).expect("it was somewhere");
        let stayed = (400..450).contains(&cycle) || (500..550).contains(&cycle);
        assert_eq!(state.held, cycle == 300 || stayed, "{cycle}");
        // If the device is torn away, the force is released at once.
        if let Some(before) = before.filter(|_| cycle != 450) {
            largest = largest.max((state.wrench_on_hand.force - before.force).norm());
        }
        before = Some(state.wrench_on_hand);
    }
    // A force of 0.5 N rises over a tenth of a second.
    assert!(largest < 0.02, "{largest}");
    assert_eq!(session.faults().jumps, 1 + 51 + 51);
}

/// A device that cannot push.
struct Deaf;

impl Device for Deaf {
    fn pose(&mut self) -> Result<Pose, DeviceError> {
        Ok(upright(-0.1))
    }
    fn apply(&mut self, _: &DeviceWrench) -> Result<(), DeviceError> {
        Err(gone())
    }
    fn limits(&self) -> DeviceLimits {
        LIMITS
    }
}

#[test]
fn failed_wrench_commands_are_counted() {
    let part = block(20_000);
    let mut session = session(&part);
    for _ in 0..5 {
        session.cycle(&mut Deaf);
    }
    assert_eq!(session.faults().failed_writes, 5);
}

/// A device that moves into the part and does not take a wrench in some cycles, with the work of what it did take.
struct Forgetful {
    cycle: u64,
    applied: DeviceWrench,
    height: f64,
    work: f64,
}

impl Device for Forgetful {
    fn pose(&mut self) -> Result<Pose, DeviceError> {
        // The force is faded in before.
        let height = 0.05 - 0.002 * self.cycle.saturating_sub(500) as f64;
        self.work -= self.applied.force.z * (height - self.height);
        (self.height, self.cycle) = (height, self.cycle + 1);
        Ok(upright(height))
    }
    fn apply(&mut self, wrench: &DeviceWrench) -> Result<(), DeviceError> {
        if self.cycle.is_multiple_of(3) {
            return Err(gone());
        }
        self.applied = *wrench;
        Ok(())
    }
    fn limits(&self) -> DeviceLimits {
        LIMITS
    }
}

#[test]
fn the_energy_balance_counts_what_the_device_has_applied() {
    let part = block(20_000);
    let mut session = session(&part);
    let applied = DeviceWrench::default();
    let mut device = Forgetful { cycle: 0, applied, height: 0.05, work: 0.0 };
    let mut last = None;
    for _ in 0..650 {
        let state = session.cycle(&mut device).expect("a pose");
        assert_eq!(state.wrench_on_hand, device.applied);
        last = Some(state);
    }
    let input = last.expect("a state").energy.input;
    assert!(
        device.work > 0.01 && (input - device.work).abs() < 1e-9 * device.work,
        "{input} {}",
        device.work
    );
}

#[test]
fn wrenches_keep_the_device_limits() {
    let part = block(20_000);
    for stiffness in [1.0, 1e3, 1e9] {
        let settings = SessionSettings { stiffness, ..SessionSettings::new(1000.0) };
        let probe = Probe::new(&part, tool("Flat")).with_law(Law::Gradient);
        let mut session = Session::new(probe, &settings, LIMITS).expect("settings");
        let mut device =
            ScriptedDevice::new(LIMITS, |cycle| Ok(upright(0.1 - 0.005 * cycle as f64)));
        for _ in 0..4000 {
            let wrench = session.cycle(&mut device).expect("it was somewhere").wrench_on_hand;
            assert!(wrench.force.norm() <= LIMITS.force * (1.0 + 1e-12));
            assert!(wrench.torque.norm() <= LIMITS.torque * (1.0 + 1e-12));
        }
    }
}
