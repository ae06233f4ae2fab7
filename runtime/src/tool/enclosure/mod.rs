//! Numbers that are known to lie in an interval over a box, together with enclosures of their slopes. Generated code
//! evaluated on them encloses, in real arithmetic, its results at every point of the box.
//!
//! A comparison that the intervals do not decide takes both branches, and the value selected by it lies in the hull of
//! both. A choice between two values also records both of them and the comparison that separates them: along a ridge,
//! where two depths are equal, neither formula bounds the depth on the other's side, but the comparison does.

mod enclosed;
mod interval;
mod ternary;

pub use enclosed::EvaluationEnclosure;
pub use ternary::Ternary;

use super::Lane;
use crate::interval::Interval;
use interval::{EMPTY, ZERO};
use std::ops::{Add, Div, Mul, Neg, Sub};
use ternary::{Choice, Choices, LinearEnclosure};

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
    fn pick(mask: Ternary, region: Enclosure, before: Enclosure) -> Enclosure {
        let regions = bit(region.value.low as usize);
        Lane::select(mask, Enclosure { regions, ..region }, before)
    }
}

/// Returns a region's bit in [`EvaluationEnclosure::regions`].
pub(crate) fn bit(region: usize) -> u64 {
    1 << region.min(63)
}
