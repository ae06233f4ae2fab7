//! Item 14, beyond the list: equivalent scenes. A scene is rotated as a whole, mirrored, spun about the tool's axis or
//! converted to another unit. Clouds are merged, and their forces must add.

use super::leaves::{rounding, told};
use super::ledger::{Kind, Ledger};
use super::moved::pose;
use super::scene::{Asked, Given, apart, shown};
use super::truth::Subject;
use nalgebra::{Matrix3, Point3, Vector3};
use touchoff::{Contact, Part, Pose, Probe, Unit};
use touchoff_tests::oracle::draw::Rng;

const MIRRORED: Kind = Kind::never("mirrored: other bits");
const MERGED: Kind = Kind::never("merged: other contacts");
const ADDED: Kind = Kind::of("merged: force and torque", "3 roundings of the sums", 1.0);

/// Spacing of the coordinates' grid. Near the tool, its multiples are stored without rounding in any tree.
const GRID: f64 = 1.0 / 1024.0;

/// Compares all equivalent scenes, `rounds` times.
pub(super) fn alike(
    subject: &Subject,
    (count, rounds): (usize, usize),
    draw: &mut Rng,
    ledger: &mut Ledger,
) {
    for _ in 0..rounds {
        let own = Given::about(subject, count, GRID, draw);
        let turned = pose(Point3::new(0.5, -0.25, 1.0), draw);
        let here = own.at(&turned, GRID);
        whole(subject, (&here, &turned), draw, ledger);
        mirrored(subject, &own, ledger);
        if subject.oracle.revolved() {
            spun(subject, &own, draw, ledger);
        }
        merged(subject, &here, &turned, draw, ledger);
        units(subject, (&here, &turned), ledger);
    }
}

fn contacts(subject: &Subject, part: &Part, pose: &Pose) -> Vec<Contact> {
    Probe::new(part, subject.tool).contacts(pose).to_vec()
}

/// Returns the allowed difference of depths between two parts: both rounding error bounds, and the effect of rounding
/// coordinates of magnitude `size`.
fn bound(subject: &Subject, parts: [&Part; 2], size: f64) -> f64 {
    let steep = subject.tool.info().depth.lipschitz.expect("proved of every tool");
    let error =
        |part: &Part| Probe::new(part, subject.tool).rounding_error_bound().expect("proved");
    let rounding = steep * 8.0 * f64::EPSILON * size;
    parts.into_iter().map(error).sum::<f64>() + rounding
}

/// Rotates part and tool together by a random rotation.
fn whole(
    subject: &Subject,
    (here, pose_here): (&Given, &Pose),
    draw: &mut Rng,
    ledger: &mut Ledger,
) {
    let by = pose(Point3::origin(), draw);
    let turn = |p: &Point3<f64>| Point3::from(by.rotation() * p.coords);
    let there = Given { points: here.points.iter().map(turn).collect(), ..here.clone() };
    let rotation = nalgebra::Rotation3::from_matrix_unchecked(by.rotation() * pose_here.rotation());
    let q = nalgebra::UnitQuaternion::from(rotation).coords;
    let tip = turn(&pose_here.tip());
    let turned = Pose::from_quaternion(tip, [q.x, q.y, q.z, q.w]).expect("a unit quaternion");
    let parts = [here.part(), there.part()];
    let (tool, truth) = (subject.tool, &*subject.truth);
    Asked { tool, truth, given: &there, part: &parts[1] }.at(&turned, ledger);
    let found = [contacts(subject, &parts[0], pose_here), contacts(subject, &parts[1], &turned)];
    let bound = bound(subject, parts.each_ref(), 2.0 * subject.scale());
    let place = || format!("turned to {}", shown(&turned));
    apart([&found[0], &found[1]], here.points.len(), bound, place, ledger);
}

/// Returns the values of contacts that do not change under a mirror or a half turn, in a canonical order. Regions are
/// omitted for the block, since two of its sides are exchanged.
fn evaluation(subject: &Subject, contacts: &[Contact]) -> Vec<(u32, usize, u64, u64, u64)> {
    let mut list: Vec<_> = contacts
        .iter()
        .map(|c| {
            let [depth, magnitude, niceness] =
                [c.depth, c.magnitude, c.niceness].map(|v| (v + 0.0).to_bits());
            let region = if subject.name() == "Block" { 0 } else { c.region };
            (c.triangle.0, region, depth, magnitude, niceness)
        })
        .collect();
    list.sort_unstable();
    list
}

