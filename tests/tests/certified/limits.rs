//! Tools and triangles for which one term of the error bounds is all that covers the rounding. The truth is computed in
//! 256 bits from the doubles of part and pose.

use crate::borders::{in_tool, pin};
use crate::prelude::*;
use crate::verdicts::assert_verdict;
use touchoff::certify::NearestTriangle;
use touchoff_tests::fixtures::{BALL, ball};
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::space::{Triple, exactly, to_f64};
use touchoff_tests::oracle::triangle::mean;
use touchoff_tests::oracle::vector::{add, norm, sub, vector_product};

/// Returns the centre of the ball.
fn centre(pose: &Pose) -> Triple {
    add(&exactly(pose.tip()), &exactly(pose.axis()), &Big::exactly(BALL))
}

/// Returns the centre of the ball at a fraction of a motion, where a pose would round the tip.
fn centre_at(path: &Motion, at: f64) -> Triple {
    let tip = add(&exactly(path.start()), &exactly(path.displacement()), &Big::exactly(at));
    add(&tip, &exactly(path.pose(at).axis()), &Big::exactly(BALL))
}

/// Returns the depth of a point in the ball.
fn depth(centre: &Triple, point: [f64; 3]) -> Big {
    &Big::exactly(BALL) - &norm(&sub(&exactly(point), centre))
}

/// Returns the depth of the line through two points.
fn depth_of_line(centre: &Triple, [from, to]: [[f64; 3]; 2]) -> Big {
    let along = sub(&exactly(to), &exactly(from));
    let off = vector_product(&sub(centre, &exactly(from)), &along);
    &Big::exactly(BALL) - &(&norm(&off) / &norm(&along))
}

fn any(rng: &mut Rng, size: f64) -> Vector3<f64> {
    size * Vector3::from(rng.direction())
}

