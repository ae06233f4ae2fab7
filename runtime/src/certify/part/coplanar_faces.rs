//! Flat faces of many triangles, so that a depth common to all of them is bounded once.
//!
//! A tool in a bore, or flat on a plate, is equally deep in many triangles, and no bounding box of them is tight enough
//! to show it. The rectangle around a flat face is: a bound for the rectangle holds for all triangles of the face.

use crate::bvh::WIDTH;
use crate::certify::space::{Point, cross, dot, minus, norm};
use crate::mesh::NO_TRIANGLE;
use std::slice;

/// The smallest number of triangles of a face.
const MIN_FACE_TRIANGLES: usize = 8;

/// The largest number of faces over a node's triangles for which the faces are used to rule it out.
const MAX_NODE_FACES: usize = 256;

/// The index that stands for no face.
const NO_FACE: u32 = u32::MAX;

/// The flat faces of a part. Triangles are given by their indices in the tree's order.
#[derive(Clone, Debug)]
pub(crate) struct CoplanarFaces {
    pub(crate) faces: Vec<Face>,
    /// The face of each triangle.
    of: Vec<u32>,
    /// The faces of the nodes of each level. The last are the leaves.
    levels: Vec<NodeFaces>,
}

/// The faces that contain all triangles of each node of a level; none if a triangle is in no face, or the faces are many.
#[derive(Clone, Debug, Default)]
struct NodeFaces {
    faces: Vec<u32>,
    /// The end of each node's faces in the list.
    ends: Vec<u32>,
}

impl NodeFaces {
    /// Creates the lists of nodes that each have up to 16 of these children, given by their faces.
    fn above<'a>(children: impl Iterator<Item = &'a [u32]>) -> NodeFaces {
        let children: Vec<&[u32]> = children.collect();
        let mut nodes = NodeFaces::default();
        let mut distinct = Vec::new();
        for node in children.chunks(WIDTH) {
            distinct.clear();
            distinct.extend(node.iter().copied().flatten());
            distinct.sort_unstable();
            distinct.dedup();
            let is_covered = node.iter().all(|child| !child.is_empty());
            if is_covered && distinct.len() <= MAX_NODE_FACES {
                nodes.faces.append(&mut distinct);
            }
            nodes.ends.push(nodes.faces.len() as u32);
        }
        nodes
    }

    fn len(&self) -> usize {
        self.ends.len()
    }

    fn of(&self, node: usize) -> &[u32] {
        let start = if node == 0 { 0 } else { self.ends[node - 1] };
        &self.faces[start as usize..self.ends[node] as usize]
    }
}

/// The rectangle around a flat face, in the part's frame and unit.
#[derive(Clone, Debug)]
pub(crate) struct Face {
    /// A corner of one of its triangles.
    pub(crate) from: Point,
    /// The corners of the rectangle relative to that.
    pub(crate) corners: [Point; 4],
}

/// The plane of a face: the points no farther than `flat` from the plane through a point.
struct FacePlane {
    point: Point,
    normal: Point,
    flat: f64,
}

impl FacePlane {
    /// Returns whether all corners of a triangle are in the plane.
    fn contains(&self, corners: &[Point; 3]) -> bool {
        corners.iter().all(|p| dot(self.normal, minus(*p, self.point)).abs() <= self.flat)
    }
}

/// Returns the unit vector in a direction, or `None` for a vector of length 0.
fn unit(a: Point) -> Option<Point> {
    let size = norm(a);
    (size > 0.0).then(|| a.map(|part| part / size))
}

