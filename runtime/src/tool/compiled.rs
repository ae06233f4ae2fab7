//! Tools that the macros compile.

use super::{Ask, Card, Felt, LANES, Lane, Points, Tool, present};
use fearless_simd::{Level, Simd, SimdBase, SimdMask, dispatch, f64x8};

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

const INSIDE: u8 = 0;
const DIRECTION: u8 = 1;
const GRADIENT: u8 = 2;
const EVERYTHING: u8 = 3;

impl<T: Evaluators> Tool for T {
    fn card(&self) -> &Card {
        T::card()
    }

    fn evaluate(&self, level: Level, ask: Ask, points: &Points, length: f64, felt: &mut Felt) {
        felt.reserve(points, ask);
        match ask {
            Ask::Inside => {
                dispatch!(level, simd => run::<T, _, INSIDE>(simd, points, length, felt))
            }
            Ask::Direction => {
                dispatch!(level, simd => run::<T, _, DIRECTION>(simd, points, length, felt))
            }
            Ask::Gradient => {
                dispatch!(level, simd => run::<T, _, GRADIENT>(simd, points, length, felt))
            }
            Ask::Everything => {
                dispatch!(level, simd => run::<T, _, EVERYTHING>(simd, points, length, felt))
            }
        }
    }
}

#[inline(always)]
fn run<T: Evaluators, S: Simd, const ASK: u8>(
    simd: S,
    points: &Points,
    length: f64,
    felt: &mut Felt,
) {
    let length = f64x8::splat(simd, length);
    let [x, y, z] = points.coordinates();
    let blocks = x.chunks_exact(LANES).zip(y.chunks_exact(LANES)).zip(z.chunks_exact(LANES));
    for (block, ((x, y), z)) in blocks.enumerate() {
        let p = [x, y, z].map(|part| f64x8::from_slice(simd, part));
        let inside = T::contains_lanes(p).to_bitmask() as u8 & present(points.len(), block);
        felt.inside[block] = inside;
        if ASK == INSIDE || inside == 0 {
            continue;
        }
        let place = block * LANES..(block + 1) * LANES;
        T::depth_lanes(p).store_slice(&mut felt.depth[place.clone()]);
        T::magnitude_lanes(p, length).store_slice(&mut felt.magnitude[place.clone()]);
        T::niceness_lanes(p).store_slice(&mut felt.niceness[place.clone()]);
        if ASK != GRADIENT {
            for (list, part) in felt.direction.iter_mut().zip(T::direction_lanes(p)) {
                part.store_slice(&mut list[place.clone()]);
            }
        }
        if ASK != DIRECTION {
            for (list, part) in felt.gradient.iter_mut().zip(T::gradient_lanes(p, length)) {
                part.store_slice(&mut list[place.clone()]);
            }
        }
        if ASK == EVERYTHING {
            T::owner_lanes(p).store_slice(&mut felt.region[place]);
        }
    }
}
