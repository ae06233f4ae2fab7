//! The curves on which the depths of two owners agree.

use super::super::root::Agreement;
use super::{BorderProver, Pair};
use crate::expr::Node;
use crate::formula::{ANY_SIGN, CurveIndex};
use std::cell::OnceCell;
use std::collections::BTreeSet;
use std::rc::Rc;

impl BorderProver<'_> {
    /// Returns the curves on which the depths of two owners agree.
    pub(super) fn joints(&mut self, pair: Pair) -> Vec<CurveIndex> {
        if let Some(known) = self.joints.get(&pair) {
            return known.clone();
        }
        // The border of neighbours is among their own conditions.
        let mut atoms = Vec::new();
        for owner in [Some(pair.0), pair.1].into_iter().flatten() {
            self.model.regions[owner]
                .inside
                .undecided_atoms(&vec![ANY_SIGN; self.curves.len()], &mut atoms);
        }
        let condition_curves: BTreeSet<CurveIndex> =
            atoms.into_iter().map(|(curve, _)| curve).collect();
        let differences = self.differences(pair);
        let mut joints: Vec<CurveIndex> = differences.iter().map(|(curve, _)| *curve).collect();
        joints.extend(
            condition_curves.into_iter().filter(|curve| self.agreement(pair, *curve).is_some()),
        );
        self.joints.insert(pair, joints.clone());
        joints
    }

    /// Returns how two owners' depths agree on a curve, if they do.
    pub(super) fn agreement(&mut self, pair: Pair, curve: CurveIndex) -> Option<Rc<Agreement>> {
        let row = &mut self.agreements[pair.0];
        row.resize(self.depths.len() + 1, Vec::new());
        let by_curve = &mut row[pair.1.map_or(0, |other| other + 1)];
        by_curve.resize(self.curves.len(), OnceCell::new());
        let agreement = by_curve[curve].get_or_init(|| {
            let difference = self.depth_differences.entry(pair).or_insert_with(|| {
                let other = pair.1.map_or(Some(&self.zero), |other| self.depths[other].as_ref());
                self.depths[pair.0].as_ref()?.difference(other?)
            });
            let (polynomial, _) = self.curves[curve].as_ref()?;
            let square = self.squares[curve].as_ref();
            difference.as_ref()?.agreement_on(polynomial, square).map(Rc::new)
        });
        agreement.clone()
    }

    /// Returns the curves on which two depths are equal, recognised by their expressions or their sums of
    /// roots. Each comes with whether it is positive where the first depth is larger.
    pub(super) fn differences(&mut self, (own, other): Pair) -> Rc<Vec<(CurveIndex, bool)>> {
        let Some(other) = other else { return Rc::default() };
        if let Some(known) = self.differences.get(&[own, other]) {
            return known.clone();
        }
        let graph = &self.model.graph;
        let [a, b] = [own, other].map(|depth| self.ids[depth]);
        let forms = self.depths[own].as_ref().zip(self.depths[other].as_ref());
        let first_is_larger = |curve: CurveIndex| match *graph.node(self.model.curves[curve].value)
        {
            Node::Sub(more, less) if [more, less] == [a, b] => Some(true),
            Node::Sub(more, less) if [more, less] == [b, a] => Some(false),
            _ => {
                let ratio = self.sums[curve].as_ref()?.ratio_to_difference(forms?.0, forms?.1)?;
                Some(!ratio.is_negative())
            }
        };
        let curves = 0..self.model.curves.len();
        let found =
            Rc::new(curves.filter_map(|curve| Some((curve, first_is_larger(curve)?))).collect());
        self.differences.insert([own, other], Rc::clone(&found));
        found
    }
}
