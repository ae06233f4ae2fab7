//! Expressions as polynomials in the coordinates, where they are polynomials, to recognise curves that are
//! equal up to a factor.

use super::interval::{Cell, Interval, ZERO};
use super::{Coord, Graph, Id, Node};
use crate::number::{NEAR_IN_DOUBLES, Number, ROUNDING};
use std::collections::{BTreeMap, HashMap};

/// The exponents of (d, x, y, z). Within this module d² and x² + y² are different polynomials.
pub type Monomial = [u8; 4];

/// Returns the exponents of one coordinate alone; all 0 for the file's unit of length.
pub(crate) fn monomial_of(coord: Coord) -> Monomial {
    match coord {
        Coord::D => [1, 0, 0, 0],
        Coord::Q => [2, 0, 0, 0],
        Coord::X => [0, 1, 0, 0],
        Coord::Y => [0, 0, 1, 0],
        Coord::Z => [0, 0, 0, 1],
        Coord::Length | Coord::PerLength => [0; 4],
    }
}

/// A sum of monomials with constant coefficients.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial(BTreeMap<Monomial, Number>);

/// The highest degree that is recognised.
const MAX_DEGREE: u8 = 8;

/// The polynomials of nodes, each computed once.
#[derive(Default)]
pub(crate) struct Polynomials(HashMap<Id, Option<Polynomial>>);

impl Polynomials {
    /// Returns the polynomial of a node, if it is one.
    pub(crate) fn of(&mut self, graph: &Graph, id: Id) -> Option<&Polynomial> {
        let mut pending: Vec<Id> =
            Some(id).filter(|id| !self.0.contains_key(id)).into_iter().collect();
        while let Some(id) = pending.last().copied() {
            let before = pending.len();
            pending
                .extend(graph.node(id).operands().filter(|operand| !self.0.contains_key(operand)));
            if pending.len() == before {
                let polynomial = Polynomial::node(graph.node(id), |operand| self.known(*operand));
                self.0.insert(id, polynomial);
                pending.pop();
            }
        }
        self.known(id)
    }

    /// Returns the polynomial of a node that was requested before, or that such a node needs.
    pub(crate) fn known(&self, id: Id) -> Option<&Polynomial> {
        self.0.get(&id)?.as_ref()
    }
}

impl Polynomial {
    /// Returns the polynomial of a node, if it is one.
    pub fn from_expression(graph: &Graph, id: Id) -> Option<Polynomial> {
        let mut polynomials = Polynomials::default();
        polynomials.of(graph, id);
        polynomials.0.remove(&id).flatten()
    }

