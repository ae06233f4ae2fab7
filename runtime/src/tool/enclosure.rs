//! Numbers that are known to lie between two ends over a box, with slopes that are known so: what generated
//! code computes of them encloses what it computes of every point of the box, in real arithmetic.
//!
//! Ends are rounded outward (Moore, *Interval Analysis*, 1966). A test that the ends do not decide goes both
//! ways, and what is selected by it lies between the ends of both.

use super::compiled::FeltLanes;
use super::{Ask, Evaluators, Lane};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// All numbers between two ends; none if the first is the larger.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Interval {
    low: f64,
    high: f64,
}

const ZERO: Interval = Interval { low: 0.0, high: 0.0 };
const NOTHING: Interval = Interval { low: f64::INFINITY, high: f64::NEG_INFINITY };
const EVERYTHING: Interval = Interval { low: f64::NEG_INFINITY, high: f64::INFINITY };

impl Interval {
    fn point(value: f64) -> Interval {
        Interval { low: value, high: value }
    }

    /// Rounds outward; where an end is not a number, nothing is known.
    fn out(low: f64, high: f64) -> Interval {
        if low.is_nan() || high.is_nan() {
            return EVERYTHING;
        }
        Interval { low: low.next_down(), high: high.next_up() }
    }

    fn hull(self, other: Interval) -> Interval {
        Interval { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    fn plus(self, other: Interval) -> Interval {
        // Nothing is rounded.
        match (self, other) {
            (ZERO, sum) | (sum, ZERO) => sum,
            _ => Interval::out(self.low + other.low, self.high + other.high),
        }
    }

    fn negated(self) -> Interval {
        Interval { low: -self.high, high: -self.low }
    }

    fn times(self, other: Interval) -> Interval {
        if self == ZERO || other == ZERO {
            return ZERO;
        }
        // 0 · ∞ stands for a product of finite numbers with a factor 0.
        let product = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        let ends = [
            product(self.low, other.low),
            product(self.low, other.high),
            product(self.high, other.low),
            product(self.high, other.high),
        ];
        // A product of ±1 is not rounded, and slopes of that are many.
        if [self, other].iter().any(|one| one.low == one.high && one.low.abs() == 1.0) {
            return Interval { low: ends[0].min(ends[3]), high: ends[0].max(ends[3]) };
        }
        let low = ends.into_iter().fold(f64::INFINITY, f64::min);
        Interval::out(low, ends.into_iter().fold(f64::NEG_INFINITY, f64::max))
    }

    fn reciprocal(self) -> Interval {
        if self.low <= 0.0 && self.high >= 0.0 {
            return EVERYTHING;
        }
        Interval::out(1.0 / self.high, 1.0 / self.low)
    }

    /// Of what is not negative, whatever rounding made of its enclosure.
    fn sqrt(self) -> Interval {
        let root = Interval::out(self.low.max(0.0).sqrt(), self.high.max(0.0).sqrt());
        Interval { low: root.low.max(0.0), ..root }
    }

    fn abs(self) -> Interval {
        match self {
            Interval { low, .. } if low >= 0.0 => self,
            Interval { high, .. } if high <= 0.0 => self.negated(),
            Interval { low, high } => Interval { low: 0.0, high: high.max(-low) },
        }
    }
}

/// What an enclosure is beside its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    Any,
    /// A coordinate, by its axis.
    Coordinate(usize),
    /// The square of one that is not negative, and that one's ends: √(x² + 0) is x, with its slope, at 0 too.
    Square(usize, Interval),
}

/// A function over a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure {
    value: Interval,
    slope: [Interval; 3],
    /// Where it stands for the numbers of regions, those up to 63 that it may be, a bit each; the last stands
    /// for all larger ones.
    regions: u64,
    form: Form,
}

/// A test's outcomes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Maybe {
    /// Whether it may succeed.
    pub yes: bool,
    /// Whether it may fail.
    pub no: bool,
}

