//! Lower bounds of the distance of a tool from boxes and triangles, 16 at a time, in `f32`.

use crate::bvh::{LaneVector, PoseTransform};
use crate::certify::bounds::descent::{Bounds, BoxBounds, BoxRings, Children, rings};
use crate::certify::bounds::lanes::{max3, min3, radial_extents};
use crate::certify::bounds::nearest::NearestPoint;
use crate::certify::tool_model::owners::Owners;
use crate::certify::tool_model::section::Section;
use crate::tool::ToolInfo;
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x16};

/// A set of solids that contain a tool: a cylinder per slab, and a ball where the slab's side is an arc about the axis.
#[derive(Clone)]
pub(crate) struct Shell {
    slabs: Vec<ShellSlab>,
    /// The rounding error bound of a point.
    margin: f32,
}

#[derive(Clone)]
struct ShellSlab {
    low: f32,
    high: f32,
    radius: f32,
    /// The height of the ball's centre and its radius.
    ball: Option<[f32; 2]>,
}

impl Shell {
    /// Creates the shell of a tool that is known by its depth field, from its envelope. `margin` is the rounding error bound of
    /// a point in `f32`.
    pub(crate) fn about(info: &ToolInfo, margin: f64) -> Shell {
        let slabs = info.envelope.iter().map(|slab| ShellSlab {
            low: slab.low as f32,
            high: slab.high as f32,
            radius: slab.radius as f32,
            ball: None,
        });
        Shell { slabs: slabs.collect(), margin: margin as f32 }
    }

    /// Creates the shell of the owners.
    pub(crate) fn new(section: &Section, owners: &Owners, margin: f64) -> Shell {
        let features = section.outline.features.iter().enumerate();
        let owned = features.filter(|(index, _)| owners.is_owned(*index));
        let slabs = owned.filter_map(|(index, feature)| {
            // A level feature has no slab of its own. It needs none if all features are owned.
            let level = !section.slabs.iter().any(|slab| slab.side == index);
            let [[d0, z0], [d1, z1]] = feature.segment.ends;
            let ball = if level { None } else { feature.ball(section.outline.size) };
            (!(owners.all() && level)).then(|| ShellSlab {
                low: z0.min(z1) as f32,
                high: z0.max(z1) as f32,
                radius: d0.max(d1) as f32,
                ball: ball.map(|ball| ball.map(|part| part as f32)),
            })
        });
        Shell { slabs: slabs.collect(), margin: margin as f32 }
    }

    /// Returns at least the negative distance of every point of the rings.
    #[inline(always)]
    fn bound<S: Simd>(&self, simd: S, rings: &BoxRings<f32x16<S>>) -> f32x16<S> {
        let BoxRings { mut near, low, high, planes, .. } = *rings;
        let zero = f32x16::splat(simd, 0.0);
        if let Some(planes) = &planes {
            near = near.max(planes.distance_of_axis(low, high));
        }
        let mut nearest = f32x16::splat(simd, f32::INFINITY);
        for slab in &self.slabs {
            let gap = (low - slab.high).max(f32x16::splat(simd, slab.low) - high).max(zero);
            let out = (near - slab.radius).max(zero);
            let mut distance = (gap * gap + out * out).sqrt();
            if let Some([z, radius]) = slab.ball {
                // The ball lies around its part of the tool, so the larger of both distances is still a lower bound.
                let along = (low - z).max(f32x16::splat(simd, z) - high).max(zero);
                let mut beyond = (near * near + along * along).sqrt();
                if let Some(planes) = &planes {
                    beyond = beyond.max(planes.distance_of_point(z));
                }
                distance = distance.max(beyond - radius);
            }
            nearest = nearest.min(distance);
        }
        zero - nearest
    }
}

impl BoxBounds for Shell {
    #[inline(always)]
    fn of_boxes<S: Simd>(
        &self,
        simd: S,
        children: Children<'_>,
        view: &PoseTransform,
        _threshold: f32,
    ) -> f32x16<S> {
        self.bound(simd, &rings(simd, children, view, self.margin, None))
    }
}

impl Bounds for Shell {
    #[inline(always)]
    fn of_triangles<S: Simd>(
        &self,
        simd: S,
        corners: &[LaneVector<f32x16<S>>; 3],
        _threshold: f32,
    ) -> f32x16<S> {
        let [a, b, c] = corners;
        let near = NearestPoint::to_axis(simd, corners);
        let [out_a, out_b, out_c] = radial_extents(corners, &near.direction);
        let near = min3(out_a, out_b, out_c).max(f32x16::splat(simd, 0.0));
        let (low, high) = (min3(a[2], b[2], c[2]), max3(a[2], b[2], c[2]));
        self.bound(simd, &BoxRings { near, far: near, low, high, planes: None })
    }
}
