//! The depth-first traversal of the triangle tree, deepest children first.

use crate::bvh::{Boxes, LaneVector, PoseTransform, WIDTH, dot, extent, load, transform};
use crate::certify::part::{Corners, NodeRing, PlaneLanes, TriangleBvh};
use crate::tool::{LANES, on_vectors};
use fearless_simd::{Level, Select, Simd, SimdBase, SimdFloat, SimdMask, dispatch, f32x16};

/// A node of the tree, a leaf or a triangle, and an upper bound of the tool's depth in it.
#[derive(Clone, Copy)]
pub(crate) struct Node {
    /// The level of its children. A leaf is a node whose children are triangles.
    pub(crate) level: u32,
    pub(crate) index: u32,
    pub(crate) bound: f32,
}

impl Node {
    /// Returns the ring about the tool's axis that contains the node, computed in `f64`.
    pub(crate) fn ring(&self, bvh: &TriangleBvh, view: &PoseTransform) -> Option<NodeRing> {
        bvh.ring(self.level as usize, self.index as usize, view)
    }

    /// Returns the flat faces that contain all of its triangles, if these are few.
    pub(crate) fn faces<'a>(&self, bvh: &'a TriangleBvh) -> Option<&'a [u32]> {
        bvh.coplanar_faces.of_node(self.level as usize, self.index as usize)
    }

    /// Returns half the diagonal of its box, in the tree's unit; infinity for the root.
    pub(crate) fn size(&self, bvh: &TriangleBvh) -> f64 {
        let Some(level) = self.level.checked_sub(1) else { return f64::INFINITY };
        let (node, lane) = (self.index as usize / WIDTH, self.index as usize % WIDTH);
        let half = &bvh.levels[level as usize][node].half;
        half.iter().map(|list| f64::from(list[lane]).powi(2)).sum::<f64>().sqrt()
    }

    /// Returns the children whose bits are set in `hits`.
    pub(crate) fn children(
        self,
        bvh: &TriangleBvh,
        hits: u32,
    ) -> impl Iterator<Item = Node> + use<> {
        let children = bvh.children(self.level as usize, self.index as usize);
        let there = (0..children as u32).filter(move |lane| hits >> lane & 1 == 1);
        let first = self.index * WIDTH as u32;
        there.map(move |lane| Node { level: self.level + 1, index: first + lane, ..self })
    }

    /// Returns the corners of a leaf's triangles in the tool's frame and unit.
    #[inline(always)]
    pub(crate) fn corners<S: Simd>(
        &self,
        simd: S,
        bvh: &TriangleBvh,
        view: &PoseTransform,
    ) -> [LaneVector<f32x16<S>>; 3] {
        let index = self.index as usize;
        let boxes = &bvh.levels[self.level as usize - 1][index / WIDTH];
        let lane = index % WIDTH;
        let centre = [boxes.centre[0][lane], boxes.centre[1][lane], boxes.centre[2][lane]];
        let middle = view.transform(centre);
        let Corners([a, b, c]) = &bvh.leaves[index];
        [
            transform(&load(simd, a), &view.rows, middle),
            transform(&load(simd, b), &view.rows, middle),
            transform(&load(simd, c), &view.rows, middle),
        ]
    }

    /// Returns whether its children are triangles.
    pub(crate) fn is_leaf(&self, bvh: &TriangleBvh) -> bool {
        self.level as usize == bvh.levels.len()
    }

    pub(crate) fn is_triangle(&self, bvh: &TriangleBvh) -> bool {
        self.level as usize > bvh.levels.len()
    }
}

/// The traversal stack. The children of the node opened last are on top, the deepest first.
#[derive(Clone, Default)]
pub(crate) struct Descent {
    stack: Vec<Node>,
    indices: Vec<u32>,
    /// True once the traversal has begun.
    started: bool,
}

/// The boxes and the planes of a node's children.
#[derive(Clone, Copy)]
pub(crate) struct Children<'a> {
    pub(crate) boxes: &'a Boxes,
    pub(crate) planes: &'a PlaneLanes,
}

/// An upper bound of depth, or of a negative distance, in boxes.
pub(crate) trait BoxBounds {
    /// Returns the bounds of 16 boxes; absent boxes have NaN centres. A bound of at most `threshold` need not be tight.
    fn of_boxes<S: Simd>(
        &self,
        simd: S,
        children: Children<'_>,
        view: &PoseTransform,
        threshold: f32,
    ) -> f32x16<S>;
}

