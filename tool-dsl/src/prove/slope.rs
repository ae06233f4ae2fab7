//! Enclosures of expressions together with their slopes, which bound the steepness of a function over a box, and
//! of depth on the two sides of a border.

use super::borders::MAX_TANGENT_SLOPE;
use crate::domain::Domain;
use crate::expr::interval::{Cell, ENTIRE, Interval, ONE, ZERO, dot};
use crate::expr::{Coord, EvaluationOrders, Graph, Id, Node};

/// A function over a box: its values, its partial derivatives by x (for a tool, by the distance from the
/// axis), y and z, and the length of its gradient, which is often known more accurately.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slope {
    pub(super) value: Interval,
    pub(super) partials: [Interval; 3],
    pub(super) length: Interval,
    /// Flags for points where it may not be smooth: kinks that point down, as lengths and the larger of two
    /// have, and kinks that point up.
    kinks: [bool; 2],
}

const NO_KINKS: [bool; 2] = [false; 2];
const KINK_DOWN: [bool; 2] = [true, false];
const KINK_UP: [bool; 2] = [false, true];

/// Returns the kinks of a sum of functions.
fn union(a: [bool; 2], b: [bool; 2]) -> [bool; 2] {
    [a[0] || b[0], a[1] || b[1]]
}

/// Returns the kinks of a product or another nonlinear combination.
fn nonlinear(a: [bool; 2], b: [bool; 2]) -> [bool; 2] {
    [a.into_iter().chain(b).any(|kinked| kinked); 2]
}

const ZERO_GRADIENT: [Interval; 3] = [ZERO; 3];

impl Slope {
    fn constant(value: Interval) -> Slope {
        Slope { value, partials: ZERO_GRADIENT, length: ZERO, kinks: NO_KINKS }
    }

    fn new(value: Interval, partials: [Interval; 3], kinks: [bool; 2]) -> Slope {
        Slope { value, partials, length: length(partials), kinks }
    }

    /// Returns a lower bound of the rate at which the function falls in some direction, from any point of the
    /// box.
    pub(super) fn fall(&self) -> f64 {
        // At a kink that points up, every adjacent slope leads down. At one that points down, the relevant slope is a
        // mean of the adjacent slopes (Clarke 1983), and therefore lies in their enclosure.
        if self.kinks[0] { length(self.partials).low } else { self.length.low }
    }

    /// Tightens the length of the gradient by another enclosure of it.
    fn with(self, known: Interval) -> Slope {
        let length = Interval {
            low: self.length.low.max(known.low),
            high: self.length.high.min(known.high),
        };
        let bound = Interval { low: -length.high, high: length.high };
        Slope { length, partials: self.partials.map(|part| part.common(bound)), ..self }
    }

    fn is_constant(&self) -> bool {
        self.length == ZERO
    }

    fn scaled(self, factor: Interval) -> Slope {
        Slope {
            value: self.value.times(factor),
            partials: self.partials.map(|part| part.times(factor)),
            length: self.length.times(factor.abs()),
            kinks: match self.kinks {
                kinks if factor.low >= 0.0 => kinks,
                [down, up] if factor.high <= 0.0 => [up, down],
                kinks => nonlinear(kinks, NO_KINKS),
            },
        }
    }

    fn plus(self, other: Slope, sign: Interval) -> Slope {
        let other = other.scaled(sign);
        let value = self.value.plus(other.value);
        // The length of the other's gradient may be known better than its components give it.
        if self.is_constant() || other.is_constant() {
            let varying = if self.is_constant() { other } else { self };
            return Slope { value, ..varying };
        }
        let partials = [0, 1, 2].map(|k| self.partials[k].plus(other.partials[k]));
        // By the triangle inequality, where the enclosures of components are wide.
        let max_length = self.length.plus(other.length).high;
        let kinks = union(self.kinks, other.kinks);
        Slope::new(value, partials, kinks).with(Interval { low: 0.0, high: max_length })
    }

    fn times(self, other: Slope) -> Slope {
        if self.is_constant() {
            return Slope { value: self.value.times(other.value), ..other.scaled(self.value) };
        }
        if other.is_constant() {
            return other.times(self);
        }
        let kinks = nonlinear(self.kinks, other.kinks);
        Slope::new(
            self.value.times(other.value),
            [0, 1, 2].map(|k| {
                self.partials[k].times(other.value).plus(other.partials[k].times(self.value))
            }),
            kinks,
        )
    }

