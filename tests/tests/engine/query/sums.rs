//! The rounding that a wrench states, against sums of the same contacts with 256 bits.

use super::compare::{LAWS_AND_WEIGHTS, tools};
use super::parts;
use crate::prelude::*;
use touchoff::Contact;
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::space::{Triple, distance, exactly};
use touchoff_tests::oracle::vector::{add, sub, vector_product};

/// Returns force and torque about a centre, the sum of weights times magnitudes, and that times the arm.
fn sums(contacts: &[Contact], law: Law, centre: Point3<f64>) -> ([Triple; 2], [f64; 2]) {
    let mut sums = [(); 2].map(|()| exactly([0.0; 3]));
    let mut sizes = [0.0; 2];
    for contact in contacts {
        let direction = match law {
            Law::Gradient => exactly(contact.gradient),
            Law::Facing if contact.normal.dot(&contact.direction) > 0.0 => continue,
            _ => sub(&exactly(contact.normal), &exactly(contact.direction)),
        };
        let force_magnitude = &Big::exactly(contact.weight) * &Big::exactly(contact.magnitude);
        let arm = contact.point - centre;
        let moment = vector_product(&exactly(arm), &direction);
        sums =
            [add(&sums[0], &direction, &force_magnitude), add(&sums[1], &moment, &force_magnitude)];
        let size = force_magnitude.to_f64() * contact.gradient.norm().max(1.0);
        sizes[0] += size;
        sizes[1] += size * (arm.norm() + contact.point.coords.norm());
    }
    (sums, sizes)
}

#[test]
fn sums_keep_the_stated_rounding_bound() {
    // Rounding in the list of contacts itself: directions turned to the world and rounded, weights multiplied and
    // rounded, points rounded at the world's coordinates.
    const LISTED_BOUND: f64 = 16.0 * f64::EPSILON;
    let (mut touching, mut tightest) = (0, f64::INFINITY);
    for part in [parts::soup(6.0, 2_000, 1), parts::tube(6_000)] {
        for (tool, oracle) in tools() {
            let mut rng = Rng::new(17);
            for k in 0..60 {
                let pose: Pose = parts::about(&part, &*oracle, k, &mut rng);
                let (law, weights) = LAWS_AND_WEIGHTS[k % 6];
                let centre = [Point3::origin(), Point3::new(300.0, -200.0, 1000.0)][k / 6 % 2];
                let probe = Probe::new(&part, tool).with_law(law).with_weights(weights);
                let mut probe = probe.with_centre(centre);
                let wrench = probe.wrench(&pose);
                let about = pose.tip() + pose.rotation() * centre.coords;
                let ([force, torque], sizes) = sums(probe.contacts(&pose), law, about);
                if wrench.colliding == 0 {
                    continue;
                }
                touching += 1;
                let stated = wrench.rounding;
                let [by_force, by_torque] =
                    [distance(&force, wrench.force), distance(&torque, wrench.torque)];
                let [force, torque] = [stated.force, stated.torque];
                assert!(by_force <= force + LISTED_BOUND * sizes[0], "{by_force:e} {stated:?}");
                assert!(by_torque <= torque + LISTED_BOUND * sizes[1], "{by_torque:e} {stated:?}");
                // Some hundred units of roundoff, not more.
                let all = sizes[0] + wrench.integral;
                assert!(stated.force <= 1e-13 * all * (1.0 + wrench.colliding as f64 / 100.0));
                tightest = tightest.min(stated.force / by_force);
            }
        }
    }
    println!("{touching} contacts; the least that stands over what is lost: {tightest:.1} times");
    assert!(touching > 200);
}
