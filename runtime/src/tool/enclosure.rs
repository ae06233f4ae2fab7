//! Numbers that are known to lie between two ends over a box, with slopes that are known so: what generated
//! code computes of them encloses what it computes of every point of the box, in real arithmetic.
//!
//! Ends are rounded outward (Moore, *Interval Analysis*, 1966). A test that the ends do not decide goes both
//! ways, and what is selected by it lies between the ends of both. Of a choice between two it is remembered
//! what they are and by what they are told apart: along a ridge, where two depths are as small, neither bounds
//! the other's side, but the test does.

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

    fn lesser(self, other: Interval) -> Interval {
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

/// A function over a box: at one of its points, and how it changes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Course {
    at: Interval,
    slope: [Interval; 3],
}

impl Course {
    fn negated(self) -> Course {
        Course { at: self.at.negated(), slope: self.slope.map(Interval::negated) }
    }

    /// Its values at a point between ends from the known one.
    fn values(&self, way: [[f64; 2]; 3]) -> Interval {
        let parts = (0..3).map(|k| {
            let [low, high] = way[k];
            self.slope[k].times(Interval { low, high })
        });
        parts.fold(self.at, Interval::plus)
    }
}

/// What a function may be, where another is not more than 0.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Choice {
    value: Course,
    gap: Course,
}

/// What a choice was between.
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
            (Choices::None, all) | (all, Choices::None) => all,
            (Choices::One(one), Choices::One(other)) => Choices::Two([one, other]),
            _ => Choices::Many,
        }
    }
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

/// A test's outcomes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Maybe {
    /// Whether it may succeed.
    pub yes: bool,
    /// Whether it may fail.
    pub no: bool,
    /// Not more than 0 where it succeeds, and where it fails, if that is known.
    gaps: [Option<Course>; 2],
}

impl Maybe {
    /// Whether one is no more than another, which may be so and may not.
    fn of([yes, no]: [bool; 2], less: &Enclosure, more: &Enclosure) -> Maybe {
        let gap = || {
            let slope =
                [0, 1, 2].map(|k| less.course.slope[k].plus(more.course.slope[k].negated()));
            Course { at: less.course.at.plus(more.course.at.negated()), slope }
        };
        let gap = (yes && no).then(gap);
        Maybe { yes, no, gaps: [gap, gap.map(Course::negated)] }
    }
}

impl BitAnd for Maybe {
    type Output = Maybe;
    fn bitand(self, other: Maybe) -> Maybe {
        let yes = self.gaps[0].or(other.gaps[0]);
        // Of two that may fail it is not known which does.
        let no = match (self.no, other.no) {
            (true, true) => None,
            (_, true) => other.gaps[1],
            _ => self.gaps[1],
        };
        Maybe { yes: self.yes && other.yes, no: self.no || other.no, gaps: [yes, no] }
    }
}

impl BitOr for Maybe {
    type Output = Maybe;
    fn bitor(self, other: Maybe) -> Maybe {
        !(!self & !other)
    }
}

impl Not for Maybe {
    type Output = Maybe;
    fn not(self) -> Maybe {
        let [yes, no] = self.gaps;
        Maybe { yes: self.no, no: self.yes, gaps: [no, yes] }
    }
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

/// What a tool feels in a box of its frame.
#[derive(Clone, Copy, Debug)]
pub struct Enclosed {
    /// Whether places of the box may be inside.
    pub inside: bool,
    /// Whether places of the box may be outside.
    pub outside: bool,
    /// What depth is where it is inside.
    depth: Enclosure,
    /// The regions that places of the box may belong to, a bit each; the 64th stands for all larger ones too.
    pub regions: u64,
}

impl Enclosed {
    /// Of a compiled tool; a box of one with an axis lies in the half plane `y = 0`, `x ≥ 0`. Slopes are told from
    /// a point of the box.
    pub fn of<T: Evaluators>(sides: [[f64; 2]; 3], at: [f64; 3]) -> Enclosed {
        let present = Maybe { yes: true, no: false, gaps: [None; 2] };
        let ask = Ask { depth: true, region: true, ..Ask::INSIDE };
        let one = Enclosure::constant(1.0);
        let FeltLanes { inside, depth, region, .. } =
            T::feel_lanes(Enclosure::of_box(sides, at), one, present, ask);
        Enclosed { inside: inside.yes, outside: inside.no, depth, regions: region.regions }
    }

    /// No less than the depth of any place of the box.
    pub fn most(&self) -> f64 {
        self.depth.value.high
    }

    /// No less than the depth of any place of the convex hull of some, given how far each is from the point along x,
    /// y and z: between two ends each. Infinite or NaN where a slope is not known.
    ///
    /// By the mean value theorem a region's formula at a place is that at the point and slopes times the way. A choice `f` where `g ≤ 0` is no more than `f - λ g` there, for any `λ ≥ 0` (Lagrange); the least
    /// of the most of that at the corners is at 0 or where two corners are as much.
    pub fn most_between(&self, ways: [[[f64; 2]; 3]; 3]) -> f64 {
        let Choices::Two(two) = self.depth.choices else {
            let most = ways.map(|way| self.depth.course.values(way).high);
            return most[0].max(most[1]).max(most[2]);
        };
        let bounds = two.map(|Choice { value, gap }| {
            let ends = ways.map(|way| (value.values(way).high, gap.values(way).low));
            // Not 0 times what may be infinite.
            let most = |scale: f64| {
                let less = |gap: f64| if scale > 0.0 { scale * gap } else { 0.0 };
                let at = ends.map(|(value, gap)| value - less(gap));
                at[0].max(at[1]).max(at[2])
            };
            let mut least = most(0.0);
            for (first, second) in [(0, 1), (1, 2), (2, 0)] {
                let scale = (ends[first].0 - ends[second].0) / (ends[first].1 - ends[second].1);
                if scale > 0.0 && scale.is_finite() {
                    least = least.min(most(scale));
                }
            }
            least
        });
        bounds[0].max(bounds[1])
    }
}

#[cfg(feature = "interpreter")]
impl Enclosed {
    /// Where no place was looked at yet.
    pub(super) fn nothing() -> Enclosed {
        Enclosed { inside: false, outside: false, depth: Enclosure::NOTHING, regions: 0 }
    }

    /// Takes places of a region with their depth, or places outside: those where a test that was not decided is
    /// below 0, or above.
    pub(super) fn take(
        &mut self,
        owner: Option<(usize, Enclosure)>,
        test: Option<(Enclosure, bool)>,
    ) {
        let Some((region, depth)) = owner else {
            self.outside = true;
            return;
        };
        let gap =
            test.map(|(value, below)| if below { value.course } else { value.course.negated() });
        let choices = if self.depth == Enclosure::NOTHING && gap.is_none() {
            depth.choices
        } else {
            self.depth.choices.and(depth.choices(gap))
        };
        self.inside = true;
        self.regions |= bit(region);
        self.depth = Enclosure { choices, ..self.depth.hull(depth) };
    }
}

/// A region's bit of [`Enclosed::regions`].
pub(crate) fn bit(region: usize) -> u64 {
    1 << region.min(63)
}
