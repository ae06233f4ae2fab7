//! The triangles of a part in a bounding volume hierarchy, with the planes of its nodes.
//!
//! A flat tool end on a plate is equally deep in all triangles of the plate, and `f32` cannot tell them apart.
//! The extent of a node's triangles along a normal, in `f64`, can.

mod coplanar_faces;
mod winding;

use crate::bvh::{Bounds, Boxes, BuildItem, Frame, PoseTransform, WIDTH, levels, order, outward};
use crate::certify::part::coplanar_faces::CoplanarFaces;
use crate::certify::space::{Point, dot};
use crate::id::TriangleId;
use crate::mesh::{self, Mesh, area_and_normal, inverted, neighbours, position_bits};
use crate::parallel;
use crate::unit::Unit;
use nalgebra::{Point3, Vector3};
use std::cmp::Ordering;
use std::collections::HashMap;

pub(crate) use coplanar_faces::Face;
pub use winding::Location;

/// A bounding volume hierarchy of a part's triangles, for queries of the depth of a tool: a 16-wide tree of boxes
/// like that of a point cloud, whose leaves hold 16 triangles.
///
/// Corners are kept as given, in the part's frame and unit. Triangles without area are kept too: they act as edges.
#[derive(Clone, Debug)]
pub struct TriangleBvh {
    pub(crate) frame: Frame,
    /// The levels of boxes, from the root's children down to the leaves.
    pub(crate) levels: Vec<Vec<Boxes>>,
    /// A plane per node of each level; the last list is for the leaves.
    planes: Vec<Vec<Plane>>,
    /// The same planes of the children of each node, for `f32`: list by list as in `levels`.
    pub(crate) plane_lanes: Vec<Vec<PlaneLanes>>,
    pub(crate) coplanar_faces: CoplanarFaces,
    /// The corners of the 16 triangles of each leaf.
    pub(crate) leaves: Vec<Corners>,
    /// The corners of each triangle, in the tree's order, in the part's frame and unit.
    pub(crate) corners: Vec<[[f64; 3]; 3]>,
    /// The ids of the triangles in the mesh, in the tree's order.
    pub(crate) ids: Vec<TriangleId>,
    unit: Unit,
    /// True if inside and outside are defined; see [`TriangleBvh::has_inside`].
    solid: bool,
}

/// A search of the triangles of a [`TriangleBvh`] by their boxes.
pub trait BoxVisitor {
    /// Returns whether the triangles in a box have to be visited, by its centre relative to [`TriangleBvh::origin`] and half of
    /// its size, both within 1e-6 of that size.
    fn enters(&mut self, centre: Vector3<f64>, half: Vector3<f64>) -> bool;

    /// Visits a triangle by its corners, in the part's frame and unit.
    fn triangle(&mut self, corners: [Point3<f64>; 3]);
}

/// The first, second and third corners of 16 triangles relative to the centre of their box, coordinate by
/// coordinate. Absent triangles have NaN coordinates.
#[derive(Clone, Debug)]
pub(crate) struct Corners(pub(crate) [[[f32; WIDTH]; 3]; 3]);

impl Corners {
    /// Stores the corners of a leaf's triangles relative to the centre of its box.
    fn of(triangles: &[[Point; 3]], centre: Point, frame: &Frame) -> Corners {
        let mut corners = Corners([[[f32::NAN; WIDTH]; 3]; 3]);
        for (lane, triangle) in triangles.iter().enumerate() {
            for (list, corner) in corners.0.iter_mut().zip(triangle) {
                let point = frame.inside(*corner);
                for axis in 0..3 {
                    // Relative to the box as it is stored, so that only this difference is rounded.
                    list[axis][lane] = (point[axis] - centre[axis]) as f32;
                }
            }
        }
        corners
    }
}