    fn square(self) -> Slope {
        let double = self.value.plus(self.value);
        let length = self.length.times(double.abs());
        Slope {
            value: self.value.square(),
            partials: self.partials.map(|part| part.times(double)),
            length,
            kinks: nonlinear(self.kinks, NO_KINKS),
        }
    }

    fn over(self, other: Slope) -> Slope {
        let reciprocal = other.value.reciprocal();
        if other.is_constant() {
            return Slope { value: self.value.times(reciprocal), ..self.scaled(reciprocal) };
        }
        let value = self.value.times(reciprocal);
        Slope::new(
            value,
            [0, 1, 2].map(|k| {
                let down = value.times(other.partials[k]);
                self.partials[k].plus(down.negated()).times(reciprocal)
            }),
            nonlinear(self.kinks, other.kinks),
        )
    }

    fn sqrt(self) -> Slope {
        let value = self.value.sqrt();
        let half = value.plus(value).reciprocal();
        Slope {
            value,
            partials: self.partials.map(|part| part.times(half)),
            length: self.length.times(half.abs()),
            kinks: if value.low > 0.0 { self.kinks } else { [true; 2] },
        }
    }

    fn hull(self, other: Slope) -> Slope {
        Slope {
            value: self.value.hull(other.value),
            partials: [0, 1, 2].map(|k| self.partials[k].hull(other.partials[k])),
            length: self.length.hull(other.length),
            kinks: union(self.kinks, other.kinks),
        }
    }

    /// Adds kinks.
    fn kinked(self, more: [bool; 2]) -> Slope {
        Slope { kinks: union(self.kinks, more), ..self }
    }
}

/// Returns the length of a vector.
fn length(partials: [Interval; 3]) -> Interval {
    // Exact for a vector along an axis.
    if let [part, ZERO, ZERO] | [ZERO, part, ZERO] | [ZERO, ZERO, part] = partials {
        return part.abs();
    }
    let squares = partials.map(Interval::square);
    squares[0].plus(squares[1]).plus(squares[2]).sqrt()
}

/// Encloses the root of a sum of squares `u² + v² + …`, the length of the vector `(u, v, …)`. Its gradient is
/// a unit vector times the slopes of the components. It is defined except where all components are 0, and is
/// at most as long as the largest singular value of the slopes.
fn norm(partials: &[Slope]) -> Slope {
    let squares = partials.iter().map(|part| part.value.square());
    let value = squares.fold(ZERO, Interval::plus).sqrt();
    // No component of a unit vector is longer than it.
    let unit_range = Interval { low: -1.0, high: 1.0 };
    // A length is not negative.
    let per_length =
        Interval { low: (1.0 / value.high).next_down(), high: (1.0 / value.low).next_up() };
    let unit_vector: Vec<Interval> =
        partials.iter().map(|part| part.value.times(per_length).common(unit_range)).collect();
    let gradient = [0, 1, 2].map(|k| {
        partials
            .iter()
            .zip(&unit_vector)
            .fold(ZERO, |sum, (part, way)| sum.plus(part.partials[k].times(*way)))
    });
    // The squares of the singular values lie around the diagonal of J Jᵀ, within its row sums (Gershgorin
    // 1931).
    let mut singular: Option<Interval> = None;
    for (i, a) in partials.iter().enumerate() {
        let mut circle = a.length.square();
        for (j, b) in partials.iter().enumerate() {
            if i != j {
                let mut product = ZERO;
                for k in 0..3 {
                    product = product.plus(a.partials[k].times(b.partials[k]));
                }
                let radius = product.abs().high;
                circle = circle.plus(Interval { low: -radius, high: radius });
            }
        }
        singular = Some(singular.map_or(circle, |hull| hull.hull(circle)));
    }
    let squared = singular.unwrap_or(ZERO);
    // The gradient is the image of a unit vector, so its length lies between the singular values.
    let known = Interval { low: squared.low.max(0.0), ..squared }.sqrt();
    // A length is a nonlinear function of its parts. It has a kink of its own, pointing down, where it is 0.
    let component_kinks = partials.iter().fold(NO_KINKS, |hull, part| nonlinear(hull, part.kinks));
    let kinks = if value.low > 0.0 { component_kinks } else { union(component_kinks, KINK_DOWN) };
    Slope::new(value, gradient, kinks).with(known)
}

