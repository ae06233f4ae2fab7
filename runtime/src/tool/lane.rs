//! The arithmetic that generated code is written in: one number, or a vector of them.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f64x8, mask64x8};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// A number, or several side by side.
///
/// Every operation is IEEE 754 double precision, rounded once, in every lane, so that generated
/// code has the same bits on every machine. There is no fused multiply-add on purpose.
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
    /// Yes or no for every lane.
    type Mask: Copy
        + BitAnd<Output = Self::Mask>
        + BitOr<Output = Self::Mask>
        + Not<Output = Self::Mask>;

    /// A constant in all the lanes that `self` has.
    fn of(self, value: f64) -> Self;
    /// What stands where nothing is selected.
    #[inline(always)]
    fn none(self) -> Self {
        self.of(0.0)
    }
    /// Square root.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// `a ≤ b`
    fn le(a: Self, b: Self) -> Self::Mask;
    /// `a < b`
    fn lt(a: Self, b: Self) -> Self::Mask;
    /// Whether the mask is set anywhere.
    fn any(mask: Self::Mask) -> bool;
    /// `yes` where the mask is set, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// The smaller; `b` where they are equal.
    #[inline(always)]
    fn min(a: Self, b: Self) -> Self {
        Self::select(Self::lt(a, b), a, b)
    }

    /// The larger; `b` where they are equal.
    #[inline(always)]
    fn max(a: Self, b: Self) -> Self {
        Self::select(Self::lt(b, a), a, b)
    }

    /// [`Lane::select`] for the numbers of regions.
    #[inline(always)]
    fn pick(mask: Self::Mask, region: Self, before: Self) -> Self {
        Self::select(mask, region, before)
    }

    /// `a / b`, and 0 where `b` is 0.
    #[inline(always)]
    fn quotient(a: Self, b: Self) -> Self {
        let zero = a.of(0.0);
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