/// Such a bound in boxes and in triangles.
pub(crate) trait Bounds: BoxBounds {
    /// Returns the bounds of 16 triangles in the tool's frame. A bound of at most `threshold` need not be tight.
    fn of_triangles<S: Simd>(
        &self,
        simd: S,
        corners: &[LaneVector<f32x16<S>>; 3],
        threshold: f32,
    ) -> f32x16<S>;
}

/// Slabs between two planes in the tool's frame, one per lane, that contain nodes.
#[derive(Clone, Copy)]
pub(crate) struct PlaneSlabs<V> {
    /// The direction across the slab, no longer than 1 but for rounding, for which the ends have room.
    normal: LaneVector<V>,
    /// The range of positions along the direction.
    low: V,
    high: V,
    /// The reciprocal of the length of the direction's part across the axis; 0 if that is short.
    per_radial: V,
}

impl<S: Simd> PlaneSlabs<f32x16<S>> {
    /// Transforms planes to the tool's frame. `margin` is the rounding error bound of a point in `f32`.
    ///
    /// With u = 2⁻²⁴ each part of the direction errs by less than 8u, its product with the origin by less than 13u of the sum
    /// of the origin's coordinates, and the ends by 4u of the part's size. A height to which the direction is applied errs
    /// by the margin, and its product by 9u of the height, which is at most the part's size from the origin's or within the
    /// tool. The margin is 16u of the tool's size and more than 64u of the part's, so all of these are less than two margins
    /// and 32u of the origin's coordinates.
    #[inline(always)]
    pub(crate) fn new(
        simd: S,
        planes: &PlaneLanes,
        view: &PoseTransform,
        margin: f32,
    ) -> PlaneSlabs<f32x16<S>> {
        let turned = transform(&load(simd, &planes.normal), &view.rows, [0.0; 3]);
        let per_unit = 1.0 / view.unit;
        let normal = [turned[0] * per_unit, turned[1] * per_unit, turned[2] * per_unit];
        let middle = dot(&normal, view.origin);
        let [x, y, z] = view.origin.map(f32::abs);
        let error = 2.0 * margin + (x + y + z) * (16.0 * f32::EPSILON);
        let low = f32x16::from_slice(simd, &planes.low) * view.unit + (middle - error);
        let high = f32x16::from_slice(simd, &planes.high) * view.unit + (middle + error);
        let radial = (normal[0] * normal[0] + normal[1] * normal[1]).sqrt();
        let one = f32x16::splat(simd, 1.0);
        let per_radial = radial.simd_gt(MIN_RADIAL).select(one / radial, f32x16::splat(simd, 0.0));
        PlaneSlabs { normal, low, high, per_radial }
    }

    #[inline(always)]
    fn widen(&mut self, distance: f32x16<S>) {
        self.low -= distance;
        self.high += distance;
    }

    /// Returns at most the distance from the axis of each point of the slab between two heights.
    #[inline(always)]
    pub(crate) fn distance_of_axis(&self, low: f32x16<S>, high: f32x16<S>) -> f32x16<S> {
        let (a, b) = (self.normal[2] * low, self.normal[2] * high);
        let (least, greatest) = (self.low - a.max(b), self.high - a.min(b));
        least.max(-greatest) * self.per_radial
    }

    /// Returns at most the distance of each point of the slab from a point of the axis.
    #[inline(always)]
    pub(crate) fn distance_of_point(&self, z: f32) -> f32x16<S> {
        let at = self.normal[2] * z;
        (self.low - at).max(at - self.high)
    }
}

/// The length of a direction's part across the axis from which it bounds the distance from the axis.
const MIN_RADIAL: f32 = 0.25;

/// Rings about the axis that contain boxes: the least and greatest distance from the axis, and the range of heights.
pub(crate) struct BoxRings<V> {
    pub(crate) near: V,
    pub(crate) far: V,
    pub(crate) low: V,
    pub(crate) high: V,
    /// The planes between which the nodes lie, too.
    pub(crate) planes: Option<PlaneSlabs<V>>,
}

/// A bound on the displacement of points in the tool's frame: a translation, and a rotation about an axis through
/// the tip.
#[derive(Clone, Copy, Default)]
pub(crate) struct Displacement {
    /// The axis of the rotation.
    pub(crate) axis: [f32; 3],
    pub(crate) translation: [f32; 3],
    pub(crate) length: f32,
    /// The distance to be kept.
    pub(crate) clearance: f32,
    pub(crate) turn: f32,
    /// The largest relevant distance of a point from the axis of the rotation.
    pub(crate) reach: f32,
    /// Bound on the distance of points from the approximating motion.
    pub(crate) deviation: f32,
}

