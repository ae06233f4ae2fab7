//! Formulas for the points of a region: "and" and "or" over the sides of splitting curves.

use crate::expr::interval::Interval;
use crate::expr::{Graph, Id, Node};

/// The index of a curve in a list of curves.
pub type CurveIndex = usize;

/// A splitting curve: the zero set of an expression.
#[derive(Clone, Debug)]
pub struct Curve {
    /// The file's name for it, if it has one.
    pub name: Option<String>,
    /// The expression that is zero on the curve.
    pub value: Id,
}

/// One side of a comparison.
#[derive(Clone, Copy, Debug)]
pub enum Side {
    /// A node's value.
    Node(Id),
    /// A constant.
    Constant(f64),
}

impl Side {
    /// Returns the node, unless the side is a constant.
    pub fn node(&self) -> Option<Id> {
        match *self {
            Side::Node(id) => Some(id),
            Side::Constant(_) => None,
        }
    }
}

impl Curve {
    /// Returns the two sides of `c ≤ 0` as `left ≤ right`. A rounded sum has the sign of its comparison exactly, so
    /// nothing is lost by not adding.
    pub fn sides(&self, graph: &Graph) -> [Side; 2] {
        let operand = |id: Id| {
            let constant = graph.constant(id).map(|value| Side::Constant(value.to_f64()));
            constant.unwrap_or(Side::Node(id))
        };
        match *graph.node(self.value) {
            Node::Sub(a, b) => [operand(a), operand(b)],
            Node::Neg(a) => [Side::Constant(0.0), operand(a)],
            Node::Add(a, b) if let Some(shift) = graph.constant(b) => {
                [operand(a), Side::Constant(-shift.to_f64())]
            }
            _ => [operand(self.value), Side::Constant(0.0)],
        }
    }
}

/// A condition on the signs of curves. Both sides of a curve are closed: `below` means `c ≤ 0`, its opposite `c ≥ 0`.
#[derive(Clone, Debug, PartialEq)]
pub enum Formula {
    /// True everywhere or nowhere.
    Const(bool),
    /// One side of a curve.
    Atom {
        /// The index of the curve.
        curve: CurveIndex,
        /// `c ≤ 0` rather than `c ≥ 0`.
        below: bool,
    },
    /// A conjunction.
    All(Vec<Formula>),
    /// A disjunction.
    Any(Vec<Formula>),
}

/// The possible signs of a curve: a set of `NEGATIVE`, `ZERO` and `POSITIVE`.
pub type Signs = u8;
/// `c < 0`
pub const NEGATIVE: Signs = 1;
/// `c = 0`
pub const ZERO: Signs = 2;
/// `c > 0`
pub const POSITIVE: Signs = 4;
/// All signs are possible.
pub const ANY_SIGN: Signs = 7;

/// Returns the only side of a curve that the signs leave: true for below, also if only 0 is left.
pub(crate) fn one_side(signs: Signs) -> Option<bool> {
    match (signs & NEGATIVE == 0, signs & POSITIVE == 0) {
        (_, true) => Some(true),
        (true, false) => Some(false),
        (false, false) => None,
    }
}

impl Formula {
    /// Returns whether the formula holds where the curves have these values. A NaN is on no side.
    pub fn holds(&self, value: &mut impl FnMut(CurveIndex) -> f64) -> bool {
        match self {
            Formula::Const(constant) => *constant,
            Formula::Atom { curve, below: true } => value(*curve) <= 0.0,
            Formula::Atom { curve, below: false } => value(*curve) >= 0.0,
            Formula::All(parts) => parts.iter().all(|part| part.holds(value)),
            Formula::Any(parts) => parts.iter().any(|part| part.holds(value)),
        }
    }

    /// Returns the curves that the formula mentions.
    pub(crate) fn curves(&self) -> Vec<CurveIndex> {
        match self {
            Formula::Const(_) => Vec::new(),
            Formula::Atom { curve, .. } => vec![*curve],
            Formula::All(parts) | Formula::Any(parts) => {
                parts.iter().flat_map(Formula::curves).collect()
            }
        }
    }

