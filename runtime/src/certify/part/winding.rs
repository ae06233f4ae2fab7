//! Location of points: the winding number of a part's surface about a point, from the triangles that a ray crosses.

use super::TriangleBvh;
use crate::bvh::WIDTH;
use nalgebra::{Point3, Vector3};
use robust::{Coord3D, orient3d};

/// The location of a point relative to a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Location {
    /// In the material.
    Inside,
    /// Outside it.
    Outside,
    /// The part has no inside: its mesh is not closed, not consistently oriented, or inside out.
    Unknown,
    /// The point is on the surface, all rays tried meet an edge, or the winding number is negative.
    Undecided,
}

/// The maximum number of rays. One is nearly always enough: the predicates are exact, so a ray is rejected only
/// if it meets an edge exactly.
const RAYS: u32 = 32;

/// The length of a ray in sizes of the part, so that it ends outside.
const RAY_LENGTH_FACTOR: f64 = 8.0;

/// Returns the direction of a ray. The directions lie on a spiral, so that all differ and none is along an axis.
fn direction(ray: u32) -> Vector3<f64> {
    /// The golden angle, in radians.
    const TURN: f64 = 2.399_963_229_728_653;
    let z = 1.0 - (2.0 * f64::from(ray) + 1.0) / f64::from(RAYS);
    let (sin, cos) = (0.5 + TURN * f64::from(ray)).sin_cos();
    let d = (1.0 - z * z).sqrt();
    Vector3::new(d * cos, d * sin, z)
}

/// The relation of a ray to a triangle.
enum Crossing {
    Misses,
    /// It crosses the triangle: 1 through the outer side, -1 through the inner side.
    Through(i32),
    /// It meets an edge or a corner, or lies in the plane.
    Edge,
    /// It begins on the triangle.
    Begins,
}

impl TriangleBvh {
    /// Locates a point, given in the part's frame and unit.
    ///
    /// The result is exact for the doubles of the point and of the triangles' corners, unless products of four
    /// lengths overflow or underflow.
    pub fn locate(&self, point: Point3<f64>) -> Location {
        if !self.solid {
            return Location::Unknown;
        }
        let p = self.frame.inside([point.x, point.y, point.z]);
        let size = f64::from(self.frame.size);
        // Outside the part's bounding box no ray is needed.
        if p.iter().any(|part| part.abs() > size) {
            return Location::Outside;
        }
        for ray in 0..RAYS {
            match self.winding(point, direction(ray), None) {
                Ok(winding) if winding > 0 => return Location::Inside,
                Ok(0) => return Location::Outside,
                // Overlap of material and its opposite: an inside-out lobe of a surface that crosses itself.
                Ok(_) | Err(Crossing::Begins) => return Location::Undecided,
                Err(_) => {}
            }
        }
        Location::Undecided
    }

    /// Returns the winding number just outside a triangle, if a ray decides it.
    ///
    /// The ray begins on the triangle. It counts all others, and this one if it leaves toward the inner side. No offset
    /// from the triangle has to be chosen, and another surface may be arbitrarily near. A triangle in the same plane is
    /// crossed where this one is.
    pub(super) fn winding_beside(&self, own: usize) -> Option<i32> {
        let corners = self.corners[own];
        (0..RAYS).find_map(|ray| {
            // Other points of the triangle for other rays: some may lie on a triangle that crosses it.
            let weights = [1.0 + f64::from(ray % 3), 1.0 + f64::from(ray / 3), 1.0];
            let total: f64 = weights.iter().sum();
            let point = Point3::from([0, 1, 2].map(|k| {
                corners.iter().zip(weights).map(|(corner, weight)| corner[k] * weight).sum::<f64>()
                    / total
            }));
            let ray_direction = direction(ray);
            let ([a, b, c], end) =
                (corners.map(coord), coord(self.end(point, ray_direction).into()));
            // Rounded, the point is not exactly in the plane. The side of the ray's end decides, not that of its
            // beginning.
            let toward_inner = match orient3d(a, b, c, end) {
                inner if inner > 0.0 => true,
                outer if outer < 0.0 => false,
                _ => return None,
            };
            let beside = Beside { own, corners, toward_inner };
            let others = self.winding(point, ray_direction, Some(&beside)).ok()?;
            Some(others - i32::from(toward_inner))
        })
    }

