//! Numbers that are known to lie between two ends over a box, with slopes that are known so: what generated
//! code computes of them encloses what it computes of every point of the box, in real arithmetic.
//!
//! A test that the ends do not decide goes both
//! ways, and what is selected by it lies between the ends of both. Of a choice between two it is remembered
//! what they are and by what they are told apart: along a ridge, where two depths are as small, neither bounds
//! the other's side, but the test does.

mod choice;
mod enclosed;
mod interval;

pub use choice::Maybe;
pub use enclosed::Enclosed;

use super::Lane;
use choice::{Choice, Choices, Course};
use interval::{Interval, NOTHING, ZERO};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// What an enclosure is beside its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    Any,
    /// A coordinate, by its axis.
    Coordinate(usize),
    /// The square of one that is not negative, with its ends, and what it is at the point: √(x² + 0) is x, with
    /// its slope, at 0 too.
    Square(usize, Interval, Interval),
}

/// A function over a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure {
    value: Interval,
    course: Course,
    /// If it was chosen by a test that was not decided.
    choices: Choices,
    /// Where it stands for the numbers of regions, those up to 63 that it may be, a bit each; the last stands
    /// for all larger ones.
    regions: u64,
    form: Form,
}

impl Enclosure {
    const NOTHING: Enclosure = {
        let course = Course { at: NOTHING, slope: [NOTHING; 3] };
        let choices = Choices::None;
        Enclosure { value: NOTHING, course, choices, regions: 0, form: Form::Any }
    };

    /// A number that is the same everywhere.
    pub fn constant(value: f64) -> Enclosure {
        let value = Interval::point(value);
        Enclosure::new(value, Course { at: value, slope: [ZERO; 3] })
    }

    /// The coordinates of a box, each from one end to another, and at one of its points.
    pub fn of_box(sides: [[f64; 2]; 3], at: [f64; 3]) -> [Enclosure; 3] {
        [0, 1, 2].map(|axis| {
            let [low, high] = sides[axis];
            if [low, high] == [0.0; 2] {
                return Enclosure::constant(0.0);
            }
            Enclosure::coordinate(axis, Interval { low, high }, Interval::point(at[axis]))
        })
    }

    fn coordinate(axis: usize, value: Interval, at: Interval) -> Enclosure {
        let mut slope = [ZERO; 3];
        slope[axis] = Interval::point(1.0);
        Enclosure { form: Form::Coordinate(axis), ..Enclosure::new(value, Course { at, slope }) }
    }

    fn new(value: Interval, course: Course) -> Enclosure {
        Enclosure { value, course, choices: Choices::None, regions: 0, form: Form::Any }
    }

    /// A function of it, by its values, its value at the point, and its derivative.
    fn chain(self, value: Interval, at: Interval, by: Interval) -> Enclosure {
        let slope = self.course.slope.map(|part| part.times(by));
        Enclosure::new(value, Course { at, slope })
    }

    /// What lies between the ends of both.
    pub fn hull(self, other: Enclosure) -> Enclosure {
        let slope = [0, 1, 2].map(|k| self.course.slope[k].hull(other.course.slope[k]));
        let course = Course { at: self.course.at.hull(other.course.at), slope };
        let regions = self.regions | other.regions;
        Enclosure { regions, ..Enclosure::new(self.value.hull(other.value), course) }
    }

    /// It as a choice where something is not more than 0.
    fn choices(self, gap: Option<Course>) -> Choices {
        match (self.choices, gap) {
            _ if self == Enclosure::NOTHING => Choices::None,
            (Choices::None, Some(gap)) => Choices::One(Choice { value: self.course, gap }),
            (Choices::None, None) => Choices::Many,
            (choices, _) => choices,
        }
    }

    /// The smaller of two.
    fn lesser(a: Enclosure, b: Enclosure) -> Enclosure {
        if a.value.high <= b.value.low {
            return a;
        }
        if b.value.high <= a.value.low {
            return b;
        }
        let Course { slope, .. } = a.hull(b).course;
        let at = a.course.at.lesser(b.course.at);
        Enclosure::new(a.value.lesser(b.value), Course { at, slope })
    }
}

