//! Triangles, and the rules they are integrated by.

use nalgebra::{Point3, Vector3, Vector6};
use touchoff::tool::{Felt, LANES, Points};
use touchoff::{Mesh, Pose, Tool};

/// How many points a rule has.
pub(super) const RULE: usize = 7;

const A: f64 = 0.470_142_064_105_115_1;
const B: f64 = 0.101_286_507_323_456_3;
/// Radon's points, by their barycentric coordinates.
const POINTS: [[f64; 3]; RULE] = [
    [1.0 / 3.0; 3],
    [A, A, 1.0 - 2.0 * A],
    [A, 1.0 - 2.0 * A, A],
    [1.0 - 2.0 * A, A, A],
    [B, B, 1.0 - 2.0 * B],
    [B, 1.0 - 2.0 * B, B],
    [1.0 - 2.0 * B, B, B],
];
const WEIGHT_A: f64 = 0.132_394_152_788_506_2;
const WEIGHT_B: f64 = 0.125_939_180_544_827_2;
/// Weights of degree 5.
const HIGH: [f64; RULE] = [0.225, WEIGHT_A, WEIGHT_A, WEIGHT_A, WEIGHT_B, WEIGHT_B, WEIGHT_B];
/// Weights of degree 2, of the middle and the outer points: a coordinate's mean square is 1/6.
const SQUARE_B: f64 = (2.0 * B * B + (1.0 - 2.0 * B) * (1.0 - 2.0 * B)) / 3.0;
const OUTER: f64 = (1.0 / 6.0 - 1.0 / 9.0) / (SQUARE_B - 1.0 / 9.0);
const LOW: [f64; RULE] = [1.0 - OUTER, 0.0, 0.0, 0.0, OUTER / 3.0, OUTER / 3.0, OUTER / 3.0];

pub(super) type Corners = [Vector3<f64>; 3];

/// A triangle of a part, or a piece of one, and the part's normal there.
#[derive(Clone, Debug)]
pub(super) struct Face {
    /// Its corners, in the world.
    pub(super) corners: [Point3<f64>; 3],
    /// The part's outward normal.
    pub(super) normal: Vector3<f64>,
}

/// The faces of a mesh.
pub(super) fn faces(mesh: &Mesh) -> Vec<Face> {
    let all = (0..).zip(mesh.triangles());
    let face = |(id, _)| Some(Face { corners: mesh.triangle(id), normal: mesh.normal(id)? });
    all.filter_map(face).collect()
}

/// The same faces, halved until no edge is longer than `longest`.
pub(super) fn split(faces: &[Face], longest: f64) -> Vec<Face> {
    let mut split = Vec::new();
    for Face { corners, normal } in faces {
        let mut left = vec![corners.map(|corner| corner.coords)];
        while let Some(corners) = left.pop() {
            if (0..3).any(|k| (corners[(k + 1) % 3] - corners[k]).norm() > longest) {
                left.extend(halves(&corners));
            } else {
                split.push(Face { corners: corners.map(Point3::from), normal: *normal });
            }
        }
    }
    split
}

/// Which of the faces the tool touches, by its distance.
pub(super) fn touched(faces: &[Face], near: &dyn Tool, pose: &Pose) -> Vec<Face> {
    const LEAST: f64 = 1e-3;
    let touches = |face: &&Face| {
        let mut left = vec![in_tool(&face.corners, pose)];
        while let Some(corners) = left.pop() {
            let middle = middle(&corners);
            let far = near.clearance(middle.into());
            if far == 0.0 {
                return true;
            }
            let radius = radius(&corners, &middle);
            if far < radius && radius > LEAST {
                left.extend(halves(&corners));
            }
        }
        false
    };
    faces.iter().filter(touches).cloned().collect()
}

pub(super) fn in_tool(corners: &[Point3<f64>; 3], pose: &Pose) -> Corners {
    corners.map(|corner| pose.rotation().tr_mul(&(corner - pose.tip())))
}

pub(super) fn area(corners: &Corners) -> f64 {
    (corners[1] - corners[0]).cross(&(corners[2] - corners[0])).norm() / 2.0
}

pub(super) fn middle(corners: &Corners) -> Vector3<f64> {
    (corners[0] + corners[1] + corners[2]) / 3.0
}

