//! Numbers that are known to lie in an interval over a box, together with enclosures of their slopes. Generated code
//! evaluated on them encloses, in real arithmetic, its results at every point of the box.
//!
//! A comparison that the intervals do not decide takes both branches, and the value selected by it lies in the hull of
//! both. A choice between two values also records both of them and the comparison that separates them: along a ridge,
//! where two depths are equal, neither formula bounds the depth on the other's side, but the comparison does.
//! Intervals are rounded outward (Moore, *Interval Analysis*, 1966).

use crate::interval::Interval;
use crate::tool::compiled::LaneEvaluation;
use crate::tool::{Evaluators, Lane, Outputs};
use std::ops::{Add, BitAnd, BitOr, BitOrAssign, Div, Mul, Neg, Not, Sub};

/// The form of an expression, where it allows a tighter enclosure than its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    Any,
    /// A coordinate, by its axis.
    Coordinate(usize),
    /// The square of a non-negative coordinate: axis, interval, and value at the reference point. Thus √(x² + 0) is x,
    /// with its slope, at 0 too.
    Square(usize, Interval, Interval),
}

/// An enclosure of a function over a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure {
    value: Interval,
    linear: LinearEnclosure,
    /// The alternatives, if an undecided comparison selected the value.
    choices: Choices,
    /// For region indices: the possible regions up to 63, one bit each; the last bit stands for all larger ones.
    regions: u64,
    form: Form,
}

/// Encloses 0, as the memory of an evaluation does before it begins.
impl Default for Enclosure {
    fn default() -> Enclosure {
        Enclosure::constant(0.0)
    }
}

impl Enclosure {
    const EMPTY: Enclosure = {
        let linear = LinearEnclosure { at: EMPTY, slope: [EMPTY; 3] };
        let choices = Choices::None;
        Enclosure { value: EMPTY, linear, choices, regions: 0, form: Form::Any }
    };

    /// Returns an enclosure of a constant.
    pub fn constant(value: f64) -> Enclosure {
        let value = Interval::point(value);
        Enclosure::new(value, LinearEnclosure { at: value, slope: [ZERO; 3] })
    }

    /// Returns the coordinates of a box, given its extent along x, y and z and a reference point in the box.
    pub fn of_box(sides: [Interval; 3], reference: [f64; 3]) -> [Enclosure; 3] {
        [0, 1, 2].map(|axis| {
            // The y of a tool with an axis: a constant keeps products with it exact.
            if sides[axis] == ZERO {
                return Enclosure::constant(0.0);
            }
            Enclosure::coordinate(axis, sides[axis], Interval::point(reference[axis]))
        })
    }

    fn coordinate(axis: usize, value: Interval, at: Interval) -> Enclosure {
        let mut slope = [ZERO; 3];
        slope[axis] = Interval::point(1.0);
        Enclosure {
            form: Form::Coordinate(axis),
            ..Enclosure::new(value, LinearEnclosure { at, slope })
        }
    }

    fn new(value: Interval, linear: LinearEnclosure) -> Enclosure {
        Enclosure { value, linear, choices: Choices::None, regions: 0, form: Form::Any }
    }

    /// Returns a function of `self`, given its values, its value at the reference point, and its derivative.
    fn chain(self, value: Interval, at: Interval, derivative: Interval) -> Enclosure {
        let slope = self.linear.slope.map(|slope| slope.times(derivative));
        Enclosure::new(value, LinearEnclosure { at, slope })
    }

    /// Returns the hull of both enclosures.
    pub fn hull(self, other: Enclosure) -> Enclosure {
        let slope = [0, 1, 2].map(|k| self.linear.slope[k].hull(other.linear.slope[k]));
        let linear = LinearEnclosure { at: self.linear.at.hull(other.linear.at), slope };
        let regions = self.regions | other.regions;
        Enclosure { regions, ..Enclosure::new(self.value.hull(other.value), linear) }
    }

    /// Returns the value as an alternative that holds where `gap` is at most 0.
    fn choices(self, gap: Option<LinearEnclosure>) -> Choices {
        match (self.choices, gap) {
            // A selection from nothing is the other value alone.
            _ if self == Enclosure::EMPTY => Choices::None,
            (Choices::None, Some(gap)) => Choices::One(Choice { value: self.linear, gap }),
            (Choices::None, None) => Choices::Many,
            (choices, _) => choices,
        }
    }

