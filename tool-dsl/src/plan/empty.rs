//! Proofs that no point has given signs: by elimination where curves are linear, otherwise by boxes that
//! cover the domain.

use crate::bound::{Extent, Prover};
use crate::domain::Domain;
use crate::elimination::Linear;
use crate::expr::interval::halves;
use crate::formula::{ANY_SIGN, Signs};
use crate::model::Model;

/// The largest number of boxes in one proof, in the half plane and in space.
const MAX_BOXES_IN_HALF_PLANE: usize = 96;
const MAX_BOXES_IN_SPACE: usize = 400;

/// The size of a box, relative to the tool's, at which a proof is given up: it mostly has a point with the signs. Boxes are divided
/// depth first, so such a box is reached soon.
const SMALLEST_BOX: f64 = 1.0 / 4096.0;

/// A prover that combinations of signs are impossible.
pub(crate) struct EmptinessProver<'m> {
    linear: Linear,
    domain: Domain,
    prover: Prover<'m>,
    /// The size of boxes that are not divided further.
    smallest: f64,
}

impl<'m> EmptinessProver<'m> {
    pub(crate) fn new(model: &'m Model, extent: &Extent) -> EmptinessProver<'m> {
        EmptinessProver {
            linear: Linear::new(model),
            domain: model.domain,
            prover: Prover::new(model),
            smallest: SMALLEST_BOX * extent.scale(),
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
            let size =
                cell.sides.iter().fold(0.0, |size: f64, side| size.max(side.high - side.low));
            if boxes_left == 0 || size < self.smallest {
                return false;
            }
            boxes_left -= 1;
            pending.extend(halves(cell));
        }
        true
    }
}
