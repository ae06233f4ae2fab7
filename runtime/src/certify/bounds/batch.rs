//! Eight triangles in the tool's frame, in SIMD lanes of `f64`.

use crate::bvh::PoseTransform;
use crate::certify::bounds::hull::Hull;
use crate::certify::part::{Face, TriangleBvh};
use crate::pose::Pose;
use crate::tool::{LANES, on_vectors};
use fearless_simd::{Level, Simd, SimdBase, f64x8};

/// One coordinate of eight points.
pub(crate) type Lanes = [f64; LANES];

/// Up to eight triangles, an upper bound of the depth of each, and the point where it may be reached.
#[derive(Clone, Default)]
pub(crate) struct Batch {
    pub(crate) indices: Vec<u32>,
    /// First relative to the tip in the part's frame and unit, then in the tool's frame and unit.
    pub(crate) corners: [[Lanes; 3]; 3],
    pub(crate) bounds: Lanes,
    points: [Lanes; 3],
}

impl Batch {
    /// Loads triangles, given by their indices in the tree's order.
    pub(crate) fn begin(&mut self, bvh: &TriangleBvh, pose: &Pose, indices: &[u32]) {
        self.indices.clear();
        self.indices.extend(indices);
        let tip = pose.tip();
        for (lane, index) in self.indices.iter().enumerate() {
            for (list, corner) in self.corners.iter_mut().zip(&bvh.corners[*index as usize]) {
                for axis in 0..3 {
                    // The difference of given doubles first: it errs by one rounding, wherever part and tool are.
                    list[axis][lane] = corner[axis] - tip[axis];
                }
            }
        }
    }

    pub(crate) fn clear(&mut self) {
        self.indices.clear();
    }

    /// Appends both halves of a face's rectangle. `index` is the face's index in its list.
    pub(crate) fn rectangle(&mut self, face: &Face, pose: &Pose, index: u32) {
        let [a, b, c, d] = face.corners;
        for half in [[a, b, c], [a, c, d]] {
            let lane = self.indices.len();
            self.indices.push(index);
            for (list, corner) in self.corners.iter_mut().zip(half) {
                for axis in 0..3 {
                    list[axis][lane] = (face.from[axis] - pose.tip()[axis]) + corner[axis];
                }
            }
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.indices.len()
    }

    pub(crate) fn index(&self, lane: usize) -> u32 {
        self.indices[lane]
    }

    pub(crate) fn point(&self, lane: usize) -> [f64; 3] {
        corner(&self.points, lane)
    }

    pub(crate) fn corners(&self, lane: usize) -> [[f64; 3]; 3] {
        let [a, b, c] = &self.corners;
        [corner(a, lane), corner(b, lane), corner(c, lane)]
    }

    pub(crate) fn any_above(&self, depth: f64) -> bool {
        self.bounds[..self.len()].iter().any(|bound| *bound > depth)
    }

    /// Transforms the corners to the tool's frame and unit.
    pub(crate) fn turn(&mut self, view: &PoseTransform) {
        let len = self.len();
        for corner in &mut self.corners {
            let p = *corner;
            for lane in 0..LANES {
                for (axis, row) in view.exact_rows.iter().enumerate() {
                    corner[axis][lane] =
                        p[0][lane] * row[0] + p[1][lane] * row[1] + p[2][lane] * row[2];
                }
            }
            // Lanes behind the last triangle hold old corners, which would be bounded, too.
            corner.iter_mut().for_each(|axis| axis[len..].fill(f64::NAN));
        }
    }

    /// Bounds the depths. A bound of at most `threshold` need not be tight.
    pub(crate) fn bound(&mut self, level: Level, hull: &Hull<f64>, threshold: f64) {
        on_vectors!(level, simd => self.bound_on(simd, hull, threshold));
        // Without vector instructions nothing is known until the edges are searched.
        self.bounds = [f64::INFINITY; LANES];
        self.points = self.corners[0];
    }

    #[inline(always)]
    fn bound_on<S: Simd>(&mut self, simd: S, hull: &Hull<f64>, threshold: f64) {
        let (bound, point) = hull.triangles(simd, &self.load_corners(simd), threshold, None);
        bound.store_slice(&mut self.bounds);
        store(&mut self.points, point);
    }

    /// Tightens the bounds, with directions from the points where the depth may be reached.
    pub(crate) fn refine(&mut self, level: Level, hull: &Hull<f64>, threshold: f64) {
        on_vectors!(level, simd => self.refine_on(simd, hull, threshold));
    }

    #[inline(always)]
    fn refine_on<S: Simd>(&mut self, simd: S, hull: &Hull<f64>, threshold: f64) {
        let points = load(simd, &self.points);
        let (bound, point) =
            hull.triangles(simd, &self.load_corners(simd), threshold, Some(&points));
        // Both bounds hold, whatever their directions.
        f64x8::from_slice(simd, &self.bounds).min(bound).store_slice(&mut self.bounds);
        store(&mut self.points, point);
    }

    #[inline(always)]
    pub(crate) fn load_corners<S: Simd>(&self, simd: S) -> [[f64x8<S>; 3]; 3] {
        let [a, b, c] = &self.corners;
        [load(simd, a), load(simd, b), load(simd, c)]
    }
}

fn corner([x, y, z]: &[Lanes; 3], lane: usize) -> [f64; 3] {
    [x[lane], y[lane], z[lane]]
}

#[inline(always)]
pub(crate) fn load<S: Simd>(simd: S, [x, y, z]: &[Lanes; 3]) -> [f64x8<S>; 3] {
    [f64x8::from_slice(simd, x), f64x8::from_slice(simd, y), f64x8::from_slice(simd, z)]
}

#[inline(always)]
fn store<S: Simd>([x, y, z]: &mut [Lanes; 3], from: [f64x8<S>; 3]) {
    from[0].store_slice(x);
    from[1].store_slice(y);
    from[2].store_slice(z);
}
