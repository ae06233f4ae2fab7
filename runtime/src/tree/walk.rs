//! Which points may be inside a tool: the descent in `f32`, with margins.

use super::{Candidates, Tree, WIDTH};
use crate::pose::Pose;
use crate::tool::{Card, Shape};
use fearless_simd::{Level, Select, Simd, SimdBase, SimdMask, dispatch, f32x16, mask32x16, u32x16};
use nalgebra::Vector3;

/// A part seen from a tool at a pose: the map to the tool's frame, and the tool's reach, in `f32`
/// and in the tree's unit, with room for what `f32` rounds away.
pub(crate) struct View {
    /// Rotation from the world to the tool.
    rows: [[f32; 3]; 3],
    /// The cloud's origin in the tool's frame.
    origin: [f32; 3],
    /// The tool's reach as nodes and as points are held to it.
    nodes: Reach,
    points: Reach,
    /// For leaves and points: the rotation and the origin as they are, in `f64`.
    exact_rows: [[f64; 3]; 3],
    exact_origin: [f64; 3],
    /// The cloud's origin from the tip in the part's frame, and the tree's unit, in the part's.
    origin_from_tip: [f64; 3],
    pub(super) scale: f64,
    /// From the part's frame and unit to the tool's.
    pub(super) carry: [[f64; 3]; 3],
    /// Whether all of this fits `f32`; if not, no point is ruled out.
    fits: bool,
}

/// The most slabs; the compiler makes no more than 24.
const SLABS: usize = 32;

/// What a tool reaches, widened.
#[derive(Default)]
struct Reach {
    /// Low end, high end and squared radius of each slab.
    slabs: [[f32; 3]; SLABS],
    /// A bit for each slab that there is.
    all: u32,
    /// For what it was widened: the tool's unit, and the margin.
    made: [f64; 2],
    /// Low and high end along x and y, if it has no axis.
    across: Option<[[f32; 2]; 2]>,
}

impl Reach {
    /// The reach of a tool, always the same, in the tree's unit, which `unit` of the tool's go to, and a margin more.
    fn set(&mut self, card: &Card, unit: f64, margin: f64) {
        // Rounded up to two binary digits, so that many poses have the same.
        let margin = match margin.is_normal() {
            true => f64::from_bits(((margin.to_bits() >> 51) + 1) << 51),
            false => margin,
        };
        if self.made == [unit, margin] {
            return;
        }
        self.made = [unit, margin];
        let low = |v: f64| ((v * unit - margin) as f32).next_down();
        let high = |v: f64| ((v * unit + margin) as f32).next_up();
        self.all = 0;
        for (index, slab) in card.envelope.iter().enumerate() {
            let radius = slab.radius * unit + margin;
            // Two roundings more, to f32 and of the comparison's own square.
            let squared = ((radius * radius * (1.0 + 8.0 * ROUNDOFF)) as f32).next_up();
            let here = [low(slab.low), high(slab.high), squared];
            // Of more slabs than there is room for the last takes up the rest.
            let place = &mut self.slabs[index.min(SLABS - 1)];
            *place = if index < SLABS {
                here
            } else {
                [place[0].min(here[0]), place[1].max(here[1]), place[2].max(here[2])]
            };
            self.all |= 1 << index.min(SLABS - 1);
        }
        self.across = match card.shape {
            Shape::Revolved => None,
            Shape::Solid { across } => Some(across.map(|[from, to]| [low(from), high(to)])),
        };
    }

    fn is_finite(&self) -> bool {
        let across = self.across.iter().flatten().flatten();
        let slabs = self.slabs.iter().enumerate().filter(|(slab, _)| self.all >> slab & 1 == 1);
        slabs.flat_map(|(_, slab)| slab).chain(across).all(|v| v.is_finite())
    }
}

/// The unit roundoff of `f32`.
const ROUNDOFF: f64 = 1.0 / 16_777_216.0;

impl View {
    /// An empty view, to be set.
    pub(crate) fn new() -> View {
        View {
            rows: [[0.0; 3]; 3],
            origin: [0.0; 3],
            nodes: Reach::default(),
            points: Reach::default(),
            exact_rows: [[0.0; 3]; 3],
            exact_origin: [0.0; 3],
            origin_from_tip: [0.0; 3],
            scale: 1.0,
            carry: [[0.0; 3]; 3],
            fits: false,
        }
    }

