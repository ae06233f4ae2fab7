//! Polynomials with enclosed coefficients, for their values over boxes.

use super::interval::{Cell, Interval, ZERO};
use super::polynomial::Monomial;

/// A polynomial whose coefficients are enclosed once, to enclose its values over many boxes.
#[derive(Clone, Debug)]
pub(crate) struct EnclosedPolynomial(Vec<(Monomial, Interval)>);

impl EnclosedPolynomial {
    pub(super) fn new(terms: Vec<(Monomial, Interval)>) -> EnclosedPolynomial {
        EnclosedPolynomial(terms)
    }

    /// Encloses the values over a box, as [`Polynomial::over`](super::polynomial::Polynomial::over) does.
    pub(crate) fn over(&self, cell: &Cell) -> Interval {
        enclosed_sum(self.0.iter().map(|(monomial, value)| (monomial, *value)), bases(cell))
    }
}

/// Returns the enclosures of d, x, y and z in a box.
pub(super) fn bases(cell: &Cell) -> [Interval; 4] {
    [cell.radius(), cell.sides[0], cell.sides[1], cell.sides[2]]
}

/// Encloses a sum of monomials with enclosed coefficients.
pub(super) fn enclosed_sum<'t>(
    terms: impl Iterator<Item = (&'t Monomial, Interval)>,
    bases: [Interval; 4],
) -> Interval {
    let term = |(monomial, value): (&Monomial, Interval)| {
        let powers = monomial.iter().zip(bases).filter(|(exponent, _)| **exponent > 0);
        powers.fold(value, |product, (exponent, base)| product.times(base.power(*exponent)))
    };
    terms.map(term).fold(ZERO, Interval::plus)
}
