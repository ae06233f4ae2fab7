//! A sample of `docs/measured/continuity.md`: steps of the force, work round closed loops, poses that are composed many times.

use nalgebra::{Point3, Vector3};
use touchoff::scenes::{Path, tube};
use touchoff::{Law, Pose, Tool};
use touchoff_bench::continuity::drift::{self, Turn, angle, apart};
use touchoff_bench::continuity::energy;
use touchoff_bench::continuity::loops::{Kind, block};
use touchoff_bench::continuity::page::{ANGLE, APART};
use touchoff_bench::continuity::smooth::Fig73Smooth;
use touchoff_bench::continuity::steps::{self, Look};
use touchoff_tests::oracle::draw::Draw;

fn tool(name: &str) -> &'static dyn Tool {
    tools_library::find(name).expect("a tool of the library")
}

/// The largest step of the force is what its points do, and more than what a smooth force would.
#[test]
fn steps_are_of_points() {
    let part = steps::part(&tube(), 5_000, 1);
    let tools: [&dyn Tool; 3] = [tool("Fig73"), tool("Fig73Exact"), &Fig73Smooth];
    for (path, law, tool) in [
        (Path::Outside, Law::Thesis, tools[0]),
        (Path::Inside, Law::Gradient, tools[1]),
        (Path::Hold, Law::Thesis, tools[2]),
        (Path::Hold, Law::Facing, tools[0]),
    ] {
        let row = steps::row(&part, tool, path, law, Look::Stations(2_000));
        let (name, step) = (&row.tool, row.force.force);
        assert!(row.steps > 4_000 && row.peaks[0] > 0.0, "{row:?}");
        assert!(step > row.median && step < row.peaks[0], "{name}: {row:?}");
        // Contacts are summed in another order and with normals in the world.
        let off = (row.change.total().norm() - step).abs();
        assert!(off < 1e-9 * row.peaks[0], "{name} on {}: {off:e} of {step:e}", path.name());
        assert!(!row.change.cause().is_empty());
    }
}

/// By the gradient's law nothing is done round a loop; by the thesis's something is.
#[test]
fn only_the_gradient_is_conservative() {
    let part = touchoff::Part::from_mesh(&block(), 100_000, 1).expect("a count of points");
    let mut thesis: f64 = 0.0;
    for name in ["Fig73", "Fig73Exact", "D2Ball", "BullNose", "UnitSphere", "Block", "LBracket"] {
        for kind in Kind::ALL {
            let row = energy::row(&part, tool(name), kind, [1e-8, 1e-5]);
            let row = row.unwrap_or_else(|| panic!("{name} is not brought to the block"));
            assert!(row.colliding > 30.0 && row.energy > 0.0, "{row:?}");
            let work = row.work[1];
            assert!(work.share.abs() < 1e-5, "{name}, {}: {work:?}", kind.name());
            thesis = thesis.max(row.work[0].share.abs());
        }
    }
    assert!(thesis > 0.05, "{thesis}");
}

#[test]
fn rotations_stay_rotations() {
    for turn in Turn::all() {
        let row = drift::row(turn, 30_000, 1);
        assert!(row.apart <= APART && row.angle <= ANGLE / 50.0, "{row:?}");
    }
}

/// However a chain of poses goes, seen from one another or one after the other.
#[test]
fn any_chain_of_poses_ends_in_a_rotation() {
    let mut draw = Draw::new(12);
    let mut any = || {
        let [x, y, z] = draw.direction();
        let [a, b, c] = draw.direction();
        let tip = Point3::new(a, b, c);
        let axis = Pose::from_axis(tip, Vector3::new(x, y, z)).expect("a unit vector");
        let w = draw.between(-1.0, 1.0);
        let size = (1.0 + w * w).sqrt();
        let full = Pose::from_quaternion(tip, [x, y, z, w].map(|part| part / size));
        [axis, full.expect("a unit quaternion")]
    };
    let mut pose = Pose::default();
    for _ in 0..20_000 {
        for other in any() {
            // What is given is normalised once, and not better than that.
            assert!(apart(other.rotation()) <= 2.0 * APART, "{other:?}");
            pose = pose.then(&other).seen_from(&any()[1]);
            assert!(apart(pose.rotation()) <= APART, "{pose:?}");
            // The way there and back.
            let back = pose.then(&other).seen_from(&other);
            assert!((back.rotation() - pose.rotation()).norm() < 3e-15, "{other:?}");
            assert!((back.tip() - pose.tip()).norm() < 1e-14 * (1.0 + pose.tip().coords.norm()));
        }
    }
}

/// One motion after another is the product, point by point.
#[test]
fn one_motion_after_another() {
    let mut draw = Draw::new(5);
    for turn in Turn::all() {
        let first = turn.motion();
        let second = Turn { axis: draw.direction(), angle: 0.7 }.motion();
        let both = first.then(&second);
        let through = |pose: &Pose, p: Point3<f64>| pose.tip() + pose.rotation() * p.coords;
        let p = Point3::from(draw.direction());
        let off = through(&both, p) - through(&second, through(&first, p));
        assert!(off.norm() < 1e-12, "{off}");
        assert!(angle(&first, &second, 1, both.rotation()) < 2e-15);
        assert!(both.is_full());
        let spun = Pose::from_axis(p, Vector3::z()).expect("a unit vector");
        assert!(!spun.then(&second).is_full());
    }
}
