//! Whether something of a part is in a tool's way: all triangles, cut up until nothing is left to ask.
//!
//! The distance to a surface changes by no more than the way. So what holds at a triangle's middle by more than
//! the triangle reaches holds for all of it, and a triangle of which that is not known is cut in two. Nothing
//! is skipped but by that.

use super::stand::{Posture, Stand};
use nalgebra::{Point3, Vector3};
use std::collections::HashMap;
use touchoff::Mesh;
use touchoff_tests::oracle::draw::Draw;

/// What is found of a posture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// Nothing is in the way.
    Free,
    /// A place is by so much deeper than it may be, in the part's unit; infinity where the tool is inside the
    /// part.
    Blocked(f64),
    /// Pieces as small as rounding do not tell, or there were too many.
    Open,
}

/// A part's triangles.
pub struct Part<'a> {
    mesh: &'a Mesh,
    /// The middle of each, and how far it reaches from there.
    balls: Vec<(Point3<f64>, f64)>,
    /// Whether every edge is gone along as often as back.
    closed: bool,
    /// How large it is and how far from the origin, in its unit.
    pub size: f64,
}

/// How many pieces are looked at.
const MOST: usize = 1_000_000;

fn ball(corners: &[Vector3<f64>; 3]) -> (Vector3<f64>, f64) {
    let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    let reach = corners.iter().map(|corner| (corner - middle).norm()).fold(0.0, f64::max);
    (middle, reach * (1.0 + 1e-12))
}

impl<'a> Part<'a> {
    /// The triangles of a mesh.
    pub fn new(mesh: &'a Mesh) -> Part<'a> {
        let ids = 0..mesh.triangles().len() as u32;
        let balls = ids.map(|id| {
            let (middle, reach) = ball(&mesh.triangle(id).map(|corner| corner.coords));
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

    /// Whether a tool may stand so: what cuts no deeper than a tolerance, the rest not in the part at all,
    /// but for `more` of either, in the part's unit; below 0, what does not cut has to keep as far away.
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
            let corners = self.mesh.triangle(id as u32).map(|corner| corner - posture.tip);
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
        // No triangle is where the tool may not be, so that is inside or outside as a whole.
        let inside = stand
            .cores
            .iter()
            .any(|z| self.closed && self.contains(posture.tip + length * *z * posture.axis));
        if inside { Verdict::Blocked(f64::INFINITY) } else { Verdict::Free }
    }

    /// Whether a place is inside a closed part: what a ray crosses, out less in.
    fn contains(&self, place: Point3<f64>) -> bool {
        let mut draw = Draw::new(9);
        for _ in 0..16 {
            if let Some(turns) = self.turns(place, Vector3::from(draw.direction())) {
                return turns > 0;
            }
        }
        false
    }

    /// `None` where the ray comes too near to an edge.
    fn turns(&self, place: Point3<f64>, way: Vector3<f64>) -> Option<i32> {
        let mut turns = 0;
        for (id, (middle, reach)) in self.balls.iter().enumerate() {
            let off = middle - place;
            let along = off.dot(&way);
            if along < -reach || off.norm_squared() - along * along > 1.1 * reach * reach {
                continue;
            }
            // Möller and Trumbore 1997.
            let [a, b, c] = self.mesh.triangle(id as u32);
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

/// A piece of a triangle that may be in the way.
struct Piece {
    corners: [Vector3<f64>; 3],
    reach: f64,
    /// By how much its middle is too deep.
    over: f64,
    /// By how much any place of it may be.
    bound: f64,
}

/// How deep what cuts may be, and the rest.
struct Asked<'a> {
    stand: &'a Stand,
    cuts: f64,
    rest: f64,
}

impl Asked<'_> {
    /// A piece by its corners from the tip; `None` if nothing of it is in the way.
    fn piece(&self, axis: &Vector3<f64>, corners: [Vector3<f64>; 3]) -> Option<Piece> {
        let (middle, reach) = ball(&corners);
        let z = middle.dot(axis);
        let at = [(middle - z * axis).norm(), 0.0, z].map(|part| part / self.stand.length);
        let [depth, cuts, rest] = self.stand.felt(at);
        let most = depth + reach;
        // The rest is the nearest to no place of it that is inside, or there is none.
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
