//! Depths in their usual form, a polynomial and at most one root: `l + k √P`. Whether they vanish or agree on
//! a curve can then be decided exactly, up to the 256 bits of constants.

use crate::expr::interval::{Cell, Interval};
use crate::expr::polynomial::{Polynomial, Polynomials};
use crate::expr::{Graph, Id, Node};
use crate::formula::{NEGATIVE, POSITIVE, Signs};
use crate::number::Number;
use std::collections::HashMap;

/// `l + k √P`: `l` is the polynomial and `k √P` the root.
#[derive(Clone, Debug)]
pub(super) struct RootForm {
    polynomial: Polynomial,
    root: Option<RootTerm>,
}

/// `k √P`: `k` is the factor and `P` the radicand.
#[derive(Clone, Debug)]
pub(super) struct RootTerm {
    pub(super) factor: Number,
    pub(super) radicand: Polynomial,
}

impl RootTerm {
    /// Returns the root with another factor, unless that is 0.
    fn with_factor(&self, factor: Number) -> Option<RootTerm> {
        (!factor.is_zero()).then(|| RootTerm { factor, radicand: self.radicand.clone() })
    }

    fn scaled(&self, by: &Number) -> RootTerm {
        RootTerm { factor: &self.factor * by, radicand: self.radicand.clone() }
    }

    /// Returns `k² P`.
    fn square(&self) -> Polynomial {
        self.radicand.scaled(&(&self.factor * &self.factor))
    }

    fn has_radicand_of(&self, other: &RootTerm) -> bool {
        let ratio = self.radicand.ratio(&other.radicand);
        ratio.is_some_and(|ratio| ratio.nearly_equals(&Number::int(1)))
    }
}

/// The agreement of two depths on a curve.
#[derive(Clone, Debug)]
pub(super) struct Agreement {
    /// True if their slopes agree too.
    pub(super) smooth: bool,
    /// A polynomial that is at least 0 where the depths agree, rather than one with the other's opposite
    /// branch.
    pub(super) branch: Option<Polynomial>,
    /// The smaller of the two on each side of the curve, if that is known.
    pub(super) order: Option<Order>,
}

/// The side of a curve on which the first of two depths is the smaller.
#[derive(Clone, Debug)]
pub(super) struct Order {
    /// True if that is where the curve is positive.
    falls: bool,
    /// Forms that must be positive for this to hold.
    positive: Vec<RootForm>,
}

impl Order {
    /// Returns whether, in a box where a curve has these signs, the first of two depths is nowhere larger
    /// than the second; nowhere smaller if `is_swapped` is set.
    pub(super) fn is_lesser(&self, is_swapped: bool, signs: Signs, cell: &Cell) -> bool {
        let other_side = if self.falls != is_swapped { NEGATIVE } else { POSITIVE };
        signs & other_side == 0 && self.positive.iter().all(|form| form.over_box(cell).low > 0.0)
    }
}

/// A difference of two forms, with roots eliminated by squaring.
pub(super) struct Difference {
    /// A polynomial that is 0 wherever the difference is.
    squared: Polynomial,
    /// A polynomial that is not negative where the difference is 0.
    branch: Option<Polynomial>,
    /// True if the difference has the opposite sign of `squared` where `branch` and `positive` are positive.
    is_opposite: bool,
    positive: Option<RootForm>,
}

impl Difference {
    /// Returns how the two forms agree wherever a curve's polynomial is zero, if they do.
    pub(super) fn agreement_on(&self, curve: &Polynomial) -> Option<Agreement> {
        let Difference { squared, branch, is_opposite, positive } = self;
        // A difference that is a multiple of the curve's square has a slope of 0 on the curve.
        let is_square = curve.times(curve).is_some_and(|square| squared.ratio(&square).is_some());
        let (smooth, ratio) = (squared.is_zero() || is_square, squared.ratio(curve));
        let agrees = smooth || ratio.is_some() || squared.vanishes_on_line(curve);
        agrees.then(|| Agreement {
            smooth,
            // Squaring also finds where a form agrees with another's opposite branch.
            branch: branch.clone(),
            // Only a simple multiple of the curve changes its sign there.
            order: ratio.map(|ratio| Order {
                falls: ratio.is_negative() != *is_opposite,
                positive: branch
                    .iter()
                    .map(RootForm::from_polynomial)
                    .chain(positive.clone())
                    .collect(),
            }),
        })
    }
}

/// The forms of nodes, each computed once.
pub(super) struct Forms<'g> {
    graph: &'g Graph,
    polynomials: Polynomials,
    forms: HashMap<Id, Option<RootForm>>,
}

