//! The arithmetic that generated code is written in: one number, or a vector of them.

use fearless_simd::{
    Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, f64x8, mask32x16, mask64x8,
};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// A number, or several side by side.
///
/// Every operation is IEEE 754 double precision, rounded once, in every lane, so that generated
/// code has the same bits on every machine. There is no fused multiply-add on purpose. (Only
/// [`Evaluators::near_lanes`](super::Evaluators::near_lanes) is also run in single precision.)
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
    /// One given in single precision.
    #[inline(always)]
    fn single(self, value: f32) -> Self {
        self.of(f64::from(value))
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

/// Sixteen numbers in single precision; constants are rounded to it.
#[derive(Clone, Copy)]
pub(crate) struct Singles<S: Simd>(pub(crate) f32x16<S>);

/// One of them.
#[derive(Clone, Copy)]
pub(crate) struct Single(pub(crate) f32);

macro_rules! single_precision {
    ($type:ident $(<$simd:ident: $bound:ident>)?) => {
        single_precision!(@ $type $(<$simd: $bound>)?: Add add, Sub sub, Mul mul, Div div);

        impl$(<$simd: $bound>)? Neg for $type$(<$simd>)? {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                $type(-self.0)
            }
        }
    };
    (@ $type:ident $(<$simd:ident: $bound:ident>)?:) => {};
    (@ $type:ident $(<$simd:ident: $bound:ident>)?: $trait:ident $function:ident $(, $($more:tt)*)?) => {
        impl$(<$simd: $bound>)? $trait for $type$(<$simd>)? {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                $type($trait::$function(self.0, other.0))
            }
        }
        impl$(<$simd: $bound>)? $trait<f64> for $type$(<$simd>)? {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: f64) -> Self {
                $type($trait::$function(self.0, other as f32))
            }
        }
        single_precision!(@ $type $(<$simd: $bound>)?: $($($more)*)?);
    };
}
single_precision!(Singles<S: Simd>);
single_precision!(Single);

impl<S: Simd> Lane for Singles<S> {
    type Mask = mask32x16<S>;

    #[inline(always)]
    fn of(self, value: f64) -> Self {
        Singles(f32x16::splat(self.0.simd, value as f32))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Singles(SimdFloat::sqrt(self.0))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Singles(SimdBase::abs(self.0))
    }
    #[inline(always)]
    fn le(a: Self, b: Self) -> Self::Mask {
        a.0.simd_le(b.0)
    }
    #[inline(always)]
    fn lt(a: Self, b: Self) -> Self::Mask {
        a.0.simd_lt(b.0)
    }
    #[inline(always)]
    fn any(mask: Self::Mask) -> bool {
        mask.any_true()
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Singles(Select::select(mask, yes.0, no.0))
    }
    #[inline(always)]
    fn max(a: Self, b: Self) -> Self {
        Singles(a.0.max(b.0))
    }
}

impl Lane for Single {
    type Mask = bool;

    #[inline(always)]
    fn of(self, value: f64) -> Self {
        Single(value as f32)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Single(self.0.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Single(self.0.abs())
    }
    #[inline(always)]
    fn le(a: Self, b: Self) -> bool {
        a.0 <= b.0
    }
    #[inline(always)]
    fn lt(a: Self, b: Self) -> bool {
        a.0 < b.0
    }
    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
}