    /// Returns the smaller of two values.
    fn smaller(a: Enclosure, b: Enclosure) -> Enclosure {
        if a.value.high <= b.value.low {
            return a;
        }
        if b.value.high <= a.value.low {
            return b;
        }
        let LinearEnclosure { slope, .. } = a.hull(b).linear;
        let at = a.linear.at.min(b.linear.at);
        Enclosure::new(a.value.min(b.value), LinearEnclosure { at, slope })
    }
}

impl Add for Enclosure {
    type Output = Enclosure;
    fn add(self, other: Enclosure) -> Enclosure {
        // Keeps the form of a square, so that √(x² + 0) is x.
        if other == Enclosure::constant(0.0) {
            return self;
        }
        let (a, b) = (self.linear, other.linear);
        let slope = [0, 1, 2].map(|k| a.slope[k].plus(b.slope[k]));
        Enclosure::new(self.value.plus(other.value), LinearEnclosure { at: a.at.plus(b.at), slope })
    }
}

impl Neg for Enclosure {
    type Output = Enclosure;
    fn neg(self) -> Enclosure {
        Enclosure::new(self.value.negated(), self.linear.negated())
    }
}

impl Sub for Enclosure {
    type Output = Enclosure;
    fn sub(self, other: Enclosure) -> Enclosure {
        self + -other
    }
}

impl Mul for Enclosure {
    type Output = Enclosure;
    fn mul(self, other: Enclosure) -> Enclosure {
        let (a, b) = (self.linear, other.linear);
        let (value, at) = (self.value.times(other.value), a.at.times(b.at));
        if let (Form::Coordinate(axis), true) = (self.form, self == other)
            && self.value.low >= 0.0
        {
            let form = Form::Square(axis, self.value, a.at);
            return Enclosure { form, ..self.chain(value, at, self.value.plus(self.value)) };
        }
        let slope =
            [0, 1, 2].map(|k| a.slope[k].times(other.value).plus(b.slope[k].times(self.value)));
        Enclosure::new(value, LinearEnclosure { at, slope })
    }
}

impl Div for Enclosure {
    type Output = Enclosure;
    fn div(self, other: Enclosure) -> Enclosure {
        let (a, b) = (self.linear, other.linear);
        // (a/b)' = (a' - (a/b) b') / b, where all three are enclosed over the whole box.
        let reciprocal = other.value.reciprocal();
        let value = self.value.times(reciprocal);
        let slope =
            [0, 1, 2].map(|k| a.slope[k].plus(value.times(b.slope[k]).negated()).times(reciprocal));
        Enclosure::new(value, LinearEnclosure { at: a.at.times(b.at.reciprocal()), slope })
    }
}

impl Add<f64> for Enclosure {
    type Output = Enclosure;
    fn add(self, other: f64) -> Enclosure {
        self + Enclosure::constant(other)
    }
}

impl Sub<f64> for Enclosure {
    type Output = Enclosure;
    fn sub(self, other: f64) -> Enclosure {
        self - Enclosure::constant(other)
    }
}

impl Mul<f64> for Enclosure {
    type Output = Enclosure;
    fn mul(self, other: f64) -> Enclosure {
        self * Enclosure::constant(other)
    }
}

impl Lane for Enclosure {
    type Mask = Ternary;

