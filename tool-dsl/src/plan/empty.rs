//! Proofs that no point has given signs: by elimination where curves are linear, otherwise by boxes that
//! cover the domain.

use crate::bound::Prover;
use crate::domain::Domain;
use crate::elimination::Linear;
use crate::expr::interval::halves;
use crate::formula::{ANY, Signs};
use crate::model::Model;

/// The largest number of boxes in one proof, in the half plane and in space.
const BOXES: usize = 96;
const BOXES_OF_SPACE: usize = 400;

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
    pub(super) fn proved(&mut self, signs: &[Signs]) -> bool {
        self.linear.judged(signs).unwrap_or_else(|| self.uncovered(signs))
    }

    /// Returns whether no box of a cover of the domain can have the signs.
    fn uncovered(&mut self, signs: &[Signs]) -> bool {
        let mut open = vec![self.domain.whole(2f64.powi(300))];
        let mut left = match self.domain {
            Domain::HalfPlane => BOXES,
            Domain::Space => BOXES_OF_SPACE,
        };
        while let Some(cell) = open.pop() {
            self.prover.set(cell);
            let mut asked = signs.iter().enumerate().filter(|(_, wanted)| **wanted != ANY);
            if asked.any(|(curve, wanted)| self.prover.sign(curve) & wanted == 0) {
                continue;
            }
            if left == 0 {
                return false;
            }
            left -= 1;
            open.extend(halves(cell));
        }
        true
    }
}
