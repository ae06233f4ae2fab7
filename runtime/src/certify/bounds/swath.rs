//! Eight triangles on their way past the tool, side by side in `f64`.

use crate::certify::bounds::batch::{Batch, Lanes, load};
use crate::certify::bounds::hull::Hull;
use crate::certify::bounds::swept::Ends;
use crate::certify::sweep::stretch::Stretch;
use crate::certify::triangle::piece::Part;
use crate::tool::{LANES, on_vectors};
use fearless_simd::{Level, Simd, SimdBase, f64x8};

/// Up to eight triangles at both ends of a stretch, and as they are in its middle.
#[derive(Default)]
pub(crate) struct Swath {
    pub(crate) middle: Batch,
    ends: [[Lanes; 3]; 6],
    /// How far their ways are from straight, and how far they have to keep.
    grow: Lanes,
    pub(crate) bounds: Lanes,
}

impl Swath {
    /// Takes triangles that have to keep so far.
    pub(crate) fn begin(&mut self, stretch: &Stretch, keep: f64, parts: &[Part]) {
        self.middle.indices.clear();
        self.middle.indices.extend(parts.iter().map(|part| part.index));
        for (lane, part) in parts.iter().enumerate() {
            for (k, corner) in part.piece.corners().iter().enumerate() {
                let [first, middle, last] = stretch.seen(corner);
                for axis in 0..3 {
                    self.ends[k][axis][lane] = first[axis];
                    self.middle.corners[k][axis][lane] = middle[axis];
                    self.ends[3 + k][axis][lane] = last[axis];
                }
            }
            self.grow[lane] = keep + stretch.curve(stretch.about(&self.middle.corners(lane)));
        }
    }

    /// Bounds how deep they come.
    pub(crate) fn bound(&mut self, level: Level, hull: &Hull<f64>, wanted: f64) {
        on_vectors!(level, simd => self.bound_on(simd, hull, wanted));
        // Without vectors nothing is known before their edges are looked at.
        self.bounds = [f64::INFINITY; LANES];
    }

    #[inline(always)]
    fn bound_on<S: Simd>(&mut self, simd: S, hull: &Hull<f64>, wanted: f64) {
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
        hull.swept(simd, (&ends, &middle), grow, wanted).store_slice(&mut self.bounds);
    }
}
