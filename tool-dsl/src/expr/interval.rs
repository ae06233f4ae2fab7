//! Interval enclosures. Every operation rounds outward by one unit in the last place, so that the exact value
//! over a box lies between the ends.

use super::{Coord, EvaluationOrders, Graph, Id, Node};
use crate::number::Number;

/// The numbers between two ends, which are included. A quantity that may be undefined is enclosed by
/// [`ENTIRE`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

/// The interval of 0 alone.
pub const ZERO: Interval = Interval { low: 0.0, high: 0.0 };

/// The interval of 1 alone.
pub(crate) const ONE: Interval = Interval { low: 1.0, high: 1.0 };
/// The interval of -1 alone.
const MINUS_ONE: Interval = Interval { low: -1.0, high: -1.0 };

/// The interval of all real numbers.
pub const ENTIRE: Interval = Interval { low: f64::NEG_INFINITY, high: f64::INFINITY };

impl Interval {
    /// Returns the interval between two ends.
    pub fn new(low: f64, high: f64) -> Interval {
        Interval { low, high }
    }

    /// Encloses a constant: exactly if it is a double, else by the doubles around its nearest one.
    pub(crate) fn enclosing(value: &Number) -> Interval {
        let nearest = value.to_f64();
        // Most constants are doubles.
        if value.is_double() {
            return Interval { low: nearest, high: nearest };
        }
        Interval::out(nearest, nearest)
    }

    pub(crate) fn negated(self) -> Interval {
        Interval { low: -self.high, high: -self.low }
    }

    /// Returns the intersection of two enclosures of the same quantity.
    pub(crate) fn common(self, other: Interval) -> Interval {
        Interval { low: self.low.max(other.low), high: self.high.min(other.high) }
    }

    /// Returns the midpoint.
    pub fn middle(self) -> f64 {
        self.low / 2.0 + self.high / 2.0
    }

    /// Rounds outward. A NaN end gives [`ENTIRE`].
    fn out(low: f64, high: f64) -> Interval {
        if low.is_nan() || high.is_nan() {
            return ENTIRE;
        }
        Interval { low: low.next_down(), high: high.next_up() }
    }

    /// Clamps the lower end to 0 if the quantity is known to be nonnegative (`sure`), since rounding outward
    /// may make it negative.
    fn at_least_0(self, sure: bool) -> Interval {
        if sure { Interval { low: self.low.max(0.0), ..self } } else { self }
    }

    pub(crate) fn plus(self, other: Interval) -> Interval {
        // Adding 0 is exact.
        if self == ZERO || other == ZERO {
            return if self == ZERO { other } else { self };
        }
        let sum = Interval::out(self.low + other.low, self.high + other.high);
        sum.at_least_0(self.low >= 0.0 && other.low >= 0.0)
    }

    pub(crate) fn times(self, other: Interval) -> Interval {
        match (self, other) {
            // Factors 0, 1 and -1 are exact.
            (ZERO, _) | (_, ZERO) => return ZERO,
            (ONE, value) | (value, ONE) => return value,
            (MINUS_ONE, value) | (value, MINUS_ONE) => return value.negated(),
            _ => {}
        }
        let ends = [
            product(self.low, other.low),
            product(self.low, other.high),
            product(self.high, other.low),
            product(self.high, other.high),
        ];
        Interval::out(
            ends.into_iter().fold(f64::INFINITY, f64::min),
            ends.into_iter().fold(f64::NEG_INFINITY, f64::max),
        )
        .at_least_0(self.low >= 0.0 && other.low >= 0.0)
    }

    pub(crate) fn reciprocal(self) -> Interval {
        if self.low <= 0.0 && self.high >= 0.0 {
            return ENTIRE;
        }
        Interval::out(1.0 / self.high, 1.0 / self.low)
    }

