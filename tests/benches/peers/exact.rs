//! What is true at a pose, and how far methods are from it.
//!
//! Of the cloud: the oracle's loop over all points in `f64` with compensated sums, which shares no
//! code with the methods. Of the part itself: the deepest point of all triangles, by branch and
//! bound.

use crate::contender::{Answer, View, Workpiece};
use crate::formula;
use nalgebra::{Point3, Vector3};
use touchoff::Pose;
use touchoff_tests::oracle::{Fig73, brute};

/// How exactly the deepest point of the triangles is found, mm.
const TOLERANCE: f64 = 1e-6;

/// The oracle's cloud.
pub(crate) struct Exact {
    tool: Fig73,
    points: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
    weights: Vec<f64>,
}

/// What is true at a pose.
pub(crate) struct Truth {
    colliding: usize,
    depth: f64,
    wrench: [Vector3<f64>; 2],
    /// Of the triangles, not the points.
    part_depth: f64,
}

impl Exact {
    pub(crate) fn new(piece: &Workpiece) -> Exact {
        Exact {
            tool: Fig73::default(),
            points: piece.cloud.points().iter().map(|p| p.coords.into()).collect(),
            normals: piece.cloud.normals().iter().map(|n| (*n).into()).collect(),
            weights: piece.cloud.weights().to_vec(),
        }
    }

    pub(crate) fn at(&self, pose: &Pose, piece: &Workpiece) -> Truth {
        let axes = [0, 1, 2].map(|axis| pose.rotation().column(axis).into_owned().into());
        let place = brute::Pose { tip: pose.tip().coords.into(), axes };
        let lists = (&self.points, &self.normals, &self.weights);
        let felt = brute::Query::new(&self.tool, place, lists.0, lists.1, lists.2).answer();
        let depth = felt.deepest.map_or(0.0, |(depth, _)| depth);
        Truth {
            colliding: felt.count,
            depth,
            wrench: [felt.force.into(), felt.torque.into()],
            part_depth: deepest(piece, pose, depth),
        }
    }
}

/// The largest magnitude on the part's triangles, given one that is reached.
fn deepest(piece: &Workpiece, pose: &Pose, mut best: f64) -> f64 {
    let view = View::of(pose);
    let turn = |p: Point3<f64>| Vector3::from(view.turn(view.arm(p.coords.into())));
    let all = 0..piece.mesh.triangles().len() as u32;
    let mut left: Vec<_> = all.map(|id| piece.mesh.triangle(id).map(turn)).collect();
    while let Some([a, b, c]) = left.pop() {
        let (here, most) = bound([a, b, c]);
        best = best.max(here);
        if most <= best + TOLERANCE {
            continue;
        }
        // Across the longest edge.
        let [ab, bc, ca] = [b - a, c - b, a - c].map(|edge| edge.norm_squared());
        let (p, q, r) = if ab >= bc && ab >= ca {
            (a, b, c)
        } else if bc >= ca {
            (b, c, a)
        } else {
            (c, a, b)
        };
        let middle = 0.5 * (p + q);
        left.extend([[p, middle, r], [middle, q, r]]);
    }
    best
}

/// The magnitude at a triangle's centre, and no less than it has anywhere on the triangle: it is the
/// largest of concave functions, none of which exceeds its tangent at the centre.
fn bound(corners: [Vector3<f64>; 3]) -> (f64, f64) {
    let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
    let d = centre.x.hypot(centre.y);
    let radial = if d > 0.0 { [centre.x / d, centre.y / d] } else { [0.0; 2] };
    let pieces = formula::pieces(d, formula::TIP - centre.z);
    let most = |(value, [by_d, by_z]): (f64, [f64; 2])| {
        let slope = Vector3::new(by_d * radial[0], by_d * radial[1], -by_z);
        let rise = corners.map(|corner| slope.dot(&(corner - centre)));
        value + rise.into_iter().fold(0.0, f64::max)
    };
    let largest = |values: [f64; 5]| values.into_iter().fold(f64::NEG_INFINITY, f64::max);
    (largest(pieces.map(|(value, _)| value)), largest(pieces.map(most)))
}

/// What a method errs, gathered over poses. Relative errors are of all poses in contact together:
/// the root of the sum of squared errors by that of squared true values.
#[derive(Default)]
pub(crate) struct Errors {
    checked: usize,
    miscounted: usize,
    depth: Ratio,
    part_depth: Ratio,
    force: Ratio,
    torque: Ratio,
}

#[derive(Default)]
struct Ratio {
    errors: f64,
    values: f64,
}

impl Ratio {
    fn add(&mut self, error: f64, value: f64) {
        self.errors += error * error;
        self.values += value * value;
    }

    fn value(&self) -> Option<f64> {
        (self.values > 0.0).then(|| (self.errors / self.values).sqrt())
    }
}

impl Errors {
    pub(crate) fn add(&mut self, found: &Answer, truth: &Truth, feels_triangles: bool) {
        self.checked += 1;
        self.part_depth.add(found.depth - truth.part_depth, truth.part_depth);
        if feels_triangles {
            // By less than the bound is exact, nothing is said.
            let doubtful = truth.part_depth > 0.0 && truth.part_depth < 2.0 * TOLERANCE;
            let wrong = (found.colliding > 0) != (truth.part_depth > 0.0);
            self.miscounted += usize::from(wrong && !doubtful);
            self.depth.add(found.depth - truth.part_depth, truth.part_depth);
        } else {
            self.miscounted += usize::from(found.colliding != truth.colliding);
            self.depth.add(found.depth - truth.depth, truth.depth);
        }
        if let Some([force, torque]) = found.wrench {
            self.force.add((force - truth.wrench[0]).norm(), truth.wrench[0].norm());
            self.torque.add((torque - truth.wrench[1]).norm(), truth.wrench[1].norm());
        }
    }

    /// Of how many poses the truth was worked out.
    pub(crate) fn checked(&self) -> usize {
        self.checked
    }

    /// At how many of them the number of points (of methods without points: contact) is wrong.
    pub(crate) fn miscounted(&self) -> usize {
        self.miscounted
    }

    /// Against the deepest of what the method feels, points or triangles.
    pub(crate) fn depth(&self) -> Option<f64> {
        self.depth.value()
    }

    /// Against the deepest of the triangles.
    pub(crate) fn part_depth(&self) -> Option<f64> {
        self.part_depth.value()
    }

    pub(crate) fn force(&self) -> Option<f64> {
        self.force.value()
    }

    pub(crate) fn torque(&self) -> Option<f64> {
        self.torque.value()
    }
}
