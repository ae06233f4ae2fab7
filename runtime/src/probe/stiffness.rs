//! The derivative of the wrench with respect to the tool's pose.

use super::state::QueryState;
use super::{Everything, Law, Probe, Weights, Wrench};
use crate::pose::Pose;
use crate::tool::{BatchEvaluator, Tool};
use nalgebra::{Matrix3, Matrix6, Vector3};

/// A wrench, and its derivative with respect to the tool's pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffness {
    /// The wrench at the pose.
    pub wrench: Wrench,
    /// The matrix `K`. As the tool moves by a small `u` and rotates by a small `θ` about its compliance centre, both in
    /// the world's frame, its force grows by the first three components of `-K (u, θ)` and its torque by the last
    /// three. The four blocks are in force per unit of length (the part's), force per radian, torque per unit of length
    /// and torque per radian.
    ///
    /// A point that enters the tool contributes nothing at first, since its magnitude is 0 at the surface. Torque is
    /// about a centre that moves with the tool. In a contact that exerts force, only the first three rows and columns
    /// are therefore symmetric, and these only for [`Law::Gradient`].
    pub matrix: Matrix6<f64>,
}

impl<T: BatchEvaluator + ?Sized> Probe<'_, T> {
    /// Returns the wrench and its derivative with respect to the pose. The derivative of each point inside is taken by
    /// the chain rule through the tool's own evaluators ([`Tool::derivatives`]), so it is exact up to rounding, except
    /// on borders between regions.
    pub fn stiffness(&mut self, pose: &Pose) -> Stiffness {
        if !self.state.set_pose(pose) {
            return self.zero_stiffness();
        }
        self.state.traverse(usize::MAX);
        self.state.filter(true);
        if !self.state.evaluate::<Everything, T>(self.tool) {
            return self.zero_stiffness();
        }
        let wrench = self.state.reduce(pose);
        Stiffness { wrench, matrix: self.state.matrix(self.tool, pose) }
    }

    /// Returns the stiffness without contact.
    fn zero_stiffness(&self) -> Stiffness {
        Stiffness { wrench: self.zero_wrench(), matrix: Matrix6::zeros() }
    }
}

impl QueryState<'_> {
    /// Sums the derivatives over all points inside, in the tool's frame, and rotates the sum to the world's frame at
    /// the end.
    ///
    /// Let `p` be the point in the tool's frame and `r` the arm from the centre to it. A force `f = R φ(p)` changes by
    /// `θ × f - A (u + θ × r)`, where `A = R Dφ Rᵀ`. For a force along `n - R u`, in which the part's normal `n` does
    /// not rotate with the tool, the first term is `θ × f'` instead, where `f'` is the tool's share of the force. The
    /// arm changes by `-u`.
    fn matrix<T: Tool + ?Sized>(&mut self, tool: &T, pose: &Pose) -> Matrix6<f64> {
        let rotation = pose.rotation();
        let mut scratch = std::mem::take(&mut self.scratch);
        let mut sum = StiffnessSum::default();
        for candidate in self.evaluations.inside_indices() {
            let index = self.candidates.indices()[candidate] as usize;
            let weight = match self.weights {
                Weights::Area => self.tree.weight(index),
                Weights::Unit => 1.0,
            };
            let vector =
                |lists: &[Vec<f64>; 3]| Vector3::from(lists.each_ref().map(|list| list[candidate]));
            let position = vector(self.candidates.points.lists());
            let arm = position * self.length - self.centre.coords;
            let magnitude = self.evaluations.magnitude[candidate];
            let gradient = vector(&self.evaluations.gradient);
            let derivatives = tool.derivatives(position.into(), self.length, &mut scratch);
            let rows = |rows: [[f64; 3]; 3]| Matrix3::from_fn(|row, column| rows[row][column]);
            let gradient_row = gradient.transpose();
            if self.law == Law::Gradient {
                let block =
                    weight * (gradient * gradient_row + magnitude * rows(derivatives.gradient));
                let force = weight * magnitude * gradient;
                sum.add(block, arm, force, force);
                continue;
            }
            let direction = vector(&self.evaluations.direction);
            let normal = rotation.tr_mul(&Vector3::from(self.tree.normal(index)));
            if self.law == Law::Facing && normal.dot(&direction) > 0.0 {
                continue;
            }
            let relative = normal - direction;
            let block =
                weight * (relative * gradient_row - magnitude * rows(derivatives.direction));
            let weighted_magnitude = weight * magnitude;
            sum.add(block, arm, weighted_magnitude * relative, -weighted_magnitude * direction);
        }
        self.scratch = scratch;
        sum.rotated(rotation)
    }
}

/// The four blocks of the matrix, in the tool's frame.
#[derive(Default)]
struct StiffnessSum {
    force: [Matrix3<f64>; 2],
    torque: [Matrix3<f64>; 2],
}

impl StiffnessSum {
    /// Adds a force at an arm, given its derivative `block` with respect to the position and the share `moment` of it that
    /// rotates with the tool.
    fn add(
        &mut self,
        block: Matrix3<f64>,
        arm: Vector3<f64>,
        force: Vector3<f64>,
        moment: Vector3<f64>,
    ) {
        let (arm, moment) = (arm.cross_matrix(), moment.cross_matrix());
        let by_rotation = moment - block * arm;
        self.force[0] += block;
        self.force[1] += by_rotation;
        self.torque[0] += arm * block - force.cross_matrix();
        self.torque[1] += arm * by_rotation;
    }

    fn rotated(&self, rotation: &Matrix3<f64>) -> Matrix6<f64> {
        let mut matrix = Matrix6::zeros();
        for (row, blocks) in [&self.force, &self.torque].into_iter().enumerate() {
            for (column, block) in blocks.iter().enumerate() {
                let rotated = rotation * block * rotation.transpose();
                matrix.fixed_view_mut::<3, 3>(3 * row, 3 * column).copy_from(&rotated);
            }
        }
        matrix
    }
}
