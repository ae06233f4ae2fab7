//! A solid without an axis in six axes: a block that is turned is turned back.

use nalgebra::{Point3, Vector3};
use touchoff::mesh::shapes;
use touchoff::{Law, Part, Pose, Probe, Sampling, Unit};
use touchoff_haptics::{
    DeviceAxes, DeviceLimits, DeviceWrench, HandImpedance, Session, SessionSettings, SessionState,
    SimulatedHand,
};
use touchoff_tests::haptics::tool;
use touchoff_tests::haptics::wall::LIMITS;

const LIMITED: DeviceLimits = DeviceLimits { axes: DeviceAxes::Six, ..LIMITS };

/// Returns the pose at which the hand wants the block: pressed onto the plane z = 0, turned by 0.05 rad about y.
/// Lengths are given in mm and converted to `unit`.
fn hand_pose(time: f64, unit: Unit) -> Pose {
    let low = (2.0 - 4.0 * time.min(1.0)) * Unit::Millimetre.factor_to(unit);
    let (sine, cosine) = 0.025f64.sin_cos();
    Pose::from_quaternion(Point3::new(0.0, 0.0, low), [0.0, sine, 0.0, cosine]).expect("a pose")
}

/// Returns the state after three seconds, with the part in that unit.
fn pressed(unit: Unit) -> SessionState {
    let mm = Unit::Millimetre.factor_to(unit);
    let (low, high) = (Point3::new(-20., -20., -10.) * mm, Point3::new(20., 20., 0.) * mm);
    let mesh = shapes::cuboid(low, high, unit).expect("a block");
    let part = Part::from_mesh(&mesh, Sampling::new(40_000)).expect("points of a block");
    let probe = Probe::new(&part, tool("Block")).with_law(Law::Gradient);
    let hand = SimulatedHand::new(LIMITED, 1000.0, |time| hand_pose(time, unit));
    let mut hand = hand.and_then(|hand| hand.with_centre(Point3::origin(), unit)).expect("a hand");
    // A wrench's force is in the part's unit cubed.
    let settings = SessionSettings { stiffness: mm.powi(-3), ..SessionSettings::new(1000.0) };
    let mut session = Session::new(probe, &settings, LIMITED).expect("settings");
    let states = (0..3_000).filter_map(|_| session.cycle(&mut hand));
    states.last().expect("the hand is somewhere")
}

/// The plane pushes up and against the rotation, the same in two units. The block yields to two fifths of the
/// rotation, where the plane's torque equals that of the grip and that of the coupling.
#[test]
fn a_block_on_an_edge_gets_a_restoring_torque() {
    let [state, inches] = [Unit::Millimetre, Unit::Inch].map(pressed);
    let lean = |pose: &Pose| pose.rotation().column(2).dot(&Vector3::x()).asin();
    let [tool, device] = [&state.tool, &state.device].map(lean);
    let hand_lean = lean(&hand_pose(3.0, Unit::Millimetre));
    let DeviceWrench { force, torque } = state.wrench_on_hand;
    assert!(force.z > 0.4 && torque.y < -8.0, "{state:?}");
    assert!(tool < 0.6 * hand_lean, "{tool} of {hand_lean}");
    for spring in [
        HandImpedance::default().turning_stiffness * (hand_lean - device),
        LIMITED.turning_stiffness * (device - tool),
    ] {
        assert!((torque.y / -spring - 1.0).abs() < 0.01, "{spring} N·mm: {torque}");
    }
    assert!(
        (inches.wrench_on_hand.force - force).norm() < 1e-4 * force.norm(),
        "{:?}",
        inches.wrench_on_hand
    );
    assert!(
        (inches.wrench_on_hand.torque - torque).norm() < 1e-4 * torque.norm(),
        "{:?}",
        inches.wrench_on_hand
    );
}
