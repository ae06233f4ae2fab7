//! Random motions on which a tool is likely to come near a part.

use super::approach::Way;
use super::brute::Brute;
use super::poses;
use nalgebra::{Point3, Rotation3, Unit, Vector3};
use touchoff::{Pose, TriangleId};
use touchoff_tests::oracle::Oracle;
use touchoff_tests::oracle::draw::Rng;

/// The kinds of motions.
pub const KINDS: [&str; 8] = [
    "slide",
    "swing about the tip",
    "swing about a place",
    "plunge",
    "straight",
    "still",
    "rapid",
    "any",
];

/// Number of times that a motion is shifted toward a near miss, and number of sampled times per shift.
const MOVES: usize = 3;
const TIMES: u32 = 10;

fn made(tip: Point3<f64>, axis: Vector3<f64>) -> Pose {
    Pose::from_axis(tip, axis.normalize()).expect("an axis")
}

fn unit(draw: &mut Rng) -> Vector3<f64> {
    Vector3::from(draw.direction())
}

/// Returns a random number between two powers of ten.
fn size(draw: &mut Rng, from: f64, to: f64) -> f64 {
    10f64.powf(draw.between(from, to))
}

/// Returns a rotation about a random axis by 0.001 to 150 degrees.
fn turn(draw: &mut Rng) -> Rotation3<f64> {
    let about = Unit::new_normalize(unit(draw));
    Rotation3::from_axis_angle(&about, size(draw, -3.0, 150f64.log10()).to_radians())
}

/// Returns a random motion of a kind. Most are shifted away from the part until they pass it by 1e-7 to 0.5 mm, or
/// overlap it by that much.
pub fn way(brute: &Brute<'_>, kind: &str, draw: &mut Rng) -> Way {
    loop {
        let drawn = drawn(brute, kind, draw);
        // For nearly antiparallel axes, rounding decides the rotation.
        if drawn.angle().to_degrees() > 170.0 {
            continue;
        }
        let keeps = draw.bits().is_multiple_of(6);
        return if keeps { drawn } else { moved(brute, drawn, draw) };
    }
}

fn drawn(brute: &Brute<'_>, kind: &str, draw: &mut Rng) -> Way {
    let from = poses::pose(brute.mesh, brute.oracle, brute.length, draw);
    let (tip, axis) = (from.tip(), from.axis());
    let [low, high] = brute.mesh.bounds();
    let part = (high - low).norm();
    let to = match kind {
        "slide" => {
            let id = brute.at(&Way { from, to: from }, 0.0, draw).triangle;
            let normal = brute.mesh.normal(TriangleId(id as u32)).unwrap_or_else(|| unit(draw));
            let along = normal.cross(&unit(draw)).normalize() * part * size(draw, -3.0, 0.0);
            let leans = draw.bits().is_multiple_of(2);
            made(tip + along, if leans { axis + 0.1 * unit(draw) } else { axis })
        }
        "swing about the tip" => made(tip, turn(draw) * axis),
        "swing about a place" => {
            let about = Point3::from(brute.at(&Way { from, to: from }, 0.0, draw).point);
            let turn = turn(draw);
            made(about + turn * (tip - about), turn * axis)
        }
        "plunge" => {
            let long = part * size(draw, -4.0, 0.3);
            made(tip + axis * if draw.bits().is_multiple_of(2) { long } else { -long }, axis)
        }
        "straight" => made(tip + unit(draw) * part * size(draw, -4.0, 0.5), axis),
        "still" => from,
        "rapid" => {
            let far = made(tip + unit(draw) * part * size(draw, 0.5, 3.0), turn(draw) * axis);
            // Half of them also come from far away.
            if draw.bits().is_multiple_of(2) {
                let back = tip - (far.tip() - tip);
                return Way { from: made(back, axis), to: far };
            }
            far
        }
        _ => poses::pose(brute.mesh, brute.oracle, brute.length, draw),
    };
    if draw.bits().is_multiple_of(2) { Way { from, to } } else { Way { from: to, to: from } }
}

fn moved(brute: &Brute<'_>, mut way: Way, draw: &mut Rng) -> Way {
    let [radius, _] = brute.oracle.extent();
    let gap = size(draw, -7.0, -0.3) * (radius * brute.length / 5.0);
    let gap = if draw.bits().is_multiple_of(10) { -gap } else { gap };
    for _ in 0..MOVES {
        let closest = brute.closest(&way, TIMES, false, draw);
        let off =
            brute.mesh.normal(TriangleId(closest.triangle as u32)).unwrap_or_else(|| unit(draw));
        let by = off * (closest.depth + gap);
        let push = |pose: &Pose| made(pose.tip() + by, pose.axis());
        way = Way { from: push(&way.from), to: push(&way.to) };
    }
    way
}