/// Of the ball about the middle.
pub(super) fn radius(corners: &Corners, middle: &Vector3<f64>) -> f64 {
    let squares = corners.map(|corner| (corner - middle).norm_squared());
    squares.into_iter().fold(0.0, f64::max).sqrt()
}

/// Both halves, by the middle of the longest edge.
pub(super) fn halves(corners: &Corners) -> [Corners; 2] {
    let length = |k: usize| (corners[(k + 1) % 3] - corners[k]).norm_squared();
    let k = (1..3).fold(0, |best, k| if length(k) > length(best) { k } else { best });
    let [a, b, c] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
    let m = (a + b) / 2.0;
    [[a, m, c], [m, b, c]]
}

/// Adds the rule's points of a triangle.
pub(super) fn push(corners: &Corners, points: &mut Points) {
    for [a, b, c] in POINTS {
        points.push((corners[0] * a + corners[1] * b + corners[2] * c).into());
    }
}

/// Force, and torque about the tip; in the tool's frame.
pub(super) type Sum = Vector6<f64>;

/// How large force and torque are.
pub(super) fn norms(sum: &Sum) -> [f64; 2] {
    [0, 3].map(|row| sum.fixed_rows::<3>(row).norm())
}

/// What the rule's points of a triangle saw. Sums are of its area's unit.
#[derive(Default)]
pub(super) struct Seen {
    pub(super) high: Sum,
    pub(super) low: Sum,
    pub(super) inside: usize,
    /// Whether all of those are of one region.
    pub(super) alike: bool,
    /// Sums over those inside: of magnitudes, gradients and places.
    magnitude: f64,
    gradient: Vector3<f64>,
    place: Vector3<f64>,
}

/// What the triangle saw whose points were pushed as number `at`.
pub(super) fn see(felt: &Felt, points: &Points, at: usize, normal: &Vector3<f64>) -> Seen {
    let mut seen = Seen { alike: true, ..Seen::default() };
    let [x, y, z] = points.coordinates();
    let vector =
        |lists: &[Vec<f64>; 3], i: usize| Vector3::new(lists[0][i], lists[1][i], lists[2][i]);
    let mut region = f64::NAN;
    for k in 0..RULE {
        let i = at * RULE + k;
        if felt.inside[i / LANES] >> (i % LANES) & 1 == 0 {
            continue;
        }
        let magnitude = felt.magnitude[i];
        let place = Vector3::new(x[i], y[i], z[i]);
        let force = (normal - vector(&felt.direction, i)) * magnitude;
        let torque = place.cross(&force);
        let sum = Sum::new(force.x, force.y, force.z, torque.x, torque.y, torque.z);
        seen.high += sum * HIGH[k];
        seen.low += sum * LOW[k];
        seen.alike &= seen.inside == 0 || felt.region[i] == region;
        region = felt.region[i];
        seen.inside += 1;
        seen.magnitude += magnitude;
        seen.gradient += vector(&felt.gradient, i);
        seen.place += place;
    }
    seen
}

/// A triangle's part of which the tool is expected to hold all, and its area.
pub(super) type Bit = (Corners, f64);

/// What of a triangle is inside, if magnitude were the plane that its points inside saw on average. Nothing if that is all or none.
pub(super) fn cut(corners: &Corners, area: f64, seen: &Seen) -> [Option<Bit>; 2] {
    let share = 1.0 / seen.inside as f64;
    let (magnitude, gradient, place) =
        (seen.magnitude * share, seen.gradient * share, seen.place * share);
    let height = corners.map(|corner| magnitude + gradient.dot(&(corner - place)));
    let up = height.iter().filter(|height| **height > 0.0).count();
    // The corner that is alone on its side comes first.
    let alone = (0..3).find(|&k| (height[k] > 0.0) == (up == 1));
    let (1 | 2, Some(k)) = (up, alone) else { return [None, None] };
    let [a, b, c] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
    let [at, to_b, to_c] = [0, 1, 2].map(|i| height[(k + i) % 3]);
    let (s, t) = (at / (at - to_b), at / (at - to_c));
    let (p, q) = (a + (b - a) * s, a + (c - a) * t);
    if up == 1 {
        [Some(([a, p, q], area * s * t)), None]
    } else {
        [Some(([p, b, c], area * (1.0 - s))), Some(([p, c, q], area * s * (1.0 - t)))]
    }
}