impl<'g> Forms<'g> {
    pub(super) fn new(graph: &'g Graph) -> Forms<'g> {
        Forms { graph, polynomials: Polynomials::default(), forms: HashMap::new() }
    }

    /// Returns the form of a node, if it has one.
    pub(super) fn of(&mut self, id: Id) -> Option<RootForm> {
        for id in self.graph.dependencies([id]) {
            if !self.forms.contains_key(&id) {
                let form = self.node(id);
                self.forms.insert(id, form);
            }
        }
        self.forms.get(&id).cloned().flatten()
    }

    fn node(&mut self, id: Id) -> Option<RootForm> {
        if let Some(polynomial) = self.polynomials.of(self.graph, id) {
            return Some(RootForm::from_polynomial(polynomial));
        }
        let of = |id: &Id| self.forms.get(id)?.as_ref();
        match self.graph.node(id) {
            Node::Sqrt(a) => {
                let radicand = of(a)?.polynomial()?.clone();
                Some(RootForm::new(Polynomial::zero(), Number::int(1), radicand))
            }
            Node::Neg(a) => Some(of(a)?.scaled(&Number::int(-1))),
            Node::Add(a, b) => of(a)?.plus(of(b)?),
            Node::Sub(a, b) => of(a)?.plus(&of(b)?.scaled(&Number::int(-1))),
            Node::Mul(a, b) => match (self.graph.constant(*a), self.graph.constant(*b)) {
                (Some(factor), _) => Some(of(b)?.scaled(factor)),
                (_, Some(factor)) => Some(of(a)?.scaled(factor)),
                _ if a == b => of(a)?.square(),
                _ => None,
            },
            Node::Div(a, b) | Node::Quotient(a, b) => of(a)?.over(of(b)?),
            _ => None,
        }
    }
}

impl RootForm {
    /// Returns `polynomial + factor √radicand`.
    pub(super) fn new(polynomial: Polynomial, factor: Number, radicand: Polynomial) -> RootForm {
        RootForm { polynomial, root: Some(RootTerm { factor, radicand }) }
    }

    /// Returns the form 0.
    pub(super) fn zero() -> RootForm {
        RootForm { polynomial: Polynomial::zero(), root: None }
    }

    /// Returns a polynomial that is zero wherever the form is. A second polynomial, if present, must be
    /// positive for the first to have the form's sign too.
    pub(super) fn curve(&self) -> Option<(Polynomial, Option<Polynomial>)> {
        let Some(root) = &self.root else { return Some((self.polynomial.clone(), None)) };
        // (l + k √P) (l - k √P) = l² - k² P. The second factor has the sign of l where k has the opposite
        // sign.
        let sign = Number::int(if root.factor.is_negative() { 1 } else { -1 });
        Some((self.times_conjugate()?.scaled(&sign), Some(self.polynomial.scaled(&sign))))
    }

    /// Returns `l² - k² P`, if there is a root.
    fn times_conjugate(&self) -> Option<Polynomial> {
        let square = self.root.as_ref()?.square();
        Some(self.polynomial.times(&self.polynomial)?.plus(&square.scaled(&Number::int(-1))))
    }

    fn scaled(&self, factor: &Number) -> RootForm {
        RootForm {
            polynomial: self.polynomial.scaled(factor),
            root: self.root.as_ref().map(|root| root.scaled(factor)),
        }
    }

    fn plus(&self, other: &RootForm) -> Option<RootForm> {
        let root = match (&self.root, &other.root) {
            (root, None) | (None, root) => root.clone(),
            (Some(a), Some(b)) if a.has_radicand_of(b) => a.with_factor(&a.factor + &b.factor),
            _ => return None,
        };
        Some(RootForm { polynomial: self.polynomial.clone().plus(&other.polynomial), root })
    }

    /// `(c + k √P)² = c² + k² P + 2 c k √P`
    fn square(&self) -> Option<RootForm> {
        // With a polynomial for `c`, the product `2 c k` would not be a constant factor of the root.
        let (c, root) = (self.polynomial.constant()?, self.root.as_ref()?);
        let polynomial = Polynomial::from_constant(&(&c * &c)).plus(&root.square());
        let doubled = &(&Number::int(2) * &c) * &root.factor;
        Some(RootForm { polynomial, root: root.with_factor(doubled) })
    }

    /// `(m² - k² P) γ / (m + k √P) = γ (m - k √P)`, the form in which depths below flat arcs are written.
    fn over(&self, divisor: &RootForm) -> Option<RootForm> {
        let dividend = self.polynomial()?;
        let Some(root) = &divisor.root else {
            // A quotient by a polynomial that is not constant has no such form.
            let divisor = divisor.polynomial.constant()?;
            return Some(self.scaled(&Number::int(1).checked_div(&divisor)?));
        };
        let conjugate = RootForm {
            polynomial: divisor.polynomial.clone(),
            root: Some(root.scaled(&Number::int(-1))),
        };
        Some(conjugate.scaled(&dividend.ratio(&divisor.times_conjugate()?)?))
    }