    /// Looks from a pose. `length` is the length of the tool's unit in the part's.
    ///
    /// A coordinate in the tool's frame is a sum of three products and one term; with the rounding
    /// of the factors themselves it errs by less than 8 units of roundoff of the sum of their
    /// sizes. Twice that is allowed for.
    pub(crate) fn set(&mut self, tree: &Tree, card: &Card, pose: &Pose, length: f64) {
        let rotation = pose.rotation();
        let from_tip = tree.origin - pose.tip();
        self.origin_from_tip = from_tip.into();
        self.scale = tree.scale;
        for axis in 0..3 {
            let column = rotation.column(axis);
            self.exact_rows[axis] = [column[0], column[1], column[2]];
            self.exact_origin[axis] = column.dot(&from_tip) / tree.scale;
            // The change of unit, once for the query.
            self.carry[axis] = self.exact_rows[axis].map(|part| part / length);
        }
        self.rows = self.exact_rows.map(|row| row.map(|v| v as f32));
        self.origin = self.exact_origin.map(|v| v as f32);
        let unit = length / tree.scale;
        let tool = card.size() * unit;
        let far = self.exact_origin.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let node_margin = 16.0 * ROUNDOFF * (far + 3.0 * f64::from(tree.size));
        // A leaf that the descent kept is no farther from the tool than the tool's size and its own.
        let near = tool + 4.0 * f64::from(tree.leaf_size) + 2.0 * node_margin;
        let point_margin = 16.0 * ROUNDOFF * (near + 3.0 * f64::from(tree.leaf_size));
        self.nodes.set(card, unit, node_margin);
        self.points.set(card, unit, point_margin);
        self.fits = self.origin.iter().all(|v| v.is_finite()) && self.nodes.is_finite();
    }

    /// The centre of a leaf, given in the tree's unit, from the tip in the part's frame.
    #[inline(always)]
    pub(super) fn leaf_from_tip(&self, centre: [f64; 3]) -> [f64; 3] {
        let (scale, tip) = (self.scale, self.origin_from_tip);
        [tip[0] + scale * centre[0], tip[1] + scale * centre[1], tip[2] + scale * centre[2]]
    }

    /// A point from the tip in the part's frame, by its place in the tree.
    pub(crate) fn relative(&self, tree: &Tree, index: usize) -> Vector3<f64> {
        let (leaf, lane) = (index / WIDTH, index % WIDTH);
        let (centre, offset) = (tree.centre(leaf), &tree.leaves[leaf].offset);
        Vector3::from_fn(|axis, _| {
            let base = self.origin_from_tip[axis] + centre[axis];
            base + self.scale * f64::from(offset[axis][lane])
        })
    }

    /// A coordinate of a place of the cloud, seen from the tool: in `f64`, then rounded.
    #[inline(always)]
    fn place(&self, from_origin: [f64; 3], axis: usize) -> f32 {
        let row = self.exact_rows[axis];
        let sum = row[0] * from_origin[0] + row[1] * from_origin[1] + row[2] * from_origin[2];
        (sum + self.exact_origin[axis]) as f32
    }
}

/// The descent, with its memory kept between queries.
pub(crate) struct Walker {
    nodes: Vec<Near>,
    below: Vec<Near>,
}

/// A node or a leaf that the tool may reach.
#[derive(Clone, Copy, Default)]
pub(crate) struct Near {
    index: u32,
    /// A bit for each slab that may reach it; no other reaches what lies in it.
    slabs: u32,
}

impl Near {
    /// What all slabs may reach.
    fn all(index: u32) -> Near {
        Near { index, slabs: u32::MAX }
    }
}

impl Walker {
    pub(crate) fn new() -> Walker {
        Walker { nodes: Vec::new(), below: Vec::new() }
    }

    /// The leaves that may have a point inside the tool, in order.
    pub(crate) fn leaves(&mut self, level: Level, tree: &Tree, view: &View) -> &[Near] {
        self.nodes.clear();
        if !view.fits {
            self.nodes.extend((0..tree.leaves.len() as u32).map(Near::all));
            return &self.nodes;
        }
        self.nodes.push(Near::all(0));
        for boxes in &tree.levels {
            self.below.resize((self.nodes.len() + 1) * WIDTH, Near::default());
            let (nodes, below) = (&self.nodes, &mut self.below);
            let kept = dispatch!(level, simd => descend(simd, boxes, view, nodes, below));
            self.below.truncate(kept);
            std::mem::swap(&mut self.nodes, &mut self.below);
        }
        // The last node of a level is not full; what lies behind the last leaf is NaN and fails.
        &self.nodes
    }
}

/// Sixteen points or boxes, coordinate by coordinate.
type Triple<S> = [f32x16<S>; 3];

// What runs on vectors is written in functions that are always inlined: a closure, as `array::map`
// takes one, would be compiled without the vector instructions of its surroundings.

#[inline(always)]
fn load<S: Simd>(simd: S, lists: &[[f32; WIDTH]; 3]) -> Triple<S> {
    [
        f32x16::from_slice(simd, &lists[0]),
        f32x16::from_slice(simd, &lists[1]),
        f32x16::from_slice(simd, &lists[2]),
    ]
}