/// Encloses chosen nodes of a graph with their slopes, over one box after another. For each box only the
/// requested nodes are computed.
pub(super) struct Slopes<'g> {
    graph: &'g Graph,
    domain: Domain,
    /// The nodes that each root needs, operands first, without constants; empty for nodes that are not roots.
    needed: EvaluationOrders,
    values: Box<[Slope]>,
    /// The number of the box for which each value was last computed.
    computed_for: Box<[u32]>,
    box_number: u32,
    cell: Cell,
}

impl<'g> Slopes<'g> {
    pub(super) fn new(
        graph: &'g Graph,
        domain: Domain,
        roots: impl IntoIterator<Item = Id>,
    ) -> Slopes<'g> {
        let unknown = Slope::new(ENTIRE, [ENTIRE; 3], [true; 2]);
        let (needed, constants) = graph.evaluation_orders(roots);
        let mut values = vec![unknown; graph.nodes().len()].into_boxed_slice();
        // Constants are the same in every box.
        for id in constants {
            let value = graph.constant(id).map_or(ENTIRE, Interval::enclosing);
            values[id.index()] = Slope::constant(value);
        }
        let computed_for = vec![0; values.len()].into_boxed_slice();
        let cell = Cell { sides: [ZERO; 3] };
        Slopes { graph, domain, needed, values, computed_for, box_number: 0, cell }
    }

    /// Selects a box.
    pub(super) fn set(&mut self, cell: Cell) {
        self.cell = cell;
        self.box_number += 1;
    }

    /// Returns the enclosure over the current box of one of the roots.
    pub(super) fn get(&mut self, root: Id) -> Slope {
        if self.computed_for[root.index()] == self.box_number {
            return self.values[root.index()];
        }
        for k in 0..self.needed[root.index()].len() {
            let id = self.needed[root.index()][k];
            let index = id.index();
            // Roots share nodes, and only some roots are asked for in a box.
            if self.computed_for[index] != self.box_number {
                self.computed_for[index] = self.box_number;
                self.values[index] = self.node(id, self.cell);
            }
        }
        self.values[root.index()]
    }

    fn node(&self, id: Id, cell: Cell) -> Slope {
        let v = |id: &Id| self.values[id.index()];
        match self.graph.node(id) {
            Node::Const(_) => v(&id),
            Node::Coord(coord) => self.coordinate(*coord, cell),
            Node::Neg(a) => v(a).scaled(ONE.negated()),
            Node::Add(a, b) => v(a).plus(v(b), ONE),
            Node::Sub(a, b) => v(a).plus(v(b), ONE.negated()),
            // The two factors are the same number, which a product of intervals would not know.
            Node::Mul(a, b) if a == b => v(a).square(),
            Node::Mul(a, b) => v(a).times(v(b)),
            Node::Div(a, b) | Node::Quotient(a, b) => v(a).over(v(b)),
            // No kink stands where one is smaller throughout the closed box. Where they are equal at its side there is one: the
            // function need not fall beyond it as it does within.
            Node::Min(a, b) if v(a).value.high < v(b).value.low => v(a),
            Node::Min(a, b) if v(b).value.high < v(a).value.low => v(b),
            Node::Max(a, b) if v(a).value.low > v(b).value.high => v(a),
            Node::Max(a, b) if v(b).value.low > v(a).value.high => v(b),
            Node::Min(a, b) => {
                let (a, b) = (v(a), v(b));
                Slope { value: a.value.min(b.value), ..a.hull(b).kinked(KINK_UP) }
            }
            Node::Max(a, b) => {
                let (a, b) = (v(a), v(b));
                Slope { value: a.value.max(b.value), ..a.hull(b).kinked(KINK_DOWN) }
            }
            Node::Abs(a) => {
                let a = v(a);
                let other = a.scaled(ONE.negated());
                match a.value {
                    Interval { low, .. } if low > 0.0 => a,
                    Interval { high, .. } if high < 0.0 => other,
                    value => Slope { value: value.abs(), ..a.hull(other).kinked(KINK_DOWN) },
                }
            }
            Node::Sqrt(a) => match self.graph.squares_of(*a) {
                Some(parts) => {
                    let parts = parts.iter().map(|part| match part {
                        Some(part) => v(part),
                        None => self.coordinate(Coord::D, cell),
                    });
                    norm(&parts.collect::<Vec<_>>())
                }
                None => v(a).sqrt(),
            },
            Node::Select { low, high, then, other } => {
                if v(low).value.high < v(high).value.low {
                    v(then)
                } else if v(low).value.low > v(high).value.high {
                    v(other)
                } else {
                    // The two may differ where they meet, so nothing is known about the kink.
                    v(then).hull(v(other)).kinked([true; 2])
                }
            }
        }
    }

    fn coordinate(&self, coord: Coord, cell: Cell) -> Slope {
        let coordinate_slope = |axis: usize| {
            let mut partials = ZERO_GRADIENT;
            partials[axis] = ONE;
            Slope { value: cell.sides[axis], partials, length: ONE, kinks: NO_KINKS }
        };
        match coord {
            Coord::X => coordinate_slope(0),
            Coord::Y => coordinate_slope(1),
            Coord::Z => coordinate_slope(2),
            Coord::D if self.domain == Domain::HalfPlane => coordinate_slope(0),
            Coord::D => norm(&[coordinate_slope(0), coordinate_slope(1)]),
            Coord::Q => {
                let d = self.coordinate(Coord::D, cell);
                // `d²` is smooth on the axis, where `d` is not.
                Slope { value: cell.squared_radius(), kinks: NO_KINKS, ..d.square() }
            }
            Coord::Length | Coord::PerLength => Slope { value: ENTIRE, ..Slope::constant(ZERO) },
        }
    }
}

