//! Items 6 and 14: equivalent scenes. The whole is rotated or translated; the part is mirrored; the tool is spun; two
//! clouds are merged, whose contacts come together and whose forces add; the scene is given in mm, inch and m, and
//! converted by `Part::converted_to`. What loses no bit has the same bits, otherwise depths differ by no more than both
//! clouds' `Probe::rounding_error_bound` and the rounding of coordinates.

use crate::leaves::by_triangle;
use crate::prelude::*;
use crate::scene::{compare_depths, in_sum_roundings, with_tip};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion};
use std::f64::consts::TAU;
use touchoff::{Contact, Unit};

/// Spacing of the coordinates' grid. Near the tool, its multiples are stored without rounding in any tree, and sums with
/// 2^40 are exact.
const GRID: f64 = 1.0 / 1024.0;

const MIRRORED: &str = "mirrored: other bits";

#[test]
fn equivalent_scenes_have_equal_contacts() {
    check_tools(14, |subject, rng, checks| {
        for _ in 0..extent(1, 8) {
            let points = PointSet::near_tool(subject, extent(12, 200), GRID, rng);
            let pose = random_pose(Point3::new(0.5, -0.25, 1.0), rng);
            let placed = Scene::new(subject, points.transformed(&pose, GRID), pose);
            let upright = Scene::new(subject, points, Pose::default());
            rotate(&placed, rng, checks);
            translate(&placed, rng, checks);
            mirror(&upright, checks);
            if subject.oracle.is_revolved() {
                spin(upright, rng, checks);
            }
            merge(&placed, rng, checks);
            convert_units(&placed, checks);
        }
    });
}

/// Returns the allowed difference of depths between two scenes: both error bounds, and the rounding of coordinates of
/// twice the tool's size.
fn bound(a: &Scene<'_>, b: &Scene<'_>) -> f64 {
    let lipschitz = a.subject.tool.info().depth.lipschitz.expect("proved of every tool");
    let rounding = lipschitz * 8.0 * f64::EPSILON * (2.0 * a.subject.scale());
    a.error_bound() + b.error_bound() + rounding
}

/// Rotates part and tool together by a random rotation.
fn rotate(scene: &Scene<'_>, rng: &mut Rng, checks: &mut Checks) {
    let turn = *random_pose(Point3::origin(), rng).rotation();
    let rotate = |p: &Point3<f64>| Point3::from(turn * p.coords);
    let rotation = Rotation3::from_matrix_unchecked(turn * scene.pose.rotation());
    let q = UnitQuaternion::from(rotation).coords;
    let rotated_pose = pose(rotate(&scene.pose.tip()), [q.x, q.y, q.z, q.w]);
    let rotated = Scene::new(scene.subject, scene.points.map(rotate), rotated_pose);
    let contacts = [scene.query().contacts, rotated.check(checks).contacts];
    let place = || format!("rotated to {}", format_pose(&rotated_pose));
    compare_depths([&contacts[0], &contacts[1]], bound(scene, &rotated), place, checks);
}

/// Translates part and tool together: by powers of two, where no coordinate loses a bit, and by distances at which each
/// coordinate of a point and of the tip is rounded to half an ulp.
fn translate(scene: &Scene<'_>, rng: &mut Rng, checks: &mut Checks) {
    // All poses are made from one, since a rotation taken from a pose and given again is rounded.
    let translated = |points: &PointSet, offset: Vector3<f64>| {
        let pose = with_tip(&scene.pose, scene.pose.tip() + offset);
        Scene::new(scene.subject, points.map(|p| p + offset), pose)
    };
    // Enough for a tree of two levels.
    let many = PointSet::near_tool(scene.subject, 300, GRID, rng).transformed(&scene.pose, GRID);
    let expected = without_points(&translated(&many, Vector3::zeros()));
    for power in [10, 20, 30, 40] {
        let moved = translated(&many, 2f64.powi(power) * Vector3::new(1.0, -1.0, 0.5));
        let place = || format_pose(&moved.pose);
        checks.never("translated: other bits", without_points(&moved) != expected, place);
    }
    let subject = scene.subject;
    let lipschitz = subject.tool.info().depth.lipschitz.expect("proved of every tool");
    let original = translated(&scene.points, Vector3::zeros());
    for distance in [1e3, 1e6, 1e9, 1e12] {
        let offset = distance * Vector3::new(1.0, -0.7, 0.3);
        let moved = translated(&scene.points, offset);
        let contacts = [&original, &moved].map(|scene| scene.check(checks).contacts);
        let rounding = lipschitz * 3f64.sqrt() * f64::EPSILON * (offset.amax() + subject.scale());
        let bound = original.error_bound() + moved.error_bound() + rounding;
        let place = || format!("translated to {}", format_pose(&moved.pose));
        compare_depths([&contacts[0], &contacts[1]], bound, place, checks);
    }
}