    /// Returns the end point of a ray.
    fn end(&self, point: Point3<f64>, ray_direction: Vector3<f64>) -> Point3<f64> {
        point + ray_direction * (RAY_LENGTH_FACTOR * f64::from(self.frame.size) * self.frame.scale)
    }

    /// Returns the margin by which boxes are widened for a ray from a point, in the tree's unit.
    ///
    /// Let `u` be the unit roundoff. In the tree's unit no point of the part is farther than 1 from its origin, and
    /// the ray reaches no farther than 9. The conversion of a corner, and of the point, errs by 2u. The end of the
    /// ray is rounded by u of its world coordinates and by 18u of its length, and no point of the ray deviates more
    /// from its direction. The ends of the box relative to the point, at most 3, and their quotients by the direction
    /// have three roundings. The total is less than `32u` plus `2u` of the point's coordinates.
    fn margin(&self, point: Point3<f64>) -> f64 {
        f64::EPSILON * (16.0 + point.coords.amax() / self.frame.scale)
    }

    /// Returns the winding number of the surface about a point, counted along a ray. For a point beside a triangle that one
    /// is left out.
    ///
    /// # Errors
    /// The crossing that does not decide it.
    fn winding(
        &self,
        point: Point3<f64>,
        ray_direction: Vector3<f64>,
        beside: Option<&Beside>,
    ) -> Result<i32, Crossing> {
        let p = self.frame.inside([point.x, point.y, point.z]);
        let (end, margin) = (self.end(point, ray_direction), self.margin(point));
        let mut winding = 0;
        let mut stack = vec![(0, 0)];
        while let Some((level, index)) = stack.pop() {
            for lane in 0..self.children(level, index) {
                let child = index * WIDTH + lane;
                if let Some(level_boxes) = self.levels.get(level) {
                    let boxes = &level_boxes[index];
                    // The ray meets the box if it is between all three pairs of sides at once.
                    let [[a, b], [c, d], [e, f]] = [0, 1, 2].map(|axis| {
                        let from = f64::from(boxes.centre[axis][lane]) - p[axis];
                        let half = f64::from(boxes.half[axis][lane]) + margin;
                        let [a, b] = [
                            (from - half) / ray_direction[axis],
                            (from + half) / ray_direction[axis],
                        ];
                        [a.min(b), a.max(b)]
                    });
                    if a.max(c).max(e).max(0.0) <= b.min(d).min(f) {
                        stack.push((level + 1, child));
                    }
                } else if beside.is_none_or(|beside| beside.own != child) {
                    let corners = self.corners[child];
                    let crossing = match beside {
                        Some(beside) if beside.is_coplanar(&corners) => {
                            beside.crossing(corners, point, end)
                        }
                        _ => crossing(corners, point, end),
                    };
                    match crossing {
                        Crossing::Misses => {}
                        Crossing::Through(side) => winding += side,
                        other => return Err(other),
                    }
                }
            }
        }
        Ok(winding)
    }
}

/// A triangle beside which a ray begins, on its outer side.
struct Beside {
    own: usize,
    corners: [[f64; 3]; 3],
    /// True if the ray crosses the triangle, because it leads to its inner side.
    toward_inner: bool,
}

impl Beside {
    /// Returns whether a triangle lies in the same plane.
    fn is_coplanar(&self, corners: &[[f64; 3]; 3]) -> bool {
        let [a, b, c] = self.corners.map(coord);
        corners.iter().all(|corner| orient3d(a, b, c, coord(*corner)) == 0.0)
    }

    /// Returns the relation of the ray to a triangle in the same plane.
    fn crossing(&self, corners: [[f64; 3]; 3], from: Point3<f64>, to: Point3<f64>) -> Crossing {
        match sides(corners, from, to) {
            sides if are_mixed(sides) => Crossing::Misses,
            // The ray does not reach the plane.
            _ if !self.toward_inner => Crossing::Misses,
            sides if sides.iter().any(|side| *side == 0.0 || side.is_nan()) => Crossing::Edge,
            _ => {
                let [own, other] = [self.corners, corners].map(|corners| {
                    let [a, b, c] = corners.map(Vector3::from);
                    (b - a).cross(&(c - a))
                });
                Crossing::Through(if own.dot(&other) > 0.0 { -1 } else { 1 })
            }
        }
    }
}