/// Returns the distance from a plane, in the part's unit, up to which a point counts as in it. It adds to the
/// depth of a face, so any value would be correct. With `32 u` of the part's extent (`u = ε/2`), triangles of a
/// plane whose corners were rounded once form one face. The test itself errs by less than `10 u` of a face's
/// extent, for which [`rounding`](crate::certify::rounding) has room: a face is used for a bound only, without
/// the `41 uM` of meridians and lines.
pub(crate) fn flat(frame: &Frame) -> f64 {
    16.0 * f64::EPSILON * f64::from(frame.size) * frame.scale
}

impl TriangleBvh {
    /// Builds the tree of a mesh's triangles.
    pub fn new(mesh: &Mesh) -> TriangleBvh {
        let corners: Vec<[[f64; 3]; 3]> =
            mesh.corners().map(|corners| corners.map(|p| [p.x, p.y, p.z])).collect();
        let frame = Frame::around(corners.iter().flatten().copied());
        let mut items: Vec<BuildItem> = corners
            .iter()
            .zip(0u32..)
            .map(|(corners, index)| {
                let bounds = Bounds::of(corners.map(|point| frame.inside(point)));
                BuildItem { at: [0, 1, 2].map(|axis| bounds.middle(axis)), index }
            })
            .collect();
        order(&mut items);
        let corners: Vec<_> = items.iter().map(|item| corners[item.index as usize]).collect();
        let boxes: Vec<Bounds> = corners
            .chunks(WIDTH)
            .map(|leaf| Bounds::of(leaf.iter().flatten().map(|corner| frame.inside(*corner))))
            .collect();
        let levels = levels(boxes);
        let above = &levels[levels.len() - 1];
        let leaves = parallel::each(corners.len().div_ceil(WIDTH), |leaf| {
            let triangles = corners.chunks(WIDTH).nth(leaf).unwrap_or_default();
            let (boxes, lane) = (&above[leaf / WIDTH], leaf % WIDTH);
            let centre = boxes.centre.map(|list| f64::from(list[lane]));
            Corners::of(triangles, centre, &frame)
        });
        let inside: Vec<_> =
            corners.iter().map(|triangle| triangle.map(|corner| frame.inside(corner))).collect();
        let depth = levels.len() as u32;
        // A node of this level holds the triangles of all leaves below it, which are consecutive.
        let planes: Vec<Vec<Plane>> = (0..=depth)
            .map(|level| {
                let below = WIDTH.pow(depth + 1 - level);
                parallel::each(inside.len().div_ceil(below), |node| {
                    Plane::of(inside.chunks(below).nth(node).unwrap_or_default())
                })
            })
            .collect();
        let plane_lanes = planes[1..].iter().map(|planes| {
            planes.chunks(WIDTH).map(|children| PlaneLanes::of(children, &frame)).collect()
        });
        let ids: Vec<TriangleId> = items.iter().map(|item| TriangleId(item.index)).collect();
        let triangles: Vec<_> = ids.iter().map(|id| mesh.triangles()[id.index()]).collect();
        let (survey, (neighbours, coplanar_faces)) = parallel::both(
            || mesh.diagnostics(),
            || {
                let neighbours = neighbours(&triangles, mesh.vertices().len());
                let faces = CoplanarFaces::new(&corners, &neighbours, flat(&frame));
                (neighbours, faces)
            },
        );
        let mut bvh = TriangleBvh {
            coplanar_faces,
            plane_lanes: plane_lanes.collect(),
            planes,
            leaves,
            levels,
            corners,
            ids,
            frame,
            unit: mesh.unit(),
            solid: survey.is_solid(),
        };
        // The rays that decide this need the finished tree.
        bvh.solid = bvh.solid
            && bvh.voids_are_voids(&neighbours)
            && (survey.shared_edges == 0 || bvh.double_triangles_are_inside());
        bvh
    }

