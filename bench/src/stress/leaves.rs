//! Item 11: trees of few points. A leaf has 16 points by design, so counts about 1, 16 and 256 test the leaf size.
//! Every order of the points must give the same contacts to the last bit, and these must agree with 256 bits.

use super::ledger::{Kind, Ledger};
use super::moved::pose;
use super::scene::{Asked, Given, shown};
use super::truth::Subject;
use nalgebra::{Point3, Vector3};
use touchoff::{Contact, Part, Pose, Probe, Wrench};
use touchoff_tests::oracle::draw::Rng;

const SAME: Kind = Kind::never("another order: other contacts");
/// Sums are taken in the tree's order, which within a leaf is the cloud's order.
const SUMS: Kind = Kind::of("another order: force and torque", "2 roundings of the sums", 1.0);

/// Numbers of points: full and partial leaves, one level and two.
pub(super) const COUNTS: [usize; 9] = [1, 2, 3, 15, 16, 17, 255, 256, 257];

/// Validates trees of each size, in several orders of the points.
pub(super) fn leaves(
    subject: &Subject,
    (orders, poses): (usize, usize),
    draw: &mut Rng,
    ledger: &mut Ledger,
) {
    let grid = 1.0 / 1024.0;
    for count in COUNTS {
        let own = Given::about(subject, count, grid, draw);
        for k in 0..poses {
            let turned = if k == 0 { Pose::default() } else { pose(Point3::origin(), draw) };
            let there = own.at(&turned, grid);
            let part = there.part();
            let (tool, truth) = (subject.tool, &*subject.truth);
            let asked = Asked { tool, truth, given: &there, part: &part };
            let first = asked.at(&turned, ledger);
            for order in permutations(count, orders, draw) {
                let part = reordered(&there, &order);
                let mut probe = Probe::new(&part, tool);
                let again = (probe.contacts(&turned).to_vec(), probe.wrench(&turned));
                compare(&first, &again, &turned, ledger);
            }
        }
    }
}

/// Returns all orders of up to three items. For more items, returns `most` orders, the reverse among them.
fn permutations(count: usize, most: usize, draw: &mut Rng) -> Vec<Vec<usize>> {
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
    let mut all = vec![(0..count).rev().collect::<Vec<_>>()];
    while all.len() < most {
        let mut order: Vec<usize> = (0..count).collect();
        for k in (1..count).rev() {
            order.swap(k, draw.bits() as usize % (k + 1));
        }
        all.push(order);
    }
    all
}

/// Builds the part of the points in another order. A point's original index is its triangle id.
fn reordered(given: &Given, order: &[usize]) -> Part {
    let pick = |k: &usize| (given.points[*k], given.normals[*k]);
    let (points, normals): (Vec<_>, Vec<_>) = order.iter().map(pick).unzip();
    let ids = order.iter().map(|k| *k as u32).collect();
    let weights = order.iter().map(|k| given.weights[*k]).collect();
    let cloud = touchoff::Cloud::new(points, normals, ids, weights, given.unit);
    Part::from_cloud(&cloud.expect("the same points"))
}

/// Returns all numbers of each contact as text, sorted by triangle.
pub(super) fn told(contacts: &[Contact]) -> Vec<(u32, String)> {
    let mut list: Vec<_> = contacts.iter().map(|c| (c.triangle.0, format!("{c:?}"))).collect();
    list.sort();
    list
}

/// Returns the rounding bounds of force and torque sums over the contacts.
pub(super) fn rounding(contacts: &[Contact], pose: &Pose) -> [f64; 2] {
    let part = f64::EPSILON * (16.0 + contacts.len() as f64 / 4.0);
    let push = |c: &Contact| 2.0 * c.weight * c.magnitude;
    let force: f64 = contacts.iter().map(push).sum();
    let lever = |c: &Contact| push(c) * (c.point - pose.tip()).norm();
    [part * force, part * contacts.iter().map(lever).sum::<f64>()]
}

fn compare(
    (contacts, wrench): &(Vec<Contact>, Wrench),
    (others, other): &(Vec<Contact>, Wrench),
    pose: &Pose,
    ledger: &mut Ledger,
) {
    ledger.count(SAME, told(contacts) != told(others), || shown(pose));
    let [force, torque] = rounding(contacts, pose);
    let part = |off: Vector3<f64>, bound: f64| {
        if off == Vector3::zeros() { 0.0 } else { off.norm() / (2.0 * bound) }
    };
    ledger.see(SUMS, part(wrench.force - other.force, force), || shown(pose));
    ledger.see(SUMS, part(wrench.torque - other.torque, torque), || shown(pose));
}