/// Returns the sides of a triangle's edges on which a line passes: the same for all three if it crosses.
fn sides(corners: [[f64; 3]; 3], from: Point3<f64>, to: Point3<f64>) -> [f64; 3] {
    let ([a, b, c], [p, q]) = (corners.map(coord), [from, to].map(|point| coord(point.into())));
    [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)]
}

fn are_mixed(sides: [f64; 3]) -> bool {
    sides.iter().any(|side| *side > 0.0) && sides.iter().any(|side| *side < 0.0)
}

fn coord([x, y, z]: [f64; 3]) -> Coord3D<f64> {
    Coord3D { x, y, z }
}

/// Returns the relation of a line segment to a triangle.
fn crossing(corners: [[f64; 3]; 3], from: Point3<f64>, to: Point3<f64>) -> Crossing {
    let ([a, b, c], [p, q]) = (corners.map(coord), [from, to].map(|point| coord(point.into())));
    let sides = sides(corners, from, to);
    if are_mixed(sides) {
        return Crossing::Misses;
    }
    // Positive on the inner side of the triangle's plane.
    let [begins, ends] = [orient3d(a, b, c, p), orient3d(a, b, c, q)];
    if begins > 0.0 && ends > 0.0 || begins < 0.0 && ends < 0.0 {
        return Crossing::Misses;
    }
    if sides.iter().any(|side| *side == 0.0 || side.is_nan()) {
        return Crossing::Edge;
    }
    match (begins > 0.0, begins < 0.0) {
        (true, _) => Crossing::Through(1),
        (_, true) => Crossing::Through(-1),
        _ => Crossing::Begins,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Mesh, shapes};
    use crate::unit::Unit;

    /// Points in the planes of a block's faces, on lines through its corners and edges, and on its surface.
    #[test]
    fn no_ray_is_lost_to_an_edge() {
        let (low, high) = (Point3::new(-1.0, -1.0, -1.0), Point3::new(1.0, 1.0, 1.0));
        let block =
            TriangleBvh::new(&shapes::cuboid(low, high, Unit::Millimetre).expect("a block"));
        let steps = [-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0];
        for x in steps {
            for y in steps {
                for z in steps {
                    let far = [x, y, z].into_iter().map(f64::abs).fold(0.0, f64::max);
                    let found = block.locate(Point3::new(x, y, z));
                    let expected = match far {
                        0.0..1.0 => Location::Inside,
                        1.0 => Location::Undecided,
                        _ => Location::Outside,
                    };
                    assert_eq!(found, expected, "{x} {y} {z}");
                }
            }
        }
    }

    /// Returns pieces as one mesh, each as it is or turned over.
    fn joined(pieces: &[(crate::Mesh, bool)]) -> crate::Mesh {
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for (mesh, turned) in pieces {
            let first = vertices.len() as u32;
            vertices.extend_from_slice(mesh.vertices());
            triangles.extend(mesh.triangles().iter().map(|corners| {
                let [a, b, c] = corners.map(|k| k + first);
                if *turned { [b, a, c] } else { [a, b, c] }
            }));
        }
        crate::Mesh::new(vertices, triangles, Unit::Millimetre).expect("a mesh")
    }

    /// Returns a mesh in which vertices at the same place are one, as in files.
    fn welded(mesh: &crate::Mesh) -> crate::Mesh {
        let first = |k: &u32| {
            let place = mesh.vertices()[*k as usize];
            mesh.vertices().iter().position(|other| *other == place).unwrap_or_default() as u32
        };
        let triangles = mesh.triangles().iter().map(|corners| corners.each_ref().map(first));
        crate::Mesh::new(mesh.vertices().to_vec(), triangles, Unit::Millimetre).expect("a mesh")
    }

    /// A piece that is inside out, next to a good one or sticking out of it, leaves no inside. A void leaves one.
    #[test]
    fn a_piece_inside_out_leaves_no_inside() {
        let block = |low: f64, high: f64, at: f64| {
            let [low, high] = [low, high].map(|z| Point3::new(z + at, z, z));
            shapes::cuboid(low, high, Unit::Millimetre).expect("a block")
        };
        let with = |small, turned| joined(&[(block(-10.0, 10.0, 0.0), false), (small, turned)]);
        let has_inside = |small, turned| TriangleBvh::new(&with(small, turned)).has_inside();
        assert!(has_inside(block(-2.0, 2.0, 30.0), false));
        assert!(has_inside(block(-2.0, 2.0, 0.0), true));
        assert!(!has_inside(block(-2.0, 2.0, 30.0), true));
        assert!(!has_inside(block(-2.0, 2.0, 10.0), true));
        // A plate with a thickness of 10^-10 of the whole.
        let plate = |at: f64| {
            let [low, high] = [(-2.0, 0.0), (2.0, 4e-9)].map(|(x, z)| Point3::new(x + at, x, z));
            shapes::cuboid(low, high, Unit::Millimetre).expect("a plate")
        };
        assert!(!has_inside(plate(30.0), true));
        assert!(has_inside(plate(0.0), true));
        // Next to it in one vertex, which they share.
        let [low, high] = [10.0, 14.0].map(|c| Point3::new(c, c, c));
        let mesh = with(shapes::cuboid(low, high, Unit::Millimetre).expect("a block"), true);
        assert!(!TriangleBvh::new(&welded(&mesh)).has_inside());
    }

    /// A block that is inside out and sticks out of another, where good blocks touch it with whole faces: every ray from the
    /// middle of one of its triangles begins on another triangle. And a body whose triangles are all stored in both
    /// directions, beside a good one, and two good blocks that touch with a whole face.
    #[test]
    fn faces_that_coincide_hide_nothing() {
        let block = |low: [f64; 3], high: [f64; 3]| {
            shapes::cuboid(low.into(), high.into(), Unit::Millimetre).expect("a block")
        };
        let has_inside = |pieces: &[(crate::Mesh, bool)]| {
            TriangleBvh::new(&welded(&joined(pieces))).has_inside()
        };
        let large = || (block([-10.0; 3], [10.0; 3]), false);
        let stick = || (block([-2.0, -2.0, 5.0], [2.0, 2.0, 14.0]), true);
        // On its five faces outside the large block.
        let around = [
            ([-2.0, -2.0, 14.0], [2.0, 2.0, 16.0]),
            ([2.0, -2.0, 10.0], [4.0, 2.0, 14.0]),
            ([-4.0, -2.0, 10.0], [-2.0, 2.0, 14.0]),
            ([-2.0, 2.0, 10.0], [2.0, 4.0, 14.0]),
            ([-2.0, -4.0, 10.0], [2.0, -2.0, 14.0]),
        ]
        .map(|(low, high)| (block(low, high), false));
        let pieces: Vec<_> = [large(), stick()].into_iter().chain(around.clone()).collect();
        assert!(!has_inside(&pieces));
        let touching: Vec<_> = [large()].into_iter().chain(around).collect();
        assert!(has_inside(&touching));
        let other = || block([20.0, -10.0, -10.0], [40.0, 10.0, 10.0]);
        assert!(!has_inside(&[large(), (other(), false), (other(), true)]));
        let beside = || block([10.0, -10.0, -10.0], [40.0, 10.0, 10.0]);
        assert!(has_inside(&[large(), (beside(), false)]));
    }

    /// A prism over a bow tie: material in one lobe, its opposite in the other.
    #[test]
    fn what_a_surface_goes_around_the_wrong_way_is_undecided() {
        let tie = [[0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 3.0]];
        let vertices = [0.0, 2.0].map(|z| tie.map(|[x, y]| Point3::new(x, y, z))).concat();
        let caps = [[1, 0, 2], [2, 0, 3], [4, 5, 6], [4, 6, 7]];
        let walls = (0..4u32).flat_map(|k| {
            let next = (k + 1) % 4;
            [[k, next, next + 4], [k, next + 4, k + 4]]
        });
        let triangles: Vec<[u32; 3]> = caps.into_iter().chain(walls).collect();
        let turned = triangles.iter().map(|[a, b, c]| [*b, *a, *c]).collect();
        for triangles in [triangles, turned] {
            let mesh = crate::Mesh::new(vertices.clone(), triangles, Unit::Millimetre);
            let bvh = TriangleBvh::new(&mesh.expect("a mesh"));
            let mut found = [[0.5, 1.5, 1.0], [3.5, 1.5, 1.0]].map(|at| bvh.locate(at.into()));
            if bvh.has_inside() {
                found.sort_by_key(|location| *location != Location::Inside);
                assert_eq!(found, [Location::Inside, Location::Undecided]);
            } else {
                assert_eq!(found, [Location::Unknown; 2]);
            }
        }
    }

    /// A point an ulp off a face is still decided.
    #[test]
    fn an_ulp_beside_the_surface_is_decided() {
        let (low, high) = (Point3::new(-1.0, -1.0, -1.0), Point3::new(1.0, 1.0, 1.0));
        let block =
            TriangleBvh::new(&shapes::cuboid(low, high, Unit::Millimetre).expect("a block"));
        let at = |x: f64| block.locate(Point3::new(x, 0.25, 0.125));
        assert_eq!(at(1.0f64.next_down()), Location::Inside);
        assert_eq!(at(1.0), Location::Undecided);
        assert_eq!(at(1.0f64.next_up()), Location::Outside);
    }

    #[test]
    fn a_ray_from_the_end_of_the_other_counts_the_same() {
        let (low, high) = (Point3::new(-1.0, -1.0, -1.0), Point3::new(1.0, 1.0, 1.0));
        let block =
            TriangleBvh::new(&shapes::cuboid(low, high, Unit::Millimetre).expect("a block"));
        let inside = Point3::new(0.3, -0.7, 0.9);
        let turns: Vec<i32> =
            (0..RAYS).filter_map(|ray| block.winding(inside, direction(ray), None).ok()).collect();
        assert!(turns.len() > 28 && turns.iter().all(|winding| *winding == 1), "{turns:?}");
    }

    /// Returns a cube from -1 to 1 whose faces are divided into eight by eight squares. All coordinates are dyadic, so
    /// that boxes end exactly where triangles do.
    fn divided_cube() -> TriangleBvh {
        const STEPS: u32 = 8;
        let at = |k: u32| f64::from(k) / 4.0 - 1.0;
        let mut vertices = Vec::new();
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                for (i, k) in (0..STEPS).flat_map(|i| (0..STEPS).map(move |k| (i, k))) {
                    let corners = [[i, k], [i + 1, k], [i + 1, k + 1], [i, k + 1]].map(|[i, k]| {
                        let mut corner = Point3::origin();
                        corner[axis] = side;
                        corner[(axis + 1) % 3] = at(i);
                        corner[(axis + 2) % 3] = at(k);
                        corner
                    });
                    let [a, b, c, d] = corners;
                    let halves = if side > 0.0 { [a, b, c, a, c, d] } else { [a, c, b, a, d, c] };
                    vertices.extend(halves);
                }
            }
        }
        // Each vertex once, so that the surface is closed.
        let first = |k: u32| {
            let place = vertices[k as usize];
            vertices.iter().position(|other| *other == place).unwrap_or_default() as u32
        };
        let triangles: Vec<[u32; 3]> = (0..vertices.len() as u32 / 3)
            .map(|k| [first(3 * k), first(3 * k + 1), first(3 * k + 2)])
            .collect();
        let mesh = crate::Mesh::new(vertices, triangles, Unit::Millimetre).expect("a cube");
        TriangleBvh::new(&mesh)
    }

    /// Rays from points inside that leave the cube within rounding of a line between its squares, where the boxes of the
    /// leaves end: of the triangles on both sides one is crossed, unless the ray meets the line exactly.
    #[test]
    fn a_ray_beside_the_border_of_two_boxes_crosses_one_triangle() {
        let cube = divided_cube();
        assert!(cube.has_inside());
        let mut crossed = 0;
        for ray in 0..RAYS {
            let toward = direction(ray);
            for axis in 0..3 {
                let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
                for (line, step) in (1..8).flat_map(|line| (0..8).map(move |step| (line, step))) {
                    let mut exit = Point3::origin();
                    exit[axis] = toward[axis].signum();
                    exit[u] = f64::from(line) / 4.0 - 1.0;
                    exit[v] = 0.23 * f64::from(step) - 0.81;
                    for back in [0.1, 0.3, 0.6] {
                        let from = exit - back * toward;
                        if from.coords.amax() >= 1.0 {
                            continue;
                        }
                        match cube.winding(from, toward, None) {
                            Ok(winding) => {
                                assert_eq!(winding, 1, "ray {ray} from {from}");
                                crossed += 1;
                            }
                            Err(other) => assert!(matches!(other, Crossing::Edge)),
                        }
                    }
                }
            }
        }
        assert!(crossed > 10_000, "{crossed}");
    }

    /// A corner of a void lies exactly on the first ray: the three triangles there are no crossings, and another ray
    /// decides.
    #[test]
    fn a_ray_through_a_corner_decides_nothing() {
        let cube = shapes::cuboid(
            Point3::new(-64.0, -64.0, -64.0),
            Point3::new(64.0, 64.0, 64.0),
            Unit::Millimetre,
        )
        .expect("a cube");
        let centre = Point3::origin();
        let end = TriangleBvh::new(&cube).end(centre, direction(0));
        // Divided by a power of two, so that the corner is on the ray to the last bit.
        let corner = Point3::from(end.coords / 64.0);
        let base = [[1.0, 0.0, -8.0], [-9.0, 8.0, -7.0], [-9.0, -8.0, -7.0]].map(Point3::from);
        let first = cube.vertices().len() as u32;
        let vertices = [cube.vertices(), &[corner], &base].concat();
        // Its faces are turned inward, toward the origin.
        let void = [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]]
            .map(|triangle| triangle.map(|k: u32| k + first));
        let triangles = cube.triangles().iter().copied().chain(void);
        let mesh = crate::Mesh::new(vertices, triangles, Unit::Millimetre).expect("a mesh");
        let bvh = TriangleBvh::new(&mesh);
        assert!(bvh.has_inside());
        assert_eq!(bvh.end(centre, direction(0)), end);
        assert!(matches!(bvh.winding(centre, direction(0), None), Err(Crossing::Edge)));
        assert_eq!(bvh.locate(centre), Location::Outside);
    }

    /// A block that is inside out is hidden in a good one up to one of its faces. Only beside that face is the winding
    /// number negative.
    #[test]
    fn a_piece_inside_out_that_barely_sticks_out_leaves_no_inside() {
        let large = shapes::cuboid(
            Point3::new(-10.0, -10.0, -10.0),
            Point3::new(10.0, 10.0, 10.0),
            Unit::Millimetre,
        )
        .expect("a block");
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                for (reach, is_hidden) in [(9.999, true), (10.001, false)] {
                    let [mut low, mut high] = [[-2.0; 3], [2.0; 3]].map(Point3::from);
                    if side < 0.0 {
                        low[axis] = -reach;
                    } else {
                        high[axis] = reach;
                    }
                    let small = shapes::cuboid(low, high, Unit::Millimetre).expect("a block");
                    let mesh = joined(&[(large.clone(), false), (small, true)]);
                    let bvh = TriangleBvh::new(&mesh);
                    assert_eq!(bvh.has_inside(), is_hidden, "axis {axis}, side {side}");
                }
            }
        }
    }

    /// The first ray begins on a wall through the middle of a void's face. Others begin elsewhere on that face, not beside it.
    #[test]
    fn a_void_that_a_wall_crosses_is_a_void() {
        let block = |low: [f64; 3], high: [f64; 3]| {
            shapes::cuboid(low.into(), high.into(), Unit::Millimetre).expect("a block")
        };
        let corners = [[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [2.0, 2.0, -3.0]];
        let faces = [[0, 2, 1], [0, 3, 2], [2, 3, 1], [1, 3, 0]];
        let void = Mesh::new(corners.map(Point3::from), faces, Unit::Millimetre).expect("a mesh");
        let pieces = [
            (block([-20.0; 3], [20.0; 3]), false),
            (void, false),
            (block([3.0, 1.0, -1.0], [4.0, 4.0, 1.0]), false),
            (block([8.0, 8.0, -1.0], [10.0, 10.0, 1.0]), true),
        ];
        assert!(TriangleBvh::new(&joined(&pieces)).has_inside());
    }
}