    /// Returns whether triangles that are stored in both directions are in the material, as where two solids touch. A body
    /// all of whose triangles are stored so has no inside.
    fn double_triangles_are_inside(&self) -> bool {
        let turns = |triangle: &[Point; 3]| {
            let mut sorted = [0, 1, 2];
            sorted
                .sort_by(|a, b| triangle[*a].partial_cmp(&triangle[*b]).unwrap_or(Ordering::Equal));
            let is_turned = matches!(sorted, [0, 2, 1] | [1, 0, 2] | [2, 1, 0]);
            (sorted.map(|k| position_bits(triangle[k])), is_turned)
        };
        let mut first_by_corners = HashMap::new();
        (0..self.corners.len()).all(|index| {
            let (corners, is_turned) = turns(&self.corners[index]);
            let (first, was_turned) =
                *first_by_corners.entry(corners).or_insert((index, is_turned));
            let has_sides = || area_and_normal(&self.corners[index].map(Point3::from)).is_some();
            // The sides of the first one, which the second turns around.
            is_turned == was_turned
                || !has_sides()
                || self.winding_beside(first).is_some_and(|winding| winding > 0)
        })
    }

    /// Returns whether pieces that face inward are voids in the material. Next to none of their triangles is the
    /// winding number of the surface negative, as it is inside a piece that is inside out.
    fn voids_are_voids(&self, neighbours: &[[u32; 3]]) -> bool {
        let corners: Vec<_> = self.corners().collect();
        inverted(&corners, neighbours).into_iter().all(|index| {
            let has_sides = area_and_normal(&corners[index as usize]).is_some();
            !has_sides || self.winding_beside(index as usize).is_some_and(|winding| winding >= 0)
        })
    }

    /// Returns the lowest and the highest corner of the bounding box, in the part's unit.
    pub fn bounds(&self) -> [Point3<f64>; 2] {
        mesh::bounds(self.corners.iter().flatten().map(|corner| Point3::from(*corner)))
    }

    /// Returns the number of triangles.
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Returns whether there are no triangles; a [`Mesh`] always has some.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// Returns whether inside and outside are defined: the mesh is closed, consistently oriented, and not inside out.
    pub fn has_inside(&self) -> bool {
        self.solid
    }

    /// Returns the unit of length.
    pub fn unit(&self) -> Unit {
        self.unit
    }

    /// Returns the point to which the boxes of [`TriangleBvh::visit`] are relative, in the part's frame and unit.
    pub fn origin(&self) -> Point3<f64> {
        Point3::from(self.frame.origin)
    }

    /// Returns the ids of the triangles in the order of the tree, in which neighbours are close.
    pub fn triangle_ids(&self) -> &[TriangleId] {
        &self.ids
    }

    /// Iterates over the corners of the triangles in the order of the tree, in the part's frame and unit.
    pub fn corners(&self) -> impl Iterator<Item = [Point3<f64>; 3]> {
        self.corners.iter().map(|corners| corners.map(Point3::from))
    }

    /// Visits the triangles in those boxes that the visitor enters, by boxes of boxes.
    pub fn visit(&self, visitor: &mut impl BoxVisitor) {
        let mut stack = vec![(0, 0)];
        while let Some((level, index)) = stack.pop() {
            for lane in 0..self.children(level, index) {
                let child = index * WIDTH + lane;
                let Some(boxes) = self.levels.get(level).map(|boxes| &boxes[index]) else {
                    visitor.triangle(self.corners[child].map(Point3::from));
                    continue;
                };
                let [centre, half] = [&boxes.centre, &boxes.half].map(|list| {
                    Vector3::from_fn(|k, _| f64::from(list[k][lane]) * self.frame.scale)
                });
                if visitor.enters(centre, half) {
                    stack.push((level + 1, child));
                }
            }
        }
    }

    /// Returns the number of children of a node of a level; below the last level are the leaves.
    pub(crate) fn children(&self, level: usize, node: usize) -> usize {
        let below = match self.levels.len() - level.min(self.levels.len()) {
            0 => self.len(),
            1 => self.leaves.len(),
            _ => self.levels[level + 1].len(),
        };
        (below - WIDTH * node).min(WIDTH)
    }
}