#[inline(always)]
fn dot<S: Simd>(v: &Triple<S>, row: [f32; 3]) -> f32x16<S> {
    v[0] * row[0] + v[1] * row[1] + v[2] * row[2]
}

/// How far a box with these half extents reaches along a row.
#[inline(always)]
fn reach<S: Simd>(half: &Triple<S>, row: [f32; 3]) -> f32x16<S> {
    dot(half, [row[0].abs(), row[1].abs(), row[2].abs()])
}

/// Which lanes a tool may reach, of boxes about a centre, with half extents along the tool's axes; and
/// for each lane by which of the `slabs`.
#[inline(always)]
fn within<S: Simd>(
    simd: S,
    reach: &Reach,
    slabs: u32,
    centre: Triple<S>,
    half: Triple<S>,
) -> (u32, u32x16<S>) {
    let zero = f32x16::splat(simd, 0.0);
    let [x, y, z] = centre;
    let (low, high) = (z - half[2], z + half[2]);
    let (dx, dy) = ((x.abs() - half[0]).max(zero), (y.abs() - half[1]).max(zero));
    let squared = dx * dx + dy * dy;
    let mut hit = mask32x16::splat(simd, false);
    let mut by = u32x16::splat(simd, 0);
    let mut left = slabs & reach.all;
    while left != 0 {
        let slab = left.trailing_zeros();
        left &= left - 1;
        let [slab_low, slab_high, radius] = reach.slabs[slab as usize % SLABS];
        let here = low.simd_le(slab_high) & high.simd_ge(slab_low) & squared.simd_le(radius);
        hit |= here;
        by = here.select(by | (1 << slab), by);
    }
    if let Some(across) = &reach.across {
        for (axis, [from, to]) in across.iter().enumerate() {
            hit &= (centre[axis] - half[axis]).simd_le(*to);
            hit &= (centre[axis] + half[axis]).simd_ge(*from);
        }
    }
    (hit.to_bitmask() as u32, by)
}

/// Tests the children of `nodes` and appends those that the tool may reach.
#[inline(always)]
fn descend<S: Simd>(
    simd: S,
    boxes: &[super::Boxes],
    view: &View,
    nodes: &[Near],
    below: &mut [Near],
) -> usize {
    let mut kept = 0;
    for node in nodes {
        let children = &boxes[node.index as usize];
        let (centre, half) = (load(simd, &children.centre), load(simd, &children.half));
        let seen = [
            dot(&centre, view.rows[0]) + view.origin[0],
            dot(&centre, view.rows[1]) + view.origin[1],
            dot(&centre, view.rows[2]) + view.origin[2],
        ];
        let wide =
            [reach(&half, view.rows[0]), reach(&half, view.rows[1]), reach(&half, view.rows[2])];
        let (hits, by) = within(simd, &view.nodes, node.slabs, seen, wide);
        let by: [u32; WIDTH] = by.to_array();
        let first = node.index * WIDTH as u32;
        // Write every child, keep those that hit: no branch to mispredict.
        let place = &mut below[kept..kept + WIDTH];
        let mut count = 0;
        for (lane, slabs) in by.into_iter().enumerate() {
            place[count & (WIDTH - 1)] = Near { index: first + lane as u32, slabs };
            count += (hits >> lane & 1) as usize;
        }
        kept += count;
    }
    kept
}

/// Adds the points of some leaves that may be inside the tool to the candidates.
pub(crate) fn filter(
    level: Level,
    tree: &Tree,
    view: &View,
    leaves: &[Near],
    candidates: &mut Candidates,
) {
    dispatch!(level, simd => sift(simd, tree, view, leaves, candidates));
}

#[inline(always)]
fn sift<S: Simd>(simd: S, tree: &Tree, view: &View, leaves: &[Near], candidates: &mut Candidates) {
    let boxes = &tree.levels[tree.levels.len() - 1];
    for leaf in leaves {
        let index = leaf.index as usize;
        let (last, lane) = (&boxes[index / WIDTH].centre, index % WIDTH);
        let centre = [f64::from(last[0][lane]), f64::from(last[1][lane]), f64::from(last[2][lane])];
        let points = &tree.leaves[index].offset;
        let offset = load(simd, points);
        let hits = if view.fits {
            let seen = [
                dot(&offset, view.rows[0]) + view.place(centre, 0),
                dot(&offset, view.rows[1]) + view.place(centre, 1),
                dot(&offset, view.rows[2]) + view.place(centre, 2),
            ];
            within(simd, &view.points, leaf.slabs, seen, [f32x16::splat(simd, 0.0); 3]).0
        } else {
            offset[0].simd_le(f32::INFINITY).to_bitmask() as u32
        };
        if hits != 0 {
            candidates.take(view, leaf.index * WIDTH as u32, centre, points, hits);
        }
    }
}
