//! The stiffness that follows from a tool, a part and a device: against closed forms of a contact with a plane, and against a hand that
//! presses a sheet.

use std::f64::consts::PI;
use touchoff::tool::Interpreted;
use touchoff::{Cloud, Law, Part, Probe, Sampling, Tool, Unit, mesh::shapes};
use touchoff_haptics::{
    ContactStiffness, DeviceLimits, Session, SessionSettings, SimulatedHand, StiffnessSource,
    ThinPlace,
};
use touchoff_tests::fixtures::cuboid;
use touchoff_tests::haptics::{block, tool, upright};

/// Returns a sheet below z = 0.
fn sheet(thickness: f64, points: usize) -> Part {
    let mesh = cuboid([-15., -15., -thickness], [15., 15., 0.]);
    Part::from_mesh(&mesh, Sampling::new(points)).expect("points of a sheet")
}

fn derived(part: &Part, name: &str, law: Law) -> ContactStiffness {
    ContactStiffness::derived(part, tool(name), law, &DeviceLimits::default())
}

/// The pressure of a ball on a plane is its depth times the cosine of its direction: the integral is π h δ², with the centre at a height
/// of h = R - δ. Under a flat end, points nearer its rim than its face are pushed aside.
#[test]
fn the_devices_force_is_that_of_a_contact_with_a_plane() {
    let part = block(5_000);
    let force = DeviceLimits::default().force;
    let ball = derived(&part, "D2Ball", Law::Gradient);
    let depth = ball.depth.expect("a contact");
    let expected = force / (PI * (1.0 - depth) * depth * depth);
    assert!((ball.stiffness / expected - 1.0).abs() < 0.03, "{ball:?}: {expected}");
    // A contact of a ball is as wide as the root of its depth.
    assert!((0.05..=0.125).contains(&depth), "{depth}");
    let radius = (2.0 * depth - depth * depth).sqrt();
    assert!((ball.radius / radius - 1.0).abs() < 0.05, "{} of {radius}", ball.radius);
    assert_eq!(ball.source, StiffnessSource::Tool);
    let flat = derived(&part, "Flat", Law::Gradient);
    let depth = flat.depth.expect("a contact");
    let expected = force / (PI * (6.0 - depth).powi(2) * depth);
    assert!((flat.stiffness / expected - 1.0).abs() < 0.05, "{flat:?}: {expected}");
    // The device's spring of 1 N/mm gives way by ten times as much.
    assert!((depth - 0.8).abs() < 1e-12 && flat.source == StiffnessSource::Device, "{flat:?}");
    // The law of the thesis pushes twice as hard where normal and direction are opposite.
    let thesis = derived(&part, "D2Ball", Law::Thesis);
    assert!((ball.stiffness / thesis.stiffness - 2.0).abs() < 0.15, "{thesis:?}");
}

#[test]
fn a_given_stiffness_has_its_depth() {
    let part = block(5_000);
    let limits = DeviceLimits::default();
    let derived = derived(&part, "D2Ball", Law::Gradient);
    let given =
        ContactStiffness::of(derived.stiffness, &part, tool("D2Ball"), Law::Gradient, &limits);
    let [one, other] = [derived, given].map(|contact| contact.depth.expect("a contact"));
    assert!((one / other - 1.0).abs() < 0.05, "{one} {other}");
    // The ball is through before it carries 8 N at 1 N/mm³.
    let soft = ContactStiffness::of(1.0, &part, tool("D2Ball"), Law::Gradient, &limits);
    assert_eq!(soft.depth, None);
    assert!(soft.reason().contains("no contact with a plane carries the device's 8 N"));
}

#[test]
fn the_thinnest_place_is_found() {
    for thickness in [0.3, 2.0] {
        let thin = ThinPlace::of(&sheet(thickness, 20_000)).expect("two sides");
        assert!((thin.thickness - thickness).abs() < 1e-3, "{thin:?}");
    }
    let plane = shapes::plane(10.0, 40, Unit::Millimetre).expect("a plane");
    assert_eq!(ThinPlace::of(&Part::from_cloud(&Cloud::centroids(&plane))), None);
}

