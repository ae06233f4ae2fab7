//! Other precisions than the one that probes have: what they promise of each other and of themselves.

use crate::compare::tools;
use crate::{parts, poses};
use nalgebra::{Point3, Vector3};
use tools_library::{Barrel, Fig73Exact, UnitSphere};
use touchoff::precision::{Double, Single};
use touchoff::tool::Senses;
use touchoff::{Law, Level, Pose, Probe, Unit};
use touchoff_tests::accuracy;
use touchoff_tests::oracle::Nearest;
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::draw::Draw;
use touchoff_tests::oracle::reference::{At, Reference};
use touchoff_tests::points::points;

/// The filter rules nothing out that is inside: without it each contact has the same bits.
#[test]
fn nothing_is_lost_by_the_filter() {
    for part in [parts::soup(6.0, 4_097, 1), parts::tube(3_000)] {
        for (tool, oracle) in tools() {
            let mut draw = Draw::new(8);
            let mut filtered = Probe::new(&part, tool);
            let mut double = Probe::new(&part, tool).precision::<Double>();
            assert_eq!(filtered.error(), double.error());
            for k in 0..200 {
                let pose = poses::about(&part, &*oracle, k, &mut draw);
                let contacts = format!("{:?}", filtered.contacts(&pose));
                assert_eq!(contacts, format!("{:?}", double.contacts(&pose)), "{}", oracle.name());
                let [one, other] = [filtered.wrench(&pose), double.wrench(&pose)];
                // The order of sums may be another, and so which of several is the deepest.
                assert_eq!(one.depth(), double.wrench(&pose).depth());
                let off = (one.force - other.force).norm();
                assert!(off <= one.rounding.force + other.rounding.force, "{off:e}");
                let off = (one.torque - other.torque).norm();
                assert!(off <= one.rounding.torque + other.rounding.torque, "{off:e}");
            }
        }
    }
}

/// Depths in `f32` against 256 bits, where they are hardest: beside the surface and splitting curves. The
/// errors are shares of what is stated.
fn single<T: Senses + Senses<f32>>(tool: &T, seed: u64) -> f64 {
    let card = tool.card();
    let listed = accuracy::tools().into_iter().find(|(other, _)| other.card().name == card.name);
    let (_, restated) = listed.expect("a tool with a restatement");
    let (oracle, reference) = (Nearest::new(&restated), Reference::new(&restated));
    let given = points(&oracle, 20_000, seed);
    let far = Vector3::new(700.0, -300.0, 55.0);
    let places: Vec<_> = given.iter().map(|p| Point3::from(*p) + far).collect();
    let part = parts::of(places.clone(), vec![Vector3::z(); given.len()], vec![1.0; given.len()]);
    let pose = Pose::from_axis(Point3::from(far), Vector3::z()).expect("a pose");
    let mut probe = Probe::new(&part, tool).precision::<Single>();
    let stated = probe.error().expect("the library's depths are bounded");
    let mut depths = vec![0.0; given.len()];
    for contact in probe.contacts(&pose) {
        assert!(contact.depth.is_finite() && contact.niceness.is_finite(), "{contact:?}");
        assert!((contact.direction.norm() - 1.0).abs() < 1e-6, "{contact:?}");
        depths[contact.triangle as usize] = contact.depth;
    }
    let mut worst = 0.0f64;
    for (at, depth) in places.iter().zip(depths) {
        let own: [f64; 3] = (at - far).coords.into();
        let exact = reference.depth(&At::new(own));
        // Outside, nothing is felt.
        let exact = if exact.is_negative() { Big::zero() } else { exact };
        worst = worst.max((&Big::exactly(depth) - &exact).abs().to_f64());
    }
    println!("{}: {worst:e} of {stated:e} mm", card.name);
    worst / stated
}

#[test]
fn single_keeps_the_error_that_is_stated() {
    for share in [single(&UnitSphere, 1), single(&Fig73Exact, 2), single(&Barrel, 3)] {
        // No idle statement.
        assert!((0.001..=1.0).contains(&share), "{share}");
    }
}

#[test]
fn single_has_the_same_bits_at_every_level() {
    let part = parts::tube(3_000);
    let said = |level: Level, pose: &Pose| {
        let probe = Probe::new(&part, &UnitSphere).precision::<Single>().law(Law::Gradient);
        let mut probe = probe.level(level);
        let (wrench, detected) = (probe.wrench(pose), probe.detect(pose));
        format!("{wrench:?} {detected} {:?}", probe.contacts(pose))
    };
    let poses: Vec<Pose> = (0..200).map(|k| touchoff::scenes::Path::Outside.pose(k, 200)).collect();
    let best = Level::new();
    let mut levels = vec![Level::baseline()];
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        levels.extend(best.as_sse4_2().map(Level::Sse4_2));
        levels.extend(best.as_avx2().map(Level::Avx2));
    }
    for pose in &poses {
        let first = said(best, pose);
        levels.iter().for_each(|level| assert_eq!(first, said(*level, pose), "{level:?}"));
    }
}

/// Far from the world's origin `f32` knows the part as well as here: it sees points from their leaf.
#[test]
fn single_does_not_mind_how_far_away_a_part_is() {
    let shift = Vector3::new(1e9, -1e9, 1e9);
    let [here, there] =
        [Vector3::zeros(), shift].map(|by| parts::carried(&parts::tube_mesh(), 20_000, |p| p + by));
    let mut near = Probe::new(&here, &UnitSphere).precision::<Single>();
    let mut far = Probe::new(&there, &UnitSphere).precision::<Single>();
    assert_eq!(here.unit(), Unit::Millimetre);
    // Coordinates at 1e9 are a tenth of a µm apart, and so are the points.
    let apart = near.error().expect("bounded") + far.error().expect("bounded") + 1e-6;
    let path = touchoff::scenes::Path::Outside;
    for k in 0..500 {
        let pose = path.pose(k, 500);
        let moved = Pose::from_axis(pose.tip() + shift, pose.axis()).expect("a pose");
        let depths = [near.wrench(&pose).depth(), far.wrench(&moved).depth()];
        assert!((depths[0] - depths[1]).abs() <= apart, "{depths:?}");
    }
}