/// A direction, and the extent of the corners of a node's triangles along it, in the tree's frame and unit.
#[derive(Clone, Copy, Debug)]
struct Plane {
    normal: Point,
    ends: [f64; 2],
}

/// The planes of sixteen nodes: a direction no longer than 1, and the extent of the node along it from the frame's origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneLanes {
    pub(crate) normal: [[f32; WIDTH]; 3],
    pub(crate) low: [f32; WIDTH],
    pub(crate) high: [f32; WIDTH],
}

impl PlaneLanes {
    fn of(planes: &[Plane], frame: &Frame) -> PlaneLanes {
        let mut lanes =
            PlaneLanes { normal: [[0.0; WIDTH]; 3], low: [0.0; WIDTH], high: [0.0; WIDTH] };
        // With u = ε/2 the stored direction differs by 8u, which makes it no longer than 1, and √3 u for rounding it. A point
        // of the part is less than its size from the origin.
        let unit = f64::from(f32::EPSILON) / 2.0;
        let slack = 10.0 * unit * f64::from(frame.size);
        for (lane, Plane { normal, ends: [low, high] }) in planes.iter().enumerate() {
            for (list, part) in lanes.normal.iter_mut().zip(normal) {
                list[lane] = ((1.0 - 8.0 * unit) * part) as f32;
            }
            lanes.low[lane] = -outward(slack - low);
            lanes.high[lane] = outward(slack + high);
        }
        lanes
    }
}

/// A ring about the tool's axis that contains a node: the least distance from the axis, and the range of heights,
/// in the tool's unit.
pub(crate) struct NodeRing {
    pub(crate) near: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Plane {
    /// Computes the plane of triangles along the mean of their normals, from corners in the tree's frame.
    fn of(triangles: &[[Point; 3]]) -> Plane {
        let mut sum = [0.0; 3];
        for [a, b, c] in triangles {
            let [u, v] = [b, c].map(|p| [0, 1, 2].map(|k| p[k] - a[k]));
            sum[0] += u[1] * v[2] - u[2] * v[1];
            sum[1] += u[2] * v[0] - u[0] * v[2];
            sum[2] += u[0] * v[1] - u[1] * v[0];
        }
        // Any direction of length 1 is correct. Scaled, so that the squares of a short sum are not subnormal.
        let largest = sum.iter().fold(0.0f64, |largest, part| largest.max(part.abs()));
        let normal = if largest > 0.0 {
            let scaled = sum.map(|part| part / largest);
            let length = dot(scaled, scaled).sqrt();
            scaled.map(|part| part / length)
        } else {
            [0.0, 0.0, 1.0]
        };
        let heights = triangles.iter().flatten().map(|corner| dot(normal, *corner));
        let ends = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], height| {
            [low.min(height), high.max(height)]
        });
        Plane { normal, ends }
    }
}

/// The box and the plane of a node, in the tree's frame and unit.
struct NodeBounds {
    centre: Point,
    half: Point,
    plane: Plane,
}

impl NodeBounds {
    /// Returns the extent of the node along a direction of the tree's frame, for a position of `origin` at the frame's
    /// origin. Its component normal to the plane is bounded tightly, the rest by the box; the box alone may be tighter.
    #[inline]
    fn extent(&self, direction: Point, origin: f64) -> [f64; 2] {
        let NodeBounds { centre, half, plane: Plane { normal, ends } } = *self;
        let part = dot(direction, normal);
        // The box bounds the directions that the plane leaves open.
        let rest = [0, 1, 2].map(|k| direction[k] - part * normal[k]);
        let wide = dot(rest.map(f64::abs), half);
        let middle = origin + dot(rest, centre);
        let [a, b] = ends.map(|end| part * end);
        let flat = [middle + a.min(b) - wide, middle + a.max(b) + wide];
        let boxed = [-1.0, 1.0].map(|side| {
            origin + dot(direction, centre) + side * dot(direction.map(f64::abs), half)
        });
        [flat[0].max(boxed[0]), flat[1].min(boxed[1])]
    }
}

