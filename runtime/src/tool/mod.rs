//! The runtime's view of a tool: a description ([`ToolInfo`]) and evaluators of depth, magnitude, direction and
//! niceness.
//!
//! Everything here is in the tool's frame (tip at the origin, +z from the tip to the spindle; for a `solid` its file's
//! frame) and in the unit of the tool's file, unless stated otherwise.

mod compiled;
mod distance;
mod enclosure;
mod info;
#[cfg(feature = "interpreter")]
mod interpreted;
mod lane;
#[cfg(feature = "interpreter")]
mod plan;

pub use compiled::{Evaluators, LaneEvaluation, PointEvaluation};
pub(crate) use enclosure::bit;
pub use enclosure::{Enclosure, EvaluationEnclosure, Ternary};
pub use info::{DepthBounds, EnvelopeSlab, ProfileSegment, Region, Surface, Symmetry, ToolInfo};
#[cfg(feature = "interpreter")]
pub use interpreted::{Interpreted, ToolError};
pub use lane::{Dual, Lane};
pub use touchoff_plane::{Circle, Place, Segment};

use crate::interval::Interval;
use fearless_simd::Level;

/// The number of points that evaluators process at a time; buffers are padded to a multiple of it.
pub const LANES: usize = 8;

/// Evaluates an expression with vector instructions and returns its value from the enclosing function, at the levels
/// AVX-512, AVX2 and NEON. Does nothing at other levels. Vectors of two doubles are used only where there are no wider
/// ones (NEON), since they make the code four times as large.
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

/// A tool that can be evaluated: compiled, interpreted, or implemented by the user.
pub trait Tool: Send + Sync {
    /// The tool's name, surfaces, regions and extent.
    fn info(&self) -> &ToolInfo;

    /// Returns the distance from a point of the tool's frame to the tool, in the file's unit: 0 inside, and outside
    /// [`ToolInfo::distance_from_outside`].
    fn clearance(&self, point: [f64; 3]) -> f64 {
        let (mut points, mut evaluations) = (PointBatch::default(), Evaluations::default());
        points.push(point);
        self.evaluate(Level::baseline(), Outputs::INSIDE, &points, 1.0, &mut evaluations);
        if evaluations.count() > 0 { 0.0 } else { self.info().distance_from_outside(point) }
    }

    /// Evaluates the requested outputs at points of the tool's frame.
    ///
    /// `length` is the length of the file's unit in the part's unit. A magnitude that is the depth is scaled by it. The
    /// result has the same bits at every level.
    fn evaluate(
        &self,
        level: Level,
        outputs: Outputs,
        points: &PointBatch,
        length: f64,
        evaluations: &mut Evaluations,
    );

    /// Returns the derivatives of the evaluation at a point inside, by the formulas of the region that owns the point,
    /// also on borders between regions. `scratch` is memory kept between calls.
    fn derivatives(&self, point: [f64; 3], length: f64, scratch: &mut Evaluations) -> Derivatives;

    /// Returns an enclosure of the evaluation over a box of the tool's frame, or `None`.
    ///
    /// The enclosure holds in real arithmetic for the expressions as they are evaluated. Its slopes are taken from the
    /// point `_reference`, which lies in the box. `_sides` is the extent of the box along x, y and z; for a tool with an
    /// axis the box lies in the half plane `y = 0`, `x ≥ 0`. `_scratch` is memory kept between calls.
    ///
    /// Returns `None` for a tool with a profile, about which more is known, and for a tool that does not support
    /// enclosures.
    fn enclose(
        &self,
        _sides: [Interval; 3],
        _reference: [f64; 3],
        _scratch: &mut Evaluations,
    ) -> Option<EvaluationEnclosure> {
        None
    }

    /// Reserves in `_evaluations` the memory that the tool itself keeps there between calls of [`Tool::evaluate`] and
    /// [`Tool::derivatives`], so that they do not allocate. A tool that keeps nothing need not implement it.
    fn reserve(&self, _evaluations: &mut Evaluations) {}
}

/// Derivatives with respect to the position in the part's unit, in the tool's frame. Each matrix has one row per
/// component of the differentiated vector and one column per axis x, y and z. A quantity that is not differentiable at
/// a point, such as the direction on the axis, counts as constant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Derivatives {
    /// Derivative of the direction to the nearest surface.
    pub direction: [[f64; 3]; 3],
    /// Derivative of the magnitude's gradient.
    pub gradient: [[f64; 3]; 3],
}

