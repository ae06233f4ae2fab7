//! Collision checks of a posture by brute force: all triangles are subdivided until every piece is decided.
//!
//! The distance to a surface is 1-Lipschitz. A condition that holds at a triangle's centroid with a margin of at least
//! the triangle's radius holds on the whole triangle. An undecided triangle is bisected. No piece is skipped for any
//! other reason.

use super::stand::{Posture, Stand};
use nalgebra::{Point3, Vector3};
use std::collections::HashMap;
use touchoff::{Mesh, TriangleId};
use touchoff_tests::oracle::draw::Rng;

/// The verdict on a posture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// The posture is free of collision.
    Free,
    /// The excess of a point's depth over the allowed depth, in the part's unit. It is infinite if the tool is inside
    /// the part.
    Blocked(f64),
    /// Undecided: pieces as small as rounding are left, or there were too many pieces.
    Open,
}

/// A part's triangles.
pub struct Part<'a> {
    mesh: &'a Mesh,
    /// Bounding ball of each triangle: centroid and radius.
    balls: Vec<(Point3<f64>, f64)>,
    /// True if each edge is used equally often in both directions.
    closed: bool,
    /// The sum of the part's size and its distance from the origin, in its unit.
    pub size: f64,
}

/// Maximum number of pieces examined.
const MOST: usize = 1_000_000;

fn ball(corners: &[Vector3<f64>; 3]) -> (Vector3<f64>, f64) {
    let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    let reach = corners.iter().map(|corner| (corner - middle).norm()).fold(0.0, f64::max);
    (middle, reach * (1.0 + 1e-12))
}

impl<'a> Part<'a> {
    /// Prepares the triangles of a mesh.
    pub fn new(mesh: &'a Mesh) -> Part<'a> {
        let ids = 0..mesh.triangles().len() as u32;
        let balls = ids.map(|id| {
            let (middle, reach) = ball(&mesh.triangle(TriangleId(id)).map(|corner| corner.coords));
            (Point3::from(middle), reach)
        });
        let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
        for corners in mesh.triangles() {
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
            }
        }
        let [low, high] = mesh.bounds();
        Part {
            mesh,
            balls: balls.collect(),
            closed: edges.values().all(|count| *count == 0),
            size: (high - low).norm() + low.coords.amax().max(high.coords.amax()),
        }
    }

    /// Validates a posture. Cutting surfaces may be in the part up to the depth `tolerance + more`, the other surfaces
    /// up to `more`, in the part's unit. If `more` is negative, the other surfaces must keep that distance.
    pub fn judge(&self, stand: &Stand, posture: &Posture, tolerance: f64, more: f64) -> Verdict {
        let length = stand.length;
        let asked = Asked { stand, cuts: tolerance + more, rest: more };
        let mut open = Vec::new();
        let [radius, height] = stand.extent();
        let keep = (-more).max(0.0);
        for (id, (middle, reach)) in self.balls.iter().enumerate() {
            let off = middle - posture.tip;
            let z = off.dot(&posture.axis);
            let near = radius + reach + keep;
            if z + reach + keep < 0.0
                || z - reach - keep > height
                || off.norm_squared() - z * z > near * near * (1.0 + 1e-9)
            {
                continue;
            }
            let corners =
                self.mesh.triangle(TriangleId(id as u32)).map(|corner| corner - posture.tip);
            open.extend(asked.piece(&posture.axis, corners));
        }
        open.sort_by(|a, b| a.bound.total_cmp(&b.bound));
        let (least, mut looked) = (1e-10 * (self.size + radius + height), 0);
        let mut left = false;
        while let Some(piece) = open.pop() {
            looked += 1;
            if piece.over > 0.0 {
                return Verdict::Blocked(piece.over);
            }
            if looked > MOST {
                return Verdict::Open;
            }
            if piece.reach < least {
                left = true;
                continue;
            }
            let [a, b, c] = piece.corners;
            let sides = [(b - a).norm(), (c - b).norm(), (a - c).norm()];
            let longest = (0..3).max_by(|k, l| sides[*k].total_cmp(&sides[*l])).unwrap_or(0);
            let [a, b, c] = [0, 1, 2].map(|k| piece.corners[(longest + k) % 3]);
            let middle = 0.5 * (a + b);
            for half in [[a, middle, c], [middle, b, c]] {
                open.extend(asked.piece(&posture.axis, half));
            }
        }
        if left {
            return Verdict::Open;
        }
        // No triangle intersects the forbidden part of the tool, so that part is inside or outside as a whole.
        let inside = stand
            .cores
            .iter()
            .any(|z| self.closed && self.contains(posture.tip + length * *z * posture.axis));
        if inside { Verdict::Blocked(f64::INFINITY) } else { Verdict::Free }
    }

