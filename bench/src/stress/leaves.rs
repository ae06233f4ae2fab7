//! Item 11: trees of few points. A leaf has 16 points by design, so counts about 1, 16 and 256 test the leaf size.
//! Every order of the points must give the same contacts to the last bit, and these must agree with 256 bits.

use super::ledger::{Kind, Ledger};
use super::scene::{PointSet, ProbeCheck, format_pose};
use super::translated::pose;
use super::truth::Subject;
use nalgebra::{Point3, Vector3};
use touchoff::TriangleId;
use touchoff::{Contact, Part, Pose, Probe, Wrench};
use touchoff_tests::oracle::rng::Rng;

const OTHER_CONTACTS: Kind = Kind::forbidden_event("another order: other contacts");
/// Sums are taken in the tree's order, which within a leaf is the cloud's order.
const SUM_DIFFERENCE: Kind =
    Kind::with_limit("another order: force and torque", "2 roundings of the sums", 1.0);

/// Numbers of points: full and partial leaves, one level and two.
pub(super) const COUNTS: [usize; 9] = [1, 2, 3, 15, 16, 17, 255, 256, 257];

/// Validates trees of each size, in several orders of the points.
pub(super) fn leaves(
    subject: &Subject,
    (orders, poses): (usize, usize),
    rng: &mut Rng,
    ledger: &mut Ledger,
) {
    let grid = 1.0 / 1024.0;
    for count in COUNTS {
        let scene = PointSet::near_tool(subject, count, grid, rng);
        for k in 0..poses {
            let scene_pose = if k == 0 { Pose::default() } else { pose(Point3::origin(), rng) };
            let placed = scene.transformed(&scene_pose, grid);
            let part = placed.part();
            let (tool, truth) = (subject.tool, &*subject.truth);
            let check = ProbeCheck { tool, truth, point_set: &placed, part: &part };
            let first = check.check(&scene_pose, ledger);
            for order in permutations(count, orders, rng) {
                let part = reordered(&placed, &order);
                let mut probe = Probe::new(&part, tool);
                let reordered_answers =
                    (probe.contacts(&scene_pose).to_vec(), probe.wrench(&scene_pose));
                compare(&first, &reordered_answers, &scene_pose, ledger);
            }
        }
    }
}

/// Returns all orders of up to three items. For more items, returns `max_orders` orders, the reverse among them.
fn permutations(count: usize, max_orders: usize, rng: &mut Rng) -> Vec<Vec<usize>> {
    match count {
        1 => return vec![vec![0]],
        2 => return vec![vec![0, 1], vec![1, 0]],
        3 => {
            return [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]]
                .map(|order| order.to_vec())
                .to_vec();
        }
        _ => {}
    }
    let mut orders = vec![(0..count).rev().collect::<Vec<_>>()];
    while orders.len() < max_orders {
        let mut order: Vec<usize> = (0..count).collect();
        for k in (1..count).rev() {
            order.swap(k, rng.bits() as usize % (k + 1));
        }
        orders.push(order);
    }
    orders
}

/// Builds the part of the points in another order. A point's original index is its triangle id.
fn reordered(point_set: &PointSet, order: &[usize]) -> Part {
    let pick = |k: &usize| (point_set.points[*k], point_set.normals[*k]);
    let (points, normals): (Vec<_>, Vec<_>) = order.iter().map(pick).unzip();
    let ids = order.iter().map(|k| TriangleId(*k as u32)).collect();
    let weights = order.iter().map(|k| point_set.weights[*k]).collect();
    let cloud = touchoff::Cloud::new(points, normals, ids, weights, point_set.unit);
    Part::from_cloud(&cloud.expect("the same points"))
}

/// Returns all numbers of each contact as text, sorted by triangle.
pub(super) fn sorted_contact_text(contacts: &[Contact]) -> Vec<(u32, String)> {
    let mut lines: Vec<_> = contacts.iter().map(|c| (c.triangle.0, format!("{c:?}"))).collect();
    lines.sort();
    lines
}

/// Returns the rounding bounds of force and torque sums over the contacts.
pub(super) fn rounding(contacts: &[Contact], pose: &Pose) -> [f64; 2] {
    let relative_error = f64::EPSILON * (16.0 + contacts.len() as f64 / 4.0);
    let force_of = |c: &Contact| 2.0 * c.weight * c.magnitude;
    let force: f64 = contacts.iter().map(force_of).sum();
    let torque_of = |c: &Contact| force_of(c) * (c.point - pose.tip()).norm();
    [relative_error * force, relative_error * contacts.iter().map(torque_of).sum::<f64>()]
}

fn compare(
    (contacts, wrench): &(Vec<Contact>, Wrench),
    (other_contacts, other_wrench): &(Vec<Contact>, Wrench),
    pose: &Pose,
    ledger: &mut Ledger,
) {
    ledger.count(
        OTHER_CONTACTS,
        sorted_contact_text(contacts) != sorted_contact_text(other_contacts),
        || format_pose(pose),
    );
    let [force, torque] = rounding(contacts, pose);
    let ratio = |difference: Vector3<f64>, bound: f64| {
        if difference == Vector3::zeros() { 0.0 } else { difference.norm() / (2.0 * bound) }
    };
    ledger.record(SUM_DIFFERENCE, ratio(wrench.force - other_wrench.force, force), || {
        format_pose(pose)
    });
    ledger.record(SUM_DIFFERENCE, ratio(wrench.torque - other_wrench.torque, torque), || {
        format_pose(pose)
    });
}