/// Returns contacts and wrench without their points, as text of all numbers, so that different numbers give different
/// text.
fn without_points(scene: &Scene<'_>) -> String {
    let mut answers = scene.query();
    for contact in &mut answers.contacts {
        contact.point = Point3::origin();
    }
    if let Some(deepest) = &mut answers.wrench.deepest {
        deepest.point = Point3::origin();
    }
    format!("{:?} {:?}", answers.contacts, answers.wrench)
}

/// Returns the values of contacts that do not change with the frame, in a canonical order.
pub(crate) fn values(scene: &Scene<'_>, has_regions: bool) -> Vec<(u32, usize, [u64; 3])> {
    let value = |c: &Contact| {
        // Adding 0 makes -0 equal to 0.
        let numbers = [c.depth, c.magnitude, c.niceness].map(|v| (v + 0.0).to_bits());
        (c.triangle.0, if has_regions { c.region } else { 0 }, numbers)
    };
    let mut values: Vec<_> = scene.query().contacts.iter().map(value).collect();
    values.sort_unstable();
    values
}

/// Mirrors the part in y, a symmetry of all tools. For a tool of revolution, also mirrors it in x and in the diagonal.
fn mirror(scene: &Scene<'_>, checks: &mut Checks) {
    let mut mirrors = vec![Matrix3::new(1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0)];
    if scene.subject.oracle.is_revolved() {
        mirrors.push(Matrix3::new(-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0));
        mirrors.push(Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0));
    }
    // A mirror exchanges two sides of the block.
    let has_regions = scene.subject.name() != "Block";
    let expected = values(scene, has_regions);
    for mirror in mirrors {
        let points = scene.points.map(|p| Point3::from(mirror * p.coords));
        let mirrored = Scene::new(scene.subject, points, scene.pose);
        let place = || format!("by {:?}", mirror.as_slice());
        checks.never(MIRRORED, values(&mirrored, has_regions) != expected, place);
    }
}

/// Rotates the tool about its own axis and leaves the part fixed.
fn spin(mut scene: Scene<'_>, rng: &mut Rng, checks: &mut Checks) {
    let (expected, contacts) = (values(&scene, true), scene.query().contacts);
    let half_angle = rng.between(0.0, TAU) / 2.0;
    scene.pose = pose(Point3::origin(), [0.0, 0.0, half_angle.sin(), half_angle.cos()]);
    let place = || format!("spun to {}", format_pose(&scene.pose));
    let spun = scene.query().contacts;
    compare_depths([&contacts, &spun], bound(&scene, &scene), place, checks);
    // A half turn does not round.
    scene.pose = pose(Point3::origin(), [0.0, 0.0, 1.0, 0.0]);
    checks.never(MIRRORED, values(&scene, true) != expected, || "a half turn".to_owned());
}

/// Compares a part with two parts that have half of its points each.
fn merge(scene: &Scene<'_>, rng: &mut Rng, checks: &mut Checks) {
    let mut points = scene.points.clone();
    // Weights that every part stores exactly: multiples of 1/64, with the same maximum in both halves.
    for weight in &mut points.weights {
        *weight = (rng.between(0.1, 2.0) * 64.0).round() / 64.0;
    }
    let count = points.points.len();
    let half = count / 2;
    points.weights[0] = 2.0;
    points.weights[half] = 2.0;
    let [a, b, both] = [0..half, half..count, 0..count].map(|range| {
        let part = points.part_of(range);
        Scene { part, points: points.clone(), ..*scene }.query()
    });
    let place = || format_pose(&scene.pose);
    let differ = by_triangle(&[a.contacts, b.contacts].concat()) != by_triangle(&both.contacts);
    checks.never("merged: other contacts", differ, place);
    let [a, b] = [a.wrench, b.wrench];
    let differences =
        [a.force + b.force - both.wrench.force, a.torque + b.torque - both.wrench.torque];
    for ratio in in_sum_roundings(&both.contacts, scene.pose.tip(), differences) {
        checks.within("merged: force and torque [roundings of the sums]", ratio, 3.0, place);
    }
}

/// Compares the scene in millimetres, inches and metres, with the points given in that unit and with the part converted
/// to it.
fn convert_units(scene: &Scene<'_>, checks: &mut Checks) {
    let expected = scene.query().contacts;
    for unit in [Unit::Millimetre, Unit::Inch, Unit::Metre] {
        let factor = scene.points.unit.factor_to(unit);
        let convert = |p: &Point3<f64>| Point3::from(p.coords * factor);
        let points = PointSet { unit, ..scene.points.map(convert) };
        let converted_pose = with_tip(&scene.pose, convert(&scene.pose.tip()));
        let mut converted = Scene::new(scene.subject, points, converted_pose);
        converted.check(checks);
        converted.part = scene.part.clone().converted_to(unit);
        let mut contacts = converted.query().contacts;
        for contact in &mut contacts {
            contact.depth /= factor;
        }
        let place = || format!("in {}, {}", unit.symbol(), format_pose(&converted_pose));
        compare_depths([&expected, &contacts], bound(scene, scene), place, checks);
    }
}
