//! Eight triangles in the tool's frame, side by side in `f64`.

use crate::bvh::PoseTransform;
use crate::certify::bounds::hull::Hull;
use crate::certify::part::{Face, Facets};
use crate::pose::Pose;
use crate::tool::{LANES, on_vectors};
use fearless_simd::{Level, Simd, SimdBase, f64x8};

/// A coordinate of each.
pub(crate) type Lanes = [f64; LANES];

/// Up to eight triangles: how deep each is at most, and where it may be so.
#[derive(Default)]
pub(crate) struct Batch {
    pub(crate) indices: Vec<u32>,
    /// First from the tip in the part's frame and unit, then in the tool's.
    pub(crate) corners: [[Lanes; 3]; 3],
    pub(crate) bounds: Lanes,
    places: [Lanes; 3],
}

impl Batch {
    /// Takes triangles by their places in the tree's order.
    pub(crate) fn begin(&mut self, facets: &Facets, pose: &Pose, indices: &[u32]) {
        self.indices.clear();
        self.indices.extend(indices);
        let tip = pose.tip();
        for (lane, index) in self.indices.iter().enumerate() {
            for (list, corner) in self.corners.iter_mut().zip(&facets.corners[*index as usize]) {
                for axis in 0..3 {
                    list[axis][lane] = corner[axis] - tip[axis];
                }
            }
        }
    }

    pub(crate) fn clear(&mut self) {
        self.indices.clear();
    }

    /// Takes both halves of a face's rectangle besides, by the face's place in the list.
    pub(crate) fn rectangle(&mut self, face: &Face, (pose, index): (&Pose, u32)) {
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

    pub(crate) fn place(&self, lane: usize) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.places[axis][lane])
    }

    pub(crate) fn corners(&self, lane: usize) -> [[f64; 3]; 3] {
        [0, 1, 2].map(|k| [0, 1, 2].map(|axis| self.corners[k][axis][lane]))
    }

    pub(crate) fn any_above(&self, depth: f64) -> bool {
        self.bounds[..self.len()].iter().any(|bound| *bound > depth)
    }

    /// Turns them to the tool's frame.
    pub(crate) fn turn(&mut self, view: &PoseTransform) {
        for corner in &mut self.corners {
            let p = *corner;
            for lane in 0..LANES {
                for (axis, row) in view.carry.iter().enumerate() {
                    corner[axis][lane] =
                        p[0][lane] * row[0] + p[1][lane] * row[1] + p[2][lane] * row[2];
                }
            }
        }
    }

    /// Bounds how deep they are.
    pub(crate) fn bound(&mut self, level: Level, hull: &Hull<f64>, wanted: f64) {
        on_vectors!(level, simd => self.bound_on(simd, hull, wanted));
        // Without vectors nothing is known before their edges are looked at.
        self.bounds = [f64::INFINITY; LANES];
        self.places = self.corners[0];
    }

    #[inline(always)]
    fn bound_on<S: Simd>(&mut self, simd: S, hull: &Hull<f64>, wanted: f64) {
        let (bound, place) = hull.triangles(simd, &self.load_corners(simd), wanted, None);
        bound.store_slice(&mut self.bounds);
        store(&mut self.places, place);
    }

    /// Bounds them again, as seen from where they may be deepest.
    pub(crate) fn closer(&mut self, level: Level, hull: &Hull<f64>, wanted: f64) {
        on_vectors!(level, simd => self.closer_on(simd, hull, wanted));
    }

    #[inline(always)]
    fn closer_on<S: Simd>(&mut self, simd: S, hull: &Hull<f64>, wanted: f64) {
        let places = load(simd, &self.places);
        let (bound, place) = hull.triangles(simd, &self.load_corners(simd), wanted, Some(&places));
        f64x8::from_slice(simd, &self.bounds).min(bound).store_slice(&mut self.bounds);
        store(&mut self.places, place);
    }

    #[inline(always)]
    pub(crate) fn load_corners<S: Simd>(&self, simd: S) -> [[f64x8<S>; 3]; 3] {
        let [a, b, c] = &self.corners;
        [load(simd, a), load(simd, b), load(simd, c)]
    }
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