impl Displacement {
    /// Returns a bound on how far paths are from straight, for points at a distance `far` from the axis of the
    /// rotation: `MotionInterval::deviation_bound` in `f32`. The margin of a sweep covers its rounding.
    #[inline(always)]
    pub(crate) fn deviation_bound<S: Simd>(&self, simd: S, far: f32x16<S>) -> f32x16<S> {
        let reach = f32x16::splat(simd, self.reach).min(far + self.length);
        (reach * (0.5 * self.turn) + self.length) * self.turn + self.deviation
    }
}

/// Returns the rings that contain nodes, and their whole paths if a displacement is given. `margin` is the rounding error
/// bound of a point in `f32`.
#[inline(always)]
pub(crate) fn rings<S: Simd>(
    simd: S,
    Children { boxes, planes }: Children<'_>,
    view: &PoseTransform,
    margin: f32,
    shift: Option<&Displacement>,
) -> BoxRings<f32x16<S>> {
    let mut planes = PlaneSlabs::new(simd, planes, view, margin);
    let centre = load(simd, &boxes.centre);
    let half = load(simd, &boxes.half);
    let [x, y, z] = transform(&centre, &view.rows, view.origin);
    let zero = f32x16::splat(simd, 0.0);
    let (x, y) = (x.abs(), y.abs());
    let rows = &view.rows;
    let mut wide = [extent(&half, rows[0]), extent(&half, rows[1]), extent(&half, rows[2])];
    if let Some(shift) = shift {
        let reach = f32x16::splat(simd, shift.reach);
        let far = [x + wide[0], y + wide[1], z.abs() + wide[2]];
        // Upper bounds of the components of `axis × p`.
        let [u, v, w] = shift.axis.map(f32::abs);
        let across = [far[2] * v + far[1] * w, far[2] * u + far[0] * w, far[0] * v + far[1] * u];
        let curve = shift.deviation_bound(simd, across[0] + across[1] + across[2]);
        for axis in 0..3 {
            // A component of `axis × p` is no longer than the distance from the axis of the rotation.
            let turned = reach.min(across[axis]) * shift.turn;
            let straight = shift.translation[axis].abs() + shift.clearance;
            wide[axis] = wide[axis] + turned + straight + curve;
        }
        // The same for the component along the planes' normals: `n · (axis × p)` is `(n × axis) · p`.
        let ([a, b, c], [u, v, w]) = (planes.normal, shift.axis);
        let across = (b * w - c * v).abs() * far[0]
            + (c * u - a * w).abs() * far[1]
            + (a * v - b * u).abs() * far[2];
        let moved = dot(&planes.normal, shift.translation).abs();
        planes.widen(moved + reach.min(across) * shift.turn + curve + shift.clearance);
    }
    let (near_x, near_y) = ((x - wide[0]).max(zero), (y - wide[1]).max(zero));
    let (far_x, far_y) = (x + wide[0], y + wide[1]);
    BoxRings {
        near: (near_x * near_x + near_y * near_y).sqrt(),
        far: (far_x * far_x + far_y * far_y).sqrt(),
        low: z - wide[2],
        high: z + wide[2],
        planes: Some(planes),
    }
}

/// A tree of triangles with the bounds by which it is descended, and the transform to the tool's frame.
pub(crate) struct BoundedTree<'a, B> {
    pub(crate) bvh: &'a TriangleBvh,
    pub(crate) bounds: &'a B,
    pub(crate) view: &'a PoseTransform,
}

impl Descent {
    pub(crate) fn clear(&mut self) {
        self.stack.clear();
        self.started = false;
    }

    /// Pushes the root.
    pub(crate) fn begin(&mut self) {
        self.stack.push(Node { level: 0, index: 0, bound: f32::INFINITY });
        self.started = true;
    }

    /// Returns whether the traversal has begun.
    pub(crate) fn started(&self) -> bool {
        self.started
    }

    pub(crate) fn pop(&mut self) -> Option<Node> {
        self.stack.pop()
    }