    /// Returns the smallest interval that contains both.
    pub fn hull(self, other: Interval) -> Interval {
        Interval { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Encloses the smaller of two quantities.
    pub(crate) fn min(self, other: Interval) -> Interval {
        Interval { low: self.low.min(other.low), high: self.high.min(other.high) }
    }

    /// Encloses the larger of two quantities.
    pub(crate) fn max(self, other: Interval) -> Interval {
        Interval { low: self.low.max(other.low), high: self.high.max(other.high) }
    }

    pub(crate) fn abs(self) -> Interval {
        if self.low >= 0.0 {
            self
        } else if self.high <= 0.0 {
            Interval { low: -self.high, high: -self.low }
        } else {
            Interval { low: 0.0, high: self.high.max(-self.low) }
        }
    }

    pub(crate) fn square(self) -> Interval {
        let abs = self.abs();
        Interval::out(abs.low * abs.low, abs.high * abs.high).at_least_0(true)
    }

    pub(crate) fn power(self, exponent: u8) -> Interval {
        match exponent {
            0 => ONE,
            1 => self,
            2 => self.square(),
            _ => self.square().times(self.power(exponent - 2)),
        }
    }

    /// Encloses the square root; [`ENTIRE`] if the operand may be negative.
    pub(crate) fn sqrt(self) -> Interval {
        if self.low < 0.0 {
            return ENTIRE;
        }
        Interval::out(self.low.sqrt(), self.high.sqrt()).at_least_0(true)
    }
}

/// An axis-aligned box in space. A tool's box lies in the half plane y = 0, x ≥ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// The sides along x, y and z.
    pub sides: [Interval; 3],
}

impl Cell {
    /// Returns the box of a tool's half plane with these distances from the axis and coordinates along it.
    pub fn half_plane(d: Interval, z: Interval) -> Cell {
        Cell { sides: [d, ZERO, z] }
    }

    /// Replaces the side along an axis.
    #[must_use]
    pub fn with_side(mut self, axis: usize, side: Interval) -> Cell {
        self.sides[axis] = side;
        self
    }

    /// Returns the box of one point.
    pub(crate) fn point(at: [f64; 3]) -> Cell {
        Cell { sides: at.map(|at| Interval::new(at, at)) }
    }

    /// Returns the centre.
    pub fn middle(&self) -> [f64; 3] {
        self.sides.map(Interval::middle)
    }

    /// Returns the smallest box that contains both.
    pub(crate) fn hull(&self, other: &Cell) -> Cell {
        let [a, b, c] = self.sides;
        let [d, e, f] = other.sides;
        Cell { sides: [a.hull(d), b.hull(e), c.hull(f)] }
    }

    /// Returns the intersection of two boxes. If it is empty, some side has `low > high`.
    pub(crate) fn common(&self, other: &Cell) -> Cell {
        Cell { sides: [0, 1, 2].map(|axis| self.sides[axis].common(other.sides[axis])) }
    }

    /// Returns whether two boxes have a common point.
    pub(crate) fn meets(&self, other: &Cell) -> bool {
        self.common(other).sides.iter().all(|side| side.low <= side.high)
    }

    /// Encloses the square of the distance from the axis.
    pub(crate) fn squared_radius(&self) -> Interval {
        let [x, y, _] = self.sides;
        // Enclosing y² = 0 would only add rounding.
        if y == ZERO { x.square() } else { x.square().plus(y.square()) }
    }

    /// Encloses the distance from the axis.
    pub(crate) fn radius(&self) -> Interval {
        let [x, y, _] = self.sides;
        if y == ZERO { x.abs() } else { self.squared_radius().sqrt() }
    }
}

/// Encloses chosen nodes of a graph over one box after another. For each box only the requested nodes are
/// computed.
#[derive(Clone, Debug)]
pub struct Encloser<'g> {
    graph: &'g Graph,
    /// The nodes that each root needs, operands first, without constants; empty for nodes that are not roots.
    needed: EvaluationOrders,
    values: Box<[Interval]>,
    /// The number of the box for which each value was last computed.
    done: Box<[u32]>,
    now: u32,
    cell: Cell,
}

