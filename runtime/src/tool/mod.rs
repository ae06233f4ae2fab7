//! What a tool is to the runtime: a card that describes it, and evaluators of what is felt.
//!
//! Everything here is in the tool's frame (tip at the origin, +z from the tip to the spindle; for
//! a `solid` its file's frame) and in the unit of the tool's file, unless it says otherwise.

mod card;
mod compiled;
mod dual;
mod enclosure;
#[cfg(feature = "interpreter")]
mod interpreted;
mod lane;

pub use card::{Card, Circle, Depth, Piece, Region, Shape, Slab, Surface};
pub use compiled::{Evaluators, FeltLanes};
pub use dual::Dual;
pub(crate) use enclosure::bit;
pub use enclosure::{Enclosed, Enclosure, Maybe};
#[cfg(feature = "interpreter")]
pub use interpreted::{Interpreted, ToolError};
pub use lane::Lane;

use fearless_simd::Level;

/// How many points evaluators do at a time; buffers are padded to a multiple of it.
pub const LANES: usize = 8;

/// Returns what is computed on vectors, at levels that have those of four doubles at least, or are all
/// there is: with two a side, there would be four times the code for nothing.
macro_rules! on_vectors {
    ($level:expr, $simd:ident => $body:expr) => {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            if let Some($simd) = $level.as_avx512() {
                return $simd.vectorize(
                    #[inline(always)]
                    || $body,
                );
            }
            if let Some($simd) = $level.as_avx2() {
                return $simd.vectorize(
                    #[inline(always)]
                    || $body,
                );
            }
        }
        #[cfg(target_arch = "aarch64")]
        if let Some($simd) = $level.as_neon() {
            return $simd.vectorize(
                #[inline(always)]
                || $body,
            );
        }
    };
}

pub(crate) use on_vectors;

/// A tool that can be asked what it feels: one that was compiled, or one that is interpreted.
pub trait Tool: Send + Sync {
    /// Who it is and how far it reaches.
    fn card(&self) -> &Card;

    /// The distance from a point of the tool's frame to the tool, in the file's unit: 0 inside, a
    /// lower bound unless [`Card::exact`]. Farther away than some 64 of the tool's sizes it is that to a
    /// cylinder about the tool, and so too small by less than the size.
    fn clearance(&self, point: [f64; 3]) -> f64;

    /// Evaluates what is asked for at points of the tool's frame.
    ///
    /// `length` is the length of the file's unit in the part's, by which a magnitude that is the
    /// depth is scaled. The answer has the same bits whatever the level.
    fn evaluate(&self, level: Level, ask: Ask, points: &Points, length: f64, felt: &mut Felt);

    /// How what is felt at a point inside changes with where it is: as the region says that it belongs to, on
    /// borders too. `room` is kept between calls.
    fn slopes(&self, point: [f64; 3], length: f64, room: &mut Felt) -> Slopes;

    /// What is felt in a box of the tool's frame, its sides from one end to another: enclosed in real
    /// arithmetic, of the expressions as they are evaluated, with slopes from a point of the box. The box of a
    /// tool with an axis lies in the half plane `y = 0`, `x ≥ 0`. `None` of a tool that has a profile, of which
    /// more is known, and of one that does not tell. `room` is kept between calls.
    fn enclose(&self, _sides: [[f64; 2]; 3], _at: [f64; 3], _room: &mut Felt) -> Option<Enclosed> {
        None
    }

    /// Reserves in `felt` the memory that the tool itself keeps there between calls of
    /// [`Tool::evaluate`] and [`Tool::slopes`], so that they allocate none. A tool that keeps nothing
    /// has nothing to do.
    fn reserve(&self, _felt: &mut Felt) {}
}

/// Derivatives by the position in the part's unit, in the tool's frame: row by row of what changes, along x,
/// y and z. What is not differentiable at a point, such as a direction on the axis, counts as unchanged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slopes {
    /// Of the direction to the nearest surface.
    pub direction: [[f64; 3]; 3],
    /// Of the magnitude's gradient.
    pub gradient: [[f64; 3]; 3],
}

