//! A few points near a tool, given as a part, and validation of a probe's answers against 256 bits.

use super::ledger::{Kind, Ledger};
use super::truth::{ExactPoint, Subject, Truth};
use nalgebra::{Point3, Vector3};
use touchoff::TriangleId;
use touchoff::{Cloud, Contact, Part, Pose, Probe, Tool, Unit, Wrench};
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::rng::Rng;

/// Error of a contact's depth relative to the true depth of the given point.
pub(super) const DEPTH_ERROR: Kind =
    Kind::with_limit("depth of contacts", "Probe::rounding_error_bound", 1.0);
/// Points beyond doubt inside without a contact, or beyond doubt outside with one.
pub(super) const WRONG_CONTACT: Kind = Kind::forbidden_event("wrong contact");
/// Error of force and torque relative to the sums over the contacts in 256 bits.
pub(super) const SUM_ERROR: Kind =
    Kind::with_limit("force and torque", "rounding of the sums", 1.0);
/// Contradictions between the answers of different queries.
pub(super) const INCONSISTENT_QUERIES: Kind = Kind::forbidden_event("questions disagree");
/// Numbers that are not finite.
pub(super) const NOT_FINITE: Kind = Kind::forbidden_event("senseless number");

/// Difference of a depth between two equivalent scenes, which comes from the rounding of both clouds and of the
/// coordinates.
const DEPTH_DIFFERENCE: Kind =
    Kind::with_limit("depth in both scenes", "both errors and rounding", 1.0);
const UNMATCHED_CONTACT: Kind = Kind::forbidden_event("contact in one scene only");

/// Checks that the contacts of two equivalent scenes agree to `bound`. A contact's triangle is the index of its point.
pub(super) fn compare_depths(
    [a, b]: [&[Contact]; 2],
    count: usize,
    bound: f64,
    location: impl Fn() -> String,
    ledger: &mut Ledger,
) {
    let depths = |contacts: &[Contact]| {
        let mut depths = vec![None; count];
        for contact in contacts {
            depths[contact.triangle.index()] = Some(contact.depth);
        }
        depths
    };
    for (k, pair) in depths(a).into_iter().zip(depths(b)).enumerate() {
        let location = || format!("point {k}, {}", location());
        match pair {
            (Some(a), Some(b)) => ledger.record(DEPTH_DIFFERENCE, (a - b).abs() / bound, location),
            (Some(depth), None) | (None, Some(depth)) => {
                ledger.count(UNMATCHED_CONTACT, depth > bound, location);
            }
            (None, None) => {}
        }
    }
}

/// Points, normals and weights in the world frame.
#[derive(Clone)]
pub(super) struct PointSet {
    pub(super) points: Vec<Point3<f64>>,
    pub(super) normals: Vec<Vector3<f64>>,
    pub(super) weights: Vec<f64>,
    pub(super) unit: Unit,
}

impl PointSet {
    /// Builds the part. The triangle of each point is its index.
    pub(super) fn part(&self) -> Part {
        let ids = (0..self.points.len() as u32).map(TriangleId).collect();
        let (points, normals) = (self.points.clone(), self.normals.clone());
        let cloud = Cloud::new(points, normals, ids, self.weights.clone(), self.unit);
        Part::from_cloud(&cloud.expect("points that make a cloud"))
    }

    /// Returns random points near a tool's surface and splitting curves, in the tool's frame and unit. Every second
    /// point may be farther away than the others. Coordinates are multiples of `grid`; normals have any direction.
    pub(super) fn near_tool(subject: &Subject, count: usize, grid: f64, rng: &mut Rng) -> PointSet {
        let curves = subject.oracle.curve_points();
        let reach = 0.2 * subject.oracle.extent()[0];
        let mut point_set = PointSet {
            points: Vec::new(),
            normals: Vec::new(),
            weights: Vec::new(),
            unit: subject.tool.info().unit,
        };
        for k in 0..count {
            let curve = &curves[rng.bits() as usize % curves.len()];
            let origin = curve[rng.bits() as usize % curve.len()];
            let step = rng.direction().map(|c| c * reach * if k % 2 == 0 { 0.05 } else { 1.0 });
            let angle = rng.between(0.0, std::f64::consts::TAU);
            let p = touchoff_tests::oracle::displaced(&*subject.oracle, origin, step, angle);
            point_set.points.push(Point3::from(p.map(|c| (c / grid).round() * grid)));
            point_set.normals.push(Vector3::from(rng.direction()));
            point_set.weights.push(rng.between(0.1, 2.0));
        }
        point_set
    }

