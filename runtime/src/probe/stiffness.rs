//! How what a tool feels changes as it moves.

use super::state::QueryState;
use super::{Everything, Law, Probe, Weights, Wrench};
use crate::pose::Pose;
use crate::tool::{Senses, Tool};
use nalgebra::{Matrix3, Matrix6, Vector3};

/// A wrench, and how it changes as the tool moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffness {
    /// What is felt.
    pub wrench: Wrench,
    /// `K`: as the tool moves by `u` and turns by `θ` about its compliance centre, both small and in the
    /// world's frame, its force grows by the first three of `-K (u, θ)`, its torque by the last three. In
    /// force by the part's unit of length, force by radian, torque by either.
    ///
    /// A point that enters brings nothing yet, since its magnitude is 0 at the surface. Torque is about a
    /// centre that moves along: of a contact that pushes only the first three rows and columns are
    /// symmetric, and that by [`Law::Gradient`] alone.
    pub matrix: Matrix6<f64>,
}

impl<T: Senses + ?Sized> Probe<'_, T> {
    /// The wrench, and its derivative by the pose: of each point inside by the chain rule through the
    /// tool's own evaluators ([`Tool::slopes`]), so exact but for rounding wherever regions do not part.
    pub fn stiffness(&mut self, pose: &Pose) -> Stiffness {
        if !self.state.set_pose(pose) {
            return self.loose();
        }
        self.state.traverse(usize::MAX);
        self.state.filter(true);
        if !self.state.evaluate::<Everything, T>(self.tool) {
            return self.loose();
        }
        let wrench = self.state.reduce(pose);
        Stiffness { wrench, matrix: self.state.matrix(self.tool, pose) }
    }

    /// Returns the stiffness without contact.
    fn loose(&self) -> Stiffness {
        Stiffness { wrench: self.nothing(), matrix: Matrix6::zeros() }
    }
}

impl QueryState<'_> {
    /// The sum over what was felt, in the tool's frame and turned at the end. With `p` in the tool's frame
    /// and `r` from the centre to it, a force `f = R φ(p)` changes by `θ × f - A (u + θ × r)`, where
    /// `A = R Dφ Rᵀ`; of one along `n - R u`, of which the part's normal `n` does not turn, by `θ × f'`
    /// instead, where `f'` is the tool's share. The arm changes by `-u`.
    fn matrix<T: Tool + ?Sized>(&mut self, tool: &T, pose: &Pose) -> Matrix6<f64> {
        let turn = pose.rotation();
        let mut room = std::mem::take(&mut self.room);
        let mut sum = Sum::default();
        for at in self.felt.places() {
            let index = self.candidates.indices()[at] as usize;
            let weight = match self.weights {
                Weights::Area => self.tree.weight(index),
                Weights::Unit => 1.0,
            };
            let vector =
                |lists: &[Vec<f64>; 3]| Vector3::from(lists.each_ref().map(|list| list[at]));
            let own = vector(self.candidates.points.lists());
            let arm = own * self.length - self.centre.coords;
            let magnitude = self.felt.magnitude[at];
            let gradient = vector(&self.felt.gradient);
            let slopes = tool.slopes(own.into(), self.length, &mut room);
            let rows = |rows: [[f64; 3]; 3]| Matrix3::from_fn(|row, column| rows[row][column]);
            let steep = gradient.transpose();
            if self.law == Law::Gradient {
                let own = weight * (gradient * steep + magnitude * rows(slopes.gradient));
                let force = weight * magnitude * gradient;
                sum.add(own, arm, force, force);
                continue;
            }
            let direction = vector(&self.felt.direction);
            let normal = turn.tr_mul(&Vector3::from(self.tree.normal(index)));
            if self.law == Law::Facing && normal.dot(&direction) > 0.0 {
                continue;
            }
            let way = normal - direction;
            let own = weight * (way * steep - magnitude * rows(slopes.direction));
            let push = weight * magnitude;
            sum.add(own, arm, push * way, -push * direction);
        }
        self.room = room;
        sum.turned(turn)
    }
}

/// The blocks of the matrix in the tool's frame.
#[derive(Default)]
struct Sum {
    force: [Matrix3<f64>; 2],
    torque: [Matrix3<f64>; 2],
}

impl Sum {
    /// A force at an arm, its derivative by the position, and what of it turns with the tool.
    fn add(
        &mut self,
        own: Matrix3<f64>,
        arm: Vector3<f64>,
        force: Vector3<f64>,
        turns: Vector3<f64>,
    ) {
        let (arm, turns) = (arm.cross_matrix(), turns.cross_matrix());
        let by_turn = turns - own * arm;
        self.force[0] += own;
        self.force[1] += by_turn;
        self.torque[0] += arm * own - force.cross_matrix();
        self.torque[1] += arm * by_turn;
    }

    fn turned(&self, turn: &Matrix3<f64>) -> Matrix6<f64> {
        let mut matrix = Matrix6::zeros();
        for (row, blocks) in [&self.force, &self.torque].into_iter().enumerate() {
            for (column, block) in blocks.iter().enumerate() {
                let turned = turn * block * turn.transpose();
                matrix.fixed_view_mut::<3, 3>(3 * row, 3 * column).copy_from(&turned);
            }
        }
        matrix
    }
}
