//! Item 6: part and pose translated together, by 1e3 to 1e12.

use super::ledger::{Kind, Ledger};
use super::scene::{PointSet, ProbeCheck, compare_depths, format_pose};
use super::truth::Subject;
use nalgebra::{Point3, Vector3};
use touchoff::{Contact, Pose, Probe};
use touchoff_tests::oracle::rng::Rng;

/// If no coordinate loses a bit, all evaluations must have the same bits.
const CHANGED_BITS: Kind = Kind::forbidden_event("moved without a loss: other bits");
/// Spacing of the coordinates' grid, so that sums with 2^40 are exact.
const GRID: f64 = 1.0 / 1024.0;

/// Translates a scene.
pub(super) fn translated_scenes(
    subject: &Subject,
    (count, poses): (usize, usize),
    rng: &mut Rng,
    ledger: &mut Ledger,
) {
    let scene = PointSet::near_tool(subject, count, GRID, rng);
    for _ in 0..poses {
        let scene_pose = pose(Point3::origin(), rng);
        let placed = scene.transformed(&scene_pose, GRID);
        let tip = Point3::origin();
        for power in [10, 20, 30, 40] {
            let offset = 2f64.powi(power) * Vector3::new(1.0, -1.0, 0.5);
            compare_bits(subject, (&placed, &scene_pose), offset, tip, ledger);
        }
        for distance in [1e3, 1e6, 1e9, 1e12] {
            let offset = distance * Vector3::new(1.0, -0.7, 0.3);
            compare_with_bounds(subject, (&placed, &scene_pose), offset, ledger);
        }
    }
}

/// Returns a pose with a random orientation.
pub(super) fn pose(tip: Point3<f64>, rng: &mut Rng) -> Pose {
    loop {
        let q = [0; 4].map(|_| rng.between(-1.0, 1.0));
        let norm = q.iter().map(|c| c * c).sum::<f64>().sqrt();
        if (0.1..=1.0).contains(&norm) {
            return Pose::from_quaternion(tip, q.map(|c| c / norm)).expect("a unit quaternion");
        }
    }
}

/// Returns the pose with another tip.
fn with_tip(pose: &Pose, tip: Point3<f64>) -> Pose {
    let q = pose.to_isometry().rotation.coords;
    Pose::from_quaternion(tip, [q.x, q.y, q.z, q.w]).expect("a unit quaternion")
}

/// Returns contacts without their points, as text of all numbers, so that different numbers give different text.
fn evaluation(contacts: &[Contact]) -> Vec<String> {
    let text_of = |c: &Contact| {
        format!(
            "{} {} {:?} {:?} {:?} {:?}",
            c.triangle, c.region, c.depth, c.magnitude, c.direction, c.gradient
        )
    };
    contacts.iter().map(text_of).collect()
}

fn compare_bits(
    subject: &Subject,
    (scene, scene_pose): (&PointSet, &Pose),
    offset: Vector3<f64>,
    tip: Point3<f64>,
    ledger: &mut Ledger,
) {
    let (a, b) = (with_tip(scene_pose, tip), with_tip(scene_pose, tip + offset));
    let parts = [scene.part(), scene.translated(offset).part()];
    let mut probes = parts.each_ref().map(|part| Probe::new(part, subject.tool));
    let contacts = [(0, &a), (1, &b)].map(|(k, pose)| evaluation(probes[k].contacts(pose)));
    let wrenches = [(0, &a), (1, &b)].map(|(k, pose)| {
        let mut wrench = probes[k].wrench(pose);
        if let Some(deepest) = &mut wrench.deepest {
            deepest.point = Point3::origin(); // it is elsewhere
        }
        format!("{wrench:?}")
    });
    let differs = contacts[0] != contacts[1] || wrenches[0] != wrenches[1];
    ledger.count(CHANGED_BITS, differs, || format_pose(&b));
}

fn compare_with_bounds(
    subject: &Subject,
    (scene, scene_pose): (&PointSet, &Pose),
    offset: Vector3<f64>,
    ledger: &mut Ledger,
) {
    let (a, b) =
        (with_tip(scene_pose, Point3::origin()), with_tip(scene_pose, Point3::origin() + offset));
    let translated_scene = scene.translated(offset);
    let parts = [scene.part(), translated_scene.part()];
    let [original_part, translated_part] = parts.each_ref();
    let (tool, truth) = (subject.tool, &*subject.truth);
    let (original_contacts, _) =
        ProbeCheck { tool, truth, point_set: scene, part: original_part }.check(&a, ledger);
    let (translated_contacts, _) =
        ProbeCheck { tool, truth, point_set: &translated_scene, part: translated_part }
            .check(&b, ledger);
    let lipschitz = tool.info().depth.lipschitz.expect("proved of every tool");
    let errors: f64 = parts
        .each_ref()
        .map(|part| Probe::new(part, tool).rounding_error_bound().expect("proved of every tool"))
        .iter()
        .sum();
    // Each coordinate of the point and of the tip is rounded to half an ulp at its position.
    let rounding = lipschitz * 3f64.sqrt() * f64::EPSILON * (offset.amax() + subject.scale());
    let bound = errors + rounding;
    let location = || format!("moved by {:?}, {}", offset.as_slice(), format_pose(&a));
    compare_depths(
        [&original_contacts, &translated_contacts],
        scene.points.len(),
        bound,
        location,
        ledger,
    );
}
