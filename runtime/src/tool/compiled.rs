//! Tools that the macros compile.

use super::{
    Ask, Card, Dual, Enclosed, Felt, LANES, Lane, Points, Senses, Slopes, Tool, Wanted, on_vectors,
    present,
};
use fearless_simd::{Level, Simd, SimdBase, SimdMask, f64x8, mask64x8};
use std::ops::Range;

/// The evaluators of a compiled tool. Implemented by the macros, not by hand.
///
/// Points are finite, in the tool's frame and the file's unit; `length` is the length of the
/// file's unit in the part's. All but `contains`, `owner` and `clearance` are for points of the solid
/// and mean nothing elsewhere. [`Evaluators::feel_lanes`] has the same bits as those for one point.
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
    /// Distance from a point outside to the tool, in the file's unit, as [`Tool::clearance`] says.
    fn clearance(point: [f64; 3]) -> f64;

    /// What is felt in a box, of a tool that has no profile: see [`Tool::enclose`].
    fn enclose(_sides: [[f64; 2]; 3], _at: [f64; 3]) -> Option<Enclosed> {
        None
    }

    /// What is asked for at those of the points that are `present`, if they belong to the solid.
    fn feel_lanes<L: Lane>(point: [L; 3], length: L, present: L::Mask, ask: Ask) -> FeltLanes<L>;
}

/// What is felt at points side by side. Lanes that are not inside, and what was not asked for, mean
/// nothing.
#[derive(Clone, Copy)]
#[expect(missing_docs, reason = "as in Felt")]
pub struct FeltLanes<L: Lane> {
    pub inside: L::Mask,
    pub depth: L,
    pub magnitude: L,
    pub niceness: L,
    pub direction: [L; 3],
    pub gradient: [L; 3],
    pub region: L,
}

impl<L: Lane> FeltLanes<L> {
    /// Nothing felt, to begin with.
    #[inline(always)]
    pub fn nothing(like: L, none: L::Mask) -> FeltLanes<L> {
        let zero = like.none();
        FeltLanes {
            inside: none,
            depth: zero,
            magnitude: zero,
            niceness: zero,
            direction: [zero; 3],
            gradient: [zero; 3],
            region: zero,
        }
    }

    /// Some lanes are in a region.
    #[inline(always)]
    pub fn take(&mut self, lanes: L::Mask, region: L) {
        self.inside = self.inside | lanes;
        self.region = L::pick(lanes, region, self.region);
    }
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
        on_vectors!(level, simd => lanes::<T, _>(simd, ask, points, length, felt));
        one_by_one::<T>(ask, points, length, felt);
    }

    fn enclose(&self, sides: [[f64; 2]; 3], at: [f64; 3], _: &mut Felt) -> Option<Enclosed> {
        T::enclose(sides, at)
    }

    fn slopes(&self, point: [f64; 3], length: f64, _: &mut Felt) -> Slopes {
        let ask = Ask { direction: true, gradient: true, ..Ask::INSIDE };
        let here = T::feel_lanes(Dual::point(point), Dual::constant(length), true, ask);
        Slopes::of(here.direction, here.gradient, length)
    }
}

impl<T: Evaluators> Senses for T {
    fn feel<W: Wanted>(&self, level: Level, points: &Points, length: f64, felt: &mut Felt) {
        felt.reserve(points, W::ASK);
        on_vectors!(level, simd => lanes::<T, _>(simd, W::ASK, points, length, felt));
        one_by_one::<T>(W::ASK, points, length, felt);
    }
}

#[inline(always)]
fn store_vector<S: Simd>(lists: &mut [Vec<f64>; 3], block: Range<usize>, values: [f64x8<S>; 3]) {
    values[0].store_slice(&mut lists[0][block.clone()]);
    values[1].store_slice(&mut lists[1][block.clone()]);
    values[2].store_slice(&mut lists[2][block]);
}

/// Blocks of eight. Vector code stands in functions that are always inlined, since a closure would
/// be compiled without the vector instructions of its surroundings.
#[inline(always)]
fn lanes<T: Evaluators, S: Simd>(simd: S, ask: Ask, points: &Points, length: f64, felt: &mut Felt) {
    let length = f64x8::splat(simd, length);
    let lists = points.coordinates();
    for at in 0..felt.inside.len() {
        let block = at * LANES..(at + 1) * LANES;
        let present = mask64x8::from_bitmask(simd, u64::from(present(points.len(), at)));
        let p = [
            f64x8::from_slice(simd, &lists[0][block.clone()]),
            f64x8::from_slice(simd, &lists[1][block.clone()]),
            f64x8::from_slice(simd, &lists[2][block.clone()]),
        ];
        let here = T::feel_lanes(p, length, present, ask);
        felt.inside[at] = here.inside.to_bitmask() as u8;
        if ask.depth {
            here.depth.store_slice(&mut felt.depth[block.clone()]);
        }
        if ask.magnitude {
            here.magnitude.store_slice(&mut felt.magnitude[block.clone()]);
        }
        if ask.niceness {
            here.niceness.store_slice(&mut felt.niceness[block.clone()]);
        }
        if ask.direction {
            store_vector(&mut felt.direction, block.clone(), here.direction);
        }
        if ask.gradient {
            store_vector(&mut felt.gradient, block.clone(), here.gradient);
        }
        if ask.region {
            here.region.store_slice(&mut felt.region[block]);
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
        if ask.depth {
            felt.depth[at] = T::depth(p);
        }
        if ask.magnitude {
            felt.magnitude[at] = T::magnitude(p, length);
        }
        if ask.niceness {
            felt.niceness[at] = T::niceness(p);
        }
        if ask.direction {
            for (list, part) in felt.direction.iter_mut().zip(T::direction(p)) {
                list[at] = part;
            }
        }
        if ask.gradient {
            for (list, part) in felt.gradient.iter_mut().zip(T::gradient(p, length)) {
                list[at] = part;
            }
        }
        if ask.region {
            felt.region[at] = T::owner(p).map_or(-1.0, |region| region as f64);
        }
    }
}
