//! Which points may be inside a tool: the descent in `f32`, with margins.

use super::{Tree, WIDTH};
use crate::pose::Pose;
use crate::tool::Card;
use fearless_simd::{Level, Simd, SimdBase, SimdMask, dispatch, f32x16, mask32x16};

/// A part seen from a tool at a pose: the map to the tool's frame, and the tool's reach, in `f32`
/// and in the tree's unit, with room for what `f32` rounds away.
pub(crate) struct View {
    /// Rotation from the world to the tool.
    rows: [[f32; 3]; 3],
    /// The cloud's origin in the tool's frame.
    origin: [f32; 3],
    /// Low end, high end and squared radius of each slab, for nodes and for points.
    nodes: Vec<[f32; 3]>,
    points: Vec<[f32; 3]>,
    /// For leaves: the rotation and the origin as they are, in `f64`.
    exact_rows: [[f64; 3]; 3],
    exact_origin: [f64; 3],
    /// Whether all of this fits `f32`; if not, no point is ruled out.
    fits: bool,
}

/// The unit roundoff of `f32`.
const ROUNDOFF: f64 = 1.0 / 16_777_216.0;

impl View {
    /// An empty view, to be set.
    pub(crate) fn new() -> View {
        View {
            rows: [[0.0; 3]; 3],
            origin: [0.0; 3],
            nodes: Vec::new(),
            points: Vec::new(),
            exact_rows: [[0.0; 3]; 3],
            exact_origin: [0.0; 3],
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
        let from_tip = (tree.origin - pose.tip()) / tree.scale;
        for axis in 0..3 {
            let column = rotation.column(axis);
            self.exact_rows[axis] = [column[0], column[1], column[2]];
            self.exact_origin[axis] = column.dot(&from_tip);
        }
        self.rows = self.exact_rows.map(|row| row.map(|v| v as f32));
        self.origin = self.exact_origin.map(|v| v as f32);
        let unit = length / tree.scale;
        let reach = card.envelope.iter().map(|s| s.low.abs().max(s.high.abs()).max(s.radius));
        let tool = reach.fold(0.0, f64::max) * unit;
        let far = self.exact_origin.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let node_margin = 16.0 * ROUNDOFF * (far + 3.0 * f64::from(tree.size));
        // A leaf that the descent kept is no farther from the tool than the tool's size and its own.
        let near = tool + 4.0 * f64::from(tree.leaf_size) + 2.0 * node_margin;
        let point_margin = 16.0 * ROUNDOFF * (near + 3.0 * f64::from(tree.leaf_size));
        let widened = |slabs: &mut Vec<[f32; 3]>, margin: f64| {
            slabs.clear();
            slabs.extend(card.envelope.iter().map(|slab| {
                let radius = slab.radius * unit + margin;
                // Two roundings more, to f32 and of the comparison's own square.
                let squared = radius * radius * (1.0 + 8.0 * ROUNDOFF);
                let low = slab.low * unit - margin;
                let high = slab.high * unit + margin;
                [(low as f32).next_down(), (high as f32).next_up(), (squared as f32).next_up()]
            }));
        };
        widened(&mut self.nodes, node_margin);
        widened(&mut self.points, point_margin);
        self.fits = self.origin.iter().chain(self.nodes.iter().flatten()).all(|v| v.is_finite());
    }
}

/// The descent, with its memory kept between queries.
pub(crate) struct Walker {
    nodes: Vec<u32>,
    below: Vec<u32>,
}

impl Walker {
    pub(crate) fn new() -> Walker {
        Walker { nodes: Vec::new(), below: Vec::new() }
    }

