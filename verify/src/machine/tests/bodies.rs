//! The motion of any body of a machine relative to any other one, against the 256-bit chain and against dense samples of the second
//! implementation.

use super::exact::{Affine, FileMachine};
use super::forward::errors;
use super::motion::{SAMPLES, displacement, machines, rotation};
use super::sampled::Sampled;
use super::{Random, cases, texts};
use crate::machine::{JointError, JointMotion, Letter, Link, Machine, Mover, Reference, Relation};
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use touchoff::Pose;

/// Returns any link of a machine.
fn link(random: &mut Random, machine: &Machine) -> Link {
    match random.below(machine.axes().len() + 1) {
        0 => Link::Base,
        index => Link::Axis(machine.axes()[index - 1].letter),
    }
}

/// Returns a pose near the machine's origin; every third is not turned.
fn mount(random: &mut Random) -> Pose {
    let tip = Point3::from([0; 3].map(|_| 300.0 * random.unit()));
    let axis = Vector3::from([0; 3].map(|_| random.unit())).normalize();
    match random.below(3) {
        0 => Pose::from_axis(tip, Vector3::z()),
        1 => Pose::from_axis(tip, random.pick(&[Vector3::x(), -Vector3::y(), -Vector3::z()])),
        _ => Pose::from_axis(tip, axis),
    }
    .expect("a unit vector")
}

/// Returns anything that moves, and the frame to which it does.
fn bodies(random: &mut Random, machine: &Machine) -> (Mover, Reference) {
    let mover = match random.below(4) {
        0 => Mover::Tool,
        _ => Mover::Body { link: link(random, machine), mount: mount(random) },
    };
    let reference = match random.below(4) {
        0 => Reference::Workpiece,
        _ => Reference::Link(link(random, machine)),
    };
    (mover, reference)
}

/// Poses at rest, which a joint motion of no length has, are within the bounds of rounding.
#[test]
fn poses_of_bodies_are_within_their_rounding_bounds() {
    let mut random = Random::new(21);
    let machines: Vec<_> = texts()
        .into_iter()
        .map(|text| (Machine::parse(text, "test").expect("a machine"), FileMachine::parse(text)))
        .collect();
    let mut greatest = [0.0f64; 2];
    let count = cases("JOINTS", 10_000);
    for case in 0..count {
        let (machine, file) = &machines[case % machines.len()];
        let (mover, reference) = bodies(&mut random, machine);
        let setup = random.setup(machine);
        let joints = random.joints(machine, 500.0);
        let workpiece = machine.chain(&setup).expect("a setup");
        let relation = Relation::new(machine, mover, reference).expect("links of the machine");
        let chain = relation.of(&workpiece);
        let motions = file.motions(&joints);
        let index = |link: Link| match link {
            Link::Base => None,
            Link::Axis(letter) => machine.axes().iter().position(|axis| axis.letter == letter),
        };
        let place = |link: Link| file.place(&motions, index(link));
        let [table, spindle] = [crate::machine::Side::Table, crate::machine::Side::Tool]
            .map(|side| machine.axes().iter().rfind(|axis| axis.side == side))
            .map(|axis| axis.map_or(Link::Base, |axis| Link::Axis(axis.letter)));
        let body = match mover {
            Mover::Tool => {
                place(spindle).then(&Affine::translation([0.0, 0.0, -setup.tool_length]))
            }
            Mover::Body { link, mount } => place(link).then(&Affine::of_pose(&mount)),
        };
        let exact = match reference {
            Reference::Workpiece => {
                place(table).then(&file.workpiece(&setup.work_offset)).inverse().then(&body)
            }
            Reference::Link(link) => place(link).inverse().then(&body),
        };
        let pose = chain.pose(&joints).expect("a pose");
        let bound = chain.rounding(&joints);
        for (at, (error, bound)) in
            errors(&pose, &exact).into_iter().zip([bound.tip, bound.rotation]).enumerate()
        {
            let name = machine.name();
            assert!(
                error <= bound,
                "{name}: {mover:?} {reference:?} {joints:?}: {error:e} > {bound:e}"
            );
            greatest[at] = greatest[at].max(error / bound);
        }
    }
    println!(
        "{count} poses: greatest error of the tip {:.3} of its bound, of the rotation {:.3}",
        greatest[0], greatest[1]
    );
}

/// Returns the pose of a body relative to a frame by the second implementation.
fn expected(sampled: &Sampled, t: f64, mover: Mover, reference: Reference) -> Isometry3<f64> {
    let body = match mover {
        Mover::Tool => {
            let spindle = sampled.machine.last_link(crate::machine::Side::Tool);
            sampled.place(t, spindle) * Isometry3::translation(0.0, 0.0, -sampled.setup.tool_length)
        }
        Mover::Body { link, mount } => {
            let turn = nalgebra::Rotation3::from_matrix_unchecked(*mount.rotation());
            let mounted = Isometry3::from_parts(
                mount.tip().into(),
                UnitQuaternion::from_rotation_matrix(&turn),
            );
            sampled.place(t, link) * mounted
        }
    };
    match reference {
        Reference::Workpiece => sampled.part(t).inverse() * body,
        Reference::Link(link) => sampled.place(t, link).inverse() * body,
    }
}

