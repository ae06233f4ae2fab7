//! Settings that would make every pose of the loop NaN are refused where they are given.

use nalgebra::Point3;
use touchoff::{Pose, Probe, Unit};
use touchoff_haptics::{
    Coupling, DeviceLimits, HandImpedance, Rendering, Session, SessionSettings, SettingError,
    SimulatedHand, SpeedLimit, Tremor,
};
use touchoff_tests::haptics::wall::LIMITS;
use touchoff_tests::haptics::{block, tool, upright};

const BAD: [f64; 4] = [0.0, -1.0, f64::NAN, f64::INFINITY];

fn session(
    settings: &SessionSettings,
    limits: DeviceLimits,
    centre: Point3<f64>,
) -> Result<(), SettingError> {
    let part = block(100);
    let probe = Probe::new(&part, tool("Flat")).with_centre(centre);
    Session::new(probe, settings, limits).map(|_| ())
}

/// Returns the message of the error, which there must be.
fn refused<T>(made: Result<T, SettingError>) -> String {
    made.map(drop).expect_err("it was accepted").to_string()
}

#[test]
fn rejects_invalid_session_settings() {
    let good = SessionSettings::new(1000.0);
    let origin = Point3::origin();
    assert_eq!(session(&good, LIMITS, origin), Ok(()));
    for bad in BAD {
        let settings = [
            SessionSettings { rate: bad, ..good },
            SessionSettings { stiffness: bad, ..good },
            SessionSettings { rendering: coupled(|coupling| coupling.stiffness = bad), ..good },
            SessionSettings {
                rendering: coupled(|coupling| coupling.turning_stiffness = bad),
                ..good
            },
        ];
        for settings in settings {
            refused(session(&settings, LIMITS, origin));
        }
        let limits = [
            DeviceLimits { force: bad, ..LIMITS },
            DeviceLimits { torque: bad, ..LIMITS },
            DeviceLimits { stiffness: bad, ..LIMITS },
            DeviceLimits { turning_stiffness: bad, ..LIMITS },
        ];
        for limits in limits {
            refused(session(&good, limits, origin));
            refused(SimulatedHand::new(limits, 1000.0, |_| upright(0.0)));
        }
        refused(SimulatedHand::new(LIMITS, bad, |_| upright(0.0)));
    }
    // No damping is valid, and so is no limit of speed.
    for bad in &BAD[1..] {
        let direct = Some(Rendering::Direct { scaled: true, damping: *bad });
        refused(session(&SessionSettings { rendering: direct, ..good }, LIMITS, origin));
        let rendering = coupled(|coupling| coupling.damping = *bad);
        refused(session(&SessionSettings { rendering, ..good }, LIMITS, origin));
    }
    for bad in &BAD[..3] {
        for fastest in [
            SpeedLimit { linear: *bad, ..SpeedLimit::default() },
            SpeedLimit { angular: *bad, ..SpeedLimit::default() },
        ] {
            refused(session(&SessionSettings { fastest, ..good }, LIMITS, origin));
        }
    }
    let fastest = SpeedLimit { linear: f64::INFINITY, angular: f64::INFINITY };
    assert_eq!(session(&SessionSettings { fastest, ..good }, LIMITS, origin), Ok(()));
    for bad in &BAD[2..] {
        refused(session(&good, LIMITS, Point3::new(0.0, *bad, 0.0)));
    }
}

fn coupled(change: impl Fn(&mut Coupling)) -> Option<Rendering> {
    let mut coupling = Coupling::of(&LIMITS);
    change(&mut coupling);
    Some(Rendering::Coupled(coupling))
}

/// The error names the number and the valid range.
#[test]
fn errors_name_the_problem_and_the_valid_range() {
    let rate = |rate| refused(session(&SessionSettings::new(rate), LIMITS, Point3::origin()));
    assert_eq!(rate(0.0), "the rate in Hz is 0: give 0.001 to 1000000 cycles per second");
    assert_eq!(rate(1e9), "the rate in Hz is 1000000000: give 0.001 to 1000000 cycles per second");
    let settings = SessionSettings { stiffness: f64::NAN, ..SessionSettings::new(1000.0) };
    let message = refused(session(&settings, LIMITS, Point3::origin()));
    assert_eq!(message, "the stiffness of contact is NaN: give a finite number above 0");
}

#[test]
fn rejects_invalid_hand_settings() {
    let hand = || SimulatedHand::new(LIMITS, 1000.0, |_| -> Pose { upright(0.0) }).expect("a hand");
    let grip = HandImpedance::default();
    for bad in &BAD[1..] {
        let grips = [
            HandImpedance { mass: *bad, ..grip },
            HandImpedance { damping: *bad, ..grip },
            HandImpedance { stiffness: *bad, ..grip },
            HandImpedance { inertia: *bad, ..grip },
            HandImpedance { turning_damping: *bad, ..grip },
            HandImpedance { turning_stiffness: *bad, ..grip },
        ];
        for grip in grips {
            refused(hand().with_impedance(&grip));
        }
        refused(hand().with_encoders(*bad, 0.0));
        refused(hand().with_encoders(0.0, *bad));
        refused(hand().with_tremor(&Tremor { size: *bad, frequency: 10.0, seed: 1 }));
        refused(hand().with_centre(Point3::new(bad * f64::INFINITY, 0.0, 0.0), Unit::Millimetre));
    }
    for mass in [0.0, 1e-300] {
        refused(hand().with_impedance(&HandImpedance { mass, ..grip }));
        refused(hand().with_impedance(&HandImpedance { inertia: mass, ..grip }));
    }
    for frequency in [0.0, -10.0, 501.0, f64::NAN, f64::INFINITY] {
        refused(hand().with_tremor(&Tremor { size: 0.02, frequency, seed: 1 }));
    }
    for frequency in [1e-3, 10.0, 500.0] {
        assert!(hand().with_tremor(&Tremor { size: 0.02, frequency, seed: 1 }).is_ok());
    }
}

#[cfg(unix)]
#[test]
fn a_space_mouse_rejects_a_rate_of_zero() {
    use touchoff_haptics::spacenav::{Spacenav, SpeedGains};
    let nobody = std::path::Path::new("nobody.sock");
    let open = |rate, linear, angular| {
        let (start, gains) = (upright(10.0), SpeedGains { linear, angular });
        match Spacenav::open(nobody, start, Unit::Millimetre, rate, gains) {
            Ok(_) => panic!("it was accepted"),
            Err(error) => error.kind(),
        }
    };
    for bad in BAD {
        for (rate, linear, angular) in [(bad, 100.0, 1.0), (1000.0, bad, 1.0), (1000.0, 100.0, bad)]
        {
            assert_eq!(open(rate, linear, angular), std::io::ErrorKind::InvalidInput);
        }
    }
    // These are valid; only nobody listens.
    assert_ne!(open(1000.0, 100.0, 1.0), std::io::ErrorKind::InvalidInput);
}
