//! The order in which runs are followed: always the one whose end is nearest.

use super::axes::{PathPosture, PostureRun};
use super::slice::Planes;
use nalgebra::Point3;
use std::collections::BTreeMap;

/// The runs that remain to be followed, by plane.
///
/// The nearest run is searched plane by plane, away from the tool. Points of contact in a plane are at least as far
/// from the tool's as the planes are from each other, and lifted tips are nearer to each other by twice the reach and the
/// lift at most, so that planes beyond the nearest run found are not searched.
pub(super) struct OpenRuns {
    planes: Planes,
    /// Per plane that has any, its remaining runs.
    runs: BTreeMap<usize, Vec<PostureRun>>,
    /// Largest distance between a tip and its point of contact, in the part's unit.
    reach: f64,
    /// Lift along the axis at which distances are measured, so that ends on both sides of a thin wall are far from each
    /// other.
    lift: f64,
}

/// The end of a run that is nearest to the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
struct NearestEnd {
    /// Distance of the lifted tips, in the part's unit.
    distance: f64,
    /// Index of the plane.
    plane: usize,
    /// Index of the run in the plane.
    run: usize,
    /// Set if the end is the run's last posture.
    is_last: bool,
}

impl OpenRuns {
    /// Creates an empty list. `reach` is the largest distance between a tip and its point of contact, and `lift` the
    /// travel along the axis after which the distance of tips is measured.
    pub(super) fn new(planes: Planes, reach: f64, lift: f64) -> OpenRuns {
        OpenRuns { planes, runs: BTreeMap::new(), reach, lift }
    }

    /// Adds runs of a plane, none of them empty.
    pub(super) fn extend(&mut self, plane: usize, runs: Vec<PostureRun>) {
        if !runs.is_empty() {
            self.runs.entry(plane).or_default().extend(runs);
        }
    }

    /// Removes and returns the run with the end nearest to the last posture, so that it begins there; without a last
    /// posture, the first run. Returns `None` if no run remains.
    pub(super) fn take_nearest(&mut self, last: Option<&PathPosture>) -> Option<PostureRun> {
        let nearest = match last {
            Some(last) => self.nearest(last)?,
            None => {
                let plane = *self.runs.first_key_value()?.0;
                NearestEnd { distance: 0.0, plane, run: 0, is_last: false }
            }
        };
        let runs = self.runs.get_mut(&nearest.plane)?;
        let mut run = runs.swap_remove(nearest.run);
        if runs.is_empty() {
            self.runs.remove(&nearest.plane);
        }
        if nearest.is_last {
            run.reverse();
        }
        Some(run)
    }

    /// Returns the end that is nearest to a posture.
    fn nearest(&self, last: &PathPosture) -> Option<NearestEnd> {
        let height = self.planes.height_of(&last.surface_point.point);
        // Either side of this plane is searched away from it. Rounding can put it on the wrong side of the tool, by much
        // less than the reach.
        let middle = self.planes.position(height).round().max(0.0) as usize;
        let mut nearest = None;
        for (plane, runs) in self.runs.range(middle..) {
            if !self.can_improve(nearest, self.planes.height(*plane) - height) {
                break;
            }
            nearest = nearer(nearest, self.nearest_of(*plane, runs, last));
        }
        for (plane, runs) in self.runs.range(..middle).rev() {
            if !self.can_improve(nearest, height - self.planes.height(*plane)) {
                break;
            }
            nearest = nearer(nearest, self.nearest_of(*plane, runs, last));
        }
        nearest
    }

    /// Returns whether a plane at a distance from that of the tool can have a nearer end.
    fn can_improve(&self, nearest: Option<NearestEnd>, distance: f64) -> bool {
        nearest.is_none_or(|nearest| distance - 2.0 * (self.reach + self.lift) <= nearest.distance)
    }

