//! Posture sweeps compared with brute force: a sample of `docs/measured/postures.md`.

use std::num::NonZeroU16;
use std::ops::ControlFlow;
use touchoff::certify::TriangleBvh;
use touchoff::mesh::shapes;
use touchoff::{Mesh, Unit};
use touchoff_bench::postures::brute_force::{TrianglePart, Verdict};
use touchoff_bench::postures::parts::relief;
use touchoff_bench::postures::tool_model::Posture;
use touchoff_bench::postures::tool_model::ToolModel;
use touchoff_bench::postures::{ComparisonSettings, measure};
use touchoff_postures::sweep::PostureSweep;
use touchoff_postures::{Directions, Rules};

fn sample(tools: Vec<&str>, draws: usize) {
    let mesh = relief(20).expect("a block");
    let task = ComparisonSettings {
        mesh: &mesh,
        tools,
        hemisphere: 60,
        tolerance: 0.01,
        niceness: 0.15,
        draws,
        seed: 4,
    };
    let results = measure(&task).expect("a sweep");
    let format_list = |list: &[touchoff_bench::postures::Discrepancy]| format!("{list:#?}");
    for drawn in [&results.accessible, &results.inaccessible] {
        assert_eq!(drawn.count, draws);
        assert!(drawn.contradicted.is_empty(), "{}", format_list(&drawn.contradicted));
        assert!(20 * drawn.undecided.len() <= draws, "{}", format_list(&drawn.undecided));
    }
    let stats = &results.stats;
    assert_eq!(stats.postures(), stats.triangles * 120);
    assert!(
        stats.cached_obstruction > 0
            && stats.obstructed > 0
            && stats.acceptable > 0
            && stats.not_facing > 0
    );
    let sum: u64 = results.reach.iter().map(|reach| reach.postures).sum();
    assert_eq!(sum, stats.acceptable);
}

#[test]
fn accessible_postures_are_free_and_others_are_blocked() {
    sample(vec!["D2Ball", "BallEr16", "TaperedBall"], 300);
}

#[test]
fn corners_two_contacts_and_inch_tools_agree_with_brute_force() {
    sample(vec!["BullNose", "Lollipop", "TSlot", "Dovetail", "Woodruff", "HalfInchBallCat40"], 300);
}

/// The validation must be able to reject a posture.
#[test]
fn brute_force_rejects_blocked_postures() {
    let low = nalgebra::Point3::new(-20.0, -20.0, -30.0);
    let high = nalgebra::Point3::new(20.0, 20.0, 0.0);
    let block = shapes::cuboid(low, high, Unit::Millimetre).expect("a block");
    let part = TrianglePart::new(&block);
    let stand = ToolModel::new("D2Ball", 1.0, 0.01).expect("a restated tool");
    let verdict_at = |tip: [f64; 3], allowance: f64| {
        let posture = Posture { tip: tip.into(), axis: nalgebra::Vector3::z(), niceness: 1.0 };
        part.check(&stand, &posture, 0.01, allowance)
    };
    assert_eq!(verdict_at([0.0, 0.0, 0.0], 0.0), Verdict::Free);
    assert_eq!(verdict_at([0.0, 0.0, -0.0099], 0.0), Verdict::Free);
    assert!(matches!(verdict_at([0.0, 0.0, -0.0101], 0.0), Verdict::Blocked(_)));
    // The flute of 5 mm may cut slightly into the wall beside it; the shank above must not.
    assert_eq!(verdict_at([20.999, 0.0, -4.9], 0.0), Verdict::Free);
    assert!(matches!(verdict_at([20.999, 0.0, -5.1], 0.0), Verdict::Blocked(_)));
    assert_eq!(verdict_at([21.0001, 0.0, -5.1], 0.0), Verdict::Free);
    assert!(matches!(verdict_at([21.0001, 0.0, -5.1], -0.001), Verdict::Blocked(_)));
    // A part far larger than the tool contains it.
    let high = nalgebra::Point3::new(20.0, 20.0, 50.0);
    let block = shapes::cuboid(low, high, Unit::Millimetre).expect("a block");
    let posture = Posture {
        tip: nalgebra::Point3::new(0.0, 0.0, -5.0),
        axis: nalgebra::Vector3::z(),
        niceness: 1.0,
    };
    let verdict = TrianglePart::new(&block).check(&stand, &posture, 0.01, 0.0);
    assert_eq!(verdict, Verdict::Blocked(f64::INFINITY));
}