    fn node<'p>(node: &Node, of: impl Fn(&Id) -> Option<&'p Polynomial>) -> Option<Polynomial> {
        let single = |monomial, value: Number| Polynomial(BTreeMap::from([(monomial, value)]));
        Some(match node {
            Node::Const(value) => single([0; 4], value.clone()),
            Node::Coord(Coord::Length | Coord::PerLength) => return None,
            Node::Coord(coord) => single(monomial_of(*coord), Number::int(1)),
            Node::Neg(a) => of(a)?.scaled(&Number::int(-1)),
            Node::Add(a, b) => of(a)?.clone().plus(of(b)?),
            Node::Sub(a, b) => of(a)?.clone().plus(&of(b)?.scaled(&Number::int(-1))),
            Node::Mul(a, b) => of(a)?.times(of(b)?)?,
            _ => return None,
        })
    }

    pub(crate) fn scaled(&self, factor: &Number) -> Polynomial {
        Polynomial(self.0.iter().map(|(m, c)| (*m, c * factor)).collect())
    }

    pub(crate) fn plus(mut self, other: &Polynomial) -> Polynomial {
        for (monomial, value) in &other.0 {
            let sum = match self.0.get(monomial) {
                Some(own) if own.nearly_equals(&-value) => Number::int(0),
                Some(own) => own + value,
                None => value.clone(),
            };
            self.0.insert(*monomial, sum);
        }
        self.0.retain(|_, value| !value.is_zero());
        self
    }

    pub(crate) fn times(&self, other: &Polynomial) -> Option<Polynomial> {
        let mut product = Polynomial(BTreeMap::new());
        for (left, a) in &self.0 {
            for (right, b) in &other.0 {
                let mut monomial = *left;
                for (sum, more) in monomial.iter_mut().zip(right) {
                    *sum += more;
                }
                if monomial.iter().sum::<u8>() > MAX_DEGREE {
                    return None;
                }
                product = product.plus(&Polynomial(BTreeMap::from([(monomial, a * b)])));
            }
        }
        Some(product)
    }

    /// Returns the zero polynomial.
    pub(crate) fn zero() -> Polynomial {
        Polynomial(BTreeMap::new())
    }

    /// Returns a constant polynomial.
    pub(crate) fn from_constant(value: &Number) -> Polynomial {
        Polynomial::zero().plus(&Polynomial(BTreeMap::from([([0; 4], value.clone())])))
    }

    /// Returns a coordinate as a polynomial.
    pub(crate) fn coordinate(coord: Coord) -> Polynomial {
        Polynomial(BTreeMap::from([(monomial_of(coord), Number::int(1))]))
    }

    /// Returns whether this provably vanishes on a straight line: after its equation is solved for a
    /// coordinate and substituted. False for a curve that is not straight.
    pub(crate) fn vanishes_on_line(&self, line: &Polynomial) -> bool {
        !self.differs_from_0_on(line)
            && self.on_line(line).is_some_and(|remainder| remainder.0.is_empty())
    }

    /// Returns whether an enclosure at one point of a straight line excludes 0. No restriction to that line
    /// is 0 then, so that the substitution need not be tried. The point has no special place in a tool.
    fn differs_from_0_on(&self, line: &Polynomial) -> bool {
        const POINT: [f64; 4] = [0.813, 1.377, -0.639, 2.179];
        let mut point = POINT.map(|at| Interval::new(at, at));
        let sloped = line.0.iter().filter(|(monomial, _)| monomial.iter().sum::<u8>() == 1);
        let Some((leading, factor)) = sloped
            .max_by(|(_, a), (_, b)| a.to_f64().abs().total_cmp(&b.to_f64().abs()))
            .filter(|_| line.is_linear())
        else {
            return false;
        };
        let Some(axis) = leading.iter().position(|exponent| *exponent == 1) else { return false };
        point[axis] = ZERO;
        let rest = line.at(point).negated();
        point[axis] = rest.times(Interval::enclosing(factor).reciprocal());
        let value = self.at(point);
        value.low > 0.0 || value.high < 0.0
    }

    /// Returns whether this is the zero polynomial.
    pub(crate) fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the restriction to a straight line, with one coordinate less; `None` if the other polynomial
    /// is not linear in one.
    pub(crate) fn on_line(&self, line: &Polynomial) -> Option<Polynomial> {
        let (leading, factor) = line.leading_term()?;
        let axis = leading.iter().position(|exponent| *exponent == 1)?;
        // leader = -(the rest) / factor
        let mut rest = line.clone();
        rest.0.remove(&leading);
        let rest = rest.scaled(&Number::int(-1).checked_div(factor)?);
        let mut remainder = Polynomial::zero();
        for (monomial, value) in &self.0 {
            let mut others = *monomial;
            let power = std::mem::take(&mut others[axis]);
            let mut term = Polynomial(BTreeMap::from([(others, value.clone())]));
            for _ in 0..power {
                term = term.times(&rest)?;
            }
            remainder = remainder.plus(&term);
        }
        // A coefficient that nearly cancels is rounding error of the 256-bit constants.
        let largest = self.0.values().map(|value| value.to_f64().abs()).fold(0.0, f64::max);
        remainder.0.retain(|_, value| value.to_f64().abs() > largest * ROUNDING);
        Some(remainder)
    }

    /// Returns the term of degree 1 with the largest coefficient, whose coordinate [`Polynomial::on_line`] replaces, or
    /// the last of several; `None` if the polynomial is constant or not linear.
    fn leading_term(&self) -> Option<(Monomial, &Number)> {
        let sloped = self.0.iter().filter(|(monomial, _)| monomial.iter().sum::<u8>() == 1);
        let (monomial, factor) = sloped.max_by(|(_, a), (_, b)| a.abs().cmp(&b.abs()))?;
        self.is_linear().then_some((*monomial, factor))
    }

    /// Encloses the values over a box.
    pub(crate) fn over(&self, cell: &Cell) -> Interval {
        self.at(bases(cell))
    }

    /// Encloses the values where d, x, y and z have these enclosures.
    fn at(&self, bases: [Interval; 4]) -> Interval {
        let terms = self.0.iter().map(|(monomial, value)| (monomial, Interval::enclosing(value)));
        enclosed_sum(terms, bases)
    }

    /// Returns the coefficient of a monomial, rounded to a double.
    pub(crate) fn factor(&self, monomial: Monomial) -> f64 {
        self.0.get(&monomial).map_or(0.0, Number::to_f64)
    }

    /// Returns whether the degree is at most 1.
    pub(crate) fn is_linear(&self) -> bool {
        self.0.keys().all(|monomial| monomial.iter().sum::<u8>() <= 1)
    }

    /// Returns the polynomial scaled to a gradient of length 1, if it is linear and not constant.
    pub(crate) fn with_unit_slope(&self) -> Option<Polynomial> {
        Some(self.scaled(&Number::int(1).checked_div(&self.slope_squared()?.sqrt()?)?))
    }

    /// Returns the squared length of the gradient, if this is linear.
    pub(crate) fn slope_squared(&self) -> Option<Number> {
        let mut sum = Number::int(0);
        for (monomial, value) in &self.0 {
            match monomial.iter().sum::<u8>() {
                0 => {}
                1 => sum = &sum + &(value * value),
                _ => return None,
            }
        }
        Some(sum)
    }

    /// Returns the derivative by one of a monomial's four coordinates, given by index.
    pub(crate) fn derivative(&self, by: usize) -> Polynomial {
        let mut sum = Polynomial::zero();
        for (monomial, value) in &self.0 {
            if monomial[by] > 0 {
                let mut lower = *monomial;
                lower[by] -= 1;
                sum.0.insert(lower, value * &Number::int(i64::from(monomial[by])));
            }
        }
        sum
    }

    /// Returns whether this is the squared distance from a point, in d and z or in x, y and z.
    pub(crate) fn is_squared_distance(&self) -> bool {
        let (one, four) = (Number::int(1), Number::int(4));
        let mut sum = Number::int(0);
        for (monomial, value) in &self.0 {
            match (monomial.iter().sum::<u8>(), monomial.iter().max()) {
                (2, Some(2)) if value.nearly_equals(&one) => {}
                (1, _) => sum = &sum + &(value * value),
                (0, _) => {}
                _ => return false,
            }
        }
        // p - m² with the centre m leaves nothing except the squares. Each linear term needs the square of
        // its coordinate.
        let is_complete = self.0.keys().all(|monomial| {
            monomial.iter().sum::<u8>() != 1 || self.0.contains_key(&monomial.map(|e| 2 * e))
        });
        let constant = self.0.get(&[0; 4]).cloned().unwrap_or_else(|| Number::int(0));
        let middle = sum.checked_div(&four).unwrap_or_else(|| Number::int(0));
        let rounding = (&constant - &middle).to_f64().abs();
        is_complete && rounding <= 2f64.powi(-180) * (1.0 + constant.to_f64().abs())
    }

    /// Writes the sum of its terms as an expression, without the terms that cancelled.
    pub fn to_expression(&self, graph: &mut Graph) -> Id {
        let mut sum = graph.int(0);
        for (monomial, factor) in &self.0 {
            let mut term = graph.number(factor.clone());
            for (exponent, coord) in monomial.iter().zip([Coord::D, Coord::X, Coord::Y, Coord::Z]) {
                let base = graph.coord(coord);
                // Nonnegative integer powers of a coordinate always exist.
                let power = graph.power(base, 2 * i32::from(*exponent)).unwrap_or(base);
                term = graph.mul(term, power);
            }
            sum = graph.add(sum, term);
        }
        sum
    }

    /// Returns the ratio of the last coefficient to the first, which multiples have too; `None` for 0.
    pub(crate) fn proportion(&self) -> Option<f64> {
        let (first, last) = (self.0.first_key_value()?.1, self.0.last_key_value()?.1);
        Some(last.to_f64() / first.to_f64())
    }

    /// Returns the factor `f` of `self = f · other`, if `self` is a multiple of `other`.
    pub fn ratio(&self, other: &Polynomial) -> Option<Number> {
        if !self.0.keys().eq(other.0.keys()) {
            return None;
        }
        let leads = (self.0.first_key_value()?.1, other.0.first_key_value()?.1);
        let ratio = leads.0.to_f64() / leads.1.to_f64();
        // A comparison of doubles rejects most curves cheaply.
        let are_near = self.0.values().zip(other.0.values()).all(|(a, b)| {
            let (a, b) = (a.to_f64(), b.to_f64() * ratio);
            (a - b).abs() <= NEAR_IN_DOUBLES * (a.abs() + b.abs())
        });
        if !are_near {
            return None;
        }
        let factor = leads.0.checked_div(leads.1)?;
        let same =
            self.0.values().zip(other.0.values()).all(|(a, b)| a.nearly_equals(&(b * &factor)));
        same.then_some(factor)
    }

    /// Returns the value, if the polynomial is constant.
    pub fn constant(&self) -> Option<Number> {
        match self.0.len() {
            0 => Some(Number::int(0)),
            1 => self.0.get(&[0; 4]).cloned(),
            _ => None,
        }
    }

    /// Returns the factor, if this is a multiple of d.
    pub fn multiple_of_d(&self) -> Option<&Number> {
        if self.0.len() == 1 { self.0.get(&[1, 0, 0, 0]) } else { None }
    }

    /// Returns `a (d - r)` for `a (d² - r²)`, which has the same sign, since `d` is not negative.
    pub(crate) fn without_square_of_d(&self) -> Option<Polynomial> {
        let (a, constant) = (self.0.get(&[2, 0, 0, 0])?, self.0.get(&[0; 4])?);
        let square = (-constant).checked_div(a).filter(|square| !square.is_negative())?;
        let radius = square.sqrt().filter(|_| self.0.len() == 2)?;
        let difference = Polynomial::coordinate(Coord::D);
        Some(difference.plus(&Polynomial::from_constant(&-&radius)).scaled(a))
    }

    /// Returns the monomials with their coefficients.
    pub fn terms(&self) -> impl Iterator<Item = (Monomial, &Number)> {
        self.0.iter().map(|(monomial, value)| (*monomial, value))
    }
}

/// Returns the enclosures of d, x, y and z in a box.
fn bases(cell: &Cell) -> [Interval; 4] {
    [cell.radius(), cell.sides[0], cell.sides[1], cell.sides[2]]
}

/// Encloses a sum of monomials with enclosed coefficients.
fn enclosed_sum<'t>(
    terms: impl Iterator<Item = (&'t Monomial, Interval)>,
    bases: [Interval; 4],
) -> Interval {
    terms
        .map(|(monomial, value)| {
            let powers = monomial.iter().zip(bases).filter(|(exponent, _)| **exponent > 0);
            powers.fold(value, |product, (exponent, base)| product.times(base.power(*exponent)))
        })
        .fold(ZERO, Interval::plus)
}