    /// Returns whether a point is inside a closed part, by counting the signed crossings of a random ray.
    fn contains(&self, place: Point3<f64>) -> bool {
        let mut draw = Rng::new(9);
        for _ in 0..16 {
            if let Some(turns) = self.turns(place, Vector3::from(draw.direction())) {
                return turns > 0;
            }
        }
        false
    }

    /// Returns the signed number of crossings of a ray. Returns `None` if the ray is too near to an edge.
    fn turns(&self, place: Point3<f64>, way: Vector3<f64>) -> Option<i32> {
        let mut turns = 0;
        for (id, (middle, reach)) in self.balls.iter().enumerate() {
            let off = middle - place;
            let along = off.dot(&way);
            if along < -reach || off.norm_squared() - along * along > 1.1 * reach * reach {
                continue;
            }
            // Intersection of Möller and Trumbore 1997.
            let [a, b, c] = self.mesh.triangle(TriangleId(id as u32));
            let (u, v, from) = (b - a, c - a, place - a);
            let p = way.cross(&v);
            let det = u.dot(&p);
            let scale = u.norm() * v.norm();
            let q = from.cross(&u);
            let (s, t, far) = (from.dot(&p) / det, way.dot(&q) / det, v.dot(&q) / det);
            if det.abs() < 1e-9 * scale {
                return None;
            }
            let inner = s.min(t).min(1.0 - s - t);
            if inner.abs() < 1e-7 {
                return None;
            }
            if inner > 0.0 && far > 0.0 {
                turns += if det > 0.0 { -1 } else { 1 };
            }
        }
        Some(turns)
    }
}

/// A piece of a triangle that may collide.
struct Piece {
    corners: [Vector3<f64>; 3],
    reach: f64,
    /// Excess of the depth at the centroid over the allowed depth.
    over: f64,
    /// Upper bound of that excess on the piece.
    bound: f64,
}

/// The allowed depths of cutting surfaces and of the other surfaces.
struct Asked<'a> {
    stand: &'a Stand,
    cuts: f64,
    rest: f64,
}

impl Asked<'_> {
    /// Evaluates a piece given by its corners relative to the tip. Returns `None` if no point of it collides.
    fn piece(&self, axis: &Vector3<f64>, corners: [Vector3<f64>; 3]) -> Option<Piece> {
        let (middle, reach) = ball(&corners);
        let z = middle.dot(axis);
        let at = [(middle - z * axis).norm(), 0.0, z].map(|part| part / self.stand.length);
        let [depth, cuts, rest] = self.stand.evaluation(at);
        let most = depth + reach;
        // The other surfaces are not the nearest to any point of the piece inside the tool, or no point is inside.
        let apart = most < 0.0 || rest - reach > most;
        let bound_cuts = if most > 0.0 { most - self.cuts } else { f64::NEG_INFINITY };
        let bound_rest = if apart { reach - rest } else { most } - self.rest;
        let bound = bound_cuts.max(bound_rest);
        if bound <= 0.0 {
            return None;
        }
        let inside = depth > 0.0;
        let over_cuts = if inside && cuts <= rest { depth - self.cuts } else { f64::NEG_INFINITY };
        let over_rest = if inside && rest <= cuts { depth } else { -rest } - self.rest;
        Some(Piece { corners, reach, over: over_cuts.max(over_rest), bound })
    }
}
