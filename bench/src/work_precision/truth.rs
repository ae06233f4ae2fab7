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
pub(super) struct Tally {
    /// Sums of squares of the errors of force, torque and depth, and of the true values.
    errors: [f64; 3],
    truths: [f64; 3],
    wrench: bool,
    worst_depth: f64,
    unfelt: usize,
    count: usize,
    colliding: usize,
}

/// The summary of a tally.
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

impl Tally {
    /// Adds an answer at a pose in true contact.
    pub(super) fn add(&mut self, found: &Answer, truth: &Truth) {
        self.count += 1;
        self.colliding += found.colliding;
        self.unfelt += usize::from(found.colliding == 0);
        let depth = (found.depth - truth.depth).abs();
        self.worst_depth = self.worst_depth.max(depth);
        self.errors[2] += depth * depth;
        if let Some([force, torque]) = found.wrench {
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

    /// Adds the values of another tally.
    pub(super) fn join(&mut self, other: &Tally) {
        for k in 0..3 {
            self.errors[k] += other.errors[k];
            self.truths[k] += other.truths[k];
        }
        self.wrench |= other.wrench;
        self.worst_depth = self.worst_depth.max(other.worst_depth);
        self.unfelt += other.unfelt;
        self.count += other.count;
        self.colliding += other.colliding;
    }

    /// Returns the root mean squares of the true force, torque and depth.
    pub(super) fn typical(&self) -> [f64; 3] {
        self.truths.map(|sum| (sum / self.count.max(1) as f64).sqrt())
    }

    /// Returns the summary. `known` has the relative accuracy of the true force, torque and depth; `depth` is the
    /// largest possible error of a true depth.
    pub(super) fn errors(&self, known: [f64; 3], depth: f64) -> Errors {
        let mut floored = Vec::new();
        let relative = [0, 1, 2].map(|k| {
            let has = self.count > 0 && (self.wrench || k == 2);
            let found = (self.errors[k] / self.truths[k]).sqrt();
            let below = has && found < known[k];
            floored.extend(below.then_some(Quantity::ALL[k].name()));
            has.then_some(found.max(known[k]))
        });
        let count = self.count.max(1) as f64;
        Errors {
            relative,
            worst_depth: self.worst_depth.max(depth),
            missed: self.unfelt as f64 / count,
            floored,
            checked: self.count,
            colliding: self.colliding as f64 / count,
        }
    }
}

/// Queries a method at the poses with known true values. A method that `walks` depends on the previous pose, so it is
/// also queried at all poses in between.
pub(super) fn check(
    contender: &mut dyn Contender,
    walks: bool,
    poses: &[Pose],
    truths: &[(usize, Truth)],
) -> Tally {
    let mut tally = Tally::default();
    let mut next = 0;
    for (at, truth) in truths {
        if walks {
            for pose in &poses[next..*at] {
                contender.query(pose);
            }
            next = at + 1;
        }
        tally.add(&contender.query(&poses[*at]), truth);
    }
    tally
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer(depth: f64, force: f64) -> Answer {
        let wrench = Some([Vector3::x() * force, Vector3::zeros()]);
        Answer { colliding: usize::from(depth > 0.0), depth, wrench }
    }

    #[test]
    fn errors_are_by_what_is_typical_and_never_below_what_is_known() {
        let truth = |depth: f64| Truth { force: Vector3::x() * depth, torque: Vector3::y(), depth };
        let mut tally = Tally::default();
        tally.add(&answer(3.0, 3.0), &truth(3.0));
        tally.add(&answer(0.0, 0.0), &truth(4.0));
        let found = tally.errors([1e-6; 3], 1e-9);
        assert_eq!(found.relative[2], Some(0.8));
        assert_eq!(found.relative[0], Some(0.8));
        assert_eq!(found.relative[1], Some(1.0));
        assert_eq!((found.worst_depth, found.missed, found.checked), (4.0, 0.5, 2));
        assert!(found.floored.is_empty());

        let mut exact = Tally::default();
        exact.add(&answer(3.0, 3.0), &truth(3.0));
        let found = exact.errors([1e-6; 3], 1e-9);
        assert_eq!((found.relative[0], found.worst_depth), (Some(1e-6), 1e-9));
        assert_eq!(found.floored, ["force", "depth"]);

        let mut deep = Tally::default();
        deep.add(&Answer { wrench: None, ..answer(3.0, 0.0) }, &truth(3.0));
        assert_eq!(deep.errors([1e-6; 3], 0.0).relative[..2], [None, None]);
    }
}