    /// Returns the difference of two forms, with roots eliminated by squaring.
    pub(super) fn difference(&self, other: &RootForm) -> Option<Difference> {
        let minus = Number::int(-1);
        if let Some(difference) = self.plus(&other.scaled(&minus)) {
            // l + k √P = 0 where l² = k² P and l does not have the sign of k.
            let (squared, branch) = difference.curve()?;
            return Some(Difference { squared, branch, is_opposite: false, positive: None });
        }
        let (a, b) = (self.root.as_ref()?, other.root.as_ref()?);
        let constant_difference =
            self.polynomial.clone().plus(&other.polynomial.scaled(&minus)).constant()?;
        let squares_difference = a.square().plus(&b.square().scaled(&minus));
        if constant_difference.is_zero() {
            let is_opposite = a.factor.is_negative();
            // `k √P - m √Q` with factors of opposite sign is 0 only where both roots are.
            let same_sign = is_opposite == b.factor.is_negative();
            return same_sign.then_some(Difference {
                squared: squares_difference,
                branch: None,
                is_opposite,
                positive: None,
            });
        }
        // With u = c + k √P, u² - m² Q = L + 2 c k √P where L = c² + k² P - m² Q. It is 0 where L is -2 c k
        // √P. There L² - 4 c² k² P has its sign if c k is negative, else the opposite one. Where u has the
        // sign of m, u - m √Q has the sign of m (u² - m² Q).
        let square = &constant_difference * &constant_difference;
        let leading = squares_difference.plus(&Polynomial::from_constant(&square));
        let squared =
            leading.times(&leading)?.plus(&a.square().scaled(&(&Number::int(-4) * &square)));
        let same = constant_difference.is_negative() == a.factor.is_negative();
        let branch = Some(leading.scaled(&Number::int(if same { -1 } else { 1 })));
        let first = RootForm {
            polynomial: Polynomial::from_constant(&constant_difference),
            root: Some(a.clone()),
        };
        let is_negative = b.factor.is_negative();
        let positive = Some(first.scaled(&Number::int(if is_negative { -1 } else { 1 })));
        Some(Difference { squared, branch, is_opposite: same != is_negative, positive })
    }

    /// Returns a polynomial as a form.
    pub(super) fn from_polynomial(polynomial: &Polynomial) -> RootForm {
        RootForm { polynomial: polynomial.clone(), root: None }
    }

    /// Encloses the form over a box.
    pub(super) fn over_box(&self, cell: &Cell) -> Interval {
        let polynomial = self.polynomial.over(cell);
        let Some(RootTerm { factor, radicand }) = &self.root else { return polynomial };
        polynomial.plus(Interval::enclosing(factor).times(radicand.over(cell).sqrt()))
    }

    /// Returns polynomials in the direction of the form's gradient or its opposite, for each of a monomial's
    /// four coordinates.
    pub(super) fn gradient_direction(&self) -> Option<[Polynomial; 4]> {
        let radicand = match &self.root {
            None => &self.polynomial,
            // The gradient of `c + k √P` is that of `P`, up to a factor that is not 0.
            Some(root) => self.polynomial.constant().map(|_| &root.radicand)?,
        };
        Some([0, 1, 2, 3].map(|by| radicand.derivative(by)))
    }

    /// Returns the polynomial, without the root.
    pub(super) fn part(&self) -> &Polynomial {
        &self.polynomial
    }

    /// Returns the root, if there is one.
    pub(super) fn root(&self) -> Option<&RootTerm> {
        self.root.as_ref()
    }

    /// Returns the polynomial, if the form has no root.
    pub(super) fn polynomial(&self) -> Option<&Polynomial> {
        self.root.is_none().then_some(&self.polynomial)
    }

    /// Returns whether this is a root without further terms: nowhere below 0, and smooth except where it is
    /// 0.
    pub(super) fn is_length(&self) -> bool {
        self.polynomial.is_zero()
            && self.root.as_ref().is_some_and(|root| !root.factor.is_negative())
    }

    /// Returns whether this is a distance: `c ± |p - centre|`, or a linear function with a gradient of length
    /// 1.
    pub(super) fn is_distance(&self) -> bool {
        match &self.root {
            None => {
                self.polynomial.slope_squared().is_some_and(|s| s.nearly_equals(&Number::int(1)))
            }
            Some(root) => {
                root.factor.abs().nearly_equals(&Number::int(1))
                    && self.polynomial.constant().is_some()
                    && root.radicand.is_squared_distance()
            }
        }
    }
}
