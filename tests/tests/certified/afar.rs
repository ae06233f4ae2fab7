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
        // The first corner is the nearest point, as the others lie behind it.
        let triangle = narrow(tip + distance * toward, toward, 1e-4 * distance, &mut rng);
        let bvh = TriangleBvh::new(&soup(&[triangle]));
        let mut certifier = Certifier::new(&bvh, &tool).expect("a profile");
        let found = certifier.clearance(&pose, 0.0).distance;
        let arm = minus(&to_big(Vector3::from(triangle[0])), &centre(&pose));
        let exact = &norm(&arm) - &Big::exactly(RADIUS);
        let text = format!("{} in {found:?} at {pose:?}", exact.to_f64());
        assert!(Big::exactly(found.low) <= exact && exact <= Big::exactly(found.high), "{text}");
        assert!(found.width() < 1e-12 * (1.0 + distance), "{text}");
    }
}

/// A ball passes a corner on a way so long that its places are rounded by more than the bound of the tool and the part
/// alone.
#[test]
fn a_rapid_from_afar_is_judged_within_the_rounding_of_its_way() {
    const TOLERANCE: f64 = 1e-4;
    let tool = ball();
    let mut rng = Rng::new(2);
    let (mut clear, mut touching) = (0, 0);
    for round in 0..200 {
        let way = any(&mut rng, 1.0);
        let axis = rng.direction();
        let near = Point3::from(any(&mut rng, 10.0));
        let from = pose((near - 4e5 * way).into(), axis);
        let path = motion(&from, &pose((near + 1e3 * way).into(), axis));
        // Nearly on the limit of contact, nearly on the tolerance, and far from both.
        let depth = [0.0, TOLERANCE, -1.0, 1.0][round % 4] + rng.between(-1e-10, 1e-10);
        let out = across(way, &mut rng);
        let corner = near + RADIUS * from.axis() + (RADIUS - depth) * out;
        let triangle = narrow(corner, out, 400.0, &mut rng);
        // The ball's centre moves along a line.
        let along = to_big(path.displacement());
        let arm = minus(&to_big(Vector3::from(triangle[0])), &centre(&path.pose(0.0)));
        let off = &norm(&cross(&arm, &along)) / &norm(&along);
        let exact = &Big::exactly(RADIUS) - &off;
        let bvh = TriangleBvh::new(&soup(&[triangle]));
        let verdict =
            Certifier::new(&bvh, &tool).expect("a profile").check_motion(&path, TOLERANCE);
        match verdict {
            // The triangle is no solid.
            MotionVerdict::SurfaceOnly => {
                assert!(exact <= Big::exactly(TOLERANCE), "{}: {path:?}", exact.to_f64());
                clear += 1;
            }
            MotionVerdict::Touching(..) => {
                assert!(exact > Big::zero(), "{}: {path:?}", exact.to_f64());
                touching += 1;
            }
            MotionVerdict::Undecided(at) => {
                assert!(round % 4 < 2, "{}: undecided from {at} of {path:?}", exact.to_f64());
            }
            other => panic!("{other:?}"),
        }
    }
    assert!(clear > 50 && touching > 50, "{clear} clear, {touching} touching");
}
