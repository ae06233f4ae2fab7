//! Distances of a ball from a part far away, and rapids from far away: there all of the rounding grows with the
//! distance. The truth is computed in 256 bits from the doubles of part and pose.

use crate::{motion, pose, soup};
use nalgebra::{Point3, Vector3};
use touchoff::Pose;
use touchoff::certify::{Certifier, MotionVerdict, TriangleBvh};
use touchoff::tool::Interpreted;
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::rng::Rng;

type Triple = [Big; 3];

const RADIUS: f64 = 3.0;

fn ball() -> Interpreted {
    "tool Ball { units mm; profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; } niceness cutting: 1; }"
        .parse()
        .expect("a tool")
}

fn to_big(v: Vector3<f64>) -> Triple {
    [v.x, v.y, v.z].map(Big::exactly)
}

fn minus(a: &Triple, b: &Triple) -> Triple {
    [0, 1, 2].map(|k| &a[k] - &b[k])
}

fn cross(a: &Triple, b: &Triple) -> Triple {
    let part = |i: usize, j: usize| &(&a[i] * &b[j]) - &(&a[j] * &b[i]);
    [part(1, 2), part(2, 0), part(0, 1)]
}

fn norm(a: &Triple) -> Big {
    (&(&(&a[0] * &a[0]) + &(&a[1] * &a[1])) + &(&a[2] * &a[2])).sqrt()
}

/// Returns the centre of the ball.
fn centre(pose: &Pose) -> Triple {
    let (tip, axis) = (to_big(pose.tip().coords), to_big(pose.axis()));
    [0, 1, 2].map(|k| &tip[k] + &(&axis[k] * &Big::exactly(RADIUS)))
}

fn any(rng: &mut Rng, size: f64) -> Vector3<f64> {
    size * Vector3::from(rng.direction())
}

/// Returns a vector across a direction.
fn across(direction: Vector3<f64>, rng: &mut Rng) -> Vector3<f64> {
    direction.cross(&any(rng, 1.0)).normalize()
}

/// Returns a triangle that is narrow toward a direction, with its first corner at a point.
fn narrow(at: Point3<f64>, direction: Vector3<f64>, size: f64, rng: &mut Rng) -> [[f64; 3]; 3] {
    let side = across(direction, rng);
    [at, at + size * (direction + side), at + size * (direction - side)].map(Into::into)
}

#[test]
fn distances_far_away_contain_those_in_256_bits() {
    let tool = ball();
    let mut rng = Rng::new(1);
    for round in 0..400 {
        let distance = 10f64.powi(2 + round % 12);
        let tip = Point3::from(any(&mut rng, 10.0));
        let pose = pose(tip.into(), rng.direction());
        let toward = any(&mut rng, 1.0);
        let nearest = tip + distance * toward;
        // Triangles without area, whose meridian cannot be wrong, end at the nearest point. One with area lies behind
        // them, in another leaf of the tree, so that it is not searched.
        let behind = 1e-3 * distance;
        let needle = [nearest, nearest + 1e-2 * behind * toward, nearest].map(Into::into);
        let mut triangles = vec![needle; 16];
        triangles.push(narrow(nearest + behind * toward, toward, 1e-2 * behind, &mut rng));
        let bvh = TriangleBvh::new(&soup(&triangles));
        let mut certifier = Certifier::new(&bvh, &tool).expect("a profile");
        let found = certifier.clearance(&pose, 0.0).distance;
        let arm = minus(&to_big(nearest.coords), &centre(&pose));
        let exact = &norm(&arm) - &Big::exactly(RADIUS);
        let text = format!("{} in {found:?} at {pose:?}", exact.to_f64());
        assert!(Big::exactly(found.low) <= exact && exact <= Big::exactly(found.high), "{text}");
        assert!(found.width() < 1e-12 * (1.0 + distance), "{text}");
    }
}

/// A ball, and a motion on which it passes a corner.
struct Passage {
    /// Distance of the way from the world's origin, and its length before the corner.
    offset: f64,
    length: f64,
    /// Size of the triangle.
    size: f64,
    /// The depths at the corner are as near as that to 0 and to the tolerance.
    near: f64,
    tolerance: f64,
}

/// Compares verdicts on some passages with the distance of the corner from the line of the ball's centre.
fn check_passages(passage: &Passage, rounds: usize, rng: &mut Rng) {
    let Passage { offset, length, size, near, tolerance } = *passage;
    let tool = ball();
    let (mut clear, mut touching) = (0, 0);
    for round in 0..rounds {
        let way = any(rng, 1.0);
        let place = Point3::from(any(rng, 10.0) + any(rng, offset));
        let from = pose((place - length * way).into(), rng.direction());
        let path = motion(&from, &pose((place + 0.01 * length * way).into(), from.axis().into()));
        // Some are far from both.
        let limit = [0.0, tolerance, 0.0, tolerance, -0.5, 0.5][round % 6];
        let depth = limit + rng.between(-near, near);
        let out = across(way, rng);
        let corner = place + RADIUS * from.axis() + (RADIUS - depth) * out;
        let triangle = narrow(corner, out, size, rng);
        let along = to_big(path.displacement());
        let arm = minus(&to_big(Vector3::from(triangle[0])), &centre(&path.pose(0.0)));
        let off = &norm(&cross(&arm, &along)) / &norm(&along);
        let exact = &Big::exactly(RADIUS) - &off;
        let text = format!("{:e} deep: {path:?}, {triangle:?}", exact.to_f64());
        let bvh = TriangleBvh::new(&soup(&[triangle]));
        let mut certifier = Certifier::new(&bvh, &tool).expect("a profile");
        match certifier.check_motion(&path, tolerance) {
            // The triangle is no solid.
            MotionVerdict::SurfaceOnly => {
                assert!(exact <= Big::exactly(tolerance), "{text}");
                clear += 1;
            }
            MotionVerdict::Touching(..) => {
                assert!(exact > Big::zero(), "{text}");
                touching += 1;
            }
            MotionVerdict::Undecided(at) => assert!(round % 6 < 4, "undecided at {at}: {text}"),
            other => panic!("{other:?}: {text}"),
        }
    }
    println!("{rounds} passages: {clear} clear, {touching} touching");
    assert!(clear >= rounds / 6 && touching >= rounds / 6, "{clear} clear, {touching} touching");
}

/// Places on the way are rounded by more than the bound of the tool and the part alone.
#[test]
fn a_rapid_from_afar_is_judged_within_the_rounding_of_its_way() {
    let mut rng = Rng::new(2);
    let afar = Passage { offset: 0.0, length: 2e6, size: 400.0, near: 1e-10, tolerance: 1e-6 };
    check_passages(&afar, 144, &mut rng);
}

/// The tips between both ends of a motion are rounded by a tenth of a micrometre and more.
#[test]
fn a_motion_far_from_the_origin_is_judged_within_the_rounding_of_its_places() {
    let mut rng = Rng::new(3);
    for offset in [1e9, 1e11, 1e12] {
        let near = f64::EPSILON * offset;
        let far = Passage { offset, length: 10.0, size: 1.0, near, tolerance: 1e-9 };
        check_passages(&far, 48, &mut rng);
    }
}
