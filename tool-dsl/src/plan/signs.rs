//! The plan of regions written by hand. Only their conditions are known, and splits decide them by signs.
//!
//! A side without samples is proved to have no point: by elimination where curves are linear, otherwise by boxes
//! that cover the domain.

use super::{BITS_PER_ADDITION, MAX_TESTS, Tree, bits, costs, too_large};
use crate::bound::{Extent, spread};
use crate::boxes::BoxTree;
use crate::diagnostic::Diagnostic;
use crate::domain::Domain;
use crate::elimination::Linear;
use crate::expr::value::{EvaluationPoint, Evaluator};
use crate::formula::{ANY_SIGN, CurveIndex, NEGATIVE, POSITIVE, Signs, ZERO};
use crate::model::Model;

/// Returns the tree of owners for regions of which only the conditions are known.
///
/// # Errors
/// If the tree would have more than [`MAX_TESTS`] tests.
pub(super) fn by_signs(model: &Model, extent: &Extent) -> Result<Tree, Diagnostic> {
    let samples = samples(model, extent);
    let all_samples: Vec<u32> = (0..samples.len() as u32).collect();
    let costs = costs(model);
    let mut planner = Planner {
        model,
        samples: &samples,
        costs: &costs,
        emptiness: EmptinessProver::new(model, extent),
        tests: 0,
    };
    planner.tree(vec![ANY_SIGN; model.curves.len()], &all_samples)
}

/// A sample point: its side of each curve, and its owner.
struct Sample {
    signs: Vec<Signs>,
    owner: Option<usize>,
}

fn samples(model: &Model, extent: &Extent) -> Vec<Sample> {
    let mut evaluator = Evaluator::new(&model.graph, model.curve_values());
    spread(model.domain, extent, 2000, 0.05)
        .map(|[x, y, z]| {
            evaluator.evaluate(EvaluationPoint::new(x, y, z));
            let mut value = |curve: CurveIndex| evaluator.get(model.curves[curve].value);
            let owner = model.regions.iter().position(|region| region.condition.holds(&mut value));
            let signs = (0..model.curves.len())
                .map(|curve| match value(curve) {
                    v if v < 0.0 => NEGATIVE,
                    v if v > 0.0 => POSITIVE,
                    _ => ZERO,
                })
                .collect();
            Sample { signs, owner }
        })
        .collect()
}

struct Planner<'m> {
    model: &'m Model,
    samples: &'m [Sample],
    costs: &'m [f64],
    emptiness: EmptinessProver<'m>,
    tests: usize,
}