    /// Returns the formula of the points that do not satisfy this one, with the same borders.
    pub(crate) fn opposite(&self) -> Formula {
        let opposites = |parts: &[Formula]| parts.iter().map(Formula::opposite).collect();
        match self {
            Formula::Const(constant) => Formula::Const(!constant),
            Formula::Atom { curve, below } => Formula::Atom { curve: *curve, below: !below },
            Formula::All(parts) => Formula::Any(opposites(parts)),
            Formula::Any(parts) => Formula::All(opposites(parts)),
        }
    }

    /// Returns whether the formula holds; `None` if the known signs do not decide it.
    pub fn decide(&self, signs: &[Signs]) -> Option<bool> {
        self.decide_with(&mut |curve| signs[curve])
    }

    /// The same, where a curve's sign is determined only when it is needed.
    pub fn decide_with(&self, sign: &mut impl FnMut(CurveIndex) -> Signs) -> Option<bool> {
        let mut known = Some(true);
        let (parts, any) = match self {
            Formula::Const(constant) => return Some(*constant),
            Formula::Atom { curve, below } => {
                let inside = side(*below);
                return match sign(*curve) {
                    known if known & !inside == 0 => Some(true),
                    known if known & inside == 0 => Some(false),
                    _ => None,
                };
            }
            Formula::All(parts) => (parts, false),
            Formula::Any(parts) => (parts, true),
        };
        for part in parts {
            match part.decide_with(sign) {
                Some(holds) if holds == any => return Some(any),
                None => known = None,
                _ => {}
            }
        }
        known.map(|_| !any)
    }

    /// Narrows the signs to those of points that satisfy the formula. Only conjunctions of single atoms are
    /// used.
    pub fn narrow_signs(&self, signs: &mut [Signs]) {
        match self {
            Formula::Atom { curve, below } => signs[*curve] &= side(*below),
            Formula::All(parts) => parts.iter().for_each(|part| part.narrow_signs(signs)),
            Formula::Any(parts) if parts.len() == 1 => parts[0].narrow_signs(signs),
            _ => {}
        }
    }

    /// Returns the disjunctions that every point of the formula satisfies, each as a list of alternatives.
    pub fn disjunctions(&self) -> Vec<&[Formula]> {
        match self {
            Formula::All(parts) => parts.iter().flat_map(Formula::disjunctions).collect(),
            Formula::Any(parts) => vec![parts],
            _ => Vec::new(),
        }
    }

    /// Returns the curve of the first undecided atom: the first that [`Formula::undecided_atoms`] lists.
    pub fn first_undecided_curve(&self, signs: &[Signs]) -> Option<CurveIndex> {
        match self {
            Formula::Const(_) => None,
            Formula::Atom { curve, .. } => self.decide(signs).is_none().then_some(*curve),
            Formula::All(parts) | Formula::Any(parts) => self
                .decide(signs)
                .is_none()
                .then(|| parts.iter().find_map(|part| part.first_undecided_curve(signs)))
                .flatten(),
        }
    }

    /// Lists the atoms whose curve is undecided, in order.
    pub fn undecided_atoms(&self, signs: &[Signs], atoms: &mut Vec<(CurveIndex, bool)>) {
        match self {
            Formula::Atom { curve, below } if self.decide(signs).is_none() => {
                atoms.push((*curve, *below));
            }
            Formula::All(parts) | Formula::Any(parts) if self.decide(signs).is_none() => {
                for part in parts {
                    part.undecided_atoms(signs, atoms);
                }
            }
            _ => {}
        }
    }
}

/// Returns the signs of the numbers in an interval.
pub(crate) fn possible(value: Interval) -> Signs {
    let mut signs = 0;
    if value.low < 0.0 {
        signs |= NEGATIVE;
    }
    if value.low <= 0.0 && value.high >= 0.0 {
        signs |= ZERO;
    }
    if value.high > 0.0 {
        signs |= POSITIVE;
    }
    signs
}

/// Returns the signs that an atom allows.
fn side(below: bool) -> Signs {
    if below { NEGATIVE | ZERO } else { POSITIVE | ZERO }
}