impl Slopes {
    /// From what a tool computes at a [`Dual::point`] of its own unit.
    pub(crate) fn of(direction: [Dual; 3], gradient: [Dual; 3], length: f64) -> Slopes {
        let rows = |parts: [Dual; 3]| parts.map(|part| part.slope.map(|slope| slope / length));
        Slopes { direction: rows(direction), gradient: rows(gradient) }
    }
}

/// What a caller wants, as a type.
pub trait Wanted {
    /// What is wanted.
    const ASK: Ask;
}

/// A tool that knows what is wanted of it when it is compiled, so that no code is made for what nobody
/// wants. Every compiled tool does; a `dyn Tool` learns it when it is asked.
pub trait Senses: Tool {
    /// [`Tool::evaluate`] for what a type says.
    fn feel<W: Wanted>(&self, level: Level, points: &Points, length: f64, felt: &mut Felt);
}

impl Senses for dyn Tool + '_ {
    fn feel<W: Wanted>(&self, level: Level, points: &Points, length: f64, felt: &mut Felt) {
        self.evaluate(level, W::ASK, points, length, felt);
    }
}

/// What a caller wants of every point inside; what it does not want is not computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ask {
    /// Penetration depth.
    pub depth: bool,
    /// Magnitude.
    pub magnitude: bool,
    /// Niceness.
    pub niceness: bool,
    /// The direction to the nearest surface.
    pub direction: bool,
    /// The magnitude's gradient.
    pub gradient: bool,
    /// The region.
    pub region: bool,
}

impl Ask {
    /// Only which points are inside.
    pub const INSIDE: Ask = Ask {
        depth: false,
        magnitude: false,
        niceness: false,
        direction: false,
        gradient: false,
        region: false,
    };
    /// What a wrench along directions is summed from.
    pub const DIRECTION: Ask =
        Ask { depth: true, magnitude: true, niceness: true, direction: true, ..Ask::INSIDE };
    /// What a wrench along gradients is summed from.
    pub const GRADIENT: Ask = Ask { direction: false, gradient: true, ..Ask::DIRECTION };
    /// All there is.
    pub const EVERYTHING: Ask = Ask { gradient: true, region: true, ..Ask::DIRECTION };
}

/// Points of the tool's frame, in the unit of the tool's file.
#[derive(Clone, Debug, Default)]
pub struct Points {
    /// As long as ever needed; always a multiple of [`LANES`], and finite.
    lists: [Vec<f64>; 3],
    count: usize,
}

impl Points {
    /// No points; the memory stays.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// One more point.
    pub fn push(&mut self, point: [f64; 3]) {
        self.room(1);
        for (list, part) in self.next(0, 1).into_iter().zip(point) {
            list[0] = part;
        }
        self.took(1);
    }

    /// Reserves memory for so many points, without touching it.
    pub(crate) fn reserve(&mut self, count: usize) {
        let wanted = count.next_multiple_of(LANES);
        self.lists.iter_mut().for_each(|list| reserve(list, wanted));
    }

    /// Makes room for some points more.
    pub(crate) fn room(&mut self, more: usize) {
        let wanted = (self.count + more).next_multiple_of(LANES);
        if self.lists[0].len() < wanted {
            self.lists.iter_mut().for_each(|list| list.resize(wanted, 0.0));
        }
    }

    /// Where points go that come after so many more, for which there is room, coordinate by coordinate.
    #[inline(always)]
    pub(crate) fn next(&mut self, after: usize, count: usize) -> [&mut [f64]; 3] {
        let place = self.count + after..self.count + after + count;
        let [x, y, z] = &mut self.lists;
        [&mut x[place.clone()], &mut y[place.clone()], &mut z[place]]
    }

    /// That so many of those were written.
    #[inline(always)]
    pub(crate) fn took(&mut self, count: usize) {
        self.count += count;
    }

    /// How many points there are.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// x, y and z of all points, and of what fills the last block of [`LANES`].
    pub fn coordinates(&self) -> [&[f64]; 3] {
        let end = self.count.next_multiple_of(LANES);
        [&self.lists[0][..end], &self.lists[1][..end], &self.lists[2][..end]]
    }

    pub(crate) fn lists(&self) -> &[Vec<f64>; 3] {
        &self.lists
    }
}