impl BitAnd for Maybe {
    type Output = Maybe;
    fn bitand(self, other: Maybe) -> Maybe {
        Maybe { yes: self.yes && other.yes, no: self.no || other.no }
    }
}

impl BitOr for Maybe {
    type Output = Maybe;
    fn bitor(self, other: Maybe) -> Maybe {
        Maybe { yes: self.yes || other.yes, no: self.no && other.no }
    }
}

impl Not for Maybe {
    type Output = Maybe;
    fn not(self) -> Maybe {
        Maybe { yes: self.no, no: self.yes }
    }
}

impl Enclosure {
    const NOTHING: Enclosure =
        Enclosure { value: NOTHING, slope: [NOTHING; 3], regions: 0, form: Form::Any };

    /// A number that is the same everywhere.
    pub fn constant(value: f64) -> Enclosure {
        Enclosure::new(Interval::point(value), [ZERO; 3])
    }

    /// The coordinates of a box, each from one end to another.
    pub fn of_box(sides: [[f64; 2]; 3]) -> [Enclosure; 3] {
        [0, 1, 2].map(|axis| {
            let [low, high] = sides[axis];
            let value = Interval { low, high };
            if value == ZERO {
                return Enclosure::new(value, [ZERO; 3]);
            }
            let mut slope = [ZERO; 3];
            slope[axis] = Interval::point(1.0);
            Enclosure { form: Form::Coordinate(axis), ..Enclosure::new(value, slope) }
        })
    }

    fn new(value: Interval, slope: [Interval; 3]) -> Enclosure {
        Enclosure { value, slope, regions: 0, form: Form::Any }
    }

    fn is_constant(&self) -> bool {
        self.slope == [ZERO; 3]
    }

    fn scaled(self, value: Interval, by: Interval) -> Enclosure {
        Enclosure::new(value, self.slope.map(|part| part.times(by)))
    }

    /// What lies between the ends of both.
    pub fn hull(self, other: Enclosure) -> Enclosure {
        let slope = [0, 1, 2].map(|k| self.slope[k].hull(other.slope[k]));
        let regions = self.regions | other.regions;
        Enclosure { regions, ..Enclosure::new(self.value.hull(other.value), slope) }
    }

    /// The smaller of two, or the larger.
    fn lesser(a: Enclosure, b: Enclosure) -> Enclosure {
        if a.value.high <= b.value.low {
            return a;
        }
        if b.value.high <= a.value.low {
            return b;
        }
        let [low, high] = [a.value.low.min(b.value.low), a.value.high.min(b.value.high)];
        Enclosure { value: Interval { low, high }, ..a.hull(b) }
    }
}

impl Add for Enclosure {
    type Output = Enclosure;
    fn add(self, other: Enclosure) -> Enclosure {
        match (self, other) {
            (sum, nothing) | (nothing, sum) if nothing.value == ZERO && nothing.is_constant() => {
                sum
            }
            _ => {
                let slope = [0, 1, 2].map(|k| self.slope[k].plus(other.slope[k]));
                Enclosure::new(self.value.plus(other.value), slope)
            }
        }
    }
}

impl Neg for Enclosure {
    type Output = Enclosure;
    fn neg(self) -> Enclosure {
        Enclosure::new(self.value.negated(), self.slope.map(Interval::negated))
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
        let value = self.value.times(other.value);
        if let (Form::Coordinate(axis), true) = (self.form, self == other)
            && self.value.low >= 0.0
        {
            let twice = self.value.plus(self.value);
            return Enclosure { form: Form::Square(axis, self.value), ..self.scaled(value, twice) };
        }
        let slope = [0, 1, 2]
            .map(|k| self.slope[k].times(other.value).plus(other.slope[k].times(self.value)));
        Enclosure::new(value, slope)
    }
}

