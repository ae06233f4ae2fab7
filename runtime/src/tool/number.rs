//! The formats that points are felt in: `f64`, or `f32` for the last factor of speed.

use super::{LANES, Lane};
use fearless_simd::{
    Select, Simd, SimdBase, SimdFloat, SimdMask, f32x8, f64x8, mask32x8, mask64x8,
};
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A format that points are felt in.
pub trait Number: Copy + Debug + Default + Into<f64> + PartialOrd + Send + Sync + 'static {
    /// Eight of them side by side, as generated code computes with.
    type Eight<S: Simd>: Lane;

    /// The number nearest to that.
    fn of(value: f64) -> Self;
    /// The same in all lanes.
    fn splat<S: Simd>(simd: S, value: f64) -> Self::Eight<S>;
    /// Those of a block.
    fn load<S: Simd>(simd: S, list: &[Self], block: usize) -> Self::Eight<S>;
    /// Those of a block as `f64`.
    fn wide<S: Simd>(simd: S, list: &[Self], block: usize) -> f64x8<S>;
    /// Puts them down as those of a block.
    fn store<S: Simd>(eight: Self::Eight<S>, list: &mut [Self], block: usize);
    /// A mask by its bits.
    fn mask<S: Simd>(simd: S, bits: u8) -> <Self::Eight<S> as Lane>::Mask;
    /// Its bits.
    fn bits<S: Simd>(mask: <Self::Eight<S> as Lane>::Mask) -> u8;
}

fn place(block: usize) -> std::ops::Range<usize> {
    block * LANES..(block + 1) * LANES
}

impl Number for f64 {
    type Eight<S: Simd> = f64x8<S>;

    #[inline(always)]
    fn of(value: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn splat<S: Simd>(simd: S, value: f64) -> f64x8<S> {
        f64x8::splat(simd, value)
    }
    #[inline(always)]
    fn load<S: Simd>(simd: S, list: &[f64], block: usize) -> f64x8<S> {
        f64x8::from_slice(simd, &list[place(block)])
    }
    #[inline(always)]
    fn wide<S: Simd>(simd: S, list: &[f64], block: usize) -> f64x8<S> {
        f64x8::from_slice(simd, &list[place(block)])
    }
    #[inline(always)]
    fn store<S: Simd>(eight: f64x8<S>, list: &mut [f64], block: usize) {
        eight.store_slice(&mut list[place(block)]);
    }
    #[inline(always)]
    fn mask<S: Simd>(simd: S, bits: u8) -> mask64x8<S> {
        mask64x8::from_bitmask(simd, u64::from(bits))
    }
    #[inline(always)]
    fn bits<S: Simd>(mask: mask64x8<S>) -> u8 {
        mask.to_bitmask() as u8
    }
}

impl Number for f32 {
    type Eight<S: Simd> = Floats<f32x8<S>>;

    #[inline(always)]
    fn of(value: f64) -> f32 {
        value as f32
    }
    #[inline(always)]
    fn splat<S: Simd>(simd: S, value: f64) -> Floats<f32x8<S>> {
        Floats(f32x8::splat(simd, constant(value)))
    }
    #[inline(always)]
    fn load<S: Simd>(simd: S, list: &[f32], block: usize) -> Floats<f32x8<S>> {
        Floats(f32x8::from_slice(simd, &list[place(block)]))
    }
    #[inline(always)]
    fn wide<S: Simd>(simd: S, list: &[f32], block: usize) -> f64x8<S> {
        let mut wide = [0.0; LANES];
        for (wide, single) in wide.iter_mut().zip(&list[place(block)]) {
            *wide = f64::from(*single);
        }
        f64x8::from_slice(simd, &wide)
    }
    #[inline(always)]
    fn store<S: Simd>(eight: Floats<f32x8<S>>, list: &mut [f32], block: usize) {
        eight.0.store_slice(&mut list[place(block)]);
    }
    #[inline(always)]
    fn mask<S: Simd>(simd: S, bits: u8) -> mask32x8<S> {
        mask32x8::from_bitmask(simd, u64::from(bits))
    }
    #[inline(always)]
    fn bits<S: Simd>(mask: mask32x8<S>) -> u8 {
        mask.to_bitmask() as u8
    }
}

/// One of `f32`, or several, with constants that are written in `f64`.
#[derive(Clone, Copy)]
pub struct Floats<V>(pub(super) V);

/// Under this a square has lost digits, in `f32`; generated code knows the like of `f64`, some 2^-960, which
/// here stands for it.
const FAINT: f32 = f32::from_bits((127 - 100) << 23);

/// A constant of generated code.
#[inline(always)]
fn constant(value: f64) -> f32 {
    let rounded = value as f32;
    if value > 0.0 && rounded < FAINT { FAINT } else { rounded }
}

macro_rules! operator {
    ($($trait:ident $method:ident),*) => {$(
        impl<V: $trait<Output = V>> $trait for Floats<V> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Floats(self.0.$method(other.0))
            }
        }
    )*};
}

operator!(Add add, Sub sub, Mul mul, Div div);

macro_rules! by_constant {
    ($($trait:ident $method:ident),*) => {$(
        impl<V: $trait<f32, Output = V>> $trait<f64> for Floats<V> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                Floats(self.0.$method(constant(other)))
            }
        }
    )*};
}

by_constant!(Add add, Sub sub, Mul mul);

impl<V: Neg<Output = V>> Neg for Floats<V> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Floats(-self.0)
    }
}

impl<S: Simd> Lane for Floats<f32x8<S>> {
    type Mask = mask32x8<S>;

    #[inline(always)]
    fn of(self, value: f64) -> Self {
        Floats(f32x8::splat(self.0.simd, constant(value)))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Floats(SimdFloat::sqrt(self.0))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Floats(SimdBase::abs(self.0))
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
        Floats(Select::select(mask, yes.0, no.0))
    }
}

impl Lane for Floats<f32> {
    type Mask = bool;

    #[inline(always)]
    fn of(self, value: f64) -> Self {
        Floats(constant(value))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Floats(f32::sqrt(self.0))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Floats(f32::abs(self.0))
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
