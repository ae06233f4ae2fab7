//! Curves that compare two depths with different roots. They are sums of a polynomial and roots, not
//! polynomials.

use super::root::{Forms, RootForm};
use crate::expr::polynomial::Polynomial;
use crate::expr::{Graph, Id, Node};
use crate::number::Number;

/// `l + k √P + m √Q + …`
#[derive(Clone)]
pub(super) struct RootSum {
    polynomial: Polynomial,
    roots: Vec<(Number, Polynomial)>,
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
        let roots = form.root().map(|(factor, under)| (factor.clone(), under.clone()));
        RootSum { polynomial: form.part().clone(), roots: roots.into_iter().collect() }
    }

    /// Returns the factor by which this is a multiple of the first depth minus the second.
    pub(super) fn ratio_to_difference(&self, a: &RootForm, b: &RootForm) -> Option<Number> {
        let difference = RootSum::from(a).plus(RootSum::from(b).scaled(&Number::int(-1)));
        let (factor, under) = self.roots.first()?;
        let (other, _) = difference.roots.iter().find(|(_, own)| is_same_radicand(own, under))?;
        let ratio = factor.checked_div(other)?;
        let rest = difference.scaled(&-&ratio).plus(self.clone());
        (rest.polynomial.is_zero() && rest.roots.is_empty()).then_some(ratio)
    }

    fn scaled(self, factor_by: &Number) -> RootSum {
        let roots = self.roots.into_iter().map(|(factor, under)| (&factor * factor_by, under));
        RootSum { polynomial: self.polynomial.scaled(factor_by), roots: roots.collect() }
    }

    fn plus(mut self, other: RootSum) -> RootSum {
        for (factor, under) in other.roots {
            match self.roots.iter_mut().find(|(_, own)| is_same_radicand(own, &under)) {
                // A sum that cancels in 256 bits is 0.
                Some((own, _)) if own.nearly_equals(&-&factor) => *own = Number::int(0),
                Some((own, _)) => *own = &*own + &factor,
                None => self.roots.push((factor, under)),
            }
        }
        self.roots.retain(|(factor, _)| !factor.is_zero());
        RootSum { polynomial: self.polynomial.plus(&other.polynomial), roots: self.roots }
    }
}

fn is_same_radicand(a: &Polynomial, b: &Polynomial) -> bool {
    a.ratio(b).is_some_and(|ratio| ratio.nearly_equals(&Number::int(1)))
}