    /// Returns the end of runs of a plane that is nearest to a posture.
    fn nearest_of(
        &self,
        plane: usize,
        runs: &[PostureRun],
        last: &PathPosture,
    ) -> Option<NearestEnd> {
        let from = lifted_tip(last, self.lift);
        let mut nearest = None;
        for (run, open) in runs.iter().enumerate() {
            let ends = [open.postures.first(), open.postures.last()];
            for (end, is_last) in ends.into_iter().zip([false, true]) {
                let found = end.map(|end| NearestEnd {
                    distance: (lifted_tip(end, self.lift) - from).norm(),
                    plane,
                    run,
                    is_last,
                });
                nearest = nearer(nearest, found);
            }
        }
        nearest
    }
}

/// Returns the tip of a posture after a lift along its axis.
fn lifted_tip(posture: &PathPosture, lift: f64) -> Point3<f64> {
    posture.pose.tip() + posture.axis * lift
}

/// Returns the nearer of two ends, the first of equally near ones.
fn nearer(one: Option<NearestEnd>, other: Option<NearestEnd>) -> Option<NearestEnd> {
    match (one, other) {
        (Some(one), Some(other)) if other.distance < one.distance => Some(other),
        (one, other) => one.or(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::placement::SurfacePoint;
    use nalgebra::Vector3;
    use rand_core::{Rng, SeedableRng};
    use rand_pcg::Pcg64Mcg;
    use touchoff::mesh::shapes;
    use touchoff::{Pose, Unit};

    const LIFT: f64 = 0.8;

    /// Returns a posture at a point, with a tip within the reach.
    fn posture(point: Point3<f64>, tip: Vector3<f64>, axis: Vector3<f64>) -> PathPosture {
        PathPosture {
            surface_point: SurfacePoint { point, normal: axis },
            pose: Pose::from_axis(point + tip, axis).expect("a pose"),
            axis,
        }
    }

    fn ends(run: &PostureRun) -> [Point3<f64>; 2] {
        let ends = [&run.postures[0], &run.postures[run.postures.len() - 1]];
        ends.map(|end| end.pose.tip() + end.pose.axis() * LIFT)
    }

    /// Among runs in random places, the search by planes finds what a search of all runs finds.
    #[test]
    fn takes_the_run_that_a_search_of_all_takes() {
        const REACH: f64 = 1.5;
        let mesh = shapes::cuboid(Point3::origin(), Point3::new(9.0, 9.0, 20.0), Unit::Millimetre)
            .expect("a block");
        let planes = Planes::new(&mesh, &Vector3::z(), 0.5);
        let mut random = Pcg64Mcg::seed_from_u64(7);
        let mut number =
            |low: f64, high: f64| low + (high - low) * (random.next_u64() as f64 / u64::MAX as f64);
        let mut open = OpenRuns::new(planes, REACH, LIFT);
        let mut all: Vec<[Point3<f64>; 2]> = Vec::new();
        for plane in 0..40 {
            // Some planes have no run, and those far from each other have few.
            for _ in 0..(plane % 7) / 2 {
                let mut random_posture = || {
                    let point =
                        Point3::new(number(0.0, 9.0), number(0.0, 9.0), planes.height(plane));
                    let tip = Vector3::from_fn(|_, _| number(-1.0, 1.0));
                    let axis = Vector3::new(number(-1.0, 1.0), number(-1.0, 1.0), 1.0).normalize();
                    posture(point, tip * (REACH / 3f64.sqrt()), axis)
                };
                let postures = vec![random_posture(), random_posture()];
                let run = PostureRun { postures, links: vec![None], squared_turns: 0.0 };
                all.push(ends(&run));
                open.extend(plane, vec![run]);
            }
        }
        let mut last: Option<PathPosture> = None;
        let mut taken = 0;
        while let Some(run) = open.take_nearest(last.as_ref()) {
            let [first, end] = ends(&run);
            if let Some(last) = &last {
                let from = last.pose.tip() + last.pose.axis() * LIFT;
                let distances = all.iter().flatten().map(|tip| (tip - from).norm());
                let least = distances.fold(f64::INFINITY, f64::min);
                assert!((first - from).norm() <= least + 1e-12, "run {taken}");
            }
            let known = all.iter().position(|ends| *ends == [first, end] || *ends == [end, first]);
            all.swap_remove(known.expect("one of the runs"));
            last = Some(run.postures[1]);
            taken += 1;
        }
        assert!(all.is_empty() && taken > 40, "{taken} runs, {} left", all.len());
    }
}
