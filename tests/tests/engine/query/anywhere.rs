//! Any part and any tool at any pose, and the scenes that figures are quoted on.

use super::compare::{Case, Statistics, check_tools, tools};
use super::parts;
use crate::prelude::*;
use touchoff::scenes::ScenePath;

/// Checks every tool about a part; fails unless two fifths of the poses touch.
pub(crate) fn all_tools(what: &str, part: &Part, count: usize) {
    check_tools(what, part, 31, |case, rng| {
        for k in 0..count {
            case.check(&parts::about(part, case.oracle, k, rng), k);
        }
        let (name, statistics) = (case.oracle.name(), case.statistics);
        assert!(5 * statistics.touching > 2 * count, "{what} {name}: {statistics:?}");
        assert_eq!(statistics.disputed, 0);
    });
}

#[test]
fn random_poses_on_surfaces() {
    all_tools("tube", &parts::tube(4_000), 120);
    all_tools("sphere", &parts::sphere(7.0, 4_000), 120);
    all_tools("cuboid", &parts::cuboid(9.0, 4_000), 120);
}

/// Trees that are just full, just not full, and one level deeper.
#[test]
fn point_counts_near_powers_of_sixteen() {
    for count in [1, 2, 15, 16, 17, 255, 256, 257, 4095, 4096, 4097] {
        let poses = if count > 1000 { 60 } else { 180 };
        all_tools(&format!("soup of {count}"), &parts::soup(6.0, count, count as u64), poses);
    }
}

#[test]
fn repeated_points() {
    for count in [1, 16, 100, 300] {
        for at in [Point3::origin(), Point3::new(0.1, -70.3, 1e3)] {
            all_tools(&format!("{count} times {at}"), &parts::identical(at, count), 120);
        }
    }
}

/// Points in a line and in a plane: boxes without a width.
#[test]
fn thin_parts() {
    let mut rng = Rng::new(17);
    let mut of = |keep: [f64; 3]| {
        let points = (0..1000).map(|_| {
            Point3::from(parts::vector(&mut rng, 20.0).component_mul(&Vector3::from(keep)))
        });
        parts::of(points.collect(), vec![Vector3::z(); 1000], vec![0.1; 1000])
    };
    for keep in [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0], [1.0, 1e-7, 1e-13]] {
        all_tools(&format!("{keep:?}"), &of(keep), 120);
    }
}

/// A tool wholly inside a hollow box has no contact, nor has one wholly outside.
#[test]
fn clear_of_the_part() {
    let part = parts::cuboid(120.0, 3_000);
    check_tools("hollow box", &part, 5, |case, rng| {
        for k in 0..60 {
            let inside = Point3::from(parts::vector(rng, 15.0));
            let outside = inside + 200.0 * parts::direction(rng);
            let farther = inside + 1e6 * parts::direction(rng);
            let [_, height] = case.oracle.extent();
            let at = [inside, outside, farther][k % 3];
            if (at - inside).norm() < 300.0 && k % 3 == 1 && at.coords.amax() < 130.0 + height {
                continue;
            }
            let pose = parts::bringing(Vector3::zeros(), at, rng);
            assert_eq!(case.check(&pose, k), 0, "{}", case.oracle.name());
        }
    });
}

/// All of the part is in the tool: every point counts.
#[test]
fn parts_inside_the_tool() {
    check_tools("inside", &parts::soup(0.2, 3_000, 3), 6, |case, rng| {
        for k in 0..30 {
            let pose = parts::bringing(Vector3::new(0.0, 0.0, 1.0), Point3::origin(), rng);
            assert_eq!(case.check(&pose, k), 3_000);
        }
    });
}

/// A pose as far away as a pose may be: no contact, and no panic.
#[test]
fn poses_at_the_largest_coordinates() {
    let part = parts::soup(6.0, 500, 8);
    for (tool, _) in tools() {
        let mut probe = Probe::new(&part, tool);
        for distance in [1e20, 1e38, 1e39, 1e50, 1e60] {
            for direction in [Vector3::x(), -Vector3::y(), Vector3::z(), -Vector3::z()] {
                for axis in [Vector3::x(), Vector3::z(), Vector3::new(0.6, 0.0, -0.8)] {
                    let pose = Pose::from_axis(Point3::from(distance * direction), axis);
                    let pose = pose.expect("a pose");
                    assert!(!probe.detect(&pose), "{} {pose:?}", tool.info().name);
                    let wrench = probe.wrench(&pose);
                    assert_eq!((wrench.colliding, wrench.force.norm()), (0, 0.0));
                    assert!(probe.contacts(&pose).is_empty());
                }
            }
        }
    }
}

/// Checks the poses of a path cut into `poses`, with every tool. Returns the statistics of the thesis's tool.
fn along(path: ScenePath, count: usize, poses: usize) -> Statistics {
    let part = parts::tube(count);
    let mut fig73 = Statistics::default();
    for (tool, oracle) in tools() {
        let mut case = Case::new(&part, tool, &*oracle);
        // The scenes are those of the thesis's tool; for the others every fifth pose is enough.
        let step = if oracle.name() == "Fig73" { 1 } else { 5 };
        for k in (0..poses).step_by(step) {
            case.check(&path.pose(k, poses), k / step);
        }
        println!("{} {count} {}: {:?}", path.name(), oracle.name(), case.statistics);
        assert_eq!(case.statistics.disputed, 0);
        if step == 1 {
            fig73 = case.statistics;
        }
    }
    fig73
}

#[test]
fn paths_along_the_tube_agree_with_the_oracle() {
    for (points, poses) in [(1_000, 600), (5_000, 240), (20_000, 120)] {
        for path in ScenePath::ALL {
            let seen = along(path, points, poses);
            let is_busy = points < 20_000 || seen.contacts > 5 * poses;
            assert!(is_busy, "{path:?} hardly touches: {seen:?}");
        }
    }
}
