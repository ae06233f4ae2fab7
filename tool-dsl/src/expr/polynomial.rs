//! Expressions as polynomials of the coordinates, where they are such: to recognise curves that
//! are equal up to a factor.

use super::{Coord, Graph, Id, Node};
use crate::number::Number;
use std::collections::{BTreeMap, HashMap};

/// Exponents of (d, x, y, z); d² is the same as x² + y² only outside this module.
pub(crate) type Monomial = [u8; 4];

/// The exponents of one coordinate alone; of the file's unit of length, none.
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

/// A sum of monomials.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial(BTreeMap<Monomial, Number>);

/// The highest degree that is recognised.
const DEGREE: u8 = 8;

/// The polynomials that nodes are, each found once.
#[derive(Default)]
pub(crate) struct Polynomials(HashMap<Id, Option<Polynomial>>);

impl Polynomials {
    /// The polynomial that a node is, if it is one.
    pub(crate) fn of(&mut self, graph: &Graph, id: Id) -> Option<&Polynomial> {
        let mut open = vec![id];
        while let Some(id) = open.last().copied() {
            let before = open.len();
            open.extend(graph.node(id).operands().filter(|operand| !self.0.contains_key(operand)));
            if open.len() == before {
                let polynomial = Polynomial::node(graph.node(id), |operand| self.known(*operand));
                self.0.insert(id, polynomial);
                open.pop();
            }
        }
        self.known(id)
    }

    /// That of a node which was asked for, or of one that such a node needs.
    pub(crate) fn known(&self, id: Id) -> Option<&Polynomial> {
        self.0.get(&id)?.as_ref()
    }
}

impl Polynomial {
    /// The polynomial that a node is, if it is one.
    pub fn of(graph: &Graph, id: Id) -> Option<Polynomial> {
        let mut all = Polynomials::default();
        all.of(graph, id);
        all.0.remove(&id).flatten()
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

    fn scaled(&self, factor: &Number) -> Polynomial {
        Polynomial(self.0.iter().map(|(m, c)| (*m, c * factor)).collect())
    }

    fn plus(mut self, other: &Polynomial) -> Polynomial {
        for (monomial, value) in &other.0 {
            let sum = match self.0.get(monomial) {
                Some(own) if own.agrees(&-value) => Number::int(0),
                Some(own) => own + value,
                None => value.clone(),
            };
            self.0.insert(*monomial, sum);
        }
        self.0.retain(|_, value| !value.is_zero());
        self
    }

    fn times(&self, other: &Polynomial) -> Option<Polynomial> {
        let mut product = Polynomial(BTreeMap::new());
        for (left, a) in &self.0 {
            for (right, b) in &other.0 {
                let mut monomial = *left;
                for (sum, more) in monomial.iter_mut().zip(right) {
                    *sum += more;
                }
                if monomial.iter().sum::<u8>() > DEGREE {
                    return None;
                }
                product = product.plus(&Polynomial(BTreeMap::from([(monomial, a * b)])));
            }
        }
        Some(product)
    }

    /// The sum of its terms: what cancels is gone from it.
    pub fn expression(&self, graph: &mut Graph) -> Id {
        let mut sum = graph.int(0);
        for (monomial, factor) in &self.0 {
            let mut term = graph.number(factor.clone());
            for (exponent, coord) in monomial.iter().zip([Coord::D, Coord::X, Coord::Y, Coord::Z]) {
                let base = graph.coord(coord);
                // Powers of a coordinate exist.
                let power = graph.power(base, 2 * i32::from(*exponent)).unwrap_or(base);
                term = graph.mul(term, power);
            }
            sum = graph.add(sum, term);
        }
        sum
    }

    /// The factor by which `self` is `other`, if it is a multiple of it.
    pub fn ratio(&self, other: &Polynomial) -> Option<Number> {
        if !self.0.keys().eq(other.0.keys()) {
            return None;
        }
        let leads = (self.0.first_key_value()?.1, other.0.first_key_value()?.1);
        let about = leads.0.to_f64() / leads.1.to_f64();
        let near = |(a, b): (&Number, &Number)| {
            let (a, b) = (a.to_f64(), b.to_f64() * about);
            (a - b).abs() <= 1e-9 * (a.abs() + b.abs())
        };
        // Most curves differ in the first digits.
        if !self.0.values().zip(other.0.values()).all(near) {
            return None;
        }
        let factor = leads.0.over(leads.1)?;
        let same = self.0.values().zip(other.0.values()).all(|(a, b)| a.agrees(&(b * &factor)));
        same.then_some(factor)
    }

    /// The value, if nothing but a constant is left.
    pub fn constant(&self) -> Option<Number> {
        match self.0.len() {
            0 => Some(Number::int(0)),
            1 => self.0.get(&[0; 4]).cloned(),
            _ => None,
        }
    }

    /// The factor, if this is a multiple of d.
    pub fn multiple_of_d(&self) -> Option<&Number> {
        if self.0.len() == 1 { self.0.get(&[1, 0, 0, 0]) } else { None }
    }

    /// The terms.
    pub fn terms(&self) -> impl Iterator<Item = (Monomial, &Number)> {
        self.0.iter().map(|(monomial, value)| (*monomial, value))
    }
}
