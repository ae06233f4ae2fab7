//! The arithmetic that generated code is written in: on a number, on a vector of numbers, and on dual numbers.
//!
//! Dual numbers are numbers with their derivatives along x, y and z. Generated code evaluated on them yields exact
//! derivatives, operation by operation, by the chain rule (Griewank and Walther, *Evaluating Derivatives*, 2008,
//! section 3.1).

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f64x8, mask64x8};
use std::ops::{Add, BitAnd, BitOr, BitOrAssign, Div, Mul, Neg, Not, Sub};

/// The square of the length below which a vector has no direction, 2^-960: smaller squares lose digits.
const SHORTEST_SQUARE: f64 = f64::from_bits((1023 - 960) << 52);

/// A number, or several numbers side by side.
///
/// Every operation is IEEE 754 double precision, rounded once, in every lane, so generated code produces the same bits
/// on every machine. For the same reason there is no fused multiply-add.
pub trait Lane:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// One truth value per lane.
    type Mask: Copy
        + BitAnd<Output = Self::Mask>
        + BitOr<Output = Self::Mask>
        + BitOrAssign
        + Not<Output = Self::Mask>;

    /// Returns a constant in as many lanes as `self` has.
    fn of(self, value: f64) -> Self;
    /// Returns the value of lanes in which nothing has been selected.
    #[inline(always)]
    fn none(self) -> Self {
        self.of(0.0)
    }
    /// Returns the square root.
    fn sqrt(self) -> Self;
    /// Returns the absolute value.
    fn abs(self) -> Self;
    /// Returns the mask of `a ≤ b`.
    fn le(a: Self, b: Self) -> Self::Mask;
    /// Returns the mask of `a < b`.
    fn lt(a: Self, b: Self) -> Self::Mask;
    /// Returns whether the mask is set in any lane.
    fn any(mask: Self::Mask) -> bool;
    /// Returns `yes` where the mask is set, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// Returns a constant where the mask is set, `self` elsewhere.
    #[inline(always)]
    fn or(self, mask: Self::Mask, value: f64) -> Self {
        Self::select(mask, self.of(value), self)
    }

    /// Returns the smaller number; `b` where they are equal.
    #[inline(always)]
    fn min(a: Self, b: Self) -> Self {
        // A comparison and a selection instead of a minimum instruction, whose result for equal zeros of both signs,
        // and for NaN, differs between machines.
        Self::select(Self::lt(a, b), a, b)
    }

    /// Returns the larger number; `b` where they are equal.
    #[inline(always)]
    fn max(a: Self, b: Self) -> Self {
        Self::select(Self::lt(b, a), a, b)
    }

    /// Does the same as [`Lane::select`], for region indices.
    #[inline(always)]
    fn pick(mask: Self::Mask, region: Self, before: Self) -> Self {
        Self::select(mask, region, before)
    }

    /// Returns a component of a unit vector: `part / length`, or `short` where the vector, whose length has this `square`, is too
    /// short to have a direction.
    #[inline(always)]
    fn component(square: Self, part: Self, length: Self, short: f64) -> Self {
        Self::select(Self::le(square, part.of(SHORTEST_SQUARE)), part.of(short), part / length)
    }

    /// Returns `a / b`, and 0 where `b` is 0.
    #[inline(always)]
    fn quotient(a: Self, b: Self) -> Self {
        let zero = a.of(0.0);
        // Both signs of zero are 0. All lanes divide, and the quotient of such a lane is discarded.
        Self::select(Self::le(b, zero) & Self::le(zero, b), zero, a / b)
    }
}

impl Lane for f64 {
    type Mask = bool;

    #[inline(always)]
    fn of(self, value: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> f64 {
        f64::abs(self)
    }
    #[inline(always)]
    fn le(a: f64, b: f64) -> bool {
        a <= b
    }
    #[inline(always)]
    fn lt(a: f64, b: f64) -> bool {
        a < b
    }
    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn select(mask: bool, yes: f64, no: f64) -> f64 {
        if mask { yes } else { no }
    }
}

impl<S: Simd> Lane for f64x8<S> {
    type Mask = mask64x8<S>;

