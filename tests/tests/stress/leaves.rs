//! Item 11: trees of few points. A leaf has 16 points by design, so there are 1, 2, 3 and about 16 and 256 points. Every
//! order of up to three points, and some of more, give the same contacts to the last bit, and those agree with 256 bits.

use crate::prelude::*;
use crate::scene::{Answers, in_sum_roundings};
use touchoff::Contact;

const GRID: f64 = 1.0 / 1024.0;

#[test]
fn the_order_of_points_does_not_matter() {
    check_tools(11, |subject, rng, checks| {
        for count in [1, 2, 3, 15, 16, 17, 255, 256, 257] {
            let points = PointSet::near_tool(subject, count, GRID, rng);
            for k in 0..extent(1, 2) {
                let pose =
                    if k == 0 { Pose::default() } else { random_pose(Point3::origin(), rng) };
                let mut scene = Scene::new(subject, points.transformed(&pose, GRID), pose);
                let first = scene.check(checks);
                for order in orders(count, rng) {
                    scene.part = scene.points.part_of(order.into_iter());
                    let Answers { contacts, wrench } = scene.query();
                    let place = || format!("{count} points, {}", format_pose(&pose));
                    let differ = by_triangle(&contacts) != by_triangle(&first.contacts);
                    checks.never("another order: other contacts", differ, place);
                    // Sums are taken in the tree's order, which within a leaf is that of the cloud.
                    let differences =
                        [wrench.force - first.wrench.force, wrench.torque - first.wrench.torque];
                    for ratio in in_sum_roundings(&first.contacts, pose.tip(), differences) {
                        let name = "another order: force and torque [roundings of the sums]";
                        checks.within(name, ratio, 2.0, place);
                    }
                }
            }
        }
    });
}

/// Returns all orders of up to three items; of more, the reverse and some at random.
fn orders(count: usize, rng: &mut Rng) -> Vec<Vec<usize>> {
    if count <= 3 {
        let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
        // Those of fewer items are the ones that leave the last items in place.
        let orders = orders.into_iter().filter(|order| order[count..] == [0, 1, 2][count..]);
        return orders.map(|order| order[..count].to_vec()).collect();
    }
    let mut orders = vec![(0..count).rev().collect::<Vec<_>>()];
    while orders.len() < extent(2, 8) {
        let mut order: Vec<usize> = (0..count).collect();
        for k in (1..count).rev() {
            order.swap(k, rng.index(k + 1));
        }
        orders.push(order);
    }
    orders
}

/// Returns all numbers of each contact as text, sorted by triangle.
pub(crate) fn by_triangle(contacts: &[Contact]) -> Vec<(u32, String)> {
    let mut lines: Vec<_> = contacts.iter().map(|c| (c.triangle.0, format!("{c:?}"))).collect();
    lines.sort();
    lines
}