impl Planner<'_> {
    /// Returns the tree for the points at which curves have these signs.
    fn tree(&mut self, mut signs: Vec<Signs>, samples: &[u32]) -> Result<Tree, Diagnostic> {
        loop {
            let possible = self.possible(&signs);
            // All regions but one are excluded, or one contains every such point.
            if let [only] = possible.as_slice() {
                return Ok(Tree::Leaf(*only));
            }
            let (curve, strict) = self.choose(&signs, &possible, samples);
            let (below, above) = sides(signs[curve], strict);
            let samples_on_side = |side: Signs| -> Vec<u32> {
                samples
                    .iter()
                    .copied()
                    .filter(|s| self.samples[*s as usize].signs[curve] & side != 0)
                    .collect()
            };
            let (low, high) = (samples_on_side(below), samples_on_side(above));
            // A side that provably has no point needs no test.
            let with_side = |side| {
                let mut signs = signs.clone();
                signs[curve] = side;
                signs
            };
            if low.is_empty() && self.emptiness.is_empty(&with_side(below)) {
                signs[curve] = above;
                continue;
            }
            if high.is_empty() && self.emptiness.is_empty(&with_side(above)) {
                signs[curve] = below;
                continue;
            }
            self.tests += 1;
            if self.tests > MAX_TESTS {
                return Err(too_large(self.model));
            }
            let below = self.tree(with_side(below), &low)?;
            let above = self.tree(with_side(above), &high)?;
            return Ok(Tree::split(curve, strict, below, above));
        }
    }

    /// Returns the possible owners of points with these signs, in the order of the list.
    fn possible(&self, signs: &[Signs]) -> Vec<Option<usize>> {
        let mut possible = Vec::new();
        for (index, region) in self.model.regions.iter().enumerate() {
            match region.condition.decide(signs) {
                // Regions listed later do not matter: the first that contains a point owns it.
                Some(true) => {
                    possible.push(Some(index));
                    return possible;
                }
                Some(false) => {}
                None => possible.push(Some(index)),
            }
        }
        possible.push(None);
        possible
    }

    /// Returns the next test: a curve, and whether its zeros go above.
    fn choose(
        &self,
        signs: &[Signs],
        possible: &[Option<usize>],
        samples: &[u32],
    ) -> (CurveIndex, bool) {
        let mut atoms = Vec::new();
        for region in possible.iter().flatten() {
            self.model.regions[*region].condition.undecided_atoms(signs, &mut atoms);
        }
        let mut tried: Vec<CurveIndex> = Vec::new();
        let mut best: Option<(f64, CurveIndex)> = None;
        let listed =
            self.model.first_curves.iter().find(|first| atoms.iter().any(|(c, _)| c == *first));
        for (curve, _) in &atoms {
            if tried.contains(curve) {
                continue;
            }
            tried.push(*curve);
            let gain = self.gain(*curve, samples) - BITS_PER_ADDITION * self.costs[*curve];
            if best.is_none_or(|(best_gain, _)| gain > best_gain) {
                best = Some((gain, *curve));
            }
        }
        let curve = listed.copied().or(best.map(|(_, curve)| curve)).unwrap_or(0);
        // The zeros go to the side of the region listed earlier.
        let below = atoms.iter().find(|(c, _)| *c == curve).is_none_or(|(_, below)| *below);
        let strict = match signs[curve] {
            // Only one open side and the zeros are left, and the test must separate these two.
            s if s & (NEGATIVE | POSITIVE) == NEGATIVE => true,
            s if s & (NEGATIVE | POSITIVE) == POSITIVE => false,
            _ => !below,
        };
        (curve, strict)
    }

    /// Returns the information, in bits, that a curve's sign gives about the owners of samples.
    fn gain(&self, curve: CurveIndex, samples: &[u32]) -> f64 {
        let mut counts: Vec<(Option<usize>, [f64; 2])> = Vec::new();
        for sample in samples {
            let sample = &self.samples[*sample as usize];
            let own = sample.owner;
            let side = usize::from(sample.signs[curve] == POSITIVE);
            match counts.iter_mut().find(|(l, _)| *l == own) {
                Some((_, count)) => count[side] += 1.0,
                None => {
                    let mut count = [0.0; 2];
                    count[side] = 1.0;
                    counts.push((own, count));
                }
            }
        }
        information(counts.iter().map(|(_, count)| *count))
    }
}

/// Returns the information, in bits, that a side gives about classes with known weights on the two sides.
fn information(counts: impl Iterator<Item = [f64; 2]> + Clone) -> f64 {
    let totals = counts.clone().fold([0.0; 2], |sum, c| [sum[0] + c[0], sum[1] + c[1]]);
    let total = totals[0] + totals[1];
    if total == 0.0 {
        return 0.0;
    }
    let before: f64 = counts.clone().map(|c| bits(c[0] + c[1], total)).sum();
    let after: f64 = counts.map(|c| bits(c[0], totals[0]) + bits(c[1], totals[1])).sum();
    (before - after) / total
}

/// Returns the signs on the two sides of a test.
fn sides(signs: Signs, strict: bool) -> (Signs, Signs) {
    let below = if strict { NEGATIVE } else { NEGATIVE | ZERO };
    (signs & below, signs & !below)
}

/// The largest number of boxes in one proof, in the half plane and in space.
const MAX_BOXES_IN_HALF_PLANE: usize = 96;
const MAX_BOXES_IN_SPACE: usize = 400;

/// The size of a box, relative to the tool's, at which a proof is given up: it mostly has a point with the signs. Boxes are divided
/// depth first, so such a box is reached soon.
const SMALLEST_BOX: f64 = 1.0 / 4096.0;