    #[inline(always)]
    fn of(self, value: f64) -> Self {
        f64x8::splat(self.simd, value)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        SimdFloat::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        SimdBase::abs(self)
    }
    #[inline(always)]
    fn le(a: Self, b: Self) -> Self::Mask {
        a.simd_le(b)
    }
    #[inline(always)]
    fn lt(a: Self, b: Self) -> Self::Mask {
        a.simd_lt(b)
    }
    #[inline(always)]
    fn any(mask: Self::Mask) -> bool {
        mask.any_true()
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Select::select(mask, yes, no)
    }
}

/// A number and its derivatives along three directions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dual {
    /// The value.
    pub value: f64,
    /// The derivatives along the three directions.
    pub slope: [f64; 3],
}

impl Dual {
    /// Returns a constant, with derivatives 0.
    pub fn constant(value: f64) -> Dual {
        Dual { value, slope: [0.0; 3] }
    }

    /// Returns a point's coordinates, each with derivative 1 along its own axis.
    pub fn point(point: [f64; 3]) -> [Dual; 3] {
        [0, 1, 2].map(|axis| {
            let mut slope = [0.0; 3];
            slope[axis] = 1.0;
            Dual { value: point[axis], slope }
        })
    }

    /// Returns a function of one number, given the function's value and derivative there.
    #[inline(always)]
    fn chain(self, value: f64, derivative: f64) -> Dual {
        Dual { value, slope: self.slope.map(|slope| derivative * slope) }
    }

    /// Returns a function of two numbers, given its value and its partial derivatives.
    #[inline(always)]
    fn combine(self, other: Dual, value: f64, partials: [f64; 2]) -> Dual {
        let slope = [0, 1, 2].map(|k| partials[0] * self.slope[k] + partials[1] * other.slope[k]);
        Dual { value, slope }
    }
}

impl Add for Dual {
    type Output = Dual;
    #[inline(always)]
    fn add(self, other: Dual) -> Dual {
        self.combine(other, self.value + other.value, [1.0, 1.0])
    }
}

impl Sub for Dual {
    type Output = Dual;
    #[inline(always)]
    fn sub(self, other: Dual) -> Dual {
        self.combine(other, self.value - other.value, [1.0, -1.0])
    }
}

impl Mul for Dual {
    type Output = Dual;
    #[inline(always)]
    fn mul(self, other: Dual) -> Dual {
        self.combine(other, self.value * other.value, [other.value, self.value])
    }
}

impl Div for Dual {
    type Output = Dual;
    #[inline(always)]
    fn div(self, other: Dual) -> Dual {
        let value = self.value / other.value;
        // (a/b)' = a'/b - (a/b) b'/b: the quotient is at hand.
        self.combine(other, value, [1.0 / other.value, -value / other.value])
    }
}

impl Neg for Dual {
    type Output = Dual;
    #[inline(always)]
    fn neg(self) -> Dual {
        self.chain(-self.value, -1.0)
    }
}

impl Add<f64> for Dual {
    type Output = Dual;
    #[inline(always)]
    fn add(self, other: f64) -> Dual {
        Dual { value: self.value + other, ..self }
    }
}

impl Sub<f64> for Dual {
    type Output = Dual;
    #[inline(always)]
    fn sub(self, other: f64) -> Dual {
        Dual { value: self.value - other, ..self }
    }
}

impl Mul<f64> for Dual {
    type Output = Dual;
    #[inline(always)]
    fn mul(self, other: f64) -> Dual {
        self.chain(self.value * other, other)
    }
}

/// The derivatives of a square root and of an absolute value at 0 do not exist; they are set to 0. The quotient
/// [`Lane::quotient`] by 0 is the constant 0, with derivative 0.
impl Lane for Dual {
    type Mask = bool;

    #[inline(always)]
    fn of(self, value: f64) -> Dual {
        Dual::constant(value)
    }
    #[inline(always)]
    fn sqrt(self) -> Dual {
        let root = self.value.sqrt();
        self.chain(root, if root > 0.0 { 0.5 / root } else { 0.0 })
    }
    #[inline(always)]
    fn abs(self) -> Dual {
        // The sign of a zero is 1 or -1, neither of which is a derivative there.
        let sign = if self.value == 0.0 { 0.0 } else { self.value.signum() };
        self.chain(self.value.abs(), sign)
    }
    #[inline(always)]
    fn le(a: Dual, b: Dual) -> bool {
        a.value <= b.value
    }
    #[inline(always)]
    fn lt(a: Dual, b: Dual) -> bool {
        a.value < b.value
    }
    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn select(mask: bool, yes: Dual, no: Dual) -> Dual {
        if mask { yes } else { no }
    }
}