    /// Transforms the points by a pose and rounds them to the grid again.
    pub(super) fn transformed(&self, pose: &Pose, grid: f64) -> PointSet {
        let transform = |p: &Point3<f64>| {
            let p = pose.tip() + pose.rotation() * p.coords;
            p.map(|c| (c / grid).round() * grid)
        };
        PointSet { points: self.points.iter().map(transform).collect(), ..self.clone() }
    }

    /// Translates the points.
    pub(super) fn translated(&self, offset: Vector3<f64>) -> PointSet {
        PointSet { points: self.points.iter().map(|p| p + offset).collect(), ..self.clone() }
    }
}

/// Formats a pose to the last bit.
pub(super) fn format_pose(pose: &Pose) -> String {
    let (tip, r) = (pose.tip(), pose.rotation());
    let list = |v: &[f64]| format!("{v:?}");
    format!("tip {}, axes {}", list(tip.coords.as_slice()), list(r.as_slice()))
}

fn to_big(v: &Vector3<f64>) -> ExactPoint {
    [v.x, v.y, v.z].map(Big::exactly)
}

fn add(a: &ExactPoint, b: &ExactPoint) -> ExactPoint {
    std::array::from_fn(|k| &a[k] + &b[k])
}

fn scale(a: &ExactPoint, factor: &Big) -> ExactPoint {
    std::array::from_fn(|k| &a[k] * factor)
}

fn cross(a: &ExactPoint, b: &ExactPoint) -> ExactPoint {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        &(&a[i] * &b[j]) - &(&a[j] * &b[i])
    })
}

/// Returns the distance between a vector of doubles and one of 256 bits.
fn distance(a: &Vector3<f64>, b: &ExactPoint) -> f64 {
    let sum_of_squares =
        to_big(a).iter().zip(b).map(|(a, b)| (a - b).to_f64().powi(2)).sum::<f64>();
    sum_of_squares.sqrt()
}

/// Transforms a point to the tool's frame and unit.
pub(super) fn in_tool(p: &Point3<f64>, pose: &Pose, [tool, part]: [Unit; 2]) -> ExactPoint {
    let offset: ExactPoint =
        std::array::from_fn(|k| &Big::exactly(p[k]) - &Big::exactly(pose.tip()[k]));
    let millimetres = |unit: Unit| Big::decimal(unit.millimetres());
    let factor = &millimetres(part) / &millimetres(tool);
    std::array::from_fn(|k| {
        let terms = (0..3).map(|j| &Big::exactly(pose.rotation()[(j, k)]) * &offset[j]);
        &terms.fold(Big::zero(), |sum, term| &sum + &term) * &factor
    })
}

/// A tool and a part, with the true values for validation.
pub(super) struct ProbeCheck<'a> {
    pub(super) tool: &'a dyn Tool,
    pub(super) truth: &'a dyn Truth,
    pub(super) point_set: &'a PointSet,
    pub(super) part: &'a Part,
}

