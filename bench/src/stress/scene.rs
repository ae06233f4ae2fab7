//! A few points near a tool, given as a part, and validation of a probe's answers against 256 bits.

use super::ledger::{Kind, Ledger};
use super::truth::{Place, Subject, Truth};
use nalgebra::{Point3, Vector3};
use touchoff::{Cloud, Contact, Part, Pose, Probe, Tool, Unit, Wrench};
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::draw::Rng;

/// Error of a contact's depth relative to the true depth of the given point.
pub(super) const DEPTHS: Kind = Kind::of("depth of contacts", "Probe::rounding_error_bound", 1.0);
/// Points beyond doubt inside without a contact, or beyond doubt outside with one.
pub(super) const MEMBERS: Kind = Kind::never("wrong contact");
/// Error of force and torque relative to the sums over the contacts in 256 bits.
pub(super) const SUMS: Kind = Kind::of("force and torque", "rounding of the sums", 1.0);
/// Contradictions between the answers of different queries.
pub(super) const ALIKE: Kind = Kind::never("questions disagree");
/// Numbers that are not finite.
pub(super) const FINITE: Kind = Kind::never("senseless number");

/// Difference of a depth between two equivalent scenes, which comes from the rounding of both clouds and of the
/// coordinates.
const APART: Kind = Kind::of("depth in both scenes", "both errors and rounding", 1.0);
const LOST: Kind = Kind::never("contact in one scene only");

/// Checks that the contacts of two equivalent scenes agree to `bound`. A contact's triangle is the index of its point.
pub(super) fn apart(
    [a, b]: [&[Contact]; 2],
    count: usize,
    bound: f64,
    place: impl Fn() -> String,
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
        let place = || format!("point {k}, {}", place());
        match pair {
            (Some(a), Some(b)) => ledger.see(APART, (a - b).abs() / bound, place),
            (Some(one), None) | (None, Some(one)) => ledger.count(LOST, one > bound, place),
            (None, None) => {}
        }
    }
}

/// Points, normals and weights in the world frame.
#[derive(Clone)]
pub(super) struct Given {
    pub(super) points: Vec<Point3<f64>>,
    pub(super) normals: Vec<Vector3<f64>>,
    pub(super) weights: Vec<f64>,
    pub(super) unit: Unit,
}

impl Given {
    /// Builds the part. The triangle of each point is its index.
    pub(super) fn part(&self) -> Part {
        let ids = (0..self.points.len() as u32).collect();
        let (points, normals) = (self.points.clone(), self.normals.clone());
        let cloud = Cloud::new(points, normals, ids, self.weights.clone(), self.unit);
        Part::from_cloud(&cloud.expect("points that make a cloud"))
    }

    /// Returns random points near a tool's surface and splitting curves, in the tool's frame and unit. Every second
    /// point may be farther away than the others. Coordinates are multiples of `grid`; normals have any direction.
    pub(super) fn about(subject: &Subject, count: usize, grid: f64, draw: &mut Rng) -> Given {
        let curves = subject.oracle.curve_points();
        let reach = 0.2 * subject.oracle.extent()[0];
        let mut given = Given {
            points: Vec::new(),
            normals: Vec::new(),
            weights: Vec::new(),
            unit: subject.tool.info().unit,
        };
        for k in 0..count {
            let curve = &curves[draw.bits() as usize % curves.len()];
            let on = curve[draw.bits() as usize % curve.len()];
            let step = draw.direction().map(|c| c * reach * if k % 2 == 0 { 0.05 } else { 1.0 });
            let angle = draw.between(0.0, std::f64::consts::TAU);
            let p = touchoff_tests::oracle::moved(&*subject.oracle, on, step, angle);
            given.points.push(Point3::from(p.map(|c| (c / grid).round() * grid)));
            given.normals.push(Vector3::from(draw.direction()));
            given.weights.push(draw.between(0.1, 2.0));
        }
        given
    }

    /// Transforms the points by a pose and rounds them to the grid again.
    pub(super) fn at(&self, pose: &Pose, grid: f64) -> Given {
        let carried = |p: &Point3<f64>| {
            let there = pose.tip() + pose.rotation() * p.coords;
            there.map(|c| (c / grid).round() * grid)
        };
        Given { points: self.points.iter().map(carried).collect(), ..self.clone() }
    }

    /// Translates the points.
    pub(super) fn moved(&self, by: Vector3<f64>) -> Given {
        Given { points: self.points.iter().map(|p| p + by).collect(), ..self.clone() }
    }
}

/// Formats a pose to the last bit.
pub(super) fn shown(pose: &Pose) -> String {
    let (tip, r) = (pose.tip(), pose.rotation());
    let list = |v: &[f64]| format!("{v:?}");
    format!("tip {}, axes {}", list(tip.coords.as_slice()), list(r.as_slice()))
}

fn exactly(v: &Vector3<f64>) -> Place {
    [v.x, v.y, v.z].map(Big::exactly)
}

fn sum(a: &Place, b: &Place) -> Place {
    std::array::from_fn(|k| &a[k] + &b[k])
}

fn scaled(a: &Place, by: &Big) -> Place {
    std::array::from_fn(|k| &a[k] * by)
}

fn cross(a: &Place, b: &Place) -> Place {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        &(&a[i] * &b[j]) - &(&a[j] * &b[i])
    })
}

/// Returns the distance between a vector of doubles and one of 256 bits.
fn off(a: &Vector3<f64>, b: &Place) -> f64 {
    let squares = exactly(a).iter().zip(b).map(|(a, b)| (a - b).to_f64().powi(2)).sum::<f64>();
    squares.sqrt()
}