fn any_pose(rng: &mut Rng) -> Pose {
    pose(any(rng, 10.0).into(), rng.direction())
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

fn assert_contains(found: Interval, exact: &Big, text: &str) {
    let [low, high] = [found.low, found.high].map(Big::exactly);
    assert!(low <= *exact && *exact <= high, "{:e} in {found:?}: {text}", exact.to_f64());
}

/// Points that are nearly equally far away, in any order. `f32` does not tell which is the nearest.
#[test]
fn distances_far_away_contain_those_in_256_bits() {
    let tool = ball();
    let mut rng = Rng::new(1);
    for round in 0..400 {
        let distance = 10f64.powi(2 + round % 12);
        let pose = any_pose(&mut rng);
        let toward = any(&mut rng, 1.0);
        // Triangles without area, whose meridian cannot be wrong. One with area lies so far behind them that it is not
        // searched.
        let behind = 1e-5 * distance;
        let mut triangles: Vec<[[f64; 3]; 3]> = Vec::new();
        for _ in 0..16 {
            let off =
                behind * across(toward, &mut rng) + rng.between(0.0, 1e-7) * distance * toward;
            let nearest = pose.tip() + distance * toward + off;
            triangles.push([nearest, nearest + behind * toward, nearest].map(Into::into));
        }
        let far = pose.tip() + (distance + behind) * toward;
        triangles.push(narrow(far, toward, behind, &mut rng));
        let mut certifier = certifier_of(&soup(&triangles), &tool);
        let found = certifier.clearance(&pose, 0.0).distance;
        let centre = centre(&pose);
        let depths = triangles.iter().map(|corners| depth(&centre, corners[0]));
        let deepest = depths.reduce(|a, b| if b > a { b } else { a }).expect("a triangle");
        assert_contains(found, &-&deepest, &format!("{pose:?}"));
        assert!(found.width() < 1e-12 * (1.0 + distance), "{found:?} at {distance}");
    }
}

/// Points of a long edge are rounded relative to its length. The triangle has no area, so that no meridian adds to its
/// error.
#[test]
fn depths_at_long_edges_contain_those_in_256_bits() {
    let tool = ball();
    let mut rng = Rng::new(4);
    for round in 0..200 {
        let length = 10f64.powi(1 + round % 9);
        let pose = any_pose(&mut rng);
        let inside = pose.tip() + BALL * pose.axis() + any(&mut rng, 0.8 * BALL);
        let along = any(&mut rng, 1.0);
        let [from, to] = [-1.0, 1.0].map(|sense| (inside + sense * length * along).into());
        let beside =
            narrow(inside + length * across(along, &mut rng), along, 0.1 * length, &mut rng);
        let mut certifier = certifier_of(&soup(&[[from, to, from], beside]), &tool);
        let found = certifier.deepest(&pose, 0.0).depth;
        assert_contains(found, &depth_of_line(&centre(&pose), [from, to]), &format!("{pose:?}"));
        assert!(found.width() < 1e-12 * (10.0 + length), "{found:?} at {length}");
    }
}

/// Slivers whose normals are off, and with them the line on which they are searched. The ball is deepest, or nearest, at a
/// point between their edges.
#[test]
fn distances_of_slivers_contain_those_in_256_bits() {
    let tool = ball();
    let mut rng = Rng::new(5);
    for round in 0..600 {
        let height = rng.power(-12.0, -3.0);
        // The plane is z = 0, from which the centre of the ball is as far as its height.
        let sliver = [
            [-rng.between(0.5, 2.0), 0.0, 0.0],
            [rng.between(0.5, 2.0), 0.0, 0.0],
            [rng.between(-0.4, 0.4), height, 0.0],
        ];
        let foot = mean(&sliver, [0; 3].map(|_| rng.between(0.3, 1.0)));
        let above = Vector3::new(0.0, 0.0, BALL + rng.between(-1.5, 1.5));
        let axis = rng.direction();
        let pose = pose((Point3::from(foot) + above - BALL * Vector3::from(axis)).into(), axis);
        let level = if round % 2 == 0 { Level::new() } else { Level::baseline() };
        let mut certifier = certifier_of(&soup(&[sliver]), &tool).with_level(level);
        let found = certifier.signed_distance(&pose, 0.0);
        let exact = &centre(&pose)[2] - &Big::exactly(BALL);
        assert_contains(found, &exact, &format!("{sliver:?} at {pose:?}"));
        let skew = (1e-13 / height).min(height);
        assert!(found.width() < 1e-11 + 4.0 * skew, "{found:?}, {height:e} high");
    }
}

/// A point that is nearer than the margin of the ball, at rest.
#[test]
fn a_margin_that_a_point_violates_is_known_to_rounding() {
    let tool = ball();
    let mut rng = Rng::new(9);
    for _ in 0..60 {
        let pose = any_pose(&mut rng);
        let out = any(&mut rng, 1.0);
        let point = pose.tip() + BALL * pose.axis() + (BALL + rng.between(0.1, 0.9)) * out;
        let beside = narrow(point + 20.0 * out, out, 1.0, &mut rng);
        let mut certifier = certifier_of(&soup(&[[point.into(); 3], beside]), &tool);
        let found = certifier.motion_depth(SurfaceId(0), &motion(&pose, &pose), -1.0, 0.0);
        let (_, found, ..) = deeper(found);
        assert_contains(found, &depth(&centre(&pose), point.into()), &format!("{pose:?}"));
    }
}

/// Triangles that are points above the end of a pin. The one that is deeper by the tolerance is not searched for, since the
/// other one is known.
#[test]
fn a_depth_that_is_not_searched_for_is_within_the_interval() {
    let tool = pin();
    let mut rng = Rng::new(6);
    for _ in 0..200 {
        let (tip, axis) = (any(&mut rng, 10.0).into(), rng.direction());
        let at = pose(tip, axis);
        let to_world = |x: f64, z: f64| at.tip() + at.rotation() * Vector3::new(x, 0.0, z);
        let [known, other] = [to_world(-2.0, 0.5), to_world(2.0, rng.between(1.0, 2.0))];
        let beside = narrow(to_world(50.0, 0.0), Vector3::x(), 1.0, &mut rng);
        let mut certifier =
            certifier_of(&soup(&[[known.into(); 3], [other.into(); 3], beside]), &tool);
        let aside = pose(to_world(-4.0, 0.0).into(), axis);
        assert!(certifier.deepest(&aside, 0.0).depth.contains(0.5));
        let [[_, _, known], [_, _, other]] = [known, other].map(|point| in_tool(&at, point));
        let tolerance = (&other - &known).to_f64();
        let found = certifier.deepest(&at, tolerance).depth;
        assert_contains(found, &other, &format!("{tolerance} at {at:?}"));
    }
}

/// A margin far larger than tool and part. `f32` rounds it, and the distance of a point that keeps it or not, by more than
/// what the two differ.
#[test]
fn a_margin_far_larger_than_the_tool_is_judged_within_its_rounding() {
    // `f32` rounds it down by almost the most.
    const MARGIN: f64 = 1e6 + 0.03;
    let tool = pin();
    let mut rng = Rng::new(10);
    for round in 0..100 {
        let pose = any_pose(&mut rng);
        let lack = if round % 2 == 0 { 1e-4 } else { -1e-4 };
        let [below, behind] = [lack - MARGIN, -1.0 - MARGIN]
            .map(|z| pose.tip() + pose.rotation() * Vector3::new(rng.between(0.0, 3.0), 1.0, z));
        let behind = narrow(behind, -pose.axis(), 1.0, &mut rng);
        let certifier = certifier_of(&soup(&[[below.into(); 3], behind]), &tool);
        let mut certifier = certifier.with_allowance("face", -MARGIN).expect("a surface");
        let verdict = certifier.check_motion(&motion(&pose, &pose), 1e-6);
        let text = format!("{lack}: {verdict:?} at {pose:?}");
        assert_eq!(matches!(verdict, MotionVerdict::Near(..)), lack > 0.0, "{text}");
        assert_eq!(verdict == MotionVerdict::SurfaceOnly, lack < 0.0, "{text}");
    }
}

/// Boxes of `f32` reach at least as far as their triangles. On both sides of a point they are nearly as far away.
#[test]
fn the_nearer_of_two_sides_is_found() {
    let mut rng = Rng::new(7);
    for round in 0..400 {
        let point = Point3::from(any(&mut rng, 1.0));
        let axis = Vector3::ith(round % 3, 1.0);
        let mut nearest = f64::INFINITY;
        let mut triangles = Vec::new();
        for toward in [axis, -axis] {
            let at = point + (1.0 + rng.between(0.0, 3e-8)) * toward;
            nearest = nearest.min((at - point).norm());
            // A leaf for each side.
            triangles.extend([narrow(at, toward, rng.between(0.3, 1.0), &mut rng); 16]);
        }
        let bvh = TriangleBvh::new(&soup(&triangles));
        let found = NearestTriangle::new(&bvh).distance(point);
        assert!((found - nearest).abs() < 1e-14, "{found} for {nearest}");
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
        let out = across(way, rng);
        // Half of the balls come near with an end of the tool.
        let axis = if round % 4 < 2 { rng.direction() } else { out.into() };
        let from = pose((place - length * way).into(), axis);
        let path = motion(&from, &pose((place + 0.01 * length * way).into(), from.axis().into()));
        // Some are far from both.
        let limit = [0.0, tolerance, 0.0, tolerance, -0.5, 0.5][round % 6];
        let depth = limit + rng.between(-near, near);
        let corner = place + BALL * from.axis() + (BALL - depth) * out;
        let triangle = narrow(corner, out, size, rng);
        let along = exactly(path.displacement());
        let arm = sub(&exactly(triangle[0]), &centre(&path.pose(0.0)));
        let off = &norm(&vector_product(&arm, &along)) / &norm(&along);
        let exact = &Big::exactly(BALL) - &off;
        let text = format!("{:e} deep: {path:?}, {triangle:?}", exact.to_f64());
        match verdict(&tool, triangle, &path, tolerance) {
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

fn verdict(
    tool: &Interpreted,
    triangle: [[f64; 3]; 3],
    path: &Motion,
    tolerance: f64,
) -> MotionVerdict {
    certifier_of(&soup(&[triangle]), tool).check_motion(path, tolerance)
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
    for offset in [1e9, 1e11, 1e12, 1e13, 1e14] {
        let near = f64::EPSILON * offset;
        let far = Passage { offset, length: 1e3, size: 1.0, near, tolerance: 1e-9 };
        check_passages(&far, 240, &mut rng);
    }
}

/// The ball turns while it passes, so that bounds are loose and the middle of an interval is examined in which it is nearest.
#[test]
fn a_rapid_that_barely_passes_a_corner_does_not_touch_it() {
    let tool = ball();
    let mut rng = Rng::new(8);
    let length = 2e6;
    for _ in 0..24 {
        let way = any(&mut rng, 1.0);
        let place = Point3::from(any(&mut rng, 10.0));
        // The middle of an interval that halving reaches.
        let at = (2 * rng.index(1 << 17) + 1) as f64 / f64::from(1 << 18);
        let axes = Vector3::from(rng.direction());
        let axes = [axes, (axes + across(axes, &mut rng)).normalize()];
        let [from, to] = [-at, 1.0 - at].map(|part| place + part * length * way);
        let path = motion(&pose(from.into(), axes[0].into()), &pose(to.into(), axes[1].into()));
        let centre = centre_at(&path, at);
        let out = across(way, &mut rng);
        // At other times the ball is deeper by at most 4e-12, since it turns.
        let gap = rng.between(1e-11, 1e-10);
        let triangle =
            narrow(Point3::from(to_f64(&centre)) + (BALL + gap) * out, out, 10.0, &mut rng);
        let exact = depth(&centre, triangle[0]);
        let verdict = verdict(&tool, triangle, &path, 0.0);
        let text = format!("{:e} deep: {path:?}, {triangle:?}", exact.to_f64());
        let is_apart = exact < Big::exactly(-4e-12);
        assert!(is_apart && verdict == MotionVerdict::SurfaceOnly, "{verdict:?}, {text}");
    }
}

/// The path of a point in the frame of a tool that turns while it moves is bent: into the ball, or out of it.
#[test]
fn a_turning_ball_touches_a_thorn_between_the_ends_of_its_way() {
    let tool = ball();
    for turn in [0.3, -0.3] {
        let at = |part: f64| {
            let angle: f64 = turn * (2.0 * part - 1.0);
            pose([40.0 * (part - 0.5), 0.0, 0.0], [angle.sin(), 0.0, angle.cos()])
        };
        let path = motion(&at(0.0), &at(1.0));
        for (part, side) in [(0.3, 1.0), (0.3, -1.0), (0.55, 1.0), (0.55, -1.0)] {
            let axis = at(part).axis();
            let speed = Vector3::new(40.0, 0.0, 0.0)
                + 2.0 * turn * BALL * Vector3::new(axis.z, 0.0, -axis.x);
            let out = side * Vector3::y().cross(&speed).normalize();
            for (depth, is_clear) in [(-1e-3, true), (1e-3, false)] {
                let corner = at(part).tip() + BALL * axis + (BALL - depth) * out;
                let others = [1.0, -1.0].map(|side| corner + 20.0 * out + side * Vector3::y());
                let thorn = [corner, others[0], others[1]].map(Into::into);
                let verdict = verdict(&tool, thorn, &path, 1e-6);
                // The triangle is no solid.
                let clear = is_clear.then_some(MotionVerdict::SurfaceOnly);
                assert_verdict(verdict, clear, (turn, part, side, depth));
            }
        }
    }
}
