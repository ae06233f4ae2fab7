//! Tools that the macros compile.

use super::{Ask, Card, Felt, LANES, Lane, Points, Tool, present};
use fearless_simd::{Level, Simd, SimdBase, SimdMask, f64x8};

/// The evaluators of a compiled tool. Implemented by the macros, not by hand.
///
/// Points are finite, in the tool's frame and the file's unit; `length` is the length of the
/// file's unit in the part's. All but `contains` and `owner` are for points of the solid and mean
/// nothing elsewhere. Each comes twice: for one point with nested branches, and for lanes with
/// selects; both give the same bits.
pub trait Evaluators: Copy + Send + Sync + 'static {
    /// Who the tool is.
    fn card() -> &'static Card;

    /// Whether a point belongs to the solid; its surface does.
    fn contains(point: [f64; 3]) -> bool;
    /// The region that a point belongs to, by its place in the card's list.
    fn owner(point: [f64; 3]) -> Option<usize>;
    /// Penetration depth, at least 0.
    fn depth(point: [f64; 3]) -> f64;
    /// Magnitude.
    fn magnitude(point: [f64; 3], length: f64) -> f64;
    /// Niceness, at least 0.
    fn niceness(point: [f64; 3]) -> f64;
    /// Unit vector to the surface. On the axis its radial part is that of +x; at a centre, where
    /// no direction is nearest, it is +z.
    fn direction(point: [f64; 3]) -> [f64; 3];
    /// The magnitude's gradient by the position in the part's unit.
    fn gradient(point: [f64; 3], length: f64) -> [f64; 3];

    /// [`Evaluators::contains`] for lanes.
    fn contains_lanes<L: Lane>(point: [L; 3]) -> L::Mask;
    /// [`Evaluators::owner`] for lanes; -1 outside.
    fn owner_lanes<L: Lane>(point: [L; 3]) -> L;
    /// [`Evaluators::depth`] for lanes.
    fn depth_lanes<L: Lane>(point: [L; 3]) -> L;
    /// [`Evaluators::magnitude`] for lanes.
    fn magnitude_lanes<L: Lane>(point: [L; 3], length: L) -> L;
    /// [`Evaluators::niceness`] for lanes.
    fn niceness_lanes<L: Lane>(point: [L; 3]) -> L;
    /// [`Evaluators::direction`] for lanes.
    fn direction_lanes<L: Lane>(point: [L; 3]) -> [L; 3];
    /// [`Evaluators::gradient`] for lanes.
    fn gradient_lanes<L: Lane>(point: [L; 3], length: L) -> [L; 3];
}

impl<T: Evaluators> Tool for T {
    fn card(&self) -> &Card {
        T::card()
    }

    fn evaluate(&self, level: Level, ask: Ask, points: &Points, length: f64, felt: &mut Felt) {
        felt.reserve(points, ask);
        // Only levels with vectors of doubles worth having get code of their own: every level more
        // would add a copy of every tool to the program.
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            if let Some(simd) = level.as_avx512() {
                return simd.vectorize(
                    #[inline(always)]
                    || lanes::<T, _>(simd, ask, points, length, felt),
                );
            }
            if let Some(simd) = level.as_avx2() {
                return simd.vectorize(
                    #[inline(always)]
                    || lanes::<T, _>(simd, ask, points, length, felt),
                );
            }
        }
        #[cfg(target_arch = "aarch64")]
        if let Some(simd) = level.as_neon() {
            return simd.vectorize(
                #[inline(always)]
                || lanes::<T, _>(simd, ask, points, length, felt),
            );
        }
        one_by_one::<T>(ask, points, length, felt);
    }
}

/// Blocks of eight, output by output; a block without a point inside is passed over.
#[inline(always)]
fn lanes<T: Evaluators, S: Simd>(simd: S, ask: Ask, points: &Points, length: f64, felt: &mut Felt) {
    let length = f64x8::splat(simd, length);
    let [x, y, z] = points.coordinates();
    let place = |block: usize| block * LANES..(block + 1) * LANES;
    let at = |block: usize| [x, y, z].map(|list| f64x8::from_slice(simd, &list[place(block)]));
    for block in 0..felt.inside.len() {
        let inside = T::contains_lanes(at(block)).to_bitmask() as u8;
        felt.inside[block] = inside & present(points.len(), block);
    }
    if ask == Ask::Inside {
        return;
    }
    let inside = std::mem::take(&mut felt.inside);
    let touched = |block: &usize| inside[*block] != 0;
    let blocks = 0..inside.len();
    for block in blocks.clone().filter(touched) {
        let p = at(block);
        T::depth_lanes(p).store_slice(&mut felt.depth[place(block)]);
        T::magnitude_lanes(p, length).store_slice(&mut felt.magnitude[place(block)]);
        T::niceness_lanes(p).store_slice(&mut felt.niceness[place(block)]);
    }
    if ask.direction() {
        for block in blocks.clone().filter(touched) {
            for (list, part) in felt.direction.iter_mut().zip(T::direction_lanes(at(block))) {
                part.store_slice(&mut list[place(block)]);
            }
        }
    }
    if ask.gradient() {
        for block in blocks.clone().filter(touched) {
            for (list, part) in felt.gradient.iter_mut().zip(T::gradient_lanes(at(block), length)) {
                part.store_slice(&mut list[place(block)]);
            }
        }
    }
    if ask == Ask::Everything {
        for block in blocks.filter(touched) {
            T::owner_lanes(at(block)).store_slice(&mut felt.region[place(block)]);
        }
    }
    felt.inside = inside;
}

/// The same without vectors, by the nested form.
fn one_by_one<T: Evaluators>(ask: Ask, points: &Points, length: f64, felt: &mut Felt) {
    let [x, y, z] = points.coordinates();
    for at in 0..points.len() {
        let p = [x[at], y[at], z[at]];
        if !T::contains(p) {
            continue;
        }
        felt.inside[at / LANES] |= 1 << (at % LANES);
        if ask == Ask::Inside {
            continue;
        }
        felt.depth[at] = T::depth(p);
        felt.magnitude[at] = T::magnitude(p, length);
        felt.niceness[at] = T::niceness(p);
        if ask.direction() {
            for (list, part) in felt.direction.iter_mut().zip(T::direction(p)) {
                list[at] = part;
            }
        }
        if ask.gradient() {
            for (list, part) in felt.gradient.iter_mut().zip(T::gradient(p, length)) {
                list[at] = part;
            }
        }
        if ask == Ask::Everything {
            felt.region[at] = T::owner(p).map_or(-1.0, |region| region as f64);
        }
    }
}
