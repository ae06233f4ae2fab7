//! Settings that would make every pose of the loop NaN, refused where they are given.

use nalgebra::Point3;
use touchoff::haptic::{
    Coupling, Fastest, Grip, Hand, Limits, Rendering, Session, SettingError, Settings, Tremor,
};
use touchoff::{Pose, Probe, Unit};
use touchoff_tests::haptics::wall::LIMITS;
use touchoff_tests::haptics::{block, tool, upright};

const BAD: [f64; 4] = [0.0, -1.0, f64::NAN, f64::INFINITY];

fn session(settings: &Settings, limits: Limits, centre: Point3<f64>) -> Result<(), SettingError> {
    let part = block(100);
    let probe = Probe::new(&part, tool("Flat")).centre(centre);
    Session::new(probe, settings, limits).map(|_| ())
}

/// The error's words; there is one.
fn refused<T>(made: Result<T, SettingError>) -> String {
    made.map(drop).expect_err("it was accepted").to_string()
}

#[test]
fn a_session_refuses_what_it_cannot_run_with() {
    let good = Settings::new(1000.0);
    let origin = Point3::origin();
    assert_eq!(session(&good, LIMITS, origin), Ok(()));
    for bad in BAD {
        let settings = [
            Settings { rate: bad, ..good },
            Settings { stiffness: bad, ..good },
            Settings { rendering: coupled(|coupling| coupling.stiffness = bad), ..good },
            Settings { rendering: coupled(|coupling| coupling.turning = bad), ..good },
        ];
        for settings in settings {
            refused(session(&settings, LIMITS, origin));
        }
        let limits = [
            Limits { force: bad, ..LIMITS },
            Limits { torque: bad, ..LIMITS },
            Limits { stiffness: bad, ..LIMITS },
            Limits { turning: bad, ..LIMITS },
        ];
        for limits in limits {
            refused(session(&good, limits, origin));
            refused(Hand::new(limits, 1000.0, |_| upright(0.0)));
        }
        refused(Hand::new(LIMITS, bad, |_| upright(0.0)));
    }
    // No damping is fine, and so is no limit of speed.
    for bad in &BAD[1..] {
        let direct = Some(Rendering::Direct { scaled: true, damping: *bad });
        refused(session(&Settings { rendering: direct, ..good }, LIMITS, origin));
        let rendering = coupled(|coupling| coupling.damping = *bad);
        refused(session(&Settings { rendering, ..good }, LIMITS, origin));
    }
    for bad in &BAD[..3] {
        for fastest in [
            Fastest { way: *bad, ..Fastest::default() },
            Fastest { turn: *bad, ..Fastest::default() },
        ] {
            refused(session(&Settings { fastest, ..good }, LIMITS, origin));
        }
    }
    let fastest = Fastest { way: f64::INFINITY, turn: f64::INFINITY };
    assert_eq!(session(&Settings { fastest, ..good }, LIMITS, origin), Ok(()));
    for bad in &BAD[2..] {
        refused(session(&good, LIMITS, Point3::new(0.0, *bad, 0.0)));
    }
}

fn coupled(change: impl Fn(&mut Coupling)) -> Option<Rendering> {
    let mut coupling = Coupling::of(&LIMITS);
    change(&mut coupling);
    Some(Rendering::Coupled(coupling))
}

/// The error names the number and says what to give.
#[test]
fn an_error_says_what_is_wrong_and_what_to_give() {
    let rate = |rate| refused(session(&Settings::new(rate), LIMITS, Point3::origin()));
    assert_eq!(rate(0.0), "the rate in Hz is 0: give 0.001 to 1000000 cycles per second");
    assert_eq!(rate(1e9), "the rate in Hz is 1000000000: give 0.001 to 1000000 cycles per second");
    let settings = Settings { stiffness: f64::NAN, ..Settings::new(1000.0) };
    let said = refused(session(&settings, LIMITS, Point3::origin()));
    assert_eq!(said, "the stiffness of contact is NaN: give a finite number above 0");
}

#[test]
fn a_hand_refuses_what_it_cannot_move_with() {
    let hand = || Hand::new(LIMITS, 1000.0, |_| -> Pose { upright(0.0) }).expect("a hand");
    let grip = Grip::default();
    for bad in &BAD[1..] {
        let grips = [
            Grip { mass: *bad, ..grip },
            Grip { damping: *bad, ..grip },
            Grip { stiffness: *bad, ..grip },
            Grip { inertia: *bad, ..grip },
            Grip { turning_damping: *bad, ..grip },
            Grip { turning: *bad, ..grip },
        ];
        for grip in grips {
            refused(hand().grip(&grip));
        }
        refused(hand().encoders(*bad, 0.0));
        refused(hand().encoders(0.0, *bad));
        refused(hand().trembling(&Tremor { size: *bad, frequency: 10.0, seed: 1 }));
        refused(hand().held_at(Point3::new(bad * f64::INFINITY, 0.0, 0.0), Unit::Millimetre));
    }
    for mass in [0.0, 1e-300] {
        refused(hand().grip(&Grip { mass, ..grip }));
        refused(hand().grip(&Grip { inertia: mass, ..grip }));
    }
    for frequency in [0.0, -10.0, 501.0, f64::NAN, f64::INFINITY] {
        refused(hand().trembling(&Tremor { size: 0.02, frequency, seed: 1 }));
    }
    for frequency in [1e-3, 10.0, 500.0] {
        assert!(hand().trembling(&Tremor { size: 0.02, frequency, seed: 1 }).is_ok());
    }
}

#[cfg(unix)]
#[test]
fn a_space_mouse_refuses_a_rate_of_zero() {
    use touchoff::haptic::spacenav::{Flight, Spacenav};
    let nobody = std::path::Path::new("nobody.sock");
    let open = |rate, way, turn| {
        let start = (upright(10.0), Unit::Millimetre);
        match Spacenav::open(nobody, start, (rate, Flight { way, turn })) {
            Ok(_) => panic!("it was accepted"),
            Err(error) => error.kind(),
        }
    };
    for bad in BAD {
        for (rate, way, turn) in [(bad, 100.0, 1.0), (1000.0, bad, 1.0), (1000.0, 100.0, bad)] {
            assert_eq!(open(rate, way, turn), std::io::ErrorKind::InvalidInput);
        }
    }
    // Nothing is wrong with these but that nobody listens.
    assert_ne!(open(1000.0, 100.0, 1.0), std::io::ErrorKind::InvalidInput);
}