/// Returns the least magnitude in a range.
#[inline]
fn least_magnitude([low, high]: [f64; 2]) -> f64 {
    low.max(-high).max(0.0)
}

impl TriangleBvh {
    /// Returns the ring about the tool's axis that contains a node, from its box and its plane. Returns `None` for
    /// the root, which has no box.
    pub(crate) fn ring(
        &self,
        level: usize,
        index: usize,
        view: &PoseTransform,
    ) -> Option<NodeRing> {
        let boxes = &self.levels[level.checked_sub(1)?][index / WIDTH];
        let lane = index % WIDTH;
        let centre = [0, 1, 2].map(|axis| f64::from(boxes.centre[axis][lane]));
        let half = [0, 1, 2].map(|axis| f64::from(boxes.half[axis][lane]));
        let node = NodeBounds { centre, half, plane: self.planes[level][index] };
        let (rows, origin) = view.exactly();
        let [low, high] = node.extent(rows[2], origin[2]);
        // Neither coordinate alone is the distance from the axis; together, and along the plane's normal, both are
        // lower bounds of it.
        let [x, y] = [0, 1].map(|axis| least_magnitude(node.extent(rows[axis], origin[axis])));
        // The distance toward the axis along the plane's normal.
        let [u, v] = [0, 1].map(|axis| dot(rows[axis], node.plane.normal));
        let length = (u * u + v * v).sqrt();
        let inward = if length > 0.0 {
            let direction = [0, 1, 2].map(|k| (u * rows[0][k] + v * rows[1][k]) / length);
            least_magnitude(node.extent(direction, (u * origin[0] + v * origin[1]) / length))
        } else {
            0.0
        };
        Some(NodeRing { near: (x * x + y * y).sqrt().max(inward), low, high })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_of_planes_have_length_1_however_thin_the_triangles() {
        for exponent in -1080..1 {
            // Squares of such a normal are subnormal or 0 below 2⁻⁵¹¹.
            let thin = 1.3 * 2f64.powi(exponent);
            let triangle = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, thin, -0.7 * thin]];
            let Plane { normal, ends } = Plane::of(&[triangle]);
            let length = dot(normal, normal).sqrt();
            assert!((length - 1.0).abs() < 1e-15, "2^{exponent}: {length}");
            assert!(ends[1] - ends[0] < 1e-15 + thin, "2^{exponent}: {ends:?}");
        }
    }

    /// Enters the boxes that contain a point.
    struct About {
        origin: Point3<f64>,
        place: Point3<f64>,
        found: usize,
        visited: usize,
    }

    impl BoxVisitor for About {
        fn enters(&mut self, centre: Vector3<f64>, half: Vector3<f64>) -> bool {
            let off = self.place - self.origin - centre;
            (0..3).all(|k| off[k].abs() <= half[k] * (1.0 + 1e-5) + 1e-9)
        }

        fn triangle(&mut self, corners: [Point3<f64>; 3]) {
            self.visited += 1;
            self.found += usize::from(corners.contains(&self.place));
        }
    }

    #[test]
    fn a_corner_is_found_in_the_boxes_that_contain_it() {
        let mesh = crate::mesh::shapes::sphere(30.0, 3, Unit::Millimetre).expect("a sphere");
        let bvh = TriangleBvh::new(&mesh);
        for place in mesh.vertices() {
            let mut about = About { origin: bvh.origin(), place: *place, found: 0, visited: 0 };
            bvh.visit(&mut about);
            // Five or six triangles meet in a corner of a divided icosahedron.
            let is_found = (5..=6).contains(&about.found) && 2 * about.visited < bvh.len();
            assert!(is_found, "{place}");
        }
    }
}
