//! What is true at a pose, and how far answers are from it.

use super::row::Quantity;
use crate::race::contender::{Answer, Contender};
use nalgebra::Vector3;
use touchoff::Pose;

/// What the true surface does to the tool at a pose. Force and torque about the tip are on the tool, in
/// the world's frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Truth {
    /// The force.
    pub(super) force: Vector3<f64>,
    /// The torque about the tip.
    pub(super) torque: Vector3<f64>,
    /// How deep the deepest place is.
    pub(super) depth: f64,
}

impl Truth {
    /// How large force, torque and depth are.
    pub(super) fn sizes(&self) -> [f64; 3] {
        [self.force.norm(), self.torque.norm(), self.depth]
    }
}

/// Errors as they are met.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    /// Sums of squares of errors of force, torque and depth, and of what is true.
    errors: [f64; 3],
    truths: [f64; 3],
    wrench: bool,
    worst_depth: f64,
    unfelt: usize,
    count: usize,
    colliding: usize,
}

/// What errors come to.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Errors {
    /// Of force, torque and depth, by what is typical.
    pub(super) relative: [Option<f64>; 3],
    /// The largest of depth.
    pub(super) worst_depth: f64,
    /// The share of poses at which nothing was felt.
    pub(super) missed: f64,
    /// Which are given as what the truth is known to.
    pub(super) floored: Vec<&'static str>,
    /// At how many placements.
    pub(super) checked: usize,
    /// Points inside on average.
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

    /// Adds how far off force, torque and depth may be themselves.
    pub(super) fn add_sizes(&mut self, sizes: [f64; 3]) {
        self.count += 1;
        self.worst_depth = self.worst_depth.max(sizes[2]);
        self.truths.iter_mut().zip(sizes).for_each(|(sum, size)| *sum += size * size);
    }

    /// The largest error of depth.
    pub(super) fn largest_depth(&self) -> f64 {
        self.worst_depth
    }

    /// Adds what another one has met.
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

    /// How large force, torque and depth typically are: root mean squares.
    pub(super) fn typical(&self) -> [f64; 3] {
        self.truths.map(|sum| (sum / self.count.max(1) as f64).sqrt())
    }

    /// What they come to, where force, torque and depth are only known to these shares of what is typical;
    /// `depth` is by how much the depth of a pose may be off.
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

/// Asks at poses whose truth is known. One that `walks` remembers where it was, and is asked at every pose
/// between them too.
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