    fn of(self, value: f64) -> Enclosure {
        Enclosure::constant(value)
    }
    fn none(self) -> Enclosure {
        Enclosure::EMPTY
    }
    fn sqrt(self) -> Enclosure {
        if let Form::Square(axis, value, at) = self.form {
            return Enclosure::coordinate(axis, value, at);
        }
        let root = self.value.sqrt();
        // The derivative of a root is 1 / (2 root).
        let doubled = root.plus(root);
        let derivative =
            Interval { low: (1.0 / doubled.high).next_down(), high: (1.0 / doubled.low).next_up() };
        self.chain(root, self.linear.at.sqrt(), derivative)
    }
    fn abs(self) -> Enclosure {
        match self.value {
            Interval { low, .. } if low >= 0.0 => self,
            Interval { high, .. } if high <= 0.0 => -self,
            value => {
                let linear =
                    LinearEnclosure { at: self.linear.at.abs(), ..self.hull(-self).linear };
                Enclosure::new(value.abs(), linear)
            }
        }
    }
    fn le(a: Enclosure, b: Enclosure) -> Ternary {
        Ternary::of([a.value.low <= b.value.high, a.value.high > b.value.low], &a, &b)
    }
    fn lt(a: Enclosure, b: Enclosure) -> Ternary {
        Ternary::of([a.value.low < b.value.high, a.value.high >= b.value.low], &a, &b)
    }
    fn any(mask: Ternary) -> bool {
        mask.yes
    }
    fn select(mask: Ternary, yes: Enclosure, no: Enclosure) -> Enclosure {
        match mask {
            Ternary { yes: true, no: false, .. } => yes,
            Ternary { yes: false, .. } => no,
            Ternary { yes: true, no: true, gaps } => {
                let choices = yes.choices(gaps[0]).and(no.choices(gaps[1]));
                Enclosure { choices, ..yes.hull(no) }
            }
        }
    }
    fn min(a: Enclosure, b: Enclosure) -> Enclosure {
        Enclosure::smaller(a, b)
    }
    fn max(a: Enclosure, b: Enclosure) -> Enclosure {
        -Enclosure::smaller(-a, -b)
    }
    #[inline]
    fn pick(mask: Ternary, region: Enclosure, mut before: Enclosure) -> Enclosure {
        // An index is a constant of the generated code, and only the bits of those that are possible are asked for.
        let bits = bit(region.value.low as usize);
        before.regions = match (mask.yes, mask.no) {
            (true, true) => before.regions | bits,
            (true, false) => bits,
            (false, _) => before.regions,
        };
        before
    }
}

/// Returns a region's bit in [`EvaluationEnclosure::regions`].
pub(crate) fn bit(region: usize) -> u64 {
    1 << region.min(63)
}

/// An enclosure of a tool's evaluation over a box of its frame.
#[derive(Clone, Copy, Debug)]
pub struct EvaluationEnclosure {
    /// True if points of the box may be inside.
    pub inside: bool,
    /// True if points of the box may be outside.
    pub outside: bool,
    /// The depth of the points inside.
    depth: Enclosure,
    /// The regions that points of the box may belong to, one bit each; the 64th bit stands for all larger indices too.
    pub regions: u64,
}

impl EvaluationEnclosure {
    /// Evaluates a compiled tool over a box. `sides` is the extent of the box along x, y and z; for a tool with an axis
    /// the box lies in the half plane `y = 0`, `x ≥ 0`. Slopes are taken from `reference`, a point of the box.
    pub fn of<T: Evaluators>(sides: [Interval; 3], reference: [f64; 3]) -> EvaluationEnclosure {
        EvaluationEnclosure::evaluated(sides, reference, T::evaluate_lanes)
    }

    /// Does the same with any evaluator.
    pub(in crate::tool) fn evaluated(
        sides: [Interval; 3],
        reference: [f64; 3],
        evaluate: impl FnOnce([Enclosure; 3], Enclosure, Ternary, Outputs) -> LaneEvaluation<Enclosure>,
    ) -> EvaluationEnclosure {
        let present = Ternary { yes: true, no: false, gaps: [None; 2] };
        let outputs = Outputs { depth: true, region: true, ..Outputs::INSIDE };
        let one = Enclosure::constant(1.0);
        let LaneEvaluation { inside, depth, region, .. } =
            evaluate(Enclosure::of_box(sides, reference), one, present, outputs);
        EvaluationEnclosure {
            inside: inside.yes,
            outside: inside.no,
            depth,
            regions: region.regions,
        }
    }

    /// Returns an upper bound on the depth of all points of the box.
    pub fn max_depth(&self) -> f64 {
        self.depth.value.high
    }

    /// Returns a lower bound on the depth of the points of the box that are inside.
    pub fn min_depth(&self) -> f64 {
        self.depth.value.low
    }

    /// Returns a lower bound on the rate at which the depth of points inside grows along a direction, anywhere in the box.
    pub fn min_rise(&self, direction: [f64; 3]) -> f64 {
        let rises =
            [0, 1, 2].map(|k| self.depth.linear.slope[k].times(Interval::point(direction[k])));
        rises.into_iter().fold(ZERO, Interval::plus).low
    }

