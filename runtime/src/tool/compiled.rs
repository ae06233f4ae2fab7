//! Tools that the macros compile.

use super::{Ask, Card, Felt, LANES, Lane, Points, Tool, present};
use fearless_simd::{Level, Simd, SimdBase, SimdMask, f64x8};

/// The evaluators of a compiled tool. Implemented by the macros, not by hand.
///
/// Points are finite, in the tool's frame and the file's unit; `length` is the length of the
/// file's unit in the part's. All but `contains`, `owner` and `clearance` are for points of the solid
/// and mean nothing elsewhere. Each comes twice: for one point with nested branches, and for lanes with
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
    /// Distance from a point outside to the tool, in the file's unit.
    fn clearance(point: [f64; 3]) -> f64;

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
    /// [`Evaluators::clearance`] for lanes.
    fn clearance_lanes<L: Lane>(point: [L; 3]) -> L;
}

impl<T: Evaluators> Tool for T {
    fn card(&self) -> &Card {
        T::card()
    }

    fn clearance(&self, point: [f64; 3]) -> f64 {
        if T::contains(point) { 0.0 } else { T::clearance(point) }
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

/// Three coordinates of eight points.
#[inline(always)]
fn load<S: Simd>(simd: S, lists: [&[f64]; 3], block: usize) -> [f64x8<S>; 3] {
    let place = block * LANES..(block + 1) * LANES;
    [
        f64x8::from_slice(simd, &lists[0][place.clone()]),
        f64x8::from_slice(simd, &lists[1][place.clone()]),
        f64x8::from_slice(simd, &lists[2][place]),
    ]
}

#[inline(always)]
fn store<S: Simd>(list: &mut [f64], block: usize, values: f64x8<S>) {
    values.store_slice(&mut list[block * LANES..(block + 1) * LANES]);
}

#[inline(always)]
fn store_vector<S: Simd>(lists: &mut [Vec<f64>; 3], block: usize, values: [f64x8<S>; 3]) {
    store(&mut lists[0], block, values[0]);
    store(&mut lists[1], block, values[1]);
    store(&mut lists[2], block, values[2]);
}

/// Blocks of eight; one without a point inside is passed over. What runs on vectors is in
/// functions that are always inlined, since a closure would be compiled without the vector
/// instructions of its surroundings.
#[inline(always)]
fn lanes<T: Evaluators, S: Simd>(simd: S, ask: Ask, points: &Points, length: f64, felt: &mut Felt) {
    let length = f64x8::splat(simd, length);
    let lists = points.coordinates();
    for block in 0..felt.inside.len() {
        let p = load(simd, lists, block);
        let inside = T::contains_lanes(p).to_bitmask() as u8 & present(points.len(), block);
        felt.inside[block] = inside;
        if ask == Ask::Inside || inside == 0 {
            continue;
        }
        store(&mut felt.depth, block, T::depth_lanes(p));
        store(&mut felt.magnitude, block, T::magnitude_lanes(p, length));
        store(&mut felt.niceness, block, T::niceness_lanes(p));
        if ask.direction() {
            store_vector(&mut felt.direction, block, T::direction_lanes(p));
        }
        if ask.gradient() {
            store_vector(&mut felt.gradient, block, T::gradient_lanes(p, length));
        }
        if ask == Ask::Everything {
            store(&mut felt.region, block, T::owner_lanes(p));
        }
    }
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
