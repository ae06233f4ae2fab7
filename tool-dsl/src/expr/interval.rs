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
}

/// A box of the half plane that the profile lies in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Distance from the axis.
    pub d: Interval,
    /// Along the axis.
    pub z: Interval,
}

/// Encloses chosen nodes of a graph over one box after another.
#[derive(Clone, Debug)]
pub struct Encloser<'g> {
    graph: &'g Graph,
    order: Vec<Id>,
    values: Vec<Interval>,
}

impl<'g> Encloser<'g> {
    /// An encloser of some nodes, which are functions of d and z.
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
                Node::Coord(Coord::Z) => cell.z,
                Node::Coord(Coord::D) => cell.d,
                Node::Coord(Coord::Q) => cell.d.square(),
                Node::Coord(Coord::X | Coord::Y) => {
                    Interval { low: -cell.d.high, high: cell.d.high }
                }
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
                // Undefined somewhere: then nothing is known.
                Node::Sqrt(a) if v(*a).low < 0.0 => EVERYTHING,
                Node::Sqrt(a) => {
                    Interval::out(v(*a).low.sqrt(), v(*a).high.sqrt()).at_least_0(true)
                }
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