impl Div for Enclosure {
    type Output = Enclosure;
    fn div(self, other: Enclosure) -> Enclosure {
        let per = other.value.reciprocal();
        let value = self.value.times(per);
        let slope =
            [0, 1, 2].map(|k| self.slope[k].plus(value.times(other.slope[k]).negated()).times(per));
        Enclosure::new(value, slope)
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
        if let Form::Square(axis, value) = self.form {
            let mut slope = [ZERO; 3];
            slope[axis] = Interval::point(1.0);
            return Enclosure { form: Form::Coordinate(axis), ..Enclosure::new(value, slope) };
        }
        let root = self.value.sqrt();
        let twice = root.plus(root);
        let by =
            Interval { low: (1.0 / twice.high).next_down(), high: (1.0 / twice.low).next_up() };
        self.scaled(root, by)
    }
    fn abs(self) -> Enclosure {
        match self.value {
            Interval { low, .. } if low >= 0.0 => self,
            Interval { high, .. } if high <= 0.0 => -self,
            value => Enclosure { value: value.abs(), ..self.hull(-self) },
        }
    }
    fn le(a: Enclosure, b: Enclosure) -> Maybe {
        Maybe { yes: a.value.low <= b.value.high, no: a.value.high > b.value.low }
    }
    fn lt(a: Enclosure, b: Enclosure) -> Maybe {
        Maybe { yes: a.value.low < b.value.high, no: a.value.high >= b.value.low }
    }
    fn any(mask: Maybe) -> bool {
        mask.yes
    }
    fn select(mask: Maybe, yes: Enclosure, no: Enclosure) -> Enclosure {
        match mask {
            Maybe { yes: true, no: false } => yes,
            Maybe { yes: false, .. } => no,
            Maybe { yes: true, no: true } => yes.hull(no),
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

/// What a tool feels in a box of its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosed {
    /// Whether places of the box may be inside, and whether outside.
    pub inside: Maybe,
    /// Between what depth lies where it is inside; the first is the larger if it nowhere is.
    pub depth: [f64; 2],
    /// How depth changes along x, y and z, where it is inside.
    pub slope: [[f64; 2]; 3],
    /// The regions that places of the box may belong to, a bit each; the 64th stands for all larger ones too.
    pub regions: u64,
}

impl Enclosed {
    /// Of a compiled tool; a box of one with an axis lies in the half plane `y = 0`, `x ≥ 0`.
    pub fn of<T: Evaluators>(sides: [[f64; 2]; 3]) -> Enclosed {
        let present = Maybe { yes: true, no: false };
        let ask = Ask { depth: true, region: true, ..Ask::INSIDE };
        let one = Enclosure::constant(1.0);
        let FeltLanes { inside, depth, region, .. } =
            T::feel_lanes(Enclosure::of_box(sides), one, present, ask);
        let slope = depth.slope.map(|part| [part.low, part.high]);
        let depth = [depth.value.low, depth.value.high];
        Enclosed { inside, depth, slope, regions: region.regions }
    }
}

#[cfg(feature = "interpreter")]
impl Enclosed {
    /// Where no place was looked at yet.
    pub(super) fn nothing() -> Enclosed {
        const NONE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];
        let inside = Maybe { yes: false, no: false };
        Enclosed { inside, depth: NONE, slope: [NONE; 3], regions: 0 }
    }

    /// Takes places of a region with their depth, or places outside.
    pub(super) fn take(&mut self, owner: Option<(usize, Enclosure)>) {
        let Some((region, depth)) = owner else {
            self.inside.no = true;
            return;
        };
        let hull = |one: &mut [f64; 2], other: Interval| {
            *one = [one[0].min(other.low), one[1].max(other.high)];
        };
        self.inside.yes = true;
        self.regions |= bit(region);
        hull(&mut self.depth, depth.value);
        for (slope, part) in self.slope.iter_mut().zip(depth.slope) {
            hull(slope, part);
        }
    }
}

/// A region's bit of [`Enclosed::regions`].
pub(crate) fn bit(region: usize) -> u64 {
    1 << region.min(63)
}