impl<'g> Encloser<'g> {
    /// Makes an encloser for some nodes.
    pub fn new(graph: &'g Graph, roots: impl IntoIterator<Item = Id>) -> Encloser<'g> {
        let (needed, constants) = graph.evaluation_orders(roots);
        let mut values = vec![ENTIRE; graph.nodes().len()].into_boxed_slice();
        for id in constants {
            values[id.index()] = graph.constant(id).map_or(ENTIRE, Interval::enclosing);
        }
        let done = vec![0; values.len()].into_boxed_slice();
        Encloser { graph, needed, values, done, now: 0, cell: Cell { sides: [ZERO; 3] } }
    }

    /// Selects the box.
    pub fn set(&mut self, cell: Cell) {
        self.cell = cell;
        self.now = self.now.wrapping_add(1);
        if self.now == 0 {
            self.done.fill(0);
            self.now = 1;
        }
    }

    /// Returns the enclosure over the selected box of one of the nodes given to [`Encloser::new`].
    pub fn get(&mut self, root: Id) -> Interval {
        if self.done[root.index()] == self.now {
            return self.values[root.index()];
        }
        for k in 0..self.needed[root.index()].len() {
            let id = self.needed[root.index()][k];
            let at = id.index();
            if self.done[at] != self.now {
                self.done[at] = self.now;
                self.values[at] = self.node(id);
            }
        }
        self.values[root.index()]
    }

    fn node(&self, id: Id) -> Interval {
        let v = |id: &Id| self.values[id.index()];
        let cell = &self.cell;
        match self.graph.node(id) {
            Node::Const(_) => v(&id),
            Node::Coord(Coord::X) => cell.sides[0],
            Node::Coord(Coord::Y) => cell.sides[1],
            Node::Coord(Coord::Z) => cell.sides[2],
            Node::Coord(Coord::D) => cell.radius(),
            Node::Coord(Coord::Q) => cell.squared_radius(),
            Node::Coord(Coord::Length | Coord::PerLength) => ENTIRE,
            Node::Neg(a) => v(a).negated(),
            Node::Add(a, b) => v(a).plus(v(b)),
            Node::Sub(a, b) => v(a).plus(v(b).negated()),
            Node::Mul(a, b) if a == b => v(a).square(),
            Node::Mul(a, b) => v(a).times(v(b)),
            Node::Div(a, b) | Node::Quotient(a, b) => v(a).times(v(b).reciprocal()),
            Node::Min(a, b) => v(a).min(v(b)),
            Node::Max(a, b) => v(a).max(v(b)),
            Node::Abs(a) => v(a).abs(),
            Node::Sqrt(a) => v(a).sqrt(),
            Node::Select { low, high, then, other } => {
                if v(low).high <= v(high).low {
                    v(then)
                } else if v(low).low > v(high).high {
                    v(other)
                } else {
                    v(then).hull(v(other))
                }
            }
        }
    }
}

/// Returns a product of two ends.
fn product(a: f64, b: f64) -> f64 {
    // 0 · ∞ stands for a product of finite numbers with a factor 0.
    if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
}

/// Encloses the dot product of two vectors.
pub(crate) fn dot(a: [Interval; 3], b: [Interval; 3]) -> Interval {
    (0..3).fold(ZERO, |sum, k| sum.plus(a[k].times(b[k])))
}

/// Bisects a box across its longest side. A side that spans several orders of magnitude is cut at their
/// geometric middle, or at 0.
pub(crate) fn halves(cell: Cell) -> [Cell; 2] {
    let length = |axis: usize| cell.sides[axis].high - cell.sides[axis].low;
    let longer =
        |longest_axis, axis| if length(axis) > length(longest_axis) { axis } else { longest_axis };
    let axis = [0, 1].into_iter().fold(2, longer);
    let side = cell.sides[axis];
    let middle = middle(side);
    [
        cell.with_side(axis, Interval::new(side.low, middle)),
        cell.with_side(axis, Interval::new(middle, side.high)),
    ]
}

fn middle(side: Interval) -> f64 {
    let (low, high) = (side.low, side.high);
    if low < 0.0 && high > 0.0 && (high > 1e6 || low < -1e6) {
        0.0
    } else if low >= 0.0 && high > 1e3 * (low + 1.0) {
        ((low + 1.0) * high).sqrt()
    } else if high <= 0.0 && low < 1e3 * (high - 1.0) {
        -((1.0 - high) * -low).sqrt()
    } else {
        low / 2.0 + high / 2.0
    }
}