/// Mirrors the part in y, a symmetry of all tools. For a tool of revolution, also mirrors it in x and in the diagonal.
fn mirrored(subject: &Subject, own: &Given, ledger: &mut Ledger) {
    let plain = evaluation(subject, &contacts(subject, &own.part(), &Pose::default()));
    let mut mirrors = vec![Matrix3::new(1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0)];
    if subject.oracle.revolved() {
        mirrors.push(Matrix3::new(-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0));
        mirrors.push(Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0));
    }
    for mirror in mirrors {
        let image = |p: &Point3<f64>| Point3::from(mirror * p.coords);
        let other = Given { points: own.points.iter().map(image).collect(), ..own.clone() };
        let seen = evaluation(subject, &contacts(subject, &other.part(), &Pose::default()));
        ledger.count(MIRRORED, seen != plain, || format!("by {:?}", mirror.as_slice()));
    }
}

/// Rotates the tool about its own axis and leaves the part fixed.
fn spun(subject: &Subject, own: &Given, draw: &mut Rng, ledger: &mut Ledger) {
    let part = own.part();
    let plain = contacts(subject, &part, &Pose::default());
    let half = draw.between(0.0, std::f64::consts::TAU) / 2.0;
    let spin = [0.0, 0.0, half.sin(), half.cos()];
    let pose = Pose::from_quaternion(Point3::origin(), spin).expect("a unit quaternion");
    let bound = bound(subject, [&part, &part], 2.0 * subject.scale());
    let place = || format!("spun to {}", shown(&pose));
    apart([&plain, &contacts(subject, &part, &pose)], own.points.len(), bound, place, ledger);
    // A half turn does not round.
    let half = [0.0, 0.0, 1.0, 0.0];
    let pose = Pose::from_quaternion(Point3::origin(), half).expect("a unit quaternion");
    let seen = evaluation(subject, &contacts(subject, &part, &pose));
    ledger.count(MIRRORED, seen != evaluation(subject, &plain), || shown(&pose));
}

/// Compares a part with two parts that have half of its points each.
fn merged(subject: &Subject, here: &Given, pose: &Pose, draw: &mut Rng, ledger: &mut Ledger) {
    let mut all = here.clone();
    // Weights that every part stores exactly: multiples of 1/64, with the same maximum in both halves.
    for weight in &mut all.weights {
        *weight = (draw.between(0.1, 2.0) * 64.0).round() / 64.0;
    }
    let half = all.points.len() / 2;
    all.weights[0] = 2.0;
    all.weights[half] = 2.0;
    let some = |range: std::ops::Range<usize>| {
        let ids = range.clone().map(|k| k as u32).collect();
        let cloud = touchoff::Cloud::new(
            all.points[range.clone()].to_vec(),
            all.normals[range.clone()].to_vec(),
            ids,
            all.weights[range].to_vec(),
            all.unit,
        );
        Part::from_cloud(&cloud.expect("some of the points"))
    };
    let parts = [0..half, half..all.points.len(), 0..all.points.len()].map(some);
    let lists = parts.each_ref().map(|part| contacts(subject, part, pose));
    let two: Vec<Contact> = lists[0].iter().chain(&lists[1]).copied().collect();
    ledger.count(MERGED, told(&two) != told(&lists[2]), || shown(pose));
    let [a, b, ab] = parts.each_ref().map(|part| Probe::new(part, subject.tool).wrench(pose));
    let [force, torque] = rounding(&lists[2], pose);
    let part = |off: Vector3<f64>, bound: f64| {
        if off == Vector3::zeros() { 0.0 } else { off.norm() / (3.0 * bound) }
    };
    ledger.see(ADDED, part(a.force + b.force - ab.force, force), || shown(pose));
    ledger.see(ADDED, part(a.torque + b.torque - ab.torque, torque), || shown(pose));
}

/// Compares the scene in millimetres, inches and metres, with the points given in that unit and with the part converted
/// to it.
fn units(subject: &Subject, (here, pose): (&Given, &Pose), ledger: &mut Ledger) {
    let own = here.unit;
    let part = here.part();
    let plain = contacts(subject, &part, pose);
    for unit in [Unit::Millimetre, Unit::Inch, Unit::Metre] {
        let by = own.factor_to(unit);
        let point = |p: &Point3<f64>| Point3::from(p.coords * by);
        let points = here.points.iter().map(point).collect();
        let given = Given { points, unit, ..here.clone() };
        let q = pose.to_isometry().rotation.coords;
        let there = Pose::from_quaternion(point(&pose.tip()), [q.x, q.y, q.z, q.w]);
        let there = there.expect("a unit quaternion");
        let other = given.part();
        let (tool, truth) = (subject.tool, &*subject.truth);
        Asked { tool, truth, given: &given, part: &other }.at(&there, ledger);
        let changed = part.clone().converted_to(unit);
        let mut seen = contacts(subject, &changed, &there);
        for contact in &mut seen {
            contact.depth /= by;
        }
        let bound = bound(subject, [&part, &part], 2.0 * subject.scale());
        let place = || format!("in {}, {}", unit.symbol(), shown(&there));
        apart([&plain, &seen], here.points.len(), bound, place, ledger);
    }
}