/// What is felt at [`Points`], list by list. Entries of points outside, and lists not asked for,
/// mean nothing.
#[derive(Clone, Debug, Default)]
pub struct Felt {
    /// A bit a point, set inside; a byte a block of [`LANES`]. Padding is not inside.
    pub inside: Vec<u8>,
    /// Penetration depth, at least 0, in the file's unit.
    pub depth: Vec<f64>,
    /// Magnitude: if it is the depth, in the part's unit; else the file's own number.
    pub magnitude: Vec<f64>,
    /// Niceness, at least 0.
    pub niceness: Vec<f64>,
    /// Unit vector to the nearest surface.
    pub direction: [Vec<f64>; 3],
    /// Gradient of the magnitude by the position in the part's unit.
    pub gradient: [Vec<f64>; 3],
    /// The region's place in the card's list.
    pub region: Vec<f64>,
    /// Room for the interpreter.
    #[cfg(feature = "interpreter")]
    pub(crate) registers: Vec<tool_dsl::interpret::Lanes>,
    /// What it remembers of a point.
    #[cfg(feature = "interpreter")]
    pub(crate) scratch: tool_dsl::interpret::Scratch,
    /// What it remembers of a point and of how all changes there.
    #[cfg(feature = "interpreter")]
    pub(crate) duals: tool_dsl::interpret::Scratch<Dual>,
    /// What it remembers of a box.
    #[cfg(feature = "interpreter")]
    pub(crate) enclosures: tool_dsl::interpret::Scratch<Enclosure>,
    /// What it remembers of a block of points.
    #[cfg(feature = "interpreter")]
    pub(crate) lanes: tool_dsl::interpret::Registers,
}

impl Felt {
    /// How many points are inside.
    pub(crate) fn count(&self) -> usize {
        self.inside.iter().map(|block| block.count_ones() as usize).sum()
    }

    /// Which points are inside, in order.
    pub(crate) fn places(&self) -> impl Iterator<Item = usize> {
        self.inside.iter().enumerate().flat_map(|(block, bits)| {
            let mut left = *bits;
            std::iter::from_fn(move || {
                let lane = (left != 0).then(|| left.trailing_zeros() as usize)?;
                left &= left - 1;
                Some(block * LANES + lane)
            })
        })
    }

    /// Reserves memory for what is asked of so many points, without touching it.
    pub(crate) fn reserve_for(&mut self, count: usize, ask: Ask) {
        let blocks = count.div_ceil(LANES);
        reserve(&mut self.inside, blocks);
        self.asked(ask, |list| reserve(list, blocks * LANES));
    }

    /// Makes room for what is asked of so many points.
    pub(crate) fn reserve(&mut self, points: &Points, ask: Ask) {
        let blocks = points.count.div_ceil(LANES);
        self.inside.clear();
        self.inside.resize(blocks, 0);
        self.asked(ask, |list| {
            if list.len() < blocks * LANES {
                list.resize(blocks * LANES, 0.0);
            }
        });
    }

    /// Goes to all lists that are asked for.
    #[inline]
    fn asked(&mut self, ask: Ask, mut each: impl FnMut(&mut Vec<f64>)) {
        let mut list = |list: &mut Vec<f64>, wanted: bool| {
            if wanted {
                each(list);
            }
        };
        list(&mut self.depth, ask.depth);
        list(&mut self.magnitude, ask.magnitude);
        list(&mut self.niceness, ask.niceness);
        self.direction.iter_mut().for_each(|part| list(part, ask.direction));
        self.gradient.iter_mut().for_each(|part| list(part, ask.gradient));
        list(&mut self.region, ask.region);
    }
}

/// Reserves memory for a list of so many in all. Nothing is written, so that memory which is never used
/// costs address space alone where the system hands out pages at the first touch.
pub(crate) fn reserve<T>(list: &mut Vec<T>, count: usize) {
    list.reserve_exact(count.saturating_sub(list.len()));
}

/// The bits of a block that are points and not padding.
pub(crate) fn present(count: usize, block: usize) -> u8 {
    match count - block * LANES {
        full if full >= LANES => u8::MAX,
        rest => (1 << rest) - 1,
    }
}
