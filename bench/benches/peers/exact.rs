//! What is true at a pose, and how far methods are from it.
//!
//! Of the cloud: the oracle's loop over all points in `f64` with compensated sums, which shares no
//! code with the methods. Of the part itself: the deepest point of all triangles, by branch and
//! bound.

use crate::contender::{Answer, Workpiece};
use nalgebra::Vector3;
use touchoff::Pose;
use touchoff_bench::peers::deepest::{TOLERANCE, deepest};
use touchoff_tests::oracle::{Fig73, brute};

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
            part_depth: deepest(&piece.mesh, pose, depth),
        }
    }
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