    /// Returns a triangle and those next to it on the stack: up to eight in all. The others have bounds that exceed
    /// `threshold`.
    pub(crate) fn triangles(
        &mut self,
        bvh: &TriangleBvh,
        first: Node,
        threshold: f32,
    ) -> &mut Vec<u32> {
        self.indices.clear();
        self.indices.push(first.index);
        while self.indices.len() < LANES
            && let Some(next) = self.stack.pop_if(|node| node.is_triangle(bvh))
        {
            // The threshold may have risen since it was pushed.
            if next.bound > threshold || next.bound.is_nan() {
                self.indices.push(next.index);
            }
        }
        &mut self.indices
    }

    /// Pushes the children of a node whose bounds exceed `threshold`.
    pub(crate) fn open<B: Bounds>(
        &mut self,
        level: Level,
        tree: &BoundedTree<'_, B>,
        node: Node,
        threshold: f32,
    ) {
        let bvh = tree.bvh;
        let mut bounds = [node.bound; WIDTH];
        let hits = if node.is_leaf(bvh) {
            of_leaf(level, tree, node, threshold, &mut bounds)
        } else {
            of_children(level, tree, node, threshold, &mut bounds)
        };
        self.take(bvh, node, hits, &bounds);
    }

    /// Pushes all children of a node, where `f32` cannot represent their bounds.
    pub(crate) fn open_all(&mut self, bvh: &TriangleBvh, node: Node) {
        self.take(bvh, node, u32::MAX, &[node.bound; WIDTH]);
    }

    fn take(&mut self, bvh: &TriangleBvh, node: Node, hits: u32, bounds: &[f32; WIDTH]) {
        let children = bvh.children(node.level as usize, node.index as usize);
        // A node at the end of its level has fewer children than 16.
        let mut hits = hits & (u32::MAX >> (32 - children));
        let first = self.stack.len();
        while hits != 0 {
            let lane = hits.trailing_zeros();
            hits &= hits - 1;
            let bound = bounds[lane as usize];
            let index = node.index * WIDTH as u32 + lane;
            let child = Node { level: node.level + 1, index, bound };
            // Insertion keeps the deepest on top: there are at most 16 children, most of them in order.
            let mut at = self.stack.len();
            self.stack.push(child);
            while at > first && self.stack[at - 1].bound > bound {
                self.stack[at] = self.stack[at - 1];
                at -= 1;
            }
            self.stack[at] = child;
        }
    }
}

/// Returns a bit mask of the bounds that are above `threshold` or NaN.
#[inline(always)]
pub(crate) fn above<S: Simd>(bound: f32x16<S>, threshold: f32) -> u32 {
    // Not `simd_gt`: a NaN bound rules nothing out.
    !bound.simd_le(threshold).to_bitmask() as u32
}

/// Returns a bit mask of the children of an inner node whose bounds may exceed `threshold`.
pub(crate) fn of_children<B: BoxBounds>(
    level: Level,
    tree: &BoundedTree<'_, B>,
    node: Node,
    threshold: f32,
    bounds: &mut [f32; WIDTH],
) -> u32 {
    dispatch!(level, simd => of_boxes(simd, tree, node, threshold, bounds))
}

#[inline(always)]
fn of_boxes<S: Simd, B: BoxBounds>(
    simd: S,
    tree: &BoundedTree<'_, B>,
    node: Node,
    threshold: f32,
    bounds: &mut [f32; WIDTH],
) -> u32 {
    let (level, index) = (node.level as usize, node.index as usize);
    let children = Children {
        boxes: &tree.bvh.levels[level][index],
        planes: &tree.bvh.plane_lanes[level][index],
    };
    let bound = tree.bounds.of_boxes(simd, children, tree.view, threshold);
    bound.store_slice(bounds);
    above(bound, threshold)
}

/// The same for a leaf. Without vector instructions its triangles keep the leaf's bound.
fn of_leaf<B: Bounds>(
    level: Level,
    tree: &BoundedTree<'_, B>,
    node: Node,
    threshold: f32,
    bounds: &mut [f32; WIDTH],
) -> u32 {
    on_vectors!(level, simd => of_leaf_on(simd, tree, node, threshold, bounds));
    u32::MAX
}

#[inline(always)]
fn of_leaf_on<S: Simd, B: Bounds>(
    simd: S,
    tree: &BoundedTree<'_, B>,
    node: Node,
    threshold: f32,
    bounds: &mut [f32; WIDTH],
) -> u32 {
    let corners = node.corners(simd, tree.bvh, tree.view);
    let bound = tree.bounds.of_triangles(simd, &corners, threshold);
    bound.store_slice(bounds);
    above(bound, threshold)
}
