//! Item 14, beyond the list: equivalent scenes. A scene is rotated as a whole, mirrored, spun about the tool's axis or
//! converted to another unit. Clouds are merged, and their forces must add.

use super::leaves::{rounding, sorted_contact_text};
use super::ledger::{Kind, Ledger};
use super::scene::{PointSet, ProbeCheck, compare_depths, format_pose};
use super::translated::pose;
use super::truth::Subject;
use nalgebra::{Matrix3, Point3, Vector3};
use touchoff::TriangleId;
use touchoff::{Contact, Part, Pose, Probe, Unit};
use touchoff_tests::oracle::rng::Rng;

const MIRRORED: Kind = Kind::forbidden_event("mirrored: other bits");
const MERGED: Kind = Kind::forbidden_event("merged: other contacts");
const ADDED: Kind = Kind::with_limit("merged: force and torque", "3 roundings of the sums", 1.0);

/// Spacing of the coordinates' grid. Near the tool, its multiples are stored without rounding in any tree.
const GRID: f64 = 1.0 / 1024.0;

/// Compares all equivalent scenes, `rounds` times.
pub(super) fn equivalent_scenes(
    subject: &Subject,
    (count, rounds): (usize, usize),
    rng: &mut Rng,
    ledger: &mut Ledger,
) {
    for _ in 0..rounds {
        let scene = PointSet::near_tool(subject, count, GRID, rng);
        let scene_pose = pose(Point3::new(0.5, -0.25, 1.0), rng);
        let placed = scene.transformed(&scene_pose, GRID);
        rotate_scene(subject, (&placed, &scene_pose), rng, ledger);
        mirror_part(subject, &scene, ledger);
        if subject.oracle.is_revolved() {
            spin_tool(subject, &scene, rng, ledger);
        }
        merge_clouds(subject, &placed, &scene_pose, rng, ledger);
        convert_units(subject, (&placed, &scene_pose), ledger);
    }
}

fn contacts(subject: &Subject, part: &Part, pose: &Pose) -> Vec<Contact> {
    Probe::new(part, subject.tool).contacts(pose).to_vec()
}

/// Returns the allowed difference of depths between two parts: both rounding error bounds, and the effect of rounding
/// coordinates of magnitude `size`.
fn depth_bound(subject: &Subject, parts: [&Part; 2], size: f64) -> f64 {
    let lipschitz = subject.tool.info().depth.lipschitz.expect("proved of every tool");
    let error =
        |part: &Part| Probe::new(part, subject.tool).rounding_error_bound().expect("proved");
    let rounding = lipschitz * 8.0 * f64::EPSILON * size;
    parts.into_iter().map(error).sum::<f64>() + rounding
}

/// Rotates part and tool together by a random rotation.
fn rotate_scene(
    subject: &Subject,
    (original, original_pose): (&PointSet, &Pose),
    rng: &mut Rng,
    ledger: &mut Ledger,
) {
    let random_turn = pose(Point3::origin(), rng);
    let rotate = |p: &Point3<f64>| Point3::from(random_turn.rotation() * p.coords);
    let rotated =
        PointSet { points: original.points.iter().map(rotate).collect(), ..original.clone() };
    let rotation = nalgebra::Rotation3::from_matrix_unchecked(
        random_turn.rotation() * original_pose.rotation(),
    );
    let q = nalgebra::UnitQuaternion::from(rotation).coords;
    let tip = rotate(&original_pose.tip());
    let rotated_pose = Pose::from_quaternion(tip, [q.x, q.y, q.z, q.w]).expect("a unit quaternion");
    let parts = [original.part(), rotated.part()];
    let (tool, truth) = (subject.tool, &*subject.truth);
    ProbeCheck { tool, truth, point_set: &rotated, part: &parts[1] }.check(&rotated_pose, ledger);
    let both =
        [contacts(subject, &parts[0], original_pose), contacts(subject, &parts[1], &rotated_pose)];
    let bound = depth_bound(subject, parts.each_ref(), 2.0 * subject.scale());
    let location = || format!("turned to {}", format_pose(&rotated_pose));
    compare_depths([&both[0], &both[1]], original.points.len(), bound, location, ledger);
}

/// Returns the values of contacts that do not change under a mirror or a half turn, in a canonical order. Regions are
/// omitted for the block, since two of its sides are exchanged.
fn evaluation(subject: &Subject, contacts: &[Contact]) -> Vec<(u32, usize, u64, u64, u64)> {
    let mut values: Vec<_> = contacts
        .iter()
        .map(|c| {
            let [depth, magnitude, niceness] =
                [c.depth, c.magnitude, c.niceness].map(|v| (v + 0.0).to_bits());
            let region = if subject.name() == "Block" { 0 } else { c.region };
            (c.triangle.0, region, depth, magnitude, niceness)
        })
        .collect();
    values.sort_unstable();
    values
}

/// Mirrors the part in y, a symmetry of all tools. For a tool of revolution, also mirrors it in x and in the diagonal.
fn mirror_part(subject: &Subject, scene: &PointSet, ledger: &mut Ledger) {
    let expected = evaluation(subject, &contacts(subject, &scene.part(), &Pose::default()));
    let mut mirrors = vec![Matrix3::new(1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0)];
    if subject.oracle.is_revolved() {
        mirrors.push(Matrix3::new(-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0));
        mirrors.push(Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0));
    }
    for mirror in mirrors {
        let image = |p: &Point3<f64>| Point3::from(mirror * p.coords);
        let mirrored_scene =
            PointSet { points: scene.points.iter().map(image).collect(), ..scene.clone() };
        let actual =
            evaluation(subject, &contacts(subject, &mirrored_scene.part(), &Pose::default()));
        ledger.count(MIRRORED, actual != expected, || format!("by {:?}", mirror.as_slice()));
    }
}

