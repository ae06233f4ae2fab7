//! Trajectories that are no motions at constant speed: the tip of a ball end mill on an arc beside a wall, for which the
//! greatest depth is known.

use crate::{UP, block, pose, tool};
use touchoff::certify::{
    Approximation, Certifier, MotionDepth, MotionVerdict, Trajectory, TriangleBvh,
};
use touchoff::mesh::shapes;
use touchoff::{Motion, Pose, SurfaceId, Unit};

/// Radius of the arc about the z axis, and that of the tool, mm.
const RADIUS: f64 = 20.0;
const BALL: f64 = 5.0;
/// The arc ends at this angle on either side of +x, in radians.
const HALF_ANGLE: f64 = 1.4;

/// The tip on an arc about the z axis, with constant speed and an upright tool.
struct Arc {
    /// Bound on the distance from the arc that is meant.
    error: f64,
}

impl Trajectory for Arc {
    fn pose(&self, at: f64) -> Pose {
        let (sine, cosine) = (HALF_ANGLE * (2.0 * at - 1.0)).sin_cos();
        pose([RADIUS * cosine, RADIUS * sine, 0.0], UP)
    }

    fn approximation(&self, [from, to]: [f64; 2], _reach: f64) -> Option<Approximation> {
        let angle = 2.0 * HALF_ANGLE * (to - from);
        // The chord of a curve is as far from it as an eighth of the greatest acceleration. Of an arc so long it says
        // nothing, as of axes that turn by half a turn.
        (angle < 1.0).then(|| Approximation {
            motion: Motion::new(&self.pose(from), &self.pose(to)).expect("no rotation"),
            times: [0.0, 1.0],
            deviation: RADIUS * angle * angle / 8.0 + self.error,
        })
    }

    fn error(&self) -> f64 {
        self.error
    }

    fn max_speed(&self, _reach: f64) -> f64 {
        2.0 * HALF_ANGLE * RADIUS
    }

    fn has_spin(&self) -> bool {
        false
    }
}

/// Returns a wall across x whose near side is so deep in the ball at the middle of the arc; it ends at the height of the
/// ball's centre.
fn wall(depth: f64) -> TriangleBvh {
    let near = RADIUS + BALL - depth;
    TriangleBvh::new(&block([near, -40.0, -30.0], [near + 10.0, 40.0, BALL]))
}

#[test]
fn the_greatest_depth_on_an_arc_is_known() {
    for (depth, error) in [(0.5, 0.0), (0.5, 0.01), (0.003, 0.0)] {
        let (wall, arc) = (wall(depth), Arc { error });
        let mut certifier = Certifier::new(&wall, tool("Ball")).expect("a profile");
        let surfaces = (0..tool("Ball").info().surfaces.len()).map(SurfaceId);
        let found: Vec<MotionDepth> = surfaces
            .map(|surface| certifier.motion_depth(surface, &arc, 0.0, 1e-6).expect("a surface"))
            .collect();
        let deepest = found.iter().find_map(|found| match found {
            MotionDepth::Deeper { at, depth, max_depth, witness } => {
                Some((*at, *depth, *max_depth, *witness))
            }
            _ => None,
        });
        let (at, interval, max_depth, witness) = deepest.expect("the ball is in the wall");
        assert!((at - 0.5).abs() < 1e-2, "{at}");
        // The bounds hold for every motion within the error. Depths are searched no finer than half of that.
        assert!(interval.low <= depth - error && depth + error <= interval.high, "{interval:?}");
        assert!(interval.high - interval.low < 2.5 * error + 2e-6, "{interval:?}");
        assert!(
            interval.high <= max_depth && max_depth < 1.2 * depth + 20.0 * error,
            "{max_depth}"
        );
        assert!((witness.point.x - (RADIUS + BALL - depth)).abs() < 1e-9, "{witness:?}");
    }
}

#[test]
fn an_arc_beside_a_wall_is_decided_to_the_tolerance() {
    let arc = Arc { error: 0.0 };
    for (depth, clear) in [(-1.0, true), (-1e-5, true), (1e-5, false), (1.0, false)] {
        let wall = wall(depth);
        let mut certifier = Certifier::new(&wall, tool("Ball")).expect("a profile");
        match certifier.check_motion(&arc, 1e-7) {
            MotionVerdict::Clear => assert!(clear, "{depth}"),
            MotionVerdict::Touching(at, witness) => {
                assert!(!clear && (at - 0.5).abs() < 0.25, "{depth}, {at}");
                assert!((witness.point.x - (RADIUS + BALL - depth)).abs() < 1e-9, "{witness:?}");
            }
            other => panic!("{depth}: {other:?}"),
        }
    }
}

/// Chords of the arc cut into a pillar inside it, which the arc itself passes.
#[test]
fn an_arc_about_a_pillar_is_clear_though_its_chords_are_not() {
    for (gap, clear) in [(1.0, true), (1e-2, true), (1e-4, true), (-1e-4, false), (-1.0, false)] {
        let pillar = shapes::tube(4.0, RADIUS - BALL - gap, 8.0, 256, 1, Unit::Millimetre);
        let pillar = TriangleBvh::new(&pillar.expect("a tube"));
        let mut certifier = Certifier::new(&pillar, tool("Ball")).expect("a profile");
        let verdict = certifier.check_motion(&Arc { error: 0.0 }, 1e-6);
        match verdict {
            MotionVerdict::Clear => assert!(clear, "{gap}"),
            MotionVerdict::Touching(at, witness) => {
                let from_tip = witness.point - Arc { error: 0.0 }.pose(at).tip();
                // Below the centre of the ball its distance from there counts, above it that from the axis.
                let below = (BALL - from_tip.z).max(0.0);
                let distance = from_tip.x.hypot(from_tip.y).hypot(below);
                // The point is inside the tool at the arc's own pose, not only at that of a chord.
                assert!(!clear && distance < BALL, "{gap}: {verdict:?}");
            }
            other => panic!("{gap}: {other:?}"),
        }
    }
}