impl CoplanarFaces {
    /// Finds the faces of triangles, given by their corners and their [`neighbours`](crate::mesh::neighbours). Points no farther than
    /// `flat` from a triangle's plane count as in it.
    pub(crate) fn new(corners: &[[Point; 3]], neighbours: &[[u32; 3]], flat: f64) -> CoplanarFaces {
        let (mut of, mut faces) = (vec![NO_FACE; corners.len()], Vec::new());
        let mut used = vec![false; corners.len()];
        let mut face = Vec::new();
        for seed in 0..corners.len() {
            let [a, b, c] = corners[seed];
            let Some(normal) = unit(cross(minus(b, a), minus(c, a))).filter(|_| !used[seed]) else {
                continue;
            };
            let plane = FacePlane { point: a, normal, flat };
            // The computed normal of a needle may lean by more than that.
            if !plane.contains(&corners[seed]) {
                continue;
            }
            face.clear();
            face.push(seed as u32);
            used[seed] = true;
            let mut next = 0;
            // Breadth first, across edges of exactly two triangles.
            while next < face.len() {
                for other in neighbours[face[next] as usize] {
                    if other != NO_TRIANGLE
                        && !used[other as usize]
                        && plane.contains(&corners[other as usize])
                    {
                        used[other as usize] = true;
                        face.push(other);
                    }
                }
                next += 1;
            }
            if face.len() < MIN_FACE_TRIANGLES {
                // They may belong to a face that is found from another triangle.
                face[1..].iter().for_each(|k| used[*k as usize] = false);
                continue;
            }
            face.iter().for_each(|k| of[*k as usize] = faces.len() as u32);
            faces.push(Face::around(&face, corners, normal));
        }
        let triangles =
            of.iter().map(|face| if *face == NO_FACE { &[] } else { slice::from_ref(face) });
        let mut levels = vec![NodeFaces::above(triangles)];
        while let Some(below) = levels.last().filter(|below| below.len() > 1) {
            levels.push(NodeFaces::above((0..below.len()).map(|node| below.of(node))));
        }
        levels.reverse();
        CoplanarFaces { faces, of, levels }
    }

    /// Returns the faces that contain all triangles of a node; `None` if some triangle is in no face, or the faces
    /// are many.
    pub(crate) fn of_node(&self, level: usize, index: usize) -> Option<&[u32]> {
        Some(self.levels.get(level)?.of(index)).filter(|faces| !faces.is_empty())
    }

    /// Returns the face of a triangle.
    pub(crate) fn of_triangle(&self, index: u32) -> Option<u32> {
        Some(self.of[index as usize]).filter(|face| *face != NO_FACE)
    }
}

impl Face {
    /// Returns the rectangle of least area among those with a side along an edge of the face's first triangle.
    fn around(face: &[u32], corners: &[[Point; 3]], normal: Point) -> Face {
        let [a, b, c] = corners[face[0] as usize];
        let points = face.iter().flat_map(|k| corners[*k as usize]).map(|p| minus(p, a));
        let edges = [minus(b, a), minus(c, b), minus(a, c)].into_iter();
        let least = edges
            .filter_map(|edge| Rectangle::along(edge, normal, &points))
            .min_by(|p, q| p.area.total_cmp(&q.area))
            .expect("a triangle with a normal has sides");
        Face { from: a, corners: least.corners }
    }
}

/// A rectangle around points of a plane.
struct Rectangle {
    area: f64,
    corners: [Point; 4],
}

impl Rectangle {
    /// Returns the rectangle around points and the origin, all in the plane through the origin with a unit normal, that has
    /// a side along a vector; `None` if the vector has no length in the plane.
    fn along<I: Iterator<Item = Point> + Clone>(
        side: Point,
        normal: Point,
        points: &I,
    ) -> Option<Rectangle> {
        // The side is an edge of a triangle, which may leave the plane by the tolerance.
        let out = dot(side, normal);
        let u = unit([0, 1, 2].map(|k| side[k] - out * normal[k]))?;
        let v = unit(cross(normal, u))?;
        let [[u0, u1], [v0, v1]] = [u, v].map(|direction| {
            let positions = points.clone().map(|p| dot(direction, p));
            positions.fold([0.0f64; 2], |[low, high], at| [low.min(at), high.max(at)])
        });
        let corners = [[u0, v0], [u1, v0], [u1, v1], [u0, v1]]
            .map(|[x, y]| [0, 1, 2].map(|k| x * u[k] + y * v[k]));
        Some(Rectangle { area: (u1 - u0) * (v1 - v0), corners })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A side that leaves the plane within the tolerance does not tilt the rectangle.
    #[test]
    fn a_rectangle_lies_in_its_plane() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]].into_iter();
        let found = Rectangle::along([1.0, 0.0, 1e-9], [0.0, 0.0, 1.0], &points).expect("a side");
        assert!(found.corners.iter().all(|corner| corner[2].abs() < 1e-15), "{:?}", found.corners);
    }
}
