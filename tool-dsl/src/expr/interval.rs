//! Enclosures: every operation rounds outward by one step of the last place, so that the true
//! value over a box lies between the ends.

use super::{Coord, Graph, Id, Node};

/// All numbers between two ends. A quantity that may be undefined encloses everything.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

/// Nothing but 0.
pub const ZERO: Interval = Interval { low: 0.0, high: 0.0 };

/// Every number.
pub const EVERYTHING: Interval = Interval { low: f64::NEG_INFINITY, high: f64::INFINITY };

impl Interval {
    /// The interval between two ends.
    pub fn new(low: f64, high: f64) -> Interval {
        Interval { low, high }
    }

    /// Rounds outward; a NaN end means that nothing is known.
    fn out(low: f64, high: f64) -> Interval {
        if low.is_nan() || high.is_nan() {
            return EVERYTHING;
        }
        Interval { low: low.next_down(), high: high.next_up() }
    }

    /// The same, known not to be negative if `sure`: rounding outward does not make it so.
    fn at_least_0(self, sure: bool) -> Interval {
        if sure { Interval { low: self.low.max(0.0), ..self } } else { self }
    }

    fn plus(self, other: Interval) -> Interval {
        let sum = Interval::out(self.low + other.low, self.high + other.high);
        sum.at_least_0(self.low >= 0.0 && other.low >= 0.0)
    }

    fn times(self, other: Interval) -> Interval {
        // 0 · ∞ stands for a product of finite numbers with a factor 0.
        let product = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
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

    fn reciprocal(self) -> Interval {
        if self.low <= 0.0 && self.high >= 0.0 {
            return EVERYTHING;
        }
        Interval::out(1.0 / self.high, 1.0 / self.low)
    }

    fn hull(self, other: Interval) -> Interval {
        Interval { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    fn abs(self) -> Interval {
        if self.low >= 0.0 {
            self
        } else if self.high <= 0.0 {
            Interval { low: -self.high, high: -self.low }
        } else {
            Interval { low: 0.0, high: self.high.max(-self.low) }
        }
    }

    fn square(self) -> Interval {
        let abs = self.abs();
        Interval::out(abs.low * abs.low, abs.high * abs.high).at_least_0(true)
    }

    /// Undefined somewhere: then nothing is known.
    fn sqrt(self) -> Interval {
        if self.low < 0.0 {
            return EVERYTHING;
        }
        Interval::out(self.low.sqrt(), self.high.sqrt()).at_least_0(true)
    }
}

/// A box of space. A tool's lies in the half plane of y = 0, x ≥ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Along x, y and z.
    pub sides: [Interval; 3],
}

impl Cell {
    /// The box of a tool's half plane with these distances from the axis and places along it.
    pub fn half_plane(d: Interval, z: Interval) -> Cell {
        Cell { sides: [d, ZERO, z] }
    }

    /// The same with another side along an axis.
    #[must_use]
    pub fn with(mut self, axis: usize, side: Interval) -> Cell {
        self.sides[axis] = side;
        self
    }

    /// The smallest box around two.
    pub(crate) fn hull(&self, other: &Cell) -> Cell {
        let [a, b, c] = self.sides;
        let [d, e, f] = other.sides;
        Cell { sides: [a.hull(d), b.hull(e), c.hull(f)] }
    }

    /// What two boxes have in common; one whose sides end before they begin if nothing.
    pub(crate) fn common(&self, other: &Cell) -> Cell {
        let both = |axis: usize| {
            let (a, b) = (self.sides[axis], other.sides[axis]);
            Interval { low: a.low.max(b.low), high: a.high.min(b.high) }
        };
        Cell { sides: [0, 1, 2].map(both) }
    }

    /// Whether the two have a point in common.
    pub(crate) fn meets(&self, other: &Cell) -> bool {
        self.common(other).sides.iter().all(|side| side.low <= side.high)
    }

    /// The square of the distance from the axis.
    fn squared_radius(&self) -> Interval {
        let [x, y, _] = self.sides;
        // Exact where it can be.
        if y == ZERO { x.square() } else { x.square().plus(y.square()) }
    }

    /// The distance from the axis.
    pub(crate) fn radius(&self) -> Interval {
        let [x, y, _] = self.sides;
        if y == ZERO { x.abs() } else { self.squared_radius().sqrt() }
    }
}

/// Encloses chosen nodes of a graph over one box after another.
#[derive(Clone, Debug)]
pub struct Encloser<'g> {
    graph: &'g Graph,
    order: Vec<Id>,
    values: Vec<Interval>,
}

impl<'g> Encloser<'g> {
    /// An encloser of some nodes.
    pub fn new(graph: &'g Graph, roots: impl IntoIterator<Item = Id>) -> Encloser<'g> {
        let mut order = graph.needed(roots);
        let mut values = vec![EVERYTHING; graph.nodes().len()];
        order.retain(|id| match graph.constant(*id) {
            Some(value) => {
                let nearest = value.to_f64();
                values[id.index()] = Interval::out(nearest, nearest);
                false
            }
            None => true,
        });
        Encloser { graph, order, values }
    }

    /// Moves to a box.
    pub fn set(&mut self, cell: Cell) {
        for &id in &self.order {
            let v = |id: Id| self.values[id.index()];
            self.values[id.index()] = match self.graph.node(id) {
                Node::Const(_) => v(id),
                Node::Coord(Coord::X) => cell.sides[0],
                Node::Coord(Coord::Y) => cell.sides[1],
                Node::Coord(Coord::Z) => cell.sides[2],
                Node::Coord(Coord::D) => cell.radius(),
                Node::Coord(Coord::Q) => cell.squared_radius(),
                Node::Coord(Coord::Length | Coord::PerLength) => EVERYTHING,
                Node::Neg(a) => Interval { low: -v(*a).high, high: -v(*a).low },
                Node::Add(a, b) => v(*a).plus(v(*b)),
                Node::Sub(a, b) => Interval::out(v(*a).low - v(*b).high, v(*a).high - v(*b).low),
                Node::Mul(a, b) if a == b => v(*a).square(),
                Node::Mul(a, b) => v(*a).times(v(*b)),
                Node::Div(a, b) | Node::Quotient(a, b) => v(*a).times(v(*b).reciprocal()),
                Node::Min(a, b) => {
                    Interval { low: v(*a).low.min(v(*b).low), high: v(*a).high.min(v(*b).high) }
                }
                Node::Max(a, b) => {
                    Interval { low: v(*a).low.max(v(*b).low), high: v(*a).high.max(v(*b).high) }
                }
                Node::Abs(a) => v(*a).abs(),
                Node::Sqrt(a) => v(*a).sqrt(),
                Node::Select { low, high, then, other } => {
                    if v(*low).high <= v(*high).low {
                        v(*then)
                    } else if v(*low).low > v(*high).high {
                        v(*other)
                    } else {
                        v(*then).hull(v(*other))
                    }
                }
            };
        }
    }

    /// The enclosure of a node over the present box.
    pub fn get(&self, id: Id) -> Interval {
        self.values[id.index()]
    }
}
