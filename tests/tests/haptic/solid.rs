//! A solid without an axis in six axes: turned, it is turned back.

use nalgebra::{Point3, Vector3};
use touchoff::haptic::{Axes, Hand, Limits, Session, Settings};
use touchoff::{Law, Pose, Probe};
use touchoff_tests::measure::haptics::wall::LIMITS;
use touchoff_tests::measure::haptics::{block, tool};

/// The block pressed onto a plane with its edge first, by a hand that would have it turned by 0.05 about y: the
/// plane pushes up, and against the turn; in two units the same.
#[test]
fn a_block_on_an_edge_is_turned_flat() {
    let part = block(40_000);
    let limits = Limits { axes: Axes::Six, ..LIMITS };
    let (sine, cosine) = 0.025f64.sin_cos();
    let wish = |time: f64| {
        let low = 2.0 - 4.0 * time.min(1.0);
        Pose::from_quaternion(Point3::new(0.0, 0.0, low), [0.0, sine, 0.0, cosine]).expect("a pose")
    };
    let probe = Probe::new(&part, tool("Block")).law(Law::Gradient);
    let mut hand = Hand::new(limits, 1000.0, wish).expect("a hand");
    let mut session = Session::new(probe, &Settings::new(1000.0), limits).expect("settings");
    let states = (0..3_000).filter_map(|_| session.cycle(&mut hand));
    let state = states.last().expect("the hand is somewhere");
    assert!(state.push.force.z > 0.1, "{state:?}");
    assert!(state.push.torque.y < -1.0, "{state:?}");
    let lean = |pose: &Pose| pose.rotation().column(2).dot(&Vector3::x());
    let [tool, wanted] = [lean(&state.tool), lean(&wish(3.0))];
    assert!(tool < 0.9 * wanted, "{tool} of {wanted}");
}
