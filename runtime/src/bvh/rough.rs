//! The formats that boxes and points are held to a tool's envelope in: `f32` with its margin, or `f64`.

use super::WIDTH;
use fearless_simd::{Simd, SimdBase, SimdMask, SimdWiden, f32x16, f64x8, mask32x16, mask64x8};
use std::ops::{Add, Mul, Sub};

/// A format in which it is found out what a tool may reach.
pub trait Rough:
    Copy + Default + PartialOrd + Add<Output = Self> + Mul<Output = Self> + Send + Sync + 'static
{
    /// The unit roundoff.
    const ROUNDOFF: f64;
    /// Between which sizes a tool's coordinates and their squares are good numbers.
    const SIZES: [f64; 2];
    /// Sixteen of them side by side.
    type Sixteen<S: Simd>: Sixteen<S, Of = Self>;

    /// The number nearest to that.
    fn of(value: f64) -> Self;
    /// One that is less.
    fn below(value: f64) -> Self;
    /// One that is more.
    fn above(value: f64) -> Self;
    /// The absolute value.
    fn size(self) -> Self;
    /// Whether it is neither infinite nor none.
    fn is_finite(self) -> bool;
}

/// Sixteen numbers side by side.
pub trait Sixteen<S: Simd>:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Add<Self::Of, Output = Self>
    + Sub<Self::Of, Output = Self>
    + Mul<Self::Of, Output = Self>
{
    /// Their format.
    type Of;

    /// The tree's numbers.
    fn load(simd: S, list: &[f32; WIDTH]) -> Self;
    /// All 0.
    fn zero(simd: S) -> Self;
    /// Absolute values.
    fn abs(self) -> Self;
    /// What is above 0 of them.
    fn positive(self) -> Self;
    /// Which are no more than that.
    fn at_most(self, other: Self::Of) -> mask32x16<S>;
    /// Which are no less.
    fn at_least(self, other: Self::Of) -> mask32x16<S>;
    /// Puts those of the mask down, side by side; what comes after means nothing.
    fn keep(self, mask: mask32x16<S>, list: &mut [Self::Of]);
}

impl Rough for f32 {
    const ROUNDOFF: f64 = 1.0 / 16_777_216.0;
    const SIZES: [f64; 2] = [1e-12, 1e12];
    type Sixteen<S: Simd> = f32x16<S>;

    #[inline(always)]
    fn of(value: f64) -> f32 {
        value as f32
    }
    fn below(value: f64) -> f32 {
        (value as f32).next_down()
    }
    fn above(value: f64) -> f32 {
        (value as f32).next_up()
    }
    #[inline(always)]
    fn size(self) -> f32 {
        self.abs()
    }
    fn is_finite(self) -> bool {
        f32::is_finite(self)
    }
}

impl<S: Simd> Sixteen<S> for f32x16<S> {
    type Of = f32;

    #[inline(always)]
    fn load(simd: S, list: &[f32; WIDTH]) -> Self {
        f32x16::from_slice(simd, list)
    }
    #[inline(always)]
    fn zero(simd: S) -> Self {
        f32x16::splat(simd, 0.0)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        SimdBase::abs(self)
    }
    #[inline(always)]
    fn positive(self) -> Self {
        self.max(f32x16::splat(self.simd, 0.0))
    }
    #[inline(always)]
    fn at_most(self, other: f32) -> mask32x16<S> {
        self.simd_le(other)
    }
    #[inline(always)]
    fn at_least(self, other: f32) -> mask32x16<S> {
        self.simd_ge(other)
    }
    #[inline(always)]
    fn keep(self, mask: mask32x16<S>, list: &mut [f32]) {
        self.compress(mask).store_slice(list);
    }
}

impl Rough for f64 {
    const ROUNDOFF: f64 = f64::EPSILON / 2.0;
    const SIZES: [f64; 2] = [1e-140, 1e140];
    type Sixteen<S: Simd> = Pair<S>;

    #[inline(always)]
    fn of(value: f64) -> f64 {
        value
    }
    fn below(value: f64) -> f64 {
        value.next_down()
    }
    fn above(value: f64) -> f64 {
        value.next_up()
    }
    #[inline(always)]
    fn size(self) -> f64 {
        self.abs()
    }
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }
}

/// Twice eight of `f64`.
#[derive(Clone, Copy)]
pub struct Pair<S: Simd>(f64x8<S>, f64x8<S>);

macro_rules! operator {
    ($($trait:ident $method:ident),*) => {$(
        impl<S: Simd> $trait for Pair<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Pair(self.0.$method(other.0), self.1.$method(other.1))
            }
        }

        impl<S: Simd> $trait<f64> for Pair<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                Pair(self.0.$method(other), self.1.$method(other))
            }
        }
    )*};
}

operator!(Add add, Sub sub, Mul mul);

/// One mask of two.
#[inline(always)]
fn both<S: Simd>(simd: S, low: mask64x8<S>, high: mask64x8<S>) -> mask32x16<S> {
    mask32x16::from_bitmask(simd, low.to_bitmask() | high.to_bitmask() << 8)
}

impl<S: Simd> Sixteen<S> for Pair<S> {
    type Of = f64;

    #[inline(always)]
    fn load(simd: S, list: &[f32; WIDTH]) -> Self {
        let (low, high) = f32x16::from_slice(simd, list).widen();
        Pair(low, high)
    }
    #[inline(always)]
    fn zero(simd: S) -> Self {
        let zero = f64x8::splat(simd, 0.0);
        Pair(zero, zero)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Pair(SimdBase::abs(self.0), SimdBase::abs(self.1))
    }
    #[inline(always)]
    fn positive(self) -> Self {
        let zero = f64x8::splat(self.0.simd, 0.0);
        Pair(self.0.max(zero), self.1.max(zero))
    }
    #[inline(always)]
    fn at_most(self, other: f64) -> mask32x16<S> {
        both(self.0.simd, self.0.simd_le(other), self.1.simd_le(other))
    }
    #[inline(always)]
    fn at_least(self, other: f64) -> mask32x16<S> {
        both(self.0.simd, self.0.simd_ge(other), self.1.simd_ge(other))
    }
    #[inline(always)]
    fn keep(self, mask: mask32x16<S>, list: &mut [f64]) {
        let (bits, simd) = (mask.to_bitmask(), self.0.simd);
        let low = bits & 0xff;
        let mask = |bits: u64| mask64x8::from_bitmask(simd, bits);
        let after = low.count_ones() as usize;
        self.0.compress(mask(low)).store_slice(&mut list[..WIDTH / 2]);
        self.1.compress(mask(bits >> 8)).store_slice(&mut list[after..after + WIDTH / 2]);
    }
}