    /// Returns an upper bound on the depth of all points in the convex hull of three corners. Infinite or NaN where a
    /// slope is not known.
    ///
    /// `displacements` has the displacement of each corner from the reference point, as an interval along each of x, y
    /// and z. The reference point has to lie in the box and in the hull.
    ///
    /// By the mean value theorem, a region's formula at a point is its value at the reference point plus slopes times
    /// the displacement. A choice `f` that holds where `g ≤ 0` is at most `f - λ g` there, for any `λ ≥ 0` (Lagrange).
    /// The minimum over `λ` of the maximum over the corners lies at 0 or where two corners have equal bounds. Where the
    /// argument of a square root may be negative its slope is unbounded, and so is the bound of some corner.
    pub fn max_depth_in_hull(&self, displacements: [[Interval; 3]; 3]) -> f64 {
        let Choices::Two(pair) = self.depth.choices else {
            let depths =
                displacements.map(|displacement| self.depth.linear.values(displacement).high);
            return depths[0].max(depths[1]).max(depths[2]);
        };
        let bounds = pair.map(|Choice { value, gap }| {
            let extremes = displacements.map(|displacement| CornerExtremes {
                value: value.values(displacement).high,
                gap: gap.values(displacement).low,
            });
            let mut bound = lagrangian_bound(&extremes, 0.0);
            for (first, second) in [(0, 1), (1, 2), (2, 0)] {
                let (first, second) = (&extremes[first], &extremes[second]);
                let multiplier = (first.value - second.value) / (first.gap - second.gap);
                if multiplier > 0.0 && multiplier.is_finite() {
                    bound = bound.min(lagrangian_bound(&extremes, multiplier));
                }
            }
            bound
        });
        bounds[0].max(bounds[1])
    }
}

/// The greatest value and the least gap of a choice at a corner.
struct CornerExtremes {
    value: f64,
    gap: f64,
}

/// Returns the maximum over the corners of an upper bound of `value - multiplier · gap`.
fn lagrangian_bound(corners: &[CornerExtremes; 3], multiplier: f64) -> f64 {
    corners
        .iter()
        .map(|corner| {
            // Avoids 0 · ∞, which is NaN.
            let product =
                if multiplier > 0.0 { (multiplier * corner.gap).next_down() } else { 0.0 };
            (corner.value - product).next_up()
        })
        .reduce(f64::max)
        .expect("there are three corners")
}

/// A first-order enclosure of a function over a box: its value at a reference point, and its slopes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct LinearEnclosure {
    at: Interval,
    slope: [Interval; 3],
}

impl LinearEnclosure {
    fn negated(self) -> LinearEnclosure {
        LinearEnclosure { at: self.at.negated(), slope: self.slope.map(Interval::negated) }
    }

    /// Returns the function's values at a point whose displacement from the reference point is known as an
    /// interval along each axis.
    fn values(&self, displacement: [Interval; 3]) -> Interval {
        let terms = (0..3).map(|k| self.slope[k].times(displacement[k]));
        terms.fold(self.at, Interval::plus)
    }
}

/// A value that a function may take where another function, the gap, is at most 0.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Choice {
    value: LinearEnclosure,
    gap: LinearEnclosure,
}

/// The alternatives of a choice.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Choices {
    None,
    One(Choice),
    Two([Choice; 2]),
    Many,
}

impl Choices {
    fn and(self, other: Choices) -> Choices {
        match (self, other) {
            (Choices::None, choices) | (choices, Choices::None) => choices,
            (Choices::One(first), Choices::One(second)) => Choices::Two([first, second]),
            _ => Choices::Many,
        }
    }
}

/// The possible outcomes of a comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ternary {
    /// True if the comparison may hold.
    pub yes: bool,
    /// True if the comparison may fail.
    pub no: bool,
    /// Functions that are at most 0 where the comparison is true and where it is false, if known.
    gaps: [Option<LinearEnclosure>; 2],
}

impl Ternary {
    /// Returns the outcome of the comparison `a ≤ b`, given whether it may be true and whether it may be false.
    fn of([yes, no]: [bool; 2], a: &Enclosure, b: &Enclosure) -> Ternary {
        // A decided comparison selects one value, which needs no gap.
        let gap = (yes && no).then(|| {
            let slope = [0, 1, 2].map(|k| a.linear.slope[k].plus(b.linear.slope[k].negated()));
            LinearEnclosure { at: a.linear.at.plus(b.linear.at.negated()), slope }
        });
        Ternary { yes, no, gaps: [gap, gap.map(LinearEnclosure::negated)] }
    }
}