    /// The leaves that may have a point inside the tool, in order.
    pub(crate) fn leaves(&mut self, level: Level, tree: &Tree, view: &View) -> &[u32] {
        self.nodes.clear();
        if !view.fits {
            self.nodes.extend(0..tree.leaves.len() as u32);
            return &self.nodes;
        }
        self.nodes.push(0);
        for boxes in &tree.levels {
            self.below.resize((self.nodes.len() + 1) * WIDTH, 0);
            let (nodes, below) = (&self.nodes, &mut self.below);
            let kept = dispatch!(level, simd => descend(simd, boxes, view, nodes, below));
            self.below.truncate(kept);
            std::mem::swap(&mut self.nodes, &mut self.below);
        }
        // The last node of a level is not full; what lies behind the last leaf is NaN and fails.
        &self.nodes
    }
}

/// Tests the children of `nodes` and appends those that the tool may reach.
#[inline(always)]
fn descend<S: Simd>(
    simd: S,
    boxes: &[super::Boxes],
    view: &View,
    nodes: &[u32],
    below: &mut [u32],
) -> usize {
    let mut kept = 0;
    for node in nodes {
        let children = &boxes[*node as usize];
        let centre = children.centre.each_ref().map(|c| f32x16::from_slice(simd, c));
        let half = children.half.each_ref().map(|h| f32x16::from_slice(simd, h));
        let place = |axis: usize| {
            let row = view.rows[axis];
            centre[0] * row[0] + centre[1] * row[1] + centre[2] * row[2] + view.origin[axis]
        };
        let reach = |axis: usize| {
            let row = view.rows[axis].map(f32::abs);
            half[0] * row[0] + half[1] * row[1] + half[2] * row[2]
        };
        let (z, dz) = (place(2), reach(2));
        let (low, high) = (z - dz, z + dz);
        let zero = f32x16::splat(simd, 0.0);
        let across = |axis: usize| (place(axis).abs() - reach(axis)).max(zero);
        let (x, y) = (across(0), across(1));
        let squared = x * x + y * y;
        let mut hit = mask32x16::splat(simd, false);
        for [slab_low, slab_high, radius] in &view.nodes {
            hit |= low.simd_le(*slab_high) & high.simd_ge(*slab_low) & squared.simd_le(*radius);
        }
        let hits = hit.to_bitmask() as u32;
        let first = node * WIDTH as u32;
        // Write every child, keep those that hit: no branch to mispredict.
        for lane in 0..WIDTH as u32 {
            below[kept] = first + lane;
            kept += (hits >> lane & 1) as usize;
        }
    }
    kept
}

/// The points of a leaf that may be inside the tool, a bit each.
pub(crate) fn filter(level: Level, tree: &Tree, view: &View, leaves: &[u32], found: &mut Vec<u32>) {
    dispatch!(level, simd => sift(simd, tree, view, leaves, found));
}

#[inline(always)]
fn sift<S: Simd>(simd: S, tree: &Tree, view: &View, leaves: &[u32], found: &mut Vec<u32>) {
    for leaf in leaves {
        let index = *leaf as usize;
        let last = &tree.levels[tree.levels.len() - 1][index / WIDTH];
        let centre: [f64; 3] =
            std::array::from_fn(|axis| f64::from(last.centre[axis][index % WIDTH]));
        let offset = tree.leaves[index].offset.each_ref().map(|o| f32x16::from_slice(simd, o));
        let place = |axis: usize| {
            let row = view.exact_rows[axis];
            let base = row[0] * centre[0]
                + row[1] * centre[1]
                + row[2] * centre[2]
                + view.exact_origin[axis];
            let row = view.rows[axis];
            offset[0] * row[0] + offset[1] * row[1] + offset[2] * row[2] + base as f32
        };
        let (x, y, z) = (place(0), place(1), place(2));
        let squared = x * x + y * y;
        let mut hit = mask32x16::splat(simd, false);
        if view.fits {
            for [low, high, radius] in &view.points {
                hit |= z.simd_le(*high) & z.simd_ge(*low) & squared.simd_le(*radius);
            }
        } else {
            hit = offset[0].simd_le(f32::INFINITY);
        }
        let mut hits = hit.to_bitmask() as u32;
        while hits != 0 {
            found.push(leaf * WIDTH as u32 + hits.trailing_zeros());
            hits &= hits - 1;
        }
    }
}