/// The poses of any body relative to any other one, the bound on their deviation, and that on their speed hold on random motions.
/// Prints how much wider than needed the bound on the deviation is.
#[test]
fn deviations_between_bodies_are_within_their_bounds() {
    let mut random = Random::new(22);
    let machines = machines();
    let mut ratios = Vec::new();
    let mut moving = 0;
    let count = cases("MOTIONS", 40_000);
    for case in 0..count {
        let sampled = random.motion(&machines[case % machines.len()]);
        let (mover, reference) = bodies(&mut random, &sampled.machine);
        let relation = Relation::new(&sampled.machine, mover, reference).expect("links");
        let motion = sampled.motion().between(&relation);
        let width = random.pick(&[1.0, 0.3, 0.1, 1e-2]);
        let t0 = 0.5 * (1.0 - width) * (1.0 + random.unit());
        let t1 = t0 + width;
        let reach = random.pick(&[0.0, 1.0, 50.0, 300.0]);
        let spin = case % 2 == 0;
        let deviation = match spin {
            true => JointMotion::deviation_with_spin,
            false => JointMotion::deviation,
        };
        let approximation =
            if spin { motion.motion_with_spin(t0, t1) } else { motion.motion(t0, t1) };
        let bound = deviation(&motion, t0, t1, reach);
        let at = |fraction: f64| expected(&sampled, t0 + fraction * (t1 - t0), mover, reference);
        let (pose, truth) = (motion.pose(t1), at(1.0));
        let tip = (pose.tip() - Point3::from(truth.translation.vector)).norm();
        let twist = (pose.rotation() - rotation(&truth)).norm();
        assert!(tip < 2e-10 && twist < 1e-12, "{sampled:?} {mover:?} {reference:?}: {tip:e}");
        let max_speed = motion.max_speed(reach);
        let point = |pose: &Isometry3<f64>| pose * Point3::new(0.0, 0.6 * reach, 0.8 * reach);
        let mut before = at(0.0);
        for k in 1..=SAMPLES {
            let now = at(k as f64 / SAMPLES as f64);
            let travel = (point(&now) - point(&before)).norm();
            let longest = max_speed * (t1 - t0) / SAMPLES as f64;
            assert!(
                travel <= longest + 1e-9,
                "{sampled:?} {mover:?} {reference:?}: {travel:e} > {longest:e}"
            );
            before = now;
        }
        // An ambiguous motion needs no bound.
        let Ok(approximation) = approximation else { continue };
        let actual = (1..SAMPLES)
            .map(|k| {
                let fraction = k as f64 / SAMPLES as f64;
                displacement(&at(fraction), &approximation, fraction, reach, spin)
            })
            .fold(0.0, f64::max);
        // The second implementation errs, too, and so do the poses of the approximating motion.
        let slack = 2e-10 + 1e-13 * reach;
        assert!(
            actual <= bound + slack,
            "{sampled:?} {mover:?} {reference:?} {t0} {t1} {reach} {spin}: {actual:e} > {bound:e}"
        );
        if actual > 1e-6 {
            ratios.push(bound / actual);
        }
        moving += usize::from(max_speed > 1e-3);
    }
    ratios.sort_by(f64::total_cmp);
    let [median, most] = [0.5, 0.9].map(|part| ratios[((ratios.len() - 1) as f64 * part) as usize]);
    println!(
        "{count} motions, {moving} of bodies that move: bound / deviation: least {:.4}, median {median:.3}, 90 % {most:.2}",
        ratios[0]
    );
    assert!(moving > count / 2 && median < 8.0, "{moving} {median}");
}

/// Bodies on one link never move against each other, and a machine has no links of axes that it lacks.
#[test]
fn bodies_of_one_link_rest() {
    let mut random = Random::new(23);
    for machine in machines() {
        for _ in 0..50 {
            let (link, mount) = (link(&mut random, &machine), mount(&mut random));
            let mover = Mover::Body { link, mount };
            let relation = Relation::new(&machine, mover, Reference::Link(link)).expect("a link");
            let motion = random.motion(&machine).motion().between(&relation);
            assert_eq!(motion.pose(0.3), motion.pose(0.9));
            assert_eq!(motion.pose(0.3).tip(), mount.tip());
            assert!(motion.max_speed(100.0) == 0.0);
        }
        for letter in Letter::ALL.into_iter().filter(|letter| machine.axis(*letter).is_none()) {
            let reference = Reference::Link(Link::Axis(letter));
            let refused = Relation::new(&machine, Mover::Tool, reference).expect_err("no axis");
            assert_eq!(refused, JointError::NoCarrier { letter });
        }
    }
}