impl BitAnd for Ternary {
    type Output = Ternary;
    fn bitand(self, other: Ternary) -> Ternary {
        let yes = self.gaps[0].or(other.gaps[0]);
        // If both may fail, it is not known which one does.
        let no = match (self.no, other.no) {
            (true, true) => None,
            (_, true) => other.gaps[1],
            _ => self.gaps[1],
        };
        Ternary { yes: self.yes && other.yes, no: self.no || other.no, gaps: [yes, no] }
    }
}

impl BitOr for Ternary {
    type Output = Ternary;
    fn bitor(mut self, other: Ternary) -> Ternary {
        self |= other;
        self
    }
}

impl BitOrAssign for Ternary {
    #[inline]
    fn bitor_assign(&mut self, other: Ternary) {
        // If both may hold, it is not known which one does.
        match (self.yes, other.yes) {
            (true, true) => self.gaps[0] = None,
            (false, true) => self.gaps[0] = other.gaps[0],
            _ => {}
        }
        self.gaps[1] = self.gaps[1].or(other.gaps[1]);
        self.yes |= other.yes;
        self.no &= other.no;
    }
}

impl Not for Ternary {
    type Output = Ternary;
    #[inline]
    fn not(self) -> Ternary {
        let [yes, no] = self.gaps;
        Ternary { yes: self.no, no: self.yes, gaps: [no, yes] }
    }
}

const ZERO: Interval = Interval { low: 0.0, high: 0.0 };
/// No number at all.
const EMPTY: Interval = Interval { low: f64::INFINITY, high: f64::NEG_INFINITY };
const ENTIRE: Interval = Interval { low: f64::NEG_INFINITY, high: f64::INFINITY };

impl Interval {
    fn point(value: f64) -> Interval {
        Interval { low: value, high: value }
    }

    /// Rounds outward. Returns all numbers if an end is NaN.
    fn outward(low: f64, high: f64) -> Interval {
        if low.is_nan() || high.is_nan() {
            return ENTIRE;
        }
        Interval { low: low.next_down(), high: high.next_up() }
    }

    fn hull(self, other: Interval) -> Interval {
        Interval { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    fn plus(self, other: Interval) -> Interval {
        // A sum with 0 is exact.
        match (self, other) {
            (ZERO, sum) | (sum, ZERO) => sum,
            _ => Interval::outward(self.low + other.low, self.high + other.high),
        }
    }

    fn negated(self) -> Interval {
        Interval { low: -self.high, high: -self.low }
    }

    fn times(self, other: Interval) -> Interval {
        if self == ZERO || other == ZERO {
            return ZERO;
        }
        let ends = [
            product_of_ends(self.low, other.low),
            product_of_ends(self.low, other.high),
            product_of_ends(self.high, other.low),
            product_of_ends(self.high, other.high),
        ];
        // A product with ±1 is exact, and many slopes are ±1.
        if [self, other].iter().any(|factor| factor.low == factor.high && factor.low.abs() == 1.0) {
            return Interval { low: ends[0].min(ends[3]), high: ends[0].max(ends[3]) };
        }
        let low = ends.into_iter().fold(f64::INFINITY, f64::min);
        Interval::outward(low, ends.into_iter().fold(f64::NEG_INFINITY, f64::max))
    }

    fn reciprocal(self) -> Interval {
        // The divisor may be 0.
        if self.low <= 0.0 && self.high >= 0.0 {
            return ENTIRE;
        }
        Interval::outward(1.0 / self.high, 1.0 / self.low)
    }

    /// Returns the square root. The argument is taken as non-negative, even if rounding made its lower end negative.
    fn sqrt(self) -> Interval {
        let root = Interval::outward(self.low.max(0.0).sqrt(), self.high.max(0.0).sqrt());
        // Rounding outward must not make a root negative: its reciprocal would be all numbers.
        Interval { low: root.low.max(0.0), ..root }
    }

    fn min(self, other: Interval) -> Interval {
        Interval { low: self.low.min(other.low), high: self.high.min(other.high) }
    }

    fn abs(self) -> Interval {
        match self {
            Interval { low, .. } if low >= 0.0 => self,
            Interval { high, .. } if high <= 0.0 => self.negated(),
            Interval { low, high } => Interval { low: 0.0, high: high.max(-low) },
        }
    }
}

/// Returns the product of two ends. An infinite end bounds finite numbers, so its product with 0 is 0.
fn product_of_ends(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
}
