//! Proofs that no point has given signs: by elimination where curves are linear, otherwise by boxes that
//! cover the domain.

use crate::bound::Prover;
use crate::domain::Domain;
use crate::elimination::Linear;
use crate::expr::interval::halves;
use crate::formula::{ANY_SIGN, Signs};
use crate::model::Model;

/// The largest number of boxes in one proof, in the half plane and in space.
const MAX_BOXES_IN_HALF_PLANE: usize = 96;
const MAX_BOXES_IN_SPACE: usize = 400;

/// A prover that combinations of signs are impossible.
pub(crate) struct EmptinessProver<'m> {
    linear: Linear,
    domain: Domain,
    prover: Prover<'m>,
}

impl<'m> EmptinessProver<'m> {
    pub(crate) fn new(model: &'m Model) -> EmptinessProver<'m> {
        EmptinessProver {
            linear: Linear::new(model),
            domain: model.domain,
            prover: Prover::new(model),
        }
    }

    /// Returns whether provably no point has these signs.
    pub(super) fn is_empty(&mut self, signs: &[Signs]) -> bool {
        self.linear.is_contradictory(signs).unwrap_or_else(|| self.is_excluded_by_boxes(signs))
    }

    /// Returns whether no box of a cover of the domain can have the signs.
    fn is_excluded_by_boxes(&mut self, signs: &[Signs]) -> bool {
        let mut pending = vec![self.domain.bounding_cell(2f64.powi(300))];
        let mut boxes_left = match self.domain {
            Domain::HalfPlane => MAX_BOXES_IN_HALF_PLANE,
            Domain::Space => MAX_BOXES_IN_SPACE,
        };
        while let Some(cell) = pending.pop() {
            self.prover.set_box(cell);
            let mut constrained =
                signs.iter().enumerate().filter(|(_, allowed)| **allowed != ANY_SIGN);
            if constrained.any(|(curve, allowed)| self.prover.signs(curve) & allowed == 0) {
                continue;
            }
            if boxes_left == 0 {
                return false;
            }
            boxes_left -= 1;
            pending.extend(halves(cell));
        }
        true
    }
}
