//! The arithmetic that generated code is written in, on a single number or on a vector of numbers.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f64x8, mask64x8};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

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
