//! Eight triangles in motion past the tool, in SIMD lanes of `f64`.

use crate::certify::bounds::batch::{Batch, Lanes, load};
use crate::certify::bounds::hull::Hull;
use crate::certify::bounds::swept::Ends;
use crate::certify::sweep::interval::MotionInterval;
use crate::certify::triangle::subdivision::TrianglePiece;
use crate::tool::{LANES, on_vectors};
use fearless_simd::{Level, Simd, SimdBase, f64x8};

/// Up to eight triangles at both ends of a motion interval and in its middle.
#[derive(Default)]
pub(crate) struct SweptBatch {
    pub(crate) middle: Batch,
    ends: [[Lanes; 3]; 6],
    /// The deviation of their paths from straight plus the distance that they have to keep.
    grow: Lanes,
    pub(crate) bounds: Lanes,
}

impl SweptBatch {
    /// Loads triangles that have to keep a distance.
    pub(crate) fn begin(
        &mut self,
        interval: &MotionInterval,
        required_clearance: f64,
        parts: &[TrianglePiece],
    ) {
        self.middle.indices.clear();
        self.middle.indices.extend(parts.iter().map(|part| part.index));
        for (lane, part) in parts.iter().enumerate() {
            for (k, corner) in part.piece.corners().iter().enumerate() {
                let [first, middle, last] = interval.transformed(corner);
                for axis in 0..3 {
                    self.ends[k][axis][lane] = first[axis];
                    self.middle.corners[k][axis][lane] = middle[axis];
                    self.ends[3 + k][axis][lane] = last[axis];
                }
            }
            self.grow[lane] = required_clearance
                + interval.deviation_bound(interval.rotation_radius(&self.middle.corners(lane)));
        }
    }

    /// Bounds the depth of each triangle during the interval. A bound of at most `threshold` need not be tight.
    pub(crate) fn bound(&mut self, level: Level, hull: &Hull<f64>, threshold: f64) {
        on_vectors!(level, simd => self.bound_on(simd, hull, threshold));
        // Without vector instructions nothing is known until the edges are searched.
        self.bounds = [f64::INFINITY; LANES];
    }

    #[inline(always)]
    fn bound_on<S: Simd>(&mut self, simd: S, hull: &Hull<f64>, threshold: f64) {
        let [a, b, c, d, e, f] = &self.ends;
        let ends: Ends<f64x8<S>> = [
            load(simd, a),
            load(simd, b),
            load(simd, c),
            load(simd, d),
            load(simd, e),
            load(simd, f),
        ];
        let middle = self.middle.load_corners(simd);
        let grow = f64x8::from_slice(simd, &self.grow);
        hull.swept(simd, (&ends, &middle), grow, threshold).store_slice(&mut self.bounds);
    }
}
