//! How near a tool is to boxes and triangles, 16 at a time, in `f32`.

use super::descent::Bounds;
use super::nearest::{Near, Space, across, least, most};
use super::section::Section;
use crate::tree::{Boxes, View, extent, load, seen};
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x16};

/// What holds a tool: for each slab a cylinder, and a ball where its side is one about the axis.
pub(super) struct Shell {
    slabs: Vec<Slab>,
}

struct Slab {
    low: f32,
    high: f32,
    radius: f32,
    /// Height of its centre and radius.
    ball: Option<[f32; 2]>,
}

impl Shell {
    pub(super) fn new(section: &Section) -> Shell {
        let slabs = section.slabs.iter().map(|slab| {
            let ball = section.features[slab.side].ball(section.size);
            Slab {
                low: slab.low as f32,
                high: slab.high as f32,
                radius: slab.radius as f32,
                ball: ball.map(|ball| ball.map(|part| part as f32)),
            }
        });
        Shell { slabs: slabs.collect() }
    }

    /// No less than the negative distance from what is no nearer to the axis and between those heights.
    #[inline(always)]
    fn bound<S: Simd>(
        &self,
        simd: S,
        near: f32x16<S>,
        low: f32x16<S>,
        high: f32x16<S>,
    ) -> f32x16<S> {
        let zero = f32x16::splat(simd, 0.0);
        let mut nearest = f32x16::splat(simd, f32::INFINITY);
        for slab in &self.slabs {
            let gap = (low - slab.high).max(f32x16::splat(simd, slab.low) - high).max(zero);
            let out = (near - slab.radius).max(zero);
            let mut distance = (gap * gap + out * out).sqrt();
            if let Some([z, radius]) = slab.ball {
                let along = (low - z).max(f32x16::splat(simd, z) - high).max(zero);
                distance = distance.max((near * near + along * along).sqrt() - radius);
            }
            nearest = nearest.min(distance);
        }
        zero - nearest
    }
}

impl Bounds for Shell {
    #[inline(always)]
    fn of_boxes<S: Simd>(&self, simd: S, boxes: &Boxes, view: &View) -> f32x16<S> {
        let (centre, half) = (load(simd, &boxes.centre), load(simd, &boxes.half));
        let [x, y, z] = seen(&centre, &view.rows, view.origin);
        let zero = f32x16::splat(simd, 0.0);
        let x = (x.abs() - extent(&half, view.rows[0])).max(zero);
        let y = (y.abs() - extent(&half, view.rows[1])).max(zero);
        let wide = extent(&half, view.rows[2]);
        self.bound(simd, (x * x + y * y).sqrt(), z - wide, z + wide)
    }

    #[inline(always)]
    fn of_triangles<S: Simd>(
        &self,
        simd: S,
        corners: &[Space<f32x16<S>>; 3],
        _wanted: f32,
    ) -> f32x16<S> {
        let [a, b, c] = corners;
        let near = Near::to_axis(simd, corners);
        let [out_a, out_b, out_c] = across(corners, &near.way);
        let near = least(out_a, out_b, out_c).max(f32x16::splat(simd, 0.0));
        let (low, high) = (least(a[2], b[2], c[2]), most(a[2], b[2], c[2]));
        self.bound(simd, near, low, high)
    }
}
