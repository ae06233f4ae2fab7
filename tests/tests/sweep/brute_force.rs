//! Collision checks of a posture by brute force: all triangles are subdivided until every piece is decided.
//!
//! The distance to a surface is 1-Lipschitz. A condition that holds at a triangle's centroid with a margin of at least
//! the triangle's radius holds on the whole triangle. An undecided triangle is bisected. No piece is skipped for any
//! other reason.

use super::tool_model::{Posture, ToolModel};
use nalgebra::{Point3, Vector3};
use std::collections::HashMap;
use touchoff::{Mesh, TriangleId};
use touchoff_tests::oracle::triangle::{bisected, winding_number};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    /// The posture is free of collision.
    Free,
    /// The excess of a point's depth over the allowed depth, in the part's unit. It is infinite if the tool is inside
    /// the part.
    Blocked(f64),
    /// Undecided: pieces as small as rounding are left, or there were too many pieces.
    Open,
}

pub(super) struct TrianglePart<'a> {
    mesh: &'a Mesh,
    /// Bounding ball of each triangle: centroid and radius.
    balls: Vec<(Point3<f64>, f64)>,
    /// True if each edge is used equally often in both directions.
    closed: bool,
    /// The sum of the part's size and its distance from the origin, in its unit.
    pub(super) size: f64,
}

const MAX_PIECES: usize = 1_000_000;

fn ball(corners: &[Vector3<f64>; 3]) -> (Vector3<f64>, f64) {
    let centroid = (corners[0] + corners[1] + corners[2]) / 3.0;
    let reach = corners.iter().map(|corner| (corner - centroid).norm()).fold(0.0, f64::max);
    (centroid, reach * (1.0 + 1e-12))
}

impl<'a> TrianglePart<'a> {
    pub(super) fn new(mesh: &'a Mesh) -> TrianglePart<'a> {
        let ids = 0..mesh.triangles().len() as u32;
        let balls = ids.map(|id| {
            let (centroid, reach) =
                ball(&mesh.triangle(TriangleId(id)).map(|corner| corner.coords));
            (Point3::from(centroid), reach)
        });
        let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
        for corners in mesh.triangles() {
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
            }
        }
        let [low, high] = mesh.bounds();
        TrianglePart {
            mesh,
            balls: balls.collect(),
            closed: edges.values().all(|count| *count == 0),
            size: (high - low).norm() + low.coords.amax().max(high.coords.amax()),
        }
    }

    /// Validates a posture. Cutting surfaces may be in the part up to the depth `tolerance + allowance`, the other
    /// surfaces up to `allowance`, in the part's unit. If `allowance` is negative, the other surfaces must keep that
    /// distance.
    pub(super) fn check(
        &self,
        tool: &ToolModel,
        posture: &Posture,
        tolerance: f64,
        allowance: f64,
    ) -> Verdict {
        let length = tool.length;
        let limits = Limits { tool, cutting: tolerance + allowance, non_cutting: allowance };
        let mut pending = Vec::new();
        let [radius, height] = tool.extent();
        let min_distance = (-allowance).max(0.0);
        for (id, (centroid, reach)) in self.balls.iter().enumerate() {
            let offset = centroid - posture.tip;
            let z = offset.dot(&posture.axis);
            let reach_limit = radius + reach + min_distance;
            if z + reach + min_distance < 0.0
                || z - reach - min_distance > height
                || offset.norm_squared() - z * z > reach_limit * reach_limit * (1.0 + 1e-9)
            {
                continue;
            }
            let corners =
                self.mesh.triangle(TriangleId(id as u32)).map(|corner| corner - posture.tip);
            pending.extend(limits.piece(&posture.axis, corners));
        }
        pending.sort_by(|a, b| a.bound.total_cmp(&b.bound));
        let (min_reach, mut examined) = (1e-10 * (self.size + radius + height), 0);
        let mut undecided = false;
        while let Some(piece) = pending.pop() {
            examined += 1;
            if piece.excess > 0.0 {
                return Verdict::Blocked(piece.excess);
            }
            if examined > MAX_PIECES {
                return Verdict::Open;
            }
            if piece.reach < min_reach {
                undecided = true;
                continue;
            }
            let length = |a: Vector3<f64>, b: Vector3<f64>| (b - a).norm();
            for piece_half in bisected(piece.corners, length, |a, b| 0.5 * (a + b)) {
                pending.extend(limits.piece(&posture.axis, piece_half));
            }
        }
        if undecided {
            return Verdict::Open;
        }
        // No triangle intersects the forbidden part of the tool, so that part is inside or outside as a whole.
        let inside = tool.core_heights.iter().any(|z| {
            let point = posture.tip + length * *z * posture.axis;
            let ids = (0..self.balls.len() as u32).map(TriangleId);
            let triangles = ids.map(|id| self.mesh.triangle(id).map(Into::into));
            self.closed && winding_number(triangles, point.into()).round() > 0.0
        });
        if inside { Verdict::Blocked(f64::INFINITY) } else { Verdict::Free }
    }
}

/// A piece of a triangle that may collide.
struct Piece {
    corners: [Vector3<f64>; 3],
    reach: f64,
    /// Excess of the depth at the centroid over the allowed depth.
    excess: f64,
    /// Upper bound of that excess on the piece.
    bound: f64,
}

/// The allowed depths of cutting surfaces and of the other surfaces.
struct Limits<'a> {
    tool: &'a ToolModel,
    cutting: f64,
    non_cutting: f64,
}

impl Limits<'_> {
    /// Evaluates a piece given by its corners relative to the tip. Returns `None` if no point of it collides.
    fn piece(&self, axis: &Vector3<f64>, corners: [Vector3<f64>; 3]) -> Option<Piece> {
        let (centroid, reach) = ball(&corners);
        let z = centroid.dot(axis);
        let meridian_point =
            [(centroid - z * axis).norm(), 0.0, z].map(|coordinate| coordinate / self.tool.length);
        let [depth, cutting, non_cutting] = self.tool.depth_and_distances(meridian_point);
        let max_depth = depth + reach;
        // The other surfaces are not the nearest to any point of the piece inside the tool, or no point is inside.
        let is_separate = max_depth < 0.0 || non_cutting - reach > max_depth;
        let cutting_bound =
            if max_depth > 0.0 { max_depth - self.cutting } else { f64::NEG_INFINITY };
        let non_cutting_bound =
            if is_separate { reach - non_cutting } else { max_depth } - self.non_cutting;
        let bound = cutting_bound.max(non_cutting_bound);
        if bound <= 0.0 {
            return None;
        }
        let inside = depth > 0.0;
        let cutting_excess =
            if inside && cutting <= non_cutting { depth - self.cutting } else { f64::NEG_INFINITY };
        let non_cutting_excess =
            if inside && non_cutting <= cutting { depth } else { -non_cutting } - self.non_cutting;
        Some(Piece { corners, reach, excess: cutting_excess.max(non_cutting_excess), bound })
    }
}