impl Add for Enclosure {
    type Output = Enclosure;
    fn add(self, other: Enclosure) -> Enclosure {
        // √(x² + 0) is x.
        if other == Enclosure::constant(0.0) {
            return self;
        }
        let (a, b) = (self.course, other.course);
        let slope = [0, 1, 2].map(|k| a.slope[k].plus(b.slope[k]));
        Enclosure::new(self.value.plus(other.value), Course { at: a.at.plus(b.at), slope })
    }
}

impl Neg for Enclosure {
    type Output = Enclosure;
    fn neg(self) -> Enclosure {
        Enclosure::new(self.value.negated(), self.course.negated())
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
        let (a, b) = (self.course, other.course);
        let (value, at) = (self.value.times(other.value), a.at.times(b.at));
        if let (Form::Coordinate(axis), true) = (self.form, self == other)
            && self.value.low >= 0.0
        {
            let form = Form::Square(axis, self.value, a.at);
            return Enclosure { form, ..self.chain(value, at, self.value.plus(self.value)) };
        }
        let slope =
            [0, 1, 2].map(|k| a.slope[k].times(other.value).plus(b.slope[k].times(self.value)));
        Enclosure::new(value, Course { at, slope })
    }
}

impl Div for Enclosure {
    type Output = Enclosure;
    fn div(self, other: Enclosure) -> Enclosure {
        let (a, b) = (self.course, other.course);
        let per = other.value.reciprocal();
        let value = self.value.times(per);
        let slope =
            [0, 1, 2].map(|k| a.slope[k].plus(value.times(b.slope[k]).negated()).times(per));
        Enclosure::new(value, Course { at: a.at.times(b.at.reciprocal()), slope })
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
    type Mask = Maybe;

    fn of(self, value: f64) -> Enclosure {
        Enclosure::constant(value)
    }
    fn none(self) -> Enclosure {
        Enclosure::NOTHING
    }
    fn sqrt(self) -> Enclosure {
        if let Form::Square(axis, value, at) = self.form {
            return Enclosure::coordinate(axis, value, at);
        }
        let root = self.value.sqrt();
        let twice = root.plus(root);
        let by =
            Interval { low: (1.0 / twice.high).next_down(), high: (1.0 / twice.low).next_up() };
        self.chain(root, self.course.at.sqrt(), by)
    }
    fn abs(self) -> Enclosure {
        match self.value {
            Interval { low, .. } if low >= 0.0 => self,
            Interval { high, .. } if high <= 0.0 => -self,
            value => {
                let course = Course { at: self.course.at.abs(), ..self.hull(-self).course };
                Enclosure::new(value.abs(), course)
            }
        }
    }
    fn le(a: Enclosure, b: Enclosure) -> Maybe {
        Maybe::of([a.value.low <= b.value.high, a.value.high > b.value.low], &a, &b)
    }
    fn lt(a: Enclosure, b: Enclosure) -> Maybe {
        Maybe::of([a.value.low < b.value.high, a.value.high >= b.value.low], &a, &b)
    }
    fn any(mask: Maybe) -> bool {
        mask.yes
    }
    fn select(mask: Maybe, yes: Enclosure, no: Enclosure) -> Enclosure {
        match mask {
            Maybe { yes: true, no: false, .. } => yes,
            Maybe { yes: false, .. } => no,
            Maybe { yes: true, no: true, gaps } => {
                let choices = yes.choices(gaps[0]).and(no.choices(gaps[1]));
                Enclosure { choices, ..yes.hull(no) }
            }
        }
    }
    fn min(a: Enclosure, b: Enclosure) -> Enclosure {
        Enclosure::lesser(a, b)
    }
    fn max(a: Enclosure, b: Enclosure) -> Enclosure {
        -Enclosure::lesser(-a, -b)
    }
    fn pick(mask: Maybe, region: Enclosure, before: Enclosure) -> Enclosure {
        let regions = bit(region.value.low as usize);
        Lane::select(mask, Enclosure { regions, ..region }, before)
    }
}

/// A region's bit of [`Enclosed::regions`].
pub(crate) fn bit(region: usize) -> u64 {
    1 << region.min(63)
}