/// Transforms a point to the tool's frame and unit.
pub(super) fn in_tool(p: &Point3<f64>, pose: &Pose, [tool, part]: [Unit; 2]) -> Place {
    let from: Place = std::array::from_fn(|k| &Big::exactly(p[k]) - &Big::exactly(pose.tip()[k]));
    let mm = |unit: Unit| Big::decimal(unit.millimetres());
    let per = &mm(part) / &mm(tool);
    std::array::from_fn(|k| {
        let terms = (0..3).map(|j| &Big::exactly(pose.rotation()[(j, k)]) * &from[j]);
        &terms.fold(Big::zero(), |sum, term| &sum + &term) * &per
    })
}

/// A tool and a part, with the true values for validation.
pub(super) struct Asked<'a> {
    pub(super) tool: &'a dyn Tool,
    pub(super) truth: &'a dyn Truth,
    pub(super) given: &'a Given,
    pub(super) part: &'a Part,
}

impl Asked<'_> {
    /// Queries at a pose, validates the answers, and returns contacts and wrench for further checks.
    pub(super) fn at(&self, pose: &Pose, ledger: &mut Ledger) -> (Vec<Contact>, Wrench) {
        let mut probe = Probe::new(self.part, self.tool);
        let contacts = probe.contacts(pose).to_vec();
        let wrench = probe.wrench(pose);
        let (found, deepest) = (probe.detect(pose), probe.deepest(pose));
        let posture = probe.posture(pose);
        let most = contacts.iter().map(|c| c.depth).fold(None, |most: Option<f64>, depth| {
            Some(most.map_or(depth, |most| most.max(depth)))
        });
        let alike = found != contacts.is_empty()
            && wrench.colliding == contacts.len()
            && posture.colliding == contacts.len()
            && deepest.map(|d| d.depth) == most
            && wrench.deepest.map(|d| d.depth) == most;
        ledger.count(ALIKE, !alike, || shown(pose));
        let error =
            probe.rounding_error_bound().expect("how steep depth is was proved of every tool");
        self.points(pose, &contacts, error, ledger);
        self.sums(pose, &contacts, &wrench, ledger);
        (contacts, wrench)
    }

    fn points(&self, pose: &Pose, contacts: &[Contact], error: f64, ledger: &mut Ledger) {
        let units = [self.tool.info().unit, self.given.unit];
        let length = &Big::decimal(units[0].millimetres()) / &Big::decimal(units[1].millimetres());
        let mut evaluation: Vec<Option<&Contact>> = vec![None; self.given.points.len()];
        for contact in contacts {
            evaluation[contact.triangle.index()] = Some(contact);
        }
        for (p, contact) in self.given.points.iter().zip(evaluation) {
            let place = in_tool(p, pose, units);
            let exact = &self.truth.depth(&place) * &length;
            let depth = exact.to_f64();
            let shown = || format!("{:?} of {}", [p.x, p.y, p.z], shown(pose));
            let wrong = contact.is_some() != (depth >= 0.0) && depth.abs() > error;
            ledger.count(MEMBERS, wrong, shown);
            let Some(contact) = contact else { continue };
            let finite = contact.depth.is_finite()
                && contact.direction.iter().chain(&contact.gradient).all(|c| c.is_finite());
            ledger.count(FINITE, !finite, shown);
            if finite {
                let off = (&Big::exactly(contact.depth) - &exact).abs().to_f64();
                // A point outside by less than the error bound may be a contact; its true depth is 0.
                let off = if depth < 0.0 { contact.depth } else { off };
                ledger.see(DEPTHS, off / error, shown);
            }
        }
    }

    fn sums(&self, pose: &Pose, contacts: &[Contact], wrench: &Wrench, ledger: &mut Ledger) {
        let finite = wrench.force.iter().chain(&wrench.torque).all(|c| c.is_finite())
            && wrench.integral.is_finite()
            && wrench.energy.is_finite();
        ledger.count(FINITE, !finite, || shown(pose));
        if !finite {
            return;
        }
        let zero = || [Big::zero(), Big::zero(), Big::zero()];
        let (mut force, mut torque) = (zero(), zero());
        let (mut integral, mut size, mut lever) = (Big::zero(), 0.0, 0.0);
        let tip = pose.tip();
        for contact in contacts {
            let push = &Big::exactly(contact.weight) * &Big::exactly(contact.magnitude);
            let [n, u] = [exactly(&contact.normal), exactly(&contact.direction)];
            let f = scaled(&sum(&n, &scaled(&u, &Big::exactly(-1.0))), &push);
            let arm: Place =
                std::array::from_fn(|k| &Big::exactly(contact.point[k]) - &Big::exactly(tip[k]));
            torque = sum(&torque, &cross(&arm, &f));
            force = sum(&force, &f);
            integral = &integral + &push;
            let most = 2.0 * push.to_f64();
            size += most;
            // The point of a contact is rounded in world coordinates.
            let far = contact.point.coords.amax().max(tip.coords.amax());
            lever += most * ((contact.point - tip).norm() + far);
        }
        let rounding = f64::EPSILON * (16.0 + contacts.len() as f64 / 4.0);
        let part =
            |off: f64, size: f64| if off == 0.0 { 0.0 } else { off / (rounding * size + 1e-320) };
        ledger.see(SUMS, part(off(&wrench.force, &force), size), || shown(pose));
        ledger.see(SUMS, part(off(&wrench.torque, &torque), lever), || shown(pose));
        let off = (&Big::exactly(wrench.integral) - &integral).abs().to_f64();
        ledger.see(SUMS, part(off, size), || shown(pose));
    }
}