/// The tolerance for neglected slopes, by which `c` is lowered. Niceness also counts as falling with depth if
/// the product of both gradients is at most this part of the product of their lengths.
///
/// Neglected are, at a point with an owner whose depth has a slope of at least `c`:
///
/// - on a border, a difference of two slopes up to [`SLOPE_TOLERANCE`]: a combination of them is shorter than either by
///   at most that, and by twice that where a third region lies between;
/// - on the axis, a slope away from it up to [`SLOPE_TOLERANCE`]: the remaining slope along the axis is shorter by at
///   most that;
/// - on a border of distances that is nearly smooth, the slope across it: `1 - √(1 - t²) ≤ t²`, with
///   [`MAX_TANGENT_SLOPE`] for `t`.
///
/// The sum is `3 SLOPE_TOLERANCE + t²`.
pub(super) const SLOPE_MARGIN: f64 = 1e-9;

/// The difference up to which two slopes count as equal; slopes have no unit.
pub(super) const SLOPE_TOLERANCE: f64 = 2.5e-10;

const _: () =
    assert!(3.0 * SLOPE_TOLERANCE + MAX_TANGENT_SLOPE * MAX_TANGENT_SLOPE <= SLOPE_MARGIN);

/// A bound of the error of `acos`. On common platforms it is one or two ulps of the result; no angle has a
/// larger ulp than π, 2^-51. This is four of these.
const ACOS_ERROR: f64 = 8.0 * f64::EPSILON;

/// Encloses the angle between two unit vectors, in radians.
pub(super) fn angle(a: [Interval; 3], b: [Interval; 3]) -> Interval {
    let product = dot(a, b);
    let [low, high] = [product.high, product.low].map(|cos| cos.clamp(-1.0, 1.0).acos());
    Interval { low: (low - ACOS_ERROR).max(0.0), high: high + ACOS_ERROR }
}

/// Returns a lower bound of the rate at which depth falls toward one of the sides of a border on which two
/// depths agree, and its uncertainty.
pub(super) fn fall_rate_across(slopes: [Slope; 2], curve: Slope, below: bool) -> (f64, f64) {
    let [own, other] = &slopes;
    let products = [0, 1, 2]
        .map(|k| own.partials[k].plus(other.partials[k].negated()).times(curve.partials[k]));
    let rise = products.into_iter().fold(ZERO, Interval::plus);
    let falls = if below { rise.low } else { -rise.high };
    // The two slopes differ only along the curve's gradient, since depths agree on the curve: by -falls
    // divided by its length.
    // Each depth is then the smaller on its own side, and both sides lead down.
    if falls >= 0.0 || falls >= -SLOPE_TOLERANCE * curve.length.low {
        return (f64::INFINITY, 0.0);
    }
    shortest_combination(&slopes)
}