/// From the centre of a plate's top a ball may lean until its flute would touch. That is the whole upper hemisphere,
/// except where the holder or a shank wider than the ball collides.
#[test]
fn a_plate_is_reached_from_the_upper_hemisphere() {
    let plate = shapes::plane(0.5, 1, Unit::Millimetre).expect("a plate");
    let bvh = TriangleBvh::new(&plate);
    let directions = Directions::spread(400);
    let rules = Rules { tolerance: 0.01, niceness: 0.5, allowed: Vec::new() };
    let tool = tools_library::find("D2Ball").expect("a tool");
    let sweep = PostureSweep::new(&plate, &bvh, vec![tool], &directions, rules, NonZeroU16::MIN)
        .expect("a sweep");
    let mut solid_angles = Vec::new();
    let _: ControlFlow<()> = sweep.run(&[0], |batch| {
        solid_angles.extend(
            batch.rows.iter().map(|(_, row)| directions.solid_angle(&row.access[0].directions)),
        );
        ControlFlow::Continue(())
    });
    assert_eq!(solid_angles.len(), 2);
    for angle in solid_angles {
        assert!((angle - std::f64::consts::TAU).abs() < 0.03, "{angle}");
    }
}

/// A plate in the middle of a hollow block. The tool fits in as it is, so no larger stick-out is needed, however far
/// the holder is assumed to extend above.
#[test]
fn required_stick_out_is_at_most_that_of_the_tool() {
    let block = |low: [f64; 3], high: [f64; 3]| {
        shapes::cuboid(low.into(), high.into(), Unit::Millimetre).expect("a block")
    };
    let plate = block([-1.0, -1.0, -2.0], [1.0, 1.0, 0.0]);
    let [outer, hollow] = [80.0, 60.0].map(|half| block([-half; 3], [half; 3]));
    let vertices = [plate.vertices(), outer.vertices(), hollow.vertices()].concat();
    let offset_corners = |corners: &[u32; 3], offset: u32| corners.map(|corner| corner + offset);
    let outside = outer.triangles().iter().map(|corners| offset_corners(corners, 8));
    // The triangles of the void face inward.
    let inside = hollow.triangles().iter().map(|corners| {
        let [a, b, c] = offset_corners(corners, 16);
        [b, a, c]
    });
    let triangles = plate.triangles().iter().copied().chain(outside).chain(inside).collect();
    let mesh = Mesh::new(vertices, triangles, Unit::Millimetre).expect("a mesh");
    let bvh = TriangleBvh::new(&mesh);
    let directions = Directions::spread(200);
    let rules = Rules { tolerance: 0.01, niceness: 0.1, allowed: Vec::new() };
    let tool = tools_library::find("BallEr16").expect("a tool");
    let sweep = PostureSweep::new(&mesh, &bvh, vec![tool], &directions, rules, NonZeroU16::MIN)
        .expect("a sweep");
    let mut needed = Vec::new();
    let _: ControlFlow<()> = sweep.run(&[0], |batch| {
        needed.extend(batch.rows.iter().filter_map(|(_, row)| row.access[0].stickout));
        ControlFlow::Continue(())
    });
    assert!(needed.len() > 2 && needed.iter().all(|needed| *needed <= 30.0), "{needed:?}");
    assert!(needed.contains(&30.0), "nothing asks for all of it: {needed:?}");
}
