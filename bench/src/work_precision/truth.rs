//! True values at a pose, and the errors of answers.

use super::row::Quantity;
use crate::race::contender::{Answer, Contender};
use nalgebra::Vector3;
use touchoff::Pose;

/// The true force, torque and depth at a pose. Force and torque about the tip act on the tool, in the world frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Truth {
    /// The force.
    pub(super) force: Vector3<f64>,
    /// The torque about the tip.
    pub(super) torque: Vector3<f64>,
    /// The greatest depth.
    pub(super) depth: f64,
}

impl Truth {
    /// Returns the norms of force, torque and depth.
    pub(super) fn sizes(&self) -> [f64; 3] {
        [self.force.norm(), self.torque.norm(), self.depth]
    }
}

/// Accumulated errors.
#[derive(Clone, Debug, Default)]
pub(super) struct ErrorStats {
    /// Sums of squares of the errors of force, torque and depth, and of the true values.
    errors: [f64; 3],
    truths: [f64; 3],
    wrench: bool,
    worst_depth: f64,
    without_contact: usize,
    count: usize,
    colliding: usize,
}

/// The summary of error statistics.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Errors {
    /// Errors of force, torque and depth, relative to their typical values.
    pub(super) relative: [Option<f64>; 3],
    /// The largest error of depth.
    pub(super) worst_depth: f64,
    /// The share of poses at which no contact was found.
    pub(super) missed: f64,
    /// Quantities whose error is given as the accuracy of the true value.
    pub(super) floored: Vec<&'static str>,
    /// Number of placements.
    pub(super) checked: usize,
    /// Mean number of points inside.
    pub(super) colliding: f64,
}

impl ErrorStats {
    /// Adds an answer at a pose in true contact.
    pub(super) fn add(&mut self, answer: &Answer, truth: &Truth) {
        self.count += 1;
        self.colliding += answer.colliding;
        self.without_contact += usize::from(answer.colliding == 0);
        let depth = (answer.depth - truth.depth).abs();
        self.worst_depth = self.worst_depth.max(depth);
        self.errors[2] += depth * depth;
        if let Some([force, torque]) = answer.wrench {
            self.wrench = true;
            self.errors[0] += (force - truth.force).norm_squared();
            self.errors[1] += (torque - truth.torque).norm_squared();
        }
        for (sum, size) in self.truths.iter_mut().zip(truth.sizes()) {
            *sum += size * size;
        }
    }

    /// Adds possible errors of the true force, torque and depth.
    pub(super) fn add_sizes(&mut self, sizes: [f64; 3]) {
        self.count += 1;
        self.worst_depth = self.worst_depth.max(sizes[2]);
        self.truths.iter_mut().zip(sizes).for_each(|(sum, size)| *sum += size * size);
    }

    /// Returns the largest error of depth.
    pub(super) fn largest_depth(&self) -> f64 {
        self.worst_depth
    }

    /// Adds the values of other statistics.
    pub(super) fn merge(&mut self, other: &ErrorStats) {
        for k in 0..3 {
            self.errors[k] += other.errors[k];
            self.truths[k] += other.truths[k];
        }
        self.wrench |= other.wrench;
        self.worst_depth = self.worst_depth.max(other.worst_depth);
        self.without_contact += other.without_contact;
        self.count += other.count;
        self.colliding += other.colliding;
    }

    /// Returns the root mean squares of the true force, torque and depth.
    pub(super) fn typical(&self) -> [f64; 3] {
        self.truths.map(|sum| (sum / self.count.max(1) as f64).sqrt())
    }

    /// Returns the summary. `accuracy` has the relative accuracy of the true force, torque and depth;
    /// `max_depth_error` is the largest possible error of a true depth.
    pub(super) fn errors(&self, accuracy: [f64; 3], max_depth_error: f64) -> Errors {
        let mut floored = Vec::new();
        let relative = [0, 1, 2].map(|k| {
            let is_measured = self.count > 0 && (self.wrench || k == 2);
            let relative_error = (self.errors[k] / self.truths[k]).sqrt();
            let is_floored = is_measured && relative_error < accuracy[k];
            floored.extend(is_floored.then_some(Quantity::ALL[k].name()));
            is_measured.then_some(relative_error.max(accuracy[k]))
        });
        let count = self.count.max(1) as f64;
        Errors {
            relative,
            worst_depth: self.worst_depth.max(max_depth_error),
            missed: self.without_contact as f64 / count,
            floored,
            checked: self.count,
            colliding: self.colliding as f64 / count,
        }
    }
}

/// Queries a method at the poses with known true values. A method with `follows_path` depends on the previous pose,
/// so it is also queried at all poses in between.
pub(super) fn check(
    contender: &mut dyn Contender,
    follows_path: bool,
    poses: &[Pose],
    truths: &[(usize, Truth)],
) -> ErrorStats {
    let mut stats = ErrorStats::default();
    let mut next = 0;
    for (index, truth) in truths {
        if follows_path {
            for pose in &poses[next..*index] {
                contender.query(pose);
            }
            next = index + 1;
        }
        stats.add(&contender.query(&poses[*index]), truth);
    }
    stats
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer(depth: f64, force: f64) -> Answer {
        let wrench = Some([Vector3::x() * force, Vector3::zeros()]);
        Answer { colliding: usize::from(depth > 0.0), depth, wrench }
    }

    #[test]
    fn errors_are_relative_to_typical_values_and_not_below_the_accuracy() {
        let truth = |depth: f64| Truth { force: Vector3::x() * depth, torque: Vector3::y(), depth };
        let mut stats = ErrorStats::default();
        stats.add(&answer(3.0, 3.0), &truth(3.0));
        stats.add(&answer(0.0, 0.0), &truth(4.0));
        let errors = stats.errors([1e-6; 3], 1e-9);
        assert_eq!(errors.relative[2], Some(0.8));
        assert_eq!(errors.relative[0], Some(0.8));
        assert_eq!(errors.relative[1], Some(1.0));
        assert_eq!((errors.worst_depth, errors.missed, errors.checked), (4.0, 0.5, 2));
        assert!(errors.floored.is_empty());

        let mut exact = ErrorStats::default();
        exact.add(&answer(3.0, 3.0), &truth(3.0));
        let errors = exact.errors([1e-6; 3], 1e-9);
        assert_eq!((errors.relative[0], errors.worst_depth), (Some(1e-6), 1e-9));
        assert_eq!(errors.floored, ["force", "depth"]);

        let mut deep = ErrorStats::default();
        deep.add(&Answer { wrench: None, ..answer(3.0, 0.0) }, &truth(3.0));
        assert_eq!(deep.errors([1e-6; 3], 0.0).relative[..2], [None, None]);
    }
}