/// The number of steps toward the shortest combination of slopes. Any direction gives a bound, so their number decides
/// only how good it is.
const SHORTENING_STEPS: usize = 32;

/// Returns a lower bound of the length of any convex combination of slopes, and its uncertainty. Depth falls along every
/// combination of the slopes about a point, and therefore at least at the rate of the shortest (Clarke 1983).
pub(super) fn shortest_combination(slopes: &[Slope]) -> (f64, f64) {
    let widths = slopes.iter().flat_map(|slope| slope.partials).map(|part| part.high - part.low);
    let slack = widths.fold(0.0, f64::max);
    let middles: Vec<[f64; 3]> =
        slopes.iter().map(|slope| slope.partials.map(Interval::middle)).collect();
    let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // Gilbert 1966: each step takes the nearest point to the origin on the way to the slope that reaches least far along
    // the current one.
    let mut nearest = middles.first().copied().unwrap_or_default();
    for _ in 0..SHORTENING_STEPS {
        let lowest =
            middles.iter().copied().min_by(|a, b| dot(*a, nearest).total_cmp(&dot(*b, nearest)));
        let Some(lowest) = lowest else { break };
        let way = [0, 1, 2].map(|k| lowest[k] - nearest[k]);
        let squared_length = dot(way, way);
        if squared_length == 0.0 {
            break;
        }
        let part = (-dot(nearest, way) / squared_length).clamp(0.0, 1.0);
        nearest = [0, 1, 2].map(|k| nearest[k] + part * way[k]);
    }
    (shortest_along(nearest, slopes), slack)
}

/// Returns a lower bound of the length of any combination of slopes, from their components along a direction.
/// The bound holds for any direction, so rounding in its choice does no harm.
fn shortest_along(direction: [f64; 3], slopes: &[Slope]) -> f64 {
    let direction = direction.map(|part| Interval::new(part, part));
    let squares = direction.map(Interval::square);
    let per_length = squares.into_iter().fold(ZERO, Interval::plus).sqrt().reciprocal();
    let along = slopes.iter().map(|slope| {
        let parts = [0, 1, 2].map(|k| slope.partials[k].times(direction[k]));
        parts.into_iter().fold(ZERO, Interval::plus).times(per_length).low
    });
    // Unbounded slopes, and a combination of length 0, have no direction; `min` would lose what is not a number.
    along.map(|low| if low.is_nan() { 0.0 } else { low.max(0.0) }).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Domain;
    use crate::expr::interval::Cell;
    use crate::expr::{Coord, Graph};
    use crate::number::Number;

    /// Two depths whose slopes differ by 2e-7 along z, and a curve whose gradient is a thousand times smaller
    /// where it points along z than elsewhere in the box. Each depth is the smaller on the other's side, and
    /// the shortest combination counts.
    #[test]
    fn slopes_are_compared_by_the_flattest_part_of_a_curve() {
        let mut graph = Graph::default();
        let mut number = |text: &str| graph.number(Number::parse_decimal(text).expect("a number"));
        let [less, more, flat] = ["0.9999999", "1.0000001", "0.001"].map(&mut number);
        let [d, z] = [Coord::D, Coord::Z].map(|coord| graph.coord(coord));
        let [own, other, linear_part] = [less, more, flat].map(|factor| graph.mul(factor, z));
        let square = graph.mul(d, d);
        let curve = graph.add(square, linear_part);
        let mut slopes = Slopes::new(&graph, Domain::HalfPlane, [own, other, curve]);
        slopes.set(Cell::half_plane(Interval::new(0.0, 1.0), Interval::new(-1.0, 1.0)));
        let [own, other, curve] = [own, other, curve].map(|id| slopes.get(id));
        let (fall, _) = fall_rate_across([own, other], curve, true);
        assert!((0.99..1.0).contains(&fall), "{fall}");
        // With the sides exchanged each is the smaller on its own.
        assert_eq!(fall_rate_across([own, other], curve, false).0, f64::INFINITY);
    }
}
