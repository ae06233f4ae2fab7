//! Trajectories that are no motions at constant speed: the tip of a ball end mill on an arc beside a wall, for which the
//! greatest depth is known.

use crate::prelude::*;
use crate::verdicts::assert_verdict;
use nalgebra::Rotation3;
use touchoff::certify::{Approximation, Trajectory};
use touchoff_tests::fixtures;

/// Radius of the arc about the z axis, and that of the tool, mm.
const RADIUS: f64 = 20.0;
const BALL: f64 = 5.0;
/// The arc ends at this angle on either side of +x, in radians.
const HALF_ANGLE: f64 = 1.4;

/// A curved path of the tip, on which the axis turns about x at constant speed.
struct Path {
    /// The tip at a time.
    tip: fn(f64) -> [f64; 3],
    /// The angle between the axis and +z at either end.
    lean: f64,
    /// Bounds on speed and acceleration of the tip.
    speed: f64,
    acceleration: f64,
    /// The longest time on which the path is approximated.
    longest: f64,
    /// Bound on the distance from the path that is meant.
    error: f64,
}

/// Returns the tip on an arc about the z axis, with constant speed and an upright tool.
fn arc(error: f64) -> Path {
    Path {
        tip: |at| {
            let (sine, cosine) = (HALF_ANGLE * (2.0 * at - 1.0)).sin_cos();
            [RADIUS * cosine, RADIUS * sine, 0.0]
        },
        lean: 0.0,
        speed: 2.0 * HALF_ANGLE * RADIUS,
        acceleration: (2.0 * HALF_ANGLE).powi(2) * RADIUS,
        // The chord of a longer arc says nothing, as axes that turn by half a turn say nothing.
        longest: 0.5 / HALF_ANGLE,
        error,
    }
}

impl Trajectory for Path {
    fn pose(&self, at: f64) -> Pose {
        let (sine, cosine) = (self.lean * (2.0 * at - 1.0)).sin_cos();
        pose((self.tip)(at), [0.0, sine, cosine])
    }

    fn approximation(&self, [from, to]: [f64; 2], _reach: f64) -> Option<Approximation> {
        let time = to - from;
        // The chord of a curve is as far from it as an eighth of the greatest acceleration.
        (time <= self.longest).then(|| Approximation {
            motion: motion(&self.pose(from), &self.pose(to)),
            times: [0.0, 1.0],
            deviation: self.acceleration * time * time / 8.0 + self.error,
        })
    }

    fn error(&self) -> f64 {
        self.error
    }

    fn max_speed(&self, reach: f64) -> f64 {
        self.speed + 2.0 * self.lean * reach
    }

    fn has_spin(&self) -> bool {
        false
    }
}

/// Returns a wall across x whose near side is so deep in the ball at the middle of the arc; it ends at the height of the
/// ball's centre.
fn wall(depth: f64) -> Mesh {
    let near = RADIUS + BALL - depth;
    block([near, -40.0, -30.0], [near + 10.0, 40.0, BALL])
}

#[test]
fn the_greatest_depth_on_an_arc_is_known() {
    for (depth, error) in [(0.5, 0.0), (0.5, 0.01), (0.003, 0.0)] {
        let (mut certifier, arc) = (certifier(&wall(depth), "Ball"), arc(error));
        let ball = tool("Ball").info().surface_named("ball").expect("a surface");
        let found = certifier.motion_depth(ball, &arc, 0.0, 1e-6);
        let (at, interval, max_depth, witness) = deeper(found);
        assert!((at - 0.5).abs() < 1e-2, "{at}");
        // The bounds hold for every motion within the error. Depths are searched no finer than half of that.
        assert!(interval.low <= depth - error && depth + error <= interval.high, "{interval:?}");
        assert!(interval.high - interval.low < 2.5 * error + 2e-6, "{interval:?}");
        let most = 1.2 * depth + 20.0 * error;
        assert!(interval.high <= max_depth && max_depth < most, "{max_depth}");
        assert!((witness.point.x - (RADIUS + BALL - depth)).abs() < 1e-9, "{witness:?}");
    }
}

#[test]
fn an_arc_beside_a_wall_is_decided_to_the_tolerance() {
    let arc = arc(0.0);
    for (depth, clear) in [(-1.0, true), (-1e-5, true), (1e-5, false), (1.0, false)] {
        let verdict = certifier(&wall(depth), "Ball").check_motion(&arc, 1e-7);
        assert_verdict(verdict, clear.then_some(MotionVerdict::Clear), depth);
        if let MotionVerdict::Touching(at, witness) = verdict {
            assert!((at - 0.5).abs() < 0.25, "{depth}, {at}");
            assert!((witness.point.x - (RADIUS + BALL - depth)).abs() < 1e-9, "{witness:?}");
        }
    }
}

