//! The transform from a part to a tool's frame: the setup that all poses share, the transform at one pose, and its
//! application to 16 points or boxes at a time, in SIMD lanes of `f32`.

use crate::bvh::{Frame, WIDTH};
use crate::interval::Interval;
use crate::pose::Pose;
use crate::tool::{Symmetry, ToolInfo};
use fearless_simd::{Simd, SimdBase, f32x16};

/// The part by which lengths are enlarged for rounding in `f64`, which is far smaller.
const F64_MARGIN: f64 = 1e-9;

/// The unit roundoff of `f32`.
const ROUNDOFF: f64 = 1.0 / 16_777_216.0;
/// The range of the tool's size and of the tree's unit, in the tool's unit, in which coordinates and their
/// squares are representable in `f32`.
const SIZES: [f64; 2] = [1e-12, 1e12];

/// The maximum number of envelope slabs. The compiler makes at most 24.
pub(crate) const SLABS: usize = 32;

/// The setup that the queries of a tool at a part share at all poses. Lengths are in the tool's unit.
///
/// Boxes and points are compared with the tool's envelope in `f32`, with a margin for the rounding errors.
#[derive(Clone, Debug)]
pub(crate) struct QuerySetup {
    /// The tool's unit of length in the part's unit.
    length: f64,
    /// The tree's unit in the part's unit (`scale`) and in the tool's unit (`unit`).
    scale: f64,
    pub(crate) unit: f64,
    pub(crate) reach: ReachBounds,
    /// True if `f32` can represent the coordinates; otherwise no point is ruled out.
    pub(crate) fits: bool,
    /// The largest rounding error of a point's coordinates in `f32`, in the tool's unit.
    pub(crate) margin: f64,
    /// The range along the tool's axis of the part's middle, and its largest squared distance from the axis, for
    /// which the tool may reach the part.
    along: [f64; 2],
    across: f64,
}

/// The tool's envelope, widened by the margin.
#[derive(Clone, Debug)]
pub(crate) struct ReachBounds {
    /// The low end, high end and squared radius of each slab.
    pub(crate) slabs: [[f32; 3]; SLABS],
    /// A bit per slab in use.
    pub(crate) all: u32,
    /// The low and high ends along x and y, for a tool without an axis.
    pub(crate) across: Option<[[f32; 2]; 2]>,
}

impl QuerySetup {
    /// Prepares the queries of one tool at one part. `length` is the tool's unit in the part's unit.
    ///
    /// A coordinate in the tool's frame is a sum of three products and one term. With the rounding of the factors
    /// themselves, it errs by less than 8 units of roundoff of the sum of the terms' magnitudes. The margin is twice
    /// that. Parts farther away than the sizes of tool and part are rejected beforehand, so the margin is the same at
    /// every pose.
    pub(crate) fn new(frame: &Frame, info: &ToolInfo, length: f64) -> QuerySetup {
        let unit = frame.scale / length;
        let part = unit * 3f64.sqrt() * f64::from(frame.size);
        let (size, Interval { low, high }) = (info.size(), info.reach());
        let margin = 16.0 * ROUNDOFF * (size + 4.0 * part);
        let reach = ReachBounds::new(info, margin);
        let fits =
            [size, unit].iter().all(|v| (SIZES[0]..=SIZES[1]).contains(v)) && reach.is_finite();
        let part = part * (1.0 + F64_MARGIN) + F64_MARGIN * size;
        QuerySetup {
            length,
            scale: frame.scale,
            unit,
            fits,
            margin,
            reach,
            along: [low - part, high + part],
            across: (info.radius() + part).powi(2),
        }
    }

    /// Sets the pose, and returns whether the tool may reach the part there.
    #[inline]
    pub(crate) fn set_pose(&self, frame: &Frame, pose: &Pose, view: &mut PoseTransform) -> bool {
        let (rotation, tip) = (pose.rotation(), pose.tip());
        let per_length = 1.0 / self.length;
        for axis in 0..3 {
            // The difference first, and in `f64`: far from the world's origin nothing else is accurate.
            view.from_tip[axis] = frame.origin[axis] - tip[axis];
        }
        let from = view.from_tip;
        let mut tool_origin = [0.0; 3];
        for axis in 0..3 {
            // The columns of the rotation are the tool's axes.
            let row = [rotation[(0, axis)], rotation[(1, axis)], rotation[(2, axis)]];
            let coordinate = row[0] * from[0] + row[1] * from[1] + row[2] * from[2];
            tool_origin[axis] = coordinate * per_length;
            view.origin[axis] = tool_origin[axis] as f32;
            view.exact_rows[axis] = row.map(|part| part * per_length);
            view.rows[axis] = row.map(|part| (part * self.unit) as f32);
        }
        view.scale = self.scale;
        view.unit = self.unit as f32;
        let [x, y, z] = tool_origin;
        // Written so that NaN counts as reachable.
        !(z < self.along[0] || z > self.along[1] || x * x + y * y > self.across)
    }
}