impl ProbeCheck<'_> {
    /// Queries at a pose, validates the answers, and returns contacts and wrench for further checks.
    pub(super) fn check(&self, pose: &Pose, ledger: &mut Ledger) -> (Vec<Contact>, Wrench) {
        let mut probe = Probe::new(self.part, self.tool);
        let contacts = probe.contacts(pose).to_vec();
        let wrench = probe.wrench(pose);
        let (has_contact, deepest) = (probe.detect(pose), probe.deepest(pose));
        let posture = probe.posture(pose);
        let max_depth =
            contacts.iter().map(|c| c.depth).fold(None, |max_depth: Option<f64>, depth| {
                Some(max_depth.map_or(depth, |max_depth| max_depth.max(depth)))
            });
        let is_consistent = has_contact != contacts.is_empty()
            && wrench.colliding == contacts.len()
            && posture.colliding == contacts.len()
            && deepest.map(|d| d.depth) == max_depth
            && wrench.deepest.map(|d| d.depth) == max_depth;
        ledger.count(INCONSISTENT_QUERIES, !is_consistent, || format_pose(pose));
        let error =
            probe.rounding_error_bound().expect("how steep depth is was proved of every tool");
        self.points(pose, &contacts, error, ledger);
        self.sums(pose, &contacts, &wrench, ledger);
        (contacts, wrench)
    }

    fn points(&self, pose: &Pose, contacts: &[Contact], error_bound: f64, ledger: &mut Ledger) {
        let units = [self.tool.info().unit, self.point_set.unit];
        let length = &Big::decimal(units[0].millimetres()) / &Big::decimal(units[1].millimetres());
        let mut evaluation: Vec<Option<&Contact>> = vec![None; self.point_set.points.len()];
        for contact in contacts {
            evaluation[contact.triangle.index()] = Some(contact);
        }
        for (p, contact) in self.point_set.points.iter().zip(evaluation) {
            let tool_point = in_tool(p, pose, units);
            let exact = &self.truth.depth(&tool_point) * &length;
            let depth = exact.to_f64();
            let describe = || format!("{:?} of {}", [p.x, p.y, p.z], format_pose(pose));
            let is_wrong = contact.is_some() != (depth >= 0.0) && depth.abs() > error_bound;
            ledger.count(WRONG_CONTACT, is_wrong, describe);
            let Some(contact) = contact else { continue };
            let finite = contact.depth.is_finite()
                && contact.direction.iter().chain(&contact.gradient).all(|c| c.is_finite());
            ledger.count(NOT_FINITE, !finite, describe);
            if finite {
                let error = (&Big::exactly(contact.depth) - &exact).abs().to_f64();
                // A point outside by less than the error bound may be a contact; its true depth is 0.
                let error = if depth < 0.0 { contact.depth } else { error };
                ledger.record(DEPTH_ERROR, error / error_bound, describe);
            }
        }
    }

    fn sums(&self, pose: &Pose, contacts: &[Contact], wrench: &Wrench, ledger: &mut Ledger) {
        let finite = wrench.force.iter().chain(&wrench.torque).all(|c| c.is_finite())
            && wrench.integral.is_finite()
            && wrench.energy.is_finite();
        ledger.count(NOT_FINITE, !finite, || format_pose(pose));
        if !finite {
            return;
        }
        let zero = || [Big::zero(), Big::zero(), Big::zero()];
        let (mut force, mut torque) = (zero(), zero());
        let (mut integral, mut force_bound, mut torque_bound) = (Big::zero(), 0.0, 0.0);
        let tip = pose.tip();
        for contact in contacts {
            let magnitude = &Big::exactly(contact.weight) * &Big::exactly(contact.magnitude);
            let [n, u] = [to_big(&contact.normal), to_big(&contact.direction)];
            let f = scale(&add(&n, &scale(&u, &Big::exactly(-1.0))), &magnitude);
            let arm: ExactPoint =
                std::array::from_fn(|k| &Big::exactly(contact.point[k]) - &Big::exactly(tip[k]));
            torque = add(&torque, &cross(&arm, &f));
            force = add(&force, &f);
            integral = &integral + &magnitude;
            let max_force = 2.0 * magnitude.to_f64();
            force_bound += max_force;
            // The point of a contact is rounded in world coordinates.
            let max_coordinate = contact.point.coords.amax().max(tip.coords.amax());
            torque_bound += max_force * ((contact.point - tip).norm() + max_coordinate);
        }
        let rounding = f64::EPSILON * (16.0 + contacts.len() as f64 / 4.0);
        let ratio = |difference: f64, force_bound: f64| {
            if difference == 0.0 { 0.0 } else { difference / (rounding * force_bound + 1e-320) }
        };
        ledger.record(SUM_ERROR, ratio(distance(&wrench.force, &force), force_bound), || {
            format_pose(pose)
        });
        ledger.record(SUM_ERROR, ratio(distance(&wrench.torque, &torque), torque_bound), || {
            format_pose(pose)
        });
        let difference = (&Big::exactly(wrench.integral) - &integral).abs().to_f64();
        ledger.record(SUM_ERROR, ratio(difference, force_bound), || format_pose(pose));
    }
}
