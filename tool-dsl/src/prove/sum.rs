//! Curves that compare two depths with different roots. They are sums of a polynomial and roots, not
//! polynomials.

use super::root::{Forms, RootForm, RootTerm};
use crate::expr::polynomial::Polynomial;
use crate::expr::{Graph, Id, Node};
use crate::number::Number;

/// `l + k √P + m √Q + …`
#[derive(Clone)]
pub(super) struct RootSum {
    polynomial: Polynomial,
    roots: Vec<RootTerm>,
}

impl RootSum {
    /// Returns a node as such a sum, if it is one.
    pub(super) fn of(graph: &Graph, forms: &mut Forms<'_>, id: Id) -> Option<RootSum> {
        if let Some(form) = forms.of(id) {
            return Some(RootSum::from(&form));
        }
        let mut of = |id: Id| RootSum::of(graph, forms, id);
        match *graph.node(id) {
            Node::Neg(a) => Some(of(a)?.scaled(&Number::int(-1))),
            Node::Add(a, b) => Some(of(a)?.plus(of(b)?)),
            Node::Sub(a, b) => Some(of(a)?.plus(of(b)?.scaled(&Number::int(-1)))),
            Node::Mul(a, b) => match (graph.constant(a), graph.constant(b)) {
                (Some(factor), _) => Some(of(b)?.scaled(factor)),
                (_, Some(factor)) => Some(of(a)?.scaled(factor)),
                _ => None,
            },
            _ => None,
        }
    }

    fn from(form: &RootForm) -> RootSum {
        let roots = form.root().cloned().into_iter().collect();
        RootSum { polynomial: form.part().clone(), roots }
    }

    /// Returns the factor by which this is a multiple of the first depth minus the second.
    pub(super) fn ratio_to_difference(&self, a: &RootForm, b: &RootForm) -> Option<Number> {
        let difference = RootSum::from(a).plus(RootSum::from(b).scaled(&Number::int(-1)));
        let root = self.roots.first()?;
        let other = difference.roots.iter().find(|other| other.has_radicand_of(root))?;
        let ratio = root.factor.checked_div(&other.factor)?;
        let rest = difference.scaled(&-&ratio).plus(self.clone());
        (rest.polynomial.is_zero() && rest.roots.is_empty()).then_some(ratio)
    }

    fn scaled(self, by: &Number) -> RootSum {
        let scaled = |root: RootTerm| RootTerm { factor: &root.factor * by, ..root };
        let roots = self.roots.into_iter().map(scaled).collect();
        RootSum { polynomial: self.polynomial.scaled(by), roots }
    }

    fn plus(mut self, other: RootSum) -> RootSum {
        for root in other.roots {
            match self.roots.iter_mut().find(|own| own.has_radicand_of(&root)) {
                // A sum that cancels in 256 bits is 0.
                Some(own) if own.factor.nearly_equals(&-&root.factor) => {
                    own.factor = Number::int(0);
                }
                Some(own) => own.factor = &own.factor + &root.factor,
                None => self.roots.push(root),
            }
        }
        self.roots.retain(|root| !root.factor.is_zero());
        RootSum { polynomial: self.polynomial.plus(&other.polynomial), roots: self.roots }
    }
}
