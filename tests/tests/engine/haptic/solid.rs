//! A solid without an axis in six axes: turned, it is turned back.

use nalgebra::{Point3, Vector3};
use touchoff::haptic::{Axes, Grip, Hand, Limits, Push, Session, Settings, State};
use touchoff::mesh::shapes;
use touchoff::{Law, Part, Pose, Probe, Unit};
use touchoff_tests::haptics::tool;
use touchoff_tests::haptics::wall::LIMITS;

const LIMITED: Limits = Limits { axes: Axes::Six, ..LIMITS };

/// The pose at which the hand wants the block: pressed onto the plane z = 0, turned by 0.05 about y. Lengths are in mm.
fn wish(time: f64, unit: Unit) -> Pose {
    let low = (2.0 - 4.0 * time.min(1.0)) * Unit::Millimetre.to(unit);
    let (sine, cosine) = 0.025f64.sin_cos();
    Pose::from_quaternion(Point3::new(0.0, 0.0, low), [0.0, sine, 0.0, cosine]).expect("a pose")
}

/// The state after three seconds, with the part in that unit.
fn pressed(unit: Unit) -> State {
    let mm = Unit::Millimetre.to(unit);
    let (low, high) = (Point3::new(-20., -20., -10.) * mm, Point3::new(20., 20., 0.) * mm);
    let mesh = shapes::cuboid(low, high, unit).expect("a block");
    let part = Part::from_mesh(&mesh, 40_000, 1).expect("points of a block");
    let probe = Probe::new(&part, tool("Block")).law(Law::Gradient);
    let hand = Hand::new(LIMITED, 1000.0, |time| wish(time, unit));
    let mut hand = hand.and_then(|hand| hand.held_at(Point3::origin(), unit)).expect("a hand");
    // A wrench's force is in the part's unit cubed.
    let settings = Settings { stiffness: mm.powi(-3), ..Settings::new(1000.0) };
    let mut session = Session::new(probe, &settings, LIMITED).expect("settings");
    let states = (0..3_000).filter_map(|_| session.cycle(&mut hand));
    states.last().expect("the hand is somewhere")
}

/// The plane pushes up, and against the turn, in two units the same. The block gives way to two fifths of the
/// turn, where the plane's torque is that of the grip and that of the coupling.
#[test]
fn a_block_on_an_edge_is_turned_back() {
    let [state, inches] = [Unit::Millimetre, Unit::Inch].map(pressed);
    let lean = |pose: &Pose| pose.rotation().column(2).dot(&Vector3::x()).asin();
    let [tool, device] = [&state.tool, &state.device].map(lean);
    let wanted = lean(&wish(3.0, Unit::Millimetre));
    let Push { force, torque } = state.push;
    assert!(force.z > 0.4 && torque.y < -8.0, "{state:?}");
    assert!(tool < 0.6 * wanted, "{tool} of {wanted}");
    for spring in [Grip::default().turning * (wanted - device), LIMITED.turning * (device - tool)] {
        assert!((torque.y / -spring - 1.0).abs() < 0.01, "{spring} N·mm: {torque}");
    }
    assert!((inches.push.force - force).norm() < 1e-4 * force.norm(), "{:?}", inches.push);
    assert!((inches.push.torque - torque).norm() < 1e-4 * torque.norm(), "{:?}", inches.push);
}