/// A part in inches has the same stiffness, in N per cubic inch.
#[test]
fn the_unit_of_the_part_does_not_matter() {
    let mm = sheet(0.3, 20_000);
    let inch = mm.clone().converted_to(Unit::Inch);
    let [one, other] = [mm, inch].map(|part| derived(&part, "D2Ball", Law::Gradient).stiffness);
    assert!((other / (one * 25.4f64.powi(3)) - 1.0).abs() < 1e-3, "{one} {other}");
}

#[test]
fn a_tool_without_a_force_is_named() {
    let text = "tool Still { units mm; profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; } magnitude: 5; }";
    let still: Interpreted = text.parse().expect("a tool");
    let part = block(2_000);
    let limits = DeviceLimits::default();
    let contact = ContactStiffness::derived(&part, &still as &dyn Tool, Law::Gradient, &limits);
    assert_eq!((contact.stiffness, contact.source), (1.0, StiffnessSource::Forceless));
    assert!(contact.reason().contains("exerts no force under the law gradient"));
    let contact = ContactStiffness::derived(&part, &still as &dyn Tool, Law::Thesis, &limits);
    assert!(contact.stiffness > 0.0 && contact.source != StiffnessSource::Forceless);
}

/// Presses a ball of 2 mm through a coupling onto a sheet of 0.3 mm, until the device gives its largest force. Returns the lowest tip and
/// the largest force.
fn pressed(part: &Part, stiffness: f64) -> [f64; 2] {
    let limits = DeviceLimits::default();
    let settings = SessionSettings { stiffness, ..SessionSettings::new(1000.0) };
    let probe = Probe::new(part, tool("D2Ball"));
    let mut session = Session::new(probe, &settings, limits).expect("settings");
    // The grip of 0.2 N/mm gives 8 N at 40 mm, and the coupling takes 8 mm.
    let mut hand =
        SimulatedHand::new(limits, 1000.0, |time: f64| upright(0.5 - 25.0 * time.min(2.0)))
            .expect("a hand");
    let states = (0..2_500).filter_map(|_| session.cycle(&mut hand));
    states.fold([f64::INFINITY, 0.0], |[lowest, force], state| {
        let felt = state.wrench_on_hand.force.norm();
        [lowest.min(state.tool.tip().z), force.max(felt)]
    })
}

#[test]
fn the_devices_force_does_not_cross_a_thin_sheet() {
    let part = sheet(0.3, 60_000);
    let contact = derived(&part, "D2Ball", Law::Gradient);
    assert_eq!(contact.source, StiffnessSource::Thickness);
    let depth = contact.depth.expect("a contact");
    assert!((depth - 0.3 / 4.0).abs() < 1e-3, "{depth}");
    assert!(contact.warnings().is_empty(), "{:?}", contact.warnings());
    let [lowest, force] = pressed(&part, contact.stiffness);
    assert!(force > 7.5 && lowest > -0.15, "{force} N at {lowest}");
    // The tool is lower than on a plane by what the points of the other side add.
    assert!(lowest < -0.5 * depth, "{lowest}");
}

#[test]
fn a_sheet_that_the_devices_force_crosses_is_named() {
    let part = sheet(0.3, 60_000);
    let soft =
        ContactStiffness::of(1.0, &part, tool("D2Ball"), Law::Gradient, &DeviceLimits::default());
    let said = soft.warnings().concat();
    assert!(said.contains("the part is 0.3000 mm thin at ("), "{said}");
    assert!(said.contains("may break through there; raise `--stiffness`"), "{said}");
    let [lowest, force] = pressed(&part, soft.stiffness);
    assert!(lowest < -2.0 && force < 7.5, "{force} N at {lowest}");
}

#[test]
fn a_contact_between_the_points_is_named() {
    let said = derived(&block(500), "D2Ball", Law::Gradient).warnings().concat();
    assert!(said.contains("the tool may slip between the points; raise `--points`"), "{said}");
    assert!(derived(&block(50_000), "D2Ball", Law::Gradient).warnings().is_empty());
}