impl Derivatives {
    /// Converts results computed at a [`Dual::point`] of the tool's own unit to derivatives in the part's unit.
    fn of(direction: [Dual; 3], gradient: [Dual; 3], length: f64) -> Derivatives {
        let rows =
            |vector: [Dual; 3]| vector.map(|component| component.slope.map(|slope| slope / length));
        Derivatives { direction: rows(direction), gradient: rows(gradient) }
    }
}

/// A selection of outputs, as a type.
pub trait OutputSelection {
    /// The selected outputs.
    const OUTPUTS: Outputs;
}

/// A tool whose outputs are selected at compile time, so that no code is generated for outputs that nobody requests.
/// Every compiled tool implements it; a `dyn Tool` receives the selection at run time.
pub trait BatchEvaluator: Tool {
    /// Does the same as [`Tool::evaluate`], for the outputs that `O` selects.
    fn evaluate_outputs<O: OutputSelection>(
        &self,
        level: Level,
        points: &PointBatch,
        length: f64,
        evaluations: &mut Evaluations,
    );
}

impl BatchEvaluator for dyn Tool + '_ {
    fn evaluate_outputs<O: OutputSelection>(
        &self,
        level: Level,
        points: &PointBatch,
        length: f64,
        evaluations: &mut Evaluations,
    ) {
        self.evaluate(level, O::OUTPUTS, points, length, evaluations);
    }
}

/// The outputs to compute at every point inside; others are not computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outputs {
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

impl Outputs {
    /// No outputs: only which points are inside.
    pub const INSIDE: Outputs = Outputs {
        depth: false,
        magnitude: false,
        niceness: false,
        direction: false,
        gradient: false,
        region: false,
    };
    /// The outputs that a wrench along directions is summed from.
    pub const DIRECTION: Outputs = Outputs {
        depth: true,
        magnitude: true,
        niceness: true,
        direction: true,
        ..Outputs::INSIDE
    };
    /// The outputs that a wrench along gradients is summed from.
    pub const GRADIENT: Outputs =
        Outputs { direction: false, gradient: true, ..Outputs::DIRECTION };
    /// All outputs.
    pub const EVERYTHING: Outputs = Outputs { gradient: true, region: true, ..Outputs::DIRECTION };
}

/// Points of the tool's frame, in the unit of the tool's file.
#[derive(Clone, Debug, Default)]
pub struct PointBatch {
    /// Coordinates, axis by axis. The length is a multiple of [`LANES`], never shrinks, and all values are finite.
    lists: [Vec<f64>; 3],
    count: usize,
}

impl PointBatch {
    /// Removes all points; keeps the memory.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Appends a point.
    pub fn push(&mut self, point: [f64; 3]) {
        self.make_room(1);
        for (list, coordinate) in self.next(0, 1).into_iter().zip(point) {
            list[0] = coordinate;
        }
        self.advance(1);
    }

    /// Reserves memory for `count` points in all, without touching it.
    pub(crate) fn reserve(&mut self, count: usize) {
        let capacity = count.next_multiple_of(LANES);
        self.lists.iter_mut().for_each(|list| reserve(list, capacity));
    }

    /// Makes room for `additional` further points.
    pub(crate) fn make_room(&mut self, additional: usize) {
        // Evaluators read whole blocks, so the last one needs its padding.
        let padded = (self.count + additional).next_multiple_of(LANES);
        // The lists never shrink: numbers from before are as good as padding as zeros are.
        if self.lists[0].len() < padded {
            self.lists.iter_mut().for_each(|list| list.resize(padded, 0.0));
        }
    }

    /// Returns the slots for `count` points, coordinate by coordinate, starting `offset` slots after the last point.
    /// [`PointBatch::make_room`] has to be called first.
    #[inline(always)]
    pub(crate) fn next(&mut self, offset: usize, count: usize) -> [&mut [f64]; 3] {
        let range = self.count + offset..self.count + offset + count;
        let [x, y, z] = &mut self.lists;
        [&mut x[range.clone()], &mut y[range.clone()], &mut z[range]]
    }

    /// Records that `count` of the slots from [`PointBatch::next`] were written.
    #[inline(always)]
    pub(crate) fn advance(&mut self, count: usize) {
        self.count += count;
    }