/// A prover that combinations of signs are impossible.
struct EmptinessProver<'m> {
    linear: Linear,
    domain: Domain,
    /// The boxes of a cover of the domain, which all proofs share.
    boxes: BoxTree<'m>,
    /// The size of boxes that are not divided further.
    smallest: f64,
    /// The boxes of this size at which proofs were given up.
    smallest_boxes: Vec<usize>,
}

impl<'m> EmptinessProver<'m> {
    fn new(model: &'m Model, extent: &Extent) -> EmptinessProver<'m> {
        let mut boxes = BoxTree::new(model);
        // All points that a query can have.
        boxes.restart(model.domain.bounding_cell(2f64.powi(300)));
        EmptinessProver {
            linear: Linear::new(model),
            domain: model.domain,
            boxes,
            smallest: SMALLEST_BOX * extent.scale(),
            smallest_boxes: Vec::new(),
        }
    }

    /// Returns whether provably no point has these signs.
    fn is_empty(&mut self, signs: &[Signs]) -> bool {
        self.linear.is_contradictory(signs).unwrap_or_else(|| self.is_excluded_by_boxes(signs))
    }

    /// Returns whether no box of a cover of the domain can have the signs.
    fn is_excluded_by_boxes(&mut self, signs: &[Signs]) -> bool {
        let constrained: Vec<(CurveIndex, Signs)> =
            signs.iter().copied().enumerate().filter(|(_, allowed)| *allowed != ANY_SIGN).collect();
        // A proof that has to be given up at a box has been given up by then, whichever boxes come before it: the signs that
        // the box can have are among those of each box that contains it.
        let mut smallest = self.smallest_boxes.iter();
        if smallest.any(|index| has_signs(&mut self.boxes, *index, &constrained)) {
            return false;
        }
        let mut pending = vec![0];
        let mut boxes_left = match self.domain {
            Domain::HalfPlane => MAX_BOXES_IN_HALF_PLANE,
            Domain::Space => MAX_BOXES_IN_SPACE,
        };
        while let Some(index) = pending.pop() {
            if !has_signs(&mut self.boxes, index, &constrained) {
                continue;
            }
            let cell = self.boxes.cell(index);
            let size =
                cell.sides.iter().fold(0.0, |size: f64, side| size.max(side.high - side.low));
            if size < self.smallest {
                self.smallest_boxes.push(index);
                return false;
            }
            if boxes_left == 0 {
                return false;
            }
            boxes_left -= 1;
            pending.extend(self.boxes.halves(index));
        }
        true
    }
}

/// Returns whether curves can have the given signs in a box, each by itself.
fn has_signs(boxes: &mut BoxTree<'_>, index: usize, demands: &[(CurveIndex, Signs)]) -> bool {
    demands.iter().all(|(curve, allowed)| boxes.signs(index, *curve) & allowed != 0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library;

    /// Returns signs that are any for most curves, and vary with a number.
    fn varied_signs(count: usize, number: usize) -> Vec<Signs> {
        let mut state = 0x9E37_79B9_7F4A_7C15u64.wrapping_mul(number as u64 + 1);
        let choices = [NEGATIVE, NEGATIVE | ZERO, POSITIVE, POSITIVE | ZERO, ZERO];
        let sign = |_| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            choices.get((state >> 32) as usize % 12).copied().unwrap_or(ANY_SIGN)
        };
        (0..count).map(sign).collect()
    }

    #[test]
    fn proofs_that_share_boxes_and_contradictions_prove_what_new_ones_prove() {
        let mut excluded = 0;
        for tool in library::tools_by_hand() {
            let mut shared = EmptinessProver::new(&tool.model, &tool.extent);
            for number in 0..300 {
                let signs = varied_signs(tool.model.curves.len(), number);
                let mut new = EmptinessProver::new(&tool.model, &tool.extent);
                let expected = [new.is_empty(&signs), new.is_excluded_by_boxes(&signs)];
                let found = [shared.is_empty(&signs), shared.is_excluded_by_boxes(&signs)];
                assert_eq!(found, expected, "{} {signs:?}", tool.model.name);
                excluded += usize::from(found[1]);
            }
        }
        assert!(excluded > 0);
    }
}