impl ReachBounds {
    fn new(info: &ToolInfo, margin: f64) -> ReachBounds {
        let (mut slabs, mut all) = ([[0f32; 3]; SLABS], 0);
        for (index, slab) in info.envelope.iter().enumerate() {
            let radius = slab.radius + margin;
            // Two more roundings: the conversion to `f32`, and the square in the comparison.
            let squared = ((radius * radius * (1.0 + 8.0 * ROUNDOFF)) as f32).next_up();
            let entry = [below(slab.low, margin), above(slab.high, margin), squared];
            // If there are more slabs than room, the last entry covers the rest.
            let slab: &mut [f32; 3] = &mut slabs[index.min(SLABS - 1)];
            *slab = if index < SLABS {
                entry
            } else {
                [slab[0].min(entry[0]), slab[1].max(entry[1]), slab[2].max(entry[2])]
            };
            // One bit per slab in use: a node passes on to its children those that reach it.
            all |= 1 << index.min(SLABS - 1);
        }
        let across = match info.symmetry {
            Symmetry::Revolved => None,
            Symmetry::Solid { extent } => {
                Some(extent.map(|side| [below(side.low, margin), above(side.high, margin)]))
            }
        };
        ReachBounds { slabs, all, across }
    }

    fn is_finite(&self) -> bool {
        let across = self.across.iter().flatten().flatten();
        self.slabs.iter().flatten().chain(across).all(|v| v.is_finite())
    }
}

/// Returns a number of `f32` below `value - margin`.
fn below(value: f64, margin: f64) -> f32 {
    ((value - margin) as f32).next_down()
}

/// Returns a number of `f32` above `value + margin`.
fn above(value: f64, margin: f64) -> f32 {
    ((value + margin) as f32).next_up()
}

/// The transform from a part to the frame of a tool at a pose.
#[derive(Clone, Default)]
pub(crate) struct PoseTransform {
    /// Rotation and scale from the tree's frame and unit to the tool's.
    pub(crate) rows: [[f32; 3]; 3],
    /// The part's origin in the tool's frame and unit.
    pub(crate) origin: [f32; 3],
    /// The vector from the tip to the part's origin, and the tree's unit, both in the part's frame and unit.
    from_tip: [f64; 3],
    pub(crate) scale: f64,
    /// The tree's unit in the tool's unit.
    pub(crate) unit: f32,
    /// Rotation and scale from the part's frame and unit to the tool's.
    pub(crate) exact_rows: [[f64; 3]; 3],
}

impl PoseTransform {
    /// Returns the centre of a leaf relative to the tip, in the part's frame and unit. The input is in the tree's unit.
    #[inline(always)]
    pub(crate) fn leaf_from_tip(&self, centre: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| self.from_tip[axis] + self.scale * centre[axis])
    }

    /// Returns the transform from the tree's frame and unit to the tool's in `f64`: rows and origin.
    pub(crate) fn exactly(&self) -> ([[f64; 3]; 3], [f64; 3]) {
        let [x, y, z] = self.from_tip;
        let origin = self.exact_rows.map(|row| row[0] * x + row[1] * y + row[2] * z);
        (self.exact_rows.map(|row| row.map(|part| part * self.scale)), origin)
    }

    /// Transforms a point from the tree's frame and unit to the tool's, in `f32`.
    #[inline(always)]
    pub(crate) fn transform(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        let [a, b, c] = &self.rows;
        [
            x * a[0] + y * a[1] + z * a[2] + self.origin[0],
            x * b[0] + y * b[1] + z * b[2] + self.origin[1],
            x * c[0] + y * c[1] + z * c[2] + self.origin[2],
        ]
    }
}

/// Vectors in SIMD lanes, coordinate by coordinate: points, box centres or half extents.
pub(crate) type LaneVector<V> = [V; 3];

/// The index of each lane; added to `16 n` it is the index of a child of node `n`, or of an item of leaf `n`.
pub(crate) const LANE_INDICES: [u32; WIDTH] =
    [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

const _: () = assert!(WIDTH == 16, "lanes are f32x16");

// Every function is `#[inline(always)]`, and none takes a closure, as `array::map` would: a closure is compiled as a
// function of its own, without the vector instructions that its caller enables.

/// Loads sixteen vectors from the lists of their x, y and z coordinates.
#[inline(always)]
pub(crate) fn load<S: Simd>(simd: S, lists: &[[f32; WIDTH]; 3]) -> LaneVector<f32x16<S>> {
    [
        f32x16::from_slice(simd, &lists[0]),
        f32x16::from_slice(simd, &lists[1]),
        f32x16::from_slice(simd, &lists[2]),
    ]
}

#[inline(always)]
pub(crate) fn dot<S: Simd>(v: &LaneVector<f32x16<S>>, row: [f32; 3]) -> f32x16<S> {
    v[0] * row[0] + v[1] * row[1] + v[2] * row[2]
}

/// Transforms sixteen vectors to the tool's frame and unit: `rows · v + origin`. `rows` is the rotation times the ratio
/// of the units; `origin` is the transformed point that the vectors are relative to. Coordinates are rounded to
/// nearest: the caller adds a margin, such as [`super::QuerySetup::margin`]. Lanes with a NaN stay NaN.
#[inline(always)]
pub(crate) fn transform<S: Simd>(
    v: &LaneVector<f32x16<S>>,
    rows: &[[f32; 3]; 3],
    origin: [f32; 3],
) -> LaneVector<f32x16<S>> {
    [dot(v, rows[0]) + origin[0], dot(v, rows[1]) + origin[1], dot(v, rows[2]) + origin[2]]
}

/// Returns the half extents of sixteen boxes along one axis of the tool, in the tool's unit. `half` are their half
/// extents in the tree's frame and unit, `row` is that axis's row of the transform. The sum is not rounded outward.
#[inline(always)]
pub(crate) fn extent<S: Simd>(half: &LaneVector<f32x16<S>>, row: [f32; 3]) -> f32x16<S> {
    dot(half, [row[0].abs(), row[1].abs(), row[2].abs()])
}
