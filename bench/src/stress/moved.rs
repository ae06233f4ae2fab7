//! Item 6: part and pose translated together, by 1e3 to 1e12.

use super::ledger::{Kind, Ledger};
use super::scene::{Asked, Given, apart, shown};
use super::truth::Subject;
use nalgebra::{Point3, Vector3};
use touchoff::{Contact, Pose, Probe};
use touchoff_tests::oracle::draw::Rng;

/// If no coordinate loses a bit, all evaluations must have the same bits.
const SAME: Kind = Kind::never("moved without a loss: other bits");
/// Spacing of the coordinates' grid, so that sums with 2^40 are exact.
const GRID: f64 = 1.0 / 1024.0;

/// Translates a scene.
pub(super) fn moved(
    subject: &Subject,
    (count, poses): (usize, usize),
    draw: &mut Rng,
    ledger: &mut Ledger,
) {
    let own = Given::about(subject, count, GRID, draw);
    for _ in 0..poses {
        let turned = pose(Point3::origin(), draw);
        let here = own.at(&turned, GRID);
        let tip = Point3::origin();
        for power in [10, 20, 30, 40] {
            let by = 2f64.powi(power) * Vector3::new(1.0, -1.0, 0.5);
            exactly(subject, (&here, &turned), by, tip, ledger);
        }
        for far in [1e3, 1e6, 1e9, 1e12] {
            let by = far * Vector3::new(1.0, -0.7, 0.3);
            anywhere(subject, (&here, &turned), by, ledger);
        }
    }
}

/// Returns a pose with a random orientation.
pub(super) fn pose(tip: Point3<f64>, draw: &mut Rng) -> Pose {
    loop {
        let q = [0; 4].map(|_| draw.between(-1.0, 1.0));
        let norm = q.iter().map(|c| c * c).sum::<f64>().sqrt();
        if (0.1..=1.0).contains(&norm) {
            return Pose::from_quaternion(tip, q.map(|c| c / norm)).expect("a unit quaternion");
        }
    }
}

/// Returns the pose with another tip.
fn put(pose: &Pose, tip: Point3<f64>) -> Pose {
    let q = pose.to_isometry().rotation.coords;
    Pose::from_quaternion(tip, [q.x, q.y, q.z, q.w]).expect("a unit quaternion")
}

/// Returns contacts without their points, as text of all numbers, so that different numbers give different text.
fn evaluation(contacts: &[Contact]) -> Vec<String> {
    let told = |c: &Contact| {
        format!(
            "{} {} {:?} {:?} {:?} {:?}",
            c.triangle, c.region, c.depth, c.magnitude, c.direction, c.gradient
        )
    };
    contacts.iter().map(told).collect()
}

fn exactly(
    subject: &Subject,
    (here, turned): (&Given, &Pose),
    by: Vector3<f64>,
    tip: Point3<f64>,
    ledger: &mut Ledger,
) {
    let (a, b) = (put(turned, tip), put(turned, tip + by));
    let parts = [here.part(), here.moved(by).part()];
    let mut probes = parts.each_ref().map(|part| Probe::new(part, subject.tool));
    let contacts = [(0, &a), (1, &b)].map(|(k, pose)| evaluation(probes[k].contacts(pose)));
    let wrenches = [(0, &a), (1, &b)].map(|(k, pose)| {
        let mut wrench = probes[k].wrench(pose);
        if let Some(deepest) = &mut wrench.deepest {
            deepest.point = Point3::origin(); // it is elsewhere
        }
        format!("{wrench:?}")
    });
    let unlike = contacts[0] != contacts[1] || wrenches[0] != wrenches[1];
    ledger.count(SAME, unlike, || shown(&b));
}

fn anywhere(
    subject: &Subject,
    (here, turned): (&Given, &Pose),
    by: Vector3<f64>,
    ledger: &mut Ledger,
) {
    let (a, b) = (put(turned, Point3::origin()), put(turned, Point3::origin() + by));
    let there = here.moved(by);
    let parts = [here.part(), there.part()];
    let [near, far] = parts.each_ref();
    let (tool, truth) = (subject.tool, &*subject.truth);
    let (found, _) = Asked { tool, truth, given: here, part: near }.at(&a, ledger);
    let (moved, _) = Asked { tool, truth, given: &there, part: far }.at(&b, ledger);
    let steep = tool.info().depth.lipschitz.expect("proved of every tool");
    let errors: f64 = parts
        .each_ref()
        .map(|part| Probe::new(part, tool).rounding_error_bound().expect("proved of every tool"))
        .iter()
        .sum();
    // Each coordinate of the point and of the tip is rounded to half an ulp at its position.
    let rounding = steep * 3f64.sqrt() * f64::EPSILON * (by.amax() + subject.scale());
    let bound = errors + rounding;
    let place = || format!("moved by {:?}, {}", by.as_slice(), shown(&a));
    apart([&found, &moved], here.points.len(), bound, place, ledger);
}
