//! Points near a tool as a part, a pose of the tool, and the answers of a probe there against 256 bits.

use crate::prelude::*;
use crate::truth::ExactPoint;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use touchoff::{Cloud, Contact, Law, Part, Probe, TriangleId, Unit, Wrench};
use touchoff_tests::oracle::displaced;
use touchoff_tests::oracle::space::{distance, exactly};
use touchoff_tests::oracle::vector::{add, dot, sub, vector_product};

const SENSELESS_NUMBER: &str = "senseless number";

/// Points, normals and weights in the world frame.
#[derive(Clone)]
pub(crate) struct PointSet {
    pub(crate) points: Vec<Point3<f64>>,
    pub(crate) normals: Vec<Vector3<f64>>,
    pub(crate) weights: Vec<f64>,
    pub(crate) unit: Unit,
}

impl PointSet {
    /// Returns random points near a tool's surface and splitting curves, in the tool's frame and unit. Every second
    /// point may be farther away than the others. Coordinates are multiples of `grid`; normals have any direction.
    pub(crate) fn near_tool(subject: &Subject, count: usize, grid: f64, rng: &mut Rng) -> PointSet {
        let curves = subject.oracle.curve_points();
        let reach = 0.2 * subject.oracle.extent()[0];
        let (mut points, mut normals, mut weights) = (Vec::new(), Vec::new(), Vec::new());
        for k in 0..count {
            let curve = &curves[rng.index(curves.len())];
            let origin = curve[rng.index(curve.len())];
            let step = rng.direction().map(|c| c * reach * if k % 2 == 0 { 0.05 } else { 1.0 });
            let p = displaced(&*subject.oracle, origin, step, rng.between(0.0, TAU));
            points.push(Point3::from(p.map(|c| (c / grid).round() * grid)));
            normals.push(Vector3::from(rng.direction()));
            weights.push(rng.between(0.1, 2.0));
        }
        PointSet { points, normals, weights, unit: subject.tool.info().unit }
    }

    /// Returns the same normals and weights at other points.
    pub(crate) fn map(&self, point: impl Fn(&Point3<f64>) -> Point3<f64>) -> PointSet {
        PointSet { points: self.points.iter().map(point).collect(), ..self.clone() }
    }

    /// Transforms the points by a pose and rounds them to the grid again.
    pub(crate) fn transformed(&self, pose: &Pose, grid: f64) -> PointSet {
        self.map(|p| (pose.tip() + pose.rotation() * p.coords).map(|c| (c / grid).round() * grid))
    }

    /// Builds the part of these points, in this order. The triangle of each point is its index.
    pub(crate) fn part_of(&self, indices: impl Iterator<Item = usize> + Clone) -> Part {
        let cloud = Cloud::new(
            indices.clone().map(|k| self.points[k]).collect(),
            indices.clone().map(|k| self.normals[k]).collect(),
            indices.clone().map(|k| TriangleId(k as u32)).collect(),
            indices.map(|k| self.weights[k]).collect(),
            self.unit,
        );
        Part::from_cloud(&cloud.expect("points that make a cloud"))
    }

    pub(crate) fn part(&self) -> Part {
        self.part_of(0..self.points.len())
    }
}

pub(crate) fn pose(tip: Point3<f64>, quaternion: [f64; 4]) -> Pose {
    Pose::from_quaternion(tip, quaternion).expect("a unit quaternion")
}

pub(crate) fn random_pose(tip: Point3<f64>, rng: &mut Rng) -> Pose {
    pose(tip, rng.quaternion())
}

pub(crate) fn with_tip(old: &Pose, tip: Point3<f64>) -> Pose {
    let q = old.to_isometry().rotation.coords;
    pose(tip, [q.x, q.y, q.z, q.w])
}

/// Formats a pose to the last bit: the tip, and the columns of the rotation.
pub(crate) fn format_pose(pose: &Pose) -> String {
    let (tip, axes) = (pose.tip(), pose.rotation());
    format!("tip {:?}, axes {:?}", tip.coords.as_slice(), axes.as_slice())
}