/// Rotates the tool about its own axis and leaves the part fixed.
fn spin_tool(subject: &Subject, scene: &PointSet, rng: &mut Rng, ledger: &mut Ledger) {
    let part = scene.part();
    let expected = contacts(subject, &part, &Pose::default());
    let half_angle = rng.between(0.0, std::f64::consts::TAU) / 2.0;
    let spin = [0.0, 0.0, half_angle.sin(), half_angle.cos()];
    let pose = Pose::from_quaternion(Point3::origin(), spin).expect("a unit quaternion");
    let bound = depth_bound(subject, [&part, &part], 2.0 * subject.scale());
    let location = || format!("spun to {}", format_pose(&pose));
    compare_depths(
        [&expected, &contacts(subject, &part, &pose)],
        scene.points.len(),
        bound,
        location,
        ledger,
    );
    // A half turn does not round.
    let half_turn = [0.0, 0.0, 1.0, 0.0];
    let pose = Pose::from_quaternion(Point3::origin(), half_turn).expect("a unit quaternion");
    let actual = evaluation(subject, &contacts(subject, &part, &pose));
    ledger.count(MIRRORED, actual != evaluation(subject, &expected), || format_pose(&pose));
}

/// Compares a part with two parts that have half of its points each.
fn merge_clouds(
    subject: &Subject,
    scene: &PointSet,
    pose: &Pose,
    rng: &mut Rng,
    ledger: &mut Ledger,
) {
    let mut weighted = scene.clone();
    // Weights that every part stores exactly: multiples of 1/64, with the same maximum in both halves.
    for weight in &mut weighted.weights {
        *weight = (rng.between(0.1, 2.0) * 64.0).round() / 64.0;
    }
    let half = weighted.points.len() / 2;
    weighted.weights[0] = 2.0;
    weighted.weights[half] = 2.0;
    let part_of = |range: std::ops::Range<usize>| {
        let ids = range.clone().map(|k| TriangleId(k as u32)).collect();
        let cloud = touchoff::Cloud::new(
            weighted.points[range.clone()].to_vec(),
            weighted.normals[range.clone()].to_vec(),
            ids,
            weighted.weights[range].to_vec(),
            weighted.unit,
        );
        Part::from_cloud(&cloud.expect("some of the points"))
    };
    let parts = [0..half, half..weighted.points.len(), 0..weighted.points.len()].map(part_of);
    let lists = parts.each_ref().map(|part| contacts(subject, part, pose));
    let both_halves: Vec<Contact> = lists[0].iter().chain(&lists[1]).copied().collect();
    ledger.count(
        MERGED,
        sorted_contact_text(&both_halves) != sorted_contact_text(&lists[2]),
        || format_pose(pose),
    );
    let [a, b, ab] = parts.each_ref().map(|part| Probe::new(part, subject.tool).wrench(pose));
    let [force, torque] = rounding(&lists[2], pose);
    let ratio = |difference: Vector3<f64>, bound: f64| {
        if difference == Vector3::zeros() { 0.0 } else { difference.norm() / (3.0 * bound) }
    };
    ledger.record(ADDED, ratio(a.force + b.force - ab.force, force), || format_pose(pose));
    ledger.record(ADDED, ratio(a.torque + b.torque - ab.torque, torque), || format_pose(pose));
}

/// Compares the scene in millimetres, inches and metres, with the points given in that unit and with the part converted
/// to it.
fn convert_units(subject: &Subject, (scene, pose): (&PointSet, &Pose), ledger: &mut Ledger) {
    let original_unit = scene.unit;
    let part = scene.part();
    let expected = contacts(subject, &part, pose);
    for unit in [Unit::Millimetre, Unit::Inch, Unit::Metre] {
        let factor = original_unit.factor_to(unit);
        let point = |p: &Point3<f64>| Point3::from(p.coords * factor);
        let points = scene.points.iter().map(point).collect();
        let converted_scene = PointSet { points, unit, ..scene.clone() };
        let q = pose.to_isometry().rotation.coords;
        let converted_pose = Pose::from_quaternion(point(&pose.tip()), [q.x, q.y, q.z, q.w]);
        let converted_pose = converted_pose.expect("a unit quaternion");
        let converted_part = converted_scene.part();
        let (tool, truth) = (subject.tool, &*subject.truth);
        ProbeCheck { tool, truth, point_set: &converted_scene, part: &converted_part }
            .check(&converted_pose, ledger);
        let part_in_unit = part.clone().converted_to(unit);
        let mut actual = contacts(subject, &part_in_unit, &converted_pose);
        for contact in &mut actual {
            contact.depth /= factor;
        }
        let bound = depth_bound(subject, [&part, &part], 2.0 * subject.scale());
        let location = || format!("in {}, {}", unit.symbol(), format_pose(&converted_pose));
        compare_depths([&expected, &actual], scene.points.len(), bound, location, ledger);
    }
}