    /// Returns the number of points.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Returns whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Returns x, y and z of all points, with the padding of the last block of [`LANES`].
    pub fn coordinates(&self) -> [&[f64]; 3] {
        let end = self.count.next_multiple_of(LANES);
        [&self.lists[0][..end], &self.lists[1][..end], &self.lists[2][..end]]
    }

    pub(crate) fn lists(&self) -> &[Vec<f64>; 3] {
        &self.lists
    }
}

/// The evaluation at the points of a [`PointBatch`], list by list. Entries of points outside, and lists that were not
/// requested, are meaningless.
#[derive(Clone, Debug, Default)]
pub struct Evaluations {
    /// One bit per point, set if the point is inside; one byte per block of [`LANES`]. Bits of padding are 0.
    pub inside: Vec<u8>,
    /// Penetration depth, at least 0, in the file's unit.
    pub depth: Vec<f64>,
    /// Magnitude: in the part's unit if it is the depth, otherwise the file's own number.
    pub magnitude: Vec<f64>,
    /// Niceness, at least 0.
    pub niceness: Vec<f64>,
    /// Unit vector to the nearest surface, in the tool's frame.
    pub direction: [Vec<f64>; 3],
    /// Gradient of the magnitude with respect to the position in the part's unit, in the tool's frame.
    pub gradient: [Vec<f64>; 3],
    /// Index of the region in the tool's list.
    pub region: Vec<f64>,
    /// Memory of interpreted tools.
    #[cfg(feature = "interpreter")]
    memory: interpreted::EvaluationMemory,
}

impl Evaluations {
    /// Returns the number of points inside.
    pub(crate) fn count(&self) -> usize {
        self.inside.iter().map(|block| block.count_ones() as usize).sum()
    }

    /// Returns the indices of the points inside, in ascending order.
    pub fn inside_indices(&self) -> impl Iterator<Item = usize> {
        self.inside.iter().enumerate().flat_map(|(block, bits)| {
            // Bit by bit from the lowest, each cleared once it was taken.
            let mut remaining = *bits;
            std::iter::from_fn(move || {
                let lane = (remaining != 0).then(|| remaining.trailing_zeros() as usize)?;
                remaining &= remaining - 1;
                Some(block * LANES + lane)
            })
        })
    }

    /// Reserves memory for the requested outputs of `count` points, without touching it.
    pub(crate) fn reserve_for(&mut self, count: usize, outputs: Outputs) {
        let blocks = count.div_ceil(LANES);
        reserve(&mut self.inside, blocks);
        self.for_each_requested(outputs, |list| reserve(list, blocks * LANES));
    }

    /// Resizes the requested lists for the points, and marks no point as inside.
    fn reserve(&mut self, points: &PointBatch, outputs: Outputs) {
        let blocks = points.count.div_ceil(LANES);
        self.inside.clear();
        // Only the bits are reset. The entries of points outside are meaningless anyway.
        self.inside.resize(blocks, 0);
        self.for_each_requested(outputs, |list| {
            if list.len() < blocks * LANES {
                list.resize(blocks * LANES, 0.0);
            }
        });
    }

    /// Calls a function on every requested list.
    #[inline]
    fn for_each_requested(&mut self, outputs: Outputs, mut f: impl FnMut(&mut Vec<f64>)) {
        let mut visit = |list: &mut Vec<f64>, requested: bool| {
            if requested {
                f(list);
            }
        };
        visit(&mut self.depth, outputs.depth);
        visit(&mut self.magnitude, outputs.magnitude);
        visit(&mut self.niceness, outputs.niceness);
        self.direction.iter_mut().for_each(|component| visit(component, outputs.direction));
        self.gradient.iter_mut().for_each(|component| visit(component, outputs.gradient));
        visit(&mut self.region, outputs.region);
    }
}

/// Reserves memory for a list of `count` entries in all. Nothing is written, so unused memory costs only address space
/// on systems that hand out pages at the first touch.
pub(crate) fn reserve<T>(list: &mut Vec<T>, count: usize) {
    // Exactly, since doubling would reserve twice the address space that is counted in the documentation.
    list.reserve_exact(count.saturating_sub(list.len()));
}

/// Returns the bits of a block that are points and not padding.
fn present(count: usize, block: usize) -> u8 {
    match count - block * LANES {
        remaining if remaining >= LANES => u8::MAX,
        // The last block: as many low bits as there are points left.
        remaining => (1 << remaining) - 1,
    }
}