pub(crate) struct Scene<'a> {
    pub(crate) subject: &'a Subject,
    pub(crate) points: PointSet,
    pub(crate) part: Part,
    pub(crate) pose: Pose,
}

pub(crate) struct Answers {
    pub(crate) contacts: Vec<Contact>,
    pub(crate) wrench: Wrench,
}

impl<'a> Scene<'a> {
    pub(crate) fn new(subject: &'a Subject, points: PointSet, pose: Pose) -> Scene<'a> {
        Scene { subject, part: points.part(), points, pose }
    }

    /// Returns the answers of a probe, unchecked.
    pub(crate) fn query(&self) -> Answers {
        let mut probe = Probe::new(&self.part, self.subject.tool).with_law(Law::Thesis);
        Answers { contacts: probe.contacts(&self.pose).to_vec(), wrench: probe.wrench(&self.pose) }
    }

    pub(crate) fn error_bound(&self) -> f64 {
        let probe = Probe::new(&self.part, self.subject.tool);
        probe.rounding_error_bound().expect("how steep depth is was proved of every tool")
    }

    /// Queries a probe, compares its answers with each other and with 256 bits, and returns them.
    pub(crate) fn check(&self, checks: &mut Checks) -> Answers {
        // One probe for all queries, so that what it keeps of one meets the next.
        let mut probe = Probe::new(&self.part, self.subject.tool).with_law(Law::Thesis);
        let contacts = probe.contacts(&self.pose).to_vec();
        let wrench = probe.wrench(&self.pose);
        let deepest = contacts.iter().map(|c| c.depth).reduce(f64::max);
        let agree = probe.detect(&self.pose) != contacts.is_empty()
            && probe.deepest(&self.pose).map(|d| d.depth) == deepest
            && probe.posture(&self.pose).colliding == contacts.len()
            && wrench.colliding == contacts.len()
            && wrench.deepest.map(|d| d.depth) == deepest;
        checks.never("queries disagree", !agree, || format_pose(&self.pose));
        let answers = Answers { contacts, wrench };
        self.check_contacts(&answers.contacts, checks);
        self.check_sums(&answers, checks);
        answers
    }

    /// Checks which points are in contact, and their depths.
    fn check_contacts(&self, contacts: &[Contact], checks: &mut Checks) {
        let length = &millimetres(self.subject.tool.info().unit) / &millimetres(self.points.unit);
        let bound = self.error_bound();
        let mut contact_of: Vec<Option<&Contact>> = vec![None; self.points.points.len()];
        for contact in contacts {
            contact_of[contact.triangle.index()] = Some(contact);
        }
        for (p, contact) in self.points.points.iter().zip(contact_of) {
            let exact = &self.subject.truth.depth(&self.in_tool(p)) * &length;
            let depth = exact.to_f64();
            let place = || format!("{:?} of {}", [p.x, p.y, p.z], format_pose(&self.pose));
            let is_wrong = contact.is_some() != (depth >= 0.0) && depth.abs() > bound;
            checks.never("wrong contact", is_wrong, place);
            let Some(contact) = contact else { continue };
            let is_finite = contact.depth.is_finite()
                && contact.direction.iter().chain(&contact.gradient).all(|c| c.is_finite());
            checks.never(SENSELESS_NUMBER, !is_finite, place);
            if is_finite {
                // A point outside by less than the error bound may be a contact; its true depth is 0.
                let exact = if depth < 0.0 { Big::zero() } else { exact };
                let error = (&Big::exactly(contact.depth) - &exact).abs().to_f64();
                let name = "depth of contacts [Probe::rounding_error_bound]";
                checks.within(name, error / bound, 1.0, place);
            }
        }
    }

    /// Transforms a point to the tool's frame and unit.
    fn in_tool(&self, p: &Point3<f64>) -> ExactPoint {
        let (tip, rotation) = (self.pose.tip(), self.pose.rotation());
        let arm = sub(&exactly(*p), &exactly(tip));
        let length = &millimetres(self.points.unit) / &millimetres(self.subject.tool.info().unit);
        let axes = [0, 1, 2].map(|k| exactly(rotation.column(k).into_owned()));
        axes.map(|axis| &dot(&axis, &arm) * &length)
    }

    /// Compares force, torque and integral with the sums over the contacts.
    fn check_sums(&self, Answers { contacts, wrench }: &Answers, checks: &mut Checks) {
        let place = || format_pose(&self.pose);
        let is_finite = wrench.force.iter().chain(&wrench.torque).all(|c| c.is_finite())
            && wrench.integral.is_finite()
            && wrench.energy.is_finite();
        checks.never(SENSELESS_NUMBER, !is_finite, place);
        if !is_finite {
            return;
        }
        let zero = exactly([0.0; 3]);
        let (mut force, mut torque, mut integral) = (zero.clone(), zero, Big::zero());
        let (mut force_bound, mut torque_bound) = (0.0, 0.0);
        let tip = self.pose.tip();
        for contact in contacts {
            let magnitude = &Big::exactly(contact.weight) * &Big::exactly(contact.magnitude);
            let push = sub(&exactly(contact.normal), &exactly(contact.direction));
            let arm = sub(&exactly(contact.point), &exactly(tip));
            torque = add(&torque, &vector_product(&arm, &push), &magnitude);
            force = add(&force, &push, &magnitude);
            integral = &integral + &magnitude;
            let max_push = 2.0 * magnitude.to_f64();
            force_bound += max_push;
            // The point of a contact is rounded in world coordinates.
            let max_coordinate = contact.point.coords.amax().max(tip.coords.amax());
            torque_bound += max_push * ((contact.point - tip).norm() + max_coordinate);
        }
        let rounding = sum_rounding(contacts.len());
        let integral_error = (&Big::exactly(wrench.integral) - &integral).abs().to_f64();
        for (error, bound) in [
            (distance(&force, wrench.force), force_bound),
            (distance(&torque, wrench.torque), torque_bound),
            (integral_error, force_bound),
        ] {
            let ratio = if error == 0.0 { 0.0 } else { error / (rounding * bound + 1e-320) };
            checks.within("force and torque [rounding of the sums]", ratio, 1.0, place);
        }
    }
}

/// Returns the rounding of a sum over so many contacts, relative to the sum of the absolute values.
fn sum_rounding(contacts: usize) -> f64 {
    f64::EPSILON * (16.0 + contacts as f64 / 4.0)
}

/// Returns differences of force and torque as multiples of the rounding of their sums over the contacts.
pub(crate) fn in_sum_roundings(
    contacts: &[Contact],
    tip: Point3<f64>,
    [force, torque]: [Vector3<f64>; 2],
) -> [f64; 2] {
    let push = |c: &Contact| 2.0 * c.weight * c.magnitude;
    let force_sum: f64 = contacts.iter().map(push).sum();
    let torque_sum: f64 = contacts.iter().map(|c| push(c) * (c.point - tip).norm()).sum();
    [(force, force_sum), (torque, torque_sum)].map(|(difference, sum)| {
        let rounding = sum_rounding(contacts.len()) * sum;
        if difference == Vector3::zeros() { 0.0 } else { difference.norm() / rounding }
    })
}

/// Checks that the contacts of two equivalent scenes agree to `bound`. A contact's triangle is the index of its point.
pub(crate) fn compare_depths(
    contacts: [&[Contact]; 2],
    bound: f64,
    place: impl Fn() -> String,
    checks: &mut Checks,
) {
    let [a, b] = contacts
        .map(|contacts| contacts.iter().map(|c| (c.triangle, c.depth)).collect::<BTreeMap<_, _>>());
    let triangles = a.keys().chain(b.keys().filter(|triangle| !a.contains_key(triangle)));
    for triangle in triangles {
        let place = || format!("point {triangle}, {}", place());
        match (a.get(triangle), b.get(triangle)) {
            (Some(a), Some(b)) => {
                let name = "depth in both scenes [both errors and rounding]";
                checks.within(name, (a - b).abs() / bound, 1.0, place);
            }
            (only_a, only_b) => {
                let depth = only_a.or(only_b).expect("it is a key of one of them");
                checks.never("contact in one scene only", *depth > bound, place);
            }
        }
    }
}

fn millimetres(unit: Unit) -> Big {
    Big::decimal(unit.millimetres())
}