/// Chords of the arc cut into a pillar inside it, which the arc itself passes.
#[test]
fn an_arc_about_a_pillar_is_clear_though_its_chords_are_not() {
    for (gap, clear) in [(1.0, true), (1e-2, true), (1e-4, true), (-1e-4, false), (-1.0, false)] {
        let pillar = shapes::tube(4.0, RADIUS - BALL - gap, 8.0, 256, 1, Unit::Millimetre);
        let verdict = certifier(&pillar.expect("a tube"), "Ball").check_motion(&arc(0.0), 1e-6);
        assert_verdict(verdict, clear.then_some(MotionVerdict::Clear), gap);
        if let MotionVerdict::Touching(at, witness) = verdict {
            let from_tip = witness.point - arc(0.0).pose(at).tip();
            // Below the centre of the ball its distance from there counts, above it that from the axis.
            let below = (BALL - from_tip.z).max(0.0);
            let distance = from_tip.x.hypot(from_tip.y).hypot(below);
            // The point is inside the tool at the arc's own pose, not only at that of a chord.
            assert!(distance < BALL, "{gap}: {verdict:?}");
        }
    }
}

/// Returns a wall turned about an axis.
fn turned(wall: &Mesh, axis: Vector3<f64>, angle: f64) -> Mesh {
    let turn = Rotation3::new(angle * axis);
    moved(wall, |vertex| turn * vertex)
}

/// Returns a small triangle outside the arc, whose nearest corner is so deep in the ball at 0.3 rad: at no time that
/// halving intervals reaches. Bounds of a wall would be too loose to miss it.
fn thorn(depth: f64) -> Mesh {
    let (sine, cosine) = 0.3f64.sin_cos();
    let out = Vector3::new(cosine, sine, 0.0);
    let corner = Point3::from((RADIUS + BALL - depth) * out) + BALL * Vector3::z();
    let others = [Vector3::z(), -Vector3::z()].map(|side| corner + 0.05 * (out + side));
    soup(&[[corner, others[0], others[1]].map(Into::into)])
}

/// Chords of the arc stay away from what is outside it and touches the arc itself between their ends.
#[test]
fn an_arc_that_touches_a_thorn_between_the_ends_of_its_chords_is_not_clear() {
    for (depth, clear) in [(-1e-5, true), (1e-5, false), (1e-3, false)] {
        let verdict = certifier(&thorn(depth), "Ball").check_motion(&arc(0.0), 1e-7);
        // The triangle is no solid.
        assert_verdict(verdict, clear.then_some(MotionVerdict::SurfaceOnly), depth);
    }
}

/// The distance from a wall beside the arc, which is less than the margin of the surface.
#[test]
fn the_least_distance_on_an_arc_is_known() {
    let ball = tool("Ball").info().surface_named("ball").expect("a surface");
    for error in [0.0, 0.01] {
        // Deepest at no time that halving the arc's intervals reaches.
        let (wall, arc) = (turned(&wall(-0.5), Vector3::z(), 0.3), arc(error));
        let found = certifier(&wall, "Ball").motion_depth(ball, &arc, -1.0, 1e-6);
        let (at, depth, max_depth, _) = deeper(found);
        assert!((at - (0.5 + 0.3 / (2.0 * HALF_ANGLE))).abs() < 1e-2, "{at}");
        // The bounds hold for every motion within the error.
        assert!(depth.low <= -0.5 - error && -0.5 + error <= depth.high, "{error}: {depth}");
        assert!(depth.high <= max_depth && max_depth < -0.5 + 0.1 + 20.0 * error, "{max_depth}");
    }
}

/// A pin that swings about its tip reaches farthest with its upper edge, while its axis points beside the wall.
#[test]
fn the_edge_of_a_swinging_pin_touches_a_wall_that_no_end_of_the_swing_reaches() {
    let pin = drawn("0 0; pin 1 0, 1 40, 0 40", "pin");
    let reach = 40f64.hypot(1.0);
    let at = |angle: f64| pose([0.0; 3], [angle.sin(), 0.0, angle.cos()]);
    let swing = motion(&at(-1.1), &at(1.0));
    for (depth, clear) in [(-1e-2, true), (1e-2, false)] {
        // The wall's face is across the direction at 0.2 rad.
        let wall = block([-60.0, -9.0, reach - depth], [60.0, 9.0, reach + 10.0]);
        let mut certifier = certifier_of(&turned(&wall, Vector3::y(), 0.2), &pin);
        let verdict = certifier.check_motion(&swing, 1e-4);
        assert_verdict(verdict, clear.then_some(MotionVerdict::Clear), depth);
    }
}

/// A tool that goes out and back ends where it began, so that its chord does not move: only the deviation from the chord tells
/// that it comes to the wall.
#[test]
fn a_wall_that_is_reached_on_the_way_out_and_back_is_touched() {
    let path = Path {
        tip: |at| [160.0 * at * (1.0 - at), 0.0, 0.0],
        lean: 0.1,
        speed: 160.0,
        acceleration: 320.0,
        longest: 1.0,
        error: 0.0,
    };
    let ball = fixtures::ball();
    for (depth, is_clear) in [(-1e-3, true), (1e-3, false)] {
        let near = 40.0 + fixtures::BALL - depth;
        let mut certifier =
            certifier_of(&block([near, -90.0, -90.0], [near + 10.0, 90.0, 90.0]), &ball);
        let verdict = certifier.check_motion(&path, 1e-4);
        assert_verdict(verdict, is_clear.then_some(MotionVerdict::Clear), depth);
    }
}
